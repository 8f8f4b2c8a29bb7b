//! `oleo hil` end to end: the same commands in every run, the reaction to every fault, one line for every bad input.

mod support;

use std::fs;
use std::path::Path;

use oleo_hil::logs::candump::parse_line;
use oleo_hil::scenario::BUILT_IN;
use support::{complaint, is_as_documented, no_panic, oleo, run, summary};

fn hil(arguments: &[&str], out: &Path) -> serde_json::Value {
    let mut all = vec!["hil", "--out", out.to_str().unwrap()];
    all.extend(arguments);
    let output = run(&all);
    no_panic(&output);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{arguments:?}\n{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    is_as_documented(out, "hil");
    summary(out)
}

/// The default scenario commands the same on every run, on one and two threads; `tests/golden/belgian.hash` is what it commanded
/// when last looked at. Where a change of controller or plant is meant to change it: run with OLEO_BLESS=1.
#[test]
fn the_same_commands_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let hash = |arguments: &[&str], name: &str| hil(arguments, &folder.path().join(name))["command_hash"].clone();
    let first = hash(&[], "first");
    assert_eq!(first, hash(&[], "second"));
    assert_eq!(first, hash(&["--threads", "2"], "threads"));
    assert_ne!(first, hash(&["--seed", "2"], "seed"));
    for file in ["candump.log", "timeseries.csv", "junit.xml"] {
        let read = |name: &str| fs::read(folder.path().join(name).join(file)).unwrap();
        assert!(read("first") == read("second"), "{file}: the same bytes");
    }
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/belgian.hash");
    let first = first.as_str().unwrap();
    if std::env::var_os("OLEO_BLESS").is_some() {
        fs::write(&golden, format!("{first}\n")).unwrap();
    }
    assert_eq!(
        fs::read_to_string(&golden).unwrap().trim(),
        first,
        "see the comment of this test"
    );
}

/// The summary of a lane change on Belgian block, less the wall clock's figures; `tests/golden/lane-change-on-belgian.json` is what
/// it was when last looked at. Where a change of controller or plant is meant to change it: run with OLEO_BLESS=1.
#[test]
fn a_lane_change_in_the_middle_of_a_rough_road() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = |more: &[&str], name: &str| {
        let arguments = [&["--scenario", "lane-change-on-belgian"], more].concat();
        let mut summary = hil(&arguments, &folder.path().join(name));
        // The version names the commit.
        for key in ["wall_s", "real_time_factor", "version"] {
            summary.as_object_mut().unwrap().remove(key);
        }
        summary
    };
    let first = scenario(&[], "first");
    assert_eq!(first, scenario(&["--threads", "2"], "threads"));
    for file in ["candump.log", "timeseries.csv"] {
        let read = |name: &str| fs::read(folder.path().join(name).join(file)).unwrap();
        assert!(read("first") == read("threads"), "{file}: the same bytes");
    }
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/lane-change-on-belgian.json");
    if std::env::var_os("OLEO_BLESS").is_some() {
        fs::write(&golden, serde_json::to_string_pretty(&first).unwrap() + "\n").unwrap();
    }
    let expected: serde_json::Value = serde_json::from_str(&fs::read_to_string(&golden).unwrap()).unwrap();
    assert_eq!(first, expected, "see the comment of this test");
    let page = fs::read_to_string(folder.path().join("first/report.html")).unwrap();
    assert!(page.contains("<h2>Manoeuvre</h2>"));
    let hard = scenario(&["--driver", "hard", "--load", "laden", "--speed-km-h", "40"], "hard");
    assert_ne!(hard["command_hash"], first["command_hash"]);
    assert_eq!(
        (&hard["driver"], &hard["load"], &first["driver"]),
        (&"hard".into(), &"laden".into(), &"eased".into())
    );
}

/// Columns of a CSV file, as text.
fn columns(file: &Path, names: &[&str]) -> Vec<Vec<String>> {
    let csv = fs::read_to_string(file).unwrap();
    let heads: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let places: Vec<usize> = (names.iter())
        .map(|name| heads.iter().position(|head| head == name).expect(name))
        .collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        places.iter().map(|place| cells[*place].to_owned()).collect()
    };
    csv.lines().skip(1).map(row).collect()
}

/// With its valves never switched the vehicle drives over the bus what `oleo drive` drives without one, digit by digit.
#[test]
fn a_fixed_setting_drives_as_without_a_bus() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let course = [
        "--load",
        "roof",
        "--road",
        "iso-d",
        "--entry-m",
        "40",
        "--driver",
        "hard",
    ];
    let manoeuvre = ["--manoeuvre", "lane-change", "--duration-s", "10", "--speed-km-h", "50"];
    let out = path("drive");
    let drive = ["drive", "--setting", "stiff", "--out", out.to_str().unwrap()];
    let output = run(&[&drive[..], &course, &manoeuvre].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let fixed = ["--scenario", "belgian", "--strategy", "always-stiff"];
    hil(&[&fixed[..], &course, &manoeuvre].concat(), &path("hil"));
    let names = [
        "station_m",
        "lateral_m",
        "roll_rad",
        "yaw_rad",
        "speed_m_s",
        "steer_rad",
    ];
    let with = columns(&path("hil/timeseries.csv"), &names);
    let without = columns(&path("drive/handling-model.csv"), &names);
    assert_eq!(with.len(), 2000);
    for (tick, (with, without)) in with.iter().zip(&without).enumerate() {
        assert_eq!(with, without, "tick {tick}");
    }
}

#[test]
fn the_default_run_leaves_what_it_promises() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let summary = hil(&["--duration-s", "5"], &out);
    for key in [
        "ticks",
        "simulated_s",
        "wall_s",
        "real_time_factor",
        "command_hash",
        "frames_sent",
        "frames_lost",
        "e2e_errors",
        "bus_load_500k",
        "weighted_rms_driver_m_s2",
        "weighted_rms_rear_left_m_s2",
        "max_roll_deg",
        "valve_switches",
        "checks",
    ] {
        assert!(!summary[key].is_null(), "{key}");
    }
    assert_eq!(summary["valve_switches"].as_array().unwrap().len(), 12);
    assert!(
        summary["checks"]
            .as_array()
            .unwrap()
            .iter()
            .all(|check| check["name"].is_string())
    );
    assert_eq!(
        (summary["frames_lost"].as_u64(), summary["e2e_errors"].as_u64()),
        (Some(0), Some(0))
    );
    let load = summary["bus_load_500k"].as_f64().unwrap();
    assert!(
        (0.25..0.38).contains(&load),
        "{load}: seven frames of 111 to 135 bits in 2500"
    );

    let log = fs::read_to_string(out.join("candump.log")).unwrap();
    let lines: Vec<_> = log.lines().map(|line| parse_line(line).expect(line)).collect();
    assert_eq!(lines.len() as u64, summary["frames_sent"].as_u64().unwrap());
    assert!(lines.windows(2).all(|pair| pair[0].time_us <= pair[1].time_us));

    let csv = fs::read_to_string(out.join("timeseries.csv")).unwrap();
    let columns = csv.lines().next().unwrap().split(',').count();
    assert_eq!(csv.lines().count(), 1001);
    assert!(csv.lines().all(|line| line.split(',').count() == columns));

    let page = fs::read_to_string(out.join("report.html")).unwrap();
    for heading in ["Road", "Body motion", "Struts", "Controller", "Bus"] {
        assert!(page.contains(&format!("<h2>{heading}</h2>")), "{heading}");
    }
    assert!(
        !page.contains("<script src") && !page.contains("<link "),
        "opens offline"
    );
    let mut names: Vec<_> = fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            ".oleo",
            "candump.log",
            "handling.toml",
            "junit.xml",
            "oleo.dbc",
            "report.html",
            "scenario.toml",
            "strut.toml",
            "summary.json",
            "timeseries.csv",
            "vehicle.toml",
        ]
    );
}

#[test]
fn every_built_in_scenario_meets_its_checks() {
    let folder = tempfile::tempdir().unwrap();
    let failures: Vec<String> = BUILT_IN
        .iter()
        .filter(|(name, _)| *name != "belgian")
        .filter_map(|(name, _)| {
            let out = folder.path().join(name);
            let output = run(&["hil", "--scenario", name, "--out", out.to_str().unwrap()]);
            no_panic(&output);
            (output.status.code() != Some(0)).then(|| format!("{name}\n{}", String::from_utf8_lossy(&output.stdout)))
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_failed_check_is_exit_status_1_and_in_every_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("own.toml");
    let text = "name = \"own\"\nroad = \"flat\"\nspeed_km_h = 30\nduration_s = 1\n\
                [[check]]\nmetric = \"frames_lost\"\nat_least = 1\n[[check]]\nmetric = \"ticks\"\nequals = 200\n";
    fs::write(&file, text).unwrap();
    let out = folder.path().join("out");
    let output = run(&[
        "hil",
        "--scenario",
        file.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(1));
    let summary = summary(&out);
    assert_eq!(summary["checks"][0]["passed"], false);
    assert_eq!(summary["checks"][1]["passed"], true);
    let junit = fs::read_to_string(out.join("junit.xml")).unwrap();
    assert!(
        junit.contains("tests=\"2\"") && junit.contains("failures=\"1\""),
        "{junit}"
    );
}

/// What needs no emulator of the image in the loop; `./test emulated-board` runs it.
#[test]
fn an_image_that_cannot_run_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("image.elf");
    let mut head = b"\x7fELF\x01\x01".to_vec();
    head.resize(18, 0);
    head.extend([40, 0]);
    fs::write(&image, head).unwrap();
    let image = image.to_str().unwrap();
    let mut command = oleo(&["hil", "--no-out", "--firmware", image]);
    let text = complaint(&command.env("PATH", folder.path()).output().unwrap());
    assert!(text.contains("install the package qemu-system-arm"), "{text}");
    let text = complaint(&run(&["hil", "--firmware", "Cargo.toml"]));
    assert!(text.contains("Cargo.toml: is no ELF file for an Arm"), "{text}");
    let stiff = folder.path().join("stiff.toml");
    let text = "name = \"own\"\nroad = \"flat\"\nspeed_km_h = 30\nduration_s = 1\nstrategy = \"always-stiff\"\n";
    fs::write(&stiff, text).unwrap();
    let text = complaint(&run(&[
        "hil",
        "--firmware",
        image,
        "--scenario",
        stiff.to_str().unwrap(),
    ]));
    assert!(text.contains("sets strategy, which an image has of its own"), "{text}");
    let conflict = run(&["hil", "--no-out", "--firmware", image, "--strategy", "always-stiff"]);
    assert_eq!(conflict.status.code(), Some(2));
    let restarted = run(&[
        "hil",
        "--no-out",
        "--firmware",
        image,
        "--scenario",
        "restarted-controller",
    ]);
    assert!(complaint(&restarted).contains("restarts the controller"));
}

#[test]
fn what_is_no_image_is_not_sealed() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("image"), "#!/bin/sh").unwrap();
    for (arguments, expected) in [
        (vec!["seal", &path("image")], "image: is no 32-bit ELF file"),
        (vec!["seal", &path("absent")], "absent: No such file"),
    ] {
        let text = complaint(&run(&arguments));
        assert!(text.contains(expected), "{text}");
    }
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1);
}

#[test]
fn bad_input_is_one_line_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(
        path("bad.toml"),
        "name = \"x\"\nroad = \"flat\"\nspeed_km_h = 60\nduration_s = -2\n",
    )
    .unwrap();
    fs::write(path("bytes.toml"), [0xFF, 0xFE, 0x00]).unwrap();
    fs::write(path("empty.toml"), "").unwrap();
    fs::write(path("strut.toml"), "[specimen]\nname = 3\n").unwrap();
    fs::write(path("road.crg"), "no road").unwrap();
    fs::write(path("a-file"), "").unwrap();
    let out = path("out");
    let table: &[(&[&str], &str)] = &[
        (&["--scenario", "belgium"], "belgian, apg"),
        (&["--scenario", &path("bad.toml")], "bad.toml:4: duration_s is -2"),
        (&["--scenario", &path("bytes.toml")], "bytes.toml"),
        (&["--scenario", &path("empty.toml")], "empty.toml:1: name is missing"),
        (&["--scenario", &path("nowhere.toml")], "nowhere.toml"),
        (&["--strut", &path("strut.toml")], "strut.toml"),
        (&["--strut", &path("nowhere.toml")], "nowhere.toml"),
        (
            &["--strut-at", &format!("rear-left={}", path("nowhere.toml"))],
            "nowhere.toml",
        ),
        (&["--strut-at", "rear=weak.toml"], "the corners are front-left"),
        (&["--vehicle", &path("strut.toml")], "strut.toml"),
        (&["--road", &path("road.crg")], "road.crg"),
        (&["--road", "cobbles"], "cobbles"),
        (&["--speed-km-h", "-1"], "--speed-km-h is -1"),
        (&["--speed-km-h", "nan"], "--speed-km-h is NaN"),
        (&["--duration-s", "1e9"], "--duration-s is 1000000000"),
        (&["--strategy", "sporty"], "always-soft"),
        (&["--clock", "sundial"], "lockstep, realtime"),
        (&["--bus", "can0"], "socketcan:vcan0"),
        (&["--bus", "socketcan:nosuchcan0"], "ip link"),
        (&["--bus", "slcan:/nonexistent"], "/nonexistent"),
        (&["--bus", "slcan:tcp:127.0.0.1:1"], "--node"),
        (&["--node", "plant"], "--bus socketcan"),
        (&["--node", "driver"], "plant"),
        (&["--xcp"], "--bus socketcan:IFACE"),
        (
            &["--xcp", "--node", "plant", "--bus", "socketcan:vcan0"],
            "controller's node",
        ),
        (&["--xcp", "250000"], "500000, 1000000"),
        (&["--xcp-write"], "--xcp"),
        (&["--threads", "3"], "--threads"),
        (&["--rod", "flat"], "--road"),
        (&["--handling", &path("strut.toml")], "strut.toml"),
        (&["--manoeuvre", "lane_change"], "lane-change-2"),
        (&["--load", "heavy"], "laden-roof"),
        (
            &["--driver", "hard"],
            "--driver has no use, since the scenario belgian has no manoeuvre",
        ),
        (&["--entry-m", "50"], "take the manoeuvre straight or another"),
        (
            &["--scenario", "step-steer", "--entry-m", "50"],
            "--entry-m does not belong",
        ),
        (
            &["--scenario", "step-steer", "--driver", "hard"],
            "--driver does not belong",
        ),
        (
            &["--scenario", "step-steer", "--duration-s", "4"],
            "--begin-s is 6: the drive ends",
        ),
        (
            &["--manoeuvre", "lane-change", "--speed-km-h", "0"],
            "--speed-km-h is 0",
        ),
        (
            &["--manoeuvre", "straight", "--side-slope-percent", "50"],
            "--side-slope-percent is 50",
        ),
    ];
    for (arguments, expected) in table {
        let mut all = vec!["hil", "--out", &out];
        all.extend(*arguments);
        let text = complaint(&run(&all));
        assert!(text.contains(expected), "{arguments:?}: {text}");
        assert!(!Path::new(&out).exists(), "{arguments:?} left something");
    }
    for folder_that_cannot_be in [path("a-file"), path("a-file/new"), "/proc/oleo".into()] {
        complaint(&run(&["hil", "--duration-s", "0.1", "--out", &folder_that_cannot_be]));
    }
}

#[test]
fn real_time_reports_its_deadlines() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let output = run(&[
        "hil",
        "--clock",
        "realtime",
        "--duration-s",
        "1",
        "--out",
        out.to_str().unwrap(),
    ]);
    no_panic(&output);
    let summary = summary(&out);
    let nodes = summary["lateness"].as_array().unwrap();
    assert_eq!(nodes.len(), 2);
    assert!(
        nodes
            .iter()
            .all(|node| node["max_us"].as_u64().unwrap() >= node["p50_us"].as_u64().unwrap())
    );
    assert!(summary["wall_s"].as_f64().unwrap() >= 0.99);
}

/// The measured surface is not in this repository.
#[test]
fn the_measured_belgian_block() {
    let surface = "../shared/roads/belgian_block.crg";
    if !Path::new(env!("CARGO_MANIFEST_DIR")).join(surface).exists() {
        println!("SKIPPED: {surface} is not here");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let summary = hil(&["--road", surface], &folder.path().join("run"));
    let felt = summary["weighted_rms_driver_m_s2"].as_f64().unwrap();
    assert!((0.5..6.0).contains(&felt), "{felt} m/s2");
}

#[test]
fn help_has_examples_and_units() {
    let output = run(&["hil", "--help"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && text.contains("Examples:") && text.contains("km/h"),
        "{text}"
    );
    assert!(run(&["hil", "--list"]).status.success());
}

/// The folder of a run holds what repeats it, whatever the command line changed.
#[test]
fn a_run_is_repeated_from_its_own_folder() {
    let folder = tempfile::tempdir().unwrap();
    let [given, weak, first, again] =
        ["given.toml", "weak.toml", "first", "again"].map(|name| folder.path().join(name));
    let strut = run(&["show", "strut"]);
    let wider = String::from_utf8(strut.stdout)
        .unwrap()
        .replacen("bore_m = 0.05", "bore_m = 0.051", 1);
    let less_gas = wider.replacen("static_gas_volume_m3 = 0.0004", "static_gas_volume_m3 = 0.0003", 1);
    assert_ne!(less_gas, wider);
    fs::write(&weak, less_gas).unwrap();
    fs::write(&given, wider).unwrap();
    let text = |path: &Path| path.to_str().unwrap().to_owned();
    let changed = [
        "--manoeuvre",
        "step-steer",
        "--speed-km-h",
        "47.12345678912",
        "--load",
        "laden",
        "--seed",
        "7",
        "--duration-s",
        "2",
    ];
    let (strut, out) = (text(&given), text(&first));
    let at_corner = format!("rear-left={}", text(&weak));
    let output = run(&[
        &[
            "hil",
            "--scenario",
            "apg",
            "--road",
            "iso-c",
            "--strut",
            &strut,
            "--strut-at",
            &at_corner,
            "--out",
            &out,
        ][..],
        &changed,
    ]
    .concat());
    assert!(
        matches!(output.status.code(), Some(0 | 1)),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let scenario = text(&first.join("scenario.toml"));
    let output = run(&["hil", "--scenario", &scenario, "--out", &text(&again)]);
    assert!(
        matches!(output.status.code(), Some(0 | 1)),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let bytes = |folder: &Path, name: &str| fs::read(folder.join(name)).unwrap();
    for name in [
        "timeseries.csv",
        "candump.log",
        "strut.toml",
        "strut-rear-left.toml",
        "scenario.toml",
    ] {
        assert_eq!(bytes(&first, name), bytes(&again, name), "{name}");
    }
    assert!(
        String::from_utf8(bytes(&first, "strut.toml"))
            .unwrap()
            .contains("bore_m = 0.051")
    );
    assert_eq!(bytes(&first, "strut-rear-left.toml"), fs::read(&weak).unwrap());
}
