//! The loop on a real CAN interface, in one process and in two. Run it where there is one:
//! `tests/harness/with-vcan.sh cargo test --test vcan -- --nocapture` (see docs/testing.md); elsewhere it says that it was skipped.

mod support;

use std::path::Path;
use std::process::Child;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use oleo_hil::Frame;
use oleo_hil::bus::{Bus, SocketCan};
use oleo_hil::frame::standard;
use oleo_hil::sync::{Role, Session, Sync};
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

/// Sends frames every 5 ms until it is dropped.
struct Chatter {
    stop: Arc<AtomicBool>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Chatter {
    fn start(bus: &str, frames: Vec<Frame>) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let (mut bus, stopped) = (listen(bus), Arc::clone(&stop));
        let thread = std::thread::spawn(move || {
            while !stopped.load(Ordering::Relaxed) {
                for frame in &frames {
                    bus.send(frame).unwrap();
                }
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        Self {
            stop,
            thread: Some(thread),
        }
    }
}

impl Drop for Chatter {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        let _ = self.thread.take().unwrap().join();
    }
}

/// Frames of the exchange that keeps two nodes in step, as somebody would forge them who does not know the session.
fn forged_sync() -> Vec<Frame> {
    let session = Session {
        plant: 1,
        controller: 2,
    };
    [Role::Plant, Role::Controller]
        .into_iter()
        .flat_map(|role| {
            [
                Sync::TickDone { tick: 9, sent: 9 },
                Sync::End { sent: 0 },
                Sync::Tally { sent: 0 },
            ]
            .map(|sync| sync.encode(role, session))
        })
        .collect()
}

#[test]
fn forged_frames_of_the_exchange_neither_end_a_run_nor_change_it() {
    on_vcan(|bus| {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        let _attacker = Chatter::start(bus, forged_sync());
        let (plant_out, controller_out) = (path("plant"), path("controller"));
        let common = ["--duration-s", "5", "--bus", bus, "--out"];
        let node = |role: &str, out: &str| start(&[&["hil", "--node", role], &common[..], &[out]].concat());
        let nodes = [node("controller", &controller_out), node("plant", &plant_out)];
        for output in nodes.map(end) {
            no_panic(&output);
            assert_eq!(output.status.code(), Some(0), "{output:?}");
        }
        let summary = summary(Path::new(&plant_out));
        assert_eq!(summary["command_hash"], hash_in_process(folder.path(), DRIVEN[0]));
        assert!(summary["foreign_sync_frames"].as_u64().unwrap() > 0);
    });
}

#[test]
fn a_killed_controller_is_missed_although_another_node_chatters() {
    on_vcan(|bus| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("plant");
        let mut bystander = listen(bus);
        let _chatter = Chatter::start(bus, vec![Frame::whole(standard(0x7DF), [0; 8])]);
        let out_name = out.to_str().unwrap();
        let plant = [
            "hil",
            "--node",
            "plant",
            "--duration-s",
            "60",
            "--bus",
            bus,
            "--out",
            out_name,
        ];
        let plant = start(&plant);
        let mut controller = start(&["hil", "--node", "controller", "--bus", bus]);
        wait_for_commands(&mut bystander);
        controller.kill().unwrap();
        controller.wait().unwrap();
        no_panic(&end(plant));
        let summary = summary(&out);
        assert!(
            summary["controller_lost_at_tick"].as_u64().is_some(),
            "the loss is told"
        );
        assert_eq!(summary["ticks"], 12_000);
    });
}

#[test]
fn a_controller_that_is_started_again_is_let_in() {
    on_vcan(|bus| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("plant");
        let mut bystander = listen(bus);
        let out_name = out.to_str().unwrap();
        let plant = [
            "hil",
            "--node",
            "plant",
            "--duration-s",
            "60",
            "--bus",
            bus,
            "--out",
            out_name,
        ];
        let plant = start(&plant);
        let controller = || start(&["hil", "--node", "controller", "--bus", bus, "--duration-s", "60"]);
        let mut first = controller();
        wait_for_commands(&mut bystander);
        first.kill().unwrap();
        first.wait().unwrap();
        let second = controller();
        // The counter of the new controller's messages begins anew, which the output stage sees: so a check of the scenario fails.
        no_panic(&end(plant));
        let output = end(second);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let summary = summary(&out);
        let told = ["ticks", "controller_rejoined", "controller_lost_at_tick"].map(|key| &summary[key]);
        assert_eq!(told, [&12_000.into(), &1.into(), &serde_json::Value::Null]);
    });
}

#[test]
fn an_interface_that_goes_down_leaves_what_was_driven() {
    on_vcan(|bus| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("run");
        let mut bystander = listen(bus);
        let run = start(&[
            "hil",
            "--duration-s",
            "600",
            "--bus",
            bus,
            "--out",
            out.to_str().unwrap(),
        ]);
        wait_for_commands(&mut bystander);
        let interface = bus.trim_start_matches("socketcan:");
        let link = |state| {
            let ip = std::process::Command::new("ip")
                .args(["link", "set", interface, state])
                .status();
            assert!(ip.unwrap().success());
        };
        link("down");
        let output = end(run);
        link("up");
        no_panic(&output);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains("the run ended after"), "{said}");
        let summary = summary(&out);
        assert!((100..120_000).contains(&summary["ticks"].as_u64().unwrap()));
        assert!(summary["bus_failure"].as_str().is_some());
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
