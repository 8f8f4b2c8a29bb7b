//! A synthetic drive: sensor readings for each tick that are bit-identical on every machine.
//!
//! It is not a model of a vehicle, which would need f64 and std, but it gives each part of the controller work: four struts on a
//! rough road, a slalom on a smooth one, sensor noise, and at the end readings that are missing or wrong; the last
//! of these come as storms that hit all readings at once. The gas follows the struts' valves by the report's isothermal law. It uses only integer arithmetic and +, -, *, / of f32, which have the same bits
//! everywhere.

use oleo_controller::{Absolute, Corner, Corners, Gauge, Inputs, Reading, Side, StrutPressures, Valve, ValveCommand};

/// Ticks until the drive ends: 20 s.
pub const TICKS: u16 = 4_000;

/// From here on, a storm of faults that comes and goes: each reading is missing, out of range or far from the last one in one
/// of four ticks.
const STORM: core::ops::Range<u16> = 3_000..4_000;
const STORM_PERIOD: u16 = 250;
/// Ticks of each period in which the storm rages.
const STORM_TICKS: u16 = 40;

/// From here on slalom, 4 s a period.
const SLALOM: core::ops::Range<u16> = 1_000..2_200;
const SLALOM_PERIOD: u16 = 800;

/// The report's strut: bore 50 mm, 0.1 l and 0.4 l of gas at the static position.
const PISTON_AREA_M2: f32 = 1.963_495_4e-3;
const GAS_1_M3: f32 = 1.0e-4;
const GAS_2_M3: f32 = 4.0e-4;
const STATIC_PA: f32 = 2.0e6;
/// What the pack of damper 1 takes while its bypass is closed, Pa for each metre of the strut in a tick.
const PACK_PA_M: f32 = 4.0e6 / 0.005;

/// The generator of the drive.
pub struct Drive {
    tick: u16,
    random: u32,
    /// Gas in the second accumulators, m3; kept while valve 3 is closed.
    gas_2_m3: Corners<f32>,
    /// What the road did in the last tick, m.
    road_m: Corners<f32>,
}

impl Drive {
    /// A drive from its start. All drives are the same.
    pub fn new() -> Self {
        Drive {
            tick: 0,
            random: 0x2545_F491,
            gas_2_m3: Corners::splat(GAS_2_M3),
            road_m: Corners::default(),
        }
    }

    /// The number of the coming tick.
    pub fn tick(&self) -> u16 {
        self.tick
    }

    /// What the sensors say in the coming tick, the valves being where the last command put them.
    pub fn inputs(&mut self, command: ValveCommand) -> Inputs {
        let tick = self.tick;
        self.tick = tick.wrapping_add(1);
        let slalom = SLALOM.contains(&tick);
        let lateral = if slalom { triangle(tick, SLALOM_PERIOD) } else { 0.0 };
        let mut displacement_m = Corners::<f32>::default();
        let mut pressure = Corners::<StrutPressures<Gauge<f32>>>::default();
        for corner in Corner::ALL {
            let side = if corner.side() == Side::Left { -1.0 } else { 1.0 };
            let number = corner.index() as u16;
            let phase = tick + 37 * number;
            let body = triangle(phase, 154);
            let wheel = triangle(phase, 25 + 2 * number);
            let road_m = if slalom {
                0.0005 * body
            } else {
                0.012 * body + 0.004 * wheel
            };
            let x = road_m + 0.006 * side * lateral + 1.0e-5 * self.noise();
            displacement_m[corner] = x;
            let mut p = self.pressures(corner, x, command.is_open(corner, Valve::Spring));
            if !command.is_open(corner, Valve::Bypass1) {
                p.p1 = p.p1 + PACK_PA_M * (road_m - self.road_m[corner]);
            }
            self.road_m[corner] = road_m;
            // The lines' share, and what the tyres' side force shifts from left to right.
            p.p1 = p.p1 + (0.06e6 * triangle(phase + 38, 154) + 0.75e6 * side * lateral);
            pressure[corner] = p.map(|p| p + 5.0e3 * self.noise());
        }
        let mut inputs = Inputs::from_values(displacement_m, pressure);
        match tick {
            // A reading that comes and goes; a broken wire; a pressure that no strut can have.
            2_300..2_320 if tick.is_multiple_of(3) => inputs.displacement[Corner::FrontRight] = Reading::INVALID,
            2_500..2_510 => inputs.pressure[Corner::RearLeft].p1 = Reading::new(f32::NAN),
            2_800..3_000 => inputs.pressure[Corner::RearRight].p2 = Reading::new(9.0e7),
            _ => {}
        }
        if STORM.contains(&tick) && tick % STORM_PERIOD < STORM_TICKS {
            for corner in Corner::ALL {
                self.damage(&mut inputs.displacement[corner], 0.2);
                for reading in inputs.pressure[corner].each_mut().into_array() {
                    self.damage(reading, 30.0e6);
                }
            }
        }
        inputs
    }

    /// Makes one of four readings wrong, in one of three ways.
    fn damage(&mut self, reading: &mut Reading, far: f32) {
        let kind = self.noise();
        *reading = match kind {
            -1.0..-0.8 => Reading::INVALID,
            -0.8..-0.7 => Reading::new(far),
            -0.7..-0.5 => Reading::new(10.0 * far),
            _ => return,
        };
    }

    /// Pressures of a strut without damping.
    fn pressures(&mut self, corner: Corner, displacement_m: f32, spring_open: bool) -> StrutPressures<Gauge<f32>> {
        let charge_pa = Gauge(STATIC_PA).absolute().pa();
        let gas_m3 = GAS_1_M3 + GAS_2_M3 - PISTON_AREA_M2 * displacement_m;
        let gas_2_m3 = &mut self.gas_2_m3[corner];
        if spring_open {
            *gas_2_m3 = gas_m3 * GAS_2_M3 / (GAS_1_M3 + GAS_2_M3);
        }
        let p1 = charge_pa * GAS_1_M3 / (gas_m3 - *gas_2_m3);
        let p4 = charge_pa * GAS_2_M3 / *gas_2_m3;
        StrutPressures {
            p4,
            ..StrutPressures::splat(p1)
        }
        .map(|p| Absolute(p).gauge())
    }

    /// White, -1..1 (xorshift32, Marsaglia 2003). A generator of a crate would change the golden hash of the valve words.
    fn noise(&mut self) -> f32 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 17;
        self.random ^= self.random << 5;
        (self.random >> 8) as f32 / 8_388_608.0 - 1.0
    }
}

/// A triangle wave of the given period in ticks, -1..1.
fn triangle(tick: u16, period: u16) -> f32 {
    let phase = f32::from(tick % period) / f32::from(period);
    if phase < 0.5 {
        4.0 * phase - 1.0
    } else {
        3.0 - 4.0 * phase
    }
}
