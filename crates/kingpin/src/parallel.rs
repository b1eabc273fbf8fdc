//! The same work on many things, spread over the threads of the pool.
//!
//! What rayon makes of a loop is compiled once, here, and not once for every loop of the wheel's crates. And where rayon returns whichever
//! failure it meets first, these loops return that of the first thing in order, however many threads there are.

use rayon::prelude::*;
use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Returns what becomes of every item, in their order.
///
/// ```
/// assert_eq!(kingpin::parallel::map(&[1, 2, 3], |number| number * number), [1, 4, 9]);
/// ```
pub fn map<I: Sync, T: Send>(items: &[I], of: impl Fn(&I) -> T + Sync) -> Vec<T> {
    let Ok(all) = try_map(items, |item| Ok::<_, Infallible>(of(item)));
    all
}

/// Returns what becomes of every item, in their order, or the failure of the first item that fails. What comes after a failure
/// need not be computed.
///
/// # Errors
/// That of the first item, in their order, that fails.
///
/// ```
/// let halves = |number: &u32| if number % 2 == 0 { Ok(number / 2) } else { Err(format!("{number} is odd")) };
/// assert_eq!(kingpin::parallel::try_map(&[2, 4], halves), Ok(vec![1, 2]));
/// assert_eq!(kingpin::parallel::try_map(&[2, 3, 5], halves), Err("3 is odd".to_owned()));
/// ```
pub fn try_map<I: Sync, T: Send, E: Send>(
    items: &[I],
    of: impl Fn(&I) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    try_map_indices(items.len(), |index| of(&items[index]))
}

/// The same for the numbers below `count`.
///
/// # Errors
/// As [`try_map`].
pub fn try_map_indices<T: Send, E: Send>(
    count: usize,
    of: impl Fn(usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let slots: Vec<Mutex<Option<Result<T, E>>>> = (0..count).map(|_| Mutex::new(None)).collect();
    let first_failure = AtomicUsize::new(usize::MAX);
    for_each(count, &|index| {
        if index > first_failure.load(Ordering::Relaxed) {
            return;
        }
        let outcome = of(index);
        if outcome.is_err() {
            first_failure.fetch_min(index, Ordering::Relaxed);
        }
        *unlocked(slots[index].lock()) = Some(outcome);
    });
    slots.into_iter().filter_map(|slot| unlocked(slot.into_inner())).collect()
}

/// Changes every item, or returns the failure of the first one, in their order, that fails.
///
/// # Errors
/// As [`try_map`].
pub(crate) fn try_change<I: Send, E: Send>(
    items: &mut [I],
    change: impl Fn(&mut I) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let items: Vec<Mutex<&mut I>> = items.iter_mut().map(Mutex::new).collect();
    try_map(&items, |item| {
        let mut item = unlocked(item.lock());
        change(&mut item)
    })
    .map(drop)
}

fn for_each(count: usize, action: &(dyn Fn(usize) + Sync)) {
    // One by one: some of what is computed here takes seconds.
    (0..count).into_par_iter().with_max_len(1).for_each(action);
}

// A lock is poisoned by a panic under it only, which is on its way up already.
fn unlocked<T>(lock: Result<T, PoisonError<T>>) -> T {
    lock.unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_failure_is_that_of_the_first_item_on_any_number_of_threads() {
        let items: Vec<usize> = (0..200).collect();
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            for first in [0, 17, 150] {
                // Later failures are quicker.
                let of = |&item: &usize| {
                    std::thread::sleep(std::time::Duration::from_micros(200 - item as u64));
                    if item >= first && item % 3 != 1 { Err(item) } else { Ok(item) }
                };
                let expected = (first..).find(|item| item % 3 != 1).unwrap();
                assert_eq!(pool.install(|| try_map(&items, of)), Err(expected));
            }
        }
    }

    #[test]
    fn every_item_is_changed() {
        let mut items: Vec<u32> = (0..100).collect();
        try_change(&mut items, |item| {
            *item += 1;
            Ok::<_, ()>(())
        })
        .unwrap();
        assert_eq!(items, (1..101).collect::<Vec<_>>());
    }
}
