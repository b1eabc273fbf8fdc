//! Starts that are far from an equilibrium, or where equilibria come in families or are stiff.

use arclength::equilibrium::{Equilibria, FoundBy, WithTotals, conserved_totals, seek_equilibrium};
use arclength::{Scalar, VectorField};
use num_complex::Complex64;
use proptest::prelude::*;

/// A field of two states from a function of states and parameters.
macro_rules! field {
    ($name:ident, $states:expr, $parameters:expr, |$s:ident, $p:ident, $d:ident| $body:block) => {
        struct $name;
        impl VectorField for $name {
            fn state_names(&self) -> Vec<String> {
                $states.iter().map(|name: &&str| (*name).to_owned()).collect()
            }
            fn parameter_names(&self) -> Vec<String> {
                $parameters.iter().map(|name: &&str| (*name).to_owned()).collect()
            }
            fn evaluate<T: Scalar>(&self, $s: &[T], $p: &[T], $d: &mut [T]) $body
        }
    };
}

field!(Stiff, ["x", "y"], ["p", "k"], |s, p, d| {
    d[0] = p[1] * (p[0] - s[0]);
    d[1] = s[0] - s[1];
});

// Equations that are nearly the same, and a nonlinear one.
field!(StiffPair, ["x", "y"], ["p", "k"], |s, p, d| {
    d[0] = p[1] * (p[0] - s[0] - s[0] * s[0] * s[0]);
    d[1] = p[1] * (p[0] - s[0] - s[0] * s[0] * s[0]) + s[0] - s[1];
});

#[test]
fn stiffness_is_no_branch_point() {
    for k in [1.0, 1e4, 2e8, 1e9, 1e12] {
        let branch = Equilibria::of(&Stiff)
            .start(&[1.0, 1.0])
            .parameters(&[1.0, k])
            .along("p", 0.5..=2.0)
            .run()
            .unwrap();
        assert_eq!(branch.special_points().count(), 0, "k = {k}");
        let branch =
            Equilibria::of(&StiffPair).start(&[0.7, 0.7]).parameters(&[1.0, k]).along("p", 0.5..=2.0).run();
        assert!(branch.is_ok(), "k = {k}: {:?}", branch.err());
    }
}

field!(Pitchfork, ["x", "y"], ["p"], |s, p, d| {
    d[0] = s[0] * (p[0] - s[0] * s[0]);
    d[1] = -s[1];
});

#[test]
fn a_branch_point_is_no_start() {
    for p in [0.0, 1e-15] {
        let branch = Equilibria::of(&Pitchfork).parameters(&[p]).along("p", -1.0..=1.0).run();
        assert!(branch.is_err(), "p = {p}");
    }
    assert!(Equilibria::of(&Pitchfork).parameters(&[1e-3]).along("p", -1.0..=1.0).run().is_ok());
}

field!(Enzyme, ["e", "s", "c", "p"], ["k"], |x, p, d| {
    let binding = p[0] * x[0] * x[1];
    d[0] = x[2] * 2.0 - binding;
    d[1] = x[2] - binding + x[3] * 0.5;
    d[2] = binding - x[2] * 2.0;
    d[3] = x[2] - x[3] * 0.5;
});

#[test]
fn conserved_totals_are_found_named_and_kept() {
    let start = [1.0, 1.0, 0.0, 0.0];
    let names: Vec<String> = Enzyme.state_names();
    let texts: Vec<String> =
        conserved_totals(&Enzyme, &start, &[1.0], &[0]).iter().map(|total| total.text(&names)).collect();
    assert_eq!(texts, ["e + c", "s + c + p"]);
    let field = WithTotals::at(&Enzyme, &start, &[1.0], &[0]);
    let branch =
        Equilibria::of(&field).start(&start).parameters(&[1.0]).along("k", 0.1..=10.0).run().unwrap();
    for point in &branch.points {
        let [e, s, c, p] = point.state[..] else { unreachable!("four states") };
        assert!((e + c - 1.0).abs() < 1e-12 && (s + c + p - 1.0).abs() < 1e-12);
        // k e s = 2 c and c = p/2.
        assert!((point.value * e * s - 2.0 * c).abs() < 1e-10 && (2.0 * c - p).abs() < 1e-10);
        let mut eigenvalues = point.eigenvalues.clone();
        field.restore_eigenvalues(&mut eigenvalues);
        assert_eq!(eigenvalues.iter().filter(|value| **value == Complex64::ZERO).count(), 2);
        assert_eq!(point.stability.is_stable(), Some(true));
    }
}

field!(StandsStill, ["x", "y"], ["k"], |x, p, d| {
    d[0] = p[0] * (x[1] - x[0].powi(3));
    d[1] = x[0] - x[1];
});

#[test]
fn what_stands_still_at_one_value_of_the_parameter_is_not_conserved() {
    // With k = 0 x does not move. Where k varies it does.
    let start = [1.0, 1.0];
    assert_eq!(conserved_totals(&StandsStill, &start, &[0.0], &[]).len(), 1);
    assert!(conserved_totals(&StandsStill, &start, &[0.0], &[0]).is_empty());
}

#[test]
fn a_field_that_conserves_nothing_is_left_alone() {
    assert!(conserved_totals(&Stiff, &[1.0, 1.0], &[1.0, 3.0], &[0]).is_empty());
}

/// A linear exchange between all states, each rate once in gain and loss: their sum is conserved.
struct Exchange {
    count: usize,
    rates: Vec<f64>,
}

impl VectorField for Exchange {
    fn state_names(&self) -> Vec<String> {
        (0..self.count).map(|index| format!("x{index}")).collect()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["k".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        d.fill(T::zero());
        for from in 0..self.count {
            let to = (from + 1) % self.count;
            let flow = s[from] * s[from] * (p[0] * self.rates[from]);
            d[from] -= flow;
            d[to] += flow;
        }
    }
}

proptest! {
    #[test]
    fn the_total_of_a_ring_is_conserved(rates in prop::collection::vec(1e-3..1e3_f64, 2..7)) {
        let ring = Exchange { count: rates.len(), rates };
        let totals = conserved_totals(&ring, &vec![1.0; ring.count], &[1.0], &[0]);
        prop_assert_eq!(totals.len(), 1);
        prop_assert!(totals[0].coefficients.iter().all(|value| *value == 1.0));
    }
}

// Morris and Lecar (1981), whose usual initial state defeats Newton's method at this current.
field!(MorrisLecar, ["v", "w"], ["i"], |s, p, d| {
    let open = (((s[0] + 1.2) / 18.0).tanh() + 1.0) * 0.5;
    let rest = (((s[0] - 12.0) / 17.4).tanh() + 1.0) * 0.5;
    let leak = (s[0] + 60.0) * 2.0 + s[1] * (s[0] + 84.0) * 8.0 + open * (s[0] - 120.0) * 4.0;
    d[0] = (p[0] - leak) / 20.0;
    d[1] = ((s[0] - 12.0) / 34.8).cosh() * (rest - s[1]) / 15.0;
});

#[test]
fn the_flow_and_random_starts_lead_to_an_equilibrium() {
    let found = seek_equilibrium(&MorrisLecar, &[-24.22, 0.305], &[80.0]).unwrap();
    assert_ne!(found.by, FoundBy::Newton);
    let mut rate = [0.0; 2];
    MorrisLecar.evaluate(&found.state, &[80.0], &mut rate);
    assert!(rate.iter().all(|value| value.abs() < 1e-12));
}
