//! The two paths of oil between the main chamber and the accumulators.

use oleo_interface::Valve;

/// A path of oil between the main chamber and an accumulator.
///
/// ```
/// use oleo_interface::Valve;
/// use oleo_plant_sim::strut::{DamperLeakage, FlowPath};
/// let leak = DamperLeakage { flow_coefficient_1: 2.0e-8, flow_coefficient_2: 5.0e-8 };
/// assert_eq!(FlowPath::ALL.map(|path| leak.flow_coefficient(path)), [2.0e-8, 5.0e-8]);
/// assert_eq!(FlowPath::Two.bypass_valve(), Valve::Bypass2);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FlowPath {
    /// Through damper pack 1 and bypass valve 1 to accumulator 1 (0.1 l).
    One,
    /// Through damper pack 2, bypass valve 2 and valve 3 to accumulator 2 (0.4 l).
    Two,
}

impl FlowPath {
    /// Both paths, in the order of their numbers.
    pub const ALL: [Self; 2] = [Self::One, Self::Two];

    /// The bypass valve of this path.
    #[inline(always)]
    #[must_use]
    pub fn bypass_valve(self) -> Valve {
        self.pick(Valve::Bypass1, Valve::Bypass2)
    }

    /// Of two values, one for each path in their order, that of this path.
    #[inline(always)]
    #[must_use]
    pub fn of<T>(self, values: [T; 2]) -> T {
        let [one, two] = values;
        self.pick(one, two)
    }

    /// Of two values, that of this path.
    #[inline(always)]
    #[must_use]
    pub fn pick<T>(self, one: T, two: T) -> T {
        match self {
            Self::One => one,
            Self::Two => two,
        }
    }
}
