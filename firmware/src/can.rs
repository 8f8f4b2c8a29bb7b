//! The bxCAN peripheral (RM0090, section 32) as `embedded_can::nb::Can`, without a panic and without waiting.
//!
//! This is own code for two reasons. The frames of the crate `bxcan` panic on a received length code above 8, which any node on
//! the bus may send, and its choice of a mailbox has branches that the linker cannot prove to be unreachable. This driver does
//! what the controller needs: it sends data frames with standard identifiers in the given order, and receives through FIFO 0.

use crate::clock::is_soon;
use crate::frame::Frame;
use embedded_can::{ErrorKind, StandardId};
use stm32f4::stm32f405::{CAN1, GPIOB, RCC, can1};

/// Time quanta a bit: 1 (sync) + 11 + 2, sample point at 85.7 %.
pub const QUANTA: u32 = 1 + SEGMENT_1 + SEGMENT_2;
const SEGMENT_1: u32 = 11;
const SEGMENT_2: u32 = 2;
const JUMP: u32 = 1;

/// What the peripheral can report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// Frames came faster than they were taken from the three-deep FIFO, so that at least one is lost.
    Overrun,
}

/// CAN1 on PB8 (receive) and PB9 (transmit).
pub struct Can {
    registers: CAN1,
}

impl Can {
    /// Takes pins and peripheral and joins the bus at `bit_rate`, bit/s. It returns at once; the peripheral becomes active by
    /// itself after eleven recessive bits, and again after bus-off. `None` if the peripheral does not answer.
    pub fn start(registers: CAN1, _pins: GPIOB, rcc: &RCC, apb1_hz: u32, bit_rate: u32) -> Option<Self> {
        connect_pins(rcc);
        rcc.apb1enr().modify(|_, w| w.can1en().enabled());
        rcc.apb1rstr().modify(|_, w| w.can1rst().reset());
        rcc.apb1rstr().modify(|_, w| w.can1rst().clear_bit());

        // After reset it sleeps; initialisation is only entered awake.
        registers.mcr().modify(|_, w| w.sleep().clear_bit().inrq().set_bit());
        if !is_soon(|| registers.msr().read().inak().bit_is_set()) {
            return None;
        }
        // Automatic recovery from bus-off; frames leave in the order of the requests, not of the mailboxes.
        registers.mcr().modify(|_, w| w.abom().set_bit().txfp().set_bit());
        let prescaler = (apb1_hz / (bit_rate.max(1) * QUANTA)).clamp(1, 1024);
        #[allow(unsafe_code)]
        // SAFETY: fields within RM0090, section 32.9.2: prescaler - 1 in 10 bits, segments - 1 in 4 and 3 bits.
        registers.btr().write(|w| unsafe {
            w.bits((JUMP - 1) << 24 | (SEGMENT_2 - 1) << 20 | (SEGMENT_1 - 1) << 16 | (prescaler - 1))
        });
        accept_all(&registers);
        registers.mcr().modify(|_, w| w.inrq().clear_bit());
        Some(Can { registers })
    }
}

/// The error state of the peripheral.
pub struct Errors {
    /// The whole error register (RM0090, section 32.9.2, `CAN_ESR`).
    pub bits: u32,
    /// Whether the peripheral has left the bus. It comes back by itself.
    pub is_off: bool,
}

impl Can {
    /// The error state now.
    pub fn errors(&self) -> Errors {
        let register = self.registers.esr().read();
        Errors {
            bits: register.bits(),
            is_off: register.boff().bit_is_set(),
        }
    }
}

impl embedded_can::nb::Can for Can {
    type Frame = Frame;
    type Error = Error;

    /// Puts the frame into a free mailbox; `WouldBlock` while there is none. Never displaces a waiting frame.
    fn transmit(&mut self, frame: &Frame) -> nb::Result<Option<Frame>, Error> {
        let (id, length, [a, b, c, d, e, f, g, h]) = frame.parts();
        let status = self.registers.tsr().read();
        let free = [status.tme0().bit(), status.tme1().bit(), status.tme2().bit()];
        let mailboxes = self.registers.tx_iter();
        let Some((mailbox, _)) = mailboxes.zip(free).find(|(_, free)| *free) else {
            return Err(nb::Error::WouldBlock);
        };
        #[allow(unsafe_code)]
        // SAFETY: an empty mailbox may be written; every pattern of data and length 0..=8 is valid.
        unsafe {
            mailbox.tdtr().write(|w| w.bits(u32::from(length)));
            mailbox.tdlr().write(|w| w.bits(u32::from_le_bytes([a, b, c, d])));
            mailbox.tdhr().write(|w| w.bits(u32::from_le_bytes([e, f, g, h])));
            mailbox.tir().write(|w| w.bits(u32::from(id) << 21).txrq().set_bit());
        }
        Ok(None)
    }

    /// The oldest received data frame; remote and extended frames are dropped. `WouldBlock` if there is none.
    fn receive(&mut self) -> nb::Result<Frame, Error> {
        let fifo = self.registers.rf0r();
        // Bounded by the depth of the FIFO, so that no traffic keeps the caller here.
        for _ in 0..3 {
            let status = fifo.read();
            if status.fovr().bit_is_set() {
                fifo.write(|w| w.fovr().clear());
                return Err(nb::Error::Other(Error::Overrun));
            }
            if status.fmp().bits() == 0 {
                break;
            }
            let frame = self.registers.rx_iter().next().and_then(read_mailbox);
            fifo.write(|w| w.rfom().set_bit());
            while fifo.read().rfom().bit_is_set() {}
            if let Some(frame) = frame {
                return Ok(frame);
            }
        }
        Err(nb::Error::WouldBlock)
    }
}

fn read_mailbox(mailbox: &can1::RX) -> Option<Frame> {
    let identifier = mailbox.rir().read();
    if identifier.ide().bit_is_set() || identifier.rtr().bit_is_set() {
        return None;
    }
    let id = StandardId::new(identifier.stid().bits())?;
    let [a, b, c, d] = mailbox.rdlr().read().bits().to_le_bytes();
    let [e, f, g, h] = mailbox.rdhr().read().bits().to_le_bytes();
    let length = mailbox.rdtr().read().dlc().bits();
    Some(Frame::received(id, length, [a, b, c, d, e, f, g, h]))
}

/// Filter bank 0 with 32 bits and mask 0 lets everything into FIFO 0. The controller knows its identifiers, and other frames cost it
/// little.
fn accept_all(registers: &CAN1) {
    registers.fmr().modify(|_, w| w.finit().set_bit());
    registers.fm1r().modify(|_, w| w.fbm0().clear_bit());
    registers.fs1r().modify(|_, w| w.fsc0().set_bit());
    registers.ffa1r().modify(|_, w| w.ffa0().clear_bit());
    if let Some(bank) = registers.fb_iter().next() {
        #[allow(unsafe_code)]
        // SAFETY: all patterns are valid; the bank is inactive and in initialisation.
        unsafe {
            bank.fr1().write(|w| w.bits(0));
            bank.fr2().write(|w| w.bits(0));
        }
    }
    registers.fa1r().modify(|_, w| w.fact0().set_bit());
    registers.fmr().modify(|_, w| w.finit().clear_bit());
}

fn connect_pins(rcc: &RCC) {
    rcc.ahb1enr().modify(|_, w| w.gpioben().enabled());
    #[allow(unsafe_code)]
    // SAFETY: the caller gave us the port; fixed, always mapped.
    let port = unsafe { &*GPIOB::ptr() };
    port.afrh().modify(|_, w| w.afrh8().af9().afrh9().af9());
    port.moder().modify(|_, w| w.moder8().alternate().moder9().alternate());
}

impl embedded_can::Error for Error {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Overrun
    }
}
