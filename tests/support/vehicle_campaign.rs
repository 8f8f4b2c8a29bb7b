//! Makes campaigns of `kind = "vehicle"` with a known answer: the closed loop of `oleo_hil` drives on struts of which some have an
//! effect that their model files lack, and what its bus carries is logged with all that happens to logs.
//!
//! The strut's equations are plant-sim's in the simulation and in the diagnosis, so that what is shown here is what the logs allow
//! to be found, not the truth of the equations. Everything else differs: the motion comes from the vehicle, in steps of 1 ms.

use std::fmt::Write as _;
use std::path::Path;

use oleo_controller::can::{COMMAND, CommandMessage, FRAME_BYTES, MESSAGES, Protector};
use oleo_controller::{Inputs, PlantEnd, Strategy, ValveCommand};
use oleo_diagnose::effect::{Drawn, TrueNumber, of};
use oleo_diagnose::selftest::{Draw, nominal};
use oleo_diagnose::vocabulary::EffectId;
use oleo_hil::frame::standard;
use oleo_hil::logs::candump::write_line;
use oleo_hil::{Frame, Scenario, run, scenario};
use oleo_interface::tick::{TICK_S, TICK_US};
use oleo_interface::{Corner, Corners, Gauge, PressurePoint, StrutPressures};
use oleo_plant_sim::course::{CourseSettings, ManoeuvreKind};
use oleo_plant_sim::strut::{COLUMNS, OilCount, StrutModel, record_column};
use oleo_plant_sim::vehicle::VehicleParameters;

/// What is concealed.
#[derive(Clone, Debug)]
pub struct Concealed {
    /// The effect.
    pub id: EffectId,
    /// Its variant (the branch, or the column of an instrument), as the self-test of the effect counts.
    pub variant: usize,
    /// Its amount, in the unit of its first parameter.
    pub amount: f64,
    /// 1 or -1, for what may have either sign.
    pub sign: f64,
    /// Uniform numbers in 0..1 that shape the rest.
    pub shape: [f64; 4],
    /// The corners that have it.
    pub corners: Vec<Corner>,
}

impl Concealed {
    /// A positive amount of an effect, whose other numbers lie in the middle of what is drawn.
    pub fn new(id: EffectId, variant: usize, amount: f64, corners: Vec<Corner>) -> Self {
        Self {
            id,
            variant,
            amount,
            sign: 1.0,
            shape: [0.5; 4],
            corners,
        }
    }

    /// Puts the effect into the model of a strut, and returns the numbers that should be found.
    pub fn put(&self, model: &mut StrutModel) -> Vec<TrueNumber> {
        let drawn = Drawn {
            variant: self.variant,
            sign: self.sign,
            shape: self.shape,
            response: model.response_polynomial_s(),
        };
        let effect = of(self.id).in_strut().expect("an effect of struts");
        effect.put_true(model, &drawn, self.amount)
    }
}

/// A campaign to make.
#[derive(Clone, Debug)]
pub struct Case {
    /// Seed of everything drawn.
    pub seed: u64,
    /// What the model files lack.
    pub concealed: Vec<Concealed>,
    /// The drives, each with its name.
    pub drives: Vec<(String, Scenario)>,
    /// Whether `PlantTick` has sixteen bits, as in the first edition of the database.
    pub first_edition: bool,
    /// Whether a command acts one tick after the sample whose tick it echoes.
    pub command_acts_late: bool,
    /// Whether the struts keep their oil, as those of a vehicle do. Else they lose it by the equation of the recordings.
    pub keeps_oil: bool,
    /// Time at which each log begins after the start from rest, s; 0 for logs that begin at rest.
    pub begins_s: f64,
    /// Whether readings are only rounded, as in the logs of `oleo hil`, and have none of the noise that the files state.
    pub without_noise: bool,
}

/// Three drives of `duration_s`: Belgian block straight ahead, a lane change on a rough road, a random road with another strategy.
pub fn drives(seed: u64, duration_s: f64) -> Vec<(String, Scenario)> {
    let base = |name: &str| Scenario {
        ticks: (duration_s / TICK_S) as u32,
        seed,
        faults: vec![],
        checks: vec![],
        ..scenario::named(name).expect("built in")
    };
    let belgian = Scenario {
        speed_m_s: 14.0,
        ..base("belgian")
    };
    let lane_change = Scenario {
        course: Some(CourseSettings {
            entry_m: Some(40.0),
            ..CourseSettings::new(ManoeuvreKind::LaneChange)
        }),
        road: "iso-c".into(),
        strategy: Strategy::RideHandling,
        ..base("belgian")
    };
    let random = Scenario {
        road: "iso-d".into(),
        speed_m_s: 12.0,
        strategy: Strategy::RideHandling,
        ..base("belgian")
    };
    vec![
        ("belgian".into(), belgian),
        ("lane-change".into(), lane_change),
        ("random-road".into(), random),
    ]
}

/// The strut as it is: every number that has a tolerance is off by up to it.
fn within_tolerance(given: &StrutModel, draw: &mut Draw) -> StrutModel {
    let mut model = given.clone();
    let tolerance = |key: &str| given.tolerance.get(key).copied().unwrap_or(0.0);
    let mut off = |key: &str| 1.0 + tolerance(key) * draw.between(-1.0, 1.0);
    for accumulator in &mut model.accumulator {
        accumulator.static_gas_volume_m3 *= off("static_gas_volume");
    }
    for valve in &mut model.valve {
        valve.flow_coefficient *= off("flow_coefficient");
    }
    model.cylinder.oil_volume_m3 *= off("oil_volume");
    if let Some(oil) = &mut model.effects.oil_compressibility {
        oil.bulk_modulus_pa *= off("bulk_modulus");
    }
    if let Some(heat) = &mut model.effects.gas_heat_transfer {
        heat.time_constant_1_s *= off("time_constant");
        heat.time_constant_2_s *= off("time_constant");
    }
    model.gas.temperature_k += tolerance("temperature_K") * draw.between(-1.0, 1.0);
    let offsets = model.effects.sensor_offset.get_or_insert_default();
    offsets.insert(
        COLUMNS[0].into(),
        tolerance("displacement_offset_m") * draw.between(-1.0, 1.0),
    );
    for column in &COLUMNS[2..] {
        offsets.insert(
            (*column).into(),
            tolerance("pressure_offset_Pa") * draw.between(-1.0, 1.0),
        );
    }
    model
}

/// A number that is concealed at a corner.
pub struct TrueAtCorner {
    pub corner: Corner,
    /// The effect that it belongs to.
    pub id: EffectId,
    pub number: TrueNumber,
}

/// Writes `model.toml`, the four strut files and one log for each drive into a folder, and returns what they conceal.
pub fn write(case: &Case, folder: &Path) -> Vec<TrueAtCorner> {
    let mut draw = Draw::named(&format!("vehicle {}", case.seed));
    let load_n = VehicleParameters::defender110().static_strut_load_n();
    // The struts are of one design.
    let design = nominal("strut", &mut draw);
    let mut index = format!(
        "[specimen]\nname = \"vehicle-{}\"\nkind = \"vehicle\"\n[strut]\n",
        case.seed
    );
    let mut all = Vec::new();
    let truth = Corner::ALL.map(|corner| {
        let mut given = design.clone();
        given.specimen.name = format!("{} strut", corner.name());
        let own: Vec<&Concealed> = case.concealed.iter().filter(|c| c.corners.contains(&corner)).collect();
        let effect = |c: &Concealed| of(c.id).in_strut().expect("an effect of struts");
        let mut complete = given.clone();
        own.iter().for_each(|c| effect(c).conceal(&mut given));
        // What the workshop charges is what the vehicle weighs; the file says it within tolerance.
        let static_pa = load_n[corner] / given.piston_area_m2();
        let tolerance = given.tolerance["static_pressure"];
        given.cylinder.static_pressure_pa = static_pa / (1.0 + tolerance * draw.between(-1.0, 1.0));
        complete.cylinder.static_pressure_pa = static_pa;
        let mut model = within_tolerance(&complete, &mut draw);
        for concealed in own {
            let id = concealed.id;
            let numbers = concealed.put(&mut model).into_iter();
            all.extend(numbers.map(|number| TrueAtCorner { corner, id, number }));
        }
        if let Some(oil) = model.effects.oil_compressibility.as_mut().filter(|_| case.keeps_oil) {
            oil.counted_at = OilCount::Static;
        }
        let _ = writeln!(index, "{} = \"{}.toml\"", corner.key(), corner.name());
        let beginning = if case.begins_s > 0.0 {
            "starts_at_rest = false\n"
        } else {
            ""
        };
        let text = format!("{beginning}{}", given.to_toml());
        std::fs::write(folder.join(format!("{}.toml", corner.name())), text).expect("a strut file");
        model
    });
    std::fs::write(folder.join("model.toml"), index).expect("model.toml");
    let truth = Corners::from_array(truth);
    for (k, (name, scenario)) in case.drives.iter().enumerate() {
        let mut lines = drive(case, scenario, &truth, &mut draw, k);
        let begins_us = lines.first().map_or(0, |line| line.0) + (1e6 * case.begins_s) as u64;
        lines.retain(|line| line.0 >= begins_us);
        std::fs::write(folder.join(format!("{name}.log")), damaged(lines, &mut draw)).expect("a log");
    }
    all
}

/// A frame with the time of its line.
type Line = (u64, Frame);

/// Drives, and returns what is logged before anything happens to it.
fn drive(case: &Case, scenario: &Scenario, truth: &Corners<StrutModel>, draw: &mut Draw, number: usize) -> Vec<Line> {
    let mut physical = truth.clone();
    // What the bus's readings suffer is not the strut's.
    physical
        .values_mut()
        .for_each(|model| model.effects.retain_sensor_faults(|_| false));
    let vehicle = run::vehicle_on(scenario, physical).expect("a vehicle");
    let outcome = run::both(scenario, vehicle, 1, &mut |_| true).expect("a run");
    let samples = &outcome.plant.recording.samples;
    let time_s: Vec<f64> = (0..samples.len()).map(|k| k as f64 * TICK_S).collect();
    // What drifts with time does so from the beginning of the log.
    let begins = ((case.begins_s / TICK_S) as usize).min(samples.len());
    let mut read = |corner: Corner, column: usize| -> Vec<f64> {
        let model = &truth[corner];
        let mut series: Vec<f64> = (samples.iter())
            .map(|s| match column.checked_sub(2) {
                None => s.displacement_m[corner],
                Some(point) => s.strut[corner].pressure_pa[point],
            })
            .collect();
        record_column(
            &model.effects,
            COLUMNS[column],
            &time_s[begins..],
            &mut series[begins..],
        );
        let noise = if case.without_noise {
            0.0
        } else {
            model.noise[COLUMNS[column]]
        };
        series.iter_mut().for_each(|v| *v += noise * draw.normal());
        series
    };
    let displacement = Corners::from_fn(|corner| read(corner, 0));
    let pressure = Corners::from_fn(|corner| [2, 3, 4, 5].map(|column| read(corner, column)));
    let (mut plant, mut controller) = (PlantEnd::new(), Protector::new(&COMMAND));
    // Both the counter and either width of the tick wrap within each drive.
    let first_tick = 65_536 - 900 - 77 * number;
    let begins_us = 1_795_000_000_000_000 + 40_000_000_000 * number as u64;
    let mut lines = Vec::new();
    for (k, sample) in samples.iter().enumerate() {
        let (tick, start_us) = (first_tick + k, begins_us + k as u64 * u64::from(TICK_US));
        let at = |corner: Corner, point: PressurePoint| Gauge(pressure[corner][point.index()][k] as f32);
        let inputs = Inputs::from_values(
            Corners::from_fn(|corner| displacement[corner][k] as f32),
            Corners::from_fn(|corner| StrutPressures::from_fn(|point| at(corner, point))),
        );
        for (n, frame) in plant.encode(tick as u16, &inputs).into_iter().enumerate() {
            lines.push((start_us + 260 * (n as u64 + 1), frame.into()));
        }
        let mut data = command(sample.command, tick - usize::from(case.command_acts_late));
        controller.protect(&mut data);
        lines.push((start_us + 2300, Frame::whole(standard(COMMAND.id), data)));
        if k % 4 == 0 {
            let stranger = Frame::new(standard(0x3F0 + (k % 7) as u16), &[k as u8, 1, 2]).expect("short");
            lines.push((start_us + 3100, stranger));
        }
    }
    if case.first_edition {
        let mut protectors = MESSAGES.map(|contract| Protector::new(&contract));
        for (time_us, frame) in &mut lines {
            let tick = first_tick + ((*time_us - begins_us) / u64::from(TICK_US)) as usize;
            *frame = in_first_edition(frame, tick, &mut protectors);
        }
    }
    lines
}

fn command(command: ValveCommand, tick: usize) -> [u8; FRAME_BYTES] {
    CommandMessage {
        command,
        echo_tick: tick as u8,
        ..CommandMessage::default()
    }
    .encode()
}

/// The frame in the first edition of the database, which had the upper byte of the tick behind the lower one.
fn in_first_edition(frame: &Frame, tick: usize, protectors: &mut [Protector; MESSAGES.len()]) -> Frame {
    let known = MESSAGES.iter().position(|m| Some(m.id) == frame.standard_id());
    let (Some(message), Ok(data)) = (known, <[u8; FRAME_BYTES]>::try_from(frame.data())) else {
        return *frame;
    };
    let (bits, upper) = (u64::from_le_bytes(data), (tick as u64 >> 8) & 0xFF);
    let mut data = match message {
        4 | 5 => (bits & !(0xFF << 20) | upper << 20).to_le_bytes(),
        6 => (bits & !(0xFF << 44) | upper << 44).to_le_bytes(),
        _ => data,
    };
    protectors[message].protect(&mut data);
    Frame::whole(standard(MESSAGES[message].id), data)
}

/// The log of a drive: frames lost, repeated, late and corrupted, one short silence, and a last line cut off.
fn damaged(lines: Vec<Line>, draw: &mut Draw) -> Vec<u8> {
    let silence = (0.7 * lines.len() as f64) as usize;
    let mut kept: Vec<Line> = Vec::with_capacity(lines.len());
    for (k, (time_us, frame)) in lines.into_iter().enumerate() {
        // Twelve ticks of seven frames.
        if draw.uniform() < 0.004 || (silence..silence + 84).contains(&k) {
            continue;
        }
        let frame = if draw.uniform() < 0.002 {
            frame.with_flipped_bit(29)
        } else {
            frame
        };
        let late_us = if draw.uniform() < 0.002 { 7_000 } else { 0 };
        kept.push((time_us + late_us, frame));
        if draw.uniform() < 0.002 {
            kept.push((time_us + late_us + 120, frame));
        }
    }
    kept.sort_by_key(|line| line.0);
    let mut log = Vec::new();
    for (time_us, frame) in &kept {
        write_line(&mut log, *time_us, "can1", frame).expect("memory takes it");
    }
    log.truncate(log.len() - 11);
    log
}
