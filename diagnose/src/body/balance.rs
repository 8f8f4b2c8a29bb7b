//! Heave, pitch and roll of the body as rows of a linear problem.
//!
//! About the believed centre of mass of the sprung mass, with `F_i` the force of strut i at `x_i` ahead and `s_i` to the left, `f` and `a` the
//! specific force and angular acceleration there in axes of the body, `k q` the moment of an anti-roll bar, and an unknown point mass `p` at
//! (x, y), the equations of the ride model (`plant-sim/src/vehicle/equations.rs`, after Genta) read
//!
//! ```text
//!   sum F_i           - m f_z           = p f_z - p x a_y + p y a_x                                - sum c_i u_i
//!   - sum x_i F_i     - J_y a_y         = - p x f_z + D_y a_y + d J_y a_x                          + sum x_i c_i u_i
//!   sum s_i F_i - sum k q - J_x a_x     = p y f_z + D_x a_x - sum b k q - d J_x a_y                - sum s_i c_i u_i
//! ```
//!
//! Three more unknowns stand for what the links of the axles do, of which nothing is believed. The lateral forces of front and rear axle, `m f_y` in
//! all and `J_z a_z` about the vertical, act at roll centres at unknown depths below the centre of mass, and add `h_1 Y_1 + h_2 Y_2` to the right side of
//! the roll, with the sign of the left one turned. Of the longitudinal force `m f_x` the links bring unknown shares into pitch and heave. The ride model
//! has none of it; the handling model does, and without these unknowns its roll is mistaken for a lost bar.
//!
//! Unknown are the mass with its moments `p, p x, p y`, what it adds to the inertias `D_x, D_y`, the share `b` of a bar that is lost, the angle `d`
//! that the unit is turned about the vertical, and the friction `c_i` at a corner beyond the believed one (`u_i` is the course of 1 N of it). All are
//! linear. The height of the mass is in `D_x` and `D_y` alone: straight ahead no force acts along x or y that would tip it.

use oleo_interface::{Axle, Corner};

use super::band::Band;
use super::believed::{Believed, unit_friction};
use super::drive::BodyDrive;

/// Positions of the unknowns.
pub const MASS: usize = 0;
pub const MASS_AHEAD: usize = 1;
pub const MASS_LEFT: usize = 2;
pub const ROLL_INERTIA: usize = 3;
pub const PITCH_INERTIA: usize = 4;
pub const BAR_LOST: [usize; 2] = [5, 6];
pub const YAW: usize = 7;
pub const FRICTION: usize = 8;
/// Depths of the roll centres of both axles below the centre of mass, m.
pub const ROLL_CENTRE: [usize; 2] = [12, 13];
/// Arm of the longitudinal force in pitch, m, and its share in heave.
pub const LINKS: [usize; 2] = [14, 15];
/// Number of unknowns.
pub const UNKNOWNS: usize = 16;

/// Heave, pitch, roll at one instant: what the believed vehicle leaves unbalanced, and what each unknown would do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// N, N m, N m.
    pub unbalanced: [f64; 3],
    /// For each unknown.
    pub slopes: [[f64; UNKNOWNS]; 3],
    /// Angular velocity about the vertical, rad/s.
    pub yaw_rate: f64,
    /// Sum of the squares of the struts' speeds, m2/s2.
    pub strut_speed_squared: f64,
}

/// The rows of a stretch whose unit is turned to the axes of the body.
pub fn rows(believed: &Believed, stretch: &BodyDrive, band: &Band) -> Vec<Row> {
    let skipped = stretch.settling();
    let pass = |series: &[f64]| band.pass(&series[skipped..]);
    let derivative = |series: &[f64]| band.derivative(&series[skipped..]);
    let force = believed.strut_force_n(&stretch.displacement_m, &stretch.p1_pa, stretch.period_s);
    let force = force.map(|series| pass(&series));
    let friction = stretch.displacement_m.each_ref().map(|x| pass(&unit_friction(x)));
    let compression = stretch.displacement_m.each_ref().map(|x| pass(x));
    let speed = stretch.displacement_m.each_ref().map(|x| derivative(x));
    let [along, across, up] = stretch.specific_force_m_s2.each_ref().map(|series| pass(series));
    let [roll_rate, pitch_rate, yaw_rate] = &stretch.rate_rad_s;
    let [roll, pitch, yaw] = [roll_rate, pitch_rate, yaw_rate].map(|series| derivative(series));
    let turning: Vec<f64> = (roll_rate.iter().zip(pitch_rate)).map(|(p, q)| p * p + q * q).collect();
    let (turning, yaw_rate) = (pass(&turning), pass(yaw_rate));

    let equations = &believed.equations;
    let (mass, [j_x, j_y, j_z]) = (equations.body_mass_kg, equations.body_inertia_kg_m2);
    let (ahead, left, unit) = (believed.ahead_m(), believed.left_m(), believed.unit_m);
    (0..up.len())
        .map(|k| {
            let (a_x, a_y, a_z) = (roll[k], pitch[k], yaw[k]);
            // From the unit's place to the centre of mass.
            let f_z = up[k] - unit[1] * a_x + unit[0] * a_y + unit[2] * turning[k];
            let f_y = across[k] - unit[0] * a_z + unit[2] * a_x;
            let f_x = along[k] - unit[2] * a_y + unit[1] * a_z;
            let bar = |axle: Axle| {
                let [l, r] = compression.of_axle(axle).map(|series| series[k]);
                let twist = (r - l) / (2.0 * equations.half_strut_spacing_m[axle]);
                equations.anti_roll_n_m_rad[axle] * twist
            };
            let bars = Axle::ALL.map(bar);
            let sum = |arm: &dyn Fn(Corner) -> f64| -> f64 {
                Corner::ALL
                    .into_iter()
                    .map(|corner| arm(corner) * force[corner][k])
                    .sum()
            };
            let mut slopes = [[0.0; UNKNOWNS]; 3];
            let [heave, pitching, rolling] = &mut slopes;
            (heave[MASS], heave[MASS_AHEAD], heave[MASS_LEFT]) = (f_z, -a_y, a_x);
            (pitching[MASS_AHEAD], pitching[PITCH_INERTIA], pitching[YAW]) = (-f_z, a_y, j_y * a_x);
            (rolling[MASS_LEFT], rolling[ROLL_INERTIA], rolling[YAW]) = (f_z, a_x, -j_x * a_y);
            for (at, moment) in BAR_LOST.into_iter().zip(bars) {
                rolling[at] = -moment;
            }
            let [front_m, rear_m] = equations.axle_ahead_m.into_array();
            let wheelbase_m = front_m - rear_m;
            rolling[ROLL_CENTRE[0]] = -(j_z * a_z - rear_m * mass * f_y) / wheelbase_m;
            rolling[ROLL_CENTRE[1]] = -(front_m * mass * f_y - j_z * a_z) / wheelbase_m;
            (pitching[LINKS[0]], heave[LINKS[1]]) = (mass * f_x, mass * f_x);
            for corner in Corner::ALL {
                let (at, course) = (FRICTION + corner.index(), friction[corner][k]);
                (heave[at], pitching[at], rolling[at]) = (-course, ahead[corner] * course, -left[corner] * course);
            }
            Row {
                unbalanced: [
                    sum(&|_| 1.0) - mass * f_z,
                    -sum(&|corner| ahead[corner]) - j_y * a_y,
                    sum(&|corner| left[corner]) - bars.iter().sum::<f64>() - j_x * a_x,
                ],
                slopes,
                yaw_rate: yaw_rate[k],
                strut_speed_squared: speed.values().map(|series| series[k] * series[k]).sum(),
            }
        })
        .collect()
}
