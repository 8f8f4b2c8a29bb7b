//! Spikes: single readings that are far off while their neighbours are not.
//!
//! What a specimen does shows in the neighbours too, or in another column at the same time. A reading is a spike only if a
//! curve through the readings beside it, which lie on it to within the noise, misses it by far. At an end of a recording these
//! are readings of one side, mostly or all.

use nalgebra::{DMatrix, DVector};

use crate::recording::Recording;

/// Readings beside it lie on a curve to within this many.
const NEAR: f64 = 2.5;
/// A reading of another column is off at the same time if it misses its own parabola by this many.
const ALSO: f64 = 3.0;
/// Of the spikes of a column this part may coincide with what other columns show, by chance; above it these are not the instrument's, and among pulses
/// none of the others is known to be.
const BY_CHANCE: f64 = 0.5;
/// Passes: a spike near another is seen when that one is gone.
const PASSES: usize = 3;
/// A column with a larger part of far readings has no spikes but something else.
const LARGEST_PART: f64 = 0.02;

/// A spike: its sample, and what the neighbours say of the reading there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spike {
    /// Index of the sample.
    pub sample: usize,
    /// Value of the curve through the neighbours.
    pub instead: f64,
}

/// How a column goes from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Course {
    /// As a force or a pressure does, with pulses when valves switch.
    WithPulses,
    /// As what a model leaves of it.
    Smooth,
}

/// The spikes in each of the first columns of recordings, by recording and column. The first is the motion of an actuator, which is
/// smooth; `others` says what the others are. `deviation` is the noise of a sample, by recording,
/// column and sample.
pub fn spikes(
    recordings: &[Recording],
    columns: usize,
    others: Course,
    deviation: &dyn Fn(usize, usize, usize) -> f64,
) -> Vec<Vec<Vec<Spike>>> {
    let mut found: Vec<Vec<Vec<Spike>>> = (recordings.iter().enumerate())
        .map(|(r, recording)| far_readings(recording, columns, others, &|c, k| deviation(r, c, k)))
        .collect();
    let samples: usize = recordings.iter().map(Recording::len).sum();
    for c in 0..columns {
        keep_how_recordings_begin_and_end(&mut found, c, recordings);
        let own: Vec<Vec<Spike>> = (recordings.iter().enumerate())
            .map(|(r, recording)| {
                let also =
                    |k: usize, other: usize| misses(&recording.columns[other], k) > ALSO * deviation(r, other, k);
                let is_elsewhere = |spike: &Spike| (0..columns).any(|other| other != c && also(spike.sample, other));
                found[r][c]
                    .iter()
                    .copied()
                    .filter(|spike| !is_elsewhere(spike))
                    .collect()
            })
            .collect();
        let all: usize = found.iter().map(|of| of[c].len()).sum();
        let elsewhere = all - own.iter().map(Vec::len).sum::<usize>();
        let too_many = all as f64 > LARGEST_PART * samples as f64;
        let shared = elsewhere as f64 > BY_CHANCE * all as f64;
        for (of, own) in found.iter_mut().zip(own) {
            if too_many || (shared && others == Course::WithPulses) {
                of[c].clear();
            } else if shared {
                of[c] = own;
            }
        }
    }
    found
}

/// Ends of a column that look like spikes in half of the recordings are how these begin or end: with a motion that sets in at the second sample, for example.
fn keep_how_recordings_begin_and_end(found: &mut [Vec<Vec<Spike>>], column: usize, recordings: &[Recording]) {
    type End = fn(&Recording) -> usize;
    let ends: [End; 2] = [|_| 0, |recording| recording.len() - 1];
    for end in ends {
        let is_end = |spike: &Spike, r: usize| spike.sample == end(&recordings[r]);
        let off = (found.iter().enumerate()).filter(|(r, of)| of[column].iter().any(|spike| is_end(spike, *r)));
        if 2 * off.count() >= recordings.len() {
            for (r, of) in found.iter_mut().enumerate() {
                of[column].retain(|spike| !is_end(spike, r));
            }
        }
    }
}

/// What looks like spikes in each column of a recording.
fn far_readings(
    recording: &Recording,
    columns: usize,
    others: Course,
    deviation: &dyn Fn(usize, usize) -> f64,
) -> Vec<Vec<Spike>> {
    let mut kept: Vec<Vec<f64>> = recording.columns[..columns].to_vec();
    let mut found: Vec<Vec<Spike>> = vec![vec![]; columns];
    for _ in 0..PASSES {
        let far: Vec<Vec<Spike>> = (kept.iter().enumerate())
            .map(|(c, series)| {
                let curves: &[Curve] = match (c, others) {
                    (0, _) => &[PARABOLA, QUARTIC],
                    (_, Course::WithPulses) => &[BEYOND_PULSES],
                    (_, Course::Smooth) => &[PARABOLA],
                };
                off(series, curves, &|k| deviation(c, k))
            })
            .collect();
        if far.iter().all(Vec::is_empty) {
            break;
        }
        for ((own, series), all) in far.into_iter().zip(&mut kept).zip(&mut found) {
            own.iter().for_each(|spike| series[spike.sample] = f64::NAN);
            all.extend(own);
        }
    }
    for own in &mut found {
        own.sort_unstable_by_key(|spike| spike.sample);
    }
    found
}

/// Samples that are off, with neighbours that are not.
fn off(series: &[f64], curves: &[Curve], deviation: &dyn Fn(usize) -> f64) -> Vec<Spike> {
    let find = |k: usize| curves.iter().find_map(|curve| spike(series, k, curve, deviation(k)));
    (0..series.len()).filter_map(find).collect()
}

fn spike(series: &[f64], k: usize, curve: &Curve, deviation: f64) -> Option<Spike> {
    let mut beside = curve.neighbours(series, k)?;
    let last = series.len() - 1;
    // Cheap first: most readings are next to the mean of their neighbours, and an end to the line through the next two.
    let (by_a_line, wider) = match k {
        0 => (2.0 * series[1] - series[2], AT_END),
        _ if k == last => (2.0 * series[k - 1] - series[k - 2], AT_END),
        _ => (0.5 * (series[k - 1] + series[k + 1]), 1.0),
    };
    let far = wider * curve.far * deviation;
    if series[k].is_nan() || (series[k] - by_a_line).abs() < 0.5 * far {
        return None;
    }
    let least = 2 * curve.beside - 1;
    let (mut instead, mut rms, worst) = curve.through(&beside)?;
    if rms > NEAR * deviation && beside.len() > least {
        // One of the neighbours may be a spike itself.
        beside.remove(worst);
        (instead, rms, _) = curve.through(&beside)?;
    }
    let far = far.max(wider * curve.beyond_kink * rms);
    let is_far = beside.len() >= least && rms <= NEAR * deviation && (series[k] - instead).abs() > far;
    is_far.then_some(Spike { sample: k, instead })
}

/// By how much a reading misses the parabola through its neighbours, whatever these do; 0 if there is none.
fn misses(series: &[f64], k: usize) -> f64 {
    let beside = PARABOLA.neighbours(series, k);
    let through = beside.and_then(|beside| PARABOLA.through(&beside));
    through.map_or(0.0, |(instead, ..)| (series[k] - instead).abs())
}

/// The first and the last reading are a spike if they are off by this many times what another one must be: they are extrapolated, with 1.7 times
/// the noise, and a kink beside them makes them miss by 14.3 times what the others do.
const AT_END: f64 = 2.0;

/// A polynomial through the readings beside a sample.
struct Curve {
    /// Readings on either side; near an end as many in all.
    beside: usize,
    /// Whether it holds near an end, where most readings are on one side.
    at_ends: bool,
    degree: usize,
    /// A spike is off by this many standard deviations of the noise ...
    far: f64,
    /// ... and by this many times what the neighbours miss the curve by: more than a kink makes, which a specimen has too.
    beyond_kink: f64,
}

/// At a kink the middle is off by 5.2 times the miss of the others, and the second and third reading by 3.5 times.
const PARABOLA: Curve = Curve {
    beside: 3,
    at_ends: true,
    degree: 2,
    far: 8.0,
    beyond_kink: 8.0,
};
/// The same among the pulses of a pressure, a few samples long, of which some look like spikes.
const BEYOND_PULSES: Curve = Curve {
    far: 10.0,
    beyond_kink: 12.0,
    ..PARABOLA
};
/// Follows a motion that begins. At a kink the middle is off by 8.0 times the miss of the others.
const QUARTIC: Curve = Curve {
    beside: 4,
    at_ends: false,
    degree: 4,
    far: 8.0,
    beyond_kink: 12.0,
};

impl Curve {
    /// Readings beside a sample, with their distances from it; `None` where there are too few.
    fn neighbours(&self, series: &[f64], k: usize) -> Option<Vec<(f64, f64)>> {
        let first = k
            .saturating_sub(self.beside)
            .min(series.len().checked_sub(2 * self.beside + 1)?);
        if first + self.beside != k && !self.at_ends {
            return None;
        }
        let window = (first..=first + 2 * self.beside).filter(|&i| i != k && series[i].is_finite());
        Some(window.map(|i| (i as f64 - k as f64, series[i])).collect())
    }

    /// The curve through points about zero: its value there, RMS of what the points miss it by, and the one without which they miss it least. That need
    /// not be the one that misses most, because the curve follows its ends.
    fn through(&self, points: &[(f64, f64)]) -> Option<(f64, f64, usize)> {
        let mean = points.iter().map(|p| p.1).sum::<f64>() / points.len() as f64;
        let terms = self.degree + 1;
        let power = |x: f64, term: usize| (0..term).fold(1.0, |p, _| p * x / self.beside as f64);
        let rows = DMatrix::from_fn(points.len(), terms, |i, term| power(points[i].0, term));
        let values = DVector::from_iterator(points.len(), points.iter().map(|p| p.1 - mean));
        let normal = (rows.transpose() * &rows).cholesky()?;
        let c = normal.solve(&(rows.transpose() * &values));
        let missed = values - &rows * &c;
        let freedom = points.len().saturating_sub(terms).max(1) as f64;
        // Sum of squares that goes with a point: Belsley, Kuh & Welsch, Regression Diagnostics, Wiley 1980, section 2.1.
        let goes_with = |i: usize| {
            let row = rows.row(i).transpose();
            missed[i] * missed[i] / (1.0 - row.dot(&normal.solve(&row))).max(f64::EPSILON)
        };
        let worst = (0..points.len()).max_by(|&a, &b| goes_with(a).total_cmp(&goes_with(b)))?;
        Some((mean + c[0], (missed.norm_squared() / freedom).sqrt(), worst))
    }
}

/// Puts a straight line where readings are missing. The ends repeat the nearest reading.
pub fn bridge(series: &mut [f64]) {
    let known: Vec<usize> = (0..series.len()).filter(|&k| series[k].is_finite()).collect();
    for k in 0..series.len() {
        if series[k].is_finite() {
            continue;
        }
        let after = known.partition_point(|&i| i < k);
        series[k] = match (after.checked_sub(1).map(|i| known[i]), known.get(after)) {
            (Some(a), Some(&b)) => series[a] + (series[b] - series[a]) * (k - a) as f64 / (b - a) as f64,
            (Some(a), None) => series[a],
            (None, Some(&b)) => series[b],
            (None, None) => return,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::noise::tests::{noise, recording};

    fn found(columns: Vec<Vec<f64>>) -> Vec<Vec<usize>> {
        let n = columns.len();
        let found = spikes(&[recording(0.002, columns)], n, Course::Smooth, &|_, _, _| 1.0).remove(0);
        found
            .iter()
            .map(|own| own.iter().map(|spike| spike.sample).collect())
            .collect()
    }

    #[test]
    fn a_spike_is_found_also_beside_another() {
        let mut series = noise(1, 2000, 0.0);
        for (k, size) in [(300, 15.0), (900, -40.0), (902, 30.0), (1500, 9.5)] {
            series[k] += size;
        }
        assert_eq!(
            found(vec![series, noise(2, 2000, 0.0)]),
            [vec![300, 900, 902, 1500], vec![]]
        );
    }

    #[test]
    fn a_spike_is_found_also_where_a_larger_one_is_the_last_that_is_seen_beside_it() {
        let mut series = noise(1, 2000, 0.0);
        for (k, size) in [(900, -23.0), (903, 57.0)] {
            series[k] += size;
        }
        assert_eq!(found(vec![series, noise(2, 2000, 0.0)]), [vec![900, 903], vec![]]);
    }

    #[test]
    fn of_what_a_model_leaves_spikes_that_no_other_column_shows_are_the_instruments() {
        let with = |seed, off: &[usize]| {
            let mut series = noise(seed, 2000, 0.0);
            off.iter().for_each(|&k| series[k] += 30.0);
            series
        };
        let columns = || vec![noise(8, 2000, 0.0), with(1, &[300, 700, 1100]), with(2, &[300, 700])];
        let of = |others| spikes(&[recording(0.002, columns())], 3, others, &|_, _, _| 1.0).remove(0);
        let samples = |own: &[Spike]| own.iter().map(|spike| spike.sample).collect::<Vec<_>>();
        let left = of(Course::Smooth);
        assert_eq!((samples(&left[1]), samples(&left[2])), (vec![1100], vec![]));
        assert!(of(Course::WithPulses)[1].is_empty());
    }

    #[test]
    fn a_spike_is_found_also_at_the_ends_of_a_recording() {
        let clean = |seed| -> Vec<f64> {
            let moving = |k: usize| 5000.0 * libm::sin(0.02 * k as f64);
            noise(seed, 2000, 0.0)
                .iter()
                .enumerate()
                .map(|(k, v)| v + moving(k))
                .collect()
        };
        let mut series = clean(4);
        assert_eq!(found(vec![series.clone(), clean(5)]), vec![Vec::<usize>::new(); 2]);
        for k in [2, 1998] {
            series[k] += 25.0;
        }
        assert_eq!(found(vec![series, clean(6)]), [vec![2, 1998], vec![]]);
        for k in [0, 1, 1997, 1998, 1999] {
            let mut series = clean(7 + k as u64);
            series[k] -= 25.0;
            let of_all = |off: &dyn Fn(usize) -> Vec<f64>| {
                let recordings: Vec<Recording> = (0..3).map(|r| recording(0.002, vec![off(r)])).collect();
                spikes(&recordings, 1, Course::Smooth, &|_, _, _| 1.0)
            };
            let one = of_all(&|r| if r == 1 { series.clone() } else { clean(5) });
            assert_eq!(one[1][0].iter().map(|spike| spike.sample).collect::<Vec<_>>(), [k]);
            assert!(one[0][0].is_empty() && one[2][0].is_empty());
            // What all recordings do at their ends is no fault.
            let is_end = k == 0 || k == 1999;
            let all = of_all(&|_| series.clone());
            assert!(all.iter().all(|of| of[0].is_empty() == is_end), "{k}");
        }
    }

    #[test]
    fn steps_corners_and_pulses_of_a_specimen_are_no_spikes() {
        let white = noise(3, 2000, 0.0);
        let with =
            |add: &dyn Fn(usize) -> f64| -> Vec<f64> { white.iter().enumerate().map(|(k, v)| v + add(k)).collect() };
        let step = with(&|k| if k >= 800 { 300.0 } else { 0.0 });
        let corner = with(&|k| 40.0 * (k as f64 - 1000.0).abs());
        let pulse = with(&|k| if (700..703).contains(&k) { 60.0 } else { 0.0 });
        assert_eq!(found(vec![step, corner, pulse]), vec![Vec::<usize>::new(); 3]);
        let beside_the_ends = with(&|k| 40.0 * k.clamp(2, 1997) as f64);
        assert_eq!(found(vec![beside_the_ends]), [Vec::<usize>::new()]);
        // One reading off in two columns at once.
        let both = with(&|k| if k == 600 { 50.0 } else { 0.0 });
        assert_eq!(found(vec![both.clone(), both]), vec![Vec::<usize>::new(); 2]);
    }

    #[test]
    fn what_is_missing_is_bridged() {
        let mut series = [f64::NAN, 1.0, f64::NAN, f64::NAN, 4.0, f64::NAN];
        bridge(&mut series);
        assert_eq!(series, [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
    }
}
