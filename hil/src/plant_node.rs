//! The plant as a node on the bus.
//!
//! In each tick it reads its sensors and sends them, takes the commands that come back, and lets the vehicle drive for 5 ms under
//! them. How long it waits between sending and driving is decided in [`crate::run`].

use std::time::Duration;

use oleo_controller::PlantEnd;
use oleo_plant_sim::course::{Ending, NotFinite, Track};

use crate::Frame;
use crate::bus::{Bus, BusError, FaultInjector, Trace};
use crate::instruments::{Instruments, StuckValves};
use crate::record::{Recording, Sample};
use crate::scenario::Scenario;
use crate::sync::{Role, Sync};
use crate::vehicle::Vehicle;

/// How the wait for the controller ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The controller has done its tick.
    Done,
    /// Nothing came for as long as was allowed.
    Nothing,
}

/// Vehicle, sensors and valves behind one end of a bus.
pub struct PlantNode<B> {
    bus: FaultInjector<Trace<B>>,
    end: PlantEnd,
    vehicle: Vehicle,
    instruments: Instruments,
    stuck: StuckValves,
    ticks_without_command: u32,
    recording: Recording,
    tick: u32,
    controller_sent: u16,
    tally: (u16, u16),
}

/// Number of frames in a tick, both directions together, for which the trace has memory.
const FRAMES_PER_TICK: usize = 8;

impl<B: Bus> PlantNode<B> {
    /// A plant at the start of the road. With `wall_clock` the traced frames carry the time.
    pub fn new(bus: B, scenario: &Scenario, vehicle: Vehicle, wall_clock: bool) -> Self {
        let ticks = scenario.ticks as usize;
        let injections: Vec<_> = scenario.faults.iter().filter_map(|fault| fault.injection()).collect();
        Self {
            bus: FaultInjector::new(
                Trace::new(bus, ticks * FRAMES_PER_TICK, wall_clock),
                &injections,
                scenario.seed,
            ),
            end: PlantEnd::new(),
            recording: Recording::with_capacity(ticks, vehicle.steps_per_tick() as usize, vehicle.step_s()),
            vehicle,
            instruments: Instruments::new(&scenario.faults, scenario.seed),
            stuck: StuckValves::new(&scenario.faults),
            ticks_without_command: 0,
            tick: 0,
            controller_sent: 0,
            tally: (0, 0),
        }
    }

    /// Number of completed ticks.
    pub fn tick(&self) -> u32 {
        self.tick
    }

    /// Begins a tick: reads the sensors and sends them.
    pub fn send_sensors(&mut self) -> Result<(), BusError> {
        self.bus.begin_tick(self.tick);
        let displacement_m = self.vehicle.strut_displacement_m();
        let struts = self.vehicle.strut_output();
        let inputs = self.instruments.read(self.tick, displacement_m, struts);
        for frame in self.end.encode(self.tick as u16, &inputs) {
            self.bus.send(&frame.into())?;
        }
        Ok(())
    }

    /// Tells the controller that all frames of this tick are on the bus.
    pub fn send_done(&mut self) -> Result<(), BusError> {
        let sent = self.bus.inner().messages_sent() as u16;
        self.bus
            .send(&Sync::TickDone { tick: self.tick, sent }.encode(Role::Plant))
    }

    /// Takes frames until the controller has done this tick, or until none came for `wait`.
    pub fn listen(&mut self, wait: Duration) -> Result<Answer, BusError> {
        while let Some(frame) = self.bus.receive(wait)? {
            match Sync::decode(&frame, Role::Controller) {
                Some(Sync::TickDone { tick, sent }) => {
                    self.controller_sent = sent;
                    if tick == self.tick {
                        return Ok(Answer::Done);
                    }
                }
                Some(Sync::Tally { sent, lost, e2e_errors }) => {
                    self.controller_sent = sent;
                    self.tally = (lost, e2e_errors);
                    return Ok(Answer::Done);
                }
                _ => self.take(&frame),
            }
        }
        Ok(Answer::Nothing)
    }

    fn take(&mut self, frame: &Frame) {
        if let Some(id) = frame.standard_id() {
            self.end.receive(id, frame.data());
        }
    }

    /// Ends the tick: drives for 5 ms under the command that came.
    ///
    /// # Errors
    /// The vehicle's motion is not finite.
    pub fn advance(&mut self) -> Result<(), NotFinite> {
        let command = self.end.end_of_tick();
        self.ticks_without_command = match self.end.output().ticks_without_command() {
            0 => 0,
            _ => self.ticks_without_command.saturating_add(1),
        };
        let energised = self.stuck.energised(self.tick, command);
        self.recording.samples.push(Sample {
            motion: self.vehicle.motion(),
            displacement_m: self.vehicle.strut_displacement_m(),
            strut: self.vehicle.strut_output(),
            command,
            energised,
        });
        let felt = &mut self.recording.seat_acceleration_m_s2;
        self.vehicle.drive(energised.corners(), |seats| felt.push(seats))?;
        self.tick += 1;
        Ok(())
    }

    /// Whether the vehicle's course is over: completed, or the vehicle has rolled over, spun or lost its track.
    pub fn is_over(&self) -> bool {
        self.vehicle.ending().is_some()
    }

    /// Says that the run is over. The controller answers with its tally, which is an [`Answer::Done`].
    pub fn send_end(&mut self) -> Result<(), BusError> {
        let sent = self.bus.inner().messages_sent() as u16;
        self.bus.send(&Sync::End { sent }.encode(Role::Plant))
    }

    /// Number of ticks since a command was last obeyed.
    pub fn ticks_without_command(&self) -> u32 {
        self.ticks_without_command
    }

    /// The bus through which the node sends and receives.
    pub fn bus(&mut self) -> &mut dyn Bus {
        &mut self.bus
    }

    /// Ends the node and returns what it knows.
    pub fn into_result(mut self) -> PlantResult {
        let trace = self.bus.inner_mut();
        let received = trace.messages_received() as u16;
        let (lost_by_controller, e2e_by_controller) = self.tally;
        let bus_lost = u64::from(self.controller_sent.wrapping_sub(received)) + u64::from(lost_by_controller);
        PlantResult {
            frames_sent: trace.messages_sent() + trace.messages_received(),
            bus_frames_lost: bus_lost,
            foreign_frames: trace.foreign(),
            trace: trace.take_entries(),
            e2e_errors: u64::from(self.end.output().errors()) + u64::from(e2e_by_controller),
            injected: self.bus.counts(),
            counters: self.bus.counters(),
            ending: self.vehicle.ending(),
            track: self.vehicle.track().cloned(),
            recording: self.recording,
        }
    }
}

/// What the plant's node knows at the end of a run.
#[derive(Debug)]
pub struct PlantResult {
    /// Samples of the run.
    pub recording: Recording,
    /// Every frame that was on the wire, in order.
    pub trace: Vec<crate::bus::TraceEntry>,
    /// Number of messages of the database that were on the wire, both directions together.
    pub frames_sent: u64,
    /// How many of them one end sent and the other did not receive.
    pub bus_frames_lost: u64,
    /// Number of frames with other identifiers.
    pub foreign_frames: u64,
    /// Number of frames that failed their end-to-end check, at either end.
    pub e2e_errors: u64,
    /// What the fault injector did to frames.
    pub injected: crate::bus::InjectionCounts,
    /// Counters of the plant's end of the bus.
    pub counters: crate::bus::BusCounters,
    /// How the course ended; `None` without a course, and for a run that was stopped.
    pub ending: Option<Ending>,
    /// The line that the driver followed, with its cones.
    pub track: Option<Track>,
}
