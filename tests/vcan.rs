//! The loop on a real CAN interface, in one process and in two. Run it where there is one:
//! `tests/harness/with-vcan.sh cargo test --test vcan -- --nocapture` (see docs/testing.md); elsewhere it says that it was skipped.

mod support;

use std::path::Path;
use std::process::Child;
use std::time::{Duration, Instant};

use oleo_hil::Frame;
use oleo_hil::bus::{Bus, SocketCan};
use oleo_hil::frame::standard;
use support::{no_panic, run, start, summary};

/// Tests of one interface must not hear each other.
static BUS: std::sync::Mutex<()> = std::sync::Mutex::new(());

fn on_vcan(test: impl FnOnce(&str)) {
    let Ok(interface) = std::env::var("OLEO_VCAN") else {
        println!("SKIPPED: no CAN interface (OLEO_VCAN is not set); run under tests/harness/with-vcan.sh");
        return;
    };
    let _alone = BUS.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    test(&format!("socketcan:{interface}"));
}

/// What is driven on every bus: the default ride, and a lane change in the middle of Belgian block.
const DRIVEN: [&[&str]; 2] = [
    &["--duration-s", "5"],
    &[
        "--scenario",
        "lane-change-on-belgian",
        "--entry-m",
        "30",
        "--duration-s",
        "9",
    ],
];

fn hash_in_process(folder: &Path, driven: &[&str]) -> serde_json::Value {
    let out = folder.join("inproc");
    run(&[&["hil", "--out", out.to_str().unwrap()], driven].concat());
    summary(&out)["command_hash"].clone()
}

/// Ends within a time that only a hang exceeds.
fn end(mut child: Child) -> std::process::Output {
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

/// Returns when the loop has run for some ticks.
fn wait_for_commands(bus: &mut SocketCan) {
    let started = Instant::now();
    let mut commands = 0;
    while commands < 200 {
        assert!(started.elapsed() < Duration::from_secs(60), "the loop does not start");
        if let Some(frame) = bus.receive(Duration::from_millis(100)).unwrap() {
            commands += u32::from(frame.standard_id() == Some(oleo_controller::can::COMMAND.id));
        }
    }
}

fn listen(bus: &str) -> SocketCan {
    SocketCan::open(bus.trim_start_matches("socketcan:")).unwrap()
}

#[test]
fn one_process_commands_what_the_bus_in_memory_commands() {
    on_vcan(|bus| {
        let folder = tempfile::tempdir().unwrap();
        for (driven, threads) in DRIVEN.into_iter().flat_map(|driven| [(driven, "1"), (driven, "2")]) {
            let out = folder.path().join(threads);
            let out = out.to_str().unwrap();
            let hil = ["hil", "--bus", bus, "--threads", threads, "--out", out];
            let output = run(&[&hil[..], driven].concat());
            no_panic(&output);
            let summary = summary(Path::new(out));
            assert_eq!(summary["command_hash"], hash_in_process(folder.path(), driven));
            assert_eq!(
                (&summary["frames_lost"], &summary["e2e_errors"]),
                (&0.into(), &0.into())
            );
            println!(
                "vcan, {threads} thread(s): {:.0} ticks/s",
                1000.0 / summary["wall_s"].as_f64().unwrap()
            );
        }
    });
}

/// Two senders under one identifier, and readings that are late: the checks of these scenarios hold on a real bus too.
#[test]
fn doubled_and_late_frames_close_the_valves() {
    on_vcan(|bus| {
        let folder = tempfile::tempdir().unwrap();
        for scenario in ["doubled-frames", "held-up-bus"] {
            let out = folder.path().join(scenario);
            let output = run(&[
                "hil",
                "--scenario",
                scenario,
                "--bus",
                bus,
                "--out",
                out.to_str().unwrap(),
            ]);
            no_panic(&output);
            let text = String::from_utf8_lossy(&output.stdout);
            assert_eq!(output.status.code(), Some(0), "{scenario}\n{text}");
        }
    });
}

#[test]
fn two_processes_in_either_order_with_a_stranger_on_the_bus() {
    on_vcan(|bus| {
        let folder = tempfile::tempdir().unwrap();
        for (driven, plant_first) in DRIVEN.into_iter().zip([true, false]) {
            let expected = hash_in_process(folder.path(), driven);
            let out = folder.path().join(format!("plant-{plant_first}"));
            let plant = ["hil", "--node", "plant", "--bus", bus, "--out", out.to_str().unwrap()];
            let plant = [&plant[..], driven].concat();
            let other = folder.path().join(format!("controller-{plant_first}"));
            let controller = [
                "hil",
                "--node",
                "controller",
                "--bus",
                bus,
                "--out",
                other.to_str().unwrap(),
            ];
            let first = start(if plant_first { &plant[..] } else { &controller[..] });
            std::thread::sleep(Duration::from_millis(200));
            let second = start(if plant_first { &controller[..] } else { &plant[..] });
            // Somebody else's diagnosis session, as fast as is polite.
            let mut stranger = listen(bus);
            for i in 0..200u32 {
                stranger
                    .send(&Frame::whole(
                        standard(0x7DF),
                        i.to_le_bytes().repeat(2).try_into().unwrap(),
                    ))
                    .unwrap();
                std::thread::sleep(Duration::from_millis(1));
            }
            for output in [end(first), end(second)] {
                no_panic(&output);
                assert_eq!(
                    output.status.code(),
                    Some(0),
                    "{}",
                    String::from_utf8_lossy(&output.stderr)
                );
            }
            assert_eq!(summary(&out)["command_hash"], expected);
            assert_eq!(summary(&other)["command_hash"], expected);
            assert_eq!(summary(&out)["e2e_errors"], 0);
        }
    });
}

#[test]
fn a_killed_plant_leaves_a_controller_that_is_safe_and_ends() {
    on_vcan(|bus| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("controller");
        let mut bystander = listen(bus);
        let controller = start(&[
            "hil",
            "--node",
            "controller",
            "--bus",
            bus,
            "--out",
            out.to_str().unwrap(),
        ]);
        let run = folder.path().join("plant");
        let mut plant = start(&[
            "hil",
            "--node",
            "plant",
            "--duration-s",
            "60",
            "--bus",
            bus,
            "--out",
            run.to_str().unwrap(),
        ]);
        wait_for_commands(&mut bystander);
        plant.kill().unwrap();
        plant.wait().unwrap();
        let output = end(controller);
        no_panic(&output);
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{text}");
        assert!(text.contains("the plant fell silent after tick"), "{text}");
        let ticks = summary(&out)["ticks_to_safe"].as_u64();
        assert!(ticks.is_some_and(|ticks| ticks <= 5), "{ticks:?}");
        assert!(!run.exists(), "a killed run leaves no results that look whole");
        println!("killed plant: controller safe after {} ticks", ticks.unwrap());
    });
}

#[test]
fn a_killed_controller_leaves_a_plant_that_closes_its_valves_and_drives_on() {
    on_vcan(|bus| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("plant");
        let mut bystander = listen(bus);
        let plant = start(&[
            "hil",
            "--node",
            "plant",
            "--duration-s",
            "60",
            "--bus",
            bus,
            "--out",
            out.to_str().unwrap(),
        ]);
        let mut controller = start(&["hil", "--no-out", "--node", "controller", "--bus", bus]);
        wait_for_commands(&mut bystander);
        controller.kill().unwrap();
        controller.wait().unwrap();
        let output = end(plant);
        no_panic(&output);
        let summary = summary(&out);
        assert_eq!(summary["ticks"], 12_000, "it drives on to the end");
        let lost = summary["controller_lost_at_tick"].as_u64().expect("the loss is told");
        let csv = std::fs::read_to_string(out.join("timeseries.csv")).unwrap();
        let column = csv
            .lines()
            .next()
            .unwrap()
            .split(',')
            .position(|name| name == "valve_word")
            .unwrap();
        let words: Vec<&str> = csv
            .lines()
            .skip(1)
            .map(|line| line.split(',').nth(column).unwrap())
            .collect();
        assert!(
            words[lost as usize + 4..].iter().all(|word| *word == "0"),
            "valves closed from tick {lost} + 4 on"
        );
        println!("killed controller: given up in tick {lost}, valves closed within 4 ticks");
    });
}

#[test]
fn a_node_without_a_partner_and_a_missing_interface_say_what_to_do() {
    on_vcan(|_| {
        let output = run(&["hil", "--no-out", "--bus", "socketcan:vcan99"]);
        let text = support::complaint(&output);
        assert!(text.contains("ip link add dev vcan99 type vcan"), "{text}");
    });
}
