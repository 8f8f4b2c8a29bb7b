//! Reads the map of the columns of recordings that another program wrote.

use std::path::Path;

use oleo_plant_sim::rig::ColumnMap;

use crate::failure::Failure;

/// The map in a file.
pub fn column_map(path: &Path) -> Result<ColumnMap, Failure> {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::new(format!("{file}: cannot read the column map: {error}; check the path")))?;
    Ok(ColumnMap::from_toml(&text, &file)?)
}
