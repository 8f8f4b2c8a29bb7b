//! The arguments of a command in one form, so that two command lines that ask for the same are the same text: every option with its
//! value in the order of the help, defaults included, and without the options that results do not depend on.

use std::ffi::OsString;

use clap::{ArgAction, ArgMatches, Command};

use crate::failure::Failure;

/// Options that decide where and how fast a command works, and not what comes out.
const NOT_OF_THE_RESULT: [&str; 7] = ["out", "no_out", "force", "open", "format", "shard", "threads"];

/// The arguments of this process, whose command `name` has the options `A`.
pub fn of_this_process<A: clap::Args>(name: &'static str) -> Result<Vec<String>, Failure> {
    let command = Command::new("oleo").subcommand(A::augment_args(Command::new(name)));
    of(command, std::env::args_os())
}

/// The arguments of a command line, whose first word is the program.
pub fn of(command: Command, line: impl IntoIterator<Item = OsString>) -> Result<Vec<String>, Failure> {
    let matches = command.clone().try_get_matches_from(line)?;
    let mut words = Vec::new();
    collect(&command, &matches, &mut words)?;
    Ok(words)
}

fn collect(command: &Command, matches: &ArgMatches, words: &mut Vec<String>) -> Result<(), Failure> {
    let mut operands = Vec::new();
    for argument in command.get_arguments() {
        let id = argument.get_id().as_str();
        if NOT_OF_THE_RESULT.contains(&id) || matches.value_source(id).is_none() {
            continue;
        }
        let flag = matches!(argument.get_action(), ArgAction::SetTrue);
        match argument.get_long() {
            Some(long) if flag => {
                if matches.get_flag(id) {
                    words.push(format!("--{long}"));
                }
            }
            Some(long) => {
                for value in matches.get_raw(id).into_iter().flatten() {
                    words.push(format!("--{long}={}", text(value)?));
                }
            }
            None => {
                for value in matches.get_raw(id).into_iter().flatten() {
                    operands.push(operand(text(value)?)?);
                }
            }
        }
    }
    words.append(&mut operands);
    if let Some((name, matches)) = matches.subcommand() {
        words.push(name.to_owned());
        if let Some(command) = command.find_subcommand(name) {
            collect(command, matches, words)?;
        }
    }
    Ok(())
}

/// Options may be put behind the arguments, so that no operand may look like one.
fn operand(text: &str) -> Result<String, Failure> {
    match text.starts_with('-') {
        true => Err(Failure::new(format!(
            "{text}: would be read as an option; write ./{text}"
        ))),
        false => Ok(text.to_owned()),
    }
}

fn text(value: &std::ffi::OsStr) -> Result<&str, Failure> {
    value.to_str().ok_or_else(|| {
        Failure::new(format!(
            "{}: is not UTF-8, and cannot be written into a shard; rename the file",
            value.to_string_lossy()
        ))
    })
}

/// A command line as a user would type it: words with a space or a special character are quoted for a shell.
pub fn quoted(words: &[String]) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_=./,:+@%".contains(c);
    let quote = |word: &String| match !word.is_empty() && word.chars().all(plain) {
        true => word.clone(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    };
    words.iter().map(quote).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Arg;

    fn canonical(line: &str) -> Vec<String> {
        let study = Command::new("study")
            .arg(Arg::new("first").long("first").default_value("0"))
            .arg(Arg::new("check").long("check").action(ArgAction::SetTrue))
            .arg(
                Arg::new("terms")
                    .long("terms")
                    .value_delimiter(',')
                    .action(ArgAction::Append),
            )
            .arg(Arg::new("threads").long("threads"))
            .arg(Arg::new("folder"));
        let line = line.split(' ').map(OsString::from);
        of(Command::new("oleo").subcommand(study), line).expect("a command line")
    }

    #[test]
    fn what_asks_for_the_same_is_the_same() {
        let one = canonical("oleo study --terms a,b --first 0");
        assert_eq!(one, ["study", "--first=0", "--terms=a", "--terms=b"]);
        assert_eq!(one, canonical("oleo study --threads 4 --terms a --terms=b"));
        let other = canonical("oleo study --check runs --first 3");
        assert_eq!(other, ["study", "--first=3", "--check", "runs"]);
        let again: Vec<String> = std::iter::once("oleo".to_owned()).chain(other.clone()).collect();
        assert_eq!(canonical(&again.join(" ")), other);
    }

    #[test]
    fn words_are_quoted_for_a_shell() {
        let words = ["study", "--vehicle=my car's.toml", ""].map(str::to_owned);
        assert_eq!(quoted(&words), r"study '--vehicle=my car'\''s.toml' ''");
    }
}
