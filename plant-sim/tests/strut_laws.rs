//! Laws without a name against closed forms, through the whole network of the strut.

mod slow_and_steady;

use oleo_interface::{StrutValves, Valve};
use oleo_plant_sim::strut::{
    AccumulatorPistonFriction, Characteristic, DampingFade, GasHeatTransfer, LawArgument, LawPlace, LineInertance,
    MountCompliance, OilCompressibility, OilCount, RealGas, Strut, StrutModel, UnlistedLaw,
};
use slow_and_steady::{
    BYPASS_1, CLOSED, SOFT, STIFF, absolute, bare, beside_pressure, close, slow_pressure, slowly, steady_drop,
};

fn law(place: LawPlace, depends_on: LawArgument, argument: [f64; 2], value: [f64; 2]) -> UnlistedLaw {
    UnlistedLaw {
        place,
        depends_on,
        argument: argument.to_vec(),
        value: value.to_vec(),
        time_constant_s: None,
        frequency_hz: None,
        presliding_volume_m3: None,
        attraction: None,
    }
}

#[test]
fn laws_of_paths_and_valves_in_steady_flow() {
    let model = bare();
    let with = |law: UnlistedLaw| {
        let mut changed = model.clone();
        changed.effects.unlisted = vec![law];
        changed
    };
    let pack = |drop: f64| model.damper[0].characteristic().value(drop);
    let orifice = |c: f64, d: f64| c * d / (d.abs() + model.orifice.transition_pressure_pa).sqrt();
    // The move ends at 15 mm of jounce, where the groove is open by 2.15e-7.
    let groove = law(
        LawPlace::BesidePack1,
        LawArgument::Displacement,
        [-0.1, 0.1],
        [1e-7, 3e-7],
    );
    let (drop, q) = steady_drop(&with(groove), 0.3, CLOSED);
    close(pack(drop) + orifice(2.15e-7, drop), q, 1e-3);
    let weak = law(LawPlace::Pack1, LawArgument::Displacement, [-0.1, 0.1], [0.5, 0.5]);
    let (drop, q) = steady_drop(&with(weak), 0.3, CLOSED);
    close(pack(drop / 0.5), q, 1e-3);
    let choking = law(LawPlace::Valves, LawArgument::PressureDrop, [0.0, 1e6], [1.0, 0.2]);
    let (drop, q) = steady_drop(&with(choking), 0.3, BYPASS_1);
    let left = 1.0 - 0.8 * drop / 1e6;
    close(
        pack(drop) + orifice(left * model.valve[0].total_flow_coefficient(), drop),
        q,
        1e-3,
    );
}

#[test]
fn a_choking_valve_3_passes_what_its_law_leaves_even_where_more_drop_means_less_flow() {
    // 1/(1 + dp/0.8 MPa) as a table: above 0.8 MPa the flow falls while the drop rises.
    let argument: Vec<f64> = (0..200).map(|k| 5e4 * f64::from(k)).collect();
    let value: Vec<f64> = argument.iter().map(|dp| 1.0 / (1.0 + dp / 0.8e6)).collect();
    let mut model = bare();
    model.effects.oil_compressibility = Some(OilCompressibility {
        bulk_modulus_pa: 1.5e9,
        counted_at: OilCount::default(),
    });
    let table = Characteristic::through(&argument, &value);
    model.effects.unlisted = vec![UnlistedLaw {
        place: LawPlace::Valve3,
        depends_on: LawArgument::PressureDrop,
        argument,
        value,
        time_constant_s: None,
        frequency_hz: None,
        presliding_volume_m3: None,
        attraction: None,
    }];
    let mut strut = Strut::at_rest(&model, STIFF).unwrap();
    slowly(&mut strut, 0.03, STIFF);
    let mut seen = 0;
    for _ in 0..400 {
        let out = strut.advance(0.03, 5e-4, SOFT);
        let drop = out.pressure_pa[2] - out.pressure_pa[3];
        let coefficient = model.valve[2].total_flow_coefficient() * strut.openings()[Valve::Spring];
        if coefficient > 0.0 && drop > 2e5 {
            let passed = table.value(drop) * coefficient * drop / (drop + model.orifice.transition_pressure_pa).sqrt();
            close(strut.flow_m3_s()[1], passed, 5e-3);
            seen += usize::from(drop > 1.5e6);
        }
    }
    assert!(seen > 5, "{seen} samples where the flow falls with the drop");
}

#[test]
fn laws_of_seal_gas_and_chamber() {
    let mut model = bare();
    model.effects.unlisted = vec![law(
        LawPlace::MainSealFriction,
        LawArgument::P1,
        [0.0, 1e7],
        [150.0, 150.0],
    )];
    let mut strut = Strut::at_rest(&model, SOFT).unwrap();
    close(beside_pressure(&model, &slowly(&mut strut, 0.02, SOFT)), 150.0, 1e-3);
    close(beside_pressure(&model, &slowly(&mut strut, 0.0, SOFT)), -150.0, 1e-3);

    let believed = absolute(slow_pressure(&bare(), 0.02, STIFF));
    let volume = model.accumulator[0].static_gas_volume_m3;
    let part = 1.0 - model.piston_area_m2() * 0.02 / volume;
    model.effects.unlisted = vec![law(
        LawPlace::Accumulator1,
        LawArgument::RelativeVolume,
        [0.2, 1.0],
        [1.4, 1.0],
    )];
    close(
        absolute(slow_pressure(&model, 0.02, STIFF)),
        believed * (1.0 + 0.5 * (1.0 - part)),
        1e-4,
    );

    model.effects.unlisted = vec![law(
        LawPlace::MainChamberLoss,
        LawArgument::P1,
        [0.0, 1e7],
        [1e-8, 1e-8],
    )];
    let mut strut = Strut::at_rest(&model, SOFT).unwrap();
    let gas = |s: &Strut| s.gas()[0].volume_m3 + s.gas()[1].volume_m3;
    let before = gas(&strut);
    (0..1000).for_each(|_| _ = strut.advance(0.0, 0.1, SOFT));
    close(gas(&strut) - before, 1e-6, 1e-3);
}

#[test]
fn laws_over_time_and_acceleration() {
    let static_pa = absolute(slow_pressure(&bare(), 0.0, STIFF));
    let with = |law: UnlistedLaw| {
        let mut model = bare();
        model.effects.unlisted = vec![law];
        Strut::at_rest(&model, STIFF).unwrap()
    };
    // Nothing moves, so the gas pressure falls as the law says.
    let time = LawArgument::Time;
    let mut leaking = with(law(LawPlace::Accumulator1, time, [0.0, 10.0], [1.0, 0.9]));
    let out = (0..100).map(|_| leaking.advance(0.0, 0.1, STIFF)).last().unwrap();
    close(absolute(out.pressure_pa[0]), 0.9 * static_pa, 1e-4);

    let mut losing = with(law(LawPlace::MainChamberLoss, time, [0.0, 10.0], [0.0, 2e-8]));
    let before = losing.gas()[0].volume_m3;
    (0..100).for_each(|_| _ = losing.advance(0.0, 0.1, STIFF));
    close(losing.gas()[0].volume_m3 - before, 1e-7, 2e-3);

    // 12 kg between load cell and oil, at 3 m/s2.
    let mass = law(
        LawPlace::MainSeal,
        LawArgument::Acceleration,
        [-100.0, 100.0],
        [-1200.0, 1200.0],
    );
    let (mut heavy, mut light) = (with(mass), Strut::at_rest(&bare(), STIFF).unwrap());
    for k in 0..20 {
        let (from, to) = (0.01 * f64::from(k), 0.01 * f64::from(k + 1));
        let (at, from, to) = (1.5 * to * to, 3.0 * from, 3.0 * to);
        let [heavy, light] = [&mut heavy, &mut light].map(|s| s.advance_with_speeds(at, from, to, 0.01, STIFF).force_n);
        close(heavy - light, 36.0, 1e-9);
    }
}

/// A law that swings about a middle with an amplitude, at 0.5 Hz, from the middle upwards.
fn swinging(place: LawPlace, middle: f64, amplitude: f64) -> UnlistedLaw {
    let argument: Vec<f64> = (0..=200).map(|k| f64::from(k) / 200.0).collect();
    let value = argument
        .iter()
        .map(|turns| middle + amplitude * libm::sin(std::f64::consts::TAU * turns))
        .collect();
    UnlistedLaw {
        place,
        depends_on: LawArgument::Phase,
        argument,
        value,
        time_constant_s: None,
        frequency_hz: Some(0.5),
        presliding_volume_m3: None,
        attraction: None,
    }
}

#[test]
fn laws_over_the_phase_of_an_oscillation() {
    let with = |law: UnlistedLaw| {
        let mut model = bare();
        model.effects.unlisted = vec![law];
        Strut::at_rest(&model, STIFF).unwrap()
    };
    // 0.5 Hz: half a second after each full turn it is at its highest.
    let mut pushed = with(swinging(LawPlace::MainSeal, 0.0, 100.0));
    for _ in 0..3 {
        let up = pushed.advance(0.0, 0.5, STIFF);
        let down = pushed.advance(0.0, 1.0, STIFF);
        close(beside_pressure(&bare(), &up), 100.0, 1e-3);
        close(beside_pressure(&bare(), &down), -100.0, 1e-3);
        pushed.advance(0.0, 0.5, STIFF);
    }
    // At rest p1 is the swinging gas pressure, also where a sample is half a turn.
    let static_pa = absolute(slow_pressure(&bare(), 0.0, STIFF));
    for place in [LawPlace::Accumulator1, LawPlace::Accumulators] {
        let mut gas = with(swinging(place, 1.0, 0.05));
        let up = gas.advance(0.0, 0.5, STIFF);
        close(absolute(up.pressure_pa[0]), 1.05 * static_pa, 1e-3);
        let down = gas.advance(0.0, 1.0, STIFF);
        close(absolute(down.pressure_pa[0]), 0.95 * static_pa, 1e-3);
    }
    // What flows out in the first half of a turn is the integral of half a sine, and comes back in the second.
    let mut pump = with(swinging(LawPlace::MainChamberLoss, 0.0, 1e-7));
    let before = pump.gas()[0].volume_m3;
    pump.advance(0.0, 1.0, STIFF);
    close(
        pump.gas()[0].volume_m3 - before,
        1e-7 * 2.0 / std::f64::consts::PI,
        1e-2,
    );
    pump.advance(0.0, 1.0, STIFF);
    assert!((pump.gas()[0].volume_m3 - before).abs() < 1e-9);
    // A pack of half its strength passes at half the drop what it passed before.
    let strong = steady_drop(&bare(), 0.1, CLOSED).0;
    let mut model = bare();
    model.effects.unlisted = vec![UnlistedLaw {
        frequency_hz: Some(1e-3),
        ..swinging(LawPlace::Pack1, 0.5, 0.0)
    }];
    assert!(steady_drop(&model, 0.1, CLOSED).0 < 0.9 * strong);
    // A valve that passes half has more than the drop, in each of the ways to name it.
    for place in [LawPlace::Valve1, LawPlace::Valves] {
        let mut model = bare();
        let whole = steady_drop(&model, 0.02, BYPASS_1).0;
        model.effects.unlisted = vec![UnlistedLaw {
            frequency_hz: Some(1e-3),
            ..swinging(place, 0.5, 0.0)
        }];
        let half = steady_drop(&model, 0.02, BYPASS_1).0;
        assert!(half > 1.5 * whole, "{half} {whole}");
    }
}

#[test]
fn laws_with_a_memory_and_of_pistons_and_valves() {
    let with = |law: UnlistedLaw| {
        let mut model = bare();
        model.effects.unlisted = vec![law];
        model
    };
    // A jump of the gas volume by r shows as the factor 1 - 2 r at first, and is forgotten with 4 s.
    let memory = |place| UnlistedLaw {
        time_constant_s: Some(4.0),
        ..law(place, LawArgument::VolumeChange, [-1.0, 1.0], [3.0, -1.0])
    };
    for place in [LawPlace::Accumulator1, LawPlace::Accumulators] {
        let (mut plain, mut remembering) = (
            Strut::at_rest(&bare(), STIFF).unwrap(),
            Strut::at_rest(&with(memory(place)), STIFF).unwrap(),
        );
        let believed = absolute(plain.advance(0.02, 0.01, STIFF).pressure_pa[1]);
        let jump = bare().piston_area_m2() * 0.02 / bare().accumulator[0].static_gas_volume_m3;
        close(
            absolute(remembering.advance(0.02, 0.01, STIFF).pressure_pa[1]),
            believed * (1.0 + 2.0 * jump),
            5e-3,
        );
        let out = (0..400).map(|_| remembering.advance(0.02, 0.01, STIFF)).last().unwrap();
        let left = 2.0 * jump * libm::exp(-1.0);
        let believed = absolute(
            (0..400)
                .map(|_| plain.advance(0.02, 0.01, STIFF))
                .last()
                .unwrap()
                .pressure_pa[1],
        );
        close(absolute(out.pressure_pa[1]), believed * (1.0 + left), 5e-3);
    }

    // The floating piston holds back 50 kPa in either direction.
    let held = law(
        LawPlace::Accumulator1Friction,
        LawArgument::RelativeVolume,
        [0.0, 2.0],
        [5e4, 5e4],
    );
    let mut strut = Strut::at_rest(&with(held), STIFF).unwrap();
    let up = slowly(&mut strut, 0.02, STIFF).pressure_pa[1];
    slowly(&mut strut, 0.03, STIFF);
    let down = slowly(&mut strut, 0.02, STIFF).pressure_pa[1];
    close(up - down, 1e5, 2e-2);

    // What passes beside a closed valve 3 is an orifice.
    let beside = law(LawPlace::BesideValve3, LawArgument::Time, [0.0, 1.0], [2e-8, 2e-8]);
    let mut strut = Strut::at_rest(&with(beside), STIFF).unwrap();
    let out = strut.advance(0.02, 0.2, STIFF);
    let drop = out.pressure_pa[2] - out.pressure_pa[3];
    let expected = 2e-8 * drop / (drop + bare().orifice.transition_pressure_pa).sqrt();
    assert!(drop > 1e5);
    close(strut.flow_m3_s()[1], expected, 1e-2);

    // A valve that needs 30 ms longer opens 30 ms later.
    let late = law(
        LawPlace::ValveTiming,
        LawArgument::PressureDrop,
        [0.0, 1e7],
        [0.03, 0.03],
    );
    let opens_after = |model: &StrutModel| {
        let mut strut = Strut::at_rest(model, STIFF).unwrap();
        (0..1000).position(|_| {
            strut.advance(0.0, 1e-3, SOFT);
            strut.openings()[Valve::Spring] > 0.5
        })
    };
    let (believed, longer) = (opens_after(&bare()).unwrap(), opens_after(&with(late)).unwrap());
    assert!((longer as i64 - believed as i64 - 30).abs() <= 1, "{believed} {longer}");
}

/// A law at a floating piston that holds back a pressure (Pa) at any gas volume.
fn piston_law(place: LawPlace, held_back_pa: f64, presliding_volume_m3: Option<f64>) -> UnlistedLaw {
    UnlistedLaw {
        presliding_volume_m3,
        ..law(place, LawArgument::RelativeVolume, [0.0, 2.0], [held_back_pa; 2])
    }
}

#[test]
fn a_piston_law_shears_its_seal_over_the_volume_that_it_states() {
    let term = |presliding_volume_m3| {
        let mut model = bare();
        model.effects.accumulator_piston_friction = Some(AccumulatorPistonFriction {
            pressure_1_pa: 5e4,
            pressure_2_pa: 8e4,
            presliding_volume_m3,
        });
        model
    };
    let laws = |volume| {
        vec![
            piston_law(LawPlace::Accumulator1Friction, 5e4, volume),
            piston_law(LawPlace::Accumulator2Friction, 8e4, volume),
        ]
    };
    // A law that does not say the volume means that of a term that does not.
    for (volume, said) in [(9e-7, Some(9e-7)), (1e-7, None)] {
        let missed = misses(&term(volume), laws(said), SOFT);
        assert!(missed < 1e-4, "{missed}");
    }
    assert!(misses(&term(9e-7), laws(Some(1e-7)), SOFT) > 0.05);
}

#[test]
fn the_seal_of_a_piston_law_slides_exponentially_over_its_volume() {
    // ds/dV = (1 - s) / V_s from rest: s = 1 - exp(-V / V_s).
    let held_pa = |presliding_m3: Option<f64>, to_m: f64| {
        let mut model = bare();
        let mut pressures = [0.0; 2];
        for (pressure, held) in pressures.iter_mut().zip([0.0, 5e4]) {
            model.effects.unlisted = vec![piston_law(LawPlace::Accumulator1Friction, held, presliding_m3)];
            let mut strut = Strut::at_rest(&model, STIFF).unwrap();
            for k in 1..=2000 {
                *pressure = strut.advance(to_m * f64::from(k) / 2000.0, 1e-3, STIFF).pressure_pa[1];
            }
        }
        pressures[1] - pressures[0]
    };
    let to_m = 3e-4;
    let volume = bare().piston_area_m2() * to_m;
    for presliding in [2e-7, 1e-6] {
        close(
            held_pa(Some(presliding), to_m),
            5e4 * (1.0 - libm::exp(-volume / presliding)),
            1e-2,
        );
    }
}

#[test]
fn a_term_of_the_piston_keeps_its_volume_beside_a_law() {
    let with = |term_pa, law_volume| {
        let mut model = bare();
        model.effects.accumulator_piston_friction = Some(AccumulatorPistonFriction {
            pressure_1_pa: term_pa,
            pressure_2_pa: 0.0,
            presliding_volume_m3: 8e-7,
        });
        model.effects.unlisted = vec![piston_law(LawPlace::Accumulator1Friction, 7e4 - term_pa, law_volume)];
        model
    };
    let run = |model: StrutModel| {
        let mut strut = Strut::at_rest(&model, STIFF).unwrap();
        let at = |k: u32| 0.01 * libm::sin(0.05 * f64::from(k));
        (0..200)
            .map(|k| strut.advance(at(k), 5e-3, STIFF).pressure_pa[1])
            .collect::<Vec<f64>>()
    };
    // The level is shared as it likes between the two; there is one seal.
    let all = run(with(7e4, Some(1e-7)));
    for other in [with(3e4, Some(1e-7)), with(0.0, None)] {
        for (a, b) in all.iter().zip(run(other)) {
            close(b, *a, 1e-9);
        }
    }
}

#[test]
fn a_law_over_the_rate_of_flow_is_an_inertance() {
    let mut named = bare();
    named.effects.line_inertance = Some(LineInertance { inertance_2_kg_m4: 3e6 });
    let mut nameless = bare();
    nameless.effects.unlisted = vec![law(LawPlace::Path2, LawArgument::FlowRate, [-1.0, 1.0], [-3e6, 3e6])];
    let mut struts = [named, nameless].map(|model| Strut::at_rest(&model, SOFT).unwrap());
    for k in 0..200 {
        let at = 0.01 * libm::sin(0.1 * f64::from(k));
        let [a, b] = struts
            .each_mut()
            .map(|strut| strut.advance(at, 2e-3, SOFT).pressure_pa[2]);
        close(b, a, 1e-6);
    }
}

/// Largest difference of any pressure between a strut whose effect has a name and one with laws in its place, over what a plain strut differs from the
/// first, in 20 s of strokes of 40 mm.
fn misses(named: &StrutModel, laws: Vec<UnlistedLaw>, signals: StrutValves<bool>) -> f64 {
    misses_beside(&bare(), named, laws, signals)
}

/// The same where the plain strut has effects that the two others have too.
fn misses_beside(plain: &StrutModel, named: &StrutModel, laws: Vec<UnlistedLaw>, signals: StrutValves<bool>) -> f64 {
    let mut nameless = plain.clone();
    nameless.effects.unlisted = laws;
    let mut struts = [named, &nameless, plain].map(|model| Strut::at_rest(model, signals).unwrap());
    let (mut missed, mut changed) = (0.0f64, 0.0f64);
    for k in 0..4000 {
        let at = 0.04 * libm::sin(0.03 * f64::from(k));
        let [a, b, plain] = struts
            .each_mut()
            .map(|strut| strut.advance(at, 5e-3, signals).pressure_pa);
        for (a, (b, plain)) in a.into_iter().zip(b.into_iter().zip(plain)) {
            missed = missed.max((b - a).abs());
            changed = changed.max((plain - a).abs());
        }
    }
    missed / changed
}

fn remembered(place: LawPlace, depends_on: LawArgument, [a, b]: [f64; 2], value: [f64; 2], time_s: f64) -> UnlistedLaw {
    UnlistedLaw {
        time_constant_s: Some(time_s),
        ..law(place, depends_on, [a, b], value)
    }
}

/// The work of compression heats an ideal gas by `(kappa - 1)` of it, over what its pressure and volume are at rest: the energy equation.
#[test]
fn a_gas_law_over_its_energy_is_the_energy_equation() {
    let mut named = bare();
    named.effects.gas_heat_transfer = Some(GasHeatTransfer {
        time_constant_1_s: 0.5,
        time_constant_2_s: 3.0,
    });
    // R / c_v of nitrogen.
    let heats = 296.8 / 743.0;
    let one = |place, time_s| {
        let line = [1.0 - heats, 1.0 + heats];
        remembered(place, LawArgument::RelativeEnergy, [-1.0, 1.0], line, time_s)
    };
    let laws = vec![one(LawPlace::Accumulator1, 0.5), one(LawPlace::Accumulator2, 3.0)];
    let missed = misses(&named, laws, SOFT);
    assert!(missed < 3e-3, "{missed}");
    // And it is none where one time constant is another one.
    let both = vec![one(LawPlace::Accumulators, 3.0)];
    assert!(misses(&named, both, SOFT) > 0.05);
}

/// Molecules with a volume that attract each other are nitrogen, also where its work warms it; a factor over the volume is not.
#[test]
fn a_gas_law_over_its_density_is_an_equation_of_state() {
    let mut plain = bare();
    plain.effects.gas_heat_transfer = Some(GasHeatTransfer {
        time_constant_1_s: 3.0,
        time_constant_2_s: 6.0,
    });
    let mut named = plain.clone();
    named.effects.real_gas = Some(RealGas::default());
    let argument: Vec<f64> = (0..=40).map(|k| 0.1 * f64::from(k)).collect();
    // In proportion to the pressure at rest: 0.06 and 0.069 at 4.3 MPa.
    let size = absolute(slow_pressure(&bare(), 0.0, SOFT)) / 4.3e6;
    let factor = |x: f64| 1.0 / (1.0 - 0.06 * size * x) - 0.069 * size * x;
    let equation_of_state = UnlistedLaw {
        value: argument.iter().map(|x| factor(*x)).collect(),
        argument,
        attraction: Some(0.069 * size),
        ..law(LawPlace::Accumulators, LawArgument::RelativeDensity, [0.0; 2], [0.0; 2])
    };
    for signals in [SOFT, STIFF] {
        let missed = misses_beside(&plain, &named, vec![equation_of_state.clone()], signals);
        assert!(missed < 0.05, "{missed}");
    }
    // The same compressibility at ambient temperature without attraction warms as an ideal gas does.
    let cold = UnlistedLaw {
        attraction: None,
        ..equation_of_state
    };
    assert!(misses_beside(&plain, &named, vec![cold], STIFF) > 0.2);
}

#[test]
fn a_pack_law_over_its_energy_is_the_fade() {
    let mut named = bare();
    named.effects.damping_fade = Some(DampingFade {
        fade_1_per_j: 2e-4,
        fade_2_per_j: 0.0,
        cooling_time_s: 8.0,
    });
    let argument: Vec<f64> = (0..400).map(|k| 10.0 * f64::from(k)).collect();
    let fades = UnlistedLaw {
        value: argument.iter().map(|energy_j| 1.0 / (1.0 + 2e-4 * energy_j)).collect(),
        argument,
        ..remembered(LawPlace::Pack1, LawArgument::Energy, [0.0; 2], [0.0; 2], 8.0)
    };
    let missed = misses(&named, vec![fades], CLOSED);
    assert!(missed < 1e-2, "{missed}");
}

#[test]
fn a_mount_law_over_its_force_is_the_compliance() {
    let mut named = bare();
    named.effects.mount_compliance = Some(MountCompliance { stiffness_n_m: 2e6 });
    let line = law(LawPlace::Mount, LawArgument::Force, [-1e4, 1e4], [-5e-3, 5e-3]);
    let missed = misses(&named, vec![line], SOFT);
    assert!(missed < 1e-4, "{missed}");
}
