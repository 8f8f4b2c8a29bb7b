//! FMI 2.0 for co-simulation.

use std::ffi::{CString, c_char, c_int, c_void};
use std::path::Path;

use libloading::Library;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

use super::call::{checked, foreign, function, integer, switch};
use super::contract::Slave;
use super::log;
use crate::description::NumberKind;
use crate::message::VariableId;

/// `fmi2CoSimulation`.
const CO_SIMULATION: c_int = 1;
/// What stays as it is in the path of a URI.
const PATH: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'/')
    .remove(b'.')
    .remove(b'-')
    .remove(b'_')
    .remove(b'~');

/// `fmi2CallbackFunctions`.
#[repr(C)]
struct Callbacks {
    logger: unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char),
    allocate_memory: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    free_memory: unsafe extern "C" fn(*mut c_void),
    step_finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    component_environment: *mut c_void,
}

/// `fmi2CallbackLogger` less the numbers that belong into the text, which stable Rust cannot take. They are in registers or on the stack behind the named ones, on every platform of
/// the standard, and the caller clears them away.
unsafe extern "C" fn logger(_: *mut c_void, _: *const c_char, status: c_int, _: *const c_char, message: *const c_char) {
    // SAFETY: FMI: a text that lives during the call.
    unsafe { log::keep(status, message) }
}

type Phase = unsafe extern "C" fn(*mut c_void) -> c_int;

/// An instance and its functions.
pub struct Instance<'l> {
    library: &'l Library,
    handle: *mut c_void,
    // The FMU keeps a pointer to it.
    _callbacks: Box<Callbacks>,
}

impl<'l> Instance<'l> {
    pub fn new(library: &'l Library, name: &str, token: &str, resources: &Path) -> Result<Self, String> {
        type Instantiate = unsafe extern "C" fn(
            *const c_char,
            c_int,
            *const c_char,
            *const c_char,
            *const Callbacks,
            c_int,
            c_int,
        ) -> *mut c_void;
        let callbacks = Box::new(Callbacks {
            logger,
            allocate_memory: nix::libc::calloc,
            free_memory: nix::libc::free,
            step_finished: None,
            component_environment: std::ptr::null_mut(),
        });
        let uri = format!("file://{}", utf8_percent_encode(&resources.to_string_lossy(), PATH));
        let [name, token, uri] =
            [name, token, &uri].map(|text| CString::new(text.replace('\0', " ")).unwrap_or_default());
        let instantiate = function::<Instantiate>(library, "fmi2Instantiate")?;
        // SAFETY: the signature of the standard; texts that live during the call, and callbacks that live as long as the instance.
        let handle = unsafe {
            instantiate(
                name.as_ptr(),
                CO_SIMULATION,
                token.as_ptr(),
                uri.as_ptr(),
                &raw const *callbacks,
                0,
                0,
            )
        };
        if handle.is_null() {
            checked(3, "fmi2Instantiate")?;
        }
        Ok(Self {
            library,
            handle,
            _callbacks: callbacks,
        })
    }

    fn phase(&self, name: &str) -> Result<(), String> {
        let phase = function::<Phase>(self.library, name)?;
        // SAFETY: the signature of the standard, with the instance that it made.
        checked(unsafe { phase(self.handle) }, name)
    }

    fn put<V>(&self, name: &str, reference: u32, value: V) -> Result<(), String> {
        let set =
            function::<unsafe extern "C" fn(*mut c_void, *const u32, usize, *const V) -> c_int>(self.library, name)?;
        // SAFETY: the signature of the standard, and one reference and one value that live during the call.
        checked(
            unsafe { set(self.handle, &raw const reference, 1, &raw const value) },
            name,
        )
    }

    fn read<V: Default>(&self, name: &str, reference: u32) -> Result<V, String> {
        let get =
            function::<unsafe extern "C" fn(*mut c_void, *const u32, usize, *mut V) -> c_int>(self.library, name)?;
        let mut value = V::default();
        // SAFETY: the signature of the standard, and one reference and one place that live during the call.
        checked(
            unsafe { get(self.handle, &raw const reference, 1, &raw mut value) },
            name,
        )?;
        Ok(value)
    }
}

impl Slave for Instance<'_> {
    fn enter_initialization(&mut self, start_s: f64, stop_s: f64) -> Result<(), String> {
        type SetUp = unsafe extern "C" fn(*mut c_void, c_int, f64, f64, c_int, f64) -> c_int;
        let set_up = function::<SetUp>(self.library, "fmi2SetupExperiment")?;
        // SAFETY: the signature of the standard, with the instance that it made.
        checked(
            unsafe { set_up(self.handle, 0, 0.0, start_s, 1, stop_s) },
            "fmi2SetupExperiment",
        )?;
        self.phase("fmi2EnterInitializationMode")
    }

    fn exit_initialization(&mut self) -> Result<(), String> {
        self.phase("fmi2ExitInitializationMode")
    }

    fn set(&mut self, variable: VariableId, value: f64) -> Result<(), String> {
        match variable.kind {
            NumberKind::Float64 => self.put("fmi2SetReal", variable.reference, value),
            NumberKind::Int32 => self.put("fmi2SetInteger", variable.reference, integer::<c_int>(value)?),
            NumberKind::Boolean => self.put("fmi2SetBoolean", variable.reference, c_int::from(switch(value))),
            other => Err(foreign(other)),
        }
    }

    fn get(&mut self, variable: VariableId) -> Result<f64, String> {
        match variable.kind {
            NumberKind::Float64 => self.read("fmi2GetReal", variable.reference),
            NumberKind::Int32 => self.read::<c_int>("fmi2GetInteger", variable.reference).map(f64::from),
            NumberKind::Boolean => {
                let on = self.read::<c_int>("fmi2GetBoolean", variable.reference)?;
                Ok(f64::from(u8::from(on != 0)))
            }
            other => Err(foreign(other)),
        }
    }

    fn step(&mut self, time_s: f64, step_s: f64) -> Result<(), String> {
        type Step = unsafe extern "C" fn(*mut c_void, f64, f64, c_int) -> c_int;
        let step = function::<Step>(self.library, "fmi2DoStep")?;
        // SAFETY: the signature of the standard, with the instance that it made.
        checked(unsafe { step(self.handle, time_s, step_s, 1) }, "fmi2DoStep")
    }

    fn terminate(&mut self) {
        let _ = self.phase("fmi2Terminate");
    }
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        if let Ok(free) = function::<unsafe extern "C" fn(*mut c_void)>(self.library, "fmi2FreeInstance") {
            // SAFETY: the signature of the standard, with the instance that it made and that is not used again.
            unsafe { free(self.handle) }
        }
    }
}
