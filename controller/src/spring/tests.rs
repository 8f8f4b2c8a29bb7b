//! The rules of the module's page, one by one, against the equations in f64.

extern crate std;
use super::trapped_lean::DWELL_TICKS as DWELL_IN_BENDS_TICKS;
use super::*;
use crate::configuration::Configuration;
use crate::valves::BYPASS_BITS;

const SECOND: u32 = 200;
const LOAD_N: Corners<f32> = Corners::splat(3927.0);
const AREA_M2: f64 = 1.963_495_4e-3;
const ATMOSPHERE_PA: f64 = 101_325.0;

fn parameters() -> Parameters {
    Configuration::defender110().spring
}

/// Struts whose p1 to p3 and p4 are these, charged for 2 MPa.
fn under(p1_pa: f32, p4_pa: f32) -> Trusted {
    let mut pressure = StrutPressures::splat(Gauge(p1_pa));
    pressure.p4 = Gauge(p4_pa);
    Trusted {
        pressure: Corners::splat(pressure),
        charge: Corners::splat(Absolute(2_101_325.0)),
        ..Trusted::default()
    }
}

fn at_rest() -> Trusted {
    under(2.0e6, 2.0e6)
}

/// Only these valves 3.
fn only(corners: &[Corner]) -> ValveCommand {
    ValveCommand::from_word(corners.iter().fold(0, |word, corner| word | bit(*corner)))
}

/// Springs that have rested for a second under some pressures.
fn rested(trusted: &Trusted) -> Springs {
    let mut springs = Springs::default();
    for _ in 0..SECOND {
        springs.step(&parameters(), trusted, &LOAD_N, ValveCommand::SAFE, Urgency::Comfort);
    }
    springs
}

/// Springs of which some have been open for a second.
fn opened(corners: &[Corner]) -> Springs {
    let mut springs = rested(&at_rest());
    for _ in 0..SECOND {
        springs.step(&parameters(), &at_rest(), &LOAD_N, only(corners), Urgency::Comfort);
    }
    assert_eq!(springs.open, only(corners).word());
    springs
}

/// The tick in which the open valves change to others, of at most ten seconds.
fn changes(springs: &mut Springs, trusted: &Trusted, wanted: ValveCommand, urgency: Urgency) -> Option<u32> {
    let before = springs.open;
    (1..=10 * SECOND).find(|_| springs.step(&parameters(), trusted, &LOAD_N, wanted, urgency).word() != before)
}

#[test]
fn the_force_step_and_the_trapped_shift_are_those_of_the_gas() {
    let (v1, v2) = (
        f64::from(parameters().gas_volume_1_m3),
        f64::from(parameters().gas_volume_2_m3),
    );
    for (p1_pa, p4_pa) in [(2.0e6, 2.5e6), (3.1e6, 1.4e6), (0.7e6, 5.0e6)] {
        let springs = rested(&under(p1_pa, p4_pa));
        let [p1, p4] = [p1_pa, p4_pa].map(|p| f64::from(p) + ATMOSPHERE_PA);
        let (left_over, behind) = (v1 * 2_101_325.0 / p1, v2 * 2_101_325.0 / p4);
        let common = (left_over * p1 + behind * p4) / (left_over + behind);
        // What the gas of the second accumulator was charged with does not matter for the step: as the page of the module has it.
        let step_n = AREA_M2 * (p4 - p1) * v2 * p1 / (v1 * p4 + v2 * p1);
        assert!(
            (AREA_M2 * (common - p1) - step_n).abs() < 1.0,
            "the page's two forms agree"
        );
        let shift_m = (v2 - behind) / AREA_M2;
        for corner in Corner::ALL {
            let found_n = f64::from(springs.valves[corner].opening_step_n);
            assert!(
                (found_n - step_n).abs() < 1e-3 * step_n.abs(),
                "{found_n} N, expected {step_n}"
            );
            let found_m = f64::from(springs.trapped_shift_m()[corner]);
            assert!(
                (found_m - shift_m).abs() < 1e-3 * shift_m.abs(),
                "{found_m} m, expected {shift_m}"
            );
        }
    }
}

/// A pressure that rises evenly counts as it will be 60 ms later.
#[test]
fn pressures_are_taken_60_ms_ahead() {
    let rate_pa_s = 1.0e6;
    let mut springs = Springs::default();
    let mut last_pa = 0.0;
    for tick in 0..SECOND {
        last_pa = 2.0e6 + rate_pa_s * tick as f32 / SECOND as f32;
        springs.step(
            &parameters(),
            &under(last_pa, last_pa),
            &LOAD_N,
            ValveCommand::SAFE,
            Urgency::Comfort,
        );
    }
    let v2 = f64::from(parameters().gas_volume_2_m3);
    let later_pa = f64::from(last_pa) + 0.06 * f64::from(rate_pa_s) + ATMOSPHERE_PA;
    let expected_m = v2 * (1.0 - 2_101_325.0 / later_pa) / AREA_M2;
    // Looked at last, in the last tick.
    let found_m = f64::from(springs.trapped_shift_m()[Corner::RearRight]);
    assert!(
        (found_m / expected_m - 1.0).abs() < 0.01,
        "{found_m} m, expected {expected_m}"
    );
}

#[test]
fn the_first_pressures_have_no_rate_and_the_struts_take_turns() {
    let trusted = under(3.0e6, 3.0e6);
    let expected_m = rested(&trusted).trapped_shift_m()[Corner::FrontLeft];
    let mut springs = Springs::default();
    for turn in Corner::ALL {
        springs.step(&parameters(), &trusted, &LOAD_N, ValveCommand::SAFE, Urgency::Comfort);
        for corner in Corner::ALL {
            let looked_at = corner.index() <= turn.index();
            let shift_m = springs.trapped_shift_m()[corner];
            assert!(
                (shift_m - if looked_at { expected_m } else { 0.0 }).abs() < 1e-5,
                "{corner:?}: {shift_m}"
            );
        }
    }
}

#[test]
fn a_valve_rests_for_half_a_second_before_it_opens() {
    let mut springs = Springs::default();
    assert_eq!(
        changes(&mut springs, &at_rest(), ValveCommand::SOFT, Urgency::Comfort),
        Some(100)
    );
}

#[test]
fn a_valve_rests_for_half_a_second_before_it_closes_unless_in_an_emergency() {
    for (urgency, tick) in [
        (Urgency::Comfort, 100),
        (Urgency::Handling, 100),
        (Urgency::Emergency, 1),
    ] {
        let mut springs = rested(&at_rest());
        assert_eq!(
            changes(&mut springs, &at_rest(), ValveCommand::SOFT, Urgency::Comfort),
            Some(1)
        );
        assert_eq!(
            changes(&mut springs, &at_rest(), ValveCommand::SAFE, urgency),
            Some(tick),
            "{urgency:?}"
        );
    }
}

/// Springs as they stand, a while under other pressures.
fn settled(mut springs: Springs, trusted: &Trusted) -> Springs {
    let as_they_are = ValveCommand::from_word(springs.open);
    for _ in 0..SECOND {
        springs.step(&parameters(), trusted, &LOAD_N, as_they_are, Urgency::Comfort);
    }
    springs
}

/// Under 4 MPa a strut charged for 2 stands far from its height.
#[test]
fn a_closing_waits_for_its_height_as_long_as_its_urgency_allows() {
    for (urgency, tick) in [
        (Urgency::Comfort, 201),
        (Urgency::Handling, 31),
        (Urgency::Emergency, 1),
    ] {
        let compressed = under(4.0e6, 4.0e6);
        let mut springs = settled(opened(&Corner::ALL), &compressed);
        let found = changes(&mut springs, &compressed, ValveCommand::SAFE, urgency);
        assert_eq!(found, Some(tick), "{urgency:?}");
    }
}

/// A valve that is where it is wanted does not begin to wait because another one waits.
#[test]
fn each_valve_waits_for_itself() {
    let apart = under(4.0e6, 6.0e6);
    let mut springs = settled(opened(&[Corner::FrontLeft]), &apart);
    let both = only(&[Corner::FrontLeft, Corner::RearLeft]);
    // The rear one waits half a second for its opening.
    for _ in 0..SECOND / 2 {
        assert_eq!(
            springs.step(&parameters(), &apart, &LOAD_N, both, Urgency::Comfort),
            only(&[Corner::FrontLeft])
        );
        assert!(
            springs.is_settled_open(Corner::FrontLeft),
            "what another valve waits for is no change of this one"
        );
    }
    let mut since = springs;
    let found = changes(&mut since, &apart, only(&[Corner::RearLeft]), Urgency::Comfort);
    // The front one has its own second from now, and the rear one half of its second left.
    assert_eq!(found, Some(SECOND / 2));
    assert_eq!(since.open, both.word());
    assert_eq!(
        changes(&mut since, &apart, only(&[Corner::RearLeft]), Urgency::Comfort),
        Some(SECOND / 2 + 1)
    );
    assert_eq!(since.open, only(&[Corner::RearLeft]).word());
}

/// Only those of an axle that are to open, and are not open yet, have to open smoothly together.
#[test]
fn who_opens_together() {
    let step = |corner: Corner, wanted: &[Corner], open: &[Corner]| {
        let mut springs = opened(open);
        springs.valves[corner].opening_step_n = 1.0e6;
        let front = only(wanted);
        springs.change(&parameters(), &LOAD_N, front.word(), Urgency::Comfort);
        springs.open == front.word()
    };
    let (left, right) = (Corner::FrontLeft, Corner::FrontRight);
    assert!(step(right, &[left], &[]), "the right one is not wanted");
    assert!(step(right, &[left, right], &[right]), "the right one is open");
    assert!(!step(right, &[left, right], &[]), "the right one would jump");
    assert!(!step(left, &[left, right], &[]));
    assert!(step(Corner::RearLeft, &[left, right], &[]), "the other axle");
}

/// Under pressures that stay apart, the opening is throttled after a second. It is over once p3 and p4 are alike, but not in the first
/// 0.2 s, and after another second whatever they are.
#[test]
fn a_throttled_opening_ends() {
    for (alike_after, ends) in [(0, 2 * SECOND / 10), (100, 101), (10 * SECOND, SECOND)] {
        let apart = under(2.0e6, 2.6e6);
        let mut springs = rested(&apart);
        assert_eq!(
            changes(&mut springs, &apart, ValveCommand::SOFT, Urgency::Comfort),
            Some(SECOND)
        );
        assert_eq!(springs.throttled(), Corners::splat(true));
        let mut ticks = Corners::splat(0);
        for tick in 0..2 * SECOND {
            for (corner, throttled) in springs.throttled().iter() {
                ticks[corner] += u32::from(*throttled);
                assert_eq!(
                    springs.is_settled_open(corner),
                    !throttled && tick >= 2 * SECOND / 10,
                    "{corner:?} in {tick}"
                );
            }
            let now = if tick < alike_after { &apart } else { &at_rest() };
            springs.step(&parameters(), now, &LOAD_N, ValveCommand::SOFT, Urgency::Comfort);
        }
        // A strut is looked at in every fourth tick.
        for (corner, ticks) in ticks.iter() {
            assert!(
                (ends..=ends + 3).contains(ticks),
                "{corner:?}: {ticks} ticks, expected {ends}"
            );
        }
    }
}

#[test]
fn valve_2_is_closed_where_valve_3_is_closed_or_throttled() {
    let mut springs = opened(&[Corner::FrontLeft, Corner::RearRight]);
    springs.throttled = bit(Corner::RearRight);
    let applied = springs.applied_to(ValveCommand::from_word(BYPASS_BITS));
    for corner in Corner::ALL {
        let open = [Corner::FrontLeft, Corner::RearRight].contains(&corner);
        assert!(applied.is_open(corner, Valve::Bypass1));
        assert_eq!(applied.is_open(corner, Valve::Bypass2), corner == Corner::FrontLeft);
        assert_eq!(applied.is_open(corner, Valve::Spring), open);
    }
}

const BEND: Urgency = Urgency::Bend { outer: Side::Right };

/// The valves that are open after so many ticks of a bend under these pressures, of a vehicle whose valves were all open.
fn in_bend(trusted: &Trusted, ticks: u32) -> ValveCommand {
    let mut springs = settled(opened(&Corner::ALL), trusted);
    let open = (0..ticks).map(|_| springs.step(&parameters(), trusted, &LOAD_N, ValveCommand::SAFE, BEND));
    open.last().expect("at least one tick")
}

/// On a road that moves nothing all valves close, each in its strut's turn.
#[test]
fn a_bend_closes_all_valves_within_four_ticks() {
    let left = |ticks| in_bend(&at_rest(), ticks).word().count_ones();
    assert_eq!([1, 2, 3, 4].map(left), [3, 2, 1, 0]);
}

/// Which valves stay open: where oil leaves accumulator 2 of a strut on the outer side that is compressed, or enters that of one on the
/// inner side that is extended.
#[test]
fn a_bend_leaves_open_what_lets_a_lean_out() {
    let (outer, inner) = (
        only(&[Corner::FrontRight, Corner::RearRight]),
        only(&[Corner::FrontLeft, Corner::RearLeft]),
    );
    for (p1_pa, p4_pa, open) in [
        (2.4e6, 3.0e6, outer),
        (3.0e6, 2.4e6, ValveCommand::SAFE),
        (1.6e6, 1.2e6, inner),
        (1.2e6, 1.6e6, ValveCommand::SAFE),
        // It flows the right way, but nothing is trapped.
        (1.6e6, 2.0e6, ValveCommand::SAFE),
        (2.4e6, 2.0e6, ValveCommand::SAFE),
        // It flows the right way, but by less than 10 % of the load: at most 1.9635e-3 m2 x 0.05 MPa = 98 N of 393 N.
        (2.6e6, 2.65e6, ValveCommand::SAFE),
    ] {
        let found = in_bend(&under(p1_pa, p4_pa), 40);
        assert_eq!(found, open, "{p1_pa} Pa, {p4_pa} Pa");
    }
}

/// A valve that is closed opens from twice the shift at which one that is open closes, and 50 ms after its closing.
#[test]
fn in_a_bend_a_valve_opens_again() {
    let v2 = f64::from(parameters().gas_volume_2_m3);
    let p4_pa = |shift_m: f64| (2_101_325.0 / (1.0 - shift_m * AREA_M2 / v2) - ATMOSPHERE_PA) as f32;
    let (c, outer) = (parameters(), only(&[Corner::FrontRight, Corner::RearRight]));
    for (shift_m, stays, opens) in [
        (0.0075, false, false),
        (0.0085, true, false),
        (0.0155, true, false),
        (0.0165, true, true),
    ] {
        let trusted = under(1.0e6, p4_pa(shift_m));
        assert_eq!(in_bend(&trusted, 40) == outer, stays, "{shift_m} m");
        let mut springs = rested(&trusted);
        let opened = (1..=20).find(|_| springs.step(&c, &trusted, &LOAD_N, ValveCommand::SAFE, BEND) == outer);
        assert_eq!(opened.is_some(), opens, "{shift_m} m");
    }
    let (lets_out, turned) = (under(1.0e6, p4_pa(0.03)), under(4.0e6, p4_pa(0.03)));
    let mut springs = settled(opened(&Corner::ALL), &lets_out);
    let mut ticks_until = |trusted: &Trusted, open: u32| {
        (1..=SECOND).find(|_| {
            let now = springs.step(&c, trusted, &LOAD_N, ValveCommand::SAFE, BEND);
            now.word().count_ones() == open
        })
    };
    let closed_after = ticks_until(&lets_out, 2).expect("the inner side");
    assert!(closed_after <= 4, "{closed_after}");
    // The pressures' rates need some ticks to be forgotten.
    let closed_after = ticks_until(&turned, 0).expect("the flow has turned");
    assert!(closed_after <= 8, "{closed_after}");
    let opened_after = ticks_until(&lets_out, 1).expect("it has turned back");
    assert!((DWELL_IN_BENDS_TICKS..=30).contains(&opened_after), "{opened_after}");
}

/// After a bend the rules of comfort hold from that tick on.
#[test]
fn after_a_bend_a_valve_waits_from_its_end() {
    let apart = under(2.0e6, 2.6e6);
    let mut springs = rested(&apart);
    springs.step(&parameters(), &apart, &LOAD_N, ValveCommand::SOFT, Urgency::Comfort);
    for _ in 0..SECOND {
        springs.step(&parameters(), &apart, &LOAD_N, ValveCommand::SAFE, BEND);
    }
    let left = changes(&mut springs, &apart, only(&[Corner::FrontLeft]), Urgency::Comfort);
    assert_eq!(left, Some(SECOND));
}
