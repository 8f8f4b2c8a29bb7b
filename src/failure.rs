//! A failure of a command: one line for the user, and exit status 2, or 128 and the number of the signal that stopped it.
//!
//! Libraries have typed errors; here, at the edge, only their text matters. `?` turns any of them into a [`Failure`];
//! `Failure::new` is for what the command line itself finds wrong.

use std::error::Error;
use std::fmt;
use std::io::Write as _;
use std::process::ExitCode;

use clap::error::ErrorKind;
use oleo_report::interrupt;

/// What went wrong, where, and what to do about it, as one line.
#[derive(Debug)]
pub struct Failure(String);

impl Failure {
    /// A failure from its text: `what: where: what to do`.
    #[allow(dead_code, reason = "not every set of commands has a complaint of its own")]
    pub fn new(text: impl Into<String>) -> Self {
        Failure(text.into())
    }

    /// Prints the line and gives the exit status that goes with it. A command that a signal stopped did not fail. A closed
    /// standard error is no further problem.
    pub fn report(self) -> ExitCode {
        let (what, status) = match interrupt::status() {
            Some(status) => ("stopped", status),
            None => ("error", 2),
        };
        let _ = writeln!(std::io::stderr(), "{what}: {self}");
        ExitCode::from(status)
    }
}

/// One line whatever the text: some libraries (TOML, for one) draw pictures of the place in their messages.
impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut words = self.0.split_whitespace();
        if let Some(first) = words.next() {
            out.write_str(first)?;
        }
        words.try_for_each(|word| write!(out, " {word}"))
    }
}

/// As in `anyhow`, `Failure` is deliberately not an `Error` itself, so that every error converts.
impl<E: Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Failure(error.to_string())
    }
}

/// Answer to arguments that do not parse: help and version are answers too, the rest is one line.
pub fn usage(error: &clap::Error) -> Result<ExitCode, Failure> {
    match error.kind() {
        // What was printed may still be in a buffer, which a full disk refuses.
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            match error.print().and_then(|()| std::io::stdout().flush()) {
                Err(refused) if refused.kind() != std::io::ErrorKind::BrokenPipe => {
                    Err(Failure(format!("standard output: cannot be written: {refused}")))
                }
                _ => Ok(ExitCode::SUCCESS),
            }
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = error.print();
            Ok(ExitCode::from(2))
        }
        _ => Err(Failure(one_line(&error.to_string()))),
    }
}

/// Clap's message without its usage block; `tip:` lines are what to do, so they stay.
fn one_line(message: &str) -> String {
    let message = message.strip_prefix("error: ").unwrap_or(message);
    let until_usage = message.split("\nUsage:").next().unwrap_or(message);
    let until_more = until_usage
        .split("\nFor more information")
        .next()
        .unwrap_or(until_usage);
    let lines: Vec<&str> = until_more
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .collect();
    format!("{}; see --help", lines.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failure_is_one_line() {
        assert_eq!(
            Failure::new("a.toml:\n  3 |  x = \n  bad").to_string(),
            "a.toml: 3 | x = bad"
        );
    }

    #[test]
    fn usage_block_is_left_out_but_the_tip_stays() {
        let message = "error: unexpected argument '--rod' found\n\n  tip: a similar argument exists: '--road'\n\n\
                       Usage: oleo hil --road <ROAD>\n\nFor more information, try '--help'.\n";
        assert_eq!(
            one_line(message),
            "unexpected argument '--rod' found tip: a similar argument exists: '--road'; see --help"
        );
    }
}
