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
//! | `textbook`, `swinging_textbook` | other laws, for the self-test to conceal |
//!
//! A new form is a file in `forms` and its name in the rows of `strut_laws`. A new quantity to depend on is a variant of
//! plant-sim's `LawArgument`, which the solver must read at the place. A law with a state of its own (heat, memory) is not
//! a table of a quantity: it needs a term in plant-sim and then, having a name, an effect.

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
mod words;

pub use forms::is_of_free_table;
pub use nameless::Unlisted;
pub use strut_laws::{equation, table};
pub use textbook::{pairs_of_variants, periodic_variants};

#[cfg(test)]
pub use strut_laws::candidates as candidates_of_struts;
