//! The report's first-generation model beside the strut that stands for its test rig: the illustrative run of figures 31 to
//! 33, and the comparison of spring forces of figure 34.

use oleo_interface::{StrutValves, Valve};

use crate::model_file::InvalidValue;
use crate::strut::StrutModel;
use crate::strut_first::FirstGenerationStrut;

use super::programme::Programme;

/// What the first-generation model gives for a programme.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstGenerationRun {
    /// Force, N, compression positive.
    pub force_n: Vec<f64>,
    /// The spring's part, N.
    pub spring_force_n: Vec<f64>,
    /// The delayed signals that acted.
    pub acting: Vec<StrutValves<bool>>,
}

/// Runs the first-generation model on inputs: time s, displacement m, speed m/s and signals of equal length.
///
/// # Errors
/// Impossible values in the model.
pub fn run_first_generation(
    model: &StrutModel,
    time_s: &[f64],
    displacement_m: &[f64],
    speed_m_s: &[f64],
    signals: &[StrutValves<bool>],
) -> Result<FirstGenerationRun, InvalidValue> {
    let first = signals.first().copied().unwrap_or_default();
    let mut strut = FirstGenerationStrut::at_rest(model, first)?;
    let mut run = FirstGenerationRun {
        force_n: Vec::new(),
        spring_force_n: Vec::new(),
        acting: Vec::new(),
    };
    for (((&time, &x), &v), &signals) in time_s.iter().zip(displacement_m).zip(speed_m_s).zip(signals) {
        let out = strut.update(time, x, v, signals);
        run.force_n.push(out.force_n);
        run.spring_force_n.push(out.spring_force_n);
        run.acting.push(out.acting);
    }
    Ok(run)
}

/// Figures 31 and 32: every switch of every valve once, at 1 Hz, the springs switched away from the reference position as in
/// the report's own figure.
#[must_use]
pub fn demonstration() -> Programme {
    let (amplitude_m, rate) = (0.02, std::f64::consts::TAU);
    let law = |t: f64| {
        (
            amplitude_m * libm::sin(rate * t),
            amplitude_m * rate * libm::cos(rate * t),
        )
    };
    Programme::from_law(law, 8.0, 2e-3, StrutValves::default())
        .switched(Valve::Bypass1, true, 1.1)
        .switched(Valve::Bypass1, false, 2.1)
        .switched(Valve::Spring, true, 3.15)
        .switched(Valve::Bypass1, true, 4.1)
        .switched(Valve::Bypass2, true, 4.1)
        .switched(Valve::Bypass2, false, 5.1)
        .switched(Valve::Bypass1, false, 5.1)
        .switched(Valve::Spring, false, 6.35)
        .switched(Valve::Bypass1, true, 7.1)
}

/// Figure 34: a slow (2 mm/s) compression history with the stiff spring, towards its end valve 3 opened at the reference position and
/// a stroke on the soft spring; both dampers bypassed.
#[must_use]
pub fn spring_comparison() -> Programme {
    let corners = [0.0_f64, 0.02, -0.04, 0.02, -0.04, 0.0, 0.04, -0.04, 0.0];
    let path_m: f64 = corners.windows(2).map(|leg| (leg[1] - leg[0]).abs()).sum();
    let stiff_m: f64 = corners[..6].windows(2).map(|leg| (leg[1] - leg[0]).abs()).sum();
    let speed_m_s = 0.002;
    Programme::sawtooth(&corners, path_m / speed_m_s, 0.05, StrutValves::new(true, true, false)).switched(
        Valve::Spring,
        true,
        stiff_m / speed_m_s,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::play;

    fn first(model: &StrutModel, programme: &Programme) -> FirstGenerationRun {
        let (x, v) = (programme.displacement_m(), programme.speed_m_s());
        run_first_generation(model, programme.time_s(), &x, &v, programme.signals()).expect("possible")
    }

    #[test]
    fn every_switch_acts_late_by_40_to_120_ms() {
        let programme = demonstration();
        let run = first(&StrutModel::defender110(8000.0), &programme);
        for valve in Valve::ALL {
            let edges = |states: &[StrutValves<bool>]| -> Vec<f64> {
                let times = programme.time_s();
                (1..states.len())
                    .filter(|&i| states[i][valve] != states[i - 1][valve])
                    .map(|i| times[i])
                    .collect()
            };
            let (signals, acts) = (edges(programme.signals()), edges(&run.acting));
            assert_eq!(signals.len(), acts.len(), "{valve:?}");
            for (signal, act) in signals.iter().zip(&acts) {
                assert!(
                    (0.039..0.12).contains(&(act - signal)),
                    "{valve:?}: {signal} s acts at {act} s"
                );
            }
        }
    }

    #[test]
    fn spring_forces_of_both_generations_agree_but_for_heat_oil_and_gas() {
        // With the second generation's effects off both are Boyle's law. With them on, what the report puts down to heat shows.
        let programme = spring_comparison();
        let model = StrutModel::defender110(8000.0);
        let run = first(&model, &programme);
        let worst = |model: &StrutModel| {
            let record = play(model, &programme).expect("possible");
            let area = model.piston_area_m2();
            let pairs = record.pressure_pa[0].iter().zip(&run.spring_force_n);
            pairs
                .map(|(pressure, force)| (pressure * area - force).abs())
                .fold(0.0, f64::max)
        };
        let mut bare = model.clone();
        bare.effects = Default::default();
        let largest = run.spring_force_n.iter().copied().fold(0.0, f64::max);
        assert!(worst(&bare) < 0.02 * largest, "{} N of {largest} N", worst(&bare));
        assert!(
            worst(&model) > worst(&bare) && worst(&model) < 0.25 * largest,
            "{} N",
            worst(&model)
        );
    }
}
