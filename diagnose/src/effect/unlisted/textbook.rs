//! Laws of textbook form that the vocabulary does not hold, for the self-test to conceal.

use std::ops::Range;

use oleo_plant_sim::strut::{LawArgument, LawPlace, UnlistedLaw};

use super::swinging_textbook;
use crate::effect::drawn::{Drawn, TrueNumber};
use crate::vocabulary::{Branch, Place, Site};

/// Points of a concealed table: many, and not those that the search uses.
const POINTS: usize = 61;

/// A law that a self-test conceals.
struct Law {
    /// Where it should be reported.
    site: Site,
    /// Where it acts in the model.
    place: LawPlace,
    /// Quantity on which the law depends.
    depends_on: LawArgument,
    /// Largest argument of its table.
    end: f64,
    /// Its value at an argument, for an amount of 1e-5 to 1; the second number is `end`.
    value: fn(f64, f64, &Drawn, f64) -> f64,
}

static LAWS: [Law; 12] = [
    Law {
        site: Site::Path(Branch::First),
        place: LawPlace::Path1,
        depends_on: LawArgument::Flow,
        end: 2e-3,
        value: turbulent_line,
    },
    Law {
        site: Site::Path(Branch::Second),
        place: LawPlace::Path2,
        depends_on: LawArgument::Flow,
        end: 2e-3,
        value: turbulent_line,
    },
    Law {
        site: Site::MainSeal,
        place: LawPlace::MainSeal,
        depends_on: LawArgument::Speed,
        end: 1.2,
        value: viscous_seal,
    },
    Law {
        site: Site::MainSeal,
        place: LawPlace::MainSeal,
        depends_on: LawArgument::Displacement,
        end: 0.11,
        value: dust_boot,
    },
    Law {
        site: Site::Path(Branch::First),
        place: LawPlace::BesidePack1,
        depends_on: LawArgument::Displacement,
        end: 0.11,
        value: groove,
    },
    Law {
        site: Site::Path(Branch::Second),
        place: LawPlace::BesidePack2,
        depends_on: LawArgument::Displacement,
        end: 0.11,
        value: groove,
    },
    Law {
        site: Site::Valves,
        place: LawPlace::Valves,
        depends_on: LawArgument::PressureDrop,
        end: 1.3e7,
        value: saturating_valve,
    },
    Law {
        site: Site::MainSeal,
        place: LawPlace::MainSeal,
        depends_on: LawArgument::Acceleration,
        end: 100.0,
        value: moving_mass,
    },
    Law {
        site: Site::MainChamber,
        place: LawPlace::MainChamberLoss,
        depends_on: LawArgument::Time,
        end: 60.0,
        value: external_leak,
    },
    Law {
        site: Site::Path(Branch::First),
        place: LawPlace::Pack1,
        depends_on: LawArgument::Time,
        end: 60.0,
        value: clogging_pack,
    },
    Law {
        site: Site::Accumulator(Branch::First),
        place: LawPlace::Accumulator1,
        depends_on: LawArgument::Time,
        end: 60.0,
        value: leaking_gas,
    },
    Law {
        site: Site::Accumulator(Branch::Second),
        place: LawPlace::Accumulator2,
        depends_on: LawArgument::Time,
        end: 60.0,
        value: leaking_gas,
    },
];

/// Pressure drop over flow squared, Pa: 3 MPa at 2 l/s at most.
fn turbulent_line(flow: f64, end: f64, _drawn: &Drawn, amount: f64) -> f64 {
    amount * 3e6 * (flow / end) * (flow / end).abs()
}

/// Force over speed, N: 1.5 kN at 1.2 m/s at most, with a drawn curvature.
fn viscous_seal(speed: f64, end: f64, drawn: &Drawn, amount: f64) -> f64 {
    amount * 1.5e3 * (speed / end) * libm::pow((speed / end).abs(), 0.6 * drawn.shape[0])
}

/// Force over displacement, N: the air spring of a sealed dust boot.
fn dust_boot(displacement: f64, end: f64, drawn: &Drawn, amount: f64) -> f64 {
    let a = displacement;
    drawn.sign * amount * 1e3 * (0.5 * a / end + (a / end) * (a / end) * (a / end))
}

/// Opening over displacement, m3/s/sqrt(Pa): a groove beside the pack of drawn place and width with ends that run out
/// linearly; 2e-6 at most.
fn groove(displacement: f64, _end: f64, drawn: &Drawn, amount: f64) -> f64 {
    let (at, half) = (0.03 * (2.0 * drawn.shape[0] - 1.0), 0.012 + 0.02 * drawn.shape[1]);
    amount * 2e-6 * (1.5 - (displacement - at).abs() / half).clamp(0.0, 1.0)
}

/// Fraction left of a flow over the root of the drop, which approaches a constant one.
fn saturating_valve(drop: f64, end: f64, _drawn: &Drawn, amount: f64) -> f64 {
    1.0 / (1.0 + 30.0 * amount * drop.abs() / end).sqrt()
}

/// Force over acceleration, N: a mass of 60 kg at most between load cell and oil.
fn moving_mass(acceleration: f64, _end: f64, _drawn: &Drawn, amount: f64) -> f64 {
    amount * 60.0 * acceleration
}

/// Flow out of the strut over time, m3/s, through a crack that opens in a drawn time: 2e-7 at most.
fn external_leak(time: f64, end: f64, drawn: &Drawn, amount: f64) -> f64 {
    amount * 2e-7 * (time.max(0.0) / (end * (0.1 + drawn.shape[0]))).min(1.0)
}

/// Factor on the drop of a pack over time: it clogs at a constant rate, to twice the drop within a minute at most.
fn clogging_pack(time: f64, end: f64, _drawn: &Drawn, amount: f64) -> f64 {
    1.0 + amount * time.max(0.0) / end
}

/// Factor on a gas pressure over time: gas that escapes at a rate in proportion to what is left, half within a minute at most.
fn leaking_gas(time: f64, end: f64, _drawn: &Drawn, amount: f64) -> f64 {
    libm::exp(-0.7 * amount * time.max(0.0) / end)
}

/// How many laws there are to draw from.
pub const COUNT: usize = LAWS.len();

/// Variants beyond these: laws that swing in time.
#[must_use]
pub fn periodic_variants() -> Range<usize> {
    COUNT..COUNT + swinging_textbook::COUNT
}

/// Pairs of variants, also of those that swing, whose laws act at places of which none holds the other.
#[must_use]
pub fn pairs_of_variants() -> Vec<[usize; 2]> {
    let place_of = |variant: usize| -> Place {
        let site = LAWS.get(variant).map(|law| &law.site);
        site.unwrap_or_else(|| swinging_textbook::site(variant - COUNT))
            .clone()
            .into()
    };
    let all = 0..periodic_variants().end;
    (all.clone()
        .flat_map(|first| all.clone().map(move |second| [first, second])))
    .filter(|&[first, second]| first < second && !place_of(first).overlaps(&place_of(second)))
    .collect()
}

/// The drawn law of an amount, and the numbers that should be reported of it, where.
pub fn law(drawn: &Drawn, amount: f64) -> (UnlistedLaw, Vec<TrueNumber>) {
    let Some(law) = LAWS.get(drawn.variant) else {
        return swinging_textbook::law(drawn, drawn.variant - COUNT, amount);
    };
    let argument: Vec<f64> = (0..POINTS)
        .map(|k| law.end * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0))
        .collect();
    let value = argument
        .iter()
        .map(|a| (law.value)(*a, law.end, drawn, amount))
        .collect();
    let table = UnlistedLaw {
        place: law.place,
        depends_on: law.depends_on,
        argument,
        value,
        time_constant_s: None,
        frequency_hz: None,
        presliding_volume_m3: None,
        attraction: None,
    };
    (table, vec![TrueNumber::present(law.site.clone())])
}
