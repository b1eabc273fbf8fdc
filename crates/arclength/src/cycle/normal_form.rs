//! Normal-form coefficients of special cycles.
//!
//! The motion near a cycle `u(tau)` is written with a slow amplitude `xi`, for instance `u(tau) + xi v(tau) + ...` with
//! `d tau/dt = 1 + a xi^2`, `d xi/dt = c xi^3`. Powers of `xi` give linear periodic problems one after the other; each is
//! bordered by the function it is not solvable for, and the coefficient comes out as the border's scalar. No adjoint
//! functions are needed. Source: Kuznetsov, Govaerts, Doedel and Dhooge, "Numerical periodic normalization for codim 1
//! bifurcations of limit cycles", *SIAM J. Numer. Anal.* 43 (2005).

use super::defining::Kind;
use super::eigenfunctions::{Eigenfunctions, Linearization};
use super::limit_cycle::LimitCycle;
use crate::collocation::equations::Collocation;
use crate::collocation::linear_problem::{LinearProblem, NodeFunction};
use crate::equilibrium::multilinear::add_along;
use crate::erased::ErasedField;

/// A critical cycle.
pub(crate) struct CriticalCycle<'a> {
    pub field: ErasedField<'a>,
    pub parameters: Vec<f64>,
    /// States on all nodes.
    pub states: &'a [f64],
    pub period: f64,
    pub linearization: Linearization<'a>,
    /// Whether the field switches along the cycle: what borders do to the coefficients is not computed.
    pub has_borders: bool,
}

/// The relative size of the shift along the cycle below which a fold's coefficient is not scaled by it.
const SMALLEST_SHIFT: f64 = 1e-6;

impl<'a> CriticalCycle<'a> {
    /// The cycle `unknown` of states, period and parameter; `collocation` has just been factorised there.
    pub(crate) fn of(collocation: &'a Collocation<LimitCycle<'a>>, unknown: &'a [f64]) -> Self {
        let problem = &collocation.problem;
        let (states, scalars) = unknown.split_at(unknown.len() - 2);
        let mut parameters = problem.parameters.clone();
        parameters[problem.active] = scalars[1];
        Self {
            field: problem.field,
            parameters,
            states,
            period: scalars[0],
            linearization: Linearization::of(collocation, unknown),
            has_borders: problem.has_borders(),
        }
    }

    /// `T` times a sum of multilinear forms at every Gauss point: every entry is a factor and its directions.
    fn forms(&self, terms: &[(f64, &[&[f64]])]) -> NodeFunction {
        let mut values = vec![0.0; self.states.len()];
        for (factor, directions) in terms {
            let points = self.linearization.nodes.gauss_points().map(|(_, node, _)| node);
            let field = (self.field, &self.parameters[..]);
            add_along(field, self.states, directions, self.period * factor, points, &mut values);
        }
        values
    }

    /// The null function of a fold with the integral of `<v, f>` over the cycle zero, and the square root of that of `<v, v>`
    /// over the unit interval: a property of the cycle, whatever mesh, scales and reference of the phase were.
    fn across_the_flow(&self, null: &NodeFunction) -> (NodeFunction, f64) {
        let Linearization { nodes, flow, .. } = &self.linearization;
        let share = nodes.product(null, flow) / nodes.product(flow, flow);
        let across: NodeFunction = null.iter().zip(flow).map(|(value, flow)| value - share * flow).collect();
        let size = nodes.product(&across, &across).sqrt();
        (across, size)
    }

    /// The coefficients of the normal form by name, as far as they exist.
    pub(crate) fn coefficients(
        &self,
        kind: Kind,
        eigenfunctions: &Eigenfunctions,
    ) -> Vec<(&'static str, f64)> {
        match kind {
            Kind::Torus if self.has_borders => {
                eigenfunctions.1.first().map(|angle| ("argument", angle.abs())).into_iter().collect()
            }
            _ if self.has_borders => Vec::new(),
            Kind::Fold => {
                // MatCont's scaling does not exist where the period stands still, as it does in a forced oscillator.
                let named = self.fold(eigenfunctions).map(|(own, scaled)| match scaled {
                    Some(value) => ("quadratic_coefficient", value),
                    None => ("quadratic_coefficient_of_unit_function", own),
                });
                named.into_iter().collect()
            }
            Kind::Doubling => {
                let coefficient = self.doubling(eigenfunctions);
                coefficient.map(|value| ("cubic_coefficient", value)).into_iter().collect()
            }
            Kind::Torus => {
                let argument = eigenfunctions.1.first().map(|angle| ("argument", angle.abs()));
                let mut named: Vec<_> = argument.into_iter().collect();
                if let Some([real, imaginary]) = self.torus(eigenfunctions) {
                    named.extend([("cubic_coefficient", real), ("cubic_coefficient_imaginary", imaginary)]);
                }
                named
            }
            Kind::Cycle | Kind::BranchPoint => Vec::new(),
        }
    }

    /// Fold: `b` of `d tau/dt = 1 + kappa xi`, `d xi/dt = b xi^2` for the null function `v' = T f_x v + beta f` with the
    /// integral of `<v, v>` over the unit interval equal to one and that of `<v, f>` zero (`kappa = -beta / T`), and
    /// `b / kappa`, its value when `v` is scaled to `kappa = 1`; the latter is what MatCont prints. The sign of `b` is that of
    /// the function.
    pub(crate) fn fold(&self, (functions, own): &Eigenfunctions) -> Option<(f64, Option<f64>)> {
        let linear = &self.linearization;
        let (null, beta) = (functions.first()?, *own.first()?);
        let scaled_size = linear.nodes.product(null, &linear.dual(null)).sqrt();
        let shifts = beta.abs() > SMALLEST_SHIFT * scaled_size * scaled_size;
        let (null, size) = self.across_the_flow(null);
        let null: NodeFunction = null.iter().map(|value| value / size).collect();
        let beta = beta / size;
        let kappa = -beta / self.period;
        let mut source = self.forms(&[(1.0, &[&null, &null])]);
        let slope = linear.image(&null);
        for ((entry, slope), flow) in source.iter_mut().zip(&slope).zip(&linear.flow) {
            *entry -= 2.0 * kappa * (slope + beta * flow);
        }
        let signs = vec![1.0; linear.scales.len()];
        let rows = [linear.dual(&linear.flow), linear.dual(&null)];
        let columns: [&[f64]; 2] = [&linear.flow, &null];
        let mut problem =
            LinearProblem::new(linear.nodes, signs, &linear.matrices, &columns, &[&rows[0], &rows[1]])?;
        let (_, scalars) = problem.solve(&source, &[0.0, 0.0])?;
        let coefficient = -scalars[1] / (2.0 * self.period);
        let scaled = shifts.then(|| coefficient / kappa);
        Some((coefficient, scaled))
    }

    /// What a coefficient of the normal form would be if the slow motion had the rate of one in a period where its amplitude is
    /// `sizes`; coefficients are counted against it.
    pub(crate) fn natural_coefficient(
        &self,
        kind: Kind,
        (functions, _): &Eigenfunctions,
        sizes: &[f64],
    ) -> f64 {
        let linear = &self.linearization;
        let sized = |function: &NodeFunction| {
            let dual: NodeFunction = function
                .iter()
                .enumerate()
                .map(|(index, value)| value / sizes[index % sizes.len()].powi(2))
                .collect();
            linear.nodes.product(function, &dual)
        };
        match (kind, &functions[..]) {
            (Kind::Cycle, _) => self.period.recip(),
            // The coefficient is quadratic.
            (Kind::Fold, [null]) => {
                let (across, size) = self.across_the_flow(null);
                sized(&across).sqrt() / size / self.period
            }
            _ => {
                let square: f64 =
                    functions.iter().map(|function| linear.nodes.product(function, function)).sum();
                functions.iter().map(sized).sum::<f64>() / square / self.period
            }
        }
    }

    /// The second-order response along the cycle: `h' = T f_x h - a T f + source`; returns `h` and `a`.
    fn periodic_response(&self, source: &[f64]) -> Option<(NodeFunction, f64)> {
        let linear = &self.linearization;
        let row = linear.dual(&linear.flow);
        let signs = vec![1.0; linear.scales.len()];
        let mut problem =
            LinearProblem::new(linear.nodes, signs, &linear.matrices, &[&linear.flow], &[&row])?;
        let (function, scalars) = problem.solve(source, &[0.0])?;
        Some((function, -scalars[0] / self.period))
    }

    /// Period doubling: `c` of `d xi/dt = c xi^3` for the eigenfunction with the integral of `<v, v>` over the period of the
    /// cycle equal to one.
    pub(crate) fn doubling(&self, (functions, _): &Eigenfunctions) -> Option<f64> {
        let linear = &self.linearization;
        let function = functions.first()?;
        let size = linear.nodes.product(function, function).sqrt();
        let function: NodeFunction = function.iter().map(|value| value / size).collect();
        let (second, twice_a) = self.periodic_response(&self.forms(&[(1.0, &[&function, &function])]))?;
        let mut source =
            self.forms(&[(3.0, &[&function, &second]), (1.0, &[&function, &function, &function])]);
        for (entry, slope) in source.iter_mut().zip(linear.image(&function)) {
            *entry -= 3.0 * twice_a * slope;
        }
        let row = linear.dual(&function);
        let signs = vec![-1.0; linear.scales.len()];
        let mut problem = LinearProblem::new(linear.nodes, signs, &linear.matrices, &[&function], &[&row])?;
        let (_, scalars) = problem.solve(&source, &[0.0])?;
        Some(-scalars[0] / (6.0 * self.period))
    }

    /// Torus bifurcation: real and imaginary part of `d` of `d xi/dt = i omega xi + d xi |xi|^2` for the eigenfunction with
    /// the integral of `<v, v>` over the unit interval equal to one.
    pub(crate) fn torus(&self, (functions, own): &Eigenfunctions) -> Option<[f64; 2]> {
        let linear = &self.linearization;
        let n = linear.scales.len();
        let [first, second] = &functions[..] else { return None };
        let [angle, beta_first, beta_second] = own[..] else { return None };
        // The component along the flow that the defining system has taken out: kappa = i beta / theta.
        let with_flow = |function: &[f64], share: f64| -> NodeFunction {
            function.iter().zip(&linear.flow).map(|(value, flow)| value + share * flow).collect()
        };
        let mut x = with_flow(first, -beta_second / angle);
        let mut y = with_flow(second, beta_first / angle);
        let size = (linear.nodes.product(&x, &x) + linear.nodes.product(&y, &y)).sqrt();
        x.iter_mut().chain(&mut y).for_each(|value| *value /= size);
        let [xx, yy, xy] =
            [[&x, &x], [&y, &y], [&x, &y]].map(|[one, other]| self.forms(&[(1.0, &[one, other])]));
        let (mixed, a) = self.periodic_response(&combined(&xx, 1.0, &yy))?;
        // h20' = (T f_x - 2 i theta) h20 + T B(q, q)
        let double = self.rotating_matrices(2.0 * angle);
        let source = interleave(&combined(&xx, -1.0, &yy), &combined(&xy, 1.0, &xy), n);
        let signs = vec![1.0; 2 * n];
        let mut problem = LinearProblem::new(linear.nodes, signs.clone(), &double, &[], &[])?;
        let (response, _) = problem.solve(&source, &[])?;
        let [h_x, h_y] = separate(&response, n);
        // h21' = (T f_x - i theta) h21 + T (2 B(q, h11) + B(conj q, h20) + C(q, q, conj q)) - 2 a q' - 2 d T q
        let [with_x, with_y] = [1.0, -1.0].map(|sign| -> NodeFunction {
            mixed.iter().zip(&h_x).map(|(mixed, h)| 2.0 * mixed + sign * h).collect()
        });
        let mut real = self.forms(&[
            (1.0, &[&x, &with_x]),
            (1.0, &[&y, &h_y]),
            (1.0, &[&x, &x, &x]),
            (1.0, &[&x, &y, &y]),
        ]);
        let mut imaginary = self.forms(&[
            (1.0, &[&y, &with_y]),
            (1.0, &[&x, &h_y]),
            (1.0, &[&x, &x, &y]),
            (1.0, &[&y, &y, &y]),
        ]);
        let (slope_x, slope_y) = (linear.image(&x), linear.image(&y));
        for node in 0..real.len() {
            real[node] -= 2.0 * a * (slope_x[node] + angle * y[node]);
            imaginary[node] -= 2.0 * a * (slope_y[node] - angle * x[node]);
        }
        let source = interleave(&real, &imaginary, n);
        let one = interleave(&x, &y, n);
        let minus_y: NodeFunction = y.iter().map(|value| -value).collect();
        let other = interleave(&minus_y, &x, n);
        let single = self.rotating_matrices(angle);
        let rows = [self.complex_dual(&one, n), self.complex_dual(&other, n)];
        let mut problem =
            LinearProblem::new(linear.nodes, signs, &single, &[&one, &other], &[&rows[0], &rows[1]])?;
        let (_, scalars) = problem.solve(&source, &[0.0, 0.0])?;
        Some([-scalars[0] / (2.0 * self.period), -scalars[1] / (2.0 * self.period)])
    }

    fn complex_dual(&self, function: &[f64], n: usize) -> NodeFunction {
        let scales = self.linearization.scales;
        function.iter().enumerate().map(|(index, value)| value / scales[index % n].powi(2)).collect()
    }

    /// `T f_x - i angle` at every Gauss point as real matrices for real and imaginary parts.
    fn rotating_matrices(&self, angle: f64) -> Vec<f64> {
        let n = self.linearization.scales.len();
        let mut matrices = Vec::with_capacity(4 * self.linearization.matrices.len());
        for block in self.linearization.matrices.chunks_exact(n * n) {
            for column in 0..2 * n {
                for row in 0..2 * n {
                    matrices.push(match (row < n, column < n) {
                        (true, true) => block[row + n * column],
                        (false, false) => block[row - n + n * (column - n)],
                        (true, false) if row == column - n => angle,
                        (false, true) if row - n == column => -angle,
                        _ => 0.0,
                    });
                }
            }
        }
        matrices
    }
}

/// A function plus a multiple of another.
fn combined(one: &[f64], factor: f64, other: &[f64]) -> NodeFunction {
    one.iter().zip(other).map(|(one, other)| one + factor * other).collect()
}

/// A function with real and imaginary parts of every state one after the other.
fn interleave(real: &[f64], imaginary: &[f64], n: usize) -> NodeFunction {
    real.chunks_exact(n)
        .zip(imaginary.chunks_exact(n))
        .flat_map(|(a, b)| a.iter().chain(b).copied())
        .collect()
}

fn separate(function: &[f64], n: usize) -> [NodeFunction; 2] {
    let part = |offset: usize| {
        function.chunks_exact(2 * n).flat_map(|state| state[offset..offset + n].iter().copied()).collect()
    };
    [part(0), part(n)]
}
