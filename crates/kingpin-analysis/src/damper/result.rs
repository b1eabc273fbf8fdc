//! The smallest dampers as a result.

use super::condition::Range;
use super::kicks::KickedWheels;
use super::large_cycles::LargeCycles;
use crate::description;
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::parameters::parameters_of;
use kingpin::{CycleForces, Key, Tyre, Wheel, is_slowest_speed};
use kingpin_report::numbers::{counted, readable, significant};
use kingpin_report::{Columns, Parameters, Report, Schema, Table};
use serde::Serialize;
use std::io::{self, Write};

/// The smallest dampers.
#[derive(Debug, Serialize)]
pub struct DamperResult {
    /// The wheel without its dampers.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The wheel's own dampers `c_q` and `c_psi`, in whose place those that were found are.
    #[serde(skip)]
    pub own_dampers: [f64; 2],
    /// What the dampers are for.
    pub requirement: &'static str,
    /// The speed in m/s up to which the uniform motion is to be stable.
    pub up_to: f64,
    /// The radii, where they are not the wheel's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<Range>,
    /// The loads, where they are not the wheel's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<Range>,
    /// The smallest lateral damper alone, in N s/m; nothing where none was found that is enough.
    pub c_q: Option<f64>,
    /// The smallest damper about the king pin alone, in N m s/rad.
    pub c_psi: Option<f64>,
    /// The speeds that decide.
    pub corner: Corner,
    /// The dampers beside a slight longitudinal one, where nothing damps the longitudinal motion and that decides.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_longitudinal_damper: Option<WithLongitudinalDamper>,
    /// Both dampers together.
    pub front: Front,
    /// What it takes that no large cycle is found either, each damper alone; nothing where none was sought.
    pub isola_free: Option<IsolaFree>,
    /// Dry friction about the king pin that was left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction: Option<NeglectedDryFriction>,
}

/// The smallest dampers beside a longitudinal one.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct WithLongitudinalDamper {
    /// The longitudinal damper in N s/m: a thousandth of the critical damping of the wheel's mass on its spring.
    pub c_u: f64,
    /// The smallest lateral damper alone beside it.
    pub c_q: Option<f64>,
    /// The smallest damper about the king pin alone beside it.
    pub c_psi: Option<f64>,
}

impl WithLongitudinalDamper {
    /// What is said of them.
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let damper = |key: Key, damping: Option<f64>| match damping {
            None => format!("no {key} that is enough"),
            Some(0.0) => format!("no {key} needed"),
            Some(damping) => description::quantity(key, damping),
        };
        writeln!(
            out,
            "\nthe longitudinal motion decides: nothing damps it (c_u = 0), and on circles it grows, however slowly; beside\n\
             {}, a thousandth of its critical damping: {} or {}",
            description::quantity(Key::CU, self.c_u),
            damper(Key::CQ, self.c_q),
            damper(Key::CPsi, self.c_psi)
        )
    }
}

/// Speeds in m/s at which the motion is unstable with a weaker damper; nothing where none is needed.
#[derive(Debug, Serialize)]
pub struct Corner {
    /// Of the lateral damper.
    pub c_q: Option<f64>,
    /// Of the one about the king pin.
    pub c_psi: Option<f64>,
    /// Where the lateral damper is decided, over several circles or loads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub c_q_at: Option<Conditions>,
    /// Where the one about the king pin is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub c_psi_at: Option<Conditions>,
}

/// One of several circles and loads, at one speed.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Conditions {
    /// Speed in m/s.
    pub v: f64,
    /// Radius in m.
    #[serde(with = "kingpin_report::number")]
    pub r: f64,
    /// Vertical force on the king pin in N.
    #[serde(rename = "F_Az")]
    pub load: f64,
}

impl Conditions {
    /// Those of a wheel.
    pub(super) fn of(wheel: &Wheel) -> Self {
        Self { v: wheel.get(Key::V), r: wheel.get(Key::TurningRadius), load: wheel.get(Key::FAz) }
    }
}

/// What it takes that no large cycle is found.
#[derive(Debug, Serialize)]
pub struct IsolaFree {
    /// The lateral damper alone; nothing where none is enough for small motions.
    pub c_q: Option<WithoutCycles>,
    /// The damper about the king pin alone.
    pub c_psi: Option<WithoutCycles>,
}

/// The smallest damper with which no large cycle was found. What was searched is no proof that there is none.
#[derive(Debug, Serialize)]
pub struct WithoutCycles {
    /// The damper in the unit of its key: where the cycles end that were followed, or, where kicks are lost with that, the first that was
    /// tried with which none is; nothing where there is none.
    pub damping: Option<f64>,
    /// Where the cycles end that were followed; nothing where there were some with every damper that was tried.
    pub by_continuation: Option<f64>,
    /// Whether large cycles decide: they last longer than small ones are born.
    pub decided_by_large_cycles: bool,
    /// The cycle that lasts longest: where large cycles decide, there the last of them dies.
    pub last_cycle: Option<LastCycleResult>,
    /// Branches of cycles that were followed.
    pub branches: usize,
    /// Curves of folds that were followed.
    pub curves: usize,
    /// Largest damper that was tried.
    pub largest: f64,
    /// Why some branches and curves were not followed.
    pub problems: Vec<String>,
    /// What became of strong random kicks with that damper; nothing where none were.
    pub kicked: Option<KickedWheels>,
}

/// A cycle at the largest damping at which one was found.
#[derive(Debug, Serialize)]
pub struct LastCycleResult {
    /// Damping.
    pub damping: f64,
    /// Speed in m/s.
    pub speed: f64,
    /// Where it is, over several circles or loads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<Conditions>,
    /// Period in s.
    pub period: f64,
    /// Smallest caster angle in rad.
    pub psi_min: f64,
    /// Largest caster angle in rad.
    pub psi_max: f64,
    /// Largest friction force in N.
    pub friction_max: Option<f64>,
    /// Largest force on the king pin in N.
    pub king_pin_force_max: Option<f64>,
    /// What the damper takes, the mean over a period in W: the heat in it.
    pub damper_power: Option<f64>,
}

impl WithoutCycles {
    /// What was found of one damper.
    pub(super) fn new(
        by_continuation: Option<f64>,
        decisive: bool,
        cycles: LargeCycles,
        at: Option<Conditions>,
        forces: Option<CycleForces>,
        kicked: Option<KickedWheels>,
    ) -> Self {
        let known =
            |value: fn(&CycleForces) -> f64| forces.as_ref().map(value).filter(|force| force.is_finite());
        let last_cycle = cycles.last.as_ref().map(|last| LastCycleResult {
            damping: last.damping,
            speed: last.speed,
            at,
            period: last.period,
            psi_min: last.angles[0],
            psi_max: last.angles[1],
            friction_max: known(|forces| forces.friction_max),
            king_pin_force_max: known(|forces| forces.king_pin_force_max),
            damper_power: known(|forces| forces.damper_power),
        });
        // A kick that is lost refutes what following cycles says.
        let damping = match &kicked {
            Some(kicked) if !kicked.ends.is_empty() => kicked.none_lost,
            _ => by_continuation,
        };
        Self {
            damping,
            by_continuation,
            decided_by_large_cycles: decisive,
            last_cycle,
            branches: cycles.branches,
            curves: cycles.curves,
            largest: cycles.largest,
            problems: cycles.problems,
            kicked,
        }
    }

    /// What is said of it.
    fn write(&self, (key, name): (Key, &str), ranges: &Ranges, out: &mut dyn Write) -> io::Result<()> {
        let quantity = |damping: f64| description::quantity(key, damping);
        match self.by_continuation {
            None => writeln!(
                out,
                "{name} alone: cycles with every damper that was tried, up to {}",
                quantity(self.largest)
            )?,
            Some(0.0) => writeln!(out, "{name} alone: none is needed, no large cycle was found")?,
            Some(damping) if !self.decided_by_large_cycles => {
                writeln!(out, "{name} alone: {} at least, no large cycle lasts longer", quantity(damping))?;
            }
            Some(damping) => writeln!(out, "{name} alone: {} at least", quantity(damping))?,
        }
        if let Some(last) = self
            .last_cycle
            .as_ref()
            .filter(|_| self.by_continuation.is_none() || self.decided_by_large_cycles)
        {
            write!(
                out,
                "  the last cycle: {}, psi from {} to {} rad, period {} s",
                ranges.place(last.speed, last.at),
                significant(last.psi_min, 4),
                significant(last.psi_max, 4),
                significant(last.period, 5)
            )?;
            if let (Some(force), Some(power)) = (last.king_pin_force_max, last.damper_power) {
                write!(
                    out,
                    ", king-pin force {} N, {} W in the damper",
                    significant(force, 3),
                    significant(power, 3)
                )?;
            }
            writeln!(out)?;
        }
        write!(
            out,
            "  {} of cycles and {} of folds were followed",
            counted(self.branches, "branch", "branches"),
            counted(self.curves, "curve", "curves")
        )?;
        if let Some(kicked) = &self.kicked {
            write!(out, "; {kicked}")?;
            match kicked.none_lost {
                _ if kicked.ends.is_empty() => {}
                Some(damping) => {
                    write!(out, "\n  so that is not enough: none does so with {}", quantity(damping))?
                }
                None => write!(
                    out,
                    "\n  so that is not enough: some do so with every stronger damper that was tried"
                )?,
            }
        }
        writeln!(out)?;
        for problem in &self.problems {
            writeln!(out, "  not followed: {problem}")?;
        }
        Ok(())
    }
}

/// What the dampers are for.
pub(super) const REQUIREMENT: &str = "no shimmy is born: the uniform motion is stable at every speed";

/// What is said where the lowest speed decides.
const SLOWER_MAY_TAKE_MORE: &str = ", the lowest speed that was looked at: lower ones may take more";

/// Pairs of dampers of which neither may be weaker.
#[derive(Debug, Default, Serialize)]
pub struct Front {
    /// Lateral ones, in N s/m.
    pub c_q: Vec<f64>,
    /// The least beside each about the king pin, in N m s/rad.
    pub c_psi: Vec<f64>,
}

/// The circles and loads for which dampers were asked.
struct Ranges {
    given: [(Key, Option<Range>); 2],
    /// Whether a load acts on motions that roll: without a tyre it enters friction only.
    loads_enter: bool,
}

impl Ranges {
    /// What is said of them in a heading.
    fn in_words(&self) -> String {
        let given = self.given.iter().filter_map(|(key, range)| Some((key, range.as_ref()?)));
        given.map(|(key, range)| format!(", {key} {range} {}", key.unit())).collect()
    }

    /// A speed and, over several circles and loads, one of them.
    fn place(&self, speed: f64, at: Option<Conditions>) -> String {
        let mut place = vec![description::quantity(Key::V, speed)];
        for (key, range) in &self.given {
            if let (Some(at), Some(_)) = (at, range)
                && (*key != Key::FAz || self.loads_enter)
            {
                let value = if *key == Key::TurningRadius { at.r } else { at.load };
                place.push(description::quantity(*key, value));
            }
        }
        place.join(", ")
    }
}

impl DamperResult {
    fn ranges(&self) -> Ranges {
        Ranges {
            given: [(Key::TurningRadius, self.radius.clone()), (Key::FAz, self.load.clone())],
            loads_enter: self.wheel.tyre() != Tyre::Rigid,
        }
    }

    /// The wheel's own dampers, which the ones that were found replace, in words; nothing where it has none.
    pub(crate) fn replaced_dampers(&self) -> Option<String> {
        let own =
            [Key::CQ, Key::CPsi].into_iter().zip(self.own_dampers).filter(|(_, damping)| *damping != 0.0);
        let own: Vec<String> = own.map(|(key, damping)| description::quantity(key, damping)).collect();
        (!own.is_empty()).then(|| own.join(" and "))
    }

    /// What dry friction does alone and beside the wheel's own dampers, in sentences that say which dampers are meant.
    fn with_dry_friction(&self, neglected: &NeglectedDryFriction) -> Vec<String> {
        let alone = neglected.in_sentences("with it and none of these dampers");
        let own = [Key::CQ, Key::CPsi].into_iter().zip(self.own_dampers);
        let mut damped = own.filter(|(_, damping)| *damping != 0.0);
        let damped = damped.try_fold(self.wheel, |wheel, (key, damping)| wheel.with(key, damping));
        let beside = self.replaced_dampers().zip(damped.ok()).and_then(|(own, wheel)| {
            let neglected = NeglectedDryFriction::of(&wheel, &[Key::V])?;
            neglected.speed_in_words(&format!("with it and the wheel's own, {own},"))
        });
        alone.into_iter().chain(beside).collect()
    }

    /// The dampers over which the lowest speed decides that was looked at.
    pub(crate) fn decided_by_the_slowest(&self) -> Vec<Key> {
        let decisive = [(Key::CQ, self.corner.c_q), (Key::CPsi, self.corner.c_psi)];
        let slowest = decisive.into_iter().filter_map(|(key, speed)| Some((key, speed?)));
        slowest.filter(|(_, speed)| is_slowest_speed(*speed, self.up_to)).map(|(key, _)| key).collect()
    }

    /// Keys of which the wheel's own values do not count.
    fn replaced(&self) -> Vec<Key> {
        let given = self.ranges().given.into_iter().filter(|(_, range)| range.is_some()).map(|(key, _)| key);
        [Key::V, Key::CQ, Key::CPsi].into_iter().chain(given).collect()
    }
}

impl Report for DamperResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.damper")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &self.replaced())
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let ranges = self.ranges();
        let wheel = description::on_lines(&self.wheel, &self.replaced());
        let up_to = readable(self.up_to);
        writeln!(out, "dampers for stability up to v = {up_to} m/s{} at {wheel}\n", ranges.in_words())?;
        if self.load.is_some() && !ranges.loads_enter {
            writeln!(
                out,
                "all loads alike: on the motions of a wheel that rolls no load acts without a tyre\n"
            )?;
        }
        if let Some(own) = self.replaced_dampers() {
            writeln!(out, "in place of the wheel's own, {own}, which are left out\n")?;
        }
        for (key, name, damping, speed, at) in [
            (Key::CQ, "lateral damper", self.c_q, self.corner.c_q, self.corner.c_q_at),
            (Key::CPsi, "damper about the king pin", self.c_psi, self.corner.c_psi, self.corner.c_psi_at),
        ] {
            match (damping, speed) {
                (None, _) => writeln!(out, "{name} alone: none was found that is enough")?,
                (Some(_), None) => writeln!(out, "{name} alone: none is needed")?,
                (Some(damping), Some(speed)) => writeln!(
                    out,
                    "{name} alone: {} at least; {} decides{}",
                    description::quantity(key, damping),
                    ranges.place(speed, at),
                    if is_slowest_speed(speed, self.up_to) { SLOWER_MAY_TAKE_MORE } else { "" }
                )?,
            }
        }
        if let Some(with) = self.with_longitudinal_damper {
            with.write(out)?;
        }
        if self.front.c_q.len() > 1 {
            writeln!(out, "\nboth together:\n")?;
            let mut table = Table::new(["c_q (N s/m)", "c_psi (N m s/rad)"]);
            for (c_q, c_psi) in self.front.c_q.iter().zip(&self.front.c_psi) {
                table.row([(*c_q).into(), (*c_psi).into()]);
            }
            table.write(out)?;
        }
        match &self.isola_free {
            None => writeln!(
                out,
                "\nsmall motions die out then; large cycles beside them (an isola) may take more and were not sought"
            )?,
            Some(isola_free) => {
                writeln!(
                    out,
                    "\nsmall motions die out then; that no large cycle is found beside them (an isola) takes\n"
                )?;
                for (key, name, found) in [
                    (Key::CQ, "lateral damper", &isola_free.c_q),
                    (Key::CPsi, "damper about the king pin", &isola_free.c_psi),
                ] {
                    if let Some(found) = found {
                        found.write((key, name), &ranges, out)?;
                    }
                }
                writeln!(out, "\nwhat was searched is no proof that there is none")?;
            }
        }
        let Some(neglected) = &self.dry_friction else { return Ok(()) };
        writeln!(out, "\n{}", neglected.in_words())?;
        self.with_dry_friction(neglected).iter().try_for_each(|sentence| writeln!(out, "{sentence}"))
    }

    fn columns(&self) -> Columns {
        Columns::new()
            .numbers("c_q", self.front.c_q.iter().copied())
            .unit("N s/m")
            .numbers("c_psi", self.front.c_psi.iter().copied())
            .unit("N m s/rad")
    }
}
