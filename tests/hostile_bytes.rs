//! The fuzz targets on a stable compiler: valid inputs, damaged in ways that files and lines get damaged, the same in
//! every run. Finding new inputs is libFuzzer's work (see `fuzz/` and docs/testing.md); this keeps what it needs working.

#[path = "../fuzz/src/lib.rs"]
mod targets;

use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::VehicleParameters;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Damaged inputs tried for each seed.
const ROUNDS: u32 = 2_000;

/// Chooses where to cut, the same in every run.
struct Random(ChaCha8Rng);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0.random_range(0..bound.max(1))
    }
}

/// What happens to files: a byte changed, a piece lost, a piece twice, the end lost, a number made extreme.
fn damage(seed: &[u8], random: &mut Random) -> Vec<u8> {
    const NUMBERS: [&[u8]; 8] = [
        b"0",
        b"-1",
        b"1e999",
        b"nan",
        b"1e-300",
        b"99999999999999999999",
        b"\"\"",
        b"[]",
    ];
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(3) {
        let (from, to) = (random.below(bytes.len()), random.below(bytes.len()));
        let piece = from.min(to)..from.max(to).min(from.min(to) + 60);
        match random.below(6) {
            0 if !bytes.is_empty() => bytes[from] = random.below(256) as u8,
            1 => drop(bytes.drain(piece)),
            2 => bytes = [&bytes[..piece.end], &bytes[piece.clone()], &bytes[piece.end..]].concat(),
            3 => bytes.truncate(from),
            _ => {
                let Some(start) = (from..bytes.len()).find(|&i| bytes[i].is_ascii_digit()) else {
                    continue;
                };
                let end = (start..bytes.len())
                    .find(|&i| !bytes[i].is_ascii_digit())
                    .unwrap_or(bytes.len());
                bytes.splice(start..end, NUMBERS[random.below(NUMBERS.len())].iter().copied());
            }
        }
    }
    bytes
}

fn drive(target: fn(&[u8]), seeds: &[&[u8]]) {
    let mut random = Random(ChaCha8Rng::seed_from_u64(1));
    target(&[]);
    for seed in seeds {
        target(seed);
        for _ in 0..ROUNDS {
            target(&damage(seed, &mut random));
        }
    }
    for _ in 0..ROUNDS {
        let noise: Vec<u8> = (0..random.below(600)).map(|_| random.below(256) as u8).collect();
        target(&noise);
    }
}

#[test]
fn can_frames() {
    use oleo_controller::Inputs;
    use oleo_interface::{Corners, Gauge, StrutPressures};
    let pressure = Corners::splat(StrutPressures::splat(Gauge(4.0e6)));
    let inputs = Inputs::from_values(Corners::splat(0.01), pressure);
    let mut plant = oleo_controller::PlantEnd::new();
    let mut proper = Vec::new();
    for tick in 0..40 {
        for (index, frame) in plant.encode(tick, &inputs).iter().enumerate() {
            proper.extend([index as u8, if index == 5 { 8 + 16 } else { 8 }]);
            proper.extend(frame.data);
        }
    }
    drive(targets::can_frames, &[&proper]);
}

/// A tenth of the rounds: a plan is thousands of ticks.
#[test]
fn fault_plan() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(1));
    // Ride/handling on a rough road with bends for 3,000 ticks: a drift, a silence that comes back, a forged command.
    let plan = [
        1, 0x4A, 0xB7, 7, 0, 0x60, 0x90, 0, 0, 9, 26, 0, 0x50, 0x18, 0x70, 5, 0, 33, 0, 0x20, 0x40, 0x40, 3, 5,
    ];
    targets::fault_plan(&plan);
    for _ in 0..ROUNDS / 10 {
        targets::fault_plan(&damage(&plan, &mut random));
    }
}

#[test]
fn slcan() {
    drive(
        targets::slcan,
        &[b"t1108001122334455667788\rT1FFF01E02ABCD\rr1108\rz\rO\rS6\rt110801\r"],
    );
}

#[test]
fn candump() {
    drive(
        targets::candump,
        &[b"(0000000001.005270) vcan0 110#0011223344556677\n(0000000002.005500) vcan0 1FFF01E0#R4\n(0000000003.1) can0 0A0#\n"],
    );
}

#[test]
fn asc() {
    let log = b"Begin Triggerblock Wed Apr 26 10:00:00.000 2023\n 0.015270 1  110 Rx   d 2 1A FF\n 0.0155004 2  1FFF01E0x Tx   r 4\n\
        0.015900 CANFD   3 Rx        123   Engine_Data   1 0 9 12 00 01 02 03 04 05 06 07 08 09 0A 0B  0 0 3000\n\
        base dec  timestamps relative\n 0.1 1  ErrorFrame\n 1.0 1  Statistic: D 200\nEnd TriggerBlock\n";
    drive(targets::asc, &[log]);
}

#[cfg(feature = "fmu")]
#[test]
fn bus_operations() {
    use oleo_fmu::ls_bus::{ArbitrationLost, ErrorCode, ErrorFlag, Identifier, NodeStatus, Operation, Setting};
    let mut seed = Vec::new();
    for operation in [
        Operation::Configuration(Setting::CanBitRate(500_000)),
        Operation::Configuration(Setting::ArbitrationLost(ArbitrationLost::DiscardAndNotify)),
        Operation::Status(NodeStatus::ErrorPassive),
        Operation::CanTransmit {
            id: Identifier::Standard(0x110),
            remote: false,
            data: &[1, 2, 3, 4, 5, 6, 7, 8],
        },
        Operation::CanFdTransmit {
            id: Identifier::Extended(0x1234_5678),
            bit_rate_switch: true,
            error_state: false,
            data: &[7; 12],
        },
        Operation::CanXlTransmit {
            id: Identifier::Standard(1),
            extended_content: false,
            content: 2,
            network: 3,
            acceptance: 4,
            data: &[5; 20],
        },
        Operation::Confirm { id: 0x110 },
        Operation::ArbitrationLost { id: 0x300 },
        Operation::BusError {
            id: 0x0A0,
            code: ErrorCode::Ack,
            flag: ErrorFlag::Secondary,
            is_sender: true,
        },
        Operation::FormatError { data: &[9; 5] },
        Operation::Wakeup,
    ] {
        operation.write(&mut seed);
    }
    drive(targets::bus_operations, &[&seed]);
}

#[test]
fn blf() {
    let packed = include_bytes!("golden/frames.blf");
    let plain = include_bytes!("golden/frames-plain.blf");
    // Head of the file and of its one container.
    drive(targets::blf, &[packed, plain, &plain[144 + 32..]]);
}

#[cfg(feature = "logs")]
#[test]
fn mf4() {
    drive(
        targets::mf4,
        &[
            include_bytes!("golden/frames.mf4"),
            include_bytes!("golden/frames-plain.mf4"),
        ],
    );
}

#[cfg(feature = "logs")]
#[test]
fn can_database() {
    let text = b"VERSION \"\"\nNS_ :\nBS_:\nBU_: A\nBO_ 256 M: 8 A\n SG_ W M : 0|8@1+ (1,0) [0|0] \"\" A\n\
        SG_ S m3 : 8|12@0- (0.5,-3) [0|16] \"bar\" A\nBO_ 2147483904 N: 64 A\n SG_ T : 32|32@1- (1,0) [0|0] \"\" A\n\
        CM_ SG_ 256 S \"text\";\nVAL_ 256 S 0 \"Zu\" 1 \"Auf\" ;\nSIG_VALTYPE_ 2147483904 T : 1;\n\
        SG_MUL_VAL_ 256 S W 3-5, 7-9;\n";
    drive(targets::can_database, &[text]);
}

#[cfg(feature = "logs")]
#[test]
fn signal_map() {
    drive(
        targets::signal_map,
        &[include_bytes!("../hil/src/signal_log/invented_car.toml")],
    );
}

#[test]
fn drive_log() {
    use oleo_controller::Inputs;
    use oleo_hil::Frame;
    use oleo_interface::{Corners, Gauge, StrutPressures};
    let pressure = Corners::splat(StrutPressures::splat(Gauge(4.0e6)));
    let inputs = Inputs::from_values(Corners::splat(0.01), pressure);
    let mut plant = oleo_controller::PlantEnd::new();
    let mut proper = Vec::new();
    for tick in 0..12 {
        for frame in plant.encode(tick, &inputs) {
            let time_us = u64::from(tick) * 5000;
            oleo_hil::logs::candump::write_line(&mut proper, time_us, "can0", &Frame::from(frame))
                .expect("memory takes it");
        }
    }
    drive(targets::drive_log, &[&proper]);
}

#[test]
fn scenario() {
    drive(
        targets::scenario,
        &[
            include_bytes!("../hil/scenarios/belgian.toml"),
            include_bytes!("../hil/scenarios/nan.toml"),
            include_bytes!("../hil/scenarios/corrupt-burst.toml"),
        ],
    );
}

#[test]
fn road_crg() {
    let text = b"$ROAD_CRG\nreference_line_increment = 0.5\nlong_section_v_right = -1\nlong_section_v_left = 1\n$\n\
        $KD_DEFINITION\n#:LRFI\nD:long section 1,m\nD:long section 2,m\nD:long section 3,m\n$\n$$$$\n 0.0000000 0.0000000 0.0111111\n\
        *missing* 0.0100000 0.0222222\n";
    let binary = b"$ROAD_CRG\nreference_line_increment = 0.5\nlong_section_v_right = -1\nlong_section_v_left = 1\n$\n\
        $KD_DEFINITION\n#:KRBI\nD:long section 1,m\nD:long section 2,m\n$\n$$$$\n12345678123456781234567812345678";
    drive(targets::road_crg, &[text, binary]);
}

#[test]
fn road_csv() {
    drive(
        targets::road_csv,
        &[b"station_m,height_m\n0,0\n0.1,0.01\n0.2,-0.01\n0.3,0\n"],
    );
}

#[test]
fn strut_model() {
    drive(
        targets::strut_model,
        &[StrutModel::defender110(5_000.0).to_toml().as_bytes()],
    );
}

#[test]
fn recording() {
    let mut proper = "time_s,displacement_m,p_Pa,valve1\n".to_owned();
    for k in 0..120 {
        proper += &format!("{:.3},0.0{k},1e6,{}\n", f64::from(k) * 0.01, k % 2);
    }
    drive(targets::recording, &[proper.as_bytes()]);
}

#[test]
fn specimen_model() {
    let spring = b"[specimen]\nname = \"a\"\nkind = \"gas spring\"\n[chamber]\narea_m2 = 0.01\nvolume_at_zero_m3 = 0.05\n[gas]\n\
        species = \"nitrogen\"\nprocess = \"adiabatic\"\ntemperature_K = 293.15\n[effects.gas_heat_transfer]\n\
        time_constant_s = 6.0\n[effects.sensor_skew]\np_Pa = 0.02\n[effects.sensor_lag]\np_Pa = 0.1\n[noise]\np_Pa = 300.0\n";
    let cylinder = b"[specimen]\nname = \"a\"\nkind = \"cylinder\"\n[[chamber]]\ncolumn = \"p_Pa\"\narea_m2 = 0.001\n[effects]\n\
        moving_mass_kg = 3.0\n[effects.seal_friction]\ncoulomb_force_N = 5.0\npresliding_stiffness_N_m = 1e5\n\
        [effects.side_load_friction]\ncoefficient = 0.02\n[effects.sensor_skew]\np_Pa = 0.02\n[tolerance]\narea = 0.03\n";
    let damper = b"[specimen]\nname = \"a\"\nkind = \"damper\"\n[damper]\nviscous_N_s_m = 1500.0\noffset_N = 2.0\n\
        [effects.presliding_friction]\ncoulomb_force_N = 50.0\npresliding_stiffness_N_m = 1e6\n[effects.gas_spring]\n\
        gas_force_N = 50.0\ngas_length_m = 0.3\n[effects.backlash]\ngap_m = 0.001\n[noise]\nforce_N = 5.0\n";
    let carriage = b"[specimen]\nname = \"a\"\nkind = \"drive\"\n[drive]\nmass_kg = 95.0\nviscous_N_s_m = 200.0\n\
        [effects.coulomb_friction]\ncoulomb_force_N = 20.0\n[effects.inertia]\nmoving_mass_kg = 2.0\n[effects.sensor_skew]\n\
        position_m = 0.002\n[effects.sensor_gain]\nposition_m = 0.1\n[tolerance]\nmass = 0.15\n";
    drive(targets::specimen_model, &[spring, cylinder, damper, carriage]);
}

#[test]
fn vehicle_parameters() {
    drive(
        targets::vehicle_parameters,
        &[VehicleParameters::defender110().to_toml().as_bytes()],
    );
}
