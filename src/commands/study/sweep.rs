//! `oleo study sweep`: figures 8 and 9, and the conclusions drawn from them.

use std::process::ExitCode;

use oleo_hil::parameter_files::Parameters;
use oleo_plant_sim::study::{
    Bench, DAMPER_FACTORS, Finding, GAS_VOLUMES_M3, Job, Ledger, Outcome, Surface, findings, jobs, run_jobs,
};
use oleo_report::{Axis, Cell, Column, Curves, Field, FieldStyle, OutputDirectory, Page, Style, Table, Verdict};
use serde_json::json;

use super::drive::{Drive, ledger};
use crate::failure::Failure;
use crate::results::ResultsArgs;
use crate::shard::{About, Kept, Request, Said, ShardArgs, Study, Work};

/// Run 10 gas volumes x 7 damper factors over Belgian block and through a lane change
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    drive: Drive,
    /// Exit with status 1 if a conclusion of the report is not met
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    results: ResultsArgs,
    #[command(flatten)]
    shard: ShardArgs,
}

/// The study.
pub struct Sweep {
    drive: Drive,
    bench: Bench,
    parameters: Parameters,
    jobs: Vec<Job>,
    check: bool,
}

impl Args {
    /// The study that is asked for.
    pub fn request(self) -> Result<Request, Failure> {
        let (bench, parameters) = self.drive.bench()?;
        let study = Sweep {
            drive: self.drive,
            bench,
            parameters,
            jobs: jobs(&GAS_VOLUMES_M3, &DAMPER_FACTORS),
            check: self.check,
        };
        Ok(Request {
            study: Box::new(study),
            results: self.results,
            shard: self.shard,
        })
    }
}

/// A case is a drive over the Belgian block or through the lane change with a gas volume and a damper factor.
impl Study for Sweep {
    type Ledger = Ledger;
    type Outcome = (Outcome, bool);

    fn about(&self) -> About {
        self.drive.about("sweep")
    }

    fn cases(&self) -> usize {
        self.jobs.len()
    }

    fn ledger(&self, kept: Kept) -> Result<Ledger, Failure> {
        ledger(kept, &self.bench)
    }

    fn run(&self, cases: &[usize], ledger: &Ledger, work: &Work) -> Result<Vec<(Outcome, bool)>, Failure> {
        let chosen: Vec<Job> = cases.iter().map(|case| self.jobs[*case]).collect();
        let drive = || run_jobs(&self.bench, ledger, &chosen, || work.done(), || work.stops());
        Ok(self.drive.on_threads(drive)??)
    }

    fn report(
        &self,
        outcomes: Vec<(Outcome, bool)>,
        out: Option<&mut OutputDirectory>,
        command: &str,
    ) -> Result<Said, Failure> {
        let surface = Surface::of(&GAS_VOLUMES_M3, &DAMPER_FACTORS, outcomes);
        let conclusions = findings(&surface);
        let met = all_met(&conclusions);
        let table = conclusions_table(&conclusions);
        if let Some(out) = out {
            self.parameters.keep_vehicle(out)?;
            write(out, self.drive.seed, &surface, &conclusions, &table, command)?;
        }
        let failed = self.check && !met;
        Ok(Said {
            text: format!("{}{table}", grid_table(&surface)),
            status: if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS },
        })
    }
}

/// Whether all statements are met that are part of the check.
fn all_met(conclusions: &[Finding]) -> bool {
    conclusions.iter().all(|finding| finding.met || !finding.conclusion)
}

fn conclusions_table(conclusions: &[Finding]) -> Table {
    let mut table = Table::new([
        Column::text("The report says (3.2)"),
        Column::text("Found"),
        Column::text("Met"),
    ]);
    for finding in conclusions {
        let met = match (finding.conclusion, finding.met) {
            (true, met) => Cell::check(met),
            (false, true) => Cell::good("yes (not part of the check)"),
            (false, false) => Cell::warning("no (not part of the check)"),
        };
        let cells: [Cell; 3] = [finding.report.into(), finding.found.as_str().into(), met];
        table.row(cells);
    }
    table
}

/// The sentence above the table of conclusions. It names the statements outside the check too, so that a "no" in the table
/// never stands below a sentence that says that all is met.
fn verdict_sentence(findings: &[Finding]) -> String {
    let count = |conclusion: bool, met: bool| {
        let such = findings.iter().filter(|f| f.conclusion == conclusion && f.met == met);
        such.count()
    };
    let (met, of) = (count(true, true), count(true, true) + count(true, false));
    let mut text = format!("{met} of the {of} conclusions of the report that are checked are met.");
    match count(false, false) {
        0 => {}
        1 => text += " One further statement of the report, which is not part of the check, is not met.",
        more => {
            text += &format!(" {more} further statements of the report, which are not part of the check, are not met.")
        }
    }
    text
}

fn grid_table(surface: &Surface) -> Table {
    let mut columns = vec![Column::text(
        "Gas volume, l (cells: weighted RMS, m/s2 | largest roll, degrees) at factor",
    )];
    columns.extend(
        surface
            .damper_factors
            .iter()
            .map(|factor| Column::number(&format!("{factor}"))),
    );
    let mut table = Table::new(columns);
    for (i, volume) in surface.gas_volumes_m3.iter().enumerate() {
        let mut row = vec![format!("{:.2}", 1e3 * volume)];
        for j in 0..surface.damper_factors.len() {
            let roll = match surface.handling[i][j].completed {
                true => format!("{:.2}", surface.handling[i][j].max_roll_rad.to_degrees()),
                false if surface.handling[i][j].rolled_over => "rolled over".to_owned(),
                false => "left the track".to_owned(),
            };
            row.push(format!("{:.2} | {roll}", surface.ride[i][j].mean_rms_m_s2()));
        }
        table.row(row);
    }
    table
}

/// A measure as contours, with a mark at its lowest value.
fn contour(measure: &str, unit: &str, litres: &[f64], factors: &[f64], values: &[Vec<f64>]) -> Field {
    let axes = [
        Axis::new("Static gas volume", "l").logarithmic(),
        Axis::new("Damper factor", ""),
        Axis::new(measure, unit),
    ];
    let mut field = Field::new(measure, FieldStyle::Contour, axes, litres, factors, values);
    let lowest = cells(values)
        .filter(|(j, i)| values[*j][*i].is_finite())
        .min_by(|a, b| values[a.0][a.1].total_cmp(&values[b.0][b.1]));
    if let Some((j, i)) = lowest {
        field.path("lowest", &[litres[i]], &[factors[j]]);
    }
    field
}

/// Rows and columns of a field.
fn cells(values: &[Vec<f64>]) -> impl Iterator<Item = (usize, usize)> {
    (values.iter().enumerate()).flat_map(|(j, row)| (0..row.len()).map(move |i| (j, i)))
}

/// The Pareto front, by rising RMS: no other cell is lower in one of RMS and roll and at most as high in the other.
fn pareto_front(rms: &[Vec<f64>], roll: &[Vec<f64>]) -> Vec<(usize, usize)> {
    let mut all: Vec<(usize, usize)> = cells(rms)
        .filter(|&(j, i)| rms[j][i].is_finite() && roll[j][i].is_finite())
        .collect();
    all.sort_by(|a, b| (rms[a.0][a.1].total_cmp(&rms[b.0][b.1])).then(roll[a.0][a.1].total_cmp(&roll[b.0][b.1])));
    let mut least = f64::INFINITY;
    all.retain(|&(j, i)| {
        let better = roll[j][i] < least;
        least = least.min(roll[j][i]);
        better
    });
    all
}

fn ride_against_roll(rms: &[Vec<f64>], roll: &[Vec<f64>], front: &[(usize, usize)]) -> Curves {
    let mut figure = Curves::new(
        "Ride against roll",
        Axis::new("Weighted RMS, mean of both seats", "m/s2"),
    );
    figure.caption(
        "A point for each combination that completed both drives. On the Pareto front, which the table lists, one measure can only be improved at the \
         cost of the other.",
    );
    let of = |values: &[Vec<f64>], places: &[(usize, usize)]| {
        places.iter().map(|&(j, i)| values[j][i]).collect::<Vec<f64>>()
    };
    let all: Vec<(usize, usize)> = cells(rms).collect();
    figure
        .panel(Axis::new("Largest body roll", "degrees"))
        .series(Style::Points, "all combinations", &of(rms, &all), &of(roll, &all))
        .series(Style::LineAndPoints, "Pareto front", &of(rms, front), &of(roll, front));
    figure
}

fn front_table(
    litres: &[f64],
    factors: &[f64],
    rms: &[Vec<f64>],
    roll: &[Vec<f64>],
    front: &[(usize, usize)],
) -> Table {
    let mut table = Table::new([
        Column::number("Gas volume, l"),
        Column::number("Damper factor"),
        Column::number("Weighted RMS, m/s2"),
        Column::number("Largest roll, degrees"),
    ]);
    for &(j, i) in front {
        table.row([
            format!("{:.2}", litres[i]),
            format!("{}", factors[j]),
            format!("{:.2}", rms[j][i]),
            format!("{:.2}", roll[j][i]),
        ]);
    }
    table
}

/// The field's rows are damper factors, its columns gas volumes.
fn field(surface: &Surface, value: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    let columns = 0..surface.gas_volumes_m3.len();
    (0..surface.damper_factors.len())
        .map(|j| columns.clone().map(|i| value(i, j)).collect())
        .collect()
}

fn write(
    out: &mut OutputDirectory,
    seed: u64,
    surface: &Surface,
    conclusions: &[Finding],
    table: &Table,
    command: &str,
) -> Result<(), Failure> {
    let met = all_met(conclusions);
    let litres: Vec<f64> = surface.gas_volumes_m3.iter().map(|v| 1e3 * v).collect();
    let factors = &surface.damper_factors;
    let ride = |of: fn(&oleo_plant_sim::study::Ride) -> f64| {
        field(surface, |i, j| {
            if surface.ride[i][j].completed {
                of(&surface.ride[i][j])
            } else {
                f64::NAN
            }
        })
    };
    let roll = field(surface, |i, j| match surface.handling[i][j].completed {
        true => surface.handling[i][j].max_roll_rad.to_degrees(),
        false => f64::NAN,
    });
    let mut page = Page::new("Design study: gas volume and damping", command);
    let verdict = if met { Verdict::Pass } else { Verdict::Fail };
    page.verdict(verdict, &verdict_sentence(conclusions));
    page.outcome(table.clone());
    page.section("Measures over gas volume and damping (figures 8 and 9)").text(
        "The vertical acceleration at the seats on Belgian block is frequency-weighted according to BS 6841. The roll is that of the \
         severe double lane change of ISO 3888-1. In a gap the vehicle rolled over, spun or left the track. The mark is the lowest value \
         of the 70 combinations.",
    );
    let measures = [
        ("Weighted RMS, mean of both seats", "m/s2", ride(|r| r.mean_rms_m_s2())),
        ("Weighted RMS at the driver", "m/s2", ride(|r| r.driver_rms_m_s2)),
        (
            "Weighted RMS at the left rear passenger",
            "m/s2",
            ride(|r| r.passenger_rms_m_s2),
        ),
        (
            "Motion sickness dose, mean of both seats",
            "m/s^1.5",
            ride(|r| r.mean_msdv_m_s1_5()),
        ),
        ("Largest body roll", "degrees", roll.clone()),
    ];
    page.choice(
        "Measure",
        measures.map(|(measure, unit, values)| {
            (
                measure.to_owned(),
                contour(measure, unit, &litres, factors, &values).into(),
            )
        }),
    );
    let rms = ride(|r| r.mean_rms_m_s2());
    let front = pareto_front(&rms, &roll);
    page.section("Ride against roll")
        .figure(ride_against_roll(&rms, &roll, &front))
        .table(front_table(&litres, factors, &rms, &roll, &front));
    page.details("All figures", grid_table(surface));

    let cells: Vec<(usize, usize)> = (0..litres.len())
        .flat_map(|i| (0..factors.len()).map(move |j| (i, j)))
        .collect();
    let column = |of: &dyn Fn(usize, usize) -> f64| cells.iter().map(|&(i, j)| of(i, j)).collect::<Vec<f64>>();
    let flag = |b: bool| f64::from(u8::from(b));
    let columns: [(&str, Vec<f64>); 11] = [
        ("gas_volume_l", column(&|i, _| litres[i])),
        ("damper_factor", column(&|_, j| factors[j])),
        (
            "weighted_rms_driver_m_s2",
            column(&|i, j| surface.ride[i][j].driver_rms_m_s2),
        ),
        (
            "weighted_rms_rear_left_m_s2",
            column(&|i, j| surface.ride[i][j].passenger_rms_m_s2),
        ),
        (
            "msdv_driver_m_s1_5",
            column(&|i, j| surface.ride[i][j].driver_msdv_m_s1_5),
        ),
        (
            "msdv_rear_left_m_s1_5",
            column(&|i, j| surface.ride[i][j].passenger_msdv_m_s1_5),
        ),
        ("ride_completed", column(&|i, j| flag(surface.ride[i][j].completed))),
        (
            "max_roll_deg",
            column(&|i, j| surface.handling[i][j].max_roll_rad.to_degrees()),
        ),
        (
            "max_lateral_m_s2",
            column(&|i, j| surface.handling[i][j].max_lateral_m_s2),
        ),
        (
            "lane_change_completed",
            column(&|i, j| flag(surface.handling[i][j].completed)),
        ),
        ("rolled_over", column(&|i, j| flag(surface.handling[i][j].rolled_over))),
    ];
    let columns: Vec<(&str, &[f64])> = columns
        .iter()
        .map(|(name, values)| (*name, values.as_slice()))
        .collect();
    out.csv("surfaces.csv", &columns)?;
    let conclusions: Vec<_> = conclusions
        .iter()
        .map(|finding| json!({"report": finding.report, "found": finding.found, "met": finding.met, "conclusion": finding.conclusion}))
        .collect();
    let summary = json!({"conclusions": conclusions, "all_met": met});
    out.summary("summary.json", Some(seed), &summary)?;
    out.page(&page)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(conclusion: bool, met: bool) -> Finding {
        Finding {
            report: "a statement",
            found: "a figure".into(),
            met,
            conclusion,
        }
    }

    #[test]
    fn cells_that_another_one_dominates_are_not_on_the_front() {
        let nan = f64::NAN;
        let rms = [vec![1.0, 2.0, 3.0], vec![2.0, 4.0, nan]];
        let roll = [vec![9.0, 5.0, 5.0], vec![6.0, 1.0, 0.0]];
        assert_eq!(pareto_front(&rms, &roll), [(0, 0), (0, 1), (1, 1)]);
    }

    #[test]
    fn the_verdict_counts_every_no_of_the_table() {
        let findings = [finding(true, true), finding(true, false), finding(false, false)];
        let text = verdict_sentence(&findings);
        assert!(text.starts_with("1 of the 2 conclusions"), "{text}");
        assert!(text.contains("One further statement"), "{text}");
        let table = conclusions_table(&findings).to_string();
        assert_eq!(table.matches("NO").count(), 1, "{table}");
        assert_eq!(table.matches("no (not part of the check)").count(), 1, "{table}");
        assert!(!verdict_sentence(&[finding(true, true), finding(false, true)]).contains("further"));
    }
}
