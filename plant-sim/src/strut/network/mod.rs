//! The hydraulic network and its solver, which computes pressures and flows at the end of one implicit stage.
//!
//! ```text
//!                 path 1: pack 1 || bypass valve 1 || leaks      line 1      accumulator 1
//!   main chamber  p1 ------------------------------------------------------- p2 [gas 1]
//!   (oil, air,    |
//!   mount)        p1 ---------------------------------------- p3 ----------- p4 [gas 2]
//!                 path 2: pack 2 || bypass valve 2 || leaks, line 2   valve 3   accumulator 2
//! ```
//!
//! | file | what it holds |
//! |---|---|
//! | `layout` | the network as it is built from a model |
//! | `chamber`, `path` | the two kinds of element, each in closed form from a trial of the unknowns |
//! | `state` | the differential states |
//! | `stage_end` | when and where a stage ends |
//! | `stage` | Newton's method on the two unknowns |
//! | `last_solution`, `bounded` | where Newton's method starts and how far it steps |
//! | `oil_column` | how the oil column of line 2 swings |
//! | `rest` | the state at rest |
//!
//! The integrator, which knows time and the valves' movements, is one level up in `integrator`. Pressures of the network
//! are gauge and stand in plain numbers and arrays, since the solver adds and multiplies them; the types `Gauge` and
//! `Absolute` stand where it speaks to gas and bubbles, which think in absolute pressure.

mod bounded;
mod chamber;
mod last_solution;
mod law_memory;
mod layout;
mod oil_column;
mod path;
mod rest;
mod stage;
mod stage_end;
mod state;

pub(super) use last_solution::LastSolution;
pub(super) use layout::Network;
pub(super) use oil_column::ColumnOscillator;
pub(super) use stage_end::StageEnd;
pub(super) use state::State;
