//! The interface between vehicle and suspension: one element at each corner, compression positive.
//!
//! The vehicle asks for nothing but a force for a motion, so the same equations carry the hydropneumatic strut, the
//! coil spring and damper of the vehicle as sold, and the linear elements that have a closed-form answer. This file is
//! also the one place where the extension-positive appendix meets the compression-positive rest of the project.

use oleo_interface::{Corners, StrutValves};
use serde::{Deserialize, Serialize};

use super::parameters::{BaselineParameters, VehicleParameters};
use crate::strut::{Abreast, Segment, Strut, StrutMove, StrutOutput, StrutSnapshot};

/// Motion of one corner's suspension over a step, compression positive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Compression from the static position at the end of the step, m.
    pub compression_m: f64,
    /// Compression rate at the end of the step, m/s, predicted to second order.
    pub compression_rate_m_s: f64,
    /// Length of the step, s.
    pub duration_s: f64,
}

impl Motion {
    /// From Appendix A's extension.
    pub fn from_extension(extension_m: f64, extension_rate_m_s: f64, duration_s: f64) -> Self {
        Self {
            compression_m: -extension_m,
            compression_rate_m_s: -extension_rate_m_s,
            duration_s,
        }
    }
}

/// Appendix A's tension (`f_S + f_D`, positive pulling) of an element that pushes with `force_n`.
pub fn tension_n(force_n: f64) -> f64 {
    -force_n
}

/// A spring-damper unit between body and axle.
pub trait SuspensionElement {
    /// What the controller sends it each step; `()` for a passive one.
    type Signal: Copy;
    /// Moves the element to the end of the step and returns its force there, N, compression positive (it pushes body
    /// and axle apart).
    fn advance(&mut self, motion: Motion, signal: Self::Signal) -> f64;
    /// Present force, N, compression positive.
    fn force_n(&self) -> f64;
    /// What four elements need to be advanced together, where that pays.
    fn abreast(_elements: &Corners<Self>) -> Option<Abreast>
    where
        Self: Sized,
    {
        None
    }
    /// Moves four elements, which may be advanced together.
    fn advance_all(
        elements: &mut Corners<Self>,
        _abreast: Option<&Abreast>,
        motions: &Corners<Motion>,
        signals: &Corners<Self::Signal>,
    ) where
        Self: Sized,
    {
        for (corner, element) in elements.iter_mut() {
            element.advance(motions[corner], signals[corner]);
        }
    }
}

/// The four elements of a vehicle's suspension.
#[derive(Debug, Clone)]
pub struct Suspension<E> {
    elements: Corners<E>,
    abreast: Option<Abreast>,
}

impl<E: SuspensionElement> Suspension<E> {
    /// A suspension of four elements.
    pub fn new(elements: Corners<E>) -> Self {
        let abreast = E::abreast(&elements);
        Self { elements, abreast }
    }

    /// Moves the elements to the end of a step.
    pub fn advance(&mut self, motions: &Corners<Motion>, signals: &Corners<E::Signal>) {
        E::advance_all(&mut self.elements, self.abreast.as_ref(), motions, signals);
    }

    /// Present forces, N, compression positive.
    pub fn force_n(&self) -> Corners<f64> {
        self.elements.each_ref().map(SuspensionElement::force_n)
    }

    /// The elements.
    pub fn elements(&self) -> &Corners<E> {
        &self.elements
    }
}

impl Suspension<StrutElement> {
    /// Force and pressures of the struts at the end of the last step.
    pub fn output(&self) -> Corners<StrutOutput> {
        self.elements.each_ref().map(StrutElement::output)
    }

    /// The present state of the struts.
    #[must_use]
    pub fn snapshot(&self) -> Corners<StrutElementSnapshot> {
        self.elements.each_ref().map(StrutElement::snapshot)
    }

    /// Puts the struts into a state that they, or others of the same models, were in.
    pub fn restore(&mut self, kept: &Corners<StrutElementSnapshot>) {
        for (corner, element) in self.elements.iter_mut() {
            element.restore(&kept[corner]);
        }
    }
}

/// The two-stage hydropneumatic strut. Signals: `true` opens a valve.
///
/// The strut is given the piston's speed at both ends of the step, not only where it goes: its damping would otherwise
/// belong to the mean speed of the step and lag by half a step (like an added mass of `c h / 2` between body and axle).
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

    /// The strut that the element contains.
    pub fn strut(&self) -> &Strut {
        &self.strut
    }

    fn next_move(&self, motion: Motion, signals: StrutValves<bool>) -> StrutMove {
        StrutMove {
            segment: Segment {
                to_m: motion.compression_m,
                from_m_s: self.rate_m_s,
                to_m_s: motion.compression_rate_m_s,
            },
            duration_s: motion.duration_s,
            signals,
        }
    }

    /// The present state.
    #[must_use]
    pub fn snapshot(&self) -> StrutElementSnapshot {
        StrutElementSnapshot {
            strut: self.strut.snapshot(),
            rate_m_s: self.rate_m_s,
        }
    }

    /// Puts the element into a state that it, or another one with the same strut, was in.
    pub fn restore(&mut self, kept: &StrutElementSnapshot) {
        self.strut.restore(&kept.strut);
        self.output = self.strut.output();
        self.rate_m_s = kept.rate_m_s;
    }
}

/// What a [`StrutElement`] carries from one step to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StrutElementSnapshot {
    strut: StrutSnapshot,
    rate_m_s: f64,
}

impl SuspensionElement for StrutElement {
    type Signal = StrutValves<bool>;

    fn advance(&mut self, motion: Motion, signal: StrutValves<bool>) -> f64 {
        self.output = self.strut.advance_by(&self.next_move(motion, signal));
        self.rate_m_s = motion.compression_rate_m_s;
        self.output.force_n
    }

    fn force_n(&self) -> f64 {
        self.output.force_n
    }

    fn abreast(elements: &Corners<Self>) -> Option<Abreast> {
        Some(Abreast::of(
            &elements.each_ref().map(|element| &element.strut).into_array(),
        ))
    }

    fn advance_all(
        elements: &mut Corners<Self>,
        abreast: Option<&Abreast>,
        motions: &Corners<Motion>,
        signals: &Corners<StrutValves<bool>>,
    ) {
        let Some(abreast) = abreast else {
            return elements.iter_mut().for_each(|(corner, element)| {
                element.advance(motions[corner], signals[corner]);
            });
        };
        let moves = Corners::from_fn(|corner| elements[corner].next_move(motions[corner], signals[corner]));
        let struts = elements.each_mut().map(|element| &mut element.strut).into_array();
        let outputs = Corners::from_array(abreast.advance(struts, moves.as_array()));
        for (corner, element) in elements.iter_mut() {
            element.output = outputs[corner];
            element.rate_m_s = motions[corner].compression_rate_m_s;
        }
    }
}

/// Linear spring and damper: `F = F0 + k x + c v`. Has a closed-form answer; used to test the equations.
#[derive(Debug, Clone, Copy)]
pub struct LinearElement {
    /// Force at the static position, N.
    pub static_load_n: f64,
    /// Stiffness k, N/m.
    pub stiffness_n_m: f64,
    /// Damping coefficient c, N s/m.
    pub damping_n_s_m: f64,
    force_n: f64,
}

impl LinearElement {
    /// An element at rest that carries `static_load_n`.
    pub fn new(static_load_n: f64, stiffness_n_m: f64, damping_n_s_m: f64) -> Self {
        Self {
            static_load_n,
            stiffness_n_m,
            damping_n_s_m,
            force_n: static_load_n,
        }
    }
}

impl SuspensionElement for LinearElement {
    type Signal = ();

    fn advance(&mut self, motion: Motion, (): ()) -> f64 {
        self.force_n = self.static_load_n
            + self.stiffness_n_m * motion.compression_m
            + self.damping_n_s_m * motion.compression_rate_m_s;
        self.force_n
    }

    fn force_n(&self) -> f64 {
        self.force_n
    }
}

/// Coil spring, damper with a bump and a rebound rate, and linear stops: the vehicle as sold.
///
/// `F = F0 + k x + c(v) v + k_stop (penetration of either stop)`; the coil goes solid or loose nowhere, the stops
/// carry the rest, so the force is defined for every travel.
#[derive(Debug, Clone, Copy)]
pub struct CoilElement {
    parameters: BaselineParameters,
    static_load_n: f64,
    force_n: f64,
}

impl CoilElement {
    /// The four elements of a vehicle as sold, at rest.
    pub fn of_vehicle(parameters: &VehicleParameters) -> Corners<Self> {
        let load_n = parameters.static_strut_load_n();
        Corners::from_fn(|corner| Self::new(parameters.baseline(corner.axle()), load_n[corner]))
    }

    /// An element at rest that carries `static_load_n`.
    pub fn new(parameters: &BaselineParameters, static_load_n: f64) -> Self {
        Self {
            parameters: *parameters,
            static_load_n,
            force_n: static_load_n,
        }
    }
}

impl SuspensionElement for CoilElement {
    type Signal = ();

    fn advance(&mut self, motion: Motion, (): ()) -> f64 {
        let p = &self.parameters;
        let (x, v) = (motion.compression_m, motion.compression_rate_m_s);
        let damping = if v > 0.0 {
            p.bump_damping_n_s_m
        } else {
            p.rebound_damping_n_s_m
        };
        let bump = (x - p.bump_clearance_m).max(0.0);
        let rebound = (-x - p.rebound_clearance_m).max(0.0);
        self.force_n =
            self.static_load_n + p.coil_stiffness_n_m * x + damping * v + p.stop_stiffness_n_m * (bump - rebound);
        self.force_n
    }

    fn force_n(&self) -> f64 {
        self.force_n
    }
}
