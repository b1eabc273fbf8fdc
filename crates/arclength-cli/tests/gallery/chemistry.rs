//! Chemical reactions.

use crate::page::{COEFFICIENT, LOCATED, Page, Source, Tolerance};
use crate::study::{Study, codimension_two, coefficient};
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::CycleEnd;

const AUTO: Source = Source::Published("demo `ab` of AUTO-07p");

#[test]
fn ab() {
    let mut page = Page::new(
        "ab",
        "A to B in a stirred tank",
        "An exothermic reaction with cooling (Uppal, Ray and Poore 1974), the first demo of AUTO. With B = 14 and 17 \
         there are two Hopf points; above B = 16 there are folds as well, and cycles end in homoclinic orbits. The curves of folds and of Hopf points in D and B \
         meet at a Bogdanov-Takens point; the folds end in a cusp, and on the curve of Hopf points the first Lyapunov \
         coefficient changes its sign.",
    );
    page.command("arclength equilibria ab.ode --along D=0:0.4 -s B=17 -o ab.json");
    page.command("arclength cycles --from ab.json:HB1 --along D=0:0.4 -o cycles.json");
    page.command("arclength locus --from ab.json:HB1 --in D=0:0.4,B=10:30 -o hopf.json -o hopf.svg");

    let mut fourteen = Study::open("ab", &[("B", 14.0)]);
    let branch = fourteen.equilibria("D=0:0.4");
    let hopf = branch.hopf_points().next().unwrap();
    page.row("Hopf point, B = 14: D", 0.16504204532, AUTO, LOCATED, hopf.value);
    let hopf_points = fourteen.locus(|locus| locus.from_hopf(hopf), ["D=0:0.4", "B=10:30"]);

    let mut seventeen = fourteen.with("B", 17.0);
    let branch = seventeen.equilibria("D=0:0.4");
    let values: Vec<f64> = branch.hopf_points().map(|point| point.value).collect();
    page.row("first Hopf point, B = 17: D", 0.12086571951, AUTO, LOCATED, values[0]);
    page.row("second Hopf point, B = 17: D", 0.21708050970, AUTO, LOCATED, values[1]);
    for hopf in [0, 1] {
        let cycles = seventeen.cycles_from(&branch, hopf, "D=0:0.4", &[]);
        assert!(
            matches!(cycles.stops[1], Some(Stop::Problem(CycleEnd::PeriodUnbounded { .. }))),
            "{:?}",
            cycles.stops
        );
    }

    let mut eighteen = fourteen.with("B", 18.0);
    let branch = eighteen.equilibria("D=0:0.4");
    let folds: Vec<_> = branch.folds().collect();
    let closed = |formula| Source::ClosedForm(formula);
    page.row("first fold, B = 18: D", (-1.5_f64).exp() / 2.0, closed("exp(-3/2)/2"), LOCATED, folds[0].value);
    page.row("second fold, B = 18: D", 2.0 * (-3.0_f64).exp(), closed("2 exp(-3)"), LOCATED, folds[1].value);

    let fold_points = fourteen.locus(|locus| locus.from_fold(folds[0]), ["D=0:0.4", "B=10:30"]);
    let cusp = codimension_two(&fold_points, SpecialKind::Cusp, 0);
    page.row("cusp: D", (-2.0_f64).exp(), closed("exp(-2)"), LOCATED, cusp.values[0]);
    page.row("cusp: B", 16.0, closed("4 (1 + beta)"), LOCATED, cusp.values[1]);
    let double = codimension_two(&hopf_points, SpecialKind::BogdanovTakens, 0);
    page.row(
        "Bogdanov-Takens point: D",
        (-4.0_f64 / 3.0).exp() / 3.0,
        closed("exp(-4/3)/3"),
        LOCATED,
        double.values[0],
    );
    page.row("Bogdanov-Takens point: B", 64.0 / 3.0, closed("64/3"), LOCATED, double.values[1]);
    let same = codimension_two(&fold_points, SpecialKind::BogdanovTakens, 0);
    page.row("the same on the curve of folds: B", 64.0 / 3.0, closed("64/3"), LOCATED, same.values[1]);
    let bautin = codimension_two(&hopf_points, SpecialKind::GeneralizedHopf, 0);
    page.row(
        "generalised Hopf point: D",
        0.278985414,
        Source::OwnValue,
        Tolerance::Relative(1e-8),
        bautin.values[0],
    );
    page.row("generalised Hopf point: B", 11.0158490927, Source::OwnValue, LOCATED, bautin.values[1]);
    page.row(
        "its second Lyapunov coefficient",
        -0.4425774,
        Source::OwnValue,
        Tolerance::Relative(1e-6),
        coefficient(bautin, "second_lyapunov"),
    );
    page.figure("", "Equilibria and cycles over D at B = 17", seventeen.diagram());
    page.figure("_plane", "Folds and Hopf points in D and B", fourteen.plane());
    page.finish();
}

#[test]
fn brusselator() {
    let mut page = Page::new(
        "brusselator",
        "The Brusselator",
        "The model reaction of Prigogine and Lefever (1968). Everything about its Hopf point is known in closed form; from \
         there a stable limit cycle grows into a relaxation oscillation.",
    );
    page.command("arclength equilibria brusselator.ode --along b=0.5:5 -o equilibria.json");
    page.command("arclength cycles --from equilibria.json:HB1 --along b=0.5:5 -o cycles.json -o cycles.svg");
    let mut study = Study::open("brusselator", &[]);
    let branch = study.equilibria("b=0.5:5");
    let hopf = branch.hopf_points().next().unwrap();
    page.row("Hopf point: b", 2.0, Source::ClosedForm("1 + a^2"), LOCATED, hopf.value);
    page.row("angular frequency", 1.0, Source::ClosedForm("a"), LOCATED, hopf.frequency);
    page.row("Re c1", -0.5, Source::ClosedForm("-1/2 at a = 1"), COEFFICIENT, hopf.c1_real.unwrap());
    let cycles = study.cycles_from(&branch, 0, "b=0.5:5", &[3.0]);
    assert!(cycles.points.iter().all(|point| point.stable == Some(true)));
    page.figure("", "Equilibria and cycles over b", study.diagram());
    page.finish();
}
