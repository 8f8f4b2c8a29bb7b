//! Fixed settings, with which the other strategies are compared.

use super::demand::{Decide, Demand, Urgency};
use crate::estimate::Estimate;
use crate::plausibility::Trusted;
use crate::range::ConfigurationError;
use crate::valves::ValveCommand;
use crate::vehicle::VehicleDescription;

/// All valves open: soft springs, low damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlwaysSoft;

impl Decide for AlwaysSoft {
    type Tuning = ();
    type State = ();
    const INITIAL: () = ();

    fn check(_: &()) -> Result<(), ConfigurationError> {
        Ok(())
    }

    fn new(_: &VehicleDescription, _: &()) -> Self {
        Self
    }

    fn step(&self, _: &mut (), _: &Estimate, _: &Trusted) -> Demand {
        Demand {
            valves: ValveCommand::SOFT,
            ..Demand::default()
        }
    }
}

/// All valves closed: stiff springs, high damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlwaysStiff;

impl Decide for AlwaysStiff {
    type Tuning = ();
    type State = ();
    const INITIAL: () = ();

    fn check(_: &()) -> Result<(), ConfigurationError> {
        Ok(())
    }

    fn new(_: &VehicleDescription, _: &()) -> Self {
        Self
    }

    fn step(&self, _: &mut (), _: &Estimate, _: &Trusted) -> Demand {
        Demand {
            valves: ValveCommand::SAFE,
            urgency: Urgency::Handling,
            handling: true,
            rollover_guard: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_the_scale() {
        let (estimate, trusted) = (Estimate::default(), Trusted::default());
        let soft = AlwaysSoft.step(&mut (), &estimate, &trusted);
        assert_eq!(
            (soft.valves, soft.urgency, soft.handling),
            (ValveCommand::SOFT, Urgency::Comfort, false)
        );
        let stiff = AlwaysStiff.step(&mut (), &estimate, &trusted);
        assert_eq!(
            (stiff.valves, stiff.urgency, stiff.handling),
            (ValveCommand::SAFE, Urgency::Handling, true)
        );
    }
}
