//! Motions of models that jump, switch and slide.

mod borders;
mod events;
mod history;
mod slides;
mod switches;
