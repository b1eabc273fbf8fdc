//! `docs/wheels.md`: its commands, typed for each of the five wheels, give the numbers beside them.

use crate::Folder;
use serde_json::Value;
use std::path::Path;

const WHEELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");

fn page() -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/wheels.md")).unwrap()
}

/// The command of a section, the file of the wheel filled in, and the rows of the section's table.
fn section(title: &str) -> (String, Vec<Vec<String>>) {
    let page = page();
    let text = page.split("\n## ").find(|section| section.starts_with(title)).expect(title).to_owned();
    let command = text.split("$ kingpin ").nth(1).or_else(|| text.split("\nkingpin ").nth(1)).unwrap();
    let command = command.lines().next().unwrap().to_owned();
    (command, rows(&text))
}

/// The rows of the tables of a text, without their headings.
fn rows(text: &str) -> Vec<Vec<String>> {
    let lines = text.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| wheel |"));
    lines
        .filter(|line| !line.contains("---"))
        .map(|line| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect())
        .collect()
}

fn typed(command: &str, wheel: &str) -> String {
    let file = format!("{WHEELS}/{}.toml", wheel.replace(' ', ""));
    command.replace("--wheel W", &format!("--wheel {file}"))
}

/// Whether a number rounds to what is printed.
fn agrees(printed: &str, value: &Value) -> bool {
    let number: f64 = printed.parse().unwrap();
    let decimals = printed.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let unit = 10_f64.powi(-i32::try_from(decimals).unwrap());
    value.as_f64().is_some_and(|value| (value - number).abs() <= 0.5 * unit * (1.0 + 1e-9))
}

#[test]
fn straight_towing() {
    let folder = Folder::new();
    let (command, rows) = section("Towed straight");
    let rows: Vec<_> = rows.into_iter().filter(|row| row.len() == 6).collect();
    assert_eq!(rows.len(), 5);
    for row in rows {
        let result = folder.json(&typed(&command, &row[0]));
        let fields = [(1, &result["parameters"]["v"]), (2, &result["growth_rate"])];
        let fields = fields.into_iter().chain([(4, &result["swing_factor"])]);
        for (column, value) in fields.chain([(5, &result["critical_speed_with_friction"])]) {
            assert!(agrees(&row[column], value), "{}: {} is {value}", row[0], row[column]);
        }
        assert!(result["critical_speed"].is_null() && row[3].starts_with("none"));
    }
}

/// The others take as long each as the suite has for all of them.
#[test]
fn the_smallest_blow_on_the_trolley() {
    let text = page();
    let command = text.lines().find(|line| line.starts_with("kingpin safe-kick")).unwrap();
    let row = rows(&text).into_iter().find(|row| row.len() == 3 && row[0] == "trolley").unwrap();
    let command = command.strip_prefix("kingpin ").unwrap().replace("M_f=M", &format!("M_f={}", row[1]));
    let result = Folder::new().json(&typed(&command, "trolley"));
    let fails = ["positive", "negative"].map(|side| result[side]["fails"].as_f64().unwrap().abs());
    let smallest = Value::from(fails[0].min(fails[1]));
    assert!(agrees(&row[2], &smallest), "{} is {smallest}", row[2]);
}

#[test]
fn dampers() {
    let folder = Folder::new();
    let (command, rows) = section("What damper it takes");
    assert_eq!(rows.len(), 5);
    for row in rows {
        let result = folder.json(&format!("{} -q", typed(&command, &row[0])));
        let large = &result["isola_free"];
        let fields = [&result["c_q"], &large["c_q"]["damping"], &result["c_psi"], &large["c_psi"]["damping"]];
        for (column, value) in (1..).zip(fields) {
            assert!(agrees(&row[column], value), "{}: {} is {value}", row[0], row[column]);
        }
    }
}

/// Largest caster angle in the last second of the simulation that the page tells, at a speed.
fn swing_at_the_end(folder: &Folder, wheel: &str, speed: &str) -> f64 {
    let text = page();
    let command = text.lines().find(|line| line.starts_with("kingpin simulate")).unwrap();
    let command = command.strip_prefix("kingpin ").unwrap().replace("v=V", &format!("v={speed}"));
    let result = folder.json(&format!("{} -q --points 3001", typed(&command, wheel)));
    let angles = result["psi"].as_array().unwrap();
    angles[2900..].iter().map(|angle| angle.as_f64().unwrap().abs()).fold(0.0, f64::max)
}

/// Slower than what was found from kicks at five speeds.
#[test]
fn the_slowest_shimmy_that_is_told() {
    let folder = Folder::new();
    for (wheel, speed, swing) in [("dolly", "1.2", 0.244), ("nose gear", "4.6", 0.240)] {
        let found = swing_at_the_end(&folder, wheel, speed);
        assert!((found - swing).abs() < 2e-3, "{wheel}: {found}");
    }
    assert!(swing_at_the_end(&folder, "nose gear", "4.4") < 1e-3);
}

/// Each at both ends of a short range about the speed that is told.
#[test]
fn the_shimmy_that_is_left() {
    let folder = Folder::new();
    let told = [
        ("office", "0.5", 0.364),
        ("office", "1", 0.381),
        ("trolley", "0.5", 0.165),
        ("trolley", "5", 0.187),
        ("wheelchair", "0.5", 0.106),
        ("wheelchair", "5", 0.121),
    ];
    for (wheel, speed, swing) in told {
        let value: f64 = speed.parse().unwrap();
        let command = format!("shimmy --wheel W --along v={speed}:{} --at {speed}", 1.02 * value);
        let result = folder.json(&format!("{} -q", typed(&command, wheel)));
        let points = result["points"].as_array().unwrap();
        let here = points.iter().find(|point| point["value"] == value && point["stable"] == true);
        let found = here.expect(wheel)["psi_max"].as_f64().unwrap();
        assert!((found - swing).abs() < 5e-4, "{wheel} at {speed} m/s: {found}");
    }
    let page = page();
    for (_, _, swing) in told {
        assert!(page.contains(&format!("{swing}")), "{swing}");
    }
}
