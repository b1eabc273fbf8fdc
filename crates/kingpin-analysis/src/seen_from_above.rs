//! Motions of a wheel as they are seen from above, to be drawn: where its parts are and the forces on it, in the frame of the towing point.

use crate::cycles::{CyclePointResult, CyclesResult};
use crate::error::Error;
use crate::shimmy::{ShimmyPointResult, ShimmyResult};
use crate::simulate::{ForcesFromAbove, HistoryResult, SlidingHistory};
use crate::steady::SteadyResult;
use arclength::cycle::Orbit;
use arclength_analysis::Control;
use kingpin::Wheel;
use serde::Serialize;

/// A motion in the frame of the towing point: x forwards, y towards the centre of the circle. Numbers of single precision, at equal
/// distances of time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeenFromAbove {
    /// Times in s.
    pub t: Vec<f32>,
    /// Displacement of the king pin forwards in m.
    pub u: Vec<f32>,
    /// Displacement of the king pin towards the centre in m.
    pub q: Vec<f32>,
    /// Caster angle in rad.
    pub psi: Vec<f32>,
    /// Yaw rate of the caster in rad/s.
    #[serde(rename = "Omega")]
    pub yaw_rate: Vec<f32>,
    /// Force of springs and dampers on the king pin in N: components x and y.
    pub king_pin_force: [Vec<f32>; 2],
    /// Force of the ground on the wheel in N: components x and y.
    pub ground_force: [Vec<f32>; 2],
}

fn single(values: &[f64]) -> Vec<f32> {
    values.iter().map(|&value| value as f32).collect()
}

fn component(forces: &[[f64; 2]], index: usize) -> Vec<f32> {
    forces.iter().map(|force| force[index] as f32).collect()
}

impl SeenFromAbove {
    /// A motion from its times, its states `u q psi Omega` and its forces.
    fn new(t: &[f64], [u, q, psi, yaw_rate]: [&[f64]; 4], forces: &ForcesFromAbove) -> Self {
        let pair = |forces: &[[f64; 2]]| [0, 1].map(|index| component(forces, index));
        Self {
            t: single(t),
            u: single(u),
            q: single(q),
            psi: single(psi),
            yaw_rate: single(yaw_rate),
            king_pin_force: pair(&forces.king_pin),
            ground_force: pair(&forces.ground),
        }
    }

    /// A cycle over one period, at so many times.
    pub(crate) fn of_cycle(wheel: &Wheel, orbit: &Orbit, samples: usize) -> Result<Self, Error> {
        let model = wheel.rolling_model(&[])?;
        let (mut times, mut states): (Vec<f64>, Vec<Vec<f64>>) = orbit
            .sample(samples.saturating_sub(1).max(1))
            .into_iter()
            .map(|(time, free)| (time, model.full_state(&free, &[])))
            .unzip();
        // The end of the period is its start.
        times.push(orbit.period);
        states.push(states[0].clone());
        Self::of_rolling(wheel, &times, &states)
    }

    /// A motion that rolls, by all states of the wheel at every time.
    fn of_rolling(wheel: &Wheel, t: &[f64], states: &[Vec<f64>]) -> Result<Self, Error> {
        let loads = wheel.rolling_loads(states.iter().map(|state| (&state[..], 0.0)))?;
        let place = |name: &str| wheel.states().iter().position(|state| *state == name);
        let values = |name: &str| -> Vec<f64> {
            place(name).map_or_else(Vec::new, |place| states.iter().map(|state| state[place]).collect())
        };
        let [u, q, psi, yaw_rate] = ["u", "q", "psi", "Omega"].map(values);
        Ok(Self::new(t, [&u, &q, &psi, &yaw_rate], &ForcesFromAbove::of_rolling(&loads)))
    }
}

impl HistoryResult {
    /// The motion as it is seen from above.
    pub fn seen_from_above(&self) -> SeenFromAbove {
        match self {
            Self::Rolling(history) => SeenFromAbove::new(
                &history.t,
                [&history.u, &history.q, &history.psi, &history.yaw_rate],
                &history.forces,
            ),
            Self::Sliding(history) => SeenFromAbove::new(
                &history.t,
                [&history.u, &history.q, &history.psi, &history.yaw_rate],
                &history.forces,
            ),
            Self::Tyre(history) => SeenFromAbove::new(
                &history.t,
                [&history.u, &history.q, &history.psi, &history.yaw_rate],
                &history.forces,
            ),
        }
    }
}

impl SteadyResult {
    /// The uniform motion as it is seen from above: one sample.
    ///
    /// # Errors
    /// [`Error::Wheel`].
    pub fn seen_from_above(&self) -> Result<SeenFromAbove, Error> {
        let state = self.state.0.iter().map(|(_, value)| *value).collect();
        SeenFromAbove::of_rolling(&self.wheel, &[0.0], &[state])
    }
}

impl CyclesResult {
    /// A cycle of the result over one period as it is seen from above, at so many times; nothing where the result does not hold its orbit.
    ///
    /// # Errors
    /// [`Error::Wheel`].
    pub fn seen_from_above(
        &self,
        point: &CyclePointResult,
        samples: usize,
    ) -> Result<Option<SeenFromAbove>, Error> {
        let Some(orbit) = &point.cycle.orbit else { return Ok(None) };
        let wheel = self.wheel.with(self.interval.key(), point.cycle.value)?;
        SeenFromAbove::of_cycle(&wheel, orbit, samples).map(Some)
    }
}

impl ShimmyResult {
    /// A shimmy of the result over one period as it is seen from above, at so many times.
    ///
    /// # Errors
    /// [`Error::Simulation`], [`Error::Wheel`]; [`Error::Stopped`] where the control stops it.
    pub fn seen_from_above(
        &self,
        point: &ShimmyPointResult,
        samples: usize,
        control: &Control<'_>,
    ) -> Result<SeenFromAbove, Error> {
        let wheel = self.wheel.with(self.interval.key(), point.value)?;
        if let Some(orbit) = &point.orbit {
            return SeenFromAbove::of_cycle(&wheel, orbit, samples);
        }
        let mut state = [0.0; 7];
        for (value, (_, known)) in state.iter_mut().zip(&point.state.0) {
            *value = *known;
        }
        let history = wheel.sliding()?.simulate_from(&state, point.period, samples, control)?;
        Ok(HistoryResult::Sliding(SlidingHistory::new(wheel, history)).seen_from_above())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::WheelRequest;
    use crate::cycles::CyclesRequest;
    use crate::simulate::SimulateRequest;
    use crate::steady::SteadyRequest;
    use arclength_analysis::{Assignment, Interval};

    /// The springs pull the king pin back, and the ground keeps the balance: the mass times the acceleration of the centre of gravity of
    /// wheel and caster is the sum of both forces (theory of the motion on a circle: towards the centre).
    #[test]
    fn forces_in_uniform_motion_keep_the_wheel_on_its_circle() {
        let steady = SteadyRequest::default().run().unwrap();
        let seen = steady.seen_from_above().unwrap();
        let number = |values: &[f32]| f64::from(values[0]);
        let (u, q, psi) = (number(&seen.u), number(&seen.q), number(&seen.psi));
        let [fx, fy] = [0, 1].map(|index| number(&seen.king_pin_force[index]));
        assert!((fx + 100.0 * u).abs() < 1e-5 && (fy + 100.0 * q).abs() < 1e-5, "{fx} {fy}");
        // The paper's wheel: masses, distances, circle.
        let (wheel_mass, caster_mass, l, l_c, r, v) = (0.3519, 0.0668, 0.08, 0.012, 1.0, 4.0);
        let place = |distance: f64| [u - distance * psi.cos(), q + distance * psi.sin()];
        let rate = (v / r) * (v / r);
        for axis in 0..2 {
            let centre = [0.0, r][axis];
            let needed =
                rate * (wheel_mass * (centre - place(l)[axis]) + caster_mass * (centre - place(l_c)[axis]));
            let sum = number(&seen.king_pin_force[axis]) + number(&seen.ground_force[axis]);
            assert!((sum - needed).abs() < 1e-4, "axis {axis}: {sum} {needed}");
        }
    }

    #[test]
    fn a_cycle_and_the_motion_from_its_start_are_seen_alike() {
        let mut request = CyclesRequest::new(Interval { key: "v".to_owned(), start: 3.5, end: 9.0 });
        request.at = vec![5.0];
        let result = request.validate().unwrap().run(&Control::none()).unwrap();
        let point = result.points.iter().find(|point| point.cycle.label.as_deref() == Some("AT1")).unwrap();
        let seen = result.seen_from_above(point, 201).unwrap().unwrap();
        assert_eq!(seen.t.len(), 201);

        let mut simulate = SimulateRequest::new(point.cycle.period);
        simulate.wheel = WheelRequest {
            wheel: None,
            set: vec![Assignment { key: "v".to_owned(), value: "5".to_owned() }],
        };
        simulate.points = 201;
        let steady = SteadyRequest { wheel: simulate.wheel.clone() }.run().unwrap();
        let start = point.cycle.orbit.as_ref().unwrap().state_at(0.0);
        simulate.perturb.0 = steady
            .state
            .0
            .iter()
            .zip(&start)
            .map(|((name, uniform), value)| (name.clone(), value - uniform))
            .collect();
        let motion = simulate.validate().unwrap().run(&Control::none()).unwrap().seen_from_above();
        for (one, other) in seen.psi.iter().zip(&motion.psi) {
            assert!((one - other).abs() < 1e-4, "{one} {other}");
        }
        for (one, other) in seen.ground_force.iter().zip(&motion.ground_force) {
            for (one, other) in one.iter().zip(other) {
                assert!((one - other).abs() < 0.02, "{one} {other}");
            }
        }
    }
}
