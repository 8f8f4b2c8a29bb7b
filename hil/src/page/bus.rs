//! The section on the bus: frames, latencies, and in real time how late the nodes woke.

use oleo_report::{Axis, Bars, Column, Page, Table, significant};

use crate::metrics::Metrics;
use crate::output::Summary;
use crate::run::Outcome;

pub(super) fn section(page: &mut Page, outcome: &Outcome, metrics: &Metrics, summary: &Summary) {
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
