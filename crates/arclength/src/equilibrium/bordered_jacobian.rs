//! The Jacobian of an equilibrium that has an eigenvalue zero, bordered by its null vectors so that it can be solved with.

use crate::algebraic::ScaledLu;

/// Solves with a singular Jacobian on the complements of its null vectors.
pub(crate) struct BorderedJacobian {
    lu: ScaledLu,
    dimension: usize,
}

impl BorderedJacobian {
    /// From the column-major `jacobian`, its left null vector and the sizes of the states; solutions are orthogonal to `normal`. `None`
    /// where the border does not make it regular.
    pub(crate) fn of(jacobian: &[f64], normal: &[f64], left: &[f64], scales: &[f64]) -> Option<Self> {
        let n = normal.len();
        let m = n + 1;
        let mut bordered = vec![0.0; m * m];
        for column in 0..n {
            bordered[m * column..m * column + n].copy_from_slice(&jacobian[n * column..n * (column + 1)]);
            bordered[n + m * column] = normal[column];
            bordered[column + m * n] = left[column] * scales[column] * scales[column];
        }
        let mut columns = scales[..n].to_vec();
        columns.push(1.0);
        let mut lu = ScaledLu::default();
        (lu.factorize(m, &bordered, &columns) != 0.0).then_some(Self { lu, dimension: n })
    }

    /// The vector whose image is the right-hand side, up to the part that cannot be reached.
    pub(crate) fn solve(&self, right_hand_side: &[f64]) -> Vec<f64> {
        let mut vector = right_hand_side.to_vec();
        vector.push(0.0);
        self.lu.solve(&mut vector);
        vector.truncate(self.dimension);
        vector
    }
}
