//! Settings compared on a few drives: `cargo run --release -p oleo-hil --example settings -- ride|roll SEEDS`.
use oleo_controller::Strategy;
use oleo_hil::comparison::{Bench, DriveCase, Figures, Setting, drive};
use oleo_plant_sim::course::{DriverStyle, LaneChange};
use rayon::prelude::*;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let what = arguments[1].as_str();
    let seeds: u64 = arguments[2].parse().unwrap();
    let bench = Bench::defender110();
    let controlled = |strategy: Strategy| {
        let mut builder = oleo_controller::Builder { strategy, ..bench.controller() };
        let env = |name: &str, value: f32| std::env::var(name).map_or(value, |v| v.parse().unwrap());
        let t = &mut builder.tuning.strategy.road_and_cornering;
        t.cornering_floor_m_s2 = env("FLOOR", t.cornering_floor_m_s2);
        t.cornering_multiple = env("K", t.cornering_multiple);
        t.release_share = env("REL", t.release_share);
        t.lateral_memory_s = env("MEM", t.lateral_memory_s);
        t.very_rough_m_s2.begin = env("VB", t.very_rough_m_s2.begin);
        t.very_rough_m_s2.end = env("VE", t.very_rough_m_s2.end);
        builder.tuning.estimate.lateral_corner_hz = env("LP", builder.tuning.estimate.lateral_corner_hz);
        Setting::Controlled(strategy.name(), Box::new(builder.build().unwrap()))
    };
    let mut settings = vec![Setting::AsSold];
    if what == "fixed" {
        settings.extend(Setting::all_fixed());
    } else {
        settings.extend([Setting::SOFT, Setting::STIFF, Setting::all_fixed()[6].clone()]);
    }
    if what != "fixed" {
        settings.push(controlled(Strategy::RoadAndCornering));
    }
    let mut groups: Vec<(String, Vec<DriveCase>)> = Vec::new();
    let seeds = 1..=seeds;
    if what == "ride" || what == "fixed" {
        for road in ["iso-b", "iso-c", "iso-d", "iso-e", "belgian"] {
            for km_h in [40.0, 60.0, 80.0] {
                let cases = seeds.clone().map(|seed| DriveCase::straight(road, km_h / 3.6, 15.0, seed)).collect();
                groups.push((format!("{road} {km_h}"), cases));
            }
        }
    } else {
        for road in arguments[3].split(',') {
            for (kind, km_h) in [(LaneChange::Severe, 60.0), (LaneChange::Severe, 80.0), (LaneChange::ObstacleAvoidance, 60.0)] {
                let cases = seeds.clone().map(|seed| DriveCase::lane_change(road, kind, km_h / 3.6, DriverStyle::Eased, seed)).collect();
                groups.push((format!("{road} {kind:?} {km_h}"), cases));
            }
            let cases = seeds.clone().map(|seed| DriveCase::step_steer(road, 60.0 / 3.6, 0.06, seed)).collect();
            groups.push((format!("{road} step 60"), cases));
        }
    }
    print!("{:28}", "");
    for s in &settings { print!("{:>16}", s.name()); }
    println!();
    for (name, cases) in groups {
        let jobs: Vec<(usize, &DriveCase)> = (0..settings.len()).flat_map(|s| cases.iter().map(move |c| (s, c))).collect();
        let figures: Vec<Figures> = jobs.par_iter().map(|(s, c)| drive(&bench, c, &settings[*s]).unwrap()).collect();
        print!("{name:28}");
        for s in 0..settings.len() {
            let mine: Vec<&Figures> = jobs.iter().zip(&figures).filter(|((k, _), _)| *k == s).map(|(_, f)| f).collect();
            let mean = |f: fn(&Figures) -> f64| mine.iter().map(|x| f(x)).sum::<f64>() / mine.len() as f64;
            if cases[0].is_straight() {
                print!("{:>8.3} e{:<2} {:>3.0}", mean(|f| f.weighted_rms_m_s2), mine.iter().map(|f| f.entries).sum::<u32>(), mean(|f| f64::from(f.valve_changes.iter().sum::<u32>()) / f.distance_km));
            } else {
                print!("{:>8.2} {:>6.2}", mean(|f| f.peak_roll_deg), mean(|f| f.decision_s.unwrap_or(9.0)));
            }
        }
        println!();
    }
}
