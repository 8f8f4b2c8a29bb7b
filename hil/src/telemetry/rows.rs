//! A run of the loop as rows, one for each tick: the columns of `timeseries.csv`, and what only messages have.

use oleo_controller::can::{COMMAND, CommandMessage, STATUS, StatusMessage};
use oleo_controller::{FaultCode, Mode};
use oleo_interface::tick::TICK_MS;
use oleo_interface::{Corner, Valve};

use super::topic::{BUS, Column, Value};
use crate::bit_timing::wire_bits;
use crate::bus::{Direction, TraceEntry};
use crate::record::{Recording, StrategyReport};
use crate::time_series::{OfTick, Tick, quantities};

/// Nanoseconds in a tick.
pub const TICK_NS: u64 = TICK_MS as u64 * 1_000_000;

/// Bits that a wire of 1 Mbit/s carries in a tick.
const BITS_IN_A_TICK: f64 = 1000.0 * TICK_MS as f64;

/// Makes rows of what has been driven, and knows how far it has come.
pub struct Rows {
    quantities: Vec<OfTick>,
    columns: Vec<Column>,
    tick: usize,
    /// Number of entries of the trace that were heard.
    heard: usize,
    status: Option<StatusMessage>,
    row: Vec<Value>,
}

/// What was on the bus in a tick.
#[derive(Default)]
struct OnBus {
    sent: u32,
    received: u32,
    bits: u32,
    account: Option<(Mode, FaultCode)>,
}

impl Rows {
    /// Rows from the first tick on, of a vehicle on a course or not, with an inertial unit or not.
    pub fn new(on_course: bool, with_unit: bool) -> Self {
        let (names, quantities): (Vec<String>, Vec<OfTick>) = quantities(on_course, with_unit).into_iter().unzip();
        let mut columns: Vec<Column> = names.into_iter().map(Column::number).collect();
        for corner in Corner::ALL {
            columns
                .extend((1..=Valve::ALL.len()).map(|valve| Column::number(format!("valve{valve}_{}", corner.key()))));
        }
        columns.extend(STATUS_COLUMNS.map(Column::number));
        columns.extend(["mode", "fault"].map(Column::word));
        columns.extend(BUS.map(Column::number));
        Self {
            quantities,
            columns,
            tick: 0,
            heard: 0,
            status: None,
            row: Vec::new(),
        }
    }

    /// The columns of each row.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Time of a row, nanoseconds since the start.
    pub fn time_ns(tick: usize) -> u64 {
        tick as u64 * TICK_NS
    }

    /// The next row with the number of its tick, if at least `margin` ticks more than it were driven. In a run in real time the command of a
    /// tick comes at the beginning of the next.
    pub fn next(&mut self, recording: &Recording, trace: &[TraceEntry], margin: usize) -> Option<(usize, &[Value])> {
        if self.tick + margin >= recording.samples.len() {
            return None;
        }
        let number = self.tick;
        let on_bus = self.listen(trace);
        let strategy = self
            .status
            .map_or_else(StrategyReport::default, |status| StrategyReport {
                handling: status.handling,
                rollover_guard: status.rollover_guard,
            });
        let tick = Tick::of(recording, number, strategy)?;
        self.row.clear();
        self.row
            .extend(self.quantities.iter().map(|of| Value::Number(of(&tick))));
        for corner in Corner::ALL {
            let signals = tick.sample.energised.strut(corner);
            let numbers = signals
                .iter()
                .map(|(_, open)| Value::Number(f64::from(u8::from(*open))));
            self.row.extend(numbers);
        }
        let said = |of: fn(&StatusMessage) -> f64| Value::Number(self.status.as_ref().map_or(f64::NAN, of));
        self.row.extend([
            said(|status| status.lateral_rms_m_s2.into()),
            said(|status| status.vertical_rms_m_s2.into()),
            said(|status| status.invalid_readings.into()),
            said(|status| status.lost_messages.bits().into()),
        ]);
        self.row.extend(match on_bus.account {
            Some((mode, fault)) => [Value::Word(mode.name()), Value::Word(fault.name())],
            None => [Value::Word(""); 2],
        });
        let load = f64::from(on_bus.bits) / BITS_IN_A_TICK;
        let numbers = [on_bus.sent.into(), on_bus.received.into(), 2.0 * load, load];
        self.row.extend(numbers.map(Value::Number));
        self.tick += 1;
        Some((number, &self.row))
    }

    /// Takes the frames of the tick from the trace.
    fn listen(&mut self, trace: &[TraceEntry]) -> OnBus {
        let mut on_bus = OnBus::default();
        let frames = trace.get(self.heard..).unwrap_or(&[]);
        for entry in frames.iter().take_while(|entry| entry.tick as usize <= self.tick) {
            self.heard += 1;
            on_bus.bits += wire_bits(&entry.frame);
            if entry.direction == Direction::Sent {
                on_bus.sent += 1;
                continue;
            }
            on_bus.received += 1;
            let Ok(data) = <&[u8; 8]>::try_from(entry.frame.data()) else {
                continue;
            };
            match entry.frame.standard_id() {
                Some(id) if id == COMMAND.id => {
                    let command = CommandMessage::decode(data);
                    on_bus.account = command.map(|command| (command.mode, command.fault)).or(on_bus.account);
                }
                Some(id) if id == STATUS.id => self.status = StatusMessage::decode(data).or(self.status),
                _ => {}
            }
        }
        on_bus
    }
}

/// What the controller's status message estimates and counts.
const STATUS_COLUMNS: [&str; 4] = [
    "lateral_rms_m_s2",
    "vertical_rms_m_s2",
    "invalid_readings",
    "lost_messages_word",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::imu::ImuSettings;
    use crate::metrics::Metrics;
    use crate::run::{both, vehicle};
    use crate::scenario::{self, Scenario};
    use crate::time_series;

    /// Rows taken while a run is under way are those taken afterwards, and have the columns of the CSV file.
    #[test]
    fn rows_are_the_columns_of_the_time_series() {
        let scenario = Scenario {
            ticks: 137,
            imu: Some(ImuSettings::default()),
            ..scenario::named("bus-silence").expect("built in")
        };
        let on_course = scenario.course.is_some();
        let (mut live, mut found) = (Rows::new(on_course, true), Vec::new());
        let outcome = both(&scenario, vehicle(&scenario).expect("a vehicle"), 1, &mut |run| {
            while let Some((tick, row)) = live.next(run.recording, run.trace, 1) {
                found.push((tick, row.to_vec()));
            }
            true
        })
        .expect("a run");
        assert_eq!(found.len(), 129, "one less than the watch has seen");
        let mut after = Rows::new(on_course, true);
        let mut all = Vec::new();
        while let Some((tick, row)) = after.next(&outcome.plant.recording, &outcome.plant.trace, 0) {
            all.push((tick, row.to_vec()));
        }
        assert_eq!(all.len(), 137);
        let text = |rows: &[(usize, Vec<Value>)]| format!("{rows:?}");
        assert_eq!(text(&found), text(&all[..129]));
        let metrics = Metrics::of(&scenario, &outcome);
        for (place, (name, values)) in time_series::columns(&outcome, &metrics).iter().enumerate() {
            assert_eq!(&after.columns()[place].name, name);
            for (value, (_, row)) in values.iter().zip(&all) {
                assert_eq!(Value::Number(*value), row[place], "{name}");
            }
        }
        let words = time_series::words(&metrics);
        let first = after
            .columns()
            .iter()
            .position(|column| column.name == "mode")
            .expect("a mode");
        for (place, (name, values)) in (first..).zip(&words) {
            assert_eq!(after.columns()[place].name, *name);
            for (value, (_, row)) in values.iter().zip(&all) {
                assert_eq!(Value::Word(value), row[place], "{name}");
            }
        }
    }
}
