//! The balance of the body in the diagnosis of a vehicle: its drives with an inertial unit, and what is found as JSON, words and a table.

use oleo_report::{Column, Page, Table, significant};
use serde_json::{Map, Value, json};

use super::drive::Drive;
use super::model::VehicleModel;
use crate::body::{Believed, BodyDrive, BodyEffect, BodyEffectId, BodyFindings, find};

/// What a payload means for what is said of the struts, which know nothing of the balance.
const STRUTS_UNDER_A_LOAD: &str = "Wrong static pressures of the struts are this load. What else is said of the struts is sure only if \
                                   their files state the static pressure under the load (static_pressure_Pa is p1 at rest).";

/// A believed body with drives that have an inertial unit.
pub struct BodyCampaign {
    believed: Believed,
    drives: Vec<BodyDrive>,
}

impl BodyCampaign {
    /// What can be balanced of a vehicle, and what a reader must know where it is nothing.
    pub fn of(model: &VehicleModel, drives: &[Drive]) -> (Option<Self>, Option<String>) {
        let with_unit: Vec<BodyDrive> = drives
            .iter()
            .filter(|drive| drive.inertial.is_there())
            .map(columns)
            .collect();
        match (&model.body, with_unit.is_empty()) {
            (None, true) => (None, None),
            (None, false) => {
                let note = "The drives have an inertial unit: with a table [body] in model.toml the body is balanced too (docs/diagnose.md).";
                (None, Some(note.to_owned()))
            }
            (Some(_), true) => {
                let note = "model.toml has a table [body], but no drive has an inertial unit (oleo hil --imu): the body is not balanced.";
                (None, Some(note.to_owned()))
            }
            (Some(body), false) => {
                let believed = Believed::new(&body.parameters, model.struts.clone(), body.unit_m);
                let drives = with_unit;
                (Some(Self { believed, drives }), None)
            }
        }
    }

    /// What the balance says.
    ///
    /// # Errors
    /// The drives do not suffice, in one sentence.
    pub fn find(&self) -> Result<BodyFindings, String> {
        find(&self.believed, &self.drives)
    }
}

/// The columns that the balance needs.
fn columns(drive: &Drive) -> BodyDrive {
    BodyDrive {
        period_s: drive.period_s,
        displacement_m: drive.struts.each_ref().map(|strut| strut.displacement_m.clone()),
        p1_pa: drive.struts.each_ref().map(|strut| strut.pressure_pa[0].clone()),
        specific_force_m_s2: drive.inertial.specific_force_m_s2.clone(),
        rate_rad_s: drive.inertial.rate_rad_s.clone(),
    }
}

/// The entry `body` of the report.
pub fn report(body: &Result<BodyFindings, String>) -> Value {
    let findings = match body {
        Ok(findings) => findings,
        Err(why) => return json!({ "effects": [], "not_balanced": why }),
    };
    let effects: Vec<Value> = (findings.effects.iter())
        .map(|effect| {
            let sizes = effect.parameters.iter();
            let sizes: Map<String, Value> = sizes
                .map(|size| {
                    (
                        size.name.to_owned(),
                        json!({ "value": size.value, "ci95": [size.low, size.high] }),
                    )
                })
                .collect();
            json!({ "id": effect.id.name(), "place": effect.id.place(), "parameters": sizes })
        })
        .collect();
    let [heave_n, pitch_n_m, roll_n_m] = findings.residual_rms;
    json!({
        "effects": effects,
        "used_s": findings.used_s,
        "residual_rms": { "heave_N": heave_n, "pitch_N_m": pitch_n_m, "roll_N_m": roll_n_m },
    })
}

/// What was found, in one sentence.
pub fn sentence(body: &Result<BodyFindings, String>) -> String {
    match body {
        Err(why) => format!(" The body: {why}."),
        Ok(findings) if findings.effects.is_empty() => {
            " The body balances as it is believed to: no payload, broken bar, friction at a corner or unit that is askew.".to_owned()
        }
        Ok(findings) => {
            let found: Vec<String> = findings.effects.iter().map(phrase).collect();
            let struts = if has_payload(findings) {
                format!(" {STRUTS_UNDER_A_LOAD}")
            } else {
                String::new()
            };
            format!(" The balance of the body shows {}.{struts}", found.join("; "))
        }
    }
}

fn has_payload(findings: &BodyFindings) -> bool {
    findings.effects.iter().any(|effect| effect.id == BodyEffectId::Payload)
}

fn phrase(effect: &BodyEffect) -> String {
    let what = match effect.id {
        BodyEffectId::Payload => "a mass that the model lacks".to_owned(),
        BodyEffectId::AntiRollBar(_) => {
            format!("an anti-roll bar at the {} that has lost stiffness", effect.id.place())
        }
        BodyEffectId::CornerFriction(_) => format!("friction {} that the model lacks", effect.id.place()),
        BodyEffectId::UnitMounting => "an inertial unit that is mounted askew".to_owned(),
    };
    let sizes = effect.parameters.iter();
    let sizes: Vec<String> = sizes
        .map(|size| format!("{} {}", size.name, significant(size.value, 3)))
        .collect();
    format!("{what} ({})", sizes.join(", "))
}

/// The section of the page.
pub fn section(page: &mut Page, body: &Result<BodyFindings, String>) {
    page.section("The body in the balance");
    let findings = match body {
        Ok(findings) => findings,
        Err(why) => {
            page.text(&format!("{why}."));
            return;
        }
    };
    page.text(&format!(
        "Forces of struts and anti-roll bars against the accelerations of the inertial unit, over {:.0} s straight ahead below 6 Hz, without \
         knowledge of the road. What is left has an RMS of {} N in heave, {} N m in pitch and {} N m in roll.",
        findings.used_s,
        significant(findings.residual_rms[0], 2),
        significant(findings.residual_rms[1], 2),
        significant(findings.residual_rms[2], 2),
    ));
    if findings.effects.is_empty() {
        page.text("Nothing is named: all differences are within what a vehicle may differ from its model by.");
        return;
    }
    if has_payload(findings) {
        page.text(STRUTS_UNDER_A_LOAD);
    }
    let mut table = Table::new([
        Column::text("Found"),
        Column::text("Place"),
        Column::text("Size"),
        Column::number("Value"),
        Column::text("95 % interval"),
    ]);
    for effect in &findings.effects {
        for size in &effect.parameters {
            table.row([
                effect.id.name().to_owned(),
                effect.id.place().to_owned(),
                size.name.to_owned(),
                significant(size.value, 4),
                format!("{} to {}", significant(size.low, 4), significant(size.high, 4)),
            ]);
        }
    }
    page.table(table);
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::Axle;

    #[test]
    fn a_payload_comes_with_a_warning_about_the_struts() {
        let found = |id: BodyEffectId| {
            Ok(BodyFindings {
                effects: vec![BodyEffect { id, parameters: vec![] }],
                used_s: 60.0,
                residual_rms: [1.0; 3],
            })
        };
        assert!(sentence(&found(BodyEffectId::Payload)).contains("static_pressure_Pa"));
        assert!(!sentence(&found(BodyEffectId::AntiRollBar(Axle::Rear))).contains("static_pressure_Pa"));
    }
}
