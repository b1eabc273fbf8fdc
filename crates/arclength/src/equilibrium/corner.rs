//! Where a branch of equilibria passes from one piece of a field to the next.
//!
//! In a piece the field is smooth, beyond its border too, and so is the branch. It comes to the border where a switch function has the
//! value of the border. There every piece that meets has equilibria of its own, on a line along its own tangent; those that lie in the
//! piece are half of that line, the half on which the switch functions grow into it. The branch goes on along the half that is not the
//! one by which it came, whatever the angle between both: the parameter turns where both lead to the same side (a non-smooth fold), and
//! nothing happens where the eigenvalues are on the same sides. Source: di Bernardo, Budd, Champneys and Kowalczyk, *Piecewise-smooth
//! Dynamical Systems* (2008), section 5.2; Leine and Nijmeijer, *Dynamics and Bifurcations of Non-Smooth Mechanical Systems* (2004).

use super::curve::{EquilibriumCurve, EquilibriumInspection};
use super::end::EquilibriumEnd;
use super::problem::EquilibriumProblem;
use super::special::SpecialPoint;
use crate::algebraic::{AlgebraicEquations, Differentiator, Solved, length, position, solve_square};
use crate::branch::{SpecialKind, Stability};
use crate::continuation::{
    Equations, Passage, PassageOf, Solution, Stop, correct, distance, finish, metric_image,
};
use crate::erased::NarrowScalar;
use crate::error::Error;

/// Distance, in the metric, within which a solution is on a border: solutions and borders are known no better.
const ON_BORDER: f64 = 1e-9;
/// Distance, in the metric, by which Newton's method in the next piece may move a solution on the border: it is one there, too.
const SAME_PLACE: f64 = 1e-8;
/// Rate at which a branch moves away from a border, in the metric and per length, that is rounding: it stays on the border.
const ALONG_BORDER: f64 = 1e-9;
/// Difference of the tangents, in the metric, of two pieces in which the branch along a border is the same.
const SAME_TANGENT: f64 = 1e-7;
/// Borders that may meet at one place: all combinations of their sides are tried.
const MOST_BORDERS: usize = 8;
/// Parts of a step at which the switch functions, as cubics, are looked at.
const LOOKS: usize = 32;
/// Corners of a step that are tried, each before the one found last.
const MOST_CORNERS: usize = 16;
/// A corner may lie this far, in the metric, outside of the step in which it is found.
const OUTSIDE: f64 = 1e-7;
/// It is no farther from the beginning of the step than this many times the step's length.
const ASIDE: f64 = 1.5;
/// Rate of change of the parameter, as part of its range, whose sign may be rounding.
const NO_TURN: f64 = 1e-9;

type Node = Solution<EquilibriumInspection>;

/// The field and its switch functions.
struct WithSwitches<'p, 'a> {
    problem: &'p EquilibriumProblem<'a>,
    switches: usize,
}

impl AlgebraicEquations for WithSwitches<'_, '_> {
    fn unknowns(&self) -> usize {
        self.problem.unknowns()
    }
    fn equations(&self) -> usize {
        self.problem.dimension + self.switches
    }
    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        self.problem.write_field(unknown, residual);
    }
}

/// The equilibrium at which a switch function has the value of a border.
struct Corner<'p, 'a> {
    all: WithSwitches<'p, 'a>,
    switch: usize,
    value: f64,
}

impl AlgebraicEquations for Corner<'_, '_> {
    fn unknowns(&self) -> usize {
        self.all.unknowns()
    }
    fn equations(&self) -> usize {
        self.all.problem.dimension + 1
    }
    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        let n = self.all.problem.dimension;
        let mut values = vec![T::zero(); self.all.equations()];
        self.all.evaluate(unknown, &mut values);
        residual[..n].copy_from_slice(&values[..n]);
        residual[n] = values[n + self.switch] - T::from(self.value);
    }
}

/// A switch function at a solution.
struct Switch {
    value: f64,
    /// Derivatives in the unknowns.
    gradient: Vec<f64>,
    /// How much it changes on a distance of one in the metric at most.
    size: f64,
}

impl Switch {
    fn rate(&self, tangent: &[f64]) -> f64 {
        self.gradient.iter().zip(tangent).map(|(entry, slope)| entry * slope).sum()
    }
}

/// Half of the line of equilibria of a piece, that lies in the piece.
#[derive(Clone)]
pub(super) struct HalfBranch {
    pub cells: Vec<f64>,
    /// Leads into the piece.
    pub tangent: Vec<f64>,
}

/// A piece of the field around a solution.
pub(super) struct Piece {
    pub cells: Vec<f64>,
    /// Whether the solution is on one of its borders.
    pub is_on_border: bool,
}

/// A border of the cell of a switch function.
#[derive(Clone, Copy)]
struct CellBorder {
    switch: usize,
    is_upper: bool,
}

impl EquilibriumCurve<'_> {
    /// The switch functions by the piece that the curve is in.
    fn switches(&self, unknown: &[f64]) -> Vec<Switch> {
        let (n, scales) = (self.dimension(), &self.system.scales);
        let problem = &self.system.problem;
        let all = WithSwitches { problem, switches: problem.cells().len() };
        let rows = all.equations();
        let mut values = vec![0.0; rows];
        let mut matrix = vec![0.0; rows * (n + 1)];
        Differentiator::default().jacobian(&all, unknown, &mut values, &mut matrix, rows);
        let of_row = |row: usize| {
            let gradient: Vec<f64> = (0..=n).map(|column| matrix[column * rows + row]).collect();
            let scaled = gradient.iter().zip(scales).map(|(entry, scale)| (entry * scale).powi(2));
            Switch { value: values[row], size: scaled.sum::<f64>().sqrt(), gradient }
        };
        (n..rows).map(of_row).collect()
    }

    /// The borders of the cells of the piece that the curve is in.
    fn borders(&self) -> Vec<[f64; 2]> {
        let thresholds = self.pieces.as_ref().map_or(&[][..], |pieces| pieces.thresholds());
        thresholds.iter().zip(self.system.problem.cells()).map(|(one, &cell)| one.borders(cell)).collect()
    }

    /// The piece in which a solution lies.
    pub(super) fn piece_at(&mut self, unknown: &[f64]) -> Option<Piece> {
        let (state, values) = unknown.split_at(self.dimension());
        let parameters = self.system.problem.parameters_at(values);
        let cells = self.pieces.as_ref()?.region_at(state, &parameters);
        let kept = self.system.problem.cells().to_vec();
        self.system.problem.enter(&cells);
        let is_on_border = !self.on_borders(unknown).is_empty();
        self.system.problem.enter(&kept);
        Some(Piece { cells, is_on_border })
    }

    /// As [`Curve::enter`](crate::continuation::Curve::enter).
    pub(super) fn enter_piece_of(&mut self, solution: &Node) {
        if !solution.point.cells.is_empty() {
            self.given_up.clear();
            self.system.problem.enter(&solution.point.cells);
        } else if let Some(Piece { cells, is_on_border: false }) = self.piece_at(&solution.unknown)
            && cells != self.given_up
        {
            self.given_up.clear();
            self.system.problem.enter(&cells);
        }
    }

    /// The borders that a solution is on.
    fn on_borders(&self, unknown: &[f64]) -> Vec<CellBorder> {
        let switches = self.switches(unknown).into_iter().zip(self.borders()).enumerate();
        let on = |(index, (switch, [lower, upper])): (usize, (Switch, [f64; 2]))| {
            let margin = ON_BORDER * switch.size;
            let at = |border: f64| (switch.value - border).abs() <= margin;
            (at(lower) || at(upper)).then(|| CellBorder { switch: index, is_upper: at(upper) })
        };
        switches.filter_map(on).collect()
    }

    /// The halves of branches that meet on a border at a solution, those of the piece with these cells first.
    pub(super) fn half_branches(&mut self, unknown: &[f64], cells: &[f64]) -> Vec<HalfBranch> {
        let kept = self.system.problem.cells().to_vec();
        self.system.problem.enter(cells);
        let on = self.on_borders(unknown);
        let count = on.len().min(MOST_BORDERS);
        let mut choices: Vec<usize> = (0..1 << count).collect();
        choices.sort_by_key(|choice| choice.count_ones());
        let mut halves: Vec<HalfBranch> = Vec::new();
        for choice in choices {
            let flipped = (0..count).filter(|place| choice >> place & 1 == 1).map(|place| on[place]);
            let Some(cells) = self.piece_beyond(unknown, cells, &flipped.collect::<Vec<_>>()) else {
                continue;
            };
            self.system.problem.enter(&cells);
            for half in self.halves_within(unknown, &cells) {
                let is_known =
                    halves.iter().any(|known| self.are_same_tangent(&known.tangent, &half.tangent));
                if !is_known {
                    halves.push(half);
                }
            }
        }
        self.system.problem.enter(&kept);
        halves
    }

    /// The cells beyond some borders; others change only where what they depend on has jumped.
    fn piece_beyond(&mut self, unknown: &[f64], cells: &[f64], flipped: &[CellBorder]) -> Option<Vec<f64>> {
        let thresholds = self.pieces.as_ref()?.thresholds().to_vec();
        let mut next = cells.to_vec();
        for &CellBorder { switch, is_upper } in flipped {
            next[switch] = thresholds[switch].next(cells[switch], is_upper);
        }
        // Those behind may depend on those before.
        for _ in 0..next.len() {
            self.system.problem.enter(&next);
            let outside = self.outside(unknown);
            let Some(&index) = outside.first() else { return Some(next) };
            if flipped.iter().any(|border| border.switch == index) {
                return None;
            }
            next[index] = thresholds[index].cell(self.switches(unknown)[index].value);
        }
        None
    }

    /// The switch functions that are outside of their cells.
    fn outside(&self, unknown: &[f64]) -> Vec<usize> {
        let switches = self.switches(unknown).into_iter().zip(self.borders()).enumerate();
        let outside = switches.filter(|(_, (switch, [lower, upper]))| {
            let margin = ON_BORDER * switch.size;
            switch.value < lower - margin || switch.value > upper + margin
        });
        outside.map(|(index, _)| index).collect()
    }

    /// The halves of the line of equilibria of the piece that the curve is in that lie in it.
    fn halves_within(&mut self, unknown: &[f64], cells: &[f64]) -> Vec<HalfBranch> {
        let Ok(tangent) = self.system.tangent(unknown) else { return Vec::new() };
        let border = metric_image(self, &tangent);
        let mut corrected = unknown.to_vec();
        let settings = self.settings;
        // A field that jumps has no equilibrium here on its other side.
        let is_equilibrium = correct(self, &mut corrected, &border, &settings)
            .is_ok_and(|_| distance(self, unknown, &corrected) <= SAME_PLACE);
        if !is_equilibrium {
            return Vec::new();
        }
        let switches: Vec<(Switch, [f64; 2])> =
            self.switches(unknown).into_iter().zip(self.borders()).collect();
        let directions = [1.0, -1.0].map(|sign| tangent.iter().map(|entry| sign * entry).collect::<Vec<_>>());
        let leads_inside = |tangent: &[f64]| {
            switches.iter().all(|(switch, [lower, upper])| {
                let (rate, margin) = (switch.rate(tangent), ON_BORDER * switch.size);
                let least = -ALONG_BORDER * switch.size;
                ((switch.value - lower).abs() > margin || rate >= least)
                    && ((switch.value - upper).abs() > margin || -rate >= least)
            })
        };
        let inside = directions.into_iter().filter(|tangent| leads_inside(tangent));
        inside.map(|tangent| HalfBranch { cells: cells.to_vec(), tangent }).collect()
    }

    fn are_same_tangent(&self, one: &[f64], other: &[f64]) -> bool {
        distance(self, one, other) <= SAME_TANGENT
    }

    /// As [`Curve::passage`](crate::continuation::Curve::passage).
    pub(super) fn corner_between(
        &mut self,
        before: &Node,
        after: &Node,
    ) -> Result<Option<PassageOf<Self>>, Error> {
        if self.system.problem.cells().is_empty() {
            return Ok(None);
        }
        let mut found: Option<(Solved, Node)> = None;
        for _ in 0..MOST_CORNERS {
            let end = found.as_ref().map_or(after, |(_, node)| node);
            match self.corner_before(before, end)? {
                None => break,
                earlier => found = earlier,
            }
        }
        let Some((solved, arrival)) = found else { return Ok(None) };
        let cells = self.system.problem.cells().to_vec();
        let back: Vec<f64> = arrival.tangent.iter().map(|entry| -entry).collect();
        let mut onward = self.half_branches(&arrival.unknown, &cells);
        onward.retain(|half| !self.are_same_tangent(&half.tangent, &back));
        let straightness = |half: &HalfBranch| distance(self, &half.tangent, &arrival.tangent);
        let straightest =
            onward.iter().min_by(|one, other| straightness(one).total_cmp(&straightness(other))).cloned();
        let Some(half) = straightest else {
            if !self.jumps_at(&arrival, &cells)? {
                // Its derivatives may have no value on the border, as those of `x*sqrt(x)`.
                self.give_up();
                return Err(Error::OtherBranch);
            }
            let parameter = arrival.unknown[self.dimension()];
            let stop = Stop::Problem(EquilibriumEnd::Border { parameter });
            return Ok(Some(Passage { arrival, special: Vec::new(), onward: Err(stop) }));
        };
        self.system.problem.enter(&half.cells);
        let departure = finish(self, arrival.unknown.clone(), &half.tangent);
        self.system.problem.enter(&cells);
        let departure = match departure {
            Err(Error::NotFound { .. }) => {
                self.give_up();
                return Err(Error::OtherBranch);
            }
            departure => departure?,
        };
        let update = solved.last_update.last().copied().unwrap_or(0.0).abs();
        let special = self.special_at_border([&arrival, &departure], onward.len() > 1, update);
        Ok(Some(Passage { arrival, special, onward: Ok(departure) }))
    }

    /// Whether the field of every piece beyond the borders that a solution is on has a value there other than zero.
    fn jumps_at(&mut self, arrival: &Node, cells: &[f64]) -> Result<bool, Error> {
        let border = metric_image(self, &arrival.tangent);
        let mut residual = vec![0.0; arrival.unknown.len()];
        let on = self.on_borders(&arrival.unknown);
        let mut pieces = Vec::new();
        for border in on {
            pieces.extend(self.piece_beyond(&arrival.unknown, cells, &[border]));
        }
        self.system.problem.enter(cells);
        if self.factorize(&arrival.unknown, &border, &mut residual) == 0.0 {
            return Ok(false);
        }
        let mut jumps = !pieces.is_empty();
        for piece in pieces {
            self.system.problem.enter(&piece);
            self.residual(&arrival.unknown, &mut residual);
            *residual.last_mut().unwrap_or(&mut 0.0) = 0.0;
            // How far away the piece before would have such a value.
            self.solve(&mut residual);
            let away = length(&residual, &self.system.scales);
            jumps &= away.is_finite() && away > SAME_PLACE;
        }
        self.system.problem.enter(cells);
        Ok(jumps)
    }

    /// Takes the field as it is from now on, until the curve has left the piece; whether it was in one.
    pub(super) fn give_up(&mut self) -> bool {
        let cells = self.system.problem.cells().to_vec();
        if cells.is_empty() {
            return false;
        }
        self.given_up = cells;
        self.system.problem.enter(&[]);
        true
    }

    /// The solution at which the curve leaves its piece between two others; `None` where it does not.
    ///
    /// # Errors
    /// [`Error::OtherBranch`] where it leaves and the place is not found: shorter steps tell.
    fn corner_before(&mut self, before: &Node, end: &Node) -> Result<Option<(Solved, Node)>, Error> {
        let way = distance(self, &before.unknown, &end.unknown);
        let (here, there) = (self.switches(&before.unknown), self.switches(&end.unknown));
        let borders = self.borders();
        let mut first: Option<(f64, Solved)> = None;
        for (switch, (one, other)) in here.iter().zip(&there).enumerate() {
            let margin = ON_BORDER * one.size.max(other.size);
            let [ahead, behind] =
                [one.rate(&before.tangent), other.rate(&end.tangent)].map(|rate| rate * way);
            for (side, value) in [(-1.0, borders[switch][0]), (1.0, borders[switch][1])] {
                if !value.is_finite() {
                    continue;
                }
                // Positive beyond the border.
                let cubic = |s: f64| side * (hermite([one.value, other.value], [ahead, behind], s) - value);
                let mut looks = (1..=LOOKS).map(|look| look as f64 / LOOKS as f64);
                let Some(beyond) = looks.find(|s| cubic(*s) > margin) else { continue };
                let is_past_end = cubic(1.0) > margin;
                let fraction = crossing(cubic, beyond - 1.0 / LOOKS as f64, beyond);
                let start: Vec<f64> =
                    before.unknown.iter().zip(&end.unknown).map(|(a, b)| a + fraction * (b - a)).collect();
                let problem = &self.system.problem;
                let all = WithSwitches { problem, switches: problem.cells().len() };
                let corner = Corner { all, switch, value };
                let solved = solve_square(&corner, &start, &self.system.scales).ok().filter(|solved| {
                    let place = position(before, &solved.unknown, &self.system.scales);
                    let offset: Vec<f64> =
                        solved.unknown.iter().zip(&before.unknown).map(|(a, b)| a - b).collect();
                    place >= -OUTSIDE
                        && place <= way + OUTSIDE
                        && length(&offset, &self.system.scales) <= ASIDE * way + OUTSIDE
                });
                match solved {
                    Some(solved) => {
                        let place = position(before, &solved.unknown, &self.system.scales);
                        if first.as_ref().is_none_or(|(known, _)| place < *known) {
                            first = Some((place, solved));
                        }
                    }
                    None if is_past_end => {
                        if way < self.settings.shortest_jump {
                            // No shorter step will tell.
                            self.give_up();
                        }
                        return Err(Error::OtherBranch);
                    }
                    // A visit that the cubic invents.
                    None => {}
                }
            }
        }
        let Some((_, solved)) = first else { return Ok(None) };
        match finish(self, solved.unknown.clone(), &before.tangent) {
            Ok(node) => Ok(Some((solved, node))),
            Err(Error::NotFound { .. }) => {
                // The piece has no derivatives there, or is singular.
                self.give_up();
                Err(Error::OtherBranch)
            }
            Err(error) => Err(error),
        }
    }

    /// What is special where one piece ends and the next begins: the parameter turns, or eigenvalues cross.
    ///
    /// The parameter turns where the determinants of both pieces have different signs: then an odd number of eigenvalues crosses
    /// zero. What crosses beside are pairs. Nothing can be said of a normal form.
    pub(super) fn special_at_border(
        &self,
        [arrival, departure]: [&Node; 2],
        branches: bool,
        update: f64,
    ) -> Vec<(SpecialKind, Node)> {
        let [one, other] = [arrival, departure].map(|node| self.turn(&node.tangent));
        let turns = one * other < 0.0 && one.abs().min(other.abs()) > NO_TURN;
        let spectra = [arrival, departure].map(|node| &node.point.spectrum);
        let is_decided = spectra.iter().all(|spectrum| spectrum.stability.is_decided());
        let change = if is_decided { spectra[0].unstable.abs_diff(spectra[1].unstable) } else { 0 };
        let left = change.saturating_sub(usize::from(turns));
        let kinds = [
            (turns, SpecialKind::Fold),
            (branches || left % 2 == 1, SpecialKind::BranchPoint),
            (left >= 2, SpecialKind::Hopf),
        ];
        let value = arrival.unknown[self.dimension()];
        let location_error = update.max(f64::EPSILON * value.abs());
        let stability =
            if spectra.iter().all(|spectrum| matches!(spectrum.stability, Stability::Unstable { .. })) {
                Stability::Unstable { dimension: None }
            } else {
                Stability::Undecided
            };
        let present = kinds.into_iter().filter(|(is_present, _)| *is_present);
        present
            .map(|(_, of)| {
                let mut node = arrival.clone();
                let special = SpecialPoint::Degenerate { of, value, location_error, at_border: true };
                node.point.special = Some(Box::new(special));
                node.point.spectrum.stability = stability;
                (of, node)
            })
            .collect()
    }
}

/// The cubic with these values and changes at both ends.
fn hermite([one, other]: [f64; 2], [ahead, behind]: [f64; 2], s: f64) -> f64 {
    let step = s * s * (3.0 - 2.0 * s);
    one + step * (other - one) + s * (1.0 - s) * (1.0 - s) * ahead + s * s * (s - 1.0) * behind
}

/// Where a function that is positive at `high` ceases to be so, by halves towards `low`.
fn crossing(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    /// Newton's method does the rest.
    const HALVINGS: usize = 20;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if function(middle) > 0.0 { high = middle } else { low = middle }
    }
    high
}
