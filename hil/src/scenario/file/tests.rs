//! Scenario files that are right, wrong in every way, and damaged.

use super::*;
use proptest::prelude::*;

const GOOD: &str = "name = \"x\"\nroad = \"flat\"\nspeed_km_h = 60\nduration_s = 2\n";

fn complaint(more: &str) -> String {
    let error = parse(&format!("{GOOD}{more}"), "x.toml", Path::new(""))
        .unwrap_err()
        .to_string();
    assert_eq!(error.lines().count(), 1, "{error}");
    error
}

#[test]
fn defaults() {
    let scenario = parse(GOOD, "x.toml", Path::new("dir")).unwrap();
    assert_eq!(
        (scenario.ticks, scenario.seed, scenario.road.as_str()),
        (400, 1, "flat")
    );
    let own = parse(&GOOD.replace("flat", "my.crg"), "x.toml", Path::new("dir")).unwrap();
    assert_eq!(own.road, "dir/my.crg");
}

#[test]
fn complaints_name_file_line_and_key() {
    let table = [
        ("sped = 3\n", "x.toml:5: sped is not a known key: did you mean "),
        ("seed = -1\n", "x.toml:5: seed is -1: must be a whole number, 0 or more"),
        (
            "strategy = \"soft\"\n",
            "x.toml:5: strategy is \"soft\": must be one of always-soft",
        ),
        ("bus = \"can0\"\n", "x.toml:5: bus \"can0\" is not a bus"),
        (
            "clock = \"slow\"\n",
            "x.toml:5: clock is \"slow\": must be one of lockstep, realtime",
        ),
        ("seed = \n", "x.toml:5: this is not TOML: "),
        (
            "[[fault]]\nkind = \"drop\"\nat_s = 3\n",
            "x.toml:7: [fault 1] at_s is 3: the run ends at 2 s",
        ),
        (
            "[[fault]]\nkind = \"drop\"\nat_s = 1\nprobability = 1.5\n",
            "x.toml:8: [fault 1] probability is 1.5: must be from 0 to 1",
        ),
        (
            "[[fault]]\nkind = \"drop\"\nat_s = nan\n",
            "x.toml:7: [fault 1] at_s is NaN: must be from 0 to 3600 s",
        ),
        (
            "[[fault]]\nkind = \"drop\"\nat_s = 1\nbits = 3\n",
            "x.toml:8: [fault 1] bits does not belong",
        ),
        (
            "[[fault]]\nkind = \"drop\"\nat_s = 1\n[[fault]]\nkind = \"drop\"\nat_s = -1\n",
            "x.toml:10: [fault 2] at_s is -1: must be from 0 to 3600 s",
        ),
        (
            "[[fault]]\nkind = \"flood\"\nat_s = 1\n",
            "x.toml:6: [fault 1] kind is \"flood\": must be one of silence, drop",
        ),
        (
            "[[fault]]\nkind = \"drop\"\nat_s = 1\nmessage = \"X\"\n",
            "x.toml:8: [fault 1] message is \"X\", which is not a message",
        ),
        (
            "[[fault]]\nkind = \"sensor-nan\"\nat_s = 1\n",
            "x.toml:6: [fault 1] kind is \"sensor-nan\", which needs sensor too",
        ),
        (
            "[[fault]]\nkind = \"sensor-nan\"\nat_s = 1\nsensor = \"p1\"\n",
            "x.toml:8: [fault 1] sensor is \"p1\": must be CORNER.SENSOR",
        ),
        (
            "[[fault]]\nkind = \"node-killed\"\nat_s = 1\nnode = \"me\"\n",
            "x.toml:8: [fault 1] node is \"me\": must be one of plant, controller",
        ),
        (
            "[[check]]\nmetric = \"max_rol_deg\"\nat_most = 1\n",
            "x.toml:6: [check 1] metric is \"max_rol_deg\", which is not a metric: did you mean max_roll_deg?",
        ),
        (
            "[[check]]\nmetric = \"max_roll_deg\"\n",
            "x.toml:6: [check 1] metric is \"max_roll_deg\": give exactly one of",
        ),
        (
            "[[check]]\nmetric = \"max_roll_deg\"\nequals = \"safe\"\n",
            "x.toml:7: [check 1] equals does not go with max_roll_deg, which is a number",
        ),
        (
            "[[check]]\nmetric = \"final_mode\"\nat_most = 1\n",
            "x.toml:7: [check 1] at_most does not go with final_mode, which is a word",
        ),
        (
            "[[check]]\nmetric = \"max_roll_deg\"\nequals = [1]\n",
            "x.toml:7: [check 1] equals is [1]: must be a number or a word",
        ),
        (
            "[[check]]\nmetric = \"max_roll_deg\"\nat_most = inf\n",
            "x.toml:7: [check 1] at_most is inf: must be a finite number",
        ),
        (
            "manoeuvre = \"lane_change\"\n",
            "x.toml:5: manoeuvre is \"lane_change\": did you mean lane-change? The choices are straight, ",
        ),
        (
            "manoeuvre = \"straight\"\ndriver = \"harsh\"\n",
            "x.toml:6: driver is \"harsh\": did you mean hard? The choices are eased, hard",
        ),
        (
            "load = \"heavy\"\n",
            "x.toml:5: load is \"heavy\": the choices are as-sold",
        ),
        (
            "broken_anti_roll_link = \"left\"\n",
            "x.toml:5: broken_anti_roll_link is \"left\": must be front or rear",
        ),
        (
            "[payload]\nmass_kg = -5\n",
            "x.toml:6: [payload] mass_kg is -5: must be from 0 to 2000 kg",
        ),
        (
            "[strut_at]\nrear = \"weak.toml\"\n",
            "x.toml:6: [strut_at] rear is not a known key: ",
        ),
        ("[imu]\nx_m = 9\n", "x.toml:6: [imu] x_m is 9: must be from -5 to 5 m"),
        ("[imu]\nplace = 9\n", "x.toml:6: [imu] place is not a known key: "),
        ("entry_m = 50\n", "x.toml:5: entry_m needs a manoeuvre"),
        ("driver = \"hard\"\n", "x.toml:5: driver needs a manoeuvre"),
        (
            "manoeuvre = \"step-steer\"\nentry_m = 50\n",
            "x.toml:6: entry_m does not belong to the manoeuvre step-steer",
        ),
        (
            "manoeuvre = \"step-steer\"\nbegin_s = 2\n",
            "x.toml:6: begin_s is 2: the drive ends before, at 2 s",
        ),
        (
            "manoeuvre = \"braking\"\nchange_m_s2 = 20\n",
            "x.toml:6: change_m_s2 is 20: must be from 0.1 to 12 m/s2",
        ),
        (
            "manoeuvre = \"straight\"\nside_slope_percent = -41\n",
            "x.toml:6: side_slope_percent is -41: must be from -40 to 40 %",
        ),
        (
            "score_from_s = -1\n",
            "x.toml:5: score_from_s is -1: must be from 0 to 3600 s",
        ),
        (
            "[[fault]]\nkind = \"sensor-swap\"\nat_s = 1\nsensor = \"front-left.p1\"\n",
            "x.toml:6: [fault 1] kind is \"sensor-swap\", which needs other too",
        ),
        (
            "[[fault]]\nkind = \"sensor-swap\"\nat_s = 1\nsensor = \"front-left.p1\"\nother = \"rear-left.displacement\"\n",
            "x.toml:9: [fault 1] other must be another sensor",
        ),
        (
            "[[fault]]\nkind = \"sensor-noise\"\nat_s = 1\nsensor = \"front-left.p1\"\nvalue = -1\n",
            "x.toml:9: [fault 1] value is -1: a standard deviation is 0 or more",
        ),
        (
            "[[fault]]\nkind = \"node-restarted\"\nat_s = 1\nnode = \"controller\"\n",
            "x.toml:6: [fault 1] kind is \"node-restarted\", which needs for_s too",
        ),
        (
            "[[fault]]\nkind = \"node-restarted\"\nat_s = 1\nfor_s = 0.2\n",
            "x.toml:6: [fault 1] kind is \"node-restarted\", which needs node too",
        ),
        (
            "[[fault]]\nkind = \"node-restarted\"\nat_s = 1\nfor_s = 0.2\nnode = \"plant\"\n",
            "x.toml:9: [fault 1] node is \"plant\", which begins another run when it restarts: must be \"controller\"",
        ),
        (
            "[[fault]]\nkind = \"masquerade\"\nat_s = 1\nprobability = 0.5\n",
            "x.toml:8: [fault 1] probability does not belong",
        ),
        (
            "[[check]]\nmetric = \"decision_s\"\nat_most = 1\n",
            "x.toml:6: [check 1] metric is \"decision_s\", which the ride model does not have",
        ),
    ];
    for (more, expected) in table {
        let error = complaint(more);
        assert!(error.starts_with(expected), "{error}\n  expected {expected}");
    }
    let missing = parse("name = \"x\"\n", "x.toml", Path::new(""))
        .unwrap_err()
        .to_string();
    assert_eq!(missing, "x.toml:1: road is missing: add it");
}

proptest! {
    #[test]
    fn no_text_does_harm(text in "\\PC{0,200}") {
        let _ = parse(&text, "x", Path::new(""));
    }

    #[test]
    fn no_damaged_scenario_does_harm(at in 0usize..400, byte in 0x20u8..0x7F) {
        let mut text = format!("{GOOD}[[fault]]\nkind = \"corrupt\"\nat_s = 1.0\nfor_s = 0.5\nbits = 2\n[[check]]\nmetric = \"final_mode\"\nequals = \"safe\"\n").into_bytes();
        let length = text.len();
        text[at % length] = byte;
        let _ = parse(std::str::from_utf8(&text).unwrap(), "x", Path::new(""));
    }
}
