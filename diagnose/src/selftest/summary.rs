//! Summarises the campaigns of a self-test: detection rate, confusion, coverage, calibration of the confidence, false
//! alarms.

mod flawed;
mod nameless;
mod several;

use std::collections::BTreeMap;

use serde::Serialize;

use super::calibrate::{Calibration, calibrate};
use super::plan::{COMPLETE, SIZES, nearest_size};
use super::statistics::Rate;
use super::trial::{Trial, covers};
use crate::effect::in_struts;
use crate::vocabulary::EffectId;
pub use flawed::Flawed;
use flawed::instruments;
pub use nameless::Nameless;
use nameless::nameless;
pub use several::Several;
use several::{of_all_sizes, several};

/// What became of one term at one size.
#[derive(Debug, Clone, Serialize)]
pub struct Power {
    /// Id of the effect in the vocabulary.
    pub term: EffectId,
    /// Size on the grid nearest to that reached, in units of noise.
    pub size: f64,
    /// Campaigns in which the effect was reported, at any place.
    pub found: Rate,
    /// Reported at its place and no other.
    pub placed: Rate,
    /// Placed, and its size within a fifth or within its interval.
    pub sized: Rate,
    /// Something that is not there reported as well or instead.
    pub false_beside: Rate,
}

/// How often intervals hold the truth.
#[derive(Debug, Clone, Serialize)]
pub struct Coverage {
    /// Id of the effect in the vocabulary.
    pub term: EffectId,
    /// Parameter, its place left out.
    pub key: String,
    /// Bounded intervals that hold it.
    pub covered: Rate,
    /// Intervals of which an end is not determined.
    pub unbounded: usize,
}

/// Reported effects of about one confidence.
#[derive(Debug, Clone, Serialize)]
pub struct Reliability {
    /// Lower end of the range of confidence, 0 to 1.
    pub from: f64,
    /// Upper end of the range of confidence, 0 to 1.
    pub to: f64,
    /// Mean of the reported confidences in this range.
    pub mean: f64,
    /// How many are there, at their place.
    pub there: Rate,
}

/// All tables of a self-test.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// Seed of all draws. The file says it among what every summary begins with.
    #[serde(skip)]
    pub seed: u64,
    /// Number of campaigns.
    pub trials: usize,
    /// Name and reason of trials without a diagnosis.
    pub failed: Vec<(String, String)>,
    /// Complete models with something reported.
    pub false_alarms: Rate,
    /// The same, 95 % interval.
    pub false_alarm_interval: [f64; 2],
    /// By term and size, one effect concealed.
    pub power: Vec<Power>,
    /// Concealed to reported to count; one effect concealed or none.
    pub confusion: BTreeMap<String, BTreeMap<String, usize>>,
    /// Two concealed: exactly those two reported.
    pub pairs_exact: Rate,
    /// Effects that were found in campaigns with two concealed effects.
    pub pairs_found: Rate,
    /// Three concealed: exactly those three reported.
    pub triples_exact: Rate,
    /// Effects that were found in campaigns with three concealed effects.
    pub triples_found: Rate,
    /// The same by number of concealed effects and by size.
    pub several: Vec<Several>,
    /// Coverage of the confidence intervals, by parameter.
    pub coverage: Vec<Coverage>,
    /// Intervals of the sizes (the first number of each effect).
    pub size_coverage: Rate,
    /// Reported confidence against the observed frequency.
    pub reliability: Vec<Reliability>,
    /// Weights of evidence that would make confidence right.
    pub calibration: Option<Calibration>,
    /// Terms left out of the search.
    pub nameless: Vec<Nameless>,
    /// Instruments with flaws.
    pub instruments: Vec<Flawed>,
    /// Unseen recordings of campaigns in which something was found: the model with it is better.
    pub unseen_better: Rate,
}

/// Edges of confidence in the table.
const CONFIDENCE: [f64; 6] = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
/// Said where nothing is reported.
const NOTHING: &str = "(nothing)";

impl Summary {
    /// Makes the tables. Trials without names and with them may be mixed; each table takes what belongs to it.
    #[must_use]
    pub fn of(seed: u64, trials: &[Trial]) -> Self {
        let failed = trials
            .iter()
            .filter_map(|t| t.failed.clone().map(|why| (t.name.clone(), why)))
            .collect();
        let sound: Vec<&Trial> = trials.iter().filter(|t| t.failed.is_none()).collect();
        let named: Vec<&Trial> = sound.iter().copied().filter(|t| t.left_out.is_none()).collect();
        let (mut false_alarms, mut unseen_better) = (Rate::default(), Rate::default());
        for t in &named {
            if t.hidden.is_empty() {
                false_alarms.count(!t.reported.is_empty());
            }
            if t.reported.iter().any(|r| r.gain.is_some()) {
                unseen_better.count(t.unseen.1 < t.unseen.0);
            }
        }
        let (coverage, size_coverage) = coverage(&named);
        let several = several(&named);
        let [pairs, triples] = [2, 3].map(|concealed| of_all_sizes(&several, concealed));
        Self {
            seed,
            trials: trials.len(),
            failed,
            false_alarms,
            false_alarm_interval: false_alarms.interval(),
            power: power(&named),
            confusion: confusion(&named),
            pairs_exact: pairs.exact,
            pairs_found: pairs.found,
            triples_exact: triples.exact,
            triples_found: triples.found,
            several,
            coverage,
            size_coverage,
            reliability: reliability(&named),
            calibration: calibrate(&named),
            nameless: nameless(&sound),
            instruments: instruments(&sound),
            unseen_better,
        }
    }
}

fn power(trials: &[&Trial]) -> Vec<Power> {
    let mut all = Vec::new();
    for term in in_struts() {
        for size in SIZES {
            let mut row = Power {
                term,
                size,
                found: Rate::default(),
                placed: Rate::default(),
                sized: Rate::default(),
                false_beside: Rate::default(),
            };
            for t in trials {
                if t.hidden.len() == 1 && t.hidden[0].0 == term && nearest_size(t.hidden[0].2) == size {
                    row.found.count(t.found(term));
                    row.placed.count(t.placed(term));
                    row.sized.count(t.sized(term));
                    row.false_beside.count(t.reported.iter().any(|r| r.id != term));
                }
            }
            if row.found.of > 0 {
                all.push(row);
            }
        }
    }
    all
}

fn confusion(trials: &[&Trial]) -> BTreeMap<String, BTreeMap<String, usize>> {
    let mut all: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    for t in trials.iter().filter(|t| t.hidden.len() < 2) {
        let row = all
            .entry(t.hidden.first().map_or(COMPLETE, |h| h.0.as_str()).to_owned())
            .or_default();
        let mut ids: Vec<&str> = t.reported.iter().map(|r| r.id.as_str()).collect();
        ids.sort_unstable();
        ids.dedup();
        if ids.is_empty() {
            ids.push(NOTHING);
        }
        for id in ids {
            *row.entry(id.to_owned()).or_default() += 1;
        }
    }
    all
}

fn coverage(trials: &[&Trial]) -> (Vec<Coverage>, Rate) {
    // In the order of the texts, as a reader looks for them.
    let mut all: BTreeMap<(&'static str, String), Coverage> = BTreeMap::new();
    let mut sizes = Rate::default();
    for t in trials {
        for (k, truth) in t.truth.iter().enumerate() {
            let Some(number) = t.estimate(truth) else { continue };
            let key = truth.key.replace("_1_", "_i_").replace("_2_", "_i_");
            let key = key
                .strip_suffix("_1")
                .or(key.strip_suffix("_2"))
                .map_or(key.clone(), |k| format!("{k}_i"));
            let row = all.entry((truth.id.as_str(), key.clone())).or_insert_with(|| Coverage {
                term: truth.id,
                key,
                covered: Rate::default(),
                unbounded: 0,
            });
            match covers(number, truth.value) {
                Some(covered) => {
                    row.covered.count(covered);
                    if k == 0 || t.truth[k - 1].id != truth.id {
                        sizes.count(covered);
                    }
                }
                None => row.unbounded += 1,
            }
        }
    }
    (all.into_values().collect(), sizes)
}

fn reliability(trials: &[&Trial]) -> Vec<Reliability> {
    (CONFIDENCE.windows(2))
        .filter_map(|edges| {
            let last = edges[1] >= 1.0;
            let inside = |c: f64| c >= edges[0] && (c < edges[1] || last);
            let (mut there, mut sum) = (Rate::default(), 0.0);
            for t in trials {
                for r in t.reported.iter().filter(|r| inside(r.confidence)) {
                    there.count(t.there(r));
                    sum += r.confidence;
                }
            }
            (there.of > 0).then(|| Reliability {
                from: edges[0],
                to: edges[1],
                mean: sum / there.of as f64,
                there,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::hidden::Truth;
    use super::super::trial::{Number, Reported};
    use super::*;
    use crate::search::LawPairs;
    use crate::vocabulary::{Branch, Site};

    fn trial(hidden: EffectId, value: f64, reported: EffectId, interval: (f64, f64)) -> Trial {
        let truth = Truth {
            id: hidden,
            place: Site::MainSeal.into(),
            key: "coefficient".into(),
            value,
        };
        Trial {
            name: String::new(),
            hidden: vec![(hidden, 1.0, 1.1)],
            truth: vec![truth],
            left_out: None,
            flaw: None,
            reported: vec![Reported {
                id: reported,
                place: Site::MainSeal.into(),
                label: String::new(),
                confidence: 0.95,
                gain: Some((100.0, 10.0)),
                lead: Some((50.0, 10.0)),
                rival: None,
                ambiguous: false,
                numbers: vec![Number {
                    key: "coefficient".into(),
                    value: 0.5 * (interval.0 + interval.1),
                    low: Some(interval.0),
                    high: Some(interval.1),
                }],
            }],
            said: vec![],
            residuals: 1000,
            noise_ratio: (1.2, 1.0),
            unseen: (1.2, 1.0),
            unseen_floor: 1.0,
            law_pairs: LawPairs::NotTried,
            simulated: 0,
            incomplete: false,
            failed: None,
        }
    }

    #[test]
    fn a_hit_a_wrong_size_and_a_wrong_name_are_told_apart() {
        let term = EffectId::SideLoadFriction;
        let s = Summary::of(
            1,
            &[
                trial(term, 0.02, term, (0.019, 0.022)),
                trial(term, 0.02, term, (0.03, 0.04)),
                trial(term, 0.02, EffectId::SealFriction, (0.0, 1.0)),
            ],
        );
        let row = &s.power[0];
        assert_eq!(
            (row.found.hits, row.placed.hits, row.sized.hits, row.false_beside.hits),
            (2, 2, 1, 1)
        );
        assert_eq!(s.confusion[term.as_str()]["seal_friction"], 1);
        assert_eq!(s.size_coverage, Rate { hits: 1, of: 2 });
        assert_eq!(s.reliability[0].there, Rate { hits: 2, of: 3 });
    }

    #[test]
    fn several_effects_are_counted_each_by_its_size_and_together_by_the_smallest() {
        let (one, two, three) = (EffectId::SideLoadFriction, EffectId::SealFriction, EffectId::BumpStop);
        let with = |hidden: &[(EffectId, f64)], reported: &[EffectId]| {
            let mut t = trial(one, 0.02, one, (0.019, 0.022));
            let (truth, found) = (t.truth[0].clone(), t.reported[0].clone());
            t.hidden = hidden.iter().map(|&(id, size)| (id, size, size)).collect();
            t.truth = (t.hidden.iter())
                .map(|&(id, ..)| Truth { id, ..truth.clone() })
                .collect();
            t.reported = (reported.iter()).map(|&id| Reported { id, ..found.clone() }).collect();
            t
        };
        let s = Summary::of(
            1,
            &[
                with(&[(one, 1.0), (two, 9.0), (three, 11.0)], &[three, two, one]),
                with(&[(one, 1.1), (two, 10.0), (three, 30.0)], &[one, two]),
                with(
                    &[(one, 10.0), (two, 10.0), (three, 10.0)],
                    &[one, two, three, EffectId::Unlisted],
                ),
                with(&[(one, 3.0), (two, 3.0)], &[one, two]),
            ],
        );
        let rate = |hits, of| Rate { hits, of };
        let row = |concealed, size, found, exact| Several {
            concealed,
            size,
            found,
            exact,
        };
        assert_eq!(
            s.several,
            [
                row(2, 3.0, rate(2, 2), rate(1, 1)),
                row(3, 1.0, rate(2, 2), rate(1, 2)),
                row(3, 10.0, rate(6, 6), rate(0, 1)),
                row(3, 30.0, rate(0, 1), rate(0, 0)),
            ]
        );
        assert_eq!((s.pairs_found, s.pairs_exact), (rate(2, 2), rate(1, 1)));
        assert_eq!((s.triples_found, s.triples_exact), (rate(8, 9), rate(1, 3)));
    }

    #[test]
    fn a_law_is_placed_by_the_parts_of_its_place() {
        let first = Site::Accumulator(Branch::First);
        let second = Site::Accumulator(Branch::Second);
        let without = |truly: &[&Site], reported: &[&Site], unseen: f64| {
            let mut t = trial(EffectId::RealGas, 0.02, EffectId::Unlisted, (0.019, 0.022));
            let (truth, found) = (t.truth[0].clone(), t.reported[0].clone());
            let place = |site: &&Site| (*site).clone().into();
            t.left_out = Some(EffectId::RealGas);
            t.truth = (truly.iter())
                .map(|s| Truth {
                    place: place(s),
                    ..truth.clone()
                })
                .collect();
            t.reported = (reported.iter())
                .map(|s| Reported {
                    place: place(s),
                    ..found.clone()
                })
                .collect();
            t.unseen.1 = unseen;
            t
        };
        let placed = |truly: &[&Site], reported: &[&Site]| without(truly, reported, 1.0).law_is_placed();
        let both = &Site::Accumulators;
        assert!(placed(&[both], &[both]) && placed(&[both], &[&first, &second]) && placed(&[&first, &second], &[both]));
        assert!(placed(&[&first, &second], &[&first]) && placed(&[&first], &[&first, &Site::MainSeal]));
        assert!(!placed(&[both], &[&first]) && !placed(&[&first], &[both]) && !placed(&[&first], &[&second]));
        let s = Summary::of(1, &[without(&[both], &[both], 1.19), without(&[both], &[&first], 1.21)]);
        let row = &s.nameless[0];
        assert_eq!((row.placed.hits, row.near_floor.hits, row.near_floor.of), (1, 1, 2));
    }
}
