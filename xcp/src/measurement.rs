//! The table of what can be measured: what the controller is told, what it estimates, and what it decides.
//!
//! One row is all that has to be written for another quantity. Its place follows from the rows before it, so a description file and a
//! slave that were made from different tables would disagree; [`identity`](crate::identity) tells them apart.

use oleo_controller::interface::{Corner, PressurePoint};
use oleo_controller::{Inputs, Outputs, Reading};

use crate::quantity::{Kind, Quantity};

/// Where the measured quantities begin.
pub const ADDRESS: u32 = 0x1000;

/// Copies of what a tick was told and what it decided.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Number of the controller's tick.
    pub tick: u32,
    /// Tick of the plant, modulo 256, of which the displacements are.
    pub plant_tick: u8,
    /// What the controller was told.
    pub inputs: &'a Inputs,
    /// What it decided.
    pub outputs: &'a Outputs,
    /// Whether a new tuning may take effect now; the controller's node says so.
    pub writable: bool,
}

/// A value of one of the kinds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Value {
    U8(u8),
    U16(u16),
    U32(u32),
    F32(f32),
}

impl Value {
    const fn to_bytes(self) -> ([u8; 4], usize) {
        match self {
            Self::U8(value) => ([value, 0, 0, 0], 1),
            Self::U16(value) => {
                let [a, b] = value.to_le_bytes();
                ([a, b, 0, 0], 2)
            }
            Self::U32(value) => (value.to_le_bytes(), 4),
            Self::F32(value) => (value.to_le_bytes(), 4),
        }
    }
}

/// A row of the table.
struct Row {
    name: &'static str,
    description: &'static str,
    unit: &'static str,
    kind: Kind,
    range: (f32, f32),
    names: &'static [&'static str],
    value: fn(&Sample) -> Value,
}

fn reading(reading: Reading) -> Value {
    Value::F32(reading.value().unwrap_or(f32::NAN))
}

fn pressure(sample: &Sample, corner: Corner, point: PressurePoint) -> Value {
    reading(sample.inputs.pressure[corner].into_array()[point.index()])
}

const fn row(
    name: &'static str,
    description: &'static str,
    unit: &'static str,
    (kind, range): (Kind, (f32, f32)),
    value: fn(&Sample) -> Value,
) -> Row {
    Row {
        name,
        description,
        unit,
        kind,
        range,
        names: &[],
        value,
    }
}

const fn named(
    name: &'static str,
    description: &'static str,
    names: &'static [&'static str],
    value: fn(&Sample) -> Value,
) -> Row {
    Row {
        names,
        ..row(name, description, "", (Kind::U8, (0.0, 255.0)), value)
    }
}

const fn number(
    name: &'static str,
    description: &'static str,
    unit: &'static str,
    largest: f32,
    value: fn(&Sample) -> Value,
) -> Row {
    row(name, description, unit, (Kind::F32, (-largest, largest)), value)
}

/// The rows that each corner has.
macro_rules! rows_of_corner {
    ($corner:ident, $key:literal, $words:literal) => {
        [
            row(
                concat!("displacement_", $key, "_m"),
                concat!(
                    "Displacement of the ",
                    $words,
                    " strut as received, compression positive"
                ),
                "m",
                (Kind::F32, (-0.25, 0.25)),
                |sample| reading(sample.inputs.displacement[Corner::$corner]),
            ),
            row(
                concat!("p1_", $key, "_Pa"),
                concat!("Gauge pressure p1 of the ", $words, " strut as received"),
                "Pa",
                (Kind::F32, (-5.0e6, 35.0e6)),
                |sample| pressure(sample, Corner::$corner, PressurePoint::P1),
            ),
            row(
                concat!("p2_", $key, "_Pa"),
                concat!("Gauge pressure p2 of the ", $words, " strut as received"),
                "Pa",
                (Kind::F32, (-5.0e6, 35.0e6)),
                |sample| pressure(sample, Corner::$corner, PressurePoint::P2),
            ),
            row(
                concat!("p3_", $key, "_Pa"),
                concat!("Gauge pressure p3 of the ", $words, " strut as received"),
                "Pa",
                (Kind::F32, (-5.0e6, 35.0e6)),
                |sample| pressure(sample, Corner::$corner, PressurePoint::P3),
            ),
            row(
                concat!("p4_", $key, "_Pa"),
                concat!("Gauge pressure p4 of the ", $words, " strut as received"),
                "Pa",
                (Kind::F32, (-5.0e6, 35.0e6)),
                |sample| pressure(sample, Corner::$corner, PressurePoint::P4),
            ),
            number(
                concat!("strut_speed_", $key, "_m_s"),
                concat!("Estimated speed of the ", $words, " strut, compression positive"),
                "m/s",
                10.0,
                |sample| Value::F32(sample.outputs.estimate.strut_speed_m_s[Corner::$corner]),
            ),
            row(
                concat!("static_load_", $key, "_N"),
                concat!("Estimated static load on the ", $words, " strut"),
                "N",
                (Kind::F32, (0.0, 1.0e5)),
                |sample| Value::F32(sample.outputs.estimate.static_load_n[Corner::$corner]),
            ),
            number(
                concat!("trapped_shift_", $key, "_m"),
                concat!(
                    "Shift of the ride height of the ",
                    $words,
                    " corner by trapped oil, lower positive"
                ),
                "m",
                0.3,
                |sample| Value::F32(sample.outputs.trapped_shift_m[Corner::$corner]),
            ),
        ]
    };
}

const COMMON: [Row; 19] = [
    row(
        "tick",
        "Number of the controller's tick",
        "",
        (Kind::U32, (0.0, 4_294_967_040.0)),
        |sample| Value::U32(sample.tick),
    ),
    row(
        "plant_tick",
        "Tick of the plant modulo 256, of which the displacements are",
        "",
        (Kind::U8, (0.0, 255.0)),
        |sample| Value::U8(sample.plant_tick),
    ),
    named("mode", "Mode of the controller", &MODES, |sample| {
        Value::U8(sample.outputs.mode as u8)
    }),
    named("fault", "First cause of a mode other than normal", &FAULTS, |sample| {
        Value::U8(sample.outputs.fault.raw())
    }),
    named(
        "handling",
        "Whether the strategy is in handling mode",
        &NO_YES,
        |sample| Value::U8(sample.outputs.handling.into()),
    ),
    named(
        "rollover_guard",
        "Whether the roll-over guard is active",
        &NO_YES,
        |sample| Value::U8(sample.outputs.rollover_guard.into()),
    ),
    row(
        "invalid_readings",
        "Number of readings that may not be used at present",
        "",
        (Kind::U8, (0.0, 20.0)),
        |sample| Value::U8(sample.outputs.invalid_readings),
    ),
    row(
        "valve_word",
        "Commanded valves: bit 3 * corner + valve, 1 open",
        "",
        (Kind::U16, (0.0, 4095.0)),
        |sample| Value::U16(sample.outputs.command.word()),
    ),
    number(
        "heave_m",
        "Heave of the body relative to the axles, up positive",
        "m",
        0.5,
        |sample| Value::F32(sample.outputs.estimate.heave_m),
    ),
    number(
        "roll_rad",
        "Roll of the body relative to the axles, right side down positive",
        "rad",
        1.0,
        |sample| Value::F32(sample.outputs.estimate.roll_rad),
    ),
    number(
        "pitch_rad",
        "Pitch of the body relative to the axles, nose down positive",
        "rad",
        1.0,
        |sample| Value::F32(sample.outputs.estimate.pitch_rad),
    ),
    number("roll_rate_rad_s", "Rate of the roll", "rad/s", 20.0, |sample| {
        Value::F32(sample.outputs.estimate.roll_rate_rad_s)
    }),
    number(
        "vertical_acceleration_m_s2",
        "Vertical acceleration of the body, up positive",
        "m/s2",
        100.0,
        |sample| Value::F32(sample.outputs.estimate.vertical_acceleration_m_s2),
    ),
    number(
        "roll_acceleration_rad_s2",
        "Roll acceleration of the body",
        "rad/s2",
        200.0,
        |sample| Value::F32(sample.outputs.estimate.roll_acceleration_rad_s2),
    ),
    number(
        "pitch_acceleration_rad_s2",
        "Pitch acceleration of the body",
        "rad/s2",
        200.0,
        |sample| Value::F32(sample.outputs.estimate.pitch_acceleration_rad_s2),
    ),
    number(
        "lateral_acceleration_quick_m_s2",
        "Lateral acceleration behind the quick filter, left positive",
        "m/s2",
        30.0,
        |sample| Value::F32(sample.outputs.estimate.lateral.acceleration_m_s2.quick),
    ),
    number(
        "lateral_acceleration_slow_m_s2",
        "Lateral acceleration behind the slow filter, left positive",
        "m/s2",
        30.0,
        |sample| Value::F32(sample.outputs.estimate.lateral.acceleration_m_s2.slow),
    ),
    row(
        "lateral_mean_square_m2_s4",
        "Running mean square of the lateral acceleration",
        "m2/s4",
        (Kind::F32, (0.0, 1.0e3)),
        |sample| Value::F32(sample.outputs.estimate.lateral_mean_square),
    ),
    row(
        "vertical_mean_square_m2_s4",
        "Running mean square of the vertical acceleration",
        "m2/s4",
        (Kind::F32, (0.0, 1.0e4)),
        |sample| Value::F32(sample.outputs.estimate.vertical_mean_square),
    ),
];

const MODES: [&str; 5] = ["start-up", "normal", "degraded", "safe", "latched"];
const FAULTS: [&str; 12] = [
    "none",
    "sensor-range",
    "sensor-rate",
    "sensor-stuck",
    "sensor-vote",
    "oil-balance",
    "valve-stuck",
    "message-lost",
    "bus-silent",
    "foreign-sender",
    "solenoid",
    "internal",
];
const NO_YES: [&str; 2] = ["no", "yes"];

const FRONT_LEFT: [Row; 8] = rows_of_corner!(FrontLeft, "front_left", "front left");
const FRONT_RIGHT: [Row; 8] = rows_of_corner!(FrontRight, "front_right", "front right");
const REAR_LEFT: [Row; 8] = rows_of_corner!(RearLeft, "rear_left", "rear left");
const REAR_RIGHT: [Row; 8] = rows_of_corner!(RearRight, "rear_right", "rear right");

/// Parts of the table, in the order of their places.
const PARTS: [&[Row]; 5] = [&COMMON, &FRONT_LEFT, &FRONT_RIGHT, &REAR_LEFT, &REAR_RIGHT];

/// Number of bytes of all measured quantities.
pub const BYTES: usize = {
    let (mut bytes, mut part) = (0, 0);
    while part < PARTS.len() {
        let mut i = 0;
        while i < PARTS[part].len() {
            bytes += PARTS[part][i].kind.bytes();
            i += 1;
        }
        part += 1;
    }
    bytes
};

/// All measured quantities, in the order of their addresses.
///
/// ```
/// use oleo_xcp::measurement;
/// let last = measurement::quantities().last().unwrap();
/// assert_eq!(last.name, "trapped_shift_rear_right_m");
/// assert_eq!(last.address as usize + 4, measurement::ADDRESS as usize + measurement::BYTES);
/// ```
pub fn quantities() -> impl Iterator<Item = Quantity> {
    PARTS.iter().copied().flatten().scan(ADDRESS, |next, row| {
        let address = *next;
        *next += row.kind.bytes() as u32;
        Some(Quantity {
            name: row.name,
            description: row.description,
            unit: row.unit,
            kind: row.kind,
            address,
            range: row.range,
            names: row.names,
        })
    })
}

/// The measured quantities of one tick as a tool reads them.
#[derive(Clone, Debug)]
pub struct Image([u8; BYTES]);

impl Image {
    /// Before the first tick.
    pub const INITIAL: Self = Self([0; BYTES]);

    /// Takes over what a tick was told and decided.
    pub fn update(&mut self, sample: &Sample) {
        let mut rest = self.0.as_mut_slice();
        for row in PARTS.iter().copied().flatten() {
            let (bytes, length) = (row.value)(sample).to_bytes();
            let Some((place, after)) = rest.split_at_mut_checked(length) else {
                return;
            };
            for (to, from) in place.iter_mut().zip(bytes) {
                *to = from;
            }
            rest = after;
        }
    }

    /// The bytes from [`ADDRESS`] on.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use oleo_controller::{Corners, FaultCode, Gauge, Mode, StrutPressures, ValveCommand};
    use std::collections::BTreeSet;
    use std::vec::Vec;

    fn sampled(change: impl FnOnce(&mut Inputs, &mut Outputs)) -> Image {
        let pressure = Corners::splat(StrutPressures::splat(Gauge(2.0e6)));
        let mut inputs = Inputs::from_values(Corners::splat(0.01), pressure);
        let mut outputs = Outputs::default();
        change(&mut inputs, &mut outputs);
        let mut image = Image::INITIAL;
        image.update(&Sample {
            tick: 0x0102_0304,
            plant_tick: 0x55,
            inputs: &inputs,
            outputs: &outputs,
            writable: false,
        });
        image
    }

    fn of<'a>(image: &'a Image, name: &str) -> &'a [u8] {
        let quantity = quantities().find(|quantity| quantity.name == name).unwrap();
        let at = (quantity.address - ADDRESS) as usize;
        &image.bytes()[at..at + quantity.kind.bytes()]
    }

    #[test]
    fn each_value_is_at_its_address_in_its_kind() {
        let image = sampled(|inputs, outputs| {
            inputs.displacement[Corner::RearLeft] = Reading::new(-0.125);
            inputs.pressure[Corner::FrontRight].p3 = Reading::new(3.5e6);
            outputs.command = ValveCommand::from_word(0x0A5F);
            outputs.mode = Mode::Degraded;
            outputs.fault = FaultCode::OilBalance;
            outputs.estimate.static_load_n[Corner::RearRight] = 4321.0;
        });
        assert_eq!(of(&image, "tick"), [4, 3, 2, 1]);
        assert_eq!(of(&image, "plant_tick"), [0x55]);
        assert_eq!(of(&image, "valve_word"), [0x5F, 0x0A]);
        assert_eq!(of(&image, "mode"), [2]);
        assert_eq!(of(&image, "fault"), [5]);
        assert_eq!(of(&image, "displacement_rear_left_m"), (-0.125_f32).to_le_bytes());
        assert_eq!(of(&image, "p3_front_right_Pa"), 3.5e6_f32.to_le_bytes());
        assert_eq!(of(&image, "static_load_rear_right_N"), 4321.0_f32.to_le_bytes());
    }

    #[test]
    fn what_is_not_valid_is_not_a_number() {
        let image = sampled(|inputs, _| inputs.displacement[Corner::FrontLeft] = Reading::INVALID);
        let bytes = of(&image, "displacement_front_left_m").try_into().unwrap();
        assert!(f32::from_le_bytes(bytes).is_nan());
    }

    #[test]
    fn kinds_and_values_agree_and_names_are_unique() {
        let (inputs, outputs) = (Inputs::default(), Outputs::default());
        let sample = Sample {
            tick: 0,
            plant_tick: 0,
            inputs: &inputs,
            outputs: &outputs,
            writable: false,
        };
        let rows: Vec<_> = PARTS.iter().copied().flatten().collect();
        for row in &rows {
            assert_eq!((row.value)(&sample).to_bytes().1, row.kind.bytes(), "{}", row.name);
        }
        let names: BTreeSet<_> = rows.iter().map(|row| row.name).collect();
        assert_eq!(names.len(), rows.len());
    }

    #[test]
    fn enumerations_have_the_names_of_the_controller() {
        for mode in [Mode::StartUp, Mode::Normal, Mode::Degraded, Mode::Safe, Mode::Latched] {
            assert_eq!(MODES[mode as usize], mode.name());
        }
        assert_eq!(
            FAULTS[usize::from(FaultCode::Internal.raw())],
            FaultCode::Internal.name()
        );
        assert_eq!(
            FAULTS[usize::from(FaultCode::OilBalance.raw())],
            FaultCode::OilBalance.name()
        );
    }
}
