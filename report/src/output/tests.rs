//! What is written, refused, replaced and left alone.

use super::*;

fn stage(path: &Path, inputs: &[PathBuf], force: bool) -> Result<OutputDirectory, OutputError> {
    let origin = Origin {
        command: "oleo test".into(),
        version: "1".into(),
        inputs: inputs.to_vec(),
    };
    OutputDirectory::stage(path, origin, force)
}

fn new(path: &Path) -> OutputDirectory {
    stage(path, &[], false).expect("writable")
}

/// Writes these files, each with its own name in it.
fn results(path: &Path, names: &[&str]) {
    let mut out = new(path);
    names.iter().for_each(|name| out.write(name, name).expect("written"));
    out.commit().expect("moved");
}

fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn nothing_is_seen_before_commit_and_all_of_it_after() {
    let parent = tempfile::tempdir().expect("a folder");
    let destination = parent.path().join("out");
    let mut out = new(&destination);
    out.csv("a.csv", &[("time_s", &[0.0, 0.1]), ("force_N", &[1.0, -2.5e-7])])
        .expect("written");
    out.write("runs/01.txt", "x").expect("written");
    assert!(!destination.exists());
    out.commit().expect("moved");
    assert_eq!(entries(&destination), [".oleo", "a.csv", "runs"]);
    assert_eq!(entries(parent.path()), ["out"]);
    let text = fs::read_to_string(destination.join("a.csv")).expect("a file");
    assert_eq!(text, "time_s,force_N\n0,1\n0.1,-2.5e-7\n");
}

#[test]
fn an_input_is_not_replaced_by_whatever_name_it_is_reached() {
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("campaign");
    fs::create_dir(&folder).expect("made");
    fs::write(folder.join("model.toml"), "mine").expect("written");
    let inputs = [folder.join("model.toml"), folder.join("absent.csv")];
    let mut out = stage(&folder.join("..").join("campaign"), &inputs, true).expect("writable");
    assert!(matches!(out.refuse("model.toml"), Err(OutputError::Input { .. })));
    let error = out.write("model.toml", "theirs").expect_err("an input").to_string();
    assert!(
        error.contains("is an input of this command") && error.lines().count() == 1,
        "{error}"
    );
    out.write("report.json", "{}").expect("no input");
    out.commit().expect("moved");
    assert_eq!(entries(&folder), [".oleo", "model.toml", "report.json"]);
    assert_eq!(fs::read_to_string(folder.join("model.toml")).expect("a file"), "mine");
}

#[test]
fn folders_above_the_destination_are_made_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut out = new(&folder.path().join("runs/monday/1"));
    out.write("a.txt", "1").expect("written");
    assert!(!folder.path().join("runs").exists());
    out.commit().expect("moved");
    assert_eq!(entries(&folder.path().join("runs/monday/1")), [".oleo", "a.txt"]);
    assert_eq!(entries(folder.path()), ["runs"]);
    drop(new(&folder.path().join("other/1")));
    assert_eq!(entries(folder.path()), ["runs"]);
}

#[test]
fn a_folder_with_other_files_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("notes.txt"), "mine").expect("written");
    let error = stage(folder.path(), &[], false).expect_err("refused").to_string();
    assert!(
        error.contains("such as notes.txt") && error.contains("--force"),
        "{error}"
    );
    assert_eq!(entries(folder.path()), ["notes.txt"]);
    assert!(matches!(
        stage(Path::new("/"), &[], true),
        Err(OutputError::Root { .. })
    ));
}

#[test]
fn nothing_of_an_earlier_run_stays_and_nothing_of_the_user_goes() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    results(&out, &["report.html", "old.csv", "runs/1.csv"]);
    fs::write(out.join("notes.txt"), "mine").expect("written");
    results(&out, &["report.html", "new.csv"]);
    assert_eq!(entries(&out), [".oleo", "new.csv", "notes.txt", "report.html"]);
    let error = new(&out).write("notes.txt", "theirs").expect_err("not ours");
    assert!(matches!(error, OutputError::NotOurs { .. }), "{error}");
}

#[test]
fn results_of_another_command_are_replaced_with_force_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    results(&out, &["old.csv"]);
    let other = |force| {
        let origin = Origin {
            command: "oleo other".into(),
            ..Origin::default()
        };
        OutputDirectory::stage(&out, origin, force)
    };
    let error = other(false).expect_err("refused").to_string();
    assert!(error.contains("has results of oleo test"), "{error}");
    let mut forced = other(true).expect("writable");
    forced.write("new.csv", "new").expect("written");
    forced.commit().expect("moved");
    assert_eq!(entries(&out), [".oleo", "new.csv"]);
}

#[test]
fn an_edited_result_and_one_that_is_an_input_now_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    results(&out, &["model.toml"]);
    let model = [out.join("model.toml")];
    for force in [false, true] {
        assert!(matches!(stage(&out, &model, force), Err(OutputError::Input { .. })));
    }
    fs::write(out.join("model.toml"), "edited").expect("written");
    let error = stage(&out, &[], false).expect_err("edited");
    assert!(matches!(error, OutputError::Changed { .. }), "{error}");
    let mut forced = stage(&out, &[], true).expect("writable");
    forced.write("model.toml", "new").expect("written");
    forced.commit().expect("moved");
    assert_eq!(fs::read_to_string(out.join("model.toml")).expect("a file"), "new");
}

#[test]
fn a_ledger_is_kept_by_every_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let open = |name: &str| {
        let origin = Origin {
            command: "oleo test".into(),
            ..Origin::default()
        };
        OutputDirectory::stage_with_ledger(&out, origin, false, name).expect("ours")
    };
    // Interrupted: the folder has the ledger only, and the command goes on in it.
    let (_, ledger) = open("runs.csv");
    fs::write(ledger, "1").expect("written");
    assert_eq!(entries(&out), [".oleo", "runs.csv"]);
    let (mut again, _) = open("runs.csv");
    again.write("report.html", "x").expect("written");
    again.commit().expect("moved");
    let (_, other) = open("drives.csv");
    fs::write(other, "2").expect("written");
    results(&out, &["summary.json"]);
    assert_eq!(entries(&out), [".oleo", "drives.csv", "runs.csv", "summary.json"]);
    drop(open("runs.csv"));
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_is_refused_before_the_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let link = folder.path().join("out");
    std::os::unix::fs::symlink("nowhere", &link).expect("linked");
    assert!(matches!(stage(&link, &[], false), Err(OutputError::NotAFolder { .. })));
}

#[test]
fn a_summary_says_where_it_comes_from() {
    let folder = tempfile::tempdir().expect("a folder");
    let input = folder.path().join("abc");
    fs::write(&input, "abc").expect("written");
    let mut out = stage(&folder.path().join("out"), &[input], false).expect("writable");
    let content = BTreeMap::from([("force_n", 2.0)]);
    out.summary("summary.json", Some(7), &content).expect("written");
    let text = fs::read_to_string(out.commit().expect("moved").join("summary.json")).expect("a file");
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let expected = serde_json::json!({
        "schema": 1, "command": "oleo test", "version": "1", "seed": 7, "force_n": 2.0,
        "inputs": [{ "name": "abc", "sha256": "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad" }],
    });
    assert_eq!(value, expected);
}

#[test]
fn dropped_without_commit_nothing_remains() {
    let parent = tempfile::tempdir().expect("a folder");
    for destination in [parent.path().join("new"), parent.path().to_path_buf()] {
        let mut out = new(&destination);
        out.write("a.txt", "x").expect("written");
        drop(out);
        assert!(entries(parent.path()).is_empty());
    }
    assert!(
        !interrupt::staged()
            .iter()
            .any(|folder| folder.starts_with(parent.path()))
    );
}

#[test]
fn an_existing_folder_keeps_its_other_files() {
    let destination = tempfile::tempdir().expect("a folder");
    fs::write(destination.path().join("notes.txt"), "mine").expect("written");
    fs::write(destination.path().join("a.txt"), "old").expect("written");
    let mut out = stage(destination.path(), &[], true).expect("writable");
    out.write("a.txt", "new").expect("written");
    out.write("runs/b.txt", "new").expect("written");
    assert_eq!(
        fs::read_to_string(destination.path().join("a.txt")).expect("a file"),
        "old"
    );
    out.commit().expect("moved");
    assert_eq!(entries(destination.path()), [".oleo", "a.txt", "notes.txt", "runs"]);
    assert_eq!(
        fs::read_to_string(destination.path().join("a.txt")).expect("a file"),
        "new"
    );
}

#[test]
fn refusals_are_one_line_that_names_the_place() {
    let parent = tempfile::tempdir().expect("a folder");
    let file = parent.path().join("file");
    fs::write(&file, "").expect("written");
    let inside = |path: &Path| stage(path, &[], false).expect_err("refused").to_string();
    for (path, part) in [(file.clone(), "not a folder"), (file.join("new/out"), "not a folder")] {
        let message = inside(&path);
        assert!(
            message.contains(part) && message.starts_with(&file.display().to_string()),
            "{message}"
        );
        assert!(!message.contains('\n'));
    }
    let mut out = new(&parent.path().join("out"));
    for name in ["../x", "/x", ""] {
        assert!(matches!(out.write(name, "x"), Err(OutputError::Name { .. })), "{name}");
    }
    assert!(out.csv("a.csv", &[("a", &[1.0]), ("b", &[])]).is_err());
}

#[test]
fn records_and_json() {
    #[derive(Serialize)]
    struct Row {
        corner: u8,
        force_n: f64,
    }
    let parent = tempfile::tempdir().expect("a folder");
    let mut out = new(&parent.path().join("out"));
    out.csv_records(
        "rows.csv",
        [Row {
            corner: 0,
            force_n: 0.1 + 0.2,
        }],
    )
    .expect("written");
    out.json(
        "summary.json",
        &Row {
            corner: 1,
            force_n: 2.0,
        },
    )
    .expect("written");
    let destination = out.commit().expect("moved");
    let text = fs::read_to_string(destination.join("rows.csv")).expect("a file");
    assert_eq!(text, "corner,force_n\n0,0.30000000000000004\n");
    assert!(
        fs::read_to_string(destination.join("summary.json"))
            .expect("a file")
            .ends_with("}\n")
    );
}
