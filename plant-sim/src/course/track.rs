//! The line that the driver wants to follow, and the cones beside it.
//!
//! ISO 3888-1 (severe double lane change) and ISO 3888-2 (obstacle avoidance) as lanes of cones whose width depends on the
//! vehicle's width w; ISO 4138 as a circle.
//!
//! ```text
//! 3888-1  lane 1 15 m (1.1 w + 0.25) | 30 m | lane 2 25 m (1.2 w + 0.25, right edge 3.5 m left of lane 1's) | 25 m | lane 3 15 m (1.3 w + 0.25)
//! 3888-2  lane 1 12 m (1.1 w + 0.25) | 13.5 m | lane 2 11 m (w + 1, 1 m beside lane 1) | 12.5 m | lane 3 12 m (3.0 m)
//! ```
//!
//! The line runs in the middle of each lane and changes lanes in one of two ways ([`LaneChangeLine`]), of which the second asks
//! for the least lateral acceleration that the length between the lanes allows, and for all of it at once.

/// After the last cones, m.
const EXIT_M: f64 = 20.0;

/// How a line goes from lane to lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaneChangeLine {
    /// A fifth-order polynomial without a step in curvature, which begins and ends well inside the lanes: a driver who uses the
    /// room there is.
    Eased,
    /// Two parabolas of equal and opposite curvature: full lock one way and the other, `4 y V^2 / l^2` of lateral
    /// acceleration for an offset y in a length l. Between the lanes of ISO 3888-1; between those of ISO 3888-2, which are too
    /// close for that at any speed worth testing, from 3.5 m inside the lanes.
    Hard,
}

impl LaneChangeLine {
    /// Share of the lateral offset at the share `s` of the length, both 0..1.
    fn share(self, s: f64) -> f64 {
        match self {
            Self::Eased => s * s * s * (10.0 - s * (15.0 - 6.0 * s)),
            Self::Hard if s < 0.5 => 2.0 * s * s,
            Self::Hard => 1.0 - 2.0 * (1.0 - s) * (1.0 - s),
        }
    }
}

/// A lane of cones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gate {
    /// First and last cone, station, m.
    pub from_m: f64,
    /// Station of the last cone, m.
    pub to_m: f64,
    /// Cones on the right, lateral, m (left positive).
    pub right_m: f64,
    /// Cones on the left, m.
    pub left_m: f64,
}

impl Gate {
    fn middle_m(&self) -> f64 {
        0.5 * (self.left_m + self.right_m)
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Line {
    Straight,
    /// Changes between the gates' middles; each starts and ends `ease_m` inside the lanes.
    Lanes {
        shape: LaneChangeLine,
        ease_m: f64,
    },
    /// Signed radius: positive turns left.
    Circle {
        radius_m: f64,
    },
}

/// A line to follow and the cones beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    line: Line,
    gates: Vec<Gate>,
}

impl Track {
    /// A track that leads straight ahead, without cones.
    pub fn straight() -> Self {
        Self {
            line: Line::Straight,
            gates: Vec::new(),
        }
    }

    /// A circle through the origin, m; positive radius turns left. ISO 4138.
    pub fn circle(radius_m: f64) -> Self {
        Self {
            line: Line::Circle { radius_m },
            gates: Vec::new(),
        }
    }

    /// ISO 3888-1 for a vehicle of width `width_m`, first lane change to the left; the first cones stand at `entry_m`.
    pub fn severe_lane_change(width_m: f64, entry_m: f64, shape: LaneChangeLine) -> Self {
        let ease_m = match shape {
            LaneChangeLine::Eased => 7.0,
            LaneChangeLine::Hard => 0.0,
        };
        let widths = [1.1 * width_m + 0.25, 1.2 * width_m + 0.25, 1.3 * width_m + 0.25];
        // Right edges: lanes 1 and 3 in line, lane 2 3.5 m to the left. Lateral 0 is the middle of lane 1.
        let right = -0.5 * widths[0];
        let lengths = [15.0, 30.0, 25.0, 25.0, 15.0];
        let gates = lanes(entry_m, lengths, [right, right + 3.5, right], widths);
        Self {
            line: Line::Lanes { shape, ease_m },
            gates,
        }
    }

    /// ISO 3888-2 for a vehicle of width `width_m`, first lane change to the left; the first cones stand at `entry_m`.
    pub fn obstacle_avoidance(width_m: f64, entry_m: f64, shape: LaneChangeLine) -> Self {
        let widths = [1.1 * width_m + 0.25, width_m + 1.0, (1.3 * width_m + 0.25).max(3.0)];
        let left = 0.5 * widths[0];
        // Lane 2 begins 1 m beside lane 1; lanes 1 and 3 are in line on the side of lane 2.
        let lengths = [12.0, 13.5, 11.0, 12.5, 12.0];
        let gates = lanes(entry_m, lengths, [-left, left + 1.0, left - widths[2]], widths);
        Self {
            line: Line::Lanes { shape, ease_m: 3.5 },
            gates,
        }
    }

    /// Station at which the manoeuvre is over, m.
    pub fn end_m(&self) -> Option<f64> {
        self.gates.last().map(|gate| gate.to_m + EXIT_M)
    }

    /// The lanes of cones.
    pub fn gates(&self) -> &[Gate] {
        &self.gates
    }

    /// How far the line runs to the left of a point, m.
    pub fn error_m(&self, x_m: f64, y_m: f64) -> f64 {
        match &self.line {
            Line::Straight => -y_m,
            Line::Circle { radius_m } => {
                let dy = y_m - radius_m;
                let distance = (x_m * x_m + dy * dy).sqrt();
                if *radius_m > 0.0 {
                    distance - radius_m
                } else {
                    -(distance + radius_m)
                }
            }
            Line::Lanes { .. } => self.lateral_m(x_m) - y_m,
        }
    }

    /// The line at a station, m to the left; 0 for a circle.
    pub fn lateral_m(&self, x_m: f64) -> f64 {
        let Line::Lanes { shape, ease_m } = self.line else {
            return 0.0;
        };
        let mut lateral = 0.0;
        for pair in self.gates.windows(2) {
            let (from, to) = (pair[0].to_m - ease_m, pair[1].from_m + ease_m);
            let s = ((x_m - from) / (to - from)).clamp(0.0, 1.0);
            lateral += shape.share(s) * (pair[1].middle_m() - pair[0].middle_m());
        }
        lateral
    }

    /// Room between a point and the nearest line of cones beside it, m; negative outside; `None` where there are none.
    pub fn margin_m(&self, x_m: f64, y_m: f64) -> Option<f64> {
        let gate = self.gates.iter().find(|gate| x_m >= gate.from_m && x_m <= gate.to_m)?;
        Some((gate.left_m - y_m).min(y_m - gate.right_m))
    }
}

/// Lanes from the station of the first cones, the five lengths, the lanes' right edges and widths.
fn lanes(entry_m: f64, lengths_m: [f64; 5], right_m: [f64; 3], widths_m: [f64; 3]) -> Vec<Gate> {
    let mut station = entry_m;
    let mut gates = Vec::new();
    for (section, length) in lengths_m.into_iter().enumerate() {
        if section % 2 == 0 {
            let lane = section / 2;
            let (right, width) = (right_m[lane], widths_m[lane]);
            gates.push(Gate {
                from_m: station,
                to_m: station + length,
                right_m: right,
                left_m: right + width,
            });
        }
        station += length;
    }
    gates
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn iso_3888_1_has_the_published_centre_path() {
        let track = Track::severe_lane_change(1.79, 25.0, LaneChangeLine::Eased);
        let gates = track.gates();
        assert!((gates[1].middle_m() - 3.590).abs() < 1e-3 && (gates[2].middle_m() - 0.179).abs() < 1e-3);
        assert!((gates[2].to_m - gates[0].from_m - 110.0).abs() < 1e-12);
        assert!(track.lateral_m(0.0).abs() < 1e-12);
        assert!((track.lateral_m(25.0 + 57.0) - 3.590).abs() < 1e-3);
        assert!((track.lateral_m(500.0) - 0.179).abs() < 1e-3);
    }

    #[test]
    fn iso_3888_2_has_a_metre_between_the_lanes() {
        let track = Track::obstacle_avoidance(1.79, 25.0, LaneChangeLine::Eased);
        let gates = track.gates();
        assert!((gates[1].right_m - gates[0].left_m - 1.0).abs() < 1e-12);
        assert!((gates[2].to_m - gates[0].from_m - 61.0).abs() < 1e-12);
    }

    #[test]
    fn the_line_itself_keeps_a_car_between_the_cones() {
        for track in [
            Track::severe_lane_change(1.79, 25.0, LaneChangeLine::Eased),
            Track::obstacle_avoidance(1.79, 25.0, LaneChangeLine::Eased),
        ] {
            let mut worst = f64::INFINITY;
            for i in 0..2000 {
                let x = 0.1 * f64::from(i);
                for side in [-0.5, 0.5] {
                    worst = worst.min(track.margin_m(x, track.lateral_m(x) + side * 1.79).unwrap_or(worst));
                }
            }
            assert!(worst > 0.05, "{worst}");
        }
    }

    /// Curvature times the square of the speed is the lateral acceleration asked for: `4 y V^2 / l^2`, and no more.
    #[test]
    fn the_hard_line_asks_for_the_least_peak_of_its_length() {
        let track = Track::severe_lane_change(1.79, 25.0, LaneChangeLine::Hard);
        let gates = track.gates();
        let d = 0.05;
        let (mut most, mut x) = (0.0f64, 30.0);
        while x < 60.0 + 25.0 {
            let curvature = (track.lateral_m(x + d) - 2.0 * track.lateral_m(x) + track.lateral_m(x - d)) / (d * d);
            most = most.max(curvature.abs());
            x += 0.1;
        }
        let (offset, length) = (
            gates[1].middle_m() - gates[0].middle_m(),
            gates[1].from_m - gates[0].to_m,
        );
        assert!((most / (4.0 * offset / (length * length)) - 1.0).abs() < 1e-3, "{most}");
    }

    #[test]
    fn error_is_positive_where_the_line_is_to_the_left() {
        assert_eq!(Track::straight().error_m(10.0, -2.0), 2.0);
        let left = Track::circle(50.0);
        assert!((left.error_m(0.0, -1.0) - 1.0).abs() < 1e-12 && (left.error_m(52.0, 50.0) - 2.0).abs() < 1e-12);
        assert_eq!(Track::circle(-50.0).error_m(3.0, 4.0), -left.error_m(3.0, -4.0));
    }
}
