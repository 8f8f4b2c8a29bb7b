//! Recordings as they come: `oleo diagnose` must answer each with one clear line (exit status 2, nothing written) or with
//! a sound report that says what was used and what could not be tested.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use oleo_interface::StrutValves;
use oleo_plant_sim::specimen::GasSpringModel;
use oleo_plant_sim::strut::{Inputs, StrutModel, replay};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use serde_json::Value;
use tempfile::TempDir;

const SPRING: &str = r#"[specimen]
name = "spring"
kind = "gas spring"
[chamber]
area_m2 = 0.01
volume_at_zero_m3 = 0.03
[gas]
species = "nitrogen"
process = "adiabatic"
temperature_K = 293.15
[tolerance]
volume_at_zero = 0.02
initial_pressure = 0.01
temperature_K = 5.0
[noise]
displacement_m = 1e-5
p_Pa = 300.0
"#;

/// Thermal time constant of the simulated gas spring, s, which its model lacks.
const TAU_S: f64 = 6.0;

/// White noise of standard deviation 1, the same in every run.
fn white_noise(seed: u64) -> impl FnMut() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move || StandardNormal.sample(&mut random)
}

/// Triangle of period 1 between -1 and 1, from 0 up.
fn triangle(cycles: f64) -> f64 {
    let part = (cycles + 0.25).fract();
    1.0 - 4.0 * (part - 0.5).abs()
}

/// A recording of the gas spring: strokes with holds, `amplitude` in m.
fn spring(samples: usize, interval_s: f64, amplitude_m: f64) -> String {
    let text = format!("{SPRING}[effects.gas_heat_transfer]\ntime_constant_s = {TAU_S}\n");
    let model = GasSpringModel::from_toml(&text, "spring").expect("valid");
    let time: Vec<f64> = (0..samples).map(|k| k as f64 * interval_s).collect();
    let x: Vec<f64> = (time.iter())
        .map(|t| amplitude_m * (1.5 * triangle(t / 23.0)).clamp(-1.0, 1.0))
        .collect();
    let p = model.pressure_pa(&time, &x, 1e6).expect("possible");
    let mut noise = white_noise(9);
    let mut csv = "time_s,displacement_m,p_Pa\n".to_owned();
    for ((t, x), p) in time.iter().zip(&x).zip(&p) {
        let _ = writeln!(csv, "{t:.6},{:.7},{:.1}", x + 1e-5 * noise(), p + 300.0 * noise());
    }
    csv
}

/// A strut recorded as the preset predicts it, valves as given, at 100 Hz.
fn strut(amplitude_m: f64, signals: [bool; 3]) -> (String, String) {
    let mut model = StrutModel::defender110(8_000.0);
    model.noise = [("displacement_m", 5e-6), ("force_N", 12.0)]
        .map(|(k, v)| (k.to_owned(), v))
        .into();
    for column in ["p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"] {
        model.noise.insert(column.into(), 4e3);
    }
    let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 0.01).collect();
    let x: Vec<f64> = time.iter().map(|t| amplitude_m * triangle(t / 2.0)).collect();
    let inputs = Inputs::from_recording(&time, &x, &vec![StrutValves::from_array(signals); time.len()], 0.0);
    let out = replay(&model, &inputs).expect("possible");
    let mut noise = white_noise(5);
    let mut csv = "time_s,displacement_m,force_N,p1_Pa,p2_Pa,p3_Pa,p4_Pa,valve1,valve2,valve3\n".to_owned();
    for k in 0..time.len() {
        let _ = write!(
            csv,
            "{:.4},{:.7},{:.2}",
            time[k],
            x[k] + 5e-6 * noise(),
            out.force_n[k] + 12.0 * noise()
        );
        for p in &out.pressure_pa {
            let _ = write!(csv, ",{:.0}", p[k] + 4e3 * noise());
        }
        let [a, b, c] = signals.map(u8::from);
        let _ = writeln!(csv, ",{a},{b},{c}");
    }
    (model.to_toml(), csv)
}

struct Campaign(TempDir);

impl Campaign {
    fn new(model: &str, recordings: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir(folder.path().join("campaign")).expect("a folder");
        fs::write(folder.path().join("campaign/model.toml"), model).expect("written");
        for (name, text) in recordings {
            fs::write(folder.path().join("campaign").join(name), text).expect("written");
        }
        Self(folder)
    }

    fn of_spring(recording: &str) -> Self {
        Self::new(SPRING, &[("a.csv", recording)])
    }

    fn command(&self, out: &Path) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_oleo"));
        command
            .current_dir(self.0.path())
            .args(["diagnose", "campaign", "--out"])
            .arg(out);
        command
    }

    fn run(&self) -> Output {
        self.command(Path::new("found")).output().expect("the program starts")
    }

    /// The report; the run must succeed.
    fn report(&self) -> Value {
        let run = self.run();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let text = fs::read_to_string(self.0.path().join("found/report.json")).expect("a report");
        serde_json::from_str(&text).expect("JSON")
    }

    /// The one line of a run that must fail and leave nothing.
    fn refusal(&self) -> String {
        let run = self.run();
        let line = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{line}");
        assert_eq!(line.lines().count(), 1, "{line}");
        assert!(run.stdout.is_empty() && line.starts_with("error: "), "{line}");
        assert_eq!(self.names(), ["campaign"], "nothing is left behind");
        line
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = (fs::read_dir(self.0.path()).expect("a folder"))
            .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

/// The refusal names all of these: what, where, what to do.
fn refused(campaign: &Campaign, parts: &[&str]) {
    let line = campaign.refusal();
    for part in parts {
        assert!(line.contains(part), "'{part}' in: {line}");
    }
}

fn ids(report: &Value, list: &str) -> Vec<String> {
    (report[list].as_array().expect("a list").iter())
        .map(|e| e["id"].as_str().expect("an id").to_owned())
        .collect()
}

fn notes(report: &Value) -> String {
    report["notes"].to_string()
}

/// A line of a recording replaced; the header is line 1.
fn with_line(csv: &str, line: usize, text: &str) -> String {
    let mut lines: Vec<&str> = csv.lines().collect();
    lines[line - 1] = text;
    lines.join("\n") + "\n"
}

#[test]
fn a_missing_column_or_another_unit() {
    let good = spring(500, 0.02, 0.5);
    let missing = Campaign::of_spring(&good.replacen("p_Pa", "temperature_K", 1));
    refused(
        &missing,
        &[
            "a.csv, line 1",
            "column 'p_Pa' is missing",
            "the file has: time_s, displacement_m",
        ],
    );
    let unit = Campaign::of_spring(&good.replacen("p_Pa", "p_bar", 1));
    refused(
        &unit,
        &["a.csv, line 1", "'p_bar' has an unknown unit", "'p_Pa' is expected"],
    );
    let time = Campaign::of_spring(&good.replacen("time_s", "time_ms", 1));
    refused(&time, &["a.csv, line 1", "'time_ms'", "'time_s' is expected"]);
}

/// A recording with the numbers of a column multiplied, and its title as it was.
fn scaled(csv: &str, column: &str, factor: f64) -> String {
    let titles = csv.lines().next().expect("a header");
    let at = titles.split(',').position(|title| title == column).expect("the column");
    let mut out = format!("{titles}\n");
    for line in csv.lines().skip(1) {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        cells[at] = (factor * cells[at].parse::<f64>().expect("a number")).to_string();
        out += &(cells.join(",") + "\n");
    }
    out
}

#[test]
fn numbers_in_another_unit_below_the_right_title() {
    let (model, csv) = strut(0.03, [true, true, true]);
    let with = |column: &str, factor: f64| Campaign::new(&model, &[("a.csv", &scaled(&csv, column, factor))]);
    refused(
        &with("displacement_m", 1e3),
        &["a.csv: displacement_m goes over 5", "give it in m"],
    );
    refused(&with("time_s", 1e3), &["a.csv: time_s goes on by 10", "milliseconds"]);
    refused(&with("force_N", 1e-3), &["recording a: force_N", "if it is in kN"]);
    refused(&with("p1_Pa", 1e-5), &["recording a: p1_Pa", "if it is in bar"]);
    refused(
        &with("p4_Pa", 1.0 / 6894.757),
        &["recording a: p4_Pa", "if it is in psi"],
    );
}

#[test]
fn time_that_goes_back_or_stands_still() {
    let good = spring(500, 0.02, 0.5);
    let back = Campaign::of_spring(&with_line(&good, 77, "0.5,0.1,1e6"));
    refused(&back, &["a.csv, line 77", "time_s goes backwards", "sort the rows"]);
    let line = good.lines().nth(98).expect("long enough");
    let twice = Campaign::of_spring(&with_line(&good, 100, line));
    refused(&twice, &["a.csv, line 100", "time_s is repeated", "drop duplicates"]);
}

#[test]
fn what_is_no_number() {
    let good = spring(500, 0.02, 0.5);
    for (text, shown) in [
        ("9.0,0.1,NaN", "'NaN'"),
        ("9.0,,1e6", "''"),
        ("9.0,0.1,inf", "'inf'"),
        ("9.0,0.1,1e6 Pa", "'1e6 Pa'"),
    ] {
        let bad = Campaign::of_spring(&with_line(&good, 452, text));
        refused(
            &bad,
            &["a.csv, line 452", shown, "not a finite number", "repair or cut"],
        );
    }
    let ragged = Campaign::of_spring(&with_line(&good, 300, "5.98,0.1"));
    refused(
        &ragged,
        &["a.csv, line 300", "the row has 2 fields, but the header has 3"],
    );
    let (model, csv) = strut(0.01, [true; 3]);
    let half_open = csv.replacen(",1,1,1\n", ",1,0.5,1\n", 1);
    refused(
        &Campaign::new(&model, &[("a.csv", &half_open)]),
        &["a.csv, line 2", "valve2 is 0.5", "0 (closed) or 1 (open)"],
    );
}

#[test]
fn too_little_or_nothing() {
    refused(
        &Campaign::of_spring(&spring(10, 0.02, 0.5)),
        &["a.csv", "10 usable samples", "at least 50", "record longer"],
    );
    refused(&Campaign::of_spring(""), &["a.csv", "column 'time_s' is missing"]);
    refused(
        &Campaign::of_spring("time_s,displacement_m,p_Pa\n"),
        &["a.csv", "0 usable samples"],
    );
    refused(
        &Campaign::new(SPRING, &[]),
        &["campaign", "holds no recording", "*.csv"],
    );
    let binary = Campaign::of_spring("");
    fs::write(
        binary.0.path().join("campaign/a.csv"),
        [0xFF, 0xFE, 0x00, 0x0A, 0xC3, 0x28],
    )
    .expect("written");
    refused(&binary, &["a.csv"]);
}

#[test]
fn a_model_that_is_wrong() {
    let csv = spring(500, 0.02, 0.5);
    let cases: [(&str, &str, &[&str]); 10] = [
        (
            "area_m2 = 0.01",
            "area_m2 = -0.01",
            &["model.toml:5: [chamber] area_m2 is -0.01: must be from 1e-6 to 1 m2"],
        ),
        (
            "area_m2 = 0.01",
            "area_mm2 = 0.01",
            &["model.toml:5: [chamber] area_mm2 is not a known key: did you mean area_m2?"],
        ),
        (
            "\"gas spring\"",
            "\"gas strut\"",
            &[
                "model.toml:",
                "[specimen] kind is \"gas strut\"",
                "did you mean gas spring?",
            ],
        ),
        ("[chamber]", "[chamber", &["model.toml:4: this is not TOML"]),
        (
            "temperature_K = 293.15",
            "temperature_K = nan",
            &["model.toml:10: [gas] temperature_K is NaN: must be from 200 to 400 K"],
        ),
        (
            "volume_at_zero_m3 = 0.03",
            "volume_at_zero_m3 = 0.004",
            &["a", "gas volume", "volume_at_zero_m3"],
        ),
        (
            "p_Pa = 300.0\n",
            "",
            &["model.toml:15: [noise] p_Pa is missing: state the standard deviation"],
        ),
        (
            "p_Pa = 300.0",
            "p_pa = 300.0",
            &["model.toml:17: [noise] p_pa is not a channel of this specimen: did you mean p_Pa?"],
        ),
        (
            "p_Pa = 300.0",
            "p_Pa = 0.0",
            &["model.toml:17: [noise] p_Pa is 0: must be above 0"],
        ),
        (
            "[noise]\ndisplacement_m = 1e-5\np_Pa = 300.0\n",
            "",
            &["model.toml", "[noise] displacement_m is missing, and so is p_Pa"],
        ),
    ];
    for (from, to, parts) in cases {
        refused(&Campaign::new(&SPRING.replacen(from, to, 1), &[("a.csv", &csv)]), parts);
    }
    let none = Campaign::of_spring(&csv);
    fs::remove_file(none.0.path().join("campaign/model.toml")).expect("removed");
    refused(&none, &["model.toml", "a campaign needs a model.toml"]);
    fs::remove_dir_all(none.0.path().join("campaign")).expect("removed");
    fs::write(none.0.path().join("campaign"), "not a folder").expect("written");
    refused(&none, &["campaign", "is not a folder"]);
}

#[test]
fn a_hole_is_said_and_what_is_before_it_used() {
    let whole = spring(6000, 0.02, 0.5);
    let mut lines: Vec<&str> = whole.lines().collect();
    lines.drain(3001..3500);
    let report = Campaign::of_spring(&(lines.join("\n") + "\n")).report();
    assert!(
        notes(&report).contains("there is a gap from 59.98 s to 69.98 s; the 2501 samples after it were not used"),
        "{report}"
    );
    assert_eq!(ids(&report, "effects"), ["gas_heat_transfer"]);
}

#[test]
fn files_of_different_rates_and_one_too_short() {
    let (a, b, c) = (
        spring(3000, 0.02, 0.8),
        spring(12_000, 0.004, 0.6),
        spring(20, 0.02, 0.5),
    );
    let report = Campaign::new(SPRING, &[("a.csv", &a), ("b.csv", &b), ("c.csv", &c)]).report();
    assert_eq!(ids(&report, "effects"), ["gas_heat_transfer"]);
    let tau = report["effects"][0]["parameters"]["time_constant_s"]["value"]
        .as_f64()
        .expect("a number");
    assert!((tau / TAU_S - 1.0).abs() < 0.02, "{tau}");
    assert!(
        notes(&report).contains("was left out: campaign/c.csv: there are 20 usable samples"),
        "{}",
        notes(&report)
    );
}

#[test]
fn no_motion_tests_nothing_and_says_so() {
    let report = Campaign::of_spring(&spring(2000, 0.02, 0.0)).report();
    assert_eq!(report["verdict"], "consistent");
    let not_tested = ids(&report, "not_tested");
    assert!(
        not_tested.contains(&"gas_heat_transfer".into()) && not_tested.contains(&"sensor_skew".into()),
        "{not_tested:?}"
    );
    assert!(
        ids(&report, "rejected").is_empty(),
        "what cannot be tested is not rejected either"
    );
    assert!(
        report["not_tested"][0]["why"]
            .as_str()
            .expect("a reason")
            .contains("record strokes")
    );

    let (model, csv) = strut(0.0, [true; 3]);
    let report = Campaign::new(&model, &[("a.csv", &csv)]).report();
    assert_eq!(report["verdict"], "consistent");
    let not_tested = ids(&report, "not_tested");
    for id in [
        "damper_leakage",
        "line_resistance",
        "mount_compliance",
        "valve3_leakage",
    ] {
        assert!(not_tested.contains(&id.into()), "{id}: {not_tested:?}");
    }
}

#[test]
fn valves_never_switched() {
    let (model, csv) = strut(0.03, [true, true, true]);
    // The preset has gradual valves; without them the model lacks what these recordings cannot show.
    let (from, to) = (model.find("[effects.valve_transition]").expect("preset"), model.len());
    let end = model[from + 1..].find("\n[").map_or(to, |k| from + 1 + k);
    let model = format!("{}{}", &model[..from], &model[end..]);
    let report = Campaign::new(&model, &[("a.csv", &csv)]).report();
    assert_eq!(ids(&report, "effects"), Vec::<String>::new(), "{report}");
    let not_tested = report["not_tested"].as_array().expect("a list");
    let of = |id: &str| not_tested.iter().filter(|e| e["id"] == id).count();
    assert!(of("valve_transition") > 0, "{not_tested:?}");
    assert!(of("valve3_leakage") == 1, "{not_tested:?}");
    for entry in not_tested {
        assert!(!entry["why"].as_str().expect("a reason").is_empty());
    }
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "minutes without optimisation; the recordings step of ./test runs it"
)]
fn ten_million_samples_in_bounded_memory() {
    // Ten million rows, written once in pieces: 1 kHz, the last 9.9 million at rest.
    let campaign = Campaign::of_spring("");
    let path = campaign.0.path().join("campaign/a.csv");
    let mut file = std::io::BufWriter::new(fs::File::create(path).expect("created"));
    let start = spring(100_000, 0.001, 0.8);
    std::io::Write::write_all(&mut file, start.as_bytes()).expect("written");
    let last = start
        .lines()
        .last()
        .expect("rows")
        .split_once(',')
        .expect("columns")
        .1
        .to_owned();
    for k in 100_000..10_000_000_u32 {
        let _ = std::io::Write::write_fmt(&mut file, format_args!("{}.{:03},{last}\n", k / 1000, k % 1000));
    }
    drop(file);
    let mut command = Command::new("sh");
    // 1 GiB of address space: the file's numbers alone would take 240 MB as one copy and the work several.
    command.current_dir(campaign.0.path()).arg("-c").arg(format!(
        "ulimit -v 1048576; exec '{}' diagnose campaign --out found",
        env!("CARGO_BIN_EXE_oleo")
    ));
    let run = command.env("RAYON_NUM_THREADS", "2").output().expect("a shell");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = fs::read_to_string(campaign.0.path().join("found/report.json")).expect("a report");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    assert!(
        notes(&report).contains("one of every 49 samples was used"),
        "{}",
        notes(&report)
    );
}

#[test]
fn an_output_that_cannot_be_written() {
    let campaign = Campaign::of_spring(&spring(500, 0.02, 0.5));
    let locked = campaign.0.path().join("locked");
    fs::create_dir(&locked).expect("a folder");
    let mut permissions = fs::metadata(&locked).expect("a folder").permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&locked, permissions).expect("a mode");
    // Root writes where modes forbid it; there the kernel's own folder says no.
    let target: PathBuf = if fs::write(locked.join("probe"), "").is_ok() {
        PathBuf::from("/proc/found")
    } else {
        locked.join("found")
    };
    let run = campaign.command(&target).output().expect("the program starts");
    let line = String::from_utf8_lossy(&run.stderr).into_owned();
    assert_eq!(run.status.code(), Some(2), "{line}");
    assert!(
        line.lines().count() == 1 && line.contains("found") && line.contains("cannot"),
        "{line}"
    );
    assert!(!target.exists());
}

/// The improved model does not replace the one that the user wrote, nor a prediction the recording that it was made from.
#[test]
fn no_output_replaces_an_input() {
    let campaign = Campaign::of_spring(&spring(500, 0.02, 0.5));
    let folder = campaign.0.path().join("campaign");
    let contents = || -> Vec<(PathBuf, Vec<u8>)> {
        let mut files: Vec<PathBuf> = (fs::read_dir(&folder).expect("a folder"))
            .map(|e| e.expect("an entry").path())
            .collect();
        files.sort();
        (files.into_iter())
            .map(|path| (path.clone(), fs::read(path).expect("a file")))
            .collect()
    };
    let before = contents();
    let recording = (before.iter().map(|(path, _)| path))
        .find(|path| path.extension().is_some_and(|e| e == "csv"))
        .expect("a recording");
    let mut predict = Command::new(env!("CARGO_BIN_EXE_oleo"));
    predict
        .arg("predict")
        .arg("--model")
        .arg(folder.join("model.toml"))
        .arg(recording);
    let mut over_model = Command::new(env!("CARGO_BIN_EXE_oleo"));
    over_model
        .args(predict.get_args())
        .arg("--out")
        .arg(folder.join("model.toml"));
    let over_recording = predict.arg("--out").arg(recording);
    for command in [
        campaign.command(Path::new("campaign/../campaign")).arg("--force"),
        over_recording,
        &mut over_model,
    ] {
        let run = command.output().expect("the program starts");
        let line = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{line}");
        assert!(
            line.lines().count() == 1 && line.contains("is an input of this command"),
            "{line}"
        );
        assert_eq!(contents(), before);
    }
}

/// Ctrl-C while it works: the program ends as interrupted programs do, and nothing is there.
#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing() {
    let campaign = Campaign::of_spring(&spring(100_000, 0.01, 0.8));
    let mut child = campaign
        .command(Path::new("found"))
        .spawn()
        .expect("the program starts");
    // It has begun once its staging folder is there; a diagnosis of a hundred thousand samples is far from done then.
    while campaign.names() == ["campaign"] {
        assert!(child.try_wait().expect("a child").is_none(), "it ended before it began");
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let sent = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .expect("kill");
    assert!(sent.success());
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert_eq!(campaign.names(), ["campaign"]);
}

#[test]
fn keeping_back_what_is_not_there() {
    let campaign = Campaign::of_spring(&spring(500, 0.02, 0.5));
    for (options, parts) in [
        (&["--hold-out", "b"][..], &["no recording 'b'", "it holds: a"][..]),
        (&["--hold-out", "a"], &["no recording is left to fit"]),
        (&["--fit-until", "1.5"], &["--fit-until", "0.05 to 0.95"]),
        (
            &["--fit-until", "0.06"],
            &["recording a", "30 samples", "fit a larger part"],
        ),
    ] {
        let run = campaign
            .command(Path::new("found"))
            .args(options)
            .output()
            .expect("the program starts");
        let line = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{line}");
        assert_eq!(line.lines().count(), 1, "{line}");
        for part in parts {
            assert!(line.contains(part), "'{part}' in: {line}");
        }
        assert_eq!(campaign.names(), ["campaign"]);
    }
}
