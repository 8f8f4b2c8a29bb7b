//! The vehicle over the road: the ride model of the seed report's Appendix A, with the two-stage struts of
//! [`crate::strut`] or the coil springs and dampers of the vehicle as sold.
//!
//! ```text
//!  parameters --> equilibrium --+
//!  road --> contact --> tyre ---+--> equations (accelerations) --> ride (fixed step) --> body, wheels, struts
//!  signals --> suspension ------+                                                            |
//!                                                                                            +--> inertial
//! ```
//!
//! Inside, the sign convention is the appendix's (extension and tension positive); everything that leaves this module
//! is compression positive like the rest of the project. The conversion is in [`suspension`] and nowhere else.
//!
//! What the printed appendix gets wrong, and what is done instead, is listed in [`equations`].

mod contact;
pub mod equations;
mod gas_temperature;
mod inertial;
mod levelling;
pub mod linear;
mod load;
mod parameters;
mod payload;
mod ride;
mod seat;
mod strut_element;
pub mod suspension;

pub use gas_temperature::TemperedStrut;
pub use inertial::InertialReading;
pub(crate) use inertial::RigidMotion;
pub use levelling::{LevelledStrut, Levelling, LevellingLimits};
pub use load::Load;
pub(crate) use load::{Cargo, put};
pub use parameters::{
    AxleParameters, BaselineParameters, BodyParameters, GRAVITY_M_S2, LayoutParameters, SeatParameters,
    SolverParameters, TyreParameters, VehicleParameters,
};
pub use payload::Payload;
pub use ride::{BaselineVehicle, BodyMotion, RideError, RideModel, RideVehicle, WheelMotion};
pub use seat::{Seat, SeatAcceleration, Seats};
pub use strut_element::{FourStruts, StrutElement, StrutElementSnapshot};
