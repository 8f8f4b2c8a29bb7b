//! An equation and its source as they are shown on a page.

/// The equation of a term and where it comes from.
///
/// It stands in the term's file beside the code that computes it, and pages and documents print it from there, so that
/// what is printed is what is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Equation {
    /// The equation in the symbols of the term's documentation, for example `g = mu |F| / (1 + s x)`.
    pub text: &'static str,
    /// Who published it, or that it is assumed.
    pub source: &'static str,
}
