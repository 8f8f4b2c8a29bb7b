//! Effects that all four corners have with one value.
//!
//! The oil and the gas of a vehicle are filled from the same source, and its four struts are of one design. An effect of these is
//! one effect of the vehicle if all corners have it and their estimates do not contradict each other (`pooling`). A leak, a friction, a charge or an instrument belongs to its corner whatever its value.

use oleo_interface::{Corner, Corners};

use super::pooling::Pooled;
use crate::diagnosis::{Effect, Estimate};
use crate::estimation::interval::HALF_INTERVAL;
use crate::vocabulary::EffectId;

/// No confidence is higher than this.
const MOST_CONFIDENT: f64 = 0.99;

/// Whether an effect is one of the oil, the gas or the design that the four struts share.
pub const fn is_shared(id: EffectId) -> bool {
    matches!(
        id,
        EffectId::OilCompressibility
            | EffectId::EntrainedAir
            | EffectId::RealGas
            | EffectId::GasHeatTransfer
            | EffectId::LineInertance
            | EffectId::LineResistance
            | EffectId::ValveDelay
            | EffectId::ValveTransition
            | EffectId::DampingFade
    )
}

/// An effect of all four corners.
#[derive(Debug, Clone)]
pub struct Common {
    /// Position of the effect among those of each corner.
    pub positions: Corners<usize>,
    /// Pooled parameters.
    pub parameters: Vec<Estimate>,
    /// Chance that the effect is there.
    pub confidence: f64,
}

/// The effects that all corners have with one value.
pub fn common(effects: &Corners<&[Effect]>) -> Vec<Common> {
    let first = effects[Corner::ALL[0]];
    (first.iter())
        .filter(|effect| is_shared(effect.id) && effect.selected.is_some())
        .filter_map(|effect| {
            let same = |corner: Corner| {
                (effects[corner].iter()).position(|other| {
                    (other.id, &other.place, &other.label) == (effect.id, &effect.place, &effect.label)
                })
            };
            let [a, b, c, d] = Corner::ALL.map(same);
            let positions = Corners::from_array([a?, b?, c?, d?]);
            let all = Corners::from_fn(|corner| &effects[corner][positions[corner]]);
            let parameters = (effect.parameters.iter().enumerate())
                .map(|(k, p)| {
                    let own = all.map(|e| e.parameters.get(k).filter(|own| own.key == p.key));
                    let [a, b, c, d] = own.into_array();
                    pooled(&[a?, b?, c?, d?])
                })
                .collect::<Option<Vec<_>>>()?;
            let absent: f64 = all.values().map(|e| 1.0 - e.confidence).product();
            Some(Common {
                positions,
                parameters,
                confidence: (1.0 - absent).min(MOST_CONFIDENT),
            })
        })
        .collect()
}

/// The mean of estimates weighted by their variances; `None` if they contradict each other. Numbers that are all positive are
/// compared by their logarithms, in which their intervals are symmetric.
fn pooled(estimates: &[&Estimate; 4]) -> Option<Estimate> {
    let positive = estimates.iter().all(|e| e.value > 0.0 && e.ci95[0] > 0.0);
    let to = |v: f64| if positive { libm::log(v) } else { v };
    let from = |v: f64| if positive { libm::exp(v) } else { v };
    let weighed = estimates.iter().map(|e| {
        let deviation = (to(e.ci95[1]) - to(e.ci95[0])) / (2.0 * HALF_INTERVAL);
        (to(e.value), deviation)
    });
    Pooled::of(weighed).map(|Pooled { mean, deviation }| Estimate {
        key: estimates[0].key.clone(),
        value: from(mean),
        ci95: [-1.0, 1.0].map(|side| from(mean + side * HALF_INTERVAL * deviation)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(value: f64, half: f64) -> Estimate {
        Estimate {
            key: "bulk_modulus_Pa".into(),
            value,
            ci95: [value - half, value + half],
        }
    }

    #[test]
    fn equal_values_are_pooled_and_one_that_differs_is_not() {
        let four = [1.40e9, 1.41e9, 1.39e9, 1.42e9].map(|v| estimate(v, 3e7));
        let all = pooled(&four.each_ref()).expect("they agree");
        assert!((all.value / 1.405e9 - 1.0).abs() < 1e-3, "{all:?}");
        // Four times the data halve the interval.
        assert!(((all.ci95[1] - all.ci95[0]) / 3e7 - 1.0).abs() < 0.05, "{all:?}");
        let odd = [1.40e9, 1.41e9, 1.39e9, 1.55e9].map(|v| estimate(v, 3e7));
        assert!(pooled(&odd.each_ref()).is_none());
        // The one that differs knows little.
        let mut vague = four;
        vague[3] = estimate(1.55e9, 4e8);
        assert!(pooled(&vague.each_ref()).is_some_and(|p| (p.value / 1.40e9 - 1.0).abs() < 5e-3));
    }

    #[test]
    fn an_estimate_without_an_interval_has_no_say() {
        let mut four = [1.0, 2.0, 1.0, 1.0].map(|v| estimate(v, 0.1));
        four[1].ci95 = [f64::NEG_INFINITY, f64::INFINITY];
        assert!(pooled(&four.each_ref()).is_some_and(|p| (p.value - 1.0).abs() < 1e-9));
    }
}
