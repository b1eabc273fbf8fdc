//! The interior systems of the intervals of a collocation, factorised for groups of [`LANES`] neighbours together, with the
//! responses of the interior to left ends and scalars.
//!
//! Where a problem consists of a cycle and of functions that its linearisation carries along, as defining systems of special
//! cycles do, the systems are block triangular, and all blocks on the diagonal are that of the cycle, or for two functions that
//! turn into each other its complex counterpart: they are factorised block by block, in an eighth to a fifth of the operations.

use super::gauss::Gauss;
use crate::linear::lane_entry::{ComplexLanes, Entry, LANES, Lanes};
use crate::linear::lu_in_lanes::{self, Exchange};
use std::borrow::Cow;

/// What is known of the derivatives of a field in its components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// Nothing.
    Dense,
    /// The second half of the components is carried along by the first: `u' = g(u)`, `v' = g_u v + ..`.
    Carried,
    /// So are the second and the last third, as real and imaginary part of a function that turns: `(v + i w)' = (g_u - i theta)
    /// (v + i w) + ..`.
    Turning,
}

impl Structure {
    /// The number of leading components among `n`, which do not depend on the others.
    pub(super) fn leading(self, n: usize) -> usize {
        match self {
            Self::Dense => n,
            Self::Carried => n / 2,
            Self::Turning => n / 3,
        }
    }
}

/// The linearised field.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinearField<'a> {
    pub mesh: &'a [f64],
    /// Derivatives at all Gauss points, `n` by `n + E` column-major for each.
    pub derivatives: &'a [f64],
}

/// The interior systems and their factors; memory is kept from one factorisation to the next.
#[derive(Debug, Clone)]
pub(super) struct Interior {
    layout: Layout,
    structure: Structure,
    /// For each group of intervals: LU factors of the systems of the leading components, and behind them their responses to the
    /// leading left ends and the scalars. Lanes behind the last interval repeat it.
    leading: Vec<Lanes>,
    /// For each group the responses of all components, where these are not the leading ones: `n + E` columns.
    responses: Vec<Lanes>,
    /// For each group: LU factors of the systems of turning pairs; behind them the responses that they are solved for with.
    turning: Vec<ComplexLanes>,
    /// Rows exchanged in the factorisations, of the leading systems and of the turning ones, and for each group whether there are any.
    exchanges: [Vec<Exchange>; 2],
    exchanged: [Vec<bool>; 2],
    /// For each group the derivatives of the carried components in the leading ones, times the widths.
    couplings: Vec<Lanes>,
    /// Derivatives of one group times the widths.
    scaled: Vec<Lanes>,
    /// The leading or carried part of one column.
    part: Vec<Lanes>,
    pair: Vec<ComplexLanes>,
}

/// Where what is: all columns hold `n` components for every Gauss point one after the other.
#[derive(Debug, Clone)]
struct Layout {
    gauss: Cow<'static, Gauss>,
    /// Numbers of components, all and leading ones, and of scalars.
    n: usize,
    leading: usize,
    scalars: usize,
}

impl Interior {
    pub(super) fn new(degree: usize, n: usize, scalars: usize, structure: Structure) -> Self {
        let leading = structure.leading(n);
        Self {
            layout: Layout { gauss: Gauss::of(degree), n, leading, scalars },
            structure,
            leading: Vec::new(),
            responses: Vec::new(),
            turning: Vec::new(),
            exchanges: [Vec::new(), Vec::new()],
            exchanged: [Vec::new(), Vec::new()],
            couplings: Vec::new(),
            scaled: vec![Lanes::ZERO; degree * n * (n + scalars)],
            part: vec![Lanes::ZERO; degree * leading],
            pair: vec![ComplexLanes::ZERO; degree * leading],
        }
    }

    #[inline(always)]
    pub(super) fn gauss(&self) -> &Gauss {
        &self.layout.gauss
    }

    /// Makes room for a number of groups.
    pub(super) fn prepare(&mut self, groups: usize) {
        let layout = &self.layout;
        self.leading.resize(groups * layout.leading_system(), Lanes::ZERO);
        let systems = if self.structure == Structure::Turning { 2 } else { 1 };
        for (exchanges, exchanged) in self.exchanges.iter_mut().zip(&mut self.exchanged).take(systems) {
            exchanges.resize(groups * layout.rows(), [0; LANES]);
            exchanged.resize(groups, false);
        }
        if self.structure != Structure::Dense {
            self.responses.resize(groups * layout.whole_response(), Lanes::ZERO);
            self.couplings.resize(groups * layout.couplings(), Lanes::ZERO);
        }
        if self.structure == Structure::Turning {
            self.turning.resize(groups * layout.turning_system(), ComplexLanes::ZERO);
        }
    }

    /// Responses of the interior of a group to left ends and scalars: `n + E` columns of `m n` numbers.
    #[inline(always)]
    pub(super) fn response(&self, group: usize) -> &[Lanes] {
        let layout = &self.layout;
        if self.structure == Structure::Dense {
            let square = layout.rows() * layout.rows();
            &self.leading[group * layout.leading_system()..][square..layout.leading_system()]
        } else {
            &self.responses[group * layout.whole_response()..][..layout.whole_response()]
        }
    }

    /// Factorises the systems of a group of intervals and forms their responses; whether they are regular.
    #[inline(always)]
    pub(super) fn factorize<const FUSED: bool>(&mut self, group: usize, field: LinearField<'_>) -> bool {
        let widths = self.scale(group, field);
        let layout = &self.layout;
        let (rows, leading) = (layout.rows(), layout.leading);
        let matrix = &mut self.leading[group * layout.leading_system()..][..layout.leading_system()];
        let (square, response) = matrix.split_at_mut(rows * rows);
        layout.fill_square(&self.scaled, square);
        response.fill(Lanes::ZERO);
        let (to_states, to_scalars) = response.split_at_mut(leading * rows);
        layout.fill_units(to_states);
        for (scalar, target) in to_scalars.chunks_exact_mut(rows).enumerate() {
            layout.integrate_scalar::<FUSED>(&self.scaled, scalar, (0, leading), target);
        }
        let exchanges = &mut self.exchanges[0][group * rows..(group + 1) * rows];
        let Some(exchanged) = lu_in_lanes::factorize_and_solve::<FUSED, Lanes>(matrix, rows, exchanges)
        else {
            return false;
        };
        self.exchanged[0][group] = exchanged;
        self.structure == Structure::Dense
            || self.respond_with_carried::<FUSED>(group, widths * Lanes::from(self.rotation(field)))
    }

    /// The derivatives of a group times the widths of its intervals, as far as they are read, and these widths.
    #[inline(always)]
    fn scale(&mut self, group: usize, field: LinearField<'_>) -> Lanes {
        let Layout { n, leading, .. } = self.layout;
        let columns = n + self.layout.scalars;
        let intervals = field.mesh.len() - 1;
        let points = self.layout.gauss.degree();
        let mut widths = Lanes::ZERO;
        for lane in 0..LANES {
            let interval = (group * LANES + lane).min(intervals - 1);
            let width = field.mesh[interval + 1] - field.mesh[interval];
            widths.0[lane] = width;
            let here = &field.derivatives[interval * points * n * columns..][..points * n * columns];
            if self.structure == Structure::Dense {
                for (target, derivative) in self.scaled.iter_mut().zip(here) {
                    target.0[lane] = width * derivative;
                }
                continue;
            }
            for (block, target) in
                here.chunks_exact(n * columns).zip(self.scaled.chunks_exact_mut(n * columns))
            {
                for range in [0..leading * n, n * n..n * columns] {
                    for (target, derivative) in target[range.clone()].iter_mut().zip(&block[range]) {
                        target.0[lane] = width * derivative;
                    }
                }
            }
        }
        widths
    }

    /// The rate `theta` at which a pair turns.
    #[inline(always)]
    fn rotation(&self, field: LinearField<'_>) -> f64 {
        let Layout { n, leading, .. } = self.layout;
        if self.structure == Structure::Turning { field.derivatives[2 * leading * n + leading] } else { 0.0 }
    }

    /// The responses of all components, from those of the leading ones; `angles` are those by which pairs turn in an interval.
    #[inline(always)]
    fn respond_with_carried<const FUSED: bool>(&mut self, group: usize, angles: Lanes) -> bool {
        let layout = &self.layout;
        let Layout { n, leading, scalars, .. } = *layout;
        let (rows, inner) = (layout.rows(), layout.inner());
        let couplings = &mut self.couplings[group * layout.couplings()..][..layout.couplings()];
        layout.take_couplings(&self.scaled, couplings);
        let system = &self.leading[group * layout.leading_system()..][..layout.leading_system()];
        let (factors, own_responses) = system.split_at(rows * rows);
        let responses = &mut self.responses[group * layout.whole_response()..][..layout.whole_response()];
        responses.fill(Lanes::ZERO);
        let places = (0..leading).chain(n..n + scalars);
        for (own, place) in own_responses.chunks_exact(rows).zip(places.clone()) {
            let column = &mut responses[place * inner..(place + 1) * inner];
            layout.scatter(own, 0, column);
            if place >= n {
                layout.integrate_scalar::<FUSED>(&self.scaled, place - n, (leading, n - leading), column);
            }
            layout.couple::<FUSED>(couplings, column);
        }
        if self.structure == Structure::Carried {
            let exchanges = self.exchanged[0][group].then(|| &self.exchanges[0][group * rows..][..rows]);
            for place in places {
                let column = &mut responses[place * inner..(place + 1) * inner];
                layout.gather(column, leading, &mut self.part);
                lu_in_lanes::solve::<FUSED, Lanes>(factors, rows, exchanges, &mut self.part);
                layout.scatter(&self.part, leading, column);
            }
            for (own, place) in own_responses.chunks_exact(rows).zip(leading..n) {
                layout.scatter(own, leading, &mut responses[place * inner..(place + 1) * inner]);
            }
            return true;
        }
        let system = &mut self.turning[group * layout.turning_system()..][..layout.turning_system()];
        let (square, pairs) = system.split_at_mut(rows * rows);
        layout.fill_square(&self.scaled, square);
        layout.turn(angles, square);
        let (to_pair, to_others) = pairs.split_at_mut(leading * rows);
        to_pair.fill(ComplexLanes::ZERO);
        layout.fill_units(to_pair);
        for (pair, place) in to_others.chunks_exact_mut(rows).zip(places.clone()) {
            layout.gather_pair(&responses[place * inner..(place + 1) * inner], pair);
        }
        let exchanges = &mut self.exchanges[1][group * rows..(group + 1) * rows];
        let Some(exchanged) =
            lu_in_lanes::factorize_and_solve::<FUSED, ComplexLanes>(system, rows, exchanges)
        else {
            return false;
        };
        self.exchanged[1][group] = exchanged;
        let (to_pair, to_others) = system[rows * rows..].split_at(leading * rows);
        for (pair, place) in to_others.chunks_exact(rows).zip(places) {
            layout.scatter_pair(pair.iter().copied(), &mut responses[place * inner..(place + 1) * inner]);
        }
        for (pair, place) in to_pair.chunks_exact(rows).zip(leading..2 * leading) {
            layout.scatter_pair(pair.iter().copied(), &mut responses[place * inner..(place + 1) * inner]);
            let place = place + leading;
            let times_i = pair.iter().map(|entry| ComplexLanes { re: -entry.im, im: entry.re });
            layout.scatter_pair(times_i, &mut responses[place * inner..(place + 1) * inner]);
        }
        true
    }

    /// Replaces a right-hand side of the systems of a group by the interior values that belong to it.
    #[inline(always)]
    pub(super) fn solve<const FUSED: bool>(&mut self, group: usize, values: &mut [Lanes]) {
        let layout = &self.layout;
        let (rows, leading) = (layout.rows(), layout.leading);
        let factors = &self.leading[group * layout.leading_system()..][..rows * rows];
        let exchanges = self.exchanged[0][group].then(|| &self.exchanges[0][group * rows..][..rows]);
        if self.structure == Structure::Dense {
            return lu_in_lanes::solve::<FUSED, Lanes>(factors, rows, exchanges, values);
        }
        layout.gather(values, 0, &mut self.part);
        lu_in_lanes::solve::<FUSED, Lanes>(factors, rows, exchanges, &mut self.part);
        layout.scatter(&self.part, 0, values);
        let couplings = &self.couplings[group * layout.couplings()..][..layout.couplings()];
        layout.couple::<FUSED>(couplings, values);
        if self.structure == Structure::Carried {
            layout.gather(values, leading, &mut self.part);
            lu_in_lanes::solve::<FUSED, Lanes>(factors, rows, exchanges, &mut self.part);
            layout.scatter(&self.part, leading, values);
        } else {
            layout.gather_pair(values, &mut self.pair);
            let factors = &self.turning[group * layout.turning_system()..][..rows * rows];
            let exchanges = self.exchanged[1][group].then(|| &self.exchanges[1][group * rows..][..rows]);
            lu_in_lanes::solve::<FUSED, ComplexLanes>(factors, rows, exchanges, &mut self.pair);
            layout.scatter_pair(self.pair.iter().copied(), values);
        }
    }
}

impl Layout {
    /// Number of interior unknowns of an interval.
    #[inline(always)]
    fn inner(&self) -> usize {
        self.gauss.degree() * self.n
    }

    /// Number of rows of a leading or turning system.
    #[inline(always)]
    fn rows(&self) -> usize {
        self.gauss.degree() * self.leading
    }

    /// Numbers of a leading system with its responses.
    #[inline(always)]
    fn leading_system(&self) -> usize {
        self.rows() * (self.rows() + self.leading + self.scalars)
    }

    /// Numbers of a turning system with its responses to its own left ends, those of the leading components and the scalars.
    #[inline(always)]
    fn turning_system(&self) -> usize {
        self.rows() * (self.rows() + 2 * self.leading + self.scalars)
    }

    /// Numbers of the responses of all components.
    #[inline(always)]
    fn whole_response(&self) -> usize {
        self.inner() * (self.n + self.scalars)
    }

    /// Numbers of the couplings of a group.
    #[inline(always)]
    fn couplings(&self) -> usize {
        self.rows() * (self.n - self.leading)
    }

    /// The system of the leading components. Column `(k, c)`: unit vector minus `a_ik` times the derivatives in component `c` at Gauss
    /// point `k`, times the width.
    #[inline(always)]
    fn fill_square<E: Entry>(&self, scaled: &[Lanes], square: &mut [E]) {
        let (rows, leading, degree) = (self.rows(), self.leading, self.gauss.degree());
        let columns = self.n + self.scalars;
        for (k, block) in square.chunks_exact_mut(leading * rows).enumerate() {
            for (component, target) in block.chunks_exact_mut(rows).enumerate() {
                let slope = &scaled[(k * columns + component) * self.n..][..leading];
                for (i, entries) in target.chunks_exact_mut(leading).enumerate() {
                    let factor = -self.gauss.integration[i * degree + k];
                    for (entry, value) in entries.iter_mut().zip(slope) {
                        *entry = E::from(value.map(|value| factor * value));
                    }
                }
                let diagonal = &mut target[k * leading + component];
                *diagonal = E::from(Lanes::ONE) + *diagonal;
            }
        }
    }

    /// Adds to the system of the leading components that pairs turn: `i theta a_ik` times the width.
    #[inline(always)]
    fn turn(&self, angles: Lanes, square: &mut [ComplexLanes]) {
        let (rows, leading, degree) = (self.rows(), self.leading, self.gauss.degree());
        for (column, target) in square.chunks_exact_mut(rows).enumerate() {
            let (k, component) = (column / leading, column % leading);
            for (i, entry) in target.iter_mut().skip(component).step_by(leading).enumerate() {
                entry.im = Lanes::from(self.gauss.integration[i * degree + k]) * angles;
            }
        }
    }

    /// Right-hand sides that belong to left ends of the leading components, into zeros.
    #[inline(always)]
    fn fill_units<E: Entry>(&self, columns: &mut [E]) {
        for (component, target) in columns.chunks_exact_mut(self.rows()).enumerate() {
            for entry in target.iter_mut().skip(component).step_by(self.leading) {
                *entry = E::from(Lanes::ONE);
            }
        }
    }

    /// Adds the right-hand side that belongs to a scalar, in the components from `first` on, `count` of them, to a column that may have
    /// all components or the leading ones only.
    #[inline(always)]
    fn integrate_scalar<const FUSED: bool>(
        &self,
        scaled: &[Lanes],
        scalar: usize,
        (first, count): (usize, usize),
        column: &mut [Lanes],
    ) {
        let degree = self.gauss.degree();
        for (i, entries) in column.chunks_exact_mut(column.len() / degree).enumerate() {
            for k in 0..degree {
                let slope =
                    &scaled[(k * (self.n + self.scalars) + self.n + scalar) * self.n + first..][..count];
                let factor = Lanes::from(self.gauss.integration[i * degree + k]);
                for (entry, value) in entries[first..].iter_mut().zip(slope) {
                    *entry = entry.plus::<FUSED>(factor, *value);
                }
            }
        }
    }

    /// The derivatives of the carried components in the leading ones: for each Gauss point a block, column-major.
    #[inline(always)]
    fn take_couplings(&self, scaled: &[Lanes], couplings: &mut [Lanes]) {
        let (n, leading) = (self.n, self.leading);
        let columns = n + self.scalars;
        for (column, target) in couplings.chunks_exact_mut(n - leading).enumerate() {
            let (point, component) = (column / leading, column % leading);
            target.copy_from_slice(&scaled[(point * columns + component) * n + leading..][..n - leading]);
        }
    }

    /// Adds to the carried components of a right-hand side what the leading ones, solved for, do to them.
    #[inline(always)]
    fn couple<const FUSED: bool>(&self, couplings: &[Lanes], column: &mut [Lanes]) {
        let (n, leading, degree) = (self.n, self.leading, self.gauss.degree());
        let carried = n - leading;
        for (k, block) in couplings.chunks_exact(leading * carried).enumerate() {
            for row in 0..carried {
                let mut slope = Lanes::ZERO;
                for component in 0..leading {
                    slope = slope.plus::<FUSED>(block[component * carried + row], column[k * n + component]);
                }
                for i in 0..degree {
                    let factor = Lanes::from(self.gauss.integration[i * degree + k]);
                    let entry = &mut column[i * n + leading + row];
                    *entry = entry.plus::<FUSED>(factor, slope);
                }
            }
        }
    }

    /// Takes as many components as there are leading ones, from `first` on, out of a column.
    #[inline(always)]
    fn gather(&self, column: &[Lanes], first: usize, part: &mut [Lanes]) {
        for (target, entries) in part.chunks_exact_mut(self.leading).zip(column.chunks_exact(self.n)) {
            target.copy_from_slice(&entries[first..first + self.leading]);
        }
    }

    /// Puts them back.
    #[inline(always)]
    fn scatter(&self, part: &[Lanes], first: usize, column: &mut [Lanes]) {
        for (source, entries) in part.chunks_exact(self.leading).zip(column.chunks_exact_mut(self.n)) {
            entries[first..first + self.leading].copy_from_slice(source);
        }
    }

    /// Takes a turning pair out of a column.
    #[inline(always)]
    fn gather_pair(&self, column: &[Lanes], pair: &mut [ComplexLanes]) {
        let leading = self.leading;
        for (target, entries) in pair.chunks_exact_mut(leading).zip(column.chunks_exact(self.n)) {
            for (component, target) in target.iter_mut().enumerate() {
                let [re, im] = [1, 2].map(|part| entries[part * leading + component]);
                *target = ComplexLanes { re, im };
            }
        }
    }

    /// Puts it back.
    #[inline(always)]
    fn scatter_pair(&self, pair: impl Iterator<Item = ComplexLanes>, column: &mut [Lanes]) {
        let leading = self.leading;
        for (index, ComplexLanes { re, im }) in pair.enumerate() {
            let place = (index / leading) * self.n + index % leading;
            column[place + leading] = re;
            column[place + 2 * leading] = im;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Responses of two groups and the solution for a right-hand side.
    fn eliminated(
        structure: Structure,
        [degree, n, scalars]: [usize; 3],
        field: LinearField<'_>,
        column: &[Lanes],
    ) -> Vec<Lanes> {
        let mut interior = Interior::new(degree, n, scalars, structure);
        interior.prepare(2);
        (0..2)
            .flat_map(|group| {
                assert!(interior.factorize::<false>(group, field));
                let mut values = column.to_vec();
                interior.solve::<false>(group, &mut values);
                values.extend_from_slice(interior.response(group));
                values
            })
            .collect()
    }

    proptest! {
        #[test]
        fn block_by_block_and_as_a_whole_are_the_same(
            leading in 1usize..4,
            degree in 2usize..6,
            scalars in 1usize..4,
            turns in any::<bool>(),
            seed in prop::collection::vec(-1.0..1.0f64, 997),
        ) {
            let structure = if turns { Structure::Turning } else { Structure::Carried };
            let n = if turns { 3 * leading } else { 2 * leading };
            let mesh = [0.0, 0.1, 0.3, 0.45, 0.6, 0.8, 1.0];
            let mut numbers = seed.iter().copied().cycle();
            let mut next = || numbers.next().expect("a cycle");
            let rotation = 3.0 * next();
            let mut derivatives = Vec::new();
            for _ in 0..(mesh.len() - 1) * degree {
                let mut block: Vec<f64> = (0..n * (n + scalars)).map(|_| 2.0 * next()).collect();
                for column in leading..n {
                    for row in 0..n {
                        let is_own = row / leading == column / leading;
                        block[column * n + row] = match (is_own, row % leading == column % leading) {
                            (true, _) => block[(column % leading) * n + row % leading],
                            (false, true) if row >= leading => if row < column { rotation } else { -rotation },
                            _ => 0.0,
                        };
                    }
                }
                derivatives.extend(block);
            }
            let column: Vec<Lanes> =
                (0..degree * n).map(|_| Lanes::from(std::array::from_fn(|_| next()))).collect();
            let field = LinearField { mesh: &mesh, derivatives: &derivatives };
            let sizes = [degree, n, scalars];
            let whole = eliminated(Structure::Dense, sizes, field, &column);
            let by_block = eliminated(structure, sizes, field, &column);
            prop_assert_eq!(whole.len(), by_block.len());
            for (one, other) in whole.iter().zip(&by_block) {
                for lane in 0..LANES {
                    let difference = (one.0[lane] - other.0[lane]).abs();
                    prop_assert!(difference < 1e-9 * (1.0 + one.0[lane].abs()), "{one:?} {other:?}");
                }
            }
        }
    }
}
