//! The controller on CAN as a tool drives it: the event mode, clocks and bus operations.

use std::ffi::{c_int, c_void};
use std::ptr::null_mut;

use oleo_controller::can::Frame;
use oleo_controller::{
    Configuration, Corners, Gauge, Inputs, Mode, Node, PlantEnd, StrutPressures, VehicleDescription,
};
use oleo_interface::tick::TICK_S;

use super::fmi3::*;
use super::handle::{ERROR, OK};
use super::tests::{LOGGED, Unpacked, logged};
use crate::ls_bus::{Identifier, NodeStatus, Operation, Setting, operations};
use crate::resources::Resources;

/// Ticks of a drive, with a few that bring a change of the valves.
const TICKS: u16 = 700;
/// Steps of a tick: a tool delivers frames between them.
const STEPS: u16 = 4;

fn fmu() -> Unpacked {
    Unpacked::of(&Resources::can_controller(VehicleDescription::default()).unwrap())
}

/// An instance and its time.
struct Bus<'a> {
    fmu: &'a Unpacked,
    instance: *mut c_void,
    time_s: f64,
}

impl<'a> Bus<'a> {
    fn new(fmu: &'a Unpacked, is_notified: bool) -> Self {
        let instance = fmu.instance3_with(true);
        assert!(!instance.is_null(), "{:?}", LOGGED.take());
        let notifications = fmu.vr("org.fmi_standard.fmi_ls_bus.Can_BusNotifications");
        unsafe {
            assert_eq!(fmi3EnterConfigurationMode(instance), OK);
            assert_eq!(
                fmi3SetBoolean(instance, &notifications, 1, &u8::from(is_notified), 1),
                OK
            );
            assert_eq!(fmi3ExitConfigurationMode(instance), OK);
            assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), OK);
            assert_eq!(fmi3ExitInitializationMode(instance), OK);
        }
        Self {
            fmu,
            instance,
            time_s: 0.0,
        }
    }

    /// In the event mode: what the node has sent, after giving it what has come. The event mode is then left.
    fn exchange(&mut self, received: &[u8]) -> Vec<u8> {
        let vr = |member: &str| self.fmu.vr(&format!("CanChannel.{member}"));
        let mut sent = Vec::new();
        unsafe {
            let mut ticks = 9;
            assert_eq!(fmi3GetClock(self.instance, &vr("Tx_Clock"), 1, &mut ticks), OK);
            if ticks != 0 {
                let (mut size, mut bytes) = (0, std::ptr::null());
                assert_eq!(
                    fmi3GetBinary(self.instance, &vr("Tx_Data"), 1, &mut size, &mut bytes, 1),
                    OK
                );
                assert!(size > 0);
                sent = std::slice::from_raw_parts(bytes, size).to_vec();
                assert_eq!(fmi3GetClock(self.instance, &vr("Tx_Clock"), 1, &mut ticks), OK);
                assert_eq!(ticks, 0, "a clock ticks once");
            }
            if !received.is_empty() {
                assert_eq!(fmi3SetClock(self.instance, &vr("Rx_Clock"), 1, &1), OK);
                let (size, bytes) = (received.len(), received.as_ptr());
                assert_eq!(fmi3SetBinary(self.instance, &vr("Rx_Data"), 1, &size, &bytes, 1), OK);
            }
            let (mut a, mut b, mut c, mut d, mut e, mut next) = (9, 9, 9, 9, 9, 9.0);
            assert_eq!(
                fmi3UpdateDiscreteStates(self.instance, &mut a, &mut b, &mut c, &mut d, &mut e, &mut next),
                OK
            );
            assert_eq!((a, b, c, d, e), (0, 0, 0, 0, 0));
            assert_eq!(fmi3EnterStepMode(self.instance), OK);
        }
        sent
    }

    /// A step; returns whether there is an event.
    fn step(&mut self, step_s: f64) -> bool {
        let (mut event, mut b, mut c, mut reached) = (9, 9, 9, 0.0);
        let status = unsafe {
            fmi3DoStep(
                self.instance,
                self.time_s,
                step_s,
                1,
                &mut event,
                &mut b,
                &mut c,
                &mut reached,
            )
        };
        assert_eq!(status, OK, "{:?}", LOGGED.take());
        assert_eq!((b, c), (0, 0), "triggered clocks do not end a step early");
        self.time_s = reached;
        event != 0
    }

    fn enter_events(&mut self) {
        assert_eq!(unsafe { fmi3EnterEventMode(self.instance) }, OK);
    }

    fn get(&self, name: &str) -> f64 {
        let mut value = f64::NAN;
        unsafe {
            let vr = self.fmu.vr(name);
            let mut word = 0;
            let mut switch = 0;
            if fmi3GetFloat64(self.instance, &vr, 1, &mut value, 1) == ERROR {
                value = if fmi3GetInt64(self.instance, &vr, 1, &mut word, 1) == OK {
                    word as f64
                } else {
                    assert_eq!(fmi3GetBoolean(self.instance, &vr, 1, &mut switch, 1), OK);
                    switch.into()
                };
            }
        }
        LOGGED.take();
        value
    }

    fn state(&self) -> *mut c_void {
        let mut kept = null_mut();
        assert_eq!(unsafe { fmi3GetFMUState(self.instance, &mut kept) }, OK);
        kept
    }
}

impl Drop for Bus<'_> {
    fn drop(&mut self) {
        unsafe { fmi3FreeInstance(self.instance) };
    }
}

fn transmit(frames: &[Frame]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for Frame { id, data } in frames {
        Operation::CanTransmit {
            id: Identifier::Standard(*id),
            remote: false,
            data,
        }
        .write(&mut bytes);
    }
    bytes
}

fn frames(bytes: &[u8]) -> Vec<Frame> {
    operations(bytes)
        .filter_map(|operation| match operation.unwrap() {
            Operation::CanTransmit {
                id: Identifier::Standard(id),
                remote: false,
                data,
            } => Some(Frame {
                id,
                data: data.try_into().unwrap(),
            }),
            _ => None,
        })
        .collect()
}

/// A vehicle that begins to roll over stones: enough to change valves.
fn readings(tick: u16) -> Inputs {
    let t = TICK_S * f64::from(tick.saturating_sub(200));
    let way =
        |phase: f64| (0.03 * libm::sin(12.0 * t + phase) + 0.01 * libm::sin(70.0 * t)) as f32 * f32::from(tick > 200);
    let displacement = Corners::from_fn(|corner| way(0.3 * corner.index() as f64));
    let pressure = displacement.map(|way| StrutPressures::splat(Gauge(2.0e6 + 1.5e7 * way)));
    Inputs::from_values(displacement, pressure)
}

/// One tick of the bus: the plant's frames before the tick, in two parts, and the node's frames after it.
fn tick(bus: &mut Bus, plant: &mut PlantEnd, tick: u16) -> Vec<Frame> {
    let sensors = plant.encode(tick, &readings(tick));
    let step_s = TICK_S / f64::from(STEPS);
    let mut fetched = Vec::new();
    for step in 0..STEPS {
        let part = match step {
            0 => &sensors[..2],
            1 => &sensors[2..],
            _ => &[][..],
        };
        if !part.is_empty() {
            if !(tick == 0 && step == 0) {
                bus.enter_events();
            }
            let sent = bus.exchange(&transmit(part));
            assert!(frames(&sent).is_empty());
        }
        if bus.step(step_s) {
            assert_eq!(step, STEPS - 1);
            bus.enter_events();
            fetched = frames(&bus.exchange(&[]));
        }
    }
    for frame in &fetched {
        plant.receive(frame.id, &frame.data);
    }
    plant.end_of_tick();
    fetched
}

/// The frames of a node without an FMU around it.
fn expected() -> Vec<Vec<Frame>> {
    let mut node = Node::new(Configuration::defender110());
    let mut plant = PlantEnd::new();
    (0..TICKS)
        .map(|tick| {
            for frame in plant.encode(tick, &readings(tick)) {
                node.receive(frame.id, &frame.data);
            }
            let (_, sent) = node.tick();
            for frame in &sent {
                plant.receive(frame.id, &frame.data);
            }
            plant.end_of_tick();
            sent.to_vec()
        })
        .collect()
}

#[test]
fn it_sends_the_frames_of_the_node_also_after_going_back_and_elsewhere() {
    let fmu = fmu();
    let expected = expected();
    let words: std::collections::BTreeSet<u8> = expected.iter().map(|sent| sent[0].data[2]).collect();
    assert!(words.len() > 2, "the valves are switched: {words:?}");
    let (mut bus, mut plant) = (Bus::new(&fmu, false), PlantEnd::new());
    for (number, expected) in (0..300).zip(&expected) {
        assert_eq!(tick(&mut bus, &mut plant, number), *expected, "tick {number}");
    }
    assert_eq!(bus.get("mode") as u8, Mode::Normal.raw());
    // A state, also one with frames that wait for their tick and decisions that were made before it.
    let (mode, heave) = (bus.get("mode"), bus.get("vertical_acceleration_m_s2"));
    assert!(heave != 0.0);
    let (mut kept, then) = (bus.state(), plant);
    for (number, expected) in (300..TICKS).zip(&expected[300..]) {
        assert_eq!(tick(&mut bus, &mut plant, number), *expected, "tick {number}");
    }
    let mut other = Bus::new(&fmu, true);
    unsafe {
        assert_eq!(fmi3SetFMUState(other.instance, kept), OK, "{:?}", LOGGED.take());
        assert_eq!(fmi3FreeFMUState(other.instance, &mut kept), OK);
    }
    other.time_s = other.get("time");
    assert_eq!(
        (other.get("mode"), other.get("vertical_acceleration_m_s2")),
        (mode, heave)
    );
    plant = then;
    for (number, expected) in (300..TICKS).zip(&expected[300..]) {
        assert_eq!(tick(&mut other, &mut plant, number), *expected, "tick {number}");
    }
}

#[test]
fn it_asks_for_its_bus_before_the_first_step() {
    let fmu = fmu();
    let mut bus = Bus::new(&fmu, true);
    let sent = bus.exchange(&[]);
    let read: Vec<_> = operations(&sent).map(Result::unwrap).collect();
    assert_eq!(read.len(), 3);
    assert_eq!(read[0], Operation::Configuration(Setting::CanBitRate(500_000)));
    assert_eq!(read[2], Operation::Status(NodeStatus::ErrorActive));
}

/// A bus that confirms nothing: three frames are on their way, four wait, and the oldest of those that wait are dropped.
#[test]
fn frames_that_are_not_confirmed_are_not_sent_again_and_again() {
    let fmu = fmu();
    let mut bus = Bus::new(&fmu, true);
    bus.exchange(&[]);
    let mut sent = Vec::new();
    for _ in 0..100 {
        if bus.step(TICK_S) {
            bus.enter_events();
            sent.extend(frames(&bus.exchange(&[])));
        }
    }
    assert_eq!(sent.len(), 3);
    assert_eq!(bus.get("frames_dropped"), 100.0 + 5.0 - 7.0);
    // One is confirmed, so that one that waits takes its place.
    let mut confirm = Vec::new();
    Operation::Confirm { id: sent[0].id.into() }.write(&mut confirm);
    bus.enter_events();
    bus.exchange(&confirm);
    assert!(bus.step(1e-4), "it is offered when the next step ends");
    bus.enter_events();
    assert_eq!(frames(&bus.exchange(&[])).len(), 1);
}

#[test]
fn what_is_wrong_is_an_error_with_one_line() {
    let fmu = fmu();
    assert!(fmu.instance3_with(false).is_null());
    assert!(logged().contains("eventModeUsed"));
    let bus = Bus::new(&fmu, false);
    let vr = |member: &str| fmu.vr(&format!("CanChannel.{member}"));
    let (size, bytes) = (70_000, [0_u8; 70_000]);
    let (mut a, mut b, mut c, mut reached) = (9, 9, 9, 0.0);
    let notifications = fmu.vr("org.fmi_standard.fmi_ls_bus.Can_BusNotifications");
    unsafe {
        let i = bus.instance;
        let cases: [(c_int, &str); 8] = [
            (
                fmi3DoStep(i, 0.0, TICK_S, 1, &mut a, &mut b, &mut c, &mut reached),
                "a step is made between the initialization mode and the end: the instance is in the event mode",
            ),
            (
                fmi3SetBinary(i, &vr("Rx_Data"), 1, &size, &bytes.as_ptr(), 1),
                "CanChannel.Rx_Data is set to 70000 bytes: at most 65536 at a time",
            ),
            (
                fmi3SetBinary(i, &vr("Tx_Data"), 1, &1, &bytes.as_ptr(), 1),
                "CanChannel.Tx_Data cannot be set: the model computes it",
            ),
            (
                fmi3SetBinary(i, &vr("Rx_Data"), 1, &1, &std::ptr::null(), 1),
                "values: the pointer is null",
            ),
            (
                fmi3SetClock(i, &vr("Tx_Clock"), 1, &1),
                "CanChannel.Tx_Clock cannot be set: the model computes it",
            ),
            (
                fmi3SetClock(i, &vr("Rx_Data"), 1, &1),
                "CanChannel.Rx_Data (value reference 1) is a binary, not a clock: use the function of its type",
            ),
            (
                fmi3SetBoolean(i, &notifications, 1, &1, 1),
                "org.fmi_standard.fmi_ls_bus.Can_BusNotifications cannot be set now: enter the configuration mode first",
            ),
            (
                fmi3EnterEventMode(i),
                "the event mode begins between the initialization mode and the end: the instance is in the event mode",
            ),
        ];
        let lines = LOGGED.take();
        assert_eq!(lines.len(), cases.len());
        for ((status, expected), line) in cases.into_iter().zip(lines) {
            assert_eq!((status, line.as_str()), (ERROR, expected));
        }
    }
}

/// Bytes and calls in any order: a status each, one line for each error, and never more than a step can bring.
#[test]
fn any_bytes_in_any_order_do_no_harm() {
    let fmu = fmu();
    let mut random: u64 = 1;
    let mut next = |below: u64| {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) % below
    };
    let bus = Bus::new(&fmu, true);
    let vr = |member: &str| fmu.vr(&format!("CanChannel.{member}"));
    let (rx_data, rx_clock, tx_data, tx_clock) = (vr("Rx_Data"), vr("Rx_Clock"), vr("Tx_Data"), vr("Tx_Clock"));
    let (mut statuses, mut kept, mut longest) = ([0_u32; 4], null_mut(), 0);
    let mut operation = Vec::new();
    for _ in 0..20_000 {
        let i = bus.instance;
        let (mut a, mut b, mut c, mut d, mut e, mut now, mut size) = (0, 0, 0, 0, 0, 0.0, 0);
        let mut bytes = std::ptr::null();
        unsafe {
            fmi3GetFloat64(i, &0, 1, &mut now, 1);
            let status = match next(14) {
                0 => fmi3EnterEventMode(i),
                1 => fmi3EnterStepMode(i),
                2 | 3 => fmi3SetClock(i, &rx_clock, 1, &(next(2) as u8)),
                4..=6 => {
                    // An operation, more often than not a right one: damaged, cut, or followed by others.
                    operation.truncate(next(80) as usize);
                    let id = [0x0A0, 0x110, 0x300][next(3) as usize];
                    match next(6) {
                        0 => operation.extend((0..next(30)).map(|_| next(256) as u8)),
                        1 => Operation::Confirm { id }.write(&mut operation),
                        2 => Operation::ArbitrationLost { id }.write(&mut operation),
                        3 => {
                            operation.clear();
                            Operation::BusError {
                                id,
                                code: crate::ls_bus::ErrorCode::Bit,
                                flag: crate::ls_bus::ErrorFlag::Primary,
                                is_sender: next(2) == 0,
                            }
                            .write(&mut operation);
                        }
                        _ => operation.extend(transmit(&[Frame {
                            id: id as u16,
                            data: [next(256) as u8; 8],
                        }])),
                    }
                    fmi3SetBinary(i, &rx_data, 1, &operation.len(), &operation.as_ptr(), 1)
                }
                7 => fmi3GetBinary(i, &tx_data, 1, &mut size, &mut bytes, 1),
                8 => fmi3GetClock(i, &tx_clock, 1, &mut a),
                9 => fmi3UpdateDiscreteStates(i, &mut a, &mut b, &mut c, &mut d, &mut e, &mut now),
                10 if next(20) == 0 => fmi3GetFMUState(i, &mut kept),
                10 if !kept.is_null() && next(20) == 0 => fmi3SetFMUState(i, kept),
                _ => fmi3DoStep(
                    i,
                    now,
                    [1e-4, 1e-3, 5e-3, 0.1, 10.0][next(5) as usize],
                    1,
                    &mut a,
                    &mut b,
                    &mut c,
                    &mut now,
                ),
            };
            longest = longest.max(size);
            statuses[status as usize] += 1;
            let lines = LOGGED.take();
            assert_eq!(lines.len(), usize::from(status == ERROR), "{lines:?}");
            assert!(lines.iter().all(|line| !line.contains("internal error")), "{lines:?}");
        }
    }
    unsafe { assert_eq!(fmi3FreeFMUState(bus.instance, &mut kept), OK) };
    LOGGED.take();
    assert!(
        statuses[OK as usize] > 8000 && statuses[ERROR as usize] > 3000,
        "{statuses:?}"
    );
    assert!((100..=1 << 16).contains(&longest), "{longest}");
}
