//! Candidates: an effect at a place with the numbers to fit.

use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Place, Site};

/// A candidate of the search: an effect at a place that the model may lack.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Id of the effect in the vocabulary, `unlisted` for laws without a name.
    pub id: EffectId,
    /// Place where the candidate acts.
    pub place: Place,
    /// Label that distinguishes laws without a name, such as `force over speed`; empty for all other effects.
    pub label: String,
    /// Parameters to fit; none for an effect that is either present or absent.
    pub parameters: Vec<Parameter>,
    /// Further starting points of the fit, as values of the parameters.
    pub starts: Vec<Vec<f64>>,
    /// Key of a calibration value that was identified without the effect and holds a part of it.
    pub takes_from: Option<&'static str>,
    /// Key of a calibration value that is not fitted beside it: the tolerance of the number that it puts right.
    pub replaces: Option<&'static str>,
    /// The effect of fewer numbers that this one becomes at an end of its range.
    pub becomes: Option<EffectId>,
    /// Candidates of the same group exclude each other.
    pub group: Option<ExclusionGroup>,
    /// Whether it is a law without a name that excludes others only where their places overlap, so that a model can have two.
    pub one_of_several: bool,
    /// Whether it is a number of the model that is other than believed, and no law.
    pub is_believed_number: bool,
    /// When it may join a model.
    pub joins: Joins,
    /// Whether it swings in time at a frequency that is looked for in the residual. Its parameters are then amplitude, phase, rad, and
    /// frequency, Hz.
    pub oscillates: bool,
    /// Why the recordings cannot show the candidate; `None` if they can.
    pub untestable: Option<String>,
}

/// A group of candidates of which a model can contain only one, because they are different forms of one effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExclusionGroup(pub EffectId);

/// When a candidate may join a model. Those of many numbers or many starts would be screened slowly, and mostly in vain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joins {
    /// When it is screened and explains most.
    Screened,
    /// When nothing else joins, or in the place of an effect that leaves much behind.
    AtLast,
    /// In the place of such an effect only.
    InPlace,
}

impl Candidate {
    /// A candidate: an effect at a site of a specimen with the parameters to fit.
    #[must_use]
    pub fn new(id: EffectId, site: Site, parameters: Vec<Parameter>) -> Self {
        Self {
            id,
            place: site.into(),
            label: String::new(),
            parameters,
            starts: vec![],
            takes_from: None,
            replaces: None,
            becomes: None,
            group: None,
            one_of_several: false,
            is_believed_number: false,
            joins: Joins::Screened,
            oscillates: false,
            untestable: None,
        }
    }

    /// The candidate with a label.
    #[must_use]
    pub fn labelled(self, label: &str) -> Self {
        Self {
            label: label.to_owned(),
            ..self
        }
    }

    /// The candidate with further starting points.
    #[must_use]
    pub fn starting_at(self, starts: Vec<Vec<f64>>) -> Self {
        Self { starts, ..self }
    }

    /// The candidate that takes over a part of what a calibration value stands for.
    #[must_use]
    pub fn taking_from(self, key: &'static str) -> Self {
        Self {
            takes_from: Some(key),
            ..self
        }
    }

    /// The candidate that becomes another effect at an end of its range.
    #[must_use]
    pub fn becoming(self, id: EffectId) -> Self {
        Self {
            becomes: Some(id),
            ..self
        }
    }

    /// The candidate in the exclusion group of an effect.
    #[must_use]
    pub fn in_place_of(self, id: EffectId) -> Self {
        Self {
            group: Some(ExclusionGroup(id)),
            ..self
        }
    }

    /// The candidate in an exclusion group, if there is one for it.
    #[must_use]
    pub fn in_group(self, group: Option<ExclusionGroup>) -> Self {
        Self { group, ..self }
    }

    /// The candidate as a law beside which a model can have another one at another place.
    #[must_use]
    pub fn beside_others(self) -> Self {
        Self {
            one_of_several: true,
            ..self
        }
    }

    /// The candidate as a number of the model that is other than believed, and the key of the calibration value that is the tolerance of this number.
    #[must_use]
    pub fn of_believed_number(self, tolerance: Option<&'static str>) -> Self {
        Self {
            is_believed_number: true,
            replaces: tolerance,
            ..self
        }
    }

    /// The candidate as one that joins a model at another time.
    #[must_use]
    pub fn joining(self, joins: Joins) -> Self {
        Self { joins, ..self }
    }

    /// The candidate as one that swings in time.
    #[must_use]
    pub fn oscillating(self, oscillates: bool) -> Self {
        Self { oscillates, ..self }
    }

    /// The candidate with a reason why the recordings cannot show it, if there is one. A later reason replaces an earlier one.
    #[must_use]
    pub fn testable_unless(self, reason: Option<String>) -> Self {
        Self {
            untestable: reason.or(self.untestable),
            ..self
        }
    }

    /// Whether the vocabulary has no name for the candidate: a law, or a number of the model that is other than believed.
    #[must_use]
    pub fn is_unlisted(&self) -> bool {
        self.id == EffectId::Unlisted
    }

    /// Whether the candidate is a law without a name.
    #[must_use]
    pub fn is_law(&self) -> bool {
        self.is_unlisted() && !self.is_believed_number
    }

    /// Whether the candidate is a sensor fault, which is judged before physics.
    #[must_use]
    pub const fn is_instrument_fault(&self) -> bool {
        self.id.is_instrument_fault()
    }

    /// Whether the two cannot be in one model. This holds for members of one group, for two faults of one sensor, which can
    /// replace each other (a short lag is nearly a skew), and for two laws without a name at one place, where two tables take the shape of a third.
    /// It holds for a fault of a sensor and a law of the same sensor, too: their sum is a third law.
    #[must_use]
    pub fn excludes(&self, other: &Self) -> bool {
        (self.group.is_some() && self.group == other.group)
            || (self.is_instrument_fault() && other.is_instrument_fault() && self.place == other.place)
            || (self.one_of_several && other.one_of_several && self.place.overlaps(&other.place))
            || (self.is_fault_beside_law(other) || other.is_fault_beside_law(self))
    }

    fn is_fault_beside_law(&self, other: &Self) -> bool {
        self.is_instrument_fault() && other.one_of_several && self.place == other.place
    }

    /// True if these values leave the model as it is: the candidate has a size, and each number that is one is zero.
    #[must_use]
    pub fn absent_at(&self, values: &[f64]) -> bool {
        let has_size = self.parameters.iter().any(|p| p.is_size);
        has_size && (self.parameters.iter().zip(values)).all(|(p, v)| !p.is_size || *v == 0.0)
    }

    /// The values that a fit of it starts from: first those of its parameters, then the others.
    #[must_use]
    pub fn all_starts(&self) -> Vec<Vec<f64>> {
        let own = self.parameters.iter().map(|p| p.start).collect();
        std::iter::once(own).chain(self.starts.iter().cloned()).collect()
    }

    /// Values with each number that is a size made zero: what is left is the shape.
    #[must_use]
    pub fn without_sizes(&self, values: &[f64]) -> Vec<f64> {
        (self.parameters.iter().zip(values))
            .map(|(p, value)| if p.is_size { 0.0 } else { *value })
            .collect()
    }

    /// Values to start from beside another candidate with these values: its own under the keys that both have.
    #[must_use]
    pub fn values_shared_with(&self, other: &Self, values: &[f64]) -> Vec<f64> {
        let known = |key: &str| (other.parameters.iter().zip(values)).find_map(|(p, v)| (p.key == key).then_some(*v));
        (self.parameters.iter())
            .map(|p| known(&p.key).unwrap_or(p.start))
            .collect()
    }

    /// Id, place and label as one text, which is unique among the candidates.
    #[must_use]
    pub fn name(&self) -> String {
        if self.label.is_empty() {
            format!("{}@{}", self.id, self.place)
        } else {
            format!("{}@{} ({})", self.id, self.place, self.label)
        }
    }

    /// The place, with the label if there is one.
    #[must_use]
    pub fn place_and_label(&self) -> String {
        if self.label.is_empty() {
            self.place.to_string()
        } else {
            format!("{} ({})", self.place, self.label)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vocabulary::Column;

    #[test]
    fn a_fault_and_a_law_of_one_instrument_exclude_each_other() {
        let at = |id, column: &str| Candidate::new(id, Site::Sensor(Column::named(column.to_owned())), vec![]);
        let drift = at(EffectId::SensorDrift, "p1_Pa");
        let law = |column| at(EffectId::Unlisted, column).beside_others();
        assert!(drift.excludes(&law("p1_Pa")) && law("p1_Pa").excludes(&drift));
        assert!(!drift.excludes(&law("p2_Pa")) && !law("p2_Pa").excludes(&drift));
    }

    #[test]
    fn only_sizes_say_whether_an_effect_is_there() {
        // A groove at displacement 0, and a stop without progression: both are there although a number of theirs is zero.
        let groove = vec![
            Parameter::amount("flow_coefficient", 1e-8, 1e-4),
            Parameter::linear("position_m", 0.0, 0.004, (-0.09, 0.09)),
        ];
        let groove = Candidate::new(EffectId::Unlisted, Site::Unknown, groove);
        assert!(groove.absent_at(&[0.0, 0.0]) && groove.absent_at(&[0.0, 0.03]) && !groove.absent_at(&[3e-7, 0.0]));
        let stop = vec![
            Parameter::amount("stiffness_N_m", 1e4, 1e8),
            Parameter::amount("progression_N_m3", 1e8, 1e13),
        ];
        let stop = Candidate::new(EffectId::BumpStop, Site::EndStop, stop);
        assert!(stop.absent_at(&[0.0, 0.0]) && !stop.absent_at(&[1e4, 0.0]) && !stop.absent_at(&[0.0, 1e8]));
        let heat = vec![Parameter::log("time_constant_s", 5.0, (0.1, 100.0))];
        assert!(!Candidate::new(EffectId::GasHeatTransfer, Site::Chamber, heat).absent_at(&[5.0]));
    }

    #[test]
    fn a_candidate_starts_from_the_numbers_that_it_shares() {
        let with = |keys: &[&str]| {
            let parameters = keys.iter().map(|key| Parameter::log(*key, 0.5, (0.1, 9.0))).collect();
            Candidate::new(EffectId::Unlisted, Site::Unknown, parameters)
        };
        let other = with(&["a", "b"]);
        assert_eq!(with(&["b", "c"]).values_shared_with(&other, &[2.0, 3.0]), [3.0, 0.5]);
    }
}
