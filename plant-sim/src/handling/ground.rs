//! The plane that approximates the road below a wheel.
//!
//! A rigid-body tyre model needs a plane: a height below the wheel centre and a normal. The height is the road's at that
//! place (or, where the vehicle's file gives a contact length, the mean over it, as in the ride model); the slopes are
//! differences over the contact patch, the "effective plane" of Pacejka's chapter 10 in its simplest form.

use nalgebra::Vector3;

use crate::road::Road;

/// A plane under a wheel, world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    /// Height below the wheel centre, m.
    pub(super) height_m: f64,
    /// Unit normal of the ground, pointing up.
    pub(super) normal: Vector3<f64>,
}

/// How the plane is taken from a road.
#[derive(Debug, Clone, Copy)]
pub(super) struct Probe {
    /// Half the base along and across, m.
    pub(super) half_length_m: f64,
    pub(super) half_width_m: f64,
    /// Half the length over which the height is averaged, m; 0 = the height at the point.
    pub(super) half_contact_m: f64,
}

impl Probe {
    /// Plane below `(x, y)` for a wheel that points along the unit vector `(ahead_x, ahead_y)`.
    pub(super) fn plane(&self, road: &dyn Road, x: f64, y: f64, ahead: (f64, f64)) -> Plane {
        let (ax, ay) = ahead;
        let at = |along: f64, across: f64| road.height_m(x + along * ax - across * ay, y + along * ay + across * ax);
        let (a, b) = (self.half_length_m, self.half_width_m);
        let (fore, aft) = (at(a, 0.0), at(-a, 0.0));
        let (left, right) = (at(0.0, b), at(0.0, -b));
        let along = (fore - aft) / (2.0 * a);
        let across = (left - right) / (2.0 * b);
        let centre = at(0.0, 0.0);
        let height_m = if self.half_contact_m > 0.0 {
            let c = self.half_contact_m;
            // Simpson's rule over the contact length.
            let inner = at(0.5 * c, 0.0) + at(-0.5 * c, 0.0);
            (at(c, 0.0) + at(-c, 0.0) + 4.0 * inner + 2.0 * centre) / 12.0
        } else {
            centre
        };
        let slope_x = along * ax - across * ay;
        let slope_y = along * ay + across * ax;
        let scale = 1.0 / (1.0 + slope_x * slope_x + slope_y * slope_y).sqrt();
        Plane {
            height_m,
            normal: Vector3::new(-slope_x * scale, -slope_y * scale, scale),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Slope;
    impl Road for Slope {
        fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
            0.3 + 0.1 * station_m - 0.2 * lateral_m
        }
    }

    #[test]
    fn a_sloping_plane_is_found_whatever_the_heading() {
        let probe = Probe {
            half_length_m: 0.1,
            half_width_m: 0.1,
            half_contact_m: 0.08,
        };
        let normal = Vector3::new(-0.1, 0.2, 1.0) / (1.0f64 + 0.01 + 0.04).sqrt();
        for angle in [0.0, 0.7, 2.9] {
            let plane = probe.plane(&Slope, 5.0, 1.0, (libm::cos(angle), libm::sin(angle)));
            assert!((plane.height_m - 0.6).abs() < 1e-12);
            assert!((plane.normal - normal).norm() < 1e-12);
        }
    }
}
