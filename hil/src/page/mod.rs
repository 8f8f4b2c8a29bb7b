//! `report.html` of a run: what happened and whether that is good, the checks, then on one time axis what the controller did, the
//! moving vehicle and the events, then road, body, struts, controller and bus.

mod body;
mod bus;
mod controller;
mod course;
mod events;
mod figures;
mod headline;
mod lanes;
mod struts;
mod time;
mod vehicle;

use oleo_report::{Page, significant};

use crate::metrics::Metrics;
use crate::output::Summary;
use crate::run::Outcome;
use crate::scenario::Scenario;
pub use course::{Path, ending_in_words, map, went};
pub use figures::{check_table, outcome_table};
use time::Time;

/// The page of a run. `command` is the command line that makes it again.
pub fn page(scenario: &Scenario, outcome: &Outcome, metrics: &Metrics, summary: &Summary, command: &str) -> Page {
    let mut page = Page::new(&format!("Hardware-in-the-loop: {}", scenario.title()), command);
    if scenario.changes.is_empty() {
        page.fact("Scenario", &scenario.description);
    } else {
        page.fact("Scenario", &scenario.title());
    }
    page.fact(
        "Road",
        &format!("{} at {} km/h", scenario.road, significant(scenario.speed_m_s * 3.6, 3)),
    );
    if let Some(sentence) = mirrored(outcome, summary) {
        page.fact("Road file", &sentence);
    }
    if let (Some(settings), Some(course)) = (&scenario.course, &summary.course) {
        page.fact("Manoeuvre", settings.kind.title());
        page.fact("Driver", course.driver);
        if course.side_slope_percent != 0.0 {
            page.fact("Side slope", &format!("{} %", course.side_slope_percent));
        }
    }
    page.fact("Load", summary.load);
    page.fact("Strategy", summary.strategy);
    page.fact("Bus, clock", &format!("{}, {}", summary.bus, summary.clock));
    page.fact("Seed", &scenario.seed.to_string());
    let (verdict, sentence) = headline::of(scenario, outcome, metrics, summary);
    page.verdict(verdict, &sentence);
    if !summary.checks.is_empty() {
        page.table(figures::gauge_table(scenario, metrics, summary));
    }
    let time = Time::of(scenario, outcome);
    page.figure(lanes::lanes(scenario, outcome, metrics, &time));
    page.scene(vehicle::scene(outcome, metrics, &time));
    events::section(&mut page, &events::of(scenario, outcome, metrics, summary));
    page.section("Figures").outcome(outcome_table(summary));
    body::road(&mut page, outcome, &time);
    course::section(&mut page, outcome, &time);
    body::section(&mut page, outcome, &time);
    struts::section(&mut page, outcome, &time);
    controller::section(&mut page, outcome, metrics, &time);
    bus::section(&mut page, outcome, metrics, summary);
    page
}

/// What a drive that is longer than its road file drove over; `None` where the file is long enough.
pub fn mirrored(outcome: &Outcome, summary: &Summary) -> Option<String> {
    let measured_m = summary.road_measured_m?;
    let driven_m = outcome.plant.recording.samples.last()?.motion.station_m;
    (driven_m > measured_m).then(|| {
        format!(
            "{} is {} m long. The {} m of this drive go over it and over its mirror image, back and forth.",
            summary.road,
            significant(measured_m, 3),
            significant(driven_m, 3)
        )
    })
}
