//! Studies in parts, as a user meets them: what is merged has the bits of the undivided study, what was interrupted goes on, and bad
//! input gets one line that says what is missing or does not belong there.

mod support;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_oleo"));
    // The tests may themselves run in an array.
    command
        .env_remove("SLURM_ARRAY_TASK_ID")
        .env_remove("JOB_COMPLETION_INDEX");
    command.args(arguments).current_dir(folder);
    command
}

fn oleo(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let run = oleo(folder, arguments);
    assert!(run.status.success(), "{arguments:?}: {}", text(&run.stderr));
    text(&run.stdout)
}

/// The one line of a command that is refused with status 2.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let run = oleo(folder, arguments);
    let said = text(&run.stderr);
    assert_eq!(run.status.code(), Some(2), "{arguments:?}: {said}");
    assert_eq!(said.lines().count(), 1, "{arguments:?}: {said}");
    assert!(run.stdout.is_empty(), "{arguments:?}: {}", text(&run.stdout));
    said
}

/// The results in a folder by name, without the ledger and the list of files.
fn results(folder: &Path, ledger: &str) -> BTreeMap<String, String> {
    let files = std::fs::read_dir(folder).expect("a folder").flatten();
    files
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name != ledger && name != ".oleo")
        .map(|name| {
            let content = std::fs::read_to_string(folder.join(&name)).expect("a file");
            (name, content)
        })
        .collect()
}

/// Runs a study whole and in so many parts, and holds the results against each other. `merged_as` is what the merged page says of its
/// command.
fn same_whole_and_in_parts(study: &[&str], parts: u32, ledger: &str, merged_as: &str) {
    let place = tempfile::tempdir().expect("a folder");
    let folder = place.path();
    let with = |more: &[&str]| succeeds(folder, &[study, more].concat());
    let said = with(&["--out", "whole"]);
    // In any order, on any number of threads.
    for k in (1..=parts).rev() {
        let (part, threads) = (format!("{k}/{parts}"), format!("{}", 1 + k % 2));
        with(&["--shard", &part, "--threads", &threads, "--out", "shards"]);
    }
    let merged = succeeds(folder, &["merge", "shards", "--out", "merged"]);
    assert_eq!(said.replace("whole/report.html", "merged/report.html"), merged);
    let command = format!("oleo {} --out whole", study.join(" "));
    let whole = results(&folder.join("whole"), ledger);
    let of_parts = results(&folder.join("merged"), ledger);
    assert_eq!(whole.keys().collect::<Vec<_>>(), of_parts.keys().collect::<Vec<_>>());
    for (name, content) in &whole {
        if name == "report.html" {
            assert!(
                content.contains(&command) && of_parts[name].contains(merged_as),
                "{merged_as}"
            );
            assert!(
                content.replace(&command, "") == of_parts[name].replace(merged_as, ""),
                "{name}"
            );
        } else {
            assert!(*content == of_parts[name], "{name} differs");
        }
    }
}

#[test]
fn robust_vehicles_in_parts_are_those_of_the_whole() {
    same_whole_and_in_parts(
        &["study", "robust", "--vehicles", "4", "--first", "7"],
        3,
        "drives.csv",
        "oleo study robust --vehicles=4 --first=7",
    );
}

#[test]
fn the_control_study_in_parts_is_the_whole_one() {
    same_whole_and_in_parts(
        &["study", "control", "--quick", "--seeds", "1", "--duration-s", "5"],
        2,
        "drives.csv",
        "oleo study control --seeds=1 --first-seed=1 --duration-s=5 --quick",
    );
}

#[test]
fn the_sweep_in_parts_is_the_whole_one() {
    same_whole_and_in_parts(
        &["study", "sweep", "--duration-s", "2"],
        3,
        "runs.csv",
        "oleo study sweep --speed-km-h=60 --driver=eased --load=as-sold --duration-s=2 --seed=1",
    );
}

#[test]
fn the_self_test_in_parts_is_the_whole_one() {
    same_whole_and_in_parts(
        &[
            "diagnose",
            "--self-test",
            "--terms",
            "none",
            "--campaigns",
            "2",
            "--seed",
            "7",
        ],
        2,
        "trials.jsonl",
        "oleo diagnose --self-test --campaigns=2 --seed=7 --terms=none",
    );
}

/// A campaign that cannot be diagnosed is an outcome too.
#[test]
fn a_fleet_in_parts_is_the_whole_one() {
    let place = tempfile::tempdir().expect("a folder");
    let save = [
        "diagnose",
        "--self-test",
        "--save",
        "--campaigns",
        "1",
        "--terms",
        "none",
        "--out",
        "fleet",
    ];
    succeeds(place.path(), &save);
    let fleet = place.path().join("fleet");
    std::fs::create_dir(fleet.join("broken")).expect("made");
    std::fs::write(fleet.join("broken/model.toml"), "nothing").expect("written");
    let path = fleet.to_str().expect("a path");
    same_whole_and_in_parts(
        &["study", "fleet", path],
        2,
        "diagnoses.jsonl",
        &format!("oleo study fleet {path}"),
    );
    let study = ["study", "fleet", path, "--out"];
    succeeds(place.path(), &[&study[..], &["out"]].concat());
    support::is_as_documented(&place.path().join("out"), "study-fleet");
    let summary = support::summary(&place.path().join("out"));
    assert_eq!(
        (&summary["members"], &summary["failed"][0]["member"]),
        (&2.into(), &"broken".into())
    );
    // A recording that was changed is diagnosed again, the others are not.
    let ledger = || std::fs::read_to_string(place.path().join("out/diagnoses.jsonl")).expect("a ledger");
    assert_eq!(ledger().lines().count(), 2);
    std::fs::write(fleet.join("broken/model.toml"), "something else").expect("written");
    succeeds(place.path(), &[&study[..], &["out"]].concat());
    assert_eq!(ledger().lines().count(), 3);
    assert!(refused(place.path(), &["study", "fleet", "out"]).contains("holds no campaign"));
}

/// A part that is killed without warning goes on where it was, and its shard is the one that it would have been.
#[cfg(unix)]
#[test]
fn a_killed_part_goes_on() {
    let place = tempfile::tempdir().expect("a folder");
    let folder = place.path();
    let part = [
        "study",
        "robust",
        "--vehicles",
        "8",
        "--shard",
        "1/2",
        "--threads",
        "1",
        "--out",
    ];
    let into = |out: &'static str| [&part[..], &[out]].concat();
    let mut running = command(folder, &into("a"))
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("started");
    let ledger = || {
        let names = std::fs::read_dir(folder.join("a")).into_iter().flatten().flatten();
        names
            .map(|entry| entry.path())
            .find(|path| path.extension().is_some_and(|end| end == "begun"))
    };
    let lines = || {
        ledger().map_or(0, |path| {
            std::fs::read_to_string(path).map_or(0, |text| text.lines().count())
        })
    };
    while lines() < 2 {
        assert!(
            running.try_wait().expect("a process").is_none(),
            "ended before it could be killed"
        );
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    // Whoever wants the same part meanwhile is refused.
    let said = refused(folder, &into("a"));
    assert!(said.contains("shard 1/2 in a: another process is running it"), "{said}");
    // On Unix this is SIGKILL.
    running.kill().expect("killed");
    running.wait().expect("ended");
    let kept = lines();
    assert!((2..24).contains(&kept), "{kept} runs were kept");
    assert!(refused(folder, &["merge", "a", "--out", "m"]).contains("holds no finished shard"));
    // What the disk lost of the last line is run again.
    let path = ledger().expect("a ledger");
    let text = std::fs::read_to_string(&path).expect("a ledger");
    std::fs::write(&path, &text[..text.len() - 3]).expect("written");
    succeeds(folder, &into("a"));
    succeeds(folder, &into("b"));
    let shard = |out: &str| std::fs::read(folder.join(out).join("shard-1-of-2.records")).expect("a shard");
    assert!(shard("a") == shard("b"));
    assert_eq!(ledger(), None);
    // Once more: nothing is run.
    assert!(succeeds(folder, &into("a")).starts_with("shard 1/2 is finished already\n"));
}

#[test]
fn what_does_not_belong_together_is_refused_in_one_line() {
    let place = tempfile::tempdir().expect("a folder");
    let folder = place.path();
    let vehicle = succeeds(folder, &["show", "vehicle"]);
    std::fs::write(folder.join("vehicle.toml"), &vehicle).expect("written");
    let robust = ["study", "robust", "--vehicles", "3", "--vehicle", "vehicle.toml"];
    let with = |more: &[&'static str]| [&robust[..], more].concat();
    for part in ["1/3", "2/3", "3/3"] {
        succeeds(folder, &[&robust[..], &["--shard", part, "--out", "s"]].concat());
    }
    succeeds(folder, &with(&["--first", "5", "--shard", "2/3", "--out", "other"]));
    succeeds(folder, &with(&["--shard", "2/2", "--out", "halves"]));
    let shard = |k: u32| folder.join(format!("s/shard-{k}-of-3.records"));

    for (arguments, complaint) in [
        (
            with(&["--shard", "4/3", "--out", "x"]),
            "there is no such part; give 1/3 to 3/3",
        ),
        (with(&["--shard", "0/3", "--out", "x"]), "there is no such part"),
        (with(&["--shard", "1/0", "--out", "x"]), "N from 1 to"),
        (
            with(&["--shard", "1/4", "--out", "x"]),
            "the study has 3 cases; give at most as many shards",
        ),
        (with(&["--shard", "/3", "--out", "x"]), "write --shard K/3"),
        (with(&["--shard", "1/3", "--no-out"]), "cannot be used with"),
        (
            with(&["--shard", "1/3", "--format", "json", "--out", "x"]),
            "a shard has no summary",
        ),
        (
            with(&["--shard", "1/3", "--out", "."]),
            "has files that are no shards, such as ",
        ),
        (
            with(&["--first", "9", "--shard", "1/3", "--out", "s"]),
            "s/shard-1-of-3.records: is of a study with --first=0, and not with --first=9",
        ),
        (vec!["merge", "absent"], "absent: cannot be read as a folder"),
        (
            vec!["merge", "s", "other"],
            "other/shard-2-of-3.records: is of a study with --first=5, and not with --first=0",
        ),
        (vec!["merge", "s", "halves"], "is one of 2, and others are of 3"),
        (vec!["merge", "s", "s"], "is shard 1/3, and so is"),
        (vec!["merge", "s", "--out", "s"], "s: has files that oleo did not write"),
        (vec!["diagnose", "s", "--shard", "1/2"], "one campaign is one case"),
        (
            vec![
                "submit",
                "--shards",
                "4",
                "--dry-run",
                "--",
                "study",
                "robust",
                "--vehicles",
                "3",
            ],
            "the study has 3 cases",
        ),
        (
            vec!["submit", "--shards", "2", "--dry-run", "--", "study", "optimise"],
            "it has no shards",
        ),
        (
            vec!["submit", "--shards", "2", "--dry-run", "--", "drive"],
            "oleo drive: unrecognized subcommand",
        ),
        (
            vec![
                "submit",
                "--shards",
                "2",
                "--dry-run",
                "--",
                "study",
                "sweep",
                "--shard",
                "1/2",
            ],
            "leave the option out",
        ),
        (
            vec!["submit", "--shards", "2", "--sbatch", "x", "--", "study", "sweep"],
            "--sbatch x: is no option of sbatch",
        ),
        (
            vec![
                "submit",
                "--shards",
                "3",
                "--folder",
                "other",
                "--dry-run",
                "--",
                "study",
                "robust",
                "--vehicles",
                "3",
            ],
            "other/shard-2-of-3.records: is of a study with",
        ),
    ] {
        let said = refused(folder, &arguments);
        assert!(said.contains(complaint), "{arguments:?}: {said}");
    }
    assert!(!folder.join("x").exists());

    // Missing, damaged, of another version, with another input.
    let whole = std::fs::read_to_string(shard(2)).expect("a shard");
    std::fs::remove_file(shard(2)).expect("removed");
    let said = refused(folder, &["merge", "s"]);
    assert!(
        said.contains("1 of 3 shards is missing: 2; run it with oleo study robust --vehicle=vehicle.toml"),
        "{said}"
    );
    assert!(said.contains("--vehicles=3 --first=0 --shard K/3 --out s"), "{said}");
    // Only what is missing is submitted.
    let submit = ["submit", "--shards", "3", "--dry-run", "--folder", "s", "--"];
    let script = succeeds(folder, &[&submit[..], &robust[..]].concat());
    assert!(
        script.contains("#SBATCH --array=2\n") && script.contains(" --shard=/3 "),
        "{script}"
    );
    for (damaged, complaint) in [
        (whole.replacen("completed", "complete", 1), "its digest differs"),
        (whole[..whole.len() / 2].to_owned(), "its digest differs"),
        (String::new(), "is no shard, or a damaged one"),
        (
            whole.replacen("\"version\":\"", "\"version\":\"0.0.9 ", 1),
            "was written by oleo 0.0.9 ",
        ),
    ] {
        std::fs::write(shard(2), damaged).expect("written");
        let said = refused(folder, &["merge", "s"]);
        assert!(
            said.contains(complaint) && said.contains("shard-2-of-3.records"),
            "{said}"
        );
    }
    std::fs::write(shard(2), whole).expect("written");
    std::fs::write(folder.join("vehicle.toml"), format!("{vehicle}\n# changed\n")).expect("written");
    let said = refused(folder, &["merge", "s"]);
    assert!(said.contains("vehicle.toml: is not as the shards read it"), "{said}");
    std::fs::remove_file(folder.join("vehicle.toml")).expect("removed");
    let said = refused(folder, &["merge", "s"]);
    assert!(
        said.contains("vehicle.toml: was read by the shards and is not here"),
        "{said}"
    );
    std::fs::write(folder.join("vehicle.toml"), vehicle).expect("written");
    succeeds(folder, &["merge", "s", "--out", "m"]);
    support::is_as_documented(&folder.join("m"), "study-robust");
}

/// The containers of the example for Kubernetes, with fewer vehicles.
#[test]
fn the_manifest_for_kubernetes_runs_these_commands() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/kubernetes.yaml");
    let manifest = std::fs::read_to_string(manifest).expect("the manifest");
    let commands = manifest
        .lines()
        .filter_map(|line| line.trim().strip_prefix("command: [oleo, ")?.strip_suffix(']'));
    let commands: Vec<Vec<&str>> = commands
        .map(|words| {
            words
                .split(", ")
                .map(|word| {
                    if word == "\"1000\"" {
                        "12"
                    } else {
                        word.trim_matches('"')
                    }
                })
                .collect()
        })
        .collect();
    let [shard, merge] = &commands[..] else {
        panic!("{commands:?}")
    };
    let completions = manifest
        .lines()
        .find_map(|line| line.trim().strip_prefix("completions: "));
    let completions: u32 = completions.and_then(|number| number.parse().ok()).expect("a number");
    let place = tempfile::tempdir().expect("a folder");
    for index in 0..completions {
        let mut command = command(place.path(), shard);
        let run = command
            .env("JOB_COMPLETION_INDEX", index.to_string())
            .output()
            .expect("started");
        assert!(run.status.success(), "{}", text(&run.stderr));
    }
    succeeds(place.path(), merge);
    assert_eq!(support::summary(&place.path().join("robust"))["vehicles"], 12);
}

/// The number of the part is that of the task, and results of a failed check have the status of the study.
#[test]
fn an_array_of_jobs_numbers_the_parts() {
    let place = tempfile::tempdir().expect("a folder");
    let folder = place.path();
    let task = |variable: &str, number: &str| {
        let mut command = command(
            folder,
            &["study", "robust", "--vehicles", "2", "--shard", "/2", "--out", "s"],
        );
        let run = command.env(variable, number).output().expect("the program starts");
        (run.status.code(), text(&run.stdout), text(&run.stderr))
    };
    let (status, said, _) = task("SLURM_ARRAY_TASK_ID", "2");
    assert!(status == Some(0) && said.starts_with("shard 2/2 is finished"), "{said}");
    let (status, said, _) = task("JOB_COMPLETION_INDEX", "0");
    assert!(status == Some(0) && said.starts_with("shard 1/2 is finished"), "{said}");
    let (status, _, said) = task("JOB_COMPLETION_INDEX", "2");
    assert!(status == Some(2) && said.contains("has the tasks 0 to 1"), "{said}");
    succeeds(folder, &["merge", "s", "--out", "m"]);
}
