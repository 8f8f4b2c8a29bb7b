//! The gas exchanges heat with its wall: it is neither isothermal nor adiabatic.

use oleo_plant_sim::specimen::{Convection, GasHeatTransferTerm, GasSpringEffects, GasSpringModel};
use oleo_plant_sim::strut::{Equation, GasHeatTransfer as Term, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, GasSpring, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{Branch, EffectId, Site, SpecimenKind};

pub struct GasHeatTransfer;

/// Label of the form in which the gas gives its heat to the wall by free convection.
const FREE_CONVECTION: &str = "free convection";

impl Effect for GasHeatTransfer {
    fn id(&self) -> EffectId {
        EffectId::GasHeatTransfer
    }

    fn name(&self) -> &'static str {
        "gas heat transfer"
    }

    fn meaning(&self) -> &'static str {
        "compression warms the gas, which cools with the time constant tau"
    }

    fn meaning_in(&self, _kind: SpecimenKind, label: &str) -> &'static str {
        if label == FREE_CONVECTION {
            "compression warms the gas, which cools by free convection: tau is the time constant at a difference of 10 K and at the gas volume V_0 of displacement zero, and at others (10 K / |T - T_ambient|)^(1/3) (V_0 / V)^(1/3) times that"
        } else {
            self.meaning()
        }
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[
            ("time_constant_i_s", "tau"),
            ("time_constant_s", "tau"),
            ("time_constant_at_10_K_s", "tau"),
        ]
    }

    /// Each accumulator of a strut has a time constant of its own.
    fn reported(&self, site: &Site, count: usize) -> Vec<(Site, Vec<usize>)> {
        match site {
            Site::Accumulators => Branch::ALL
                .map(|branch| (Site::Accumulator(branch), vec![branch.number() - 1]))
                .to_vec(),
            one => vec![(one.clone(), (0..count).collect())],
        }
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }

    fn in_gas_spring(&self) -> Option<&dyn ActsOn<GasSpring>> {
        Some(self)
    }
}

impl ActsOn<Strut> for GasHeatTransfer {
    fn equation(&self) -> Equation {
        TermId::GasHeatTransfer.equation()
    }

    fn candidates(&self, model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.gas_heat_transfer.is_some() {
            return vec![];
        }
        let tau = |branch: Branch| Parameter::log(format!("time_constant_{}_s", branch.number()), 5.0, (0.02, 300.0));
        let starts = if excitation.valve3_holding_s > 0.0 {
            vec![vec![1.0, 1.5]]
        } else {
            vec![]
        };
        vec![Candidate::new(self.id(), Site::Accumulators, Branch::ALL.map(tau).to_vec()).starting_at(starts)]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.gas_heat_transfer = Some(Term {
            time_constant_1_s: values[0],
            time_constant_2_s: values[1],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "steps of 50 mm at 0.3 m/s held for 30 s, valves 1 and 2 open, once with valve 3 open and once with it closed",
            shows: "lets the pressure fall over several seconds while nothing moves, until the gas is at the temperature of its surroundings",
        }
    }
}

impl Concealed for GasHeatTransfer {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        // Faster gas is isothermal for all that a strut does.
        Some((0.5, 12.0))
    }

    fn conceal(&self, given: &mut StrutModel) {
        given.effects.gas_heat_transfer = None;
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        let second = amount * drawn.between(0, 1.4, 2.5);
        model.effects.gas_heat_transfer = Some(Term {
            time_constant_1_s: amount,
            time_constant_2_s: second,
        });
        let [one, two] = Branch::ALL.map(Site::Accumulator);
        vec![
            TrueNumber::new(one, "time_constant_1_s", amount),
            TrueNumber::new(two, "time_constant_2_s", second),
        ]
    }
}

impl ActsOn<GasSpring> for GasHeatTransfer {
    fn equation(&self) -> Equation {
        GasSpringEffects::GAS_HEAT_TRANSFER
    }

    fn candidates(&self, model: &GasSpringModel, _excitation: &excitation::GasSpring) -> Vec<Candidate> {
        if model.effects.gas_heat_transfer.is_some() {
            return vec![];
        }
        let form = |key: &str| {
            let time_constant = Parameter::log(key, 10.0, (0.02, 3000.0));
            Candidate::new(self.id(), Site::Chamber, vec![time_constant])
                .starting_at(vec![vec![1.0], vec![60.0]])
                .in_place_of(self.id())
        };
        vec![
            form("time_constant_s"),
            form("time_constant_at_10_K_s").labelled(FREE_CONVECTION),
        ]
    }

    fn put(&self, model: &mut GasSpringModel, candidate: &Candidate, values: &[f64]) {
        let is_free = candidate.label == FREE_CONVECTION;
        model.effects.gas_heat_transfer = Some(GasHeatTransferTerm {
            time_constant_s: values[0],
            convection: if is_free {
                Convection::Free
            } else {
                Convection::Constant
            },
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "steps of a third of the volume at the fastest speed, held until the pressure rests",
            shows: "lets the pressure fall exponentially while the piston is held, and changes nothing at the corners of the motion",
        }
    }
}
