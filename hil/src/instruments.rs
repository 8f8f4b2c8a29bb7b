//! The electronics of the plant with their faults: sensors, and valves that do not follow.
//!
//! ```text
//!   vehicle -> Instruments (sensor faults) -> frames
//!   frames -> oleo_controller::OutputStage (what may be obeyed) -> StuckValves -> switching signals -> vehicle
//! ```

use oleo_controller::{Inputs, ValveCommand};
use oleo_interface::{Corners, Gauge, StrutPressures};
use oleo_plant_sim::strut::StrutOutput;

use crate::scenario::fault::{Fault, FaultKind, Sensor, SensorFault, SensorPlace, ValvePlace};

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

/// Valves that do not follow their signals.
#[derive(Clone, Debug)]
pub struct StuckValves {
    stuck: Vec<(Fault, ValvePlace, bool)>,
}

impl StuckValves {
    /// The solenoid faults among `faults`.
    pub fn new(faults: &[Fault]) -> Self {
        let of_solenoids = |fault: &Fault| match fault.kind {
            FaultKind::SolenoidStuck { place, open } => Some((*fault, place, open)),
            _ => None,
        };
        Self {
            stuck: faults.iter().filter_map(of_solenoids).collect(),
        }
    }

    /// Positions of the valves' signals under a command, stuck valves included.
    pub fn energised(&self, tick: u32, command: ValveCommand) -> ValveCommand {
        let active = self.stuck.iter().filter(|(fault, ..)| fault.is_active(tick));
        active.fold(command, |word, (_, place, open)| {
            word.with(place.corner, place.valve, *open)
        })
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
    fn a_stuck_valve_does_not_follow() {
        let place = ValvePlace {
            corner: Corner::FrontLeft,
            valve: Valve::Spring,
        };
        let stuck = StuckValves::new(&[fault(FaultKind::SolenoidStuck { place, open: true })]);
        assert_eq!(stuck.energised(1, ValveCommand::SAFE).word(), 0);
        assert_eq!(stuck.energised(2, ValveCommand::SAFE).word(), 0b100);
    }
}
