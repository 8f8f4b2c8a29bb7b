//! An unmodelled law at the main seal as the solver reads it.

use super::argument::LawArgument;
use super::course::phase;
use super::law::UnlistedLaw;
use super::place::LawPlace;
use crate::strut::characteristic::Characteristic;
use crate::strut::rod_state::RodState;

/// A force or a friction between rod and cylinder, N.
#[derive(Debug, Clone)]
pub(in crate::strut) struct SealLaw {
    argument: LawArgument,
    table: Characteristic,
    frequency_hz: f64,
}

impl SealLaw {
    /// The laws at a place of the seal, at most one for each argument.
    pub fn all_at(laws: &[UnlistedLaw], place: LawPlace) -> Vec<Self> {
        (laws.iter().filter(|law| law.place == place))
            .map(|law| Self {
                argument: law.depends_on,
                table: law.characteristic(),
                frequency_hz: law.frequency_hz.unwrap_or(0.0),
            })
            .collect()
    }

    /// Value of the law, N, in a state of the rod.
    pub fn value_n(&self, rod: &RodState) -> f64 {
        self.table.value(match self.argument {
            LawArgument::Displacement => rod.displacement_m,
            LawArgument::Speed => rod.speed_m_s,
            LawArgument::Acceleration => rod.acceleration.now_m_s2(),
            LawArgument::Time => rod.time_s,
            LawArgument::Phase => phase(self.frequency_hz, rod.time_s),
            _ => rod.p1_pa,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::rod_state::Acceleration;

    #[test]
    fn reads_the_quantity_that_it_depends_on() {
        let rod = RodState {
            displacement_m: 1.0,
            speed_m_s: 2.0,
            acceleration: Acceleration::default(),
            p1_pa: 3.0,
            oil_force_n: 0.0,
            time_s: 5.0,
        };
        for (depends_on, value) in [
            (LawArgument::Displacement, 1.0),
            (LawArgument::Speed, 2.0),
            (LawArgument::P1, 3.0),
            (LawArgument::Time, 5.0),
            // Two turns and a quarter.
            (LawArgument::Phase, 0.25),
        ] {
            let laws = [UnlistedLaw {
                place: LawPlace::MainSealFriction,
                depends_on,
                argument: vec![0.0, 10.0],
                value: vec![0.0, 10.0],
                time_constant_s: None,
                frequency_hz: (depends_on == LawArgument::Phase).then_some(0.45),
                presliding_volume_m3: None,
                attraction: None,
            }];
            let found = SealLaw::all_at(&laws, LawPlace::MainSealFriction);
            assert!(found.len() == 1 && (found[0].value_n(&rod) - value).abs() < 1e-12);
            assert!(SealLaw::all_at(&laws, LawPlace::MainSeal).is_empty());
        }
    }
}
