//! The curves: what grows, and at which sizes it is measured.

use strum::VariantArray;

/// A curve of cost over work.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, strum::Display, strum::EnumString, strum::IntoStaticStr, strum::VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Curve {
    /// Closed loops without a bus.
    Vehicles,
    /// A diagnosis.
    Samples,
    /// The same.
    Candidates,
    /// `oleo convert` from frames to frames.
    LogFrames,
    /// `oleo convert` from frames to columns.
    LogColumns,
}

impl Curve {
    /// All curves in the order of the page.
    pub const ALL: [Self; 5] = [
        Self::Vehicles,
        Self::Samples,
        Self::Candidates,
        Self::LogFrames,
        Self::LogColumns,
    ];

    /// What the help says of a curve.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Vehicles => "Closed loops over the number of vehicles",
            Self::Samples => "A diagnosis over the number of samples that were recorded",
            Self::Candidates => "A diagnosis over the number of effects that it may find",
            Self::LogFrames => "oleo convert from candump to ASC over the number of frames",
            Self::LogColumns => "oleo convert from candump to CSV over the number of frames",
        }
    }

    /// What is counted on the horizontal axis.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Vehicles => "vehicles",
            Self::Samples => "samples",
            Self::Candidates => "candidates",
            Self::LogFrames | Self::LogColumns => "frames",
        }
    }

    /// What the work does most of, and is counted.
    pub fn operation(self) -> &'static str {
        match self {
            Self::Vehicles => "vehicle tick",
            Self::Samples | Self::Candidates => "simulated recording",
            Self::LogFrames | Self::LogColumns => "frame",
        }
    }

    /// What exactly is done.
    pub fn explained(self) -> &'static str {
        match self {
            Self::Vehicles => {
                "As oleo study control does on all cores: every vehicle (handling model, four struts, sensors with noise, the \
                 controller with its default strategy) drives 2 s straight ahead on a class C road of its own at 60 km/h. 400 ticks of 5 ms a \
                 vehicle; making the vehicle and its road is part of the work."
            }
            Self::Samples => {
                "A whole oleo diagnose from reading the files to the content of report.json, on all cores: two recordings of a strut at 200 Hz whose second \
                 accumulator holds 10 % more gas than its model says. Beyond 200,000 samples of one recording the reader thins, so the curve ends before."
            }
            Self::Candidates => {
                "The same with 4,000 samples, without reading and writing, where only so many of the named effects may be found; the one that is missing is always among them. \
                 With one candidate there is nothing to choose."
            }
            Self::LogFrames => {
                "A candump log of the default scenario, repeated up to the size. Frames pass through one at a time. One thread."
            }
            Self::LogColumns => {
                "The same log, from which the displacements, pressures and valves of its drive are written. One thread."
            }
        }
    }

    /// Sizes at which the curve is measured, rising.
    pub fn sizes(self, quick: bool) -> &'static [u64] {
        match (self, quick) {
            (Self::Vehicles, true) => &[1, 3, 10, 30, 100],
            (Self::Vehicles, false) => &[1, 2, 5, 10, 20, 50, 100, 200, 500, 1_000, 2_000, 5_000, 10_000],
            (Self::Samples, true) => &[1_000, 1_500, 2_000, 3_000, 4_000],
            (Self::Samples, false) => &[1_000, 2_000, 4_000, 8_000, 16_000, 32_000, 64_000, 128_000],
            (Self::Candidates, true) => &[1, 2, 4, 8, 16],
            (Self::Candidates, false) => &[1, 2, 4, 8, 12, 16, 24, 32],
            (Self::LogFrames | Self::LogColumns, true) => &[10_000, 20_000, 30_000, 60_000, 100_000],
            (Self::LogFrames | Self::LogColumns, false) => &[10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000],
        }
    }

    /// Its name on the command line and in the summary.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

const _: () = assert!(Curve::ALL.len() == Curve::VARIANTS.len());
