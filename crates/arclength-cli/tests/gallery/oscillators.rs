//! Oscillators and roads to chaos.

use crate::page::{COEFFICIENT, CYCLE, LOCATED, Page, Source, Tolerance};
use crate::study::{Study, at, special};
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::{CycleEnd, CycleStart};

#[test]
fn lure() {
    const MATCONT: Source = Source::Published("testrun `adaptx` of MatCont");
    let mut page = Page::new(
        "lure",
        "Feedback control of Lur'e type",
        "Example 5.4 of Kuznetsov's book and the testrun `adaptx` of MatCont. The cycles that are born at the Hopf point of the \
         origin double their period twice on the way to the Hopf point of the other equilibrium.",
    );
    page.command("arclength equilibria lure.ode --along alpha=-1.5:1.5 -o equilibria.json");
    page.command("arclength cycles --from equilibria.json:HB1 --along alpha=-1.5:1.5 -o cycles.json");
    page.command("arclength cycles --from cycles.json:PD1 --along alpha=-1.5:1.5 -o doubled.json");
    page.command("arclength show equilibria.json cycles.json doubled.json -o lure.svg");
    page.command("arclength locus --from cycles.json:PD1 --in alpha=-2:2,beta=0.2:2 -o doublings.json -o doublings.svg");
    let mut study = Study::open("lure", &[]);
    let branch = study.equilibria("alpha=-1.5:1.5");
    let hopf = branch.hopf_points().next().unwrap();
    page.row("Hopf point: alpha", 1.0, Source::ClosedForm("1"), LOCATED, hopf.value);
    page.row("its first Lyapunov coefficient", -0.3, MATCONT, COEFFICIENT, hopf.first_lyapunov.unwrap());
    let cycles = study.cycles_from(&branch, 0, "alpha=-1.5:1.5", &[]);
    let doublings = special(&cycles, |special| special == SpecialKind::PeriodDoubling);
    for (cycle, sign, name) in [(doublings[0], 1.0, "first"), (doublings[1], -1.0, "second")] {
        page.row(
            format!("{name} period doubling: alpha"),
            sign * 0.6303020062,
            MATCONT,
            Tolerance::Relative(1e-9),
            cycle.value,
        );
        page.row("its period", 6.364071339, MATCONT, CYCLE, cycle.period);
    }
    let Some(Stop::Problem(CycleEnd::HopfPoint { parameter, .. })) = cycles.stops[1] else {
        panic!("{:?}", cycles.stops)
    };
    assert!((parameter + 1.0).abs() < 1e-4, "{parameter}");
    const REFERENCE: Source = Source::Published("reference value of this project");
    let doubled = study.doubled_from(doublings[0], "alpha=-1.5:1.5", &[]);
    let folds = special(&doubled, |special| special == SpecialKind::FoldOfCycles);
    for (cycle, sign, name) in [(folds[0], -1.0, "first"), (folds[1], 1.0, "second")] {
        page.row(
            format!("doubled branch, {name} fold of cycles: alpha"),
            sign * 0.0449491239,
            REFERENCE,
            Tolerance::Relative(1e-8),
            cycle.value,
        );
    }
    let again = special(&doubled, |special| special == SpecialKind::PeriodDoubling);
    page.row(
        "doubled branch, period doubling: alpha",
        -0.0447196616,
        REFERENCE,
        Tolerance::Relative(1e-8),
        again[1].value,
    );
    page.row("its period", 11.062836564, REFERENCE, CYCLE, again[1].period);
    let Some(Stop::Problem(CycleEnd::PeriodDoubling { parameter, .. })) = doubled.stops[1] else {
        panic!("{:?}", doubled.stops)
    };
    page.row(
        "end of the doubled branch: alpha",
        -0.6303020062,
        MATCONT,
        Tolerance::Relative(1e-8),
        parameter,
    );
    page.figure("", "Equilibria and cycles over alpha", study.diagram());
    let curve = study.cycle_locus(SpecialKind::PeriodDoubling, doublings[0], ["alpha=-2:2", "beta=0.2:2"]);
    assert!(matches!(curve.stops[1], Some(Stop::Closed)), "{:?}", curve.stops);
    for (number, (_, point)) in curve.special().enumerate() {
        let place = format!("1:2 resonance {} on the curve of period doublings: alpha", number + 1);
        page.row(
            place,
            0.0,
            Source::ClosedForm("0, where the system is reversible"),
            Tolerance::Absolute(1e-8),
            point.values[0],
        );
    }
    page.figure("_plane", "Period doublings in alpha and beta", study.plane());
    page.finish();
}

#[test]
fn lorenz() {
    let mut page = Page::new(
        "lorenz",
        "The Lorenz equations",
        "Lorenz's model of convection (1963) with sigma = 10 and beta = 8/3. The origin loses its stability at a pitchfork, the \
         other equilibria theirs at subcritical Hopf points, whose cycles end in a homoclinic orbit. At high rho there is a \
         stable cycle again, which doubles its period on the way down.",
    );
    page.command("arclength equilibria lorenz.ode --along rho=0:30 -o origin.json");
    page.command("arclength equilibria --from origin.json:BP1 --along rho=0:30 -o other.json");
    page.command("arclength cycles --from other.json:HB1 --along rho=0:30 -o cycles.json");
    let mut study = Study::open("lorenz", &[]);
    let origin = study.equilibria("rho=0:30");
    page.row(
        "pitchfork of the origin: rho",
        1.0,
        Source::ClosedForm("1"),
        LOCATED,
        origin.branch_points().next().unwrap().value,
    );
    let other = study.other_branch(&origin, 0, "rho=0:30");
    let exact = 470.0 / 19.0;
    let hopf: Vec<f64> = other.hopf_points().map(|point| point.value).collect();
    page.row(
        "Hopf points: rho",
        exact,
        Source::ClosedForm("sigma (sigma + beta + 3)/(sigma - beta - 1) = 470/19"),
        LOCATED,
        hopf[0],
    );
    assert_eq!(hopf.len(), 2);
    let cycles = study.cycles_from(&other, 0, "rho=0:30", &[]);
    assert!(
        matches!(cycles.stops[1], Some(Stop::Problem(CycleEnd::PeriodUnbounded { .. }))),
        "{:?}",
        cycles.stops
    );
    let last = cycles.points.last().unwrap();
    page.row("homoclinic orbit: rho", 13.92656, Source::OwnValue, Tolerance::Relative(1e-4), last.value);
    page.figure("", "Equilibria and cycles over rho", study.diagram());

    let high = study.with("rho", 240.0);
    let mut high = high.starting_at(&[10.0, 10.0, 200.0]);
    let orbit = high.settled(200.0, 2.0);
    let parameters = high.chosen.parameters.clone();
    let cycles = high.cycles(CycleStart::Orbit(orbit), &parameters, "rho=205:320", &[]);
    let doubling = special(&cycles, |special| special == SpecialKind::PeriodDoubling);
    page.row(
        "period doubling: rho",
        229.40670855,
        Source::Published("reference value of this project"),
        Tolerance::Relative(1e-9),
        doubling[0].value,
    );
    let mut doubled = high.doubled_from(doubling[0], "rho=205:320", &[]);
    for (reference, name) in [(218.21012778, "second"), (215.96593069, "third")] {
        let found = special(&doubled, |special| special == SpecialKind::PeriodDoubling);
        let next =
            found.iter().min_by(|a, b| (a.value - reference).abs().total_cmp(&(b.value - reference).abs()));
        let next = *next.unwrap();
        page.row(
            format!("{name} period doubling: rho"),
            reference,
            Source::Published("reference value of this project"),
            Tolerance::Relative(1e-9),
            next.value,
        );
        if name == "second" {
            let branching = next.clone();
            doubled = high.doubled_from(&branching, "rho=205:320", &[]);
        }
    }
    page.figure("_high", "Cycles at high rho", high.diagram());
    page.finish();
}

#[test]
fn rossler() {
    const CHAOSBOOK: Source = Source::Published("ChaosBook.org, periodic orbits of Roessler's model");
    let mut page = Page::new(
        "rossler",
        "The Roessler equations",
        "The simplest chaos (Roessler 1976), a = b = 0.2. The cycle that is born at the Hopf point doubles its period on the \
         way to c = 5.7, where it is one of the unstable cycles in the attractor.",
    );
    page.command("arclength simulate rossler.ode --duration 500 -o history.json");
    page.command(
        "arclength cycles --from history.json:END --along c=0.5:6 --at 5.7 -o cycles.json -o cycles.svg",
    );
    let mut study = Study::open("rossler", &[]);
    let orbit = study.settled(500.0, 10.0);
    let parameters = study.chosen.parameters.clone();
    let cycles = study.cycles(CycleStart::Orbit(orbit), &parameters, "c=0.5:6", &[5.7]);
    let cycle = at(&cycles, 5.7);
    page.row("period at c = 5.7", 5.88108845586, CHAOSBOOK, CYCLE, cycle.period);
    page.row(
        "multiplier at c = 5.7",
        -2.403953527,
        CHAOSBOOK,
        Tolerance::Relative(1e-7),
        cycle.multipliers[0].re,
    );
    let doubling = special(&cycles, |special| special == SpecialKind::PeriodDoubling);
    let doubled = study.doubled_from(doubling[0], "c=0.5:6", &[5.7]);
    let cycle = at(&doubled, 5.7);
    page.row("period of the doubled cycle at c = 5.7", 11.7586260717, CHAOSBOOK, CYCLE, cycle.period);
    page.row("its multiplier", -3.512006980, CHAOSBOOK, Tolerance::Relative(1e-7), cycle.multipliers[0].re);
    page.row("period doubling: c", 2.8324, Source::OwnValue, Tolerance::Relative(1e-4), doubling[0].value);
    page.figure("", "The cycle over c", study.diagram());
    page.finish();
}

#[test]
fn vanderpol() {
    const LITERATURE: Source = Source::Published("reference value of this project");
    let mut page = Page::new(
        "vanderpol",
        "The van der Pol oscillator",
        "From a harmonic oscillation at small mu to a relaxation oscillation. The Hopf point at mu = 0 is degenerate: all cycles \
         lie at mu = 0 there, so that the branch starts from a time history.",
    );
    page.command("arclength simulate vanderpol.ode --duration 60 -o history.json");
    page.command(
        "arclength cycles --from history.json:END --along mu=0.1:10 --at 1,5 -o cycles.json -o cycles.svg",
    );
    let mut study = Study::open("vanderpol", &[("mu", 1.0)]);
    let orbit = study.settled(60.0, 20.0);
    let parameters = study.chosen.parameters.clone();
    let cycles = study.cycles(CycleStart::Orbit(orbit), &parameters, "mu=0.1:10", &[1.0, 5.0]);
    page.row(
        "period at mu = 1",
        6.663286859323,
        LITERATURE,
        Tolerance::Relative(1e-11),
        at(&cycles, 1.0).period,
    );
    page.row(
        "period at mu = 5",
        11.612230668,
        LITERATURE,
        Tolerance::Relative(1e-10),
        at(&cycles, 5.0).period,
    );
    page.figure("", "The cycle over mu", study.diagram());
    page.finish();
}
