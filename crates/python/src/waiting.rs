//! Waits for what is written or drawn while other threads of Python run, and listens to Ctrl-C meanwhile.

use crate::errors::Failure;
use kingpin_report::ReportError;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How often Python is asked for signals.
const TICK: Duration = Duration::from_millis(20);
/// How long what leaves nothing behind is waited for once it was stopped; what is drawn looks at no flag, and ends by itself.
pub(crate) const GRACE: Duration = Duration::from_millis(100);
/// The same of what has begun a file, which is gone when it ends: it looks at the flag.
pub(crate) const UNTIL_GONE: Duration = Duration::from_secs(10);

/// Does something on a thread of its own. Ctrl-C sets the flag that it is given, and is raised when it has ended, or after the grace.
pub(crate) fn unless_interrupted<T: Send + 'static>(
    py: Python<'_>,
    grace: Duration,
    work: impl FnOnce(&AtomicBool) -> Result<T, ReportError> + Send + 'static,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, receiver) = channel();
    let its_own = Arc::clone(&stop);
    std::thread::spawn(move || {
        // Nobody waits any more where it was stopped.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(|| work(&its_own))));
    });
    // Whoever waits lets go of the interpreter, and only what can be shared may be used meanwhile.
    let receiver = Mutex::new(receiver);
    let wait = |time: Duration| {
        let of = |receiver: &Receiver<_>| receiver.recv_timeout(time);
        py.detach(|| of(&receiver.lock().unwrap_or_else(PoisonError::into_inner)))
    };
    loop {
        match wait(TICK) {
            Ok(Ok(outcome)) => return Ok(outcome.map_err(Failure::from)?),
            Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => {
                return Err(
                    Failure::internal("a result could not be written by a mistake in the library").into()
                );
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(error) = py.check_signals() {
            stop.store(true, Ordering::Relaxed);
            let was_done = matches!(wait(grace), Ok(Ok(Ok(_))));
            if was_done || !error.is_instance_of::<PyKeyboardInterrupt>(py) {
                return Err(error);
            }
            return Err(Failure::interrupted(&ReportError::Stopped).into());
        }
    }
}
