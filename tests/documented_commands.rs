//! The commands of README and docs are commands of this program: each is parsed, and those of the first steps are run.

mod support;

use std::path::Path;
use std::process::Command;

use support::run;

/// Pages with commands.
const PAGES: [&str; 11] = [
    "README.md",
    "docs/start.md",
    "docs/hil.md",
    "docs/bench.md",
    "docs/xcp.md",
    "docs/diagnose.md",
    "docs/fmu.md",
    "docs/handling.md",
    "docs/scale.md",
    "docs/performance.md",
    "docs/viewers.md",
];

/// Commands of a page: lines of code that begin with `oleo` or run it with cargo, as words. What follows two spaces or a `#` explains.
fn commands(page: &str) -> Vec<Vec<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
    let text = std::fs::read_to_string(path).expect("a page");
    let begins = [
        "oleo ",
        "target/release/oleo ",
        "cargo run --release -- ",
        "cargo run --release --features logs -- ",
    ];
    let mut found = Vec::new();
    for line in text.lines().map(str::trim) {
        let Some(rest) = begins.iter().find_map(|begin| line.strip_prefix(begin)) else {
            continue;
        };
        let command = rest
            .split("  ")
            .next()
            .unwrap_or("")
            .split(" # ")
            .next()
            .unwrap_or("")
            .trim_end_matches(',');
        let words: Vec<String> = command.split_whitespace().map(str::to_owned).collect();
        // A sentence that begins with the program's name is no command.
        if words
            .first()
            .is_some_and(|word| word.chars().all(|c| c.is_ascii_lowercase() || c == '-'))
        {
            found.push(words);
        }
    }
    found
}

/// The words of a pattern as words of a command: `[--road FILE]` and `A|B` are read as what they stand for.
fn is_pattern(words: &[String]) -> bool {
    words
        .iter()
        .any(|word| word.contains(['[', '|', '<', '…']) || word.contains("..."))
}

#[test]
fn every_command_of_the_documentation_is_understood() {
    let mut count = 0;
    for page in PAGES {
        for words in commands(page).iter().filter(|words| !is_pattern(words)) {
            // Help is given when everything before it has been read: an unknown option or value is refused first.
            let mut arguments: Vec<&str> = words.iter().map(|word| word.trim_matches(['"', '`', '\''])).collect();
            // Behind `--` stands a command of its own.
            let end = arguments
                .iter()
                .position(|word| *word == "--")
                .unwrap_or(arguments.len());
            arguments.insert(end, "--help");
            let output = run(&arguments);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success(), "{page}: oleo {}: {said}", words.join(" "));
            count += 1;
        }
    }
    assert!(count > 25, "only {count} commands were found");
}

#[test]
fn the_first_steps_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut count = 0;
    for words in commands("docs/start.md") {
        // These need recordings, and `tests/handing_on.rs` runs them on some.
        if is_pattern(&words)
            || ["diagnose", "predict"].contains(&words[0].as_str())
            || words.iter().any(|word| word.contains("FILE"))
        {
            continue;
        }
        let arguments = words.iter().filter(|word| *word != "--open");
        let output = Command::new(env!("CARGO_BIN_EXE_oleo"))
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .expect("the program starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "oleo {}: {said}", words.join(" "));
        count += 1;
    }
    assert!(count >= 4, "only {count} commands were run");
}
