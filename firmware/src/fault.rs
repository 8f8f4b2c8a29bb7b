//! Reaction to processor faults: the code turns the solenoids off and restarts.
//!
//! After the reset the controller is in its start-up mode with closed valves, until all sensors have been healthy again.

use crate::solenoid;
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};

/// Bus, memory, usage and escalated faults.
#[allow(unsafe_code)] // the attribute asks for the word: the stack may be what is broken
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    off_and_reset()
}

/// Any exception or interrupt that is not enabled.
#[allow(unsafe_code)]
#[exception]
unsafe fn DefaultHandler(_number: i16) {
    off_and_reset()
}

fn off_and_reset() -> ! {
    solenoid::all_off();
    SCB::sys_reset()
}

/// No panic is reachable in this image (build with `--features panic-never` to have the linker prove it); the language
/// still asks for a handler.
#[cfg(not(feature = "panic-never"))]
#[panic_handler]
fn panic(_info: &core::panic::PanicInfo<'_>) -> ! {
    off_and_reset()
}

#[cfg(feature = "panic-never")]
use panic_never as _;
