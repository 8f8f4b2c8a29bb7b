//! Laws of the mount between actuator and strut.

use oleo_plant_sim::strut::LawArgument::Force;
use oleo_plant_sim::strut::LawPlace;

use super::law::{Law, law};
use crate::effect::unlisted::forms::{ProportionalAmount, Rising};
use crate::effect::unlisted::knots::{MOUNT_N, MOUNT_TABLE_N};
use crate::vocabulary::Site;

pub(super) const LAWS: &[Law] = &[
    law(
        "deflection over force, a line",
        Site::Mount,
        (LawPlace::Mount, Force),
        &ProportionalAmount("compliance_m_N"),
        MOUNT_N,
        2e-9,
    ),
    law(
        "deflection over force",
        Site::Mount,
        (LawPlace::Mount, Force),
        &Rising,
        MOUNT_TABLE_N,
        2e-5,
    ),
];
