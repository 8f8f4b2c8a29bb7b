//! The options of both studies: what is driven, on how many threads, and how finished runs are kept.

use std::path::PathBuf;

use oleo_plant_sim::course::DriverStyle;
use oleo_plant_sim::study::{Bench, Conditions, DAMPER_FACTORS, GAS_VOLUMES_M3, Ledger, Surface, sweep};
use oleo_plant_sim::vehicle::Load;
use oleo_report::Progress;
use oleo_report::interrupt::Graceful;

use crate::commands::word::word;
use crate::failure::Failure;
use crate::shard::{About, Kept};
use oleo_hil::parameter_files::Parameters;

/// What both studies drive.
#[derive(clap::Args)]
pub struct Drive {
    /// File of vehicle parameters [default: the built-in defender110]
    #[arg(long, value_name = "VEHICLE.toml")]
    vehicle: Option<PathBuf>,
    /// File of handling parameters [default: the built-in defender110]
    #[arg(long, value_name = "HANDLING.toml")]
    handling: Option<PathBuf>,
    /// Speed on the Belgian block and in the lane change, km/h
    #[arg(long, value_name = "KM_H", default_value_t = 60.0, allow_negative_numbers = true)]
    speed_km_h: f64,
    /// Driver of the lane change: eased follows a smooth line that cuts the corners; hard steers hard left and hard right and
    /// demands about twice as much of the vehicle
    #[arg(long, value_name = "eased|hard", default_value = "eased", value_parser = word::<DriverStyle>)]
    driver: DriverStyle,
    /// Load: as-sold (none), laden (900 kg), roof (150 kg on the roof) or laden-roof (750 kg, and 150 kg on the roof)
    #[arg(long, value_name = "LOAD", default_value = "as-sold", value_parser = word::<Load>)]
    load: Load,
    /// Simulated time on the Belgian block, s
    #[arg(long, value_name = "S", default_value_t = 20.0, allow_negative_numbers = true)]
    duration_s: f64,
    /// Seed of the Belgian block
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Number of threads [default: all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

impl Drive {
    /// The test bench as set, and what its vehicle was read from.
    pub fn bench(&self) -> Result<(Bench, Parameters), Failure> {
        let parameters = Parameters::read(self.vehicle.as_ref(), self.handling.as_ref(), None)?;
        let range = |option: &str, value: f64, low: f64, high: f64| match value >= low && value <= high {
            true => Ok(()),
            false => Err(Failure::new(format!(
                "{option} {value}: give a value from {low} to {high}"
            ))),
        };
        range("--speed-km-h", self.speed_km_h, 5.0, 200.0)?;
        range("--duration-s", self.duration_s, 2.0, 600.0)?;
        let speed = self.speed_km_h / 3.6;
        let conditions = Conditions {
            ride_speed_m_s: speed,
            ride_duration_s: self.duration_s,
            seed: self.seed,
            lane_change_speed_m_s: speed,
            driver: self.driver,
            ..Conditions::default()
        };
        // The study's gas springs are charged for what they carry.
        let vehicle = self.load.at_ride_height(&parameters.vehicle);
        Ok((
            Bench::new(vehicle, parameters.handling.clone(), conditions)?,
            parameters,
        ))
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

    /// Runs what the ledger does not know of the 70 combinations, with a bar of this name.
    pub fn surface(&self, name: &str, bench: &Bench, ledger: &Ledger) -> Result<Surface, Failure> {
        let (volumes, factors) = (&GAS_VOLUMES_M3, &DAMPER_FACTORS);
        let progress = Progress::new(name, 2 * (volumes.len() * factors.len()) as u64);
        // After the first Ctrl-C the running simulations are completed and stored.
        let graceful = Graceful::begin();
        let (progress, graceful) = (&progress, &graceful);
        let done = move || progress.add(1);
        let stop = move || graceful.requested();
        Ok(self.on_threads(move || sweep(bench, ledger, volumes, factors, done, stop))??)
    }

    /// What a study of these drives is called.
    pub fn about(&self, study: &str) -> About {
        About {
            command: format!("oleo study {study}"),
            name: format!("study-{study}"),
            inputs: self.vehicle.iter().chain(&self.handling).cloned().collect(),
            ledger: "runs.csv",
            steps: 1,
            ends_gracefully: true,
        }
    }
}

/// The finished runs on a test bench.
pub fn ledger(kept: Kept, bench: &Bench) -> Result<Ledger, Failure> {
    Ok(match kept {
        Kept::Nowhere => Ledger::in_memory(bench),
        Kept::In(path) => Ledger::open(path, bench)?,
        Kept::Text(text) => Ledger::of_text(text, bench),
    })
}
