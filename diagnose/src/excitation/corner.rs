//! Clocks compared at corners: where a motion starts or stops sharply, what it drives must start or stop with it.
//!
//! Within a second or two of a corner every slow process (heat, leakage, drift) is a straight line in time, so the delay
//! between cause and effect is read off without a model of any of them. It is the one test in which a late instrument
//! and a thermal lag cannot be mistaken for each other.

/// Half of the stretch around a corner that is looked at, s.
const HALF_STRETCH_S: f64 = 1.2;
/// Largest delay looked for, s.
const MOST_DELAY_S: f64 = 1.0;
/// Most corners used, the sharpest.
const MOST_CORNERS: usize = 40;
/// Corners softer than this part of the sharpest are not corners.
const LEAST_SHARPNESS: f64 = 0.15;
/// Fewest samples in a stretch.
const LEAST_SAMPLES: usize = 24;
/// Fewest samples of a recording, in stretches of the fewest samples: less holds no corner with its surroundings.
const LEAST_STRETCHES: usize = 4;
/// Half window over which the motion is smoothed for its acceleration, as a fraction of half a stretch: a bend stays sharp
/// beside the stretch.
const SMOOTHING: f64 = 0.2;
/// What the best delay leaves of the effect must be below this fraction of the bend, or the corner is of something else.
const MOST_LEFT: f64 = 0.05;
/// A bend must stand out of the noise of the effect this many times.
const LEAST_BEND: f64 = 8.0;

/// A corner of a motion: a sharp start or stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Time of the corner, s.
    pub time_s: f64,
    /// By how much the effect is late, s.
    pub delay_s: f64,
    /// Slope of effect over cause there.
    pub slope: f64,
    /// True if a delay explains the corner better than a first-order lag of any time constant: it is sharp, only late.
    pub sharp: bool,
}

/// Time constants of a lag held against a delay, in sampling intervals.
const LAGS: [f64; 10] = [1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 18.0, 25.0, 35.0, 50.0];

/// What is known of two columns while their corners are looked for.
struct Pair<'a> {
    time_s: &'a [f64],
    cause: &'a [f64],
    lagged: Vec<Vec<f64>>,
    effect: &'a [f64],
    noise: f64,
    interval: f64,
    half: usize,
}

/// Corners of `cause` and the delay of `effect` at each, in order of time. `noise` is the effect's standard deviation.
#[must_use]
pub fn corners(time_s: &[f64], cause: &[f64], effect: &[f64], noise: f64) -> Vec<Corner> {
    let n = time_s.len();
    if n < LEAST_STRETCHES * LEAST_SAMPLES {
        return Vec::new();
    }
    let interval = (time_s[n - 1] - time_s[0]) / (n - 1) as f64;
    let half = (HALF_STRETCH_S / interval) as usize;
    let reach = half + (MOST_DELAY_S / interval) as usize + 1;
    if 2 * half < LEAST_SAMPLES || n < 2 * reach + 2 {
        return Vec::new();
    }
    let motion = oleo_plant_sim::specimen::smooth_motion(time_s, cause, SMOOTHING * HALF_STRETCH_S);
    let mut sharpness: Vec<f64> = motion.acceleration_m_s2.iter().map(|a| a.abs()).collect();
    sharpness[..reach].fill(0.0);
    sharpness[n - reach..].fill(0.0);
    let most = sharpness.iter().copied().fold(0.0, f64::max);
    let pair = Pair {
        time_s,
        cause,
        lagged: LAGS.iter().map(|tau| lagged(cause, *tau)).collect(),
        effect,
        noise,
        interval,
        half,
    };
    let mut found = Vec::new();
    let mut tried = 0;
    while tried < MOST_CORNERS {
        let at = (0..n)
            .max_by(|&a, &b| sharpness[a].total_cmp(&sharpness[b]))
            .unwrap_or(0);
        if most <= 0.0 || sharpness[at] < LEAST_SHARPNESS * most {
            break;
        }
        sharpness[at.saturating_sub(2 * half)..(at + 2 * half).min(n)].fill(0.0);
        tried += 1;
        found.extend(pair.delay_at(at));
    }
    found.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    found
}

/// First-order lag, the time constant in samples.
fn lagged(series: &[f64], samples: f64) -> Vec<f64> {
    let keep = libm::exp(-1.0 / samples);
    let mut state = series.first().copied().unwrap_or(0.0);
    (series.iter())
        .map(|v| {
            state = v + (state - v) * keep;
            state
        })
        .collect()
}

impl Pair<'_> {
    /// The delay that leaves least of the effect unexplained by a line in time and the delayed cause.
    fn delay_at(&self, at: usize) -> Option<Corner> {
        let stretch = at - self.half..at + self.half;
        let time = &self.time_s[stretch.clone()];
        let steps = (MOST_DELAY_S / self.interval) as isize;
        let y = without_line(time, &self.effect[stretch.clone()]);
        let total: f64 = y.iter().map(|v| v * v).sum();
        if (total / y.len() as f64).sqrt() < LEAST_BEND * self.noise {
            return None;
        }
        // What is left of the effect, and its slope over a cause.
        let left = |cause: &[f64]| {
            let x = without_line(time, cause);
            let (xy, xx) = (x.iter().zip(&y)).fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + x * y, xx + x * x));
            let slope = if xx > 0.0 { xy / xx } else { 0.0 };
            let left: f64 = x.iter().zip(&y).map(|(x, y)| (y - slope * x) * (y - slope * x)).sum();
            (left, slope)
        };
        let mut best = (f64::INFINITY, 0, 0.0);
        for shift in -steps..=steps {
            let from = (stretch.start as isize - shift) as usize;
            let (remains, slope) = left(&self.cause[from..from + stretch.len()]);
            if remains < best.0 {
                best = (remains, shift, slope);
            }
        }
        let with_lag = (self.lagged.iter())
            .map(|cause| left(&cause[stretch.clone()]).0)
            .fold(f64::INFINITY, f64::min);
        let (remains, shift, slope) = best;
        (remains < MOST_LEFT * total && shift.abs() < steps).then_some(Corner {
            time_s: self.time_s[at],
            delay_s: shift as f64 * self.interval,
            slope,
            sharp: remains < with_lag,
        })
    }
}

fn without_line(time_s: &[f64], series: &[f64]) -> Vec<f64> {
    let n = series.len() as f64;
    let (mt, ms) = (time_s.iter().sum::<f64>() / n, series.iter().sum::<f64>() / n);
    let (ts, tt) = (time_s.iter().zip(series)).fold((0.0, 0.0), |(ts, tt), (t, s)| {
        (ts + (t - mt) * (s - ms), tt + (t - mt) * (t - mt))
    });
    let slope = if tt > 0.0 { ts / tt } else { 0.0 };
    (time_s.iter().zip(series))
        .map(|(t, s)| s - ms - slope * (t - mt))
        .collect()
}

/// Delays of enough corners to speak for the whole recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Number of corners that were evaluated.
    pub corners: usize,
    /// Smallest, median and largest delay, s; of ten corners and more the outermost tenth at either end is left out.
    pub delay_s: [f64; 3],
    /// Smallest and largest slope, likewise.
    pub slope: [f64; 2],
    /// Part of the corners that are late but sharp, 0 to 1.
    pub sharp: f64,
}

/// Fewest corners that speak for a recording.
const LEAST_CORNERS: usize = 4;
/// One corner of this many at either end is left out of the smallest and largest delay and slope: a few are misread.
const CORNERS_PER_OUTLIER: usize = 10;
/// A delay must be above this many sampling intervals to be called one: the median of corners is good to about one.
const LEAST_DELAY_INTERVALS: f64 = 3.0;
/// The delays of one late clock scatter by less than this fraction of their median.
const MOST_SCATTER: f64 = 0.5;

impl Clock {
    /// What corners say together; `None` of too few.
    #[must_use]
    pub fn of(corners: &[Corner]) -> Option<Self> {
        if corners.len() < LEAST_CORNERS {
            return None;
        }
        let sorted = |value: fn(&Corner) -> f64| {
            let mut all: Vec<f64> = corners.iter().map(value).collect();
            all.sort_by(f64::total_cmp);
            all
        };
        let (delays, slopes) = (sorted(|c| c.delay_s), sorted(|c| c.slope));
        let n = corners.len();
        let edge = n / CORNERS_PER_OUTLIER;
        Some(Self {
            corners: n,
            delay_s: [delays[edge], delays[n / 2], delays[n - 1 - edge]],
            slope: [slopes[edge], slopes[n - 1 - edge]],
            sharp: corners.iter().filter(|c| c.sharp).count() as f64 / n as f64,
        })
    }

    /// True if one delay, and not zero, explains every corner: their scatter is small beside it.
    #[must_use]
    pub fn is_late(&self, interval_s: f64) -> bool {
        let [low, middle, high] = self.delay_s;
        middle.abs() > LEAST_DELAY_INTERVALS * interval_s && high - low < MOST_SCATTER * middle.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ramps and holds through a thermal lag of 6 s, shown late by `delay`.
    fn relaxing(delay: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let dt = 0.02;
        let time: Vec<f64> = (0..6000).map(|k| f64::from(k) * dt).collect();
        let cause: Vec<f64> = time
            .iter()
            .map(|t| (t % 20.0 - 5.0).clamp(0.0, 5.0) - (t % 20.0 - 13.0).clamp(0.0, 5.0))
            .collect();
        let (mut slow, mut effect) = (0.0, Vec::new());
        for c in &cause {
            slow += (c - slow) * dt / 6.0;
            effect.push(1.4 * c - 0.4 * slow);
        }
        let late = (delay / dt) as usize;
        let shown = (0..time.len()).map(|k| effect[k.saturating_sub(late)]).collect();
        (time, cause, shown)
    }

    #[test]
    fn a_late_sensor_is_told_from_a_thermal_lag() {
        for delay in [0.0, 0.3] {
            let (t, x, y) = relaxing(delay);
            let clock = Clock::of(&corners(&t, &x, &y, 1e-4)).expect("corners");
            assert!(clock.corners > 15, "{clock:?}");
            assert!((clock.delay_s[1] - delay).abs() < 0.03, "{clock:?}");
            assert_eq!(clock.is_late(0.02), delay > 0.0, "{clock:?}");
            assert!(delay == 0.0 || clock.sharp > 0.9, "{clock:?}");
        }
    }

    #[test]
    fn a_lagging_sensor_is_not_called_late_but_sharp() {
        let (t, x, y) = relaxing(0.0);
        let clock = Clock::of(&corners(&t, &x, &lagged(&y, 15.0), 1e-4)).expect("corners");
        assert!(clock.sharp < 0.1, "{clock:?}");
    }

    #[test]
    fn no_motion_has_no_corners() {
        let t: Vec<f64> = (0..2000).map(|k| f64::from(k) * 0.02).collect();
        assert!(corners(&t, &vec![0.1; 2000], &vec![1.0; 2000], 1e-3).is_empty());
        assert!(corners(&t[..10], &[0.0; 10], &[0.0; 10], 1e-3).is_empty());
    }
}
