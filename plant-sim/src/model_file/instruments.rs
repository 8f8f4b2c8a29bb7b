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

/// Refuse a model that does not state the noise of every channel. Simulation does without; a diagnosis, which judges every
/// residual by it, does not.
///
/// # Errors
/// The channels whose noise is missing.
pub fn check_noise_is_complete(noise: &BTreeMap<String, f64>, channels: &[&str]) -> Result<(), InvalidValue> {
    let missing: Vec<&str> = channels
        .iter()
        .filter(|channel| !noise.contains_key(**channel))
        .copied()
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let what = format!(
        "says nothing of {}: give the standard deviation of every channel's noise",
        missing.join(", ")
    );
    Err(InvalidValue::new("noise", what))
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
        let noise = table(&[("force_N", 12.0)]);
        let missing = check_noise_is_complete(&noise, &CHANNELS).unwrap_err().to_string();
        assert!(
            missing.starts_with("noise says nothing of displacement_m, p_Pa: "),
            "{missing}"
        );
        assert!(check_noise_is_complete(&noise, &["force_N"]).is_ok());
    }
}
