//! The smallest damper with which no shimmy is born at any speed up to a given one, on any of some circles, under any of some loads.
//!
//! A damper is tried over all speeds, and circles and loads, where the motion grows fastest; the dampings at which a wheel there becomes
//! stable are known exactly, and the least that is enough for all the wheels found so far is tried next, until none is unstable.
//! Stability may be lost again with more damping: it is the first damping that is enough, not the end of those that are.
//!
//! This speaks of small motions only: a wheel that is stable at every speed may still have large cycles (Takács, Stépán and Hogan
//! 2008), and removing them takes more.

mod condition;
mod critical_dampings;
mod growth;
mod search;

pub use condition::{Condition, SmallestDamper};

use crate::error::KingpinError;
use crate::parameters::Key;
use crate::plane::Axis;
use crate::wheel::Wheel;
use arclength::control::Control;
use growth::Conditions;

/// The smallest speed of the range as part of the largest.
const SLOWEST: f64 = 1e-3;
/// A speed that decides is the smallest one within this part of it.
const SAME_SPEED: f64 = 1e-6;

/// Whether the speed that decides over a damper is the smallest one that is looked at up to a largest one: then slower ones may take more.
///
/// Some wheels with a tyre are unstable at every low speed, and one damper alone has to be the stronger the slower they are towed.
pub fn is_slowest_speed(speed: f64, up_to: f64) -> bool {
    speed <= SLOWEST * up_to * (1.0 + SAME_SPEED)
}

impl Wheel {
    /// A damper about the king pin, in N m s/rad, that would take the lateral motion of the rolling wheel about a period to die out: `l` times
    /// the root of `k_q J`. Where the king pin is rigid sideways the tyre gives way in its place, `C_alpha/l`.
    pub fn natural_rotational_damping(&self) -> f64 {
        let body = self.body();
        let arm = body.caster_length;
        let stiffness = match body.lateral_stiffness {
            stiffness if stiffness.is_finite() => stiffness,
            _ => self.get(Key::CAlpha) / arm,
        };
        (stiffness * arm * arm / body.inverse_yaw_inertia).sqrt()
    }

    /// The smallest value of a damping parameter (`c_u`, `c_q` or `c_psi`, the others as they are) with which the uniform motion is
    /// stable at every speed from a thousandth of `up_to` to `up_to`; `None` where no value is found that is enough.
    ///
    /// # Errors
    /// [`Interrupted`](KingpinError::Interrupted); [`OutOfRange`](KingpinError::OutOfRange) for a speed that is not allowed.
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Key, Wheel};
    /// let mut wheel = Wheel::default();
    /// wheel.set("r", "inf")?;
    /// wheel.set("l", "0.04")?;
    /// let damper = wheel.smallest_damper(Key::CPsi, 3.0, &Control::none())?.unwrap();
    /// // In closed form: v (J/l - m).
    /// assert!((damper.damping / (3.0 * 1.2088e-4) - 1.0).abs() < 1e-6 && damper.speed == Some(3.0));
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn smallest_damper(
        &self,
        key: Key,
        up_to: f64,
        control: &Control<'_>,
    ) -> Result<Option<SmallestDamper>, KingpinError> {
        self.smallest_damper_over(key, up_to, &[], control)
    }

    /// The same at all values of other parameters, radii and loads.
    ///
    /// # Errors
    /// As [`smallest_damper`](Self::smallest_damper).
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Condition, Key, Wheel, branches::Along};
    /// let wheel = Wheel::default().with(Key::L, 0.04)?;
    /// let circles = Condition::Interval(Along::new(Key::TurningRadius, 1.0, f64::INFINITY)?);
    /// let damper = wheel.smallest_damper_over(Key::CPsi, 3.0, &[circles], &Control::none())?.unwrap();
    /// // The tightest circle takes most, more than straight towing: v (J/l - m).
    /// assert!(damper.damping > 3.0 * 1.2088e-4);
    /// assert_eq!(damper.corner.unwrap().get(Key::TurningRadius), 1.0);
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn smallest_damper_over(
        &self,
        key: Key,
        up_to: f64,
        conditions: &[Condition],
        control: &Control<'_>,
    ) -> Result<Option<SmallestDamper>, KingpinError> {
        self.check_tyre()?;
        let speeds = Axis::new(Key::V, SLOWEST * up_to..=up_to)?;
        search::smallest(key, &Conditions::new(self, speeds, conditions)?, control)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::branches::Along;
    use proptest::prelude::*;

    fn straight(l: f64) -> Wheel {
        Wheel::default().with(Key::TurningRadius, f64::INFINITY).unwrap().with(Key::L, l).unwrap()
    }

    /// The lateral motion of a plain wheel towed straight, in closed form: what `c_psi` and `c_q` have to be at least at a speed.
    fn closed_forms(wheel: &Wheel, v: f64) -> [f64; 2] {
        let (l, k) = (wheel.get(Key::L), wheel.get(Key::KQ));
        let d = l - wheel.get(Key::LC);
        let m = wheel.get(Key::MC) * d;
        let inertia = wheel.get(Key::JCz) + wheel.get(Key::JWzeta) + m * d;
        // c_psi k l^2 > l k v J - m v k l^2, and l^2 v c^2 + (m v^2 + l^3 k) c > k v (J - m l).
        let rotational = v * (inertia / l - m);
        let (a, b, c) = (l * l * v, m * v * v + l.powi(3) * k, -k * v * (inertia - m * l));
        [rotational, 2.0 * -c / (b + (b * b - 4.0 * a * c).sqrt())]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn straight_ahead_they_are_the_closed_forms(l in 0.016..0.045_f64, up_to in 0.2..20.0_f64) {
            let wheel = straight(l);
            let none = Control::none();
            let damper = |key| wheel.smallest_damper(key, up_to, &none).unwrap().unwrap();
            let rotational = damper(Key::CPsi);
            let [expected, _] = closed_forms(&wheel, up_to);
            prop_assert!((rotational.damping / expected - 1.0).abs() < 1e-8, "{rotational:?} {expected}");
            prop_assert_eq!(rotational.speed, Some(up_to));
            // The lateral damper is decided where its closed form is largest.
            let lateral = damper(Key::CQ);
            let expected = (1..=20_000)
                .map(|index| closed_forms(&wheel, up_to * f64::from(index) / 20_000.0)[1])
                .fold(0.0, f64::max);
            prop_assert!((lateral.damping / expected - 1.0).abs() < 1e-6, "{lateral:?} {expected}");
            let speed = lateral.speed.unwrap();
            if speed < up_to {
                let [below, here, above] =
                    [1.0 - 2e-4, 1.0, 1.0 + 2e-4].map(|part| closed_forms(&wheel, part * speed)[1]);
                let aside = 2e-4 * (above - below) / (2.0 * (2.0 * here - above - below));
                prop_assert!(aside.abs() < 1e-7, "{lateral:?} {aside:e}");
            }
        }
    }

    #[test]
    fn on_a_circle_the_corner_is_where_stability_is_lost_last() {
        let wheel = Wheel::default();
        let none = Control::none();
        for key in [Key::CQ, Key::CPsi] {
            let damper = wheel.smallest_damper(key, 12.0, &none).unwrap().unwrap();
            let corner = damper.speed.unwrap();
            let stable = |factor: f64, v: f64| {
                let damped = wheel.with(key, factor * damper.damping).unwrap();
                damped.with(Key::V, v).unwrap().uniform_motion().unwrap().is_stable()
            };
            assert_eq!((stable(0.9999, corner), stable(1.0001, corner)), (Some(false), Some(true)));
            assert!((1..=480).all(|step| stable(1.0001, f64::from(step) / 40.0) == Some(true)));
        }
        // Below its critical speed the wheel needs none.
        let none_needed = wheel.smallest_damper(Key::CQ, 8.0, &none).unwrap();
        assert_eq!(none_needed, Some(SmallestDamper { damping: 0.0, speed: None, corner: None }));
    }

    /// The largest of the smallest dampers on many circles.
    fn over_circles(wheel: &Wheel, key: Key, up_to: f64, [from, to]: [f64; 2]) -> f64 {
        let none = Control::none();
        let circle = |index: u32| from + (to - from) * f64::from(index) / 40.0;
        let damper = |curvature: f64| {
            let wheel = wheel.with(Key::Curvature, curvature).unwrap();
            wheel.smallest_damper(key, up_to, &none).unwrap().unwrap().damping
        };
        (0..=40).map(|index| damper(circle(index))).fold(0.0, f64::max)
    }

    #[test]
    fn over_circles_the_worst_decides() {
        let none = Control::none();
        let short = Wheel::default().with(Key::L, 0.04).unwrap();
        let soft = Wheel::default().with(Key::L, 0.07).unwrap().with(Key::CU, 0.3).unwrap();
        for (wheel, key, up_to, [from, to]) in [
            (short, Key::CPsi, 3.0, [0.0, 1.0]),
            (short, Key::CQ, 3.0, [0.0, 0.9]),
            (soft, Key::CQ, 9.0, [0.2, 2.0]),
            (soft, Key::CPsi, 9.0, [0.2, 2.0]),
        ] {
            let circles = Along::new(Key::TurningRadius, f64::recip(to), f64::recip(from)).unwrap();
            let circles = Condition::Interval(circles);
            let found = wheel.smallest_damper_over(key, up_to, &[circles], &none).unwrap().unwrap();
            let expected = over_circles(&wheel, key, up_to, [from, to]);
            // No sample is worse, and one comes near: those at the ends are among them.
            let ratio = expected / found.damping;
            assert!((0.999..1.0 + 1e-8).contains(&ratio), "{key} {up_to}: {found:?} {expected}");
            let corner = found.corner.unwrap();
            let stable = |factor: f64| {
                corner.with(key, factor * found.damping).unwrap().uniform_motion().unwrap().is_stable()
            };
            assert_eq!([stable(0.9999), stable(1.0001)], [Some(false), Some(true)]);
        }
    }

    #[test]
    fn several_radii_are_the_worst_of_them() {
        let none = Control::none();
        let wheel = Wheel::default().with(Key::L, 0.04).unwrap();
        let radii = [0.8, 2.0, f64::INFINITY];
        let condition = Condition::Values(Key::TurningRadius, radii.to_vec());
        let found = wheel.smallest_damper_over(Key::CQ, 3.0, &[condition], &none).unwrap().unwrap();
        let alone = radii.map(|radius| {
            let wheel = wheel.with(Key::TurningRadius, radius).unwrap();
            wheel.smallest_damper(Key::CQ, 3.0, &none).unwrap().unwrap().damping
        });
        let worst = alone.into_iter().fold(0.0, f64::max);
        assert!((found.damping / worst - 1.0).abs() < 1e-9, "{found:?} {alone:?}");
    }
}
