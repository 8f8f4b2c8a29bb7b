//! How much faster than real time the handling model runs with four second-generation struts, and what a lane change is like.

use std::sync::Arc;
use std::time::Instant;

use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::handling::{HandlingParameters, HandlingVehicle, Manoeuvre, Track};
use oleo_plant_sim::road::{Flat, Road, belgian};
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::VehicleParameters;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let parameters = VehicleParameters::defender110();
    let handling = HandlingParameters::defender110();
    let [a, b, c, d] = parameters.static_strut_load_n().into_array();
    let speed_m_s = 60.0 / 3.6;
    let belgian: Arc<dyn Road> = Arc::new(belgian::belgian_block(500.0, 1)?);
    for (name, road, track, open) in [
        (
            "lane change soft",
            Arc::new(Flat) as Arc<dyn Road>,
            Track::severe_lane_change(1.79),
            true,
        ),
        (
            "lane change stiff",
            Arc::new(Flat) as Arc<dyn Road>,
            Track::severe_lane_change(1.79),
            false,
        ),
        (
            "ISO 3888-2 stiff",
            Arc::new(Flat) as Arc<dyn Road>,
            Track::obstacle_avoidance(1.79),
            false,
        ),
        ("belgian soft", Arc::clone(&belgian), Track::straight(), true),
        ("belgian stiff", belgian, Track::straight(), false),
    ] {
        let signals = [open; 3];
        let strut = |load_n| Strut::at_rest(&StrutModel::defender110(load_n), signals);
        let struts = Corners::from_array([strut(a)?, strut(b)?, strut(c)?, strut(d)?]);
        let signals = Corners::from_array([StrutValves::from_array(signals); 4]);
        let mut model = HandlingVehicle::new(&parameters, &handling, struts, road, speed_m_s)?;
        let manoeuvre = Manoeuvre::Follow {
            track,
            speed_m_s,
            duration_s: 20.0,
        };
        let begin = Instant::now();
        let run = manoeuvre.drive(&mut model, &parameters, &handling, |_| (signals, signals), |_| {})?;
        let wall = begin.elapsed().as_secs_f64();
        println!(
            "{name}: {:.1} s in {wall:.3} s = {:.0} x real time; {}; roll {:.2} deg, lateral {:.2} m/s2, cones {:?} m",
            model.time_s(),
            model.time_s() / wall,
            run.ending.word(),
            run.max_roll_rad.to_degrees(),
            run.max_lateral_m_s2,
            run.cone_margin_m,
        );
    }
    Ok(())
}
