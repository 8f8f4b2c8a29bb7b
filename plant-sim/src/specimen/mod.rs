//! Test specimens simpler than the strut: a gas spring and a cylinder, as found on other people's test machines.
//!
//! They share the strut's physics (energy equation of the gas, friction of the seal) and its vocabulary of effects, so
//! that a diagnosis learnt on one is checked on the others.

mod cylinder;
mod gas_spring;

use serde::{Deserialize, Serialize};

use crate::strut::SensorEffect;

pub use cylinder::{CylinderChamber, CylinderEffects, CylinderModel, CylinderSeal, SmoothedMotion, smooth_motion};
pub use gas_spring::{GasHeatTransferTerm, GasProcess, GasSpringEffects, GasSpringGas, GasSpringModel, SpringChamber};

/// Which specimen a model file is of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SpecimenName {
    /// Name of the individual.
    pub name: String,
    /// Kind, for example `gas spring`.
    pub kind: String,
}

/// The `[specimen]` table of any model file.
///
/// # Errors
/// One line: source, line where known, what.
pub fn specimen_name(text: &str, source: &str) -> Result<SpecimenName, String> {
    #[derive(Deserialize)]
    struct Head {
        specimen: SpecimenName,
    }
    toml::from_str::<Head>(text)
        .map(|h| h.specimen)
        .map_err(|e| toml_message(text, source, &e))
}

/// One line for a TOML error: source, line, what.
pub(crate) fn toml_message(text: &str, source: &str, error: &toml::de::Error) -> String {
    let line = error
        .span()
        .map_or(0, |s| text[..s.start.min(text.len())].matches('\n').count() + 1);
    format!(
        "{source}, line {line}: {}",
        error.message().lines().next().unwrap_or("not valid TOML")
    )
}

/// Checks what a model says of its instruments: tolerances and noise not negative, faults finite.
pub(crate) fn instruments(
    source: &str,
    tolerance: &SensorEffect,
    noise: &SensorEffect,
    faults: &[(&str, &Option<SensorEffect>)],
) -> Result<(), String> {
    for (key, value) in tolerance {
        within(source, &format!("tolerance.{key}"), *value, 0.0, 1e12)?;
    }
    for (key, value) in noise {
        within(source, &format!("noise.{key}"), *value, 0.0, 1e12)?;
    }
    for (name, fault) in faults {
        for (key, value) in fault.iter().flatten() {
            within(source, &format!("effects.{name}.{key}"), *value, -1e12, 1e12)?;
        }
    }
    Ok(())
}

/// Checks that a number lies in a range.
pub(crate) fn within(source: &str, key: &str, value: f64, lower: f64, upper: f64) -> Result<(), String> {
    if value.is_finite() && value >= lower && value <= upper {
        Ok(())
    } else {
        Err(format!("{source}, key {key}: {value} is outside {lower} to {upper}"))
    }
}
