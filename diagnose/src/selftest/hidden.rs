//! What is concealed: an effect of the vocabulary in a drawn variant, with an amount that can be scaled, so that power can
//! be asked for over the size of the effect. How an effect is concealed the effect itself says.

use oleo_plant_sim::strut::StrutModel;
use serde::{Deserialize, Serialize};

use super::draw::Draw;
use crate::effect::{Drawn, StrutEffect, of};
use crate::vocabulary::{EffectId, Place};

/// A number of the truth, as the report would give it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Id of the effect in the vocabulary.
    pub id: EffectId,
    /// Place where the concealed effect acts.
    pub place: Place,
    /// Key with unit, empty for an effect without numbers.
    pub key: String,
    /// True value, in the unit of the key.
    pub value: f64,
}

/// A concealed effect whose amount is still open.
pub struct Hidden {
    /// Smallest and largest amount; `None` for what is there or not.
    pub range: Option<(f64, f64)>,
    id: EffectId,
    effect: &'static dyn StrutEffect,
    drawn: Drawn,
}

impl Hidden {
    /// Draws an effect of a strut whose complete nominal model is given, also its variant where that is open; `None` for an effect that
    /// struts do not have.
    #[must_use]
    pub fn draw(id: EffectId, variant: Option<usize>, complete: &StrutModel, draw: &mut Draw) -> Option<Self> {
        let effect = of(id).in_strut()?;
        let response = &complete.valve_timing.response_polynomial_s;
        let drawn = Drawn {
            variant: variant.unwrap_or_else(|| draw.index(effect.variants())),
            sign: if draw.uniform() < 0.5 { -1.0 } else { 1.0 },
            shape: std::array::from_fn(|_| draw.uniform()),
            response: std::array::from_fn(|k| response.get(k).copied().unwrap_or(0.0)),
        };
        Some(Self {
            range: effect.amounts(drawn.variant),
            id,
            effect,
            drawn,
        })
    }

    /// Column of a faulty instrument.
    #[must_use]
    pub fn column(&self) -> Option<&'static str> {
        self.effect.faulty_column(self.drawn.variant)
    }

    /// Takes the effect out of what is believed, where the complete model has it.
    pub fn conceal(&self, given: &mut StrutModel) {
        self.effect.conceal(given);
    }

    /// Puts the effect into the true model and says the numbers that should be found; the first is its size.
    pub fn put(&self, model: &mut StrutModel, amount: f64) -> Vec<Truth> {
        let numbers = self.effect.put_true(model, &self.drawn, amount);
        (numbers.into_iter())
            .map(|number| Truth {
                id: self.id,
                place: number.site.into(),
                key: number.key,
                value: number.value,
            })
            .collect()
    }
}
