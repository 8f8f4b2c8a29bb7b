//! Recordings and models side by side: four replays at once in the vectors of the processor.
//!
//! Each lane goes through its own recording with its own model at its own pace: a lane has its own steps, and where a recording is over the
//! next one takes its seat. What the hydraulics carry from step to step stays in the vectors. The results have the same bits as those of
//! replays one after the other ([`lanes`](crate::lanes)), whichever replays are given together and in whichever order.

use pulp::Simd;

use super::beginning::Beginning;
use super::hydraulics::Hydraulics;
use super::inputs::Inputs;
use super::model::StrutModel;
use super::run::{Replayed, Run};
use super::side_by_side::SideBySide;
use crate::lanes::{Four, LANES, each_lane, vectors};
use crate::model_file::InvalidValue;

/// A recording's inputs that are to be simulated with a model.
#[derive(Debug, Clone, Copy)]
pub struct Replay<'a> {
    /// The model.
    pub model: &'a StrutModel,
    /// The inputs.
    pub inputs: &'a Inputs,
    /// How it begins.
    pub begins: Beginning,
    /// Whether it is to be noted what the rod goes through, which takes about 200 bytes a sample.
    pub with_course: bool,
}

/// Simulates many recordings, or one with many models, on this thread: what [`replay_from`](super::replay_from()) gives for each, to the bit, but in
/// less time where models are of the same kind, because four are solved at once.
///
/// ```
/// use oleo_interface::StrutValves;
/// use oleo_plant_sim::strut::{Beginning, Inputs, Replay, StrutModel, replay, replay_all};
/// let time_s: Vec<f64> = (0..=200).map(|k| 0.01 * f64::from(k)).collect();
/// let displacement_m: Vec<f64> = time_s.iter().map(|t| 0.01 * t).collect();
/// let signals = vec![StrutValves::new(true, true, false); 201];
/// let inputs = Inputs::from_recording(&time_s, &displacement_m, &signals, 5.0e-6);
/// let models = [6000.0, 7000.0, 8000.0].map(StrutModel::defender110);
/// let wanted = models.each_ref().map(|model| Replay { begins: Beginning::AtRest, model, inputs: &inputs, with_course: false });
/// for (model, replayed) in models.iter().zip(replay_all(&wanted)) {
///     assert_eq!(replayed?.prediction, replay(model, &inputs)?);
/// }
/// # Ok::<(), oleo_plant_sim::model_file::InvalidValue>(())
/// ```
///
/// An impossible value in a model is the error of its replay only.
#[must_use]
pub fn replay_all(wanted: &[Replay<'_>]) -> Vec<Result<Replayed, InvalidValue>> {
    match vectors() {
        Some(simd) => replay_in(simd, wanted),
        None => wanted.iter().map(alone).collect(),
    }
}

fn begun<'a>(wanted: &Replay<'a>) -> Result<Run<'a>, InvalidValue> {
    let run = Run::begin(wanted.model, wanted.inputs, &wanted.begins)?;
    Ok(if wanted.with_course { run.with_course() } else { run })
}

fn alone(wanted: &Replay<'_>) -> Result<Replayed, InvalidValue> {
    let mut run = begun(wanted)?;
    run.go_on_to_the_end();
    Ok(run.into_replayed())
}

fn replay_in<S: Simd>(simd: S, wanted: &[Replay<'_>]) -> Vec<Result<Replayed, InvalidValue>> {
    let mut runs: Vec<_> = wanted.iter().map(begun).collect();
    let mut waiting: Vec<&mut Run<'_>> = runs.iter_mut().flatten().collect();
    // The longest first, so that the lanes are empty at about the same time. Replays of one recording stay together, and then their steps are alike.
    waiting.sort_by_key(|run| std::cmp::Reverse(run.samples()));
    while !waiting.is_empty() {
        let first = &waiting[0].strut.hydraulics;
        let is_like_first = |run: &Run<'_>| {
            let both = each_lane(|lane| if lane == 0 { first } else { &run.strut.hydraulics });
            Hydraulics::abreast(&both, Four::zero(simd)).is_some()
        };
        let alike: Vec<bool> = waiting.iter().map(|run| is_like_first(run)).collect();
        let (mut kind, mut others) = (Vec::new(), Vec::new());
        for (k, (run, is_alike)) in waiting.into_iter().zip(alike).enumerate() {
            // The first one is not like itself if it cannot be in a lane at all.
            if is_alike || k == 0 { &mut kind } else { &mut others }.push(run);
        }
        for runs in with_fewest_laws(kind) {
            Seats::new(simd, runs).simulate();
        }
        waiting = others;
    }
    (runs.into_iter()).map(|run| run.map(Run::into_replayed)).collect()
}

/// Runs of one kind that are simulated together. Where there is a law in one lane, all lanes wait while it is looked up, so that runs with the same laws stay
/// among themselves if they fill the lanes.
fn with_fewest_laws<'r, 'a>(kind: Vec<&'r mut Run<'a>>) -> Vec<Vec<&'r mut Run<'a>>> {
    let mut by_laws: Vec<Vec<&mut Run<'_>>> = Vec::new();
    for run in kind {
        match by_laws.iter_mut().find(|runs| runs[0].has_laws_of(run)) {
            Some(runs) => runs.push(run),
            None => by_laws.push(vec![run]),
        }
    }
    let (mut together, few): (Vec<_>, Vec<_>) = by_laws.into_iter().partition(|runs| runs.len() >= LANES);
    together.push(few.into_iter().flatten().collect());
    together
}

/// Runs of one kind, of which as many as there are lanes have a seat.
struct Seats<'r, 'a, S> {
    simd: S,
    /// Those that wait for a seat, the next one last.
    waiting: Vec<&'r mut Run<'a>>,
    seated: Vec<&'r mut Run<'a>>,
}

impl<'r, 'a, S: Simd> Seats<'r, 'a, S> {
    fn new(simd: S, mut runs: Vec<&'r mut Run<'a>>) -> Self {
        runs.reverse();
        Self {
            simd,
            waiting: runs,
            seated: Vec::with_capacity(LANES),
        }
    }

    /// Simulates all of them to their ends.
    fn simulate(mut self) {
        loop {
            while self.seated.len() < LANES
                && let Some(next) = self.waiting.pop()
            {
                self.seated.push(next);
            }
            if self.seated.len() < 2 || !self.go_on_until_one_is_over() {
                break;
            }
            self.seated.retain_mut(|run| run.next_step().is_some());
        }
        for run in self.seated {
            run.go_on_to_the_end();
        }
    }

    /// Takes steps until a run is over; whether any could be taken, which is not so where runs differ in kind.
    fn go_on_until_one_is_over(&mut self) -> bool {
        let seated = &mut self.seated;
        // A lane for which there is no run computes what the first one computes.
        let computed = each_lane(|lane| if lane < seated.len() { lane } else { 0 });
        let Some(mut side_by_side) = SideBySide::of(self.simd, &each_lane(|lane| &seated[computed[lane]].strut)) else {
            return false;
        };
        'steps: loop {
            let steps = &mut side_by_side.steps;
            for (lane, run) in seated.iter_mut().enumerate() {
                let Some(step) = run.next_step() else { break 'steps };
                steps.put(lane, &step);
            }
            for (lane, &stands_in) in computed.iter().enumerate().skip(seated.len()) {
                steps.put(lane, &steps.part(stands_in));
            }
            side_by_side.step();
            for (lane, run) in seated.iter_mut().enumerate() {
                side_by_side.tell(lane, &mut run.strut);
                run.conclude(&side_by_side.steps.part(lane), side_by_side.friction_n(lane));
            }
        }
        for (lane, run) in seated.iter_mut().enumerate() {
            side_by_side.take_out(lane, &mut run.strut);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::motion::Motion;
    use crate::strut::replay::{replay, replay_with_course};
    use crate::strut::terms::{Effects, LawArgument, LawPlace, UnlistedLaw};
    use oleo_interface::StrutValves;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const SEAL: &str = "seal_friction = { coulomb_force_N = 300.0, breakaway_force_N = 400.0, stribeck_speed_m_s = 0.02, \
                        presliding_stiffness_N_m = 2e6 }";

    fn with(unlisted: Vec<UnlistedLaw>) -> Effects {
        Effects {
            unlisted,
            ..Effects::default()
        }
    }

    /// Stretches of rest between stretches of sines, whose ends lie between samples, with valves that switch.
    fn inputs(samples: usize, random: &mut ChaCha8Rng) -> Inputs {
        let (amplitude_m, frequency_1_s) = (random.random_range(0.01..0.08), random.random_range(2.0..25.0));
        let interval_s = random.random_range(0.002..0.012);
        let time_s: Vec<f64> = (0..samples).map(|k| interval_s * k as f64).collect();
        let moves = |k: usize| (k / 40) % 3 < 2;
        let at = |k: usize| {
            if moves(k) {
                amplitude_m * libm::sin(frequency_1_s * time_s[k])
            } else {
                0.4 * amplitude_m
            }
        };
        let speed = |k: usize| {
            if moves(k) {
                amplitude_m * frequency_1_s * libm::cos(frequency_1_s * time_s[k])
            } else {
                0.0
            }
        };
        let mut signals = StrutValves::new(true, false, true);
        Inputs {
            motion: Motion::through((0..samples).map(|k| (at(k), speed(k)))),
            signals: (0..samples)
                .map(|k| {
                    if k % 37 == 0 {
                        signals = StrutValves::from_fn(|_| random.random_range(0..2) == 0);
                    }
                    signals
                })
                .collect(),
            time_s,
        }
    }

    fn model(effects: Effects, random: &mut ChaCha8Rng) -> StrutModel {
        let mut model = StrutModel::defender110(random.random_range(3500.0..9000.0));
        model.effects = effects;
        model.gas.temperature_k = random.random_range(250.0..330.0);
        model.valve[2].flow_coefficient *= random.random_range(0.5..2.0);
        model
    }

    fn have_the_same_bits<S: Simd>(simd: S) {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let inputs = [1, 500, 180, 700, 330, 2, 420, 600].map(|samples| inputs(samples, &mut random));
        // More of some kinds than there are lanes, and some that are alone.
        let seal = || toml::from_str::<Effects>(SEAL).unwrap();
        let mut models: Vec<StrutModel> = [
            seal(),
            seal(),
            Effects::every_term(),
            Effects::every_term(),
            Effects::every_term(),
            Effects::default(),
        ]
        .into_iter()
        .map(|effects| model(effects, &mut random))
        .collect();
        models[5].effects.gas_heat_transfer = models[2].effects.gas_heat_transfer.clone();
        let laws = Effects::laws_of_the_network();
        models.extend([laws.clone(), laws.clone()].map(|laws| model(with(laws), &mut random)));
        models.extend(laws.into_iter().map(|law| model(with(vec![law]), &mut random)));
        let mut impossible = models[0].clone();
        impossible.cylinder.bore_m = -1.0;
        models.push(impossible);
        let wanted: Vec<Replay<'_>> = (models.iter().enumerate())
            .flat_map(|(m, model)| {
                (inputs.iter().enumerate()).map(move |(i, inputs)| Replay {
                    model,
                    inputs,
                    begins: Beginning::AtRest,
                    with_course: (m + i) % 3 == 0,
                })
            })
            .collect();
        for (k, (wanted, replayed)) in wanted.iter().zip(replay_in(simd, &wanted)).enumerate() {
            match (replayed, replay(wanted.model, wanted.inputs)) {
                (Ok(replayed), Ok(alone)) => {
                    assert_eq!(replayed.prediction, alone, "replay {k}");
                    let effects = &wanted.model.effects;
                    let course = replayed.course.map(|course| course.force_n(effects));
                    let alone = (wanted.with_course).then(|| {
                        replay_with_course(wanted.model, wanted.inputs)
                            .unwrap()
                            .1
                            .force_n(effects)
                    });
                    assert_eq!(course, alone, "course of replay {k}");
                }
                (Err(replayed), Err(alone)) => assert_eq!(replayed.to_string(), alone.to_string()),
                (replayed, alone) => panic!("replay {k}: {replayed:?} and {alone:?}"),
            }
        }
    }

    #[test]
    fn replays_in_lanes_have_the_bits_of_a_replay_alone() {
        have_the_same_bits(pulp::Scalar256b);
        match vectors() {
            Some(simd) => have_the_same_bits(simd),
            None => eprintln!("SKIPPED vectors of four numbers: this processor has none"),
        }
    }

    #[test]
    fn struts_with_laws_at_different_places_share_the_lanes() {
        let simd = pulp::Scalar256b;
        let hydraulics = |laws| {
            let mut model = StrutModel::defender110(5000.0);
            model.effects.unlisted = laws;
            Hydraulics::of(&model)
        };
        let bare = hydraulics(vec![]);
        for law in Effects::laws_of_the_network() {
            // A throttled valve 3 is solved for in another way.
            let is_alone = (law.place, law.depends_on) == (LawPlace::Valves, LawArgument::PressureDrop);
            let with_law = hydraulics(vec![law.clone()]);
            let both = [&with_law, &bare, &bare, &with_law];
            assert_eq!(
                Hydraulics::abreast(&both, Four::zero(simd)).is_none(),
                is_alone,
                "{law:?}"
            );
        }
    }

    #[test]
    fn runs_with_the_same_laws_stay_among_themselves_where_they_fill_the_lanes() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let inputs = inputs(20, &mut random);
        let laws = Effects::laws_of_the_network();
        let models: Vec<StrutModel> = [5, 3, 2]
            .into_iter()
            .zip([vec![], laws[..1].to_vec(), laws[1..2].to_vec()])
            .flat_map(|(count, laws)| vec![with(laws); count])
            .map(|effects| model(effects, &mut random))
            .collect();
        let mut runs: Vec<Run<'_>> = (models.iter())
            .map(|model| Run::begin(model, &inputs, &Beginning::AtRest).unwrap())
            .collect();
        let groups = with_fewest_laws(runs.iter_mut().collect());
        assert_eq!(groups.iter().map(Vec::len).collect::<Vec<_>>(), [5, 5]);
        assert!(groups[0].iter().all(|run| groups[0][0].has_laws_of(run)));
    }

    #[test]
    fn nothing_is_simulated_where_nothing_is_wanted() {
        assert!(replay_all(&[]).is_empty());
    }
}
