//! The parameters of a field, some of them replaced by unknowns.

use crate::differentiation::Scalar;

/// Calls `action` with the parameters, some of them replaced, without allocating for the usual numbers of them.
#[inline(always)]
pub(crate) fn with_parameters<T: Scalar, R>(
    parameters: &[f64],
    replaced: impl IntoIterator<Item = (usize, T)>,
    action: impl FnOnce(&[T]) -> R,
) -> R {
    // Dual numbers are large, so memory is not much more than is needed.
    match parameters.len() {
        0..=4 => with_memory::<T, R, 4>(parameters, replaced, action),
        5..=10 => with_memory::<T, R, 10>(parameters, replaced, action),
        11..=24 => with_memory::<T, R, 24>(parameters, replaced, action),
        count => action(fill(&mut vec![T::zero(); count], parameters, replaced)),
    }
}

#[inline(always)]
fn with_memory<T: Scalar, R, const MOST: usize>(
    parameters: &[f64],
    replaced: impl IntoIterator<Item = (usize, T)>,
    action: impl FnOnce(&[T]) -> R,
) -> R {
    action(fill(&mut [T::zero(); MOST][..parameters.len()], parameters, replaced))
}

#[inline(always)]
fn fill<'a, T: Scalar>(
    memory: &'a mut [T],
    parameters: &[f64],
    replaced: impl IntoIterator<Item = (usize, T)>,
) -> &'a [T] {
    for (entry, value) in memory.iter_mut().zip(parameters) {
        *entry = T::from(*value);
    }
    for (index, value) in replaced {
        memory[index] = value;
    }
    memory
}
