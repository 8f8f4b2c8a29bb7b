//! The unmodelled laws of the main chamber, and of the mount that makes it larger, as the solver reads them.

use super::argument::LawArgument;
use super::course::Course;
use super::law::UnlistedLaw;
use super::law_table::LawTable;
use super::place::LawPlace;
use crate::lanes::Number;

/// The laws of the main chamber over p1 (gauge, Pa) and time (s), and that of the mount over its force (N); of one strut, or of several side by
/// side.
#[derive(Debug, Clone)]
pub(in crate::strut) struct ChamberLaws<N: Number = f64> {
    volume: LawTable<N>,
    loss: LawTable<N>,
    loss_in_time: Course<N>,
    mount: LawTable<N>,
}

impl ChamberLaws {
    /// The laws of the chamber.
    pub fn of(laws: &[UnlistedLaw]) -> Self {
        Self {
            volume: LawTable::at_place(laws, LawPlace::MainChamber, LawArgument::P1),
            loss: LawTable::at_place(laws, LawPlace::MainChamberLoss, LawArgument::P1),
            loss_in_time: Course::at(laws, LawPlace::MainChamberLoss),
            mount: LawTable::at_place(laws, LawPlace::Mount, LawArgument::Force),
        }
    }

    /// Those of several struts side by side, `like` any number of their kind.
    pub fn abreast<N: Number>(each: &N::Each<&Self>, like: N) -> ChamberLaws<N> {
        let all = each.as_ref();
        let table = |of: fn(&Self) -> &LawTable| LawTable::abreast(&N::each(|lane| of(all[lane])));
        ChamberLaws {
            volume: table(|laws| &laws.volume),
            loss: table(|laws| &laws.loss),
            loss_in_time: Course::abreast(&N::each(|lane| &all[lane].loss_in_time), like),
            mount: table(|laws| &laws.mount),
        }
    }
}

impl<N: Number> ChamberLaws<N> {
    /// Volume taken up at a gauge pressure, m3, and its derivative, m3/Pa, if there is such a law.
    #[inline(always)]
    pub fn volume(&self, p1_pa: N) -> Option<(N, N)> {
        self.volume.added(p1_pa)
    }

    /// By how much the mount yields under a force above the static one (N), m, and its derivative, m/N, if there is such a law.
    #[inline(always)]
    pub fn mount_m(&self, force_n: N) -> Option<(N, N)> {
        self.mount.added(force_n)
    }

    /// Flow lost at a gauge pressure and a time, m3/s.
    #[inline(always)]
    pub fn loss(&self, p1_pa: N, time_s: N) -> N {
        let by_pressure = self.loss.amount(p1_pa).unwrap_or(p1_pa.of(0.0));
        by_pressure + self.loss_in_time.sum(time_s)
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
