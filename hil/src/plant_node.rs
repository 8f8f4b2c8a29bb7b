//! The plant as a node on the bus.
//!
//! In each tick it reads its sensors and sends them, takes the commands that come back, and lets the vehicle drive for 5 ms under
//! them. How long it waits between sending and driving is decided in [`crate::run`].

use std::time::Duration;

use oleo_controller::PlantEnd;
use oleo_plant_sim::course::{Ending, NotFinite, Track};
use oleo_plant_sim::vehicle::InertialReading;

use crate::Frame;
use crate::bus::{Bus, BusError, FaultInjector, Trace, TraceEntry};
use crate::deadline::Deadline;
use crate::imu::{self, Unit};
use crate::instruments::{Instruments, StuckValves};
use crate::newcomer::Newcomer;
use crate::record::{Recording, Sample};
use crate::scenario::Scenario;
use crate::sync::{Decoded, Role, Session, Sync, Terms};
use crate::vehicle::{Assembly, Vehicle};

/// How the wait for the controller ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The controller has done its tick.
    Done,
    /// The controller was started again and has been let in; this tick has no answer.
    Rejoined,
    /// No answer came within the time that was allowed.
    Nothing,
}

/// Vehicle, sensors and valves behind one end of a bus.
pub struct PlantNode<B> {
    bus: FaultInjector<Trace<B>>,
    end: PlantEnd,
    vehicle: Vehicle,
    instruments: Instruments,
    unit: Option<Unit>,
    stuck: StuckValves,
    ticks_without_command: u32,
    recording: Recording,
    tick: u32,
    session: Session,
    /// What a controller that is started again must want; `None` where it cannot be.
    terms: Option<Terms>,
    newcomer: Newcomer,
    rejoined: u32,
    strangers: u64,
    /// Messages that had been sent and received when the session began.
    before: (u64, u64),
    controller_sent: u64,
    controller_lost: u32,
    controller_e2e_errors: u16,
    ended: bool,
}

/// The part of a tick's number that a `TickDone` carries.
const TICK_MASK: u32 = 0xFF_FFFF;

/// Number of frames in a tick, both directions together, for which the trace has memory.
const FRAMES_PER_TICK: usize = 8 + imu::MESSAGES.len();

impl<B: Bus> PlantNode<B> {
    /// A plant at the start of the road. With `wall_clock` the traced frames carry the time.
    pub fn new(bus: B, scenario: &Scenario, vehicle: Vehicle, wall_clock: bool) -> Self {
        let ticks = scenario.ticks as usize;
        let recording = Recording::with_capacity(ticks, vehicle.steps_per_tick() as usize, vehicle.step_s());
        let injections: Vec<_> = scenario.faults.iter().filter_map(|fault| fault.injection()).collect();
        Self {
            bus: FaultInjector::new(
                Trace::new(bus, ticks * FRAMES_PER_TICK, wall_clock),
                &injections,
                scenario.seed,
            ),
            end: PlantEnd::new(),
            recording: if vehicle.records_struts() {
                recording.with_struts()
            } else {
                recording
            },
            vehicle,
            instruments: Instruments::new(&scenario.faults, scenario.seed),
            unit: scenario.imu.as_ref().map(|settings| Unit::new(settings, scenario.seed)),
            stuck: StuckValves::new(&scenario.faults),
            ticks_without_command: 0,
            tick: 0,
            session: Session::default(),
            terms: None,
            newcomer: Newcomer::default(),
            rejoined: 0,
            strangers: 0,
            before: (0, 0),
            controller_sent: 0,
            controller_lost: 0,
            controller_e2e_errors: 0,
            ended: false,
        }
    }

    /// Takes part in a session whose controller is another process, which may be started again.
    pub fn join(&mut self, session: Session, terms: Terms) {
        (self.session, self.terms) = (session, Some(terms));
    }

    /// Number of completed ticks.
    pub fn tick(&self) -> u32 {
        self.tick
    }

    /// What was driven until now.
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// The frames until now.
    pub fn trace(&self) -> &[TraceEntry] {
        self.bus.inner().entries()
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
        let read = self.inertial();
        if let (Some(unit), Some(read)) = (&mut self.unit, read) {
            for frame in unit.frames(&read) {
                self.bus.send(&frame)?;
            }
        }
        Ok(())
    }

    /// What the inertial unit would read now without noise, in its own axes.
    fn inertial(&self) -> Option<InertialReading> {
        let body = self.vehicle.inertial()?;
        Some(self.unit.as_ref()?.without_noise(&body))
    }

    /// Tells the controller that all frames of this tick are on the bus.
    pub fn send_done(&mut self) -> Result<(), BusError> {
        let sent = self.sent() as u16;
        self.say(Sync::TickDone { tick: self.tick, sent })
    }

    /// Number of messages sent in this session.
    fn sent(&self) -> u64 {
        self.bus.inner().messages_sent() - self.before.0
    }

    fn say(&mut self, sync: Sync) -> Result<(), BusError> {
        self.bus.send(&sync.encode(Role::Plant, self.session))
    }

    /// Takes frames until the controller has done this tick, but for no longer than `wait`, whatever else comes meanwhile.
    pub fn listen(&mut self, wait: Duration) -> Result<Answer, BusError> {
        let mut deadline = Deadline::new(wait);
        while let Some(left) = deadline.left() {
            let Some(frame) = self.bus.receive(left)? else { break };
            match Sync::decode(&frame, Role::Controller, self.session) {
                Decoded::Partner(sync) => {
                    if let Some(answer) = self.heed(sync)? {
                        return Ok(answer);
                    }
                }
                Decoded::Stranger => self.strangers += 1,
                Decoded::Other => self.take(&frame),
            }
        }
        Ok(Answer::Nothing)
    }

    /// Takes a frame of the exchange. Returns the answer that it completes.
    fn heed(&mut self, sync: Sync) -> Result<Option<Answer>, BusError> {
        match sync {
            Sync::TickDone { tick, sent } if tick == self.tick & TICK_MASK => {
                // The count is sent modulo 65536, and far fewer messages are in a tick.
                let more = sent.wrapping_sub(self.controller_sent as u16);
                self.controller_sent += u64::from(more);
                self.newcomer.dismiss();
                return Ok(Some(Answer::Done));
            }
            Sync::Losses { lost, e2e_errors } if self.ended => {
                (self.controller_lost, self.controller_e2e_errors) = (lost, e2e_errors);
            }
            Sync::Tally { sent } if self.ended => {
                self.controller_sent = sent;
                return Ok(Some(Answer::Done));
            }
            Sync::Hello { terms, number, .. } if Some(terms) == self.terms => {
                if number != self.session.controller && self.newcomer.hello(number) {
                    self.newcomer.dismiss();
                    self.session.controller = number;
                    self.rejoined += 1;
                    let trace = self.bus.inner();
                    self.before = (trace.messages_sent(), trace.messages_received());
                    self.controller_sent = 0;
                    let number = self.session.plant;
                    self.say(Sync::Hello {
                        terms,
                        heard: true,
                        number,
                    })?;
                    return Ok(Some(Answer::Rejoined));
                }
            }
            _ => self.strangers += 1,
        }
        Ok(None)
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
            0 => {
                self.newcomer.dismiss();
                0
            }
            _ => self.ticks_without_command.saturating_add(1),
        };
        let energised = self.stuck.energised(self.tick, command);
        self.recording.samples.push(Sample {
            motion: self.vehicle.motion(),
            displacement_m: self.vehicle.strut_displacement_m(),
            strut: self.vehicle.strut_output(),
            inertial: self.inertial(),
            heard: self.ticks_without_command == 0,
            command,
            energised,
        });
        let Recording {
            seat_acceleration_m_s2: felt,
            strut_steps,
            ..
        } = &mut self.recording;
        self.vehicle.drive(energised.corners(), |seats, struts| {
            felt.push(seats);
            strut_steps.extend(struts);
        })?;
        self.tick += 1;
        Ok(())
    }

    /// Whether the vehicle's course is over: completed, or the vehicle has rolled over, spun or lost its track.
    pub fn is_over(&self) -> bool {
        self.vehicle.ending().is_some()
    }

    /// Says that the run is over. The controller answers with its tally, which is an [`Answer::Done`].
    pub fn send_end(&mut self) -> Result<(), BusError> {
        self.ended = true;
        let sent = self.sent();
        self.say(Sync::End { sent })
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
        let received = trace.messages_received() - self.before.1;
        let lost_here = self.controller_sent.saturating_sub(received);
        let bus_lost = lost_here + u64::from(self.controller_lost);
        PlantResult {
            frames_sent: trace.messages_sent() + trace.messages_received() + trace.unit_messages_sent(),
            bus_frames_lost: bus_lost,
            foreign_frames: trace.foreign(),
            foreign_sync_frames: self.strangers,
            controller_rejoined: self.rejoined,
            trace: trace.take_entries(),
            e2e_errors: u64::from(self.end.output().errors()) + u64::from(self.controller_e2e_errors),
            injected: self.bus.counts(),
            counters: self.bus.counters(),
            ending: self.vehicle.ending(),
            track: self.vehicle.track().cloned(),
            assembly: self.vehicle.assembly().clone(),
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
    pub trace: Vec<TraceEntry>,
    /// Number of messages of the database that were on the wire, both directions together, and of the inertial unit's.
    pub frames_sent: u64,
    /// How many of them one end sent and the other did not receive.
    pub bus_frames_lost: u64,
    /// Number of frames with other identifiers.
    pub foreign_frames: u64,
    /// Number of frames of [`crate::sync`] that belonged to another run, or to no moment of this one. They were ignored.
    pub foreign_sync_frames: u64,
    /// Number of times that the controller was started again during the run.
    pub controller_rejoined: u32,
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
    /// What the vehicle was made of.
    pub assembly: Assembly,
}
