//! Laws that swing in time, for the self-test to conceal.

use std::f64::consts::TAU;

use oleo_interface::Valve;
use oleo_plant_sim::strut::{LawArgument, LawPlace, UnlistedLaw};

use crate::effect::drawn::{Drawn, TrueNumber};
use crate::vocabulary::{Branch, Column, Site};

/// Points of a concealed turn: many, and not those that the search uses.
const POINTS: usize = 181;
/// Smallest and largest frequency that is drawn, over the usual one.
const SPREAD: (f64, f64) = (0.75, 1.3);

/// A law that swings.
struct Swing {
    site: Site,
    place: LawPlace,
    /// Key of its amplitude.
    key: &'static str,
    /// Its usual frequency, Hz.
    frequency_hz: f64,
    /// The largest amplitude.
    most: f64,
    /// What it swings about: 0 where it is added, 1 where it multiplies.
    middle: f64,
}

/// How many there are.
pub const COUNT: usize = 6;

static SWINGS: [Swing; COUNT] = [
    // A seal that is lubricated unevenly by a rod that turns.
    Swing {
        site: Site::MainSeal,
        place: LawPlace::MainSealFriction,
        key: "amplitude_N",
        frequency_hz: 0.7,
        most: 390.0,
        middle: 0.0,
    },
    // A room whose heating switches.
    Swing {
        site: Site::Accumulator(Branch::First),
        place: LawPlace::Accumulator1,
        key: "amplitude",
        frequency_hz: 0.15,
        most: 0.9,
        middle: 1.0,
    },
    // A pump on the same frame pushes.
    Swing {
        site: Site::MainSeal,
        place: LawPlace::MainSeal,
        key: "amplitude_N",
        frequency_hz: 11.0,
        most: 1e4,
        middle: 0.0,
    },
    // A solenoid whose current is modulated.
    Swing {
        site: Site::Valve(Valve::Bypass1),
        place: LawPlace::Valve1,
        key: "amplitude",
        frequency_hz: 2.3,
        most: 0.9,
        middle: 1.0,
    },
    // A pump that pulsates into the chamber.
    Swing {
        site: Site::MainChamber,
        place: LawPlace::MainChamberLoss,
        key: "amplitude_m3_s",
        frequency_hz: 3.1,
        most: 1e-3,
        middle: 0.0,
    },
    // An instrument beside a machine.
    Swing {
        site: Site::Sensor(Column::known("p2_Pa")),
        place: LawPlace::InstrumentP2,
        key: "amplitude_p2_Pa",
        frequency_hz: 5.7,
        most: 1e6,
        middle: 0.0,
    },
];

/// Where a law acts.
pub fn site(variant: usize) -> &'static Site {
    &SWINGS[variant].site
}

/// The law of an amount, 1e-5 to 1, and its numbers: its frequency and its phase at the start of a recording are drawn.
pub fn law(drawn: &Drawn, variant: usize, amount: f64) -> (UnlistedLaw, Vec<TrueNumber>) {
    let swing = &SWINGS[variant];
    let frequency_hz = swing.frequency_hz * drawn.between(0, SPREAD.0, SPREAD.1);
    let (amplitude, begin) = (amount * swing.most, drawn.shape[1]);
    let argument: Vec<f64> = (0..POINTS).map(|k| k as f64 / (POINTS - 1) as f64).collect();
    let value = argument
        .iter()
        .map(|turns| swing.middle + amplitude * libm::sin(TAU * (turns + begin)))
        .collect();
    let law = UnlistedLaw {
        place: swing.place,
        depends_on: LawArgument::Phase,
        argument,
        value,
        time_constant_s: None,
        frequency_hz: Some(frequency_hz),
        presliding_volume_m3: None,
        attraction: None,
    };
    let numbers = vec![
        TrueNumber::new(swing.site.clone(), swing.key, amplitude),
        TrueNumber::new(swing.site.clone(), "frequency_Hz", frequency_hz),
    ];
    (law, numbers)
}
