//! The twelve valves, as one word.
//!
//! Everything that decides, sends, checks or drives valves speaks of the same twelve bits, so the word and its order
//! are defined once, here. The word with no bit set is what a dead controller commands: it is the safe state.

/// Number of corners: 0 front left, 1 front right, 2 rear left, 3 rear right.
pub const CORNERS: usize = 4;

/// Valves of one strut: index 0 and 1 bypass dampers 1 and 2 (open: low damping), index 2 connects the 0.4 l accumulator
/// (open: soft spring). The report counts them 1 to 3.
pub const VALVES: usize = 3;

/// Index of the bypass valve of damper 1.
pub const BYPASS_1: usize = 0;
/// Index of the bypass valve of damper 2. It has no effect while the spring valve is closed (report, figure 10).
pub const BYPASS_2: usize = 1;
/// Index of valve 3, which connects the large accumulator.
pub const SPRING: usize = 2;

/// Valve positions of all four struts: bit `3 * corner + valve`, 1 open (energised), 0 closed.
///
/// ```
/// use oleo_controller::ValveCommand;
/// let soft_front_left = ValveCommand::SAFE.with(0, 2, true);
/// assert_eq!(soft_front_left.word(), 0b100);
/// assert!(soft_front_left.valve(0, 2) && !soft_front_left.valve(1, 2));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
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

    /// The 12-bit word.
    pub const fn word(self) -> u16 {
        self.0
    }

    const fn mask(corner: usize, valve: usize) -> u16 {
        if corner < CORNERS && valve < VALVES {
            1 << (VALVES * corner + valve)
        } else {
            0
        }
    }

    /// Whether a valve is commanded open. `false` for a corner or valve that does not exist.
    pub const fn valve(self, corner: usize, valve: usize) -> bool {
        self.0 & Self::mask(corner, valve) != 0
    }

    /// The same command with one valve changed; unchanged for a corner or valve that does not exist.
    pub const fn with(self, corner: usize, valve: usize, open: bool) -> Self {
        let mask = Self::mask(corner, valve);
        if open {
            Self(self.0 | mask)
        } else {
            Self(self.0 & !mask)
        }
    }

    /// The switching signals of one strut, in valve order.
    pub const fn corner(self, corner: usize) -> [bool; VALVES] {
        [
            self.valve(corner, BYPASS_1),
            self.valve(corner, BYPASS_2),
            self.valve(corner, SPRING),
        ]
    }

    /// The switching signals of all struts.
    pub const fn corners(self) -> [[bool; VALVES]; CORNERS] {
        [self.corner(0), self.corner(1), self.corner(2), self.corner(3)]
    }

    /// From the switching signals of all struts.
    pub fn from_corners(corners: [[bool; VALVES]; CORNERS]) -> Self {
        let mut word = 0;
        for (shift, open) in corners.into_iter().flatten().enumerate() {
            word |= u16::from(open) << shift;
        }
        Self(word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn word_order_is_corner_then_valve() {
        for corner in 0..CORNERS {
            for valve in 0..VALVES {
                let one = ValveCommand::SAFE.with(corner, valve, true);
                assert_eq!(one.word(), 1 << (3 * corner + valve));
                assert_eq!(ValveCommand::from_corners(one.corners()), one);
                assert_eq!(one.with(corner, valve, false), ValveCommand::SAFE);
            }
        }
    }

    #[test]
    fn what_does_not_exist_cannot_be_opened() {
        assert_eq!(ValveCommand::SAFE.with(4, 0, true), ValveCommand::SAFE);
        assert_eq!(ValveCommand::SAFE.with(0, 3, true), ValveCommand::SAFE);
        assert_eq!(ValveCommand::from_word(0xFFFF), ValveCommand::SOFT);
    }
}
