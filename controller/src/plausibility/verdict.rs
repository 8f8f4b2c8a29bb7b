//! The faults that the checks found in the readings of one strut.

use oleo_interface::PressurePoint;

use crate::failsafe::FaultCode;

/// Bits of a cause.
const CAUSE_BITS: u32 = 4;
/// The lowest bit of each of the five causes.
const LOWEST: u32 = 0x1_1111;

const _: () = assert!(FaultCode::Internal.raw() < 1 << CAUSE_BITS, "a cause must fit");

/// One of the five readings of a strut: the place of its cause among the verdicts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place(u32);

impl Place {
    /// The displacement.
    pub const DISPLACEMENT: Self = Self(0);
    /// The pressures p1 to p4.
    pub const P1: Self = Self::of(PressurePoint::P1);
    pub const P2: Self = Self::of(PressurePoint::P2);
    pub const P3: Self = Self::of(PressurePoint::P3);
    pub const P4: Self = Self::of(PressurePoint::P4);

    /// A pressure.
    pub const fn of(point: PressurePoint) -> Self {
        Self(CAUSE_BITS * (1 + point.index() as u32))
    }
}

/// A cause for each reading of a strut, [`FaultCode::None`] for a good one: four bits each, so that "nothing is wrong" is one
/// comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verdicts(u32);

impl Verdicts {
    /// Nothing is wrong.
    pub const GOOD: Self = Self(0);

    /// Whether nothing was found about a reading.
    pub const fn is_good(self, place: Place) -> bool {
        self.0 >> place.0 & 0xF == 0
    }

    /// Whether nothing was found about any pressure.
    pub const fn pressures_are_good(self) -> bool {
        self.0 >> Place::P1.0 == 0
    }

    /// Notes a cause, unless an earlier check has found one.
    pub fn blame(&mut self, place: Place, cause: FaultCode) {
        if self.is_good(place) {
            self.0 |= u32::from(cause.raw()) << place.0;
        }
    }

    /// From the causes of all readings.
    pub fn of(displacement: FaultCode, [p1, p2, p3, p4]: [FaultCode; 4]) -> Self {
        let at = |place: Place, cause: FaultCode| u32::from(cause.raw()) << place.0;
        Self(
            at(Place::DISPLACEMENT, displacement)
                | at(Place::P1, p1)
                | at(Place::P2, p2)
                | at(Place::P3, p3)
                | at(Place::P4, p4),
        )
    }

    /// All bits of the causes that are not [`FaultCode::None`].
    const fn found(self) -> u32 {
        let pairs = self.0 | self.0 >> 1;
        ((pairs | pairs >> 2) & LOWEST) * 0xF
    }

    /// These causes, and those of later checks where there is none.
    pub const fn or(self, later: Self) -> Self {
        self.select(self, later)
    }

    /// For each reading, one of two causes: `faulty` where this names a cause, `good` where it names none.
    pub const fn select(self, faulty: Self, good: Self) -> Self {
        let found = self.found();
        Self(faulty.0 & found | good.0 & !found)
    }

    /// Number of causes, 0 to 5.
    pub const fn count(self) -> u8 {
        // The product sums the lowest bits up in its fifth place.
        ((self.found() & LOWEST).wrapping_mul(LOWEST) >> (4 * CAUSE_BITS) & 0xF) as u8
    }

    /// The gravest of the causes.
    pub fn gravest(self) -> FaultCode {
        let at = |place: Place| self.0 >> place.0 & 0xF;
        let pressures = at(Place::P1).max(at(Place::P2)).max(at(Place::P3)).max(at(Place::P4));
        let gravest = at(Place::DISPLACEMENT).max(pressures);
        FaultCode::from_repr(gravest as u8).unwrap_or(FaultCode::Internal)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use strum::VariantArray;

    const PLACES: [Place; 5] = [Place::DISPLACEMENT, Place::P1, Place::P2, Place::P3, Place::P4];

    #[test]
    fn the_first_cause_of_each_reading_is_kept() {
        for (n, place) in PLACES.into_iter().enumerate() {
            for &cause in FaultCode::VARIANTS {
                let mut verdicts = Verdicts::GOOD;
                verdicts.blame(place, cause);
                let found = cause != FaultCode::None;
                assert_eq!((verdicts.gravest(), verdicts.count()), (cause, u8::from(found)));
                verdicts.blame(place, FaultCode::Internal);
                assert_eq!(verdicts.gravest(), if found { cause } else { FaultCode::Internal });
                for (m, other) in PLACES.into_iter().enumerate() {
                    assert_eq!(verdicts.is_good(other), n != m);
                }
                assert_eq!(verdicts.pressures_are_good(), n == 0);
            }
        }
    }

    #[test]
    fn causes_stand_in_their_places() {
        let mut one_by_one = Verdicts::GOOD;
        let causes = [
            FaultCode::None,
            FaultCode::SensorRate,
            FaultCode::Internal,
            FaultCode::SensorRange,
        ];
        for (place, cause) in PLACES
            .into_iter()
            .zip([&[FaultCode::MessageLost][..], &causes].concat())
        {
            one_by_one.blame(place, cause);
        }
        assert_eq!(Verdicts::of(FaultCode::MessageLost, causes), one_by_one);
    }

    #[test]
    fn later_checks_fill_the_gaps_and_all_are_counted() {
        let (mut first, mut later) = (Verdicts::GOOD, Verdicts::GOOD);
        first.blame(Place::P2, FaultCode::SensorRange);
        for (n, place) in PLACES.into_iter().enumerate() {
            assert_eq!(usize::from(later.count()), n);
            later.blame(place, FaultCode::MessageLost);
        }
        let both = first.or(later);
        assert_eq!((both.count(), both.gravest()), (5, FaultCode::MessageLost));
        let only_where_good = first.select(Verdicts::GOOD, later);
        assert_eq!((only_where_good.count(), only_where_good.is_good(Place::P2)), (4, true));
        assert_eq!(Verdicts::GOOD.or(first), first);
    }
}
