//! A specimen for tests: two outputs that are known functions of one input, candidates whose merits are known, and seeded
//! noise. It needs no recording, and a whole search on it takes milliseconds.
//!
//! What is believed: the first output is a stiffness times the displacement, the second a damping times the speed. Each has a
//! tolerance. What is true is that and whatever laws a test adds.

use std::sync::atomic::AtomicBool;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::effect::{Candidate, ExclusionGroup, Joins};
use crate::parameter::{Beside, Parameter};
use crate::recording::Recording;
use crate::specimen::{Channel, Hypothesis, Series, Specimen, StateSeries};
use crate::vocabulary::{Column, EffectId, Place, Site, SpecimenKind, State};

/// A flag that never asks the fit to stop.
pub static RUN: AtomicBool = AtomicBool::new(false);

/// A force that grows with the cube of the displacement; one number.
pub const CUBIC: usize = 0;
/// Nearly the same law, `x |x|^2.02`; one number.
pub const NEARLY_CUBIC: usize = 1;
/// A force of constant size against the motion; one number.
pub const FRICTION: usize = 2;
/// A vibration of the second output: amplitude and circular frequency. Its cost has a local minimum every 0.1 rad/s, so that
/// only a start near the true frequency finds it.
pub const VIBRATION: usize = 3;
/// Forty sines of fixed frequencies in both outputs: they fit any noise, and predict none.
pub const FORTY_SINES: usize = 4;
/// A wrong gain of the first output's instrument; one number.
pub const GAIN: usize = 5;
/// A law without a name: force over displacement as a table of eight numbers. It can take the shape of the cubic.
pub const TABLE: usize = 6;
/// A model that does not exist above 1; one number. It changes nothing else.
pub const FRAGILE: usize = 7;
/// Friction of each output with a number of its own: the same effect as [`FRICTION`] in more places.
pub const FRICTION_OF_BOTH: usize = 8;
/// A vibration of the first output at 5 rad/s; one number.
pub const FIRST_OF_PAIR: usize = 9;
/// Nearly the opposite, with a little of another vibration: where both are true, either alone explains 2.5 % of the misfit.
pub const SECOND_OF_PAIR: usize = 10;

/// A law without a name: a friction of the first output whose level swings; amplitude, phase (rad) and frequency (Hz).
pub const SWING: usize = 11;
/// A vibration of the first output that is 200 times weaker before [`LATE_FROM_S`]: what is before says next to nothing of its one number.
pub const LATE: usize = 12;

/// A vibration of the first output at 3 rad/s, whose phase is a number of the model; one number. With the phase that is believed it explains nothing.
pub const PHASED: usize = 13;
/// A vibration of the first output at 7 rad/s; one number.
pub const OTHER_TONE: usize = 14;
/// The vibrations of [`FIRST_OF_PAIR`] and [`OTHER_TONE`] with a little of a third; one number. Where both are true it explains nearly all, and more than either alone.
pub const IMITATION: usize = 15;
/// The phase that is true beyond the one that is believed, rad.
const PHASE: f64 = std::f64::consts::FRAC_PI_2;

/// When the late vibration begins.
const LATE_FROM_S: f64 = 60.0;

/// Frequency of the vibration, rad/s.
pub const FREQUENCY: f64 = 2.3;
/// Ends of the table's pieces.
const TABLE_M: [f64; 8] = [-1.5, -1.0, -0.7, -0.35, 0.35, 0.7, 1.0, 1.5];
/// Stiffness and damping that are believed.
const BELIEVED: [f64; 2] = [2.0, 1.5];
/// Standard deviation of each output's noise.
const NOISE: [f64; 2] = [0.05, 0.04];

/// How a specimen is made.
#[derive(Clone)]
pub struct Recipe {
    /// Seed of the noise.
    pub seed: u64,
    /// Laws that are true and not believed, with their numbers.
    pub truth: Vec<(usize, Vec<f64>)>,
    /// Number of recordings; each moves differently.
    pub recordings: usize,
    /// Samples of each recording, at 20 Hz.
    pub samples: usize,
    /// Correlation of neighbouring samples of the noise; 0 is white.
    pub colour: f64,
    /// Candidates that the search may use.
    pub candidates: Vec<usize>,
    /// True if leaving out folds is computed instead of approximated.
    pub cheap: bool,
}

impl Default for Recipe {
    fn default() -> Self {
        Self {
            seed: 1,
            truth: vec![],
            recordings: 3,
            samples: 800,
            colour: 0.0,
            candidates: vec![CUBIC, NEARLY_CUBIC, FRICTION, VIBRATION, FORTY_SINES, GAIN],
            cheap: false,
        }
    }
}

/// The specimen.
pub struct Analytic {
    recordings: Vec<Recording>,
    channels: Vec<Channel>,
    calibration: Vec<Parameter>,
    candidates: Vec<Candidate>,
    cheap: bool,
}

impl Analytic {
    /// Starting points of a candidate beside its own.
    pub fn give_starts(&mut self, candidate: usize, starts: Vec<Vec<f64>>) {
        self.candidates[candidate].starts = starts;
    }

    /// Makes a candidate a law without a name at a place.
    pub fn take_name(&mut self, candidate: usize, site: Site) {
        let candidate = &mut self.candidates[candidate];
        (candidate.id, candidate.place, candidate.one_of_several) = (EffectId::Unlisted, site.into(), true);
    }

    /// Makes a candidate a fault of an instrument.
    pub fn become_fault(&mut self, candidate: usize, column: Column) {
        let candidate = &mut self.candidates[candidate];
        (candidate.id, candidate.place) = (EffectId::SensorGain, Site::Sensor(column).into());
    }

    /// Makes a candidate a number of the model that is other than believed.
    pub fn become_number(&mut self, candidate: usize) {
        let candidate = &mut self.candidates[candidate];
        (candidate.id, candidate.one_of_several) = (EffectId::Unlisted, false);
        candidate.is_believed_number = true;
    }

    /// Puts a candidate in the place of a calibration value.
    pub fn replace(&mut self, candidate: usize, calibration: &'static str) {
        self.candidates[candidate].replaces = Some(calibration);
    }

    /// Gives a candidate's first parameter another key.
    pub fn take_key(&mut self, candidate: usize, key: &str) {
        key.clone_into(&mut self.candidates[candidate].parameters[0].key);
    }

    /// Makes a candidate one that joins a model at another time.
    pub fn become_joining(&mut self, candidate: usize, joins: Joins) {
        self.candidates[candidate].joins = joins;
    }

    /// Makes the phase of [`PHASED`] a number of the model that matters only beside it.
    pub fn let_phase_sleep(&mut self) {
        self.calibration.push(Parameter {
            lower: -4.0,
            upper: 4.0,
            only_beside: Some(Beside::anywhere(EffectId::GasHeatTransfer)),
            ..Parameter::calibration("phase", 2.0)
        });
    }

    /// Lets the stiffness be told by one recording alone.
    pub fn tie_stiffness_to(&mut self, recording: usize) {
        self.calibration[0].only_in = Some(recording);
    }

    /// Another start of a candidate's first parameter.
    pub fn move_start(&mut self, candidate: usize, start: f64) {
        self.candidates[candidate].parameters[0].start = start;
    }
}

impl Recipe {
    /// Makes the specimen: simulates the truth and adds noise.
    pub fn make(&self) -> Analytic {
        let mut candidates: Vec<Candidate> = (0..=IMITATION).map(candidate).collect();
        for (k, c) in candidates.iter_mut().enumerate() {
            if !self.candidates.contains(&k) {
                c.untestable = Some("not part of this test".to_owned());
            }
        }
        let mut specimen = Analytic {
            recordings: (0..self.recordings).map(|r| motion(r, self.samples)).collect(),
            channels: (0..2)
                .map(|c| Channel {
                    column: column(c),
                    noise: NOISE[c],
                })
                .collect(),
            calibration: vec![
                Parameter::calibration("stiffness", 0.02),
                Parameter::calibration("damping", 0.02),
            ],
            candidates,
            cheap: self.cheap,
        };
        let truth = Hypothesis {
            calibration: vec![0.004, -0.006],
            effects: self.truth.clone(),
        };
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        for r in 0..self.recordings {
            let simulated = specimen.simulate(&truth, r).expect("the truth exists");
            let mut shown = specimen.observe(&truth, r, &simulated);
            for (series, noise) in shown.iter_mut().zip(NOISE) {
                add_noise(series, noise, self.colour, &mut random);
            }
            specimen.recordings[r].columns.extend(shown);
        }
        specimen
    }
}

/// Adds normal noise; neighbours are correlated by `colour`, the standard deviation stays as it is.
fn add_noise(series: &mut [f64], deviation: f64, colour: f64, random: &mut ChaCha8Rng) {
    let fresh = (1.0 - colour * colour).sqrt();
    let mut state: f64 = StandardNormal.sample(random);
    for value in series {
        let drawn: f64 = StandardNormal.sample(random);
        state = colour * state + fresh * drawn;
        *value += deviation * state;
    }
}

/// A displacement of three sines, other ones for each recording.
fn motion(recording: usize, samples: usize) -> Recording {
    let time_s: Vec<f64> = (0..samples).map(|k| 0.05 * k as f64).collect();
    let base = 0.9 + 0.17 * recording as f64;
    let x = |t: &f64| 0.8 * libm::sin(base * t) + 0.4 * libm::sin(2.71 * base * t) + 0.25 * libm::sin(0.31 * base * t);
    Recording {
        name: format!("motion {}", recording + 1),
        columns: vec![time_s.iter().map(x).collect()],
        time_s,
        notes: vec![],
    }
}

fn column(channel: usize) -> Column {
    Column::known(["force_N", "resistance_N"][channel])
}

fn candidate(index: usize) -> Candidate {
    let amount = |key: &str| Parameter::departure(key, 0.05, (-5.0, 5.0));
    let positive = |key: &str| Parameter::amount(key, 0.05, 5.0);
    let (id, place, parameters): (EffectId, Place, Vec<Parameter>) = match index {
        CUBIC => (EffectId::MountCompliance, Site::Mount.into(), vec![amount("cubic")]),
        NEARLY_CUBIC => (EffectId::RealGas, Site::Chamber.into(), vec![amount("nearly_cubic")]),
        FRICTION => (
            EffectId::SealFriction,
            Site::MainSeal.into(),
            vec![positive("coulomb_force_N")],
        ),
        VIBRATION => (
            EffectId::LineInertance,
            Site::EndStop.into(),
            vec![
                amount("amplitude"),
                Parameter::linear("frequency", 1.0, 0.05, (0.5, 4.0)),
            ],
        ),
        FORTY_SINES => (
            EffectId::OilCompressibility,
            Site::Unknown.into(),
            (0..40).map(|k| amount(&format!("sine_{k}"))).collect(),
        ),
        GAIN => (
            EffectId::SensorGain,
            Site::Sensor(column(0)).into(),
            vec![Parameter::departure("relative_error", 0.01, (-0.6, 0.6)).on_instrument()],
        ),
        TABLE => (
            EffectId::Unlisted,
            Site::MainChamber.into(),
            TABLE_M.map(|x| amount(&format!("at_{x}"))).to_vec(),
        ),
        SWING => (
            EffectId::Unlisted,
            Site::MainSeal.into(),
            vec![
                positive("amplitude_N"),
                Parameter::linear("phase_rad", 0.0, 0.3, (-9.0, 9.0)),
                Parameter::linear("frequency_Hz", 1.0, 0.01, (1e-3, 9.0)),
            ],
        ),
        FRAGILE => (EffectId::BumpStop, Site::EndStop.into(), vec![positive("stress")]),
        FIRST_OF_PAIR => (EffectId::DampingFade, Site::Mount.into(), vec![amount("first")]),
        LATE => (EffectId::ValveDelay, Site::Mount.into(), vec![amount("late")]),
        PHASED => (
            EffectId::GasHeatTransfer,
            Site::Mount.into(),
            // It begins with a size, without which a phase says nothing.
            vec![Parameter::linear("phased", 0.1, 0.05, (-5.0, 5.0))],
        ),
        OTHER_TONE => (EffectId::LineResistance, Site::Mount.into(), vec![amount("other")]),
        IMITATION => (EffectId::GasChargeError, Site::Mount.into(), vec![amount("both")]),
        SECOND_OF_PAIR => (EffectId::EntrainedAir, Site::Mount.into(), vec![amount("second")]),
        _ => (
            EffectId::SealFriction,
            Site::MainSeal.into(),
            vec![positive("first_N"), positive("second_N")],
        ),
    };
    Candidate {
        group: (id == EffectId::SealFriction).then_some(ExclusionGroup(EffectId::SealFriction)),
        label: match index {
            TABLE => "force over displacement".into(),
            SWING => "friction over time, periodic".into(),
            _ => String::new(),
        },
        starts: vec![],
        takes_from: None,
        replaces: None,
        becomes: None,
        one_of_several: id == EffectId::Unlisted,
        is_believed_number: false,
        joins: Joins::Screened,
        oscillates: index == SWING,
        untestable: None,
        id,
        place,
        parameters,
    }
}

/// What a law adds to the two outputs at a time, a displacement and a speed.
fn law(index: usize, v: &[f64], t: f64, x: f64, speed: f64) -> Result<[f64; 2], String> {
    let direction = libm::tanh(speed / 0.02);
    Ok(match index {
        CUBIC => [v[0] * x * x * x, 0.0],
        NEARLY_CUBIC => [v[0] * x * libm::pow(x.abs(), 2.02), 0.0],
        FRICTION => [v[0] * direction, v[0] * direction],
        VIBRATION => [0.0, v[0] * libm::sin(v[1] * t)],
        FORTY_SINES => {
            let sines: f64 = (v.iter().enumerate())
                .map(|(k, c)| c * libm::sin((5.0 + 0.71 * k as f64) * t))
                .sum();
            [sines, -sines]
        }
        TABLE => [
            v.iter()
                .zip(TABLE_M)
                .map(|(c, at)| c * (1.0 - (x - at).abs() / 0.4).max(0.0))
                .sum(),
            0.0,
        ],
        SWING => [
            v[0] * libm::sin(std::f64::consts::TAU * v[2] * t + v[1]) * direction,
            0.0,
        ],
        FRAGILE if v[0] > 1.0 => return Err("broken".to_owned()),
        FRICTION_OF_BOTH => [v[0] * direction, v[1] * direction],
        FIRST_OF_PAIR => [v[0] * libm::sin(5.0 * t), 0.0],
        OTHER_TONE => [v[0] * libm::sin(7.0 * t), 0.0],
        IMITATION => {
            let tones = libm::sin(5.0 * t) + libm::sin(7.0 * t) + 0.38 * libm::sin(9.0 * t);
            [v[0] * tones, 0.0]
        }
        LATE => {
            let part = if t < LATE_FROM_S { 0.02 } else { 4.0 };
            [v[0] * part * libm::sin(5.0 * t), 0.0]
        }
        SECOND_OF_PAIR => [-v[0] * (0.95 * libm::sin(5.0 * t) + 0.31 * libm::sin(7.0 * t)), 0.0],
        _ => [0.0, 0.0],
    })
}

/// Speed by central differences.
fn speed(recording: &Recording) -> Vec<f64> {
    let (t, x) = (&recording.time_s, &recording.columns[0]);
    let last = x.len() - 1;
    (0..x.len())
        .map(|k| {
            let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
            (x[b] - x[a]) / (t[b] - t[a])
        })
        .collect()
}

impl Specimen for Analytic {
    fn kind(&self) -> SpecimenKind {
        SpecimenKind::Cylinder
    }

    fn recordings(&self) -> &[Recording] {
        &self.recordings
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn calibration(&self) -> &[Parameter] {
        &self.calibration
    }

    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    fn simulations_at_once(&self) -> usize {
        12
    }

    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, String> {
        let r = &self.recordings[recording];
        let mut out = vec![Vec::with_capacity(r.len()), Vec::with_capacity(r.len())];
        for ((&t, &x), speed) in r.time_s.iter().zip(&r.columns[0]).zip(speed(r)) {
            let c = &hypothesis.calibration;
            let stiffness_matters = self.calibration[0].only_in.is_none_or(|only| only == recording);
            let stiffer = if stiffness_matters { c[0] } else { 0.0 };
            let mut y = [BELIEVED[0] * (1.0 + stiffer) * x, BELIEVED[1] * (1.0 + c[1]) * speed];
            for (index, values) in &hypothesis.effects {
                let added = match (*index, c.get(2)) {
                    (PHASED, phase) => [values[0] * libm::sin(3.0 * t + phase.copied().unwrap_or(PHASE)), 0.0],
                    _ => law(*index, values, t, x, speed)?,
                };
                y = [y[0] + added[0], y[1] + added[1]];
            }
            out.iter_mut().zip(y).for_each(|(series, y)| series.push(y));
        }
        Ok(out)
    }

    fn observe(&self, hypothesis: &Hypothesis, _recording: usize, truth: &Series) -> Series {
        let mut shown = truth.clone();
        for (_, values) in hypothesis.effects.iter().filter(|(index, _)| *index == GAIN) {
            shown[0].iter_mut().for_each(|y| *y *= 1.0 + values[0]);
        }
        shown
    }

    fn model_toml(&self, _hypothesis: &Hypothesis) -> Result<String, String> {
        Ok(String::new())
    }

    fn states(&self, recording: usize) -> Vec<StateSeries> {
        let r = &self.recordings[recording];
        vec![
            StateSeries::new(State::Displacement, r.columns[0].clone()),
            StateSeries::new(State::Speed, speed(r)),
        ]
    }

    fn inputs_in_words(&self) -> &'static str {
        "displacement"
    }

    fn simulates_in_milliseconds(&self) -> bool {
        self.cheap
    }
}
