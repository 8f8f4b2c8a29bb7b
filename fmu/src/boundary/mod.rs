//! The functions that tools call: pointers become slices and texts here, complaints become status and log lines, and no panic leaves.
//!
//! | file | what it holds |
//! |---|---|
//! | `handle` | an instance as a tool holds it: a pointer, and the way to the tool's logger |
//! | `memory` | reading and writing what pointers point at |
//! | `state` | states to go back to, as a tool holds them |
//! | `fmi2`, `fmi3` | the functions of either version, by the names in their standards |
//!
//! This is the only unsafe code of the crate. What cannot be checked is said in FMI's own contract: a pointer is null or points at as many values as
//! the call says, and an instance is used by one thread at a time and not after it was freed.
#![allow(unsafe_code, reason = "FMI is a C interface; each block says why it is sound")]

mod fmi2;
mod fmi3;
mod handle;
mod memory;
#[cfg(test)]
mod network_tests;
mod state;
#[cfg(test)]
mod tests;
