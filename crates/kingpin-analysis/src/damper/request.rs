//! What the smallest dampers are asked for by, and how they are found.

use super::condition::Range;
use super::kicks::kick;
use super::large_cycles::{LargeCycles, LastCycle};
use super::result::{
    Conditions, Corner, DamperResult, Front, IsolaFree, REQUIREMENT, WithLongitudinalDamper, WithoutCycles,
};
use crate::error::Error;
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::up_to;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Assignment, Control};
use kingpin::branches::Along;
use kingpin::{Condition, Key, SmallestDamper, Tyre, Wheel};
use serde::{Deserialize, Serialize};

/// What the search for what small motions take is of the whole time, roughly.
const PART_OF_SMALL_MOTIONS: f64 = 0.1;
/// What the search for large cycles is of the whole time in which one damper is looked at.
const PART_OF_CYCLES: f64 = 0.3;
/// Dampers on the front between the lateral and the rotational one.
const FRONT: usize = 9;
/// The most, with those between them where the front is bent.
const MOST_ON_FRONT: usize = 24;
/// It is bent where it is farther than this part of its larger neighbour from the line between the two.
const BENT: f64 = 0.2;
/// The slight longitudinal damper that is tried on circles, as a part of the critical damping of the wheel's mass on its spring.
const SLIGHT: f64 = 1e-3;
/// Part by which it has to change the others to be told.
const CHANGED: f64 = 0.3;

/// The smallest dampers with which no shimmy is born up to a speed, on all of some circles and under all of some loads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DamperRequest {
    /// Which wheel; its own `c_q` and `c_psi` do not count.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// The speed, `v=3`.
    pub up_to: Assignment,
    /// The radii in place of the wheel's own.
    #[serde(default)]
    pub radius: Option<Range>,
    /// The loads `F_Az` in place of the wheel's own.
    #[serde(default)]
    pub load: Option<Range>,
    /// Only what small motions take: no large cycles are sought.
    #[serde(default)]
    pub small_motions: bool,
}

impl DamperRequest {
    /// For the wheel's own radius and load, large cycles too.
    pub fn new(wheel: WheelRequest, up_to: Assignment) -> Self {
        Self { wheel, up_to, radius: None, load: None, small_motions: false }
    }

    /// Computes them.
    ///
    /// # Errors
    /// What is wrong with the wheel, the speed, the radii or the loads; an interruption.
    pub fn run(&self, control: &Control<'_>) -> Result<DamperResult, Error> {
        let given = self.wheel.read()?;
        let own_dampers = [Key::CQ, Key::CPsi].map(|key| given.get(key));
        let mut wheel = given.with(Key::CQ, 0.0)?.with(Key::CPsi, 0.0)?;
        let up_to = up_to::speed(&wheel, &self.up_to)?;
        let mut conditions = Vec::new();
        let given: [(_, _, &'static [&'static str]); 2] =
            [(&self.radius, Key::TurningRadius, &["radius"]), (&self.load, Key::FAz, &["load"])];
        for (range, key, field) in given {
            if let Some(range) = range {
                let condition = range.of(key, field, &wheel)?;
                if let Some(first) = condition.extremes().first() {
                    wheel = wheel.with(key, *first)?;
                }
                conditions.push(condition);
            }
        }
        // The kicks, too, are those of the wheel that small motions and cycles are of.
        let sizing = Sizing { wheel: wheel.with(Key::MF, 0.0)?, up_to, conditions };
        let sized = sizing.wheel;
        let part = if self.small_motions { 1.0 } else { PART_OF_SMALL_MOTIONS };
        let small = &control.part(0.0..part);
        let lateral = sizing.alone(&sized, Key::CQ, &small.part(0.0..0.1))?;
        let rotational = sizing.alone(&sized, Key::CPsi, &small.part(0.1..0.2))?;
        let with_longitudinal_damper =
            sizing.with_longitudinal_damper([lateral, rotational], &small.part(0.2..0.3))?;
        let front = sizing.front(lateral, &small.part(0.3..1.0))?;
        let isola_free = match self.small_motions {
            true => None,
            false => {
                let middle = 0.5 * (PART_OF_SMALL_MOTIONS + 1.0);
                let part = |range| control.part(range);
                Some(IsolaFree {
                    c_q: sizing.without_cycles(Key::CQ, lateral, &part(PART_OF_SMALL_MOTIONS..middle))?,
                    c_psi: sizing.without_cycles(Key::CPsi, rotational, &part(middle..1.0))?,
                })
            }
        };
        let [c_q, c_psi] = [lateral, rotational].map(|damper| damper.map(|damper| damper.damping));
        let speed = |damper: Option<SmallestDamper>| damper.and_then(|damper| damper.speed);
        Ok(DamperResult {
            requirement: REQUIREMENT,
            own_dampers,
            up_to,
            c_q,
            c_psi,
            corner: Corner {
                c_q: speed(lateral),
                c_psi: speed(rotational),
                c_q_at: sizing.decides(lateral),
                c_psi_at: sizing.decides(rotational),
            },
            with_longitudinal_damper,
            front,
            isola_free,
            dry_friction: NeglectedDryFriction::of(&wheel, &[Key::V]),
            wheel,
            radius: self.radius.clone(),
            load: self.load.clone(),
        })
    }
}

/// Where a curve of points with ascending abscissae needs one more: in the middle of the wider interval beside the point at which it is
/// bent most; nothing where it is bent nowhere.
fn bent(points: &[[f64; 2]]) -> Option<f64> {
    let bend = |[before, here, after]: [[f64; 2]; 3]| {
        let part = (here[0] - before[0]) / (after[0] - before[0]);
        let chord = before[1] + part * (after[1] - before[1]);
        (here[1] - chord).abs() / before[1].max(after[1])
    };
    let triples = points.windows(3).map(|window| [window[0], window[1], window[2]]);
    let bends = triples.map(|triple| (bend(triple), triple)).filter(|(bend, _)| *bend > BENT);
    let (_, [before, here, after]) = bends.max_by(|one, other| one.0.total_cmp(&other.0))?;
    // Next to the steep side, where the ordinates differ most.
    let steep_before = (before[1] - here[1]).abs() > (here[1] - after[1]).abs();
    let [from, to] = if steep_before { [before[0], here[0]] } else { [here[0], after[0]] };
    Some(0.5 * (from + to))
}

/// What dampers are sized for.
struct Sizing {
    /// Without a damper, at the first of the radii and loads.
    wheel: Wheel,
    up_to: f64,
    conditions: Vec<Condition>,
}

impl Sizing {
    /// Conditions that the equations of rolling motion know of: a load only through the limit of a brush tyre.
    fn of_small_motions(&self) -> Vec<Condition> {
        let counts = |condition: &&Condition| condition.key() != Key::FAz || self.wheel.tyre() == Tyre::Brush;
        self.conditions.iter().filter(counts).cloned().collect()
    }

    /// The smallest of one damper beside what the wheel has of the other.
    fn alone(&self, wheel: &Wheel, key: Key, control: &Control<'_>) -> Result<Option<SmallestDamper>, Error> {
        Ok(wheel.smallest_damper_over(key, self.up_to, &self.of_small_motions(), control)?)
    }

    /// The dampers beside a slight longitudinal one, where they are others on circles on which nothing damps the longitudinal motion: turning
    /// makes that grow or decay, slowly on wide circles, and dampers of the caster hardly matter to it.
    fn with_longitudinal_damper(
        &self,
        without: [Option<SmallestDamper>; 2],
        control: &Control<'_>,
    ) -> Result<Option<WithLongitudinalDamper>, Error> {
        let wheel = &self.wheel;
        let turns = wheel.get(Key::Curvature) != 0.0
            || self.conditions.iter().any(|condition| condition.key() == Key::TurningRadius);
        let is_undamped = wheel.get(Key::CU) == 0.0 && wheel.get(Key::KU).is_finite();
        if !turns || !is_undamped || wheel.tyre() != Tyre::Rigid {
            return Ok(None);
        }
        let c_u = SLIGHT * 2.0 * (wheel.get(Key::KU) * wheel.mass()).sqrt();
        let damped = wheel.with(Key::CU, c_u)?;
        let [lateral, rotational] =
            [Key::CQ, Key::CPsi].map(|key| self.alone(&damped, key, &control.quiet()));
        let with = [lateral?, rotational?];
        let differs = |(with, without): (&Option<SmallestDamper>, &Option<SmallestDamper>)| {
            let [with, without] = [with, without].map(|damper| damper.map(|damper| damper.damping));
            match (with, without) {
                (Some(with), Some(without)) => (with - without).abs() > CHANGED * with.max(without),
                (with, without) => with != without,
            }
        };
        let [c_q, c_psi] = with.map(|damper| damper.map(|damper| damper.damping));
        let is_told = with.iter().zip(&without).any(differs);
        Ok(is_told.then_some(WithLongitudinalDamper { c_u, c_q, c_psi }))
    }

    /// The least damper about the king pin beside parts of the lateral one that is enough alone: evenly spaced ones, and more where the
    /// least damper is far from the line between those beside it.
    fn front(&self, lateral: Option<SmallestDamper>, control: &Control<'_>) -> Result<Front, Error> {
        let mut front = Front::default();
        let Some(SmallestDamper { damping, .. }) = lateral else { return Ok(front) };
        let beside = |part: f64, control: &Control<'_>| match part {
            1.0 => Ok(Some(0.0)),
            part => {
                let damped = self.wheel.with(Key::CQ, part * damping)?;
                Ok::<_, Error>(self.alone(&damped, Key::CPsi, control)?.map(|damper| damper.damping))
            }
        };
        let count = if damping > 0.0 { FRONT } else { 1 };
        let mut points: Vec<[f64; 2]> = Vec::new();
        for index in 0..count {
            let part = index as f64 / (FRONT - 1) as f64;
            let c_psi = beside(part, &control.part(part..(part + 0.1).min(1.0)))?;
            points.extend(c_psi.map(|c_psi| [part, c_psi]));
        }
        while let Some(part) = bent(&points).filter(|_| points.len() < MOST_ON_FRONT) {
            let Some(c_psi) = beside(part, &control.quiet())? else { break };
            points.push([part, c_psi]);
            points.sort_by(|one, other| one[0].total_cmp(&other[0]));
        }
        for [part, c_psi] in points {
            front.c_q.push(part * damping);
            front.c_psi.push(c_psi);
        }
        Ok(front)
    }

    /// Where a damper is decided; nothing where there is one radius and one load, or where none is needed.
    fn decides(&self, damper: Option<SmallestDamper>) -> Option<Conditions> {
        let corner = damper?.corner?;
        (!self.conditions.is_empty()).then(|| Conditions::of(&corner))
    }

    /// The wheels at the ends of all intervals and at all values, and the one that decides over small motions.
    fn extremes(&self, decisive: Option<Wheel>, all: bool) -> Result<Vec<Wheel>, Error> {
        let mut wheels = vec![self.wheel];
        let conditions = if all { self.conditions.clone() } else { self.of_small_motions() };
        for condition in conditions {
            let mut more = Vec::new();
            for wheel in &wheels {
                for value in condition.extremes() {
                    more.push(wheel.with(condition.key(), value)?);
                }
            }
            wheels = more;
        }
        if let Some(corner) = decisive {
            let same = |wheel: &Wheel| {
                [Key::Curvature, Key::FAz].iter().all(|key| wheel.get(*key) == corner.get(*key))
            };
            if !wheels.iter().any(same) {
                let at = self.wheel.with(Key::Curvature, corner.get(Key::Curvature))?;
                wheels.push(at.with(Key::FAz, corner.get(Key::FAz))?);
            }
        }
        Ok(wheels)
    }

    /// The damper alone with which no large cycle was found either; nothing where none is enough for small motions. Cycles are sought on the
    /// circles at the ends of the range and on the decisive one, the last fold is followed over the others, and the wheel is kicked there.
    fn without_cycles(
        &self,
        key: Key,
        needed: Option<SmallestDamper>,
        control: &Control<'_>,
    ) -> Result<Option<WithoutCycles>, Error> {
        let Some(SmallestDamper { damping: needed, corner, .. }) = needed else { return Ok(None) };
        let (up_to, seek) = (self.up_to, control.part(0.0..PART_OF_CYCLES));
        let wheels = self.extremes(corner, false)?;
        let mut cycles = LargeCycles::default();
        for (index, wheel) in wheels.iter().enumerate() {
            let part = |index: usize| index as f64 / wheels.len() as f64;
            let seek = seek.part(part(index)..part(index + 1));
            // What the small motions of this one take.
            let own = if wheels.len() == 1 {
                needed
            } else {
                wheel.smallest_damper(key, up_to, &seek.quiet())?.map_or(needed, |damper| damper.damping)
            };
            cycles = cycles.and(LargeCycles::seek(wheel, key, [own, up_to], &seek)?);
        }
        let mut variables = Vec::new();
        for condition in self.of_small_motions() {
            if let Condition::Interval(along) = condition {
                let (from, to) = along.ends();
                variables.push(match along.key() {
                    Key::TurningRadius => Along::new(Key::Curvature, to.recip(), from.recip())?,
                    key => Along::new(key, from, to)?,
                });
            }
        }
        if !variables.is_empty() {
            cycles = cycles.followed_along(&variables, key, up_to, &seek.quiet())?;
        }
        let forces = cycles.last.as_ref().map(LastCycle::forces).transpose()?;
        let last = cycles.last.as_ref().map_or(0.0, |last| last.damping);
        let by_continuation = (!cycles.at_every_damper).then(|| needed.max(last));
        let decisive = last > needed;
        let worst = if decisive { cycles.last.as_ref().map(|last| last.wheel) } else { corner };
        let kicked = match by_continuation {
            Some(damping) => {
                let wheels = self.extremes(worst, true)?;
                kick(&wheels, key, [damping, up_to], &control.part(PART_OF_CYCLES..1.0))?
            }
            None => None,
        };
        let at = cycles.last.as_ref().filter(|_| !self.conditions.is_empty());
        let at = at.map(|last| Conditions::of(&last.wheel));
        Ok(Some(WithoutCycles::new(by_continuation, decisive, cycles, at, forces, kicked)))
    }
}
