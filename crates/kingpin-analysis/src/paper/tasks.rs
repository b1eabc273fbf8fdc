//! Counts the tasks of a run that are done.

use crate::error::{Error, unless_stopped};
use arclength_analysis::Control;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The tasks of a run under a control.
pub(super) struct Tasks<'a> {
    control: &'a Control<'a>,
    done: AtomicUsize,
    total: usize,
}

impl<'a> Tasks<'a> {
    /// So many tasks.
    pub(super) fn new(control: &'a Control<'a>, total: usize) -> Self {
        Self { control, done: AtomicUsize::new(0), total }
    }

    /// That one more is done.
    ///
    /// # Errors
    /// [`Error::Stopped`] where the control says so.
    pub(super) fn step(&self) -> Result<(), Error> {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.control.done(done as f64 / self.total as f64);
        unless_stopped(self.control)
    }
}
