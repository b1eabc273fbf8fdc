//! Critical eigenfunctions of a cycle: what the defining systems of special cycles and the branches that leave them start from.

use super::defining::Kind;
use super::limit_cycle::LimitCycle;
use crate::collocation::equations::Collocation;
use crate::collocation::linear_problem::{LinearProblem, NodeFunction, Nodes};
use crate::collocation::problem::BoundaryValueEquations;
use crate::error::Error;
use crate::linear::product_eigenvectors::product_eigenvector;
use num_complex::Complex64;
use std::f64::consts::PI;

/// A cycle with its linearisation `y' = T f_x y` and the derivatives of `T f` with respect to period and parameter.
pub(crate) struct Linearization<'a> {
    pub nodes: Nodes<'a>,
    /// Sizes of the states.
    pub scales: &'a [f64],
    /// `T f_x` at every Gauss point.
    pub matrices: Vec<f64>,
    /// `f` at every node.
    pub flow: NodeFunction,
    /// Derivative of `T f` with respect to the active parameter at every Gauss point; zero at left ends.
    pub parameter: NodeFunction,
}

impl<'a> Linearization<'a> {
    /// From the last factorisation of `collocation`, which has to be that at `unknown`.
    pub(crate) fn of(collocation: &'a Collocation<LimitCycle<'_>>, unknown: &[f64]) -> Self {
        let n = collocation.problem.dimension();
        let nodes =
            Nodes { mesh: collocation.mesh(), gauss: collocation.gauss(), jumps: collocation.linear_jumps() };
        let scalars = &unknown[unknown.len() - 2..];
        let derivatives = collocation.derivatives();
        let mut matrices = Vec::with_capacity(nodes.count() * n * n);
        let mut parameter = vec![0.0; nodes.count() * n];
        for (block, (_, node, _)) in derivatives.chunks_exact(n * (n + 2)).zip(nodes.gauss_points()) {
            matrices.extend_from_slice(&block[..n * n]);
            parameter[node * n..(node + 1) * n].copy_from_slice(&block[n * (n + 1)..]);
        }
        let mut flow = vec![0.0; nodes.count() * n];
        let times = collocation.polynomials(unknown).node_times();
        for ((state, target), time) in unknown.chunks_exact(n).zip(flow.chunks_exact_mut(n)).zip(times) {
            collocation.problem.field(time, state, scalars, target);
            target.iter_mut().for_each(|entry| *entry /= scalars[0]);
        }
        Self { nodes, scales: &collocation.problem.scales, matrices, flow, parameter }
    }

    /// A function with every component divided by the square of its size: the covector that measures its direction.
    pub(crate) fn dual(&self, function: &[f64]) -> NodeFunction {
        function
            .chunks_exact(self.scales.len())
            .flat_map(|state| state.iter().zip(self.scales).map(|(value, scale)| value / (scale * scale)))
            .collect()
    }

    /// A covector function with every component multiplied by the square of its size: the inverse of [`dual`](Self::dual).
    fn vector(&self, function: &[f64]) -> NodeFunction {
        function
            .chunks_exact(self.scales.len())
            .flat_map(|state| state.iter().zip(self.scales).map(|(value, scale)| value * scale * scale))
            .collect()
    }

    /// `T f_x y` at every Gauss point; zero at left ends.
    pub(crate) fn image(&self, function: &[f64]) -> NodeFunction {
        let n = self.scales.len();
        let mut image = vec![0.0; function.len()];
        for (matrix, (_, node, _)) in self.matrices.chunks_exact(n * n).zip(self.nodes.gauss_points()) {
            let target = &mut image[node * n..(node + 1) * n];
            for (column, factor) in matrix.chunks_exact(n).zip(&function[node * n..]) {
                for (entry, value) in target.iter_mut().zip(column) {
                    *entry += factor * value;
                }
            }
        }
        image
    }

    /// A smooth function that no symmetry of a cycle makes orthogonal to an eigenfunction.
    fn generic(&self) -> NodeFunction {
        let mut function = Vec::with_capacity(self.nodes.count() * self.scales.len());
        for pair in self.nodes.mesh.windows(2) {
            let points = std::iter::once(0.0).chain(self.nodes.gauss.points.iter().copied());
            for time in points.map(|point| pair[0] + point * (pair[1] - pair[0])) {
                for (index, scale) in self.scales.iter().enumerate() {
                    let shift = 1.0 + index as f64;
                    let waves = (2.0 * PI * time + shift).cos() + 0.7 * (4.0 * PI * time + 2.0 * shift).sin();
                    function.push(scale * (0.4 + waves));
                }
            }
        }
        function
    }

    /// Null function of a cycle with a nontrivial multiplier one: `v' = T f_x v + beta f`, orthogonal to the flow and of unit
    /// size, with `beta`.
    pub(crate) fn null_function(&self) -> Option<(NodeFunction, f64)> {
        self.null_function_beside(None)
    }

    /// The same, orthogonal to another null function if there is one.
    pub(crate) fn null_function_beside(&self, other: Option<&NodeFunction>) -> Option<(NodeFunction, f64)> {
        let known: Vec<&[f64]> = std::iter::once(&self.flow).chain(other).map(|known| &known[..]).collect();
        let duals: Vec<NodeFunction> = known.iter().map(|function| self.dual(function)).collect();
        let rows: Vec<&[f64]> = duals.iter().map(|dual| &dual[..]).collect();
        let dual = |function: &[f64]| self.dual(function);
        let start = self.generic();
        let (function, scalars) =
            inverse_iterations(self.nodes, &self.matrices, (&known, &rows), start, dual)?;
        Some((function, scalars[0]))
    }

    /// Covector function of a cycle at a branch point: `psi' = -T f_x^T psi`, orthogonal to the flow and of unit size. Along a family of
    /// cycles for one value of the parameter the gradient of what is conserved is such a function everywhere; that of a branch point is
    /// the one that is orthogonal to the derivative in the parameter.
    pub(crate) fn adjoint_null_function(&self, is_along_family: bool) -> Option<NodeFunction> {
        let n = self.scales.len();
        let mut adjoint = vec![0.0; self.matrices.len()];
        for (source, target) in self.matrices.chunks_exact(n * n).zip(adjoint.chunks_exact_mut(n * n)) {
            for row in 0..n {
                for column in 0..n {
                    target[column + n * row] = -source[row + n * column];
                }
            }
        }
        // At kinks nothing jumps; where the field does, branch points are not located.
        let nodes = Nodes { jumps: &[], ..self.nodes };
        let mut known = vec![&self.flow[..]];
        known.extend(is_along_family.then_some(&self.parameter[..]));
        let duals: Vec<NodeFunction> = known.iter().map(|function| self.dual(function)).collect();
        let columns: Vec<&[f64]> = duals.iter().map(|dual| &dual[..]).collect();
        let vector = |function: &[f64]| self.vector(function);
        let start = self.dual(&self.generic());
        inverse_iterations(nodes, &adjoint, (&columns, &known), start, vector).map(|(function, _)| function)
    }
}

/// The function of unit size that solves `y' = M y` best, with the `columns` and orthogonal to the `rows`, from a start: in the null space it
/// is exact. `paired` is what a function is measured by. With the factors of the columns.
fn inverse_iterations(
    nodes: Nodes<'_>,
    matrices: &[f64],
    (columns, rows): (&[&[f64]], &[&[f64]]),
    start: NodeFunction,
    paired: impl Fn(&[f64]) -> NodeFunction,
) -> Option<(NodeFunction, Vec<f64>)> {
    let n = start.len() / nodes.count();
    let mut values = vec![0.0; rows.len()];
    values.push(1.0);
    let (mut function, mut factors) = (start, Vec::new());
    for _ in 0..ITERATIONS {
        let row = paired(&function);
        let columns = [columns, &[&function[..]]].concat();
        let rows = [rows, &[&row[..]]].concat();
        let mut problem = LinearProblem::new(nodes, vec![1.0; n], matrices, &columns, &rows)?;
        let (found, scalars) = problem.solve(&vec![0.0; function.len()], &values)?;
        let size = nodes.product(&found, &paired(&found)).sqrt();
        function = found.iter().map(|value| value / size).collect();
        factors = scalars.iter().map(|scalar| scalar / size).collect();
    }
    Some((function, factors))
}

/// Inverse iterations for a null function.
const ITERATIONS: usize = 3;

/// Real functions on the nodes and the own scalars of a kind.
pub(crate) type Eigenfunctions = (Vec<NodeFunction>, Vec<f64>);

/// Start for the eigenfunctions of a defining system at a cycle close to a special one, with the kind's own scalars.
///
/// `is_along_family` says whether the parameter stands still along the branch. `None` when the cycle has no multiplier of this kind.
pub(crate) fn critical(
    collocation: &mut Collocation<LimitCycle<'_>>,
    (unknown, is_along_family): (&[f64], bool),
    multipliers: &[Complex64],
    kind: Kind,
) -> Result<Option<Eigenfunctions>, Error> {
    // The blocks of this cycle, not of the last trial point.
    let mut border = vec![0.0; unknown.len()];
    border[unknown.len() - 1] = 1.0;
    let mut residual = vec![0.0; unknown.len()];
    collocation.factorize(unknown, &border, &mut residual);
    let linearization = Linearization::of(collocation, unknown);
    let nearest = |distance: &dyn Fn(&Complex64) -> f64| {
        let found = multipliers.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        found.copied().filter(|multiplier| distance(multiplier).is_finite())
    };
    let size = |function: &[f64]| linearization.nodes.product(function, &linearization.dual(function));
    Ok(match kind {
        Kind::Fold => linearization.null_function().map(|(function, beta)| {
            let period = unknown[unknown.len() - 2];
            let factor = (1.0 + (beta / period).powi(2)).sqrt().recip();
            (vec![function.iter().map(|value| value * factor).collect()], vec![beta * factor])
        }),
        Kind::Cycle => Some((Vec::new(), Vec::new())),
        Kind::BranchPoint => {
            let adjoint = linearization.adjoint_null_function(is_along_family);
            adjoint.map(|adjoint| (vec![adjoint], vec![0.0, 0.0]))
        }
        Kind::Doubling => {
            let Some(critical) = nearest(&|multiplier| (multiplier + 1.0).norm()) else { return Ok(None) };
            // Next to a 1:2 resonance the multiplier may be complex: the real part of its function is a start, too.
            let mut functions = eigenfunctions(collocation, critical, 0.0)?;
            functions.truncate(1);
            let factor = size(&functions[0]).sqrt().recip();
            functions[0].iter_mut().for_each(|value| *value *= factor);
            factor.is_finite().then_some((functions, Vec::new()))
        }
        Kind::Torus => {
            let distance = |multiplier: &Complex64| {
                if multiplier.im > 0.0 { multiplier.norm().ln().abs() } else { f64::INFINITY }
            };
            let Some(critical) = nearest(&distance) else { return Ok(None) };
            let angle = critical.arg();
            let functions = eigenfunctions(collocation, critical, angle)?;
            // Without their components along the flow, which come back through beta = -i theta kappa.
            let flow_row = linearization.dual(&linearization.flow);
            let square = linearization.nodes.product(&linearization.flow, &flow_row);
            let mut parts = Vec::new();
            for function in &functions {
                let share = linearization.nodes.product(function, &flow_row) / square;
                let rest: NodeFunction = function
                    .iter()
                    .zip(&linearization.flow)
                    .map(|(value, flow)| value - share * flow)
                    .collect();
                parts.push((rest, share));
            }
            let [(first, first_share), (second, second_share)] = &parts[..] else { return Ok(None) };
            let factor = (size(first) + size(second)).sqrt().recip();
            let scaled = |function: &[f64]| function.iter().map(|value| value * factor).collect();
            let own = vec![angle, angle * second_share * factor, -angle * first_share * factor];
            factor.is_finite().then_some((vec![scaled(first), scaled(second)], own))
        }
    })
}

/// Solutions of the variational equation with `z(1) = mu z(0)`, real for a real multiplier; for a complex one
/// real and imaginary part of `z(t) exp(-i angle t)`, which is periodic when `mu = exp(i angle)`.
fn eigenfunctions<P: BoundaryValueEquations>(
    collocation: &Collocation<P>,
    multiplier: Complex64,
    angle: f64,
) -> Result<Vec<NodeFunction>, Error> {
    let n = collocation.problem.dimension();
    let intervals = collocation.intervals();
    let degree = collocation.gauss().degree();
    let starts = product_eigenvector(collocation.transfer(), n, intervals, multiplier)
        .map_err(|_| Error::Eigenvalues { quantity: "Floquet multipliers" })?
        .vectors;
    let is_real = multiplier.im == 0.0;
    let count = if is_real { 1 } else { 2 };
    let mut functions = vec![Vec::with_capacity(collocation.unknowns()); count];
    let mut parts = [vec![0.0; degree * n], vec![0.0; degree * n]];
    for interval in 0..intervals {
        let start = &starts[interval * n..(interval + 1) * n];
        let real: Vec<f64> = start.iter().map(|z| z.re).collect();
        let imaginary: Vec<f64> = start.iter().map(|z| z.im).collect();
        collocation.interior_response(interval, &real, &mut parts[0]);
        collocation.interior_response(interval, &imaginary, &mut parts[1]);
        let left = collocation.mesh()[interval];
        let width = collocation.mesh()[interval + 1] - left;
        let times = std::iter::once(0.0).chain(collocation.gauss().points.iter().copied());
        for (node, position) in times.enumerate() {
            let rotation = if is_real {
                Complex64::new(1.0, 0.0)
            } else {
                Complex64::from_polar(1.0, -angle * (left + position * width))
            };
            for (component, value) in start.iter().enumerate() {
                let z = if node == 0 {
                    *value
                } else {
                    let index = (node - 1) * n + component;
                    Complex64::new(parts[0][index], parts[1][index])
                };
                let rotated = z * rotation;
                functions[0].push(rotated.re);
                if !is_real {
                    functions[1].push(rotated.im);
                }
            }
        }
    }
    Ok(functions)
}
