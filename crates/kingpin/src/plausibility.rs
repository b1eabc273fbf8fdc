//! Parameters that no wheel has which somebody built: mostly numbers in other units.
//!
//! What cannot be at all, such as a negative mass, is out of the [range](crate::parameters::Allowed) of its key and an error. What is told
//! here is none: the equations take the moments of inertia only in sums with the masses, in which a value may stand for what another
//! part has, a motor that turns with the wheel for example.

use crate::parameters::{Key, Tyre};
use crate::wheel::Wheel;
use arclength_numbers::readable;
use std::f64::consts::TAU;
use std::fmt;

/// Largest radius in m of a wheel.
const LARGEST_RADIUS: f64 = 5.0;
/// Longest caster in radii of the wheel, and farthest centre of gravity in lengths of both.
const LONGEST: f64 = 100.0;
const FARTHEST: f64 = 10.0;
/// More than the density of the heaviest metals in kg/m^3.
const DENSITY: f64 = 2.3e4;
/// Part by which a moment of inertia may be beyond a limit that thin bodies come to: numbers are rounded.
const ROUNDED: f64 = 0.02;
/// Largest radius of gyration in lengths of the body.
const LARGEST_GYRATION: f64 = 10.0;
/// Largest speed in m/s and acceleration of gravity in m/s^2.
const FASTEST: f64 = 400.0;
const HEAVIEST: f64 = 100.0;
/// Longest relaxation length in radii of the wheel.
const LONGEST_RELAXATION: f64 = 100.0;
/// A value in another unit is what was meant if it is within the limit and not smaller than this part of it.
const TYPICAL: f64 = 1e-4;
/// The moment of inertia of a wheel about its axis is not smaller than this part of the limit.
const TYPICAL_OF_WHEELS: f64 = 0.05;

/// A value that no built wheel has.
#[derive(Clone, Debug, PartialEq)]
pub struct Implausible {
    /// The parameter.
    pub key: Key,
    /// Its value.
    pub value: f64,
    /// What it is beyond.
    pub limit: Limit,
    /// Another unit in which the number may be, and what it is in that of the key.
    pub meant: Option<(&'static str, f64)>,
}

/// What a value is to be at most or at least.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// The value.
    pub value: f64,
    /// Whether it is the largest one; else it is the smallest.
    pub is_largest: bool,
    /// The same made of other parameters; empty where it is a number.
    pub formula: &'static str,
    /// What has it.
    pub of: &'static str,
}

impl fmt::Display for Implausible {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, value, limit, meant } = self;
        let quantity = |value: f64| format!("{} {}", readable(value), key.unit());
        let formula = if limit.formula.is_empty() { String::new() } else { format!("{} = ", limit.formula) };
        let side = if limit.is_largest { "at most" } else { "at least" };
        let limit = format!("{side} {formula}{}, {}", quantity(limit.value), limit.of);
        write!(formatter, "{key} = {} is not that of a wheel: {limit}", quantity(*value))?;
        match meant {
            Some((unit, meant)) => write!(formatter, "; is it in {unit}? that is {}", quantity(*meant)),
            None => Ok(()),
        }
    }
}

/// A limit on a parameter, and the others that it is made of.
struct Check {
    key: Key,
    others: Vec<Key>,
    limit: Limit,
    /// The smallest part of the limit that is usual.
    usual: f64,
}

impl Check {
    fn at_most(key: Key, value: f64, (formula, others): (&'static str, &[Key]), of: &'static str) -> Self {
        let limit = Limit { value, is_largest: true, formula, of };
        Self { key, others: others.to_vec(), limit, usual: TYPICAL }
    }

    /// What is wrong with a value.
    fn of(&self, value: f64) -> Option<Implausible> {
        let size = value.abs();
        let is_beyond = if self.limit.is_largest { size > self.limit.value } else { size < self.limit.value };
        is_beyond.then(|| Implausible {
            key: self.key,
            value,
            limit: self.limit.clone(),
            meant: self.meant(value),
        })
    }

    /// The first of some units of the same quantity in which the number would be usual.
    fn meant(&self, value: f64) -> Option<(&'static str, f64)> {
        let units: &[(&'static str, f64)] = match self.key.unit() {
            "m" => &[("mm", 1e-3)],
            "kg" => &[("g", 1e-3)],
            "kg m^2" => {
                &[("kg mm^2", 1e-6), ("kg cm^2", 1e-4), ("g cm^2", 1e-7), ("g mm^2", 1e-9), ("g m^2", 1e-3)]
            }
            "m/s" => &[("mm/s", 1e-3)],
            "m/s^2" => &[("cm/s^2", 1e-2)],
            _ => &[],
        };
        let usual = self.usual * self.limit.value..=self.limit.value;
        let meant = units.iter().map(|(unit, size)| (*unit, value * size));
        meant.into_iter().find(|(_, meant)| self.limit.is_largest && usual.contains(&meant.abs()))
    }
}

impl Wheel {
    /// What of its parameters no built wheel has, as far as that can be told from those that do not vary. What follows from a value that is
    /// told already is not told again.
    ///
    /// ```
    /// use kingpin::{Key, Wheel};
    /// assert_eq!(Wheel::default().implausible(&[]), []);
    /// let wheel = Wheel::default().with(Key::MW, 351.9)?;
    /// let told = wheel.implausible(&[])[0].to_string();
    /// assert!(told.starts_with("m_w = 351.9 kg is not that of a wheel: at most"), "{told}");
    /// assert!(told.ends_with("is it in g? that is 0.3519 kg"), "{told}");
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn implausible(&self, varying: &[Key]) -> Vec<Implausible> {
        let mut told: Vec<Implausible> = Vec::new();
        for check in self.checks() {
            let is_known =
                |key: &Key| !self.varies_with(*key, varying) && !told.iter().any(|other| other.key == *key);
            if check.others.iter().chain([&check.key]).all(is_known) {
                told.extend(check.of(self.get(check.key)));
            }
        }
        told
    }

    /// What a plausible wheel keeps, in an order in which what others are made of comes first.
    fn checks(&self) -> Vec<Check> {
        use Key::{G, HalfContactLength, JCz, JWxi, JWzeta, L, LC, MC, MW, Sigma, TP, V, WheelRadius as R};
        let get = |key: Key| self.get(key);
        let (radius, length) = (get(R), get(L));
        let reach = length + radius;
        let of_caster = reach.max(get(LC).abs());
        let gyration = |mass: f64, length: f64| mass * (LARGEST_GYRATION * length).powi(2);
        let of_rim = get(MW) * radius * radius;
        let spin = Check {
            usual: TYPICAL_OF_WHEELS,
            ..Check::at_most(JWxi, of_rim * (1.0 + ROUNDED), ("m_w R^2", &[MW, R]), "which a thin rim has")
        };
        // Any unit would do.
        let of_many =
            |key, value, formula, of| Check { usual: 1.0, ..Check::at_most(key, value, formula, of) };
        let diameter = Check {
            key: JWzeta,
            others: vec![JWxi],
            limit: Limit {
                value: 0.5 * get(JWxi) * (1.0 - ROUNDED),
                is_largest: false,
                formula: "J_wxi/2",
                of: "which a thin disc has: no moment of inertia is more than the sum of the two others",
            },
            usual: TYPICAL,
        };
        let mut checks = vec![
            Check::at_most(R, LARGEST_RADIUS, ("", &[]), "more than the largest wheels have"),
            Check::at_most(L, LONGEST * radius, ("100 R", &[R]), "longer than any caster"),
            Check::at_most(
                LC,
                FARTHEST * reach,
                ("10 (l + R)", &[L, R]),
                "farther from the king pin than the caster reaches",
            ),
            Check::at_most(
                MW,
                DENSITY * TAU * radius.powi(3),
                ("2 pi R^3 23000 kg/m^3", &[R]),
                "the mass of solid metal as wide as high",
            ),
            Check::at_most(
                MC,
                DENSITY * of_caster.powi(3),
                ("(l + R)^3 23000 kg/m^3", &[L, R, LC]),
                "the mass of solid metal as long, as wide and as high as caster and wheel",
            ),
            spin,
            diameter,
            of_many(
                JWzeta,
                gyration(get(MW), reach),
                ("m_w (10 (l + R))^2", &[MW, L, R]),
                "whose radius of gyration is ten times the caster and the wheel",
            ),
            of_many(
                JCz,
                gyration(get(MC), of_caster),
                ("m_c (10 (l + R))^2", &[MC, L, R, LC]),
                "whose radius of gyration is ten times the caster and the wheel",
            ),
            Check::at_most(V, FASTEST, ("", &[]), "faster than anything on wheels"),
            Check::at_most(G, HEAVIEST, ("", &[]), "more than on any planet"),
        ];
        if self.tyre() != Tyre::Rigid {
            let tyre = ("R", &[R][..]);
            checks.extend([
                Check::at_most(
                    HalfContactLength,
                    radius,
                    tyre,
                    "half of what a wheel can touch the ground with",
                ),
                Check::at_most(
                    Sigma,
                    LONGEST_RELAXATION * radius,
                    ("100 R", &[R]),
                    "longer than that of any tyre",
                ),
                Check::at_most(TP, radius, tyre, "farther from the middle of the contact than it reaches"),
            ]);
        }
        checks
    }
}
