//! Places in a specimen and, on a vehicle, the corner they belong to.

use std::fmt;
use std::str::FromStr;

use oleo_interface::{Corner, Valve};
use serde::{Deserialize, Serialize};

use super::Column;

/// Where an effect acts: a site of the specimen, and for a vehicle the part of it that the site belongs to.
///
/// ```
/// use oleo_diagnose::vocabulary::{Branch, Place, Site};
///
/// let place: Place = "front-left/accumulator-2".parse()?;
/// assert_eq!(place.site, Site::Accumulator(Branch::Second));
/// assert_eq!(place.to_string(), "front-left/accumulator-2");
/// assert!("accumulator-3".parse::<Place>().is_err());
/// # Ok::<(), oleo_diagnose::vocabulary::PlaceError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Place {
    /// Part of the vehicle; `None` on a test rig.
    pub part: Option<VehiclePart>,
    /// Site within the specimen.
    pub site: Site,
}

/// The part of a vehicle that a place belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VehiclePart {
    /// All corners alike, with one value.
    All,
    /// One corner of the vehicle.
    Corner(Corner),
}

/// A branch of the two-stage strut: branch 1 holds damper 1 and the 0.1 l accumulator, branch 2 damper 2, valve 3 and the
/// 0.4 l accumulator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Branch {
    /// Path 1 with damper 1, valve 1 and accumulator 1.
    First,
    /// Path 2 with damper 2, valves 2 and 3, and accumulator 2.
    Second,
}

impl Branch {
    /// Both branches in order.
    pub const ALL: [Self; 2] = [Self::First, Self::Second];

    /// 1 or 2, as the places and keys count.
    #[must_use]
    pub const fn number(self) -> usize {
        match self {
            Self::First => 1,
            Self::Second => 2,
        }
    }
}

/// A site within a specimen.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Site {
    /// Oil between piston and dampers of a strut.
    MainChamber,
    /// One accumulator of a strut: gas, floating piston.
    Accumulator(Branch),
    /// Both accumulators of a strut.
    Accumulators,
    /// Rod seal and guides.
    MainSeal,
    /// One flow path of a strut: damper, bypass and line.
    Path(Branch),
    /// Both flow paths of a strut.
    Paths,
    /// One solenoid valve of a strut.
    Valve(Valve),
    /// All solenoid valves of a strut.
    Valves,
    /// Stops at the ends of travel.
    EndStop,
    /// Mount between actuator and strut.
    Mount,
    /// Gas chamber of a gas spring.
    Chamber,
    /// The damper on a dynamometer as a whole: its two ends are all that is recorded.
    Damper,
    /// The drive as a whole, from the force of its motor to the position of its carriage.
    Drive,
    /// The instrument behind a column.
    Sensor(Column),
    /// An output of somebody else's model, by the column that it is compared with.
    Output(Column),
    /// An input of somebody else's model, by the column that it is taken from.
    Input(Column),
    /// A parameter of somebody else's model.
    Parameter(Column),
    /// The place is unknown.
    Unknown,
}

impl Site {
    /// The sites that a combined one stands for, in order; a simple one stands for itself.
    #[must_use]
    pub fn parts(&self) -> Vec<Self> {
        match self {
            Self::Accumulators => Branch::ALL.map(Self::Accumulator).to_vec(),
            Self::Paths => Branch::ALL.map(Self::Path).to_vec(),
            Self::Valves => Valve::ALL.map(Self::Valve).to_vec(),
            simple => vec![simple.clone()],
        }
    }
}

impl Place {
    /// A place of a specimen on a test rig.
    #[must_use]
    pub const fn on_rig(site: Site) -> Self {
        Self { part: None, site }
    }

    /// The column of the instrument, where the place is one.
    #[must_use]
    pub const fn sensor(&self) -> Option<&Column> {
        match &self.site {
            Site::Sensor(column) => Some(column),
            _ => None,
        }
    }

    /// The branch of the strut, where the place is in one.
    #[must_use]
    pub const fn branch(&self) -> Option<Branch> {
        match self.site {
            Site::Accumulator(branch) | Site::Path(branch) => Some(branch),
            _ => None,
        }
    }

    /// The same part of the vehicle, another site.
    #[must_use]
    pub const fn with_site(&self, site: Site) -> Self {
        Self { part: self.part, site }
    }

    /// True if the other place is this one or a part of it.
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        self.part == other.part && (self.site == other.site || self.site.parts().contains(&other.site))
    }

    /// True if one of the two places is the other one or a part of it.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.contains(other) || other.contains(self)
    }

    /// The text where a found effect is reported: `both accumulators` is what the vocabulary calls them there.
    #[must_use]
    pub fn as_reported(&self) -> String {
        let text = self.to_string();
        match self.site {
            Site::Accumulators => text.replace(ACCUMULATORS, BOTH_ACCUMULATORS),
            _ => text,
        }
    }
}

impl From<Site> for Place {
    fn from(site: Site) -> Self {
        Self::on_rig(site)
    }
}

/// What begins the text of an instrument's place.
const SENSOR: &str = "sensor:";
/// The same of an output, an input and a parameter of somebody else's model.
const OUTPUT: &str = "output:";
const INPUT: &str = "input:";
const PARAMETER: &str = "parameter:";
/// Text of [`Site::Accumulators`] as a candidate.
const ACCUMULATORS: &str = "accumulators";
/// The same where it is reported.
const BOTH_ACCUMULATORS: &str = "both accumulators";
/// Text of [`VehiclePart::All`].
const VEHICLE: &str = "vehicle";

impl fmt::Display for Site {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MainChamber => out.write_str("main-chamber"),
            Self::Accumulator(branch) => write!(out, "accumulator-{}", branch.number()),
            Self::Accumulators => out.write_str(ACCUMULATORS),
            Self::MainSeal => out.write_str("main-seal"),
            Self::Path(branch) => write!(out, "path-{}", branch.number()),
            Self::Paths => out.write_str("path-1+path-2"),
            Self::Valve(valve) => write!(out, "valve-{}", valve.index() + 1),
            Self::Valves => out.write_str("valve-1..3"),
            Self::EndStop => out.write_str("end-stop"),
            Self::Mount => out.write_str("mount"),
            Self::Chamber => out.write_str("chamber"),
            Self::Damper => out.write_str("damper"),
            Self::Drive => out.write_str("drive"),
            Self::Sensor(column) => write!(out, "{SENSOR}{column}"),
            Self::Output(column) => write!(out, "{OUTPUT}{column}"),
            Self::Input(column) => write!(out, "{INPUT}{column}"),
            Self::Parameter(name) => write!(out, "{PARAMETER}{name}"),
            Self::Unknown => out.write_str("unknown"),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.part {
            None => {}
            Some(VehiclePart::All) => write!(out, "{VEHICLE}/")?,
            Some(VehiclePart::Corner(corner)) => write!(out, "{}/", corner.name())?,
        }
        write!(out, "{}", self.site)
    }
}

/// A text that names no place.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is not a place of the vocabulary, such as main-seal, path-1, sensor:p1_Pa or front-left/accumulator-2")]
pub struct PlaceError(String);

impl FromStr for Place {
    type Err = PlaceError;

    fn from_str(text: &str) -> Result<Self, PlaceError> {
        let unknown = || PlaceError(text.to_owned());
        let (part, site) = match text.split_once('/') {
            None => (None, text),
            Some((VEHICLE, site)) => (Some(VehiclePart::All), site),
            Some((name, site)) => {
                let corner = Corner::named(name).ok_or_else(unknown)?;
                (Some(VehiclePart::Corner(corner)), site)
            }
        };
        Ok(Self {
            part,
            site: site.parse().map_err(|_| unknown())?,
        })
    }
}

impl FromStr for Site {
    type Err = PlaceError;

    fn from_str(text: &str) -> Result<Self, PlaceError> {
        let column = |prefix| {
            let name = text.strip_prefix(prefix).filter(|name: &&str| !name.is_empty());
            name.map(|name| Column::named(name.to_owned()))
        };
        if let Some(column) = column(SENSOR) {
            return Ok(Self::Sensor(column));
        }
        if let Some(column) = column(OUTPUT) {
            return Ok(Self::Output(column));
        }
        if let Some(column) = column(INPUT) {
            return Ok(Self::Input(column));
        }
        if let Some(name) = column(PARAMETER) {
            return Ok(Self::Parameter(name));
        }
        Ok(match text {
            "main-chamber" => Self::MainChamber,
            "accumulator-1" => Self::Accumulator(Branch::First),
            "accumulator-2" => Self::Accumulator(Branch::Second),
            ACCUMULATORS | BOTH_ACCUMULATORS => Self::Accumulators,
            "main-seal" => Self::MainSeal,
            "path-1" => Self::Path(Branch::First),
            "path-2" => Self::Path(Branch::Second),
            "path-1+path-2" => Self::Paths,
            "valve-1" => Self::Valve(Valve::Bypass1),
            "valve-2" => Self::Valve(Valve::Bypass2),
            "valve-3" => Self::Valve(Valve::Spring),
            "valve-1..3" => Self::Valves,
            "end-stop" => Self::EndStop,
            "mount" => Self::Mount,
            "chamber" => Self::Chamber,
            "damper" => Self::Damper,
            "drive" => Self::Drive,
            "unknown" => Self::Unknown,
            _ => return Err(PlaceError(text.to_owned())),
        })
    }
}

impl From<Place> for String {
    fn from(place: Place) -> Self {
        place.as_reported()
    }
}

impl TryFrom<String> for Place {
    type Error = PlaceError;

    fn try_from(text: String) -> Result<Self, PlaceError> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn site() -> impl Strategy<Value = Site> {
        let branch = || prop::sample::select(Branch::ALL.to_vec());
        prop_oneof![
            Just(Site::MainChamber),
            branch().prop_map(Site::Accumulator),
            Just(Site::Accumulators),
            Just(Site::MainSeal),
            branch().prop_map(Site::Path),
            Just(Site::Paths),
            prop::sample::select(Valve::ALL.to_vec()).prop_map(Site::Valve),
            Just(Site::Valves),
            Just(Site::EndStop),
            Just(Site::Mount),
            Just(Site::Chamber),
            Just(Site::Damper),
            Just(Site::Drive),
            "[a-z][a-z0-9_]{0,8}_(Pa|m|N)".prop_map(|name| Site::Sensor(Column::named(name))),
            "[a-z][a-z0-9_.]{0,8}".prop_map(|name| Site::Output(Column::named(name))),
            "[a-z][a-z0-9_.]{0,8}".prop_map(|name| Site::Input(Column::named(name))),
            "[a-z][a-z0-9_.]{0,8}".prop_map(|name| Site::Parameter(Column::named(name))),
            Just(Site::Unknown),
        ]
    }

    fn part() -> impl Strategy<Value = Option<VehiclePart>> {
        prop_oneof![
            Just(None),
            Just(Some(VehiclePart::All)),
            prop::sample::select(Corner::ALL.to_vec()).prop_map(|c| Some(VehiclePart::Corner(c))),
        ]
    }

    proptest! {
        #[test]
        fn texts_are_read_back(part in part(), site in site()) {
            let place = Place { part, site };
            prop_assert_eq!(place.to_string().parse(), Ok(place.clone()));
            prop_assert_eq!(place.as_reported().parse(), Ok(place.clone()));
            let json = serde_json::to_string(&place).expect("text");
            prop_assert_eq!(serde_json::from_str::<Place>(&json).ok(), Some(place));
        }

        #[test]
        fn no_text_makes_it_panic(text in ".{0,30}") {
            if let Ok(place) = text.parse::<Place>() {
                prop_assert!(place.to_string() == text || place.as_reported() == text);
            }
        }
    }

    #[test]
    fn a_combined_place_contains_its_parts_of_the_same_corner() {
        let at = |text: &str| text.parse::<Place>().expect("a place");
        assert!(at("path-1+path-2").contains(&at("path-2")) && at("valve-1..3").contains(&at("valve-3")));
        assert!(at("mount").contains(&at("mount")) && !at("path-1").contains(&at("path-2")));
        assert!(!at("front-left/accumulators").contains(&at("accumulator-1")));
        assert!(at("rear-right/accumulators").contains(&at("rear-right/accumulator-1")));
    }
}
