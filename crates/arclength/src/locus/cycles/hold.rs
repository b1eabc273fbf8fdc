//! The condition that a quantity keeps its value, as one more row of the equations of a cycle in two parameters.
//!
//! The quantity is any function of the cycle, so that its row of the Jacobian is not known entry by entry; along two directions it
//! is: by a difference quotient. The equations are therefore factorised with another condition in its place, linear in the
//! scalars, and corrected by what the quantity says along the direction in which only that condition changes.

use crate::continuation::{Equations, norm};
use crate::cycle::Orbit;
use crate::cycle::locating::DefiningCurve;
use crate::locus::held::Held;

/// Step of a difference quotient, in the metric of the curve: its error is the square of this, relative to the rates.
const STEP: f64 = 1e-5;
/// Part of a direction that the scalars have at least where they are to tell it from others.
const VISIBLE: f64 = 1e-3;

/// The condition, with what the last factorisation left.
pub(super) struct Hold {
    held: Held,
    value: f64,
    /// Unknowns at which the Jacobian was factorised last.
    place: Vec<f64>,
    /// The direction in which only the condition in its place changes, and the rate of the quantity along it.
    direction: Vec<f64>,
    rate: f64,
}

impl Hold {
    pub(super) fn new(held: Held, value: f64) -> Self {
        Self { held, value, place: Vec::new(), direction: Vec::new(), rate: f64::NAN }
    }

    /// The quantity on the cycle that unknowns describe, not a number where it does not exist.
    fn quantity(&self, system: &DefiningCurve<'_>, unknown: &[f64]) -> f64 {
        let problem = &system.collocation.problem;
        let [states @ .., period, one, other] = unknown else { return f64::NAN };
        let mut parameters = problem.parameters.clone();
        for (index, value) in [Some(problem.active), problem.second].into_iter().flatten().zip([one, other]) {
            parameters[index] = *value;
        }
        let orbit = Orbit {
            mesh: system.collocation.mesh().to_vec(),
            degree: system.collocation.gauss().degree(),
            dimension: problem.scales.len(),
            states: states.to_vec(),
            period: *period,
        };
        self.held.of(&orbit, &parameters).unwrap_or(f64::NAN)
    }

    /// The rate of change of the quantity along a direction, where the Jacobian was factorised last.
    fn along(&self, system: &DefiningCurve<'_>, direction: &[f64]) -> f64 {
        let length = norm(system, direction, &mut vec![0.0; direction.len()]);
        if length == 0.0 {
            return 0.0;
        }
        let step = STEP / length;
        let [ahead, behind] = [step, -step].map(|step| {
            let moved: Vec<f64> =
                self.place.iter().zip(direction).map(|(value, slope)| value + step * slope).collect();
            self.quantity(system, &moved)
        });
        (ahead - behind) / (2.0 * step)
    }

    /// Writes its residual in place of that of the condition in its place.
    pub(super) fn add_residual(&self, system: &DefiningCurve<'_>, unknown: &[f64], residual: &mut [f64]) {
        let row = residual.len() - 2;
        residual[row] = self.quantity(system, unknown) - self.value;
    }

    /// As [`Curve::factorize`].
    pub(super) fn factorize(
        &mut self,
        system: &mut DefiningCurve<'_>,
        unknown: &[f64],
        border: &[f64],
        residual: &mut [f64],
    ) -> f64 {
        system.collocation.problem.stand_in = self.stand_in(system, border);
        let sign = system.factorize(unknown, border, residual);
        if sign == 0.0 {
            return 0.0;
        }
        self.add_residual(system, unknown, residual);
        self.place = unknown.to_vec();
        self.direction = vec![0.0; unknown.len()];
        self.direction[unknown.len() - 2] = 1.0;
        system.solve(&mut self.direction);
        self.rate = self.along(system, &self.direction);
        // By Cramer's rule the two determinants differ by this factor.
        if self.rate.is_finite() && self.rate != 0.0 { sign * self.rate.signum() } else { 0.0 }
    }

    /// As [`Curve::solve`].
    pub(super) fn solve(&self, system: &mut DefiningCurve<'_>, right_hand_side: &mut [f64]) {
        let row = right_hand_side.len() - 2;
        let wanted = std::mem::take(&mut right_hand_side[row]);
        system.solve(right_hand_side);
        self.change_by(wanted, system, right_hand_side);
    }

    /// Moves a vector along the direction in which only the condition in its place changes, so that the quantity changes by
    /// `wanted` along it.
    pub(super) fn change_by(&self, wanted: f64, system: &DefiningCurve<'_>, vector: &mut [f64]) {
        let missing = (wanted - self.along(system, vector)) / self.rate;
        for (entry, slope) in vector.iter_mut().zip(&self.direction) {
            *entry += missing * slope;
        }
    }

    /// Coefficients of the condition in its place: those of the scalars along the direction of the last factorisation, or of
    /// the parameter that the border says least about.
    fn stand_in(&self, system: &DefiningCurve<'_>, border: &[f64]) -> [f64; 3] {
        let problem = &system.collocation.problem;
        let scales = [problem.period_scale, system.parameter_scales[0], system.parameter_scales[1]];
        let scaled = |vector: &[f64], index: usize| vector[vector.len() - 3 + index] / scales[index];
        if self.direction.len() == border.len() {
            let length = norm(system, &self.direction, &mut vec![0.0; border.len()]);
            let parts = [0, 1, 2].map(|index| scaled(&self.direction, index) / length);
            let size = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
            if size > VISIBLE {
                return [0, 1, 2].map(|index| parts[index] / size / scales[index]);
            }
        }
        let shown = |index: usize| (border[border.len() - 3 + index] * scales[index]).abs();
        let place = if shown(1) < shown(2) { 1 } else { 2 };
        let mut factors = [0.0; 3];
        factors[place] = 1.0 / scales[place];
        factors
    }
}
