//! Laws without a name: a table at a place of the network, over a quantity that is measured there.
//!
//! What the vocabulary does not name can still be found and placed: a force at the seal over displacement, speed or
//! pressure; a volume of the main chamber over pressure; a drop in series with a path or a flow beside its damper.
//! Values are increments from knot to knot outwards from rest, so that the order a physical law needs (more flow, more
//! drop) is a bound and not a wish.

use oleo_plant_sim::strut::{LawArgument, LawPlace, UnlistedLaw};

use super::excitation::Excitation;
use crate::parameter::Parameter;
use crate::specimen::Candidate;

/// One kind of law.
struct Kind {
    label: &'static str,
    place: &'static str,
    law: LawPlace,
    argument: LawArgument,
    /// Knots; one of them is the rest value, where the law is zero.
    knots: &'static [f64],
    /// Size of one increment that would be visible.
    scale: f64,
    monotone: bool,
}

const P: f64 = 1e6;
const KINDS: [Kind; 8] = [
    Kind {
        label: "force over displacement",
        place: "main-seal",
        law: LawPlace::MainSeal,
        argument: LawArgument::Displacement,
        knots: &[-0.09, -0.06, -0.03, 0.0, 0.03, 0.06, 0.09],
        scale: 20.0,
        monotone: false,
    },
    Kind {
        label: "force over speed",
        place: "main-seal",
        law: LawPlace::MainSeal,
        argument: LawArgument::Speed,
        knots: &[-0.6, -0.2, -0.05, -0.005, 0.0, 0.005, 0.05, 0.2, 0.6],
        scale: 20.0,
        monotone: false,
    },
    Kind {
        label: "force over pressure",
        place: "main-seal",
        law: LawPlace::MainSeal,
        argument: LawArgument::P1,
        knots: &[0.0, 2.0 * P, 4.0 * P, 6.0 * P, 9.0 * P, 13.0 * P],
        scale: 20.0,
        monotone: false,
    },
    Kind {
        label: "volume over pressure",
        place: "main-chamber",
        law: LawPlace::MainChamber,
        argument: LawArgument::P1,
        knots: &[0.0, P, 2.0 * P, 4.0 * P, 7.0 * P, 13.0 * P],
        scale: 5e-8,
        monotone: true,
    },
    Kind {
        label: "series drop over flow, path 1",
        place: "path-1",
        law: LawPlace::Path1,
        argument: LawArgument::Flow,
        knots: &[-1.5e-3, -5e-4, -1.5e-4, 0.0, 1.5e-4, 5e-4, 1.5e-3],
        scale: 1e4,
        monotone: true,
    },
    Kind {
        label: "series drop over flow, path 2",
        place: "path-2",
        law: LawPlace::Path2,
        argument: LawArgument::Flow,
        knots: &[-1.5e-3, -5e-4, -1.5e-4, 0.0, 1.5e-4, 5e-4, 1.5e-3],
        scale: 1e4,
        monotone: true,
    },
    Kind {
        label: "flow beside pack 1 over pressure drop",
        place: "path-1",
        law: LawPlace::BesidePack1,
        argument: LawArgument::PressureDrop,
        knots: &[
            -2.5 * P,
            -1.6 * P,
            -1.0 * P,
            -0.5 * P,
            -0.2 * P,
            0.0,
            0.2 * P,
            0.5 * P,
            0.8 * P,
            1.2 * P,
            2.0 * P,
        ],
        scale: 2e-6,
        monotone: true,
    },
    Kind {
        label: "flow beside pack 2 over pressure drop",
        place: "path-2",
        law: LawPlace::BesidePack2,
        argument: LawArgument::PressureDrop,
        knots: &[
            -2.5 * P,
            -1.6 * P,
            -1.0 * P,
            -0.5 * P,
            -0.2 * P,
            0.0,
            0.2 * P,
            0.5 * P,
            0.8 * P,
            1.2 * P,
            2.0 * P,
        ],
        scale: 2e-6,
        monotone: true,
    },
];

/// Candidates for every kind of law.
#[must_use]
pub fn candidates(_excitation: &Excitation, untestable: &Option<String>) -> Vec<Candidate> {
    KINDS
        .iter()
        .map(|kind| {
            let least = if kind.monotone { 0.0 } else { -1e4 * kind.scale };

            let parameters = (1..kind.knots.len())
                .map(|k| {
                    let key = format!("rise_{:.3e}_to_{:.3e}", kind.knots[k - 1], kind.knots[k]);
                    Parameter::linear(key, 0.0, kind.scale, (least, 1e4 * kind.scale))
                })
                .collect();
            Candidate {
                id: "unlisted",
                place: kind.place.to_owned(),
                label: kind.label.to_owned(),
                parameters,
                starts: vec![],
                instrument: false,
                group: "unlisted",
                untestable: untestable.clone(),
            }
        })
        .collect()
}

/// The law of a candidate with its increments.
#[must_use]
pub fn law(label: &str, increments: &[f64]) -> Option<UnlistedLaw> {
    let kind = KINDS.iter().find(|k| k.label == label)?;
    let mut value = vec![0.0];
    for rise in increments {
        value.push(value[value.len() - 1] + rise);
    }
    // Zero at rest: at argument zero, or at the smallest pressure.
    let rest = kind.knots.iter().position(|k| *k == 0.0).map_or(0.0, |k| value[k]);
    value.iter_mut().for_each(|v| *v -= rest);
    Some(UnlistedLaw {
        place: kind.law,
        depends_on: kind.argument,
        argument: kind.knots.to_vec(),
        value,
    })
}
