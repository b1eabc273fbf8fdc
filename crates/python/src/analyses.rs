//! The analyses by name: from the JSON of a request to a result, and to the request with every default in it.

use crate::errors::Failure;
use crate::stored::Stored;
use arclength_analysis::Control;
use kingpin_analysis::Journal;
use kingpin_report::Report;
use pyo3::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A result with what is worth knowing of it.
pub(crate) struct Finished {
    pub result: Box<dyn Stored>,
    pub warnings: Vec<String>,
}

impl Finished {
    /// With what is worth knowing of the parameters first, as the programs tell it.
    fn new<R: Report + Send + Sync + 'static>(result: R, warnings: impl IntoIterator<Item = String>) -> Self {
        let remarks = result.parameters().remarks;
        Self { result: Box::new(result), warnings: remarks.into_iter().chain(warnings).collect() }
    }
}

/// What is done with the type of a request, once its name is known.
enum Task<'a> {
    Run(&'a Control<'a>),
    Complete,
}

/// What came of it.
enum Outcome {
    Finished(Finished),
    Completed(String),
}

fn read<R: DeserializeOwned>(request: &str) -> Result<R, Failure> {
    serde_json::from_str(request)
        .map_err(|error| Failure::bad_request(format!("the request cannot be read: {error}")))
}

fn perform<R: DeserializeOwned + Serialize>(
    request: &str,
    task: Task<'_>,
    run: impl FnOnce(R, &Control<'_>) -> Result<Finished, Failure>,
) -> Result<Outcome, Failure> {
    let request: R = read(request)?;
    match task {
        Task::Run(control) => run(request, control).map(Outcome::Finished),
        Task::Complete => serde_json::to_string(&request)
            .map(Outcome::Completed)
            .map_err(|error| Failure::internal(error.to_string())),
    }
}

fn dispatch(analysis: &str, request: &str, task: Task<'_>) -> Result<Outcome, Failure> {
    match analysis {
        "arclength.equilibria" => {
            use arclength_analysis::equilibria::EquilibriaRequest;
            perform(request, task, |request: EquilibriaRequest, control| {
                let analysis = request.validate()?;
                let result = analysis.run(control)?;
                let warnings = [analysis.warnings().to_vec(), result.warnings()].concat();
                Ok(Finished::new(result, warnings))
            })
        }
        "arclength.cycles" => {
            use arclength_analysis::cycles::CyclesRequest;
            perform(request, task, |request: CyclesRequest, control| {
                let analysis = request.validate()?;
                let result = analysis.run(control)?;
                let warnings = [analysis.warnings().to_vec(), result.warnings()].concat();
                Ok(Finished::new(result, warnings))
            })
        }
        "arclength.locus" => {
            use arclength_analysis::locus::{LocusRequest, LocusResult};
            perform(request, task, |request: LocusRequest, control| {
                let result = request.validate()?.run(control)?;
                let warnings = result.warnings();
                Ok(match result {
                    LocusResult::Equilibria(curve) => Finished::new(curve, warnings),
                    LocusResult::Cycles(curve) => Finished::new(curve, warnings),
                })
            })
        }
        "arclength.simulate" => {
            use arclength_analysis::simulate::SimulateRequest;
            perform(request, task, |request: SimulateRequest, control| {
                let analysis = request.validate()?;
                let result = analysis.run_under(control)?;
                let warnings = [analysis.warnings(), &result.warnings].concat();
                Ok(Finished::new(result, warnings))
            })
        }
        _ => of_wheels(analysis, request, task),
    }
}

fn of_wheels(analysis: &str, request: &str, task: Task<'_>) -> Result<Outcome, Failure> {
    use kingpin_analysis::basin::BasinRequest;
    use kingpin_analysis::chart::ChartRequest;
    use kingpin_analysis::cycles::CyclesRequest;
    use kingpin_analysis::damper::DamperRequest;
    use kingpin_analysis::fit::FitRequest;
    use kingpin_analysis::hopf::HopfRequest;
    use kingpin_analysis::locus::{LocusRequest, LocusResult};
    use kingpin_analysis::margin::MarginRequest;
    use kingpin_analysis::report::ReportRequest;
    use kingpin_analysis::safe_kick::SafeKickRequest;
    use kingpin_analysis::shimmy::ShimmyRequest;
    use kingpin_analysis::simulate::SimulateRequest;
    use kingpin_analysis::stability::StabilityRequest;
    use kingpin_analysis::steady::SteadyRequest;
    use kingpin_analysis::steady_along::SteadyAlongRequest;
    match analysis {
        "kingpin.steady" => {
            perform(request, task, |request: SteadyRequest, _| Ok(Finished::new(request.run()?, [])))
        }
        "kingpin.steady-along" => {
            perform(request, task, |request: SteadyAlongRequest, _| Ok(Finished::new(request.run()?, [])))
        }
        "kingpin.stability" => {
            perform(request, task, |request: StabilityRequest, _| Ok(Finished::new(request.run()?, [])))
        }
        "kingpin.chart" => perform(request, task, |request: ChartRequest, control| {
            let analysis = request.validate()?;
            Ok(Finished::new(analysis.run(control)?, analysis.warnings().to_vec()))
        }),
        "kingpin.hopf" => perform(request, task, |request: HopfRequest, control| {
            let result = request.validate()?.run(control)?;
            let warnings = result.warnings();
            Ok(Finished::new(result, warnings))
        }),
        "kingpin.cycles" => perform(request, task, |request: CyclesRequest, control| {
            let analysis = request.validate()?;
            let result = analysis.run(control)?;
            let warnings = [analysis.warnings(), result.warnings()].concat();
            Ok(Finished::new(result, warnings))
        }),
        "kingpin.locus" => perform(request, task, |request: LocusRequest, control| {
            let result = request.validate()?.run(control)?;
            let warnings = result.warnings();
            Ok(match result {
                LocusResult::Motions(curve) => Finished::new(curve, warnings),
                LocusResult::Cycles(curve) => Finished::new(curve, warnings),
            })
        }),
        "kingpin.shimmy" => perform(request, task, |request: ShimmyRequest, control| {
            let result = request.validate()?.run(control)?;
            let warnings = result.warnings();
            Ok(Finished::new(result, warnings))
        }),
        "kingpin.simulate" => perform(request, task, |request: SimulateRequest, control| {
            let result = request.validate()?.run(control)?;
            let warnings = result.warnings();
            Ok(Finished::new(result, warnings))
        }),
        "kingpin.basin" => perform(request, task, |request: BasinRequest, control| {
            let analysis = request.validate()?;
            Ok(Finished::new(analysis.run(control, &Journal::none())?, analysis.warnings().to_vec()))
        }),
        "kingpin.safe-kick" => perform(request, task, |request: SafeKickRequest, control| {
            let analysis = request.validate()?;
            Ok(Finished::new(analysis.run(control)?, analysis.warnings().to_vec()))
        }),
        "kingpin.margin" => perform(request, task, |request: MarginRequest, control| {
            Ok(Finished::new(request.validate()?.run(control, &Journal::none())?, []))
        }),
        "kingpin.damper" => perform(request, task, |request: DamperRequest, control| {
            Ok(Finished::new(request.run(control)?, []))
        }),
        "kingpin.fit" => perform(request, task, |request: FitRequest, control| {
            let analysis = request.validate()?;
            let result = analysis.run(control)?;
            let warnings = [analysis.warnings().to_vec(), result.warnings()].concat();
            Ok(Finished::new(result, warnings))
        }),
        "kingpin.report" => perform(request, task, |request: ReportRequest, control| {
            Ok(Finished::new(request.validate()?.run(control)?, []))
        }),
        other => Err(Failure::bad_request(format!("there is no analysis `{other}`"))),
    }
}

/// Runs the analysis with this name.
pub(crate) fn run(analysis: &str, request: &str, control: &Control<'_>) -> Result<Finished, Failure> {
    match dispatch(analysis, request, Task::Run(control))? {
        Outcome::Finished(finished) => Ok(finished),
        Outcome::Completed(_) => Err(Failure::internal("the request was not run")),
    }
}

/// The request as JSON with every default in it.
#[pyfunction]
pub(crate) fn complete_request(analysis: &str, request: &str) -> PyResult<String> {
    match dispatch(analysis, request, Task::Complete)? {
        Outcome::Completed(request) => Ok(request),
        Outcome::Finished(_) => Err(Failure::internal("the request was run").into()),
    }
}
