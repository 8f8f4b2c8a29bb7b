//! Motion of the body and the struts, from displacements and pressures alone.
//!
//! There is no accelerometer. A strut's force is its main pressure times the piston area, and the struts carry the whole body. So
//! the sum of their forces tells how the body accelerates, and the differences tell how it is turned. With `F` the four forces,
//! `W` their slow mean (the static load; it is measured, so that the payload needs no parameter), `y` and `x` the distances of
//! the struts to the left of and ahead of the centre of gravity, and `phi_f` and `phi_r` the roll relative to each axle:
//!
//! ```text
//!   heave       z''     = g (sum F / sum W - 1)
//!   roll        phi''   = g (sum y (F - W) - k_f phi_f - k_r phi_r) / (sum W  i_x^2)
//!   pitch       theta'' = g (- sum x (F - W)) / (sum W  i_y^2)
//! ```
//!
//! `W` and the offset of p1 are means of all that was seen until their memories are full, so that an offset that is there from power-on
//! is no motion. What is left of it on one side is taken off the lateral acceleration (`Uneven`).
//!
//! Source: Newton and Euler for the sprung mass at small angles. The lateral acceleration is [`crate::lateral`]'s. Signs: x forward,
//! y left, z up; roll is positive with the right side down, pitch with the nose down. So a left turn, in which the lateral
//! acceleration is positive, rolls the body in the positive direction.
//!
//! Limits: a side slope looks like cornering, as it does to an accelerometer. Forces that do not pass through the oil are not in
//! p1: seal friction, links, bushes and stops. `phi` lacks the roll of the axles on the tyres. Figures are in
//! `docs/controller.md`.

use oleo_interface::tick::TICKS_PER_SECOND;
use oleo_interface::{Axles, Corners};

use crate::filter::{Derivative, DerivativeState, LowPass, at_least};
use crate::lateral::{self, Lateral};
use crate::plausibility::Trusted;
use crate::range::{ConfigurationError, within};
use crate::timing::ticks;
use crate::vehicle::VehicleDescription;
use crate::wheelbase;

/// Standard gravity, m/s2 (ISO 80000-3).
pub const GRAVITY_M_S2: f32 = 9.806_65;

/// Corner frequency of the filter that differentiates the strut displacement, Hz. It is high enough for everything that valves of
/// 40 to 90 ms can follow, and low enough for the 0.01 mm steps of the displacement signal (`vehicle.md`: 15 to 20 Hz).
const SPEED_CORNER_HZ: f32 = 18.0;
/// Ticks from the start in which uneven load is learnt.
const LEARNING_TICKS: f32 = ticks(2_500) as f32;
const _: () = assert!(
    SPEED_CORNER_HZ * 8.0 <= TICKS_PER_SECOND as f32,
    "fastest filter: at least eight ticks a period of its corner, or its discrete form is not what was designed"
);

/// What a person may choose about the estimate.
///
/// ```
/// use oleo_controller::{Builder, estimate};
/// let mut builder = Builder::default();
/// builder.tuning.estimate = estimate::Tuning { running_rms_s: 0.5, ..estimate::Tuning::default() };
/// assert!(builder.build().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// The lateral acceleration.
    pub lateral: lateral::Tuning,
    /// Time constant of the running mean squares, s, 0.1 to 20.
    pub running_rms_s: f32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            lateral: lateral::Tuning::default(),
            running_rms_s: 1.0, // recalled: Els, about 1 s
        }
    }
}

impl Tuning {
    /// Whether every value is within its range.
    pub(crate) fn check(&self) -> Result<(), ConfigurationError> {
        self.lateral.check()?;
        within("tuning.estimate.running_rms_s", self.running_rms_s, 0.1, 20.0)
    }
}

/// Dimensions and filters, as the equations above use them. See [`State`] for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    piston_area_m2: f32,
    half_spacing_m: Axles<f32>,
    per_spacing: Axles<f32>,
    axle_distance_m: Axles<f32>,
    per_wheelbase: f32,
    per_roll_arm: f32,
    anti_roll_stiffness_n_m_rad: Axles<f32>,
    per_roll_gyration_2: f32,
    per_pitch_gyration_2: f32,
    strut_speed: Derivative,
    static_load: LowPass,
    /// Lateral acceleration for each metre by which the first gas is compressed further on one side than on the other.
    carried_m_s2_m: f32,
    lateral: lateral::Parameters,
    wheelbase: wheelbase::Parameters,
    running: LowPass,
}

impl Parameters {
    /// From a description and a tuning that have been checked.
    pub(crate) fn new(vehicle: &VehicleDescription, tuning: &Tuning) -> Self {
        let square = |x: f32| x * x;
        let Axles { front, rear } = vehicle.axle_distance_m;
        Self {
            piston_area_m2: vehicle.piston_area_m2,
            half_spacing_m: vehicle.strut_spacing_m.map(|spacing| 0.5 * spacing),
            per_spacing: vehicle.strut_spacing_m.map(|spacing| 1.0 / spacing),
            axle_distance_m: vehicle.axle_distance_m,
            per_wheelbase: 1.0 / (front + rear),
            per_roll_arm: 1.0 / vehicle.roll_arm_m,
            anti_roll_stiffness_n_m_rad: vehicle.anti_roll_stiffness_n_m_rad,
            per_roll_gyration_2: 1.0 / square(vehicle.roll_gyration_m),
            per_pitch_gyration_2: 1.0 / square(vehicle.pitch_gyration_m),
            strut_speed: Derivative::from_corner_hz(SPEED_CORNER_HZ),
            static_load: LowPass::from_time_constant_s(20.0),
            carried_m_s2_m: carried_m_s2_m(vehicle),
            lateral: lateral::Parameters::new(&tuning.lateral, square(vehicle.roll_gyration_m) / vehicle.roll_arm_m),
            wheelbase: wheelbase::Parameters::new(),
            running: LowPass::from_time_constant_s(tuning.running_rms_s),
        }
    }
}

/// With two axles, each with half the spacing `y` to either side, the gas turns the body by `2 y k (c_r - c_l)`, where the stiffness of
/// the first gas of a strut that carries a fourth of the weight is `k = A W / (4 V1)`.
fn carried_m_s2_m(vehicle: &VehicleDescription) -> f32 {
    let half_spacing_m = 0.25 * (vehicle.strut_spacing_m.front + vehicle.strut_spacing_m.rear);
    GRAVITY_M_S2 * half_spacing_m * vehicle.piston_area_m2 / (2.0 * vehicle.gas_volume_1_m3 * vehicle.roll_arm_m)
}

/// Estimated motion. Quantities of the body are those of its centre of gravity, with x forward, y left and z up; compression of a
/// strut is positive. See [`estimate::State`](State) for an example.
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
    /// Lateral acceleration, low-passed, and what the road alone adds to it.
    pub lateral: Lateral,
    /// Running mean square of the lateral acceleration, m2/s4.
    pub lateral_mean_square: f32,
    /// Running mean square of the vertical acceleration, m2/s4.
    pub vertical_mean_square: f32,
    /// Static load on each strut, N.
    pub static_load_n: Corners<f32>,
    /// Ticks after which the rear axle meets what the front one has met, where that is known.
    #[cfg(feature = "comparison")]
    pub axle_delay_ticks: Option<u8>,
}

impl Estimate {
    /// Whether every quantity is a finite number.
    pub fn is_finite(&self) -> bool {
        // Every quantity above enters one of these sums, and a value that is not finite makes its sum not finite.
        let corners: f32 = self.strut_speed_m_s.values().chain(self.static_load_n.values()).sum();
        let body = self.heave_m
            + self.roll_rad
            + self.pitch_rad
            + self.roll_rate_rad_s
            + self.vertical_acceleration_m_s2
            + self.roll_acceleration_rad_s2
            + self.pitch_acceleration_rad_s2
            + self.lateral_mean_square
            + self.vertical_mean_square
            + self.lateral.acceleration_m_s2.quick
            + self.lateral.acceleration_m_s2.slow
            + self.lateral.witness_m_s2.slow;
        (corners + body).is_finite()
    }
}

/// Memory of the estimator.
///
/// ```
/// use oleo_controller::plausibility::Trusted;
/// use oleo_controller::{Configuration, Corners, Gauge, StrutPressures, estimate};
/// let parameters = Configuration::defender110().estimate;
/// let mut state = estimate::State::default();
/// let under = |pressure_pa: f32| Trusted {
///     pressure: Corners::splat(StrutPressures::splat(Gauge(pressure_pa))),
///     ..Trusted::default()
/// };
/// // The mean load is the static load: the body is at rest.
/// let estimate = (0..4_000).map(|_| state.step(&parameters, &under(2.0e6))).last().unwrap();
/// assert_eq!(estimate.vertical_acceleration_m_s2, 0.0);
/// // A tenth more force at every strut accelerates the body upwards by a tenth of gravity.
/// let estimate = state.step(&parameters, &under(2.2e6));
/// assert!((estimate.vertical_acceleration_m_s2 - 0.980_665).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    speed: Corners<DerivativeState>,
    static_load_n: Corners<f32>,
    lateral: lateral::State,
    wheelbase: wheelbase::State,
    lateral_mean_square: f32,
    vertical_mean_square: f32,
    uneven: Uneven,
    /// Ticks since the start. It is a number of ticks as long as anything depends on it.
    ticks: f32,
}

impl Default for State {
    fn default() -> Self {
        Self::INITIAL
    }
}

impl State {
    pub(crate) const INITIAL: Self = Self {
        speed: Corners::splat(DerivativeState::INITIAL),
        static_load_n: Corners::splat(0.0),
        lateral: lateral::State::INITIAL,
        wheelbase: wheelbase::State::INITIAL,
        lateral_mean_square: 0.0,
        vertical_mean_square: 0.0,
        uneven: Uneven::INITIAL,
        ticks: 0.0,
    };

    /// The static load on each strut, N.
    pub(crate) fn static_load_n(&self) -> &Corners<f32> {
        &self.static_load_n
    }

    /// One tick; returns the motion that follows from readings that may be used.
    pub fn step(&mut self, c: &Parameters, trusted: &Trusted) -> Estimate {
        let force = Corners::from_fn(|corner| {
            (trusted.pressure[corner].p1.pa() - trusted.p1_offset_pa[corner]) * c.piston_area_m2
        });
        if self.ticks == 0.0 {
            self.speed = trusted.displacement_m.map(DerivativeState::at_rest);
        }
        self.ticks += 1.0;
        let speeds = self.speed.each_mut().zip(trusted.displacement_m);
        let strut_speed_m_s = speeds.map(|(state, x)| c.strut_speed.step(state, x));
        let relative = Relative::from_struts(c, trusted.displacement_m);
        let relative_rate = Relative::from_struts(c, strut_speed_m_s);

        let part = c.static_load.growing(self.ticks);
        for (load, force) in self.static_load_n.each_mut().zip(force).into_array() {
            // A strut without load (jacked up, or empty) must not lead to a division by zero.
            *load = at_least(*load + part * (force - *load), 1.0);
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

        let per_inertia = per_mass * c.per_roll_arm;
        if self.ticks <= LEARNING_TICKS {
            (self.uneven).learn(
                per_inertia * left_up_n_m,
                trusted.load_to_right_m * c.carried_m_s2_m,
                self.ticks,
            );
        }
        let lateral_raw =
            per_inertia * (bars_n_m - left_up_n_m) + self.uneven.lateral_m_s2 - GRAVITY_M_S2 * relative.roll_rad;
        let Axles { front, rear } = relative.axle_roll_rad;
        let delay = self.wheelbase.step(&c.wheelbase, strut_speed_m_s);
        let lateral = self.lateral.step(&c.lateral, lateral_raw, front, rear, delay);
        let lateral_square = lateral.acceleration_m_s2.quick * lateral.acceleration_m_s2.quick;

        Estimate {
            strut_speed_m_s,
            heave_m: relative.heave_m,
            roll_rad: relative.roll_rad,
            pitch_rad: relative.pitch_rad,
            roll_rate_rad_s: relative_rate.roll_rad,
            vertical_acceleration_m_s2: vertical,
            roll_acceleration_rad_s2: roll,
            pitch_acceleration_rad_s2: pitch,
            lateral,
            lateral_mean_square: c.running.step(&mut self.lateral_mean_square, lateral_square),
            vertical_mean_square: c.running.step(&mut self.vertical_mean_square, vertical * vertical),
            static_load_n: self.static_load_n,
            #[cfg(feature = "comparison")]
            axle_delay_ticks: delay,
        }
    }
}

#[cfg(test)]
impl State {
    /// A state whose memory was damaged, as no input can do.
    pub(crate) fn damaged() -> Self {
        Self {
            ticks: 1.0,
            lateral: lateral::State::damaged(),
            ..Self::default()
        }
    }
}

/// What the forces of the struts are on one side more than on the other, as lateral acceleration, though the body does not lean: uneven
/// load, and what sensors show too much since the controller has started.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Uneven {
    /// By the forces, and by the compression of the gas, m/s2, in the mean.
    forces_m_s2: f32,
    gas_m_s2: f32,
    /// What of the first the second does not explain, m/s2.
    lateral_m_s2: f32,
}

impl Uneven {
    const INITIAL: Self = Self {
        forces_m_s2: 0.0,
        gas_m_s2: 0.0,
        lateral_m_s2: 0.0,
    };

    /// The `n`-th tick.
    #[inline(never)]
    fn learn(&mut self, forces_m_s2: f32, gas_m_s2: f32, n: f32) {
        let part = 1.0 / n;
        self.forces_m_s2 += part * (forces_m_s2 - self.forces_m_s2);
        self.gas_m_s2 += part * (gas_m_s2 - self.gas_m_s2);
        let beyond_m_s2 = at_least(self.forces_m_s2.abs() - self.gas_m_s2.abs(), 0.0);
        self.lateral_m_s2 = beyond_m_s2.copysign(self.forces_m_s2);
    }
}

/// Motion of the body relative to the axles: positions from strut displacements, or rates from strut speeds.
struct Relative {
    heave_m: f32,
    roll_rad: f32,
    axle_roll_rad: Axles<f32>,
    pitch_rad: f32,
}

impl Relative {
    fn from_struts(c: &Parameters, displacement: Corners<f32>) -> Self {
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
