//! The electronics of the plant with their faults: sensors, and valves that do not follow.
//!
//! ```text
//!   vehicle -> Instruments (sensor faults) -> frames
//!   frames -> oleo_controller::OutputStage (what may be obeyed) -> StuckValves -> switching signals -> vehicle
//! ```

use oleo_controller::{Inputs, ValveCommand};
use oleo_interface::tick::TICK_S;
use oleo_interface::{Corners, Gauge, StrutPressures};
use oleo_plant_sim::strut::StrutOutput;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::scenario::fault::{Fault, FaultKind, Sensor, SensorFault, SensorPlace, ValvePlace};

/// The four displacement sensors and sixteen pressure sensors.
#[derive(Clone, Debug)]
pub struct Instruments {
    faults: Vec<Broken>,
}

/// A sensor fault and what it remembers.
#[derive(Clone, Debug)]
struct Broken {
    fault: Fault,
    /// The last value, of a sensor that is stuck.
    held: Option<f32>,
    /// Random numbers of this fault alone.
    random: ChaCha8Rng,
}

/// Random streams of sensor faults begin here; those of disturbed frames are counted from 0.
const FIRST_STREAM: u64 = 1 << 32;

/// Readings of all sensors.
struct Readings {
    displacement_m: Corners<f32>,
    pressure_pa: Corners<StrutPressures<f32>>,
}

impl Readings {
    fn at(&mut self, place: SensorPlace) -> &mut f32 {
        match place.sensor {
            Sensor::Displacement => &mut self.displacement_m[place.corner],
            Sensor::Pressure(point) => &mut self.pressure_pa[place.corner][point],
        }
    }
}

impl Instruments {
    /// Sensors that have the sensor faults among `faults`; `seed` fixes their noise.
    pub fn new(faults: &[Fault], seed: u64) -> Self {
        let broken = |(index, fault): (usize, &Fault)| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream(FIRST_STREAM + index as u64);
            Broken {
                fault: *fault,
                held: None,
                random,
            }
        };
        let of_sensors =
            |fault: &Fault| matches!(fault.kind, FaultKind::Sensor { .. } | FaultKind::SensorsSwapped { .. });
        let numbered = faults.iter().filter(|fault| of_sensors(fault)).enumerate();
        Self {
            faults: numbered.map(broken).collect(),
        }
    }

    /// What the sensors say in a tick, from the true displacements (m, compression positive) and pressures.
    pub fn read(&mut self, tick: u32, displacement_m: Corners<f64>, struts: Corners<StrutOutput>) -> Inputs {
        let mut readings = Readings {
            displacement_m: displacement_m.map(|x| x as f32),
            pressure_pa: struts.map(|strut| StrutPressures::from_array(strut.pressure_pa.map(|p| p as f32))),
        };
        for broken in &mut self.faults {
            broken.spoil(tick, &mut readings);
        }
        let pressure = readings.pressure_pa.map(|strut| strut.map(Gauge));
        Inputs::from_values(readings.displacement_m, pressure)
    }
}

impl Broken {
    fn spoil(&mut self, tick: u32, readings: &mut Readings) {
        if !self.fault.is_active(tick) {
            self.held = None;
            return;
        }
        match self.fault.kind {
            FaultKind::Sensor { place, fault } => {
                let value = readings.at(place);
                *value = match fault {
                    SensorFault::Stuck => *self.held.get_or_insert(*value),
                    SensorFault::NotANumber => f32::NAN,
                    SensorFault::Value(says) => says,
                    SensorFault::Offset(more) => *value + more,
                    SensorFault::Gain(factor) => *value * factor,
                    SensorFault::Noise(deviation) => {
                        let standard: f32 = StandardNormal.sample(&mut self.random);
                        *value + deviation * standard
                    }
                    SensorFault::Drift(a_second) => {
                        let since_s = f64::from(tick - self.fault.from_tick) * TICK_S;
                        *value + a_second * since_s as f32
                    }
                };
            }
            FaultKind::SensorsSwapped { one, other } => {
                let said = (*readings.at(one), *readings.at(other));
                (*readings.at(other), *readings.at(one)) = said;
            }
            _ => {}
        }
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
        let place = SensorPlace { corner: PLACE, sensor };
        Instruments::new(&[fault(FaultKind::Sensor { place, fault: kind })], 1)
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
            read(&mut sensor(SensorFault::Gain(2.0), Sensor::Displacement), 2).displacement[PLACE].value(),
            Some(0.04)
        );
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
    fn a_drift_grows_from_the_begin_of_its_fault() {
        let mut drifting = sensor(SensorFault::Drift(1.0), Sensor::Displacement);
        let seen: Vec<_> = (1..5)
            .map(|tick| read(&mut drifting, tick).displacement[PLACE].value().unwrap())
            .collect();
        for (seen, expected) in seen.into_iter().zip([0.01, 0.02, 0.03 + 0.005, 0.04]) {
            assert!((seen - expected).abs() < 1e-6, "{seen} {expected}");
        }
    }

    /// Mean and standard deviation of many readings, and the same readings again from the same seed.
    #[test]
    fn noise_has_its_standard_deviation() {
        let place = SensorPlace {
            corner: PLACE,
            sensor: Sensor::Displacement,
        };
        let noisy = Fault {
            kind: FaultKind::Sensor {
                place,
                fault: SensorFault::Noise(0.002),
            },
            from_tick: 0,
            until_tick: 20_000,
        };
        let readings = |seed| -> Vec<f64> {
            let mut instruments = Instruments::new(&[noisy], seed);
            let mut say = |tick| instruments.read(tick, Corners::splat(0.01), Corners::default());
            (0..20_000)
                .map(|tick| f64::from(say(tick).displacement[PLACE].value().unwrap()) - 0.01)
                .collect()
        };
        let one = readings(1);
        let mean = one.iter().sum::<f64>() / 20_000.0;
        let deviation = (one.iter().map(|x| x * x).sum::<f64>() / 20_000.0).sqrt();
        assert!(
            mean.abs() < 6e-5 && (deviation / 0.002 - 1.0).abs() < 0.02,
            "{mean} {deviation}"
        );
        assert!(one == readings(1) && one != readings(2));
    }

    #[test]
    fn swapped_sensors_say_what_the_other_one_should() {
        let at = |corner| SensorPlace {
            corner,
            sensor: Sensor::Displacement,
        };
        let (one, other) = (at(Corner::FrontLeft), at(Corner::RearRight));
        let mut swapped = Instruments::new(&[fault(FaultKind::SensorsSwapped { one, other })], 1);
        let true_m = Corners::from_array([0.01, 0.02, 0.03, 0.04]);
        let mut say = |tick| {
            let inputs = swapped.read(tick, true_m, Corners::default());
            inputs.displacement.map(|reading| reading.value().unwrap()).into_array()
        };
        assert_eq!(say(1), [0.01, 0.02, 0.03, 0.04]);
        assert_eq!(say(2), [0.04, 0.02, 0.03, 0.01]);
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
