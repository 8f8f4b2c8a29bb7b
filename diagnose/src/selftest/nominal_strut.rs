//! A strut nobody has: nominal numbers spread as those of the labelled campaigns are, everything but the concealed effect
//! in its model, and the tolerances and noise stated there.

use oleo_plant_sim::strut::StrutModel;

use super::draw::Draw;

/// Damper characteristic of the labelled struts at one, the pressure drop at -2 l/s, Pa.
const DROP_AT_REBOUND_PA: f64 = 2.68e6;
/// Flow, m3/s, and pressure drop over [`DROP_AT_REBOUND_PA`].
const PACK: [(f64, f64); 9] = [
    (-2e-3, -1.0),
    (-1e-3, -0.673),
    (-4e-4, -0.442),
    (-1.2e-4, -0.1385),
    (0.0, 0.0),
    (1.2e-4, 0.0731),
    (4e-4, 0.2),
    (1e-3, 0.369),
    (2e-3, 0.615),
];

/// The complete nominal model.
///
/// # Panics
/// Never: the text it writes is the model file's form.
#[must_use]
pub fn nominal(name: &str, draw: &mut Draw) -> StrutModel {
    let list = |values: Vec<f64>| {
        format!(
            "[{}]",
            values.iter().map(|v| format!("{v:e}")).collect::<Vec<_>>().join(", ")
        )
    };
    let flow = list(PACK.iter().map(|p| p.0).collect());
    let first = DROP_AT_REBOUND_PA * draw.between(0.8, 1.15);
    let second = first * draw.between(0.74, 0.84);
    let drop = |scale: f64| list(PACK.iter().map(|p| scale * p.1).collect());
    let tau = draw.between(2.3, 4.6);
    let text = format!(
        "[specimen]\nname = \"{name}\"\nkind = \"two-stage hydropneumatic strut\"\n\
         [cylinder]\nbore_m = 0.05\noil_volume_m3 = {:e}\nstatic_pressure_Pa = {:e}\n\
         [gas]\nspecies = \"nitrogen\"\ntemperature_K = 293.15\n\
         [[accumulator]]\nstatic_gas_volume_m3 = 1e-4\n[[accumulator]]\nstatic_gas_volume_m3 = 4e-4\n\
         [[damper]]\nflow_m3_s = {flow}\npressure_drop_Pa = {}\n[[damper]]\nflow_m3_s = {flow}\npressure_drop_Pa = {}\n\
         [[valve]]\nflow_coefficient = {:e}\n[[valve]]\nflow_coefficient = {:e}\n[[valve]]\nflow_coefficient = {:e}\n\
         [orifice]\ntransition_pressure_Pa = 2e4\n\
         [valve_timing]\nresponse_polynomial_s = [{:e}, {:e}, {:e}]\ninitial_delay_fraction = 0.4\n\
         [effects.oil_compressibility]\nbulk_modulus_Pa = {:e}\n\
         [effects.gas_heat_transfer]\ntime_constant_1_s = {tau:e}\ntime_constant_2_s = {:e}\n\
         [effects.valve_transition]\nshape = \"linear\"\n{}",
        draw.between(6.5e-4, 9.5e-4),
        draw.between(3.9e6, 4.6e6),
        drop(first),
        drop(second),
        draw.between(2.6e-6, 3.6e-6),
        draw.between(2.6e-6, 3.6e-6),
        draw.between(3.3e-6, 4.3e-6),
        draw.between(0.0395, 0.0425),
        draw.between(0.0019, 0.0024),
        draw.between(1e-4, 1.3e-4),
        draw.between(1.2e9, 1.65e9),
        tau * draw.between(1.4, 2.5),
        TOLERANCE_AND_NOISE,
    );
    StrutModel::from_toml(&text, name).unwrap_or_else(|e| unreachable!("{e}"))
}

/// As the labelled campaigns state them.
const TOLERANCE_AND_NOISE: &str = "[tolerance]\nstatic_gas_volume = 0.01\nstatic_pressure = 0.01\n\
    displacement_offset_m = 2e-4\npressure_offset_Pa = 1.5e4\nforce_offset_N = 15.0\ntemperature_K = 2.0\noil_volume = 0.03\n\
    flow_coefficient = 0.02\nbulk_modulus = 0.03\ntime_constant = 0.08\n\
    [noise]\ndisplacement_m = 5e-6\nforce_N = 12.0\np1_Pa = 4e3\np2_Pa = 4e3\np3_Pa = 4e3\np4_Pa = 4e3\n";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nominal_models_are_sound_and_differ() {
        let a = nominal("a", &mut Draw::named("a"));
        let b = nominal("b", &mut Draw::named("b"));
        assert!(a.effects.oil_compressibility.is_some() && a.effects.valve_transition.is_some());
        assert_ne!(a.cylinder.oil_volume_m3, b.cylinder.oil_volume_m3);
    }
}
