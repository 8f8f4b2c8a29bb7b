//! Writes the files of a run: `summary.json`, `timeseries.csv`, `candump.log`, `junit.xml`, `report.html`.
//!
//! They are written through [`OutputDirectory`], so that all of them appear or none. Between two runs of one scenario only wall-clock
//! figures differ; everything else has the same bytes.

use oleo_controller::{Mode, ValveCommand};
use oleo_interface::tick::TICK_S;
use oleo_report::{OutputDirectory, OutputError};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use serde::Serialize;

use crate::bus::BusCounters;
use crate::clock::Lateness;
use crate::logs::candump::write_line;
use crate::metrics::Metrics;
use crate::record::command_hash;
use crate::run::Outcome;
use crate::scenario::check::{Figure, Metric};
use crate::scenario::{Clock, Scenario};
use crate::time_series;

/// Outcome of one check.
#[derive(Clone, Debug, Serialize)]
pub struct CheckOutcome {
    /// What is required: `max_roll_deg at most 3`.
    pub name: String,
    /// Whether the requirement is met.
    pub passed: bool,
    /// The figure as text: a number, a word, or `never`.
    pub figure: String,
}

/// The contents of `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Name of the scenario.
    pub scenario: String,
    /// What the command line changed in it, in words.
    pub changes: Vec<String>,
    /// Name or path of the road.
    pub road: String,
    /// Length of a road from a file, m; `null` for computed roads. A longer drive goes over its mirror image, back and forth.
    pub road_measured_m: Option<f64>,
    /// Forward speed of the vehicle, km/h.
    pub speed_km_h: f64,
    /// Model of the vehicle: `ride` or `handling`.
    pub model: &'static str,
    /// What the vehicle carried.
    pub load: &'static str,
    /// Name of the strategy that decided the valves.
    pub strategy: &'static str,
    /// Address of the bus.
    pub bus: String,
    /// How time passed: `lockstep` or `realtime`.
    pub clock: &'static str,
    /// Number of ticks that were run.
    pub ticks: u32,
    /// Simulated time of the run, s.
    pub simulated_s: f64,
    /// Wall-clock time of the loop alone, s.
    pub wall_s: f64,
    /// Simulated time over wall-clock time.
    pub real_time_factor: f64,
    /// Digest of the valve words, see [`command_hash`].
    pub command_hash: String,
    /// Number of messages on the wire, both directions together.
    pub frames_sent: u64,
    /// Number of frames that were sent and not received, injected drops included.
    pub frames_lost: u64,
    /// How many of them the bus itself lost.
    pub bus_frames_lost: u64,
    /// Number of frames with other identifiers, which are ignored.
    pub foreign_frames: u64,
    /// Number of frames that keep two nodes in step but belonged to another run; they are ignored.
    pub foreign_sync_frames: u64,
    /// Number of frames that failed their end-to-end check, at either end.
    pub e2e_errors: u64,
    /// Fraction of time for which a wire of 500 kbit/s would be busy, 0 to 1.
    pub bus_load_500k: f64,
    /// The same for a wire of 1 Mbit/s.
    pub bus_load_1m: f64,
    /// Number of waits for a full transmit queue.
    pub bus_back_offs: u64,
    /// Weighted RMS acceleration at the driver's seat (BS 6841), m/s2.
    pub weighted_rms_driver_m_s2: f64,
    /// The same at the left rear passenger's seat.
    pub weighted_rms_rear_left_m_s2: f64,
    /// Vibration dose value at the driver's seat (BS 6841), m/s^1.75.
    pub vdv_driver_m_s1_75: f64,
    /// The same at the left rear passenger's seat.
    pub vdv_rear_left_m_s1_75: f64,
    /// Motion sickness dose value at the driver's seat (BS 6841), m/s^1.5.
    pub msdv_driver_m_s1_5: f64,
    /// The same at the left rear passenger's seat.
    pub msdv_rear_left_m_s1_5: f64,
    /// Largest roll of the body to either side, degrees.
    pub max_roll_deg: f64,
    /// Time at the start that does not count for the ride measures above, s.
    pub score_from_s: f64,
    /// Number of times that the controller reported handling mode anew.
    pub handling_entries: u64,
    /// What a run with a manoeuvre has besides.
    #[serde(flatten)]
    pub course: Option<CourseSummary>,
    /// Number of changes of each of the twelve valve signals: corner by corner, valves 1 to 3.
    pub valve_switches: [u64; 12],
    /// Each change of the controller's mode.
    pub modes: Vec<ModeEntry>,
    /// See [`Metric::TicksToDetect`]; `null` is "never", here and in the next three.
    pub ticks_to_detect: Option<f64>,
    /// Ticks until the controller was safe, as [`Metric::TicksToSafe`].
    pub ticks_to_safe: Option<f64>,
    /// Ticks until all valves were closed, as [`Metric::TicksToClosed`].
    pub ticks_to_closed: Option<f64>,
    /// Ticks until the mode was normal again, as [`Metric::TicksToRecover`].
    pub ticks_to_recover: Option<f64>,
    /// Tick in which a silent controller was taken to be gone.
    pub controller_lost_at_tick: Option<u32>,
    /// Number of times that the controller's process was started again and let in.
    pub controller_rejoined: u32,
    /// How the bus failed, if that has ended the run.
    pub bus_failure: Option<String>,
    /// Whether the run was stopped from outside.
    pub interrupted: bool,
    /// In real time: how each node met its deadlines.
    pub lateness: Vec<NodeLateness>,
    /// Outcome of each check of the scenario.
    pub checks: Vec<CheckOutcome>,
}

/// Figures of the manoeuvre; see [`CourseFigures`](crate::metrics::CourseFigures) for what `null` is in each.
#[derive(Clone, Debug, Serialize)]
pub struct CourseSummary {
    /// Name of the manoeuvre.
    pub manoeuvre: &'static str,
    /// Who drove: `eased` or `hard`.
    pub driver: &'static str,
    /// Side slope of the road, %, positive where the left side is the higher one.
    pub side_slope_percent: f64,
    /// `completed`, `rolled over`, `spun` or `lost the track`; `null` for a run that was stopped.
    pub ending: Option<&'static str>,
    /// Largest lateral acceleration of the body's centre of mass, m/s2.
    pub max_lateral_m_s2: f64,
    /// Largest distance of the body's centre of mass from the driver's line, m.
    pub max_path_deviation_m: Option<f64>,
    /// Least room to the cones, m, negative where one was hit.
    pub cone_margin_m: Option<f64>,
    /// From the first lateral acceleration above 0.5 m/s2 in the manoeuvre to the decision for handling, s.
    pub decision_s: Option<f64>,
    /// Weighted RMS acceleration at the driver's seat before the manoeuvre (BS 6841), m/s2.
    pub weighted_rms_driver_before_m_s2: Option<f64>,
    /// The same at the left rear passenger's seat.
    pub weighted_rms_rear_left_before_m_s2: Option<f64>,
    /// Weighted RMS acceleration at the driver's seat behind the last cones (BS 6841), m/s2.
    pub weighted_rms_driver_after_m_s2: Option<f64>,
    /// The same at the left rear passenger's seat.
    pub weighted_rms_rear_left_after_m_s2: Option<f64>,
}

impl CourseSummary {
    fn of(scenario: &Scenario, metrics: &Metrics) -> Option<Self> {
        let (settings, figures) = (scenario.course.as_ref()?, metrics.course.as_ref()?);
        let (before, after) = (figures.ride_before_m_s2, figures.ride_after_m_s2);
        Some(Self {
            manoeuvre: settings.kind.key(),
            driver: settings.driver().key(),
            side_slope_percent: settings.side_slope_percent(),
            ending: figures.ending.map(|ending| ending.word()),
            max_lateral_m_s2: figures.max_lateral_m_s2,
            max_path_deviation_m: figures.max_path_deviation_m,
            cone_margin_m: figures.cone_margin_m,
            decision_s: figures.decision_s,
            weighted_rms_driver_before_m_s2: before.map(|[driver, _]| driver),
            weighted_rms_rear_left_before_m_s2: before.map(|[_, rear_left]| rear_left),
            weighted_rms_driver_after_m_s2: after.map(|[driver, _]| driver),
            weighted_rms_rear_left_after_m_s2: after.map(|[_, rear_left]| rear_left),
        })
    }
}

/// A mode and when it was entered.
#[derive(Clone, Debug, Serialize)]
pub struct ModeEntry {
    /// First tick of the mode.
    pub tick: u32,
    /// Name of the mode.
    pub mode: &'static str,
    /// Name of the first cause, `none` if all is well.
    pub fault: &'static str,
}

/// How one node met its deadlines.
#[derive(Clone, Debug, Serialize)]
pub struct NodeLateness {
    /// Name of the node: `plant` or `controller`.
    pub node: &'static str,
    /// How late its ticks began.
    #[serde(flatten)]
    pub lateness: Lateness,
}

impl Summary {
    /// Collects the figures of a run over a road that was measured for `road_measured_m`.
    pub fn of(scenario: &Scenario, outcome: &Outcome, metrics: &Metrics, road_measured_m: Option<f64>) -> Self {
        let number = |metric| match metrics.figure(metric) {
            Figure::Number(number) => Some(number),
            _ => None,
        };
        let [driver, rear_left] = metrics.seats;
        let simulated_s = f64::from(metrics.ticks) * TICK_S;
        let BusCounters { back_offs, .. } = outcome.plant.counters;
        Self {
            scenario: scenario.name.clone(),
            changes: scenario.changes.clone(),
            road: scenario.road.clone(),
            road_measured_m,
            // Rounded, because the conversion to m/s and back changes the last digit.
            speed_km_h: (scenario.speed_m_s * 3.6 * 1e6).round() * 1e-6,
            model: if scenario.course.is_some() { "handling" } else { "ride" },
            load: scenario.load.key(),
            strategy: scenario.strategy.name(),
            bus: scenario.bus.to_string(),
            clock: scenario.clock.name(),
            ticks: metrics.ticks,
            simulated_s,
            wall_s: outcome.wall_s,
            real_time_factor: simulated_s / outcome.wall_s.max(1e-9),
            command_hash: command_hash(outcome.plant.recording.words()),
            frames_sent: outcome.plant.frames_sent,
            frames_lost: metrics.frames_lost,
            bus_frames_lost: metrics.bus_frames_lost,
            foreign_frames: outcome.plant.foreign_frames,
            foreign_sync_frames: outcome.plant.foreign_sync_frames,
            e2e_errors: metrics.e2e_errors,
            bus_load_500k: metrics.wires[0].utilisation,
            bus_load_1m: metrics.wires[1].utilisation,
            bus_back_offs: back_offs,
            weighted_rms_driver_m_s2: driver.weighted_rms_m_s2,
            weighted_rms_rear_left_m_s2: rear_left.weighted_rms_m_s2,
            vdv_driver_m_s1_75: driver.vdv_m_s1_75,
            vdv_rear_left_m_s1_75: rear_left.vdv_m_s1_75,
            msdv_driver_m_s1_5: driver.msdv_m_s1_5,
            msdv_rear_left_m_s1_5: rear_left.msdv_m_s1_5,
            max_roll_deg: number(Metric::MaxRoll).unwrap_or(0.0),
            score_from_s: scenario.score_from_s,
            handling_entries: metrics.handling_entries,
            course: CourseSummary::of(scenario, metrics),
            valve_switches: valve_switches(metrics),
            modes: mode_entries(metrics),
            ticks_to_detect: number(Metric::TicksToDetect),
            ticks_to_safe: number(Metric::TicksToSafe),
            ticks_to_closed: number(Metric::TicksToClosed),
            ticks_to_recover: number(Metric::TicksToRecover),
            controller_lost_at_tick: outcome.controller_lost_at,
            controller_rejoined: outcome.plant.controller_rejoined,
            bus_failure: outcome.bus_failure.as_ref().map(ToString::to_string),
            interrupted: outcome.interrupted,
            lateness: outcome
                .lateness
                .iter()
                .map(|(role, lateness)| NodeLateness {
                    node: role.name(),
                    lateness: lateness.clone(),
                })
                .collect(),
            checks: check_outcomes(scenario, outcome, metrics),
        }
    }

    /// Whether every check is met, and the bus has not failed.
    pub fn passed(&self) -> bool {
        self.bus_failure.is_none() && self.checks.iter().all(|check| check.passed)
    }
}

/// The numbers of changes in the order of the valve word's bits.
fn valve_switches(metrics: &Metrics) -> [u64; 12] {
    let mut edges = [0; 12];
    for (corner, strut) in metrics.valve_switches.iter() {
        for (valve, count) in strut.iter() {
            edges[ValveCommand::bit(corner, valve)] = *count;
        }
    }
    edges
}

/// Largest fraction of ticks in which a node may overrun its deadline in real time.
const MOST_OVERRUNS: f64 = 0.01;
/// Number of ticks from which on a run in real time must have left start-up: one second.
const STARTED_TICKS: u32 = 200;

/// What a run in real time must do whatever its scenario checks. Otherwise it has shown nothing.
fn real_time_outcomes(outcome: &Outcome, metrics: &Metrics) -> Vec<CheckOutcome> {
    let mut outcomes: Vec<CheckOutcome> = outcome
        .lateness
        .iter()
        .map(|(role, late)| {
            let fraction = late.overruns as f64 / late.ticks.max(1) as f64;
            CheckOutcome {
                name: format!(
                    "overruns of the {} <= {} % of ticks",
                    role.name(),
                    100.0 * MOST_OVERRUNS
                ),
                passed: fraction <= MOST_OVERRUNS,
                figure: format!("{} %", oleo_report::significant(100.0 * fraction, 3)),
            }
        })
        .collect();
    if metrics.ticks >= STARTED_TICKS {
        let started = metrics.account.iter().flatten().any(|(mode, _)| *mode != Mode::StartUp);
        outcomes.push(CheckOutcome {
            name: "controller leaves start-up".into(),
            passed: started,
            figure: if started { "yes" } else { "no" }.into(),
        });
    }
    outcomes
}

fn check_outcomes(scenario: &Scenario, outcome: &Outcome, metrics: &Metrics) -> Vec<CheckOutcome> {
    let of_clock = match scenario.clock {
        Clock::RealTime => real_time_outcomes(outcome, metrics),
        Clock::Lockstep => Vec::new(),
    };
    let of_check = |check: &crate::scenario::Check| {
        let figure = metrics.figure(check.metric);
        CheckOutcome {
            name: check.name(),
            passed: check.is_met(&figure),
            figure: figure.to_string(),
        }
    };
    scenario.checks.iter().map(of_check).chain(of_clock).collect()
}

fn mode_entries(metrics: &Metrics) -> Vec<ModeEntry> {
    let mut entries: Vec<ModeEntry> = Vec::new();
    for (tick, account) in metrics.account.iter().enumerate() {
        let Some((mode, fault)) = account else { continue };
        let (mode, fault) = (mode.name(), fault.name());
        if entries
            .last()
            .is_none_or(|last| (last.mode, last.fault) != (mode, fault))
        {
            entries.push(ModeEntry {
                tick: tick as u32,
                mode,
                fault,
            });
        }
    }
    entries
}

/// Writes all data files of a run. The page is written by [`crate::page`].
///
/// # Errors
/// A file cannot be written.
pub fn write(
    out: &mut OutputDirectory,
    scenario: &Scenario,
    outcome: &Outcome,
    metrics: &Metrics,
    summary: &Summary,
) -> Result<(), OutputError> {
    out.summary("summary.json", Some(scenario.seed), summary)?;
    out.write("junit.xml", junit(summary))?;
    out.write("candump.log", candump(scenario, outcome, metrics))?;
    let columns = time_series::columns(outcome, metrics);
    let borrowed: Vec<(&str, &[f64])> = columns
        .iter()
        .map(|(name, values)| (name.as_str(), values.as_slice()))
        .collect();
    let words = time_series::words(metrics);
    let words = words.each_ref().map(|(name, values)| (*name, values.as_slice()));
    out.csv_with_words("timeseries.csv", &borrowed, &words)
}

/// The checks as a JUnit file: one suite with a case for each check.
fn junit(summary: &Summary) -> Vec<u8> {
    let mut suite = TestSuite::new(format!("oleo hil {}", summary.scenario));
    for check in &summary.checks {
        let status = if check.passed {
            TestCaseStatus::success()
        } else {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_message(format!("{}: is {}", check.name, check.figure));
            status
        };
        let mut case = TestCase::new(check.name.clone(), status);
        case.set_classname(format!("oleo.hil.{}", summary.scenario));
        suite.add_test_case(case);
    }
    let mut report = Report::new("oleo hil");
    report.add_test_suite(suite);
    let mut bytes = Vec::new();
    // Writing to memory does not fail.
    let _ = report.serialize(&mut bytes);
    bytes
}

/// The traced frames as a candump log. Their times are those at which a wire of 500 kbit/s would have carried them (in lockstep) or
/// at which this machine did (in real time).
fn candump(scenario: &Scenario, outcome: &Outcome, metrics: &Metrics) -> Vec<u8> {
    let interface = match &scenario.bus {
        crate::bus::BusAddress::SocketCan(interface) => interface.as_str(),
        _ => "vcan0",
    };
    let trace = &outcome.plant.trace;
    let real_time = scenario.clock == Clock::RealTime;
    let mut timed: Vec<(u64, usize)> = match real_time {
        true => trace
            .iter()
            .enumerate()
            .map(|(i, entry)| (u64::from(entry.wall_us), i))
            .collect(),
        false => metrics.wires[0].end_us.iter().copied().zip(0..).collect(),
    };
    timed.sort_unstable();
    let mut log = Vec::with_capacity(48 * trace.len());
    for (time_us, index) in timed {
        // Writing to memory does not fail.
        let _ = write_line(&mut log, time_us, interface, &trace[index].frame);
    }
    log
}
