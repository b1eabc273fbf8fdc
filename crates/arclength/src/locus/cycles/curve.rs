//! A curve of special cycles as continuation sees it.

use super::monitor;
use crate::branch::SpecialKind;
use crate::continuation::{Adaptation, CorrectionFailure, Curve, Ending, Settings, Solution, Stop, locate};
use crate::cycle::Resolution;
use crate::cycle::collocation::Collocation;
use crate::cycle::defining::Kind;
use crate::cycle::eigenfunctions::Eigenfunctions;
use crate::cycle::extrema::{Range, ranges};
use crate::cycle::floquet::{Floquet, floquet};
use crate::cycle::limit_cycle::LimitCycle;
use crate::cycle::locating::{DefiningCurve, component_scales, split};
use crate::cycle::mesh::{error_profile, fit_mesh};
use crate::cycle::normal_form::CriticalCycle;
use crate::cycle::problem::PeriodicProblem;
use crate::cycle::sizes::StateSizes;
use crate::error::Error;
use crate::linear::periodic_schur::PeriodicSchur;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Sizes of eigenfunctions in the metric, so that they count less than states and parameters.
const EIGENFUNCTION_WEIGHT: f64 = 10.0;
/// The sizes are measured anew when one has changed by this factor.
const SIZE_CHANGE: f64 = 1.5;
/// Part of a bracket to which a point of codimension two is located by the secant method.
const LOCATION: f64 = 1e-12;
/// A test function that is not this much smaller than at the ends of the bracket has a pole there and no zero.
const POLE: f64 = 1e-3;

/// A point at which a test function vanishes, with error estimates of the two parameters.
type Zero = (Solution<Inspection>, [f64; 2]);

/// A test function made of multipliers, which is at most one, is zero below this where the curve starts at a special point.
const ZERO: f64 = 1e-10;
/// Distance of the angle from that of a resonance within which it counts as there.
const AT_RESONANCE: f64 = 1e-6;

/// What is known about a point of the curve.
#[derive(Clone, Debug)]
pub(super) struct Inspection {
    pub error_estimate: f64,
    pub floquet: Floquet,
    pub ranges: Vec<Range>,
    pub mesh: Vec<f64>,
    pub tests: Vec<(SpecialKind, f64)>,
    /// Coefficient of the normal form.
    pub coefficient: Option<f64>,
    /// What that coefficient counts against.
    pub natural_coefficient: f64,
    /// Argument of the multipliers of a torus bifurcation.
    pub argument: Option<f64>,
    /// A point of codimension two, with error estimates of the two parameters.
    pub special: Option<(SpecialKind, [f64; 2])>,
}

/// The curve of one kind of special cycles in two parameters.
pub(super) struct CycleLocusCurve<'a> {
    pub system: DefiningCurve<'a>,
    /// The cycle alone, for its multipliers and normal form.
    base: Collocation<LimitCycle<'a>>,
    resolution: Resolution,
    settings: Settings,
    states: usize,
    second: usize,
    sizes: StateSizes,
    error_estimate: f64,
    schur: Option<(usize, PeriodicSchur)>,
}

impl<'a> CycleLocusCurve<'a> {
    pub fn new(
        mut system: DefiningCurve<'a>,
        base: Collocation<LimitCycle<'a>>,
        sizes: StateSizes,
        second: usize,
        resolution: Resolution,
        settings: Settings,
    ) -> Self {
        let states = system.collocation.problem.scales.len();
        let kind = system.collocation.problem.kind;
        system.scales = component_scales(&system.collocation.problem.scales, kind, EIGENFUNCTION_WEIGHT);
        Self {
            system,
            base,
            resolution,
            settings,
            states,
            second,
            sizes,
            error_estimate: f64::INFINITY,
            schur: None,
        }
    }

    pub fn kind(&self) -> Kind {
        self.system.collocation.problem.kind
    }

    /// Measures the sizes of the states; whether they have changed so much that the normalisation has to follow.
    fn rescale(&mut self, cycle: &[f64]) -> bool {
        let mut changed = false;
        let sizes = self.sizes.measure(&cycle[..cycle.len() - 3]);
        for (old, size) in self.system.collocation.problem.scales.iter_mut().zip(sizes) {
            let ratio = size.scale / *old;
            if size.scale > 0.0 && ratio.is_finite() && !(1.0 / SIZE_CHANGE..=SIZE_CHANGE).contains(&ratio) {
                *old = size.scale;
                changed = true;
            }
        }
        if changed {
            let scales = self.system.collocation.problem.scales.clone();
            self.system.scales = component_scales(&scales, self.kind(), EIGENFUNCTION_WEIGHT);
            self.base.problem.scales = scales;
        }
        changed
    }

    /// Sizes against which errors count: of the states their own, of eigenfunctions their largest one in units of the states.
    fn error_scales(&self, functions: &Eigenfunctions) -> Vec<f64> {
        let scales = &self.system.collocation.problem.scales;
        let mut all = scales.clone();
        for function in &functions.0 {
            let largest = function
                .chunks_exact(self.states)
                .flat_map(|state| state.iter().zip(scales).map(|(value, scale)| (value / scale).abs()))
                .fold(0.0, f64::max)
                .max(f64::MIN_POSITIVE);
            all.extend(scales.iter().map(|scale| scale * largest));
        }
        all
    }

    /// Coefficient of the normal form, and what it counts against; the base has just been factorised.
    fn coefficient(&self, cycle: &[f64], eigenfunctions: &Eigenfunctions) -> (Option<f64>, f64) {
        let critical = CriticalCycle::of(&self.base, &cycle[..cycle.len() - 1]);
        let coefficient = match self.kind() {
            Kind::Fold => critical.fold(eigenfunctions).map(|(own, _)| own),
            Kind::Doubling => critical.doubling(eigenfunctions),
            Kind::Torus => critical.torus(eigenfunctions).map(|[real, _]| real),
            Kind::BranchPoint => None,
        };
        let scales = &self.system.collocation.problem.scales;
        let sizes: Vec<f64> =
            self.sizes.natural().zip(scales).map(|(natural, scale)| natural.max(*scale)).collect();
        (coefficient, critical.natural_coefficient(self.kind(), eigenfunctions, &sizes))
    }

    /// The point at which a test function vanishes between two solutions.
    fn zero(
        &mut self,
        before: &Solution<Inspection>,
        after: &Solution<Inspection>,
        kind: SpecialKind,
    ) -> Result<Option<Zero>, Error> {
        let test = |solution: &Solution<Inspection>| test_value(solution, kind);
        let zero = if monitor::is_coefficient(kind) { 0.0 } else { ZERO };
        let settings = self.settings;
        let found = match locate(self, before, after, &settings, LOCATION, |_, solution| test(solution)) {
            Ok(Some(found)) => found,
            Ok(None) | Err(Error::NotFound { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        let value = |solution: &Solution<Inspection>| test(solution).map_or(f64::INFINITY, f64::abs);
        let (ends, nearer) = (value(before).max(value(after)), value(before).min(value(after)));
        let smallest = value(&found);
        if smallest > POLE * nearer && smallest > zero {
            return Ok(None);
        }
        // The parameters are known as well as the test function: its slope along the bracket gives the error.
        let end = found.unknown.len();
        let part = LOCATION.max(smallest / ends.max(f64::MIN_POSITIVE));
        let error = [2, 1].map(|place| {
            let change = (after.unknown[end - place] - before.unknown[end - place]).abs();
            (part * change).max(f64::EPSILON * found.unknown[end - place].abs())
        });
        Ok(Some((found, error)))
    }
}

fn test_value(solution: &Solution<Inspection>, kind: SpecialKind) -> Option<f64> {
    solution.point.tests.iter().find(|(candidate, _)| *candidate == kind).map(|(_, value)| *value)
}

impl Curve for CycleLocusCurve<'_> {
    type Point = Inspection;

    fn unknowns(&self) -> usize {
        self.system.unknowns()
    }

    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        self.system.residual(unknown, residual);
    }

    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        self.system.factorize(unknown, border, residual)
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) {
        self.system.solve(right_hand_side);
    }

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        self.system.apply_metric(vector, image);
    }

    fn adapt(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        let (cycle, eigenfunctions) = split(unknown, self.states, self.kind());
        let period = cycle[cycle.len() - 3];
        if period <= 0.0 || self.sizes.is_equilibrium(&cycle[..cycle.len() - 3]) {
            return Err(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged });
        }
        self.system.collocation.problem.period_scale = period;
        let rescaled = self.rescale(&cycle);
        let scales = self.error_scales(&eigenfunctions);
        let errors = error_profile(&self.system.collocation, unknown, &scales);
        let (adaptation, worst) =
            fit_mesh(&mut self.system.collocation, &errors, &self.resolution, unknown, vectors)?;
        self.error_estimate = worst;
        Ok(if rescaled { Adaptation::Changed } else { adaptation })
    }

    fn inspect(&mut self, unknown: &[f64], _tangent: &[f64], _orientation: f64) -> Result<Inspection, Error> {
        let kind = self.kind();
        let (cycle, eigenfunctions) = split(unknown, self.states, kind);
        let end = cycle.len() - 3;
        self.base.problem.parameters[self.second] = cycle[end + 2];
        let base = &cycle[..end + 2];
        self.base.set_mesh(self.system.collocation.mesh().to_vec(), base);
        let mut border = vec![0.0; base.len()];
        border[end + 1] = 1.0;
        let mut residual = vec![0.0; base.len()];
        self.base.factorize(base, &border, &mut residual);
        let floquet = floquet(&self.base, base, &self.base.problem.scales, &mut self.schur)?;
        let (coefficient, natural_coefficient) = self.coefficient(&cycle, &eigenfunctions);
        let angle = eigenfunctions.1.first().copied().unwrap_or(0.0);
        let multipliers: Vec<Complex64> =
            floquet.nontrivial.iter().map(|multiplier| multiplier.to_complex()).collect();
        Ok(Inspection {
            error_estimate: self.error_estimate,
            ranges: ranges(&self.base, base, self.states),
            mesh: self.base.mesh().to_vec(),
            tests: monitor::tests(kind, &multipliers, coefficient, angle),
            coefficient,
            natural_coefficient,
            argument: (kind == Kind::Torus).then_some(angle),
            special: None,
            floquet,
        })
    }

    fn special_points(
        &mut self,
        before: &Solution<Inspection>,
        after: &Solution<Inspection>,
    ) -> Result<Vec<Solution<Inspection>>, Error> {
        let mut found = Vec::new();
        for (kind, value) in before.point.tests.clone() {
            let Some(other) = test_value(after, kind).filter(|other| (value > 0.0) != (*other > 0.0)) else {
                continue;
            };
            // A coefficient that is zero all along, by symmetry for instance, changes its sign at random.
            let noise = self.resolution.tolerance * after.point.natural_coefficient;
            if monitor::is_coefficient(kind) && value.abs().max(other.abs()) < noise {
                continue;
            }
            let Some((mut solution, error)) = self.zero(before, after, kind)? else {
                continue;
            };
            let multipliers: Vec<Complex64> =
                solution.point.floquet.nontrivial.iter().map(|multiplier| multiplier.to_complex()).collect();
            if monitor::is_genuine(kind, self.kind(), &multipliers) {
                solution.point.special = Some((kind, error));
                found.push(solution);
            }
        }
        Ok(found)
    }

    fn signature(&self, unknown: &[f64]) -> Vec<f64> {
        let (cycle, _) = split(unknown, self.states, self.kind());
        let end = cycle.len() - 3;
        let mut signature = vec![cycle[end].ln(), cycle[end + 2] / self.system.parameter_scales[1]];
        signature.extend(self.sizes.signature(&ranges(&self.base, &cycle[..end + 2], self.states)));
        signature
    }

    fn ending(&mut self, before: &Solution<Inspection>, after: &Solution<Inspection>) -> Option<Ending> {
        let end = after.unknown.len() - self.system.collocation.problem.scalars();
        let period = after.unknown[end];
        let last = after.tangent.len() - 2;
        let [one, other] =
            [0, 1].map(|index| after.tangent[last + index] / self.system.parameter_scales[index]);
        let sensitivity = (after.tangent[end] / period).abs() / one.hypot(other);
        if self.sizes.period_is_unbounded(period, sensitivity, self.resolution.tolerance) {
            let parameter = after.unknown[last];
            return Some(Ending::After(Stop::PeriodUnbounded { period, parameter }));
        }
        // Next to the end both parameters depend on the amplitude through its square.
        let [(here, a), (there, b)] = [before, after].map(|solution| {
            let (mut cycle, _) = split(&solution.unknown, self.states, self.kind());
            let parameter = cycle[cycle.len() - 2];
            cycle.truncate(cycle.len() - 3);
            (cycle, parameter)
        });
        if let Some(parameter) = self.sizes.amplitude_passes_zero((&here, a), (&there, b)) {
            let frequency = 2.0 * PI / period;
            return Some(Ending::Between(Stop::HopfPoint { parameter, frequency, located: false }));
        }
        let angle = |solution: &Solution<Inspection>| solution.point.argument;
        let (from, to) = (angle(before)?, angle(after)?);
        // Folds with the angle 0 and period doublings with the angle pi solve the defining system as well and cross its curve
        // at the resonances, where the continuation may turn onto theirs.
        for (resonance, order) in [(0.0, 1), (PI, 2)] {
            if (from - resonance) * (to - resonance) < 0.0 || (to - resonance).abs() < AT_RESONANCE {
                return Some(Ending::Between(Stop::StrongResonance { order }));
            }
        }
        None
    }
}
