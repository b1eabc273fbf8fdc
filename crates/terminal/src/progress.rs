//! Progress bars on standard error, where that is a terminal.

use arclength_analysis::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// Parts that a bar is divided into.
const PARTS: u64 = 1000;
/// Time between two pictures of a spinner.
const SPIN: Duration = Duration::from_millis(100);

/// A bar for a part of the work that is done, or a spinner where that is not known.
#[derive(Debug)]
pub struct ProgressDisplay {
    bar: ProgressBar,
}

impl ProgressDisplay {
    /// A bar from nothing to all.
    pub fn bar(what: &'static str, quiet: bool) -> Self {
        Self::new(ProgressBar::new(PARTS), "{msg} [{bar:40}] {percent} % {elapsed}", what, quiet)
    }

    /// A spinner with a message that changes.
    pub fn spinner(what: &'static str, quiet: bool) -> Self {
        let progress = Self::new(ProgressBar::no_length(), "{spinner} {msg} {elapsed}", what, quiet);
        // What nobody sees needs no thread that turns it.
        if !progress.bar.is_hidden() {
            progress.bar.enable_steady_tick(SPIN);
        }
        progress
    }

    fn new(bar: ProgressBar, template: &str, what: &'static str, quiet: bool) -> Self {
        // Hidden by itself where standard error is no terminal.
        bar.set_draw_target(if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() });
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(what);
        Self { bar }
    }

    /// Shows how far an analysis has come.
    pub fn show(&self, progress: Progress<'_>) {
        match progress {
            Progress::Done(part) => self.bar.set_position((part.clamp(0.0, 1.0) * PARTS as f64) as u64),
            Progress::At(place) => self.bar.set_message(place.to_owned()),
        }
    }
}

impl Drop for ProgressDisplay {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
