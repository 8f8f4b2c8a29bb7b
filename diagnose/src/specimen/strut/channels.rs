//! The columns of a strut's recording.

use oleo_interface::StrutValves;

use crate::recording::{ColumnKind, ColumnSpec, Recording};
use crate::specimen::channel::Series;
use crate::vocabulary::Site;

/// Columns of the compared channels of a strut on a rig, in their order. A vehicle does not record the force.
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

/// Where the columns of a strut's recordings are: displacement, then the channels, then the three switching signals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Number of channels of [`CHANNELS`] that are not recorded; they are the first ones.
    unrecorded: usize,
}

impl Layout {
    /// A strut on a rig: all channels.
    pub const RIG: Self = Self { unrecorded: 0 };
    /// A strut in a vehicle: no force.
    pub const VEHICLE: Self = Self { unrecorded: P1 };

    /// Names of the recorded channels.
    pub fn channels(self) -> &'static [&'static str] {
        CHANNELS.get(self.unrecorded..).unwrap_or(&[])
    }

    /// Whether a channel of [`CHANNELS`] is recorded.
    pub const fn has(self, channel: usize) -> bool {
        channel >= self.unrecorded
    }

    /// Position of a recorded channel of [`CHANNELS`] among the recorded ones.
    pub const fn channel(self, channel: usize) -> usize {
        channel - self.unrecorded
    }

    /// Position of the column of a recorded channel of [`CHANNELS`].
    pub const fn column(self, channel: usize) -> usize {
        1 + self.channel(channel)
    }

    /// Position of the first switching signal.
    pub const fn valves(self) -> usize {
        1 + CHANNELS.len() - self.unrecorded
    }

    /// The switching signals of a recording.
    pub fn signals(self, recording: &Recording) -> Vec<StrutValves<bool>> {
        (0..recording.len())
            .map(|k| StrutValves::from_fn(|valve| recording.columns[self.valves() + valve.index()][k] > 0.5))
            .collect()
    }

    /// Why what acts at a site cannot be seen, where its only channel is not recorded.
    pub fn unseen(self, site: &Site) -> Option<String> {
        let only_in_force = matches!(site, Site::MainSeal | Site::EndStop);
        (only_in_force && !self.has(FORCE)).then(|| {
            "it acts on the force only, which a vehicle does not record; record the strut on a test rig".to_owned()
        })
    }

    /// The simulated channels of a strut that are recorded.
    pub fn recorded(self, mut all: Series) -> Series {
        all.drain(..self.unrecorded);
        all
    }
}

/// Columns of a recording: displacement, the five channels, the three switching signals.
#[must_use]
pub fn columns() -> Vec<ColumnSpec> {
    let mut specs = vec![ColumnSpec::new("displacement_m", ColumnKind::Input)];
    specs.extend(CHANNELS.map(|name| ColumnSpec::new(name, ColumnKind::Output)));
    specs.extend(["valve1", "valve2", "valve3"].map(|name| ColumnSpec::new(name, ColumnKind::Switch)));
    specs
}
