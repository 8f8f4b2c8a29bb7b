//! A strut in a vehicle: what its recordings leave unknown is noise of the samples that it touches.

use oleo_interface::StrutPressures;
use oleo_plant_sim::strut::{Beginning, Inputs, OilCount, Replay, StrutModel, replay_all, smooth_free_motion};
use rayon::prelude::*;

use super::channels::Layout;
use super::unknown_motion::{Counted, Unknown, UnknownMotion};
use super::{TwoStageStrut, beginning, displacement_noise, finite_channels, floor, stated_noise, unread};
use crate::instrument::Examined;
use crate::recording::Recording;
use crate::specimen::channel::Series;
use crate::specimen::contract::Specimen;
use crate::specimen::hypothesis::Hypothesis;

impl TwoStageStrut {
    /// A strut in a vehicle, whose recordings hold no force: displacement, p1 to p4, and the three switching signals. A pressure
    /// that was not received is NaN and does not count.
    ///
    /// Between two samples of 5 ms a wheel moves in a way that is not recorded, and the dampers turn what is not known of its speed
    /// into pressure. This is noise of p1 and p3 as the sensor's is, and is added to it: its size is the difference that
    /// motions make which the readings cannot tell apart. A displacement or a switching signal that was not received is NaN, and what it leaves unknown counts in the
    /// same way.
    ///
    /// `rounded_to_pa` are the steps in which the pressures were logged, 0 where they were not rounded; the noise of the model includes the rounding. Noise
    /// that is smaller than the model states is measured and used, and readings that stand still, whose rounding is one error, count as one.
    ///
    /// A recording that does not begin at rest begins with the pressures that were read first ([`Self::let_begin_in_motion`] cuts it); volume and temperature of
    /// the gas are then part of every fit, and the readings of the first tenth of a second do not count.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn in_vehicle(
        model: StrutModel,
        mut recordings: Vec<Recording>,
        rounded_to_pa: StrutPressures<f64>,
        starts_at_rest: bool,
    ) -> Result<Self, String> {
        let mut begins = vec![Beginning::AtRest; recordings.len()];
        if !starts_at_rest {
            for (begins, recording) in begins.iter_mut().zip(&mut recordings) {
                *begins = beginning::as_read(recording, Layout::VEHICLE, &model).unwrap_or_default();
                beginning::without_first_readings(recording, Layout::VEHICLE);
            }
        }
        let (mut inputs, mut unread) = (Vec::new(), Vec::new());
        for r in &mut recordings {
            let signals = unread::fill_signals(r, Layout::VEHICLE);
            let motion = smooth_free_motion(&r.columns[0], r.interval_s(), displacement_noise(&model));
            let best = Inputs {
                time_s: r.time_s.clone(),
                motion: motion.best,
                signals: Layout::VEHICLE.signals(r),
            };
            unread::fill_displacement(&mut r.columns[0], &best);
            unread.push(Unread {
                motions: (motion.possible.into_iter())
                    .map(|motion| Inputs { motion, ..best.clone() })
                    .collect(),
                signals: (signals.into_iter().flatten())
                    .map(|signals| Inputs {
                        signals,
                        ..best.clone()
                    })
                    .collect(),
            });
            inputs.push(best);
        }
        let mut strut = Self::with_layout(model, recordings, inputs, begins, Layout::VEHICLE, Examined::default())?;
        let instruments = Examined::of_drives(
            &strut.recordings,
            &stated_noise(&strut.model, Layout::VEHICLE),
            &[
                0.0,
                rounded_to_pa.p1,
                rounded_to_pa.p2,
                rounded_to_pa.p3,
                rounded_to_pa.p4,
            ],
            &strut.beside_believed(),
        );
        if instruments.findings.is_empty() {
            strut.instruments = instruments;
        } else {
            // What the recordings excite is judged by the noise too.
            let Self {
                model,
                recordings,
                inputs,
                begins,
                ..
            } = strut;
            strut = Self::with_layout(model, recordings, inputs, begins, Layout::VEHICLE, instruments)?;
        }
        strut.count_what_is_unread(unread);
        Ok(strut)
    }

    /// What was read less what the believed model makes of it, by channel and recording, Pa. A recording that it cannot simulate is left out.
    fn beside_believed(&self) -> Vec<Vec<Vec<f64>>> {
        let believed = self.as_given();
        let simulated: Vec<Option<Series>> = (0..self.recordings.len())
            .into_par_iter()
            .map(|r| self.simulate(&believed, r).ok())
            .collect();
        let of_channel = |c: usize| {
            let recorded = simulated.iter().enumerate();
            let beside = recorded.filter_map(|(r, simulated)| Some((self.measured(r, c), &simulated.as_ref()?[c])));
            beside
                .map(|(read, simulated)| {
                    read.iter()
                        .zip(simulated)
                        .map(|(read, simulated)| read - simulated)
                        .collect()
                })
                .collect()
        };
        (0..self.channels.len()).map(of_channel).collect()
    }

    /// Cuts off what a recording that does not begin at rest holds before the sample from which a strut can be simulated: all that must be known of the strut
    /// was read there, and its valves stand still if they do so within the first seconds. Returns the length of what is cut off, s.
    pub fn let_begin_in_motion(recording: &mut Recording) -> f64 {
        beginning::from_first_complete_sample(recording, Layout::VEHICLE)
    }

    /// Lets oil whose compressibility is found, because the believed model has none, be counted at this density.
    pub fn count_found_oil_at(&mut self, counted_at: OilCount) {
        self.found_oil_counted_at = counted_at;
    }

    /// True if a recording begins in the middle of a drive.
    #[must_use]
    pub(crate) fn begins_in_motion(&self) -> bool {
        self.begins.iter().any(|begins| *begins != Beginning::AtRest)
    }

    /// The same recordings beside another model, to be fitted. Its noise is that of this strut; its floor does not count what the model makes of the unknown motion.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(crate) fn believing(&self, model: StrutModel) -> Result<Self, String> {
        Self::with_layout(
            model,
            self.recordings.clone(),
            self.inputs.clone(),
            self.begins.clone(),
            self.layout,
            self.instruments.clone(),
        )
    }

    /// What was read less what another model makes of the same motion and beginning, by recording and channel, Pa; exactly zero where nothing was read. `None`
    /// if the model cannot be simulated.
    #[must_use]
    pub fn residuals_of(&self, model: &StrutModel) -> Option<Vec<Series>> {
        let wanted: Vec<Replay<'_>> = (self.inputs.iter().zip(&self.begins))
            .map(|(inputs, begins)| Replay {
                model,
                inputs,
                begins: *begins,
                with_course: false,
            })
            .collect();
        let simulated = replay_all(&wanted)
            .into_iter()
            .map(|replayed| Some(self.layout.recorded(finite_channels(replayed.ok()?.prediction).ok()?)));
        (simulated.enumerate())
            .map(|(r, channels)| Some(self.beside(r, &channels?)))
            .collect()
    }

    /// The same under a hypothesis.
    #[must_use]
    pub(crate) fn residuals(&self, hypothesis: &Hypothesis) -> Option<Vec<Series>> {
        (0..self.recordings.len())
            .into_par_iter()
            .map(|r| Some(self.beside(r, &self.simulate(hypothesis, r).ok()?)))
            .collect()
    }

    /// What was read in a recording less what was simulated of it.
    fn beside(&self, recording: usize, simulated: &Series) -> Series {
        let channels = simulated.iter().enumerate();
        channels
            .map(|(c, series)| less(self.measured(recording, c), series))
            .collect()
    }

    /// Adds to the noise of each sample what the readings leave unknown: how far the pressures of other motions and other switching signals are from
    /// those of the best ones. What the motion makes is measured by the second difference of the residuals, in which a model that lacks something shows
    /// next to nothing, because that changes slowly.
    fn count_what_is_unread(&mut self, unread: Vec<Unread>) {
        let believed = self.as_given();
        let mut seen = vec![Unknown::default(); self.channels.len()];
        let mut of_motions: Vec<Vec<Series>> = Vec::with_capacity(unread.len());
        for (r, unread) in unread.iter().enumerate() {
            let differences = self.differences_from_best(r, &unread.motions);
            if let Ok(simulated) = self.simulate(&believed, r) {
                for (c, seen) in seen.iter_mut().enumerate() {
                    differences.iter().for_each(|series| seen.add_difference(&series[c]));
                    seen.add_residual(self.measured(r, c), &simulated[c]);
                }
            }
            for (c, deviations) in self.deviations(&self.differences_from_best(r, &unread.signals)) {
                self.instruments.add_noise(r, 1 + c, &deviations);
            }
            of_motions.push(differences);
        }
        let shares: Vec<f64> = (seen.iter().zip(&self.channels))
            .map(|(seen, channel)| seen.share(channel.noise * channel.noise))
            .collect();
        for (r, differences) in of_motions.iter().enumerate() {
            for (c, mut deviations) in self.deviations(differences) {
                deviations.iter_mut().for_each(|v| *v *= shares[c].sqrt());
                self.instruments.add_noise(r, 1 + c, &deviations);
            }
        }
        let firsts: Vec<Option<&Series>> = of_motions.iter().map(|series| series.first()).collect();
        let counted = (shares.into_iter().enumerate())
            .map(|(c, share)| Counted {
                estimated: self.mean_square(c, &firsts),
                share,
            })
            .collect();
        let possible = unread
            .into_iter()
            .filter_map(|unread| unread.motions.into_iter().next());
        self.unknown_motion = Some(UnknownMotion::new(possible.collect(), counted));
    }

    /// What other inputs of a recording make different, with the believed model.
    fn differences_from_best(&self, recording: usize, others: &[Inputs]) -> Vec<Series> {
        let pairs: Vec<[&Inputs; 2]> = others.iter().map(|other| [&self.inputs[recording], other]).collect();
        (floor::differences_of_all(&self.model, &pairs, &self.begins[recording], self.layout).into_iter())
            .flatten()
            .collect()
    }

    /// Root mean square of differences around each sample, every channel; nothing without differences.
    fn deviations(&self, differences: &[Series]) -> Vec<(usize, Vec<f64>)> {
        let channels = if differences.is_empty() { 0 } else { self.channels.len() };
        (0..channels)
            .map(|c| {
                let of_channel: Vec<&[f64]> = differences.iter().map(|series| series[c].as_slice()).collect();
                (c, floor::local_deviation_of_all(&of_channel))
            })
            .collect()
    }

    /// Mean square of differences of a channel, one for each recording, in units of the noise of the samples.
    fn mean_square(&self, channel: usize, differences: &[Option<&Series>]) -> f64 {
        let (mut sum, mut count) = (0.0, 0_usize);
        for (r, series) in differences.iter().enumerate() {
            let Some(series) = series else { continue };
            let relative = self.relative_noise(r, channel);
            for (k, d) in series[channel].iter().enumerate() {
                let in_units = d / (self.channels[channel].noise * relative.map_or(1.0, |relative| relative[k]));
                sum += in_units * in_units;
            }
            count += series[channel].len();
        }
        sum / count.max(1) as f64
    }

    /// The floor of a strut in a vehicle. What the motion leaves unknown is part of the channels' noise, as far as the believed model turns it into
    /// pressure; another model, such as one with an oil column that swings, may turn it into more.
    pub(super) fn floor_of_unknown_motion(&self, motion: &UnknownMotion, hypothesis: &Hypothesis) -> f64 {
        let model = self.applied(hypothesis);
        let differences: Vec<Option<Series>> = (0..self.inputs.len())
            .into_par_iter()
            .map(|r| {
                let pair = [&self.inputs[r], motion.possible(r)];
                floor::differences(&model, pair, &self.beginning(hypothesis, &model, r), self.layout)
            })
            .collect();
        let differences: Vec<Option<&Series>> = differences.iter().map(Option::as_ref).collect();
        let beyond = (0..self.channels.len()).map(|c| motion.beyond(c, self.mean_square(c, &differences)));
        (1.0 + beyond.sum::<f64>() / self.channels.len() as f64).sqrt()
    }
}

/// What was read less what was simulated; zero where nothing was read.
fn less(read: &[f64], simulated: &[f64]) -> Vec<f64> {
    let difference = |(read, simulated): (&f64, &f64)| if read.is_finite() { read - simulated } else { 0.0 };
    read.iter().zip(simulated).map(difference).collect()
}

/// Inputs of a recording that its readings allow beside the best ones.
struct Unread {
    /// With other motions.
    motions: Vec<Inputs>,
    /// With other samples at which valves were switched.
    signals: Vec<Inputs>,
}
