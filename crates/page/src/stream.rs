//! Results that grow: events (`text/event-stream`) with every point as it is found, and the finished result.
//!
//! The events of a computation are, in this order: `run` with its number, by which it can be stopped; any number of `warning`,
//! `progress` and `point`; then `result` with the text of the result file, or `failure`.

use crate::failure::Failure;
use crate::work::{StopOnDrop, Work, failed};
use arclength_analysis::{Control, FoundPoint, Progress};
use axum::body::{Body, Bytes};
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use futures_core::Stream;
use kingpin_report::{Report, json};
use serde::Serialize;
use std::convert::Infallible;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::sync::{mpsc, oneshot};
use tokio::task::spawn_blocking;

/// Events that may wait for the client before the computation waits too.
const MOST_EVENTS: usize = 256;
/// Fewest samples of a cycle that is sent for drawing.
const CYCLE_SAMPLES: usize = 120;

/// Where a computation tells its events.
#[derive(Debug)]
pub struct Events {
    sender: mpsc::Sender<Bytes>,
    stop: Arc<AtomicBool>,
}

/// A cycle to be drawn: numbers of single precision.
#[derive(Serialize)]
struct DrawnOrbit {
    period: f64,
    t: Vec<f32>,
    /// A list for every state.
    states: Vec<Vec<f32>>,
}

/// A point of a branch to be drawn.
#[derive(Serialize)]
struct DrawnPoint<'a> {
    values: &'a [f64],
    max: &'a [f64],
    min: &'a [f64],
    stable: Option<bool>,
    label: Option<String>,
    orbit: Option<DrawnOrbit>,
}

impl DrawnPoint<'_> {
    fn orbit(point: &FoundPoint<'_>) -> Option<DrawnOrbit> {
        let orbit = point.orbit.filter(|orbit| orbit.mesh.len() > 1)?;
        // As many samples in each mesh interval: they are where something happens.
        let parts = CYCLE_SAMPLES.div_ceil(orbit.mesh.len() - 1);
        let mut times: Vec<f64> = Vec::new();
        for ends in orbit.mesh.windows(2) {
            times.extend((0..parts).map(|part| ends[0] + (ends[1] - ends[0]) * part as f64 / parts as f64));
        }
        times.push(1.0);
        let mut states = vec![Vec::with_capacity(times.len()); orbit.dimension];
        for time in &times {
            let state = orbit.state_at(time * orbit.period);
            states.iter_mut().zip(state).for_each(|(list, value)| list.push(value as f32));
        }
        let t = times.iter().map(|time| (time * orbit.period) as f32).collect();
        Some(DrawnOrbit { period: orbit.period, t, states })
    }
}

impl Events {
    /// Tells an event. A client that went away stops the computation.
    pub fn tell(&self, kind: &str, text: &str) {
        let lines = text.split('\n').map(|line| format!("data: {line}\n"));
        let event = format!("event: {kind}\n{}\n", lines.collect::<String>());
        if self.sender.blocking_send(event.into()).is_err() {
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    /// Tells something that is serialised.
    pub fn tell_data<T: Serialize>(&self, kind: &str, data: &T) {
        if let Ok(text) = serde_json::to_string(data) {
            self.tell(kind, &text);
        }
    }

    /// Computes something, which is stopped after some time; says whether it was.
    pub fn within<A>(&self, longest: Duration, compute: impl FnOnce() -> A) -> (A, bool) {
        let (done, is_done) = std::sync::mpsc::channel::<()>();
        std::thread::scope(|scope| {
            let alarm = scope.spawn(move || {
                let is_late = is_done.recv_timeout(longest) == Err(RecvTimeoutError::Timeout);
                if is_late {
                    self.stop.store(true, Ordering::Relaxed);
                }
                is_late
            });
            let answer = compute();
            drop(done);
            (answer, alarm.join().unwrap_or(false))
        })
    }

    /// Tells what is worth knowing.
    pub fn warn_of(&self, warnings: &[String]) {
        warnings.iter().for_each(|warning| self.tell("warning", warning));
    }

    /// Tells a point of a branch.
    pub fn point(&self, point: FoundPoint<'_>) {
        self.tell_data(
            "point",
            &DrawnPoint {
                values: point.values,
                max: point.max,
                min: point.min,
                stable: point.stable,
                label: point.label.map(|label| label.to_string()),
                orbit: DrawnPoint::orbit(&point),
            },
        );
    }

    /// Tells the text of a result file, the same bytes that the command line writes.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn result<R: Report>(&self, result: &R) -> Result<(), Failure> {
        let mut text = Vec::new();
        json::write(result, &mut text).map_err(|error| Failure::of_analysis(&error))?;
        self.tell("result", &String::from_utf8_lossy(&text));
        Ok(())
    }
}

impl Work {
    /// Prepares a computation on a thread of its own, answers with what is wrong with it, or runs it and answers with its events. It
    /// is stopped when the client goes away.
    ///
    /// # Errors
    /// That of the preparation, and too many computations that wait.
    pub async fn stream<P, C>(&self, prepare: P) -> Result<Response, Failure>
    where
        P: FnOnce() -> Result<C, Failure> + Send + 'static,
        C: FnOnce(&Control<'_>, &Events) -> Result<(), Failure>,
    {
        let turn = self.turn().await?;
        let stopper = StopOnDrop(Arc::clone(&turn.stop));
        let (sender, receiver) = mpsc::channel(MOST_EVENTS);
        let (prepared, is_prepared) = oneshot::channel();
        spawn_blocking(move || {
            let compute = match prepare() {
                Ok(compute) => compute,
                Err(failure) => {
                    // Where nobody waits for it nobody misses it.
                    let _ = prepared.send(Err(failure));
                    return;
                }
            };
            let _ = prepared.send(Ok(()));
            let events = Events { sender, stop: Arc::clone(&turn.stop) };
            events.tell("run", &turn.number.to_string());
            let observer = |progress: Progress<'_>| {
                if let Progress::Done(part) = progress {
                    events.tell_data("progress", &part);
                }
            };
            if let Err(failure) = compute(&Control::new(&turn.stop, &observer), &events) {
                events.tell("failure", &failure.json());
            }
            // The turn ends before the stream does: who has read to the end finds nothing that runs.
            drop(turn);
            drop(events);
        });
        is_prepared.await.unwrap_or_else(|_| Err(failed()))?;
        let body = Body::from_stream(Received { receiver, _stopper: stopper });
        Ok(([(CONTENT_TYPE, "text/event-stream"), (CACHE_CONTROL, "no-store")], body).into_response())
    }
}

/// The events as the body of an answer.
struct Received {
    receiver: mpsc::Receiver<Bytes>,
    _stopper: StopOnDrop,
}

impl Stream for Received {
    type Item = Result<Bytes, Infallible>;

    fn poll_next(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        self.receiver.poll_recv(context).map(|event| event.map(Ok))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_takes_too_long_is_stopped_and_what_does_not_is_not() {
        let (sender, _receiver) = mpsc::channel(1);
        let events = Events { sender, stop: Arc::default() };
        assert_eq!(events.within(Duration::from_secs(60), || 1), (1, false));
        assert!(!events.stop.load(Ordering::Relaxed));
        let wait = || {
            while !events.stop.load(Ordering::Relaxed) {
                std::thread::yield_now();
            }
        };
        assert_eq!(events.within(Duration::from_millis(20), wait), ((), true));
    }
}
