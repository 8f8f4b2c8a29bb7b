//! `modelDescription.xml`: what an FMU says of itself.

use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;
use serde::{Deserialize, Serialize};

use crate::complaint::Complaint;

/// The version of FMI that an FMU follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum FmiVersion {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

/// The type of a variable that is a number or a switch, by the C type that it is read and written with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum NumberKind {
    /// `fmi2Real` and `fmi3Float64`.
    Float64,
    /// `fmi3Float32`.
    Float32,
    /// `fmi2Integer`, `fmi3Int32`, enumerations of FMI 2.0.
    Int32,
    /// `fmi3Int64`, enumerations of FMI 3.0.
    Int64,
    /// `fmi2Boolean` and `fmi3Boolean`; one and zero here.
    Boolean,
}

/// What a variable is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Given in every step.
    Input,
    /// Computed.
    Output,
    /// Given before the simulation begins.
    Parameter,
    /// Everything else.
    Other,
}

/// When a variable may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variability {
    /// Never.
    Constant,
    /// Not after the initialization.
    Fixed,
    /// Between steps, by who simulates.
    Tunable,
    /// At events.
    Discrete,
    /// At any time.
    Continuous,
}

/// A variable of an FMU.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// The number by which the library knows it.
    pub reference: u32,
    /// Its type; `None` for texts, binaries, clocks, arrays and small integers, which cannot be compared with a column.
    pub kind: Option<NumberKind>,
    /// What it is for.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Its value at the start, where one is stated.
    pub start: Option<f64>,
}

/// What an FMU says of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Version of FMI.
    pub version: FmiVersion,
    /// Name of the model.
    pub name: String,
    /// What the file of the library is called.
    pub identifier: String,
    /// By which the library knows its description: `guid` or `instantiationToken`.
    pub token: String,
    /// Whether steps may differ in length.
    pub variable_step: bool,
    /// Step that the FMU was made for, s, where it states one.
    pub step_s: Option<f64>,
    /// Whether a process may make only one instance.
    pub once_per_process: bool,
    /// All variables, in their order.
    pub variables: Vec<Variable>,
}

impl Description {
    /// Reads a description.
    ///
    /// # Errors
    /// It is not XML of FMI 2.0 or 3.0, or the FMU is none for co-simulation.
    pub fn read(text: &str) -> Result<Self, Complaint> {
        let mut reader = Reader::from_str(text);
        let mut read = Partial::default();
        loop {
            match reader.read_event() {
                Ok(Event::Start(element)) => read.open(&element, Closed::Later)?,
                Ok(Event::Empty(element)) => read.open(&element, Closed::AtOnce)?,
                Ok(Event::End(element)) => read.close(element.local_name().as_ref()),
                Ok(Event::Eof) => return read.finish(),
                Ok(_) => {}
                Err(error) => {
                    return Err(Complaint::new(format!(
                        "modelDescription.xml: is no XML: {error}; export the FMU again"
                    )));
                }
            }
        }
    }

    /// The variable of a name.
    #[must_use]
    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.name == name)
    }
}

/// Whether an element has content.
#[derive(Clone, Copy, PartialEq)]
enum Closed {
    AtOnce,
    Later,
}

/// What has been read so far.
#[derive(Default)]
struct Partial {
    head: Option<(FmiVersion, String, String)>,
    slave: Option<(String, bool, bool)>,
    step_s: Option<f64>,
    in_variables: bool,
    /// The variable that was opened last and may still be told its type or its dimensions.
    begun: Option<Variable>,
    variables: Vec<Variable>,
}

/// Attributes of an element by name.
struct Attributes(Vec<(String, String)>);

impl Attributes {
    fn of(element: &BytesStart) -> Result<Self, Complaint> {
        let broken = |what: &dyn std::fmt::Display| {
            Complaint::new(format!(
                "modelDescription.xml: an attribute is broken: {what}; export the FMU again"
            ))
        };
        let mut all = Vec::new();
        for attribute in element.attributes() {
            let attribute = attribute.map_err(|error| broken(&error))?;
            let value = attribute
                .normalized_value(XmlVersion::Implicit1_0)
                .map_err(|error| broken(&error))?;
            let key = String::from_utf8_lossy(attribute.key.local_name().as_ref()).into_owned();
            all.push((key, value.into_owned()));
        }
        Ok(Self(all))
    }

    fn get(&self, name: &str) -> Option<&str> {
        self.0
            .iter()
            .find(|(key, _)| key == name)
            .map(|(_, value)| value.as_str())
    }

    fn text(&self, name: &str) -> String {
        self.get(name).unwrap_or_default().to_owned()
    }

    fn says(&self, name: &str) -> bool {
        matches!(self.get(name), Some("true" | "1"))
    }
}

impl Partial {
    fn open(&mut self, element: &BytesStart, closed: Closed) -> Result<(), Complaint> {
        let name = element.local_name();
        let name = String::from_utf8_lossy(name.as_ref()).into_owned();
        let attributes = Attributes::of(element)?;
        match name.as_str() {
            "fmiModelDescription" => self.head(&attributes)?,
            "CoSimulation" => {
                let variable_step = attributes.says("canHandleVariableCommunicationStepSize");
                let once = attributes.says("canBeInstantiatedOnlyOncePerProcess");
                self.slave = Some((attributes.text("modelIdentifier"), variable_step, once));
            }
            "DefaultExperiment" => self.step_s = attributes.get("stepSize").and_then(|text| text.parse().ok()),
            "ModelVariables" => self.in_variables = closed == Closed::Later,
            "Dimension" => {
                if let Some(begun) = &mut self.begun {
                    begun.kind = None;
                }
            }
            _ if !self.in_variables => {}
            "ScalarVariable" => self.begun = Some(variable(&attributes, None)?),
            "Real" | "Integer" | "Boolean" | "Enumeration" if self.begun.is_some() => self.typed(&name, &attributes),
            "Float64" | "Float32" | "Int32" | "Int64" | "Boolean" | "Enumeration" | "Int8" | "Int16" | "UInt8"
            | "UInt16" | "UInt32" | "UInt64" | "String" | "Binary" | "Clock"
                if self.begun.is_none() =>
            {
                let begun = variable(&attributes, kind_of_three(&name))?;
                match closed {
                    Closed::AtOnce => self.variables.push(begun),
                    Closed::Later => self.begun = Some(begun),
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn close(&mut self, name: &[u8]) {
        match name {
            b"ModelVariables" => self.in_variables = false,
            b"ScalarVariable" => self.variables.extend(self.begun.take()),
            _ if self.head.as_ref().is_some_and(|head| head.0 == FmiVersion::Three)
                && (kind_of_three(&String::from_utf8_lossy(name)).is_some()
                    || matches!(name, b"String" | b"Binary" | b"Clock")) =>
            {
                self.variables.extend(self.begun.take());
            }
            _ => {}
        }
    }

    fn head(&mut self, attributes: &Attributes) -> Result<(), Complaint> {
        let stated = attributes.text("fmiVersion");
        let (version, token) = match stated.split('.').next() {
            Some("2") => (FmiVersion::Two, "guid"),
            Some("3") => (FmiVersion::Three, "instantiationToken"),
            _ => {
                return Err(Complaint::new(format!(
                    "modelDescription.xml: is of FMI {stated:?}, and 2.0 and 3.0 are read; export the FMU in one of them"
                )));
            }
        };
        self.head = Some((version, attributes.text("modelName"), attributes.text(token)));
        Ok(())
    }

    /// The type of a variable of FMI 2.0, which is an element inside it.
    fn typed(&mut self, name: &str, attributes: &Attributes) {
        if let Some(begun) = &mut self.begun {
            begun.kind = match name {
                "Real" => Some(NumberKind::Float64),
                "Boolean" => Some(NumberKind::Boolean),
                _ => Some(NumberKind::Int32),
            };
            begun.start = number(attributes.get("start"));
        }
    }

    fn finish(self) -> Result<Description, Complaint> {
        let Some((version, name, token)) = self.head else {
            return Err(Complaint::new(
                "modelDescription.xml: has no fmiModelDescription; export the FMU again",
            ));
        };
        let Some((identifier, variable_step, once_per_process)) = self.slave else {
            return Err(Complaint::new(
                "modelDescription.xml: the FMU is not for co-simulation; export it as one for co-simulation, which brings its solver along",
            ));
        };
        // The identifier becomes the name of a file.
        if identifier.is_empty() || !identifier.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
            return Err(Complaint::new(format!(
                "modelDescription.xml: modelIdentifier {identifier:?} is no identifier of C; export the FMU again"
            )));
        }
        Ok(Description {
            version,
            name,
            identifier,
            token,
            variable_step,
            step_s: self.step_s.filter(|step| *step > 0.0),
            once_per_process,
            variables: self.variables,
        })
    }
}

fn kind_of_three(element: &str) -> Option<NumberKind> {
    Some(match element {
        "Float64" => NumberKind::Float64,
        "Float32" => NumberKind::Float32,
        "Int32" => NumberKind::Int32,
        "Int64" | "Enumeration" => NumberKind::Int64,
        "Boolean" => NumberKind::Boolean,
        _ => return None,
    })
}

fn variable(attributes: &Attributes, kind: Option<NumberKind>) -> Result<Variable, Complaint> {
    let name = attributes.text("name");
    let Some(reference) = attributes.get("valueReference").and_then(|text| text.parse().ok()) else {
        return Err(Complaint::new(format!(
            "modelDescription.xml: variable {name:?} has no valueReference; export the FMU again"
        )));
    };
    let causality = match attributes.get("causality") {
        Some("input") => Causality::Input,
        Some("output") => Causality::Output,
        Some("parameter" | "structuralParameter") => Causality::Parameter,
        _ => Causality::Other,
    };
    let variability = match attributes.get("variability") {
        Some("constant") => Variability::Constant,
        Some("fixed") => Variability::Fixed,
        Some("tunable") => Variability::Tunable,
        Some("discrete") => Variability::Discrete,
        Some("continuous") => Variability::Continuous,
        // As the standards have it.
        _ if causality == Causality::Parameter => Variability::Fixed,
        _ => match kind {
            Some(NumberKind::Float64 | NumberKind::Float32) | None => Variability::Continuous,
            Some(_) => Variability::Discrete,
        },
    };
    Ok(Variable {
        name,
        reference,
        kind,
        causality,
        variability,
        start: number(attributes.get("start")),
    })
}

fn number(text: Option<&str>) -> Option<f64> {
    match text? {
        "true" => Some(1.0),
        "false" => Some(0.0),
        text => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: &str = r#"<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="mass &amp; spring" guid="{7}">
  <CoSimulation modelIdentifier="mass" canHandleVariableCommunicationStepSize="true"/>
  <TypeDefinitions><SimpleType name="t"><Real unit="m"/></SimpleType></TypeDefinitions>
  <DefaultExperiment stepSize="0.001"/>
  <ModelVariables>
    <ScalarVariable name="f" valueReference="1" causality="input"><Real start="0.5"/></ScalarVariable>
    <ScalarVariable name="on" valueReference="1" causality="input"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="m" valueReference="2" causality="parameter" variability="tunable"><Real start="3"/></ScalarVariable>
    <ScalarVariable name="name" valueReference="2" causality="parameter"><String start="x"/></ScalarVariable>
  </ModelVariables>
</fmiModelDescription>"#;

    const THREE: &str = r#"<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="{8}">
  <CoSimulation modelIdentifier="mass" canBeInstantiatedOnlyOncePerProcess="true"/>
  <TypeDefinitions><Float64Type name="t" unit="m"/></TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Float64 name="many" valueReference="3" causality="output"><Dimension start="2"/></Float64>
    <Boolean name="on" valueReference="4" causality="input" start="false"><Alias name="other"/></Boolean>
    <UInt8 name="small" valueReference="5" causality="input" start="7"/>
  </ModelVariables>
</fmiModelDescription>"#;

    #[test]
    fn both_versions_are_read() {
        let two = Description::read(TWO).expect("a description");
        assert_eq!((two.name.as_str(), two.token.as_str()), ("mass & spring", "{7}"));
        assert!(two.variable_step && !two.once_per_process && two.step_s == Some(0.001));
        let kinds: Vec<_> = two.variables.iter().map(|v| v.kind).collect();
        let float = Some(NumberKind::Float64);
        assert_eq!(kinds, [float, Some(NumberKind::Boolean), float, None]);
        assert_eq!(two.variable("on").and_then(|v| v.start), Some(1.0));
        assert_eq!(two.variables[2].variability, Variability::Tunable);
        assert_eq!(two.variables[3].variability, Variability::Fixed);

        let three = Description::read(THREE).expect("a description");
        assert!(three.once_per_process && !three.variable_step);
        let names: Vec<_> = three.variables.iter().map(|v| (v.name.as_str(), v.kind)).collect();
        let boolean = Some(NumberKind::Boolean);
        assert_eq!(
            names,
            [("time", float), ("many", None), ("on", boolean), ("small", None)]
        );
    }

    #[test]
    fn what_cannot_be_used_is_refused_with_what_to_do() {
        let said = |text: &str| Description::read(text).expect_err("refused").to_string();
        assert!(said(&TWO.replace("\"2.0\"", "\"1.0\"")).contains("2.0 and 3.0 are read"));
        assert!(said(&TWO.replace("CoSimulation", "ModelExchange")).contains("export it as one for co-simulation"));
        assert!(said(&TWO.replace("\"mass\"", "\"../mass\"")).contains("modelIdentifier"));
        assert!(said("<a><b></a>").contains("is no XML"));
        assert!(said("").contains("has no fmiModelDescription"));
        assert!(said(&TWO.replace("valueReference=\"2\"", "")).contains("valueReference"));
    }
}
