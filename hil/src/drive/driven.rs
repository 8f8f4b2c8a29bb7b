//! The drives of a request: one, or one for each model, or one for each suspension.

use oleo_plant_sim::course::Run;
use rayon::prelude::*;

use super::choice::{Model, Setting};
use super::plan::Plan;
use super::request::Request;
use crate::run::RunError;

/// A drive with the name that tells it from the others: that of the model, or of the suspension where there are several.
pub struct Driven {
    /// Its name.
    pub name: &'static str,
    /// Its suspension.
    pub setting: Setting,
    /// What happened.
    pub run: Run,
}

/// Drives everything that was asked for, on all cores, in the order in which it was asked for.
///
/// # Errors
/// As [`Plan::handling`].
pub fn drive(plan: &Plan, request: &Request) -> Result<Vec<Driven>, RunError> {
    let models: &[(&'static str, Model)] = match request.model {
        Model::Ride => &[("ride model", Model::Ride)],
        Model::Handling => &[("handling model", Model::Handling)],
        Model::Both => &[("ride model", Model::Ride), ("handling model", Model::Handling)],
    };
    let several = request.setting.len() > 1;
    let asked: Vec<_> = (request.setting.iter())
        .flat_map(|&setting| models.iter().map(move |&(name, model)| (setting, name, model)))
        .collect();
    (asked.into_par_iter())
        .map(|(setting, name, model)| {
            Ok(Driven {
                name: if several { setting.name() } else { name },
                setting,
                run: match model {
                    Model::Ride => plan.ride(setting)?,
                    _ => plan.handling(setting)?,
                },
            })
        })
        .collect()
}
