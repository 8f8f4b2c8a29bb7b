//! Which campaigns a self-test is made of, in which order: every term at every size, complete models, and pairs, dealt out
//! in rounds, so that the first hundred are already a fair sample of the first thousand.

use std::ops::Range;
use std::str::FromStr;

use oleo_plant_sim::model_file::names::suggestion;

use super::draw::Draw;
use super::flaw::Flaw;
use crate::effect::in_struts;
use crate::effect::unlisted::{
    pairs_of_variants, periodic_variants, unfamiliar_variants, variants_of_believed_numbers,
};
use crate::vocabulary::EffectId;

/// Sizes asked for, in units of noise (RMS over all channels and samples, after recalibration).
pub const SIZES: [f64; 8] = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0];
/// Sizes with which terms are left out of the search: large enough that something must be said.
const NAMELESS_SIZES: [f64; 2] = [3.0, 10.0];
/// Complete models in a round, where false alarms are counted.
const COMPLETE_PER_ROUND: usize = 8;
/// Campaigns with two effects in a round.
const PAIRS_PER_ROUND: usize = 4;
/// Campaigns with three effects in a round.
const TRIPLES_PER_ROUND: usize = 4;
/// Name of a campaign in which nothing is concealed.
pub const COMPLETE: &str = "none";
/// Name of a campaign in which two effects are.
pub const PAIR: &str = "pair";
/// Name of a campaign in which three effects are.
pub const TRIPLE: &str = "triple";

/// Name of a campaign in which a law that swings in time is.
pub const PERIODIC: &str = "periodic";
/// Its sizes: faint, middling, gross.
const PERIODIC_SIZES: [f64; 3] = [1.0, 5.0, 30.0];

/// Name of a campaign in which two laws without a name are, at different places.
pub const TWO_LAWS: &str = "two_laws";
/// Sizes of each: large enough that something must be said.
const TWO_LAWS_SIZES: [f64; 3] = [3.0, 10.0, 30.0];
/// Campaigns with two laws in a round.
const TWO_LAWS_PER_ROUND: usize = 6;

/// Name of a campaign in which a number of the model is another than believed.
pub const WRONG_NUMBER: &str = "wrong_number";
/// Its sizes.
const WRONG_NUMBER_SIZES: [f64; 3] = [1.0, 5.0, 30.0];

/// Name of a campaign in which a law is whose shape no textbook has.
pub const UNFAMILIAR: &str = "unfamiliar";
/// Its sizes: large enough that something must be said.
const UNFAMILIAR_SIZES: [f64; 3] = [2.0, 10.0, 60.0];

/// What a self-test is to do.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Seed of all draws.
    pub seed: u64,
    /// Number of campaigns.
    pub campaigns: usize,
    /// What to conceal; everything where the list is empty.
    pub subjects: Vec<Subject>,
    /// Leave each concealed term out of the search: what is found must be `unlisted`.
    pub without_names: bool,
    /// Flaws of the instruments, dealt out to the campaigns in turn; none if the list is empty.
    pub flaws: Vec<Flaw>,
}

/// One campaign to make and diagnose.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Its name, which fixes everything drawn in it.
    pub name: String,
    /// Concealed effects and the sizes that they should have, in units of noise.
    pub hidden: Vec<(EffectId, f64)>,
    /// Variants of the concealed effects, in their order; empty where they are drawn.
    pub variants: Vec<usize>,
    /// Term that the search may not use.
    pub left_out: Option<EffectId>,
    /// What is wrong with the instruments.
    pub flaw: Option<Flaw>,
}

/// What is concealed in a campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// One concealed effect.
    Effect(EffectId),
    /// No concealed effect: the model is complete.
    Complete,
    /// Two concealed effects.
    Pair,
    /// Three concealed effects.
    Triple,
    /// A law without a name that swings in time.
    Periodic,
    /// Two laws without a name at different places.
    TwoLaws,
    /// A number of the model that is another than believed.
    WrongNumber,
    /// A law without a name whose shape no textbook has.
    Unfamiliar,
}

/// A text that names no subject of a self-test.
#[derive(Debug, thiserror::Error)]
#[error("--terms {0}: there is no such term, {known}; separate several by commas", known = suggested(.0))]
pub struct UnknownTerm(String);

/// The terms, and which was probably meant.
fn suggested(text: &str) -> String {
    let effects = in_struts().into_iter().map(EffectId::as_str);
    let known: Vec<&str> = effects
        .chain([COMPLETE, PAIR, TRIPLE, PERIODIC, TWO_LAWS, WRONG_NUMBER, UNFAMILIAR])
        .collect();
    suggestion(text, &known, "terms")
}

impl FromStr for Subject {
    type Err = UnknownTerm;

    fn from_str(text: &str) -> Result<Self, UnknownTerm> {
        match text {
            COMPLETE => Ok(Self::Complete),
            PAIR => Ok(Self::Pair),
            TRIPLE => Ok(Self::Triple),
            PERIODIC => Ok(Self::Periodic),
            TWO_LAWS => Ok(Self::TwoLaws),
            WRONG_NUMBER => Ok(Self::WrongNumber),
            UNFAMILIAR => Ok(Self::Unfamiliar),
            _ => (in_struts().into_iter().find(|term| term.as_str() == text))
                .map(Self::Effect)
                .ok_or_else(|| UnknownTerm(text.to_owned())),
        }
    }
}

impl Plan {
    /// All cases, in order. Without names only effects are concealed.
    #[must_use]
    pub fn cases(&self) -> Vec<Case> {
        let wanted = |s: Subject| self.subjects.is_empty() || self.subjects.contains(&s);
        let mut cases = Vec::with_capacity(self.campaigns);
        let mut round = 0;
        while cases.len() < self.campaigns {
            let before = cases.len();
            if self.without_names {
                self.nameless(round, &wanted, &mut cases);
            } else {
                self.round(round, &wanted, &mut cases);
            }
            if cases.len() == before {
                break;
            }
            round += 1;
        }
        cases.truncate(self.campaigns);
        for (case, flaw) in cases.iter_mut().zip(self.flaws.iter().cycle()) {
            case.name += &format!(":{flaw}");
            case.flaw = Some(*flaw);
        }
        cases
    }

    fn round(&self, round: usize, wanted: &dyn Fn(Subject) -> bool, cases: &mut Vec<Case>) {
        let (seed, terms) = (self.seed, in_struts());
        // Three terms, then a complete model: an interrupted round holds a share of each kind.
        let mut complete = (0..COMPLETE_PER_ROUND).map(|k| Case {
            name: format!("{seed}:{COMPLETE}:{round}.{k}"),
            hidden: vec![],
            variants: vec![],
            left_out: None,
            flaw: None,
        });
        for (k, &term) in terms.iter().enumerate() {
            if wanted(Subject::Effect(term)) {
                let size = SIZES[(round + k) % SIZES.len()];
                cases.push(Case {
                    name: format!("{seed}:{term}:{round}:{size}"),
                    hidden: vec![(term, size)],
                    variants: vec![],
                    left_out: None,
                    flaw: None,
                });
            }
            if k % 3 == 2 && wanted(Subject::Complete) {
                cases.extend(complete.next());
            }
        }
        if wanted(Subject::Complete) {
            cases.extend(complete);
        }
        if self.subjects.contains(&Subject::Periodic) {
            self.periodic(round, cases);
        }
        if self.subjects.contains(&Subject::WrongNumber) {
            let (variants, sizes) = (variants_of_believed_numbers(), WRONG_NUMBER_SIZES);
            self.one_of_each(WRONG_NUMBER, variants, sizes, round, cases);
        }
        if self.subjects.contains(&Subject::Unfamiliar) {
            self.one_of_each(UNFAMILIAR, unfamiliar_variants(), UNFAMILIAR_SIZES, round, cases);
        }
        if self.subjects.contains(&Subject::TwoLaws) {
            self.two_laws(round, cases);
        }
        if wanted(Subject::Pair) {
            cases.extend((0..PAIRS_PER_ROUND).map(|k| several::<2>(format!("{seed}:{PAIR}:{round}.{k}"))));
        }
        // Among the others they would move the campaigns of all later rounds, and published figures would be of other ones.
        if self.subjects.contains(&Subject::Triple) {
            cases.extend((0..TRIPLES_PER_ROUND).map(|k| several::<3>(format!("{seed}:{TRIPLE}:{round}.{k}"))));
        }
    }

    /// Laws that swing in time, of every kind and size. They are concealed only where they are asked for.
    fn periodic(&self, round: usize, cases: &mut Vec<Case>) {
        for variant in periodic_variants() {
            for size in PERIODIC_SIZES {
                cases.push(Case {
                    name: format!("{}:{PERIODIC}:{round}:{variant}:{size}", self.seed),
                    hidden: vec![(EffectId::Unlisted, size)],
                    variants: vec![variant],
                    left_out: None,
                    flaw: None,
                });
            }
        }
    }

    /// Every variant once, with a size that changes from round to round. They are concealed only where they are asked for.
    fn one_of_each(&self, kind: &str, variants: Range<usize>, sizes: [f64; 3], round: usize, cases: &mut Vec<Case>) {
        for (k, variant) in variants.enumerate() {
            let size = sizes[(round + k) % sizes.len()];
            cases.push(Case {
                name: format!("{}:{kind}:{round}:{variant}:{size}", self.seed),
                hidden: vec![(EffectId::Unlisted, size)],
                variants: vec![variant],
                left_out: None,
                flaw: None,
            });
        }
    }

    /// Two laws without a name, which and of which sizes is drawn. They are concealed only where they are asked for.
    fn two_laws(&self, round: usize, cases: &mut Vec<Case>) {
        let pairs = pairs_of_variants();
        for k in 0..TWO_LAWS_PER_ROUND {
            let name = format!("{}:{TWO_LAWS}:{round}.{k}", self.seed);
            let mut draw = Draw::named(&name);
            let variants = pairs[draw.index(pairs.len())].to_vec();
            let mut size = || TWO_LAWS_SIZES[draw.index(TWO_LAWS_SIZES.len())];
            let hidden = vec![(EffectId::Unlisted, size()), (EffectId::Unlisted, size())];
            cases.push(Case {
                name,
                hidden,
                variants,
                left_out: None,
                flaw: None,
            });
        }
    }

    fn nameless(&self, round: usize, wanted: &dyn Fn(Subject) -> bool, cases: &mut Vec<Case>) {
        let nameable = |t: EffectId| t != EffectId::Unlisted && wanted(Subject::Effect(t));
        for (k, term) in in_struts().into_iter().enumerate().filter(|(_, t)| nameable(*t)) {
            let size = NAMELESS_SIZES[(round + k) % NAMELESS_SIZES.len()];
            cases.push(Case {
                name: format!("{}:without:{term}:{round}:{size}", self.seed),
                hidden: vec![(term, size)],
                variants: vec![],
                left_out: Some(term),
                flaw: None,
            });
        }
    }
}

/// Different effects at once, each of one to thirty times the noise.
fn several<const N: usize>(name: String) -> Case {
    let mut draw = Draw::named(&name);
    let mut left = in_struts();
    let terms = [(); N].map(|()| {
        // Turned, so that a pair is the same two as before there were triples.
        let at = draw.index(left.len());
        left.rotate_left(at);
        left.remove(0)
    });
    Case {
        hidden: terms.map(|term| (term, SIZES[2 + draw.index(4)])).to_vec(),
        name,
        variants: vec![],
        left_out: None,
        flaw: None,
    }
}

/// The grid's size nearest in the logarithm.
pub fn nearest_size(size: f64) -> f64 {
    let distance = |s: f64| (libm::log(s.max(1e-9)) - libm::log(size.max(1e-9))).abs();
    SIZES
        .into_iter()
        .min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        .unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(campaigns: usize, terms: &[&str]) -> Plan {
        Plan {
            seed: 1,
            campaigns,
            subjects: terms.iter().map(|t| t.parse().expect("a term")).collect(),
            without_names: false,
            flaws: vec![],
        }
    }

    #[test]
    fn names_are_unique_and_a_part_holds_the_same_campaigns() {
        let all = plan(500, &[]).cases();
        let mut names: Vec<&str> = all.iter().map(|c| c.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), 500);
        for case in plan(12, &["seal_friction"]).cases() {
            assert!(all.contains(&case), "{case:?}");
        }
    }

    #[test]
    fn eight_rounds_hold_every_term_at_every_size() {
        let terms = in_struts();
        let all = plan(SIZES.len() * (terms.len() + COMPLETE_PER_ROUND + PAIRS_PER_ROUND), &[]).cases();
        for term in terms {
            for size in SIZES {
                assert!(all.iter().any(|c| c.hidden == [(term, size)]), "{term} {size}");
            }
        }
    }

    #[test]
    fn triples_are_three_different_effects_and_leave_all_other_campaigns_as_they_are() {
        let triples = plan(24, &["triple"]).cases();
        assert_eq!(triples.len(), 24);
        for case in &triples {
            let mut terms: Vec<EffectId> = case.hidden.iter().map(|(term, _)| *term).collect();
            terms.sort_unstable();
            terms.dedup();
            assert_eq!(terms.len(), 3, "{case:?}");
            assert!(
                case.hidden.iter().all(|(_, size)| (1.0..=30.0).contains(size)),
                "{case:?}"
            );
        }
        let all = plan(200, &[]).cases();
        assert!(all.iter().all(|case| case.hidden.len() < 3));
    }

    #[test]
    fn pairs_are_those_of_the_published_figures() {
        let terms = in_struts();
        for case in plan(40, &["pair"]).cases() {
            // As they were drawn before there were triples.
            let mut draw = Draw::named(&case.name);
            let first = draw.index(terms.len());
            let second = (first + 1 + draw.index(terms.len() - 1)) % terms.len();
            assert_eq!(
                case.hidden,
                [first, second].map(|t| (terms[t], SIZES[2 + draw.index(4)]))
            );
        }
    }

    #[test]
    fn two_laws_are_two_and_act_at_different_places() {
        let cases = plan(24, &["two_laws"]).cases();
        assert!(
            cases
                .iter()
                .all(|case| case.hidden.len() == 2 && case.variants.len() == 2)
        );
        let mut pairs: Vec<&[usize]> = cases.iter().map(|case| case.variants.as_slice()).collect();
        pairs.sort_unstable();
        pairs.dedup();
        assert!(pairs.len() > 12, "{pairs:?}");
        // A groove beside damper 1 and a line of path 1 are both in path 1; a valve is one of all valves.
        let all = pairs_of_variants();
        assert!(all.contains(&[0, 5]) && !all.contains(&[0, 4]) && !all.contains(&[6, 15]));
        assert!(all.len() > 100, "{}", all.len());
    }

    #[test]
    fn an_unknown_term_is_refused_with_those_known() {
        let error = "seal_fraction".parse::<Subject>().expect_err("no term").to_string();
        assert!(error.contains("seal_fraction") && error.contains("seal_friction"));
    }
}
