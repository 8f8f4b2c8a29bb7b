//! Checks of a run: a metric, a comparison and a limit.
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
            /// Every metric, in the order of the documentation.
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
    Ticks, "ticks", "Number of ticks that were run.";
    TicksMissing, "ticks_missing", "Number of ticks of the scenario that were not run.";
    WeightedRmsDriver, "weighted_rms_driver_m_s2", "BS 6841 weighted RMS at the driver's seat, m/s2.";
    WeightedRmsRearLeft, "weighted_rms_rear_left_m_s2", "BS 6841 weighted RMS at the left rear passenger's seat, m/s2.";
    VdvDriver, "vdv_driver_m_s1_75", "BS 6841 vibration dose value at the driver's seat, m/s^1.75.";
    VdvRearLeft, "vdv_rear_left_m_s1_75", "BS 6841 vibration dose value at the left rear seat, m/s^1.75.";
    MsdvDriver, "msdv_driver_m_s1_5", "BS 6841 motion sickness dose value at the driver's seat, m/s^1.5.";
    MsdvRearLeft, "msdv_rear_left_m_s1_5", "BS 6841 motion sickness dose value at the left rear seat, m/s^1.5.";
    MaxHeave, "max_heave_m", "Largest heave of the body in either direction, m.";
    MaxRoll, "max_roll_deg", "Largest roll of the body in either direction, degrees.";
    MaxPitch, "max_pitch_deg", "Largest pitch of the body in either direction, degrees.";
    MaxJounce, "max_jounce_m", "Largest compression of any strut from its static position, m.";
    MaxRebound, "max_rebound_m", "Largest extension of any strut from its static position, m.";
    MaxPressure, "max_pressure_pa", "Highest gauge pressure in any strut, Pa.";
    WheelLift, "wheel_lift_share", "Fraction of ticks in which a wheel is off the ground, 0 to 1.";
    ValveSwitches, "valve_switches_total", "Number of edges of all twelve valve signals.";
    HandlingEntries, "handling_entries", "Number of times that the controller entered handling mode.";
    MaxLateral, "max_lateral_m_s2", "Largest lateral acceleration of the body's centre of mass, m/s2. This metric and the next six need a manoeuvre.";
    MaxPathDeviation, "max_path_deviation_m", "Largest distance of the body's centre of mass from the driver's line, m.";
    ConeMargin, "cone_margin_m", "Smallest clearance to the cones, m; negative if one was hit.";
    Decision, "decision_s", "Time from the first lateral acceleration above 0.5 m/s2 to the decision for handling, s.";
    RideBefore, "weighted_rms_driver_before_m_s2", "Weighted RMS at the driver's seat before the manoeuvre, m/s2.";
    RideAfter, "weighted_rms_driver_after_m_s2", "Weighted RMS at the driver's seat behind the last cones, m/s2.";
    Ending, "ending", "How the manoeuvre ended: completed, rolled over, spun or lost the track.";
    FramesLost, "frames_lost", "Frames that were sent but not received, including injected losses.";
    BusFramesLost, "bus_frames_lost", "Frames that the bus itself lost, without injected losses.";
    E2eErrors, "e2e_errors", "Frames that failed their end-to-end check, at either end.";
    BusLoad500k, "bus_load_500k", "Fraction of time in which a wire of 500 kbit/s is busy, 0 to 1.";
    TicksToDetect, "ticks_to_detect", "Ticks from the first fault to the first other mode; 0 means in the same tick.";
    TicksToSafe, "ticks_to_safe", "Ticks from the first fault to the mode safe or latched.";
    TicksToClosed, "ticks_to_closed", "Ticks from the first fault until all valves are closed and remain closed while it lasts.";
    TicksToRecover, "ticks_to_recover", "Ticks from the end of the last fault to the mode normal.";
    WorstMode, "worst_mode", "The most restricted mode after start-up: normal, degraded, safe or latched.";
    FinalMode, "final_mode", "Mode at the end: start-up, normal, degraded, safe or latched.";
    FirstFault, "first_fault", "The first reported fault: none, sensor-range, sensor-rate, sensor-stuck, ...";
}

impl Metric {
    /// The metric with this name in a scenario file; `None` if there is none.
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

/// The value of a metric: a number or a name.
#[derive(Clone, Debug, PartialEq)]
pub enum Figure {
    /// A number, in the unit that the metric's name ends in.
    Number(f64),
    /// A name, such as a mode or a fault.
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
    /// The figure must not be above this value.
    AtMost(f64),
    /// The figure must not be below this value.
    AtLeast(f64),
    /// The figure must be this number.
    Equals(f64),
    /// The figure must be this name.
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

/// A check of a scenario: a metric and what it is compared with.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// The metric that is checked.
    pub metric: Metric,
    /// What the metric must satisfy.
    pub comparison: Comparison,
}

impl Check {
    /// The check in words, such as "max_roll_deg at most 3".
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
