//! Plans of faults, drawn at random: every mode and every fault is reached, and whatever goes wrong, the rules of the safe state hold.
//!
//! The rules are tested too: each of them finds a violation that is planted for it.

#[path = "../../fuzz/src/fault_plan/mod.rs"]
mod fault_plan;

use fault_plan::{BYTES_OF_EVENT, BYTES_OF_HEADER, Broken, Observation, Plan, Reached, Rule, drive};
use oleo_controller::{FaultCode, Mode};
use rand::{Rng as _, RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// The plan with a number, the same in every run.
fn plan(number: u64) -> Plan {
    let mut random = ChaCha8Rng::seed_from_u64(number);
    let events = random.random_range(1..10);
    let mut bytes = vec![0; BYTES_OF_HEADER + events * BYTES_OF_EVENT];
    random.fill_bytes(&mut bytes);
    Plan::from_bytes(&bytes).expect("enough bytes")
}

/// Runs the plans with these numbers.
fn run(numbers: impl Iterator<Item = u64>) -> Reached {
    let mut reached = Reached::default();
    for number in numbers {
        match drive(&plan(number), |_| {}) {
            Ok(more) => reached += more,
            Err(broken) => panic!("plan {number}: {broken:#?}\n{:#?}", plan(number)),
        }
    }
    reached
}

/// Every number on the bus that has a meaning was seen.
fn assert_all_reached(reached: &Reached) {
    for (number, ticks) in (0_u8..).zip(reached.modes) {
        assert!(ticks > 0, "never in mode {:?}: {reached:?}", Mode::from_repr(number));
    }
    for (number, ticks) in (0_u8..).zip(reached.faults) {
        assert!(
            ticks > 0,
            "never under fault {:?}: {reached:?}",
            FaultCode::from_repr(number)
        );
    }
    assert_eq!(
        (Mode::from_repr(5), FaultCode::from_repr(12)),
        (None, None),
        "a new one is not counted"
    );
}

#[test]
fn every_mode_and_fault_is_reached_and_no_rule_is_broken() {
    let reached = run(0..200);
    assert_all_reached(&reached);
}

/// In the first three a command was lost, and a forged one beside the right one passed for it, thousands of ticks later or in the next
/// one: it opened all valves in `Latched`. In the last two a rule was too strict: a reading was missing in a right frame that was refused,
/// because a forged one with its counter had come before it; and two readings of a strut were missing for two ticks each, but not together.
#[test]
fn plans_that_have_broken_a_rule() {
    run([10_001_135, 10_001_698, 10_303_030, 1_007_716, 1_062_940].into_iter());
}

/// `OLEO_FAULT_TICKS=1000000000 cargo test --release -p oleo-controller --test fault_plans -- --ignored --nocapture`
#[test]
#[ignore = "runs for as many ticks as OLEO_FAULT_TICKS says, on all cores"]
fn as_many_ticks_as_one_likes() {
    let setting =
        |name: &str, default: u64| std::env::var(name).map_or(default, |text| text.parse().expect("a number"));
    let (most, first) = (
        setting("OLEO_FAULT_TICKS", 10_000_000),
        setting("OLEO_FAULT_FIRST", 1_000_000),
    );
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let share = move |thread: u64| {
        let (mut reached, mut number) = (Reached::default(), first + thread);
        while reached.ticks < most / threads {
            reached += run(core::iter::once(number));
            number += threads;
        }
        reached
    };
    let mut reached = Reached::default();
    let workers: Vec<_> = (0..threads)
        .map(|thread| std::thread::spawn(move || share(thread)))
        .collect();
    for worker in workers {
        reached += worker.join().expect("no rule is broken");
    }
    println!("{} ticks, no rule broken", reached.ticks);
    for (number, ticks) in (0_u8..).zip(reached.modes) {
        println!("{:>16} {ticks}", Mode::from_repr(number).map_or("", Mode::name));
    }
    for (number, ticks) in (0_u8..).zip(reached.faults) {
        println!(
            "{:>16} {ticks}",
            FaultCode::from_repr(number).map_or("", FaultCode::name)
        );
    }
    assert_all_reached(&reached);
}

/// The rule that a planted violation breaks in the first plan that gives it the occasion.
fn found(mut violation: impl FnMut(&mut Observation)) -> Option<Rule> {
    (0..200).find_map(|number| match drive(&plan(number), &mut violation) {
        Err(Broken { rule, .. }) => Some(rule),
        Ok(_) => None,
    })
}

/// Opens and closes the first valve every so many ticks, after a healthy start.
fn chatter(word: &mut u16, tick: u32, period: u32) {
    if tick > 100 {
        *word = *word & !1 | u16::from(tick / period % 2 == 1);
    }
}

#[test]
fn each_rule_finds_the_violation_that_is_planted_for_it() {
    for rule in Rule::ALL {
        let mut held = None;
        let found = found(|seen| match rule {
            Rule::ClosedModeIsClosed if seen.mode == Mode::Latched => seen.commanded |= 0x800,
            Rule::OutputStageCloses if seen.mode == Mode::Safe => seen.driven = *held.get_or_insert(seen.driven | 1),
            Rule::OutputStageTimesOut if seen.commands_silent == 4 && seen.mode == Mode::Normal => seen.driven |= 1,
            Rule::WordIsLegal if seen.mode == Mode::Degraded => seen.commanded |= 0b1_000_001,
            Rule::CommandDoesNotChatter if seen.mode == Mode::Normal => chatter(&mut seen.commanded, seen.tick, 19),
            Rule::DriveDoesNotChatter if seen.mode == Mode::Normal => chatter(&mut seen.driven, seen.tick, 19),
            Rule::ModeDoesNotChatter if seen.mode == Mode::Degraded && seen.tick % 600 < 300 => {
                (seen.mode, seen.commanded, seen.driven) = (Mode::Safe, 0, 0);
            }
            Rule::LatchHolds if seen.mode == Mode::Latched && seen.tick % 64 == 0 => {
                (seen.mode, seen.fault) = (Mode::Safe, FaultCode::MessageLost);
            }
            Rule::FaultIsNamed if seen.mode == Mode::Safe => seen.fault = FaultCode::None,
            Rule::ArithmeticIsFinite if seen.mode == Mode::Normal && seen.tick > 200 => seen.finite = false,
            Rule::SilenceCloses if seen.sensors_silent >= 4 && seen.mode == Mode::Safe => seen.mode = Mode::Degraded,
            Rule::ForeignSenderCloses if seen.own_identifier && seen.mode == Mode::Safe => seen.mode = Mode::Degraded,
            Rule::SolenoidLatches if seen.solenoid_failed => seen.mode = Mode::Safe,
            Rule::MissingReadingRestricts if seen.reading_missing == 3 && seen.mode == Mode::Degraded => {
                (seen.mode, seen.fault) = (Mode::Normal, FaultCode::None);
            }
            _ => {}
        });
        assert_eq!(found, Some(rule));
    }
}
