//! A synthetic drive, the same to the bit on every machine: what the sensors say, tick by tick.
//!
//! Not a vehicle (that is plant-sim's, and needs f64 and std) but its shape: four struts moving on a rough road, a roll
//! that comes and goes so that ride and handling both get their turn, noise, and now and then a reading that is missing
//! or wrong. Only integer arithmetic and +, -, *, / of f32, which have the same bits everywhere.

use oleo_controller::{Inputs, Reading};

/// Ticks until the drive ends: 10 s.
pub const TICKS: u16 = 2_000;

const STATIC_PRESSURE_PA: f32 = 4.0e6;
/// Travel over which the pressure doubles, m (gas volume over piston area, of the size of the struts').
const GAS_LENGTH_M: f32 = 0.2;

/// The generator of the drive.
pub struct Drive {
    tick: u16,
    random: u32,
}

impl Drive {
    /// From the start; always the same.
    pub fn new() -> Self {
        Drive {
            tick: 0,
            random: 0x2545_F491,
        }
    }

    /// The number of the coming tick.
    pub fn tick(&self) -> u16 {
        self.tick
    }

    /// What the sensors say in the coming tick.
    pub fn inputs(&mut self) -> Inputs {
        let tick = self.tick;
        self.tick = tick.wrapping_add(1);
        // Half the time a slalom of 2 s period and 30 mm, on a road of two periods that differ from corner to corner.
        let roll_m = if tick % 1000 < 500 {
            0.0
        } else {
            0.03 * triangle(tick, 400)
        };
        let mut displacement_m = [0.0; 4];
        let mut pressure_pa = [[0.0; 4]; 4];
        for (corner, (x, p)) in (0_u16..).zip(displacement_m.iter_mut().zip(&mut pressure_pa)) {
            let side = if corner % 2 == 0 { 1.0 } else { -1.0 };
            let road_m = 0.03 * triangle(tick + 37 * corner, 200 + 7 * corner) + 0.01 * triangle(tick, 19 + 2 * corner);
            *x = road_m + side * roll_m + 0.0003 * self.noise();
            let spring_pa = STATIC_PRESSURE_PA * GAS_LENGTH_M / (GAS_LENGTH_M - *x);
            let damper_pa = 4.0e5 * triangle(tick + 50, 19 + 2 * corner);
            *p = [spring_pa + damper_pa, spring_pa, spring_pa + 0.5 * damper_pa, spring_pa];
            for place in p {
                *place += 5.0e3 * self.noise();
            }
        }
        let mut inputs = Inputs::from_values(displacement_m, pressure_pa);
        match tick {
            // A reading that comes and goes; a broken wire; a pressure no strut can have.
            600..620 if tick % 3 == 0 => inputs.displacement[1] = Reading::INVALID,
            1200..1210 => inputs.pressure[2][0] = Reading::new(f32::NAN),
            1800.. => inputs.pressure[3][1] = Reading::new(9.0e7),
            _ => {}
        }
        inputs
    }

    /// White, -1..1 (xorshift32, Marsaglia 2003).
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
