//! What the studies of the controller share: the vehicle, the threads, and how finished drives are kept.

use std::path::PathBuf;

use oleo_controller::{DamperPolicy, Strategy};
use oleo_hil::comparison::{Bench, Setting};
use oleo_plant_sim::study::Records;

use crate::failure::Failure;
use crate::shard::{About, Kept};
use oleo_hil::parameter_files::Parameters;

/// The vehicle and the threads.
#[derive(clap::Args)]
pub struct Drives {
    /// File of vehicle parameters [default: the built-in defender110]
    #[arg(long, value_name = "VEHICLE.toml")]
    vehicle: Option<PathBuf>,
    /// File of handling parameters [default: the built-in defender110]
    #[arg(long, value_name = "HANDLING.toml")]
    handling: Option<PathBuf>,
    /// Strut model, such as the model.toml that oleo diagnose writes; it is charged for the load that it carries [default: the
    /// built-in defender110]
    #[arg(long, value_name = "MODEL.toml")]
    strut: Option<PathBuf>,
    /// Number of threads [default: all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

impl Drives {
    /// The vehicle on its struts, and what it was read from.
    pub fn bench(&self) -> Result<(Bench, Parameters), Failure> {
        let (vehicle, handling) = (self.vehicle.as_ref(), self.handling.as_ref());
        let parameters = Parameters::read(vehicle, handling, self.strut.as_ref())?;
        let Parameters {
            vehicle,
            handling,
            strut,
            ..
        } = &parameters;
        Ok((Bench::new(vehicle.clone(), handling.clone(), strut), parameters))
    }

    /// Runs `work` on the threads asked for.
    pub fn on_threads<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
        let threads = self.threads.unwrap_or(0);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| Failure::new(format!("--threads {threads}: {error}")))?;
        Ok(pool.install(work))
    }

    /// What a study of these drives is called, with so many drives for each of its cases.
    pub fn about(&self, study: &str, drives: u64) -> About {
        let files = [&self.vehicle, &self.handling, &self.strut];
        About {
            command: format!("oleo study {study}"),
            name: format!("study-{study}"),
            inputs: files.into_iter().flatten().cloned().collect(),
            ledger: "drives.csv",
            steps: drives,
            ends_gracefully: true,
        }
    }
}

/// The finished drives.
pub fn records(kept: Kept) -> Result<Records, Failure> {
    Ok(match kept {
        Kept::Nowhere => Records::in_memory(),
        Kept::In(path) => Records::open(path)?,
        Kept::Text(text) => Records::of_text(text),
    })
}

/// The controller of a vehicle with a strategy. The damper policy is that of `ride-handling`, and nothing to the others.
pub fn controlled(
    bench: &Bench,
    name: &'static str,
    strategy: Strategy,
    dampers: DamperPolicy,
) -> Result<Setting, Failure> {
    let mut builder = oleo_controller::Builder {
        strategy,
        ..bench.controller()
    };
    builder.tuning.strategy.ride_handling.dampers.policy = dampers;
    let configuration = builder.build().map_err(|error| Failure::new(error.to_string()))?;
    Ok(Setting::Controlled(name, Box::new(configuration)))
}
