//! Laws that the vocabulary has no name for.
//!
//! What is searched for on a strut is a product: a *place* of the network, a quantity that the law *depends on* there, and
//! a *form*, which makes a table of a few fitted numbers. Only the forms are code; the product is the data of `strut_laws`.
//!
//! | file | what it holds |
//! |---|---|
//! | `nameless` | the effect `unlisted` |
//! | `forms/` | one file for each form |
//! | `knots` | points of the tables |
//! | `strut_laws` | place x dependence x form: the laws that are tried on a strut |
//! | `cylinder_laws`, `gas_spring_laws`, `mechanism_laws` | laws of one number that only these kinds of specimen may have |
//! | `believed_numbers` | numbers of a strut's model that may be other than believed |
//! | `textbook`, `swinging_textbook` | other laws, for the self-test to conceal |
//! | `unfamiliar` | laws of shapes that no textbook has, for the same |
//!
//! A new form is a file in `forms` and its name in the rows of `strut_laws`. A new quantity to depend on is a variant of
//! plant-sim's `LawArgument`, which the solver must read at the place. A law with a state of its own (heat, memory) is not
//! a table of a quantity: it needs a term in plant-sim and then, having a name, an effect.

mod believed_numbers;
mod co_simulation_laws;
mod cylinder_laws;
mod forms;
mod gas_spring_laws;
mod knots;
mod mechanism_laws;
mod nameless;
mod strut_laws;
mod swinging_textbook;
mod textbook;
mod unfamiliar;
mod words;

use super::candidate::Candidate;

pub use believed_numbers::is_label as is_believed_number;
pub use believed_numbers::variants as variants_of_believed_numbers;
pub use forms::is_of_free_table;
pub use nameless::Unlisted;
pub use strut_laws::table;
pub use textbook::{pairs_of_variants, periodic_variants};
pub use unfamiliar::variants as unfamiliar_variants;

#[cfg(test)]
pub use strut_laws::candidates as candidates_of_struts;

/// Numbers with which a law of a strut comes near another one; `None` where they do not act at the same place over the same quantity. The longest
/// recording lasts this long, s.
#[must_use]
pub fn near(law: &Candidate, other: &Candidate, fitted: &[f64], longest_s: f64) -> Option<Vec<f64>> {
    strut_laws::near(&law.label, &other.label, fitted, longest_s)
}

/// What was found of a candidate of a strut, as an equation with its numbers; `None` for a law that is drawn.
#[must_use]
pub fn equation(candidate: &Candidate, fitted: &[f64]) -> Option<String> {
    believed_numbers::found(candidate, fitted).or_else(|| strut_laws::equation(&candidate.label, fitted))
}
