//! What follows from estimated parameters, with what is left uncertain of it: the critical speeds, and the largest blow that is
//! safe.
//!
//! Critical speeds are cheap, so their intervals are those of their profile: all parameters are fitted again with the speed held. A safe
//! blow takes many motions; its interval is that of the delta method, with differences over the whole intervals of the parameters in
//! place of derivatives.

use crate::classification::{Classification, Contact};
use crate::disturbance::DisturbanceRequest;
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::identification::{ConsequenceInterval, Identification, Identified, JointDistribution};
use kingpin::parallel;
use kingpin::simulation::SimulationError;
use kingpin::{Key, Tyre, Wheel};
use serde::Serialize;

/// Part of a speed by which it is left on either side.
const ASIDE: f64 = 1e-6;

/// Something that follows from the parameters, with its 95 per cent interval.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Consequence {
    /// Its value for the estimates; nothing where there is none.
    pub value: Option<f64>,
    /// Lower end of its interval; nothing where it is unknown.
    pub lower: Option<f64>,
    /// Upper end of its interval; nothing where it is unknown, or where there may be no such value.
    pub upper: Option<f64>,
    /// `profile` or `differences`; nothing without an interval.
    pub method: Option<&'static str>,
    /// Part of the wheels drawn from the joint distribution of the estimates which have no such value, being stable at all speeds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without: Option<f64>,
}

/// What follows from the estimates.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Consequences {
    /// Largest speed in m/s up to which the uniform motion is stable, from standstill on; 0 where it is unstable from there.
    pub critical_speed: Consequence,
    /// Smallest speed in m/s beyond which small motions grow in spite of dry friction about the king pin, whatever its moment; only
    /// in straight towing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub critical_speed_with_friction: Option<Consequence>,
    /// Largest blow in N s from which the wheel returns, in the direction in which fewer return, at the speed of the wheel: the last before the first that
    /// does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub safe_blow: Option<Consequence>,
    /// Why no blow could be told.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub safe_blow_failure: Option<String>,
    /// `rolling` or `sliding`: how the wheel goes on after a blow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact: Option<&'static str>,
    /// Largest blow in N s that was tried.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_blow: Option<f64>,
}

impl Consequences {
    /// Those of estimates for a wheel that has them.
    ///
    /// # Errors
    /// A motion that cannot be followed, an interruption.
    pub(super) fn of(
        identification: &Identification,
        identified: &Identified,
        wheel: &Wheel,
        with_blow: bool,
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let distribution = identified.distribution.as_ref();
        let by_profile = |of: &(dyn Fn(&Wheel) -> f64 + Sync)| -> Result<Consequence, Error> {
            let interval = identification.interval_of(identified, wheel, of, &control.quiet())?;
            Ok(from_profile(of(wheel), interval))
        };
        let critical_speed = by_profile(&critical_speed)?;
        control.done(0.1);
        let has_friction =
            wheel.get(Key::MF) > 0.0 || identified.estimates.iter().any(|estimate| estimate.key == Key::MF);
        let is_straight = wheel.get(Key::TurningRadius).is_infinite() && wheel.tyre() == Tyre::Rigid;
        let with_friction = |wheel: &Wheel| wheel.critical_speed_with_friction().unwrap_or(f64::INFINITY);
        let critical_speed_with_friction =
            (has_friction && is_straight).then(|| by_profile(&with_friction)).transpose()?;
        control.done(0.2);
        let takes_blow = with_blow
            && wheel.tyre() == Tyre::Rigid
            && wheel.get(Key::V) > 0.0
            && wheel.uniform_motion().is_ok();
        let contact = Classification::default().contact_by_load(wheel);
        let largest = DisturbanceRequest::default().largest(wheel);
        let disturbance = DisturbanceRequest { largest: Some(largest), ..DisturbanceRequest::default() };
        let rest = control.part(0.2..1.0);
        let blow = takes_blow.then(|| safe_blow(wheel, &disturbance, contact, distribution, &rest));
        let (blow, blow_failure) = match blow {
            // What the records say stands, whatever becomes of a wheel that is hit.
            Some(Err(error)) if !matches!(error, Error::Stopped) => (None, Some(error.to_string())),
            blow => (blow.transpose()?, None),
        };
        Ok(Self {
            critical_speed,
            critical_speed_with_friction,
            largest_blow: blow.as_ref().map(|_| largest),
            contact: blow.as_ref().map(|_| contact.model().name()),
            safe_blow: blow,
            safe_blow_failure: blow_failure,
        })
    }
}

/// The speed up to which the motion is stable: infinite where it is stable at all speeds, zero where it is unstable from standstill on.
fn critical_speed(wheel: &Wheel) -> f64 {
    let is_stable = |wheel: &Wheel| wheel.uniform_motion().ok().and_then(|motion| motion.is_stable());
    match wheel.critical_speed() {
        // Where stability is regained it is missing below.
        Some(critical) => match wheel.with(Key::V, critical.speed * (1.0 - ASIDE)) {
            Ok(slower) if is_stable(&slower) == Some(false) => 0.0,
            _ => critical.speed,
        },
        None if is_stable(wheel) == Some(false) => 0.0,
        None => f64::INFINITY,
    }
}

fn from_profile(value: f64, interval: Option<ConsequenceInterval>) -> Consequence {
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    Consequence {
        value: finite(value),
        lower: interval.and_then(|interval| finite(interval.lower)),
        upper: interval.and_then(|interval| finite(interval.upper)),
        method: interval.map(|_| "profile"),
        without: interval.map(|interval| interval.without),
    }
}

/// The largest blow that returned, in the direction in which fewer do; nothing where all that were tried return, and where a wheel that
/// may slide has no uniform motion to return to.
fn largest_returning(
    wheel: &Wheel,
    disturbance: &DisturbanceRequest,
    contact: Contact,
    control: &Control<'_>,
) -> Result<Option<f64>, Error> {
    let settings = Classification::default().settings(wheel)?;
    let edges = match disturbance.edges(wheel, contact.model(), settings, control) {
        Ok(edges) => edges,
        Err(SimulationError::UniformMotionSlides { .. }) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let edges = edges.into_iter().flatten().filter(|edge| !edge.is_undecided());
    Ok(edges.map(|edge| edge.returns.abs()).min_by(f64::total_cmp))
}

fn safe_blow(
    wheel: &Wheel,
    disturbance: &DisturbanceRequest,
    contact: Contact,
    distribution: Option<&JointDistribution>,
    control: &Control<'_>,
) -> Result<Consequence, Error> {
    let pairs = distribution.map(|distribution| distribution.pairs(wheel)).unwrap_or_default();
    let wheels: Vec<Wheel> = std::iter::once(*wheel).chain(pairs.iter().flatten().copied()).collect();
    let counter = control.count(wheels.len());
    let blows: Vec<Option<f64>> = parallel::try_map(&wheels, |wheel| {
        let blow = largest_returning(wheel, disturbance, contact, &control.quiet());
        counter.advance(1);
        blow
    })?;
    let value = blows[0];
    let mut consequence = Consequence { value, lower: None, upper: None, method: None, without: None };
    let all: Option<Vec<f64>> = blows.into_iter().collect();
    if let (Some(value), Some(all)) = (value, all.filter(|_| !pairs.is_empty())) {
        let (mut below, mut above) = (0.0_f64, 0.0_f64);
        for pair in all[1..].chunks_exact(2) {
            let changes = [pair[0] - value, pair[1] - value];
            below += changes.iter().fold(0.0_f64, |most, change| most.min(*change)).powi(2);
            above += changes.iter().fold(0.0_f64, |most, change| most.max(*change)).powi(2);
        }
        consequence.lower = Some((value - below.sqrt()).max(0.0));
        consequence.upper = Some(value + above.sqrt());
        consequence.method = Some("differences");
    }
    Ok(consequence)
}
