//! What is found at the values of the parameter as chunks of rows, for processes that share them.

use super::found::Found;
use super::request::MarginAnalysis;
use super::result::MarginResult;
use crate::by_chunks::{ByChunks, Keep, in_a_chunk};
use crate::classification::NamedFate;
use crate::disturbance::Edge;
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::basin::Fate;
use kingpin_report::{Columns, Entries};
use serde_json::Value;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// The column that says why no edge was sought.
const PROBLEM: &str = "problem";
/// The directions, before the names of their columns.
const DIRECTIONS: [&str; 2] = ["positive", "negative"];

impl ByChunks for MarginAnalysis {
    type Result = MarginResult;

    fn computation(&self) -> &Value {
        self.computation()
    }

    fn points(&self) -> usize {
        self.values().len()
    }

    /// Each value takes seconds to minutes.
    fn chunk(&self, shards: usize) -> Result<usize, Error> {
        Ok(in_a_chunk(self.points(), 1, shards))
    }

    fn compute(&self, chunks: &[Range<usize>], keep: Keep<'_>, control: &Control<'_>) -> Result<(), Error> {
        let wanted: Vec<usize> = chunks.iter().cloned().flatten().collect();
        let known: Vec<Mutex<BTreeMap<usize, Found>>> = chunks.iter().map(|_| Mutex::default()).collect();
        let on_found = |index: usize, found: &Found| {
            let Some(chunk) = chunks.iter().position(|chunk| chunk.contains(&index)) else { return };
            let mut values = known[chunk].lock().unwrap_or_else(PoisonError::into_inner);
            values.insert(index, found.clone());
            if values.len() == chunks[chunk].len() {
                keep(chunk, &self.columns_of(&values));
            }
        };
        self.seek(&wanted, &on_found, control).map(drop)
    }

    fn put_together(&self, columns: &Columns, control: &Control<'_>) -> Result<Option<MarginResult>, Error> {
        match found_of(columns) {
            Some(found) => self.result(found, control).map(Some),
            None => Ok(None),
        }
    }
}

impl MarginAnalysis {
    fn columns_of(&self, found: &BTreeMap<usize, Found>) -> Columns {
        let value = found.keys().map(|&index| self.values()[index]);
        let mut columns = Columns::new().numbers(self.along().key().name(), value);
        for (direction, name) in DIRECTIONS.into_iter().enumerate() {
            let edges = || found.values().map(move |found| [found.positive, found.negative][direction]);
            let fate = |edge: Option<Edge>| Some(edge?.fate?.0.name().to_owned());
            columns = columns
                .optional_numbers(format!("{name}_returns"), edges().map(|edge| Some(edge?.returns)))
                .optional_numbers(format!("{name}_fails"), edges().map(|edge| Some(edge?.fails)))
                .texts(format!("{name}_fate"), edges().map(fate))
                .booleans(
                    format!("{name}_smaller_are_undecided"),
                    edges().map(|edge| Some(edge?.smaller_are_undecided)),
                );
        }
        columns.texts(PROBLEM, found.values().map(|found| found.problem.clone()))
    }
}

/// What stands in columns; nothing where they are others.
fn found_of(columns: &Columns) -> Option<Vec<Found>> {
    let Some(Entries::Texts(problems)) = columns.named(PROBLEM) else { return None };
    let [positive, negative] = DIRECTIONS.map(|name| edges_of(columns, name));
    let edges = positive?.into_iter().zip(negative?);
    let found = problems.iter().zip(edges);
    Some(
        found
            .map(|(problem, (positive, negative))| Found { positive, negative, problem: problem.clone() })
            .collect(),
    )
}

fn edges_of(columns: &Columns, direction: &str) -> Option<Vec<Option<Edge>>> {
    let column = |name: &str| columns.named(&format!("{direction}_{name}"));
    let (
        Some(Entries::Numbers(returns)),
        Some(Entries::Numbers(fails)),
        Some(Entries::Texts(fates)),
        Some(Entries::Booleans(undecided)),
    ) = (column("returns"), column("fails"), column("fate"), column("smaller_are_undecided"))
    else {
        return None;
    };
    let edge = |row: usize| {
        let named = |name: &String| Fate::ALL.into_iter().find(|fate| fate.name() == name).map(NamedFate);
        Some(Edge {
            returns: returns[row]?,
            fails: fails[row]?,
            fate: fates[row].as_ref().and_then(named),
            smaller_are_undecided: undecided[row]?,
        })
    };
    Some((0..returns.len()).map(edge).collect())
}
