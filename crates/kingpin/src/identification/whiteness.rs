//! Whether residuals are noise: if they are, none says anything of the next.

use super::distributions::chi_squared_tail;

/// Most lags, and part of the samples, at which residuals are compared with themselves.
const MOST_LAGS: usize = 20;
const PART: usize = 5;
/// Probability below which noise is not believed in.
const UNBELIEVABLE: f64 = 0.01;

/// The test of Ljung and Box (Biometrika 65, 1978) of residuals in the order of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whiteness {
    /// Correlation of each residual with the next.
    pub correlation_with_next: f64,
    /// Probability that noise is as correlated as they are, over up to 20 lags.
    pub probability: f64,
}

impl Whiteness {
    /// The test of some residuals.
    pub(super) fn of(residuals: &[f64]) -> Self {
        let count = residuals.len();
        let mean = residuals.iter().sum::<f64>() / count as f64;
        let centred: Vec<f64> = residuals.iter().map(|residual| residual - mean).collect();
        let square = centred.iter().map(|residual| residual * residual).sum::<f64>();
        if square == 0.0 {
            return Self { correlation_with_next: 0.0, probability: 1.0 };
        }
        let lags = (count / PART).clamp(1, MOST_LAGS);
        let correlation = |lag: usize| {
            let pairs = centred.iter().zip(&centred[lag..]);
            pairs.map(|(one, other)| one * other).sum::<f64>() / square
        };
        let n = count as f64;
        let statistic: f64 = (1..=lags).map(|lag| correlation(lag).powi(2) / (n - lag as f64)).sum();
        Self {
            correlation_with_next: correlation(1),
            probability: chi_squared_tail(n * (n + 2.0) * statistic, lags as f64),
        }
    }

    /// Whether they may be noise.
    pub fn is_white(&self) -> bool {
        self.probability >= UNBELIEVABLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_is_no_noise() {
        let wave: Vec<f64> = (0..100).map(|index| (0.3 * f64::from(index)).sin()).collect();
        assert!(!Whiteness::of(&wave).is_white());
        // Neither is what turns its sign from sample to sample.
        let turns: Vec<f64> = (0..100).map(|index| if index % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!(!Whiteness::of(&turns).is_white());
    }

    #[test]
    fn the_statistic_is_that_of_the_definition() {
        // By NumPy and SciPy, over two lags.
        let residuals = [1.0, -2.0, 3.0, 0.0, 1.0, 2.0, -1.0, 0.0, 1.0, -2.0];
        let found = Whiteness::of(&residuals);
        assert!((found.probability - EXPECTED_PROBABILITY).abs() < 1e-9, "{found:?}");
    }

    /// Of the statistic 3.0651285847925.
    const EXPECTED_PROBABILITY: f64 = 0.215_981_117_868_131_98;
}
