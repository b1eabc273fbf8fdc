//! The phases of a motion whose field switches on a state: in a region, or along the border of two.

use super::flow::{Flow, Rates};
use arclength::Threshold;
use arclength::integration::Event;
use arclength_ode::Model;

/// A value this close to a border, relative to its size or to one, is on it.
const ON_BORDER: f64 = 1e-9;

/// Part of the time within which two borders are passed at once.
const AT_ONCE: f64 = 16.0 * f64::EPSILON;

/// Corrections that draw a state to a switch; they double the digits.
const CORRECTIONS: usize = 4;

/// Where the field of a model is smooth: everywhere, in a region, or along a switch.
#[derive(Clone, Debug)]
pub(super) enum Phase {
    /// In the region with these cells; without any, everywhere. A motion that has come into it over a border may be on that
    /// border still, beyond which it is only where that is no rounding.
    Within { cells: Vec<f64>, entry: Option<Entry> },
    /// Along a switch, between the regions with these cells below and above it.
    Sliding { switch: usize, below: Vec<f64>, above: Vec<f64> },
}

/// The border over which a motion has come into a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry {
    switch: usize,
    /// Whether it is the upper one of the cell.
    is_upper: bool,
    /// What of the switch function may be rounding there.
    margin: f64,
}

impl Phase {
    /// The switch along which it slides, if it does.
    pub(super) fn slide(&self) -> Option<usize> {
        match self {
            Self::Within { .. } => None,
            Self::Sliding { switch, .. } => Some(*switch),
        }
    }

    fn cells(&self) -> &[f64] {
        let (Self::Within { cells, .. } | Self::Sliding { below: cells, .. }) = self;
        cells
    }
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
            Phase::Within { cells, .. } => self.within(cells),
            Phase::Sliding { switch, below, above } => self.within(below).along(*switch, above),
        }
    }

    fn within(&self, cells: &[f64]) -> Flow<'a> {
        Flow::new(self.model, self.parameters, cells, self.interval)
    }

    /// The phase at a state: the region in which it lies, at a border the upper one unless the model itself has the field of the
    /// lower one there.
    pub(super) fn phase_at(&self, time: f64, state: &[f64]) -> Phase {
        let cells = vec![1.0; self.thresholds.len()];
        let mut cells = self.settled(cells, time, state, |_, threshold, _, value| threshold.cell(value));
        let values = self.within(&cells).switches(time, state, cells.len());
        for (switch, value) in values.into_iter().enumerate() {
            let threshold = self.thresholds[switch];
            if value != threshold.borders(cells[switch])[0] {
                continue;
            }
            let written = Flow::new(self.model, self.parameters, &[], self.interval).velocity(time, state);
            if self.within(&cells).velocity(time, state) == written {
                continue;
            }
            let mut below = cells.clone();
            below[switch] = threshold.next(cells[switch], false);
            let below =
                self.settled(
                    below,
                    time,
                    state,
                    |index, threshold, cell, value| {
                        if index == switch { cell } else { threshold.cell(value) }
                    },
                );
            if self.within(&below).velocity(time, state) == written {
                cells = below;
            }
        }
        Phase::Within { cells, entry: None }
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
        let (cells, slide) = (phase.cells(), phase.slide());
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
        let border = self.thresholds[switch].borders(phase.cells()[switch])[usize::from(upwards)];
        let margin = match phase {
            Phase::Within { entry: Some(entry), .. }
                if entry.switch == switch && entry.is_upper == upwards =>
            {
                entry.margin
            }
            _ => 0.0,
        };
        if upwards { border + margin } else { border - margin }
    }

    /// The exit over a border at a state from which there is no step, as the field of the region ends at the border: a root of what
    /// is cut off, which is no number beyond. Nothing where the state is on no border that it moves to.
    pub(super) fn exit_without_step(
        &self,
        phase: &Phase,
        exits: &[Exit],
        time: f64,
        state: &[f64],
    ) -> Option<Exit> {
        let flow = self.flow(phase);
        let values = flow.switches(time, state, self.thresholds.len());
        let velocity = flow.velocity(time, state);
        exits.iter().copied().find(|exit| {
            let Exit::Border { switch, upwards } = *exit else { return false };
            let border = self.border(phase, switch, upwards);
            let rate = flow.rates(time, state, switch, [&velocity, &velocity]).below;
            let leads_out = if upwards { rate >= 0.0 } else { rate <= 0.0 };
            leads_out && (values[switch] - border).abs() <= ON_BORDER * border.abs().max(1e-3)
        })
    }

    /// Draws a state that is on a border but for rounding to the border itself, by the shortest way.
    pub(super) fn draw_to_border(&self, phase: &Phase, exit: Exit, time: f64, state: &mut [f64]) {
        let Exit::Border { switch, upwards } = exit else { return };
        let slope = self.flow(phase).switch_slope(time, state, switch);
        let excess = slope.value - self.border(phase, switch, upwards);
        let square: f64 = slope.gradient[..state.len()].iter().map(|gradient| gradient * gradient).sum();
        if square > 0.0 {
            state.iter_mut().zip(&slope.gradient).for_each(|(value, gradient)| {
                *value -= excess * gradient / square;
            });
        }
    }

    /// The phase behind an exit that is passed at a state.
    pub(super) fn behind(&self, phase: &Phase, exit: Exit, time: f64, state: &[f64]) -> Phase {
        let (switch, upwards) = match (exit, phase) {
            (Exit::Border { switch, upwards }, _) => (switch, upwards),
            (Exit::PulledAway { upwards: true }, Phase::Sliding { above, .. }) => {
                return self.entered(above.clone(), phase.slide(), false, time, state);
            }
            (Exit::PulledAway { .. }, Phase::Sliding { below, .. }) => {
                return self.entered(below.clone(), phase.slide(), true, time, state);
            }
            (Exit::PulledAway { .. }, Phase::Within { .. }) => return phase.clone(),
        };
        match phase {
            Phase::Within { cells, .. } => {
                let next = self.beyond(phase, cells, switch, upwards, time, state);
                let [below, above] = if upwards { [cells.clone(), next] } else { [next, cells.clone()] };
                self.at_border(switch, below, above, upwards, time, state)
            }
            Phase::Sliding { switch: along, below, above } => {
                let [below, above] =
                    [below, above].map(|cells| self.beyond(phase, cells, switch, upwards, time, state));
                // What has jumped may have taken the switch along, away from the motion.
                let value = self.within(&below).switches(time, state, below.len())[*along];
                let border = self.thresholds[*along].borders(below[*along])[1];
                if (value - border).abs() > ON_BORDER * value.abs().max(border.abs()).max(1.0) {
                    let cells = if value > border { above } else { below };
                    let cells = self.settled(cells, time, state, |index, threshold, cell, value| {
                        if index == *along { threshold.cell(value) } else { cell }
                    });
                    return Phase::Within { cells, entry: None };
                }
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
        let goes_up = match (rate_below > 0.0, rate_above < 0.0) {
            (true, true) => return Phase::Sliding { switch, below, above },
            (true, false) => true,
            (false, true) => false,
            (false, false) => upwards,
        };
        self.entered(if goes_up { above } else { below }, Some(switch), !goes_up, time, state)
    }

    /// In a region, into which a motion has come over the border of a switch at a state.
    fn entered(
        &self,
        cells: Vec<f64>,
        switch: Option<usize>,
        is_upper: bool,
        time: f64,
        state: &[f64],
    ) -> Phase {
        let entry = switch.map(|switch| {
            let slope = self.within(&cells).switch_slope(time, state, switch);
            let border = self.thresholds[switch].borders(cells[switch])[usize::from(is_upper)];
            // A border where the motion could not be followed to the far side is not quite reached.
            let excess = if is_upper { slope.value - border } else { border - slope.value };
            let short = if excess <= ON_BORDER * border.abs().max(1e-3) { 2.0 * excess } else { 0.0 };
            Entry { switch, is_upper, margin: slope.noise(time, state).max(short) }
        });
        Phase::Within { cells, entry }
    }

    /// How far a state is from the switch along which a phase slides, in units of the differences that count as none, `scales`.
    pub(super) fn drift(&self, phase: &Phase, time: f64, state: &[f64], scales: &[f64]) -> f64 {
        self.way_to_slide(phase, time, state, scales).map_or(0.0, |way| {
            way.iter().zip(scales).map(|(way, scale)| (way / scale).powi(2)).sum::<f64>().sqrt()
        })
    }

    /// Draws a state to the switch along which a phase slides, from which it has been driven by errors; `scales` are those that count
    /// as equal for the states.
    pub(super) fn draw_to_slide(&self, phase: &Phase, time: f64, state: &mut [f64], scales: &[f64]) {
        for _ in 0..CORRECTIONS {
            let Some(way) = self.way_to_slide(phase, time, state, scales) else { return };
            state.iter_mut().zip(way).for_each(|(value, way)| *value += way);
        }
    }

    /// The shortest way to the switch along which a phase slides, to first order; nothing where a state is on it but for rounding.
    fn way_to_slide(&self, phase: &Phase, time: f64, state: &[f64], scales: &[f64]) -> Option<Vec<f64>> {
        let switch = phase.slide()?;
        let slope = self.flow(phase).switch_slope(time, state, switch);
        let excess = slope.value - self.border(phase, switch, true);
        let weights = slope.gradient.iter().zip(scales).map(|(gradient, scale)| gradient * scale * scale);
        let way: Vec<f64> = weights.map(|weight| -excess * weight).collect();
        let squares = slope.gradient.iter().zip(scales).map(|(gradient, scale)| (gradient * scale).powi(2));
        let square: f64 = squares.sum();
        let is_known = square > 0.0 && excess.is_finite() && excess.abs() > slope.noise(time, state);
        is_known.then(|| way.into_iter().map(|way| way / square).collect())
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
        let kept = phase.slide();
        let mut next = cells.to_vec();
        next[switch] = self.thresholds[switch].next(cells[switch], upwards);
        let ahead = self.within(&next).switches(time, state, cells.len());
        let jumps = |index: usize, value: f64| {
            let size = value.abs().max(values[index].abs()).max(1.0);
            (value - values[index]).abs() > ON_BORDER * size
        };
        let mut passed = vec![false; cells.len()];
        for (index, threshold) in self.thresholds.iter().enumerate() {
            if index == switch || Some(index) == kept {
                passed[index] = true;
            } else if !jumps(index, ahead[index]) {
                // Others that are passed at the same time, as far as that is known.
                let rate = self.within(cells).rates(time, state, index, [&velocity, &velocity]).below;
                let border = threshold.borders(cells[index])[usize::from(rate > 0.0)];
                let margin = (ON_BORDER * border.abs().max(1e-3)).max(AT_ONCE * (rate * time).abs());
                if rate != 0.0 && border.is_finite() && (values[index] - border).abs() <= margin {
                    next[index] = threshold.next(cells[index], rate > 0.0);
                    passed[index] = true;
                }
            }
        }
        // The rest change only where what they depend on has jumped.
        self.settled(next, time, state, |index, threshold, cell, value| {
            let [lower, upper] = threshold.borders(cell);
            let margin = ON_BORDER * value.abs().max(1.0);
            let stays =
                passed[index] || !jumps(index, value) && (lower - margin..=upper + margin).contains(&value);
            if stays { cell } else { threshold.cell(value) }
        })
    }
}
