//! How much faster than real time the handling model runs with four second-generation struts, and what a lane change is like.

use std::sync::Arc;
use std::time::Instant;

use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::course::{Course, Drive, DriverStyle, LaneChange, Manoeuvre};
use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::road::{Flat, Road, belgian};
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::StrutElement;
use oleo_plant_sim::vehicle::VehicleParameters;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let parameters = VehicleParameters::defender110();
    let handling = HandlingParameters::defender110();
    let [a, b, c, d] = parameters.static_strut_load_n().into_array();
    let speed_m_s = 60.0 / 3.6;
    let belgian: Arc<dyn Road> = Arc::new(belgian::belgian_block(500.0, 1)?);
    let lane_change = |kind| Manoeuvre::LaneChange {
        kind,
        speed_m_s,
        entry_m: 25.0,
        duration_s: None,
    };
    let straight = Manoeuvre::Straight {
        speed_m_s,
        duration_s: 20.0,
    };
    let flat = || Arc::new(Flat) as Arc<dyn Road>;
    for (name, road, manoeuvre, driver, open) in [
        (
            "lane change soft",
            flat(),
            lane_change(LaneChange::Severe),
            DriverStyle::Eased,
            true,
        ),
        (
            "lane change stiff",
            flat(),
            lane_change(LaneChange::Severe),
            DriverStyle::Hard,
            false,
        ),
        (
            "ISO 3888-2 stiff",
            flat(),
            lane_change(LaneChange::ObstacleAvoidance),
            DriverStyle::Eased,
            false,
        ),
        ("belgian soft", Arc::clone(&belgian), straight, DriverStyle::Eased, true),
        ("belgian stiff", belgian, straight, DriverStyle::Eased, false),
    ] {
        let signals = StrutValves::splat(open);
        let strut = |load_n| Strut::at_rest(&StrutModel::defender110(load_n), signals);
        let struts = Corners::from_array([strut(a)?, strut(b)?, strut(c)?, strut(d)?]).map(StrutElement::new);
        let signals = Corners::splat(signals);
        let course = Course {
            manoeuvre,
            driver,
            road,
        };
        let drive = Drive::begin(&course, &parameters, &handling, struts)?;
        let begin = Instant::now();
        let run = drive.to_end(|_| (signals, signals), |_| {})?;
        let wall = begin.elapsed().as_secs_f64();
        let time_s = run.history.last().map_or(0.0, |sample| sample.time_s);
        println!(
            "{name}: {time_s:.1} s in {wall:.3} s = {:.0} x real time; {}; roll {:.2} deg, lateral {:.2} m/s2, cones {:?} m",
            time_s / wall,
            run.ending.word(),
            run.max_roll_rad.to_degrees(),
            run.max_lateral_m_s2,
            run.cone_margin_m,
        );
    }
    Ok(())
}
