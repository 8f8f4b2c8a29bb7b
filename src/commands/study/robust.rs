//! `oleo study robust`: random vehicles under the controller of the nominal one.

use std::ops::Range;
use std::process::ExitCode;

use oleo_controller::{DamperPolicy, Strategy};
use oleo_hil::comparison::{Bench, DRIVES, Setting, VariedResult, robust};
use oleo_hil::parameter_files::Parameters;
use oleo_plant_sim::study::Records;
use oleo_report::{Axis, Column, Curves, OutputDirectory, Page, Style, Table, Verdict};
use serde_json::json;

use super::drives::{Drives, controlled, records};
use crate::failure::Failure;
use crate::results::ResultsArgs;
use crate::shard::{About, Kept, Request, Said, ShardArgs, Study, Work};

/// Drive random vehicles (load, inertia, tyres, gas, friction, valves, sensors, a weak strut) with the controller of the nominal one
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    drives: Drives,
    /// Number of vehicles, 1 to 10000000
    #[arg(long, value_name = "N", default_value_t = 100)]
    vehicles: u64,
    /// Number of the first vehicle; with --vehicles 1 a single vehicle is driven again
    #[arg(long, value_name = "K", default_value_t = 0)]
    first: u64,
    /// Exit with status 1 if a vehicle rolls over that stands with all valves closed
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    results: ResultsArgs,
    #[command(flatten)]
    shard: ShardArgs,
}

/// One of the distributions.
struct Distribution {
    name: &'static str,
    key: &'static str,
    of: fn(&VariedResult) -> f64,
}

const DISTRIBUTIONS: [Distribution; 3] = [
    Distribution {
        name: "weighted RMS on class C over all valves open",
        key: "ride_ratio_to_soft",
        of: |result| result.ride_ratio_to_soft,
    },
    Distribution {
        name: "peak roll in the lane change on a flat road over all valves closed",
        key: "roll_ratio_to_stiff",
        of: |result| result.roll_ratio_to_stiff,
    },
    Distribution {
        name: "the same on class C",
        key: "roll_ratio_to_stiff_rough",
        of: |result| result.roll_ratio_to_stiff_rough,
    },
];

/// Most vehicles of a study.
const MOST: u64 = 10_000_000;

/// The study.
pub struct Robust {
    drives: Drives,
    nominal: Bench,
    parameters: Parameters,
    setting: Setting,
    vehicles: Range<u64>,
    check: bool,
}

impl Args {
    /// The study that is asked for.
    pub fn request(self) -> Result<Request, Failure> {
        if !(1..=MOST).contains(&self.vehicles) {
            return Err(Failure::new(format!(
                "--vehicles {}: give a number from 1 to {MOST}",
                self.vehicles
            )));
        }
        let (nominal, parameters) = self.drives.bench()?;
        let setting = controlled(
            &nominal,
            Strategy::default().name(),
            Strategy::default(),
            DamperPolicy::default(),
        )?;
        let study = Robust {
            drives: self.drives,
            nominal,
            parameters,
            setting,
            vehicles: self.first..self.first.saturating_add(self.vehicles),
            check: self.check,
        };
        Ok(Request {
            study: Box::new(study),
            results: self.results,
            shard: self.shard,
        })
    }
}

/// A case is a vehicle, drawn by its number.
impl Study for Robust {
    type Ledger = Records;
    type Outcome = VariedResult;

    fn about(&self) -> About {
        self.drives.about("robust", DRIVES)
    }

    fn cases(&self) -> usize {
        self.vehicles.clone().count()
    }

    fn ledger(&self, kept: Kept) -> Result<Records, Failure> {
        records(kept)
    }

    fn run(&self, cases: &[usize], records: &Records, work: &Work) -> Result<Vec<VariedResult>, Failure> {
        let vehicles: Vec<u64> = cases.iter().map(|case| self.vehicles.start + *case as u64).collect();
        let (nominal, setting) = (&self.nominal, &self.setting);
        let drive = || robust(nominal, setting, &vehicles, records, || work.done(), || work.stops());
        Ok(self.drives.on_threads(drive)??)
    }

    fn report(
        &self,
        results: Vec<VariedResult>,
        out: Option<&mut OutputDirectory>,
        command: &str,
    ) -> Result<Said, Failure> {
        let over: Vec<u64> = results
            .iter()
            .filter(|result| result.rolls_over)
            .map(|result| result.case)
            .collect();
        let table = table(&results);
        if let Some(out) = out {
            self.parameters.keep(out)?;
            write(out, self.vehicles.start, &results, &over, &table, command)?;
        }
        let failed = self.check && !over.is_empty();
        Ok(Said {
            text: format!("{table}{}\n", verdict(results.len(), &over)),
            status: if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS },
        })
    }
}

fn verdict(vehicles: usize, over: &[u64]) -> String {
    match over {
        [] => format!("None of {vehicles} vehicles rolls over that stands with all valves closed."),
        some => {
            let numbers: Vec<String> = some.iter().map(u64::to_string).collect();
            format!(
                "{} of {vehicles} vehicles roll over that stand with all valves closed: numbers {}.",
                some.len(),
                numbers.join(", ")
            )
        }
    }
}

/// The values of a distribution in rising order with the numbers of their vehicles; those that are no numbers are left out.
fn sorted(results: &[VariedResult], distribution: &Distribution) -> Vec<(f64, u64)> {
    let mut values: Vec<(f64, u64)> = results
        .iter()
        .map(|result| ((distribution.of)(result), result.case))
        .filter(|(value, _)| value.is_finite())
        .collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    values
}

/// The value below which a part of the vehicles lies: the nearest rank.
fn quantile(values: &[(f64, u64)], part: f64) -> f64 {
    let rank = (part * values.len() as f64).ceil().max(1.0) as usize;
    values.get(rank - 1).map_or(f64::NAN, |(value, _)| *value)
}

fn table(results: &[VariedResult]) -> Table {
    let mut table = Table::new([
        Column::text("Ratio"),
        Column::number("Median"),
        Column::number("95 %"),
        Column::number("Worst"),
        Column::number("Vehicle"),
    ]);
    for distribution in &DISTRIBUTIONS {
        let values = sorted(results, distribution);
        let (worst, case) = values.last().copied().unwrap_or((f64::NAN, 0));
        table.row([
            distribution.name.to_owned(),
            format!("{:.2}", quantile(&values, 0.5)),
            format!("{:.2}", quantile(&values, 0.95)),
            format!("{worst:.2}"),
            case.to_string(),
        ]);
    }
    table
}

fn write(
    out: &mut OutputDirectory,
    seed: u64,
    results: &[VariedResult],
    over: &[u64],
    table: &Table,
    command: &str,
) -> Result<(), Failure> {
    let column = |of: &dyn Fn(&VariedResult) -> f64| results.iter().map(of).collect::<Vec<f64>>();
    let case = column(&|result| result.case as f64);
    let rolls_over = column(&|result| f64::from(u8::from(result.rolls_over)));
    let [ride, flat, rough] = DISTRIBUTIONS.map(|distribution| (distribution.key, column(&distribution.of)));
    out.csv(
        "vehicles.csv",
        &[
            ("vehicle", &case),
            (ride.0, &ride.1),
            (flat.0, &flat.1),
            (rough.0, &rough.1),
            ("rolls_over", &rolls_over),
        ],
    )?;
    let distributions: serde_json::Map<String, serde_json::Value> = DISTRIBUTIONS
        .iter()
        .map(|distribution| {
            let values = sorted(results, distribution);
            let (worst, vehicle) = values.last().copied().unwrap_or((f64::NAN, 0));
            let figures = json!({
                "median": quantile(&values, 0.5),
                "quantile_95": quantile(&values, 0.95),
                "worst": worst,
                "worst_vehicle": vehicle,
            });
            (distribution.key.to_owned(), figures)
        })
        .collect();
    out.summary(
        "summary.json",
        Some(seed),
        &json!({
            "vehicles": results.len(),
            "rolled_over": over,
            "distributions": distributions,
        }),
    )?;

    let mut page = Page::new("Robustness study", command);
    let kind = if over.is_empty() { Verdict::Pass } else { Verdict::Fail };
    page.verdict(kind, &verdict(results.len(), over));
    page.outcome(table.clone());
    let mut figure = Curves::new("Distributions", Axis::new("Ratio", ""));
    figure.caption("Fraction of the vehicles whose ratio is at most the value below. A ratio of 1 equals the soft setting for the ride, and the stiff one for the roll.");
    let panel = figure.panel(Axis::new("Fraction of the vehicles", "").range(0.0, 1.0));
    for distribution in &DISTRIBUTIONS {
        let values = sorted(results, distribution);
        let x: Vec<f64> = values.iter().map(|(value, _)| *value).collect();
        let y: Vec<f64> = (1..=x.len()).map(|rank| rank as f64 / x.len() as f64).collect();
        panel.series(Style::Step, distribution.name, &x, &y);
    }
    page.section("Distributions").figure(figure);
    out.page(&page)?;
    Ok(())
}
