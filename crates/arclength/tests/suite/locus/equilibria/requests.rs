//! Requests that make no sense.

use super::{Cusp, equilibria_of_the_cusp};
use arclength::locus::EquilibriumLocus;

#[test]
fn bad_requests_are_refused() {
    let branch = equilibria_of_the_cusp();
    let fold = branch.folds().next().unwrap();
    let message = |asked: EquilibriumLocus<'_>| asked.run().unwrap_err().to_string();
    let ask = || EquilibriumLocus::of(&Cusp).from_fold(fold);
    assert!(message(ask()).contains("two parameters"));
    assert!(message(ask().along("beta1", -1.0..=1.0)).contains("two parameters"));
    assert!(message(ask().along("beta1", -1.0..=1.0).and("beta1", -1.0..=2.0)).contains("different"));
    assert!(
        message(ask().along("beta1", -1.0..=1.0).and("gamma", -1.0..=2.0)).contains("one of beta1, beta2")
    );
    assert!(message(ask().along("beta1", -1.0..=1.0).and("beta2", 2.0..=3.0)).contains("contains 1"));
    let unstarted = EquilibriumLocus::of(&Cusp).along("beta1", -1.0..=1.0).and("beta2", -1.0..=2.0);
    assert!(message(unstarted).contains("a fold"));
}
