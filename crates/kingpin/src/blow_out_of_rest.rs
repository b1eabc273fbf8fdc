//! The smallest blow on the wheel that dry friction about the king pin does not take in one swing.
//!
//! A blow is a change of the velocities, which no friction prevents: the caster swings, and friction stops it. What is asked is whether
//! it stays where that first swing ends.
//!
//! - A rigid wheel that rolls rests at one caster angle only, and the swing after any blow ends at another one (after a weak one
//!   `J w^2/(2 M_f)` away, for the yaw rate `w` that the blow gives): held there it drifts sideways until it breaks away. The smallest blow
//!   is zero. Whether the swings that follow die out is the question of [`SafeKick`](crate::basin::SafeKick).
//! - With a tyre there is an interval of angles at rest, and the tyre gives way during the swing: there is no closed form. Motions are
//!   followed, and the edge is found by bisection.
//! - While the wheel slides sideways the caster may be held at an angle: at any, without a spring about the king pin, so that no blow is
//!   too strong; else up to an angle, and the blow after which the swing ends just there is found by bisection.

use crate::basin::{ClassificationSettings, ContactModel, Destinations, Disturbance, Fate};
use crate::parameters::{Key, Tyre};
use crate::simulation::{SIMULATION_TOLERANCE, SimulationError};
use crate::sliding::KingPin;
use crate::wheel::Wheel;
use arclength::control::Control;
use std::f64::consts::{PI, TAU};

/// The edge is narrowed down to this part of it.
const RESOLUTION: f64 = 1e-6;
/// Blows that are tried at equal distances up to one that is not held.
const SCAN: usize = 32;
/// Motions are followed for so many times of what is to come to rest.
const SETTLING: f64 = 10.0;
/// How often a first guess is doubled or halved.
const DOUBLINGS: usize = 40;

/// The smallest blow after which the caster does not stay where its first swing ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlowOutOfRest {
    /// Its size in N s, in the direction in which it is smaller; zero where any blow is too strong, `None` where none was found that is.
    pub blow: Option<f64>,
    /// Whether it was found by following motions; else it is known in closed form.
    pub simulated: bool,
    /// Distance in N s to the largest one that was seen to be held.
    pub resolution: Option<f64>,
    /// Distance in N s of the blows that were tried below: one that is not held, in a narrower range, may have been missed.
    pub scanned: Option<f64>,
    /// What becomes of the motion after it, where that was followed.
    pub fate: Option<Fate>,
}

impl BlowOutOfRest {
    const fn in_closed_form(blow: Option<f64>) -> Self {
        Self { blow, simulated: false, resolution: None, scanned: None, fate: None }
    }
}

impl Wheel {
    /// The smallest sideways blow on the rim (that of [`Disturbance::Impulse`]) after which the caster of the rolling wheel, which dry
    /// friction about the king pin stops, does not stay where its first swing ends. `None` without dry friction.
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Key, Wheel};
    /// let wheel = Wheel::default().with(Key::Curvature, 0.0)?.with(Key::MF, 0.02)?;
    /// // It rests at one angle only.
    /// assert_eq!(wheel.blow_out_of_rest(&Control::none())?.and_then(|edge| edge.blow), Some(0.0));
    /// # Ok::<(), kingpin::simulation::SimulationError>(())
    /// ```
    ///
    /// # Errors
    /// No uniform motion; [`SimulationError::Interrupted`].
    pub fn blow_out_of_rest(&self, control: &Control<'_>) -> Result<Option<BlowOutOfRest>, SimulationError> {
        let moment = self.get(Key::MF);
        if moment == 0.0 {
            return Ok(None);
        }
        self.uniform_motion()?;
        if self.tyre() == Tyre::Rigid {
            return Ok(Some(BlowOutOfRest::in_closed_form(Some(0.0))));
        }
        let Some([low, high]) = self.resting_angles()? else { return Ok(None) };
        let angles = [low, high];
        let is_held = |blow: f64| self.stays_after_one_swing(blow, angles, control);
        let mut edge = self.edge(0.5 * (high - low), ContactModel::Rolling, is_held)?;
        if let Some(blow) = edge.blow.filter(|blow| *blow != 0.0) {
            // The direction in which it is not held.
            let blow = if is_held(blow)? { -blow } else { blow };
            let (_, state) = Disturbance::Impulse.apply(self, ContactModel::Rolling, blow)?;
            let settings = ClassificationSettings::for_wheel(self)?;
            let destinations = Destinations::new(self, ContactModel::Rolling, settings)?;
            edge.fate = Some(destinations.of_disturbed(&state, control)?);
        }
        Ok(Some(edge))
    }

    /// The smallest sideways blow on the rim of a wheel that may slide after which the first swing of the caster ends beyond the
    /// [largest angle](Self::largest_resting_angle_while_sliding) at which dry friction holds it while the wheel slides. `None` where there
    /// is no such angle.
    ///
    /// # Errors
    /// As [`sliding`](Self::sliding); [`SimulationError::Interrupted`].
    pub fn blow_out_of_rest_while_sliding(
        &self,
        control: &Control<'_>,
    ) -> Result<Option<BlowOutOfRest>, SimulationError> {
        let Some(largest) = self.largest_resting_angle_while_sliding() else { return Ok(None) };
        if self.has_lateral_elasticity_only() {
            return Ok(None);
        }
        if largest >= PI {
            return Ok(Some(BlowOutOfRest::in_closed_form(None)));
        }
        let wheel = self.sliding()?;
        let duration = ClassificationSettings::for_wheel(self)?.duration;
        let is_held = |blow: f64| {
            let (_, state) = Disturbance::Impulse.apply(self, ContactModel::Sliding, blow)?;
            let mut angle = f64::INFINITY;
            let followed = wheel.follow(wheel.slipping_state(&state), duration, &[], control, |piece| {
                let sticks = piece.phase.king_pin == KingPin::Sticking && piece.phase.end > piece.phase.start;
                if sticks {
                    angle = piece.solution.state[2].abs();
                }
                !sticks
            });
            lost_where_it_cannot_be_followed(followed.map(|_| angle <= largest))
        };
        Ok(Some(self.edge(largest, ContactModel::Sliding, is_held)?))
    }

    /// Whether the caster of a wheel with a tyre swings once after a blow, ends at an angle at which it rests, and is not shaken loose by
    /// what else moves: the springs and the tyre are given time to come to rest.
    fn stays_after_one_swing(
        &self,
        blow: f64,
        [low, high]: [f64; 2],
        control: &Control<'_>,
    ) -> Result<bool, SimulationError> {
        let (_, state) = Disturbance::Impulse.apply(self, ContactModel::Rolling, blow)?;
        let wheel = self.swinging(SIMULATION_TOLERANCE)?;
        let start = wheel.free_state(&state);
        // Times in s: of the tyre, of a spring (none where it is rigid), and of a swing against the friction alone.
        let tyre = self.get(Key::Sigma) / self.get(Key::V);
        let springs = TAU * (self.mass() / self.get(Key::KQ).min(self.get(Key::KU))).sqrt();
        let swing = (2.0 * (high - low) / (self.get(Key::MF) * self.body().inverse_yaw_inertia)).sqrt();
        let duration = SETTLING * (tyre + springs + swing);
        let (mut swings, mut sticks) = (0, false);
        let followed = wheel.follow(&start, duration, &[], control, |stretch| {
            if stretch.phase.end > stretch.phase.start {
                sticks = stretch.phase.king_pin == KingPin::Sticking;
                swings += usize::from(!sticks);
            }
        });
        let held = followed.map(|reached| {
            let angle = wheel.reduced(&reached.state)[2];
            reached.border.is_none() && sticks && swings <= 1 && (low..=high).contains(&angle)
        });
        lost_where_it_cannot_be_followed(held)
    }

    /// The smallest blow in either direction that is not held. The first guess is the one whose energy takes the caster through an angle
    /// against the friction alone.
    fn edge(
        &self,
        angle: f64,
        model: ContactModel,
        is_held: impl Fn(f64) -> Result<bool, SimulationError>,
    ) -> Result<BlowOutOfRest, SimulationError> {
        // Towed straight both directions are mirror images.
        let straight = self.towing_yaw_rate() == 0.0;
        let is_held = |blow: f64| Ok::<_, SimulationError>(is_held(blow)? && (straight || is_held(-blow)?));
        let [_, yaw] = self.velocity_change(1.0, model)?;
        let mut lost = (2.0 * self.get(Key::MF) * self.body().inverse_yaw_inertia * angle).sqrt() / yaw.abs();
        if !(lost > 0.0 && lost.is_finite()) {
            return Ok(BlowOutOfRest::in_closed_form(Some(0.0)));
        }
        let mut doublings = 0;
        while is_held(lost)? {
            lost *= 2.0;
            doublings += 1;
            if doublings == DOUBLINGS {
                return Ok(BlowOutOfRest { simulated: true, ..BlowOutOfRest::in_closed_form(None) });
            }
        }
        let mut held = 0.0;
        let mut scanned = lost / SCAN as f64;
        for _ in 0..DOUBLINGS {
            scanned = lost / SCAN as f64;
            let mut first = SCAN;
            for index in 1..SCAN {
                if !is_held(scanned * index as f64)? {
                    first = index;
                    break;
                }
            }
            (held, lost) = (scanned * (first - 1) as f64, scanned * first as f64);
            // Where the weakest that was tried is not held, weaker ones are tried.
            if held > 0.0 {
                break;
            }
        }
        while lost - held > RESOLUTION * lost {
            let middle = 0.5 * (held + lost);
            if middle <= held || middle >= lost {
                break;
            }
            if is_held(middle)? { held = middle } else { lost = middle }
        }
        Ok(BlowOutOfRest {
            blow: Some(lost),
            simulated: true,
            resolution: Some(lost - held),
            scanned: Some(scanned),
            fate: None,
        })
    }
}

/// A motion that leaves the range of numbers is not held.
fn lost_where_it_cannot_be_followed(held: Result<bool, SimulationError>) -> Result<bool, SimulationError> {
    match held {
        Err(SimulationError::Integration(_)) => Ok(false),
        held => held,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wheel on a tyre, towed straight.
    fn with_a_tyre(changes: &str) -> Wheel {
        let text = "tyre = \"linear\"\nsigma = 0.02\nC_alpha = 100.0\nr = inf\nv = 1.0\nM_f = 0.02\n";
        Wheel::from_toml(&format!("{text}{changes}")).unwrap()
    }

    /// How often the caster swings, from a simulation that knows nothing of the edge.
    fn swings(wheel: &Wheel, blow: f64) -> usize {
        let (_, state) = Disturbance::Impulse.apply(wheel, ContactModel::Rolling, blow).unwrap();
        let history = wheel.simulate_with_tyre_from(&state, 20.0, 2, &Control::none()).unwrap();
        history.phases.iter().filter(|phase| phase.king_pin == KingPin::Swinging).count()
    }

    #[test]
    fn just_below_the_edge_the_caster_swings_once_and_just_above_twice() {
        for changes in ["", "c_psi = 0.001", "t_p = 0.01\nk_psi = 0.05"] {
            let wheel = with_a_tyre(changes);
            let edge = wheel.blow_out_of_rest(&Control::none()).unwrap().unwrap();
            let blow = edge.blow.unwrap();
            assert!(blow > 0.0 && edge.resolution.unwrap() <= 1e-6 * blow, "{changes}: {edge:?}");
            assert_eq!(swings(&wheel, 0.999 * blow), 1, "{changes}: {edge:?}");
            assert_eq!(swings(&wheel, 0.3 * blow), 1, "{changes}: {edge:?}");
            assert!(swings(&wheel, 1.001 * blow) > 1, "{changes}: {edge:?}");
        }
    }

    /// The equations of small motions know no scale but the friction.
    #[test]
    fn the_edge_grows_as_the_friction() {
        let edge = |moment: f64| {
            let wheel = with_a_tyre("").with(Key::MF, moment).unwrap();
            wheel.blow_out_of_rest(&Control::none()).unwrap().unwrap().blow.unwrap()
        };
        let ratio = edge(2e-4) / edge(1e-4);
        assert!((ratio - 2.0).abs() < 1e-4, "{ratio}");
    }

    #[test]
    fn without_friction_nothing_is_held_and_without_a_tyre_no_blow_is() {
        let none = with_a_tyre("").with(Key::MF, 0.0).unwrap();
        assert_eq!(none.blow_out_of_rest(&Control::none()).unwrap(), None);
        let rigid = Wheel::default().with(Key::MF, 0.1).unwrap();
        let edge = rigid.blow_out_of_rest(&Control::none()).unwrap().unwrap();
        assert_eq!(edge, BlowOutOfRest::in_closed_form(Some(0.0)));
        assert_eq!(rigid.blow_out_of_rest_while_sliding(&Control::none()).unwrap(), None);
    }

    #[test]
    fn while_it_slides_the_swing_ends_at_the_largest_angle() {
        let text = "l = 0.08\nr = inf\nv = 1.0\nM_f = 0.6\nF_Az = -3.0\n";
        let free = Wheel::from_toml(text).unwrap();
        let edge = free.blow_out_of_rest_while_sliding(&Control::none()).unwrap().unwrap();
        assert_eq!(edge, BlowOutOfRest::in_closed_form(None));
        let sprung = Wheel::from_toml(&format!("{text}k_psi = 0.3\n")).unwrap();
        let largest = sprung.largest_resting_angle_while_sliding().unwrap();
        let edge = sprung.blow_out_of_rest_while_sliding(&Control::none()).unwrap().unwrap();
        let blow = edge.blow.unwrap();
        let farthest = |blow: f64| {
            let (_, state) = Disturbance::Impulse.apply(&sprung, ContactModel::Sliding, blow).unwrap();
            let wheel = sprung.sliding().unwrap();
            let history = wheel.simulate_from(&state, 2.0, 20_001, &Control::none()).unwrap();
            history.states.iter().fold(0.0_f64, |farthest, state| farthest.max(state[2].abs()))
        };
        let [below, above] = [0.999, 1.001].map(|part| farthest(part * blow));
        assert!(below < largest && largest < above, "{below} {largest} {above}: {edge:?}");
    }
}
