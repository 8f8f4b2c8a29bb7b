//! K/N: which part of a study is run here.

use std::str::FromStr;

use crate::failure::Failure;

/// Most parts of a study: as many tasks as the largest arrays of Slurm and Kubernetes have.
const MOST: u32 = 100_000;

/// Number of a task in an array of Slurm, as `oleo submit` numbers them: from 1.
const SLURM: &str = "SLURM_ARRAY_TASK_ID";
/// Number of a pod in an indexed job of Kubernetes: from 0.
const KUBERNETES: &str = "JOB_COMPLETION_INDEX";

/// The option of every study that can be divided.
#[derive(clap::Args)]
#[group(id = "shards")]
pub struct ShardArgs {
    /// Run part K of N of the cases only (1/N to N/N), and write them to DIR for oleo merge. With /N, K is the number of the task: of
    /// SLURM_ARRAY_TASK_ID, or of JOB_COMPLETION_INDEX (Kubernetes, which counts from 0)
    #[arg(long, value_name = "K/N", conflicts_with_all = ["no_out", "open"], help_heading = "Shards")]
    shard: Option<Asked>,
}

impl ShardArgs {
    /// The part that is run here; `None` for all of the study.
    pub fn part(&self) -> Result<Option<Part>, Failure> {
        let variable = |name: &str| std::env::var(name).ok();
        self.shard.map(|asked| asked.part(variable)).transpose()
    }

    /// Whether a part is asked for.
    pub fn is_given(&self) -> bool {
        self.shard.is_some()
    }
}

/// What `--shard` says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Asked {
    number: Option<u32>,
    of: u32,
}

impl FromStr for Asked {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("give a part as K/N, such as 3/12, or /N within an array of jobs, N from 1 to {MOST}");
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let of: u32 = of.parse().map_err(|_| wrong())?;
        let number: Option<u32> = match number {
            "" => None,
            number => Some(number.parse().map_err(|_| wrong())?),
        };
        if !(1..=MOST).contains(&of) {
            return Err(wrong());
        }
        if number.is_some_and(|number| !(1..=of).contains(&number)) {
            return Err(format!("there is no such part; give 1/{of} to {of}/{of}"));
        }
        Ok(Self { number, of })
    }
}

impl Asked {
    fn part(self, variable: impl Fn(&str) -> Option<String>) -> Result<Part, Failure> {
        let of = self.of;
        if let Some(number) = self.number {
            return Ok(Part { number, of });
        }
        let (name, text, first) = match (variable(SLURM), variable(KUBERNETES)) {
            (Some(text), None) => (SLURM, text, 1),
            (None, Some(text)) => (KUBERNETES, text, 0),
            (None, None) => {
                return Err(Failure::new(format!(
                    "--shard /{of}: neither {SLURM} nor {KUBERNETES} is set; write --shard K/{of}"
                )));
            }
            (Some(_), Some(_)) => {
                return Err(Failure::new(format!(
                    "--shard /{of}: both {SLURM} and {KUBERNETES} are set; write --shard K/{of}"
                )));
            }
        };
        let task = text.parse::<u32>().ok().and_then(|task| task.checked_sub(first));
        match task {
            Some(place) if place < of => Ok(Part { number: place + 1, of }),
            _ => Err(Failure::new(format!(
                "{name}={text}: --shard /{of} has the tasks {first} to {}; give the array that many",
                of - 1 + first
            ))),
        }
    }
}

/// Part `number` of `of`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Part {
    pub number: u32,
    pub of: u32,
}

impl Part {
    /// All parts of a study.
    pub fn all(of: u32) -> impl Iterator<Item = Self> {
        (1..=of).map(move |number| Self { number, of })
    }

    /// Its cases, of so many: every N-th, because studies put what takes long together. Every case is in one part.
    pub fn cases(self, of_all: usize) -> Vec<usize> {
        ((self.number as usize - 1)..of_all).step_by(self.of as usize).collect()
    }

    /// Refuses more parts than cases: a part without a case is a mistake.
    pub fn check(self, cases: usize) -> Result<(), Failure> {
        if self.of as usize <= cases {
            return Ok(());
        }
        Err(Failure::new(format!(
            "{} shards: the study has {cases} cases; give at most as many shards",
            self.of
        )))
    }
}

impl std::fmt::Display for Part {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(text: &str, slurm: Option<&str>, kubernetes: Option<&str>) -> Result<String, String> {
        let variable = |name: &str| if name == SLURM { slurm } else { kubernetes }.map(str::to_owned);
        let part = text.parse::<Asked>()?.part(variable).map_err(|e| e.to_string())?;
        Ok(part.to_string())
    }

    #[test]
    fn a_part_is_said_or_taken_from_the_array() {
        assert_eq!(part("3/12", Some("5"), None).as_deref(), Ok("3/12"));
        assert_eq!(part("/12", Some("12"), None).as_deref(), Ok("12/12"));
        assert_eq!(part("/12", None, Some("0")).as_deref(), Ok("1/12"));
        for (text, slurm, kubernetes, complaint) in [
            ("13/12", None, None, "1/12 to 12/12"),
            ("0/12", None, None, "1/12 to 12/12"),
            ("1/0", None, None, "N from 1"),
            ("3", None, None, "K/N"),
            ("a/b", None, None, "K/N"),
            ("1/4294967297", None, None, "K/N"),
            ("/12", None, None, "write --shard K/12"),
            ("/12", Some("1"), Some("1"), "both"),
            ("/12", Some("13"), None, "tasks 1 to 12"),
            ("/12", Some("0"), None, "tasks 1 to 12"),
            ("/12", None, Some("12"), "tasks 0 to 11"),
            ("/12", Some("x"), None, "SLURM_ARRAY_TASK_ID=x"),
        ] {
            let error = part(text, slurm, kubernetes).expect_err(text);
            assert!(error.contains(complaint), "{text}: {error}");
        }
    }

    #[test]
    fn every_case_is_in_one_part() {
        for (cases, of) in [(12, 12), (25, 12), (7, 1), (5, 5)] {
            let mut all: Vec<usize> = Part::all(of).flat_map(|part| part.cases(cases)).collect();
            all.sort_unstable();
            assert_eq!(all, (0..cases).collect::<Vec<_>>());
            assert!(Part::all(of).all(|part| !part.cases(cases).is_empty()));
        }
        assert!(Part { number: 1, of: 6 }.check(5).is_err());
    }
}
