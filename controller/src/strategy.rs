//! How valves are decided: replaceable.

/// The strategies there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Strategy {
    /// All valves open, for comparison.
    AlwaysSoft,
    /// All valves closed, for comparison.
    AlwaysStiff,
    /// Ride mode or handling mode by running RMS.
    #[default]
    RideHandling,
}

impl Strategy {
    /// Names, as on a command line.
    pub const ALL: [(&'static str, Self); 3] = [
        ("always-soft", Self::AlwaysSoft),
        ("always-stiff", Self::AlwaysStiff),
        ("ride-handling", Self::RideHandling),
    ];

    /// By name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find_map(|(n, strategy)| (n == name).then_some(strategy))
    }
}
