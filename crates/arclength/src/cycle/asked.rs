//! A branch of limit cycles that is asked for, once the request is checked: its curve, and how a start is followed, whatever it is.

use super::curve::{Birth, CycleCurve, CycleInspection};
use super::end::CycleEnd;
use super::limit_cycle::LimitCycle;
use super::switching::Departure;
use crate::branch::SpecialKind;
use crate::collocation::equations::Collocation;
use crate::collocation::resolution::Resolution;
use crate::continuation::{
    Bound, Curve, Equations, Followed, Observer, Request, Settings, Solution, Stop, follow,
};
use crate::erased::ErasedField;
use crate::error::{CorrectionFailure, Error};

/// Times that the distance of a first cycle is reduced before a start is given up.
pub(super) const MOST_REDUCTIONS: usize = 6;

pub(super) type FollowedCycles = Followed<CycleInspection, SpecialKind, CycleEnd>;

/// A checked request.
pub(super) struct Asked<'a> {
    pub field: ErasedField<'a>,
    pub parameters: Vec<f64>,
    pub active: usize,
    pub bound: Bound,
    pub resolution: Resolution,
    pub settings: Settings,
}

impl<'a> Asked<'a> {
    pub(super) fn problem(&self) -> LimitCycle<'a> {
        LimitCycle {
            field: self.field,
            parameters: self.parameters.clone(),
            active: self.active,
            scales: vec![1.0; self.field.dimension()],
            segments: None,
        }
    }

    pub(super) fn curve(&self, start: &Departure) -> CycleCurve<'a> {
        let collocation = Collocation::new(self.problem(), start.mesh.clone(), start.degree);
        let mut curve = CycleCurve::new(collocation, self.resolution, self.bound.width(), &start.unknown);
        curve.settings = self.settings.for_locating();
        curve
    }

    /// Follows the branch from a start in the direction of its tangent.
    pub(super) fn follow(
        &self,
        start: &Departure,
        birth: Birth,
        request: &Request<'_, CycleInspection>,
        observer: &mut Observer<'_, CycleInspection, SpecialKind>,
    ) -> Result<FollowedCycles, Error> {
        let mut curve = self.curve(start);
        curve.birth = birth;
        let mut followed =
            follow(&mut curve, start.unknown.clone(), start.tangent.clone(), request, observer)?;
        if matches!(followed.stop, Stop::StepTooSmall { .. }) {
            let solutions: Vec<_> = followed.solutions.iter().map(|(solution, _)| solution).collect();
            if let Some(grazing) = curve.grazing_ahead(&solutions) {
                followed.stop = Stop::Problem(grazing);
            }
        }
        Ok(followed)
    }

    /// The first run that finds a cycle, at ever smaller distances.
    pub(super) fn first_of(
        &self,
        mut distance: f64,
        reduction: f64,
        mut run: impl FnMut(f64) -> Result<FollowedCycles, Error>,
    ) -> Result<FollowedCycles, Error> {
        let mut failure = None;
        for _ in 0..MOST_REDUCTIONS {
            match run(distance) {
                Err(Error::NotFound { sought, cause }) => {
                    failure.get_or_insert(Error::NotFound { sought, cause });
                    distance *= reduction;
                }
                result => return result,
            }
        }
        Err(failure.unwrap_or(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged }))
    }

    /// A start as it is given, with its multipliers.
    pub(super) fn unsolved(&self, start: &Departure) -> Result<Solution<CycleInspection>, Error> {
        let mut curve = self.curve(start);
        let mut border = vec![0.0; start.tangent.len()];
        curve.apply_metric(&start.tangent, &mut border);
        let mut residual = vec![0.0; start.tangent.len()];
        curve.estimate_error(&start.unknown);
        // It may be singular there, but the multipliers do not need the border.
        curve.factorize(&start.unknown, &border, &mut residual);
        let point = curve.inspect(&start.unknown, &start.tangent, 0.0)?;
        Ok(Solution {
            unknown: start.unknown.clone(),
            tangent: start.tangent.clone(),
            orientation: 0.0,
            point,
        })
    }
}
