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
