//! `report.json`: the schema of the recordings' README, plus what a careful reader wants besides (`not_tested`,
//! `calibration`, `relations`, `notes`).

use serde_json::{Map, Value, json};

use crate::campaign::Campaign;
use crate::diagnosis::{Diagnosis, Estimate};
use crate::effect::Candidate;
use crate::locate::condition::Region;
use crate::search::LeastSize;
use crate::specimen::Specimen;
use crate::vocabulary::Column;

/// The report as a value. `runtime_s` is the only number that differs from run to run.
#[must_use]
pub fn report(campaign: &Campaign, diagnosis: &Diagnosis, runtime_s: f64) -> Value {
    let specimen = &*campaign.specimen;
    let locations: Vec<Value> = (diagnosis.locations.iter())
        .map(|l| {
            json!({
                "place": l.place.to_string(), "share_of_excess": rounded(l.share_of_excess),
                "where": {
                    "recording": specimen.recording_name(l.recording), "t_s": l.t_s, "condition": l.condition.text,
                    "channel": specimen.channels()[l.channel].column.as_str(), "region": l.condition.region.as_ref().map(region),
                },
            })
        })
        .collect();
    let effects: Vec<Value> = (diagnosis.effects.iter())
        .map(|e| {
            let mut effect = json!({
                "id": e.id, "place": e.place.as_reported(), "confidence": rounded(e.confidence),
                "parameters": parameters(&e.parameters), "law": e.law,
                "held_out_noise_ratio": { "without": rounded(e.ratio_without), "with": rounded(e.ratio_with) },
            });
            if let Some(equation) = &e.equation {
                effect["equation"] = json!(equation);
            }
            effect
        })
        .collect();
    let mut channels = Map::new();
    for (c, w) in diagnosis.channels.iter().zip(&diagnosis.whiteness) {
        channels.insert(
            c.column.to_string(),
            json!({
                "noise_ratio_before": rounded(c.before), "noise_ratio_after": rounded(c.after),
                "held_out_before": rounded(c.held_out_before), "held_out_after": rounded(c.held_out_after),
                "residual_lag_one_correlation": rounded(c.lag_one), "ljung_box": rounded(w.ljung_box),
                "input_correlation": w.input.as_ref().map(|(input, r)| json!({ "input": input.as_str(), "value": rounded(*r), "bound99": rounded(w.bound) })),
            }),
        );
    }
    let calibration: Vec<Value> = (diagnosis.calibration.iter())
        .map(|c| {
            let e = &c.estimate;
            json!({ "key": e.key, "value": e.value, "ci95": interval(e), "tolerance_used": rounded(c.tolerance_used) })
        })
        .collect();
    let relations: Vec<Value> = (diagnosis.relations.iter())
        .map(|r| json!({ "relation": r.name, "noise_ratio": r.noise_ratio.map(rounded), "samples": r.samples }))
        .collect();
    let changed: Vec<Value> = (diagnosis.changed_relations.iter())
        .map(|r| {
            json!({ "relation": r.relation, "share_of_excess": rounded(r.share_of_excess),
                    "by": specimen.candidates()[r.candidate].name() })
        })
        .collect();
    let correlations: Vec<Value> = (diagnosis.correlations.iter())
        .map(|c| json!([c.keys[0], c.keys[1], rounded(c.coefficient)]))
        .collect();
    json!({
        "verdict": diagnosis.verdict(),
        "locations": locations,
        "effects": effects,
        "rejected": rejected(specimen, diagnosis),
        "ambiguous": diagnosis.ambiguous,
        "next_experiment": diagnosis.next_experiment,
        "fit": channels,
        "runtime_s": runtime_s,
        "not_tested": not_tested(specimen),
        "relations": relations,
        "relations_changed_alone": changed,
        "calibration": calibration,
        "correlated": correlations,
        "instruments": instruments(specimen),
        "notes": campaign.notes,
    })
}

/// What the instruments do that the model file does not state.
fn instruments(specimen: &dyn Specimen) -> Vec<Value> {
    (specimen.instruments().iter())
        .map(|finding| {
            let numbers = finding.flaw.numbers().into_iter();
            let numbers: Map<String, Value> = numbers.map(|(key, number)| (key.to_owned(), json!(number))).collect();
            json!({
                "column": finding.column.as_ref().map(Column::as_str), "flaw": finding.flaw.name(),
                "numbers": numbers, "text": finding.text(),
            })
        })
        .collect()
}

/// Candidates that were tested and are not in the model, the strongest first, with the figures that reject them.
#[must_use]
pub fn rejected(specimen: &dyn Specimen, diagnosis: &Diagnosis) -> Vec<Value> {
    let selection = &diagnosis.selection;
    let all = specimen.candidates();
    let mut scores: Vec<_> = (selection.scores.iter())
        .filter(|s| !selection.best.point.effects.contains(&s.candidate))
        .collect();
    scores.sort_by(|a, b| a.alone.total_cmp(&b.alone));
    (scores.iter())
        .map(|t| {
            let c = &all[t.candidate];
            let alone = if t.alone.is_finite() {
                format!(
                    "alone it brings the held-out noise ratio from {:.3} to {:.3}",
                    selection.calibrated_ratio, t.alone
                )
            } else {
                "alone it could not be fitted to these recordings".to_owned()
            };
            let why = match t.added {
                Some(added) => format!(
                    "{alone}; added to the chosen model from {:.3} to {added:.3}",
                    selection.improved_ratio
                ),
                None => format!("{alone}; it excludes or is excluded by an effect of the chosen model"),
            };
            json!({ "id": c.id, "place": c.place_and_label(), "why": why, "shown_from": shown_from(c, &t.least_sizes) })
        })
        .collect()
}

/// The sizes from which the recordings would have shown an effect, by their keys.
fn shown_from(candidate: &Candidate, least_sizes: &[LeastSize]) -> Value {
    let sizes = least_sizes.iter().map(|least| {
        let number = &candidate.parameters[least.parameter];
        let value = least.value.map(|value| number.reported(value));
        (number.reported_key().to_owned(), json!(value))
    });
    Value::Object(sizes.collect())
}

/// Candidates that the recordings cannot show.
#[must_use]
pub fn not_tested(specimen: &dyn Specimen) -> Vec<Value> {
    (specimen.candidates().iter())
        .filter_map(|c| {
            c.untestable
                .as_ref()
                .map(|why| json!({ "id": c.id, "place": c.place.to_string(), "why": why }))
        })
        .collect()
}

fn region(r: &Region) -> Value {
    json!({ "state": r.state.as_str(), "from": r.from, "to": r.to, "share_of_misfit": rounded(r.share_of_misfit),
            "share_of_samples": rounded(r.share_of_samples) })
}

/// Estimates by their keys.
pub(crate) fn parameters(estimates: &[Estimate]) -> Value {
    let mut out = Map::new();
    for e in estimates {
        out.insert(e.key.clone(), json!({ "value": e.value, "ci95": interval(e) }));
    }
    Value::Object(out)
}

/// JSON has no infinity: an end that the recordings do not determine is null.
fn interval(e: &Estimate) -> Value {
    let end = |v: f64| if v.is_finite() { json!(v) } else { Value::Null };
    json!([end(e.ci95[0]), end(e.ci95[1])])
}

/// Four digits after the point, which is more than any ratio is known to; 0 for what is not finite.
pub(crate) fn rounded(v: f64) -> f64 {
    if v.is_finite() { (v * 1e4).round() / 1e4 } else { 0.0 }
}
