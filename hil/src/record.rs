//! The record of a run in memory: one sample for each tick, and what is read from the traced frames.
//!
//! All memory is reserved before the run starts, so that in the loop a sample is only a copy. Measures, logs and pictures are
//! computed afterwards.

use crc::{CRC_64_XZ, Crc};
use oleo_controller::can::{COMMAND, CommandMessage, STATUS, StatusMessage};
use oleo_controller::{FaultCode, Mode, ValveCommand};
use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::course::Phase;
use oleo_plant_sim::handling::HandlingMotion;
use oleo_plant_sim::strut::StrutOutput;
use oleo_plant_sim::vehicle::{BodyMotion, InertialReading};

use crate::bus::{Direction, TraceEntry};

/// A wheel and the road under it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wheel {
    /// Force of the road on the wheel, N; 0 off the ground.
    pub load_n: f64,
    /// Height of the road under the wheel from the level at the start, m.
    pub road_height_m: f64,
}

/// How the vehicle moves at an instant, with either model.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// Centre of mass of the body ahead of the start, where the front axle stood, m.
    pub station_m: f64,
    /// Motion of the sprung mass.
    pub body: BodyMotion,
    /// The four wheels.
    pub wheel: Corners<Wheel>,
    /// What only a vehicle on a course has; `None` for the ride model.
    pub course: Option<CourseMotion>,
}

/// A steered vehicle and the line that its driver follows.
#[derive(Clone, Copy, Debug)]
pub struct CourseMotion {
    /// Motion of the body in the world.
    pub body: HandlingMotion,
    /// Angle of the steering wheel over the steering ratio, rad, left positive.
    pub steer_rad: f64,
    /// How far the body's centre of mass is right of the line, m; `None` while the steering wheel is held.
    pub path_deviation_m: Option<f64>,
    /// Room to the nearest cones, m, negative where one is hit; `None` where there are none.
    pub cone_margin_m: Option<f64>,
    /// Where in the manoeuvre it is; `None` where the manoeuvre has no cornering.
    pub phase: Option<Phase>,
}

/// State at the beginning of a tick, and the valve commands that held from there to the next tick.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Motion of the vehicle.
    pub motion: Motion,
    /// Strut displacement, m, compression positive.
    pub displacement_m: Corners<f64>,
    /// Force and pressures of each strut.
    pub strut: Corners<StrutOutput>,
    /// What the inertial unit would read without noise, in its own axes; `None` where there is none.
    pub inertial: Option<InertialReading>,
    /// Whether a command of the controller arrived in this tick and passed its check.
    pub heard: bool,
    /// The command that the drivers obeyed, after check and watchdog.
    pub command: ValveCommand,
    /// Positions of the valves' signals, stuck valves included.
    pub energised: ValveCommand,
}

/// The four struts after an integration step.
#[derive(Clone, Copy, Debug)]
pub struct StrutStep {
    /// Strut displacement, m, compression positive.
    pub displacement_m: Corners<f64>,
    /// Force and pressures of each strut.
    pub strut: Corners<StrutOutput>,
}

/// The samples of a run.
#[derive(Debug, Default)]
pub struct Recording {
    /// One sample for each tick.
    pub samples: Vec<Sample>,
    /// Vertical acceleration at the driver's and at the left rear passenger's seat for every integration step, m/s2.
    pub seat_acceleration_m_s2: Vec<[f64; 2]>,
    /// The struts after every integration step, if the vehicle records them.
    pub strut_steps: Vec<StrutStep>,
    /// Integration step of the vehicle, s.
    pub step_s: f64,
}

impl Recording {
    /// An empty recording with memory for a run.
    pub fn with_capacity(ticks: usize, steps_per_tick: usize, step_s: f64) -> Self {
        Self {
            samples: Vec::with_capacity(ticks),
            seat_acceleration_m_s2: Vec::with_capacity(ticks * steps_per_tick),
            strut_steps: Vec::new(),
            step_s,
        }
    }

    /// The same with memory for the struts after every integration step.
    pub fn with_struts(mut self) -> Self {
        self.strut_steps.reserve(self.seat_acceleration_m_s2.capacity());
        self
    }

    /// The valve words that the drivers obeyed, one for each tick.
    pub fn words(&self) -> impl Iterator<Item = u16> {
        self.samples.iter().map(|sample| sample.command.word())
    }

    /// Number of changes of each valve's signal. Before the first tick all valves are closed.
    pub fn valve_switches(&self) -> Corners<StrutValves<u64>> {
        let mut edges = Corners::<StrutValves<u64>>::default();
        let mut before = ValveCommand::SAFE;
        for sample in &self.samples {
            let changed = ValveCommand::from_word(sample.energised.word() ^ before.word());
            for (corner, strut) in edges.iter_mut() {
                for (valve, changed) in changed.strut(corner).iter() {
                    strut[valve] += u64::from(*changed);
                }
            }
            before = sample.energised;
        }
        edges
    }
}

/// Digest of a sequence of valve words: CRC-64/XZ of the words as little-endian 16-bit numbers, 16 hexadecimal digits.
///
/// The digest need not be cryptographic, because nobody gains from forging it. Tools for this one exist in every language.
pub fn command_hash(words: impl IntoIterator<Item = u16>) -> String {
    let crc = Crc::<u64>::new(&CRC_64_XZ);
    let mut digest = crc.digest();
    for word in words {
        digest.update(&word.to_le_bytes());
    }
    format!("{:016x}", digest.finalize())
}

/// Mode and first cause in each tick as the controller's frames on the wire say it, before injected faults; `None` for a tick
/// without a readable command.
pub fn controller_account(trace: &[TraceEntry], ticks: usize) -> Vec<Option<(Mode, FaultCode)>> {
    let mut account = vec![None; ticks];
    for entry in trace.iter().filter(|e| e.direction == Direction::Received) {
        if entry.frame.standard_id() == Some(COMMAND.id)
            && let Ok(data) = <&[u8; 8]>::try_from(entry.frame.data())
            && let Some(message) = CommandMessage::decode(data)
            && let Some(slot) = account.get_mut(entry.tick as usize)
        {
            *slot = Some((message.mode, message.fault));
        }
    }
    account
}

/// The controller's status messages, each with the tick in which it came.
pub fn status_messages(trace: &[TraceEntry]) -> Vec<(u32, StatusMessage)> {
    let received = trace.iter().filter(|e| e.direction == Direction::Received);
    received
        .filter(|entry| entry.frame.standard_id() == Some(STATUS.id))
        .filter_map(|entry| Some((entry.tick, StatusMessage::decode(entry.frame.data().try_into().ok()?)?)))
        .collect()
}

/// What the controller's last status said of its strategy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StrategyReport {
    /// The strategy is in handling mode.
    pub handling: bool,
    /// The roll-over guard acts.
    pub rollover_guard: bool,
}

/// What the last status until each tick said.
pub fn strategy_reports(trace: &[TraceEntry], ticks: usize) -> Vec<StrategyReport> {
    let mut reports = vec![StrategyReport::default(); ticks];
    for (tick, status) in status_messages(trace) {
        let report = StrategyReport {
            handling: status.handling,
            rollover_guard: status.rollover_guard,
        };
        if let Some(rest) = reports.get_mut(tick as usize..) {
            rest.fill(report);
        }
    }
    reports
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hash_is_crc64_xz_of_little_endian_words() {
        // Check value of CRC-64/XZ: "123456789" gives 995dc9bbdf1939fa; its first eight bytes as four words and one more
        // cannot be it, so the four words are compared with the same bytes digested at once.
        let words = [0x3231, 0x3433, 0x3635, 0x3837];
        let whole = Crc::<u64>::new(&CRC_64_XZ).checksum(b"12345678");
        assert_eq!(command_hash(words), format!("{whole:016x}"));
        assert_eq!(
            Crc::<u64>::new(&CRC_64_XZ).checksum(b"123456789"),
            0x995d_c9bb_df19_39fa
        );
        assert_ne!(command_hash([0, 0]), command_hash([0]));
    }
}
