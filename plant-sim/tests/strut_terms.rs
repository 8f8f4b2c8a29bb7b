//! Every term of the strut against a closed form or a limit, through the whole network.
//!
//! Slow moves make the gas isothermal (no `gas_heat_transfer` in these models) and the paths lossless; steady moves make
//! flows known: `Q = A v` where only one path is open. Signs: compression positive.

mod slow_and_steady;

use oleo_interface::{Absolute, StrutValves, Valve};
use oleo_plant_sim::model_file::Checked;
use oleo_plant_sim::strut::{
    ATMOSPHERE_PA, AccumulatorPistonFriction, BumpStop, DamperLeakage, DampingFade, EntrainedAir, GasChargeError,
    GasHeatTransfer, GasState, LineInertance, LineResistance, MountCompliance, Nitrogen, OilCompressibility, OilCount,
    RealGas, SealFriction, SideLoadFriction, Strut, StrutModel, StrutOutput, Valve3Leakage, ValveDelay,
};
use slow_and_steady::{
    BYPASS_1, CLOSED, SOFT, STIFF, absolute, bare, beside_pressure, close, slow_pressure, slowly, steady_drop,
};

/// Solve a rising function by bisection.
fn solve(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Volume that gas of static volume `v` has given way at gauge pressure `p`, isothermal.
fn given_way(model: &StrutModel, v: f64, p: f64) -> f64 {
    v * (1.0 - absolute(model.cylinder.static_pressure_pa) / absolute(p))
}

#[test]
fn boyle_on_both_springs() {
    let model = bare();
    let a = model.piston_area_m2();
    let p0 = absolute(model.cylinder.static_pressure_pa);
    close(
        absolute(slow_pressure(&model, 0.04, STIFF)),
        p0 * 1e-4 / (1e-4 - a * 0.04),
        1e-4,
    );
    close(
        absolute(slow_pressure(&model, 0.04, SOFT)),
        p0 * 5e-4 / (5e-4 - a * 0.04),
        1e-4,
    );
    close(
        absolute(slow_pressure(&model, -0.1, SOFT)),
        p0 * 5e-4 / (5e-4 + a * 0.1),
        1e-4,
    );
}

#[test]
fn oil_compressibility_and_mount_are_springs_in_series() {
    let a = bare().piston_area_m2();
    for (beta, mount) in [(Some(1.5e9), None), (None, Some(2e6)), (Some(1e9), Some(3e6))] {
        let mut model = bare();
        model.effects.oil_compressibility = beta.map(|b| OilCompressibility {
            bulk_modulus_pa: b,
            counted_at: OilCount::Chamber,
        });
        model.effects.mount_compliance = mount.map(|k| MountCompliance { stiffness_n_m: k });
        let p0 = model.cylinder.static_pressure_pa;
        let x = 0.03;
        let exact = solve(p0, 30e6, |p| {
            let mount = mount.map_or(0.0, |k| a * (p - p0) / k);
            // Oil volume shrinks with the piston's way in: d(ln) law integrated with the mean volume.
            let oil = beta.map_or(0.0, |b| (model.cylinder.oil_volume_m3 - 0.5 * a * x) * (p - p0) / b);
            given_way(&model, 1e-4, p) + oil + a * mount - a * x
        });
        close(slow_pressure(&model, x, STIFF), exact, 4e-3);
    }
}

#[test]
fn entrained_air_softens_low_pressure_most() {
    let with = |fraction: f64, x: f64| {
        let mut model = bare();
        model.effects.oil_compressibility = Some(OilCompressibility {
            bulk_modulus_pa: 1.5e9,
            counted_at: OilCount::Chamber,
        });
        model.effects.entrained_air = Some(EntrainedAir {
            volume_fraction: fraction,
            polytropic_exponent: 1.0,
        });
        slow_pressure(&model, x, STIFF)
    };
    // n = 1: the bubbles obey Boyle, V_air = fraction V_oil p_atm / p.
    let model = bare();
    let a = model.piston_area_m2();
    let (p0, fraction, x) = (model.cylinder.static_pressure_pa, 0.05, -0.08);
    let exact = solve(-5e4, p0, |p| {
        let oil = model.cylinder.oil_volume_m3 - 0.5 * a * x;
        let air = fraction * oil * ATMOSPHERE_PA * (1.0 / absolute(p0) - 1.0 / absolute(p));
        given_way(&model, 1e-4, p) + oil * (p - p0) / 1.5e9 + air - a * x
    });
    close(with(fraction, x), exact, 4e-3);
    let softening = |x: f64| (with(0.0, x) - with(fraction, x)).abs() / with(0.0, x);
    assert!(softening(-0.08) > softening(0.02));
}

#[test]
fn a_strut_pulled_apart_reaches_vacuum_and_no_further() {
    let mut strut = Strut::at_rest(&StrutModel::defender110(4000.0), CLOSED).unwrap();
    let lowest = (1..=100)
        .map(|i| strut.advance(-1.4e-3 * f64::from(i), 1e-3, CLOSED).pressure_pa[0])
        .fold(f64::INFINITY, f64::min);
    assert!(lowest > -ATMOSPHERE_PA && lowest < -0.5 * ATMOSPHERE_PA, "{lowest}");
    for i in 1..=400 {
        strut.advance(-0.14 + 3.5e-4 * f64::from(i), 1e-2, CLOSED);
    }
    let back = (0..6000).map(|_| strut.advance(0.0, 1e-2, CLOSED)).last().unwrap();
    assert!((back.force_n - 4000.0).abs() < 400.0, "{}", back.force_n);
}

#[test]
fn charge_error_is_a_volume() {
    let mut model = bare();
    model.effects.gas_charge_error = Some(GasChargeError {
        relative_error_1: 0.1,
        relative_error_2: 0.0,
    });
    let p0 = absolute(model.cylinder.static_pressure_pa);
    close(
        absolute(slow_pressure(&model, 0.03, STIFF)),
        p0 * 1.1e-4 / (1.1e-4 - model.piston_area_m2() * 0.03),
        1e-4,
    );
}

#[test]
fn real_gas_is_softer_than_ideal_at_moderate_and_harder_at_high_pressure() {
    let mut model = bare();
    model.effects.real_gas = Some(RealGas::default());
    let gas = Nitrogen::reference();
    let p0 = absolute(model.cylinder.static_pressure_pa);
    let t = model.gas.temperature_k;
    let rho = gas.density(Absolute(p0), t) * 1e-4 / (1e-4 - model.piston_area_m2() * 0.038);
    close(
        absolute(slow_pressure(&model, 0.038, STIFF)),
        gas.state(rho, t).pressure.pa(),
        1e-3,
    );
}

#[test]
fn heat_transfer_decays_with_its_time_constant() {
    let mut model = bare();
    model.effects.gas_heat_transfer = Some(GasHeatTransfer {
        time_constant_1_s: 3.0,
        time_constant_2_s: 6.0,
    });
    let mut strut = Strut::at_rest(&model, STIFF).unwrap();
    for i in 1..=100 {
        strut.advance(3e-4 * f64::from(i), 1e-3, STIFF);
    }
    let wait = |s: &mut Strut, seconds: usize| (0..seconds * 100).map(|_| s.advance(0.03, 0.01, STIFF)).last().unwrap();
    let settle = wait(&mut strut, 1).pressure_pa[0];
    let later = wait(&mut strut, 3).pressure_pa[0];
    let end = wait(&mut strut, 60).pressure_pa[0];
    close((later - end) / (settle - end), libm::exp(-1.0), 5e-3);
}

#[test]
fn pack_bypass_leak_and_line_in_steady_flow() {
    let mut model = bare();
    let pack = |drop: f64| model.damper[0].characteristic().value(drop);
    let (drop, q) = steady_drop(&model, 0.3, CLOSED);
    close(pack(drop), q, 1e-3);
    let (drop, q) = steady_drop(&model, 0.3, BYPASS_1);
    let orifice = |c: f64, d: f64| c * d / (d.abs() + model.orifice.transition_pressure_pa).sqrt();
    close(
        pack(drop) + orifice(model.valve[0].total_flow_coefficient(), drop),
        q,
        1e-3,
    );
    let leak = DamperLeakage {
        flow_coefficient_1: 2e-7,
        flow_coefficient_2: 0.0,
    };
    let expected = |drop: f64| pack(drop) + orifice(2e-7, drop);
    let (drop, q) = {
        let mut leaking = model.clone();
        leaking.effects.damper_leakage = Some(leak);
        steady_drop(&leaking, 0.3, CLOSED)
    };
    close(expected(drop), q, 1e-3);
    let (plain, q) = steady_drop(&model, 0.3, CLOSED);
    model.effects.line_resistance = Some(LineResistance {
        resistance_1_pa_s_m3: 5e8,
        resistance_2_pa_s_m3: 0.0,
    });
    close(steady_drop(&model, 0.3, CLOSED).0 - plain, 5e8 * q, 1e-3);
}

#[test]
fn inertance_is_pressure_per_flow_acceleration() {
    let mut model = bare();
    // Path 1 as good as blocked, so that all flow takes path 2.
    model.damper[0] = model.damper[0].scaled(1e7);
    let peak = |model: &StrutModel| {
        let signals = StrutValves::new(false, true, true);
        let mut strut = Strut::at_rest(model, signals).unwrap();
        let (a, h) = (20.0, 1e-3);
        let mut out = StrutOutput::default();
        for i in 0..30 {
            let t = h * f64::from(i + 1);
            out = strut.advance_with_speeds(0.5 * a * t * t, a * (t - h), a * t, h, signals);
        }
        out.pressure_pa[0]
    };
    let plain = peak(&model);
    model.effects.line_inertance = Some(LineInertance { inertance_2_kg_m4: 5e6 });
    close(peak(&model) - plain, 5e6 * model.piston_area_m2() * 20.0, 0.01);
}

#[test]
fn accumulator_piston_friction_opens_a_loop_of_twice_its_pressure() {
    let mut model = bare();
    model.effects.accumulator_piston_friction = Some(AccumulatorPistonFriction {
        pressure_1_pa: 4e4,
        pressure_2_pa: 0.0,
        presliding_volume_m3: 1e-7,
    });
    let mut strut = Strut::at_rest(&model, STIFF).unwrap();
    let there = slowly(&mut strut, 0.02, STIFF).pressure_pa[0];
    slowly(&mut strut, 0.03, STIFF);
    let back = slowly(&mut strut, 0.02, STIFF).pressure_pa[0];
    close(there - back, 8e4, 0.02);
}

#[test]
fn valve3_leak_passes_its_orifice_flow() {
    let mut model = bare();
    model.effects.valve3_leakage = Some(Valve3Leakage { flow_coefficient: 1e-9 });
    let mut strut = Strut::at_rest(&model, STIFF).unwrap();
    for i in 1..=100 {
        strut.advance(3e-4 * f64::from(i), 1e-3, STIFF);
    }
    let out = (0..50).map(|_| strut.advance(0.03, 1e-3, STIFF)).last().unwrap();
    let across = out.pressure_pa[2] - out.pressure_pa[3];
    close(
        strut.flow_m3_s()[1],
        1e-9 * across / (across + model.orifice.transition_pressure_pa).sqrt(),
        0.01,
    );
}

#[test]
fn warm_dampers_weaken_by_the_heat_they_hold() {
    let mut model = bare();
    let signals = CLOSED;
    let (fresh, _) = steady_drop(&model, 0.3, signals);
    model.effects.damping_fade = Some(DampingFade {
        fade_1_per_j: 1e-3,
        fade_2_per_j: 0.0,
        cooling_time_s: 1e9,
    });
    let mut strut = Strut::at_rest(&model, signals).unwrap();
    let (mut energy, h) = (0.0, 5e-4);
    let mut drop = 0.0;
    for i in 1..=100 {
        let out = strut.advance(0.3 * h * f64::from(i), h, signals);
        drop = out.pressure_pa[0] - out.pressure_pa[1];
        energy += drop * strut.flow_m3_s()[0] * h;
    }
    close(fresh / drop, 1.0 + 1e-3 * energy, 0.01);
}

#[test]
fn valves_answer_by_the_parabola_at_the_edge() {
    let mut model = bare();
    model.effects.valve_delay = Some(ValveDelay {
        response_polynomial_s: [0.04, 0.002, 0.0001],
    });
    let mut strut = Strut::at_rest(&model, STIFF).unwrap();
    let at = slowly(&mut strut, 0.03, STIFF);
    let across = 1e-6 * (at.pressure_pa[2] - at.pressure_pa[3]);
    let total = 0.04 + across * (0.002 + across * 0.0001);
    let mut opened = 0.0;
    for i in 1..=2000 {
        strut.advance(0.03, 1e-4, SOFT);
        if strut.openings()[Valve::Spring] > 0.5 {
            opened = 1e-4 * f64::from(i);
            break;
        }
    }
    assert!((opened - total).abs() < 2.1e-4, "{opened} {total}");
}

/// A second of work at 1 Hz and 40 mm, then rest: the work put in, J, and the oil that did not come back, m3.
fn closed_cycle(counted_at: OilCount) -> (f64, f64) {
    let mut model = StrutModel::defender110(8000.0);
    model.effects.bump_stop = None;
    model.effects.seal_friction = None;
    model.effects.entrained_air = None;
    model.effects.oil_compressibility = Some(OilCompressibility {
        bulk_modulus_pa: BETA,
        counted_at,
    });
    let mut strut = Strut::at_rest(&model, SOFT).unwrap();
    let total = |g: [GasState; 2]| g[0].volume_m3 + g[1].volume_m3;
    let before = total(strut.gas());
    let (mut work, mut last) = (0.0, strut.output().force_n);
    let w = 2.0 * std::f64::consts::PI;
    let mut x = 0.0;
    for i in 1..=20_000 {
        let t = 5e-4 * f64::from(i);
        let to = if t < 2.0 { 0.04 * libm::sin(w * t) } else { 0.0 };
        let speed = |t: f64| if t < 2.0 { 0.04 * w * libm::cos(w * t) } else { 0.0 };
        let out = strut.advance_with_speeds(to, speed(t - 5e-4), speed(t - 1e-9), 5e-4, SOFT);
        work += 0.5 * (last + out.force_n) * (to - x);
        (x, last) = (to, out.force_n);
    }
    for _ in 0..10_000 {
        strut.advance(0.0, 0.01, SOFT);
    }
    (work, total(strut.gas()) - before)
}

const BETA: f64 = 1.5e9;

#[test]
fn the_recordings_chamber_equation_pumps_its_loop_over_beta_and_the_conserving_one_nothing() {
    let (work, pumped) = closed_cycle(OilCount::Chamber);
    assert!(work > 10.0, "{work}");
    // 15 mm3 here, and nothing but that.
    assert!((pumped / (work / BETA) - 1.0).abs() < 0.05, "{pumped} {}", work / BETA);
    let (_, pumped) = closed_cycle(OilCount::Static);
    assert!(pumped.abs() < 0.02 * work / BETA, "{pumped}");
}

/// A minute of violent work that pulls the oil to vacuum in each rebound: none is lost.
#[test]
fn bubbles_that_open_and_close_keep_the_oil() {
    let mut strut = Strut::at_rest(&StrutModel::defender110(4000.0), SOFT).unwrap();
    let total = |g: [GasState; 2]| g[0].volume_m3 + g[1].volume_m3;
    let before = total(strut.gas());
    let mut lowest = f64::INFINITY;
    for i in 1..=60_000 {
        let t = 1e-3 * f64::from(i);
        let out = strut.advance(
            0.1 * libm::sin(8.0 * std::f64::consts::PI * t),
            1e-3,
            StrutValves::new(false, false, true),
        );
        lowest = out.pressure_pa[0].min(lowest);
    }
    assert!(lowest < -0.5 * ATMOSPHERE_PA, "{lowest}");
    for _ in 0..6000 {
        strut.advance(0.0, 0.01, SOFT);
    }
    close(total(strut.gas()), before, 1e-4);
}

#[test]
fn seal_friction_slides_on_the_stribeck_curve_and_turns_with_the_motion() {
    let mut model = bare();
    let (coulomb, breakaway, stribeck) = (120.0, 180.0, 4e-3);
    model.effects.seal_friction = Some(SealFriction {
        coulomb_force_n: coulomb,
        breakaway_force_n: breakaway,
        stribeck_speed_m_s: stribeck,
        presliding_stiffness_n_m: 2e6,
    });
    let mut strut = Strut::at_rest(&model, SOFT).unwrap();
    // `slowly` moves at 2 mm/s and then waits: the seal keeps what it had.
    let level = coulomb + (breakaway - coulomb) * libm::exp(-0.25);
    close(beside_pressure(&model, &slowly(&mut strut, 0.02, SOFT)), level, 1e-3);
    close(beside_pressure(&model, &slowly(&mut strut, 0.01, SOFT)), -level, 1e-3);
    let fast = (1..=100)
        .map(|i| strut.advance(0.01 + 5e-4 * f64::from(i), 1e-3, SOFT))
        .last()
        .unwrap();
    close(beside_pressure(&model, &fast), coulomb, 1e-3);
}

#[test]
fn side_load_friction_is_a_share_of_the_strut_force() {
    let mut model = bare();
    model.effects.side_load_friction = Some(SideLoadFriction {
        coefficient: 0.02,
        overlap_growth_1_m: 0.0,
    });
    let mut strut = Strut::at_rest(&model, STIFF).unwrap();
    for (to, sign) in [(0.03, 1.0), (-0.03, -1.0)] {
        let out = slowly(&mut strut, to, STIFF);
        let pressure_force = model.piston_area_m2() * out.pressure_pa[0];
        close(beside_pressure(&model, &out), sign * 0.02 * pressure_force, 1e-2);
    }
}

#[test]
fn stops_are_a_spring_beyond_their_clearance() {
    let mut model = bare();
    model.effects.bump_stop = Some(BumpStop {
        bump_clearance_m: 0.02,
        rebound_clearance_m: 0.05,
        stiffness_n_m: 4e4,
        progression_n_m3: 1e9,
    });
    let mut strut = Strut::at_rest(&model, SOFT).unwrap();
    assert!(beside_pressure(&model, &slowly(&mut strut, 0.019, SOFT)).abs() < 1e-9);
    close(
        beside_pressure(&model, &slowly(&mut strut, 0.03, SOFT)),
        4e4 * 0.01 + 1e9 * 1e-6,
        1e-9,
    );
    close(
        beside_pressure(&model, &slowly(&mut strut, -0.06, SOFT)),
        -(4e4 * 0.01 + 1e9 * 1e-6),
        1e-9,
    );
}

#[test]
fn valves_in_parallel_pass_the_sum_of_their_flows() {
    let text = StrutModel::defender110(8000.0).to_toml();
    assert!(text.contains("in_parallel = 2"), "as built: two for each function");
    let mut two = bare();
    let mut one = two.clone();
    for (two, one) in two.valve.iter_mut().zip(&mut one.valve) {
        (two.in_parallel, one.in_parallel) = (2, 1);
        one.flow_coefficient = 2.0 * two.flow_coefficient;
    }
    assert_eq!(steady_drop(&two, 0.3, STIFF), steady_drop(&one, 0.3, STIFF));
    two.valve[1].in_parallel = 0;
    let error = two.check().unwrap_err().to_string();
    assert!(error.starts_with("[valve 2] in_parallel is 0: "), "{error}");
}
