//! The unit in which a column is drawn. Its name ends in the unit of its values.

use oleo_report::Axis;

/// End of a name, unit in which it is drawn, and factor to it.
const ENDS: [(&str, &str, f64); 10] = [
    ("_rad_s2", "rad/s2", 1.0),
    ("_rad_s", "degrees/s", 180.0 / std::f64::consts::PI),
    ("_rad", "degrees", 180.0 / std::f64::consts::PI),
    ("_m_s2", "m/s2", 1.0),
    ("_m_s", "m/s", 1.0),
    ("_m", "m", 1.0),
    ("_N", "kN", 1e-3),
    ("_Pa", "MPa", 1e-6),
    ("_K", "K", 1.0),
    ("_s", "s", 1.0),
];

/// Lengths that are small beside a metre.
const SHORT: [&str; 4] = ["displacement", "heave", "front_axle_heave", "road"];

/// What a column is, in words, the unit in which it is drawn and the factor to this unit.
pub fn quantity(name: &str) -> (String, &'static str, f64) {
    let found = ENDS
        .iter()
        .find_map(|(end, unit, factor)| Some((name.strip_suffix(end)?, *unit, *factor)));
    let (stem, unit, factor) = found.unwrap_or((name, "", 1.0));
    let short = unit == "m" && SHORT.iter().any(|begin| stem.starts_with(begin));
    let (unit, factor) = if short { ("mm", 1e3) } else { (unit, factor) };
    let mut words = stem.replace('_', " ");
    // p1 is a name; other words begin a label.
    if let Some(first) = words.get_mut(..1).filter(|_| !stem.starts_with('p') || stem.len() > 2) {
        first.make_ascii_uppercase();
    }
    (words, unit, factor)
}

/// The axis of a column.
pub fn axis(name: &str) -> Axis {
    let (words, unit, _) = quantity(name);
    Axis::new(&words, unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_name_is_its_unit() {
        for (name, words, unit) in [
            ("roll_rad", "Roll", "degrees"),
            ("lateral_acceleration_m_s2", "Lateral acceleration", "m/s2"),
            ("displacement_front_left_m", "Displacement front left", "mm"),
            ("station_m", "Station", "m"),
            ("p1_Pa", "p1", "MPa"),
            ("handling", "Handling", ""),
        ] {
            let found = quantity(name);
            assert_eq!((found.0.as_str(), found.1), (words, unit), "{name}");
        }
    }
}
