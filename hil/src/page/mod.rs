//! `report.html` of a run: the outcome first, then road, body, struts, controller and bus, on one time axis.

mod course;
mod time;

use oleo_controller::Mode;
use oleo_interface::tick::TICK_S;
use oleo_interface::{Axle, Corner, PressurePoint, Side, Valve};
use oleo_report::{Axis, Bars, Cell, Column, Page, Style, Table, Verdict, significant};
use strum::VariantArray;

use crate::metrics::Metrics;
use crate::output::Summary;
use crate::record::status_messages;
use crate::run::Outcome;
use crate::scenario::Scenario;
pub use course::{Path, map};
use time::Time;

/// The page of a run. `command` is the command line that makes it again.
pub fn page(scenario: &Scenario, outcome: &Outcome, metrics: &Metrics, summary: &Summary, command: &str) -> Page {
    let mut page = Page::new(&format!("Hardware-in-the-loop: {}", scenario.title()), command);
    if scenario.changes.is_empty() {
        page.fact("Scenario", &scenario.description);
    } else {
        page.fact("Scenario", &scenario.title());
    }
    page.fact(
        "Road",
        &format!("{} at {} km/h", scenario.road, significant(scenario.speed_m_s * 3.6, 3)),
    );
    if let Some(sentence) = mirrored(outcome, summary) {
        page.fact("Road file", &sentence);
    }
    if let (Some(settings), Some(course)) = (&scenario.course, &summary.course) {
        page.fact("Manoeuvre", settings.kind.title());
        page.fact("Driver", course.driver);
        if course.side_slope_percent != 0.0 {
            page.fact("Side slope", &format!("{} %", course.side_slope_percent));
        }
    }
    page.fact("Load", summary.load);
    page.fact("Strategy", summary.strategy);
    page.fact("Bus, clock", &format!("{}, {}", summary.bus, summary.clock));
    page.fact("Seed", &scenario.seed.to_string());
    let failed = summary.checks.iter().filter(|check| !check.passed).count();
    let (verdict, sentence) = match (failed, summary.checks.len()) {
        (0, 0) => (Verdict::Attention, "The scenario has no checks.".to_owned()),
        (0, all) => (Verdict::Pass, format!("All {all} checks are met.")),
        (failed, all) => (Verdict::Fail, format!("{failed} of {all} checks are not met.")),
    };
    page.verdict(verdict, &sentence);
    page.outcome(outcome_table(summary));
    if !summary.checks.is_empty() {
        page.table(check_table(summary));
    }
    let time = Time::of(scenario, outcome);
    road(&mut page, outcome, &time);
    course::section(&mut page, outcome, &time);
    body(&mut page, outcome, &time);
    struts(&mut page, outcome, &time);
    controller(&mut page, outcome, metrics, summary, &time);
    bus(&mut page, outcome, metrics, summary);
    page
}

/// What a drive that is longer than its road file drove over; `None` where the file is long enough.
pub fn mirrored(outcome: &Outcome, summary: &Summary) -> Option<String> {
    let measured_m = summary.road_measured_m?;
    let driven_m = outcome.plant.recording.samples.last()?.motion.station_m;
    (driven_m > measured_m).then(|| {
        format!(
            "{} is {} m long. The {} m of this drive go over it and over its mirror image, back and forth.",
            summary.road,
            significant(measured_m, 3),
            significant(driven_m, 3)
        )
    })
}

/// Table of the run's figures, for the terminal and the page.
pub fn outcome_table(summary: &Summary) -> Table {
    let mut table = Table::new([Column::text("Quantity"), Column::number("Value"), Column::text("Unit")]);
    let mut row = |quantity: &str, value: String, unit: &str| {
        table.row([quantity.to_owned(), value, unit.to_owned()]);
    };
    row("simulated", significant(summary.simulated_s, 4), "s");
    row("wall clock", significant(summary.wall_s, 3), "s");
    row("real time factor", significant(summary.real_time_factor, 3), "");
    row("command hash", summary.command_hash.clone(), "");
    row(
        "vertical weighted RMS, driver (BS 6841)",
        significant(summary.weighted_rms_driver_m_s2, 3),
        "m/s2",
    );
    row(
        "vertical weighted RMS, left rear passenger",
        significant(summary.weighted_rms_rear_left_m_s2, 3),
        "m/s2",
    );
    row(
        "vertical vibration dose, driver",
        significant(summary.vdv_driver_m_s1_75, 3),
        "m/s^1.75",
    );
    row("largest roll", significant(summary.max_roll_deg, 3), "degrees");
    if let Some(course) = &summary.course {
        let known = |value: Option<f64>| value.map_or("never".to_owned(), |value| significant(value, 3));
        row("manoeuvre", course.ending.unwrap_or("stopped").to_owned(), "");
        row(
            "largest lateral acceleration",
            significant(course.max_lateral_m_s2, 3),
            "m/s2",
        );
        if let Some(deviation_m) = course.max_path_deviation_m {
            row("largest path deviation", significant(deviation_m, 3), "m");
        }
        if let Some(margin_m) = course.cone_margin_m {
            row("least room to the cones (negative: hit)", significant(margin_m, 3), "m");
        }
        row("handling decided after 0.5 m/s2", known(course.decision_s), "s");
        for (quantity, value) in [
            ("weighted RMS, driver, before", course.weighted_rms_driver_before_m_s2),
            ("weighted RMS, driver, after", course.weighted_rms_driver_after_m_s2),
        ] {
            if value.is_some() {
                row(quantity, known(value), "m/s2");
            }
        }
    }
    row(
        "handling mode reported anew",
        summary.handling_entries.to_string(),
        "times",
    );
    row(
        "valve switches",
        summary.valve_switches.iter().sum::<u64>().to_string(),
        "",
    );
    row("frames sent", summary.frames_sent.to_string(), "");
    row("frames lost", summary.frames_lost.to_string(), "");
    row("end-to-end errors", summary.e2e_errors.to_string(), "");
    row(
        "bus load at 500 kbit/s",
        significant(100.0 * summary.bus_load_500k, 3),
        "%",
    );
    let answers = [
        ("fault detected after", summary.ticks_to_detect),
        ("mode safe after", summary.ticks_to_safe),
        ("valves closed after", summary.ticks_to_closed),
        ("mode normal again after the fault ended", summary.ticks_to_recover),
    ];
    for (quantity, ticks) in answers {
        if let Some(ticks) = ticks {
            row(quantity, ticks.to_string(), "ticks");
        }
    }
    if let Some(tick) = summary.controller_lost_at_tick {
        row("controller counted as lost in tick", tick.to_string(), "");
    }
    if summary.controller_rejoined > 0 {
        row(
            "controller started again",
            summary.controller_rejoined.to_string(),
            "times",
        );
    }
    if summary.foreign_sync_frames > 0 {
        let count = summary.foreign_sync_frames.to_string();
        row("sync frames of another run, ignored", count, "");
    }
    if let Some(failure) = &summary.bus_failure {
        row("the run was ended by the bus", failure.clone(), "");
    }
    for node in &summary.lateness {
        let late = &node.lateness;
        row(
            &format!("{} lateness, median / 99 % / largest", node.node),
            format!("{} / {} / {}", late.p50_us, late.p99_us, late.max_us),
            "us",
        );
        row(&format!("{} overruns", node.node), late.overruns.to_string(), "ticks");
    }
    table
}

/// Table of the checks, for the terminal and the page.
pub fn check_table(summary: &Summary) -> Table {
    let mut table = Table::new([Column::text("Check"), Column::number("Figure"), Column::text("Met")]);
    for check in &summary.checks {
        table.row::<Cell>([
            check.name.as_str().into(),
            check.figure.as_str().into(),
            Cell::check(check.passed),
        ]);
    }
    table
}

fn road(page: &mut Page, outcome: &Outcome, time: &Time) {
    let samples = &outcome.plant.recording.samples;
    let mut curves = time.curves("Road under the front wheels");
    curves.panel(Axis::new("Height", "mm"));
    for side in Side::ALL {
        let corner = Axle::Front.corner(side);
        let height: Vec<f64> = samples
            .iter()
            .map(|sample| 1e3 * sample.motion.wheel[corner].road_height_m)
            .collect();
        curves.line(side.key(), &time.s, &height);
    }
    page.section("Road").figure(curves);
}

fn body(page: &mut Page, outcome: &Outcome, time: &Time) {
    let recording = &outcome.plant.recording;
    let samples = &recording.samples;
    let mut curves = time.curves("Sprung mass");
    let mut panel = |axis: Axis, name: &str, value: &dyn Fn(usize) -> f64| {
        let values: Vec<f64> = (0..samples.len()).map(value).collect();
        curves.panel(axis).line(name, &time.s, &values);
        time.mark(&mut curves);
    };
    panel(Axis::new("Heave", "mm"), "heave", &|i| {
        1e3 * samples[i].motion.body.heave_m
    });
    panel(Axis::new("Roll", "degrees"), "roll", &|i| {
        samples[i].motion.body.roll_rad.to_degrees()
    });
    panel(Axis::new("Pitch", "degrees"), "pitch", &|i| {
        samples[i].motion.body.pitch_rad.to_degrees()
    });
    page.section("Body motion")
        .text("Heave is positive upwards, roll with the left side up, and pitch with the nose down.")
        .figure(curves);

    let step_s: Vec<f64> = (1..=recording.seat_acceleration_m_s2.len())
        .map(|i| i as f64 * recording.step_s)
        .collect();
    let mut felt = time.curves("Vertical acceleration at the seats");
    for (seat, name) in ["driver", "left rear passenger"].into_iter().enumerate() {
        let values: Vec<f64> = recording.seat_acceleration_m_s2.iter().map(|a| a[seat]).collect();
        felt.panel(Axis::new(name, "m/s2")).line(name, &step_s, &values);
        time.mark(&mut felt);
    }
    page.figure(felt);
}

fn struts(page: &mut Page, outcome: &Outcome, time: &Time) {
    let samples = &outcome.plant.recording.samples;
    page.section("Struts").text(
        "Compression is positive, and pressures are gauge pressures. Valves 1 and 2 bypass the dampers; when they are open, the \
         damping is low. Valve 3 connects the 0.4 l accumulator; when it is open, the spring is soft.",
    );
    for corner in Corner::ALL {
        let column = |value: &dyn Fn(usize) -> f64| (0..samples.len()).map(value).collect::<Vec<f64>>();
        let mut curves = time.curves(&format!("Strut {}", corner.name().replace('-', " ")));
        curves.height(620);
        curves.panel(Axis::new("Displacement", "mm"));
        curves.line(
            "displacement",
            &time.s,
            &column(&|i| 1e3 * samples[i].displacement_m[corner]),
        );
        time.mark(&mut curves);
        curves.panel(Axis::new("Pressure", "MPa"));
        for point in PressurePoint::ALL {
            let pressure = column(&|i| 1e-6 * samples[i].strut[corner].pressure_pa[point.index()]);
            curves.line(point.key(), &time.s, &pressure);
        }
        curves.panel(Axis::new("Force", "kN"));
        curves.line("force", &time.s, &column(&|i| 1e-3 * samples[i].strut[corner].force_n));
        // The three signals lie above each other. A signal is at its label when closed, and above it when open.
        curves.panel(
            Axis::new("Open", "")
                .ticks([(0.0, "valve 1"), (1.5, "valve 2"), (3.0, "valve 3")])
                .range(-0.3, 4.3),
        );
        for valve in Valve::ALL {
            let label = 1.5 * valve.index() as f64;
            let open = column(&|i| label + f64::from(u8::from(samples[i].energised.is_open(corner, valve))));
            curves.series(Style::Step, &format!("valve {}", valve.number()), &time.s, &open);
        }
        page.figure(curves);
    }
}

fn controller(page: &mut Page, outcome: &Outcome, metrics: &Metrics, summary: &Summary, time: &Time) {
    let mode: Vec<f64> = metrics
        .account
        .iter()
        .map(|account| account.map_or(f64::NAN, |(mode, _)| f64::from(mode.raw())))
        .collect();
    let mut curves = time.curves("Mode and strategy");
    let names = Mode::VARIANTS.iter().map(|mode| (f64::from(mode.raw()), mode.name()));
    curves.panel(Axis::new("Mode", "").ticks(names).range(-0.4, 4.4));
    curves.series(Style::Step, "mode", &time.s, &mode);
    time.mark(&mut curves);
    let status = status_messages(&outcome.plant.trace);
    let status_s: Vec<f64> = status.iter().map(|(tick, _)| f64::from(*tick) * TICK_S).collect();
    let of = |value: &dyn Fn(&oleo_controller::can::StatusMessage) -> f64| -> Vec<f64> {
        status.iter().map(|(_, message)| value(message)).collect()
    };
    curves.panel(Axis::new("Running RMS", "m/s2"));
    curves.line("lateral, estimated", &status_s, &of(&|m| m.lateral_rms_m_s2.into()));
    curves.line("vertical", &status_s, &of(&|m| m.vertical_rms_m_s2.into()));
    curves.panel(
        Axis::new("Strategy", "")
            .ticks([(0.0, "ride"), (1.0, "handling")])
            .range(-0.2, 1.2),
    );
    curves.series(
        Style::Step,
        "setting",
        &status_s,
        &of(&|m| f64::from(u8::from(m.handling))),
    );
    curves.series(
        Style::Step,
        "roll-over guard",
        &status_s,
        &of(&|m| f64::from(u8::from(m.rollover_guard))),
    );
    page.section("Controller")
        .text("The values are taken from the frames that the controller sent, before any injected fault changed them.")
        .figure(curves);

    let mut table = Table::new([
        Column::number("Tick"),
        Column::number("Time, s"),
        Column::text("Mode entered"),
        Column::text("First cause"),
    ]);
    for entry in &summary.modes {
        let time_s = significant(f64::from(entry.tick) * TICK_S, 5);
        table.row([
            entry.tick.to_string(),
            time_s,
            entry.mode.to_owned(),
            entry.fault.to_owned(),
        ]);
    }
    page.table(table);
    let (mut names, mut edges) = (Vec::new(), Vec::new());
    for (corner, strut) in metrics.valve_switches.iter() {
        for (valve, count) in strut.iter() {
            names.push(format!("{} {}", corner.name(), valve.number()));
            edges.push(*count as f64);
        }
    }
    let mut bars = Bars::new(
        "Valve switches",
        names.iter().map(String::as_str),
        Axis::new("Edges", ""),
    );
    bars.series("edges", &edges);
    page.figure(bars);
}

fn bus(page: &mut Page, outcome: &Outcome, metrics: &Metrics, summary: &Summary) {
    let counters = &outcome.plant.counters;
    let injected = &outcome.plant.injected;
    let mut table = Table::new([Column::text("Frames"), Column::number("Count")]);
    for (name, count) in [
        ("messages on the wire, both directions", summary.frames_sent),
        ("lost by the bus itself", summary.bus_frames_lost),
        ("of other nodes, ignored", summary.foreign_frames),
        ("failed the end-to-end check in either node", summary.e2e_errors),
        ("injected: dropped", injected.dropped),
        ("injected: corrupted", injected.corrupted),
        ("injected: delayed", injected.delayed),
        ("injected: duplicated", injected.duplicated),
        ("injected: replaced by an old one", injected.replayed),
        ("injected: forged", injected.forged),
        ("plant node: dropped by the kernel", counters.receive_lost),
        ("plant node: not sent because the queue was full", counters.send_lost),
        ("plant node: waits for a full queue", counters.back_offs),
        ("plant node: unreadable", counters.unreadable),
    ] {
        table.row([name.to_owned(), count.to_string()]);
    }
    page.section("Bus").table(table);
    for wire in &metrics.wires {
        let rate = wire.bit_rate / 1000;
        page.text(&format!(
            "A wire of {rate} kbit/s would be busy for {} % of the time, and for {} % of the busiest tick, with the stuff bits that occurred. \
             The table gives the latency from ready to sent in microseconds. Its bound is that of the response-time analysis of Davis \
             et al. (2007) with worst-case stuffing.",
            significant(100.0 * wire.utilisation, 3),
            significant(100.0 * wire.peak_utilisation, 3),
        ));
        let mut latency = Table::new([
            Column::text("Message"),
            Column::text("Identifier"),
            Column::number("Frames"),
            Column::number("Mean, us"),
            Column::number("Longest, us"),
            Column::number("Bound, us"),
        ]);
        for message in &wire.messages {
            latency.row([
                message.contract.name.to_owned(),
                format!("{:#05X}", message.contract.id),
                message.frames.to_string(),
                significant(message.mean_us, 3),
                significant(message.max_us, 3),
                significant(message.bound_us, 4),
            ]);
        }
        page.table(latency);
    }
    for node in &summary.lateness {
        let classes: Vec<String> = node
            .lateness
            .histogram
            .iter()
            .map(|(limit, _)| {
                if *limit == u32::MAX {
                    "more".into()
                } else {
                    format!("< {limit}")
                }
            })
            .collect();
        let counts: Vec<f64> = node.lateness.histogram.iter().map(|(_, count)| *count as f64).collect();
        let title = format!("Wake-ups of the {} by lateness, us", node.node);
        let mut bars = Bars::new(&title, classes.iter().map(String::as_str), Axis::new("Ticks", ""));
        bars.series("ticks", &counts);
        page.figure(bars);
    }
}
