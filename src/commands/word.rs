//! Reads options that accept one of several words, which a library crate defines.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Reads one of the words of `T`, which the help explains as `of` does.
pub fn described<T>(of: fn(T) -> &'static str) -> impl TypedValueParser<Value = T>
where
    T: std::str::FromStr<Err = strum::ParseError> + strum::VariantArray + Copy + Into<&'static str> + Send + Sync,
{
    let values = T::VARIANTS.iter().map(|word| {
        let name: &'static str = (*word).into();
        PossibleValue::new(name).help(of(*word))
    });
    PossibleValuesParser::new(values).try_map(|name| name.parse::<T>())
}

/// Reads one of the words of `T`; the complaint lists them.
pub fn word<T>(text: &str) -> Result<T, String>
where
    T: std::str::FromStr + strum::VariantArray + Copy + Into<&'static str>,
{
    let words = || {
        T::VARIANTS
            .iter()
            .map(|word| (*word).into())
            .collect::<Vec<&str>>()
            .join(", ")
    };
    text.parse().map_err(|_| format!("give one of {}", words()))
}
