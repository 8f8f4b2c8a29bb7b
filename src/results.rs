//! Where a command writes its results, and what it says at its end: tables on standard output, and the path of the page.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use oleo_report::{Origin, OutputDirectory};

use crate::failure::Failure;

/// Version of this program, with the commit that it was built from.
pub const VERSION: &str = env!("OLEO_VERSION");

/// Name of the page in a folder of results.
const PAGE: &str = "report.html";

/// Folder, in the current one, that holds the results of commands without `--out`.
const HOME: &str = "oleo-out";

/// How long a browser may take to refuse.
const PATIENCE: Duration = Duration::from_secs(2);

/// Options of every command that writes a folder of results.
#[derive(clap::Args)]
#[group(id = "results")]
pub struct ResultsArgs {
    /// Folder to which data (CSV, JSON) and report.html, a page that opens offline, are written [default: a folder in oleo-out]
    #[arg(long, value_name = "DIR", help_heading = "Results")]
    out: Option<PathBuf>,
    /// Write no files, and print the tables only
    #[arg(long, conflicts_with_all = ["out", "force", "open"], help_heading = "Results")]
    no_out: bool,
    /// Write also among files that oleo did not write, and over results that were edited. Inputs are never replaced
    #[arg(long, help_heading = "Results")]
    force: bool,
    /// Open the page in the browser
    #[arg(long, help_heading = "Results")]
    open: bool,
    /// What is printed on standard output: tables and the path of the page, or summary.json (of diagnose report.json)
    #[arg(long, value_enum, default_value_t = Format::Text, help_heading = "Results")]
    format: Format,
}

/// What a command prints of its results.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// Tables, and the path of the page as the last line
    Text,
    /// The summary as it is in the folder, and nothing else
    Json,
}

impl ResultsArgs {
    /// Stages the folder of a command: `command` is `oleo hil`, `name` what the folder is called without `--out`. A folder that
    /// cannot be written is refused here, before the work.
    pub fn stage(&self, command: &str, name: &str, inputs: Vec<PathBuf>) -> Result<Option<OutputDirectory>, Failure> {
        let folder = match self.folder(name)? {
            Some(folder) => folder,
            // What is printed is staged like what is written, and dropped.
            None if self.format == Format::Json => std::env::temp_dir().join(format!("oleo-{}", std::process::id())),
            None => return Ok(None),
        };
        Ok(Some(OutputDirectory::stage(
            folder,
            origin(command, inputs),
            self.force,
        )?))
    }

    /// As [`Self::stage`], with the path of a file of finished runs where there is a folder to keep it in.
    pub fn stage_with_ledger(
        &self,
        command: &str,
        name: &str,
        inputs: Vec<PathBuf>,
        ledger: &str,
    ) -> Result<(Option<OutputDirectory>, Option<PathBuf>), Failure> {
        let Some(folder) = self.folder(name)? else {
            return Ok((self.stage(command, name, inputs)?, None));
        };
        let (out, ledger) = OutputDirectory::stage_with_ledger(folder, origin(command, inputs), self.force, ledger)?;
        Ok((Some(out), Some(ledger)))
    }

    /// The folder of the shards of a study, and whether shards of another study in it are replaced.
    pub fn of_shards(&self, name: &str) -> Result<(PathBuf, bool), Failure> {
        if self.format == Format::Json {
            return Err(Failure::new(
                "--format json: a shard has no summary; leave the option out, and give it to oleo merge",
            ));
        }
        let folder = match &self.out {
            Some(out) => out.clone(),
            None => default_path(&format!("{name}.shards"))?,
        };
        Ok((folder, self.force))
    }

    /// Whether files that this program did not write may be replaced.
    pub fn force(&self) -> bool {
        self.force
    }

    /// The folder of `--out`.
    pub fn out(&self) -> Option<&Path> {
        self.out.as_deref()
    }

    /// The folder of the results; `None` where none are wanted. The folder that holds those without `--out` is made.
    fn folder(&self, name: &str) -> Result<Option<PathBuf>, Failure> {
        match &self.out {
            _ if self.no_out => Ok(None),
            Some(out) => Ok(Some(out.clone())),
            None => default_path(name).map(Some),
        }
    }

    /// Moves the results into place and prints `text`, and the path of the page as the last line; or the summary.
    pub fn publish(&self, out: Option<OutputDirectory>, text: &str) -> Result<(), Failure> {
        self.publish_with(out, text, PAGE)
    }

    /// As [`Self::publish`], where another file is the one to look at.
    pub fn publish_with(&self, out: Option<OutputDirectory>, text: &str, shown: &str) -> Result<(), Failure> {
        let Some(out) = out else { return say(text) };
        let summary = out.summary_text().to_owned();
        if self.no_out {
            return say(&summary);
        }
        let page = out.commit()?.join(shown);
        match self.format {
            Format::Json => say(&summary)?,
            Format::Text => say(&format!("{text}{}\n", page.display()))?,
        }
        if self.open {
            open(&page);
        }
        Ok(())
    }
}

/// What results say of where they come from.
pub fn origin(command: &str, inputs: Vec<PathBuf>) -> Origin {
    Origin {
        command: command.to_owned(),
        version: VERSION.to_owned(),
        inputs,
    }
}

/// `name` in the folder of results without `--out`, which is made.
pub fn default_path(name: &str) -> Result<PathBuf, Failure> {
    std::fs::create_dir_all(HOME).map_err(|error| {
        Failure::new(format!(
            "{HOME}: cannot make this folder for the results: {error}; name another with --out, or add --no-out"
        ))
    })?;
    let plain = |c: char| match c {
        'a'..='z' | 'A'..='Z' | '0'..='9' | '-' | '_' | '.' => c,
        _ => '-',
    };
    let name: String = name.trim_start_matches('.').chars().map(plain).collect();
    Ok(Path::new(HOME).join(name))
}

/// Removes the folder of results without `--out` where a command that failed left it empty.
pub fn tidy() {
    let _ = std::fs::remove_dir(HOME);
}

/// The command as it was given, for the page.
pub fn command_line() -> String {
    let words = (std::env::args_os().skip(1)).map(|word| {
        let word = word.to_string_lossy().into_owned();
        if word.contains(' ') { format!("{word:?}") } else { word }
    });
    std::iter::once("oleo".to_owned())
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
}

/// Writes to standard output. A reader that has gone away (`oleo hil | head`) is no failure, a full disk is.
pub fn say(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::new(format!(
            "standard output: cannot be written: {error}; the files of the results, if any, are complete"
        ))),
        _ => Ok(()),
    }
}

/// Shows a page with the first program that takes it. Where none does, the user is told, and the results are as good.
fn open(page: &Path) {
    let page = std::path::absolute(page).unwrap_or_else(|_| page.to_path_buf());
    let opened = open::commands(&page).into_iter().any(starts);
    if !opened {
        let _ = writeln!(
            std::io::stderr(),
            "--open: no browser could be started; open {} yourself",
            page.display()
        );
    }
}

/// Whether a program starts, and does not refuse at once.
fn starts(mut command: Command) -> bool {
    let quiet = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let Ok(mut child) = quiet.spawn() else { return false };
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        match child.try_wait() {
            Ok(Some(status)) => return status.success(),
            Ok(None) => std::thread::sleep(Duration::from_millis(20)),
            Err(_) => return false,
        }
    }
    true
}
