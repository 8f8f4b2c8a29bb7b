//! Somebody else's model, whatever it is of: it is simulated by a [`Simulator`](simulator::Simulator), and a [`Map`](map::Map) says what it is compared with.
//!
//! Nothing inside the model can be changed but its parameters. What it lacks is added from outside ([`crate::correction`]): at the instruments, at its inputs
//! before it is simulated, at its outputs afterwards.
//!
//! | file | what it says |
//! |---|---|
//! | `simulator` | what a model must be able to do |
//! | `map` | the file that says which column is what |
//! | `fit` | whether map and model go together |
//! | `stepping` | the times of a simulation, and what is driven at them |
//! | `model` | a model with its map, and what of it may be off within tolerance |
//! | `specimen` | the same with recordings |
//! | `candidates` | what can be added from outside |
//! | `mod` | how model and recordings come together |

mod candidates;
mod fit;
pub mod map;
mod model;
pub mod simulator;
mod specimen;
mod stepping;

use oleo_plant_sim::model_file::InvalidValue;

use super::channel::Channel;
use super::contract::{BelievedModel, Specimen};
use super::hypothesis::Hypothesis;
use crate::error::DiagnoseError;
use crate::recording::{ColumnKind, ColumnSpec, GapPolicy, Recording};
use crate::vocabulary::Column;
use candidates::candidates;
pub use model::CoSimulationModel;
use specimen::CoSimulation;
use stepping::Times;

impl BelievedModel for CoSimulationModel {
    fn columns(&self) -> Vec<ColumnSpec> {
        let compared = self
            .map
            .compared()
            .map(|name| ColumnSpec::new(name, ColumnKind::Output));
        let sources = self.map.sources();
        compared
            .chain(sources.into_iter().map(|name| ColumnSpec::new(name, ColumnKind::Input)))
            .collect()
    }

    fn check_noise(&self) -> Result<(), InvalidValue> {
        // The map was refused without.
        Ok(())
    }

    fn gap_policy(&self) -> GapPolicy {
        GapPolicy::Cut
    }

    fn with_recordings(self: Box<Self>, recordings: Vec<Recording>) -> Result<Box<dyn Specimen>, DiagnoseError> {
        let channels: Vec<Channel> = (self.map.outputs.values())
            .map(|output| Channel {
                column: Column::named(output.column.clone()),
                noise: output.noise,
            })
            .collect();
        let times = (recordings.iter())
            .map(|recording| {
                let interval = recording.interval_s();
                Times::of(&recording.time_s, interval, &self.map.run, self.simulator.stepping())
            })
            .collect::<Result<Vec<_>, String>>()
            .map_err(DiagnoseError::Model)?;
        let mut specimen = CoSimulation {
            model: *self,
            recordings,
            times,
            channels,
            inputs: vec![],
            rates: vec![],
            as_stated: vec![],
            calibration: vec![],
            candidates: vec![],
        };
        specimen.look_at_inputs();
        // One after the other and before the search, so that the first recording on which the model fails is the one that is named.
        let stated = Hypothesis::default();
        for r in 0..specimen.recordings.len() {
            let failed = |what| DiagnoseError::Simulation {
                recording: specimen.recordings[r].name.clone(),
                what,
            };
            if r == 0 {
                let course = specimen.course(&stated, &specimen.corrections(&stated), r);
                (specimen.model.simulator)
                    .check_repeatable(&specimen.recordings[r].name, &course)
                    .map_err(failed)?;
            }
            let simulated = specimen.simulate(&stated, r).map_err(failed)?;
            specimen.as_stated.push(simulated);
        }
        specimen.calibration = specimen.model.calibration();
        specimen.candidates = candidates(&specimen);
        Ok(Box::new(specimen))
    }
}

#[cfg(test)]
mod tests;
