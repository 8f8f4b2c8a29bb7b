//! Where an axle is on the body: its two coordinates, and what follows from them.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// The axle's two coordinates, their rates or accelerations.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct AxleCoordinates {
    /// Along the body's z, m, towards the body positive.
    pub heave: f64,
    /// About the body's x, rad, left side up positive.
    pub roll: f64,
}

impl AxleCoordinates {
    /// `self + factor * other`.
    pub(super) fn plus(self, factor: f64, other: Self) -> Self {
        Self {
            heave: self.heave + factor * other.heave,
            roll: self.roll + factor * other.roll,
        }
    }
}

/// An axle in its place.
#[derive(Debug, Clone, Copy)]
pub(super) struct AxlePlace {
    /// Position of the roll centre, m.
    pub(super) centre: Vector3<f64>,
    /// Centre of mass (middle between the wheel centres).
    pub(super) mass_centre: Vector3<f64>,
    /// The axle's own y.
    pub(super) left: Vector3<f64>,
    /// From roll centre to centre of mass.
    pub(super) arm: Vector3<f64>,
    /// d(mass_centre)/d(heave): up, and fore and aft as the links guide it.
    pub(super) lift: Vector3<f64>,
    /// d(mass_centre)/d(roll).
    pub(super) swing: Vector3<f64>,
    /// Inertia about the centre of mass.
    pub(super) inertia: Matrix3<f64>,
    /// Sine and cosine of its roll.
    pub(super) sin_roll: f64,
    pub(super) cos_roll: f64,
}
