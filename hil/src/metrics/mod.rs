//! Computes the figures of a run from its record: ride measures, extremes, and reaction times to faults in ticks.
//!
//! Everything here is computed from what the run left in memory. So it costs the loop nothing, and it is the same for every bus.

mod course;

use oleo_controller::can::bus_load;
use oleo_controller::{FaultCode, Mode};
use oleo_interface::tick::TICK_US;
use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::course::Ending;
use oleo_plant_sim::measures::{RideMeasures, RideMeter};

use crate::bit_timing::{SendingOrder, WireModel};
use crate::record::{Sample, StrategyReport, controller_account, strategy_reports};
use crate::run::Outcome;
use crate::scenario::Scenario;
use crate::scenario::check::{Figure, Metric};
pub use course::CourseFigures;

/// Figures of a run, and what they were computed from.
#[derive(Debug)]
pub struct Metrics {
    /// Number of ticks that were run.
    pub ticks: u32,
    /// Number of ticks of the scenario that were not run, although the course was not completed.
    pub ticks_missing: u32,
    /// Ride measures at the driver's and at the left rear passenger's seat.
    pub seats: [RideMeasures; 2],
    /// Number of changes of each valve's signal.
    pub valve_switches: Corners<StrutValves<u64>>,
    /// Number of frames that were sent and not received, injected drops included.
    pub frames_lost: u64,
    /// How many of them the bus itself lost.
    pub bus_frames_lost: u64,
    /// Number of frames that failed their end-to-end check, at either end.
    pub e2e_errors: u64,
    /// Mode and first cause in each tick, as the controller's frames say.
    pub account: Vec<Option<(Mode, FaultCode)>>,
    /// What the controller had last reported of its strategy, in each tick.
    pub strategy: Vec<StrategyReport>,
    /// Number of times that the controller reported handling mode anew.
    pub handling_entries: u64,
    /// Figures of the manoeuvre; `None` where the ride model drove.
    pub course: Option<CourseFigures>,
    /// The traced frames on a wire of 500 kbit/s and of 1 Mbit/s.
    pub wires: [WireModel; 2],
    extremes: Extremes,
    answer: Answer,
}

#[derive(Debug, Default)]
struct Extremes {
    heave_m: f64,
    roll_rad: f64,
    pitch_rad: f64,
    jounce_m: f64,
    rebound_m: f64,
    pressure_pa: f64,
    lifted_ticks: u64,
}

/// Numbers of ticks from the first fault, and of `recover` from the end of the last one; `None` for what did not happen.
#[derive(Debug, Default)]
struct Answer {
    detect: Option<u32>,
    safe: Option<u32>,
    closed: Option<u32>,
    recover: Option<u32>,
}

impl Metrics {
    /// Computes all figures of a run.
    pub fn of(scenario: &Scenario, outcome: &Outcome) -> Self {
        let plant = &outcome.plant;
        let samples = &plant.recording.samples;
        let ticks = samples.len() as u32;
        let account = controller_account(&plant.trace, samples.len());
        let order = SendingOrder::of(&plant.trace);
        let mut meters = [
            RideMeter::new(plant.recording.step_s),
            RideMeter::new(plant.recording.step_s),
        ];
        let settling = (scenario.score_from_s / plant.recording.step_s).round() as usize;
        for (step, felt) in plant.recording.seat_acceleration_m_s2.iter().enumerate() {
            for (meter, a) in meters.iter_mut().zip(felt) {
                if step < settling {
                    meter.settle(*a);
                } else {
                    meter.add(*a);
                }
            }
        }
        let strategy = strategy_reports(&plant.trace, samples.len());
        Self {
            ticks,
            ticks_missing: match plant.ending {
                Some(Ending::Completed) => 0,
                _ => scenario.ticks.saturating_sub(ticks),
            },
            handling_entries: entries(strategy.iter().map(|report| report.handling)),
            course: CourseFigures::of(
                &plant.recording,
                plant.ending,
                &account,
                &strategy,
                scenario.score_from_s,
            ),
            strategy,
            seats: meters.each_ref().map(RideMeter::measures),
            valve_switches: plant.recording.valve_switches(),
            frames_lost: plant.bus_frames_lost + plant.injected.dropped,
            bus_frames_lost: plant.bus_frames_lost,
            e2e_errors: plant.e2e_errors,
            wires: bus_load::BIT_RATES.map(|rate| WireModel::of(&order, rate, TICK_US, ticks)),
            extremes: Extremes::of(samples),
            answer: scenario
                .fault_ticks()
                .map(|span| Answer::of(span, &account, samples))
                .unwrap_or_default(),
            account,
        }
    }

    /// The figure of one metric.
    pub fn figure(&self, metric: Metric) -> Figure {
        let degrees = |rad: f64| Figure::Number(rad.to_degrees());
        let count = |n: u64| Figure::Number(n as f64);
        let ticks = |n: Option<u32>| n.map_or(Figure::Never, |n| Figure::Number(f64::from(n)));
        let [driver, rear_left] = &self.seats;
        match metric {
            Metric::Ticks => count(self.ticks.into()),
            Metric::TicksMissing => count(self.ticks_missing.into()),
            Metric::WeightedRmsDriver => Figure::Number(driver.weighted_rms_m_s2),
            Metric::WeightedRmsRearLeft => Figure::Number(rear_left.weighted_rms_m_s2),
            Metric::VdvDriver => Figure::Number(driver.vdv_m_s1_75),
            Metric::VdvRearLeft => Figure::Number(rear_left.vdv_m_s1_75),
            Metric::MsdvDriver => Figure::Number(driver.msdv_m_s1_5),
            Metric::MsdvRearLeft => Figure::Number(rear_left.msdv_m_s1_5),
            Metric::MaxHeave => Figure::Number(self.extremes.heave_m),
            Metric::MaxRoll => degrees(self.extremes.roll_rad),
            Metric::MaxPitch => degrees(self.extremes.pitch_rad),
            Metric::MaxJounce => Figure::Number(self.extremes.jounce_m),
            Metric::MaxRebound => Figure::Number(self.extremes.rebound_m),
            Metric::MaxPressure => Figure::Number(self.extremes.pressure_pa),
            Metric::WheelLift => Figure::Number(self.extremes.lifted_ticks as f64 / f64::from(self.ticks.max(1))),
            Metric::ValveSwitches => count(
                self.valve_switches
                    .map(|strut| strut.into_array().iter().sum::<u64>())
                    .values()
                    .sum(),
            ),
            Metric::HandlingEntries => count(self.handling_entries),
            Metric::MaxLateral => self.of_course(|course| Some(course.max_lateral_m_s2)),
            Metric::MaxPathDeviation => self.of_course(|course| course.max_path_deviation_m),
            Metric::ConeMargin => self.of_course(|course| course.cone_margin_m),
            Metric::Decision => self.of_course(|course| course.decision_s),
            Metric::RideBefore => self.of_course(|course| course.ride_before_m_s2.map(|[driver, _]| driver)),
            Metric::RideAfter => self.of_course(|course| course.ride_after_m_s2.map(|[driver, _]| driver)),
            Metric::Ending => {
                let ending = self.course.as_ref().and_then(|course| course.ending);
                ending.map_or(Figure::Never, |ending| Figure::Word(ending.word()))
            }
            Metric::FramesLost => count(self.frames_lost),
            Metric::BusFramesLost => count(self.bus_frames_lost),
            Metric::E2eErrors => count(self.e2e_errors),
            Metric::BusLoad500k => Figure::Number(self.wires[0].utilisation),
            Metric::TicksToDetect => ticks(self.answer.detect),
            Metric::TicksToSafe => ticks(self.answer.safe),
            Metric::TicksToClosed => ticks(self.answer.closed),
            Metric::TicksToRecover => ticks(self.answer.recover),
            Metric::WorstMode => Figure::Word(self.worst_mode()),
            Metric::FinalMode => {
                let last = self.account.iter().rev().flatten().next();
                Figure::Word(last.map_or(Mode::StartUp, |(mode, _)| *mode).name())
            }
            Metric::FirstFault => {
                // Before the first complete set of readings the controller rightly calls the bus silent.
                let begin = self
                    .account
                    .iter()
                    .position(|a| a.is_some_and(|(mode, _)| mode == Mode::Normal));
                let mut faults = self
                    .account
                    .iter()
                    .skip(begin.unwrap_or(0))
                    .flatten()
                    .map(|(_, fault)| *fault);
                let first = faults.find(|fault| *fault != FaultCode::None);
                Figure::Word(first.unwrap_or_default().name())
            }
        }
    }

    /// A figure of the manoeuvre.
    fn of_course(&self, of: impl FnOnce(&CourseFigures) -> Option<f64>) -> Figure {
        self.course.as_ref().and_then(of).map_or(Figure::Never, Figure::Number)
    }

    /// The most restricted mode after the first start-up. The order of the modes is that of their restriction.
    fn worst_mode(&self) -> &'static str {
        let modes = self
            .account
            .iter()
            .flatten()
            .map(|(mode, _)| *mode)
            .skip_while(|mode| *mode == Mode::StartUp);
        let worst = modes.filter(|mode| *mode != Mode::StartUp).max();
        worst.unwrap_or(Mode::StartUp).name()
    }
}

/// How often a state was entered, from not being in it.
fn entries(states: impl Iterator<Item = bool>) -> u64 {
    let mut before = false;
    states
        .filter(|now| !std::mem::replace(&mut before, *now) && *now)
        .count() as u64
}

impl Extremes {
    fn of(samples: &[Sample]) -> Self {
        samples.iter().fold(Self::default(), |mut most, sample| {
            let body = &sample.motion.body;
            most.heave_m = most.heave_m.max(body.heave_m.abs());
            most.roll_rad = most.roll_rad.max(body.roll_rad.abs());
            most.pitch_rad = most.pitch_rad.max(body.pitch_rad.abs());
            for (_, (displacement_m, strut)) in sample.displacement_m.zip(sample.strut).iter() {
                most.jounce_m = most.jounce_m.max(*displacement_m);
                most.rebound_m = most.rebound_m.max(-displacement_m);
                most.pressure_pa = strut.pressure_pa.iter().fold(most.pressure_pa, |p, q| p.max(*q));
            }
            most.lifted_ticks += u64::from(sample.motion.wheel.values().any(|wheel| wheel.load_n <= 0.0));
            most
        })
    }
}

impl Answer {
    fn of((from, until): (u32, u32), account: &[Option<(Mode, FaultCode)>], samples: &[Sample]) -> Self {
        let mode_at = |tick: u32| account.get(tick as usize).copied().flatten().map(|(mode, _)| mode);
        let end = samples.len() as u32;
        let before = from.checked_sub(1).and_then(mode_at);
        let first = |begin: u32, wanted: &dyn Fn(Mode) -> bool| {
            (begin..end)
                .find(|tick| mode_at(*tick).is_some_and(wanted))
                .map(|tick| tick - begin)
        };
        let closed = |tick: u32| {
            samples
                .get(tick as usize)
                .is_some_and(|sample| sample.energised.word() == 0)
        };
        // The last tick of the fault in which a valve is open. From the next one on all stay closed.
        let last_open = (from..until.min(end)).rev().find(|tick| !closed(*tick));
        let closed_from = last_open.map_or(from, |tick| tick + 1);
        Self {
            detect: first(from, &|mode| Some(mode) != before),
            safe: first(from, &|mode| matches!(mode, Mode::Safe | Mode::Latched)),
            closed: (closed_from < until.min(end)).then(|| closed_from - from),
            recover: first(until, &|mode| mode == Mode::Normal),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Motion, Wheel};
    use oleo_controller::ValveCommand;
    use oleo_plant_sim::strut::StrutOutput;

    fn sample(word: u16) -> Sample {
        Sample {
            motion: Motion {
                wheel: Corners::splat(Wheel {
                    load_n: 1.0,
                    ..Wheel::default()
                }),
                ..Motion::default()
            },
            displacement_m: Corners::from_array([0.01, -0.02, 0.0, 0.0]),
            strut: Corners::splat(StrutOutput {
                force_n: 0.0,
                pressure_pa: [4e6; 4],
            }),
            inertial: None,
            heard: true,
            command: ValveCommand::from_word(word),
            energised: ValveCommand::from_word(word),
        }
    }

    #[test]
    fn ticks_are_counted_from_the_fault_and_from_its_end() {
        let modes = [
            Mode::Normal,
            Mode::Normal,
            Mode::Normal,
            Mode::Safe,
            Mode::Safe,
            Mode::Safe,
            Mode::StartUp,
            Mode::Normal,
        ];
        let account: Vec<_> = modes.iter().map(|mode| Some((*mode, FaultCode::None))).collect();
        let samples: Vec<_> = [7, 7, 7, 0, 0, 0, 0, 7].map(sample).into();
        let answer = Answer::of((2, 5), &account, &samples);
        assert_eq!(
            (answer.detect, answer.safe, answer.closed, answer.recover),
            (Some(1), Some(1), Some(1), Some(2))
        );
        let never = Answer::of((2, 3), &account[..3], &samples[..3]);
        assert_eq!(
            (never.detect, never.safe, never.closed, never.recover),
            (None, None, None, None)
        );
    }

    #[test]
    fn entries_by_hand() {
        assert_eq!(entries([].into_iter()), 0);
        assert_eq!(entries([true, true, false, true].into_iter()), 2);
    }

    #[test]
    fn extremes_by_hand() {
        let most = Extremes::of(&[sample(0), sample(0)]);
        assert_eq!(
            (most.jounce_m, most.rebound_m, most.pressure_pa, most.lifted_ticks),
            (0.01, 0.02, 4e6, 0)
        );
    }
}
