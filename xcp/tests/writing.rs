//! What a tool may write, in the build that permits it.
#![cfg(feature = "calibration")]

mod common;

use common::Pair;
use oleo_controller::Builder;
use oleo_xcp::{Budget, Slave, calibration};

fn writable() -> Pair {
    let mut pair = Pair::new(Slave::new(Builder::default(), Budget::at(500_000)).writable());
    assert_eq!(pair.ok(&[0xFF, 0])[1], 0x05, "calibration and measurement");
    pair.writable = true;
    pair
}

fn write(pair: &mut Pair, name: &str, value: f32) -> Result<(), u8> {
    let [a, b, c, d] = address_of(name).to_le_bytes();
    pair.ok(&[0xF6, 0, 0, 0, a, b, c, d]);
    let [a, b, c, d] = value.to_le_bytes();
    let answer = pair.command(&[0xF0, 4, a, b, c, d]).unwrap();
    if answer[0] == 0xFF { Ok(()) } else { Err(answer[1]) }
}

fn address_of(name: &str) -> u32 {
    calibration::quantities()
        .find(|quantity| quantity.name == name)
        .unwrap()
        .address
}

const SHIFT: &str = "tuning.spring.trapped_shift_m";
const ROUGH: &str = "tuning.strategy.road_and_cornering.rough_m_s2";

#[test]
fn a_permitted_value_becomes_the_configuration_that_a_file_would_make() {
    let mut pair = writable();
    assert_eq!(write(&mut pair, SHIFT, 0.011), Ok(()));
    let mut builder = Builder::default();
    builder.tuning.spring.trapped_shift_m = 0.011;
    assert_eq!(pair.slave.take_changed(), Some(builder.build().unwrap()));
    assert_eq!(pair.slave.take_changed(), None);
    assert_eq!(pair.upload(address_of(SHIFT), 4), 0.011_f32.to_le_bytes());
    assert_eq!(pair.slave.counters().written, 1);
}

#[test]
fn a_value_outside_of_its_range_changes_nothing() {
    let mut pair = writable();
    for value in [0.2, -0.01, f32::NAN, f32::INFINITY] {
        assert_eq!(write(&mut pair, SHIFT, value), Err(0x22), "{value}");
        assert_eq!(pair.slave.take_changed(), None);
    }
    assert_eq!(pair.upload(address_of(SHIFT), 4), 0.008_f32.to_le_bytes());
}

#[test]
fn two_thresholds_stay_in_order() {
    let mut pair = writable();
    let (begin, end) = (format!("{ROUGH}.begin"), format!("{ROUGH}.end"));
    assert_eq!(write(&mut pair, &end, 0.3), Err(0x22), "above the other");
    assert_eq!(write(&mut pair, &begin, 0.5), Ok(()));
    assert_eq!(write(&mut pair, &end, 0.3), Ok(()));
}

#[test]
fn nothing_is_written_while_a_valve_may_be_open() {
    let mut pair = writable();
    pair.writable = false;
    assert_eq!(write(&mut pair, SHIFT, 0.01), Err(0x33));
    pair.writable = true;
    assert_eq!(write(&mut pair, SHIFT, 0.01), Ok(()));
}

#[test]
fn only_whole_parameters_are_written() {
    let mut pair = writable();
    for (address, count) in [
        (0x2001_u32, 4_u8),
        (0x2000, 3),
        (0x2000, 5),
        (0x1000, 4),
        (0x3000, 4),
        (calibration::ADDRESS + calibration::BYTES as u32, 4),
        (0, 4),
    ] {
        let [a, b, c, d] = address.to_le_bytes();
        pair.ok(&[0xF6, 0, 0, 0, a, b, c, d]);
        assert_eq!(
            pair.refusal(&[0xF0, count, 0, 0, 0x80, 0x3F, 0, 0]),
            0x24,
            "{address:#x}, {count} bytes"
        );
    }
    pair.ok(&[0xF6, 0, 0, 0, 0, 0x20, 0, 0]);
    assert_eq!(pair.refusal(&[0xF0, 6, 0, 0]), 0x21, "fewer bytes than it says");
}
