//! The unmodelled laws of the main chamber as the solver reads them.

use super::argument::LawArgument;
use super::law::{UnlistedLaw, law_at};
use super::place::LawPlace;
use crate::strut::characteristic::Characteristic;

/// The laws of the main chamber over p1 (gauge, Pa).
#[derive(Debug, Clone, Default)]
pub(in crate::strut) struct ChamberLaws {
    volume: Option<Characteristic>,
    loss: Option<Characteristic>,
}

impl ChamberLaws {
    /// The laws of the chamber.
    pub fn of(laws: &[UnlistedLaw]) -> Self {
        Self {
            volume: law_at(laws, LawPlace::MainChamber, LawArgument::P1),
            loss: law_at(laws, LawPlace::MainChamberLoss, LawArgument::P1),
        }
    }

    /// Volume taken up at a gauge pressure, m3, and its derivative, m3/Pa, if there is such a law.
    #[inline]
    pub fn volume(&self, p1_pa: f64) -> Option<(f64, f64)> {
        self.volume.as_ref().map(|law| law.at(p1_pa, &mut 0))
    }

    /// Flow lost at a gauge pressure, m3/s, if there is such a law.
    #[inline]
    pub fn loss(&self, p1_pa: f64) -> Option<f64> {
        self.loss.as_ref().map(|law| law.value(p1_pa))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_law_reads_its_own_table() {
        let law = |place, value: [f64; 2]| UnlistedLaw {
            place,
            depends_on: LawArgument::P1,
            argument: vec![0.0, 1e7],
            value: value.to_vec(),
        };
        let laws = ChamberLaws::of(&[law(LawPlace::MainChamber, [0.0, 1e-5])]);
        let (volume, slope) = laws.volume(5e6).unwrap();
        assert!((volume - 5e-6).abs() < 1e-18 && (slope - 1e-12).abs() < 1e-24 && laws.loss(5e6).is_none());
        let laws = ChamberLaws::of(&[law(LawPlace::MainChamberLoss, [0.0, 1e-8])]);
        assert!((laws.loss(5e6).unwrap() - 5e-9).abs() < 1e-20 && laws.volume(5e6).is_none());
    }
}
