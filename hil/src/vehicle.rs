//! The vehicle that the plant's node drives, with one of two models.
//!
//! ```text
//!   ride model, 7 degrees of freedom       straight ahead at constant speed over a road
//!   handling model, 14, with its driver    a course: manoeuvre, driver, road
//! ```
//!
//! Both run on the same struts and give the same sample; a course gives more.

use oleo_interface::Corners;
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::course::{Drive, Ending, NotFinite, Signals, Track};
use oleo_plant_sim::strut::{StrutModel, StrutOutput};
use oleo_plant_sim::vehicle::StrutElement;
use oleo_plant_sim::vehicle::{BodyMotion, InertialReading, RideVehicle, Seats, VehicleParameters};

use crate::record::{CourseMotion, Motion, StrutStep, Wheel};

/// What a vehicle is made of, as it was loaded.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// Body, axles, tyres, with the load.
    pub parameters: VehicleParameters,
    /// The four struts, each charged for the load that it carries.
    pub struts: Corners<StrutModel>,
    /// Corners of the body seen from above, ahead and left of its centre of mass, m.
    pub outline_m: [[f64; 2]; 4],
}

/// A vehicle on its way.
pub struct Vehicle {
    model: Model,
    assembly: Assembly,
    seats: Seats<[f64; 3]>,
    behind_front_axle_m: f64,
    steps_per_tick: u32,
    measured_road_m: Option<f64>,
    records_struts: bool,
    inertial_place_m: Option<[f64; 3]>,
}

/// Which model drives. Both are some kilobytes, so that neither is moved about.
enum Model {
    Ride(Box<RideVehicle>),
    Course(Box<Drive<StrutElement>>),
}

impl Vehicle {
    /// Straight ahead with the ride model.
    pub fn on_road(model: RideVehicle, assembly: Assembly) -> Self {
        Self::new(model.step_s(), Model::Ride(Box::new(model)), assembly)
    }

    /// On a course with the handling model.
    pub fn on_course(drive: Drive<StrutElement>, assembly: Assembly) -> Self {
        Self::new(drive.model().step_s(), Model::Course(Box::new(drive)), assembly)
    }

    fn new(step_s: f64, model: Model, assembly: Assembly) -> Self {
        let parameters = &assembly.parameters;
        Self {
            model,
            seats: Seats::from_fn(|seat| parameters.seat_place_m(seat)),
            behind_front_axle_m: parameters.body_cg_behind_front_axle_m(),
            steps_per_tick: (TICK_S / step_s).round() as u32,
            measured_road_m: None,
            records_struts: false,
            inertial_place_m: None,
            assembly,
        }
    }

    /// What it is made of.
    pub fn assembly(&self) -> &Assembly {
        &self.assembly
    }

    /// The same vehicle, on a road that was measured over this length, m.
    pub(crate) fn over_measured(self, measured_road_m: Option<f64>) -> Self {
        Self {
            measured_road_m,
            ..self
        }
    }

    /// The same vehicle with an inertial unit at a place ahead, left and up of the body's present centre of mass, m.
    pub(crate) fn with_inertial_unit_at(self, place_m: Option<[f64; 3]>) -> Self {
        Self {
            inertial_place_m: place_m,
            ..self
        }
    }

    /// What an inertial unit without error reads at its place in the body's axes; `None` where there is no unit.
    pub fn inertial(&self) -> Option<InertialReading> {
        let place_m = self.inertial_place_m?;
        Some(match &self.model {
            Model::Ride(model) => model.inertial_at(place_m),
            Model::Course(drive) => drive.model().inertial_at(place_m),
        })
    }

    /// The same vehicle, whose struts are recorded after every integration step.
    pub fn recording_struts(self) -> Self {
        Self {
            records_struts: true,
            ..self
        }
    }

    /// Whether its struts are recorded after every integration step.
    pub fn records_struts(&self) -> bool {
        self.records_struts
    }

    /// Length of the measured road, m; `None` for a road that is computed. Beyond it the vehicle drives over its mirror image.
    pub fn measured_road_m(&self) -> Option<f64> {
        self.measured_road_m
    }

    /// Integration steps in a tick.
    pub fn steps_per_tick(&self) -> u32 {
        self.steps_per_tick
    }

    /// Integration step, s.
    pub fn step_s(&self) -> f64 {
        match &self.model {
            Model::Ride(model) => model.step_s(),
            Model::Course(drive) => drive.model().step_s(),
        }
    }

    /// Strut displacement, m, compression positive.
    pub fn strut_displacement_m(&self) -> Corners<f64> {
        match &self.model {
            Model::Ride(model) => model.strut_displacement_m(),
            Model::Course(drive) => drive.model().strut_displacement_m(),
        }
    }

    /// Force and pressures of the four struts.
    pub fn strut_output(&self) -> Corners<StrutOutput> {
        match &self.model {
            Model::Ride(model) => model.strut_output(),
            Model::Course(drive) => drive.model().strut_output(),
        }
    }

    /// How the vehicle moves now.
    pub fn motion(&self) -> Motion {
        match &self.model {
            Model::Ride(model) => Motion {
                station_m: model.station_m() - self.behind_front_axle_m,
                body: model.body(),
                wheel: model.wheels().map(|wheel| Wheel {
                    load_n: wheel.force_n,
                    road_height_m: wheel.road_height_m,
                }),
                course: None,
            },
            Model::Course(drive) => {
                let (model, motion) = (drive.model(), drive.model().motion());
                let [roll_rate, pitch_rate, _] = motion.rates_rad_s;
                let [roll_acceleration, pitch_acceleration, _] = motion.angular_acceleration_rad_s2;
                Motion {
                    station_m: motion.position_m[0],
                    body: BodyMotion {
                        heave_m: motion.position_m[2],
                        roll_rad: motion.roll_rad,
                        pitch_rad: motion.pitch_rad,
                        heave_rate_m_s: motion.velocity_m_s[2],
                        roll_rate_rad_s: roll_rate,
                        pitch_rate_rad_s: pitch_rate,
                        heave_acceleration_m_s2: motion.vertical_acceleration_m_s2,
                        roll_acceleration_rad_s2: roll_acceleration,
                        pitch_acceleration_rad_s2: pitch_acceleration,
                    },
                    wheel: model.wheels().map(|wheel| Wheel {
                        load_n: wheel.load_n,
                        road_height_m: wheel.road_height_m,
                    }),
                    course: Some(CourseMotion {
                        body: motion,
                        steer_rad: model.steer_rad(),
                        path_deviation_m: drive.path_deviation_m(),
                        cone_margin_m: drive.cone_margin_m(),
                        phase: drive.phase(),
                    }),
                }
            }
        }
    }

    /// Drives for a tick under switching signals. After each integration step `felt` gets the vertical acceleration at the driver's and
    /// at the passenger's seat, m/s2, and the struts if they are recorded.
    ///
    /// # Errors
    /// The handling model's motion is not finite.
    pub fn drive(
        &mut self,
        signals: Signals,
        mut felt: impl FnMut([f64; 2], Option<StrutStep>),
    ) -> Result<(), NotFinite> {
        let Seats { driver, passenger } = self.seats;
        match &mut self.model {
            Model::Ride(model) => {
                for _ in 0..self.steps_per_tick {
                    model.step(signals);
                    let struts = self.records_struts.then(|| StrutStep {
                        displacement_m: model.strut_displacement_m(),
                        strut: model.strut_output(),
                    });
                    felt(
                        [driver, passenger].map(|[x, y, _]| model.vertical_acceleration_at(x, y)),
                        struts,
                    );
                }
                Ok(())
            }
            Model::Course(drive) => drive.tick(signals, |model| {
                let struts = self.records_struts.then(|| StrutStep {
                    displacement_m: model.strut_displacement_m(),
                    strut: model.strut_output(),
                });
                felt(
                    [driver, passenger].map(|place| model.acceleration_at(place).vertical_m_s2),
                    struts,
                );
            }),
        }
    }

    /// How the course has ended, if it has.
    pub fn ending(&self) -> Option<Ending> {
        match &self.model {
            Model::Ride(_) => None,
            Model::Course(drive) => drive.ending(),
        }
    }

    /// The line that the driver follows, with its cones.
    pub fn track(&self) -> Option<&Track> {
        match &self.model {
            Model::Ride(_) => None,
            Model::Course(drive) => Some(drive.track()),
        }
    }
}
