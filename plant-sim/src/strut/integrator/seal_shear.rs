//! How finely time is cut while the seals of floating pistons shear.
//!
//! A seal keeps the shear at which its flow stops, and the pressure that goes with it is held for as long as the strut rests. A long step
//! in which the flow stops or turns gets that shear wrong by a part of it. So the more a seal holds back, the shorter are the steps while
//! oil flows, and until the chambers have come to rest.

use crate::strut::flow_path::FlowPath;
use crate::strut::terms::{Effects, most_held_back_pa};

/// Length of a step times the pressure that a seal holds back, Pa s. At 5 bar, 0.6 ms, recordings of a strut are met within their noise where the flow
/// stops within a tenth of a second from 0.5 m/s; at 0.2 bar steps are as long as they are without a seal.
const STEP_PA_S: f64 = 300.0;
/// Shortest step for the sake of the seals, s: one that holds back more than 15 bar is not worth the time.
const LEAST_STEP_S: f64 = 2e-4;
/// Time after the last fast movement in which oil may still flow, s.
const COMES_TO_REST_S: f64 = 0.1;

/// The seals of both pistons as the integrator watches them.
#[derive(Debug, Clone)]
pub(super) struct SealShear {
    step_s: f64,
}

impl SealShear {
    /// The seals of the term and of laws without a name; none where they hold nothing back.
    pub fn of(effects: &Effects) -> Option<Self> {
        let held_back_pa = |path| {
            let by_term =
                (effects.accumulator_piston_friction.as_ref()).map_or(0.0, |term| term.seal(path).breakaway_pa);
            by_term + most_held_back_pa(&effects.unlisted, path)
        };
        let largest_pa = FlowPath::ALL.map(held_back_pa).into_iter().fold(0.0, f64::max);
        (largest_pa > 0.0).then(|| Self {
            step_s: (STEP_PA_S / largest_pa).max(LEAST_STEP_S),
        })
    }

    /// Longest step now, s, where no valve moves from a time on, s, and nothing has moved fast since another, s; infinite once the oil has come to rest.
    #[inline]
    pub fn longest_step_s(&self, now_s: f64, valves_settled_s: f64, fast_until_s: f64) -> f64 {
        if now_s < fast_until_s.max(valves_settled_s) + COMES_TO_REST_S {
            self.step_s
        } else {
            f64::INFINITY
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::terms::AccumulatorPistonFriction;
    use crate::strut::{Strut, StrutModel};
    use oleo_interface::StrutValves;

    /// A strut whose second floating piston holds back so much, Pa.
    fn model(breakaway_pa: f64) -> StrutModel {
        let mut model = StrutModel::defender110(8000.0);
        model.effects.accumulator_piston_friction = Some(AccumulatorPistonFriction {
            pressure_1_pa: 0.0,
            pressure_2_pa: breakaway_pa,
            presliding_volume_m3: 4e-7,
        });
        model
    }

    /// Pressure of accumulator 2 while the strut holds, Pa, after 50 mm within 0.1 s, told in intervals of this many milliseconds.
    fn held_pa(breakaway_pa: f64, interval_ms: u32) -> f64 {
        let open = StrutValves::splat(true);
        let mut strut = Strut::at_rest(&model(breakaway_pa), open).unwrap();
        let position = |t_s: f64| {
            let part = (t_s / 0.1).min(1.0);
            0.05 * part * part * (3.0 - 2.0 * part)
        };
        let speed = |t_s: f64| {
            if t_s < 0.1 {
                3.0 * t_s / 0.1 * (1.0 - t_s / 0.1)
            } else {
                0.0
            }
        };
        let h = 1e-3 * f64::from(interval_ms);
        let mut out = strut.output();
        for k in 1..=500 / interval_ms {
            let t = h * f64::from(k);
            out = strut.advance_with_speeds(position(t), speed(t - h), speed(t), h, open);
        }
        out.pressure_pa[3]
    }

    #[test]
    fn a_stop_leaves_the_shear_that_short_steps_leave() {
        let (short, long) = (held_pa(5e5, 1), held_pa(5e5, 20));
        let without = held_pa(0.0, 1);
        assert!(
            (short - without).abs() > 1e4,
            "the seal holds {short} against {without}"
        );
        assert!((long - short).abs() < 2e3, "{long} {short}");
    }

    #[test]
    fn steps_are_as_long_as_ever_once_the_oil_rests_and_where_nothing_is_held_back() {
        assert!(SealShear::of(&model(0.0).effects).is_none());
        let seals = SealShear::of(&model(5e5).effects).unwrap();
        assert_eq!(seals.longest_step_s(2.05, f64::NEG_INFINITY, 2.0), 6e-4);
        assert_eq!(seals.longest_step_s(2.15, f64::NEG_INFINITY, 2.0), f64::INFINITY);
        assert_eq!(seals.longest_step_s(2.15, 2.1, 2.0), 6e-4);
        let gross = SealShear::of(&model(1e9).effects).unwrap();
        assert_eq!(gross.longest_step_s(0.05, 0.0, 0.0), LEAST_STEP_S);
    }
}
