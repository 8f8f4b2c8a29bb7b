//! `oleo hil`: reads the options and the scenario, runs them with `oleo_hil`, and writes the results.

mod record;
mod xcp;

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use oleo_controller::{DamperPolicy, FaultCode, Mode, Strategy};
use oleo_hil::bus::BusAddress;
use oleo_hil::companion::Companion;
use oleo_hil::imu;
use oleo_hil::metrics::Metrics;
use oleo_hil::output::{self, Summary};
use oleo_hil::record::command_hash;
use oleo_hil::run::{self, ControllerOutcome, Outcome, Underway};
use oleo_hil::scenario::file::DEFENDER;
use oleo_hil::scenario::{self, Clock, FaultKind, Overrides, Scenario};
use oleo_hil::telemetry::{Live, McapFile, Rows};
use oleo_hil::{page, sync::Role};
use oleo_interface::Corner;
use oleo_plant_sim::course::ManoeuvreKind;
use oleo_plant_sim::road;
use oleo_report::interrupt::{self, Graceful};
use oleo_report::{Column, OutputDirectory, Progress, Table, significant};
use strum::VariantNames;

use self::record::{Recorded, record, recorded};
use self::xcp::XcpArgs;
use super::course_arguments::{CourseArgs, option_failure};
use super::mcap::{McapArgs, program};
use super::show::{DBC, scenarios};
use crate::failure::Failure;
use crate::results::{ResultsArgs, command_line, say};
use oleo_hil::parameter_files::Parameters;

/// Drive the vehicle with controller and plant communicating only through CAN frames.
///
/// Without arguments the vehicle drives for 20 s over Belgian block at 60 km/h with the default strategy. Both nodes run in
/// this process, as fast as the machine allows.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  oleo hil --out belgian                                    run the default scenario and write report.html
  oleo hil --scenario bus-silence                           run a built-in fault scenario (--list shows all)
  oleo hil --road ../shared/roads/belgian_block.crg         drive over a measured road
  oleo hil --scenario lane-change-on-belgian --out lane     change lanes in the middle of a rough road
  oleo hil --manoeuvre lane-change-2 --driver hard --load laden --road flat
  oleo hil --record rear-left --out run                     record a strut, for oleo diagnose run/rear-left
  oleo hil --strut-at rear-left=weak.toml --out weak        one strut that differs, of which the controller is not told
  oleo hil --imu=0.3,0,-0.2 --out run                       an inertial unit on the body sends on the same bus
  oleo hil --bus socketcan:vcan0                            send the frames over SocketCAN
  oleo hil --clock realtime --duration-s 5                  run in real time
  oleo hil --bus socketcan:vcan0 --clock realtime --xcp     let a calibration tool read the controller
  oleo hil --mcap drive.mcap                                write the run also for Foxglove and PlotJuggler
  oleo hil --live --duration-s 60                           follow the run in Foxglove while it drives
  oleo hil --firmware oleo-firmware                         run the controller as an image on an emulated board
  oleo hil --node controller --bus socketcan:vcan0          run the two nodes as two processes,
  oleo hil --node plant --bus socketcan:vcan0 --out run     which may be started in either order

Exit status: 0 if all checks are met; 1 if a check failed, the bus failed during the run or the controller lost the plant; 2 if an input
was bad. A run in real time also fails if a node overran its deadline in more than 1 % of the ticks, or if the controller did not leave
start-up within a second.")]
pub struct Args {
    /// Name of a built-in scenario, or path of a scenario file
    #[arg(long, value_name = "FILE|NAME", default_value = "belgian")]
    scenario: String,
    /// List the built-in scenarios and exit
    #[arg(long)]
    list: bool,
    /// Bus that carries the frames: inproc (in memory), socketcan:IFACE, slcan:DEVICE or slcan:tcp:HOST:PORT [default: the
    /// scenario's, which is inproc in all built-in scenarios]
    #[arg(long, value_name = "BUS")]
    bus: Option<String>,
    /// Clock: in lockstep both nodes wait for each other in every tick and run as fast as the machine allows; in real time each
    /// tick takes 5 ms of the wall clock [default: the scenario's]
    #[arg(long, value_parser = by_name::<Clock>())]
    clock: Option<Clock>,
    /// Road: belgian, apg-left, apg-right, apg-both, iso-a .. iso-f, flat, or a .crg or .csv file [default: the scenario's]
    #[arg(long, value_name = "FILE|NAME")]
    road: Option<String>,
    /// Manoeuvre that is driven with the handling model and its driver [default: the scenario's; a scenario without a manoeuvre
    /// drives straight ahead with the ride model]. A manoeuvre other than the scenario's uses none of the scenario's settings of its
    /// own manoeuvre
    #[arg(long, value_name = "NAME", value_parser = by_name::<ManoeuvreKind>())]
    manoeuvre: Option<ManoeuvreKind>,
    #[command(flatten)]
    course: CourseArgs,
    /// Forward speed, km/h; in a circle the speed at the end [default: the scenario's]
    #[arg(long, alias = "speed", value_name = "KM_H", allow_negative_numbers = true)]
    speed_km_h: Option<f64>,
    /// Simulated time, s [default: the scenario's]
    #[arg(long, alias = "duration", value_name = "S", allow_negative_numbers = true)]
    duration_s: Option<f64>,
    /// Strategy by which the controller sets the valves [default: the scenario's]
    #[arg(long, value_name = "NAME", value_parser = by_name::<Strategy>())]
    strategy: Option<Strategy>,
    /// Rule by which the strategies ride-handling and road-and-dampers switch the dampers [default: the scenario's]
    #[arg(long, value_name = "NAME", value_parser = by_name::<DamperPolicy>())]
    damper_policy: Option<DamperPolicy>,
    /// Strut model, such as the model.toml that oleo diagnose writes [default: the scenario's]
    #[arg(long, value_name = "MODEL.toml")]
    strut: Option<String>,
    /// Strut model of one corner, of which the controller is not told; may be given for each corner [default: the scenario's, which is
    /// that of all corners unless it has a table strut_at]
    #[arg(long, value_name = "CORNER=MODEL.toml", value_parser = strut_at)]
    strut_at: Vec<(Corner, String)>,
    /// File of vehicle parameters [default: the scenario's]
    #[arg(long, value_name = "VEHICLE.toml")]
    vehicle: Option<String>,
    /// Handling parameters [default: the scenario's]
    #[arg(long, value_name = "HANDLING.toml")]
    handling: Option<String>,
    /// Seed of random roads and of injected faults, up to 2^63 - 1 [default: the scenario's]
    #[arg(long, value_parser = clap::value_parser!(u64).range(..=i64::MAX.cast_unsigned()))]
    seed: Option<u64>,
    /// An inertial unit on the body sends what it reads each tick, three specific forces and three rates, in two more frames (database: oleo
    /// show imu-dbc). Its place ahead, left and up of the body's centre of mass in running order, m; without a place it is in that centre
    #[arg(long, value_name = "X,Y,Z", num_args = 0..=1, require_equals = true, default_missing_value = "0,0,0", value_parser = place)]
    imu: Option<[f64; 3]>,
    /// Run only this node; the other node must run as another process on the same bus
    #[arg(long, value_parser = by_name::<Role>())]
    node: Option<Role>,
    /// Firmware image that is the controller, on an emulated board (needs qemu-system-arm): the ELF file of `cargo build --release
    /// --features slcan` in firmware/. Every frame that it sends is compared with that of the controller in this process
    #[arg(long, value_name = "IMAGE.elf", conflicts_with_all = ["node", "bus", "clock", "strategy", "damper_policy", "strut", "vehicle", "handling"])]
    firmware: Option<PathBuf>,
    /// Number of threads for the two nodes, 1 or 2 (real time always uses 2)
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=2))]
    threads: u8,
    /// Record a strut as a test rig would, or all four: DIR/CORNER is then a campaign for oleo diagnose, with the model that the plant
    /// has of the strut and sensor noise on every channel
    #[arg(long, value_name = "CORNER|all", value_parser = recorded, conflicts_with = "no_out")]
    record: Option<Recorded>,
    /// Serve the run to Foxglove on this machine while it is under way, on this port; a run in lockstep is then held back to real time
    /// (docs/viewers.md)
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "8765")]
    live: Option<u16>,
    #[command(flatten)]
    mcap: McapArgs,
    #[command(flatten)]
    xcp: XcpArgs,
    #[command(flatten)]
    results: ResultsArgs,
}

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    if args.list {
        say(&scenarios()?)?;
        return Ok(ExitCode::SUCCESS);
    }
    let scenario = chosen(&args)?;
    if args.firmware.is_some() {
        suits_image(&scenario)?;
    }
    let companion = args.xcp.companion(&scenario, args.node)?;
    if companion.is_some() && scenario.imu.is_some() {
        return Err(Failure::new(
            "--xcp: the scenario has an inertial unit, and the bus has no room for both: leave one of them out",
        ));
    }
    if args.node == Some(Role::Controller) {
        has_no_vehicle(&args)?;
        return controller(&args, &scenario, companion);
    }
    let name = format!("hil-{}", scenario.name);
    let inputs = inputs(&args, &scenario);
    let mcap = args.mcap.stage(&inputs, args.results.force())?;
    let staged = args.results.stage("oleo hil", &name, inputs)?;
    let [vehicle, handling, strut] = [&scenario.vehicle, &scenario.handling, &scenario.strut]
        .map(|name| (name != DEFENDER).then(|| PathBuf::from(name)));
    let parameters =
        Parameters::read(vehicle.as_ref(), handling.as_ref(), strut.as_ref())?.with_struts_of(&scenario)?;
    let mut vehicle = run::vehicle(&scenario)?;
    if args.record.is_some() {
        vehicle = vehicle.recording_struts();
    }
    let road_measured_m = vehicle.measured_road_m();
    let progress = Progress::new(&scenario.name, scenario.ticks.into());
    // In real time Ctrl-C ends the run, and what has been driven is reported.
    let mut live = live(&args, &scenario)?;
    let takes_its_time = scenario.clock == Clock::RealTime || live.is_some();
    let graceful = takes_its_time.then(Graceful::begin);
    let mut watch = |run: Underway| {
        progress.set(run.ticks.into());
        if let Some(live) = &mut live {
            live.watch(run);
        }
        !graceful.as_ref().is_some_and(Graceful::requested)
    };
    let outcome = match (&args.firmware, args.node) {
        (Some(image), _) => run::with_firmware(&scenario, vehicle, image, &mut watch)?,
        (None, Some(_)) => run::plant_alone(
            &scenario,
            vehicle,
            &mut || waiting_for(Role::Controller, &scenario),
            &mut watch,
        )?,
        (None, None) => run::both_with(&scenario, vehicle, args.threads.into(), companion, &mut watch)?,
    };
    drop(progress);
    if let Some(live) = live {
        let served = live.finish(&outcome);
        let _ = writeln!(std::io::stderr(), "live: {served}");
    }
    if let Some(mcap) = mcap {
        mcap.write(|out| messages(out, &scenario, &outcome))?;
    }
    report(&args, &scenario, &parameters, &outcome, road_measured_m, staged)
}

/// Refuses options that concern the vehicle, which the controller's node does not have.
fn has_no_vehicle(args: &Args) -> Result<(), Failure> {
    let refused = |option: &str, what: &str| {
        let text = format!("{option}: the controller's node has no {what}; give it to the plant's node");
        Err(Failure::new(text))
    };
    if args.record.is_some() {
        return refused("--record", "strut");
    }
    if !args.strut_at.is_empty() {
        return refused("--strut-at", "strut");
    }
    if args.imu.is_some() {
        return refused("--imu", "body");
    }
    if args.live.is_some() {
        return refused("--live", "vehicle");
    }
    if args.mcap.is_given() {
        return refused("--mcap", "vehicle");
    }
    Ok(())
}

/// The server for viewers, if it is wanted. Says where they find it.
fn live(args: &Args, scenario: &Scenario) -> Result<Option<Live>, Failure> {
    let Some(port) = args.live else { return Ok(None) };
    let rows = Rows::new(scenario.course.is_some(), scenario.imu.is_some());
    let hold_back = scenario.clock == Clock::Lockstep;
    let live = Live::begin(port, "oleo hil", rows, hold_back)?;
    let _ = writeln!(
        std::io::stderr(),
        "live: open {} in Foxglove (Open connection, Foxglove WebSocket)",
        live.address()
    );
    Ok(Some(live))
}

/// Writes the messages of a run.
fn messages(out: &mut BufWriter<File>, scenario: &Scenario, outcome: &Outcome) -> std::io::Result<()> {
    let plant = &outcome.plant;
    let mut rows = Rows::new(scenario.course.is_some(), scenario.imu.is_some());
    let mut file = McapFile::new(out, &program())?;
    file.add(None, rows.columns())?;
    while let Some((tick, row)) = rows.next(&plant.recording, &plant.trace, 0) {
        file.row(0, Rows::time_ns(tick), row)?;
    }
    file.finish()
}

/// The files that a run reads; names of built-in things are no files.
fn inputs(args: &Args, scenario: &Scenario) -> Vec<PathBuf> {
    let built_in = scenario::BUILT_IN.iter().any(|(name, _)| *name == args.scenario);
    let file = (!built_in).then_some(&args.scenario);
    let road = Some(&scenario.road).filter(|road| !road::NAMES.contains(&road.as_str()));
    let parts = [&scenario.strut, &scenario.vehicle, &scenario.handling];
    let parts = (parts.into_iter().chain(scenario.strut_at.values().flatten())).filter(|part| *part != DEFENDER);
    let mut inputs: Vec<PathBuf> = (file.into_iter().chain(road).chain(parts)).map(PathBuf::from).collect();
    inputs.extend(args.firmware.clone());
    inputs
}

/// Whether a scenario drives what the controller in a firmware image is configured for.
fn suits_image(scenario: &Scenario) -> Result<(), Failure> {
    if scenario
        .faults
        .iter()
        .any(|fault| fault.kind == FaultKind::ControllerRestarted)
    {
        return Err(Failure::new(format!(
            "--firmware: the scenario {} restarts the controller, which the emulated board cannot do in step: take another scenario",
            scenario.name
        )));
    }
    let differs = if scenario.strategy != Strategy::default() {
        "strategy"
    } else if [&scenario.vehicle, &scenario.handling, &scenario.strut].map(String::as_str) != [DEFENDER; 3] {
        "vehicle, handling or strut"
    } else if scenario.clock != Clock::Lockstep {
        "clock"
    } else if scenario.bus != BusAddress::InProcess {
        "bus"
    } else {
        return Ok(());
    };
    Err(Failure::new(format!(
        "--firmware: the scenario {} sets {differs}, which an image has of its own: leave it out of the scenario",
        scenario.name
    )))
}

/// The scenario, with the changes of the command line.
fn chosen(args: &Args) -> Result<Scenario, Failure> {
    let bus = (args.bus.as_ref())
        .map(|bus| {
            bus.parse::<BusAddress>()
                .map_err(|e| Failure::new(format!("--bus: {e}")))
        })
        .transpose()?;
    let overrides = Overrides {
        bus,
        clock: args.clock,
        road: args.road.clone(),
        manoeuvre: args.manoeuvre,
        course: args.course.changes(),
        load: args.course.load,
        speed_km_h: args.speed_km_h,
        duration_s: args.duration_s,
        strategy: args.strategy,
        damper_policy: args.damper_policy,
        imu_m: args.imu,
        strut: args.strut.clone(),
        strut_at: args.strut_at.clone(),
        vehicle: args.vehicle.clone(),
        handling: args.handling.clone(),
        seed: args.seed,
    };
    let written = scenario::named(&args.scenario)?;
    overrides.of(&written).map_err(|invalid| option_failure(&invalid))
}

/// Reads a corner with the path of a strut model.
fn strut_at(text: &str) -> Result<(Corner, String), String> {
    let given = text.split_once('=').and_then(|(name, path)| {
        let corner = Corner::named(name)?;
        (!path.is_empty()).then(|| (corner, path.to_owned()))
    });
    let corners = Corner::ALL.map(Corner::name).join(", ");
    given.ok_or_else(|| {
        format!("give a corner and a model file, such as rear-left=model.toml; the corners are {corners}")
    })
}

/// Reads a place: three numbers with commas between.
fn place(text: &str) -> Result<[f64; 3], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(str::parse).collect();
    (numbers.ok().and_then(|numbers| numbers.try_into().ok()))
        .ok_or_else(|| "is no place: give three numbers in m, such as 0.3,0,-0.2".to_owned())
}

/// Reads an enum of a library by the names that the library gives its variants.
fn by_name<T>() -> impl TypedValueParser<Value = T>
where
    T: VariantNames + FromStr<Err = strum::ParseError> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(T::VARIANTS).try_map(|name| name.parse())
}

fn report(
    args: &Args,
    scenario: &Scenario,
    parameters: &Parameters,
    outcome: &Outcome,
    road_measured_m: Option<f64>,
    mut staged: Option<OutputDirectory>,
) -> Result<ExitCode, Failure> {
    let metrics = Metrics::of(scenario, outcome);
    let summary = Summary::of(scenario, outcome, &metrics, road_measured_m);
    let mut text = format!("{}\n", scenario.title());
    if let Some(sentence) = page::mirrored(outcome, &summary) {
        text += &format!("{sentence}\n");
    }
    text += &page::outcome_table(&summary).to_string();
    if !summary.checks.is_empty() {
        text += &page::check_table(&summary).to_string();
    }
    if let Some(out) = &mut staged {
        output::write(out, scenario, outcome, &metrics, &summary)?;
        parameters.keep(out)?;
        out.write("scenario.toml", scenario.to_toml())?;
        out.write("oleo.dbc", DBC)?;
        if scenario.imu.is_some() {
            out.write("imu.dbc", imu::DBC)?;
        }
        out.page(&page::page(scenario, outcome, &metrics, &summary, &command_line()))?;
        for corner in args.record.iter().flat_map(|recorded| &recorded.0) {
            text += &record(out, scenario, outcome, *corner)?;
        }
    }
    args.results.publish(staged, &text)?;
    if let Some(failure) = &summary.bus_failure {
        let _ = writeln!(
            std::io::stderr(),
            "error: the run ended after {} ticks: {failure}",
            summary.ticks
        );
    }
    Ok(match interrupt::status() {
        Some(status) => ExitCode::from(status),
        None if summary.passed() => ExitCode::SUCCESS,
        None => ExitCode::FAILURE,
    })
}

/// Says for what a node waits, so that a user who forgot to start the other one need not guess.
fn waiting_for(partner: Role, scenario: &Scenario) {
    let _ = writeln!(
        std::io::stderr(),
        "waiting for the {0} on the bus of {1}; if it does not run yet, start `oleo hil --node {0}` on the same bus",
        partner.name(),
        scenario.bus
    );
}

/// Runs the controller's node alone. Its results go to standard output and to `summary.json`.
fn controller(args: &Args, scenario: &Scenario, companion: Option<Box<dyn Companion>>) -> Result<ExitCode, Failure> {
    let name = format!("hil-{}-controller", scenario.name);
    let mut staged = args
        .results
        .stage("oleo hil --node controller", &name, inputs(args, scenario))?;
    let ended = run::controller_alone(scenario, companion, &mut || waiting_for(Role::Plant, scenario))?;
    let mut table = Table::new([Column::text("Quantity"), Column::number("Value")]);
    table.row(["node".to_owned(), Role::Controller.name().to_owned()]);
    table.row(["ticks".to_owned(), ended.words.len().to_string()]);
    table.row(["command hash".to_owned(), command_hash(ended.words.iter().copied())]);
    table.row(["wall clock, s".to_owned(), significant(ended.wall_s, 3)]);
    table.row(["frames lost".to_owned(), ended.frames_lost.to_string()]);
    table.row(["end-to-end errors".to_owned(), ended.e2e_errors.to_string()]);
    for (tick, mode, fault) in &ended.account {
        let cause = if *mode == Mode::Normal { "" } else { fault.name() };
        table.row([
            format!("tick {tick}: mode"),
            format!("{} {cause}", mode.name()).trim_end().to_owned(),
        ]);
    }
    if let Some(late) = &ended.lateness {
        let figures = format!("{} / {} / {}", late.p50_us, late.p99_us, late.max_us);
        table.row(["lateness, median / 99 % / largest, us".to_owned(), figures]);
        table.row(["overruns".to_owned(), late.overruns.to_string()]);
    }
    if let Some(out) = &mut staged {
        out.summary("summary.json", Some(scenario.seed), &controller_summary(&ended))?;
    }
    args.results.publish_with(staged, &table.to_string(), "summary.json")?;
    let Some(lost) = ended.plant_lost else {
        return Ok(ExitCode::SUCCESS);
    };
    let answer = match lost.safe_after {
        Some(ticks) => format!("the controller was in mode safe with all valves closed {ticks} ticks later"),
        None => "the controller was still in mode start-up with all valves closed".into(),
    };
    let last = lost.last_tick;
    let _ = if lost.restarted {
        writeln!(
            std::io::stderr(),
            "the plant was started again after tick {last}, which is another run: {answer}; start this node again too"
        )
    } else {
        writeln!(std::io::stderr(), "the plant fell silent after tick {last}: {answer}")
    };
    Ok(ExitCode::FAILURE)
}

#[derive(serde::Serialize)]
struct ControllerSummary {
    node: &'static str,
    ticks: usize,
    wall_s: f64,
    command_hash: String,
    frames_lost: u64,
    e2e_errors: u64,
    modes: Vec<output::ModeEntry>,
    plant_lost_after_tick: Option<u32>,
    ticks_to_safe: Option<u32>,
}

fn controller_summary(ended: &ControllerOutcome) -> ControllerSummary {
    let entry = |(tick, mode, fault): &(u32, Mode, FaultCode)| output::ModeEntry {
        tick: *tick,
        mode: mode.name(),
        fault: fault.name(),
    };
    ControllerSummary {
        node: Role::Controller.name(),
        ticks: ended.words.len(),
        wall_s: ended.wall_s,
        command_hash: command_hash(ended.words.iter().copied()),
        frames_lost: ended.frames_lost,
        e2e_errors: ended.e2e_errors,
        modes: ended.account.iter().map(entry).collect(),
        plant_lost_after_tick: ended.plant_lost.map(|lost| lost.last_tick),
        ticks_to_safe: ended.plant_lost.and_then(|lost| lost.safe_after),
    }
}
