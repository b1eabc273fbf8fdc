//! kingpin
