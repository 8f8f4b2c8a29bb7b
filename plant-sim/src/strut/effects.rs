//! The terms a strut model may have: the vocabulary of the recordings, one struct a term.
//!
//! Keys are those of `[effects.*]` in `model.toml`. A term that is absent is physics left out, never a default value.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

macro_rules! term {
    ($(#[$doc:meta])* $name:ident { $($(#[$fdoc:meta])* $field:ident : $ty:ty = $key:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name { $($(#[$fdoc])* #[serde(rename = $key)] pub $field: $ty),* }
    };
}

/// At which density the main chamber's balance counts oil.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OilCount {
    /// That of the chamber at the moment: `dp1/dt = beta / (V - A x) (A v - Q1 - Q2)`, the equation of the recordings. A loop
    /// in the force-displacement plane shifts `area / beta` of oil: harmless in a recording, centimetres in an hour.
    #[default]
    Chamber,
    /// That at static pressure: `d/dt [(V - A x) (exp((p1 - p_static)/beta) - 1)] = A v - Q1 - Q2`.
    /// Conserves oil.
    Static,
}
/// Finite stiffness of the oil: `dp = beta dV / V`. Report: 1.5e9 Pa; range 0.5e9 to 2.5e9.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OilCompressibility {
    /// Bulk modulus, Pa.
    #[serde(rename = "bulk_modulus_Pa")]
    pub bulk_modulus_pa: f64,
    /// Density at which oil is counted.
    #[serde(default, skip_serializing_if = "is_chamber")]
    pub counted_at: OilCount,
}

fn is_chamber(counted_at: &OilCount) -> bool {
    *counted_at == OilCount::Chamber
}

term! {
    /// Undissolved air in the main chamber's oil (Gholizadeh, Burton & Schoenau, "Fluid bulk modulus: a literature survey",
    /// Int. J. Fluid Power 12(3), 2011): `1/beta_eff = 1/beta + a (p_atm/p)^(1/n) / (n p)`, p absolute.
    EntrainedAir {
        /// Volume fraction at atmospheric pressure, 0 to 0.1.
        volume_fraction: f64 = "volume_fraction",
        /// Polytropic exponent of the bubbles, 1 (slow) to 1.4 (fast).
        polytropic_exponent: f64 = "polytropic_exponent",
    }
}
term! {
    /// Gas neither isothermal nor adiabatic: energy equation with a thermal time constant (Els & Grobbelaar, SAE 930265).
    GasHeatTransfer {
        /// Thermal time constant of accumulator 1, s. Range 0.5 to 20.
        time_constant_1_s: f64 = "time_constant_1_s",
        /// Thermal time constant of accumulator 2, s.
        time_constant_2_s: f64 = "time_constant_2_s",
    }
}
/// Equation of state of the real gas.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GasEquation {
    /// The reference equation of Span et al., J. Phys. Chem. Ref. Data 29(6), 2000.
    #[default]
    Reference,
    /// Benedict-Webb-Rubin with the constants of `vehicle.md`.
    Bwr,
}
/// Nitrogen departs from the ideal gas law.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RealGas {
    /// Which equation of state.
    #[serde(default)]
    pub equation: GasEquation,
}
term! {
    /// Gas charge off by a relative error of the gas volume at static pressure.
    GasChargeError {
        /// Accumulator 1, relative.
        relative_error_1: f64 = "relative_error_1",
        /// Accumulator 2, relative.
        relative_error_2: f64 = "relative_error_2",
    }
}
term! {
    /// Coulomb and Stribeck friction of the rod seal.
    SealFriction {
        /// Coulomb force while sliding fast, N.
        coulomb_force_n: f64 = "coulomb_force_N",
        /// Breakaway force, N, at least the Coulomb force.
        breakaway_force_n: f64 = "breakaway_force_N",
        /// Stribeck speed, m/s.
        stribeck_speed_m_s: f64 = "stribeck_speed_m_s",
        /// Presliding stiffness, N/m.
        presliding_stiffness_n_m: f64 = "presliding_stiffness_N_m",
    }
}
term! {
    /// Friction from the bending of an offset mounting: `mu |strut force| / (1 + s x)` (report, 3.5.1). The guides carry
    /// the bending moment over their overlap, which grows with jounce; `1/s` is the overlap at static position.
    SideLoadFriction {
        /// Friction force over strut force at static position, 0 to 0.3.
        coefficient: f64 = "coefficient",
        /// Relative growth of the guides' overlap with displacement, 1/m; 0 for guides of constant overlap.
        #[serde(default)]
        overlap_growth_1_m: f64 = "overlap_growth_1_m",
    }
}
term! {
    /// Pressure held back by the floating pistons' seals (the report's first suspicion for its hysteresis).
    AccumulatorPistonFriction {
        /// Breakaway pressure of accumulator 1, Pa.
        pressure_1_pa: f64 = "pressure_1_Pa",
        /// Breakaway pressure of accumulator 2, Pa.
        pressure_2_pa: f64 = "pressure_2_Pa",
        /// Oil volume that shears a piston's seal from rest to sliding, m3.
        #[serde(default = "presliding_volume")]
        presliding_volume_m3: f64 = "presliding_volume_m3",
    }
}
/// 0.05 mm of a 50 mm piston. *Assumed*; a diagnosis fits it.
fn presliding_volume() -> f64 {
    1e-7
}
term! {
    /// Oil passing beside the damper packs (the report's manufacturing error): an orifice in parallel.
    DamperLeakage {
        /// Flow coefficient beside pack 1, m3/s/sqrt(Pa).
        flow_coefficient_1: f64 = "flow_coefficient_1",
        /// Flow coefficient beside pack 2.
        flow_coefficient_2: f64 = "flow_coefficient_2",
    }
}
term! {
    /// Laminar loss of the lines in series with the paths: `dp = R Q`.
    LineResistance {
        /// Path 1, Pa s/m3.
        resistance_1_pa_s_m3: f64 = "resistance_1_Pa_s_m3",
        /// Path 2, Pa s/m3.
        resistance_2_pa_s_m3: f64 = "resistance_2_Pa_s_m3",
    }
}
term! {
    /// Mass of the oil column of line 2: `dp = I dQ/dt`, `I = rho l / a`.
    LineInertance {
        /// Inertance of path 2, kg/m4.
        inertance_2_kg_m4: f64 = "inertance_2_kg_m4",
    }
}
term! {
    /// Valve response time over pressure difference, in place of the model's polynomial (report, figure 25).
    ValveDelay {
        /// `c0 + c1 dP + c2 dP^2`, s, dP in MPa.
        response_polynomial_s: [f64; 3] = "response_polynomial_s",
    }
}
/// How a valve moves between the 5 % and the 95 % point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TransitionShape {
    /// A straight line through the two points.
    Linear,
}
term! {
    /// The valves open gradually, not in a step.
    ValveTransition {
        /// Shape of the movement.
        shape: TransitionShape = "shape",
    }
}
term! {
    /// The closed valve 3 passes oil: an orifice in parallel.
    Valve3Leakage {
        /// Flow coefficient, m3/s/sqrt(Pa).
        flow_coefficient: f64 = "flow_coefficient",
    }
}
term! {
    /// Buffers at the ends of travel; clearances from the static position.
    BumpStop {
        /// Free jounce travel, m.
        bump_clearance_m: f64 = "bump_clearance_m",
        /// Free rebound travel, m (positive).
        rebound_clearance_m: f64 = "rebound_clearance_m",
        /// Linear stiffness, N/m.
        stiffness_n_m: f64 = "stiffness_N_m",
        /// Cubic stiffness, N/m3.
        progression_n_m3: f64 = "progression_N_m3",
    }
}
term! {
    /// Rubber bush in series: the strut moves less than the actuator, `x_strut = x - F / k`.
    MountCompliance {
        /// Stiffness, N/m.
        stiffness_n_m: f64 = "stiffness_N_m",
    }
}
term! {
    /// Dampers weaken as their oil warms: drop divided by `1 + f E`, `dE/dt = dissipated power - E / tau`.
    DampingFade {
        /// Relative weakening of pack 1 per joule held, 1/J.
        fade_1_per_j: f64 = "fade_1_per_J",
        /// Relative weakening of pack 2, 1/J.
        fade_2_per_j: f64 = "fade_2_per_J",
        /// Cooling time constant, s.
        cooling_time_s: f64 = "cooling_time_s",
    }
}
/// Where a law without a name acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawPlace {
    /// Force between rod and cylinder, N.
    MainSeal,
    /// Volume that the main chamber gives way, m3.
    MainChamber,
    /// Pressure drop in series with path 1, Pa.
    #[serde(rename = "path-1")]
    Path1,
    /// Pressure drop in series with path 2, Pa.
    #[serde(rename = "path-2")]
    Path2,
    /// Flow beside pack 1, m3/s.
    #[serde(rename = "beside-pack-1")]
    BesidePack1,
    /// Flow beside pack 2, m3/s.
    #[serde(rename = "beside-pack-2")]
    BesidePack2,
    /// Factor on the pressure drop of pack 1.
    #[serde(rename = "pack-1")]
    Pack1,
    /// Factor on the pressure drop of pack 2.
    #[serde(rename = "pack-2")]
    Pack2,
    /// Factor on the flow of valve 1.
    #[serde(rename = "valve-1")]
    Valve1,
    /// Factor on the flow of valve 2.
    #[serde(rename = "valve-2")]
    Valve2,
    /// Factor on the flow of valve 3.
    #[serde(rename = "valve-3")]
    Valve3,
    /// Factor on the flow of each valve.
    #[serde(rename = "valve-1..3")]
    Valves,
    /// Level of friction between rod and cylinder, against the motion, N.
    MainSealFriction,
    /// Factor on the gas pressure of accumulator 1.
    #[serde(rename = "accumulator-1")]
    Accumulator1,
    /// Factor on the gas pressure of accumulator 2.
    #[serde(rename = "accumulator-2")]
    Accumulator2,
    /// Flow out of the main chamber that does not come back, m3/s.
    MainChamberLoss,
}
/// What a law without a name depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LawArgument {
    /// Displacement, m (forces, friction, packs; beside a pack the value is a flow coefficient, m3/s/sqrt(Pa)).
    Displacement,
    /// Strut speed, m/s (forces and friction).
    Speed,
    /// Gauge pressure p1, Pa (forces, friction, volume and loss).
    P1,
    /// Flow of the path, m3/s (series drops).
    Flow,
    /// Pressure drop across the pack, Pa (parallel flows); its size (valves).
    PressureDrop,
    /// Gas volume over the one at static pressure (accumulators).
    RelativeVolume,
}
/// A law that has no name: a table at a place, over a measured quantity; linear between points and beyond the ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UnlistedLaw {
    /// Place, which fixes what the law gives: a force, a volume, a drop or a flow.
    pub place: LawPlace,
    /// Its argument.
    pub depends_on: LawArgument,
    /// Argument values, strictly increasing, at least two.
    pub argument: Vec<f64>,
    /// Values at them (volume, drop and flow laws: not decreasing).
    pub value: Vec<f64>,
}

/// Effect of an instrument: column name to value, in the unit the field of [`Effects`] states.
pub type SensorEffect = BTreeMap<String, f64>;

/// All terms of a model.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)] // each term says it
pub struct Effects {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oil_compressibility: Option<OilCompressibility>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub entrained_air: Option<EntrainedAir>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gas_heat_transfer: Option<GasHeatTransfer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub real_gas: Option<RealGas>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gas_charge_error: Option<GasChargeError>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seal_friction: Option<SealFriction>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side_load_friction: Option<SideLoadFriction>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accumulator_piston_friction: Option<AccumulatorPistonFriction>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damper_leakage: Option<DamperLeakage>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line_resistance: Option<LineResistance>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line_inertance: Option<LineInertance>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valve_delay: Option<ValveDelay>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valve_transition: Option<ValveTransition>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valve3_leakage: Option<Valve3Leakage>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bump_stop: Option<BumpStop>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mount_compliance: Option<MountCompliance>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_fade: Option<DampingFade>,
    /// First-order lag of a column, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_lag: Option<SensorEffect>,
    /// Relative gain error of a column (0.02: reads 2 % high, about its value at rest for none: about zero).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_gain: Option<SensorEffect>,
    /// Drift of a column, its unit per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_drift: Option<SensorEffect>,
    /// Time by which a column is late, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_skew: Option<SensorEffect>,
    /// Columns with the wrong sign: value -1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_sign: Option<SensorEffect>,
    /// Offset of a column, its unit: calibration within `[tolerance]`, never physics.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_offset: Option<SensorEffect>,
    /// Laws without a name.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub unlisted: Vec<UnlistedLaw>,
}
