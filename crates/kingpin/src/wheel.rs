//! A wheel: named, validated parameters, read from TOML and overridden one by one.

use crate::error::{KingpinError, Position};
use crate::origin::Origin;
use crate::parameters::{Key, STORED, Tyre};
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// Half contact lengths per pneumatic trail, if none is set: as for a brush whose bristles have one stiffness.
pub(crate) const HALF_LENGTHS_PER_TRAIL: f64 = 3.0;

/// The parameters of a towed wheel, each within its allowed range ([`Key::allowed`]).
///
/// The default is the paper's wheel at v = 4 m/s, l = 0.08 m, r = 1 m, without vertical load (`F_Az = 0`) and
/// without damping. Its coefficient of sliding friction, which the paper does not give, is 0.8 or `mu_s`, whichever is less, until
/// it is set: sliding friction above the static one would let the wheel neither roll nor slide.
///
/// ```
/// use kingpin::{Key, Wheel};
/// let wheel = Wheel::default().with(Key::TurningRadius, f64::INFINITY)?;
/// assert_eq!(wheel.get(Key::Curvature), 0.0);
/// assert!(wheel.with(Key::L, -1.0).is_err());
/// # Ok::<(), kingpin::KingpinError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Wheel {
    values: [f64; STORED],
    /// What was said of the tyre; nothing is a rigid one.
    tyre: Option<Tyre>,
    /// Where the values come from. Unless they were set, `mu_d` is kept at or below `mu_s`, and `t_p` at `a/3`.
    origin: Origin,
}

/// What says which body a wheel has.
const BODY: [Key; 9] =
    [Key::MW, Key::MC, Key::JWxi, Key::JWzeta, Key::JCz, Key::WheelRadius, Key::LC, Key::KU, Key::KQ];

impl PartialEq for Wheel {
    /// Wheels with the same values are the same, whether these were set or not.
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values && self.tyre() == other.tyre()
    }
}

impl Default for Wheel {
    fn default() -> Self {
        let mut values = [0.0; STORED];
        for (value, key) in values.iter_mut().zip(Key::ALL) {
            *value = key.default_value();
        }
        Self { values, tyre: None, origin: Origin::default() }
    }
}

impl Wheel {
    /// The value of a parameter, in SI units.
    #[inline]
    pub fn get(&self, key: Key) -> f64 {
        match key {
            Key::K => self.get(Key::KQ),
            Key::Curvature => self.get(Key::TurningRadius).recip(),
            stored => self.values[stored as usize],
        }
    }

    /// The law of the tyre.
    #[inline]
    pub fn tyre(&self) -> Tyre {
        self.tyre.unwrap_or_default()
    }

    /// Sets the law of the tyre.
    pub fn set_tyre(&mut self, tyre: Tyre) {
        self.tyre = Some(tyre);
    }

    /// Mass of wheel and caster together, in kg.
    pub fn mass(&self) -> f64 {
        self.get(Key::MW) + self.get(Key::MC)
    }

    /// Every stored parameter with its value, in the order of the table; `k` and `curvature` are not among them, those of the
    /// tyre only where there is one.
    pub fn parameters(&self) -> impl Iterator<Item = (Key, f64)> {
        let has_tyre = self.tyre() != Tyre::Rigid;
        Key::ALL.into_iter().zip(self.values).filter(move |(key, _)| has_tyre || !key.is_of_the_tyre())
    }

    /// Sets a parameter from text, as in `-s key=value`; `inf` is infinity. The value of `tyre` is a word.
    ///
    /// # Errors
    /// [`UnknownKey`](KingpinError::UnknownKey), [`NotANumber`](KingpinError::NotANumber),
    /// [`OutOfRange`](KingpinError::OutOfRange) and [`UnknownTyre`](KingpinError::UnknownTyre); the wheel is left as it was.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), KingpinError> {
        if key.trim() == Tyre::KEY {
            self.set_tyre(value.trim().parse()?);
            return Ok(());
        }
        let key: Key = key.trim().parse()?;
        self.set_value(key, parse_number(key, value)?)
    }

    /// Sets a parameter.
    ///
    /// # Errors
    /// [`OutOfRange`](KingpinError::OutOfRange); the wheel is left as it was.
    pub fn set_value(&mut self, key: Key, value: f64) -> Result<(), KingpinError> {
        if !key.allowed().contains(value) {
            return Err(KingpinError::OutOfRange { key, value, position: None });
        }
        let before = self.values;
        match key {
            Key::Curvature => {
                // A curvature below that of the largest radius is taken for straight.
                let radius = value.recip();
                let straight = radius > Key::TurningRadius.allowed().highest;
                self.values[Key::TurningRadius as usize] = if straight { f64::INFINITY } else { radius };
            }
            _ => key.sets().iter().for_each(|&stored| self.values[stored as usize] = value),
        }
        let values = self.values;
        self.origin.note(key, |stored| before[stored as usize] != values[stored as usize]);
        if !self.origin.is_set(Key::MuD) {
            self.values[Key::MuD as usize] = Key::MuD.default_value().min(self.get(Key::MuS));
        }
        if !self.origin.is_set(Key::TP) {
            self.values[Key::TP as usize] = self.get(Key::HalfContactLength) / HALF_LENGTHS_PER_TRAIL;
        }
        Ok(())
    }

    /// The wheel with one parameter changed.
    ///
    /// # Errors
    /// [`OutOfRange`](KingpinError::OutOfRange).
    pub fn with(mut self, key: Key, value: f64) -> Result<Self, KingpinError> {
        let before = self.origin;
        self.set_value(key, value)?;
        self.origin = self.origin.varied_from(before);
        Ok(self)
    }

    /// That the parameters fit together: sliding friction is at most static friction, a tyre has what its law needs, and without
    /// a tyre there is nothing that only a tyre has.
    ///
    /// # Errors
    /// [`SlidingFriction`](KingpinError::SlidingFriction) and those of [`check_tyre`](Self::check_tyre).
    pub fn check(&self) -> Result<(), KingpinError> {
        let (sticking, sliding) = (self.get(Key::MuS), self.get(Key::MuD));
        if sliding > sticking {
            return Err(KingpinError::SlidingFriction { sliding, sticking });
        }
        self.check_tyre()
    }

    /// That a tyre has what its law needs, and that without one nothing is set that only a tyre has.
    ///
    /// # Errors
    /// [`MissingOfTyre`](KingpinError::MissingOfTyre), [`NoFrictionLimit`](KingpinError::NoFrictionLimit),
    /// [`NoTyre`](KingpinError::NoTyre), [`RigidKingPin`](KingpinError::RigidKingPin), and, with
    /// which it is not computed.
    pub fn check_tyre(&self) -> Result<(), KingpinError> {
        let tyre = self.tyre();
        if tyre == Tyre::Rigid {
            let set = |key: &Key| self.get(*key) != key.default_value();
            return match Key::TYRE.into_iter().find(set) {
                // Said to be rigid, a wheel may have been one with a tyre before.
                Some(key) if self.tyre.is_none() => Err(KingpinError::NoTyre { key }),
                _ if self.get(Key::KQ).is_infinite() => Err(KingpinError::RigidKingPin),
                _ => Ok(()),
            };
        }
        let missing = [Key::Sigma, Key::CAlpha].into_iter().find(|key| self.get(*key) == key.default_value());
        if let Some(key) = missing {
            return Err(KingpinError::MissingOfTyre { tyre, key });
        }
        let limit = self.get(Key::MuS) * self.normal_force();
        if tyre == Tyre::Brush && limit <= 0.0 {
            return Err(KingpinError::NoFrictionLimit { limit });
        }
        Ok(())
    }

    /// That the wheel is rigid, for what takes no tyre.
    pub(crate) fn check_rigid(&self) -> Result<(), KingpinError> {
        match self.tyre() {
            Tyre::Rigid => self.check_tyre(),
            tyre => Err(KingpinError::TyreNotTaken { tyre }),
        }
    }

    /// That parameters which are to vary are not those of a tyre where there is none.
    pub(crate) fn check_varies(&self, keys: &[Key]) -> Result<(), KingpinError> {
        match keys.iter().find(|key| key.is_of_the_tyre()) {
            Some(&key) if self.tyre() == Tyre::Rigid => Err(KingpinError::NoTyre { key }),
            _ => Ok(()),
        }
    }

    /// Whether a stored parameter varies with those that do: it is set by one of them, or it is `t_p`, was not set and follows `a`.
    pub fn varies_with(&self, key: Key, active: &[Key]) -> bool {
        let follows =
            key == Key::TP && self.pneumatic_trail_follows() && active.contains(&Key::HalfContactLength);
        follows || active.iter().any(|active| active.sets().contains(&key))
    }

    /// Whether `t_p` is `a/3` because it was not set.
    pub(crate) fn pneumatic_trail_follows(&self) -> bool {
        !self.origin.is_set(Key::TP)
    }

    /// Reads a wheel from TOML: `key = value` lines. Keys that are absent keep the value of the default wheel; `k` and
    /// `curvature` are taken before the keys that they stand for.
    ///
    /// # Errors
    /// What is wrong, with line and column.
    ///
    /// ```
    /// use kingpin::{Key, Wheel};
    /// let wheel = Wheel::from_toml("v = 3.5\nr = \"inf\"")?;
    /// assert_eq!((wheel.get(Key::V), wheel.get(Key::TurningRadius)), (3.5, f64::INFINITY));
    /// let error = Wheel::from_toml("v = 3.5\nk_v = 1").unwrap_err();
    /// assert!(error.to_string().starts_with("line 2, column 1: unknown key `k_v`"));
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn from_toml(text: &str) -> Result<Self, KingpinError> {
        let table = DeTable::parse(text)?;
        let mut settings = Vec::new();
        let mut wheel = Self::default();
        for (name, value) in table.get_ref() {
            let place = |span: std::ops::Range<usize>| Position::of(span.start, text);
            if let DeValue::Table(_) = value.get_ref() {
                let given = name.get_ref().to_string();
                return Err(KingpinError::Section { given, position: Some(place(name.span())) });
            }
            if name.get_ref() == Tyre::KEY {
                let word = value.get_ref().as_str().unwrap_or(&text[value.span()]);
                wheel.set_tyre(word.parse().map_err(|error: KingpinError| error.at(place(value.span())))?);
                continue;
            }
            let key: Key =
                name.get_ref().parse().map_err(|error: KingpinError| error.at(place(name.span())))?;
            let number = match value.get_ref() {
                DeValue::Float(number) => parse_number(key, &number.as_str().replace('_', "")),
                DeValue::Integer(number) if number.radix() == 10 => {
                    parse_number(key, &number.as_str().replace('_', ""))
                }
                DeValue::String(number) => parse_number(key, number),
                _ => Err(KingpinError::NotANumber {
                    key,
                    given: text[value.span()].to_owned(),
                    position: None,
                }),
            };
            let position = place(value.span());
            settings.push((key, number.map_err(|error| error.at(position))?, position));
        }
        settings.sort_by_key(|(key, ..)| key.is_stored());
        for (key, number, position) in settings {
            wheel.set_value(key, number).map_err(|error| error.at(position))?;
        }
        Ok(wheel)
    }

    /// Reads a wheel from a TOML file; see [`from_toml`](Self::from_toml).
    ///
    /// # Errors
    /// [`Unreadable`](KingpinError::Unreadable) or [`InFile`](KingpinError::InFile).
    pub fn read(path: impl AsRef<Path>) -> Result<Self, KingpinError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path)
            .map_err(|source| KingpinError::Unreadable { path: path.to_owned(), source })?;
        let wheel = Self::from_toml(&text)
            .map_err(|source| KingpinError::InFile { path: path.to_owned(), source: Box::new(source) })?;
        Ok(wheel.from_file(&path.file_name().unwrap_or_default().to_string_lossy()))
    }

    /// The wheel as that of a file with this name: what is set from now on is told as [changed](Self::is_changed).
    #[must_use]
    pub fn from_file(mut self, name: &str) -> Self {
        self.origin.is_file(name);
        self
    }

    /// The name of the file that the wheel is from; nothing where it is from none.
    pub fn file_name(&self) -> Option<&str> {
        self.origin.file_name()
    }

    /// Whether a stored parameter was changed since the file was read that the wheel is from; where it is from none, whether it
    /// differs from that of the paper's wheel.
    pub fn is_changed(&self, key: Key) -> bool {
        match self.file_name() {
            Some(_) => self.origin.is_changed(key),
            None => self.get(key) != key.default_value(),
        }
    }

    /// What was not set of masses, moments of inertia, lengths and stiffnesses, and so is that of the paper's wheel.
    pub fn left_to_the_paper(&self) -> impl Iterator<Item = Key> {
        BODY.into_iter().filter(|key| !self.origin.is_set(*key))
    }

    /// Whether `k` was set, and `k_u` or `k_q` too, both in a file or both after it.
    pub fn stiffness_is_given_twice(&self) -> bool {
        self.origin.stiffness_is_given_twice()
    }

    /// Whether `r` and `curvature` were set, both in a file or both after it.
    pub fn radius_is_given_twice(&self) -> bool {
        self.origin.radius_is_given_twice()
    }

    /// The wheel as TOML, which [`from_toml`](Self::from_toml) reads back; what follows from other parameters is left to follow.
    ///
    /// ```
    /// use kingpin::Wheel;
    /// let wheel = Wheel::from_toml("v = 3.5\nr = inf\nM_f = 1e-3")?;
    /// assert_eq!(Wheel::from_toml(&wheel.to_toml())?, wheel);
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn to_toml(&self) -> String {
        let follows = |key: Key| matches!(key, Key::MuD | Key::TP) && !self.origin.is_set(key);
        let tyre = self.tyre.map(|tyre| format!("{} = \"{tyre}\"\n", Tyre::KEY));
        let lines = self.parameters().filter(|&(key, _)| !follows(key)).map(|(key, value)| {
            let unit = if key.unit() == "1" { String::new() } else { format!("{}: ", key.unit()) };
            format!("{key} = {value:?} # {unit}{}\n", key.meaning())
        });
        tyre.into_iter().chain(lines).collect()
    }

    /// That there is no dry friction about the king pin, with which something is not computed.
    pub(crate) fn check_without_dry_friction(
        &self,
        what: &'static str,
        remedy: &'static str,
    ) -> Result<(), KingpinError> {
        let moment = self.get(Key::MF);
        if moment == 0.0 { Ok(()) } else { Err(KingpinError::DryFriction { moment, what, remedy }) }
    }

    /// Yaw rate `omega = v/r` of the towing frame in rad/s.
    #[inline]
    pub fn towing_yaw_rate(&self) -> f64 {
        self.get(Key::V) / self.get(Key::TurningRadius)
    }

    /// Normal force on the wheel, `N = -F_Az + (m_w + m_c) g`, in N; negative where the load lifts the wheel.
    #[inline]
    pub fn normal_force(&self) -> f64 {
        self.mass() * self.get(Key::G) - self.get(Key::FAz)
    }

    /// Whether `mu_d` is `mu_s` because it was not set.
    pub(crate) fn sliding_friction_follows_static(&self) -> bool {
        !self.origin.is_set(Key::MuD) && self.get(Key::MuS) < Key::MuD.default_value()
    }

    /// Whether any of the three dampers acts.
    #[inline]
    pub fn is_damped(&self) -> bool {
        [Key::CU, Key::CQ, Key::CPsi].into_iter().any(|key| self.get(key) != 0.0)
    }

    /// Whether the wheel is of the paper's kind: equal stiffnesses, no dampers, no spring about the king pin, no tyre.
    #[inline]
    pub fn is_plain(&self) -> bool {
        self.tyre() == Tyre::Rigid
            && !self.is_damped()
            && self.get(Key::KPsi) == 0.0
            && self.get(Key::KU) == self.get(Key::KQ)
    }
}

fn parse_number(key: Key, given: &str) -> Result<f64, KingpinError> {
    match given.trim().parse::<f64>() {
        Ok(number) if !number.is_nan() => Ok(number),
        _ => Err(KingpinError::NotANumber { key, given: given.trim().to_owned(), position: None }),
    }
}
