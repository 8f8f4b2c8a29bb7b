//! What the driver feels of what was found, as JSON, words and a table: the closed loop with the vehicle as it is believed to be and as it was found.
//!
//! This crate does not know the loop; whoever does drives it and fills in [`Driven`].

use oleo_report::{Column, Page, Table, significant};
use serde_json::{Value, json};

use crate::json::rounded;

/// What is felt of a vehicle.
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
    /// With the vehicle as it is believed to be.
    pub believed: Felt,
    /// With the vehicle as it was found.
    pub found: Felt,
}

/// The drives, or why there are none, as part of `report.json`.
pub fn report(driven: &Result<Driven, String>) -> Value {
    let driven = match driven {
        Ok(driven) => driven,
        Err(why) => return json!({ "not_driven": why }),
    };
    let felt = |felt: Felt| -> Value {
        let figures = felt
            .figures()
            .map(|(name, _, value)| (name.to_owned(), json!(rounded(value))));
        Value::Object(figures.into_iter().collect())
    };
    json!({
        "rough_road": driven.rough_road,
        "lane_change": driven.lane_change,
        "believed": felt(driven.believed),
        "found": felt(driven.found),
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
         plane, as high as it can be. The ride is that of the scenario \"{}\", the roll that of \"{}\" (oleo hil --scenario NAME). In both the \
         controller is told of the believed vehicle with the believed front left strut. Instruments are taken to be right, and each strut is \
         charged for the load that it carries.",
        driven.rough_road, driven.lane_change
    ));
    let mut table = Table::new([
        Column::text("Figure"),
        Column::number("As believed"),
        Column::number("As found"),
        Column::number("Found / believed"),
    ]);
    for ((_, name, believed), (_, _, found)) in driven.believed.figures().into_iter().zip(driven.found.figures()) {
        let ratio = significant(found / believed, 3);
        table.row([name.to_owned(), significant(believed, 3), significant(found, 3), ratio]);
    }
    page.table(table);
}

/// The drives in a sentence for the terminal.
#[must_use]
pub fn driven_in_words(driven: &Result<Driven, String>) -> String {
    match driven {
        Ok(driven) => {
            let (believed, found) = (driven.believed, driven.found);
            format!(
                "As believed and as found, the driver feels {} and {} m/s2 (weighted RMS, {}), and the body rolls by {} and {} degrees ({}).",
                significant(believed.driver_m_s2, 3),
                significant(found.driver_m_s2, 3),
                driven.rough_road,
                significant(believed.roll_deg, 3),
                significant(found.roll_deg, 3),
                driven.lane_change,
            )
        }
        Err(why) => format!("The closed loop could not be driven with the vehicle that was found: {why}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driven() -> Driven {
        let believed = Felt {
            driver_m_s2: 2.0,
            rear_left_m_s2: 2.5,
            roll_deg: 4.0,
        };
        Driven {
            rough_road: "belgian".into(),
            lane_change: "lane-change-on-belgian".into(),
            believed,
            found: Felt {
                driver_m_s2: 2.2,
                roll_deg: 5.0,
                ..believed
            },
        }
    }

    #[test]
    fn what_is_felt_is_told_side_by_side() {
        let words = driven_in_words(&Ok(driven()));
        assert!(
            words.contains("feels 2.00 and 2.20 m/s2") && words.contains("by 4.00 and 5.00 degrees"),
            "{words}"
        );
        let value = report(&Ok(driven()));
        assert_eq!(value["found"]["max_roll_deg"], 5.0);
        assert_eq!(value["believed"]["weighted_rms_rear_left_m_s2"], 2.5);
    }

    #[test]
    fn a_loop_that_cannot_be_driven_says_why() {
        let failed = Err("front-left: it cannot be at rest".to_owned());
        assert_eq!(report(&failed)["not_driven"], "front-left: it cannot be at rest");
        assert!(driven_in_words(&failed).ends_with("it cannot be at rest"));
    }
}
