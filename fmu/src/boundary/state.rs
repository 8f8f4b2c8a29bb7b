//! States as a tool holds them: a pointer at bytes, which can be written to a file.

use std::ffi::c_void;

use super::memory::{place, places, values};
use crate::complaint::Complaint;
use crate::instance::Instance;

/// A state for a tool, in the place that the tool has for it; the one that is there is replaced.
///
/// # Safety
/// The place holds null or a pointer that this function has put there.
pub unsafe fn put_state(place: &mut *mut c_void, bytes: Vec<u8>) {
    // SAFETY: as the caller promises.
    match unsafe { place.cast::<Vec<u8>>().as_mut() } {
        Some(kept) => *kept = bytes,
        None => *place = Box::into_raw(Box::new(bytes)).cast(),
    }
}

/// The bytes of a state.
///
/// # Safety
/// The pointer is null or one of [`put_state`] that has not been freed.
pub unsafe fn state<'a>(state: *mut c_void) -> Result<&'a [u8], Complaint> {
    // SAFETY: as the caller promises.
    match unsafe { state.cast::<Vec<u8>>().as_ref() } {
        Some(bytes) => Ok(bytes),
        None => Err(Complaint::new("state: the pointer is null; get a state first")),
    }
}

/// Ends a state and writes null in its place.
///
/// # Safety
/// As [`put_state`], and nobody uses the state again.
pub unsafe fn free_state(place: &mut *mut c_void) {
    if !place.is_null() {
        // SAFETY: it was made by `Box::into_raw` in `put_state`, and this is its last use.
        drop(unsafe { Box::from_raw(place.cast::<Vec<u8>>()) });
        *place = std::ptr::null_mut();
    }
}

/// Writes a state into a tool's memory.
///
/// # Safety
/// A state of `put_state` or null, and `size` places or null.
pub unsafe fn serialize(kept: *mut c_void, bytes: *mut u8, size: usize) -> Result<(), Complaint> {
    // SAFETY: as the caller promises.
    let (kept, out) = unsafe { (state(kept)?, places(bytes, size, "serializedState")?) };
    let Some(out) = out.get_mut(..kept.len()) else {
        return Err(Complaint::new(format!(
            "serializedState has {size} bytes and the state has {}: ask for its size first",
            kept.len()
        )));
    };
    out.copy_from_slice(kept);
    Ok(())
}

/// Makes a state of what [`serialize`] has written.
///
/// # Safety
/// `size` bytes or null, and the place of a state, which holds null or a state of `put_state`.
pub unsafe fn deserialize(
    instance: &Instance,
    bytes: *const u8,
    size: usize,
    out: *mut *mut c_void,
) -> Result<(), Complaint> {
    // SAFETY: as the caller promises.
    let (bytes, out) = unsafe { (values(bytes, size, "serializedState")?, place(out, "FMUstate")?) };
    instance.check_state(bytes)?;
    // SAFETY: as the caller promises.
    unsafe { put_state(out, bytes.to_vec()) };
    Ok(())
}
