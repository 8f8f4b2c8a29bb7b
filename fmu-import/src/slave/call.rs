//! Looking up a function of a library, what its status means, and numbers as its types.

use libloading::Library;

use super::log;
use crate::description::NumberKind;

/// A function of a library by its name.
pub fn function<'l, F>(library: &'l Library, name: &str) -> Result<libloading::Symbol<'l, F>, String> {
    // SAFETY: FMI says what type the function of this name has.
    unsafe { library.get(name) }.map_err(|_| format!("its library has no function {name}"))
}

/// What a status means: 0 is success and 1 a warning in both versions.
pub fn checked(status: std::ffi::c_int, what: &str) -> Result<(), String> {
    match status {
        0 | 1 => Ok(()),
        _ => {
            let named = match status {
                2 => "discards it",
                4 => "calls it a fatal error",
                5 => "has not finished it",
                _ => "calls it an error",
            };
            let said = log::take().map_or(String::new(), |said| format!(": {said}"));
            Err(format!("{what}: the FMU {named}{said}"))
        }
    }
}

/// A number as an integer of a type, refused where it is none of its values.
pub fn integer<I: TryFrom<i64>>(value: f64) -> Result<I, String> {
    let whole = value as i64;
    match I::try_from(whole) {
        Ok(integer) if whole as f64 == value => Ok(integer),
        _ => Err(format!("{value} is not an integer of the variable's type")),
    }
}

/// Whether a switch is on.
pub fn switch(value: f64) -> bool {
    value != 0.0
}

/// What a type is that this version does not have.
pub fn foreign(kind: NumberKind) -> String {
    format!("this version of FMI has no variables of the type {kind:?}")
}
