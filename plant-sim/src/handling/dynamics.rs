//! Equations of motion: fourteen unconstrained degrees of freedom and the torsion of the body.
//!
//! ```text
//! body 6   (a, w')            a: acceleration of the body's centre of mass less gravity, w: angular velocity
//! axles 4  (s'', p'')_f,r     heave along and roll about the body's axes, see `axle`
//! wheels 4 Omega'             spin about each wheel's own axis
//! torsion  twist''            front half of the body against the rear half
//! ```
//!
//! Kane's form of Newton and Euler in body axes (T. R. Kane, D. A. Levinson, *Dynamics: Theory and Applications*, 1985):
//! every body's `m a_G` and `J W' + W x (J W + h)` are projected on what each coordinate moves. For an axle at `g` from the
//! body's centre of mass, with `l = dg/ds` (up, and a little fore and aft: `guide`), `t = e_x x arm` and W = w + e_x p':
//!
//! ```text
//! a_G = a + w' x g + l s'' + t p'' + w x (w x g) + 2 w x (l s' + t p') - arm p'^2 + l' s'
//! W'  = w' + e_x p'' + w x e_x p'
//! ```
//!
//! The axles' coordinates couple to the body only, so they are eliminated axle by axle (a 2 x 2 inverse each) and one
//! 6 x 6 positive definite system remains (Cholesky). Nothing is linearised: the equations hold for any roll angle.
//!
//! Heave and roll bring a little pitch and yaw of the axle with them (`guide`); loads and gyroscopic torques are projected on
//! those too.
//!
//! Wheels are rotors in the axle: `I Omega' = drive torque + tyre torque` about the wheel's axis, and `h = sum I Omega y_w` gives
//! the gyroscopic torque. The bearing passes everything but that tyre torque to the axle; the axle takes the reaction
//! of the drive torque.
//!
//! Torsion: the report's body is two rigid bodies on a revolute joint with a spring. Both halves are taken to have half
//! of J_x, so the mean roll and the twist separate exactly: `J_x/4 twist'' = (torque front - torque rear)/2 - c twist' - k
//! twist`, with the torques that struts and anti-roll bars put on either end (the links' small share in twisting is left
//! out). It is an elastic mode on top of the fourteen coordinates.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use oleo_interface::{Axle, Axles, Corners};
use serde::{Deserialize, Serialize};

use super::axle::AxleGeometry;
use super::axle_place::{AxleCoordinates, AxlePlace};
use super::guide::Guide;

/// Inertia of the body and what the axles are.
#[derive(Debug, Clone, PartialEq)]
pub struct Masses {
    /// Sprung mass of the vehicle, kg.
    pub body_kg: f64,
    /// J_x, J_y, J_z of the body, kg m2.
    pub body_inertia_kg_m2: Vector3<f64>,
    /// Front and rear axle.
    pub axles: Axles<AxleGeometry>,
    /// Spin inertia of one wheel of an axle, kg m2.
    pub spin_inertia_kg_m2: Axles<f64>,
    /// Torque that twists the body's front half against its rear half, N m/rad.
    pub torsional_stiffness_n_m_rad: f64,
    /// Its damping, N m s/rad.
    pub torsional_damping_n_m_s_rad: f64,
}

/// Velocities of all coordinates, body axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Velocities {
    pub(super) linear: Vector3<f64>,
    pub(super) angular: Vector3<f64>,
    pub(super) axles: Axles<AxleCoordinates>,
    pub(super) spin: Corners<f64>,
    pub(super) twist: f64,
}

/// Forces on all coordinates; gravity is not among them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Loads {
    /// On the whole vehicle, body axes, N.
    pub(super) force: Vector3<f64>,
    /// About the body's centre of mass, N m.
    pub(super) moment: Vector3<f64>,
    /// On each axle's coordinates.
    pub(super) axles: Axles<AxleCoordinates>,
    /// On each wheel's spin, N m.
    pub(super) spin: Corners<f64>,
    /// On the twist, N m.
    pub(super) twist: f64,
}

/// Accelerations of all coordinates, body axes; `linear` is less gravity (what an accelerometer reads).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Accelerations {
    pub(super) linear: Vector3<f64>,
    pub(super) angular: Vector3<f64>,
    pub(super) axles: Axles<AxleCoordinates>,
    pub(super) spin: Corners<f64>,
    pub(super) twist: f64,
}

/// A force and moment on an axle as all coordinates feel it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Wrench {
    force: Vector3<f64>,
    moment: Vector3<f64>,
    axle: AxleCoordinates,
}

impl Wrench {
    /// Of a force (N) at a point of the axle and a moment (N m), body axes.
    pub(super) fn on_axle(
        (place, guide): (&AxlePlace, &Guide),
        force: Vector3<f64>,
        point: Vector3<f64>,
        moment: Vector3<f64>,
    ) -> Self {
        Self {
            force,
            moment: point.cross(&force) + moment,
            axle: guide.generalised(place, &force, &point, &moment),
        }
    }
}

impl Loads {
    /// Adds what the left and the right wheel do to an axle: as a pair, so that mirrored loads give mirrored bits.
    pub(super) fn add_pair(&mut self, axle: Axle, left: &Wrench, right: &Wrench) {
        self.force += left.force + right.force;
        self.moment += left.moment + right.moment;
        self.axles[axle] = self.axles[axle].plus(1.0, left.axle.plus(1.0, right.axle));
    }
}

fn skew(v: Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0)
}

/// An axle's part of the equations, its own coordinates eliminated.
struct Eliminated {
    /// Inverse of the axle's 2 x 2 inertia: heave-heave, heave-roll, roll-roll.
    inverse: [f64; 3],
    /// Coupling of heave and of roll to the body's six accelerations.
    coupling: [SVector<f64, 6>; 2],
    /// Right-hand sides.
    right: [f64; 2],
}

impl Eliminated {
    fn solve(&self, right: [f64; 2]) -> [f64; 2] {
        let [a, b, c] = self.inverse;
        [a * right[0] + b * right[1], b * right[0] + c * right[1]]
    }
}

impl Masses {
    /// Angular momentum of the two wheels of an axle about their axes, body axes.
    fn wheel_momentum(&self, axle: Axle, velocities: &Velocities, axes: &Corners<Vector3<f64>>) -> Vector3<f64> {
        let inertia = self.spin_inertia_kg_m2[axle];
        let [left, right] = axes.of_axle(axle);
        let [left_spin, right_spin] = velocities.spin.of_axle(axle);
        left * (inertia * left_spin) + right * (inertia * right_spin)
    }

    /// Accelerations for places, velocities and loads. `axes`: each wheel's axis, body axes.
    pub(super) fn accelerations(
        &self,
        places: &Axles<AxlePlace>,
        velocities: &Velocities,
        loads: &Loads,
        axes: &Corners<Vector3<f64>>,
    ) -> Accelerations {
        let w = velocities.angular;
        let e_x = Vector3::new(1.0, 0.0, 0.0);
        let j = self.body_inertia_kg_m2;

        let mut mass = self.body_kg;
        let mut first = Vector3::zeros();
        let mut inertia = Matrix3::from_diagonal(&j);
        let mut force = loads.force;
        let mut moment = loads.moment - w.cross(&j.component_mul(&w));

        let parts = Axles::from_fn(|index| {
            let (axle, place) = (&self.axles[index], &places[index]);
            let rate = velocities.axles[index];
            let (m, g, l, t) = (axle.mass_kg, place.mass_centre, place.lift, place.swing);

            let relative = l * rate.heave + t * rate.roll;
            let sliding = axle.guide.pitch_per_heave_rad_m * rate.heave * (rate.heave + place.arm.y * rate.roll);
            let bias = w.cross(&(w.cross(&g) + relative * 2.0)) - place.arm * (rate.roll * rate.roll) + e_x * sliding;
            let turn = w + e_x * rate.roll;
            // The wheels' axes turn with the axle as its links guide it, which makes their gyroscopic torque.
            let gyroscopic = (w + axle.guide.turn(place, rate)).cross(&self.wheel_momentum(index, velocities, axes));
            let guided = axle.guide.guided(place, &gyroscopic);
            let turn_bias =
                place.inertia * (w.cross(&e_x) * rate.roll) + turn.cross(&(place.inertia * turn)) + gyroscopic;

            let g_skew = skew(g);
            mass += m;
            first += g * m;
            inertia += place.inertia - g_skew * g_skew * m;
            force -= bias * m;
            moment -= g.cross(&bias) * m + turn_bias;

            let heave = g.cross(&l) * m;
            let roll = g.cross(&t) * m + e_x * axle.roll_inertia_kg_m2;
            let (a, b, c) = (m * l.dot(&l), m * l.dot(&t), m * t.dot(&t) + axle.roll_inertia_kg_m2);
            let determinant = a * c - b * b;
            let load = loads.axles[index];
            Eliminated {
                inverse: [c / determinant, -b / determinant, a / determinant],
                coupling: [
                    SVector::from([m * l.x, 0.0, m * l.z, heave.x, heave.y, heave.z]),
                    SVector::from([m * t.x, m * t.y, m * t.z, roll.x, roll.y, roll.z]),
                ],
                right: [
                    load.heave - m * l.dot(&bias) - guided.heave,
                    load.roll - m * t.dot(&bias) - turn_bias.x - guided.roll,
                ],
            }
        });

        let mut matrix = SMatrix::<f64, 6, 6>::zeros();
        let cross = skew(first);
        for row in 0..3 {
            matrix[(row, row)] = mass;
            for column in 0..3 {
                matrix[(row, column + 3)] = -cross[(row, column)];
                matrix[(row + 3, column)] = cross[(row, column)];
                matrix[(row + 3, column + 3)] = inertia[(row, column)];
            }
        }
        let mut right = SVector::from([force.x, force.y, force.z, moment.x, moment.y, moment.z]);
        for (_, part) in parts.iter() {
            let [heave, roll] = &part.coupling;
            let [a, b, c] = part.inverse;
            let (first, second) = (heave * a + roll * b, heave * b + roll * c);
            let known = part.solve(part.right);
            for row in 0..6 {
                right[row] -= heave[row] * known[0] + roll[row] * known[1];
                for column in 0..=row {
                    matrix[(row, column)] -= heave[row] * first[column] + roll[row] * second[column];
                }
            }
        }
        // Only the lower triangle is read. Positive definite for positive masses, which the parameters guarantee.
        let body = matrix
            .cholesky()
            .map_or_else(SVector::zeros, |factor| factor.solve(&right));

        let axles = parts.each_ref().map(|part| {
            let [heave, roll] = part.solve([
                part.right[0] - part.coupling[0].dot(&body),
                part.right[1] - part.coupling[1].dot(&body),
            ]);
            AxleCoordinates { heave, roll }
        });
        Accelerations {
            linear: Vector3::new(body[0], body[1], body[2]),
            angular: Vector3::new(body[3], body[4], body[5]),
            axles,
            spin: Corners::from_fn(|corner| loads.spin[corner] / self.spin_inertia_kg_m2[corner.axle()]),
            twist: loads.twist / (0.25 * j.x),
        }
    }

    /// Kinetic energy of all bodies, J.
    pub(super) fn kinetic_energy_j(&self, places: &Axles<AxlePlace>, velocities: &Velocities) -> f64 {
        let (v, w) = (velocities.linear, velocities.angular);
        let j = self.body_inertia_kg_m2;
        let mut twice = self.body_kg * v.dot(&v) + w.dot(&j.component_mul(&w));
        for (index, axle) in self.axles.iter() {
            let place = &places[index];
            let (speed, turn) = axle_motion(place, velocities, index);
            twice += axle.mass_kg * speed.dot(&speed) + turn.dot(&(place.inertia * turn));
            for spin in velocities.spin.of_axle(index) {
                twice += self.spin_inertia_kg_m2[index] * spin * spin;
            }
        }
        0.5 * (twice + 0.25 * j.x * velocities.twist * velocities.twist)
    }

    /// Momentum (kg m/s) and angular momentum about the body's centre of mass (kg m2/s), body axes.
    #[cfg(test)]
    pub(super) fn momentum(
        &self,
        places: &Axles<AxlePlace>,
        velocities: &Velocities,
        axes: &Corners<Vector3<f64>>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let mut linear = velocities.linear * self.body_kg;
        let mut angular = self.body_inertia_kg_m2.component_mul(&velocities.angular);
        for (index, axle) in self.axles.iter() {
            let place = &places[index];
            let (speed, turn) = axle_motion(place, velocities, index);
            linear += speed * axle.mass_kg;
            angular += place.mass_centre.cross(&speed) * axle.mass_kg
                + place.inertia * turn
                + self.wheel_momentum(index, velocities, axes);
        }
        (linear, angular)
    }
}

/// Velocity of an axle's centre of mass and the axle's angular velocity, body axes.
fn axle_motion(place: &AxlePlace, velocities: &Velocities, index: Axle) -> (Vector3<f64>, Vector3<f64>) {
    let rate = velocities.axles[index];
    let speed = velocities.linear + velocities.angular.cross(&place.mass_centre) + place.swing * rate.roll;
    let turn = velocities.angular + Vector3::new(rate.roll, 0.0, 0.0);
    (speed + place.lift * rate.heave, turn)
}
