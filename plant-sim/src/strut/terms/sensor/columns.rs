//! The columns that instruments stand behind, and the sizes of their faults.

use std::collections::BTreeMap;

use crate::model_file::InvalidValue;
use crate::model_file::names::suggestion;
use crate::strut::terms::id::TermId;

/// Columns of a strut's recording that an instrument stands behind.
pub const COLUMNS: [&str; 6] = ["displacement_m", "force_N", "p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"];

/// A fault of instruments: name of the column to size of the fault, in the unit of the fault's own file.
pub type SensorEffect = BTreeMap<String, f64>;

/// Refuse a column that no instrument stands behind, and a fault of impossible size. `fault` is the kind of fault, `effect`
/// its columns, `columns` those that the specimen has.
///
/// ```
/// use oleo_plant_sim::strut::{SensorEffect, TermId, check_columns};
/// let lag = SensorEffect::from([("p_pa".to_owned(), 0.01)]);
/// let invalid = check_columns(TermId::SensorLag, Some(&lag), &["p_Pa"]).unwrap_err();
/// assert_eq!(
///     invalid.to_string(),
///     "[sensor_lag] p_pa is not a column with an instrument: did you mean p_Pa? The columns are p_Pa"
/// );
/// ```
///
/// # Errors
/// The first column that is unknown or whose value is out of range.
pub fn check_columns(fault: TermId, effect: Option<&SensorEffect>, columns: &[&str]) -> Result<(), InvalidValue> {
    check_sizes(fault, effect, columns).map_err(|invalid| invalid.inside(fault.key()))
}

/// The same, with the path of the error counted from the fault's own table.
pub(in crate::strut::terms) fn check_sizes(
    fault: TermId,
    effect: Option<&SensorEffect>,
    columns: &[&str],
) -> Result<(), InvalidValue> {
    for (column, value) in effect.into_iter().flatten() {
        if !columns.contains(&column.as_str()) {
            let what = format!(
                "is not a column with an instrument: {}",
                suggestion(column, columns, "columns")
            );
            return Err(InvalidValue::new(column.clone(), what));
        }
        for size in fault.quantities() {
            size.check(*value, column.clone())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_columns_and_impossible_sizes_are_refused() {
        let check = |column: &str, value: f64| {
            let effect = SensorEffect::from([(column.to_owned(), value)]);
            check_columns(TermId::SensorLag, Some(&effect), &COLUMNS).map_err(|e| e.to_string())
        };
        assert_eq!(check("p1_Pa", 0.01), Ok(()));
        assert_eq!(
            check("p1_Pa", -0.01),
            Err("[sensor_lag] p1_Pa is -0.01: must be from 0 to 1000000 s".to_owned())
        );
        assert!(check("p1_pa", 0.01).unwrap_err().contains("did you mean p1_Pa?"));
    }
}
