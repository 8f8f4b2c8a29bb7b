//! The conversion of a log, as `oleo convert` does it.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use oleo_hil::logs::candump::write_line;
use oleo_hil::run::{both, vehicle};
use oleo_hil::scenario;
use oleo_interface::tick::TICK_US;
use oleo_report::digest;

use super::contract::Work;
use crate::commands::convert;
use crate::failure::Failure;

/// Scenario whose frames are logged.
const SCENARIO: &str = "belgian";
/// Ticks of the drive. All counters of the messages have run round after so many, so that it can be repeated as one long drive.
const TICKS: u32 = 1024;
/// Time between two frames of a tick, microseconds: that of a frame at 500 kbit/s.
const FRAME_US: u64 = 260;

/// A log and the file that it is converted to.
pub struct Conversion {
    arguments: convert::Args,
    frames: u64,
}

impl Conversion {
    /// Writes the log. The end of the name of the output says what it is converted to.
    pub fn prepare(frames: u64, scratch: &Path, to: &str) -> Result<Self, Failure> {
        let log = scratch.join(format!("{frames}.log"));
        // Other repeats and the other curve have the same log.
        if !log.exists() {
            write(&log, frames)?;
        }
        let output = scratch.join(format!("converted.{to}"));
        // A process that only did the work left its file.
        if output.exists() {
            std::fs::remove_file(&output)?;
        }
        Ok(Self {
            arguments: convert::Args::of(log, output),
            frames,
        })
    }

    fn output(&self) -> &PathBuf {
        self.arguments.output()
    }
}

impl Work for Conversion {
    fn run(&mut self) -> Result<u64, Failure> {
        convert::convert(&self.arguments)?;
        Ok(self.frames)
    }

    fn outcome(&self) -> Result<String, Failure> {
        let unreadable = || Failure::new(format!("{}: cannot be read", self.output().display()));
        let digest = digest::of_file(self.output()).ok_or_else(unreadable)?;
        std::fs::remove_file(self.output())?;
        Ok(digest)
    }
}

/// Writes a log of so many frames under another name and renames it, so that a log that is there is whole.
fn write(log: &Path, frames: u64) -> Result<(), Failure> {
    let mut scenario = scenario::named(SCENARIO)?;
    scenario.ticks = TICKS;
    let trace = both(&scenario, vehicle(&scenario)?, 1, &mut |_| true)?.plant.trace;
    let half = log.with_extension("part");
    let mut out = BufWriter::new(File::create(&half)?);
    let tick_us = u64::from(TICK_US);
    let (mut begin_us, mut written) = (0, 0);
    while written < frames {
        let (mut tick, mut within) = (0, 0);
        for entry in trace.iter().take((frames - written) as usize) {
            within = if entry.tick == tick { within + 1 } else { 0 };
            tick = entry.tick;
            let time_us = begin_us + tick_us * u64::from(tick) + FRAME_US * within;
            write_line(&mut out, time_us, "can0", &entry.frame)?;
            written += 1;
        }
        begin_us += tick_us * u64::from(TICKS);
    }
    out.flush()?;
    std::fs::rename(half, log)?;
    Ok(())
}
