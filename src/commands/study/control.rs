//! `oleo study control`: the controller against every fixed setting, the vehicle as sold and an oracle.

use std::process::ExitCode;

use oleo_controller::{DamperPolicy, Strategy};
use oleo_hil::comparison::{
    self, Bench, Extent, Figures, Group, Means, Row, Scores, Setting, by_group, compare, groups, jobs, scores,
    settings, with_beginnings,
};
use oleo_hil::parameter_files::Parameters;
use oleo_plant_sim::study::Records;
use oleo_report::{Axis, Cell, Column, Curves, OutputDirectory, Page, Style, Table, Verdict};
use serde_json::json;

use super::drives::{Drives, controlled, records};
use super::mixed_drive::MixedDrive;
use crate::failure::Failure;
use crate::results::ResultsArgs;
use crate::shard::{About, Kept, Request, Said, ShardArgs, Study, Work};

/// Compare the controller with every fixed valve setting, the vehicle as sold and an oracle, for ride and for roll
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    drives: Drives,
    /// Number of seeds of roads and sensors, 1 to 1000
    #[arg(long, value_name = "N", default_value_t = 8)]
    seeds: u64,
    /// First seed, 1 to 1000000; the controller was tuned with seeds below 1000 in view
    #[arg(long, value_name = "N", default_value_t = 1)]
    first_seed: u64,
    /// Duration of a drive straight ahead, s, 5 to 600; the first 3 s are not scored
    #[arg(long, value_name = "S", default_value_t = 20.0, allow_negative_numbers = true)]
    duration_s: f64,
    /// Class C and Belgian block at one speed, and two manoeuvres: a first look
    #[arg(long)]
    quick: bool,
    /// Exit with status 1 if a goal is not met
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    results: ResultsArgs,
    #[command(flatten)]
    shard: ShardArgs,
}

/// Controllers that are compared: name, strategy, and the damper policy of `ride-handling`. The first is the one that is scored.
/// The second is the same with rear dampers that a forecast sets. The others decide as Els does, by running RMS; their dampers stay low,
/// or follow a rule of the literature.
const CONTROLLERS: [(&str, Strategy, DamperPolicy); 7] = [
    ("road-and-cornering", Strategy::RoadAndCornering, DamperPolicy::Low),
    ("predictive", Strategy::Predictive, DamperPolicy::Low),
    ("ride-handling-low", Strategy::RideHandling, DamperPolicy::Low),
    ("ride-handling-karnopp", Strategy::RideHandling, DamperPolicy::Karnopp),
    (
        "ride-handling-hoelscher-huang",
        Strategy::RideHandling,
        DamperPolicy::HoelscherHuang,
    ),
    ("ride-handling-sh-add", Strategy::RideHandling, DamperPolicy::ShAdd),
    (
        "ride-handling-nell-steyn",
        Strategy::RideHandling,
        DamperPolicy::NellSteyn,
    ),
];

/// What the names of the controllers that decide by running RMS begin with: one series of the picture.
const RUNNING_RMS: &str = "ride-handling";
/// Points of the picture that are nearer than this along both axes share a label, which would not be read otherwise.
const ONE_LABEL: f64 = 0.02;

/// What was compared, and the result.
struct Comparison<'a> {
    groups: &'a [Group],
    settings: &'a [Setting],
    means: Means,
    /// For each of [`CONTROLLERS`].
    scores: Vec<Scores>,
}

/// The study.
pub struct Control {
    drives: Drives,
    bench: Bench,
    parameters: Parameters,
    groups: Vec<Group>,
    settings: Vec<Setting>,
    first_seed: u64,
    check: bool,
}

impl Args {
    /// The study that is asked for.
    pub fn request(self) -> Result<Request, Failure> {
        if !(1..=1000).contains(&self.seeds) {
            return Err(Failure::new(format!(
                "--seeds {}: give a number from 1 to 1000",
                self.seeds
            )));
        }
        if !(1..=1_000_000).contains(&self.first_seed) {
            return Err(Failure::new(format!(
                "--first-seed {}: give a number from 1 to 1000000",
                self.first_seed
            )));
        }
        if !(5.0..=600.0).contains(&self.duration_s) {
            return Err(Failure::new(format!(
                "--duration-s {}: give a value from 5 to 600",
                self.duration_s
            )));
        }
        let (bench, parameters) = self.drives.bench()?;
        let controllers: Vec<Setting> = CONTROLLERS
            .into_iter()
            .map(|(name, strategy, dampers)| controlled(&bench, name, strategy, dampers))
            .collect::<Result<_, Failure>>()?;
        let groups = groups(&Extent {
            first_seed: self.first_seed,
            seeds: self.seeds,
            straight_s: self.duration_s,
            quick: self.quick,
        });
        let study = Control {
            groups: self.drives.on_threads(|| with_beginnings(&bench, groups))??,
            settings: settings(controllers),
            drives: self.drives,
            bench,
            parameters,
            first_seed: self.first_seed,
            check: self.check,
        };
        Ok(Request {
            study: Box::new(study),
            results: self.results,
            shard: self.shard,
        })
    }
}

/// A case is a drive: of a group, with a setting and a seed.
impl Study for Control {
    type Ledger = Records;
    type Outcome = Figures;

    fn about(&self) -> About {
        self.drives.about("control", 1)
    }

    fn cases(&self) -> usize {
        jobs(&self.groups, &self.settings).len()
    }

    fn ledger(&self, kept: Kept) -> Result<Records, Failure> {
        records(kept)
    }

    fn run(&self, cases: &[usize], records: &Records, work: &Work) -> Result<Vec<Figures>, Failure> {
        let all = jobs(&self.groups, &self.settings);
        let chosen: Vec<_> = cases.iter().map(|case| all[*case]).collect();
        let drive = || compare(&self.bench, &chosen, records, || work.done(), || work.stops());
        Ok(self.drives.on_threads(drive)??)
    }

    fn report(&self, figures: Vec<Figures>, out: Option<&mut OutputDirectory>, command: &str) -> Result<Said, Failure> {
        let comparison = self.comparison(figures);
        let [own, ..] = &comparison.scores[..] else {
            return Err(Failure::new("the comparison has no controller"));
        };
        let tables = [ride_table(&comparison), roll_table(&comparison), goals_table(own)];
        let met = own.goals.iter().all(|goal| goal.met);
        if let Some(out) = out {
            self.parameters.keep(out)?;
            let mixed = || MixedDrive::new(&self.bench, &self.settings, CONTROLLERS[0].0, self.first_seed);
            let mixed = self.drives.on_threads(mixed)??;
            write(out, self.first_seed, &comparison, own, &tables, &mixed, command)?;
        }
        let text: Vec<String> = tables.iter().map(ToString::to_string).collect();
        let failed = self.check && !met;
        Ok(Said {
            text: text.join("\n"),
            status: if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS },
        })
    }
}

impl Control {
    fn comparison(&self, figures: Vec<Figures>) -> Comparison<'_> {
        let (groups, settings) = (&self.groups, &self.settings);
        let results = by_group(groups, settings, figures);
        let means = Means::of(groups, &results);
        let first = settings.len() - CONTROLLERS.len();
        let scores = (first..settings.len())
            .filter_map(|place| scores(groups, settings, &results, &means, place))
            .collect();
        Comparison {
            groups,
            settings,
            means,
            scores,
        }
    }
}

/// One line a group, one column a setting.
fn table(title: &str, rows: &[Row], settings: &[Setting], digits: usize) -> Table {
    let names = settings.iter().map(|setting| Column::number(&setting.name()));
    let mut table = Table::new([Column::text(title)].into_iter().chain(names));
    for row in rows {
        let cells = row.by_setting.iter().map(|value| format!("{value:.digits$}"));
        table.row([row.group.clone()].into_iter().chain(cells));
    }
    table
}

fn ride_table(comparison: &Comparison) -> Table {
    table("Weighted RMS, m/s2", &comparison.means.ride, comparison.settings, 3)
}

fn roll_table(comparison: &Comparison) -> Table {
    table("Peak roll, degrees", &comparison.means.roll, comparison.settings, 2)
}

fn goals_table(scores: &Scores) -> Table {
    let mut table = Table::new([
        Column::text("Goal"),
        Column::number("Limit"),
        Column::number("Worst"),
        Column::text("Where"),
        Column::text("Met"),
    ]);
    for goal in &scores.goals {
        table.row([
            Cell::from(goal.goal.as_str()),
            format!("{:.2}", goal.limit).into(),
            // A third digit, so that a goal that is missed by little does not read as if it were met.
            format!("{:.3}", goal.value).into(),
            goal.at.as_str().into(),
            Cell::check(goal.met),
        ]);
    }
    table
}

fn write(
    out: &mut OutputDirectory,
    seed: u64,
    comparison: &Comparison,
    own: &Scores,
    tables: &[Table; 3],
    mixed: &MixedDrive,
    command: &str,
) -> Result<(), Failure> {
    let Comparison {
        groups,
        settings,
        means,
        scores,
    } = comparison;
    let by_controller: serde_json::Map<String, serde_json::Value> = CONTROLLERS
        .iter()
        .zip(scores)
        .map(|((name, ..), scores)| ((*name).to_owned(), json!(scores)))
        .collect();
    out.summary(
        "summary.json",
        Some(seed),
        &json!({
            "controller": CONTROLLERS[0].0,
            "ride_ratio_to_soft": own.ride_ratio_to_soft,
            "ride_ratio_to_best_fixed": own.ride_ratio_to_best_fixed,
            "roll_ratio_to_stiff": own.roll_ratio_to_stiff,
            "roll_ratio_to_baseline": own.roll_ratio_to_baseline,
            "decision_s": own.decision_s,
            "false_entries_per_km": own.false_entries_per_km,
            "valve_changes_per_km": own.valve_changes_per_km,
            "valve_life_changes": comparison::VALVE_LIFE_CHANGES,
            "valve_life_km": own.valve_life_km,
            "first_seed": groups.first().and_then(|group| group.cases.first()).map(|case| case.seed),
            "seeds": groups.iter().map(|group| group.cases.len()).max(),
            "settings": settings.iter().map(Setting::name).collect::<Vec<_>>(),
            "means": means,
            "mixed_drive": mixed.summary(),
            "controllers": by_controller,
        }),
    )?;
    out.page(&page(comparison, own, tables, mixed, command))?;
    Ok(())
}

fn page(
    comparison: &Comparison,
    own: &Scores,
    [ride, roll, goals]: &[Table; 3],
    mixed: &MixedDrive,
    command: &str,
) -> Page {
    let Comparison { settings, means, .. } = comparison;
    let mut page = Page::new("Control study", command);
    let met = own.goals.iter().filter(|goal| goal.met).count();
    let counted = format!("{met} of {} goals are met.", own.goals.len());
    if met == own.goals.len() {
        page.verdict(Verdict::Pass, &counted);
    } else {
        page.verdict(
            Verdict::Attention,
            &format!("{counted} The table states where the other goals fail."),
        );
    }
    page.outcome(goals.clone());

    let place = |wanted: &Setting| settings.iter().position(|setting| setting == wanted);
    if let (Some(soft), Some(stiff)) = (place(&Setting::SOFT), place(&Setting::STIFF)) {
        let flat_and_c: Vec<Row> = means
            .roll
            .iter()
            .filter(|row| ["flat", "iso-c"].contains(&row.road))
            .cloned()
            .collect();
        let mut figure = Curves::new("Ride against roll", Axis::new("Weighted RMS over all valves open", ""));
        figure.caption(
            "One point for each setting: the geometric means over the drives straight ahead, and over the manoeuvres on a flat road and on \
             class C. Lower left is better. A fixed setting lies on the arc from soft to stiff; the oracle knows when a manoeuvre begins.",
        );
        let panel = figure.panel(Axis::new("Peak roll over all valves closed", ""));
        let mut drawn: Vec<(String, Vec<f64>, Vec<f64>)> = Vec::new();
        for (number, setting) in settings.iter().enumerate() {
            let name = setting.name();
            let ride = comparison::mean_ratio(&means.ride, number, soft);
            let roll = comparison::mean_ratio(&flat_and_c, number, stiff);
            let of_running_rms = |names: &str| name.starts_with(RUNNING_RMS) && names.starts_with(RUNNING_RMS);
            // A closed valve 3 takes no flow, so that valve 2 makes no difference behind it; others are as good as equal.
            let beside = |x: &[f64], y: &[f64]| (x[0] - ride).abs() < ONE_LABEL && (y[0] - roll).abs() < ONE_LABEL;
            if let Some((names, x, y)) = (drawn.iter_mut()).find(|(names, x, y)| of_running_rms(names) || beside(x, y))
            {
                *names = if of_running_rms(names) {
                    format!("{RUNNING_RMS} with five damper policies")
                } else {
                    format!("{names}, {name}")
                };
                x.push(ride);
                y.push(roll);
            } else {
                drawn.push((name, vec![ride], vec![roll]));
            }
        }
        for (name, x, y) in drawn {
            panel.series(Style::NamedPoints, &name, &x, &y);
        }
        page.section("Ride against roll").figure(figure);
    }
    mixed.show(&mut page);
    let section = page.section("Ride, straight ahead");
    section.text(
        "Vertical acceleration at the seats, BS 6841 weighting, mean of driver and passenger, from the third second.",
    );
    section.table(ride.clone());
    let section = page.section("Roll in manoeuvres");
    section.text("Largest roll of the body from the third second; 90 degrees stand for a vehicle that rolled over.");
    section.table(roll.clone());
    let mut valves = Table::new([
        Column::text("Valve"),
        Column::number("Changes of one valve per km"),
        Column::number("Life, km"),
    ]);
    for (number, changes) in (1..=3).zip(own.valve_changes_per_km) {
        let life_km = comparison::VALVE_LIFE_CHANGES / changes;
        valves.row([format!("{number}"), format!("{changes:.1}"), format!("{life_km:.0}")]);
    }
    let section = page.section("Valves");
    section.text("Changes of the valves' signals straight ahead on rough roads, and the distance to 10 million changes (an assumed life).");
    section.table(valves);
    page
}
