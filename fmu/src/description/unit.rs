//! Units as FMI wants them: the text and, where there are any, the exponents of the base units.

/// Base units in the order of FMI's attributes.
pub const BASE: [&str; 5] = ["kg", "m", "s", "K", "rad"];

/// A unit as a product of powers of base units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaseUnit {
    /// Exponents of [`BASE`].
    pub exponents: [i32; BASE.len()],
    /// What one of the unit is in base units.
    pub factor: f64,
}

/// The base units of a text such as `Pa s/m3`: factors, powers behind them, and all behind a stroke below the line. `None` for a unit that has no whole
/// powers, such as `m3/s/sqrt(Pa)`, or is unknown.
pub fn base_unit(text: &str) -> Option<BaseUnit> {
    let mut unit = BaseUnit {
        exponents: [0; BASE.len()],
        factor: 1.0,
    };
    for (place, part) in text.split('/').enumerate() {
        let sign = if place == 0 { 1 } else { -1 };
        for factor in part.split_whitespace().filter(|factor| *factor != "1") {
            let digits = factor.trim_start_matches(|c: char| !c.is_ascii_digit());
            let power: i32 = if digits.is_empty() { 1 } else { digits.parse().ok()? };
            let symbol = factor.strip_suffix(digits)?;
            let (exponents, scale) = of_symbol(symbol)?;
            for (sum, exponent) in unit.exponents.iter_mut().zip(exponents) {
                *sum += sign * power * exponent;
            }
            for _ in 0..power {
                unit.factor = if sign > 0 {
                    unit.factor * scale
                } else {
                    unit.factor / scale
                };
            }
        }
    }
    Some(unit)
}

/// Exponents of kg, m, s, K, rad, and the factor.
fn of_symbol(symbol: &str) -> Option<([i32; BASE.len()], f64)> {
    Some(match symbol {
        "kg" => ([1, 0, 0, 0, 0], 1.0),
        "m" => ([0, 1, 0, 0, 0], 1.0),
        "s" => ([0, 0, 1, 0, 0], 1.0),
        "K" => ([0, 0, 0, 1, 0], 1.0),
        "rad" => ([0, 0, 0, 0, 1], 1.0),
        "N" => ([1, 1, -2, 0, 0], 1.0),
        "Pa" => ([1, -1, -2, 0, 0], 1.0),
        "MPa" => ([1, -1, -2, 0, 0], 1e6),
        "J" => ([1, 2, -2, 0, 0], 1.0),
        "W" => ([1, 2, -3, 0, 0], 1.0),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_products_of_powers() {
        let exponents = |text| base_unit(text).map(|unit| unit.exponents);
        assert_eq!(exponents("m"), Some([0, 1, 0, 0, 0]));
        assert_eq!(exponents("m3/s"), Some([0, 3, -1, 0, 0]));
        assert_eq!(exponents("Pa s/m3"), Some([1, -4, -1, 0, 0]));
        assert_eq!(exponents("N m/rad"), Some([1, 2, -2, 0, -1]));
        assert_eq!(exponents("1/J"), Some([-1, -2, 2, 0, 0]));
        assert_eq!(exponents("m3/s/sqrt(Pa)"), None);
        assert_eq!(base_unit("s/MPa2").map(|unit| unit.factor), Some(1e-12));
    }
}
