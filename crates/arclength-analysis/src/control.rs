//! What a running analysis tells whoever asked for it, and how it is stopped.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// How far an analysis has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress<'a> {
    /// The part that is done, from 0 to 1.
    Done(f64),
    /// Where it is, in words, where the part that is done is not known.
    At(&'a str),
}

/// Under what an analysis runs: an observer that is told its progress, and a flag that stops it.
///
/// ```
/// use arclength_analysis::Control;
/// use std::sync::atomic::{AtomicBool, Ordering};
/// let stop = AtomicBool::new(false);
/// let control = Control::new(&stop, &|progress| println!("{progress:?}"));
/// assert!(control.flow().is_continue());
/// stop.store(true, Ordering::Relaxed);
/// assert!(control.flow().is_break());
/// ```
#[derive(Clone, Copy)]
pub struct Control<'a> {
    stop: &'a AtomicBool,
    observer: &'a (dyn Fn(Progress<'_>) + Sync),
}

impl<'a> Control<'a> {
    /// A control with an observer. Whoever sets the flag stops the analysis at the step that it is at.
    pub fn new(stop: &'a AtomicBool, observer: &'a (dyn Fn(Progress<'_>) + Sync)) -> Self {
        Self { stop, observer }
    }

    /// A control that tells nobody.
    pub fn unobserved(stop: &'a AtomicBool) -> Self {
        Self { stop, observer: &|_| {} }
    }

    /// Tells the part that is done, from 0 to 1.
    pub fn done(&self, part: f64) {
        (self.observer)(Progress::Done(part));
    }

    /// Tells where the analysis is.
    pub fn at(&self, place: &str) {
        (self.observer)(Progress::At(place));
    }

    /// Whether to go on.
    pub fn flow(&self) -> ControlFlow<()> {
        if self.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Whether the analysis is to stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The flag that stops the analysis.
    pub fn stop(&self) -> &'a AtomicBool {
        self.stop
    }
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Control").field("stop", &self.stop).finish_non_exhaustive()
    }
}
