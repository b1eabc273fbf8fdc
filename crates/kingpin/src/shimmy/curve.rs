//! Periodic motions with sliding phases as a curve that the continuation can follow.
//!
//! The unknowns are the scaled states at the start, the scaled period and the parameter.

use super::error::Refusal;
use super::passage::difference;
use super::return_map::{Return, ReturnMap, Start};
use super::variation::{DIRECTIONS, PARAMETER, STATES};
use super::{PeriodicSliding, SAME, SAMPLES_PER_PERIOD, middle_of_longest_passage, search};
use crate::parameters::Key;
use crate::sliding::model::SlipState;
use arclength::branch::SpecialKind;
use arclength::continuation::events::{Location, Reading, Spectrum, TestFunction};
use arclength::continuation::{Adaptation, Curve, Ending, Equations, Settings, Solution, Stop, locate};
use arclength::control::Control;
use arclength::error::{CorrectionFailure, Error};
use arclength::linear::lu;
use num_complex::Complex64;
use std::borrow::Cow;
use std::convert::Infallible;
use std::f64::consts::TAU;

/// Bifurcations are located to this part of a step.
const LOCATED: f64 = 1e-6;
/// Distance from the unit circle, or from -1, at which a multiplier is critical.
const CRITICAL: f64 = 1e-3;
/// Logarithm of the modulus of a multiplier below which its side of the unit circle is not decided, and the smallest one that is
/// told apart: motions that stick have multipliers zero.
const UNDECIDED: f64 = 1e-6;
const SMALLEST_LOGARITHM: f64 = -700.0;
/// Part of its phase that has to lie on both sides of the start.
const MARGIN: f64 = 0.2;
/// Distances beyond a grazing, as parts of the range, at which the motion is looked for.
const CROSSINGS: [f64; 4] = [1e-6, 1e-5, 1e-4, 1e-3];
/// A motion beyond a grazing is on the same branch when it differs by less than this part of its size.
const NEAR_GRAZING: f64 = 0.03;
/// Cosine of the angle between the motion and the normal of the plane that fixes its start, below which the plane is laid anew: where
/// the motion becomes tangent to the plane, a branch would turn back that does not.
const ACROSS: f64 = 0.9;
/// Growth of the period after which everything is scaled anew.
const RESCALE: f64 = 1.3;

/// The bifurcations that are looked for. A real pair of multipliers with the product one changes the test of torus bifurcations
/// too.
const TEST_FUNCTIONS: &[TestFunction<SpecialKind>] = &[
    TestFunction::new(SpecialKind::FoldOfCycles).changing(&[1]).turning(),
    TestFunction::new(SpecialKind::PeriodDoubling).changing(&[1]).of_spectrum(),
    TestFunction::new(SpecialKind::Torus).changing(&[0, 2]).of_spectrum(),
];

/// The value of a test function: it changes its sign where the bifurcation is.
fn test(kind: SpecialKind, solution: &Solution<CurvePoint>) -> Option<f64> {
    let nontrivial: Vec<Complex64> = solution.point.motion.nontrivial().collect();
    match kind {
        SpecialKind::FoldOfCycles => solution.tangent.last().copied(),
        SpecialKind::PeriodDoubling => {
            Some(nontrivial.iter().map(|multiplier| 1.0 + multiplier).product::<Complex64>().re)
        }
        SpecialKind::Torus => {
            let pairs = nontrivial
                .iter()
                .enumerate()
                .flat_map(|(index, one)| nontrivial[index + 1..].iter().map(move |other| 1.0 - one * other));
            Some(pairs.product::<Complex64>().re)
        }
        _ => None,
    }
}

/// Whether a solution where the test changes its sign is the bifurcation: a real pair with product 1 is none, nor is a curve that turns
/// back where no second multiplier is 1.
fn is_at(kind: SpecialKind, motion: &PeriodicSliding) -> bool {
    match kind {
        SpecialKind::FoldOfCycles => {
            motion.nontrivial().any(|multiplier| (multiplier - 1.0).norm() < CRITICAL)
        }
        SpecialKind::PeriodDoubling => {
            motion.nontrivial().any(|multiplier| (multiplier + 1.0).norm() < CRITICAL)
        }
        SpecialKind::Torus => motion
            .nontrivial()
            .any(|multiplier| multiplier.im != 0.0 && (multiplier.norm() - 1.0).abs() < CRITICAL),
        _ => true,
    }
}

/// What is known about a solution.
#[derive(Clone, Debug)]
pub(super) struct CurvePoint {
    pub motion: PeriodicSliding,
}

/// The curve, with the memory of its last linear equations.
pub(super) struct SlidingCurve<'a> {
    pub map: ReturnMap,
    pub key: Key,
    /// Length of the range of the parameter.
    pub range: f64,
    matrix: Vec<f64>,
    pivots: Vec<usize>,
    last: Option<(Vec<f64>, Return)>,
    /// Why the map was last not defined.
    pub refusal: Option<Refusal>,
    /// Whether the map was defined where it was last evaluated.
    is_defined: bool,
    /// Whether the start has to be moved away from the events.
    pub wants_new_start: bool,
    settings: Settings,
    control: &'a Control<'a>,
}

impl<'a> SlidingCurve<'a> {
    pub(super) fn new(
        map: ReturnMap,
        key: Key,
        range: f64,
        settings: Settings,
        control: &'a Control<'a>,
    ) -> Self {
        let map = ReturnMap { parameter: Some((key, 1.0)), ..map };
        Self {
            map,
            key,
            range,
            matrix: Vec::new(),
            pivots: Vec::new(),
            last: None,
            refusal: None,
            is_defined: false,
            wants_new_start: false,
            settings,
            control,
        }
    }

    /// The unknowns of a start at a parameter value.
    pub(super) fn unknown(&self, start: &Start, value: f64) -> Vec<f64> {
        let states = self.map.free().iter().map(|&i| start.state.state[i] / self.map.scales[i]);
        states.chain([start.period / self.map.period_scale, value]).collect()
    }

    fn start(&self, unknown: &[f64]) -> Start {
        let free = self.map.free();
        let mut state = self.map.reference;
        for (&i, value) in free.iter().zip(unknown) {
            state.state[i] = value * self.map.scales[i];
        }
        Start { state, period: unknown[free.len()] * self.map.period_scale }
    }

    fn evaluate(&mut self, unknown: &[f64], with_derivatives: bool) -> Option<Return> {
        let value = unknown[unknown.len() - 1];
        let image =
            self.map.wheel.with(self.key, value).map_err(|error| Refusal::from_wheel(&error)).and_then(
                |wheel| {
                    self.map.wheel = wheel;
                    self.map.evaluate(&self.start(unknown), with_derivatives, self.control)
                },
            );
        self.is_defined = image.is_ok();
        match image {
            Ok(image) => Some(image),
            Err(refusal) => {
                self.refusal = Some(refusal);
                None
            }
        }
    }

    /// Moves the start of a solution to the middle of its longest phase and scales everything anew; returns the unknowns and
    /// the tangent there.
    pub(super) fn renew(&mut self, solution: &Solution<CurvePoint>) -> Result<(Vec<f64>, Vec<f64>), Refusal> {
        let value = solution.unknown[solution.unknown.len() - 1];
        let free = self.map.free();
        let slope = &solution.tangent;
        let mut map = solution.point.motion.map.clone();
        map.parameter = Some((self.key, slope[slope.len() - 1]));
        let start = self.start(&solution.unknown);
        let (passages, _) = map.follow(&start, &[], self.control)?;
        let time = middle_of_longest_passage(&passages, start.period);
        let mut columns = [[0.0; DIRECTIONS]; STATES];
        for (&i, slope) in free.iter().zip(slope) {
            columns[i][PARAMETER] = slope * map.scales[i];
        }
        if time > 0.0 {
            let (way, _) = map.follow(&Start { period: time, ..start.clone() }, &[], self.control)?;
            map.carry(&way, &mut columns)?;
        }
        let start = map.start_after(&start, time, self.control)?;
        let sampling: Vec<f64> =
            (0..SAMPLES_PER_PERIOD).map(|i| start.period * i as f64 / SAMPLES_PER_PERIOD as f64).collect();
        let samples: Vec<SlipState> = map
            .follow(&start, &sampling, self.control)?
            .0
            .iter()
            .flat_map(|passage| passage.samples.iter().map(|s| s.1))
            .collect();
        let period_slope = slope[free.len()] * map.period_scale;
        map.scales = search::sizes(&map.wheel, &samples);
        map.period_scale = start.period;
        map.set_reference(start.state)?;
        map.expected = Some(map.follow(&start, &[], self.control)?.0);
        // The tangent lies in the new plane across the flow.
        let rate = map.sliding()?.rate(&start.state);
        let normal = |vector: &dyn Fn(usize) -> f64| -> f64 {
            map.free().iter().map(|&i| map.normal[i] * vector(i) / map.scales[i]).sum()
        };
        let along_flow = normal(&|i| columns[i][PARAMETER]) / normal(&|i| rate[i]);
        let mut tangent: Vec<f64> = map
            .free()
            .iter()
            .map(|&i| (columns[i][PARAMETER] - along_flow * rate[i]) / map.scales[i])
            .collect();
        tangent.extend([period_slope / map.period_scale, slope[slope.len() - 1]]);
        self.map = ReturnMap { parameter: Some((self.key, 1.0)), ..map };
        self.wants_new_start = false;
        Ok((self.unknown(&start, value), tangent))
    }

    /// The motion beyond a grazing: at a parameter value near that of the last solution, with another sequence of phases and
    /// not `known` at this value. Returns the unknowns and a tangent.
    pub(super) fn cross(
        &mut self,
        solution: &Solution<CurvePoint>,
        range: (f64, f64),
        known: &dyn Fn(f64, &PeriodicSliding) -> bool,
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        let slope = &solution.tangent;
        let last = slope.len() - 1;
        let old = solution.point.motion.map.expected.clone()?;
        for distance in CROSSINGS {
            for side in [1.0, -1.0] {
                let direction = side * slope[last].signum();
                let value = solution.unknown[last] + direction * distance * self.range;
                if !(range.0..=range.1).contains(&value) {
                    continue;
                }
                let Ok(wheel) = solution.point.motion.map.wheel.with(self.key, value) else { continue };
                let mut map =
                    ReturnMap { wheel, expected: None, parameter: None, ..solution.point.motion.map.clone() };
                let start = self.start(&solution.unknown);
                let Ok((found, image)) = map.solve(&start, self.control) else { continue };
                let far = map.free().iter().any(|&i| {
                    ((found.state.state[i] - start.state.state[i]) / map.scales[i]).abs() > NEAR_GRAZING
                });
                let unchanged = map.expected.as_ref().is_none_or(|new| difference(&old, new).is_none());
                if far || unchanged || (found.period / start.period - 1.0).abs() > NEAR_GRAZING {
                    continue;
                }
                let Ok(motion) = PeriodicSliding::describe(&map, &found, &image, self.control) else {
                    continue;
                };
                if known(value, &motion) {
                    continue;
                }
                self.map = ReturnMap { parameter: Some((self.key, 1.0)), ..map };
                let unknown = self.unknown(&found, value);
                let mut tangent = vec![0.0; unknown.len()];
                tangent[last] = direction * self.range;
                return Some((unknown, tangent));
            }
        }
        None
    }

    /// What is made of a curve that seems to turn back where there is no fold: close to a grazing derivatives are so large that a tangent
    /// points back. The step is made anew and shorter, as long as it may be.
    fn turned_back(
        &self,
        [before, after]: [&Solution<CurvePoint>; 2],
    ) -> Result<Location<CurvePoint>, Error> {
        let step: Vec<f64> =
            after.unknown.iter().zip(&before.unknown).map(|(one, other)| one - other).collect();
        let mut image = step.clone();
        self.apply_metric(&step, &mut image);
        let square: f64 = step.iter().zip(&image).map(|(one, other)| one * other).sum();
        if square.sqrt() > self.settings.smallest_step {
            Err(Error::OtherBranch)
        } else {
            Ok(Location::Missed)
        }
    }

    fn is_start_near_event(&self, motion: &PeriodicSliding) -> bool {
        let [first, .., last] = &motion.phases[..] else { return false };
        let (before, after) = (last.end - last.start, first.end - first.start);
        before.min(after) < MARGIN * (before + after)
    }
}

impl SlidingCurve<'_> {
    /// Cosine of the angle between the motion at its start and the normal of the plane.
    fn cosine_to_normal(&self, unknown: &[f64]) -> Option<f64> {
        let rate = self.map.sliding().ok()?.rate(&self.start(unknown).state);
        let scaled: SlipState = std::array::from_fn(|i| rate[i] / self.map.scales[i]);
        let along: f64 = scaled.iter().zip(&self.map.normal).map(|(rate, normal)| rate * normal).sum();
        Some(along / scaled.iter().map(|rate| rate * rate).sum::<f64>().sqrt())
    }
}

impl Refusal {
    fn from_wheel(error: &crate::KingpinError) -> Self {
        Self::Integration(error.to_string())
    }
}

impl Equations for SlidingCurve<'_> {
    fn unknowns(&self) -> usize {
        self.map.free().len() + 2
    }

    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        match self.evaluate(unknown, false) {
            Some(image) => residual[..image.residual.len()].copy_from_slice(&image.residual),
            None => residual.fill(f64::INFINITY),
        }
    }

    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        let n = unknown.len();
        self.last = None;
        let Some(image) = self.evaluate(unknown, true) else {
            residual.fill(f64::INFINITY);
            return 1.0;
        };
        residual[..n - 1].copy_from_slice(&image.residual);
        self.matrix.resize(n * n, 0.0);
        self.pivots.resize(n, 0);
        for (column, border) in border.iter().enumerate() {
            self.matrix[column * n..][..n - 1].copy_from_slice(&image.jacobian[column * (n - 1)..][..n - 1]);
            self.matrix[column * n + n - 1] = *border;
        }
        self.last = Some((unknown.to_vec(), image));
        lu::factorize(&mut self.matrix, n, &mut self.pivots)
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) {
        if !self.is_defined {
            // An update that is not finite makes the corrector give up.
            right_hand_side.fill(f64::INFINITY);
            return;
        }
        lu::solve(&self.matrix, right_hand_side.len(), &self.pivots, right_hand_side);
    }
}

impl Curve for SlidingCurve<'_> {
    type Point = CurvePoint;
    type Kind = SpecialKind;
    type Reason = Infallible;

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        image.copy_from_slice(vector);
        if let Some(parameter) = image.last_mut() {
            *parameter /= self.range * self.range;
        }
    }

    fn adapt(
        &mut self,
        _unknown: &mut Vec<f64>,
        _vectors: &mut [&mut Vec<f64>],
    ) -> Result<Adaptation, Error> {
        Ok(Adaptation::Unchanged)
    }

    fn inspect(&mut self, unknown: &[f64], _tangent: &[f64], _orientation: f64) -> Result<CurvePoint, Error> {
        let invalid = |cause: String| Error::Invalid {
            name: "periodic motion".into(),
            value: cause,
            allowed: "a motion whose multipliers can be computed".into(),
        };
        let Some((at, image)) = self.last.take() else { return Err(invalid("not computed".into())) };
        debug_assert_eq!(at, unknown);
        let motion = PeriodicSliding::describe(&self.map, &self.start(unknown), &image, self.control)
            .map_err(|refusal| invalid(refusal.to_string()))?;
        // What tells motions apart has to be known of them.
        if motion.error_estimate > SAME {
            let error = motion.error_estimate;
            self.last = Some((at, image));
            if !matches!(self.refusal, Some(Refusal::Grazing(_))) {
                self.refusal = Some(Refusal::Inexact { error });
            }
            return Err(Error::NotFound { sought: "periodic motion", cause: CorrectionFailure::Diverged });
        }
        self.map.expected = Some(image.passages.clone());
        self.last = Some((at, image));
        Ok(CurvePoint { motion })
    }

    fn test_functions(&self) -> Cow<'static, [TestFunction<SpecialKind>]> {
        Cow::Borrowed(TEST_FUNCTIONS)
    }

    fn test(&self, kind: SpecialKind, solution: &Solution<CurvePoint>) -> Option<Reading> {
        test(kind, solution).map(Reading::exact)
    }

    fn spectrum(&self, solution: &Solution<CurvePoint>) -> Spectrum {
        let nontrivial: Vec<Complex64> = solution.point.motion.nontrivial().collect();
        let exponents: Vec<Complex64> = nontrivial
            .iter()
            .map(|multiplier| {
                Complex64::new(multiplier.norm().ln().max(SMALLEST_LOGARITHM), multiplier.arg())
            })
            .collect();
        Spectrum {
            unstable: exponents.iter().filter(|exponent| exponent.re > 0.0).count(),
            decided: exponents.iter().all(|exponent| exponent.re.abs() > UNDECIDED),
            exponents,
            noise: UNDECIDED,
            is_periodic: true,
        }
    }

    fn locate(
        &mut self,
        kind: SpecialKind,
        [before, after]: [&Solution<CurvePoint>; 2],
    ) -> Result<Location<CurvePoint>, Error> {
        let settings = self.settings;
        let value = |_: &mut Self, solution: &Solution<CurvePoint>| test(kind, solution);
        match locate(self, before, after, &settings, LOCATED, value) {
            Ok(Some(solution)) if is_at(kind, &solution.point.motion) => Ok(Location::At(solution)),
            _ if kind == SpecialKind::FoldOfCycles => self.turned_back([before, after]),
            Ok(_) => Ok(Location::Nothing),
            Err(_) => Ok(Location::Missed),
        }
    }

    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        // The period and, where the start has not moved, the state itself.
        let start = self.start(unknown);
        let angle = start.state.state[2];
        vec![(start.period, self.map.period_scale), (angle - TAU * (angle / TAU).round(), 1.0)]
    }

    fn ending(
        &mut self,
        _before: &Solution<CurvePoint>,
        after: &Solution<CurvePoint>,
    ) -> Option<Ending<Infallible>> {
        let motion = &after.point.motion;
        let ratio = motion.period / self.map.period_scale;
        self.wants_new_start = self.is_start_near_event(motion)
            || !(RESCALE.recip()..RESCALE).contains(&ratio)
            || self.cosine_to_normal(&after.unknown).is_none_or(|cosine| cosine < ACROSS);
        self.wants_new_start.then_some(Ending::After(Stop::Interrupted))
    }
}
