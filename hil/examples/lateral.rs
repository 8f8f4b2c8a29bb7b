//! RMS of the estimated lateral acceleration by road and setting, straight ahead.
use oleo_controller::{Configuration, State, tick};
use oleo_hil::comparison::*;
use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::course::{Course, Drive, DriverStyle, Manoeuvre};
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::suspension::StrutElement;
use rayon::prelude::*;
fn main() {
    let b = Bench::defender110();
    let mut jobs = vec![];
    for road in ["iso-b", "iso-c", "iso-d", "iso-e", "belgian"] { for v in [40.0, 60.0, 80.0] { for open in [false, true] { jobs.push((road, v, open)); } } }
    let lines: Vec<String> = jobs.par_iter().map(|&(road, v, open)| {
        let m = Manoeuvre::Straight { speed_m_s: v / 3.6, duration_s: 15.0 };
        let track = m.track(DriverStyle::Eased, b.vehicle.layout.width_m);
        let course = Course { manoeuvre: m, driver: DriverStyle::Eased, road: oleo_plant_sim::road::from_name_or_path(road, m.length_m(&track), 1).unwrap() };
        let sig = StrutValves::splat(open);
        let el = b.vehicle.static_strut_load_n().map(|l| StrutElement::new(Strut::at_rest(&StrutModel::defender110(l), sig).unwrap()));
        let mut d = Drive::begin(&course, &b.vehicle, &b.handling, el).unwrap();
        let mut out = format!("{road} {v} {open}:");
        let lps = [(1.0f32, 0.15f32), (1.5, 0.15), (2.0, 0.15), (2.0, 0.4)];
        let configs: Vec<Configuration> = lps.iter().map(|lp| { let mut x = b.controller(); x.tuning.estimate.lateral_corner_hz = lp.0; x.vehicle.roll_gyration_m = lp.1; x.build().unwrap() }).collect();
        let mut states: Vec<State> = lps.iter().map(|_| State::new()).collect();
        let mut s = Sensors::new(1);
        let mut sq = [0.0f64; 8]; let mut n = 0.0; let mut peak = [0.0f64; 4];
        while d.ending().is_none() {
            let i = s.read(d.model().strut_displacement_m(), d.model().strut_output());
            for k in 0..4 { let e = tick(&configs[k], &mut states[k], &i).estimate; if d.ticks() > 600 { let a = f64::from(e.lateral_acceleration_m_s2); sq[k] += a * a; peak[k] = peak[k].max(a.abs()); if k == 0 { sq[4] += f64::from(e.vertical_acceleration_m_s2).powi(2); sq[5] += d.model().motion().lateral_acceleration_m_s2.powi(2); sq[6] += f64::from(e.roll_rad.to_degrees()).powi(2); } } }
            if d.ticks() > 600 { n += 1.0; }
            d.tick(Corners::splat(sig), |_| {}).unwrap();
        }
        for k in 0..4 { out += &format!("  {:.2} ({:.1})", (sq[k] / n).sqrt(), peak[k]); }
        out + &format!("   z {:.2} true {:.2} roll_rel {:.2}", (sq[4] / n).sqrt(), (sq[5] / n).sqrt(), (sq[6]/n).sqrt())
    }).collect();
    for l in lines { println!("{l}"); }
}
