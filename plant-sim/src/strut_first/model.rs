//! The model of figure 26: five inputs (displacement, speed, three switch signals), one force.

use oleo_interface::{StrutValves, Valve};

use crate::model_file::InvalidValue;
use crate::strut::StrutModel;

use super::characteristics::{Characteristics, Damping, Spring};
use super::switching::DelayedSwitch;

/// What the model gives at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstGenerationOutput {
    /// Spring and damper force, N, compression positive.
    pub force_n: f64,
    /// The spring's part, N.
    pub spring_force_n: f64,
    /// The damper's part, N.
    pub damper_force_n: f64,
    /// The delayed signals that act.
    pub acting: StrutValves<bool>,
}

/// First-generation strut: tables and the state of three valves.
///
/// ```
/// use oleo_interface::StrutValves;
/// use oleo_plant_sim::strut::StrutModel;
/// use oleo_plant_sim::strut_first::FirstGenerationStrut;
/// let open = StrutValves::new(true, true, true);
/// let mut strut = FirstGenerationStrut::at_rest(&StrutModel::defender110(8000.0), open)?;
/// let out = strut.update(0.0, 0.0, 0.0, open);
/// assert!((out.force_n - 8000.0).abs() < 1.0);
/// # Ok::<(), oleo_plant_sim::model_file::InvalidValue>(())
/// ```
#[derive(Debug, Clone)]
pub struct FirstGenerationStrut {
    characteristics: Characteristics,
    area_m2: f64,
    response_polynomial_s: Vec<f64>,
    switches: StrutValves<DelayedSwitch>,
    last: Option<FirstGenerationOutput>,
}

impl FirstGenerationStrut {
    /// Tables from the model's geometry, fillings and packs; its `[effects]` are of the second generation and not used.
    ///
    /// # Errors
    /// Impossible values in the model.
    pub fn at_rest(model: &StrutModel, signals: StrutValves<bool>) -> Result<Self, InvalidValue> {
        Ok(Self {
            characteristics: Characteristics::of(model)?,
            area_m2: model.piston_area_m2(),
            response_polynomial_s: model.valve_timing.response_polynomial_s.clone(),
            switches: signals.map(DelayedSwitch::at_rest),
            last: None,
        })
    }

    /// The look-up tables of the model.
    #[must_use]
    pub fn characteristics(&self) -> &Characteristics {
        &self.characteristics
    }

    /// Force at `time_s` (not decreasing from call to call), displacement m and speed m/s, compression positive.
    ///
    /// The pressure difference at a valve is approximated as in the report: damper force over piston area for valves 1 and 2,
    /// spring force over piston area for valve 3, both as they were before the edge.
    pub fn update(
        &mut self,
        time_s: f64,
        displacement_m: f64,
        speed_m_s: f64,
        signals: StrutValves<bool>,
    ) -> FirstGenerationOutput {
        let before = match self.last {
            Some(last) => last,
            None => self.forces(displacement_m, speed_m_s, signals),
        };
        let damper_pa = before.damper_force_n / self.area_m2;
        let spring_pa = before.spring_force_n / self.area_m2;
        let across = StrutValves::new(damper_pa, damper_pa, spring_pa);
        let acting = StrutValves::from_fn(|valve| {
            self.switches[valve].update(time_s, signals[valve], across[valve], &self.response_polynomial_s)
        });
        let output = self.forces(displacement_m, speed_m_s, acting);
        self.last = Some(output);
        output
    }

    /// The sub-systems "soft spring" and "stiff spring" with their damping sub-systems (figures 28 to 30).
    fn forces(&self, displacement_m: f64, speed_m_s: f64, acting: StrutValves<bool>) -> FirstGenerationOutput {
        let (spring, damping) = if acting[Valve::Spring] {
            // One open bypass takes nearly all the oil; the report has no curve of its own for it.
            let low = acting[Valve::Bypass1] || acting[Valve::Bypass2];
            (Spring::Soft, if low { Damping::Low } else { Damping::HighSoft })
        } else {
            let low = acting[Valve::Bypass1];
            (Spring::Stiff, if low { Damping::Low } else { Damping::HighStiff })
        };
        let spring_force_n = self.characteristics.spring(spring).at(displacement_m);
        let damper_force_n = self.characteristics.damping(damping).at(speed_m_s);
        FirstGenerationOutput {
            force_n: spring_force_n + damper_force_n,
            spring_force_n,
            damper_force_n,
            acting,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: StrutValves<bool> = StrutValves::new(true, true, true);
    const STIFF: StrutValves<bool> = StrutValves::new(true, true, false);

    fn strut(signals: StrutValves<bool>) -> FirstGenerationStrut {
        FirstGenerationStrut::at_rest(&StrutModel::defender110(8000.0), signals).expect("the preset is possible")
    }

    #[test]
    fn valve_2_does_nothing_with_valve_3_closed() {
        for first in [false, true] {
            let force_n = |signals| strut(signals).update(0.0, 0.01, 0.3, signals).force_n;
            let closed = force_n(StrutValves::new(first, false, false));
            let open = force_n(StrutValves::new(first, true, false));
            assert_eq!(closed, open);
        }
    }

    #[test]
    fn opening_valve_3_at_the_reference_position_is_smooth_and_elsewhere_a_jump() {
        let jump = |displacement_m: f64| {
            let mut strut = strut(STIFF);
            let before = strut.update(0.0, displacement_m, 0.0, STIFF);
            strut.update(0.1, displacement_m, 0.0, OPEN);
            let after = strut.update(0.3, displacement_m, 0.0, OPEN);
            assert!(after.acting[Valve::Spring]);
            after.force_n - before.force_n
        };
        assert!(jump(0.0).abs() < 5.0);
        assert!(jump(0.03) < -5000.0);
    }

    #[test]
    fn valve_3_is_later_at_a_higher_spring_force() {
        let delay = |displacement_m: f64| {
            let mut strut = strut(STIFF);
            strut.update(0.0, displacement_m, 0.0, STIFF);
            (0..2000)
                .map(|i| 1e-4 * f64::from(i))
                .find(|&t| strut.update(t, displacement_m, 0.0, OPEN).acting[Valve::Spring])
                .expect("it acts")
        };
        // Parabola of the preset at 4.07 MPa (static), and at some 38 kN over 1963.5 mm2.
        assert!((delay(0.0) - 0.068_39).abs() < 2e-4, "{}", delay(0.0));
        assert!(delay(0.04) > 0.18 && delay(0.04) < 0.22, "{}", delay(0.04));
    }

    #[test]
    fn isothermal_and_without_memory() {
        let mut strut = strut(OPEN);
        let first = strut.update(0.0, 0.02, 0.1, OPEN);
        strut.update(50.0, -0.1, 0.0, OPEN);
        let again = strut.update(100.0, 0.02, 0.1, OPEN);
        assert_eq!(first.force_n, again.force_n);
    }
}
