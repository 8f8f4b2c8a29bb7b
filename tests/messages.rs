//! `--mcap` and `--live` at the command line. What is in the messages is read by other programs in `tests/messages.py`.

mod support;

use support::{complaint, run};

/// A binary with the feature writes the file whole or not at all, and never over an input.
#[cfg(feature = "mcap")]
#[test]
fn a_file_of_messages_is_whole_or_absent() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let (log, messages) = (file("run/candump.log"), file("run.mcap"));
    let out = file("run");
    let ran = run(&["hil", "--duration-s", "1", "--out", &out, "--mcap", &messages]);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let bytes = std::fs::read(&messages).expect("a file");
    assert!(bytes.starts_with(b"\x89MCAP0\r\n") && bytes.ends_with(b"\x89MCAP0\r\n"));
    let copy = file("log.mcap");
    assert!(run(&["convert", &log, &copy]).status.success());
    // The input by another name.
    let same = file("same.mcap");
    std::os::unix::fs::symlink(&log, &same).expect("a link");
    assert!(complaint(&run(&["convert", &log, &same])).contains("is an input"));
    let below_a_file = file("run.mcap/run.mcap");
    let refused = complaint(&run(&["hil", "--duration-s", "1", "--no-out", "--mcap", &below_a_file]));
    assert!(refused.contains("run.mcap: "), "{refused}");
    let words = file("words.log");
    std::fs::write(&words, "words\n").expect("written");
    let absent = file("absent.mcap");
    complaint(&run(&["convert", &words, &absent]));
    assert!(!std::path::Path::new(&absent).exists());
}

/// A port that is taken is one line; the controller's node has nothing to show.
#[cfg(feature = "mcap")]
#[test]
fn what_cannot_be_served_is_refused_in_one_line() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = taken.local_addr().expect("an address").port().to_string();
    let refused = complaint(&run(&["hil", "--no-out", "--duration-s", "1", "--live", &port]));
    assert!(refused.contains(&port) && refused.contains("--live PORT"), "{refused}");
    for option in [&["--live"][..], &["--mcap", "a.mcap"]] {
        let node = ["hil", "--no-out", "--node", "controller", "--bus", "socketcan:vcan0"];
        let refused = complaint(&run(&[&node, option].concat()));
        assert!(refused.contains("the controller's node has no vehicle"), "{refused}");
    }
}

/// A binary without it says how to come by one.
#[cfg(not(feature = "mcap"))]
#[test]
fn messages_are_refused_with_the_command_that_builds_their_writer() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let (log, messages) = (file("a.log"), file("a.mcap"));
    std::fs::write(&log, "(0000000001.000000) can0 123#00\n").expect("written");
    for arguments in [
        &["hil", "--no-out", "--duration-s", "1", "--mcap", &messages][..],
        &["hil", "--no-out", "--duration-s", "1", "--live"],
        &["drive", "--manoeuvre", "bump", "--no-out", "--mcap", &messages],
        &["convert", &log, &messages],
    ] {
        let complaint = complaint(&run(arguments));
        assert!(
            complaint.contains("cargo install --path . --features mcap"),
            "{complaint}"
        );
    }
    assert!(!std::path::Path::new(&messages).exists());
}
