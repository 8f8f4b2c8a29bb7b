//! `oleo fmu`: what is written and what is refused. FMPy opens the files in `fmu/tests`.

mod support;

use std::path::Path;

use support::{complaint, run};

fn path(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

/// A program without it says how to come by one.
#[cfg(not(feature = "fmu"))]
#[test]
fn a_program_without_fmus_says_how_to_build_one_with_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("strut.fmu");
    for kind in ["strut", "controller", "vehicle"] {
        let said = complaint(&run(&["fmu", kind, "--out", path(&out)]));
        assert!(
            said.contains("`cargo build --release --features fmu -p oleo -p oleo-fmu`"),
            "{said}"
        );
        assert!(!out.exists());
    }
}

#[cfg(feature = "fmu")]
mod with_feature {
    use super::*;

    /// The head of a shared library for Linux, which is all that the command looks at.
    const LIBRARY: [u8; 20] = [0x7F, b'E', b'L', b'F', 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 62, 0];

    #[test]
    fn each_kind_is_written_in_both_versions_with_the_same_bytes_each_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let library = folder.path().join("library.so");
        std::fs::write(&library, LIBRARY).expect("written");
        for (kind, counts) in [
            ("strut", "5 inputs, 14 outputs"),
            ("controller", "20 inputs, 21 outputs, 13 parameters"),
            ("vehicle", "19 inputs, 41 outputs"),
        ] {
            let mut files = Vec::new();
            for (version, name) in [("2", "a.fmu"), ("2", "b.fmu"), ("3", "c.fmu")] {
                let out = folder.path().join(name);
                let arguments = [
                    "fmu",
                    kind,
                    "--fmi",
                    version,
                    "--library",
                    path(&library),
                    "--out",
                    path(&out),
                ];
                let ran = run(&arguments);
                let said = String::from_utf8_lossy(&ran.stdout).into_owned();
                assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
                assert!(
                    said.contains(counts) && said.starts_with(&format!("FMI {version}.0 ")),
                    "{said}"
                );
                files.push(std::fs::read(&out).expect("an FMU"));
            }
            assert!(files[0] == files[1] && files[0] != files[2], "{kind}");
        }
    }

    #[test]
    fn what_cannot_be_written_is_refused_in_one_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let (library, text) = (folder.path().join("library.so"), folder.path().join("text.toml"));
        std::fs::write(&library, LIBRARY).expect("written");
        std::fs::write(&text, "bore = 1\n").expect("written");
        let out = folder.path().join("out.fmu");
        for (arguments, expected) in [
            (
                vec!["strut", "--library", path(&text)],
                "is no shared library of a platform",
            ),
            (vec!["strut", "--library", "absent.so"], "absent.so: cannot be read"),
            (
                vec!["strut", "--library", path(&library), "--strut", path(&text)],
                "text.toml:1",
            ),
            (
                vec!["vehicle", "--library", path(&library), "--road", "a.crg"],
                "carries built-in roads only",
            ),
            (
                vec!["vehicle", "--library", path(&library), "--speed-km-h", "nan"],
                "initial_speed_m_s",
            ),
            (vec!["controller", "--library", path(&library), "--fmi", "1"], "--fmi"),
        ] {
            let all = [vec!["fmu"], arguments, vec!["--out", path(&out)]].concat();
            let said = complaint(&run(&all));
            assert!(said.contains(expected), "{said}");
            assert!(!out.exists());
        }
    }
}
