//! Ride-height levelling: an actuator that pumps oil into a strut or drains it.
//!
//! The report makes levelling an optional provision. Here a pump feeds each strut's cylinder at a constant flow and a drain
//! empties it; both are slow (some millimetres a second), so that they correct load and temperature, not the road. Oil of volume
//! `q t` under the piston does what the piston does that moves in by `q t / A`: pressures and flows are those of a strut at
//! `x + q t / A`. The stops feel the piston itself. The seal's friction takes its speed from the sum, which is wrong by the
//! levelling's own speed (10 mm/s against the Stribeck speed of 20 mm/s); it is below 3 % of a strut's force.

use oleo_interface::{Corners, StrutValves};

use super::strut_element::StrutElement;
use super::suspension::{Motion, SuspensionElement};
use crate::model_file::InvalidValue;
use crate::strut::{BumpStop, Strut, StrutModel, StrutOutput};

/// What the levelling of a strut is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Levelling {
    /// Nothing: the oil stays where it is.
    #[default]
    Hold,
    /// The pump feeds the strut: the vehicle rises.
    Raise,
    /// The drain is open: the vehicle sinks.
    Lower,
}

/// Flow of pump and drain, m3/s, and how much oil they have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevellingLimits {
    /// Flow into or out of one strut, m3/s.
    pub flow_m3_s: f64,
    /// Most oil put in or taken out since the strut was charged, m3.
    pub most_m3: f64,
}

impl Default for LevellingLimits {
    /// 10 mm/s and 80 mm of a piston of 50 mm (assumed: a pump of 4.7 l/min for four struts).
    fn default() -> Self {
        Self {
            flow_m3_s: 1.96e-5,
            most_m3: 1.57e-4,
        }
    }
}

/// A strut with levelling.
#[derive(Debug, Clone)]
pub struct LevelledStrut {
    strut: StrutElement,
    stops: Option<BumpStop>,
    limits: LevellingLimits,
    area_m2: f64,
    oil_m3: f64,
    force_n: f64,
}

impl LevelledStrut {
    /// A strut at rest, its valves settled where their signals say, no oil put in or taken out.
    ///
    /// # Errors
    /// Impossible values in the model.
    pub fn at_rest(
        model: &StrutModel,
        limits: LevellingLimits,
        signals: StrutValves<bool>,
    ) -> Result<Self, InvalidValue> {
        let mut without_stops = model.clone();
        let stops = without_stops.effects.bump_stop.take();
        let strut = StrutElement::new(Strut::at_rest(&without_stops, signals)?);
        let force_n = strut.force_n() + stops.as_ref().map_or(0.0, |stops| stops.force_n(0.0));
        Ok(Self {
            strut,
            stops,
            limits,
            area_m2: model.piston_area_m2(),
            oil_m3: 0.0,
            force_n,
        })
    }

    /// Oil put in since the strut was charged, m3; negative where it was taken out.
    pub fn oil_m3(&self) -> f64 {
        self.oil_m3
    }

    /// Force and pressures at the end of the last step.
    pub fn output(&self) -> StrutOutput {
        StrutOutput {
            force_n: self.force_n,
            ..self.strut.output()
        }
    }
}

impl SuspensionElement for LevelledStrut {
    type Signal = (StrutValves<bool>, Levelling);
    type Four = Corners<Self>;

    fn advance(&mut self, motion: Motion, (valves, levelling): Self::Signal) -> f64 {
        let flow_m3_s = match levelling {
            Levelling::Hold => 0.0,
            Levelling::Raise => self.limits.flow_m3_s,
            Levelling::Lower => -self.limits.flow_m3_s,
        };
        let most_m3 = self.limits.most_m3;
        let oil_m3 = (self.oil_m3 + flow_m3_s * motion.duration_s).clamp(-most_m3, most_m3);
        let rate_m_s = (oil_m3 - self.oil_m3) / (motion.duration_s * self.area_m2);
        self.oil_m3 = oil_m3;
        let inner = Motion {
            compression_m: motion.compression_m + oil_m3 / self.area_m2,
            compression_rate_m_s: motion.compression_rate_m_s + rate_m_s,
            duration_s: motion.duration_s,
        };
        let stops_n = self
            .stops
            .as_ref()
            .map_or(0.0, |stops| stops.force_n(motion.compression_m));
        self.force_n = self.strut.advance(inner, valves) + stops_n;
        self.force_n
    }

    fn force_n(&self) -> f64 {
        self.force_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: StrutValves<bool> = StrutValves::new(true, true, true);

    fn still(duration_s: f64) -> Motion {
        Motion {
            compression_m: 0.0,
            compression_rate_m_s: 0.0,
            duration_s,
        }
    }

    /// Held and never commanded, it is the strut itself, to the bit where the stops are away.
    #[test]
    fn off_it_is_the_strut() {
        let model = StrutModel::defender110(5000.0);
        let mut levelled = LevelledStrut::at_rest(&model, LevellingLimits::default(), OPEN).unwrap();
        let mut strut = StrutElement::new(Strut::at_rest(&model, OPEN).unwrap());
        for i in 1..2000 {
            let t = 0.001 * f64::from(i);
            let motion = Motion {
                compression_m: 0.05 * libm::sin(6.0 * t),
                compression_rate_m_s: 0.3 * libm::cos(6.0 * t),
                duration_s: 0.001,
            };
            assert_eq!(
                levelled.advance(motion, (OPEN, Levelling::Hold)),
                strut.advance(motion, OPEN)
            );
        }
    }

    /// A load that floats on the strut rises by the oil's volume over the piston's area, and stays up when the pump stops.
    #[test]
    fn a_load_rises_by_the_oil_over_the_area() {
        let mut model = StrutModel::defender110(5000.0);
        model.effects.seal_friction = None;
        let limits = LevellingLimits::default();
        let area_m2 = model.piston_area_m2();
        let mut levelled = LevelledStrut::at_rest(&model, limits, OPEN).unwrap();
        // A mass of 500 kg with a damper to the ground, explicit: enough to find the rest.
        let (mut x, mut v, h) = (0.0, 0.0, 0.001);
        for i in 0..30_000 {
            let levelling = if i < 3000 { Levelling::Raise } else { Levelling::Hold };
            let force = levelled.advance(
                Motion {
                    compression_m: x,
                    compression_rate_m_s: v,
                    duration_s: h,
                },
                (OPEN, levelling),
            );
            v += h * ((5000.0 - force) - 4000.0 * v) / 500.0;
            x += h * v;
        }
        let oil_m3 = limits.flow_m3_s * 3.0;
        assert!((levelled.oil_m3() - oil_m3).abs() < 1e-12);
        assert!((x + oil_m3 / area_m2).abs() < 2e-4, "{x} m");
    }

    #[test]
    fn pump_and_drain_end_at_their_oil() {
        let model = StrutModel::defender110(5000.0);
        let limits = LevellingLimits {
            flow_m3_s: 1e-4,
            most_m3: 5e-5,
        };
        let mut levelled = LevelledStrut::at_rest(&model, limits, OPEN).unwrap();
        for _ in 0..2000 {
            levelled.advance(still(0.001), (OPEN, Levelling::Raise));
        }
        assert_eq!(levelled.oil_m3(), 5e-5);
        let raised_n = levelled.force_n();
        for _ in 0..4000 {
            levelled.advance(still(0.001), (OPEN, Levelling::Lower));
        }
        assert_eq!(levelled.oil_m3(), -5e-5);
        assert!(levelled.force_n() < 5000.0 && raised_n > 5000.0);
    }
}
