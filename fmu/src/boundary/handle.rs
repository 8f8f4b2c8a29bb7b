//! An instance as a tool holds it: a pointer, and the way to the tool's logger.

use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::complaint::Complaint;
use crate::instance::Instance;

/// Everything went as it should (FMI 2 and 3).
pub const OK: i32 = 0;
/// The call had no effect, and a line went to the logger (FMI 2 and 3).
pub const ERROR: i32 = 3;

/// Takes one line to the tool's logger.
pub type Log = Box<dyn Fn(&str)>;

/// What the pointer of an instance points at.
pub struct Handle {
    instance: Instance,
    log: Log,
    /// A panic has left it in a state that nobody knows.
    is_broken: bool,
}

/// An instance for a tool; null, and a line, where there is none.
pub fn instantiate(log: Log, make: impl FnOnce() -> Result<Instance, Complaint>) -> *mut c_void {
    match guarded(make) {
        Ok(instance) => {
            let handle = Handle {
                instance,
                log,
                is_broken: false,
            };
            Box::into_raw(Box::new(handle)).cast()
        }
        Err(Refused { complaint, .. }) => {
            log(&complaint.to_string());
            std::ptr::null_mut()
        }
    }
}

/// Ends an instance.
///
/// # Safety
/// The pointer is null or one of [`instantiate`] that is not used again.
pub unsafe fn free(instance: *mut c_void) {
    if !instance.is_null() {
        // SAFETY: it was made by `Box::into_raw` in `instantiate`, and this is its last use.
        let handle = unsafe { Box::from_raw(instance.cast::<Handle>()) };
        let _ = catch_unwind(AssertUnwindSafe(|| drop(handle)));
    }
}

/// Lets an instance work. The status is that of FMI; what is wrong goes to the logger.
///
/// # Safety
/// The pointer is null or one of [`instantiate`] that nobody else uses during the call.
pub unsafe fn call(instance: *mut c_void, work: impl FnOnce(&mut Instance) -> Result<(), Complaint>) -> i32 {
    // SAFETY: null, or made by `Box::into_raw` in `instantiate` and not freed, as the caller promises.
    let Some(handle) = (unsafe { instance.cast::<Handle>().as_mut() }) else {
        return ERROR;
    };
    let outcome = if handle.is_broken {
        Err(Refused {
            complaint: Complaint::new("the instance has failed before: free it and instantiate a new one"),
            panicked: false,
        })
    } else {
        guarded(|| work(&mut handle.instance))
    };
    match outcome {
        Ok(()) => OK,
        Err(Refused { complaint, panicked }) => {
            handle.is_broken |= panicked;
            (handle.log)(&complaint.to_string());
            ERROR
        }
    }
}

struct Refused {
    complaint: Complaint,
    panicked: bool,
}

/// A panic must not unwind into a tool that is not Rust: it becomes a complaint.
fn guarded<T>(work: impl FnOnce() -> Result<T, Complaint>) -> Result<T, Refused> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(outcome) => outcome.map_err(|complaint| Refused {
            complaint,
            panicked: false,
        }),
        Err(_) => Err(Refused {
            complaint: Complaint::new("an internal error of oleo: please report it with the inputs that led to it"),
            panicked: true,
        }),
    }
}
