//! The mixed drive of `oleo study control`: rough road, lane change and rough road again, with every setting.

use oleo_hil::comparison::{Bench, ComparisonError, DriveCase, History, Setting, beginning_s, history};
use oleo_report::{Axis, Column, Curves, Page, Table};
use rayon::prelude::*;
use serde_json::{Value, json};

/// A quantity over time.
type Values = fn(&History) -> &[f64];

/// The road of the drive.
const ROAD: &str = "belgian";

/// The drive with every setting.
pub struct MixedDrive {
    name: String,
    /// Name of the setting, what happened, and whether it is drawn.
    driven: Vec<(String, History, bool)>,
}

impl MixedDrive {
    /// Drives, on the threads of the pool that it is called in. What `own` names is drawn beside the vehicle as sold, always soft and
    /// always stiff.
    pub fn new(bench: &Bench, settings: &[Setting], own: &str, seed: u64) -> Result<Self, ComparisonError> {
        let mut case = DriveCase::mixed(ROAD, seed);
        case.begins_s = beginning_s(bench, &case)?;
        let driven = settings
            .par_iter()
            .map(|setting| {
                let name = setting.name();
                let drawn = name == own || [Setting::AsSold, Setting::SOFT, Setting::STIFF].contains(setting);
                Ok((name, history(bench, &case, setting)?, drawn))
            })
            .collect::<Result<_, ComparisonError>>()?;
        let km_h = 3.6 * case.manoeuvre.initial_speed_m_s();
        let name = format!("{} on {ROAD}, {km_h:.0} km/h", case.manoeuvre_name());
        Ok(Self { name, driven })
    }

    /// The figures of each setting.
    pub fn summary(&self) -> Value {
        let of = |(name, history, _): &(String, History, bool)| {
            let figures = json!({
                "ride_before_m_s2": history.ride_before_m_s2,
                "peak_roll_deg": history.peak_roll_deg,
                "ride_after_m_s2": history.ride_after_m_s2,
            });
            (name.clone(), figures)
        };
        Value::Object(self.driven.iter().map(of).collect())
    }

    /// Adds a section with the histories and the figures.
    pub fn show(&self, page: &mut Page) {
        let section = page.section("One drive with both");
        section.text(&format!(
            "The drive {}: ten seconds straight ahead, the lane change, and straight ahead to the end. Before and after, ride counts, from the third \
             second on; in between, roll.",
            self.name
        ));
        section.figure(self.figure());
        section.table(self.table());
    }

    fn figure(&self) -> Curves {
        let mut figure = Curves::new("Soft, stiff, soft", Axis::new("Time", "s"));
        figure.caption(
            "Roll of the body; running RMS (1 s) of the vertical acceleration that the driver feels, weighted as in BS 6841; number of valves that are \
             commanded open. The manoeuvre is shaded. In it, little roll is better; before and after, little acceleration.",
        );
        let panels: [(Axis, Values); 3] = [
            (Axis::new("Roll", "degrees"), |history| &history.roll_deg),
            (Axis::new("Felt by the driver", "m/s2"), |history| &history.felt_m_s2),
            (Axis::new("Open valves", ""), |history| &history.open_valves),
        ];
        let cornering = self.driven.iter().find_map(|(_, history, _)| history.cornering_s);
        for (axis, values) in panels {
            let panel = figure.panel(axis);
            for (name, history, _) in self.driven.iter().filter(|(.., drawn)| *drawn) {
                // The vehicle as sold has no valves.
                if !values(history).is_empty() {
                    panel.line(name, &history.time_s, values(history));
                }
            }
            if let Some((begin_s, end_s)) = cornering {
                panel.region(begin_s, end_s, "");
            }
        }
        figure
    }

    fn table(&self) -> Table {
        let mut table = Table::new([
            Column::text("Setting"),
            Column::number("Ride before, m/s2"),
            Column::number("Peak roll, degrees"),
            Column::number("Ride after, m/s2"),
        ]);
        for (name, history, _) in &self.driven {
            table.row([
                name.clone(),
                format!("{:.2}", history.ride_before_m_s2),
                format!("{:.2}", history.peak_roll_deg),
                format!("{:.2}", history.ride_after_m_s2),
            ]);
        }
        table
    }
}
