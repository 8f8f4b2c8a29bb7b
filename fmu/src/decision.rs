//! What a controller has decided, as variables: switching signals, mode and its cause, and what it estimates.

use oleo_controller::{Corner, Outputs, Valve};

use crate::model::switch;
use crate::variable::{Role, Variable, Word};

const VALVES: usize = 12;
/// Number of variables.
pub const SIZE: usize = VALVES + 9;

/// The words of [`Mode`], in the order of their numbers.
const MODES: [Word; 5] = [
    (
        "start-up",
        "waits for the first complete set of readings; all valves closed",
    ),
    ("normal", "the strategy sets all valves"),
    (
        "degraded",
        "readings of one axle are missing; springs stiff, the other axle's dampers follow the strategy",
    ),
    ("safe", "readings of both axles are missing; all valves closed"),
    ("latched", "all valves closed until a restart"),
];
/// The words of [`FaultCode`], in the order of their numbers.
const FAULTS: [Word; 12] = [
    ("none", "no fault"),
    ("sensor-range", "a reading is outside its range"),
    ("sensor-rate", "a reading changes faster than the hardware can move"),
    ("sensor-stuck", "a reading does not change while its neighbours do"),
    (
        "sensor-vote",
        "one pressure of a strut disagrees with the others at rest",
    ),
    ("oil-balance", "displacement and gas volumes of a strut disagree"),
    ("valve-stuck", "oil moves through a valve 3 that is commanded closed"),
    ("message-lost", "a sensor message is late or not trustworthy"),
    ("bus-silent", "no sensor message arrives any more"),
    ("foreign-sender", "somebody else sends commands"),
    ("solenoid", "a solenoid could not be switched"),
    (
        "internal",
        "the controller's own arithmetic gave something that is not finite",
    ),
];
/// The variables, in the order of their places.
pub fn variables() -> Vec<Variable> {
    let mut variables = Vec::with_capacity(SIZE);
    for corner in Corner::ALL {
        variables.extend(Valve::ALL.map(|valve| {
            let name = format!("valve{}_{}", valve.number(), corner.key());
            let what = format!(
                "switching signal of valve {} of the strut {}: true opens",
                valve.number(),
                corner.name()
            );
            Variable::switch(name, Role::Output, what)
        }));
    }
    variables.extend([
        Variable::word("mode", "Mode", &MODES, Role::Output, 0, "mode of the controller"),
        Variable::word(
            "fault",
            "Fault",
            &FAULTS,
            Role::Output,
            0,
            "first cause of a mode other than normal",
        ),
        Variable::switch(
            "handling",
            Role::Output,
            "the strategy is in handling mode: stiff springs and high damping",
        ),
        Variable::switch("rollover_guard", Role::Output, "the roll-over guard is active"),
        Variable::output(
            "invalid_readings",
            "",
            "number of readings that may not be used, 0 to 20",
        ),
        Variable::output(
            "roll_rad",
            "rad",
            "estimated roll of the body against the axles, right side down positive",
        ),
        Variable::output(
            "pitch_rad",
            "rad",
            "estimated pitch of the body against the axles, nose down positive",
        ),
        Variable::output(
            "vertical_acceleration_m_s2",
            "m/s2",
            "estimated vertical acceleration of the body, up positive",
        ),
        Variable::output(
            "lateral_acceleration_m_s2",
            "m/s2",
            "estimated lateral acceleration of the body, left positive",
        ),
    ]);
    debug_assert_eq!(variables.len(), SIZE);
    variables
}

/// Writes the values of the variables.
pub fn write(outputs: &Outputs, values: &mut [f64]) {
    let (signals, others) = values.split_at_mut(VALVES);
    for corner in Corner::ALL {
        for valve in Valve::ALL {
            signals[3 * corner.index() + valve.index()] = switch(outputs.command.is_open(corner, valve));
        }
    }
    let Outputs { estimate, .. } = outputs;
    others.copy_from_slice(&[
        f64::from(outputs.mode.raw()),
        f64::from(outputs.fault.raw()),
        switch(outputs.handling),
        switch(outputs.rollover_guard),
        f64::from(outputs.invalid_readings),
        f64::from(estimate.roll_rad),
        f64::from(estimate.pitch_rad),
        f64::from(estimate.vertical_acceleration_m_s2),
        f64::from(estimate.lateral.acceleration_m_s2.quick),
    ]);
}

#[cfg(test)]
mod tests {
    use oleo_controller::{FaultCode, Mode};
    use strum::VariantArray;

    use super::*;

    /// A word that is added to the controller is to be added here.
    #[test]
    fn the_words_are_those_of_the_controller() {
        let words = |list: &[Word]| list.iter().map(|word| word.0).collect::<Vec<_>>();
        let modes: Vec<&str> = Mode::VARIANTS.iter().map(|mode| mode.name()).collect();
        let faults: Vec<&str> = FaultCode::VARIANTS.iter().map(|fault| fault.name()).collect();
        assert_eq!((words(&MODES), words(&FAULTS)), (modes, faults));
        assert!((0..).zip(Mode::VARIANTS).all(|(number, mode)| mode.raw() == number));
        assert!(
            (0..)
                .zip(FaultCode::VARIANTS)
                .all(|(number, fault)| fault.raw() == number)
        );
    }
}
