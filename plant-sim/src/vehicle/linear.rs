//! The ride model's linearisation about the static position: mass and stiffness matrices, eigenfrequencies, mode shapes.
//!
//! Stiffness is assembled spring by spring, `K = sum k b b^T` with `b` the row that turns the seven coordinates into
//! the spring's stretch: an independent way to the same physics as the forces of [`super::equations`], so that each
//! tests the other. Gravity adds nothing: heave is vertical and the small-angle model has no pendulum term.

use nalgebra::{SMatrix, SVector, SymmetricEigen};
use oleo_interface::{Axle, Corners, Side};

use super::equations::{Coordinates, Equations};
use super::parameters::VehicleParameters;

/// Mass (diagonal) and stiffness of the seven coordinates in the order of [`Coordinates::to_array`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linearisation {
    /// Diagonal of M: kg, kg m2.
    pub mass: [f64; 7],
    /// K: N/m, N, N m.
    pub stiffness: SMatrix<f64, 7, 7>,
}

/// One way the undamped vehicle swings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Undamped natural frequency, Hz.
    pub frequency_hz: f64,
    /// Shape; the largest entry is 1.
    pub shape: Coordinates,
}

impl Mode {
    /// What moves most, in words. Rotations are compared by the travel they give the wheels: half the track, half the
    /// wheelbase.
    pub fn name(&self) -> &'static str {
        let [z, zf, zr, pitch, roll, rf, rr] = self.shape.to_array();
        let (half_track_m, half_wheelbase_m) = (0.75, 1.4);
        let parts = [
            ("body heave", z),
            ("front axle heave", zf),
            ("rear axle heave", zr),
            ("body pitch", half_wheelbase_m * pitch),
            ("body roll", half_track_m * roll),
            ("front axle roll", half_track_m * rf),
            ("rear axle roll", half_track_m * rr),
        ];
        parts
            .iter()
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            .map_or("", |part| part.0)
    }
}

impl Linearisation {
    /// With a given rate at each corner's strut, N/m.
    pub fn new(parameters: &VehicleParameters, strut_stiffness_n_m: Corners<f64>) -> Self {
        let equations = Equations::new(parameters);
        let m_s = equations.body_mass_kg;
        let [j_x, j_y, _] = equations.body_inertia_kg_m2;
        let [m_f, m_r] = equations.axle_mass_kg.into_array();
        let [j_f, j_r] = equations.axle_inertia_kg_m2.into_array();
        let mut stiffness = SMatrix::<f64, 7, 7>::zeros();
        let mut add = |rate: f64, stretch: [f64; 7]| {
            let b = SVector::<f64, 7>::from(stretch);
            stiffness += b * b.transpose() * rate;
        };
        for axle in Axle::ALL {
            let ahead = equations.axle_ahead_m[axle];
            // Places of the axle's heave and roll among the seven coordinates.
            let (heave, roll) = match axle {
                Axle::Front => (1, 5),
                Axle::Rear => (2, 6),
            };
            for (side, sign) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
                let lever = sign * equations.half_strut_spacing_m[axle];
                let mut strut = [1.0, 0.0, 0.0, -ahead, lever, 0.0, 0.0];
                strut[heave] = -1.0;
                strut[roll] = -lever;
                add(strut_stiffness_n_m[axle.corner(side)], strut);
                let mut tyre = [0.0; 7];
                tyre[heave] = 1.0;
                tyre[roll] = sign * equations.half_track_m[axle];
                add(parameters.axle(axle).tyre_stiffness_n_m, tyre);
            }
            let mut bar = [0.0; 7];
            bar[4] = 1.0;
            bar[roll] = -1.0;
            add(equations.anti_roll_n_m_rad[axle], bar);
        }
        Self {
            mass: [m_s, m_f, m_r, j_y, j_x, j_f, j_r],
            stiffness,
        }
    }

    /// The seven modes, slowest first: eigenvectors of `M^-1/2 K M^-1/2`.
    pub fn modes(&self) -> [Mode; 7] {
        let root = self.mass.map(f64::sqrt);
        let scaled = SMatrix::<f64, 7, 7>::from_fn(|i, j| self.stiffness[(i, j)] / (root[i] * root[j]));
        let eigen = SymmetricEigen::new(scaled);
        let mut modes = core::array::from_fn(|k| {
            let shape: [f64; 7] = core::array::from_fn(|i| eigen.eigenvectors[(i, k)] / root[i]);
            let largest = shape
                .iter()
                .fold(0.0, |m: f64, x| if x.abs() > m.abs() { *x } else { m });
            Mode {
                frequency_hz: eigen.eigenvalues[k].max(0.0).sqrt() / (2.0 * core::f64::consts::PI),
                shape: Coordinates::from_array(shape.map(|x| x / largest)),
            }
        });
        modes.sort_by(|a: &Mode, b: &Mode| a.frequency_hz.total_cmp(&b.frequency_hz));
        modes
    }
}
