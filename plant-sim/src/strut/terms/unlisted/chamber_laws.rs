//! The unmodelled laws of the main chamber, and of the mount that makes it larger, as the solver reads them.

use super::argument::LawArgument;
use super::course::Course;
use super::law::{UnlistedLaw, law_at};
use super::place::LawPlace;
use crate::strut::characteristic::Characteristic;

/// The laws of the main chamber over p1 (gauge, Pa) and time (s), and that of the mount over its force (N).
#[derive(Debug, Clone, Default)]
pub(in crate::strut) struct ChamberLaws {
    volume: Option<Characteristic>,
    loss: Option<Characteristic>,
    loss_in_time: Course,
    mount: Option<Characteristic>,
}

impl ChamberLaws {
    /// The laws of the chamber.
    pub fn of(laws: &[UnlistedLaw]) -> Self {
        Self {
            volume: law_at(laws, LawPlace::MainChamber, LawArgument::P1),
            loss: law_at(laws, LawPlace::MainChamberLoss, LawArgument::P1),
            loss_in_time: Course::at(laws, LawPlace::MainChamberLoss),
            mount: law_at(laws, LawPlace::Mount, LawArgument::Force),
        }
    }

    /// Volume taken up at a gauge pressure, m3, and its derivative, m3/Pa, if there is such a law.
    #[inline]
    pub fn volume(&self, p1_pa: f64) -> Option<(f64, f64)> {
        self.volume.as_ref().map(|law| law.at(p1_pa, &mut 0))
    }

    /// By how much the mount yields under a force above the static one (N), m, and its derivative, m/N, if there is such a law.
    #[inline]
    pub fn mount_m(&self, force_n: f64) -> Option<(f64, f64)> {
        self.mount.as_ref().map(|law| law.at(force_n, &mut 0))
    }

    /// Flow lost at a gauge pressure and a time, m3/s.
    #[inline]
    pub fn loss(&self, p1_pa: f64, time_s: f64) -> f64 {
        self.loss.as_ref().map_or(0.0, |law| law.value(p1_pa)) + self.loss_in_time.sum(time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_law_reads_its_own_table() {
        let law = |place, depends_on, value: [f64; 2]| UnlistedLaw {
            place,
            depends_on,
            argument: vec![0.0, 1e7],
            value: value.to_vec(),
            time_constant_s: None,
            frequency_hz: None,
            presliding_volume_m3: None,
            attraction: None,
        };
        let laws = ChamberLaws::of(&[law(LawPlace::MainChamber, LawArgument::P1, [0.0, 1e-5])]);
        let (volume, slope) = laws.volume(5e6).unwrap();
        assert!((volume - 5e-6).abs() < 1e-18 && (slope - 1e-12).abs() < 1e-24 && laws.loss(5e6, 5e6) == 0.0);
        let [p1, time] = [LawArgument::P1, LawArgument::Time]
            .map(|over| ChamberLaws::of(&[law(LawPlace::MainChamberLoss, over, [0.0, 1e-8])]));
        assert!((p1.loss(5e6, 0.0) - 5e-9).abs() < 1e-20 && p1.volume(5e6).is_none());
        assert!((time.loss(0.0, 5e6) - 5e-9).abs() < 1e-20);
    }
}
