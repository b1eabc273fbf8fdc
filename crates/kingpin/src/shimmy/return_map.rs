//! The return map of a periodic motion with sliding phases, with its derivatives: what Newton's method makes a zero of.
//!
//! A motion starts inside one of its phases, where its states are five (rolling) or seven (sliding), and has to come back to its
//! start after the period, up to whole turns of the caster. The start is fixed on the orbit by a plane across it.

use super::error::Refusal;
use super::passage::{Passage, difference, passages};
use super::variation::{Columns, DIRECTIONS, PARAMETER, STATES, carry, varied_equations};
use crate::parameters::Key;
use crate::sliding::model::SlipState;
use crate::sliding::{Contact, HybridState, ONSET_SLIP, SlidingWheel, VANISHING_SLIP};
use crate::wheel::Wheel;
use arclength::control::{Control, Interrupted};
use arclength::linear::lu;
use std::f64::consts::TAU;

/// Index of the caster angle.
pub(super) const PSI: usize = 2;
/// The states that are free where the wheel rolls.
const FREE_WHILE_ROLLING: [usize; 5] = [0, 1, PSI, 3, 5];
/// The states that are free where it slides.
const FREE_WHILE_SLIDING: [usize; 7] = [0, 1, 2, 3, 4, 5, 6];
/// Most repetitions of a motion in what is taken for its period.
const MOST_REPETITIONS: i32 = 12;
/// States that differ by less than this part of their size are the same.
const SAME: f64 = 1e-6;
/// Most updates of Newton's method.
const MOST_UPDATES: usize = 15;
/// An update, relative to the size of the motion, at which Newton's method has converged.
const CONVERGED: f64 = 1e-7;
/// An update that is as small as the tolerance of the integration lets it be, in units of that tolerance.
const ROUNDING: f64 = 10.0;

/// A start of a periodic motion.
#[derive(Clone, Debug)]
pub(super) struct Start {
    pub state: HybridState,
    pub period: f64,
}

/// The return map near a periodic motion.
#[derive(Clone, Debug)]
pub(super) struct ReturnMap {
    pub wheel: Wheel,
    /// The parameter that varies, with its unit.
    pub parameter: Option<(Key, f64)>,
    /// Where the motion starts; the plane through it fixes the phase.
    pub reference: HybridState,
    /// Normal of that plane in scaled states.
    pub normal: SlipState,
    /// Sizes of the states.
    pub scales: [f64; STATES],
    /// Size of the period.
    pub period_scale: f64,
    /// Turns of the caster in a period.
    pub turns: i32,
    pub tolerance: f64,
    /// Slip speeds in m/s up to which slip keeps its limit direction, and at which it is taken straight to zero.
    pub slips: [f64; 2],
    /// The passages that the motion has to have, where that is known.
    pub expected: Option<Vec<Passage>>,
}

/// The return map at a start.
#[derive(Clone, Debug)]
pub(super) struct Return {
    /// State after the period less that at the start, in units of the scales; then the distance from the plane.
    pub residual: Vec<f64>,
    /// Derivatives with respect to the scaled states, the scaled period and the scaled parameter; column by column.
    pub jacobian: Vec<f64>,
    pub passages: Vec<Passage>,
}

impl ReturnMap {
    /// The map near a start.
    ///
    /// # Errors
    /// What [`Wheel::sliding`] refuses.
    pub(super) fn new(
        wheel: &Wheel,
        start: &Start,
        scales: [f64; STATES],
        turns: i32,
        tolerance: f64,
    ) -> Result<Self, Refusal> {
        let mut map = Self {
            wheel: *wheel,
            parameter: None,
            reference: start.state,
            normal: [0.0; STATES],
            scales,
            period_scale: start.period,
            turns,
            tolerance,
            slips: [ONSET_SLIP, VANISHING_SLIP],
            expected: None,
        };
        map.set_reference(start.state)?;
        Ok(map)
    }

    /// Lays the plane through another state.
    pub(super) fn set_reference(&mut self, reference: HybridState) -> Result<(), Refusal> {
        let rate = self.sliding()?.rate(&reference);
        let scaled: SlipState = std::array::from_fn(|i| rate[i] / self.scales[i]);
        let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.normal = scaled.map(|x| x / length);
        self.reference = reference;
        Ok(())
    }

    pub(super) fn sliding(&self) -> Result<SlidingWheel, Refusal> {
        let [onset, vanishing] = self.slips;
        Ok(self.wheel.sliding().map_err(Refusal::from)?.slips(onset, vanishing).tolerance(self.tolerance))
    }

    /// The states that vary at the start.
    pub(super) fn free(&self) -> &'static [usize] {
        match self.reference.contact {
            Contact::Rolling => &FREE_WHILE_ROLLING,
            Contact::Sliding => &FREE_WHILE_SLIDING,
        }
    }

    /// Passages over a period, with samples at `times`.
    ///
    /// # Errors
    /// [`Refusal`].
    pub(super) fn follow(
        &self,
        start: &Start,
        times: &[f64],
        control: &Control<'_>,
    ) -> Result<(Vec<Passage>, HybridState), Refusal> {
        if !(start.period > 0.0 && start.period.is_finite()) {
            return Err(Refusal::Integration(format!("the period became {} s", start.period)));
        }
        Ok(passages(&self.sliding()?, start.state, start.period, times, &control.quiet())?)
    }

    /// The start of the same motion that lies later by `time`.
    ///
    /// # Errors
    /// [`Refusal`].
    pub(super) fn start_after(
        &self,
        start: &Start,
        time: f64,
        control: &Control<'_>,
    ) -> Result<Start, Refusal> {
        if time <= 0.0 {
            return Ok(start.clone());
        }
        let state = self.follow(&Start { period: time, ..start.clone() }, &[], control)?.1;
        Ok(Start { state, period: start.period })
    }

    /// How often the motion repeats itself in what is taken for its period, where that is more than once.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub(super) fn repetitions(
        &self,
        start: &Start,
        control: &Control<'_>,
    ) -> Result<Option<i32>, Interrupted> {
        for parts in (2..=MOST_REPETITIONS).rev().filter(|parts| self.turns % parts == 0) {
            let part = Start { period: start.period / f64::from(parts), ..start.clone() };
            let end = match self.follow(&part, &[], control) {
                Ok((_, end)) => end,
                Err(Refusal::Interrupted(interrupted)) => return Err(interrupted),
                Err(_) => continue,
            };
            let is_same = |&i: &usize| {
                let turn = if i == PSI { TAU * f64::from(self.turns / parts) } else { 0.0 };
                ((end.state[i] - start.state.state[i] - turn) / self.scales[i]).abs() < SAME
            };
            if end.contact == start.state.contact && self.free().iter().all(is_same) {
                return Ok(Some(parts));
            }
        }
        Ok(None)
    }

    /// The map at a start, with the derivatives unless only the residual is wanted.
    ///
    /// # Errors
    /// [`Refusal`].
    pub(super) fn evaluate(
        &self,
        start: &Start,
        with_derivatives: bool,
        control: &Control<'_>,
    ) -> Result<Return, Refusal> {
        let (passages, end) = self.follow(start, &[], control)?;
        if let Some(expected) = &self.expected
            && let Some(grazing) = difference(expected, &passages)
        {
            return Err(Refusal::Grazing(grazing));
        }
        let free = self.free();
        let d = free.len();
        let mut residual = Vec::with_capacity(d + 1);
        for &i in free {
            let mut change = end.state[i] - start.state.state[i];
            if i == PSI {
                change -= TAU * f64::from(self.turns);
            }
            residual.push(change / self.scales[i]);
        }
        let offset = |i: usize| (start.state.state[i] - self.reference.state[i]) / self.scales[i];
        residual.push(free.iter().map(|&i| self.normal[i] * offset(i)).sum());
        let mut jacobian = Vec::new();
        if with_derivatives {
            if end.contact != self.reference.contact {
                return Err(Refusal::Integration("the motion ends in another phase than it began".into()));
            }
            let columns = self.carry_identity(&passages)?;
            let rate = self.sliding()?.rate(&end);
            jacobian.resize((d + 1) * (d + 2), 0.0);
            for (column, entries) in jacobian.chunks_exact_mut(d + 1).enumerate() {
                for (row, &i) in free.iter().enumerate() {
                    entries[row] = match column {
                        _ if column < d => {
                            columns[i][free[column]] / self.scales[i] - f64::from(row == column)
                        }
                        _ if column == d => rate[i] * self.period_scale / self.scales[i],
                        _ => columns[i][PARAMETER] / self.scales[i],
                    };
                }
                if column < d {
                    entries[d] = self.normal[free[column]];
                }
            }
        }
        Ok(Return { residual, jacobian, passages })
    }

    fn carry_identity(&self, passages: &[Passage]) -> Result<Columns, Refusal> {
        let mut columns = [[0.0; DIRECTIONS]; STATES];
        for &i in self.free() {
            columns[i][i] = self.scales[i];
        }
        self.carry(passages, &mut columns)?;
        Ok(columns)
    }

    /// Carries derivatives along passages.
    ///
    /// # Errors
    /// A motion that cannot be followed.
    pub(super) fn carry(&self, passages: &[Passage], columns: &mut Columns) -> Result<(), Refusal> {
        let equations = varied_equations(&self.wheel, self.parameter);
        carry(&equations, passages, columns, &self.scales, self.tolerance)
    }

    /// Moves a start by scaled changes of its states and its period.
    pub(super) fn moved(&self, start: &Start, change: &[f64], sign: f64) -> Start {
        let mut moved = start.clone();
        for (&i, change) in self.free().iter().zip(change) {
            moved.state.state[i] += sign * change * self.scales[i];
        }
        moved.period += sign * change[self.free().len()] * self.period_scale;
        moved
    }

    /// Newton's method at a fixed parameter. The sequence of passages may change on the way but not at the end.
    ///
    /// # Errors
    /// [`Refusal`].
    pub(super) fn solve(&mut self, start: &Start, control: &Control<'_>) -> Result<(Start, Return), Refusal> {
        let mut start = start.clone();
        let mut previous = f64::INFINITY;
        for _ in 0..MOST_UPDATES {
            let image = self.evaluate(&start, true, control)?;
            let update = newton_update(&image)?;
            let length = update.iter().map(|x| x * x).sum::<f64>().sqrt();
            if !length.is_finite() {
                return Err(Refusal::Diverged { update: length });
            }
            let small = length < CONVERGED && (length > 0.1 * previous || length < ROUNDING * self.tolerance);
            if small {
                self.expected = Some(image.passages.clone());
                return Ok((start, image));
            }
            // Far away only part of the way: the sequence of passages may not be that of the solution.
            let part = (0.5 / length).min(1.0);
            let damped: Vec<f64> = update.iter().map(|x| part * x).collect();
            start = self.moved(&start, &damped, -1.0);
            previous = length;
        }
        Err(Refusal::Diverged { update: previous })
    }
}

/// Solves for the change of states and period that Newton's method asks for.
pub(super) fn newton_update(image: &Return) -> Result<Vec<f64>, Refusal> {
    let n = image.residual.len();
    let mut matrix = image.jacobian[..n * n].to_vec();
    let mut pivots = vec![0; n];
    let mut update = image.residual.clone();
    if lu::factorize(&mut matrix, n, &mut pivots) == 0.0 {
        return Err(Refusal::Singular);
    }
    lu::solve(&matrix, n, &pivots, &mut update);
    Ok(update)
}
