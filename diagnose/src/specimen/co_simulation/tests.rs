//! A model that is simulated in memory: a spring and a damper under a recorded displacement.

use std::sync::Arc;

use super::map::Map;
use super::simulator::{Course, Role, Simulator, Stepping, Variable};
use super::*;
use crate::vocabulary::EffectId;

const NAMES: [&str; 6] = ["x", "v", "force", "k", "d", "spare"];

/// `force = k x + d v`; breaks above a stiffness of 150.
struct Spring {
    variables: Vec<Variable>,
}

impl Spring {
    fn new() -> Self {
        let roles = [
            Role::Input,
            Role::Input,
            Role::Output,
            Role::TunableParameter,
            Role::Parameter,
            Role::Input,
        ];
        let starts = [None, None, None, Some(100.0), Some(3.0), Some(0.0)];
        let variables = (NAMES.iter().zip(roles).zip(starts)).map(|((name, role), start)| Variable {
            name: (*name).to_owned(),
            role,
            is_real: true,
            start,
        });
        Self {
            variables: variables.collect(),
        }
    }
}

impl Simulator for Spring {
    fn name(&self) -> &str {
        "spring"
    }

    fn variables(&self) -> &[Variable] {
        &self.variables
    }

    fn stepping(&self) -> Stepping {
        Stepping {
            variable: true,
            step_s: None,
        }
    }

    fn simulate(&self, _recording: &str, course: &Course) -> Result<Vec<Vec<f64>>, String> {
        let value = |name: &str, k: usize| {
            let variable = NAMES.iter().position(|n| *n == name).unwrap_or_default();
            let driven = course.driven.iter().rfind(|driven| driven.variable == variable);
            let start = course.starts.iter().find(|start| start.0 == variable);
            (driven.map(|driven| driven.at[k]).or(start.map(|start| start.1))).or(self.variables[variable].start)
        };
        if value("k", 0) > Some(150.0) {
            return Err("too stiff".to_owned());
        }
        let force = |k: usize| Some(value("k", k)? * value("x", k)? + value("d", k)? * value("v", k)?);
        Ok(vec![
            (0..course.times_s.len())
                .map(|k| force(k).unwrap_or(f64::NAN))
                .collect(),
        ])
    }
}

const MAP: &str = "[inputs]\nx = { column = \"x_mm\", factor = 1e-3, offset_tolerance = 1e-3 }\nv = { rate_of = \"x_mm\", factor = 1e-3 }\n\
    [outputs]\nforce = { column = \"force_N\", noise = 0.1, factor = 2.0, offset = 1.0, offset_tolerance = 0.5 }\n\
    [parameters]\nk = { tolerance = 0.1 }\n";

fn recording() -> Recording {
    let time_s: Vec<f64> = (0..200).map(|k| 5.0 + 0.01 * f64::from(k)).collect();
    let x: Vec<f64> = time_s.iter().map(|t| 20.0 * (t - 5.0)).collect();
    Recording {
        name: "ramp".into(),
        columns: vec![vec![0.0; time_s.len()], x],
        time_s,
        notes: vec![],
    }
}

fn specimen(map: &str) -> Result<Box<dyn Specimen>, DiagnoseError> {
    let read = Map::read(map, "map.toml")?;
    let model = CoSimulationModel::new(read, map, "map.toml", Arc::new(Spring::new()))?;
    let file = model.into_model_file();
    assert_eq!(file.name, "spring");
    let columns: Vec<String> = file.model.columns().into_iter().map(|spec| spec.name).collect();
    assert_eq!(columns, ["force_N", "x_mm"]);
    file.model.with_recordings(vec![recording()])
}

#[test]
fn a_column_is_the_output_in_its_unit() {
    let specimen = specimen(MAP).expect("a specimen");
    let truth = specimen.simulate(&Hypothesis::default(), 0).expect("simulated");
    let force = &specimen.observe(&Hypothesis::default(), 0, &truth)[0];
    // At 1 s: 0.02 m and 0.02 m/s.
    assert!(
        (force[100] - (2.0 * (100.0 * 0.02 + 3.0 * 0.02) + 1.0)).abs() < 1e-9,
        "{}",
        force[100]
    );
    assert_eq!(specimen.remarks().len(), 1);
    assert!(specimen.remarks()[0].contains("input spare"));
    assert_eq!(specimen.measured(0, 0).len(), 200);
}

#[test]
fn the_map_of_a_hypothesis_simulates_as_the_hypothesis() {
    let specimen = specimen(MAP).expect("a specimen");
    let index = |label: &str| {
        let found = specimen.candidates().iter().position(|c| c.label == label);
        found.unwrap_or_else(|| panic!("no {label}"))
    };
    let gain = (specimen.candidates().iter())
        .position(|c| c.id == EffectId::SensorGain && c.place.to_string() == "sensor:x_mm")
        .expect("a gain");
    let softens = index("k over time_s");
    let hypothesis = Hypothesis {
        calibration: vec![0.05, 2e-4, 0.3],
        effects: vec![
            (index("force_N over rate of x_mm, proportional"), vec![0.5]),
            (gain, vec![0.02]),
            (softens, vec![-0.1; specimen.candidates()[softens].parameters.len()]),
        ],
    };
    let shown = |specimen: &dyn Specimen, hypothesis: &Hypothesis| {
        let truth = specimen.simulate(hypothesis, 0).expect("simulated");
        specimen.observe(hypothesis, 0, &truth)
    };
    let as_put = shown(&*specimen, &hypothesis);
    let plain = shown(&*specimen, &Hypothesis::default());
    assert!(as_put[0].iter().zip(&plain[0]).any(|(a, b)| (a - b).abs() > 1.0));
    let text = specimen.model_toml(&hypothesis).expect("a map");
    let again = self::specimen(&text).expect("a specimen");
    let read = shown(&*again, &Hypothesis::default());
    assert!(
        as_put[0].iter().zip(&read[0]).all(|(a, b)| (a - b).abs() < 1e-9),
        "{text}"
    );
    assert_eq!(specimen.model_file(), "map.toml");
}

#[test]
fn what_does_not_fit_or_does_not_run_is_one_line() {
    for (map, expected) in [
        (
            MAP.replace("k = {", "kk = {"),
            "map.toml:7: [parameters] kk is not there",
        ),
        (
            MAP.replace("force = {", "k = {"),
            "[outputs] k is another thing: the outputs of the model are force",
        ),
        (
            MAP.replace("{ tolerance = 0.1 }", "{ value = 151.0 }"),
            "recording ramp: too stiff",
        ),
        (
            format!(
                "{MAP}[[effects.law]]\nat = \"parameter\"\nof = \"d\"\nover = \"time_s\"\nargument = [0.0, 1.0]\nvalue = [1.0, 1.0]\n"
            ),
            "of is \"d\"",
        ),
        (
            format!("{MAP}[effects.sensor_gain]\nforc_N = 0.1\n"),
            "did you mean force_N?",
        ),
    ] {
        let said = specimen(&map).err().map_or_else(String::new, |error| error.to_string());
        assert!(said.contains(expected) && !said.contains('\n'), "{said}");
    }
}
