//! The page: models, their branches and motions in a browser on this machine.
//!
//! [`Server`] listens on the loopback address alone and gives [`Asset`]s, which are part of the program, and the answers of its
//! routes. A route takes a request of an analysis, the same plain data that the command line asks with, together with the earlier
//! results that it names, and runs it among the [`Work`] of the server: with bounded concurrency, ended when nobody waits for it any
//! more. The server keeps nothing of what it computed and no route touches a file: what a request names as a file is what came with it.
//!
//! [`model_site`] is the page for any `.ode` model. Nothing here knows a wheel; whoever does adds assets and routes of its own.

mod answer;
mod asset;
mod browser;
mod colors;
mod drawing;
mod failure;
mod guard;
mod look;
mod model;
mod openapi;
mod picture;
mod routes;
mod sent_files;
mod server;
mod stream;
mod work;

pub use answer::Answer;
pub use asset::Asset;
pub use browser::open;
pub use colors::OwnColors;
pub use failure::Failure;
pub use look::Look;
pub use model::{StartModel, model_site};
pub use openapi::joined;
pub use picture::{PictureAnswer, drawn, saved};
pub use routes::{Address, Routes};
pub use sent_files::{Asked, parse};
pub use server::{ServeError, Server, Site};
pub use stream::Events;
pub use work::Work;
