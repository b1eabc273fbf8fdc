//! What results of the wheel without dry friction about the king pin say of one that has it.
//!
//! Where the caster sticks there is nothing to linearise, so that uniform motions, eigenvalues, Hopf points and cycles are those at
//! `M_f = 0`. What dry friction makes of small motions in straight towing is known beside: they die out up to a speed that does not
//! depend on its moment.

use crate::description;
use kingpin::{Key, Wheel};
use kingpin_report::numbers::readable;
use serde::Serialize;
use std::io::{self, Write};

/// Dry friction about the king pin that a result takes no account of.
#[derive(Clone, Debug, Serialize)]
pub struct NeglectedDryFriction {
    /// Its moment `M_f` in N m.
    pub moment: f64,
    /// Towed straight, the speed in m/s up to which small motions die out with it; nothing where there is none, or where it varies
    /// over the result.
    pub critical_speed_with_friction: Option<f64>,
    /// Whether that speed can be told.
    #[serde(skip)]
    is_told: bool,
    /// Where it varies over the result, it at the wheel's own values, in words, of what it varies with.
    #[serde(skip)]
    own: Option<(String, Option<f64>)>,
}

impl NeglectedDryFriction {
    /// That of a wheel, in a result over which some parameters vary; nothing where the wheel has none.
    pub(crate) fn of(wheel: &Wheel, varying: &[Key]) -> Option<Self> {
        let moment = wheel.get(Key::MF);
        let same_speed = [Key::V, Key::KU, Key::CU, Key::G, Key::MuS, Key::MuD, Key::FAz];
        let is_told = wheel.get(Key::TurningRadius).is_infinite()
            && varying.iter().flat_map(|key| key.sets()).all(|key| same_speed.contains(key));
        let moved: Vec<Key> = varying
            .iter()
            .copied()
            .filter(|key| key.sets().iter().any(|key| !same_speed.contains(key)))
            .collect();
        let on_circles = moved.iter().any(|key| key.sets().contains(&Key::TurningRadius));
        let own = (!is_told && wheel.get(Key::TurningRadius).is_infinite() && !on_circles).then(|| {
            let place: Vec<String> =
                moved.iter().map(|key| description::quantity(*key, wheel.get(*key))).collect();
            (place.join(", "), wheel.critical_speed_with_friction())
        });
        let speed = is_told.then(|| wheel.critical_speed_with_friction()).flatten();
        (moment > 0.0).then_some(Self { moment, critical_speed_with_friction: speed, is_told, own })
    }

    /// That it was left out, in words.
    pub(crate) fn in_words(&self) -> String {
        let moment = readable(self.moment);
        format!("this is the wheel without dry friction about the king pin: M_f = {moment} N m was left out")
    }

    /// All that is known of it, in sentences.
    pub(crate) fn sentences(&self) -> Vec<String> {
        [vec![self.in_words()], self.in_sentences("with it")].concat()
    }

    /// What takes it into account, and what it does to small motions; of which wheel is said by the words `with it`.
    pub(crate) fn in_sentences(&self, with_it: &str) -> Vec<String> {
        let elsewhere = "`simulate`, `basin`, `safe-kick` and `margin` take it into account".to_owned();
        let elsewhere = Some(elsewhere).filter(|_| !self.is_told);
        elsewhere.into_iter().chain(self.speed_in_words(with_it)).collect()
    }

    /// Up to which speed small motions die out with it; nothing where that varies with what is not the wheel's own.
    pub(crate) fn speed_in_words(&self, with_it: &str) -> Option<String> {
        let (at, speed) = match &self.own {
            Some((place, speed)) => (format!("at {place} "), speed),
            None if self.is_told => (String::new(), &self.critical_speed_with_friction),
            None => return None,
        };
        Some(match speed {
            Some(0.0) => format!("{at}{with_it} small motions grow at every speed all the same"),
            Some(speed) => format!("{at}{with_it} small motions die out up to {} m/s", readable(*speed)),
            None => format!("{at}{with_it} small motions die out at every speed"),
        })
    }

    /// Tells of it, where there is any.
    pub(crate) fn tell(neglected: Option<&Self>, out: &mut dyn Write) -> io::Result<()> {
        let Some(neglected) = neglected else { return Ok(()) };
        writeln!(out)?;
        neglected.sentences().iter().try_for_each(|sentence| writeln!(out, "{sentence}"))
    }
}
