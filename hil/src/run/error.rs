//! Why a run did not come about.

use oleo_controller::ConfigurationError;
use oleo_interface::tick::TICK_S;

use crate::bus::BusError;
use crate::handshake::HandshakeError;
use crate::scenario::file::DEFENDER;

/// Why a run did not come about.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The strut model is wrong.
    #[error(transparent)]
    Strut(#[from] oleo_plant_sim::strut::ModelError),
    /// The vehicle's parameters are wrong.
    #[error(transparent)]
    Vehicle(#[from] oleo_plant_sim::vehicle::ParameterError),
    /// Strut and vehicle do not go together.
    #[error(transparent)]
    Ride(#[from] oleo_plant_sim::vehicle::RideError),
    /// The road is wrong.
    #[error(transparent)]
    Road(#[from] oleo_plant_sim::road::RoadError),
    /// The controller cannot be configured.
    #[error(transparent)]
    Configuration(#[from] ConfigurationError),
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// The nodes did not find together.
    #[error(transparent)]
    Handshake(#[from] HandshakeError),
    /// A file cannot be read.
    #[error("{path}: cannot be read: {source}; give {DEFENDER} or the path of a TOML file")]
    Unreadable {
        /// Which.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// The integration step does not divide the tick.
    #[error("{vehicle}: solver.step_s is {step_s}: must divide the controller's tick of {TICK_S} s")]
    Step {
        /// Parameter file.
        vehicle: String,
        /// Its step, s.
        step_s: f64,
    },
    /// A bus with one end only.
    #[error("{bus} connects two programs: add --node plant or --node controller, and start the other one too")]
    OneEnd {
        /// Address.
        bus: String,
    },
    /// In memory, there is no other process.
    #[error("--node needs a bus that another process can reach: add --bus socketcan:IFACE or --bus slcan:DEVICE")]
    NoOtherProcess,
}
