//! How fast the loop goes: `cargo run --release -p oleo-hil --example loop_speed [-- BUS [TICKS]]`.
//!
//! Prints ticks a second and the ratio to real time of the default scenario's loop, the best of five runs, with one and with two
//! threads. BUS is `inproc` (default) or `socketcan:vcan0`.

use oleo_hil::record::command_hash;
use oleo_hil::{run, scenario};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut scenario = scenario::named("belgian")?;
    if let Some(bus) = arguments.next() {
        scenario.bus = bus.parse()?;
    }
    if let Some(ticks) = arguments.next() {
        scenario.ticks = ticks.parse()?;
    }
    for threads in [1, 2] {
        let mut best = f64::INFINITY;
        let mut hash = String::new();
        for _ in 0..5 {
            let outcome = run::both(&scenario, run::vehicle(&scenario)?, threads, &mut |_| true)?;
            best = best.min(outcome.wall_s);
            hash = command_hash(outcome.plant.recording.words());
        }
        println!(
            "{} on {}: {threads} thread(s): {:.1} ms, {:.0} ticks/s, {:.0} x real time, commands {hash}",
            scenario.name,
            scenario.bus,
            best * 1e3,
            f64::from(scenario.ticks) / best,
            scenario.duration_s() / best
        );
    }
    Ok(())
}
