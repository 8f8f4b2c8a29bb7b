//! The state of a strut as data: to go back to a moment, to go on in another process, or to go on with another model.

use oleo_interface::StrutValves;
use serde::{Deserialize, Serialize};

use super::oil_swing::SwingCourse;
use super::{Strut, settled_s};
use crate::model_file::InvalidValue;
use crate::strut::hydraulics::Flowing;
use crate::strut::model::StrutModel;
use crate::strut::network::{LastSolution, State};
use crate::strut::rod_state::Acceleration;
use crate::strut::valve::ValveMotion;

/// Everything that a strut carries from one step to the next. A strut of the same model that is put into this state goes on with the
/// same bits; the start values of the solver belong to it for this reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StrutSnapshot {
    time_s: f64,
    actuator_m: f64,
    speed_m_s: f64,
    acceleration: Acceleration,
    supplied_m: f64,
    state: State,
    last: LastSolution,
    pressure_pa: [f64; 4],
    valves: [ValveMotion; 3],
    friction_n: f64,
    swing: SwingCourse,
    fast_until_s: f64,
}

impl Strut {
    /// The present state.
    ///
    /// ```
    /// use oleo_interface::StrutValves;
    /// use oleo_plant_sim::strut::{Strut, StrutModel};
    /// let (model, closed) = (StrutModel::defender110(8000.0), StrutValves::default());
    /// let mut strut = Strut::at_rest(&model, closed)?;
    /// strut.advance(0.01, 0.05, closed);
    /// let kept = strut.snapshot();
    /// let first = strut.advance(0.02, 0.05, closed);
    /// strut.restore(&kept);
    /// assert_eq!(strut.advance(0.02, 0.05, closed), first);
    /// # Ok::<(), oleo_plant_sim::model_file::InvalidValue>(())
    /// ```
    #[must_use]
    pub fn snapshot(&self) -> StrutSnapshot {
        StrutSnapshot {
            time_s: self.time_s,
            actuator_m: self.actuator_m,
            speed_m_s: self.speed_m_s,
            acceleration: self.acceleration,
            supplied_m: self.flowing.supplied_m,
            state: self.flowing.state,
            last: self.flowing.last,
            pressure_pa: self.flowing.pressure_pa,
            valves: self.valves.into_array(),
            friction_n: self.rod.friction_n(),
            swing: self
                .swing
                .as_ref()
                .map_or_else(SwingCourse::default, |swing| swing.course),
            fast_until_s: self.fast_until_s,
        }
    }

    /// Puts the strut into a state that it, or another strut of the same model, was in.
    pub fn restore(&mut self, kept: &StrutSnapshot) {
        self.time_s = kept.time_s;
        self.actuator_m = kept.actuator_m;
        self.speed_m_s = kept.speed_m_s;
        self.acceleration = kept.acceleration;
        self.flowing = Flowing {
            state: kept.state,
            last: kept.last,
            pressure_pa: kept.pressure_pa,
            supplied_m: kept.supplied_m,
        };
        self.valves = StrutValves::from_array(kept.valves);
        self.settled_s = settled_s(&self.valves);
        self.rod.set_friction_n(kept.friction_n);
        if let Some(swing) = &mut self.swing {
            swing.course = kept.swing;
        }
        self.fast_until_s = kept.fast_until_s;
    }

    /// A strut of another model in the present state of this one: oil, gas, valves and friction stay as they are, and the laws change.
    ///
    /// # Errors
    /// Impossible values in the model.
    pub fn remodelled(&self, model: &StrutModel) -> Result<Self, InvalidValue> {
        let mut strut = Self::at_rest(model, StrutValves::default())?;
        strut.restore(&self.snapshot());
        Ok(strut)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::terms::Effects;

    /// A strut with every term, and with a law over acceleration, which has a state of its own.
    fn with_every_state() -> StrutModel {
        let mut model = StrutModel::defender110(8000.0);
        model.effects = Effects::every_term();
        let over_acceleration: Effects = toml::from_str(
            r#"
            [[unlisted]]
            place = "main-seal"
            depends_on = "acceleration"
            argument = [-10.0, 0.0, 10.0]
            value = [-50.0, 0.0, 50.0]
            "#,
        )
        .unwrap();
        model.effects.unlisted.extend(over_acceleration.unlisted);
        model
    }

    fn drive(strut: &mut Strut, from: u32, to: u32) -> Vec<u64> {
        let mut bits = Vec::new();
        for k in from..to {
            let t = 0.004 * f64::from(k);
            let signals = StrutValves::new(k % 50 < 25, k % 70 < 35, k % 90 < 40);
            let out = strut.advance(0.03 * libm::sin(9.0 * t), 0.004, signals);
            bits.push(out.force_n.to_bits());
            bits.extend(out.pressure_pa.map(f64::to_bits));
        }
        bits
    }

    /// Stops at moments at which valves move, and goes on in a new strut.
    #[test]
    fn a_new_strut_goes_on_with_the_same_bits() {
        let model = with_every_state();
        let mut whole = Strut::at_rest(&model, StrutValves::default()).unwrap();
        let expected = drive(&mut whole, 0, 400);
        for stop in [1, 27, 93, 212] {
            let mut first = Strut::at_rest(&model, StrutValves::default()).unwrap();
            let mut bits = drive(&mut first, 0, stop);
            let mut second = Strut::at_rest_at(&model, StrutValves::splat(true), 0.02).unwrap();
            second.restore(&first.snapshot());
            assert_eq!(second.snapshot(), first.snapshot());
            bits.extend(drive(&mut second, stop, 400));
            assert!(bits == expected, "stopped after {stop} steps");
            let mut same_laws = first.remodelled(&model).unwrap();
            assert!(drive(&mut same_laws, stop, 400) == expected[5 * stop as usize..]);
        }
    }
}
