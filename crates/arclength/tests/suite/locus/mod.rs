//! Curves of special points in two parameters: of equilibria and of cycles.

mod cycles;
mod equilibria;
