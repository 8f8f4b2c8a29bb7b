//! Vector ASC logs, the text that CANoe, CANalyzer and many loggers write.
//!
//! ```text
//!   date Wed Apr 26 10:00:00.000 2023
//!   base hex  timestamps absolute
//!   Begin Triggerblock Wed Apr 26 10:00:00.000 2023
//!      0.015270 1  110             Rx   d 8 00 11 22 33 44 55 66 77  Length = 0 BitCount = 64
//!      0.015500 2  1FFF01E0x       Rx   r 4
//!      0.015600 1  ErrorFrame
//!      0.015900 CANFD   1 Rx        123   NameOfTheMessage   1 0 d 32 AA BB ...
//!      1.000000 1  Statistic: D 200 R 0 XD 0 XR 0 E 0 O 0 B 12.5%
//!   End TriggerBlock
//! ```
//!
//! Source: Vector, "CAN, Log & Trigger ASC Logging Format", 1.4.6 (2016), sections 3.1 to 3.5. `base` holds for identifiers, data
//! and lengths as codes, not for times, channels and the length of CAN FD data. With `timestamps relative` a time counts from the
//! event before, of whatever kind. Times start at zero with the measurement.
//!
//! The crate `blf_asc` 0.2 reads these files too, but takes relative times for absolute ones, ends at a byte that is not UTF-8, and
//! counts nothing of what it leaves out.

use std::path::PathBuf;

use super::account::Account;
use super::error::LogError;
use super::frame::{Entry, FrameKind, LoggedFrame, Payload, identifier};
use super::source::{FrameSource, Sink};
use super::text::Lines;

/// How the numbers of a log are to be read; a head says so, and may come once more in the middle of joined files.
#[derive(Clone, Copy, Debug)]
struct Notation {
    radix: u32,
    is_relative: bool,
}

/// What an event is.
#[derive(Debug, PartialEq)]
enum Event<'a> {
    /// A frame, and the channel that it was on.
    Frame(&'a str, LoggedFrame),
    /// An error frame.
    Error,
    /// Anything else that the format knows.
    Other,
    /// No event of this format.
    Unreadable,
}

/// The frames of an ASC log.
pub struct Asc {
    lines: Lines,
    path: PathBuf,
}

impl Asc {
    /// A log whose text is given. `path` is the name that appears in errors.
    pub fn new(lines: Lines, path: PathBuf) -> Self {
        Self { lines, path }
    }
}

impl FrameSource for Asc {
    fn read(&mut self, sink: &mut Sink) -> Result<Account, LogError> {
        let mut account = Account::default();
        let mut notation = Notation {
            radix: 16,
            is_relative: false,
        };
        // Time of the event before.
        let mut now_us: u64 = 0;
        while let Some(line) = (self.lines.next()).map_err(|e| LogError::unreadable(&self.path, &e))? {
            account.entries += 1;
            let line = line.trim();
            let Some((time_us, rest)) = timed(line) else {
                match notation.read_head(line) {
                    true => account.without_frame += 1,
                    false => account.unreadable += 1,
                }
                continue;
            };
            now_us = if notation.is_relative {
                now_us.saturating_add(time_us)
            } else {
                time_us
            };
            match event(rest, notation.radix) {
                Event::Frame(bus, frame) => {
                    account.remote_frames += u64::from(matches!(frame.kind, FrameKind::Remote(_)));
                    let entry = Entry {
                        time_us: now_us,
                        bus,
                        frame,
                    };
                    if sink(entry).is_break() {
                        break;
                    }
                }
                Event::Error => account.error_frames += 1,
                Event::Other => account.without_frame += 1,
                Event::Unreadable => account.unreadable += 1,
            }
        }
        Ok(account)
    }
}

impl Notation {
    /// Reads a line without a time; whether the format knows it.
    fn read_head(&mut self, line: &str) -> bool {
        let lower = line.to_ascii_lowercase();
        let mut words = lower.split_ascii_whitespace();
        match words.next() {
            Some("base") => {
                self.radix = match words.next() {
                    Some("hex") => 16,
                    Some("dec") => 10,
                    _ => return false,
                };
                self.is_relative = match (words.next(), words.next()) {
                    (None, _) | (Some("timestamps"), Some("absolute")) => false,
                    (Some("timestamps"), Some("relative")) => true,
                    _ => return false,
                };
                true
            }
            None | Some("date" | "begin" | "end" | "no" | "internal" | "previous") => true,
            Some(word) => word.starts_with("//"),
        }
    }
}

/// The time that a line begins with, us, and the rest of it.
fn timed(line: &str) -> Option<(u64, &str)> {
    let (time, rest) = line.split_once(|c: char| c.is_ascii_whitespace())?;
    let (seconds, fraction) = time.split_once('.')?;
    let are_digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    if !are_digits(seconds) || !are_digits(fraction) || fraction.len() > 12 {
        return None;
    }
    // Down to picoseconds as an integer, so that a time has one value on every machine.
    let picoseconds: u64 = format!("{fraction:0<12}").parse().ok()?;
    let micros = (picoseconds + 500_000) / 1_000_000;
    let seconds: u64 = seconds.parse().ok()?;
    Some((seconds.checked_mul(1_000_000)?.checked_add(micros)?, rest.trim_start()))
}

fn event(rest: &str, radix: u32) -> Event<'_> {
    let mut words = rest.split_ascii_whitespace();
    let Some(first) = words.next() else {
        return Event::Unreadable;
    };
    if first == "CANFD" {
        let (Some(channel), second) = (words.next(), words.next()) else {
            return Event::Unreadable;
        };
        // The direction stands before the identifier, and before the word of an error frame, which some writers leave out.
        let is_error = |word: Option<&str>| word.is_some_and(|word| word.eq_ignore_ascii_case("ErrorFrame"));
        return match second {
            Some("Rx" | "Tx") => match fd(words.clone(), radix) {
                Some(frame) => Event::Frame(channel, frame),
                None if is_error(words.next()) => Event::Error,
                None => Event::Unreadable,
            },
            Some("TxRq") => Event::Other,
            word if is_error(word) => Event::Error,
            _ => Event::Unreadable,
        };
    }
    if !first.bytes().all(|b| b.is_ascii_digit()) {
        return Event::Other;
    }
    match (words.next(), words.next()) {
        (Some(word), _) if word.eq_ignore_ascii_case("ErrorFrame") => Event::Error,
        (Some(id), Some("Rx" | "Tx")) => match classic(id, words, radix) {
            Some(frame) => Event::Frame(first, frame),
            None => Event::Unreadable,
        },
        // A request to transmit is not what was on the bus; statistics and the state of the chip are no frame.
        _ => Event::Other,
    }
}

/// An identifier, with an x behind one of 29 bits.
fn id(word: &str, radix: u32) -> Option<embedded_can::Id> {
    let (digits, is_extended) = match word.strip_suffix(['x', 'X']) {
        Some(digits) => (digits, true),
        None => (word, false),
    };
    identifier(number(digits, radix)?, is_extended)
}

fn number(digits: &str, radix: u32) -> Option<u32> {
    u32::from_str_radix(digits, radix)
        .ok()
        .filter(|_| !digits.starts_with('+'))
}

fn bytes<'a>(words: impl Iterator<Item = &'a str>, count: usize, radix: u32) -> Option<Payload> {
    let (mut payload, mut read) = (Payload::EMPTY, 0);
    for word in words.take(count) {
        payload.push(u8::try_from(number(word, radix)?).ok()?)?;
        read += 1;
    }
    (read == count).then_some(payload)
}

/// `123 Rx d 8 00 11 ...`: what follows the direction.
fn classic<'a>(id_word: &str, mut words: impl Iterator<Item = &'a str>, radix: u32) -> Option<LoggedFrame> {
    let id = id(id_word, radix)?;
    match words.next()? {
        "d" | "D" => {
            // A code above 8 is transmitted with eight bytes.
            let length = number(words.next()?, radix).filter(|code| *code <= 15)?.min(8);
            LoggedFrame::new(id, FrameKind::Classic, bytes(words, length as usize, radix)?)
        }
        "r" | "R" => {
            let code = words.next().and_then(|word| number(word, radix)).unwrap_or(0);
            LoggedFrame::new(id, FrameKind::Remote(code.min(8) as u8), Payload::EMPTY)
        }
        _ => None,
    }
}

/// `123 [NAME] BRS ESI DLC LENGTH 00 11 ...`: what follows the direction of a frame on a CAN FD channel.
fn fd<'a>(mut words: impl Iterator<Item = &'a str>, radix: u32) -> Option<LoggedFrame> {
    let id = id(words.next()?, radix)?;
    let flag = |word: &str| match word {
        "0" => Some(0),
        "1" => Some(1),
        _ => None,
    };
    let after = words.next()?;
    // A symbolic name begins with a letter or an underscore.
    let brs = match flag(after) {
        Some(brs) => brs,
        None => flag(words.next()?)?,
    };
    let esi: u8 = flag(words.next()?)?;
    let _code = number(words.next()?, radix)?;
    // The length is decimal whatever the base.
    let length: usize = words.next()?.parse().ok()?;
    LoggedFrame::new(id, FrameKind::Fd(brs | esi << 1), bytes(words, length, radix)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    /// Time, us; channel, identifier, kind and data of a frame.
    type Read = (u64, String, embedded_can::Id, FrameKind, Vec<u8>);

    /// The frames of a text, and the account.
    fn read(text: &str) -> (Vec<Read>, Account) {
        let mut frames = Vec::new();
        let lines = Lines::new(Box::new(std::io::Cursor::new(text.as_bytes().to_vec())));
        let account = Asc::new(lines, "a.asc".into())
            .read(&mut |entry| {
                let frame = entry.frame;
                frames.push((
                    entry.time_us,
                    entry.bus.to_owned(),
                    frame.id,
                    frame.kind,
                    frame.data().to_vec(),
                ));
                ControlFlow::Continue(())
            })
            .expect("memory can be read");
        (frames, account)
    }

    fn id(number: u32, is_extended: bool) -> embedded_can::Id {
        identifier(number, is_extended).expect("within its bits")
    }

    #[test]
    fn a_log_of_canalyzer_is_read() {
        let (frames, account) = read(
            "date Wed Apr 26 10:00:00.000 am 2023\nbase hex  timestamps absolute\nno internal events logged\n\
             // version 9.0.0\nBegin Triggerblock Wed Apr 26 10:00:00.000 2023\n   0.000000 Start of measurement\n\
             0.015270 1  110             Rx   d 2 1A FF  Length = 0 BitCount = 64 ID = 272\n\
             0.0155004 2  1FFF01E0x       Tx   r 4\n 0.0156 1  ErrorFrame\n 0.0157 CANFD   1 Rx        ErrorFrame\n\
             0.015900 CANFD   3 Rx        123   Engine_Data   1 0 9 12 00 01 02 03 04 05 06 07 08 09 0A 0B  0 0 3000\n\
             0.016000 CANFD   3 Tx        1F0x 0 1 0 0\n 0.9 1 110 TxRq d 0\n\
             1.000000 1  Statistic: D 200 R 0 XD 0 XR 0 E 0 O 0 B 12.5%\n 1.1 CAN 1 Status:chip status error active\n\
             1.2 1 110 Rx d 3 00 01\n what is this\nEnd TriggerBlock\n",
        );
        let data: Vec<u8> = (0..12).collect();
        assert_eq!(
            frames,
            [
                (
                    15_270,
                    "1".into(),
                    id(0x110, false),
                    FrameKind::Classic,
                    vec![0x1A, 0xFF]
                ),
                (15_500, "2".into(), id(0x1FFF_01E0, true), FrameKind::Remote(4), vec![]),
                (15_900, "3".into(), id(0x123, false), FrameKind::Fd(1), data),
                (16_000, "3".into(), id(0x1F0, true), FrameKind::Fd(2), vec![]),
            ]
        );
        let expected = Account {
            entries: 18,
            unreadable: 2,
            error_frames: 2,
            remote_frames: 1,
            without_frame: 10,
        };
        assert_eq!(account, expected);
    }

    #[test]
    fn decimal_numbers_and_times_since_the_event_before() {
        let (frames, _) = read(
            "base dec  timestamps relative\n 0.5 1  291  Rx   d 2 1 255\n 0.25 1  Statistic: D 0\n\
             0.25 CANFD 1 Rx 305419896x 1 0 8 8 11 22 33 44 55 66 77 88\n",
        );
        assert_eq!(
            frames,
            [
                (500_000, "1".into(), id(291, false), FrameKind::Classic, vec![1, 255]),
                (
                    1_000_000,
                    "1".into(),
                    id(305_419_896, true),
                    FrameKind::Fd(1),
                    vec![11, 22, 33, 44, 55, 66, 77, 88]
                ),
            ]
        );
    }

    proptest::proptest! {
        #[test]
        fn no_text_does_harm(text in "(base dec|[0-9]{1,4}\\.[0-9]{1,13}|CANFD|Rx|d|r|x|[0-9a-f]{1,4}| |\n|\\PC){0,40}") {
            let _ = read(&text);
        }
    }
}
