//! The `oleo` binary as its users meet it: arguments in, exit status, two streams and a folder out.
#![allow(dead_code, reason = "each test binary uses its part")]

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

/// The command, run where relative paths of the documentation hold.
pub fn oleo(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_oleo"));
    command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// Runs to the end.
pub fn run(arguments: &[&str]) -> Output {
    oleo(arguments).output().expect("the binary runs")
}

/// Starts and leaves running.
pub fn start(arguments: &[&str]) -> Child {
    oleo(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs")
}

/// `summary.json` of an output folder.
pub fn summary(folder: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(folder.join("summary.json")).expect("summary.json is there");
    serde_json::from_str(&text).expect("summary.json is JSON")
}

/// What `#` stands for in the table of columns.
const NUMBERS: [&str; 6] = ["1", "2", "3", "4", "5", "95"];

/// The columns that `docs/results-files.md` lists, with its abbreviations written out.
fn listed_columns() -> Vec<String> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/results-files.md");
    let text = std::fs::read_to_string(page).expect("the page");
    let columns = text.split("## Columns").nth(1).expect("the columns");
    let names = columns
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    let written_out = |names: Vec<String>, short: &str, long: &[&str]| -> Vec<String> {
        let all = |name: String| match name.contains(short) {
            true => long.iter().map(|long| name.replace(short, long)).collect(),
            false => vec![name],
        };
        names.into_iter().flat_map(all).collect()
    };
    let names = written_out(
        names.map(str::to_owned).collect(),
        "CORNER",
        &["front_left", "front_right", "rear_left", "rear_right"],
    );
    let names = written_out(names, "SEAT", &["driver", "rear_left"]);
    let names = written_out(names, "AXLE", &["front", "rear"]);
    written_out(names, "#", &NUMBERS)
}

/// Holds a folder of results against `docs/results-files.md` (columns) and against the schema of its summary.
pub fn is_as_documented(folder: &Path, schema: &str) {
    let listed = listed_columns();
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().into_owned();
        // Finished runs of a study, which have no header.
        if path.extension().is_none_or(|kind| kind != "csv") || name == "runs.csv" || name == "drives.csv" {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("CSV");
        // A table of the self-test without rows is an empty file.
        for column in text.lines().take(1).flat_map(|header| header.split(',')) {
            let known = listed.iter().any(|name| name == column);
            assert!(
                known,
                "{}: column '{column}' is not in docs/results-files.md",
                path.display()
            );
        }
    }
    let file = if schema == "diagnose" {
        "report.json"
    } else {
        "summary.json"
    };
    let text = std::fs::read_to_string(folder.join(file)).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let shown = run(&["show", "schema", schema]);
    let schema: serde_json::Value = serde_json::from_slice(&shown.stdout).expect("a schema");
    // `./test schemas` checks the values with a validator; the keys are checked here, too.
    let keys = |value: &serde_json::Value| -> Vec<String> {
        let object = value.as_object().expect("an object");
        object.keys().cloned().collect()
    };
    let known = keys(&schema["properties"]);
    for key in keys(&summary) {
        let free = schema["additionalProperties"].is_object();
        assert!(
            free || known.contains(&key),
            "{}: '{key}' is not in the schema",
            folder.display()
        );
    }
    for key in schema["required"].as_array().expect("required keys") {
        let key = key.as_str().expect("a key");
        assert!(summary.get(key).is_some(), "{}: no '{key}'", folder.display());
    }
}

/// Standard error, which must be one line that starts as every complaint does.
pub fn complaint(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.starts_with("error: "), "{text}");
    text
}

/// Nothing a user should never see.
pub fn no_panic(output: &Output) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code().is_some_and(|code| code <= 2),
        "{:?} {text}",
        output.status
    );
    assert!(!text.contains("panicked") && !text.contains("RUST_BACKTRACE"), "{text}");
}
