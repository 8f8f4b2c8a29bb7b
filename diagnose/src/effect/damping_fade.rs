//! Loss of damping as the oil of the dampers warms.

use oleo_plant_sim::strut::{DampingFade as Term, Equation, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{Branch, EffectId, Site};

/// Variant in which damper 1 alone fades.
const FIRST: usize = 0;
/// Variant in which damper 2 alone fades; in the third both do.
const SECOND: usize = 1;

pub struct DampingFade;

impl Effect for DampingFade {
    fn id(&self) -> EffectId {
        EffectId::DampingFade
    }

    fn name(&self) -> &'static str {
        "loss of damping with temperature"
    }

    fn meaning(&self) -> &'static str {
        "the dampers weaken as their oil warms; E is the energy stored in the oil, and f is the relative loss of damping per joule"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("fade_i_per_J", "f"), ("cooling_time_s", "tau")]
    }

    /// Both paths have a number of their own and share the cooling time.
    fn reported(&self, site: &Site, count: usize) -> Vec<(Site, Vec<usize>)> {
        match site {
            Site::Paths => Branch::ALL
                .map(|branch| (Site::Path(branch), vec![branch.number() - 1, 2]))
                .to_vec(),
            one => vec![(one.clone(), (0..count).collect())],
        }
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for DampingFade {
    fn equation(&self) -> Equation {
        TermId::DampingFade.equation()
    }

    fn candidates(&self, model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.damping_fade.is_some() {
            return vec![];
        }
        // A rate is fitted and not a time: recordings that are too short to show any cooling tell no long time from a longer one, but they do not tell how large
        // the fade is either, and near a rate of zero both answer together.
        let cooling =
            || Parameter::linear("cooling_rate_1_s", 1.0 / 60.0, 0.01, (1e-5, 1.0)).shown_as_inverse("cooling_time_s");
        let fade = |branch: Branch| Parameter::amount(format!("fade_{}_per_J", branch.number()), 1e-5, 1e-2);
        let one = Branch::ALL.map(|branch| {
            Candidate::new(self.id(), Site::Path(branch), vec![fade(branch), cooling()])
                .testable_unless(excitation.no_drop(branch))
        });
        let [first, second] = Branch::ALL;
        let both = Candidate::new(self.id(), Site::Paths, vec![fade(first), fade(second), cooling()])
            .testable_unless(excitation.no_drop(first).or(excitation.no_drop(second)));
        // One damper or both fade: these stand for the same thing.
        one.into_iter()
            .chain([both])
            .map(|candidate| candidate.in_place_of(self.id()))
            .collect()
    }

    fn put(&self, model: &mut StrutModel, candidate: &Candidate, values: &[f64]) {
        let (first, second, cooling_rate) = match candidate.place.branch() {
            Some(Branch::First) => (values[0], 0.0, values[1]),
            Some(Branch::Second) => (0.0, values[0], values[1]),
            None => (values[0], values[1], values[2]),
        };
        model.effects.damping_fade = Some(Term {
            fade_1_per_j: first,
            fade_2_per_j: second,
            cooling_time_s: 1.0 / cooling_rate,
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "sines of 25 mm at 0.8 m/s for 60 s, valves 1 and 2 closed, valve 3 open, and the same again after 10 minutes of rest",
            shows: "lets the pressure drop across the damper fall from cycle to cycle and recover after the rest",
        }
    }
}

impl Concealed for DampingFade {
    fn variants(&self) -> usize {
        3
    }

    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e-8, 3e-4))
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        let first = if drawn.variant == SECOND { 0.0 } else { amount };
        let second = match drawn.variant {
            FIRST => 0.0,
            SECOND => amount,
            _ => amount * drawn.between(0, 0.7, 1.4),
        };
        let cooling = drawn.between(1, 30.0, 200.0);
        model.effects.damping_fade = Some(Term {
            fade_1_per_j: first,
            fade_2_per_j: second,
            cooling_time_s: cooling,
        });
        let [path_1, path_2] = Branch::ALL.map(Site::Path);
        let mut all = Vec::new();
        if drawn.variant != SECOND {
            all.push(TrueNumber::new(path_1.clone(), "fade_1_per_J", first));
        }
        if drawn.variant != FIRST {
            all.push(TrueNumber::new(path_2.clone(), "fade_2_per_J", second));
        }
        let cools = if drawn.variant == SECOND { path_2 } else { path_1 };
        all.push(TrueNumber::new(cools, "cooling_time_s", cooling));
        all
    }
}
