//! Converts the options of the command line into a drive for either model.

use std::sync::Arc;

use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, Corners};
use oleo_plant_sim::course::{Course, Drive, LaneChange, Manoeuvre, Run, Sample, Signals, Track};
use oleo_plant_sim::handling::{HandlingParameters, HandlingVehicle};
use oleo_plant_sim::road::{self, Bend, SideSlope};
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::suspension::{CoilElement, StrutElement, SuspensionElement};
use oleo_plant_sim::vehicle::{
    BaselineVehicle, RideModel, RideVehicle, SeatAcceleration, Seats, TemperedStrut, VehicleParameters,
};

use super::arguments::{Args, Kind, Model, Setting};
use super::suspension::{Valves, struts};
use crate::failure::Failure;

/// Time before a step of steer, or before brake or accelerator, s.
const BEGIN_S: f64 = 1.0;
/// Time to settle in the bend before braking in it, s.
const SETTLED_IN_BEND_S: f64 = 8.0;
/// Temperature at which the struts were charged, degrees Celsius.
const CHARGED_AT_C: f64 = 20.0;
/// Station at which a side slope begins, m.
const SLOPE_FROM_M: f64 = 5.0;

pub struct Plan {
    pub title: &'static str,
    pub course: Course,
    pub track: Track,
    pub vehicle: VehicleParameters,
    handling: HandlingParameters,
    struts: Corners<TemperedStrut>,
    pub road_name: String,
}

impl Plan {
    pub fn new(args: &Args, vehicle: VehicleParameters, handling: HandlingParameters) -> Result<Self, Failure> {
        let kind = args.manoeuvre;
        if kind.steers() && args.model != Model::Handling {
            return Err(Failure::new(
                "--model: the ride model can neither steer nor brake; use --model handling for this manoeuvre",
            ));
        }
        let own_road = match kind {
            Kind::Belgian => Some("belgian"),
            Kind::Bump => Some("apg-left"),
            _ => None,
        };
        if own_road.is_some() && args.road.is_some() {
            return Err(Failure::new(
                "--road: this manoeuvre has a road of its own; use --manoeuvre straight to drive over another road",
            ));
        }
        let manoeuvre = manoeuvre(args, vehicle.layout.wheelbase_m)?;
        within("--side-slope-percent", args.side_slope_percent, -40.0, 40.0)?;
        let track = manoeuvre.track(args.driver, vehicle.layout.width_m);
        let name = own_road.or(args.road.as_deref()).unwrap_or("flat");
        let mut surface = road::from_name_or_path(name, manoeuvre.length_m(&track), args.seed)?;
        let mut road_name = name.to_owned();
        if args.side_slope_percent != 0.0 {
            surface = Arc::new(SideSlope::new(surface, 0.01 * args.side_slope_percent, SLOPE_FROM_M));
            road_name = format!("{name}, side slope of {} %", args.side_slope_percent);
        }
        if let Some(radius_m) = manoeuvre.radius_m() {
            surface = Arc::new(Bend::new(surface, radius_m));
        }
        if args.setting == Setting::Baseline && args.gas_temperature_c.is_some() {
            return Err(Failure::new(
                "--gas-temperature-c: coil springs contain no gas; use another --setting or leave the option out",
            ));
        }
        let celsius = args.gas_temperature_c.unwrap_or(CHARGED_AT_C);
        within("--gas-temperature-c", celsius, -60.0, 120.0)?;
        let levelled = args.load.at_ride_height(&vehicle);
        let struts = levelled
            .static_strut_load_n()
            .map(|load_n| TemperedStrut::new(&StrutModel::defender110(load_n), celsius + 273.15));
        let vehicle = match args.setting {
            Setting::Baseline => args.load.on_coil_springs(&vehicle),
            _ => levelled.raised(struts.each_ref().by_axle().map(|(left, _)| left.rise_m)),
        };
        Ok(Self {
            title: kind.title(),
            course: Course {
                manoeuvre,
                driver: args.driver,
                road: surface,
            },
            track,
            vehicle,
            handling,
            struts,
            road_name,
        })
    }

    /// How much the gas's temperature raises the body in front and at the rear, m.
    pub fn rise_m(&self) -> (f64, f64) {
        let rise = self.struts.each_ref().map(|strut| strut.rise_m);
        (rise[Corner::FrontLeft], rise[Corner::RearLeft])
    }

    /// Displacements as sensors say that were set to zero when the struts were charged.
    fn sensed_m(&self, displacement_m: Corners<f64>) -> Corners<f64> {
        Corners::from_fn(|corner| displacement_m[corner] - self.struts[corner].rise_m)
    }

    /// With the handling model.
    pub fn handling(&self, setting: Setting) -> Result<Run, Failure> {
        let (vehicle, handling) = (&self.vehicle, &self.handling);
        if setting == Setting::Baseline {
            let drive = Drive::begin(&self.course, vehicle, handling, CoilElement::of_vehicle(vehicle))?;
            return Ok(drive.to_end(|_| Default::default(), |_| {})?);
        }
        let mut valves = Valves::new(setting);
        let elements = struts(&self.struts, valves.at_start())?.map(StrutElement::new);
        let decide = |model: &HandlingVehicle| {
            let signals = valves.decide(self.sensed_m(model.strut_displacement_m()), model.strut_output());
            (signals, signals)
        };
        Ok(Drive::begin(&self.course, vehicle, handling, elements)?.to_end(decide, |_| {})?)
    }

    /// With the ride model; straight ahead only.
    pub fn ride(&self, setting: Setting) -> Result<Run, Failure> {
        let road = Arc::clone(&self.course.road);
        let speed_m_s = self.course.manoeuvre.initial_speed_m_s();
        if setting == Setting::Baseline {
            let mut model = BaselineVehicle::baseline(&self.vehicle, road, speed_m_s)?;
            return Ok(self.ride_out(&mut model, |_| Default::default()));
        }
        let mut valves = Valves::new(setting);
        let struts = struts(&self.struts, valves.at_start())?;
        let mut model = RideVehicle::new(&self.vehicle, struts, road, speed_m_s)?;
        let decide = |model: &RideVehicle| {
            let signals = valves.decide(self.sensed_m(model.strut_displacement_m()), model.strut_output());
            (signals, signals)
        };
        Ok(self.ride_out(&mut model, decide))
    }

    fn ride_out<E: SuspensionElement>(
        &self,
        model: &mut RideModel<E>,
        mut decide: impl FnMut(&RideModel<E>) -> (Corners<E::Signal>, Signals),
    ) -> Run {
        let vehicle = &self.vehicle;
        let seats = Seats::from_fn(|seat| vehicle.seat_place_m(seat));
        let steps_a_tick = (TICK_S / model.step_s()).round().max(1.0) as usize;
        let ticks = (self.course.manoeuvre.duration_s(&self.track) / TICK_S).round() as usize;
        let mut run = Run::with_capacity(ticks);
        for i in 0..=ticks {
            let (signals, valves) = decide(model);
            let body = model.body();
            let seat = seats.map(|[x, y, _]| SeatAcceleration {
                vertical_m_s2: model.vertical_acceleration_at(x, y),
                ..SeatAcceleration::default()
            });
            let (axles, _) = model.state();
            let sample = Sample {
                time_s: model.time_s(),
                station_m: model.station_m() - vehicle.body_cg_behind_front_axle_m(),
                heave_m: body.heave_m,
                pitch_rad: body.pitch_rad,
                roll_rad: body.roll_rad,
                speed_m_s: self.course.manoeuvre.initial_speed_m_s(),
                vertical_acceleration_m_s2: body.heave_acceleration_m_s2,
                wheel_load_n: model.wheels().map(|wheel| wheel.force_n),
                strut_displacement_m: model.strut_displacement_m(),
                strut_force_n: model.suspension_force_n(),
                seat,
                front_axle_heave_m: axles.front_heave,
                front_axle_roll_rad: axles.front_roll,
                valves,
                ..Sample::default()
            };
            run.note(sample, None);
            if i < ticks {
                for _ in 0..steps_a_tick {
                    model.step(signals);
                }
            }
        }
        run
    }
}

/// The manoeuvre that the options describe.
fn manoeuvre(args: &Args, wheelbase_m: f64) -> Result<Manoeuvre, Failure> {
    let kind = args.manoeuvre;
    let speed_km_h = args.speed_km_h.unwrap_or(match kind {
        Kind::Bump => 5.0,
        Kind::BrakingInBend | Kind::Acceleration => 40.0,
        _ => 60.0,
    });
    within("--speed-km-h", speed_km_h, 1.0, 250.0)?;
    let speed_m_s = speed_km_h / 3.6;
    if let Some(duration_s) = args.duration_s {
        within("--duration-s", duration_s, 0.1, 3600.0)?;
    }
    within("--radius-m", args.radius_m.abs(), 8.0, 1e5)?;
    within("--steer-deg", args.steer_deg.abs(), 0.0, 60.0)?;
    within("--entry-m", args.entry_m, 10.0, 2000.0)?;
    let change_m_s2 = args.change_m_s2.unwrap_or(match kind {
        Kind::Acceleration => 2.0,
        _ => 5.0,
    });
    within("--change-m-s2", change_m_s2, 0.1, 12.0)?;
    let duration_s = args.duration_s.unwrap_or(match kind {
        // Past the obstacle with both axles, and three seconds more.
        Kind::Bump => (12.0 + wheelbase_m) / speed_m_s + 3.0,
        Kind::ConstantRadius => 90.0,
        Kind::StepSteer | Kind::Acceleration => 6.0,
        _ => 20.0,
    });
    let lane_change = |which| Manoeuvre::LaneChange {
        kind: which,
        speed_m_s,
        entry_m: args.entry_m,
    };
    let braking = |radius_m: Option<f64>, at_s| Manoeuvre::Braking {
        speed_m_s,
        radius_m,
        deceleration_m_s2: change_m_s2,
        at_s,
        duration_s,
    };
    Ok(match kind {
        Kind::LaneChange => lane_change(LaneChange::Severe),
        Kind::LaneChange2 => lane_change(LaneChange::ObstacleAvoidance),
        Kind::ConstantRadius => Manoeuvre::ConstantRadius {
            radius_m: args.radius_m,
            from_m_s: speed_m_s.min(3.0),
            to_m_s: speed_m_s,
            duration_s,
        },
        Kind::StepSteer => Manoeuvre::StepSteer {
            speed_m_s,
            angle_rad: args.steer_deg.to_radians(),
            at_s: BEGIN_S,
            duration_s,
        },
        Kind::Braking => braking(None, BEGIN_S),
        Kind::BrakingInBend => braking(Some(args.radius_m), SETTLED_IN_BEND_S),
        Kind::Acceleration => Manoeuvre::Acceleration {
            speed_m_s,
            acceleration_m_s2: change_m_s2,
            at_s: BEGIN_S,
            duration_s,
        },
        Kind::Belgian | Kind::Bump | Kind::Straight => Manoeuvre::Straight { speed_m_s, duration_s },
    })
}

fn within(option: &str, value: f64, low: f64, high: f64) -> Result<(), Failure> {
    if value >= low && value <= high {
        return Ok(());
    }
    Err(Failure::new(format!(
        "{option} {value}: give a value from {low} to {high}"
    )))
}
