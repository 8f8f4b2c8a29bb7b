//! The handshake by which two nodes find each other on a bus, in either order, and agree on the run.
//!
//! Each repeats its `Hello` until it has received the other's and knows that its own was received.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::time::{Duration, Instant};

use crate::bus::{Bus, BusError};
use crate::sync::{Decoded, Role, Session, Sync, Terms};

/// Why two nodes did not start a run together.
#[derive(Debug, thiserror::Error)]
pub enum HandshakeError {
    /// The other node did not answer.
    #[error("no {} answers on {bus} within {waited_s:.0} s: start `oleo hil --node {} --bus {bus}` as well", .partner.name(), .partner.name())]
    Alone {
        /// The node that was expected.
        partner: Role,
        /// Address of the bus.
        bus: String,
        /// Time for which it was waited for, s.
        waited_s: f64,
    },
    /// The two nodes want different runs.
    #[error("the {} on {bus} runs another {what}: give both nodes the same scenario, --strategy, --clock, --vehicle, --handling and --strut", .partner.name())]
    Terms {
        /// The node that answered.
        partner: Role,
        /// Address of the bus.
        bus: String,
        /// What differs: `strategy`, `clock` or `vehicle`.
        what: &'static str,
    },
    /// The bus failed during the handshake.
    #[error(transparent)]
    Bus(#[from] BusError),
}

/// Pause between two `Hello`s.
const HELLO_PERIOD: Duration = Duration::from_millis(50);

/// A partner that is running answers sooner.
const SAID_AFTER: Duration = Duration::from_secs(1);

/// Finds the partner, whichever was started first. Returns the session, in which all further frames are. `waiting` is called once if the
/// partner does not answer within a second.
///
/// # Errors
/// The partner did not answer within `patience`, wants another run, or the bus failed.
pub fn handshake(
    bus: &mut dyn Bus,
    name: &str,
    role: Role,
    terms: Terms,
    patience: Duration,
    waiting: &mut dyn FnMut(),
) -> Result<Session, HandshakeError> {
    let partner = role.other();
    let started = Instant::now();
    let mut session = Session::of(role, drawn());
    let number = session.number(role);
    let (mut heard, mut is_heard) = (false, false);
    let mut said = false;
    while !(heard && is_heard) {
        if started.elapsed() > SAID_AFTER && !core::mem::replace(&mut said, true) {
            waiting();
        }
        if started.elapsed() > patience {
            return Err(HandshakeError::Alone {
                partner,
                bus: name.into(),
                waited_s: patience.as_secs_f64(),
            });
        }
        bus.send(&Sync::Hello { terms, heard, number }.encode(role, session))?;
        let pause = Instant::now() + HELLO_PERIOD;
        while !(heard && is_heard) {
            let left = pause.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            let Some(frame) = bus.receive(left)? else { break };
            let Decoded::Partner(Sync::Hello {
                terms: theirs,
                heard: theirs_heard,
                number: theirs_number,
            }) = Sync::decode(&frame, partner, session)
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
            if theirs.real_time != terms.real_time {
                return Err(differs("clock"));
            }
            if theirs.vehicle != terms.vehicle {
                return Err(differs("vehicle"));
            }
            // A node that is started again while this one waits has another number, and has not heard this one.
            if heard && theirs_number != session.number(partner) {
                (heard, is_heard) = (false, false);
            }
            session = session.with(partner, theirs_number);
            is_heard |= theirs_heard;
            if !std::mem::replace(&mut heard, true) {
                break; // say so at once
            }
        }
    }
    // The partner may not know yet that its own `Hello` was received.
    let heard = true;
    bus.send(&Sync::Hello { terms, heard, number }.encode(role, session))?;
    Ok(session)
}

/// A number that another start of a node hardly has again. It is in no result. The standard library seeds its hash maps from the
/// operating system's randomness.
fn drawn() -> u16 {
    RandomState::new().build_hasher().finish() as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_find_each_other_in_either_order() {
        let terms = Terms {
            strategy: 2,
            real_time: false,
            vehicle: 7,
        };
        for late in [Role::Plant, Role::Controller] {
            let (mut a, mut b) = crate::bus::in_process_pair();
            std::thread::scope(|scope| {
                let early = scope.spawn(move || {
                    let session = handshake(&mut a, "x", late.other(), terms, Duration::from_secs(20), &mut || {});
                    // The end lives until the other node has read from it.
                    (session, a)
                });
                std::thread::sleep(Duration::from_millis(120));
                let session = handshake(&mut b, "x", late, terms, Duration::from_secs(20), &mut || {}).unwrap();
                assert_eq!(early.join().unwrap().0.unwrap(), session);
            });
        }
    }

    #[test]
    fn a_node_alone_or_with_other_terms_says_so() {
        let terms = Terms {
            strategy: 2,
            real_time: false,
            vehicle: 7,
        };
        let (mut a, mut b) = crate::bus::in_process_pair();
        let alone = handshake(
            &mut a,
            "socketcan:vcan0",
            Role::Plant,
            terms,
            Duration::from_millis(60),
            &mut || {},
        );
        assert!(
            alone
                .unwrap_err()
                .to_string()
                .contains("oleo hil --node controller --bus socketcan:vcan0")
        );
        for (others, what) in [
            (Terms { strategy: 1, ..terms }, "another strategy"),
            (
                Terms {
                    real_time: true,
                    ..terms
                },
                "another clock",
            ),
            (Terms { vehicle: 8, ..terms }, "another vehicle"),
        ] {
            let hello = Sync::Hello {
                terms: others,
                heard: false,
                number: 5,
            };
            b.send(&hello.encode(Role::Controller, Session::default())).unwrap();
            let other = handshake(&mut a, "x", Role::Plant, terms, Duration::from_secs(9), &mut || {}).unwrap_err();
            assert!(other.to_string().contains(what), "{other}");
        }
    }
}
