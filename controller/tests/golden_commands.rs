//! The valve words of a recorded drive, the same in every build profile, on every machine.
//!
//! The drive is made of f32 arithmetic and `libm` only: rough road, a lane change, a better road, so that every strategy part acts.
//! `OLEO_BLESS=1 cargo test -p oleo-controller --test golden_commands` rewrites the file after an intended change.

mod common;

use common::{AREA_M2, QuietStrut, STATIC_PA, rough_road};
use oleo_controller::{
    Builder, Corner, Corners, DamperPolicy, Gauge, Inputs, Side, State, Strategy, StrutPressures, Valve, ValveCommand,
    tick,
};

const TICKS: u32 = 4000;

/// Displacement with a lane change between 8 s and 12 s: body roll of a quarter hertz, with its load transfer.
fn drive(tick_number: u32, struts: &mut Corners<QuietStrut>, command: ValveCommand) -> Inputs {
    let t = tick_number as f32 * 0.005;
    let lane_change = (1600..2400).contains(&tick_number);
    // Displacements are imposed here, and a strut that is still stiff would answer a rough road with forces no body would stand.
    let level = if tick_number < 1600 { 1.0 } else { 0.1 };
    let rough = rough_road(tick_number);
    let lateral = if lane_change {
        libm::sinf(6.283_185_5 * 0.25 * (t - 8.0))
    } else {
        0.0
    };
    let mut displacement = Corners::splat(0.0);
    let mut pressure = Corners::<StrutPressures<Gauge<f32>>>::default();
    for corner in Corner::ALL {
        let side = if corner.side() == Side::Left { -1.0 } else { 1.0 };
        let open = command.is_open(corner, Valve::Spring);
        displacement[corner] = level * rough[corner] + 0.006 * side * lateral;
        // A body on stiff springs settles where the trapped oil lets it.
        if tick_number >= 2400 && !open {
            displacement[corner] += struts[corner].rest_m();
        }
        pressure[corner] = struts[corner].pressures(displacement[corner], open);
        // The damper's share of p1, and the strut's share of the load transfer at the given roll.
        let damping = 0.3e6 * libm::cosf(8.2 * t + corner.index() as f32);
        let p1 = &mut pressure[corner].p1;
        *p1 = Gauge((p1.pa() + damping * 0.2).max(0.1 * STATIC_PA) + 1500.0 * side * lateral / AREA_M2);
    }
    Inputs::from_values(displacement, pressure)
}

fn words(strategy: Strategy, policy: DamperPolicy) -> Vec<u16> {
    let mut builder = Builder {
        strategy,
        ..Builder::default()
    };
    builder.tuning.strategy.ride_handling.dampers.policy = policy;
    builder.tuning.strategy.road_and_dampers.dampers.policy = policy;
    let configuration = builder.build().unwrap();
    let (mut state, mut struts) = (State::new(), Corners::splat(QuietStrut::default()));
    let mut command = ValveCommand::SAFE;
    (0..TICKS)
        .map(|n| {
            let inputs = drive(n, &mut struts, command);
            command = tick(&configuration, &mut state, &inputs).command;
            command.word()
        })
        .collect()
}

/// Run lengths: `word x ticks`, a line each, readable in a diff.
fn run_lengths(words: &[u16]) -> String {
    let mut text = String::new();
    let mut rest = words;
    while let Some(&word) = rest.first() {
        let n = rest.iter().take_while(|&&w| w == word).count();
        text += &format!("{word:03x} {n}\n");
        rest = &rest[n..];
    }
    text
}

fn check(name: &str, strategy: Strategy, policy: DamperPolicy) -> Vec<u16> {
    let path = format!("{}/tests/golden/{name}.words", env!("CARGO_MANIFEST_DIR"));
    let words = words(strategy, policy);
    let text = run_lengths(&words);
    if std::env::var_os("OLEO_BLESS").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let golden = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        text == golden,
        "{name}: command sequence changed; if intended: OLEO_BLESS=1 cargo test -p oleo-controller"
    );
    words
}

#[test]
fn always_soft_and_always_stiff() {
    let soft = check("always-soft", Strategy::AlwaysSoft, DamperPolicy::Karnopp);
    assert_eq!(soft.last(), Some(&0xFFF));
    let stiff = check("always-stiff", Strategy::AlwaysStiff, DamperPolicy::Karnopp);
    assert!(stiff.iter().all(|&word| word == 0));
}

#[test]
fn ride_handling() {
    for (name, policy) in [
        ("ride-handling-low", DamperPolicy::Low),
        ("ride-handling-karnopp", DamperPolicy::Karnopp),
        ("ride-handling-hoelscher-huang", DamperPolicy::HoelscherHuang),
    ] {
        let words = check(name, Strategy::RideHandling, policy);
        let soft = |tick: usize| words[tick] & 0b100_100_100_100;
        assert_eq!(soft(1500), 0b100_100_100_100, "{name}: soft on the rough road");
        assert_eq!(soft(2100), 0, "{name}: stiff in the lane change");
        assert_eq!(soft(3900), 0b100_100_100_100, "{name}: soft again");
    }
}

#[test]
fn road_and_cornering() {
    let words = check("road-and-cornering", Strategy::RoadAndCornering, DamperPolicy::Karnopp);
    assert_eq!(
        words[1500] & 0b100_100_100_100,
        0b100_100_100_100,
        "soft on the rough road"
    );
    assert_eq!(words[2100], 0, "stiff in the lane change");
}

#[test]
fn dampers_on_rough_roads() {
    for (name, strategy, policy) in [
        (
            "road-and-dampers-nell-steyn",
            Strategy::RoadAndDampers,
            DamperPolicy::NellSteyn,
        ),
        ("predictive", Strategy::Predictive, DamperPolicy::Karnopp),
    ] {
        let words = check(name, strategy, policy);
        let soft = |tick: usize| words[tick] & 0b100_100_100_100;
        assert_eq!(soft(1500), 0b100_100_100_100, "{name}: soft on the rough road");
        assert_eq!(words[2100], 0, "{name}: stiff in the lane change");
    }
}
