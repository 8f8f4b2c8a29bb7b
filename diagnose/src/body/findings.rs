//! What is named, how large it is, and how sure that is.
//!
//! A thing is named only if the whole interval of 95 % lies beyond what a vehicle that lacks nothing may differ from its model by. These tolerances
//! are stated below and are no result of the recording. To the scatter of the blocks each interval adds what the believed instruments and laws
//! leave open, which no length of the drive averages away.

use oleo_interface::{Axle, Corner};

use super::balance::{BAR_LOST, FRICTION, MASS, MASS_AHEAD, MASS_LEFT, ROLL_INERTIA, Row, UNKNOWNS, YAW, rows};
use super::band::Band;
use super::believed::Believed;
use super::drive::BodyDrive;
use super::fit::{BLOCKS, Fit, STUDENT_T, fit};
use super::level::Attitude;

/// Mass that a vehicle may differ from its model by, of the sprung mass: a tank of fuel.
const MASS_TOLERANCE: f64 = 0.03;
/// Share of its stiffness that an anti-roll bar may lack.
const BAR_TOLERANCE: f64 = 0.25;
/// Friction that may be missing at a corner, N.
const FRICTION_TOLERANCE_N: f64 = 40.0;
/// Angle about the vertical by which a unit may be turned, rad.
const YAW_TOLERANCE: f64 = 1.0 * DEGREE;
/// Lean of road and vehicle that a drive in one direction cannot tell from the mounting, rad: a crossfall of 2.5 %, and as much again for the vehicle.
const LEAN: f64 = 2.9 * DEGREE;
/// Believed friction is off by this part of its level, as far as the intervals go.
const FRICTION_ERROR: f64 = 0.05;
/// Error of a force that no believed friction explains, N: half a step of p1 on the bus, 5 kPa on 20 cm2.
const FORCE_ERROR_N: f64 = 5.0;
/// Part of the body's weight that the links of an axle may carry at constant speed, of which nothing is believed: rolling resistance of 1 % of the weight and the drive
/// force against it, on links that bring up to a third of it into heave.
const LINK_ERROR: f64 = 0.002;
/// Error of a share of a bar, from the arms of its believed place.
const BAR_ERROR: f64 = 0.02;
/// Error of the angle about the vertical, rad.
const YAW_ERROR: f64 = 0.1 * DEGREE;
const DEGREE: f64 = core::f64::consts::PI / 180.0;
const GRAVITY_M_S2: f64 = oleo_plant_sim::vehicle::GRAVITY_M_S2;

/// Yaw rate from which on a vehicle turns, rad/s; the balance is that of driving straight ahead.
const TURNING_RAD_S: f64 = 0.03;
/// RMS speed of a strut below which it hardly moves, m/s.
const RESTING_M_S: f64 = 0.02;
/// Shortest block, s: several swings of the body.
const SHORTEST_BLOCK_S: f64 = 1.5;
/// Parts of a drive that are used or left out as a whole, s.
const PART_S: f64 = 2.0;
/// Passes in which the unit is turned by the angle that was found.
const PASSES: usize = 4;

/// What may be named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BodyEffectId {
    /// The body carries a mass that its model lacks, or lacks one that the model has.
    Payload,
    /// An anti-roll bar twists less than it should; not at all with a broken link.
    AntiRollBar(Axle),
    /// A corner rubs more than it should.
    CornerFriction(Corner),
    /// The inertial unit is mounted askew.
    UnitMounting,
}

impl BodyEffectId {
    /// Name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Payload => "payload",
            Self::AntiRollBar(_) => "anti_roll_bar",
            Self::CornerFriction(_) => "corner_friction",
            Self::UnitMounting => "unit_mounting",
        }
    }

    /// Place in reports.
    #[must_use]
    pub const fn place(self) -> &'static str {
        match self {
            Self::Payload => "body",
            Self::AntiRollBar(Axle::Front) => "front axle",
            Self::AntiRollBar(Axle::Rear) => "rear axle",
            Self::CornerFriction(corner) => corner.name(),
            Self::UnitMounting => "inertial unit",
        }
    }
}

/// An estimate with its interval of 95 %.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyEstimate {
    /// Name that ends in its unit.
    pub name: &'static str,
    /// Estimate.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl BodyEstimate {
    fn new(name: &'static str, value: f64, deviation: f64) -> Self {
        let half = STUDENT_T * deviation;
        Self {
            name,
            value,
            low: value - half,
            high: value + half,
        }
    }

    /// Whether the whole interval is further from 0 than this.
    fn is_beyond(&self, tolerance: f64) -> bool {
        self.low > tolerance || self.high < -tolerance
    }
}

/// Something that was named.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyEffect {
    /// What it is, and where.
    pub id: BodyEffectId,
    /// Its sizes.
    pub parameters: Vec<BodyEstimate>,
}

/// What the balance of the body says.
#[derive(Debug, Clone)]
pub struct BodyFindings {
    /// What is named, in a fixed order.
    pub effects: Vec<BodyEffect>,
    /// Time that was used, s.
    pub used_s: f64,
    /// RMS of what is left of heave (N), pitch and roll (N m).
    pub residual_rms: [f64; 3],
}

/// Balances the body over drives.
///
/// # Errors
/// Too little driving straight ahead on a road that moves the struts, in one sentence.
pub fn find(believed: &Believed, drives: &[BodyDrive]) -> Result<BodyFindings, String> {
    let stretches: Vec<BodyDrive> = drives.iter().flat_map(BodyDrive::stretches).collect();
    let mut attitude = Attitude::of_mean(mean_force(&stretches));
    let mut active: Vec<usize> = (0..UNKNOWNS).collect();
    for (at, axle) in BAR_LOST.into_iter().zip(Axle::ALL) {
        // A bar that is not there cannot be lost.
        active.retain(|unknown| *unknown != at || believed.equations.anti_roll_n_m_rad[axle] > 0.0);
    }
    let mut last = None;
    for _ in 0..PASSES {
        let (rows, spacing_s) = used_rows(believed, &stretches, attitude);
        let used_s = rows.len() as f64 * spacing_s;
        let of_block = rows.len() / BLOCKS;
        if of_block as f64 * spacing_s < SHORTEST_BLOCK_S {
            return Err(format!(
                "the body cannot be balanced: {used_s:.0} s straight ahead with moving struts and all readings are there, and {:.0} s are needed",
                BLOCKS as f64 * SHORTEST_BLOCK_S
            ));
        }
        let blocks: Vec<&[Row]> = rows.chunks_exact(of_block).take(BLOCKS).collect();
        let Some(fitted) = fit(&blocks, &active) else {
            return Err("the body cannot be balanced: heave, pitch and roll do not move apart from each other; drive on a rougher road".to_owned());
        };
        attitude.yaw += fitted.values[YAW];
        last = Some((fitted, used_s));
    }
    let Some((fitted, used_s)) = last else {
        return Err("the body cannot be balanced".to_owned());
    };
    Ok(BodyFindings {
        effects: effects(believed, &fitted, attitude),
        used_s,
        residual_rms: fitted.residual_rms,
    })
}

/// Mean specific force in the unit's axes over all stretches.
fn mean_force(stretches: &[BodyDrive]) -> [f64; 3] {
    let count: usize = stretches
        .iter()
        .map(|stretch| stretch.specific_force_m_s2[0].len())
        .sum();
    [0, 1, 2].map(|axis| {
        let all = stretches.iter().flat_map(|stretch| &stretch.specific_force_m_s2[axis]);
        all.sum::<f64>() / count.max(1) as f64
    })
}

/// The rows of those parts of the drives that go straight ahead and move the struts, and the time between two of them.
fn used_rows(believed: &Believed, stretches: &[BodyDrive], attitude: Attitude) -> (Vec<Row>, f64) {
    let (mut used, mut spacing_s) = (Vec::new(), 0.0);
    for stretch in stretches {
        let band = Band::new(stretch.period_s);
        spacing_s = band.spacing_s();
        let rows = rows(believed, &attitude.turned(stretch), &band);
        let of_part = (PART_S / spacing_s).round() as usize;
        for part in rows.chunks_exact(of_part) {
            let mean = |of: fn(&Row) -> f64| part.iter().map(of).sum::<f64>() / part.len() as f64;
            let moves = mean(|row| row.strut_speed_squared) > 4.0 * RESTING_M_S * RESTING_M_S;
            if moves && mean(|row| row.yaw_rate).abs() < TURNING_RAD_S {
                used.extend_from_slice(part);
            }
        }
    }
    (used, spacing_s)
}

fn effects(believed: &Believed, fitted: &Fit, attitude: Attitude) -> Vec<BodyEffect> {
    let mut effects = Vec::new();
    effects.extend(payload(believed, fitted));
    for (at, axle) in BAR_LOST.into_iter().zip(Axle::ALL) {
        let deviation = libm::hypot(fitted.deviation(at), BAR_ERROR);
        let lost = BodyEstimate::new("lost_share", fitted.values[at], deviation);
        if lost.is_beyond(BAR_TOLERANCE) {
            let parameters = vec![lost];
            let id = BodyEffectId::AntiRollBar(axle);
            effects.push(BodyEffect { id, parameters });
        }
    }
    let levels = believed.friction_level_n();
    for corner in Corner::ALL {
        let at = FRICTION + corner.index();
        let left_open_n = libm::hypot(FRICTION_ERROR * levels[corner], FORCE_ERROR_N);
        let deviation = libm::hypot(fitted.deviation(at), left_open_n);
        let more = BodyEstimate::new("more_friction_N", fitted.values[at], deviation);
        if more.is_beyond(FRICTION_TOLERANCE_N) {
            let parameters = vec![more];
            let id = BodyEffectId::CornerFriction(corner);
            effects.push(BodyEffect { id, parameters });
        }
    }
    effects.extend(mounting(fitted, attitude));
    effects
}

/// Mass and place of what the body carries.
fn payload(believed: &Believed, fitted: &Fit) -> Option<BodyEffect> {
    let of_struts = believed
        .ahead_m()
        .zip(believed.left_m())
        .zip(believed.friction_level_n());
    // Forces of struts and links that are off, each on its own, as a mass with its moments.
    let mut covariance =
        [MASS, MASS_AHEAD, MASS_LEFT].map(|i| [MASS, MASS_AHEAD, MASS_LEFT].map(|j| fitted.covariance[i][j]));
    let struts = (of_struts.values()).map(|((ahead_m, left_m), level_n)| {
        let error_n = libm::hypot(FRICTION_ERROR * level_n, FORCE_ERROR_N);
        (error_n / GRAVITY_M_S2, *ahead_m, *left_m)
    });
    let link_kg = LINK_ERROR * believed.equations.body_mass_kg;
    let links = believed
        .equations
        .axle_ahead_m
        .into_array()
        .map(|ahead_m| (link_kg, ahead_m, 0.0));
    for (error_kg, ahead_m, left_m) in struts.chain(links) {
        let arms = [1.0, ahead_m, left_m].map(|arm| arm * error_kg);
        for (line, a) in covariance.iter_mut().zip(arms) {
            for (entry, b) in line.iter_mut().zip(arms) {
                *entry += a * b;
            }
        }
    }
    let mass_kg = fitted.values[MASS];
    let mass = BodyEstimate::new("mass_kg", mass_kg, covariance[0][0].sqrt());
    if !mass.is_beyond(MASS_TOLERANCE * believed.equations.body_mass_kg) {
        return None;
    }
    let place = |name: &'static str, at: usize, unknown: usize| {
        let arm_m = fitted.values[unknown] / mass_kg;
        let [var_mass, var_moment, both] = [covariance[0][0], covariance[at][at], covariance[0][at]];
        let variance = (var_moment + arm_m * arm_m * var_mass - 2.0 * arm_m * both).max(0.0);
        BodyEstimate::new(name, arm_m, variance.sqrt() / mass_kg.abs())
    };
    let (x, y) = (place("x_m", 1, MASS_AHEAD), place("y_m", 2, MASS_LEFT));
    Some(BodyEffect {
        id: BodyEffectId::Payload,
        parameters: [Some(mass), Some(x), Some(y), height(believed, fitted)]
            .into_iter()
            .flatten()
            .collect(),
    })
}

/// How far above or below the believed centre of mass the mass is at most: were it a point, exactly so far, and an extended one is nearer.
fn height(believed: &Believed, fitted: &Fit) -> Option<BodyEstimate> {
    let (body_kg, mass_kg) = (believed.equations.body_mass_kg, fitted.values[MASS]);
    let reduced_kg = body_kg * mass_kg / (body_kg + mass_kg);
    let arm_m = |inertia: f64| (inertia / reduced_kg).max(0.0).sqrt();
    let inertia = fitted.values[ROLL_INERTIA];
    let half = STUDENT_T
        * libm::hypot(
            fitted.deviation(ROLL_INERTIA),
            INERTIA_ERROR * believed.equations.body_inertia_kg_m2[0],
        );
    (reduced_kg > 0.0).then(|| BodyEstimate {
        name: "height_at_most_m",
        value: arm_m(inertia),
        low: 0.0,
        high: arm_m(inertia + half),
    })
}

/// Error of the believed inertia in roll, as a part of it.
const INERTIA_ERROR: f64 = 0.03;

/// How the unit is turned, where it is askew.
fn mounting(fitted: &Fit, attitude: Attitude) -> Option<BodyEffect> {
    let yaw_deviation = libm::hypot(fitted.deviation(YAW), YAW_ERROR);
    let lean = LEAN / STUDENT_T;
    let angles = [
        ("yaw_deg", attitude.yaw, yaw_deviation, YAW_TOLERANCE),
        ("pitch_deg", attitude.pitch, lean, 0.0),
        ("roll_deg", attitude.roll, lean, 0.0),
    ];
    let is_askew = (angles.iter())
        .any(|(name, angle, deviation, tolerance)| BodyEstimate::new(name, *angle, *deviation).is_beyond(*tolerance));
    is_askew.then(|| BodyEffect {
        id: BodyEffectId::UnitMounting,
        parameters: (angles.into_iter())
            .map(|(name, angle, deviation, _)| BodyEstimate::new(name, angle / DEGREE, deviation / DEGREE))
            .collect(),
    })
}
