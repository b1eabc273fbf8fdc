//! Wheels whose contact with the ground is of one kind all the time, with a tyre or, with `k_u = inf`, rolling, and whose caster swings
//! or, where dry friction acts about the king pin, swings and sticks by turns.
//!
//! The moment of dry friction enters the equations linearly. While the caster swings it is `M_f sign(psi')`; while it sticks it is what
//! keeps the yaw rate at that of the towing frame, as long as that is at most `M_f`. Where one ends is located as an event. The
//! equations hold up to a border: with a tyre the wheel has to roll forwards, `V1 > 0`; with `k_u = inf` the caster must not lie
//! across, `psi = +-pi/2`, where the speed does not follow. A motion ends there, and what becomes of it is undecided.

use crate::contact::ContactForce;
use crate::error::KingpinError;
use crate::lateral::LateralWheel;
use crate::motion_integrator::motion_integrator;
use crate::parameters::{Key, Tyre};
use crate::simulation::SimulationError;
use crate::sliding::model::FrictionMoment;
use crate::sliding::{Contact, KingPin, Phase, RESTING_ANGLE, RESTING_EXCESS};
use crate::tyre::TyreWheel;
use crate::wheel::Wheel;
use arclength::control::Control;
use arclength::integration::{Event, Integrator, Solution, from_rates};
use std::f64::consts::TAU;

/// Most free states.
pub(crate) const MOST_STATES: usize = 7;
/// The forward speed, as a part of the towing speed, that counts as none: at zero the moment of the tread width is infinite.
const STANDSTILL: f64 = 1e-9;
/// With `k_u = inf` the caster lies across where the cosine of its angle falls to this.
pub(crate) const LYING_ACROSS: f64 = 0.01;
/// Largest number of swings and rests of a motion.
const MAXIMUM_PHASES: usize = 100_000;

/// Events: the border of the equations, the force on the wheel, what ends about the king pin.
const BORDER: usize = 0;
const SLIP: usize = 1;
const KING_PIN: usize = 2;

/// Free states, filled up with zeros.
pub(crate) type FreeState = [f64; MOST_STATES];

#[derive(Clone, Debug)]
enum Model {
    Tyre(TyreWheel),
    Lateral(LateralWheel),
}

/// A wheel with a tyre, or with lateral elasticity only.
#[derive(Clone, Debug)]
pub(crate) struct SwingingWheel {
    model: Model,
    /// `M_f` in N m.
    largest_friction_moment: f64,
    towing_yaw_rate: f64,
    towing_speed: f64,
    /// Whether small motions of the wheel that rolls die out with dry friction, so that what is left of a small angle is no motion.
    comes_to_rest: bool,
    /// Whether a motion ends at the border of the equations.
    ends_at_border: bool,
    /// Whether it is noticed where the force on the wheel exceeds the static friction.
    reports_slip: bool,
    integrator: Integrator,
}

/// A stretch of a motion along which the caster only swings or only sticks.
pub(crate) struct Stretch<'a> {
    pub phase: Phase,
    /// The moment of dry friction that acts.
    pub friction_moment: FrictionMoment<f64>,
    /// State where it begins.
    pub initial: &'a FreeState,
    /// Its solution in the free states.
    pub solution: &'a Solution,
}

impl Stretch<'_> {
    /// Time in s at which the force on the wheel comes to exceed the static friction, where that is [reported](SwingingWheel::reporting_slip).
    pub(crate) fn slips_at(&self) -> Option<f64> {
        let crossings = self.solution.crossings.iter();
        crossings.filter(|crossing| crossing.event == SLIP).map(|crossing| crossing.time).next()
    }
}

/// Where a motion has got.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reached {
    pub state: FreeState,
    /// When it came to the border of the equations, if it did.
    pub border: Option<f64>,
}

impl Wheel {
    /// A wheel with a tyre, or with lateral elasticity only, whose motions are followed with a tolerance.
    ///
    /// # Errors
    /// Those of [`with_tyre`](Self::with_tyre) and [`lateral`](Self::lateral).
    pub(crate) fn swinging(&self, tolerance: f64) -> Result<SwingingWheel, KingpinError> {
        let model = match self.tyre() {
            Tyre::Rigid => Model::Lateral(self.lateral(&[])?),
            _ => Model::Tyre(self.with_tyre(&[])?),
        };
        Ok(SwingingWheel {
            model,
            largest_friction_moment: self.get(Key::MF),
            towing_yaw_rate: self.towing_yaw_rate(),
            towing_speed: self.get(Key::V),
            comes_to_rest: self.swing_factor().is_some_and(|factor| factor.abs() < 1.0),
            ends_at_border: true,
            reports_slip: false,
            integrator: motion_integrator(tolerance),
        })
    }
}

impl SwingingWheel {
    /// The same, whose motions go on beyond the border of the equations, as far as the integration goes.
    pub(crate) fn beyond_the_border(mut self) -> Self {
        self.ends_at_border = false;
        self
    }

    /// The same, of whose motions it is noticed where the force on the wheel exceeds the static friction.
    pub(crate) fn reporting_slip(&self) -> Self {
        Self { reports_slip: true, ..self.clone() }
    }

    /// Whether dry friction acts about the king pin.
    pub(crate) fn has_dry_friction(&self) -> bool {
        self.largest_friction_moment > 0.0
    }

    /// Work in J that dry friction about the king pin takes along a stretch, in which the caster angle grows or falls all the way.
    pub(crate) fn dry_friction_work(&self, stretch: &Stretch<'_>) -> f64 {
        match stretch.friction_moment {
            FrictionMoment::Swinging(moment) => {
                let angle = |free: &[f64]| self.full_state(free)[2];
                moment * (angle(&stretch.solution.state) - angle(stretch.initial))
            }
            FrictionMoment::Absent | FrictionMoment::Sticking => 0.0,
        }
    }

    /// Indices of the free states among [all states](Wheel::states).
    pub(crate) fn free(&self) -> &'static [usize] {
        match &self.model {
            Model::Tyre(wheel) => wheel.free(),
            Model::Lateral(_) => &[1, 2, 4],
        }
    }

    /// Position of one of [all states](Wheel::states) among the free ones.
    pub(crate) fn position(&self, state: usize) -> Option<usize> {
        self.free().iter().position(|&free| free == state)
    }

    /// The same for one of `(u, q, psi, V, Omega)`.
    pub(crate) fn place_of(&self, reduced: usize) -> Option<usize> {
        let [_, _, yaw] = self.places();
        self.position(if reduced == 4 { yaw } else { reduced })
    }

    /// Indices of `psi`, forward speed and `Omega` among [all states](Wheel::states).
    const fn places(&self) -> [usize; 3] {
        match self.model {
            Model::Tyre(_) => [2, 3, 5],
            Model::Lateral(_) => [2, 3, 4],
        }
    }

    /// The free ones of [all states](Wheel::states).
    pub(crate) fn free_state(&self, full: &[f64]) -> FreeState {
        let mut free = [0.0; MOST_STATES];
        for (value, &index) in free.iter_mut().zip(self.free()) {
            *value = full[index];
        }
        free
    }

    /// [All states](Wheel::states), without a tyre followed by zeros.
    pub(crate) fn full_state(&self, free: &[f64]) -> [f64; 7] {
        match &self.model {
            Model::Tyre(wheel) => wheel.full_state(free, &[]),
            Model::Lateral(wheel) => {
                [0.0, free[0], free[1], wheel.forward_speed_at(free, &[]), free[2], 0.0, 0.0]
            }
        }
    }

    /// `(u, q, psi, V, Omega)`; with a tyre `V` is `V1`.
    pub(crate) fn reduced(&self, free: &[f64]) -> [f64; 5] {
        let full = self.full_state(free);
        let [psi, forward, yaw] = self.places().map(|place| full[place]);
        [full[0], full[1], psi, forward, yaw]
    }

    /// Rates of the free states under a moment about the king pin.
    fn rates_under(&self, moment: f64, free: &[f64], rates: &mut [f64]) {
        match &self.model {
            Model::Lateral(wheel) => {
                wheel.forward_motion(free, &[], moment, rates);
            }
            Model::Tyre(wheel) => {
                let (all, _) = wheel.rates_and_lateral_force(free, &[], moment);
                rates.iter_mut().zip(wheel.free()).for_each(|(rate, &index)| *rate = all[index]);
            }
        }
    }

    fn yaw_position(&self) -> usize {
        // Behind it there is the deflection of a tyre.
        self.free().len() - 1 - usize::from(matches!(self.model, Model::Tyre(_)))
    }

    /// The moment about the king pin in N m that keeps the yaw rate as it is.
    pub(crate) fn holding_moment(&self, free: &[f64]) -> f64 {
        let yaw = self.yaw_position();
        let [without, with_one] = [0.0, 1.0].map(|moment| {
            let mut rates = [0.0; MOST_STATES];
            self.rates_under(moment, free, &mut rates[..self.free().len()]);
            rates[yaw]
        });
        -without / (with_one - without)
    }

    /// Rates of the free states.
    pub(crate) fn rates(&self, friction_moment: FrictionMoment<f64>, free: &[f64], rates: &mut [f64]) {
        self.rates_under(self.moment(friction_moment, free), free, rates);
        if friction_moment == FrictionMoment::Sticking {
            rates[self.yaw_position()] = 0.0;
        }
    }

    /// The moment of dry friction about the king pin that acts, in N m.
    pub(crate) fn moment(&self, friction_moment: FrictionMoment<f64>, free: &[f64]) -> f64 {
        match friction_moment {
            FrictionMoment::Absent => 0.0,
            FrictionMoment::Swinging(moment) => moment,
            FrictionMoment::Sticking => self.holding_moment(free),
        }
    }

    /// The caster angle with its first two derivatives.
    pub(crate) fn angle(&self, friction_moment: FrictionMoment<f64>, free: &[f64]) -> [f64; 3] {
        let mut rates = [0.0; MOST_STATES];
        self.rates(friction_moment, free, &mut rates[..self.free().len()]);
        let yaw = self.yaw_position();
        let psi = self.full_state(free)[2];
        [psi, self.swing_rate(free), -rates[yaw]]
    }

    fn swing_rate(&self, free: &[f64]) -> f64 {
        self.towing_yaw_rate - free[self.yaw_position()]
    }

    /// Whether the equations hold at a state.
    pub(crate) fn is_inside(&self, free: &FreeState) -> bool {
        self.distance_from_border(free) > 0.0
    }

    /// What happens at the border of the equations.
    pub(crate) const fn at_the_border(&self) -> &'static str {
        match self.model {
            Model::Tyre(_) => "the wheel stops rolling forwards, V1 = 0",
            Model::Lateral(_) => "with k_u = inf the caster lies across, psi = +-pi/2",
        }
    }

    /// How far a state is from the border of the equations: positive inside.
    fn distance_from_border(&self, free: &[f64]) -> f64 {
        match &self.model {
            Model::Tyre(_) => self.full_state(free)[3] - STANDSTILL * self.towing_speed,
            Model::Lateral(_) => free[1].cos().abs() - LYING_ACROSS,
        }
    }

    /// The force of the ground on the wheel under a moment of dry friction.
    pub(crate) fn contact_force(&self, moment: f64, free: &[f64]) -> ContactForce {
        match &self.model {
            Model::Tyre(wheel) => {
                wheel.wheel().tyre_contact_force_under(moment, &wheel.full_state(free, &[]))
            }
            Model::Lateral(wheel) => {
                wheel.wheel().lateral_contact_force_under(moment, &[free[0], free[1], free[2]])
            }
        }
    }

    /// What the friction about the king pin does where a motion goes on from a state.
    fn friction_moment(&self, free: &FreeState) -> FrictionMoment<f64> {
        let limit = self.largest_friction_moment;
        if limit == 0.0 {
            return FrictionMoment::Absent;
        }
        let rate = self.swing_rate(free);
        if rate != 0.0 {
            return FrictionMoment::Swinging(limit.copysign(rate));
        }
        let needed = self.holding_moment(&free[..self.free().len()]);
        let rests = self.comes_to_rest && self.off_path(free).abs() < RESTING_ANGLE;
        if needed.abs() <= if rests { limit * (1.0 + RESTING_EXCESS) } else { limit } {
            return FrictionMoment::Sticking;
        }
        // Friction opposes the swing that takes more than it can give.
        FrictionMoment::Swinging(limit.copysign(needed))
    }

    /// Caster angle of the wheel with lateral elasticity only, less whole turns.
    fn off_path(&self, free: &FreeState) -> f64 {
        free[1] - TAU * (free[1] / TAU).round()
    }

    /// Follows the motion from its free states for `duration`, calling `visit` with each stretch of it. `times` are sampled.
    ///
    /// # Errors
    /// A motion that cannot be followed; [`SimulationError::Interrupted`].
    pub(crate) fn follow(
        &self,
        initial: &FreeState,
        duration: f64,
        times: &[f64],
        control: &Control<'_>,
        mut visit: impl FnMut(Stretch<'_>),
    ) -> Result<Reached, SimulationError> {
        let (mut now, mut present, mut sampled) = (0.0, *initial, 0);
        for _ in 0..MAXIMUM_PHASES {
            if self.ends_at_border && !self.is_inside(&present) {
                return Ok(Reached { state: present, border: Some(now) });
            }
            let rest = control.part(now / duration..1.0);
            let piece = |friction_moment| {
                self.piece(friction_moment, (now, &present), duration, &times[sampled..], &rest)
            };
            let mut friction_moment = self.friction_moment(&present);
            let (mut solution, mut next) = piece(friction_moment)?;
            if let FrictionMoment::Swinging(moment) = friction_moment
                && self.swing_rate(&present) == 0.0
                && self.swing_rate(&next) * moment < 0.0
            {
                // The limit was only touched, to rounding: no swing begins.
                friction_moment = FrictionMoment::Sticking;
                (solution, next) = piece(friction_moment)?;
            }
            sampled += solution.times.len();
            let king_pin = match friction_moment {
                FrictionMoment::Sticking => KingPin::Sticking,
                _ => KingPin::Swinging,
            };
            let phase = Phase { contact: Contact::Rolling, king_pin, start: now, end: solution.time };
            visit(Stretch { phase, friction_moment, initial: &present, solution: &solution });
            now = solution.time;
            present = next;
            control.done(now / duration);
            if self.ends_at_border && solution.ended_by == Some(BORDER) {
                return Ok(Reached { state: present, border: Some(now) });
            }
            if now >= duration {
                return Ok(Reached { state: present, border: None });
            }
        }
        Err(SimulationError::out_of_range("number of phases", MAXIMUM_PHASES as f64, "fewer phases"))
    }

    /// A stretch under one friction moment, and the state from which the motion goes on after it.
    fn piece(
        &self,
        friction_moment: FrictionMoment<f64>,
        (start, initial): (f64, &FreeState),
        end: f64,
        times: &[f64],
        control: &Control<'_>,
    ) -> Result<(Solution, FreeState), SimulationError> {
        let count = self.free().len();
        let yaw = self.yaw_position();
        let border = Event::new(|_, state| self.distance_from_border(state)).falling();
        let reserve = |state: &[f64]| match self.reports_slip {
            true => self.contact_force(self.moment(friction_moment, state), state).static_reserve(),
            false => 1.0,
        };
        let border = if self.ends_at_border { border.terminal() } else { border };
        let mut events = vec![border, Event::new(|_, state| reserve(state)).falling()];
        events.extend(self.end_about_king_pin(friction_moment));
        let system = from_rates(count, |state: &[f64], rates: &mut [f64]| {
            self.rates(friction_moment, state, rates);
        });
        let solution = self.integrator.under(control).with_events(
            system,
            start,
            &initial[..count],
            end,
            times,
            &mut events,
        )?;
        let mut next = [0.0; MOST_STATES];
        next[..count].copy_from_slice(&solution.state);
        let swing_ends = solution.ended_by == Some(KING_PIN);
        if friction_moment == FrictionMoment::Sticking || swing_ends {
            next[yaw] = self.towing_yaw_rate;
        }
        if swing_ends && friction_moment != FrictionMoment::Sticking && self.comes_to_rest {
            let angle = self.off_path(&next);
            if angle.abs() < RESTING_ANGLE {
                next[1] -= angle;
            }
        }
        Ok((solution, next))
    }

    /// Where what the caster does about the king pin ends: a swing where it stands still, a rest where the moment exceeds `M_f`.
    fn end_about_king_pin(&self, friction_moment: FrictionMoment<f64>) -> Option<Event<'_>> {
        let end = match friction_moment {
            FrictionMoment::Absent => return None,
            FrictionMoment::Swinging(moment) => {
                Event::new(move |_, state| moment.signum() * self.swing_rate(state))
            }
            FrictionMoment::Sticking => Event::new(move |_, state| {
                self.largest_friction_moment.powi(2) - self.holding_moment(state).powi(2)
            }),
        };
        Some(end.falling().terminal())
    }
}
