//! The progress of a run that takes more than a second. It is shown on a terminal only.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// How long a command may work before a bar appears.
const PATIENCE: Duration = Duration::from_secs(1);

/// Progress bar on standard error. Threads may share it; it never touches standard output nor any result.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    started: Instant,
    interactive: bool,
}

impl Progress {
    /// A bar for `total` units of work, invisible until a second has passed.
    pub fn new(label: &str, total: u64) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}") {
            bar.set_style(style);
        }
        bar.set_message(label.to_owned());
        Self {
            bar,
            started: Instant::now(),
            interactive: std::io::stderr().is_terminal(),
        }
    }

    /// `count` more units are done.
    pub fn add(&self, count: u64) {
        self.show_when_due();
        self.bar.inc(count);
    }

    /// `position` units are done in all.
    pub fn set(&self, position: u64) {
        self.show_when_due();
        self.bar.set_position(position);
    }

    fn show_when_due(&self) {
        if self.interactive && self.bar.is_hidden() && self.started.elapsed() > PATIENCE {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
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
}
