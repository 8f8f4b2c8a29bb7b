//! FMI 3.0 for co-simulation: the functions by the names in the standard.

use std::ffi::{CString, c_char, c_int, c_void};
use std::path::Path;

use super::handle::{ERROR, Log, call, free, instantiate};
use super::memory::{place, places, text, values};
use super::state::{deserialize, free_state, put_state, serialize, state};
use crate::asked::Asked;
use crate::complaint::Complaint;
use crate::instance::Instance;
use crate::model::switch;

/// The one category of messages.
const CATEGORY: &str = "logStatusError";

/// `fmi3LogMessageCallback`.
type LogMessage = Option<unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char)>;
/// `fmi3IntermediateUpdateCallback`: never called.
type IntermediateUpdate = Option<unsafe extern "C" fn()>;
/// `fmi3ClockUpdateCallback`, `fmi3LockPreemptionCallback` and `fmi3UnlockPreemptionCallback`: never called.
type Callback = Option<unsafe extern "C" fn()>;

#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// The way to a tool's logger.
fn log_to(logger: LogMessage, environment: *mut c_void) -> Log {
    let c_text = |text: &str| CString::new(text.replace('\0', " ")).unwrap_or_default();
    let category = c_text(CATEGORY);
    Box::new(move |line: &str| {
        if let Some(logger) = logger {
            let message = c_text(line);
            // SAFETY: the tool's own function with its own environment, and texts that live during the call.
            unsafe { logger(environment, ERROR, category.as_ptr(), message.as_ptr()) }
        }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: u8,
    _logging_on: u8,
    event_mode_used: u8,
    _early_return_allowed: u8,
    _intermediate_variables: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    logger: LogMessage,
    _intermediate_update: IntermediateUpdate,
) -> *mut c_void {
    instantiate(log_to(logger, environment), || {
        // SAFETY: FMI: texts that end with a zero, or null.
        let (token, resources) = unsafe { (text(token, "instantiationToken")?, text(resources, "resourcePath")?) };
        Instance::new(&token, Path::new(&resources), event_mode_used != 0)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: u8,
    _logging_on: u8,
    environment: *mut c_void,
    logger: LogMessage,
) -> *mut c_void {
    instantiate(log_to(logger, environment), || {
        Err(Complaint::new(
            "the FMU is one for co-simulation, and model exchange was asked for",
        ))
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: u8,
    _logging_on: u8,
    environment: *mut c_void,
    logger: LogMessage,
    _clock_update: Callback,
    _lock_preemption: Callback,
    _unlock_preemption: Callback,
) -> *mut c_void {
    instantiate(log_to(logger, environment), || {
        Err(Complaint::new(
            "the FMU is one for co-simulation, and scheduled execution was asked for",
        ))
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: *mut c_void) {
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null, not used again.
    unsafe { free(instance) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: *mut c_void,
    _logging_on: u8,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    // There is nothing to debug by messages: only errors are logged, and always.
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, |_| Ok(())) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut c_void,
    _tolerance_defined: u8,
    _tolerance: f64,
    start_s: f64,
    _stop_defined: u8,
    _stop_s: f64,
) -> c_int {
    let work = |instance: &mut Instance| {
        instance.set_up(start_s)?;
        instance.enter_initialization()
    };
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, work) }
}

/// Functions that change the phase of an instance and have no other argument.
macro_rules! phases {
    ($($name:ident: $method:expr;)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut c_void) -> c_int {
            // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
            unsafe { call(instance, $method) }
        }
    )*};
}

phases! {
    fmi3ExitInitializationMode: Instance::exit_initialization;
    fmi3Terminate: Instance::terminate;
    fmi3EnterConfigurationMode: Instance::enter_configuration;
    fmi3ExitConfigurationMode: Instance::exit_configuration;
    fmi3EnterEventMode: Instance::enter_events;
    fmi3EnterStepMode: Instance::enter_steps;
    fmi3Reset: |instance| {
        instance.reset();
        Ok(())
    };
}

/// Functions that get the values of one type, each converted by a function.
macro_rules! get {
    ($($name:ident($kind:ty, $asked:expr): $convert:expr;)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance: *mut c_void,
            references: *const u32,
            count: usize,
            out: *mut $kind,
            places_count: usize,
        ) -> c_int {
            let work = |instance: &mut Instance| {
                // SAFETY: FMI: as many references and places as are said, or null.
                let (references, out) = unsafe {
                    (values(references, count, "valueReferences")?, places(out, places_count, "values")?)
                };
                as_many(count, places_count)?;
                let convert: fn(f64) -> $kind = $convert;
                for (place, value) in out.iter_mut().zip(instance.get($asked, references)?) {
                    *place = convert(value);
                }
                Ok(())
            };
            // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
            unsafe { call(instance, work) }
        }
    )*};
}

/// Functions that set the values of one type, each converted by a function.
macro_rules! set {
    ($($name:ident($kind:ty, $asked:expr): $convert:expr;)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance: *mut c_void,
            references: *const u32,
            count: usize,
            new: *const $kind,
            new_count: usize,
        ) -> c_int {
            let work = |instance: &mut Instance| {
                // SAFETY: FMI: as many references and values as are said, or null.
                let (references, new) = unsafe {
                    (values(references, count, "valueReferences")?, values(new, new_count, "values")?)
                };
                let convert: fn(&$kind) -> f64 = $convert;
                let new: Vec<f64> = new.iter().map(convert).collect();
                instance.set($asked, references, &new)
            };
            // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
            unsafe { call(instance, work) }
        }
    )*};
}

/// Every variable is a single number: there are as many places as references.
fn as_many(references: usize, places: usize) -> Result<(), Complaint> {
    if references == places {
        return Ok(());
    }
    Err(Complaint::new(format!(
        "{references} variables are asked for and there is place for {places} values: give one place for each"
    )))
}

// A boolean of C is one byte.
get! {
    fmi3GetFloat64(f64, Asked::Real): |value| value;
    fmi3GetBoolean(u8, Asked::Switch): |value| u8::from(value != 0.0);
    fmi3GetInt64(i64, Asked::Word): |value| value as i64;
    fmi3GetFloat32(f32, Asked::Other("a Float32")): |_| 0.0;
    fmi3GetInt8(i8, Asked::Other("an Int8")): |_| 0;
    fmi3GetUInt8(u8, Asked::Other("a UInt8")): |_| 0;
    fmi3GetInt16(i16, Asked::Other("an Int16")): |_| 0;
    fmi3GetUInt16(u16, Asked::Other("a UInt16")): |_| 0;
    fmi3GetInt32(i32, Asked::Other("an Int32")): |_| 0;
    fmi3GetUInt32(u32, Asked::Other("a UInt32")): |_| 0;
    fmi3GetUInt64(u64, Asked::Other("a UInt64")): |_| 0;
    fmi3GetString(*const c_char, Asked::Other("a text")): |_| std::ptr::null();
}

set! {
    fmi3SetFloat64(f64, Asked::Real): |value| *value;
    fmi3SetBoolean(u8, Asked::Switch): |value| switch(*value != 0);
    fmi3SetInt64(i64, Asked::Word): |value| *value as f64;
    fmi3SetFloat32(f32, Asked::Other("a Float32")): |_| 0.0;
    fmi3SetInt8(i8, Asked::Other("an Int8")): |_| 0.0;
    fmi3SetUInt8(u8, Asked::Other("a UInt8")): |_| 0.0;
    fmi3SetInt16(i16, Asked::Other("an Int16")): |_| 0.0;
    fmi3SetUInt16(u16, Asked::Other("a UInt16")): |_| 0.0;
    fmi3SetInt32(i32, Asked::Other("an Int32")): |_| 0.0;
    fmi3SetUInt32(u32, Asked::Other("a UInt32")): |_| 0.0;
    fmi3SetUInt64(u64, Asked::Other("a UInt64")): |_| 0.0;
    fmi3SetString(*const c_char, Asked::Other("a text")): |_| 0.0;
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: *mut c_void, out: *mut *mut c_void) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: the place of a state, which holds null or a state of this function.
        unsafe { put_state(place(out, "FMUState")?, instance.save()?) };
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: *mut c_void, kept: *mut c_void) -> c_int {
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null, and a state of `fmi3GetFMUState` or null.
    unsafe { call(instance, |instance| instance.load(state(kept)?)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(instance: *mut c_void, kept: *mut *mut c_void) -> c_int {
    let work = |_: &mut Instance| {
        // SAFETY: FMI: the place of a state, which holds null or a state that nobody uses again; null is permitted.
        if let Some(kept) = unsafe { kept.as_mut() } {
            unsafe { free_state(kept) };
        }
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: *mut c_void,
    kept: *mut c_void,
    size: *mut usize,
) -> c_int {
    let work = |_: &mut Instance| {
        // SAFETY: FMI: a state of `fmi3GetFMUState` or null, and a place for a size.
        unsafe { *place(size, "size")? = state(kept)?.len() };
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: *mut c_void,
    kept: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null, a state of `fmi3GetFMUState` or null, and `size` places.
    unsafe { call(instance, |_| serialize(kept, bytes, size)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: *mut c_void,
    bytes: *const u8,
    size: usize,
    out: *mut *mut c_void,
) -> c_int {
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null, `size` bytes, and the place of a state.
    unsafe { call(instance, |instance| deserialize(instance, bytes, size, out)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: *mut c_void,
    from_s: f64,
    step_s: f64,
    _no_way_back: u8,
    event_needed: *mut u8,
    terminate: *mut u8,
    early_return: *mut u8,
    reached_s: *mut f64,
) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: four places for what is told of the step.
        let (event_needed, terminate, early_return, reached) = unsafe {
            (
                place(event_needed, "eventHandlingNeeded")?,
                place(terminate, "terminateSimulation")?,
                place(early_return, "earlyReturn")?,
                place(reached_s, "lastSuccessfulTime")?,
            )
        };
        (*event_needed, *terminate, *early_return) = (0, 0, 0);
        *reached = instance.time_s();
        *reached = instance.step(from_s, step_s)?;
        *event_needed = u8::from(instance.has_event());
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBinary(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    sizes: *mut usize,
    out: *mut *const u8,
    places_count: usize,
) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: as many references, sizes and places as are said, or null.
        let (references, sizes, out) = unsafe {
            (
                values(references, count, "valueReferences")?,
                places(sizes, places_count, "valueSizes")?,
                places(out, places_count, "values")?,
            )
        };
        as_many(count, places_count)?;
        for ((reference, size), place) in references.iter().zip(sizes).zip(out) {
            // FMI: the bytes stay until the tool calls another function of this instance, and so does the memory here.
            let bytes = instance.get_binary(*reference)?;
            (*size, *place) = (bytes.len(), bytes.as_ptr());
        }
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetBinary(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    sizes: *const usize,
    new: *const *const u8,
    new_count: usize,
) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: as many references, sizes and pointers as are said, or null.
        let (references, sizes, new) = unsafe {
            (
                values(references, count, "valueReferences")?,
                values(sizes, new_count, "valueSizes")?,
                values(new, new_count, "values")?,
            )
        };
        as_many(count, new_count)?;
        // SAFETY: FMI: each pointer points at as many bytes as its size says, or is null.
        let new: Vec<&[u8]> = (new.iter().zip(sizes))
            .map(|(bytes, size)| unsafe { values(*bytes, *size, "values") })
            .collect::<Result<_, _>>()?;
        instance.set_binaries(references, &new)
    };
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetClock(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    out: *mut u8,
) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: as many references and places as are said, or null.
        let (references, out) = unsafe {
            (
                values(references, count, "valueReferences")?,
                places(out, count, "values")?,
            )
        };
        for (place, ticks) in out.iter_mut().zip(instance.get_clocks(references)?) {
            *place = u8::from(ticks);
        }
        Ok(())
    };
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetClock(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    new: *const u8,
) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: as many references and values as are said, or null.
        let (references, new) = unsafe {
            (
                values(references, count, "valueReferences")?,
                values(new, count, "values")?,
            )
        };
        let ticks: Vec<bool> = new.iter().map(|ticks| *ticks != 0).collect();
        instance.set_clocks(references, &ticks)
    };
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, work) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EvaluateDiscreteStates(instance: *mut c_void) -> c_int {
    // No output of an instant depends on an input of the same instant.
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, |instance| instance.in_events("discrete states are evaluated")) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: *mut c_void,
    again: *mut u8,
    terminate: *mut u8,
    nominals_changed: *mut u8,
    values_changed: *mut u8,
    next_defined: *mut u8,
    next_s: *mut f64,
) -> c_int {
    let work = |instance: &mut Instance| {
        // SAFETY: FMI: six places for what is told of the instant.
        let (again, terminate, nominals_changed, values_changed, next_defined, next_s) = unsafe {
            (
                place(again, "discreteStatesNeedUpdate")?,
                place(terminate, "terminateSimulation")?,
                place(nominals_changed, "nominalsOfContinuousStatesChanged")?,
                place(values_changed, "valuesOfContinuousStatesChanged")?,
                place(next_defined, "nextEventTimeDefined")?,
                place(next_s, "nextEventTime")?,
            )
        };
        (*again, *terminate, *nominals_changed, *values_changed) = (0, 0, 0, 0);
        (*next_defined, *next_s) = (0, 0.0);
        instance.update_discrete_states()
    };
    // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
    unsafe { call(instance, work) }
}

/// Functions of capabilities that the description denies.
macro_rules! denied {
    ($($name:ident($($argument:ty),*): $why:expr;)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut c_void, $(_: $argument),*) -> c_int {
            // SAFETY: FMI: an instance of `fmi3InstantiateCoSimulation` or null.
            unsafe { call(instance, |_| Err(Complaint::new($why))) }
        }
    )*};
}

const NO_DEPENDENCIES: &str = "there are no dependencies of elements: the description says so";
const NO_DERIVATIVES: &str = "there are no derivatives: the description says so";
const NO_CLOCKS: &str = "no clock has an interval: there are none, or they are triggered, as the description says";
const NO_EXCHANGE: &str = "the FMU is one for co-simulation, and this function is one of model exchange";

denied! {
    fmi3GetNumberOfVariableDependencies(u32, *mut usize): NO_DEPENDENCIES;
    fmi3GetVariableDependencies(u32, *mut usize, *mut u32, *mut usize, *mut c_int, usize): NO_DEPENDENCIES;
    fmi3GetDirectionalDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize): NO_DERIVATIVES;
    fmi3GetAdjointDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize): NO_DERIVATIVES;
    fmi3GetOutputDerivatives(*const u32, usize, *const i32, *mut f64, usize): NO_DERIVATIVES;
    fmi3GetIntervalDecimal(*const u32, usize, *mut f64, *mut c_int): NO_CLOCKS;
    fmi3GetIntervalFraction(*const u32, usize, *mut u64, *mut u64, *mut c_int): NO_CLOCKS;
    fmi3GetShiftDecimal(*const u32, usize, *mut f64): NO_CLOCKS;
    fmi3GetShiftFraction(*const u32, usize, *mut u64, *mut u64): NO_CLOCKS;
    fmi3SetIntervalDecimal(*const u32, usize, *const f64): NO_CLOCKS;
    fmi3SetIntervalFraction(*const u32, usize, *const u64, *const u64): NO_CLOCKS;
    fmi3SetShiftDecimal(*const u32, usize, *const f64): NO_CLOCKS;
    fmi3SetShiftFraction(*const u32, usize, *const u64, *const u64): NO_CLOCKS;
    fmi3ActivateModelPartition(u32, f64): NO_CLOCKS;
    fmi3EnterContinuousTimeMode(): NO_EXCHANGE;
    fmi3CompletedIntegratorStep(u8, *mut u8, *mut u8): NO_EXCHANGE;
    fmi3SetTime(f64): NO_EXCHANGE;
    fmi3SetContinuousStates(*const f64, usize): NO_EXCHANGE;
    fmi3GetContinuousStateDerivatives(*mut f64, usize): NO_EXCHANGE;
    fmi3GetEventIndicators(*mut f64, usize): NO_EXCHANGE;
    fmi3GetContinuousStates(*mut f64, usize): NO_EXCHANGE;
    fmi3GetNominalsOfContinuousStates(*mut f64, usize): NO_EXCHANGE;
    fmi3GetNumberOfEventIndicators(*mut usize): NO_EXCHANGE;
    fmi3GetNumberOfContinuousStates(*mut usize): NO_EXCHANGE;
}
