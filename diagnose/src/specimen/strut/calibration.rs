//! What of a strut's model may be off within its tolerance.

use oleo_plant_sim::strut::{COLUMNS, StrutModel};

use super::channels::Layout;
use crate::parameter::Parameter;

/// What a calibration parameter changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Calibration {
    /// Static gas volume of accumulator 1 or 2 (counted from 0), relative.
    GasVolume(usize),
    /// Static pressure, as a relative deviation.
    StaticPressure,
    /// Oil volume of the main chamber, relative.
    OilVolume,
    /// Flow coefficient of valve 1, 2 or 3 (counted from 0), relative.
    FlowCoefficient(usize),
    /// Bulk modulus of the oil, relative.
    BulkModulus,
    /// Thermal time constant of accumulator 1 or 2 (counted from 0), relative.
    TimeConstant(usize),
    /// Ambient temperature, as a deviation in K.
    Temperature,
    /// Offset of `COLUMNS[i]`, in the unit of the column.
    Offset(usize),
}

impl Calibration {
    /// Puts a deviation into a model.
    pub fn apply(self, model: &mut StrutModel, value: f64) {
        let e = &mut model.effects;
        match self {
            Calibration::GasVolume(i) => model.accumulator[i].static_gas_volume_m3 *= 1.0 + value,
            Calibration::StaticPressure => model.cylinder.static_pressure_pa *= 1.0 + value,
            Calibration::OilVolume => model.cylinder.oil_volume_m3 *= 1.0 + value,
            Calibration::FlowCoefficient(i) => model.valve[i].flow_coefficient *= 1.0 + value,
            Calibration::BulkModulus => {
                e.oil_compressibility
                    .iter_mut()
                    .for_each(|o| o.bulk_modulus_pa *= 1.0 + value);
            }
            Calibration::TimeConstant(i) => e.gas_heat_transfer.iter_mut().for_each(|h| {
                let tau = if i == 0 {
                    &mut h.time_constant_1_s
                } else {
                    &mut h.time_constant_2_s
                };
                *tau *= 1.0 + value;
            }),
            Calibration::Temperature => model.gas.temperature_k += value,
            Calibration::Offset(i) => {
                *e.sensor_offset
                    .get_or_insert_default()
                    .entry(COLUMNS[i].into())
                    .or_default() += value;
            }
        }
    }
}

/// Everything that the model states a tolerance for, apart from the zeros of instruments that are not there.
#[must_use]
pub fn of(model: &StrutModel, layout: Layout) -> (Vec<Calibration>, Vec<Parameter>) {
    let tolerance = |key: &str| model.tolerance.get(key).copied().filter(|size| *size > 0.0);
    let mut out = Vec::new();
    let mut add = |what: Calibration, key: String, tolerance: Option<f64>| {
        let is_there = !matches!(what, Calibration::Offset(i) if i > 0 && !layout.has(i - 1));
        if let (Some(t), true) = (tolerance, is_there) {
            let parameter = Parameter::calibration(key, t);
            let instrument = matches!(what, Calibration::Offset(i) if i > 0);
            out.push((
                what,
                if instrument {
                    parameter.on_instrument()
                } else {
                    parameter
                },
            ));
        }
    };
    for i in 0..2 {
        add(
            Calibration::GasVolume(i),
            format!("static_gas_volume_{}", i + 1),
            tolerance("static_gas_volume"),
        );
    }
    add(
        Calibration::StaticPressure,
        "static_pressure".into(),
        tolerance("static_pressure"),
    );
    for i in 0..3 {
        add(
            Calibration::FlowCoefficient(i),
            format!("flow_coefficient_{}", i + 1),
            tolerance("flow_coefficient"),
        );
    }
    // Also where the oil is believed rigid: its volume matters as soon as it is not.
    add(Calibration::OilVolume, "oil_volume".into(), tolerance("oil_volume"));
    if model.effects.oil_compressibility.is_some() {
        add(
            Calibration::BulkModulus,
            "bulk_modulus".into(),
            tolerance("bulk_modulus"),
        );
    }
    if model.effects.gas_heat_transfer.is_some() {
        for i in 0..2 {
            add(
                Calibration::TimeConstant(i),
                format!("time_constant_{}", i + 1),
                tolerance("time_constant"),
            );
        }
    }
    // An ideal gas at ambient temperature has the same pressures at any ambient temperature.
    if model.effects.real_gas.is_some() {
        add(
            Calibration::Temperature,
            "temperature_K".into(),
            tolerance("temperature_K"),
        );
    }
    add(
        Calibration::Offset(0),
        "displacement_offset_m".into(),
        tolerance("displacement_offset_m"),
    );
    add(
        Calibration::Offset(1),
        "force_offset_N".into(),
        tolerance("force_offset_N"),
    );
    for (i, column) in COLUMNS.iter().enumerate().skip(2) {
        add(
            Calibration::Offset(i),
            format!("{column} offset"),
            tolerance("pressure_offset_Pa"),
        );
    }
    out.into_iter().unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation;
    use crate::specimen::strut::candidates::candidates;

    #[test]
    fn what_replaces_a_tolerance_replaces_one_that_the_model_can_state() {
        let mut model = StrutModel::defender110(8000.0);
        let keys =
            "static_gas_volume static_pressure flow_coefficient oil_volume bulk_modulus time_constant temperature_K";
        model.tolerance = keys.split(' ').map(|key| (key.to_owned(), 0.01)).collect();
        let (_, parameters) = of(&model, Layout::RIG);
        let all = candidates(&model, &excitation::Strut::of_everything(), Layout::RIG);
        let mut replaced: Vec<&str> = all.iter().filter_map(|c| c.replaces).collect();
        assert!(
            replaced.iter().all(|key| parameters.iter().any(|p| p.key == *key)),
            "{replaced:?}"
        );
        // The gas volumes are left: their error has a name.
        replaced.sort_unstable();
        replaced.dedup();
        assert_eq!(replaced.len() + 2, parameters.len());
    }
}
