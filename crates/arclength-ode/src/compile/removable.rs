//! Quotients of an exponential less one that are `0/0` at one place and smooth there: `x/(exp(x) - 1)`, `x/(1 - exp(-x))`, the rates
//! of ion channels, and their reciprocals.
//!
//! Written out, they are not a number where the state makes `x` zero, and next to it their digits and those of their
//! derivatives cancel. Where numerator and exponent have a common factor they become `r / E(x)`, with the entire function
//! `E(x) = (exp(x) - 1)/x` and the quotient `r` of the other factors, which has no such place.

use super::graph::{Graph, NodeId, Operation};
use crate::expression::{BinaryOperation, UnaryOperation};
use std::collections::BTreeMap;

/// Relative difference of the coefficients of two sums that are multiples of each other.
const PROPORTIONAL: f64 = 1e-14;

/// A product: a number, nodes that multiply it and nodes that divide it.
#[derive(Clone, Debug)]
struct Product {
    number: f64,
    numerators: Vec<NodeId>,
    denominators: Vec<NodeId>,
}

impl Graph {
    /// The quotient of two nodes where it has a removable `0/0`.
    pub(super) fn removable_quotient(&mut self, numerator: NodeId, denominator: NodeId) -> Option<NodeId> {
        let below = self.product(denominator);
        for place in 0..below.numerators.len() {
            if let Some((sign, exponent)) = self.exponential_less_one(below.numerators[place])
                && let Some(others) = self.ratio(numerator, exponent)
            {
                let relative = self.unary(UnaryOperation::RelativeExponential, exponent);
                let mut quotient = self.binary(BinaryOperation::Divide, others, relative);
                let factor = self.constant(sign / below.number);
                quotient = self.binary(BinaryOperation::Multiply, factor, quotient);
                for (_, node) in below.numerators.iter().enumerate().filter(|(other, _)| *other != place) {
                    quotient = self.binary(BinaryOperation::Divide, quotient, *node);
                }
                for node in &below.denominators {
                    quotient = self.binary(BinaryOperation::Multiply, quotient, *node);
                }
                return Some(quotient);
            }
        }
        let (sign, exponent) = self.exponential_less_one(numerator)?;
        let others = self.ratio(denominator, exponent)?;
        let relative = self.unary(UnaryOperation::RelativeExponential, exponent);
        let quotient = self.binary(BinaryOperation::Divide, relative, others);
        Some(self.signed(sign, quotient))
    }

    fn signed(&mut self, sign: f64, node: NodeId) -> NodeId {
        if sign < 0.0 { self.unary(UnaryOperation::Negate, node) } else { node }
    }

    /// The exponent `x` of a node `exp(x) - 1`, with the sign one, or `1 - exp(x)`, with the sign minus one.
    fn exponential_less_one(&self, node: NodeId) -> Option<(f64, NodeId)> {
        use BinaryOperation::{Add, Subtract};
        let Operation::Binary(operation, a, b) = self.operation(node) else { return None };
        let exponent = |node: NodeId| match self.operation(node) {
            Operation::Unary(UnaryOperation::Exponential, exponent) => Some(exponent),
            _ => None,
        };
        match (operation, self.constant_value(a), self.constant_value(b)) {
            (Subtract, Some(1.0), None) => Some((-1.0, exponent(b)?)),
            (Subtract, None, Some(1.0)) => Some((1.0, exponent(a)?)),
            (Add, Some(-1.0), None) => Some((1.0, exponent(b)?)),
            (Add, None, Some(-1.0)) => Some((1.0, exponent(a)?)),
            _ => None,
        }
    }

    /// `node / exponent` with the factor that both have left out.
    fn ratio(&mut self, node: NodeId, exponent: NodeId) -> Option<NodeId> {
        let (above, below) = (self.product(node), self.product(exponent));
        let places = (0..above.numerators.len())
            .flat_map(|one| (0..below.numerators.len()).map(move |other| (one, other)));
        let (one, other, factor) = places
            .filter_map(|(one, other)| {
                let factor = self.multiple(above.numerators[one], below.numerators[other])?;
                Some((one, other, factor))
            })
            .next()?;
        let mut numerators = above.numerators;
        numerators.remove(one);
        numerators.extend(below.denominators);
        let mut denominators = below.numerators;
        denominators.remove(other);
        denominators.extend(above.denominators);
        let mut ratio = self.constant(factor * above.number / below.number);
        for node in numerators {
            ratio = self.binary(BinaryOperation::Multiply, ratio, node);
        }
        for node in denominators {
            ratio = self.binary(BinaryOperation::Divide, ratio, node);
        }
        Some(ratio)
    }

    /// A node as a product.
    fn product(&self, node: NodeId) -> Product {
        let mut product = Product { number: 1.0, numerators: Vec::new(), denominators: Vec::new() };
        let mut waiting = vec![(node, true)];
        while let Some((node, is_above)) = waiting.pop() {
            match self.operation(node) {
                Operation::Constant(bits) => {
                    let value = f64::from_bits(bits);
                    product.number *= if is_above { value } else { value.recip() };
                }
                Operation::Unary(UnaryOperation::Negate, inner) => {
                    product.number = -product.number;
                    waiting.push((inner, is_above));
                }
                Operation::Unary(UnaryOperation::Reciprocal, inner) => waiting.push((inner, !is_above)),
                Operation::Binary(BinaryOperation::Multiply, a, b) => {
                    waiting.extend([(b, is_above), (a, is_above)]);
                }
                Operation::Binary(BinaryOperation::Divide, a, b) => {
                    waiting.extend([(b, !is_above), (a, is_above)]);
                }
                _ if is_above => product.numerators.push(node),
                _ => product.denominators.push(node),
            }
        }
        product
    }

    /// The number that one node is times another, both sums of multiples of the same nodes.
    pub(super) fn multiple(&self, one: NodeId, other: NodeId) -> Option<f64> {
        let (one, other) = (self.sum(one), self.sum(other));
        if one.len() != other.len() {
            return None;
        }
        let mut factors = one.iter().zip(&other).map(|((a, x), (b, y))| (a == b).then_some(x / y));
        let first = factors.next()??;
        factors
            .all(|factor| factor.is_some_and(|factor| (factor / first - 1.0).abs() <= PROPORTIONAL))
            .then_some(first)
    }

    /// A node as a sum of multiples of nodes; the number alone belongs to none.
    pub(super) fn sum(&self, node: NodeId) -> BTreeMap<Option<NodeId>, f64> {
        let mut sum = BTreeMap::new();
        let mut waiting = vec![(node, 1.0)];
        while let Some((node, factor)) = waiting.pop() {
            let place = match self.operation(node) {
                Operation::Constant(bits) => {
                    *sum.entry(None).or_insert(0.0) += factor * f64::from_bits(bits);
                    continue;
                }
                Operation::Unary(UnaryOperation::Negate, inner) => {
                    waiting.push((inner, -factor));
                    continue;
                }
                Operation::Binary(BinaryOperation::Add, a, b) => {
                    waiting.extend([(b, factor), (a, factor)]);
                    continue;
                }
                Operation::Binary(BinaryOperation::Subtract, a, b) => {
                    waiting.extend([(b, -factor), (a, factor)]);
                    continue;
                }
                Operation::Binary(BinaryOperation::Multiply, a, b) => {
                    match (self.constant_value(a), self.constant_value(b)) {
                        (Some(value), None) => Some((b, factor * value)),
                        (None, Some(value)) => Some((a, factor * value)),
                        _ => None,
                    }
                }
                Operation::Binary(BinaryOperation::Divide, a, b) => {
                    self.constant_value(b).map(|value| (a, factor / value))
                }
                _ => None,
            };
            match place {
                Some(inner) => waiting.push(inner),
                None => *sum.entry(Some(node)).or_insert(0.0) += factor,
            }
        }
        sum.retain(|_, factor| *factor != 0.0);
        sum
    }
}
