//! What the paper leaves open, computed and drawn.
//!
//! Each study has a file here that computes, draws and tells its findings; figures are numbered from 7 on, after those of
//! the paper. A study returns plain data; [`StudyRequest::run`] turns them into files.

mod animation;
mod basin;
mod damping;
mod fate_color;
mod files;
mod isola;
mod name;
mod request;
mod result;
mod sliding;
mod step_steer;
mod study;
mod wheel;

pub use name::StudyName;
pub use request::StudyRequest;
pub use result::StudyResult;
pub use study::Finding;
