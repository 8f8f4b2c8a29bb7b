//! `oleo rig replay`: figures 31 to 34 of the report, or the inputs of a recording simulated with either model
//! generation.

use std::path::PathBuf;
use std::process::ExitCode;

use oleo_interface::{PressurePoint, StrutValves, Valve};
use oleo_plant_sim::rig::{
    FirstGenerationRun, Programme, Record, RecordedStrut, demonstration, play, run_first_generation, spring_comparison,
};
use oleo_plant_sim::strut::{StrutModel, replay};
use oleo_report::{Axis, Column, Curves, Style, Table};
use serde_json::json;

use super::sheet::{Sheet, Specimen};
use crate::failure::Failure;

/// Run the first-generation model (the report's SIMULINK model) and the second-generation model on the same inputs.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo rig replay --generation first --out replay        repeats the report's figures 31 to 34\n  \
                  oleo rig replay campaign/road_switching.csv --strut campaign/model.toml --out replay"
)]
pub struct Args {
    /// Recording whose displacement and switching signals are the inputs [default: the report's illustrative runs]
    #[arg(value_name = "RECORDING.csv")]
    recording: Option<PathBuf>,
    #[command(flatten)]
    specimen: Specimen,
    /// Model to run
    #[arg(long, value_enum, default_value_t = Generation::Both)]
    generation: Generation,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Generation {
    /// The report's model: look-up tables, isothermal gas, valves that switch as a delayed step
    First,
    /// The hydraulic network of oleo, with the effects of the model file
    Second,
    /// Both models, compared
    Both,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    let model = args.specimen.model()?;
    let mut sheet = args
        .specimen
        .sheet("replay", "Rig: replay", &model, args.recording.as_ref())?;
    let mut table = Table::new([
        Column::text("Run"),
        Column::number("Peak force, kN"),
        Column::number("RMS difference, kN"),
        Column::number("Largest difference, kN"),
    ]);
    let mut runs = Vec::new();
    match &args.recording {
        None => {
            runs.push(Run::of("illustrative", &model, &demonstration())?);
            runs.push(Run::of("comparison", &model, &spring_comparison())?);
        }
        Some(path) => runs.push(Run::recorded(&model, path)?),
    }
    for run in &runs {
        run.tabulate(&mut table, args.generation);
    }
    sheet.page.outcome(table.clone());
    for run in &runs {
        run.draw(&mut sheet, args.generation);
        run.write(&mut sheet, args.generation)?;
    }
    sheet.publish(&table.to_string())?;
    Ok(ExitCode::SUCCESS)
}

/// One set of inputs simulated with both generations. Without a recording the second generation replaces the test rig.
struct Run {
    name: String,
    record: Record,
    first: FirstGenerationRun,
    /// Force from p1, N: what the first generation's spring force is compared with.
    pressure_force_n: Vec<f64>,
    recorded_force_n: Option<Vec<f64>>,
}

impl Run {
    fn of(name: &str, model: &StrutModel, programme: &Programme) -> Result<Self, Failure> {
        Self::from_record(name, model, play(model, programme)?, None)
    }

    fn recorded(model: &StrutModel, path: &PathBuf) -> Result<Self, Failure> {
        let file = path.display().to_string();
        let source = std::fs::File::open(path)
            .map_err(|error| Failure::new(format!("{file}: cannot read the recording: {error}; check the path")))?;
        let recording = RecordedStrut::read(source, &file)?;
        let inputs = recording.inputs(model.noise.get("displacement_m").copied().unwrap_or(0.0));
        let predicted = replay(model, &inputs)?;
        let first_speed = inputs.motion.segments.first().map_or(0.0, |segment| segment.from_m_s);
        let record = Record {
            speed_m_s: std::iter::once(first_speed)
                .chain(inputs.motion.segments.iter().map(|s| s.to_m_s))
                .collect(),
            time_s: recording.time_s,
            displacement_m: recording.displacement_m,
            force_n: predicted.force_n,
            pressure_pa: predicted.pressure_pa,
            signals: recording.signals,
        };
        let name = path
            .file_stem()
            .map_or_else(|| "recording".into(), |stem| stem.to_string_lossy().into_owned());
        Self::from_record(&name, model, record, recording.force_n)
    }

    fn from_record(
        name: &str,
        model: &StrutModel,
        record: Record,
        recorded_force_n: Option<Vec<f64>>,
    ) -> Result<Self, Failure> {
        let first = run_first_generation(
            model,
            &record.time_s,
            &record.displacement_m,
            &record.speed_m_s,
            &record.signals,
        )?;
        let area_m2 = model.piston_area_m2();
        let pressure_force_n = record.pressure_pa[PressurePoint::P1.index()]
            .iter()
            .map(|pressure| pressure * area_m2)
            .collect();
        Ok(Self {
            name: name.to_owned(),
            record,
            first,
            pressure_force_n,
            recorded_force_n,
        })
    }

    /// What the generations are held against: the recording, else the second generation.
    fn truth(&self) -> &[f64] {
        self.recorded_force_n.as_deref().unwrap_or(&self.record.force_n)
    }

    fn tabulate(&self, table: &mut Table, generation: Generation) {
        let mut row = |name: String, force: &[f64], truth: &[f64]| {
            let (rms, largest) = differences(force, truth);
            let peak = force.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
            let kn = |value: f64| format!("{:.3}", 1e-3 * value);
            table.row([name, kn(peak), kn(rms), kn(largest)]);
        };
        let against = if self.recorded_force_n.is_some() {
            "recording"
        } else {
            "second generation"
        };
        if generation != Generation::Second {
            row(
                format!("{}: first generation, against {against}", self.name),
                &self.first.force_n,
                self.truth(),
            );
            if self.recorded_force_n.is_none() {
                let name = format!("{}: spring force, against pressure", self.name);
                row(name, &self.first.spring_force_n, &self.pressure_force_n);
            }
        }
        if generation != Generation::First && self.recorded_force_n.is_some() {
            row(
                format!("{}: second generation, against {against}", self.name),
                &self.record.force_n,
                self.truth(),
            );
        }
    }

    fn draw(&self, sheet: &mut Sheet, generation: Generation) {
        let time = &self.record.time_s;
        let scaled = |values: &[f64], by: f64| values.iter().map(|value| by * value).collect::<Vec<f64>>();
        let (first, second) = (generation != Generation::Second, generation != Generation::First);
        sheet.page.section(&format!("Run: {}", self.name));

        let mut inputs = Curves::new("Displacement and speed (report, figure 31)", Axis::new("Time", "s"));
        inputs.link(&self.name).panel(Axis::new("Displacement", "mm"));
        inputs.line("displacement", time, &scaled(&self.record.displacement_m, 1e3));
        inputs
            .panel(Axis::new("Speed", "m/s"))
            .line("speed", time, &self.record.speed_m_s);
        sheet.page.figure(inputs);

        let mut switches = Curves::new(
            "Switch signals and delayed switch signals (report, figure 32)",
            Axis::new("Time", "s"),
        );
        switches.link(&self.name);
        for valve in Valve::ALL {
            let state =
                |states: &[StrutValves<bool>]| states.iter().map(|s| f64::from(u8::from(s[valve]))).collect::<Vec<_>>();
            let ticks = [(0.0, "closed"), (1.0, "open")];
            switches.panel(
                Axis::new(&format!("Valve {}", valve.number()), "")
                    .ticks(ticks)
                    .range(-0.15, 1.15),
            );
            switches.series(Style::Step, "signal", time, &state(&self.record.signals));
            if first {
                switches.series(
                    Style::Step,
                    "acting, first generation",
                    time,
                    &state(&self.first.acting),
                );
            }
        }
        sheet.page.figure(switches);

        let mut force = Curves::new("Output force (report, figures 33 and 34)", Axis::new("Time", "s"));
        force.link(&self.name).panel(Axis::new("Force", "kN")).height(460);
        if let Some(recorded) = &self.recorded_force_n {
            force.line("recorded", time, &scaled(recorded, 1e-3));
        }
        if second {
            force.line("second generation", time, &scaled(&self.record.force_n, 1e-3));
        }
        if first {
            force.series(
                Style::Dashed,
                "first generation",
                time,
                &scaled(&self.first.force_n, 1e-3),
            );
            force.series(
                Style::Dashed,
                "first generation, spring alone",
                time,
                &scaled(&self.first.spring_force_n, 1e-3),
            );
        }
        if first && second {
            force.line(
                "second generation, from pressure p1",
                time,
                &scaled(&self.pressure_force_n, 1e-3),
            );
        }
        force.caption(
            "The first-generation model switches between its tables in one step, so its force jumps when a valve switches away \
             from the reference position. In the second-generation model the pressure of the trapped gas equalises \
             gradually.",
        );
        sheet.page.figure(force);
    }

    fn write(&self, sheet: &mut Sheet, generation: Generation) -> Result<(), Failure> {
        let acting = |valve: Valve| {
            self.first
                .acting
                .iter()
                .map(|s| f64::from(u8::from(s[valve])))
                .collect::<Vec<_>>()
        };
        let [one, two, three] = Valve::ALL.map(acting);
        let mut more: Vec<(&str, &[f64])> = vec![("speed_m_s", &self.record.speed_m_s)];
        if generation != Generation::Second {
            more.extend([
                ("first_generation_force_N", self.first.force_n.as_slice()),
                ("first_generation_spring_force_N", &self.first.spring_force_n),
                ("acting1", &one),
                ("acting2", &two),
                ("acting3", &three),
            ]);
        }
        sheet.record(&format!("{}.csv", self.name), &self.record, &more)?;
        let (rms, largest) = differences(&self.first.force_n, self.truth());
        let (spring_rms, spring_largest) = differences(&self.first.spring_force_n, &self.pressure_force_n);
        sheet.summarise(
            &self.name,
            json!({
                "against": if self.recorded_force_n.is_some() { "recording" } else { "second generation" },
                "first_generation_rms_N": rms, "first_generation_largest_N": largest,
                "spring_force_rms_N": spring_rms, "spring_force_largest_N": spring_largest,
            }),
        );
        Ok(())
    }
}

/// Root mean square and largest difference.
fn differences(a: &[f64], b: &[f64]) -> (f64, f64) {
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    let largest = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    ((square / a.len().max(1) as f64).sqrt(), largest)
}
