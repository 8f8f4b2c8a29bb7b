//! The plant's electronics: its sensors and its output stage, with their faults.
//!
//! ```text
//!   vehicle -> Instruments (sensor faults) -> frames
//!   frames -> OutputStage (end-to-end check, watchdog, stuck valves) -> switching signals -> vehicle
//! ```

use oleo_controller::can::{COMMAND, CheckStatus, CommandMessage};
use oleo_controller::{Inputs, ValveCommand};
use oleo_interface::{Corners, Gauge, StrutPressures};
use oleo_plant_sim::strut::StrutOutput;

use crate::scenario::fault::{Fault, FaultKind, Sensor, SensorFault, SensorPlace, ValvePlace};

/// Number of ticks without a usable command after which the output stage de-energises all valves. It is the time-out of the
/// command's contract.
pub const WATCHDOG_TICKS: u32 = COMMAND.timeout_ticks as u32;

/// The four displacement sensors and sixteen pressure sensors.
#[derive(Clone, Debug)]
pub struct Instruments {
    faults: Vec<(Fault, SensorPlace, SensorFault, Option<f32>)>,
}

impl Instruments {
    /// Sensors that have the sensor faults among `faults`.
    pub fn new(faults: &[Fault]) -> Self {
        let of_sensors = |fault: &Fault| match fault.kind {
            FaultKind::Sensor { place, fault: kind } => Some((*fault, place, kind, None)),
            _ => None,
        };
        Self {
            faults: faults.iter().filter_map(of_sensors).collect(),
        }
    }

    /// What the sensors say in a tick, from the true displacements (m, compression positive) and pressures.
    pub fn read(&mut self, tick: u32, displacement_m: Corners<f64>, struts: Corners<StrutOutput>) -> Inputs {
        let mut displacement_m = displacement_m.map(|x| x as f32);
        let mut pressure_pa = struts.map(|strut| StrutPressures::from_array(strut.pressure_pa.map(|p| p as f32)));
        for (fault, place, kind, held) in &mut self.faults {
            let value = match place.sensor {
                Sensor::Displacement => &mut displacement_m[place.corner],
                Sensor::Pressure(point) => &mut pressure_pa[place.corner][point],
            };
            if !fault.is_active(tick) {
                *held = None;
                continue;
            }
            *value = match *kind {
                SensorFault::Stuck => *held.get_or_insert(*value),
                SensorFault::NotANumber => f32::NAN,
                SensorFault::Value(says) => says,
                SensorFault::Offset(more) => *value + more,
            };
        }
        Inputs::from_values(displacement_m, pressure_pa.map(|strut| strut.map(Gauge)))
    }
}

/// The twelve solenoid drivers, behind a watchdog.
#[derive(Clone, Debug)]
pub struct OutputStage {
    command: ValveCommand,
    age: u32,
    fresh: bool,
    errors: u64,
    stuck: Vec<(Fault, ValvePlace, bool)>,
}

impl OutputStage {
    /// A de-energised output stage that has the solenoid faults among `faults`.
    pub fn new(faults: &[Fault]) -> Self {
        let of_solenoids = |fault: &Fault| match fault.kind {
            FaultKind::SolenoidStuck { place, open } => Some((*fault, place, open)),
            _ => None,
        };
        let stuck = faults.iter().filter_map(of_solenoids).collect();
        Self {
            command: ValveCommand::SAFE,
            age: WATCHDOG_TICKS,
            fresh: false,
            errors: 0,
            stuck,
        }
    }

    /// Takes a received command with the outcome of its check.
    pub fn receive(&mut self, status: CheckStatus, message: Option<CommandMessage>) {
        self.errors += u64::from(status.is_error());
        if let Some(message) = message
            && (status.is_usable() || status == CheckStatus::Initial)
        {
            self.command = message.command;
            self.fresh = true;
        }
    }

    /// Ends the reception of a tick; returns whether a usable command came.
    pub fn end_of_tick(&mut self) -> bool {
        if std::mem::take(&mut self.fresh) {
            self.age = 0;
            return true;
        }
        self.age = self.age.saturating_add(1);
        if self.age >= WATCHDOG_TICKS {
            self.command = ValveCommand::SAFE;
        }
        false
    }

    /// The command that the drivers obey.
    pub fn command(&self) -> ValveCommand {
        self.command
    }

    /// Positions of the valves' signals, stuck valves included.
    pub fn energised(&self, tick: u32) -> ValveCommand {
        let active = self.stuck.iter().filter(|(fault, ..)| fault.is_active(tick));
        active.fold(self.command, |word, (_, place, open)| {
            word.with(place.corner, place.valve, *open)
        })
    }

    /// Number of ticks since the last usable command.
    pub fn ticks_without_command(&self) -> u32 {
        self.age
    }

    /// Number of commands that failed their end-to-end check.
    pub fn errors(&self) -> u64 {
        self.errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::{Corner, PressurePoint, Valve};

    fn fault(kind: FaultKind) -> Fault {
        Fault {
            kind,
            from_tick: 2,
            until_tick: 4,
        }
    }

    const PLACE: Corner = Corner::FrontRight;

    fn sensor(kind: SensorFault, sensor: Sensor) -> Instruments {
        Instruments::new(&[fault(FaultKind::Sensor {
            place: SensorPlace { corner: PLACE, sensor },
            fault: kind,
        })])
    }

    fn read(instruments: &mut Instruments, tick: u32) -> Inputs {
        let mut struts = Corners::splat(StrutOutput::default());
        struts[PLACE].pressure_pa = [4e6 + f64::from(tick) * 1e5; 4];
        instruments.read(tick, Corners::splat(f64::from(tick) * 0.01), struts)
    }

    #[test]
    fn each_sensor_fault_within_its_interval_and_place() {
        let mut stuck = sensor(SensorFault::Stuck, Sensor::Displacement);
        let seen: Vec<_> = (0..6)
            .map(|tick| read(&mut stuck, tick).displacement[PLACE].value().unwrap())
            .collect();
        assert_eq!(seen, [0.0, 0.01, 0.02, 0.02, 0.04, 0.05]);

        let mut broken = sensor(SensorFault::NotANumber, Sensor::Pressure(PressurePoint::P3));
        let inputs = read(&mut broken, 3);
        assert!(!inputs.pressure[PLACE].p3.is_valid());
        assert!(inputs.pressure[PLACE].p2.is_valid() && inputs.pressure[Corner::FrontLeft].p3.is_valid());
        assert!(read(&mut broken, 4).pressure[PLACE].p3.is_valid());

        assert_eq!(
            read(&mut sensor(SensorFault::Offset(0.5), Sensor::Displacement), 2).displacement[PLACE].value(),
            Some(0.52)
        );
        assert_eq!(
            read(
                &mut sensor(SensorFault::Value(9e9), Sensor::Pressure(PressurePoint::P1)),
                2
            )
            .pressure[PLACE]
                .p1
                .value(),
            Some(9e9)
        );
    }

    #[test]
    fn the_watchdog_closes_the_valves() {
        let mut stage = OutputStage::new(&[]);
        let open = CommandMessage {
            command: ValveCommand::SOFT,
            ..CommandMessage::default()
        };
        stage.receive(CheckStatus::Initial, Some(open));
        assert!(stage.end_of_tick());
        for _ in 1..WATCHDOG_TICKS {
            stage.receive(CheckStatus::WrongCrc, None);
            assert!(!stage.end_of_tick());
            assert_eq!(stage.command(), ValveCommand::SOFT);
        }
        stage.receive(CheckStatus::Repeated, Some(open));
        assert!(!stage.end_of_tick());
        assert_eq!(stage.command(), ValveCommand::SAFE);
        assert_eq!(stage.errors(), u64::from(WATCHDOG_TICKS));
    }

    #[test]
    fn a_stuck_valve_does_not_follow() {
        let place = ValvePlace {
            corner: Corner::FrontLeft,
            valve: Valve::Spring,
        };
        let stage = OutputStage::new(&[fault(FaultKind::SolenoidStuck { place, open: true })]);
        assert_eq!(stage.energised(1).word(), 0);
        assert_eq!(stage.energised(2).word(), 0b100);
        assert_eq!(stage.command().word(), 0);
    }
}
