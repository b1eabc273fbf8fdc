//! Models: what they declare, their right-hand side at a state, and models built from the operations of a function.

use crate::errors::Failure;
use arclength::VectorField;
use arclength_analysis::{ChosenModel, ModelRequest};
use arclength_ode::{BuiltNode, ModelBuilder, OdeError, Operator};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A model with its parameters and its initial state.
#[pyclass(frozen, module = "arclength._native")]
pub(crate) struct NativeModel {
    chosen: ChosenModel,
    /// What its reader warns of.
    #[pyo3(get)]
    warnings: Vec<String>,
}

fn named<'py>(py: Python<'py>, names: &[String], values: &[f64]) -> PyResult<Bound<'py, PyDict>> {
    let named = PyDict::new(py);
    names.iter().zip(values).try_for_each(|(name, value)| named.set_item(name, value))?;
    Ok(named)
}

#[pymethods]
impl NativeModel {
    /// The model of a request as JSON.
    #[new]
    fn new(request: &str) -> PyResult<Self> {
        let request: ModelRequest =
            serde_json::from_str(request).map_err(|error| Failure::bad_request(error.to_string()))?;
        let opened = request.open().map_err(Failure::from)?;
        Ok(Self { chosen: opened.chosen, warnings: opened.warnings })
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.chosen.stored.name
    }

    /// Its text.
    #[getter]
    fn source(&self) -> &str {
        &self.chosen.stored.source
    }

    /// Names and initial values of its states.
    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        named(py, self.chosen.model.states(), &self.chosen.start)
    }

    /// Names and values of its parameters.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        named(py, self.chosen.model.parameters(), &self.chosen.parameters)
    }

    /// Names of its auxiliary quantities.
    #[getter]
    fn auxiliaries(&self) -> Vec<String> {
        self.chosen.auxiliary_names()
    }

    /// The right-hand side at a time, a state and parameters, in their order.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        time: f64,
        state: PyReadonlyArray1<'py, f64>,
        parameters: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let model = &self.chosen.model;
        let (state, parameters) = (state.as_slice()?, parameters.as_slice()?);
        let expected = [model.dimension(), model.parameters().len()];
        if [state.len(), parameters.len()] != expected {
            let message = format!(
                "{} states and {} parameters; allowed: {} and {}",
                state.len(),
                parameters.len(),
                expected[0],
                expected[1]
            );
            return Err(Failure::bad_request(message).into());
        }
        let mut derivative = vec![0.0; state.len()];
        model.evaluate_at(time, state, parameters, &mut derivative);
        Ok(derivative.into_pyarray(py))
    }
}

/// An operation of a traced function: its name, its operands by index, and the number where it is one.
type Traced = (String, Vec<usize>, f64);

fn operator(name: &str) -> Option<Operator> {
    Some(match name {
        "+" => Operator::Add,
        "-" => Operator::Subtract,
        "*" => Operator::Multiply,
        "/" => Operator::Divide,
        "^" => Operator::Power,
        ">" => Operator::Greater,
        "<" => Operator::Less,
        ">=" => Operator::GreaterOrEqual,
        "<=" => Operator::LessOrEqual,
        "==" => Operator::Equal,
        "!=" => Operator::NotEqual,
        "&" => Operator::And,
        "|" => Operator::Or,
        _ => return None,
    })
}

fn built(
    states: &[(String, f64)],
    parameters: &[(String, f64)],
    operations: &[Traced],
    derivatives: &[usize],
) -> Result<String, OdeError> {
    let mut builder = ModelBuilder::new();
    let mut nodes: Vec<BuiltNode> = Vec::with_capacity(states.len() + parameters.len() + operations.len());
    for (name, value) in states {
        nodes.push(builder.state(name, *value)?);
    }
    for (name, value) in parameters {
        nodes.push(builder.parameter(name, *value)?);
    }
    let unknown =
        |what: &str| OdeError::Name { name: what.to_owned(), problem: "it is no operation".to_owned() };
    for (name, operands, value) in operations {
        let operands: Option<Vec<BuiltNode>> =
            operands.iter().map(|&index| nodes.get(index).copied()).collect();
        let operands = operands.ok_or_else(|| unknown(name))?;
        let node = match (name.as_str(), operands.as_slice()) {
            ("constant", []) => builder.constant(*value)?,
            ("negate", &[a]) => builder.negate(a),
            ("select", &[condition, yes, no]) => builder.select(condition, yes, no),
            (name, &[a, b]) if operator(name).is_some() => {
                let operator = operator(name).ok_or_else(|| unknown(name))?;
                builder.binary(operator, a, b)
            }
            (name, operands) => builder.call(name, operands)?,
        };
        nodes.push(node);
    }
    for (index, derivative) in derivatives.iter().enumerate().take(states.len()) {
        let derivative = nodes.get(*derivative).ok_or_else(|| unknown("derivative"))?;
        builder.equation(nodes[index], *derivative)?;
    }
    Ok(builder.build()?.source().to_owned())
}

/// The text of the model with these states, parameters and operations: operands and derivatives count states, then parameters, then
/// operations.
#[pyfunction]
pub(crate) fn build_model(
    states: Vec<(String, f64)>,
    parameters: Vec<(String, f64)>,
    operations: Vec<Traced>,
    derivatives: Vec<usize>,
) -> PyResult<String> {
    built(&states, &parameters, &operations, &derivatives)
        .map_err(|error| Failure::bad_request(error.snippet()).into())
}
