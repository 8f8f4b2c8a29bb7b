//! The children of an FMU: as many as are asked at the same time, each used again, and the run that failed.

use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use crate::archive::Fmu;
use crate::complaint::Complaint;
use crate::message::{Answer, Opening, Run};
use crate::worker::{ASK_ITS_TOOL, End, Worker};

/// What a child may use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Wall-clock time of one simulated recording, s.
    pub time_s: f64,
    /// Memory, bytes.
    pub memory: u64,
}

/// The program that [`crate::serve`]s: usually the one that runs, with an argument that makes it do so.
#[derive(Debug, Clone)]
pub struct Program {
    /// Path of the program.
    pub path: PathBuf,
    /// Its arguments.
    pub arguments: Vec<String>,
}

/// Why a run has no outputs.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// The FMU refuses these values; others may do.
    Refused(String),
    /// The FMU hangs or falls, and nothing more is to be had of it.
    Fatal(Complaint),
}

/// Simulates an FMU in children.
pub struct Children {
    fmu: Fmu,
    program: Program,
    limits: Limits,
    idle: Mutex<Vec<Worker>>,
    started: AtomicUsize,
    /// Whether every run has a process of its own.
    always_new: OnceLock<()>,
    failed: OnceLock<Complaint>,
}

impl Children {
    /// No child is started before the first run.
    #[must_use]
    pub fn new(fmu: Fmu, program: Program, limits: Limits) -> Self {
        let always_new = OnceLock::new();
        if fmu.description.once_per_process {
            let _ = always_new.set(());
        }
        Self {
            fmu,
            program,
            limits,
            idle: Mutex::default(),
            started: AtomicUsize::new(0),
            always_new,
            failed: OnceLock::new(),
        }
    }

    /// The FMU.
    #[must_use]
    pub fn fmu(&self) -> &Fmu {
        &self.fmu
    }

    /// The first failure after which nothing more was simulated.
    #[must_use]
    pub fn failed(&self) -> Option<&Complaint> {
        self.failed.get()
    }

    /// Simulates a run. `recording` is named in the complaint if the FMU hangs or falls.
    ///
    /// # Errors
    /// What the FMU refuses; how it ended, and after which time of the recording.
    pub fn run(&self, recording: &str, run: &Run) -> Result<Vec<Vec<f64>>, Failure> {
        if let Some(failed) = self.failed.get() {
            return Err(Failure::Fatal(failed.clone()));
        }
        let fatal = |end: End| {
            let complaint = self.complaint(recording, &end);
            Failure::Fatal(self.failed.get_or_init(|| complaint).clone())
        };
        let limit = Duration::from_secs_f64(self.limits.time_s);
        let idle = self.idle().pop();
        let mut worker = match idle {
            Some(worker) => worker,
            None => self.start(limit).map_err(fatal)?,
        };
        match worker.ask(run, limit).map_err(fatal)? {
            Answer::Outputs(outputs) => {
                if self.always_new.get().is_none() {
                    self.idle().push(worker);
                }
                Ok(outputs)
            }
            // Its child is not asked again: the instance is in no state that FMI permits to go on from.
            Answer::Refused(what) => Err(Failure::Refused(what)),
            Answer::Opened => Err(fatal(End {
                how: "answered out of turn".to_owned(),
                reached_s: None,
                what_to_do: ASK_ITS_TOOL,
            })),
        }
    }

    /// Simulates a run twice in one process and once in another. If a second instance in a process does something else than the first, every run gets a process of its own, so that results do not depend on
    /// which process had simulated what before.
    ///
    /// # Errors
    /// As [`Self::run`]; two processes that do not agree.
    pub fn check_repeatable(&self, recording: &str, run: &Run) -> Result<(), Failure> {
        let first = bits(&self.run(recording, run)?);
        if self.always_new.get().is_none() {
            if bits(&self.run(recording, run)?) == first {
                return Ok(());
            }
            let _ = self.always_new.set(());
            self.idle().clear();
        }
        if bits(&self.run(recording, run)?) == first {
            return Ok(());
        }
        let path = self.fmu.path.display();
        let complaint = Complaint::new(format!(
            "{path}: recording {recording}: the FMU gives other outputs for the same inputs each time, so that nothing can be concluded from it; fix its \
             seed of random numbers, or what else it takes from its surroundings"
        ));
        Err(Failure::Fatal(self.failed.get_or_init(|| complaint).clone()))
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Worker>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn start(&self, limit: Duration) -> Result<Worker, End> {
        let number = self.started.fetch_add(1, Ordering::Relaxed);
        let (folder, description) = (self.fmu.folder(), &self.fmu.description);
        let opening = Opening {
            version: description.version,
            library: self.fmu.library.clone(),
            name: description.identifier.clone(),
            token: description.token.clone(),
            resources: folder.join("resources"),
            clock: folder.join(format!("clock-{number}")),
            memory: self.limits.memory,
        };
        let mut command = Command::new(&self.program.path);
        // Files that an FMU writes where it stands do not end up among those of the user.
        command.args(&self.program.arguments).current_dir(folder);
        // Ctrl-C is for the parent, with which its children end.
        command.process_group(0);
        Worker::start(command, &opening, limit)
    }

    fn complaint(&self, recording: &str, end: &End) -> Complaint {
        let path = self.fmu.path.display();
        let when = end.reached_s.map_or_else(
            || "before the simulation began".to_owned(),
            |t| format!("at {t:.6} s of the simulation"),
        );
        Complaint::new(format!(
            "{path}: recording {recording}: the FMU {}, {when}; {}",
            end.how, end.what_to_do
        ))
    }
}

fn bits(outputs: &[Vec<f64>]) -> Vec<u64> {
    outputs.iter().flatten().map(|value| value.to_bits()).collect()
}
