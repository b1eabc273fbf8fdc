//! How motions are followed and told apart: a part of every request that asks where they end.

use crate::error::Error;
use kingpin::basin::{ClassificationSettings, ContactModel, Fate};
use kingpin::{Key, KingpinError, Tyre, Wheel};
use kingpin_figure::{Color, palette};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Whether the wheel may slide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Contact {
    /// Ideal rolling, as in the paper and in `cycles`: the ground supplies whatever force that takes.
    #[default]
    Rolling,
    /// Coulomb friction: the wheel slides where rolling takes more than the static friction.
    Sliding,
}

impl Contact {
    /// The model of the contact.
    pub fn model(self) -> ContactModel {
        match self {
            Self::Rolling => ContactModel::Rolling,
            Self::Sliding => ContactModel::Sliding,
        }
    }
}

/// How motions are followed.
///
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Classification {
    /// Whether the wheel may slide, where that is said.
    pub contact: Option<Contact>,
    /// Time in s for which motions are followed, up to ten times as long while they swing to and fro unsettled (irregular ones only
    /// where they may return); 12 times the decay time of small disturbances, 30 to 300, where it is not given.
    pub duration: Option<f64>,
}

impl Classification {
    /// The contact where it is said, else ideal rolling: there the uniform motion always exists, while that of the paper's wheel takes
    /// more friction than there is, so that a wheel that may slide has nothing to return to.
    pub fn contact_or_rolling(&self) -> Contact {
        self.contact.unwrap_or_default()
    }

    /// The contact where it is said, else what a designer means: a wheel whose load is known may slide, unless it has a tyre, or
    /// lateral elasticity only, with which that is not computed.
    pub fn contact_by_load(&self, wheel: &Wheel) -> Contact {
        let is_loaded = wheel.get(Key::FAz) != 0.0;
        let loaded = if is_loaded && may_slide(wheel) { Contact::Sliding } else { Contact::Rolling };
        self.contact.unwrap_or(loaded)
    }

    /// The settings for a wheel.
    ///
    /// # Errors
    /// No uniform motion, or a duration that is not positive.
    pub fn settings(&self, wheel: &Wheel) -> Result<ClassificationSettings, Error> {
        match self.duration {
            Some(duration) if duration > 0.0 && duration.is_finite() => {
                Ok(ClassificationSettings::with_duration(duration))
            }
            Some(duration) => Err(Error::invalid(
                &["duration"],
                duration.to_string(),
                "no time to follow a motion",
                "positive and finite, in s",
            )),
            None => Ok(ClassificationSettings::for_wheel(wheel)?),
        }
    }

    /// What ideal rolling passes over, and that nothing returns to the uniform motion.
    ///
    /// # Errors
    /// No uniform motion.
    pub fn warnings(&self, wheel: &Wheel, contact: Contact) -> Result<Vec<String>, KingpinError> {
        let motion = wheel.uniform_motion()?;
        let mut warnings = Vec::new();
        if contact == Contact::Rolling && wheel.has_lateral_elasticity_only() && wheel.tyre() == Tyre::Rigid {
            warnings.push(
                "with k_u = inf the wheel rolls whatever force that takes: sliding is computed with a finite k_u only"
                    .to_owned(),
            );
        }
        if contact == Contact::Rolling && !motion.rolls() {
            warnings.push(
                "rolling takes more than the static friction even in uniform motion; it is assumed to roll"
                    .to_owned(),
            );
        }
        let with_friction = wheel.swing_factor().filter(|_| wheel.get(Key::MF) > 0.0);
        match with_friction {
            Some(factor) if factor.abs() >= 1.0 => warnings.push(
                "small motions grow in spite of dry friction about the king pin: see `kingpin stability`"
                    .to_owned(),
            ),
            Some(_) => {}
            None if motion.is_stable() == Some(false) && wheel.resting_angles()?.is_none() => {
                warnings.push("the uniform motion is unstable: see `kingpin stability`".to_owned());
            }
            None => {}
        }
        Ok(warnings)
    }
}

/// What happens to the wheel where its equations cease to hold.
pub(crate) fn end_of_the_model(wheel: &Wheel) -> &'static str {
    match wheel.tyre() {
        Tyre::Rigid => "with k_u = inf the caster comes to lie across the towing direction",
        _ => "the wheel stops rolling forwards (V1 = 0), where the law of the tyre ends",
    }
}

/// Whether sliding of the wheel is computed: with a tyre, or with lateral elasticity only, it is not.
pub(crate) fn may_slide(wheel: &Wheel) -> bool {
    wheel.tyre() == Tyre::Rigid && !wheel.has_lateral_elasticity_only()
}

/// What the contact of the wheel with the ground is, in words.
pub(crate) fn contact_in_words(wheel: &Wheel, contact: &str) -> &'static str {
    match wheel.tyre() {
        Tyre::Linear => "a linear tyre",
        Tyre::Brush => "a brush tyre",
        Tyre::Rigid if contact == Contact::Rolling.model().name() => "ideal rolling",
        Tyre::Rigid => "rolling and sliding",
    }
}

/// A fate by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedFate(pub Fate);

impl NamedFate {
    /// The colour in which maps show it.
    pub fn color(self) -> Color {
        color(self.0)
    }
}

impl Serialize for NamedFate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name())
    }
}

impl<'de> Deserialize<'de> for NamedFate {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let fate = Fate::ALL.into_iter().find(|fate| fate.name() == name);
        fate.map(Self).ok_or_else(|| D::Error::custom(format!("`{name}` is no fate")))
    }
}

/// The colour of a fate, told apart with any colour vision.
pub(crate) fn color(fate: Fate) -> Color {
    match fate {
        Fate::UniformMotion => palette::BLUE,
        Fate::Shimmy => palette::YELLOW,
        Fate::SteadySliding => palette::GREEN,
        Fate::Tumbling => palette::VERMILION,
        Fate::Escape => palette::BLACK,
        Fate::Irregular => palette::ORANGE,
        Fate::ModelEnds => palette::PURPLE,
        Fate::Undecided => palette::LIGHT_GREY,
    }
}
