//! A strut that is moved slowly, or at a steady speed: its pressures and flows have closed forms.

use oleo_interface::{Gauge, StrutValves};
use oleo_plant_sim::strut::{Effects, Strut, StrutModel, StrutOutput};

pub const STIFF: StrutValves<bool> = StrutValves::new(true, true, false);
pub const SOFT: StrutValves<bool> = StrutValves::new(true, true, true);
pub const CLOSED: StrutValves<bool> = StrutValves::new(false, false, false);
pub const BYPASS_1: StrutValves<bool> = StrutValves::new(true, false, false);

/// The preset without any term.
pub fn bare() -> StrutModel {
    let mut model = StrutModel::defender110(8000.0);
    model.effects = Effects::default();
    model
}

pub fn absolute(gauge: f64) -> f64 {
    Gauge(gauge).absolute().pa()
}

/// Slowly to a displacement: 2 mm/s in 10 ms steps.
pub fn slowly(strut: &mut Strut, to_m: f64, signals: StrutValves<bool>) -> StrutOutput {
    let from = strut.displacement_m();
    let steps = ((to_m - from).abs() / 2e-5).ceil().max(1.0);
    for i in 1..=steps as usize {
        strut.advance(from + (to_m - from) * i as f64 / steps, 0.01, signals);
    }
    (0..200).map(|_| strut.advance(to_m, 0.01, signals)).last().unwrap()
}

pub fn slow_pressure(model: &StrutModel, to_m: f64, signals: StrutValves<bool>) -> f64 {
    slowly(&mut Strut::at_rest(model, signals).unwrap(), to_m, signals).pressure_pa[0]
}

pub fn close(a: f64, b: f64, relative: f64) {
    assert!((a / b - 1.0).abs() < relative, "{a} is not {b}");
}

/// Pressure drop p1 - p2 at a steady speed through path 1 alone.
pub fn steady_drop(model: &StrutModel, speed: f64, signals: StrutValves<bool>) -> (f64, f64) {
    let mut strut = Strut::at_rest(model, signals).unwrap();
    let out = (1..=100)
        .map(|i| strut.advance(speed * 5e-4 * f64::from(i), 5e-4, signals))
        .last()
        .unwrap();
    (out.pressure_pa[0] - out.pressure_pa[1], model.piston_area_m2() * speed)
}

/// Load cell less the pressure's force.
pub fn beside_pressure(model: &StrutModel, out: &StrutOutput) -> f64 {
    out.force_n - model.piston_area_m2() * out.pressure_pa[0]
}
