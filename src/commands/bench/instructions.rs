//! Counts the instructions of a point with callgrind. They do not depend on what else the machine does.

use std::path::Path;
use std::process::Command;

use super::point::Point;
use super::process::{self, Part};
use crate::failure::Failure;

/// Points that take longer are not counted, s: callgrind is about fifty times slower.
pub const LONGEST_S: f64 = 0.5;

/// Refuses where callgrind cannot be had.
pub fn require() -> Result<(), Failure> {
    match Command::new("valgrind").arg("--version").output() {
        Ok(output) if output.status.success() => Ok(()),
        _ => Err(Failure::new(
            "--instructions: there is no valgrind; install it, or leave the option out",
        )),
    }
}

/// Instructions of the work of a point: those of a process that does it less those of one that only prepares it.
pub fn of(point: Point, scratch: &Path) -> Result<u64, Failure> {
    let whole = in_process(point, scratch, Part::Work)?;
    Ok(whole.saturating_sub(in_process(point, scratch, Part::Preparation)?))
}

fn in_process(point: Point, scratch: &Path, part: Part) -> Result<u64, Failure> {
    let plain = process::command(point, scratch)?;
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]);
    command.arg(plain.get_program()).args(plain.get_args());
    command.args(["--only", part.into()]);
    let output = (command.output()).map_err(|error| point.failed(&format!("valgrind cannot be started: {error}")))?;
    let said = String::from_utf8_lossy(&output.stderr);
    collected(&said)
        .filter(|_| output.status.success())
        .ok_or_else(|| point.failed("valgrind counted nothing; leave --instructions out"))
}

/// The count that callgrind prints at its end.
fn collected(said: &str) -> Option<u64> {
    let (_, after) = said.lines().find_map(|line| line.split_once("Collected :"))?;
    after.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::collected;

    #[test]
    fn the_count_is_found_in_what_callgrind_says() {
        let said =
            "==7== Callgrind, a call-graph generating cache profiler\n==7== Events    : Ir\n==7== Collected : 123456\n";
        assert_eq!(collected(said), Some(123_456));
        assert_eq!(collected("==7== Events    : Ir\n"), None);
    }
}
