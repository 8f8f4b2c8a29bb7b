//! The report's conclusions from its figures 8 and 9, as statements that a sweep meets or does not meet.

use super::sweep::Surface;

/// One statement of the report, and whether the sweep agrees with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What the report says (section 3.2).
    pub report: &'static str,
    /// What the sweep shows, with its figures.
    pub found: String,
    /// Whether the sweep agrees with the statement.
    pub met: bool,
    /// Whether it is one of the report's conclusions, which `--check` tests; otherwise it is an observation that is only shown.
    pub conclusion: bool,
}

/// Roll counts as insensitive to the damper factor if its spread over the factors is below this fraction of its spread over
/// the whole grid.
const INSENSITIVE: f64 = 0.25;

/// Checks the conclusions of section 3.2 on a swept grid.
pub fn findings(surface: &Surface) -> Vec<Finding> {
    let cells = || {
        let volumes = surface.gas_volumes_m3.iter().enumerate();
        volumes.flat_map(|(i, v)| {
            surface
                .damper_factors
                .iter()
                .enumerate()
                .map(move |(j, f)| (i, j, *v, *f))
        })
    };
    let mut list = Vec::new();

    let rms = |i: usize, j: usize| surface.ride[i][j].mean_rms_m_s2();
    let best = cells()
        .filter(|&(i, j, ..)| surface.ride[i][j].completed)
        .min_by(|a, b| rms(a.0, a.1).total_cmp(&rms(b.0, b.1)));
    if let Some((i, j, volume, factor)) = best {
        list.push(Finding {
            report: "lowest acceleration with low damping (damper scale factor of 0.8) ...",
            found: format!("lowest mean weighted RMS {:.3} m/s2 at factor {factor}", rms(i, j)),
            met: factor <= 0.8 + 1e-9,
            conclusion: true,
        });
        list.push(Finding {
            report: "... and soft springs (static gas volume > 0.5 liters)",
            found: format!("lowest mean weighted RMS at {:.2} l", 1e3 * volume),
            met: volume > 5e-4 + 1e-12,
            conclusion: true,
        });
    }

    let soft = surface.gas_volumes_m3.len().saturating_sub(1);
    let half = surface
        .gas_volumes_m3
        .iter()
        .position(|v| *v >= 5e-4 - 1e-12)
        .unwrap_or(soft);
    let sick = |i: usize| surface.ride[i].first().map_or(f64::NAN, |ride| ride.mean_msdv_m_s1_5());
    if half < soft {
        list.push(Finding {
            report: "motion sickness values do however increase with very soft springs",
            found: format!(
                "motion sickness dose at factor {}: {:.2} m/s^1.5 at {:.1} l, {:.2} at {:.1} l",
                surface.damper_factors[0],
                sick(half),
                1e3 * surface.gas_volumes_m3[half],
                sick(soft),
                1e3 * surface.gas_volumes_m3[soft]
            ),
            met: sick(soft) > sick(half),
            conclusion: true,
        });
    }

    let roll = |i: usize, j: usize| surface.handling[i][j].max_roll_rad.to_degrees();
    let done = |i: usize, j: usize| surface.handling[i][j].completed;
    let least = cells()
        .filter(|&(i, j, ..)| done(i, j))
        .min_by(|a, b| roll(a.0, a.1).total_cmp(&roll(b.0, b.1)));
    if let Some((i, j, volume, _)) = least {
        list.push(Finding {
            report: "smallest body roll angle with the stiffest spring (static gas volume of 0.01 liter)",
            found: format!("smallest roll angle {:.2} degrees at {:.3} l", roll(i, j), 1e3 * volume),
            met: i == 0,
            conclusion: true,
        });
    }
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        })
    };
    let mut spread = 0.0;
    let mut rows = 0.0;
    for i in 0..surface.gas_volumes_m3.len() {
        let mut row = (0..surface.damper_factors.len())
            .filter(|&j| done(i, j))
            .map(|j| roll(i, j));
        let (low, high) = range(&mut row);
        if high >= low {
            spread += high - low;
            rows += 1.0;
        }
    }
    let (low, high) = range(&mut cells().filter(|&(i, j, ..)| done(i, j)).map(|(i, j, ..)| roll(i, j)));
    if rows > 0.0 && high > low {
        let over_factors = spread / rows;
        list.push(Finding {
            report: "the roll angle is insensitive to the damper scale factor",
            found: format!(
                "mean spread over the damper factors {over_factors:.2} degrees, spread over the whole grid {:.2} degrees",
                high - low
            ),
            met: over_factors < INSENSITIVE * (high - low),
            conclusion: true,
        });
    }
    let gaps = cells().filter(|&(i, j, ..)| !done(i, j)).count();
    let rolled = cells().filter(|&(i, j, ..)| surface.handling[i][j].rolled_over).count();
    list.push(Finding {
        report: "gaps in the graph are where the vehicle could not complete the lane change without rolling over",
        found: format!("{gaps} gaps, of which {rolled} are roll-overs"),
        met: gaps > 0 && gaps == rolled,
        conclusion: false,
    });
    list
}
