//! The vehicle as the balance of its body says that it is: what it carries, what its bars still do, and what rubs at its corners.

use oleo_interface::{Axle, Corners};
use oleo_plant_sim::strut::{PRESLIDING_STIFFNESS_N_M, SealFriction, StrutModel};
use oleo_plant_sim::vehicle::{Payload, VehicleParameters};

use super::findings::{BodyEffect, BodyEffectId, BodyFindings};

impl BodyFindings {
    /// Whether something is found of the vehicle, and not of its inertial unit alone.
    #[must_use]
    pub fn alters_vehicle(&self) -> bool {
        (self.effects.iter()).any(|effect| effect.id != BodyEffectId::UnitMounting)
    }

    /// A believed body with what was found: mass and bars. The mass is a point in the middle plane, as high above the believed centre of mass as
    /// `height_at_most_m` says, where it makes the body roll most.
    #[must_use]
    pub fn on_body(&self, believed: &VehicleParameters) -> VehicleParameters {
        let mut found = believed.clone();
        for effect in &self.effects {
            match effect.id {
                BodyEffectId::Payload => {
                    let payload = Payload {
                        mass_kg: effect.size("mass_kg"),
                        x_m: effect.size("x_m"),
                        z_m: effect.size("height_at_most_m"),
                    };
                    found = payload.on(&found, believed);
                }
                BodyEffectId::AntiRollBar(axle) => {
                    let bar = match axle {
                        Axle::Front => &mut found.front_axle,
                        Axle::Rear => &mut found.rear_axle,
                    };
                    bar.anti_roll_stiffness_n_m_rad *= (1.0 - effect.size("lost_share")).max(0.0);
                }
                BodyEffectId::CornerFriction(_) | BodyEffectId::UnitMounting => {}
            }
        }
        found
    }

    /// Struts with the friction that was found at the corners, in place of theirs: it is counted from that of the believed struts.
    pub fn on_struts(&self, believed: &Corners<StrutModel>, struts: &mut Corners<StrutModel>) {
        for effect in &self.effects {
            if let BodyEffectId::CornerFriction(corner) = effect.id {
                let more_n = effect.size("more_friction_N");
                struts[corner].effects.seal_friction = Some(rubbing(&believed[corner], more_n));
            }
        }
    }
}

impl BodyEffect {
    /// Estimate of a size; 0 where there is none.
    fn size(&self, name: &str) -> f64 {
        let named = self.parameters.iter().find(|size| size.name == name);
        named.map_or(0.0, |size| size.value)
    }
}

/// The friction of a strut with more of it, N. What rubs where nothing is believed to rub is Coulomb's: without a breakaway force of its own the
/// Stribeck speed has no effect.
fn rubbing(believed: &StrutModel, more_n: f64) -> SealFriction {
    let mut seal = believed.effects.seal_friction.clone().unwrap_or(SealFriction {
        coulomb_force_n: 0.0,
        breakaway_force_n: 0.0,
        stribeck_speed_m_s: 0.02,
        presliding_stiffness_n_m: PRESLIDING_STIFFNESS_N_M,
    });
    seal.coulomb_force_n = (seal.coulomb_force_n + more_n).max(0.0);
    seal.breakaway_force_n = (seal.breakaway_force_n + more_n).max(seal.coulomb_force_n);
    seal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::BodyEstimate;
    use oleo_interface::Corner;

    fn findings(effects: Vec<(BodyEffectId, &[(&'static str, f64)])>) -> BodyFindings {
        let sizes = |sizes: &[(&'static str, f64)]| {
            (sizes.iter())
                .map(|&(name, value)| BodyEstimate {
                    name,
                    value,
                    low: value,
                    high: value,
                })
                .collect()
        };
        BodyFindings {
            effects: (effects.into_iter())
                .map(|(id, all)| BodyEffect {
                    id,
                    parameters: sizes(all),
                })
                .collect(),
            used_s: 60.0,
            residual_rms: [0.0; 3],
        }
    }

    #[test]
    fn a_body_carries_what_was_found_on_the_bars_that_are_left() {
        let mut believed = VehicleParameters::defender110();
        believed.front_axle.anti_roll_stiffness_n_m_rad = 2e4;
        let found = findings(vec![
            (
                BodyEffectId::Payload,
                &[
                    ("mass_kg", 200.0),
                    ("x_m", -1.0),
                    ("y_m", 0.3),
                    ("height_at_most_m", 0.8),
                ],
            ),
            (BodyEffectId::AntiRollBar(Axle::Rear), &[("lost_share", 1.02)]),
            (BodyEffectId::AntiRollBar(Axle::Front), &[("lost_share", 0.25)]),
        ]);
        assert!(found.alters_vehicle());
        let body = found.on_body(&believed);
        assert!((body.body.sprung_mass_kg - believed.body.sprung_mass_kg - 200.0).abs() < 1e-9);
        // The common centre of both masses.
        let share = 200.0 / body.body.sprung_mass_kg;
        let up_m = body.body_cg_height_m() - believed.body_cg_height_m();
        let back_m = body.body_cg_behind_front_axle_m() - believed.body_cg_behind_front_axle_m();
        assert!(
            (up_m - 0.8 * share).abs() < 1e-9 && (back_m - share).abs() < 1e-9,
            "{up_m} {back_m}"
        );
        assert_eq!(body.rear_axle.anti_roll_stiffness_n_m_rad, 0.0);
        assert_eq!(body.front_axle.anti_roll_stiffness_n_m_rad, 1.5e4);
    }

    #[test]
    fn a_corner_rubs_by_so_much_more_than_believed_and_a_unit_alters_nothing() {
        let believed = Corners::from_fn(|_| StrutModel::defender110(5000.0));
        let found = findings(vec![(
            BodyEffectId::CornerFriction(Corner::RearLeft),
            &[("more_friction_N", 150.0)],
        )]);
        let mut struts = believed.clone();
        // Said of the strut already: it is not counted twice.
        struts[Corner::RearLeft].effects.seal_friction = Some(rubbing(&believed[Corner::RearLeft], 100.0));
        found.on_struts(&believed, &mut struts);
        let level = |struts: &Corners<StrutModel>, corner: Corner| {
            struts[corner]
                .effects
                .seal_friction
                .as_ref()
                .map_or(0.0, |seal| seal.coulomb_force_n)
        };
        assert_eq!(
            level(&struts, Corner::RearLeft),
            level(&believed, Corner::RearLeft) + 150.0
        );
        assert_eq!(struts[Corner::FrontLeft], believed[Corner::FrontLeft]);
        let mut bare = believed[Corner::FrontLeft].clone();
        bare.effects.seal_friction = None;
        assert_eq!(rubbing(&bare, 80.0).breakaway_force_n, 80.0);

        let askew = findings(vec![(BodyEffectId::UnitMounting, &[("yaw_deg", 5.0)])]);
        assert!(!askew.alters_vehicle());
        let vehicle = VehicleParameters::defender110();
        assert_eq!(askew.on_body(&vehicle), vehicle);
    }
}
