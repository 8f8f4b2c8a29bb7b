//! The traits of an effect: its texts, and what it does in each kind of specimen.

use oleo_plant_sim::specimen::{CylinderModel, GasSpringModel};
use oleo_plant_sim::strut::{Equation, StrutModel};

use super::candidate::Candidate;
use super::drawn::{Drawn, TrueNumber};
use super::relation;
use crate::excitation;
use crate::vocabulary::{EffectId, Site, SpecimenKind};

/// A law that a model may lack, or a fault of an instrument.
pub trait Effect: Sync {
    /// Id of the effect in the vocabulary.
    fn id(&self) -> EffectId;

    /// What it is called in a sentence: "gas heat transfer".
    fn name(&self) -> &'static str;

    /// What its equation means, as a main clause without capital and full stop. It explains the symbols of the equation.
    fn meaning(&self) -> &'static str;

    /// The symbol in the equation of each number that is reported, by its key. A key that counts places has `i` there:
    /// `time_constant_i_s`. Numbers that only say where an equation begins to hold have no symbol.
    fn symbols(&self) -> &'static [(&'static str, &'static str)];

    /// The symbol of a reported number; empty where the equation has none.
    fn symbol(&self, key: &str) -> Option<&'static str> {
        let counted = |known: &str| ["_1", "_2"].iter().any(|count| known.replace("_i", count) == key);
        let mut symbols = self.symbols().iter();
        symbols
            .find(|(known, _)| *known == key || counted(known))
            .map(|(_, symbol)| *symbol)
    }

    /// In which channels it shows.
    fn shows_in(&self) -> ShowsIn {
        ShowsIn::NextToItsPlace
    }

    /// The relation of the model that it changes at a site, in words.
    fn changed_relation(&self, site: &Site) -> String {
        relation::at(site)
    }

    /// A candidate at a site with `count` numbers as it is reported: one entry a place, with the numbers that belong to it.
    fn reported(&self, site: &Site, count: usize) -> Vec<(Site, Vec<usize>)> {
        vec![(site.clone(), (0..count).collect())]
    }

    /// One experiment on a strut that tells it from a rival better than the two effects' own experiments one after the
    /// other: what to record, and why. It is asked of both effects of a pair.
    fn told_from(&self, _rival: EffectId) -> Option<&'static str> {
        None
    }

    /// What it does in a strut, where it may be in one.
    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        None
    }

    /// What it does in a gas spring, where it may be in one.
    fn in_gas_spring(&self) -> Option<&dyn ActsOn<GasSpring>> {
        None
    }

    /// What it does in a cylinder, where it may be in one.
    fn in_cylinder(&self) -> Option<&dyn ActsOn<Cylinder>> {
        None
    }

    /// What it is called in a heading or a table; `label` tells laws without a name apart.
    fn named(&self, _kind: SpecimenKind, _label: &str) -> &'static str {
        self.name()
    }

    /// What it is called in running text, where laws without a name are called after what they relate.
    fn called(&self, _kind: SpecimenKind, _label: &str) -> String {
        self.name().to_owned()
    }

    /// Its equation in a kind of specimen, and the equation's source; `None` where it cannot be in one.
    fn equation_in(&self, kind: SpecimenKind, _label: &str) -> Option<Equation> {
        Some(match kind {
            SpecimenKind::TwoStageStrut => self.in_strut()?.equation(),
            SpecimenKind::GasSpring => self.in_gas_spring()?.equation(),
            SpecimenKind::Cylinder => self.in_cylinder()?.equation(),
        })
    }

    /// What to record in a kind of specimen to see it; `None` where it cannot be in one.
    fn experiment_in(&self, kind: SpecimenKind) -> Option<Experiment> {
        Some(match kind {
            SpecimenKind::TwoStageStrut => self.in_strut()?.experiment(),
            SpecimenKind::GasSpring => self.in_gas_spring()?.experiment(),
            SpecimenKind::Cylinder => self.in_cylinder()?.experiment(),
        })
    }
}

/// What an effect does in one kind of specimen.
pub trait ActsOn<K: Kind>: Sync {
    /// Its equation as the model of this kind computes it, and its source.
    fn equation(&self) -> Equation;

    /// The candidates that a search tries; none where the model has the effect already, whose numbers are then
    /// calibration.
    fn candidates(&self, model: &K::Model, excitation: &K::Excitation) -> Vec<Candidate>;

    /// Puts a candidate with the values of its parameters into a model.
    fn put(&self, model: &mut K::Model, candidate: &Candidate, values: &[f64]);

    /// The recording in which it shows best, and how.
    fn experiment(&self) -> Experiment;
}

/// How an effect is concealed in a simulated campaign of a self-test.
pub trait Concealed: Sync {
    /// How many variants there are to draw from: places, or ways to be there.
    fn variants(&self) -> usize {
        1
    }

    /// Smallest and largest amount of a variant; `None` for what is there or not.
    fn amounts(&self, variant: usize) -> Option<(f64, f64)>;

    /// The columns whose instruments are faulty; `None` for physics. Two faults of one instrument would be one.
    fn faulty_column(&self, _variant: usize) -> Option<&'static str> {
        None
    }

    /// Takes the effect out of what is believed, where a complete model has it.
    fn conceal(&self, _given: &mut StrutModel) {}

    /// Puts an amount of it into the true model and says the numbers that should be found; the first is its size.
    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber>;
}

/// What an effect of a strut does: it is searched for, and it is concealed in self-tests.
pub trait StrutEffect: ActsOn<Strut> + Concealed {}

impl<E: ActsOn<Strut> + Concealed> StrutEffect for E {}

/// A kind of specimen as effects see it.
pub trait Kind {
    /// What is believed of it.
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

/// The channels in which an effect shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShowsIn {
    /// Those next to the place where it acts.
    NextToItsPlace,
    /// All channels.
    EveryChannel,
}

/// A recording in which an effect shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Experiment {
    /// What to record: amplitude, speed and, of a strut, the state of its valves.
    pub record: &'static str,
    /// What the effect does in that recording that others do not: a clause without its subject, "stays in the force only".
    pub shows: &'static str,
}
