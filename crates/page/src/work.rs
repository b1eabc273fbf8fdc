//! What the server computes: as many analyses at once as there are processors, in the order in which they were asked for, each under a
//! control that its client, its absence, or the end of the server stops.

use crate::failure::Failure;
use arclength_analysis::Control;
use axum::http::StatusCode;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::spawn_blocking;

/// Analyses that may wait for their turn.
const MOST_WAITING: usize = 512;

/// The analyses of a server. Clones are the same.
#[derive(Clone, Debug)]
pub struct Work(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    turns: Arc<Semaphore>,
    waiting: AtomicUsize,
    last: AtomicU64,
    running: Mutex<HashMap<u64, Arc<AtomicBool>>>,
    is_over: AtomicBool,
}

/// A turn to compute. While it lasts its number stops it.
#[derive(Debug)]
pub(crate) struct Turn {
    /// By what a client names it.
    pub number: u64,
    /// What stops it.
    pub stop: Arc<AtomicBool>,
    work: Work,
    _permit: OwnedSemaphorePermit,
}

impl Drop for Turn {
    fn drop(&mut self) {
        self.work.running().remove(&self.number);
    }
}

/// Stops a computation when it is dropped.
#[derive(Debug)]
pub(crate) struct StopOnDrop(pub Arc<AtomicBool>);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Leaves the queue however its waiting ends.
struct Waiting<'a>(&'a AtomicUsize);

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Work {
    pub(crate) fn new() -> Self {
        let at_once = std::thread::available_parallelism().map_or(1, usize::from);
        Self(Arc::new(Shared {
            turns: Arc::new(Semaphore::new(at_once)),
            waiting: AtomicUsize::new(0),
            last: AtomicU64::new(0),
            running: Mutex::default(),
            is_over: AtomicBool::new(false),
        }))
    }

    fn running(&self) -> MutexGuard<'_, HashMap<u64, Arc<AtomicBool>>> {
        self.0.running.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a turn. Who goes away before it comes loses nothing but the place.
    pub(crate) async fn turn(&self) -> Result<Turn, Failure> {
        let shared = &self.0;
        if shared.waiting.fetch_add(1, Ordering::Relaxed) >= MOST_WAITING {
            shared.waiting.fetch_sub(1, Ordering::Relaxed);
            let message = format!("{MOST_WAITING} computations are waiting already; try again later");
            return Err(Failure::new(StatusCode::TOO_MANY_REQUESTS, message));
        }
        let waiting = Waiting(&shared.waiting);
        let turn = Arc::clone(&shared.turns).acquire_owned().await;
        drop(waiting);
        let permit = turn.map_err(|_| over())?;
        let number = shared.last.fetch_add(1, Ordering::Relaxed) + 1;
        let stop = Arc::new(AtomicBool::new(false));
        self.running().insert(number, Arc::clone(&stop));
        let turn = Turn { number, stop, work: self.clone(), _permit: permit };
        // Whoever comes while the server ends must not keep it.
        if shared.is_over.load(Ordering::SeqCst) { Err(over()) } else { Ok(turn) }
    }

    /// Runs something short on a thread of its own and gives its answer. When nobody waits for that any more it is stopped.
    ///
    /// # Errors
    /// That of the computation, and too many that wait.
    pub async fn answer<A: Send + 'static>(
        &self,
        compute: impl FnOnce(&Control<'_>) -> Result<A, Failure> + Send + 'static,
    ) -> Result<A, Failure> {
        let turn = self.turn().await?;
        let _stopper = StopOnDrop(Arc::clone(&turn.stop));
        let computed = spawn_blocking(move || compute(&Control::unobserved(&turn.stop))).await;
        computed.unwrap_or_else(|_| Err(failed()))
    }

    /// Stops the computation with this number, if it still runs.
    pub(crate) fn stop(&self, number: u64) -> bool {
        let found = self.running().get(&number).cloned();
        found.as_ref().inspect(|stop| stop.store(true, Ordering::Relaxed)).is_some()
    }

    /// Stops everything and lets nothing begin.
    pub(crate) fn end(&self) {
        self.0.is_over.store(true, Ordering::SeqCst);
        self.0.turns.close();
        self.running().values().for_each(|stop| stop.store(true, Ordering::Relaxed));
    }
}

/// That the server ends.
fn over() -> Failure {
    Failure::new(StatusCode::SERVICE_UNAVAILABLE, "the server ends")
}

/// That a thread of the computation was lost.
pub(crate) fn failed() -> Failure {
    Failure::new(
        StatusCode::INTERNAL_SERVER_ERROR,
        "the computation broke down; this is a mistake of the program",
    )
}
