//! One run of a plan: vehicle, sensors' node, bus, controller, output stage, tick by tick, and the rules after each.

use core::ops::AddAssign;

use oleo_controller::can::COMMAND;
use oleo_controller::{Configuration, Corners, FaultCode, Inputs, Mode, Node, Outputs, PlantEnd, ValveCommand};

use super::bus::{self, Crossing, OnBus};
use super::plan::{Event, Plan, What};
use super::readings;
use super::rules::{Broken, Observation, Restart, Rules, TIMEOUT};
use super::vehicle::Vehicle;

/// Ticks that were spent in each mode, and under each fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reached {
    /// Ticks altogether.
    pub ticks: u64,
    /// Ticks in each mode, by its number on the bus.
    pub modes: [u64; 5],
    /// Ticks under each first cause, by its number on the bus.
    pub faults: [u64; 12],
}

impl Reached {
    fn add(&mut self, mode: Mode, fault: FaultCode) {
        self.ticks += 1;
        self.modes[usize::from(mode.raw())] += 1;
        self.faults[usize::from(fault.raw())] += 1;
    }
}

impl AddAssign for Reached {
    fn add_assign(&mut self, other: Self) {
        self.ticks += other.ticks;
        let add = |(sum, more): (&mut u64, u64)| *sum += more;
        self.modes.iter_mut().zip(other.modes).for_each(add);
        self.faults.iter_mut().zip(other.faults).for_each(add);
    }
}

/// An event with what it remembers.
struct Fault {
    event: Event,
    reading: readings::Memory,
    sensors: bus::Memory,
    commands: bus::Memory,
}

/// Everything that is driven.
struct World {
    configuration: Configuration,
    vehicle: Vehicle,
    node: Node,
    plant: PlantEnd,
    driven: ValveCommand,
    /// What the last tick said.
    outputs: Outputs,
    sensors_silent: u32,
    commands_silent: u32,
    /// Ticks since something happened to a sensor's frame, or the controller was restarted.
    undisturbed: u32,
    /// Ticks for which each reading has been missing.
    missing: [u32; READINGS],
}

/// Four displacements and sixteen pressures.
const READINGS: usize = 20;

/// Runs a plan. `change` may change what the rules see in each tick: a test that plants a violation does so.
///
/// # Errors
/// The first tick in which a rule does not hold.
pub fn drive(plan: &Plan, mut change: impl FnMut(&mut Observation)) -> Result<Reached, Broken> {
    let configuration = Configuration::defender110().with_strategy(plan.strategy);
    let mut world = World {
        vehicle: Vehicle::new(plan.road_m, plan.lean_m),
        node: Node::new(configuration),
        configuration,
        plant: PlantEnd::new(),
        driven: ValveCommand::SAFE,
        outputs: Outputs::default(),
        sensors_silent: 0,
        commands_silent: 0,
        undisturbed: 0,
        missing: [0; READINGS],
    };
    let mut faults: Vec<Fault> = (plan.events.iter())
        .map(|&event| Fault {
            event,
            reading: readings::Memory::default(),
            sensors: bus::Memory::default(),
            commands: bus::Memory::default(),
        })
        .collect();
    let (mut rules, mut reached) = (Rules::default(), Reached::default());
    for tick in 0..plan.ticks {
        let mut seen = world.step(tick, &mut faults);
        change(&mut seen);
        rules.check(&seen)?;
        reached.add(seen.mode, seen.fault);
    }
    Ok(reached)
}

impl World {
    fn step(&mut self, tick: u32, faults: &mut [Fault]) -> Observation {
        let present = |faults: &[Fault], what: What| {
            faults
                .iter()
                .any(|fault| fault.event.what == what && fault.event.present(tick).is_some())
        };
        let restart = [
            (What::PowerCycle, Restart::PowerCycle),
            (What::ResetAfterInternalFault, Restart::AfterInternalFault),
            (What::Reset, Restart::Reset),
        ]
        .into_iter()
        .find(|(what, _)| present(faults, *what))
        .map(|(_, restart)| restart);
        if let Some(restart) = restart {
            self.restart(restart);
        }
        let solenoid_failed = present(faults, What::SolenoidFails);
        if solenoid_failed {
            self.node.report_solenoid_failure();
        }

        let inputs = self.sensors(tick, faults);
        let (own_identifier, touched) = self.deliver_sensors(tick, faults, &inputs);
        self.undisturbed = if touched || restart.is_some() {
            0
        } else {
            self.undisturbed.saturating_add(1)
        };
        let pressures = inputs.pressure.values().flat_map(|strut| strut.into_array());
        let readings = inputs.displacement.values().copied().chain(pressures);
        for (ticks, reading) in self.missing.iter_mut().zip(readings) {
            *ticks = if self.undisturbed <= TIMEOUT || reading.is_valid() {
                0
            } else {
                *ticks + 1
            };
        }

        let (outputs, sent) = self.node.tick();
        self.outputs = outputs;
        self.deliver_commands(tick, faults, sent.iter().map(OnBus::from).collect());
        Observation {
            tick,
            mode: outputs.mode,
            fault: outputs.fault,
            commanded: outputs.command.word(),
            driven: self.driven.word(),
            finite: outputs.estimate.is_finite() && outputs.trapped_shift_m.values().all(|shift| shift.is_finite()),
            restart,
            own_identifier,
            solenoid_failed,
            sensors_silent: self.sensors_silent,
            commands_silent: self.commands_silent,
            reading_missing: self.missing.into_iter().max().unwrap_or(0),
        }
    }

    /// A new controller, which latches at once where the firmware's would.
    fn restart(&mut self, restart: Restart) {
        self.node = Node::new(self.configuration);
        let latched = (self.outputs.mode == Mode::Latched).then_some(self.outputs.fault);
        let kept = match restart {
            Restart::PowerCycle => None,
            Restart::Reset => latched,
            Restart::AfterInternalFault => latched.or(Some(FaultCode::Internal)),
        };
        if let Some(cause) = kept {
            self.node.latch(cause);
        }
    }

    /// What the sensors say in a tick.
    fn sensors(&mut self, tick: u32, faults: &mut [Fault]) -> Inputs {
        let mut stuck = Corners::splat(None);
        for Fault { event, .. } in faults.iter().filter(|fault| fault.event.present(tick).is_some()) {
            match event.what {
                What::ValveStuckOpen => stuck[event.corner] = Some(true),
                What::ValveStuckClosed => stuck[event.corner] = Some(false),
                _ => {}
            }
        }
        let mut inputs = self.vehicle.step(tick, self.driven, stuck);
        for fault in faults {
            if let Some(since) = fault.event.present(tick) {
                readings::spoil(&fault.event, since, &mut fault.reading, &mut inputs);
            }
        }
        inputs
    }

    /// Brings the sensors' frames to the controller. Returns whether it hears one of its own identifiers, and whether anything happened
    /// to a frame.
    fn deliver_sensors(&mut self, tick: u32, faults: &mut [Fault], inputs: &Inputs) -> (bool, bool) {
        let before = self.plant;
        let sent = self.plant.encode(tick as u16, inputs);
        let mut frames: Vec<OnBus> = sent.iter().map(OnBus::from).collect();
        for fault in faults {
            if let Some(since) = fault.event.present(tick) {
                let mut crossing = Crossing {
                    tick,
                    frames: &mut frames,
                    sender: &before,
                };
                bus::spoil_sensors(&fault.event, since, &mut fault.sensors, &mut crossing);
            }
        }
        for frame in &frames {
            self.node.receive(frame.id, frame.data());
        }
        let is_sensors = |frame: &OnBus| sent.iter().any(|sent| sent.id == frame.id);
        self.sensors_silent = if frames.iter().any(is_sensors) {
            0
        } else {
            self.sensors_silent + 1
        };
        let as_sent = frames.len() == sent.len()
            && frames
                .iter()
                .zip(&sent)
                .all(|(frame, sent)| frame.id == sent.id && frame.data() == sent.data);
        let own = |frame: &OnBus| frame.id == COMMAND.id || frame.id == oleo_controller::can::STATUS.id;
        (frames.iter().any(own), !as_sent)
    }

    /// Brings the controller's frames to the output stage, which ends the tick.
    fn deliver_commands(&mut self, tick: u32, faults: &mut [Fault], mut frames: Vec<OnBus>) {
        for fault in faults {
            if let Some(since) = fault.event.present(tick) {
                let mut crossing = Crossing {
                    tick,
                    frames: &mut frames,
                    sender: &self.plant,
                };
                bus::spoil_commands(&fault.event, since, &mut fault.commands, &mut crossing);
            }
        }
        for frame in &frames {
            self.plant.receive(frame.id, frame.data());
        }
        let commanded = frames.iter().any(|frame| frame.id == COMMAND.id);
        self.commands_silent = if commanded { 0 } else { self.commands_silent + 1 };
        self.driven = self.plant.end_of_tick();
    }
}
