//! arclength-ode
