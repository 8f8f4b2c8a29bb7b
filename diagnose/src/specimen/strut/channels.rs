//! The columns of a strut's recording.

use oleo_interface::StrutValves;

use crate::recording::{ColumnKind, ColumnSpec, Recording};
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

/// Where the columns of a strut's recordings are: displacement, then the recorded channels, then the three switching signals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Which of [`CHANNELS`] are recorded.
    recorded: [bool; CHANNELS.len()],
}

impl Layout {
    /// A strut on a rig: all channels.
    pub const RIG: Self = Self {
        recorded: [true; CHANNELS.len()],
    };
    /// A strut in a vehicle: no force.
    pub const VEHICLE: Self = Self {
        recorded: [false, true, true, true, true],
    };

    /// The channels of which recordings with all columns hold at least one reading.
    pub fn of_readings(recordings: &[Recording]) -> Self {
        let recorded = std::array::from_fn(|channel| {
            let column = Self::RIG.column(channel);
            (recordings.iter()).any(|r| r.columns[column].iter().any(|v| v.is_finite()))
        });
        Self { recorded }
    }

    /// Takes the columns of channels that are not recorded out of a recording with all columns.
    pub fn without_unrecorded(self, recording: &mut Recording) {
        for channel in (0..CHANNELS.len()).rev().filter(|&channel| !self.has(channel)) {
            recording.columns.remove(Self::RIG.column(channel));
        }
    }

    /// Names of the recorded channels.
    pub fn channels(self) -> Vec<&'static str> {
        self.recorded(CHANNELS.to_vec())
    }

    /// Names of the channels that are not recorded.
    pub fn unrecorded(self) -> impl Iterator<Item = &'static str> {
        let all = CHANNELS.into_iter().enumerate();
        all.filter(move |(channel, _)| !self.has(*channel))
            .map(|(_, name)| name)
    }

    /// Whether a channel of [`CHANNELS`] is recorded.
    pub const fn has(self, channel: usize) -> bool {
        self.recorded[channel]
    }

    /// Position of a recorded channel of [`CHANNELS`] among the recorded ones.
    pub fn channel(self, channel: usize) -> usize {
        (0..channel).filter(|&before| self.has(before)).count()
    }

    /// Position of the column of a recorded channel of [`CHANNELS`].
    pub fn column(self, channel: usize) -> usize {
        1 + self.channel(channel)
    }

    /// Position of the first switching signal.
    pub fn valves(self) -> usize {
        self.column(CHANNELS.len())
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
            "it acts on the force only, which is not recorded; record the strut on a test rig with a load cell"
                .to_owned()
        })
    }

    /// What is recorded of the channels of a strut.
    pub fn recorded<T>(self, all: Vec<T>) -> Vec<T> {
        let all = all.into_iter().enumerate();
        all.filter(|(channel, _)| self.has(*channel))
            .map(|(_, own)| own)
            .collect()
    }
}

/// Columns of a recording: displacement, the five channels, the three switching signals.
#[must_use]
pub fn columns() -> Vec<ColumnSpec> {
    let mut specs = vec![ColumnSpec::new("displacement_m", ColumnKind::Input)];
    specs.extend(CHANNELS.map(ColumnSpec::optional));
    specs.extend(["valve1", "valve2", "valve3"].map(|name| ColumnSpec::new(name, ColumnKind::Switch)));
    specs
}
