//! The second Lyapunov coefficient of a generalised Hopf point.
//!
//! Source: Kuznetsov, "Numerical normalization techniques for all codim 2 bifurcations of equilibria in ODE's", *SIAM J.
//! Numer. Anal.* 36 (1999), section 3.

use super::hopf::{CriticalPair, inner};
use num_complex::Complex64;

/// A vector with complex entries.
type Vector = Vec<Complex64>;

fn sum(terms: &[(f64, Vector)]) -> Vector {
    let length = terms.first().map_or(0, |(_, vector)| vector.len());
    (0..length).map(|index| terms.iter().map(|(factor, vector)| vector[index] * *factor).sum()).collect()
}

fn conjugate(vector: &[Complex64]) -> Vector {
    vector.iter().map(Complex64::conj).collect()
}

impl CriticalPair<'_> {
    /// `Re(c2)/omega` with `c2` the coefficient of `z |z|^4` and `<q, q> = <p, q> = 1`, valid where the first Lyapunov
    /// coefficient vanishes; `None` if an eigenvalue is zero or a resonant multiple of the critical one.
    pub(crate) fn second_lyapunov(&self) -> Option<f64> {
        let forms = self.forms();
        let form = |directions: &[&Vector]| {
            let directions: Vec<&[Complex64]> =
                directions.iter().map(|direction| direction.as_slice()).collect();
            forms.complex(&directions)
        };
        let i = |multiple: f64| Complex64::new(0.0, multiple * self.frequency);
        let q = &self.right;
        let r = &conjugate(q);

        let h20 = &self.resolvent(i(2.0), &form(&[q, q]))?;
        let h11 = &self.resolvent(Complex64::ZERO, &form(&[q, r]))?;
        let h02 = &conjugate(h20);
        let h30 = &self.resolvent(i(3.0), &sum(&[(1.0, form(&[q, q, q])), (3.0, form(&[q, h20]))]))?;
        let cubic = sum(&[(1.0, form(&[q, q, r])), (1.0, form(&[r, h20])), (2.0, form(&[q, h11]))]);
        let c1 = inner(&self.left, &cubic) * 0.5;
        let rest: Vector = cubic.iter().zip(q).map(|(value, entry)| value - c1 * 2.0 * entry).collect();
        let h21 = &self.critical_resolvent(&rest)?;
        let h12 = &conjugate(h21);
        let mut quartic = sum(&[
            (1.0, form(&[q, q, q, r])),
            (3.0, form(&[q, q, h11])),
            (3.0, form(&[q, r, h20])),
            (3.0, form(&[h20, h11])),
            (1.0, form(&[r, h30])),
            (3.0, form(&[q, h21])),
        ]);
        quartic.iter_mut().zip(h20).for_each(|(entry, h)| *entry -= c1 * 6.0 * h);
        let h31 = &self.resolvent(i(2.0), &quartic)?;
        let h22 = &self.resolvent(
            Complex64::ZERO,
            &sum(&[
                (1.0, form(&[q, q, r, r])),
                (4.0, form(&[q, r, h11])),
                (1.0, form(&[r, r, h20])),
                (1.0, form(&[q, q, h02])),
                (2.0, form(&[h11, h11])),
                (2.0, form(&[q, h12])),
                (2.0, form(&[r, h21])),
                (1.0, form(&[h02, h20])),
            ]),
        )?;
        let quintic = sum(&[
            (1.0, form(&[q, q, q, r, r])),
            (1.0, form(&[q, q, q, h02])),
            (3.0, form(&[q, r, r, h20])),
            (6.0, form(&[q, q, r, h11])),
            (1.0, form(&[r, r, h30])),
            (3.0, form(&[q, q, h12])),
            (6.0, form(&[q, r, h21])),
            (3.0, form(&[q, h02, h20])),
            (6.0, form(&[q, h11, h11])),
            (6.0, form(&[r, h20, h11])),
            (2.0, form(&[r, h31])),
            (3.0, form(&[q, h22])),
            (1.0, form(&[h02, h30])),
            (3.0, form(&[h12, h20])),
            (6.0, form(&[h11, h21])),
        ]);
        let value = inner(&self.left, &quintic).re / (12.0 * self.frequency);
        value.is_finite().then_some(value)
    }
}
