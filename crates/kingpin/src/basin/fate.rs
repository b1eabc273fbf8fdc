//! What becomes of a motion.

use crate::parameters::Key;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// A motion has returned when it stays this near the uniform motion, relative to the reference speed, ...
const NEAR: f64 = 0.02;
/// ... for this many natural periods of the springs.
const PERIODS_NEAR: f64 = 3.0;
/// A motion has escaped when it is this many reference speeds away from the uniform motion.
const FAR: f64 = 50.0;
/// The amplitude of a motion that lasts changes by less than this part between the third and the last quarter.
const STEADY: f64 = 0.1;
/// Bounds in s of the duration that is chosen for a wheel, and the number of decay times in it.
const SHORTEST_DURATION: f64 = 30.0;
const LONGEST_DURATION: f64 = 300.0;
const DECAY_TIMES: f64 = 12.0;
/// Eigenvalues with a real part below this, relative to the natural frequency, count as neutral.
const NEUTRAL: f64 = 1e-9;

/// What becomes of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Fate {
    /// It returns to the uniform motion.
    UniformMotion,
    /// It lasts to the end with a steady amplitude, the caster swinging to and fro.
    Shimmy,
    /// It lasts to the end, the caster turning right round.
    Tumbling,
    /// It grows beyond fifty times the reference speed.
    Escape,
    /// It did none of these in the time it was followed.
    Undecided,
}

impl Fate {
    /// All fates.
    pub const ALL: [Fate; 5] =
        [Fate::UniformMotion, Fate::Shimmy, Fate::Tumbling, Fate::Escape, Fate::Undecided];

    /// Name as it is written in results.
    pub const fn name(self) -> &'static str {
        match self {
            Fate::UniformMotion => "uniform motion",
            Fate::Shimmy => "shimmy",
            Fate::Tumbling => "tumbling",
            Fate::Escape => "escape",
            Fate::Undecided => "undecided",
        }
    }
}

/// How motions are classified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassificationSettings {
    /// Time in s for which a motion is followed at most.
    pub duration: f64,
}

impl Default for ClassificationSettings {
    /// Thirty seconds.
    fn default() -> Self {
        Self { duration: SHORTEST_DURATION }
    }
}

impl ClassificationSettings {
    /// As long as slow motions of this wheel take to show where they go: twelve times the time in which a small
    /// disturbance of the uniform motion falls to a 1/e, but at least thirty seconds and at most three hundred.
    ///
    /// Nearly neutral motions would otherwise pass for lasting ones: an unstable cycle near its Hopf point repels twice as
    /// fast as the uniform motion attracts.
    ///
    /// # Errors
    /// No uniform motion.
    pub fn for_wheel(wheel: &Wheel) -> Result<Self, SimulationError> {
        let decay = -wheel.uniform_motion()?.growth_rate();
        let duration = if decay > 0.0 { DECAY_TIMES / decay } else { SHORTEST_DURATION };
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
    /// Turns differences of the states into speeds in m/s.
    weights: [f64; 5],
    /// The larger of the towing speed and the caster length times the natural frequency of the springs, in m/s.
    reference_speed: f64,
    /// Natural period of the wheel on its springs in s.
    pub natural_period: f64,
    /// Whether motions return at all: near an unstable uniform motion they only linger.
    attracts: bool,
}

impl Target {
    pub fn new(wheel: &Wheel) -> Result<Self, SimulationError> {
        let body = wheel.body();
        let frequency = (wheel.get(Key::KQ) * body.inverse_rolling_mass).sqrt();
        let length = body.caster_length;
        let reference_speed = wheel.get(Key::V).max(frequency * length);
        let motion = wheel.uniform_motion()?;
        Ok(Self {
            state: motion.state(),
            attracts: motion.growth_rate() <= NEUTRAL * frequency,
            weights: [frequency, frequency, reference_speed, 1.0, length],
            reference_speed,
            natural_period: TAU / frequency,
        })
    }

    /// Distance from the uniform motion in units of the reference speed; the caster angle counts modulo a turn.
    fn distance(&self, state: &[f64; 5]) -> f64 {
        let mut sum = 0.0;
        for (i, (&weight, &target)) in self.weights.iter().zip(&self.state).enumerate() {
            let difference = state[i] - target;
            let difference = if i == 2 { difference - TAU * (difference / TAU).round() } else { difference };
            sum += (weight * difference).powi(2);
        }
        sum.sqrt() / self.reference_speed
    }
}

/// Watches one motion and decides.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    target: Target,
    duration: f64,
    /// Since when the motion has been near the uniform motion.
    near_since: Option<f64>,
    decided: Option<Fate>,
    /// Largest distance in the third and the last quarter of the duration.
    amplitudes: [f64; 2],
    /// Smallest and largest caster angle in the last quarter.
    angles: [f64; 2],
    ended: bool,
}

impl Watch {
    /// Watches a motion from its initial state.
    pub fn new(target: &Target, settings: &ClassificationSettings, initial: &[f64; 5]) -> Self {
        // Steps can be longer than the time near the uniform motion that is asked for: the start counts.
        let is_near = target.attracts && target.distance(initial) < NEAR;
        Self {
            target: target.clone(),
            duration: settings.duration,
            near_since: is_near.then_some(0.0),
            decided: None,
            amplitudes: [0.0; 2],
            angles: [f64::INFINITY, f64::NEG_INFINITY],
            ended: false,
        }
    }

    /// Takes a state `(u, q, psi, V, Omega)` into account; breaks once the fate is known.
    #[inline]
    pub fn observe(&mut self, time: f64, state: &[f64; 5]) -> ControlFlow<()> {
        let distance = self.target.distance(state);
        if distance >= FAR || distance.is_nan() {
            self.decided = Some(Fate::Escape);
            return ControlFlow::Break(());
        }
        if distance < NEAR && self.target.attracts {
            let since = *self.near_since.get_or_insert(time);
            if time - since >= PERIODS_NEAR * self.target.natural_period {
                self.decided = Some(Fate::UniformMotion);
                return ControlFlow::Break(());
            }
        } else {
            self.near_since = None;
        }
        if time > 0.5 * self.duration {
            let is_last_quarter = time > 0.75 * self.duration;
            let amplitude = &mut self.amplitudes[usize::from(is_last_quarter)];
            *amplitude = amplitude.max(distance);
            if is_last_quarter {
                self.angles = [self.angles[0].min(state[2]), self.angles[1].max(state[2])];
            }
        }
        self.ended = time >= self.duration * (1.0 - 1e-9);
        ControlFlow::Continue(())
    }

    /// The fate of the motion.
    pub fn fate(&self) -> Fate {
        if let Some(fate) = self.decided {
            return fate;
        }
        let [third, last] = self.amplitudes;
        if !self.ended {
            Fate::Undecided
        } else if self.angles[1] - self.angles[0] > TAU {
            Fate::Tumbling
        } else if (last - third).abs() < STEADY * third {
            Fate::Shimmy
        } else {
            Fate::Undecided
        }
    }
}
