//! What a fit is asked for by.

use super::consequences::Consequences;
use super::record_file::{self, RecordFile};
use super::record_request::RecordRequest;
use super::result::FitResult;
use crate::disturbance::natural_period;
use crate::error::Error;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Assignment, Control};
use kingpin::identification::{Identification, IdentificationError, Record, Start};
use kingpin::{Key, Wheel};
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::path::PathBuf;

/// Samples that are farther apart than so many swings tell nothing of what is between them. The wheel is that from which the search
/// starts, whose stiffness may be wrong a hundred times.
const SWINGS_BETWEEN_SAMPLES: f64 = 10.0;

/// Part of the time that the fit takes, roughly.
const PART_OF_FIT: f64 = 0.5;

/// Parameters of a wheel from records of its motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FitRequest {
    /// Which wheel, and the values to start from of what is estimated.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// The records.
    pub records: Vec<RecordRequest>,
    /// Keys of what is estimated; the usual ones where there is none.
    pub estimate: Vec<String>,
    /// Measured states that count; all where there is none.
    pub states: Vec<String>,
    /// What is known of states at the first sample: a value, `uniform` or `free`.
    pub start: Vec<Assignment>,
    /// States whose instruments have an unknown zero.
    pub offset: Vec<String>,
    /// Standard deviations of the noise that are known.
    pub sigma: Vec<Assignment>,
    /// That no safe blow is wanted.
    pub no_blow: bool,
}

/// A request that makes sense, with its records.
#[derive(Clone, Debug)]
pub struct FitAnalysis {
    wheel: Wheel,
    files: Vec<PathBuf>,
    records: Vec<Record>,
    keys: Vec<Key>,
    identification: Identification,
    with_blow: bool,
    warnings: Vec<String>,
}

impl FitRequest {
    /// Reads the wheel and the records, and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel, a file or a field.
    pub fn validate(&self) -> Result<FitAnalysis, Error> {
        let wheel = self.wheel.read()?;
        let keys = self.keys(&wheel)?;
        let mut warnings = Vec::new();
        let mut records = Vec::new();
        for request in &self.records {
            let (record, told) = self.record(request, &wheel, &keys)?;
            records.push(record);
            warnings.extend(told);
        }
        let files: Vec<PathBuf> = self.records.iter().map(|request| request.file.clone()).collect();
        let identification = self.identification(&records, &keys);
        let identification = identification.map_err(|error| with_file(error, &files))?;
        Ok(FitAnalysis { wheel, files, records, keys, identification, with_blow: !self.no_blow, warnings })
    }

    fn keys(&self, wheel: &Wheel) -> Result<Vec<Key>, Error> {
        if self.estimate.is_empty() {
            return Ok(wheel.usually_estimated());
        }
        let key = |name: &String| {
            name.trim().parse::<Key>().map_err(|error| {
                let problem = error.to_string();
                Error::invalid(
                    &["estimate"],
                    name.as_str(),
                    problem,
                    "keys of parameters, such as k,c_psi,M_f",
                )
            })
        };
        self.estimate.iter().map(key).collect()
    }

    /// A record of a file, with the wheel at its parameters, and what is worth knowing about it.
    fn record(
        &self,
        request: &RecordRequest,
        wheel: &Wheel,
        keys: &[Key],
    ) -> Result<(Record, Vec<String>), Error> {
        let file = &request.file;
        let RecordFile { times, columns, settings, passed_over, not_understood } =
            record_file::read(file, wheel.free_states(), &self.states)?;
        let mut of_record = *wheel;
        for Assignment { key, value } in settings.iter().chain(&request.set) {
            let problem = |problem: String| Error::Record { path: file.clone(), problem };
            of_record.set(key, value).map_err(|error| problem(format!("{key}={value}: {error}")))?;
            let sets = key.parse::<Key>().map(Key::sets).unwrap_or_default();
            if keys.iter().any(|key| key.sets().iter().any(|stored| sets.contains(stored))) {
                let allowed = "set what is not estimated, or leave it out of the estimated parameters";
                return Err(problem(format!(
                    "{key} is estimated and cannot be {value} for one record; {allowed}"
                )));
            }
        }
        let told = |(line, problem): &(u64, String)| format!("{}: line {line}: {problem}", file.display());
        let mut warnings: Vec<String> = not_understood.iter().map(told).collect();
        let dependent: Vec<&str> = passed_over
            .iter()
            .map(String::as_str)
            .filter(|name| of_record.states().contains(name) && !of_record.free_states().contains(name))
            .collect();
        if !dependent.is_empty() {
            warnings.push(format!(
                "{}: {} follow from the other states and were passed over",
                file.display(),
                dependent.join(", ")
            ));
        }
        let intervals = times.windows(2).map(|pair| pair[1] - pair[0]);
        let shortest = intervals.fold(f64::INFINITY, f64::min);
        let period = natural_period(&of_record);
        if shortest.is_finite() && shortest > SWINGS_BETWEEN_SAMPLES * period {
            return Err(Error::Record {
                path: file.clone(),
                problem: format!(
                    "samples are at least {} s apart, and this wheel swings in {} s: a motion between them is not told; t is \
                     taken in seconds, divide milliseconds by 1000, or start from a softer wheel",
                    readable(shortest),
                    readable(period)
                ),
            });
        }
        let largest_angle =
            columns.iter().filter(|column| column.state == "psi").flat_map(|column| &column.values);
        let largest_angle = largest_angle.fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
        if largest_angle > TAU {
            warnings.push(format!(
                "{}: psi reaches {largest_angle}; it is taken in radians, divide degrees by 57.29578",
                file.display()
            ));
        }
        Ok((Record { wheel: of_record, times, columns }, warnings))
    }

    fn identification(&self, records: &[Record], keys: &[Key]) -> Result<Identification, Error> {
        let mut identification = Identification::new(records.to_vec(), keys)?;
        for Assignment { key, value } in &self.start {
            let start = match value.as_str() {
                "uniform" => Start::Uniform,
                "free" => Start::Free,
                number => Start::At(
                    number.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
                        let given = format!("{key}={value}");
                        Error::invalid(&["start"], given, "no start", "a finite number, `uniform` or `free`")
                    })?,
                ),
            };
            identification = identification.start(key, start)?;
        }
        for state in &self.offset {
            identification = identification.offset(state)?;
        }
        for Assignment { key, value } in &self.sigma {
            let deviation = value.parse().map_err(|_| {
                let given = format!("{key}={value}");
                Error::invalid(
                    &["sigma"],
                    given,
                    "no standard deviation",
                    "a positive number in the unit of the state",
                )
            })?;
            identification = identification.deviation(key, deviation)?;
        }
        Ok(identification)
    }
}

/// An error in which a record has the name of its file.
fn with_file(error: Error, files: &[PathBuf]) -> Error {
    match error {
        Error::Identification(IdentificationError::Record { record, problem }) => {
            Error::Record { path: files[record].clone(), problem }
        }
        error => error,
    }
}

impl FitAnalysis {
    /// What is worth knowing before it runs.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Estimates the parameters, and what follows from them.
    ///
    /// # Errors
    /// [`Error::Identification`], a motion that cannot be followed, and [`Error::Stopped`] where the control stops it.
    pub fn run(&self, control: &Control<'_>) -> Result<FitResult, Error> {
        let fit = control.part(0.0..PART_OF_FIT);
        let identified =
            self.identification.run(&fit).map_err(|error| with_file(error.into(), &self.files))?;
        let mut wheel = self.wheel;
        for &key in &self.keys {
            wheel.set_value(key, identified.wheel.get(key))?;
        }
        let rest = control.part(PART_OF_FIT..1.0);
        let consequences = match identified.undetermined.is_empty() {
            true => Some(Consequences::of(&self.identification, &identified, &wheel, self.with_blow, &rest)?),
            false => None,
        };
        FitResult::new(wheel, &self.keys, &self.files, &self.records, identified, consequences)
    }
}
