//! Damping characteristics by sines of 25 mm, with the frequency varied to vary the speed, the force calculated from the
//! pressure readings (report, 3.5.2 and figure 23).
//!
//! A pressure reading holds spring and damper. At mid-stroke, where the speed is greatest, the damper's part is what p1
//! exceeds the pressure that both accumulators would settle at, `F = A (p1 - (V1 p2 + V2 p4) / (V1 + V2))`, V the gas volumes;
//! with valve 3 closed accumulator 2 is not connected and p2 stands alone. This is also the force that dissipates what both paths
//! dissipate while the flows divide as the volumes do.

use oleo_interface::StrutValves;

use crate::model_file::InvalidValue;
use crate::strut::StrutModel;
use crate::strut_first::Damping;

use super::programme::{Programme, play};

/// Amplitude of the sines, m: the report's 25 mm (50 mm stroke).
const AMPLITUDE_M: f64 = 0.025;
/// Cycles played, of which the last is measured: the gas has then warmed to its cycle, and steps have died away.
const CYCLES: usize = 6;
const PER_CYCLE: usize = 240;

/// A setting of the three valves as it was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DampingState {
    /// Which of the three levels.
    pub damping: Damping,
}

impl DampingState {
    /// The three states of figure 23.
    pub const ALL: [Self; 3] = [
        Self { damping: Damping::Low },
        Self {
            damping: Damping::HighSoft,
        },
        Self {
            damping: Damping::HighStiff,
        },
    ];

    /// Name as the report has it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.damping {
            Damping::Low => "low (both dampers bypassed)",
            Damping::HighSoft => "high (no bypass), soft spring",
            Damping::HighStiff => "high (no bypass), stiff spring",
        }
    }

    /// Switching signals, true for open.
    #[must_use]
    pub fn signals(self) -> StrutValves<bool> {
        match self.damping {
            Damping::Low => StrutValves::new(true, true, true),
            Damping::HighSoft => StrutValves::new(false, false, true),
            Damping::HighStiff => StrutValves::new(false, false, false),
        }
    }
}

/// Damper force at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampingPoint {
    /// Frequency of the sine, Hz.
    pub frequency_hz: f64,
    /// Speed at mid-stroke, m/s.
    pub speed_m_s: f64,
    /// Damper force in jounce, N, positive.
    pub jounce_n: f64,
    /// Damper force in rebound, N, negative.
    pub rebound_n: f64,
    /// Lowest p1 of the cycle, Pa gauge: below -0.1 MPa oil would part.
    pub lowest_p1_pa: f64,
}

/// Measures one state at the given greatest speeds, m/s.
///
/// # Errors
/// Impossible values in the model.
pub fn measure_damping(
    model: &StrutModel,
    state: DampingState,
    speeds_m_s: &[f64],
) -> Result<Vec<DampingPoint>, InvalidValue> {
    let area_m2 = model.piston_area_m2();
    let volumes = [
        model.accumulator[0].static_gas_volume_m3,
        model.accumulator[1].static_gas_volume_m3,
    ];
    let connected = if state.damping == Damping::HighStiff {
        [volumes[0], 0.0]
    } else {
        volumes
    };
    let measure = |&speed_m_s: &f64| {
        let frequency_hz = speed_m_s / (std::f64::consts::TAU * AMPLITUDE_M);
        let programme = Programme::sine(AMPLITUDE_M, frequency_hz, CYCLES, PER_CYCLE, state.signals());
        let record = play(model, &programme)?;
        let damper_n = |at: usize| {
            let [p1, p2, _, p4] = [0, 1, 2, 3].map(|i| record.pressure_pa[i][at]);
            let settled = (connected[0] * p2 + connected[1] * p4) / (connected[0] + connected[1]);
            area_m2 * (p1 - settled)
        };
        let last = (CYCLES - 1) * PER_CYCLE;
        Ok(DampingPoint {
            frequency_hz,
            speed_m_s,
            jounce_n: damper_n(last),
            rebound_n: damper_n(last + PER_CYCLE / 2),
            lowest_p1_pa: record.pressure_pa[0][last..]
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min),
        })
    };
    speeds_m_s.iter().map(measure).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::DamperLeakage;
    use crate::strut_first::Characteristics;

    const SPEEDS_M_S: [f64; 3] = [0.1, 0.3, 0.6];

    fn measured(model: &StrutModel) -> [Vec<DampingPoint>; 3] {
        DampingState::ALL.map(|state| measure_damping(model, state, &SPEEDS_M_S).expect("possible"))
    }

    #[test]
    fn damper_1_alone_measures_as_its_table() {
        let model = StrutModel::defender110(8000.0);
        let table = Characteristics::of(&model).expect("possible");
        let table = table.damping(Damping::HighStiff);
        for point in &measured(&model)[2] {
            for (force, speed) in [(point.jounce_n, point.speed_m_s), (point.rebound_n, -point.speed_m_s)] {
                let truth = table.at(speed);
                // The oil's compressibility holds back a little of the flow.
                assert!(
                    (force / truth - 1.0).abs() < 0.05,
                    "{force} N, table {truth} N at {speed} m/s"
                );
            }
        }
    }

    #[test]
    fn three_discrete_levels() {
        let [low, soft, stiff] = measured(&StrutModel::defender110(8000.0));
        for ((low, soft), stiff) in low.iter().zip(&soft).zip(&stiff) {
            assert!(0.0 < low.jounce_n && 1.5 * low.jounce_n < soft.jounce_n && soft.jounce_n < stiff.jounce_n);
            assert!(0.0 > low.rebound_n && 1.5 * low.rebound_n > soft.rebound_n && soft.rebound_n > stiff.rebound_n);
        }
    }

    #[test]
    fn leaking_packs_lower_the_high_levels_and_keep_three() {
        let model = StrutModel::defender110(8000.0);
        let mut leaking = model.clone();
        leaking.effects.damper_leakage = Some(DamperLeakage {
            flow_coefficient_1: 8e-7,
            flow_coefficient_2: 8e-7,
        });
        let (tight, leak) = (measured(&model), measured(&leaking));
        for at in 0..SPEEDS_M_S.len() {
            let ratio = |level: usize| leak[level][at].jounce_n / tight[level][at].jounce_n;
            assert!(ratio(1) < 0.85 && ratio(2) < 0.85 && ratio(0) > ratio(1));
            assert!(leak[0][at].jounce_n < leak[1][at].jounce_n && leak[1][at].jounce_n < leak[2][at].jounce_n);
        }
    }
}
