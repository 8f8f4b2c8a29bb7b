//! Ctrl-C in the middle of a run: nothing is left of what was staged, and the exit status is the shells' 128 and the signal. A
//! command that holds a `Graceful` finishes first.
#![cfg(unix)]

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use oleo_report::{Origin, OutputDirectory, interrupt, interrupt::Graceful};

/// Set for the child process: the folder to write and how to behave.
const TARGET: &str = "OLEO_INTERRUPT_TARGET";
const MODE: &str = "OLEO_INTERRUPT_MODE";

/// Not a test of its own: what the child process runs.
#[test]
fn child() {
    let Ok(target) = std::env::var(TARGET) else { return };
    let graceful = (std::env::var(MODE).as_deref() == Ok("graceful")).then(Graceful::begin);
    let mut out = OutputDirectory::stage(&target, Origin::default(), false).expect("writable");
    out.write("half.txt", "half").expect("written");
    let patience = Instant::now();
    while patience.elapsed() < Duration::from_secs(60) {
        if graceful.as_ref().is_some_and(Graceful::requested) {
            out.commit().expect("moved");
            std::process::exit(interrupt::status().expect("a signal").into());
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn start(target: &Path, mode: &str) -> Child {
    let program = std::env::current_exe().expect("this test");
    let mut command = Command::new(program);
    command
        .args(["--exact", "child", "--nocapture"])
        .env(TARGET, target)
        .env(MODE, mode);
    command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts")
}

/// Interrupts the child once it has staged something, and returns its exit status.
fn interrupt(parent: &Path, mut child: Child, signal: &str) -> Option<i32> {
    let staged = || {
        let folders = std::fs::read_dir(parent).expect("a folder").flatten();
        folders
            .map(|folder| folder.path().join("half.txt"))
            .any(|file| file.exists())
    };
    while !staged() {
        assert!(
            child.try_wait().expect("a child").is_none(),
            "the child ended too early"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    let sent = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status()
        .expect("kill");
    assert!(sent.success());
    child.wait().expect("it ends").code()
}

#[test]
fn nothing_is_left() {
    let parent = tempfile::tempdir().expect("a folder");
    for (signal, status) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let child = start(&parent.path().join("out"), "plain");
        assert_eq!(interrupt(parent.path(), child, signal), Some(status));
        assert_eq!(std::fs::read_dir(parent.path()).expect("a folder").count(), 0);
    }
}

#[test]
fn a_graceful_command_finishes() {
    let parent = tempfile::tempdir().expect("a folder");
    let child = start(&parent.path().join("out"), "graceful");
    assert_eq!(interrupt(parent.path(), child, "-INT"), Some(130));
    assert!(parent.path().join("out").join("half.txt").exists());
}
