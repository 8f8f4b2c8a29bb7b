//! `oleo convert`: the same drive in every format that is written, and by a map of our own database.
//!
//! Files of other programs are read by `tests/logs_as_people_have_them.py`.

mod support;

use std::fmt::Write as _;
use std::path::Path;

use support::{complaint, run};

fn path(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

fn succeeds(arguments: &[&str]) {
    let ran = run(arguments);
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "oleo {}: {said}", arguments.join(" "));
}

/// A map that reads our own database as a foreign one.
fn map_of_our_database() -> String {
    let mut map = String::new();
    for (key, axle, side, place) in [
        ("front_left", "FRONT", "Left", "FrontLeft"),
        ("front_right", "FRONT", "Right", "FrontRight"),
        ("rear_left", "REAR", "Left", "RearLeft"),
        ("rear_right", "REAR", "Right", "RearRight"),
    ] {
        let works = format!("valid = {{ signal = \"DISPLACEMENT_{axle}.Status{side}\", is = 0 }}");
        let _ = writeln!(
            map,
            "[{key}]\ndisplacement_m = {{ signal = \"DISPLACEMENT_{axle}.Displacement{side}\", {works} }}"
        );
        for point in 1..=4 {
            let message = format!("PRESSURE_{axle}_{}", side.to_uppercase());
            let _ = writeln!(map, "p{point}_Pa = {{ signal = \"{message}.P{point}\" }}");
        }
        for valve in 1..=3 {
            let _ = writeln!(map, "valve{valve} = {{ signal = \"COMMAND.Valve{valve}_{place}\" }}");
        }
    }
    map
}

/// The rows of a CSV file as numbers.
fn numbers(text: &str) -> Vec<Vec<f64>> {
    let number = |field: &str| field.parse().expect("a number");
    text.lines()
        .skip(1)
        .map(|line| line.split(',').map(number).collect())
        .collect()
}

#[test]
fn a_drive_has_the_same_columns_in_every_format() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name);
    let read = |name: &str| std::fs::read_to_string(file(name)).expect("a file");
    succeeds(&["hil", "--duration-s", "2", "--out", path(&file("run"))]);
    let log = file("run/candump.log");
    succeeds(&["convert", path(&log), path(&file("a.asc"))]);
    succeeds(&["convert", path(&file("a.asc")), path(&file("b.log"))]);
    assert_eq!(read("b.log").lines().count(), read("run/candump.log").lines().count());
    succeeds(&["convert", path(&file("b.log")), path(&file("a.blf"))]);
    succeeds(&["convert", path(&file("a.blf")), path(&file("c.log"))]);
    assert_eq!(read("c.log"), read("b.log"));
    for (input, output) in [
        (&log, "a.csv"),
        (&file("a.asc"), "b.csv"),
        (&file("b.log"), "c.csv"),
        (&file("a.blf"), "e.csv"),
    ] {
        succeeds(&["convert", path(input), path(&file(output))]);
    }
    let expected = read("a.csv");
    assert!(
        expected.starts_with("drive,time_s,displacement_front_left_m,p1_front_left_Pa,"),
        "{expected:.200}"
    );
    assert_eq!((read("b.csv"), read("c.csv")), (expected.clone(), expected.clone()));
    assert_eq!(read("e.csv"), expected);
    if cfg!(feature = "logs") {
        by_map_it_has_the_same_columns(folder.path(), &log, &expected);
    }
}

/// Our controller reads in single precision, a map in double.
fn by_map_it_has_the_same_columns(folder: &Path, log: &Path, expected: &str) {
    let file = |name: &str| folder.join(name);
    std::fs::write(file("map.toml"), map_of_our_database()).expect("written");
    let database = Path::new(env!("CARGO_MANIFEST_DIR")).join("controller/oleo.dbc");
    let by_map = ["--dbc", path(&database), "--signals", path(&file("map.toml"))].map(str::to_owned);
    let csv = file("d.csv");
    let mut arguments = vec!["convert", path(log), path(&csv)];
    arguments.extend(by_map.iter().map(String::as_str));
    succeeds(&arguments);
    let mapped = std::fs::read_to_string(csv).expect("a file");
    let (ours, mapped) = (numbers(expected), numbers(&mapped));
    assert_eq!(ours.len(), mapped.len());
    for (ours, mapped) in ours.iter().flatten().zip(mapped.iter().flatten()) {
        let is_same = (ours - mapped).abs() <= 1e-6 * ours.abs() + 1e-9 || ours.is_nan() && mapped.is_nan();
        assert!(is_same, "{ours} {mapped}");
    }
}

/// What needs to be read more than once is copied, and the copy does not stay.
#[cfg(unix)]
#[test]
fn a_pipe_with_two_drives_gives_what_a_file_gives() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name);
    succeeds(&["hil", "--duration-s", "2", "--out", path(&file("run"))]);
    let drive = std::fs::read(file("run/candump.log")).expect("a log");
    std::fs::write(file("two.log"), [&drive[..], &drive].concat()).expect("written");
    std::fs::write(file("map.toml"), map_of_our_database()).expect("written");
    let database = Path::new(env!("CARGO_MANIFEST_DIR")).join("controller/oleo.dbc");
    let map = file("map.toml");
    let by_map = ["--dbc", path(&database), "--signals", path(&map)];
    let mut ways = vec![("csv", &[][..])];
    if cfg!(feature = "mcap") {
        ways.push(("mcap", &[]));
    }
    if cfg!(feature = "parquet") {
        ways.push(("parquet", &[]));
    }
    if cfg!(feature = "logs") {
        ways.push(("csv", &by_map));
    }
    for (end, options) in ways {
        let (of_file, of_pipe) = (file(&format!("file.{end}")), file(&format!("pipe.{end}")));
        succeeds(&[&["convert", path(&file("two.log")), path(&of_file)], options].concat());
        let mut convert = support::oleo(&[&["convert", "/dev/stdin", path(&of_pipe)], options].concat());
        let mut running = (convert
            .stdin(std::process::Stdio::piped())
            .stdout(std::process::Stdio::piped()))
        .spawn()
        .expect("the binary runs");
        let mut pipe = running.stdin.take().expect("a pipe");
        std::io::Write::write_all(&mut pipe, &std::fs::read(file("two.log")).expect("a log")).expect("it reads");
        drop(pipe);
        let ran = running.wait_with_output().expect("it ends");
        let said = String::from_utf8_lossy(&ran.stdout);
        assert!(ran.status.success() && said.starts_with("2 drives"), "{end}: {said}");
        let read = |path: &Path| std::fs::read(path).expect("a file");
        assert!(read(&of_file) == read(&of_pipe), "{end}");
        std::fs::remove_file(of_file).expect("there");
        std::fs::remove_file(of_pipe).expect("there");
    }
    let left = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(left, 3, "only what this test made");
}

#[test]
fn what_cannot_be_converted_is_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name);
    let line = "(0000000001.000000) can0 123#00\n";
    std::fs::write(file("a.log"), line).expect("written");
    let refused = |arguments: &[&str]| complaint(&run(&[&["convert"], arguments].concat()));
    let log = file("a.log");
    assert!(refused(&[path(&log), path(&log)]).contains("is an input"));
    assert!(refused(&[path(&log), path(&file("a.trc"))]).contains("is no format that is written"));
    assert!(refused(&[path(&log), path(&file("a.csv"))]).contains("1 frame with other identifiers"));
    assert!(refused(&[path(&file("none.log")), path(&file("b.log"))]).contains("check the path"));
    assert!(refused(&[path(&log), path(&file("b.log")), "--dbc", "a.dbc"]).contains("--signals"));
    let both = ["--dbc", "none.dbc", "--signals", "none.toml"];
    assert!(refused(&[&[path(&log), path(&file("b.log"))], &both[..]].concat()).contains("leave the options out"));
    for (name, content, said) in [
        ("words.asc", &b"these are words\n"[..], "holds no frame"),
        ("a.blf", b"LOGG\0\0", "is cut off"),
        (
            "b.blf",
            &include_bytes!("golden/frames.blf")[..1000],
            "after 0 whole frames; copy it again",
        ),
    ] {
        std::fs::write(file(name), content).expect("written");
        let complaint = refused(&[path(&file(name)), path(&file("b.log"))]);
        assert!(complaint.contains(name) && complaint.contains(said), "{complaint}");
    }
    // Nothing half-written, and the input as it was.
    assert!(!file("b.log").exists() && !file("a.csv").exists());
    assert_eq!(std::fs::read_to_string(&log).expect("a log"), line);
}

/// What a file is, its content says and not its name; error frames are counted.
#[test]
fn a_blf_log_of_python_can_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name);
    for golden in [
        &include_bytes!("golden/frames.blf")[..],
        include_bytes!("golden/frames-plain.blf"),
    ] {
        std::fs::write(file("a.log"), golden).expect("written");
        let ran = run(&["convert", path(&file("a.log")), path(&file("b.log"))]);
        let said = String::from_utf8_lossy(&ran.stdout);
        let expected = "44 frames of 48 entries; 4 error frames, 0 unreadable entries.";
        assert!(said.starts_with(expected), "{said}");
        let written = std::fs::read_to_string(file("b.log")).expect("a log");
        let count = |what: &str| written.matches(what).count();
        assert_eq!(
            (written.lines().count(), count("##1"), count("#R8")),
            (44, 10, 4),
            "{written}"
        );
        assert!(
            written.starts_with("(0000000000.000000) can1 1AEBDC75#5AD72524\n"),
            "{written}"
        );
    }
}

/// A binary with the feature reads what others write.
#[cfg(feature = "logs")]
#[test]
fn logs_of_other_programs_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name);
    let refused = |arguments: &[&str]| complaint(&run(&[&["convert"], arguments].concat()));
    let (log, csv) = (file("a.log"), file("a.csv"));
    std::fs::write(&log, "(0000000001.000000) can0 123#00\n").expect("written");
    let none = ["--dbc", "none.dbc", "--signals", "none.toml"];
    let arguments = [&[path(&log), path(&csv)], &none[..]].concat();
    assert!(refused(&arguments).contains("none.toml: cannot read"));
    std::fs::write(file("cut.mf4"), &include_bytes!("golden/frames.mf4")[..5000]).expect("written");
    let complaint = refused(&[path(&file("cut.mf4")), path(&file("b.log"))]);
    assert!(
        complaint.contains("cut.mf4: ") && complaint.contains("the file is damaged or was cut off"),
        "{complaint}"
    );
    // Frames of an MDF 4 file, CAN FD among them.
    std::fs::write(file("whole.mf4"), include_bytes!("golden/frames.mf4")).expect("written");
    succeeds(&["convert", path(&file("whole.mf4")), path(&file("b.log"))]);
    let written = std::fs::read_to_string(file("b.log")).expect("a log");
    assert_eq!(
        (written.lines().count(), written.matches("##1").count()),
        (40, 10),
        "{written}"
    );
}

/// A binary without it says how to come by one.
#[cfg(not(feature = "logs"))]
#[test]
fn logs_of_other_programs_are_refused_with_the_command_that_builds_their_readers() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name);
    std::fs::write(file("whole.mf4"), include_bytes!("golden/frames.mf4")).expect("written");
    std::fs::write(file("a.log"), "(0000000001.000000) can0 123#00\n").expect("written");
    let (whole, log, csv) = (file("whole.mf4"), file("a.log"), file("a.csv"));
    let by_map = ["--dbc", "car.dbc", "--signals", "map.toml"];
    for arguments in [
        vec!["convert", path(&whole), path(&csv)],
        [&["convert", path(&log), path(&csv)], &by_map[..]].concat(),
    ] {
        let complaint = complaint(&run(&arguments));
        let names_both = [
            "cargo install --path . --features logs",
            "cargo run --release --features logs -- ",
        ]
        .iter()
        .all(|command| complaint.contains(command));
        assert!(names_both, "{complaint}");
        assert!(!csv.exists());
    }
}
