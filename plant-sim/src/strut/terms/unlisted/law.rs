//! An unmodelled law as a model file holds it: a table at a place, over a measured quantity.

use crate::strut::terms::equation::Equation;
use serde::{Deserialize, Serialize};

use super::argument::LawArgument;
use super::place::{LawForm, LawPlace};
use crate::model_file::limits::{as_many, increasing};
use crate::model_file::{Checked, InvalidValue, Limit, Range};
use crate::strut::characteristic::Characteristic;
use crate::strut::terms::accumulator_piston_friction::PRESLIDING_VOLUME_M3;

/// An unmodelled law: a table at a place, linear between its points and beyond its ends.
///
/// ```
/// use oleo_plant_sim::strut::{LawArgument, LawPlace, StrutModel, UnlistedLaw};
/// // Damper 1 is weaker in jounce than its table says: by a tenth at 50 mm.
/// let law = UnlistedLaw {
///     place: LawPlace::Pack1,
///     depends_on: LawArgument::Displacement,
///     argument: vec![0.0, 0.05],
///     value: vec![1.0, 0.9],
///     time_constant_s: None,
///     frequency_hz: None,
///     presliding_volume_m3: None,
///     attraction: None,
/// };
/// assert!((law.characteristic().value(0.025) - 0.95).abs() < 1e-15);
/// let mut model = StrutModel::defender110(8000.0);
/// model.effects.unlisted.push(law);
/// assert!(model.to_toml().contains("place = \"pack-1\""));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UnlistedLaw {
    /// Place where the law acts.
    pub place: LawPlace,
    /// What it depends on.
    pub depends_on: LawArgument,
    /// Values of what it depends on, strictly increasing, at least two; unit as [`LawArgument`] says.
    pub argument: Vec<f64>,
    /// Value of the law at each of them; unit and meaning as [`LawPlace`] says.
    pub value: Vec<f64>,
    /// Time constant of the law's memory, s; a law over what [is remembered](LawArgument::is_remembered) has one, others have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_constant_s: Option<f64>,
    /// Frequency of the oscillation, Hz; a law over [`LawArgument::Phase`] has one, others have none.
    #[serde(default, rename = "frequency_Hz", skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<f64>,
    /// Oil volume that shears the seal of a floating piston from rest to sliding, m3, 1e-12 to 1 (Dahl 1968). Only a law at a floating piston has
    /// one, and 1e-7 is meant where it has none. Where the term [`AccumulatorPistonFriction`](super::super::AccumulatorPistonFriction) is in the
    /// model too, its volume holds for both, because there is one seal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub presliding_volume_m3: Option<f64>,
    /// Part of the compressibility factor that the attraction of the molecules takes away at the static density and ambient temperature, 0 to 1,
    /// about 0.07 for nitrogen at 4.3 MPa. It grows with the density and falls with the temperature to the power 3/2 (Redlich & Kwong, Chem. Rev.
    /// 44(1), 1949); the other part does not change with the temperature. Only a law over [`LawArgument::RelativeDensity`] has one, and 0 is meant
    /// where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attraction: Option<f64>,
}

impl Checked for UnlistedLaw {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::list("argument", Range::Finite, "", |law| &law.argument),
        Limit::list("value", Range::Finite, "", |law| &law.value),
        Limit::optional("time_constant_s", Range::FromTo(1e-3, 1e6), "s", |law| {
            law.time_constant_s
        }),
        Limit::optional("frequency_Hz", Range::FromTo(1e-4, 1e3), "Hz", |law| law.frequency_hz),
        Limit::optional("presliding_volume_m3", PRESLIDING_VOLUME_M3, "m3", |law| {
            law.presliding_volume_m3
        }),
        Limit::optional("attraction", Range::FromTo(0.0, 1.0), "", |law| law.attraction),
    ];

    fn check_together(&self) -> Result<(), InvalidValue> {
        let known = self.place.arguments();
        if !known.contains(&self.depends_on) {
            let what = format!(
                "is {}, which a law at {} does not depend on: must be {}{}",
                word(&self.depends_on),
                word(&self.place),
                if known.len() == 1 { "" } else { "one of " },
                known.iter().map(word).collect::<Vec<_>>().join(", ")
            );
            return Err(InvalidValue::new("depends_on", what));
        }
        if self.depends_on.is_remembered() != self.time_constant_s.is_some() {
            let what = format!(
                "belongs to laws over {}, {}, {} and {}, and each of them needs one",
                word(&LawArgument::VolumeChange),
                word(&LawArgument::Energy),
                word(&LawArgument::RelativeEnergy),
                word(&LawArgument::ReadingChange)
            );
            return Err(InvalidValue::new("time_constant_s", what));
        }
        if (self.depends_on == LawArgument::Phase) != self.frequency_hz.is_some() {
            let what = format!(
                "belongs to laws over {}, and each of them needs one",
                word(&LawArgument::Phase)
            );
            return Err(InvalidValue::new("frequency_Hz", what));
        }
        if self.presliding_volume_m3.is_some() && !self.place.is_floating_piston() {
            let what = format!(
                "belongs to laws at {} and {}: no other place has a seal that is sheared by oil",
                word(&LawPlace::Accumulator1Friction),
                word(&LawPlace::Accumulator2Friction)
            );
            return Err(InvalidValue::new("presliding_volume_m3", what));
        }
        if self.attraction.is_some() && self.depends_on != LawArgument::RelativeDensity {
            let what = format!("belongs to laws over {}", word(&LawArgument::RelativeDensity));
            return Err(InvalidValue::new("attraction", what));
        }
        increasing("argument", &self.argument)?;
        if self.depends_on == LawArgument::Phase
            && !matches!(&self.argument[..], [first, .., last] if *first == 0.0 && *last == 1.0)
        {
            let what = format!(
                "must go from 0 to 1: a law over {} is one turn",
                word(&LawArgument::Phase)
            );
            return Err(InvalidValue::new("argument", what));
        }
        as_many("value", &self.value, "argument", &self.argument)?;
        if self.depends_on == LawArgument::FlowRate
            && !matches!((&self.argument[..], &self.value[..]), ([a, b], [c, d]) if *b == -a && *d == -c)
        {
            let what = format!(
                "must be two values of opposite sign, as those of argument: a law over {} is a line through the origin",
                word(&LawArgument::FlowRate)
            );
            return Err(InvalidValue::new("value", what));
        }
        if self.place.form(self.depends_on) == LawForm::AddedNotFalling
            && let Some(k) = (1..self.value.len()).find(|&k| self.value[k] < self.value[k - 1])
        {
            let what = format!(
                "is {}: a law at {} must not fall, and the entry before it is {}",
                self.value[k],
                word(&self.place),
                self.value[k - 1]
            );
            return Err(InvalidValue::new(k, what).inside("value"));
        }
        Ok(())
    }
}

/// A place or a quantity as the model file writes it.
pub(super) fn word(value: &impl Serialize) -> String {
    toml::Value::try_from(value).map_or_else(|_| String::new(), |value| value.to_string())
}

/// A law of this kind has its table in place of an equation.
pub const EQUATION: Equation = Equation {
    text: "the tabulated law",
    source: "fitted to the recordings; no name in the vocabulary",
};

impl UnlistedLaw {
    /// The table as the solver reads it.
    #[must_use]
    pub fn characteristic(&self) -> Characteristic {
        Characteristic::through(&self.argument, &self.value)
    }
}

/// Check the laws of a model: each for itself, and that no two act at the same place over the same quantity. A law that stands in the file is
/// read by the solver, or it is refused here.
///
/// # Errors
/// The first law that is wrong, with its position in the list.
pub(in crate::strut::terms) fn check_all(laws: &[UnlistedLaw]) -> Result<(), InvalidValue> {
    for (k, law) in laws.iter().enumerate() {
        law.check().map_err(|invalid| invalid.inside(k))?;
        let same = |other: &UnlistedLaw| other.place == law.place && other.depends_on == law.depends_on;
        if laws.iter().take(k).any(same) {
            let what = format!("is {}, which has a law already: keep one of them", word(&law.place));
            return Err(InvalidValue::new("place", what).inside(k));
        }
    }
    Ok(())
}

/// The table of the law at a place over a quantity, if there is one.
pub(in crate::strut) fn law_at(laws: &[UnlistedLaw], place: LawPlace, over: LawArgument) -> Option<Characteristic> {
    find(laws, place, over).map(UnlistedLaw::characteristic)
}

/// The law at a place over a quantity, if there is one.
pub(super) fn find(laws: &[UnlistedLaw], place: LawPlace, over: LawArgument) -> Option<&UnlistedLaw> {
    laws.iter().find(|law| law.place == place && law.depends_on == over)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(place: LawPlace, depends_on: LawArgument, value: [f64; 2]) -> UnlistedLaw {
        UnlistedLaw {
            place,
            depends_on,
            argument: vec![0.0, 1.0],
            value: value.to_vec(),
            time_constant_s: None,
            frequency_hz: None,
            presliding_volume_m3: None,
            attraction: None,
        }
    }

    #[test]
    fn a_law_that_the_solver_would_not_read_is_refused() {
        let good = law(LawPlace::Valves, LawArgument::PressureDrop, [1.0, 0.5]);
        let groove = law(LawPlace::BesidePack1, LawArgument::Displacement, [2e-7, 1e-7]);
        assert!(check_all(&[good.clone(), groove]).is_ok());
        let unread = law(LawPlace::Valve1, LawArgument::P1, [1.0, 0.5]);
        assert_eq!(
            check_all(&[good.clone(), unread]).unwrap_err().to_string(),
            "[2] depends_on is \"p1\", which a law at \"valve-1\" does not depend on: must be one of \"pressure_drop\", \"phase\""
        );
        assert!(
            check_all(&[good.clone(), good])
                .unwrap_err()
                .to_string()
                .contains("has a law already")
        );
        let (a, b) = (LawArgument::Speed, LawArgument::P1);
        let seal = [a, b].map(|over| law(LawPlace::MainSeal, over, [0.0, 1.0]));
        assert!(check_all(&seal).is_ok(), "laws over different quantities add");
    }

    #[test]
    fn a_resistance_that_falls_is_refused_where_a_factor_may_fall() {
        let falls = law(LawPlace::Path2, LawArgument::Flow, [1.0, 0.5]);
        let complaint = falls.check().unwrap_err().to_string();
        assert!(complaint.starts_with("value, entry 2, is 0.5"), "{complaint}");
        assert!(
            law(LawPlace::Pack2, LawArgument::Displacement, [1.0, 0.5])
                .check()
                .is_ok()
        );
    }

    #[test]
    fn a_mass_of_oil_is_a_line_through_the_origin() {
        let line = |argument: &[f64], value: &[f64]| UnlistedLaw {
            argument: argument.to_vec(),
            value: value.to_vec(),
            ..law(LawPlace::Path2, LawArgument::FlowRate, [0.0; 2])
        };
        assert!(line(&[-1.0, 1.0], &[-2e6, 2e6]).check().is_ok());
        assert!(line(&[-1.0, 1.0], &[0.0, 2e6]).check().is_err());
        assert!(line(&[-1.0, 0.0, 1.0], &[-2e6, 0.0, 2e6]).check().is_err());
    }

    #[test]
    fn a_memory_needs_its_time_constant_and_only_a_memory_has_one() {
        let remembering = law(LawPlace::Accumulator1, LawArgument::VolumeChange, [1.0, 0.5]);
        assert!(remembering.check().unwrap_err().to_string().contains("time_constant_s"));
        let with = |law: UnlistedLaw| UnlistedLaw {
            time_constant_s: Some(3.0),
            ..law
        };
        assert!(with(remembering).check().is_ok());
        assert!(
            with(law(LawPlace::Accumulator1, LawArgument::Time, [1.0, 0.5]))
                .check()
                .is_err()
        );
    }

    #[test]
    fn only_a_floating_piston_has_a_seal_that_oil_shears() {
        let with = |place, volume: f64| UnlistedLaw {
            presliding_volume_m3: Some(volume),
            ..law(place, LawArgument::RelativeVolume, [4e4, 4e4])
        };
        let good = with(LawPlace::Accumulator2Friction, 7e-7);
        assert!(good.check().is_ok());
        let toml = toml::to_string(&good).unwrap();
        assert!(toml.contains("presliding_volume_m3 = "), "{toml}");
        assert_eq!(toml::from_str::<UnlistedLaw>(&toml).unwrap(), good);
        // It may be left out.
        let without = law(LawPlace::Accumulator2Friction, LawArgument::RelativeVolume, [4e4, 4e4]);
        let toml = toml::to_string(&without).unwrap();
        assert!(
            !toml.contains("presliding_volume_m3") && without.check().is_ok(),
            "{toml}"
        );
        assert_eq!(toml::from_str::<UnlistedLaw>(&toml).unwrap(), without);
        assert_eq!(
            with(LawPlace::Accumulator2, 7e-7).check().unwrap_err().to_string(),
            "presliding_volume_m3 belongs to laws at \"accumulator-1-friction\" and \"accumulator-2-friction\": no other place has a seal that \
             is sheared by oil"
        );
        assert!(with(LawPlace::Accumulator1Friction, 0.0).check().is_err());
    }

    #[test]
    fn only_an_equation_of_state_has_an_attraction() {
        let good = UnlistedLaw {
            attraction: Some(0.07),
            ..law(LawPlace::Accumulators, LawArgument::RelativeDensity, [1.0, 0.98])
        };
        assert!(good.check().is_ok());
        let toml = toml::to_string(&good).unwrap();
        assert!(toml.contains("attraction = 0.07"), "{toml}");
        assert_eq!(toml::from_str::<UnlistedLaw>(&toml).unwrap(), good);
        let over_volume = UnlistedLaw {
            depends_on: LawArgument::RelativeVolume,
            ..good.clone()
        };
        assert_eq!(
            over_volume.check().unwrap_err().to_string(),
            "attraction belongs to laws over \"relative_density\""
        );
        let repelling = UnlistedLaw {
            attraction: Some(-0.1),
            ..good
        };
        assert!(repelling.check().is_err());
    }

    #[test]
    fn what_repeats_has_a_frequency_and_is_one_turn() {
        let bare = law(LawPlace::MainSeal, LawArgument::Phase, [1.0, 1.0]);
        assert!(bare.check().unwrap_err().to_string().contains("frequency_Hz"));
        let with = |law: UnlistedLaw| UnlistedLaw {
            frequency_hz: Some(0.7),
            ..law
        };
        let good = with(bare);
        assert!(good.check().is_ok());
        assert!(
            with(law(LawPlace::MainSeal, LawArgument::Time, [0.0, 1.0]))
                .check()
                .is_err()
        );
        let half = UnlistedLaw {
            argument: vec![0.0, 0.5],
            ..good.clone()
        };
        assert!(half.check().unwrap_err().to_string().contains("one turn"));
        let toml = toml::to_string(&good).unwrap();
        assert!(toml.contains("frequency_Hz = 0.7"), "{toml}");
        assert_eq!(toml::from_str::<UnlistedLaw>(&toml).unwrap(), good);
    }
}
