//! One run: parts put together, a clock over them, an end in every case.
//!
//! | run | nodes here | who waits for whom |
//! |---|---|---|
//! | lockstep, 1 thread | both | taking turns |
//! | lockstep, 2 threads | both | each for the other's `TickDone` |
//! | lockstep, `--node` | one | the same, across processes |
//! | real time | both (2 threads) or one | nobody: deadlines |
//!
//! The first three give the same commands, bit for bit. A partner that stays silent for the scenario's `partner_timeout_s` is gone: the plant
//! drives on with de-energised valves (or ends, as the scenario says), the controller ticks on until it is safe, and ends.

mod controller_loop;
mod plant_loop;

use std::sync::Arc;
use std::time::{Duration, Instant};

use oleo_controller::strategy::Strategy;
use oleo_controller::{Configuration, FaultCode, Mode};
use oleo_interface::Corners;
use oleo_plant_sim::road;
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::{RideVehicle, VehicleParameters};

use crate::bus::{Bus, BusAddress, BusError, in_process_pair};
use crate::clock::Lateness;
use crate::controller_node::{ControllerNode, Heard};
use crate::plant_node::{PlantNode, PlantRemains};
use crate::scenario::file::DEFENDER;
use crate::scenario::{Clock, Scenario, TICK_S};
use crate::sync::{HandshakeError, Role, Terms, handshake};

/// Why a run did not come about.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The strut model is wrong.
    #[error(transparent)]
    Strut(#[from] oleo_plant_sim::strut::ModelError),
    /// The vehicle's parameters are wrong.
    #[error(transparent)]
    Vehicle(#[from] oleo_plant_sim::vehicle::ParameterError),
    /// Strut and vehicle do not go together.
    #[error(transparent)]
    Ride(#[from] oleo_plant_sim::vehicle::RideError),
    /// The road is wrong.
    #[error(transparent)]
    Road(#[from] oleo_plant_sim::road::RoadError),
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// The nodes did not find together.
    #[error(transparent)]
    Handshake(#[from] HandshakeError),
    /// A file cannot be read.
    #[error("{path}: cannot be read: {source}; give {DEFENDER} or the path of a TOML file")]
    Unreadable {
        /// Which.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// The integration step does not divide the tick.
    #[error("{vehicle}: solver.step_s is {step_s}: must divide the controller's tick of {TICK_S} s")]
    Step {
        /// Parameter file.
        vehicle: String,
        /// Its step, s.
        step_s: f64,
    },
    /// A bus with one end only.
    #[error("{bus} connects two programs: add --node plant or --node controller, and start the other one too")]
    OneEnd {
        /// Address.
        bus: String,
    },
    /// In memory, there is no other process.
    #[error("--node needs a bus that another process can reach: add --bus socketcan:IFACE or --bus slcan:DEVICE")]
    NoOtherProcess,
}

/// Called every few ticks with the number of ticks done; `false` ends the run early.
pub type Watch<'a> = &'a mut dyn FnMut(u32) -> bool;

/// How long a node looks for its partner.
const PATIENCE: Duration = Duration::from_secs(60);
/// Between the plant's deadline and the controller's in real time.
const CONTROLLER_PHASE: Duration = Duration::from_micros(2500);
const TICK: Duration = Duration::from_millis(oleo_controller::timing::TICK_MS as u64);

/// The plant's parts, made before the clock starts.
pub struct Plant {
    parameters: VehicleParameters,
    vehicle: RideVehicle,
}

impl Plant {
    /// Makes road, struts and vehicle of a scenario.
    ///
    /// # Errors
    /// Files that are missing or wrong; parts that do not go together.
    pub fn build(scenario: &Scenario) -> Result<Self, RunError> {
        let read = |path: &str| {
            std::fs::read_to_string(path).map_err(|source| RunError::Unreadable {
                path: path.into(),
                source,
            })
        };
        let parameters = match scenario.vehicle.as_str() {
            DEFENDER => VehicleParameters::defender110(),
            path => VehicleParameters::from_toml(&read(path)?, path)?,
        };
        let step_s = parameters.solver.step_s;
        let steps = TICK_S / step_s;
        if (steps - steps.round()).abs() > 1e-9 * steps || steps < 0.5 {
            return Err(RunError::Step {
                vehicle: scenario.vehicle.clone(),
                step_s,
            });
        }
        let model = match scenario.strut.as_str() {
            DEFENDER => None,
            path => Some(StrutModel::from_toml(&read(path)?, path)?),
        };
        // Each corner is charged for the load it carries, as one does in a workshop.
        let mut struts = Vec::with_capacity(4);
        for load_n in parameters.static_strut_load_n().into_array() {
            let model = match &model {
                None => StrutModel::defender110(load_n),
                Some(model) => {
                    let mut charged = model.clone();
                    charged.cylinder.static_pressure_pa = load_n / model.piston_area_m2();
                    charged
                }
            };
            struts.push(Strut::at_rest(&model, [false; 3])?);
        }
        let Ok(struts) = <[Strut; 4]>::try_from(struts) else {
            unreachable!("four loads make four struts")
        };
        let road: Arc<dyn road::Road> =
            road::from_name_or_path(&scenario.road, scenario.road_length_m(), scenario.seed)?;
        let vehicle = RideVehicle::new(&parameters, Corners::from_array(struts), road, scenario.speed_m_s)?;
        Ok(Self { parameters, vehicle })
    }
}

/// The controller's configuration for a scenario.
pub fn configuration(scenario: &Scenario) -> Configuration {
    Configuration::defender110()
        .with_strategy(scenario.strategy)
        .with_damper_policy(scenario.damper_policy)
}

/// What a run with a plant leaves behind.
#[derive(Debug)]
pub struct Outcome {
    /// Samples, frames, counters.
    pub remains: PlantRemains,
    /// Wall-clock time of the loop alone, s.
    pub wall_s: f64,
    /// How the plant's and (where it ran here) the controller's deadlines were met, in real time.
    pub lateness: Vec<(Role, Lateness)>,
    /// Tick in which the controller was given up.
    pub controller_lost_at: Option<u32>,
    /// Somebody asked to stop.
    pub interrupted: bool,
}

/// How a controller node's run ended.
#[derive(Debug)]
pub struct ControllerOutcome {
    /// Words commanded, one a tick.
    pub words: Vec<u16>,
    /// Modes entered: tick, mode, first cause.
    pub account: Vec<(u32, Mode, FaultCode)>,
    /// If the plant went silent: its last tick, and the ticks from there to a safe mode (`None`: not reached).
    pub plant_lost: Option<(u32, Option<u32>)>,
    /// Frames that failed their end-to-end check.
    pub e2e_errors: u64,
    /// Frames that did not arrive.
    pub frames_lost: u64,
    /// How deadlines were met, in real time.
    pub lateness: Option<Lateness>,
    /// Wall-clock time of the loop alone, s.
    pub wall_s: f64,
}

fn guard(scenario: &Scenario) -> Duration {
    Duration::from_secs_f64(scenario.partner_timeout_s)
}

/// Runs both nodes in this process, in `threads` (1 or 2; real time always takes 2).
///
/// # Errors
/// See [`RunError`].
pub fn both(scenario: &Scenario, plant: Plant, threads: usize, watch: Watch) -> Result<Outcome, RunError> {
    let (plant_end, controller_end) = both_ends(scenario)?;
    let real_time = scenario.clock == Clock::RealTime;
    let mut plant = PlantNode::new(plant_end, scenario, &plant.parameters, plant.vehicle, real_time);
    let mut controller = ControllerNode::new(controller_end, configuration(scenario), scenario.ticks as usize);
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
        let wait = guard(scenario);
        let mut turn = || match controller.listen(wait)? {
            Heard::Tick => {
                controller.decide()?;
                controller.send_done()
            }
            Heard::End => controller.send_tally(),
            Heard::Nothing => Ok(()),
        };
        plant_loop::in_lockstep(&mut plant, scenario, &mut turn, watch)?
    };
    Ok(end.outcome(plant, lateness, started))
}

/// Runs the plant; the controller is another process.
///
/// # Errors
/// See [`RunError`].
pub fn plant_alone(scenario: &Scenario, plant: Plant, watch: Watch) -> Result<Outcome, RunError> {
    let bus = scenario.bus.open()?.ok_or(RunError::NoOtherProcess)?;
    let real_time = scenario.clock == Clock::RealTime;
    let mut plant = PlantNode::new(bus, scenario, &plant.parameters, plant.vehicle, real_time);
    handshake(
        plant.bus(),
        &scenario.bus.to_string(),
        Role::Plant,
        terms(scenario),
        PATIENCE,
    )?;
    let started = Instant::now();
    let end = if real_time {
        plant_loop::in_real_time(&mut plant, scenario, started + TICK, watch)?
    } else {
        plant_loop::in_lockstep(&mut plant, scenario, &mut || Ok(()), watch)?
    };
    Ok(end.outcome(plant, Vec::new(), started))
}

/// Runs the controller; the plant is another process and says when it is over.
///
/// # Errors
/// See [`RunError`].
pub fn controller_alone(scenario: &Scenario) -> Result<ControllerOutcome, RunError> {
    let bus = scenario.bus.open()?.ok_or(RunError::NoOtherProcess)?;
    let mut controller = ControllerNode::new(bus, configuration(scenario), scenario.ticks as usize);
    handshake(
        controller.bus(),
        &scenario.bus.to_string(),
        Role::Controller,
        terms(scenario),
        PATIENCE,
    )?;
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

fn terms(scenario: &Scenario) -> Terms {
    let position = Strategy::ALL
        .iter()
        .position(|(_, strategy)| *strategy == scenario.strategy)
        .unwrap_or(0);
    Terms {
        strategy: position as u8,
        clock: scenario.clock as u8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::command_hash;
    use crate::scenario;

    fn short(name: &str, ticks: u32) -> Scenario {
        Scenario {
            ticks,
            ..scenario::named(name).unwrap()
        }
    }

    fn run(scenario: &Scenario, threads: usize) -> Outcome {
        both(scenario, Plant::build(scenario).unwrap(), threads, &mut |_| true).unwrap()
    }

    fn hash(outcome: &Outcome) -> String {
        command_hash(outcome.remains.recording.words())
    }

    #[test]
    fn one_thread_and_two_command_the_same() {
        let scenario = short("belgian", 300);
        let (one, two) = (run(&scenario, 1), run(&scenario, 2));
        assert_eq!(one.remains.recording.samples.len(), 300);
        assert_eq!(hash(&one), hash(&two));
        assert_eq!(one.remains.trace.len(), two.remains.trace.len());
        assert_eq!((one.remains.bus_frames_lost, one.remains.e2e_errors), (0, 0));
        assert_eq!(one.remains.frames_sent, 300 * 7 + 300 / 20);
    }

    #[test]
    fn an_interrupted_run_ends_in_order() {
        let scenario = short("belgian", 1000);
        let mut calls = 0;
        let outcome = both(&scenario, Plant::build(&scenario).unwrap(), 1, &mut |_| {
            calls += 1;
            calls < 3
        });
        let outcome = outcome.unwrap();
        assert!(outcome.interrupted);
        assert_eq!(
            outcome.remains.recording.samples.len(),
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

    /// A partner that stops answering, as a killed process does: the other end stays open and silent.
    #[test]
    fn a_controller_that_falls_silent_costs_four_ticks_of_open_valves() {
        let scenario = Scenario {
            partner_timeout_s: 0.1,
            strategy: Strategy::AlwaysSoft,
            ..short("belgian", 200)
        };
        let (a, b) = in_process_pair();
        let parts = Plant::build(&scenario).unwrap();
        let mut plant = PlantNode::new(a, &scenario, &parts.parameters, parts.vehicle, false);
        let mut controller = ControllerNode::new(b, configuration(&scenario), 200);
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
        let words: Vec<u16> = plant.into_remains().recording.words().collect();
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
        let parts = Plant::build(&scenario).unwrap();
        let mut plant = PlantNode::new(a, &scenario, &parts.parameters, parts.vehicle, false);
        let mut controller = ControllerNode::new(b, configuration(&scenario), 200);
        for _ in 0..100 {
            plant.send_sensors().unwrap();
            plant.send_done().unwrap();
            assert_eq!(controller.listen(Duration::ZERO).unwrap(), Heard::Tick);
            controller.decide().unwrap();
            controller.send_done().unwrap();
            plant.listen(Duration::ZERO).unwrap();
            plant.advance();
        }
        let lost = controller_loop::in_lockstep(&mut controller, &scenario).unwrap();
        let (last, taken) = lost.unwrap();
        assert_eq!(last, 99);
        assert!(taken.is_some_and(|ticks| ticks <= 5), "{taken:?}");
        assert_eq!(controller.words().last(), Some(&0));
    }
}
