//! Computes how a traced run would look on a CAN wire: bits, arbitration, latency and utilisation.
//!
//! The buses of this crate deliver at once. A CAN wire sends one frame at a time, lowest identifier first, with a stuff bit after
//! every five equal bits. This computes from the trace when each frame would have ended at a given bit rate.
//!
//! The bit sequence is that of ISO 11898-1 (SOF, identifier, RTR, IDE, r0, DLC, data, CRC-15: stuffed; then CRC delimiter, ACK,
//! ACK delimiter, EOF and interframe space: 13 bits more). The bound on latency is the sufficient response-time test of
//! Davis, Burns, Bril & Lukkien, "Controller Area Network (CAN) schedulability analysis: refuted, revisited and revised",
//! Real-Time Systems 35 (2007), equation 14: `w = max(B, C_m) + sum over higher priorities of ceil((w + tau) / T_k) C_k`.

use crc::{CRC_15_CAN, Crc};
use oleo_controller::can::bus_load::worst_case_bits;
use oleo_controller::can::{Contract, MESSAGES};

use crate::bus::{Direction, TraceEntry};
use crate::{Frame, imu};

/// x^15+x^14+x^10+x^8+x^7+x^4+x^3+1.
const CRC: Crc<u16> = Crc::<u16>::new(&CRC_15_CAN);

/// Bits after the stuffed part: CRC delimiter, ACK slot, ACK delimiter, 7 EOF, 3 interframe space.
const UNSTUFFED_BITS: u32 = 13;

/// Length of a frame on the wire, bit times: exact, stuff bits included, with the interframe space.
pub fn wire_bits(frame: &Frame) -> u32 {
    let mut stream = BitStream::default();
    let (id, dlc) = (u64::from(frame.raw_id()), frame.dlc() as u64);
    let remote = u64::from(frame.is_remote());
    if frame.is_extended() {
        // SOF, identifier, SRR and IDE recessive, rest of the identifier, RTR, r1 and r0, DLC.
        let header = id >> 18 << 27 | 0b11 << 25 | (id & 0x3_FFFF) << 7 | remote << 6 | dlc;
        stream.push(header, 39);
    } else {
        // SOF, identifier, RTR, IDE and r0, DLC.
        stream.push(id << 7 | remote << 6 | dlc, 19);
    }
    let data = frame.data();
    let value = data.iter().fold(0, |value, byte| value << 8 | u64::from(*byte));
    stream.push(value, 8 * data.len() as u32);
    stream.push(u64::from(stream.crc()), 15);
    stream.count + stream.stuff_bits() + UNSTUFFED_BITS
}

/// The stuffed part of a frame, at most 118 bits, the last one sent in the lowest place.
#[derive(Clone, Copy, Default)]
struct BitStream {
    bits: u128,
    count: u32,
}

impl BitStream {
    fn push(&mut self, value: u64, count: u32) {
        self.bits = self.bits << count | u128::from(value);
        self.count += count;
    }

    /// CRC of the bits so far. Zeros before them change nothing, since it begins with zero: whole bytes are taken.
    fn crc(self) -> u16 {
        let unused = 16 - self.count.div_ceil(8) as usize;
        CRC.checksum(&self.bits.to_be_bytes()[unused..])
    }

    /// Number of stuff bits: one of the other value after every five equal bits, of which an earlier stuff bit can be the first.
    fn stuff_bits(self) -> u32 {
        // The first bit sent in the highest place; a bit is set where it and the bit after it are equal.
        let bits = self.bits << (u128::BITS - self.count);
        let equal = !(bits ^ bits << 1);
        let four = equal & equal << 1 & equal << 2;
        // Four equal pairs end within the bits if they begin no later than this.
        let five = four & equal << 3 & !(u128::MAX >> self.count.saturating_sub(4));
        let bit = |place: u32| bits << place >> (u128::BITS - 1);
        let (mut stuffed, mut from, mut inserted) = (0, 0, None);
        while from < self.count {
            let with_inserted = from + 4 <= self.count && four << from >> (u128::BITS - 1) == 1;
            let last = if with_inserted && inserted == Some(bit(from)) {
                from + 3
            } else {
                let next = five & u128::MAX >> from;
                if next == 0 {
                    break;
                }
                next.leading_zeros() + 4
            };
            stuffed += 1;
            inserted = Some(1 - bit(last));
            from = last + 1;
        }
        stuffed
    }
}

/// Latency of one message at one bit rate, from ready to sent, microseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MessageTiming {
    /// The message whose latency this is.
    pub contract: Contract,
    /// Number of frames that were sent.
    pub frames: u64,
    /// Mean latency from ready to sent, microseconds.
    pub mean_us: f64,
    /// Longest latency that occurred, microseconds.
    pub max_us: f64,
    /// Longest possible latency with all messages of the database and worst-case stuffing, microseconds (see the module).
    pub bound_us: f64,
}

/// A traced run on a wire of a given bit rate.
#[derive(Clone, Debug, PartialEq)]
pub struct WireModel {
    /// Bit rate of the wire, bit/s.
    pub bit_rate: u32,
    /// Fraction of time for which the wire is busy, 0 to 1, with the stuff bits that occurred.
    pub utilisation: f64,
    /// The same fraction in the busiest tick.
    pub peak_utilisation: f64,
    /// Latency of each message of the database.
    pub messages: Vec<MessageTiming>,
    /// Time at which each frame of the trace ends, microseconds since the start of the run, in the order of the trace.
    pub end_us: Vec<u64>,
}

/// A frame of a trace when its turn has come.
#[derive(Clone, Copy, Debug)]
struct Turn {
    tick: u32,
    direction: Direction,
    /// Place in the trace.
    index: usize,
    bits: u32,
    /// Place among the messages on the bus.
    message: Option<usize>,
}

/// The frames of a trace in the order in which a wire sends them, which is the same at every rate.
#[derive(Clone, Debug)]
pub struct SendingOrder {
    turns: Vec<Turn>,
    on_bus: Vec<Contract>,
}

impl SendingOrder {
    /// The plant's frames of a tick come first, then the controller's, and among these the lowest identifier. `trace` must be in the order of
    /// ticks.
    pub fn of(trace: &[TraceEntry]) -> Self {
        let on_bus = contracts(trace);
        let mut turns = Vec::with_capacity(trace.len());
        let mut begin = 0;
        for group in trace.chunk_by(|a, b| a.tick == b.tick) {
            for direction in [Direction::Sent, Direction::Received] {
                let from = turns.len();
                let going = group
                    .iter()
                    .enumerate()
                    .filter(|(_, entry)| entry.direction == direction);
                turns.extend(going.map(|(i, entry)| Turn {
                    tick: entry.tick,
                    direction,
                    index: begin + i,
                    bits: wire_bits(&entry.frame),
                    message: (on_bus.iter()).position(|contract| Some(contract.id) == entry.frame.standard_id()),
                }));
                turns[from..].sort_by_key(|turn| arbitration_key(&trace[turn.index].frame));
            }
            begin += group.len();
        }
        Self { turns, on_bus }
    }
}

impl WireModel {
    /// Sends a trace over a wire. The plant's frames are ready when their tick begins, the controller's when the last of the
    /// plant's has arrived.
    pub fn of(order: &SendingOrder, bit_rate: u32, tick_us: u32, ticks: u32) -> Self {
        let bit_us = 1e6 / f64::from(bit_rate);
        let SendingOrder { turns, on_bus } = order;
        let mut end_us = vec![0; turns.len()];
        let of_contract = |contract: &Contract| {
            let bound_us = response_bound_bits(contract, on_bus, bit_rate).map_or(f64::INFINITY, |bits| bits * bit_us);
            MessageTiming {
                contract: *contract,
                frames: 0,
                mean_us: 0.0,
                max_us: 0.0,
                bound_us,
            }
        };
        let mut timing: Vec<MessageTiming> = on_bus.iter().map(of_contract).collect();
        let (mut free_us, mut busy_us, mut peak_us) = (0.0f64, 0.0, 0.0f64);
        for in_tick in turns.chunk_by(|a, b| a.tick == b.tick) {
            let tick = in_tick.first().map_or(0, |turn| turn.tick);
            let mut ready_us = f64::from(tick) * f64::from(tick_us);
            free_us = free_us.max(ready_us);
            let mut busy_in_tick_us = 0.0;
            for going in in_tick.chunk_by(|a, b| a.direction == b.direction) {
                if going.first().is_some_and(|turn| turn.direction == Direction::Received) {
                    ready_us = free_us;
                }
                for turn in going {
                    let length_us = f64::from(turn.bits) * bit_us;
                    free_us += length_us;
                    busy_in_tick_us += length_us;
                    end_us[turn.index] = free_us as u64;
                    if let Some(message) = turn.message {
                        let (message, latency_us) = (&mut timing[message], free_us - ready_us);
                        message.frames += 1;
                        message.mean_us += latency_us;
                        message.max_us = message.max_us.max(latency_us);
                    }
                }
            }
            busy_us += busy_in_tick_us;
            peak_us = peak_us.max(busy_in_tick_us);
        }
        for message in &mut timing {
            message.mean_us /= message.frames.max(1) as f64;
        }
        Self {
            bit_rate,
            utilisation: busy_us / (f64::from(ticks.max(1)) * f64::from(tick_us)),
            peak_utilisation: peak_us / f64::from(tick_us),
            messages: timing,
            end_us,
        }
    }
}

/// The messages of the suspension, and those of an inertial unit where one sends.
fn contracts(trace: &[TraceEntry]) -> Vec<Contract> {
    let of_unit =
        |entry: &TraceEntry| entry.direction == Direction::Sent && imu::of_unit(entry.frame.standard_id()).is_some();
    let unit: &[Contract] = if trace.iter().any(of_unit) { &imu::MESSAGES } else { &[] };
    MESSAGES.iter().chain(unit).copied().collect()
}

/// Order of arbitration: the dominant bit wins, and a standard frame wins against an extended one with the same first 11 bits.
fn arbitration_key(frame: &Frame) -> (u32, bool, u32) {
    let id = frame.raw_id();
    if frame.is_extended() {
        (id >> 18, true, id)
    } else {
        (id, false, 0)
    }
}

/// Longest response of a message in bit times; `None` if it does not converge within its period.
fn response_bound_bits(message: &Contract, on_bus: &[Contract], bit_rate: u32) -> Option<f64> {
    let length = |m: &Contract| f64::from(worst_case_bits(m.length));
    let period = |m: &Contract| f64::from(m.period_ms) * 1e-3 * f64::from(bit_rate);
    let blocking = on_bus
        .iter()
        .filter(|m| m.id > message.id)
        .map(length)
        .fold(length(message), f64::max);
    let mut waiting = blocking;
    loop {
        let interference: f64 = on_bus
            .iter()
            .filter(|m| m.id < message.id)
            .map(|m| ((waiting + 1.0) / period(m)).ceil() * length(m))
            .sum();
        let next = blocking + interference;
        if next + length(message) > period(message) {
            return None;
        }
        if next == waiting {
            return Some(next + length(message));
        }
        waiting = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{extended, standard, tests::any_frame};
    use proptest::prelude::*;

    #[test]
    fn published_lengths() {
        // Without any stuff bit: 1+11+1+2+4+64+15+13 = 111 and with 29 bits 131 bit times.
        let plain = Frame::whole(standard(0x555), [0x55; 8]);
        let stuffed = |frame: &Frame| wire_bits(frame) - 13;
        assert!((98..=103).contains(&stuffed(&plain)), "{}", stuffed(&plain));
        let wide = Frame::whole(extended(0x1555_5555), [0x55; 8]);
        assert!((118..=124).contains(&stuffed(&wide)), "{}", stuffed(&wide));
        // All zero: a stuff bit after five, then after each further four of the same.
        let zeros = Frame::whole(standard(0), [0; 8]);
        assert!(wire_bits(&zeros) > 111 + 12);
    }

    #[test]
    fn crc_of_a_known_frame() {
        // CRC-15/CAN of reveng's catalogue: check value of "123456789" is 0x059E.
        let mut stream = BitStream::default();
        b"123456789".iter().for_each(|byte| stream.push(u64::from(*byte), 8));
        assert_eq!(stream.crc(), 0x059E);
    }

    /// CRC and stuff bits of bits that are sent one after the other, as the standard describes it.
    fn one_by_one(stream: BitStream) -> (u16, u32) {
        let (mut crc, mut stuffed, mut run, mut last) = (0_u16, 0, 0, None);
        for place in (0..stream.count).rev() {
            let bit = (stream.bits >> place) as u16 & 1;
            let invert = bit ^ crc >> 14;
            crc = crc << 1 & 0x7FFF ^ if invert == 1 { 0x4599 } else { 0 };
            run = if last == Some(bit) { run + 1 } else { 1 };
            last = Some(bit);
            if run == 5 {
                stuffed += 1;
                (run, last) = (1, Some(1 - bit));
            }
        }
        (crc, stuffed)
    }

    proptest! {
        #[test]
        fn bits_at_once_are_as_bits_one_by_one(parts in prop::collection::vec((any::<bool>(), 1_u32..9), 1..14), flips in any::<u32>()) {
            let mut stream = BitStream::default();
            for (k, (ones, count)) in parts.into_iter().enumerate() {
                let run = if ones { (1 << count) - 1 } else { 0 };
                stream.push(run ^ u64::from(flips >> k & 3 == 0) & ((1 << count) - 1), count);
            }
            prop_assert_eq!((stream.crc(), stream.stuff_bits()), one_by_one(stream));
        }

        #[test]
        fn never_longer_than_the_worst_case(frame in any_frame()) {
            prop_assume!(!frame.is_extended());
            let bytes = frame.data().len();
            prop_assert!(wire_bits(&frame) <= worst_case_bits(bytes));
            prop_assert!(wire_bits(&frame) >= 47 + 8 * bytes as u32);
        }
    }

    fn tick_of_eight(tick: u32) -> Vec<TraceEntry> {
        let entry = |direction, id| TraceEntry {
            tick,
            wall_us: 0,
            direction,
            frame: Frame::whole(standard(id), [0x5A; 8]),
        };
        let mut trace: Vec<_> = [0x115, 0x110, 0x111, 0x112, 0x113, 0x114]
            .map(|id| entry(Direction::Sent, id))
            .into();
        trace.push(entry(Direction::Received, 0x0A0));
        trace
    }

    #[test]
    fn lower_identifiers_go_first_and_the_answer_after_the_question() {
        let trace: Vec<_> = (0..3).flat_map(tick_of_eight).collect();
        let wire = WireModel::of(&SendingOrder::of(&trace), 500_000, 5000, 3);
        assert_eq!(wire.end_us.len(), trace.len());
        assert!(wire.end_us[0] > wire.end_us[5], "0x115 was queued first and sent last");
        assert!(wire.end_us[6] > wire.end_us[0]);
        assert!(wire.end_us[7] > 5000 && wire.end_us[7] < 7000);
        let bits: u32 = trace.iter().map(|entry| wire_bits(&entry.frame)).sum();
        assert!((wire.utilisation - f64::from(bits) / 500_000.0 / 0.015).abs() < 1e-9);
        assert!((wire.peak_utilisation - wire.utilisation).abs() < 1e-9);
        for message in &wire.messages {
            assert!(message.max_us <= message.bound_us, "{}", message.contract.name);
        }
    }

    #[test]
    fn bound_by_hand() {
        // The command has the highest priority: it waits for one frame and then takes its own time.
        assert_eq!(
            response_bound_bits(&oleo_controller::can::COMMAND, &MESSAGES, 500_000),
            Some(270.0)
        );
        // Status: all seven of higher priority once, a frame of its own length as blocking, and itself.
        assert_eq!(
            response_bound_bits(&oleo_controller::can::STATUS, &MESSAGES, 500_000),
            Some(135.0 * 9.0)
        );
    }
}
