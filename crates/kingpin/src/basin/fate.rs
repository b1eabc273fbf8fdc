//! What becomes of a motion.

use super::contact_model::ContactModel;
use crate::parameters::{Key, Tyre};
use crate::simulation::SimulationError;
use crate::tyre::Rests;
use crate::wheel::Wheel;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// A motion has returned when it stays this near the uniform motion, relative to the reference speed, ...
pub(super) const NEAR: f64 = 0.02;
/// ... for this many natural periods of the springs.
const PERIODS_NEAR: f64 = 3.0;
/// Part of the duration for which a motion has to be near where it is not known whether small ones die out; then it is undecided.
const LINGERING: f64 = 0.25;
/// A motion has escaped when it is this many reference speeds away from the uniform motion.
const FAR: f64 = 50.0;
/// A motion that turns right round is given up for tumbling at the end of the duration; one that swings to and fro then is
/// followed on, for this many durations in all.
pub(super) const PATIENCE: f64 = 10.0;
/// Bounds in s of the duration that is chosen for a wheel, and the number of decay times in it.
const SHORTEST_DURATION: f64 = 30.0;
const LONGEST_DURATION: f64 = 300.0;
const DECAY_TIMES: f64 = 12.0;
/// Part of an angle from the theory of small motions that holds for motions that are near the uniform motion.
const LINEAR: f64 = 0.99;
/// Eigenvalues with a real part below this, relative to the natural frequency, count as neutral.
const NEUTRAL: f64 = 1e-9;

/// Nodes in one natural period of the springs: enough for maxima of motions with sliding phases to be right to a millionth.
const NODES_PER_PERIOD: f64 = 384.0;
/// Natural periods that are followed at a time.
const PERIODS_AT_A_TIME: f64 = 5.0;

/// What becomes of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Fate {
    /// It returns to the uniform motion.
    UniformMotion,
    /// The caster swings to and fro for ever: the motion repeats itself to a millionth of its size and, pushed a thousandth
    /// outwards or inwards, comes back to a tenth of that.
    Shimmy,
    /// The wheel slides for ever with the caster at rest in the towing frame: the motion stays near steady sliding of which small
    /// disturbances die out, as near as it has to come to the uniform motion to have returned.
    SteadySliding,
    /// It lasts to the end of the duration, the caster turning right round.
    Tumbling,
    /// It grows beyond fifty times the reference speed.
    Escape,
    /// The caster swings to and fro irregularly, with a size that has no trend, to the end of the time it was followed, ten times the
    /// duration, or once where small motions grow, so that it cannot return: whether for ever or as a long transient is undecided.
    Irregular,
    /// It comes to where the equations cease to hold, `V1 = 0` with a tyre and `psi = +-pi/2` with `k_u = inf`: what becomes of it
    /// is undecided.
    ModelEnds,
    /// It did none of these in the time it was followed: ten times the duration, where the caster swings to and fro.
    Undecided,
}

impl Fate {
    /// All fates.
    pub const ALL: [Fate; 8] = [
        Fate::UniformMotion,
        Fate::Shimmy,
        Fate::SteadySliding,
        Fate::Tumbling,
        Fate::Escape,
        Fate::Irregular,
        Fate::ModelEnds,
        Fate::Undecided,
    ];

    /// Name as it is written in results.
    pub const fn name(self) -> &'static str {
        match self {
            Fate::UniformMotion => "uniform motion",
            Fate::Shimmy => "shimmy",
            Fate::SteadySliding => "steady sliding",
            Fate::Tumbling => "tumbling",
            Fate::Escape => "escape",
            Fate::Irregular => "irregular swinging",
            Fate::ModelEnds => "end of the model",
            Fate::Undecided => "undecided",
        }
    }

    /// Whether it is unknown what becomes of the motion in the end.
    pub const fn is_undecided(self) -> bool {
        matches!(self, Fate::Irregular | Fate::ModelEnds | Fate::Undecided)
    }
}

/// How motions are classified.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ClassificationSettings {
    /// Time in s for which motions are followed. One that swings to and fro at its end, without having settled, is
    /// followed for up to ten times as long.
    pub duration: f64,
}

impl Default for ClassificationSettings {
    /// Thirty seconds.
    fn default() -> Self {
        Self { duration: SHORTEST_DURATION }
    }
}

impl ClassificationSettings {
    /// With a time in s for which motions are followed.
    pub fn with_duration(duration: f64) -> Self {
        Self { duration }
    }

    /// As long as slow motions of this wheel take to show where they go: twelve times the time in which a small
    /// disturbance of the uniform motion falls to a 1/e, but at least thirty seconds and at most three hundred. Where that is more than
    /// motions are followed even with ten times the patience, nothing but what comes near at once is seen to return, and thirty seconds
    /// tell as much.
    ///
    /// In rectilinear towing the disturbances are those of the lateral motion, which [`Fate::UniformMotion`] is about.
    ///
    /// # Errors
    /// No uniform motion.
    pub fn for_wheel(wheel: &Wheel) -> Result<Self, SimulationError> {
        let decay = -decisive_growth_rate(wheel)?;
        let needed = DECAY_TIMES / decay;
        let is_seen = decay > 0.0 && needed <= PATIENCE * LONGEST_DURATION;
        let duration = if is_seen { needed } else { SHORTEST_DURATION };
        Ok(Self { duration: duration.clamp(SHORTEST_DURATION, LONGEST_DURATION).round() })
    }

    pub(super) fn check(&self) -> Result<(), SimulationError> {
        if self.duration > 0.0 && self.duration.is_finite() {
            return Ok(());
        }
        Err(SimulationError::out_of_range("duration", self.duration, "positive and finite, in s"))
    }
}

/// The uniform motion that motions may return to, and the measure of the distance from it.
#[derive(Clone, Debug)]
pub(super) struct Target {
    state: [f64; 5],
    /// [All states](Wheel::states) of the uniform motion.
    states: Vec<f64>,
    /// Where a wheel with a tyre rests with dry friction about its king pin: the caster has to stick there.
    rests: Option<Rests>,
    /// That of a caster that sticks, in rad/s.
    towing_yaw_rate: f64,
    /// Turns differences of the states into speeds in m/s. In rectilinear towing `u` and `V` do not count: near straight
    /// running the longitudinal oscillation is decoupled, without a damper it rings for ever, and it is no shimmy. On a circle, neither
    /// do they nor `q` where dry friction about the king pin may hold the caster, behind which all of them ring.
    weights: [f64; 5],
    /// With dry friction the wheel rests with any lateral deflection up to this many m from that of the uniform motion.
    resting_deflection: f64,
    /// The larger of the towing speed and the caster length times the natural frequency of the springs, in m/s.
    reference_speed: f64,
    /// Natural frequency of the wheel on its springs in rad/s, and its period in s.
    frequency: f64,
    pub natural_period: f64,
    /// Whether motions return at all: near an unstable uniform motion they only linger. Nothing where that is not known.
    attracts: Option<bool>,
    /// Where dry friction alone makes small motions die out, the largest angle in rad at which the caster must come to stick: to be
    /// near means nothing then, since motions that are large beside the friction grow.
    sticks_up_to: Option<f64>,
}

/// Angular frequency in rad/s with which displacements of the king pin are counted, that of the lateral spring, and the slowest of wheel
/// and caster. On its tyre the caster turns about the king pin; where that is rigid sideways it is the only frequency.
fn frequencies(wheel: &Wheel) -> [f64; 2] {
    let get = |key: Key| wheel.get(key);
    let spring = (get(Key::KQ) * wheel.body().inverse_rolling_mass).sqrt();
    if wheel.tyre() == Tyre::Rigid {
        return [spring; 2];
    }
    let inertia = get(Key::JCz)
        + get(Key::JWzeta)
        + get(Key::MW) * get(Key::L).powi(2)
        + get(Key::MC) * get(Key::LC).powi(2);
    let stiffness = (get(Key::CAlpha) * (get(Key::L) + get(Key::TP))).abs() + get(Key::KPsi);
    let turning = (stiffness / inertia).sqrt();
    [if spring.is_finite() { spring } else { turning }, turning.min(spring)]
}

/// Growth rate of the disturbances on which the fate depends: in rectilinear towing those of the lateral motion.
fn decisive_growth_rate(wheel: &Wheel) -> Result<f64, SimulationError> {
    let mut wheel = *wheel;
    if wheel.get(Key::Curvature) == 0.0 {
        // The longitudinal motion is decoupled; without its damper the growth rate is that of the rest.
        wheel.set_value(Key::CU, 0.0)?;
    }
    Ok(wheel.uniform_motion()?.growth_rate())
}

/// Whether small motions that grow without dry friction about the king pin die out with it, and the largest angle from which they do
/// once the caster sticks.
fn returning_angle(wheel: &Wheel, model: ContactModel) -> (Option<bool>, Option<f64>) {
    // On a circle there is no closed form.
    let Some(factor) = wheel.swing_factor() else { return (None, None) };
    let ground = wheel.get(Key::MuS) * wheel.normal_force() * wheel.get(Key::L);
    if model == ContactModel::Sliding && wheel.get(Key::MF) > ground {
        // The wheel slides before the caster breaks away.
        return (Some(true), Some(f64::INFINITY));
    }
    // However slowly they grow at a larger factor: no simulation would tell.
    let angle = wheel.largest_returning_angle().map(|angle| LINEAR * angle);
    (Some(factor.abs() < 1.0), angle)
}

impl Target {
    pub(super) fn new(wheel: &Wheel, model: ContactModel) -> Result<Self, SimulationError> {
        let [frequency, slowest] = frequencies(wheel);
        let length = wheel.get(Key::L);
        let has_tyre = wheel.tyre() != Tyre::Rigid;
        let reference_speed = wheel.get(Key::V).max(frequency * length);
        let straight = wheel.get(Key::Curvature) == 0.0;
        let dry = wheel.get(Key::MF) > 0.0;
        let longitudinal = if straight || dry { 0.0 } else { 1.0 };
        let lateral = if dry && !straight && !has_tyre { 0.0 } else { 1.0 };
        let [low, high] = wheel.resting_deflections()?.unwrap_or_default();
        let is_stable = decisive_growth_rate(wheel)? <= NEUTRAL * frequency;
        let (attracts, sticks_up_to) = if dry && has_tyre {
            // The inside of the interval of rests is safe.
            (Some(true), None)
        } else if is_stable || !dry {
            (Some(is_stable), None)
        } else {
            returning_angle(wheel, model)
        };
        let motion = wheel.uniform_motion()?;
        Ok(Self {
            state: motion.state(),
            states: motion.states(),
            rests: wheel.rests()?,
            towing_yaw_rate: wheel.towing_yaw_rate(),
            attracts,
            sticks_up_to,
            weights: [longitudinal * frequency, lateral * frequency, reference_speed, longitudinal, length],
            resting_deflection: 0.5 * (high - low),
            reference_speed,
            frequency,
            natural_period: TAU / slowest,
        })
    }

    /// Whether motions return at all; nothing where that is not known.
    pub(super) fn attracts(&self) -> Option<bool> {
        self.attracts
    }

    /// The uniform motion.
    pub(super) fn state(&self) -> &[f64; 5] {
        &self.state
    }

    /// The uniform motion in [all states](Wheel::states).
    pub(super) fn states(&self) -> &[f64] {
        &self.states
    }

    /// Distance of two states in units of the reference speed, with every state counted; angles count modulo a turn.
    pub(super) fn separation(&self, one: &[f64; 5], other: &[f64; 5]) -> f64 {
        let difference = |i: usize| match i {
            2 => within_a_turn(one[i] - other[i]),
            _ => one[i] - other[i],
        };
        (0..5).map(|i| (self.scale(i) * difference(i)).powi(2)).sum::<f64>().sqrt()
    }

    /// What one unit of a state counts in such a distance.
    pub(super) fn scale(&self, state: usize) -> f64 {
        let speed = match state {
            0 | 1 => self.frequency,
            2 => self.reference_speed,
            3 => 1.0,
            _ => self.weights[4],
        };
        speed / self.reference_speed
    }

    /// For how long, in s, motions are followed at a time.
    pub(super) fn piece(&self) -> f64 {
        PERIODS_AT_A_TIME * self.natural_period
    }

    /// Distance of the nodes of a motion in s.
    pub(super) fn spacing(&self) -> f64 {
        self.natural_period / NODES_PER_PERIOD
    }

    /// Whether the caster sticks, `Omega = omega` to the last bit, at an angle up to a largest one.
    fn sticks(&self, state: &[f64; 5], largest: f64) -> bool {
        state[4] == self.towing_yaw_rate && within_a_turn(state[2] - self.state[2]).abs() <= largest
    }

    /// Whether to be near at a state means anything: motions may return, and the caster sticks where it has to for a rest.
    fn may_linger(&self, state: &[f64; 5]) -> bool {
        self.attracts != Some(false) && (self.rests.is_none() || state[4] == self.towing_yaw_rate)
    }

    /// Whether a state is near the uniform motion in a way that means anything.
    fn is_near(&self, state: &[f64; 5]) -> bool {
        self.distance(state) < NEAR && self.may_linger(state)
    }

    /// Distance from the uniform motion in units of the reference speed; the caster angle counts modulo a turn.
    fn distance(&self, state: &[f64; 5]) -> f64 {
        let mut sum = 0.0;
        let rest = self.rests.as_ref().map(|rests| {
            let centre = self.state[2];
            rests.nearest(centre + within_a_turn(state[2] - centre))
        });
        let nearest = rest.as_ref().unwrap_or(&self.state);
        for (i, (&weight, &target)) in self.weights.iter().zip(nearest).enumerate() {
            let difference = state[i] - target;
            let difference = match i {
                1 => difference - difference.clamp(-self.resting_deflection, self.resting_deflection),
                2 => within_a_turn(difference),
                _ => difference,
            };
            sum += (weight * difference).powi(2);
        }
        sum.sqrt() / self.reference_speed
    }
}

/// An angle less whole turns.
fn within_a_turn(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// Watches one motion and tells when it has returned, escaped, or turns right round at the end.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    target: Target,
    duration: f64,
    /// Since when the motion has been near the uniform motion.
    near_since: Option<f64>,
    decided: Option<Fate>,
    /// Which quarter of the duration it is, and the smallest and largest caster angle in it.
    quarter: f64,
    angles: [f64; 2],
    /// Whether the caster turned right round in the quarter before.
    turned: bool,
}

impl Watch {
    /// Watches a motion from its initial state.
    pub(super) fn new(target: &Target, settings: &ClassificationSettings, initial: &[f64; 5]) -> Self {
        // Steps can be longer than the time near the uniform motion that is asked for: the start counts.
        let is_near = target.is_near(initial);
        Self {
            target: target.clone(),
            duration: settings.duration,
            near_since: is_near.then_some(0.0),
            decided: None,
            quarter: 0.0,
            angles: [initial[2]; 2],
            turned: false,
        }
    }

    /// Takes a state `(u, q, psi, V, Omega)` into account; breaks once the fate is known.
    #[inline]
    pub(super) fn observe(&mut self, time: f64, state: &[f64; 5]) -> ControlFlow<()> {
        let distance = self.target.distance(state);
        if distance >= FAR || distance.is_nan() {
            return self.decide(Fate::Escape);
        }
        if distance < NEAR && self.target.may_linger(state) {
            let since = *self.near_since.get_or_insert(time);
            let lingers = time - since;
            let decided = match (self.target.attracts, self.target.sticks_up_to) {
                // Whether it leaves again no closed form tells.
                (None, _) => (lingers >= LINGERING * self.duration).then_some(Fate::Undecided),
                (_, None) => {
                    (lingers >= PERIODS_NEAR * self.target.natural_period).then_some(Fate::UniformMotion)
                }
                (_, Some(largest)) => self.target.sticks(state, largest).then_some(Fate::UniformMotion),
            };
            if let Some(fate) = decided {
                return self.decide(fate);
            }
        } else {
            self.near_since = None;
        }
        self.angles = [self.angles[0].min(state[2]), self.angles[1].max(state[2])];
        let quarter = (4.0 * time / self.duration * (1.0 + f64::EPSILON)).floor();
        if quarter > self.quarter {
            self.quarter = quarter;
            self.turned = self.is_turning();
            self.angles = [state[2]; 2];
            if quarter >= 4.0 && self.turned {
                return self.decide(Fate::Tumbling);
            }
        }
        ControlFlow::Continue(())
    }

    fn decide(&mut self, fate: Fate) -> ControlFlow<()> {
        self.decided = Some(fate);
        ControlFlow::Break(())
    }

    fn is_turning(&self) -> bool {
        self.angles[1] - self.angles[0] > TAU
    }

    /// The duration in s of the settings.
    pub(super) fn duration(&self) -> f64 {
        self.duration
    }

    /// The fate, where it is known.
    pub(super) fn fate(&self) -> Option<Fate> {
        self.decided
    }

    /// The fate of a motion that cannot be followed any further, since that takes too many steps: what it was doing.
    pub(super) fn fate_when_cut_short(&self) -> Fate {
        match self.decided {
            Some(fate) => fate,
            None if self.turned || self.is_turning() => Fate::Tumbling,
            None => Fate::Undecided,
        }
    }
}
