//! Figures of a run with a manoeuvre: how far the vehicle went from its line, when the controller took the drive for cornering, and
//! the ride before and after.

use oleo_controller::{FaultCode, Mode};
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::course::{Ending, Phase};
use oleo_plant_sim::measures::RideMeter;

use crate::record::{CourseMotion, Recording, Sample, StrategyReport};

/// Lateral acceleration of the body's centre of mass at which the vehicle corners, m/s2.
const CORNERING_M_S2: f64 = 0.5;

/// Figures of a run with a manoeuvre.
#[derive(Debug)]
pub struct CourseFigures {
    /// How it ended; `None` for a run that was stopped.
    pub ending: Option<Ending>,
    /// Largest lateral acceleration of the body's centre of mass, m/s2.
    pub max_lateral_m_s2: f64,
    /// Largest distance of the body's centre of mass from the driver's line, m; `None` where the steering wheel is held.
    pub max_path_deviation_m: Option<f64>,
    /// Least room between the body's outline and the cones, m, negative where one was hit; `None` without cones.
    pub cone_margin_m: Option<f64>,
    /// Time from the first lateral acceleration above 0.5 m/s2 in the manoeuvre until the controller has decided for handling, s.
    /// `None` where it never did, or where the manoeuvre has no cornering.
    pub decision_s: Option<f64>,
    /// Weighted RMS acceleration (BS 6841) at the driver's and at the left rear passenger's seat before the manoeuvre, m/s2;
    /// `None` where nothing is before it.
    pub ride_before_m_s2: Option<[f64; 2]>,
    /// The same behind the last cones.
    pub ride_after_m_s2: Option<[f64; 2]>,
}

impl CourseFigures {
    /// Figures of a recording; `None` where the ride model drove. `strategy` is what the controller had last
    /// reported in each tick.
    pub(super) fn of(
        recording: &Recording,
        ending: Option<Ending>,
        account: &[Option<(Mode, FaultCode)>],
        strategy: &[StrategyReport],
        score_from_s: f64,
    ) -> Option<Self> {
        let samples = &recording.samples;
        samples.first()?.motion.course?;
        let course = || samples.iter().filter_map(|sample| sample.motion.course);
        let largest = |of: &dyn Fn(CourseMotion) -> Option<f64>| course().filter_map(of).reduce(f64::max);
        Some(Self {
            ending,
            max_lateral_m_s2: largest(&|at| Some(at.body.lateral_acceleration_m_s2.abs())).unwrap_or(0.0),
            max_path_deviation_m: largest(&|at| at.path_deviation_m.map(f64::abs)),
            cone_margin_m: course().filter_map(|at| at.cone_margin_m).reduce(f64::min),
            decision_s: decision_s(samples, account, strategy),
            ride_before_m_s2: ride_in(recording, Phase::Before, score_from_s),
            ride_after_m_s2: ride_in(recording, Phase::After, score_from_s),
        })
    }
}

/// The controller has decided for handling when it, awake and not for a fault, commands all valves closed, or says that it is in
/// handling mode. Every tick carries a command, but only every twentieth a status: where the controller keeps a valve open in
/// handling mode, the time is up to 0.1 s too long.
fn decision_s(samples: &[Sample], account: &[Option<(Mode, FaultCode)>], strategy: &[StrategyReport]) -> Option<f64> {
    let corners = |sample: &Sample| {
        sample.motion.course.is_some_and(|at| {
            at.phase == Some(Phase::Cornering) && at.body.lateral_acceleration_m_s2.abs() > CORNERING_M_S2
        })
    };
    let begun = samples.iter().position(corners)?;
    let decided = (begun..samples.len()).find(|tick| {
        let awake = matches!(account[*tick], Some((Mode::Normal | Mode::Degraded, _)));
        awake && (samples[*tick].command.word() == 0 || strategy[*tick].handling)
    })?;
    Some((decided - begun) as f64 * TICK_S)
}

/// Weighted RMS at both seats in one phase. The filters see the whole drive, so that they have no start of their own in it.
fn ride_in(recording: &Recording, phase: Phase, score_from_s: f64) -> Option<[f64; 2]> {
    let steps = recording.seat_acceleration_m_s2.len() / recording.samples.len().max(1);
    let first_tick = (score_from_s / TICK_S).round() as usize;
    let mut meters = [RideMeter::new(recording.step_s), RideMeter::new(recording.step_s)];
    let mut counted = false;
    for (tick, (sample, felt)) in (recording.samples.iter())
        .zip(recording.seat_acceleration_m_s2.chunks(steps.max(1)))
        .enumerate()
    {
        let counts = tick >= first_tick && sample.motion.course.is_some_and(|at| at.phase == Some(phase));
        counted |= counts;
        for (seat, meter) in meters.iter_mut().enumerate() {
            for felt in felt {
                if counts {
                    meter.add(felt[seat]);
                } else {
                    meter.settle(felt[seat]);
                }
            }
        }
    }
    counted.then(|| meters.each_ref().map(|meter| meter.measures().weighted_rms_m_s2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Motion;
    use oleo_controller::ValveCommand;
    use oleo_interface::Corners;
    use oleo_plant_sim::handling::HandlingMotion;
    use oleo_plant_sim::strut::StrutOutput;

    fn sample(lateral_m_s2: f64, word: u16, phase: Phase) -> Sample {
        Sample {
            motion: Motion {
                course: Some(CourseMotion {
                    body: HandlingMotion {
                        lateral_acceleration_m_s2: lateral_m_s2,
                        ..HandlingMotion::default()
                    },
                    steer_rad: 0.0,
                    path_deviation_m: Some(-0.3),
                    cone_margin_m: None,
                    phase: Some(phase),
                }),
                ..Motion::default()
            },
            displacement_m: Corners::default(),
            strut: Corners::splat(StrutOutput::default()),
            inertial: None,
            heard: true,
            command: ValveCommand::from_word(word),
            energised: ValveCommand::from_word(word),
        }
    }

    const NORMAL: Option<(Mode, FaultCode)> = Some((Mode::Normal, FaultCode::None));

    /// From the second tick, the first one that corners, to the fourth, in which the valves are closed.
    #[test]
    fn a_decision_counts_from_the_first_lateral_acceleration_of_the_manoeuvre() {
        use Phase::{Before, Cornering};
        let samples = [
            sample(2.0, 7, Before),
            sample(-0.6, 7, Cornering),
            sample(0.2, 7, Cornering),
            sample(1.0, 0, Cornering),
        ];
        let [open, reported] = [
            [StrategyReport::default(); 4],
            [false, false, true, true].map(|handling| StrategyReport {
                handling,
                ..StrategyReport::default()
            }),
        ];
        assert_eq!(decision_s(&samples, &[NORMAL; 4], &open), Some(2.0 * TICK_S));
        // What a status says counts as well, but not valves that are closed because of a fault.
        assert_eq!(decision_s(&samples, &[NORMAL; 4], &reported), Some(TICK_S));
        let safe = [NORMAL, NORMAL, NORMAL, Some((Mode::Safe, FaultCode::BusSilent))];
        assert_eq!(decision_s(&samples, &safe, &open), None);
        assert_eq!(decision_s(&samples[..1], &[NORMAL], &open[..1]), None);
    }

    /// A sine of 8 Hz before and twice as much after: each phase has its own closed form, `a Wb / sqrt 2`.
    #[test]
    fn ride_is_measured_phase_by_phase() {
        use oleo_plant_sim::measures::WB;
        use std::f64::consts::{PI, SQRT_2};
        let mut recording = Recording::with_capacity(4000, 5, 1e-3);
        for tick in 0..4000 {
            let (phase, amplitude) = match tick {
                0..2000 => (Phase::Before, 1.0),
                2000..2200 => (Phase::Cornering, 5.0),
                _ => (Phase::After, 2.0),
            };
            recording.samples.push(sample(0.0, 7, phase));
            for step in 0..5 {
                let time_s = 1e-3 * f64::from(5 * tick + step);
                let felt = amplitude * libm::sin(2.0 * PI * 8.0 * time_s);
                recording.seat_acceleration_m_s2.push([felt, 0.0]);
            }
        }
        let expected = WB.magnitude(8.0) / SQRT_2;
        let before = ride_in(&recording, Phase::Before, 1.0).unwrap();
        let after = ride_in(&recording, Phase::After, 1.0).unwrap();
        assert!((before[0] / expected - 1.0).abs() < 0.01, "{before:?}");
        // The weighting's tail of the cornering is in it.
        assert!((after[0] / (2.0 * expected) - 1.0).abs() < 0.03, "{after:?}");
        assert_eq!(before[1], 0.0);
        assert_eq!(ride_in(&recording, Phase::Before, 11.0), None);
    }
}
