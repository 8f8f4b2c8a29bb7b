//! A vehicle that costs a hundred instructions a tick: its body is moved, and pressures follow from the oil that each strut has displaced,
//! by the report's isothermal gas law. Valve 3 follows its command after 65 ms.
//!
//! It shares no equation with the controller: volumes are tracked here, and pressures computed from them.

use oleo_controller::{Absolute, Corner, Corners, Gauge, Inputs, Side, StrutPressures, Valve, ValveCommand};

const AREA_M2: f32 = 1.963_495_4e-3;
const VOLUME_M3: [f32; 2] = [1.0e-4, 4.0e-4];
/// Gas pressure at the static position, Pa absolute.
const CHARGE_PA: f32 = 2.1e6;
/// Highest pressure, Pa absolute: the strut is at its stop.
const STOP_PA: f32 = 30.0e6;
/// Pressure drop across damper 1 with valve 1 closed and open, Pa per m/s.
const DAMPING_PA_S_M: [f32; 2] = [2.0e6, 0.2e6];
/// Time after which valve 3 has followed its command, ticks.
const RESPONSE_TICKS: u8 = 13;
const TICK_S: f32 = 0.005;

/// One strut.
#[derive(Clone, Copy, Debug)]
struct Strut {
    displacement_m: f32,
    /// Gas in accumulator 2, m3.
    gas2_m3: f32,
    open: bool,
    /// Ticks for which valve 3 has been commanded elsewhere.
    waiting: u8,
}

/// Body, struts and road.
#[derive(Clone, Debug)]
pub struct Vehicle {
    struts: Corners<Strut>,
    road_m: f32,
    lean_m: f32,
}

impl Vehicle {
    /// At rest, on a road of some amplitude, in bends that lean the body so far, m.
    pub fn new(road_m: f32, lean_m: f32) -> Self {
        Self {
            struts: Corners::splat(Strut {
                displacement_m: 0.0,
                gas2_m3: VOLUME_M3[1],
                open: false,
                waiting: 0,
            }),
            road_m,
            lean_m,
        }
    }

    /// One tick under a command; returns what healthy sensors say. `stuck` holds valve 3 of a corner open or closed.
    pub fn step(&mut self, tick: u32, command: ValveCommand, stuck: Corners<Option<bool>>) -> Inputs {
        let lean_m = self.lean_m * sine(0.21, 0.0, tick);
        let mut pressure = Corners::splat(StrutPressures::default());
        for (corner, strut) in self.struts.iter_mut() {
            let side = if corner.side() == Side::Left { 1.0 } else { -1.0 };
            let displacement_m = self.road_m * road(corner, tick) + side * lean_m;
            let speed_m_s = (displacement_m - strut.displacement_m) / TICK_S;
            strut.displacement_m = displacement_m;
            strut.follow(command.is_open(corner, Valve::Spring), stuck[corner]);
            let valve1 = usize::from(command.is_open(corner, Valve::Bypass1));
            pressure[corner] = strut.pressures(DAMPING_PA_S_M[valve1] * speed_m_s);
        }
        Inputs::from_values(self.struts.map(|strut| strut.displacement_m), pressure)
    }
}

impl Strut {
    fn follow(&mut self, command: bool, stuck: Option<bool>) {
        self.waiting = if command == self.open { 0 } else { self.waiting + 1 };
        if self.waiting >= RESPONSE_TICKS {
            self.open = command;
            self.waiting = 0;
        }
        self.open = stuck.unwrap_or(self.open);
    }

    fn pressures(&mut self, drop_pa: f32) -> StrutPressures<Gauge<f32>> {
        let [v1, v2] = VOLUME_M3;
        let gas_m3 = v1 + v2 - AREA_M2 * self.displacement_m;
        let (p2, p4) = if self.open {
            let p = CHARGE_PA * (v1 + v2) / gas_m3;
            self.gas2_m3 = CHARGE_PA * v2 / p;
            (p, p)
        } else {
            let gas1_m3 = (gas_m3 - self.gas2_m3).max(1.0e-6);
            (CHARGE_PA * v1 / gas1_m3, CHARGE_PA * v2 / self.gas2_m3)
        };
        let p2 = p2.min(STOP_PA);
        let p1 = (p2 + drop_pa).clamp(0.0, STOP_PA);
        StrutPressures { p1, p2, p3: p2, p4 }.map(|p| Absolute(p).gauge())
    }
}

/// The road under a corner over its amplitude: the body at 1.3 Hz, the wheels about 7 Hz, the rear axle after the front one.
fn road(corner: Corner, tick: u32) -> f32 {
    let (phase, wheel_hz) = match corner {
        Corner::FrontLeft => (0.0, 7.1),
        Corner::FrontRight => (0.4, 6.7),
        Corner::RearLeft => (1.9, 7.9),
        Corner::RearRight => (2.3, 8.3),
    };
    0.75 * sine(1.3, phase, tick) + 0.25 * sine(wheel_hz, 3.0 * phase, tick)
}

fn sine(frequency_hz: f32, phase: f32, tick: u32) -> f32 {
    let turns = (f64::from(frequency_hz) * f64::from(tick) * f64::from(TICK_S)).fract() as f32;
    libm::sinf(core::f32::consts::TAU * turns + phase)
}
