//! Motion of the body and the struts, from displacements and pressures alone.
//!
//! There is no accelerometer. A strut's force is its main pressure times the piston area, and the struts carry the whole body, so their sum
//! says how the body accelerates, and their differences how it is turned. With `F` the four forces, `W` their
//! slow mean (the static load, measured, so that payload needs no parameter), `y` and `x` the struts' places to the left and ahead of
//! the centre of gravity and `phi_f`, `phi_r` the roll relative to each axle:
//!
//! ```text
//!   heave       z''     = g (sum F / sum W - 1)
//!   roll        phi''   = g (sum y (F - W) - k_f phi_f - k_r phi_r) / (sum W  i_x^2)
//!   pitch       theta'' = g (- sum x (F - W)) / (sum W  i_y^2)
//!   lateral     a_y     = g (- sum y F + k_f phi_f + k_r phi_r) / (sum W  h) - g phi, two lags at 1 Hz, bias removed
//!   corner      z_i''   = z'' + y_i phi'' - x_i theta''
//! ```
//!
//! Newton and Euler for the sprung mass, small angles; the lateral line is the moment balance about the roll axis at low frequency, where
//! `J_x phi''` vanishes. Signs: x forward, y left, z up; roll positive right side down, pitch positive nose down, so a left turn
//! (positive `a_y`) rolls the body positive.
//!
//! What this cannot know: a side slope looks like cornering (so it does to an accelerometer); seal friction, links, bushes and
//! stops that press past the oil are not in p1; axle roll on the tyres is missing from `phi`. Figures in `docs/controller.md`.

use oleo_interface::{Axles, Corners};

use crate::configuration::Configuration;
use crate::filter::{DerivativeState, at_least};
use crate::plausibility::Trusted;

/// Standard gravity, m/s2 (ISO 80000-3).
pub const GRAVITY_M_S2: f32 = 9.806_65;

/// Largest lateral offset that is learnt as uneven load or sensor bias, m/s2: a long bend must not be learnt away.
const MAX_BIAS_M_S2: f32 = 0.5;

/// Estimated motion. Body quantities are about its centre of gravity, x forward, y left, z up; struts compression positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Strut speed, m/s, compression positive.
    pub strut_speed_m_s: Corners<f32>,
    /// Heave of the body relative to the axles, m, up positive.
    pub heave_m: f32,
    /// Roll of the body relative to the axles, rad, right side down positive.
    pub roll_rad: f32,
    /// Pitch of the body relative to the axles, rad, nose down positive.
    pub pitch_rad: f32,
    /// Rate of `roll_rad`, rad/s.
    pub roll_rate_rad_s: f32,
    /// Vertical acceleration of the body, m/s2, up positive.
    pub vertical_acceleration_m_s2: f32,
    /// Roll acceleration of the body, rad/s2.
    pub roll_acceleration_rad_s2: f32,
    /// Pitch acceleration of the body, rad/s2.
    pub pitch_acceleration_rad_s2: f32,
    /// Surrogate of the lateral acceleration, m/s2, to the left positive.
    pub lateral_acceleration_m_s2: f32,
    /// Running mean square of the lateral surrogate, m2/s4.
    pub lateral_mean_square: f32,
    /// Running mean square of the vertical acceleration, m2/s4.
    pub vertical_mean_square: f32,
    /// Vertical acceleration of the body over each strut, m/s2, up positive.
    pub corner_acceleration_m_s2: Corners<f32>,
    /// Vertical velocity of the body over each strut above 0.2 Hz, m/s, up positive.
    pub corner_velocity_m_s: Corners<f32>,
    /// Static load on each strut, N.
    pub static_load_n: Corners<f32>,
}

impl Estimate {
    /// Whether all arithmetic gave numbers.
    pub fn is_finite(&self) -> bool {
        // Every quantity above enters one of these sums, and NaN or infinity survives addition.
        let corners: f32 = self
            .strut_speed_m_s
            .values()
            .chain(self.corner_acceleration_m_s2.values())
            .chain(self.corner_velocity_m_s.values())
            .chain(self.static_load_n.values())
            .sum();
        let body = self.heave_m
            + self.roll_rad
            + self.pitch_rad
            + self.roll_rate_rad_s
            + self.lateral_mean_square
            + self.vertical_mean_square
            + self.lateral_acceleration_m_s2;
        (corners + body).is_finite()
    }
}

/// Memory of the estimator.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    speed: Corners<DerivativeState>,
    static_load_n: Corners<f32>,
    velocity: Corners<f32>,
    lateral: [f32; 2],
    lateral_bias: f32,
    lateral_mean_square: f32,
    vertical_mean_square: f32,
    started: bool,
}

impl State {
    /// One tick from readings that may be used.
    pub fn step(&mut self, c: &Configuration, trusted: &Trusted) -> Estimate {
        let speeds = self.speed.each_mut().zip(trusted.displacement_m);
        let strut_speed_m_s = speeds.map(|(state, x)| c.strut_speed.step(state, x));
        let relative = Relative::from_struts(c, trusted.displacement_m);
        let relative_rate = Relative::from_struts(c, strut_speed_m_s);

        let force = trusted.pressure.map(|pressure| pressure.p1.pa() * c.piston_area_m2);
        if !self.started {
            self.started = true;
            self.static_load_n = force;
        }
        for (load, force) in self.static_load_n.each_mut().zip(force).into_array() {
            // A strut without load (jacked up, empty) must not divide by nothing.
            *load = at_least(c.static_load.step(load, force), 1.0);
        }
        let weight: f32 = self.static_load_n.values().sum();
        let per_mass = GRAVITY_M_S2 / weight;

        let Axles { front: hf, rear: hr } = c.half_spacing_m;
        let Axles { front: a, rear: b } = c.axle_distance_m;
        let Axles { front: kf, rear: kr } = c.anti_roll_stiffness_n_m_rad;
        let bars_n_m = kf * relative.axle_roll_rad.front + kr * relative.axle_roll_rad.rear;
        let [w0, w1, w2, w3] = self.static_load_n.into_array();
        let [f0, f1, f2, f3] = force.into_array();
        let left_up_n_m = hf * (f0 - f1) + hr * (f2 - f3);
        let static_left_up_n_m = hf * (w0 - w1) + hr * (w2 - w3);

        let vertical = per_mass * (f0 + f1 + f2 + f3) - GRAVITY_M_S2;
        let roll = per_mass * c.per_roll_gyration_2 * (left_up_n_m - static_left_up_n_m - bars_n_m);
        let pitch = per_mass * c.per_pitch_gyration_2 * (b * (f2 + f3 - w2 - w3) - a * (f0 + f1 - w0 - w1));

        let lateral_raw = per_mass * c.per_roll_arm * (bars_n_m - left_up_n_m) - GRAVITY_M_S2 * relative.roll_rad;
        let [lag1, lag2] = &mut self.lateral;
        let lagged = c.lateral.step(lag2, c.lateral.step(lag1, lateral_raw));
        c.lateral_bias
            .step(&mut self.lateral_bias, lagged.clamp(-MAX_BIAS_M_S2, MAX_BIAS_M_S2));
        let lateral = lagged - self.lateral_bias;

        let corner_acceleration_m_s2 = Corners::from_array([
            vertical + hf * roll - a * pitch,
            vertical - hf * roll - a * pitch,
            vertical + hr * roll + b * pitch,
            vertical - hr * roll + b * pitch,
        ]);
        for (velocity, acceleration) in self.velocity.each_mut().zip(corner_acceleration_m_s2).into_array() {
            c.body_velocity.step(velocity, acceleration);
        }
        Estimate {
            strut_speed_m_s,
            heave_m: relative.heave_m,
            roll_rad: relative.roll_rad,
            pitch_rad: relative.pitch_rad,
            roll_rate_rad_s: relative_rate.roll_rad,
            vertical_acceleration_m_s2: vertical,
            roll_acceleration_rad_s2: roll,
            pitch_acceleration_rad_s2: pitch,
            lateral_acceleration_m_s2: lateral,
            lateral_mean_square: c.running.step(&mut self.lateral_mean_square, lateral * lateral),
            vertical_mean_square: c.running.step(&mut self.vertical_mean_square, vertical * vertical),
            corner_acceleration_m_s2,
            corner_velocity_m_s: self.velocity,
            static_load_n: self.static_load_n,
        }
    }
}

/// Body relative to the axles, from strut displacements (or rates, from strut speeds).
struct Relative {
    heave_m: f32,
    roll_rad: f32,
    axle_roll_rad: Axles<f32>,
    pitch_rad: f32,
}

impl Relative {
    fn from_struts(c: &Configuration, displacement: Corners<f32>) -> Self {
        let struts = displacement.by_axle();
        let Axles { front: a, rear: b } = c.axle_distance_m;
        let axle_roll_rad = struts
            .zip(c.per_spacing)
            .map(|((left, right), per)| (right - left) * per);
        let Axles { front, rear } = struts.map(|(left, right)| 0.5 * (left + right));
        Self {
            // Compression lowers the body; the centre of gravity is nearer to one axle.
            heave_m: -(front * b + rear * a) * c.per_wheelbase,
            roll_rad: 0.5 * (axle_roll_rad.front + axle_roll_rad.rear),
            axle_roll_rad,
            pitch_rad: (front - rear) * c.per_wheelbase,
        }
    }
}
