//! Curves of special equilibria as plain data.

use super::codimension_two::CodimensionTwoPoint;
use super::curve::EquilibriumLocusInspection;
use crate::branch::{Branch, Label, Labelled};
use crate::continuation::Solution;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::convert::Infallible;

/// A point on a curve of special equilibria.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocusPoint {
    /// Values of the two parameters that vary.
    pub values: [f64; 2],
    /// The equilibrium.
    pub state: Vec<f64>,
    /// Eigenvalues by descending real part.
    pub eigenvalues: Vec<Complex64>,
    /// On a curve of Hopf points the angular frequency; `None` where the curve consists of neutral saddles.
    pub frequency: Option<f64>,
    /// First Lyapunov coefficient (Kuznetsov's scaling) of a Hopf point.
    pub first_lyapunov: Option<f64>,
    /// Label of a point of codimension two or of a value asked for.
    pub label: Option<Label>,
    /// Values of the test functions by the label of the point at which each changes sign.
    pub tests: Vec<(Cow<'static, str>, f64)>,
    /// Values of the monitors, in the order in which they were asked for; not a number where one does not exist.
    #[serde(default)]
    pub monitors: Vec<f64>,
    /// What is known about a point of codimension two.
    pub special: Option<Box<CodimensionTwoPoint>>,
}

/// A curve of special equilibria in two parameters.
pub type EquilibriumLocusBranch = Branch<LocusPoint, Infallible>;

impl Labelled for LocusPoint {
    fn label(&self) -> Option<Label> {
        self.label
    }

    fn values(&self) -> Vec<f64> {
        self.values.to_vec()
    }
}

impl EquilibriumLocusBranch {
    /// Points of codimension two in the order of the curve.
    pub fn special_points(&self) -> impl Iterator<Item = &CodimensionTwoPoint> {
        self.points.iter().filter_map(|point| point.special.as_deref())
    }
}

impl LocusPoint {
    /// A solution of a curve in a field of `dimension` states. `swapped` says that the unknowns hold the second parameter that
    /// was asked for first.
    pub(super) fn new(
        solution: &Solution<EquilibriumLocusInspection>,
        label: Option<Label>,
        (dimension, swapped): (usize, bool),
    ) -> Self {
        let EquilibriumLocusInspection { spectrum, monitor, special } = &solution.point;
        let end = solution.unknown.len() - 2;
        let mut values = [solution.unknown[end], solution.unknown[end + 1]];
        let mut special = special.clone();
        if swapped {
            values.swap(0, 1);
            if let Some(special) = &mut special {
                special.values.swap(0, 1);
                special.location_error.swap(0, 1);
                special.active.swap(0, 1);
            }
        }
        Self {
            values,
            state: solution.unknown[..dimension].to_vec(),
            eigenvalues: spectrum.eigenvalues.clone(),
            frequency: monitor.frequency,
            first_lyapunov: monitor.first_lyapunov,
            label,
            tests: monitor.tests.iter().map(|(kind, reading)| (kind.label().into(), reading.value)).collect(),
            monitors: Vec::new(),
            special,
        }
    }
}
