//! Plant and controller as two processes, on any machine: over slcan, with a cable that is a thread.

mod support;

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Output};
use std::time::{Duration, Instant};

use support::{is_as_documented, no_panic, run, start, summary};

/// A serial cable: what comes in at one end goes out at the other.
fn cable() -> [String; 2] {
    let ends = [(); 2].map(|()| TcpListener::bind("127.0.0.1:0").unwrap());
    let addresses = ends
        .each_ref()
        .map(|end| format!("slcan:tcp:{}", end.local_addr().unwrap()));
    std::thread::spawn(move || {
        let [a, b] = ends.map(|end| end.accept().unwrap().0);
        for (mut from, mut to) in [(a.try_clone().unwrap(), b.try_clone().unwrap()), (b, a)] {
            from.set_nodelay(true).unwrap();
            std::thread::spawn(move || pump(&mut from, &mut to));
        }
    });
    addresses
}

fn pump(from: &mut TcpStream, to: &mut TcpStream) {
    let mut bytes = [0; 4096];
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        if to.write_all(&bytes[..count]).is_err() {
            break;
        }
    }
    let _ = to.shutdown(std::net::Shutdown::Both);
}

/// Ends within a time that only a hang exceeds.
fn end(mut child: Child) -> Output {
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > Duration::from_secs(120) {
            child.kill().unwrap();
            panic!("hangs: {:?}", child.wait_with_output());
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    child.wait_with_output().unwrap()
}

fn words(out: &Path) -> Vec<u16> {
    let csv = std::fs::read_to_string(out.join("timeseries.csv")).unwrap();
    let column = csv
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "valve_word")
        .unwrap();
    csv.lines()
        .skip(1)
        .map(|line| line.split(',').nth(column).unwrap().parse().unwrap())
        .collect()
}

#[test]
fn two_processes_command_what_one_does() {
    same_in_two_processes(&["--duration-s", "3"]);
}

#[test]
fn two_processes_command_what_one_does_in_a_lane_change() {
    same_in_two_processes(&[
        "--scenario",
        "lane-change-on-belgian",
        "--entry-m",
        "30",
        "--duration-s",
        "9",
    ]);
}

fn same_in_two_processes(driven: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let [here, there] = cable();
    run(&[&["hil", "--out", &path("one")], driven].concat());
    let controller = start(&[
        "hil",
        "--node",
        "controller",
        "--bus",
        &there,
        "--out",
        &path("controller"),
    ]);
    let plant = ["hil", "--node", "plant", "--bus", &here, "--out", &path("plant")];
    let plant = start(&[&plant[..], driven].concat());
    for output in [end(plant), end(controller)] {
        no_panic(&output);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    is_as_documented(Path::new(&path("controller")), "hil-controller");
    let one = summary(Path::new(&path("one")));
    for node in ["plant", "controller"] {
        assert_eq!(
            summary(Path::new(&path(node)))["command_hash"],
            one["command_hash"],
            "{node}"
        );
    }
    let plant = summary(Path::new(&path("plant")));
    assert_eq!((&plant["frames_lost"], &plant["e2e_errors"]), (&0.into(), &0.into()));
    let read = |name: &str| std::fs::read(folder.path().join(name).join("timeseries.csv")).unwrap();
    assert!(read("plant") == read("one"), "the same motion, bit for bit");
}

#[test]
fn a_killed_controller_leaves_closed_valves() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("plant");
    let [here, there] = cable();
    let mut controller = start(&[
        "hil",
        "--node",
        "controller",
        "--bus",
        &there,
        "--strategy",
        "always-soft",
    ]);
    let plant = [
        "hil",
        "--node",
        "plant",
        "--strategy",
        "always-soft",
        "--duration-s",
        "240",
        "--bus",
        &here,
    ];
    let plant = start(&[&plant[..], &["--out", out.to_str().unwrap()]].concat());
    std::thread::sleep(Duration::from_millis(1500));
    controller.kill().unwrap();
    controller.wait().unwrap();
    let output = end(plant);
    no_panic(&output);
    let summary = summary(&out);
    if summary["controller_lost_at_tick"].is_null() {
        println!("SKIPPED: this machine was done before the controller was killed");
        return;
    }
    let lost = summary["controller_lost_at_tick"].as_u64().unwrap() as usize;
    let words = words(&out);
    assert_eq!(words.len(), 48_000, "it drives on to the end");
    assert!(
        words[lost + 4..].iter().all(|word| *word == 0),
        "closed from tick {lost} + 4 on"
    );
}

#[test]
fn a_killed_plant_leaves_a_safe_controller_that_ends() {
    let folder = tempfile::tempdir().unwrap();
    let (out, run) = (folder.path().join("controller"), folder.path().join("plant"));
    let [here, there] = cable();
    let controller = start(&[
        "hil",
        "--node",
        "controller",
        "--bus",
        &there,
        "--out",
        out.to_str().unwrap(),
    ]);
    let mut plant = start(&[
        "hil",
        "--node",
        "plant",
        "--duration-s",
        "600",
        "--bus",
        &here,
        "--out",
        run.to_str().unwrap(),
    ]);
    std::thread::sleep(Duration::from_millis(3000));
    plant.kill().unwrap();
    plant.wait().unwrap();
    let output = end(controller);
    no_panic(&output);
    assert!(
        !run.join("summary.json").exists(),
        "a killed run leaves no results that look whole"
    );
    let text = String::from_utf8_lossy(&output.stderr);
    if text.contains("closed the connection") {
        println!("SKIPPED: the plant was killed before the nodes had met");
        return;
    }
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("the plant fell silent after tick"), "{text}");
    let ticks = summary(&out)["ticks_to_safe"].as_u64();
    assert!(ticks.is_some_and(|ticks| ticks <= 5), "{ticks:?}");
}

/// A controller that was built for another vehicle is refused, because it would command something else than in one process.
#[test]
fn nodes_with_different_vehicles_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wider.toml");
    let text = include_str!("../plant-sim/presets/defender110.toml");
    std::fs::write(&file, text.replace("strut_spacing_m = 1.0", "strut_spacing_m = 1.2")).unwrap();
    let [here, there] = cable();
    let controller = start(&["hil", "--no-out", "--node", "controller", "--bus", &there]);
    let plant = [
        "hil",
        "--node",
        "plant",
        "--bus",
        &here,
        "--vehicle",
        file.to_str().unwrap(),
    ];
    let plant = start(&plant);
    let outputs = [end(plant), end(controller)];
    let texts = outputs.each_ref().map(|output| String::from_utf8_lossy(&output.stderr));
    assert!(texts.iter().any(|text| text.contains("another vehicle")), "{texts:?}");
    for output in &outputs {
        support::complaint(output);
    }
}

#[test]
fn nodes_that_want_different_runs_say_so() {
    let [here, there] = cable();
    let controller = start(&[
        "hil",
        "--node",
        "controller",
        "--bus",
        &there,
        "--strategy",
        "always-stiff",
    ]);
    let plant = start(&["hil", "--no-out", "--node", "plant", "--bus", &here]);
    let outputs = [end(plant), end(controller)];
    assert!(
        outputs
            .iter()
            .any(|output| String::from_utf8_lossy(&output.stderr).contains("another strategy"))
    );
    for output in &outputs {
        support::complaint(output);
    }
}
