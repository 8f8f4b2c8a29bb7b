//! FMI 2.0 for co-simulation: the functions by the names in the standard.

use std::ffi::{CString, c_char, c_int, c_void};

use super::handle::{ERROR, OK, call, free, instantiate};
use super::memory::{path_of_uri, place, places, text, values};
use super::state::{deserialize, free_state, put_state, serialize, state};
use crate::asked::Asked;
use crate::complaint::Complaint;
use crate::instance::Instance;
use crate::model::switch;

/// `fmi2CoSimulation`: the only type of FMU that this library is.
const CO_SIMULATION: c_int = 1;
/// The one category of messages.
const CATEGORY: &str = "logStatusError";

/// `fmi2CallbackLogger`.
type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// `fmi2CallbackFunctions`. Only the logger is used.
#[repr(C)]
pub struct Callbacks {
    pub logger: Option<Logger>,
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    pub component_environment: *mut c_void,
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    fmu_type: c_int,
    guid: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    _logging_on: c_int,
) -> *mut c_void {
    // SAFETY: FMI: the callbacks are there while the instance lives, and what is needed of them is copied here.
    let (logger, environment) = match unsafe { callbacks.as_ref() } {
        Some(callbacks) => (callbacks.logger, callbacks.component_environment),
        None => (None, std::ptr::null_mut()),
    };
    // SAFETY: FMI: a text, or null, which is taken for no name.
    let instance_name = unsafe { text(name, "instanceName") }.unwrap_or_default();
    let c_text = |text: &str| CString::new(text.replace('\0', " ")).unwrap_or_default();
    let (instance_name, category) = (c_text(&instance_name), c_text(CATEGORY));
    let log = Box::new(move |line: &str| {
        if let Some(logger) = logger {
            // The message is the format of a printf.
            let message = c_text(&line.replace('%', "%%"));
            // SAFETY: the tool's own function with its own environment, and texts that live during the call.
            unsafe {
                logger(
                    environment,
                    instance_name.as_ptr(),
                    ERROR,
                    category.as_ptr(),
                    message.as_ptr(),
                );
            }
        }
    });
    instantiate(log, || {
        if fmu_type != CO_SIMULATION {
            return Err(Complaint::new(
                "the FMU is one for co-simulation, and model exchange was asked for",
            ));
        }
        // SAFETY: FMI: texts that end with a zero, or null.
        let (guid, resources) = unsafe { (text(guid, "fmuGUID")?, text(resources, "fmuResourceLocation")?) };
        Instance::new(&guid, &path_of_uri(&resources), false)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(instance: *mut c_void) {
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null, not used again.
    unsafe { free(instance) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    instance: *mut c_void,
    _logging_on: c_int,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    // There is nothing to debug by messages: only errors are logged, and always.
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, |_| Ok(())) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    instance: *mut c_void,
    _tolerance_defined: c_int,
    _tolerance: f64,
    start_s: f64,
    _stop_defined: c_int,
    _stop_s: f64,
) -> c_int {
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, |instance| instance.set_up(start_s)) }
}

/// Functions that change the phase of an instance and have no other argument.
macro_rules! phases {
    ($($name:ident: $method:expr;)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut c_void) -> c_int {
            // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
            unsafe { call(instance, $method) }
        }
    )*};
}

phases! {
    fmi2EnterInitializationMode: Instance::enter_initialization;
    fmi2ExitInitializationMode: Instance::exit_initialization;
    fmi2Terminate: Instance::terminate;
    fmi2Reset: |instance| {
        instance.reset();
        Ok(())
    };
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(instance: *mut c_void, vr: *const u32, count: usize, out: *mut f64) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: `count` references and places, or null.
        let (references, places) = unsafe { (values(vr, count, "vr")?, places(out, count, "value")?) };
        places.copy_from_slice(&instance.get(Asked::Real, references)?);
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(instance: *mut c_void, vr: *const u32, count: usize, new: *const f64) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: `count` references and values, or null.
        let (references, new) = unsafe { (values(vr, count, "vr")?, values(new, count, "value")?) };
        instance.set(Asked::Real, references, new)
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

/// Words of a list: FMI 2 has them as integers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(instance: *mut c_void, vr: *const u32, count: usize, out: *mut c_int) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: `count` references and places, or null.
        let (references, places) = unsafe { (values(vr, count, "vr")?, places(out, count, "value")?) };
        for (place, value) in places.iter_mut().zip(instance.get(Asked::Word, references)?) {
            *place = value as c_int;
        }
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    instance: *mut c_void,
    vr: *const u32,
    count: usize,
    new: *const c_int,
) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: `count` references and values, or null.
        let (references, new) = unsafe { (values(vr, count, "vr")?, values(new, count, "value")?) };
        let new: Vec<f64> = new.iter().map(|value| f64::from(*value)).collect();
        instance.set(Asked::Word, references, &new)
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(instance: *mut c_void, vr: *const u32, count: usize, out: *mut c_int) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: `count` references and places, or null.
        let (references, places) = unsafe { (values(vr, count, "vr")?, places(out, count, "value")?) };
        for (place, value) in places.iter_mut().zip(instance.get(Asked::Switch, references)?) {
            *place = c_int::from(value != 0.0);
        }
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    instance: *mut c_void,
    vr: *const u32,
    count: usize,
    new: *const c_int,
) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: `count` references and values, or null.
        let (references, new) = unsafe { (values(vr, count, "vr")?, values(new, count, "value")?) };
        let new: Vec<f64> = new.iter().map(|value| switch(*value != 0)).collect();
        instance.set(Asked::Switch, references, &new)
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

/// Functions for texts, which no variable is: an error unless nothing is asked for.
macro_rules! no_texts {
    ($($name:ident($pointer:ty);)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut c_void, vr: *const u32, count: usize, _: $pointer) -> c_int {
            let work = |instance: &mut Instance| {
                // SAFETY: FMI: `count` references, or null.
                let references = unsafe { values(vr, count, "vr")? };
                instance.get(Asked::Other("a text"), references).map(drop)
            };
            // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
            unsafe { call(instance, work) }
        }
    )*};
}

no_texts! {
    fmi2GetString(*mut *const c_char);
    fmi2SetString(*const *const c_char);
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(instance: *mut c_void, out: *mut *mut c_void) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: the place of a state, which holds null or a state of this function.
        unsafe { put_state(place(out, "FMUstate")?, instance.save()?) };
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(instance: *mut c_void, kept: *mut c_void) -> c_int {
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null, and a state of `fmi2GetFMUstate` or null.
    unsafe { call(instance, |instance| instance.load(state(kept)?)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(instance: *mut c_void, kept: *mut *mut c_void) -> c_int {
    let work = |_: &mut Instance| {
        // SAFETY: FMI: the place of a state, which holds null or a state that nobody uses again; null is permitted.
        if let Some(kept) = unsafe { kept.as_mut() } {
            unsafe { free_state(kept) };
        }
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    instance: *mut c_void,
    kept: *mut c_void,
    size: *mut usize,
) -> c_int {
    let work = |_: &mut Instance| {
        // SAFETY: FMI: a state of `fmi2GetFMUstate` or null, and a place for a size.
        unsafe { *place(size, "size")? = state(kept)?.len() };
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    instance: *mut c_void,
    kept: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null, a state of `fmi2GetFMUstate` or null, and `size` places.
    unsafe { call(instance, |_| serialize(kept, bytes, size)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    instance: *mut c_void,
    bytes: *const u8,
    size: usize,
    out: *mut *mut c_void,
) -> c_int {
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null, `size` bytes, and the place of a state.
    unsafe { call(instance, |instance| deserialize(instance, bytes, size, out)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(instance: *mut c_void, from_s: f64, step_s: f64, _no_way_back: c_int) -> c_int {
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, |instance| instance.step(from_s, step_s).map(drop)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(instance: *mut c_void) -> c_int {
    let work = |_: &mut Instance| {
        Err(Complaint::new(
            "no step can be cancelled: each is done when its call returns",
        ))
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

/// Functions of capabilities that the description denies.
macro_rules! denied {
    ($($name:ident($($argument:ty),*): $why:literal;)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut c_void, $(_: $argument),*) -> c_int {
            // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
            unsafe { call(instance, |_| Err(Complaint::new($why))) }
        }
    )*};
}

denied! {
    fmi2GetDirectionalDerivative(*const u32, usize, *const u32, usize, *const f64, *mut f64):
        "there are no directional derivatives: the description says so";
    fmi2SetRealInputDerivatives(*const u32, usize, *const c_int, *const f64):
        "derivatives of inputs are not taken: set speed_m_s where there is one";
    fmi2GetRealOutputDerivatives(*const u32, usize, *const c_int, *mut f64):
        "there are no derivatives of outputs: the description says so";
    fmi2GetStatus(c_int, *mut c_int): "no step is pending: each is done when its call returns";
    fmi2GetIntegerStatus(c_int, *mut c_int): "no step is pending: each is done when its call returns";
    fmi2GetStringStatus(c_int, *mut *const c_char): "no step is pending: each is done when its call returns";
}

/// `fmi2LastSuccessfulTime`.
const LAST_SUCCESSFUL_TIME: c_int = 2;
/// `fmi2Terminated`.
const TERMINATED: c_int = 3;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(instance: *mut c_void, kind: c_int, out: *mut f64) -> c_int {
    let work = |instance: &mut Instance| {
        if kind != LAST_SUCCESSFUL_TIME {
            return Err(Complaint::new(format!(
                "status {kind} is not a number: ask for the last successful time, 2"
            )));
        }
        // SAFETY: FMI: a place for the value.
        unsafe { *place(out, "value")? = instance.time_s() };
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(instance: *mut c_void, kind: c_int, out: *mut c_int) -> c_int {
    let work = |_: &mut Instance| {
        if kind != TERMINATED {
            return Err(Complaint::new(format!(
                "status {kind} is not a boolean: ask for the end, 3"
            )));
        }
        // SAFETY: FMI: a place for the value. The model never asks for an end by itself.
        unsafe { *place(out, "value")? = OK };
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi2Instantiate` or null.
    unsafe { call(instance, work) }
}
