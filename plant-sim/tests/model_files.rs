//! The one reader of model files: every complaint names the line, the table, the key and what would be right.

use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::model_file::ModelFileError;
use oleo_plant_sim::specimen::{CylinderModel, DamperModel, DriveModel, GasSpringModel};
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::VehicleParameters;
use proptest::prelude::*;

/// A strut in every way that TOML has to write a table: headers, arrays of tables, inline tables, dotted keys. Keys of
/// the same name stand in several tables, and one key is the end of another.
const STRUT: &str = r#"# A comment before anything else.
orifice.transition_pressure_Pa = 20000.0
cylinder = { bore_m = 0.05, oil_volume_m3 = 0.0009, static_pressure_Pa = 4.0e6 }
gas.species = "nitrogen"
gas.temperature_K = 293.15

[specimen]
name = "a"
kind = "two-stage hydropneumatic strut"

[[accumulator]]
static_gas_volume_m3 = 0.0001

[[accumulator]]
static_gas_volume_m3 = 0.0004

[[valve]]
flow_coefficient = 3.2e-6
in_parallel = 1
[[valve]]
flow_coefficient = 3.3e-6
in_parallel = 2
[[valve]]
flow_coefficient = 3.4e-6
in_parallel = 3

[[damper]]
flow_m3_s = [-0.002, 0.0, 0.002]
pressure_drop_Pa = [-2.0e6, 0.0, 1.0e6]

[[damper]]
flow_m3_s = [
    -0.002,
    -0.001,
    # the origin
    0.0,
    0.002,
]
pressure_drop_Pa = [
    -2.0e6,
    -1.5e6,
    0.0,
    1.0e6,
]

[valve_timing]
response_polynomial_s = [0.04, 0.0022, 0.00006]
initial_delay_fraction = 0.4

[effects]
mount_compliance = { stiffness_N_m = 5.0e6 }
damper_leakage.flow_coefficient_1 = 1.0e-8
damper_leakage.flow_coefficient_2 = 2.0e-8

[effects.seal_friction]
presliding_stiffness_N_m = 2.0e6
coulomb_force_N = 100.0
breakaway_force_N = 120.0
stribeck_speed_m_s = 0.02

[effects.bump_stop]
bump_clearance_m = 0.08
rebound_clearance_m = 0.14
stiffness_N_m = 2.0e5
progression_N_m3 = 1.0e8

[effects.valve3_leakage]
flow_coefficient = 1.0e-9

[[effects.unlisted]]
place = "path-1"
depends_on = "flow"
argument = [-1.0e-3, 1.0e-3]
value = [-1.0e5, 1.0e5]

[[effects.unlisted]]
place = "path-2"
depends_on = "flow"
argument = [-1.0e-3, 1.0e-3]
value = [-1.0e5, 1.0e5]

[tolerance]
static_gas_volume = 0.01

[noise]
displacement_m = 5.0e-6
p1_Pa = 4000.0
"#;

fn read(text: &str) -> Result<StrutModel, ModelFileError> {
    StrutModel::from_toml(text, "m.toml")
}

/// The complaint about [`STRUT`] with the `nth` place (from 1) of a piece replaced by another, and that place's line.
fn damaged(piece: &str, nth: usize, by: &str) -> (String, usize) {
    let (at, _) = STRUT.match_indices(piece).nth(nth - 1).expect("the piece is there");
    let text = format!("{}{by}{}", &STRUT[..at], &STRUT[at + piece.len()..]);
    let complaint = read(&text).expect_err("must be refused").to_string();
    assert_eq!(complaint.lines().count(), 1, "{complaint}");
    (complaint, 1 + STRUT[..at].matches('\n').count())
}

#[test]
fn the_strut_of_this_file_is_read() {
    let model = read(STRUT).unwrap();
    assert_eq!(model.accumulator[1].static_gas_volume_m3, 4e-4);
    assert_eq!(read(&model.to_toml()).unwrap(), model);
}

#[test]
fn a_value_is_reported_at_its_own_place_among_others_of_the_same_name() {
    for (piece, nth, by, complaint) in [
        (
            "static_gas_volume_m3 = 0.0004",
            1,
            "static_gas_volume_m3 = -0.0004",
            "[accumulator 2] static_gas_volume_m3 is -0.0004: must be from 1e-9 to 10 m3",
        ),
        (
            "flow_coefficient = 3.4e-6",
            1,
            "flow_coefficient = 0",
            "[valve 3] flow_coefficient is 0: must be from 1e-12 to 1 m3/s/sqrt(Pa)",
        ),
        (
            "flow_coefficient = 1.0e-9",
            1,
            "flow_coefficient = -1",
            "[effects.valve3_leakage] flow_coefficient is -1: must be from 0 to 1 m3/s/sqrt(Pa)",
        ),
        // Not the presliding stiffness, whose key ends the same, nor the mount's, which stands further up.
        (
            "\nstiffness_N_m = 2.0e5",
            1,
            "\nstiffness_N_m = -2.0e5",
            "[effects.bump_stop] stiffness_N_m is -200000: must be from 0 to 1e12 N/m",
        ),
        (
            "{ stiffness_N_m = 5.0e6 }",
            1,
            "{ stiffness_N_m = 0.0 }",
            "[effects.mount_compliance] stiffness_N_m is 0: must be from 1 to 1e16 N/m",
        ),
        (
            "oil_volume_m3 = 0.0009",
            1,
            "oil_volume_m3 = 900.0",
            "[cylinder] oil_volume_m3 is 900: must be from 1e-7 to 10 m3",
        ),
        (
            "gas.temperature_K = 293.15",
            1,
            "gas.temperature_K = 20",
            "[gas] temperature_K is 20: must be from 100 to 1000 K",
        ),
        (
            "damper_leakage.flow_coefficient_2 = 2.0e-8",
            1,
            "damper_leakage.flow_coefficient_2 = nan",
            "[effects.damper_leakage] flow_coefficient_2 is NaN: must be from 0 to 1 m3/s/sqrt(Pa)",
        ),
        (
            "value = [-1.0e5, 1.0e5]",
            2,
            "value = [1.0e5, -1.0e5]",
            "[effects.unlisted 2] value, entry 2, is -100000: a law at \"path-2\" must not fall",
        ),
        (
            "place = \"path-2\"",
            1,
            "place = \"path-1\"",
            "[effects.unlisted 2] place is \"path-1\", which has a law already: keep one of them",
        ),
        (
            "in_parallel = 2",
            1,
            "in_parallel = 2.5",
            "[valve 2] in_parallel is 2.5: must be a whole number, 0 or more",
        ),
        (
            "in_parallel = 3",
            1,
            "in_parallel = \"three\"",
            "[valve 3] in_parallel is the text \"three\": must be a whole number, 0 or more",
        ),
        (
            "p1_Pa = 4000.0",
            1,
            "p1_pa = 4000.0",
            "[noise] p1_pa is not a channel of this specimen: did you mean p1_Pa?",
        ),
        (
            "static_gas_volume = 0.01",
            1,
            "gas_volume = 0.01",
            "[tolerance] gas_volume is not a tolerance of this specimen: did you mean static_gas_volume?",
        ),
    ] {
        let (found, line) = damaged(piece, nth, by);
        let line = line + usize::from(piece.starts_with('\n'));
        assert!(
            found.starts_with(&format!("m.toml:{line}: {complaint}")),
            "{found}\nexpected at line {line}: {complaint}"
        );
    }
}

#[test]
fn an_entry_of_an_array_is_reported_at_its_own_line() {
    let line_of = |piece: &str| 1 + STRUT.lines().position(|line| line == piece).unwrap();
    let (found, line) = damaged("    -1.5e6,", 1, "    0.5e6,");
    assert_eq!(line, line_of("    -1.5e6,"));
    let below = line + 1;
    assert_eq!(
        found,
        format!(
            "m.toml:{below}: [damper 2] pressure_drop_Pa, entry 3, is 0: must be above the entry before it, which is 500000"
        )
    );
    let (found, line) = damaged("    -1.5e6,", 1, "    inf,");
    assert!(
        found.starts_with(&format!(
            "m.toml:{line}: [damper 2] pressure_drop_Pa, entry 2, is inf: "
        )),
        "{found}"
    );
    let (found, line) = damaged("    -1.5e6,", 1, "    \"x\",");
    assert!(
        found.starts_with(&format!(
            "m.toml:{line}: [damper 2] pressure_drop_Pa, entry 2, is the text \"x\": must be a number"
        )),
        "{found}"
    );
    let (found, _) = damaged("    -1.5e6,", 1, "");
    assert!(
        found.contains("[damper 2] pressure_drop_Pa has 3 entries: must have as many as flow_m3_s, which has 4"),
        "{found}"
    );
}

#[test]
fn unknown_and_missing_keys_are_told_with_what_would_be_right() {
    let (found, line) = damaged("bore_m", 1, "boar_m");
    assert!(
        found.starts_with(&format!(
            "m.toml:{line}: [cylinder] boar_m is not a known key: did you mean bore_m? The known keys are bore_m, \
             oil_volume_m3, static_pressure_Pa"
        )),
        "{found}"
    );
    let (found, line) = damaged("stribeck_speed_m_s = 0.02\n", 1, "");
    let header = 1 + STRUT
        .lines()
        .position(|line| line == "[effects.seal_friction]")
        .unwrap();
    assert!(header < line);
    assert_eq!(
        found,
        format!("m.toml:{header}: [effects.seal_friction] stribeck_speed_m_s is missing: add it")
    );
    let (found, line) = damaged("static_gas_volume_m3 = 0.0004\n", 1, "");
    assert_eq!(
        found,
        format!(
            "m.toml:{}: [accumulator 2] static_gas_volume_m3 is missing: add it",
            line - 1
        )
    );
    let (found, _) = damaged(
        "[valve_timing]\nresponse_polynomial_s = [0.04, 0.0022, 0.00006]\ninitial_delay_fraction = 0.4\n",
        1,
        "",
    );
    assert_eq!(found, "m.toml:1: valve_timing is missing: add it");
    let (found, line) = damaged("\"path-1\"", 1, "\"path-3\"");
    assert!(
        found.starts_with(&format!(
            "m.toml:{line}: [effects.unlisted 1] place is \"path-3\": must be one of "
        )),
        "{found}"
    );
    let (found, _) = damaged("[[accumulator]]\nstatic_gas_volume_m3 = 0.0001\n", 1, "");
    assert!(found.contains("accumulator") && found.contains("2 entries"), "{found}");
}

#[test]
fn what_is_not_toml_is_told_with_its_line() {
    let (found, line) = damaged("[effects.bump_stop]", 1, "[effects.bump_stop");
    assert!(
        found.starts_with(&format!("m.toml:{line}: this is not TOML: ")),
        "{found}"
    );
    let twice = format!("{STRUT}\n[noise]\n");
    let found = read(&twice).unwrap_err().to_string();
    assert!(
        found.starts_with(&format!("m.toml:{}: this is not TOML: ", twice.lines().count())),
        "{found}"
    );
    for text in ["", "x", "[", "\u{0}", "a = 1\n\n\n[", "\"a\nb\" = 1"] {
        let found = read(text).unwrap_err().to_string();
        assert!(found.starts_with("m.toml") && found.lines().count() == 1, "{found}");
    }
}

/// The numbers of a text: their lines and places.
fn numbers(text: &str) -> Vec<(usize, std::ops::Range<usize>)> {
    let mut found = Vec::new();
    let mut start = 0;
    for (k, line) in text.split_inclusive('\n').enumerate() {
        let code = line.split('#').next().unwrap_or("");
        let values = code.find('=').map_or(0, |at| at + 1);
        if code[values..].trim_start().starts_with('"') {
            start += line.len();
            continue;
        }
        // A line may hold several numbers, in an array or an inline table.
        let mut at = values;
        for word in code[values..].split([',', '[', ']', '{', '}', ' ', '\n']) {
            if word.parse::<f64>().is_ok() {
                let begin = start + code[at..].find(word).map_or(at, |offset| at + offset);
                found.push((k + 1, begin..begin + word.len()));
                at = begin - start + word.len();
            }
        }
        start += line.len();
    }
    found
}

/// What reads a file.
type Reader = fn(&str) -> Result<(), ModelFileError>;

/// A file of every kind, and what reads it.
fn files() -> Vec<(String, Reader)> {
    let spring = "[specimen]\nname = \"a\"\nkind = \"gas spring\"\n[chamber]\narea_m2 = 0.01\nvolume_at_zero_m3 = 0.05\n[gas]\n\
                  species = \"nitrogen\"\nprocess = \"adiabatic\"\ntemperature_K = 293.15\n[effects.sensor_lag]\np_Pa = 0.1\n\
                  [noise]\np_Pa = 300.0\n";
    let cylinder = "chamber = [\n    { column = \"a_Pa\", area_m2 = 0.001 },\n    { column = \"b_Pa\", area_m2 = -0.002 },\n]\n\
                    [specimen]\nname = \"a\"\nkind = \"cylinder\"\n[effects]\nmoving_mass_kg = 3.0\n[tolerance]\narea = 0.03\n";
    let damper = "[specimen]\nname = \"a\"\nkind = \"damper\"\n[damper]\nviscous_N_s_m = 1500.0\noffset_N = 2.0\n[effects]\n\
                  presliding_friction = { coulomb_force_N = 50.0, presliding_stiffness_N_m = 1e6, breakaway_force_N = 60.0, stribeck_speed_m_s = 0.01 }\n\
                  smooth_yield = { yield_force_N = 300.0, yield_speed_m_s = 0.02 }\nstiffness = { stiffness_N_m = 100.0 }\n\
                  gas_spring = { gas_force_N = 50.0, gas_length_m = 0.3 }\nunlisted = { turbulent_N_s2_m2 = 3.0 }\n\
                  [tolerance]\nviscous = 0.3\n[noise]\nforce_N = 5.0\n";
    let drive = "[specimen]\nname = \"a\"\nkind = \"drive\"\n[drive]\nmass_kg = 95.0\nviscous_N_s_m = 200.0\n[effects]\n\
                 coulomb_friction = { coulomb_force_N = 20.0 }\nforce_offset = { force_N = -3.0 }\nbacklash = { gap_m = 1e-4 }\n\
                 stribeck_friction = { coulomb_force_N = 20.0, breakaway_force_N = 25.0, stribeck_speed_m_s = 0.01 }\n\
                 inertia = { moving_mass_kg = 2.0 }\nsensor_skew = { position_m = 0.002 }\n[tolerance]\nmass = 0.15\n";
    vec![
        (STRUT.to_owned(), |text| read(text).map(drop)),
        (StrutModel::defender110(8000.0).to_toml(), |text| read(text).map(drop)),
        (include_str!("../presets/strut-defender110.toml").to_owned(), |text| {
            read(text).map(drop)
        }),
        (include_str!("../presets/defender110.toml").to_owned(), |text| {
            VehicleParameters::from_toml(text, "m.toml").map(drop)
        }),
        (
            include_str!("../presets/defender110-handling.toml").to_owned(),
            |text| HandlingParameters::from_toml(text, "m.toml").map(drop),
        ),
        (spring.to_owned(), |text| {
            GasSpringModel::from_toml(text, "m.toml").map(drop)
        }),
        (cylinder.to_owned(), |text| {
            CylinderModel::from_toml(text, "m.toml").map(drop)
        }),
        (damper.to_owned(), |text| {
            DamperModel::from_toml(text, "m.toml").map(drop)
        }),
        (drive.to_owned(), |text| DriveModel::from_toml(text, "m.toml").map(drop)),
    ]
}

/// Every number of every model file, damaged alone, is reported at its own line.
#[test]
fn any_single_damaged_number_is_reported_at_its_own_line() {
    let mut tried = 0;
    for (text, read) in files() {
        assert_eq!(read(&text), Ok(()));
        for (line, place) in numbers(&text) {
            for by in ["nan", "inf", "\"x\"", "[]", "{}"] {
                let damaged = format!("{}{by}{}", &text[..place.start], &text[place.end..]);
                let complaint = read(&damaged).expect_err(by);
                assert_eq!(
                    complaint.line(),
                    Some(line),
                    "{complaint} ({by} for {})",
                    &text[place.clone()]
                );
                tried += 1;
            }
        }
    }
    assert!(tried > 1000, "{tried}");
}

proptest! {
    /// The same wherever the file is longer by comments and empty lines.
    #[test]
    fn lines_are_counted_whatever_stands_between(
        which in 0usize..1000,
        file in 0usize..7,
        filler in proptest::collection::vec((0usize..200, prop_oneof![Just("\n"), Just("# nan = 1\n"), Just("   \n")]), 0..20),
    ) {
        let (text, read) = files().swap_remove(file);
        let numbers = numbers(&text);
        let (line, place) = numbers[which % numbers.len()].clone();
        let damaged = format!("{}nan{}", &text[..place.start], &text[place.end..]);
        let mut lines: Vec<String> = damaged.split_inclusive('\n').map(str::to_owned).collect();
        let mut expected = line;
        for (at, blank) in filler {
            let at = at % lines.len();
            lines.insert(at, blank.to_owned());
            expected += usize::from(at < expected);
        }
        prop_assert_eq!(read(&lines.concat()).unwrap_err().line(), Some(expected));
    }

    #[test]
    fn no_text_does_harm(text in "\\PC{0,200}") {
        for (_, read) in files() {
            if let Err(complaint) = read(&text) {
                prop_assert_eq!(complaint.to_string().lines().count(), 1);
            }
        }
    }
}
