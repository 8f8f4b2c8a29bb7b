//! `oleo fmu`: writes strut, vehicle or controller as a functional mock-up unit for other simulation tools.

use std::path::PathBuf;
use std::process::ExitCode;

use crate::failure::Failure;

/// Write strut, controller or vehicle as a functional mock-up unit (FMU), which other simulation tools open.
///
/// An FMU is for co-simulation: it holds the shared library of this project and the parameters as files, and needs nothing else.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo fmu strut --out strut.fmu                              the built-in strut, FMI 2.0\n  \
    oleo fmu strut --strut model.toml --fmi 3 --out strut.fmu     another strut, FMI 3.0\n  \
    oleo fmu controller --out controller.fmu                      the controller of the built-in vehicle\n  \
    oleo fmu can-controller --out can-controller.fmu              the same with frames in and out (FMI-LS-BUS), FMI 3.0\n  \
    oleo fmu vehicle --road belgian --speed-km-h 40 --out vehicle.fmu\n\n\
    The shared library is built with `cargo build --release --features fmu -p oleo -p oleo-fmu` and is looked for beside this program. docs/fmu.md describes \
    all variables."
)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

/// What the FMU is of.
#[derive(clap::Subcommand)]
enum What {
    /// One strut: displacement and switching signals in, force and pressures out
    Strut(StrutArgs),
    /// The controller: displacements and pressures in, switching signals of twelve valves out, a tick of 5 ms
    Controller(ControllerArgs),
    /// The controller as a node on CAN: frames in, frames out, for a tool with FMI-LS-BUS 1.0 (FMI 3.0 only)
    CanController(ControllerArgs),
    /// The vehicle on four struts, 14 degrees of freedom: valves, steering and pedals in, pressures and motion out
    Vehicle(VehicleArgs),
}

#[derive(clap::Args)]
#[cfg_attr(not(feature = "fmu"), allow(dead_code, reason = "the command refuses to run"))]
struct StrutArgs {
    /// Model file of the strut. The default is the built-in one
    #[arg(long, value_name = "MODEL.toml")]
    strut: Option<PathBuf>,
    #[command(flatten)]
    file: FileArgs,
}

#[derive(clap::Args)]
#[cfg_attr(not(feature = "fmu"), allow(dead_code, reason = "the command refuses to run"))]
struct ControllerArgs {
    #[command(flatten)]
    parameters: ParameterArgs,
    #[command(flatten)]
    file: FileArgs,
}

#[derive(clap::Args)]
#[cfg_attr(not(feature = "fmu"), allow(dead_code, reason = "the command refuses to run"))]
struct VehicleArgs {
    #[command(flatten)]
    parameters: ParameterArgs,
    /// Built-in road; heights under the wheels can be added to it
    #[arg(long, value_name = "NAME", default_value = "flat")]
    road: String,
    /// Seed of a random road
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u32,
    /// Speed at the start, which is a parameter of the FMU too, km/h
    #[arg(long, value_name = "V", default_value_t = 0.0)]
    speed_km_h: f64,
    #[command(flatten)]
    file: FileArgs,
}

/// Files that describe a vehicle. For each, the default is the built-in one.
#[derive(clap::Args)]
#[cfg_attr(not(feature = "fmu"), allow(dead_code, reason = "the command refuses to run"))]
struct ParameterArgs {
    /// Parameters of body, axles and tyres
    #[arg(long, value_name = "FILE.toml")]
    vehicle: Option<PathBuf>,
    /// Parameters of steering and links
    #[arg(long, value_name = "FILE.toml")]
    handling: Option<PathBuf>,
    /// Model file of the struts
    #[arg(long, value_name = "MODEL.toml")]
    strut: Option<PathBuf>,
}

#[derive(clap::Args)]
#[cfg_attr(not(feature = "fmu"), allow(dead_code, reason = "the command refuses to run"))]
struct FileArgs {
    /// File that is written
    #[arg(long, value_name = "FILE.fmu")]
    out: PathBuf,
    /// Version of FMI, 2 or 3. One file has one version. The default is 2, which more tools read, and 3 for a node on CAN
    #[arg(long, value_name = "VERSION", value_parser = clap::value_parser!(u8).range(2..=3))]
    fmi: Option<u8>,
    /// Shared library that goes into the file. May be given once for each platform
    #[arg(long, value_name = "FILE")]
    library: Vec<PathBuf>,
    /// Replace a file of a campaign. Inputs are never replaced
    #[arg(long)]
    force: bool,
}

/// Runs the command.
///
/// # Errors
/// A file is missing or wrong, or the FMU cannot be written.
#[cfg(not(feature = "fmu"))]
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    let (What::Strut(StrutArgs { file, .. })
    | What::Controller(ControllerArgs { file, .. })
    | What::CanController(ControllerArgs { file, .. })
    | What::Vehicle(VehicleArgs { file, .. })) = args.what;
    Err(Failure::new(format!(
        "{}: this program was built without FMUs; build it with `cargo build --release --features fmu -p oleo -p oleo-fmu`",
        file.out.display()
    )))
}

/// Runs the command.
///
/// # Errors
/// A file is missing or wrong, or the FMU cannot be written.
#[cfg(feature = "fmu")]
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    use oleo_fmu::{Resources, Start};
    use oleo_hil::description::describe;
    use oleo_hil::parameter_files::Parameters;

    let least = match args.what {
        What::CanController(_) => 3,
        _ => 2,
    };
    let (resources, file, inputs) = match args.what {
        What::Strut(StrutArgs { strut, file }) => {
            let read = Parameters::read(None, None, strut.as_ref())?;
            (Resources::strut(&read.strut), file, vec![strut])
        }
        What::Controller(ControllerArgs { parameters, file }) => {
            let read = parameters.read()?;
            let described = describe(&read.vehicle, &read.handling, &read.strut);
            (Resources::controller(described)?, file, parameters.paths())
        }
        What::CanController(ControllerArgs { parameters, file }) => {
            let read = parameters.read()?;
            let described = describe(&read.vehicle, &read.handling, &read.strut);
            (Resources::can_controller(described)?, file, parameters.paths())
        }
        What::Vehicle(VehicleArgs {
            parameters,
            road,
            seed,
            speed_km_h,
            file,
        }) => {
            let read = parameters.read()?;
            let start = Start {
                road,
                seed,
                speed_m_s: speed_km_h / 3.6,
            };
            let resources = Resources::vehicle(&read.vehicle, &read.handling, &read.strut, start);
            (resources, file, parameters.paths())
        }
    };
    let fmi = file.fmi.unwrap_or(least);
    with_feature::write(&resources, &file, fmi, inputs.into_iter().flatten().collect())
}

#[cfg(feature = "fmu")]
mod with_feature {
    use oleo_hil::parameter_files::Parameters;
    use std::path::PathBuf;
    use std::process::ExitCode;

    use oleo_fmu::{FmiVersion, Packed, Resources, SharedLibrary, pack};
    use oleo_plant_sim::model_file::ModelFileError;
    use oleo_report::OutputFile;

    use super::{FileArgs, ParameterArgs};
    use crate::failure::Failure;
    use crate::results::say;

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

    /// Packs resources and libraries into a file.
    pub fn write(resources: &Resources, file: &FileArgs, fmi: u8, inputs: Vec<PathBuf>) -> Result<ExitCode, Failure> {
        let libraries = (libraries(file)?.iter())
            .map(|path| SharedLibrary::read(path))
            .collect::<Result<Vec<_>, _>>()?;
        let inputs = [inputs, file.library.clone()].concat();
        let out = OutputFile::stage(&file.out, &inputs, file.force)?;
        let version = match fmi {
            3 => FmiVersion::Three,
            _ => FmiVersion::Two,
        };
        let Packed {
            bytes,
            counts: [inputs, outputs, parameters],
            platforms,
        } = pack(resources, version, &libraries)?;
        let out = out.bytes(&bytes)?;
        say(&format!(
            "FMI {}.0 for co-simulation, {}: {inputs} inputs, {outputs} outputs, {parameters} parameters\n{}\n",
            fmi,
            platforms.join(", "),
            out.display()
        ))?;
        Ok(ExitCode::SUCCESS)
    }

    /// The libraries that were given, or the one beside this program.
    fn libraries(file: &FileArgs) -> Result<Vec<PathBuf>, Failure> {
        if !file.library.is_empty() {
            return Ok(file.library.clone());
        }
        let program = std::env::current_exe()?;
        let folder = program.parent().unwrap_or(&program);
        let candidates = SharedLibrary::candidates(folder);
        match candidates.iter().find(|path| path.is_file()) {
            Some(path) => Ok(vec![path.clone()]),
            None => Err(Failure::new(format!(
                "{}: the shared library of the FMUs is not there; build it with `cargo build --release --features fmu -p oleo -p oleo-fmu`, or name it with --library",
                candidates[0].display()
            ))),
        }
    }
}
