//! CAN over USART1 as text ("slcan", Lawicel), in place of the bxCAN peripheral: for an emulator, which has no CAN controller.
//!
//! The driver has the same trait as the real one, so the port, the node and the tick behind it are the same code. It also paces the
//! controller: a simulated plant ends each of its ticks with a frame, `TickDone`, and waits for the one with which this node answers
//! (`hil/src/sync.rs`). Time then passes as the plant says, and not as fast as the emulator happens to run.
//!
//! Nothing is lost on an emulated line, so there is no error to report. A line that is no frame is skipped.

use crate::frame::Frame;
use crc::{CRC_16_IBM_3740, Crc, NoTable};
use embedded_can::StandardId;
use stm32f4::stm32f405::{GPIOA, RCC, USART1};

/// Extended identifiers of the frames that keep two nodes in step: the plant's and this node's.
const PLANT_ID: u32 = 0x1FFF_01E0;
const OWN_ID: u32 = 0x1FFF_01E1;
/// Kinds of such frames, in their first byte.
const HELLO: u8 = 0x30;
const TICK_DONE: u8 = 0x31;
const END: u8 = 0x32;
const LOSSES: u8 = 0x33;
const TALLY: u8 = 0x34;
/// Check value of such a frame over sender, session (four zeros: there is one board on the line), kind and content. Without a table,
/// which would be longer than all else here.
const CHECK: Crc<u16, NoTable> = Crc::<u16, NoTable>::new(&CRC_16_IBM_3740);
/// Longest line that is read: `T`, eight digits, a length and eight bytes.
const LONGEST: usize = 1 + 8 + 1 + 16;
/// Rate of the line, bit/s.
const BAUD: u32 = 1_000_000;

/// USART1 on PA9 (transmit) and PA10 (receive).
pub struct Slcan {
    registers: USART1,
    line: [u8; LONGEST],
    length: usize,
    /// Number of the tick that the plant has ended and that was not answered yet.
    due: Option<[u8; 3]>,
    sent: u32,
    e2e_errors: u16,
}

impl Slcan {
    /// Sets the line up, and says that the node is ready.
    pub fn start(registers: USART1, port: GPIOA, rcc: &RCC, apb2_hz: u32) -> Self {
        rcc.ahb1enr().modify(|_, w| w.gpioaen().enabled());
        rcc.apb2enr().modify(|_, w| w.usart1en().enabled());
        port.afrh().modify(|_, w| w.afrh9().af7().afrh10().af7());
        port.moder().modify(|_, w| w.moder9().alternate().moder10().alternate());
        #[allow(unsafe_code)]
        // SAFETY: the whole register is the divider, in sixteenths at 16 samples a bit.
        registers
            .brr()
            .write(|w| unsafe { w.bits((apb2_hz / BAUD) as u16 as _) });
        registers
            .cr1()
            .write(|w| w.ue().set_bit().te().set_bit().re().set_bit());
        let mut line = Self {
            registers,
            line: [0; LONGEST],
            length: 0,
            due: None,
            sent: 0,
            e2e_errors: 0,
        };
        line.write_sync(HELLO, [0; 5]);
        line
    }

    /// Whether the plant has ended a tick that is not answered yet.
    pub fn is_tick_due(&self) -> bool {
        self.due.is_some()
    }

    /// Tells the plant that its tick is answered. The number of frames that have failed their end-to-end check is for the end of the run.
    pub fn end_tick(&mut self, e2e_errors: u32) {
        self.e2e_errors = u16::try_from(e2e_errors).unwrap_or(u16::MAX);
        let Some([t0, t1, t2]) = self.due.take() else { return };
        let [s0, s1, ..] = self.sent.to_le_bytes();
        self.write_sync(TICK_DONE, [t0, t1, t2, s0, s1]);
    }

    fn write_sync(&mut self, kind: u8, content: [u8; 5]) {
        let ([c0, c1], [a, b, c, d, e]) = (check(OWN_ID, kind, content), content);
        self.write(b'T');
        self.write_hex(OWN_ID, 8);
        self.write_data(8, [kind, c0, c1, a, b, c, d, e]);
    }

    fn write_data(&mut self, length: u8, data: [u8; 8]) {
        self.write_hex(length.into(), 1);
        for byte in data.into_iter().take(length.into()) {
            self.write_hex(byte.into(), 2);
        }
        self.write(b'\r');
    }

    fn write_hex(&mut self, value: u32, digits: u32) {
        for place in (0..digits).rev() {
            let digit = (value >> (4 * place) & 0xF) as u8;
            self.write(if digit < 10 { b'0' + digit } else { b'A' + (digit - 10) });
        }
    }

    /// Waits for the transmitter, which takes 10 us a byte; the plant waits meanwhile.
    fn write(&mut self, byte: u8) {
        while self.registers.sr().read().txe().bit_is_clear() {}
        self.registers.dr().write(|w| w.dr().set(byte.into()));
    }

    /// Takes a byte; returns the frame of the vehicle that it ends, if it does.
    fn take(&mut self, byte: u8) -> Option<Frame> {
        if byte != b'\r' {
            if let Some(place) = self.line.get_mut(self.length) {
                *place = byte;
            }
            // One more than there is room for marks a line that is too long.
            self.length = (self.length + 1).min(LONGEST + 1);
            return None;
        }
        let line = self.line;
        let line = line.get(..core::mem::take(&mut self.length))?;
        let (kind, rest) = line.split_first()?;
        match kind {
            b't' => {
                let (id, length, data) = parse(rest, 3)?;
                Some(Frame::received(StandardId::new(id as u16)?, length, data))
            }
            b'T' => {
                let (id, _, [kind, c0, c1, a, b, c, d, e]) = parse(rest, 8)?;
                if [c0, c1] != check(PLANT_ID, kind, [a, b, c, d, e]) {
                    return None;
                }
                match (id, kind) {
                    (PLANT_ID, TICK_DONE) => self.due = Some([a, b, c]),
                    (PLANT_ID, END) => {
                        let ([s0, s1, s2, s3], [e0, e1]) = (self.sent.to_le_bytes(), self.e2e_errors.to_le_bytes());
                        self.write_sync(LOSSES, [0, 0, 0, e0, e1]);
                        self.write_sync(TALLY, [s0, s1, s2, s3, 0]);
                    }
                    _ => {}
                }
                None
            }
            _ => None,
        }
    }
}

/// Check value of a frame that keeps two nodes in step.
fn check(id: u32, kind: u8, content: [u8; 5]) -> [u8; 2] {
    let mut digest = CHECK.digest();
    digest.update(&id.to_le_bytes());
    digest.update(&[0, 0, 0, 0, kind]);
    digest.update(&content);
    digest.finalize().to_le_bytes()
}

/// Identifier, length and data of a line without its first letter.
fn parse(line: &[u8], id_digits: usize) -> Option<(u32, u8, [u8; 8])> {
    let (id, rest) = line.split_at_checked(id_digits)?;
    let (length, digits) = rest.split_at_checked(1)?;
    let length = hex(length)? as u8;
    let mut data = [0; 8];
    for (byte, digits) in data.iter_mut().zip(digits.chunks(2)) {
        *byte = hex(digits)? as u8;
    }
    Some((hex(id)?, length, data))
}

fn hex(digits: &[u8]) -> Option<u32> {
    digits.iter().try_fold(0, |value: u32, digit| {
        let digit = match digit {
            b'0'..=b'9' => digit - b'0',
            b'A'..=b'F' => digit - b'A' + 10,
            b'a'..=b'f' => digit - b'a' + 10,
            _ => return None,
        };
        Some(value << 4 | u32::from(digit))
    })
}

impl embedded_can::nb::Can for Slcan {
    type Frame = Frame;
    type Error = embedded_can::ErrorKind;

    fn transmit(&mut self, frame: &Frame) -> nb::Result<Option<Frame>, Self::Error> {
        let (id, length, data) = frame.parts();
        self.write(b't');
        self.write_hex(id.into(), 3);
        self.write_data(length, data);
        self.sent = self.sent.wrapping_add(1);
        Ok(None)
    }

    /// The next frame of the vehicle. While a tick is due there is none, so that what comes after it belongs to the next.
    fn receive(&mut self) -> nb::Result<Frame, Self::Error> {
        while self.due.is_none() && self.registers.sr().read().rxne().bit_is_set() {
            let byte = self.registers.dr().read().dr().bits() as u8;
            if let Some(frame) = self.take(byte) {
                return Ok(frame);
            }
        }
        Err(nb::Error::WouldBlock)
    }
}
