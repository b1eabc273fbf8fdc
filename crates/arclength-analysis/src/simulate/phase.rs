//! The phases of a motion whose field switches on a state: in a region, or along the border of two.

use super::flow::{Flow, Rates};
use arclength::Threshold;
use arclength::integration::Event;
use arclength_ode::Model;

/// A value this close to a border, relative to its size or to one, is on it.
const ON_BORDER: f64 = 1e-9;

/// Where the field of a model is smooth: everywhere, in a region, or along a switch.
#[derive(Clone, Debug)]
pub(super) enum Phase {
    /// In the region with these cells; without any, everywhere.
    Within(Vec<f64>),
    /// Along a switch, between the regions with these cells below and above it.
    Sliding { switch: usize, below: Vec<f64>, above: Vec<f64> },
}

/// A way out of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Exit {
    /// Over a border of a cell, upwards or downwards.
    Border { switch: usize, upwards: bool },
    /// The field below, or that above, pulls away from the switch.
    PulledAway { upwards: bool },
}

/// A model over an interval of time without switches in time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage<'a> {
    pub model: &'a Model,
    pub parameters: &'a [f64],
    pub thresholds: &'a [Threshold],
    pub interval: [f64; 2],
}

impl<'a> Stage<'a> {
    /// The flow in a phase.
    pub(super) fn flow(&self, phase: &Phase) -> Flow<'a> {
        match phase {
            Phase::Within(cells) => self.within(cells),
            Phase::Sliding { switch, below, above } => self.within(below).along(*switch, above),
        }
    }

    fn within(&self, cells: &[f64]) -> Flow<'a> {
        Flow::new(self.model, self.parameters, cells, self.interval)
    }

    /// The phase at a state: the region in which it lies, at a border the upper one.
    pub(super) fn phase_at(&self, time: f64, state: &[f64]) -> Phase {
        let cells = vec![1.0; self.thresholds.len()];
        Phase::Within(self.settled(cells, time, state, |_, threshold, _, value| threshold.cell(value)))
    }

    /// Sets the cells one after the other, as those behind may depend on those before.
    fn settled(
        &self,
        mut cells: Vec<f64>,
        time: f64,
        state: &[f64],
        cell: impl Fn(usize, Threshold, f64, f64) -> f64,
    ) -> Vec<f64> {
        for _ in 0..self.thresholds.len() {
            let values = self.within(&cells).switches(time, state, cells.len());
            let all = self.thresholds.iter().zip(&cells).zip(values).enumerate();
            let next: Vec<f64> = all
                .map(|(index, ((threshold, known), value))| cell(index, *threshold, *known, value))
                .collect();
            if next == cells {
                break;
            }
            cells = next;
        }
        cells
    }

    /// The ways out of a phase.
    pub(super) fn exits(&self, phase: &Phase) -> Vec<Exit> {
        let (cells, slide) = match phase {
            Phase::Within(cells) => (cells, None),
            Phase::Sliding { switch, below, .. } => (below, Some(*switch)),
        };
        let borders =
            self.thresholds.iter().zip(cells).enumerate().flat_map(|(switch, (threshold, cell))| {
                let [lower, upper] = threshold.borders(*cell);
                let exits =
                    [(lower, false), (upper, true)].into_iter().filter(|(border, _)| border.is_finite());
                exits.map(move |(_, upwards)| Exit::Border { switch, upwards })
            });
        let borders =
            borders.filter(|exit| !matches!(exit, Exit::Border { switch, .. } if Some(*switch) == slide));
        let pulls = [false, true].map(|upwards| Exit::PulledAway { upwards });
        borders.chain(pulls.into_iter().filter(|_| slide.is_some())).collect()
    }

    /// Functions that are positive as long as a motion is in a phase, one for each exit.
    pub(super) fn events(&self, phase: &Phase, exits: &[Exit]) -> Vec<Event<'a>> {
        let count = self.thresholds.len();
        exits
            .iter()
            .map(|exit| {
                let flow = self.flow(phase);
                match *exit {
                    Exit::Border { switch, upwards } => {
                        let border = self.border(phase, switch, upwards);
                        Event::new(move |time, state: &[f64]| {
                            let value = flow.switches(time, state, count)[switch];
                            if upwards { border - value } else { value - border }
                        })
                    }
                    Exit::PulledAway { upwards } => Event::new(move |time, state: &[f64]| {
                        flow.slide_rates(time, state)
                            .map_or(f64::NAN, |rates| if upwards { -rates.above } else { rates.below })
                    }),
                }
                .falling()
                .terminal()
            })
            .collect()
    }

    /// The conditions of the events of the model.
    pub(super) fn model_events(&self, phase: &Phase) -> impl Iterator<Item = Event<'a>> {
        let flow = self.flow(phase);
        self.model.global_events().iter().map(move |event| {
            let flow = flow.clone();
            Event::new(move |time, state: &[f64]| flow.condition_value(event, time, state))
                .direction(event.direction())
                .before()
                .terminal()
        })
    }

    fn border(&self, phase: &Phase, switch: usize, upwards: bool) -> f64 {
        let (Phase::Within(cells) | Phase::Sliding { below: cells, .. }) = phase;
        self.thresholds[switch].borders(cells[switch])[usize::from(upwards)]
    }

    /// The phase behind an exit that is passed at a state.
    pub(super) fn behind(&self, phase: &Phase, exit: Exit, time: f64, state: &[f64]) -> Phase {
        let (switch, upwards) = match (exit, phase) {
            (Exit::Border { switch, upwards }, _) => (switch, upwards),
            (Exit::PulledAway { upwards: true }, Phase::Sliding { above, .. }) => {
                return Phase::Within(above.clone());
            }
            (Exit::PulledAway { .. }, Phase::Sliding { below, .. }) => return Phase::Within(below.clone()),
            (Exit::PulledAway { .. }, Phase::Within(cells)) => return Phase::Within(cells.clone()),
        };
        match phase {
            Phase::Within(cells) => {
                let next = self.beyond(phase, cells, switch, upwards, time, state);
                let [below, above] = if upwards { [cells.clone(), next] } else { [next, cells.clone()] };
                self.at_border(switch, below, above, upwards, time, state)
            }
            Phase::Sliding { switch: along, below, above } => {
                let [below, above] =
                    [below, above].map(|cells| self.beyond(phase, cells, switch, upwards, time, state));
                self.at_border(*along, below, above, true, time, state)
            }
        }
    }

    /// At a border between two regions: sliding where both fields push towards it, else the side to which they push.
    fn at_border(
        &self,
        switch: usize,
        below: Vec<f64>,
        above: Vec<f64>,
        upwards: bool,
        time: f64,
        state: &[f64],
    ) -> Phase {
        let Rates { below: rate_below, above: rate_above } = {
            let velocities = [&below, &above].map(|cells| self.within(cells).velocity(time, state));
            self.within(&below).rates(time, state, switch, [&velocities[0], &velocities[1]])
        };
        match (rate_below > 0.0, rate_above < 0.0) {
            (true, true) => Phase::Sliding { switch, below, above },
            (true, false) => Phase::Within(above),
            (false, true) => Phase::Within(below),
            (false, false) => Phase::Within(if upwards { above } else { below }),
        }
    }

    /// The cells of the region beyond a border at a state on that border.
    fn beyond(
        &self,
        phase: &Phase,
        cells: &[f64],
        switch: usize,
        upwards: bool,
        time: f64,
        state: &[f64],
    ) -> Vec<f64> {
        let velocity = self.flow(phase).velocity(time, state);
        let values = self.within(cells).switches(time, state, cells.len());
        let kept = match phase {
            Phase::Sliding { switch, .. } => Some(*switch),
            Phase::Within(_) => None,
        };
        let mut next = cells.to_vec();
        let mut passed = vec![false; cells.len()];
        for (index, threshold) in self.thresholds.iter().enumerate() {
            let [lower, upper] = threshold.borders(cells[index]);
            let is_on = |border: f64| (values[index] - border).abs() <= ON_BORDER * border.abs().max(1e-3);
            if index == switch {
                next[index] = threshold.next(cells[index], upwards);
                passed[index] = true;
            } else if Some(index) == kept {
                passed[index] = true;
            } else if is_on(lower) || is_on(upper) {
                // Others that are passed at the same time.
                let rate = self.within(cells).rates(time, state, index, [&velocity, &velocity]).below;
                if is_on(upper) && rate > 0.0 || is_on(lower) && rate < 0.0 {
                    next[index] = threshold.next(cells[index], rate > 0.0);
                    passed[index] = true;
                }
            }
        }
        // The rest change only where what they depend on has jumped.
        self.settled(next, time, state, |index, threshold, cell, value| {
            let [lower, upper] = threshold.borders(cell);
            let margin = ON_BORDER * value.abs().max(1.0);
            let stays = passed[index] || (lower - margin..=upper + margin).contains(&value);
            if stays { cell } else { threshold.cell(value) }
        })
    }
}
