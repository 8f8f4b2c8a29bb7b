//! The compressibility factor of a gas over its density, as the solver reads it.

use std::sync::Arc;

use super::argument::LawArgument;
use super::law::UnlistedLaw;
use super::path_laws::gas;
use crate::strut::characteristic::Characteristic;
use crate::strut::flow_path::FlowPath;

/// The factor never falls below this: a table that a fit tries must leave the gas a pressure.
const LEAST_FACTOR: f64 = 0.1;

/// The compressibility factor at ambient temperature over the density over the static one, and the part of it that attraction takes away.
#[derive(Debug, Clone)]
pub(in crate::strut) struct Compressibility {
    /// Shared, because every strut of a fit has it.
    table: Arc<Characteristic>,
    attraction: f64,
}

impl Compressibility {
    /// The law of the gas at the end of a path, if there is one.
    pub fn at(laws: &[UnlistedLaw], path: FlowPath) -> Option<Self> {
        gas(laws, path, LawArgument::RelativeDensity).map(|law| Self {
            table: Arc::new(law.characteristic()),
            attraction: law.attraction.unwrap_or(0.0),
        })
    }

    /// The factor at ambient temperature and a density over the static one, and its derivative by this.
    pub fn factor(&self, relative_density: f64) -> (f64, f64) {
        let (factor, slope) = self.table.at(relative_density, &mut 0);
        if factor < LEAST_FACTOR {
            (LEAST_FACTOR, 0.0)
        } else {
            (factor, slope)
        }
    }

    /// What attraction takes away of the factor at the static density and ambient temperature.
    pub fn attraction(&self) -> f64 {
        self.attraction
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::terms::LawPlace;

    #[test]
    fn a_gas_has_its_own_law_or_that_of_both_and_always_a_pressure() {
        let law = |place, value: [f64; 2], attraction| UnlistedLaw {
            place,
            depends_on: LawArgument::RelativeDensity,
            argument: vec![0.0, 2.0],
            value: value.to_vec(),
            time_constant_s: None,
            frequency_hz: None,
            presliding_volume_m3: None,
            attraction,
        };
        let laws = [
            law(LawPlace::Accumulators, [1.0, 0.8], Some(0.1)),
            law(LawPlace::Accumulator2, [1.0, 1.2], None),
        ];
        let [one, two] = FlowPath::ALL.map(|path| Compressibility::at(&laws, path).unwrap());
        assert_eq!((one.attraction(), two.attraction()), (0.1, 0.0));
        assert!((one.factor(1.0).0 - 0.9).abs() < 1e-12 && (two.factor(1.0).0 - 1.1).abs() < 1e-12);
        assert_eq!(one.factor(50.0), (0.1, 0.0));
        assert!(Compressibility::at(&[], FlowPath::One).is_none());
    }
}
