//! What must hold at the end of a run: a metric, a comparison, a limit.
//!
//! The metrics have names of their own (those of `summary.json` where it has them), so that a scenario file, the table, the JUnit
//! file and the summary all say the same word. How they are worked out is in [`crate::metrics`].

use std::fmt;

macro_rules! metrics {
    ($($variant:ident, $name:literal, $meaning:literal;)*) => {
        /// A figure of a run.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Metric {
            $(#[doc = $meaning] $variant,)*
        }

        impl Metric {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$variant,)*];

            /// As written in scenario files.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// What it is, for people.
            pub fn meaning(self) -> &'static str {
                match self { $(Self::$variant => $meaning,)* }
            }
        }
    };
}
metrics! {
    Ticks, "ticks", "Ticks run.";
    TicksMissing, "ticks_missing", "Ticks of the scenario that were not run.";
    WeightedRmsDriver, "weighted_rms_driver_m_s2", "BS 6841 weighted RMS at the driver's seat, m/s2.";
    WeightedRmsRearLeft, "weighted_rms_rear_left_m_s2", "BS 6841 weighted RMS at the left rear passenger's seat, m/s2.";
    VdvDriver, "vdv_driver_m_s1_75", "BS 6841 vibration dose value at the driver's seat, m/s^1.75.";
    VdvRearLeft, "vdv_rear_left_m_s1_75", "BS 6841 vibration dose value at the left rear seat, m/s^1.75.";
    MsdvDriver, "msdv_driver_m_s1_5", "BS 6841 motion sickness dose value at the driver's seat, m/s^1.5.";
    MsdvRearLeft, "msdv_rear_left_m_s1_5", "BS 6841 motion sickness dose value at the left rear seat, m/s^1.5.";
    MaxHeave, "max_heave_m", "Largest heave of the body either way, m.";
    MaxRoll, "max_roll_deg", "Largest roll of the body either way, degrees.";
    MaxPitch, "max_pitch_deg", "Largest pitch of the body either way, degrees.";
    MaxJounce, "max_jounce_m", "Largest compression of any strut from static, m.";
    MaxRebound, "max_rebound_m", "Largest extension of any strut from static, m.";
    MaxPressure, "max_pressure_pa", "Highest gauge pressure in any strut, Pa.";
    WheelLift, "wheel_lift_share", "Share of ticks in which some wheel is off the ground, 0 to 1.";
    ValveSwitches, "valve_switches_total", "Edges of all twelve valve signals.";
    HandlingEntries, "handling_entries", "Times that the controller reported handling mode anew.";
    MaxLateral, "max_lateral_m_s2", "Largest lateral acceleration of the body's centre of mass, m/s2. Needs a manoeuvre, as the next six.";
    MaxPathDeviation, "max_path_deviation_m", "Largest distance of the body's centre of mass from the driver's line, m.";
    ConeMargin, "cone_margin_m", "Least room to the cones, m; negative where one was hit.";
    Decision, "decision_s", "From the first lateral acceleration above 0.5 m/s2 to the decision for handling, s.";
    RideBefore, "weighted_rms_driver_before_m_s2", "Weighted RMS at the driver's seat before the manoeuvre, m/s2.";
    RideAfter, "weighted_rms_driver_after_m_s2", "Weighted RMS at the driver's seat behind the last cones, m/s2.";
    Ending, "ending", "How the manoeuvre ended: completed, rolled over, spun or lost the track.";
    FramesLost, "frames_lost", "Frames sent and not received, injected drops included.";
    BusFramesLost, "bus_frames_lost", "Frames that the bus itself lost, without injected drops.";
    E2eErrors, "e2e_errors", "Frames that failed their end-to-end check, at either end.";
    BusLoad500k, "bus_load_500k", "Share of time a wire of 500 kbit/s is busy, 0 to 1.";
    TicksToDetect, "ticks_to_detect", "From the first fault to the first other mode; 0: within the same tick.";
    TicksToSafe, "ticks_to_safe", "From the first fault to mode safe or latched.";
    TicksToClosed, "ticks_to_closed", "From the first fault until all valves are closed and stay so while it lasts.";
    TicksToRecover, "ticks_to_recover", "From the end of the last fault to mode normal.";
    WorstMode, "worst_mode", "The most restricted mode entered after start-up: normal, degraded, safe or latched.";
    FinalMode, "final_mode", "Mode at the end: start-up, normal, degraded, safe or latched.";
    FirstFault, "first_fault", "First fault code reported: none, sensor-range, sensor-rate, sensor-stuck, ...";
}

impl Metric {
    /// By name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|metric| metric.name() == name)
    }

    /// Whether the figure is a word.
    pub fn is_word(self) -> bool {
        matches!(
            self,
            Self::WorstMode | Self::FinalMode | Self::FirstFault | Self::Ending
        )
    }

    /// Whether only a manoeuvre has this figure.
    pub fn needs_manoeuvre(self) -> bool {
        matches!(
            self,
            Self::MaxLateral
                | Self::MaxPathDeviation
                | Self::ConeMargin
                | Self::Decision
                | Self::RideBefore
                | Self::RideAfter
                | Self::Ending
        )
    }
}

/// A metric's figure.
#[derive(Clone, Debug, PartialEq)]
pub enum Figure {
    /// A number.
    Number(f64),
    /// A word.
    Word(&'static str),
    /// What was to be timed did not happen.
    Never,
}

impl fmt::Display for Figure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) if number.fract() == 0.0 && number.abs() < 1e9 => write!(out, "{number}"),
            Self::Number(number) => out.write_str(&oleo_report::significant(*number, 4)),
            Self::Word(word) => out.write_str(word),
            Self::Never => out.write_str("never"),
        }
    }
}

/// What a figure is held against.
#[derive(Clone, Debug, PartialEq)]
pub enum Comparison {
    /// Not above.
    AtMost(f64),
    /// Not below.
    AtLeast(f64),
    /// This number.
    Equals(f64),
    /// This word.
    Is(String),
}

impl fmt::Display for Comparison {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AtMost(limit) => write!(out, "at most {limit}"),
            Self::AtLeast(limit) => write!(out, "at least {limit}"),
            Self::Equals(number) => write!(out, "equals {number}"),
            Self::Is(word) => write!(out, "equals {word}"),
        }
    }
}

/// One check.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Of what.
    pub metric: Metric,
    /// Against what.
    pub comparison: Comparison,
}

impl Check {
    /// "max_roll_deg at most 3".
    pub fn name(&self) -> String {
        format!("{} {}", self.metric.name(), self.comparison)
    }

    /// Whether a figure meets it. What never happened meets nothing.
    pub fn is_met(&self, figure: &Figure) -> bool {
        match (&self.comparison, figure) {
            (Comparison::AtMost(limit), Figure::Number(number)) => number <= limit,
            (Comparison::AtLeast(limit), Figure::Number(number)) => number >= limit,
            (Comparison::Equals(expected), Figure::Number(number)) => number == expected,
            (Comparison::Is(expected), Figure::Word(word)) => word == expected,
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comparisons() {
        let met = |comparison, figure: &Figure| {
            Check {
                metric: Metric::MaxRoll,
                comparison,
            }
            .is_met(figure)
        };
        assert!(met(Comparison::AtMost(2.0), &Figure::Number(2.0)));
        assert!(!met(Comparison::AtMost(2.0), &Figure::Number(2.1)));
        assert!(!met(Comparison::AtMost(2.0), &Figure::Number(f64::NAN)));
        assert!(!met(Comparison::AtMost(2.0), &Figure::Never));
        assert!(met(Comparison::AtLeast(2.0), &Figure::Number(2.0)));
        assert!(met(Comparison::Is("safe".into()), &Figure::Word("safe")));
        assert!(!met(Comparison::Is("safe".into()), &Figure::Never));
    }

    #[test]
    fn names_are_unique() {
        for metric in Metric::ALL {
            assert_eq!(Metric::from_name(metric.name()), Some(*metric));
        }
    }
}
