//! Parameters of a vehicle, each with its unit and source.
//!
//! One TOML file describes one vehicle; the ride model and the handling model read the same file, so that a mass is
//! stated once. Every value of the shipped preset carries the label of its origin in a comment of
//! `presets/defender110.toml`. A file with an unknown key, a missing key or an impossible value is refused with one
//! line that names file, line and key: a simulation of the wrong vehicle is worse than none.

use oleo_interface::{Axle, Corner, Corners};
use serde::{Deserialize, Serialize};

use super::seat::Seat;
use crate::model_file::{Checked, InvalidValue, Limit, ModelFileError, Range, checked, read};

/// Standard acceleration of gravity, m/s2 (ISO 80000-3).
pub const GRAVITY_M_S2: f64 = 9.80665;

/// A vehicle, complete. All values SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleParameters {
    /// What the vehicle is called in reports.
    pub name: String,
    /// Mass and inertias of the sprung mass.
    pub body: BodyParameters,
    /// Overall dimensions and weight distribution.
    pub layout: LayoutParameters,
    /// Front live axle with its wheels.
    pub front_axle: AxleParameters,
    /// Rear live axle with its wheels.
    pub rear_axle: AxleParameters,
    /// What is the same for all tyres.
    pub tyre: TyreParameters,
    /// Coil springs and dampers of the vehicle as sold, front.
    pub front_baseline: BaselineParameters,
    /// Coil springs and dampers of the vehicle as sold, rear.
    pub rear_baseline: BaselineParameters,
    /// Driver's seat (right front in the preset).
    pub driver_seat: SeatParameters,
    /// Left rear passenger's seat.
    pub passenger_seat: SeatParameters,
    /// Settings of the fixed-step integration.
    pub solver: SolverParameters,
}

/// Mass of a body or an axle, kg.
const MASS_KG: Range = Range::FromTo(1.0, 1e5);
/// Inertia of a body or an axle, kg m2.
const INERTIA_KG_M2: Range = Range::FromTo(0.1, 1e6);
/// Dimension of a vehicle, m.
const LENGTH_M: Range = Range::FromTo(0.1, 20.0);
/// Rate of a spring or a tyre, N/m.
const RATE_N_M: Range = Range::FromTo(1e3, 1e7);
/// Rate of a damper or a tyre, N s/m.
const DAMPING_N_S_M: Range = Range::FromTo(0.0, 1e5);

impl Checked for VehicleParameters {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        checked(&self.body, "body")?;
        checked(&self.layout, "layout")?;
        checked(&self.front_axle, "front_axle")?;
        checked(&self.rear_axle, "rear_axle")?;
        checked(&self.tyre, "tyre")?;
        checked(&self.front_baseline, "front_baseline")?;
        checked(&self.rear_baseline, "rear_baseline")?;
        checked(&self.driver_seat, "driver_seat")?;
        checked(&self.passenger_seat, "passenger_seat")?;
        checked(&self.solver, "solver")?;
        let front_share = 1.0 - self.body_cg_behind_front_axle_m() / self.layout.wheelbase_m;
        if !(0.02..=0.98).contains(&front_share) {
            let what = format!(
                "is {}: with these axle masses the front struts would carry {:.0} % of the body; must leave 2 to 98 %",
                self.body.front_mass_share,
                100.0 * front_share
            );
            return Err(InvalidValue::new("front_mass_share", what).inside("body"));
        }
        Ok(())
    }
}

/// The sprung mass: a rigid body with its principal axes along x (forward), y (left), z (up).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyParameters {
    /// Sprung mass m_s, kg.
    pub sprung_mass_kg: f64,
    /// J_x about the body's own centre of mass, kg m2.
    pub roll_inertia_kg_m2: f64,
    /// Pitch inertia J_y of the sprung mass, kg m2.
    pub pitch_inertia_kg_m2: f64,
    /// Yaw inertia J_z of the sprung mass, kg m2.
    pub yaw_inertia_kg_m2: f64,
    /// Height of the *whole vehicle's* centre of mass above ground at static load, m.
    pub vehicle_cg_height_m: f64,
    /// Share of the *whole vehicle's* weight on the front axle, 0..1.
    pub front_mass_share: f64,
}

impl Checked for BodyParameters {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("sprung_mass_kg", MASS_KG, "kg", |p| p.sprung_mass_kg),
        Limit::one("roll_inertia_kg_m2", INERTIA_KG_M2, "kg m2", |p| p.roll_inertia_kg_m2),
        Limit::one("pitch_inertia_kg_m2", INERTIA_KG_M2, "kg m2", |p| p.pitch_inertia_kg_m2),
        Limit::one("yaw_inertia_kg_m2", INERTIA_KG_M2, "kg m2", |p| p.yaw_inertia_kg_m2),
        Limit::one("vehicle_cg_height_m", Range::FromTo(0.05, 10.0), "m", |p| {
            p.vehicle_cg_height_m
        }),
        Limit::one("front_mass_share", Range::FromTo(0.05, 0.95), "", |p| {
            p.front_mass_share
        }),
    ];
}

/// Overall dimensions of the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutParameters {
    /// Front to rear axle, m.
    pub wheelbase_m: f64,
    /// Overall width w, which sets the lane widths of ISO 3888, m.
    pub width_m: f64,
}

impl Checked for LayoutParameters {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("wheelbase_m", LENGTH_M, "m", |p| p.wheelbase_m),
        Limit::one("width_m", LENGTH_M, "m", |p| p.width_m),
    ];
}

/// A live axle with its two wheels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxleParameters {
    /// Axle with wheels, m_f or m_r, kg.
    pub mass_kg: f64,
    /// J_f or J_r: inertia about x and, as Appendix A has it, about z; kg m2.
    pub inertia_kg_m2: f64,
    /// Distance between the left and right wheel centres, m.
    pub track_m: f64,
    /// Distance between the left and right strut on the axle (2 l_g/d2), m.
    pub strut_spacing_m: f64,
    /// k_arb: torque between body and axle per radian of relative roll, N m/rad; 0 = no bar.
    pub anti_roll_stiffness_n_m_rad: f64,
    /// Vertical rate of one tyre, N/m.
    pub tyre_stiffness_n_m: f64,
    /// Vertical damping of one tyre, N s/m.
    pub tyre_damping_n_s_m: f64,
    /// Height of the wheel centre above ground at static load, m.
    pub tyre_radius_m: f64,
}

impl Checked for AxleParameters {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("mass_kg", MASS_KG, "kg", |p| p.mass_kg),
        Limit::one("inertia_kg_m2", INERTIA_KG_M2, "kg m2", |p| p.inertia_kg_m2),
        Limit::one("track_m", LENGTH_M, "m", |p| p.track_m),
        Limit::one("strut_spacing_m", LENGTH_M, "m", |p| p.strut_spacing_m),
        Limit::one("anti_roll_stiffness_n_m_rad", Range::FromTo(0.0, 1e7), "N m/rad", |p| {
            p.anti_roll_stiffness_n_m_rad
        }),
        Limit::one("tyre_stiffness_n_m", RATE_N_M, "N/m", |p| p.tyre_stiffness_n_m),
        Limit::one("tyre_damping_n_s_m", DAMPING_N_S_M, "N s/m", |p| p.tyre_damping_n_s_m),
        Limit::one("tyre_radius_m", Range::FromTo(0.05, 3.0), "m", |p| p.tyre_radius_m),
    ];
}

/// Tyre contact in the vertical direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TyreParameters {
    /// Length over which the road height is averaged, m; 0 = point contact as in Appendix A.
    pub contact_length_m: f64,
}

impl Checked for TyreParameters {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("contact_length_m", Range::FromTo(0.0, 1.0), "m", |p| {
        p.contact_length_m
    })];
}

/// Coil spring, damper and stops of one wheel of the vehicle as sold. Bump = compression.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BaselineParameters {
    /// Spring rate of the coil spring, N/m.
    pub coil_stiffness_n_m: f64,
    /// Damper rate in compression, N s/m.
    pub bump_damping_n_s_m: f64,
    /// Damper rate in extension, N s/m.
    pub rebound_damping_n_s_m: f64,
    /// Compression from static at which the bump stop is touched, m.
    pub bump_clearance_m: f64,
    /// Extension from static at which the rebound stop is touched, m.
    pub rebound_clearance_m: f64,
    /// Rate of either stop once touched, N/m.
    pub stop_stiffness_n_m: f64,
}

impl Checked for BaselineParameters {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("coil_stiffness_n_m", RATE_N_M, "N/m", |p| p.coil_stiffness_n_m),
        Limit::one("bump_damping_n_s_m", DAMPING_N_S_M, "N s/m", |p| p.bump_damping_n_s_m),
        Limit::one("rebound_damping_n_s_m", DAMPING_N_S_M, "N s/m", |p| {
            p.rebound_damping_n_s_m
        }),
        Limit::one("bump_clearance_m", Range::FromTo(0.0, 1.0), "m", |p| p.bump_clearance_m),
        Limit::one("rebound_clearance_m", Range::FromTo(0.0, 1.0), "m", |p| {
            p.rebound_clearance_m
        }),
        Limit::one("stop_stiffness_n_m", Range::FromTo(0.0, 1e7), "N/m", |p| {
            p.stop_stiffness_n_m
        }),
    ];
}

/// A seat's place on the body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeatParameters {
    /// Distance behind the front axle, m.
    pub behind_front_axle_m: f64,
    /// Distance to the left of the centre plane, m (right is negative).
    pub left_of_centre_m: f64,
    /// Height of the seat surface above ground at static load, m.
    pub above_ground_m: f64,
}

impl Checked for SeatParameters {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("behind_front_axle_m", Range::FromTo(-10.0, 20.0), "m", |p| {
            p.behind_front_axle_m
        }),
        Limit::one("left_of_centre_m", Range::FromTo(-5.0, 5.0), "m", |p| {
            p.left_of_centre_m
        }),
        Limit::one("above_ground_m", Range::FromTo(-2.0, 10.0), "m", |p| p.above_ground_m),
    ];
}

/// Settings of the fixed-step integration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolverParameters {
    /// Integration step, s. Must divide the controller's tick (5 ms).
    pub step_s: f64,
}

impl Checked for SolverParameters {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("step_s", Range::FromTo(1e-6, 0.005), "s", |p| p.step_s)];

    fn check_together(&self) -> Result<(), InvalidValue> {
        let steps = (TICK_S / self.step_s).round();
        if (steps * self.step_s - TICK_S).abs() <= 1e-9 {
            return Ok(());
        }
        let what = format!(
            "is {}: must divide the tick of {TICK_S} s, for example 0.001",
            self.step_s
        );
        Err(InvalidValue::new("step_s", what))
    }
}

impl VehicleParameters {
    /// Read and check a vehicle file. `file` is the name that appears in errors.
    ///
    /// ```
    /// use oleo_plant_sim::vehicle::VehicleParameters;
    /// let vehicle = VehicleParameters::defender110();
    /// assert_eq!(VehicleParameters::from_toml(&vehicle.to_toml(), "copy.toml"), Ok(vehicle.clone()));
    /// // Struts carry the body, wheels the whole vehicle.
    /// let (struts, wheels) = (vehicle.static_strut_load_n(), vehicle.static_wheel_load_n());
    /// let sum = |load_n: &[f64; 4]| load_n.iter().sum::<f64>() / 9.806_65;
    /// assert!((sum(struts.as_array()) - vehicle.body.sprung_mass_kg).abs() < 1e-6);
    /// assert!((sum(wheels.as_array()) - vehicle.total_mass_kg()).abs() < 1e-6);
    /// ```
    ///
    /// # Errors
    /// Unknown, missing or mistyped keys and values outside their physical range, each with its line.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ModelFileError> {
        read(text, file)
    }

    /// The parameters as a file that `from_toml` reads back to the same bits.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// The file of the shipped Defender 110.
    pub const DEFENDER110_TOML: &'static str = include_str!("../../presets/defender110.toml");

    /// The shipped Defender 110: kerb weight and driver, 2050 kg.
    pub fn defender110() -> Self {
        Self::from_toml(Self::DEFENDER110_TOML, "presets/defender110.toml")
            .expect("the shipped preset is parsed in the tests")
    }

    /// Mass of the whole vehicle, kg.
    pub fn total_mass_kg(&self) -> f64 {
        self.body.sprung_mass_kg + self.front_axle.mass_kg + self.rear_axle.mass_kg
    }

    /// Distance from the front axle back to the *body's* centre of mass, m (l_e/c1 of the front axle).
    ///
    /// Moments about the front axle: `m_s a_s = m L (1 - share) - m_r L`.
    pub fn body_cg_behind_front_axle_m(&self) -> f64 {
        let wheelbase_m = self.layout.wheelbase_m;
        let moment = self.total_mass_kg() * wheelbase_m * (1.0 - self.body.front_mass_share)
            - self.rear_axle.mass_kg * wheelbase_m;
        moment / self.body.sprung_mass_kg
    }

    /// Height of the *body's* centre of mass above ground at static load, m; axles at wheel-centre height.
    pub fn body_cg_height_m(&self) -> f64 {
        let axles = self.front_axle.mass_kg * self.front_axle.tyre_radius_m
            + self.rear_axle.mass_kg * self.rear_axle.tyre_radius_m;
        (self.total_mass_kg() * self.body.vehicle_cg_height_m - axles) / self.body.sprung_mass_kg
    }

    /// Weight that each strut carries at rest on level ground, N: what `StrutModel::defender110` is charged for.
    pub fn static_strut_load_n(&self) -> Corners<f64> {
        let behind = self.body_cg_behind_front_axle_m();
        let weight_n = self.body.sprung_mass_kg * GRAVITY_M_S2;
        let rear = 0.5 * weight_n * behind / self.layout.wheelbase_m;
        let front = 0.5 * weight_n - rear;
        Corners::from_fn(|corner| match corner.axle() {
            Axle::Front => front,
            Axle::Rear => rear,
        })
    }

    /// Vertical force of the road on each wheel at rest on level ground, N.
    pub fn static_wheel_load_n(&self) -> Corners<f64> {
        let strut = self.static_strut_load_n();
        Corners::from_fn(|corner| strut[corner] + 0.5 * self.axle_of(corner).mass_kg * GRAVITY_M_S2)
    }

    /// Position of a seat relative to the body's centre of mass, `(x forward, y left)` in m.
    pub fn seat_position_m(&self, seat: &SeatParameters) -> (f64, f64) {
        (
            self.body_cg_behind_front_axle_m() - seat.behind_front_axle_m,
            seat.left_of_centre_m,
        )
    }

    /// A seat's place in body axes (ahead, left, up) from the body's centre of mass, m.
    pub fn seat_place_m(&self, seat: Seat) -> [f64; 3] {
        let seat = match seat {
            Seat::Driver => &self.driver_seat,
            Seat::Passenger => &self.passenger_seat,
        };
        let (x, y) = self.seat_position_m(seat);
        [x, y, seat.above_ground_m - self.body_cg_height_m()]
    }

    /// Parameters of an axle.
    pub fn axle(&self, axle: Axle) -> &AxleParameters {
        match axle {
            Axle::Front => &self.front_axle,
            Axle::Rear => &self.rear_axle,
        }
    }

    /// Parameters of the axle that a corner belongs to.
    pub fn axle_of(&self, corner: Corner) -> &AxleParameters {
        self.axle(corner.axle())
    }

    /// Coil spring and damper of the vehicle as sold at an axle.
    pub fn baseline(&self, axle: Axle) -> &BaselineParameters {
        match axle {
            Axle::Front => &self.front_baseline,
            Axle::Rear => &self.rear_baseline,
        }
    }
}

/// The controller's tick, s, which the plant's step must divide.
const TICK_S: f64 = oleo_interface::tick::TICK_S;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_file::limits::forgotten_keys;

    const PRESET: &str = VehicleParameters::DEFENDER110_TOML;

    /// Table 1 of the seed report counts one "anti-rollbar stiffness" between the two halves of one bar.
    #[test]
    fn the_preset_has_one_anti_roll_bar() {
        let preset = VehicleParameters::defender110();
        let bars = Axle::ALL.map(|axle| preset.axle(axle).anti_roll_stiffness_n_m_rad);
        assert_eq!(bars.iter().filter(|stiffness| **stiffness > 0.0).count(), 1, "{bars:?}");
    }

    fn error_of(text: &str) -> ModelFileError {
        VehicleParameters::from_toml(text, "car.toml").expect_err("must be refused")
    }

    #[test]
    fn preset_is_read_and_survives_the_round_trip() {
        let preset = VehicleParameters::defender110();
        assert_eq!(preset.total_mass_kg(), 2050.0);
        let again = VehicleParameters::from_toml(&preset.to_toml(), "again").unwrap();
        assert_eq!(again, preset);
    }

    #[test]
    fn every_value_of_the_preset_is_labelled_with_its_origin() {
        for line in PRESET
            .lines()
            .filter(|line| line.contains(" = ") && !line.starts_with('#'))
        {
            if line.starts_with("name") || line.starts_with("step_s") {
                continue;
            }
            let label = line.split('#').nth(1).unwrap_or("").trim();
            assert!(
                ["report", "source", "recalled", "assumed", "computed"]
                    .iter()
                    .any(|known| label.starts_with(known)),
                "no origin: {line}"
            );
        }
    }

    #[test]
    fn weight_is_carried_by_wheels_and_shared_as_stated() {
        let preset = VehicleParameters::defender110();
        let wheels = preset.static_wheel_load_n();
        let sum: f64 = wheels.values().sum();
        let [front_left, front_right] = wheels.of_axle(Axle::Front);
        assert!((sum / (2050.0 * GRAVITY_M_S2) - 1.0).abs() < 1e-12);
        assert!(((front_left + front_right) / sum - 0.5).abs() < 1e-12);
        assert_eq!(front_left.to_bits(), front_right.to_bits());
    }

    #[test]
    fn every_number_has_a_limit() {
        let p = VehicleParameters::defender110();
        let forgotten = [
            forgotten_keys(&p),
            forgotten_keys(&p.body),
            forgotten_keys(&p.layout),
            forgotten_keys(&p.front_axle),
            forgotten_keys(&p.tyre),
            forgotten_keys(&p.front_baseline),
            forgotten_keys(&p.driver_seat),
            forgotten_keys(&p.solver),
        ];
        assert!(forgotten.concat().is_empty(), "{forgotten:?}");
    }

    #[test]
    fn bad_files_give_file_line_and_key() {
        let unknown = PRESET.replace("width_m", "widht_m");
        let error = error_of(&unknown);
        assert_eq!(
            error.line(),
            Some(1 + unknown.lines().position(|l| l.starts_with("widht_m")).unwrap())
        );
        assert!(error.to_string().contains("widht_m"), "{error}");

        let missing: String = PRESET
            .lines()
            .filter(|l| !l.starts_with("wheelbase_m"))
            .map(|l| format!("{l}\n"))
            .collect();
        let error = error_of(&missing);
        assert!(error.to_string().contains("wheelbase_m"), "{error}");
        assert_eq!(
            error.line(),
            Some(1 + missing.lines().position(|l| l.starts_with("[layout]")).unwrap())
        );

        let impossible = PRESET.replace("sprung_mass_kg = 1600.0", "sprung_mass_kg = -1600.0");
        let error = error_of(&impossible);
        assert_eq!(
            error.line(),
            Some(1 + PRESET.lines().position(|l| l.starts_with("sprung_mass_kg")).unwrap())
        );
        assert!(error.to_string().starts_with("car.toml:"), "{error}");
        assert!(error.to_string().contains("[body] sprung_mass_kg"), "{error}");

        let mistyped = PRESET.replace("step_s = 0.001", "step_s = \"fast\"");
        assert!(error_of(&mistyped).to_string().contains("step_s"));

        let undivided = PRESET.replace("step_s = 0.001", "step_s = 0.003");
        assert!(error_of(&undivided).to_string().contains("must divide the tick"));

        for text in ["", "name", "[body", "\u{0}"] {
            assert!(!error_of(text).to_string().contains('\n'));
        }
    }

    #[test]
    fn not_a_number_and_infinity_are_refused() {
        for value in ["nan", "inf", "-inf"] {
            let text = PRESET.replace("width_m = 1.79", &format!("width_m = {value}"));
            assert!(error_of(&text).to_string().contains("width_m"));
        }
    }
}
