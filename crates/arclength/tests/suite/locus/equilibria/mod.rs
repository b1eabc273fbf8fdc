//! Curves of special equilibria in two parameters against closed forms and published values.

mod branch_points;
mod closed_and_degenerate;
mod codimension_two;
mod models;
mod random_fields;
mod requests;

use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::equilibrium::{Equilibria, EquilibriumBranch};
use arclength::locus::{CodimensionTwoPoint, EquilibriumLocusBranch};
use arclength::{Scalar, VectorField};

fn labels(branch: &EquilibriumLocusBranch) -> Vec<String> {
    branch.points.iter().filter_map(|point| Some(point.label?.to_string())).collect()
}

fn coefficient(point: &CodimensionTwoPoint, name: &str) -> f64 {
    point.coefficients.iter().find(|(candidate, _)| candidate == name).expect("the coefficient").1
}

fn only(branch: &EquilibriumLocusBranch, kind: SpecialKind) -> &CodimensionTwoPoint {
    let found: Vec<_> = branch.special_points().filter(|point| point.kind == kind).collect();
    assert_eq!(found.len(), 1, "{:?}", labels(branch));
    found[0]
}

fn reaches_range_ends(branch: &EquilibriumLocusBranch) {
    for stop in branch.stops.iter().flatten() {
        assert!(matches!(stop, Stop::RangeEnd { .. }), "{stop}");
    }
}

field!(Cusp, ["x"], ["beta1", "beta2"], |x, p, d| {
    d[0] = p[0] + p[1] * x[0] - x[0].powi(3);
});

/// Its equilibria along `beta1` at `beta2 = 1`.
fn equilibria_of_the_cusp() -> EquilibriumBranch {
    let equilibria = Equilibria::of(&Cusp).start(&[-2.0]).parameters(&[-2.0, 1.0]);
    equilibria.along("beta1", -2.0..=2.0).run().unwrap()
}
