//! `oleo.dbc` against the code, read by can-dbc: every constant, every bit, every name.
//!
//! The packer here knows nothing of the codecs: it sets bits where the database says.

use std::sync::LazyLock;

use can_dbc::{AttributeValue, ByteOrder, Dbc, Message, MessageId, NumericValue, Signal, ValueType};
use oleo_controller::can::{
    self, BOARD, BoardMessage, BusState, COMMAND, ClockSource, CommandMessage, DISPLACEMENT, DisplacementMessage,
    ImageState, MESSAGES, PRESSURE, PressureMessage, Protector, STATUS, StatusMessage, bus_load,
};
use oleo_controller::{
    Axle, Corner, FaultCode, MessageSet, Mode, PressurePoint, Reading, StrutPressures, Valve, ValveCommand,
};
use proptest::prelude::*;

/// The database, which takes long to read where nothing is optimised.
fn database() -> &'static Dbc {
    static READ: LazyLock<Dbc> =
        LazyLock::new(|| Dbc::try_from(include_str!("../oleo.dbc")).expect("can-dbc reads the database"));
    &READ
}

fn message(dbc: &Dbc, id: u16) -> &Message {
    dbc.messages
        .iter()
        .find(|m| m.id == MessageId::Standard(id))
        .expect("message in database")
}

fn signal<'a>(message: &'a Message, name: &str) -> &'a Signal {
    message
        .signals
        .iter()
        .find(|s| s.name == name)
        .unwrap_or_else(|| panic!("{} has no {name}", message.name))
}

/// Little-endian signals only, which the database is checked to have.
fn insert(frame: &mut [u8; 8], signal: &Signal, raw: i64) {
    for bit in 0..signal.size {
        let place = (signal.start_bit + bit) as usize;
        frame[place / 8] |= ((raw >> bit & 1) as u8) << (place % 8);
    }
}

fn extract(frame: &[u8; 8], signal: &Signal) -> i64 {
    let mut raw = 0i64;
    for bit in 0..signal.size {
        let place = (signal.start_bit + bit) as usize;
        raw |= i64::from(frame[place / 8] >> (place % 8) & 1) << bit;
    }
    if signal.value_type == ValueType::Signed && raw >> (signal.size - 1) & 1 == 1 {
        raw - (1 << signal.size)
    } else {
        raw
    }
}

fn physical(frame: &[u8; 8], signal: &Signal) -> f64 {
    extract(frame, signal) as f64 * signal.factor + signal.offset
}

fn number(value: &AttributeValue) -> i64 {
    match value {
        AttributeValue::Uint(n) => *n as i64,
        AttributeValue::Int(n) => *n,
        other => panic!("{other:?} is not a whole number"),
    }
}

#[test]
fn contracts_are_the_database() {
    let dbc = database();
    assert_eq!(dbc.messages.len(), MESSAGES.len());
    for contract in &MESSAGES {
        let message = message(dbc, contract.id);
        #[cfg(feature = "comparison")]
        assert_eq!(message.name, contract.name);
        assert_eq!(message.size as usize, contract.length);
        let attribute = |name| {
            dbc.message_attribute(message.id, name)
                .unwrap_or_else(|| panic!("{name}"))
        };
        assert_eq!(number(attribute("GenMsgCycleTime")), i64::from(contract.period_ms));
        assert_eq!(
            number(attribute("E2E_Profile")),
            1,
            "profile 2 is the second of the list"
        );
        assert_eq!(number(attribute("E2E_MaxDeltaCounter")), i64::from(contract.max_delta));
        assert_eq!(number(attribute("E2E_TimeoutTicks")), i64::from(contract.timeout_ticks));
        let AttributeValue::String(list) = attribute("E2E_DataIdList") else {
            panic!("a list")
        };
        let list: Vec<u8> = list.split(' ').map(|id| u8::from_str_radix(id, 16).unwrap()).collect();
        assert_eq!(list, contract.data_ids);
        assert!(dbc.message_comment(message.id).is_some());
    }
}

#[test]
fn signals_do_not_overlap_and_are_explained() {
    let dbc = database();
    for message in &dbc.messages {
        let mut taken = 0u64;
        for signal in &message.signals {
            assert_eq!(signal.byte_order, ByteOrder::LittleEndian);
            let bits = ((1u64 << signal.size) - 1) << signal.start_bit;
            assert_eq!(taken & bits, 0, "{}.{} overlaps", message.name, signal.name);
            taken |= bits;
            assert!(
                dbc.signal_comment(message.id, &signal.name).is_some(),
                "{}.{}",
                message.name,
                signal.name
            );
        }
        let crc = signal(message, "E2E_Crc");
        let counter = signal(message, "E2E_Counter");
        assert_eq!((crc.start_bit, crc.size, counter.start_bit, counter.size), (0, 8, 8, 4));
    }
}

#[test]
fn scaling_is_the_code_s() {
    let dbc = database();
    for contract in PRESSURE.values() {
        for p in &message(dbc, contract.id).signals[2..] {
            assert_eq!(
                (p.factor, p.offset),
                (f64::from(can::PRESSURE_STEP_PA), f64::from(can::PRESSURE_OFFSET_PA))
            );
            assert_eq!(p.unit, "Pa");
            let most = f64::from(can::PRESSURE_RAW_MAX) * p.factor + p.offset;
            assert_eq!(p.max, NumericValue::Uint(most as u64));
        }
    }
    for contract in DISPLACEMENT.into_array() {
        let x = signal(message(dbc, contract.id), "DisplacementLeft");
        assert_eq!((x.factor as f32, x.offset), (can::DISPLACEMENT_STEP_M, 0.0));
        assert_eq!(x.unit, "m");
    }
}

#[test]
fn value_tables_are_the_enumerations() {
    let dbc = database();
    for contract in [&COMMAND, &STATUS] {
        let id = MessageId::Standard(contract.id);
        let modes = dbc.value_descriptions_for_signal(id, "Mode").unwrap();
        for d in modes {
            assert_eq!(format!("{:?}", Mode::from_repr(d.id as u8).unwrap()), d.description);
        }
        assert_eq!(
            Mode::from_repr(modes.len() as u8),
            None,
            "a mode is missing in the database"
        );
        let faults = dbc.value_descriptions_for_signal(id, "Fault").unwrap();
        for d in faults {
            assert_eq!(
                format!("{:?}", FaultCode::from_repr(d.id as u8).unwrap()),
                d.description
            );
        }
        assert_eq!(
            FaultCode::from_repr(faults.len() as u8),
            None,
            "a fault is missing in the database"
        );
    }
}

#[test]
fn bus_load_from_the_database() {
    let dbc = database();
    let mut bits_a_second = 0.0;
    for message in &dbc.messages {
        let cycle_ms = number(dbc.message_attribute(message.id, "GenMsgCycleTime").unwrap());
        let data_bits = 8.0 * message.size as f64;
        let worst = 34.0 + data_bits + 13.0 + ((34.0 + data_bits - 1.0) / 4.0).floor();
        bits_a_second += worst * 1000.0 / cycle_ms as f64;
    }
    assert_eq!(bus_load::LOAD_500K_PERMILLE, (bits_a_second / 500.0) as u32);
    assert_eq!(bus_load::LOAD_1M_PERMILLE, (bits_a_second / 1000.0) as u32);
    println!(
        "worst case load: {:.2} % at 500 kbit/s, {:.2} % at 1 Mbit/s",
        bits_a_second / 5e3,
        bits_a_second / 1e4
    );
}

proptest! {
    #[test]
    fn pressures(raw in prop::array::uniform4(0u16..8192), corner in prop::sample::select(&Corner::ALL[..])) {
        let dbc = database();
        let message = message(dbc, PRESSURE[corner].id);
        let mut frame = [0; 8];
        let raw = StrutPressures::from_array(raw);
        let name = |point: PressurePoint| point.key().to_uppercase();
        for (point, raw) in raw.iter() {
            insert(&mut frame, signal(message, &name(point)), i64::from(*raw));
        }
        let decoded = PressureMessage::decode(&frame);
        for (point, reading) in decoded.pressure.iter() {
            prop_assert_eq!(reading.is_valid(), raw[point] <= 8189);
            if let Some(value) = reading.value() {
                prop_assert_eq!(f64::from(value), physical(&frame, signal(message, &name(point))));
            }
        }
        if raw.iter().all(|(_, &raw)| raw != 8191) {
            prop_assert_eq!(decoded.encode(), frame);
        }
    }

    #[test]
    fn displacements(tick: u8, answer: u8, left: i16, right: i16, status in 0u8..4, axle in prop::sample::select(&Axle::ALL[..])) {
        let dbc = database();
        let message = message(dbc, DISPLACEMENT[axle].id);
        let mut frame = [0; 8];
        insert(&mut frame, signal(message, "PlantTick"), i64::from(tick));
        insert(&mut frame, signal(message, "Answer"), i64::from(answer));
        insert(&mut frame, signal(message, "DisplacementLeft"), i64::from(left));
        insert(&mut frame, signal(message, "DisplacementRight"), i64::from(right));
        insert(&mut frame, signal(message, "StatusRight"), i64::from(status));
        let decoded = DisplacementMessage::decode(&frame);
        prop_assert_eq!((decoded.plant_tick, decoded.answer), (tick, answer));
        let expected = physical(&frame, signal(message, "DisplacementLeft"));
        prop_assert!((f64::from(decoded.left.value().unwrap()) - expected).abs() < 1e-7);
        prop_assert_eq!(decoded.right.is_valid(), status == 0);
        if status == 0 {
            prop_assert_eq!(decoded.encode(), frame);
        }
    }

    #[test]
    fn commands(word in 0u16..4096, echo_tick: u8, challenge: u8, mode in 0u8..5, fault in 0u8..12) {
        let dbc = database();
        let message = message(dbc, COMMAND.id);
        let sent = CommandMessage {
            command: ValveCommand::from_word(word),
            echo_tick,
            challenge,
            mode: Mode::from_repr(mode).unwrap(),
            fault: FaultCode::from_repr(fault).unwrap(),
        };
        let frame = sent.encode();
        for corner in Corner::ALL {
            for valve in Valve::ALL {
                let bit = extract(&frame, signal(message, &format!("Valve{}_{corner:?}", valve.number())));
                prop_assert_eq!(bit == 1, sent.command.is_open(corner, valve));
            }
        }
        prop_assert_eq!(extract(&frame, signal(message, "ValveWordComplement")), i64::from(!word & 0xFFF));
        prop_assert_eq!(extract(&frame, signal(message, "EchoTick")), i64::from(echo_tick));
        prop_assert_eq!(extract(&frame, signal(message, "Challenge")), i64::from(challenge));
        prop_assert_eq!(extract(&frame, signal(message, "Mode")), i64::from(mode));
        prop_assert_eq!(extract(&frame, signal(message, "Fault")), i64::from(fault));
        prop_assert_eq!(CommandMessage::decode(&frame), Some(sent));
    }

    #[test]
    fn status(mode in 0u8..5, fault in 0u8..12, handling: bool, rollover_guard: bool,
              lateral in 0u32..1024, vertical in 0u32..1024, invalid_readings in 0u8..21, lost_messages in 0u8..64) {
        let dbc = database();
        let message = message(dbc, STATUS.id);
        let sent = StatusMessage {
            mode: Mode::from_repr(mode).unwrap(),
            fault: FaultCode::from_repr(fault).unwrap(),
            handling,
            rollover_guard,
            lateral_rms_m_s2: lateral as f32 * 0.02,
            vertical_rms_m_s2: vertical as f32 * 0.02,
            invalid_readings,
            lost_messages: MessageSet::from_bits(lost_messages),
        };
        let frame = sent.encode();
        for (name, expected) in [
            ("Mode", i64::from(mode)), ("Fault", i64::from(fault)), ("Handling", i64::from(handling)),
            ("RolloverGuard", i64::from(rollover_guard)), ("LateralRms", i64::from(lateral)),
            ("VerticalRms", i64::from(vertical)), ("InvalidReadings", i64::from(invalid_readings)),
            ("LostMessages", i64::from(lost_messages)),
        ] {
            prop_assert_eq!(extract(&frame, signal(message, name)), expected, "{}", name);
        }
        prop_assert_eq!(StatusMessage::decode(&frame), Some(sent));
    }

    #[test]
    fn board(reset_causes in 0u8..128, clock in 0u8..3, brown_out_level in 0u8..4, latch_kept: bool, image in 0u8..2, bus in 0u8..4,
             overruns: u8, bus_off: u8, port_errors: u8, port_dropped: u8) {
        let dbc = database();
        let message = message(dbc, BOARD.id);
        let sent = BoardMessage {
            reset_causes,
            clock: ClockSource::from_repr(clock).unwrap(),
            brown_out_level,
            latch_kept,
            image: ImageState::from_repr(image).unwrap(),
            bus: BusState::from_repr(bus).unwrap(),
            overruns,
            bus_off,
            port_errors,
            port_dropped,
        };
        let frame = sent.encode();
        let causes = ["BrownOut", "Pin", "Supply", "Software", "Watchdog", "WindowWatchdog", "LowPower"];
        for (bit, cause) in causes.into_iter().enumerate() {
            let expected = i64::from(reset_causes >> bit & 1);
            prop_assert_eq!(extract(&frame, signal(message, &format!("ResetBy{cause}"))), expected, "{}", cause);
        }
        for (name, expected) in [
            ("Clock", clock), ("BrownOutLevel", brown_out_level), ("LatchKept", latch_kept.into()), ("Image", image),
            ("BusState", bus), ("Overruns", overruns), ("BusOff", bus_off), ("PortErrors", port_errors),
            ("PortDropped", port_dropped),
        ] {
            prop_assert_eq!(extract(&frame, signal(message, name)), i64::from(expected), "{}", name);
        }
        prop_assert_eq!(BoardMessage::decode(&frame), Some(sent));
    }

    /// What is out of a signal's range is sent as an error, never clipped.
    #[test]
    fn out_of_range_is_an_error(value in prop::num::f32::ANY) {
        let sent = PressureMessage { pressure: StrutPressures::splat(Reading::new(value)) };
        let p = PressureMessage::decode(&sent.encode()).pressure.p1;
        prop_assert_eq!(p.is_valid(), value.is_finite() && (-5_002_500.0..=35_947_500.0).contains(&value));
        if let Some(p) = p.value() {
            prop_assert!((p - value).abs() <= 2_501.0);
        }
        let both = DisplacementMessage { plant_tick: 0, answer: 0, left: Reading::new(value), right: Reading::new(value) };
        let x = DisplacementMessage::decode(&both.encode()).left;
        prop_assert!(!x.is_valid() || (x.value().unwrap() - value).abs() <= 5.1e-6);
        prop_assert!(x.is_valid() || !value.is_finite() || value.abs() > 0.3276);
    }

    /// Any eight bytes are decoded without a panic, and only what was sealed passes.
    #[test]
    fn any_bytes(bytes: [u8; 8]) {
        PressureMessage::decode(&bytes);
        DisplacementMessage::decode(&bytes);
        let _ = (CommandMessage::decode(&bytes), StatusMessage::decode(&bytes));
    }
}

#[test]
fn a_reserved_valve_word_is_refused() {
    let mut frame = CommandMessage::default().encode();
    Protector::new(&COMMAND).protect(&mut frame);
    assert!(CommandMessage::decode(&frame).is_some());
    frame[2] ^= 1;
    assert_eq!(CommandMessage::decode(&frame), None);
}
