//! Everything that can go wrong, said so that it can be put right.

use crate::parameters::{Key, Tyre};
use arclength::control::Interrupted;
use arclength_numbers::{readable, significant};
use std::fmt;
use std::path::PathBuf;

/// A place in a text, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// Line.
    pub line: usize,
    /// Column, in characters.
    pub column: usize,
}

impl Position {
    /// The place of a byte offset in a text.
    pub(crate) fn of(offset: usize, text: &str) -> Self {
        let before = &text.as_bytes()[..offset.min(text.len())];
        let start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
        Self {
            line: before.iter().filter(|&&byte| byte == b'\n').count() + 1,
            column: String::from_utf8_lossy(&before[start..]).chars().count() + 1,
        }
    }
}

impl fmt::Display for Position {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "line {}, column {}", self.line, self.column)
    }
}

/// What there is of a wheel with a tyre.
const TAKES_TYRE: &str = "uniform motions, their stability, charts, Hopf points, dampers, cycles, shimmy, curves in two parameters, simulations, fits, basins, safe kicks and their margins";

/// Why a wheel has no uniform motion.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoUniformMotion {
    /// The towing point stands still.
    #[error("at v = 0 every caster angle is an equilibrium; set v above 0")]
    Standstill,
    /// The inertial force of the caster outgrows the lateral spring.
    #[error(
        "m omega^2 < k l fails: {} N is not below {} N (m = m_c (l - l_c), omega = v/r, k = k_q); lower v or raise r, l or k_q",
        readable(*inertial), readable(*elastic)
    )]
    SpringTooSoft {
        /// `m omega^2` in N.
        inertial: f64,
        /// `k l` in N.
        elastic: f64,
    },
    /// The motion of a wheel with a tyre was followed from the straight path to its circle and lost.
    #[error(
        "it was followed from the straight path to 1/r = {} 1/m and lost there (residual {}); lower v or raise r",
        readable(*curvature), significant(*residual, 2)
    )]
    LostOnTheCircle {
        /// The last curvature in 1/m at which the motion was found.
        curvature: f64,
        /// Largest component of the vector field where Newton's method gave up.
        residual: f64,
    },
    /// The caster cannot lie along the circle of the wheel.
    #[error(
        "|l - a0| < r fails: {} m is not below {} m \
         (a0 = m omega^2/k is the deflection of the spring along the caster); raise r or lower l",
        readable(*effective_length), readable(*radius)
    )]
    CircleTooSmall {
        /// `|l - a0|` in m.
        effective_length: f64,
        /// `r` in m.
        radius: f64,
    },
    /// Newton's method did not find the caster angle of the wheel with lateral elasticity only.
    #[error("Newton's method stopped with residual {}; lower k_psi", significant(*residual, 2))]
    NotFound {
        /// What is left of the equation for `sin psi`.
        residual: f64,
    },
    /// Newton's method was led from the isotropic wheel towards the given one and stopped on the way.
    #[error(
        "it was followed from k_u = k_q to k_u = {} N/m and lost there (residual {}); bring k_u nearer to k_q or lower k_psi",
        readable(*longitudinal_stiffness), significant(*residual, 2)
    )]
    LostOnTheWay {
        /// The last `k_u` in N/m at which the motion was found.
        longitudinal_stiffness: f64,
        /// Largest component of the vector field where Newton's method gave up.
        residual: f64,
    },
}

/// The error of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum KingpinError {
    /// A key that is in no table.
    #[error("{}unknown key `{given}`; {}", prefix(.position), told(.given, .suggestions))]
    UnknownKey {
        /// What was given.
        given: String,
        /// The known keys that may be meant, the likeliest first; none where none is near.
        suggestions: Vec<Key>,
        /// Where in a file.
        position: Option<Position>,
    },
    /// A section of a file.
    #[error("{}[{given}]: there are no sections; write the keys and their values without one, as in `v = 1.5`", prefix(.position))]
    Section {
        /// Its name.
        given: String,
        /// Where in the file.
        position: Option<Position>,
    },
    /// Text that is no number.
    #[error("{}{key} = {given}: not a number; allowed: {} {}", prefix(.position), .key.allowed(), .key.unit())]
    NotANumber {
        /// The parameter.
        key: Key,
        /// What was given.
        given: String,
        /// Where in a file.
        position: Option<Position>,
    },
    /// A number that the parameter may not take.
    #[error("{}{key} = {value}: out of range; allowed: {} {} ({})",
        prefix(.position), .key.allowed(), .key.unit(), .key.meaning())]
    OutOfRange {
        /// The parameter.
        key: Key,
        /// What was given.
        value: f64,
        /// Where in a file.
        position: Option<Position>,
    },
    /// A word that is no law of the tyre.
    #[error("{}tyre = {given}: no such tyre; allowed: rigid, linear, brush", prefix(.position))]
    UnknownTyre {
        /// What was given.
        given: String,
        /// Where in a file.
        position: Option<Position>,
    },
    /// The law of the tyre where a parameter is asked for that varies.
    #[error("`tyre` is a word (rigid, linear, brush) and cannot vary; set it with `tyre = linear`")]
    TyreVaries,
    /// A tyre without what its law needs.
    #[error("tyre = {tyre} needs {key} ({}, in {}): allowed: {}", .key.meaning(), .key.unit(), .key.allowed())]
    MissingOfTyre {
        /// The tyre.
        tyre: Tyre,
        /// What is missing.
        key: Key,
    },
    /// A brush that no friction holds.
    #[error(
        "tyre = brush needs friction: mu_s N = {limit} N, where N = -F_Az + (m_w + m_c) g; raise mu_s, or lower F_Az, which \
         is negative where a load presses down"
    )]
    NoFrictionLimit {
        /// `mu_s N` in N.
        limit: f64,
    },
    /// A parameter of the tyre where there is none.
    #[error("`{key}` belongs to a tyre ({}), and the wheel has none: set tyre = linear or tyre = brush", .key.meaning())]
    NoTyre {
        /// The key.
        key: Key,
    },
    /// A king pin that cannot give way, with a wheel that cannot either.
    #[error(
        "k_q = inf: without a tyre the wheel needs a finite k_q, or nothing gives way; set tyre = linear or tyre = brush for a \
         rigid king pin"
    )]
    RigidKingPin,
    /// What does not take a tyre.
    #[error(
        "tyre = {tyre}: this takes rigid wheels only; with a tyre there are {TAKES_TYRE}; see the wheel without it by tyre = rigid"
    )]
    TyreNotTaken {
        /// The tyre.
        tyre: Tyre,
    },
    /// A text that is no TOML.
    #[error("not valid TOML: {0}")]
    Toml(#[from] toml::de::Error),
    /// A file that cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A file with something wrong in it.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Box<KingpinError>,
    },
    /// Two keys that set the same parameter cannot both vary.
    #[error("`{first}` and `{second}` cannot vary together: both set `{}`",
        first.sets().iter().find(|key| second.sets().contains(key)).unwrap_or(first))]
    DependentKeys {
        /// One key.
        first: Key,
        /// The other.
        second: Key,
    },
    /// Sliding friction above static friction.
    #[error("mu_d = {sliding} is not allowed: at most mu_s = {sticking}")]
    SlidingFriction {
        /// `mu_d`.
        sliding: f64,
        /// `mu_s`.
        sticking: f64,
    },
    /// `r` cannot vary from infinity.
    #[error("`r` cannot vary from inf: vary `curvature` = 1/r from 0 instead")]
    InfiniteRadius,
    /// `k` cannot vary while it stands for two different stiffnesses.
    #[error(
        "`k` cannot vary while k_u = {longitudinal} N/m and k_q = {lateral} N/m differ: vary `k_u` or `k_q`"
    )]
    AmbiguousStiffness {
        /// `k_u` in N/m.
        longitudinal: f64,
        /// `k_q` in N/m.
        lateral: f64,
    },
    /// The five-state model needs longitudinal elasticity.
    #[error(
        "k_u = inf: this needs a finite k_u; with lateral elasticity only there are uniform motions, their stability, \
         charts, Hopf points, cycles and simulations of ideal rolling"
    )]
    LateralElasticityOnly,
    /// Something that is not computed with dry friction about the king pin.
    #[error("M_f = {moment} N m: {what} with dry friction about the king pin is not computed; {remedy}")]
    DryFriction {
        /// `M_f` in N m.
        moment: f64,
        /// What is not computed with it.
        what: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// `M_f` cannot vary along a branch or an axis.
    #[error(
        "`M_f` cannot vary here: uniform motions, eigenvalues and cycles are those without dry friction about the king pin; \
         `margin --along M_f=A:B:N` shows what it does to motions"
    )]
    DryFrictionVaries,
    /// The three-state model has no longitudinal elasticity.
    #[error("k_u = {longitudinal} N/m: the model with lateral elasticity only needs k_u = inf")]
    LongitudinalElasticity {
        /// `k_u` in N/m.
        longitudinal: f64,
    },
    /// In the three-state model nothing moves along the towing direction.
    #[error(
        "`{key}` cannot vary while k_u = inf: with lateral elasticity only the king pin does not move along the towing \
         direction; vary another key or set a finite k_u"
    )]
    NoLongitudinalMotion {
        /// The key.
        key: Key,
    },
    /// A rigid king pin does not move sideways.
    #[error(
        "`{key}` cannot vary while k_q = inf: the king pin does not move sideways; vary another key or set a finite k_q"
    )]
    NoLateralMotion {
        /// The key.
        key: Key,
    },
    /// A cycle on which a wheel with a tyre does not roll forwards all the time.
    #[error(
        "on this cycle the smallest V1 is {ratio} v: with a tyre the wheel has to roll forwards; start from a smaller cycle"
    )]
    RollsBackwards {
        /// The smallest `V1/v`.
        ratio: f64,
    },
    /// The model with a tyre needs one.
    #[error("tyre = rigid: the model with a tyre needs tyre = linear or tyre = brush")]
    NeedsTyre,
    /// An interval that reaches a limit in which the model has fewer states.
    #[error(
        "{key} = inf cannot be an end of the interval: the wheel has fewer states there; allowed: a finite end"
    )]
    InfiniteEnd {
        /// The parameter.
        key: Key,
    },
    /// A branch could not be followed.
    #[error(transparent)]
    Continuation(#[from] arclength::Error),
    /// The value to start from is outside the interval to be followed.
    #[error("{key} = {value} is outside {start}:{end}; the interval has to contain the start")]
    OutsideInterval {
        /// The parameter.
        key: Key,
        /// Its value at the start.
        value: f64,
        /// Start of the interval.
        start: f64,
        /// End of the interval.
        end: f64,
    },
    /// An interval that is empty.
    #[error("{key} = {start}:{end}: empty interval; the start must be below the end")]
    EmptyInterval {
        /// The parameter.
        key: Key,
        /// Start.
        start: f64,
        /// End.
        end: f64,
    },
    /// A grid that is too coarse or too fine.
    #[error("a grid of {columns} x {rows} points; allowed: at least 2 x 2, at most {most} points")]
    GridSize {
        /// Points along x.
        columns: usize,
        /// Points along y.
        rows: usize,
        /// Most points.
        most: usize,
    },
    /// The computation was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// There is no uniform motion.
    #[error("no uniform motion at v = {} m/s, l = {} m, {}: {reason}", readable(*v), readable(*l), radius(*r))]
    NoUniformMotion {
        /// Towing speed in m/s.
        v: f64,
        /// Caster length in m.
        l: f64,
        /// Turning radius in m.
        r: f64,
        /// The condition that fails.
        #[source]
        reason: NoUniformMotion,
    },
}

impl KingpinError {
    /// The same error, found at a place in a text.
    pub(crate) fn at(self, place: Position) -> Self {
        let position = Some(place);
        match self {
            Self::UnknownKey { given, suggestions, .. } => Self::UnknownKey { given, suggestions, position },
            Self::NotANumber { key, given, .. } => Self::NotANumber { key, given, position },
            Self::OutOfRange { key, value, .. } => Self::OutOfRange { key, value, position },
            Self::UnknownTyre { given, .. } => Self::UnknownTyre { given, position },
            other => other,
        }
    }
}

/// The keys that may be meant, with what they mean.
fn told(given: &str, suggestions: &[Key]) -> String {
    // The law of the tyre is a word, and no key of a number.
    let is_tyre = ["tyre", "tire"].into_iter().any(|word| given.to_lowercase().contains(word));
    let tyre = is_tyre.then(|| format!("`{}` (law of the tyre: rigid, linear, brush)", Tyre::KEY));
    let keys = suggestions.iter().map(|key| format!("`{key}` ({}, {})", key.meaning(), key.unit()));
    match tyre.into_iter().chain(keys).collect::<Vec<_>>().as_slice() {
        [] => {
            let keys = Key::ALL.map(Key::name).join(", ");
            format!("the keys are {keys}, and `{}`, which is a word (rigid, linear, brush)", Tyre::KEY)
        }
        [nearest] => format!("the nearest known key is {nearest}"),
        several => format!("it may be {}", several.join(", or ")),
    }
}

/// The radius of the path.
fn radius(r: f64) -> String {
    if r.is_infinite() { "r = inf".to_owned() } else { format!("r = {} m", readable(r)) }
}

fn prefix(position: &Option<Position>) -> String {
    position.map_or_else(String::new, |position| format!("{position}: "))
}
