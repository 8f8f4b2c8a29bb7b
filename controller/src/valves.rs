//! The positions of the twelve valves as one word.
//!
//! Everything that decides, sends, checks or drives valves speaks of the same twelve bits, so the word and its order
//! are defined once, here. The word without a set bit is what a dead controller commands: it is the safe state.

use oleo_interface::{Corner, Corners, StrutValves, Valve};

/// Number of valves.
pub(crate) const VALVES: usize = 12;

/// The bits that are set in a word, each with its place, from the lowest. The number of steps is that of the bits: a loop over all
/// twelve valves would be unrolled into as many copies of its body.
pub(crate) fn bits(word: u16) -> impl Iterator<Item = (usize, u16)> {
    let mut rest = word;
    core::iter::from_fn(move || {
        let bit = rest & rest.wrapping_neg();
        rest ^= bit;
        (bit != 0).then_some((bit.trailing_zeros() as usize, bit))
    })
}

/// The bits of the bypass valves 1 and 2 of every strut.
pub(crate) const BYPASS_BITS: u16 = 0b011_011_011_011;
/// The bits of bypass valve 2 of every strut.
pub(crate) const BYPASS2_BITS: u16 = 0b010_010_010_010;
/// The bits of valve 3 of every strut.
pub(crate) const SPRING_BITS: u16 = 0b100_100_100_100;

/// Commanded positions of the twelve valves: bit `3 * corner + valve`, 1 open (energised), 0 closed.
///
/// ```
/// use oleo_controller::{Corner, Valve, ValveCommand};
/// let soft_front_left = ValveCommand::SAFE.with(Corner::FrontLeft, Valve::Spring, true);
/// assert_eq!(soft_front_left.word(), 0b100);
/// assert!(soft_front_left.is_open(Corner::FrontLeft, Valve::Spring));
/// assert!(!soft_front_left.is_open(Corner::FrontRight, Valve::Spring));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ValveCommand(u16);

impl ValveCommand {
    /// All valves closed (de-energised): stiff spring, high damping.
    pub const SAFE: Self = Self(0);
    /// All valves open: soft spring, low damping.
    pub const SOFT: Self = Self(0x0FFF);

    /// From the 12-bit word; higher bits are ignored.
    pub const fn from_word(word: u16) -> Self {
        Self(word & 0x0FFF)
    }

    /// The 12-bit word, 0 to 0xFFF.
    pub const fn word(self) -> u16 {
        self.0
    }

    /// From a function that says whether a valve is open.
    pub fn from_fn(mut is_open: impl FnMut(Corner, Valve) -> bool) -> Self {
        Self::from_corners(Corners::from_fn(|corner| {
            StrutValves::from_fn(|valve| is_open(corner, valve))
        }))
    }

    /// From the switching signals of all struts.
    pub fn from_corners(corners: Corners<StrutValves<bool>>) -> Self {
        let mut word = 0;
        for (bit, open) in corners
            .into_array()
            .map(StrutValves::into_array)
            .as_flattened()
            .iter()
            .enumerate()
        {
            word |= u16::from(*open) << bit;
        }
        Self(word)
    }

    /// Place of a valve's bit in the word, 0 to 11.
    pub const fn bit(corner: Corner, valve: Valve) -> usize {
        3 * corner.index() + valve.index()
    }

    /// Whether a valve is commanded open.
    pub const fn is_open(self, corner: Corner, valve: Valve) -> bool {
        self.0 >> Self::bit(corner, valve) & 1 == 1
    }

    /// The same command with one valve changed.
    #[must_use]
    pub const fn with(self, corner: Corner, valve: Valve, open: bool) -> Self {
        let mask = 1 << Self::bit(corner, valve);
        if open {
            Self(self.0 | mask)
        } else {
            Self(self.0 & !mask)
        }
    }

    /// The switching signals of one strut.
    pub const fn strut(self, corner: Corner) -> StrutValves<bool> {
        StrutValves::new(
            self.is_open(corner, Valve::Bypass1),
            self.is_open(corner, Valve::Bypass2),
            self.is_open(corner, Valve::Spring),
        )
    }

    /// The switching signals of all struts.
    pub fn corners(self) -> Corners<StrutValves<bool>> {
        Corners::from_fn(|corner| self.strut(corner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn word_order_is_corner_then_valve() {
        let mut bit = 0;
        for corner in Corner::ALL {
            for valve in Valve::ALL {
                let one = ValveCommand::SAFE.with(corner, valve, true);
                assert_eq!((one.word(), ValveCommand::bit(corner, valve)), (1 << bit, bit));
                assert!(one.is_open(corner, valve));
                assert_eq!(ValveCommand::from_corners(one.corners()), one);
                assert_eq!(ValveCommand::from_fn(|c, v| (c, v) == (corner, valve)), one);
                assert_eq!(one.with(corner, valve, false), ValveCommand::SAFE);
                bit += 1;
            }
        }
    }

    #[test]
    fn bits_beyond_the_twelve_are_ignored() {
        assert_eq!(ValveCommand::from_word(0xFFFF), ValveCommand::SOFT);
        assert_eq!(ValveCommand::from_word(0xF000), ValveCommand::SAFE);
    }
}
