//! The table of parameter keys: name, symbol, unit, meaning and allowed range of each.
//!
//! One parameter is a word, the law of the tyre. The keys are those of the paper, in ASCII, and the same everywhere: flags, TOML, columns. Help texts and error
//! messages are made from this table, so that they cannot differ from what is checked.

use std::fmt;

/// The key of a parameter. Everything is SI.
///
/// The paper's `r` and `R` differ by case only; here they are [`Key::TurningRadius`] and [`Key::WheelRadius`].
///
/// ```
/// use kingpin::Key;
/// let key: Key = "J_Cz".parse()?;
/// assert_eq!((key, key.unit()), (Key::JCz, "kg m^2"));
/// # Ok::<(), kingpin::KingpinError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)] // the table below says what each key means
pub enum Key {
    V,
    L,
    TurningRadius,
    MW,
    MC,
    JWxi,
    JWzeta,
    JCz,
    WheelRadius,
    LC,
    G,
    MuS,
    MuD,
    FAz,
    KU,
    KQ,
    CU,
    CQ,
    CPsi,
    KPsi,
    MF,
    Sigma,
    HalfContactLength,
    CAlpha,
    TP,
    Kappa,
    /// Both stiffnesses at once; reads as `k_q`.
    K,
    /// `1/r`, zero in rectilinear towing: the continuation passes through `r = inf` with it.
    Curvature,
}

/// Number of parameters that a wheel stores; the keys after them stand for others.
pub(crate) const STORED: usize = Key::K as usize;

/// What a parameter may be: a closed interval, to which infinity may be added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allowed {
    /// Smallest value.
    pub lowest: f64,
    /// Largest finite value.
    pub highest: f64,
    /// Whether `inf` is allowed too.
    pub infinite: bool,
}

impl Allowed {
    const fn between(lowest: f64, highest: f64) -> Self {
        Self { lowest, highest, infinite: false }
    }
    const fn or_infinite(lowest: f64, highest: f64) -> Self {
        Self { lowest, highest, infinite: true }
    }
    /// The value itself where it may be taken, else the nearest that may be.
    pub(crate) fn nearest(&self, value: f64) -> f64 {
        if self.contains(value) || value.is_nan() { value } else { value.clamp(self.lowest, self.highest) }
    }

    /// Whether the value may be taken.
    pub fn contains(&self, value: f64) -> bool {
        (self.lowest <= value && value <= self.highest) || (self.infinite && value == f64::INFINITY)
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |value: f64| {
            if value == 0.0 || (0.01..1e4).contains(&value.abs()) {
                value.to_string()
            } else {
                format!("{value:e}")
            }
        };
        write!(formatter, "{} to {}", number(self.lowest), number(self.highest))?;
        if self.infinite { write!(formatter, ", or inf") } else { Ok(()) }
    }
}

struct Entry {
    name: &'static str,
    symbol: &'static str,
    unit: &'static str,
    meaning: &'static str,
    allowed: Allowed,
    /// The paper's wheel at v = 4 m/s, l = 0.08 m, r = 1 m.
    default: f64,
}

const LENGTH: Allowed = Allowed::between(1e-6, 1e3);
const MASS: Allowed = Allowed::between(1e-9, 1e6);
const INERTIA: Allowed = Allowed::between(1e-12, 1e6);
const DAMPING: Allowed = Allowed::between(0.0, 1e6);
const FRICTION: Allowed = Allowed::between(0.0, 100.0);

const fn entry(
    name: &'static str,
    symbol: &'static str,
    unit: &'static str,
    meaning: &'static str,
    allowed: Allowed,
    default: f64,
) -> Entry {
    Entry { name, symbol, unit, meaning, allowed, default }
}

/// In the order of the variants of [`Key`].
#[rustfmt::skip]
const TABLE: [Entry; STORED + 2] = [
    entry("v", "v", "m/s", "towing speed", Allowed::between(0.0, 1e4), 4.0),
    entry("l", "l", "m", "caster length, from king pin to wheel", LENGTH, 0.08),
    entry("r", "r", "m", "turning radius of the towing point; inf is rectilinear towing, turning the other way is the mirror image",
        Allowed::or_infinite(1e-3, 1e12), 1.0),
    entry("m_w", "m_w", "kg", "mass of the wheel", MASS, 0.3519),
    entry("m_c", "m_c", "kg", "mass of the caster", MASS, 0.0668),
    entry("J_wxi", "J_wξ", "kg m^2", "moment of inertia of the wheel about its spin axis", INERTIA, 4.63e-5),
    entry("J_wzeta", "J_wζ", "kg m^2", "moment of inertia of the wheel about the vertical", INERTIA, 2.38e-5),
    entry("J_Cz", "J_Cz", "kg m^2", "moment of inertia of the caster about the vertical at its centre of gravity C", INERTIA, 3.48e-6),
    entry("R", "R", "m", "radius of the wheel", LENGTH, 0.04),
    entry("l_c", "l_c", "m", "distance from king pin to C, negative where C lies ahead of the king pin",
        Allowed::between(-1e3, 1e3), 0.012),
    entry("g", "g", "m/s^2", "acceleration of gravity", Allowed::between(0.0, 1e3), 9.81),
    entry("mu_s", "μ_s", "1", "coefficient of static friction", FRICTION, 1.0),
    entry("mu_d", "μ_d", "1", "coefficient of sliding friction, at most mu_s; if not set, 0.8 or mu_s, whichever is less", FRICTION, 0.8),
    entry("F_Az", "F_Az", "N", "vertical force on the king pin, negative presses down", Allowed::between(-1e6, 1e6), 0.0),
    entry("k_u", "k_u", "N/m", "longitudinal stiffness at the king pin; inf is lateral elasticity only",
        Allowed::or_infinite(1e-3, 1e9), 100.0),
    entry("k_q", "k_q", "N/m", "lateral stiffness at the king pin; inf only with a tyre",
        Allowed::or_infinite(1e-3, 1e9), 100.0),
    entry("c_u", "c_u", "N s/m", "longitudinal damping at the king pin", DAMPING, 0.0),
    entry("c_q", "c_q", "N s/m", "lateral damping at the king pin", DAMPING, 0.0),
    entry("c_psi", "c_ψ", "N m s/rad", "rotational damping about the king pin", DAMPING, 0.0),
    entry("k_psi", "k_ψ", "N m/rad", "rotational stiffness about the king pin", DAMPING, 0.0),
    entry("M_f", "M_f", "N m", "moment of dry friction about the king pin", DAMPING, 0.0),
    entry("sigma", "σ", "m", "relaxation length of the tyre, must be set with one", LENGTH, 0.0),
    entry("a", "a", "m", "half contact length of the tyre", Allowed::between(0.0, 1e3), 0.0),
    entry("C_alpha", "C_α", "N/rad", "cornering stiffness of the tyre, must be set with one", Allowed::between(1e-3, 1e12), 0.0),
    entry("t_p", "t_p", "m", "pneumatic trail of the tyre at small slip; if not set, a/3", Allowed::between(-1e3, 1e3), 0.0),
    entry("kappa", "κ", "N m^2", "tread width coefficient of the tyre", DAMPING, 0.0),
    entry("k", "k", "N/m", "stiffness at the king pin, sets k_u and k_q", Allowed::or_infinite(1e-3, 1e9), 100.0),
    entry("curvature", "1/r", "1/m", "curvature of the towing path, sets r", Allowed::between(0.0, 1e3), 1.0),
];

impl Key {
    /// Every key, in the order of the table.
    pub const ALL: [Key; STORED + 2] = [
        Key::V,
        Key::L,
        Key::TurningRadius,
        Key::MW,
        Key::MC,
        Key::JWxi,
        Key::JWzeta,
        Key::JCz,
        Key::WheelRadius,
        Key::LC,
        Key::G,
        Key::MuS,
        Key::MuD,
        Key::FAz,
        Key::KU,
        Key::KQ,
        Key::CU,
        Key::CQ,
        Key::CPsi,
        Key::KPsi,
        Key::MF,
        Key::Sigma,
        Key::HalfContactLength,
        Key::CAlpha,
        Key::TP,
        Key::Kappa,
        Key::K,
        Key::Curvature,
    ];

    const fn entry(self) -> &'static Entry {
        &TABLE[self as usize]
    }
    /// The key as it is written in files and flags.
    pub const fn name(self) -> &'static str {
        self.entry().name
    }
    /// The symbol as it is printed in axis labels.
    pub const fn symbol(self) -> &'static str {
        self.entry().symbol
    }
    /// The SI unit, `1` where there is none.
    pub const fn unit(self) -> &'static str {
        self.entry().unit
    }
    /// What the parameter is.
    pub const fn meaning(self) -> &'static str {
        self.entry().meaning
    }
    /// The values that the parameter may take.
    pub const fn allowed(self) -> Allowed {
        self.entry().allowed
    }
    /// The keys of the tyre: relaxation length, half contact length, cornering stiffness, pneumatic trail, tread width.
    pub const TYRE: [Key; 5] = [Key::Sigma, Key::HalfContactLength, Key::CAlpha, Key::TP, Key::Kappa];

    /// Whether the key says something of the tyre, which a rigid one does not have.
    pub fn is_of_the_tyre(self) -> bool {
        Self::TYRE.contains(&self)
    }
    /// The value in [`Wheel::default`](crate::Wheel); not an allowed one where a tyre has to be given its own.
    pub const fn default_value(self) -> f64 {
        self.entry().default
    }
    /// Whether the wheel stores the parameter itself; `k` and `curvature` stand for others.
    pub const fn is_stored(self) -> bool {
        (self as usize) < STORED
    }
    /// The stored keys that setting this one changes.
    pub const fn sets(self) -> &'static [Key] {
        const OWN: [[Key; 1]; STORED + 2] = {
            let mut own = [[Key::V]; STORED + 2];
            let mut index = 0;
            while index < Key::ALL.len() {
                own[index] = [Key::ALL[index]];
                index += 1;
            }
            own
        };
        match self {
            Key::K => &[Key::KU, Key::KQ],
            Key::Curvature => &[Key::TurningRadius],
            _ => &OWN[self as usize],
        }
    }
}

impl fmt::Display for Key {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// The law of the tyre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Tyre {
    /// None: the wheel rolls on a point and does not slip.
    #[default]
    Rigid,
    /// Force and moment are proportional to the slip.
    Linear,
    /// A row of bristles: force and moment are limited by the friction.
    Brush,
}

impl Tyre {
    /// The key by which it is set.
    pub const KEY: &'static str = "tyre";

    /// All of them.
    pub const ALL: [Tyre; 3] = [Tyre::Rigid, Tyre::Linear, Tyre::Brush];

    /// The word for it in files and flags.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::Linear => "linear",
            Self::Brush => "brush",
        }
    }
}

impl fmt::Display for Tyre {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_is_in_the_order_of_the_keys() {
        for (index, key) in Key::ALL.into_iter().enumerate() {
            assert_eq!(key as usize, index);
            assert_eq!(key.name().parse::<Key>().unwrap(), key);
            let has_no_default = [Key::Sigma, Key::CAlpha].contains(&key);
            assert_eq!(key.allowed().contains(key.default_value()), !has_no_default);
        }
    }
}
