//! What a comparison says of one controller: its ride against the soft and the best fixed setting, its roll against the stiff setting
//! and the vehicle as sold, how soon it decides, and how often it is wrong.

use serde::Serialize;

use super::compare::Results;
use super::figures::Figures;
use super::plan::Group;
use super::setting::Setting;

/// Changes of its signal for which a solenoid valve is said to last: the least that makers of hydraulic cartridge valves give is
/// 1e7 (*assumed*).
pub const VALVE_LIFE_CHANGES: f64 = 1e7;

/// One group of drives: a figure for each setting, the mean over the seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Road, manoeuvre and speed.
    pub group: String,
    /// Name of the road.
    pub road: &'static str,
    /// In the order of the settings.
    pub by_setting: Vec<f64>,
}

/// A goal and what was reached.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Goal {
    /// What is asked, with the limit.
    pub goal: String,
    /// Where the worst value was.
    pub at: String,
    /// The worst value.
    pub value: f64,
    /// Its limit: the value must not be above it.
    pub limit: f64,
    /// Whether it is not.
    pub met: bool,
}

/// Scores of one controller.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scores {
    /// Weighted RMS at the seats over that with all valves open, the worst of classes C to E and Belgian block, straight ahead.
    pub ride_ratio_to_soft: f64,
    /// Weighted RMS over that of the best of the eight fixed settings for each road and speed, the worst of all.
    pub ride_ratio_to_best_fixed: f64,
    /// Peak roll over that with all valves closed, the worst manoeuvre on a flat road.
    pub roll_ratio_to_stiff: f64,
    /// Peak roll over that of the vehicle as sold, the worst manoeuvre on a flat road and on class C.
    pub roll_ratio_to_baseline: f64,
    /// Time from |a_y| > 0.5 m/s2 until it is taken for cornering or all valves are commanded closed, s: the worst drive on a flat road and on class C.
    pub decision_s: f64,
    /// Decisions for cornering a kilometre straight ahead, the worst road and speed.
    pub false_entries_per_km: f64,
    /// The same over all roads and speeds.
    pub false_entries_per_km_mean: f64,
    /// Changes of the valves' signals a kilometre straight ahead, one valve's mean over the corners, valves 1 to 3.
    pub valve_changes_per_km: [f64; 3],
    /// Kilometres after which the busiest of them reaches [`VALVE_LIFE_CHANGES`].
    pub valve_life_km: f64,
    /// Every goal of the project with what was reached.
    pub goals: Vec<Goal>,
}

/// Mean figures of every group, for every setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Means {
    /// Weighted RMS at the seats, m/s2, of the drives straight ahead.
    pub ride: Vec<Row>,
    /// Peak roll, degrees, of the manoeuvres.
    pub roll: Vec<Row>,
}

impl Means {
    /// Means over seeds.
    pub fn of(groups: &[Group], results: &Results) -> Self {
        let rows = |straight: bool, figure: fn(&Figures) -> f64| {
            groups
                .iter()
                .zip(results)
                .filter(|(group, _)| group.is_straight() == straight)
                .map(|(group, results)| Row {
                    group: group.name.clone(),
                    road: group.road,
                    by_setting: results.iter().map(|seeds| mean(seeds.iter().map(figure))).collect(),
                })
                .collect()
        };
        Self {
            ride: rows(true, |figures| figures.weighted_rms_m_s2),
            roll: rows(false, |figures| figures.peak_roll_deg),
        }
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// Geometric mean over rows of a setting's figure over another one's.
pub fn mean_ratio(rows: &[Row], setting: usize, reference: usize) -> f64 {
    let ratios = rows
        .iter()
        .map(|row| row.by_setting[setting] / row.by_setting[reference]);
    libm::exp(mean(ratios.map(libm::log)))
}

/// The worst of some values and where it was.
#[derive(Clone, Debug, Default)]
struct Worst {
    value: f64,
    at: String,
}

impl Worst {
    fn of<'a>(values: impl Iterator<Item = (&'a str, f64)>) -> Self {
        values.fold(Self::default(), |worst, (at, value)| {
            if worst.at.is_empty() || value > worst.value {
                Self { value, at: at.into() }
            } else {
                worst
            }
        })
    }

    /// The goal; `None` where nothing was driven that tells.
    fn goal(&self, goal: &str, limit: f64) -> Option<Goal> {
        (!self.at.is_empty()).then(|| Goal {
            goal: goal.into(),
            at: self.at.clone(),
            value: self.value,
            limit,
            met: self.value <= limit,
        })
    }
}

/// Places of the reference settings among the settings.
struct References {
    as_sold: usize,
    soft: usize,
    stiff: usize,
    fixed: Vec<usize>,
}

impl References {
    fn find(settings: &[Setting]) -> Option<Self> {
        let place = |wanted: &Setting| settings.iter().position(|setting| setting == wanted);
        Some(Self {
            as_sold: place(&Setting::AsSold)?,
            soft: place(&Setting::SOFT)?,
            stiff: place(&Setting::STIFF)?,
            fixed: Setting::all_fixed().iter().filter_map(place).collect(),
        })
    }
}

/// Scores of the setting at a place; `None` where the settings lack a reference or the place.
pub fn scores(
    groups: &[Group],
    settings: &[Setting],
    results: &Results,
    means: &Means,
    controlled: usize,
) -> Option<Scores> {
    let references = References::find(settings)?;
    settings.get(controlled)?;
    let ratio = |rows: &[Row], roads: &[&str], reference: &dyn Fn(&Row) -> f64| {
        let rows = rows.iter().filter(|row| roads.contains(&row.road));
        Worst::of(rows.map(|row| (row.group.as_str(), row.by_setting[controlled] / reference(row))))
    };
    let soft = |row: &Row| row.by_setting[references.soft];
    let stiff = |row: &Row| row.by_setting[references.stiff];
    let as_sold = |row: &Row| row.by_setting[references.as_sold];
    let best_fixed = |row: &Row| {
        let fixed = references.fixed.iter().map(|place| row.by_setting[*place]);
        fixed.fold(f64::INFINITY, f64::min)
    };
    let rough = ["iso-c", "iso-d", "iso-e", "belgian"];
    let all_rough = ["iso-b", "iso-c", "iso-d", "iso-e", "belgian"];
    let to_soft = ratio(&means.ride, &rough, &soft);
    let to_best = ratio(&means.ride, &all_rough, &best_fixed);
    let to_best_very_rough = ratio(&means.ride, &["iso-e", "belgian"], &best_fixed);
    let flat = ratio(&means.roll, &["flat"], &stiff);
    let flat_and_c = ratio(&means.roll, &["flat", "iso-c"], &stiff);
    let worse_roads = ratio(&means.roll, &["iso-d", "iso-e", "belgian"], &stiff);
    let baseline = ratio(&means.roll, &["flat", "iso-c"], &as_sold);
    let baseline_everywhere = ratio(
        &means.roll,
        &["flat", "iso-b", "iso-c", "iso-d", "iso-e", "belgian"],
        &as_sold,
    );

    let mine = || {
        groups
            .iter()
            .zip(results)
            .map(|(group, results)| (group, &results[controlled]))
    };
    let decisions = mine()
        .filter(|(group, _)| !group.is_straight() && ["flat", "iso-c"].contains(&group.road))
        .flat_map(|(group, seeds)| {
            let decided = |figures: &Figures| (group.name.as_str(), figures.decision_s.unwrap_or(f64::INFINITY));
            seeds.iter().map(decided)
        });
    let decision = Worst::of(decisions);
    let straight = || mine().filter(|(group, _)| group.is_straight());
    let entries_per_km = |seeds: &[Figures]| {
        let entries: u32 = seeds.iter().map(|figures| figures.entries).sum();
        f64::from(entries) / seeds.iter().map(|figures| figures.distance_km).sum::<f64>()
    };
    let entries = Worst::of(straight().map(|(group, seeds)| (group.name.as_str(), entries_per_km(seeds))));
    let everything: Vec<Figures> = straight().flat_map(|(_, seeds)| seeds.iter().copied()).collect();
    let distance_km: f64 = everything.iter().map(|figures| figures.distance_km).sum();
    let valve_changes_per_km = core::array::from_fn(|valve| {
        let changes: u32 = everything.iter().map(|figures| figures.valve_changes[valve]).sum();
        0.25 * f64::from(changes) / distance_km
    });
    let busiest = valve_changes_per_km.into_iter().fold(0.0, f64::max);

    Some(Scores {
        ride_ratio_to_soft: to_soft.value,
        ride_ratio_to_best_fixed: to_best.value,
        roll_ratio_to_stiff: flat.value,
        roll_ratio_to_baseline: baseline.value,
        decision_s: decision.value,
        false_entries_per_km: entries.value,
        false_entries_per_km_mean: entries_per_km(&everything),
        valve_changes_per_km,
        valve_life_km: VALVE_LIFE_CHANGES / busiest,
        goals: [
            to_best.goal(
                "weighted RMS over the best fixed setting, every rough road and speed",
                1.0,
            ),
            to_best_very_rough.goal("the same on class E and Belgian block", 0.95),
            flat_and_c.goal("peak roll over all valves closed, flat and class C", 1.15),
            baseline.goal("peak roll over the vehicle as sold, flat and class C", 1.0),
            worse_roads.goal("peak roll over all valves closed, classes D, E and Belgian block", 1.4),
            baseline_everywhere.goal("peak roll over the vehicle as sold, every road", 1.0),
            decision.goal("time to decide, every drive on flat and class C, s", 0.25),
            entries.goal(
                "false decisions a kilometre straight ahead, every rough road and speed",
                1.0,
            ),
        ]
        .into_iter()
        .flatten()
        .collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::plan::{Extent, groups};
    use super::*;
    use oleo_plant_sim::course::Ending;

    /// Settings whose figures are made up: the place of a setting is its ride, and less of it is less roll.
    #[test]
    fn ratios_are_the_worst_of_their_roads() {
        let groups = groups(&Extent {
            first_seed: 1,
            seeds: 2,
            straight_s: 10.0,
            quick: true,
        });
        let fixed = Setting::all_fixed();
        let settings: Vec<Setting> = [Setting::AsSold]
            .into_iter()
            .chain(fixed)
            .chain([Setting::SOFT])
            .collect();
        let figures = |rms: f64, roll: f64| Figures {
            ending: Ending::Completed,
            weighted_rms_m_s2: rms,
            peak_roll_deg: roll,
            decision_s: Some(0.2),
            entries: 1,
            distance_km: 0.5,
            valve_changes: [4, 8, 0],
        };
        let results: Results = groups
            .iter()
            .map(|group| {
                let of = |place: usize| match (place, group.road) {
                    (9, "belgian") => figures(0.9, 3.0),
                    (9, "flat") => figures(0.5, 4.0),
                    (9, _) => figures(0.5, 2.0),
                    _ => figures(1.0 + 0.1 * place as f64, 2.0 + 0.5 * place as f64),
                };
                (0..settings.len())
                    .map(|place| vec![of(place); group.cases.len()])
                    .collect()
            })
            .collect();
        let means = Means::of(&groups, &results);
        let scores = scores(&groups, &settings, &results, &means, 9).unwrap();
        // Fixed settings rank 1.1 (stiff, place 1) to 1.8 (soft, place 8).
        assert!((scores.ride_ratio_to_soft - 0.9 / 1.8).abs() < 1e-12);
        assert!((scores.ride_ratio_to_best_fixed - 0.9 / 1.1).abs() < 1e-12);
        assert!((scores.roll_ratio_to_stiff - 4.0 / 2.5).abs() < 1e-12);
        assert!((scores.roll_ratio_to_baseline - 4.0 / 2.0).abs() < 1e-12);
        assert_eq!((scores.decision_s, scores.false_entries_per_km), (0.2, 2.0));
        assert_eq!(scores.valve_changes_per_km, [2.0, 4.0, 0.0]);
        assert_eq!(scores.valve_life_km, VALVE_LIFE_CHANGES / 4.0);
        let unmet: Vec<&str> = scores
            .goals
            .iter()
            .filter(|goal| !goal.met)
            .map(|goal| goal.goal.as_str())
            .collect();
        assert_eq!((scores.goals.len(), unmet.len()), (7, 4), "{unmet:?}");
    }
}
