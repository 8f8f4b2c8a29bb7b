//! Roads from a table: CSV with columns `station_m, left_m, right_m`.
//!
//! The first line names the columns (in any order; further columns are ignored). Stations ascend and need not be even;
//! heights are linear between them, mirrored beyond the last, and lie under the wheels at [`HALF_TRACK_M`] either side.

use super::{HALF_TRACK_M, Road, RoadError};

/// Two profiles over stations.
#[derive(Debug, Clone)]
pub struct ProfileRoad {
    station_m: Vec<f64>,
    heights_m: Vec<[f64; 2]>,
}

/// Reads the table; `path` appears in errors.
///
/// # Errors
/// Missing columns, what is not a finite number, stations that do not ascend, fewer than two rows; each with its line.
pub fn profile_from_csv(bytes: &[u8], path: &str) -> Result<ProfileRoad, RoadError> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(bytes);
    let header = reader
        .headers()
        .map_err(|error| RoadError::line(path, 1, one_line(&error)))?
        .clone();
    let mut columns = [0; 3];
    for (column, name) in columns.iter_mut().zip(["station_m", "left_m", "right_m"]) {
        *column = header.iter().position(|h| h == name).ok_or_else(|| {
            RoadError::line(
                path,
                1,
                format!("no column '{name}': a road needs station_m, left_m, right_m"),
            )
        })?;
    }
    let mut road = ProfileRoad {
        station_m: Vec::new(),
        heights_m: Vec::new(),
    };
    for record in reader.records() {
        let record = record.map_err(|error| {
            let line = error.position().map_or(1, |p| p.line() as usize);
            RoadError::line(path, line, one_line(&error))
        })?;
        let line = record.position().map_or(1, |p| p.line() as usize);
        let mut row = [0.0; 3];
        for (value, (column, name)) in row
            .iter_mut()
            .zip(columns.iter().zip(["station_m", "left_m", "right_m"]))
        {
            let text = record.get(*column).unwrap_or_default();
            *value = text
                .parse()
                .ok()
                .filter(|v: &f64| v.is_finite())
                .ok_or_else(|| RoadError::line(path, line, format!("{name}: '{text}' is not a finite number")))?;
        }
        if road.station_m.last().is_some_and(|&last| row[0] <= last) {
            return Err(RoadError::line(
                path,
                line,
                format!("station_m: {} does not ascend", row[0]),
            ));
        }
        road.station_m.push(row[0]);
        road.heights_m.push([row[1], row[2]]);
    }
    if road.station_m.len() < 2 {
        return Err(RoadError::line(path, 1, "a road needs at least two rows"));
    }
    let start = road.station_m[0];
    road.station_m.iter_mut().for_each(|station| *station -= start);
    Ok(road)
}

fn one_line(error: &csv::Error) -> String {
    error.to_string().replace('\n', " ")
}

impl ProfileRoad {
    /// From the first to the last station, m.
    pub fn length_m(&self) -> f64 {
        self.station_m.last().copied().unwrap_or(0.0)
    }
}

impl Road for ProfileRoad {
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        let length_m = self.length_m();
        let mut place = station_m;
        if !(place >= 0.0 && place <= length_m) {
            let period = 2.0 * length_m;
            place -= period * (place / period).floor();
            if place > length_m {
                place = period - place;
            }
            place = if place >= 0.0 { place.min(length_m) } else { 0.0 };
        }
        let last = self.station_m.len() - 1;
        let cell = self.station_m.partition_point(|&s| s <= place).clamp(1, last) - 1;
        let width = self.station_m[cell + 1] - self.station_m[cell];
        let fraction = (place - self.station_m[cell]) / width;
        let (low, high) = (self.heights_m[cell], self.heights_m[cell + 1]);
        let left = low[0] + fraction * (high[0] - low[0]);
        let right = low[1] + fraction * (high[1] - low[1]);
        let offset = (lateral_m / (2.0 * HALF_TRACK_M)).clamp(-0.5, 0.5);
        (0.5 + offset) * left + (0.5 - offset) * right
    }

    fn measured_length_m(&self) -> Option<f64> {
        Some(self.length_m())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uneven_stations_are_met_and_mirrored() {
        let road = profile_from_csv(
            b"left_m, station_m, right_m, note\n0, 5, 1, a\n1, 6, 2, b\n3, 10, 2, c\n",
            "r.csv",
        )
        .unwrap();
        assert_eq!(road.length_m(), 5.0);
        let h = HALF_TRACK_M;
        assert_eq!(road.height_m(0.0, h), 0.0);
        assert_eq!(road.height_m(0.5, h), 0.5);
        assert_eq!(road.height_m(3.0, h), 2.0);
        assert_eq!(road.height_m(5.0, -h), 2.0);
        assert_eq!(road.height_m(7.0, h), road.height_m(3.0, h));
        assert_eq!(road.height_m(-0.5, h), road.height_m(0.5, h));
        assert_eq!(road.height_m(0.5, 0.0), 1.0);
    }

    #[test]
    fn bad_tables_say_where() {
        for (text, expected) in [
            ("", "r.csv:1: no column 'station_m'"),
            ("station_m,left_m\n0,0\n", "no column 'right_m'"),
            ("station_m,left_m,right_m\n0,0,0\n", "two rows"),
            ("station_m,left_m,right_m\n0,0,0\n1,x,0\n", "r.csv:3: left_m: 'x'"),
            ("station_m,left_m,right_m\n0,0,0\n1,0\n", "r.csv:3: right_m: ''"),
            ("station_m,left_m,right_m\n0,0,0\n1,nan,0\n", "r.csv:3: left_m"),
            (
                "station_m,left_m,right_m\n0,0,0\n0,0,0\n",
                "r.csv:3: station_m: 0 does not ascend",
            ),
        ] {
            let error = profile_from_csv(text.as_bytes(), "r.csv").unwrap_err().to_string();
            assert!(error.contains(expected), "{error} <> {expected}");
        }
    }
}
