//! Motions that a strong damper makes stiff, beside an integration of the equations of rolling by SciPy's Radau IIA (relative tolerance
//! 1e-11). An explicit method takes a million steps for the first hundredth of a second of some of them.

use arclength::control::Control;
use kingpin::{Key, Wheel};

/// The paper's wheel on its circle with a damper, released 0.1 rad from its uniform motion, and its states after five seconds.
const MOTIONS: [(Key, f64, [f64; 5]); 2] = [
    (
        Key::CPsi,
        1e5,
        [
            -0.3366561631452736,
            -1.8289869436283053,
            0.17898972095392526,
            11.247582175203814,
            4.000146732597508,
        ],
    ),
    (
        Key::CQ,
        1e6,
        [0.0004722553332865, -0.0091681132824933, 0.0788891307899136, 4.0314996482977, 4.0074729281351],
    ),
];

#[test]
fn motions_under_strong_dampers_are_those_of_an_implicit_method() {
    for (key, value, end) in MOTIONS {
        let wheel = Wheel::default().with(key, value).unwrap();
        let history = wheel.simulate(5.0, &[("psi", 0.1)], 2, &Control::none()).unwrap();
        let last = history.states.last().unwrap();
        for (found, expected) in last.iter().zip(end) {
            assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{key}: {last:?}");
        }
    }
}

/// A caster that slides turns by what the moment on it and the damper allow: as good as not at all.
#[test]
fn a_wheel_that_slides_is_followed_under_a_strong_damper() {
    let wheel = Wheel::default().with(Key::CPsi, 1e5).unwrap().with(Key::FAz, -5.0).unwrap();
    let start = wheel.perturbed_uniform_motion(&[("psi", 0.1)]).unwrap();
    let history = wheel.sliding().unwrap().simulate(&start, 5.0, 2, &Control::none()).unwrap();
    let [first, last] = [0, 1].map(|index| history.states[index][2]);
    assert!((first - last).abs() < 1e-3 && last != first, "{first} {last}");
}

/// Straight, held in a rigid king pin by a damper that lets it come back slowly, a caster has the slip angle psi, and the side force
/// `C_alpha psi` turns it about its length and the trail of the tyre, a third of `a`: `c_psi psi' = -C_alpha (l + t_p) psi`.
#[test]
fn a_wheel_with_a_tyre_comes_back_at_the_rate_of_its_damper() {
    let (damping, duration, angle) = (1e5, 50.0, 0.01);
    let text =
        "tyre = \"linear\"\nsigma = 0.03\na = 0.01\nC_alpha = 400\nk = inf\nr = inf\nF_Az = -20\nc_psi = 1e5";
    let wheel = Wheel::from_toml(text).unwrap();
    let history = wheel.simulate_with_tyre(duration, &[("psi", angle)], 2, &Control::none()).unwrap();
    let rate = (angle / history.states[1][2]).ln() / duration;
    let expected = 400.0 * (wheel.get(Key::L) + 0.01 / 3.0) / damping;
    assert!((rate / expected - 1.0).abs() < 1e-3, "{rate} {expected}");
}
