//! What all measurements of the rig share: the choice of the strut, and the sheet of results.

use std::path::PathBuf;

use oleo_plant_sim::strut::StrutModel;
use oleo_report::{OutputDirectory, Page, Table};
use serde_json::{Map, Value};

use crate::failure::Failure;

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
    static_load: f64,
    /// Folder to which CSV data, summary.json and report.html are written; without it only the table is printed
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Specimen {
    /// Reads the strut's model from its file, or takes the built-in one.
    pub fn model(&self) -> Result<StrutModel, Failure> {
        match &self.strut {
            Some(path) => {
                let name = path.display().to_string();
                let text = std::fs::read_to_string(path)
                    .map_err(|error| Failure::new(format!("{name}: cannot read the model: {error}; check the path")))?;
                Ok(StrutModel::from_toml(&text, &name)?)
            }
            None if self.static_load.is_finite() && (500.0..=40_000.0).contains(&self.static_load) => {
                Ok(StrutModel::defender110(self.static_load))
            }
            None => Err(Failure::new(format!(
                "--static-load {}: give a load from 500 to 40000 N",
                self.static_load
            ))),
        }
    }

    /// Starts the sheet; fails at once where `--out` cannot be written.
    pub fn sheet(&self, title: &str, model: &StrutModel) -> Result<Sheet, Failure> {
        let out = self.out.as_ref().map(OutputDirectory::stage).transpose()?;
        let arguments: Vec<String> = std::env::args().skip(1).collect();
        let mut page = Page::new(title, &format!("oleo {}", arguments.join(" ")));
        let static_kn = 1e-3 * model.cylinder.static_pressure_pa * model.piston_area_m2();
        page.fact(
            "Strut",
            &format!("{}, static load {static_kn:.1} kN", model.specimen.name),
        );
        Ok(Sheet {
            out,
            page,
            summary: Map::new(),
        })
    }
}

/// Results of one measurement, on their way out.
pub struct Sheet {
    out: Option<OutputDirectory>,
    pub page: Page,
    summary: Map<String, Value>,
}

impl Sheet {
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

    /// Prints the table and moves the files into place. The table is the first thing on the page besides.
    pub fn publish(self, table: &Table) -> Result<(), Failure> {
        if let Some(mut out) = self.out {
            out.json("summary.json", &self.summary)?;
            out.page(&self.page)?;
            out.commit()?;
        }
        // A closed standard output (`| head`) is no failure of the measurement.
        let _ = std::io::Write::write_all(&mut std::io::stdout(), table.to_string().as_bytes());
        Ok(())
    }
}
