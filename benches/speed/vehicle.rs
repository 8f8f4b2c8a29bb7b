//! The whole loop in one process: vehicle on four struts, sensors, frames, controller, command, valves.

use divan::Bencher;
use divan::counter::ItemsCount;
use oleo_hil::run;
use oleo_hil::scenario;

/// A second of Belgian block at 60 km/h in lockstep on one thread. Items are ticks of 5 ms.
#[divan::bench(sample_count = 20)]
fn loop_tick(bencher: Bencher) {
    let mut scenario = scenario::named("belgian").expect("built in");
    scenario.ticks = 200;
    bencher
        .counter(ItemsCount::new(scenario.ticks))
        .with_inputs(|| run::vehicle(&scenario).expect("a vehicle"))
        .bench_local_values(|vehicle| run::both(&scenario, vehicle, 1, &mut |_| true).map(|outcome| outcome.wall_s));
}
