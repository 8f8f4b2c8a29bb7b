//! A surface measured on a regular grid, as OpenCRG files hold it.

use super::Road;

/// Heights on a grid of stations (even spacing) and lateral positions (any ascending spacing), bilinear between.
///
/// Beyond its last and before its first row the surface is mirrored, which joins it to itself without a step; outside
/// its lateral edges the height of the edge goes on.
#[derive(Debug, Clone)]
pub struct GridRoad {
    per_m: f64,
    lateral_m: Vec<f64>,
    /// 1 / spacing where the lateral positions are even, which finds a cell without a search.
    lateral_per_m: Option<f64>,
    rows: usize,
    /// Row by row, each right to left as `lateral_m` ascends.
    heights_m: Vec<f32>,
}

impl GridRoad {
    /// `heights_m` holds `rows` rows of `lateral_m.len()` heights. At least two rows; lateral positions ascend.
    pub(super) fn new(spacing_m: f64, lateral_m: Vec<f64>, rows: usize, heights_m: Vec<f32>) -> Self {
        let lateral_per_m = match lateral_m.as_slice() {
            [first, .., last] => {
                let step = (last - first) / (lateral_m.len() - 1) as f64;
                let even = lateral_m
                    .iter()
                    .enumerate()
                    .all(|(i, v)| (first + i as f64 * step - v).abs() < 1e-6 * step);
                even.then_some(1.0 / step)
            }
            _ => None,
        };
        Self {
            per_m: 1.0 / spacing_m,
            lateral_m,
            lateral_per_m,
            rows,
            heights_m,
        }
    }

    /// From the first to the last row, m.
    pub fn length_m(&self) -> f64 {
        (self.rows - 1) as f64 / self.per_m
    }

    /// Lateral positions of the columns, m, right (negative) to left.
    pub fn lateral_m(&self) -> &[f64] {
        &self.lateral_m
    }

    /// Distance between rows, m.
    pub fn spacing_m(&self) -> f64 {
        1.0 / self.per_m
    }

    /// Number of rows of the grid.
    pub fn rows(&self) -> usize {
        self.rows
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        self.heights_m
            .get(row * self.lateral_m.len() + column)
            .map_or(0.0, |&height| f64::from(height))
    }

    /// Column to the right of a lateral position and the fraction towards the next.
    fn lateral_cell(&self, lateral_m: f64) -> (usize, f64) {
        let last = self.lateral_m.len() - 1;
        if let Some(per_m) = self.lateral_per_m {
            let place = ((lateral_m - self.lateral_m[0]) * per_m).clamp(0.0, last as f64);
            let cell = (place as usize).min(last.saturating_sub(1));
            return (cell, place - cell as f64);
        }
        if last == 0 {
            return (0, 0.0);
        }
        let cell = self.lateral_m.partition_point(|&v| v <= lateral_m).clamp(1, last) - 1;
        let width = self.lateral_m[cell + 1] - self.lateral_m[cell];
        (cell, ((lateral_m - self.lateral_m[cell]) / width).clamp(0.0, 1.0))
    }
}

impl Road for GridRoad {
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        let last = (self.rows - 1) as f64;
        let mut place = station_m * self.per_m;
        if !(place >= 0.0 && place <= last) {
            let period = 2.0 * last;
            place -= period * (place / period).floor();
            if place > last {
                place = period - place;
            }
            // Stations beyond the resolution of a double have lost their place; they stay on the surface.
            place = if place >= 0.0 { place.min(last) } else { 0.0 };
        }
        let row = (place as usize).min(self.rows - 2);
        let along = place - row as f64;
        let (column, across) = self.lateral_cell(lateral_m);
        let next = (column + 1).min(self.lateral_m.len() - 1);
        let right = self.at(row, column) + along * (self.at(row + 1, column) - self.at(row, column));
        let left = self.at(row, next) + along * (self.at(row + 1, next) - self.at(row, next));
        (1.0 - across) * right + across * left
    }

    fn measured_length_m(&self) -> Option<f64> {
        Some(self.length_m())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(lateral_m: Vec<f64>) -> GridRoad {
        let rows = 4;
        let heights = (0..rows)
            .flat_map(|row| {
                lateral_m
                    .iter()
                    .map(move |v| (row as f64 * 0.5 + 10.0 * v) as f32)
                    .collect::<Vec<_>>()
            })
            .collect();
        GridRoad::new(0.5, lateral_m, rows, heights)
    }

    #[test]
    fn a_plane_is_met_exactly_for_even_and_uneven_columns() {
        for lateral in [vec![-1.0, 0.0, 1.0], vec![-1.0, -0.5, 1.0]] {
            let road = plane(lateral);
            for (s, v) in [(0.0, 0.0), (0.3, 0.25), (1.5, -1.0), (0.77, 0.99), (1.1, -0.6)] {
                assert!((road.height_m(s, v) - (s + 10.0 * v)).abs() < 1e-6, "{s} {v}");
            }
        }
    }

    #[test]
    fn mirrors_beyond_its_ends_and_holds_its_edges() {
        let road = plane(vec![-1.0, 0.0, 1.0]);
        assert_eq!(road.length_m(), 1.5);
        assert_eq!(road.height_m(1.7, 0.0), road.height_m(1.3, 0.0));
        assert_eq!(road.height_m(-0.25, 0.0), road.height_m(0.25, 0.0));
        assert_eq!(road.height_m(3.0 + 0.25, 0.0), road.height_m(0.25, 0.0));
        assert_eq!(road.height_m(0.5, 7.0), road.height_m(0.5, 1.0));
        assert_eq!(road.height_m(0.5, -7.0), road.height_m(0.5, -1.0));
        for station in [1e300, -1e300, f64::MAX, 1e17] {
            assert!(road.height_m(station, 0.1).is_finite());
        }
    }
}
