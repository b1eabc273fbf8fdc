//! The server: on the loopback address, until it is told to stop.

use crate::answer::Answer;
use crate::asset::{self, Asset};
use crate::failure::Failure;
use crate::guard::{LARGEST_BODY, guard};
use crate::routes::Routes;
use crate::sent_files::parse;
use crate::work::Work;
use axum::Router;
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, State};
use axum::http::StatusCode;
use axum::middleware::from_fn_with_state;
use axum::serve::ListenerExt;
use serde::Deserialize;
use serde_json::Value;
use std::future::IntoFuture;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tokio::time::{sleep, timeout};

/// Threads on which is computed: more than may compute at once, since those that are stopped may still be at their last step.
const MOST_THREADS: usize = 64;
/// How often is looked whether to stop.
const LOOK: Duration = Duration::from_millis(50);
/// How long is waited for answers under way when the server stops.
const PATIENCE: Duration = Duration::from_millis(400);

/// What a server gives.
#[derive(Debug)]
pub struct Site {
    /// The files of its pages.
    pub assets: Vec<Asset>,
    /// What it computes.
    pub routes: Routes,
    /// What its first page begins with, for its script to read.
    pub start: Value,
    /// What its routes are asked with and answer, as an OpenAPI document.
    pub description: Value,
}

impl Site {
    /// All that a server of this site can be asked.
    pub fn all_routes(&self) -> Routes {
        let start = self.start.clone();
        let description = self.description.clone();
        Routes::new()
            .get("/api/start", move || async move { Answer(start) })
            .get("/api/openapi.json", move || async move { Answer(description) })
            .post("/api/stop", stop)
            .merge(self.routes.clone())
    }
}

/// Why a server does not run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The port cannot be had.
    #[error("port {port} cannot be listened on: {source}; try: --port 0 for any free one")]
    Port {
        /// The port.
        port: u16,
        /// The cause.
        source: std::io::Error,
    },
    /// The system refuses what a server needs.
    #[error("the server cannot run: {0}")]
    System(#[from] std::io::Error),
}

/// A server that listens already.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
}

#[derive(Deserialize)]
struct StopRequest {
    run: u64,
}

async fn stop(State(work): State<Work>, body: Bytes) -> Result<Answer<bool>, Failure> {
    let StopRequest { run } = parse(&body)?;
    Ok(Answer(work.stop(run)))
}

impl Server {
    /// Listens on a port of the loopback address, on any free one with 0.
    ///
    /// # Errors
    /// [`ServeError::Port`].
    pub fn listen(port: u16) -> Result<Self, ServeError> {
        let failure = |source| ServeError::Port { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failure)?;
        let address = listener.local_addr().map_err(failure)?;
        listener.set_nonblocking(true).map_err(failure)?;
        Ok(Self { listener, address })
    }

    /// Where its page is.
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Serves a site until the flag is set. What is computed then ends.
    ///
    /// # Errors
    /// [`ServeError::System`].
    pub fn run(self, site: Site, flag: &'static AtomicBool) -> Result<(), ServeError> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .max_blocking_threads(MOST_THREADS)
            .build()?;
        let work = Work::new();
        let nothing = || async { Failure::new(StatusCode::NOT_FOUND, "there is nothing at this address") };
        let router = Router::new()
            .merge(site.all_routes().into_router())
            .merge(asset::routes(&site.assets))
            .fallback(nothing)
            .method_not_allowed_fallback(|| async {
                Failure::new(StatusCode::METHOD_NOT_ALLOWED, "this address is not asked in this way")
            })
            .layer(DefaultBodyLimit::max(LARGEST_BODY))
            .layer(from_fn_with_state(self.address.port(), guard))
            .with_state(work.clone());
        let outcome = runtime.block_on(async {
            // Events are small, and none waits for the next one.
            let listener = tokio::net::TcpListener::from_std(self.listener)?.tap_io(|connection| {
                let _ = connection.set_nodelay(true);
            });
            let ended = work.clone();
            let (told, is_told) = tokio::sync::oneshot::channel::<()>();
            let stopped = async move {
                while !flag.load(Ordering::Relaxed) {
                    sleep(LOOK).await;
                }
                ended.end();
                // The other side waits as long as this one.
                let _ = told.send(());
            };
            let serving =
                tokio::spawn(axum::serve(listener, router).with_graceful_shutdown(stopped).into_future());
            let _ = is_told.await;
            match timeout(PATIENCE, serving).await {
                Ok(Ok(served)) => served,
                // Connections that are kept open without asking for anything are given up.
                Ok(Err(_)) | Err(_) => Ok(()),
            }
        });
        runtime.shutdown_timeout(PATIENCE);
        Ok(outcome?)
    }
}
