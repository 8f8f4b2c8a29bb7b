//! What the actuator plays and what the instruments would read: displacement and switching signals in, force and
//! pressures out, in the columns of a recording.

use oleo_interface::{StrutValves, Valve};

use crate::model_file::InvalidValue;
use crate::strut::{Inputs, Motion, Segment, StrutModel, replay};

/// A displacement history with its switching signals. Compression positive, m from the static position.
#[derive(Debug, Clone, PartialEq)]
pub struct Programme {
    time_s: Vec<f64>,
    motion: Motion,
    signals: Vec<StrutValves<bool>>,
}

impl Programme {
    /// Straight moves through `corners_m` at one speed, lasting `duration_s` in all, sampled about every `interval_s`; each corner
    /// falls on a sample. The first corner is where it starts.
    #[must_use]
    pub fn sawtooth(corners_m: &[f64], duration_s: f64, interval_s: f64, signals: StrutValves<bool>) -> Self {
        let path_m: f64 = corners_m.windows(2).map(|leg| (leg[1] - leg[0]).abs()).sum();
        let speed = path_m / duration_s;
        let start_m = corners_m.first().copied().unwrap_or(0.0);
        let (mut time_s, mut segments) = (vec![0.0], Vec::new());
        let mut began_s = 0.0;
        for leg in corners_m.windows(2) {
            let (rise_m, lasts_s) = (leg[1] - leg[0], (leg[1] - leg[0]).abs() / speed);
            let count = (lasts_s / interval_s).round().max(1.0);
            for i in 1..=count as usize {
                let share = i as f64 / count;
                time_s.push(began_s + lasts_s * share);
                let slope = speed.copysign(rise_m);
                segments.push(Segment {
                    to_m: leg[0] + rise_m * share,
                    from_m_s: slope,
                    to_m_s: slope,
                });
            }
            began_s += lasts_s;
        }
        Self::new(time_s, Motion { start_m, segments }, signals)
    }

    /// `cycles` of `amplitude_m sin(2 pi f t)` with `per_cycle` samples each, from the static position.
    #[must_use]
    pub fn sine(
        amplitude_m: f64,
        frequency_hz: f64,
        cycles: usize,
        per_cycle: usize,
        signals: StrutValves<bool>,
    ) -> Self {
        let step = 1.0 / (frequency_hz * per_cycle as f64);
        let turn = std::f64::consts::TAU / per_cycle as f64;
        let speed_m_s = amplitude_m * std::f64::consts::TAU * frequency_hz;
        let count = cycles * per_cycle;
        let time_s = (0..=count).map(|i| step * i as f64).collect();
        // The phase is taken within its cycle, so that every cycle has the same samples to the last bit.
        let phase = |i: usize| turn * (i % per_cycle) as f64;
        let segments = (1..=count).map(|i| Segment {
            to_m: amplitude_m * libm::sin(phase(i)),
            from_m_s: speed_m_s * libm::cos(phase(i - 1)),
            to_m_s: speed_m_s * libm::cos(phase(i)),
        });
        let motion = Motion {
            start_m: 0.0,
            segments: segments.collect(),
        };
        Self::new(time_s, motion, signals)
    }

    /// Any displacement `law(time_s) -> (m, m/s)` for `duration_s`, sampled every `interval_s`.
    #[must_use]
    pub fn from_law(
        law: impl Fn(f64) -> (f64, f64),
        duration_s: f64,
        interval_s: f64,
        signals: StrutValves<bool>,
    ) -> Self {
        let count = (duration_s / interval_s).round() as usize;
        let time_s: Vec<f64> = (0..=count).map(|i| interval_s * i as f64).collect();
        let segments = time_s.windows(2).map(|pair| {
            let ((_, from_m_s), (to_m, to_m_s)) = (law(pair[0]), law(pair[1]));
            Segment { to_m, from_m_s, to_m_s }
        });
        let motion = Motion {
            start_m: law(0.0).0,
            segments: segments.collect(),
        };
        Self::new(time_s, motion, signals)
    }

    /// Switches one valve at a time (s), from there to the end; the edge falls on the next sample.
    #[must_use]
    pub fn switched(mut self, valve: Valve, open: bool, at_s: f64) -> Self {
        for (time_s, signals) in self.time_s.iter().zip(&mut self.signals) {
            if *time_s >= at_s - 1e-9 {
                signals[valve] = open;
            }
        }
        self
    }

    fn new(time_s: Vec<f64>, motion: Motion, signals: StrutValves<bool>) -> Self {
        let signals = vec![signals; time_s.len()];
        Self {
            time_s,
            motion,
            signals,
        }
    }

    /// Times of the samples, s.
    #[must_use]
    pub fn time_s(&self) -> &[f64] {
        &self.time_s
    }

    /// Switching signals at each sample, true for open.
    #[must_use]
    pub fn signals(&self) -> &[StrutValves<bool>] {
        &self.signals
    }

    /// Displacement at each sample, m.
    #[must_use]
    pub fn displacement_m(&self) -> Vec<f64> {
        std::iter::once(self.motion.start_m)
            .chain(self.motion.segments.iter().map(|segment| segment.to_m))
            .collect()
    }

    /// Speed just before each sample (just after the first), m/s.
    #[must_use]
    pub fn speed_m_s(&self) -> Vec<f64> {
        let first = self.motion.segments.first().map_or(0.0, |segment| segment.from_m_s);
        std::iter::once(first)
            .chain(self.motion.segments.iter().map(|segment| segment.to_m_s))
            .collect()
    }
}

/// What was played and what the instruments read.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Times of the samples, s.
    pub time_s: Vec<f64>,
    /// Actuator displacement, m, compression positive.
    pub displacement_m: Vec<f64>,
    /// Speed of the actuator, m/s, positive in jounce.
    pub speed_m_s: Vec<f64>,
    /// Load cell, N, compression positive.
    pub force_n: Vec<f64>,
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [Vec<f64>; 4],
    /// Switching signals at each sample, true for open.
    pub signals: Vec<StrutValves<bool>>,
}

impl Record {
    /// The columns of a recording, in its order and with its names.
    #[must_use]
    pub fn columns(&self) -> Vec<(&'static str, Vec<f64>)> {
        let signal = |valve: Valve| {
            let signal: Vec<f64> = self
                .signals
                .iter()
                .map(|signals| f64::from(u8::from(signals[valve])))
                .collect();
            (valve.column(), signal)
        };
        let [p1, p2, p3, p4] = self.pressure_pa.clone();
        vec![
            ("time_s", self.time_s.clone()),
            ("displacement_m", self.displacement_m.clone()),
            ("force_N", self.force_n.clone()),
            ("p1_Pa", p1),
            ("p2_Pa", p2),
            ("p3_Pa", p3),
            ("p4_Pa", p4),
            signal(Valve::Bypass1),
            signal(Valve::Bypass2),
            signal(Valve::Spring),
        ]
    }
}

/// Plays a programme on the second-generation strut, at rest before.
///
/// # Errors
/// Impossible values in the model.
pub fn play(model: &StrutModel, programme: &Programme) -> Result<Record, InvalidValue> {
    let inputs = Inputs {
        time_s: programme.time_s.clone(),
        motion: programme.motion.clone(),
        signals: programme.signals.clone(),
    };
    let read = replay(model, &inputs)?;
    Ok(Record {
        time_s: inputs.time_s,
        displacement_m: programme.displacement_m(),
        speed_m_s: programme.speed_m_s(),
        force_n: read.force_n,
        pressure_pa: read.pressure_pa,
        signals: inputs.signals,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sawtooth_has_its_corners_on_samples_and_one_speed() {
        let saw = Programme::sawtooth(
            &[0.0, 0.04, -0.1, 0.04, 0.0],
            300.0,
            0.05,
            StrutValves::from_array([true; 3]),
        );
        let x = saw.displacement_m();
        for corner in [0.04, -0.1] {
            assert!(x.contains(&corner), "{corner}");
        }
        let last = saw.time_s().len() - 1;
        assert!((saw.time_s()[last] - 300.0).abs() < 1e-9 && x[last] == 0.0);
        assert!(
            saw.speed_m_s()
                .iter()
                .all(|speed| (speed.abs() - 0.36 / 300.0).abs() < 1e-12)
        );
    }

    #[test]
    fn cycles_of_a_sine_are_the_same_samples() {
        let sine = Programme::sine(0.025, 1.3, 3, 40, StrutValves::from_array([true; 3]));
        let x = sine.displacement_m();
        assert_eq!(x[..40], x[40..80]);
        assert!((x[10] - 0.025).abs() < 1e-15 && x[20].abs() < 1e-15);
        assert!((sine.speed_m_s()[0] - 0.025 * std::f64::consts::TAU * 1.3).abs() < 1e-12);
    }

    #[test]
    fn an_edge_acts_from_its_sample_on() {
        let closed = StrutValves::default();
        let still = Programme::from_law(|_| (0.0, 0.0), 1.0, 0.1, closed).switched(Valve::Spring, true, 0.5);
        let spring = |sample: usize| still.signals()[sample][Valve::Spring];
        assert!(!spring(4) && spring(5) && spring(10));
        assert!(still.signals().iter().all(|signals| !signals[Valve::Bypass1]));
    }
}
