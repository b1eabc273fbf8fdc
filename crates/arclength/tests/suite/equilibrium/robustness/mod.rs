//! Branches of equilibria that are hard to follow: units, close special points, degenerate fields, symmetry, random fields.

mod close_points;
mod crossings;
mod degenerate_fields;
mod double_zero;
mod equal_eigenvalues;
mod random_fields;
mod requests;
mod rings;
mod steep_flanks;
mod symmetry;
mod units;

use arclength::equilibrium::EquilibriumBranch;

fn kinds(branch: &EquilibriumBranch) -> Vec<String> {
    branch.points.iter().filter_map(|point| Some(point.label?.to_string())).collect()
}
