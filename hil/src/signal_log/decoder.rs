//! The value of a signal from the bytes of a frame, as a CAN database defines it.
//!
//! The crate `can-dbc` parses databases and leaves decoding to others. Of those, `falcon_mdf` (0.7) does not know the signals that are
//! floating-point numbers (`SIG_VALTYPE_`) and reads them as integers, and `can_decode` (0.7) knows no multiplexing and needs another
//! version of `can-dbc`. Hence these few lines; `tests/logs_as_people_have_them.py` holds them against cantools.

use can_dbc::{ByteOrder, Dbc, Message, MultiplexIndicator, NumericValue, Signal, SignalExtendedValueType, ValueType};

/// Most multiplexers of which one selects the next.
const DEEPEST: usize = 8;

/// Where the bits of a signal are.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bits {
    /// Start bit as the database counts: bit 0 is the lowest of byte 0. It is the lowest bit of a little-endian signal and the highest
    /// of a big-endian one.
    start: usize,
    /// Number of bits, 1 to 64.
    size: usize,
    is_big_endian: bool,
}

impl Bits {
    fn of(signal: &Signal) -> Option<Self> {
        let size = usize::try_from(signal.size)
            .ok()
            .filter(|size| (1..=64).contains(size))?;
        Some(Self {
            start: usize::try_from(signal.start_bit).ok().filter(|start| *start < 512)?,
            size,
            is_big_endian: signal.byte_order == ByteOrder::BigEndian,
        })
    }

    /// The bits as an unsigned number; `None` if the frame is too short.
    fn raw(self, data: &[u8]) -> Option<u64> {
        let mask = u64::MAX >> (64 - self.size);
        // 64 bits lie in nine bytes at most.
        let (first, in_byte) = (self.start / 8, self.start % 8);
        if self.is_big_endian {
            let above = 7 - in_byte;
            let bytes = (above + self.size).div_ceil(8);
            let whole =
                (data.get(first..first + bytes)?.iter()).fold(0u128, |whole, byte| whole << 8 | u128::from(*byte));
            return Some((whole >> (8 * bytes - above - self.size)) as u64 & mask);
        }
        let bytes = (in_byte + self.size).div_ceil(8);
        let whole =
            (data.get(first..first + bytes)?.iter().rev()).fold(0u128, |whole, byte| whole << 8 | u128::from(*byte));
        Some((whole >> in_byte) as u64 & mask)
    }
}

/// How the bits are a number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    Unsigned,
    Signed,
    Single,
    Double,
}

/// A condition under which a signal is in the frame: a multiplexer holds a value in one of the ranges.
#[derive(Clone, Debug, PartialEq)]
struct Selected {
    by: Bits,
    ranges: Vec<(u64, u64)>,
}

/// Decodes one signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Decoder {
    bits: Bits,
    number: Number,
    factor: f64,
    offset: f64,
    /// Range of values that mean something, where the database states one.
    range: Option<(f64, f64)>,
    selected: Vec<Selected>,
}

impl Decoder {
    /// The decoder of a signal; an error says in a few words what the database has that cannot be decoded.
    pub fn of(database: &Dbc, message: &Message, signal: &Signal) -> Result<Self, String> {
        let bits = Bits::of(signal).ok_or_else(|| format!("has {} bits from bit {}", signal.size, signal.start_bit))?;
        let number = match (
            database.extended_value_type_for_signal(message.id, &signal.name),
            bits.size,
        ) {
            (Some(SignalExtendedValueType::IEEEfloat32Bit), 32) => Number::Single,
            (Some(SignalExtendedValueType::IEEEdouble64bit), 64) => Number::Double,
            (Some(SignalExtendedValueType::IEEEfloat32Bit | SignalExtendedValueType::IEEEdouble64bit), size) => {
                return Err(format!("is a floating-point number of {size} bits"));
            }
            _ if signal.value_type == ValueType::Signed => Number::Signed,
            _ => Number::Unsigned,
        };
        let as_number = |value| match value {
            NumericValue::Uint(value) => value as f64,
            NumericValue::Int(value) => value as f64,
            NumericValue::Double(value) => value,
        };
        let range = (as_number(signal.min), as_number(signal.max));
        let selected = selected(database, message, signal)?;
        Ok(Self {
            bits,
            number,
            factor: signal.factor,
            offset: signal.offset,
            // [0|0] states no range.
            range: (range.0 < range.1).then_some(range),
            selected,
        })
    }

    /// The decoder that takes any value for one that means something.
    pub fn without_range(self) -> Self {
        Self { range: None, ..self }
    }

    /// Step between two values; 0 of a floating-point number.
    pub fn step(&self) -> f64 {
        match self.number {
            Number::Unsigned | Number::Signed => self.factor.abs(),
            Number::Single | Number::Double => 0.0,
        }
    }

    /// The value in a frame, in the unit of the database. `None` if the signal is not in this frame, or beyond the range in which the
    /// database says that it means something.
    pub fn value(&self, data: &[u8]) -> Option<f64> {
        let is_there = |selected: &Selected| {
            let raw = selected.by.raw(data);
            raw.is_some_and(|raw| selected.ranges.iter().any(|(low, high)| (*low..=*high).contains(&raw)))
        };
        if !self.selected.iter().all(is_there) {
            return None;
        }
        let raw = self.bits.raw(data)?;
        let number = match self.number {
            Number::Unsigned => raw as f64,
            Number::Signed => {
                let unused = 64 - self.bits.size;
                ((raw << unused) as i64 >> unused) as f64
            }
            Number::Single => f64::from(f32::from_bits(raw as u32)),
            Number::Double => f64::from_bits(raw),
        };
        let value = number * self.factor + self.offset;
        // A database rounds the ends of its ranges.
        let slack = 0.5 * self.step();
        let means_something = |(low, high): (f64, f64)| (low - slack..=high + slack).contains(&value);
        (value.is_finite() && self.range.is_none_or(means_something)).then_some(value)
    }
}

/// The conditions under which a signal is in its message, from its own multiplexer to that of the whole message.
fn selected(database: &Dbc, message: &Message, signal: &Signal) -> Result<Vec<Selected>, String> {
    let (mut conditions, mut signal) = (Vec::new(), signal);
    for _ in 0..DEEPEST {
        let extended = (database.extended_multiplex.iter())
            .find(|entry| entry.message_id == message.id && entry.signal_name == signal.name);
        let (by, ranges) = match (extended, signal.multiplexer_indicator) {
            (Some(entry), _) => {
                let by = message
                    .signals
                    .iter()
                    .find(|other| other.name == entry.multiplexor_signal_name);
                let ranges = entry.mappings.iter().map(|range| (range.min_value, range.max_value));
                (by, ranges.collect())
            }
            (None, MultiplexIndicator::Plain | MultiplexIndicator::Multiplexor) => return Ok(conditions),
            (
                None,
                MultiplexIndicator::MultiplexedSignal(value)
                | MultiplexIndicator::MultiplexorAndMultiplexedSignal(value),
            ) => {
                let is_switch = |other: &&Signal| other.multiplexer_indicator == MultiplexIndicator::Multiplexor;
                (message.signals.iter().find(is_switch), vec![(value, value)])
            }
        };
        let by = by.ok_or("is selected by a multiplexer that the message does not have")?;
        conditions.push(Selected {
            by: Bits::of(by).ok_or("is selected by a multiplexer without bits")?,
            ranges,
        });
        signal = by;
    }
    Err("is selected by multiplexers in a circle".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn decoder(definition: &str, rest: &str) -> Decoder {
        let text =
            format!("VERSION \"\"\nNS_ :\nBS_:\nBU_: A\nBO_ 256 M: 8 A\n SG_ S {definition} Vector__XXX\n{rest}\n");
        let database = Dbc::try_from(text.as_str()).expect("a database");
        let message = &database.messages[0];
        Decoder::of(&database, message, &message.signals[0]).expect("a signal")
    }

    #[test]
    fn bytes_become_values() {
        let data = [0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0];
        let value = |definition: &str| decoder(definition, "").value(&data);
        assert_eq!(value(": 0|16@1+ (1,0) [0|0] \"\""), Some(f64::from(0x3412)));
        assert_eq!(value(": 7|16@0+ (1,0) [0|0] \"\""), Some(f64::from(0x1234)));
        assert_eq!(value(": 4|12@1+ (1,0) [0|0] \"\""), Some(f64::from(0x341)));
        assert_eq!(value(": 3|12@0+ (1,0) [0|0] \"\""), Some(f64::from(0x234)));
        assert_eq!(value(": 56|8@1- (0.5,10) [0|0] \"bar\""), Some(2.0));
        // Two steps beyond the range, and half a step.
        assert_eq!(value(": 0|8@1+ (1,0) [0|16] \"\""), None);
        assert_eq!(value(": 0|8@1+ (1,0) [0|17.5] \"\""), Some(18.0));
        // A frame that is too short.
        assert_eq!(decoder(": 60|8@1+ (1,0) [0|0] \"\"", "").value(&data), None);
    }

    #[test]
    fn floating_point_numbers_and_multiplexed_signals() {
        let single = decoder(": 0|32@1- (2,0) [0|0] \"\"", "SIG_VALTYPE_ 256 S : 1;");
        assert_eq!(single.value(&[0, 0, 0xC0, 0x3F]), Some(3.0));
        assert_eq!((single.value(&[0, 0, 0x80, 0x7F]), single.step()), (None, 0.0));
        let selected = decoder(
            "m3 : 8|8@1+ (1,0) [0|0] \"\"",
            " SG_ W M : 0|8@1+ (1,0) [0|0] \"\" Vector__XXX",
        );
        assert_eq!((selected.value(&[3, 77]), selected.value(&[4, 77])), (Some(77.0), None));
    }

    proptest! {
        /// Bit by bit, as the definition of both orders says.
        #[test]
        fn any_signal_anywhere(start in 0_usize..64, size in 1_usize..=64, is_big_endian: bool, data: [u8; 8]) {
            let bits = Bits { start, size, is_big_endian };
            let mut places = Vec::new();
            let mut at = Some(start);
            for _ in 0..size {
                places.extend(at.filter(|at| *at < 64));
                at = at.and_then(|at| match (is_big_endian, at % 8) {
                    (false, _) => Some(at + 1),
                    (true, 0) => Some(at + 15),
                    (true, _) => at.checked_sub(1),
                });
            }
            let expected = (places.len() == size).then(|| {
                let bit = |at: &usize| u64::from(data[at / 8] >> (at % 8) & 1);
                let highest_first: Vec<u64> = if is_big_endian {
                    places.iter().map(bit).collect()
                } else {
                    places.iter().rev().map(bit).collect()
                };
                highest_first.iter().fold(0, |value, bit| value << 1 | bit)
            });
            prop_assert_eq!(bits.raw(&data), expected);
        }
    }
}
