//! What the board knows of itself, for a debugger: words in RAM at the symbol `BOARD`, in the order of the fields
//! (`docs/flashing.md`). Reading them disturbs nothing. A summary goes onto the bus once a second, as the message `BOARD`.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use oleo_controller::can::{BoardMessage, BusState, ClockSource, ImageState};

/// The words.
#[cfg_attr(
    feature = "slcan",
    allow(dead_code, reason = "some are about the hardware of the vehicle's board")
)]
pub struct Board {
    /// Why the board was reset, see [`crate::reset::causes`].
    pub reset_causes: AtomicU32,
    /// What the clock runs from: 0 crystal, 1 internal oscillator (the crystal has failed), 2 internal oscillator without the PLL.
    pub clock_source: AtomicU32,
    /// Cause of a latch that the reset has not ended, as on the bus; 0 for none.
    pub latch_before_reset: AtomicU32,
    /// Bits `BOR_LEV` of the option bytes: 3 off, 2 level 1 (2.1 V), 1 level 2 (2.4 V), 0 level 3 (2.7 V) (RM0090, `FLASH_OPTCR`).
    pub brown_out_level: AtomicU32,
    /// Number of ticks at whose end the next one was due already. It wraps.
    pub overruns: AtomicU32,
    /// The error register of the CAN peripheral after the last tick: bit 0 warning, 1 passive, 2 bus-off; bits 16 to 23 transmit
    /// and 24 to 31 receive error counter.
    pub bus_errors: AtomicU32,
    /// Number of times that the board left the bus because of its errors (bus-off). It wraps.
    pub bus_off: AtomicU32,
    /// Number of receive and transmit errors, and of frames that were not sent in time. Both wrap.
    pub port_errors: AtomicU32,
    pub port_dropped: AtomicU32,
    /// Whether the flash was checked: 0 the image has no check value, 1 it is right (see [`crate::image`]).
    pub image: AtomicU32,
}

/// The board's report.
#[used]
pub static BOARD: Board = Board {
    reset_causes: AtomicU32::new(0),
    clock_source: AtomicU32::new(0),
    latch_before_reset: AtomicU32::new(0),
    brown_out_level: AtomicU32::new(0),
    overruns: AtomicU32::new(0),
    bus_errors: AtomicU32::new(0),
    bus_off: AtomicU32::new(0),
    port_errors: AtomicU32::new(0),
    port_dropped: AtomicU32::new(0),
    image: AtomicU32::new(0),
};

/// The report as it goes onto the bus.
pub fn message((clock, image): (ClockSource, ImageState)) -> BoardMessage {
    let read = |word: &AtomicU32| word.load(Relaxed);
    let count = |word: &AtomicU32| u8::try_from(read(word)).unwrap_or(u8::MAX);
    let errors = read(&BOARD.bus_errors);
    BoardMessage {
        reset_causes: read(&BOARD.reset_causes) as u8,
        clock,
        brown_out_level: read(&BOARD.brown_out_level) as u8,
        latch_kept: read(&BOARD.latch_before_reset) != 0,
        image,
        bus: match errors & 7 {
            0 => BusState::Active,
            1 => BusState::Warning,
            2 | 3 => BusState::Passive,
            _ => BusState::Off,
        },
        overruns: count(&BOARD.overruns),
        bus_off: count(&BOARD.bus_off),
        port_errors: count(&BOARD.port_errors),
        port_dropped: count(&BOARD.port_dropped),
    }
}

/// Sets a word.
pub fn set(word: &AtomicU32, value: u32) {
    word.store(value, Relaxed);
}

/// Counts one more.
#[cfg_attr(
    feature = "slcan",
    allow(dead_code, reason = "what is counted is about the hardware")
)]
pub fn count(word: &AtomicU32) {
    word.store(word.load(Relaxed).wrapping_add(1), Relaxed);
}
