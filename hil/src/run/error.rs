//! Errors that prevent or end a run.

use oleo_controller::ConfigurationError;
use oleo_interface::tick::TICK_S;

use crate::bus::BusError;
use crate::emulator::EmulatorError;
use crate::handshake::HandshakeError;
use crate::scenario::file::DEFENDER;

/// Why a run did not come about.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The file of the strut or of the vehicle is wrong.
    #[error(transparent)]
    ModelFile(#[from] oleo_plant_sim::model_file::ModelFileError),
    /// The strut cannot be charged for the load that its corner carries.
    #[error("strut {0}")]
    Strut(#[from] oleo_plant_sim::model_file::InvalidValue),
    /// Strut and vehicle do not fit together.
    #[error(transparent)]
    Ride(#[from] oleo_plant_sim::vehicle::RideError),
    /// The road cannot be read or made.
    #[error(transparent)]
    Road(#[from] oleo_plant_sim::road::RoadError),
    /// The manoeuvre has a setting that it cannot have.
    #[error("{0}")]
    Course(oleo_plant_sim::model_file::InvalidValue),
    /// The vehicle's motion is not finite.
    #[error(transparent)]
    NotFinite(#[from] oleo_plant_sim::course::NotFinite),
    /// The controller cannot be configured.
    #[error(transparent)]
    Configuration(#[from] ConfigurationError),
    /// The bus failed before or during the run.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// The firmware image does not run.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// The two nodes did not find each other, or want different runs.
    #[error(transparent)]
    Handshake(#[from] HandshakeError),
    /// A file cannot be read.
    #[error("{path}: cannot be read: {source}; give {DEFENDER} or the path of a TOML file")]
    Unreadable {
        /// Path of the file.
        path: String,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The integration step does not divide the tick.
    #[error(
        "{vehicle}: solver.step_s is {step_s}: must be {TICK_S} s, the controller's tick, divided by a whole number"
    )]
    Step {
        /// Name of the vehicle or path of its parameter file.
        vehicle: String,
        /// Integration step of the vehicle file, s.
        step_s: f64,
    },
    /// The bus has only one end in this process.
    #[error(
        "{bus} connects two programs: add --node plant or --node controller, and start the other node as a second program"
    )]
    OneEnd {
        /// Address of the bus.
        bus: String,
    },
    /// A bus in memory cannot reach another process.
    #[error("--node needs a bus that another process can reach: add --bus socketcan:IFACE or --bus slcan:DEVICE")]
    NoOtherProcess,
}
