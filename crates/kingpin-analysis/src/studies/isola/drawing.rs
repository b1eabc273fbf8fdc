//! Figure 7: branches of cycles for three dampers, and the folds in speed and damping.

use super::Isola;
use crate::studies::study::Drawing;
use arclength::branch::{Labelled, SpecialKind};
use arclength::cycle::CycleBranch;
use kingpin_figure::{
    Axis, Branch, Color, Figure, Legend, LegendEntry, Line, Marker, MarkerShape, Markers, Panel, Region,
    Stability, palette,
};
use kingpin_report::Columns;

/// Points of the curve of Hopf points.
const HOPF_POINTS: usize = 400;

impl Isola {
    pub(in crate::studies) fn drawing(&self) -> Drawing {
        let figure = Figure::double_column()
            .columns(2)
            .height_mm(82.0)
            .description("Branches of limit cycles against the speed for three dampers; their folds in speed and damping")
            .panel(self.branches())
            .panel(self.loci());
        Drawing { number: 7, figure, data: self.data() }
    }

    fn branches(&self) -> Panel {
        let mut panel = Panel::new(
            Axis::new("$v$ (m/s)").logarithmic().limits(self.ranges.speeds.0, self.ranges.speeds.1),
            Axis::new("largest $\\psi$ (rad)").limits(0.0, 1.6),
        )
        .tag("(a)")
        .legend(Legend::Below);
        for (index, branch) in self.attached.iter().enumerate() {
            let curve = diagram(branch, palette::BLUE);
            let label = format!("$c_q={}$ N s/m", self.ranges.with_hopf_points);
            panel = panel.curve(if index == 0 { curve.legend(label) } else { curve });
        }
        let shown = self.shown.iter().map(|(damping, branch)| (*damping, branch));
        let mut others: Vec<(f64, &CycleBranch, Color)> = shown
            .zip([palette::GREEN, palette::PURPLE])
            .map(|((damping, branch), color)| (damping, branch, color))
            .chain([(self.ranges.detached, &self.closed, palette::VERMILION)])
            .collect();
        others.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (damping, branch, color) in others {
            panel = panel.curve(diagram(branch, color).legend(format!("$c_q={damping}$ N s/m")));
        }
        panel = panel.markers(
            Markers::new(
                self.hopf_points.iter().map(|hopf| (hopf.value, 0.0)),
                Marker::new(MarkerShape::Circle).color(palette::BLUE),
            )
            .legend("Hopf point"),
        );
        let folds = self.closed_folds();
        panel.markers(
            Markers::new(
                folds.iter().map(|fold| (fold.value, fold.max[1])),
                Marker::new(MarkerShape::Square).color(palette::VERMILION),
            )
            .legend("fold"),
        )
    }

    fn loci(&self) -> Panel {
        let hopf = self.hopf_curve();
        let folds: Vec<(f64, f64)> = self.folds.points.iter().map(|point| point.values.into()).collect();
        let ends = [(self.ranges.speeds.1, 0.0), (self.ranges.speeds.0, 0.0)];
        let below = folds.iter().copied().chain(ends);
        let marker = |color: Color| Marker::new(MarkerShape::Diamond).size(5.0).color(color);
        Panel::new(
            Axis::new("$v$ (m/s)").logarithmic().limits(self.ranges.speeds.0, self.ranges.speeds.1),
            Axis::new("$c_q$ (N s/m)").limits(0.0, 1.15 * self.death.damping),
        )
        .tag("(b)")
        .legend(Legend::Below)
        .region(Region::new(below).fill(palette::VERMILION.lightened(0.75)))
        .region(Region::new(hopf.clone()).fill(palette::SKY_BLUE.lightened(0.5)))
        .curve(Line::new(hopf).color(palette::BLUE).legend("Hopf points"))
        .curve(Line::new(folds).color(palette::VERMILION).legend("folds of cycles"))
        .markers(Markers::new([(self.birth.speed, self.birth.damping)], marker(palette::BLUE)))
        .markers(Markers::new([(self.death.value, self.death.damping)], marker(palette::VERMILION)))
        .legend_entry(LegendEntry::marker("birth and death of the isola", marker(palette::BLACK)))
    }

    fn hopf_curve(&self) -> Vec<(f64, f64)> {
        let (mut slow, mut fast) = (Vec::new(), Vec::new());
        for index in 1..HOPF_POINTS {
            // Points crowd at the vertex.
            let part = index as f64 / HOPF_POINTS as f64;
            let damping = self.birth.damping * (1.0 - part * part);
            if let Some([low, high]) = self.birth.speeds_at(damping) {
                slow.push((low, damping));
                fast.push((high, damping));
            }
        }
        slow.reverse();
        slow.push((self.birth.speed, self.birth.damping));
        slow.extend(fast);
        slow
    }

    fn data(&self) -> Columns {
        let branches = || {
            let attached =
                self.attached.iter().map(|branch| ("limit cycle", self.ranges.with_hopf_points, branch));
            let shown = self.shown.iter().map(|(damping, branch)| ("limit cycle", *damping, branch));
            attached.chain([("limit cycle", self.ranges.detached, &self.closed)]).chain(shown).flat_map(
                |(what, damping, branch)| branch.points.iter().map(move |point| (what, damping, point)),
            )
        };
        let folds = || self.folds.points.iter();
        let stability = |stable: Option<bool>| match stable {
            Some(true) => "stable",
            Some(false) => "unstable",
            None => "undecided",
        };
        let kinds = branches()
            .map(|(what, _, point)| match point.special_kind() {
                Some(SpecialKind::FoldOfCycles) => "fold of the branch",
                _ => what,
            })
            .chain(folds().map(|_| "fold of cycles"));
        Columns::new()
            .texts("solution", kinds.map(|kind| Some(kind.to_owned())))
            .numbers(
                "v [m/s]",
                branches().map(|(_, _, point)| point.value).chain(folds().map(|fold| fold.values[0])),
            )
            .numbers(
                "c_q [N s/m]",
                branches().map(|(_, damping, _)| damping).chain(folds().map(|fold| fold.values[1])),
            )
            .numbers("period [s]", branches().map(|(_, _, p)| p.period).chain(folds().map(|f| f.period)))
            .numbers("psi_max [rad]", branches().map(|(_, _, p)| p.max[1]).chain(folds().map(|f| f.max[1])))
            .numbers("psi_min [rad]", branches().map(|(_, _, p)| p.min[1]).chain(folds().map(|f| f.min[1])))
            .texts(
                "stability",
                branches()
                    .map(|(_, _, point)| Some(stability(point.stable).to_owned()))
                    .chain(folds().map(|_| None)),
            )
    }
}

fn diagram(branch: &CycleBranch, color: Color) -> Branch {
    let points = branch.points.iter().map(|point| {
        let stability = match point.special_kind() {
            Some(_) => Stability::Changes,
            _ => Stability::from(point.stable == Some(true)),
        };
        ((point.value, point.max[1]), stability)
    });
    Branch::new(points).color(color)
}
