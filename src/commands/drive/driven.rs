//! The drives of a command: one, or one for each model, or one for each suspension.

use oleo_plant_sim::course::Run;
use rayon::prelude::*;

use super::arguments::{Args, Model, Setting};
use super::plan::Plan;
use crate::failure::Failure;

/// A drive with the name that tells it from the others: that of the model, or of the suspension where there are several.
pub struct Driven {
    pub name: &'static str,
    pub setting: Setting,
    pub run: Run,
}

/// Drives everything that was asked for, on all cores, in the order in which it was asked for.
pub fn drive(plan: &Plan, args: &Args) -> Result<Vec<Driven>, Failure> {
    let models: &[(&'static str, Model)] = match args.model {
        Model::Ride => &[("ride model", Model::Ride)],
        Model::Handling => &[("handling model", Model::Handling)],
        Model::Both => &[("ride model", Model::Ride), ("handling model", Model::Handling)],
    };
    let several = args.setting.len() > 1;
    let asked: Vec<_> = (args.setting.iter())
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
