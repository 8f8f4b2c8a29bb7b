//! What all measurements of the rig share: the choice of the strut, and the sheet of results.

use std::path::PathBuf;

use oleo_plant_sim::strut::StrutModel;
use oleo_report::{OutputDirectory, Page};
use serde_json::{Map, Value};

use crate::failure::Failure;
use crate::results::{ResultsArgs, command_line};
use oleo_hil::parameter_files::strut;

/// Options that all measurements share: the strut and the output folder.
#[derive(clap::Args)]
pub struct Specimen {
    /// File of the strut model [default: the built-in defender110]
    #[arg(long, value_name = "MODEL.toml")]
    strut: Option<PathBuf>,
    /// Static load of the built-in strut, N
    #[arg(
        long,
        value_name = "N",
        default_value_t = 8000.0,
        conflicts_with = "strut",
        allow_negative_numbers = true
    )]
    static_load_n: f64,
    #[command(flatten)]
    results: ResultsArgs,
}

impl Specimen {
    /// Reads the strut's model from its file, or takes the built-in one.
    pub fn model(&self) -> Result<StrutModel, Failure> {
        match &self.strut {
            Some(path) => Ok(strut(path)?),
            None if self.static_load_n.is_finite() && (500.0..=40_000.0).contains(&self.static_load_n) => {
                Ok(StrutModel::defender110(self.static_load_n))
            }
            None => Err(Failure::new(format!(
                "--static-load-n {}: give a load from 500 to 40000 N",
                self.static_load_n
            ))),
        }
    }

    /// Starts the sheet of a measurement (its name on the command line); fails at once where `--out` cannot be written.
    /// `recording` is what it reads besides the model.
    pub fn sheet(
        &self,
        measurement: &str,
        title: &str,
        model: &StrutModel,
        recording: Option<&PathBuf>,
    ) -> Result<Sheet<'_>, Failure> {
        let inputs = self.strut.iter().chain(recording).cloned().collect();
        let (command, name) = (format!("oleo rig {measurement}"), format!("rig-{measurement}"));
        let mut out = self.results.stage(&command, &name, inputs)?;
        if let Some(out) = &mut out {
            out.write("strut.toml", model.to_toml())?;
        }
        let mut page = Page::new(title, &command_line());
        let static_kn = 1e-3 * model.cylinder.static_pressure_pa * model.piston_area_m2();
        page.fact(
            "Strut",
            &format!("{}, static load {static_kn:.1} kN", model.specimen.name),
        );
        Ok(Sheet {
            results: &self.results,
            out,
            page,
            summary: Map::new(),
        })
    }
}

/// Results of one measurement, on their way out.
pub struct Sheet<'a> {
    results: &'a ResultsArgs,
    out: Option<OutputDirectory>,
    pub page: Page,
    summary: Map<String, Value>,
}

impl Sheet<'_> {
    /// A figure for `summary.json`.
    pub fn summarise(&mut self, key: &str, value: impl Into<Value>) {
        self.summary.insert(key.to_owned(), value.into());
    }

    /// Adds a CSV file with the given columns.
    pub fn csv(&mut self, name: &str, columns: &[(&str, &[f64])]) -> Result<(), Failure> {
        if let Some(out) = &mut self.out {
            out.csv(name, columns)?;
        }
        Ok(())
    }

    /// A record with the columns of a recording, and more behind them.
    pub fn record(
        &mut self,
        name: &str,
        record: &oleo_plant_sim::rig::Record,
        more: &[(&str, &[f64])],
    ) -> Result<(), Failure> {
        let columns = record.columns();
        let mut all: Vec<(&str, &[f64])> = columns.iter().map(|column| (column.0, column.1.as_slice())).collect();
        all.extend_from_slice(more);
        self.csv(name, &all)
    }

    /// Moves the files into place and prints the tables. Nothing in a measurement is random.
    pub fn publish(mut self, text: &str) -> Result<(), Failure> {
        if let Some(out) = &mut self.out {
            out.summary("summary.json", None, &self.summary)?;
            out.page(&self.page)?;
        }
        self.results.publish(self.out, text)
    }
}
