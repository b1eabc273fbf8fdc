//! A quantity of a model: an expression in its names that is not part of its text, such as what a user wants to be monitored.

use crate::error::OdeError;
use crate::model::Model;

/// An expression in the names of a model and perhaps some more.
///
/// ```
/// use arclength_ode::Model;
/// let model = Model::parse("par k=2\nx'=-k*x\ndone\n")?;
/// let energy = model.quantity("k*x^2/2 + extra", &["extra"])?;
/// assert_eq!(energy.value(&[3.0], &[2.0], &[0.5]), 9.5);
/// # Ok::<(), arclength_ode::OdeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Quantity {
    /// The model with the quantity as its first auxiliary and the other names as its first parameters.
    model: Model,
}

/// Name of the auxiliary, with a character more as long as it is taken.
const NAME: &str = "quantity";

impl Model {
    /// An expression in the names of the model and in `others`, which are values that are given with every evaluation.
    ///
    /// # Errors
    /// As [`Model::parse`]; the places are those in the line that declares the expression.
    pub fn quantity(&self, expression: &str, others: &[&str]) -> Result<Quantity, OdeError> {
        let expression: String = expression
            .chars()
            .map(|character| if character.is_control() { ' ' } else { character })
            .collect();
        let mut name = NAME.to_owned();
        loop {
            let parameters: String = others.iter().map(|other| format!("par {other}=0\n")).collect();
            let source = format!("aux {name}={expression}\n{parameters}{}", self.source());
            match Self::parse(&source) {
                Err(OdeError::NameTaken { name: taken, .. }) if taken.eq_ignore_ascii_case(&name) => {
                    name.push('_');
                }
                parsed => {
                    let model = parsed?;
                    return match model.left_out(&name) {
                        Some(error) => Err(error.clone()),
                        None => Ok(Quantity { model }),
                    };
                }
            }
        }
    }
}

impl Quantity {
    /// Its value at a state, with the parameters of the model and the other values; not a number if it depends on the time.
    pub fn value(&self, state: &[f64], parameters: &[f64], others: &[f64]) -> f64 {
        self.value_at(f64::NAN, state, parameters, others)
    }

    /// The same at a time.
    pub fn value_at(&self, time: f64, state: &[f64], parameters: &[f64], others: &[f64]) -> f64 {
        let all = [others, parameters].concat();
        let mut values = vec![f64::NAN; self.model.auxiliary_names().len()];
        self.model.evaluate_auxiliary(time, state, &all, &mut values);
        values[0]
    }
}
