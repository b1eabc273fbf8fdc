//! Predators and prey.

use crate::page::{CYCLE, LOCATED, Page, Source, Tolerance};
use crate::study::{Study, at, codimension_two, coefficient};
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::CycleEnd;

#[test]
fn pp2() {
    const AUTO: Source = Source::Published("demo `pp2` of AUTO-07p");
    let mut page = Page::new(
        "pp2",
        "A predator and its harvested prey",
        "Demo `pp2` of AUTO. The trivial equilibrium has a branch point; on the branch through it lie a fold and a second \
         branch point, from which the coexistence of both species bends away. There a Hopf point gives birth to cycles that \
         end in a heteroclinic orbit.",
    );
    page.command("arclength equilibria pp2.ode --along p1=0:0.9 -o trivial.json");
    page.command("arclength equilibria --from trivial.json:BP1 --along p1=0:0.9 -o prey.json");
    page.command("arclength equilibria --from prey.json:BP2 --along p1=0:0.9 -o both.json");
    page.command("arclength cycles --from both.json:HB1 --along p1=0:0.9 --at 0.7 -o cycles.json");
    page.command("arclength show trivial.json prey.json both.json cycles.json -o pp2.svg");
    let mut study = Study::open("pp2", &[]);
    let trivial = study.equilibria("p1=0.2:0.9");
    page.row("branch point: p1", 0.6, AUTO, LOCATED, trivial.branch_points().next().unwrap().value);
    let prey = study.other_branch(&trivial, 0, "p1=0.2:0.9");
    page.row("fold: p1", 0.83292932223, AUTO, LOCATED, prey.folds().next().unwrap().value);
    let place = prey.branch_points().position(|point| point.value > 0.7).unwrap();
    let both = study.other_branch(&prey, place, "p1=0.2:0.9");
    let hopf = both.hopf_points().next().unwrap();
    page.row("Hopf point: p1", 0.67159384747883, AUTO, Tolerance::Relative(1e-12), hopf.value);
    page.row("its angular frequency", 0.6047822219, AUTO, LOCATED, hopf.frequency);
    let cycles = study.cycles_from(&both, 0, "p1=0.2:0.9", &[0.7]);
    page.row("period of the cycle at p1 = 0.7", 17.12989088, AUTO, CYCLE, at(&cycles, 0.7).period);
    assert!(
        matches!(cycles.stops[1], Some(Stop::Problem(CycleEnd::PeriodUnbounded { .. }))),
        "{:?}",
        cycles.stops
    );
    page.figure("", "Equilibria and cycles over p1", study.diagram());
    page.finish();
}

#[test]
fn bazykin() {
    let mut page = Page::new(
        "bazykin",
        "Bazykin's predator and prey",
        "Competition among predators and saturation (Bazykin 1985). The curves of folds and of Hopf points in alpha and delta \
         touch at a Bogdanov-Takens point.",
    );
    page.command("arclength equilibria bazykin.ode --along alpha=0:1 -s delta=0.1 -o equilibria.json");
    page.command(
        "arclength locus --from equilibria.json:HB1 --in alpha=0:1,delta=0:0.5 -o hopf.json -o hopf.svg",
    );
    let mut study = Study::open("bazykin", &[("delta", 0.1)]);
    let branch = study.equilibria("alpha=0:1");
    let hopf = branch.hopf_points().next().unwrap();
    let hopf_points = study.locus(|locus| locus.from_hopf(hopf), ["alpha=0:1", "delta=0:0.5"]);
    let fold = branch.folds().next().unwrap();
    let folds = study.locus(|locus| locus.from_fold(fold), ["alpha=0:1", "delta=0:0.5"]);
    let source =
        || Source::Published("Kuznetsov (2004), section 8.3.3; digits as reference value of this project");
    for (curve, name) in [(&hopf_points, "Hopf points"), (&folds, "folds")] {
        let point = codimension_two(curve, SpecialKind::BogdanovTakens, 0);
        page.row(
            format!("Bogdanov-Takens point on the curve of {name}: alpha"),
            0.4536243277781295,
            source(),
            LOCATED,
            point.values[0],
        );
        page.row(
            format!("Bogdanov-Takens point on the curve of {name}: delta"),
            0.1751275929502174,
            source(),
            LOCATED,
            point.values[1],
        );
        assert!(coefficient(point, "a") * coefficient(point, "b") != 0.0);
    }
    page.figure("", "Equilibria over alpha at delta = 0.1", study.diagram());
    page.figure("_plane", "Folds and Hopf points in alpha and delta", study.plane());
    page.finish();
}
