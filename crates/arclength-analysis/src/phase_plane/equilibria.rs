//! The equilibria in a window of the plane, with their kind.

use super::nullclines::GridSamples;
use super::plane_field::PlaneField;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Most equilibria that are told apart; more are taken for lines of equilibria.
const MOST: usize = 40;
/// Most places from which equilibria are sought.
const MOST_STARTS: usize = 2000;
/// Equilibria closer than this part of the window are one.
const SAME: f64 = 1e-6;
/// Rates below this part of the fastest one are not told from zero.
const NO_RATE: f64 = 1e-9;

/// What an equilibrium of the plane is, by its eigenvalues.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EquilibriumKind {
    /// Two negative real eigenvalues.
    StableNode,
    /// A complex pair with a negative real part.
    StableFocus,
    /// Two positive real eigenvalues.
    UnstableNode,
    /// A complex pair with a positive real part.
    UnstableFocus,
    /// Real eigenvalues of both signs.
    Saddle,
    /// An imaginary pair: the linear field does not say whether it is stable.
    Centre,
    /// An eigenvalue is zero: the linear field does not say whether it is stable.
    Degenerate,
}

/// An equilibrium of the plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlaneEquilibrium {
    /// What the state on the horizontal axis is there.
    pub x: f64,
    /// What the state on the vertical axis is there.
    pub y: f64,
    /// What it is.
    pub kind: EquilibriumKind,
    /// Its eigenvalues, real and imaginary parts.
    pub eigenvalues: [[f64; 2]; 2],
    /// Where it lies in the square.
    #[serde(skip)]
    pub(super) place: [f64; 2],
}

/// The equilibria; nothing where there are so many that they form lines.
pub(super) fn within(field: &PlaneField<'_>, samples: &GridSamples) -> Option<Vec<PlaneEquilibrium>> {
    let starts = samples.standstills();
    if starts.len() > MOST_STARTS {
        return None;
    }
    let mut places: Vec<[f64; 2]> = Vec::new();
    for start in starts {
        let Some(place) = field.equilibrium(start) else { continue };
        let inside = place.iter().all(|value| (-SAME..=1.0 + SAME).contains(value));
        let is_new = places.iter().all(|known| (known[0] - place[0]).hypot(known[1] - place[1]) > SAME);
        if inside && is_new {
            places.push(place);
        }
        if places.len() > MOST {
            return None;
        }
    }
    // Where the field has no derivatives nothing is known of the motions beside it.
    let is_smooth =
        |found: &PlaneEquilibrium| found.eigenvalues.iter().flatten().all(|part| part.is_finite());
    Some(places.into_iter().map(|place| equilibrium(field, place)).filter(is_smooth).collect())
}

fn equilibrium(field: &PlaneField<'_>, place: [f64; 2]) -> PlaneEquilibrium {
    let [x, y] = field.point(place);
    let eigenvalues = eigenvalues(field.jacobian(place));
    PlaneEquilibrium {
        x,
        y,
        kind: kind(eigenvalues),
        eigenvalues: eigenvalues.map(|value| [value.re, value.im]),
        place,
    }
}

/// The eigenvalues of a matrix given row by row, the larger real part first.
pub(super) fn eigenvalues([[a, b], [c, d]]: [[f64; 2]; 2]) -> [Complex64; 2] {
    let mean = 0.5 * (a + d);
    // The product of the eigenvalues' distances from their mean, without cancellation where they are alike.
    let discriminant = (0.5 * (a - d)).powi(2) + b * c;
    if discriminant < 0.0 {
        let frequency = (-discriminant).sqrt();
        return [Complex64::new(mean, frequency), Complex64::new(mean, -frequency)];
    }
    let larger = mean + mean.signum() * discriminant.sqrt();
    let smaller = if larger == 0.0 { 0.0 } else { (a * d - b * c) / larger };
    let (high, low) = if larger > smaller { (larger, smaller) } else { (smaller, larger) };
    [Complex64::new(high, 0.0), Complex64::new(low, 0.0)]
}

fn kind([one, two]: [Complex64; 2]) -> EquilibriumKind {
    let negligible = NO_RATE * one.norm().max(two.norm());
    let is_pair = one.im != 0.0;
    match (one.re > negligible, two.re < -negligible) {
        (true, true) => EquilibriumKind::Saddle,
        _ if is_pair && one.re.abs() <= negligible => EquilibriumKind::Centre,
        (true, _) if is_pair => EquilibriumKind::UnstableFocus,
        (_, true) if is_pair => EquilibriumKind::StableFocus,
        (true, _) if two.re > negligible => EquilibriumKind::UnstableNode,
        (_, true) if one.re < -negligible => EquilibriumKind::StableNode,
        _ => EquilibriumKind::Degenerate,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_those_of_the_eigenvalues() {
        for (matrix, right) in [
            ([[0.0, 1.0], [1.0, 0.0]], EquilibriumKind::Saddle),
            ([[0.0, 1.0], [-1.0, 0.0]], EquilibriumKind::Centre),
            ([[0.1, 1.0], [-1.0, 0.1]], EquilibriumKind::UnstableFocus),
            ([[-0.1, 1.0], [-1.0, -0.1]], EquilibriumKind::StableFocus),
            ([[2.0, 1.0], [0.0, 1.0]], EquilibriumKind::UnstableNode),
            ([[-2.0, 1.0], [0.0, -1.0]], EquilibriumKind::StableNode),
            ([[-2.0, 1.0], [0.0, 0.0]], EquilibriumKind::Degenerate),
            ([[0.0, 1.0], [0.0, 0.0]], EquilibriumKind::Degenerate),
            ([[0.0, 0.0], [0.0, 0.0]], EquilibriumKind::Degenerate),
        ] {
            assert_eq!(kind(eigenvalues(matrix)), right, "{matrix:?}");
        }
        let [high, low] = eigenvalues([[1e8, 0.0], [1.0, 1e-8]]).map(|value| value.re);
        assert_eq!((high, low), (1e8, 1e-8));
    }
}
