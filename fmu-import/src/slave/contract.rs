//! What an instance of either version can.

use crate::message::VariableId;

/// One instance, from its initialization to its end.
pub trait Slave {
    /// Begins the initialization at a time, s, of a simulation that ends at another.
    fn enter_initialization(&mut self, start_s: f64, stop_s: f64) -> Result<(), String>;
    /// Ends it.
    fn exit_initialization(&mut self) -> Result<(), String>;
    /// Sets a variable.
    fn set(&mut self, variable: VariableId, value: f64) -> Result<(), String>;
    /// Reads a variable.
    fn get(&mut self, variable: VariableId) -> Result<f64, String>;
    /// Makes a step from a time, both in s.
    fn step(&mut self, time_s: f64, step_s: f64) -> Result<(), String>;
    /// Ends the simulation. What the FMU says to it no longer matters.
    fn terminate(&mut self);
}
