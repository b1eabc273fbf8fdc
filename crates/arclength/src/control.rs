//! What a long computation tells whoever waits for it, and how it is stopped.
//!
//! Everything that may take longer than a tenth of a second takes a [`Control`]. It tells its progress as plain data, from
//! whatever thread it runs on, and looks at a flag that anybody may set: a signal handler, another thread, the observer
//! itself. What is stopped gives the error [`Interrupted`], or a result that says so, and never half a number.
//!
//! ```
//! use arclength::control::{Control, Interrupted, Progress};
//! use std::sync::atomic::{AtomicBool, Ordering};
//!
//! /// The sum of the first numbers.
//! fn sum(count: u64, control: &Control<'_>) -> Result<u64, Interrupted> {
//!     (0..count).try_fold(0, |sum, number| {
//!         control.check()?;
//!         control.done(number as f64 / count as f64);
//!         Ok(sum + number)
//!     })
//! }
//!
//! assert_eq!(sum(1000, &Control::none()), Ok(499_500));
//!
//! let stop = AtomicBool::new(false);
//! let observer = |progress: Progress<'_>| {
//!     if progress == Progress::Done(0.5) {
//!         stop.store(true, Ordering::Relaxed);
//!     }
//! };
//! assert_eq!(sum(1000, &Control::new(&stop, &observer)), Err(Interrupted));
//! ```

use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How far a computation has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress<'a> {
    /// The part that is done, from 0 to 1.
    Done(f64),
    /// Where it is, in words, where the part that is done is not known.
    At(&'a str),
}

/// A computation was stopped before it had its result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

/// Under what a computation runs: an observer that is told its progress, and a flag that stops it.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    stop: &'a AtomicBool,
    observer: &'a (dyn Fn(Progress<'_>) + Sync),
    /// The part of the whole that this computation is: where it begins, and its length.
    begin: f64,
    length: f64,
}

impl Control<'static> {
    /// A control that tells nobody and never stops.
    pub const fn none() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self::unobserved(&NEVER)
    }
}

impl<'a> Control<'a> {
    /// A control with an observer. Whoever sets the flag stops the computation.
    pub const fn new(stop: &'a AtomicBool, observer: &'a (dyn Fn(Progress<'_>) + Sync)) -> Self {
        Self { stop, observer, begin: 0.0, length: 1.0 }
    }

    /// A control that tells nobody.
    pub const fn unobserved(stop: &'a AtomicBool) -> Self {
        Self::new(stop, &|_| {})
    }

    /// The same control for a part of the computation, which begins and ends where the whole is so far, from 0 to 1.
    pub const fn part(&self, of: Range<f64>) -> Self {
        let Self { stop, observer, begin, length } = *self;
        Self { stop, observer, begin: begin + length * of.start, length: length * (of.end - of.start) }
    }

    /// The same flag with nobody who is told: for parts whose own progress says nothing of the whole.
    pub const fn quiet(&self) -> Self {
        Self::unobserved(self.stop)
    }

    /// Tells the part that is done, from 0 to 1.
    pub fn done(&self, part: f64) {
        (self.observer)(Progress::Done(self.begin + self.length * part));
    }

    /// Tells where the computation is.
    pub fn at(&self, place: &str) {
        (self.observer)(Progress::At(place));
    }

    /// Counts the parts of a computation that consists of `total` equal ones.
    pub const fn count(&self, total: usize) -> Counter<'a> {
        Counter { control: *self, total, done: AtomicUsize::new(0) }
    }

    /// Asks whether to go on.
    ///
    /// # Errors
    /// [`Interrupted`] if not.
    pub fn check(&self) -> Result<(), Interrupted> {
        if self.is_stopped() { Err(Interrupted) } else { Ok(()) }
    }

    /// Asks whether to go on, as observers answer.
    pub fn flow(&self) -> ControlFlow<()> {
        if self.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Whether the computation is to stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The flag that stops the computation.
    pub const fn stop(&self) -> &'a AtomicBool {
        self.stop
    }
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Control").field("stop", &self.stop).finish_non_exhaustive()
    }
}

/// Counts what is done of many equal parts, from any thread, and tells it.
#[derive(Debug)]
pub struct Counter<'a> {
    control: Control<'a>,
    total: usize,
    done: AtomicUsize,
}

impl Counter<'_> {
    /// Adds parts that are done.
    pub fn advance(&self, parts: usize) {
        let done = self.done.fetch_add(parts, Ordering::Relaxed) + parts;
        self.control.done(done as f64 / self.total as f64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn parts_of_parts_are_told_as_parts_of_the_whole() {
        let told = Mutex::new(Vec::new());
        let observer = |progress: Progress<'_>| {
            if let Progress::Done(part) = progress {
                told.lock().unwrap().push(part);
            }
        };
        let stop = AtomicBool::new(false);
        let control = Control::new(&stop, &observer);
        control.part(0.5..1.0).part(0.0..0.5).done(0.5);
        control.quiet().done(0.9);
        let half = control.part(0.0..0.5);
        let counter = half.count(2);
        counter.advance(1);
        counter.advance(1);
        assert_eq!(*told.lock().unwrap(), [0.625, 0.25, 0.5]);
    }

    #[test]
    fn a_flag_stops_computations_on_other_threads() {
        let stop = AtomicBool::new(false);
        let control = Control::unobserved(&stop);
        std::thread::scope(|scope| {
            let waiting = scope.spawn(|| {
                while control.check().is_ok() {
                    std::thread::yield_now();
                }
                control.flow()
            });
            stop.store(true, Ordering::Relaxed);
            assert_eq!(waiting.join().unwrap(), ControlFlow::Break(()));
        });
        assert!(Control::none().check().is_ok());
    }
}
