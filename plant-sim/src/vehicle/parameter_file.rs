//! Reads vehicle parameters from TOML and refuses what no vehicle can be, with file, line and key in one line.
//!
//! serde finds unknown, missing and mistyped keys; the table of limits below finds the impossible values. The line of
//! a value is found again in the text, so that the parameter structs stay plain numbers.

use oleo_interface::tick::TICK_S;

use super::parameters::VehicleParameters;

/// A vehicle file that cannot be used: one line saying where and why.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{source_name}:{line}: {problem}")]
pub struct ParameterError {
    /// File name or the name given by the caller.
    pub source_name: String,
    /// Line in the file, from 1.
    pub line: usize,
    /// Names the key and says what to do.
    pub problem: String,
}

/// Closed range a value must lie in.
pub(crate) type Limits = (f64, f64);

const MASS_KG: Limits = (1.0, 1e5);
const INERTIA_KG_M2: Limits = (0.1, 1e6);
const LENGTH_M: Limits = (0.1, 20.0);
const RATE_N_M: Limits = (1e3, 1e7);
const DAMPING_N_S_M: Limits = (0.0, 1e5);

impl VehicleParameters {
    /// Parses and checks a vehicle file. `source_name` appears in errors.
    ///
    /// # Errors
    /// Unknown, missing or mistyped keys and values outside their physical range, each with its line.
    pub fn from_toml(text: &str, source_name: &str) -> Result<Self, ParameterError> {
        let parameters: Self = toml::from_str(text).map_err(|error| ParameterError {
            source_name: source_name.to_owned(),
            line: error.span().map_or(1, |span| line_at(text, span.start)),
            problem: describe(text, &error),
        })?;
        parameters.check().map_err(|(table, key, why)| ParameterError {
            source_name: source_name.to_owned(),
            line: line_of(text, table, key),
            problem: format!("[{table}] {key}: {why}"),
        })?;
        Ok(parameters)
    }

    /// The parameters as a file that `from_toml` reads back to the same bits.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// First impossible value as (table, key, reason).
    fn check(&self) -> Result<(), (&'static str, &'static str, String)> {
        let body = &self.body;
        within("body", "sprung_mass_kg", body.sprung_mass_kg, MASS_KG)?;
        within("body", "roll_inertia_kg_m2", body.roll_inertia_kg_m2, INERTIA_KG_M2)?;
        within("body", "pitch_inertia_kg_m2", body.pitch_inertia_kg_m2, INERTIA_KG_M2)?;
        within("body", "yaw_inertia_kg_m2", body.yaw_inertia_kg_m2, INERTIA_KG_M2)?;
        within("body", "vehicle_cg_height_m", body.vehicle_cg_height_m, (0.05, 10.0))?;
        within("body", "front_mass_share", body.front_mass_share, (0.05, 0.95))?;
        within("layout", "wheelbase_m", self.layout.wheelbase_m, LENGTH_M)?;
        within("layout", "width_m", self.layout.width_m, LENGTH_M)?;
        for (table, axle) in [("front_axle", &self.front_axle), ("rear_axle", &self.rear_axle)] {
            within(table, "mass_kg", axle.mass_kg, MASS_KG)?;
            within(table, "inertia_kg_m2", axle.inertia_kg_m2, INERTIA_KG_M2)?;
            within(table, "track_m", axle.track_m, LENGTH_M)?;
            within(table, "strut_spacing_m", axle.strut_spacing_m, LENGTH_M)?;
            within(
                table,
                "anti_roll_stiffness_n_m_rad",
                axle.anti_roll_stiffness_n_m_rad,
                (0.0, 1e7),
            )?;
            within(table, "tyre_stiffness_n_m", axle.tyre_stiffness_n_m, RATE_N_M)?;
            within(table, "tyre_damping_n_s_m", axle.tyre_damping_n_s_m, DAMPING_N_S_M)?;
            within(table, "tyre_radius_m", axle.tyre_radius_m, (0.05, 3.0))?;
        }
        within("tyre", "contact_length_m", self.tyre.contact_length_m, (0.0, 1.0))?;
        for (table, baseline) in [
            ("front_baseline", &self.front_baseline),
            ("rear_baseline", &self.rear_baseline),
        ] {
            within(table, "coil_stiffness_n_m", baseline.coil_stiffness_n_m, RATE_N_M)?;
            within(table, "bump_damping_n_s_m", baseline.bump_damping_n_s_m, DAMPING_N_S_M)?;
            within(
                table,
                "rebound_damping_n_s_m",
                baseline.rebound_damping_n_s_m,
                DAMPING_N_S_M,
            )?;
            within(table, "bump_clearance_m", baseline.bump_clearance_m, (0.0, 1.0))?;
            within(table, "rebound_clearance_m", baseline.rebound_clearance_m, (0.0, 1.0))?;
            within(table, "stop_stiffness_n_m", baseline.stop_stiffness_n_m, (0.0, 1e7))?;
        }
        for (table, seat) in [
            ("driver_seat", &self.driver_seat),
            ("passenger_seat", &self.passenger_seat),
        ] {
            within(table, "behind_front_axle_m", seat.behind_front_axle_m, (-10.0, 20.0))?;
            within(table, "left_of_centre_m", seat.left_of_centre_m, (-5.0, 5.0))?;
            within(table, "above_ground_m", seat.above_ground_m, (-2.0, 10.0))?;
        }
        let step_s = self.solver.step_s;
        within("solver", "step_s", step_s, (1e-6, 0.005))?;
        let steps = (TICK_S / step_s).round();
        if (steps * step_s - TICK_S).abs() > 1e-9 {
            return Err((
                "solver",
                "step_s",
                format!("{step_s} does not divide the tick of {TICK_S} s; take 0.001"),
            ));
        }
        let front_share = 1.0 - self.body_cg_behind_front_axle_m() / self.layout.wheelbase_m;
        if !(0.02..=0.98).contains(&front_share) {
            return Err((
                "body",
                "front_mass_share",
                format!(
                    "with these axle masses the front struts would carry {:.0} % of the body",
                    100.0 * front_share
                ),
            ));
        }
        Ok(())
    }
}

pub(crate) fn within(
    table: &'static str,
    key: &'static str,
    value: f64,
    (low, high): Limits,
) -> Result<(), (&'static str, &'static str, String)> {
    if value >= low && value <= high {
        return Ok(());
    }
    Err((
        table,
        key,
        format!("{value} is outside the possible range {low} to {high}"),
    ))
}

/// One line from a TOML error, with the key it is about where that can be seen.
pub(crate) fn describe(text: &str, error: &toml::de::Error) -> String {
    let message = error.message().replace('\n', " ");
    let key = error.span().and_then(|span| {
        let line = text.lines().nth(line_at(text, span.start) - 1)?;
        let (key, _) = line.split_once('=')?;
        Some(key.trim().to_owned())
    });
    match key {
        Some(key) if !message.contains(&key) => format!("{key}: {message}"),
        _ => message,
    }
}

/// Line, from 1, of a byte offset.
pub(crate) fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
}

/// Line, from 1, of `key` in `[table]`; 1 where it is not written in that form.
pub(crate) fn line_of(text: &str, table: &str, key: &str) -> usize {
    let header = format!("[{table}]");
    let mut inside = false;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim_start();
        if line.starts_with('[') {
            inside = line.starts_with(&header);
        } else if inside && line.split('=').next().is_some_and(|name| name.trim() == key) {
            return index + 1;
        }
    }
    1
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRESET: &str = include_str!("../../presets/defender110.toml");

    fn error_of(text: &str) -> ParameterError {
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
        let [front_left, front_right, ..] = wheels.into_array();
        let sum: f64 = wheels.values().sum();
        assert!((sum / (2050.0 * GRAVITY) - 1.0).abs() < 1e-12);
        assert!(((front_left + front_right) / sum - 0.5).abs() < 1e-12);
        assert_eq!(front_left.to_bits(), front_right.to_bits());
    }
    const GRAVITY: f64 = super::super::parameters::GRAVITY_M_S2;

    #[test]
    fn bad_files_give_file_line_and_key() {
        let unknown = PRESET.replace("width_m", "widht_m");
        let error = error_of(&unknown);
        assert_eq!(
            error.line,
            1 + unknown.lines().position(|l| l.starts_with("widht_m")).unwrap()
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
            error.line,
            1 + missing.lines().position(|l| l.starts_with("[layout]")).unwrap()
        );

        let impossible = PRESET.replace("sprung_mass_kg = 1600.0", "sprung_mass_kg = -1600.0");
        let error = error_of(&impossible);
        assert_eq!(
            error.line,
            1 + PRESET.lines().position(|l| l.starts_with("sprung_mass_kg")).unwrap()
        );
        assert!(error.to_string().starts_with("car.toml:"), "{error}");
        assert!(error.to_string().contains("[body] sprung_mass_kg"), "{error}");

        let mistyped = PRESET.replace("step_s = 0.001", "step_s = \"fast\"");
        assert!(error_of(&mistyped).to_string().contains("step_s"));

        let undivided = PRESET.replace("step_s = 0.001", "step_s = 0.003");
        assert!(error_of(&undivided).to_string().contains("does not divide"));

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
