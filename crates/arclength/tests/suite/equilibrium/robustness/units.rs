//! Units of states, parameter and time change nothing.

use super::kinds;
use arclength::equilibrium::Equilibria;
use arclength::{Scalar, VectorField};
use proptest::prelude::*;

/// The chemical reaction of AUTO's demo `ab` in other units.
struct Reaction {
    units: [f64; 2],
    parameter_unit: f64,
    time_unit: f64,
}

impl VectorField for Reaction {
    fn state_names(&self) -> Vec<String> {
        vec!["conversion".into(), "temperature".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["D".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let (conversion, temperature) = (x[0] / self.units[0], x[1] / self.units[1]);
        let rate = p[0] / self.parameter_unit * (-conversion + 1.0) * temperature.exp();
        d[0] = (rate - conversion) * (self.units[0] / self.time_unit);
        d[1] = (rate * 18.0 - temperature * 4.0) * (self.units[1] / self.time_unit);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn units_do_not_matter(exponents in prop::collection::vec(-9.0..9.0f64, 4)) {
        let run = |exponents: &[f64]| {
            let field = Reaction {
                units: [10f64.powf(exponents[0]), 10f64.powf(exponents[1])],
                parameter_unit: 10f64.powf(exponents[2]),
                time_unit: 10f64.powf(exponents[3]),
            };
            let range = 0.0..=0.4 * field.parameter_unit;
            Equilibria::of(&field).parameters(&[0.0]).along("D", range).run().unwrap()
        };
        let (reference, scaled) = (run(&[0.0; 4]), run(&exponents));
        prop_assert_eq!(kinds(&reference), ["HB1", "LP1", "LP2", "HB2"]);
        prop_assert_eq!(kinds(&scaled), kinds(&reference));
        prop_assert!(scaled.points.len().abs_diff(reference.points.len()) < 3);
        for (one, other) in reference.special_points().zip(scaled.special_points()) {
            let ratio = other.value() / (one.value() * 10f64.powf(exponents[2]));
            prop_assert!((ratio - 1.0).abs() < 1e-12);
        }
    }
}
