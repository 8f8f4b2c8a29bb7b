//! What a log holds, piece by piece or whole, and the words for what was read of it.

use std::ops::ControlFlow;

use oleo_diagnose::vehicle::{Drive, InertialSamples, StrutSamples};
use oleo_hil::logs::Account;
use oleo_interface::{Corners, StrutValves};

/// A piece of the drives of a log, in the order of the log.
#[derive(Clone, Copy)]
pub enum Part<'a> {
    /// A drive begins.
    Begins {
        /// Time between two of its samples, s.
        period_s: f64,
        /// Whether the log has several drives, where this was asked for.
        of_several: bool,
    },
    /// The next sample of the drive.
    Sample(&'a VehicleSample),
}

/// Takes the drives of a log piece by piece, and may end the reading.
pub type PartSink<'a> = dyn FnMut(Part) -> ControlFlow<()> + 'a;

/// A sample of a vehicle.
#[derive(Clone, Copy)]
pub struct VehicleSample {
    /// The four struts.
    pub struts: Corners<StrutSample>,
    /// The inertial unit.
    pub inertial: InertialSample,
}

/// A sample of an inertial unit, in its own axes. What was not received is NaN.
#[derive(Clone, Copy)]
pub struct InertialSample {
    /// Specific force along x, y, z, m/s2.
    pub specific_force_m_s2: [f64; 3],
    /// Angular velocity about x, y, z, rad/s.
    pub rate_rad_s: [f64; 3],
}

/// A sample of one strut. What was not received is NaN or `None`.
#[derive(Clone, Copy)]
pub struct StrutSample {
    /// Displacement, m, compression positive.
    pub displacement_m: f64,
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [f64; 4],
    /// Switching signals that hold from this sample to the next.
    pub valves: Option<StrutValves<bool>>,
}

/// What a log holds.
pub struct VehicleLog {
    /// The drives in the order of the log, at least one.
    pub drives: Vec<Drive>,
    /// What was read, in one sentence.
    pub in_words: String,
}

/// Drives that are kept whole, because a diagnosis needs them so.
pub struct Collected {
    /// The name of the log.
    name: String,
    drives: Vec<Drive>,
}

impl Collected {
    /// No drive yet. The first will be named as the log is.
    pub fn new(name: String) -> Self {
        let drives = Vec::new();
        Self { name, drives }
    }

    /// Appends a piece.
    pub fn take(&mut self, part: Part) {
        let count = self.drives.len();
        match (part, self.drives.last_mut()) {
            (Part::Begins { period_s, .. }, _) => self.drives.push(Drive {
                name: match count {
                    0 => self.name.clone(),
                    _ => format!("{}, drive {}", self.name, count + 1),
                },
                is_first: count == 0,
                period_s,
                struts: Corners::from_fn(|_| StrutSamples {
                    displacement_m: Vec::new(),
                    pressure_pa: std::array::from_fn(|_| Vec::new()),
                    valves: Vec::new(),
                }),
                inertial: InertialSamples::default(),
            }),
            (Part::Sample(sample), Some(drive)) => {
                for (strut, sample) in drive.struts.values_mut().zip(sample.struts.values()) {
                    strut.displacement_m.push(sample.displacement_m);
                    for (series, value) in strut.pressure_pa.iter_mut().zip(sample.pressure_pa) {
                        series.push(value);
                    }
                    strut.valves.push(sample.valves);
                }
                let of_unit = (drive.inertial.specific_force_m_s2.iter_mut()).zip(sample.inertial.specific_force_m_s2);
                for (series, value) in
                    of_unit.chain(drive.inertial.rate_rad_s.iter_mut().zip(sample.inertial.rate_rad_s))
                {
                    series.push(value);
                }
            }
            (Part::Sample(_), None) => {}
        }
    }

    /// The drives of the whole log.
    pub fn into_drives(self) -> Vec<Drive> {
        self.drives
    }
}

/// The end of a word for several.
pub fn plural(n: usize) -> &'static str {
    if n == 1 { "" } else { "s" }
}

/// What else was in a log.
pub fn others(foreign_frames: u64, log: &Account) -> String {
    format!(
        "{foreign_frames} frames of other devices, {} error frames, {} unreadable entries",
        log.error_frames, log.unreadable
    )
}
