//! The phase plane of a model of two states: nullclines, directions, equilibria with their stability, and the manifolds of its saddles.
//!
//! Everything is found within a window. What is smaller than a cell of the grid that is laid over it may be missed: a closed nullcline, or
//! two equilibria in one cell.

mod drawing;
mod equilibria;
mod manifolds;
mod nullclines;
mod plane_field;

pub use equilibria::{EquilibriumKind, PlaneEquilibrium};
pub use manifolds::Manifold;

use crate::model::ChosenModel;
use plane_field::PlaneField;
use serde::{Deserialize, Serialize};

/// The phase plane of a model of two states that does not depend on the time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PhasePlane {
    /// Name of the state on the horizontal axis.
    pub x: String,
    /// Name of the state on the vertical axis.
    pub y: String,
    /// The least and the largest value on the horizontal and on the vertical axis.
    pub window: [[f64; 2]; 2],
    /// Polylines on which the state on the horizontal axis does not change.
    pub x_nullclines: Vec<Vec<[f64; 2]>>,
    /// Polylines on which the state on the vertical axis does not change.
    pub y_nullclines: Vec<Vec<[f64; 2]>>,
    /// The equilibria in the window; nothing where they form lines.
    pub equilibria: Option<Vec<PlaneEquilibrium>>,
    /// The stable and the unstable manifolds of the saddles.
    pub manifolds: Vec<Manifold>,
    /// The direction field on a grid.
    #[serde(default)]
    pub directions: Vec<Direction>,
}

/// The velocity at a place of the phase plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Direction {
    /// The states on both axes.
    pub at: [f64; 2],
    /// How fast they change.
    pub velocity: [f64; 2],
}

impl PhasePlane {
    /// The phase plane with these two states on its axes, in a window.
    pub(crate) fn of(chosen: &ChosenModel, axes: [usize; 2], window: [[f64; 2]; 2]) -> Self {
        let field = PlaneField::new(chosen, axes, window);
        let samples = nullclines::GridSamples::of(&field);
        let equilibria = equilibria::within(&field, &samples);
        let saddles = equilibria.iter().flatten().filter(|found| found.kind == EquilibriumKind::Saddle);
        let manifolds = saddles.flat_map(|saddle| manifolds::of(&field, saddle, equilibria.as_deref()));
        let [x_nullclines, y_nullclines] = [0, 1].map(|axis| {
            let curves = nullclines::zero_curves(&samples, axis, |point| field.velocity(point)[axis]);
            let points = |curve: Vec<[f64; 2]>| curve.into_iter().map(|point| field.point(point)).collect();
            curves.into_iter().map(points).collect()
        });
        let names = chosen.model.states();
        Self {
            x: names[axes[0]].clone(),
            y: names[axes[1]].clone(),
            window,
            x_nullclines,
            y_nullclines,
            manifolds: manifolds.collect(),
            directions: plane_field::places_of_arrows()
                .map(|place| Direction { at: field.point(place), velocity: field.speed(place) })
                .filter(|direction| direction.velocity.iter().all(|speed| speed.is_finite()))
                .collect(),
            equilibria,
        }
    }
}
