//! How finely solutions are resolved: intervals, collocation points and tolerance.

use crate::branch::invalid;
use crate::error::Error;

/// How finely solutions are resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Error estimate, relative to the size of each component (of a cycle: its amplitude), that no reported solution exceeds.
    pub tolerance: f64,
    /// Degree of the polynomials, 2 to 16.
    pub degree: usize,
    /// Fewest mesh intervals.
    pub fewest_intervals: usize,
    /// Most mesh intervals.
    pub most_intervals: usize,
}

impl Resolution {
    /// Resolution for a tolerance, with the degree that makes a branch cheapest: a matrix of `m` Gauss points costs `m^3` and
    /// the intervals needed fall with the tolerance to the power `-1/(m+1)`. Measured on the cycles of four models at
    /// tolerances of 1e-2 to 1e-10, the best degree grows by 0.6 to 0.7 per digit and a miss of one costs a tenth.
    pub fn with_tolerance(tolerance: f64) -> Self {
        let digits = -tolerance.log10();
        let degree = (2.5 + 0.6 * digits).round().clamp(3.0, 11.0) as usize;
        Self { tolerance, degree, fewest_intervals: 4, most_intervals: 2000 }
    }

    /// That all numbers make sense.
    ///
    /// # Errors
    /// [`Error::Invalid`]
    pub(crate) fn validate(&self) -> Result<(), Error> {
        if !(2..=16).contains(&self.degree) {
            return Err(invalid("degree", &self.degree.to_string(), "2 to 16"));
        }
        let (fewest, most) = (self.fewest_intervals, self.most_intervals);
        if !(1 < fewest && fewest <= most) {
            let allowed = format!("2 to {most}, the most intervals");
            return Err(invalid("fewest intervals", &fewest.to_string(), &allowed));
        }
        if !(self.tolerance > 1e-13 && self.tolerance < 0.1) {
            return Err(invalid("tolerance", &self.tolerance.to_string(), "between 1e-13 and 0.1"));
        }
        Ok(())
    }
}

impl Default for Resolution {
    /// For a tolerance of 1e-8.
    fn default() -> Self {
        Self::with_tolerance(1e-8)
    }
}
