//! The threads on which analyses run: a pool of this process, started when it is first needed.
//!
//! A process that was forked has none of the threads of its parent, so that a pool is good for the process that started it only. What a
//! parent started is left alone there: its locks may be held by threads that no longer exist.

use pyo3::PyResult;
use pyo3::exceptions::PyRuntimeError;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes of the stack of a thread: as much as the main thread of a program has.
const STACK: usize = 8 << 20;

struct Pool {
    process: u32,
    asked: usize,
    threads: Arc<ThreadPool>,
}

/// It is only locked by who holds the interpreter, as who forks does: no fork finds it locked.
static POOL: Mutex<Option<Pool>> = Mutex::new(None);

/// The pool with so many threads; 0 is as many as the machine has processors.
pub(crate) fn of(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = pool.as_ref()
        && known.process == process
        && known.asked == threads
    {
        return Ok(Arc::clone(&known.threads));
    }
    let started = ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build();
    let started =
        started.map_err(|error| PyRuntimeError::new_err(format!("cannot start threads: {error}")))?;
    let started = Arc::new(started);
    let former = pool.replace(Pool { process, asked: threads, threads: Arc::clone(&started) });
    if let Some(former) = former.filter(|former| former.process != process) {
        std::mem::forget(former);
    }
    Ok(started)
}
