//! The condition in which a misfit appears: the range of a state in which it concentrates, and the state with which it
//! varies.
//!
//! Two figures, both free of any model of the missing physics. *Region*: of all stretches of a state the one with the
//! largest excess of misfit over samples that begins or ends at an end of the state's range: above a pressure, near zero
//! speed, soon after an edge (the excess is the two-sample Kolmogorov-Smirnov statistic; a stretch in the middle would as
//! often be a constant of the excitation as of the physics). *Following*: the part of the
//! misfit's variance that its mean over a state explains (correlation ratio, eta squared), which also sees what has no
//! region but a sign, as friction has.

use std::ops::Range;

use crate::specimen::StateSeries;
use crate::vocabulary::State;

/// Groups of equal numbers of samples that a state is cut into.
const GROUPS: usize = 48;
/// A region needs this much more of the misfit than of the samples to be called one.
const LEAST_CONCENTRATION: f64 = 0.25;
/// A state is followed if it explains this part of the misfit's variance.
const LEAST_FOLLOWING: f64 = 0.5;

/// The stretch of a state in which the misfit concentrates.
#[derive(Debug, Clone)]
pub struct Region {
    /// State whose range it is.
    pub state: State,
    /// Lower end of the range, in the state's unit.
    pub from: f64,
    /// Upper end of the range, in the state's unit.
    pub to: f64,
    /// Part of the misfit in it.
    pub share_of_misfit: f64,
    /// Part of the samples in it.
    pub share_of_samples: f64,
    /// True if it reaches the smallest, the largest value of the state.
    pub reaches: (bool, bool),
}

/// Region, followed state and both in words.
#[derive(Debug, Clone, Default)]
pub struct Condition {
    /// The condition in words, with its figures.
    pub text: String,
    /// True if it decays while nothing moves.
    pub decays: bool,
    /// Where it concentrates, if it does.
    pub region: Option<Region>,
    /// Which state it follows, and the part of its variance that this explains.
    pub follows: Option<(State, f64)>,
}

impl Condition {
    /// Finds both. `misfit` is squared misfit a sample (negative where the model with the effect is worse), `residual` what
    /// the effect changes in the residual.
    #[must_use]
    pub fn of(states: &[StateSeries], misfit: &[f64], residual: &[f64]) -> Self {
        let mut region: Option<Region> = None;
        let mut follows: Option<(State, f64)> = None;
        for state in states {
            let groups = Groups::of(&state.values);
            let better = |r: &Region| region.as_ref().is_none_or(|b| r.concentration() > b.concentration());
            if let Some(found) = groups.region(state, misfit).filter(better) {
                region = Some(found);
            }
            let eta = groups.following(residual);
            if follows.as_ref().is_none_or(|(_, best)| eta > *best) {
                follows = Some((state.state, eta));
            }
        }
        let region = region.filter(|r| r.concentration() > LEAST_CONCENTRATION);
        let follows = follows.filter(|f| f.1 > LEAST_FOLLOWING);
        let text = match (&region, &follows) {
            (Some(r), Some((state, part))) => format!("{}; {}", r.words(), follow(*state, *part)),
            (Some(r), None) => r.words(),
            (None, Some((state, part))) => format!("over the whole range; {}", follow(*state, *part)),
            (None, None) => "over the whole range of every recorded state".into(),
        };
        Self {
            text,
            decays: false,
            region,
            follows,
        }
    }
}

impl Region {
    /// More of the misfit than of the samples, 0 to 1.
    #[must_use]
    pub fn concentration(&self) -> f64 {
        self.share_of_misfit - self.share_of_samples
    }

    /// "near zero speed, below 4 mm/s: 83 % of the misfit in 12 % of the samples".
    #[must_use]
    pub fn words(&self) -> String {
        let (quantity, unit) = self.state.quantity_and_unit();
        let (from, to) = (shown(self.from, unit), shown(self.to, unit));
        let place = match (self.state, self.reaches) {
            (State::Displacement, (false, true)) if self.to > 0.0 => {
                format!("near the end of travel in jounce, beyond {from}")
            }
            (State::Displacement, (true, false)) if self.from < 0.0 => {
                format!("near the end of travel in rebound, below {to}")
            }
            (State::TimeSinceSwitching, (true, _)) => format!("up to {to} after a switching edge"),
            (State::SpeedMagnitude, (false, true)) => format!("at speeds above {from}"),
            (State::SpeedMagnitude, (true, _)) => format!("near zero speed, up to {to}"),
            (_, (true, true)) => format!("everywhere in {quantity}"),
            (_, (true, false)) => format!("at {quantity} below {to}"),
            (_, (false, true)) => format!("at {quantity} above {from}"),
            _ => format!("at {quantity} from {from} to {to}"),
        };
        format!(
            "{place}: {:.0} % of the misfit in {:.0} % of the samples",
            100.0 * self.share_of_misfit.min(1.0),
            100.0 * self.share_of_samples
        )
    }
}

fn follow(state: State, part: f64) -> String {
    format!(
        "varies with {}, which explains {:.0} % of it",
        state.quantity_and_unit().0,
        100.0 * part
    )
}

/// A value in the unit people use for it.
#[must_use]
pub fn shown(value: f64, unit: &str) -> String {
    let (factor, unit) = match unit {
        "m" => (1e3, "mm"),
        "m/s" if value.abs() < 0.1 => (1e3, "mm/s"),
        "Pa" => (1e-6, "MPa"),
        "s" if value.abs() < 0.5 => (1e3, "ms"),
        other => (1.0, other),
    };
    format!("{} {unit}", oleo_report::significant(value * factor, 2))
}

/// Samples sorted by a state and cut where its value changes, into groups of about equal size.
struct Groups {
    order: Vec<usize>,
    cuts: Vec<Range<usize>>,
}

impl Groups {
    fn of(values: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..values.len()).filter(|&k| values[k].is_finite()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let size = order.len().div_ceil(GROUPS).max(1);
        let mut cuts: Vec<Range<usize>> = Vec::new();
        let mut from = 0;
        while from < order.len() {
            let mut to = (from + size).min(order.len());
            // Equal values belong together: standing still is one state.
            while to < order.len() && values[order[to]] == values[order[to - 1]] {
                to += 1;
            }
            cuts.push(from..to);
            from = to;
        }
        Self { order, cuts }
    }

    fn region(&self, state: &StateSeries, misfit: &[f64]) -> Option<Region> {
        let total: f64 = misfit.iter().sum();
        if total <= 0.0 || self.cuts.len() < 4 {
            return None;
        }
        let share = |c: &Range<usize>| self.order[c.clone()].iter().map(|&k| misfit[k]).sum::<f64>() / total;
        let part = |c: &Range<usize>| c.len() as f64 / misfit.len() as f64;
        let shares: Vec<(f64, f64)> = self.cuts.iter().map(|c| (share(c), part(c))).collect();
        // From the smallest value up, and from every value to the largest.
        let (mut best, mut found, mut sum) = (0.0, 0..0, 0.0);
        for (k, (share, part)) in shares.iter().enumerate() {
            sum += share - part;
            if sum > best {
                (best, found) = (sum, 0..k + 1);
            }
        }
        let mut sum = 0.0;
        for (k, (share, part)) in shares.iter().enumerate().rev() {
            sum += share - part;
            if sum > best {
                (best, found) = (sum, k..shares.len());
            }
        }
        if found.is_empty() {
            return None;
        }
        let samples = self.cuts[found.start].start..self.cuts[found.end - 1].end;
        let at = |k: usize| state.values[self.order[k]];
        Some(Region {
            state: state.state,
            from: at(samples.start),
            to: at(samples.end - 1),
            share_of_misfit: shares[found.clone()].iter().map(|s| s.0).sum(),
            share_of_samples: shares[found.clone()].iter().map(|s| s.1).sum(),
            reaches: (found.start == 0, found.end == self.cuts.len()),
        })
    }

    /// Correlation ratio: variance of the group means over the variance, of all samples (those without the state too).
    fn following(&self, residual: &[f64]) -> f64 {
        let n = residual.len() as f64;
        let mean = residual.iter().sum::<f64>() / n;
        let total: f64 = residual.iter().map(|r| (r - mean) * (r - mean)).sum();
        if total <= 0.0 || self.cuts.len() < 2 {
            return 0.0;
        }
        let between: f64 = (self.cuts.iter())
            .map(|c| {
                let sum: f64 = self.order[c.clone()].iter().map(|&k| residual[k] - mean).sum();
                sum * sum / c.len() as f64
            })
            .sum();
        between / total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine, its speed, and the states a friction or a stop would show over.
    fn stroke() -> (Vec<f64>, Vec<f64>) {
        (0..4000)
            .map(|k| 1e-3 * f64::from(k) * 6.3)
            .map(|t| (0.1 * libm::sin(t), 0.1 * libm::cos(t)))
            .unzip()
    }

    fn states(x: &[f64], v: &[f64]) -> Vec<StateSeries> {
        vec![
            StateSeries::new(State::Displacement, x.to_vec()),
            StateSeries::new(State::Direction, v.iter().map(|v| v.signum()).collect()),
            StateSeries::new(State::SpeedMagnitude, v.iter().map(|v| v.abs()).collect()),
        ]
    }

    fn condition(x: &[f64], v: &[f64], residual: &[f64]) -> Condition {
        let squares: Vec<f64> = residual.iter().map(|r| r * r).collect();
        Condition::of(&states(x, v), &squares, residual)
    }

    #[test]
    fn a_stop_is_found_at_its_end_of_travel() {
        let (x, v) = stroke();
        let residual: Vec<f64> = x.iter().map(|x| (x - 0.07).max(0.0) * 1e4).collect();
        let c = condition(&x, &v, &residual);
        let region = c.region.expect("a region");
        assert!(region.from > 0.068 && region.reaches.1, "{region:?}");
        assert!(c.text.starts_with("near the end of travel in jounce"), "{}", c.text);
    }

    #[test]
    fn friction_has_no_region_but_follows_the_direction() {
        let (x, v) = stroke();
        let residual: Vec<f64> = v.iter().map(|v| 20.0 * v.signum()).collect();
        let c = condition(&x, &v, &residual);
        assert!(c.region.is_none(), "{:?}", c.region);
        assert!(c.text.contains("varies with direction of travel"), "{}", c.text);
        assert!(c.follows.is_some_and(|f| f.1 > 0.99));
    }

    #[test]
    fn a_spike_near_zero_speed_is_found_there() {
        let (x, v) = stroke();
        let residual: Vec<f64> = v.iter().map(|v| 30.0 * libm::exp(-(v * v) / 2.5e-5)).collect();
        let c = condition(&x, &v, &residual);
        assert!(c.text.starts_with("near zero speed, up to"), "{}", c.text);
    }

    #[test]
    fn noise_has_neither() {
        let (x, v) = stroke();
        let residual: Vec<f64> = (0..x.len())
            .map(|k| f64::from((k * 7919 % 101) as u32) - 50.0)
            .collect();
        let c = condition(&x, &v, &residual);
        assert!(c.region.is_none() && c.follows.is_none(), "{c:?}");
    }
}
