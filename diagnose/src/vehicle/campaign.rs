//! Model and drives of a vehicle put together: a strut with its recordings at every corner.

use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, Corners};
use oleo_plant_sim::rig::implausible;
use oleo_plant_sim::strut::StrutModel;
use oleo_report::significant;

use super::body::BodyCampaign;
use super::bridge::bridge;
use super::command_timing::{a_sample_later, acts_later};
use super::drive::{Drive, Resolution};
use super::model::{BodyModel, VehicleModel};
use super::oil_count;
use super::stretch::{BridgedDrive, Chosen, choose};
use crate::campaign::{Campaign, MODEL_FILE};
use crate::error::DiagnoseError;
use crate::instrument::Flaw;
use crate::recording::Recording;
use crate::specimen::Specimen;
use crate::specimen::strut::TwoStageStrut;
use crate::units;

/// A rounded reading is off by at most half a step, and its error is even within: variance step^2 / 12.
const VARIANCE_OF_ROUNDING: f64 = 1.0 / 12.0;

/// Column of the displacement in the recording of a strut.
const DISPLACEMENT: usize = 0;

/// What is cut off the beginning of a drive is said where it is longer than this, s.
const NOTED_S: f64 = 0.5;

/// A vehicle ready to be diagnosed.
pub struct VehicleCampaign {
    /// The model files as they are believed, with oil counted as the drives show.
    pub model: VehicleModel,
    /// Each strut with its recordings.
    pub corners: Corners<Campaign>,
    /// The body with the drives that have an inertial unit, where the model says what is believed of it.
    pub body: Option<BodyCampaign>,
    /// What was used of the drives, one sentence each.
    pub notes: Vec<String>,
}

impl VehicleCampaign {
    /// Puts the model of a vehicle and its drives together. `source` names the drives in messages.
    ///
    /// # Errors
    /// Drives of which nothing can be used; a strut that cannot be at rest.
    pub fn of(
        mut model: VehicleModel,
        drives: &[Drive],
        resolution: &Corners<Resolution>,
        source: &str,
    ) -> Result<Self, DiagnoseError> {
        let bridged: Vec<BridgedDrive> = (drives.iter())
            .map(|drive| BridgedDrive {
                name: drive.name.clone(),
                is_first: drive.is_first,
                period_s: drive.period_s,
                struts: drive.struts.each_ref().map(|strut| bridge(strut, drive.period_s)),
            })
            .collect();
        let Chosen {
            mut recordings,
            mut notes,
        } = choose(&bridged, &model.starts_at_rest);
        if let Some(corner) = Corner::ALL.into_iter().find(|corner| recordings[*corner].is_empty()) {
            let why = notes.first().map_or_else(String::new, |note| format!(" ({note})"));
            let what = format!(
                "nothing of the {} strut can be used{why}; log drives that begin at rest, for at least a minute, or say starts_at_rest = false in the file of the strut",
                corner.name()
            );
            return Err(DiagnoseError::file(source, what));
        }
        let struts = Corners::from_fn(|corner| as_read(&model.struts[corner], resolution[corner]));
        let at_rest = &model.starts_at_rest;
        // Before commands are moved, so that both kinds of recordings begin at the same sample.
        for corner in Corner::ALL.into_iter().filter(|corner| !at_rest[*corner]) {
            for recording in &mut recordings[corner] {
                let cut_s = TwoStageStrut::let_begin_in_motion(recording);
                if cut_s > NOTED_S {
                    notes.push(format!(
                        "{}, {}: the first {cut_s:.2} s are not used: it begins where all readings are there and the valves stand still.",
                        recording.name,
                        corner.name()
                    ));
                }
            }
        }
        let at_once = specimens(&struts, &recordings, resolution, at_rest)?;
        check_units(&at_once)?;
        let commanded_later = (recordings.clone()).map(|all| all.into_iter().map(a_sample_later).collect());
        let a_tick_later = specimens(&struts, &commanded_later, resolution, at_rest)?;
        let period_s = drives.first().map_or(TICK_S, |drive| drive.period_s);
        let is_later = acts_later(&at_once, &a_tick_later, period_s)?;
        if is_later {
            let period_ms = (1e4 * period_s).round() / 10.0;
            notes.push(format!(
                "The commands act one tick ({period_ms} ms) after the sample whose tick they echo: with this the believed models fit the \
                 edges of the valves better."
            ));
        }
        let (mut as_believed, recordings) = if is_later {
            (a_tick_later, commanded_later)
        } else {
            (at_once, recordings)
        };
        let counted_at = oil_count::shown_by(&as_believed, &struts);
        let counting = oil_count::with_oil_counted_at(counted_at, &struts);
        if counting != struts {
            as_believed = specimens(&counting, &recordings, resolution, at_rest)?;
            model.struts = oil_count::with_oil_counted_at(counted_at, &model.struts);
            notes.push(oil_count::IS_KEPT.to_owned());
        }
        as_believed
            .values_mut()
            .for_each(|strut| strut.count_found_oil_at(counted_at));
        notes.extend(smaller_noise(&as_believed));
        let corners = as_believed
            .zip(Corners::from_fn(|corner| corner))
            .map(|(specimen, corner)| Campaign {
                name: format!("{} strut", corner.name()),
                specimen: Box::new(specimen),
                notes: vec![],
            });
        let (body, note) = BodyCampaign::of(&model, drives);
        notes.extend(note);
        Ok(Self {
            corners,
            model,
            body,
            notes,
        })
    }

    /// Names of the files in which the improved model is written: the struts', `model.toml`, and the body's where it has one.
    #[must_use]
    pub fn model_files(&self) -> Vec<String> {
        let struts = self.model.distinct_files().into_array();
        let body = self
            .model
            .body
            .as_ref()
            .and_then(BodyModel::own_file)
            .map(str::to_owned);
        std::iter::once(MODEL_FILE.to_owned())
            .chain(struts)
            .chain(body)
            .collect()
    }
}

/// Refuses a log whose database or map of signals takes a quantity for one in another unit.
fn check_units(struts: &Corners<TwoStageStrut>) -> Result<(), DiagnoseError> {
    for (corner, strut) in struts.iter() {
        let at_corner = |what: String| DiagnoseError::Model(format!("{} strut, {what}", corner.name()));
        for Recording {
            name, time_s, columns, ..
        } in strut.recordings()
        {
            if let Some(what) = implausible(time_s, Some(&columns[DISPLACEMENT])) {
                return Err(at_corner(format!("recording {name}: {what}")));
            }
        }
        units::check(strut).map_err(|error| at_corner(error.to_string()))?;
    }
    Ok(())
}

fn specimens(
    struts: &Corners<StrutModel>,
    recordings: &Corners<Vec<Recording>>,
    resolution: &Corners<Resolution>,
    starts_at_rest: &Corners<bool>,
) -> Result<Corners<TwoStageStrut>, DiagnoseError> {
    Corners::try_from_fn(|corner| {
        let (model, recordings) = (struts[corner].clone(), recordings[corner].clone());
        TwoStageStrut::in_vehicle(
            model,
            recordings,
            resolution[corner].pressure_pa,
            starts_at_rest[corner],
        )
        .map_err(DiagnoseError::Model)
    })
}

/// Says whose readings are judged by less noise than the files state; `None` if none are.
fn smaller_noise(struts: &Corners<TwoStageStrut>) -> Option<String> {
    let at = |(corner, strut): (Corner, &TwoStageStrut)| {
        let measured = strut
            .instruments()
            .iter()
            .filter_map(|finding| match (&finding.column, finding.flaw) {
                (Some(column), Flaw::OtherNoise { measured, .. }) => {
                    Some(format!("{} {}", column.as_str(), significant(measured, 3)))
                }
                _ => None,
            });
        let measured: Vec<String> = measured.collect();
        (!measured.is_empty()).then(|| format!("{}: {}", corner.name(), measured.join(", ")))
    };
    let all: Vec<String> = struts.iter().filter_map(at).collect();
    (!all.is_empty()).then(|| {
        format!(
            "Readings have less noise than the strut files state with the rounding of the bus. They are judged by what was measured (standard \
             deviation): {}.",
            all.join("; ")
        )
    })
}

/// A strut whose readings are rounded besides being noisy.
fn as_read(strut: &StrutModel, resolution: Resolution) -> StrutModel {
    let mut strut = strut.clone();
    for (column, noise) in &mut strut.noise {
        let step = match column.as_str() {
            "displacement_m" => resolution.displacement_m,
            "force_N" => 0.0,
            "p1_Pa" => resolution.pressure_pa.p1,
            "p2_Pa" => resolution.pressure_pa.p2,
            "p3_Pa" => resolution.pressure_pa.p3,
            _ => resolution.pressure_pa.p4,
        };
        *noise = (*noise * *noise + VARIANCE_OF_ROUNDING * step * step).sqrt();
    }
    strut
}
