//! `oleo fmu`: writes strut, vehicle or controller as a functional mock-up unit for other simulation tools.

mod arguments;
#[cfg(feature = "fmu")]
mod packed;

use std::path::PathBuf;
use std::process::ExitCode;

use arguments::{FileArgs, ParameterArgs};

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
    packed::write(&resources, &file, fmi, inputs.into_iter().flatten().collect())
}
