//! The columns of a strut's recording.

use crate::recording::{ColumnKind, ColumnSpec};

/// Columns of the compared channels, in their order.
pub const CHANNELS: [&str; 5] = ["force_N", "p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"];
/// Position of the force in [`CHANNELS`].
pub const FORCE: usize = 0;
/// Position of p1, the main cylinder.
pub const P1: usize = 1;
/// Position of p2, the oil side of accumulator 1.
pub const P2: usize = 2;
/// Position of p3, between damper 2 and valve 3.
pub const P3: usize = 3;
/// Position of p4, the oil side of accumulator 2.
pub const P4: usize = 4;

/// Columns of a recording: displacement, the five channels, the three switching signals.
#[must_use]
pub fn columns() -> Vec<ColumnSpec> {
    let mut specs = vec![ColumnSpec::new("displacement_m", ColumnKind::Input)];
    specs.extend(CHANNELS.map(|name| ColumnSpec::new(name, ColumnKind::Output)));
    specs.extend(["valve1", "valve2", "valve3"].map(|name| ColumnSpec::new(name, ColumnKind::Switch)));
    specs
}
