//! A million frames of a tool that is wrong, or means harm: the slave never panics, never sends more than the bus has room for, never
//! sends anything that is no packet, and never hands over a configuration that was not permitted.

mod common;

use std::collections::VecDeque;

use common::Pair;
use oleo_controller::Builder;
use oleo_xcp::{Budget, Slave, measurement};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Commands that lead somewhere, which random bytes hardly ever do.
fn command(random: &mut ChaCha8Rng) -> Vec<u8> {
    let small = |random: &mut ChaCha8Rng| random.random_range(0..4_u8);
    let address = |random: &mut ChaCha8Rng| {
        let base = [measurement::ADDRESS, 0x2000, 0x3000, 0, u32::MAX - 3];
        base[random.random_range(0..base.len())]
            .wrapping_add(random.random_range(0..200))
            .to_le_bytes()
    };
    let (list, odt, entry) = (small(random), small(random), small(random));
    let [a, b, c, d] = address(random);
    let mut bytes = match random.random_range(0..22_u8) {
        // What ends everything is rare, or nothing ever begins.
        0 | 1 if random.random_range(0..40) > 0 => vec![0xDD, 1],
        0 => vec![0xFF, 0],
        1 => vec![0xD6],
        2 => vec![0xD5, 0, small(random), 0],
        3 => vec![0xD4, 0, list, 0, random.random_range(0..16)],
        4 => vec![0xD3, 0, list, 0, odt, random.random_range(0..8)],
        5 | 6 => vec![0xE2, 0, list, 0, odt, entry],
        7 | 8 => vec![0xE1, 0xFF, random.random_range(1..8), 0, a, b, c, d],
        9 | 10 => vec![0xE0, 0x10 * (list & 1), list, 0, 0, 0, random.random(), 0],
        11 | 12 => vec![0xDE, small(random), list, 0],
        13 => vec![0xDD, small(random)],
        14 => vec![0xF6, 0, 0, 0, a, b, c, d],
        15 => vec![0xF5, random.random_range(0..9)],
        16 => vec![0xF4, random.random_range(0..9), 0, 0, a, b, c, d],
        17 => vec![0xF3, 0, 0, 0, random.random(), small(random), 0, 0],
        18 => {
            let value: f32 = random.random_range(-1.0..6.0);
            let [a, b, c, d] = value.to_le_bytes();
            vec![0xF0, 4, a, b, c, d]
        }
        19 => vec![[0xFD, 0xFC, 0xFB, 0xDA, 0xD9, 0xDC][random.random_range(0..6)]],
        20 => vec![0xFA, small(random)],
        _ => {
            let mut bytes = vec![0; random.random_range(0..9)];
            random.fill_bytes(&mut bytes);
            bytes
        }
    };
    // Now and then a bit is wrong, or the frame too short.
    if random.random_range(0..8) == 0 && !bytes.is_empty() {
        let at = random.random_range(0..bytes.len());
        bytes[at] ^= 1 << random.random_range(0..8);
        if random.random() {
            bytes.truncate(at);
        }
    }
    bytes
}

/// The commands by which a tool sets up its lists, right or nearly right.
fn set_up(random: &mut ChaCha8Rng) -> VecDeque<Vec<u8>> {
    let lists = random.random_range(1..5_u8);
    let odts: Vec<u8> = (0..lists).map(|_| random.random_range(1..9)).collect();
    let mut commands = VecDeque::from([vec![0xFF, 0], vec![0xD6], vec![0xD5, 0, lists, 0]]);
    commands.extend(
        (0..lists)
            .zip(&odts)
            .map(|(list, count)| vec![0xD4, 0, list, 0, *count]),
    );
    let each = |list: u8| (0..odts[usize::from(list)]).map(move |odt| (list, odt));
    commands.extend(
        (0..lists)
            .flat_map(each)
            .map(|(list, odt)| vec![0xD3, 0, list, 0, odt, 2]),
    );
    for (list, odt) in (0..lists).flat_map(each) {
        commands.push_back(vec![0xE2, 0, list, 0, odt, 0]);
        for _ in 0..2 {
            commands.push_back(vec![
                0xE1,
                0xFF,
                random.random_range(1..4),
                0,
                random.random_range(0..64),
                0x10,
                0,
                0,
            ]);
        }
    }
    for list in 0..lists {
        commands.push_back(vec![0xE0, 0x10, list, 0, 0, 0, random.random_range(2..40), 0]);
        commands.push_back(vec![0xDE, random.random_range(1..3), list, 0]);
    }
    commands
}

/// Sends so many frames; returns the numbers of answers, refusals, frames of data, and writes.
fn survive(slave: Slave, budget: Budget, frames: u32, seed: u64) -> [u32; 4] {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut pair = Pair::new(slave);
    let mut most_left_out = 0;
    let mut counts = [0; 4];
    let mut prepared = VecDeque::new();
    for _ in 0..frames {
        if random.random_range(0..300) == 0 {
            prepared = set_up(&mut random);
        }
        let next = prepared.pop_front().unwrap_or_else(|| command(&mut random));
        pair.slave.receive(&next);
        pair.writable = random.random_range(0..4) == 0;
        let sent = pair.step();
        let data = sent.iter().filter(|packet| packet[0] <= 0xFB).count();
        assert!(data <= budget.data_frames() && sent.len() <= data + 1);
        assert!(sent.iter().all(|packet| (1..=8).contains(&packet.len())));
        counts[0] += sent.iter().filter(|packet| packet[0] == 0xFF).count() as u32;
        counts[1] += sent.iter().filter(|packet| packet[0] == 0xFE).count() as u32;
        counts[2] += data as u32;
        most_left_out = most_left_out.max(pair.slave.counters().samples_left_out);
        #[cfg(feature = "calibration")]
        if pair.slave.take_changed().is_some() {
            assert!(pair.writable, "a configuration while a valve may be open");
            counts[3] += 1;
        }
    }
    println!("{most_left_out} samples found no room");
    counts
}

#[test]
fn a_million_frames_of_an_unruly_tool() {
    let budget = Budget::at(500_000);
    let slave = Slave::new(Builder::default(), budget);
    let [answers, refusals, data, writes] = survive(slave, budget, 1_000_000, 1);
    println!("{answers} answers, {refusals} refusals, {data} frames of data");
    assert!(answers > 200_000 && refusals > 200_000 && data > 10_000);
    assert_eq!(writes, 0, "this slave does not write");
}

#[cfg(feature = "calibration")]
#[test]
fn a_million_frames_where_writing_is_permitted() {
    let budget = Budget::at(1_000_000);
    let slave = Slave::new(Builder::default(), budget).writable();
    let [_, _, data, writes] = survive(slave, budget, 1_000_000, 2);
    println!("{data} frames of data, {writes} values written");
    assert!(data > 10_000 && writes > 20, "{data}, {writes}");
}
