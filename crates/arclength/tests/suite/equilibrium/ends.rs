//! Where branches of equilibria end that reach no end of a range, and what special points do not say.

use arclength::branch::{Criticality, Stability};
use arclength::continuation::Stop;
use arclength::equilibrium::{Equilibria, EquilibriumBranch, EquilibriumEnd, equilibrium_settings};
use arclength::{Scalar, VectorField};

fn kinds(branch: &EquilibriumBranch) -> Vec<String> {
    branch.points.iter().filter_map(|point| Some(point.label?.to_string())).collect()
}

field!(Hyperbola, ["x"], ["p"], |x, p, d| {
    d[0] = -(p[0] * x[0]) + 1.0;
});

field!(Logarithm, ["x"], ["p"], |x, p, d| {
    d[0] = x[0].exp() - p[0];
});

field!(VerticalLine, ["x"], ["a"], |x, p, d| {
    d[0] = p[0] * (x[0] - x[0] * x[0] * x[0] * 0.25);
});

/// Every (0, x) is an equilibrium: the line is followed, with its branch points at x = +-2, and its end is called what it is.
#[test]
fn a_line_of_equilibria_at_one_parameter_value() {
    let branch = Equilibria::of(&VerticalLine).parameters(&[-1.0]).along("a", -1.0..=1.0).run().unwrap();
    let point = branch.branch_points().next().unwrap();
    assert_eq!(point.criticality, Some(Criticality::Degenerate));
    for finer in [1.0, 10.0] {
        let settings = equilibrium_settings();
        let settings =
            settings.initial_step(settings.initial_step / finer).largest_step(settings.largest_step / finer);
        let line = Equilibria::of(&VerticalLine)
            .from_branch_point(point)
            .along("a", -1.0..=1.0)
            .settings(settings)
            .run()
            .unwrap();
        assert_eq!(kinds(&line), ["BP1", "BP2", "BP3"]);
        for stop in &line.stops {
            assert!(
                matches!(stop, Some(Stop::Problem(EquilibriumEnd::ParameterStandsStill { parameter })) if *parameter == 0.0),
                "{stop:?}"
            );
        }
    }
}

field!(Folded, ["x"], ["lam"], |x, p, d| {
    d[0] = p[0] - x[0].exp() + x[0];
});

field!(Node, ["x", "y"], ["k"], |x, p, d| {
    d[0] = -(x[0] - 1.0);
    d[1] = -(p[0] * (x[1] - 1.0));
});

/// The critical eigenvalue of a scalar field at a fold is rounding and the largest one: it says nothing about stability. Around a
/// start at the end of a range nothing outside of it is told.
#[test]
fn special_points_say_no_more_than_they_know() {
    let fold =
        Equilibria::of(&Folded).start(&[-1.5]).parameters(&[1.7]).along("lam", 0.0..=2.0).run().unwrap();
    for point in fold.points.iter().filter(|point| point.special.is_some()) {
        assert_eq!(point.stability, Stability::Undecided);
    }
    assert_eq!(kinds(&fold), ["LP1"]);
    let wide =
        Equilibria::of(&Node).start(&[1.0, 1.0]).parameters(&[1.0]).along("k", 1.0..=1e8).run().unwrap();
    assert!(kinds(&wide).is_empty(), "{:?}", kinds(&wide));
}

#[test]
fn branches_that_go_to_infinity_end() {
    let branch =
        Equilibria::of(&Hyperbola).start(&[1.0]).parameters(&[1.0]).along("p", -1.0..=2.0).run().unwrap();
    match &branch.stops[0] {
        Some(Stop::Problem(EquilibriumEnd::StateUnbounded { parameter })) => assert!(parameter.abs() < 1e-5),
        other => panic!("{other:?}"),
    }
    let branch = Equilibria::of(&Logarithm).parameters(&[1.0]).along("p", 0.0..=2.0).run().unwrap();
    assert!(matches!(branch.stops[0], Some(Stop::RangeEnd { value: 0.0, .. })), "{:?}", branch.stops);
    let branch = Equilibria::of(&Logarithm).parameters(&[1.0]).along("p", -1.0..=2.0).run().unwrap();
    match &branch.stops[0] {
        Some(Stop::Problem(EquilibriumEnd::StateUnbounded { parameter })) => assert!(parameter.abs() < 1e-5),
        other => panic!("{other:?}"),
    }
}
