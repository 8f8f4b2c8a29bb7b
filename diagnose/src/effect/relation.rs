//! The relation of the model that acts at a place, in words.

use oleo_interface::Valve;

use crate::vocabulary::Site;

/// The relation between measured neighbours in which a site takes part.
#[must_use]
pub fn at(site: &Site) -> String {
    match site {
        Site::Sensor(column) => format!("instrument {column}"),
        Site::Output(column) => format!("output {column} of the model"),
        Site::Input(column) => format!("input {column} of the model"),
        Site::Parameter(name) => format!("parameter {name} of the model"),
        Site::MainSeal | Site::EndStop | Site::Damper | Site::Drive => "force balance".into(),
        Site::Mount => "motion of the strut (mount)".into(),
        Site::MainChamber => "continuity of the oil".into(),
        Site::Chamber | Site::Accumulators => "gas law".into(),
        Site::Accumulator(_) => format!("gas law of {}", named(site)),
        Site::Valves => "valve timing".into(),
        Site::Valve(Valve::Spring) => "flow through valve 3".into(),
        Site::Paths => "flow in both paths".into(),
        Site::Path(_) | Site::Valve(_) | Site::Unknown => format!("flow in {}", named(site)),
    }
}

/// A site with its number in words: "accumulator 1".
#[must_use]
pub fn named(site: &Site) -> String {
    site.to_string().replace('-', " ")
}
