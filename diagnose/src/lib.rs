//! Finds the physics that a model leaves out.
//!
//! If simulation and recordings differ, this crate locates the misfit, names the physics that the model leaves out, models
//! it, and shows how much the prediction of held-out recordings improves. [`Campaign`] reads the recordings and the given
//! model of a specimen, [`search`] finds the missing effects, and [`Diagnosis`] states the result.
//!
//! ```text
//! recording --> campaign --> specimen (strut | gas spring | cylinder | damper | drive: one trait) <-- effect (what may be missing: one file each)
//!                               |
//!              estimation (residuals in noise units, sensitivities of free runs, fits with calibration within tolerance)
//!                               |
//!              search (screen all candidates, select on held-out blocks, compare with rivals)
//!                               |
//!              locate (which relation, when, under which condition) --> diagnosis --> json, page, model.toml
//! ```
//!
//! A gas spring is believed to be adiabatic, and its gas exchanges heat with the wall:
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//! use oleo_diagnose::estimation::LeastSquares;
//! use oleo_diagnose::recording::Recording;
//! use oleo_diagnose::specimen::ModelFile;
//! use oleo_diagnose::vocabulary::EffectId;
//! use oleo_diagnose::{DiagnoseError, Diagnosis};
//! use oleo_plant_sim::specimen::GasSpringModel;
//!
//! let believed = "[specimen]\nname = \"spring\"\nkind = \"gas spring\"\n\
//!     [chamber]\narea_m2 = 0.01\nvolume_at_zero_m3 = 0.03\n\
//!     [gas]\nspecies = \"nitrogen\"\nprocess = \"adiabatic\"\ntemperature_K = 293.15\n\
//!     [noise]\ndisplacement_m = 1e-5\np_Pa = 300.0\n";
//! let truth = format!("{believed}[effects.gas_heat_transfer]\ntime_constant_s = 6.0\n");
//! let truth = GasSpringModel::from_toml(&truth, "truth")?;
//!
//! // Strokes of 0.5 m with holds, sampled at 20 Hz.
//! let time_s: Vec<f64> = (0..1200).map(|k| 0.05 * f64::from(k)).collect();
//! let stroke = |t: &f64| ((t % 20.0 - 5.0).clamp(0.0, 5.0) - (t % 20.0 - 13.0).clamp(0.0, 5.0)) / 10.0;
//! let displacement_m: Vec<f64> = time_s.iter().map(stroke).collect();
//! let pressure_pa = truth.pressure_pa(&time_s, &displacement_m, 1.0e6).map_err(DiagnoseError::Model)?;
//! let recording = Recording { name: "strokes".into(), time_s, columns: vec![displacement_m, pressure_pa], notes: vec![] };
//!
//! let specimen = ModelFile::read(believed, "model.toml")?.model.with_recordings(vec![recording])?;
//! let stop = AtomicBool::new(false);
//! let diagnosis = Diagnosis::of(&LeastSquares::new(&*specimen, &stop), &|_, _| {})?;
//! let found = &diagnosis.effects[0];
//! assert_eq!((diagnosis.effects.len(), found.id), (1, EffectId::GasHeatTransfer));
//! assert!((found.parameters[0].value - 6.0).abs() < 0.1);
//! # Ok::<(), DiagnoseError>(())
//! ```
//!
//! `docs/architecture.md` draws the dependencies of the modules, and the path of a column through them.

#[cfg(test)]
mod analytic;
pub mod body;
pub mod campaign;
pub mod confidence;
pub mod correction;
pub mod criteria;
pub mod diagnosis;
pub mod effect;
pub mod error;
pub mod estimation;
pub mod excitation;
mod experiment;
pub mod findings;
pub mod free_run;
pub mod instrument;
pub mod json;
pub mod locate;
mod median;
pub mod one_a_thread;
pub mod page;
pub mod parameter;
pub mod prediction;
pub mod recording;
pub mod search;
pub mod selftest;
pub mod specimen;
mod units;
pub mod vehicle;
pub mod vocabulary;
pub mod whiteness;

pub use campaign::{Campaign, KeptBack, MODEL_FILE};
pub use diagnosis::Diagnosis;
pub use error::DiagnoseError;
pub use findings::Findings;
pub use prediction::Predictions;
