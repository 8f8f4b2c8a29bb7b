//! A row of the tables of laws.

use oleo_plant_sim::strut::{LawArgument, LawPlace};

use crate::effect::unlisted::forms::{Form, Grid};
use crate::effect::unlisted::knots::EDGE_PA;
use crate::vocabulary::Site;

/// One law that is searched for.
pub struct Law {
    /// What it relates, for people: "force over speed".
    pub label: &'static str,
    /// Place at which the law is reported.
    pub site: Site,
    /// Where it acts in the model.
    pub place: LawPlace,
    /// Quantity on which the law depends.
    pub depends_on: LawArgument,
    /// How its table comes from fitted numbers.
    pub form: &'static dyn Form,
    /// Values of the argument at which the table has points.
    pub knots: &'static [f64],
    /// Size of one fitted number that would be visible.
    pub visible: f64,
}

/// A row of a table.
pub const fn law(
    label: &'static str,
    site: Site,
    (place, depends_on): (LawPlace, LawArgument),
    form: &'static dyn Form,
    knots: &'static [f64],
    visible: f64,
) -> Law {
    Law {
        label,
        site,
        place,
        depends_on,
        form,
        knots,
        visible,
    }
}

impl Law {
    /// At rest a law adds nothing and leaves everything as believed: displacement, speed, flow and drop zero, gas volume
    /// the static one, smallest pressure. The duration of the longest recording scales what is fitted of time.
    pub fn grid(&self, longest_s: f64) -> Grid<'static> {
        Grid {
            knots: self.knots,
            at_rest: match (self.place, self.depends_on) {
                (_, LawArgument::RelativeVolume) => 1.0,
                // A response may be longer at any pressure difference.
                (LawPlace::ValveTiming, _) => EDGE_PA[0],
                _ => 0.0,
            },
            visible: self.visible,
            longest_s,
        }
    }

    /// Whether the law changes only what an instrument shows. The displacement is an input: its instrument misleads the simulation.
    pub fn is_of_output_only(&self) -> bool {
        matches!(self.site, Site::Sensor(_)) && self.place != LawPlace::InstrumentDisplacement
    }
}
