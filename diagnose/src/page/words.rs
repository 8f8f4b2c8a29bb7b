//! The vocabulary in words: what an effect is called where it acts, its equation as the model has it, and its source.

use oleo_interface::Valve;

use crate::vocabulary::{EffectId, Place, Site};

/// Name, equation in words and source of an effect.
pub struct Words {
    /// "gas heat transfer".
    pub name: &'static str,
    /// The equation and its symbols.
    pub equation: &'static str,
    /// Where it comes from.
    pub source: &'static str,
}

/// Words of an id of the vocabulary; `label` tells laws without a name apart.
#[must_use]
pub fn words(id: EffectId, label: &str) -> Words {
    let (name, equation, source) = match id {
        EffectId::OilCompressibility => (
            "oil compressibility",
            "dp1/dt = beta / (V_oil - A x) (A dx/dt - Q1 - Q2): the oil column is a spring of bulk modulus beta between piston and dampers",
            "Theron & Els, final report 2002, figure 21",
        ),
        EffectId::EntrainedAir => (
            "air in the oil",
            "1/beta_eff = 1/beta + a (p_atm/p)^(1/n) / (n p), p absolute: the bulk modulus falls at low pressure, a the volume fraction of air at atmospheric pressure, n its polytropic exponent",
            "Gholizadeh, Burton & Schoenau, Int. J. Fluid Power 12(3), 2011",
        ),
        EffectId::GasHeatTransfer => (
            "gas heat transfer",
            "m c_v dT/dt = -T (dp/dT)_V dV/dt - m c_v (T - T_ambient)/tau: compression warms the gas, which cools with the time constant tau",
            "Els & Grobbelaar, SAE 930265; Otis & Pourmovahed, J. Dyn. Sys. 107, 1985",
        ),
        EffectId::RealGas => (
            "real-gas behaviour of the nitrogen",
            "p = rho R T (1 + delta alpha_delta): the pressure departs from the ideal gas law as density grows",
            "Span et al., J. Phys. Chem. Ref. Data 29(6), 2000",
        ),
        EffectId::GasChargeError => (
            "a wrong gas charge",
            "gas volume at static pressure times (1 + e): more or less gas than the model believes, beyond tolerance",
            "definition of the recordings",
        ),
        EffectId::SealFriction => (
            "seal friction",
            "dF/dx = k (1 - sgn(v) F/g), g = F_c + (F_s - F_c) exp(-(v/v_s)^2): Coulomb force F_c, breakaway force F_s, Stribeck speed v_s",
            "Dahl 1968; Canudas de Wit et al., IEEE TAC 40(3), 1995",
        ),
        EffectId::SideLoadFriction => (
            "friction that grows with load",
            "friction level mu |F|: what presses the seal or bends the rod makes it rub",
            "Theron & Els, final report 2002, section 3.5.1",
        ),
        EffectId::AccumulatorPistonFriction => (
            "friction of the floating piston",
            "p_oil = p_gas + p_f s, ds/dV = (1 - s sgn(Q))/V_s: the piston's seal holds back the pressure p_f, and gives way over the volume V_s",
            "Theron & Els, final report 2002, section 3.5.1",
        ),
        EffectId::DamperLeakage => (
            "oil passing beside the damper pack",
            "Q = c dp / sqrt(|dp| + p_t) in parallel with the pack",
            "Theron & Els, final report 2002, section 3.5.2",
        ),
        EffectId::LineResistance => (
            "viscous loss in a line",
            "dp = R Q in series with the pack",
            "Hagen-Poiseuille",
        ),
        EffectId::LineInertance => (
            "mass of the oil column in a line",
            "dp = I dQ/dt, I = rho l / a",
            "Newton, oil column",
        ),
        EffectId::ValveDelay => (
            "valve response that depends on pressure",
            "total = c0 + c1 dP + c2 dP^2 s, dP the pressure difference across the valve at the edge in MPa",
            "Theron & Els, final report 2002, figures 24 and 25",
        ),
        EffectId::ValveTransition => (
            "gradual valve opening",
            "opening is the straight line through 5 % at the initial delay and 95 % at the total response time, not a step",
            "Theron & Els, final report 2002, section 3.6",
        ),
        EffectId::Valve3Leakage => (
            "leakage through the closed valve",
            "Q = c dp / sqrt(|dp| + p_t) while the valve is closed",
            "definition of the recordings",
        ),
        EffectId::BumpStop => (
            "contact with a stop",
            "F = k d + c d^3, d the travel beyond the clearance",
            "progressive rubber buffer",
        ),
        EffectId::MountCompliance => (
            "compliance",
            "x_strut = x - (F - F_static)/k: the strut moves less than the actuator",
            "rubber bush in series",
        ),
        EffectId::DampingFade => (
            "damping that fades with heat",
            "drop / (1 + f E), dE/dt = dp Q - E/tau: dampers weaken as their oil warms",
            "lumped energy balance",
        ),
        EffectId::SensorLag => ("a lagging instrument", "tau dy/dt + y = x", "first-order instrument"),
        EffectId::SensorSkew => (
            "a late (or early) instrument",
            "y(t) = x(t - s)",
            "definition of the recordings",
        ),
        EffectId::SensorGain => (
            "a wrong gain of an instrument",
            "y = rest + (1 + e)(x - rest)",
            "definition of the recordings",
        ),
        EffectId::SensorDrift => ("a drifting instrument", "y = x + d t", "definition of the recordings"),
        EffectId::SensorSign => (
            "an instrument with the wrong sign",
            "y = -x",
            "definition of the recordings",
        ),
        _ => return unlisted(label),
    };
    Words { name, equation, source }
}

fn unlisted(label: &str) -> Words {
    let (name, equation) = match label {
        "polytropic exponent" => ("a polytropic gas process", "p V^n = constant"),
        "gas lost" => ("gas being lost", "dm/dt = -k m"),
        "moving mass" => ("a moving mass", "F = m d2x/dt2"),
        "viscous friction" => ("viscous friction", "F = c dx/dt"),
        "parallel stiffness" => ("a stiffness in parallel", "F = k x"),
        _ => ("physics without a name in the vocabulary", "the tabulated law below"),
    };
    Words {
        name,
        equation,
        source: "fitted to the recordings; no name in the vocabulary",
    }
}

/// The name; a law that has none is called after what it relates.
#[must_use]
pub fn called(id: EffectId, label: &str) -> String {
    if id == EffectId::Unlisted && label.contains(" over ") {
        format!("a {label}, which has no name in the vocabulary,")
    } else {
        words(id, label).name.to_owned()
    }
}

/// "in accumulator 1": a place after an effect's name.
#[must_use]
pub fn at(place: &Place) -> String {
    match &place.site {
        Site::Sensor(column) => format!("({column})"),
        Site::MainChamber => "in the main chamber".into(),
        Site::MainSeal => "at the main seal".into(),
        Site::Mount => "at the mount".into(),
        Site::EndStop => "at the end of travel".into(),
        Site::Valves => "(valves 1 to 3)".into(),
        Site::Valve(Valve::Spring) => "(valve 3)".into(),
        Site::Accumulators => "in both accumulators".into(),
        Site::Chamber => "in the gas chamber".into(),
        Site::Paths => "in both paths".into(),
        Site::Unknown => "at a place that the recordings do not tell".into(),
        Site::Accumulator(_) | Site::Path(_) | Site::Valve(_) => {
            format!("in {}", place.site.to_string().replace('-', " "))
        }
    }
}

/// With a capital at its beginning.
#[must_use]
pub fn sentence(text: &str) -> String {
    let mut chars = text.chars();
    chars
        .next()
        .map_or(String::new(), |first| first.to_uppercase().chain(chars).collect())
}

/// Units that end a parameter's key, longest first, and as people write them.
const UNITS: [(&str, &str); 21] = [
    ("_Pa_s_m3", "Pa s/m3"),
    ("_s_MPa2", "s/MPa2"),
    ("_s_MPa", "s/MPa"),
    ("_N_s_m", "N s/m"),
    ("_kg_m4", "kg/m4"),
    ("_per_J", "1/J"),
    ("_N_m3", "N/m3"),
    ("_Pa_s", "Pa/s"),
    ("_1_Pa", "1/Pa"),
    ("_N_m", "N/m"),
    ("_m_N", "m/N"),
    ("_m_s", "m/s"),
    ("_N_s", "N/s"),
    ("_1_s", "1/s"),
    ("_m3", "m3"),
    ("_Pa", "Pa"),
    ("_kg", "kg"),
    ("_N", "N"),
    ("_K", "K"),
    ("_m", "m"),
    ("_s", "s"),
];
/// Keys in which a number before the unit counts places.
const COUNTED: [&str; 2] = ["time_constant", "pressure"];
/// Words of keys without a unit that are relative changes.
const RELATIVE: [&str; 7] = [
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
        .replace('_', " ")
        .replace("coulomb", "Coulomb")
        .replace("stribeck", "Stribeck");
    (format!("{name}{suffix}"), unit.to_owned())
}

/// A value with as many digits as its interval gives meaning to.
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
            ("breakaway_over_coulomb", "breakaway over Coulomb", ""),
            ("drift_Pa_s", "drift", "Pa/s"),
        ] {
            assert_eq!(quantity(key), (name.to_owned(), unit.to_owned()), "{key}");
        }
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

    #[test]
    fn every_id_of_the_vocabulary_has_words() {
        for id in crate::specimen::strut::TERMS
            .into_iter()
            .filter(|id| *id != EffectId::Unlisted)
        {
            assert!(!words(id, "").name.contains("without a name"), "{id}");
        }
    }
}
