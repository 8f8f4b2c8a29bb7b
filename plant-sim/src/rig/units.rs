//! Units in which other programs state a quantity, each with its size in ours.

/// The units of a kind of quantity, by the end of our names.
const UNITS: [(&str, &[(&str, f64)]); 4] = [
    ("_s", &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("min", 60.0)]),
    ("_m", &[("m", 1.0), ("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254)]),
    ("_N", &[("N", 1.0), ("kN", 1e3), ("lbf", 4.448_221_615_260_5)]),
    (
        "_Pa",
        &[
            ("Pa", 1.0),
            ("kPa", 1e3),
            ("MPa", 1e6),
            ("bar", 1e5),
            ("psi", 6_894.757_293_168_36),
        ],
    ),
];

/// The units of a name's quantity besides its own, with the size of each in that; none of a name without a unit.
///
/// ```
/// let of_pressures: Vec<(&str, f64)> = oleo_plant_sim::rig::other_units("p1_Pa").collect();
/// assert!(of_pressures.contains(&("bar", 1e5)) && !of_pressures.contains(&("Pa", 1.0)));
/// ```
pub fn other_units(name: &str) -> impl Iterator<Item = (&'static str, f64)> {
    let of_quantity = UNITS.iter().find(|(end, _)| name.ends_with(end));
    let units = of_quantity.map_or(&[][..], |(_, units)| units);
    units.iter().copied().filter(|&(_, size)| size != 1.0)
}

/// The size of a unit in that of our name, such as 0.001 for `mm` of `displacement_m`.
///
/// ```
/// assert_eq!(oleo_plant_sim::rig::unit_size("p1_Pa", "bar"), Ok(1e5));
/// assert!(oleo_plant_sim::rig::unit_size("p1_Pa", "mm").unwrap_err().contains("the units are Pa, kPa"));
/// ```
///
/// # Errors
/// A name without a unit, or a unit of another quantity, in one line.
pub fn unit_size(name: &str, unit: &str) -> Result<f64, String> {
    let Some((_, units)) = UNITS.iter().find(|(end, _)| name.ends_with(end)) else {
        return Err(format!("{name}: has no unit; leave out unit = {unit:?}"));
    };
    match units.iter().find(|(known, _)| *known == unit) {
        Some((_, size)) => Ok(*size),
        None => {
            let known: Vec<&str> = units.iter().map(|(known, _)| *known).collect();
            Err(format!(
                "{name}: {unit:?} is not a unit of it; the units are {}",
                known.join(", ")
            ))
        }
    }
}
