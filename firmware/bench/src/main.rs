//! Runs the controller over a synthetic drive, and prints the hash of the valve words and the instructions that it
//! takes.
//!
//! One program for two machines. On the emulated Cortex-M4F it counts instructions of each tick; on the host it is what
//! callgrind looks at. Both print the hash of all valve words, which must be the same: the promise that what is
//! simulated on a desk is what drives in the vehicle.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod drive;
#[cfg_attr(target_os = "none", path = "board.rs")]
#[cfg_attr(not(target_os = "none"), path = "host.rs")]
mod machine;

use core::hash::Hasher;
use core::hint::black_box;
use drive::{Drive, TICKS};
use fnv::FnvHasher;
use machine::{Counter, leave, say};
use oleo_controller::can::Frame;
use oleo_controller::{Configuration, Inputs, Node, Outputs, PlantEnd, State, ValveCommand, tick};

/// Largest permitted median and largest permitted value of the tick, instructions on the Cortex-M4F.
const BUDGET: (u32, u32) = (2_000, 3_000);

#[cfg_attr(target_os = "none", cortex_m_rt::entry)]
fn main() -> ! {
    let Some(counter) = Counter::start() else { leave(false) };
    let configuration = Configuration::defender110();
    let mut drive = Drive::new();
    let mut plant = PlantEnd::new();
    let mut node = Node::new(configuration);
    let mut state = State::new();
    let mut words = FnvHasher::default();
    let mut costs = [[0_u32; TICKS as usize]; 3];
    let [tick_costs, node_costs, receive_costs] = &mut costs;
    let mut modes = [0_u16; 16];
    let (mut handling, mut changes, mut last) = (0_u16, 0_u16, 0);

    for index in 0..usize::from(TICKS) {
        let number = drive.tick();
        let inputs = drive.inputs(ValveCommand::from_word(last));
        let frames = plant.encode(number, &inputs);

        tick_costs[index] = counter.instructions(|| {
            black_box(controller_tick(&configuration, &mut state, &inputs));
        });
        receive_costs[index] = counter.instructions(|| node_receive(&mut node, &frames));
        let mut answer = None;
        node_costs[index] = counter.instructions(|| answer = Some(node_tick(&mut node)));
        let Some((outputs, frames)) = answer else { leave(false) };
        for frame in frames {
            plant.receive(frame.id, &frame.data);
        }
        plant.end_of_tick();

        words.write(&outputs.command.word().to_le_bytes());
        modes[outputs.mode as usize & 15] += 1;
        handling += u16::from(outputs.handling);
        changes += u16::from(outputs.command.word() != last);
        last = outputs.command.word();
    }

    say!("ticks {}", TICKS);
    // FNV-1a, 64 bit, over the words, low byte first.
    say!("valve words hash {:016x}", words.finish());
    for (mode, ticks) in modes.iter().enumerate().filter(|(_, ticks)| **ticks > 0) {
        say!("mode {} for {} ticks", mode, ticks);
    }
    say!("handling for {} ticks, {} changes of the valve word", handling, changes);
    let mut within = true;
    for (name, costs) in ["tick", "node tick", "receive six frames"].into_iter().zip(&mut costs) {
        costs.sort_unstable();
        let (min, median, max) = (costs[0], costs[costs.len() / 2], costs[costs.len() - 1]);
        let mean = costs.iter().sum::<u32>() / u32::from(TICKS);
        if max > 0 {
            say!(
                "{}: {} min, {} median, {} mean, {} max instructions",
                name,
                min,
                median,
                mean,
                max
            );
            within &= name != "tick" || (median <= BUDGET.0 && max <= BUDGET.1);
        }
    }
    if !within {
        say!(
            "above the budget of {} (median) and {} (max) instructions a tick",
            BUDGET.0,
            BUDGET.1
        );
    }
    leave(within)
}

/// The pure function, on its own in the image so that a profiler finds it.
#[inline(never)]
fn controller_tick(configuration: &Configuration, state: &mut State, inputs: &Inputs) -> Outputs {
    tick(black_box(configuration), black_box(state), black_box(inputs))
}

/// The same with the bus around it: time-outs, command and status frames.
#[inline(never)]
fn node_tick(node: &mut Node) -> (Outputs, impl Iterator<Item = Frame>) {
    let (outputs, frames) = node.tick();
    (outputs, black_box(frames).into_iter())
}

/// Check and decode one tick's frames.
#[inline(never)]
fn node_receive(node: &mut Node, frames: &[Frame]) {
    for frame in black_box(frames) {
        node.receive(frame.id, &frame.data);
    }
}
