//! Nell & Steyn's choice of all four dampers together: the combination whose forces oppose the body's motion best.
//!
//! The other rules look at one corner at a time. A body has three motions, and a damper that calms one may excite another. So all
//! sixteen combinations `s` of low and high are compared by what the forces would make of the body, and the least is taken:
//!
//! ```text
//!   a(s)  = ( sum F_i(s_i) / m - g,   sum y_i F_i(s_i) / m - ...,   - sum x_i F_i(s_i) / m )   heave, roll / i_x, pitch / i_y
//!   J(s)  = sum over the three of (a(s) + v / T)^2                      each roll and pitch times its radius of gyration
//! ```
//!
//! `v` are the velocities of the three motions, integrals of the estimated accelerations above 0.2 Hz. `v / T` is the deceleration
//! that is aimed at: with a large `T` the accelerations alone are made small, with a small one any force is good that brakes. Radii of
//! gyration make the three motions alike in energy.
//!
//! Source: S. Nell and J. L. Steyn, "An alternative control strategy for semi-active dampers on off-road vehicles", J. Terramechanics 35
//! (1998), 25-40 (report, reference 16), *recalled*: that combinations of damper states are compared by the vertical, pitch and roll
//! motion that they lead to, and the one that opposes it best is set. The form of `J`, its weights and `T` are this project's: the paper
//! was not at hand.
//!
//! `F_i` with low and with high damping comes from [`super::strut_force`] at the present pressures and speed, lagged at 4 Hz like the
//! quantities of the other rules, because the valves cannot follow the wheel.

use oleo_interface::{Corner, Corners};

use super::strut_force::{Bypass, Gases, StrutForce};
use crate::estimate::{Estimate, GRAVITY_M_S2};
use crate::filter::{LeakyIntegrator, LowPass, at_least};
use crate::plausibility::Trusted;
use crate::vehicle::VehicleDescription;

/// Time in which the body's velocity is to be braked, s: `T`. Of 0.1, 0.3, 1 and 2 s on classes C to E and Belgian block (seed 1) the long
/// ones are the better ones, and a still longer one, which leaves the accelerations alone, gains 1 % more.
const BRAKING_S: f32 = 1.0;
/// Part by which the cost must be less than that of the present combination before it is left.
const LESS: f32 = 0.9;
/// Least cost at which a damper is set high, m2/s4: below it the valves rest.
const LEAST_2: f32 = 0.5 * 0.5;
/// Low and high damping as settings of the bypass valves.
const SETTINGS: [Bypass; 2] = [[true, true], [false, false]];

/// Heave, roll and pitch; roll and pitch times their radii of gyration.
type Motions = [f32; 3];

/// Levers of the struts and filters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    strut: StrutForce,
    /// Contribution of a force over the mass at each strut to the three motions.
    levers: Corners<Motions>,
    gyration_m: Motions,
    band: LowPass,
    velocity: LeakyIntegrator,
    /// Square of the share of the running RMS below which the valves rest, too.
    share_2: f32,
}

impl Parameters {
    /// From a description that has been checked, and the places of the struts ahead of and to the left of the centre of gravity, m.
    pub fn new(vehicle: &VehicleDescription, place_m: &Corners<(f32, f32)>, share: f32) -> Self {
        let (roll_m, pitch_m) = (vehicle.roll_gyration_m, vehicle.pitch_gyration_m);
        Self {
            strut: StrutForce::new(vehicle),
            levers: place_m.map(|(ahead_m, left_m)| [1.0, left_m / roll_m, -ahead_m / pitch_m]),
            gyration_m: [1.0, roll_m, pitch_m],
            band: LowPass::from_corner_hz(4.0),
            velocity: LeakyIntegrator::from_corner_hz(0.2),
            share_2: share * share,
        }
    }
}

/// Lagged accelerations and forces, velocities, and the combination that is set.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    velocity_m_s: Motions,
    acceleration_m_s2: Motions,
    /// What the force of each strut would be more with low, and with high damping, than it is, N, lagged.
    more_n: Corners<[f32; 2]>,
    /// A bit for each corner that is high.
    high: u8,
}

impl State {
    pub const INITIAL: Self = Self {
        velocity_m_s: [0.0; 3],
        acceleration_m_s2: [0.0; 3],
        more_n: Corners::splat([0.0; 2]),
        high: 0,
    };

    /// One tick; returns whether high damping is wanted at each corner.
    pub fn step(&mut self, c: &Parameters, estimate: &Estimate, trusted: &Trusted) -> Corners<bool> {
        let weight_n: f32 = estimate.static_load_n.values().sum();
        let per_mass = GRAVITY_M_S2 / at_least(weight_n, 1.0);
        let [_, roll_m, pitch_m] = c.gyration_m;
        let accelerations = [
            estimate.vertical_acceleration_m_s2,
            roll_m * estimate.roll_acceleration_rad_s2,
            pitch_m * estimate.pitch_acceleration_rad_s2,
        ];
        let states = self.velocity_m_s.iter_mut().zip(&mut self.acceleration_m_s2);
        for ((velocity, lagged), acceleration) in states.zip(accelerations) {
            c.velocity.step(velocity, acceleration);
            c.band.step(lagged, acceleration);
        }
        for (corner, more) in self.more_n.iter_mut() {
            let pressure = &trusted.pressure[corner];
            let now_n = (pressure.p1.pa() - trusted.p1_offset_pa[corner]) * c.strut.area_m2();
            for (more, open) in more.iter_mut().zip(SETTINGS) {
                let mut gases = Gases::measured(pressure, trusted.charge[corner]);
                let force_n = c.strut.step(&mut gases, estimate.strut_speed_m_s[corner], open, 0.0);
                c.band.step(more, force_n - now_n);
            }
        }
        let rests_2 = at_least(c.share_2 * estimate.vertical_mean_square, LEAST_2);
        self.high = self.least(c, per_mass, rests_2);
        let high = self.high;
        Corners::from_fn(|corner| high & bit(corner) != 0)
    }

    /// The combination of least cost; the present one unless another is clearly better, and none where the body rests.
    fn least(&self, c: &Parameters, per_mass: f32, rests_2: f32) -> u8 {
        let (mut best, mut least) = (self.high, LESS * self.cost(c, per_mass, self.high));
        for combination in 0..16 {
            let cost = self.cost(c, per_mass, combination);
            if cost < least {
                (best, least) = (combination, cost);
            }
        }
        if self.cost(c, per_mass, 0) < rests_2 { 0 } else { best }
    }

    /// `J` of a combination, m2/s4.
    fn cost(&self, c: &Parameters, per_mass: f32, combination: u8) -> f32 {
        let mut motions = self.acceleration_m_s2;
        for (motion, velocity) in motions.iter_mut().zip(self.velocity_m_s) {
            *motion += velocity * (1.0 / BRAKING_S);
        }
        for (corner, levers) in c.levers.iter() {
            let [low, high] = self.more_n[corner];
            let more_n = if combination & bit(corner) == 0 { low } else { high };
            for (motion, lever) in motions.iter_mut().zip(levers) {
                *motion += lever * per_mass * more_n;
            }
        }
        motions.into_iter().map(|motion| motion * motion).sum()
    }
}

/// The bit of a corner in a combination.
const fn bit(corner: Corner) -> u8 {
    1 << corner.index()
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::{Absolute, Axle, Gauge, Side, StrutPressures};

    const LOAD_N: f32 = 4.0e3;

    fn parameters() -> Parameters {
        let place_m = Corners::from_fn(|corner| {
            let ahead_m = if corner.axle() == Axle::Front { 1.389 } else { -1.405 };
            (ahead_m, if corner.side() == Side::Left { 0.5 } else { -0.5 })
        });
        Parameters::new(&VehicleDescription::default(), &place_m, 2.2)
    }

    /// What is set after a second in which the struts are compressed at these speeds, m/s, while heave, roll and pitch accelerate.
    fn settled(speed_m_s: Corners<f32>, motions: Motions) -> [bool; 4] {
        settled_on(0.0, speed_m_s, motions)
    }

    /// The same on a road of this mean square of the vertical acceleration, m2/s4.
    fn settled_on(mean_square: f32, speed_m_s: Corners<f32>, [heave, roll, pitch]: Motions) -> [bool; 4] {
        let (c, mut state) = (parameters(), State::INITIAL);
        let estimate = Estimate {
            strut_speed_m_s: speed_m_s,
            vertical_acceleration_m_s2: heave,
            roll_acceleration_rad_s2: roll,
            pitch_acceleration_rad_s2: pitch,
            static_load_n: Corners::splat(LOAD_N),
            vertical_mean_square: mean_square,
            ..Estimate::default()
        };
        let trusted = Trusted {
            pressure: Corners::splat(StrutPressures::splat(Gauge(2.0e6))),
            charge: Corners::splat(Absolute(2.101_325e6)),
            ..Trusted::default()
        };
        let mut high = Corners::splat(false);
        for _ in 0..200 {
            // Velocities are those of the test, not the integrals of an acceleration that lasts.
            state.velocity_m_s = [0.0; 3];
            high = state.step(&c, &estimate, &trusted);
        }
        high.into_array()
    }

    /// By hand: struts that are compressed at 0.2 m/s push with some 570 N more if they are high. A body that accelerates downwards at
    /// 3 m/s2 gains from that at all four, and one that accelerates upwards at none.
    #[test]
    fn heave_sets_all_four() {
        let compressed = Corners::splat(0.2);
        assert_eq!(settled(compressed, [-3.0, 0.0, 0.0]), [true; 4]);
        assert_eq!(settled(compressed, [3.0, 0.0, 0.0]), [false; 4]);
        assert_eq!(settled(Corners::splat(-0.2), [3.0, 0.0, 0.0]), [true; 4]);
        assert_eq!(settled(compressed, [-0.3, 0.0, 0.0]), [false; 4], "the body rests");
    }

    /// Where all struts are compressed, a roll to the right is met on the right, and a pitch forwards at the front: no rule for one corner
    /// tells that.
    #[test]
    fn roll_is_met_on_one_side_and_pitch_at_one_axle() {
        let compressed = Corners::splat(0.2);
        assert_eq!(settled(compressed, [0.0, 4.0, 0.0]), [false, true, false, true]);
        assert_eq!(settled(compressed, [0.0, -4.0, 0.0]), [true, false, true, false]);
        assert_eq!(settled(compressed, [0.0, 0.0, 2.0]), [true, true, false, false]);
        assert_eq!(settled(compressed, [0.0, 0.0, -2.0]), [false, false, true, true]);
    }

    /// The body rests below 2.2 times the running RMS: at an RMS of 2 m/s2 below 4.4 m/s2, and at one of 1 m/s2 below 2.2.
    #[test]
    fn more_is_left_alone_on_a_rougher_road() {
        let compressed = Corners::splat(0.2);
        assert_eq!(settled_on(4.0, compressed, [-3.8, 0.0, 0.0]), [false; 4]);
        assert_eq!(settled_on(1.0, compressed, [-3.8, 0.0, 0.0]), [true; 4]);
    }

    /// A strut that does not move would have the force that it has at either setting, whatever its sensor reads too much.
    #[test]
    fn the_offset_of_a_sensor_is_no_force() {
        let mut state = State::INITIAL;
        let mut trusted = Trusted {
            pressure: Corners::splat(StrutPressures::splat(Gauge(2.0e6))),
            charge: Corners::splat(Absolute(2.101_325e6)),
            p1_offset_pa: Corners::splat(1.0e5),
            ..Trusted::default()
        };
        trusted
            .pressure
            .values_mut()
            .for_each(|pressure| pressure.p1 = Gauge(2.1e6));
        state.step(&parameters(), &Estimate::default(), &trusted);
        for more_n in state.more_n.values() {
            assert!(more_n.iter().all(|more_n| more_n.abs() < 0.1), "{more_n:?} N");
        }
    }

    /// One cost by hand: 1 m/s2 of heave, 2 m/s upwards, and 100 N more at one strut in 16,000 N.
    #[test]
    fn the_cost_is_the_sum_of_squares_of_the_three_motions() {
        let c = parameters();
        let mut state = State {
            velocity_m_s: [2.0, 0.0, 0.0],
            acceleration_m_s2: [1.0, 0.0, 0.0],
            ..State::INITIAL
        };
        let per_mass = GRAVITY_M_S2 / (4.0 * LOAD_N);
        assert!((state.cost(&c, per_mass, 0) - 9.0).abs() < 1e-4, "1 + 2.0 / 1.0 = 3");
        state.more_n[Corner::FrontLeft] = [0.0, -100.0];
        let each = -100.0 * per_mass;
        let (roll, pitch) = (each * 0.5 / 0.661, -each * 1.389 / 1.25);
        let expected = (3.0 + each) * (3.0 + each) + roll * roll + pitch * pitch;
        assert!((state.cost(&c, per_mass, 1) - expected).abs() < 1e-4);
    }

    /// A combination that is better by less than a tenth does not move a valve.
    #[test]
    fn a_little_better_is_not_enough() {
        let (c, per_mass) = (parameters(), GRAVITY_M_S2 / (4.0 * LOAD_N));
        let with = |more_n: f32, high: u8| {
            let mut state = State {
                acceleration_m_s2: [-3.0, 0.0, 0.0],
                high,
                ..State::INITIAL
            };
            state.more_n = Corners::splat([0.0, more_n]);
            state.least(&c, per_mass, LEAST_2)
        };
        assert_eq!((with(40.0, 0), with(40.0, 15)), (0, 15), "9.0 against 8.4 m2/s4");
        assert_eq!((with(200.0, 0), with(-200.0, 15)), (15, 0), "9.0 against 6.3 m2/s4");
    }

    /// Of combinations that cost the same the one with fewer high dampers is taken, and below the least cost, 0.25 m2/s4, none is high,
    /// however good it would be.
    #[test]
    fn no_damper_is_set_high_for_nothing() {
        let (c, per_mass) = (parameters(), GRAVITY_M_S2 / (4.0 * LOAD_N));
        let with = |heave_m_s2: f32, more_n: [f32; 4]| {
            let mut state = State {
                acceleration_m_s2: [heave_m_s2, 0.0, 0.0],
                ..State::INITIAL
            };
            state.more_n = Corners::from_array(more_n.map(|more_n| [0.0, more_n]));
            state.least(&c, per_mass, LEAST_2)
        };
        assert_eq!(with(-3.0, [200.0; 4]), 0b1111);
        assert_eq!(with(-3.0, [200.0, 200.0, 0.0, 0.0]), 0b0011, "struts that stand still");
        assert_eq!((with(-0.49, [50.0; 4]), with(-0.5, [50.0; 4])), (0, 0b1111));
    }
}
