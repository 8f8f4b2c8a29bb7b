//! The faults that the checks found in the readings of one strut.

use oleo_interface::StrutPressures;

use crate::failsafe::FaultCode;

/// A cause for each reading of a strut, [`FaultCode::None`] for a good one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Verdicts {
    pub displacement: FaultCode,
    pub pressure: StrutPressures<FaultCode>,
}

impl Verdicts {
    /// The causes of all five readings.
    pub fn all(&self) -> impl Iterator<Item = FaultCode> {
        core::iter::once(self.displacement).chain(self.pressure.into_array())
    }
}

/// Notes a cause, unless an earlier check has found one.
pub fn blame(verdict: &mut FaultCode, cause: FaultCode) {
    if *verdict == FaultCode::None {
        *verdict = cause;
    }
}
