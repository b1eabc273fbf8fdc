//! A curve of uniform motions of a wheel as a result: of Hopf points, or of those on which a quantity keeps its value.

use crate::along::ParameterPlane;
use crate::description;
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::parameters::{parameters_over, wheel_of};
use crate::states::named_state;
use arclength::branch::SpecialKind;
use arclength_analysis::Origin;
use arclength_analysis::locus::{EquilibriumCurve, Quantities};
use kingpin::branches::MotionCurve;
use kingpin::{KingpinError, Wheel};
use kingpin_figure::{Figure, FigureError};
use kingpin_report::{Columns, Parameters, Report, Schema, Story};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// A curve of uniform motions.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "StoredCurve")]
pub struct MotionLocusResult {
    /// The wheel; its values of the parameters that vary are anywhere.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The parameters and their intervals.
    #[serde(skip)]
    pub plane: ParameterPlane,
    /// The curve.
    #[serde(flatten)]
    pub curve: EquilibriumCurve,
    /// Dry friction about the king pin that was left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction: Option<NeglectedDryFriction>,
}

/// The result as it is read back.
#[derive(Deserialize)]
struct StoredCurve {
    parameters: Parameters,
    #[serde(flatten)]
    curve: EquilibriumCurve,
}

impl TryFrom<StoredCurve> for MotionLocusResult {
    type Error = KingpinError;

    fn try_from(StoredCurve { parameters, curve }: StoredCurve) -> Result<Self, KingpinError> {
        let wheel = wheel_of(&parameters)?;
        let plane = ParameterPlane::of(&curve.plane)?;
        let dry_friction = NeglectedDryFriction::of(&wheel, &plane.keys());
        Ok(Self { wheel, plane, curve, dry_friction })
    }
}

impl MotionLocusResult {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "kingpin.locus";

    /// The result of a curve.
    pub(super) fn new(
        wheel: Wheel,
        plane: ParameterPlane,
        from: Origin,
        (kind, monitors): (Option<SpecialKind>, &[String]),
        curve: &MotionCurve,
    ) -> Self {
        let MotionCurve { points, stops, unlocated, monitors: ends } = curve;
        let quantities = Quantities { plane: plane.varying(), monitors, ends: Some(ends) };
        let curve = EquilibriumCurve::new(kind, quantities, from, points, stops, unlocated, named_state);
        let dry_friction = NeglectedDryFriction::of(&wheel, &plane.keys());
        Self { wheel, plane, curve, dry_friction }
    }

    /// What the curve consists of, in words.
    fn name(&self) -> String {
        match self.curve.kind {
            Some(_) => self.curve.name(),
            None => self.curve.name().replace("equilibria", "uniform motions"),
        }
    }
}

impl Report for MotionLocusResult {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> Parameters {
        parameters_over(&self.wheel, &self.plane.0.map(|along| (along.key(), along.ends().into())))
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let heading =
            format!("curve of {} at {}", self.name(), description::on_lines(&self.wheel, &self.plane.keys()));
        self.curve.write_table(&heading, out)?;
        NeglectedDryFriction::tell(self.dry_friction.as_ref(), out)
    }

    fn columns(&self) -> Columns {
        self.curve.columns()
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let [one, two] = self.plane.keys();
        let description =
            format!("{} in {one} and {two} at {}", self.name(), description::of(&self.wheel, &[one, two]));
        let [first, second] = self.plane.labels();
        Ok(Some(self.curve.figure(&description, [&first, &second], self.plane.scales())))
    }

    fn story(&self) -> Option<Story> {
        Some(self.curve.story())
    }
}
