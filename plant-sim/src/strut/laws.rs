//! Laws without a name, as the solver reads them: tables at places of the network, linear between points and beyond.
//!
//! A table is a number over one quantity. What the number does follows from the place: it is added (a force, a volume, a
//! flow, a drop), or it multiplies what the model believed (a damper's drop, a valve's flow, a gas pressure).

use super::characteristic::Characteristic;
use super::effects::{LawArgument, LawPlace, UnlistedLaw};

/// A factor never falls below this part of what was believed: an element does not turn round.
const LEAST_FACTOR: f64 = 0.01;

/// The laws of one path.
#[derive(Debug, Clone, Default)]
pub(super) struct PathLaws {
    /// Drop in series over flow, Pa.
    pub series: Option<Characteristic>,
    /// Flow beside the pack over its drop, m3/s.
    pub parallel: Option<Characteristic>,
    /// Flow coefficient beside the pack over displacement.
    bypass: Option<Characteristic>,
    /// Factor on the pack's drop over displacement.
    strength: Option<Characteristic>,
    /// Factor on the bypass valve's flow over the size of its drop.
    throttle: Option<Characteristic>,
    /// Factor on the gas pressure over volume.
    pub gas: Option<Characteristic>,
}

/// Quantities that a law at a place may depend on; what is not here, the solver would not read.
pub(super) fn arguments(place: LawPlace) -> &'static [LawArgument] {
    match place {
        LawPlace::MainSeal | LawPlace::MainSealFriction => {
            &[LawArgument::Displacement, LawArgument::Speed, LawArgument::P1]
        }
        LawPlace::MainChamber | LawPlace::MainChamberLoss => &[LawArgument::P1],
        LawPlace::Path1 | LawPlace::Path2 => &[LawArgument::Flow],
        LawPlace::BesidePack1 | LawPlace::BesidePack2 => &[LawArgument::PressureDrop, LawArgument::Displacement],
        LawPlace::Pack1 | LawPlace::Pack2 => &[LawArgument::Displacement],
        LawPlace::Valve1 | LawPlace::Valve2 | LawPlace::Valve3 | LawPlace::Valves => &[LawArgument::PressureDrop],
        LawPlace::Accumulator1 | LawPlace::Accumulator2 => &[LawArgument::RelativeVolume],
    }
}

/// A place or a quantity as the model file writes it.
fn word(value: &impl serde::Serialize) -> String {
    toml::Value::try_from(value).map_or_else(|_| String::new(), |v| v.to_string())
}

/// What is wrong with the laws of a model, if anything: the key and what to do. Nothing that stands there is left unread.
pub(super) fn check(laws: &[UnlistedLaw]) -> Result<(), (String, String)> {
    for (k, law) in laws.iter().enumerate() {
        let known = arguments(law.place);
        if !known.contains(&law.depends_on) {
            let list: Vec<String> = known.iter().map(word).collect();
            let what = format!(
                "is {}, which a law at {} does not depend on: one of {}",
                word(&law.depends_on),
                word(&law.place),
                list.join(", ")
            );
            return Err(("depends_on".into(), what));
        }
        // The seal has one law of each kind; everywhere else a place has one for each quantity.
        let one = matches!(law.place, LawPlace::MainSeal | LawPlace::MainSealFriction);
        let same = |other: &UnlistedLaw| other.place == law.place && (one || other.depends_on == law.depends_on);
        if laws[..k].iter().any(same) {
            return Err((
                "place".into(),
                format!("{} has a law already: keep one", word(&law.place)),
            ));
        }
    }
    Ok(())
}

/// The table at a place over a quantity, if the model has one.
pub(super) fn law_at(laws: &[UnlistedLaw], place: LawPlace, over: LawArgument) -> Option<Characteristic> {
    laws.iter()
        .find(|l| l.place == place && l.depends_on == over)
        .map(|l| Characteristic::through(&l.argument, &l.value))
}

/// A valve's law is its own or the one of all three.
pub(super) fn throttle_of(laws: &[UnlistedLaw], valve: usize) -> Option<Characteristic> {
    let own = [LawPlace::Valve1, LawPlace::Valve2, LawPlace::Valve3][valve];
    law_at(laws, own, LawArgument::PressureDrop).or_else(|| law_at(laws, LawPlace::Valves, LawArgument::PressureDrop))
}

/// Factor of a throttle at a drop.
#[inline]
pub(super) fn throttled(law: &Characteristic, drop_pa: f64) -> f64 {
    law.value(drop_pa.abs()).max(LEAST_FACTOR)
}

impl PathLaws {
    pub fn of(laws: &[UnlistedLaw], path: usize) -> Self {
        let pick = |a: [LawPlace; 2], over| law_at(laws, a[path], over);
        Self {
            series: pick([LawPlace::Path1, LawPlace::Path2], LawArgument::Flow),
            parallel: pick(
                [LawPlace::BesidePack1, LawPlace::BesidePack2],
                LawArgument::PressureDrop,
            ),
            bypass: pick(
                [LawPlace::BesidePack1, LawPlace::BesidePack2],
                LawArgument::Displacement,
            ),
            strength: pick([LawPlace::Pack1, LawPlace::Pack2], LawArgument::Displacement),
            throttle: throttle_of(laws, path),
            gas: pick(
                [LawPlace::Accumulator1, LawPlace::Accumulator2],
                LawArgument::RelativeVolume,
            ),
        }
    }

    /// Flow coefficient beside the pack at a displacement.
    #[inline]
    pub fn bypass(&self, displacement_m: f64) -> f64 {
        self.bypass.as_ref().map_or(0.0, |l| l.value(displacement_m).max(0.0))
    }

    /// What the believed drop of the pack is divided by at a displacement.
    #[inline]
    pub fn weakening(&self, displacement_m: f64) -> f64 {
        self.strength
            .as_ref()
            .map_or(1.0, |l| 1.0 / l.value(displacement_m).max(LEAST_FACTOR))
    }

    /// Part of the bypass valve's flow that a drop does not let pass.
    #[inline]
    pub fn throttled_away(&self, drop_pa: f64) -> f64 {
        self.throttle.as_ref().map_or(0.0, |l| 1.0 - throttled(l, drop_pa))
    }
}
