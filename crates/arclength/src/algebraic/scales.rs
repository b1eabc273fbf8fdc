//! Natural sizes of the state variables of a vector field, whatever their units.
//!
//! A change of units `x = D y` changes the Jacobian by a diagonal similarity, so balancing the Jacobian
//! (Osborne, *J. ACM* 7, 1960) tells the ratios of the units of variables that influence each other. The
//! absolute size comes from the state itself or, where that is zero, from the distance over which the
//! Jacobian changes by its own size.

use crate::differentiation::Dual;
use crate::erased::ErasedField;
use crate::integration::exact_jacobian;
use crate::linear::strong_components::strong_components;

/// A variable is at least this part of what the others, in its units, are.
const COUPLED_SHARE: f64 = 1e-2;
/// States smaller than this part of the distance over which the field is nonlinear count as zero,
const NONLINEAR_SHARE: f64 = 1e-3;
/// and their sizes are this part of it.
const AT_ZERO: f64 = 0.1;
/// Ratio of the change of the Jacobian over that distance to what its derivatives say, beyond which these say nothing about it: beside a
/// steep flank everything is flat.
const EXTRAPOLATES: f64 = 10.0;
/// Part of its size by which it changes over a distance that counts, where they say nothing.
const CHANGED: f64 = 0.3;
/// States smaller than this part of what drives them are zero but for rounding.
const ROUNDED: f64 = 1e-10;
/// Rates slower than this part of the fastest may be rounding of zero.
const SLOWEST: f64 = 1e-8;
/// A balanced influence of one state on another below this part of the fastest rate of their group is that of rounding (of which
/// balancing leaves the square root) or next to none.
const NO_INFLUENCE: f64 = 1e-6;
/// Part of a parameter's range that counts as next to a value,
const NEXT_TO: f64 = 0.02;
/// and part of a size below which the one there shows that it was an accident.
const ACCIDENTAL: f64 = 1e-5;
/// Sweeps of balancing.
const SWEEPS: usize = 30;

/// Sizes of the states at an equilibrium; `speed` is the derivative of the field with respect to the parameters times
/// their ranges (zero where nothing is known).
pub(crate) fn natural_scales(
    field: &ErasedField<'_>,
    state: &[f64],
    parameters: &[f64],
    speed: &[f64],
) -> Vec<f64> {
    let n = state.len();
    let (jacobian, lengths) = derivatives(field, state, parameters, speed);
    let (group, units) = groups_and_units(&jacobian, n);
    let mut nonlinear = nonlinear_lengths(&jacobian, &lengths, (&group, &units), state, speed);
    let around = Around { field, state, parameters, jacobian: &jacobian, units: &units };
    for index in 0..n {
        let (size, length) = (state[index].abs(), nonlinear[index]);
        let is_far = size < NONLINEAR_SHARE * length && length.is_finite();
        if is_far && !around.changes_as(&lengths, index, AT_ZERO * length) {
            nonlinear[index] = around.changing_length(index, size.max(ROUNDED * length), length);
        }
    }
    let mut scales: Vec<f64> = (0..n)
        .map(|index| {
            let members = || (0..n).filter(|&other| group[other] == group[index]);
            let own = |k: usize| state[k].abs().min(nonlinear[k]);
            let coupled = members().map(|k| own(k) / units[k]).fold(0.0, f64::max);
            let nonlinear = members().map(|k| nonlinear[k] / units[k]).fold(f64::INFINITY, f64::min);
            let (mut common, mut share) = (coupled, COUPLED_SHARE);
            if nonlinear.is_finite() && coupled < NONLINEAR_SHARE * nonlinear {
                // The states are next to zero and say nothing about their sizes.
                (common, share) = (AT_ZERO * nonlinear, 1.0);
            }
            if common == 0.0 {
                let rate = (0..n * n)
                    .filter(|entry| group[entry % n] == group[index] && group[entry / n] == group[index])
                    .map(|entry| (jacobian[entry] * units[entry / n] / units[entry % n]).abs())
                    .fold(0.0, f64::max);
                let driven = members().map(|k| speed[k].abs() / units[k]).fold(0.0, f64::max);
                (common, share) = (driven / rate, 1.0);
            }
            if !(common.is_finite() && common > 0.0) {
                (common, share) = (1.0, 1.0);
            }
            let scale = own(index).max(share * common * units[index]);
            if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
        })
        .collect();
    drive(&mut scales, &jacobian, &group);
    scales
}

/// Sizes of the states at an equilibrium from which a branch starts along the parameter `active`, which has a range of this width. Where
/// the parameter is a factor of what is nonlinear, as in `mu (1 - x^2) y`, the field may be linear, but for rounding, at the very
/// value of a Hopf point: the sizes are those next to it.
pub(crate) fn natural_scales_along(
    field: &ErasedField<'_>,
    state: &[f64],
    parameters: &[f64],
    (active, width): (usize, f64),
) -> Vec<f64> {
    let standing = vec![0.0; state.len()];
    let mut scales = natural_scales(field, state, parameters, &standing);
    for side in [-NEXT_TO, NEXT_TO] {
        let mut there = parameters.to_vec();
        there[active] += side * width;
        let mut value = vec![0.0; state.len()];
        field.evaluate(state, &there, &mut value);
        if value.iter().any(|entry| !entry.is_finite()) {
            continue;
        }
        for (here, there) in scales.iter_mut().zip(natural_scales(field, state, &there, &standing)) {
            if there < ACCIDENTAL * *here {
                *here = there;
            }
        }
    }
    scales
}

/// A state that is zero but for rounding, in a field that is linear in it, gets its size from the states of other groups that drive it.
fn drive(scales: &mut [f64], jacobian: &[f64], group: &[usize]) {
    let n = scales.len();
    let fastest = (0..n).map(|index| jacobian[index * (n + 1)].abs()).fold(0.0, f64::max);
    for _ in 0..n {
        let mut changed = false;
        for index in 0..n {
            let entry = |other: usize| (jacobian[index + n * other] * scales[other]).abs();
            let others = (0..n).filter(|&other| group[other] != group[index]);
            let inflow = others.map(entry).fold(0.0, f64::max);
            let members = (0..n).filter(|&other| group[other] == group[index]);
            // At a fold a rate may be rounding itself.
            let rate = members.map(entry).fold(0.0, f64::max) / scales[index];
            let driven = inflow / if rate > SLOWEST * fastest { rate } else { fastest };
            if driven.is_finite() && scales[index] < ROUNDED * driven {
                scales[index] = AT_ZERO * driven;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
}

/// The Jacobian and its first and second derivatives with respect to every state, the moduli of the latter two by
/// entry: index `entry + n * n * state`.
struct Derivatives {
    first: Vec<f64>,
    second: Vec<f64>,
}

/// The Jacobian around a state.
struct Around<'a> {
    field: &'a ErasedField<'a>,
    state: &'a [f64],
    parameters: &'a [f64],
    /// At the state itself.
    jacobian: &'a [f64],
    units: &'a [f64],
}

impl Around<'_> {
    /// The Jacobian away from the state in one direction.
    fn displaced(&self, index: usize, way: f64) -> Vec<f64> {
        let mut state = self.state.to_vec();
        state[index] += way;
        let parameters: Vec<_> = self.parameters.iter().map(|value| Dual::constant(*value)).collect();
        let mut jacobian = vec![0.0; self.jacobian.len()];
        let evaluate = |state: &[_], slope: &mut [_]| self.field.evaluate(state, &parameters, slope);
        exact_jacobian(evaluate, &state, &mut jacobian);
        jacobian
    }

    /// The largest balanced entry of a matrix.
    fn largest(&self, entry: impl Fn(usize) -> f64) -> f64 {
        let (n, units) = (self.units.len(), self.units);
        let balanced = (0..n * n).map(|place| entry(place).abs() * units[place / n] / units[place % n]);
        balanced.fold(0.0, f64::max)
    }

    /// Whether the balanced Jacobian changes over a distance in one state about as its derivatives say.
    fn changes_as(&self, derivatives: &Derivatives, index: usize, distance: f64) -> bool {
        let block = self.jacobian.len() * index;
        let expected = self.largest(|entry| {
            let [first, second] = [&derivatives.first, &derivatives.second].map(|of| of[block + entry]);
            first * distance + 0.5 * second * distance * distance
        });
        [-distance, distance].into_iter().any(|way| {
            let there = self.displaced(index, way);
            let change = self.largest(|entry| there[entry] - self.jacobian[entry]);
            let exists = there.iter().all(|entry| entry.is_finite());
            exists && change < EXTRAPOLATES * expected && expected < EXTRAPOLATES * change
        })
    }

    /// The first of distances in one state, each ten times the one before, over which the balanced Jacobian changes by a good part of its
    /// own size; infinite where it does so over none.
    fn changing_length(&self, index: usize, from: f64, until: f64) -> f64 {
        let linear = self.largest(|entry| self.jacobian[entry]);
        let changes = |distance: &f64| {
            [-distance, *distance].into_iter().any(|way| {
                let there = self.displaced(index, way);
                self.largest(|entry| there[entry] - self.jacobian[entry]) > CHANGED * linear
            })
        };
        let longer = |distance: &f64| Some(distance * 10.0).filter(|next| next > distance);
        let distances = std::iter::successors(Some(from), longer).skip(1);
        distances.take_while(|distance| *distance < until).find(changes).unwrap_or(f64::INFINITY)
    }
}

fn derivatives(
    field: &ErasedField<'_>,
    state: &[f64],
    parameters: &[f64],
    speed: &[f64],
) -> (Vec<f64>, Derivatives) {
    type Triple = Dual<Dual<Dual<f64, 1>, 1>, 1>;
    let n = state.len();
    debug_assert_eq!(speed.len(), n);
    let mut jacobian = vec![0.0; n * n];
    let mut found = Derivatives { first: vec![0.0; n * n * n], second: vec![0.0; n * n * n] };
    let constant = |value: f64| Triple::from(value);
    let parameters: Vec<Triple> = parameters.iter().map(|&value| constant(value)).collect();
    let mut unknown: Vec<Triple> = state.iter().map(|&value| constant(value)).collect();
    let mut image = vec![constant(0.0); n];
    for direction in 0..n {
        for column in 0..n {
            unknown[column].derivatives[0] = Dual::from(1.0);
            unknown[direction].value.derivatives[0] = Dual::from(1.0);
            unknown[direction].value.value.derivatives[0] = 1.0;
            field.evaluate(&unknown, &parameters, &mut image);
            for (row, value) in image.iter().enumerate() {
                let entry = row + n * column;
                let slope = value.derivatives[0];
                jacobian[entry] = slope.value.value;
                found.first[entry + n * n * direction] = slope.value.derivatives[0].abs();
                found.second[entry + n * n * direction] = slope.derivatives[0].derivatives[0].abs();
            }
            unknown[column] = constant(state[column]);
            unknown[direction] = constant(state[direction]);
        }
    }
    (jacobian, found)
}

/// For every state the distance over which the balanced Jacobian changes by its own size, all of it or that of the group of the state,
/// which has its own time scale; infinite where the field is linear in it.
fn nonlinear_lengths(
    jacobian: &[f64],
    derivatives: &Derivatives,
    (group, units): (&[usize], &[f64]),
    state: &[f64],
    speed: &[f64],
) -> Vec<f64> {
    let n = state.len();
    let length = |index: usize, counts: &dyn Fn(usize) -> bool| {
        let largest = |values: &mut dyn Iterator<Item = f64>| {
            values.map(f64::abs).filter(|value| value.is_finite()).fold(0.0, f64::max)
        };
        let balanced = |matrix: &[f64]| {
            let entries = matrix.iter().enumerate();
            let inside = entries.filter(|(entry, _)| counts(entry % n) && counts(entry / n));
            largest(&mut inside.map(|(entry, value)| value * units[entry / n] / units[entry % n]))
        };
        let linear = balanced(jacobian);
        let driven = largest(&mut (0..n).filter(|&row| counts(row)).map(|row| speed[row] / units[row]));
        let block = n * n * index..n * n * (index + 1);
        let quadratic = balanced(&derivatives.first[block.clone()]) * units[index];
        let cubic = balanced(&derivatives.second[block]) * units[index] * units[index];
        let by_quadratic = (linear / quadratic).max((driven / quadratic).sqrt());
        let by_cubic = (linear / cubic).sqrt().max((driven / cubic).cbrt());
        let length = by_quadratic.min(by_cubic) * units[index];
        if length > 0.0 { length } else { f64::INFINITY }
    };
    (0..n)
        .map(|index| {
            let all = length(index, &|_| true);
            let own = length(index, &|other| group[other] == group[index]);
            // That of the group counts where the state agrees with it: at a critical state of no size a rate is zero but for rounding.
            let size = state[index].abs();
            let agrees = size > NONLINEAR_SHARE * own && own > NONLINEAR_SHARE * size && size > ROUNDED * all;
            if agrees { all.min(own) } else { all }
        })
        .collect()
}

/// Groups of states that influence each other, and the units of all states. An influence that balancing leaves below
/// [`NO_INFLUENCE`] is none: at an invariant subspace rounding couples states that are not coupled.
fn groups_and_units(jacobian: &[f64], n: usize) -> (Vec<usize>, Vec<f64>) {
    let mut coupling = jacobian.to_vec();
    loop {
        let (group, _) = strong_components(&coupling, n);
        let units = balance(&coupling, n, &group);
        let balanced = |entry: usize| (jacobian[entry] * units[entry / n] / units[entry % n]).abs();
        let in_group = |entry: usize| group[entry % n] == group[entry / n];
        let mut changed = false;
        for entry in (0..n * n).filter(|&entry| in_group(entry) && entry % n != entry / n) {
            let members = |other: &usize| in_group(*other) && group[other % n] == group[entry % n];
            let rate = (0..n * n).filter(members).map(balanced).fold(0.0, f64::max);
            if coupling[entry] != 0.0 && balanced(entry) < NO_INFLUENCE * rate {
                coupling[entry] = 0.0;
                changed = true;
            }
        }
        if !changed {
            return (group, units);
        }
    }
}

/// Units `D` that make the rows and columns of `D^-1 J D` equally large within every group.
fn balance(jacobian: &[f64], n: usize, group: &[usize]) -> Vec<f64> {
    let mut units = vec![1.0_f64; n];
    for _ in 0..SWEEPS {
        let mut change = 0.0_f64;
        for index in 0..n {
            let (mut row, mut column) = (0.0, 0.0);
            for other in (0..n).filter(|&other| other != index && group[other] == group[index]) {
                row += (jacobian[index + n * other] * units[other] / units[index]).abs();
                column += (jacobian[other + n * index] * units[index] / units[other]).abs();
            }
            let factor = (row / column).sqrt();
            if factor.is_finite() && factor > 0.0 {
                units[index] *= factor;
                change = change.max(factor.ln().abs());
            }
        }
        if change < 1e-6 {
            break;
        }
    }
    units
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::differentiation::Scalar;
    use crate::field::VectorField;

    /// A pendulum driven by a current, in units `scale` times larger.
    struct Scaled([f64; 3]);

    impl VectorField for Scaled {
        fn state_names(&self) -> Vec<String> {
            ["angle", "rate", "current"].map(String::from).to_vec()
        }
        fn parameter_names(&self) -> Vec<String> {
            vec!["torque".into()]
        }
        fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
            let [a, b, c] = self.0;
            let (angle, rate, current) = (state[0] / a, state[1] / b, state[2] / c);
            derivative[0] = rate * a;
            derivative[1] = (-angle.sin() * 4.0 - rate * 0.1 + current) * b;
            derivative[2] = (parameters[0] - current * 3.0 - rate) * c;
        }
    }

    /// Predator and prey: without predators nothing changes that.
    struct Invariant;

    impl VectorField for Invariant {
        fn state_names(&self) -> Vec<String> {
            ["prey", "predator"].map(String::from).to_vec()
        }
        fn parameter_names(&self) -> Vec<String> {
            vec!["rate".into()]
        }
        fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
            let [prey, predator] = [state[0], state[1]];
            derivative[0] = prey * (-prey + 1.0) - prey * predator - parameters[0] * prey;
            derivative[1] = predator * prey * 3.0 - predator;
        }
    }

    #[test]
    fn rounding_next_to_an_invariant_subspace_does_not_count() {
        let exact = natural_scales(&Invariant.erased(), &[1.0 / 3.0, 0.0], &[0.1], &[1.0, 0.0]);
        for predator in [1e-36, -1e-25, 1e-17, -1e-15] {
            let scales = natural_scales(&Invariant.erased(), &[1.0 / 3.0, predator], &[0.1], &[1.0, 0.0]);
            for (scale, reference) in scales.iter().zip(&exact) {
                assert!((scale / reference - 1.0).abs() < 1e-6, "{scales:?} {exact:?}");
            }
        }
    }

    #[test]
    fn scales_follow_the_units() {
        for state in [[0.0; 3], [0.3, 0.0, 4.0 * 0.3f64.sin()]] {
            let reference = natural_scales(&Scaled([1.0; 3]).erased(), &state, &[0.5], &[0.0, 0.0, 1.0]);
            assert!(reference.iter().all(|scale| (1e-3..10.0).contains(scale)), "{reference:?}");
            let units = [1e-6, 1e3, 1e9];
            let scaled_state: Vec<f64> = state.iter().zip(units).map(|(x, unit)| x * unit).collect();
            let scaled = natural_scales(&Scaled(units).erased(), &scaled_state, &[0.5], &[0.0, 0.0, 1e9]);
            for index in 0..3 {
                let ratio = scaled[index] / (reference[index] * units[index]);
                assert!((ratio - 1.0).abs() < 1e-4, "{state:?} {index} {ratio}");
            }
        }
    }
}
