//! Equal cells that are coupled: many Hopf points, some of them double.

use super::kinds;
use approx::assert_relative_eq;
use arclength::branch::Stability;
use arclength::equilibrium::{Equilibria, SpecialPoint};
use arclength::{Scalar, VectorField};

/// The Brusselator in a row of cells with closed ends, or in a ring, both species diffusing equally fast: as many Hopf points
/// as cells.
struct Cells {
    count: usize,
    ring: bool,
}

impl VectorField for Cells {
    fn state_names(&self) -> Vec<String> {
        (0..2 * self.count)
            .map(|index| format!("{}{}", if index % 2 == 0 { "x" } else { "y" }, index / 2))
            .collect()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["b".into(), "diffusion".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        for cell in 0..self.count {
            let (one, other) = (x[2 * cell], x[2 * cell + 1]);
            let square = one * one * other;
            d[2 * cell] = -(p[0] + 1.0) * one + square + 1.0;
            d[2 * cell + 1] = p[0] * one - square;
            let left = if cell > 0 { Some(cell - 1) } else { self.ring.then_some(self.count - 1) };
            let right = if cell + 1 < self.count { Some(cell + 1) } else { self.ring.then_some(0) };
            for neighbour in left.into_iter().chain(right) {
                d[2 * cell] += p[1] * (x[2 * neighbour] - one);
                d[2 * cell + 1] += p[1] * (x[2 * neighbour + 1] - other);
            }
        }
    }
}

#[test]
fn every_mode_of_a_row_of_cells_has_its_hopf_point() {
    let (cells, diffusion) = (12, 0.4);
    let field = Cells { count: cells, ring: false };
    let branch = Equilibria::of(&field).start(&[1.0; 24]).parameters(&[1.5, diffusion]).along("b", 1.5..=6.0);
    let branch = branch.run().unwrap();
    let found: Vec<f64> = branch.hopf_points().map(|hopf| hopf.value).collect();
    // Mode m decays with rate mu = 4 sin^2(pi m/(2 cells)) times the diffusion; its trace vanishes at b = 2 + 2 mu, where the
    // determinant 1 - mu^2 is positive for slow modes.
    let rate = |mode: usize| {
        4.0 * diffusion * (std::f64::consts::PI * mode as f64 / (2 * cells) as f64).sin().powi(2)
    };
    let expected: Vec<f64> = (0..cells).map(rate).filter(|mu| *mu < 1.0).map(|mu| 2.0 + 2.0 * mu).collect();
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    for (value, expected) in found.iter().zip(expected) {
        assert_relative_eq!(*value, expected, max_relative = 1e-11);
    }
}

#[test]
fn hopf_points_that_symmetry_makes_double_are_reported() {
    let field = Cells { count: 4, ring: true };
    let branch =
        Equilibria::of(&field).start(&[1.0; 8]).parameters(&[1.5, 0.1]).along("b", 1.5..=3.0).run().unwrap();
    // Modes 0, 1, 1, 2 with the rates 0, 2, 2, 4 times the diffusion.
    assert_eq!(kinds(&branch), ["HB1", "HB2", "HB3"]);
    let found: Vec<_> = branch.special_points().collect();
    for (special, expected) in found.iter().zip([2.0, 2.4, 2.8]) {
        assert!((special.value() - expected).abs() < 1e-9, "{special:?}");
    }
    assert!(matches!(found[1], SpecialPoint::Degenerate { location_error, .. } if *location_error < 1e-9));
    assert_eq!(branch.points[0].stability, Stability::Stable);
    assert_eq!(branch.points[branch.points.len() - 1].stability, Stability::Unstable { dimension: Some(8) });
}

/// Three equal cells, each coupled with the others: eigenvalues `p` and twice `p - 3 k`.
struct Triangle(f64);

impl VectorField for Triangle {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        for cell in 0..3 {
            let others = x[(cell + 1) % 3] + x[(cell + 2) % 3] - x[cell] * 2.0;
            d[cell] = x[cell] * p[0] - x[cell].powi(3) + others * self.0;
        }
    }
}

#[test]
fn two_real_eigenvalues_that_vanish_together_are_no_hopf_point() {
    for coupling in [0.05, 0.1, 0.2, 0.3, 0.4, 0.6] {
        let field = Triangle(coupling);
        let run = Equilibria::of(&field).start(&[0.0; 3]).parameters(&[-1.0]).along("p", -1.0..=2.0).run();
        let branch = run.unwrap();
        let labels = kinds(&branch);
        assert!(labels.iter().all(|label| !label.starts_with("HB")), "{coupling}: {labels:?}");
        let near =
            |value: f64| branch.special_points().filter(|point| (point.value() - value).abs() < 1e-9).count();
        assert_eq!((near(0.0), near(3.0 * coupling)), (1, 1), "{coupling}: {labels:?}");
        assert_eq!(
            branch.points[branch.points.len() - 1].stability,
            Stability::Unstable { dimension: Some(3) }
        );
    }
}
