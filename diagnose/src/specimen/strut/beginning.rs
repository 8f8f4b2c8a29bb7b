//! Recordings that begin in the middle of a drive: what is not known of the strut then, and is fitted.
//!
//! Volume and temperature of the gas in both accumulators are unknown. Fitted are its pressure and temperature, from which the volume
//! follows: the pressure is nearly what was read, and does not change with an error of the charge, as the volume would. Since no oil was lost, the
//! temperatures are tied: the displacement says what volume both gases have together.

use oleo_plant_sim::strut::{ATMOSPHERE_PA, Beginning, Effects, InMotion, StrutModel, true_first_value};

use super::channels::{CHANNELS, Layout, P1, P2, P3, P4};
use crate::parameter::Parameter;
use crate::recording::Recording;
use crate::vocabulary::Branch;

/// Readings of this time do not count, s: a valve may be moving when the recording begins, which takes 90 ms at most.
const UNCOUNTED_S: f64 = 0.1;
/// How far the gas pressure is usually from what was read first, relative: twice its standard deviation. And how far it may be.
const PRESSURE_WITHIN: (f64, f64) = (0.03, 0.06);
/// The same of the temperature of gas 1 and what both volumes say of it if they are equally warm, K.
const FIRST_WITHIN_K: (f64, f64) = (40.0, 90.0);
/// The same of the temperature of gas 2 and what its volume says of it, K.
const SECOND_WITHIN_K: (f64, f64) = (6.0, 30.0);
/// The volume of the oil says no more than this of the temperature, relative to ambient: what it says beyond is an error of an instrument.
const MOST_FROM_AMBIENT: f64 = 0.2;

/// Something that is not known of the beginning of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unknown {
    recording: usize,
    branch: Branch,
    quantity: Quantity,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quantity {
    /// Gas pressure, relative to the absolute pressure that was read.
    Pressure,
    /// Gas temperature beyond what the volume of the oil says, K; that of accumulator 2 given that of accumulator 1.
    Temperature,
}

/// Lets a recording begin at the first sample that holds the pressures of the chamber and of both accumulators: a pressure that was read a sample later
/// may be a tenth of itself away.
pub fn from_first_complete_sample(recording: &mut Recording, layout: Layout) {
    let has_all = |k: usize| {
        [P1, P2, P4]
            .iter()
            .all(|&c| recording.columns[layout.column(c)][k].is_finite())
    };
    let Some(first) = (0..recording.len()).find(|&k| has_all(k)) else {
        return;
    };
    recording.time_s.drain(..first);
    recording
        .columns
        .iter_mut()
        .for_each(|column| drop(column.drain(..first)));
}

/// What the first readings say: the oil has the pressures that were read. Both gases are as much warmer than ambient as they must be to leave
/// the oil the volume that the believed model has for it at this displacement. `None` where no sample is complete.
pub fn as_read(model: &StrutModel, recording: &Recording, layout: Layout) -> Option<Beginning> {
    let first = |channel: usize| {
        let reading = recording.columns[layout.column(channel)].first().copied();
        reading.filter(|v| v.is_finite())
    };
    let (chamber_pa, gas_pa) = (first(P1)?, [first(P2)?, first(P4)?]);
    let static_pa = model.cylinder.static_pressure_pa;
    let static_m3 = [0, 1].map(|i| model.accumulator[i].static_gas_volume_m3);
    let at_ambient = [0, 1].map(|i| static_m3[i] * (static_pa + ATMOSPHERE_PA) / (gas_pa[i] + ATMOSPHERE_PA));
    let compressed_m3 = model.effects.oil_compressibility.as_ref().map_or(0.0, |oil| {
        model.cylinder.oil_volume_m3 * (chamber_pa - static_pa) / oil.bulk_modulus_pa
    });
    let pushed_in_m3 = model.piston_area_m2() * recording.columns[0].first()? - compressed_m3;
    let warmer = (static_m3[0] + static_m3[1] - pushed_in_m3) / (at_ambient[0] + at_ambient[1]) - 1.0;
    Some(Beginning::InMotion(InMotion {
        chamber_pa,
        gas_pa,
        first_above_ambient_k: model.gas.temperature_k * warmer.clamp(-MOST_FROM_AMBIENT, MOST_FROM_AMBIENT),
        second_beyond_k: 0.0,
    }))
}

/// The pressures behind the readings with which a recording begins, where instruments have these faults.
pub fn behind_readings(begins: Beginning, effects: &Effects) -> Beginning {
    let Beginning::InMotion(read) = begins else {
        return begins;
    };
    let truth = |channel: usize, reading: f64| {
        let pa = true_first_value(effects, CHANNELS[channel], reading);
        if pa.is_finite() { pa } else { reading }
    };
    let [gas_1, gas_2] = read.gas_pa;
    Beginning::InMotion(InMotion {
        chamber_pa: truth(P1, read.chamber_pa),
        gas_pa: [truth(P2, gas_1), truth(P4, gas_2)],
        ..read
    })
}

/// Takes out the pressures that a moving valve may have changed. The first reading of each accumulator stays: without it only the sum of both
/// gas volumes could be told.
pub fn without_first_readings(recording: &mut Recording, layout: Layout) {
    let uncounted = 1 + (UNCOUNTED_S / recording.interval_s()) as usize;
    for channel in [P1, P2, P3, P4] {
        let column = &mut recording.columns[layout.column(channel)];
        let end = uncounted.min(column.len());
        let kept = usize::from(matches!(channel, P2 | P4));
        column[kept.min(end)..end].fill(f64::NAN);
    }
}

/// What is not known of these recordings, with its parameters.
pub fn unknowns(recordings: &[Recording]) -> (Vec<Unknown>, Vec<Parameter>) {
    let of = |(recording, named): (usize, &Recording)| {
        let name = named.name.clone();
        Branch::ALL.into_iter().flat_map(move |branch| {
            let number = branch.number();
            let unknown = |quantity| Unknown {
                recording,
                branch,
                quantity,
            };
            let pressure = format!("gas_pressure_{number} at the beginning of {name}");
            let temperature_within_k = match branch {
                Branch::First => FIRST_WITHIN_K,
                Branch::Second => SECOND_WITHIN_K,
            };
            let temperature = format!("gas_temperature_{number}_K at the beginning of {name}");
            [
                (unknown(Quantity::Pressure), within(pressure, PRESSURE_WITHIN)),
                (
                    unknown(Quantity::Temperature),
                    within(temperature, temperature_within_k),
                ),
            ]
        })
    };
    recordings.iter().enumerate().flat_map(of).unzip()
}

/// A deviation that is usually within a tolerance, and may be larger.
fn within(key: String, (usual, most): (f64, f64)) -> Parameter {
    Parameter {
        lower: -most,
        upper: most,
        ..Parameter::calibration(key, usual)
    }
}

impl Unknown {
    /// Puts a deviation into the beginning of a recording, if it is of that one.
    pub fn apply(self, recording: usize, begins: &mut Beginning, value: f64) {
        if let Beginning::InMotion(in_motion) = begins
            && recording == self.recording
        {
            match (self.quantity, self.branch) {
                (Quantity::Pressure, branch) => {
                    let pressure_pa = &mut in_motion.gas_pa[branch.number() - 1];
                    *pressure_pa += value * (*pressure_pa + ATMOSPHERE_PA);
                }
                (Quantity::Temperature, Branch::First) => in_motion.first_above_ambient_k += value,
                (Quantity::Temperature, Branch::Second) => in_motion.second_beyond_k += value,
            }
        }
    }
}
