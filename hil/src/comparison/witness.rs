//! What follows a drive while it goes on.

use oleo_controller::ValveCommand;
use oleo_plant_sim::course::Phase;
use oleo_plant_sim::vehicle::{SeatAcceleration, Seats};

/// The beginning of a tick.
pub(super) struct Instant {
    pub roll_rad: f64,
    pub command: ValveCommand,
    pub handling: bool,
    /// Where in the manoeuvre the vehicle is; `None` without one.
    pub phase: Option<Phase>,
}

/// Sees a drive tick by tick, and feels it step by step.
pub(super) trait Witness {
    /// At the beginning of a tick.
    fn tick(&mut self, now: &Instant);

    /// At the end of each step of the model within the tick: the acceleration at the seats.
    fn step(&mut self, felt: Seats<SeatAcceleration>);
}

/// Looks away.
pub(super) struct Nobody;

impl Witness for Nobody {
    fn tick(&mut self, _: &Instant) {}

    fn step(&mut self, _: Seats<SeatAcceleration>) {}
}
