//! Hopf points of the uniform motion: where shimmy is born.

use super::Along;
use crate::{KingpinError, Wheel};
use arclength::branch::Criticality;
use arclength::control::Control;
use arclength::equilibrium::Equilibria;

/// A Hopf point of the uniform motion.
#[derive(Clone, Debug)]
pub struct HopfPoint {
    /// Value of the parameter along which it was found.
    pub value: f64,
    /// Angular frequency in rad/s.
    pub frequency: f64,
    /// First Lyapunov coefficient in Kuznetsov's scaling, states in SI units.
    pub first_lyapunov: Option<f64>,
    /// Whether the cycles that are born are unstable (subcritical) or stable (supercritical).
    pub criticality: Criticality,
    /// State `u q psi V Omega` of the uniform motion.
    pub state: [f64; 5],
    /// The wheel at this point.
    pub wheel: Wheel,
    /// The point as the continuation engine knows it, to start cycles from.
    pub detail: arclength::equilibrium::HopfPoint,
}

/// What a search for Hopf points found.
#[derive(Clone, Debug)]
pub struct HopfSearch {
    /// The Hopf points in ascending order of the parameter.
    pub points: Vec<HopfPoint>,
    /// Whether the uniform motion is stable at the lower and at the upper end of what could be searched.
    pub stable_at_ends: (Option<bool>, Option<bool>),
    /// Part of the interval in which the uniform motion was followed.
    pub searched: (f64, f64),
    /// Why the search ended below and above.
    pub stops: (String, String),
}

impl Wheel {
    /// The Hopf points of the uniform motion along a parameter.
    ///
    /// # Errors
    /// [`KingpinError::NoUniformMotion`] when there is none anywhere in the interval (the reason is that at its
    /// start), [`KingpinError::Continuation`] when the branch cannot be followed, [`KingpinError::Interrupted`].
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Key, Wheel, branches::Along};
    /// let search = Wheel::default().hopf_points(Along::new(Key::V, 1.0, 12.0)?, &Control::none())?;
    /// assert!((search.points[0].value - 8.43103697014).abs() < 1e-9);
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn hopf_points(&self, along: Along, control: &Control<'_>) -> Result<HopfSearch, KingpinError> {
        let mut first_error = None;
        let key = along.followed();
        for candidate in along.candidates(self) {
            control.check()?;
            let wheel = self.with(key, candidate)?;
            let motion = match wheel.uniform_motion() {
                Ok(motion) => motion,
                Err(error) => {
                    first_error.get_or_insert(error);
                    continue;
                }
            };
            let model = wheel.rolling_model(&[key])?;
            let branch = Equilibria::of(&model)
                .start(&model.free_state(&motion.state()))
                .parameters(&[candidate])
                .along(&key.to_string(), along.range())
                .observer(|_| control.flow())
                .run()?;
            control.check()?;
            let mut points = branch
                .hopf_points()
                .map(|point| {
                    Ok(HopfPoint {
                        value: along.convert(point.value),
                        frequency: point.frequency,
                        first_lyapunov: point.first_lyapunov,
                        criticality: point.criticality,
                        state: model.full_state(&point.state, &[point.value]),
                        wheel: wheel.with(key, point.value)?,
                        detail: point.clone(),
                    })
                })
                .collect::<Result<Vec<_>, KingpinError>>()?;
            points.sort_by(|a, b| a.value.total_cmp(&b.value));
            let ends: Vec<_> = branch.points.first().into_iter().chain(branch.points.last()).collect();
            let [first, last] = ends[..] else { continue };
            let mut ends =
                [first, last].map(|point| (along.convert(point.value), point.stability.is_stable()));
            let mut stops = branch.stops.map(|stop| {
                stop.map_or_else(String::new, |stop| {
                    along.tell(stop).explain(&[&along.key().to_string()]).cause
                })
            });
            if ends[0].0 > ends[1].0 {
                ends.reverse();
                stops.reverse();
            }
            return Ok(HopfSearch {
                points,
                stable_at_ends: (ends[0].1, ends[1].1),
                searched: (ends[0].0, ends[1].0),
                stops: stops.into(),
            });
        }
        let (start, end) = along.ends();
        Err(first_error.unwrap_or(KingpinError::EmptyInterval { key: along.key(), start, end }))
    }
}
