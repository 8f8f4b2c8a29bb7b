//! One instance along the steps of a run.

use std::collections::BTreeMap;

use crate::message::Run;
use crate::slave::Slave;

/// Simulates. `reached` is told each time, s, before the step that begins there.
///
/// # Errors
/// What the FMU refused, and when.
pub fn simulate(slave: &mut dyn Slave, run: &Run, reached: &mut dyn FnMut(f64)) -> Result<Vec<Vec<f64>>, String> {
    let (Some(&start), Some(&stop)) = (run.times_s.first(), run.times_s.last()) else {
        return Err("there is nothing to simulate".to_owned());
    };
    reached(start);
    for (variable, value) in &run.starts {
        slave.set(*variable, *value)?;
    }
    slave.enter_initialization(start, stop)?;
    let mut inputs = Inputs::default();
    for (k, driven) in run.driven.iter().enumerate() {
        inputs.set(slave, run, k, driven.at.first().or(driven.during.first()).copied())?;
    }
    slave.exit_initialization()?;
    let mut outputs = vec![Vec::with_capacity(run.times_s.len()); run.outputs.len()];
    read(slave, run, start, &mut outputs)?;
    for (step, window) in run.times_s.windows(2).enumerate() {
        let &[from, to] = window else { continue };
        reached(from);
        let at = |what: String| format!("{what} (at {from} s)");
        for (k, driven) in run.driven.iter().enumerate() {
            inputs
                .set(slave, run, k, driven.during.get(step).copied())
                .map_err(at)?;
        }
        slave.step(from, to - from).map_err(at)?;
        for (k, driven) in run.driven.iter().enumerate() {
            inputs
                .set(slave, run, k, driven.at.get(step + 1).copied())
                .map_err(at)?;
        }
        read(slave, run, to, &mut outputs)?;
    }
    slave.terminate();
    Ok(outputs)
}

/// What was set last, as bits.
#[derive(Default)]
struct Inputs(BTreeMap<usize, u64>);

impl Inputs {
    /// Sets what is driven, unless it has this value already: some FMUs begin anew whenever an input is set.
    fn set(&mut self, slave: &mut dyn Slave, run: &Run, driven: usize, value: Option<f64>) -> Result<(), String> {
        match value {
            Some(value) if self.0.insert(driven, value.to_bits()) != Some(value.to_bits()) => {
                slave.set(run.driven[driven].variable, value)
            }
            _ => Ok(()),
        }
    }
}

fn read(slave: &mut dyn Slave, run: &Run, time_s: f64, outputs: &mut [Vec<f64>]) -> Result<(), String> {
    for (variable, series) in run.outputs.iter().zip(outputs) {
        let value = slave.get(*variable).map_err(|what| format!("{what} (at {time_s} s)"))?;
        if !value.is_finite() {
            return Err(format!("an output is {value} at {time_s} s"));
        }
        series.push(value);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::NumberKind;
    use crate::message::{Driven, VariableId};

    /// Integrates its input, and passes it through; notes what is called.
    #[derive(Default)]
    struct Integrator {
        state: f64,
        input: f64,
        calls: Vec<String>,
        fails_at: Option<f64>,
    }

    impl Slave for Integrator {
        fn enter_initialization(&mut self, start_s: f64, stop_s: f64) -> Result<(), String> {
            self.calls.push(format!("enter {start_s} {stop_s}"));
            Ok(())
        }
        fn exit_initialization(&mut self) -> Result<(), String> {
            self.calls.push("exit".to_owned());
            Ok(())
        }
        fn set(&mut self, variable: VariableId, value: f64) -> Result<(), String> {
            self.calls.push(format!("set {} {value}", variable.reference));
            match variable.reference {
                0 => self.input = value,
                _ => self.state = value,
            }
            Ok(())
        }
        fn get(&mut self, variable: VariableId) -> Result<f64, String> {
            Ok([self.input, self.state][variable.reference as usize])
        }
        fn step(&mut self, time_s: f64, step_s: f64) -> Result<(), String> {
            if self.fails_at == Some(time_s) {
                return Err("no".to_owned());
            }
            self.state += step_s * self.input;
            Ok(())
        }
        fn terminate(&mut self) {
            self.calls.push("terminate".to_owned());
        }
    }

    fn id(reference: u32) -> VariableId {
        let kind = NumberKind::Float64;
        VariableId { reference, kind }
    }

    fn run() -> Run {
        Run {
            times_s: vec![0.0, 1.0, 3.0],
            starts: vec![(id(1), 10.0)],
            driven: vec![Driven {
                variable: id(0),
                during: vec![1.0, 2.0],
                at: vec![1.0, 2.0, 5.0],
            }],
            outputs: vec![id(1), id(0)],
        }
    }

    #[test]
    fn steps_are_made_with_what_is_driven_and_outputs_read_with_what_is_there_at_their_end() {
        let (mut slave, mut reached) = (Integrator::default(), vec![]);
        let outputs = simulate(&mut slave, &run(), &mut |t| reached.push(t)).expect("outputs");
        assert_eq!(outputs, [[10.0, 11.0, 15.0], [1.0, 2.0, 5.0]]);
        assert_eq!(reached, [0.0, 0.0, 1.0]);
        let calls = [
            "set 1 10",
            "enter 0 3",
            "set 0 1",
            "exit",
            "set 0 2",
            "set 0 5",
            "terminate",
        ];
        assert_eq!(slave.calls, calls);
    }

    #[test]
    fn what_is_refused_says_when() {
        let mut slave = Integrator {
            fails_at: Some(1.0),
            ..Integrator::default()
        };
        let said = simulate(&mut slave, &run(), &mut |_| {}).expect_err("refused");
        assert_eq!(said, "no (at 1 s)");
        let mut endless = run();
        endless.starts[0].1 = f64::INFINITY;
        let said = simulate(&mut Integrator::default(), &endless, &mut |_| {}).expect_err("refused");
        assert!(said.contains("an output is inf at 0 s"), "{said}");
    }
}
