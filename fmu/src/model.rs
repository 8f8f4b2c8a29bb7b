//! What every simulated model has.

use crate::complaint::Complaint;

/// A model behind a table of values. It reads inputs and parameters out of the table and writes outputs into it, at the places that its
/// definition gives them.
pub trait Model: Send {
    /// Starts anew from the inputs and parameters.
    ///
    /// # Errors
    /// A parameter that the model cannot have.
    fn begin(&mut self, values: &[f64]) -> Result<(), Complaint>;

    /// Goes on for `duration_s`, which is a multiple of the tick where the definition has one, under the inputs.
    ///
    /// # Errors
    /// A parameter that the model cannot have.
    fn step(&mut self, values: &[f64], duration_s: f64) -> Result<(), Complaint>;

    /// Writes the outputs.
    fn outputs(&self, values: &mut [f64]);

    /// The state as bytes. Parameters and inputs are not in it.
    ///
    /// # Errors
    /// The model has not begun.
    fn save(&self) -> Result<Vec<u8>, Complaint>;

    /// Goes back to a state that [`Self::save`] has given, under these parameters.
    ///
    /// # Errors
    /// The bytes are not a state, or a parameter is wrong.
    fn load(&mut self, values: &[f64], bytes: &[u8]) -> Result<(), Complaint>;

    /// The network end of a model that has a terminal and has begun.
    fn network(&mut self) -> Option<&mut dyn Network> {
        None
    }
}

/// A node on a network whose bus is the tool.
pub trait Network {
    /// Takes bus operations, which may be any bytes.
    fn take(&mut self, operations: &[u8]);

    /// Bus operations for the tool, which are then gone from here.
    fn take_sent(&mut self) -> Vec<u8>;
}

/// Whether a value of the table is on.
pub fn is_on(value: f64) -> bool {
    value != 0.0
}

/// A switch as a value of the table.
pub fn switch(on: bool) -> f64 {
    f64::from(u8::from(on))
}
