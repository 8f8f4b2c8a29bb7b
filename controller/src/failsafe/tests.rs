//! The numbers and tables of the mode machine's page, each by a test of its own.

extern crate std;
use super::*;
use oleo_interface::{Axle, Corner};
use std::string::String;

const SECOND: u32 = 200;

/// A fault at some corners.
fn at(corners: &[Corner]) -> Health {
    let mut health = Health {
        cause: FaultCode::SensorVote,
        ..Health::default()
    };
    for corner in corners {
        health.affected[*corner] = true;
    }
    health
}

fn healthy() -> Health {
    Health::default()
}

/// A machine that has been normal for a while.
fn normal() -> State {
    let mut state = State::default();
    for tick in 1..=40 {
        let mode = state.step(&healthy());
        assert_eq!(mode, if tick < 20 { Mode::StartUp } else { Mode::Normal });
        assert_eq!(state.was_normal(), tick >= 20);
    }
    state
}

/// Ticks of the same health until a mode is reached.
fn until(state: &mut State, health: &Health, mode: Mode) -> u32 {
    (1..=200 * SECOND)
        .find(|_| state.step(health) == mode)
        .expect("within 200 s")
}

#[test]
fn names_are_those_of_the_variants_in_kebab_case() {
    let kebab = |debug: String| {
        let mut name = String::new();
        for (n, letter) in debug.chars().enumerate() {
            if letter.is_uppercase() && n > 0 {
                name.push('-');
            }
            name.push(letter.to_ascii_lowercase());
        }
        name
    };
    for mode in Mode::VARIANTS {
        assert_eq!(mode.name(), kebab(std::format!("{mode:?}")));
    }
    for fault in FaultCode::VARIANTS {
        assert_eq!(fault.name(), kebab(std::format!("{fault:?}")));
    }
}

#[test]
fn health_is_good_without_a_cause_and_without_an_affected_corner() {
    assert!(healthy().is_good());
    assert!(!at(&[]).is_good());
    for corner in Corner::ALL {
        let mut health = healthy();
        health.affected[corner] = true;
        assert!(!health.is_good());
    }
}

#[test]
fn start_up_takes_twenty_healthy_ticks_in_a_row() {
    for corner in Corner::ALL {
        let mut state = State::default();
        for _ in 0..3 {
            assert!((0..19).all(|_| state.step(&healthy()) == Mode::StartUp));
            assert_eq!(state.step(&at(&[corner])), Mode::StartUp);
            assert_eq!(
                (state.first_cause(), state.was_normal()),
                (FaultCode::SensorVote, false)
            );
        }
        assert_eq!(until(&mut state, &healthy(), Mode::Normal), 20);
        assert_eq!((state.first_cause(), state.was_normal()), (FaultCode::None, true));
    }
}

#[test]
fn the_mode_counts_the_axles_with_a_fault() {
    for one in Corner::ALL {
        for other in Corner::ALL {
            let mut state = normal();
            let both = one.axle() != other.axle();
            let mode = state.step(&at(&[one, other]));
            assert_eq!(mode, if both { Mode::Safe } else { Mode::Degraded });
            let restricted = Axles::from_fn(|axle: Axle| one.axle() == axle || other.axle() == axle);
            assert_eq!(state.restricted(), restricted);
        }
    }
}

#[test]
fn the_first_cause_is_kept_until_all_is_well() {
    let mut state = normal();
    assert_eq!(state.first_cause(), FaultCode::None);
    state.step(&at(&[Corner::FrontLeft]));
    let later = Health {
        cause: FaultCode::BusSilent,
        ..at(&Corner::ALL)
    };
    state.step(&later);
    assert_eq!(state.first_cause(), FaultCode::SensorVote);
    until(&mut state, &healthy(), Mode::Normal);
    assert_eq!(state.first_cause(), FaultCode::None);
}

/// 1, 4, 16, 64 s, and 64 s from then on.
#[test]
fn recovery_takes_four_times_as_long_each_time() {
    for corner in [Corner::FrontRight, Corner::RearLeft] {
        let mut state = normal();
        for seconds in [1, 4, 16, 64, 64, 64] {
            assert_eq!(state.step(&at(&[corner])), Mode::Degraded);
            assert_eq!(until(&mut state, &healthy(), Mode::Normal), seconds * SECOND);
        }
    }
}

#[test]
fn recovery_begins_anew_with_each_faulty_tick() {
    let mut state = normal();
    state.step(&at(&[Corner::RearRight]));
    for _ in 0..5 {
        assert!((0..SECOND - 1).all(|_| state.step(&healthy()) == Mode::Degraded));
        assert_eq!(state.step(&at(&[Corner::RearRight])), Mode::Degraded);
    }
    // It was one restriction: the next recovery is the second.
    assert_eq!(until(&mut state, &healthy(), Mode::Normal), SECOND);
    state.step(&at(&[Corner::RearRight]));
    assert_eq!(until(&mut state, &healthy(), Mode::Normal), 4 * SECOND);
}

/// A minute without a restriction takes one of the recorded faults away.
#[test]
fn faults_are_forgotten_one_a_minute() {
    let cases = [(0, 16), (1, 4), (2, 1), (3, 1), (9, 1)];
    for ((minutes, recovery_s), corner) in cases
        .into_iter()
        .flat_map(|case| [(case, Corner::FrontLeft), (case, Corner::RearLeft)])
    {
        let mut state = normal();
        for _ in 0..2 {
            state.step(&at(&[corner]));
            until(&mut state, &healthy(), Mode::Normal);
        }
        // A tick of the first minute has passed with the recovery.
        for _ in 0..minutes * 60 * SECOND {
            assert_eq!(state.step(&healthy()), Mode::Normal);
        }
        state.step(&at(&[corner]));
        assert_eq!(
            until(&mut state, &healthy(), Mode::Normal),
            recovery_s * SECOND,
            "{minutes} minutes"
        );
    }
}

#[test]
fn just_less_than_a_minute_forgets_nothing() {
    let mut state = normal();
    state.step(&at(&[Corner::FrontLeft]));
    until(&mut state, &healthy(), Mode::Normal);
    for _ in 0..60 * SECOND - 2 {
        state.step(&healthy());
    }
    state.step(&at(&[Corner::FrontLeft]));
    assert_eq!(until(&mut state, &healthy(), Mode::Normal), 4 * SECOND);
}

#[test]
fn the_fifth_entry_into_safe_latches() {
    let mut state = normal();
    let all = at(&Corner::ALL);
    for seconds in [1, 4, 16, 64] {
        assert_eq!(state.step(&all), Mode::Safe);
        assert_eq!(until(&mut state, &healthy(), Mode::Normal), seconds * SECOND);
    }
    assert_eq!(state.step(&all), Mode::Latched);
    assert!(
        (0..100 * SECOND).all(|_| state.step(&healthy()) == Mode::Latched),
        "it stays so"
    );
    assert_eq!(state.first_cause(), FaultCode::SensorVote);
}

#[test]
fn entries_into_safe_that_are_more_than_a_minute_apart_never_latch() {
    let mut state = normal();
    for _ in 0..12 {
        assert_eq!(state.step(&at(&Corner::ALL)), Mode::Safe);
        until(&mut state, &healthy(), Mode::Normal);
        for _ in 0..61 * SECOND {
            state.step(&healthy());
        }
    }
}

/// Entries are forgotten one a minute too, also when no fault of an axle is remembered any more.
#[test]
fn entries_into_safe_are_forgotten_after_the_faults() {
    let mut state = normal();
    let (front, rear) = (at(&[Corner::FrontLeft]), at(&[Corner::RearLeft]));
    let both = at(&[Corner::FrontLeft, Corner::RearLeft]);
    // Two faults of each axle make three entries: rear under front twice, then front under rear.
    for health in [&both, &front, &both] {
        for _ in 0..5 * SECOND {
            state.step(health);
        }
    }
    for _ in 0..3 * SECOND {
        state.step(&rear);
    }
    assert_eq!(state.step(&both), Mode::Safe);
    until(&mut state, &healthy(), Mode::Normal);
    for _ in 0..5 * 60 * SECOND {
        assert_eq!(state.step(&healthy()), Mode::Normal);
    }
    for seconds in [1, 4, 16, 64] {
        assert_eq!(state.step(&both), Mode::Safe);
        assert_eq!(until(&mut state, &healthy(), Mode::Normal), seconds * SECOND);
    }
}

/// While one axle recovers, a fault of the other alone does not count as severe.
#[test]
fn a_fault_on_one_axle_does_not_latch_while_the_other_recovers() {
    let mut state = normal();
    let (front, rear) = (at(&[Corner::FrontLeft]), at(&[Corner::RearLeft]));
    for _ in 0..2 {
        state.step(&rear);
        until(&mut state, &healthy(), Mode::Normal);
    }
    // The third recovery of the rear axle takes 16 s.
    for _ in 0..5 * SECOND {
        state.step(&at(&Corner::ALL));
    }
    for _ in 0..15 * SECOND {
        assert_eq!(state.step(&front), Mode::Safe);
    }
}

/// A fault on both axles latches after 10 s. One on a single axle in `Safe` does not.
#[test]
fn a_lasting_fault_on_both_axles_latches() {
    let mut state = normal();
    assert_eq!(until(&mut state, &at(&Corner::ALL), Mode::Latched), 10 * SECOND + 1);

    let mut state = normal();
    for _ in 0..5 * SECOND {
        state.step(&at(&Corner::ALL));
    }
    for _ in 0..15 * SECOND {
        assert_ne!(state.step(&at(&[Corner::FrontLeft])), Mode::Latched);
    }
    assert_eq!(state.step(&at(&Corner::ALL)), Mode::Safe, "a new entry counts anew");
    assert_eq!(until(&mut state, &at(&Corner::ALL), Mode::Latched), 10 * SECOND);
}

#[test]
fn a_solenoid_or_an_internal_fault_latches_at_once_from_every_mode() {
    for cause in [FaultCode::Solenoid, FaultCode::Internal] {
        let terminal = Health { cause, ..healthy() };
        let mut degraded = normal();
        degraded.step(&at(&[Corner::FrontLeft]));
        let mut safe = normal();
        safe.step(&at(&Corner::ALL));
        for mut state in [State::default(), normal(), degraded, safe] {
            assert_eq!(state.step(&terminal), Mode::Latched);
            assert_eq!(state.first_cause(), cause, "even if there was another one before");
            assert_eq!(state.step(&healthy()), Mode::Latched);
        }
    }
}

#[test]
fn a_latch_from_before_a_restart_holds() {
    let mut state = State::latched(FaultCode::BusSilent);
    assert_eq!(state.first_cause(), FaultCode::BusSilent);
    assert!((0..50).all(|_| state.step(&healthy()) == Mode::Latched));
    assert_eq!(state.first_cause(), FaultCode::BusSilent);
}

#[test]
fn each_mode_permits_what_its_row_says() {
    for word in [0xFFF, 0xA53, 0x5AC, 0x924, 0x6DB] {
        let wanted = ValveCommand::from_word(word);
        for front in [false, true] {
            for rear in [false, true] {
                let restricted = Axles::new(front, rear);
                let given = |mode| permitted(mode, restricted, wanted).word();
                assert_eq!(given(Mode::Normal), word);
                for mode in [Mode::StartUp, Mode::Safe, Mode::Latched] {
                    assert_eq!(given(mode), 0);
                }
                // The front axle has the low six bits; valve 3 is the highest of each three.
                let axles = if front { 0 } else { 0b000_000_011_011 } | if rear { 0 } else { 0b011_011_000_000 };
                assert_eq!(given(Mode::Degraded), word & axles);
            }
        }
    }
}
