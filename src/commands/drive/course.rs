//! A manoeuvre with its road and vehicle, ready to be driven with either model.

use std::sync::Arc;

use oleo_interface::Corners;
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::handling::{
    Ending, HandlingModel, HandlingParameters, HandlingVehicle, Manoeuvre, Run, Sample, Signals, Track,
};
use oleo_plant_sim::road::{self, Road};
use oleo_plant_sim::vehicle::suspension::{CoilElement, SuspensionElement};
use oleo_plant_sim::vehicle::{BaselineVehicle, RideModel, RideVehicle, SeatAcceleration, Seats, VehicleParameters};

use super::suspension::{Valves, struts};
use super::{Args, Kind, Model, Setting};
use crate::failure::Failure;

/// Time before a step of steer, s.
const STEP_AT_S: f64 = 1.0;

pub struct Course {
    pub title: &'static str,
    pub manoeuvre: Manoeuvre,
    pub track: Track,
    pub speed_m_s: f64,
    pub vehicle: VehicleParameters,
    handling: HandlingParameters,
    road: Arc<dyn Road>,
    pub road_name: String,
    duration_s: f64,
}

impl Course {
    pub fn new(args: &Args, vehicle: VehicleParameters, handling: HandlingParameters) -> Result<Self, Failure> {
        let free = matches!(args.manoeuvre, Kind::Belgian | Kind::Bump | Kind::Straight);
        if !free && args.model != Model::Handling {
            return Err(Failure::new(
                "--model: the ride model does not steer: take --model handling for this manoeuvre",
            ));
        }
        if args.manoeuvre != Kind::Straight && args.road != "flat" {
            return Err(Failure::new(
                "--road: only --manoeuvre straight takes a road; the others have their own",
            ));
        }
        let speed_km_h = args
            .speed_km_h
            .unwrap_or(if args.manoeuvre == Kind::Bump { 5.0 } else { 60.0 });
        within("--speed-km-h", speed_km_h, 1.0, 250.0)?;
        let speed_m_s = speed_km_h / 3.6;
        if let Some(duration_s) = args.duration_s {
            within("--duration-s", duration_s, 0.1, 3600.0)?;
        }
        within("--radius-m", args.radius_m.abs(), 8.0, 1e5)?;
        within("--steer-deg", args.steer_deg.abs(), 0.0, 60.0)?;
        let width_m = vehicle.layout.width_m;
        let (title, road_name, track) = match args.manoeuvre {
            Kind::Belgian => ("Belgian block", "belgian", Track::straight()),
            Kind::Bump => ("APG obstacle, left wheels", "apg-left", Track::straight()),
            Kind::LaneChange => (
                "Severe double lane change, ISO 3888-1",
                "flat",
                Track::severe_lane_change(width_m),
            ),
            Kind::LaneChange2 => (
                "Obstacle avoidance, ISO 3888-2",
                "flat",
                Track::obstacle_avoidance(width_m),
            ),
            Kind::ConstantRadius => ("Constant radius, ISO 4138", "flat", Track::circle(args.radius_m)),
            Kind::StepSteer => ("Step of steer, ISO 7401", "flat", Track::straight()),
            Kind::Straight => ("Straight ahead", args.road.as_str(), Track::straight()),
        };
        let duration_s = args.duration_s.unwrap_or(match args.manoeuvre {
            // Past the obstacle with both axles, and three seconds more.
            Kind::Bump => (12.0 + vehicle.layout.wheelbase_m) / speed_m_s + 3.0,
            Kind::LaneChange | Kind::LaneChange2 => 2.5 * track.end_m().unwrap_or(0.0) / speed_m_s,
            Kind::ConstantRadius => 90.0,
            Kind::StepSteer => 6.0,
            Kind::Belgian | Kind::Straight => 20.0,
        });
        let manoeuvre = match args.manoeuvre {
            Kind::ConstantRadius => Manoeuvre::ConstantRadius {
                radius_m: args.radius_m,
                from_m_s: speed_m_s.min(3.0),
                to_m_s: speed_m_s,
                duration_s,
            },
            Kind::StepSteer => {
                let angle_rad = args.steer_deg.to_radians();
                Manoeuvre::StepSteer {
                    speed_m_s,
                    angle_rad,
                    at_s: STEP_AT_S,
                    duration_s,
                }
            }
            _ => Manoeuvre::Follow {
                track: track.clone(),
                speed_m_s,
                duration_s,
            },
        };
        let road = road::from_name_or_path(road_name, speed_m_s * duration_s + 50.0, args.seed)?;
        let road_name = road_name.to_owned();
        Ok(Self {
            title,
            manoeuvre,
            track,
            speed_m_s,
            vehicle,
            handling,
            road,
            road_name,
            duration_s,
        })
    }

    /// With the handling model.
    pub fn handling(&self, setting: Setting) -> Result<Run, Failure> {
        let (vehicle, handling) = (&self.vehicle, &self.handling);
        let road = Arc::clone(&self.road);
        let speed_m_s = self.manoeuvre.initial_speed_m_s();
        if setting == Setting::Baseline {
            let mut model =
                HandlingModel::with_elements(vehicle, handling, CoilElement::of_vehicle(vehicle), road, speed_m_s)?;
            return Ok(self
                .manoeuvre
                .drive(&mut model, vehicle, handling, |_| Default::default(), |_| {})?);
        }
        let mut valves = Valves::new(setting);
        let struts = struts(vehicle, valves.at_start())?;
        let mut model = HandlingVehicle::new(vehicle, handling, struts, road, speed_m_s)?;
        let decide = |model: &HandlingVehicle| {
            let signals = valves.decide(model.strut_displacement_m(), model.strut_output());
            (signals, signals)
        };
        Ok(self.manoeuvre.drive(&mut model, vehicle, handling, decide, |_| {})?)
    }

    /// With the ride model; straight ahead only.
    pub fn ride(&self, setting: Setting) -> Result<Run, Failure> {
        let road = Arc::clone(&self.road);
        if setting == Setting::Baseline {
            let mut model = BaselineVehicle::baseline(&self.vehicle, road, self.speed_m_s)?;
            return Ok(self.ride_out(&mut model, |_| Default::default()));
        }
        let mut valves = Valves::new(setting);
        let struts = struts(&self.vehicle, valves.at_start())?;
        let mut model = RideVehicle::new(&self.vehicle, struts, road, self.speed_m_s)?;
        let decide = |model: &RideVehicle| {
            let signals = valves.decide(model.strut_displacement_m(), model.strut_output());
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
        let ticks = (self.duration_s / TICK_S).round() as usize;
        let mut run = Run {
            ending: Ending::Completed,
            history: Vec::with_capacity(ticks + 1),
            cone_margin_m: None,
            max_roll_rad: 0.0,
            max_lateral_m_s2: 0.0,
            wheel_lift_s: 0.0,
        };
        for i in 0..=ticks {
            let (signals, valves) = decide(model);
            let body = model.body();
            let seat = seats.map(|[x, y, _]| SeatAcceleration {
                vertical_m_s2: model.vertical_acceleration_at(x, y),
                ..SeatAcceleration::default()
            });
            let (axles, _) = model.state();
            run.history.push(Sample {
                time_s: model.time_s(),
                station_m: model.station_m() - vehicle.body_cg_behind_front_axle_m(),
                heave_m: body.heave_m,
                pitch_rad: body.pitch_rad,
                roll_rad: body.roll_rad,
                speed_m_s: self.speed_m_s,
                vertical_acceleration_m_s2: body.heave_acceleration_m_s2,
                wheel_load_n: model.wheels().map(|wheel| wheel.force_n),
                strut_displacement_m: model.strut_displacement_m(),
                strut_force_n: model.suspension_force_n(),
                seat,
                front_axle_heave_m: axles.front_heave,
                front_axle_roll_rad: axles.front_roll,
                valves,
                ..Sample::default()
            });
            run.max_roll_rad = run.max_roll_rad.max(body.roll_rad.abs());
            if i > 0 && model.wheels().values().any(|wheel| wheel.force_n <= 0.0) {
                run.wheel_lift_s += TICK_S;
            }
            if i < ticks {
                for _ in 0..steps_a_tick {
                    model.step(signals);
                }
            }
        }
        run
    }
}

fn within(option: &str, value: f64, low: f64, high: f64) -> Result<(), Failure> {
    if value >= low && value <= high {
        return Ok(());
    }
    Err(Failure::new(format!(
        "{option} {value}: give a value from {low} to {high}"
    )))
}
