//! The curve of limit cycles of one parameter: mesh adaptation, metric, stability along the way.

use super::end::CycleEnd;
use super::extrema::{Range, ranges};
use super::floquet::{Floquet, floquet};
use super::limit_cycle::LimitCycle;
use super::sizes::{StateSizes, vanishing_point};
use super::special;
use super::switching::Branching;
use crate::branch::{SpecialKind, invalid};
use crate::collocation::equations::Collocation;
use crate::collocation::mesh::{error_profile, fit_mesh};
use crate::collocation::problem::PeriodicProblem;
use crate::continuation::events::{Event, Location, Reading, Spectrum, TestFunction};
use crate::continuation::{Adaptation, Curve, Ending, Settings, Solution, Stop};
use crate::error::{CorrectionFailure, Error};
use crate::linear::periodic_schur::PeriodicSchur;

/// How finely cycles are resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Error estimate, relative to the amplitude of each state variable, that no reported cycle exceeds.
    pub tolerance: f64,
    /// Degree of the polynomials, 2 to 16.
    pub degree: usize,
    /// Fewest mesh intervals.
    pub fewest_intervals: usize,
    /// Most mesh intervals.
    pub most_intervals: usize,
}

impl Resolution {
    /// Resolution for a tolerance, with the degree that makes a branch cheapest: a matrix of `m` Gauss points costs `m^3` and
    /// the intervals needed fall with the tolerance to the power `-1/(m+1)`. Measured on the cycles of four models at
    /// tolerances of 1e-2 to 1e-10, the best degree grows by 0.6 to 0.7 per digit and a miss of one costs a tenth.
    pub fn with_tolerance(tolerance: f64) -> Self {
        let digits = -tolerance.log10();
        let degree = (2.5 + 0.6 * digits).round().clamp(3.0, 11.0) as usize;
        Self { tolerance, degree, fewest_intervals: 4, most_intervals: 2000 }
    }

    /// That all numbers make sense.
    ///
    /// # Errors
    /// [`Error::Invalid`]
    pub(crate) fn validate(&self) -> Result<(), Error> {
        if !(2..=16).contains(&self.degree) {
            return Err(invalid("degree", &self.degree.to_string(), "2 to 16"));
        }
        let (fewest, most) = (self.fewest_intervals, self.most_intervals);
        if !(1 < fewest && fewest <= most) {
            let allowed = format!("2 to {most}, the most intervals");
            return Err(invalid("fewest intervals", &fewest.to_string(), &allowed));
        }
        if !(self.tolerance > 1e-13 && self.tolerance < 0.1) {
            return Err(invalid("tolerance", &self.tolerance.to_string(), "between 1e-13 and 0.1"));
        }
        Ok(())
    }
}

impl Default for Resolution {
    /// For a tolerance of 1e-8.
    fn default() -> Self {
        Self::with_tolerance(1e-8)
    }
}

/// The mesh is made finer than the tolerance asks for where the trivial multiplier is wrong by more than this part of the root
/// of the tolerance: next to a canard errors of the cycle are multiplied by large multipliers.
const MULTIPLIER_PART: f64 = 0.1;
/// Factors of the tolerance for that reason: the smallest of all, the strongest and the weakest at a time. Rounding sets an end
/// to it, too.
const FINEST: f64 = 1e-4;
const FINEST_TOLERANCE: f64 = 1e-10;
const REFINEMENT: (f64, f64) = (0.1, 0.5);
/// Where the error is less than this part of what is allowed, the factor of the tolerance grows by `RELAXATION` from point to
/// point.
const MUCH_LESS: f64 = 0.01;
const RELAXATION: f64 = 1.5;
/// On the branch that turns at a pitchfork the parameter turns too, and a multiplier touches one. Two real multipliers with the
/// product one change the test of torus bifurcations as well.
const TEST_FUNCTIONS: &[TestFunction<SpecialKind>] = &[
    TestFunction::new(SpecialKind::BranchPointOfCycles)
        .changing(&[0, 1])
        .absorbing(&[SpecialKind::FoldOfCycles])
        .of_spectrum(),
    TestFunction::new(SpecialKind::FoldOfCycles).changing(&[1]).turning(),
    TestFunction::new(SpecialKind::PeriodDoubling).changing(&[1]).of_spectrum(),
    TestFunction::new(SpecialKind::Torus).changing(&[0, 2]).of_spectrum(),
];
/// Rate of change of the parameter, as part of its range, that may be rounding, and one below which a cycle may be a fold.
const PARAMETER_ROUNDING: f64 = 1e-13;
const NEARLY_FOLD: f64 = 1e-8;
/// Difference of the arguments of two pairs of multipliers.
const DISTINCT: f64 = 1e-6;
/// Samples for the difference of the halves of a doubled cycle.
const HALF_SAMPLES: usize = 64;

/// What is known about one cycle.
#[derive(Clone, Debug)]
pub struct CycleInspection {
    /// Error estimate relative to the amplitudes.
    pub error_estimate: f64,
    /// Multipliers.
    pub floquet: Floquet,
    /// Largest and smallest value of each state.
    pub(super) ranges: Vec<Range>,
    /// Mesh of this solution.
    pub mesh: Vec<f64>,
    /// Coefficients of its normal form by name.
    pub normal_form: Vec<(&'static str, f64)>,
    /// The branch that leaves here.
    pub branching: Option<Branching>,
}

impl CycleInspection {
    /// Product of `1 + mu` over the real nontrivial multipliers, scaled: zero at a period doubling.
    pub fn doubling_test(&self) -> f64 {
        let real = self.floquet.nontrivial.iter().filter(|multiplier| multiplier.is_real());
        real.map(|multiplier| {
            let value = multiplier.to_complex().re;
            if value.is_finite() { (1.0 + value) / (1.0 + value.abs()) } else { value.signum() }
        })
        .product()
    }
}

/// Limit cycles `u' = T f(u, p)` along one parameter.
#[derive(Debug)]
pub struct CycleCurve<'a> {
    /// The discretised problem.
    pub collocation: Collocation<LimitCycle<'a>>,
    /// Resolution asked for.
    pub resolution: Resolution,
    /// Settings of corrections made while special points are located.
    pub settings: Settings,
    /// Weight of the parameter in the metric: the length of its range.
    pub parameter_scale: f64,
    period_scale: f64,
    /// Sizes that measure the error: amplitudes.
    amplitudes: Vec<f64>,
    sizes: StateSizes,
    /// Whether the branch is one of doubled cycles, which ends where they become single again.
    pub doubled: bool,
    error_estimate: f64,
    /// Factor of the tolerance that the multipliers ask for.
    refinement: f64,
    schur: Option<(usize, PeriodicSchur)>,
}

impl<'a> CycleCurve<'a> {
    /// The curve through a start that is given on the mesh of the collocation.
    pub fn new(
        mut collocation: Collocation<LimitCycle<'a>>,
        resolution: Resolution,
        parameter_scale: f64,
        start: &[f64],
    ) -> Self {
        collocation.set_reference(start);
        let n = collocation.problem.dimension();
        let sizes = StateSizes::new(&collocation.problem, start);
        let mut curve = Self {
            collocation,
            resolution,
            settings: Settings::default(),
            parameter_scale,
            period_scale: 1.0,
            amplitudes: vec![1.0; n],
            sizes,
            doubled: false,
            error_estimate: f64::INFINITY,
            refinement: 1.0,
            schur: None,
        };
        curve.rescale(start);
        curve.collocation.set_reference(start);
        curve
    }

    /// Measures sizes on a solution.
    fn rescale(&mut self, unknown: &[f64]) {
        let end = unknown.len() - 2;
        for (component, size) in self.sizes.measure(&unknown[..end]).into_iter().enumerate() {
            self.amplitudes[component] = size.amplitude;
            self.collocation.problem.scales[component] = size.scale;
        }
        self.period_scale = unknown[end].abs();
    }

    /// Gives states that rest the sizes that the nonlinearity of the field gives them, where a branch is left on which they do.
    pub(super) fn count_resting_states_fully(&mut self) {
        for (scale, natural) in self.collocation.problem.scales.iter_mut().zip(self.sizes.natural()) {
            *scale = scale.max(natural);
        }
    }

    /// Rate of change of the parameter along the curve, as part of its range: zero at a fold.
    pub fn turn(&self, tangent: &[f64]) -> f64 {
        tangent.last().map_or(0.0, |rate| rate / self.parameter_scale)
    }

    /// Estimates the error of a cycle on the mesh as it is.
    pub fn estimate_error(&mut self, unknown: &[f64]) {
        self.rescale(unknown);
        let errors = error_profile(&self.collocation, unknown, &self.amplitudes);
        self.error_estimate = errors.into_iter().fold(0.0, f64::max);
    }

    /// Parameter value at which the two halves of a doubled cycle become equal between two solutions.
    fn single_again(&self, before: &[f64], after: &[f64]) -> Option<f64> {
        let n = self.collocation.problem.dimension();
        let half_difference = |unknown: &[f64]| -> Vec<f64> {
            let (mut one, mut other) = (vec![0.0; n], vec![0.0; n]);
            let mut differences = Vec::with_capacity(n * HALF_SAMPLES);
            for sample in 0..HALF_SAMPLES {
                let time = 0.5 * sample as f64 / HALF_SAMPLES as f64;
                self.collocation.evaluate(unknown, time, &mut one);
                self.collocation.evaluate(unknown, time + 0.5, &mut other);
                let scaled = one.iter().zip(&other).zip(&self.collocation.problem.scales);
                differences.extend(scaled.map(|((a, b), scale)| (a - b) / scale));
            }
            differences
        };
        let (one, other) = (half_difference(before), half_difference(after));
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (size_before, size_after) = (product(&one, &one), product(&other, &other));
        if product(&one, &other) >= 0.0 {
            return None;
        }
        let (a, b) = (before[before.len() - 1], after[after.len() - 1]);
        Some(vanishing_point((a, size_before), (b, size_after)))
    }
}

impl Curve for CycleCurve<'_> {
    type Point = CycleInspection;
    type Kind = SpecialKind;
    type Reason = CycleEnd;

    fn unknowns(&self) -> usize {
        self.collocation.unknowns()
    }

    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        self.collocation.residual(unknown, residual);
    }

    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        self.collocation.factorize(unknown, border, residual)
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) {
        self.collocation.solve(right_hand_side);
    }

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        let end = vector.len() - 2;
        state_metric(&self.collocation, &self.collocation.problem.scales, vector, image);
        image[end] = vector[end] / (self.period_scale * self.period_scale);
        image[end + 1] = vector[end + 1] / (self.parameter_scale * self.parameter_scale);
    }

    fn adapt(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        // Equilibria and cycles with the time reversed solve the equations too, and Newton's method may jump there.
        let end = unknown.len() - 2;
        if unknown[end] <= 0.0 || self.sizes.is_equilibrium(&unknown[..end]) {
            return Err(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged });
        }
        self.rescale(unknown);
        let errors = error_profile(&self.collocation, unknown, &self.amplitudes);
        let finer = Resolution { tolerance: self.refinement * self.resolution.tolerance, ..self.resolution };
        let (adaptation, worst) = match fit_mesh(&mut self.collocation, &errors, &finer, unknown, vectors) {
            Err(Error::MeshLimit { .. }) if self.refinement < 1.0 => {
                fit_mesh(&mut self.collocation, &errors, &self.resolution, unknown, vectors)?
            }
            result => result?,
        };
        self.error_estimate = worst;
        Ok(adaptation)
    }

    fn inspect(
        &mut self,
        unknown: &[f64],
        _tangent: &[f64],
        _orientation: f64,
    ) -> Result<CycleInspection, Error> {
        let floquet = floquet(&self.collocation, unknown, &self.collocation.problem.scales, &mut self.schur)?;
        let n = self.collocation.problem.dimension();
        Ok(CycleInspection {
            error_estimate: self.error_estimate,
            floquet,
            ranges: ranges(&self.collocation, unknown, n),
            mesh: self.collocation.mesh().to_vec(),
            normal_form: Vec::new(),
            branching: None,
        })
    }

    fn resolves(&mut self, point: &CycleInspection) -> bool {
        let floquet = &point.floquet;
        let allowed = MULTIPLIER_PART * self.resolution.tolerance.sqrt();
        let error = if floquet.is_contradictory() { f64::INFINITY } else { floquet.trivial_error };
        if error <= allowed {
            if error < MUCH_LESS * allowed {
                self.refinement = (RELAXATION * self.refinement).min(1.0);
            }
            return true;
        }
        let (strongest, weakest) = REFINEMENT;
        let reached = (self.error_estimate / self.resolution.tolerance).min(self.refinement);
        let finer = reached * (allowed / error).clamp(strongest, weakest);
        let finest = FINEST.max(FINEST_TOLERANCE / self.resolution.tolerance).min(1.0);
        self.refinement = finer.max(finest);
        finer < finest
    }

    fn test_functions(&self) -> &'static [TestFunction<SpecialKind>] {
        TEST_FUNCTIONS
    }

    fn test(&self, kind: SpecialKind, solution: &Solution<CycleInspection>) -> Option<Reading> {
        let floquet = &solution.point.floquet;
        let reading = match kind {
            // On the explosion of a canard the parameter may vary by its rounding only.
            SpecialKind::FoldOfCycles => {
                return Some(Reading::exact(self.turn(&solution.tangent)).with_noise(PARAMETER_ROUNDING));
            }
            SpecialKind::BranchPointOfCycles => Reading::exact(solution.orientation),
            SpecialKind::PeriodDoubling => Reading::exact(solution.point.doubling_test()),
            SpecialKind::Torus => {
                let (value, undecided) = floquet.torus_test();
                Reading::exact(value).in_class(undecided)
            }
            _ => return None,
        };
        Some(Reading { resolved: !floquet.is_contradictory(), ..reading })
    }

    fn spectrum(&self, solution: &Solution<CycleInspection>) -> Spectrum {
        solution.point.floquet.growth()
    }

    fn undecided(&self, solution: &Solution<CycleInspection>) -> usize {
        let (_, certain) = solution.point.floquet.unstable();
        usize::from(!certain) + usize::from(self.turn(&solution.tangent).abs() < NEARLY_FOLD)
    }

    fn locate(
        &mut self,
        kind: SpecialKind,
        between: [&Solution<CycleInspection>; 2],
    ) -> Result<Location<CycleInspection>, Error> {
        special::locate(self, kind, between)
    }

    fn locate_crossing(
        &mut self,
        between: [&Solution<CycleInspection>; 2],
        _near: Solution<CycleInspection>,
        change: usize,
        _half: f64,
    ) -> Result<Vec<Event<SpecialKind, CycleInspection>>, Error> {
        special::crossing(self, between, change)
    }

    fn are_distinct(&self, one: &CycleInspection, other: &CycleInspection) -> bool {
        // Torus bifurcations of pairs with different arguments.
        let argument = |point: &CycleInspection| {
            point.normal_form.iter().find(|(name, _)| *name == "argument").map(|entry| entry.1)
        };
        matches!((argument(one), argument(other)), (Some(one), Some(other)) if (one - other).abs() > DISTINCT)
    }

    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        let n = self.collocation.problem.dimension();
        let mut signature = vec![(unknown[unknown.len() - 2].ln(), 1.0)];
        signature.extend(self.sizes.signature(&ranges(&self.collocation, unknown, n)));
        signature
    }

    fn ending(
        &mut self,
        before: &Solution<CycleInspection>,
        after: &Solution<CycleInspection>,
    ) -> Option<Ending<CycleEnd>> {
        let end = after.unknown.len() - 2;
        let (period, parameter) = (after.unknown[end], after.unknown[end + 1]);
        let rate = after.tangent[end] / self.period_scale;
        let sensitivity = (rate / self.turn(&after.tangent)).abs();
        if self.sizes.period_is_unbounded(period, sensitivity, self.resolution.tolerance) {
            return Some(Ending::After(Stop::Problem(CycleEnd::PeriodUnbounded { period, parameter })));
        }
        if self.doubled
            && let Some(parameter) = self.single_again(&before.unknown, &after.unknown)
        {
            return Some(Ending::Between(Stop::Problem(CycleEnd::PeriodDoubling {
                parameter,
                period: 0.5 * period,
            })));
        }
        let parameter_before = before.unknown[end + 1];
        let (here, there) = (&before.unknown[..end], &after.unknown[..end]);
        if let Some(parameter) =
            self.sizes.amplitude_passes_zero((here, parameter_before), (there, parameter))
        {
            let frequency = 2.0 * std::f64::consts::PI / period;
            return Some(Ending::Between(Stop::Problem(CycleEnd::HopfPoint {
                parameter,
                frequency,
                located: false,
            })));
        }
        // Cycles that are not known to be doubled ones may be so; then they pass what looks like a branch point.
        if !self.doubled
            && before.orientation * after.orientation < 0.0
            && let Some(parameter) = self.single_again(&before.unknown, &after.unknown)
        {
            return Some(Ending::Between(Stop::Problem(CycleEnd::PeriodDoubling {
                parameter,
                period: 0.5 * period,
            })));
        }
        None
    }
}

/// Applies the metric of the states: mean square over the unit interval, each state in units of its scale.
/// Components beyond the scales have weight zero.
pub(super) fn state_metric<P: PeriodicProblem>(
    collocation: &Collocation<P>,
    scales: &[f64],
    vector: &[f64],
    image: &mut [f64],
) {
    let n = collocation.problem.dimension();
    let size = collocation.interval_size();
    let weights = &collocation.gauss().weights;
    let square = |component: usize| scales.get(component).map_or(0.0, |scale| 1.0 / (scale * scale));
    let squares: Vec<f64> = (0..n).map(square).collect();
    for ((pair, vector), image) in
        collocation.mesh().windows(2).zip(vector.chunks_exact(size)).zip(image.chunks_exact_mut(size))
    {
        let (start, rest) = image.split_at_mut(n);
        start.fill(0.0);
        for ((values, images), weight) in
            vector[n..].chunks_exact(n).zip(rest.chunks_exact_mut(n)).zip(weights)
        {
            let weight = weight * (pair[1] - pair[0]);
            for ((image, value), square) in images.iter_mut().zip(values).zip(&squares) {
                *image = weight * square * value;
            }
        }
    }
}
