//! What continuation asks of a curve of equilibria: residuals, test functions, where special points lie, where the curve ends.

use super::curve::{EquilibriumCurve, EquilibriumInspection};
use super::end::EquilibriumEnd;
use super::locating;
use super::problem::EquilibriumProblem;
use super::special::SpecialPoint;
use super::spectrum::Spectrum;
use crate::algebraic::DenseSystem;
use crate::branch::SpecialKind;
use crate::continuation::events::{Event, Location, Reading, TestFunction, partners};
use crate::continuation::{
    Adaptation, Curve, Discretised, Ending, PassageOf, Solution, Stop, distance, events,
};
use crate::error::Error;
use num_complex::Complex64;
use std::borrow::Cow;

/// On the branch that turns at a pitchfork the parameter turns too, and an eigenvalue touches zero. At a neutral saddle the
/// Hopf test vanishes as well.
const TEST_FUNCTIONS: &[TestFunction<SpecialKind>] = &[
    TestFunction::new(SpecialKind::BranchPoint)
        .changing(&[0, 1])
        .absorbing(&[SpecialKind::Fold])
        .of_spectrum()
        .orienting(),
    TestFunction::new(SpecialKind::Fold).changing(&[1]).turning(),
    TestFunction::new(SpecialKind::Hopf).changing(&[0, 2]).of_spectrum(),
];
/// A rate of change of the parameter along the curve that may be rounding error, and one below which a solution may be a fold
/// itself.
const UNDECIDED_FOLD: f64 = 1e-13;
const NEARLY_FOLD: f64 = 1e-9;
/// Displacement along the tangent for the rates of the eigenvalues. Small enough that curvature does not matter,
/// large enough that rounding does not.
const DISPLACEMENT: f64 = 1e-7;
/// Rate of change of the parameter, as part of the whole, and growth of a state since the start that together mean that the
/// state grows without bound.
const VERTICAL: f64 = 1e-7;
const UNBOUNDED_GROWTH: f64 = 1e6;
/// Part of its range by which the parameter has to change within a way of this length, in sizes of the states: it stands still
/// otherwise. On an analytic curve it does so from the start on or nowhere; where it has moved before it tends to a limit.
const IDLE: f64 = 1e-13;
const LONGEST_IDLE_WAY: f64 = 5.0;

impl<'f> Discretised for EquilibriumCurve<'f> {
    type System = DenseSystem<EquilibriumProblem<'f>>;

    fn system(&self) -> &Self::System {
        &self.system
    }

    fn system_mut(&mut self) -> &mut Self::System {
        &mut self.system
    }
}

impl Curve for EquilibriumCurve<'_> {
    type Point = EquilibriumInspection;
    type Kind = SpecialKind;
    type Reason = EquilibriumEnd;

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        self.system.apply_metric(vector, image);
    }

    fn adapt(&mut self, unknown: &mut Vec<f64>, _vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        let n = self.dimension();
        self.system.grow_scales(unknown, n);
        Ok(Adaptation::Unchanged)
    }

    fn inspect(
        &mut self,
        unknown: &[f64],
        tangent: &[f64],
        orientation: f64,
    ) -> Result<EquilibriumInspection, Error> {
        let n = self.dimension();
        let determinant = self.system.determinant_size();
        let is_line = self.turn(tangent).abs() < UNDECIDED_FOLD;
        let spectrum = |curve: &mut Self| -> Result<Spectrum, Error> {
            let spectrum = curve.spectrum()?;
            Ok(if is_line { spectrum.along_a_line() } else { spectrum })
        };
        let here = spectrum(self)?;
        let nearby: Vec<f64> =
            unknown.iter().zip(tangent).map(|(value, slope)| value + DISPLACEMENT * slope).collect();
        let mut residual = vec![0.0; n + 1];
        self.system.linearize(&nearby, &mut residual);
        let rates = match spectrum(self) {
            Ok(there) => {
                let partners = partners(&here.growth(), &there.growth());
                let pairs = here.eigenvalues.iter().zip(partners);
                pairs.map(|(here, index)| (there.eigenvalues[index] - here) / DISPLACEMENT).collect()
            }
            Err(_) => vec![Complex64::ZERO; n],
        };
        let cells = self.system.problem.cells().to_vec();
        Ok(EquilibriumInspection { spectrum: here, rates, orientation, determinant, cells, special: None })
    }

    fn test_functions(&self) -> Cow<'static, [TestFunction<SpecialKind>]> {
        Cow::Borrowed(TEST_FUNCTIONS)
    }

    fn test(&self, kind: SpecialKind, solution: &Solution<EquilibriumInspection>) -> Option<Reading> {
        let point = &solution.point;
        match kind {
            SpecialKind::Fold => {
                Some(Reading::exact(self.turn(&solution.tangent)).with_noise(UNDECIDED_FOLD))
            }
            SpecialKind::BranchPoint => Some(Reading::exact(solution.orientation * point.determinant)),
            SpecialKind::Hopf => {
                Some(Reading::exact(point.spectrum.hopf_test).in_class(point.spectrum.hopf_undecided))
            }
            _ => None,
        }
    }

    fn spectrum(&self, solution: &Solution<EquilibriumInspection>) -> events::Spectrum {
        solution.point.spectrum.growth()
    }

    fn exponent_rates(&self, solution: &Solution<EquilibriumInspection>) -> Option<Vec<Complex64>> {
        let direction = solution.orientation * solution.point.orientation;
        Some(solution.point.rates.iter().map(|rate| rate * direction).collect())
    }

    fn undecided(&self, solution: &Solution<EquilibriumInspection>) -> usize {
        let spectrum = &solution.point.spectrum;
        spectrum.hopf_undecided
            + usize::from(!spectrum.stability.is_decided())
            + usize::from(self.turn(&solution.tangent).abs() < NEARLY_FOLD)
    }

    fn locate(
        &mut self,
        kind: SpecialKind,
        [before, after]: [&Solution<EquilibriumInspection>; 2],
    ) -> Result<Location<EquilibriumInspection>, Error> {
        let located = match kind {
            SpecialKind::Fold => locating::fold(self, before, after)?,
            SpecialKind::BranchPoint => locating::branch_point(self, before, after)?,
            _ => locating::hopf(self, before, after)?,
        };
        Ok(match located.point.special.as_deref() {
            Some(SpecialPoint::Degenerate { .. }) => Location::Bracketed(located),
            _ => Location::At(located),
        })
    }

    fn locate_crossing(
        &mut self,
        [before, _]: [&Solution<EquilibriumInspection>; 2],
        near: Solution<EquilibriumInspection>,
        change: usize,
        half: f64,
    ) -> Result<Vec<Event<SpecialKind, EquilibriumInspection>>, Error> {
        locating::crossing(self, before, near, change, half)
    }

    fn are_distinct(&self, one: &EquilibriumInspection, other: &EquilibriumInspection) -> bool {
        match (one.special.as_deref(), other.special.as_deref()) {
            (Some(SpecialPoint::Hopf(one)), Some(SpecialPoint::Hopf(other))) => {
                locating::are_distinct(one.frequency, other.frequency)
            }
            _ => false,
        }
    }

    fn widen(&self, point: &mut EquilibriumInspection, reach: f64) {
        if let Some(SpecialPoint::Degenerate { location_error, .. }) = point.special.as_deref_mut() {
            *location_error = location_error.max(reach * self.system.scales[self.dimension()]);
        }
    }

    fn kind_at(&self, point: &EquilibriumInspection) -> Option<SpecialKind> {
        point.special.as_ref().map(|special| special.kind())
    }

    fn changes_at(&self, point: &EquilibriumInspection) -> Option<&'static [usize]> {
        match point.special.as_deref()? {
            SpecialPoint::Hopf(_) => Some(&[2]),
            SpecialPoint::NeutralSaddle(_) => Some(&[0]),
            _ => None,
        }
    }

    fn turns_at(&self, point: &EquilibriumInspection) -> Option<bool> {
        match point.special.as_deref()? {
            SpecialPoint::BranchPoint(point) => Some(point.turns()),
            _ => None,
        }
    }

    fn passage(
        &mut self,
        before: &Solution<EquilibriumInspection>,
        after: &Solution<EquilibriumInspection>,
    ) -> Result<Option<PassageOf<Self>>, Error> {
        self.corner_between(before, after)
    }

    fn enter(&mut self, solution: &Solution<EquilibriumInspection>) {
        self.enter_piece_of(solution);
    }

    fn give_up_piece(&mut self) -> bool {
        self.give_up()
    }

    fn ending(
        &mut self,
        before: &Solution<EquilibriumInspection>,
        after: &Solution<EquilibriumInspection>,
    ) -> Option<Ending<EquilibriumEnd>> {
        let n = self.dimension();
        let range = self.system.scales[n];
        let parameter = after.unknown[n];
        if (parameter - before.unknown[n]).abs() > IDLE * range {
            self.idle_way = 0.0;
            self.has_moved = true;
        } else {
            self.idle_way += distance(self, &before.unknown, &after.unknown);
        }
        let sizes = self.system.scales.iter().zip(&self.first_scales);
        let growth = sizes.map(|(now, first)| now / first).fold(0.0, f64::max);
        let vertical = self.turn(&after.tangent).abs() < VERTICAL;
        let idle = self.idle_way > LONGEST_IDLE_WAY;
        if (vertical && growth > UNBOUNDED_GROWTH) || (idle && self.has_moved) {
            let parameter = self.limit(before, after);
            return Some(Ending::After(Stop::Problem(EquilibriumEnd::StateUnbounded { parameter })));
        }
        if idle {
            return Some(Ending::After(Stop::Problem(EquilibriumEnd::ParameterStandsStill { parameter })));
        }
        // The parameter creeps up to the end of its range and never reaches it.
        let end = [self.bound.lower, self.bound.upper]
            .into_iter()
            .find(|end| (parameter - end).abs() < IDLE * range);
        match end {
            Some(value) if vertical => Some(Ending::After(Stop::RangeEnd { bound: 0, value })),
            _ => None,
        }
    }

    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        let states = unknown.iter().copied().zip(self.system.scales.iter().copied());
        states.take(self.dimension()).collect()
    }
}
