//! A motion at the times of a record, and its derivatives with respect to parameters and the state at the start.
//!
//! The derivatives are those of the variational equations, along which dual numbers carry the Jacobians. With dry friction about the
//! king pin the field changes where the caster stands still, `psi' = 0`. A neighbouring motion meets that event later by
//! `dt = -(h' dx)/(h' f)`, `h = psi'`, and with the field `f` before and `g` after it (Aizerman and Gantmacher 1958)
//!
//! ```text
//! dx_after = dx + (f - g) dt
//! ```
//!
//! Where the caster breaks away the two fields agree, and nothing jumps. In the limit of no friction the moment is the smallest number
//! whose square is not zero, so that the one-sided derivative with respect to `M_f` exists there.

use crate::body::Body;
use crate::parameters::Key;
use crate::rolling_model::RollingModel;
use crate::simulation::SimulationError;

use crate::sliding::model::{FrictionMoment, SlipState};
use crate::wheel::Wheel;
use arclength::control::Control;
use arclength::integration::{Integrator, System, autonomous};
use arclength::linear::lu;
use arclength::{Dual, Scalar, VectorField};

/// Directions in which one evaluation differentiates.
const CHUNK: usize = 8;
/// A number with its derivatives in a chunk of directions.
type Varied = Dual<f64, CHUNK>;

/// Relative tolerance of motions, and of the variational equations.
const TOLERANCE: f64 = 1e-11;
const VARIATIONAL_TOLERANCE: f64 = 1e-8;
/// Absolute tolerance of derivatives, in units of the scale of their direction.
const ABSOLUTE_TOLERANCE_OF_DERIVATIVES: f64 = 1e-8;
/// Stands for no friction about the king pin where that is estimated, in N m.
const VANISHING_FRICTION: f64 = 1e-100;
/// Index of the caster angle and of the yaw rate among the states of a wheel with dry friction.
const PSI: usize = 2;
const OMEGA: usize = 4;

/// A direction in which a motion is differentiated.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Direction {
    /// Index of the parameter that varies, with its scale; nothing where only the state at the start does.
    pub parameter: Option<(usize, f64)>,
    /// How the state at the start varies.
    pub start: Vec<f64>,
}

/// A wheel of which some parameters are estimated.
#[derive(Clone, Debug)]
pub(super) struct EstimatedWheel<'a> {
    pub wheel: Wheel,
    pub keys: &'a [Key],
}

impl EstimatedWheel<'_> {
    /// Whether dry friction acts about the king pin, or might.
    fn has_dry_friction(&self) -> bool {
        self.wheel.get(Key::MF) > 0.0 || self.keys.contains(&Key::MF)
    }

    /// The wheel as it is followed: with friction about the king pin where that is estimated.
    fn followed(&self) -> Result<Wheel, SimulationError> {
        let vanishes = self.has_dry_friction() && self.wheel.get(Key::MF) < VANISHING_FRICTION;
        Ok(if vanishes { self.wheel.with(Key::MF, VANISHING_FRICTION)? } else { self.wheel })
    }

    /// The free states at the times, the first of which is that of the start.
    ///
    /// # Errors
    /// A motion that cannot be followed; [`SimulationError::Interrupted`].
    pub(super) fn states(
        &self,
        start: &[f64],
        times: &[f64],
        control: &Control<'_>,
    ) -> Result<Vec<Vec<f64>>, SimulationError> {
        let times = from_zero(times);
        let mut states = Vec::with_capacity(times.len());
        if self.has_dry_friction() {
            self.follow(start, &times, control, &mut states)?;
        } else {
            let model = self.wheel.rolling_model(&[])?;
            let integrator = Integrator::with_tolerance(TOLERANCE);
            let solution = integrator.under(control).sample(autonomous(&model, &[]), start, &times)?;
            states.extend(solution.samples().map(|(_, state)| state.to_vec()));
        }
        Ok(states)
    }

    /// Follows a motion with dry friction through its swings and rests; `states` are those at the times.
    fn follow(
        &self,
        start: &[f64],
        times: &[f64],
        control: &Control<'_>,
        states: &mut Vec<Vec<f64>>,
    ) -> Result<Vec<Stretch>, SimulationError> {
        let rolling = self.followed()?.always_rolling()?.tolerance(TOLERANCE);
        let initial = rolling.rolling_state(&std::array::from_fn(|index| start[index]));
        let duration = times.last().copied().unwrap_or(0.0);
        let mut stretches = Vec::new();
        let mut present = initial.state;
        rolling.follow(initial, duration, times, &control.quiet(), |piece| {
            let state = |state: &[f64]| of_rolling(&std::array::from_fn(|index| state[index])).to_vec();
            states.extend(piece.solution.samples().map(|(_, sample)| state(sample)));
            stretches.push(Stretch {
                friction: piece.mode.friction_moment,
                start: piece.phase.start,
                end: piece.phase.end,
                initial: of_rolling(&present).to_vec(),
            });
            present = std::array::from_fn(|index| piece.solution.state[index]);
            true
        })?;
        Ok(stretches)
    }

    /// The derivatives of the free states at the times, in every direction: `[time][direction][state]`.
    ///
    /// # Errors
    /// A motion that cannot be followed; [`SimulationError::Interrupted`].
    pub(super) fn derivatives(
        &self,
        start: &[f64],
        directions: &[Direction],
        times: &[f64],
        control: &Control<'_>,
    ) -> Result<Vec<Vec<Vec<f64>>>, SimulationError> {
        let times = from_zero(times);
        let stretches = if self.has_dry_friction() {
            self.follow(start, &times, control, &mut Vec::new())?
        } else {
            let end = times.last().copied().unwrap_or(0.0);
            vec![Stretch { friction: FrictionMoment::Absent, start: 0.0, end, initial: start.to_vec() }]
        };
        let keys = self.smooth_keys();
        let model = self.wheel.rolling_model(&keys)?;
        let mut variations = Variations::new(self, &model, directions)?;
        let integrator = variations.integrator();
        let n = start.len();
        let mut columns: Vec<f64> =
            directions.iter().flat_map(|direction| &direction.start).copied().collect();
        let mut sampled = Vec::with_capacity(times.len());
        for (index, stretch) in stretches.iter().enumerate() {
            let is_last = index + 1 == stretches.len();
            variations.friction = stretch.friction;
            let mut extended = stretch.initial.clone();
            extended.extend_from_slice(&columns);
            let rest = &times[sampled.len()..];
            let inside = &rest[..rest.partition_point(|&time| is_last || time <= stretch.end)];
            if stretch.end > stretch.start {
                let solution = integrator.under(&control.quiet()).with_events(
                    &mut variations,
                    stretch.start,
                    &extended,
                    stretch.end,
                    inside,
                    &mut [],
                )?;
                sampled.extend(solution.samples().map(|(_, state)| in_columns(&state[n..], n)));
                extended = solution.state;
            } else {
                sampled.extend(inside.iter().map(|_| in_columns(&columns, n)));
            }
            if let Some(next) = stretches.get(index + 1) {
                variations.jump(&mut extended, next);
            }
            columns = extended.split_off(n);
        }
        Ok(sampled)
    }

    /// The estimated parameters without the friction about the king pin, which is none of the smooth field.
    fn smooth_keys(&self) -> Vec<Key> {
        self.keys.iter().copied().filter(|key| *key != Key::MF).collect()
    }

    /// The free states of the uniform motion with their derivatives with respect to every estimated parameter: those of its
    /// equations, `f(x, p) = 0`. A wheel that stands has no displacement and no speed.
    ///
    /// # Errors
    /// No uniform motion.
    pub(super) fn uniform(&self) -> Result<(Vec<f64>, Vec<Vec<f64>>), SimulationError> {
        let model = self.wheel.rolling_model(&self.smooth_keys())?;
        let n = model.dimension();
        if self.wheel.get(Key::V) == 0.0 {
            return Ok((vec![0.0; n], vec![vec![0.0; n]; self.keys.len()]));
        }
        let state = model.free_state(&self.wheel.uniform_motion()?.states());
        let of_states = (0..n).map(|index| {
            let mut start = vec![0.0; n];
            start[index] = 1.0;
            Direction { parameter: None, start }
        });
        let of_parameters = (0..self.keys.len())
            .map(|index| Direction { parameter: Some((index, 1.0)), start: vec![0.0; n] });
        let directions: Vec<Direction> = of_states.chain(of_parameters).collect();
        let mut variations = Variations::new(self, &model, &directions)?;
        let mut extended = state.clone();
        extended.extend(directions.iter().flat_map(|direction| &direction.start));
        let mut rate = vec![0.0; extended.len()];
        (&mut variations).evaluate(0.0, &extended, &mut rate);
        let mut jacobian = rate[n..n * (1 + n)].to_vec();
        let mut pivots = vec![0; n];
        let regular = lu::factorize(&mut jacobian, n, &mut pivots) != 0.0;
        let derivatives = rate[n * (1 + n)..].chunks_exact(n).map(|of_parameter| {
            let mut change: Vec<f64> = of_parameter.iter().map(|entry| -entry).collect();
            if regular {
                lu::solve(&jacobian, n, &pivots, &mut change);
            }
            change
        });
        Ok((state, derivatives.collect()))
    }
}

fn from_zero(times: &[f64]) -> Vec<f64> {
    times.iter().map(|time| time - times[0]).collect()
}

fn in_columns(columns: &[f64], dimension: usize) -> Vec<Vec<f64>> {
    columns.chunks_exact(dimension).map(<[f64]>::to_vec).collect()
}

/// The five states of a wheel that rolls.
fn of_rolling(&[u, q, psi, speed, _, yaw, _]: &SlipState) -> [f64; 5] {
    [u, q, psi, speed, yaw]
}

/// A stretch of a motion along which it is smooth.
#[derive(Clone, Debug)]
struct Stretch {
    friction: FrictionMoment<f64>,
    start: f64,
    end: f64,
    initial: Vec<f64>,
}

/// The equations of motion with their variational equations: the states, then a column for every direction.
struct Variations<'a> {
    model: &'a RollingModel,
    /// The parameters of the field with their derivatives, for every chunk of directions.
    parameters: Vec<Vec<Varied>>,
    /// The yaw acceleration that `M_f` gives, for every chunk.
    friction_acceleration: Vec<Varied>,
    /// The moment of dry friction that acts.
    friction: FrictionMoment<f64>,
    directions: usize,
    state: Vec<Varied>,
    rate: Vec<Varied>,
}

impl<'a> Variations<'a> {
    fn new(
        estimated: &EstimatedWheel<'_>,
        model: &'a RollingModel,
        directions: &[Direction],
    ) -> Result<Self, SimulationError> {
        let n = model.dimension();
        let chunks = directions.chunks(CHUNK);
        // A parameter of the wheel with its derivatives in the directions of a chunk.
        let varied = |key: Key, value: f64, chunk: &[Direction]| {
            let mut varied = Varied::constant(value);
            for (derivative, direction) in varied.derivatives.iter_mut().zip(chunk) {
                if let Some((index, scale)) = direction.parameter {
                    *derivative = if estimated.keys[index] == key { scale } else { 0.0 };
                }
            }
            varied
        };
        let keys = estimated.smooth_keys();
        let parameters: Vec<Vec<Varied>> = chunks
            .clone()
            .map(|chunk| keys.iter().map(|&key| varied(key, estimated.wheel.get(key), chunk)).collect())
            .collect();
        let friction = estimated.followed()?.get(Key::MF);
        let friction_acceleration = chunks.zip(&parameters).map(|(chunk, parameters)| {
            let body: Option<Body<Varied>> = match model {
                RollingModel::Elastic(rolling) => Some(rolling.body(parameters)),
                RollingModel::Lateral(_) | RollingModel::Tyre(_) => None,
            };
            body.map_or(Varied::zero(), |body| varied(Key::MF, friction, chunk) * body.inverse_yaw_inertia)
        });
        Ok(Self {
            model,
            friction_acceleration: friction_acceleration.collect(),
            parameters,
            friction: FrictionMoment::Absent,
            directions: directions.len(),
            state: vec![Varied::zero(); n],
            rate: vec![Varied::zero(); n],
        })
    }

    fn integrator(&self) -> Integrator {
        let n = self.state.len();
        let mut absolute = vec![ABSOLUTE_TOLERANCE_OF_DERIVATIVES; n * (1 + self.directions)];
        absolute[..n].fill(0.01 * VARIATIONAL_TOLERANCE);
        Integrator::default().relative_tolerance(VARIATIONAL_TOLERANCE).absolute_tolerances(&absolute)
    }

    /// Evaluates the field for a chunk of the directions.
    fn evaluate_chunk(&mut self, chunk: usize, extended: &[f64]) {
        let n = self.state.len();
        let columns = extended[n..].chunks_exact(n).skip(chunk * CHUNK).take(CHUNK);
        for (index, state) in self.state.iter_mut().enumerate() {
            *state = Varied::constant(extended[index]);
        }
        for (direction, column) in columns.enumerate() {
            for (state, derivative) in self.state.iter_mut().zip(column) {
                state.derivatives[direction] = *derivative;
            }
        }
        self.model.evaluate(&self.state, &self.parameters[chunk], &mut self.rate);
        match self.friction {
            FrictionMoment::Absent => {}
            FrictionMoment::Swinging(moment) => {
                self.rate[OMEGA] += self.friction_acceleration[chunk] * moment.signum();
            }
            FrictionMoment::Sticking => self.rate[OMEGA] = Varied::zero(),
        }
    }

    /// Turns the columns at the end of a stretch into those at the start of the next.
    fn jump(&mut self, extended: &mut [f64], next: &Stretch) {
        if !matches!(self.friction, FrictionMoment::Swinging(_)) {
            return;
        }
        let n = self.state.len();
        let mut delays = Vec::with_capacity(self.directions);
        let mut before = Vec::new();
        for chunk in 0..self.parameters.len() {
            self.evaluate_chunk(chunk, extended);
            let deceleration = self.rate[OMEGA].value;
            delays.extend(self.rate[PSI].derivatives.map(|change| change / deceleration));
            before = self.rate.iter().map(|rate| rate.value).collect();
        }
        if before[OMEGA] == 0.0 {
            return;
        }
        self.friction = next.friction;
        let mut from = next.initial.clone();
        from.resize(extended.len(), 0.0);
        self.evaluate_chunk(0, &from);
        for (column, delay) in extended[n..].chunks_exact_mut(n).zip(delays) {
            for ((derivative, before), after) in column.iter_mut().zip(&before).zip(&self.rate) {
                *derivative += (before - after.value) * delay;
            }
        }
    }
}

impl System for &mut Variations<'_> {
    fn dimension(&self) -> usize {
        self.state.len() * (1 + self.directions)
    }

    fn has_own_clock(&self) -> bool {
        true
    }

    fn evaluate(&mut self, _time: f64, extended: &[f64], derivative: &mut [f64]) {
        let n = self.state.len();
        for chunk in 0..self.parameters.len() {
            self.evaluate_chunk(chunk, extended);
            for (index, rate) in self.rate.iter().enumerate() {
                derivative[index] = rate.value;
            }
            let columns = derivative[n..].chunks_exact_mut(n).skip(chunk * CHUNK).take(CHUNK);
            for (direction, column) in columns.enumerate() {
                for (derivative, rate) in column.iter_mut().zip(&self.rate) {
                    *derivative = rate.derivatives[direction];
                }
            }
        }
    }
}
