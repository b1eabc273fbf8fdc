//! Motions of models that jump, switch and slide.

mod events;
mod history;
mod slides;
