//! Sessions as a tool holds them, byte by byte as the specification says.

mod common;

use common::{Pair, address_of};
use oleo_controller::{Builder, Mode, ValveCommand};
use oleo_xcp::{Budget, Slave, identity, measurement};

#[test]
fn nothing_is_answered_before_connect_and_after_disconnect() {
    let mut pair = Pair::new(Slave::new(Builder::default(), Budget::at(500_000)));
    assert_eq!(pair.command(&[0xFD]), None);
    assert_eq!(pair.command(&[0xFF, 1]), None, "a mode of connection that is not there");
    pair.ok(&[0xFF, 0]);
    assert!(pair.slave.is_connected());
    assert_eq!(pair.ok(&[0xFD]), [0xFF, 0, 0, 0, 0, 0]);
    pair.ok(&[0xFE]);
    assert!(!pair.slave.is_connected());
    assert_eq!(pair.command(&[0xFD]), None);
}

#[test]
fn it_says_who_it_is() {
    let mut pair = Pair::connected();
    let answer = pair.ok(&[0xFA, 0]);
    let length = u32::from_le_bytes(answer[4..8].try_into().unwrap());
    let mut text = Vec::new();
    while text.len() < length as usize {
        let count = (length as usize - text.len()).min(7) as u8;
        text.extend_from_slice(&pair.ok(&[0xF5, count])[1..]);
    }
    assert_eq!(String::from_utf8(text).unwrap(), identity().as_str());
    assert_eq!(pair.ok(&[0xFA, 1])[4], 4);
    assert_eq!(&pair.ok(&[0xF5, 4])[1..], b"oleo");
    assert_eq!(
        pair.ok(&[0xFA, 4]),
        [0xFF, 0, 0, 0, 0, 0, 0, 0],
        "there is no file to upload"
    );
    assert_eq!(pair.ok(&[0xFB]).len(), 8);
    assert_eq!(pair.refusal(&[0xFC]), 0x00, "SYNCH");
}

#[test]
fn measured_values_are_those_of_the_last_tick() {
    let mut pair = Pair::connected();
    pair.outputs.mode = Mode::Safe;
    pair.outputs.command = ValveCommand::from_word(0x0ABC);
    assert_eq!(pair.upload(address_of("mode"), 1), [3]);
    assert_eq!(pair.upload(address_of("valve_word"), 2), [0xBC, 0x0A]);
    assert_eq!(
        pair.upload(address_of("displacement_rear_left_m"), 4),
        0.01_f32.to_le_bytes()
    );
    assert_eq!(
        pair.refusal(&[0xF4, 4, 0, 0, 0, 0, 0, 0]),
        0x24,
        "nothing is at address 0"
    );
    assert_eq!(
        pair.refusal(&[0xF4, 1, 0, 1, 0, 0x10, 0, 0]),
        0x22,
        "there is no other extension"
    );
    assert_eq!(pair.refusal(&[0xF4, 8, 0, 0, 0, 0x10, 0, 0]), 0x22, "more than a frame");
    assert_eq!(pair.refusal(&[0xF4, 1]), 0x21, "too short");
    assert_eq!(pair.refusal(&[0x42]), 0x20);
}

#[test]
fn a_checksum_names_the_largest_block() {
    let mut pair = Pair::connected();
    pair.ok(&[0xF6, 0, 0, 0, 0, 0x20, 0, 0]);
    let answer = pair.ok(&[0xF3, 0, 0, 0, 64, 0, 0, 0]);
    assert_eq!(answer[1], 9, "CRC-32");
    let answer = pair.command(&[0xF3, 0, 0, 0, 0, 0, 1, 0]).unwrap();
    assert_eq!(answer, [0xFE, 0x22, 0, 0, 0, 4, 0, 0]);
}

#[test]
fn a_list_is_sent_every_tick_with_its_time() {
    let mut pair = Pair::connected();
    let (word, mode, roll) = (address_of("valve_word"), address_of("mode"), address_of("roll_rad"));
    pair.select_list(&[&[(word, 2), (mode, 1)], &[(roll, 4)]], true, 1);
    pair.ok(&[0xDD, 1]);
    assert_eq!(pair.ok(&[0xFD])[1], 0x40, "a list runs");
    pair.data.clear();
    for n in 0..100_u16 {
        pair.outputs.command = ValveCommand::from_word(n);
        pair.outputs.estimate.roll_rad = f32::from(n) * 0.5;
        let tick = pair.tick as u16;
        let frames = pair.step();
        let [low, high] = tick.to_le_bytes();
        let [a, b] = n.to_le_bytes();
        assert_eq!(frames[0], [0, low, high, a, b, 0]);
        assert_eq!(
            (frames[1][0], frames[1][1..].to_vec()),
            (1, (f32::from(n) * 0.5).to_le_bytes().to_vec())
        );
        assert_eq!(frames.len(), 2);
    }
    pair.ok(&[0xDD, 0]);
    assert!(pair.step().is_empty());
    assert_eq!(pair.slave.counters().samples_left_out, 0);
}

#[test]
fn lists_that_the_bus_has_no_room_for_do_not_start() {
    let mut pair = Pair::connected();
    let roll: &[(u32, u8)] = &[(address_of("roll_rad"), 4)];
    pair.select_list(&[roll, roll, roll], false, 1);
    assert_eq!(pair.refusal(&[0xDD, 1]), 0x2A, "three frames a tick, of two");
    pair.ok(&[0xE0, 0, 0, 0, 0, 0, 2, 0]);
    pair.ok(&[0xDE, 2, 0, 0]);
    pair.ok(&[0xDD, 1]);
    pair.data.clear();
    let sent: Vec<usize> = (0..50).map(|_| pair.step().len()).collect();
    assert!(sent.iter().all(|frames| *frames <= 2), "{sent:?}");
    assert_eq!(sent.iter().sum::<usize>(), 75);
    assert_eq!(pair.slave.counters().samples_left_out, 0);
}

#[test]
fn a_frame_that_is_too_long_for_its_time_stamp_does_not_start() {
    let mut pair = Pair::connected();
    let full: &[(u32, u8)] = &[(measurement::ADDRESS, 7)];
    pair.select_list(&[full], true, 1);
    assert_eq!(pair.refusal(&[0xDD, 1]), 0x2A);
    pair.ok(&[0xE0, 0, 0, 0, 0, 0, 1, 0]);
    pair.ok(&[0xDE, 1, 0, 0]);
    assert_eq!(pair.step()[0].len(), 8);
}

#[test]
fn allocation_has_an_order_and_an_end() {
    let mut pair = Pair::connected();
    assert_eq!(pair.refusal(&[0xD4, 0, 0, 0, 1]), 0x29, "ODTs before lists");
    pair.ok(&[0xD6]);
    assert_eq!(pair.refusal(&[0xD5, 0, 9, 0]), 0x30, "nine lists");
    pair.ok(&[0xD5, 0, 2, 0]);
    assert_eq!(pair.refusal(&[0xD4, 0, 0, 0, 33]), 0x30, "more ODTs than there are");
    pair.ok(&[0xD4, 0, 0, 0, 1]);
    assert_eq!(pair.refusal(&[0xD4, 0, 2, 0, 1]), 0x22, "a list that is not there");
    pair.ok(&[0xD4, 0, 1, 0, 1]);
    assert_eq!(pair.refusal(&[0xD3, 0, 0, 0, 0, 8]), 0x22);
    pair.ok(&[0xD3, 0, 0, 0, 0, 1]);
    assert_eq!(pair.refusal(&[0xE1, 0xFF, 1, 0, 0, 0x10, 0, 0]), 0x22, "no pointer yet");
    pair.ok(&[0xE2, 0, 0, 0, 0, 0]);
    assert_eq!(pair.refusal(&[0xE1, 0xFF, 1, 0, 0, 0, 0, 0]), 0x24, "nothing is there");
    assert_eq!(pair.refusal(&[0xE1, 3, 1, 0, 0, 0x10, 0, 0]), 0x22, "a single bit");
    pair.ok(&[0xE1, 0xFF, 1, 0, 0, 0x10, 0, 0]);
    assert_eq!(
        pair.refusal(&[0xE1, 0xFF, 1, 0, 0, 0x10, 0, 0]),
        0x22,
        "beyond the last entry"
    );
    assert_eq!(pair.refusal(&[0xDE, 1, 0, 0]), 0x29, "no event yet");
    assert_eq!(pair.refusal(&[0xE0, 2, 0, 0, 0, 0, 1, 0]), 0x27, "stimulation");
    assert_eq!(
        pair.refusal(&[0xE0, 0, 0, 0, 1, 0, 1, 0]),
        0x22,
        "an event that is not there"
    );
    assert_eq!(pair.refusal(&[0xE0, 0, 0, 0, 0, 0, 0, 0]), 0x22, "no prescaler");
    pair.ok(&[0xE0, 0, 0, 0, 0, 0, 1, 0]);
    pair.ok(&[0xDE, 1, 0, 0]);
    assert_eq!(pair.refusal(&[0xD5, 0, 1, 0]), 0x11, "while a list runs");
    assert_eq!(pair.refusal(&[0xE2, 0, 0, 0, 0, 0]), 0x11);
}

#[test]
fn it_describes_its_lists_and_its_clock() {
    let mut pair = Pair::connected();
    assert_eq!(pair.ok(&[0xDA]), [0xFF, 0x13, 8, 0, 1, 0, 0, 0]);
    assert_eq!(pair.ok(&[0xD9]), [0xFF, 1, 7, 1, 0, 0x62, 5, 0]);
    assert_eq!(pair.ok(&[0xD7, 0, 0, 0]), [0xFF, 0x84, 8, 4, 5, 6, 0]);
    assert_eq!(&pair.ok(&[0xF5, 4])[1..], b"tick");
    assert_eq!(pair.refusal(&[0xD7, 0, 1, 0]), 0x22);
    let tick = pair.tick;
    assert_eq!(pair.ok(&[0xDC])[4..], tick.to_le_bytes());
}

#[test]
fn a_command_that_does_not_wait_for_its_answer_is_left_out() {
    let mut pair = Pair::connected();
    pair.slave.receive(&[0xFD]);
    pair.slave.receive(&[0xFC]);
    assert_eq!(pair.step(), [[0xFF, 0, 0, 0, 0, 0]]);
    assert!(pair.step().is_empty());
    assert_eq!(pair.slave.counters().commands_left_out, 1);
}

#[test]
fn a_restart_disconnects() {
    let mut pair = Pair::connected();
    pair.slave.restart();
    assert_eq!(pair.command(&[0xFD]), None);
}

#[test]
fn without_write_access_every_write_is_refused() {
    let mut pair = Pair::connected();
    pair.writable = true;
    pair.ok(&[0xF6, 0, 0, 0, 0, 0x20, 0, 0]);
    assert_eq!(pair.refusal(&[0xF0, 4, 0, 0, 0x80, 0x3F]), 0x23);
    assert_eq!(pair.ok(&[0xFF, 0])[1], 0x04, "and is not offered");
}
