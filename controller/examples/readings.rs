//! The controller without a bus: made-up readings in, valve positions out.
//!
//! `cargo run -p oleo-controller --example readings` drives a vehicle for 15 s over a rough road, through a bend, and on with a
//! broken displacement sensor. It prints a line whenever mode, setting or springs change.

use oleo_controller::interface::tick::{TICK_S_F32, TICKS_PER_SECOND};
use oleo_controller::{
    Absolute, Configuration, Corner, Corners, Gauge, Inputs, Outputs, Reading, Side, State, StrutPressures, Valve,
    ValveCommand, tick,
};

const PISTON_AREA_M2: f32 = 1.963_495_4e-3;
/// Gas pressure of a strut at its static position.
const CHARGE: Absolute<f32> = Absolute(2.1e6);
const GAS_VOLUME_1_M3: f32 = 1.0e-4;
const GAS_VOLUME_2_M3: f32 = 4.0e-4;

/// A strut without dampers: its pressures follow from displacement and gas volumes by Boyle's law.
#[derive(Clone, Copy)]
struct Strut {
    /// Gas in accumulator 2, m3; it cannot change while valve 3 is closed.
    gas_2_m3: f32,
}

impl Strut {
    fn pressures(&mut self, displacement_m: f32, spring_open: bool) -> StrutPressures<Gauge<f32>> {
        let gas_m3 = GAS_VOLUME_1_M3 + GAS_VOLUME_2_M3 - PISTON_AREA_M2 * displacement_m;
        if spring_open {
            self.gas_2_m3 = gas_m3 * GAS_VOLUME_2_M3 / (GAS_VOLUME_1_M3 + GAS_VOLUME_2_M3);
        }
        let main = Absolute(CHARGE.pa() * GAS_VOLUME_1_M3 / (gas_m3 - self.gas_2_m3));
        let behind_valve_3 = Absolute(CHARGE.pa() * GAS_VOLUME_2_M3 / self.gas_2_m3);
        StrutPressures {
            p4: behind_valve_3.gauge(),
            ..StrutPressures::splat(main.gauge())
        }
    }
}

/// What the sensors say at a time, the valves being where the last command put them.
fn readings(time_s: f32, struts: &mut Corners<Strut>, command: ValveCommand) -> Inputs {
    let wave = |hz: f32, phase: f32| libm::sinf(6.283_185_5 * hz * time_s + phase);
    let bend = if (6.0..10.0).contains(&time_s) { 1.0 } else { 0.0 };
    let road_m = Corners::from_fn(|corner| {
        let phase = corner.index() as f32;
        (1.0 - bend) * (0.004 * wave(1.3, phase) + 0.002 * wave(7.1, 2.0 * phase))
    });
    // In a left bend the body leans to the right.
    let lean_m = |corner: Corner| bend * if corner.side() == Side::Right { 0.008 } else { -0.008 };
    let displacement_m = Corners::from_fn(|corner| road_m[corner] + lean_m(corner));
    let pressure = Corners::from_fn(|corner| {
        let spring_open = command.is_open(corner, Valve::Spring);
        let mut pressure = struts[corner].pressures(displacement_m[corner], spring_open);
        // The load that the tyres' side force shifts from left to right.
        pressure.p1 = pressure.p1 + 5.0e7 * lean_m(corner);
        pressure
    });
    let mut inputs = Inputs::from_values(displacement_m, pressure);
    if time_s > 12.0 {
        inputs.displacement[Corner::FrontLeft] = Reading::INVALID;
    }
    inputs
}

/// What is printed of a tick.
fn summary(outputs: &Outputs) -> String {
    let springs = outputs
        .command
        .corners()
        .map(|strut| if strut[Valve::Spring] { "soft" } else { "stiff" });
    format!(
        "{:<9} {:<13} {:<9} springs {}",
        outputs.mode.name(),
        outputs.fault.name(),
        if outputs.handling { "handling" } else { "ride" },
        springs.into_array().join(", ")
    )
}

fn main() {
    let configuration = Configuration::defender110();
    let mut state = State::new();
    let mut struts = Corners::splat(Strut {
        gas_2_m3: GAS_VOLUME_2_M3,
    });
    let mut command = ValveCommand::SAFE;
    let mut before = String::new();
    println!("time, s  mode      first cause   strategy  front left, front right, rear left, rear right");
    for number in 0..15 * TICKS_PER_SECOND {
        let time_s = number as f32 * TICK_S_F32;
        let inputs = readings(time_s, &mut struts, command);
        let outputs = tick(&configuration, &mut state, &inputs);
        command = outputs.command;
        let now = summary(&outputs);
        if now != before {
            println!("{time_s:7.3}  {now}");
            before = now;
        }
    }
}
