//! A vehicle for tests: struts whose pressures follow from displacement, load and valves by the report's isothermal gas law, and a bus to the controller
//! on which frames can be tampered with.
//!
//! Independent of the controller's own equations on purpose: volumes are tracked, not pressures.

#![allow(dead_code, reason = "each test binary uses its part")]

use oleo_controller::can::{CommandMessage, Frame};
use oleo_controller::{
    Absolute, Configuration, Corners, Gauge, Inputs, Node, Outputs, PlantEnd, StrutPressures, Valve, ValveCommand,
};

pub const AREA_M2: f32 = 1.963_495_4e-3;
pub const STATIC_PA: f32 = 2.0e6;
const ATMOSPHERE_PA: f32 = 101_325.0;
/// What the pack of damper 1 takes while its bypass is closed, Pa for each m/s of the strut (report: 3 MPa in jounce, 6 in rebound).
const PACK_PA_S_M: f32 = 4.0e6;
const VOLUME_M3: [f32; 2] = [1.0e-4, 4.0e-4];

/// One strut without damping: quasi-static, isothermal, valves without delay.
#[derive(Clone, Copy, Debug)]
pub struct QuietStrut {
    pub charge_pa: f32,
    gas2_m3: f32,
}

impl Default for QuietStrut {
    fn default() -> Self {
        Self {
            charge_pa: STATIC_PA + ATMOSPHERE_PA,
            gas2_m3: VOLUME_M3[1],
        }
    }
}

impl QuietStrut {
    /// Displacement at which the strut carries its static load while valve 3 is closed: oil behind the valve lowers it.
    pub fn rest_m(&self) -> f32 {
        (VOLUME_M3[1] - self.gas2_m3) / AREA_M2
    }

    /// Gauge pressures p1 to p4 at a displacement, compression positive.
    pub fn pressures(&mut self, displacement_m: f32, spring_open: bool) -> StrutPressures<Gauge<f32>> {
        let oil_m3 = AREA_M2 * displacement_m;
        let [v1, v2] = VOLUME_M3;
        let (p1, p4) = if spring_open {
            let p = self.charge_pa * (v1 + v2) / (v1 + v2 - oil_m3);
            self.gas2_m3 = self.charge_pa * v2 / p;
            (p, p)
        } else {
            let gas1_m3 = (v1 + v2 - oil_m3 - self.gas2_m3).max(1e-6);
            (self.charge_pa * v1 / gas1_m3, self.charge_pa * v2 / self.gas2_m3)
        };
        StrutPressures {
            p4,
            ..StrutPressures::splat(p1)
        }
        .map(|p| Absolute(p).gauge())
    }
}

/// Displacements in metres as a function of the tick: several incommensurate sines, so that everything moves.
pub fn rough_road(tick: u32) -> Corners<f32> {
    let t = tick as f32 * 0.005;
    let sine = |hz: f32, phase: f32| libm::sinf(6.283_185_5 * hz * t + phase);
    Corners::from_array([
        0.012 * sine(1.3, 0.0) + 0.004 * sine(7.1, 0.3),
        0.012 * sine(1.3, 0.4) + 0.004 * sine(6.7, 1.1),
        0.011 * sine(1.3, 1.9) + 0.004 * sine(7.9, 0.2),
        0.011 * sine(1.3, 2.3) + 0.004 * sine(8.3, 2.0),
    ])
}

/// Controller and test vehicle with a bus between.
pub struct Loop {
    pub node: Node,
    pub plant: PlantEnd,
    pub struts: Corners<QuietStrut>,
    displacement_m: Corners<f32>,
    pub tick: u32,
    pub command: ValveCommand,
    pub answer: Option<CommandMessage>,
}

impl Loop {
    pub fn new(configuration: Configuration) -> Self {
        Self {
            node: Node::new(configuration),
            plant: PlantEnd::new(),
            struts: Corners::splat(QuietStrut::default()),
            displacement_m: Corners::splat(0.0),
            tick: 0,
            command: ValveCommand::SAFE,
            answer: None,
        }
    }

    /// What the sensors say at present displacements.
    pub fn sensors(&mut self, displacement_m: Corners<f32>) -> Inputs {
        let pressure = Corners::from_fn(|corner| {
            let x = displacement_m[corner];
            let open = self.command.is_open(corner, Valve::Spring);
            let mut pressure = self.struts[corner].pressures(x, open);
            if !self.command.is_open(corner, Valve::Bypass1) {
                pressure.p1 = pressure.p1 + PACK_PA_S_M * (x - self.displacement_m[corner]) / 0.005;
            }
            pressure
        });
        self.displacement_m = displacement_m;
        Inputs::from_values(displacement_m, pressure)
    }

    /// One tick on which `tamper` may change readings and frames.
    pub fn step(
        &mut self,
        displacement_m: Corners<f32>,
        tamper_inputs: impl FnOnce(&mut Inputs),
        tamper_frames: impl FnOnce(&mut Vec<Frame>),
    ) -> Outputs {
        let mut inputs = self.sensors(displacement_m);
        tamper_inputs(&mut inputs);
        let mut frames = self.plant.encode(self.tick as u16, &inputs).to_vec();
        tamper_frames(&mut frames);
        for frame in frames {
            self.node.receive(frame.id, &frame.data);
        }
        let (outputs, sent) = self.node.tick();
        self.answer = None;
        for frame in sent {
            if self.plant.receive(frame.id, &frame.data).is_some() {
                self.answer = CommandMessage::decode(&frame.data);
            }
        }
        self.command = self.plant.end_of_tick();
        self.tick += 1;
        outputs
    }

    /// Undisturbed ticks on the rough road.
    pub fn run(&mut self, ticks: u32) -> Outputs {
        let mut outputs = Outputs::default();
        for _ in 0..ticks {
            outputs = self.step(rough_road(self.tick), |_| {}, |_| {});
        }
        outputs
    }
}
