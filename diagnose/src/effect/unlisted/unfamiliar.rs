//! Laws of shapes that the textbook laws do not have, for the self-test to conceal: what somebody else would draw.
//!
//! The textbook laws and the closed forms of the search were written in one house, so that a search that finds the ones may still miss what has a
//! threshold, acts in one direction, breaks at some moment, or bends otherwise. Thresholds and changes at a moment have since become forms of the search
//! (a change is drawn here between points half a second apart, which no form holds exactly); no form holds the others.

use std::ops::Range;

use oleo_interface::Valve;
use oleo_plant_sim::strut::{LawArgument, LawPlace, UnlistedLaw};

use super::believed_numbers;
use crate::effect::drawn::{Drawn, TrueNumber};
use crate::vocabulary::{Branch, Column, Site};

/// Points of a concealed table: many, and not those that the search uses.
const POINTS: usize = 121;
/// Shortest and longest time constant of a law with a memory, s.
const MEMORY_S: (f64, f64) = (2.0, 12.0);

/// A law that a self-test conceals.
struct Law {
    /// Where it should be reported.
    site: Site,
    /// Where it acts in the model.
    place: LawPlace,
    /// Quantity on which the law depends.
    depends_on: LawArgument,
    /// Smallest and largest argument of its table.
    range: (f64, f64),
    /// Whether its quantity is remembered.
    remembers: bool,
    /// Its value at an argument, for an amount of 1e-5 to 1.
    value: fn(f64, &Drawn, f64) -> f64,
}

/// How many there are.
pub const COUNT: usize = 26;

const DISPLACEMENT_M: (f64, f64) = (-0.11, 0.11);
const TIME_S: (f64, f64) = (0.0, 60.0);
const P1_PA: (f64, f64) = (-1e5, 2e7);
const FLOW_M3_S: (f64, f64) = (-2e-3, 2e-3);
const DROP_PA: (f64, f64) = (-1.2e7, 1.2e7);

static LAWS: [Law; COUNT] = [
    Law {
        site: Site::Path(Branch::First),
        place: LawPlace::Path1,
        depends_on: LawArgument::Flow,
        range: FLOW_M3_S,
        remembers: false,
        value: |flow, drawn, amount| amount * 1e6 * libm::tanh(flow / drawn.between(0, 2e-5, 2e-4)),
    },
    Law {
        site: Site::Path(Branch::Second),
        place: LawPlace::Path2,
        depends_on: LawArgument::Flow,
        range: FLOW_M3_S,
        remembers: false,
        value: |flow, _, amount| amount * 4e9 * flow.min(0.0),
    },
    Law {
        site: Site::MainSeal,
        place: LawPlace::MainSeal,
        depends_on: LawArgument::Speed,
        range: (-1.2, 1.2),
        remembers: false,
        value: |speed, _, amount| amount * 3e3 * speed.min(0.0),
    },
    Law {
        site: Site::MainSeal,
        place: LawPlace::MainSeal,
        depends_on: LawArgument::P1,
        range: P1_PA,
        remembers: false,
        value: |p1, drawn, amount| amount * 1e-4 * (p1 - drawn.between(0, 4e6, 6e6)).max(0.0),
    },
    Law {
        site: Site::MainSeal,
        place: LawPlace::MainSealFriction,
        depends_on: LawArgument::P1,
        range: P1_PA,
        remembers: false,
        value: |p1, _, amount| amount * 500.0 * (p1.max(0.0) / 1e7).sqrt(),
    },
    // A tight spot of the bore.
    Law {
        site: Site::MainSeal,
        place: LawPlace::MainSealFriction,
        depends_on: LawArgument::Displacement,
        range: DISPLACEMENT_M,
        remembers: false,
        value: |x, drawn, amount| {
            let away = (x - drawn.between(0, -0.02, 0.02)) / drawn.between(1, 0.008, 0.02);
            amount * 600.0 * libm::exp(-away * away)
        },
    },
    // A seal that runs dry from some moment on.
    Law {
        site: Site::MainSeal,
        place: LawPlace::MainSealFriction,
        depends_on: LawArgument::Time,
        range: TIME_S,
        remembers: false,
        value: |t, drawn, amount| amount * 10.0 * (t - drawn.between(0, 0.8, 4.0)).max(0.0),
    },
    // A blow-off valve.
    Law {
        site: Site::Path(Branch::First),
        place: LawPlace::BesidePack1,
        depends_on: LawArgument::PressureDrop,
        range: DROP_PA,
        remembers: false,
        value: |drop, drawn, amount| amount * 1e-6 * (drop - drawn.between(0, 1e5, 5e5)).max(0.0).sqrt(),
    },
    // A clack that leaks in rebound.
    Law {
        site: Site::Path(Branch::Second),
        place: LawPlace::BesidePack2,
        depends_on: LawArgument::PressureDrop,
        range: DROP_PA,
        remembers: false,
        value: |drop, _, amount| -amount * 1e-6 * (-drop).max(0.0).sqrt(),
    },
    // A metering pin.
    Law {
        site: Site::Path(Branch::First),
        place: LawPlace::Pack1,
        depends_on: LawArgument::Displacement,
        range: DISPLACEMENT_M,
        remembers: false,
        value: |x, drawn, amount| 1.0 + drawn.sign * amount * 0.9 * x / 0.11,
    },
    // A hydraulic stop: the damper stiffens towards both ends.
    Law {
        site: Site::Path(Branch::Second),
        place: LawPlace::Pack2,
        depends_on: LawArgument::Displacement,
        range: DISPLACEMENT_M,
        remembers: false,
        value: |x, drawn, amount| 1.0 + amount * 40.0 * (x.abs() - drawn.between(0, 0.015, 0.03)).max(0.0),
    },
    // Dirt that lodges within half a second.
    Law {
        site: Site::Path(Branch::First),
        place: LawPlace::Pack1,
        depends_on: LawArgument::Time,
        range: TIME_S,
        remembers: false,
        value: |t, drawn, amount| 1.0 + amount * ((t - drawn.between(0, 0.8, 4.0)) / 0.5).clamp(0.0, 1.0),
    },
    // Oil that thins as it warms, exponentially.
    Law {
        site: Site::Path(Branch::Second),
        place: LawPlace::Pack2,
        depends_on: LawArgument::Energy,
        range: (0.0, 2e4),
        remembers: true,
        value: |energy, _, amount| libm::exp(-2e-3 * amount * energy),
    },
    // A bag that stiffens where it is small.
    Law {
        site: Site::Accumulator(Branch::First),
        place: LawPlace::Accumulator1,
        depends_on: LawArgument::RelativeVolume,
        range: (0.05, 3.0),
        remembers: false,
        value: |v, _, amount| 1.0 + amount * (1.0 - v).max(0.0) * (1.0 - v).max(0.0),
    },
    Law {
        site: Site::Accumulator(Branch::Second),
        place: LawPlace::Accumulator2,
        depends_on: LawArgument::VolumeChange,
        range: (-1.0, 2.0),
        remembers: true,
        value: |change, drawn, amount| 1.0 - 0.2 * amount * libm::tanh(change / drawn.between(0, 0.02, 0.1)),
    },
    // A gap that opens at a pressure.
    Law {
        site: Site::MainChamber,
        place: LawPlace::MainChamber,
        depends_on: LawArgument::P1,
        range: P1_PA,
        remembers: false,
        value: |p1, drawn, amount| amount * 1e-11 * (p1 - drawn.between(0, 4e6, 6e6)).max(0.0),
    },
    // A relief valve.
    Law {
        site: Site::MainChamber,
        place: LawPlace::MainChamberLoss,
        depends_on: LawArgument::P1,
        range: P1_PA,
        remembers: false,
        value: |p1, drawn, amount| amount * 1e-13 * (p1 - drawn.between(0, 4e6, 6e6)).max(0.0),
    },
    // A seat that is cut at some moment.
    Law {
        site: Site::Valve(Valve::Spring),
        place: LawPlace::BesideValve3,
        depends_on: LawArgument::Time,
        range: TIME_S,
        remembers: false,
        value: |t, drawn, amount| amount * 1e-6 * ((t - drawn.between(0, 0.8, 4.0)) / 0.5).clamp(0.0, 1.0),
    },
    // A valve that flutters about a drop.
    Law {
        site: Site::Valve(Valve::Bypass1),
        place: LawPlace::Valve1,
        depends_on: LawArgument::PressureDrop,
        range: (0.0, 1.2e7),
        remembers: false,
        value: |drop, drawn, amount| {
            let away = (drop - drawn.between(0, 1e5, 6e5)) / drawn.between(1, 1e5, 4e5);
            1.0 - 0.9 * amount * libm::exp(-away * away)
        },
    },
    // Solenoids that are held fast above a drop.
    Law {
        site: Site::Valves,
        place: LawPlace::ValveTiming,
        depends_on: LawArgument::PressureDrop,
        range: (0.0, 1.2e7),
        remembers: false,
        value: |drop, drawn, amount| amount * 5e-8 * (drop - drawn.between(0, 1e5, 1e6)).max(0.0),
    },
    Law {
        site: Site::Sensor(Column::known("p2_Pa")),
        place: LawPlace::InstrumentP2,
        depends_on: LawArgument::Reading,
        range: P1_PA,
        remembers: false,
        value: |reading, drawn, amount| drawn.sign * amount * 1e6 * (reading / 1e7) * (reading / 1e7).abs(),
    },
    // A load cell that sits loosely, so that it jumps about the static force.
    Law {
        site: Site::Sensor(Column::known("force_N")),
        place: LawPlace::InstrumentForce,
        depends_on: LawArgument::Reading,
        range: (-5e3, 4e4),
        remembers: false,
        value: |reading, drawn, amount| amount * 2e3 * libm::tanh((reading - 8.3e3) / drawn.between(0, 200.0, 1e3)),
    },
    // A plug that is knocked.
    Law {
        site: Site::Sensor(Column::known("p1_Pa")),
        place: LawPlace::InstrumentP1,
        depends_on: LawArgument::Time,
        range: TIME_S,
        remembers: false,
        value: |t, drawn, amount| drawn.sign * amount * 1e6 * ((t - drawn.between(0, 0.8, 4.0)) / 0.5).clamp(0.0, 1.0),
    },
    Law {
        site: Site::Sensor(Column::known("p4_Pa")),
        place: LawPlace::InstrumentP4,
        depends_on: LawArgument::ReadingChange,
        range: (-5e6, 1e7),
        remembers: true,
        value: |change, _, amount| -amount * 1e6 * libm::tanh(change / 1e6),
    },
    // Rubber that stiffens.
    Law {
        site: Site::Mount,
        place: LawPlace::Mount,
        depends_on: LawArgument::Force,
        range: (-1e4, 3e4),
        remembers: false,
        value: |force, drawn, amount| amount * 5e-3 * libm::tanh(force / drawn.between(0, 1e3, 4e3)),
    },
    Law {
        site: Site::Accumulator(Branch::First),
        place: LawPlace::Accumulator1Friction,
        depends_on: LawArgument::RelativeVolume,
        range: (0.05, 3.0),
        remembers: false,
        value: |v, _, amount| amount * 1e6 * (1.0 - v).max(0.0),
    },
];

/// Variants of the effect `unlisted` beyond the textbook, the laws that swing and the wrong numbers.
#[must_use]
pub fn variants() -> Range<usize> {
    let from = believed_numbers::variants().end;
    from..from + COUNT
}

/// The drawn law of an amount, and what should be reported of it, where; `None` if the variant is none of these.
pub fn law(drawn: &Drawn, amount: f64) -> Option<(UnlistedLaw, Vec<TrueNumber>)> {
    let law = LAWS.get(drawn.variant.checked_sub(variants().start)?)?;
    let (from, to) = law.range;
    let argument: Vec<f64> = (0..POINTS)
        .map(|k| from + (to - from) * k as f64 / (POINTS - 1) as f64)
        .collect();
    let table = UnlistedLaw {
        place: law.place,
        depends_on: law.depends_on,
        value: argument.iter().map(|a| (law.value)(*a, drawn, amount)).collect(),
        argument,
        time_constant_s: law.remembers.then(|| drawn.between(2, MEMORY_S.0, MEMORY_S.1)),
        frequency_hz: None,
        presliding_volume_m3: None,
        attraction: None,
    };
    Some((table, vec![TrueNumber::present(law.site.clone())]))
}

#[cfg(test)]
mod tests {
    use oleo_plant_sim::model_file::Checked;

    use super::*;

    #[test]
    fn every_law_is_one_that_the_solver_reads() {
        for variant in variants() {
            for (amount, shape) in [(1e-5, 0.0), (1.0, 0.5), (1.0, 0.999)] {
                let drawn = Drawn {
                    variant,
                    sign: -1.0,
                    shape: [shape; 4],
                    response: [0.04, 0.002, 1e-4],
                };
                let (law, told) = law(&drawn, amount).expect("a law");
                assert_eq!(law.check(), Ok(()), "{variant} {:?}", law.place);
                assert_eq!(told.len(), 1);
            }
        }
    }
}
