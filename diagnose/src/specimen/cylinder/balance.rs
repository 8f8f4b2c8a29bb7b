//! The force balance of a cylinder read off as measured, before any model of friction: what the load cell shows beyond
//! the pressures on their areas, moving in, moving out and at rest, at low and at high pressure, and when.

use oleo_plant_sim::specimen::CylinderModel;

use crate::excitation::pressing;
use crate::median::median;
use crate::recording::Recording;

/// Slower than this part of the fastest is rest, faster than three times that is motion.
const REST: f64 = 0.01;
/// Pressing forces of one recording differ enough to be compared from this part of their mean.
const VARIES: f64 = 0.3;
/// Fewest samples that a median is taken of.
const LEAST_SAMPLES: usize = 20;
/// Longest delay looked for, in samples.
const MOST_DELAY: usize = 25;
/// Correlation of changes below which nothing is said of delays.
const LEAST_CORRELATION: f64 = 0.7;

/// What one recording shows: the balance, and the delay of the force where the changes tell one.
#[must_use]
pub fn remarks(model: &CylinderModel, recording: &Recording, speed: &[f64]) -> Vec<String> {
    let n = recording.len();
    let pressing = pressing(model, recording);
    let mut net = vec![0.0; n];
    for (chamber, p) in model.chamber.iter().zip(&recording.columns[2..]) {
        net.iter_mut().zip(p).for_each(|(sum, p)| *sum += chamber.area_m2 * p);
    }
    let force = &recording.columns[1];
    let fastest = speed.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    let (low, high) = (pressing.iter()).fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
    let half_way = 0.5 * (low + high);
    let beyond = |wanted: &dyn Fn(usize) -> bool| {
        let values: Vec<f64> = (0..n).filter(|&k| wanted(k)).map(|k| force[k] - net[k]).collect();
        (values.len() >= LEAST_SAMPLES).then(|| median(values))
    };
    let moving = |k: usize, sign: f64| speed[k] * sign > 3.0 * REST * fastest;
    let mut out = Vec::new();
    if let (Some(inward), Some(outward)) = (beyond(&|k| moving(k, 1.0)), beyond(&|k| moving(k, -1.0))) {
        let width = |high: bool| {
            let side = |sign| beyond(&|k: usize| moving(k, sign) && (pressing[k] > half_way) == high);
            Some(0.5 * (side(1.0)? - side(-1.0)?))
        };
        let mean = pressing.iter().sum::<f64>() / n as f64;
        let growth = match (width(false), width(true)) {
            (Some(below), Some(above)) if high - low > VARIES * mean => {
                format!(" ({below:.2} N below {half_way:.0} N, {above:.2} N above)")
            }
            _ => String::new(),
        };
        let half = 0.5 * (inward - outward);
        let rest = beyond(&|k| speed[k].abs() < REST * fastest)
            .map_or(String::new(), |rest| format!(", {rest:+.2} N at rest"));
        out.push(format!(
            "{}: the median of force_N minus the pressure forces is {inward:+.2} N moving in and {outward:+.2} N moving out{rest}; \
             half the difference is {half:.2} N at a mean pressing force of {mean:.0} N{growth}",
            recording.name
        ));
    }
    if let Some((delay, correlation)) = delay(force, &net) {
        out.push(format!(
            "{}: changes of force_N follow those of the pressures after {:.1} ms (correlation {correlation:.2})",
            recording.name,
            1e3 * delay * recording.interval_s()
        ));
    }
    out
}

/// Delay in samples, between samples by a parabola, at which changes correlate best, and that correlation.
fn delay(late: &[f64], early: &[f64]) -> Option<(f64, f64)> {
    let changes = |s: &[f64]| s.windows(2).map(|w| w[1] - w[0]).collect::<Vec<f64>>();
    let (a, b) = (changes(late), changes(early));
    if a.len() < 20 * MOST_DELAY {
        return None;
    }
    let stretch = MOST_DELAY..a.len() - MOST_DELAY;
    let correlation = |shift: isize| {
        let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
        for k in stretch.clone() {
            let (x, y) = (a[k], b[(k as isize - shift) as usize]);
            ab += x * y;
            aa += x * x;
            bb += y * y;
        }
        ab / (aa * bb).sqrt().max(1e-300)
    };
    let most = MOST_DELAY as isize;
    let best = (-most..=most).max_by(|&x, &y| correlation(x).total_cmp(&correlation(y)))?;
    let at = correlation(best);
    if at < LEAST_CORRELATION || best.abs() == most {
        return None;
    }
    let (before, after) = (correlation(best - 1), correlation(best + 1));
    let vertex = 0.5 * (before - after) / (before - 2.0 * at + after).min(-1e-12);
    Some((best as f64 + vertex.clamp(-0.5, 0.5), at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_plant_sim::specimen::smooth_motion;

    #[test]
    fn delay_between_samples() {
        let f = |t: f64| libm::sin(0.05 * t) + 0.5 * libm::sin(0.31 * t);
        let early: Vec<f64> = (0..3000).map(|k| f(f64::from(k))).collect();
        let late: Vec<f64> = (0..3000).map(|k| f(f64::from(k) - 2.3)).collect();
        let (delay, correlation) = delay(&late, &early).expect("clear");
        assert!((delay - 2.3).abs() < 0.1 && correlation > 0.99, "{delay} {correlation}");
        assert!(super::delay(&vec![0.0; 3000], &early).is_none());
    }

    #[test]
    fn friction_shows_as_half_the_difference() {
        let model = CylinderModel::from_toml(
            "[specimen]\nname='a'\nkind='cylinder'\n[[chamber]]\ncolumn='p_Pa'\narea_m2=0.001\n",
            "test",
        )
        .expect("valid");
        let time_s: Vec<f64> = (0..4000).map(|k| f64::from(k) * 0.01).collect();
        let x: Vec<f64> = time_s.iter().map(|t| 0.02 * libm::sin(*t)).collect();
        let p: Vec<f64> = time_s.iter().map(|t| if *t < 20.0 { 1e5 } else { 3e5 }).collect();
        let force = (time_s.iter().zip(&p))
            .map(|(t, p)| p * 1e-3 + libm::cos(*t).signum() * p * 1e-4)
            .collect();
        let recording = Recording {
            name: "r".into(),
            time_s,
            columns: vec![x, force, p],
            notes: vec![],
        };
        let speed = smooth_motion(&recording.time_s, &recording.columns[0], 0.05).speed_m_s;
        let lines = remarks(&model, &recording, &speed);
        assert!(lines[0].contains("(10.00 N below 200 N, 30.00 N above)"), "{lines:?}");
    }
}
