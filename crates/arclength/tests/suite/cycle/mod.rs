//! Branches of limit cycles.

mod errors;
mod held;
mod hybrid;
mod kinks;
mod neutral_families;
mod normal_forms;
mod published;
mod robustness;
mod weak_hopf;
mod wheel;
