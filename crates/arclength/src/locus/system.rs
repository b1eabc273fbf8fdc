//! The equations of a curve of special equilibria, of whichever kind: everything behind them is compiled once and not for every kind.

use super::held_equilibria::HeldSystem;
use super::kind::LocusKind;
use crate::algebraic::AlgebraicEquations;
use crate::equilibrium::defining::{BranchPointSystem, FoldSystem, HopfSystem};
use crate::erased::NarrowScalar;
use std::ops::{Deref, DerefMut};

/// The equations of a curve of one kind of equilibria in two parameters.
#[derive(Clone)]
pub(super) enum LocusSystem<'a> {
    Fold(FoldSystem<'a>),
    Hopf(HopfSystem<'a>),
    BranchPoint(BranchPointSystem<'a>),
    Held(HeldSystem<'a>),
}

impl<'a> Deref for LocusSystem<'a> {
    type Target = dyn LocusKind<'a> + 'a;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Fold(system) => system,
            Self::Hopf(system) => system,
            Self::BranchPoint(system) => system,
            Self::Held(system) => system,
        }
    }
}

impl DerefMut for LocusSystem<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Fold(system) => system,
            Self::Hopf(system) => system,
            Self::BranchPoint(system) => system,
            Self::Held(system) => system,
        }
    }
}

impl AlgebraicEquations for LocusSystem<'_> {
    fn unknowns(&self) -> usize {
        match self {
            Self::Fold(system) => system.unknowns(),
            Self::Hopf(system) => system.unknowns(),
            Self::BranchPoint(system) => system.unknowns(),
            Self::Held(system) => system.unknowns(),
        }
    }

    fn equations(&self) -> usize {
        self.unknowns() - 1
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        match self {
            Self::Fold(system) => system.evaluate(unknown, residual),
            Self::Hopf(system) => system.evaluate(unknown, residual),
            Self::BranchPoint(system) => system.evaluate(unknown, residual),
            Self::Held(system) => system.evaluate(unknown, residual),
        }
    }
}
