//! The loop: plant and controller, talking only through CAN frames.
//!
//! ```text
//!   scenario (TOML) --> run --> [plant node | bus | controller node] --> record, trace --> metrics, checks --> files
//! ```
//!
//! * [`bus`]: what carries frames, and decorators around it.
//! * [`sync`]: how two nodes keep in step.
#![forbid(unsafe_code)]

pub mod bit_timing;
pub mod bus;
pub mod candump;
pub mod clock;
pub mod frame;
pub mod sync;

pub use frame::Frame;
