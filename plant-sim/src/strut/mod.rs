//! The two-stage hydropneumatic strut as a small hydraulic network.
//!
//! ```text
//!   displacement, force                    path 1: damper 1 || valve 1 (|| leak)      accumulator 1
//!        |                             p1 ----[ pack1 ]-----------------------[ line ]--- p2 (0.1 l)
//!   +---------+                        |
//!   | cylinder|--- main chamber (oil)--+   path 2: damper 2 || valve 2    valve 3     accumulator 2
//!   +---------+                        |
//!                                      p1 ----[ pack2 ]------ p3 ------[orifice]----- p4 (0.4 l)
//! ```
//!
//! Compression is positive. Every physical effect is a *term* that a [`StrutModel`] has or has not
//! ([`Effects`]); [`Strut`] solves whatever the model holds. One file a law, `network` puts them together,
//! `replay` drives the network with a recording's inputs.

mod characteristic;
mod damper;
mod effects;
mod friction;
mod gas;
mod input;
mod laws;
mod model;
mod network;
mod nitrogen;
mod orifice;
mod replay;
mod sensor;
mod solve;
mod stops;
mod valve;

pub use characteristic::Characteristic;
pub use damper::DamperTable;
pub use effects::*;
pub use friction::advance_friction;
pub use gas::{Gas, GasState, NITROGEN_CV_J_KG_K, NITROGEN_R_J_KG_K};
pub use input::{Motion, Segment, smooth_displacement};
pub use model::{
    ATMOSPHERE_PA, Accumulator, Cylinder, GasCharge, ModelError, Orifice, Specimen, StrutModel, Valve, ValveTiming,
};
pub use network::{Strut, StrutOutput};
pub use nitrogen::Nitrogen;
pub use replay::{Inputs, Prediction, replay};
pub use sensor::{COLUMNS, record as record_column};
pub use valve::ValveMotion;
