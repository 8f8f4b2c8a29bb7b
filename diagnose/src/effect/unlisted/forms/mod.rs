//! Forms of laws: how a table comes from a few fitted numbers, one file for each.
//!
//! | form | its value | fitted |
//! |---|---|---|
//! | `added` | is added; zero at rest | rises from knot to knot, of any sign |
//! | `rising` | is added and never falls with its argument | rises from knot to knot, none negative |
//! | `level` | is added and never negative | the value at each knot |
//! | `factor` | multiplies what is believed; one at rest | logarithmic rises from knot to knot |
//! | `bell` | is added around one argument | height, position, half width |
//! | `choke` | multiplies what is believed, and falls with the size of its argument | inverse argument, exponent |

mod added;
mod bell;
mod choke;
mod factor;
mod form;
mod level;
mod rises;
mod rising;

#[cfg(test)]
mod tests;

pub use added::Added;
pub use bell::Bell;
pub use choke::Choke;
pub use factor::Factor;
pub use form::{Form, Grid};
pub use level::Level;
pub use rising::Rising;
