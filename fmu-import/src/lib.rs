//! Functional mock-up units that other tools wrote (FMU): FMI 2.0 and 3.0, co-simulation, each in a process of its own.
//!
//! An FMU is a program that somebody else compiled. It may stop, call `abort`, or write over memory that is not its own. It is therefore never loaded by the
//! process that uses it, but by a child, which is ended when it takes too long, and whose end is one line.
//!
//! ```text
//!   MODEL.fmu                          parent                             child
//!      |                                 |                                  |
//!   archive: unpacked, description     children: as many as asked at once   |
//!      read                              |                                  |
//!      +------------------------------> worker --- Opening, Run ---------> serve --> simulation
//!                                        |  <----- Answer ----------------    |          |
//!                                        |                                    |       slave: FMI 2.0, FMI 3.0 (the only unsafe code)
//!                                        +------- clock: time reached <-------+
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | `complaint` | what is wrong, in one line |
//! | `description` | `modelDescription.xml`: version, variables, what the FMU can |
//! | `archive` | the unpacked file, and the library for this platform |
//! | `message` | what parent and child say to each other, and how it is framed |
//! | `slave` | an instance of the FMU, the same for both versions |
//! | `simulation` | one instance along the steps of a run |
//! | `child` | the process that loads the library |
//! | `worker` | one child, as the parent sees it |
//! | `children` | all of them, and the run that failed |

mod archive;
mod child;
mod children;
mod complaint;
mod description;
mod message;
mod simulation;
mod slave;
mod worker;

pub use archive::Fmu;
pub use child::serve;
pub use children::{Children, Failure, Limits, Program};
pub use complaint::Complaint;
pub use description::{Causality, Description, FmiVersion, NumberKind, Variability, Variable};
pub use message::{Driven, Run, VariableId};
