//! The towed wheel as a text model: the same numbers as the model of the crate `kingpin`, as closed forms and as shooting.

use crate::page::{COEFFICIENT, CYCLE, LOCATED, Page, Source, Tolerance};
use crate::study::{Study, at};
use kingpin::branches::{Along, CycleOptions};
use kingpin::{Key, Wheel};
use std::ops::ControlFlow;

/// Speed, period, largest and smallest caster angle, largest multiplier at l = 0.08 m, r = 1 m: single shooting with a
/// tolerance of 3e-14.
const SHOOTING: [(f64, f64, f64, f64, f64); 4] = [
    (6.0, 0.1498182585503941, 0.5130785057286356, -0.3763047240963389, 1.0643648931772707),
    (4.0, 0.15274192836201247, 0.6351645637341435, -0.5003383285676317, 1.1137826096822392),
    (2.0, 0.15469423899444815, 0.7098150349910172, -0.5648677576526538, 1.160425345177388),
    (1.0, 0.15522951404204402, 0.7307800097444889, -0.5801477894905818, 1.1325484248532904),
];
/// Index of the caster angle among the states.
const CASTER_ANGLE: usize = 2;

#[test]
fn towed_wheel() {
    let mut page = Page::new(
        "towed_wheel",
        "The towed wheel",
        "A rolling wheel on a caster, towed on a circle: the model of the crate `kingpin` as text. The critical speed and the \
         frequency are closed forms, the cycles were computed by single shooting, and the Rust model gives the same numbers.",
    );
    page.command("arclength equilibria towed_wheel.ode --along v=0.5:12 -o equilibria.json");
    page.command("arclength cycles --from equilibria.json:HB1 --along v=0.5:12 --at 1,2,4,6 -o cycles.json -o cycles.svg");
    let mut study = Study::open("towed_wheel", &[]);
    let branch = study.equilibria("v=0.5:12");
    let hopf = branch.hopf_points().next().unwrap();
    let derivation = || Source::ClosedForm("docs/derivation.md");
    page.row("Hopf point: v", 8.43103697014, derivation(), LOCATED, hopf.value);
    page.row("its angular frequency", 43.2553921186, derivation(), LOCATED, hopf.frequency);
    let lyapunov = Source::ClosedForm("Kuznetsov's formula in 30-digit arithmetic");
    page.row(
        "its first Lyapunov coefficient",
        6.520929e-5,
        lyapunov,
        Tolerance::Relative(1e-6),
        hopf.first_lyapunov.unwrap(),
    );
    let along = Along::new(Key::V, 0.5, 12.0).unwrap();
    let wheel = Wheel::default();
    let rust = wheel.hopf_points(along, &arclength::control::Control::none()).unwrap().points.remove(0);
    let model = || Source::ClosedForm("the Rust model");
    page.row("Hopf point: v", rust.value, model(), Tolerance::Relative(1e-12), hopf.value);
    page.row(
        "its first Lyapunov coefficient",
        rust.first_lyapunov.unwrap(),
        model(),
        COEFFICIENT,
        hopf.first_lyapunov.unwrap(),
    );

    let speeds = SHOOTING.map(|(v, ..)| v);
    let cycles = study.cycles_from(&branch, 0, "v=0.5:12", &speeds);
    let options = CycleOptions::default().at(&speeds);
    let same = rust.cycles(along, &options, |_| ControlFlow::Continue(())).unwrap();
    for (v, period, largest, smallest, multiplier) in SHOOTING {
        let cycle = at(&cycles, v);
        let shooting = || Source::Published("single shooting, tolerance 3e-14");
        page.row(format!("period at v = {v}"), period, shooting(), CYCLE, cycle.period);
        page.row(format!("largest psi at v = {v}"), largest, shooting(), CYCLE, cycle.max[CASTER_ANGLE]);
        page.row(format!("smallest psi at v = {v}"), smallest, shooting(), CYCLE, cycle.min[CASTER_ANGLE]);
        page.row(
            format!("largest multiplier at v = {v}"),
            multiplier,
            shooting(),
            Tolerance::Relative(1e-7),
            cycle.multipliers[0].re,
        );
        let twin = same.points.iter().find(|point| point.value == v).unwrap();
        page.row(format!("period at v = {v}"), twin.period, model(), CYCLE, cycle.period);
    }
    page.figure("", "Uniform motion and cycles over v", study.diagram());
    page.finish();
}
