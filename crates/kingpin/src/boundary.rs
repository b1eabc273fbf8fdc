//! Boundaries in the plane of two parameters, traced as curves.
//!
//! The stability boundary consists of the zeros of the Hurwitz determinant (flutter: a conjugate pair crosses) and of
//! the determinant of the Jacobian (divergence: a real eigenvalue crosses) at which the other conditions for stability
//! hold. The rolling limit is the zero set of `F_f - mu_s N`.

use crate::parameters::Key;
use crate::plane::Plane;
use crate::tracing::{Traced, trace_zero_set};
use crate::wheel::Wheel;
use arclength::control::{Control, Interrupted};

/// A boundary in the plane of two parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Values `[x, y]` of the two parameters, in order along the curve, each converged by Newton's method.
    pub points: Vec<[f64; 2]>,
    /// Whether the last point is the first.
    pub closed: bool,
}

impl Wheel {
    /// The curves in the plane on which the uniform motion changes its stability. They end where the plane or the motion
    /// does.
    ///
    /// # Errors
    /// [`Interrupted`].
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Axis, Key, Plane, Wheel};
    /// let plane = Plane::new(Axis::new(Key::V, 0.0..=10.0)?, Axis::new(Key::L, 0.02..=0.2)?)?;
    /// let wheel = Wheel::default();
    /// for [v, l] in &wheel.stability_boundary(&plane, &Control::none())?[0].points {
    ///     let critical = wheel.with(Key::L, *l)?.critical_yaw_rate().unwrap();
    ///     assert!((v * v - critical * critical).abs() < 1e-9);
    /// }
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn stability_boundary(
        &self,
        plane: &Plane,
        control: &Control<'_>,
    ) -> Result<Vec<Curve>, Interrupted> {
        let mut boundary = self.zero_set(plane, Wheel::flutter_margin, &control.part(0.0..0.5))?;
        boundary.extend(self.zero_set(plane, Wheel::divergence_margin, &control.part(0.5..1.0))?);
        Ok(boundary)
    }

    /// The curves in the plane on which small motions of the wheel that is towed straight just die out with dry friction about the king
    /// pin, however little: the [factor of a swing](Self::swing_factor) has the modulus one. None on a circle and with a tyre.
    ///
    /// # Errors
    /// [`Interrupted`].
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Axis, Key, Plane, Wheel};
    /// let wheel = Wheel::default().with(Key::Curvature, 0.0)?;
    /// let plane = Plane::new(Axis::new(Key::V, 0.1..=10.0)?, Axis::new(Key::L, 0.03..=0.05)?)?;
    /// for [v, l] in &wheel.swing_boundary(&plane, &Control::none())?[0].points {
    ///     let critical = wheel.with(Key::L, *l)?.critical_speed_with_friction().unwrap();
    ///     assert!((v - critical).abs() < 1e-6);
    /// }
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn swing_boundary(&self, plane: &Plane, control: &Control<'_>) -> Result<Vec<Curve>, Interrupted> {
        self.zero_set(plane, |wheel| wheel.swing_factor().map(|factor| factor.abs() - 1.0), control)
    }

    /// The curves in the plane on which the ground can just hold the wheel in its uniform motion, `F_f = mu_s N`.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub fn rolling_limit(&self, plane: &Plane, control: &Control<'_>) -> Result<Vec<Curve>, Interrupted> {
        let reserve = |wheel: &Wheel| {
            let force = wheel.uniform_motion().ok()?.contact_force();
            Some(force.friction() - force.limit)
        };
        self.zero_set(plane, reserve, control)
    }

    fn zero_set(
        &self,
        plane: &Plane,
        function: impl Fn(&Wheel) -> Option<f64>,
        control: &Control<'_>,
    ) -> Result<Vec<Curve>, Interrupted> {
        let parameters = |[x, y]: [f64; 2]| [plane.x().at(x), plane.y().at(y)];
        let keys: [Key; 2] = [plane.x().key(), plane.y().key()];
        let at_point = |point| {
            let [x, y] = parameters(point);
            function(&self.with(keys[0], x).ok()?.with(keys[1], y).ok()?)
        };
        let curves = trace_zero_set(at_point, control)?;
        let in_units = |Traced { points, closed }| Curve {
            points: points.into_iter().map(parameters).collect(),
            closed,
        };
        Ok(curves.into_iter().map(in_units).collect())
    }
}
