//! The towed wheel at l = 0.08 m, r = 1 m.

use super::hopf_start;
use arclength::cycle::CycleStart;
use arclength::{Scalar, VectorField};

/// The towed wheel of the project's theory, l = 0.08 m, r = 1 m, towing speed active.
pub(crate) struct Wheel;

impl VectorField for Wheel {
    fn state_names(&self) -> Vec<String> {
        ["u", "q", "psi", "V", "Omega"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["v".into()]
    }
    fn dimension(&self) -> usize {
        5
    }
    #[inline(always)]
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], out: &mut [T]) {
        let (m_w, m_c, inertia_spin, inertia_wheel, inertia_caster) =
            (0.3519, 0.0668, 4.63e-5, 2.38e-5, 3.48e-6);
        let (radius, l_c, k, l, r) = (0.04, 0.012, 100.0, 0.08, 1.0);
        let d = l - l_c;
        let mass = m_w + m_c + inertia_spin / (radius * radius);
        let inertia = inertia_caster + inertia_wheel + m_c * d * d;
        let m = m_c * d;
        let (u, q, psi, forward, yaw) = (x[0], x[1], x[2], x[3], x[4]);
        let v = p[0];
        let omega = v / r;
        let (sine, cosine) = psi.sin_cos();
        out[0] = forward * cosine + yaw * sine * l - v + omega * q;
        out[1] = yaw * cosine * l - forward * sine - omega * u;
        out[2] = omega - yaw;
        out[3] = (yaw * yaw * m - (u * cosine - q * sine) * k) / mass;
        out[4] = (-(forward * yaw * m) - (u * sine + q * cosine) * (k * l)) / inertia;
    }
}

/// Its Hopf point from the closed forms, and the towing speed there.
pub(crate) fn wheel_start() -> (CycleStart, f64) {
    let v = 8.43103697014;
    let (d, l, k, m_c) = (0.068, 0.08, 100.0, 0.0668);
    let m = m_c * d;
    let omega: f64 = v;
    let a0 = m * omega * omega / k;
    let v0 = omega * (1.0 - (l - a0) * (l - a0)).sqrt() / (1.0 - m * omega * omega / (k * l));
    let b0 = -m * omega * v0 / (k * l);
    let psi0 = (l - a0).asin();
    let state = vec![a0 * psi0.cos() + b0 * psi0.sin(), -a0 * psi0.sin() + b0 * psi0.cos(), psi0, v0, omega];
    (hopf_start(&Wheel, &state, &[v]), v)
}
