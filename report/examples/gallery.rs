//! Every kind of figure on one page, to look at after a change: `cargo run -p oleo-report --example gallery -- OUT`.

use oleo_report::{
    Axis, Bars, Cell, Column, Curves, Field, FieldStyle, Origin, OutputDirectory, Page, Style, Table, Verdict,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Some(destination) = std::env::args().nth(1) else {
        return Err("name an output folder".into());
    };
    let mut page = Page::new(
        "Gallery of figures",
        "cargo run -p oleo-report --example gallery -- out",
    );
    page.fact("Strut", "defender110, static load 8 kN")
        .verdict(Verdict::Pass, "3 of 3 checks met");
    let mut outcome = Table::new([
        Column::text("Limit"),
        Column::number("Value"),
        Column::text("Unit"),
        Column::text("Met"),
    ]);
    outcome.row([
        Cell::from("pressure at full bump"),
        "19.5".into(),
        "MPa".into(),
        Cell::check(true),
    ]);
    outcome.row([Cell::from("force"), "41.2".into(), "kN".into(), Cell::check(false)]);
    print!("{outcome}");
    page.outcome(outcome.clone());

    let time_s: Vec<f64> = (0..200_000).map(|i| f64::from(i) * 1e-4).collect();
    let force_kn: Vec<f64> = time_s
        .iter()
        .map(|t| 8.0 + 4.0 * libm::sin(3.0 * t) * libm::exp(-0.1 * t))
        .collect();
    let valve: Vec<f64> = time_s
        .iter()
        .map(|t| f64::from(u8::from(libm::sin(0.8 * t) > 0.0)))
        .collect();
    let rough: Vec<f64> = force_kn.iter().map(|force| force * 1.05 + 0.3).collect();
    let mut history = Curves::new("Time histories in linked panels", Axis::new("Time", "s"));
    history
        .link("time")
        .caption("The shaded stretch is where the two differ.");
    history
        .panel(Axis::new("Force", "kN"))
        .line("measured", &time_s, &force_kn);
    history
        .series(Style::Dashed, "predicted", &time_s, &rough)
        .region(4.0, 7.0, "found")
        .vertical(10.0, "switch");
    history.panel(
        Axis::new("Valve 1", "")
            .ticks([(0.0, "closed"), (1.0, "open")])
            .range(-0.2, 1.2),
    );
    history.series(Style::Step, "valve 1", &time_s, &valve);
    history
        .panel(Axis::new("Pressure", "MPa"))
        .line("p1", &time_s, &force_kn)
        .horizontal(11.0, "limit");
    page.section("Curves")
        .text("Lines, steps, regions and limits.")
        .figure(history);

    let x: Vec<f64> = time_s.iter().map(|t| 40.0 * libm::sin(*t)).collect();
    let y: Vec<f64> = time_s.iter().map(|t| 8.0 + 3.0 * libm::sin(*t + 0.2)).collect();
    let mut hysteresis = Curves::new("A loop", Axis::new("Displacement", "mm"));
    hysteresis.panel(Axis::new("Force", "kN")).line("measured", &x, &y);
    hysteresis.points_with_interval(
        "estimates",
        &[-20.0, 0.0, 20.0],
        &[7.0, 8.0, 9.0],
        &[6.8, 7.7, 8.7],
        &[7.2, 8.4, 9.4],
    );
    page.figure(hysteresis);

    let volumes = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0];
    let factors = [0.8, 1.0, 1.5, 2.0, 3.0];
    let roll: Vec<Vec<f64>> = factors
        .iter()
        .map(|factor| {
            volumes
                .iter()
                .map(|&v| {
                    if v > 2.0 && *factor < 1.1 {
                        f64::NAN
                    } else {
                        6.0 + 2.0 * libm::log10(v) + 0.1 * factor
                    }
                })
                .collect()
        })
        .collect();
    page.section("Fields");
    for style in [FieldStyle::HeatMap, FieldStyle::Contour] {
        let axes = [
            Axis::new("Static gas volume", "l").logarithmic(),
            Axis::new("Damper factor", ""),
            Axis::new("Roll angle", "deg"),
        ];
        let mut field = Field::new("Roll", style, axes, &volumes, &factors, &roll);
        field
            .path("optimiser", &[1.0, 0.3, 0.01], &[2.0, 1.0, 0.8])
            .caption("Gaps: rolled over.");
        page.figure(field);
    }
    let mut bars = Bars::new(
        "Held-out noise ratio",
        ["p1", "p2", "force"],
        Axis::new("Noise ratio", ""),
    );
    bars.series("without", &[14.2, 3.0, 9.0])
        .series("with", &[1.1, 1.0, 1.2]);
    page.section("Bars").figure(bars).details("All rows", outcome);

    let mut out = OutputDirectory::stage(destination, Origin::default(), true)?;
    out.page(&page)?;
    out.commit()?;
    Ok(())
}
