//! Frames that keep two nodes in step. They are machinery of the simulation, not messages of the vehicle.
//!
//! A node in lockstep must know that the other has said all it has to say in a tick, also when a fault has eaten the
//! last message. So each ends its tick with a `TickDone` that no fault touches and that counts what was sent, which shows
//! frames that a slow reader lost. Wall-clock time decides nothing, except that a partner silent for seconds is gone.
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
//! Identifiers are extended and of the lowest priority, so no vehicle message can be mistaken for one.

use std::time::{Duration, Instant};

use strum::{EnumString, IntoStaticStr, VariantNames};

use crate::Frame;
use crate::bus::{Bus, BusError};
use crate::frame::extended;

/// Which node a sync frame comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString, IntoStaticStr, VariantNames)]
#[strum(serialize_all = "lowercase")]
pub enum Role {
    /// Sensors, vehicle and valves.
    Plant,
    /// The suspension controller.
    Controller,
}

impl Role {
    /// The node opposite.
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

/// Version of this exchange; nodes of different versions do not start.
const VERSION: u8 = 1;

/// What the nodes must agree on before they start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terms {
    /// Number of the [`Strategy`](oleo_controller::Strategy), counted from 0.
    pub strategy: u8,
    /// 0 lockstep, 1 real time.
    pub clock: u8,
}

/// Content of a sync frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sync {
    /// "I am here", and whether the other one was heard.
    Hello {
        /// What the run needs both to agree on.
        terms: Terms,
        /// The sender has had a `Hello` of the receiver.
        heard: bool,
    },
    /// All frames of a tick are on the bus.
    TickDone {
        /// Which tick.
        tick: u32,
        /// Frames sent since the start, modulo 65536, without sync frames.
        sent: u16,
    },
    /// The plant's run is over.
    End {
        /// As in `TickDone`.
        sent: u16,
    },
    /// The controller's answer to `End`.
    Tally {
        /// As in `TickDone`.
        sent: u16,
        /// Frames that did not reach the controller, saturating.
        lost: u16,
        /// Frames that failed its end-to-end check, saturating.
        e2e_errors: u16,
    },
}

/// Whether a frame belongs to this exchange, whoever sent it.
pub fn is_sync(frame: &Frame) -> bool {
    frame.is_extended() && matches!(frame.raw_id(), PLANT_ID | CONTROLLER_ID)
}

impl Sync {
    /// As a frame of `role`.
    pub fn encode(self, role: Role) -> Frame {
        let id = match role {
            Role::Plant => PLANT_ID,
            Role::Controller => CONTROLLER_ID,
        };
        let [t0, t1, t2, t3];
        let data = match self {
            Self::Hello { terms, heard } => [1, VERSION, u8::from(heard), terms.strategy, terms.clock, 0, 0, 0],
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

/// Why two nodes did not find together.
#[derive(Debug, thiserror::Error)]
pub enum HandshakeError {
    /// Nobody answered.
    #[error("no {} answers on {bus} within {waited_s:.0} s: start `oleo hil --node {} --bus {bus}` as well", .partner.name(), .partner.name())]
    Alone {
        /// Who was expected.
        partner: Role,
        /// Where.
        bus: String,
        /// For how long, s.
        waited_s: f64,
    },
    /// They want different runs.
    #[error("the {} on {bus} runs another {what}: give both nodes the same scenario, --strategy and --clock", .partner.name())]
    Terms {
        /// Who is there.
        partner: Role,
        /// Where.
        bus: String,
        /// What differs.
        what: &'static str,
    },
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
}

/// Pause between two `Hello`s.
const HELLO_PERIOD: Duration = Duration::from_millis(50);

/// Finds the partner, whichever was started first.
///
/// # Errors
/// Nobody there within `patience`, or somebody who wants another run.
pub fn handshake(
    bus: &mut dyn Bus,
    name: &str,
    role: Role,
    terms: Terms,
    patience: Duration,
) -> Result<(), HandshakeError> {
    let partner = role.other();
    let started = Instant::now();
    let (mut heard, mut is_heard) = (false, false);
    while !(heard && is_heard) {
        if started.elapsed() > patience {
            return Err(HandshakeError::Alone {
                partner,
                bus: name.into(),
                waited_s: patience.as_secs_f64(),
            });
        }
        bus.send(&Sync::Hello { terms, heard }.encode(role))?;
        let pause = Instant::now() + HELLO_PERIOD;
        while !(heard && is_heard) {
            let left = pause.saturating_duration_since(Instant::now());
            let Some(frame) = bus.receive(left)? else { break };
            let Some(Sync::Hello {
                terms: theirs,
                heard: theirs_heard,
            }) = Sync::decode(&frame, partner)
            else {
                continue;
            };
            let differs = |what| HandshakeError::Terms {
                partner,
                bus: name.into(),
                what,
            };
            if theirs.strategy != terms.strategy {
                return Err(differs("strategy"));
            }
            if theirs.clock != terms.clock {
                return Err(differs("clock"));
            }
            is_heard |= theirs_heard;
            if !std::mem::replace(&mut heard, true) {
                break; // say so at once
            }
        }
    }
    // The partner may not have heard that it was heard.
    bus.send(&Sync::Hello { terms, heard: true }.encode(role))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_sent_is_understood(tick: u32, sent: u16, strategy: u8, clock: u8, heard: bool) {
            let all = [
                Sync::Hello { terms: Terms { strategy, clock }, heard },
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

    #[test]
    fn nodes_find_each_other_in_either_order() {
        let terms = Terms { strategy: 2, clock: 0 };
        for late in [Role::Plant, Role::Controller] {
            let (mut a, mut b) = crate::bus::in_process_pair();
            std::thread::scope(|scope| {
                let early = scope
                    .spawn(move || handshake(&mut a, "x", late.other(), terms, Duration::from_secs(20)).map(|()| a));
                std::thread::sleep(Duration::from_millis(120));
                handshake(&mut b, "x", late, terms, Duration::from_secs(20)).unwrap();
                early.join().unwrap().unwrap();
            });
        }
    }

    #[test]
    fn a_node_alone_or_with_other_terms_says_so() {
        let terms = Terms { strategy: 2, clock: 0 };
        let (mut a, mut b) = crate::bus::in_process_pair();
        let alone = handshake(&mut a, "socketcan:vcan0", Role::Plant, terms, Duration::from_millis(60));
        assert!(
            alone
                .unwrap_err()
                .to_string()
                .contains("oleo hil --node controller --bus socketcan:vcan0")
        );
        b.send(
            &Sync::Hello {
                terms: Terms { strategy: 1, clock: 0 },
                heard: false,
            }
            .encode(Role::Controller),
        )
        .unwrap();
        let other = handshake(&mut a, "x", Role::Plant, terms, Duration::from_secs(9)).unwrap_err();
        assert!(other.to_string().contains("another strategy"), "{other}");
    }
}
