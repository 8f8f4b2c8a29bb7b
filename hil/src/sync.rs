//! Frames that synchronise the two nodes. They belong to the simulation and are not messages of the vehicle.
//!
//! A node in lockstep must know when the other has sent everything in a tick, even if a fault has dropped the last message. So each
//! ends its tick with a `TickDone`, which no injected fault touches. It carries the number of frames sent so far, which shows
//! frames that a slow reader has lost. Wall-clock time decides nothing, except that a partner that is silent for seconds is taken
//! to be gone.
//!
//! ```text
//!   plant                                 controller
//!     Hello  (repeated until heard)  <->    Hello               either may start first
//!     six sensor frames, TickDone n   ->
//!                                    <-     command (status), TickDone n
//!     ... n + 1 ...
//!     End                             ->
//!                                    <-     Losses, Tally       what the controller's side of the bus lost
//! ```
//!
//! The identifiers are extended and have the lowest priority, so that no message of the vehicle can be mistaken for one.
//!
//! Bytes 1 and 2 are a check value (CRC-16/IBM-3740) over the sender, the [`Session`], the kind and the content. So a frame of another run on
//! the same bus, of a node that was restarted, or that somebody made up is not taken for one of this run. The polynomial is public: this
//! guards against mistakes, not against somebody who has listened from the handshake on.

use crc::{CRC_16_IBM_3740, Crc};
use strum::{EnumString, IntoStaticStr, VariantNames};

use crate::Frame;
use crate::frame::extended;

/// Which node a sync frame comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString, IntoStaticStr, VariantNames)]
#[strum(serialize_all = "lowercase")]
pub enum Role {
    /// The plant: sensors, vehicle and valves.
    Plant,
    /// The node with the suspension controller.
    Controller,
}

impl Role {
    /// The other node of the loop.
    pub fn other(self) -> Self {
        match self {
            Self::Plant => Self::Controller,
            Self::Controller => Self::Plant,
        }
    }

    /// As on the command line: `plant` or `controller`.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

const PLANT_ID: u32 = 0x1FFF_01E0;
const CONTROLLER_ID: u32 = 0x1FFF_01E1;

/// Version of this exchange. Nodes of different versions do not understand each other.
const VERSION: u8 = 3;

/// Kinds of frames, in their first byte. A frame of another version has another kind.
const HELLO: u8 = VERSION << 4;
const TICK_DONE: u8 = HELLO + 1;
const END: u8 = HELLO + 2;
const LOSSES: u8 = HELLO + 3;
const TALLY: u8 = HELLO + 4;

const CHECK: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_3740);

/// Largest number that five bytes hold.
const FIVE_BYTES: u64 = (1 << 40) - 1;

/// A run of two nodes: each has drawn a number when it started. Both are 0 where the nodes need not find each other, because they run in
/// one process or on an emulated board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Session {
    /// The plant's number.
    pub plant: u16,
    /// The controller's number.
    pub controller: u16,
}

impl Session {
    /// The session in which a node's own number is the only one known.
    pub fn of(role: Role, number: u16) -> Self {
        let mut session = Self::default();
        *session.number_mut(role) = number;
        session
    }

    /// The number of a node.
    pub fn number(self, role: Role) -> u16 {
        match role {
            Role::Plant => self.plant,
            Role::Controller => self.controller,
        }
    }

    /// The same session with another number of a node.
    #[must_use]
    pub fn with(mut self, role: Role, number: u16) -> Self {
        *self.number_mut(role) = number;
        self
    }

    fn number_mut(&mut self, role: Role) -> &mut u16 {
        match role {
            Role::Plant => &mut self.plant,
            Role::Controller => &mut self.controller,
        }
    }
}

/// What the nodes must agree on before they start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terms {
    /// Number of the [`Strategy`](oleo_controller::Strategy), counted from 0, below 64.
    pub strategy: u8,
    /// Whether the run is in real time.
    pub real_time: bool,
    /// Digest of what the controller knows of the vehicle.
    pub vehicle: u16,
}

/// Content of a frame that keeps nodes in step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sync {
    /// The sender is ready for the handshake.
    Hello {
        /// What both must agree on.
        terms: Terms,
        /// Whether the sender has received a `Hello` of the receiver.
        heard: bool,
        /// The sender's number in the session.
        number: u16,
    },
    /// All frames of a tick are on the bus.
    TickDone {
        /// Number of the tick, modulo 2^24 (23 hours).
        tick: u32,
        /// Number of messages sent since the start, modulo 65536, without frames of this exchange.
        sent: u16,
    },
    /// The plant's run is over.
    End {
        /// Number of messages sent since the start.
        sent: u64,
    },
    /// The controller's answer to `End`, first part.
    Losses {
        /// Number of frames that did not reach the controller; it saturates at 2^24 - 1.
        lost: u32,
        /// Number of frames that failed the controller's end-to-end check; it saturates.
        e2e_errors: u16,
    },
    /// The controller's answer to `End`, last part.
    Tally {
        /// Number of messages sent since the start.
        sent: u64,
    },
}

/// What a frame is to a node that waits for its partner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decoded {
    /// A frame of the partner in this session.
    Partner(Sync),
    /// A frame with the partner's identifier that is none of this session.
    Stranger,
    /// A frame that has nothing to do with this exchange.
    Other,
}

/// Whether a frame belongs to this exchange, whoever sent it.
pub fn is_sync(frame: &Frame) -> bool {
    frame.is_extended() && matches!(frame.raw_id(), PLANT_ID | CONTROLLER_ID)
}

fn id_of(role: Role) -> u32 {
    match role {
        Role::Plant => PLANT_ID,
        Role::Controller => CONTROLLER_ID,
    }
}

/// Check value over sender, session, kind and content. A `Hello` belongs to no session yet.
fn check(role: Role, session: Session, kind: u8, content: [u8; 5]) -> [u8; 2] {
    let session = if kind == HELLO { Session::default() } else { session };
    let mut digest = CHECK.digest();
    digest.update(&id_of(role).to_le_bytes());
    digest.update(&session.plant.to_le_bytes());
    digest.update(&session.controller.to_le_bytes());
    digest.update(&[kind]);
    digest.update(&content);
    digest.finalize().to_le_bytes()
}

/// The low five bytes of a number, which saturates.
fn five_bytes(number: u64) -> [u8; 5] {
    let [a, b, c, d, e, ..] = number.min(FIVE_BYTES).to_le_bytes();
    [a, b, c, d, e]
}

impl Sync {
    /// The frame by which `role` sends this in a session.
    pub fn encode(self, role: Role, session: Session) -> Frame {
        let (kind, content) = match self {
            Self::Hello { terms, heard, number } => {
                let [[v0, v1], [n0, n1]] = [terms.vehicle, number].map(u16::to_le_bytes);
                let flags = terms.strategy << 2 | u8::from(terms.real_time) << 1 | u8::from(heard);
                (HELLO, [flags, v0, v1, n0, n1])
            }
            Self::TickDone { tick, sent } => {
                let ([t0, t1, t2, _], [s0, s1]) = (tick.to_le_bytes(), sent.to_le_bytes());
                (TICK_DONE, [t0, t1, t2, s0, s1])
            }
            Self::End { sent } => (END, five_bytes(sent)),
            Self::Losses { lost, e2e_errors } => {
                let ([l0, l1, l2, _], [e0, e1]) = (lost.min(0xFF_FFFF).to_le_bytes(), e2e_errors.to_le_bytes());
                (LOSSES, [l0, l1, l2, e0, e1])
            }
            Self::Tally { sent } => (TALLY, five_bytes(sent)),
        };
        let ([c0, c1], [a, b, c, d, e]) = (check(role, session, kind, content), content);
        Frame::whole(extended(id_of(role)), [kind, c0, c1, a, b, c, d, e])
    }

    /// What a frame is to a node that waits for `role` in a session.
    pub fn decode(frame: &Frame, role: Role, session: Session) -> Decoded {
        if !frame.is_extended() || frame.raw_id() != id_of(role) {
            return Decoded::Other;
        }
        let Ok(&[kind, c0, c1, a, b, c, d, e]) = <&[u8; 8]>::try_from(frame.data()) else {
            return Decoded::Stranger;
        };
        let content = [a, b, c, d, e];
        if [c0, c1] != check(role, session, kind, content) {
            return Decoded::Stranger;
        }
        Decoded::Partner(match kind {
            HELLO => Self::Hello {
                terms: Terms {
                    strategy: a >> 2,
                    real_time: a & 2 != 0,
                    vehicle: u16::from_le_bytes([b, c]),
                },
                heard: a & 1 != 0,
                number: u16::from_le_bytes([d, e]),
            },
            TICK_DONE => Self::TickDone {
                tick: u32::from_le_bytes([a, b, c, 0]),
                sent: u16::from_le_bytes([d, e]),
            },
            END => Self::End {
                sent: u64::from_le_bytes([a, b, c, d, e, 0, 0, 0]),
            },
            LOSSES => Self::Losses {
                lost: u32::from_le_bytes([a, b, c, 0]),
                e2e_errors: u16::from_le_bytes([d, e]),
            },
            TALLY => Self::Tally {
                sent: u64::from_le_bytes([a, b, c, d, e, 0, 0, 0]),
            },
            _ => return Decoded::Stranger,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HERE: Session = Session {
        plant: 7,
        controller: 0x1234,
    };

    proptest! {
        #[test]
        fn what_is_sent_is_understood_in_its_session_only(
            tick in 0u32..1 << 24, sent: u16, total in 0..=FIVE_BYTES, strategy in 0u8..64, real_time: bool, heard: bool, other: u16
        ) {
            let all = [
                Sync::TickDone { tick, sent },
                Sync::End { sent: total },
                Sync::Losses { lost: tick, e2e_errors: sent },
                Sync::Tally { sent: total },
            ];
            let hello = Sync::Hello { terms: Terms { strategy, real_time, vehicle: sent }, heard, number: other };
            for role in [Role::Plant, Role::Controller] {
                for sync in all {
                    let frame = sync.encode(role, HERE);
                    prop_assert!(is_sync(&frame));
                    prop_assert_eq!(Sync::decode(&frame, role, HERE), Decoded::Partner(sync));
                    prop_assert_eq!(Sync::decode(&frame, role.other(), HERE), Decoded::Other);
                    for node in [Role::Plant, Role::Controller] {
                        let elsewhere = HERE.with(node, other);
                        let known = elsewhere == HERE;
                        prop_assert_eq!(Sync::decode(&frame, role, elsewhere) == Decoded::Partner(sync), known);
                    }
                }
                let frame = hello.encode(role, Session::of(role, other));
                prop_assert_eq!(Sync::decode(&frame, role, HERE), Decoded::Partner(hello));
            }
        }

        #[test]
        fn a_frame_with_any_bit_changed_is_a_strangers(tick in 0u32..1 << 24, sent: u16, bit in 0usize..64) {
            let frame = Sync::TickDone { tick, sent }.encode(Role::Plant, HERE).with_flipped_bit(bit);
            prop_assert_eq!(Sync::decode(&frame, Role::Plant, HERE), Decoded::Stranger);
        }

        #[test]
        fn other_frames_are_not_taken(frame in crate::frame::tests::any_frame()) {
            prop_assume!(!is_sync(&frame));
            prop_assert_eq!(Sync::decode(&frame, Role::Plant, HERE), Decoded::Other);
        }
    }
}
