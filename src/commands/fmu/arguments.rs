//! What the command line says of every FMU: files of parameters, and the file that is written.

use std::path::PathBuf;

#[cfg(feature = "fmu")]
use oleo_hil::parameter_files::Parameters;
#[cfg(feature = "fmu")]
use oleo_plant_sim::model_file::ModelFileError;

/// Files that describe a vehicle. For each, the default is the built-in one.
#[derive(clap::Args)]
#[cfg_attr(not(feature = "fmu"), allow(dead_code, reason = "the command refuses to run"))]
pub struct ParameterArgs {
    /// Parameters of body, axles and tyres
    #[arg(long, value_name = "FILE.toml")]
    pub vehicle: Option<PathBuf>,
    /// Parameters of steering and links
    #[arg(long, value_name = "FILE.toml")]
    pub handling: Option<PathBuf>,
    /// Model file of the struts
    #[arg(long, value_name = "MODEL.toml")]
    pub strut: Option<PathBuf>,
}

#[derive(clap::Args)]
#[cfg_attr(not(feature = "fmu"), allow(dead_code, reason = "the command refuses to run"))]
pub struct FileArgs {
    /// File that is written
    #[arg(long, value_name = "FILE.fmu")]
    pub out: PathBuf,
    /// Version of FMI, 2 or 3. One file has one version. The default is 2, which more tools read, and 3 for a node on CAN
    #[arg(long, value_name = "VERSION", value_parser = clap::value_parser!(u8).range(2..=3))]
    pub fmi: Option<u8>,
    /// Shared library that goes into the file. May be given once for each platform
    #[arg(long, value_name = "FILE")]
    pub library: Vec<PathBuf>,
    /// Replace a file of a campaign. Inputs are never replaced
    #[arg(long)]
    pub force: bool,
}

#[cfg(feature = "fmu")]
impl ParameterArgs {
    /// Reads the files.
    pub fn read(&self) -> Result<Parameters, ModelFileError> {
        Parameters::read(self.vehicle.as_ref(), self.handling.as_ref(), self.strut.as_ref())
    }

    /// The files that were given.
    pub fn paths(self) -> Vec<Option<PathBuf>> {
        vec![self.vehicle, self.handling, self.strut]
    }
}
