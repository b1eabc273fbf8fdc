//! An animated SVG of the wheel seen from above over one period of a shimmy, rolling and sliding in turn.
//!
//! The picture is that of somebody who travels with the towing frame: the towing point stands still, the ground turns past
//! it about the centre of the curve. Marks on the ground are spaced so that the picture repeats itself with the motion.

use crate::error::Error;
use arclength_analysis::Control;
use kingpin::shimmy::PeriodicSliding;
use kingpin::sliding::Contact;
use kingpin::{Key, Wheel};
use std::fmt::Write;

/// How much slower than the motion the picture is.
const SLOWER: f64 = 25.0;
/// Pictures of a period; between them everything moves linearly.
const FRAMES: usize = 300;
/// Size of the picture in pixels, and what is left free around the motion; more below, for the text.
const SIZE: (f64, f64) = (640.0, 460.0);
const MARGIN: f64 = 70.0;
/// Distance between marks on the ground and between their lines, about, in pixels.
const MARKS: f64 = 110.0;
const LANES: f64 = 75.0;
/// Lines of marks on either side of the path of the towing point.
const LANES_BESIDE: i32 = 7;
/// Length of the force arrow in pixels where all the static friction is used.
const FORCE: f64 = 62.5;
/// Width of the wheel, part of its diameter.
const WIDTH: f64 = 0.28;

/// The animation of one period.
///
/// # Errors
/// When the motion cannot be simulated again.
pub(super) fn animation(motion: &PeriodicSliding) -> Result<String, Error> {
    let history = motion.history(1.0, FRAMES + 1, &Control::none())?;
    let wheel = &motion.wheel;
    let (length, radius) = (wheel.get(Key::L), wheel.get(Key::WheelRadius));
    let duration = format!("{:.3}", SLOWER * motion.period);
    let slides = |time: f64| {
        motion
            .phases
            .iter()
            .any(|phase| phase.contact == Contact::Sliding && (phase.start..phase.end).contains(&time))
    };
    let list = |value: &dyn Fn(usize) -> String| (0..=FRAMES).map(value).collect::<Vec<_>>().join(";");
    // All that king pin and wheel reach, and the towing point; the picture has y downwards.
    let places = || {
        let reached = history.states.iter().flat_map(|state| {
            let (x, y, psi) = (state[0], -state[1], state[2]);
            [(x, y), (x - length * psi.cos(), y - length * psi.sin())]
        });
        reached.chain([(0.0, 0.0)])
    };
    let smallest = places().fold((0.0_f64, 0.0_f64), |a, b| (a.0.min(b.0), a.1.min(b.1)));
    let largest = places().fold((0.0_f64, 0.0_f64), |a, b| (a.0.max(b.0), a.1.max(b.1)));
    let (width, height) = SIZE;
    let room = (width - 2.0 * MARGIN, height - 2.5 * MARGIN);
    let scale = (room.0 / (largest.0 - smallest.0)).min(room.1 / (largest.1 - smallest.1));
    let middle = (0.5 * (smallest.0 + largest.0), 0.5 * (smallest.1 + largest.1));
    let origin = (0.5 * width - scale * middle.0, 0.5 * (height - 0.5 * MARGIN) - scale * middle.1);
    let pin = |index: usize| {
        let state = &history.states[index];
        (scale * state[0], -scale * state[1])
    };
    // From king pin to wheel the caster points along -e1 = (-cos psi, sin psi); the picture has y downwards.
    let contact_point = |index: usize| {
        let ((x, y), psi) = (pin(index), history.states[index][2]);
        (x - scale * length * psi.cos(), y - scale * length * psi.sin())
    };
    // The attributes have the values at the start, so that a viewer that does not animate shows one picture of the motion.
    let place = |index: usize| pair(pin(index));
    let turned = |index: usize| format!("{:.2}", history.states[index][2].to_degrees());
    let path: Vec<String> = (0..=FRAMES).map(|index| pair(contact_point(index))).collect();
    let color = |index: usize| if slides(history.times[index]) { "#d55e00" } else { "#0072b2" }.to_owned();
    let shown = |index: usize, sliding: bool| u8::from(slides(history.times[index]) == sliding).to_string();
    let of_force = FORCE / (wheel.get(Key::MuS) * wheel.normal_force());
    let arrow = |index: usize| {
        let [along, across] = history.friction[index];
        // Across is along e2 = (sin psi, cos psi), upwards in the frame of the wheel.
        format!("M0 0 L{:.1} {:.1}", of_force * along, -of_force * across)
    };

    let mut svg = String::new();
    let mut line = |text: String| {
        // Writing to a string does not fail.
        let _ = writeln!(svg, "{text}");
    };
    line(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"17\">"
    ));
    line("<title>A towed wheel seen from above, rolling and sliding in turn</title>".into());
    line(format!("<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>"));
    line(format!("<g transform=\"translate({} {})\">", origin.0, origin.1));
    for mark in ground(motion, &duration, scale) {
        line(mark);
    }
    line(format!(
        "<polyline stroke-linejoin=\"round\" points=\"{}\" fill=\"none\" stroke=\"#888\" stroke-width=\"1\" stroke-dasharray=\"2 3\"/>",
        path.join(" ")
    ));
    let animate = |attribute: &str, values: &str, discrete: bool| {
        let mode = if discrete { " calcMode=\"discrete\"" } else { "" };
        format!(
            "<animate attributeName=\"{attribute}\" dur=\"{duration}s\" repeatCount=\"indefinite\"{mode} values=\"{values}\"/>"
        )
    };
    let transform = |kind: &str, values: &str| {
        format!(
            "<animateTransform attributeName=\"transform\" type=\"{kind}\" dur=\"{duration}s\" repeatCount=\"indefinite\" values=\"{values}\"/>"
        )
    };
    let (diameter, tread) = (2.0 * radius * scale, 2.0 * radius * scale * WIDTH);
    line(format!("<g transform=\"translate({})\">", place(0)));
    line(transform("translate", &list(&place)));
    line(format!("<g transform=\"rotate({})\">", turned(0)));
    line(transform("rotate", &list(&turned)));
    line(format!("<line x2=\"{:.1}\" stroke=\"#333\" stroke-width=\"7\"/>", -scale * length));
    line(format!("<g transform=\"translate({:.1} 0)\">", -scale * length));
    line(format!(
        "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{diameter:.1}\" height=\"{tread:.1}\" rx=\"10\" fill=\"{}\" fill-opacity=\"0.85\">",
        -0.5 * diameter,
        -0.5 * tread,
        color(0)
    ));
    line(animate("fill", &list(&color), true));
    line("</rect>".into());
    line(format!("<path d=\"{}\" fill=\"none\" stroke=\"#000\" stroke-width=\"3\">", arrow(0)));
    line(animate("d", &list(&arrow), false));
    line("</path>".into());
    line("<circle r=\"4\"/></g></g>".into());
    line("<circle r=\"7\" fill=\"#fff\" stroke=\"#333\" stroke-width=\"3\"/>".into());
    line("</g>".into());
    line("<path d=\"M-8 0 H8 M0 -8 V8\" stroke=\"#009e73\" stroke-width=\"3\"/>".into());
    line("</g>".into());
    for (word, color, sliding) in [("rolling", "#0072b2", false), ("sliding", "#d55e00", true)] {
        line(format!(
            "<text x=\"16\" y=\"30\" font-size=\"24\" font-weight=\"bold\" fill=\"{color}\" opacity=\"{}\">{word}",
            shown(0, sliding)
        ));
        line(animate("opacity", &list(&|index| shown(index, sliding)), true));
        line("</text>".into());
    }
    line(format!(
        "<text x=\"16\" y=\"{}\">v = {} m/s, {}, load {} N, {SLOWER} times slower; cross: towing point</text>",
        height - 14.0,
        wheel.get(Key::V),
        path_of(wheel),
        -wheel.get(Key::FAz)
    ));
    line("</svg>".into());
    Ok(svg)
}

/// The path of the towing point in words.
fn path_of(wheel: &Wheel) -> String {
    let radius = wheel.get(Key::TurningRadius);
    if radius.is_infinite() { "straight".to_owned() } else { format!("r = {radius} m") }
}

/// The marks on the ground, which turn about the centre of the curve, or pass on a straight path.
fn ground(motion: &PeriodicSliding, duration: &str, scale: f64) -> Vec<String> {
    let radius = motion.wheel.get(Key::TurningRadius);
    if radius.is_infinite() {
        return straight_ground(motion.wheel.get(Key::V) * motion.period * scale, duration);
    }
    let turned = motion.wheel.towing_yaw_rate() * motion.period;
    let marks = (turned * radius * scale / MARKS).round().max(1.0);
    let spacing = turned / marks;
    // All that is seen from the towing point, and what comes in during a period.
    let seen = (1.2 * SIZE.0 / scale / radius / spacing).ceil() as i64;
    let center = -scale * radius;
    let mut lines = vec![format!(
        "<g stroke=\"#ccc\" stroke-width=\"2\" fill=\"none\"><animateTransform attributeName=\"transform\" type=\"rotate\" \
         dur=\"{duration}s\" repeatCount=\"indefinite\" values=\"0 0 {center:.1};{:.3} 0 {center:.1}\"/>",
        turned.to_degrees()
    )];
    for index in -seen..=seen + marks as i64 {
        for lane in -LANES_BESIDE..=LANES_BESIDE {
            let (distance, half) = (scale * radius + LANES * f64::from(lane), 0.2 * spacing);
            let end = |angle: f64| (distance * angle.sin(), center + distance * angle.cos());
            let middle = index as f64 * spacing;
            lines.push(format!("<path d=\"M{} L{}\"/>", pair(end(middle - half)), pair(end(middle + half))));
        }
    }
    lines.push("</g>".into());
    lines
}

/// The marks that pass a way in pixels during a period.
fn straight_ground(way: f64, duration: &str) -> Vec<String> {
    let marks = (way / MARKS).round().max(1.0);
    let spacing = way / marks;
    let seen = (1.2 * SIZE.0 / spacing).ceil() as i64;
    let mut lines = vec![format!(
        "<g stroke=\"#ccc\" stroke-width=\"2\" fill=\"none\"><animateTransform attributeName=\"transform\" type=\"translate\" \
         dur=\"{duration}s\" repeatCount=\"indefinite\" values=\"0 0;{:.1} 0\"/>",
        -way
    )];
    for index in -seen..=seen + marks as i64 {
        for lane in -LANES_BESIDE..=LANES_BESIDE {
            let (middle, height) = (index as f64 * spacing, LANES * f64::from(lane));
            let end = |part: f64| pair((middle + part * spacing, height));
            lines.push(format!("<path d=\"M{} L{}\"/>", end(-0.2), end(0.2)));
        }
    }
    lines.push("</g>".into());
    lines
}

fn pair((x, y): (f64, f64)) -> String {
    format!("{x:.1} {y:.1}")
}
