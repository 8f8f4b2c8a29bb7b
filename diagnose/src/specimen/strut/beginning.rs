//! Recordings that begin in the middle of a drive: what is not known of the strut then, and is fitted.
//!
//! Volume and temperature of the gas in both accumulators are unknown. Fitted are the pressures, which are nearly what was read, and do not change with
//! an error of the charge, as volumes would; the volume of both together, which the displacement says as long as no oil is lost; and one temperature. Where the
//! dampers fade, it is unknown too for how long they have been heated, and in what proportion: before, oil may have taken the other path. Where floating
//! pistons rub, the gas has another pressure than the oil, by what the sheared seal holds back.

use oleo_plant_sim::strut::{ATMOSPHERE_PA, Beginning, Effects, InMotion, StrutModel, true_first_value};

use super::channels::{CHANNELS, Layout, P1, P2, P3, P4};
use super::heating;
use crate::median::median;
use crate::parameter::{Beside, Parameter, Scale};
use crate::recording::Recording;
use crate::vocabulary::{Branch, EffectId, Site};

/// A valve has moved after this time, s: it takes 90 ms at most.
const MOVED_S: f64 = 0.1;
/// So long a recording may wait until its valves stand still, s.
const WAITS_S: f64 = 3.0;
/// Part of its median that the absolute pressure of the chamber has at least where a recording begins.
const FILLED: f64 = 0.5;
/// How far the gas pressure is usually from what was read first, relative: twice its standard deviation. And how far it may be.
const PRESSURE_WITHIN: (f64, f64) = (0.03, 0.06);
/// The same of the volume of both gases together and what the displacement says of it, relative. A strut that has turned 20 kJ into heat, which takes a
/// minute at 350 W, has lost 1.4e-5 m3 of oil by the recordings' equation: 3 % of its gas.
const VOLUME_WITHIN: (f64, f64) = (0.06, 0.3);
/// The same of the temperature of gas 1 and that which both have if they are equally warm, K.
const TEMPERATURE_WITHIN_K: (f64, f64) = (40.0, 250.0);
/// The time for which dampers have been heated, s: usually; the factor that is its standard deviation, as a logarithm; and how short and long it may be.
const HEATED_USUALLY_S: f64 = 60.0;
const HEATED_FACTOR: f64 = 1.5;
const HEATED_WITHIN_S: (f64, f64) = (0.1, 36e3);
/// The mean power of damper 2 before the recording over that in it, with damper 1 as it is: the factor that is its standard deviation, as a logarithm; and how small
/// and large it may be.
const SECOND_POWER_FACTOR: f64 = 1.0;
const SECOND_POWER_WITHIN: (f64, f64) = (0.05, 20.0);

/// The shear of a piston's seal: twice its standard deviation, if it is anything between its ends; and how large it may be.
const SHEAR_WITHIN: (f64, f64) = (1.2, 1.0);

/// Something that is not known of the beginning of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unknown {
    recording: usize,
    quantity: Quantity,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quantity {
    /// Pressure of an accumulator, relative to the absolute pressure that was read.
    Pressure(Branch),
    /// Volume of both gases beyond what the displacement says, relative.
    Volume,
    /// Temperature of gas 1 beyond that which both have if they are equally warm, K.
    Temperature,
    /// Time for which dampers have been heated as they are in the recording, s.
    Heated,
    /// Mean power of damper 2 before the recording, relative to that in it.
    SecondPower,
    /// Shear of the seal of a floating piston.
    Shear(Branch),
}

impl Quantity {
    const ALL: [Self; 8] = [
        Self::Pressure(Branch::First),
        Self::Pressure(Branch::Second),
        Self::Volume,
        Self::Temperature,
        Self::Heated,
        Self::SecondPower,
        Self::Shear(Branch::First),
        Self::Shear(Branch::Second),
    ];

    /// Its parameter in a recording of this name.
    fn parameter(self, recording: &str) -> Parameter {
        let key = |key: &str| format!("{key} at the beginning of {recording}");
        let beside_nothing = |name: &str, (usual, most): (f64, f64)| Parameter {
            lower: -most,
            upper: most,
            ..Parameter::calibration(key(name), usual)
        };
        match self {
            Self::Pressure(Branch::First) => beside_nothing("gas_pressure_1", PRESSURE_WITHIN),
            Self::Pressure(Branch::Second) => beside_nothing("gas_pressure_2", PRESSURE_WITHIN),
            Self::Volume => beside_nothing("gas_volume", VOLUME_WITHIN),
            Self::Temperature => beside_nothing("gas_temperature_1_K", TEMPERATURE_WITHIN_K),
            Self::Heated => Parameter {
                scale: Scale::Log(HEATED_FACTOR),
                prior: true,
                ..Parameter::log(key("dampers_heated_s"), HEATED_USUALLY_S, HEATED_WITHIN_S)
            },
            Self::SecondPower => Parameter {
                scale: Scale::Log(SECOND_POWER_FACTOR),
                prior: true,
                ..Parameter::log(key("damper_2_power"), 1.0, SECOND_POWER_WITHIN)
            },
            Self::Shear(Branch::First) => beside_nothing("piston_seal_shear_1", SHEAR_WITHIN),
            Self::Shear(Branch::Second) => beside_nothing("piston_seal_shear_2", SHEAR_WITHIN),
        }
    }
}

/// Lets a recording begin at the first sample that holds the displacement and the pressures of the chamber and of both accumulators: a pressure that was
/// read a sample later may be a tenth of itself away. Near vacuum, where an error of the pressure is a large volume of bubbles, it does not begin; and if it
/// can wait, it does not while a valve may be moving, because which accumulator takes the oil is unknown then. Returns how much is cut off, s.
pub fn from_first_complete_sample(recording: &mut Recording, layout: Layout) -> f64 {
    let chamber_pa = &recording.columns[layout.column(P1)];
    let read_pa: Vec<f64> = chamber_pa.iter().copied().filter(|pa| pa.is_finite()).collect();
    let usual_pa = median(read_pa) + ATMOSPHERE_PA;
    let has_all = |k: usize| {
        let read = |column: usize| recording.columns[column][k].is_finite();
        read(0) && [P1, P2, P4].iter().all(|&c| read(layout.column(c)))
    };
    let is_filled = |k: usize| chamber_pa[k] + ATMOSPHERE_PA > FILLED * usual_pa;
    let steps = |time_s: f64| (time_s / recording.interval_s()).ceil() as usize;
    let (moved, waits) = (steps(MOVED_S), steps(WAITS_S));
    let stand_still = |k: &usize| {
        let mut signals = recording.columns[layout.valves()..].iter();
        *k >= moved && signals.all(|signal| is_constant(&signal[k - moved..=*k]))
    };
    let complete = (0..recording.len()).filter(|&k| has_all(k));
    let filled = complete.clone().filter(|&k| is_filled(k));
    let settled = filled.clone().take_while(|&k| k <= waits).find(stand_still);
    let Some(first) = settled
        .or_else(|| filled.clone().next())
        .or_else(|| complete.clone().next())
    else {
        return 0.0;
    };
    let cut_s = recording.time_s[first] - recording.time_s[0];
    recording.time_s.drain(..first);
    recording
        .columns
        .iter_mut()
        .for_each(|column| drop(column.drain(..first)));
    cut_s
}

/// Whether all that was read of a signal is the same.
fn is_constant(signal: &[f64]) -> bool {
    let mut read = signal.iter().filter(|v| v.is_finite());
    let first = read.next();
    read.all(|v| Some(v) == first)
}

/// What the first readings say: the oil has the pressures that were read, and both gases are equally warm. `None` where no sample is complete.
/// The dampers have been heated as they are in the recording.
pub fn as_read(recording: &Recording, layout: Layout, model: &StrutModel) -> Option<Beginning> {
    let first = |channel: usize| {
        let reading = recording.columns[layout.column(channel)].first().copied();
        reading.filter(|v| v.is_finite())
    };
    Some(Beginning::InMotion(InMotion {
        chamber_pa: first(P1)?,
        accumulator_pa: [first(P2)?, first(P4)?],
        heating_w: heating::of_dampers_w(recording, layout, model),
        heated_s: HEATED_USUALLY_S,
        ..InMotion::default()
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
    let [first, second] = read.accumulator_pa;
    Beginning::InMotion(InMotion {
        chamber_pa: truth(P1, read.chamber_pa),
        accumulator_pa: [truth(P2, first), truth(P4, second)],
        ..read
    })
}

/// Takes out the pressures that a moving valve may have changed. The first reading of each accumulator stays: without it only the sum of both
/// gas volumes could be told.
pub fn without_first_readings(recording: &mut Recording, layout: Layout) {
    let uncounted = 1 + (MOVED_S / recording.interval_s()) as usize;
    for channel in [P1, P2, P3, P4] {
        let column = &mut recording.columns[layout.column(channel)];
        let end = uncounted.min(column.len());
        let kept = usize::from(matches!(channel, P2 | P4));
        column[kept.min(end)..end].fill(f64::NAN);
    }
}

/// What is not known of these recordings, with its parameters.
pub fn unknowns(recordings: &[Recording], model: &StrutModel) -> (Vec<Unknown>, Vec<Parameter>) {
    let fade = model.effects.damping_fade.as_ref();
    let rubs = model.effects.accumulator_piston_friction.as_ref();
    let heat_transfer_is_sought = model.effects.gas_heat_transfer.is_none();
    let beside = |is_sought: bool, effect: EffectId| is_sought.then_some(Beside::anywhere(effect));
    let only_beside = |quantity: Quantity| match quantity {
        Quantity::Pressure(_) => None,
        // Gas that is believed to stay at ambient temperature has the volume that follows from its pressure.
        Quantity::Volume | Quantity::Temperature => beside(heat_transfer_is_sought, EffectId::GasHeatTransfer),
        Quantity::Heated => beside(fade.is_none(), EffectId::DampingFade),
        // Where damper 2 alone fades, the time that it has been heated for says it all.
        Quantity::SecondPower => fade.is_none().then_some(Beside {
            effect: EffectId::DampingFade,
            site: Some(Site::Paths),
        }),
        Quantity::Shear(branch) => rubs.is_none().then_some(Beside {
            effect: EffectId::AccumulatorPistonFriction,
            site: Some(Site::Accumulator(branch)),
        }),
    };
    let both_fade = fade.is_none_or(|fade| fade.fade_1_per_j > 0.0 && fade.fade_2_per_j > 0.0);
    let mut quantities = Quantity::ALL.to_vec();
    quantities.retain(|quantity| match quantity {
        Quantity::SecondPower => both_fade,
        Quantity::Shear(branch) => {
            rubs.is_none_or(|rubs| [rubs.pressure_1_pa, rubs.pressure_2_pa][branch.number() - 1] > 0.0)
        }
        _ => true,
    });
    let (mut unknowns, mut parameters) = (Vec::new(), Vec::new());
    for (recording, named) in recordings.iter().enumerate() {
        for &quantity in &quantities {
            unknowns.push(Unknown { recording, quantity });
            parameters.push(Parameter {
                only_in: Some(recording),
                only_beside: only_beside(quantity),
                ..quantity.parameter(&named.name)
            });
        }
    }
    (unknowns, parameters)
}

impl Unknown {
    /// Puts a deviation into the beginning of a recording, if it is of that one.
    pub fn apply(self, recording: usize, begins: &mut Beginning, value: f64) {
        if let Beginning::InMotion(in_motion) = begins
            && recording == self.recording
        {
            match self.quantity {
                Quantity::Pressure(branch) => {
                    let pressure_pa = &mut in_motion.accumulator_pa[branch.number() - 1];
                    *pressure_pa += value * (*pressure_pa + ATMOSPHERE_PA);
                }
                Quantity::Volume => in_motion.volume_beyond += value,
                Quantity::Temperature => in_motion.first_beyond_k += value,
                Quantity::Heated => in_motion.heated_s = value,
                Quantity::SecondPower => in_motion.heating_w[1] *= value,
                Quantity::Shear(branch) => in_motion.seal_shear[branch.number() - 1] = value,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_plant_sim::strut::{AccumulatorPistonFriction, DampingFade};

    const NONE: f64 = f64::NAN;

    fn model() -> StrutModel {
        StrutModel::defender110(6000.0)
    }

    /// Displacement, p1 to p4 and three signals, every 50 ms.
    fn recording() -> Recording {
        let mut columns = vec![vec![0.00, 0.01, 0.02, 0.03, 0.04]];
        columns.push(vec![1e6, 2e6, 3e6, 4e6, 5e6]);
        columns.push(vec![NONE, 2.1e6, 3.1e6, 4.1e6, 5.1e6]);
        columns.push(vec![1.2e6, NONE, 3.2e6, 4.2e6, 5.2e6]);
        columns.push(vec![1.3e6, 2.3e6, 3.3e6, 4.3e6, 5.3e6]);
        columns.extend([vec![0.0; 5], vec![1.0; 5], vec![0.0; 5]]);
        Recording {
            name: "a".into(),
            time_s: (0..5).map(|k| 0.05 * f64::from(k)).collect(),
            columns,
            notes: vec![],
        }
    }

    #[test]
    fn a_recording_begins_where_three_pressures_are_read_at_once() {
        let mut recording = recording();
        let valve = Layout::VEHICLE.valves();
        recording.columns[valve] = vec![0.0, 1.0, 0.0, 1.0, 0.0];
        assert_eq!(from_first_complete_sample(&mut recording, Layout::VEHICLE), 0.05);
        assert_eq!(
            (recording.time_s[0], recording.columns[0][0], recording.len()),
            (0.05, 0.01, 4)
        );
        let Some(Beginning::InMotion(read)) = as_read(&recording, Layout::VEHICLE, &model()) else {
            panic!("it begins in motion");
        };
        assert_eq!((read.chamber_pa, read.accumulator_pa), (2e6, [2.1e6, 2.3e6]));
        // Three samples are within 0.1 s; the accumulators keep their first reading.
        without_first_readings(&mut recording, Layout::VEHICLE);
        let counted = [1, 2, 3, 4].map(|c| recording.columns[c].iter().filter(|p| p.is_finite()).count());
        assert_eq!(counted, [1, 2, 1, 2]);
        assert!(recording.columns[2][0].is_finite() && recording.columns[4][0].is_finite());
        assert_eq!(recording.columns[6], [1.0; 4]);
    }

    #[test]
    fn a_recording_begins_where_valves_stand_still_the_chamber_is_filled_and_the_displacement_is_read() {
        let begins_at = |change: &dyn Fn(&mut Recording)| {
            let mut recording = recording();
            change(&mut recording);
            from_first_complete_sample(&mut recording, Layout::VEHICLE);
            5 - recording.len()
        };
        let valve = Layout::VEHICLE.valves();
        assert_eq!(begins_at(&|_| {}), 2, "the valves have had a tenth of a second");
        assert_eq!(begins_at(&|r| r.columns[valve][2] = NONE), 2);
        assert_eq!(begins_at(&|r| r.columns[valve][0] = 1.0), 3);
        assert_eq!(begins_at(&|r| r.columns[valve][3] = 1.0), 2);
        assert_eq!(
            begins_at(&|r| r.columns[valve] = vec![0.0, 1.0, 0.0, 1.0, 0.0]),
            1,
            "they never stand still"
        );
        assert_eq!(begins_at(&|r| r.columns[1][2] = -8e4), 3);
        assert_eq!(begins_at(&|r| r.columns[0][2] = NONE), 3);
        assert_eq!(begins_at(&|r| r.columns[1][1..].fill(-1.2e5)), 1, "it is never filled");
    }

    #[test]
    fn a_pressure_is_that_behind_the_instrument_of_the_hypothesis() {
        let read = as_read(&recording(), Layout::VEHICLE, &model());
        assert_eq!(read, None);
        let begins = Beginning::InMotion(InMotion {
            chamber_pa: 4e6,
            accumulator_pa: [4e6, 4e6],
            ..InMotion::default()
        });
        let mut effects = Effects::default();
        effects.sensor_gain.get_or_insert_default().insert("p2_Pa".into(), -0.2);
        effects
            .sensor_offset
            .get_or_insert_default()
            .insert("p4_Pa".into(), 1e5);
        let Beginning::InMotion(behind) = behind_readings(begins, &effects) else {
            panic!("it begins in motion");
        };
        assert_eq!((behind.chamber_pa, behind.accumulator_pa), (4e6, [5e6, 3.9e6]));
        assert_eq!(behind_readings(Beginning::AtRest, &effects), Beginning::AtRest);
    }

    #[test]
    fn the_power_of_damper_2_is_unknown_beside_the_fade_of_both_dampers() {
        let power = |fades: Option<[f64; 2]>| {
            let mut model = model();
            model.effects.damping_fade = fades.map(|[fade_1_per_j, fade_2_per_j]| DampingFade {
                fade_1_per_j,
                fade_2_per_j,
                cooling_time_s: 60.0,
            });
            let (_, all) = unknowns(&[recording()], &model);
            all.into_iter().find(|p| p.key.starts_with("damper_2_power"))
        };
        let sought = power(None).and_then(|p| p.only_beside);
        assert_eq!(sought.and_then(|beside| beside.site), Some(Site::Paths));
        assert_eq!(power(Some([1e-5, 1e-5])).map(|p| p.only_beside), Some(None));
        assert!(power(Some([0.0, 1e-5])).is_none() && power(Some([1e-5, 0.0])).is_none());
    }

    #[test]
    fn the_shear_of_a_seal_is_unknown_where_its_piston_rubs() {
        let shears = |rub: Option<[f64; 2]>| {
            let mut model = model();
            model.effects.accumulator_piston_friction =
                rub.map(|[pressure_1_pa, pressure_2_pa]| AccumulatorPistonFriction {
                    pressure_1_pa,
                    pressure_2_pa,
                    presliding_volume_m3: 1e-7,
                });
            let (_, mut all) = unknowns(&[recording()], &model);
            all.retain(|p| p.key.starts_with("piston_seal_shear"));
            all
        };
        let sites: Vec<_> = (shears(None).into_iter())
            .map(|p| p.only_beside.and_then(|beside| beside.site))
            .collect();
        assert_eq!(sites, Branch::ALL.map(|branch| Some(Site::Accumulator(branch))));
        let [second] = shears(Some([0.0, 1e5])).try_into().expect("of one piston");
        assert_eq!(
            (second.key.as_str(), second.only_beside),
            ("piston_seal_shear_2 at the beginning of a", None)
        );
    }

    #[test]
    fn a_deviation_is_of_one_recording_and_one_quantity() {
        let (unknowns, parameters) = unknowns(&[recording(), recording()], &model());
        assert_eq!((unknowns.len(), parameters.len()), (16, 16));
        assert_eq!(parameters[1].key, "gas_pressure_2 at the beginning of a");
        let mut begins = Beginning::InMotion(InMotion {
            chamber_pa: 4e6,
            accumulator_pa: [4e6, 4e6],
            heating_w: [300.0, 200.0],
            ..InMotion::default()
        });
        let before = begins;
        unknowns[8].apply(0, &mut begins, 0.01);
        assert_eq!(begins, before);
        for unknown in &unknowns[..8] {
            unknown.apply(0, &mut begins, 0.01);
        }
        let pa = 4e6 + 0.01 * (4e6 + ATMOSPHERE_PA);
        let moved = InMotion {
            chamber_pa: 4e6,
            accumulator_pa: [pa, pa],
            first_beyond_k: 0.01,
            volume_beyond: 0.01,
            heating_w: [300.0, 2.0],
            heated_s: 0.01,
            seal_shear: [0.01; 2],
        };
        assert_eq!(begins, Beginning::InMotion(moved));
    }
}
