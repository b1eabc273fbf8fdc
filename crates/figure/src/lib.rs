//! kingpin-figure
