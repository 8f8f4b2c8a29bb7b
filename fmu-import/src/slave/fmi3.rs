//! FMI 3.0 for co-simulation, without event mode and early return.

use std::ffi::{CString, c_char, c_int, c_void};
use std::path::{MAIN_SEPARATOR, Path};

use libloading::Library;

use super::call::{checked, function, integer, switch};
use super::contract::Slave;
use super::log;
use crate::description::NumberKind;
use crate::message::VariableId;

/// `fmi3LogMessageCallback`.
type LogMessage = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

unsafe extern "C" fn log_message(_: *mut c_void, status: c_int, _: *const c_char, message: *const c_char) {
    // SAFETY: FMI: a text that lives during the call.
    unsafe { log::keep(status, message) }
}

type Phase = unsafe extern "C" fn(*mut c_void) -> c_int;

/// An instance and its functions.
pub struct Instance<'l> {
    library: &'l Library,
    handle: *mut c_void,
}

impl<'l> Instance<'l> {
    pub fn new(library: &'l Library, name: &str, token: &str, resources: &Path) -> Result<Self, String> {
        type Instantiate = unsafe extern "C" fn(
            *const c_char,
            *const c_char,
            *const c_char,
            bool,
            bool,
            bool,
            bool,
            *const u32,
            usize,
            *mut c_void,
            LogMessage,
            Option<unsafe extern "C" fn()>,
        ) -> *mut c_void;
        // FMI 3.0 asks for the separator at the end.
        let folder = format!("{}{MAIN_SEPARATOR}", resources.display());
        let [name, token, folder] =
            [name, token, &folder].map(|text| CString::new(text.replace('\0', " ")).unwrap_or_default());
        let instantiate = function::<Instantiate>(library, "fmi3InstantiateCoSimulation")?;
        // SAFETY: the signature of the standard; texts that live during the call.
        let handle = unsafe {
            instantiate(
                name.as_ptr(),
                token.as_ptr(),
                folder.as_ptr(),
                false,
                false,
                false,
                false,
                std::ptr::null(),
                0,
                std::ptr::null_mut(),
                log_message,
                None,
            )
        };
        if handle.is_null() {
            checked(3, "fmi3InstantiateCoSimulation")?;
        }
        Ok(Self { library, handle })
    }

    fn phase(&self, name: &str) -> Result<(), String> {
        let phase = function::<Phase>(self.library, name)?;
        // SAFETY: the signature of the standard, with the instance that it made.
        checked(unsafe { phase(self.handle) }, name)
    }

    fn put<V>(&self, name: &str, reference: u32, value: V) -> Result<(), String> {
        type Set<V> = unsafe extern "C" fn(*mut c_void, *const u32, usize, *const V, usize) -> c_int;
        let set = function::<Set<V>>(self.library, name)?;
        // SAFETY: the signature of the standard, and one reference and one value that live during the call.
        checked(
            unsafe { set(self.handle, &raw const reference, 1, &raw const value, 1) },
            name,
        )
    }

    fn read<V: Default>(&self, name: &str, reference: u32) -> Result<V, String> {
        type Get<V> = unsafe extern "C" fn(*mut c_void, *const u32, usize, *mut V, usize) -> c_int;
        let get = function::<Get<V>>(self.library, name)?;
        let mut value = V::default();
        // SAFETY: the signature of the standard, and one reference and one place that live during the call.
        checked(
            unsafe { get(self.handle, &raw const reference, 1, &raw mut value, 1) },
            name,
        )?;
        Ok(value)
    }
}

impl Slave for Instance<'_> {
    fn enter_initialization(&mut self, start_s: f64, stop_s: f64) -> Result<(), String> {
        type Enter = unsafe extern "C" fn(*mut c_void, bool, f64, f64, bool, f64) -> c_int;
        let name = "fmi3EnterInitializationMode";
        let enter = function::<Enter>(self.library, name)?;
        // SAFETY: the signature of the standard, with the instance that it made.
        checked(unsafe { enter(self.handle, false, 0.0, start_s, true, stop_s) }, name)
    }

    fn exit_initialization(&mut self) -> Result<(), String> {
        self.phase("fmi3ExitInitializationMode")
    }

    fn set(&mut self, variable: VariableId, value: f64) -> Result<(), String> {
        match variable.kind {
            NumberKind::Float64 => self.put("fmi3SetFloat64", variable.reference, value),
            NumberKind::Float32 => self.put("fmi3SetFloat32", variable.reference, value as f32),
            NumberKind::Int32 => self.put("fmi3SetInt32", variable.reference, integer::<i32>(value)?),
            NumberKind::Int64 => self.put("fmi3SetInt64", variable.reference, integer::<i64>(value)?),
            NumberKind::Boolean => self.put("fmi3SetBoolean", variable.reference, u8::from(switch(value))),
        }
    }

    fn get(&mut self, variable: VariableId) -> Result<f64, String> {
        match variable.kind {
            NumberKind::Float64 => self.read("fmi3GetFloat64", variable.reference),
            NumberKind::Float32 => self.read::<f32>("fmi3GetFloat32", variable.reference).map(f64::from),
            NumberKind::Int32 => self.read::<i32>("fmi3GetInt32", variable.reference).map(f64::from),
            NumberKind::Int64 => self
                .read::<i64>("fmi3GetInt64", variable.reference)
                .map(|value| value as f64),
            NumberKind::Boolean => {
                // As a byte, because a byte that is neither 0 nor 1 is no `bool` of Rust.
                let on = self.read::<u8>("fmi3GetBoolean", variable.reference)?;
                Ok(f64::from(u8::from(on != 0)))
            }
        }
    }

    fn step(&mut self, time_s: f64, step_s: f64) -> Result<(), String> {
        type Step = unsafe extern "C" fn(*mut c_void, f64, f64, bool, *mut u8, *mut u8, *mut u8, *mut f64) -> c_int;
        let step = function::<Step>(self.library, "fmi3DoStep")?;
        let (mut event, mut terminate, mut early, mut reached) = (0_u8, 0_u8, 0_u8, time_s);
        // SAFETY: the signature of the standard, and places that live during the call.
        let status = unsafe {
            step(
                self.handle,
                time_s,
                step_s,
                true,
                &raw mut event,
                &raw mut terminate,
                &raw mut early,
                &raw mut reached,
            )
        };
        checked(status, "fmi3DoStep")?;
        match (terminate, early) {
            (0, 0) => Ok(()),
            (0, _) => Err("fmi3DoStep: the FMU returned early, which it was not allowed to".to_owned()),
            _ => Err("fmi3DoStep: the FMU asks to end the simulation".to_owned()),
        }
    }

    fn terminate(&mut self) {
        let _ = self.phase("fmi3Terminate");
    }
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        if let Ok(free) = function::<unsafe extern "C" fn(*mut c_void)>(self.library, "fmi3FreeInstance") {
            // SAFETY: the signature of the standard, with the instance that it made and that is not used again.
            unsafe { free(self.handle) }
        }
    }
}
