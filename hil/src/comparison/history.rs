//! One drive from its beginning to its end: what a page shows of a bend in the middle of a rough road.

use oleo_controller::ValveCommand;
use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, Valve};
use oleo_plant_sim::course::{Ending, Phase};
use oleo_plant_sim::measures::{RideMeter, WB, WeightingFilter};
use oleo_plant_sim::vehicle::{SeatAcceleration, Seats};

use super::bench::Bench;
use super::case::DriveCase;
use super::drive::{ComparisonError, drive_seen_by};
use super::figures::SCORED_FROM_S;
use super::setting::Setting;
use super::witness::{Instant, Witness};

/// Time constant of the running RMS of what the driver feels, s (ISO 2631-1, 6.3.1).
const RUNNING_S: f64 = 1.0;

/// What a drive was like over time. Vectors have one value a tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Time since the beginning, s.
    pub time_s: Vec<f64>,
    /// Roll of the body, degrees, positive with the left side up.
    pub roll_deg: Vec<f64>,
    /// Running RMS of the vertical acceleration at the driver's seat, weighted as in BS 6841, m/s2.
    pub felt_m_s2: Vec<f64>,
    /// Number of valves that are commanded open, 0 to 12; empty for the vehicle as sold, which has none.
    pub open_valves: Vec<f64>,
    /// Weighted RMS before the manoeuvre from the third second on, mean of both seats, m/s2.
    pub ride_before_m_s2: f64,
    /// The same behind the last cones.
    pub ride_after_m_s2: f64,
    /// Largest roll of the body from the third second on, degrees; 90 for a vehicle that rolled over.
    pub peak_roll_deg: f64,
    /// Begin and end of the manoeuvre, s; `None` where there is none.
    pub cornering_s: Option<(f64, f64)>,
}

/// Drives a case with a setting and keeps what happened.
///
/// # Errors
/// As of [`drive`](super::drive()).
pub fn history(bench: &Bench, case: &DriveCase, setting: &Setting) -> Result<History, ComparisonError> {
    let mut kept = Keeper::new(bench.vehicle.solver.step_s);
    let ending = drive_seen_by(&mut kept, bench, case, setting)?;
    let mut history = kept.history(ending);
    if *setting == Setting::AsSold {
        history.open_valves.clear();
    }
    Ok(history)
}

/// Keeps a history while it happens.
struct Keeper {
    history: History,
    step_s: f64,
    weighting: WeightingFilter,
    running_square: f64,
    before: Seats<RideMeter>,
    after: Seats<RideMeter>,
    phase: Option<Phase>,
    scored: bool,
}

impl Keeper {
    fn new(step_s: f64) -> Self {
        Self {
            history: History::default(),
            step_s,
            weighting: WeightingFilter::new(&WB, 1.0 / step_s),
            running_square: 0.0,
            before: Seats::from_fn(|_| RideMeter::new(step_s)),
            after: Seats::from_fn(|_| RideMeter::new(step_s)),
            phase: None,
            scored: false,
        }
    }

    fn history(mut self, ending: Ending) -> History {
        let mean = |meters: &Seats<RideMeter>| {
            let sum: f64 = meters.iter().map(|(_, meter)| meter.measures().weighted_rms_m_s2).sum();
            0.5 * sum
        };
        self.history.ride_before_m_s2 = mean(&self.before);
        self.history.ride_after_m_s2 = mean(&self.after);
        if let Ending::RolledOver(_) = ending {
            self.history.peak_roll_deg = 90.0;
        }
        self.history
    }
}

impl Witness for Keeper {
    fn tick(&mut self, now: &Instant) {
        let time_s = self.history.time_s.len() as f64 * TICK_S;
        self.phase = now.phase;
        self.scored = time_s >= SCORED_FROM_S;
        if now.phase == Some(Phase::Cornering) {
            let (begin_s, _) = self.history.cornering_s.unwrap_or((time_s, time_s));
            self.history.cornering_s = Some((begin_s, time_s));
        }
        let roll_deg = now.roll_rad.to_degrees();
        if self.scored {
            self.history.peak_roll_deg = self.history.peak_roll_deg.max(roll_deg.abs());
        }
        self.history.time_s.push(time_s);
        self.history.roll_deg.push(roll_deg);
        self.history.felt_m_s2.push(self.running_square.sqrt());
        self.history.open_valves.push(open_valves(now.command));
    }

    fn step(&mut self, felt: Seats<SeatAcceleration>) {
        let weighted = self.weighting.filter(felt.driver.vertical_m_s2);
        self.running_square += (weighted * weighted - self.running_square) * self.step_s / RUNNING_S;
        // Every filter sees the whole drive, so that it has no start of its own in its phase.
        for (meters, phase) in [(&mut self.before, Phase::Before), (&mut self.after, Phase::After)] {
            let counts = self.scored && self.phase == Some(phase);
            for (seat, meter) in meters.iter_mut() {
                let vertical_m_s2 = felt[seat].vertical_m_s2;
                if counts {
                    meter.add(vertical_m_s2);
                } else {
                    meter.settle(vertical_m_s2);
                }
            }
        }
    }
}

fn open_valves(command: ValveCommand) -> f64 {
    let open = |corner| {
        Valve::ALL
            .iter()
            .filter(|valve| command.is_open(corner, **valve))
            .count()
    };
    Corner::ALL.into_iter().map(open).sum::<usize>() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 1e-3;

    /// A second before, one in the manoeuvre and one behind it, from the third second on. The seats feel sines of 8 Hz, whose weighted RMS
    /// is `a Wb / sqrt 2`, and the body rolls most in between.
    #[test]
    fn each_phase_has_its_own_figures() {
        let mut kept = Keeper::new(STEP_S);
        for tick in 0..1600_u32 {
            let (phase, amplitude, roll_rad) = match tick {
                0..600 => (Phase::Before, 1.5, -0.9),
                600..1000 => (Phase::Before, 1.0, 0.01),
                1000..1200 => (Phase::Cornering, 5.0, -0.1),
                _ => (Phase::After, 2.0, 0.02),
            };
            kept.tick(&Instant {
                roll_rad,
                command: ValveCommand::from_word(0b111),
                handling: false,
                phase: Some(phase),
            });
            for step in 0..5 {
                let time_s = f64::from(5 * tick + step) * STEP_S;
                let vertical_m_s2 = amplitude * libm::sin(2.0 * std::f64::consts::PI * 8.0 * time_s);
                let felt = SeatAcceleration {
                    vertical_m_s2,
                    ..SeatAcceleration::default()
                };
                kept.step(Seats::from_fn(|_| felt));
            }
        }
        let history = kept.history(Ending::Completed);
        let weighted = |amplitude: f64| amplitude * WB.magnitude(8.0) / 2.0_f64.sqrt();
        assert!((history.ride_before_m_s2 / weighted(1.0) - 1.0).abs() < 0.02);
        assert!((history.ride_after_m_s2 / weighted(2.0) - 1.0).abs() < 0.02);
        assert!((history.peak_roll_deg - 0.1_f64.to_degrees()).abs() < 1e-12);
        assert_eq!(history.cornering_s, Some((5.0, 5.995)));
        assert_eq!((history.time_s.len(), history.open_valves[700]), (1600, 3.0));
        let running = history.felt_m_s2[999];
        assert!((running / weighted(1.0) - 1.0).abs() < 0.1, "running RMS {running}");
    }

    #[test]
    fn a_vehicle_that_rolls_over_has_ninety_degrees() {
        let history = Keeper::new(STEP_S).history(Ending::RolledOver(1.0));
        assert_eq!(history.peak_roll_deg, 90.0);
    }
}
