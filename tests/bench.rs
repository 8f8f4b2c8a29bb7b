//! `oleo bench`: what it writes, and that what it computes does not depend on the run. No time is asserted.

mod support;

use support::{complaint, is_as_documented, run, summary};

/// Digests of what the points computed.
fn outcomes(summary: &serde_json::Value) -> Vec<String> {
    let curves = summary["curves"].as_array().expect("curves");
    let points = curves
        .iter()
        .flat_map(|curve| curve["points"].as_array().expect("points"));
    points
        .map(|point| point["outcome"].as_str().expect("a digest").to_owned())
        .collect()
}

#[test]
fn a_quick_bench_measures_every_curve_and_computes_the_same_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let bench = |name: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let path = out.to_str().expect("a path");
        let output = run(&[&["bench", "--quick", "--out", path], more].concat());
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        is_as_documented(&out, "bench");
        (
            text,
            summary(&out),
            std::fs::read_to_string(out.join("report.html")).expect("a page"),
        )
    };
    let (text, first, page) = bench("first", &["--repeats", "1"]);
    // Repeats of one run are compared by the command itself.
    let (_, second, _) = bench("second", &["--repeats", "2", "--curve", "vehicles"]);
    let (first_outcomes, second_outcomes) = (outcomes(&first), outcomes(&second));
    assert_eq!(first_outcomes[..second_outcomes.len()], second_outcomes);
    let curves = first["curves"].as_array().expect("curves");
    assert_eq!(curves.len(), 5);
    for curve in curves {
        let name = curve["name"].as_str().expect("a name");
        let points = curve["points"].as_array().expect("points");
        let sizes: Vec<u64> = points
            .iter()
            .map(|point| point["size"].as_u64().expect("a size"))
            .collect();
        assert!(sizes.len() == 5 && sizes.is_sorted(), "{name}: {sizes:?}");
        let sentence = curve["in_words"].as_str().expect("a sentence");
        assert!(
            text.contains(sentence) && page.contains(&format!("<h3>{name}</h3>")),
            "{name}: {sentence}"
        );
        assert!(
            points.iter().all(|point| point["operations"].as_u64() > Some(0)),
            "{name}"
        );
    }
    let ticks = |vehicles: usize| curves[0]["points"][vehicles]["operations"].clone();
    assert_eq!((ticks(0), ticks(4)), (400.into(), 40_000.into()));
    assert!(page.contains("only clocks are given, which are noisy"));
}

#[test]
fn what_cannot_be_measured_is_refused_in_one_line() {
    for (arguments, says) in [
        (
            &["bench", "--repeats", "0"][..],
            "--repeats 0: give a number from 1 to 100",
        ),
        (&["bench", "--curve", "wheels"], "vehicles"),
        (
            &["bench", "--point", "vehicles:0", "--scratch", "."],
            "such as vehicles:100",
        ),
    ] {
        let complaint = complaint(&run(arguments));
        assert!(complaint.contains(says), "{complaint}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("notes.txt"), "mine").expect("a file");
    let path = folder.path().to_str().expect("a path");
    let complaint = complaint(&run(&["bench", "--quick", "--curve", "log-frames", "--out", path]));
    assert!(complaint.contains("--force"), "{complaint}");
}
