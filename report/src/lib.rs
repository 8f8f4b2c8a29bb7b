//! The output of every command: folders of results, tables, and report pages.
//!
//! * [`OutputDirectory`]: files of a run are staged in a hidden folder and appear in `--out DIR` at once, or not at all.
//! * [`OutputFile`]: one such file on its own.
//! * [`Page`]: one self-contained `report.html` that opens offline: what was run, the outcome, figures that zoom.
//! * [`Curves`], [`Lanes`], [`Dots`], [`Field`], [`Bars`]: the kinds of figure; every [`Axis`] names its quantity and unit.
//! * [`Scene`]: a drawing that moves with the time at the pointer.
//! * [`Table`]: the same rows on standard output and in the page.
//! * [`Progress`]: for runs of more than a second, a progress bar on a terminal and a line a phase elsewhere.
//!
//! ```
//! use oleo_report::{Axis, Column, Curves, Origin, OutputDirectory, Page, Table, Verdict};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let parent = tempfile::tempdir()?;
//! # let destination = parent.path().join("out");
//! let time_s = [0.0, 0.1, 0.2];
//! let force_n = [0.0, 900.0, 400.0];
//!
//! let mut outcome = Table::new([Column::text("Quantity"), Column::number("Value"), Column::text("Unit")]);
//! outcome.row(["peak force", "900", "N"]);
//!
//! let mut figure = Curves::new("Strut force", Axis::new("Time", "s"));
//! figure.panel(Axis::new("Force", "N")).line("measured", &time_s, &force_n).horizontal(500.0, "limit");
//!
//! let mut page = Page::new("Rig: replay", "oleo rig replay --out out");
//! page.verdict(Verdict::Pass, "all limits met").outcome(outcome);
//! page.section("Force").text("Compression is positive.").figure(figure);
//!
//! let mut out = OutputDirectory::stage(&destination, Origin::default(), false)?;
//! out.csv("force.csv", &[("time_s", &time_s), ("force_N", &force_n)])?;
//! out.page(&page)?;
//! out.commit()?;
//! # assert!(destination.join("report.html").exists());
//! # Ok(())
//! # }
//! ```

mod axis;
mod bars;
mod curves;
mod decimate;
mod dots;
mod equation;
mod field;
mod figure;
pub mod interrupt;
mod lanes;
mod output;
mod page;
mod progress;
mod scene;
mod table;

pub use axis::Axis;
pub use bars::Bars;
pub use curves::{Curves, Style};
pub use decimate::extrema_by_bucket;
pub use dots::Dots;
pub use field::{Field, FieldStyle};
pub use figure::Figure;
pub use lanes::{Lanes, Tint};
pub use output::{CsvRows, Origin, OutputDirectory, OutputError, OutputFile, digest, rounded};
pub use page::{Page, Verdict};
pub use progress::Progress;
pub use scene::Scene;
pub use table::{Cell, Column, Table, significant};
