//! What the wheel and its caster do, in words.

use kingpin::sliding::{self, Contact, KingPin};
use kingpin::{Key, Wheel};
use kingpin_report::Columns;
use kingpin_report::numbers::{counted, readable};
use serde::Serialize;
use std::io::{self, Write};

/// A stretch of time in which the wheel only rolls or only slides, and the caster only swings or only sticks.
#[derive(Debug, Serialize)]
pub struct Phase {
    /// `rolling` or `sliding`.
    pub contact: &'static str,
    /// `swinging` or `sticking`, where dry friction acts about the king pin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub king_pin: Option<&'static str>,
    /// Its start in s.
    pub start: f64,
    /// Its end in s.
    pub end: f64,
}

/// The contact in a word.
pub(super) fn contact(contact: Contact) -> &'static str {
    match contact {
        Contact::Rolling => "rolling",
        Contact::Sliding => "sliding",
    }
}

/// What the caster does in a word.
pub(super) fn king_pin(king_pin: KingPin) -> &'static str {
    match king_pin {
        KingPin::Swinging => "swinging",
        KingPin::Sticking => "sticking",
    }
}

/// Columns with what dry friction about the king pin does, where there is any.
pub(super) fn columns(
    columns: Columns,
    moment: Option<&[f64]>,
    king_pin: Option<&[&'static str]>,
) -> Columns {
    let columns = match moment {
        Some(moment) => columns.numbers("friction_moment", moment.iter().copied()).unit("N m"),
        None => columns,
    };
    match king_pin {
        Some(words) => columns.texts("king_pin", words.iter().map(|word| Some((*word).to_owned()))),
        None => columns,
    }
}

impl Phase {
    /// The phases of a motion of a wheel.
    pub(super) fn list(wheel: &Wheel, phases: &[sliding::Phase]) -> Vec<Self> {
        let dry = wheel.get(Key::MF) > 0.0;
        let phase = |phase: &sliding::Phase| Self {
            contact: contact(phase.contact),
            king_pin: dry.then(|| king_pin(phase.king_pin)),
            start: phase.start,
            end: phase.end,
        };
        phases.iter().map(phase).collect()
    }

    /// Tells how the caster swings and sticks, where dry friction acts about the king pin.
    pub(super) fn tell_swings(
        phases: &[Self],
        psi: Option<f64>,
        work: Option<f64>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let Some(work) = work else { return Ok(()) };
        let is = |phase: &&Self, word: KingPin| phase.king_pin == Some(king_pin(word));
        let time = |phases: &mut dyn Iterator<Item = &Self>| -> f64 {
            // The sum of none is zero, without a sign.
            phases.fold(0.0, |sum, phase| sum + (phase.end - phase.start))
        };
        let total = time(&mut phases.iter());
        let stuck = time(&mut phases.iter().filter(|phase| is(phase, KingPin::Sticking)));
        let swings = phases.iter().filter(|phase| is(phase, KingPin::Swinging)).count();
        let share = if total > 0.0 { 100.0 * stuck / total } else { 0.0 };
        writeln!(
            out,
            "the caster swings in {} and sticks for {share:.1} % of the time; dry friction takes {} J",
            counted(swings, "phase", "phases"),
            readable(work)
        )?;
        // Contact may change while it goes on sticking.
        let last = phases.iter().rev().take_while(|phase| is(phase, KingPin::Sticking)).last();
        match (last, psi) {
            (Some(last), Some(psi)) => writeln!(
                out,
                "it sticks from {} s to the end, at psi = {} rad",
                readable(last.start),
                readable(psi)
            ),
            _ => writeln!(out, "it swings at the end"),
        }
    }
}
