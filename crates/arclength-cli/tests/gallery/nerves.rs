//! Excitable membranes.

use crate::page::{LOCATED, Page, Source, Tolerance};
use crate::study::{Study, codimension_two, special};
use arclength::VectorField;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::CycleEnd;
use arclength::equilibrium::HopfPoint;

/// Bisection where continuation is not wanted.
fn root(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    assert!(function(low) * function(high) < 0.0);
    while high - low > 1e-15 * (low.abs() + high.abs()) {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if function(low) * function(middle) <= 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

#[test]
fn fitzhugh_nagumo() {
    let mut page = Page::new(
        "fitzhugh_nagumo",
        "The FitzHugh-Nagumo model",
        "The caricature of a nerve (FitzHugh 1961). The Hopf points are known in closed form; between them the nerve fires.",
    );
    page.command("arclength equilibria fitzhugh_nagumo.ode --along i0=0:2 -o equilibria.json");
    page.command("arclength cycles --from equilibria.json:HB1 --along i0=0:2 -o cycles.json -o cycles.svg");
    let mut study = Study::open("fitzhugh_nagumo", &[]);
    let branch = study.equilibria("i0=0:2");
    let points: Vec<&HopfPoint> = branch.hopf_points().collect();
    let (a, b, epsilon) = (0.7, 0.8, 0.08);
    for (sign, point, name) in [(-1.0, points[0], "first"), (1.0, points[1], "second")] {
        let v: f64 = sign * (1.0_f64 - b * epsilon).sqrt();
        let exact = (v + a) / b - v + v.powi(3) / 3.0;
        let formula = Source::ClosedForm("(v + a)/b - v + v^3/3, v^2 = 1 - b epsilon");
        page.row(format!("{name} Hopf point: i0"), exact, formula, LOCATED, point.value);
        let frequency = (epsilon - (b * epsilon).powi(2)).sqrt();
        page.row(
            "its angular frequency",
            frequency,
            Source::ClosedForm("sqrt(epsilon - (b epsilon)^2)"),
            LOCATED,
            point.frequency,
        );
    }
    study.cycles_from(&branch, 0, "i0=0:2", &[]);
    page.figure("", "Equilibria and cycles over i0", study.diagram());
    page.finish();
}

#[test]
fn hodgkin_huxley() {
    const PROOF: Source =
        Source::Published("Hendrick, computer-assisted proof in ball arithmetic, el = 10.613");
    let mut page = Page::new(
        "hodgkin_huxley",
        "The Hodgkin-Huxley equations",
        "The squid axon (Hodgkin and Huxley 1952) at 6.3 degrees. The Hopf points were found by Rinzel and Miller (1980) near \
         9.78 and 154.5; Hendrick has enclosed them to twelve digits for the leak potential 10.613 mV that Hodgkin and Huxley \
         print. The branch of cycles that is born at the first one turns back at folds of cycles.",
    );
    page.command("arclength equilibria hodgkin_huxley.ode --along i0=0:200 -s el=10.613 -o equilibria.json");
    page.command("arclength cycles --from equilibria.json:HB1 --along i0=0:200 -o cycles.json -o cycles.svg");
    let mut study = Study::open("hodgkin_huxley", &[("el", 10.613)]);
    let branch = study.equilibria("i0=0:200");
    let points: Vec<&HopfPoint> = branch.hopf_points().collect();
    page.row("first Hopf point: i0", 9.7754379953935, PROOF, Tolerance::Relative(1e-12), points[0].value);
    page.row("second Hopf point: i0", 154.5224336658085, PROOF, Tolerance::Relative(1e-12), points[1].value);
    assert!(points[0].first_lyapunov.unwrap() > 0.0 && points[1].first_lyapunov.unwrap() < 0.0);
    let cycles = study.cycles_from(&branch, 0, "i0=0:200", &[]);
    let own = Tolerance::Relative(1e-7);
    let folds = special(&cycles, |special| special == SpecialKind::FoldOfCycles);
    let doublings = special(&cycles, |special| special == SpecialKind::PeriodDoubling);
    for (cycle, value, name) in [
        (folds[0], 7.8423471202, "first fold of cycles"),
        (doublings[0], 7.8453373978, "first period doubling"),
        (doublings[1], 7.9177776757, "second period doubling"),
        (folds[1], 7.9177854943, "second fold of cycles"),
        (folds[2], 6.2603212745, "third fold of cycles"),
    ] {
        page.row(format!("{name}: i0"), value, Source::OwnValue, own, cycle.value);
    }
    let Some(Stop::Problem(CycleEnd::HopfPoint { parameter, .. })) = cycles.stops[1] else {
        panic!("{:?}", cycles.stops)
    };
    page.row(
        "Hopf point at which the cycles end: i0",
        points[1].value,
        Source::ClosedForm("the second Hopf point"),
        LOCATED,
        parameter,
    );
    page.figure("", "Equilibria and cycles over i0", study.diagram());
    page.finish();
}

#[test]
fn morris_lecar() {
    let mut page = Page::new(
        "morris_lecar",
        "The Morris-Lecar model",
        "The barnacle muscle fibre (Morris and Lecar 1981) with the values of Rinzel and Ermentrout (1989). The trace of the \
         Jacobian is a function of the potential alone, so that bisection gives the Hopf points without continuation. In the \
         plane of iapp and v3 the curves of folds and of Hopf points meet at a Bogdanov-Takens point; the folds end in a cusp.",
    );
    page.command("arclength equilibria morris_lecar.ode --along iapp=0:300 -o equilibria.json");
    page.command(
        "arclength cycles --from equilibria.json:HB1 --along iapp=0:300 -o cycles.json -o cycles.svg",
    );
    page.command(
        "arclength locus --from equilibria.json:HB1 --in iapp=-50:300,v3=-20:40 -o hopf.json -o hopf.svg",
    );
    let mut study = Study::open("morris_lecar", &[]);
    let branch = study.equilibria("iapp=0:300");
    // At an equilibrium w is w_inf(v): the current and the trace follow from the field alone.
    let model = study.chosen.model.clone();
    let parameters = study.chosen.parameters.clone();
    let gate = |v: f64| 0.5 * (1.0 + ((v - 2.0) / 30.0).tanh());
    let field = |v: f64, w: f64| {
        let mut derivative = [0.0; 2];
        model.evaluate(&[v, w], &parameters, &mut derivative);
        derivative
    };
    let current = |v: f64| parameters[0] - 20.0 * field(v, gate(v))[0];
    let trace = |v: f64| {
        // Complex step would need another field; central differences of order four are exact to 1e-11 here.
        let slope =
            |f: &dyn Fn(f64) -> f64, h: f64| (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h);
        slope(&|h| field(v + h, gate(v))[0], 1e-2) + slope(&|h| field(v, gate(v) + h)[1], 1e-3)
    };
    let points: Vec<&HopfPoint> = branch.hopf_points().collect();
    let source = || Source::ClosedForm("zero of the trace by bisection");
    for (point, bracket, name) in [(points[0], [-40.0, -15.0], "first"), (points[1], [0.0, 20.0], "second")] {
        let v = root(trace, bracket[0], bracket[1]);
        page.row(
            format!("{name} Hopf point: iapp"),
            current(v),
            source(),
            Tolerance::Relative(1e-9),
            point.value,
        );
    }
    study.cycles_from(&branch, 0, "iapp=0:300", &[]);
    page.figure("", "Equilibria and cycles over iapp", study.diagram());

    let hopf_points = study.locus(|locus| locus.from_hopf(points[0]), ["iapp=-50:300", "v3=-20:40"]);
    let found: Vec<[f64; 2]> = hopf_points
        .special_points()
        .filter(|point| point.kind == SpecialKind::BogdanovTakens)
        .map(|point| point.values)
        .collect();
    let mut folded = study.with("v3", 20.0);
    let branch = folded.equilibria("iapp=-50:300");
    let fold = branch.folds().next().unwrap();
    let folds = study.locus(|locus| locus.from_fold(fold), ["iapp=-50:300", "v3=-20:40"]);
    for (number, values) in found.iter().enumerate() {
        let other = folds
            .special_points()
            .filter(|point| point.kind == SpecialKind::BogdanovTakens)
            .map(|point| point.values)
            .min_by(|a, b| (a[1] - values[1]).abs().total_cmp(&(b[1] - values[1]).abs()))
            .unwrap();
        for (index, key) in ["iapp", "v3"].into_iter().enumerate() {
            page.row(
                format!("Bogdanov-Takens point {} on the curve of Hopf points: {key}", number + 1),
                other[index],
                Source::ClosedForm("the same point on the curve of folds"),
                Tolerance::Relative(1e-8),
                values[index],
            );
        }
    }
    let cusp = codimension_two(&folds, SpecialKind::Cusp, 0);
    for (index, (key, value)) in [("iapp", 92.105230083), ("v3", 6.4182080284)].into_iter().enumerate() {
        page.row(format!("cusp: {key}"), value, Source::OwnValue, LOCATED, cusp.values[index]);
    }
    page.figure("_plane", "Folds and Hopf points in iapp and v3", study.plane());
    page.finish();
}
