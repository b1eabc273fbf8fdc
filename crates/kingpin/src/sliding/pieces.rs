//! A motion followed piece by piece, each with its own equations, the ends of which are located as events.

use super::model::{Equations, FrictionMoment, S1, S2, SlipState, slip_squared, slips};
use super::regime::{Mode, Regime};
use super::{Contact, HybridState, Phase, SlidingWheel, as_slip_state};
use crate::simulation::SimulationError;
use arclength::VectorField;
use arclength::control::Control;
use arclength::integration::{Crossing, Direction, Event, EventLocator, Solution, Stepper, from_rates};

/// A piece of a motion, along which one mode holds.
#[derive(Debug)]
pub(crate) struct Piece<'a> {
    /// When, and what wheel and caster do.
    pub phase: Phase,
    /// Which equations hold.
    pub mode: Mode,
    /// Whether it resumes the phase of the piece before.
    pub resumes: bool,
    /// Its solution, whose states are [`SlipState`]s.
    pub solution: &'a Solution,
}

impl Piece<'_> {
    /// Work in J that dry friction about the king pin takes along it, from a caster angle on, which grows or falls all the way.
    pub(crate) fn dry_friction_work(&self, psi: f64) -> f64 {
        match self.mode.friction_moment {
            FrictionMoment::Swinging(moment) => moment * (self.solution.state[2] - psi),
            FrictionMoment::Absent | FrictionMoment::Sticking => 0.0,
        }
    }
}

/// Where a piece begins and how far it may go.
struct Stretch<'a> {
    start: f64,
    state: &'a SlipState,
    end: f64,
    /// Times that are sampled, from the start on.
    times: &'a [f64],
    control: &'a Control<'a>,
}

impl SlidingWheel {
    /// Follows the motion for `duration`, calling `visit` with each piece of it. `times` are sampled. Ends early when
    /// `visit` returns false.
    pub(crate) fn follow(
        &self,
        initial: HybridState,
        duration: f64,
        times: &[f64],
        control: &Control<'_>,
        mut visit: impl FnMut(Piece<'_>) -> bool,
    ) -> Result<HybridState, SimulationError> {
        let mut now = 0.0;
        let mut present = initial;
        let mut sampled = 0;
        let mut before = None;
        if self.equations.static_limit == 0.0 && !self.rolls_always {
            present.contact = Contact::Sliding;
        }
        for _ in 0..self.maximum_phases {
            let rest = control.part(now / duration..1.0);
            let stretch = Stretch {
                start: now,
                state: &present.state,
                end: duration,
                times: &times[sampled..],
                control: &rest,
            };
            let mut mode = self.mode(&present);
            let (mut solution, mut next) = self.piece(mode, &stretch)?;
            if self.turned_back(mode, &present.state, &next.state) {
                // The limit was only touched, to rounding: no swing begins.
                mode = mode.sticking();
                (solution, next) = self.piece(mode, &stretch)?;
            }
            sampled += solution.times.len();
            let resumes = present.contact == Contact::Sliding
                && before.is_some_and(|before| before == mode.friction_moment);
            let phase = Phase {
                contact: mode.regime.contact(),
                king_pin: mode.king_pin(),
                start: now,
                end: solution.time,
            };
            let keep_on = visit(Piece { phase, mode, resumes, solution: &solution });
            now = solution.time;
            control.done(now / duration);
            present = next;
            before = Some(mode.friction_moment);
            if now >= duration || !keep_on {
                return Ok(present);
            }
        }
        Err(SimulationError::out_of_range("number of phases", self.maximum_phases as f64, "fewer phases"))
    }

    /// The next piece, and the state from which the motion goes on after it.
    fn piece(&self, mode: Mode, stretch: &Stretch<'_>) -> Result<(Solution, HybridState), SimulationError> {
        let equations = self.equations_in(mode);
        let (solution, mut next) = match mode.regime {
            Regime::Rolling => self.roll(&equations, mode, stretch),
            Regime::Onset => self.start_slip(&equations, mode, stretch),
            Regime::Sliding => self.slide(&equations, mode, stretch),
        }?;
        let stops = solution.ended_by == Some(mode.regime.contact_events());
        if mode.friction_moment == FrictionMoment::Sticking || stops {
            next.state[5] = equations.towing_yaw_rate();
        }
        if stops && mode.friction_moment != FrictionMoment::Sticking {
            next = self.laid_along_path(next);
        }
        Ok((solution, next))
    }

    /// Whether a swing that was to begin from rest about the king pin went the other way.
    fn turned_back(&self, mode: Mode, from: &SlipState, to: &SlipState) -> bool {
        let FrictionMoment::Swinging(moment) = mode.friction_moment else { return false };
        self.equations.swing_rate(from) == 0.0 && self.equations.swing_rate(to) * moment < 0.0
    }

    /// Whether the static friction holds the wheel at a state without slip.
    pub(super) fn holds(&self, equations: &Equations<f64>, state: &[f64]) -> bool {
        // The two are the same expression, so that equal limits give equal answers to the last bit.
        self.rolls_always || equations.static_reserve(state) >= 0.0 || equations.sliding_reserve(state) >= 0.0
    }

    /// Rolls until the static friction is exhausted, or what the caster does ends. The solution has the seven states.
    fn roll(
        &self,
        equations: &Equations<f64>,
        mode: Mode,
        stretch: &Stretch<'_>,
    ) -> Result<(Solution, HybridState), SimulationError> {
        let &Stretch { start, state, end, times, control } = stretch;
        let widen = |x: &[f64]| [x[0], x[1], x[2], x[3], 0.0, x[4], 0.0];
        let initial = [state[0], state[1], state[2], state[3], state[5]];
        let exhausted = Event::new(|_, x| equations.static_reserve(&widen(x))).falling();
        let mut events = vec![if self.rolls_always { exhausted } else { exhausted.terminal() }];
        events.extend(end_about_king_pin(equations, mode, widen));
        let system = from_rates(5, |state: &[f64], derivative: &mut [f64]| {
            self.rolling.evaluate(state, &[], derivative);
            match mode.friction_moment {
                FrictionMoment::Absent => {}
                FrictionMoment::Swinging(moment) => derivative[4] += equations.yaw_acceleration(moment),
                FrictionMoment::Sticking => derivative[4] = 0.0,
            }
        });
        let times = &times[..times.partition_point(|&time| time <= end)];
        let mut solution = self.while_rolling.under(control).with_events(
            system,
            start,
            &initial,
            end,
            times,
            &mut events,
        )?;
        solution.states = solution.states.chunks_exact(5).flat_map(widen).collect();
        let state = widen(&solution.state);
        solution.state = state.to_vec();
        Ok((solution, HybridState { contact: Contact::Rolling, state }))
    }

    /// Slides out of `s = 0` along the limit direction.
    fn start_slip(
        &self,
        equations: &Equations<f64>,
        mode: Mode,
        stretch: &Stretch<'_>,
    ) -> Result<(Solution, HybridState), SimulationError> {
        let &Stretch { start, state, end, times, control } = stretch;
        let system = from_rates(7, |state: &[f64], derivative: &mut [f64]| {
            equations.derivative(state, equations.incipient_force(state), derivative);
        });
        let mut events = vec![
            Event::new(|_, x| slip_squared(x) - self.onset_slip.powi(2)).rising().terminal(),
            Event::new(|_, x| equations.slip_along_limit_direction(x)).falling().terminal(),
        ];
        events.extend(end_about_king_pin(equations, mode, as_slip_state));
        let integrator = self.while_sliding.under(control);
        let mut solution = integrator.with_events(system, start, state, end, times, &mut events)?;
        let state = as_slip_state(&solution.state);
        if solution.ended_by != Some(1) {
            let contact = if slips(&state) { Contact::Sliding } else { Contact::Rolling };
            return Ok((solution, HybridState { contact, state }));
        }
        let state = stuck(state);
        solution.state = state.to_vec();
        Ok((solution, HybridState { contact: Contact::Rolling, state }))
    }

    /// Slides until the slip vanishes; the crossing is where its straight way to zero begins.
    fn slide(
        &self,
        equations: &Equations<f64>,
        mode: Mode,
        stretch: &Stretch<'_>,
    ) -> Result<(Solution, HybridState), SimulationError> {
        let &Stretch { start, state, end, times, control } = stretch;
        let system = from_rates(7, |state: &[f64], derivative: &mut [f64]| {
            equations.derivative(state, equations.sliding_force(state), derivative);
        });
        // Without friction there is nothing special about zero slip.
        let vanishing = if equations.static_limit == 0.0 { 0.0 } else { self.vanishing_slip.powi(2) };
        // The direction of vanishing slip turns ever faster, so the steps shrink with the slip and cannot jump over zero:
        // looking at the end of each step is enough.
        let mut events: Vec<Event<'_>> =
            end_about_king_pin(equations, mode, as_slip_state).into_iter().collect();
        let mut locator = EventLocator::new(&mut events, start, state);
        let mut crossings = Vec::new();
        let mut stepper = Stepper::new(system, &self.while_sliding, start, state, end)?;
        let mut solution = Solution::default();
        let mut vanished = false;
        let ended = loop {
            let ended = !events.is_empty() && locator.locate(&mut stepper, &mut events, &mut crossings);
            let reached = crossings.last().map_or(stepper.time(), |crossing: &Crossing| crossing.time);
            for &time in times[solution.times.len()..].iter().take_while(|&&time| time <= reached) {
                let from = solution.states.len();
                solution.states.resize(from + state.len(), 0.0);
                stepper.prepare_dense_output();
                stepper.interpolate(time, &mut solution.states[from..]);
                solution.times.push(time);
            }
            if stepper.is_finished() || vanished || ended {
                break ended;
            }
            control.check()?;
            stepper.advance()?;
            vanished = slip_squared(stepper.state()) < vanishing && equations.slip_vanishes(stepper.state());
        };
        if let Some(crossing) = crossings.pop().filter(|_| ended) {
            solution.time = crossing.time;
            let state = as_slip_state(&crossing.state);
            solution.state = crossing.state;
            solution.ended_by = Some(mode.regime.contact_events());
            return Ok((solution, HybridState { contact: Contact::Sliding, state }));
        }
        solution.time = stepper.time();
        solution.state = stepper.state().to_vec();
        let mut state = as_slip_state(&solution.state);
        if !vanished {
            return Ok((solution, HybridState { contact: Contact::Sliding, state }));
        }
        solution.crossings.push(Crossing {
            event: 0,
            time: solution.time,
            state: solution.state.clone(),
            direction: Direction::Falling,
        });
        // The rest of the way to zero slip is a straight line.
        let mut rate = [0.0; 7];
        equations.derivative(&state, equations.sliding_force(&state), &mut rate);
        let shrinking = -(state[S1] * rate[S1] + state[S2] * rate[S2]);
        let rest = if shrinking > 0.0 { slip_squared(&state) / shrinking } else { 0.0 };
        let rest = rest.min(end - solution.time);
        let straight =
            |time: f64, component: usize| state[component] + (time - solution.time) * rate[component];
        for &time in times[solution.times.len()..].iter().take_while(|&&time| time <= solution.time + rest) {
            solution.states.extend((0..state.len()).map(|component| straight(time, component)));
            solution.times.push(time);
        }
        for (component, rate) in state.iter_mut().zip(rate) {
            *component += rest * rate;
        }
        let state = stuck(state);
        solution.time += rest;
        solution.state = state.to_vec();
        Ok((solution, HybridState { contact: Contact::Rolling, state }))
    }
}

/// The state with what is left of the slip removed.
fn stuck(mut state: SlipState) -> SlipState {
    state[S1] = 0.0;
    state[S2] = 0.0;
    state
}

/// Where what the caster does about the king pin ends: a swing where it stands still, a rest where the moment exceeds `M_f`.
fn end_about_king_pin<'a>(
    equations: &'a Equations<f64>,
    mode: Mode,
    widen: impl Fn(&[f64]) -> SlipState + 'a,
) -> Option<Event<'a>> {
    let end = match mode.friction_moment {
        FrictionMoment::Absent => return None,
        FrictionMoment::Swinging(moment) => {
            Event::new(move |_, state| moment.signum() * equations.swing_rate(&widen(state)))
        }
        FrictionMoment::Sticking => Event::new(move |_, state| {
            let state = widen(state);
            let moment = equations.friction_moment(&state, mode.regime.friction(equations, &state));
            equations.largest_friction_moment.powi(2) - moment.powi(2)
        }),
    };
    Some(end.falling().terminal())
}
