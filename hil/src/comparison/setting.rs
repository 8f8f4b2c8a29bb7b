//! What a drive is driven with.

use oleo_controller::Configuration;
use oleo_interface::StrutValves;

/// A setting of the suspension.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// The vehicle as sold: coil springs and telescopic dampers.
    AsSold,
    /// The struts with their valves held.
    Fixed(StrutValves<bool>),
    /// The struts with valves held as `before` until `delay_s` after a manoeuvre began, and closed from then on. No controller can know
    /// when that is; this is a bound.
    Oracle {
        /// Open valves before.
        before: StrutValves<bool>,
        /// Delay of the decision, s.
        delay_s: f64,
    },
    /// The struts with a controller, and the name of its strategy.
    Controlled(&'static str, Box<Configuration>),
}

impl Setting {
    /// All valves open.
    pub const SOFT: Self = Self::Fixed(StrutValves::splat(true));
    /// All valves closed.
    pub const STIFF: Self = Self::Fixed(StrutValves::splat(false));

    /// The eight combinations of three valves, the same at all corners, from all closed to all open.
    pub fn all_fixed() -> [Self; 8] {
        core::array::from_fn(|bits| {
            let open = |valve: usize| bits >> valve & 1 == 1;
            Self::Fixed(StrutValves::new(open(0), open(1), open(2)))
        })
    }

    /// Short name: `as-sold`, the open valves as in `open-23`, `soft`, `stiff`, or the controller's strategy.
    pub fn name(&self) -> String {
        match self {
            Self::AsSold => "as-sold".into(),
            Self::Fixed(_) if *self == Self::SOFT => "soft".into(),
            Self::Fixed(_) if *self == Self::STIFF => "stiff".into(),
            Self::Fixed(open) => {
                let numbers = (1..=3).zip(open.into_array()).filter(|(_, open)| *open);
                numbers.fold("open-".into(), |name, (number, _)| format!("{name}{number}"))
            }
            Self::Oracle { delay_s, .. } => format!("oracle-{delay_s}-s"),
            Self::Controlled(strategy, _) => (*strategy).into(),
        }
    }
}
