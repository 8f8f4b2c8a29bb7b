//! The one reader of model files: struts, vehicles, handling parameters, test specimens and scenarios are all read here.
//!
//! A model file is TOML. Reading it takes three steps, and each of them can fail with one line that names the file, the
//! line, the key, the value that stands there and what would be right:
//!
//! ```text
//!   text --toml--> document --serde--> struct --Checked::check--> model
//!                     |                   |            |
//!                     |                   |            +--> InvalidValue: the path of the key, and what is wrong
//!                     |                   +--> unknown key (with a suggestion), missing key, wrong type
//!                     +--> not TOML
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`range`] | the values that a number may have |
//! | [`limits`] | the table of keys, ranges and units that stands beside every struct of a model file |
//! | [`path`] | the way from the top of a file to one value: `accumulator`, second entry, `static_gas_volume_m3` |
//! | [`error`] | a value that is not allowed, and the same in a file with its line |
//! | [`instruments`] | the tables `[tolerance]` and `[noise]` |
//! | [`names`] | names that are looked up in a list, with a suggestion for a misspelt one |
//!
//! The line of a value is found from its path in the document that toml parsed, which knows the place of every key and
//! every array element. The text is never searched for a key, so a second accumulator is not taken for the first and
//! `stiffness_N_m` is not taken for `presliding_stiffness_N_m`.

mod document;
pub mod error;
pub mod instruments;
pub mod limits;
mod message;
pub mod names;
pub mod path;
pub mod range;

use serde::de::DeserializeOwned;

pub use error::{InvalidValue, ModelFileError};
pub use limits::{Checked, Limit, Quantity, checked};
pub use path::{KeyPath, Step};
pub use range::Range;

/// Read a model from the text of a file and check every value in it. `file` is the name that appears in errors.
///
/// ```
/// use oleo_plant_sim::model_file::read;
/// use oleo_plant_sim::strut::StrutModel;
///
/// let text = StrutModel::defender110(8000.0).to_toml();
/// assert!(read::<StrutModel>(&text, "strut.toml").is_ok());
///
/// let line = 1 + text.lines().position(|line| line.starts_with("bore_m")).unwrap();
/// let error = read::<StrutModel>(&text.replace("bore_m = 0.05", "bore_m = 50.0"), "strut.toml").unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     format!("strut.toml:{line}: [cylinder] bore_m is 50: must be from 0.001 to 2 m")
/// );
/// ```
///
/// # Errors
/// The text is not TOML, a key is unknown or missing, or a value is of the wrong type or outside its range.
pub fn read<T: DeserializeOwned + Checked>(text: &str, file: &str) -> Result<T, ModelFileError> {
    let model: T = toml::from_str(text).map_err(|error| message::in_file(&error, text, file))?;
    model.check().map_err(|invalid| invalid.in_file(text, file))?;
    Ok(model)
}
