//! An FMU as the diagnosis simulates it.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use oleo_diagnose::Campaign;
use oleo_diagnose::specimen::ModelFile;
use oleo_diagnose::specimen::co_simulation::CoSimulationModel;
use oleo_diagnose::specimen::co_simulation::map::Map;
use oleo_diagnose::specimen::co_simulation::simulator::{Course, Role, Simulator, Stepping, Variable};
use oleo_fmu_import::{
    Causality, Children, Driven, Failure as Refusal, Fmu, Limits, NumberKind, Program, Run, Variability, VariableId,
};
use oleo_report::interrupt;

use super::arguments::Recordings;
use crate::commands::column_map::column_map;
use crate::commands::diagnose::campaign::{found, stage, write};
use crate::failure::Failure;
use crate::results::ResultsArgs;

/// The hidden command that serves one FMU.
const CHILD: &str = "fmu-child";
/// Bytes of a mebibyte.
const MEBIBYTE: u64 = 1 << 20;

/// Runs the command.
pub fn run(
    fmu: &Path,
    map: Option<&Path>,
    recordings: &Recordings,
    results: &ResultsArgs,
) -> Result<ExitCode, Failure> {
    let begun = Instant::now();
    let Some(map_path) = map else {
        return Err(Failure::new(
            "--fmu: needs --map MAP.toml, which says what is compared with what; see docs/fmu.md",
        ));
    };
    let map_file = map_path.display().to_string();
    let text = std::fs::read_to_string(map_path)
        .map_err(|error| Failure::new(format!("{map_file}: cannot be read: {error}; check the path")))?;
    let map = Map::read(&text, &map_file)?;
    let limits = Limits {
        time_s: map.run.limit_s,
        memory: MEBIBYTE * u64::from(map.run.memory_mib),
    };
    let unpacked = Fmu::open(fmu)?;
    interrupt::removes(unpacked.folder());
    let program = Program {
        path: std::env::current_exe()?,
        arguments: vec![CHILD.to_owned()],
    };
    let foreign = Arc::new(Foreign::new(Children::new(unpacked, program, limits)));
    let mut inputs = recordings.files.to_vec();
    inputs.extend([fmu.to_path_buf(), map_path.to_path_buf()]);
    inputs.extend(recordings.columns.map(Path::to_path_buf));
    let outcome = CoSimulationModel::new(map, &text, &map_file, foreign.clone())
        .map_err(Failure::from)
        .and_then(|model| diagnose(&foreign, model.into_model_file(), recordings, inputs, results, begun));
    // Where the FMU hung or fell, this is what is wrong, whatever the search made of it.
    match foreign.children.failed() {
        Some(complaint) => Err(Failure::new(complaint.to_string())),
        None => outcome,
    }
}

fn diagnose(
    foreign: &Arc<Foreign>,
    model: ModelFile,
    recordings: &Recordings,
    inputs: Vec<PathBuf>,
    results: &ResultsArgs,
    begun: Instant,
) -> Result<ExitCode, Failure> {
    let columns = recordings.columns.map(column_map).transpose()?;
    let again = {
        let foreign = foreign.clone();
        Box::new(move |text: &str| {
            let improved = "improved map";
            let map = Map::read(text, improved)?;
            Ok(CoSimulationModel::new(map, text, improved, foreign.clone())?.into_model_file())
        })
    };
    let kept_back = &recordings.kept_back;
    let (campaign, complete) = Campaign::of_files(model, recordings.files, columns.as_ref(), kept_back, again)?;
    let out = stage(results, &campaign, inputs)?;
    let stop = AtomicBool::new(false);
    let findings = found(campaign, complete.as_ref(), kept_back.clone(), begun, &stop)?;
    if foreign.children.failed().is_some() {
        return Ok(ExitCode::FAILURE);
    }
    write(results, out, &findings)
}

/// An FMU as the diagnosis simulates it.
struct Foreign {
    children: Children,
    variables: Vec<Variable>,
    ids: Vec<VariableId>,
}

impl Foreign {
    fn new(children: Children) -> Self {
        let described = &children.fmu().description.variables;
        let variables = described.iter().map(|variable| Variable {
            name: variable.name.clone(),
            role: match (variable.kind, variable.causality, variable.variability) {
                (None, ..) => Role::NoNumber,
                (_, Causality::Input, _) => Role::Input,
                (_, Causality::Output, _) => Role::Output,
                (_, Causality::Parameter, Variability::Tunable) => Role::TunableParameter,
                (_, Causality::Parameter, _) => Role::Parameter,
                (_, Causality::Other, _) => Role::Other,
            },
            is_real: matches!(variable.kind, Some(NumberKind::Float64 | NumberKind::Float32)),
            start: variable.start,
        });
        // Nothing is asked of a variable that is no number, so that its type does not matter.
        let ids = described.iter().map(|variable| VariableId {
            reference: variable.reference,
            kind: variable.kind.unwrap_or(NumberKind::Float64),
        });
        Self {
            variables: variables.collect(),
            ids: ids.collect(),
            children,
        }
    }

    fn run(&self, course: &Course) -> Run {
        Run {
            times_s: course.times_s.clone(),
            starts: course
                .starts
                .iter()
                .map(|(variable, value)| (self.ids[*variable], *value))
                .collect(),
            driven: (course.driven.iter())
                .map(|driven| Driven {
                    variable: self.ids[driven.variable],
                    during: driven.during.clone(),
                    at: driven.at.clone(),
                })
                .collect(),
            outputs: course.outputs.iter().map(|variable| self.ids[*variable]).collect(),
        }
    }

    fn in_words(&self, refusal: Refusal) -> String {
        match refusal {
            Refusal::Refused(what) => format!("{}: {what}", self.children.fmu().path.display()),
            Refusal::Fatal(complaint) => complaint.to_string(),
        }
    }
}

impl Simulator for Foreign {
    fn name(&self) -> &str {
        &self.children.fmu().description.name
    }

    fn variables(&self) -> &[Variable] {
        &self.variables
    }

    fn stepping(&self) -> Stepping {
        let description = &self.children.fmu().description;
        Stepping {
            variable: description.variable_step,
            step_s: description.step_s,
        }
    }

    fn simulate(&self, recording: &str, course: &Course) -> Result<Vec<Vec<f64>>, String> {
        (self.children.run(recording, &self.run(course))).map_err(|refusal| self.in_words(refusal))
    }

    fn check_repeatable(&self, recording: &str, course: &Course) -> Result<(), String> {
        (self.children.check_repeatable(recording, &self.run(course))).map_err(|refusal| self.in_words(refusal))
    }
}
