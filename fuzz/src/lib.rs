//! One function for each thing that reads bytes from outside. Whatever the bytes, it must answer, and what it accepts must hold
//! what its type promises: each function asserts that.
//!
//! Driven by libFuzzer (`fuzz_targets/`, coverage-guided, as long as one likes) and by `tests/hostile_bytes.rs` of the
//! root package (mutated valid files, seconds, every test run).

#[cfg(feature = "fmu")]
mod bus_operations;
mod fault_plan;
#[cfg(feature = "logs")]
mod foreign_logs;

use oleo_controller::{Configuration, Node, PlantEnd, SensorMessage};
use oleo_diagnose::recording::{ColumnKind, ColumnSpec, GapPolicy, parse};
use oleo_hil::bus::{SlcanDecoder, slcan_encode};
use oleo_hil::logs::candump::{parse_line, write_line};
use oleo_hil::logs::{FrameKind, in_memory};
use oleo_interface::StrutValves;
use oleo_plant_sim::road::{Road, crg, profile_from_csv};
use oleo_plant_sim::specimen::{CylinderModel, DamperModel, DriveModel, GasSpringModel, smooth_motion, specimen_name};
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::VehicleParameters;
use std::path::Path;

#[cfg(feature = "fmu")]
pub use bus_operations::bus_operations;
#[cfg(feature = "logs")]
pub use foreign_logs::{can_database, mf4, signal_map};

/// A bus full of strangers: frames of any identifier, length and content, ticks in between.
///
/// Each frame takes ten bytes: which identifier, how long and whether a tick follows, eight of data.
pub fn can_frames(bytes: &[u8]) {
    let mut node = Node::new(Configuration::defender110());
    let mut plant = PlantEnd::new();
    for chunk in bytes.chunks_exact(10) {
        let id = match usize::from(chunk[0]) {
            known @ 0..48 => SensorMessage::ALL[known % SensorMessage::ALL.len()].contract().id,
            48..64 => oleo_controller::can::COMMAND.id,
            other => other as u16 * 8,
        };
        let data = &chunk[2..(2 + usize::from(chunk[1] & 15)).min(10)];
        node.receive(id, data);
        let _ = plant.receive(id, data);
        if chunk[1] & 16 != 0 {
            let (outputs, frames) = node.tick();
            assert!(outputs.command.word() < 1 << 12);
            assert!(!frames.is_empty(), "every tick commands");
            for frame in frames {
                let _ = plant.receive(frame.id, &frame.data);
            }
            assert!(plant.end_of_tick().word() < 1 << 12);
        }
    }
}

/// A vehicle whose frames are right, and events that spoil them. Whatever goes wrong, the rules of the safe state hold.
pub fn fault_plan(bytes: &[u8]) {
    let Some(plan) = fault_plan::Plan::from_bytes(bytes) else {
        return;
    };
    if let Err(broken) = fault_plan::drive(&plan, |_| {}) {
        panic!("{broken:?} in {plan:?}");
    }
}

/// The ASCII lines of a serial CAN adapter. What is read as a frame is written and read again as the same.
pub fn slcan(bytes: &[u8]) {
    let mut decoder = SlcanDecoder::default();
    for byte in bytes {
        let Some(frame) = decoder.push(*byte) else { continue };
        let mut second = SlcanDecoder::default();
        let again = slcan_encode(&frame).bytes().find_map(|byte| second.push(byte));
        assert_eq!(again, Some(frame));
    }
}

/// Lines of a candump log. What is read is written and read again as the same.
pub fn candump(bytes: &[u8]) {
    for line in String::from_utf8_lossy(bytes).lines() {
        let Some(entry) = parse_line(line) else { continue };
        let mut written = Vec::new();
        write_line(&mut written, entry.time_us, entry.interface, entry.frame).expect("memory takes it");
        let written = String::from_utf8(written).expect("the format is ASCII and the interface was text");
        assert_eq!(parse_line(&written), Some(entry), "{line}");
    }
}

/// A log in any format. Its frames have as many bytes as their kind can carry, and every entry is accounted for.
fn frames_of(bytes: &[u8]) {
    let mut frames = 0;
    let read = in_memory(bytes).and_then(|mut log| {
        log.read(&mut |entry| {
            let most = if matches!(entry.frame.kind, FrameKind::Fd(_)) {
                64
            } else {
                8
            };
            assert!(entry.frame.data().len() <= most);
            frames += 1;
            std::ops::ControlFlow::Continue(())
        })
    });
    match read {
        Ok(account) => {
            let others = account.unreadable + account.error_frames + account.without_frame;
            assert_eq!(account.entries, frames + others, "{account:?}");
        }
        Err(error) => one_line(&error),
    }
}

/// A Vector ASC log.
pub fn asc(bytes: &[u8]) {
    frames_of(&[b"base hex  timestamps absolute\n", bytes].concat());
}

/// A Vector BLF log: as it is, and as objects that are in no container, so that damage is not noticed by the checksum of a container.
pub fn blf(bytes: &[u8]) {
    frames_of(bytes);
    frames_of(&[b"LOGG\x08\0\0\0", bytes].concat());
}

/// A candump log as `oleo diagnose` reads it. A drive that is accepted has samples, all of them finite or missing.
pub fn drive_log(bytes: &[u8]) {
    match oleo_hil::drive_log::parse(bytes) {
        Ok(log) => {
            assert!(!log.drives.is_empty());
            for sample in log.drives.iter().flat_map(|drive| &drive.samples) {
                let values = sample
                    .displacement_m
                    .values()
                    .chain(sample.pressure_pa.values().flat_map(|p| [&p.p1, &p.p2, &p.p3, &p.p4]));
                assert!(values.filter_map(|reading| reading.value()).all(f32::is_finite));
            }
        }
        Err(error) => assert!(!error.is_empty() && !error.contains('\n'), "{error}"),
    }
}

/// Reads the bytes as a scenario file.
pub fn scenario(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Err(error) = oleo_hil::scenario::file::parse(text, "any.toml", Path::new(".")) {
        one_line(&error);
    }
}

/// An OpenCRG road, text or binary. A road that is accepted has a finite height everywhere.
pub fn road_crg(bytes: &[u8]) {
    match crg::read(bytes, "any.crg") {
        Ok(road) => heights_are_finite(&road),
        Err(error) => one_line(&error),
    }
}

/// A road profile as CSV; the same promise.
pub fn road_csv(bytes: &[u8]) {
    match profile_from_csv(bytes, "any.csv") {
        Ok(road) => heights_are_finite(&road),
        Err(error) => one_line(&error),
    }
}

/// A strut's `model.toml`. A model that is accepted is written and read again as the same, and gives a strut that can
/// be moved or one line saying why not.
pub fn strut_model(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match StrutModel::from_toml(text, "any.toml") {
        Ok(model) => {
            let written = model.to_toml();
            let again = StrutModel::from_toml(&written, "again.toml").expect("what was written can be read");
            assert_eq!(again.to_toml(), written);
            match Strut::at_rest(&model, StrutValves::default()) {
                Ok(mut strut) => {
                    strut.advance(0.001, 0.001, StrutValves::new(true, true, true));
                }
                Err(error) => one_line(&error),
            }
        }
        Err(error) => one_line(&error),
    }
}

/// A recording as `oleo diagnose` reads it, in its whole or as if it were one of very many rows. What is accepted is
/// finite, in order of time, and every column as long as the others.
pub fn recording(bytes: &[u8]) {
    let spec = ColumnSpec::new;
    let columns = [
        spec("displacement_m", ColumnKind::Input),
        spec("p_Pa", ColumnKind::Output),
        spec("valve1", ColumnKind::Switch),
    ];
    for (rows, gaps) in [(0, GapPolicy::Cut), (1_000_000, GapPolicy::Keep)] {
        match parse(bytes, rows, Path::new("any.csv"), &columns, gaps) {
            Ok(recording) => {
                assert!(recording.time_s.windows(2).all(|w| w[1] > w[0]));
                for column in &recording.columns {
                    assert_eq!(column.len(), recording.len());
                    assert!(column.iter().all(|v| v.is_finite()));
                }
            }
            Err(error) => one_line(&error),
        }
    }
}

/// The `model.toml` of a gas spring, a cylinder, a damper or a drive, as `oleo diagnose` and `oleo predict` read it. A model that is
/// accepted is written and read again as the same, and predicts a recording or says in a line why not.
pub fn specimen_model(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Err(error) = specimen_name(text, "any.toml") {
        one_line(&error);
    }
    let time_s: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.01).collect();
    let x: Vec<f64> = time_s.iter().map(|t| 0.1 * t).collect();
    match GasSpringModel::from_toml(text, "any.toml") {
        Ok(model) => {
            let written = model.to_toml().expect("what was read can be written");
            assert_eq!(GasSpringModel::from_toml(&written, "again.toml"), Ok(model.clone()));
            match model.pressure_pa(&time_s, &x, 1e6) {
                Ok(pressure) => assert_eq!(model.shown(&time_s, pressure).len(), time_s.len()),
                Err(message) => assert!(!message.is_empty() && !message.contains('\n'), "{message}"),
            }
        }
        Err(error) => one_line(&error),
    }
    match CylinderModel::from_toml(text, "any.toml") {
        Ok(model) => {
            let written = model.to_toml().expect("what was read can be written");
            assert_eq!(CylinderModel::from_toml(&written, "again.toml"), Ok(model.clone()));
            let pressures = vec![vec![1e5; time_s.len()]; model.chamber.len()];
            let force = model.force_n(&time_s, &smooth_motion(&time_s, &x, 0.05), &pressures);
            assert_eq!(model.shown(&time_s, force).len(), time_s.len());
        }
        Err(error) => one_line(&error),
    }
    match DamperModel::from_toml(text, "any.toml") {
        Ok(model) => {
            let written = model.to_toml().expect("what was read can be written");
            assert_eq!(DamperModel::from_toml(&written, "again.toml"), Ok(model.clone()));
            match model.force_n(&DamperModel::motion(&time_s, &x)) {
                Ok(force) => assert_eq!(model.shown(&time_s, force).len(), time_s.len()),
                Err(message) => assert!(!message.is_empty() && !message.contains('\n'), "{message}"),
            }
        }
        Err(error) => one_line(&error),
    }
    match DriveModel::from_toml(text, "any.toml") {
        Ok(model) => {
            let written = model.to_toml().expect("what was read can be written");
            assert_eq!(DriveModel::from_toml(&written, "again.toml"), Ok(model.clone()));
            match model.position_m(&time_s, &x, &DriveModel::motion(&time_s, &x)) {
                Ok(position) => assert_eq!(model.shown(&time_s, position).len(), time_s.len()),
                Err(message) => assert!(!message.is_empty() && !message.contains('\n'), "{message}"),
            }
        }
        Err(error) => one_line(&error),
    }
}

/// A vehicle's parameter file.
pub fn vehicle_parameters(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Err(error) = VehicleParameters::from_toml(text, "any.toml") {
        one_line(&error);
    }
}

fn heights_are_finite(road: &impl Road) {
    for station_m in [-1.0e9, -1.0, 0.0, 0.3, 17.0, 1.0e9] {
        for lateral_m in [-1.0e3, -0.7, 0.0, 0.7, 1.0e3] {
            let height_m = road.height_m(station_m, lateral_m);
            assert!(height_m.is_finite(), "height {height_m} at ({station_m}, {lateral_m})");
        }
    }
}

/// What people are told is one line.
fn one_line(error: &dyn std::error::Error) {
    let text = error.to_string();
    assert!(!text.is_empty() && !text.contains('\n'), "{text}");
}
