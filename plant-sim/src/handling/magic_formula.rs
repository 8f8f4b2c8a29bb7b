//! Forces of a rolling tyre for given slips, load and camber: the Magic Formula.
//!
//! Source: H. B. Pacejka, *Tyre and Vehicle Dynamics* (2002), 4.3.2, as in the tyre property files "PAC2002" (MSC Adams/
//! Tire), ISO-W axes: x ahead, y to the left, z up; camber positive leaning right; a wheel sliding to the left
//! (`alpha > 0`) is pushed to the right. Why a subset: left and right tyres must be mirror images, so the shifts
//! that remain at zero slip and camber (ply steer, conicity, residual torque; PHX, PVX, PHY1-2, PVY1-2, PEX4, PEY3,
//! RBY3, RH*, RVY*, QBZ4, QDZ3, QDZ6-9, QEZ4-5, QHZ, SSZ) are left out. With `dfz = (Fz - Fz0) / Fz0`:
//!
//! ```text
//! pure      Fx0 = Dx sin(Cx atan(Bx k - Ex (Bx k - atan(Bx k))))        Bx = Kx / (Cx Dx)
//!           Dx = (PDX1 + PDX2 dfz) Fz      Kx = Fz (PKX1 + PKX2 dfz) exp(PKX3 dfz)
//!           Fy0 = Dy sin(Cy atan(By a - Ey (By a - atan(By a)))) + Svy  a = alpha + PHY3 camber
//!           Dy = (PDY1 + PDY2 dfz) (1 - PDY3 camber^2) Fz
//!           Ky = PKY1 Fz0 sin(2 atan(Fz / (PKY2 Fz0))) (1 - PKY3 |camber|)
//! combined  Fx = Fx0 cos(RCX1 atan(Bxa a - E (Bxa a - atan(Bxa a))))    Bxa = RBX1 cos(atan(RBX2 kappa))
//!           Fy = Fy0 cos(RCY1 atan(Byk k - E (Byk k - atan(Byk k))))    Byk = RBY1 cos(atan(RBY2 alpha))
//! aligning  Mz = - t Fy,  t = Dt cos(Ct atan(Bt q - Et (Bt q - atan(Bt q)))) cos(alpha)
//!           q: alpha with the longitudinal slip added in the ratio of stiffnesses
//! rolling   My = - QSY1 R0 Fz
//! lengths   sigma_kappa = Fz (PTX1 + PTX2 dfz) exp(PTX3 dfz) R0 / Fz0
//!           sigma_alpha = PTY1 sin(2 atan(Fz / (PTY2 Fz0))) R0
//! radius    Re = R0 - d0 (DREFF atan(BREFF d / d0) + FREFF d / d0),  d0 = Fz0 / Cz
//! ```

use libm::{atan, cos, exp, sin};
use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};

/// Camber and load beyond which the coefficients are held: the source's file is fitted to 15 degrees.
const CAMBER_LIMIT_RAD: f64 = 0.2618;
const LOAD_EXCESS_LIMIT: f64 = 2.0;
/// Relaxation lengths do not fall below this, m.
const SHORTEST_RELAXATION_M: f64 = 0.03;

/// A coefficient of either sign.
const ANY: Range = Range::FromTo(-1000.0, 1000.0);
/// A coefficient that the formula divides by or takes the sign of the force from.
const POSITIVE: Range = Range::FromTo(1e-3, 1000.0);
/// The same for the one that is negative in these axes.
const NEGATIVE: Range = Range::FromTo(-1000.0, -1e-3);
/// Nominal load, N.
const LOAD_N: Range = Range::FromTo(100.0, 1e5);
/// Factor on friction.
const SCALE: Range = Range::FromTo(0.0, 3.0);

macro_rules! coefficients {
    ($($(#[$doc:meta])* $name:ident: $range:ident $unit:literal),* $(,)?) => {
        /// Coefficients of the formula, named as in the field's property files (in lower case).
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct MagicFormula { $($(#[$doc])* pub $name: f64),* }

        impl Checked for MagicFormula {
            const LIMITS: &'static [Limit<Self>] =
                &[$(Limit::one(stringify!($name), $range, $unit, |formula| formula.$name)),*];
        }
    };
}

coefficients! {
    /// Nominal wheel load Fz0, N, above 0.
    nominal_load_n: LOAD_N "N",
    /// Factor on both friction coefficients (LMUX, LMUY): 1 dry asphalt.
    friction_scale: SCALE "",
    /// Shape factor Cx of the longitudinal force in pure slip.
    pcx1: POSITIVE "",
    /// Longitudinal friction coefficient at nominal load.
    pdx1: POSITIVE "",
    /// Change of the longitudinal friction coefficient with the relative load.
    pdx2: ANY "",
    /// Curvature factor Ex of the longitudinal force.
    pex1: ANY "",
    /// Change of Ex with the relative load.
    pex2: ANY "",
    /// Change of Ex with the square of the relative load.
    pex3: ANY "",
    /// Longitudinal slip stiffness over load, at nominal load.
    pkx1: POSITIVE "",
    /// Change of the longitudinal slip stiffness with the relative load.
    pkx2: ANY "",
    /// Exponent of the longitudinal slip stiffness in the relative load.
    pkx3: ANY "",
    /// Shape factor Cy of the lateral force in pure slip.
    pcy1: POSITIVE "",
    /// Lateral friction coefficient at nominal load.
    pdy1: POSITIVE "",
    /// Change of the lateral friction coefficient with the relative load.
    pdy2: ANY "",
    /// Change of the lateral friction coefficient with the square of camber.
    pdy3: ANY "",
    /// Curvature factor Ey of the lateral force.
    pey1: ANY "",
    /// Change of Ey with the relative load.
    pey2: ANY "",
    /// Change of Ey with camber, by the sign of the slip angle.
    pey4: ANY "",
    /// Largest cornering stiffness over nominal load; negative in ISO-W axes.
    pky1: NEGATIVE "",
    /// Load at which the cornering stiffness is largest, over the nominal load.
    pky2: POSITIVE "",
    /// Change of the cornering stiffness with camber.
    pky3: ANY "",
    /// Shift of the slip angle with camber, part of the camber thrust.
    phy3: ANY "",
    /// Shift of the lateral force with camber, part of the camber thrust.
    pvy3: ANY "",
    /// Change of the shift of the lateral force with camber and the relative load.
    pvy4: ANY "",
    /// Slope factor of the longitudinal force in combined slip.
    rbx1: ANY "",
    /// Change of that slope with the longitudinal slip.
    rbx2: ANY "",
    /// Shape factor of the longitudinal force in combined slip.
    rcx1: ANY "",
    /// Curvature factor of the longitudinal force in combined slip.
    rex1: ANY "",
    /// Change of that curvature with the relative load.
    rex2: ANY "",
    /// Slope factor of the lateral force in combined slip.
    rby1: ANY "",
    /// Change of that slope with the slip angle.
    rby2: ANY "",
    /// Shape factor of the lateral force in combined slip.
    rcy1: ANY "",
    /// Curvature factor of the lateral force in combined slip.
    rey1: ANY "",
    /// Change of that curvature with the relative load.
    rey2: ANY "",
    /// Slope factor Bt of the pneumatic trail.
    qbz1: ANY "",
    /// Change of Bt with the relative load.
    qbz2: ANY "",
    /// Change of Bt with the square of the relative load.
    qbz3: ANY "",
    /// Change of Bt with the absolute value of camber.
    qbz5: ANY "",
    /// Shape factor Ct of the pneumatic trail.
    qcz1: ANY "",
    /// Peak of the pneumatic trail, over radius and relative load.
    qdz1: ANY "",
    /// Change of the peak of the trail with the relative load.
    qdz2: ANY "",
    /// Change of the peak of the trail with the square of camber.
    qdz4: ANY "",
    /// Curvature factor Et of the pneumatic trail.
    qez1: ANY "",
    /// Change of Et with the relative load.
    qez2: ANY "",
    /// Longitudinal relaxation length over radius, at nominal load.
    ptx1: POSITIVE "",
    /// Change of the longitudinal relaxation length with the relative load.
    ptx2: ANY "",
    /// Exponent of the longitudinal relaxation length in the relative load.
    ptx3: ANY "",
    /// Largest lateral relaxation length, over radius.
    pty1: POSITIVE "",
    /// Load at which the lateral relaxation length is largest, over the nominal load.
    pty2: POSITIVE "",
    /// Rolling resistance over load.
    qsy1: ANY "",
    /// How fast the effective rolling radius falls at low load.
    breff: ANY "",
    /// Peak of the change of the effective rolling radius.
    dreff: ANY "",
    /// Effective radius at high load.
    freff: ANY "",
}

/// What the road does to a wheel in its plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TyreForces {
    /// Fx, N, ahead positive.
    pub longitudinal_n: f64,
    /// Fy, N, to the left positive.
    pub lateral_n: f64,
    /// Mz about the road's normal, N m, turning left positive.
    pub aligning_n_m: f64,
}

/// The formula at one load and camber: everything that does not depend on slip.
#[derive(Debug, Clone, Copy)]
pub struct LoadedTyre<'a> {
    formula: &'a MagicFormula,
    load_excess: f64,
    load_n: f64,
    camber_rad: f64,
    free_radius_m: f64,
    slip_stiffness_n: f64,
    cornering_stiffness_n_rad: f64,
}

/// `sin(2 atan(x))`.
fn sin_twice_atan(x: f64) -> f64 {
    2.0 * x / (1.0 + x * x)
}

/// `cos(atan(x))`.
fn cos_atan(x: f64) -> f64 {
    1.0 / (1.0 + x * x).sqrt()
}

impl MagicFormula {
    /// The tyre at a load (N, > 0), camber (rad) and free radius (m).
    pub fn at(&self, load_n: f64, camber_rad: f64, free_radius_m: f64) -> LoadedTyre<'_> {
        let nominal = self.nominal_load_n;
        let load_excess = ((load_n - nominal) / nominal).min(LOAD_EXCESS_LIMIT);
        let camber_rad = camber_rad.clamp(-CAMBER_LIMIT_RAD, CAMBER_LIMIT_RAD);
        LoadedTyre {
            formula: self,
            load_excess,
            load_n,
            camber_rad,
            free_radius_m,
            slip_stiffness_n: load_n * (self.pkx1 + self.pkx2 * load_excess) * exp(self.pkx3 * load_excess),
            cornering_stiffness_n_rad: self.pky1
                * nominal
                * sin_twice_atan(load_n / (self.pky2 * nominal))
                * (1.0 - self.pky3 * camber_rad.abs()),
        }
    }

    /// Effective rolling radius, m, for a vertical deflection (m) and rate (N/m).
    pub fn rolling_radius_m(&self, free_radius_m: f64, deflection_m: f64, stiffness_n_m: f64) -> f64 {
        let nominal_m = self.nominal_load_n / stiffness_n_m;
        let relative = deflection_m.max(0.0) / nominal_m;
        free_radius_m - nominal_m * (self.dreff * atan(self.breff * relative) + self.freff * relative)
    }
}

impl LoadedTyre<'_> {
    /// dFx/dkappa at zero slip, N.
    pub fn slip_stiffness_n(&self) -> f64 {
        self.slip_stiffness_n
    }

    /// -dFy/dalpha at zero slip, N/rad (positive).
    pub fn cornering_stiffness_n_rad(&self) -> f64 {
        -self.cornering_stiffness_n_rad
    }

    /// Pneumatic trail at zero slip, m.
    pub fn pneumatic_trail_m(&self) -> f64 {
        let f = self.formula;
        let peak = f.qdz1 + f.qdz2 * self.load_excess;
        let camber = 1.0 + f.qdz4 * self.camber_rad * self.camber_rad;
        self.load_n / f.nominal_load_n * self.free_radius_m * peak * camber
    }

    /// Longitudinal and lateral relaxation length, m.
    pub fn relaxation_m(&self) -> (f64, f64) {
        let f = self.formula;
        let relative = self.load_n / f.nominal_load_n;
        let along =
            relative * (f.ptx1 + f.ptx2 * self.load_excess) * exp(f.ptx3 * self.load_excess) * self.free_radius_m;
        let across = f.pty1 * sin_twice_atan(relative / f.pty2) * self.free_radius_m;
        (along.max(SHORTEST_RELAXATION_M), across.max(SHORTEST_RELAXATION_M))
    }

    /// Rolling resistance torque, N m, against the wheel's spin.
    pub fn rolling_resistance_n_m(&self) -> f64 {
        self.formula.qsy1 * self.load_n * self.free_radius_m
    }

    /// Forces at longitudinal slip `kappa` (driving positive) and slip angle `alpha_rad` (sliding to the left positive).
    pub fn forces(&self, kappa: f64, alpha_rad: f64) -> TyreForces {
        let f = self.formula;
        let (dfz, camber) = (self.load_excess, self.camber_rad);

        let peak_x = f.friction_scale * (f.pdx1 + f.pdx2 * dfz) * self.load_n;
        let curvature_x = (f.pex1 + dfz * (f.pex2 + dfz * f.pex3)).min(1.0);
        let pure_x = magic(
            slope(self.slip_stiffness_n, f.pcx1, peak_x) * kappa,
            f.pcx1,
            peak_x,
            curvature_x,
        );
        let slope_xa = f.rbx1 * cos_atan(f.rbx2 * kappa);
        let with_alpha = weight(slope_xa * alpha_rad, f.rcx1, f.rex1 + f.rex2 * dfz);

        let peak_y = f.friction_scale * (f.pdy1 + f.pdy2 * dfz) * (1.0 - f.pdy3 * camber * camber) * self.load_n;
        let shifted = alpha_rad + f.phy3 * camber;
        let side = if shifted < 0.0 { -camber } else { camber };
        let curvature_y = ((f.pey1 + f.pey2 * dfz) * (1.0 - f.pey4 * side)).min(1.0);
        let thrust = f.friction_scale * self.load_n * camber * (f.pvy3 + f.pvy4 * dfz);
        let stiffness = self.cornering_stiffness_n_rad;
        let pure_y = magic(slope(stiffness, f.pcy1, peak_y) * shifted, f.pcy1, peak_y, curvature_y) + thrust;
        let slope_yk = f.rby1 * cos_atan(f.rby2 * alpha_rad);
        let with_kappa = weight(slope_yk * kappa, f.rcy1, f.rey1 + f.rey2 * dfz);

        let lateral_n = pure_y * with_kappa;
        TyreForces {
            longitudinal_n: pure_x * with_alpha,
            lateral_n,
            aligning_n_m: -self.trail_m(kappa, alpha_rad) * lateral_n,
        }
    }

    fn trail_m(&self, kappa: f64, alpha_rad: f64) -> f64 {
        let f = self.formula;
        let dfz = self.load_excess;
        let ratio = self.slip_stiffness_n / self.cornering_stiffness_n_rad * kappa;
        let equivalent = (alpha_rad * alpha_rad + ratio * ratio).sqrt();
        let slope = (f.qbz1 + dfz * (f.qbz2 + dfz * f.qbz3)).max(0.0) * (1.0 + f.qbz5 * self.camber_rad.abs());
        let curvature = (f.qez1 + f.qez2 * dfz).min(1.0);
        let x = slope * equivalent;
        // The formula takes the cosine of the slip angle: of the tangent's arc, which is what alpha is here.
        self.pneumatic_trail_m() * cos(f.qcz1 * atan(x - curvature * (x - atan(x)))) * cos(alpha_rad)
    }
}

/// Stiffness factor B of K = B C D; 0 for a road without friction.
fn slope(stiffness: f64, shape: f64, peak: f64) -> f64 {
    if peak > 0.0 { stiffness / (shape * peak) } else { 0.0 }
}

/// `D sin(C atan(x - E (x - atan x)))` with `x = B slip`.
fn magic(x: f64, shape: f64, peak: f64, curvature: f64) -> f64 {
    peak * sin(shape * atan(x - curvature * (x - atan(x))))
}

/// `cos(C atan(x - E (x - atan x)))`: what is left of one force under the other slip.
fn weight(x: f64, shape: f64, curvature: f64) -> f64 {
    cos(shape * atan(x - curvature * (x - atan(x)))).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::super::parameters::HandlingParameters;
    use super::*;
    use proptest::prelude::*;

    const R0: f64 = 0.41;

    fn tyre() -> MagicFormula {
        HandlingParameters::defender110().tyre
    }

    #[test]
    fn slopes_at_zero_slip_are_the_stated_stiffnesses() {
        let tyre = tyre();
        for load in [1000.0, 5027.0, 9000.0] {
            let loaded = tyre.at(load, 0.0, R0);
            let d = 1e-6;
            let along = loaded.forces(d, 0.0).longitudinal_n / d;
            let across = -loaded.forces(0.0, d).lateral_n / d;
            assert!((along / loaded.slip_stiffness_n() - 1.0).abs() < 1e-6);
            assert!((across / loaded.cornering_stiffness_n_rad() - 1.0).abs() < 1e-6);
            let trail = -loaded.forces(0.0, d).aligning_n_m / loaded.forces(0.0, d).lateral_n;
            assert!((trail / loaded.pneumatic_trail_m() - 1.0).abs() < 1e-6);
        }
        // PKY1 Fz0 is the largest cornering stiffness, at PKY2 Fz0.
        let at_peak = tyre
            .at(tyre.pky2 * tyre.nominal_load_n, 0.0, R0)
            .cornering_stiffness_n_rad();
        assert!((at_peak / (-tyre.pky1 * tyre.nominal_load_n) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn peak_is_the_friction_coefficient_and_falls_with_load() {
        let tyre = tyre();
        let peak = |load: f64| {
            let loaded = tyre.at(load, 0.0, R0);
            let most = (0..600).map(|i| -loaded.forces(0.0, 0.002 * f64::from(i)).lateral_n);
            most.fold(0.0, f64::max) / load
        };
        assert!((peak(5797.0) - 1.0141).abs() < 1e-3, "{}", peak(5797.0));
        assert!(peak(9000.0) < peak(5797.0) && peak(5797.0) < peak(2000.0));
    }

    #[test]
    fn camber_pushes_to_the_side_it_leans_to() {
        // Leaning right (positive): force to the right (negative); some hundredths of the load per 0.1 rad.
        let force = tyre().at(5000.0, 0.1, R0).forces(0.0, 0.0).lateral_n / 5000.0;
        assert!((-0.2..-0.03).contains(&force), "{force}");
    }

    proptest! {
        #[test]
        fn a_mirrored_tyre_gives_mirrored_bits(
            load in 100.0..20000.0f64, camber in -0.5..0.5f64, kappa in -1.5..1.5f64, alpha in -1.5..1.5f64
        ) {
            let tyre = tyre();
            let one = tyre.at(load, camber, R0).forces(kappa, alpha);
            let other = tyre.at(load, -camber, R0).forces(kappa, -alpha);
            prop_assert_eq!(one.longitudinal_n, other.longitudinal_n);
            prop_assert_eq!(one.lateral_n, -other.lateral_n);
            prop_assert_eq!(one.aligning_n_m, -other.aligning_n_m);
        }

        #[test]
        fn combined_force_stays_within_friction_and_takes_energy_out(
            load in 100.0..12000.0f64, kappa in -1.0..1.0f64, alpha in -1.2..1.2f64
        ) {
            let loaded = tyre().at(load, 0.0, R0).forces(kappa, alpha);
            let total = (loaded.longitudinal_n * loaded.longitudinal_n + loaded.lateral_n * loaded.lateral_n).sqrt();
            let peak = 1.1387 - 0.11999 * ((load - 5797.0) / 5797.0).min(2.0);
            prop_assert!(total < 1.3 * peak * load, "{}", total / (peak * load));
            // Power of sliding: force along the slip velocity (-kappa, tan alpha) is never positive.
            prop_assert!(loaded.longitudinal_n * -kappa + loaded.lateral_n * libm::tan(alpha) <= 1e-9 * load);
        }
    }
}
