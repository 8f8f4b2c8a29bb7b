//! `modelDescription.xml`, printed from the table of variables.
//!
//! One file has one version of FMI, because its description has one. Both versions tell the same: names, units, ranges, words, start values, and that
//! outputs do not depend on inputs before a step is made.

mod unit;

use std::io;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};

use crate::definition::Definition;
use crate::numbers::ends;
use crate::variable::{Kind, Role, Variable};
use unit::{BASE, base_unit};

/// A version of FMI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FmiVersion {
    /// FMI 2.0, which most tools read.
    Two,
    /// FMI 3.0.
    Three,
}

impl FmiVersion {
    /// The version as a tool reads it.
    fn text(self) -> &'static str {
        match self {
            Self::Two => "2.0",
            Self::Three => "3.0",
        }
    }

    /// One of two names, by version.
    fn name(self, two: &'static str, three: &'static str) -> &'static str {
        match self {
            Self::Two => two,
            Self::Three => three,
        }
    }
}

type Xml = Writer<Vec<u8>>;
type Attributes = Vec<(&'static str, String)>;

/// The text of `modelDescription.xml`.
///
/// # Errors
/// None that memory does not have.
pub fn description(definition: &Definition, version: FmiVersion) -> io::Result<Vec<u8>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let attributes = vec![
        ("fmiVersion", version.text().to_owned()),
        ("modelName", definition.identifier.to_owned()),
        (version.name("guid", "instantiationToken"), definition.token()),
        ("description", definition.description.clone()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("generationTool", concat!("oleo ", env!("CARGO_PKG_VERSION")).to_owned()),
        ("variableNamingConvention", "structured".to_owned()),
    ];
    around(&mut xml, "fmiModelDescription", &attributes, |xml| {
        empty(xml, "CoSimulation", &capabilities(definition, version))?;
        around(xml, "UnitDefinitions", &[], |xml| units(definition, xml))?;
        let lists = definition.lists();
        if !lists.is_empty() {
            around(xml, "TypeDefinitions", &[], |xml| types(&lists, version, xml))?;
        }
        around(xml, "LogCategories", &[], |xml| {
            let category = [
                ("name", "logStatusError".to_owned()),
                (
                    "description",
                    "what is wrong, where, and what to do, in one line".to_owned(),
                ),
            ];
            empty(xml, "Category", &category)
        })?;
        let experiment = [
            ("startTime", "0".to_owned()),
            ("stopTime", number(definition.stop_s)),
            ("stepSize", number(definition.step_s)),
        ];
        empty(xml, "DefaultExperiment", &experiment)?;
        around(xml, "ModelVariables", &[], |xml| {
            (definition.variables.iter().enumerate())
                .try_for_each(|(place, variable)| scalar(variable, place, version, xml))
        })?;
        around(xml, "ModelStructure", &[], |xml| structure(definition, version, xml))
    })?;
    let mut text = xml.into_inner();
    text.push(b'\n');
    Ok(text)
}

fn capabilities(definition: &Definition, version: FmiVersion) -> Attributes {
    let any_step = definition.tick_s.is_none().to_string();
    let yes = || "true".to_owned();
    let mut attributes = vec![
        ("modelIdentifier", definition.identifier.to_owned()),
        ("canHandleVariableCommunicationStepSize", any_step),
    ];
    match version {
        FmiVersion::Two => attributes.extend([
            ("canNotUseMemoryManagementFunctions", yes()),
            ("canGetAndSetFMUstate", yes()),
            ("canSerializeFMUstate", yes()),
        ]),
        FmiVersion::Three => {
            attributes.extend([("canGetAndSetFMUState", yes()), ("canSerializeFMUState", yes())]);
            attributes.extend(definition.terminal.map(|_| ("hasEventMode", yes())));
            attributes.extend(
                definition
                    .tick_s
                    .map(|tick_s| ("fixedInternalStepSize", number(tick_s))),
            );
        }
    }
    attributes
}

fn units(definition: &Definition, xml: &mut Xml) -> io::Result<()> {
    let mut seen: Vec<&str> = Vec::new();
    for variable in &definition.variables {
        let Kind::Real { unit, .. } = variable.kind else {
            continue;
        };
        if unit.is_empty() || seen.contains(&unit) {
            continue;
        }
        seen.push(unit);
        let name = [("name", unit.to_owned())];
        let Some(base) = base_unit(unit) else {
            empty(xml, "Unit", &name)?;
            continue;
        };
        let mut attributes: Attributes = (BASE.iter().zip(base.exponents))
            .filter(|(_, exponent)| *exponent != 0)
            .map(|(symbol, exponent)| (*symbol, exponent.to_string()))
            .collect();
        if base.factor != 1.0 {
            attributes.push(("factor", number(base.factor)));
        }
        around(xml, "Unit", &name, |xml| empty(xml, "BaseUnit", &attributes))?;
    }
    Ok(())
}

fn types(
    lists: &[(&'static str, &'static [crate::variable::Word])],
    version: FmiVersion,
    xml: &mut Xml,
) -> io::Result<()> {
    for (list, words) in lists {
        let name = [("name", (*list).to_owned())];
        let items = |xml: &mut Xml| {
            (words.iter().enumerate()).try_for_each(|(value, (word, meaning))| {
                let item = [
                    ("name", (*word).to_owned()),
                    ("value", value.to_string()),
                    ("description", (*meaning).to_owned()),
                ];
                empty(xml, "Item", &item)
            })
        };
        match version {
            FmiVersion::Two => around(xml, "SimpleType", &name, |xml| around(xml, "Enumeration", &[], items))?,
            FmiVersion::Three => around(xml, "EnumerationType", &name, items)?,
        }
    }
    Ok(())
}

/// One variable: FMI 2 puts what belongs to the type into an element inside, FMI 3 has one element for both.
fn scalar(variable: &Variable, place: usize, version: FmiVersion, xml: &mut Xml) -> io::Result<()> {
    let is_real = matches!(variable.kind, Kind::Real { .. });
    let is_clock = variable.kind == Kind::Clock;
    let (causality, variability, initial) = match variable.role {
        Role::Structural => ("structuralParameter", "fixed", Some("exact")),
        Role::Output if is_clock => ("output", "discrete", None),
        Role::Time => ("independent", "continuous", None),
        Role::Input if is_real => ("input", "continuous", None),
        Role::Input => ("input", "discrete", None),
        Role::Output if is_real => ("output", "continuous", Some("calculated")),
        Role::Output => ("output", "discrete", Some("calculated")),
        Role::Fixed => ("parameter", "fixed", Some("exact")),
        Role::Tunable => ("parameter", "tunable", Some("exact")),
    };
    let mut general: Attributes = vec![
        ("name", variable.name.clone()),
        ("valueReference", place.to_string()),
        ("description", variable.description.clone()),
        ("causality", causality.to_owned()),
        ("variability", variability.to_owned()),
    ];
    general.extend(initial.map(|initial| ("initial", initial.to_owned())));
    let (element, own) = of_kind(variable, version);
    let is_given = variable.role.is_given();
    match version {
        FmiVersion::Two => around(xml, "ScalarVariable", &general, |xml| empty(xml, element, &own)),
        FmiVersion::Three => {
            general.extend(own);
            if matches!(variable.kind, Kind::Binary { .. }) && is_given {
                // No bytes.
                around(xml, element, &general, |xml| {
                    empty(xml, "Start", &[("value", String::new())])
                })
            } else {
                empty(xml, element, &general)
            }
        }
    }
}

/// The element of a type, and the attributes that belong to it.
fn of_kind(variable: &Variable, version: FmiVersion) -> (&'static str, Attributes) {
    let is_given = variable.role.is_given();
    match &variable.kind {
        Kind::Real { unit, range } => {
            let (low, high) = ends(*range);
            let mut own: Attributes = Vec::new();
            if !unit.is_empty() {
                own.push(("unit", (*unit).to_owned()));
            }
            own.extend(low.map(|low| ("min", number(low))));
            own.extend(high.map(|high| ("max", number(high))));
            own.extend(is_given.then(|| ("start", number(variable.start))));
            (version.name("Real", "Float64"), own)
        }
        Kind::Switch => {
            let start = is_given.then(|| ("start", (variable.start != 0.0).to_string()));
            ("Boolean", start.into_iter().collect())
        }
        Kind::Word { list, .. } => {
            let mut own: Attributes = vec![("declaredType", (*list).to_owned())];
            own.extend(is_given.then(|| ("start", (variable.start as i64).to_string())));
            ("Enumeration", own)
        }
        Kind::Binary {
            mime_type,
            most_bytes,
            clock,
        } => {
            let own = vec![
                ("clocks", clock.to_string()),
                ("mimeType", (*mime_type).to_owned()),
                ("maxSize", most_bytes.to_string()),
            ];
            ("Binary", own)
        }
        Kind::Clock => ("Clock", vec![("intervalVariability", "triggered".to_owned())]),
    }
}

/// Which outputs there are. Between two steps none depends on an input; at the start all may depend on everything.
fn structure(definition: &Definition, version: FmiVersion, xml: &mut Xml) -> io::Result<()> {
    let outputs: Vec<usize> = (definition.variables.iter().enumerate())
        .filter_map(|(place, variable)| (variable.role == Role::Output).then_some(place))
        .collect();
    let no_inputs = ("dependencies", String::new());
    match version {
        FmiVersion::Two => {
            let index = |place: &usize| ("index", (place + 1).to_string());
            around(xml, "Outputs", &[], |xml| {
                (outputs.iter()).try_for_each(|place| empty(xml, "Unknown", &[index(place), no_inputs.clone()]))
            })?;
            around(xml, "InitialUnknowns", &[], |xml| {
                outputs
                    .iter()
                    .try_for_each(|place| empty(xml, "Unknown", &[index(place)]))
            })
        }
        FmiVersion::Three => {
            let reference = |place: &usize| ("valueReference", place.to_string());
            (outputs.iter()).try_for_each(|place| empty(xml, "Output", &[reference(place), no_inputs.clone()]))?;
            // What a clock ticks for is not known before the first instant.
            let is_clocked = |place: &usize| matches!(definition.variables[*place].kind, Kind::Binary { .. });
            (outputs.iter().filter(|place| !is_clocked(place)))
                .try_for_each(|place| empty(xml, "InitialUnknown", &[reference(place)]))
        }
    }
}

/// A number with all its digits.
fn number(number: f64) -> String {
    format!("{number:?}")
}

fn empty(xml: &mut Xml, element: &str, attributes: &[(&'static str, String)]) -> io::Result<()> {
    let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
    xml.create_element(element)
        .with_attributes(attributes)
        .write_empty()
        .map(drop)
}

fn around(
    xml: &mut Xml,
    element: &str,
    attributes: &[(&'static str, String)],
    inside: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
    (xml.create_element(element).with_attributes(attributes))
        .write_inner_content(inside)
        .map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_plant_sim::model_file::Range;

    fn definition() -> Definition {
        let range = Range::FromTo(0.0, 2.0);
        Definition {
            identifier: "oleo_test",
            description: "less < more & \"quotes\"".to_owned(),
            variables: vec![
                Variable::time(),
                Variable::input("x_m", "m", range, "way"),
                Variable::switch("valve1", Role::Input, "valve"),
                Variable::output("force_N", "N", "force"),
                Variable::parameter(
                    "damper[1].flow_m3_s[2]",
                    "m3/s",
                    "flow",
                    Role::Tunable,
                    Range::Finite,
                    1e-7,
                ),
            ],
            tick_s: Some(0.005),
            step_s: 0.005,
            stop_s: 1.0,
            terminal: None,
        }
    }

    #[test]
    fn both_versions_tell_the_same_and_texts_are_escaped() {
        let text = |version| String::from_utf8(description(&definition(), version).unwrap()).unwrap();
        let (two, three) = (text(FmiVersion::Two), text(FmiVersion::Three));
        for text in [&two, &three] {
            assert!(text.contains("less &lt; more &amp; &quot;quotes&quot;"), "{text}");
            assert!(text.contains(&definition().token()));
            assert!(text.contains("name=\"damper[1].flow_m3_s[2]\"") && text.contains("start=\"1e-7\""));
        }
        assert!(two.contains("<Unknown index=\"4\" dependencies=\"\"/>"), "{two}");
        assert!(
            three.contains("<Output valueReference=\"3\" dependencies=\"\"/>"),
            "{three}"
        );
        assert!(three.contains("fixedInternalStepSize=\"0.005\""));
    }

    /// A library refuses a file whose variables are not its own.
    #[test]
    fn the_token_changes_with_every_variable() {
        let mut other = definition();
        other.variables[4].start = 2e-7;
        assert_ne!(other.token(), definition().token());
        assert_eq!(definition().token(), definition().token());
    }
}
