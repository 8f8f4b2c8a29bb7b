//! What a core of this machine can do at most with numbers of double precision: `cargo run --release -p oleo-plant-sim --example processor_limits`.
//!
//! Prints nanoseconds of one operation where each needs the result of the one before (`latency`), and of one value where they do not
//! depend on each other and the compiler takes two at a time, as the release build does everywhere (`throughput`). The best of several
//! runs, since only disturbances make them longer. `docs/performance.md` works out from these how long a strut's step needs at least.

use std::hint::black_box;
use std::time::Instant;

const OPERATIONS: u32 = 240_000;
const RUNS: u32 = 300;
/// Values that are worked on at the same time: as many as the registers hold beside two constants.
const ABREAST: usize = 24;

/// Nanoseconds of one of `operations`.
fn best(operations: u32, mut work: impl FnMut()) -> f64 {
    let run = |_| {
        let begun = Instant::now();
        work();
        begun.elapsed().as_secs_f64()
    };
    1e9 * (0..RUNS).map(run).fold(f64::INFINITY, f64::min) / f64::from(operations)
}

fn latency(operation: impl Fn(f64) -> f64) -> f64 {
    best(OPERATIONS, || {
        let mut x = black_box(1.3);
        for _ in 0..OPERATIONS {
            x = operation(x);
        }
        black_box(x);
    })
}

fn throughput(operation: impl Fn(f64) -> f64) -> f64 {
    best(OPERATIONS, || {
        let mut values = black_box([1.3; ABREAST]);
        for _ in 0..OPERATIONS / ABREAST as u32 {
            values.iter_mut().for_each(|x| *x = operation(*x));
        }
        black_box(values);
    })
}

fn main() {
    // A factor of one keeps the product from becoming so small that the processor slows down.
    let (a, b, one) = (black_box(0.7), black_box(0.4), black_box(1.0));
    let add = latency(|x| x + a);
    let root_and_add = latency(|x| x.sqrt() + a);
    for (name, ns) in [
        ("add latency", add),
        ("multiply latency", latency(|x| x * one)),
        ("divide latency", latency(|x| a / x)),
        ("root latency", root_and_add - add),
        // A multiplication and an addition each.
        ("add or multiply throughput", 0.5 * throughput(|x| x * a + b)),
        ("divide throughput", throughput(|x| a / x)),
        ("root throughput", throughput(f64::sqrt)),
    ] {
        println!("{name}: {ns:.3} ns");
    }
}
