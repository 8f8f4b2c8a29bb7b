//! What is kept of a drive.

use oleo_controller::ValveCommand;
use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, Valve};
use oleo_plant_sim::course::Ending;

/// Scores begin after this time, s: start-up of the controller and the smooth entry of the road are over.
pub const SCORED_FROM_S: f64 = 3.0;
/// True lateral acceleration at which a manoeuvre counts as begun, m/s2.
const BEGUN_M_S2: f64 = 0.5;

/// Figures of one drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// How it ended.
    pub ending: Ending,
    /// BS 6841 weighted vertical RMS, mean of both seats, m/s2.
    pub weighted_rms_m_s2: f64,
    /// Largest roll of the body, degrees; 90 for a vehicle that rolled over.
    pub peak_roll_deg: f64,
    /// From the first |a_y| > 0.5 m/s2 of a manoeuvre until all valves are commanded closed, s; `None` without a manoeuvre or where
    /// it never happened.
    pub decision_s: Option<f64>,
    /// Times that the controller took the drive for cornering.
    pub entries: u32,
    /// Distance that counts, km.
    pub distance_km: f64,
    /// Changes of each valve's signal, all corners together, valves 1 to 3.
    pub valve_changes: [u32; 3],
}

/// Follows a drive, tick by tick.
pub(super) struct Watch {
    scored_from_tick: u32,
    manoeuvre_from_tick: Option<u32>,
    ticks: u32,
    peak_roll_rad: f64,
    begun: Option<u32>,
    decided: Option<u32>,
    handling: bool,
    entries: u32,
    word: Option<ValveCommand>,
    changes: [u32; 3],
}

/// One tick as the watch sees it.
pub(super) struct Instant {
    pub roll_rad: f64,
    pub lateral_m_s2: f64,
    pub command: ValveCommand,
    pub handling: bool,
}

impl Watch {
    /// `manoeuvre_from_s` is when the driver begins to steer.
    pub fn new(manoeuvre_from_s: Option<f64>) -> Self {
        let tick = |time_s: f64| (time_s / TICK_S).round() as u32;
        Self {
            scored_from_tick: tick(SCORED_FROM_S),
            manoeuvre_from_tick: manoeuvre_from_s.map(tick),
            ticks: 0,
            peak_roll_rad: 0.0,
            begun: None,
            decided: None,
            handling: false,
            entries: 0,
            word: None,
            changes: [0; 3],
        }
    }

    pub fn tick(&mut self, now: &Instant) {
        let tick = self.ticks;
        self.ticks += 1;
        if self.manoeuvre_from_tick.is_some_and(|from| tick >= from)
            && self.begun.is_none()
            && now.lateral_m_s2.abs() > BEGUN_M_S2
        {
            self.begun = Some(tick);
        }
        if self.begun.is_some() && self.decided.is_none() && now.command == ValveCommand::SAFE {
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

    pub fn figures(self, ending: Ending, weighted_rms_m_s2: f64, speed_m_s: f64) -> Figures {
        let scored_s = f64::from(self.ticks.saturating_sub(self.scored_from_tick)) * TICK_S;
        Figures {
            ending,
            weighted_rms_m_s2,
            peak_roll_deg: match ending {
                Ending::RolledOver(_) => 90.0,
                _ => self.peak_roll_rad.to_degrees(),
            },
            decision_s: (self.begun.zip(self.decided)).map(|(begun, decided)| f64::from(decided - begun) * TICK_S),
            entries: self.entries,
            distance_km: 1e-3 * scored_s * speed_m_s,
            valve_changes: self.changes,
        }
    }
}
