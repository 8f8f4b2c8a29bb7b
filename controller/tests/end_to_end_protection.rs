//! Profile 2 against independently computed vectors, and the receiver's rules as sequences.

use oleo_controller::Corner;
use oleo_controller::can::{CheckStatus, Checker, Contract, PRESSURE, Protector};

/// The message that the tests send.
const MESSAGE: Contract = PRESSURE.as_array()[Corner::FrontLeft.index()];

/// The data ids of the examples in AUTOSAR's protocol specification: 1 to 16.
fn example_contract() -> Contract {
    Contract {
        data_ids: core::array::from_fn(|i| i as u8 + 1),
        ..MESSAGE
    }
}

/// Computed by the Python package `autosar-e2e` 1.0.0, an independent implementation: `e2e_p02_protect(data, bytes(range(1, 17)))` on eight
/// zero bytes with counters 1 and 2. The first (0x1B) is *recalled* to be the protocol specification's own example.
#[test]
fn independent_vectors() {
    let mut protector = Protector::new(&example_contract());
    for expected in [0x1B, 0x98] {
        let mut data = [0; 8];
        protector.protect(&mut data);
        assert_eq!(data[0], expected);
    }
}

fn frames(n: usize) -> Vec<[u8; 8]> {
    let mut protector = Protector::new(&MESSAGE);
    (0..n)
        .map(|i| {
            let mut data = [0, 0x50, i as u8, 3, 4, 5, 6, 7];
            protector.protect(&mut data);
            data
        })
        .collect()
}

fn statuses(received: &[usize]) -> Vec<CheckStatus> {
    let frames = frames(64);
    let mut checker = Checker::new(&MESSAGE);
    received.iter().map(|&i| checker.check(&frames[i])).collect()
}

#[test]
fn sequences() {
    use CheckStatus::{Initial, Ok, OkSomeLost, Repeated, Sync, WrongSequence};
    for (received, expected) in [
        (vec![0, 1, 2, 3], vec![Initial, Ok, Ok, Ok]),
        (vec![0, 1, 3, 6], vec![Initial, Ok, OkSomeLost, OkSomeLost]),
        (vec![0, 1, 1, 2], vec![Initial, Ok, Repeated, Ok]),
        (vec![0, 1, 5, 6, 7, 8], vec![Initial, Ok, WrongSequence, Sync, Sync, Ok]),
        (vec![5, 6, 5, 6, 7, 8], vec![Initial, Ok, WrongSequence, Sync, Sync, Ok]), // played back
        (vec![14, 15, 16, 17], vec![Initial, Ok, Ok, Ok]),                          // counter wraps
    ] {
        assert_eq!(statuses(&received), expected, "{received:?}");
    }
}

#[test]
fn after_a_silence_the_counter_may_be_further_but_must_prove_itself() {
    let frames = frames(32);
    let mut checker = Checker::new(&MESSAGE);
    checker.check(&frames[0]);
    checker.check(&frames[1]);
    for _ in 0..2 {
        checker.no_new_data();
    }
    assert_eq!(checker.check(&frames[4]), CheckStatus::OkSomeLost, "two lost");
    for _ in 0..9 {
        checker.no_new_data();
    }
    assert_eq!(checker.check(&frames[14]), CheckStatus::Sync);
    assert_eq!(checker.check(&frames[15]), CheckStatus::Sync);
    assert_eq!(checker.check(&frames[16]), CheckStatus::Ok);
}

#[test]
fn another_message_s_frame_fails() {
    let frames = frames(16);
    for other in PRESSURE.values().filter(|contract| **contract != MESSAGE) {
        for frame in &frames {
            assert_eq!(Checker::new(other).check(frame), CheckStatus::WrongCrc);
        }
    }
}

/// Outside the counter, up to three flipped bits are always seen (CRC8H2F has Hamming distance 4 at this length: Koopman); every case tried.
#[test]
fn up_to_three_flipped_bits_are_seen() {
    let frame = frames(1)[0];
    let bits: Vec<u64> = (0..64)
        .filter(|bit| !(8..12).contains(bit))
        .map(|bit| 1 << bit)
        .collect();
    let sealed = u64::from_le_bytes(frame);
    let seen = |flips: u64| {
        let status = Checker::new(&MESSAGE).check(&(sealed ^ flips).to_le_bytes());
        assert_eq!(status, CheckStatus::WrongCrc, "{flips:#x}");
    };
    for (i, a) in bits.iter().enumerate() {
        seen(*a);
        for (j, b) in bits.iter().enumerate().skip(i + 1) {
            seen(a | b);
            for c in &bits[j + 1..] {
                seen(a | b | c);
            }
        }
    }
}

/// A flipped counter also selects another data id, so these count as more than one error; all of them are seen.
#[test]
fn a_wrong_counter_is_seen() {
    for frame in frames(16) {
        for counter in 1..16 {
            let mut wrong = frame;
            wrong[1] ^= counter;
            assert_eq!(Checker::new(&MESSAGE).check(&wrong), CheckStatus::WrongCrc);
        }
    }
}
