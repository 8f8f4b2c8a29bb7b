//! What every command leaves behind and says: nothing of the user's is replaced, results lie where they are expected, a run is
//! titled by what was run, and the exit status is right when the disk is full or a signal comes.
#![cfg(unix)]

use std::fs;
use std::io::Read as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// The shortest run with a page.
const SHORT: [&str; 3] = ["hil", "--duration-s", "0.5"];

fn oleo(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_oleo"));
    command.args(arguments).current_dir(folder);
    command
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    oleo(folder, arguments).output().expect("the binary runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The one line of a refusal.
fn refused(output: &Output) -> String {
    let line = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{line}");
    assert!(line.starts_with("error: ") && line.lines().count() == 1, "{line}");
    line
}

/// Every file below a folder with its contents.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let name = entry.path().display().to_string();
        if entry.path().is_dir() {
            all.push((name, Vec::new()));
            all.extend(contents(&entry.path()));
        } else {
            all.push((name, fs::read(entry.path()).expect("a file")));
        }
    }
    all.sort();
    all
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// A folder with a strut model, a recording made with it, and a scenario.
fn campaign() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mine = folder.path().join("mine");
    fs::create_dir(&mine).expect("made");
    let model = oleo_plant_sim::strut::StrutModel::defender110(8000.0);
    fs::write(mine.join("model.toml"), model.to_toml()).expect("written");
    let made = run(folder.path(), &["rig", "replay", "--out", "replay"]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    fs::copy(folder.path().join("replay/comparison.csv"), mine.join("a.csv")).expect("copied");
    fs::remove_dir_all(folder.path().join("replay")).expect("removed");
    let road = "station_m,left_m,right_m\n0,0,0\n5,0.01,0\n10,0,0.01\n";
    fs::write(folder.path().join("road.csv"), road).expect("written");
    fs::write(mine.join("belief.toml"), model.to_toml()).expect("written");
    std::os::unix::fs::symlink("mine", folder.path().join("link")).expect("linked");
    folder
}

#[test]
fn no_command_writes_into_a_folder_of_the_user() {
    let folder = campaign();
    let before = contents(folder.path());
    for out in ["mine", "link", "mine/../mine", "."] {
        for arguments in [
            &["hil", "--strut", "mine/model.toml", "--duration-s", "0.1"][..],
            &[
                "drive",
                "--manoeuvre",
                "straight",
                "--road",
                "road.csv",
                "--duration-s",
                "1",
            ],
            &["rig", "limits", "--strut", "mine/model.toml"],
            &["rig", "replay", "mine/a.csv"],
            &["study", "sweep"],
            &["study", "control"],
            &["diagnose", "mine"],
            &["diagnose", "--self-test"],
            &["diagnose", "--self-test", "--save", "--campaigns", "1"],
        ] {
            let line = refused(&run(folder.path(), &[arguments, &["--out", out]].concat()));
            assert!(
                line.contains("oleo did not write") && line.contains("--force"),
                "{arguments:?}: {line}"
            );
            assert_eq!(contents(folder.path()), before, "{arguments:?}");
        }
    }
    for (out, says) in [
        ("/", "the root of the file system"),
        ("mine/a.csv", "not a folder"),
        ("/proc/oleo", "cannot write here"),
        ("mine/a.csv/new/out", "not a folder"),
    ] {
        let line = refused(&run(folder.path(), &[&SHORT[..], &["--out", out, "--force"]].concat()));
        assert!(line.contains(says), "{line}");
    }
    assert_eq!(contents(folder.path()), before);
}

#[test]
fn force_replaces_no_input() {
    let folder = campaign();
    let before = contents(folder.path());
    let predict = [
        "predict",
        "--model",
        "mine/model.toml",
        "mine/a.csv",
        "--force",
        "--out",
    ];
    for arguments in [
        &["diagnose", "mine", "--out", "link", "--force"][..],
        &[&predict[..], &["link/a.csv"]].concat(),
        &[&predict[..], &["mine/model.toml"]].concat(),
    ] {
        let line = refused(&run(folder.path(), arguments));
        assert!(line.contains("is an input of this command"), "{line}");
        assert_eq!(contents(folder.path()), before);
    }
    // A recording of a campaign is not replaced by mistake either.
    fs::copy(folder.path().join("mine/a.csv"), folder.path().join("mine/b.csv")).expect("copied");
    let other = [
        "predict",
        "--model",
        "mine/model.toml",
        "mine/a.csv",
        "--out",
        "mine/b.csv",
    ];
    assert!(refused(&run(folder.path(), &other)).contains("--force"));
    assert!(
        run(folder.path(), &[&other[..], &["--force"]].concat())
            .status
            .success()
    );
}

#[test]
fn nothing_of_another_command_stays_beside_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let oil = ["rig", "bulk-modulus", "--out", "out"];
    assert!(
        run(folder.path(), &[&SHORT[..], &["--out", "out"]].concat())
            .status
            .code()
            .is_some_and(|code| code < 2)
    );
    let line = refused(&run(folder.path(), &oil));
    assert!(line.contains("has results of oleo hil"), "{line}");
    assert!(run(folder.path(), &[&oil[..], &["--force"]].concat()).status.success());
    assert_eq!(
        names(&out),
        [".oleo", "oil.csv", "report.html", "strut.toml", "summary.json"]
    );
    fs::write(out.join("summary.json"), "{}").expect("edited");
    let line = refused(&run(folder.path(), &oil));
    assert!(line.contains("summary.json: is not as oleo wrote it"), "{line}");
}

#[test]
fn results_lie_in_oleo_out_and_the_last_line_is_the_page() {
    let folder = campaign();
    for (arguments, file) in [
        (&SHORT[..], "oleo-out/hil-belgian/report.html"),
        (
            &["drive", "--manoeuvre", "straight", "--duration-s", "1"],
            "oleo-out/drive-straight/report.html",
        ),
        (
            &["rig", "valve-response", "--points", "3"],
            "oleo-out/rig-valve-response/report.html",
        ),
        (
            &["predict", "--model", "mine/model.toml", "mine/a.csv"],
            "oleo-out/predict-a/a.csv",
        ),
    ] {
        let output = run(folder.path(), arguments);
        let said = text(&output.stdout);
        assert_eq!(said.lines().last(), Some(file), "{said} {}", text(&output.stderr));
        assert!(folder.path().join(file).is_file(), "{file}");
        let given = run(folder.path(), &[arguments, &["--out", "x"]].concat());
        assert!(
            text(&given.stdout)
                .lines()
                .last()
                .is_some_and(|line| line.starts_with('x'))
        );
        let _ = fs::remove_dir_all(folder.path().join("x")).or_else(|_| fs::remove_file(folder.path().join("x")));
    }
    let before = contents(folder.path());
    let tables = run(folder.path(), &[&SHORT[..], &["--no-out"]].concat());
    assert!(text(&tables.stdout).contains("command hash") && !text(&tables.stdout).contains("report.html"));
    assert_eq!(contents(folder.path()), before);
}

#[test]
fn a_failure_leaves_no_empty_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    refused(&run(folder.path(), &["hil", "--road", "none.csv"]));
    assert!(names(folder.path()).is_empty());
}

#[test]
fn without_a_browser_the_results_are_as_good() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = oleo(folder.path(), &[&SHORT[..], &["--open"]].concat())
        .env("PATH", "")
        .output()
        .expect("the binary runs");
    let line = text(&output.stderr);
    assert!(output.status.code().is_some_and(|code| code < 2), "{line}");
    assert!(
        line.starts_with("--open: no browser") && line.lines().count() == 1,
        "{line}"
    );
    assert!(folder.path().join("oleo-out/hil-belgian/report.html").is_file());
}

#[test]
fn a_run_is_titled_by_what_was_run() {
    let folder = campaign();
    let short = [
        "hil",
        "--road",
        "road.csv",
        "--speed-km-h",
        "30",
        "--duration-s",
        "3",
        "--out",
        "out",
    ];
    let output = run(folder.path(), &short);
    let said = text(&output.stdout);
    let title = "belgian with road road.csv, 30 km/h, 3 s";
    assert_eq!(said.lines().next(), Some(title), "{said} {}", text(&output.stderr));
    let mirrored = "road.csv is 10.0 m long.";
    assert!(
        said.lines().nth(1).is_some_and(|line| line.starts_with(mirrored)),
        "{said}"
    );
    let page = fs::read_to_string(folder.path().join("out/report.html")).expect("a page");
    assert!(page.contains(&format!("Hardware-in-the-loop: {title}")) && page.contains(mirrored));
    assert!(
        !page.contains("Belgian block at 60 km/h"),
        "the description of another run"
    );
    let drive = [
        "drive",
        "--manoeuvre",
        "straight",
        "--road",
        "road.csv",
        "--duration-s",
        "2",
        "--no-out",
    ];
    let said = text(&run(folder.path(), &drive).stdout);
    assert!(
        said.starts_with("Straight ahead: road road.csv (10.0 m, beyond them its mirror image)"),
        "{said}"
    );
}

#[test]
fn what_has_no_effect_is_refused_and_errors_name_what_was_given() {
    let folder = tempfile::tempdir().expect("a folder");
    for (arguments, says) in [
        (
            &["hil", "--damper-policy", "karnopp"][..],
            "--damper-policy has no use in the strategy road-and-cornering",
        ),
        (
            &["hil", "--steer-deg", "3"],
            "--steer-deg has no use, since the scenario belgian has no manoeuvre",
        ),
        (
            &["hil", "--manoeuvre", "lane-change", "--steer-deg", "3"],
            "--steer-deg does not belong",
        ),
        (&["hil", "--duration-s", "3000"], "change the duration or the speed"),
        (
            &["drive", "--manoeuvre", "belgian", "--duration-s", "3000"],
            "change the duration or the speed",
        ),
        (
            &[
                "drive",
                "--manoeuvre",
                "belgian",
                "--model",
                "ride",
                "--setting",
                "soft",
                "--handling",
                "x.toml",
            ],
            "--handling is not used by the ride model",
        ),
    ] {
        let line = refused(&run(folder.path(), arguments));
        assert!(line.contains(says), "{line}");
    }
}

/// A terminal that does not know its width says 0.
#[test]
fn a_terminal_of_width_zero_gets_whole_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let size = nix::pty::Winsize {
        ws_row: 0,
        ws_col: 0,
        ws_xpixel: 0,
        ws_ypixel: 0,
    };
    let terminal = nix::pty::openpty(Some(&size), None).expect("a terminal");
    let mut child = oleo(folder.path(), &[&SHORT[..], &["--no-out"]].concat())
        .stdout(Stdio::from(terminal.slave))
        .spawn()
        .expect("the binary runs");
    let reader = std::thread::spawn(move || {
        let (mut said, mut screen) = (Vec::new(), fs::File::from(terminal.master));
        // The end of a terminal is an error.
        let _ = screen.read_to_end(&mut said);
        text(&said)
    });
    child.wait().expect("it ends");
    let said = reader.join().expect("read");
    assert!(
        said.lines()
            .any(|line| line.contains("vertical weighted RMS, driver (BS 6841)")),
        "{said}"
    );
}

#[test]
fn a_full_disk_is_no_success_and_a_reader_that_left_is_no_failure() {
    let folder = tempfile::tempdir().expect("a folder");
    let full = || Stdio::from(fs::OpenOptions::new().write(true).open("/dev/full").expect("/dev/full"));
    for arguments in [
        &["hil", "--list"][..],
        &["--help"],
        &[&SHORT[..], &["--no-out"]].concat(),
    ] {
        let output = oleo(folder.path(), arguments)
            .stdout(full())
            .output()
            .expect("the binary runs");
        assert!(
            refused(&output).contains("standard output: cannot be written"),
            "{arguments:?}"
        );
        let mut child = oleo(folder.path(), arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary runs");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("it ends");
        assert!(
            output.status.code().is_some_and(|code| code < 2) && output.stderr.is_empty(),
            "{arguments:?}"
        );
    }
}

/// Sends a signal once a file has grown, and returns the exit status and the last line on standard error.
fn stopped(folder: &Path, arguments: &[&str], signal: &str, file: &str) -> (Option<i32>, String) {
    let length = || std::fs::metadata(folder.join(file)).map_or(0, |found| found.len());
    let before = length();
    let mut child = oleo(folder, arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    while length() <= before {
        assert!(child.try_wait().expect("a child").is_none(), "it ended too early");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(sent.expect("kill").success());
    let output = child.wait_with_output().expect("it ends");
    (
        output.status.code(),
        text(&output.stderr).lines().last().unwrap_or_default().to_owned(),
    )
}

#[test]
fn a_stopped_study_says_so_and_resumes() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = ["study", "control", "--seeds", "40", "--threads", "1", "--out", "out"];
    for (signal, status) in [("-INT", 130), ("-TERM", 143)] {
        let (code, line) = stopped(folder.path(), &study, signal, "out/drives.csv");
        assert_eq!(code, Some(status), "{line}");
        assert!(line.starts_with("stopped: ") && line.contains("same command"), "{line}");
        assert_eq!(names(&folder.path().join("out")), [".oleo", "drives.csv"]);
    }
}

#[test]
fn what_is_built_in_is_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = |arguments: &[&str]| {
        let output = run(folder.path(), &[&["show"], arguments].concat());
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stdout)
    };
    let schemas = said(&["schema"]);
    for name in ["hil", "drive", "rig-limits", "study-control", "diagnose", "self-test"] {
        assert!(schemas.contains(name), "{schemas}");
        let schema: serde_json::Value = serde_json::from_str(&said(&["schema", name])).expect("JSON");
        assert_eq!(schema["properties"]["schema"]["const"], 1, "{name}");
    }
    assert!(said(&["completions", "bash"]).contains("--speed-km-h"));
    assert!(said(&["man"]).contains("oleo"));
    assert!(said(&["man", "hil"]).contains("speed\\-km\\-h"));
    for (arguments, says) in [
        (&["show", "schema", "hill"][..], "did you mean hil?"),
        (&["show", "man", "drvie"], "did you mean drive?"),
        (&["hil", "--scenario", "bus-silense"], "did you mean bus-silence?"),
        (&["hil", "--road", "belgium"], "did you mean belgian?"),
        (
            &["diagnose", "--self-test", "--terms", "seal_fraction"],
            "did you mean seal_friction?",
        ),
    ] {
        assert!(refused(&run(folder.path(), arguments)).contains(says), "{arguments:?}");
    }
}

#[test]
fn a_recording_with_other_separators_is_told_so() {
    let folder = campaign();
    let mine = folder.path().join("mine");
    let recording = fs::read_to_string(mine.join("a.csv")).expect("a recording");
    for (separator, name) in [(";", "semicolons"), ("\t", "tabs")] {
        fs::write(mine.join("a.csv"), recording.replace(',', separator)).expect("written");
        for arguments in [
            &["diagnose", "mine", "--no-out"][..],
            &["predict", "--model", "mine/model.toml", "mine/a.csv"],
        ] {
            let line = refused(&run(folder.path(), arguments));
            assert!(line.contains(&format!("separated by {name}")), "{line}");
        }
    }
}
