//! `oleo diagnose --fmu`: somebody else's model against recordings. The model is `tests/foreign/mount.c`, built here; the truth is computed in this file and has nothing in
//! common with it.

mod support;

use support::complaint;

/// A program without FMUs says how to come by one with them.
#[cfg(not(feature = "fmu"))]
#[test]
fn a_program_without_fmus_says_how_to_build_one_with_them() {
    let said = complaint(&support::run(&[
        "diagnose", "--fmu", "a.fmu", "--map", "map.toml", "a.csv",
    ]));
    assert!(said.contains("--features fmu"), "{said}");
}

#[cfg(feature = "fmu")]
mod with_feature {
    use std::fmt::Write as _;
    use std::io::Write as _;
    use std::path::{Path, PathBuf};
    use std::process::Command;

    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};
    use serde_json::Value;
    use tempfile::TempDir;
    use zip::write::{SimpleFileOptions, ZipWriter};

    use super::support::oleo;
    use super::*;

    fn path(path: &Path) -> &str {
        path.to_str().expect("a path in UTF-8")
    }

    /// Noise of the load cell, N.
    const NOISE_N: f64 = 2.0;
    const INTERVAL_S: f64 = 0.005;
    const SAMPLES: usize = 1200;

    /// What the specimen is beside what the model has.
    #[derive(Clone, Copy)]
    struct Truth {
        stiffness: f64,
        friction_n: f64,
        gain: f64,
        delay_s: f64,
        softening: f64,
    }

    const AS_MODELLED: Truth = Truth {
        stiffness: 20000.0,
        friction_n: 0.0,
        gain: 1.0,
        delay_s: 0.0,
        softening: 0.0,
    };

    /// Displacement and speed of a recording at a time.
    fn motion(recording: usize, t: f64) -> (f64, f64) {
        let base = 3.0 + 1.3 * recording as f64;
        let parts = [(0.006, base), (0.004, 2.7 * base), (0.0015, 9.1 * base)];
        let x = parts.iter().map(|(a, w)| a * libm::sin(w * t)).sum();
        let v = parts.iter().map(|(a, w)| a * w * libm::cos(w * t)).sum();
        (x, v)
    }

    /// The force of the mount over a recording, by small steps.
    fn force(truth: &Truth, recording: usize, time_s: &[f64]) -> Vec<f64> {
        const FINE: usize = 50;
        let (mut z, mut out) = (0.0, vec![]);
        let h = INTERVAL_S / FINE as f64;
        let mut fine = vec![];
        for k in 0..(time_s.len() * FINE) {
            let t = h * k as f64;
            let (x, v) = motion(recording, t);
            let friction = truth.friction_n * libm::tanh(v / 0.002);
            let stiffness = truth.stiffness * (1.0 - truth.softening * t);
            fine.push(truth.gain * (stiffness * x + 300.0 * v + z + friction));
            let (_, middle) = motion(recording, t + 0.5 * h);
            z += h * (8000.0 * middle - z / 0.05);
        }
        let late = (truth.delay_s / h).round() as usize;
        out.extend((0..time_s.len()).map(|k| fine[(k * FINE).saturating_sub(late)]));
        out
    }

    fn record(folder: &Path, truth: &Truth, recording: usize) -> PathBuf {
        let time_s: Vec<f64> = (0..SAMPLES).map(|k| INTERVAL_S * k as f64).collect();
        let mut random = ChaCha8Rng::seed_from_u64(7 + recording as u64);
        let mut text = "time_s,displacement_m,force_N\n".to_owned();
        for (t, force) in time_s.iter().zip(force(truth, recording, &time_s)) {
            let noise: f64 = StandardNormal.sample(&mut random);
            let _ = writeln!(
                text,
                "{t:.3},{:.9},{:.4}",
                motion(recording, *t).0,
                force + NOISE_N * noise
            );
        }
        let file = folder.join(format!("run{recording}.csv"));
        std::fs::write(&file, text).expect("written");
        file
    }

    /// Description of the mount in a version of FMI.
    fn description(version: u8) -> String {
        let variables = [
            ("displacement_m", "input", "continuous", ""),
            ("speed_m_s", "input", "continuous", ""),
            ("force_N", "output", "continuous", ""),
            ("stiffness_N_m", "parameter", "tunable", "20000"),
            ("viscous_N_s_m", "parameter", "fixed", "300"),
            ("relaxing_stiffness_N_m", "parameter", "fixed", "8000"),
            ("time_constant_s", "parameter", "fixed", "0.05"),
        ];
        let (open, token) = match version {
            2 => ("fmiVersion=\"2.0\"", "guid"),
            _ => ("fmiVersion=\"3.0\"", "instantiationToken"),
        };
        let mut text = format!(
            "<fmiModelDescription {open} modelName=\"mount\" {token}=\"{{mount}}\">\
             <CoSimulation modelIdentifier=\"mount\" canHandleVariableCommunicationStepSize=\"true\"/><ModelVariables>"
        );
        for (reference, (name, causality, variability, start)) in variables.iter().enumerate() {
            // What is computed has no start.
            let start = if *causality == "output" {
                String::new()
            } else {
                format!("start=\"{}\"", if start.is_empty() { "0" } else { start })
            };
            let head = format!(
                "name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"{variability}\""
            );
            let _ = match version {
                2 => write!(text, "<ScalarVariable {head}><Real {start}/></ScalarVariable>"),
                _ => write!(text, "<Float64 {head} {start}/>"),
            };
        }
        let head = "name=\"misbehave\" valueReference=\"0\" causality=\"parameter\" variability=\"fixed\"";
        text += &match version {
            2 => format!("<ScalarVariable {head}><Integer start=\"0\"/></ScalarVariable>"),
            _ => format!("<Int32 {head} start=\"0\"/>").replace("valueReference=\"0\"", "valueReference=\"100\""),
        };
        text + "</ModelVariables></fmiModelDescription>"
    }

    /// The mount as an FMU; `None` where there is no C compiler, which is said.
    fn mount(folder: &Path, version: u8) -> Option<PathBuf> {
        let library = folder.join("mount.so");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign/mount.c");
        let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
        let built = Command::new(&compiler)
            .args(["-shared", "-fPIC", "-O1", "-o", path(&library), path(&source), "-lm"])
            .status();
        match built {
            Ok(status) => assert!(status.success(), "{} does not compile", source.display()),
            Err(error) => {
                eprintln!("SKIPPED: no C compiler ({compiler}: {error}), so that no FMU can be built to try");
                return None;
            }
        }
        let library = std::fs::read(library).expect("a library");
        Some(pack(
            &folder.join("mount.fmu"),
            &description(version),
            platform(version),
            &library,
        ))
    }

    fn platform(version: u8) -> &'static str {
        match version {
            2 => "linux64",
            _ if cfg!(target_arch = "aarch64") => "aarch64-linux",
            _ => "x86_64-linux",
        }
    }

    fn pack(file: &Path, description: &str, platform: &str, library: &[u8]) -> PathBuf {
        let mut archive = ZipWriter::new(std::fs::File::create(file).expect("a file"));
        let library_name = format!("binaries/{platform}/mount.so");
        for (name, bytes) in [
            ("modelDescription.xml", description.as_bytes()),
            (&library_name, library),
        ] {
            archive.start_file(name, SimpleFileOptions::DEFAULT).expect("an entry");
            archive.write_all(bytes).expect("written");
        }
        archive.finish().expect("an archive");
        file.to_path_buf()
    }

    const MAP: &str = "[inputs]\n\
        displacement_m = { column = \"displacement_m\" }\n\
        speed_m_s = { rate_of = \"displacement_m\" }\n\
        [outputs]\n\
        force_N = { column = \"force_N\", noise = 2.0 }\n\
        [parameters]\n\
        stiffness_N_m = { tolerance = 0.1 }\n\
        viscous_N_s_m = { tolerance = 0.02 }\n";

    /// An FMU, a map and recordings in a folder.
    struct Bench {
        folder: TempDir,
        fmu: PathBuf,
        recordings: Vec<PathBuf>,
    }

    impl Bench {
        fn of(truth: &Truth, version: u8) -> Option<Self> {
            let folder = tempfile::tempdir().expect("a folder");
            let fmu = mount(folder.path(), version)?;
            let recordings = (0..3).map(|k| record(folder.path(), truth, k)).collect();
            Some(Self {
                folder,
                fmu,
                recordings,
            })
        }

        fn command(&self, map: &str, out: &str, further: &[&str]) -> Command {
            let map_file = self.folder.path().join("map.toml");
            std::fs::write(&map_file, map).expect("written");
            let out = self.folder.path().join(out);
            let mut arguments = vec![
                "diagnose",
                "--fmu",
                path(&self.fmu),
                "--map",
                path(&map_file),
                "--out",
                path(&out),
            ];
            arguments.extend(self.recordings.iter().map(|r| path(r)));
            arguments.extend(further);
            oleo(&arguments)
        }

        fn report(&self, map: &str, out: &str, further: &[&str]) -> Value {
            let ran = self.command(map, out, further).output().expect("it runs");
            assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
            self.read(out)
        }

        fn read(&self, out: &str) -> Value {
            let text = std::fs::read_to_string(self.folder.path().join(out).join("report.json")).expect("a report");
            serde_json::from_str(&text).expect("JSON")
        }

        fn said(&self, map: &str) -> String {
            let said = complaint(&self.command(map, "refused", &[]).output().expect("it runs"));
            assert!(!self.folder.path().join("refused").exists(), "something was written");
            said
        }
    }

    fn calibrated(report: &Value, key: &str) -> f64 {
        let all = report["calibration"].as_array().expect("a calibration");
        let found = all
            .iter()
            .find(|value| value["key"] == key)
            .expect("a calibrated value");
        found["value"].as_f64().expect("a number")
    }

    #[test]
    fn a_wrong_parameter_is_calibrated_in_both_versions_of_fmi() {
        let truth = Truth {
            stiffness: 1.06 * AS_MODELLED.stiffness,
            ..AS_MODELLED
        };
        for version in [2, 3] {
            let Some(bench) = Bench::of(&truth, version) else {
                return;
            };
            let report = bench.report(MAP, "found", &["--hold-out", "run2"]);
            assert_eq!(report["verdict"], "consistent", "{report}");
            let off = calibrated(&report, "stiffness_N_m (relative)");
            assert!((off - 0.06).abs() < 2e-3, "{off}");
            let models = report["kept_back"]["models"].as_array().expect("models");
            let held_out = |k: usize| models[k]["noise_ratio_kept_back"]["force_N"].as_f64().expect("a ratio");
            assert!(held_out(0) > 3.0 && held_out(1) < 1.1, "{models:?}");
            // The improved map is one to go on with, and nothing is left to calibrate.
            let improved = std::fs::read_to_string(bench.folder.path().join("found/map.toml")).expect("a map");
            let again = bench.report(&improved, "again", &[]);
            assert!(calibrated(&again, "stiffness_N_m (relative)").abs() < 1e-3, "{again}");
        }
    }

    #[test]
    fn friction_that_the_model_leaves_out_is_found_as_a_law_over_the_speed() {
        let truth = Truth {
            friction_n: 30.0,
            ..AS_MODELLED
        };
        let Some(bench) = Bench::of(&truth, 2) else { return };
        let report = bench.report(MAP, "found", &["--hold-out", "run2"]);
        let effect = &report["effects"][0];
        assert_eq!(
            (&effect["id"], &effect["place"]),
            (&"unlisted".into(), &"output:force_N".into()),
            "{effect}"
        );
        let law = &effect["law"];
        assert_eq!(law["over"], "rate of displacement_m", "{law}");
        let numbers = |key: &str| -> Vec<f64> {
            law[key]
                .as_array()
                .expect("numbers")
                .iter()
                .map(|v| v.as_f64().expect("a number"))
                .collect()
        };
        for (speed, force) in numbers("argument").into_iter().zip(numbers("value")) {
            if speed.abs() > 0.02 {
                assert!((force - 30.0 * speed.signum()).abs() < 5.0, "{force} N at {speed} m/s");
            }
        }
        // On any number of threads.
        let mut one = bench.command(MAP, "one", &["--hold-out", "run2"]);
        assert!(one.env("RAYON_NUM_THREADS", "1").status().expect("it runs").success());
        let mut alone = bench.read("one");
        let mut many = report.clone();
        for report in [&mut alone, &mut many] {
            report["runtime_s"] = Value::Null;
        }
        assert_eq!(alone, many);
    }

    #[test]
    fn faults_of_instruments_and_a_parameter_that_changes_are_found() {
        let late = Truth {
            delay_s: 0.012,
            ..AS_MODELLED
        };
        let softens = Truth {
            softening: 0.05,
            ..AS_MODELLED
        };
        for (truth, id, place, value) in [
            (late, "sensor_skew", "sensor:force_N", Some(0.012)),
            (softens, "unlisted", "parameter:stiffness_N_m", None),
        ] {
            let Some(bench) = Bench::of(&truth, 3) else { return };
            let map = MAP.replace("tolerance = 0.1", "tolerance = 0.02");
            let report = bench.report(&map, "found", &[]);
            let effect = &report["effects"][0];
            assert_eq!(
                (&effect["id"], &effect["place"]),
                (&id.into(), &place.into()),
                "{}",
                report["effects"]
            );
            if let Some(value) = value {
                let parameters = effect["parameters"].as_object().expect("parameters");
                let found = parameters
                    .values()
                    .next()
                    .and_then(|p| p["value"].as_f64())
                    .expect("a value");
                assert!((found - value).abs() < 0.05 * value.abs(), "{id}: {found}");
            }
        }
    }

    /// In a linear model a gain of the load cell is one of the displacement.
    #[test]
    fn two_faults_that_nothing_tells_apart_are_reported_as_such() {
        let truth = Truth {
            gain: 1.05,
            ..AS_MODELLED
        };
        let Some(bench) = Bench::of(&truth, 2) else { return };
        let map = MAP
            .replace("tolerance = 0.1", "tolerance = 0.01")
            .replace("tolerance = 0.02", "tolerance = 0.01");
        let report = bench.report(&map, "found", &[]);
        assert_eq!(report["effects"][0]["id"], "sensor_gain");
        let next = report["next_experiment"].as_str().expect("an experiment");
        assert!(
            next.contains("To separate") && next.contains("sensor:force_N") && next.contains("sensor:displacement_m"),
            "{next}"
        );
    }

    #[test]
    fn a_model_that_hangs_or_falls_is_one_line_that_says_when() {
        let Some(bench) = Bench::of(&AS_MODELLED, 2) else {
            return;
        };
        for (misbehave, further, expected) in [
            (
                1,
                "[run]\nlimit_s = 1.0\n",
                "did not finish within 1 s and was ended, at 1.000000 s of the simulation",
            ),
            (
                2,
                "",
                "was ended by signal 6 (SIGABRT), saying \"assertion failed: the mount is torn\", at 1.000000 s",
            ),
            (3, "", "ended its process with exit status 3, at 1.000000 s"),
            (
                4,
                "",
                "fmi2DoStep: the FMU calls it an error: the solver does not converge at %g s (at 1 s)",
            ),
            (5, "", "an output is NaN at 1.005 s"),
            (
                7,
                "[run]\nmemory_MiB = 256\n",
                "was ended by signal 11 (SIGSEGV), at 1.000000 s",
            ),
        ] {
            let map = format!("{MAP}misbehave = {{ value = {misbehave} }}\n{further}");
            let said = bench.said(&map);
            assert!(said.contains(expected), "{misbehave}: {said}");
            assert!(
                said.contains(path(&bench.fmu)) && said.contains("recording run0"),
                "{said}"
            );
        }
    }

    #[test]
    fn a_model_that_remembers_the_run_before_gets_a_process_for_each() {
        let Some(bench) = Bench::of(&AS_MODELLED, 2) else {
            return;
        };
        let map = format!("{MAP}misbehave = {{ value = 6 }}\n");
        // Every step of an instance adds one newton to it. In a process of its own it is at least the same every time.
        let found = |threads: &str, out: &str| {
            let mut command = bench.command(&map, out, &[]);
            assert!(
                command
                    .env("RAYON_NUM_THREADS", threads)
                    .status()
                    .expect("it runs")
                    .success()
            );
            let mut report = bench.read(out);
            report["runtime_s"] = Value::Null;
            report
        };
        assert_eq!(found("1", "one"), found("2", "two"));
    }

    #[test]
    fn what_does_not_go_together_is_one_line() {
        let Some(bench) = Bench::of(&AS_MODELLED, 2) else {
            return;
        };
        for (from, to, expected) in [
            (
                "force_N = { column",
                "forc_N = { column",
                "map.toml:5: [outputs] forc_N is not there: did you mean force_N?",
            ),
            ("speed_m_s =", "speed_mm_s =", "did you mean speed_m_s?"),
            (
                "column = \"force_N\"",
                "column = \"load_N\"",
                "column 'load_N' is missing",
            ),
            ("viscous_N_s_m =", "viscosity =", "[parameters] viscosity is not there"),
            (
                "{ tolerance = 0.1 }",
                "{ tolerance = 0.1, value = 0.0 }",
                "state tolerance_absolute instead",
            ),
            ("noise = 2.0", "noise = -2.0", "must be above 0"),
        ] {
            let said = bench.said(&MAP.replace(from, to));
            assert!(said.contains(expected), "{said}");
        }
        let other = bench.folder.path().join("other.fmu");
        let with = |fmu: &Path| {
            let broken = Bench {
                folder: tempfile::tempdir().expect("a folder"),
                fmu: fmu.to_path_buf(),
                recordings: bench.recordings.clone(),
            };
            broken.said(MAP)
        };
        std::fs::write(&other, "no zip").expect("written");
        assert!(with(&other).contains("other.fmu: is no FMU, which is a zip file"));
        pack(&other, &description(2), "win64", b"MZ");
        assert!(with(&other).contains("holds libraries for win64, and linux64 is needed"));
        pack(&other, &description(2), platform(2), b"no library");
        assert!(with(&other).contains("its library cannot be loaded"));
        pack(
            &other,
            &description(2).replace("{mount}", "{other}"),
            platform(2),
            &std::fs::read(bench.folder.path().join("mount.so")).expect("a library"),
        );
        assert!(with(&other).contains("fmi2Instantiate: the FMU calls it an error"));
        pack(
            &other,
            &description(2).replace("CoSimulation", "ModelExchange"),
            platform(2),
            b"",
        );
        assert!(with(&other).contains("export it as one for co-simulation"));
    }
}
