//! A step of steer on a flat road: what `tests/side_by_side.py` times beside vehicle models of others.
//!
//! `vehicle_side_by_side SPRINGS SPEED STEER AT DURATION` (SPRINGS is `struts` or `coil springs`; m/s, rad, s, s) prints the seconds of each of five
//! repeats, and the heading at the end.

use std::sync::Arc;

use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::course::{Course, Drive, DriverStyle, Manoeuvre};
use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::road::Flat;
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::StrutElement;
use oleo_plant_sim::vehicle::VehicleParameters;
use oleo_plant_sim::vehicle::suspension::{CoilElement, SuspensionElement};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let [springs, speed, angle, at, duration, repeats] = words[..] else {
        return Err("usage: vehicle_side_by_side SPRINGS SPEED STEER AT DURATION REPEATS".into());
    };
    let manoeuvre = Manoeuvre::StepSteer {
        speed_m_s: speed.parse()?,
        angle_rad: angle.parse()?,
        at_s: at.parse()?,
        duration_s: duration.parse()?,
    };
    let vehicle = VehicleParameters::defender110();
    for _ in 0..repeats.parse::<u32>()? {
        match springs {
            "coil springs" => drive(
                manoeuvre,
                &vehicle,
                CoilElement::of_vehicle(&vehicle),
                Corners::default(),
            )?,
            "struts" => {
                let signals = StrutValves::splat(true);
                let loads = vehicle.static_strut_load_n();
                let strut = |corner| Strut::at_rest(&StrutModel::defender110(loads[corner]), signals);
                let struts = Corners::try_from_fn(|corner| strut(corner).map(StrutElement::new))?;
                drive(manoeuvre, &vehicle, struts, Corners::splat(signals))?;
            }
            _ => return Err(format!("{springs}: give struts or coil springs").into()),
        }
    }
    Ok(())
}

fn drive<E: SuspensionElement>(
    manoeuvre: Manoeuvre,
    vehicle: &VehicleParameters,
    springs: Corners<E>,
    signals: Corners<E::Signal>,
) -> Result<(), Box<dyn std::error::Error>>
where
    Corners<E::Signal>: Copy,
{
    let course = Course {
        manoeuvre,
        driver: DriverStyle::Eased,
        road: Arc::new(Flat),
    };
    let mut drive = Drive::begin(&course, vehicle, &HandlingParameters::defender110(), springs)?;
    while drive.ending().is_none() {
        drive.tick(signals, |_| {})?;
    }
    println!("yaw {:e}", drive.model().motion().yaw_rad);
    Ok(())
}
