//! The motion of a specimen, freed of noise.

/// Displacement freed of noise, with its derivatives; one value a sample.
#[derive(Debug, Clone, Default)]
pub struct SmoothedMotion {
    /// Displacement, m, compression positive.
    pub displacement_m: Vec<f64>,
    /// Speed of the piston, m/s, positive in jounce.
    pub speed_m_s: Vec<f64>,
    /// Acceleration of the piston, m/s2, positive in jounce.
    pub acceleration_m_s2: Vec<f64>,
}

/// Local parabolas over `half_window_s` on either side (Savitzky & Golay, Anal. Chem. 36(8), 1964, for uneven steps).
#[must_use]
pub fn smooth_motion(time_s: &[f64], displacement_m: &[f64], half_window_s: f64) -> SmoothedMotion {
    let n = time_s.len();
    let mut motion = SmoothedMotion::default();
    let (mut from, mut to) = (0, 0);
    for k in 0..n {
        while time_s[k] - time_s[from] > half_window_s {
            from += 1;
        }
        while to < n && time_s[to] - time_s[k] <= half_window_s {
            to += 1;
        }
        // Normal equations of c0 + c1 s + c2 s^2 with s in units of the half window.
        let mut s = [0.0; 5];
        let mut b = [0.0; 3];
        for j in from..to {
            let u = (time_s[j] - time_s[k]) / half_window_s;
            let powers = [1.0, u, u * u, u * u * u, u * u * u * u];
            s.iter_mut().zip(powers).for_each(|(s, p)| *s += p);
            b.iter_mut().zip(powers).for_each(|(b, p)| *b += p * displacement_m[j]);
        }
        let m = nalgebra::Matrix3::new(s[0], s[1], s[2], s[1], s[2], s[3], s[2], s[3], s[4]);
        let c = match m.try_inverse() {
            Some(inverse) if to - from > 4 => inverse * nalgebra::Vector3::new(b[0], b[1], b[2]),
            _ => nalgebra::Vector3::new(displacement_m[k], 0.0, 0.0),
        };
        motion.displacement_m.push(c[0]);
        motion.speed_m_s.push(c[1] / half_window_s);
        motion
            .acceleration_m_s2
            .push(2.0 * c[2] / (half_window_s * half_window_s));
    }
    motion
}

/// Mean sampling interval of a recording, s; 0 for fewer than two samples.
#[must_use]
pub fn mean_interval_s(time_s: &[f64]) -> f64 {
    let duration = time_s
        .last()
        .zip(time_s.first())
        .map_or(0.0, |(end, begin)| end - begin);
    duration / (time_s.len().max(2) - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_interval_is_that_between_samples() {
        assert_eq!(mean_interval_s(&[1.0, 1.5, 3.0]), 1.0);
        assert_eq!((mean_interval_s(&[2.0]), mean_interval_s(&[])), (0.0, 0.0));
    }

    #[test]
    fn a_parabola_is_its_own_smoothing() {
        let t: Vec<f64> = (0..200).map(|k| f64::from(k) * 0.01).collect();
        let x: Vec<f64> = t.iter().map(|t| 0.1 + 0.2 * t + 0.3 * t * t).collect();
        let m = smooth_motion(&t, &x, 0.05);
        assert!((m.displacement_m[100] - x[100]).abs() < 1e-12);
        assert!((m.speed_m_s[100] - 0.8).abs() < 1e-9 && (m.acceleration_m_s2[100] - 0.6).abs() < 1e-7);
    }
}
