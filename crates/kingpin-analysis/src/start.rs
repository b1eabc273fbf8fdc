//! Labelled points of earlier results from which computations start, checked to be what they claim.

use crate::error::Error;
use crate::result_file::ResultFile;
use arclength::branch::SpecialKind;
use arclength::cycle::{Branching, Orbit};
use arclength_analysis::{Files, PointReference};
use kingpin::branches::Along;
use kingpin::{Key, Wheel};

/// A labelled point with its wheel.
#[derive(Clone, Debug)]
pub(crate) struct LabelledPoint {
    /// The wheel there.
    pub wheel: Wheel,
    /// What it is.
    pub solution: LabelledSolution,
}

/// What a labelled point is.
#[derive(Clone, Debug)]
pub(crate) enum LabelledSolution {
    /// A Hopf point, with a parameter along which it was found.
    Hopf(Along),
    /// A cycle.
    Cycle {
        /// The cycle itself.
        orbit: Box<Orbit>,
        /// The start of the branch that leaves there, with the parameter along which it was found.
        branching: Option<(Box<Branching>, Key)>,
    },
}

impl LabelledPoint {
    /// Reads a labelled point from its file.
    ///
    /// # Errors
    /// [`Error::Start`]: no such file, not a result that can be started from, no such label, or a point that does not fit its
    /// wheel.
    pub(crate) fn read(reference: &PointReference, files: &dyn Files) -> Result<Self, Error> {
        let file =
            ResultFile::read_among(files, &reference.path).map_err(|problem| reference.failure(problem))?;
        let labels = file.labels();
        let missing = || reference.no_such_label(&labels);
        let is_wanted = |label: &Option<String>| label.as_ref() == Some(&reference.label);
        let name = reference.path.file_name().unwrap_or_default().to_string_lossy();
        let at = |wheel: Wheel, values: &[(Key, f64)]| {
            let wheel = values.iter().try_fold(wheel, |wheel, &(key, value)| wheel.with(key, value));
            wheel.map(|wheel| wheel.from_file(&name)).map_err(|error| reference.failure(error.to_string()))
        };
        match file {
            ResultFile::Hopf(result) => {
                let point = result.points.iter().find(|point| point.label == reference.label);
                let point = point.ok_or_else(missing)?;
                let wheel = at(result.wheel, &[(result.interval.key(), point.value)])?;
                Ok(Self { wheel, solution: LabelledSolution::Hopf(result.interval) })
            }
            ResultFile::Cycles(result) => {
                let place = result.points.iter().position(|point| is_wanted(&point.cycle.label));
                let cycle = &result.points[place.ok_or_else(missing)?].cycle;
                let wheel = at(result.wheel, &[(result.interval.key(), cycle.value)])?;
                let Some(orbit) = cycle.orbit.clone() else {
                    return Ok(Self { wheel, solution: LabelledSolution::Hopf(result.interval) });
                };
                let branching = cycle.branching.clone().map(|branching| (branching, result.interval.key()));
                Self::cycle(reference, wheel, orbit, branching)
            }
            ResultFile::MotionLocus(result) => {
                let point = result.curve.points.iter().find(|point| is_wanted(&point.label));
                let [one, two] = point.ok_or_else(missing)?.values;
                let [first, second] = result.plane.keys();
                let wheel = at(result.wheel, &[(first, one), (second, two)])?;
                if result.curve.kind != Some(SpecialKind::Hopf) {
                    let label = &reference.label;
                    let problem = format!(
                        "{label} is a uniform motion, at which nothing can be started; allowed: Hopf points (HB), cycles"
                    );
                    return Err(reference.failure(problem).into());
                }
                Ok(Self { wheel, solution: LabelledSolution::Hopf(result.plane.0[0]) })
            }
            ResultFile::CycleLocus(result) => {
                let point = result.curve.points.iter().find(|point| is_wanted(&point.label));
                let point = point.ok_or_else(missing)?;
                let [first, second] = result.plane.keys();
                let wheel = at(result.wheel, &[(first, point.values[0]), (second, point.values[1])])?;
                let orbit = point.orbit.clone();
                let orbit = orbit.ok_or_else(|| {
                    reference.failure(format!("{} is stored without its orbit", reference.label))
                })?;
                Self::cycle(reference, wheel, orbit, None)
            }
        }
    }

    fn cycle(
        reference: &PointReference,
        wheel: Wheel,
        orbit: Orbit,
        branching: Option<(Branching, Key)>,
    ) -> Result<Self, Error> {
        if let Some((branching, _)) = &branching {
            branching.check(orbit.dimension).map_err(|error| reference.failure(error.to_string()))?;
        }
        let branching = branching.map(|(branching, key)| (Box::new(branching), key));
        Ok(Self { wheel, solution: LabelledSolution::Cycle { orbit: orbit.into(), branching } })
    }

    /// That the orbit is one of a wheel.
    ///
    /// # Errors
    /// [`Error::Start`].
    pub(crate) fn check_orbit(reference: &PointReference, wheel: &Wheel, orbit: &Orbit) -> Result<(), Error> {
        let states = wheel.free_states();
        if orbit.dimension != states.len() {
            let problem = format!(
                "the orbit of {} has {} states, this wheel {} ({}): leave k_u as it is in the file",
                reference.label,
                orbit.dimension,
                states.len(),
                states.join(", ")
            );
            return Err(reference.failure(problem).into());
        }
        Ok(reference.check(orbit, states.len())?)
    }
}
