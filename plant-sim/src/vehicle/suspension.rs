//! The interface between vehicle and suspension: one element at each corner, compression positive.
//!
//! The vehicle asks for nothing but a force for a motion, so the same equations carry the hydropneumatic strut, the
//! coil spring and damper of the vehicle as sold, and the linear elements that have a closed-form answer. This file is
//! also the one place where the extension-positive appendix meets the compression-positive rest of the project.

use oleo_interface::Corners;

use super::parameters::{BaselineParameters, VehicleParameters};

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
pub trait SuspensionElement: Sized {
    /// What the controller sends it each step; `()` for a passive one.
    type Signal: Copy;
    /// The suspension of a vehicle: four of them.
    type Four: FourElements<Self>;
    /// Moves the element to the end of the step and returns its force there, N, compression positive (it pushes body
    /// and axle apart).
    fn advance(&mut self, motion: Motion, signal: Self::Signal) -> f64;
    /// Present force, N, compression positive.
    fn force_n(&self) -> f64;
}

/// The four elements of a vehicle's suspension. Four of most kinds ([`Corners`]) are moved one after the other.
pub trait FourElements<E: SuspensionElement>: From<Corners<E>> {
    /// Moves the elements to the end of a step.
    fn advance(&mut self, motions: &Corners<Motion>, signals: &Corners<E::Signal>);
    /// Present forces, N, compression positive.
    fn force_n(&self) -> Corners<f64>;
}

impl<E: SuspensionElement> FourElements<E> for Corners<E> {
    fn advance(&mut self, motions: &Corners<Motion>, signals: &Corners<E::Signal>) {
        for (corner, element) in self.iter_mut() {
            element.advance(motions[corner], signals[corner]);
        }
    }

    fn force_n(&self) -> Corners<f64> {
        self.each_ref().map(SuspensionElement::force_n)
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
    type Four = Corners<Self>;

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
    type Four = Corners<Self>;

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
