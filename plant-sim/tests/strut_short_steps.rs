//! Short steps: of an instant, because a step ends where a valve begins or ends to move, and while the main chamber settles.

use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Effects, Strut, StrutModel};

const SOFT: StrutValves<bool> = StrutValves::new(true, true, true);

/// What a long step of a coarse motion leaves of the rod's stroke is micrometres. In an incompressible chamber they would be a blow if the next
/// step supplied them within an instant.
#[test]
fn a_step_of_an_instant_is_no_blow() {
    let mut model = StrutModel::defender110(8000.0);
    model.effects = Effects::default();
    let mut strut = Strut::at_rest(&model, SOFT).unwrap();
    // Both moves are longer than the speeds of nothing say.
    let before = strut.advance_with_speeds(2e-6, 0.0, 0.0, 0.02, SOFT).pressure_pa;
    let after = strut.advance_with_speeds(4e-6, 0.0, 0.0, 2e-7, SOFT).pressure_pa;
    for (before, after) in before.into_iter().zip(after) {
        assert!((after - before).abs() < 1e5, "{before} {after}");
    }
    // And the stroke is not lost: it is supplied in the end.
    let slow = strut.advance_with_speeds(4e-6, 0.0, 0.0, 0.1, SOFT);
    let settled = strut.advance_with_speeds(4e-6, 0.0, 0.0, 0.1, SOFT).pressure_pa[0];
    assert!(settled > before[0] && (settled - slow.pressure_pa[0]).abs() < 100.0);
}

/// How the drops change within an instant says nothing of the step behind it: if that is long, its start is predicted with more oil than the
/// accumulator holds, and it must find back to the pressure of the gas.
#[test]
fn a_long_step_after_an_instant_finds_the_gas() {
    let mut model = StrutModel::defender110(7686.0);
    model.accumulator[0].static_gas_volume_m3 = 1e-4;
    let stiff = StrutValves::new(true, true, false);
    let mut strut = Strut::at_rest(&model, stiff).unwrap();
    let slow = |k: f64| 2.5e-4 * k;
    for k in 1..=120 {
        strut.advance_with_speeds(slow(f64::from(k)), 0.005, 0.005, 0.05, stiff);
    }
    let before = strut.output().pressure_pa[0];
    for speed_m_s in [0.01, 0.05, 0.5, -0.05, -0.5] {
        let mut strut = strut.clone();
        let turn_m = 0.03 + 4e-6 * speed_m_s;
        strut.advance_with_speeds(turn_m, speed_m_s, speed_m_s, 4e-6, stiff);
        for k in 1..=20 {
            let out = strut.advance_with_speeds(turn_m - slow(f64::from(k)), -0.005, -0.005, 0.05, stiff);
            assert!(
                (out.pressure_pa[0] / before - 1.0).abs() < 0.5,
                "{speed_m_s} m/s, step {k}: {} after {before} Pa",
                out.pressure_pa[0]
            );
        }
    }
}

/// p1 behind a stroke of 0.5 m/s on closed valves that ends within 5 ms, 5 ms apart, Pa: told in intervals of this many milliseconds.
fn behind_a_stroke(interval_ms: u32) -> Vec<f64> {
    const FAST_UNTIL_S: f64 = 0.03;
    const STANDS_FROM_S: f64 = 0.035;
    let closed = StrutValves::default();
    let mut strut = Strut::at_rest(&StrutModel::defender110(8000.0), closed).unwrap();
    let left = |t_s: f64| ((STANDS_FROM_S - t_s) / (STANDS_FROM_S - FAST_UNTIL_S)).clamp(0.0, 1.0);
    let speed = |t_s: f64| 0.5 * left(t_s);
    let position = |t_s: f64| {
        let braking_s = (t_s - FAST_UNTIL_S).clamp(0.0, STANDS_FROM_S - FAST_UNTIL_S);
        0.5 * (t_s.min(FAST_UNTIL_S) + 0.5 * braking_s * (1.0 + left(t_s)))
    };
    let h = 1e-3 * f64::from(interval_ms);
    let told: Vec<(u32, f64)> = (1..=60 / interval_ms)
        .map(|k| {
            let end_s = h * f64::from(k);
            let out = strut.advance_with_speeds(position(end_s), speed(end_s - h), speed(end_s), h, closed);
            (k * interval_ms, out.pressure_pa[0])
        })
        .collect();
    let stands = told.into_iter().filter(|(ms, _)| *ms > 35 && ms.is_multiple_of(5));
    stands.map(|(_, p1_pa)| p1_pa).collect()
}

/// The main chamber settles within milliseconds, also where the rod is slow again.
#[test]
fn what_a_stroke_leaves_is_followed_where_the_motion_is_slow_again() {
    let (short, long) = (behind_a_stroke(1), behind_a_stroke(5));
    for (short, long) in short.iter().zip(&long) {
        assert!((long - short).abs() < 100.0, "{long} {short} Pa");
    }
}
