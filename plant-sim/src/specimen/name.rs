//! The table `[specimen]`, which every model file has.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, InvalidValue, Limit, ModelFileError, checked, read};

/// Which specimen a model file is of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SpecimenName {
    /// Name of the individual.
    pub name: String,
    /// Kind, for example `gas spring`.
    pub kind: String,
}

impl Checked for SpecimenName {
    const LIMITS: &'static [Limit<Self>] = &[];
}

/// A model file, read no further than its table `[specimen]`.
#[derive(Deserialize)]
struct Head {
    specimen: SpecimenName,
}

impl Checked for Head {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        checked(&self.specimen, "specimen")
    }
}

/// The table `[specimen]` of any model file. `file` is the name that appears in errors.
///
/// ```
/// use oleo_plant_sim::specimen::specimen_name;
/// let text = "[specimen]\nname = \"lower\"\nkind = \"gas spring\"\n[chamber]\n";
/// assert_eq!(specimen_name(text, "model.toml").unwrap().kind, "gas spring");
/// assert!(specimen_name("[chamber]\n", "model.toml").is_err());
/// ```
///
/// # Errors
/// The text is not TOML, or the table is missing or incomplete.
pub fn specimen_name(text: &str, file: &str) -> Result<SpecimenName, ModelFileError> {
    Ok(read::<Head>(text, file)?.specimen)
}
