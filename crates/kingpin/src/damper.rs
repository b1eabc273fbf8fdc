//! The smallest damper with which no shimmy is born up to a speed.
//!
//! In the plane of speed and damping the stability boundary is [traced](crate::boundary); the least damping at which the uniform
//! motion is stable at every speed of the range is at one of its peaks, or where it leaves the range. Stability may be lost again
//! with more damping, so that these are tried from the least on.
//!
//! This speaks of small motions only: a wheel that is stable at every speed may still have large cycles (Takács, Stépán and Hogan
//! 2008), and removing them takes more.

use crate::boundary::Curve;
use crate::critical_speed::{SECTION, bisect};
use crate::error::KingpinError;
use crate::parameters::{Key, Tyre};
use crate::plane::{Axis, Plane};
use crate::wheel::Wheel;
use arclength::control::Control;

/// Speeds at which stability is looked at between the smallest and the largest of the range, and the smallest as part of the
/// largest.
const SPEEDS: usize = 200;
const SLOWEST: f64 = 1e-3;
/// The dampers that are tried begin at this part of a damper that would take the lateral motion a period to die out.
const WEAKEST: f64 = 1e-3;
/// Doublings of it that are tried.
const DOUBLINGS: usize = 24;
/// The plane reaches this many times as far as the damper that is enough.
const BEYOND: f64 = 1.1;
/// Relative distance from a boundary at which the stability on both sides is compared.
const ASIDE: f64 = 1e-6;
/// Steps by which a peak is narrowed down.
const GOLDEN_STEPS: usize = 40;

/// The smallest damper that is enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallestDamper {
    /// Damping in the unit of the parameter; zero where none is needed.
    pub damping: f64,
    /// The speed in m/s that decides: with a weaker damper the motion is unstable there. `None` where none is needed.
    pub speed: Option<f64>,
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
        self.check_tyre()?;
        let speeds = Axis::new(Key::V, SLOWEST * up_to..=up_to)?;
        let search = Search { wheel: self, key, up_to };
        let rigid = |stiffness: Key| self.get(stiffness).is_infinite();
        if search.is_enough(0.0) {
            return Ok(Some(SmallestDamper { damping: 0.0, speed: None }));
        }
        // Where nothing gives way nothing is damped.
        if (key == Key::CQ && rigid(Key::KQ)) || (key == Key::CU && rigid(Key::KU)) {
            return Ok(None);
        }
        let Some(enough) = search.some_that_is_enough(control)? else { return Ok(None) };
        let plane = Plane::new(speeds, Axis::new(key, 0.0..=BEYOND * enough)?)?;
        let mut peaks = Vec::new();
        for curve in self.stability_boundary(&plane, control)? {
            peaks.extend(search.peaks(&curve));
        }
        peaks.sort_by(|one, other| one[1].total_cmp(&other[1]));
        for [speed, damping] in peaks {
            control.check()?;
            let is_needed = search.is_stable(speed, damping * (1.0 - ASIDE)) == Some(false);
            if is_needed && search.is_enough(damping * (1.0 + ASIDE)) {
                return Ok(Some(SmallestDamper { damping, speed: Some(speed) }));
            }
        }
        Ok(None)
    }
}

struct Search<'a> {
    wheel: &'a Wheel,
    key: Key,
    up_to: f64,
}

impl Search<'_> {
    fn is_stable(&self, speed: f64, damping: f64) -> Option<bool> {
        let wheel = self.wheel.with(self.key, damping).and_then(|wheel| wheel.with(Key::V, speed)).ok()?;
        wheel.uniform_motion().map_or(Some(false), |motion| motion.is_stable())
    }

    /// Whether the motion is nowhere surely unstable, and stable at the largest speed.
    fn is_enough(&self, damping: f64) -> bool {
        let speed = |index: usize| self.up_to * SLOWEST.powf(1.0 - index as f64 / SPEEDS as f64);
        let even = |index: usize| self.up_to * (index + 1) as f64 / (SPEEDS + 1) as f64;
        let mut all = (0..SPEEDS).flat_map(|index| [speed(index), even(index)]).chain([self.up_to]);
        all.all(|speed| self.is_stable(speed, damping) != Some(false))
    }

    fn some_that_is_enough(&self, control: &Control<'_>) -> Result<Option<f64>, KingpinError> {
        let arm = self.wheel.get(Key::L);
        let rotational = self.rotational_scale();
        let unit = if self.key == Key::CPsi { rotational } else { rotational / (arm * arm) };
        for doubling in 0..DOUBLINGS {
            control.check()?;
            let damping = WEAKEST * unit * f64::powi(2.0, doubling as i32);
            if BEYOND * damping > self.key.allowed().highest {
                return Ok(None);
            }
            if self.is_enough(damping) {
                return Ok(Some(damping));
            }
        }
        Ok(None)
    }

    /// A damper about the king pin, in N m s/rad, that would take the lateral motion about a period to die out.
    fn rotational_scale(&self) -> f64 {
        if self.wheel.tyre() == Tyre::Rigid {
            return self.wheel.natural_rotational_damping();
        }
        let inertia = self.wheel.body().inverse_yaw_inertia.recip();
        let fastest = self.wheel.with(Key::V, self.up_to).and_then(|wheel| wheel.uniform_motion());
        let eigenvalues = fastest.map(|motion| motion.eigenvalues()).unwrap_or_default();
        let frequency = eigenvalues.iter().map(|eigenvalue| eigenvalue.norm()).fold(0.0, f64::max);
        // Without a motion at the largest speed no damper is enough.
        if frequency > 0.0 { frequency * inertia } else { f64::INFINITY }
    }

    /// Speeds and dampings of the peaks of a boundary, and of its ends.
    fn peaks(&self, curve: &Curve) -> Vec<[f64; 2]> {
        let points = &curve.points;
        let mut peaks = Vec::new();
        for index in 0..points.len() {
            let here = points[index];
            let neighbour = |step: isize| {
                let other = index as isize + step;
                if curve.closed {
                    return points.get(other.rem_euclid(points.len() as isize - 1) as usize);
                }
                usize::try_from(other).ok().and_then(|other| points.get(other))
            };
            match (neighbour(-1), neighbour(1)) {
                (Some(before), Some(after)) if before[1] <= here[1] && after[1] <= here[1] => {
                    peaks.push(self.peak([*before, here, *after]));
                }
                (Some(_), Some(_)) => {}
                // An end is at the edge of the plane up to the step of the trace.
                _ if (here[0] - self.up_to).abs() < ASIDE * self.up_to => {
                    let damping = self.boundary_at(self.up_to, here[1], 1e-3 * here[1]);
                    peaks.push([self.up_to, damping.unwrap_or(here[1])]);
                }
                _ => peaks.push(here),
            }
        }
        peaks
    }

    /// The peak between three points of a boundary, by golden section.
    fn peak(&self, [before, here, after]: [[f64; 2]; 3]) -> [f64; 2] {
        let reach = 2.0 * (here[1] - before[1].min(after[1])).max(1e-6 * here[1]);
        let (mut low, mut high) = (before[0].min(after[0]), before[0].max(after[0]));
        let height = |speed: f64| self.boundary_at(speed, here[1], reach);
        let mut best = here;
        for _ in 0..GOLDEN_STEPS {
            let places = [high - SECTION * (high - low), low + SECTION * (high - low)];
            let [Some(left), Some(right)] = places.map(height) else { break };
            for (speed, damping) in places.into_iter().zip([left, right]) {
                if damping > best[1] {
                    best = [speed, damping];
                }
            }
            if left > right { high = places[1] } else { low = places[0] }
        }
        best
    }

    /// The damping near a guess at which the growth rate changes its sign at a speed.
    fn boundary_at(&self, speed: f64, guess: f64, reach: f64) -> Option<f64> {
        let rate = |damping: f64| {
            let wheel =
                self.wheel.with(self.key, damping).and_then(|wheel| wheel.with(Key::V, speed)).ok()?;
            Some(wheel.uniform_motion().ok()?.growth_rate())
        };
        let (low, high) = ((guess - reach).max(0.0), guess + reach);
        let below = rate(low)?;
        if (rate(high)? < 0.0) == (below < 0.0) {
            return None;
        }
        bisect(low, below, high, rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        assert_eq!(none_needed, Some(SmallestDamper { damping: 0.0, speed: None }));
    }
}
