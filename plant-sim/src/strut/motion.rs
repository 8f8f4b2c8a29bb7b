//! How the actuator moves: a cubic from sample to sample, with one speed before each sample and one after it.

use oleo_interface::StrutValves;

/// An acceleration jumps at a sample if it changes there this many times as much as beside it.
const JUMPS: f64 = 3.0;

/// One sampling interval of a motion: where it ends, and the speeds at its two ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Displacement at the end, m, compression positive.
    pub to_m: f64,
    /// Speed just after the beginning, m/s.
    pub from_m_s: f64,
    /// Speed just before the end, m/s.
    pub to_m_s: f64,
}

impl Segment {
    /// Standing still.
    #[must_use]
    pub const fn rest(at_m: f64) -> Self {
        Self {
            to_m: at_m,
            from_m_s: 0.0,
            to_m_s: 0.0,
        }
    }

    /// The part of an interval of `duration_s` in which the motion from `from_m` happens: when it begins and how long it
    /// takes, s.
    ///
    /// Where the motion begins or ends at rest and its other speed would carry it farther than it goes, it has begun or
    /// ended within the interval: at constant acceleration, which takes twice the way over the speed. (A cubic over the
    /// whole interval would overshoot and come back, and a seal's friction with it.)
    ///
    /// ```
    /// use oleo_plant_sim::strut::Segment;
    /// // From 0.2 m/s to rest within 1 mm takes 10 ms, whatever the sampling interval.
    /// let stop = Segment { to_m: 1e-3, from_m_s: 0.2, to_m_s: 0.0 };
    /// assert_eq!(stop.moves_within(0.0, 0.02), (0.0, 0.01));
    /// ```
    #[must_use]
    pub fn moves_within(&self, from_m: f64, duration_s: f64) -> (f64, f64) {
        let rise = self.to_m - from_m;
        let takes = |speed: f64| {
            let time = 2.0 * rise / speed;
            (time > 0.0 && time < duration_s).then_some(time)
        };
        if self.to_m_s == 0.0 {
            takes(self.from_m_s).map_or((0.0, duration_s), |time| (0.0, time))
        } else if self.from_m_s == 0.0 {
            takes(self.to_m_s).map_or((0.0, duration_s), |time| (duration_s - time, time))
        } else {
            (0.0, duration_s)
        }
    }
}

/// How a strut is to move over an interval, and the switching signals of its valves meanwhile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrutMove {
    /// Where it ends, and the speeds at its two ends.
    pub segment: Segment,
    /// Duration of the interval, s.
    pub duration_s: f64,
    /// Switching signals, true for open.
    pub signals: StrutValves<bool>,
}

/// A displacement history that a strut can be driven with.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Displacement at the first sample, m.
    pub start_m: f64,
    /// One segment for each sampling interval.
    pub segments: Vec<Segment>,
}

impl Motion {
    /// The motion through displacements (m) and speeds (m/s) at its samples, without a jump of speed.
    #[cfg(test)]
    pub(super) fn through(rod: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let rod: Vec<(f64, f64)> = rod.into_iter().collect();
        let segments = rod.windows(2).map(|ends| Segment {
            to_m: ends[1].0,
            from_m_s: ends[0].1,
            to_m_s: ends[1].1,
        });
        Self {
            start_m: rod[0].0,
            segments: segments.collect(),
        }
    }

    /// Acceleration at each sample, m/s2, where all motion is known. It is taken across the sample, or from that side of it on which it changes much less: where the
    /// acceleration jumps, a mean of both sides is neither.
    pub(super) fn accelerations_m_s2(&self, time_s: &[f64]) -> Vec<f64> {
        self.accelerations(time_s, |at| at.steadier_m_s2)
    }

    /// Acceleration just before each sample and just after it, m/s2. They differ where it jumps at the sample itself; where it jumps within an interval, both of a
    /// sample are those of its other interval.
    pub(super) fn accelerations_beside_samples_m_s2(&self, time_s: &[f64]) -> Vec<[f64; 2]> {
        self.accelerations(time_s, |at| at.beside_m_s2)
    }

    fn accelerations<T>(&self, time_s: &[f64], of: impl Fn(Acceleration) -> T) -> Vec<T> {
        let means: Vec<f64> = (self.segments.iter().zip(time_s.windows(2)))
            .map(|(segment, time)| (segment.to_m_s - segment.from_m_s) / (time[1] - time[0]))
            .collect();
        let mean = |k: Option<usize>| means.get(k?).copied();
        let around = |k: usize| {
            [
                mean(k.checked_sub(2)),
                mean(k.checked_sub(1)),
                mean(Some(k)),
                mean(Some(k + 1)),
            ]
        };
        (0..=self.segments.len())
            .map(|k| of(Acceleration::between(around(k))))
            .collect()
    }
}

/// Acceleration at a sample, m/s2.
struct Acceleration {
    /// From the side on which it changes less, if it jumps; else across the sample.
    steadier_m_s2: f64,
    /// Just before the sample and just after it.
    beside_m_s2: [f64; 2],
}

impl Acceleration {
    /// Between the means of two intervals before a sample and two after it, m/s2.
    fn between([second_last, last, next, second_next]: [Option<f64>; 4]) -> Self {
        let everywhere = |m_s2: f64| Self {
            steadier_m_s2: m_s2,
            beside_m_s2: [m_s2; 2],
        };
        let (Some(before), Some(after)) = (last, next) else {
            return everywhere(last.or(next).unwrap_or(0.0));
        };
        let change = after - before;
        // From either side by a line through the means of two intervals, if it changes much less there.
        let steady = |c: &f64| JUMPS * c.abs() < change.abs();
        let from_before = second_last.map(|m| before - m).filter(steady);
        let from_after = second_next.map(|m| m - after).filter(steady);
        match (from_before, from_after) {
            (None, None) => everywhere(before + 0.5 * change),
            (Some(c), None) => everywhere(before + 0.5 * c),
            (None, Some(c)) => everywhere(after - 0.5 * c),
            (Some(c), Some(d)) => {
                let beside_m_s2 = [before + 0.5 * c, after - 0.5 * d];
                Self {
                    steadier_m_s2: beside_m_s2[usize::from(d.abs() < c.abs())],
                    beside_m_s2,
                }
            }
        }
    }
}

/// The cubic through displacement and speed at both ends of an interval: both agree with it at any time inside.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cubic {
    start_m: f64,
    duration_s: f64,
    coefficients: [f64; 3],
}

impl Cubic {
    pub fn through(start_m: f64, segment: &Segment, duration_s: f64) -> Self {
        let (a, b) = (segment.from_m_s * duration_s, segment.to_m_s * duration_s);
        let rise = segment.to_m - start_m;
        Self {
            start_m,
            duration_s,
            coefficients: [a, 3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise],
        }
    }

    /// Displacement, m, and speed, m/s, after a fraction of the interval.
    #[inline(always)]
    pub fn at(&self, fraction: f64) -> (f64, f64) {
        let [a, c2, c3] = self.coefficients;
        (
            self.start_m + fraction * (a + fraction * (c2 + fraction * c3)),
            (a + fraction * (2.0 * c2 + 3.0 * fraction * c3)) / self.duration_s,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_from_or_to_rest_moves_at_constant_acceleration_within_its_interval() {
        let s = |from_m_s, to_m_s| Segment {
            to_m: 1e-3,
            from_m_s,
            to_m_s,
        };
        assert_eq!(s(0.2, 0.0).moves_within(0.0, 0.02), (0.0, 0.01));
        assert_eq!(s(0.0, 0.2).moves_within(0.0, 0.02), (0.01, 0.01));
        for whole in [s(0.08, 0.0), s(0.0, 0.08), s(-0.2, 0.0), s(0.2, 0.2), s(0.0, 0.0)] {
            assert_eq!(whole.moves_within(0.0, 0.02), (0.0, 0.02), "{whole:?}");
        }
    }

    #[test]
    fn the_cubic_has_displacement_and_speed_at_both_ends() {
        let segment = Segment {
            to_m: 3e-3,
            from_m_s: 0.1,
            to_m_s: -0.4,
        };
        let cubic = Cubic::through(1e-3, &segment, 0.02);
        let (x, v) = cubic.at(0.0);
        assert!((x - 1e-3).abs() < 1e-15 && (v - 0.1).abs() < 1e-12);
        let (x, v) = cubic.at(1.0);
        assert!((x - 3e-3).abs() < 1e-15 && (v + 0.4).abs() < 1e-12);
    }

    /// Motion whose speeds at even samples are these.
    fn through_speeds(speed_m_s: &[f64], interval_s: f64) -> (Vec<f64>, Motion) {
        let segments = (speed_m_s.windows(2))
            .map(|v| Segment {
                to_m: 0.0,
                from_m_s: v[0],
                to_m_s: v[1],
            })
            .collect();
        let time_s = (0..speed_m_s.len()).map(|k| interval_s * k as f64).collect();
        (time_s, Motion { start_m: 0.0, segments })
    }

    #[test]
    fn an_acceleration_that_is_smooth_is_that_across_each_sample() {
        let speed: Vec<f64> = (0..200).map(|k| libm::sin(0.05 * f64::from(k))).collect();
        let (time_s, motion) = through_speeds(&speed, 0.002);
        let found = motion.accelerations_m_s2(&time_s);
        assert_eq!(found.len(), speed.len());
        for (k, a) in found.iter().enumerate().skip(2).take(196) {
            let exact = 25.0 * libm::cos(0.05 * k as f64);
            assert!((a - exact).abs() < 0.03, "{k}: {a} {exact}");
        }
    }

    #[test]
    fn an_acceleration_that_jumps_between_two_samples_is_that_of_its_side() {
        // From 1 to -3 m/s2 at a quarter of the interval after sample 5.
        let speed: Vec<f64> = (0..12)
            .map(|k| 0.01 * f64::from(k))
            .map(|t| t.min(0.0525) - 3.0 * (t - 0.0525).max(0.0))
            .collect();
        let (time_s, motion) = through_speeds(&speed, 0.01);
        for (k, a) in motion.accelerations_m_s2(&time_s).into_iter().enumerate() {
            let exact = if k <= 5 { 1.0 } else { -3.0 };
            assert!((a - exact).abs() < 1e-9, "{k}: {a} {exact}");
        }
    }

    #[test]
    fn beside_a_sample_the_acceleration_is_that_of_each_side_only_where_it_jumps() {
        // From 1 to -3 m/s2 at sample 5, and within the interval after it.
        for (jumps_s, at_sample_5) in [(0.05, [1.0, -3.0]), (0.055, [1.0, 1.0])] {
            let speed: Vec<f64> = (0..12)
                .map(|k| 0.01 * f64::from(k))
                .map(|t| t.min(jumps_s) - 3.0 * (t - jumps_s).max(0.0))
                .collect();
            let (time_s, motion) = through_speeds(&speed, 0.01);
            for (k, beside) in motion.accelerations_beside_samples_m_s2(&time_s).iter().enumerate() {
                let exact = match k {
                    0..5 => [1.0; 2],
                    5 => at_sample_5,
                    _ => [-3.0; 2],
                };
                assert!(
                    beside.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-9),
                    "{k}: {beside:?}"
                );
            }
        }
    }

    #[test]
    fn a_motion_of_few_samples_has_the_accelerations_that_it_shows() {
        let of = |speed: &[f64]| {
            let (time_s, motion) = through_speeds(speed, 0.5);
            motion.accelerations_m_s2(&time_s)
        };
        assert_eq!(of(&[]), [0.0]);
        assert_eq!(of(&[1.0, 2.0]), [2.0, 2.0]);
        assert_eq!(of(&[1.0, 2.0, 4.0]), [2.0, 3.0, 4.0]);
    }
}
