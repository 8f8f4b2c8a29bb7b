//! An unmodelled law at the main seal as the solver reads it.

use super::argument::LawArgument;
use super::law::UnlistedLaw;
use super::place::LawPlace;
use crate::strut::characteristic::Characteristic;

/// A force or a friction between rod and cylinder, N, over displacement, speed or p1.
#[derive(Debug, Clone)]
pub(in crate::strut) struct SealLaw {
    argument: LawArgument,
    table: Characteristic,
}

impl SealLaw {
    /// The law at a place of the seal, if there is one.
    pub fn at(laws: &[UnlistedLaw], place: LawPlace) -> Option<Self> {
        laws.iter().find(|law| law.place == place).map(|law| Self {
            argument: law.depends_on,
            table: law.characteristic(),
        })
    }

    /// Value of the law, N, at a displacement (m), a speed (m/s) and a gauge pressure p1 (Pa).
    pub fn value_n(&self, displacement_m: f64, speed_m_s: f64, p1_pa: f64) -> f64 {
        self.table.value(match self.argument {
            LawArgument::Displacement => displacement_m,
            LawArgument::Speed => speed_m_s,
            _ => p1_pa,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_quantity_that_it_depends_on() {
        for (depends_on, value) in [
            (LawArgument::Displacement, 1.0),
            (LawArgument::Speed, 2.0),
            (LawArgument::P1, 3.0),
        ] {
            let laws = [UnlistedLaw {
                place: LawPlace::MainSealFriction,
                depends_on,
                argument: vec![0.0, 10.0],
                value: vec![0.0, 10.0],
            }];
            let law = SealLaw::at(&laws, LawPlace::MainSealFriction).unwrap();
            assert_eq!(law.value_n(1.0, 2.0, 3.0), value);
            assert!(SealLaw::at(&laws, LawPlace::MainSeal).is_none());
        }
    }
}
