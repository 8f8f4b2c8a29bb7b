//! A point of the search: which effects are in the model, and the coordinates of all its parameters.

use std::ops::Range;

use nalgebra::DVector;

use crate::parameter::Parameter;
use crate::specimen::{Hypothesis, Specimen};

/// The structure of a model and the coordinates of its parameters.
///
/// Coordinates `z` are of order one ([`Parameter`]); the calibration comes first, then the parameters of each effect in the
/// order of `effects`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Point {
    /// Indices of the candidates that are in the model.
    pub effects: Vec<usize>,
    /// Coordinates of all parameters.
    pub z: Vec<f64>,
}

impl Point {
    /// The model as believed: nominal calibration, no effect added.
    #[must_use]
    pub fn nominal(specimen: &dyn Specimen) -> Self {
        Self {
            effects: Vec::new(),
            z: vec![0.0; specimen.calibration().len()],
        }
    }

    /// The parameters, in the order of `z`.
    #[must_use]
    pub fn parameters<'s>(&self, specimen: &'s dyn Specimen) -> Vec<&'s Parameter> {
        let candidates = specimen.candidates();
        (specimen.calibration().iter())
            .chain(self.effects.iter().flat_map(|&e| &candidates[e].parameters))
            .collect()
    }

    /// Whether a coordinate matters beside the effects of this model.
    #[must_use]
    pub fn matters(&self, specimen: &dyn Specimen, coordinate: usize) -> bool {
        let candidates = specimen.candidates();
        let parameter = self.parameters(specimen)[coordinate];
        let needs = (parameter.only_beside.as_ref()).is_none_or(|beside| {
            let mut effects = self.effects.iter().map(|&e| &candidates[e]);
            effects.any(|effect| beside.is(effect.id, &effect.place))
        });
        needs && !self.is_replaced(specimen, coordinate)
    }

    /// Whether a coordinate is a calibration value in whose place an effect of this model stands.
    fn is_replaced(&self, specimen: &dyn Specimen, coordinate: usize) -> bool {
        let candidates = specimen.candidates();
        // A number of an effect may have the key of the calibration value that it replaces.
        (specimen.calibration().get(coordinate))
            .is_some_and(|p| self.effects.iter().any(|&e| candidates[e].replaces == Some(&p.key)))
    }

    /// Range of every coordinate. A calibration value of which an effect takes over a part is freed from its tolerance; one that an effect replaces stays at
    /// what is believed.
    #[must_use]
    pub fn ranges(&self, specimen: &dyn Specimen) -> Vec<(f64, f64)> {
        let candidates = specimen.candidates();
        let freed = |key: &str| (self.effects.iter()).any(|&e| candidates[e].takes_from == Some(key));
        (self.parameters(specimen).iter().enumerate())
            .map(|(k, p)| {
                if self.is_replaced(specimen, k) {
                    (0.0, 0.0)
                } else if freed(&p.key) {
                    p.z_range()
                } else {
                    p.tolerated_z_range()
                }
            })
            .collect()
    }

    /// Precision of the prior on every coordinate: 1 for what has a tolerance, 0 for what is free.
    #[must_use]
    pub fn prior(&self, specimen: &dyn Specimen) -> DVector<f64> {
        let parameters = self.parameters(specimen);
        DVector::from_iterator(
            parameters.len(),
            parameters.iter().map(|p| if p.prior { 1.0 } else { 0.0 }),
        )
    }

    /// Cost of departing from nominal.
    #[must_use]
    pub fn prior_cost(&self, specimen: &dyn Specimen) -> f64 {
        (self.parameters(specimen).iter().zip(&self.z))
            .filter(|(p, _)| p.prior)
            .map(|(_, z)| z * z)
            .sum()
    }

    /// Where the coordinates of the effect at a position of `effects` stand in `z`.
    #[must_use]
    pub fn coordinates_of(&self, specimen: &dyn Specimen, position: usize) -> Range<usize> {
        let count = |effect: &usize| specimen.candidates()[*effect].parameters.len();
        let from = specimen.calibration().len() + self.effects[..position].iter().map(count).sum::<usize>();
        from..from + count(&self.effects[position])
    }

    /// The same with one more effect, whose parameters have these values.
    #[must_use]
    pub fn with_effect(&self, specimen: &dyn Specimen, effect: usize, values: &[f64]) -> Self {
        let mut more = self.clone();
        more.effects.push(effect);
        let parameters = &specimen.candidates()[effect].parameters;
        more.z.extend(parameters.iter().zip(values).map(|(p, &v)| p.z(v)));
        more
    }

    /// The same without the effect at a position of `effects`.
    #[must_use]
    pub fn without_effect(&self, specimen: &dyn Specimen, position: usize) -> Self {
        let coordinates = self.coordinates_of(specimen, position);
        let mut less = self.clone();
        less.effects.remove(position);
        less.z.drain(coordinates);
        less
    }

    /// The model in values instead of coordinates.
    #[must_use]
    pub fn hypothesis(&self, specimen: &dyn Specimen) -> Hypothesis {
        let values = |parameters: &[Parameter], z: &[f64]| -> Vec<f64> {
            parameters.iter().zip(z).map(|(p, z)| p.value(*z)).collect()
        };
        let candidates = specimen.candidates();
        let effects = (self.effects.iter().enumerate())
            .map(|(position, &effect)| {
                let own = &self.z[self.coordinates_of(specimen, position)];
                (effect, values(&candidates[effect].parameters, own))
            })
            .collect();
        Hypothesis {
            calibration: values(specimen.calibration(), &self.z),
            effects,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRICTION, Recipe, VIBRATION};

    #[test]
    fn effects_come_and_go_with_their_own_coordinates() {
        let specimen = Recipe::default().make();
        let point = Point::nominal(&specimen)
            .with_effect(&specimen, CUBIC, &[0.2])
            .with_effect(&specimen, VIBRATION, &[0.1, 1.5])
            .with_effect(&specimen, FRICTION, &[0.05]);
        assert_eq!(point.coordinates_of(&specimen, 1), 3..5);
        assert_eq!(point.parameters(&specimen).len(), point.z.len());
        let values = |p: &Point| p.hypothesis(&specimen).effects;
        for (a, b) in
            values(&point)
                .iter()
                .zip([(CUBIC, vec![0.2]), (VIBRATION, vec![0.1, 1.5]), (FRICTION, vec![0.05])])
        {
            assert_eq!(a.0, b.0);
            assert!(a.1.iter().zip(&b.1).all(|(x, y)| (x - y).abs() < 1e-12), "{a:?} {b:?}");
        }
        let less = point.without_effect(&specimen, 1);
        assert_eq!(less.effects, [CUBIC, FRICTION]);
        assert_eq!(values(&less), [values(&point)[0].clone(), values(&point)[2].clone()]);
        assert_eq!(less.prior(&specimen).as_slice(), [1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn the_tolerance_of_a_number_that_an_effect_puts_right_is_not_fitted() {
        let mut specimen = Recipe::default().make();
        let key = specimen.calibration()[1].key.clone();
        // The effect's own number has the same key, and is fitted.
        specimen.take_key(CUBIC, &key);
        specimen.replace(CUBIC, key.leak());
        let nominal = Point::nominal(&specimen);
        let beside = nominal.with_effect(&specimen, CUBIC, &[0.2]);
        let fitted = |point: &Point| [0, 1].map(|k| (point.matters(&specimen, k), point.ranges(&specimen)[k]));
        let usual = specimen.calibration()[0].tolerated_z_range();
        assert_eq!(fitted(&nominal).map(|(matters, _)| matters), [true, true]);
        assert_eq!(fitted(&beside), [(true, usual), (false, (0.0, 0.0))]);
        let own = beside.coordinates_of(&specimen, 0).start;
        assert!(beside.matters(&specimen, own) && beside.ranges(&specimen)[own] != (0.0, 0.0));
    }
}
