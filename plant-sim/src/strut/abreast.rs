//! Four struts that move together, side by side in the vectors of the processor.
//!
//! The results have the same bits as those of four struts that move one after the other: the hydraulics are one source, compiled
//! for one number and for four ([`lanes`](crate::lanes)). What is not worth a vector (the valves' movements, the rod) is worked out strut
//! by strut. What the hydraulics carry from step to step stays in the vectors. Where a processor has no vectors of four numbers, or the four
//! struts differ in kind, they take their steps alone.

use pulp::Simd;

use super::integrator::{Interval, Strut, StrutOutput, StrutSnapshot};
use super::motion::StrutMove;
use super::side_by_side::SideBySide;
use crate::lanes::{LANES, Vectors, each_lane, vectors};

/// Four struts that move together.
///
/// ```
/// use oleo_interface::StrutValves;
/// use oleo_plant_sim::strut::{Segment, Strut, StrutModel, StrutMove, StrutsAbreast};
/// let closed = StrutValves::default();
/// let strut = |load_n| Strut::at_rest(&StrutModel::defender110(load_n), closed);
/// let struts = [strut(4000.0)?, strut(5000.0)?, strut(6000.0)?, strut(8000.0)?];
/// let mut alone = struts[2].clone();
/// let moves = [0.01, 0.02, -0.01, 0.0].map(|to_m| StrutMove {
///     segment: Segment { to_m, from_m_s: 0.0, to_m_s: 1.0 },
///     duration_s: 0.01,
///     signals: closed,
/// });
/// let together = StrutsAbreast::new(struts).advance(&moves);
/// assert_eq!(together[2], alone.advance_with_speeds(-0.01, 0.0, 1.0, 0.01, closed));
/// # Ok::<(), oleo_plant_sim::model_file::InvalidValue>(())
/// ```
#[derive(Debug, Clone)]
pub struct StrutsAbreast {
    /// Of what flows they have only what is read between steps where it stands in the vectors.
    struts: [Strut; LANES],
    side_by_side: Option<SideBySide<Vectors>>,
}

impl StrutsAbreast {
    /// Four struts in their present states.
    #[must_use]
    pub fn new(struts: [Strut; LANES]) -> Self {
        Self {
            side_by_side: vectors().and_then(|simd| SideBySide::of(simd, &struts.each_ref())),
            struts,
        }
    }

    /// Makes a move with each strut; the outputs at their ends.
    pub fn advance(&mut self, moves: &[StrutMove; LANES]) -> [StrutOutput; LANES] {
        let struts = &mut self.struts;
        match &mut self.side_by_side {
            Some(side_by_side) => advance(side_by_side, struts, moves),
            None => each_lane(|lane| struts[lane].advance_by(&moves[lane])),
        }
    }

    /// Forces and pressures now.
    #[must_use]
    pub fn output(&self) -> [StrutOutput; LANES] {
        each_lane(|lane| self.struts[lane].output())
    }

    /// The present states.
    #[must_use]
    pub fn snapshot(&self) -> [StrutSnapshot; LANES] {
        each_lane(|lane| match &self.side_by_side {
            Some(side_by_side) => {
                let mut strut = self.struts[lane].clone();
                side_by_side.take_out(lane, &mut strut);
                strut.snapshot()
            }
            None => self.struts[lane].snapshot(),
        })
    }

    /// Puts the struts into states that they, or others of the same models, were in.
    pub fn restore(&mut self, kept: [&StrutSnapshot; LANES]) {
        for (strut, kept) in self.struts.iter_mut().zip(kept) {
            strut.restore(kept);
        }
        if let Some(side_by_side) = &mut self.side_by_side {
            side_by_side.take_in(&self.struts.each_ref());
        }
    }
}

fn advance<S: Simd>(
    side_by_side: &mut SideBySide<S>,
    struts: &mut [Strut; LANES],
    moves: &[StrutMove; LANES],
) -> [StrutOutput; LANES] {
    let mut intervals = each_lane(|lane| struts[lane].begin(&moves[lane]));
    while intervals.iter().all(|interval| !interval.is_over()) {
        for lane in 0..LANES {
            side_by_side.steps.put(lane, &struts[lane].next_step(&intervals[lane]));
        }
        side_by_side.step();
        for lane in 0..LANES {
            side_by_side.tell(lane, &mut struts[lane]);
            let (step, friction_n) = (side_by_side.steps.part(lane), side_by_side.friction_n(lane));
            struts[lane].conclude(&step, friction_n, &mut intervals[lane]);
        }
    }
    if intervals.iter().any(|interval| !interval.is_over()) {
        arrive(side_by_side, struts, &mut intervals);
    }
    each_lane(|lane| struts[lane].finish(&intervals[lane], None))
}

/// Lets those struts arrive that have more steps to take than others, each alone.
#[cold]
fn arrive<S: Simd>(side_by_side: &mut SideBySide<S>, struts: &mut [Strut; LANES], intervals: &mut [Interval; LANES]) {
    for (lane, (strut, interval)) in struts.iter_mut().zip(intervals).enumerate() {
        side_by_side.take_out(lane, strut);
        strut.take_steps(interval);
    }
    side_by_side.take_in(&struts.each_ref());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::model::StrutModel;
    use crate::strut::motion::Segment;
    use crate::strut::terms::{Effects, LawArgument};
    use oleo_interface::StrutValves;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const REST: StrutMove = StrutMove {
        segment: Segment {
            to_m: 0.0,
            from_m_s: 0.0,
            to_m_s: 0.0,
        },
        duration_s: 0.01,
        signals: StrutValves::new(false, false, false),
    };

    fn every_law() -> Effects {
        Effects {
            unlisted: Effects::laws_of_the_network(),
            ..StrutModel::defender110(5000.0).effects
        }
    }

    /// Struts whose parameters differ from lane to lane.
    fn models(effects: &Effects, random: &mut ChaCha8Rng) -> [StrutModel; LANES] {
        each_lane(|lane| {
            let mut model = StrutModel::defender110(random.random_range(3500.0..9000.0));
            model.effects = effects.clone();
            model.gas.temperature_k = random.random_range(250.0..330.0);
            model.damper = model.damper.map(|damper| damper.scaled(random.random_range(0.6..1.5)));
            model.valve[2].flow_coefficient *= random.random_range(0.5..2.0);
            if let Some(air) = &mut model.effects.entrained_air {
                air.polytropic_exponent = [1.0, 1.2, 1.4, 1.0][lane];
            }
            // Beside rods that rub, one whose seal does not, and one whose guides do not.
            if lane == 3 {
                model.effects.seal_friction = None;
            }
            if lane == 1 {
                model.effects.side_load_friction = None;
            }
            // Beside one that rubs, one whose piston is free and whose pack neither leaks nor fades.
            if let (0, Some(friction)) = (lane, &mut model.effects.accumulator_piston_friction) {
                friction.pressure_1_pa = 0.0;
            }
            if let (1, Some(leak)) = (lane, &mut model.effects.damper_leakage) {
                leak.flow_coefficient_1 = 0.0;
            }
            if let (2, Some(fade)) = (lane, &mut model.effects.damping_fade) {
                fade.fade_2_per_j = 0.0;
            }
            // Laws of one kind whose tables have different points.
            for law in &mut model.effects.unlisted {
                if law.depends_on != LawArgument::Phase {
                    let stretch = random.random_range(0.8..1.25);
                    law.argument.iter_mut().for_each(|x| *x *= stretch);
                }
                if lane % 2 == 0 && law.argument.len() > 2 {
                    law.argument.remove(1);
                    law.value.remove(1);
                }
            }
            model
        })
    }

    /// Calm ones, violent ones down to vacuum, with valves that switch at times of their own.
    fn moves(count: usize, random: &mut ChaCha8Rng) -> Vec<StrutMove> {
        let (amplitude_m, frequency_1_s) = (random.random_range(0.0..0.1), random.random_range(1.0..60.0));
        let mut time_s = 0.0;
        (0..count)
            .map(|k| {
                let duration_s = [0.001, 0.004, 0.01][k % 3];
                let speed = |t: f64| amplitude_m * frequency_1_s * libm::cos(frequency_1_s * t);
                let from_m_s = speed(time_s);
                time_s += duration_s;
                StrutMove {
                    segment: Segment {
                        to_m: amplitude_m * libm::sin(frequency_1_s * time_s),
                        from_m_s,
                        to_m_s: speed(time_s),
                    },
                    duration_s,
                    signals: StrutValves::from_fn(|_| random.random_range(0..60) < 30),
                }
            })
            .collect()
    }

    fn have_the_same_bits<S: Simd>(simd: S, effects: &Effects) {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..6 {
            let models = models(effects, &mut random);
            let signals = StrutValves::new(true, false, random.random_range(0..2) == 0);
            let mut together = models.each_ref().map(|model| Strut::at_rest(model, signals).unwrap());
            let mut alone = together.clone();
            let mut moves = each_lane(|_| moves(300, &mut random).into_iter());
            let mut by = each_lane(|_| REST);
            let mut side_by_side = SideBySide::of(simd, &together.each_ref()).unwrap();
            for k in 0..300 {
                by = each_lane(|lane| moves[lane].next().unwrap_or(by[lane]));
                let outputs = advance(&mut side_by_side, &mut together, &by);
                assert_eq!(outputs, each_lane(|lane| alone[lane].advance_by(&by[lane])), "move {k}");
                assert!(outputs.iter().all(|output| output.force_n.is_finite()));
            }
            for lane in 0..LANES {
                side_by_side.take_out(lane, &mut together[lane]);
                // The state too: it comes to rest alone as if it had never been beside others.
                let mut rest = by[lane];
                (rest.segment.from_m_s, rest.segment.to_m_s) = (0.0, 0.0);
                for _ in 0..20 {
                    assert_eq!(together[lane].advance_by(&rest), alone[lane].advance_by(&rest));
                }
            }
        }
    }

    #[test]
    fn lanes_have_the_bits_of_a_strut_alone() {
        for effects in [
            StrutModel::defender110(5000.0).effects,
            Effects::every_term(),
            every_law(),
        ] {
            // Lanes that are no vectors are tested with recordings: each kind of lanes is compiled for as long as half of this crate.
            match vectors() {
                Some(simd) => have_the_same_bits(simd, &effects),
                None => eprintln!("SKIPPED vectors of four numbers: this processor has none"),
            }
        }
    }

    #[test]
    fn struts_of_different_kinds_move_alone() {
        let plain = StrutModel::defender110(5000.0);
        let mut bare = plain.clone();
        bare.effects.gas_heat_transfer = None;
        let still = StrutValves::default();
        let struts = [&plain, &plain, &bare, &plain].map(|model| Strut::at_rest(model, still).unwrap());
        assert!(SideBySide::of(pulp::Scalar256b, &struts.each_ref()).is_none());
    }
}
