//! The traits of an effect: its texts, and what it does in each kind of specimen.

use oleo_plant_sim::specimen::{CylinderModel, GasSpringModel, MechanismEffects};
use oleo_plant_sim::strut::{Equation, StrutModel};

use super::candidate::Candidate;
use super::drawn::{Drawn, TrueNumber};
use super::relation;
use crate::correction::Corrections;
use crate::excitation;
use crate::vocabulary::{EffectId, Site, SpecimenKind};

/// An effect: a law that a model may lack, or a sensor fault.
pub trait Effect: Sync {
    /// Id of the effect in the vocabulary.
    fn id(&self) -> EffectId;

    /// Name of the effect in a sentence, such as "gas heat transfer".
    fn name(&self) -> &'static str;

    /// Meaning of its equation, as a main clause without capital and full stop. It explains the symbols of the equation.
    fn meaning(&self) -> &'static str;

    /// The same in a kind of specimen; `label` distinguishes what has no name.
    fn meaning_in(&self, _kind: SpecimenKind, _label: &str) -> &'static str {
        self.meaning()
    }

    /// Symbol in the equation for each reported parameter, by its key. In a key that counts places the number is written `i`:
    /// `time_constant_i_s`. Parameters that only state where an equation begins to hold have no symbol.
    fn symbols(&self) -> &'static [(&'static str, &'static str)];

    /// Symbol of a reported parameter; empty if the equation has none.
    fn symbol(&self, key: &str) -> Option<&'static str> {
        let counted = |known: &str| ["_1", "_2"].iter().any(|count| known.replace("_i", count) == key);
        let mut symbols = self.symbols().iter();
        symbols
            .find(|(known, _)| *known == key || counted(known))
            .map(|(_, symbol)| *symbol)
    }

    /// The same for a law without a name, whose symbols are those of its form.
    fn symbol_in(&self, _kind: SpecimenKind, _label: &str, key: &str) -> Option<&'static str> {
        self.symbol(key)
    }

    /// The channels in which the effect shows.
    fn shows_in(&self) -> ShowsIn {
        ShowsIn::NextToItsPlace
    }

    /// The relation of the model that the effect changes at a site, in words.
    fn changed_relation(&self, site: &Site) -> String {
        relation::at(site)
    }

    /// How a candidate at a site with `count` parameters is reported: one entry for each place, with the indices of the
    /// parameters that belong to it.
    fn reported(&self, site: &Site, count: usize) -> Vec<(Site, Vec<usize>)> {
        vec![(site.clone(), (0..count).collect())]
    }

    /// An experiment on a strut that separates the effect from a rival better than the own experiments of the two, one after
    /// the other: what to record, and why. Both effects of a pair are queried.
    fn told_from(&self, _rival: EffectId) -> Option<&'static str> {
        None
    }

    /// What the effect does in a strut; `None` if it cannot occur in one.
    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        None
    }

    /// What the effect does in a gas spring; `None` if it cannot occur in one.
    fn in_gas_spring(&self) -> Option<&dyn ActsOn<GasSpring>> {
        None
    }

    /// What the effect does in a cylinder; `None` if it cannot occur in one.
    fn in_cylinder(&self) -> Option<&dyn ActsOn<Cylinder>> {
        None
    }

    /// What the effect does in a damper or a drive; `None` if it cannot occur in one.
    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        None
    }

    /// What the effect does around somebody else's model; `None` if it cannot be added from outside.
    fn in_co_simulation(&self) -> Option<&dyn ActsOn<CoSimulation>> {
        None
    }

    /// Name in a heading or a table; `label` distinguishes laws without a name.
    fn named(&self, _kind: SpecimenKind, _label: &str) -> &'static str {
        self.name()
    }

    /// Name in running text, in which a law without a name is followed by its label.
    fn called(&self, _kind: SpecimenKind, _label: &str) -> String {
        self.name().to_owned()
    }

    /// The equation in a kind of specimen and its source; `None` if the effect cannot occur in this kind.
    fn equation_in(&self, kind: SpecimenKind, _label: &str) -> Option<Equation> {
        Some(match kind {
            SpecimenKind::TwoStageStrut => self.in_strut()?.equation(),
            SpecimenKind::GasSpring => self.in_gas_spring()?.equation(),
            SpecimenKind::Cylinder => self.in_cylinder()?.equation(),
            SpecimenKind::Damper | SpecimenKind::Drive => self.in_mechanism()?.equation(),
            SpecimenKind::CoSimulation => self.in_co_simulation()?.equation(),
        })
    }

    /// What to record to detect the effect in a kind of specimen; `None` if it cannot occur in this kind.
    fn experiment_in(&self, kind: SpecimenKind) -> Option<Experiment> {
        Some(match kind {
            SpecimenKind::TwoStageStrut => self.in_strut()?.experiment(),
            SpecimenKind::GasSpring => self.in_gas_spring()?.experiment(),
            SpecimenKind::Cylinder => self.in_cylinder()?.experiment(),
            SpecimenKind::Damper | SpecimenKind::Drive => self.in_mechanism()?.experiment(),
            SpecimenKind::CoSimulation => self.in_co_simulation()?.experiment(),
        })
    }
}

/// What an effect does in one kind of specimen.
pub trait ActsOn<K: Kind>: Sync {
    /// The equation as the model of this kind computes it, and its source.
    fn equation(&self) -> Equation;

    /// The candidates that the search tries. There are none if the model already has the effect; its parameters are then part
    /// of the calibration.
    fn candidates(&self, model: &K::Model, excitation: &K::Excitation) -> Vec<Candidate>;

    /// Puts a candidate with the values of its parameters into a model.
    fn put(&self, model: &mut K::Model, candidate: &Candidate, values: &[f64]);

    /// The recording in which the effect shows best, and how it shows.
    fn experiment(&self) -> Experiment;
}

/// How an effect is concealed in a simulated campaign of a self-test.
pub trait Concealed: Sync {
    /// Number of variants to draw from, such as places.
    fn variants(&self) -> usize {
        1
    }

    /// Smallest and largest amount of a variant; `None` for an effect that is either present or absent.
    fn amounts(&self, variant: usize) -> Option<(f64, f64)>;

    /// The column whose sensor is faulty; `None` for physics. A campaign has at most one fault for each sensor.
    fn faulty_column(&self, _variant: usize) -> Option<&'static str> {
        None
    }

    /// Removes the effect from the given model if a complete model has it.
    fn conceal(&self, _given: &mut StrutModel) {}

    /// Puts an amount of the effect into the true model, and returns the values that should be found; the first one is its size.
    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber>;
}

/// An effect of a strut, which can be searched for and concealed in self-tests.
pub trait StrutEffect: ActsOn<Strut> + Concealed {}

impl<E: ActsOn<Strut> + Concealed> StrutEffect for E {}

/// A kind of specimen: the types of its model and of what its recordings excite.
pub trait Kind {
    /// Type of the given model.
    type Model;
    /// What the recordings of this kind excite.
    type Excitation;
}

/// The kind of specimen "two-stage hydropneumatic strut".
pub struct Strut;

impl Kind for Strut {
    type Model = StrutModel;
    type Excitation = excitation::Strut;
}

/// The kind of specimen "gas spring".
pub struct GasSpring;

impl Kind for GasSpring {
    type Model = GasSpringModel;
    type Excitation = excitation::GasSpring;
}

/// The kind of specimen "cylinder".
pub struct Cylinder;

impl Kind for Cylinder {
    type Model = CylinderModel;
    type Excitation = excitation::Cylinder;
}

/// The kinds of specimen "damper" and "drive", whose models have the same effects.
pub struct Mechanism;

impl Kind for Mechanism {
    type Model = MechanismEffects;
    type Excitation = excitation::Mechanism;
}

/// The kind of specimen "co-simulation model", to which everything is added from outside.
pub struct CoSimulation;

impl Kind for CoSimulation {
    type Model = Corrections;
    type Excitation = excitation::CoSimulation;
}

/// The channels in which an effect shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShowsIn {
    /// The channels next to the place where the effect acts.
    NextToItsPlace,
    /// All channels.
    EveryChannel,
}

/// A recording in which an effect shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Experiment {
    /// What to record: amplitude, speed and, for a strut, the state of its valves.
    pub record: &'static str,
    /// What distinguishes the effect in this recording: a clause without its subject, such as "stays in the force only".
    pub shows: &'static str,
}
