//! Finds the road for a name on the command line or in a scenario file.

use std::path::Path;
use std::sync::Arc;

use oleo_interface::Side;

use crate::model_file::names::suggestion;

use super::iso8608::{Class, iso8608};
use super::{
    ApgObstacle, EnteredSmoothly, Flat, HALF_TRACK_M, LANE_M, Lanes, Road, RoadError, belgian, crg, profile_from_csv,
};

/// Names of the built-in roads.
pub const NAMES: [&str; 11] = [
    "belgian",
    "apg-left",
    "apg-right",
    "apg-both",
    "iso-a",
    "iso-b",
    "iso-c",
    "iso-d",
    "iso-e",
    "iso-f",
    "flat",
];

/// Where the foot of the APG obstacle's first ramp lies, m: the vehicle has rolled two seconds at 10 km/h.
const APG_START_M: f64 = 6.0;

/// Makes a road of at least `length_m` from a built-in name ([`NAMES`]) or the path of a `.crg` or `.csv` file.
///
/// `seed` picks the random roads' phases and is without effect on others. Random roads and files are entered smoothly
/// (see [`EnteredSmoothly`]); a file shorter than `length_m` goes on as its mirror image, back and forth.
///
/// # Errors
/// Unknown names, unreadable or wrong files (with line), impossible lengths.
pub fn from_name_or_path(spec: &str, length_m: f64, seed: u64) -> Result<Arc<dyn Road>, RoadError> {
    let obstacle = |side| {
        Arc::new(ApgObstacle {
            start_m: APG_START_M,
            side,
        })
    };
    Ok(match spec {
        "flat" => Arc::new(Flat),
        "belgian" => Arc::new(belgian::belgian_block(length_m, seed)?),
        "apg-left" => obstacle(Some(Side::Left)),
        "apg-right" => obstacle(Some(Side::Right)),
        "apg-both" => obstacle(None),
        "iso-a" => Arc::new(iso8608(Class::A, length_m, seed)?),
        "iso-b" => Arc::new(iso8608(Class::B, length_m, seed)?),
        "iso-c" => Arc::new(iso8608(Class::C, length_m, seed)?),
        "iso-d" => Arc::new(iso8608(Class::D, length_m, seed)?),
        "iso-e" => Arc::new(iso8608(Class::E, length_m, seed)?),
        "iso-f" => Arc::new(iso8608(Class::F, length_m, seed)?),
        path => return from_path(path),
    })
}

fn from_path(path: &str) -> Result<Arc<dyn Road>, RoadError> {
    let extension = Path::new(path)
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default()
        .to_ascii_lowercase();
    if extension != "crg" && extension != "csv" {
        return Err(RoadError::Unknown {
            spec: path.to_owned(),
            names: suggestion(path, &NAMES, "built-in roads"),
        });
    }
    let bytes = std::fs::read(path).map_err(|error| RoadError::Unreadable {
        path: path.to_owned(),
        reason: error.to_string(),
    })?;
    if extension == "crg" {
        let surface = crg::read(&bytes, path)?;
        let edge = |place: Option<&f64>| place.map_or(0.0, |place| place.abs());
        let half_width_m = edge(surface.lateral_m().first()).min(edge(surface.lateral_m().last()));
        // A surface wider than a lane has room for a lane change of its own.
        Ok(if half_width_m > 0.5 * LANE_M {
            Arc::new(EnteredSmoothly::levelled(surface))
        } else {
            Arc::new(EnteredSmoothly::levelled(Lanes::new(surface, half_width_m)))
        })
    } else {
        Ok(Arc::new(EnteredSmoothly::levelled(Lanes::new(
            profile_from_csv(&bytes, path)?,
            HALF_TRACK_M,
        ))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_a_road_that_starts_level() {
        for name in NAMES {
            let road = from_name_or_path(name, 100.0, 1).unwrap();
            for station in [-3.0, 0.0] {
                assert_eq!(road.height_m(station, 0.743), 0.0, "{name}");
            }
            assert!(road.height_m(1e4, -0.743).is_finite());
        }
    }

    #[test]
    fn what_is_no_road_is_refused_with_one_line() {
        for spec in ["belgium", "", "x.txt", "nowhere.crg", "nowhere.csv"] {
            let error = from_name_or_path(spec, 100.0, 1).err().unwrap().to_string();
            assert!(!error.contains('\n'));
        }
        assert!(
            from_name_or_path("belgium", 1.0, 1)
                .err()
                .unwrap()
                .to_string()
                .contains("belgian, apg-left")
        );
        assert!(from_name_or_path("iso-c", -1.0, 1).is_err());
    }

    #[test]
    fn files_are_read_by_their_kind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ramp.CSV");
        std::fs::write(&path, "station_m,left_m,right_m\n0,0,0\n100,1,1\n").unwrap();
        let road = from_name_or_path(path.to_str().unwrap(), 10.0, 0).unwrap();
        assert!(
            (road.height_m(55.0, 0.0) - 0.495).abs() < 1e-12,
            "the file starts after the entry, level with its first metre"
        );
    }
}
