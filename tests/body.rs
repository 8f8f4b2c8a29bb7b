//! The body in the balance: drives of `oleo hil` with an inertial unit and something concealed, read from their logs, and what is named.
//!
//! `cargo test --test body -- --nocapture` prints the table.

#[path = "support/felt.rs"]
mod felt;
mod support;

use std::fs;
use std::path::Path;

use felt::is_felt;
use oleo_diagnose::body::{Believed, BodyDrive, BodyEffect, BodyEffectId, BodyFindings, find};
use oleo_hil::bus::Direction;
use oleo_hil::drive_log::{self, LoggedSample};
use oleo_hil::logs::candump::write_line;
use oleo_hil::run;
use oleo_hil::scenario::Scenario;
use oleo_hil::scenario::file::parse;
use oleo_interface::tick::TICK_S;
use oleo_interface::{Axle, Corner, Corners};
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::{Payload, VehicleParameters};
use support::{complaint, is_as_documented, run as oleo};

/// Place of the unit, m.
const UNIT_M: [f64; 3] = [0.3, -0.2, 0.1];

/// A campaign: what its scenario says besides, friction that a corner has in excess, and what must be named with what sizes.
struct Campaign {
    name: &'static str,
    /// Keys of the scenario.
    keys: &'static str,
    /// Keys of the unit.
    unit: &'static str,
    /// Road and manoeuvre. With a manoeuvre the handling model drives, whose equations are not those of the balance.
    course: &'static str,
    friction: Option<(Corner, f64)>,
    truth: Vec<(BodyEffectId, Vec<(&'static str, f64)>)>,
}

impl Campaign {
    fn new(name: &'static str, keys: &'static str, unit: &'static str) -> Self {
        let (friction, truth, course) = (None, Vec::new(), "road = \"iso-e\"");
        Self {
            name,
            keys,
            unit,
            course,
            friction,
            truth,
        }
    }

    fn with(mut self, id: BodyEffectId, sizes: &[(&'static str, f64)]) -> Self {
        self.truth.push((id, sizes.to_vec()));
        self
    }

    fn rubbing(mut self, corner: Corner, more_n: f64) -> Self {
        self.friction = Some((corner, more_n));
        self.with(BodyEffectId::CornerFriction(corner), &[("more_friction_N", more_n)])
    }

    fn steered(self) -> Self {
        self.over("road = \"iso-d\"\nmanoeuvre = \"straight\"")
    }

    fn over(mut self, course: &'static str) -> Self {
        self.course = course;
        self
    }

    fn scenario(&self, seed: u64) -> Scenario {
        let course = self.course;
        let [x, y, z] = UNIT_M;
        let text = format!(
            "name = \"body\"\n{course}\nspeed_km_h = 40\nduration_s = 60\nseed = {seed}\n{}\n[imu]\nx_m = {x}\ny_m = {y}\nz_m = {z}\n{}\n",
            self.keys, self.unit
        );
        parse(&text, self.name, Path::new("")).unwrap_or_else(|error| panic!("{error}"))
    }

    /// What the log of its drive holds.
    fn drive(&self, seed: u64) -> BodyDrive {
        let scenario = self.scenario(seed);
        let believed = StrutModel::defender110(1.0);
        let struts = Corners::from_fn(|corner| {
            let mut strut = believed.clone();
            if let (Some((at, more_n)), Some(seal)) = (self.friction, &mut strut.effects.seal_friction)
                && at == corner
            {
                seal.coulomb_force_n += more_n;
                seal.breakaway_force_n += more_n;
            }
            strut
        });
        let vehicle = run::vehicle_on(&scenario, struts).unwrap();
        let outcome = run::both(&scenario, vehicle, 1, &mut |_| true).unwrap();
        let mut log = Vec::new();
        for (k, entry) in outcome.plant.trace.iter().enumerate() {
            // The order of the bus; where in the tick a frame is does not matter.
            let within_us = 200
                + (k as u64 % 10)
                + if entry.direction == Direction::Received {
                    2000
                } else {
                    0
                };
            write_line(&mut log, u64::from(entry.tick) * 5000 + within_us, "can0", &entry.frame).unwrap();
        }
        let mut read = drive_log::parse(&log).unwrap();
        columns(&read.drives.remove(0).samples)
    }
}

/// The columns of a log.
fn columns(samples: &[LoggedSample]) -> BodyDrive {
    let number = |reading: oleo_controller::Reading| reading.value().map_or(f64::NAN, f64::from);
    let of = |get: &dyn Fn(&LoggedSample) -> oleo_controller::Reading| -> Vec<f64> {
        samples.iter().map(|sample| number(get(sample))).collect()
    };
    BodyDrive {
        period_s: TICK_S,
        displacement_m: Corners::from_fn(|corner| of(&|sample| sample.displacement_m[corner])),
        p1_pa: Corners::from_fn(|corner| of(&|sample| sample.pressure_pa[corner].p1)),
        specific_force_m_s2: [0, 1, 2].map(|axis| of(&|sample| sample.inertial.specific_force_m_s2[axis])),
        rate_rad_s: [0, 1, 2].map(|axis| of(&|sample| sample.inertial.rate_rad_s[axis])),
    }
}

fn campaigns() -> Vec<Campaign> {
    use BodyEffectId::{AntiRollBar, Payload, UnitMounting};
    let payload = |mass_kg: f64, x_m: f64, z_m: f64| {
        [
            ("mass_kg", mass_kg),
            ("x_m", x_m),
            ("y_m", 0.0),
            ("height_at_most_m", z_m),
        ]
    };
    let broken = [("lost_share", 1.0)];
    vec![
        Campaign::new("nothing", "", ""),
        Campaign::new(
            "payload of 120 kg at the back",
            "[payload]\nmass_kg = 120\nx_m = -1.4\nz_m = 0.3",
            "",
        )
        .with(Payload, &payload(120.0, -1.4, 0.3)),
        Campaign::new(
            "payload of 150 kg on the roof",
            "[payload]\nmass_kg = 150\nx_m = -0.4\nz_m = 1.3",
            "",
        )
        .with(Payload, &payload(150.0, -0.4, 1.3)),
        Campaign::new("broken link", "broken_anti_roll_link = \"rear\"", "").with(AntiRollBar(Axle::Rear), &broken),
        Campaign::new("friction at a corner", "", "").rubbing(Corner::FrontRight, 180.0),
        Campaign::new("unit turned", "", "yaw_deg = 7")
            .with(UnitMounting, &[("yaw_deg", 7.0), ("pitch_deg", 0.0), ("roll_deg", 0.0)]),
        Campaign::new("unit askew", "", "roll_deg = -5\npitch_deg = 4\nyaw_deg = -3").with(
            UnitMounting,
            &[("yaw_deg", -3.0), ("pitch_deg", 4.0), ("roll_deg", -5.0)],
        ),
        Campaign::new(
            "payload and broken link",
            "broken_anti_roll_link = \"rear\"\n[payload]\nmass_kg = 200\nx_m = 0.9\nz_m = 0.1",
            "",
        )
        .with(Payload, &payload(200.0, 0.9, 0.1))
        .with(AntiRollBar(Axle::Rear), &broken),
        Campaign::new("nothing, class C", "", "").over("road = \"iso-c\""),
        Campaign::new("nothing, handling model", "", "").steered(),
        Campaign::new("nothing, lane change", "", "")
            .over("road = \"iso-d\"\nmanoeuvre = \"lane-change\"\nentry_m = 250"),
        Campaign::new(
            "payload, handling model",
            "[payload]\nmass_kg = 150\nx_m = -0.4\nz_m = 1.3",
            "",
        )
        .steered()
        .with(Payload, &payload(150.0, -0.4, 1.3)),
        Campaign::new("broken link, handling model", "broken_anti_roll_link = \"rear\"", "")
            .steered()
            .with(AntiRollBar(Axle::Rear), &broken),
        Campaign::new("friction and unit turned, handling model", "", "yaw_deg = -6")
            .steered()
            .rubbing(Corner::FrontLeft, 160.0)
            .with(
                UnitMounting,
                &[("yaw_deg", -6.0), ("pitch_deg", 0.0), ("roll_deg", 0.0)],
            ),
        Campaign::new(
            "all of them",
            "broken_anti_roll_link = \"rear\"\n[payload]\nmass_kg = 300\nx_m = -1.1\nz_m = 0.2",
            "yaw_deg = 12",
        )
        .with(Payload, &payload(300.0, -1.1, 0.2))
        .with(AntiRollBar(Axle::Rear), &broken)
        .rubbing(Corner::RearLeft, 150.0)
        .with(
            UnitMounting,
            &[("yaw_deg", 12.0), ("pitch_deg", 0.0), ("roll_deg", 0.0)],
        ),
    ]
}

fn found(drive: BodyDrive) -> Result<BodyFindings, String> {
    let vehicle = VehicleParameters::defender110();
    let believed = Believed::new(&vehicle, Corners::from_fn(|_| StrutModel::defender110(1.0)), UNIT_M);
    find(&believed, &[drive])
}

/// The true sizes within their intervals, and all of them; prints a line for each.
fn held(effect: &BodyEffect, truth: &[(&'static str, f64)]) -> (usize, usize) {
    let mut within = 0;
    for (name, size) in truth {
        let found = effect.parameters.iter().find(|parameter| parameter.name == *name);
        let found = found.unwrap_or_else(|| panic!("no {name}"));
        let holds = (found.low..=found.high).contains(size);
        within += usize::from(holds);
        let mark = if holds { "" } else { "  MISSED" };
        println!(
            "      {name:<16} true {size:8.3}  found {:8.3}  from {:8.3} to {:8.3}{mark}",
            found.value, found.low, found.high
        );
    }
    (within, truth.len())
}

#[test]
fn what_is_concealed_in_the_body_is_named_and_nothing_else() {
    let (mut within, mut all) = (0, 0);
    for campaign in campaigns() {
        for seed in [1, 2] {
            let findings = found(campaign.drive(seed)).unwrap();
            let names: Vec<String> = findings
                .effects
                .iter()
                .map(|e| format!("{} ({})", e.id.name(), e.id.place()))
                .collect();
            println!(
                "{}, seed {seed}, {:.0} s: {}",
                campaign.name,
                findings.used_s,
                names.join(", ")
            );
            let ids: Vec<BodyEffectId> = findings.effects.iter().map(|effect| effect.id).collect();
            let expected: Vec<BodyEffectId> = campaign.truth.iter().map(|(id, _)| *id).collect();
            assert_eq!(ids, expected, "{}, seed {seed}: {:#?}", campaign.name, findings.effects);
            for (effect, (_, sizes)) in findings.effects.iter().zip(&campaign.truth) {
                let (held, of) = held(effect, sizes);
                within += held;
                all += of;
            }
        }
    }
    println!("{within} of {all} intervals hold the truth");
    assert!(20 * within >= 18 * all, "{within} of {all}");
}

/// A drive that is too short, on a smooth road, or without a unit is one sentence.
#[test]
fn what_cannot_be_balanced_is_said() {
    let campaign = Campaign::new("nothing", "", "");
    let drive = campaign.drive(1);
    let mut silent = drive.clone();
    silent.rate_rad_s[0].fill(f64::NAN);
    let said = found(silent).unwrap_err();
    assert!(said.contains("0 s straight ahead") && !said.contains('\n'), "{said}");
}

/// A vehicle that `oleo hil` has driven, with its log and strut files in the folder `drives`.
struct Driven {
    folder: tempfile::TempDir,
}

impl Driven {
    /// Drives with something concealed by `keys` of a scenario. The struts are charged for what `carrying` weighs.
    fn with(keys: &str, carrying: &VehicleParameters) -> Self {
        let driven = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        let path = |name: &str| driven.path(name);
        let [x, y, z] = UNIT_M;
        let drive = format!(
            "name = \"concealed\"\nroad = \"iso-e\"\nspeed_km_h = 40\nduration_s = 36\n{keys}\n[imu]\nx_m = {x}\ny_m = {y}\nz_m = {z}\n"
        );
        fs::write(path("drive.toml"), drive).unwrap();
        let ran = oleo(&["hil", "--scenario", &path("drive.toml"), "--out", &path("run")]);
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
        fs::create_dir(path("drives")).unwrap();
        fs::copy(path("run/candump.log"), path("drives/drive.log")).unwrap();
        let load_n = carrying.static_strut_load_n();
        for (name, corner) in [("front.toml", Corner::FrontLeft), ("rear.toml", Corner::RearLeft)] {
            let strut = StrutModel::defender110(load_n[corner]);
            fs::write(path(&format!("drives/{name}")), strut.to_toml()).unwrap();
        }
        driven
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    /// Writes the model of the vehicle, whose body is said to be this.
    fn believes(&self, body: &str) {
        let text = format!(
            "[specimen]\nname = \"car\"\nkind = \"vehicle\"\n[strut]\nfront_left = \"front.toml\"\nfront_right = \"front.toml\"\n\
             rear_left = \"rear.toml\"\nrear_right = \"rear.toml\"\n[body]\n{body}"
        );
        fs::write(self.path("drives/model.toml"), text).unwrap();
    }

    /// What `oleo diagnose` prints, and its report, of a vehicle whose struts are as they are believed to be.
    fn diagnosed(&self, vehicle: &str) -> (String, serde_json::Value) {
        let [x, y, z] = UNIT_M;
        self.believes(&format!("vehicle = \"{vehicle}\"\nunit_m = [{x}, {y}, {z}]\n"));
        let ran = oleo(&["diagnose", &self.path("drives"), "--out", &self.path("found")]);
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
        is_as_documented(Path::new(&self.path("found")), "diagnose");
        let report = fs::read_to_string(self.path("found/report.json")).unwrap();
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["verdict"], "consistent", "{:#}", report["effects"]);
        (String::from_utf8_lossy(&ran.stdout).into_owned(), report)
    }
}

/// The whole way: `oleo hil` drives with a broken link, `oleo diagnose` reads its log beside a model with a table `[body]`.
#[test]
fn a_broken_link_is_named_by_oleo_diagnose() {
    let vehicle = VehicleParameters::defender110();
    let driven = Driven::with("broken_anti_roll_link = \"rear\"", &vehicle);
    let path = |name: &str| driven.path(name);
    driven.believes("vehicle = \"absent.toml\"\nunit_m = [0, 0, 0]\n");
    assert!(complaint(&oleo(&["diagnose", &path("drives"), "--no-out"])).contains("absent.toml"));
    driven.believes("vehicle = \"../car.toml\"\nunit_m = [0, 0, 0]\n");
    assert!(complaint(&oleo(&["diagnose", &path("drives"), "--no-out"])).contains("without a folder"));

    fs::write(path("drives/car.toml"), vehicle.to_toml()).unwrap();
    let (said, report) = driven.diagnosed("car.toml");
    assert!(
        said.contains("an anti-roll bar at the rear axle that has lost stiffness"),
        "{said}"
    );
    let effects = report["body"]["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 1, "{effects:?}");
    assert_eq!(
        (&effects[0]["id"], &effects[0]["place"]),
        (&"anti_roll_bar".into(), &"rear axle".into())
    );
    let lost = &effects[0]["parameters"]["lost_share"]["ci95"];
    assert!(
        lost[0].as_f64().unwrap() < 1.0 && lost[1].as_f64().unwrap() > 1.0,
        "{lost}"
    );
    let page = fs::read_to_string(path("found/report.html")).unwrap();
    assert!(page.contains("The body in the balance") && page.contains("What the driver feels of it"));
    // The improved model names what is believed of the body, as the given one did.
    assert_eq!(fs::read_to_string(path("found/car.toml")).unwrap(), vehicle.to_toml());
    assert!(fs::read_to_string(path("found/model.toml")).unwrap().contains("[body]"));
    // What the driver feels of it is what the loop with a broken link gives.
    is_felt(&report, "believed", 1e-3, |_| {});
    is_felt(&report, "found", 0.02, |scenario| {
        scenario.broken_anti_roll_link = Some(Axle::Rear);
    });
}

/// A payload on the roof is found nearly as it is, and felt nearly as it is felt.
#[test]
fn a_payload_that_oleo_diagnose_finds_is_felt() {
    let payload = Payload {
        mass_kg: 150.0,
        x_m: -0.4,
        z_m: 1.3,
    };
    let vehicle = VehicleParameters::defender110();
    let keys = "[payload]\nmass_kg = 150\nx_m = -0.4\nz_m = 1.3";
    let (_, report) = Driven::with(keys, &payload.on(&vehicle, &vehicle)).diagnosed("defender110");
    is_felt(&report, "found", 0.02, |scenario| {
        scenario.payload = Some(payload.clone())
    });
    let change = &report["driven"]["change"];
    let [more_roll, less_ride] = ["max_roll_deg", "weighted_rms_driver_m_s2"].map(|key| &change[key]["ci95"]);
    println!("a payload on the roof: {:#}", report["driven"]);
    assert!(
        more_roll[0].as_f64().unwrap() > 0.0 && less_ride[1].as_f64().unwrap() < 0.0,
        "{change}"
    );
}
