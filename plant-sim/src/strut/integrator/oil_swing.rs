//! How finely time is cut while the oil column of line 2 swings.
//!
//! The column's mass and the volumes that its ends can take up are an oscillator of 10 to 200 Hz, which rings after every
//! sudden change of speed or valve. A step of a recording's sampling interval (2 to 50 ms) would lose the ringing's phase
//! or the ringing itself. So steps are a quarter of a radian while the column swings, and as long as ever while it rests
//! or follows a slow flow.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::strut::network::{ColumnOscillator, Network};

/// Length of a step while the column swings, rad of its oscillation. SDIRK2 then is behind by 0.3 % of the phase.
const STEP_RAD: f64 = 0.25;
/// Shortest step for the sake of the column, s. One that would need shorter ones (above 200 Hz, of a few decimetres of line) is
/// damped by the packs within a few milliseconds and is left to the integrator, which is L-stable.
const LEAST_STEP_S: f64 = 2e-4;
/// A column whose swing is below this pressure is at rest, Pa: a twentieth of a usual sensor's noise.
const AT_REST_PA: f64 = 300.0;

/// The column as the integrator watches it.
#[derive(Debug, Clone)]
pub(super) struct OilSwing {
    oscillator: ColumnOscillator,
    step_s: f64,
    pub course: SwingCourse,
}

/// What is carried from one step to the next.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct SwingCourse {
    /// Flow of path 2 at the end of the last step, m3/s.
    flow_m3_s: f64,
    /// How fast it changed within the last step, m3/s2.
    rate_m3_s2: f64,
    /// How much longer it counts as swinging, rad of its oscillation.
    swings_for_rad: f64,
}

impl OilSwing {
    /// The column of a network at rest; none if its oil has no mass, or so little that it need not be followed.
    /// It is looked at where the strut stands unmoved, wherever it starts: a strut that goes on from a state of another one must take the same
    /// steps.
    pub fn of(network: &Network, ambient_k: f64) -> Option<Self> {
        let oscillator = network.column_oscillator(&network.at_rest(0.0, ambient_k))?;
        let step_s = STEP_RAD / oscillator.frequency_rad_s;
        (step_s >= LEAST_STEP_S).then(|| Self {
            oscillator,
            step_s,
            course: SwingCourse::default(),
        })
    }

    /// Longest step now, s; infinite while the column is at rest.
    #[inline]
    pub fn longest_step_s(&self) -> f64 {
        if self.course.swings_for_rad > 0.0 {
            self.step_s
        } else {
            f64::INFINITY
        }
    }

    /// Longest step of an interval in or before which the piston's speed changes by so much (m/s), s: whether that sets the column
    /// swinging.
    #[inline]
    pub fn longest_step_of_kick_s(&self, speed_change_m_s: f64) -> f64 {
        let kick_pa = self.oscillator.kick_pa_s_m * speed_change_m_s;
        if kick_pa > AT_REST_PA {
            self.step_s
        } else {
            f64::INFINITY
        }
    }

    /// Follows a step that the hydraulics have taken: its length, s, and the flow of path 2 at its end, m3/s.
    #[inline]
    pub fn follow(&mut self, duration_s: f64, flow_m3_s: f64) {
        let rate = (flow_m3_s - self.course.flow_m3_s) / duration_s;
        let change_pa = self.oscillator.inertance_kg_m4 * (rate - self.course.rate_m3_s2).abs();
        // Within a step of so many rad the column's pressure changes by as many times the amplitude of the swing at most, and
        // by no more than about the amplitude.
        let turned_rad = duration_s * self.oscillator.frequency_rad_s;
        let swings = change_pa > AT_REST_PA * turned_rad.clamp(STEP_RAD, 1.0);
        self.course = SwingCourse {
            flow_m3_s,
            rate_m3_s2: rate,
            // At the turns of the pressure it does not change: only half a turn without a change is rest.
            swings_for_rad: if swings {
                PI
            } else {
                self.course.swings_for_rad - turned_rad
            },
        };
    }
}
