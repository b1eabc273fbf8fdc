//! How shimmy is born at a Hopf point of the uniform motion: in which direction the wheel swings, on which side of the point the
//! uniform motion is stable, how the amplitude grows with the parameter and the friction with the amplitude.
//!
//! To leading order the motion is the uniform one and `2 Re(zeta q e^(i omega t))` with the eigenvector `q`, where
//! `Re lambda'(p) (p - p_H) + Re c1 |zeta|^2 = 0`.

use super::Along;
use crate::rolling_model::RollingModel;
use crate::uniform_motion::UniformMotion;
use crate::{Key, KingpinError, Wheel};
use arclength::Dual;
use arclength::equilibrium::HopfPoint;
use num_complex::Complex64;
use std::fmt;

/// Real part of an eigenvalue, relative to the frequency, below which its sign is not decided.
const UNDECIDED: f64 = 1e-9;
/// Indices of the displacements of the king pin and of the caster angle among [all states](Wheel::states).
const LONGITUDINAL: usize = 0;
const LATERAL: usize = 1;
const ANGLE: usize = 2;

/// What moves farthest in an oscillation: the king pin along the towing direction or across it, or the wheel centre about the king
/// pin, on the way `l psi`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The king pin moves along the towing direction.
    Longitudinal,
    /// The king pin moves across the towing direction.
    Lateral,
    /// The caster turns about the king pin.
    Yaw,
}

impl fmt::Display for Mode {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Self::Longitudinal => "longitudinal",
            Self::Lateral => "lateral",
            Self::Yaw => "yaw",
        })
    }
}

/// How shimmy is born at a Hopf point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Birth {
    /// What moves farthest.
    pub mode: Mode,
    /// Number of unstable directions of the uniform motion just below and just above the value of the parameter; `None` where
    /// that is not decided. An undamped longitudinal motion in straight towing does not count.
    pub unstable: [Option<usize>; 2],
    /// Slope in the parameter of the square of the largest `psi - psi_0` of the cycles, in rad^2 over its unit, negative where they lie
    /// below the Hopf point; `None` where there is no first Lyapunov coefficient, or it is zero.
    pub psi_max_squared_slope: Option<f64>,
    /// Slope of the largest friction force in the largest `psi - psi_0` of the cycles, in N/rad.
    pub friction_slope: Option<f64>,
}

impl Birth {
    /// At a Hopf point that the engine found along a parameter.
    ///
    /// # Errors
    /// Those of [`rolling_model`](Wheel::rolling_model).
    pub(super) fn at(point: &HopfPoint, motion: &UniformMotion, along: Along) -> Result<Self, KingpinError> {
        let wheel = motion.wheel();
        let model = wheel.rolling_model(&[])?;
        let amplitude = |state: usize| {
            let place = model.free().iter().position(|&free| free == state);
            place.map_or(0.0, |place| point.eigenvector[place].norm())
        };
        // The derivative of the parameter that is followed in the key.
        let value = along.convert(point.value);
        let rate = if along.key() == Key::TurningRadius { -1.0 / (value * value) } else { 1.0 };
        let crossing_speed = point.crossing_speed.map(|speed| rate * speed);
        let angle = amplitude(ANGLE);
        let slope = crossing_speed.zip(point.c1_real).map(|(speed, c1)| -4.0 * angle * angle * speed / c1);
        let friction = friction_amplitude(&model, wheel, motion, &point.eigenvector) / angle;
        Ok(Self {
            mode: mode([amplitude(LONGITUDINAL), amplitude(LATERAL), wheel.get(Key::L) * angle]),
            unstable: unstable(motion, point.frequency, crossing_speed),
            psi_max_squared_slope: slope.filter(|slope| slope.is_finite()),
            friction_slope: Some(friction).filter(|slope| slope.is_finite()),
        })
    }
}

fn mode([longitudinal, lateral, yaw]: [f64; 3]) -> Mode {
    if longitudinal > lateral.max(yaw) {
        Mode::Longitudinal
    } else if lateral > yaw {
        Mode::Lateral
    } else {
        Mode::Yaw
    }
}

/// Numbers of unstable directions on both sides, from the eigenvalues beside the critical pair and the sense in which that crosses.
fn unstable(motion: &UniformMotion, frequency: f64, crossing_speed: Option<f64>) -> [Option<usize>; 2] {
    let mut eigenvalues = motion.eigenvalues_that_count();
    for critical in [frequency, -frequency] {
        let distance = |index: &usize| (eigenvalues[*index] - Complex64::new(0.0, critical)).norm();
        let nearest = (0..eigenvalues.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map(|index| eigenvalues.remove(index));
    }
    let decided = eigenvalues.iter().all(|eigenvalue| eigenvalue.re.abs() > UNDECIDED * frequency);
    let crossing_speed = crossing_speed.filter(|speed| decided && *speed != 0.0);
    let others = eigenvalues.iter().filter(|eigenvalue| eigenvalue.re > 0.0).count();
    match crossing_speed {
        Some(speed) if speed > 0.0 => [Some(others), Some(others + 2)],
        Some(_) => [Some(others + 2), Some(others)],
        None => [None; 2],
    }
}

/// By how much the friction force exceeds that of the uniform motion at its largest, to first order, in an oscillation along an
/// eigenvector with an amplitude of one.
fn friction_amplitude(
    model: &RollingModel,
    wheel: &Wheel,
    motion: &UniformMotion,
    eigenvector: &[Complex64],
) -> f64 {
    let state = model.free_state(&motion.states());
    let directed = |part: fn(&Complex64) -> f64| {
        let along: Vec<Dual<f64, 1>> = state
            .iter()
            .zip(eigenvector)
            .map(|(&value, entry)| Dual { value, derivatives: [part(entry)] })
            .collect();
        model.forces(&along, &[]).ground
    };
    let (real, imaginary) = (directed(|entry| entry.re), directed(|entry| entry.im));
    let [along, across] =
        [0, 1].map(|index| Complex64::new(real[index].derivatives[0], imaginary[index].derivatives[0]));
    if wheel.towing_yaw_rate() == 0.0 {
        // Without friction in the uniform motion its tip goes round an ellipse.
        let sum = along.norm_sqr() + across.norm_sqr();
        let minor = (along * along + across * across).norm();
        return (0.5 * (sum + minor)).sqrt();
    }
    let [steady_along, steady_across] = [real[0].value, real[1].value];
    (along * steady_along + across * steady_across).norm() / steady_along.hypot(steady_across)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moves_farthest_is_the_mode() {
        assert_eq!(mode([3.0, 2.0, 1.0]), Mode::Longitudinal);
        assert_eq!(mode([1.0, 2.0, 1.5]), Mode::Lateral);
        assert_eq!(mode([0.0, 0.0, 1.5]), Mode::Yaw);
    }
}
