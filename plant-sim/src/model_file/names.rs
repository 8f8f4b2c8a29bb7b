//! Looks names up in a list and suggests the nearest one for a misspelt name.

use std::collections::BTreeMap;
use std::str::FromStr;

use strum::VariantNames;

use super::error::InvalidValue;

/// How alike two names must be for the one to be suggested for the other, from 0 (nothing in common) to 1 (the same).
/// At 0.6 `boar_m` still suggests `bore_m`, and `p1_Pa` does not suggest `force_N`.
const ALIKE: f64 = 0.6;
/// Fewest bytes of a name that is recognised as a part of another.
const SHORTEST_PART: usize = 3;

/// The known name that was probably meant, if one is similar. Upper and lower case do not count; a name that holds the
/// other in full is similar.
///
/// ```
/// use oleo_plant_sim::model_file::names::did_you_mean;
/// assert_eq!(did_you_mean("p_pa", ["force_N", "p_Pa"]), Some("p_Pa"));
/// assert_eq!(did_you_mean("speed", ["force_N", "p_Pa"]), None);
/// ```
pub fn did_you_mean<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    known
        .into_iter()
        .map(|candidate| {
            let known = candidate.to_lowercase();
            let alike = strsim::normalized_damerau_levenshtein(&name, &known);
            let holds = name.len() >= SHORTEST_PART && (known.contains(&name) || name.contains(&known));
            (if holds { 1.0 + alike } else { alike }, candidate)
        })
        .filter(|(alike, _)| *alike >= ALIKE)
        // The first of those that are equally alike, so that the answer does not depend on luck.
        .reduce(|best, next| if next.0 > best.0 { next } else { best })
        .map(|(_, candidate)| candidate)
}

/// The end of a sentence about a name that is not in a list: `did you mean p_Pa? The channels are force_N, p_Pa`.
pub fn suggestion(name: &str, known: &[&str], what_they_are: &str) -> String {
    let list = format!("{what_they_are} are {}", known.join(", "));
    match did_you_mean(name, known.iter().copied()) {
        Some(meant) => format!("did you mean {meant}? The {list}"),
        None => format!("the {list}"),
    }
}

/// Refuse a table with a key that is not in the list. `singular` and `plural` say what its keys are: a channel, channels.
///
/// # Errors
/// The first unknown key, with the known ones.
pub fn only_known(
    table: &BTreeMap<String, f64>,
    known: &[&str],
    singular: &str,
    plural: &str,
) -> Result<(), InvalidValue> {
    match table.keys().find(|name| !known.contains(&name.as_str())) {
        None => Ok(()),
        Some(name) => Err(InvalidValue::new(
            name.clone(),
            format!("is not a {singular}: {}", suggestion(name, known, plural)),
        )),
    }
}

/// A value that a key names out of a list; the type's default where the key is absent.
///
/// ```
/// use oleo_plant_sim::model_file::names::one_of;
/// #[derive(Default, Debug, PartialEq, strum::EnumString, strum::VariantNames)]
/// #[strum(serialize_all = "lowercase")]
/// enum Gear {
///     #[default]
///     Low,
///     High,
/// }
/// assert_eq!(one_of("gear", Some("high")), Ok(Gear::High));
/// assert_eq!(one_of("gear", None), Ok(Gear::Low));
/// assert_eq!(
///     one_of::<Gear>("gear", Some("reverse")).unwrap_err().to_string(),
///     "gear is \"reverse\": must be one of low, high"
/// );
/// ```
///
/// # Errors
/// A name that is not in the list, with those that are.
pub fn one_of<T: Default + FromStr + VariantNames>(key: &'static str, name: Option<&str>) -> Result<T, InvalidValue> {
    let Some(name) = name else { return Ok(T::default()) };
    name.parse().map_err(|_| {
        let what = format!("is {name:?}: must be one of {}", T::VARIANTS.join(", "));
        InvalidValue::new(key, what)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_alike_name_is_suggested() {
        let known = ["p1_Pa", "p2_Pa", "force_N", "displacement_m"];
        assert_eq!(did_you_mean("p2_pa", known), Some("p2_Pa"));
        assert_eq!(did_you_mean("displacment_m", known), Some("displacement_m"));
        assert_eq!(did_you_mean("force", known), Some("force_N"));
        assert_eq!(did_you_mean("", known), None);
        assert_eq!(did_you_mean("temperature", known), None);
    }

    #[test]
    fn an_unknown_key_names_the_known_ones() {
        let noise = BTreeMap::from([("force_N".to_owned(), 1.0), ("p_pa".to_owned(), 2.0)]);
        let invalid = only_known(&noise, &["force_N", "p_Pa"], "channel", "channels").unwrap_err();
        assert_eq!(
            invalid.inside("noise").to_string(),
            "[noise] p_pa is not a channel: did you mean p_Pa? The channels are force_N, p_Pa"
        );
        assert!(only_known(&noise, &["force_N", "p_pa"], "channel", "channels").is_ok());
    }
}
