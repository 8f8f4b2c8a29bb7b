//! Spikes: single readings that are far off while their neighbours are not.
//!
//! What a specimen does shows in the neighbours too, or in another column at the same time. A reading is a spike only if a
//! parabola through the three readings on either side, which lie on it to within the noise, misses it by far.

use super::differences::REACH;
use crate::recording::Recording;

/// Readings on either side.
const BESIDE: usize = 3;
/// A spike is off by this many standard deviations of the noise, and by this many times what its neighbours miss the parabola by: at a
/// kink, which a specimen makes too, that is five times.
const FAR: f64 = 8.0;
/// Readings beside it lie on the parabola to within this many.
const NEAR: f64 = 2.5;
/// A reading of another column is off at the same time if it misses its own parabola by this many.
const ALSO: f64 = 3.0;
/// Of the spikes of a column this part may coincide with what other columns show, by chance; above it they are not the instrument's.
const BY_CHANCE: f64 = 0.5;
/// Passes: a spike near another is seen when that one is gone.
const PASSES: usize = 3;
/// A column with a larger part of far readings has no spikes but something else.
const LARGEST_PART: f64 = 0.02;

/// Samples of the spikes in each of the first columns of a recording.
pub fn spikes(recording: &Recording, columns: usize, deviation: &dyn Fn(usize, usize) -> f64) -> Vec<Vec<usize>> {
    let mut kept: Vec<Vec<f64>> = recording.columns[..columns].to_vec();
    let mut found: Vec<Vec<usize>> = vec![vec![]; columns];
    for _ in 0..PASSES {
        let far: Vec<Vec<usize>> = (kept.iter().enumerate())
            .map(|(c, series)| off(series, &|k| deviation(c, k), FAR))
            .collect();
        if far.iter().all(Vec::is_empty) {
            break;
        }
        for ((own, series), all) in far.into_iter().zip(&mut kept).zip(&mut found) {
            own.iter().for_each(|&k| series[k] = f64::NAN);
            all.extend(own);
        }
    }
    for own in &mut found {
        own.sort_unstable();
    }
    (0..columns)
        .map(|c| {
            let own = &found[c];
            let elsewhere = own.iter().filter(|&&k| {
                (0..columns)
                    .any(|other| other != c && misses(&recording.columns[other], k) > ALSO * deviation(other, k))
            });
            let too_many = own.len() as f64 > LARGEST_PART * recording.len() as f64;
            let physical = elsewhere.count() as f64 > BY_CHANCE * own.len() as f64;
            if too_many || physical { vec![] } else { own.clone() }
        })
        .collect()
}

/// Samples that are off, with neighbours that are not.
fn off(series: &[f64], deviation: &dyn Fn(usize) -> f64, far: f64) -> Vec<usize> {
    let last = series.len().saturating_sub(BESIDE);
    (BESIDE..last)
        .filter(|&k| is_off(series, k, deviation(k), far))
        .collect()
}

fn is_off(series: &[f64], k: usize, deviation: f64, far: f64) -> bool {
    if k < BESIDE || k + BESIDE >= series.len() || !series[k].is_finite() {
        return false;
    }
    // Cheap first: most readings are next to the mean of their neighbours.
    let chord = series[k] - 0.5 * (series[k - 1] + series[k + 1]);
    if chord.abs() < 0.5 * far * deviation {
        return false;
    }
    let mut beside: Vec<(f64, f64)> = (1..=BESIDE)
        .flat_map(|i| [(-(i as f64), series[k - i]), (i as f64, series[k + i])])
        .filter(|(_, y)| y.is_finite())
        .collect();
    if beside.len() < REACH {
        return false;
    }
    let Some((mut middle, mut rms, worst)) = parabola(&beside) else {
        return false;
    };
    if rms > NEAR * deviation && beside.len() > REACH {
        // One of the neighbours may be a spike itself.
        beside.remove(worst);
        let Some(again) = parabola(&beside) else { return false };
        (middle, rms, _) = again;
    }
    rms <= NEAR * deviation && (series[k] - middle).abs() > far * deviation.max(rms)
}

/// By how much a reading misses the parabola through its neighbours, whatever these do; 0 if there is none.
fn misses(series: &[f64], k: usize) -> f64 {
    if k < BESIDE || k + BESIDE >= series.len() || !series[k].is_finite() {
        return 0.0;
    }
    let beside: Vec<(f64, f64)> = (1..=BESIDE)
        .flat_map(|i| [(-(i as f64), series[k - i]), (i as f64, series[k + i])])
        .filter(|(_, y)| y.is_finite())
        .collect();
    parabola(&beside).map_or(0.0, |(middle, ..)| (series[k] - middle).abs())
}

/// Parabola through points about zero: its value there, RMS of the points about it by degrees of freedom, and the worst point.
fn parabola(points: &[(f64, f64)]) -> Option<(f64, f64, usize)> {
    let mean = points.iter().map(|p| p.1).sum::<f64>() / points.len() as f64;
    let mut h = nalgebra::Matrix3::zeros();
    let mut g = nalgebra::Vector3::zeros();
    for &(x, y) in points {
        let row = nalgebra::Vector3::new(1.0, x, x * x);
        h += row * row.transpose();
        g += row * (y - mean);
    }
    let c = h.cholesky()?.solve(&g);
    let residual = |&(x, y): &(f64, f64)| y - mean - c[0] - c[1] * x - c[2] * x * x;
    let squares: f64 = points.iter().map(|p| residual(p) * residual(p)).sum();
    let worst = (0..points.len()).max_by(|&a, &b| residual(&points[a]).abs().total_cmp(&residual(&points[b]).abs()))?;
    let freedom = points.len().saturating_sub(3).max(1) as f64;
    Some((mean + c[0], (squares / freedom).sqrt(), worst))
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
        spikes(&recording(0.002, columns), n, &|_, _| 1.0)
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
    fn steps_corners_and_pulses_of_a_specimen_are_no_spikes() {
        let white = noise(3, 2000, 0.0);
        let with =
            |add: &dyn Fn(usize) -> f64| -> Vec<f64> { white.iter().enumerate().map(|(k, v)| v + add(k)).collect() };
        let step = with(&|k| if k >= 800 { 300.0 } else { 0.0 });
        let corner = with(&|k| 40.0 * (k as f64 - 1000.0).abs());
        let pulse = with(&|k| if (700..703).contains(&k) { 60.0 } else { 0.0 });
        assert_eq!(found(vec![step, corner, pulse]), vec![Vec::<usize>::new(); 3]);
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
