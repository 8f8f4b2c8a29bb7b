//! The progress of a run that takes more than a second: a bar on a terminal, a line a phase or quarter elsewhere.

use std::io::{IsTerminal, Write as _};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// How long a command may work before it shows progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// Progress on standard error. Threads may share it; it never touches standard output nor any result.
#[derive(Debug)]
pub struct Progress {
    label: String,
    bar: ProgressBar,
    started: Instant,
    interactive: bool,
    said: Mutex<Said>,
}

/// What was written where there is no terminal.
#[derive(Debug, Default)]
struct Said {
    phase: String,
    line: String,
}

impl Progress {
    /// Progress of `total` units of work, invisible until a second has passed.
    pub fn new(label: &str, total: u64) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}") {
            bar.set_style(style);
        }
        bar.set_message(label.to_owned());
        Self {
            label: label.to_owned(),
            bar,
            started: Instant::now(),
            interactive: std::io::stderr().is_terminal(),
            said: Mutex::default(),
        }
    }

    /// Says in words what is done from now on.
    pub fn phase(&self, phase: &str) {
        self.bar.set_message(format!("{}: {phase}", self.label));
        phase.clone_into(&mut self.said.lock().unwrap_or_else(PoisonError::into_inner).phase);
    }

    /// `count` more units are done.
    pub fn add(&self, count: u64) {
        self.bar.inc(count);
        self.show_when_due();
    }

    /// `position` units are done in all.
    pub fn set(&self, position: u64) {
        self.bar.set_position(position);
        self.show_when_due();
    }

    fn show_when_due(&self) {
        if self.started.elapsed() <= PATIENCE {
            return;
        }
        if !self.interactive {
            if let Some(line) = self.next_line() {
                // A closed standard error is no reason to stop.
                let _ = writeln!(std::io::stderr(), "{line}");
            }
        } else if self.bar.is_hidden() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }

    /// The line for a log, where it differs from the one before: the phase, or the quarters that are done.
    fn next_line(&self) -> Option<String> {
        let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        let quarters = 4 * self.bar.position() / self.bar.length().unwrap_or(1).max(1);
        let line = match said.phase.as_str() {
            "" if quarters == 0 => format!("{}: at work", self.label),
            "" => format!("{}: {} % done", self.label, 25 * quarters),
            phase => format!("{}: {phase}", self.label),
        };
        (said.line != line).then(|| said.line.clone_from(&line))?;
        Some(line)
    }
}

impl Drop for Progress {
    /// The bar leaves no trace: what remains on the terminal is the outcome.
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_without_a_terminal() {
        let progress = Progress::new("runs", 10);
        progress.add(3);
        progress.set(7);
        assert_eq!(progress.bar.position(), 7);
        assert!(progress.bar.is_hidden());
    }

    #[test]
    fn a_log_has_a_line_for_each_quarter_or_phase() {
        let progress = Progress::new("runs", 8);
        let lines = |positions: &[u64]| -> Vec<String> {
            let at = |position: &u64| {
                progress.bar.set_position(*position);
                progress.next_line()
            };
            positions.iter().filter_map(at).collect()
        };
        let quarters = [
            "runs: at work",
            "runs: 25 % done",
            "runs: 50 % done",
            "runs: 100 % done",
        ];
        assert_eq!(lines(&[0, 1, 2, 3, 4, 4, 8]), quarters);
        progress.phase("screening every candidate");
        assert_eq!(lines(&[1, 2]), ["runs: screening every candidate"]);
    }
}
