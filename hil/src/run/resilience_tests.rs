//! Runs on a bus on which somebody else speaks, a node is started again, or the interface goes away.

use std::time::{Duration, Instant};

use super::tests::{hash, run, short};
use super::*;
use crate::Frame;
use crate::bus::{BusCounters, BusError, InProcess};
use crate::frame::standard;
use crate::sync::{Session, Sync};

/// A bus on which a third party speaks: before each frame that the node receives, frames of this party arrive.
struct Crowded<B, F> {
    inner: B,
    /// What the third party says next, if anything.
    third: F,
}

impl<B: Bus, F: FnMut() -> Option<Frame> + Send> Bus for Crowded<B, F> {
    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.inner.send(frame)
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        match (self.third)() {
            None => self.inner.receive(wait),
            forged => Ok(forged),
        }
    }

    fn counters(&self) -> BusCounters {
        self.inner.counters()
    }
}

const SESSION: Session = Session {
    plant: 0x1111,
    controller: 0x2222,
};

fn ask() -> Terms {
    Terms {
        strategy: 3,
        real_time: false,
        vehicle: 9,
    }
}

/// A plant and a controller on a bus with a third party at each end.
type Pair<F> = (PlantNode<Crowded<InProcess, F>>, ControllerNode<Crowded<InProcess, F>>);

/// A plant and a controller of a scenario, in a session, with a third party at each end.
fn crowded<F>(scenario: &Scenario, at_plant: F, at_controller: F) -> Pair<F>
where
    F: FnMut() -> Option<Frame> + Send,
{
    let (a, b) = in_process_pair();
    let [a, b] = [(a, at_plant), (b, at_controller)].map(|(inner, third)| Crowded { inner, third });
    let mut plant = PlantNode::new(a, scenario, vehicle(scenario).unwrap(), false);
    let configuration = configuration(scenario).unwrap();
    let mut controller = ControllerNode::new(b, configuration, &scenario.faults, scenario.ticks as usize);
    plant.join(SESSION, ask());
    controller.join(SESSION);
    (plant, controller)
}

/// Runs both in lockstep in two threads.
fn drive<F>(scenario: &Scenario, (mut plant, mut controller): Pair<F>) -> Outcome
where
    F: FnMut() -> Option<Frame> + Send,
{
    let started = Instant::now();
    let end = std::thread::scope(|scope| {
        scope.spawn(|| controller_loop::in_lockstep(&mut controller, scenario));
        plant_loop::in_lockstep(&mut plant, scenario, &mut || Ok(()), &mut |_| true)
    });
    end.unwrap().outcome(plant, Vec::new(), started)
}

/// A third party that says each of some frames, one before each frame that the node receives, again and again.
fn repeating(frames: Vec<Frame>) -> impl FnMut() -> Option<Frame> + Send {
    let mut turn = 0;
    move || {
        turn += 1;
        (turn % 2 == 0).then(|| frames[turn / 2 % frames.len()])
    }
}

#[test]
fn forged_frames_of_the_exchange_change_nothing() {
    let scenario = short("belgian", 300);
    let elsewhere = Session {
        plant: 3,
        controller: 4,
    };
    let forged: Vec<Frame> = [Role::Plant, Role::Controller]
        .into_iter()
        .flat_map(|role| {
            [
                Sync::TickDone { tick: 5, sent: 0 },
                Sync::TickDone { tick: 299, sent: 7 },
                Sync::End { sent: 0 },
                Sync::Losses { lost: 9, e2e_errors: 9 },
                Sync::Tally { sent: 1 },
                Sync::Hello {
                    terms: ask(),
                    heard: false,
                    number: 77,
                },
            ]
            .map(|sync| sync.encode(role, elsewhere))
        })
        // Frames of this session that were recorded before are no news either.
        .chain([
            Sync::TickDone { tick: 0, sent: 6 }.encode(Role::Plant, SESSION),
            Sync::TickDone { tick: 0, sent: 1 }.encode(Role::Controller, SESSION),
            Sync::Tally { sent: 1 }.encode(Role::Controller, SESSION),
        ])
        .collect();
    let outcome = drive(
        &scenario,
        crowded(&scenario, repeating(forged.clone()), repeating(forged)),
    );
    let alone = run(&scenario, 1);
    assert_eq!(outcome.plant.recording.samples.len(), 300);
    assert_eq!(hash(&outcome), hash(&alone));
    assert!(outcome.plant.foreign_sync_frames > 100, "they are counted");
    assert_eq!(
        (outcome.plant.bus_frames_lost, outcome.plant.controller_rejoined),
        (0, 0)
    );
}

/// A partner that is gone is found although another node never stops speaking.
#[test]
fn chatter_of_others_does_not_keep_a_partner_alive() {
    let scenario = Scenario {
        partner_timeout_s: 0.1,
        ..short("belgian", 200)
    };
    let chatter = || {
        || {
            std::thread::sleep(Duration::from_millis(1));
            Some(Frame::whole(standard(0x7DF), [0; 8]))
        }
    };
    let (mut plant, mut controller) = crowded(&scenario, chatter(), chatter());
    let started = Instant::now();
    let end = plant_loop::in_lockstep(&mut plant, &scenario, &mut || Ok(()), &mut |_| true).unwrap();
    assert_eq!(end.controller_lost_at, Some(0));
    let lost = controller_loop::in_lockstep(&mut controller, &scenario).unwrap();
    assert!(lost.is_some_and(|lost| !lost.restarted));
    assert!(started.elapsed() < Duration::from_secs(20), "hangs");
}

/// A controller's process is killed and started again while the plant waits: it is let in, and the drive goes on.
#[test]
fn a_controller_that_is_started_again_is_let_in() {
    let scenario = Scenario {
        partner_timeout_s: 5.0,
        strategy: oleo_controller::Strategy::AlwaysSoft,
        ..short("belgian", 400)
    };
    let terms = ask();
    let (mut plant_end, mut controller_end) = in_process_pair();
    let outcome = std::thread::scope(|scope| {
        scope.spawn(|| {
            let patience = Duration::from_secs(20);
            for ticks in [150, u32::MAX] {
                let session =
                    handshake(&mut controller_end, "x", Role::Controller, terms, patience, &mut || {}).unwrap();
                let configuration = configuration(&scenario).unwrap();
                let mut controller = ControllerNode::new(&mut controller_end, configuration, &[], 400);
                controller.join(session);
                let mut done = 0;
                while done < ticks {
                    match controller.listen(Duration::from_secs(5)).unwrap() {
                        Heard::Tick => {
                            controller.decide().unwrap();
                            controller.send_done().unwrap();
                            done += 1;
                        }
                        Heard::End => {
                            controller.send_tally().unwrap();
                            break;
                        }
                        other => panic!("{other:?}"),
                    }
                }
            }
        });
        let session = handshake(
            &mut plant_end,
            "x",
            Role::Plant,
            terms,
            Duration::from_secs(20),
            &mut || {},
        )
        .unwrap();
        let mut plant = PlantNode::new(&mut plant_end, &scenario, vehicle(&scenario).unwrap(), false);
        plant.join(session, terms);
        let started = Instant::now();
        let end = plant_loop::in_lockstep(&mut plant, &scenario, &mut || Ok(()), &mut |_| true).unwrap();
        end.outcome(plant, Vec::new(), started)
    });
    assert_eq!(
        (outcome.plant.controller_rejoined, outcome.controller_lost_at),
        (1, None)
    );
    assert_eq!(outcome.plant.bus_frames_lost, 0);
    let words: Vec<u16> = outcome.plant.recording.words().collect();
    assert_eq!(words.len(), 400);
    assert!(words[100..150].iter().all(|word| *word != 0), "it drives softly before");
    assert_eq!(words[155], 0, "a new controller begins with closed valves");
    assert!(
        words[300..].iter().any(|word| *word != 0),
        "and opens them when it trusts the sensors"
    );
}

/// The plant is started again: its old controller ends, and does not answer the other run.
#[test]
fn a_plant_that_is_started_again_ends_its_controller() {
    let scenario = short("belgian", 100);
    let (near, mut far) = in_process_pair();
    let mut controller = ControllerNode::new(near, configuration(&scenario).unwrap(), &[], 100);
    controller.join(SESSION);
    let hello = Sync::Hello {
        terms: ask(),
        heard: false,
        number: 9,
    };
    for _ in 0..3 {
        far.send(&hello.encode(Role::Plant, Session::of(Role::Plant, 9)))
            .unwrap();
    }
    let lost = controller_loop::in_lockstep(&mut controller, &scenario)
        .unwrap()
        .unwrap();
    assert!(lost.restarted && controller.words().iter().all(|word| *word == 0));
}

/// A bus that fails after some frames.
struct Failing {
    inner: InProcess,
    frames: u32,
}

impl Bus for Failing {
    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.frames = self.frames.saturating_sub(1);
        if self.frames == 0 {
            return Err(BusError::Io {
                bus: "socketcan:vcan0".into(),
                action: "sending",
                source: std::io::Error::from_raw_os_error(100),
            });
        }
        self.inner.send(frame)
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        self.inner.receive(wait)
    }

    fn counters(&self) -> BusCounters {
        self.inner.counters()
    }
}

#[test]
fn an_interface_that_goes_away_leaves_what_was_driven() {
    let scenario = short("belgian", 300);
    let (near, far) = in_process_pair();
    let near = Failing {
        inner: near,
        frames: 700,
    };
    let mut plant = PlantNode::new(near, &scenario, vehicle(&scenario).unwrap(), false);
    let mut controller = ControllerNode::new(far, configuration(&scenario).unwrap(), &[], 300);
    let mut turn = || {
        if controller.listen(Duration::ZERO)? == Heard::Tick {
            controller.decide()?;
            controller.send_done()?;
        }
        Ok(())
    };
    let started = Instant::now();
    let end = plant_loop::in_lockstep(&mut plant, &scenario, &mut turn, &mut |_| true).unwrap();
    let outcome = end.outcome(plant, Vec::new(), started);
    assert_eq!(outcome.plant.recording.samples.len(), 99, "seven frames a tick");
    let metrics = crate::metrics::Metrics::of(&scenario, &outcome);
    let summary = crate::output::Summary::of(&scenario, &outcome, &metrics, None);
    assert!(!summary.passed() && summary.bus_failure.unwrap().contains("sending failed"));
}

/// More than 65,536 frames, after which a counter of 16 bits would begin anew, and a controller that is gone then.
#[test]
fn lost_frames_are_counted_beyond_sixteen_bits() {
    let scenario = Scenario {
        partner_timeout_s: 0.05,
        ..short("belgian", 10_000)
    };
    let (a, b) = in_process_pair();
    let mut plant = PlantNode::new(a, &scenario, vehicle(&scenario).unwrap(), false);
    let mut controller = ControllerNode::new(b, configuration(&scenario).unwrap(), &[], 10_000);
    let mut turns = 0;
    let mut turn = || {
        turns += 1;
        if turns <= 9_900 && controller.listen(Duration::ZERO)? == Heard::Tick {
            controller.decide()?;
            controller.send_done()?;
        }
        Ok(())
    };
    let started = Instant::now();
    let end = plant_loop::in_lockstep(&mut plant, &scenario, &mut turn, &mut |_| true).unwrap();
    let outcome = end.outcome(plant, Vec::new(), started);
    assert!(outcome.plant.frames_sent > 65_536);
    assert_eq!(
        (outcome.controller_lost_at, outcome.plant.bus_frames_lost),
        (Some(9_900), 0)
    );
}

#[test]
fn a_controller_in_reset_is_silent_and_then_starts_up() {
    let scenario = short("restarted-controller", 1600);
    let outcome = run(&scenario, 1);
    let words: Vec<u16> = outcome.plant.recording.words().collect();
    assert!(words[590..600].iter().all(|word| *word != 0), "soft before");
    assert!(
        words[604..640].iter().all(|word| *word == 0),
        "closed while it is in reset"
    );
    let metrics = crate::metrics::Metrics::of(&scenario, &outcome);
    let summary = crate::output::Summary::of(&scenario, &outcome, &metrics, None);
    assert!(summary.passed(), "{:?}", summary.checks);
    assert_eq!(hash(&outcome), hash(&run(&scenario, 2)));
}
