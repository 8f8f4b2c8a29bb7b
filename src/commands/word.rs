//! Reads options that accept one of several words, which a library crate defines.

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
