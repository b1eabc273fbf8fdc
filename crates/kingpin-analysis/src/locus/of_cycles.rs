//! A curve of special cycles of a wheel as a result.

use crate::along::ParameterPlane;
use crate::description;
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::parameters::{parameters_over, wheel_of};
use crate::states::named_state;
use arclength_analysis::Origin;
use arclength_analysis::locus::{CycleCurve, Quantities};
use kingpin::{KingpinError, Wheel};
use kingpin_figure::{Figure, FigureError};
use kingpin_report::{Columns, Parameters, Report, Schema, Story};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// A curve of folds, period doublings or torus bifurcations of limit cycles.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "StoredCurve")]
pub struct CycleLocusResult {
    /// The wheel; its values of the parameters that vary are anywhere.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The parameters and their intervals.
    #[serde(skip)]
    pub plane: ParameterPlane,
    /// The curve.
    #[serde(flatten)]
    pub curve: CycleCurve,
    /// Dry friction about the king pin that was left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction: Option<NeglectedDryFriction>,
}

/// The result as it is read back.
#[derive(Deserialize)]
struct StoredCurve {
    parameters: Parameters,
    #[serde(flatten)]
    curve: CycleCurve,
}

impl TryFrom<StoredCurve> for CycleLocusResult {
    type Error = KingpinError;

    fn try_from(StoredCurve { parameters, curve }: StoredCurve) -> Result<Self, KingpinError> {
        let wheel = wheel_of(&parameters)?;
        let plane = ParameterPlane::of(&curve.plane)?;
        let dry_friction = NeglectedDryFriction::of(&wheel, &plane.keys());
        Ok(Self { wheel, plane, curve, dry_friction })
    }
}

impl CycleLocusResult {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "kingpin.cycle_locus";

    /// The result of a curve.
    pub(super) fn new(
        wheel: Wheel,
        plane: ParameterPlane,
        from: Origin,
        monitors: &[String],
        curve: kingpin::branches::CycleCurve,
    ) -> Self {
        let kingpin::branches::CycleCurve { kind, points, stops, unlocated, monitors: ends } = curve;
        let quantities = Quantities { plane: plane.varying(), monitors, ends: Some(&ends) };
        let curve = CycleCurve::new(kind, quantities, from, points, &stops, &unlocated, named_state);
        let dry_friction = NeglectedDryFriction::of(&wheel, &plane.keys());
        Self { wheel, plane, curve, dry_friction }
    }
}

impl Report for CycleLocusResult {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> Parameters {
        parameters_over(&self.wheel, &self.plane.0.map(|along| (along.key(), along.ends().into())))
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let kind = self.curve.name();
        let heading = format!("curve: {kind}, at {}", description::on_lines(&self.wheel, &self.plane.keys()));
        self.curve.write_table(&heading, out)?;
        NeglectedDryFriction::tell(self.dry_friction.as_ref(), out)
    }

    fn columns(&self) -> Columns {
        self.curve.columns()
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let (kind, [one, two]) = (self.curve.name(), self.plane.keys());
        let description =
            format!("{kind} in {one} and {two} at {}", description::of(&self.wheel, &[one, two]));
        let [first, second] = self.plane.labels();
        Ok(Some(self.curve.figure(&description, [&first, &second], self.plane.scales())))
    }

    fn story(&self) -> Option<Story> {
        Some(self.curve.story())
    }
}
