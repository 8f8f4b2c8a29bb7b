//! The table of what can be calibrated: the tuning of the controller.
//!
//! The description of the vehicle and the limits of the plausibility checks are not in it: what the fail-safe relies on cannot be
//! changed by a tool. A tool always may read these values. It may write only in a build with the feature `calibration`, where the
//! caller asks for it ([`Slave::writable`](crate::Slave)), and then under the rule of `Working::write`:
//!
//! 1. one whole value at a time, at its address;
//! 2. the tuning with it passes [`Builder::build`], the same check as that of every other source, or nothing is changed;
//! 3. all valves have been closed for as long as the slowest valve needs and the strategy is not handling a bend, so that the new value
//!    meets a vehicle in the safe state ([`Sample::writable`](crate::Sample)).
//!
//! A pair of thresholds is written one after the other, and the pair has to be right after each: raise the upper one first.

use oleo_controller::Builder;

use crate::quantity::{Kind, Quantity};

/// Where the parameters begin.
pub const ADDRESS: u32 = 0x2000;

/// Bytes of a parameter: all are numbers in single precision.
pub const VALUE_BYTES: usize = 4;

/// A row of the table.
struct Row {
    name: &'static str,
    description: &'static str,
    unit: &'static str,
    value: fn(&mut Builder) -> &mut f32,
    /// For the lower one of two thresholds, the upper one.
    upper: Option<fn(&mut Builder) -> &mut f32>,
}

/// A parameter at a path below `tuning`, which is also its name.
macro_rules! parameter {
    ($($path:ident).+, $unit:literal, $description:literal) => {
        Row {
            name: concat!("tuning", $(".", stringify!($path)),+),
            description: $description,
            unit: $unit,
            value: |builder| &mut builder.tuning$(.$path)+,
            upper: None,
        }
    };
}

/// The lower one of the two thresholds at a path.
macro_rules! end_of {
    ($($path:ident).+, $unit:literal, $description:literal) => {
        Row {
            name: concat!("tuning", $(".", stringify!($path)),+, ".end"),
            description: $description,
            unit: $unit,
            value: |builder| &mut builder.tuning$(.$path)+.end,
            upper: Some(|builder| &mut builder.tuning$(.$path)+.begin),
        }
    };
}

const ROWS: [Row; COUNT] = [
    parameter!(
        estimate.lateral.corner_hz,
        "Hz",
        "Corner frequency of the low-pass of the lateral acceleration"
    ),
    parameter!(
        estimate.lateral.smoothed_share,
        "",
        "Share of the smoothed sum in the quick estimate of lateral acceleration"
    ),
    parameter!(
        estimate.lateral.dragged_share,
        "",
        "How much of the mean of the correction for the axles' roll is added to the quick estimate of lateral acceleration"
    ),
    parameter!(estimate.running_rms_s, "s", "Time constant of the running mean squares"),
    parameter!(
        spring.trapped_shift_m,
        "m",
        "Largest shift of the ride height that closing valve 3 may trap"
    ),
    parameter!(
        spring.opening_step_share,
        "",
        "Largest force step on opening valve 3, as a fraction of the static load"
    ),
    parameter!(
        strategy.road_and_cornering.rough_m_s2.begin,
        "m/s2",
        "Running RMS of the vertical acceleration at which a smooth road begins to count as rough"
    ),
    end_of!(
        strategy.road_and_cornering.rough_m_s2,
        "m/s2",
        "Running RMS of the vertical acceleration at which a rough road begins to count as smooth"
    ),
    parameter!(
        strategy.road_and_cornering.heave_m_s2.begin,
        "m/s2",
        "Running RMS of the heave at which damper 1 begins to be high"
    ),
    end_of!(
        strategy.road_and_cornering.heave_m_s2,
        "m/s2",
        "Running RMS of the heave at which damper 1 is low again"
    ),
    parameter!(
        strategy.road_and_cornering.cornering.floor_m_s2,
        "m/s2",
        "Lateral acceleration that counts as cornering on a road that makes no error"
    ),
    parameter!(
        strategy.road_and_cornering.cornering.witness_multiple,
        "",
        "Multiple of the running RMS of the witness, where the estimate is corrected"
    ),
    parameter!(
        strategy.road_and_cornering.cornering.plain_witness_multiple,
        "",
        "Multiple of the running RMS of the witness, where the estimate is not corrected"
    ),
    parameter!(
        strategy.road_and_cornering.cornering.own_multiple,
        "",
        "Multiple of the running RMS of the quick estimate itself"
    ),
    parameter!(
        strategy.road_and_cornering.cornering.release_share,
        "",
        "Part of the bound below which the vehicle corners no longer"
    ),
    parameter!(
        strategy.road_and_cornering.rollover_guard.roll_rad.begin,
        "rad",
        "Predicted roll angle above which the roll-over guard acts"
    ),
    end_of!(
        strategy.road_and_cornering.rollover_guard.roll_rad,
        "rad",
        "Roll angle below which the roll-over guard lets go"
    ),
    parameter!(
        strategy.road_and_cornering.rollover_guard.lateral_m_s2,
        "m/s2",
        "Lateral acceleration above which the roll-over guard acts"
    ),
];

/// Number of parameters.
pub const COUNT: usize = 18;

/// Number of bytes of all parameters.
pub const BYTES: usize = COUNT * VALUE_BYTES;

/// All parameters, in the order of their addresses. The ranges are those of the controller's own check.
///
/// ```
/// use oleo_xcp::calibration;
/// let first = calibration::quantities().next().unwrap();
/// assert_eq!(first.name, "tuning.estimate.lateral.corner_hz");
/// assert_eq!((first.address, first.range), (0x2000, (0.1, 5.0)));
/// ```
pub fn quantities() -> impl Iterator<Item = Quantity> {
    ROWS.iter()
        .zip((ADDRESS..).step_by(VALUE_BYTES))
        .map(|(row, address)| Quantity {
            name: row.name,
            description: row.description,
            unit: row.unit,
            kind: Kind::F32,
            address,
            range: range(row),
            names: &[],
        })
}

/// The range that the controller's check states when it refuses what is no number.
fn range(row: &Row) -> (f32, f32) {
    let mut builder = Builder::default();
    let refused_range = |builder: &mut Builder, value: fn(&mut Builder) -> &mut f32| {
        let before = core::mem::replace(value(builder), f32::NAN);
        let range = builder.build().err().map(|error| error.range);
        *value(builder) = before;
        range
    };
    // The lower threshold may be as large as the upper one, which may be as large as its own range permits.
    if let Some(upper) = row.upper
        && let Some((_, most)) = refused_range(&mut builder, upper)
    {
        *upper(&mut builder) = most;
    }
    refused_range(&mut builder, row.value).unwrap_or((f32::MIN, f32::MAX))
}

/// The tuning that is in use, and the bytes by which a tool reads it.
#[derive(Clone, Debug)]
pub(crate) struct Working {
    #[cfg(feature = "calibration")]
    builder: Builder,
    image: [u8; BYTES],
}

impl Working {
    pub fn new(builder: Builder) -> Self {
        Self {
            image: image(builder),
            #[cfg(feature = "calibration")]
            builder,
        }
    }

    /// The bytes from [`ADDRESS`] on.
    pub fn bytes(&self) -> &[u8] {
        &self.image
    }

    /// Takes over one whole value if the tuning with it is permitted. Returns the configuration that follows.
    #[cfg(feature = "calibration")]
    pub fn write(
        &mut self,
        address: u32,
        bytes: &[u8],
    ) -> Result<oleo_controller::Configuration, crate::packet::Refusal> {
        use crate::packet::Refusal;
        let offset = address.checked_sub(ADDRESS).ok_or(Refusal::AccessDenied)? as usize;
        let row = ROWS.get(offset / VALUE_BYTES).ok_or(Refusal::AccessDenied)?;
        let whole = <[u8; VALUE_BYTES]>::try_from(bytes)
            .ok()
            .filter(|_| offset.is_multiple_of(VALUE_BYTES));
        let mut changed = self.builder;
        *(row.value)(&mut changed) = f32::from_le_bytes(whole.ok_or(Refusal::AccessDenied)?);
        let configuration = changed.build().map_err(|_| Refusal::OutOfRange)?;
        *self = Self::new(changed);
        Ok(configuration)
    }
}

fn image(mut builder: Builder) -> [u8; BYTES] {
    let mut image = [0; BYTES];
    for (place, row) in image.chunks_exact_mut(VALUE_BYTES).zip(&ROWS) {
        for (to, from) in place.iter_mut().zip((row.value)(&mut builder).to_le_bytes()) {
            *to = from;
        }
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each row reaches the value that it names: the controller's own error says which one was wrong.
    #[test]
    fn every_row_reaches_the_value_that_it_names() {
        for row in &ROWS {
            let mut builder = Builder::default();
            *(row.value)(&mut builder) = f32::NAN;
            let error = builder.build().unwrap_err();
            assert!(row.name.starts_with(error.name), "{} is not {}", row.name, error.name);
        }
    }

    #[test]
    fn ranges_are_those_of_the_controller() {
        let range = |name: &str| quantities().find(|quantity| quantity.name == name).unwrap().range;
        assert_eq!(range("tuning.spring.trapped_shift_m"), (1e-4, 0.1));
        assert_eq!(
            range("tuning.strategy.road_and_cornering.rough_m_s2.begin"),
            (0.01, 10.0)
        );
        assert_eq!(range("tuning.strategy.road_and_cornering.rough_m_s2.end"), (0.01, 10.0));
    }

    #[test]
    fn a_tool_reads_the_tuning_in_use() {
        let mut builder = Builder::default();
        builder.tuning.spring.trapped_shift_m = 0.0125;
        let working = Working::new(builder);
        let at = quantities().find(|quantity| quantity.name == "tuning.spring.trapped_shift_m");
        let at = (at.unwrap().address - ADDRESS) as usize;
        assert_eq!(working.bytes()[at..at + 4], 0.0125_f32.to_le_bytes());
    }

    extern crate std;
}
