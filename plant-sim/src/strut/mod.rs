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
//! Compression is positive. Every physical effect is a *term* that a [`StrutModel`] has or has not ([`Effects`]);
//! [`Strut`] solves whatever the model holds. Data flows one way:
//!
//! ```text
//!   model (model.toml) --> terms ----------------+
//!                            |                   v
//!   recording --> smoothing --> motion --> integrator --> replay --> predicted columns
//!                                          |    |    |
//!                              network (stages) valve rod_forces
//!                              |    |    |
//!                      characteristic gas orifice
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | `model` | the tables of `model.toml`, their limits |
//! | `terms` | the vocabulary of effects: one file for each, with struct, limits, equation, source, tests |
//! | `network` | the hydraulic network and its solver: one implicit stage |
//! | `hydraulics` | a step of oil, gas and mount, of one strut or of several side by side |
//! | `integrator` | the strut in time: steps, valves' edges, the rod |
//! | `abreast`, `side_by_side` | four struts that are advanced together, and their hydraulics in the vectors of the processor |
//! | `valve` | movement of a valve |
//! | `rod_forces`, `rod_state` | forces between rod and cylinder, and what they depend on |
//! | `friction`, `rod_friction` | dry friction of a body that slides, and of a rod |
//! | `gas`, `equation_of_state`, `nitrogen`, `orifice`, `damper`, `characteristic` | laws of the elements |
//! | `instruments` | what faulty instruments make of the columns |
//! | `motion`, `smoothing` | a motion from sample to sample, and how a recorded displacement becomes one |
//! | `inputs`, `prediction` | what a recording says was done to a strut, and what its instruments would read |
//! | `run` | a recording on its way through a model, step by step |
//! | `replay`, `replay_abreast` | a recording's inputs through a model, and many at once in the vectors of the processor |

mod abreast;
mod beginning;
mod characteristic;
mod damper;
mod equation_of_state;
mod flow_path;
mod friction;
mod gas;
mod hydraulics;
mod inputs;
mod instruments;
mod integrator;
mod model;
mod motion;
mod network;
mod nitrogen;
mod orifice;
mod prediction;
mod pressure;
mod replay;
mod replay_abreast;
mod rod_course;
mod rod_forces;
mod rod_friction;
mod rod_state;
mod run;
mod settled;
mod side_by_side;
mod smoothing;
mod terms;
mod valve;

pub use abreast::StrutsAbreast;
pub use beginning::{Beginning, InMotion};
pub use characteristic::Characteristic;
pub use damper::DamperTable;
pub use equation_of_state::NITROGEN_R_J_KG_K;
pub use flow_path::FlowPath;
pub use friction::{PRESLIDING_STIFFNESS_N_M, advance_friction};
pub use gas::{Gas, GasState, NITROGEN_CV_J_KG_K};
pub use inputs::Inputs;
pub use instruments::{record_column, true_first_value};
pub use integrator::{Strut, StrutOutput, StrutSnapshot};
pub use model::{Accumulator, Cylinder, GasCharge, Orifice, Specimen, StrutModel, Valve, ValveTiming};
pub use motion::{Motion, Segment, StrutMove};
pub use nitrogen::Nitrogen;
pub use prediction::Prediction;
pub use pressure::ATMOSPHERE_PA;
pub use replay::{replay, replay_from, replay_with_course};
pub use replay_abreast::{Replay, replay_all};
pub use rod_course::RodCourse;
pub use run::Replayed;
pub use smoothing::{FreeMotion, smooth_displacement, smooth_free_motion, smooth_uneven_displacement};
pub use terms::{
    AccumulatorPistonFriction, BumpStop, COLUMNS, DamperLeakage, DampingFade, Effects, EntrainedAir, Equation,
    GasChargeError, GasEquation, GasHeatTransfer, LaminarLine, LawArgument, LawForm, LawPlace, LineInertance,
    LineResistance, Mount, MountCompliance, OilCompressibility, OilCount, PackFade, PistonSeal, RealGas, SealFriction,
    SensorEffect, SideLoadFriction, TermId, TransitionShape, UnlistedLaw, Valve3Leakage, ValveDelay, ValveTransition,
    check_columns,
};
pub use valve::ValveMotion;
