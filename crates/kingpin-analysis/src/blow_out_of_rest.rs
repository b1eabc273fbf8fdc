//! The smallest blow that dry friction about the king pin does not take in one swing, as a part of results.

use kingpin::BlowOutOfRest;
use kingpin::basin::Fate;
use kingpin_report::numbers::readable;
use serde::Serialize;

/// The smallest sideways blow on the rim after which the caster does not stay where its first swing ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BlowOutOfRestResult {
    /// Its size in N s; zero where any is too strong, nothing where none was found that is.
    pub blow: Option<f64>,
    /// `closed form` or `simulation`.
    pub method: &'static str,
    /// Distance in N s to the largest one that was seen to be held; nothing in closed form.
    pub resolution: Option<f64>,
    /// Distance in N s of the blows that were tried below; nothing in closed form.
    pub scanned: Option<f64>,
    /// What becomes of the motion after it, where that was followed.
    pub ends_in: Option<&'static str>,
}

impl From<BlowOutOfRest> for BlowOutOfRestResult {
    fn from(edge: BlowOutOfRest) -> Self {
        let ends_in = |fate: Fate| if fate == Fate::UniformMotion { "rest" } else { fate.name() };
        Self {
            blow: edge.blow,
            method: if edge.simulated { "simulation" } else { "closed form" },
            resolution: edge.resolution,
            scanned: edge.scanned,
            ends_in: edge.fate.map(ends_in),
        }
    }
}

impl BlowOutOfRestResult {
    /// What a blow does to the wheel that rolls and rests.
    pub(crate) fn while_rolling(&self) -> String {
        match (self.blow, self.how()) {
            (Some(0.0), _) => "any blow takes it out of that, however weak (closed form: rolling, it rests at one caster angle only);\n\
                 up to which it comes back, `kingpin safe-kick` tells"
                .to_owned(),
            (Some(blow), how) => {
                let then = match self.ends_in {
                    Some("rest") => "swings again before it rests".to_owned(),
                    Some(fate) => format!("swings again, and the motion ends in: {fate}"),
                    None => "swings again".to_owned(),
                };
                let blow = readable(blow);
                format!("after a blow on the rim below {blow} N s the caster swings once and rests, from there on it {then}\n{how}")
            }
            (None, how) => format!("no blow was found after which the caster swings more than once {how}"),
        }
    }

    /// What a blow does to the caster that is held at an angle while the wheel slides.
    pub(crate) fn while_sliding(&self) -> String {
        match (self.blow, self.how()) {
            (Some(blow), how) => {
                format!("a blow on the rim from {} N s on swings it beyond that\n{how}", readable(blow))
            }
            (None, how) => format!("no blow swings it beyond that {how}"),
        }
    }

    fn how(&self) -> String {
        match (self.resolution, self.scanned) {
            (Some(resolution), Some(scanned)) => format!(
                "(by simulation, to {resolution:.1e} N s; below, blows {} N s apart were tried)",
                readable(scanned)
            ),
            _ => format!("({})", if self.method == "simulation" { "by simulation" } else { self.method }),
        }
    }
}
