//! What an FMU last said of an error. Its functions return a status only; the text goes to the logger.

use std::ffi::{CStr, c_char};
use std::sync::Mutex;

/// Status from which on a text is kept: discard, error, fatal.
const KEPT_FROM: i32 = 2;
/// Longest text that is kept, characters.
const LONGEST: usize = 300;

static LAST: Mutex<Option<String>> = Mutex::new(None);

/// Keeps a text.
///
/// # Safety
/// The pointer is null or points at a text that ends with a zero.
pub unsafe fn keep(status: i32, message: *const c_char) {
    if status < KEPT_FROM || message.is_null() {
        return;
    }
    // SAFETY: not null, and as the caller promises.
    let text = unsafe { CStr::from_ptr(message) }.to_string_lossy();
    if let Ok(mut last) = LAST.lock() {
        *last = Some(text.replace("%%", "%").chars().take(LONGEST).collect());
    }
}

/// The text that was kept last, once.
pub fn take() -> Option<String> {
    LAST.lock().ok()?.take()
}
