//! How well `oleo diagnose` finds altered struts in the logs of a vehicle: makes campaigns with a known answer, diagnoses each, and
//! prints what was found beside what was concealed.
//!
//! ```text
//! cargo build --release && cargo run --release --example vehicle_logs -- DIR [--seeds N] [--first SEED] [--without-noise] [CASE...]
//! cargo build --release && cargo run --release --example vehicle_logs -- DIR --drawn N [--wrong-numbers] [--in-motion] [--first SEED] [--without-noise]
//! ```
//!
//! The first form runs listed cases of one effect each, the second N campaigns in which effects, corners, sizes and drives are drawn, or
//! one wrong number of one strut's model, with logs that begin at rest or in the middle of a drive. `--without-noise` leaves the readings as the bus rounds
//! them, like those of `oleo hil`, although the strut files state a noise. DIR gets a folder for each campaign, with its answer and the results of the diagnosis.

#[path = "../../tests/support/vehicle_campaign.rs"]
mod vehicle_campaign;

mod drawn;
mod listed;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use oleo_diagnose::effect::TrueNumber;
use oleo_diagnose::vocabulary::EffectId;
use oleo_interface::Corner;
use oleo_report::{Column, Table};
use vehicle_campaign::{Case, TrueAtCorner, write};

/// Effects that act on the force alone, which no log of a vehicle holds: nothing is the right answer.
const ON_FORCE_ALONE: [EffectId; 3] = [EffectId::SealFriction, EffectId::SideLoadFriction, EffectId::BumpStop];

const USAGE: &str = "usage: vehicle_logs DIR [--seeds N] [--first SEED] [--without-noise] [CASE...]
       vehicle_logs DIR --drawn N [--wrong-numbers] [--in-motion] [--first SEED] [--without-noise]";

/// Says how this program is called, and ends it.
fn usage() -> ! {
    eprintln!("{USAGE}");
    std::process::exit(2)
}

fn main() {
    let mut words = std::env::args().skip(1);
    let (mut folder, mut seeds, mut drawn, mut first, mut wanted) = (None, 1, 0, 1, Vec::new());
    let (mut wrong_numbers, mut in_motion, mut without_noise) = (false, false, false);
    while let Some(word) = words.next() {
        let number = |next: Option<String>| next.and_then(|n| n.parse().ok()).unwrap_or_else(|| usage());
        match word.as_str() {
            "--seeds" => seeds = number(words.next()),
            "--drawn" => drawn = number(words.next()),
            "--wrong-numbers" => wrong_numbers = true,
            "--in-motion" => in_motion = true,
            "--without-noise" => without_noise = true,
            "--first" => first = number(words.next()),
            "--help" | "-h" => {
                println!("{USAGE}");
                return;
            }
            _ if word.starts_with('-') => usage(),
            _ if folder.is_none() => folder = Some(PathBuf::from(word)),
            _ => wanted.push(word),
        }
    }
    let folder = folder.unwrap_or_else(|| usage());
    let mut cases: Vec<(String, Case)> = if drawn > 0 {
        let all = first..first + drawn;
        let case = if wrong_numbers {
            drawn::wrong_number
        } else {
            drawn::case
        };
        all.map(|seed| (format!("drawn-{seed}"), case(seed, in_motion)))
            .collect()
    } else {
        (first..first + seeds)
            .flat_map(|seed| listed::cases(seed, &wanted))
            .collect()
    };
    cases
        .iter_mut()
        .for_each(|(_, case)| case.without_noise = without_noise);
    let mut table = Table::new([
        Column::text("Campaign"),
        Column::text("Concealed"),
        Column::text("Found"),
        Column::text("Exact"),
        Column::number("Noise ratio before (worst channel)"),
        Column::number("after"),
        Column::number("Time, s"),
    ]);
    let mut total = Total::default();
    for (name, case) in &cases {
        let campaign = folder.join(name);
        std::fs::create_dir_all(&campaign).expect("a folder for a campaign");
        let truth = answer(case, write(case, &campaign));
        let text = serde_json::to_string_pretty(&truth.iter().map(Answer::to_json).collect::<Vec<_>>());
        std::fs::write(campaign.join("answer.json"), text.expect("an answer in JSON")).expect("a written answer");
        let begun = Instant::now();
        let report = diagnose(&campaign);
        let took_s = begun.elapsed().as_secs_f64();
        let found = found(&report);
        let mut concealed: Vec<String> = truth.iter().map(|a| a.effect.clone()).collect();
        concealed.dedup();
        let exact = total.add(&truth, &concealed, &found, &report);
        table.row([
            name.clone(),
            concealed.join(" "),
            found.join(" "),
            if exact { "yes" } else { "no" }.to_owned(),
            format!("{:.2}", worst(&report, "held_out_before")),
            format!("{:.2}", worst(&report, "held_out_after")),
            format!("{took_s:.0}"),
        ]);
        eprintln!(
            "{name}: {}, concealed {concealed:?}, found {found:?}, {took_s:.0} s",
            if exact { "exact" } else { "not exact" }
        );
    }
    println!("{table}\n{total}");
}

/// A number that was concealed.
struct Answer {
    /// Id and place, as a report should give them.
    effect: String,
    number: TrueNumber,
}

impl Answer {
    fn to_json(&self) -> serde_json::Value {
        serde_json::json!({"effect": self.effect, "key": self.number.key, "value": self.number.value})
    }
}

/// What all campaigns together say.
#[derive(Default)]
struct Total {
    campaigns: usize,
    exact: usize,
    concealed: usize,
    found: usize,
    not_there: usize,
    numbers: usize,
    inside: usize,
}

impl Total {
    /// Counts a campaign, and says whether exactly what can be seen of it was found.
    fn add(&mut self, truth: &[Answer], concealed: &[String], found: &[String], report: &serde_json::Value) -> bool {
        let exact = concealed == found;
        self.campaigns += 1;
        self.exact += usize::from(exact);
        self.concealed += concealed.len();
        self.found += concealed.iter().filter(|c| found.contains(c)).count();
        self.not_there += found.iter().filter(|f| !concealed.contains(f)).count();
        for answer in truth {
            let Some([low, high]) = interval(report, answer) else {
                continue;
            };
            self.numbers += 1;
            self.inside += usize::from((low..=high).contains(&answer.number.value));
        }
        exact
    }
}

impl std::fmt::Display for Total {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            campaigns,
            exact,
            concealed,
            found,
            not_there,
            numbers,
            inside,
        } = self;
        write!(
            f,
            "{exact} of {campaigns} exact; {found} of {concealed} effects found, {not_there} reported that are not there; {inside} of \
             {numbers} true numbers inside their 95 % intervals"
        )
    }
}

/// What is concealed and can be seen, in the order of its id and place. What all corners have is told by the first of them.
fn answer(case: &Case, all: Vec<TrueAtCorner>) -> Vec<Answer> {
    let mut answers: Vec<Answer> = (all.into_iter())
        .filter(|truth| !ON_FORCE_ALONE.contains(&truth.id))
        .filter_map(|TrueAtCorner { corner, id, number }| {
            let corners = &case
                .concealed
                .iter()
                .find(|c| c.id == id && c.corners.contains(&corner))?
                .corners;
            let part = if corners.len() == Corner::ALL.len() {
                "vehicle"
            } else {
                corner.name()
            };
            let site = number.site.to_string().replace("accumulators", "both accumulators");
            let effect = format!("{id}@{part}/{site}");
            (corner == corners[0]).then_some(Answer { effect, number })
        })
        .collect();
    answers.sort_by(|a, b| a.effect.cmp(&b.effect));
    answers
}

/// The 95 % interval that a report states for a number; `None` if it does not have the effect or the number.
fn interval(report: &serde_json::Value, answer: &Answer) -> Option<[f64; 2]> {
    let effects = report["effects"].as_array()?;
    let own = effects.iter().find(|e| named(e) == answer.effect)?;
    let ends = own["parameters"][&answer.number.key]["ci95"].as_array()?;
    Some([ends.first()?.as_f64()?, ends.get(1)?.as_f64()?])
}

/// Id and place of an effect of a report.
fn named(effect: &serde_json::Value) -> String {
    let text = |key: &str| effect[key].as_str().unwrap_or_default();
    format!("{}@{}", text("id"), text("place"))
}

fn diagnose(campaign: &Path) -> serde_json::Value {
    let here = std::env::current_exe().expect("this program has a path");
    let oleo = here
        .parent()
        .and_then(Path::parent)
        .expect("it lies in target/release/examples")
        .join("oleo");
    let out = campaign.join("found");
    let run = Command::new(oleo)
        .arg("diagnose")
        .arg(campaign)
        .arg("--out")
        .arg(&out)
        .output()
        .expect("oleo is built");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = std::fs::read_to_string(out.join("report.json")).expect("a report");
    serde_json::from_str(&text).expect("a report in JSON")
}

fn found(report: &serde_json::Value) -> Vec<String> {
    let effects = report["effects"].as_array().expect("a list of effects");
    let mut all: Vec<String> = effects.iter().map(named).collect();
    all.sort();
    all.dedup();
    all
}

/// The largest of a figure over all channels.
fn worst(report: &serde_json::Value, figure: &str) -> f64 {
    let channels = report["fit"].as_object().expect("figures of the channels");
    channels.values().filter_map(|c| c[figure].as_f64()).fold(0.0, f64::max)
}
