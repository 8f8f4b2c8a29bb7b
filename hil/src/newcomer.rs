//! Tells a partner that was started again from a stray `Hello`.

/// Number of times that a partner must say `Hello`, without a sign of life of the one before it, until it is believed: 100 ms.
const BELIEVED: u8 = 3;

/// A node that says `Hello` in the middle of a run, with a number that is not the partner's.
#[derive(Debug, Default)]
pub struct Newcomer {
    number: u16,
    hellos: u8,
}

impl Newcomer {
    /// Takes a `Hello`. Returns whether its sender is believed to be the partner, started again.
    pub fn hello(&mut self, number: u16) -> bool {
        if self.hellos == 0 || self.number != number {
            *self = Self { number, hellos: 0 };
        }
        self.hellos += 1;
        self.hellos >= BELIEVED
    }

    /// The partner is there.
    pub fn dismiss(&mut self) {
        self.hellos = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_believed_when_it_insists_and_the_partner_is_silent() {
        let mut newcomer = Newcomer::default();
        assert_eq!(
            [5, 5, 6, 5, 5, 5].map(|number| newcomer.hello(number)),
            [false, false, false, false, false, true]
        );
        newcomer.dismiss();
        assert!(!newcomer.hello(5) && !newcomer.hello(5));
        newcomer.dismiss();
        assert!(!newcomer.hello(5) && !newcomer.hello(5) && newcomer.hello(5));
    }
}
