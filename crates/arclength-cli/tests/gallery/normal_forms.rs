//! Normal forms and other systems whose branches are known in closed form.

use crate::page::{COEFFICIENT, CYCLE, LOCATED, Page, Source, Tolerance};
use crate::study::{Study, at, codimension_two, coefficient, special};
use arclength::branch::SpecialKind;
use arclength::cycle::CycleStart;
use std::f64::consts::{PI, TAU};

const EXACT: Tolerance = Tolerance::Absolute(1e-12);

fn closed(formula: &'static str) -> Source {
    Source::ClosedForm(formula)
}

#[test]
fn cusp() {
    let mut page = Page::new("cusp", "The cusp", "Normal form of the cusp (Kuznetsov, theorem 8.1).");
    page.command("arclength equilibria cusp.ode --along beta1=-1:1 -o equilibria.json");
    page.command(
        "arclength locus --from equilibria.json:LP1 --in beta1=-1:1,beta2=-1:1.5 -o folds.json -o folds.svg",
    );
    let mut study = Study::open("cusp", &[]);
    let branch = study.equilibria("beta1=-1:1");
    let exact = 2.0 / 27.0_f64.sqrt();
    let folds: Vec<_> = branch.folds().collect();
    page.row("first fold: beta1", exact, closed("2/sqrt(27)"), LOCATED, folds[0].value);
    page.row("second fold: beta1", -exact, closed("-2/sqrt(27)"), LOCATED, folds[1].value);
    let curve = study.locus(|locus| locus.from_fold(folds[0]), ["beta1=-1:1", "beta2=-1:1.5"]);
    let point = codimension_two(&curve, SpecialKind::Cusp, 0);
    page.row("cusp: beta1", 0.0, closed("0"), EXACT, point.values[0]);
    page.row("cusp: beta2", 0.0, closed("0"), EXACT, point.values[1]);
    page.row("its coefficient c", -1.0, closed("-1"), COEFFICIENT, coefficient(point, "c"));
    let far = curve.points.iter().map(|point| 27.0 * point.values[0].powi(2) - 4.0 * point.values[1].powi(3));
    let far = far.fold(0.0_f64, |worst, error| worst.max(error.abs()));
    page.row(
        "largest abs(27 beta1^2 - 4 beta2^3) on the curve",
        0.0,
        closed("0"),
        Tolerance::Absolute(1e-9),
        far,
    );
    page.figure("", "Equilibria over beta1 at beta2 = 1", study.diagram());
    page.figure("_plane", "Folds in beta1 and beta2", study.plane());
    page.finish();
}

#[test]
fn bogdanov_takens() {
    let mut page = Page::new(
        "bogdanov_takens",
        "The Bogdanov-Takens bifurcation",
        "Normal form of the Bogdanov-Takens bifurcation (Kuznetsov, theorem 8.4, s = -1): folds on a parabola, Hopf points on \
         a half line, and a branch of cycles that ends in a homoclinic orbit.",
    );
    page.command("arclength equilibria bogdanov_takens.ode --along beta1=-1:0.5 -o equilibria.json");
    page.command(
        "arclength locus --from equilibria.json:HB1 --in beta1=-1:1,beta2=-2:2 -o hopf.json -o hopf.svg",
    );
    let mut study = Study::open("bogdanov_takens", &[]);
    let branch = study.equilibria("beta1=-1:0.5");
    let hopf = branch.hopf_points().next().unwrap();
    let fold = branch.folds().next().unwrap();
    page.row("Hopf point at beta2 = -1: beta1", 0.0, closed("0"), EXACT, hopf.value);
    page.row("its angular frequency", 1.0, closed("sqrt(-beta2)"), LOCATED, hopf.frequency);
    page.row("fold at beta2 = -1: beta1", 0.25, closed("beta2^2/4"), LOCATED, fold.value);
    let plane = ["beta1=-1:1", "beta2=-2:2"];
    let curves = [
        (study.locus(|locus| locus.from_hopf(hopf), plane), "Hopf points"),
        (study.locus(|locus| locus.from_fold(fold), plane), "folds"),
    ];
    for (curve, name) in &curves {
        let point = codimension_two(curve, SpecialKind::BogdanovTakens, 0);
        let place = format!("Bogdanov-Takens point on the curve of {name}");
        page.row(format!("{place}: beta1"), 0.0, closed("0"), EXACT, point.values[0]);
        page.row(format!("{place}: beta2"), 0.0, closed("0"), EXACT, point.values[1]);
        page.row("its coefficient a", 1.0, closed("1"), COEFFICIENT, coefficient(point, "a"));
        page.row("its coefficient b", -1.0, closed("-1"), COEFFICIENT, coefficient(point, "b"));
    }
    study.cycles_from(&branch, 0, "beta1=-1:0.5", &[]);
    page.figure("", "Equilibria and cycles over beta1 at beta2 = -1", study.diagram());
    page.figure("_plane", "Folds and Hopf points in beta1 and beta2", study.plane());
    page.finish();
}

#[test]
fn bautin() {
    let mut page = Page::new(
        "bautin",
        "The generalised Hopf (Bautin) bifurcation",
        "Normal form of the Bautin bifurcation (Kuznetsov, theorem 8.2): the cycles have the squared radius rho with \
         beta1 + beta2 rho - rho^2 = 0 and turn back at a fold of cycles.",
    );
    page.command("arclength equilibria bautin.ode --along beta1=-1:1 -o equilibria.json");
    page.command("arclength cycles --from equilibria.json:HB1 --along beta1=-1:1 --at 0.5 -o cycles.json -o cycles.svg");
    page.command("arclength locus --from equilibria.json:HB1 --in beta1=-1:1,beta2=-1:1.5 -o hopf.json");
    page.command("arclength locus --from cycles.json:LPC1 --in beta1=-1:1,beta2=0.1:1.5 -o folds.json");
    let mut study = Study::open("bautin", &[]);
    let branch = study.equilibria("beta1=-1:1");
    let hopf = branch.hopf_points().next().unwrap();
    page.row("Hopf point: beta1", 0.0, closed("0"), EXACT, hopf.value);
    page.row(
        "its first Lyapunov coefficient",
        2.0,
        closed("2 beta2 with <q, q> = 1"),
        COEFFICIENT,
        hopf.first_lyapunov.unwrap(),
    );
    let cycles = study.cycles_from(&branch, 0, "beta1=-1:1", &[0.5]);
    let folds = special(&cycles, |special| special == SpecialKind::FoldOfCycles);
    page.row("fold of cycles: beta1", -0.25, closed("-beta2^2/4"), CYCLE, folds[0].value);
    page.row("its largest x", 0.5_f64.sqrt(), closed("sqrt(beta2/2)"), CYCLE, folds[0].max[0]);
    let radius = (0.5 + 0.75_f64.sqrt()).sqrt();
    page.row(
        "largest x at beta1 = 0.5",
        radius,
        closed("sqrt(1/2 + sqrt(3/4))"),
        CYCLE,
        at(&cycles, 0.5).max[0],
    );
    let curve = study.locus(|locus| locus.from_hopf(hopf), ["beta1=-1:1", "beta2=-1:1.5"]);
    let point = codimension_two(&curve, SpecialKind::GeneralizedHopf, 0);
    page.row("generalised Hopf point: beta2", 0.0, closed("0"), Tolerance::Absolute(1e-10), point.values[1]);
    let second = coefficient(point, "second_lyapunov");
    page.row("its second Lyapunov coefficient", -4.0, closed("-4 with <q, q> = 1"), COEFFICIENT, second);
    let folds = study.cycle_locus(SpecialKind::FoldOfCycles, folds[0], ["beta1=-1:1", "beta2=0.1:1.5"]);
    let far = folds.points.iter().map(|point| (point.values[0] + 0.25 * point.values[1].powi(2)).abs());
    let far = far.fold(0.0, f64::max);
    page.row(
        "largest abs(beta1 + beta2^2/4) on the curve of folds of cycles",
        0.0,
        closed("0"),
        Tolerance::Absolute(1e-8),
        far,
    );
    page.figure("", "Equilibria and cycles over beta1 at beta2 = 1", study.diagram());
    page.figure("_plane", "Hopf points and folds of cycles in beta1 and beta2", study.plane());
    page.finish();
}

#[test]
fn radial_cycle() {
    let mut page = Page::new(
        "radial_cycle",
        "A circle with a known multiplier",
        "The unit circle is a cycle with the multiplier exp(-4 pi rho) at every rho: a check of Floquet multipliers over many \
         orders of magnitude.",
    );
    page.command("arclength simulate radial_cycle.ode --duration 10 -o history.json");
    page.command("arclength cycles --from history.json:END --along rho=-1:2 --at 0.5,1,2 -o cycles.json");
    let mut study = Study::open("radial_cycle", &[]);
    let orbit = study.settled(10.0, 10.0);
    let parameters = study.chosen.parameters.clone();
    let cycles = study.cycles(CycleStart::Orbit(orbit), &parameters, "rho=0.1:2", &[0.5, 1.0, 2.0]);
    for (rho, tolerance) in [(0.5, 1e-8), (2.0, 1e-5)] {
        let cycle = at(&cycles, rho);
        page.row(format!("period at rho = {rho}"), TAU, closed("2 pi"), CYCLE, cycle.period);
        let exact = (-4.0 * PI * rho).exp();
        page.row(
            format!("multiplier at rho = {rho}"),
            exact,
            closed("exp(-4 pi rho)"),
            Tolerance::Relative(tolerance),
            cycle.multipliers[1].re,
        );
    }
    page.figure("", "The cycle over rho", study.diagram());
    page.finish();
}

#[test]
fn langford() {
    let mut page = Page::new(
        "langford",
        "A torus from a cycle",
        "Interaction of a Hopf and a transcritical bifurcation (Langford 1979). The cycle is a circle at constant z, so that \
         its torus bifurcation is the Hopf bifurcation of a planar system and known in closed form.",
    );
    page.command("arclength simulate langford.ode --duration 500 -o history.json");
    page.command(
        "arclength cycles --from history.json:END --along lambda=1.7:2.1 -o cycles.json -o cycles.svg",
    );
    let mut study = Study::open("langford", &[]);
    let orbit = study.settled(500.0, 40.0);
    let parameters = study.chosen.parameters.clone();
    let cycles = study.cycles(CycleStart::Orbit(orbit), &parameters, "lambda=1.7:2.1", &[]);
    let torus = cycles.of_kind(SpecialKind::Torus).next().expect("a torus bifurcation");
    let argument = torus.normal_form.iter().find(|(name, _)| *name == "argument").expect("an argument").1;
    page.row("torus bifurcation: lambda", 2.0, closed("2"), LOCATED, torus.value);
    page.row("its period", 8.0 * PI, closed("2 pi/c"), CYCLE, torus.period);
    page.row("its largest x", 1.0, closed("1"), CYCLE, torus.max[0]);
    let angle = (1.2_f64.sqrt() * 8.0 * PI).rem_euclid(TAU);
    page.row("argument of its multipliers", angle, closed("8 pi sqrt(6/5) - 8 pi"), COEFFICIENT, argument);
    page.figure("", "The cycle over lambda", study.diagram());
    page.finish();
}
