//! The model files of a vehicle: `model.toml` names the files of its four struts.

use std::path::Path;

use oleo_interface::{Corner, Corners};
use oleo_plant_sim::model_file::{Checked, InvalidValue, Limit, read};
use oleo_plant_sim::specimen::specimen_name;
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::VehicleParameters;
use serde::{Deserialize, Serialize};

use crate::error::DiagnoseError;

/// What `[specimen] kind` says of a vehicle.
pub const VEHICLE: &str = "vehicle";

/// A vehicle as it is believed to be: the models of its struts.
#[derive(Debug, Clone)]
pub struct VehicleModel {
    /// Name of the vehicle.
    pub name: String,
    /// Names of the struts' files, without a folder.
    pub files: Corners<String>,
    /// The struts.
    pub struts: Corners<StrutModel>,
    /// Whether the drives begin with each strut at rest; where they do not, the state of its gas is fitted.
    pub starts_at_rest: Corners<bool>,
    /// The body with an inertial unit, where something is believed of it.
    pub body: Option<BodyModel>,
}

/// The body of a vehicle with an inertial unit.
#[derive(Debug, Clone)]
pub struct BodyModel {
    /// Name of the file of the vehicle's parameters, without a folder, or that of the built-in vehicle.
    pub vehicle: String,
    /// The parameters in it.
    pub parameters: VehicleParameters,
    /// Place of the unit ahead, left and up of the centre of mass of the sprung mass, m.
    pub unit_m: [f64; 3],
}

impl BodyModel {
    /// The name of the parameters' file; `None` of the built-in vehicle.
    #[must_use]
    pub fn own_file(&self) -> Option<&str> {
        (self.vehicle != BUILT_IN).then_some(self.vehicle.as_str())
    }
}

/// Name of the built-in vehicle.
const BUILT_IN: &str = "defender110";

/// `model.toml` of a vehicle.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    specimen: Specimen,
    strut: Struts,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    body: Option<Body>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Body {
    vehicle: String,
    unit_m: [f64; 3],
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Specimen {
    name: String,
    kind: String,
}

/// Names of the struts' files.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Struts {
    front_left: String,
    front_right: String,
    rear_left: String,
    rear_right: String,
}

impl Checked for File {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        if let Some(body) = &self.body {
            if !is_plain_name(&body.vehicle) {
                let what = format!(
                    "is {:?}: must be {BUILT_IN}, or the name of a file of vehicle parameters beside this file, without a folder",
                    body.vehicle
                );
                return Err(InvalidValue::new("vehicle", what).inside("body"));
            }
            if let Some(far) = body.unit_m.iter().find(|place| !(-10.0..=10.0).contains(*place)) {
                let what = format!("has {far}: each must be from -10 to 10 m");
                return Err(InvalidValue::new("unit_m", what).inside("body"));
            }
        }
        let Struts {
            front_left,
            front_right,
            rear_left,
            rear_right,
        } = &self.strut;
        for (corner, name) in Corner::ALL
            .into_iter()
            .zip([front_left, front_right, rear_left, rear_right])
        {
            if !is_plain_name(name) {
                let what =
                    format!("is {name:?}: must be the name of a strut's model file beside this file, without a folder");
                return Err(InvalidValue::new(corner.key(), what).inside("strut"));
            }
        }
        Ok(())
    }
}

/// Whether a name is that of a file without a folder.
fn is_plain_name(name: &str) -> bool {
    Path::new(name)
        .file_name()
        .is_some_and(|file| file.to_str() == Some(name))
}

/// Whether the text of a model file is that of a vehicle.
#[must_use]
pub fn is_vehicle(text: &str) -> bool {
    specimen_name(text, "").is_ok_and(|head| head.kind == VEHICLE)
}

/// Key of a strut's file, which only files of a vehicle's struts have.
const STARTS_AT_REST: &str = "starts_at_rest";

/// The text of a strut's file without the key [`STARTS_AT_REST`], and what it says.
fn without_beginning(text: String, path: &Path) -> Result<(String, bool), DiagnoseError> {
    // What is no TOML gets the message of the model's reader.
    let Ok(mut table) = toml::from_str::<toml::Table>(&text) else {
        return Ok((text, true));
    };
    let inside = (table.get_mut("specimen")).and_then(|s| s.as_table_mut()?.remove(STARTS_AT_REST));
    let Some(says) = table.remove(STARTS_AT_REST).or(inside) else {
        return Ok((text, true));
    };
    let Some(at_rest) = says.as_bool() else {
        let what = format!(
            "{STARTS_AT_REST} is {says}: must be true where every drive begins with this strut at rest, or false where the state of its \
             gas at the first sample is not known"
        );
        return Err(DiagnoseError::file(path, what));
    };
    let text = toml::to_string(&table).map_err(|e| DiagnoseError::Output(e.to_string()))?;
    Ok((text, at_rest))
}

/// Reads what a table `[body]` names.
fn body_model(body: Body, folder: &Path) -> Result<BodyModel, DiagnoseError> {
    let Body { vehicle, unit_m } = body;
    let parameters = if vehicle == BUILT_IN {
        VehicleParameters::defender110()
    } else {
        let path = folder.join(&vehicle);
        let text = std::fs::read_to_string(&path)
            .map_err(|e| DiagnoseError::file(&path, format!("{e}; it is needed as the parameters of the body")))?;
        VehicleParameters::from_toml(&text, &path.display().to_string())?
    };
    Ok(BodyModel {
        vehicle,
        parameters,
        unit_m,
    })
}

impl VehicleModel {
    /// Reads `model.toml` of a vehicle and the files of its struts, which lie beside it.
    ///
    /// # Errors
    /// One line: file, line or key, what is wrong, what to do.
    pub fn read(path: &Path) -> Result<Self, DiagnoseError> {
        let text_of = |path: &Path| {
            std::fs::read_to_string(path).map_err(|e| {
                DiagnoseError::file(
                    path,
                    format!("{e}; it is needed as the model of the vehicle or of one of its struts"),
                )
            })
        };
        let text = text_of(path)?;
        let source = path.display().to_string();
        let kind = specimen_name(&text, &source)?.kind;
        if kind != VEHICLE {
            let what = format!(
                "is the model of a {kind}; give that of a vehicle (kind = {VEHICLE:?}), which names the files of its struts"
            );
            return Err(DiagnoseError::file(path, what));
        }
        let File { specimen, strut, body } = read::<File>(&text, &source)?;
        let Struts {
            front_left,
            front_right,
            rear_left,
            rear_right,
        } = strut;
        let files = Corners::from_array([front_left, front_right, rear_left, rear_right]);
        let folder = path.parent().unwrap_or(Path::new("."));
        let strut = |corner: Corner| {
            let path = folder.join(&files[corner]);
            let source = path.display().to_string();
            let (text, at_rest) = without_beginning(text_of(&path)?, &path)?;
            let model = StrutModel::from_toml(&text, &source)?;
            model
                .check_noise_is_complete()
                .map_err(|invalid| DiagnoseError::file(&path, invalid.to_string()))?;
            Ok::<_, DiagnoseError>((model, at_rest))
        };
        let read = Corners::try_from_fn(strut)?;
        Ok(Self {
            name: specimen.name,
            starts_at_rest: read.each_ref().map(|(_, at_rest)| *at_rest),
            struts: read.map(|(model, _)| model),
            body: body.map(|body| body_model(body, folder)).transpose()?,
            files,
        })
    }

    /// Names for the files of the improved struts: those given, or `front_left.toml` and so on where two corners share one.
    #[must_use]
    pub fn distinct_files(&self) -> Corners<String> {
        let shared = Corner::ALL.iter().any(|a| {
            let same = |b: &Corner| self.files[*a].eq_ignore_ascii_case(&self.files[*b]);
            Corner::ALL.iter().filter(|b| same(b)).count() > 1 || self.files[*a].eq_ignore_ascii_case(crate::MODEL_FILE)
        });
        if shared {
            Corners::from_fn(|corner| format!("{}.toml", corner.key()))
        } else {
            self.files.clone()
        }
    }

    /// The text of the file of a strut with this model.
    #[must_use]
    pub fn strut_to_toml(&self, corner: Corner, strut: &StrutModel) -> String {
        let text = strut.to_toml();
        if self.starts_at_rest[corner] {
            text
        } else {
            format!("{STARTS_AT_REST} = false\n{text}")
        }
    }

    /// The text of a `model.toml` that names these files.
    ///
    /// # Errors
    /// A name that TOML cannot hold; there is none.
    pub fn to_toml(&self, files: &Corners<String>) -> Result<String, DiagnoseError> {
        let [front_left, front_right, rear_left, rear_right] = files.clone().into_array();
        let file = File {
            specimen: Specimen {
                name: self.name.clone(),
                kind: VEHICLE.to_owned(),
            },
            strut: Struts {
                front_left,
                front_right,
                rear_left,
                rear_right,
            },
            body: self.body.as_ref().map(|body| Body {
                vehicle: body.vehicle.clone(),
                unit_m: body.unit_m,
            }),
        };
        toml::to_string_pretty(&file).map_err(|e| DiagnoseError::Output(e.to_string()))
    }
}
