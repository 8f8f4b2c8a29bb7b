//! `oleo hil --imu` end to end: what the log says by its database is what the vehicle did, and nothing else changes.

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use oleo_hil::logs::candump::parse_line;
use support::{complaint, is_as_documented, no_panic, run, summary};

fn hil(arguments: &[&str], out: &Path) -> serde_json::Value {
    let mut all = vec!["hil", "--out", out.to_str().unwrap()];
    all.extend(arguments);
    let output = run(&all);
    no_panic(&output);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    is_as_documented(out, "hil");
    summary(out)
}

/// Columns of a CSV file by name.
fn columns(file: &Path) -> BTreeMap<String, Vec<f64>> {
    let csv = fs::read_to_string(file).unwrap();
    let heads: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let mut columns = vec![Vec::new(); heads.len()];
    for line in csv.lines().skip(1) {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            column.push(cell.parse().unwrap_or(f64::NAN));
        }
    }
    heads.into_iter().map(str::to_owned).zip(columns).collect()
}

/// What a column holds in a tick.
fn value(columns: &BTreeMap<String, Vec<f64>>, name: &str, tick: usize) -> f64 {
    columns[name][tick]
}

/// A signal as a database says it: first bit, length, step.
struct Signal {
    name: String,
    start: u32,
    length: u32,
    step: f64,
}

/// The signals of each message, read from the text of the database alone. All are little-endian and, but for the protection, signed.
fn database(text: &str) -> BTreeMap<u32, Vec<Signal>> {
    let mut messages: BTreeMap<u32, Vec<Signal>> = BTreeMap::new();
    let mut message = 0;
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["BO_", id, ..] => message = id.parse().unwrap(),
            ["SG_", name, ":", bits, scale, ..] if bits.ends_with("@1-") => {
                let (start, length) = bits.strip_suffix("@1-").unwrap().split_once('|').unwrap();
                let step = scale.trim_start_matches('(').split(',').next().unwrap();
                messages.entry(message).or_default().push(Signal {
                    name: (*name).to_owned(),
                    start: start.parse().unwrap(),
                    length: length.parse().unwrap(),
                    step: step.parse().unwrap(),
                });
            }
            _ => {}
        }
    }
    messages
}

/// The values of each signal of the unit in a log, in the order of the log.
fn decoded(log: &Path, dbc: &str) -> BTreeMap<String, Vec<f64>> {
    let database = database(dbc);
    let mut values: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for line in fs::read_to_string(log).unwrap().lines() {
        let entry = parse_line(line).expect("a line");
        let id = entry.frame.standard_id().map(u32::from);
        let Some(signals) = id.and_then(|id| database.get(&id)) else {
            continue;
        };
        let bits = u64::from_le_bytes(entry.frame.data().try_into().expect("eight bytes"));
        for signal in signals {
            let raw = (bits << (64 - signal.start - signal.length)).cast_signed() >> (64 - signal.length);
            values
                .entry(signal.name.clone())
                .or_default()
                .push(raw as f64 * signal.step);
        }
    }
    values
}

fn shown_dbc() -> String {
    String::from_utf8(run(&["show", "imu-dbc"]).stdout).unwrap()
}

/// Name in the database, column, and standard deviation of noise and rounding together.
const AXES: [(&str, &str, f64); 6] = [
    ("SpecificForceX", "imu_specific_force_x_m_s2", 0.017),
    ("SpecificForceY", "imu_specific_force_y_m_s2", 0.017),
    ("SpecificForceZ", "imu_specific_force_z_m_s2", 0.017),
    ("RateX", "imu_rate_x_rad_s", 0.0024),
    ("RateY", "imu_rate_y_rad_s", 0.0024),
    ("RateZ", "imu_rate_z_rad_s", 0.0024),
];

/// The log differs from what the vehicle did by white noise of the stated size.
fn differs_by_noise(read: &BTreeMap<String, Vec<f64>>, did: &BTreeMap<String, Vec<f64>>) {
    for (signal, column, deviation) in AXES {
        let (read, did) = (&read[signal], &did[column]);
        assert_eq!(read.len(), did.len(), "{signal}");
        let errors: Vec<f64> = read.iter().zip(did).map(|(a, b)| a - b).collect();
        let power = errors.iter().map(|e| e * e).sum::<f64>();
        let rms = (power / errors.len() as f64).sqrt();
        assert!((rms / deviation - 1.0).abs() < 0.08, "{signal}: {rms}");
        let next = errors.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / power;
        assert!(next.abs() < 0.12, "{signal}: neighbours alike, {next}");
    }
}

#[test]
fn the_log_says_what_the_body_did_on_a_rough_road() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let [x, y, z] = [0.4, -0.3, 0.2];
    let with = hil(&["--duration-s", "6", "--imu=0.4,-0.3,0.2"], &path("with"));
    let without = hil(&["--duration-s", "6"], &path("without"));
    assert_eq!(with["command_hash"], without["command_hash"]);
    assert_eq!(
        with["frames_sent"].as_u64().unwrap(),
        without["frames_sent"].as_u64().unwrap() + 2 * 1200
    );
    assert_eq!((&with["frames_lost"], &with["foreign_frames"]), (&0.into(), &0.into()));
    let load = with["bus_load_500k"].as_f64().unwrap();
    assert!(
        load > without["bus_load_500k"].as_f64().unwrap() + 0.08 && load < 0.489,
        "{load}"
    );

    let dbc = shown_dbc();
    assert_eq!(fs::read_to_string(path("with/imu.dbc")).unwrap(), dbc);
    assert!(!path("without/imu.dbc").exists());
    let did = columns(&path("with/timeseries.csv"));
    differs_by_noise(&decoded(&path("with/candump.log"), &dbc), &did);
    // The columns of the unit are the motion of the body at its place, to terms of second order.
    let (mut moved, mut missed) = ([0.0; 2], [0.0; 2]);
    for tick in 0..1200 {
        let at = |name: &str| value(&did, name, tick);
        let (pitch, roll) = (at("pitch_acceleration_rad_s2"), at("roll_acceleration_rad_s2"));
        let upward = 9.806_65 + at("heave_acceleration_m_s2");
        let up = upward - x * pitch + y * roll;
        let along = z * pitch - upward * at("pitch_rad");
        for (k, name, expected) in [(0, "z", up), (1, "x", along)] {
            let error = at(&format!("imu_specific_force_{name}_m_s2")) - expected;
            missed[k] += error * error / 1200.0;
        }
        moved[0] += (up - 9.806_65) * (up - 9.806_65) / 1200.0;
        moved[1] += along * along / 1200.0;
    }
    assert!(moved[0] > 0.5 && moved[1] > 0.01, "{moved:?}");
    // Mean squares: what is left are terms of second order.
    assert!(
        missed[0] < 0.002 * moved[0] && missed[1] < 0.02 * moved[1],
        "{missed:?} of {moved:?}"
    );
    // All other columns and frames are those of the run without a unit.
    for (name, values) in columns(&path("without/timeseries.csv")) {
        assert!(
            values.iter().zip(&did[&name]).all(|(a, b)| a.to_bits() == b.to_bits()),
            "{name}"
        );
    }
}

#[test]
fn the_log_says_what_the_body_did_in_a_lane_change() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let drive = [
        "--manoeuvre",
        "lane-change",
        "--road",
        "flat",
        "--speed-km-h",
        "70",
        "--duration-s",
        "8",
        "--load",
        "laden",
        "--imu",
    ];
    hil(&drive, &path("one"));
    hil(&[&drive[..], &["--threads", "2"]].concat(), &path("two"));
    for file in ["candump.log", "timeseries.csv", "scenario.toml"] {
        let read = |name: &str| fs::read(path(name).join(file)).unwrap();
        assert!(read("one") == read("two"), "{file}: the same bytes");
    }
    let did = columns(&path("one/timeseries.csv"));
    differs_by_noise(&decoded(&path("one/candump.log"), &shown_dbc()), &did);
    // The load has moved the centre of mass away from the unit, by the closed form of two masses: 1,670 kg of body and 900 kg of load.
    let vehicle = oleo_plant_sim::vehicle::VehicleParameters::defender110();
    let share = 900.0 / (900.0 + vehicle.body.sprung_mass_kg);
    let ahead = share * (2.55 - vehicle.body_cg_behind_front_axle_m());
    let above = -share * (1.05 - vehicle.body_cg_height_m());
    let mut largest: f64 = 0.0;
    for tick in 1..did["time_s"].len() - 1 {
        let at = |name: &str| value(&did, name, tick);
        let yaw_acceleration = (did["yaw_rate_rad_s"][tick + 1] - did["yaw_rate_rad_s"][tick - 1]) / 0.01;
        let upward = 9.806_65 + at("heave_acceleration_m_s2");
        let across = at("lateral_acceleration_m_s2") + upward * at("roll_rad") + ahead * yaw_acceleration
            - above * at("roll_acceleration_rad_s2");
        assert!(
            (at("imu_specific_force_y_m_s2") - across).abs() < 0.08,
            "{tick}: {across}"
        );
        assert!((at("imu_rate_z_rad_s") - at("yaw_rate_rad_s")).abs() < 1e-3);
        largest = largest.max(across.abs());
    }
    assert!(largest > 3.0, "{largest}");
    // The run is repeated by its scenario, which has the unit.
    let scenario = path("one/scenario.toml");
    hil(&["--scenario", scenario.to_str().unwrap()], &path("again"));
    let read = |name: &str| fs::read(path(name).join("candump.log")).unwrap();
    assert!(read("again") == read("one"));
}

#[test]
fn logs_with_a_unit_are_converted() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    hil(&["--duration-s", "3", "--imu"], &folder.path().join("run"));
    hil(&["--duration-s", "1"], &folder.path().join("without"));
    let convert = |arguments: &[&str]| run(&[&["convert"], arguments].concat());
    for (from, to) in [
        ("run/candump.log", "frames.asc"),
        ("frames.asc", "frames.blf"),
        ("frames.blf", "columns.csv"),
    ] {
        let unit: &[&str] = if to.ends_with("csv") { &["--imu"] } else { &[] };
        let output = convert(&[&[path(from).as_str(), path(to).as_str()], unit].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(
            unit.is_empty() || said.contains(" and 1200 of an inertial unit; 0 lost"),
            "{said}"
        );
    }
    let read = columns(Path::new(&path("columns.csv")));
    let decoded = decoded(Path::new(&path("run/candump.log")), &shown_dbc());
    for (signal, column, _) in AXES {
        let same = read[column]
            .iter()
            .zip(&decoded[signal])
            .all(|(a, b)| (a - b).abs() < 1e-5);
        assert!(same && read[column].len() == 600, "{column}");
    }
    // The option adds columns to those without it.
    assert!(convert(&[&path("frames.blf"), &path("plain.csv")]).status.success());
    let plain = columns(Path::new(&path("plain.csv")));
    assert_eq!(plain.len() + 6, read.len());

    let refused = convert(&[&path("without/candump.log"), &path("none.csv"), "--imu"]);
    assert!(complaint(&refused).contains("no message of an inertial unit"));
    assert!(!Path::new(&path("none.csv")).exists());
    let refused = convert(&[&path("run/candump.log"), &path("none.asc"), "--imu"]);
    assert!(complaint(&refused).contains("frames are converted as they are"));
}

#[test]
fn a_bad_place_is_one_line() {
    for (arguments, expected) in [
        (vec!["--imu=9,0,0"], "--imu is 9,0,0: x_m is 9: must be from -5 to 5 m"),
        (vec!["--imu=0,nan,0"], "must be from -2 to 2 m"),
        (
            vec!["--imu", "--node", "controller", "--bus", "socketcan:none0"],
            "the controller's node has no body",
        ),
    ] {
        let text = complaint(&run(&[&["hil", "--no-out"], &arguments[..]].concat()));
        assert!(text.contains(expected), "{text}");
    }
    let refused = run(&["hil", "--no-out", "--imu=1,2"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("is no place: give three numbers in m"));
}
