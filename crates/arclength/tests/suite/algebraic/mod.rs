//! Curves of solutions of algebraic systems.

mod maps;
