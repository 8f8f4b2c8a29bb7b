//! How long the parts take that are run most often: `cargo bench`, or `cargo bench strut` for those with this in their name.
//!
//! | module | what is timed |
//! |---|---|
//! | `controller` | a period of the controller, alone and with its CAN frames |
//! | `strut` | a step of one strut, smooth and while a valve moves |
//! | `vehicle` | a tick of the whole loop in one process |
//! | `diagnosis` | one simulation of a campaign, and the derivatives of a fit |
//!
//! Times depend on the machine and on what else it does. Two versions are compared on a busy machine by instructions
//! (`./test instructions`), which do not.

mod controller;
mod diagnosis;
mod strut;
mod vehicle;

fn main() {
    divan::main();
}
