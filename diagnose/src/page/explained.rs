//! The fitted law drawn over the residual that it explains, as a function of the state that it follows.
//!
//! For a friction that only the load cell sees, that residual needs no model: it is the recorded force less the area of the piston
//! times the recorded pressure. Elsewhere it is the recording less what the model predicts without the effect.

use oleo_plant_sim::strut::LawArgument;
use oleo_report::{Axis, Curves, Page, Style};

use super::effects;
use super::shown::{brief, scaled, title};
use crate::diagnosis::Diagnosis;
use crate::locate::{self, Location};
use crate::specimen::{Series, Specimen};
use crate::vocabulary::{Column, Site, SpecimenKind, State};

/// Largest number of markers in a figure of the residual over a state.
const MARKERS: usize = 1200;
/// Number of stretches of the state over which the law is averaged, with equally many samples each.
const BINS: usize = 60;
/// Fewest samples of a stretch.
const FEWEST: usize = 4;

pub(super) fn over_state(page: &mut Page, specimen: &dyn Specimen, diagnosis: &Diagnosis, location: &Location) {
    let condition = &location.condition;
    let name = match (of_law(diagnosis, location), &condition.region, &condition.follows) {
        _ if of_seal(specimen, location) => State::Speed,
        (Some(state), ..) => state,
        (None, Some(region), _) => region.state,
        (None, None, Some((state, _))) => *state,
        // Time says it: a decay needs no second picture.
        (None, None, None) if condition.decays => return,
        (None, None, None) => State::Displacement,
    };
    let every = specimen.samples().div_ceil(MARKERS).max(1);
    let Some(state) = locate::states(specimen, every).into_iter().find(|s| s.state == name) else {
        return;
    };
    let (quantity, unit) = name.quantity_and_unit();
    let (scale, unit) = scaled(unit);
    let x: Vec<f64> = state.values.iter().map(|v| scale * v).collect();
    let seen = Seen::of(specimen, diagnosis, location, every);
    let mut curves = Curves::new(
        &format!(
            "{}: {} over {quantity}, all recordings",
            title(specimen.kind(), diagnosis, location),
            seen.what
        ),
        Axis::new(quantity, unit),
    );
    curves.panel(Axis::new(&seen.quantity, seen.unit));
    curves.series(Style::Points, &seen.points_name, &brief(&x), &brief(&seen.points));
    let mut caption = String::new();
    if let Some(law) = &seen.law {
        let (at, mean) = averaged(&x, law);
        curves.series(Style::Line, "the fitted effect", &brief(&at), &brief(&mean));
        caption += "The line is the mean of what the fitted effect gives in the samples of its neighbourhood. ";
    }
    caption += &seen.caption;
    if let Some(region) = condition.region.as_ref().filter(|region| region.state == name) {
        curves.region(scale * region.from, scale * region.to, "found here");
        caption += &format!(
            " The shaded range contains the most misfit relative to its number of samples: {}.",
            region.words()
        );
    } else if let Some((_, part)) = condition.follows.as_ref().filter(|(state, _)| *state == name) {
        caption += &format!(
            " The mean residual as a function of {quantity} explains {:.0} % of {}.",
            100.0 * part,
            if location.candidate.is_some() {
                "what the effect changes"
            } else {
                "the residual"
            }
        );
    }
    curves.caption(caption.trim());
    page.figure(curves);
}

/// The state that a law without a name was fitted over.
fn of_law(diagnosis: &Diagnosis, location: &Location) -> Option<State> {
    let effect =
        (diagnosis.effects.iter()).find(|e| location.candidate.is_some() && e.candidate() == location.candidate)?;
    match effects::law(effect)?.depends_on {
        LawArgument::Displacement => Some(State::Displacement),
        LawArgument::Speed => Some(State::Speed),
        LawArgument::Acceleration => Some(State::Acceleration),
        LawArgument::P1 => Some(State::P1),
        _ => None,
    }
}

/// Whether the effect acts between the pressure in the main chamber and the load cell.
fn of_seal(specimen: &dyn Specimen, location: &Location) -> bool {
    location.candidate.is_some()
        && location.place.site == Site::MainSeal
        && specimen.kind() == SpecimenKind::TwoStageStrut
        && specimen.channels()[location.channel].column == Column::FORCE
}

/// What is drawn over the state.
struct Seen {
    /// In the title: "residual of p1_Pa".
    what: String,
    quantity: String,
    unit: &'static str,
    points_name: String,
    points: Vec<f64>,
    /// What the fitted effect gives in the same samples.
    law: Option<Vec<f64>>,
    caption: String,
}

impl Seen {
    fn of(specimen: &dyn Specimen, diagnosis: &Diagnosis, location: &Location, every: usize) -> Self {
        if of_seal(specimen, location)
            && let Some(seen) = Self::beside_pressure(specimen, diagnosis, every)
        {
            return seen;
        }
        let c = location.channel;
        let channel = &specimen.channels()[c];
        let (scale, unit) = units(channel.column.unit());
        let pooled = |set: &[Series]| -> Vec<f64> {
            let of = |(r, own): (usize, &Series)| specimen.in_units(r, c, &own[c]).into_iter().step_by(every);
            set.iter().enumerate().flat_map(of).map(|e| scale * e).collect()
        };
        let (without, with) = (pooled(&location.without), pooled(&diagnosis.residuals.improved));
        let found = location.candidate.is_some();
        Self {
            what: format!("residual of {}", channel.column),
            quantity: "Residual".to_owned(),
            unit,
            points_name: if found {
                "recording less model without it".to_owned()
            } else {
                "recording less improved model".to_owned()
            },
            law: found.then(|| {
                without
                    .iter()
                    .zip(&with)
                    .map(|(without, with)| without - with)
                    .collect()
            }),
            points: without,
            caption: String::new(),
        }
    }

    /// Force less piston area times p1, as recorded and as the improved model has it.
    fn beside_pressure(specimen: &dyn Specimen, diagnosis: &Diagnosis, every: usize) -> Option<Self> {
        let position = |column: Column| specimen.channels().iter().position(|c| c.column == column);
        let (force, p1) = (position(Column::FORCE)?, position(Column::known("p1_Pa"))?);
        let area_m2 = piston_area_m2(&diagnosis.given_toml)?;
        let (mut points, mut law) = (Vec::new(), Vec::new());
        for r in 0..specimen.recordings().len() {
            let (f, p) = (specimen.measured(r, force), specimen.measured(r, p1));
            let left = |c: usize| specimen.in_units(r, c, &diagnosis.residuals.improved[r][c]);
            let (left_of_force, left_of_p1) = (left(force), left(p1));
            for k in (0..f.len()).step_by(every) {
                if (f[k] - p[k]).is_nan() {
                    continue;
                }
                points.push(f[k] - area_m2 * p[k]);
                law.push(f[k] - left_of_force[k] - area_m2 * (p[k] - left_of_p1[k]));
            }
        }
        Some(Self {
            what: "force less A p1".to_owned(),
            quantity: "Force less A p1".to_owned(),
            unit: "N",
            points_name: "recorded".to_owned(),
            points,
            law: Some(law),
            caption: format!(
                "The points are the recorded force less the piston area ({} cm2) times the recorded pressure, without any model.",
                oleo_report::significant(1e4 * area_m2, 3)
            ),
        })
    }
}

/// Factor and unit in which people read a quantity; the unit outlives the column.
fn units(unit: &str) -> (f64, &'static str) {
    match unit {
        "Pa" => (1e-3, "kPa"),
        "m" => (1e3, "mm"),
        "N" => (1.0, "N"),
        _ => (1.0, ""),
    }
}

/// The area of the piston that a model file gives by its bore, m2.
fn piston_area_m2(model_toml: &str) -> Option<f64> {
    let model: toml::Table = model_toml.parse().ok()?;
    let bore_m = model.get("cylinder")?.get("bore_m")?.as_float()?;
    Some(0.25 * std::f64::consts::PI * bore_m * bore_m)
}

/// Means of `y` over stretches of `x` with equally many samples each; none of them crosses zero, where frictions step.
fn averaged(x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut pairs: Vec<(f64, f64)> = (x.iter().copied().zip(y.iter().copied()))
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = (pairs.len() / BINS).max(FEWEST);
    let (negative, positive) = pairs.split_at(pairs.partition_point(|(x, _)| *x < 0.0));
    let (mut at, mut mean) = (Vec::new(), Vec::new());
    for stretch in negative
        .chunks(size)
        .chain(positive.chunks(size))
        .filter(|stretch| stretch.len() >= FEWEST)
    {
        let n = stretch.len() as f64;
        at.push(stretch.iter().map(|(x, _)| x).sum::<f64>() / n);
        mean.push(stretch.iter().map(|(_, y)| y).sum::<f64>() / n);
    }
    (at, mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_at_zero_is_kept_and_noise_is_averaged() {
        let x: Vec<f64> = (-600..600).map(|i| 0.01 * f64::from(i)).collect();
        let y: Vec<f64> = (x.iter().enumerate())
            .map(|(i, x)| 100.0 * x.signum() + if i % 2 == 0 { 20.0 } else { -20.0 })
            .collect();
        let (at, mean) = averaged(&x, &y);
        assert_eq!(at.len(), BINS);
        assert!(
            at.iter()
                .zip(&mean)
                .all(|(at, mean)| (mean - 100.0 * at.signum()).abs() < 1e-9)
        );
    }

    #[test]
    fn the_area_is_that_of_the_bore() {
        let area_m2 = piston_area_m2("[cylinder]\nbore_m = 0.05\n").expect("a bore");
        assert!((area_m2 - 1.963_495e-3).abs() < 1e-9);
        assert_eq!(piston_area_m2("[cylinder]\n"), None);
    }
}
