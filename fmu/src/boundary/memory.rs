//! Reading and writing what a tool's pointers point at.

use std::ffi::{CStr, c_char};
use std::path::PathBuf;
use std::slice;

use percent_encoding::percent_decode_str;

use crate::complaint::Complaint;

/// The values at a pointer.
///
/// # Safety
/// The pointer is null or points at `count` values that stay as they are during the call.
pub unsafe fn values<'a, T>(pointer: *const T, count: usize, what: &str) -> Result<&'a [T], Complaint> {
    if count == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(missing(what));
    }
    // SAFETY: not null, and as the caller promises.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}

/// The places at a pointer that values are written to.
///
/// # Safety
/// The pointer is null or points at `count` values that nobody else reads or writes during the call.
pub unsafe fn places<'a, T>(pointer: *mut T, count: usize, what: &str) -> Result<&'a mut [T], Complaint> {
    if count == 0 {
        return Ok(&mut []);
    }
    if pointer.is_null() {
        return Err(missing(what));
    }
    // SAFETY: not null, and as the caller promises.
    Ok(unsafe { slice::from_raw_parts_mut(pointer, count) })
}

/// The place at a pointer that one value is written to.
///
/// # Safety
/// As [`places`] with one value.
pub unsafe fn place<'a, T>(pointer: *mut T, what: &str) -> Result<&'a mut T, Complaint> {
    // SAFETY: as the caller promises.
    unsafe { pointer.as_mut() }.ok_or_else(|| missing(what))
}

/// The text at a pointer.
///
/// # Safety
/// The pointer is null or points at a text that ends with a zero.
pub unsafe fn text(pointer: *const c_char, what: &str) -> Result<String, Complaint> {
    if pointer.is_null() {
        return Err(missing(what));
    }
    // SAFETY: not null, and as the caller promises.
    let text = unsafe { CStr::from_ptr(pointer) };
    Ok(text.to_string_lossy().into_owned())
}

/// The path that a URI of the scheme `file` names. A path without a scheme is taken as it is, since some tools give one.
pub fn path_of_uri(uri: &str) -> PathBuf {
    let Some(rest) = uri.strip_prefix("file:") else {
        return PathBuf::from(uri);
    };
    // `file:///tmp/x`, `file:/tmp/x`, `file://localhost/tmp/x`; on Windows `file:///C:/x`.
    let path = match rest.strip_prefix("//") {
        Some(rest) => rest.strip_prefix("localhost").unwrap_or(rest),
        None => rest,
    };
    let path = percent_decode_str(path).decode_utf8_lossy();
    let without_root = path.strip_prefix('/').filter(|_| cfg!(windows));
    PathBuf::from(without_root.unwrap_or(&path))
}

fn missing(what: &str) -> Complaint {
    Complaint::new(format!("{what}: the pointer is null"))
}
