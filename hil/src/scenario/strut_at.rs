//! Struts that differ from the others: the table `[strut_at]` of a scenario names their model files by corner.

use oleo_interface::{Corner, Corners};
use serde::Deserialize;
use toml::{Table, Value};

/// The table as it stands in the file.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
pub(super) struct StrutAt {
    front_left: Option<String>,
    front_right: Option<String>,
    rear_left: Option<String>,
    rear_right: Option<String>,
}

impl StrutAt {
    pub fn by_corner(self) -> Corners<Option<String>> {
        Corners::from_array([self.front_left, self.front_right, self.rear_left, self.rear_right])
    }
}

/// Name of the file in the results of a run that holds the model of the strut at a corner, if it differs from the others.
#[must_use]
pub fn kept_as(corner: Corner) -> String {
    format!("strut-{}.toml", corner.name())
}

/// The table that names the files in the results of a run; none where no strut differs.
pub(super) fn as_table(struts: &Corners<Option<String>>) -> Option<Value> {
    let named = struts.iter().filter(|(_, path)| path.is_some());
    let table: Table = named
        .map(|(corner, _)| (corner.key().to_owned(), kept_as(corner).into()))
        .collect();
    (!table.is_empty()).then_some(Value::Table(table))
}
