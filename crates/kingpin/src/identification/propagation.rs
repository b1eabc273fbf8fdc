//! Parameters as likely as the estimates make them, for what follows from them.
//!
//! They are drawn from Student's t distribution about the unconstrained minimum of the quadratic model, with its covariance, and those that
//! a parameter may not have are drawn again.

use super::distributions::half_width;
use crate::parameters::Key;
use crate::wheel::Wheel;
use std::f64::consts::TAU;

/// Draws for each sample that is wanted after which the search for allowed ones ends.
const MOST_DRAWS: usize = 2000;
/// Most ratio by which rounding makes a pivot negative.
const ROUNDING: f64 = 1e-12;

/// The joint distribution of the estimated parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct JointDistribution {
    /// The parameters.
    pub keys: Vec<Key>,
    /// Where the quadratic model of the sum of squares is smallest, inside the allowed ranges or not.
    pub centre: Vec<f64>,
    /// Covariances.
    pub covariance: Vec<Vec<f64>>,
    /// Degrees of freedom of the variance of the noise; infinite where it was known.
    pub degrees_of_freedom: f64,
}

impl JointDistribution {
    /// Wheels with parameters drawn from it, up to so many: fewer where hardly any draw is allowed. They are the same every time.
    pub fn wheels(&self, wheel: &Wheel, count: usize) -> Vec<Wheel> {
        let Some(factor) = cholesky(&self.covariance) else { return Vec::new() };
        let mut random = Normal { state: 0, spare: None };
        let draws = (0..count * MOST_DRAWS).map(|_| {
            let normal: Vec<f64> = self.keys.iter().map(|_| random.next()).collect();
            let stretch = student_stretch(self.degrees_of_freedom, random.next());
            let value = |row: usize| {
                let sum: f64 = factor[row].iter().zip(&normal).map(|(entry, normal)| entry * normal).sum();
                self.centre[row] + stretch * sum
            };
            let values: Vec<f64> = (0..self.keys.len()).map(value).collect();
            values
        });
        let wheels = draws.filter_map(|values| {
            let mut settings = self.keys.iter().zip(values);
            settings.try_fold(*wheel, |wheel, (&key, value)| wheel.with(key, value).ok())
        });
        wheels.take(count).collect()
    }

    /// Pairs of wheels on both sides of one with the estimates, a half width of a 95 per cent interval away in as many directions as there are
    /// parameters: the squares of the changes of anything over all of them add up to the square of its half width, as far as it is
    /// linear. A parameter stays within its allowed range.
    pub fn pairs(&self, wheel: &Wheel) -> Vec<[Wheel; 2]> {
        let Some(factor) = cholesky(&self.covariance) else { return Vec::new() };
        let half_width = half_width(self.degrees_of_freedom);
        let moved = |direction: usize, side: f64| {
            let mut moved = *wheel;
            for (row, &key) in self.keys.iter().enumerate() {
                let [low, high] = [key.allowed().lowest, key.allowed().highest];
                let value = wheel.get(key) + side * half_width * factor[row][direction];
                // A value within the range is allowed.
                if moved.set_value(key, value.clamp(low, high)).is_err() {
                    return None;
                }
            }
            Some(moved)
        };
        let pair = |direction: usize| Some([moved(direction, -1.0)?, moved(direction, 1.0)?]);
        (0..self.keys.len()).filter_map(pair).collect()
    }
}

/// The factor that makes a normal variable one of Student's t: `sqrt(n/chi^2)`, by the approximation of Wilson and Hilferty.
fn student_stretch(degrees_of_freedom: f64, normal: f64) -> f64 {
    let ninth = 2.0 / (9.0 * degrees_of_freedom);
    let mean_square = (1.0 - ninth + normal * ninth.sqrt()).powi(3);
    if mean_square > 0.0 { mean_square.sqrt().recip() } else { 1.0 }
}

/// The lower triangle `L` of `L L^T`; nothing for a matrix that is not one of covariances.
fn cholesky(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let mut factor = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = matrix[i][j] - sum;
            factor[i][j] = if i != j {
                if factor[j][j] > 0.0 { rest / factor[j][j] } else { 0.0 }
            } else if rest > -ROUNDING * matrix[i][i] && rest.is_finite() {
                rest.max(0.0).sqrt()
            } else {
                return None;
            };
        }
    }
    Some(factor)
}

/// Normal numbers that are the same every time: SplitMix64 (Steele, Lea and Flood, OOPSLA 2014), turned by Box and Muller.
struct Normal {
    state: u64,
    spare: Option<f64>,
}

impl Normal {
    fn unit(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((mixed ^ (mixed >> 31)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let (radius, angle) = ((-2.0 * self.unit().ln()).sqrt(), TAU * self.unit());
        self.spare = Some(radius * angle.sin());
        radius * angle.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_have_the_covariance_that_is_asked_for() {
        let covariance = vec![vec![4.0, 1.5e-3], vec![1.5e-3, 1e-6]];
        let distribution = JointDistribution {
            keys: vec![Key::K, Key::CPsi],
            centre: vec![100.0, 0.1],
            covariance: covariance.clone(),
            degrees_of_freedom: f64::INFINITY,
        };
        let wheels = distribution.wheels(&Wheel::default(), 4000);
        assert_eq!(wheels.len(), 4000);
        let mean = |key: Key| wheels.iter().map(|wheel| wheel.get(key)).sum::<f64>() / 4000.0;
        assert!((mean(Key::K) - 100.0).abs() < 0.1 && (mean(Key::CPsi) - 0.1).abs() < 5e-5);
        for (i, row) in [Key::K, Key::CPsi].into_iter().enumerate() {
            for (j, column) in [Key::K, Key::CPsi].into_iter().enumerate() {
                let product =
                    |wheel: &Wheel| (wheel.get(row) - mean(row)) * (wheel.get(column) - mean(column));
                let found = wheels.iter().map(product).sum::<f64>() / 4000.0;
                assert!((found / covariance[i][j] - 1.0).abs() < 0.1, "{i} {j}: {found}");
            }
        }
    }

    #[test]
    fn what_is_not_allowed_is_not_drawn() {
        let distribution = JointDistribution {
            keys: vec![Key::CPsi],
            centre: vec![-0.1],
            covariance: vec![vec![0.01]],
            degrees_of_freedom: 20.0,
        };
        let wheels = distribution.wheels(&Wheel::default(), 200);
        assert_eq!(wheels.len(), 200);
        assert!(wheels.iter().all(|wheel| wheel.get(Key::CPsi) >= 0.0));
    }
}
