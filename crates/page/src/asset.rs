//! The files of the page, which are part of the program.

use axum::Router;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::routing::get;

/// A file of the page.
#[derive(Clone, Copy, Debug)]
pub struct Asset {
    /// Where it is found, such as `/style.css`.
    pub path: &'static str,
    /// What it holds.
    pub text: &'static str,
}

impl Asset {
    /// What kind of text it is, by its ending.
    fn kind(self) -> &'static str {
        match self.path.rsplit_once('.') {
            Some((_, "css")) => "text/css; charset=utf-8",
            Some((_, "js")) => "text/javascript; charset=utf-8",
            Some((_, "svg")) => "image/svg+xml",
            _ => "text/html; charset=utf-8",
        }
    }
}

/// A router that gives the assets.
pub(crate) fn routes<S: Clone + Send + Sync + 'static>(assets: &[Asset]) -> Router<S> {
    assets.iter().fold(Router::new(), |router, &asset| {
        // A newer program at the same address must not be shown an older page.
        let answer =
            move || async move { ([(CONTENT_TYPE, asset.kind()), (CACHE_CONTROL, "no-cache")], asset.text) };
        router.route(asset.path, get(answer))
    })
}
