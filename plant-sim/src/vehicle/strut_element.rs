//! The two-stage hydropneumatic strut as a suspension element: one, and the four of a vehicle.
//!
//! The strut is given the piston's speed at both ends of the step, not only where it goes: its damping would otherwise
//! belong to the mean speed of the step and lag by half a step (like an added mass of `c h / 2` between body and axle).

use oleo_interface::{Corners, StrutValves};
use serde::{Deserialize, Serialize};

use super::suspension::{FourElements, Motion, SuspensionElement};
use crate::strut::{Segment, Strut, StrutMove, StrutOutput, StrutSnapshot, StrutsAbreast};

/// A two-stage hydropneumatic strut. Signals: `true` opens a valve.
#[derive(Debug, Clone)]
pub struct StrutElement {
    strut: Strut,
    output: StrutOutput,
    rate_m_s: f64,
}

impl StrutElement {
    /// Wraps a strut at rest in its present state.
    pub fn new(strut: Strut) -> Self {
        let output = strut.output();
        Self {
            strut,
            output,
            rate_m_s: 0.0,
        }
    }

    /// Force and pressures at the end of the last step.
    pub fn output(&self) -> StrutOutput {
        self.output
    }
}

/// A motion of the suspension as a move of the strut, whose compression rate has been `from_m_s`.
fn strut_move(motion: Motion, from_m_s: f64, signals: StrutValves<bool>) -> StrutMove {
    StrutMove {
        segment: Segment {
            to_m: motion.compression_m,
            from_m_s,
            to_m_s: motion.compression_rate_m_s,
        },
        duration_s: motion.duration_s,
        signals,
    }
}

impl SuspensionElement for StrutElement {
    type Signal = StrutValves<bool>;
    type Four = FourStruts;

    fn advance(&mut self, motion: Motion, signal: StrutValves<bool>) -> f64 {
        self.output = self.strut.advance_by(&strut_move(motion, self.rate_m_s, signal));
        self.rate_m_s = motion.compression_rate_m_s;
        self.output.force_n
    }

    fn force_n(&self) -> f64 {
        self.output.force_n
    }
}

/// The four struts of a vehicle, which are advanced together where the processor can.
#[derive(Debug, Clone)]
pub struct FourStruts {
    struts: StrutsAbreast,
    output: Corners<StrutOutput>,
    rate_m_s: Corners<f64>,
}

impl FourStruts {
    /// Force and pressures of the struts at the end of the last step.
    pub fn output(&self) -> Corners<StrutOutput> {
        self.output
    }

    /// The present state of the struts.
    #[must_use]
    pub fn snapshot(&self) -> Corners<StrutElementSnapshot> {
        let of_strut = |(strut, rate_m_s)| StrutElementSnapshot { strut, rate_m_s };
        Corners::from_array(self.struts.snapshot())
            .zip(self.rate_m_s)
            .map(of_strut)
    }

    /// Puts the struts into a state that they, or others of the same models, were in.
    pub fn restore(&mut self, kept: &Corners<StrutElementSnapshot>) {
        self.struts
            .restore(kept.each_ref().map(|kept| &kept.strut).into_array());
        self.output = Corners::from_array(self.struts.output());
        self.rate_m_s = kept.each_ref().map(|kept| kept.rate_m_s);
    }
}

impl From<Corners<StrutElement>> for FourStruts {
    fn from(elements: Corners<StrutElement>) -> Self {
        Self {
            output: elements.each_ref().map(|element| element.output),
            rate_m_s: elements.each_ref().map(|element| element.rate_m_s),
            struts: StrutsAbreast::new(elements.map(|element| element.strut).into_array()),
        }
    }
}

impl FourElements<StrutElement> for FourStruts {
    fn advance(&mut self, motions: &Corners<Motion>, signals: &Corners<StrutValves<bool>>) {
        let moves = Corners::from_fn(|corner| strut_move(motions[corner], self.rate_m_s[corner], signals[corner]));
        self.output = Corners::from_array(self.struts.advance(moves.as_array()));
        self.rate_m_s = motions.map(|motion| motion.compression_rate_m_s);
    }

    fn force_n(&self) -> Corners<f64> {
        self.output.map(|output| output.force_n)
    }
}

/// What a strut of a vehicle carries from one step to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StrutElementSnapshot {
    strut: StrutSnapshot,
    rate_m_s: f64,
}
