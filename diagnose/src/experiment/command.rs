//! An experiment as a command: displacement and switching signals over time, to be given to an actuator and a valve driver.
//!
//! The numbers are those of the experiments' texts ([`crate::effect::Experiment`]); a test compares the two.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use crate::vocabulary::EffectId;

/// Speed at which the next part's start is approached, mm/s.
const APPROACH_MM_S: f64 = 20.0;
/// Rest between parts, s.
const PAUSE_S: f64 = 2.0;
/// Points of a cycle of a sine.
const POINTS_A_CYCLE: u32 = 40;
/// Duration of a change of a switching signal in the trace, s: no time on any recorder.
const EDGE_S: f64 = 1e-4;
/// A ramp is longer than this, s.
const LEAST_RAMP_S: f64 = 1e-9;

/// A motion of the actuator, in mm and mm/s from the static position, jounce positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Straight strokes to `about` plus and minus the amplitude.
    Triangles {
        about: f64,
        amplitude: f64,
        speed: f64,
        count: u32,
    },
    /// Sines with this largest speed.
    Sines {
        about: f64,
        amplitude: f64,
        speed: f64,
        count: u32,
    },
    /// A ramp to a position, held for some seconds.
    Step { to: f64, speed: f64, hold_s: f64 },
}

/// A motion with the switching signals during it; `None` for what the text says of them in words only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// What the actuator does.
    pub motion: Motion,
    /// Signals of valves 1 to 3, true for open.
    pub valves: Option<[bool; 3]>,
}

/// The command over time: straight between its points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Time of each point, s.
    pub time_s: Vec<f64>,
    /// Displacement, m, jounce positive.
    pub displacement_m: Vec<f64>,
    /// Signals of valves 1 to 3, true for open; as many as there are points, or none.
    pub valves: Vec<[bool; 3]>,
}

/// The experiment in which an effect of a strut shows; `travel_mm` is the range that "the whole travel" means. `None` for effects that
/// no strut has.
pub fn of_strut(id: EffectId, travel_mm: [f64; 2]) -> Option<Vec<Part>> {
    use EffectId as E;
    let (all, none) = ([true; 3], [false; 3]);
    let part = |motion, valves| Part {
        motion,
        valves: Some(valves),
    };
    let sines = |about, amplitude, speed, count| Motion::Sines {
        about,
        amplitude,
        speed,
        count,
    };
    let triangles = |about, amplitude, speed, count| Motion::Triangles {
        about,
        amplitude,
        speed,
        count,
    };
    let step = |to, speed, hold_s| Motion::Step { to, speed, hold_s };
    let [low, high] = travel_mm;
    let whole = |speed| triangles(0.5 * (low + high), 0.5 * (high - low), speed, 2);
    Some(match id {
        E::OilCompressibility | E::MountCompliance => {
            vec![
                part(sines(0.0, 5.0, 500.0, 30), none),
                part(sines(60.0, 5.0, 500.0, 30), none),
            ]
        }
        E::EntrainedAir => vec![part(triangles(-10.0, 70.0, 5.0, 1), [true, true, false])],
        E::GasHeatTransfer => [all, [true, true, false]]
            .into_iter()
            .flat_map(|valves| {
                [
                    part(step(50.0, 300.0, 30.0), valves),
                    part(step(0.0, 300.0, 30.0), valves),
                ]
            })
            .collect(),
        E::RealGas => vec![part(whole(5.0), [true, false, false])],
        E::GasChargeError => vec![
            part(triangles(0.0, 60.0, 5.0, 1), [true, false, true]),
            part(triangles(0.0, 60.0, 5.0, 1), [true, false, false]),
        ],
        E::SealFriction | E::SideLoadFriction => [-60.0, 0.0, 60.0]
            .into_iter()
            .map(|about| part(triangles(about, 10.0, 5.0, 2), all))
            .collect(),
        E::AccumulatorPistonFriction => vec![part(triangles(0.0, 10.0, 5.0, 2), all)],
        E::DamperLeakage => [50.0, 200.0, 800.0]
            .into_iter()
            .map(|speed| part(sines(0.0, 25.0, speed, 5), [false, false, true]))
            .collect(),
        E::LineResistance => [50.0, 200.0, 800.0]
            .into_iter()
            .map(|speed| part(sines(0.0, 25.0, speed, 5), all))
            .collect(),
        E::LineInertance => [100.0, 300.0, 600.0]
            .into_iter()
            .map(|speed| part(sines(0.0, 5.0, speed, 10), all))
            .collect(),
        E::ValveDelay | E::ValveTransition => valve_steps(),
        E::Valve3Leakage => vec![part(step(30.0, 100.0, 60.0), [true, true, false])],
        E::BumpStop => vec![part(whole(5.0), all), part(whole(200.0), all)],
        E::DampingFade => {
            let minute = part(sines(0.0, 25.0, 800.0, 306), [false, false, true]);
            vec![minute, part(step(0.0, 20.0, 600.0), [false, false, true]), minute]
        }
        E::SensorLag | E::SensorSkew => vec![part(step(50.0, 500.0, 5.0), all)],
        E::SensorDrift => vec![
            part(step(0.0, 20.0, 600.0), all),
            part(step(50.0, 500.0, 0.0), all),
            part(step(0.0, 500.0, 600.0), all),
        ],
        E::SensorSign => vec![part(step(50.0, 50.0, 1.0), all)],
        E::SensorGain => [-20.0, 0.0, 20.0]
            .into_iter()
            .map(|level| part(step(level, 500.0, 5.0), all))
            .collect(),
        E::Unlisted => [(20.0, 5.0), (20.0, 500.0), (80.0, 5.0), (80.0, 500.0)]
            .into_iter()
            .flat_map(|(amplitude, speed)| {
                [(false, false), (false, true), (true, false), (true, true)]
                    .map(|(one, three)| part(triangles(0.0, amplitude, speed, 1), [one, true, three]))
            })
            .collect(),
        _ => return None,
    })
}

/// Each valve is closed while the strut is driven, at three speeds for three pressure differences, and opens when it stops.
fn valve_steps() -> Vec<Part> {
    let mut parts = Vec::new();
    for valve in 0..3 {
        for speed in [20.0, 100.0, 300.0] {
            let mut closed = [true; 3];
            closed[valve] = false;
            for (to, valves, hold_s) in [(30.0, closed, 0.0), (30.0, [true; 3], 1.0), (0.0, [true; 3], 1.0)] {
                parts.push(Part {
                    motion: Motion::Step { to, speed, hold_s },
                    valves: Some(valves),
                });
            }
        }
    }
    parts
}

impl Trace {
    /// The parts one after the other, from the static position and back to it.
    #[must_use]
    pub fn of(parts: &[Part]) -> Self {
        let mut trace = Self::default();
        let with_valves = parts.iter().all(|part| part.valves.is_some());
        let mut valves = parts.first().and_then(|part| part.valves);
        trace.point(0.0, 0.0, valves.filter(|_| with_valves));
        trace.hold(PAUSE_S);
        for (index, part) in parts.iter().enumerate() {
            if let Motion::Triangles { about, .. } | Motion::Sines { about, .. } = part.motion {
                if index > 0 {
                    trace.hold(PAUSE_S);
                }
                trace.ramp(about, APPROACH_MM_S);
            }
            if with_valves && part.valves != valves {
                valves = part.valves;
                trace.point(trace.end_s() + EDGE_S, trace.end_mm(), valves);
            }
            trace.motion(part.motion);
        }
        trace.hold(PAUSE_S);
        trace.ramp(0.0, APPROACH_MM_S);
        trace
    }

    fn motion(&mut self, motion: Motion) {
        match motion {
            Motion::Triangles {
                about,
                amplitude,
                speed,
                count,
            } => {
                for _ in 0..count {
                    self.ramp(about + amplitude, speed);
                    self.ramp(about - amplitude, speed);
                    self.ramp(about, speed);
                }
            }
            Motion::Sines {
                about,
                amplitude,
                speed,
                count,
            } => {
                let (begin_s, period_s) = (self.end_s(), TAU * amplitude / speed);
                for k in 1..=count * POINTS_A_CYCLE {
                    let cycles = |k| f64::from(k) / f64::from(POINTS_A_CYCLE);
                    // Each cycle ends where it began, to the last bit.
                    let x = about + amplitude * libm::sin(TAU * cycles(k % POINTS_A_CYCLE));
                    self.point(begin_s + cycles(k) * period_s, x, self.valves.last().copied());
                }
            }
            Motion::Step { to, speed, hold_s } => {
                self.ramp(to, speed);
                self.hold(hold_s);
            }
        }
    }

    fn ramp(&mut self, to_mm: f64, speed_mm_s: f64) {
        let takes_s = (to_mm - self.end_mm()).abs() / speed_mm_s;
        // What is left of rounding is no way to go.
        if takes_s > LEAST_RAMP_S {
            self.point(self.end_s() + takes_s, to_mm, self.valves.last().copied());
        }
    }

    fn hold(&mut self, seconds: f64) {
        if seconds > 0.0 {
            self.point(self.end_s() + seconds, self.end_mm(), self.valves.last().copied());
        }
    }

    fn point(&mut self, time_s: f64, displacement_mm: f64, valves: Option<[bool; 3]>) {
        self.time_s.push(time_s);
        self.displacement_m.push(1e-3 * displacement_mm);
        self.valves.extend(valves);
    }

    fn end_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or(0.0)
    }

    fn end_mm(&self) -> f64 {
        self.displacement_m.last().map_or(0.0, |x| 1e3 * x)
    }

    /// The command as a CSV file with the columns of a recording.
    #[must_use]
    pub fn csv(&self) -> String {
        let valves = !self.valves.is_empty();
        let mut csv = String::from(if valves {
            "time_s,displacement_m,valve1,valve2,valve3\n"
        } else {
            "time_s,displacement_m\n"
        });
        for (i, (time_s, x)) in self.time_s.iter().zip(&self.displacement_m).enumerate() {
            // Writing to a string does not fail.
            let _ = write!(csv, "{time_s:.4},{x:.7}");
            if let Some(open) = self.valves.get(i) {
                let [a, b, c] = open.map(u8::from);
                let _ = write!(csv, ",{a},{b},{c}");
            }
            csv.push('\n');
        }
        csv
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::of;
    use crate::vocabulary::SpecimenKind;
    use strum::VariantArray;

    const TRAVEL_MM: [f64; 2] = [-90.0, 80.0];

    /// Whether a text gives a length or a speed: with its unit, or as one of a list.
    fn says(text: &str, value: f64) -> bool {
        let written = format!("{value}");
        text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'))
            .any(|word| word == written)
    }

    #[test]
    fn the_command_of_an_effect_has_the_numbers_of_its_text() {
        for id in EffectId::VARIANTS {
            let text = of(*id).experiment_in(SpecimenKind::TwoStageStrut).map(|e| e.record);
            let parts = of_strut(*id, TRAVEL_MM);
            assert_eq!(text.is_some(), parts.is_some(), "{id}");
            let (Some(text), Some(parts)) = (text, parts) else {
                continue;
            };
            for part in parts {
                let (lengths, speed) = match part.motion {
                    // A sawtooth is given by its ends.
                    Motion::Triangles {
                        about,
                        amplitude,
                        speed,
                        ..
                    } if text.contains("sawtooth from") => (vec![about - amplitude, about + amplitude], speed),
                    Motion::Triangles { speed, .. } if text.contains("whole travel") => (vec![], speed),
                    Motion::Triangles { amplitude, speed, .. } | Motion::Sines { amplitude, speed, .. } => {
                        (vec![amplitude], speed)
                    }
                    // Back to where it came from, or a rest, is not said.
                    Motion::Step { to: 0.0, .. } => continue,
                    Motion::Step { to, speed, .. } => (vec![to.abs()], speed),
                };
                assert!(lengths.iter().all(|mm| says(text, *mm)), "{id}: {lengths:?} in {text}");
                assert!(says(text, speed) || says(text, 1e-3 * speed), "{id}: {speed} in {text}");
            }
        }
    }

    #[test]
    fn a_trace_keeps_its_speeds_and_comes_back() {
        let parts = of_strut(EffectId::SealFriction, TRAVEL_MM).expect("an effect of a strut");
        let trace = Trace::of(&parts);
        assert!(trace.time_s.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(
            (trace.displacement_m[0], trace.displacement_m.last()),
            (0.0, Some(&0.0))
        );
        let slowest_first = trace.displacement_m.iter().copied().fold(0.0, f64::min);
        assert!((slowest_first + 0.07).abs() < 1e-12);
        assert_eq!(trace.valves.len(), trace.time_s.len());
        assert!(
            trace
                .csv()
                .starts_with("time_s,displacement_m,valve1,valve2,valve3\n0.0000,0.0000000,1,1,1\n")
        );
        let leak = Trace::of(&of_strut(EffectId::DamperLeakage, TRAVEL_MM).expect("an effect of a strut"));
        let fastest = (leak.time_s.windows(2).zip(leak.displacement_m.windows(2)))
            .map(|(t, x)| ((x[1] - x[0]) / (t[1] - t[0])).abs())
            .fold(0.0, f64::max);
        assert!((fastest - 0.8).abs() < 0.01, "{fastest}");
    }
}
