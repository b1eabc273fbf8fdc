//! Fates of initial conditions as a result.

use crate::classification::{NamedFate, color, contact_in_words, end_of_the_model};
use crate::description;
use crate::parameters::parameters_of;
use crate::states;
use kingpin::basin::{Axis, Destinations, Fate, Fraction, Tile};
use kingpin::{Key, Wheel};
use kingpin_figure::{
    CategoryMap, Figure, FigureError, Grid, Legend, LegendEntry, Marker, MarkerShape, Markers, Panel,
};
use kingpin_report::numbers::{readable, significant};
use kingpin_report::{Cell, Columns, Parameters, Report, Schema, Table};
use serde::Serialize;
use std::io::{self, Write};

/// The column of the fates.
pub(super) const FATE: &str = "fate";

/// Most characters across and down in the map that is printed.
const PRINTED: [usize; 2] = [72, 24];
/// Size in points of the marks of random initial conditions.
const MARK_SIZE: f64 = 2.6;

/// Labels of the states on axes.
const LABELS: [(&str, &str); 8] = [
    ("u", "$u$ (m)"),
    ("q", "$q$ (m)"),
    ("psi", "$\\psi$ (rad)"),
    ("V", "$V$ (m/s)"),
    ("V1", "$V_1$ (m/s)"),
    ("V2", "$V_2$ (m/s)"),
    ("Omega", "$\\Omega$ (rad/s)"),
    ("y_t", "$y_t$ (m)"),
];

/// The values of one state, of the columns or rows of a grid or of every member of a sample.
#[derive(Debug, Serialize)]
pub struct StateValues {
    /// Name of the state.
    pub state: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The values.
    pub values: Vec<f64>,
}

impl StateValues {
    fn new(axis: &Axis, values: Vec<f64>) -> Self {
        Self { state: axis.name(), unit: states::unit(axis.name()), values }
    }

    fn label(&self) -> &'static str {
        LABELS.iter().find(|(state, _)| *state == self.state).map_or("", |(_, label)| label)
    }
}

/// The initial conditions: the axes of a grid, or the states of a sample.
#[derive(Debug)]
pub(super) struct Starts {
    x: Vec<f64>,
    y: Vec<f64>,
    seed: Option<u64>,
}

impl Starts {
    /// A grid.
    pub(super) fn grid(axes: &[Axis; 2], counts: [usize; 2]) -> Self {
        Self { x: axes[0].values(counts[0]), y: axes[1].values(counts[1]), seed: None }
    }

    /// A sample.
    pub(super) fn sample(axes: &[Axis; 2], states: &[[f64; 7]], seed: u64) -> Self {
        let values = |axis: &Axis| states.iter().map(|state| axis.value_in(state)).collect();
        Self { x: values(&axes[0]), y: values(&axes[1]), seed: Some(seed) }
    }
}

/// How many had a fate.
#[derive(Debug, Serialize)]
pub struct FractionResult {
    /// The fate.
    pub fate: NamedFate,
    /// How many had it.
    pub count: usize,
    /// Their part of all.
    pub share: f64,
    /// Of confidence 95 %, where the initial conditions are a random sample.
    pub interval: Option<[f64; 2]>,
}

/// Fates on a grid, row by row, or of a sample.
#[derive(Debug, Serialize)]
pub struct BasinResult {
    /// The wheel and how its motions are followed.
    #[serde(skip)]
    pub destinations: Destinations,
    /// The ends of both axes.
    #[serde(skip)]
    pub ends: [[f64; 2]; 2],
    /// `rolling` or `sliding`.
    pub contact: &'static str,
    /// Time in s for which motions are followed.
    pub duration: f64,
    /// Seed of a random sample.
    pub seed: Option<u64>,
    /// The state across.
    pub x: StateValues,
    /// The state upwards.
    pub y: StateValues,
    /// Where every motion ends.
    pub fates: Vec<NamedFate>,
    /// How many had each fate.
    pub fractions: Vec<FractionResult>,
}

impl BasinResult {
    /// The result of the fates of the starts.
    pub(super) fn new(
        destinations: Destinations,
        axes: &[Axis; 2],
        starts: Starts,
        fates: Vec<Fate>,
    ) -> Self {
        let tile = [Tile { index: 0, first: 0, fates }];
        let is_sample = starts.seed.is_some();
        let fractions = Fraction::of(&tile).into_iter().map(|fraction| FractionResult {
            fate: NamedFate(fraction.fate),
            count: fraction.count,
            share: fraction.share,
            interval: is_sample.then(|| fraction.interval.into()),
        });
        let [tile] = tile;
        Self {
            // What cannot be is not listed.
            fractions: fractions
                .filter(|fraction| {
                    fraction.count > 0
                        || !fraction.fate.0.is_undecided()
                        || fraction.fate.0 == Fate::Undecided
                })
                .collect(),
            ends: [0, 1].map(|index| [axes[index].value(0.0), axes[index].value(1.0)]),
            contact: destinations.model().name(),
            duration: destinations.settings().duration,
            seed: starts.seed,
            x: StateValues::new(&axes[0], starts.x),
            y: StateValues::new(&axes[1], starts.y),
            fates: tile.fates.into_iter().map(NamedFate).collect(),
            destinations,
        }
    }

    /// The fates that occur.
    fn occurring(&self) -> Vec<Fate> {
        self.fractions.iter().filter(|fraction| fraction.count > 0).map(|fraction| fraction.fate.0).collect()
    }

    fn described(&self, wheel: impl Fn(&Wheel, &[Key]) -> String) -> String {
        let how = contact_in_words(self.destinations.wheel(), self.contact);
        format!("{how} at {}", wheel(self.destinations.wheel(), &[]))
    }

    fn write_map(&self, out: &mut dyn Write) -> io::Result<()> {
        let [across, down] = [self.x.values.len().min(PRINTED[0]), self.y.values.len().min(PRINTED[1])];
        let nearest = |place: usize, places: usize, count: usize| place * (count - 1) / (places - 1);
        let rows: Vec<usize> =
            (0..down).rev().map(|place| nearest(place, down, self.y.values.len())).collect();
        let labels: Vec<String> = rows.iter().map(|&row| significant(self.y.values[row], 3)).collect();
        let width = labels.iter().map(String::len).max().unwrap_or(0);
        writeln!(out, "{:>width$} ({})", self.y.state, self.y.unit)?;
        for (row, label) in rows.iter().zip(&labels) {
            let symbols: String = (0..across)
                .map(|column| nearest(column, across, self.x.values.len()))
                .map(|column| symbol(self.fates[row * self.x.values.len() + column].0))
                .collect();
            writeln!(out, "{label:>width$} {symbols}")?;
        }
        let ends = self.ends[0].map(readable);
        let gap = across.saturating_sub(ends[0].len() + ends[1].len());
        writeln!(out, "{:width$} {}{:gap$}{} {} ({})\n", "", ends[0], "", ends[1], self.x.state, self.x.unit)
    }
}

fn symbol(fate: Fate) -> char {
    match fate {
        Fate::UniformMotion => '.',
        Fate::Shimmy => 's',
        Fate::SteadySliding => 'd',
        Fate::Tumbling => 't',
        Fate::Escape => 'e',
        Fate::Irregular => 'i',
        Fate::ModelEnds => '|',
        Fate::Undecided => '?',
    }
}

impl Report for BasinResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.basin")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(self.destinations.wheel(), &[])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{}", self.described(description::on_lines))?;
        let count = self.fates.len();
        let [x, y] = self.ends.map(|[from, to]| format!("{} to {}", readable(from), readable(to)));
        let (x_name, y_name) = (self.x.state, self.y.state);
        let (x_unit, y_unit) = (self.x.unit, self.y.unit);
        match self.seed {
            None => {
                writeln!(out, "{count} motions, each followed for {} s at most\n", readable(self.duration))?
            }
            Some(seed) => writeln!(
                out,
                "{count} random motions with {x_name} = {x} {x_unit} and {y_name} = {y} {y_unit}, seed {seed}, each \
                 followed for {} s at most\n",
                readable(self.duration)
            )?,
        }
        if self.seed.is_none() {
            self.write_map(out)?;
        }
        let headings =
            ["", "end", "motions", "share", if self.seed.is_some() { "95 % interval" } else { "" }];
        let mut table = Table::new(headings);
        for fraction in &self.fractions {
            let interval =
                |[low, high]: [f64; 2]| format!("{} to {}", significant(low, 3), significant(high, 3));
            table.row([
                symbol(fraction.fate.0).to_string().into(),
                fraction.fate.0.name().into(),
                (fraction.count as f64).into(),
                Cell::Digits(fraction.share, 4),
                fraction.interval.map_or_else(|| "".into(), |ends| interval(ends).into()),
            ]);
        }
        table.write(out)?;
        let occurs = |fate: Fate| self.fractions.iter().any(|other| other.fate.0 == fate && other.count > 0);
        if occurs(Fate::Irregular) {
            writeln!(
                out,
                "\nirregular swinging lasted to the end, {} s: whether for ever is undecided",
                readable(10.0 * self.duration)
            )?;
        }
        if occurs(Fate::ModelEnds) {
            let why = end_of_the_model(self.destinations.wheel());
            writeln!(out, "\nend of the model: {why}, and what becomes of the motion is undecided")?;
        }
        if self.destinations.attracts().is_none() {
            writeln!(
                out,
                "\non a circle at this speed it is not known whether small motions, which grow without M_f, die out with it: those that stay \
                 near the uniform motion are undecided"
            )?;
        }
        Ok(())
    }

    fn columns(&self) -> Columns {
        let [x, y] = [&self.x.values, &self.y.values];
        let (across, upwards): (Vec<f64>, Vec<f64>) = match self.seed {
            None => y.iter().flat_map(|&y| x.iter().map(move |&x| (x, y))).unzip(),
            Some(_) => (x.clone(), y.clone()),
        };
        Columns::new()
            .numbers(self.x.state, across)
            .unit(self.x.unit)
            .numbers(self.y.state, upwards)
            .unit(self.y.unit)
            .texts(FATE, self.fates.iter().map(|fate| Some(fate.0.name().to_owned())))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let occurring = self.occurring();
        let axis = |values: &StateValues, [low, high]: [f64; 2]| {
            kingpin_figure::Axis::new(values.label()).limits(low, high)
        };
        let mut panel =
            Panel::new(axis(&self.x, self.ends[0]), axis(&self.y, self.ends[1])).legend(Legend::Below);
        if self.seed.is_none() {
            let place = |fate: &NamedFate| occurring.iter().position(|other| *other == fate.0);
            let cells: Vec<usize> = self.fates.iter().filter_map(place).collect();
            let grid = Grid::new(self.x.values.clone(), self.y.values.clone())?;
            panel = panel.map(CategoryMap::new(
                grid,
                cells,
                occurring.iter().map(|fate| (fate.name(), color(*fate))),
            )?);
        } else {
            for fate in occurring {
                let marker = Marker::new(MarkerShape::Circle).color(color(fate)).size(MARK_SIZE);
                let points = self.x.values.iter().zip(&self.y.values).zip(&self.fates);
                let points = points.filter(|(_, other)| other.0 == fate).map(|((x, y), _)| (*x, *y));
                panel = panel
                    .markers(Markers::new(points, marker))
                    .legend_entry(LegendEntry::patch(fate.name(), color(fate)));
            }
        }
        let description = format!(
            "Where motions end depending on {} and {} at the start: {}",
            self.x.state,
            self.y.state,
            self.described(description::of)
        );
        Ok(Some(Figure::single_column().description(description).panel(panel)))
    }
}
