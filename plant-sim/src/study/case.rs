//! One combination of springs and dampers, and the results of driving with it.
//!
//! Ride: Belgian block at 60 km/h for 20 s, straight ahead. Handling: the severe double lane change of ISO 3888-1 at 60 km/h.
//! Both with the handling model, as the report did both with DADS (section 3.2).

use std::sync::Arc;

use oleo_interface::{Axles, Corner, Corners};

use super::element::GasElement;
use crate::course::{Course, Drive, DriverStyle, Ending, LaneChange, Manoeuvre, NotFinite, Run};
use crate::handling::HandlingParameters;
use crate::measures::SeatMeter;
use crate::road::{Flat, Road, RoadError};
use crate::strut::StrutModel;
use crate::vehicle::{RideError, Seats, VehicleParameters};

/// How far the vehicle drives straight ahead before the first cones, m.
const ENTRY_M: f64 = 25.0;

/// Static gas volumes and damper factors of front and rear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Static gas volume, m3.
    pub gas_volume_m3: Axles<f64>,
    /// Factor on the damper force of the vehicle as sold.
    pub damper_factor: Axles<f64>,
}

impl Case {
    /// The same front and rear.
    pub fn alike(gas_volume_m3: f64, damper_factor: f64) -> Self {
        Self {
            gas_volume_m3: Axles::new(gas_volume_m3, gas_volume_m3),
            damper_factor: Axles::new(damper_factor, damper_factor),
        }
    }

    /// The four numbers: gas volumes front and rear, damper factors front and rear.
    pub(super) fn numbers(&self) -> [f64; 4] {
        let ([volume_f, volume_r], [factor_f, factor_r]) =
            (self.gas_volume_m3.into_array(), self.damper_factor.into_array());
        [volume_f, volume_r, factor_f, factor_r]
    }
}

/// How the study drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Speed over the rough road, m/s.
    pub ride_speed_m_s: f64,
    /// Time on it, s.
    pub ride_duration_s: f64,
    /// Time at its beginning that does not count, s.
    pub ride_settling_s: f64,
    /// Phases of the Belgian block.
    pub seed: u64,
    /// Speed in the lane change, m/s.
    pub lane_change_speed_m_s: f64,
    /// Who drives the lane change.
    pub driver: DriverStyle,
    /// Polytropic exponent of the gas.
    pub polytropic_exponent: f64,
}

impl Default for Conditions {
    fn default() -> Self {
        Self {
            ride_speed_m_s: 60.0 / 3.6,
            ride_duration_s: 20.0,
            ride_settling_s: 1.0,
            seed: 1,
            lane_change_speed_m_s: 60.0 / 3.6,
            driver: DriverStyle::Eased,
            polytropic_exponent: 1.4,
        }
    }
}

/// What the rough road says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ride {
    /// BS 6841 weighted RMS at the driver, m/s2.
    pub driver_rms_m_s2: f64,
    /// And at the left rear passenger, m/s2.
    pub passenger_rms_m_s2: f64,
    /// BS 6841 motion sickness dose at the driver, m/s^1.5.
    pub driver_msdv_m_s1_5: f64,
    /// And at the passenger, m/s^1.5.
    pub passenger_msdv_m_s1_5: f64,
    /// The vehicle stayed on the road to the end.
    pub completed: bool,
}

impl Ride {
    /// Mean of both seats, m/s2.
    pub fn mean_rms_m_s2(&self) -> f64 {
        0.5 * (self.driver_rms_m_s2 + self.passenger_rms_m_s2)
    }

    /// Mean of both seats, m/s^1.5.
    pub fn mean_msdv_m_s1_5(&self) -> f64 {
        0.5 * (self.driver_msdv_m_s1_5 + self.passenger_msdv_m_s1_5)
    }
}

/// What the lane change says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Handling {
    /// Largest body roll, rad.
    pub max_roll_rad: f64,
    /// Largest lateral acceleration, m/s2.
    pub max_lateral_m_s2: f64,
    /// Smallest clearance to the cones, m; negative if one was hit.
    pub cone_margin_m: f64,
    /// Rolled over, spun or left the track: a gap in the surface.
    pub completed: bool,
    /// Whether the vehicle rolled over.
    pub rolled_over: bool,
}

/// A run that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// Vehicle and springs do not fit.
    #[error(transparent)]
    Vehicle(#[from] RideError),
    /// The model left the real numbers.
    #[error(transparent)]
    NotFinite(#[from] NotFinite),
    /// The road cannot be made.
    #[error(transparent)]
    Road(#[from] RoadError),
}

/// Everything a run needs that is the same for all cases.
pub struct Bench {
    /// Parameters of the vehicle.
    pub parameters: VehicleParameters,
    /// Handling parameters of the vehicle.
    pub handling: HandlingParameters,
    /// How it is driven.
    pub conditions: Conditions,
    rough: Arc<dyn Road>,
}

impl Bench {
    /// Makes the roads.
    ///
    /// # Errors
    /// A road of impossible length.
    pub fn new(
        parameters: VehicleParameters,
        handling: HandlingParameters,
        conditions: Conditions,
    ) -> Result<Self, RoadError> {
        let length_m = conditions.ride_speed_m_s * conditions.ride_duration_s + 50.0;
        let rough = Arc::new(crate::road::belgian::belgian_block(length_m, conditions.seed)?);
        Ok(Self {
            parameters,
            handling,
            conditions,
            rough,
        })
    }

    fn begin(&self, case: &Case, manoeuvre: Manoeuvre, road: Arc<dyn Road>) -> Result<Drive<GasElement>, RideError> {
        let p = &self.parameters;
        let load = p.static_strut_load_n();
        let area_m2 = StrutModel::defender110(load[Corner::FrontLeft]).piston_area_m2();
        let elements = Corners::from_fn(|corner| {
            let axle = corner.axle();
            GasElement::new(
                p.baseline(axle),
                load[corner],
                area_m2,
                case.gas_volume_m3[axle],
                self.conditions.polytropic_exponent,
                case.damper_factor[axle],
            )
        });
        let course = Course {
            manoeuvre,
            driver: self.conditions.driver,
            road,
        };
        Drive::begin(&course, p, &self.handling, elements)
    }

    /// Drives over the rough road.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn ride(&self, case: &Case) -> Result<Ride, StudyError> {
        let manoeuvre = Manoeuvre::Straight {
            speed_m_s: self.conditions.ride_speed_m_s,
            duration_s: self.conditions.ride_duration_s,
        };
        let drive = self.begin(case, manoeuvre, Arc::clone(&self.rough))?;
        let places = drive.seat_places_m();
        let settling_s = self.conditions.ride_settling_s;
        let mut meters = Seats::from_fn(|_| SeatMeter::new(drive.model().step_s(), settling_s));
        let run = drive.to_end(
            |_| Default::default(),
            |model| {
                for (seat, meter) in meters.iter_mut() {
                    meter.add(model.acceleration_at(places[seat]));
                }
            },
        )?;
        let Seats { driver, passenger } = meters.map(|meter| meter.measures().vertical);
        Ok(Ride {
            driver_rms_m_s2: driver.weighted_rms_m_s2,
            passenger_rms_m_s2: passenger.weighted_rms_m_s2,
            driver_msdv_m_s1_5: driver.msdv_m_s1_5,
            passenger_msdv_m_s1_5: passenger.msdv_m_s1_5,
            completed: run.ending == Ending::Completed,
        })
    }

    /// Drives the lane change and keeps the whole run.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn lane_change(&self, case: &Case) -> Result<Run, StudyError> {
        let manoeuvre = Manoeuvre::LaneChange {
            kind: LaneChange::Severe,
            speed_m_s: self.conditions.lane_change_speed_m_s,
            entry_m: ENTRY_M,
            duration_s: None,
        };
        let drive = self.begin(case, manoeuvre, Arc::new(Flat))?;
        Ok(drive.to_end(|_| Default::default(), |_| {})?)
    }

    /// Drives the lane change.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn handling(&self, case: &Case) -> Result<Handling, StudyError> {
        let run = self.lane_change(case)?;
        Ok(Handling {
            max_roll_rad: run.max_roll_rad,
            max_lateral_m_s2: run.max_lateral_m_s2,
            cone_margin_m: run.cone_margin_m.unwrap_or(f64::NAN),
            completed: run.ending == Ending::Completed,
            rolled_over: matches!(run.ending, Ending::RolledOver(_)),
        })
    }
}
