//! Roots of sums of squares: `r = sqrt(x^2 + y^2)`, of which the derivatives of every other root would make no number at the origin.
//!
//! Even powers of such a root are the sum itself. What is left has a kink where
//! all squares vanish. A field has derivatives there all the same where every way from the root to it leads through a product with
//! one of the terms, as `x*(l - r)`: then the root becomes a [norm](BinaryOperation::Norm), whose derivatives are zero there. Elsewhere
//! they do not exist, and are not made up.

use super::graph::{Graph, NodeId, Operation};
use crate::expression::{BinaryOperation, UnaryOperation};

/// Ratio of the weights of two neighbouring terms of a norm in the sum that tells whether one varies: the golden ratio, so that
/// terms hardly ever cancel.
const WEIGHT_RATIO: f64 = 1.618_033_988_749_895;

/// Largest weight.
const LARGEST_WEIGHT: f64 = 1e3;

impl Graph {
    /// Whether a node is negative nowhere, as far as its spelling shows.
    pub(super) fn is_non_negative(&self, node: NodeId) -> bool {
        use BinaryOperation::{Add, Divide, Multiply};
        use UnaryOperation::{AbsoluteValue, Exponential, Heaviside, Reciprocal, SquareRoot};
        let mut waiting = vec![node];
        let mut seen = std::collections::HashSet::new();
        while let Some(node) = waiting.pop() {
            if !seen.insert(node) {
                continue;
            }
            match self.operation(node) {
                Operation::Constant(bits) if f64::from_bits(bits) >= 0.0 => {}
                Operation::Unary(AbsoluteValue | Exponential | Heaviside | SquareRoot, _) => {}
                Operation::Unary(Reciprocal, a) => waiting.push(a),
                Operation::Binary(Multiply, a, b) if a == b => {}
                Operation::Binary(Add | Multiply | Divide, a, b) => waiting.extend([a, b]),
                Operation::WholePower(_, exponent) if exponent % 2 == 0 => {}
                _ => return false,
            }
        }
        true
    }

    /// The root of the square of what is negative nowhere: that itself.
    pub(super) fn root(&self, radicand: NodeId) -> Option<NodeId> {
        match self.operation(radicand) {
            Operation::Binary(BinaryOperation::Multiply, a, b) if a == b => {
                self.is_non_negative(a).then_some(a)
            }
            _ => None,
        }
    }

    /// What stands under a root that is a root everywhere.
    fn radicand(&self, node: NodeId) -> Option<NodeId> {
        match self.operation(node) {
            Operation::Unary(UnaryOperation::SquareRoot, inner) => {
                self.is_non_negative(inner).then_some(inner)
            }
            _ => None,
        }
    }

    /// A product in which such a root stands twice.
    pub(super) fn product_of_roots(&mut self, a: NodeId, b: NodeId) -> Option<NodeId> {
        for (root, other) in [(a, b), (b, a)] {
            let Some(radicand) = self.radicand(root) else { continue };
            if other == root {
                return Some(radicand);
            }
            if let Operation::Binary(BinaryOperation::Multiply, c, d) = self.operation(other)
                && (c == root || d == root)
            {
                let rest = if c == root { d } else { c };
                return Some(self.binary(BinaryOperation::Multiply, rest, radicand));
            }
        }
        None
    }

    /// A power of such a root, or a half power of what could stand under one: whole powers, and a root where the exponent is odd.
    pub(super) fn power_of_root(&mut self, base: NodeId, exponent: f64) -> Option<NodeId> {
        let halves = 2.0 * exponent;
        let (radicand, halves) = match self.radicand(base) {
            Some(radicand) => (radicand, exponent),
            None if exponent.fract() != 0.0 && self.is_sum_of_squares(base) => (base, halves),
            None => return None,
        };
        if halves.fract() != 0.0 || !(2.0..=f64::from(i32::MAX)).contains(&halves) {
            return None;
        }
        let whole = (halves / 2.0).floor();
        let exponent = self.constant(whole);
        let power = self.binary(BinaryOperation::Power, radicand, exponent);
        if whole + whole == halves {
            return Some(power);
        }
        let root = self.unary(UnaryOperation::SquareRoot, radicand);
        Some(self.binary(BinaryOperation::Multiply, power, root))
    }

    fn is_sum_of_squares(&self, node: NodeId) -> bool {
        self.squares(node).is_some()
    }

    /// The terms of a sum of squares with positive factors; nothing for any other node.
    fn squares(&self, node: NodeId) -> Option<Vec<NodeId>> {
        use BinaryOperation::{Add, Divide, Multiply};
        let is_positive = |node: NodeId| self.constant_value(node).is_some_and(|value| value > 0.0);
        let mut terms = Vec::new();
        let mut waiting = vec![node];
        while let Some(node) = waiting.pop() {
            match self.operation(node) {
                Operation::Binary(Multiply, a, b) if a == b => terms.push(a),
                Operation::Binary(Add, a, b) => waiting.extend([b, a]),
                Operation::Binary(Multiply, a, b) if is_positive(a) => waiting.push(b),
                Operation::Binary(Multiply | Divide, a, b) if is_positive(b) => waiting.push(a),
                Operation::WholePower(a, exponent) if exponent > 0 && exponent % 2 == 0 => terms.push(a),
                _ => return None,
            }
        }
        Some(terms)
    }

    /// The results, of states, with norms in place of the roots that leave them their derivatives.
    pub(crate) fn with_norms(&mut self, results: Vec<NodeId>) -> Vec<NodeId> {
        let needed = self.needed_for(results.iter().copied());
        let roots: Vec<(NodeId, NodeId)> = (0..needed.len())
            .filter(|&index| needed[index])
            .filter_map(|index| match self.operation(index as NodeId) {
                Operation::Unary(UnaryOperation::SquareRoot, radicand) => Some((index as NodeId, radicand)),
                _ => None,
            })
            .collect();
        let mut norms = Vec::new();
        for (root, radicand) in roots {
            if let Some(terms) = self.squares(radicand)
                && !self.has_kink(&results, root, radicand, &terms, &needed)
            {
                norms.push((root, radicand, terms));
            }
        }
        if norms.is_empty() {
            return results;
        }
        self.rebuilt(&results, &needed, &norms)
    }

    /// Whether results have a kink where all terms of the root vanish.
    fn has_kink(
        &self,
        results: &[NodeId],
        root: NodeId,
        radicand: NodeId,
        terms: &[NodeId],
        needed: &[bool],
    ) -> bool {
        use BinaryOperation::{Add, Divide, Multiply, Subtract};
        use UnaryOperation as U;
        let mut vanishes = vec![false; needed.len()];
        let mut has_kink = vec![false; needed.len()];
        for index in (0..needed.len()).filter(|&index| needed[index]) {
            let node = index as NodeId;
            let operation = self.operation(node);
            let zero = |node: NodeId| vanishes[node as usize];
            let kink = |node: NodeId| has_kink[node as usize];
            let (is_zero, is_kink) = match operation {
                _ if node == root => (true, true),
                Operation::Binary(Multiply, a, b) => {
                    (zero(a) || zero(b), kink(a) && !zero(b) || kink(b) && !zero(a))
                }
                Operation::Binary(Divide, a, b) => (zero(a), kink(a) || kink(b) && !zero(a)),
                Operation::Binary(Add | Subtract, a, b) => (zero(a) && zero(b), kink(a) || kink(b)),
                Operation::Unary(
                    U::Negate
                    | U::AbsoluteValue
                    | U::SquareRoot
                    | U::Sine
                    | U::Tangent
                    | U::InverseSine
                    | U::InverseTangent
                    | U::HyperbolicSine
                    | U::HyperbolicTangent,
                    a,
                ) => (zero(a), kink(a)),
                // The square and higher powers of what vanishes are flat.
                Operation::WholePower(a, exponent) => {
                    (exponent > 0 && zero(a), kink(a) && !(exponent > 1 && zero(a)))
                }
                _ => (false, operation.operands().any(kink)),
            };
            vanishes[index] = is_zero || node == radicand || terms.contains(&node);
            has_kink[index] = is_kink;
        }
        results.iter().any(|&result| has_kink[result as usize])
    }

    fn rebuilt(
        &mut self,
        results: &[NodeId],
        needed: &[bool],
        norms: &[(NodeId, NodeId, Vec<NodeId>)],
    ) -> Vec<NodeId> {
        let mut image: Vec<NodeId> = (0..needed.len() as NodeId).collect();
        for index in (0..needed.len()).filter(|&index| needed[index]) {
            let node = index as NodeId;
            image[index] = if let Some((_, radicand, terms)) = norms.iter().find(|(root, ..)| *root == node) {
                let square = image[*radicand as usize];
                let terms: Vec<NodeId> = terms.iter().map(|&term| image[term as usize]).collect();
                let trace = self.weighted(&terms);
                self.insert(Operation::Binary(BinaryOperation::Norm, square, trace))
            } else {
                let operation = self.operation(node);
                if operation.operands().all(|operand| image[operand as usize] == operand) {
                    node
                } else {
                    let new = |node: NodeId| image[node as usize];
                    self.insert(match operation {
                        Operation::Unary(of, a) => Operation::Unary(of, new(a)),
                        Operation::Binary(of, a, b) => Operation::Binary(of, new(a), new(b)),
                        Operation::WholePower(a, exponent) => Operation::WholePower(new(a), exponent),
                        Operation::Select(a, b, c) => Operation::Select(new(a), new(b), new(c)),
                        leaf => leaf,
                    })
                }
            };
        }
        results.iter().map(|&result| image[result as usize]).collect()
    }

    /// A sum with weights that are no simple multiples of each other.
    fn weighted(&mut self, terms: &[NodeId]) -> NodeId {
        let mut sum = self.constant(0.0);
        let mut weight = 1.0;
        for &term in terms {
            let factor = self.constant(weight);
            let product = self.binary(BinaryOperation::Multiply, factor, term);
            sum = self.binary(BinaryOperation::Add, sum, product);
            weight *= WEIGHT_RATIO;
            if weight > LARGEST_WEIGHT {
                weight = weight.fract() + 1.0;
            }
        }
        sum
    }
}
