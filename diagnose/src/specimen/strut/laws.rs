//! Laws without a name: a table at a place of the network, over a quantity that is measured there.
//!
//! What the vocabulary does not name can still be found and placed: a force or a friction at the seal; a volume or a loss
//! of the main chamber; a drop in series with a path, a flow beside its damper, a damper or a valve that is weaker or
//! stronger than believed; a gas law that bends. The search space is the product of places and quantities.

use oleo_interface::Valve;
use oleo_plant_sim::strut::{LawArgument, LawPlace, UnlistedLaw};

use crate::parameter::Parameter;
use crate::specimen::candidate::{Candidate, ExclusionGroup};
use crate::vocabulary::{Branch, EffectId, Site};

/// What a table's numbers are, and how they are fitted.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// Added; zero at rest. Fitted as rises from knot to knot outwards from rest, of any sign.
    Added,
    /// Added and never falling with its quantity: the order that a resistance or a compliance needs is a bound, no wish.
    Rising,
    /// Added; never negative; fitted knot by knot.
    Level,
    /// Multiplies what was believed; one at rest. Fitted as logarithmic rises from knot to knot.
    Factor,
    /// Added; a bell `c exp(-((x - x0)/w)^2)`: a groove or a step that acts around one position.
    Bell,
    /// Multiplies what was believed: `1/(1 + (a dp)^k)`, a flow that chokes, or a poppet that its flow pulls shut.
    Choke,
}

/// One kind of law.
struct Kind {
    label: &'static str,
    site: Site,
    law: LawPlace,
    argument: LawArgument,
    knots: &'static [f64],
    /// Size of one fitted number that would be visible.
    scale: f64,
    form: Form,
}

const P: f64 = 1e6;
const STROKE_M: &[f64] = &[
    -0.06, -0.04, -0.026, -0.017, -0.009, 0.0, 0.009, 0.017, 0.026, 0.04, 0.06,
];
const TRAVEL_M: &[f64] = &[-0.09, -0.06, -0.03, 0.0, 0.03, 0.06, 0.09];
const SPEED_M_S: &[f64] = &[-0.6, -0.2, -0.05, -0.005, 0.0, 0.005, 0.05, 0.2, 0.6];
const P1_PA: &[f64] = &[0.0, 2.0 * P, 4.0 * P, 6.0 * P, 9.0 * P, 13.0 * P];
const FLOW_M3_S: &[f64] = &[-1.5e-3, -5e-4, -1.5e-4, 0.0, 1.5e-4, 5e-4, 1.5e-3];
const PACK_PA: &[f64] = &[
    -2.5 * P,
    -1.6 * P,
    -P,
    -0.5 * P,
    -0.2 * P,
    0.0,
    0.2 * P,
    0.5 * P,
    0.8 * P,
    1.2 * P,
    2.0 * P,
];
/// Every half octave.
const VALVE_PA: &[f64] = &[
    0.0,
    0.02 * P,
    0.03 * P,
    0.045 * P,
    0.07 * P,
    0.1 * P,
    0.14 * P,
    0.2 * P,
    0.28 * P,
    0.4 * P,
    0.56 * P,
    0.8 * P,
    1.1 * P,
    1.6 * P,
    2.2 * P,
    3.2 * P,
    4.5 * P,
    6.4 * P,
    9.0 * P,
    13.0 * P,
];
/// Every 4 mm.
const GROOVE_M: &[f64] = &[
    -0.1, -0.08, -0.064, -0.056, -0.048, -0.04, -0.036, -0.032, -0.028, -0.024, -0.02, -0.016, -0.012, -0.008, -0.004,
    0.0, 0.004, 0.008, 0.012, 0.016, 0.02, 0.024, 0.028, 0.032, 0.036, 0.04, 0.048, 0.056, 0.064, 0.08, 0.1,
];
const CHAMBER_PA: &[f64] = &[
    0.0,
    0.2 * P,
    0.45 * P,
    0.8 * P,
    1.3 * P,
    2.0 * P,
    4.0 * P,
    7.0 * P,
    13.0 * P,
];
const RELATIVE_VOLUME: &[f64] = &[0.3, 0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0];

const fn kind(
    label: &'static str,
    site: Site,
    law: LawPlace,
    argument: LawArgument,
    knots: &'static [f64],
    scale: f64,
    form: Form,
) -> Kind {
    Kind {
        label,
        site,
        law,
        argument,
        knots,
        scale,
        form,
    }
}

use Form::{Added, Bell, Choke, Factor, Level, Rising};
use LawArgument::{Displacement, Flow, P1, PressureDrop, RelativeVolume, Speed};
use LawPlace as At;

const KINDS: &[Kind] = &[
    kind(
        "force over displacement",
        Site::MainSeal,
        At::MainSeal,
        Displacement,
        TRAVEL_M,
        20.0,
        Added,
    ),
    kind(
        "force over speed",
        Site::MainSeal,
        At::MainSeal,
        Speed,
        SPEED_M_S,
        20.0,
        Added,
    ),
    kind(
        "force over pressure",
        Site::MainSeal,
        At::MainSeal,
        P1,
        P1_PA,
        20.0,
        Added,
    ),
    kind(
        "friction over displacement",
        Site::MainSeal,
        At::MainSealFriction,
        Displacement,
        TRAVEL_M,
        20.0,
        Level,
    ),
    kind(
        "friction over speed",
        Site::MainSeal,
        At::MainSealFriction,
        Speed,
        SPEED_M_S,
        20.0,
        Level,
    ),
    kind(
        "friction over pressure",
        Site::MainSeal,
        At::MainSealFriction,
        P1,
        P1_PA,
        20.0,
        Level,
    ),
    kind(
        "volume over pressure",
        Site::MainChamber,
        At::MainChamber,
        P1,
        CHAMBER_PA,
        5e-8,
        Rising,
    ),
    kind(
        "oil lost over pressure",
        Site::MainChamber,
        At::MainChamberLoss,
        P1,
        P1_PA,
        1e-9,
        Level,
    ),
    kind(
        "series drop over flow, path 1",
        Site::Path(Branch::First),
        At::Path1,
        Flow,
        FLOW_M3_S,
        1e4,
        Rising,
    ),
    kind(
        "series drop over flow, path 2",
        Site::Path(Branch::Second),
        At::Path2,
        Flow,
        FLOW_M3_S,
        1e4,
        Rising,
    ),
    kind(
        "flow beside pack 1 over pressure drop",
        Site::Path(Branch::First),
        At::BesidePack1,
        PressureDrop,
        PACK_PA,
        2e-6,
        Rising,
    ),
    kind(
        "flow beside pack 2 over pressure drop",
        Site::Path(Branch::Second),
        At::BesidePack2,
        PressureDrop,
        PACK_PA,
        2e-6,
        Rising,
    ),
    kind(
        "opening beside pack 1 over displacement",
        Site::Path(Branch::First),
        At::BesidePack1,
        Displacement,
        GROOVE_M,
        1e-7,
        Bell,
    ),
    kind(
        "opening beside pack 2 over displacement",
        Site::Path(Branch::Second),
        At::BesidePack2,
        Displacement,
        GROOVE_M,
        1e-7,
        Bell,
    ),
    kind(
        "strength of pack 1 over displacement",
        Site::Path(Branch::First),
        At::Pack1,
        Displacement,
        STROKE_M,
        0.05,
        Factor,
    ),
    kind(
        "strength of pack 2 over displacement",
        Site::Path(Branch::Second),
        At::Pack2,
        Displacement,
        STROKE_M,
        0.05,
        Factor,
    ),
    kind(
        "flow of the open valves over pressure drop",
        Site::Valves,
        At::Valves,
        PressureDrop,
        VALVE_PA,
        1e-8,
        Choke,
    ),
    kind(
        "flow of open valve 1 over pressure drop",
        Site::Valve(Valve::Bypass1),
        At::Valve1,
        PressureDrop,
        VALVE_PA,
        1e-8,
        Choke,
    ),
    kind(
        "flow of open valve 2 over pressure drop",
        Site::Valve(Valve::Bypass2),
        At::Valve2,
        PressureDrop,
        VALVE_PA,
        1e-8,
        Choke,
    ),
    kind(
        "flow of open valve 3 over pressure drop",
        Site::Valve(Valve::Spring),
        At::Valve3,
        PressureDrop,
        VALVE_PA,
        1e-8,
        Choke,
    ),
    kind(
        "gas pressure over volume, accumulator 1",
        Site::Accumulator(Branch::First),
        At::Accumulator1,
        RelativeVolume,
        RELATIVE_VOLUME,
        0.01,
        Factor,
    ),
    kind(
        "gas pressure over volume, accumulator 2",
        Site::Accumulator(Branch::Second),
        At::Accumulator2,
        RelativeVolume,
        RELATIVE_VOLUME,
        0.01,
        Factor,
    ),
];

impl Kind {
    fn parameters(&self) -> Vec<Parameter> {
        let most = 1e4 * self.scale;
        let rise = |k: usize| format!("rise_{:.3e}_to_{:.3e}", self.knots[k - 1], self.knots[k]);
        let between = 1..self.knots.len();
        match self.form {
            Added => between
                .map(|k| Parameter::linear(rise(k), 0.0, self.scale, (-most, most)))
                .collect(),
            Rising => between
                .map(|k| Parameter::linear(rise(k), 0.0, self.scale, (0.0, most)))
                .collect(),
            Bell => vec![
                Parameter::amount("flow_coefficient", self.scale, most),
                Parameter::linear("position_m", 0.0, 0.004, (-0.09, 0.09)),
                Parameter::log("half_width_m", 0.012, (0.002, 0.1)),
            ],
            Choke => vec![
                Parameter::amount("inverse_pressure_1_Pa", self.scale, most),
                Parameter::linear("exponent", 1.0, 0.1, (0.3, 4.0)),
            ],
            Level => (self.knots.iter())
                .map(|x| Parameter::amount(format!("at_{x:.3e}"), self.scale, most))
                .collect(),
            // A weak wish for no change keeps knots in order where no recording goes.
            Factor => between
                .map(|k| Parameter {
                    prior: true,
                    ..Parameter::linear(format!("log_{}", rise(k)), 0.0, self.scale, (-3.0, 3.0))
                })
                .collect(),
        }
    }

    /// Starting points beside "not there": laws that bend far from straight are also tried where they show.
    fn starts(&self) -> Vec<Vec<f64>> {
        match self.form {
            Bell => [-0.03, 0.0, 0.03].map(|x| vec![3e-7, x, 0.012]).to_vec(),
            Choke => vec![vec![3e-7, 1.0], vec![1e-6, 1.0]],
            _ => vec![],
        }
    }

    /// The table's values from the fitted numbers.
    fn values(&self, fitted: &[f64]) -> Vec<f64> {
        match (self.form, fitted) {
            (Level, _) => return fitted.to_vec(),
            (Bell, &[most, at, width]) => {
                let off = |x: &f64| (x - at) / width;
                return self.knots.iter().map(|x| most * libm::exp(-off(x) * off(x))).collect();
            }
            (Choke, &[inverse, exponent]) => {
                return self
                    .knots
                    .iter()
                    .map(|dp| 1.0 / (1.0 + libm::pow(inverse * dp, exponent)))
                    .collect();
            }
            _ => {}
        }
        let mut value = vec![0.0];
        for rise in fitted {
            value.push(value[value.len() - 1] + rise);
        }
        // At rest a law adds nothing and leaves everything as believed: argument zero, volume one, smallest pressure.
        let at_rest = if self.argument == RelativeVolume { 1.0 } else { 0.0 };
        let rest = self.knots.iter().position(|k| *k == at_rest).map_or(0.0, |k| value[k]);
        let factor = self.form == Factor;
        value
            .iter()
            .map(|v| if factor { libm::exp(v - rest) } else { v - rest })
            .collect()
    }
}

/// Candidates for every kind of law.
#[must_use]
pub fn candidates(untestable: &Option<String>) -> Vec<Candidate> {
    KINDS
        .iter()
        .map(|kind| Candidate {
            id: EffectId::Unlisted,
            place: kind.site.clone().into(),
            label: kind.label.to_owned(),
            parameters: kind.parameters(),
            starts: kind.starts(),
            group: Some(ExclusionGroup::Unlisted),
            untestable: untestable.clone(),
        })
        .collect()
}

/// The law of a candidate with its fitted numbers.
#[must_use]
pub fn law(label: &str, fitted: &[f64]) -> Option<UnlistedLaw> {
    let kind = KINDS.iter().find(|k| k.label == label)?;
    Some(UnlistedLaw {
        place: kind.law,
        depends_on: kind.argument,
        argument: kind.knots.to_vec(),
        value: kind.values(fitted),
    })
}
