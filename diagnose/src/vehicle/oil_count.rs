//! Whether the struts keep their oil in a drive, or lose it as the recordings' equation does.
//!
//! That equation counts oil at the density of the main chamber ([`OilCount::Chamber`]), so that a strut loses `loop area / beta` of oil with every loop in the
//! force-displacement plane: a millimetre of ride height in a minute on a rough road. A vehicle loses none, and a log of a simulator that has the equation
//! does. What a file says of it is therefore a belief like any other, and has no number to be fitted; without this decision the lost oil would be
//! called a drift of the displacement. It is decided from the pressures, by what they do over seconds: each pressure of each recording gives its
//! [share](super::share) of what the recording contains.

use std::sync::atomic::AtomicBool;

use oleo_interface::Corners;
use oleo_plant_sim::strut::{OilCount, StrutModel};

use super::share::{HALF, Share, median};
use crate::estimation::{LeastSquares, Point, fit};
use crate::specimen::strut::TwoStageStrut;
use crate::specimen::{Series, Specimen};
use crate::vocabulary::EffectId;

/// The note where files that do not say so are read as if they did.
pub const IS_KEPT: &str = "The struts keep their oil: it is counted at its static density at every corner, because the pressures do not follow the loss of oil \
                           in the equation of the files, or because the file of another corner says so. The improved files say it too (counted_at = \"static\").";

/// Length of the parts of a recording over which residuals are averaged, s: longer than what the road does, shorter than what oil takes to be lost.
const AVERAGED_S: f64 = 1.0;

/// The density at which the struts count oil, as the recordings show with the believed models. That a file counts it at the static density is a statement,
/// which is not asked.
#[must_use]
pub fn shown_by(struts: &Corners<TwoStageStrut>, believed: &Corners<StrutModel>) -> OilCount {
    let states_static = |strut: &StrutModel| counted_at(strut) == Some(OilCount::Static);
    if believed.values().any(states_static) {
        return OilCount::Static;
    }
    let corners = struts.values().zip(believed.values());
    let shares = corners
        .flat_map(|(strut, believed)| shares_of_kept(strut, believed))
        .collect();
    match median(shares) {
        Some(kept) if kept > HALF => OilCount::Static,
        _ => OilCount::Chamber,
    }
}

fn counted_at(strut: &StrutModel) -> Option<OilCount> {
    strut.effects.oil_compressibility.as_ref().map(|oil| oil.counted_at)
}

/// The share of a strut that keeps its oil in each pressure of each recording.
fn shares_of_kept(strut: &TwoStageStrut, believed: &StrutModel) -> Vec<Share> {
    let Some([losing, keeping]) = residuals(strut, believed) else {
        return vec![];
    };
    let pairs = losing.iter().zip(&keeping).zip(strut.recordings());
    pairs
        .flat_map(|((losing, keeping), recording)| {
            let samples = super::bridge::samples_in(AVERAGED_S, recording.interval_s());
            let of_channel = move |(a, b): (&Vec<f64>, &Vec<f64>)| Share::of(slow(a, b, samples));
            losing.iter().zip(keeping).filter_map(of_channel)
        })
        .collect()
}

/// What was read less what the believed model makes of it with oil that is lost and that is kept. What looks like oil that is lost is fitted first:
///
/// - The beginning in the middle of a drive. Gas that was warm at the first sample cools, and its pressure falls.
/// - Heat of the gas that the file leaves out, where the drives show it: the mean pressure moves for as long as the gas takes to be as warm as the road makes it.
///
/// Rigid oil counts alike at either density, so that oil that yields is added to it.
fn residuals(strut: &TwoStageStrut, believed: &StrutModel) -> Option<[Vec<Series>; 2]> {
    let is_rigid = counted_at(believed).is_none();
    let yields = is_rigid.then_some(EffectId::OilCompressibility);
    let warms = (believed.effects.gas_heat_transfer.is_none()).then_some(EffectId::GasHeatTransfer);
    if yields.is_none() && warms.is_none() && !strut.begins_in_motion() {
        return both(|count| strut.residuals_of(&counting_at(count, believed.clone())));
    }
    let with = |added: Vec<EffectId>| {
        let fitted = both(|count| fitted(strut, counting_at(count, believed.clone()), count, &added))?;
        let cost = fitted.iter().map(|(cost, _)| cost).sum::<f64>();
        Some((cost, fitted.map(|(_, residuals)| residuals)))
    };
    let as_believed = with(yields.into_iter().collect());
    let with_heat = warms.and_then(|warms| with(yields.into_iter().chain([warms]).collect()));
    let either = as_believed.into_iter().chain(with_heat);
    either
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, residuals)| residuals)
}

/// The same of oil that is lost and of oil that is kept.
fn both<T>(of: impl Fn(OilCount) -> Option<T>) -> Option<[T; 2]> {
    Some([of(OilCount::Chamber)?, of(OilCount::Static)?])
}

/// Cost and residuals of a model with these effects added, fitted.
fn fitted(strut: &TwoStageStrut, model: StrutModel, count: OilCount, added: &[EffectId]) -> Option<(f64, Vec<Series>)> {
    let mut strut = strut.believing(model).ok()?;
    strut.count_found_oil_at(count);
    let mut start = Point::nominal(&strut);
    for id in added {
        let candidates = strut.candidates();
        let effect = candidates.iter().position(|candidate| candidate.id == *id)?;
        let values: Vec<f64> = (candidates[effect].parameters.iter())
            .map(|parameter| if parameter.is_size { 0.0 } else { parameter.start })
            .collect();
        start = start.with_effect(&strut, effect, &values);
    }
    let never = AtomicBool::new(false);
    let problem = LeastSquares::new(&strut, &never);
    let fitted = fit(&problem, start, problem.criteria.fitting.quick).ok()?;
    let residuals = strut.residuals(&fitted.point.hypothesis(&strut))?;
    Some((fitted.cost, residuals))
}

/// A strut whose oil, if it is compressible, is counted at a density.
fn counting_at(count: OilCount, mut strut: StrutModel) -> StrutModel {
    if let Some(oil) = &mut strut.effects.oil_compressibility {
        oil.counted_at = count;
    }
    strut
}

/// The struts with their oil counted at a density, where it is compressible.
#[must_use]
pub fn with_oil_counted_at(count: OilCount, struts: &Corners<StrutModel>) -> Corners<StrutModel> {
    struts.each_ref().map(|strut| counting_at(count, strut.clone()))
}

/// Both residuals, averaged over so many samples, about their mean: an offset of a pressure or of the displacement is no loss. Parts of which less than half
/// was recorded do not count.
fn slow(first: &[f64], second: &[f64], samples: usize) -> Vec<[f64; 2]> {
    let parts = first.chunks(samples).zip(second.chunks(samples));
    let mut means: Vec<[f64; 2]> = parts
        .filter_map(|(first, second)| {
            let recorded = || first.iter().zip(second).filter(|(first, _)| **first != 0.0);
            let count = recorded().count();
            (2 * count > samples).then(|| mean(recorded().map(|(first, second)| [*first, *second]), count))
        })
        .collect();
    let middle = mean(means.iter().copied(), means.len());
    for of_part in &mut means {
        *of_part = [of_part[0] - middle[0], of_part[1] - middle[1]];
    }
    means
}

fn mean(values: impl Iterator<Item = [f64; 2]>, count: usize) -> [f64; 2] {
    let sum = values.fold([0.0; 2], |sum, value| [sum[0] + value[0], sum[1] + value[1]]);
    sum.map(|sum| sum / count.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::{StrutPressures, StrutValves};
    use oleo_plant_sim::strut::{Inputs, OilCompressibility, replay};

    use crate::recording::Recording;

    /// A drive of 20 s with all valves closed, as a strut reads it: swings of 30 mm, 1.2 times a second, that begin and end softly.
    fn driven(truth: &StrutModel) -> Recording {
        let time_s: Vec<f64> = (0..4000).map(|k| 0.005 * f64::from(k)).collect();
        let swing = |t: &f64| {
            0.03 * libm::sin(std::f64::consts::PI * t / 20.0) * libm::sin(2.0 * std::f64::consts::PI * 1.2 * t)
        };
        let displacement_m: Vec<f64> = time_s.iter().map(swing).collect();
        let signals = vec![StrutValves::splat(false); time_s.len()];
        let inputs = Inputs::from_recording(&time_s, &displacement_m, &signals, 1e-6);
        let prediction = replay(truth, &inputs).expect("a simulation");
        let closed = std::iter::repeat_with(|| vec![0.0; time_s.len()]).take(3);
        let columns = std::iter::once(displacement_m)
            .chain(prediction.pressure_pa)
            .chain(closed);
        Recording {
            name: "swings".into(),
            columns: columns.collect(),
            time_s,
            notes: vec![],
        }
    }

    #[test]
    fn the_oil_of_files_that_have_it_rigid_is_kept_or_lost_as_it_is() {
        let mut rigid = StrutModel::defender110(6000.0);
        rigid.effects.oil_compressibility = None;
        rigid.noise = [("displacement_m", 5e-6), ("force_N", 12.0)]
            .into_iter()
            .chain(["p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"].map(|pressure| (pressure, 4e3)))
            .map(|(column, noise)| (column.to_owned(), noise))
            .collect();
        // Ordinary oil, and one that is thirty times as stiff: of that little is lost, and yet more than the readings' noise.
        let moduli_pa = [1.5e9, 50e9].into_iter();
        let oils = moduli_pa.flat_map(|pa| [(pa, OilCount::Chamber), (pa, OilCount::Static)]);
        for (bulk_modulus_pa, counted_at) in oils {
            let mut truth = rigid.clone();
            truth.effects.oil_compressibility = Some(OilCompressibility {
                bulk_modulus_pa,
                counted_at,
            });
            let recording = driven(&truth);
            let struts = Corners::from_fn(|_| {
                let no_steps = StrutPressures::splat(0.0);
                TwoStageStrut::in_vehicle(rigid.clone(), vec![recording.clone()], no_steps, true).expect("a strut")
            });
            let believed = Corners::from_fn(|_| rigid.clone());
            assert_eq!(shown_by(&struts, &believed), counted_at, "{bulk_modulus_pa} Pa");
        }
    }

    #[test]
    fn an_offset_is_no_loss() {
        // The second simulation loses 10 Pa a sample, and what was recorded does not; both are off by 700 Pa, and a road makes 50 Pa.
        let road = |k: usize| if k.is_multiple_of(2) { 50.0 } else { -50.0 };
        let first: Vec<f64> = (0..40).map(|k| 700.0 + road(k)).collect();
        let second: Vec<f64> = (0..40).map(|k| 700.0 + road(k) + 10.0 * k as f64).collect();
        let kept = |first: &[f64], second: &[f64]| median(Share::of(slow(first, second, 4)).into_iter().collect());
        assert_eq!((kept(&first, &second), kept(&second, &first)), (Some(0.0), Some(1.0)));
    }

    #[test]
    fn what_was_not_recorded_does_not_count() {
        let mut first: Vec<f64> = (0..12).map(f64::from).collect();
        let second = first.clone();
        // The first sample of the first part, and three of four of the second part.
        first[4..7].fill(0.0);
        let slow = slow(&first, &second, 4);
        // Of 1, 2, 3 and of 8 to 11.
        assert_eq!(slow, [[-3.75; 2], [3.75; 2]]);
    }
}
