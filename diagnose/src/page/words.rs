//! Places, parameter keys and values in words. The name of an effect is in the effect's own file.

use oleo_interface::Valve;

use crate::diagnosis::Effect;
use crate::vocabulary::{Place, Site};

/// What is wrong with a model, as a sentence without its full stop: what it leaves out, and the wrong numbers that it states.
pub fn of_the_model(left_out: &str, wrong_numbers: &str) -> String {
    match (left_out, wrong_numbers) {
        ("", "") => "The model leaves something out".into(),
        (left_out, "") => format!("The model leaves out {left_out}"),
        ("", wrong) => format!("The model states {wrong}"),
        (left_out, wrong) => format!("The model leaves out {left_out}, and states {wrong}"),
    }
}

/// The id of an effect in the vocabulary, with the name of its law if it is a law without a name.
pub fn effect_name(effect: &Effect) -> String {
    if effect.label.is_empty() {
        effect.id.to_string()
    } else {
        format!("{}: {}", effect.id, effect.label)
    }
}

/// A place as it follows the name of an effect: "in accumulator 1".
#[must_use]
pub fn at(place: &Place) -> String {
    match &place.site {
        Site::Sensor(column) => format!("({column})"),
        Site::Output(column) => format!("at the output {column}"),
        Site::Input(column) => format!("at the input {column}"),
        Site::Parameter(name) => format!("in the parameter {name}"),
        Site::MainChamber => "in the main chamber".into(),
        Site::MainSeal => "at the main seal".into(),
        Site::Mount => "at the mount".into(),
        Site::EndStop => "at the end of travel".into(),
        Site::Valves => "(valves 1 to 3)".into(),
        Site::Valve(Valve::Spring) => "(valve 3)".into(),
        Site::Accumulators => "in both accumulators".into(),
        Site::Chamber => "in the gas chamber".into(),
        Site::Damper => "in the damper".into(),
        Site::Drive => "in the drive".into(),
        Site::Paths => "in both paths".into(),
        Site::Unknown => "at an unknown place".into(),
        Site::Accumulator(_) | Site::Path(_) | Site::Valve(_) => {
            format!("in {}", place.site.to_string().replace('-', " "))
        }
    }
}

/// The sites of a place as the topics of a page, which the drawing of the specimen selects.
#[must_use]
pub fn topic(place: &Place) -> String {
    let sites: Vec<String> = place.site.parts().iter().map(ToString::to_string).collect();
    sites.join(" ")
}

/// The text with its first letter in upper case.
#[must_use]
pub fn sentence(text: &str) -> String {
    let mut chars = text.chars();
    chars
        .next()
        .map_or(String::new(), |first| first.to_uppercase().chain(chars).collect())
}

/// Units at the end of a parameter's key, longest first, with their usual spelling.
const UNITS: [(&str, &str); 30] = [
    ("_N_s2_m2", "N s2/m2"),
    ("_Pa_s_m3", "Pa s/m3"),
    ("_m3_s_Pa", "m3/s/Pa"),
    ("_s_MPa2", "s/MPa2"),
    ("_s_Pa2", "s/Pa2"),
    ("_m3_Pa", "m3/Pa"),
    ("_s_MPa", "s/MPa"),
    ("_N_s_m", "N s/m"),
    ("_kg_m4", "kg/m4"),
    ("_per_J", "1/J"),
    ("_N_m3", "N/m3"),
    ("_N_Pa", "N/Pa"),
    ("_s_Pa", "s/Pa"),
    ("_m3_s", "m3/s"),
    ("_Pa_s", "Pa/s"),
    ("_1_Pa", "1/Pa"),
    ("_N_m", "N/m"),
    ("_m_N", "m/N"),
    ("_m_s", "m/s"),
    ("_N_s", "N/s"),
    ("_1_s", "1/s"),
    ("_m3", "m3"),
    ("_Pa", "Pa"),
    ("_rad", "rad"),
    ("_Hz", "Hz"),
    ("_kg", "kg"),
    ("_N", "N"),
    ("_K", "K"),
    ("_m", "m"),
    ("_s", "s"),
];
/// Keys in which a number before the unit counts places.
const COUNTED: [&str; 2] = ["time_constant", "pressure"];
/// Words of keys without a unit that are relative changes.
const RELATIVE: [&str; 9] = [
    "mass",
    "viscous",
    "volume",
    "static_pressure",
    "initial_pressure",
    "flow_coefficient",
    "bulk_modulus",
    "time_constant",
    "relative_error",
];

/// A parameter's key as words and unit: "time_constant_1_s" is "time constant 1" in "s".
#[must_use]
pub fn quantity(key: &str) -> (String, String) {
    // Offsets are named after their column: "p1_Pa offset".
    let (key, suffix) = key
        .strip_suffix(" offset")
        .map_or((key, ""), |column| (column, " offset"));
    let found = UNITS.iter().find(|(end, _)| {
        let inverse = matches!(*end, "_1_s" | "_1_Pa");
        // The 1 of "time_constant_1_s" counts accumulators.
        key.ends_with(end) && !(inverse && COUNTED.iter().any(|c| key.starts_with(c)))
    });
    let (name, unit) = found.map_or((key, ""), |(end, unit)| (&key[..key.len() - end.len()], *unit));
    let unit = if unit.is_empty() && suffix.is_empty() && RELATIVE.iter().any(|c| key.contains(c)) {
        "relative"
    } else {
        unit
    };
    let name = name
        .replace("breakaway_over_coulomb", "breakaway force over Coulomb force")
        .replace('_', " ")
        .replace("coulomb", "Coulomb")
        .replace("stribeck", "Stribeck");
    (format!("{name}{suffix}"), unit.to_owned())
}

/// As [`quantity`], for a parameter of an effect: its flow coefficient is a value, not the relative change of a calibration.
#[must_use]
pub fn parameter(key: &str) -> (String, String) {
    let (name, unit) = quantity(key);
    if key.starts_with("flow_coefficient") {
        (name, "m3/s/sqrt(Pa)".into())
    } else {
        (name, unit)
    }
}

/// A value and its interval, with as many digits as the width of the interval justifies.
#[must_use]
pub fn value_and_interval(value: f64, ci95: [f64; 2]) -> (String, String) {
    let half = 0.5 * (ci95[1] - ci95[0]).abs();
    let digits = if half.is_finite() && half > 0.0 && value != 0.0 {
        (libm::log10(value.abs() / half).ceil() + 1.0).clamp(2.0, 6.0) as usize
    } else {
        3
    };
    if half == 0.0 {
        return (oleo_report::significant(value, 3), "not determined".into());
    }
    let show = |v: f64| {
        if v.is_finite() {
            oleo_report::significant(v, digits)
        } else {
            "not determined".into()
        }
    };
    (show(value), format!("{} to {}", show(ci95[0]), show(ci95[1])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_become_words_with_units() {
        for (key, name, unit) in [
            ("time_constant_1_s", "time constant 1", "s"),
            ("bulk_modulus_Pa", "bulk modulus", "Pa"),
            ("rate_1_s", "rate", "1/s"),
            ("pressure_1_Pa", "pressure 1", "Pa"),
            ("stribeck_speed_m_s", "Stribeck speed", "m/s"),
            ("p1_Pa offset", "p1 offset", "Pa"),
            ("static_gas_volume_1", "static gas volume 1", "relative"),
            ("breakaway_over_coulomb", "breakaway force over Coulomb force", ""),
            ("drift_Pa_s", "drift", "Pa/s"),
            ("slope_s_Pa", "slope", "s/Pa"),
            ("curvature_s_Pa2", "curvature", "s/Pa2"),
            ("slope_m3_s_Pa", "slope", "m3/s/Pa"),
            ("flow_after_a_minute_m3_s", "flow after a minute", "m3/s"),
            ("log_factor_after_a_minute", "log factor after a minute", ""),
        ] {
            assert_eq!(quantity(key), (name.to_owned(), unit.to_owned()), "{key}");
        }
    }

    #[test]
    fn the_flow_coefficient_of_a_leak_has_a_unit() {
        assert_eq!(parameter("flow_coefficient_1").1, "m3/s/sqrt(Pa)");
        assert_eq!(quantity("flow_coefficient_1").1, "relative");
        assert_eq!(parameter("half_width_m"), ("half width".into(), "m".into()));
    }

    #[test]
    fn digits_follow_the_interval() {
        assert_eq!(
            value_and_interval(4.588_18, [4.586_8, 4.589_6]),
            ("4.5882".into(), "4.5868 to 4.5896".into())
        );
        assert_eq!(value_and_interval(117.3, [90.0, 140.0]).0, "117");
        assert_eq!(
            value_and_interval(1.0, [0.5, f64::INFINITY]).1,
            "0.500 to not determined"
        );
    }
}
