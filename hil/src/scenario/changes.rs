//! What a command line changed in a scenario, in words.

use oleo_plant_sim::course::CourseSettings;

use super::definition::Scenario;

/// What of the drive differs between a scenario and the one that is run instead: `road iso-c`, `30 km/h`. How it is run (bus,
/// clock, seed) is told elsewhere.
pub fn changes(before: &Scenario, after: &Scenario) -> Vec<String> {
    let mut changes = Vec::new();
    let mut say = |differs: bool, words: String| {
        if differs {
            changes.push(words);
        }
    };
    let file = |name: &str| {
        let path = std::path::Path::new(name);
        path.file_name()
            .map_or(name.to_owned(), |name| name.to_string_lossy().into_owned())
    };
    if let Some(new) = &after.course {
        let old = before.course.clone().filter(|old| old.kind == new.kind);
        say(old.is_none(), format!("manoeuvre {}", new.kind.key()));
        let old = old.unwrap_or_else(|| CourseSettings::new(new.kind));
        say(new.driver() != old.driver(), format!("driver {}", new.driver().key()));
        let settings = [
            ("entry", new.entry_m, old.entry_m, " m"),
            ("radius", new.radius_m, old.radius_m, " m"),
            ("steer", new.steer_deg, old.steer_deg, " degrees"),
            ("change of speed", new.change_m_s2, old.change_m_s2, " m/s2"),
            ("begin", new.begin_s, old.begin_s, " s"),
            ("side slope", new.side_slope_percent, old.side_slope_percent, " %"),
        ];
        for (name, new, old, unit) in settings {
            if let Some(value) = new.filter(|_| new != old) {
                say(true, format!("{name} {value}{unit}"));
            }
        }
    }
    say(after.road != before.road, format!("road {}", file(&after.road)));
    let speed_km_h = (after.speed_m_s * 3.6 * 1e6).round() / 1e6;
    say(after.speed_m_s != before.speed_m_s, format!("{speed_km_h} km/h"));
    say(after.ticks != before.ticks, format!("{} s", after.duration_s()));
    say(
        after.strategy != before.strategy,
        format!("strategy {}", after.strategy.name()),
    );
    let policy = after.damper_policy.name();
    say(
        after.damper_policy != before.damper_policy,
        format!("damper policy {policy}"),
    );
    say(after.load != before.load, format!("load {}", after.load.key()));
    if let Some(imu) = &after.imu {
        let [x, y, z] = imu.place_m();
        say(after.imu != before.imu, format!("inertial unit at {x}, {y}, {z} m"));
    }
    for (name, new, old) in [
        ("strut", &after.strut, &before.strut),
        ("vehicle", &after.vehicle, &before.vehicle),
        ("handling", &after.handling, &before.handling),
    ] {
        say(new != old, format!("{name} {}", file(new)));
    }
    for (corner, new) in after.strut_at.iter() {
        if let Some(new) = new {
            let differs = before.strut_at[corner].as_ref() != Some(new);
            say(differs, format!("strut {} at {}", file(new), corner.name()));
        }
    }
    changes
}

#[cfg(test)]
mod tests {
    use oleo_plant_sim::course::ManoeuvreKind;

    use super::super::named;
    use super::*;

    #[test]
    fn every_change_of_the_drive_is_said() {
        let before = named("belgian").unwrap();
        assert!(changes(&before, &before).is_empty());
        let mut after = before.clone();
        after.road = "roads/mine.crg".into();
        after.speed_m_s = 30.0 / 3.6;
        after.course = Some(CourseSettings {
            side_slope_percent: Some(4.0),
            ..CourseSettings::new(ManoeuvreKind::LaneChange)
        });
        let words = ["manoeuvre lane-change", "side slope 4 %", "road mine.crg", "30 km/h"];
        assert_eq!(changes(&before, &after), words);
        after.changes = changes(&before, &after);
        assert!(
            after.title().starts_with("belgian with manoeuvre lane-change, "),
            "{}",
            after.title()
        );
    }
}
