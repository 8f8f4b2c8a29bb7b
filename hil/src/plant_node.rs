//! The plant as a node on the bus: measures, sends, listens, moves on.
//!
//! A tick n is: read the sensors at its beginning and send them; take the commands that come back; let the vehicle roll for
//! 5 ms under them. What lies between sending and moving on (waiting for the partner, or for a deadline) is the clock's
//! business, in [`crate::run`].

use std::time::Duration;

use oleo_controller::can::PlantEnd;
use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::vehicle::{RideVehicle, VehicleParameters};

use crate::Frame;
use crate::bus::{Bus, BusError, FaultInjector, Trace};
use crate::instruments::{Instruments, OutputStage};
use crate::record::{Recording, Sample};
use crate::scenario::{Scenario, TICK_S};
use crate::sync::{Role, Sync};

/// What ended the wait for the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// It has done its tick.
    Done,
    /// Nothing for as long as was allowed.
    Nothing,
}

/// Vehicle, sensors and valves behind one end of a bus.
pub struct PlantNode<B> {
    bus: FaultInjector<Trace<B>>,
    end: PlantEnd,
    vehicle: RideVehicle,
    steps_per_tick: u32,
    seats: [(f64, f64); 2],
    instruments: Instruments,
    output: OutputStage,
    recording: Recording,
    tick: u32,
    controller_sent: u16,
    tally: (u16, u16),
}

/// Frames of a tick in both directions, for the trace's memory.
const FRAMES_PER_TICK: usize = 8;

impl<B: Bus> PlantNode<B> {
    /// A plant at its start. `wall_clock`: traced frames carry the time.
    pub fn new(
        bus: B,
        scenario: &Scenario,
        parameters: &VehicleParameters,
        vehicle: RideVehicle,
        wall_clock: bool,
    ) -> Self {
        let ticks = scenario.ticks as usize;
        let injections: Vec<_> = scenario.faults.iter().filter_map(|fault| fault.injection()).collect();
        let steps_per_tick = (TICK_S / vehicle.step_s()).round() as u32;
        let seats = [&parameters.driver_seat, &parameters.passenger_seat].map(|seat| parameters.seat_position_m(seat));
        Self {
            bus: FaultInjector::new(
                Trace::new(bus, ticks * FRAMES_PER_TICK, wall_clock),
                &injections,
                scenario.seed,
            ),
            end: PlantEnd::new(),
            recording: Recording::with_capacity(ticks, steps_per_tick as usize, vehicle.step_s()),
            vehicle,
            steps_per_tick,
            seats,
            instruments: Instruments::new(&scenario.faults),
            output: OutputStage::new(&scenario.faults),
            tick: 0,
            controller_sent: 0,
            tally: (0, 0),
        }
    }

    /// Ticks completed.
    pub fn tick(&self) -> u32 {
        self.tick
    }

    /// Begins a tick: sends what the sensors say.
    pub fn send_sensors(&mut self) -> Result<(), BusError> {
        self.bus.begin_tick(self.tick);
        let displacement_m = self.vehicle.strut_displacement_m().into_array();
        let inputs = self
            .instruments
            .read(self.tick, displacement_m, self.vehicle.strut_output().into_array());
        for frame in self.end.encode(self.tick as u16, &inputs) {
            self.bus.send(&frame.into())?;
        }
        Ok(())
    }

    /// Tells the controller that all of this tick is on the bus.
    pub fn send_done(&mut self) -> Result<(), BusError> {
        let sent = self.bus.inner().messages_sent() as u16;
        self.bus
            .send(&Sync::TickDone { tick: self.tick, sent }.encode(Role::Plant))
    }

    /// Takes frames until the controller has done this tick, or none came for `wait`.
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
        if let Some(id) = frame.standard_id()
            && let Some((status, message)) = self.end.receive(id, frame.data())
        {
            self.output.receive(status, message);
        }
    }

    /// Ends the tick: 5 ms of driving under the commands that came.
    pub fn advance(&mut self) {
        if !self.output.end_of_tick() {
            self.end.no_command();
        }
        let energised = self.output.energised(self.tick);
        self.recording.samples.push(Sample {
            station_m: self.vehicle.station_m(),
            body: self.vehicle.body(),
            displacement_m: self.vehicle.strut_displacement_m().into_array(),
            strut: self.vehicle.strut_output().into_array(),
            wheel: self.vehicle.wheels().into_array(),
            command: self.output.command(),
            energised,
        });
        let signals = Corners::from_array(energised.corners().map(StrutValves::from_array));
        for _ in 0..self.steps_per_tick {
            self.vehicle.step(signals);
            let felt = self
                .seats
                .map(|(x_m, y_m)| self.vehicle.vertical_acceleration_at(x_m, y_m));
            self.recording.seat_acceleration_m_s2.push(felt);
        }
        self.tick += 1;
    }

    /// Says that the run is over; the controller's tally is the [`Answer::Done`] to it.
    pub fn send_end(&mut self) -> Result<(), BusError> {
        let sent = self.bus.inner().messages_sent() as u16;
        self.bus.send(&Sync::End { sent }.encode(Role::Plant))
    }

    /// Ticks since the last usable command.
    pub fn ticks_without_command(&self) -> u32 {
        self.output.ticks_without_command()
    }

    /// The bus, for the handshake.
    pub fn bus(&mut self) -> &mut dyn Bus {
        &mut self.bus
    }

    /// What is left of a run.
    pub fn into_remains(mut self) -> PlantRemains {
        let trace = self.bus.inner_mut();
        let received = trace.messages_received() as u16;
        let (lost_by_controller, e2e_by_controller) = self.tally;
        let bus_lost = u64::from(self.controller_sent.wrapping_sub(received)) + u64::from(lost_by_controller);
        PlantRemains {
            frames_sent: trace.messages_sent() + trace.messages_received(),
            bus_frames_lost: bus_lost,
            foreign_frames: trace.foreign(),
            trace: trace.take_entries(),
            e2e_errors: self.output.errors() + u64::from(e2e_by_controller),
            injected: self.bus.counts(),
            counters: self.bus.counters(),
            recording: self.recording,
        }
    }
}

/// What a plant node knows at the end of a run.
#[derive(Debug)]
pub struct PlantRemains {
    /// Samples of the run.
    pub recording: Recording,
    /// Frames on the wire.
    pub trace: Vec<crate::bus::TraceEntry>,
    /// Messages of the database that were on the wire, both directions.
    pub frames_sent: u64,
    /// Of these, how many one end sent and the other did not get.
    pub bus_frames_lost: u64,
    /// Frames of third parties.
    pub foreign_frames: u64,
    /// Frames that failed their end-to-end check, both ends.
    pub e2e_errors: u64,
    /// What the fault injector did.
    pub injected: crate::bus::InjectionCounts,
    /// What the bus counted.
    pub counters: crate::bus::BusCounters,
}
