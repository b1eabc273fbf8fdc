//! Points of codimension two on curves of special cycles: resonances of torus bifurcations by Newton's method at their angle,
//! the others by the secant method on their test functions.

use super::curve::{CycleLocusCurve, CycleLocusInspection, test_value};
use super::monitor;
use crate::branch::SpecialKind;
use crate::continuation::events::Location;
use crate::continuation::{Curve, Equations, Solution, along, fix, locate_value, metric_image};
use crate::error::Error;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Part of a bracket to which a point of codimension two is located by the secant method.
const LOCATION: f64 = 1e-12;
/// A test function that is not this much smaller than at the ends of the bracket has a pole there and no zero.
const POLE: f64 = 1e-3;
/// A coefficient this many times what it is at the ends of a bracket has a pole between them.
const POLE_GROWTH: f64 = 30.0;
/// A test function made of multipliers, which is at most one, is zero below this where the curve starts at a special point.
const ZERO: f64 = 1e-10;
/// Part of that below which a trial point is as good as the zero.
const NEGLIGIBLE: f64 = 1e-2;
/// At a cusp both parameters turn: their speed there is at most this part of that at the ends of the bracket.
const TURN: f64 = 1e-2;

/// Distance, in parts of their ranges, of the parameters of one point on two sides of a resonance.
const SAME_PLACE: f64 = 1e-7;

/// What a change of sign of a test function turned out to be.
enum Zero {
    /// A point at which it vanishes, and the size that its test function has there: its value, or the noise in it.
    At(Box<Solution<CycleLocusInspection>>, f64),
    /// A coefficient goes through infinity.
    Pole,
    /// No point was located.
    Missed,
}

impl CycleLocusCurve<'_> {
    /// The point of codimension two between two solutions at which a test function changes its sign.
    ///
    /// # Errors
    /// When the multipliers of a solution cannot be computed.
    pub(super) fn point_of_codimension_two(
        &mut self,
        kind: SpecialKind,
        [before, after]: [&Solution<CycleLocusInspection>; 2],
    ) -> Result<Location<CycleLocusInspection>, Error> {
        let found = match self.at_resonance(kind, [before, after])? {
            Some(found) => Zero::At(Box::new(found), 0.0),
            None => self.zero(kind, [before, after])?,
        };
        let (mut solution, value) = match found {
            Zero::At(solution, value) => (*solution, value),
            Zero::Pole => return Ok(Location::Nothing),
            Zero::Missed => return Ok(Location::Missed),
        };
        let multipliers: Vec<Complex64> =
            solution.point.floquet.nontrivial.iter().map(|multiplier| multiplier.to_complex()).collect();
        if !monitor::is_genuine(kind, self.kind(), &multipliers) {
            return Ok(Location::Nothing);
        }
        // At a point where the coefficient has a pole, rounding is all that is left of it.
        let size = |solution: &Solution<CycleLocusInspection>| solution.point.coefficient.map(f64::abs);
        let ends = size(before).into_iter().chain(size(after)).fold(0.0, f64::max);
        solution.point.coefficient =
            solution.point.coefficient.filter(|value| value.abs() <= POLE_GROWTH * ends);
        // The parameters are known as well as the test function: its slope along the bracket gives the error.
        let noise = if monitor::is_coefficient(kind) {
            solution.point.error_estimate * solution.point.natural_coefficient
        } else {
            solution.point.floquet.trivial_error
        };
        let slope = modulus(before, kind).max(modulus(after, kind)).max(f64::MIN_POSITIVE);
        let part = LOCATION.max(value.max(noise) / slope).min(1.0);
        let end = solution.unknown.len();
        solution.point.location_error = Some([2, 1].map(|place| {
            let change = (after.unknown[end - place] - before.unknown[end - place]).abs();
            (part * change).max(f64::EPSILON * solution.unknown[end - place].abs())
        }));
        Ok(Location::At(solution))
    }

    /// The resonance between two solutions of a curve of torus bifurcations, whose angle is an unknown; `None` for other kinds,
    /// and where Newton's method leads elsewhere.
    fn at_resonance(
        &mut self,
        kind: SpecialKind,
        [before, after]: [&Solution<CycleLocusInspection>; 2],
    ) -> Result<Option<Solution<CycleLocusInspection>>, Error> {
        let resonant = match kind {
            SpecialKind::Resonance3 => TAU / 3.0,
            SpecialKind::Resonance4 => FRAC_PI_2,
            _ => return Ok(None),
        };
        let (Some(from), Some(to)) = (self.angle(before), self.angle(after)) else { return Ok(None) };
        let middle = 0.5 * (from + to);
        // Past 0 and pi the angle goes on.
        let angles = [resonant, -resonant].map(|angle| angle + TAU * ((middle - angle) / TAU).round());
        let Some(angle) = angles.into_iter().find(|angle| (from - angle) * (to - angle) <= 0.0) else {
            return Ok(None);
        };
        match self.at_angle([before, after], angle) {
            Ok(found) => {
                let place = along(self, before, &found.unknown) / along(self, before, &after.unknown);
                Ok((0.0..=1.0).contains(&place).then_some(found))
            }
            Err(Error::NotFound { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// The solution between two others at which the angle of a torus bifurcation has a value.
    fn at_angle(
        &mut self,
        [before, after]: [&Solution<CycleLocusInspection>; 2],
        angle: f64,
    ) -> Result<Solution<CycleLocusInspection>, Error> {
        let (from_end, settings) = (self.angle_from_end(), self.settings);
        fix(self, before, after, from_end, angle, &settings)
    }

    /// Whether a curve of torus bifurcations whose angle passes that of a strong resonance between two solutions comes back on itself
    /// behind it, with the eigenfunctions conjugate: then the parameters are the same on both sides. `None` where it cannot be told.
    pub(super) fn comes_back(
        &mut self,
        [before, after]: [&Solution<CycleLocusInspection>; 2],
        resonance: f64,
    ) -> Option<bool> {
        let (from, to) = (self.angle(before)?, self.angle(after)?);
        let (nearer, angle) = if (from - resonance).abs() < (to - resonance).abs() {
            (before, 2.0 * resonance - from)
        } else {
            (after, 2.0 * resonance - to)
        };
        let mirrored = self.at_angle([before, after], angle).ok()?;
        let end = mirrored.unknown.len();
        Some([2, 1].into_iter().zip(self.system.parameter_scales).all(|(place, scale)| {
            (mirrored.unknown[end - place] - nearer.unknown[end - place]).abs() < SAME_PLACE * scale
        }))
    }

    /// The point at which a test function vanishes between two solutions.
    fn zero(
        &mut self,
        kind: SpecialKind,
        [before, after]: [&Solution<CycleLocusInspection>; 2],
    ) -> Result<Zero, Error> {
        let is_coefficient = monitor::is_coefficient(kind);
        let zero = if is_coefficient { ZERO * after.point.natural_coefficient } else { ZERO };
        let mut largest = 0.0_f64;
        let test = |_: &mut Self, solution: &Solution<CycleLocusInspection>| {
            let value = test_value(solution, kind);
            largest = value.map_or(largest, |value| largest.max(value.abs()));
            value
        };
        let (settings, tolerances) = (self.settings, (LOCATION, NEGLIGIBLE * zero));
        let mut found = match locate_value(self, [before, after], &settings, tolerances, test) {
            Ok(Some(found)) => found,
            Ok(None) | Err(Error::NotFound { .. }) => return Ok(Zero::Missed),
            Err(error) => return Err(error),
        };
        // The test function of a coefficient is small where its factors are: the coefficient itself has to be.
        let size = |solution: &Solution<CycleLocusInspection>| match solution.point.coefficient {
            Some(value) if is_coefficient => value.abs(),
            _ => modulus(solution, kind),
        };
        let ends = [size(before), size(after)];
        if size(&found) > POLE * ends[0].min(ends[1]) && size(&found) > zero {
            let ends = [before, after].map(|solution| modulus(solution, kind));
            let is_pole = is_coefficient && largest > POLE_GROWTH * ends[0].max(ends[1]);
            return Ok(if is_pole { Zero::Pole } else { Zero::Missed });
        }
        let smallest = modulus(&found, kind);
        if kind == SpecialKind::CuspOfCycles {
            let speed = |solution: &Solution<CycleLocusInspection>| {
                let [one, other] = self.parameter_speeds(solution);
                one.hypot(other)
            };
            if speed(&found) > TURN * speed(before).max(speed(after)) {
                return Ok(Zero::Missed);
            }
        }
        let border = metric_image(self, &found.tangent);
        let mut residual = vec![0.0; found.unknown.len()];
        if self.factorize(&found.unknown, &border, &mut residual) != 0.0 {
            self.measure(&mut found);
        }
        Ok(Zero::At(Box::new(found), smallest))
    }
}

/// Modulus of a test function, infinite where it does not exist.
fn modulus(solution: &Solution<CycleLocusInspection>, kind: SpecialKind) -> f64 {
    test_value(solution, kind).map_or(f64::INFINITY, f64::abs)
}
