//! `report.json` of a vehicle: the form of a specimen's report, with the corner before every place and channel.

use oleo_interface::Corner;
use serde_json::{Map, Value, json};

use super::body;
use super::campaign::VehicleCampaign;
use super::diagnosis::VehicleDiagnosis;
use super::driven;
use crate::json;
use crate::vocabulary::VehiclePart;

/// The report as a value. `runtime_s` is the only number that differs from run to run.
#[must_use]
pub fn report(campaign: &VehicleCampaign, diagnosis: &VehicleDiagnosis, runtime_s: f64) -> Value {
    let effects: Vec<Value> = (diagnosis.effects.iter())
        .map(|v| {
            let e = &v.effect;
            let mut value = json!({
                "id": e.id, "place": e.place.as_reported(), "confidence": json::rounded(e.confidence),
                "parameters": json::parameters(&e.parameters), "law": e.law,
                "held_out_noise_ratio": { "without": json::rounded(v.ratios[0]), "with": json::rounded(v.ratios[1]) },
            });
            if e.place.part == Some(VehiclePart::All) {
                value["at_corners"] = at_corners(diagnosis, v);
            }
            value
        })
        .collect();
    let mut out = json!({
        "verdict": diagnosis.verdict(),
        "effects": effects,
        "runtime_s": runtime_s,
        "notes": campaign.notes,
    });
    // The lists and tables of the corners one after the other, each entry with its corner.
    for key in ["locations", "rejected", "not_tested"] {
        out[key] = Value::Array(of_corners(campaign, diagnosis, key, |corner, mut entry| {
            let place = entry["place"]
                .as_str()
                .map(|place| format!("{}/{place}", corner.name()));
            entry["place"] = json!(place);
            entry
        }));
    }
    for key in ["relations", "relations_changed_alone", "calibration", "instruments"] {
        out[key] = Value::Array(of_corners(campaign, diagnosis, key, |corner, mut entry| {
            entry["corner"] = json!(corner.name());
            entry
        }));
    }
    out["correlated"] = Value::Array(of_corners(campaign, diagnosis, "correlated", |corner, pair| {
        let key = |k: usize| format!("{}/{}", corner.name(), pair[k].as_str().unwrap_or_default());
        json!([key(0), key(1), pair[2]])
    }));
    let mut ambiguous = of_corners(campaign, diagnosis, "ambiguous", |_, pair| pair);
    ambiguous.dedup();
    out["ambiguous"] = Value::Array(ambiguous);
    let next: Vec<String> = (diagnosis.corners.iter())
        .filter_map(|(corner, d)| {
            d.next_experiment
                .as_ref()
                .map(|next| format!("{}: {next}", corner.name()))
        })
        .collect();
    out["next_experiment"] = if next.is_empty() {
        Value::Null
    } else {
        json!(next.join(" "))
    };
    let mut fit = Map::new();
    for corner in Corner::ALL {
        if let Value::Object(channels) = &corner_report(campaign, diagnosis, corner)["fit"] {
            for (column, figures) in channels {
                fit.insert(format!("{}/{column}", corner.name()), figures.clone());
            }
        }
    }
    out["fit"] = Value::Object(fit);
    if let Some(found) = &diagnosis.body {
        out["body"] = body::report(found);
    }
    if let Some(felt) = &diagnosis.driven {
        out["driven"] = driven::report(felt);
    }
    out
}

/// The estimates of a shared effect at each corner, from which the common value was pooled.
fn at_corners(diagnosis: &VehicleDiagnosis, shared: &super::VehicleEffect) -> Value {
    let mut out = Map::new();
    for corner in Corner::ALL {
        let own: Vec<_> = (0..shared.effect.parameters.len())
            .filter_map(|k| diagnosis.at_corners(&shared.effect, k)[corner].cloned())
            .collect();
        out.insert(corner.name().to_owned(), json::parameters(&own));
    }
    Value::Object(out)
}

fn corner_report(campaign: &VehicleCampaign, diagnosis: &VehicleDiagnosis, corner: Corner) -> Value {
    json::report(&campaign.corners[corner], &diagnosis.corners[corner], 0.0)
}

fn of_corners(
    campaign: &VehicleCampaign,
    diagnosis: &VehicleDiagnosis,
    key: &str,
    entry: impl Fn(Corner, Value) -> Value,
) -> Vec<Value> {
    let mut out = Vec::new();
    for corner in Corner::ALL {
        if let Value::Array(entries) = corner_report(campaign, diagnosis, corner)[key].take() {
            out.extend(entries.into_iter().map(|value| entry(corner, value)));
        }
    }
    out
}
