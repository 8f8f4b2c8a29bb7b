//! What to record when two effects cannot be told apart, or when something is left that nothing explains: the excitation
//! in which they differ most, with amplitude, speed and valve state.

use crate::locate::Location;
use crate::specimen::{Candidate, Specimen, SpecimenKind};
use crate::vocabulary::{EffectId, Site, State};

/// One sentence: amplitude, speed, valve state.
#[must_use]
pub fn separate(kind: SpecimenKind, a: &Candidate, b: &Candidate) -> String {
    let how = if kind == SpecimenKind::TwoStageStrut {
        strut(a, b)
    } else {
        other(a, b)
    };
    format!("To separate {} from {}: {how}.", a.name(), b.name())
}

fn strut(a: &Candidate, b: &Candidate) -> &'static str {
    let is = |x: EffectId, y: EffectId| (a.id == x && b.id == y) || (a.id == y && b.id == x);
    let any = |x: EffectId| a.id == x || b.id == x;
    if is(EffectId::OilCompressibility, EffectId::MountCompliance) {
        "sines of 5 mm at 0.5 m/s with all valves closed, once about the static position and once about 60 mm of jounce: the mount \
         stays as stiff, the oil column shortens"
    } else if is(EffectId::OilCompressibility, EffectId::EntrainedAir) {
        "a sawtooth from -80 mm to 60 mm at 5 mm/s, valve 3 closed, valves 1 and 2 open: air shows below 1 MPa only"
    } else if is(EffectId::SealFriction, EffectId::SideLoadFriction) {
        "the same triangle of 10 mm at 5 mm/s about -60, 0 and 60 mm, all valves open: side-load friction follows the force, the \
         seal's does not"
    } else if is(EffectId::SealFriction, EffectId::AccumulatorPistonFriction) {
        "a triangle of 10 mm at 5 mm/s, all valves open, force, p1 and p2 recorded: the seal's hysteresis is in the force only, the \
         piston's in p1 and p2 too"
    } else if any(EffectId::GasHeatTransfer) {
        "steps of 50 mm at 0.3 m/s held for 30 s, valves 1 and 2 open, once with valve 3 open and once closed: heat relaxes over \
         seconds, friction and a late instrument do not, a leak goes on until the pressures are equal"
    } else if is(EffectId::RealGas, EffectId::GasChargeError) {
        "a sawtooth over the whole travel at 5 mm/s up to 12 MPa, valve 3 closed, valve 1 open: the real gas departs with pressure, \
         the charge does not"
    } else if any(EffectId::ValveTransition) || any(EffectId::ValveDelay) {
        "steps of each valve at pressure differences of 0.2, 2 and 6 MPa (30 mm at 0.02, 0.1 and 0.3 m/s before the edge), sampled at \
         1 kHz or faster"
    } else if any(EffectId::LineResistance) || any(EffectId::DamperLeakage) || any(EffectId::DampingFade) {
        "sines of 25 mm at 0.05, 0.2 and 0.8 m/s, valves 1 and 2 closed, valve 3 open, each for 60 s: leakage shows at low, resistance \
         at high speed, fade over time"
    } else if any(EffectId::SensorLag) || any(EffectId::SensorSkew) || any(EffectId::SensorGain) {
        "both columns from one calibrated reference: a ramp of 50 mm at 0.5 m/s with all valves open for the time, three held levels \
         20 mm apart for the gain"
    } else {
        "triangles of 20 and 80 mm, each at 5 mm/s and at 0.5 m/s, in all four states of valves 1 and 3, valve 2 open"
    }
}

fn other(a: &Candidate, b: &Candidate) -> &'static str {
    if a.is_instrument_fault() || b.is_instrument_fault() {
        "the same stroke at a tenth and at twice the speed (no valves): what is late by a time grows with speed, what is physics need not"
    } else if a.place.site == Site::MainSeal && b.place.site == Site::MainSeal {
        "strokes of full travel at a tenth and at ten times the speed, each at the lowest and the highest pressure: viscous \
         friction follows the speed, a seal's does not, and what grows with pressure does so at every speed"
    } else {
        "steps of a third of the volume at the fastest speed, held until the pressure rests, and the same stroke over 10 minutes"
    }
}

/// What to record about a misfit that nothing explains: its own condition, one thing changed at a time.
#[must_use]
pub fn isolate(specimen: &dyn Specimen, left: &Location) -> String {
    let r = left.recording;
    let place = format!(
        "What is left unexplained is largest in {} of {}, {:.2} to {:.2} s ({}).",
        specimen.channels()[left.channel].column,
        specimen.recording_name(r),
        left.t_s[0],
        left.t_s[1],
        left.condition.text
    );
    if left.condition.decays {
        return format!(
            "{place} Record the step before it alone, held ten times as long ({:.0} s), in both directions, at once and half the \
             amplitude and at once and a tenth of the speed{}.",
            10.0 * (left.t_s[1] - left.t_s[0]),
            valves(specimen, r, left.t_s).map_or(String::new(), |v| format!(", {v}"))
        );
    }
    let time = specimen.time_s(r);
    let within: Vec<usize> = (0..time.len())
        .filter(|&k| time[k] >= left.t_s[0] && time[k] <= left.t_s[1])
        .collect();
    let states = specimen.states(r);
    let series = |state: State| states.iter().find(|s| s.state == state).map(|s| &s.values);
    let mut how = Vec::new();
    if let Some(x) = series(State::Displacement) {
        let (low, high) = within
            .iter()
            .fold((f64::MAX, f64::MIN), |(a, b), &k| (a.min(x[k]), b.max(x[k])));
        how.push(format!("from {:.0} to {:.0} mm", 1e3 * low, 1e3 * high));
    }
    if let Some(v) = series(State::Speed) {
        let fastest = within.iter().fold(0.0_f64, |m, &k| m.max(v[k].abs()));
        let speeds = [0.3, 1.0, 3.0].map(|f| oleo_report::significant(f * fastest, 2));
        how.push(format!("at {} m/s in turn", speeds.join(", ")));
    }
    how.push(valves(specimen, r, left.t_s).unwrap_or_else(|| "everything else as it was".into()));
    format!(
        "{place} Record that stretch alone: strokes {}, each twice.",
        how.join(", ")
    )
}

/// Valves as they are in the middle of a stretch, and the other way round.
fn valves(specimen: &dyn Specimen, recording: usize, t_s: [f64; 2]) -> Option<String> {
    let time = specimen.time_s(recording);
    let middle = time
        .partition_point(|t| *t < 0.5 * (t_s[0] + t_s[1]))
        .min(time.len() - 1);
    let valves = specimen.settings(recording, middle);
    (!valves.is_empty()).then(|| format!("with {}, then each valve the other way round", valves.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_proposal_for_a_strut_has_amplitude_speed_and_valve_state() {
        let candidate = |id: EffectId| Candidate {
            id,
            place: Site::Unknown.into(),
            label: String::new(),
            parameters: vec![],
            starts: vec![],
            group: None,
            untestable: None,
        };
        let ids = crate::specimen::strut::TERMS;
        for a in ids {
            for b in ids {
                let text = separate(SpecimenKind::TwoStageStrut, &candidate(a), &candidate(b));
                for needed in [" mm", " m/s", "valve"] {
                    // Slow triangles are given in mm/s.
                    let there = text.contains(needed) || (needed == " m/s" && text.contains(" mm/s"));
                    assert!(there, "{needed}: {text}");
                }
            }
        }
    }
}
