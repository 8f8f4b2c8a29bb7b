//! One run: the nodes, the clock that paces them, and an end in every case.
//!
//! | run | nodes here | who waits for whom |
//! |---|---|---|
//! | lockstep, 1 thread | both | taking turns |
//! | lockstep, 2 threads | both | each for the other's `TickDone` |
//! | lockstep, `--node` | one | the same, across processes |
//! | lockstep, `--firmware` | the plant; the controller is an image on an emulated board | the same |
//! | real time | both (2 threads) or one | nobody: each keeps its deadlines |
//!
//! The first three give the same commands, bit for bit. A partner that stays silent for the scenario's `partner_timeout_s` is
//! taken to be gone, whatever else is on the bus. The plant then drives on with de-energised valves, or ends if the scenario says so; the
//! controller ticks on until its mode is safe, and ends. A controller that is started again while the plant waits for it is let in; a
//! plant that is started again wants another run, so its old controller ends. A bus that fails ends the run, and what was driven
//! until then is kept.

mod controller_loop;
mod error;
mod outcome;
mod parameters;
mod plant;
mod plant_loop;
mod waiting;

use std::path::Path;
use std::time::Instant;

use crc::{CRC_16_IBM_3740, Crc};
use oleo_controller::{Builder, Configuration};

use crate::bus::{Bus, BusAddress, Compared, in_process_pair};
use crate::companion::Companion;
use crate::controller_node::{ControllerNode, Heard};
use crate::emulator::Emulator;
use crate::handshake::handshake;
use crate::plant_node::PlantNode;
use crate::scenario::{Clock, Scenario};
use crate::sync::{Role, Terms};
use crate::vehicle::Vehicle;
pub use controller_loop::PlantLost;
pub use error::RunError;
pub use outcome::{ControllerOutcome, Outcome};
pub use parameters::Parameters;
pub use plant::{vehicle, vehicle_on};
pub use plant_loop::{Underway, Watch};
use waiting::{CONTROLLER_PHASE, PATIENCE, TICK, partner_timeout};

/// What the controller is built from in a scenario: the vehicle as its files describe it, without its load.
///
/// # Errors
/// A file is missing or wrong.
pub fn builder(scenario: &Scenario) -> Result<Builder, RunError> {
    Ok(builder_knowing(scenario, &Parameters::read(scenario)?))
}

/// The same of a vehicle whose files have been read.
fn builder_knowing(scenario: &Scenario, parameters: &Parameters) -> Builder {
    let mut builder = Builder {
        vehicle: parameters.description(),
        strategy: scenario.strategy,
        ..Builder::default()
    };
    let strategies = &mut builder.tuning.strategy;
    strategies.ride_handling.dampers.policy = scenario.damper_policy;
    strategies.road_and_dampers.dampers.policy = scenario.damper_policy;
    builder
}

/// The controller's configuration for a scenario.
///
/// # Errors
/// A file is missing or wrong, or a value is outside the range for which the controller was designed.
pub fn configuration(scenario: &Scenario) -> Result<Configuration, RunError> {
    Ok(builder(scenario)?.build()?)
}

/// Runs both nodes in this process, in `threads` (1 or 2; real time always takes 2).
///
/// # Errors
/// See [`RunError`].
pub fn both(scenario: &Scenario, vehicle: Vehicle, threads: usize, watch: Watch) -> Result<Outcome, RunError> {
    both_with(scenario, vehicle, threads, None, watch)
}

/// Runs both nodes in this process, in one thread, with a vehicle that stands on struts of its own or whose controller is told of another strut.
///
/// # Errors
/// See [`RunError`].
pub fn both_of(scenario: &Scenario, parameters: &Parameters, watch: Watch) -> Result<Outcome, RunError> {
    let configuration = builder_knowing(scenario, parameters).build()?;
    both_configured(
        scenario,
        plant::begin(scenario, parameters)?,
        configuration,
        1,
        None,
        watch,
    )
}

/// The same; the controller's node also serves something else.
///
/// # Errors
/// See [`RunError`].
pub fn both_with(
    scenario: &Scenario,
    vehicle: Vehicle,
    threads: usize,
    companion: Option<Box<dyn Companion>>,
    watch: Watch,
) -> Result<Outcome, RunError> {
    both_configured(scenario, vehicle, configuration(scenario)?, threads, companion, watch)
}

fn both_configured(
    scenario: &Scenario,
    vehicle: Vehicle,
    configuration: Configuration,
    threads: usize,
    companion: Option<Box<dyn Companion>>,
    watch: Watch,
) -> Result<Outcome, RunError> {
    let (plant_end, controller_end) = both_ends(scenario)?;
    let real_time = scenario.clock == Clock::RealTime;
    let mut plant = PlantNode::new(plant_end, scenario, vehicle, real_time);
    let mut controller = ControllerNode::new(controller_end, configuration, &scenario.faults, scenario.ticks as usize);
    if let Some(companion) = companion {
        controller.serve(companion);
    }
    let started = Instant::now();
    let mut lateness = Vec::new();
    let end = if real_time {
        let begin = started + TICK;
        std::thread::scope(|scope| {
            let other =
                scope.spawn(|| controller_loop::in_real_time(&mut controller, scenario, begin + CONTROLLER_PHASE));
            let end = plant_loop::in_real_time(&mut plant, scenario, begin, watch);
            if let Ok(Ok((late, _))) = other.join() {
                lateness.push((Role::Controller, late));
            }
            end
        })?
    } else if threads > 1 {
        std::thread::scope(|scope| {
            scope.spawn(|| controller_loop::in_lockstep(&mut controller, scenario));
            plant_loop::in_lockstep(&mut plant, scenario, &mut || Ok(()), watch)
        })?
    } else {
        let wait = partner_timeout(scenario);
        let mut turn = || match controller.listen(wait)? {
            Heard::Tick => {
                controller.decide()?;
                controller.send_done()
            }
            Heard::End => controller.send_tally(),
            Heard::Nothing | Heard::Restarted => Ok(()),
        };
        plant_loop::in_lockstep(&mut plant, scenario, &mut turn, watch)?
    };
    Ok(end.outcome(plant, lateness, started))
}

/// Runs the plant; the controller is another process. `waiting` is called once if that takes more than a second to answer.
///
/// # Errors
/// See [`RunError`].
pub fn plant_alone(
    scenario: &Scenario,
    vehicle: Vehicle,
    waiting: &mut dyn FnMut(),
    watch: Watch,
) -> Result<Outcome, RunError> {
    let bus = scenario.bus.open()?.ok_or(RunError::NoOtherProcess)?;
    let real_time = scenario.clock == Clock::RealTime;
    let mut plant = PlantNode::new(bus, scenario, vehicle, real_time);
    let (name, terms) = (scenario.bus.to_string(), terms(scenario)?);
    let session = handshake(plant.bus(), &name, Role::Plant, terms, PATIENCE, waiting)?;
    plant.join(session, terms);
    let started = Instant::now();
    let end = if real_time {
        plant_loop::in_real_time(&mut plant, scenario, started + TICK, watch)?
    } else {
        plant_loop::in_lockstep(&mut plant, scenario, &mut || Ok(()), watch)?
    };
    Ok(end.outcome(plant, Vec::new(), started))
}

/// Runs the plant; the controller is a firmware image on an emulated board. What it sends is compared with what the same controller
/// in this process sends, frame by frame.
///
/// # Errors
/// See [`RunError`]; among others the first frame that differs.
pub fn with_firmware(scenario: &Scenario, vehicle: Vehicle, image: &Path, watch: Watch) -> Result<Outcome, RunError> {
    let mut emulator = Emulator::start(image)?;
    let bus = Compared::new(emulator.bus(), Configuration::defender110());
    let mut plant = PlantNode::new(bus, scenario, vehicle, false);
    let started = Instant::now();
    let end = plant_loop::in_lockstep(&mut plant, scenario, &mut || Ok(()), watch)?;
    Ok(end.outcome(plant, Vec::new(), started))
}

/// Runs the controller, and what it serves beside; the plant is another process and says when it is over. `waiting` is called once if that
/// takes more than a second to answer.
///
/// # Errors
/// See [`RunError`].
pub fn controller_alone(
    scenario: &Scenario,
    companion: Option<Box<dyn Companion>>,
    waiting: &mut dyn FnMut(),
) -> Result<ControllerOutcome, RunError> {
    let bus = scenario.bus.open()?.ok_or(RunError::NoOtherProcess)?;
    let mut controller = ControllerNode::new(bus, configuration(scenario)?, &scenario.faults, scenario.ticks as usize);
    if let Some(companion) = companion {
        controller.serve(companion);
    }
    let name = scenario.bus.to_string();
    let session = handshake(
        controller.bus(),
        &name,
        Role::Controller,
        terms(scenario)?,
        PATIENCE,
        waiting,
    )?;
    controller.join(session);
    let started = Instant::now();
    let (lateness, plant_lost) = if scenario.clock == Clock::RealTime {
        let (lateness, lost) =
            controller_loop::in_real_time(&mut controller, scenario, started + TICK + CONTROLLER_PHASE)?;
        (Some(lateness), lost)
    } else {
        (None, controller_loop::in_lockstep(&mut controller, scenario)?)
    };
    Ok(ControllerOutcome {
        words: controller.words().to_vec(),
        account: controller.account().to_vec(),
        plant_lost,
        e2e_errors: controller.e2e_errors(),
        frames_lost: controller.frames_lost(),
        lateness,
        wall_s: started.elapsed().as_secs_f64(),
    })
}

/// The plant's and the controller's end of one bus.
type Ends = (Box<dyn Bus>, Box<dyn Bus>);

fn both_ends(scenario: &Scenario) -> Result<Ends, RunError> {
    let one_end = || RunError::OneEnd {
        bus: scenario.bus.to_string(),
    };
    match &scenario.bus {
        BusAddress::InProcess => {
            let (a, b) = in_process_pair();
            Ok((Box::new(a), Box::new(b)))
        }
        BusAddress::SocketCan(_) => {
            let open = || scenario.bus.open()?.ok_or_else(one_end);
            Ok((open()?, open()?))
        }
        BusAddress::SerialLine(_) => Err(one_end()),
    }
}

fn terms(scenario: &Scenario) -> Result<Terms, RunError> {
    // Every number of the description in its shortest exact form.
    let description = format!("{:?}", Parameters::read(scenario)?.description());
    Ok(Terms {
        strategy: scenario.strategy as u8,
        real_time: scenario.clock == Clock::RealTime,
        vehicle: Crc::<u16>::new(&CRC_16_IBM_3740).checksum(description.as_bytes()),
    })
}

#[cfg(test)]
mod course_tests;
#[cfg(test)]
mod resilience_tests;
#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::command_hash;
    use crate::scenario;
    use oleo_interface::{Corner, Corners};
    use std::time::Duration;

    pub(super) fn short(name: &str, ticks: u32) -> Scenario {
        Scenario {
            ticks,
            ..scenario::named(name).unwrap()
        }
    }

    pub(super) fn run(scenario: &Scenario, threads: usize) -> Outcome {
        both(scenario, vehicle(scenario).unwrap(), threads, &mut |_| true).unwrap()
    }

    pub(super) fn hash(outcome: &Outcome) -> String {
        command_hash(outcome.plant.recording.words())
    }

    #[test]
    fn one_thread_and_two_command_the_same() {
        let scenario = short("belgian", 300);
        let (one, two) = (run(&scenario, 1), run(&scenario, 2));
        assert_eq!(one.plant.recording.samples.len(), 300);
        assert_eq!(hash(&one), hash(&two));
        assert_eq!(one.plant.trace.len(), two.plant.trace.len());
        assert_eq!((one.plant.bus_frames_lost, one.plant.e2e_errors), (0, 0));
        assert_eq!(one.plant.frames_sent, 300 * 7 + 300 / 20);
    }

    #[test]
    fn parameters_that_were_read_drive_as_their_scenario_does_and_others_differ() {
        let scenario = short("belgian", 300);
        let read = || Parameters::read(&scenario).unwrap();
        let pressures = |parameters: &Parameters| -> Vec<_> {
            let outcome = both_of(&scenario, parameters, &mut |_| true).unwrap();
            let samples = outcome.plant.recording.samples.iter();
            samples.map(|sample| sample.strut).collect()
        };
        let as_read = pressures(&read());
        let of_scenario = run(&scenario, 1).plant.recording.samples;
        assert!(
            of_scenario
                .iter()
                .map(|sample| sample.strut)
                .eq(as_read.iter().copied())
        );
        let mut weak = oleo_plant_sim::strut::StrutModel::defender110(1.0);
        weak.accumulator[1].static_gas_volume_m3 *= 0.8;
        let on_others = pressures(&read().on_struts(Corners::from_fn(|_| weak.clone())));
        assert_ne!(on_others, as_read);
        // The controller of a vehicle that it takes for another one is configured for that one.
        let told = |parameters: Parameters| format!("{:?}", parameters.description());
        assert_ne!(told(read().telling_of(weak.clone())), told(read()));
        // One corner may differ, of which it is not told.
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), weak.to_toml()).unwrap();
        let mut differs = scenario.clone();
        differs.strut_at[Corner::RearLeft] = Some(file.path().display().to_string());
        let with_weak = Parameters::read(&differs).unwrap();
        let strut_at = |corner| match corner {
            Corner::RearLeft => weak.clone(),
            _ => oleo_plant_sim::strut::StrutModel::defender110(1.0),
        };
        let at_corner = pressures(&read().on_struts(Corners::from_fn(strut_at)));
        assert_eq!(pressures(&with_weak), at_corner);
        assert_ne!(at_corner, as_read);
        assert_eq!(told(with_weak), told(read()));
    }

    #[test]
    fn an_interrupted_run_ends_in_order() {
        let scenario = short("belgian", 1000);
        let mut calls = 0;
        let outcome = both(&scenario, vehicle(&scenario).unwrap(), 1, &mut |_| {
            calls += 1;
            calls < 3
        });
        let outcome = outcome.unwrap();
        assert!(outcome.interrupted);
        assert_eq!(
            outcome.plant.recording.samples.len(),
            3 * plant_loop::WATCH_TICKS as usize
        );
    }

    #[test]
    fn real_time_counts_its_deadlines() {
        let scenario = Scenario {
            clock: Clock::RealTime,
            ..short("belgian", 60)
        };
        let outcome = run(&scenario, 2);
        assert_eq!(outcome.lateness.len(), 2);
        assert!(
            outcome
                .lateness
                .iter()
                .any(|(role, late)| *role == Role::Plant && late.ticks == 60)
        );
        assert!(outcome.wall_s >= 0.295, "{}", outcome.wall_s);
    }

    /// A partner that stops answering as a killed process does: its end of the bus stays open and is silent.
    #[test]
    fn a_controller_that_falls_silent_costs_four_ticks_of_open_valves() {
        let scenario = Scenario {
            partner_timeout_s: 0.1,
            strategy: oleo_controller::Strategy::AlwaysSoft,
            ..short("belgian", 200)
        };
        let (a, b) = in_process_pair();
        let mut plant = PlantNode::new(a, &scenario, vehicle(&scenario).unwrap(), false);
        let mut controller = ControllerNode::new(b, configuration(&scenario).unwrap(), &[], 200);
        let mut turns = 0;
        let mut turn = || {
            turns += 1;
            if turns <= 100 && controller.listen(Duration::ZERO)? == Heard::Tick {
                controller.decide()?;
                controller.send_done()?;
            }
            Ok(())
        };
        let end = plant_loop::in_lockstep(&mut plant, &scenario, &mut turn, &mut |_| true).unwrap();
        assert_eq!(end.controller_lost_at, Some(100));
        let words: Vec<u16> = plant.into_result().recording.words().collect();
        assert_eq!(words.len(), 200, "it drives on");
        assert_ne!(words[99], 0);
        assert_eq!(words[100..103], [words[99]; 3], "the watchdog's patience");
        assert!(words[103..].iter().all(|word| *word == 0));
    }

    #[test]
    fn a_plant_that_falls_silent_makes_the_controller_safe_and_end() {
        let scenario = Scenario {
            partner_timeout_s: 0.1,
            ..short("belgian", 200)
        };
        let (a, b) = in_process_pair();
        let mut plant = PlantNode::new(a, &scenario, vehicle(&scenario).unwrap(), false);
        let mut controller = ControllerNode::new(b, configuration(&scenario).unwrap(), &[], 200);
        for _ in 0..100 {
            plant.send_sensors().unwrap();
            plant.send_done().unwrap();
            assert_eq!(controller.listen(Duration::ZERO).unwrap(), Heard::Tick);
            controller.decide().unwrap();
            controller.send_done().unwrap();
            plant.listen(Duration::ZERO).unwrap();
            plant.advance().unwrap();
        }
        let lost = controller_loop::in_lockstep(&mut controller, &scenario).unwrap();
        let lost = lost.unwrap();
        assert_eq!((lost.last_tick, lost.restarted), (99, false));
        assert!(lost.safe_after.is_some_and(|ticks| ticks <= 5), "{lost:?}");
        assert_eq!(controller.words().last(), Some(&0));
    }
}
