//! Converts what is asked for into a drive for either model.

use std::sync::Arc;

use oleo_controller::VehicleDescription;
use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, Corners};
use oleo_plant_sim::course::{Course, Drive, Run, Sample, Signals, Track};
use oleo_plant_sim::handling::{HandlingParameters, HandlingVehicle};
use oleo_plant_sim::road;
use oleo_plant_sim::vehicle::StrutElement;
use oleo_plant_sim::vehicle::suspension::{CoilElement, SuspensionElement};
use oleo_plant_sim::vehicle::{
    BaselineVehicle, RideModel, RideVehicle, SeatAcceleration, Seats, TemperedStrut, VehicleParameters,
};
use oleo_report::significant;

use super::choice::{Kind, Setting};
use super::request::Request;
use super::suspension::{Valves, struts};
use crate::description::describe;
use crate::parameter_files::Parameters;
use crate::run::RunError;

/// Temperature at which the struts were charged, degrees Celsius.
const CHARGED_AT_C: f64 = 20.0;

/// A manoeuvre on its road, and the vehicle for it.
pub struct Plan {
    /// Heading of the report.
    pub title: &'static str,
    /// Manoeuvre, driver and road.
    pub course: Course,
    /// The driver's line, and the cones.
    pub track: Track,
    on_struts: VehicleParameters,
    on_coil_springs: VehicleParameters,
    handling: HandlingParameters,
    struts: Corners<TemperedStrut>,
    /// What the controller knows of the vehicle.
    described: VehicleDescription,
    /// The road in words.
    pub road_name: String,
}

impl Plan {
    /// Plans a drive.
    ///
    /// # Errors
    /// A setting that is out of its range or has no use; a road or vehicle that is not to be had.
    pub fn new(request: &Request, parameters: &Parameters) -> Result<Self, RunError> {
        request.refuse_unused()?;
        Request::within("score_from_s", request.score_from_s, 0.0, 3600.0)?;
        let Parameters {
            vehicle,
            handling,
            strut,
            ..
        } = parameters;
        let kind = request.manoeuvre;
        let settings = request.course.settings(kind.manoeuvre());
        let speed_m_s = request.speed_km_h.unwrap_or(match kind {
            Kind::Bump => 5.0,
            _ => settings.kind.usual_speed_km_h(),
        }) / 3.6;
        // Past the obstacle with both axles, and three seconds more.
        let past_bump_s = (kind == Kind::Bump).then(|| (12.0 + vehicle.layout.wheelbase_m) / speed_m_s + 3.0);
        let duration_s = request.duration_s.or(past_bump_s);
        let manoeuvre = settings.manoeuvre(speed_m_s, duration_s).map_err(RunError::Course)?;
        let name = kind.own_road().or(request.road.as_deref()).unwrap_or("flat");
        let length_m = settings.road_length_m(&manoeuvre, vehicle);
        let course = settings.course(manoeuvre, road::from_name_or_path(name, length_m, request.seed)?);
        let track = course.track(vehicle);
        let mut road_name = name.to_owned();
        if let Some(measured_m) = course.road.measured_length_m() {
            road_name += &format!(" ({} m, beyond them its mirror image)", significant(measured_m, 3));
        }
        match settings.side_slope_percent() {
            0.0 => {}
            percent => road_name += &format!(", side slope of {percent} %"),
        }
        let celsius = request.gas_temperature_c.unwrap_or(CHARGED_AT_C);
        Request::within("gas_temperature_c", celsius, -60.0, 120.0)?;
        let load = request.load.unwrap_or_default();
        let described = describe(vehicle, handling, strut);
        let levelled = load.at_ride_height(vehicle);
        let struts = levelled
            .static_strut_load_n()
            .map(|load_n| TemperedStrut::new(&strut.clone().charged_for(load_n), celsius + 273.15));
        Ok(Self {
            title: kind.title(),
            course,
            track,
            on_struts: levelled.raised(struts.each_ref().by_axle().map(|(left, _)| left.rise_m)),
            on_coil_springs: load.on_coil_springs(vehicle),
            handling: handling.clone(),
            struts,
            described,
            road_name,
        })
    }

    /// Name of the vehicle, whatever it stands on.
    pub fn vehicle_name(&self) -> &str {
        &self.on_struts.name
    }

    /// The vehicle with its load on one of its suspensions.
    fn vehicle(&self, setting: Setting) -> &VehicleParameters {
        match setting {
            Setting::Baseline => &self.on_coil_springs,
            _ => &self.on_struts,
        }
    }

    /// How much the gas's temperature raises the body in front and at the rear, m.
    pub fn rise_m(&self, setting: Setting) -> (f64, f64) {
        if setting == Setting::Baseline {
            return (0.0, 0.0);
        }
        let rise = self.struts.each_ref().map(|strut| strut.rise_m);
        (rise[Corner::FrontLeft], rise[Corner::RearLeft])
    }

    /// Corners of the body seen from above, ahead and left of its centre of mass, m.
    pub fn outline_m(&self) -> [[f64; 2]; 4] {
        self.handling.outline.corners_m(&self.on_struts)
    }

    /// Displacements as sensors say that were set to zero when the struts were charged.
    fn sensed_m(&self, displacement_m: Corners<f64>) -> Corners<f64> {
        Corners::from_fn(|corner| displacement_m[corner] - self.struts[corner].rise_m)
    }

    /// Drives the handling model.
    ///
    /// # Errors
    /// A vehicle that cannot stand or a motion that is not finite.
    pub fn handling(&self, setting: Setting) -> Result<Run, RunError> {
        let (vehicle, handling) = (self.vehicle(setting), &self.handling);
        if setting == Setting::Baseline {
            let drive = Drive::begin(&self.course, vehicle, handling, CoilElement::of_vehicle(vehicle))?;
            return Ok(drive.to_end(|_| Default::default(), |_| {})?);
        }
        let mut valves = Valves::new(setting, self.described)?;
        let elements = struts(&self.struts, valves.at_start())?.map(StrutElement::new);
        let decide = |model: &HandlingVehicle| {
            let signals = valves.decide(self.sensed_m(model.strut_displacement_m()), model.strut_output());
            (signals, signals)
        };
        Ok(Drive::begin(&self.course, vehicle, handling, elements)?.to_end(decide, |_| {})?)
    }

    /// Drives the ride model, straight ahead.
    ///
    /// # Errors
    /// A vehicle that cannot stand.
    pub fn ride(&self, setting: Setting) -> Result<Run, RunError> {
        let road = Arc::clone(&self.course.road);
        let speed_m_s = self.course.manoeuvre.initial_speed_m_s();
        if setting == Setting::Baseline {
            let mut model = BaselineVehicle::baseline(self.vehicle(setting), road, speed_m_s)?;
            return Ok(self.ride_out(setting, &mut model, |_| Default::default()));
        }
        let mut valves = Valves::new(setting, self.described)?;
        let struts = struts(&self.struts, valves.at_start())?;
        let mut model = RideVehicle::new(self.vehicle(setting), struts, road, speed_m_s)?;
        let decide = |model: &RideVehicle| {
            let signals = valves.decide(self.sensed_m(model.strut_displacement_m()), model.strut_output());
            (signals, signals)
        };
        Ok(self.ride_out(setting, &mut model, decide))
    }

    fn ride_out<E: SuspensionElement>(
        &self,
        setting: Setting,
        model: &mut RideModel<E>,
        mut decide: impl FnMut(&RideModel<E>) -> (Corners<E::Signal>, Signals),
    ) -> Run {
        let vehicle = self.vehicle(setting);
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
