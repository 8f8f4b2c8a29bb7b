//! The loop: plant and controller communicate only through CAN frames.
//!
//! ```text
//!   scenario (TOML)
//!       |
//!       v                          six sensor frames a tick
//!      run ----> plant_node  =====================================>  controller_node
//!                (vehicle,       bus: memory, SocketCAN or slcan     (oleo_controller::Node,
//!                 instruments)   <=================================   the firmware's code)
//!                    |               one command a tick
//!                    v
//!      record, trace --> metrics --> checks --> output (summary, logs, CSV, JUnit, page)
//! ```
//!
//! * [`bus`] contains the buses and the decorators around them; [`sync`] and [`handshake`] synchronise two nodes; [`clock`] paces a
//!   run in real time.
//! * [`image`] seals a firmware image; [`emulator`] runs one on an emulated board, whose frames are compared with those of the controller in this process.
//! * [`scenario`] describes what is driven, which faults occur and which checks must be met; [`run`] turns a scenario into a recording.
//! * [`imu`] is an inertial unit on the body that sends on the same bus, for whoever logs it.
//! * [`metrics`] and [`output`] turn a recording into figures and files; [`bit_timing`] computes when a wire would have carried each
//!   frame.
//! * [`strut_recording`] gives a run as a recording of one strut, for a diagnosis.
//! * [`companion`] is what else the controller's node serves on its bus: XCP, where the program was built with it (`xcp`).
//! * [`drive`] drives a vehicle without a bus, with the controller called directly.
//! * [`telemetry`] gives a run as messages for viewers, in a file or live.
//! * [`logs`] reads the frames of logs in any format. [`drive_log`] makes the drives of a vehicle of messages of our own database, and
//!   `signal_log` (feature `logs`) of those of any other.
#![forbid(unsafe_code)]

pub mod bit_timing;
pub mod bus;
pub mod clock;
pub mod companion;
pub mod comparison;
pub mod controller_node;
mod deadline;
pub mod description;
pub mod drive;
pub mod drive_log;
pub mod emulator;
pub mod frame;
pub mod handshake;
pub mod image;
pub mod imu;
pub mod instruments;
pub mod logs;
pub mod metrics;
mod newcomer;
pub mod output;
pub mod page;
pub mod parameter_files;
pub mod plant_node;
pub mod record;
pub mod run;
pub mod scenario;
#[cfg(feature = "logs")]
pub mod signal_log;
pub mod strut_recording;
pub mod sync;
pub mod telemetry;
pub mod time_series;
pub mod vehicle;
#[cfg(feature = "xcp")]
pub mod xcp;

pub use frame::Frame;
pub use scenario::Scenario;
