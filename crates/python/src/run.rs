//! Runs an analysis: on threads of its own, while the thread of Python that waits for it lets others run, listens to Ctrl-C and
//! tells the progress.

use crate::analyses;
use crate::errors::Failure;
use crate::pool;
use crate::result::NativeResult;
use arclength_analysis::{Control, Progress};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How often Python is asked for signals, and told the progress.
const TICK: Duration = Duration::from_millis(20);

/// Analyses that take less than waking a thread twice, on one thread, and tell no progress: they run where they are asked for.
const SHORT: [&str; 2] = ["kingpin.steady", "kingpin.stability"];

/// The last that was told of a computation: the part that is done, or where it is.
type Told = Arc<Mutex<Option<(Option<f64>, Option<String>)>>>;

/// Runs an analysis. Ctrl-C stops it: what there is of the result is the result then, where there is something.
#[pyfunction]
#[pyo3(signature = (analysis, request, threads = 0, progress = None))]
pub(crate) fn run_analysis(
    py: Python<'_>,
    analysis: String,
    request: String,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<NativeResult> {
    if SHORT.contains(&analysis.as_str()) {
        let run = || analyses::run(&analysis, &request, &Control::none());
        let outcome = py.detach(|| catch_unwind(AssertUnwindSafe(run)));
        return Ok(NativeResult::new(outcome.map_err(|_| mistake())??, false));
    }
    let stop = Arc::new(AtomicBool::new(false));
    let told: Told = Arc::default();
    let observed = progress.is_some();
    let (sender, receiver) = channel();
    // Whoever waits lets go of the interpreter, and only what can be shared may be used meanwhile.
    let receiver = Mutex::new(receiver);
    let pool = pool::of(threads)?;
    pool.spawn({
        let (stop, told) = (Arc::clone(&stop), Arc::clone(&told));
        move || {
            let observer = |progress: Progress<'_>| {
                if observed {
                    let progress = match progress {
                        Progress::Done(part) => (Some(part), None),
                        Progress::At(place) => (None, Some(place.to_owned())),
                    };
                    *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress);
                }
            };
            let control = Control::new(&stop, &observer);
            let outcome = catch_unwind(AssertUnwindSafe(|| analyses::run(&analysis, &request, &control)));
            // Nobody waits any more only where the interpreter is gone.
            let _ = sender.send(outcome);
        }
    });
    let mut stopped_by: Option<PyErr> = None;
    let outcome = loop {
        match py.detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK)) {
            Ok(outcome) => break outcome,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Failure::internal("the thread of the computation ended without a result").into());
            }
            Err(RecvTimeoutError::Timeout) if stopped_by.is_none() => {
                if let Err(error) = py.check_signals().and_then(|()| tell(py, progress.as_ref(), &told)) {
                    stop.store(true, Ordering::Relaxed);
                    stopped_by = Some(error);
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    };
    let outcome = outcome.map_err(|_| mistake())?;
    let by_signal = stopped_by.as_ref().is_some_and(|error| error.is_instance_of::<PyKeyboardInterrupt>(py));
    match (outcome, stopped_by) {
        (Ok(finished), None) => Ok(NativeResult::new(finished, false)),
        (Ok(finished), Some(_)) if by_signal => Ok(NativeResult::new(finished, true)),
        (Err(failure), None) => Err(failure.into()),
        (Err(failure), Some(_)) if by_signal => Err(Failure { class: "Interrupted", ..failure }.into()),
        // What a progress function raised.
        (_, Some(error)) => Err(error),
    }
}

fn mistake() -> Failure {
    Failure::internal("the computation failed by a mistake in the library")
}

/// Calls the progress function with what was told since the last time.
fn tell(py: Python<'_>, progress: Option<&Py<PyAny>>, told: &Told) -> PyResult<()> {
    let Some(progress) = progress else { return Ok(()) };
    let last = told.lock().unwrap_or_else(PoisonError::into_inner).take();
    match last {
        Some((part, place)) => progress.call1(py, (part, place)).map(|_| ()),
        None => Ok(()),
    }
}
