//! What the kinds of dry friction have in common: their parameters, and that they exclude each other.

use crate::effect::candidate::Candidate;
use crate::excitation::Mechanism;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

/// Key of the viscous coefficient among the calibration values of a damper or a drive. A coefficient that was identified
/// without friction holds a part of it: the equivalent viscous damping.
pub const VISCOUS: &str = "viscous";

/// Coulomb, Stribeck and presliding friction are forms of one effect, and need motion in both directions.
pub fn dry(candidate: Candidate, excitation: &Mechanism) -> Candidate {
    (candidate.taking_from(VISCOUS))
        .in_place_of(EffectId::CoulombFriction)
        .testable_unless(excitation.one_way.clone())
}

/// Friction force at high speed.
pub fn coulomb_force(excitation: &Mechanism) -> Parameter {
    let force = excitation.force_n;
    Parameter::linear("coulomb_force_N", 0.1 * force, 0.05 * force, (0.0, 3.0 * force))
}

/// Friction force at rest over that at high speed.
pub fn breakaway() -> Parameter {
    Parameter::linear("breakaway_over_coulomb", 1.3, 0.2, (1.0, 3.0))
}

/// Speed over which it falls, from a hundredth of the fastest: below that the fall is a peak at rest, which a free run passes
/// between two samples.
pub fn stribeck_speed(excitation: &Mechanism) -> Parameter {
    let speed = excitation.speed_m_s;
    Parameter::log("stribeck_speed_m_s", 0.05 * speed, (0.01 * speed, speed))
}
