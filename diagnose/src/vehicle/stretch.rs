//! The parts of the drives that are used, and why.
//!
//! A simulation needs the state of the strut at its beginning, which is known where a drive begins at rest, and is fitted where the strut's file
//! says that drives do not. A part of a drive is always its beginning, without a stretch in which nothing has moved yet. Hours of data add little to the first
//! minutes of those drives that move the struts fastest, farthest, and with most switchings of valve 3; these are used.

use oleo_interface::{Corner, Corners, Valve};

use super::bridge::{Bridged, LONGEST_BRIDGE_S, samples_in};
use crate::recording::{MIN_SAMPLES, Recording};

/// Most samples of a corner that are used: two minutes at 5 ms. An hour of log is then diagnosed in about as long as a test-rig campaign.
const MOST_SAMPLES: usize = 24_000;
/// Samples that a drive contributes before others are asked: 40 s at 5 ms, several times the thermal time constants of the gas.
const FIRST_SHARE: usize = 8_000;
/// Standing still is kept for this long before a drive moves, s.
const KEPT_STILL_S: f64 = 0.5;
/// A displacement this far from its first value has moved, m: far beyond noise and steps of the bus.
const MOVED_M: f64 = 1e-4;
/// Samples by which the beginning of a later drive is judged.
const BEGINNING: usize = 20;
/// A later drive begins at rest at this displacement of the first one, m, and at this fraction of its pressure.
const SAME_REST: (f64, f64) = (1e-3, 0.02);
/// Largest difference of two pressures at rest, Pa, beside the one with which the first drive begins.
const EQUAL_PA: f64 = 1e4;
/// Gauge pressures that a sensor with an error of its zero shows near vacuum, Pa. One of the wrong sign shows far less.
const NEAR_VACUUM_PA: std::ops::Range<f64> = -3e5..-5e4;
/// Column of p1 in the recording of a strut.
const P1: usize = 1;

/// A drive whose gaps are bridged.
pub struct BridgedDrive {
    /// Name of the drive.
    pub name: String,
    /// Whether the drive is the first of its log.
    pub is_first: bool,
    /// Time between two samples, s.
    pub period_s: f64,
    /// The struts; `None` of one without a displacement.
    pub struts: Corners<Option<Bridged>>,
}

/// What a drive excites.
#[derive(Debug, Clone, Copy, Default)]
struct Excitation {
    /// RMS of the strut speed over all corners, m/s.
    speed_m_s: f64,
    /// Largest range of displacement of any strut, m.
    range_m: f64,
    /// Number of switchings of valve 3 at all corners.
    spring_edges: usize,
}

impl Excitation {
    fn of(drive: &BridgedDrive, from: usize, samples: usize) -> Self {
        let (mut square, mut count, mut out) = (0.0, 0, Self::default());
        for strut in drive.struts.values().flatten() {
            let end = (from + samples).min(strut.displacement_m.len());
            let x = &strut.displacement_m[from.min(end)..end];
            // Over two samples, so that a step of the bus is no speed.
            for step in x.windows(3).map(|w| w[2] - w[0]).filter(|step| step.is_finite()) {
                square += step * step;
                count += 1;
            }
            let (low, high) = x.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
            out.range_m = out.range_m.max(high - low);
            out.spring_edges += (strut.valves[from.min(end)..end].windows(2))
                .filter(|w| w[0][Valve::Spring] != w[1][Valve::Spring])
                .count();
        }
        out.speed_m_s = (square / count.max(1) as f64).sqrt() / (2.0 * drive.period_s);
        out
    }
}

/// The used recordings of every corner, and what a reader must know of the choice.
pub struct Chosen {
    /// Recordings with the columns of a strut in a vehicle.
    pub recordings: Corners<Vec<Recording>>,
    /// What was used and what was not, one sentence each.
    pub notes: Vec<String>,
}

/// A drive of which something may be used.
struct Usable<'d> {
    drive: &'d BridgedDrive,
    /// The first sample that is used.
    from: usize,
    begins_at_rest: bool,
}

/// Chooses what is used of all drives. Of a drive that does not begin at rest only those struts are used of which that is not expected.
#[must_use]
pub fn choose(drives: &[BridgedDrive], starts_at_rest: &Corners<bool>) -> Chosen {
    let mut notes = Vec::new();
    let mut known: Vec<Usable<'_>> = Vec::new();
    let reference = drives.iter().find(|drive| drive.is_first);
    for drive in drives {
        let begins_at_rest = drive.is_first || reference.is_some_and(|first| begins_as(first, drive));
        if begins_at_rest || !starts_at_rest.values().all(|&at_rest| at_rest) {
            let kept_still = samples_in(KEPT_STILL_S, drive.period_s);
            known.push(Usable {
                drive,
                from: moves_from(drive).saturating_sub(kept_still),
                begins_at_rest,
            });
        } else {
            notes.push(format!(
                "{}: not used, because it does not begin at rest, so that the state of the struts at its beginning is not known.",
                drive.name
            ));
        }
    }
    let lengths: Vec<usize> = known
        .iter()
        .map(|usable| length(usable.drive).saturating_sub(usable.from))
        .collect();
    let excitation: Vec<Excitation> = (known.iter().zip(&lengths))
        .map(|(usable, n)| Excitation::of(usable.drive, usable.from, (*n).min(FIRST_SHARE)))
        .collect();
    let used = shares(&lengths, &excitation);
    let mut recordings = Corners::from_fn(|_| Vec::new());
    for ((usable, share), (excited, whole)) in known.iter().zip(&used).zip(excitation.iter().zip(&lengths)) {
        let Usable {
            drive,
            from,
            begins_at_rest,
        } = usable;
        if *share < MIN_SAMPLES {
            let why = if *whole < MIN_SAMPLES {
                "it is too short"
            } else {
                "the drives used move the struts more"
            };
            notes.push(format!("{}: not used, because {why}.", drive.name));
            continue;
        }
        let of = |samples: usize| samples as f64 * drive.period_s;
        notes.push(format!(
            "{}: {:.1} s of {:.1} s are used, from {:.1} s on (RMS strut speed {:.3} m/s, range {:.0} mm, {} switchings of valves 3{}).",
            drive.name,
            of(*share),
            of(length(drive)),
            of(*from),
            excited.speed_m_s,
            1e3 * excited.range_m,
            excited.spring_edges,
            if share < whole { "; more would add little" } else { "" },
        ));
        for corner in Corner::ALL {
            if starts_at_rest[corner] && !begins_at_rest {
                notes.push(format!(
                    "{}: not used for the {} strut, because it does not begin at rest, as the strut's file says that it does.",
                    drive.name,
                    corner.name()
                ));
                continue;
            }
            let long_enough =
                (drive.struts[corner].as_ref()).filter(|strut| strut.displacement_m.len() >= from + MIN_SAMPLES);
            let recorded = long_enough.map(|strut| recording(drive, strut, *from, *share));
            let useless = match recorded {
                Some(recording) if !is_empty(&recording.columns[P1]) => {
                    recordings[corner].push(recording);
                    None
                }
                Some(_) => Some("whose main chamber is empty: p1 is near vacuum for most of the time"),
                None => Some("whose readings are missing"),
            };
            notes
                .extend(useless.map(|why| format!("{}: not used for the {} strut, {why}.", drive.name, corner.name())));
            notes.extend(
                drive.struts[corner]
                    .as_ref()
                    .and_then(|strut| bridged(drive, corner, strut)),
            );
        }
    }
    Chosen { recordings, notes }
}

/// Whether the main chamber of a strut is empty of oil for most of the time, so that nothing tells how much is left.
fn is_empty(chamber_pa: &[f64]) -> bool {
    let read = chamber_pa.iter().filter(|pa| pa.is_finite());
    let near_vacuum = read.clone().filter(|pa| NEAR_VACUUM_PA.contains(pa)).count();
    2 * near_vacuum > read.count()
}

/// What was missing at a corner, and what became of it.
fn bridged(drive: &BridgedDrive, corner: Corner, strut: &Bridged) -> Option<String> {
    let mut parts = Vec::new();
    if strut.missing > 0 {
        parts.push(format!("{} displacements are missing", strut.missing));
    }
    if strut.without_command > 0 {
        parts.push(format!("{} ticks have no command", strut.without_command));
    }
    if let Some(at) = strut.cut_at {
        parts.push(format!(
            "the drive was cut at {:.2} s, where more than {} readings in a row are missing",
            at as f64 * drive.period_s,
            samples_in(LONGEST_BRIDGE_S, drive.period_s)
        ));
    }
    (!parts.is_empty()).then(|| format!("{}, {}: {}.", drive.name, corner.name(), parts.join("; ")))
}

/// Samples of the longest strut of a drive.
fn length(drive: &BridgedDrive) -> usize {
    drive
        .struts
        .values()
        .flatten()
        .map(|s| s.displacement_m.len())
        .max()
        .unwrap_or(0)
}

/// The first sample at which a strut has moved or a valve was switched.
fn moves_from(drive: &BridgedDrive) -> usize {
    let of_strut = |strut: &Bridged| {
        let moved = strut
            .displacement_m
            .iter()
            .position(|x| (x - strut.displacement_m[0]).abs() > MOVED_M);
        let switched = strut.valves.iter().position(|v| *v != strut.valves[0]);
        let end = strut.displacement_m.len();
        moved.unwrap_or(end).min(switched.unwrap_or(end))
    };
    drive.struts.values().flatten().map(of_strut).min().unwrap_or(0)
}

/// Whether a later drive begins at rest as the first one does: still, at the same displacement and pressures.
fn begins_as(first: &BridgedDrive, later: &BridgedDrive) -> bool {
    Corner::ALL.into_iter().all(|corner| {
        let (Some(a), Some(b)) = (&first.struts[corner], &later.struts[corner]) else {
            return first.struts[corner].is_none();
        };
        let mean = |series: &[f64]| {
            let known: Vec<f64> = series
                .iter()
                .take(BEGINNING)
                .copied()
                .filter(|v| v.is_finite())
                .collect();
            known.iter().sum::<f64>() / known.len().max(1) as f64
        };
        let x = mean(&b.displacement_m);
        let still = b
            .displacement_m
            .iter()
            .take(BEGINNING)
            .all(|v| v.is_nan() || (v - x).abs() < MOVED_M);
        let [p, q] = [a, b].map(|s| s.pressure_pa.each_ref().map(|p| mean(p)));
        let equal = (1..4).all(|k| ((q[k] - q[0]) - (p[k] - p[0])).abs() < EQUAL_PA);
        let same = (x - mean(&a.displacement_m)).abs() < SAME_REST.0 && (q[0] - p[0]).abs() < SAME_REST.1 * p[0].abs();
        b.from == 0 && still && equal && same
    })
}

/// Number of samples that are used of each drive.
fn shares(lengths: &[usize], excitation: &[Excitation]) -> Vec<usize> {
    let mut used = vec![0; lengths.len()];
    let mut left = MOST_SAMPLES;
    // The best by one figure, then the best of the others by the next, so that each kind of excitation is there.
    let figures: [fn(&Excitation) -> f64; 3] = [|e| e.speed_m_s, |e| e.range_m, |e| e.spring_edges as f64];
    let mut order: Vec<usize> = Vec::new();
    while order.len() < lengths.len() {
        let figure = figures[order.len() % figures.len()];
        let rest = (0..lengths.len()).filter(|k| !order.contains(k));
        // The first of equals.
        let best = rest
            .rev()
            .max_by(|a, b| figure(&excitation[*a]).total_cmp(&figure(&excitation[*b])));
        order.extend(best);
    }
    for limit in [FIRST_SHARE, usize::MAX] {
        for &k in order.iter().filter(|k| lengths[**k] >= MIN_SAMPLES) {
            let more = lengths[k].min(limit).saturating_sub(used[k]).min(left);
            // A few samples of a drive cost a simulation and show nothing.
            if used[k] > 0 || more >= lengths[k].min(FIRST_SHARE / 4) {
                used[k] += more;
                left -= more;
            }
        }
    }
    used
}

fn recording(drive: &BridgedDrive, strut: &Bridged, from: usize, samples: usize) -> Recording {
    let end = (from + samples).min(strut.displacement_m.len());
    let mut columns = vec![strut.displacement_m[from..end].to_vec()];
    columns.extend(strut.pressure_pa.iter().map(|p| p[from..end].to_vec()));
    let is_unknown = |k: usize| strut.switched_unseen.iter().any(|unseen| unseen.contains(&k));
    columns.extend(Valve::ALL.map(|valve| {
        (from..end)
            .map(|k| match strut.valves[k][valve] {
                _ if is_unknown(k) => f64::NAN,
                signal => f64::from(u8::from(signal)),
            })
            .collect()
    }));
    Recording {
        name: drive.name.clone(),
        time_s: (from..end).map(|k| (strut.from + k) as f64 * drive.period_s).collect(),
        columns,
        notes: vec![],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::StrutValves;
    use oleo_interface::tick::{TICK_S, TICKS_PER_SECOND};

    const AT_REST: Corners<bool> = Corners::from_array([true; 4]);

    /// A drive that stands still, then moves with an amplitude (m).
    fn drive(name: &str, is_first: bool, samples: usize, still: usize, amplitude_m: f64) -> BridgedDrive {
        let x = |k: usize| amplitude_m * libm::sin(0.3 * k.saturating_sub(still) as f64);
        let strut = Bridged {
            displacement_m: (0..samples).map(x).collect(),
            pressure_pa: std::array::from_fn(|_| vec![4e6; samples]),
            valves: vec![StrutValves::default(); samples],
            switched_unseen: vec![],
            from: 0,
            missing: 0,
            without_command: 0,
            cut_at: None,
        };
        BridgedDrive {
            name: name.into(),
            is_first,
            period_s: TICK_S,
            struts: Corners::from_fn(|_| Some(strut.clone())),
        }
    }

    #[test]
    fn hours_are_reduced_to_what_moves_most() {
        let hour = 3600 * TICKS_PER_SECOND as usize;
        let drives = [
            drive("smooth", true, hour, 0, 0.002),
            drive("rough", true, hour, 60_000, 0.02),
            drive("short", true, 10, 0, 0.02),
        ];
        let chosen = choose(&drives, &AT_REST);
        let used: Vec<(&str, usize)> = chosen.recordings[Corner::RearLeft]
            .iter()
            .map(|r| (r.name.as_str(), r.len()))
            .collect();
        assert_eq!(used.iter().map(|u| u.1).sum::<usize>(), MOST_SAMPLES);
        assert_eq!(
            (used[1].0, used[1].1),
            ("rough", MOST_SAMPLES - FIRST_SHARE),
            "{used:?}"
        );
        // What stands still for five minutes is left out, but for its end.
        assert!((chosen.recordings[Corner::RearLeft][1].time_s[0] - 299.5).abs() < 0.1);
        assert!(
            chosen.notes.iter().any(|n| n.starts_with("short: not used")),
            "{:?}",
            chosen.notes
        );
    }

    #[test]
    fn a_strut_without_oil_in_its_chamber_is_not_used_and_a_sensor_of_the_wrong_sign_is() {
        let with = |pa: f64| {
            let mut drive = drive("a", true, 4000, 200, 0.02);
            if let Some(strut) = &mut drive.struts[Corner::RearRight] {
                strut.pressure_pa[0].fill(pa);
            }
            let chosen = choose(&[drive], &AT_REST);
            let note = chosen.notes.iter().any(|note| note.contains("main chamber is empty"));
            (chosen.recordings[Corner::RearRight].len(), note)
        };
        assert_eq!(with(2e6), (1, false));
        assert_eq!(with(-1.4e5), (0, true));
        assert_eq!(with(-2e6), (1, false));
    }

    #[test]
    fn a_later_drive_is_used_if_it_begins_as_the_first() {
        let mut in_motion = drive("b", false, 4000, 0, 0.02);
        let names = |drives: &[BridgedDrive]| -> Vec<String> {
            choose(drives, &AT_REST).recordings[Corner::FrontLeft]
                .iter()
                .map(|r| r.name.clone())
                .collect()
        };
        let first = || drive("a", true, 4000, 50, 0.02);
        assert_eq!(names(&[first(), drive("b", false, 4000, 50, 0.02)]), ["a", "b"]);
        assert_eq!(names(&[first(), in_motion]), ["a"]);
        // One strut is expected to begin in motion, and the drive is used for it alone.
        let mut expected = AT_REST;
        expected[Corner::FrontRight] = false;
        let used = choose(&[first(), drive("b", false, 4000, 0, 0.02)], &expected).recordings;
        assert_eq!(
            [Corner::FrontLeft, Corner::FrontRight].map(|corner| used[corner].len()),
            [1, 2]
        );
        // Still, but the gas is warm or oil is trapped behind valve 3.
        in_motion = drive("b", false, 4000, 50, 0.02);
        if let Some(strut) = &mut in_motion.struts[Corner::RearRight] {
            strut.pressure_pa[3].fill(4.05e6);
        }
        assert_eq!(names(&[first(), in_motion]), ["a"]);
    }
}
