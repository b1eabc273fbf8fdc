//! Wheels with a tyre.

use kingpin::{Key, Tyre, Wheel};

/// The paper's wheel with a tyre and other values of some parameters.
pub fn wheel(tyre: Tyre, settings: &[(Key, f64)]) -> Wheel {
    let mut wheel = Wheel::default();
    wheel.set_tyre(tyre);
    settings.iter().fold(wheel, |wheel, &(key, value)| wheel.with(key, value).unwrap())
}

pub fn inertia_about_king_pin(wheel: &Wheel) -> f64 {
    let get = |key| wheel.get(key);
    get(Key::JCz)
        + get(Key::JWzeta)
        + get(Key::MW) * get(Key::L).powi(2)
        + get(Key::MC) * get(Key::LC).powi(2)
}
