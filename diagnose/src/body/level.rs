//! The unit's axes turned to the body's.
//!
//! In a drive straight ahead the mean specific force points up. This levels the unit without any knowledge of how it is mounted; what is left is the
//! angle about the vertical, which the balance itself shows. The mean also holds the mean lean of road and vehicle, which a drive in one
//! direction cannot tell from the mounting. An error of a degree in the level changes the vertical specific force by 0.02 %.

use super::drive::BodyDrive;

/// How the unit is turned against the body: yaw, then pitch, then roll, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude {
    /// About z, to the left positive.
    pub yaw: f64,
    /// About y, nose down positive.
    pub pitch: f64,
    /// About x, left side up positive.
    pub roll: f64,
}

impl Attitude {
    /// Pitch and roll of a unit of which this is the mean specific force straight ahead; its yaw is not seen by this.
    pub fn of_mean([x, y, z]: [f64; 3]) -> Self {
        Self {
            yaw: 0.0,
            pitch: libm::asin(-x / (x * x + y * y + z * z).sqrt()),
            roll: libm::atan2(y, z),
        }
    }

    /// A vector in the unit's axes, in those of the body.
    pub fn in_body(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = libm::sincos(self.roll);
        let (y, z) = (cos * y - sin * z, sin * y + cos * z);
        let (sin, cos) = libm::sincos(self.pitch);
        let (x, z) = (cos * x + sin * z, cos * z - sin * x);
        let (sin, cos) = libm::sincos(self.yaw);
        [cos * x - sin * y, sin * x + cos * y, z]
    }

    /// The drive with the unit's readings in the axes of the body.
    pub fn turned(&self, drive: &BodyDrive) -> BodyDrive {
        let mut turned = drive.clone();
        for vectors in [&mut turned.specific_force_m_s2, &mut turned.rate_rad_s] {
            for k in 0..vectors[0].len() {
                let body = self.in_body([vectors[0][k], vectors[1][k], vectors[2][k]]);
                for (series, value) in vectors.iter_mut().zip(body) {
                    series[k] = value;
                }
            }
        }
        turned
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_levels_whatever_the_yaw() {
        // What a unit that is turned by 7 degrees of pitch and -4 of roll reads at rest, by hand.
        let (pitch, roll) = (7f64.to_radians(), -4f64.to_radians());
        let read = {
            let ((sin, cos), (sin_roll, cos_roll)) = (libm::sincos(pitch), libm::sincos(roll));
            [-sin, cos * sin_roll, cos * cos_roll].map(|x| 9.8 * x)
        };
        let found = Attitude::of_mean(read);
        assert!((found.pitch - pitch).abs() < 1e-12 && (found.roll - roll).abs() < 1e-12);
        let up = Attitude { yaw: 1.0, ..found }.in_body(read);
        assert!(
            up[0].abs() < 1e-12 && up[1].abs() < 1e-12 && (up[2] - 9.8).abs() < 1e-12,
            "{up:?}"
        );
        let turned = Attitude {
            yaw: 0.5 * core::f64::consts::PI,
            pitch: 0.0,
            roll: 0.0,
        };
        let left = turned.in_body([1.0, 0.0, 0.0]);
        assert!(
            (left[1] - 1.0).abs() < 1e-12,
            "the unit's x axis points to the left: {left:?}"
        );
    }
}
