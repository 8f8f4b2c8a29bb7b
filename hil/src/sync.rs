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
//!                                    <-     Tally               what the controller's side of the bus lost
//! ```
//!
//! The identifiers are extended and have the lowest priority, so that no message of the vehicle can be mistaken for one.

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

/// Version of this exchange. Nodes of different versions do not start.
const VERSION: u8 = 2;

/// What the nodes must agree on before they start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terms {
    /// Number of the [`Strategy`](oleo_controller::Strategy), counted from 0.
    pub strategy: u8,
    /// Number of the clock: 0 lockstep, 1 real time.
    pub clock: u8,
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
    },
    /// All frames of a tick are on the bus.
    TickDone {
        /// Number of the tick.
        tick: u32,
        /// Number of messages sent since the start, modulo 65536, without frames of this exchange.
        sent: u16,
    },
    /// The plant's run is over.
    End {
        /// Number of messages sent, as in `TickDone`.
        sent: u16,
    },
    /// The controller's answer to `End`.
    Tally {
        /// Number of messages sent, as in `TickDone`.
        sent: u16,
        /// Number of frames that did not reach the controller; it saturates.
        lost: u16,
        /// Number of frames that failed the controller's end-to-end check; it saturates.
        e2e_errors: u16,
    },
}

/// Whether a frame belongs to this exchange, whoever sent it.
pub fn is_sync(frame: &Frame) -> bool {
    frame.is_extended() && matches!(frame.raw_id(), PLANT_ID | CONTROLLER_ID)
}

impl Sync {
    /// The frame by which `role` sends this.
    pub fn encode(self, role: Role) -> Frame {
        let id = match role {
            Role::Plant => PLANT_ID,
            Role::Controller => CONTROLLER_ID,
        };
        let [t0, t1, t2, t3];
        let data = match self {
            Self::Hello { terms, heard } => {
                let [v0, v1] = terms.vehicle.to_le_bytes();
                [1, VERSION, u8::from(heard), terms.strategy, terms.clock, v0, v1, 0]
            }
            Self::TickDone { tick, sent } => {
                [t0, t1, t2, t3] = tick.to_le_bytes();
                let [s0, s1] = sent.to_le_bytes();
                [2, 0, s0, s1, t0, t1, t2, t3]
            }
            Self::End { sent } => {
                let [s0, s1] = sent.to_le_bytes();
                [3, 0, s0, s1, 0, 0, 0, 0]
            }
            Self::Tally { sent, lost, e2e_errors } => {
                let [[s0, s1], [l0, l1], [e0, e1]] = [sent, lost, e2e_errors].map(u16::to_le_bytes);
                [4, 0, s0, s1, l0, l1, e0, e1]
            }
        };
        Frame::whole(extended(id), data)
    }

    /// The content of a frame sent by `role`; `None` for every other frame.
    pub fn decode(frame: &Frame, role: Role) -> Option<Self> {
        let id = match role {
            Role::Plant => PLANT_ID,
            Role::Controller => CONTROLLER_ID,
        };
        if !frame.is_extended() || frame.raw_id() != id {
            return None;
        }
        let &[kind, b1, b2, b3, b4, b5, b6, b7] = <&[u8; 8]>::try_from(frame.data()).ok()?;
        Some(match kind {
            1 if b1 == VERSION => Self::Hello {
                terms: Terms {
                    strategy: b3,
                    clock: b4,
                    vehicle: u16::from_le_bytes([b5, b6]),
                },
                heard: b2 != 0,
            },
            2 => Self::TickDone {
                tick: u32::from_le_bytes([b4, b5, b6, b7]),
                sent: u16::from_le_bytes([b2, b3]),
            },
            3 => Self::End {
                sent: u16::from_le_bytes([b2, b3]),
            },
            4 => Self::Tally {
                sent: u16::from_le_bytes([b2, b3]),
                lost: u16::from_le_bytes([b4, b5]),
                e2e_errors: u16::from_le_bytes([b6, b7]),
            },
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_sent_is_understood(tick: u32, sent: u16, strategy: u8, clock: u8, heard: bool) {
            let all = [
                Sync::Hello { terms: Terms { strategy, clock, vehicle: sent }, heard },
                Sync::TickDone { tick, sent },
                Sync::End { sent },
                Sync::Tally { sent, lost: strategy.into(), e2e_errors: tick as u16 },
            ];
            for sync in all {
                for role in [Role::Plant, Role::Controller] {
                    let frame = sync.encode(role);
                    prop_assert!(is_sync(&frame));
                    prop_assert_eq!(Sync::decode(&frame, role), Some(sync));
                    prop_assert_eq!(Sync::decode(&frame, role.other()), None);
                }
            }
        }

        #[test]
        fn other_frames_are_not_taken(frame in crate::frame::tests::any_frame()) {
            prop_assume!(!is_sync(&frame));
            prop_assert_eq!(Sync::decode(&frame, Role::Plant), None);
        }
    }
}
