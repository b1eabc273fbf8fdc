//! The direction of the flow split off from the blocks of a cycle, so that the trivial multiplier leaves the others exactly.

/// The blocks without the direction of the flow.
pub(super) struct Deflated {
    /// For every part of the period a block of size `n - 1`, column-major.
    pub factors: Vec<f64>,
    /// The multiplier in the direction of the flow, which is one but for discretisation.
    pub trivial: f64,
    /// How far that and the split are from exact.
    pub trivial_error: f64,
}

impl Deflated {
    /// From the flow direction at the beginning of every part of the period and the block that maps it to the next. `None` where the
    /// field vanishes.
    pub(super) fn of(flow: Vec<f64>, transfer: &[f64], scales: &[f64]) -> Option<Self> {
        let n = scales.len();
        let intervals = flow.len() / n;
        let reflections = FlowReflections::of(flow, scales)?;
        let mut factors = vec![0.0; intervals * (n - 1) * (n - 1)];
        let mut trivial = 1.0;
        let mut coupling = 0.0;
        let mut block = vec![0.0; n * n];
        for (interval, transfer) in transfer.chunks_exact(n * n).enumerate() {
            let next = (interval + 1) % intervals;
            for column in 0..n {
                for row in 0..n {
                    block[row + n * column] = transfer[row + n * column] * scales[column] / scales[row];
                }
            }
            reflect_from_right(&mut block, reflections.vector(interval));
            reflect_from_left(&mut block, reflections.vector(next));
            // The lengths of the flow vectors cancel in the product of the corner entries up to discretisation.
            trivial *= block[0] * reflections.signs[interval] * reflections.signs[next];
            coupling += length(&block[1..n]);
            for column in 1..n {
                for row in 1..n {
                    factors[interval * (n - 1) * (n - 1) + row - 1 + (n - 1) * (column - 1)] =
                        block[row + n * column];
                }
            }
        }
        Some(Self { factors, trivial, trivial_error: (trivial - 1.0).abs().max(coupling) })
    }
}

/// Reflections `I - 2 v v'` that map the scaled direction of the flow at each mesh point to the first axis.
struct FlowReflections {
    /// The vectors `v`, one after the other.
    vectors: Vec<f64>,
    /// The signs of the images.
    signs: Vec<f64>,
    dimension: usize,
}

impl FlowReflections {
    fn of(mut flow: Vec<f64>, scales: &[f64]) -> Option<Self> {
        let n = scales.len();
        let mut signs = vec![1.0; flow.len() / n];
        for (reflector, sign) in flow.chunks_exact_mut(n).zip(&mut signs) {
            for (entry, scale) in reflector.iter_mut().zip(scales) {
                *entry /= scale;
            }
            let norm = length(reflector);
            if !(norm > 0.0 && norm.is_finite()) {
                return None;
            }
            *sign = if reflector[0] > 0.0 { -1.0 } else { 1.0 };
            reflector[0] -= *sign * norm;
            let norm = length(reflector);
            reflector.iter_mut().for_each(|entry| *entry /= norm);
        }
        Some(Self { vectors: flow, signs, dimension: n })
    }

    fn vector(&self, point: usize) -> &[f64] {
        &self.vectors[point * self.dimension..(point + 1) * self.dimension]
    }
}

/// A square block times `I - 2 v v'`.
fn reflect_from_right(block: &mut [f64], vector: &[f64]) {
    let n = vector.len();
    for row in 0..n {
        let sum: f64 = (0..n).map(|column| block[row + n * column] * vector[column]).sum();
        for column in 0..n {
            block[row + n * column] -= 2.0 * sum * vector[column];
        }
    }
}

/// `I - 2 v v'` times a square block.
fn reflect_from_left(block: &mut [f64], vector: &[f64]) {
    for column in block.chunks_exact_mut(vector.len()) {
        let sum: f64 = column.iter().zip(vector).map(|(a, b)| a * b).sum();
        for (entry, component) in column.iter_mut().zip(vector) {
            *entry -= 2.0 * sum * component;
        }
    }
}

fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}
