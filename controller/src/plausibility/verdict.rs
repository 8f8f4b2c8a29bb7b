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

    /// These causes, and those of later checks where there is none.
    pub fn or(&self, later: &Self) -> Self {
        self.select(self, later)
    }

    /// For each reading, one of two causes: `faulty` where this names a cause, `good` where it names none.
    pub fn select(&self, faulty: &Self, good: &Self) -> Self {
        let choose = |fault, faulty, good| if fault == FaultCode::None { good } else { faulty };
        let pressure = self.pressure.zip(faulty.pressure).zip(good.pressure);
        Self {
            displacement: choose(self.displacement, faulty.displacement, good.displacement),
            pressure: pressure.map(|((fault, faulty), good)| choose(fault, faulty, good)),
        }
    }
}

/// Notes a cause, unless an earlier check has found one.
pub fn blame(verdict: &mut FaultCode, cause: FaultCode) {
    if *verdict == FaultCode::None {
        *verdict = cause;
    }
}
