//! Cycles next to a Hopf point to second order in their amplitude.
//!
//! On the centre manifold `x = x0 + z q + h20 z^2/2 + h11 z conj(z)/2 + c.c.` (Kuznetsov, *Elements of Applied Bifurcation Theory*,
//! section 5.4), and on the cycles the parameter, and the equilibrium with it, moves with the squared amplitude. Where the growth
//! rate hardly depends on the parameter, what the first order leaves out moves the parameter further than the range of Newton's
//! method.

use super::hopf_start::HopfStart;
use crate::equilibrium::hopf::{CriticalPair, inner};
use crate::erased::ErasedField;
use num_complex::Complex64;

/// What a cycle of amplitude `|z|` is beside its first harmonic.
#[derive(Clone, Debug)]
pub(super) struct Expansion {
    /// Change of the mean of the states, divided by the squared amplitude.
    pub mean: Vec<f64>,
    /// Coefficients `h20` of the second harmonic.
    pub second_harmonic: Vec<Complex64>,
    /// Change of the parameter, divided by the squared amplitude.
    pub parameter: f64,
    /// Change of the angular frequency, divided by the squared amplitude.
    pub frequency: f64,
}

impl Expansion {
    /// The expansion at a Hopf point; `None` where its normal form is not known or degenerate.
    pub(super) fn at(
        hopf: &HopfStart<'_>,
        field: ErasedField<'_>,
        parameters: &[f64],
        active: usize,
        scales: &[f64],
    ) -> Option<Self> {
        let parameter = -hopf.cubic_coefficient / hopf.crossing_speed;
        if !parameter.is_finite() {
            return None;
        }
        let pair = CriticalPair::at(field, hopf.state, parameters, hopf.frequency, scales).ok()?;
        let forms = pair.forms();
        let q = hopf.eigenvector;
        let conjugate: Vec<Complex64> = q.iter().map(Complex64::conj).collect();
        let product = inner(&pair.left, q);
        let left: Vec<Complex64> = pair.left.iter().map(|entry| entry / product.conj()).collect();
        let constant = pair.resolvent(Complex64::ZERO, &forms.complex(&[q, &conjugate]))?;
        let double = Complex64::new(0.0, 2.0 * hopf.frequency);
        let second_harmonic = pair.resolvent(double, &forms.complex(&[q, q]))?;
        let cubic = inner(&left, &forms.complex(&[q, q, &conjugate]))
            + inner(&left, &forms.complex(&[q, &constant])) * 2.0
            + inner(&left, &forms.complex(&[&conjugate, &second_harmonic]));

        let n = hopf.state.len();
        let mut along = vec![0.0; n + parameters.len()];
        along[n + active] = 1.0;
        let slope: Vec<Complex64> = forms.real(&[&along]).into_iter().map(Complex64::from).collect();
        let response = pair.resolvent(Complex64::ZERO, &slope)?;
        let direction: Vec<Complex64> =
            response.iter().copied().chain(along[n..].iter().map(|&entry| Complex64::from(entry))).collect();
        let rate = inner(&left, &forms.complex(&[q, &direction]));
        let expansion = Self {
            mean: constant.iter().zip(&response).map(|(own, moved)| own.re + parameter * moved.re).collect(),
            second_harmonic,
            parameter,
            frequency: 0.5 * cubic.im + parameter * rate.im,
        };
        let finite = expansion.frequency.is_finite()
            && expansion.mean.iter().all(|value| value.is_finite())
            && expansion.second_harmonic.iter().all(|value| value.is_finite());
        finite.then_some(expansion)
    }
}
