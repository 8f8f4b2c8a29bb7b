//! What is kept of a drive.

use oleo_controller::ValveCommand;
use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, Valve};
use oleo_plant_sim::course::Ending;
use oleo_plant_sim::measures::SeatMeter;
use oleo_plant_sim::vehicle::{SeatAcceleration, Seats};

use super::case::DriveCase;
use super::witness::{Instant, Witness};

/// Scores begin after this time, s: start-up of the controller and the smooth entry of the road are over.
pub const SCORED_FROM_S: f64 = 3.0;

/// Figures of one drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// How it ended.
    pub ending: Ending,
    /// BS 6841 weighted vertical RMS, mean of both seats, m/s2.
    pub weighted_rms_m_s2: f64,
    /// Largest roll of the body, degrees; 90 for a vehicle that rolled over.
    pub peak_roll_deg: f64,
    /// From when the manoeuvre began until the controller takes the drive for cornering, or all valves are commanded closed, s; `None`
    /// without a manoeuvre or where it never happened.
    pub decision_s: Option<f64>,
    /// Times that the controller took the drive for cornering.
    pub entries: u32,
    /// Distance that counts, km.
    pub distance_km: f64,
    /// Changes of each valve's signal, all corners together, valves 1 to 3.
    pub valve_changes: [u32; 3],
}

/// Makes the figures while a drive goes on.
pub(super) struct Scored {
    meters: Seats<SeatMeter>,
    speed_m_s: f64,
    scored_from_tick: u32,
    begun_tick: Option<u32>,
    ticks: u32,
    peak_roll_rad: f64,
    decided: Option<u32>,
    handling: bool,
    entries: u32,
    word: Option<ValveCommand>,
    changes: [u32; 3],
}

impl Scored {
    /// Of a drive with the model's step, s.
    pub fn new(case: &DriveCase, step_s: f64) -> Self {
        let tick = |time_s: f64| (time_s / TICK_S).round() as u32;
        Self {
            meters: Seats::from_fn(|_| SeatMeter::new(step_s, SCORED_FROM_S)),
            speed_m_s: case.manoeuvre.initial_speed_m_s(),
            scored_from_tick: tick(SCORED_FROM_S),
            begun_tick: case.begins_s.map(tick),
            ticks: 0,
            peak_roll_rad: 0.0,
            decided: None,
            handling: false,
            entries: 0,
            word: None,
            changes: [0; 3],
        }
    }

    /// The figures of a drive that has ended.
    pub fn figures(self, ending: Ending) -> Figures {
        let scored_s = f64::from(self.ticks.saturating_sub(self.scored_from_tick)) * TICK_S;
        let felt = self.meters.map(|meter| meter.measures().vertical.weighted_rms_m_s2);
        Figures {
            ending,
            weighted_rms_m_s2: 0.5 * (felt.driver + felt.passenger),
            peak_roll_deg: match ending {
                Ending::RolledOver(_) => 90.0,
                _ => self.peak_roll_rad.to_degrees(),
            },
            decision_s: (self.begun_tick.zip(self.decided)).map(|(begun, decided)| f64::from(decided - begun) * TICK_S),
            entries: self.entries,
            distance_km: 1e-3 * scored_s * self.speed_m_s,
            valve_changes: self.changes,
        }
    }
}

impl Witness for Scored {
    fn tick(&mut self, now: &Instant) {
        let tick = self.ticks;
        self.ticks += 1;
        let begun = self.begun_tick.is_some_and(|begun| tick >= begun);
        if begun && self.decided.is_none() && (now.handling || now.command == ValveCommand::SAFE) {
            self.decided = Some(tick);
        }
        if tick >= self.scored_from_tick {
            self.peak_roll_rad = self.peak_roll_rad.max(now.roll_rad.abs());
            self.entries += u32::from(now.handling && !self.handling);
            if let Some(before) = self.word {
                for (corner, valve) in Corner::ALL.into_iter().flat_map(|c| Valve::ALL.map(|v| (c, v))) {
                    self.changes[valve.index()] +=
                        u32::from(before.is_open(corner, valve) != now.command.is_open(corner, valve));
                }
            }
        }
        self.handling = now.handling;
        self.word = Some(now.command);
    }

    fn step(&mut self, felt: Seats<SeatAcceleration>) {
        for (seat, meter) in self.meters.iter_mut() {
            meter.add(felt[seat]);
        }
    }
}
