//! The search between two solutions, and what it finds.

use super::event::{Event, Unlocated};
use super::memory::Memory;
use super::node::Node;
use super::scan::Scan;
use crate::continuation::{Bound, Curve, Settings};
use crate::error::Error;

/// Special points between two solutions, in the order of the curve, and what could not be located.
pub(crate) struct Events<C: Curve + ?Sized> {
    pub found: Vec<Event<C::Kind, C::Point>>,
    pub unlocated: Vec<Unlocated<C::Kind>>,
}

impl<C: Curve> Default for Events<C> {
    fn default() -> Self {
        Self { found: Vec::new(), unlocated: Vec::new() }
    }
}

/// Special points between two solutions, in order.
pub(super) fn search<C: Curve>(
    curve: &mut C,
    ends: [&mut Node<C>; 2],
    memory: &Memory,
    bounds: &[Bound],
    settings: &Settings,
) -> Result<Events<C>, Error> {
    let settings = settings.for_locating();
    let mut scan = Scan::new(curve, memory, bounds, &settings);
    let found = scan.verified(ends)?;
    let unlocated = scan.unlocated;
    Ok(Events { found, unlocated })
}
