//! `oleo show`: prints what is built in.

use std::process::ExitCode;

use clap_complete::Shell;
use oleo_hil::scenario;
use oleo_hil::scenario::file::DEFENDER;
use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::model_file::names::suggestion;
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::VehicleParameters;
use oleo_report::{Column, Table};

use crate::failure::Failure;
use crate::results::say;

/// Print what is built in, so that it can be saved and used.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo show vehicle > mine.toml         for --vehicle of drive, study and hil\n  \
                        oleo show scenario bus-silence > mine.toml\n  \
                        oleo show dbc > oleo.dbc\n  \
                        oleo show imu-dbc > imu.dbc           messages of oleo hil --imu\n  \
                        oleo show schema                      lists the schemas\n  \
                        oleo show schema hil > hil.schema.json\n  \
                        oleo show completions bash > oleo.bash\n  oleo show man hil | man -l -"
)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// Parameters of the built-in vehicle: masses, dimensions, springs, tyres (TOML, for --vehicle)
    Vehicle {
        /// Name of the vehicle
        #[arg(value_name = "NAME", default_value = DEFENDER)]
        name: String,
    },
    /// Handling parameters of the built-in vehicle: tyres, axles, steering (TOML, for --handling)
    Handling {
        /// Name of the vehicle
        #[arg(value_name = "NAME", default_value = DEFENDER)]
        name: String,
    },
    /// Model of the built-in strut (TOML, for --strut and oleo predict)
    Strut {
        /// Name of the strut
        #[arg(value_name = "NAME", default_value = DEFENDER)]
        name: String,
    },
    /// A built-in scenario (TOML, for oleo hil --scenario); without a name, the list of scenarios
    Scenario {
        /// Name of the scenario
        #[arg(value_name = "NAME")]
        name: Option<String>,
    },
    /// Database of the messages on the bus (DBC)
    Dbc,
    /// Database of the messages of an inertial unit on the body, which oleo hil --imu also sends (DBC)
    ImuDbc,
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

/// The database, from which the controller's codecs are tested too.
pub const DBC: &str = include_str!("../../controller/oleo.dbc");

/// Name, file that it describes, and text of each schema.
macro_rules! schemas {
    ($($name:literal of $file:literal),* $(,)?) => {
        [$(($name, $file, include_str!(concat!("../../schemas/", $name, ".json")))),*]
    };
}

const SCHEMAS: [(&str, &str, &str); 18] = schemas!(
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
    "study-fleet" of "summary.json of oleo study fleet",
    "compare" of "summary.json of oleo compare",
    "bench" of "summary.json of oleo bench",
    "diagnose" of "report.json of oleo diagnose",
    "self-test" of "summary.json of oleo diagnose --self-test",
);

/// Runs the command. `program` is the whole command line.
pub fn run(args: Args, program: clap::Command) -> Result<ExitCode, Failure> {
    let text = match args.what {
        What::Vehicle { name } => only(&name, "vehicles", VehicleParameters::DEFENDER110_TOML)?,
        What::Handling { name } => only(&name, "vehicles", HandlingParameters::DEFENDER110_TOML)?,
        What::Strut { name } => only(&name, "struts", StrutModel::DEFENDER110_TOML)?,
        What::Scenario { name: None } => scenarios()?,
        What::Scenario { name: Some(name) } => one_of(&name, "scenario", scenario::BUILT_IN)?,
        What::Dbc => DBC.to_owned(),
        What::ImuDbc => oleo_hil::imu::DBC.to_owned(),
        What::Schema { name: None } => list(),
        What::Schema { name: Some(name) } => one_of(&name, "schema", &SCHEMAS.map(|(name, _, text)| (name, text)))?,
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

/// The text of the built-in vehicle or strut, if that is its name.
fn only(name: &str, plural: &str, text: &str) -> Result<String, Failure> {
    if name == DEFENDER {
        return Ok(text.to_owned());
    }
    Err(Failure::new(format!(
        "{name}: is not built in: {}",
        suggestion(name, &[DEFENDER], plural)
    )))
}

/// The text of this name in a list.
fn one_of(name: &str, singular: &str, built_in: &[(&str, &str)]) -> Result<String, Failure> {
    if let Some((_, text)) = built_in.iter().find(|(known, _)| *known == name) {
        return Ok((*text).to_owned());
    }
    let names: Vec<&str> = built_in.iter().map(|(name, _)| *name).collect();
    Err(Failure::new(format!(
        "{name}: is no {singular}: {}",
        suggestion(name, &names, &format!("{singular}s"))
    )))
}

/// The built-in scenarios and what they show.
pub fn scenarios() -> Result<String, Failure> {
    let mut table = Table::new([Column::text("Scenario"), Column::text("What it shows")]);
    for (name, _) in scenario::BUILT_IN {
        table.row([name.to_string(), scenario::named(name)?.description]);
    }
    Ok(table.to_string())
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
            let shown = program.get_subcommands().filter(|command| !command.is_hide_set());
            let names: Vec<&str> = shown.map(clap::Command::get_name).collect();
            let what = || format!("{name}: is no command: {}", suggestion(name, &names, "commands"));
            let found = program.find_subcommand(name).ok_or_else(|| Failure::new(what()))?;
            found.clone()
        }
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page).render(&mut text)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}
