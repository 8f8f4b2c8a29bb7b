//! Calls as a tool makes them, through the functions that it finds in the library.

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::Path;
use std::ptr::null_mut;

use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Inputs, Motion, Segment, Strut, StrutModel, replay};

use super::fmi2::*;
use super::fmi3::*;
use super::handle::{ERROR, OK};
use crate::definition::Definition;
use crate::resources::Resources;

thread_local! {
    pub(super) static LOGGED: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// A logger without the arguments behind the message, of which none is ever given.
unsafe extern "C" fn logger2(
    _: *mut c_void,
    _: *const c_char,
    status: c_int,
    _: *const c_char,
    message: *const c_char,
) {
    unsafe { logger3(null_mut(), status, message, message) }
}

unsafe extern "C" fn logger3(_: *mut c_void, status: c_int, _: *const c_char, message: *const c_char) {
    assert_eq!(status, ERROR);
    let line = unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned();
    LOGGED.with_borrow_mut(|logged| logged.push(line));
}

/// The line that the last call has logged; there must be just one.
pub(super) fn logged() -> String {
    let lines = LOGGED.take();
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(!lines[0].contains('\n'));
    lines.into_iter().next().unwrap_or_default()
}

/// An unpacked FMU.
pub(super) struct Unpacked {
    folder: tempfile::TempDir,
    pub(super) definition: Definition,
}

impl Unpacked {
    pub(super) fn of(resources: &Resources) -> Self {
        // The space is in the address as %20.
        let folder = tempfile::Builder::new().prefix("an fmu ").tempdir().unwrap();
        for (name, text) in resources.files().unwrap() {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        let (definition, _) = resources.build().unwrap();
        Self { folder, definition }
    }

    fn strut() -> Self {
        Self::of(&Resources::strut(&StrutModel::defender110(8000.0)))
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    pub(super) fn vr(&self, name: &str) -> u32 {
        let place = self
            .definition
            .variables
            .iter()
            .position(|variable| variable.name == name);
        place.unwrap_or_else(|| panic!("no variable {name}")) as u32
    }

    fn instance2_with(&self, guid: &str) -> *mut c_void {
        // SAFETY: the arguments behind the message are never given, and so never read.
        let logger: unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...) =
            unsafe { std::mem::transmute(logger2 as *const ()) };
        let callbacks = Callbacks {
            logger: Some(logger),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: null_mut(),
        };
        let uri = format!("file://{}", self.path().display()).replace(' ', "%20");
        let (guid, uri) = (CString::new(guid).unwrap(), CString::new(uri).unwrap());
        unsafe { fmi2Instantiate(c"one".as_ptr(), 1, guid.as_ptr(), uri.as_ptr(), &callbacks, 0, 0) }
    }

    /// An instance of FMI 2 that is ready for a step.
    fn started2(&self) -> *mut c_void {
        let instance = self.instance2_with(&self.definition.token());
        assert!(!instance.is_null(), "{:?}", LOGGED.take());
        unsafe {
            assert_eq!(fmi2SetupExperiment(instance, 0, 0.0, 0.0, 0, 0.0), OK);
            assert_eq!(fmi2EnterInitializationMode(instance), OK);
            assert_eq!(fmi2ExitInitializationMode(instance), OK);
        }
        instance
    }

    fn instance3(&self) -> *mut c_void {
        self.instance3_with(false)
    }

    pub(super) fn instance3_with(&self, uses_events: bool) -> *mut c_void {
        let token = CString::new(self.definition.token()).unwrap();
        let path = CString::new(self.path().display().to_string()).unwrap();
        unsafe {
            fmi3InstantiateCoSimulation(
                c"one".as_ptr(),
                token.as_ptr(),
                path.as_ptr(),
                0,
                0,
                uses_events.into(),
                0,
                std::ptr::null(),
                0,
                null_mut(),
                Some(logger3),
                None,
            )
        }
    }

    fn set2(&self, instance: *mut c_void, name: &str, value: f64) -> c_int {
        unsafe { fmi2SetReal(instance, &self.vr(name), 1, &value) }
    }

    fn get2(&self, instance: *mut c_void, name: &str) -> f64 {
        let mut value = f64::NAN;
        assert_eq!(unsafe { fmi2GetReal(instance, &self.vr(name), 1, &mut value) }, OK);
        value
    }
}

/// A power of two, so that times in a row have differences of the same bits.
const STEP_S: f64 = 1.0 / 512.0;
const STEPS: u32 = 700;

/// Displacement at the end of a step, and the signals during it: at first all closed.
fn inputs(k: u32) -> (f64, StrutValves<bool>) {
    let t = STEP_S * f64::from(k + 1);
    let signals = StrutValves::new(k % 170 > 90, k % 230 > 120, k % 310 > 130);
    (0.03 * libm::sin(7.0 * t) - 0.004 * libm::sin(60.0 * t), signals)
}

const OUTPUTS: [&str; 5] = ["force_N", "p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"];

/// One step through FMI 2; the bits of force and pressures.
fn step2(fmu: &Unpacked, instance: *mut c_void, k: u32) -> [u64; 5] {
    let (to_m, signals) = inputs(k);
    assert_eq!(fmu.set2(instance, "displacement_m", to_m), OK);
    let signals = signals.into_array().map(c_int::from);
    let valves = ["valve1", "valve2", "valve3"].map(|name| fmu.vr(name));
    unsafe {
        assert_eq!(fmi2SetBoolean(instance, valves.as_ptr(), 3, signals.as_ptr()), OK);
        let status = fmi2DoStep(instance, STEP_S * f64::from(k), STEP_S, 1);
        assert_eq!(status, OK, "{:?}", LOGGED.take());
    }
    OUTPUTS.map(|name| fmu.get2(instance, name).to_bits())
}

/// What the strut itself answers to the same inputs.
fn of_strut() -> Vec<[u64; 5]> {
    let mut strut = Strut::at_rest(&StrutModel::defender110(8000.0), StrutValves::default()).unwrap();
    (0..STEPS)
        .map(|k| {
            let (to_m, signals) = inputs(k);
            let out = strut.advance(to_m, STEP_S, signals);
            let [p1, p2, p3, p4] = out.pressure_pa;
            [out.force_n, p1, p2, p3, p4].map(f64::to_bits)
        })
        .collect()
}

#[test]
fn a_strut_has_the_bits_of_the_strut_and_of_a_replay() {
    let fmu = Unpacked::strut();
    let instance = fmu.started2();
    let expected = of_strut();
    for (k, expected) in (0..STEPS).zip(&expected) {
        assert_eq!(step2(&fmu, instance, k), *expected, "step {k}");
    }
    unsafe { fmi2FreeInstance(instance) };

    // A replay of the same motion, at even speed from sample to sample.
    let mut at = 0.0;
    let segments = (0..STEPS).map(|k| {
        let (to_m, _) = inputs(k);
        let speed = (to_m - at) / STEP_S;
        at = to_m;
        Segment {
            to_m,
            from_m_s: speed,
            to_m_s: speed,
        }
    });
    let replayed = Inputs {
        motion: Motion {
            start_m: 0.0,
            segments: segments.collect(),
        },
        time_s: (0..=STEPS).map(|k| STEP_S * f64::from(k)).collect(),
        signals: (0..=STEPS).map(|k| inputs(k).1).collect(),
    };
    let predicted = replay(&StrutModel::defender110(8000.0), &replayed).unwrap();
    for (k, expected) in expected.iter().enumerate() {
        let [p1, p2, p3, p4] = predicted.pressure_pa.each_ref().map(|pressure| pressure[k + 1]);
        assert_eq!(
            [predicted.force_n[k + 1], p1, p2, p3, p4].map(f64::to_bits),
            *expected,
            "step {k}"
        );
    }
}

#[test]
fn both_versions_have_the_same_bits() {
    let fmu = Unpacked::strut();
    let (two, three) = (fmu.started2(), fmu.instance3());
    assert!(!three.is_null(), "{:?}", LOGGED.take());
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(three, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(fmi3ExitInitializationMode(three), OK);
        for k in 0..STEPS {
            let (to_m, signals) = inputs(k);
            assert_eq!(fmi3SetFloat64(three, &fmu.vr("displacement_m"), 1, &to_m, 1), OK);
            let valves = ["valve1", "valve2", "valve3"].map(|name| fmu.vr(name));
            let signals = signals.into_array().map(u8::from);
            assert_eq!(fmi3SetBoolean(three, valves.as_ptr(), 3, signals.as_ptr(), 3), OK);
            let (mut a, mut b, mut c, mut reached) = (9, 9, 9, 0.0);
            let from_s = STEP_S * f64::from(k);
            assert_eq!(
                fmi3DoStep(three, from_s, STEP_S, 1, &mut a, &mut b, &mut c, &mut reached),
                OK
            );
            assert_eq!((a, b, c, reached), (0, 0, 0, from_s + STEP_S));
            let mut out = [0.0; 5];
            let outputs = OUTPUTS.map(|name| fmu.vr(name));
            assert_eq!(fmi3GetFloat64(three, outputs.as_ptr(), 5, out.as_mut_ptr(), 5), OK);
            assert_eq!(out.map(f64::to_bits), step2(&fmu, two, k), "step {k}");
        }
        assert_eq!(fmi3Terminate(three), OK);
        fmi3FreeInstance(three);
        fmi2FreeInstance(two);
    }
}

#[test]
fn a_serialised_state_goes_on_in_another_instance_with_the_same_bits() {
    let fmu = Unpacked::strut();
    let first = fmu.started2();
    // A number that is changed while the strut works belongs to the state.
    let change = |instance, k| {
        if k == 300 {
            assert_eq!(
                fmu.set2(instance, "effects.gas_heat_transfer.time_constant_1_s", 0.7),
                OK
            );
        }
    };
    let expected: Vec<[u64; 5]> = (0..STEPS)
        .map(|k| {
            change(first, k);
            step2(&fmu, first, k)
        })
        .collect();
    assert_ne!(expected[699], of_strut()[699]);
    for stop in [1, 95, 299, 301, 433] {
        let (before, after) = (fmu.started2(), fmu.started2());
        for k in 0..stop {
            change(before, k);
            step2(&fmu, before, k);
        }
        let mut bytes = Vec::new();
        unsafe {
            let (mut kept, mut size) = (null_mut(), 0);
            assert_eq!(fmi2GetFMUstate(before, &mut kept), OK);
            assert_eq!(fmi2SerializedFMUstateSize(before, kept, &mut size), OK);
            bytes.resize(size, 0);
            assert_eq!(fmi2SerializeFMUstate(before, kept, bytes.as_mut_ptr(), size), OK);
            assert_eq!(fmi2FreeFMUstate(before, &mut kept), OK);
            assert!(kept.is_null());
            fmi2FreeInstance(before);
            assert_eq!(fmi2DeSerializeFMUstate(after, bytes.as_ptr(), size, &mut kept), OK);
            assert_eq!(fmi2SetFMUstate(after, kept), OK);
            assert_eq!(fmi2FreeFMUstate(after, &mut kept), OK);
        }
        for k in stop..STEPS {
            change(after, k);
            assert_eq!(
                step2(&fmu, after, k),
                expected[k as usize],
                "stopped at {stop}, step {k}"
            );
        }
        // Each damaged byte and each cut is noticed.
        for at in (0..bytes.len()).step_by(7) {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x10;
            let mut kept: *mut c_void = null_mut();
            unsafe {
                assert_eq!(
                    fmi2DeSerializeFMUstate(after, damaged.as_ptr(), damaged.len(), &mut kept),
                    ERROR
                );
                logged();
                assert_eq!(fmi2DeSerializeFMUstate(after, bytes.as_ptr(), at, &mut kept), ERROR);
            }
            logged();
            assert!(kept.is_null());
        }
        unsafe { fmi2FreeInstance(after) };
    }
    unsafe { fmi2FreeInstance(first) };
}

#[test]
fn instances_on_several_threads_do_not_know_of_each_other() {
    let fmu = Unpacked::strut();
    let expected = of_strut();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let [one, other] = [fmu.started2(), fmu.started2()];
                for k in 0..STEPS {
                    assert_eq!(step2(&fmu, one, k), expected[k as usize]);
                    if k >= 50 {
                        assert_eq!(step2(&fmu, other, k - 50), expected[k as usize - 50]);
                    }
                }
                [one, other]
                    .into_iter()
                    .for_each(|instance| unsafe { fmi2FreeInstance(instance) });
            });
        }
    });
}

#[test]
fn after_a_reset_everything_is_as_in_the_beginning() {
    let fmu = Unpacked::strut();
    let instance = fmu.started2();
    let expected = of_strut();
    unsafe {
        (0..100).for_each(|k| _ = step2(&fmu, instance, k));
        assert_eq!(fmi2Reset(instance), OK);
        assert_eq!(fmu.set2(instance, "cylinder.bore_m", 0.06), OK);
        assert_eq!(fmi2Reset(instance), OK);
        assert_eq!(fmi2EnterInitializationMode(instance), OK);
        assert_eq!(fmi2ExitInitializationMode(instance), OK);
    }
    for (k, expected) in (0..STEPS).zip(expected) {
        assert_eq!(step2(&fmu, instance, k), expected);
    }
    unsafe { fmi2FreeInstance(instance) };
}

/// A parameter is that of the model file, and the initial displacement is one at rest.
#[test]
fn parameters_and_start_values_are_those_of_the_model() {
    let fmu = Unpacked::strut();
    let mut model = StrutModel::defender110(8000.0);
    model.accumulator[1].static_gas_volume_m3 = 5e-4;
    model.damper[0].pressure_drop_pa[8] = 1.9e6;
    let instance = fmu.instance2_with(&fmu.definition.token());
    assert_eq!(fmu.set2(instance, "accumulator[2].static_gas_volume_m3", 5e-4), OK);
    assert_eq!(fmu.set2(instance, "damper[1].pressure_drop_Pa[9]", 1.9e6), OK);
    assert_eq!(fmu.set2(instance, "displacement_m", 0.02), OK);
    unsafe {
        assert_eq!(fmi2EnterInitializationMode(instance), OK);
        let mut strut = Strut::at_rest_at(&model, StrutValves::default(), 0.02).unwrap();
        assert_eq!(
            fmu.get2(instance, "force_N").to_bits(),
            strut.output().force_n.to_bits()
        );
        assert_eq!(fmi2ExitInitializationMode(instance), OK);
        // With a speed, the displacement is that of the begin of the step.
        assert_eq!(fmu.set2(instance, "speed_m_s", 0.5), OK);
        assert_eq!(fmi2DoStep(instance, 0.0, 0.01, 1), OK);
        let out = strut.advance(0.02 + 0.5 * 0.01, 0.01, StrutValves::default());
        assert_eq!(fmu.get2(instance, "force_N").to_bits(), out.force_n.to_bits());
        assert_eq!(fmu.get2(instance, "time"), 0.01);
        fmi2FreeInstance(instance);
    }
}

#[test]
fn what_is_wrong_is_an_error_with_one_line() {
    let fmu = Unpacked::strut();
    let instance = fmu.started2();
    let complains = |status: c_int, start: &str| {
        assert_eq!(status, ERROR, "{start}");
        let line = logged();
        assert!(line.starts_with(start), "{line}");
    };
    let mut real = 0.0;
    unsafe {
        complains(
            fmi2GetReal(instance, &9999, 1, &mut real),
            "value reference 9999 is unknown: they go from 0 to ",
        );
        complains(
            fmi2GetReal(instance, &fmu.vr("valve1"), 1, &mut real),
            "valve1 (value reference 3) is a boolean, not a floating-point number",
        );
        complains(
            fmi2GetString(instance, &0, 1, null_mut()),
            "time (value reference 0) is a floating-point number, not a text",
        );
        complains(
            fmi2GetReal(instance, std::ptr::null(), 1, &mut real),
            "vr: the pointer is null",
        );
        complains(fmi2GetReal(instance, &0, 1, null_mut()), "value: the pointer is null");
        assert_eq!(fmi2GetReal(instance, std::ptr::null(), 0, null_mut()), OK);
        complains(
            fmu.set2(instance, "force_N", 1.0),
            "force_N cannot be set: the model computes it",
        );
        complains(
            fmu.set2(instance, "cylinder.bore_m", 0.06),
            "cylinder.bore_m cannot be set now: the instance is between",
        );
        complains(
            fmu.set2(instance, "displacement_m", f64::NAN),
            "displacement_m is NaN: must be from -2 to 2 m",
        );
        complains(
            fmu.set2(instance, "valve[1].flow_coefficient", -1.0),
            "valve[1].flow_coefficient is -1: must be from 1e-12 to 1 m3/s/sqrt(Pa)",
        );
        complains(
            fmi2DoStep(instance, 0.5, STEP_S, 1),
            "the step begins at 0.5 s and the model is at 0 s",
        );
        complains(fmi2DoStep(instance, f64::NAN, STEP_S, 1), "the step begins at NaN s");
        for step_s in [0.0, -0.001, f64::NAN, f64::INFINITY, 1e9] {
            complains(fmi2DoStep(instance, 0.0, step_s, 1), "the step is ");
        }
        complains(
            fmi2ExitInitializationMode(instance),
            "the initialization mode ends in the initialization mode: ",
        );
        complains(fmi2SetFMUstate(instance, null_mut()), "state: the pointer is null");
        complains(fmi2CancelStep(instance), "no step can be cancelled");
        assert_eq!(fmi2DoStep(null_mut(), 0.0, STEP_S, 1), ERROR);
        fmi2FreeInstance(null_mut());

        // Numbers that do not go together are refused by the model file's own check, when the step begins; put right, it is made.
        assert_eq!(fmu.set2(instance, "damper[1].flow_m3_s[2]", 0.5), OK);
        complains(
            fmi2DoStep(instance, 0.0, STEP_S, 1),
            "[damper 1] flow_m3_s, entry 3, is -0.0004: must be above the entry before it",
        );
        assert_eq!(fmu.set2(instance, "damper[1].flow_m3_s[2]", -0.001), OK);
        assert_eq!(fmi2DoStep(instance, 0.0, STEP_S, 1), OK);
        assert_eq!(fmi2Terminate(instance), OK);
        complains(
            fmi2DoStep(instance, STEP_S, STEP_S, 1),
            "a step is made between the initialization mode and the end",
        );
        fmi2FreeInstance(instance);

        assert!(fmu.instance2_with("{another}").is_null());
        assert!(logged().contains("another version of oleo"));
        std::fs::write(fmu.path().join("strut.toml"), "bore = ").unwrap();
        assert!(fmu.instance2_with(&fmu.definition.token()).is_null());
        assert!(logged().starts_with("strut.toml"));
    }
}

/// Calls in any order with any arguments that C permits: each returns a status, and nothing else happens.
#[test]
fn calls_in_any_order_do_no_harm() {
    let fmu = Unpacked::strut();
    let mut random: u64 = 1;
    let mut next = |below: u64| {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) % below
    };
    let numbers = [
        0.0,
        1e-3,
        -1e-3,
        0.01,
        0.5,
        -2.0,
        2.0,
        1e300,
        f64::NAN,
        f64::INFINITY,
        1e-6,
        3.0,
    ];
    let count = fmu.definition.variables.len() as u64;
    let mut instance: *mut c_void = null_mut();
    let mut kept: *mut c_void = null_mut();
    let mut statuses = [0_u32; 4];
    for _ in 0..20_000 {
        unsafe {
            if instance.is_null() {
                instance = fmu.instance2_with(&fmu.definition.token());
                assert!(!instance.is_null(), "{:?}", LOGGED.take());
            }
            let (vr, number) = (next(count + 2) as u32, numbers[next(12) as usize]);
            let mut now = 0.0;
            let _ = fmi2GetReal(instance, &0, 1, &mut now);
            let status = match next(14) {
                0 => fmi2SetupExperiment(instance, 0, 0.0, number, 0, 0.0),
                1 => fmi2EnterInitializationMode(instance),
                2 => fmi2ExitInitializationMode(instance),
                3 if next(20) == 0 => fmi2Terminate(instance),
                4 if next(20) == 0 => fmi2Reset(instance),
                5 => fmi2SetReal(instance, &vr, 1, &number),
                6 => fmi2SetBoolean(instance, &vr, 1, &(next(3) as c_int)),
                7 => fmi2GetReal(instance, &vr, 1, &mut now),
                8 => fmi2GetFMUstate(instance, &mut kept),
                9 => fmi2SetFMUstate(instance, kept),
                10 if next(200) == 0 => {
                    fmi2FreeInstance(instance);
                    instance = null_mut();
                    OK
                }
                _ => fmi2DoStep(instance, now, numbers[next(12) as usize], 0),
            };
            statuses[status as usize] += 1;
            let lines = LOGGED.take();
            assert_eq!(lines.len(), usize::from(status == ERROR), "{lines:?}");
            assert!(lines.iter().all(|line| !line.contains("internal error")), "{lines:?}");
        }
    }
    unsafe {
        if instance.is_null() {
            instance = fmu.started2();
        }
        assert_eq!(fmi2FreeFMUstate(instance, &mut kept), OK);
        fmi2FreeInstance(instance);
    }
    assert!(
        statuses[OK as usize] > 3000 && statuses[ERROR as usize] > 1000,
        "{statuses:?}"
    );
}
