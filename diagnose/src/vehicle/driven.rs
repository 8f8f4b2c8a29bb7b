//! What the driver feels of what was found, as JSON, words and a table: the closed loop with the vehicle as it is believed to be and as it was found.
//!
//! This crate does not know the loop; whoever does drives it and fills in [`Driven`].

use oleo_report::{Column, Page, Table, significant};
use serde_json::{Value, json};

use crate::json::rounded;

/// Drives of each kind, over one road after the other. A small change of the vehicle moves the instant at which the springs close: a centimetre in the
/// height of a payload changed the roll of a single drive by two fifths, and the mean of 16 by 2 %.
pub const DRIVES: usize = 16;
/// Student's t for 95 % with [`DRIVES`] differences.
const STUDENT_T: f64 = 2.131;

/// What is felt of a vehicle in a drive of each kind.
#[derive(Debug, Clone, Copy)]
pub struct Felt {
    /// Weighted RMS acceleration (BS 6841) at the driver's seat on the rough road, m/s2.
    pub driver_m_s2: f64,
    /// The same at the left rear passenger's seat.
    pub rear_left_m_s2: f64,
    /// Largest roll of the body in the lane change, degrees.
    pub roll_deg: f64,
}

impl Felt {
    /// Names, units and values of the figures, in order. The names are those of the loop's `summary.json`.
    const fn figures(self) -> [(&'static str, &'static str, f64); 3] {
        [
            (
                "weighted_rms_driver_m_s2",
                "weighted RMS, driver's seat, m/s2",
                self.driver_m_s2,
            ),
            (
                "weighted_rms_rear_left_m_s2",
                "weighted RMS, left rear seat, m/s2",
                self.rear_left_m_s2,
            ),
            ("max_roll_deg", "largest roll, degrees", self.roll_deg),
        ]
    }
}

/// The drives of the closed loop, and what is felt in them.
#[derive(Debug, Clone)]
pub struct Driven {
    /// Name of the built-in drive straight ahead over a rough road.
    pub rough_road: String,
    /// Name of the built-in drive with a lane change.
    pub lane_change: String,
    /// With the vehicle as it is believed to be, over one road after the other.
    pub believed: [Felt; DRIVES],
    /// With the vehicle as it was found, over the same roads.
    pub found: [Felt; DRIVES],
}

/// A figure over all drives.
struct Compared {
    /// Name in `report.json`.
    key: &'static str,
    /// Name and unit in words.
    name: &'static str,
    /// Mean as believed.
    believed: f64,
    /// Mean as found.
    found: f64,
    /// Half of the 95 % interval of the change, from the differences road by road.
    half: f64,
}

impl Driven {
    fn figures(&self) -> [Compared; 3] {
        let mean = |values: &[f64; DRIVES]| values.iter().sum::<f64>() / DRIVES as f64;
        [0, 1, 2].map(|k| {
            let (key, name, _) = self.believed[0].figures()[k];
            let of = |felt: &[Felt; DRIVES]| felt.map(|felt| felt.figures()[k].2);
            let (believed, found) = (of(&self.believed), of(&self.found));
            let changes = std::array::from_fn(|drive| found[drive] - believed[drive]);
            let change = mean(&changes);
            let squares: f64 = changes.iter().map(|one| (one - change) * (one - change)).sum();
            let deviation_of_mean = (squares / ((DRIVES - 1) * DRIVES) as f64).sqrt();
            Compared {
                key,
                name,
                believed: mean(&believed),
                found: mean(&found),
                half: STUDENT_T * deviation_of_mean,
            }
        })
    }
}

impl Compared {
    const fn change(&self) -> f64 {
        self.found - self.believed
    }

    const fn ends(&self) -> [f64; 2] {
        [self.change() - self.half, self.change() + self.half]
    }

    fn in_words(&self, unit: &str) -> String {
        let [low, high] = self.ends();
        let unsure = if low <= 0.0 && high >= 0.0 {
            ", no sure change"
        } else {
            ""
        };
        let [believed, found] = [self.believed, self.found].map(|value| significant(value, 3));
        format!("{believed} and {found} {unit}{unsure}")
    }
}

/// The drives, or why there are none, as part of `report.json`.
pub fn report(driven: &Result<Driven, String>) -> Value {
    let driven = match driven {
        Ok(driven) => driven,
        Err(why) => return json!({ "not_driven": why }),
    };
    let figures = driven.figures();
    let each = |value: &dyn Fn(&Compared) -> Value| -> Value {
        Value::Object(figures.iter().map(|one| (one.key.to_owned(), value(one))).collect())
    };
    json!({
        "rough_road": driven.rough_road,
        "lane_change": driven.lane_change,
        "drives": DRIVES,
        "believed": each(&|one| json!(rounded(one.believed))),
        "found": each(&|one| json!(rounded(one.found))),
        "change": each(&|one| json!({ "value": rounded(one.change()), "ci95": one.ends().map(rounded) })),
    })
}

/// The drives in a section of the page.
pub fn section(page: &mut Page, driven: &Result<Driven, String>) {
    page.section("What the driver feels of it");
    let driven = match driven {
        Ok(driven) => driven,
        Err(why) => {
            page.text(&format!(
                "The closed loop could not be driven with the vehicle that was found: {why}"
            ));
            return;
        }
    };
    page.text(&format!(
        "The closed loop of controller and vehicle, as the vehicle is believed to be and as it was found: with the effects, and with the numbers of \
         the struts that were fitted within their tolerances. What the balance of the body names is there too; a mass stands in the middle \
         plane, as high as it can be. The figures are means of {DRIVES} drives over different roads (oleo hil --scenario NAME --seed 1 to \
         {DRIVES}): the ride is that of the scenario \"{}\", the roll that of \"{}\". In all of them the controller is told of the believed vehicle \
         with the believed front left strut. Instruments are taken to be right, and each strut is charged for the load that it carries.",
        driven.rough_road, driven.lane_change
    ));
    let mut table = Table::new([
        Column::text("Figure"),
        Column::number("As believed"),
        Column::number("As found"),
        Column::number("Change"),
        Column::text("95 % interval"),
    ]);
    for one in driven.figures() {
        let [low, high] = one.ends().map(|end| significant(end, 3));
        table.row([
            one.name.to_owned(),
            significant(one.believed, 3),
            significant(one.found, 3),
            significant(one.change(), 3),
            format!("{low} to {high}"),
        ]);
    }
    page.table(table);
}

/// The drives in a sentence for the terminal.
#[must_use]
pub fn driven_in_words(driven: &Result<Driven, String>) -> String {
    match driven {
        Ok(driven) => {
            let [driver, _, roll] = driven.figures();
            format!(
                "In the mean of {DRIVES} drives as believed and as found, the driver feels {} (weighted RMS, {}), and the body rolls by at most {} ({}).",
                driver.in_words("m/s2"),
                driven.rough_road,
                roll.in_words("degrees"),
                driven.lane_change,
            )
        }
        Err(why) => format!("The closed loop could not be driven with the vehicle that was found: {why}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Drives in which the roll as found is 1 degree larger in the mean, by turns 0.5 and 1.5.
    fn driven() -> Driven {
        let believed = Felt {
            driver_m_s2: 2.0,
            rear_left_m_s2: 2.5,
            roll_deg: 4.0,
        };
        Driven {
            rough_road: "belgian".into(),
            lane_change: "lane-change-on-belgian".into(),
            believed: [believed; DRIVES],
            found: std::array::from_fn(|drive| Felt {
                driver_m_s2: 2.2,
                roll_deg: if drive % 2 == 0 { 4.5 } else { 5.5 },
                ..believed
            }),
        }
    }

    #[test]
    fn what_is_felt_is_told_side_by_side() {
        let words = driven_in_words(&Ok(driven()));
        assert!(
            words.contains("feels 2.00 and 2.20 m/s2 (") && words.contains("at most 4.00 and 5.00 degrees ("),
            "{words}"
        );
        let mut by_chance = driven();
        (by_chance.found.iter_mut().enumerate())
            .for_each(|(drive, felt)| felt.roll_deg = if drive < 9 { 3.0 } else { 5.0 });
        let words = driven_in_words(&Ok(by_chance));
        assert!(words.contains("4.00 and 3.88 degrees, no sure change ("), "{words}");
        let value = report(&Ok(driven()));
        assert_eq!(value["found"]["max_roll_deg"], 5.0);
        assert_eq!(value["believed"]["weighted_rms_rear_left_m_s2"], 2.5);
        // The deviation of a single difference is 0.5 sqrt(16 / 15) degrees; a quarter of it is that of the mean.
        let change = &value["change"]["max_roll_deg"];
        let half = 2.131 * 0.125 * (16.0_f64 / 15.0).sqrt();
        assert_eq!(change["value"], 1.0);
        assert!(
            (change["ci95"][1].as_f64().expect("a number") - 1.0 - half).abs() < 1e-4,
            "{change}"
        );
        assert_eq!(
            value["change"]["weighted_rms_rear_left_m_s2"]["ci95"],
            json!([0.0, 0.0])
        );
    }

    #[test]
    fn a_loop_that_cannot_be_driven_says_why() {
        let failed = Err("front-left: it cannot be at rest".to_owned());
        assert_eq!(report(&failed)["not_driven"], "front-left: it cannot be at rest");
        assert!(driven_in_words(&failed).ends_with("it cannot be at rest"));
    }
}
