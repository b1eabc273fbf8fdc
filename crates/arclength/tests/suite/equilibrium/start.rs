//! Special points are found wherever the steps fall and wherever the run starts, and starts on singular points.

use arclength::branch::Stability;
use arclength::equilibrium::{Equilibria, EquilibriumBranch, SpecialPoint};
use arclength::{Scalar, VectorField};

/// Labels and parameter values of the labelled points, without neutral saddles.
fn labelled(branch: &EquilibriumBranch) -> Vec<(String, f64)> {
    let all = branch.points.iter().filter_map(|point| Some((point.label?.to_string(), point.value)));
    all.filter(|(label, _)| !label.starts_with("NSE")).collect()
}

fn expect(branch: &EquilibriumBranch, expected: &[(&str, f64)], tolerance: f64, context: &str) {
    let found = labelled(branch);
    let same = found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|((label, value), (name, place))| label == name && (value - place).abs() < tolerance);
    assert!(same, "{context}: {found:?}, expected {expected:?}");
}

/// Between special points the number of unstable eigenvalues is the same from point to point.
fn stability_changes_at_special_points_only(branch: &EquilibriumBranch) {
    for pair in branch.points.windows(2).filter(|pair| pair.iter().all(|point| point.special.is_none())) {
        let counts = [0, 1].map(|index| pair[index].stability.unstable_dimension());
        if let [Some(one), Some(other)] = counts {
            assert_eq!(one, other, "between {} and {}", pair[0].value, pair[1].value);
        }
    }
}

field!(HopfAndPitchfork, ["x", "y", "q"], ["mu", "g"], |x, p, d| {
    let square = x[0] * x[0] + x[1] * x[1];
    d[0] = (p[0] - square) * x[0] - x[1];
    d[1] = (p[0] - square) * x[1] + x[0];
    d[2] = (p[0] - p[1]) * x[2] - x[2].powi(3);
});

#[test]
fn a_hopf_point_close_to_a_branch_point_is_not_lost() {
    for gap in [0.1, 0.05, 0.02, 0.01, 0.001] {
        for start in [-0.37, -0.41, -0.5, 0.3] {
            let branch = Equilibria::of(&HopfAndPitchfork)
                .parameters(&[start, gap])
                .along("mu", -1.0..=1.0)
                .run()
                .unwrap();
            expect(&branch, &[("HB1", 0.0), ("BP1", gap)], 1e-12, &format!("gap {gap}, start {start}"));
            stability_changes_at_special_points_only(&branch);
        }
    }
}

field!(TwoHopfAndPitchfork, ["x", "y", "u", "v", "p", "q"], ["mu", "g", "s"], |x, p, d| {
    let (one, other) = (x[0] * x[0] + x[1] * x[1], x[2] * x[2] + x[3] * x[3]);
    let growth = p[2] * (p[0] - p[1]);
    d[0] = (p[0] - one) * x[0] - x[1];
    d[1] = (p[0] - one) * x[1] + x[0];
    d[2] = (growth - other) * x[2] - x[3] * 2.0;
    d[3] = (growth - other) * x[3] + x[2] * 2.0;
    d[4] = -x[4];
    d[5] = p[2] * (p[0] - p[1] * 2.0) * x[5] - x[5].powi(3);
});

#[test]
fn three_special_points_in_one_step_are_all_found() {
    for sense in [1.0, -1.0] {
        for gap in [0.02, 0.01, 0.001] {
            let start = Equilibria::of(&TwoHopfAndPitchfork).parameters(&[-0.37, gap, sense]);
            let branch = start.along("mu", -1.0..=1.0).run().unwrap();
            let expected = [("HB1", 0.0), ("HB2", gap), ("BP1", 2.0 * gap)];
            expect(&branch, &expected, 1e-12, &format!("gap {gap}, sense {sense}"));
            stability_changes_at_special_points_only(&branch);
        }
    }
}

field!(Hopf, ["x", "y"], ["mu"], |x, p, d| {
    let square = x[0] * x[0] + x[1] * x[1];
    d[0] = (p[0] + square) * x[0] - x[1];
    d[1] = (p[0] + square) * x[1] + x[0];
});

field!(Parabola, ["x", "y"], ["p"], |x, p, d| {
    d[0] = p[0] - x[0] * x[0];
    d[1] = -x[1];
});

#[test]
fn a_start_on_a_hopf_point_or_beside_it_finds_it_once() {
    for start in [0.0, 1e-16, -1e-15, 1e-14, 1e-13, -1e-12, 1e-11, 1e-9, -1e-7, 1e-6, 2e-6] {
        let branch = Equilibria::of(&Hopf).parameters(&[start]).along("mu", -2.0..=1.0).run().unwrap();
        expect(&branch, &[("HB1", 0.0)], 1e-13, &format!("start {start:e}"));
        assert_eq!(branch.points[branch.start].value, start);
        assert!(matches!(branch.special_points().next(), Some(SpecialPoint::Hopf(_))));
        stability_changes_at_special_points_only(&branch);
        assert_eq!(branch.points[0].stability, Stability::Stable);
    }
    // At an end of the range.
    for range in [0.0..=1.0, -1.0..=0.0] {
        let branch = Equilibria::of(&Hopf).parameters(&[0.0]).along("mu", range).run().unwrap();
        expect(&branch, &[("HB1", 0.0)], 1e-15, "end of the range");
    }
}

#[test]
fn a_start_on_a_fold_or_beside_it_finds_it_once() {
    for start in [0.0_f64, 1e-20, 1e-16, 1e-14, 1e-12, 1e-10, 1e-6] {
        for sign in [1.0, -1.0] {
            let run = Equilibria::of(&Parabola).through(&[sign * start.sqrt(), 0.0]);
            let branch = run.parameters(&[start]).along("p", -1.0..=1.0).run().unwrap();
            expect(&branch, &[("LP1", 0.0)], 1e-13, &format!("start {start:e}"));
            stability_changes_at_special_points_only(&branch);
            assert_eq!(branch.points[0].value, 1.0);
            assert_eq!(branch.points[branch.points.len() - 1].value, 1.0);
        }
    }
}

field!(Pitchfork, ["x", "y"], ["p", "r"], |x, p, d| {
    d[0] = p[0] * x[0] - x[0].powi(3);
    d[1] = -x[1] + p[1];
});

field!(Transcritical, ["x", "y"], ["p", "r"], |x, p, d| {
    d[0] = (p[0] + p[1]) * x[0] - x[0] * x[0];
    d[1] = -x[1];
});

#[test]
fn a_start_on_a_branch_point_is_refused_with_the_reason() {
    for error in [
        Equilibria::of(&Pitchfork).parameters(&[0.0, 0.0]).along("p", -1.0..=1.0).run().unwrap_err(),
        Equilibria::of(&Transcritical).parameters(&[0.0, 0.0]).along("p", -1.0..=1.0).run().unwrap_err(),
    ] {
        let message = error.to_string();
        assert!(message.contains("branch point") && message.contains("slightly different p"), "{message}");
    }
}

#[test]
fn a_branch_point_is_followed_along_another_parameter() {
    let trivial =
        Equilibria::of(&Transcritical).parameters(&[-0.7, 0.1]).along("p", -1.0..=1.0).run().unwrap();
    expect(&trivial, &[("BP1", -0.1)], 1e-13, "trivial branch");
    let point = trivial.branch_points().next().unwrap();
    // Along the other parameter the branch x = p + r crosses it as well.
    let other = Equilibria::of(&Transcritical).from_branch_point(point).along("r", -1.0..=1.0).run().unwrap();
    expect(&other, &[("BP1", 0.1)], 1e-13, "other branch");
    for point in &other.points {
        assert!((point.state[0] - (point.value - 0.1)).abs() < 1e-9, "{point:?}");
    }
    // A parameter that has no part in the branch point leaves the state x = 0 singular everywhere.
    let trivial = Equilibria::of(&Pitchfork).parameters(&[-0.7, 0.1]).along("p", -1.0..=1.0).run().unwrap();
    let point = trivial.branch_points().next().unwrap();
    let error = Equilibria::of(&Pitchfork).from_branch_point(point).along("r", -1.0..=1.0).run().unwrap_err();
    assert!(error.to_string().contains("slightly different r"), "{error}");
}

/// A ring of oscillators with linear coupling `k` of both components: Hopf points at `mu = 2 k (1 - cos(2 pi j/count))`.
struct Ring(usize);

impl VectorField for Ring {
    fn state_names(&self) -> Vec<String> {
        (0..2 * self.0).map(|index| format!("z{index}")).collect()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["mu".into(), "k".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        for cell in 0..self.0 {
            let (one, other) = (x[2 * cell], x[2 * cell + 1]);
            let square = one * one + other * other;
            let (left, right) = ((cell + self.0 - 1) % self.0, (cell + 1) % self.0);
            d[2 * cell] = (p[0] - square) * one - other - square * other * 0.5
                + p[1] * (x[2 * left] + x[2 * right] - one * 2.0);
            d[2 * cell + 1] = (p[0] - square) * other
                + one
                + square * one * 0.5
                + p[1] * (x[2 * left + 1] + x[2 * right + 1] - other * 2.0);
        }
    }
}

#[test]
fn every_mode_of_a_ring_is_found_though_most_cross_in_pairs() {
    let field = Ring(24);
    let branch = Equilibria::of(&field).parameters(&[-0.5, 0.1]).along("mu", -0.5..=1.0).run().unwrap();
    let found = labelled(&branch);
    assert_eq!(found.len(), 13, "{found:?}");
    for (mode, (label, value)) in found.iter().enumerate() {
        let expected = 0.2 * (1.0 - (std::f64::consts::TAU * mode as f64 / 24.0).cos());
        assert_eq!(*label, format!("HB{}", mode + 1));
        assert!((value - expected).abs() < 1e-8, "{label} at {value}, expected {expected}");
    }
    stability_changes_at_special_points_only(&branch);
}

field!(TwoFrequencies, ["x", "px", "y", "py"], ["m", "k"], |x, p, d| {
    d[0] = x[1];
    d[1] = -x[0] - x[0] * x[2] * 2.0 + p[0] * x[1];
    d[2] = x[3];
    d[3] = -p[1] * x[2] - x[0] * x[0] + x[2] * x[2] + p[0] * x[3];
});

#[test]
fn pairs_of_different_frequencies_that_cross_together_are_two_hopf_points() {
    for start in [-0.5, -0.37, 0.0] {
        let branch =
            Equilibria::of(&TwoFrequencies).parameters(&[start, 0.9]).along("m", -0.5..=0.5).run().unwrap();
        expect(&branch, &[("HB1", 0.0), ("HB2", 0.0)], 1e-12, &format!("start {start}"));
        let mut frequencies: Vec<f64> = branch.hopf_points().map(|hopf| hopf.frequency).collect();
        frequencies.sort_by(f64::total_cmp);
        assert_eq!(frequencies.len(), 2);
        assert!((frequencies[0] - 0.9_f64.sqrt()).abs() < 1e-12 && (frequencies[1] - 1.0).abs() < 1e-12);
    }
    // Equal frequencies stay one point that is not regular.
    let branch =
        Equilibria::of(&TwoFrequencies).parameters(&[-0.37, 1.0]).along("m", -0.5..=0.5).run().unwrap();
    expect(&branch, &[("HB1", 0.0)], 1e-8, "equal frequencies");
    assert!(matches!(branch.special_points().next(), Some(SpecialPoint::Degenerate { .. })));
}
