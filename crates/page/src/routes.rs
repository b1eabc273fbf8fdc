//! What a server can be asked: its routes, each known by how and where it is asked, so that its description can be held against them.

use crate::guard::only_json;
use crate::work::Work;
use axum::Router;
use axum::handler::Handler;
use axum::middleware::from_fn;
use axum::routing::{get, post};

/// How and where something is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Address {
    /// `get` or `post`.
    pub method: &'static str,
    /// The path, such as `/api/model`.
    pub path: &'static str,
}

/// Routes that know their addresses.
#[derive(Clone, Debug, Default)]
pub struct Routes {
    router: Router<Work>,
    addresses: Vec<Address>,
}

impl Routes {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// What is only fetched.
    pub fn get<H: Handler<T, Work>, T: 'static>(mut self, path: &'static str, handler: H) -> Self {
        self.addresses.push(Address { method: "get", path });
        self.router = self.router.route(path, get(handler));
        self
    }

    /// What is asked with a body.
    pub fn post<H: Handler<T, Work>, T: 'static>(mut self, path: &'static str, handler: H) -> Self {
        self.addresses.push(Address { method: "post", path });
        self.router = self.router.route(path, post(handler).route_layer(from_fn(only_json)));
        self
    }

    /// These and others.
    pub fn merge(mut self, other: Self) -> Self {
        self.addresses.extend(other.addresses);
        self.router = self.router.merge(other.router);
        self
    }

    /// Where they are.
    pub fn addresses(&self) -> &[Address] {
        &self.addresses
    }

    pub(crate) fn into_router(self) -> Router<Work> {
        self.router
    }
}
