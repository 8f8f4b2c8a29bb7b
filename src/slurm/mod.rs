//! Slurm: the scripts of the jobs, and the queue that they are given to. Its commands are called by name, so that nothing of Slurm is
//! needed where it is not used.

pub mod queue;
mod scripts;

pub use scripts::Scripts;
