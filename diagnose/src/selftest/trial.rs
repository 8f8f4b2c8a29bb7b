//! One campaign diagnosed, and what a table needs to know of it: what was concealed, what was reported, how far off.

use std::sync::atomic::AtomicBool;

use oleo_plant_sim::strut::StrutModel;
use serde::{Deserialize, Serialize};

use super::flaw::Flaw;
use super::generate::generate;
use super::hidden::Truth;
use super::plan::Case;
use crate::campaign::Campaign;
use crate::diagnosis::{Diagnosis, Effect};
use crate::error::DiagnoseError;
use crate::estimation::LeastSquares;
use crate::instrument::Finding;
use crate::recording::Recording;
use crate::search::LawPairs;
use crate::specimen::strut::TwoStageStrut;
use crate::specimen::{Hypothesis, Specimen};
use crate::vocabulary::{EffectId, Place, Site};

/// A fitted number of a reported effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// Key of the parameter with its unit.
    pub key: String,
    /// Estimated value, in the unit of the key.
    pub value: f64,
    /// 95 % interval; `None` where the recordings do not bound it.
    pub low: Option<f64>,
    /// Upper end of the 95 % interval; `None` if it is not determined.
    pub high: Option<f64>,
}

/// A reported effect with the evidence its confidence came from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reported {
    /// Id of the vocabulary or `unlisted`.
    pub id: EffectId,
    /// Where it is said to act.
    pub place: Place,
    /// What tells laws without a name apart; empty for everything else.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub label: String,
    /// Reported confidence, 0.05 to 0.99.
    pub confidence: f64,
    /// Held-out gain in cost and its standard error; `None` for what is seen but not modelled.
    pub gain: Option<(f64, f64)>,
    /// Lead in cost over the strongest rival, and its standard error.
    pub lead: Option<(f64, f64)>,
    /// The strongest rival, if one could be fitted.
    pub rival: Option<String>,
    /// True if the report calls the two ambiguous.
    pub ambiguous: bool,
    /// Reported parameters of the effect.
    pub numbers: Vec<Number>,
}

/// The outcome of one campaign.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Name of the campaign.
    pub name: String,
    /// Ids concealed, with the size wanted and the size reached, in units of noise.
    pub hidden: Vec<(EffectId, f64, f64)>,
    /// True values of the concealed parameters.
    pub truth: Vec<Truth>,
    /// Term that the search was not allowed.
    pub left_out: Option<EffectId>,
    /// What is wrong with the instruments.
    pub flaw: Option<Flaw>,
    /// Effects that the diagnosis reported.
    pub reported: Vec<Reported>,
    /// What the diagnosis said of the instruments: name of each finding and its column, empty for all.
    pub said: Vec<(String, String)>,
    /// Number of residuals of the campaign.
    pub residuals: usize,
    /// Held-out noise ratio of the calibrated and of the improved model.
    pub noise_ratio: (f64, f64),
    /// The same on recordings that the diagnosis never saw.
    pub unseen: (f64, f64),
    /// The same of the true model, which is driven by the recorded displacement like the others: the floor.
    #[serde(default)]
    pub unseen_floor: f64,
    /// Whether laws without a name were tried in pairs.
    #[serde(default)]
    pub law_pairs: LawPairs,
    /// Number of recordings that were simulated during the search.
    #[serde(default)]
    pub simulated: usize,
    /// True if the report says that something remains.
    pub incomplete: bool,
    /// Why there is no diagnosis, where there is none.
    pub failed: Option<String>,
}

/// Makes the campaign and diagnoses it.
///
/// # Errors
/// [`DiagnoseError::Interrupted`] if the caller asked to stop; every other error is part of the result.
pub fn run(case: &Case, stop: &AtomicBool) -> Result<Trial, DiagnoseError> {
    let mut trial = Trial {
        name: case.name.clone(),
        hidden: case.hidden.iter().map(|(id, size)| (*id, *size, 0.0)).collect(),
        truth: vec![],
        left_out: case.left_out,
        flaw: case.flaw,
        reported: vec![],
        said: vec![],
        residuals: 0,
        noise_ratio: (0.0, 0.0),
        unseen: (0.0, 0.0),
        unseen_floor: 0.0,
        law_pairs: LawPairs::NotTried,
        simulated: 0,
        incomplete: false,
        failed: None,
    };
    match diagnose(case, stop, &mut trial) {
        Ok(()) => {}
        Err(DiagnoseError::Interrupted) => return Err(DiagnoseError::Interrupted),
        Err(error) => trial.failed = Some(error.to_string()),
    }
    Ok(trial)
}

fn diagnose(case: &Case, stop: &AtomicBool, trial: &mut Trial) -> Result<(), DiagnoseError> {
    let generated = generate(&case.name, &case.hidden, &case.variants, case.flaw)?;
    trial.truth = generated.truth;
    for (hidden, size) in trial.hidden.iter_mut().zip(generated.sizes) {
        // JSON knows no infinity: an effect that stops the simulation is as large as can be said.
        hidden.2 = size.min(1e9);
    }
    let mut strut = TwoStageStrut::new(generated.given, generated.recordings).map_err(DiagnoseError::Model)?;
    if let Some(id) = case.left_out {
        strut.leave_out(id);
    }
    trial.said = said(&strut);
    let campaign = Campaign {
        name: case.name.clone(),
        specimen: Box::new(strut),
        notes: vec![],
    };
    let problem = LeastSquares::new(&*campaign.specimen, stop);
    let diagnosis = Diagnosis::of(&problem, &|_, _| {})?;
    trial.residuals = problem.residuals();
    trial.noise_ratio = (diagnosis.selection.calibrated_ratio, diagnosis.selection.improved_ratio);
    trial.law_pairs = diagnosis.selection.law_pairs;
    trial.simulated = diagnosis.simulated;
    trial.incomplete = diagnosis.selection.incomplete;
    trial.reported = diagnosis.effects.iter().map(|e| reported(&campaign, e)).collect();
    let calibrated = diagnosis.selection.calibrated.point.hypothesis(problem.specimen());
    let before = campaign
        .specimen
        .model_toml(&calibrated)
        .map_err(DiagnoseError::Output)?;
    let read =
        |text: &str| StrutModel::from_toml(text, "improved model").map_err(|e| DiagnoseError::Model(e.to_string()));
    trial.unseen = (
        noise_ratio(read(&before)?, &generated.unseen)?,
        noise_ratio(read(&diagnosis.model_toml)?, &generated.unseen)?,
    );
    trial.unseen_floor = noise_ratio(generated.complete, &generated.unseen)?;
    Ok(())
}

/// What is said of the instruments.
fn said(strut: &TwoStageStrut) -> Vec<(String, String)> {
    let column = |f: &Finding| f.column.as_ref().map_or_else(String::new, ToString::to_string);
    let findings = strut.instruments().iter();
    findings.map(|f| (f.flaw.name().to_owned(), column(f))).collect()
}

fn reported(campaign: &Campaign, effect: &Effect) -> Reported {
    let all = campaign.specimen.candidates();
    let selected = effect.selected.as_ref();
    let rival = selected.and_then(|s| s.rival);
    let bound = |v: f64| v.is_finite().then_some(v);
    Reported {
        id: effect.id,
        place: effect.place.clone(),
        label: effect.label.clone(),
        confidence: effect.confidence,
        gain: selected.map(|s| (s.gain.total, s.gain.standard_error)),
        lead: rival.map(|r| (r.lead.total, r.lead.standard_error)),
        rival: rival.map(|r| all[r.candidate].name()),
        ambiguous: rival.is_some_and(|r| r.ambiguous),
        numbers: (effect.parameters.iter())
            .map(|p| Number {
                key: p.key.clone(),
                value: if p.value.is_finite() { p.value } else { f64::MAX },
                low: bound(p.ci95[0].min(p.ci95[1])),
                high: bound(p.ci95[0].max(p.ci95[1])),
            })
            .collect(),
    }
}

/// Noise ratio of a model on recordings.
fn noise_ratio(model: StrutModel, recordings: &[Recording]) -> Result<f64, DiagnoseError> {
    let strut = TwoStageStrut::new(model, recordings.to_vec()).map_err(DiagnoseError::Model)?;
    let as_given = Hypothesis {
        calibration: vec![0.0; strut.calibration().len()],
        effects: vec![],
    };
    let (mut sum, mut count) = (0.0, 0);
    for (r, recording) in recordings.iter().enumerate() {
        let simulated = strut.simulate(&as_given, r).map_err(|what| DiagnoseError::Simulation {
            recording: recording.name.clone(),
            what,
        })?;
        let shown = strut.observe(&as_given, r, &simulated);
        for (c, channel) in strut.channels().iter().enumerate() {
            let measured = strut.measured(r, c);
            sum += (measured.iter().zip(&shown[c]))
                .map(|(m, s)| ((m - s) / channel.noise) * ((m - s) / channel.noise))
                .sum::<f64>();
            count += measured.len();
        }
    }
    Ok((sum / count.max(1) as f64).sqrt().min(1e9))
}

impl Trial {
    /// Ids of the concealed effects.
    pub fn hidden_ids(&self) -> Vec<EffectId> {
        self.hidden.iter().map(|(id, ..)| *id).collect()
    }

    /// What is concealed and what is reported, each in order and once: the id, and the place of a law where more than one is concealed.
    pub fn concealed_and_reported(&self) -> [Vec<(EffectId, Option<&Place>)>; 2] {
        let laws = self.hidden.iter().filter(|(id, ..)| *id == EffectId::Unlisted).count();
        let known = |id: EffectId, place| (id, (id == EffectId::Unlisted && laws > 1).then_some(place));
        let hidden = self.truth.iter().map(|t| known(t.id, &t.place)).collect();
        let reported = self.reported.iter().map(|r| known(r.id, &r.place)).collect();
        [hidden, reported].map(|mut list: Vec<_>| {
            list.sort_unstable();
            list.dedup();
            list
        })
    }

    /// Size reached of each concealed effect, and whether it is reported; of several laws each at its place.
    pub fn each_found(&self) -> Vec<(f64, bool)> {
        let laws = self.hidden.iter().filter(|(id, ..)| *id == EffectId::Unlisted).count();
        let mut places: Vec<&Place> = (self.truth.iter())
            .filter(|t| t.id == EffectId::Unlisted)
            .map(|t| &t.place)
            .collect();
        places.dedup();
        let mut places = places.into_iter();
        let mut at_its_place = |id: EffectId| {
            let place = places.next();
            self.reported.iter().any(|r| r.id == id && Some(&r.place) == place)
        };
        (self.hidden.iter())
            .map(|&(id, _, size)| match id == EffectId::Unlisted && laws > 1 {
                true => (size, at_its_place(id)),
                false => (size, self.found(id)),
            })
            .collect()
    }

    /// Whether an id is reported.
    #[must_use]
    pub fn found(&self, id: EffectId) -> bool {
        self.reported.iter().any(|r| r.id == id)
    }

    /// Whether laws without a name are reported at the whole place of a concealed effect. Combined places count by their parts: a law of both
    /// accumulators is where an effect of each of them is, and a law of each is where an effect of both is.
    #[must_use]
    pub fn law_is_placed(&self) -> bool {
        let parts = |place: &Place| place.site.parts();
        let truly: Vec<Site> = self.truth.iter().flat_map(|t| parts(&t.place)).collect();
        let laws = self.reported.iter().filter(|r| r.id == EffectId::Unlisted);
        let there: Vec<Site> = (laws.map(|r| parts(&r.place)))
            .filter(|own| own.iter().all(|site| truly.contains(site)))
            .flatten()
            .collect();
        !there.is_empty() && (self.truth.iter()).any(|t| parts(&t.place).iter().all(|site| there.contains(site)))
    }

    /// Whether an id is reported at every one of its places and nowhere else.
    #[must_use]
    pub fn placed(&self, id: EffectId) -> bool {
        let mut true_places: Vec<&Place> = self.truth.iter().filter(|t| t.id == id).map(|t| &t.place).collect();
        let mut places: Vec<&Place> = (self.reported.iter())
            .filter(|r| r.id == id)
            .map(|r| &r.place)
            .collect();
        for list in [&mut true_places, &mut places] {
            list.sort_unstable();
            list.dedup();
        }
        !places.is_empty() && places == true_places
    }

    /// The reported number that answers a true one.
    #[must_use]
    pub fn estimate(&self, truth: &Truth) -> Option<&Number> {
        (self.reported.iter())
            .filter(|r| r.id == truth.id && r.place == truth.place)
            .flat_map(|r| &r.numbers)
            .find(|n| n.key == truth.key)
    }

    /// Whether an id is placed and its size (the first number concealed) is within a fifth or within its interval; what
    /// has no numbers is sized where it is placed.
    #[must_use]
    pub fn sized(&self, id: EffectId) -> bool {
        let Some(size) = self.truth.iter().find(|t| t.id == id) else {
            return false;
        };
        let near =
            |n: &Number| (n.value - size.value).abs() <= 0.2 * size.value.abs() || covers(n, size.value) == Some(true);
        self.placed(id) && (size.key.is_empty() || self.estimate(size).is_some_and(near))
    }

    /// Whether a reported effect is there, at its place.
    #[must_use]
    pub fn there(&self, reported: &Reported) -> bool {
        self.truth
            .iter()
            .any(|t| t.id == reported.id && t.place == reported.place)
    }
}

/// Whether a bounded interval holds the true value.
#[must_use]
pub fn covers(number: &Number, truth: f64) -> Option<bool> {
    let (low, high) = (number.low?, number.high?);
    Some(low <= truth && truth <= high)
}
