//! Several real eigenvalues that are the same function of the parameter and pass through zero in one point. The sum of two of them
//! changes its sign there as at a Hopf point or a neutral saddle, which it is not.

use arclength::branch::{SpecialKind, Stability};
use arclength::equilibrium::{Equilibria, SpecialPoint};
use arclength::{Scalar, VectorField};
use proptest::prelude::*;

/// `equal` states `y' = (p - birth) y - y^3` and one that decays, coupled by quadratic terms, seen in the coordinates `x` with
/// `y = x + mixing (sum of x) (1, 2, ..)`.
#[derive(Debug, Clone)]
struct Equal {
    equal: usize,
    birth: f64,
    decay: f64,
    coupling: f64,
    mixing: f64,
}

impl VectorField for Equal {
    fn state_names(&self) -> Vec<String> {
        (0..=self.equal).map(|index| format!("x{index}")).collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }

    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], derivative: &mut [T]) {
        let n = self.equal + 1;
        let weight = |index: usize| self.mixing * (index + 1) as f64;
        let total = x.iter().fold(x[0] * 0.0, |total, entry| total + *entry);
        let y: Vec<T> = (0..n).map(|index| x[index] + total * weight(index)).collect();
        let growth = p[0] - self.birth;
        let rate = |index: usize| {
            let next = y[(index + 1) % n];
            let own = if index == self.equal {
                y[index] * (-self.decay)
            } else {
                growth * y[index] - y[index] * y[index] * y[index]
            };
            own + next * y[(index + 2) % n] * self.coupling
        };
        // The inverse of one plus a matrix of rank one (Sherman and Morrison, 1950).
        let rates: Vec<T> = (0..n).map(rate).collect();
        let sum = rates.iter().fold(x[0] * 0.0, |sum, rate| sum + *rate);
        let weights: f64 = (0..n).map(weight).sum();
        for index in 0..n {
            derivative[index] = rates[index] - sum * (weight(index) / (1.0 + weights));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn equal_eigenvalues_that_vanish_are_one_branch_point(
        equal in 2_usize..4,
        birth in -0.5_f64..0.5,
        decay in 0.1_f64..5.0,
        coupling in -0.5_f64..0.5,
        mixing in 0.0_f64..0.3,
    ) {
        let field = Equal { equal, birth, decay, coupling, mixing };
        let branch = Equilibria::of(&field)
            .start(&vec![0.0; equal + 1])
            .parameters(&[-1.0])
            .along("p", -1.0..=1.0)
            .run()
            .unwrap();
        prop_assert!(branch.unlocated.is_empty(), "{:?}", branch.unlocated);
        // Beyond the birth the decaying state makes neutral saddles with the others; nothing else happens.
        let at_birth = |special: &&SpecialPoint| (special.value() - birth).abs() < 1e-3;
        let near: Vec<&SpecialPoint> = branch.special_points().filter(at_birth).collect();
        prop_assert!(near.len() == 1 && near[0].kind() == SpecialKind::BranchPoint, "{near:?}");
        prop_assert!((near[0].value() - birth).abs() <= near[0].location_error().max(1e-12), "{near:?}");
        for point in &branch.points {
            if point.special.as_ref().is_some_and(|special| (special.value() - birth).abs() < 1e-3) {
                prop_assert!(point.stability == Stability::Undecided, "{point:?}");
            }
        }
    }
}
