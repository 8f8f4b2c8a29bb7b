//! The tables `[tolerance]` and `[noise]`, which the model of every specimen has.

use std::collections::BTreeMap;

use super::error::InvalidValue;
use super::limits::Quantity;
use super::names::only_known;
use super::range::Range;

/// A tolerance or a standard deviation: not negative, in the unit that its name says.
const SIZE: Range = Range::FromTo(0.0, 1e12);

/// Check the table `[tolerance]`: how far nominal values may be off. Its keys are the names of what can be calibrated.
///
/// # Errors
/// A name that nothing is calibrated by, or a tolerance that is negative or not finite.
pub fn check_tolerance(tolerance: &BTreeMap<String, f64>, known: &[&str]) -> Result<(), InvalidValue> {
    only_known(tolerance, known, "tolerance of this specimen", "tolerances")
        .and_then(|()| sizes(tolerance))
        .map_err(|invalid| invalid.inside("tolerance"))
}

/// Check the table `[noise]`: the standard deviation of each channel's white noise. Its keys are the channels.
///
/// # Errors
/// A channel that the specimen does not have, or a standard deviation that is negative or not finite.
pub fn check_noise(noise: &BTreeMap<String, f64>, channels: &[&str]) -> Result<(), InvalidValue> {
    only_known(noise, channels, "channel of this specimen", "channels")
        .and_then(|()| sizes(noise))
        .map_err(|invalid| invalid.inside("noise"))
}

/// Refuse a model that does not state the noise of every channel, or states none for a channel that is `compared` with the
/// model. Simulation does without; a diagnosis does not, because it judges every residual by the noise of its channel.
///
/// # Errors
/// The channels whose noise is missing, all at once; a compared channel whose noise is zero.
pub fn check_noise_is_complete(
    noise: &BTreeMap<String, f64>,
    channels: &[&str],
    compared: &[&str],
) -> Result<(), InvalidValue> {
    let mut missing = channels
        .iter()
        .filter(|channel| !noise.contains_key(**channel))
        .copied();
    if let Some(first) = missing.next() {
        return Err(missing_noise(first, &missing.collect::<Vec<_>>()));
    }
    compared
        .iter()
        .try_for_each(|channel| noise_of_compared(noise, channel).map(drop))
}

/// Standard deviation of the noise of a channel that is compared with the model, in the unit of its name; above 0.
///
/// # Errors
/// The noise is missing or zero.
pub fn noise_of_compared(noise: &BTreeMap<String, f64>, channel: &str) -> Result<f64, InvalidValue> {
    match noise.get(channel) {
        Some(&deviation) if deviation > 0.0 => Ok(deviation),
        Some(_) => {
            let what = "is 0: must be above 0, because the residuals of this channel are divided by it";
            Err(InvalidValue::new(channel.to_owned(), what).inside("noise"))
        }
        None => Err(missing_noise(channel, &[])),
    }
}

fn missing_noise(first: &str, others: &[&str]) -> InvalidValue {
    let others = match others {
        [] => String::new(),
        [one] => format!(", and so is {one}"),
        several => format!(", and so are {}", several.join(", ")),
    };
    let what = format!("is missing{others}: state the standard deviation of the noise of every recorded channel");
    InvalidValue::new(first.to_owned(), what).inside("noise")
}

fn sizes(table: &BTreeMap<String, f64>) -> Result<(), InvalidValue> {
    let size = Quantity {
        key: "",
        range: SIZE,
        unit: "",
    };
    table
        .iter()
        .try_for_each(|(name, value)| size.check(*value, name.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHANNELS: [&str; 3] = ["displacement_m", "force_N", "p_Pa"];

    fn table(entries: &[(&str, f64)]) -> BTreeMap<String, f64> {
        entries
            .iter()
            .map(|(name, value)| ((*name).to_owned(), *value))
            .collect()
    }

    #[test]
    fn a_misspelt_channel_and_a_negative_deviation_are_refused() {
        let complaint = |entry| check_noise(&table(&[entry]), &CHANNELS).map_err(|invalid| invalid.to_string());
        assert_eq!(complaint(("p_Pa", 300.0)), Ok(()));
        assert_eq!(
            complaint(("p_pa", 300.0)),
            Err(
                "[noise] p_pa is not a channel of this specimen: did you mean p_Pa? The channels are displacement_m, \
                 force_N, p_Pa"
                    .to_owned()
            )
        );
        assert_eq!(
            complaint(("p_Pa", -1.0)),
            Err("[noise] p_Pa is -1: must be from 0 to 1e12".to_owned())
        );
        let tolerance = check_tolerance(&table(&[("aera", 0.1)]), &["area", "mass"]).unwrap_err();
        assert!(
            tolerance
                .to_string()
                .starts_with("[tolerance] aera is not a tolerance of this specimen: did you mean area?")
        );
    }

    #[test]
    fn missing_channels_are_named_all_at_once() {
        let complaint = |noise: &[(&str, f64)]| {
            check_noise_is_complete(&table(noise), &CHANNELS, &CHANNELS[1..]).map_err(|invalid| invalid.to_string())
        };
        let starts = |noise: &[(&str, f64)], start: &str| complaint(noise).is_err_and(|said| said.starts_with(start));
        assert!(starts(
            &[],
            "[noise] displacement_m is missing, and so are force_N, p_Pa: state the"
        ));
        assert!(starts(
            &[("force_N", 12.0)],
            "[noise] displacement_m is missing, and so is p_Pa: state the"
        ));
        assert!(starts(
            &[("displacement_m", 1e-5), ("force_N", 12.0)],
            "[noise] p_Pa is missing: state the"
        ));
    }

    #[test]
    fn an_input_may_be_exact_but_no_channel_that_is_compared() {
        let check = |displacement, force| {
            let noise = table(&[("displacement_m", displacement), ("force_N", force), ("p_Pa", 300.0)]);
            check_noise_is_complete(&noise, &CHANNELS, &CHANNELS[1..]).map_err(|invalid| invalid.to_string())
        };
        assert_eq!(check(0.0, 12.0), Ok(()));
        assert!(check(0.0, 0.0).is_err_and(|said| said.starts_with("[noise] force_N is 0: must be above 0")));
        assert_eq!(noise_of_compared(&table(&[("p_Pa", 300.0)]), "p_Pa"), Ok(300.0));
        assert!(noise_of_compared(&table(&[]), "p_Pa").is_err());
    }
}
