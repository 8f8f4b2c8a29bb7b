//! A drive: a measured force pushes a carriage, and its position is measured.
//!
//! `m d2x/dt2 = F - c dx/dt` is what the model of every drive has. The effects add their resistance.
//!
//! A drive integrates its force twice, so an error of the force grows without bound. The free run is therefore cut into
//! windows of [`WINDOW_S`]. Each window begins with the measured position and speed, and receives nothing but the force after
//! that. The state of dry friction is carried over, because nothing measures it.

use serde::{Deserialize, Serialize};

use super::effects::MechanismEffects;
use crate::model_file::instruments::{check_noise, check_noise_is_complete, check_tolerance};
use crate::model_file::{Checked, InvalidValue, Limit, ModelFileError, Range, checked, read};
use crate::specimen::name::SpecimenName;
use crate::specimen::smoothed_motion::{SmoothedMotion, mean_interval_s, smooth_motion};
use crate::strut::{SensorEffect, TermId};

/// What the model of every drive has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Moving mass, kg.
    pub mass_kg: f64,
    /// Viscous friction: force over speed, N s/m, 0 or more.
    #[serde(rename = "viscous_N_s_m")]
    pub viscous_n_s_m: f64,
}

impl Checked for Drive {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("mass_kg", Range::FromTo(1e-6, 1e9), "kg", |d| d.mass_kg),
        Limit::one("viscous_N_s_m", Range::FromTo(0.0, 1e9), "N s/m", |d| d.viscous_n_s_m),
    ];
}

/// The `model.toml` of a drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveModel {
    /// Name and kind of the specimen.
    pub specimen: SpecimenName,
    /// What the model of every drive has.
    pub drive: Drive,
    /// Effects that the model contains.
    #[serde(default)]
    pub effects: MechanismEffects,
    /// How far values may be off: `mass` and `viscous`, both relative.
    #[serde(default)]
    pub tolerance: SensorEffect,
    /// Standard deviation of the noise by column.
    #[serde(default)]
    pub noise: SensorEffect,
}

/// Length of a window of the free run, s.
pub const WINDOW_S: f64 = 2.5;
/// Column of the position, which is compared with the model.
const POSITION: &str = "position_m";
/// All channels of a drive.
const CHANNELS: [&str; 2] = ["force_N", POSITION];
/// Half window over which the measured position is smoothed for the speed at the start of a window: this long, s ...
const SMOOTHING_S: f64 = 0.02;
/// ... and at least this many samples.
const SMOOTHING_SAMPLES: f64 = 5.0;
/// Longest step of the integration, s. Longer sampling intervals are divided.
const LONGEST_STEP_S: f64 = 0.002;
/// Most steps that a sampling interval is divided into.
const MOST_STEPS: f64 = 100.0;
/// A position this far from zero, m, means that the simulation has diverged.
const FARTHEST_M: f64 = 1e6;
/// Least part of the believed mass that may remain.
const LEAST_MASS: f64 = 0.01;

impl Checked for DriveModel {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        checked(&self.specimen, "specimen")?;
        checked(&self.drive, "drive")?;
        checked(&self.effects, "effects")?;
        self.effects.check_sensors(POSITION)?;
        check_tolerance(&self.tolerance, &["mass", "viscous"])?;
        check_noise(&self.noise, &CHANNELS)
    }
}

/// Position, speed and friction force of the carriage.
#[derive(Debug, Clone, Copy)]
struct State {
    position_m: f64,
    speed_m_s: f64,
    friction_n: f64,
}

impl DriveModel {
    /// Refuse a model that does not state the noise of both channels, which only a diagnosis needs. The force, which is not
    /// compared, may be without noise (0).
    ///
    /// # Errors
    /// The channels whose noise is missing, or a position without noise.
    pub fn check_noise_is_complete(&self) -> Result<(), InvalidValue> {
        check_noise_is_complete(&self.noise, &CHANNELS, &[POSITION])
    }

    /// Read and check a model. `file` is the name that appears in errors.
    ///
    /// ```
    /// use oleo_plant_sim::specimen::DriveModel;
    /// let text = "[specimen]\nname = \"a\"\nkind = \"drive\"\n[drive]\nmass_kg = 100.0\nviscous_N_s_m = 0.0\n";
    /// let model = DriveModel::from_toml(text, "model.toml").unwrap();
    /// // 50 N on 100 kg for 2 s, from rest.
    /// let time_s: Vec<f64> = (0..2001).map(|k| 0.001 * f64::from(k)).collect();
    /// let measured = DriveModel::motion(&time_s, &vec![0.0; 2001]);
    /// let position_m = model.position_m(&time_s, &vec![50.0; 2001], &measured).unwrap();
    /// assert!((position_m[2000] - 1.0).abs() < 1e-9);
    /// ```
    ///
    /// # Errors
    /// Unknown, missing or impossible entries, with file and line.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ModelFileError> {
        read(text, file)
    }

    /// The model as a file.
    ///
    /// # Errors
    /// Never for a model that was read; the serialiser's message otherwise.
    pub fn to_toml(&self) -> Result<String, String> {
        toml::to_string_pretty(self).map_err(|e| e.to_string())
    }

    /// The measured motion, freed of noise: where the windows begin.
    #[must_use]
    pub fn motion(time_s: &[f64], position_m: &[f64]) -> SmoothedMotion {
        smooth_motion(
            time_s,
            position_m,
            SMOOTHING_S.max(SMOOTHING_SAMPLES * mean_interval_s(time_s)),
        )
    }

    /// True position at every sample, m, from the force (N) and the measured motion at the start of each window.
    ///
    /// # Errors
    /// A simulation that diverges; a mass that is not positive.
    pub fn position_m(&self, time_s: &[f64], force_n: &[f64], measured: &SmoothedMotion) -> Result<Vec<f64>, String> {
        let mass = self.drive.mass_kg + self.effects.further_mass_kg();
        if mass < LEAST_MASS * self.drive.mass_kg {
            return Err(format!(
                "the moving mass would be {mass} kg; correct mass_kg or moving_mass_kg"
            ));
        }
        let begin = time_s.first().copied().unwrap_or(0.0);
        let mut positions = Vec::with_capacity(time_s.len());
        let mut state = State {
            position_m: 0.0,
            speed_m_s: 0.0,
            friction_n: 0.0,
        };
        let (mut shown, mut next_window) = (0.0, begin);
        for k in 0..time_s.len() {
            if k == 0 || time_s[k] >= next_window {
                while next_window <= time_s[k] {
                    next_window += WINDOW_S;
                }
                let (position, speed) = self.measured_state(time_s, measured, k);
                state = State {
                    position_m: self.in_front_of_gap(position, speed),
                    speed_m_s: speed,
                    ..state
                };
                shown = position;
            } else {
                self.advance(&mut state, mass, time_s[k] - time_s[k - 1], force_n[k - 1], force_n[k])?;
                shown = match &self.effects.backlash {
                    Some(gap) => gap.behind_m(shown, state.position_m),
                    None => state.position_m,
                };
            }
            positions.push(shown);
        }
        Ok(positions)
    }

    /// The position of the mass whose gap has the measured part behind it: touching in the direction of travel.
    fn in_front_of_gap(&self, behind_m: f64, speed_m_s: f64) -> f64 {
        let gap = self.effects.backlash.as_ref().map_or(0.0, |gap| gap.gap_m);
        if speed_m_s == 0.0 {
            behind_m
        } else {
            behind_m + (0.5 * gap).copysign(speed_m_s)
        }
    }

    /// True position and speed at a sample, from what the instrument shows.
    fn measured_state(&self, time_s: &[f64], measured: &SmoothedMotion, sample: usize) -> (f64, f64) {
        let fault = |id| self.effects.fault(id, POSITION);
        let late = fault(TermId::SensorSkew).unwrap_or(0.0);
        // What the instrument shows late is true earlier: look as much later.
        let at = time_s[sample] + late;
        let mut k = sample;
        while k + 1 < time_s.len() && time_s[k] < at {
            k += 1;
        }
        while k > 0 && time_s[k] > at {
            k -= 1;
        }
        let off = at - time_s[k];
        let acceleration = measured.acceleration_m_s2[k];
        let position = measured.displacement_m[k] + off * (measured.speed_m_s[k] + 0.5 * off * acceleration);
        let speed = measured.speed_m_s[k] + off * acceleration;
        let factor = (1.0 + fault(TermId::SensorGain).unwrap_or(0.0)) * fault(TermId::SensorSign).unwrap_or(1.0);
        let drift = fault(TermId::SensorDrift).unwrap_or(0.0);
        let (position, speed) = ((position - drift * (at - time_s[0])) / factor, (speed - drift) / factor);
        let lag = fault(TermId::SensorLag).unwrap_or(0.0);
        (position + lag * speed, speed + lag * acceleration / factor)
    }

    /// One sampling interval, over which the force changes linearly.
    fn advance(&self, state: &mut State, mass: f64, interval_s: f64, from_n: f64, to_n: f64) -> Result<(), String> {
        let steps = (interval_s / LONGEST_STEP_S - 1e-9).ceil().clamp(1.0, MOST_STEPS);
        let h = interval_s / steps;
        for k in 0..steps as usize {
            let part = (k as f64 + 0.5) / steps;
            self.step(state, mass, h, from_n + part * (to_n - from_n));
        }
        if state.position_m.abs() < FARTHEST_M {
            Ok(())
        } else {
            Err("the simulation diverged; the force is too large for the mass, or a stiffness is negative".to_owned())
        }
    }

    /// One step with the mean force of the step. Rigid friction stops the carriage at the time within the step at which its
    /// speed is zero, and holds it or lets it go from there.
    fn step(&self, state: &mut State, mass: f64, h: f64, force_n: f64) {
        let v = state.speed_m_s;
        let next = self.speed_after(state, mass, h, force_n);
        if self.effects.presliding_friction.is_some() || v == 0.0 || v * next > 0.0 {
            self.arrive(state, h, next);
            return;
        }
        let until = (h * v / (v - next)).clamp(0.0, h);
        self.arrive(state, until, 0.0);
        let next = self.speed_after(state, mass, h - until, force_n);
        self.arrive(state, h - until, next);
    }

    /// Speed at the end of a step, m/s, against rigid friction in the direction of travel.
    ///
    /// The trapezoidal rule, linearised about the speed at the start, for everything smooth and for the stiffness of presliding
    /// friction (average acceleration: Newmark 1959). From rest, rigid friction takes what is below its level (projection:
    /// Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988), so that it holds without creeping.
    fn speed_after(&self, state: &State, mass: f64, h: f64, force_n: f64) -> f64 {
        let effects = &self.effects;
        let (x, v) = (state.position_m, state.speed_m_s);
        let (resistance, slope) = effects.resistance(x + 0.5 * h * v, v);
        let viscous = self.drive.viscous_n_s_m;
        let shear = effects.shear(state.friction_n, v);
        let (held, stiffness) = shear.map_or((0.0, 0.0), |s| (s.force_n, s.slope_n_m));
        let spring = stiffness + effects.stiffness.as_ref().map_or(0.0, |s| s.stiffness_n_m.max(0.0));
        let damping = (viscous + slope).max(0.0);
        let inverse = 1.0 / (1.0 + 0.5 * h / mass * (damping + 0.5 * h * spring));
        let pushed = force_n - resistance - viscous * v - held - 0.5 * h * stiffness * v;
        let free = v + h / mass * inverse * pushed;
        if shear.is_some() {
            return free;
        }
        let hold = h / mass * inverse * effects.friction_level_n(v);
        if v != 0.0 {
            free - hold.copysign(v)
        } else if free.abs() <= hold {
            0.0
        } else {
            free - hold.copysign(free)
        }
    }

    /// The state after a step to a speed (m/s).
    fn arrive(&self, state: &mut State, h: f64, speed_m_s: f64) {
        let mean = 0.5 * (state.speed_m_s + speed_m_s);
        if self.effects.presliding_friction.is_some() {
            state.friction_n = self.effects.friction_after_n(state.friction_n, h * mean, mean);
        }
        state.position_m += h * mean;
        state.speed_m_s = speed_m_s;
    }

    /// What the instrument shows of the position.
    #[must_use]
    pub fn shown(&self, time_s: &[f64], position_m: Vec<f64>) -> Vec<f64> {
        self.effects.shown(POSITION, time_s, position_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::mechanism::{Backlash, CoulombFriction, ForceOffset, PreslidingFriction, Stiffness};

    fn drive(viscous: f64) -> DriveModel {
        let text = format!("[specimen]\nname='a'\nkind='drive'\n[drive]\nmass_kg=100.0\nviscous_N_s_m={viscous:?}\n");
        DriveModel::from_toml(&text, "test").unwrap()
    }

    fn times(seconds: f64) -> Vec<f64> {
        (0..=(1000.0 * seconds) as usize).map(|k| 0.001 * k as f64).collect()
    }

    /// Position from rest at zero under a force over time.
    fn run(model: &DriveModel, time: &[f64], force: &dyn Fn(f64) -> f64) -> Vec<f64> {
        let force: Vec<f64> = time.iter().map(|t| force(*t)).collect();
        let rest = DriveModel::motion(time, &vec![0.0; time.len()]);
        model.position_m(time, &force, &rest).unwrap()
    }

    #[test]
    fn a_constant_force_against_viscous_friction_is_the_closed_form() {
        let time = times(2.0);
        let x = run(&drive(200.0), &time, &|_| 50.0);
        // x = F/c (t - tau (1 - exp(-t/tau))), tau = m/c.
        let expected = 50.0 / 200.0 * (2.0 - 0.5 * (1.0 - libm::exp(-4.0)));
        assert!((x[2000] - expected).abs() < 1e-6, "{} {expected}", x[2000]);
    }

    #[test]
    fn coulomb_friction_holds_and_stops_the_carriage_where_its_energy_ends() {
        let mut model = drive(0.0);
        model.effects.coulomb_friction = Some(CoulombFriction { coulomb_force_n: 20.0 });
        let time = times(2.4);
        assert!(run(&model, &time, &|_| 19.9).iter().all(|x| *x == 0.0), "it holds");
        // 50 N for a second accelerates with 0.3 m/s2 to 0.3 m/s; then friction stops it within v^2 / (2 a), a = 0.2 m/s2, of
        // which it has 1.4 s: 0.3 * 1.4 - 0.1 * 1.4^2.
        let x = run(&model, &time, &|t| if t < 0.9995 { 50.0 } else { 0.0 });
        let expected = 0.15 + 0.3 * 1.4 - 0.1 * 1.4 * 1.4;
        assert!((x[2400] - expected).abs() < 1e-3, "{} {expected}", x[2400]);
        let mut stopping = drive(0.0);
        stopping.effects.coulomb_friction = Some(CoulombFriction { coulomb_force_n: 60.0 });
        let x = run(&stopping, &time, &|t| if t < 0.9995 { 120.0 } else { 0.0 });
        // 0.6 m/s after 0.3 m; then 0.6 m/s2 for a second and 0.3 m, and rest.
        assert!((x[2400] - 0.6).abs() < 1e-3 && x[2300] == x[2400], "{}", x[2400]);
    }

    #[test]
    fn a_stiffness_makes_it_an_oscillator_of_the_right_period_and_energy() {
        let mut model = drive(0.0);
        model.effects.stiffness = Some(Stiffness {
            stiffness_n_m: 10_000.0,
        });
        model.effects.force_offset = Some(ForceOffset { force_n: -100.0 });
        let time = times(2.4);
        // About 10 mm with 10 rad/s: x = 0.01 (1 - cos(10 t)).
        for (t, x) in time.iter().zip(run(&model, &time, &|_| 0.0)) {
            assert!((x - 0.01 * (1.0 - libm::cos(10.0 * t))).abs() < 2e-5, "{t}: {x}");
        }
    }

    #[test]
    fn presliding_friction_is_a_spring_before_it_slides() {
        let mut model = drive(20_000.0);
        model.effects.presliding_friction = Some(PreslidingFriction {
            coulomb_force_n: 100.0,
            presliding_stiffness_n_m: 1e6,
            breakaway_force_n: None,
            stribeck_speed_m_s: None,
        });
        // Slowly up to half of the level: F = g (1 - exp(-k x / g)), so x = -g/k ln(1 - F/g).
        let x = run(&model, &times(2.4), &|t| 50.0 * (t / 2.0).min(1.0));
        let expected = 1e-4 * std::f64::consts::LN_2;
        assert!((x[2400] / expected - 1.0).abs() < 0.02, "{} {expected}", x[2400]);
    }

    #[test]
    fn behind_a_gap_the_position_follows_late() {
        let mut model = drive(0.0);
        model.effects.backlash = Some(Backlash { gap_m: 0.01 });
        let time = times(2.0);
        let (with, without) = (run(&model, &time, &|_| 50.0), run(&drive(0.0), &time, &|_| 50.0));
        assert!((without[2000] - with[2000] - 0.005).abs() < 1e-9);
        assert_eq!(with[100], 0.0);
    }

    #[test]
    fn windows_begin_with_the_measured_state() {
        let time = times(6.0);
        let measured: Vec<f64> = time.iter().map(|t| 0.1 * t).collect();
        let motion = DriveModel::motion(&time, &measured);
        // Believed far too sluggish: within a window it falls behind, at the start of the next it has caught up.
        let x = drive(500.0).position_m(&time, &vec![0.0; time.len()], &motion).unwrap();
        for k in [0, 2500, 5000] {
            assert!((x[k] - measured[k]).abs() < 1e-9, "{k}");
        }
        assert!(measured[2499] - x[2499] > 0.2 && measured[2600] - x[2600] < 0.01);
    }

    #[test]
    fn faults_of_the_instrument_are_undone_where_a_window_begins() {
        let time = times(6.0);
        let truth: Vec<f64> = time.iter().map(|t| 0.2 + 0.1 * t).collect();
        for (id, size) in [
            (TermId::SensorGain, 0.2),
            (TermId::SensorDrift, 0.03),
            (TermId::SensorSkew, 0.04),
            (TermId::SensorLag, 0.02),
            (TermId::SensorSign, -1.0),
        ] {
            let mut model = drive(0.0);
            let table = model.effects.sensor_fault_mut(id).expect("a fault");
            *table = Some(SensorEffect::from([(POSITION.to_owned(), size)]));
            let shown = model.shown(&time, truth.clone());
            let motion = DriveModel::motion(&time, &shown);
            let x = model.position_m(&time, &vec![0.0; time.len()], &motion).unwrap();
            for k in [2500, 4000, 5000, 6000] {
                assert!((x[k] - truth[k]).abs() < 1e-6, "{id} {k}: {} {}", x[k], truth[k]);
            }
        }
    }

    /// Halving the step changes a motion with friction and reversals by little.
    #[test]
    fn the_step_is_short_enough() {
        let mut model = drive(200.0);
        model.effects.coulomb_friction = Some(CoulombFriction { coulomb_force_n: 20.0 });
        let force = |t: f64| 100.0 * libm::sin(5.0 * t);
        let coarse = run(&model, &times(2.4), &force);
        let fine_time: Vec<f64> = (0..=24_000).map(|k| 1e-4 * f64::from(k)).collect();
        let fine = run(&model, &fine_time, &force);
        let worst = (coarse.iter().enumerate()).fold(0.0_f64, |m, (k, x)| m.max((x - fine[10 * k]).abs()));
        assert!(worst < 2e-6, "{worst}");
    }
}
