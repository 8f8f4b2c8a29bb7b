//! What can be added to the model from outside.

use super::model::Calibrated;
use super::simulator::Role;
use super::specimen::CoSimulation;
use crate::correction::Quantity;
use crate::effect::{ALL, Candidate, of, sensor};
use crate::excitation::{self, Known, Reading};
use crate::vocabulary::{Column, EffectId};

/// How far an input moves after it has turned until it resists fully, as parts of its spread.
const TURNS: [f64; 3] = [0.003, 0.02, 0.1];

/// Everything that can be added from outside: laws without a name, then faults of instruments.
pub(super) fn candidates(specimen: &CoSimulation) -> Vec<Candidate> {
    let recordings = || 0..specimen.recordings.len();
    let largest = |of: &dyn Fn(usize) -> f64| recordings().map(of).fold(0.0, f64::max);
    let reading = |column: Column, position: usize| Reading {
        column,
        spread: specimen.spread(position),
    };
    let (first, model) = (specimen.channels.len(), &specimen.model);
    let known = quantities(specimen).into_iter().filter_map(|(quantity, switches)| {
        let series: Vec<Vec<f64>> = recordings()
            .filter_map(|r| specimen.quantity(&quantity, r, &specimen.as_stated[r]))
            .collect();
        let range = excitation::CoSimulation::range_of(series.iter().map(Vec::as_slice))?;
        Some(Known {
            quantity,
            range,
            switches,
        })
    });
    let excitation = excitation::CoSimulation {
        outputs: (specimen.channels.iter().enumerate())
            .map(|(k, channel)| {
                let reading = reading(channel.column.clone(), k);
                // What hardly moves may still be wrong by its noise.
                let spread = reading.spread.max(channel.noise);
                Reading { spread, ..reading }
            })
            .collect(),
        inputs: (specimen.inputs.iter().enumerate())
            .filter(|(_, input)| !input.switches)
            .map(|(k, input)| reading(Column::named(input.name.clone()), first + k))
            .filter(|reading| reading.spread > 0.0)
            .collect(),
        quantities: known.collect(),
        tunable: (model.calibrated().into_iter())
            .filter_map(|(calibrated, _)| match calibrated {
                Calibrated::Part(name) | Calibrated::Setting(name) => Some(name.to_owned()),
                Calibrated::InputOffset(_) | Calibrated::OutputOffset(_) => None,
            })
            .filter(|name| model.simulator.variables()[model.variable(name)].role == Role::TunableParameter)
            .collect(),
        duration_s: largest(&|r| specimen.times[r].samples_s.last().copied().unwrap_or(0.0)),
        interval_s: largest(&|r| specimen.recordings[r].interval_s()),
    };
    let of_effect = |id: EffectId| {
        of(id)
            .in_co_simulation()
            .map_or(vec![], |effect| effect.candidates(&model.map.effects, &excitation))
    };
    let physics = ALL.iter().copied().filter(|id| id.is_physics());
    (physics.chain([EffectId::Unlisted]).chain(sensor::IN_ORDER))
        .flat_map(of_effect)
        .collect()
}

/// What a law may depend on, and whether it has only two values.
fn quantities(specimen: &CoSimulation) -> Vec<(Quantity, bool)> {
    let turns = (specimen.inputs.iter().enumerate())
        .filter(|(_, input)| !input.switches)
        .flat_map(|(k, input)| {
            let spread = specimen.spread(specimen.channels.len() + k);
            TURNS.map(|part| Quantity::SinceTurned(input.name.clone(), two_digits(part * spread)))
        })
        .filter(|quantity| matches!(quantity, Quantity::SinceTurned(_, most) if *most > 0.0));
    let further = turns.chain([Quantity::Time]).map(|quantity| (quantity, false));
    specimen.shown_quantities().into_iter().chain(further).collect()
}

/// A number with two digits, which a map shows.
fn two_digits(number: f64) -> f64 {
    format!("{number:.1e}").parse().unwrap_or(number)
}
