//! The sections on the road and on the motion of the body.

use oleo_interface::{Axle, Side};
use oleo_report::{Axis, Page};

use super::time::Time;
use crate::run::Outcome;

pub(super) fn road(page: &mut Page, outcome: &Outcome, time: &Time) {
    let samples = &outcome.plant.recording.samples;
    let mut curves = time.curves("Road under the front wheels");
    curves.panel(Axis::new("Height", "mm"));
    for side in Side::ALL {
        let corner = Axle::Front.corner(side);
        let height: Vec<f64> = samples
            .iter()
            .map(|sample| 1e3 * sample.motion.wheel[corner].road_height_m)
            .collect();
        curves.line(side.key(), &time.s, &height);
    }
    page.section("Road").figure(curves);
}

pub(super) fn section(page: &mut Page, outcome: &Outcome, time: &Time) {
    let recording = &outcome.plant.recording;
    let samples = &recording.samples;
    let mut curves = time.curves("Sprung mass");
    let mut panel = |axis: Axis, name: &str, value: &dyn Fn(usize) -> f64| {
        let values: Vec<f64> = (0..samples.len()).map(value).collect();
        curves.panel(axis).line(name, &time.s, &values);
        time.mark(&mut curves);
    };
    panel(Axis::new("Heave", "mm"), "heave", &|i| {
        1e3 * samples[i].motion.body.heave_m
    });
    panel(Axis::new("Roll", "degrees"), "roll", &|i| {
        samples[i].motion.body.roll_rad.to_degrees()
    });
    panel(Axis::new("Pitch", "degrees"), "pitch", &|i| {
        samples[i].motion.body.pitch_rad.to_degrees()
    });
    page.section("Body motion")
        .text("Heave is positive upwards, roll with the left side up, and pitch with the nose down.")
        .figure(curves);

    let step_s: Vec<f64> = (1..=recording.seat_acceleration_m_s2.len())
        .map(|i| i as f64 * recording.step_s)
        .collect();
    let mut felt = time.curves("Vertical acceleration at the seats");
    for (seat, name) in ["driver", "left rear passenger"].into_iter().enumerate() {
        let values: Vec<f64> = recording.seat_acceleration_m_s2.iter().map(|a| a[seat]).collect();
        felt.panel(Axis::new(name, "m/s2")).line(name, &step_s, &values);
        time.mark(&mut felt);
    }
    page.figure(felt);
}
