//! Runs with a manoeuvre: the same on any number of threads, and without switched valves the same as a drive without a bus.

use oleo_controller::Strategy;
use oleo_interface::Corners;
use oleo_plant_sim::course::{Drive, DriverStyle, Ending, ManoeuvreKind, Run};
use oleo_plant_sim::road;
use oleo_plant_sim::vehicle::Load;

use super::tests::{hash, run};
use super::*;
use crate::scenario;
use oleo_plant_sim::vehicle::StrutElement;

/// A lane change after 3 s, with a fault if there is one in the scenario.
fn lane_change(name: &str) -> Scenario {
    let mut scenario = scenario::named(name).unwrap();
    scenario.ticks = 2400;
    if let Some(settings) = &mut scenario.course {
        settings.entry_m = Some(60.0);
    }
    scenario
}

#[test]
fn one_thread_and_two_command_the_same_in_a_lane_change() {
    let scenario = lane_change("bus-silence-in-lane-change");
    let (one, two) = (run(&scenario, 1), run(&scenario, 2));
    assert_eq!(one.plant.recording.samples.len(), 2400);
    assert_eq!(hash(&one), hash(&two));
    let path = |outcome: &Outcome| -> Vec<_> {
        let samples = outcome.plant.recording.samples.iter();
        samples
            .map(|sample| sample.motion.course.unwrap().body.position_m)
            .collect()
    };
    assert_eq!(path(&one), path(&two));
    assert!(one.plant.injected.dropped > 500);
}

/// The same drive without controller and bus: all valves closed from the start.
fn directly(scenario: &Scenario) -> Run {
    let parameters = Parameters::read(scenario).unwrap();
    let loaded = scenario.load.at_ride_height(&parameters.vehicle);
    let settings = scenario.course.as_ref().unwrap();
    let manoeuvre = settings
        .manoeuvre(scenario.speed_m_s, Some(scenario.duration_s()))
        .unwrap();
    let length_m = settings.road_length_m(&manoeuvre, &loaded);
    let surface = road::from_name_or_path(&scenario.road, length_m, scenario.seed).unwrap();
    let struts = Parameters::at_rest(&parameters.charged(loaded.static_strut_load_n())).unwrap();
    let course = settings.course(manoeuvre, surface);
    Drive::begin(&course, &loaded, &parameters.handling, struts.map(StrutElement::new))
        .unwrap()
        .to_end(|_| (Corners::default(), Corners::default()), |_| {})
        .unwrap()
}

#[test]
fn with_valves_never_switched_it_drives_as_without_a_bus() {
    for (name, load, driver) in [
        ("lane-change-on-belgian", Load::AsSold, DriverStyle::Hard),
        ("lane-change-laden", Load::Laden, DriverStyle::Eased),
    ] {
        let mut scenario = lane_change(name);
        scenario.strategy = Strategy::AlwaysStiff;
        scenario.load = load;
        scenario.course.as_mut().unwrap().driver = Some(driver);
        let outcome = run(&scenario, 1);
        let direct = directly(&scenario);
        assert_eq!(outcome.plant.ending, Some(direct.ending));
        for (sample, direct) in outcome.plant.recording.samples.iter().zip(&direct.history) {
            let course = sample.motion.course.unwrap();
            let there = [direct.station_m, direct.lateral_m, direct.heave_m];
            assert_eq!(course.body.position_m, there, "{name} at {} s", direct.time_s);
            assert_eq!(sample.motion.body.roll_rad, direct.roll_rad);
            assert_eq!(sample.displacement_m, direct.strut_displacement_m);
        }
        assert!(direct.max_lateral_m_s2 > 2.0, "it changes lanes");
    }
}

/// A vehicle that rolls over ends the run, with the ticks that are missing.
#[test]
fn a_run_ends_with_its_course() {
    let mut scenario = lane_change("lane-change-on-belgian");
    scenario.road = "flat".into();
    scenario.strategy = Strategy::AlwaysSoft;
    scenario.speed_m_s = 100.0 / 3.6;
    scenario.load = Load::LadenRoof;
    let settings = scenario.course.as_mut().unwrap();
    (settings.kind, settings.driver) = (ManoeuvreKind::LaneChange2, Some(DriverStyle::Hard));
    let outcome = run(&scenario, 1);
    let ended = outcome.plant.ending.unwrap();
    assert!(matches!(ended, Ending::RolledOver(_) | Ending::Spun(_)), "{ended:?}");
    let metrics = crate::metrics::Metrics::of(&scenario, &outcome);
    assert!(metrics.ticks_missing > 100, "{}", metrics.ticks_missing);
    assert!(!outcome.interrupted);

    // A vehicle that has braked to a stop has completed its course, and nothing is missing.
    let mut scenario = scenario::named("step-steer").unwrap();
    let settings = scenario.course.as_mut().unwrap();
    *settings = oleo_plant_sim::course::CourseSettings::new(ManoeuvreKind::Braking);
    let outcome = run(&scenario, 1);
    assert_eq!(outcome.plant.ending, Some(Ending::Completed));
    assert!(outcome.plant.recording.samples.len() < 2000);
    assert_eq!(crate::metrics::Metrics::of(&scenario, &outcome).ticks_missing, 0);
}

/// A load is not told to the controller; another vehicle file is.
#[test]
fn the_controller_is_configured_from_the_vehicle_without_its_load() {
    let mut scenario = scenario::named("lane-change-laden").unwrap();
    let laden = configuration(&scenario).unwrap();
    scenario.load = Load::AsSold;
    assert_eq!(laden, configuration(&scenario).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("van.toml");
    let text = include_str!("../../../plant-sim/presets/defender110.toml");
    let wider = text.replace("strut_spacing_m = 1.0", "strut_spacing_m = 1.2");
    assert_ne!(text, wider);
    std::fs::write(&path, wider).unwrap();
    scenario.vehicle = path.to_str().unwrap().into();
    let described = Parameters::read(&scenario).unwrap().description();
    assert_eq!(described.strut_spacing_m.front, 1.2);
    assert_ne!(laden, configuration(&scenario).unwrap());
}
