//! One simulated campaign: a drawn strut, its true numbers within the stated tolerances, a concealed effect of a wanted
//! size, and recordings of it with noise on every column.
//!
//! The truth is simulated on a grid five times finer than the recordings, with the exact motion; the diagnosis sees
//! samples of it and a noisy displacement. The equations are plant-sim's in both, so what is measured here is the power of
//! the method, not the truth of the equations: that is what the labelled recordings of an independent simulator are for.

use std::sync::atomic::AtomicBool;

use nalgebra::{DMatrix, DVector};
use oleo_interface::Valve;
use oleo_plant_sim::strut::{
    COLUMNS, Effects, Inputs, PRESLIDING_STIFFNESS_N_M, SealFriction, StrutModel, record_column, replay,
};

use super::draw::Draw;
use super::excitation::{Move, moves};
use super::flaw::{Flaw, Instruments};
use super::hidden::{Hidden, Truth};
use super::nominal_strut::nominal;
use crate::error::DiagnoseError;
use crate::estimation::bounded_step::bounded_step;
use crate::estimation::{Evaluation, Point};
use crate::recording::Recording;
use crate::specimen::strut::{CHANNELS, TwoStageStrut};
use crate::specimen::{Hypothesis, Series, Specimen};
use crate::vocabulary::EffectId;

/// The truth's grid is this many times finer than a recording's.
const REFINEMENT: usize = 5;
/// Halvings of the (logarithmic) range of the amount in the search for a size.
const HALVINGS: usize = 11;
/// Recordings of every campaign that the diagnosis never sees: these moves, made again with other strokes and speeds.
const UNSEEN: [&str; 5] = [
    "slow_hold",
    "sine_high_stiff",
    "damper_steps",
    "valve3_steps",
    "road_switching",
];

/// Friction of the seal that is known where laws without a name are concealed on purpose: a level that can swing.
const KNOWN_FRICTION: SealFriction = SealFriction {
    coulomb_force_n: 400.0,
    breakaway_force_n: 400.0,
    stribeck_speed_m_s: 0.01,
    presliding_stiffness_n_m: PRESLIDING_STIFFNESS_N_M,
};

/// A campaign and what is concealed in it.
pub struct Generated {
    /// The model that is believed.
    pub given: StrutModel,
    /// What the diagnosis is given.
    pub recordings: Vec<Recording>,
    /// Recordings that the diagnosis does not get, on which it is judged.
    pub unseen: Vec<Recording>,
    /// The complete model, with the effects and the true values of everything that is believed within a tolerance.
    pub complete: StrutModel,
    /// True values of the concealed parameters.
    pub truth: Vec<Truth>,
    /// Size of each concealed effect: RMS over all channels and samples of what it changes, over the noise, after the best
    /// linear recalibration within tolerance.
    pub sizes: Vec<f64>,
}

/// Generates the campaign of this name with these effects, each of a wanted size. Their variants are drawn unless they are stated; then they
/// are laws without a name, and the strut has a friction of its seal that is known. A flaw of the instruments is in the
/// recordings that the diagnosis gets; the others are made with instruments as the model states them, so that they judge the
/// model.
///
/// # Errors
/// A drawn model that cannot be simulated.
pub fn generate(
    name: &str,
    wanted: &[(EffectId, f64)],
    variants: &[usize],
    flaw: Option<Flaw>,
) -> Result<Generated, DiagnoseError> {
    let (mut flawed, mut perfect) = (Instruments::draw(name, flaw), Instruments::draw(name, None));
    let mut draw = Draw::named(name);
    let mut given = nominal(name, &mut draw);
    let seen = moves(&mut draw);
    if !variants.is_empty() {
        given.effects.seal_friction = Some(KNOWN_FRICTION);
    }
    let hidden = concealed(wanted, variants, &given, &mut draw);
    for (h, _) in &hidden {
        h.conceal(&mut given);
    }
    let blank = seen.iter().map(blank_recording).collect();
    let scaffold = TwoStageStrut::new(given.clone(), blank).map_err(DiagnoseError::Model)?;
    let deviations: Vec<f64> = scaffold
        .calibration()
        .iter()
        .map(|p| 2.0 * draw.between(-1.0, 1.0) * p.slope(0.0))
        .collect();
    let believed = scaffold.applied(&Hypothesis {
        calibration: deviations,
        effects: vec![],
    });
    let mut truth_model = believed.clone();
    let ruler = Ruler::new(&scaffold, &believed, &seen)?;
    let (mut truth, mut sizes) = (Vec::new(), Vec::new());
    for (h, target) in &hidden {
        let (amount, size) = ruler.amount(h, *target);
        truth.extend(h.put(&mut truth_model, amount));
        sizes.push(size);
    }
    let recordings = (seen.iter())
        .map(|m| record(&truth_model, m, &mut draw, &mut flawed))
        .collect::<Result<_, _>>()?;
    let unseen = moves(&mut draw)
        .iter()
        .filter(|m| UNSEEN.contains(&m.name))
        .map(|m| record(&truth_model, m, &mut draw, &mut perfect))
        .collect::<Result<_, _>>()?;
    Ok(Generated {
        given,
        recordings,
        unseen,
        complete: truth_model,
        truth,
        sizes,
    })
}

/// Draws the effects; two faults of one instrument would be one.
fn concealed(
    wanted: &[(EffectId, f64)],
    variants: &[usize],
    complete: &StrutModel,
    draw: &mut Draw,
) -> Vec<(Hidden, f64)> {
    let mut all: Vec<(Hidden, f64)> = Vec::new();
    for (k, &(id, size)) in wanted.iter().enumerate() {
        let variant = variants.get(k).copied();
        let mut drawn = Hidden::draw(id, variant, complete, draw);
        let taken = |h: &Hidden| h.column().is_some() && all.iter().any(|(other, _)| other.column() == h.column());
        while drawn.as_ref().is_some_and(taken) {
            drawn = Hidden::draw(id, variant, complete, draw);
        }
        all.extend(drawn.map(|hidden| (hidden, size)));
    }
    all
}

fn switching(inputs: &Inputs) -> [Vec<f64>; 3] {
    Valve::ALL.map(|valve| inputs.signals.iter().map(|s| f64::from(u8::from(s[valve]))).collect())
}

fn positions(inputs: &Inputs) -> Vec<f64> {
    let later = inputs.motion.segments.iter().map(|s| s.to_m);
    std::iter::once(inputs.motion.start_m).chain(later).collect()
}

/// A recording with exact displacement and empty channels: what sensitivities need.
fn blank_recording(m: &Move) -> Recording {
    let inputs = m.inputs(1);
    let n = inputs.time_s.len();
    let mut columns = vec![positions(&inputs)];
    columns.extend(std::iter::repeat_n(vec![0.0; n], CHANNELS.len()));
    columns.extend(switching(&inputs));
    Recording {
        name: m.name.to_owned(),
        time_s: inputs.time_s,
        columns,
        notes: vec![],
    }
}

/// A model without what its displacement sensor does: [`replay`] takes motion for a reading, and here it is the truth.
fn with_true_motion(model: &StrutModel) -> StrutModel {
    let mut model = model.clone();
    model.effects.retain_sensor_faults(|column| column != COLUMNS[0]);
    model
}

fn run(model: &StrutModel, inputs: &Inputs, name: &str) -> Result<Series, DiagnoseError> {
    let fail = |what: String| DiagnoseError::Simulation {
        recording: name.to_owned(),
        what,
    };
    let p = replay(model, inputs).map_err(|e| fail(e.to_string()))?;
    let [p1, p2, p3, p4] = p.pressure_pa;
    let series = vec![p.force_n, p1, p2, p3, p4];
    if series.iter().flatten().all(|v| v.is_finite()) {
        Ok(series)
    } else {
        Err(fail("the model ran to values that are not numbers".into()))
    }
}

fn read_displacement(effects: &Effects, inputs: &Inputs) -> Vec<f64> {
    let mut shown = positions(inputs);
    record_column(effects, COLUMNS[0], &inputs.time_s, &mut shown);
    shown
}

/// Simulates a move on the fine grid, samples it, and adds noise to every column.
fn record(
    truth: &StrutModel,
    m: &Move,
    draw: &mut Draw,
    instruments: &mut Instruments,
) -> Result<Recording, DiagnoseError> {
    let fine = m.inputs(REFINEMENT);
    let channels = run(&with_true_motion(truth), &fine, m.name)?;
    let displacement = read_displacement(&truth.effects, &fine);
    let coarse = m.inputs(1);
    let late = instruments.jitter(coarse.time_s.len());
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for (c, (name, series)) in (COLUMNS.iter().zip(std::iter::once(&displacement).chain(&channels))).enumerate() {
        let noise = truth.noise.get(*name).copied().unwrap_or(0.0);
        let sampled: Vec<f64> = match &late {
            None => series.iter().step_by(REFINEMENT).copied().collect(),
            Some(late) => (late.iter().enumerate())
                .map(|(k, late)| between(series, (k as f64 + late) * REFINEMENT as f64))
                .collect(),
        };
        let white = sampled.iter().map(|_| draw.normal()).collect();
        let drawn = instruments.noise(white);
        let mut readings: Vec<f64> = sampled.iter().zip(drawn).map(|(v, drawn)| v + noise * drawn).collect();
        instruments.record(c, noise, m.interval_s, &mut readings);
        columns.push(readings);
    }
    columns.extend(switching(&coarse));
    Ok(Recording {
        name: m.name.to_owned(),
        time_s: coarse.time_s,
        columns,
        notes: vec![],
    })
}

/// A series between its samples, by a straight line.
fn between(series: &[f64], at: f64) -> f64 {
    let last = series.len().saturating_sub(1);
    let at = at.clamp(0.0, last as f64);
    let before = (at as usize).min(last.saturating_sub(1));
    let part = at - before as f64;
    series[before] + part * (series[(before + 1).min(last)] - series[before])
}

/// Measures effects in units of noise.
struct Ruler<'a> {
    believed: &'a StrutModel,
    moves: Vec<(&'static str, Inputs)>,
    without: Vec<Series>,
    weights: Vec<f64>,
    /// Derivatives of all residuals by the calibration, their normal matrix with the prior, and what tolerance allows.
    columns: Vec<Vec<f64>>,
    normal: DMatrix<f64>,
    ranges: Vec<(f64, f64)>,
}

impl<'a> Ruler<'a> {
    fn new(scaffold: &TwoStageStrut, believed: &'a StrutModel, moves: &[Move]) -> Result<Self, DiagnoseError> {
        let stop = AtomicBool::new(false);
        let nominal = Point::nominal(scaffold);
        let all: Vec<usize> = (0..nominal.z.len()).collect();
        let sensitivities = Evaluation::new(scaffold, &stop).sensitivities(&nominal, &all, None)?;
        let columns: Vec<Vec<f64>> = all
            .iter()
            .map(|&k| {
                sensitivities
                    .iter()
                    .flat_map(|s| s.columns[k].iter().flatten().copied())
                    .collect()
            })
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut h = DMatrix::<f64>::identity(all.len(), all.len());
        for i in 0..all.len() {
            for j in 0..all.len() {
                h[(i, j)] += dot(&columns[i], &columns[j]);
            }
        }
        let moves: Vec<(&'static str, Inputs)> = moves.iter().map(|m| (m.name, m.inputs(1))).collect();
        let true_motion = with_true_motion(believed);
        let without = (moves.iter())
            .map(|(name, inputs)| run(&true_motion, inputs, name))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            believed,
            moves,
            without,
            weights: scaffold.channels().iter().map(|c| 1.0 / c.noise).collect(),
            columns,
            normal: h,
            ranges: scaffold.calibration().iter().map(|p| p.z_range()).collect(),
        })
    }

    /// Size of a hidden effect; infinite where the truth cannot be simulated.
    fn size(&self, hidden: &Hidden, amount: f64) -> f64 {
        self.difference(hidden, amount).map_or(f64::INFINITY, |difference| {
            let answer = DVector::from_iterator(
                self.columns.len(),
                (self.columns.iter()).map(|c| c.iter().zip(&difference).map(|(a, b)| a * b).sum::<f64>()),
            );
            let rest = vec![0.0; self.columns.len()];
            let step = bounded_step(&self.normal, &answer, 0.0, &rest, &self.ranges);
            let mut left = difference;
            for (column, a) in self.columns.iter().zip(step.iter().flat_map(|s| s.iter())) {
                left.iter_mut().zip(column).for_each(|(l, c)| *l -= a * c);
            }
            (left.iter().map(|v| v * v).sum::<f64>() / left.len() as f64).sqrt()
        })
    }

    /// With less without the effect, all channels of all recordings, in units of noise.
    fn difference(&self, hidden: &Hidden, amount: f64) -> Result<Vec<f64>, DiagnoseError> {
        let mut model = self.believed.clone();
        hidden.put(&mut model, amount);
        let true_motion = with_true_motion(&model);
        let mut difference = Vec::new();
        for ((name, inputs), without) in self.moves.iter().zip(&self.without) {
            let with = run(&true_motion, inputs, name)?;
            // What the believed model makes of the reading of a faulty displacement sensor.
            let misled = (hidden.column() == Some(COLUMNS[0]))
                .then(|| {
                    let noise = model.noise.get(COLUMNS[0]).copied().unwrap_or(0.0);
                    let shown = read_displacement(&model.effects, inputs);
                    let inputs = Inputs::from_recording(&inputs.time_s, &shown, &inputs.signals, noise);
                    run(self.believed, &inputs, name)
                })
                .transpose()?;
            let without = misled.as_ref().unwrap_or(without);
            for ((a, b), weight) in with.iter().zip(without).zip(&self.weights) {
                difference.extend(a.iter().zip(b).map(|(a, b)| (a - b) * weight));
            }
        }
        Ok(difference)
    }

    /// The amount whose size comes nearest to the target, and its size.
    fn amount(&self, hidden: &Hidden, target: f64) -> (f64, f64) {
        let Some((least, most)) = hidden.range else {
            return (1.0, self.size(hidden, 1.0));
        };
        let largest = self.size(hidden, most);
        if largest <= target {
            return (most, largest);
        }
        let (mut low, mut high) = (libm::log(least), libm::log(most));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.size(hidden, libm::exp(middle)) < target {
                low = middle;
            } else {
                high = middle;
            }
        }
        let amount = libm::exp(0.5 * (low + high));
        (amount, self.size(hidden, amount))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::normal_equations::{assemble, sum};
    use crate::estimation::{LeastSquares, fit};
    use crate::search::Screen;

    #[test]
    fn a_complete_campaign_is_met_by_its_own_truth_to_the_noise() {
        // The truth here is the model that is believed plus calibration: fitting that alone must reach the noise.
        let g = generate("test:none", &[], &[], None).unwrap();
        assert!(g.truth.is_empty() && g.sizes.is_empty());
        assert_eq!(g.unseen.len(), UNSEEN.len());
        let strut = TwoStageStrut::new(g.given, g.recordings).unwrap();
        let stop = AtomicBool::new(false);
        let problem = LeastSquares::new(&strut, &stop);
        let calibrated = fit(&problem, Point::nominal(&strut), problem.criteria.fitting.converged).unwrap();
        let ratio = (calibrated.cost / problem.residuals() as f64).sqrt();
        assert!(ratio > 0.98 && ratio < 1.06, "{ratio}");
    }

    #[test]
    fn the_law_of_an_instrument_counts_once() {
        let g = generate("test:none", &[], &[], None).unwrap();
        let strut = TwoStageStrut::new(g.given, g.recordings).unwrap();
        let labelled = |label: &str| strut.candidates().iter().position(|c| c.label == label);
        let law = labelled("reading over time, periodic, p2").unwrap();
        let first_p2 = |amplitude: f64| {
            let hypothesis = Hypothesis {
                calibration: vec![0.0; strut.calibration().len()],
                effects: vec![(law, vec![amplitude, std::f64::consts::FRAC_PI_2, 0.1])],
            };
            let truth = strut.simulate(&hypothesis, 0).unwrap();
            strut.observe(&hypothesis, 0, &truth)[2][0]
        };
        // A quarter of a turn on, the sine is at its highest, and the points of its 64 straight parts are higher by the square of `x / sin(x)`.
        let half_part = std::f64::consts::PI / 64.0;
        let highest = 1e4 * (half_part / libm::sin(half_part)) * (half_part / libm::sin(half_part));
        assert!((first_p2(1e4) - first_p2(0.0) - highest).abs() < 1e-3);
    }

    /// The term is left out of the model, and the law at its piston must find its level and the volume that shears its seal.
    #[test]
    fn the_law_of_a_floating_piston_finds_the_volume_that_shears_its_seal() {
        let g = generate("test:piston", &[(EffectId::AccumulatorPistonFriction, 10.0)], &[], None).unwrap();
        let branch = g.truth[0].place.branch().unwrap();
        let strut = TwoStageStrut::new(g.given, g.recordings).unwrap();
        let label = format!("pressure held back over volume, accumulator {}", branch.number());
        let law = strut.candidates().iter().position(|c| c.label == label).unwrap();
        let stop = AtomicBool::new(false);
        let problem = LeastSquares::new(&strut, &stop);
        let calibrated = fit(&problem, Point::nominal(&strut), problem.criteria.fitting.converged).unwrap();
        let screened = Screen::new(&problem, &calibrated)
            .and_then(|screen| screen.all(&[law]))
            .unwrap();
        let start = screened[0].as_ref().unwrap().point.clone();
        let fitted = fit(&problem, start, problem.criteria.fitting.converged).unwrap();
        let ratio = (fitted.cost / problem.residuals() as f64).sqrt();
        let found = fitted.point.hypothesis(&strut).effects[0].1.clone();
        let (level, volume) = (found[0] / g.truth[0].value, found[2] / g.truth[1].value);
        assert!(
            ratio < 1.06 && (level - 1.0).abs() < 0.05 && (volume - 1.0).abs() < 0.1,
            "{ratio} {found:?} {:?}",
            g.truth
        );
    }

    /// Where the displacement is read with an offset, stops that are as much further away and gases that are filled for it do the same: of the offset nothing
    /// is known but its tolerance, however gross the stops are.
    #[test]
    fn gross_stops_do_not_say_where_the_displacement_is_zero() {
        let g = generate("5:bump_stop:9:300", &[(EffectId::BumpStop, 300.0)], &[], None).unwrap();
        let mut without = g.complete;
        let stops = without.effects.bump_stop.take().unwrap();
        let strut = TwoStageStrut::new(without, g.recordings).unwrap();
        let candidate = (strut.candidates().iter().position(|c| c.id == EffectId::BumpStop)).unwrap();
        let far = |end: usize| strut.candidates()[candidate].parameters[end].upper;
        let numbers = [
            stops.bump_clearance_m.min(far(0)),
            stops.rebound_clearance_m.min(far(1)),
            stops.stiffness_n_m,
            stops.progression_n_m3,
        ];
        let point = Point::nominal(&strut).with_effect(&strut, candidate, &numbers);
        let stop = AtomicBool::new(false);
        let problem = LeastSquares::new(&strut, &stop);
        let all: Vec<usize> = (0..point.z.len()).collect();
        let offset = (strut.calibration().iter())
            .position(|p| p.key == "displacement_offset_m")
            .unwrap();
        let deviation = |evaluation: &Evaluation<'_>| {
            let answers = evaluation.sensitivities(&point, &all, None).unwrap();
            let z = vec![0.0; all.len()];
            let (h, _) = sum(&assemble(&problem.blocks, &answers), &point.prior(&strut), &z);
            // The clearance of a stop that is never touched shows nowhere.
            let h = h + DMatrix::identity(all.len(), all.len()) * 1e-9;
            h.try_inverse().unwrap()[(offset, offset)].sqrt()
        };
        let (one_side, both_sides) = (
            deviation(&problem.evaluation),
            deviation(&problem.evaluation.from_both_sides()),
        );
        // One is what the tolerance says.
        assert!(
            one_side < 0.3 && both_sides > 0.8 && both_sides < 1.001,
            "{one_side} {both_sides}"
        );
    }

    #[test]
    fn the_same_name_gives_the_same_bits() {
        let bits = |g: &Generated| {
            g.recordings[3].columns[1]
                .iter()
                .map(|v| v.to_bits())
                .collect::<Vec<_>>()
        };
        let wanted = [(EffectId::SealFriction, 1.0)];
        let (a, b) = (
            generate("test:bits", &wanted, &[], None).unwrap(),
            generate("test:bits", &wanted, &[], None).unwrap(),
        );
        assert_eq!(bits(&a), bits(&b));
        assert_eq!(a.truth, b.truth);
    }

    #[test]
    fn effects_have_the_size_asked_for() {
        for id in [
            EffectId::SealFriction,
            EffectId::OilCompressibility,
            EffectId::SensorGain,
            EffectId::LineResistance,
            EffectId::ValveDelay,
        ] {
            let g = generate(&format!("test:size:{id}"), &[(id, 1.0)], &[], None).unwrap();
            assert!((g.sizes[0] - 1.0).abs() < 0.1, "{id}: {:?} {:?}", g.sizes, g.truth);
        }
    }

    #[test]
    fn sensors_read_with_the_stated_noise() {
        let g = generate("test:noise", &[], &[], None).unwrap();
        for r in &g.recordings {
            // Before anything moves only noise and offset change a reading.
            let rest = r.time_s.partition_point(|t| *t < 0.25).max(4);
            for (c, noise) in [(0, 5e-6), (1, 12.0), (2, 4e3), (5, 4e3)] {
                let values = &r.columns[c][..rest];
                let mean = values.iter().sum::<f64>() / rest as f64;
                let sd = (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (rest - 1) as f64).sqrt();
                let (low, high) = if rest > 50 { (0.7, 1.4) } else { (0.1, 3.0) };
                assert!(
                    r.name.starts_with("road") || (sd > low * noise && sd < high * noise),
                    "{} {c} {sd}",
                    r.name
                );
            }
        }
    }
}
