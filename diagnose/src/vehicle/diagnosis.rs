//! The diagnosis of a vehicle: that of its four struts, and what they have in common.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use oleo_interface::{Corner, Corners};
use oleo_plant_sim::strut::StrutModel;
use rayon::prelude::*;

use super::body::BodyCampaign;
use super::campaign::VehicleCampaign;
use super::common::{Common, common};
use super::driven::Driven;
use super::sharing::with_what_all_share;
use crate::body::BodyFindings;
use crate::campaign::MODEL_FILE;
use crate::diagnosis::{Diagnosis, Effect, Estimate, Verdict};
use crate::error::DiagnoseError;
use crate::estimation::LeastSquares;
use crate::search::Progress;
use crate::vocabulary::{Place, VehiclePart};

/// Fraction of the work that is done when all corners have been diagnosed on their own.
const SHARING_BEGINS: f64 = 0.97;

/// An effect with the part of the vehicle that has it.
#[derive(Debug, Clone)]
pub struct VehicleEffect {
    /// The effect. Of one that all corners share, the place is that of the vehicle, the parameters are pooled, and everything else
    /// is the first corner's.
    pub effect: Effect,
    /// Held-out noise ratio without the effect and with it, over the corners that have it.
    pub ratios: [f64; 2],
}

/// The result of the diagnosis of a vehicle.
pub struct VehicleDiagnosis {
    /// The diagnosis of each strut.
    pub corners: Corners<Diagnosis>,
    /// All effects: first what is common to all corners, then each corner's own.
    pub effects: Vec<VehicleEffect>,
    /// What the balance of the body says, or why it says nothing; `None` where there is nothing to balance.
    pub body: Option<Result<BodyFindings, String>>,
    /// What the driver feels of the effects, or why it is not known; `None` until the loop was driven.
    pub driven: Option<Result<Driven, String>>,
}

impl VehicleDiagnosis {
    /// Diagnoses all four struts. `stop`, set from another thread, ends the work.
    ///
    /// # Errors
    /// A model that cannot be simulated; [`DiagnoseError::Interrupted`] once the caller asked to stop.
    pub fn of(campaign: &VehicleCampaign, stop: &AtomicBool, progress: Progress<'_>) -> Result<Self, DiagnoseError> {
        // What each corner is doing; the one that is furthest behind is told.
        let done = Mutex::new(Corners::<(f64, String)>::default());
        let diagnosed: Vec<Result<Diagnosis, DiagnoseError>> = (Corner::ALL.into_par_iter())
            .map(|corner| {
                let problem = LeastSquares::new(&*campaign.corners[corner].specimen, stop);
                Diagnosis::of(&problem, &|doing, part| {
                    if let Ok(mut done) = done.lock() {
                        done[corner] = (part, doing.to_owned());
                        let begun = done.values().filter(|(_, doing)| !doing.is_empty());
                        if let Some((_, doing)) = begun.min_by(|a, b| a.0.total_cmp(&b.0)) {
                            progress(doing, done.values().map(|(part, _)| part).sum::<f64>() / 4.0);
                        }
                    }
                })
            })
            .collect();
        let mut diagnosed = diagnosed.into_iter();
        let corners = Corners::try_from_fn(|_| diagnosed.next().unwrap_or(Err(DiagnoseError::Interrupted)))?;
        progress("trying at all corners what some of them show", SHARING_BEGINS);
        let corners = with_what_all_share(campaign, corners, stop)?;
        Ok(Self {
            effects: effects(&corners),
            corners,
            body: campaign.body.as_ref().map(BodyCampaign::find),
            driven: None,
        })
    }

    /// The answer on the struts in one word; the body has an answer of its own.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let any = |verdict: Verdict| self.corners.values().any(|d| d.verdict() == verdict);
        [Verdict::MissingPhysics, Verdict::Unexplained]
            .into_iter()
            .find(|v| any(*v))
            .unwrap_or(Verdict::Consistent)
    }

    /// The effects of one corner, and those that all corners share.
    pub fn effects_of(&self, part: VehiclePart) -> impl Iterator<Item = &VehicleEffect> {
        self.effects.iter().filter(move |e| e.effect.place.part == Some(part))
    }

    /// The estimates of a parameter of a shared effect at the four corners.
    #[must_use]
    pub fn at_corners(&self, shared: &Effect, parameter: usize) -> Corners<Option<&Estimate>> {
        self.corners.each_ref().map(|diagnosis| {
            let same = |e: &&Effect| (e.id, &e.place.site, &e.label) == (shared.id, &shared.place.site, &shared.label);
            diagnosis.effects.iter().find(same)?.parameters.get(parameter)
        })
    }

    /// Whether something is found of the vehicle itself, and not of its instruments alone.
    #[must_use]
    pub fn alters_vehicle(&self) -> bool {
        let of_struts = self.effects.iter().any(|found| found.effect.place.sensor().is_none());
        of_struts || self.balanced().is_some_and(BodyFindings::alters_vehicle)
    }

    /// What the balance of the body found, where there was one.
    #[must_use]
    pub fn balanced(&self) -> Option<&BodyFindings> {
        self.body.as_ref()?.as_ref().ok()
    }

    /// The struts as they were found, with the noise of the fit.
    ///
    /// # Errors
    /// A model that cannot be read back.
    pub fn struts(&self, campaign: &VehicleCampaign) -> Result<Corners<StrutModel>, DiagnoseError> {
        let names = campaign.model.distinct_files();
        Corners::try_from_fn(|corner| Ok(StrutModel::from_toml(&self.corners[corner].model_toml, &names[corner])?))
    }

    /// The improved model: name and text of each file, in the form of the given one.
    ///
    /// # Errors
    /// A model that cannot be written.
    pub fn improved(&self, campaign: &VehicleCampaign) -> Result<Vec<(String, String)>, DiagnoseError> {
        let names = campaign.model.distinct_files();
        let mut files = vec![(MODEL_FILE.to_owned(), campaign.model.to_toml(&names)?)];
        for (corner, mut strut) in Corner::ALL.into_iter().zip(self.struts(campaign)?.into_array()) {
            // The noise that was fitted with contains the rounding of the bus; the file states the sensor's.
            strut.noise.clone_from(&campaign.model.struts[corner].noise);
            files.push((names[corner].clone(), campaign.model.strut_to_toml(corner, &strut)));
        }
        if let Some(body) = &campaign.model.body
            && let Some(name) = body.own_file()
        {
            files.push((name.to_owned(), body.parameters.to_toml()));
        }
        Ok(files)
    }
}

fn effects(corners: &Corners<Diagnosis>) -> Vec<VehicleEffect> {
    let of_corners = corners.each_ref().map(|d| d.effects.as_slice());
    let shared = common(&of_corners);
    let mut out: Vec<VehicleEffect> = shared.iter().map(|s| of_vehicle(s, &of_corners)).collect();
    for corner in Corner::ALL {
        for (k, effect) in corners[corner].effects.iter().enumerate() {
            if shared.iter().any(|s| s.positions[corner] == k) {
                continue;
            }
            let mut effect = effect.clone();
            effect.place = on(VehiclePart::Corner(corner), &effect.place);
            out.push(VehicleEffect {
                ratios: [effect.ratio_without, effect.ratio_with],
                effect,
            });
        }
    }
    out
}

fn of_vehicle(shared: &Common, effects: &Corners<&[Effect]>) -> VehicleEffect {
    let all = Corners::from_fn(|corner| &effects[corner][shared.positions[corner]]);
    let first = all[Corner::FrontLeft];
    let mean = |ratio: fn(&Effect) -> f64| (all.values().map(|e| ratio(e) * ratio(e)).sum::<f64>() / 4.0).sqrt();
    VehicleEffect {
        ratios: [mean(|e| e.ratio_without), mean(|e| e.ratio_with)],
        effect: Effect {
            place: on(VehiclePart::All, &first.place),
            confidence: shared.confidence,
            parameters: shared.parameters.clone(),
            ..first.clone()
        },
    }
}

fn on(part: VehiclePart, place: &Place) -> Place {
    Place {
        part: Some(part),
        site: place.site.clone(),
    }
}
