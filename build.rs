//! Tells the program its version with the commit that it is built from.

use std::path::Path;
use std::process::Command;

/// What the program is made of.
const SOURCES: [&str; 10] = [
    "build.rs",
    "Cargo.lock",
    "src",
    "interface/src",
    "controller/src",
    "xcp/src",
    "plant-sim/src",
    "hil/src",
    "diagnose/src",
    "report/src",
];

/// What git says; `None` without git or outside a repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !text.is_empty()).then_some(text)
}

fn main() {
    let version = std::env::var("CARGO_PKG_VERSION").unwrap_or_default();
    // A copy without its history may lie inside another repository, whose commits say nothing of it.
    let folder = std::env::current_dir().and_then(|folder| folder.canonicalize()).ok();
    let top = git(&["rev-parse", "--show-toplevel"]).and_then(|top| Path::new(&top).canonicalize().ok());
    let commit = git(&["rev-parse", "--short=12", "HEAD"]).filter(|_| top.is_some() && top == folder);
    let built_from = match commit {
        // What is not committed makes another program of the same commit.
        Some(commit) => match git(&["status", "--porcelain", "--untracked-files=no"]) {
            None => format!("commit {commit}"),
            Some(_) => format!("commit {commit} with changes"),
        },
        None => "built without git".to_owned(),
    };
    println!("cargo::rustc-env=OLEO_VERSION={version} ({built_from})");
    for source in SOURCES {
        println!("cargo::rerun-if-changed={source}");
    }
    // Changes with every commit.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]).filter(|path| Path::new(path).exists()) {
        println!("cargo::rerun-if-changed={log}");
    }
}
