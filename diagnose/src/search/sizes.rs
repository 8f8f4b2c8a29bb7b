//! Sizes from which a candidate is started: from one that would show to the largest that is possible.
//!
//! A derivative at size zero says where an effect is only as long as the answer of the recordings is linear in its size. A
//! gross effect is not: the flow of a leak goes with the root of the pressure drop that it removes, and a stop that is hard
//! moves the point at which it seems to begin. Such a candidate is therefore also simulated at sizes a fixed factor apart.

use crate::effect::Candidate;
use crate::parameter::{Parameter, Scale};

/// One starting size over the one before: two a decade. A step from a size that is wrong by half of that converges.
const RATIO: f64 = 3.162_277_660_168_379_5;

/// All values at which a candidate is started with the numbers that are no sizes as in `shape`: one list for each direction in
/// which its sizes can go, the smallest size first. Empty for a candidate without sizes.
pub fn starting_sizes(candidate: &Candidate, shape: &[f64]) -> Vec<Vec<Vec<f64>>> {
    let goes = |direction: f64| {
        let sizes = candidate.parameters.iter().filter(|p| p.is_size);
        sizes.clone().count() > 0 && sizes.clone().all(|p| most(p, direction) > 0.0)
    };
    [1.0, -1.0]
        .into_iter()
        .filter(|direction| goes(*direction))
        .map(|direction| ladder(candidate, shape, direction))
        .collect()
}

fn ladder(candidate: &Candidate, shape: &[f64], direction: f64) -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    let mut factor = 1.0;
    loop {
        let at = |(p, value): (&Parameter, &f64)| match p.scale {
            Scale::Linear(visible) if p.is_size => direction * (factor * visible).min(most(p, direction)),
            _ => *value,
        };
        let values: Vec<f64> = candidate.parameters.iter().zip(shape).map(at).collect();
        // Beyond the largest size of all its numbers nothing changes any more.
        if all.last() == Some(&values) {
            return all;
        }
        all.push(values);
        factor *= RATIO;
    }
}

/// Largest size in a direction, not negative.
fn most(parameter: &Parameter, direction: f64) -> f64 {
    if direction > 0.0 {
        parameter.upper
    } else {
        -parameter.lower
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vocabulary::{EffectId, Site};

    fn candidate(parameters: Vec<Parameter>) -> Candidate {
        Candidate::new(EffectId::BumpStop, Site::EndStop, parameters)
    }

    #[test]
    fn sizes_go_from_what_shows_to_the_largest_and_the_shape_stays() {
        let stop = candidate(vec![
            Parameter::linear("clearance_m", 0.06, 0.005, (0.01, 0.1)),
            Parameter::amount("stiffness_N_m", 1e4, 1e6),
            Parameter::amount("progression_N_m3", 1e8, 1e9),
        ]);
        let all = starting_sizes(&stop, &[0.05, 0.0, 0.0]);
        assert_eq!(all.len(), 1, "a stop does not pull");
        let [up] = &all[..] else { return };
        assert!(up.iter().all(|v| v[0] == 0.05));
        assert_eq!((up[0][1], up[0][2]), (1e4, 1e8));
        assert!((up[1][1] / 10f64.sqrt() - 1e4).abs() < 1e-6);
        assert_eq!((up[4][1].round(), up[4][2]), (1e6, 1e9));
        assert!((5..=6).contains(&up.len()));
    }

    #[test]
    fn a_departure_goes_both_ways_as_far_as_each_goes() {
        let charge = candidate(vec![Parameter::departure("relative_error", 0.02, (-0.7, 2.0))]);
        let all = starting_sizes(&charge, &[0.0]);
        let last = |k: usize| all[k].last().and_then(|v| v.first()).copied();
        assert_eq!((all.len(), last(0), last(1)), (2, Some(2.0), Some(-0.7)));
        assert_eq!(all[1][0], [-0.02]);
    }

    #[test]
    fn what_has_no_size_has_no_starting_sizes() {
        let heat = candidate(vec![Parameter::log("time_constant_s", 5.0, (0.1, 100.0))]);
        assert!(starting_sizes(&heat, &[5.0]).is_empty());
        assert!(starting_sizes(&candidate(vec![]), &[]).is_empty());
    }
}
