//! Charts over a grid in the plane of two parameters, on all cores.
//!
//! A growth-rate chart takes the roots of the characteristic polynomial at every point. Where only stability is asked
//! for, a plain wheel needs no root: the Routh-Hurwitz conditions are evaluated eight points at a time, with the vector
//! instructions of the processor, but no fused ones, so that the chart does not depend on it.

use crate::body::Body;
use crate::error::KingpinError;
use crate::hurwitz::{determinants, hopf_condition, plain_characteristic_polynomial};
use crate::parameters::Key;
use crate::plane::Plane;
use crate::wheel::Wheel;
use arclength::control::Control;
use arclength::lanes::{self, Kernel};
use rayon::prelude::*;
use std::ops::Range;

/// Most points of a grid.
pub const MOST_POINTS: usize = 100_000_000;
/// Points that one core computes before it asks for more, at least.
const POINTS_PER_CHUNK: usize = 4096;
/// Points of a row that are taken together.
const LANES: usize = 8;

/// Rounding error of the Hopf condition, a pure number of the order of one.
const HOPF_ROUNDING: f64 = 64.0 * f64::EPSILON;

type Lanes = lanes::Lanes<LANES>;

/// Stability and rolling on a grid. The rows of the grid follow each other: point `(column, row)` has the index
/// `row * x.len() + column`.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilityChart {
    /// Values of the parameter along x.
    pub x: Vec<f64>,
    /// Values of the parameter along y.
    pub y: Vec<f64>,
    /// Whether the uniform motion exists and is linearly stable beyond rounding errors.
    pub stable: Vec<bool>,
    /// Whether it exists and the ground can hold the wheel in it.
    pub rolls: Vec<bool>,
}

/// Growth rate, stability and rolling on a grid, in the order of [`StabilityChart`].
#[derive(Clone, Debug, PartialEq)]
pub struct GrowthRateChart {
    /// Values of the parameter along x.
    pub x: Vec<f64>,
    /// Values of the parameter along y.
    pub y: Vec<f64>,
    /// Largest real part of the eigenvalues in 1/s; `None` where there is no uniform motion.
    pub growth_rate: Vec<Option<f64>>,
    /// Whether the uniform motion exists and is linearly stable; `None` where rounding could decide that either way.
    pub stable: Vec<Option<bool>>,
    /// Whether it exists and the ground can hold the wheel in it.
    pub rolls: Vec<bool>,
}

/// Growth rate, stability and rolling at some points of a grid, as in a [`GrowthRateChart`].
#[derive(Clone, Debug, PartialEq)]
pub struct GrowthRates {
    /// Largest real part of the eigenvalues in 1/s; `None` where there is no uniform motion.
    pub growth_rate: Vec<Option<f64>>,
    /// Whether the uniform motion exists and is linearly stable; `None` where rounding could decide that either way.
    pub stable: Vec<Option<bool>>,
    /// Whether it exists and the ground can hold the wheel in it.
    pub rolls: Vec<bool>,
}

impl Wheel {
    /// The growth rate of the uniform motion on a grid of `[columns, rows]` points.
    ///
    /// ```
    /// use kingpin::{Axis, Key, Plane, Wheel};
    /// use arclength::control::Control;
    /// let plane = Plane::new(Axis::new(Key::V, 1.0..=10.0)?, Axis::new(Key::L, 0.05..=0.2)?)?;
    /// let chart = Wheel::default().growth_rate_chart(&plane, [10, 4], &Control::none())?;
    /// assert_eq!((chart.stable[0], chart.stable[9]), (Some(true), Some(false)));
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    ///
    /// # Errors
    /// [`GridSize`](KingpinError::GridSize), [`DryFrictionVaries`](KingpinError::DryFrictionVaries) and
    /// [`Interrupted`](KingpinError::Interrupted).
    pub fn growth_rate_chart(
        &self,
        plane: &Plane,
        points: [usize; 2],
        control: &Control<'_>,
    ) -> Result<GrowthRateChart, KingpinError> {
        let (x, y) = axes(plane, points)?;
        let rates = self.growth_rates(plane, points, 0..x.len() * y.len(), control)?;
        let GrowthRates { growth_rate, stable, rolls } = rates;
        Ok(GrowthRateChart { x, y, growth_rate, stable, rolls })
    }

    /// The growth rate of the uniform motion at some points of such a grid, counted row by row: the same numbers as in the whole chart.
    ///
    /// # Errors
    /// As [`growth_rate_chart`](Self::growth_rate_chart).
    ///
    /// # Panics
    /// Panics if the grid has fewer points.
    pub fn growth_rates(
        &self,
        plane: &Plane,
        points: [usize; 2],
        range: Range<usize>,
        control: &Control<'_>,
    ) -> Result<GrowthRates, KingpinError> {
        let (x, y) = axes(plane, points)?;
        assert!(range.end <= x.len() * y.len(), "{range:?} of {} points", x.len() * y.len());
        self.check_varies(&[plane.x().key(), plane.y().key()])?;
        let mut growth_rate = vec![None; range.len()];
        let mut stable = vec![Some(false); range.len()];
        let mut rolls = vec![false; range.len()];
        let (x_key, y_key) = (plane.x().key(), plane.y().key());
        let progress = control.count(range.len());
        let results = (
            growth_rate.par_chunks_mut(POINTS_PER_CHUNK),
            stable.par_chunks_mut(POINTS_PER_CHUNK),
            rolls.par_chunks_mut(POINTS_PER_CHUNK),
        );
        results.into_par_iter().enumerate().try_for_each(|(chunk, (growth_rate, stable, rolls))| {
            let results = growth_rate.iter_mut().zip(stable).zip(rolls);
            let first = range.start + chunk * POINTS_PER_CHUNK;
            for (index, ((growth_rate, stable), rolls)) in (first..).zip(results) {
                control.check()?;
                let (x, y) = (x[index % x.len()], y[index / x.len()]);
                let wheel = self.with(y_key, y).and_then(|wheel| wheel.with(x_key, x))?;
                let Some(point) = wheel.chart_point() else { continue };
                (*growth_rate, *stable, *rolls) = (Some(point.growth_rate), point.stable, point.rolls);
            }
            progress.advance(range.len().min((chunk + 1) * POINTS_PER_CHUNK) - chunk * POINTS_PER_CHUNK);
            Ok::<_, KingpinError>(())
        })?;
        Ok(GrowthRates { growth_rate, stable, rolls })
    }

    /// Stability and rolling of the uniform motion on a grid of `[columns, rows]` points, without eigenvalues.
    ///
    /// # Errors
    /// As [`growth_rate_chart`](Self::growth_rate_chart).
    pub fn stability_chart(
        &self,
        plane: &Plane,
        points: [usize; 2],
        control: &Control<'_>,
    ) -> Result<StabilityChart, KingpinError> {
        let (x, y) = axes(plane, points)?;
        let keys = [plane.x().key(), plane.y().key()];
        let both = [Key::KU, Key::KQ].map(|key| keys.iter().any(|active| active.sets().contains(&key)));
        let stays_plain = [Key::KPsi, Key::CU, Key::CQ, Key::CPsi].iter().all(|key| !keys.contains(key))
            && (keys.contains(&Key::K) || both == [false; 2]);
        // `k` on an axis makes both stiffnesses equal.
        let corner = self.with(keys[0], x[0])?.with(keys[1], y[0])?;
        if !(corner.is_plain() && stays_plain) {
            let GrowthRateChart { x, y, stable, rolls, .. } =
                self.growth_rate_chart(plane, points, control)?;
            let stable = stable.into_iter().map(|stable| stable == Some(true)).collect();
            return Ok(StabilityChart { x, y, stable, rolls });
        }
        let mut stable = vec![false; x.len() * y.len()];
        let mut rolls = vec![false; x.len() * y.len()];
        let width = x.len();
        let chunk = rows_per_chunk(width) * width;
        let progress = control.count(y.len());
        (stable.par_chunks_mut(chunk), rolls.par_chunks_mut(chunk))
            .into_par_iter()
            .zip(y.par_chunks(rows_per_chunk(width)))
            .try_for_each(|((stable, rolls), y)| {
                for ((stable, rolls), &y) in stable.chunks_mut(width).zip(rolls.chunks_mut(width)).zip(y) {
                    control.check()?;
                    let row = corner.with(keys[1], y)?;
                    lanes::run(PlainRow { row: &row, key: keys[0], x: &x, stable, rolls });
                }
                progress.advance(y.len());
                Ok::<_, KingpinError>(())
            })?;
        Ok(StabilityChart { x, y, stable, rolls })
    }
}

fn axes(plane: &Plane, [columns, rows]: [usize; 2]) -> Result<(Vec<f64>, Vec<f64>), KingpinError> {
    let few_enough = columns.checked_mul(rows).is_some_and(|points| points <= MOST_POINTS);
    if columns < 2 || rows < 2 || !few_enough {
        return Err(KingpinError::GridSize { columns, rows, most: MOST_POINTS });
    }
    if [plane.x(), plane.y()].iter().any(|axis| axis.key() == Key::MF) {
        return Err(KingpinError::DryFrictionVaries);
    }
    Ok((plane.x().values(columns), plane.y().values(rows)))
}

fn rows_per_chunk(width: usize) -> usize {
    POINTS_PER_CHUNK.div_ceil(width)
}

/// One row of a stability chart of plain wheels.
struct PlainRow<'a> {
    row: &'a Wheel,
    key: Key,
    x: &'a [f64],
    stable: &'a mut [bool],
    rolls: &'a mut [bool],
}

impl Kernel for PlainRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let results = self.stable.chunks_mut(LANES).zip(self.rolls.chunks_mut(LANES));
        for (x, (stable, rolls)) in self.x.chunks(LANES).zip(results) {
            // The last lanes repeat the last point where the row ends before them.
            let points = Lanes::from(std::array::from_fn(|lane| x[lane.min(x.len() - 1)]));
            let [stability, adhesion] = plain_margins(self.row, self.key, points);
            for (lane, (stable, rolls)) in stable.iter_mut().zip(rolls).enumerate() {
                (*stable, *rolls) = (stability.0[lane] > 0.0, adhesion.0[lane] > 0.0);
            }
        }
    }
}

/// Two numbers: positive where the uniform motion exists and is stable, and where it exists and rolls.
#[inline(always)]
fn plain_margins(wheel: &Wheel, key: Key, x: Lanes) -> [Lanes; 2] {
    let sets = key.sets();
    let get = |asked: Key| if sets.contains(&asked) { x } else { Lanes::from(wheel.get(asked)) };
    let one = Lanes::from(1.0);
    let body = Body::new(get);
    let curvature = match key {
        Key::Curvature => x,
        Key::TurningRadius => one / x,
        _ => Lanes::from(wheel.get(Key::Curvature)),
    };
    let v = get(Key::V);
    let omega = v * curvature;
    let squared = omega * omega;
    let polynomial = plain_characteristic_polynomial(&body, squared);
    let [second, _] = determinants(polynomial);
    let [c1, _, c3, _, c5] = polynomial;
    let [stiff, inertial] = hopf_condition(&body);
    // Both terms are of the order of one where they decide, and so is their rounding in units of the last place.
    let hopf = Lanes::from(-HOPF_ROUNDING) - stiff - inertial * squared;

    // l - a0 = l (1 - rho)
    let elastic = body.lateral_stiffness * body.caster_length;
    let remaining = elastic - body.static_moment * squared;
    let sine = remaining / body.lateral_stiffness * curvature;
    let cosine_squared = one - sine * sine;
    let exists = remaining.smaller(cosine_squared).smaller(v);
    let stability = exists.smaller(c1).smaller(c3).smaller(c5).smaller(second).smaller(hopf);

    // F_f^2 = ((m_w + m_c l_c/l) V0 omega)^2 with V0 = v cos psi0 k l/(k l - m omega^2), against (mu_s N)^2.
    let (m_w, m_c) = (get(Key::MW), get(Key::MC));
    let mass = m_w + m_c * get(Key::LC) / body.caster_length;
    let speed = v * elastic * omega * mass;
    let normal = (m_w + m_c) * get(Key::G) - get(Key::FAz);
    let limit = get(Key::MuS) * normal * remaining;
    let adhesion = limit * limit - speed * speed * cosine_squared;
    [stability, exists.smaller(normal).smaller(adhesion)]
}
