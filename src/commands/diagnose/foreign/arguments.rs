//! What the command line says of somebody else's model, and what it is compared with.

use std::path::{Path, PathBuf};

use oleo_diagnose::KeptBack;

/// Somebody else's model, and how it goes with recordings.
#[derive(clap::Args)]
pub struct ForeignArgs {
    /// Somebody else's model: a functional mock-up unit for co-simulation, FMI 2.0 or 3.0 (docs/fmu.md)
    #[arg(long, value_name = "MODEL.fmu", requires = "map", conflicts_with_all = ["vehicle", "self_test"])]
    pub fmu: Option<PathBuf>,
    /// Map of an FMU: which column of the recordings is which input, what is compared, what may be calibrated
    #[arg(long, value_name = "MAP.toml", requires = "fmu")]
    pub map: Option<PathBuf>,
}

/// What somebody else's model is compared with.
#[cfg_attr(not(feature = "fmu"), allow(dead_code, reason = "the command refuses to run"))]
pub struct Recordings<'a> {
    /// Paths of the recordings.
    pub files: &'a [PathBuf],
    /// What of them is predicted and not fitted.
    pub kept_back: KeptBack,
    /// Map of their columns, where another program wrote them.
    pub columns: Option<&'a Path>,
}
