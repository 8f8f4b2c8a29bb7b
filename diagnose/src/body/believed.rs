//! Masses, places, bars and struts as they are believed.

use oleo_interface::{Axles, Corners};
use oleo_plant_sim::strut::{StrutModel, advance_friction};
use oleo_plant_sim::vehicle::VehicleParameters;
use oleo_plant_sim::vehicle::equations::Equations;

/// A vehicle with an inertial unit as it is believed to be.
#[derive(Debug, Clone)]
pub struct Believed {
    /// Constants of the equations of motion: sprung mass, its inertias, places of the struts, anti-roll bars.
    pub equations: Equations,
    /// Place of the unit ahead, left and up of the centre of mass of the sprung mass, m.
    pub unit_m: [f64; 3],
    struts: Corners<StrutModel>,
}

impl Believed {
    /// A vehicle of these parameters on these struts, with a unit at this place.
    #[must_use]
    pub fn new(vehicle: &VehicleParameters, struts: Corners<StrutModel>, unit_m: [f64; 3]) -> Self {
        Self {
            equations: Equations::new(vehicle),
            unit_m,
            struts,
        }
    }

    /// Places of the struts ahead of the centre of mass, m.
    pub(super) fn ahead_m(&self) -> Corners<f64> {
        Corners::from_fn(|corner| self.equations.axle_ahead_m[corner.axle()])
    }

    /// Places of the struts left of the middle, m.
    pub(super) fn left_m(&self) -> Corners<f64> {
        Corners::from_left_right(Axles::from_fn(|axle| {
            let half_m = self.equations.half_strut_spacing_m[axle];
            [half_m, -half_m]
        }))
    }

    /// Level of the believed Coulomb friction of each strut, N.
    pub(super) fn friction_level_n(&self) -> Corners<f64> {
        self.struts.each_ref().map(|strut| {
            let seal = strut.effects.seal_friction.as_ref();
            seal.map_or(0.0, |seal| seal.coulomb_force_n)
        })
    }

    /// Force with which each strut pushes the body, N: oil on the piston, friction of the seal and stops, from displacement and p1.
    pub(super) fn strut_force_n(
        &self,
        displacement_m: &Corners<Vec<f64>>,
        p1_pa: &Corners<Vec<f64>>,
        period_s: f64,
    ) -> Corners<Vec<f64>> {
        Corners::from_fn(|corner| {
            let (strut, x) = (&self.struts[corner], &displacement_m[corner]);
            let area_m2 = strut.piston_area_m2();
            let seal = strut.effects.seal_friction.as_ref();
            let stops = strut.effects.bump_stop.as_ref();
            let mut friction_n = 0.0;
            (0..x.len())
                .map(|k| {
                    if let (Some(seal), Some(before)) = (seal, k.checked_sub(1)) {
                        let stroke_m = x[k] - x[before];
                        let level_n = seal.level_n(stroke_m / period_s);
                        friction_n = advance_friction(friction_n, stroke_m, level_n, seal.presliding_stiffness_n_m);
                    }
                    area_m2 * p1_pa[corner][k] + friction_n + stops.map_or(0.0, |stops| stops.force_n(x[k]))
                })
                .collect()
        })
    }
}

/// Force of a friction of 1 N along a displacement, N: it sticks over some tens of micrometres and slides then.
pub(super) fn unit_friction(displacement_m: &[f64]) -> Vec<f64> {
    /// Of the stiffness before sliding that recordings show, over an ordinary level of 120 N.
    const STIFFNESS_OF_A_NEWTON: f64 = oleo_plant_sim::strut::PRESLIDING_STIFFNESS_N_M / 120.0;
    let mut force = 0.0;
    let mut before = displacement_m.first().copied().unwrap_or(0.0);
    (displacement_m.iter())
        .map(|x| {
            force = advance_friction(force, x - before, 1.0, STIFFNESS_OF_A_NEWTON);
            before = *x;
            force
        })
        .collect()
}
