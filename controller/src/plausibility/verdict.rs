//! The faults that the checks found in the readings of one strut.

use oleo_interface::PressurePoint;

use crate::failsafe::FaultCode;

/// Bits of a cause, of which the highest is not used: it is the borrow of a comparison (see [`Verdicts::graver`]).
const CAUSE_BITS: u32 = 5;
/// The lowest bit of each of the five causes.
const LOWEST: u32 = 0b00001_00001_00001_00001_00001;
/// All bits of one cause that are used.
const CAUSE: u32 = 0b01111;

const _: () = assert!(FaultCode::Internal.raw() as u32 <= CAUSE, "a cause must fit");

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

/// A cause for each reading of a strut, [`FaultCode::None`] for a good one: a few bits each, so that "nothing is wrong" is one
/// comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Verdicts(u32);

impl Verdicts {
    /// Nothing is wrong.
    pub const GOOD: Self = Self(0);

    /// Whether nothing was found about a reading.
    pub const fn is_good(self, place: Place) -> bool {
        self.0 >> place.0 & CAUSE == 0
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
        self.ones() * CAUSE
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

    /// A one in each place in which there is a cause. Up to 31 of these may be added.
    const fn ones(self) -> u32 {
        let pairs = self.0 | self.0 >> 1;
        (pairs | pairs >> 2) & LOWEST
    }

    /// The number of causes in several verdicts, 0 to 20 in those of a vehicle.
    pub fn count(all: &[Self]) -> u8 {
        let ones: u32 = all.iter().map(|verdicts| verdicts.ones()).sum();
        // The product sums the places up in the fifth one.
        (ones.wrapping_mul(LOWEST) >> (4 * CAUSE_BITS) & 0x1F) as u8
    }

    /// The graver cause of two for each reading.
    const fn graver(self, other: Self) -> Self {
        // The unused bit of each place stays where nothing has to be borrowed from it: where our cause is not the lesser one. Less its
        // lowest bit, it covers the place.
        let not_less = ((self.0 | LOWEST << (CAUSE_BITS - 1)) - other.0) & LOWEST << (CAUSE_BITS - 1);
        let ours = not_less - (not_less >> (CAUSE_BITS - 1));
        Self(self.0 & ours | other.0 & !ours)
    }

    /// The gravest of the causes in several verdicts.
    pub fn gravest(all: &[Self]) -> FaultCode {
        let Self(all) = all
            .iter()
            .fold(Self::GOOD, |gravest, verdicts| gravest.graver(*verdicts));
        let at = |place: Place| all >> place.0 & CAUSE;
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
                assert_eq!(
                    (Verdicts::gravest(&[verdicts]), Verdicts::count(&[verdicts])),
                    (cause, u8::from(found))
                );
                verdicts.blame(place, FaultCode::Internal);
                assert_eq!(
                    Verdicts::gravest(&[verdicts]),
                    if found { cause } else { FaultCode::Internal }
                );
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
            assert_eq!(usize::from(Verdicts::count(&[later])), n);
            later.blame(place, FaultCode::MessageLost);
        }
        let both = first.or(later);
        assert_eq!(
            (Verdicts::count(&[both]), Verdicts::gravest(&[both])),
            (5, FaultCode::MessageLost)
        );
        let only_where_good = first.select(Verdicts::GOOD, later);
        assert_eq!(
            (Verdicts::count(&[only_where_good]), only_where_good.is_good(Place::P2)),
            (4, true)
        );
        assert_eq!(Verdicts::GOOD.or(first), first);
    }

    /// Of every pair of causes at every pair of readings the graver one is told, and both are counted.
    #[test]
    fn the_gravest_of_several_is_told_and_all_are_counted() {
        for place in PLACES {
            for other in PLACES {
                for &cause in FaultCode::VARIANTS {
                    for &second in FaultCode::VARIANTS {
                        let mut verdicts = [Verdicts::GOOD; 4];
                        let [first, _, third, _] = &mut verdicts;
                        first.blame(place, cause);
                        third.blame(other, second);
                        let found = [cause, second]
                            .iter()
                            .filter(|cause| **cause != FaultCode::None)
                            .count();
                        assert_eq!(Verdicts::gravest(&verdicts), cause.max(second), "{place:?} {other:?}");
                        assert_eq!(usize::from(Verdicts::count(&verdicts)), found);
                    }
                }
            }
        }
        let mut all = Verdicts::GOOD;
        PLACES
            .into_iter()
            .for_each(|place| all.blame(place, FaultCode::Internal));
        assert_eq!(
            (Verdicts::count(&[all; 4]), Verdicts::gravest(&[all; 4])),
            (20, FaultCode::Internal)
        );
    }
}
