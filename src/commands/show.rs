//! `oleo show`: prints what is built in.

use std::process::ExitCode;

use clap_complete::Shell;
use oleo_plant_sim::model_file::names::suggestion;
use oleo_report::{Column, Table};

use crate::failure::Failure;
use crate::results::say;

/// Print what is built in, so that it can be saved and used.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo show schema                      lists the schemas\n  \
                        oleo show schema hil > hil.schema.json\n  \
                        oleo show completions bash > oleo.bash\n  oleo show man hil | man -l -"
)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// JSON Schema (draft 2020-12) of a summary.json or report.json; without a name, the list of schemas
    Schema {
        /// Name of the schema: the command, with hyphens
        #[arg(value_name = "NAME")]
        name: Option<String>,
    },
    /// Script that completes commands and options in a shell
    Completions {
        /// Shell that is to read it
        shell: Shell,
    },
    /// Manual page in troff form; without a name, that of oleo
    Man {
        /// Name of a command, such as hil
        #[arg(value_name = "COMMAND")]
        command: Option<String>,
    },
}

/// Name, file that it describes, and text of each schema.
macro_rules! schemas {
    ($($name:literal of $file:literal),* $(,)?) => {
        [$(($name, $file, include_str!(concat!("../../schemas/", $name, ".json")))),*]
    };
}

const SCHEMAS: [(&str, &str, &str); 15] = schemas!(
    "hil" of "summary.json of oleo hil",
    "hil-controller" of "summary.json of oleo hil --node controller",
    "drive" of "summary.json of oleo drive",
    "rig-spring" of "summary.json of oleo rig spring",
    "rig-damping" of "summary.json of oleo rig damping",
    "rig-bulk-modulus" of "summary.json of oleo rig bulk-modulus",
    "rig-valve-response" of "summary.json of oleo rig valve-response",
    "rig-replay" of "summary.json of oleo rig replay",
    "rig-limits" of "summary.json of oleo rig limits",
    "study-sweep" of "summary.json of oleo study sweep",
    "study-optimise" of "summary.json of oleo study optimise",
    "study-control" of "summary.json of oleo study control",
    "study-robust" of "summary.json of oleo study robust",
    "diagnose" of "report.json of oleo diagnose",
    "self-test" of "summary.json of oleo diagnose --self-test",
);

/// Runs the command. `program` is the whole command line.
pub fn run(args: Args, program: clap::Command) -> Result<ExitCode, Failure> {
    let text = match args.what {
        What::Schema { name: None } => list(),
        What::Schema { name: Some(name) } => schema(&name)?.to_owned(),
        What::Completions { shell } => completions(shell, program),
        What::Man { command } => manual(program, command.as_deref())?,
    };
    say(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn list() -> String {
    let mut table = Table::new([Column::text("Schema"), Column::text("File that it describes")]);
    for (name, file, _) in SCHEMAS {
        table.row([name, file]);
    }
    table.to_string()
}

fn schema(name: &str) -> Result<&'static str, Failure> {
    let names = SCHEMAS.map(|(name, ..)| name);
    match SCHEMAS.iter().find(|(known, ..)| *known == name) {
        Some((_, _, text)) => Ok(text),
        None => Err(Failure::new(format!(
            "{name}: is no schema: {}",
            suggestion(name, &names, "schemas")
        ))),
    }
}

fn completions(shell: Shell, mut program: clap::Command) -> String {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut program, "oleo", &mut text);
    String::from_utf8_lossy(&text).into_owned()
}

fn manual(mut program: clap::Command, command: Option<&str>) -> Result<String, Failure> {
    program.build();
    let page = match command {
        None => program,
        Some(name) => {
            let names: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
            let what = || format!("{name}: is no command: {}", suggestion(name, &names, "commands"));
            let found = program.find_subcommand(name).ok_or_else(|| Failure::new(what()))?;
            found.clone()
        }
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page).render(&mut text)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}
