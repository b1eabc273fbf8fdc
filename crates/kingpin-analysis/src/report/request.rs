//! What a report is asked for by, and how it is computed and written.

use super::families::Family;
use super::finding::Finding;
use super::found::Found;
use super::illustration::{Illustration, Pictures};
use super::page::page;
use super::result::ReportResult;
use super::rolling::Motions;
use super::shimmy::{self, Searched};
use super::speeds::Speeds;
use super::verdict::{Verdict, sentence};
use super::{blow, cycles, dampers, limits, margin};
use crate::chart::ChartRequest;
use crate::classification::{Classification, Contact, may_slide};
use crate::damper::DamperResult;
use crate::error::{Error, unless_stopped};
use crate::folder;
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::page::{PageFigure, prose};
use crate::parameters::{doubts, lifted};
use crate::up_to;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Assignment, Control, SampledInterval};
use kingpin::parallel;
use kingpin::{Key, Tyre, Wheel};
use kingpin_report::numbers::{readable, significant};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::PathBuf;

/// The report looks at speeds up to so many times that of the wheel, where nothing else is asked for; farther, beyond the critical speed,
/// where that is not too far.
const SPEEDS: f64 = 2.0;
const FARTHEST: f64 = 5.0;
/// Radius in m of the circle on which a wheel is looked at that is towed straight otherwise.
const CIRCLE: f64 = 2.0;
/// Caster lengths of the chart, as parts of that of the wheel; where a longer one is stable straight at every speed, up to that.
const LENGTHS: [f64; 2] = [0.1, 3.0];
const BEYOND_CRITICAL: f64 = 1.2;
/// The longest caster of the chart, as part of that of the wheel.
const LONGEST: f64 = 20.0;
/// Points of the chart along each axis.
const CHART: [usize; 2] = [160, 120];
/// Parts of the time that the subjects take, roughly.
const MOTIONS: Range<f64> = 0.0..0.01;
const CHARTED: Range<f64> = 0.01..0.1;
const DAMPED: Range<f64> = 0.1..0.2;
const FOLLOWED: Range<f64> = 0.2..0.25;
const SHIMMIED: Range<f64> = 0.25..0.45;
const STRUCK: Range<f64> = 0.45..0.7;
const STRUCK_ALONG: Range<f64> = 0.7..1.0;

/// A report on a wheel: its stability straight and on a circle, where it rolls, its limit cycles, the smallest blow from which it
/// does not return, and the dampers that it takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ReportRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// The largest speed that is looked at, `v=3`. Where it is not given, twice that of the wheel, or more if the critical speed is in
    /// reach.
    pub up_to: Option<Assignment>,
    /// The folder for the files; it is created where it is missing.
    pub out: PathBuf,
}

impl Default for ReportRequest {
    fn default() -> Self {
        Self { wheel: WheelRequest::default(), up_to: None, out: "report".into() }
    }
}

/// A request that makes sense, with its wheel.
#[derive(Clone, Debug)]
pub struct ReportAnalysis {
    request: ReportRequest,
    wheel: Wheel,
    fastest: f64,
}

impl ReportRequest {
    /// Reads the wheel and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel or the speed.
    pub fn validate(&self) -> Result<ReportAnalysis, Error> {
        let wheel = self.wheel.read()?;
        let speed = wheel.get(Key::V);
        let fastest = match &self.up_to {
            None => {
                let critical =
                    wheel.critical_speed().map_or(0.0, |critical| BEYOND_CRITICAL * critical.speed);
                let farthest = if critical <= FARTHEST * speed { critical } else { 0.0 };
                rounded(farthest.max(SPEEDS * speed))
            }
            Some(given) => up_to::speed(&wheel, given)?,
        };
        if fastest < speed || fastest <= 0.0 {
            let allowed = format!("at least the wheel's own, {} m/s, and above 0", readable(speed));
            return Err(Error::invalid(&["up_to"], readable(fastest), "slower than the wheel", allowed));
        }
        Ok(ReportAnalysis { request: self.clone(), wheel, fastest })
    }
}

/// A number with two digits.
fn rounded(value: f64) -> f64 {
    let unit = 10_f64.powf(value.log10().floor() - 1.0);
    (value / unit).round() * unit
}

impl ReportAnalysis {
    /// What was found of the wheel without its dry friction about the king pin, which says so.
    fn without_dry_friction(&self, found: Found) -> Found {
        let Some(neglected) = NeglectedDryFriction::of(&self.wheel, &[Key::V]) else { return found };
        let sentence = sentence(&neglected.in_words());
        let findings = found.findings.into_iter().map(|finding| finding.and(&sentence));
        let illustrations = found.illustrations.into_iter().map(|illustration| Illustration {
            caption: format!("{} {}", illustration.caption, prose(&sentence)),
            ..illustration
        });
        Found { findings: findings.collect(), illustrations: illustrations.collect() }
    }

    /// Computes everything and writes nothing.
    ///
    /// # Errors
    /// [`Error::Stopped`]. What cannot be computed is said among the findings.
    pub fn find(&self, control: &Control<'_>) -> Result<ReportResult, Error> {
        let Found { findings, .. } = self.compute(control)?;
        Ok(ReportResult { wheel: self.wheel, up_to: self.fastest, findings, files: Vec::new() })
    }

    /// Computes everything and writes it when all is ready. What cannot be computed is said in the report.
    ///
    /// # Errors
    /// The files cannot be written; [`Error::Stopped`]. Then no file was written.
    pub fn run(&self, control: &Control<'_>) -> Result<ReportResult, Error> {
        folder::prepare(&self.request.out)?;
        let found = self.compute(control)?;
        let pictures: Vec<Pictures> = parallel::try_map(&found.illustrations, Illustration::pictures)?;
        let numbered = || (1_u8..).zip(found.illustrations.iter().zip(&pictures));
        let figures: Vec<PageFigure> = numbered()
            .map(|(number, (illustration, pictures))| PageFigure {
                number,
                svg: &pictures.svg,
                caption: &illustration.caption,
            })
            .collect();
        let page = page(&self.name(), &self.wheel, &found.findings, &figures);
        let mut contents = vec![("report.html".to_owned(), page.into_bytes())];
        for (number, Pictures { svg, png, pdf, csv }) in (1_u8..).zip(pictures) {
            let name = |ending: &str| format!("figure{number}.{ending}");
            contents.push((name("svg"), svg.into_bytes()));
            contents.push((name("png"), png));
            contents.push((name("pdf"), pdf));
            contents.push((name("csv"), csv));
        }
        let files = folder::write(&self.request.out, &contents)?;
        Ok(ReportResult { wheel: self.wheel, up_to: self.fastest, findings: found.findings, files })
    }

    fn compute(&self, control: &Control<'_>) -> Result<Found, Error> {
        let own_radius = self.wheel.get(Key::TurningRadius);
        let speed = self.wheel.get(Key::V);
        let radius = if own_radius.is_finite() { own_radius } else { CIRCLE };
        let straight = "straight".to_owned();
        let circle = format!("r = {} m", readable(radius));
        let own = if own_radius.is_finite() { &circle } else { &straight };
        let mut found = Found::default();
        let mut verdict = Verdict::default();
        let mut stable_here = None;
        let mut stable_speeds = None;
        let mut hopf_points = Vec::new();
        for (subject, radius) in [(&straight, f64::INFINITY), (&circle, radius)] {
            let speeds = self.speeds(radius, &control.part(MOTIONS));
            if let Ok(speeds) = &speeds {
                if radius == own_radius {
                    stable_here = speeds.at(speed);
                    stable_speeds = speeds.first_stable();
                    hopf_points = speeds.hopf_points();
                }
                if radius.is_infinite() {
                    verdict.straight = Some(self.straight(speeds, control)?);
                } else if radius == own_radius {
                    verdict.circle = Some(format!("at {circle} {}", speeds.in_short()));
                }
            }
            let speeds =
                speeds.map(|speeds| Found::new(speeds.finding(format!("stability, {subject}")), None));
            found.take(
                &format!("stability, {subject}"),
                speeds.map(|speeds| self.without_dry_friction(speeds)),
            )?;
        }
        let dry = self
            .with_dry_friction(own)
            .map(|finding| Found { findings: finding.into_iter().collect(), illustrations: Vec::new() });
        verdict.dry_friction = self.dry_friction_in_short()?;
        found.take("dry friction", dry)?;
        // What is said of a wheel on which nothing presses comes first, and so do numbers that no wheel has.
        let doubts = doubts(&self.wheel, &[]);
        let lifted = lifted(&self.wheel, &[]);
        verdict.lifted = lifted.clone();
        let told = doubts.iter().chain(&lifted).map(|doubt| sentence(doubt)).collect::<Vec<_>>().join(" ");
        if !told.is_empty() {
            found
                .findings
                .insert(0, Finding::new("the numbers of the wheel", told, "").undecided_if(lifted.is_some()));
        }
        let subject = format!("rolling, {circle}");
        let rolling = self.with_radius(radius).and_then(|wheel| Motions::compute(&wheel, self.fastest));
        if lifted.is_none() {
            verdict.rolling = rolling.as_ref().ok().map(Motions::in_short);
            let rolling =
                rolling.map(|motions| Found::new(motions.finding(subject.clone()), [motions.illustration()]));
            found.take(&subject, rolling.map(|rolling| self.without_dry_friction(rolling)))?;
        }
        let chart = self.chart(own_radius, &control.part(CHARTED));
        found.take("chart", chart.map(|chart| self.without_dry_friction(chart)))?;
        let turns = own_radius.is_finite();
        let subject = "dampers, straight";
        let damped = dampers::seek(&self.request_at(f64::INFINITY), self.fastest, &control.part(DAMPED));
        let large_cycles = self.search_for_large_cycles(damped.as_ref().ok(), stable_here);
        verdict.dampers = damped
            .as_ref()
            .ok()
            .map(|dampers| dampers::in_short(dampers, turns.then_some(straight.as_str())));
        let damped = damped.map(|dampers| {
            self.without_dry_friction(Found::new(
                dampers::finding(subject.to_owned(), &dampers),
                dampers::illustration(&dampers),
            ))
        });
        found.take(subject, damped)?;
        if turns {
            // Straight towing says little of what it takes on the wheel's own circle; small motions there are quickly looked at.
            let subject = format!("dampers, {circle}");
            let damped = dampers::seek_for_small_motions(&self.request.wheel, self.fastest, &control.quiet());
            verdict.dampers_on_circle =
                damped.as_ref().ok().map(|dampers| dampers::in_short(dampers, Some(&format!("at {circle}"))));
            let damped = damped.map(|dampers| {
                self.without_dry_friction(Found::new(dampers::finding(subject.clone(), &dampers), None))
            });
            found.take(&subject, damped)?;
        }
        let subject = format!("limit cycles, {own}");
        let followed =
            self.cycles(&subject, (stable_here, &hopf_points), large_cycles, &control.part(FOLLOWED));
        found.take(&subject, followed.map(|cycles| self.without_dry_friction(cycles)))?;
        unless_stopped(control)?;
        self.families(own, &mut found, control)?;
        let subject = format!("shimmy, {own}");
        let stable = (stable_here, stable_speeds);
        let shimmy = self.shimmy(&subject, stable, &mut verdict, &control.part(SHIMMIED));
        found.take(&subject, shimmy)?;
        let subject = format!("blow, {own}");
        let blow = self.blow(&subject, stable_here, &mut verdict, &control.part(STRUCK));
        found.take(&subject, blow)?;
        let subject = format!("blow over the speed, {own}");
        found.take(&subject, self.margin(&subject, stable_speeds, &control.part(STRUCK_ALONG)))?;
        found.findings.insert(0, verdict.finding());
        Ok(found)
    }

    /// The stability on a circle over the speed.
    fn speeds(&self, radius: f64, control: &Control<'_>) -> Result<Speeds, Error> {
        Speeds::follow(&self.with_radius(radius)?, self.fastest, control)
    }

    /// The stability in straight towing in a few words, without the wheel's dampers and with them.
    fn straight(&self, speeds: &Speeds, control: &Control<'_>) -> Result<String, Error> {
        let dampers = [Key::CU, Key::CQ, Key::CPsi];
        let with = speeds.in_short();
        if dampers.iter().all(|key| self.wheel.get(*key) == 0.0) {
            return Ok(format!("straight: {with} without damper"));
        }
        let undamped = dampers
            .into_iter()
            .try_fold(self.with_radius(f64::INFINITY)?, |wheel, key| wheel.with(key, 0.0))
            .map_err(Error::from);
        match undamped.and_then(|wheel| Speeds::follow(&wheel, self.fastest, &control.quiet())) {
            Ok(without) => Ok(format!("straight: {} without damper; {with} with yours", without.in_short())),
            Err(Error::Stopped) => Err(Error::Stopped),
            // A motion that cannot be followed without dampers is one that nobody asked for.
            Err(_) => Ok(format!("straight: {with} with your damper")),
        }
    }

    /// What the wheel's own dry friction about the king pin makes of small motions in straight towing, in a few words.
    fn dry_friction_in_short(&self) -> Result<Option<String>, Error> {
        if self.wheel.tyre() != Tyre::Rigid || self.wheel.get(Key::MF) == 0.0 {
            return Ok(None);
        }
        let wheel = self.with_radius(f64::INFINITY)?;
        if wheel.swing_factor().is_none() {
            return Ok(None);
        }
        Ok(Some(match wheel.critical_speed_with_friction() {
            Some(0.0) => "small motions grow in spite of your dry friction".to_owned(),
            Some(speed) => {
                format!("with your dry friction small motions die out up to {} m/s", significant(speed, 4))
            }
            None => "with your dry friction small motions die out at every speed".to_owned(),
        }))
    }

    /// The wheel on another circle.
    fn with_radius(&self, radius: f64) -> Result<Wheel, Error> {
        Ok(self.wheel.with(Key::TurningRadius, radius)?)
    }

    /// The request for the wheel on another circle.
    fn request_at(&self, radius: f64) -> WheelRequest {
        let mut request = self.request.wheel.clone();
        let value = if radius.is_infinite() { "inf".to_owned() } else { radius.to_string() };
        request.set.push(Assignment { key: Key::TurningRadius.name().to_owned(), value });
        request
    }

    /// What dry friction about the king pin makes of small motions: without a tyre however little, and in straight towing, for which there is
    /// a closed form; with one that of the wheel.
    fn with_dry_friction(&self, own: &str) -> Result<Option<Finding>, Error> {
        if self.wheel.tyre() != Tyre::Rigid {
            return self.resting_with_tyre(own);
        }
        let wheel = self.with_radius(f64::INFINITY)?;
        let Some(factor) = wheel.swing_factor() else { return Ok(None) };
        let text = match wheel.critical_speed_with_friction() {
            Some(0.0) => {
                "Small motions grow at every speed even with dry friction about the king pin.".to_owned()
            }
            Some(speed) => format!(
                "With dry friction about the king pin, however little, small motions die out up to {} m/s.",
                readable(speed)
            ),
            None => {
                "With dry friction about the king pin, however little, small motions die out at every speed."
                    .to_owned()
            }
        };
        let check = format!(
            "At the wheel's own speed each swing multiplies a small caster angle by {} (absolute value below 1: it dies out).",
            readable(factor)
        );
        Ok(Some(Finding::new("dry friction, straight", text, check)))
    }

    /// Where the wheel with a tyre rests with its dry friction about the king pin; nothing where it has none.
    fn resting_with_tyre(&self, own: &str) -> Result<Option<Finding>, Error> {
        let moment = readable(self.wheel.get(Key::MF));
        let finding = self.wheel.resting_angles()?.map(|[low, high]| {
            let text = format!(
                "With its dry friction about the king pin, M_f = {moment} N m, the wheel rests at caster angles from {} to {} rad, and \
                 motions near those inside return to rest.",
                significant(low, 4),
                significant(high, 4)
            );
            let check = "The balance of moments at rest.";
            Finding::new(format!("dry friction, {own}"), text, check)
        });
        Ok(finding)
    }

    /// The stability chart on axes that fit the wheel.
    fn chart(&self, radius: f64, control: &Control<'_>) -> Result<Found, Error> {
        let length = self.wheel.get(Key::L);
        let critical = self.with_radius(f64::INFINITY)?.critical_caster_length();
        let longest = critical.map_or(0.0, |critical| (BEYOND_CRITICAL * critical).min(LONGEST * length));
        let lengths = [LENGTHS[0] * length, longest.max(LENGTHS[1] * length)];
        let request = ChartRequest {
            wheel: self.request.wheel.clone(),
            x: SampledInterval::new("v", self.fastest / CHART[0] as f64, self.fastest, CHART[0]),
            y: SampledInterval::new("l", lengths[0], lengths[1], CHART[1]),
            overlay: Vec::new(),
        };
        let chart = request.validate()?.run(control)?;
        let caption = format!(
            "Growth rate of the uniform motion over speed and caster length at <i>r</i> = {}; the wheel has <i>v</i> = {} m/s, <i>l</i> = {} m.",
            if radius.is_infinite() { "∞".to_owned() } else { format!("{} m", readable(radius)) },
            readable(self.wheel.get(Key::V)),
            readable(length)
        );
        let mut illustrations: Vec<Illustration> = Illustration::of(&chart, caption)?.into_iter().collect();
        illustrations.push(limits::illustration(&self.wheel, self.fastest, lengths, &control.quiet())?);
        Ok(Found { findings: Vec::new(), illustrations })
    }

    /// Whether large cycles that are born of no Hopf point are sought elsewhere in the report, in words.
    fn search_for_large_cycles(&self, dampers: Option<&DamperResult>, stable: Option<bool>) -> &'static str {
        let isola_free = dampers.and_then(|dampers| dampers.isola_free.as_ref());
        let found = isola_free.into_iter().flat_map(|isola_free| [&isola_free.c_q, &isola_free.c_psi]);
        let is_kicked = found.flatten().any(|found| found.kicked.is_some())
            && self.wheel.get(Key::TurningRadius).is_infinite();
        match (is_kicked, self.strikes(stable)) {
            (true, true) => "were sought only by the blows below and the kicks of the dampers above",
            (true, false) => "were sought only by the kicks of the dampers above",
            (false, true) => "were sought only by the blows below",
            (false, false) => "were not sought",
        }
    }

    fn cycles(
        &self,
        subject: &str,
        uniform_motion: (Option<bool>, &[f64]),
        large_cycles: &str,
        control: &Control<'_>,
    ) -> Result<Found, Error> {
        let speeds = [self.wheel.get(Key::V), self.fastest];
        let cycles = cycles::follow(&self.request.wheel, speeds, control)?;
        let illustration = match &cycles {
            Some(cycles) => cycles::illustration(cycles, self.wheel.get(Key::TurningRadius))?,
            None => None,
        };
        let finding = match &cycles {
            Some(cycles) => cycles::finding(subject.to_owned(), cycles, speeds[0], uniform_motion),
            None => cycles::none_is_born(subject.to_owned(), self.fastest, uniform_motion.1, large_cycles),
        };
        Ok(Found::new(finding, illustration))
    }

    /// The cycles for several caster lengths and on several circles.
    fn families(&self, own: &str, found: &mut Found, control: &Control<'_>) -> Result<(), Error> {
        let families = [
            (format!("limit cycles over l, {own}"), Family::of_lengths as fn(&_, &_, _, &_) -> _),
            ("limit cycles over r".to_owned(), Family::of_radii),
        ];
        for (subject, follow) in families {
            let family = follow(&self.request.wheel, &self.wheel, self.fastest, control);
            let family =
                family.map(|family| Found::new(family.finding(subject.clone()), family.illustration()));
            found.take(&subject, family.map(|family| self.without_dry_friction(family)))?;
        }
        Ok(())
    }

    /// Whether there may be blows from which the wheel returns.
    fn strikes(&self, stable: Option<bool>) -> bool {
        stable != Some(false) || self.wheel.get(Key::MF) > 0.0
    }

    /// The shimmy of a wheel that is known to slide: whose load is known, and whose sliding is computed.
    fn shimmy(
        &self,
        subject: &str,
        (stable, stable_speeds): (Option<bool>, Option<[f64; 2]>),
        verdict: &mut Verdict,
        control: &Control<'_>,
    ) -> Result<Found, Error> {
        let speed = self.wheel.get(Key::V);
        // Where small motions die out at every speed the blows tell what remains.
        if self.is_everywhere(stable_speeds) {
            return Ok(Found::default());
        }
        let has_tyre = self.wheel.tyre() != Tyre::Rigid && self.wheel.get(Key::MF) == 0.0;
        if !has_tyre && Classification::default().contact_by_load(&self.wheel) != Contact::Sliding {
            if stable == Some(true) {
                return Ok(Found::default());
            }
            let reason = if may_slide(&self.wheel) {
                "no load on the king pin is given (F_Az = 0), and with it how much friction there is"
            } else {
                "shimmy is computed of a wheel that may slide, with a finite k_u, or of one with a tyre and without dry friction"
            };
            let text =
                format!("What the wheel settles on where small motions grow is not computed: {reason}.");
            return Ok(Found::new(Finding::new(subject, text, "").undecided_if(true), None));
        }
        let searched = Searched { speed, fastest: self.fastest, stable, stable_speeds };
        let found = searched.seek(&self.request.wheel, control)?;
        verdict.shimmy = searched.in_short(&found);
        let illustration = shimmy::illustration(&found, self.wheel.get(Key::TurningRadius))?;
        Ok(Found::new(searched.finding(subject.to_owned(), &found), illustration))
    }

    /// Whether a range of stable speeds reaches over all that are looked at.
    fn is_everywhere(&self, stable: Option<[f64; 2]>) -> bool {
        stable.is_some_and(|[from, to]| from <= 0.01 * self.fastest && to >= self.fastest)
    }

    /// The smallest blow over the speeds at which small motions die out, of a wheel that is known to slide.
    fn margin(&self, subject: &str, stable: Option<[f64; 2]>, control: &Control<'_>) -> Result<Found, Error> {
        if Classification::default().contact_by_load(&self.wheel) != Contact::Sliding {
            return Ok(Found::default());
        }
        // Dry friction keeps small motions small where they would grow without it.
        let dry = || -> Result<Option<[f64; 2]>, Error> {
            if self.wheel.get(Key::MF) == 0.0 || self.wheel.get(Key::TurningRadius).is_finite() {
                return Ok(None);
            }
            let critical = self.wheel.critical_speed_with_friction().unwrap_or(f64::INFINITY);
            Ok(Some([0.0, critical.min(self.fastest)]).filter(|[_, to]| *to > 0.0))
        };
        let Some(stable) = dry()?.or(stable) else {
            return Ok(Found::default());
        };
        // Up to a critical speed: where there is none the blow at the wheel's own speed is told.
        if self.is_everywhere(Some(stable)) {
            return Ok(Found::default());
        }
        let result = margin::seek(&self.request.wheel, stable, control)?;
        let illustration = margin::illustration(&result, self.wheel.get(Key::TurningRadius))?;
        Ok(Found::new(margin::finding(subject.to_owned(), &result), illustration))
    }

    fn blow(
        &self,
        subject: &str,
        stable: Option<bool>,
        verdict: &mut Verdict,
        control: &Control<'_>,
    ) -> Result<Found, Error> {
        let speed = self.wheel.get(Key::V);
        if !self.strikes(stable) {
            let text = format!(
                "At {} m/s the uniform motion is unstable: without friction about the king pin no blow is small enough.",
                readable(speed)
            );
            verdict.blow = Some(format!("at {} m/s no blow is small enough", readable(speed)));
            return Ok(Found::new(Finding::new(subject, text, ""), None));
        }
        let mut found = Found::default();
        let slides = may_slide(&self.wheel);
        let contacts: &[Contact] =
            if slides { &[Contact::Sliding, Contact::Rolling] } else { &[Contact::Rolling] };
        for &contact in contacts {
            let part = match contact {
                Contact::Sliding => 0.0..0.7,
                Contact::Rolling if slides => 0.7..1.0,
                Contact::Rolling => 0.0..1.0,
            };
            // Where there is one contact it needs no name.
            let name = if slides { format!(", {}", contact.model().name()) } else { String::new() };
            let subject = format!("{subject}{name}");
            let result = blow::seek(&self.request.wheel, contact, &control.part(part)).and_then(|result| {
                verdict.blow.get_or_insert_with(|| blow::in_short(&result, speed));
                let illustration = blow::illustration(&result)?;
                Ok(Found::new(blow::finding(subject.clone(), &result, speed), illustration))
            });
            found.take(&subject, result)?;
        }
        Ok(found)
    }

    /// What the wheel is called: its file, without the folder.
    fn name(&self) -> String {
        let file = self.request.wheel.wheel.as_ref().and_then(|file| file.file_stem());
        file.map_or_else(|| "The paper's wheel".to_owned(), |name| name.to_string_lossy().into_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::DamperRequest;

    const WHEELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");

    fn trolley(set: &[(&str, &str)]) -> ReportAnalysis {
        let set = set.iter().map(|(key, value)| Assignment { key: (*key).into(), value: (*value).into() });
        let wheel = WheelRequest { wheel: Some(format!("{WHEELS}/trolley.toml").into()), set: set.collect() };
        ReportRequest { wheel, ..ReportRequest::default() }.validate().unwrap()
    }

    const TYRE: [(&str, &str); 4] =
        [("tyre", "linear"), ("sigma", "0.05"), ("a", "0.02"), ("C_alpha", "900")];

    #[test]
    fn what_leaves_dry_friction_out_says_so() {
        let found = || Found {
            findings: vec![Finding::new("stability", "It is stable.".to_owned(), "")],
            illustrations: Vec::new(),
        };
        let said = |analysis: ReportAnalysis| analysis.without_dry_friction(found()).findings.remove(0).text;
        assert_eq!(said(trolley(&[])), "It is stable.");
        let sentence =
            "This is the wheel without dry friction about the king pin: M_f = 0.3 N m was left out.";
        assert_eq!(said(trolley(&[("M_f", "0.3")])), format!("It is stable. {sentence}"));
    }

    #[test]
    fn rests_with_a_tyre_are_told() {
        assert!(trolley(&TYRE).with_dry_friction("straight").unwrap().is_none());
        let dry = [&TYRE[..], &[("M_f", "0.3")]].concat();
        let finding = trolley(&dry).with_dry_friction("straight").unwrap().unwrap();
        assert_eq!(finding.subject, "dry friction, straight");
        assert!(
            finding.text.contains("M_f = 0.3 N m, the wheel rests at caster angles from -0.00"),
            "{}",
            finding.text
        );
    }

    #[test]
    fn dampers_are_told_without_the_wheels_own() {
        let up_to = Assignment { key: "v".to_owned(), value: "2".to_owned() };
        for (own, told) in
            [("0", None), ("3", Some("All this is without the wheel's own dampers (c_q = 3 N s/m)."))]
        {
            let request = trolley(&[("c_q", own)]).request.wheel;
            let request = DamperRequest { small_motions: true, ..DamperRequest::new(request, up_to.clone()) };
            let text = dampers::finding(String::new(), &request.run(&Control::none()).unwrap()).text;
            assert_eq!(text.contains("wheel's own"), told.is_some(), "{text}");
            assert!(told.is_none_or(|told| text.ends_with(told)), "{text}");
        }
    }

    #[test]
    fn dampers_on_the_wheels_own_circle_are_told_with_those_of_straight_towing() {
        let up_to = 37.0;
        let wheel = |r: &str| WheelRequest {
            wheel: Some(format!("{WHEELS}/nosegear.toml").into()),
            set: vec![Assignment { key: "r".to_owned(), value: r.to_owned() }],
        };
        let dampers = |r: &str| dampers::seek_for_small_motions(&wheel(r), up_to, &Control::none()).unwrap();
        let (straight, circle) = (dampers("inf"), dampers("2"));
        // A damper that is enough straight is too weak on the circle: with 24.5 N m s/rad it is unstable at 34 m/s.
        assert!(
            circle.c_psi.unwrap() > 1.3 * straight.c_psi.unwrap(),
            "{:?} {:?}",
            circle.c_psi,
            straight.c_psi
        );
        let said = dampers::in_short(&circle, Some("at r = 2 m"));
        assert!(
            said.starts_with("at r = 2 m, for small motions to die out up to 37 m/s it takes c_q"),
            "{said}"
        );
        let text = dampers::finding("dampers, r = 2 m".to_owned(), &circle);
        assert!(!text.check.contains("kicks"), "{}", text.check);
    }

    #[test]
    fn where_large_cycles_are_sought_is_told() {
        let straight = trolley(&[]);
        assert_eq!(straight.search_for_large_cycles(None, Some(false)), "were not sought");
        assert_eq!(straight.search_for_large_cycles(None, Some(true)), "were sought only by the blows below");
    }
}
