//! What a curve in two parameters is told in.

use crate::varying_parameter::VaryingParameter;

/// The parameters that vary along a curve, and the names of what is monitored.
#[derive(Clone, Debug)]
pub struct Quantities<'a> {
    /// The two parameters.
    pub plane: [VaryingParameter; 2],
    /// The monitors, in the order of their values.
    pub monitors: &'a [String],
    /// Words for what the curve may end at, in the order in which the engine counts it; without them the monitors.
    pub ends: Option<&'a [String]>,
}

impl From<[VaryingParameter; 2]> for Quantities<'_> {
    fn from(plane: [VaryingParameter; 2]) -> Self {
        Self { plane, monitors: &[], ends: None }
    }
}
