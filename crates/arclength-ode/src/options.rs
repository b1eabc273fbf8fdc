//! The options of the lines `@`: all are kept by name, those with a meaning here are typed.

use crate::assignments::assignments;
use crate::error::{OdeError, Place, Warning, nearest};
use crate::source::Text;

/// One option as written.
#[derive(Clone, Debug, PartialEq)]
pub struct OptionEntry {
    /// Name in lower case.
    pub name: String,
    /// Value as written.
    pub value: String,
    /// Where the name stands.
    pub place: Place,
}

/// The options of a model. `None` means that the model does not give the option.
///
/// XPPAUT recognises an option by the beginning of its name, so `trans` and `transient` are the same.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Every option in the order of the file, whether or not it has a meaning here.
    pub entries: Vec<OptionEntry>,
    /// Duration of a simulation.
    pub total: Option<f64>,
    /// Time step of a simulation.
    pub dt: Option<f64>,
    /// Time at which a simulation starts.
    pub t0: Option<f64>,
    /// Time before which a simulation is not reported.
    pub transient: Option<f64>,
    /// Magnitude at which a simulation stops.
    pub bound: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// Absolute tolerance.
    pub absolute_tolerance: Option<f64>,
    /// Integration method.
    pub method: Option<String>,
    /// Number of mesh intervals of a cycle.
    pub ntst: Option<f64>,
    /// Number of collocation points in an interval.
    pub ncol: Option<f64>,
    /// Largest number of steps along a branch.
    pub nmax: Option<f64>,
    /// Every how many steps AUTO writes a point.
    pub npr: Option<f64>,
    /// First step along a branch; its sign is the direction.
    pub ds: Option<f64>,
    /// Smallest step.
    pub dsmin: Option<f64>,
    /// Largest step.
    pub dsmax: Option<f64>,
    /// Lower end of the parameter's range.
    pub parmin: Option<f64>,
    /// Upper end of the parameter's range.
    pub parmax: Option<f64>,
    /// Smallest norm of a point on the branch.
    pub normmin: Option<f64>,
    /// Largest norm of a point on the branch.
    pub normmax: Option<f64>,
    /// AUTO's relative convergence criterion for equation parameters.
    pub epsl: Option<f64>,
    /// AUTO's relative convergence criterion for solution components.
    pub epsu: Option<f64>,
    /// AUTO's relative arclength convergence criterion for special points.
    pub epss: Option<f64>,
    /// Lower end of the plotted range of the branch's parameter.
    pub autoxmin: Option<f64>,
    /// Upper end of the plotted range of the branch's parameter.
    pub autoxmax: Option<f64>,
    /// Lower end of the plotted range of the state.
    pub autoymin: Option<f64>,
    /// Upper end of the plotted range of the state.
    pub autoymax: Option<f64>,
    /// State that a branch plots.
    pub autovar: Option<String>,
    /// Quantity on the horizontal axis.
    pub xp: Option<String>,
    /// Quantity on the vertical axis.
    pub yp: Option<String>,
    /// Lower end of the horizontal axis.
    pub xlo: Option<f64>,
    /// Upper end of the horizontal axis.
    pub xhi: Option<f64>,
    /// Lower end of the vertical axis.
    pub ylo: Option<f64>,
    /// Upper end of the vertical axis.
    pub yhi: Option<f64>,
}

/// Beginnings of the names of XPPAUT's options that have no meaning here.
const WITHOUT_MEANING: &[&str] = &[
    "axes",
    "back",
    "bandlo",
    "bandup",
    "bell",
    "big",
    "but",
    "color",
    "delay",
    "dfdraw",
    "dfgrid",
    "dll_",
    "dtmax",
    "dtmin",
    "dwcolor",
    "fold",
    "forecolor",
    "grads",
    "height",
    "hist",
    "jac_eps",
    "logfile",
    "lt",
    "maxstor",
    "multiwin",
    "mwcolor",
    "ncdraw",
    "newt_",
    "njmp",
    "nmesh",
    "nout",
    "nplot",
    "output",
    "phi",
    "plotfmt",
    "poi",
    "postprocess",
    "ps_",
    "quiet",
    "range",
    "runnow",
    "s1",
    "s2",
    "s3",
    "sec",
    "seed",
    "shi",
    "simplot",
    "slo",
    "small",
    "smc",
    "spc",
    "spec",
    "stoch",
    "theta",
    "tor_per",
    "tutorial",
    "uec",
    "umc",
    "upc",
    "vmaxpts",
    "width",
    "xmax",
    "xmin",
    "xnc",
    "ymax",
    "ymin",
    "ync",
    "zmax",
    "zmin",
    "zp",
    "autoeval",
    "xp",
    "yp",
    "xlo",
    "xhi",
    "ylo",
    "yhi",
    "zlo",
    "zhi",
];

impl Options {
    /// Reads the options in `line[start..]`.
    pub(crate) fn read(
        &mut self,
        line: &Text,
        start: usize,
        warnings: &mut Vec<Warning>,
    ) -> Result<(), OdeError> {
        for assignment in assignments(line, start, line.len())? {
            let name = assignment.name.key();
            let value = assignment.value(line).into_owned();
            if !assignment.has_value() {
                let message = format!("the option `{name}` has no value: ignored");
                warnings.push(Warning::new(assignment.name.span, message));
                continue;
            }
            let span = line.span(assignment.value_start, assignment.value_end);
            if name.starts_with("meth") && matches!(value.to_ascii_lowercase().get(..2), Some("di" | "de")) {
                return Err(OdeError::unsupported(
                    span,
                    "maps (meth=discrete) are",
                    "only differential equations x'=... can be continued",
                ));
            }
            match self.slot(&name) {
                Some(Slot::Number(slot)) => {
                    let number = crate::expression::parse_number(&value).ok_or_else(|| {
                        OdeError::syntax(span, format!("the option `{name}` takes a number, not `{value}`"))
                    })?;
                    *slot = Some(number);
                }
                Some(Slot::Word(slot)) => *slot = Some(value.clone()),
                None if WITHOUT_MEANING.iter().any(|known| name.starts_with(known)) => {}
                None => {
                    let guess = nearest(&name, WITHOUT_MEANING.iter().chain(WITH_MEANING).copied());
                    let guess = guess.map(|guess| format!("; did you mean `{guess}`?")).unwrap_or_default();
                    let message = format!("unknown option `{name}`: ignored{guess}");
                    warnings.push(Warning::new(assignment.name.span, message));
                }
            }
            self.entries.push(OptionEntry { name, value, place: assignment.name.span.into() });
        }
        Ok(())
    }

    /// The value of an option by its whole name, as last given.
    pub fn get(&self, name: &str) -> Option<&str> {
        let name = name.to_ascii_lowercase();
        self.entries.iter().rev().find(|entry| entry.name == name).map(|entry| entry.value.as_str())
    }

    /// Where the typed value of an option goes.
    fn slot(&mut self, name: &str) -> Option<Slot<'_>> {
        use Slot::{Number, Word};
        let known = *WITH_MEANING.iter().find(|known| match **known {
            // Short names that other options begin with must be whole.
            "dt" | "ds" | "t0" => name == **known,
            // `xp2` is the axis of another plot, `xplot` is `xp`.
            "xp" | "yp" => {
                name.strip_prefix(*known).is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_digit()))
            }
            _ => name.starts_with(*known),
        })?;
        Some(match known {
            "total" => Number(&mut self.total),
            "dt" => Number(&mut self.dt),
            "t0" => Number(&mut self.t0),
            "trans" => Number(&mut self.transient),
            "bound" => Number(&mut self.bound),
            "tol" => Number(&mut self.tolerance),
            "atol" => Number(&mut self.absolute_tolerance),
            "meth" => Word(&mut self.method),
            "ntst" => Number(&mut self.ntst),
            "ncol" => Number(&mut self.ncol),
            "nmax" => Number(&mut self.nmax),
            "npr" => Number(&mut self.npr),
            "ds" => Number(&mut self.ds),
            "dsmin" => Number(&mut self.dsmin),
            "dsmax" => Number(&mut self.dsmax),
            "parmin" => Number(&mut self.parmin),
            "parmax" => Number(&mut self.parmax),
            "normmin" => Number(&mut self.normmin),
            "normmax" => Number(&mut self.normmax),
            "epsl" => Number(&mut self.epsl),
            "epsu" => Number(&mut self.epsu),
            "epss" => Number(&mut self.epss),
            "autoxmin" => Number(&mut self.autoxmin),
            "autoxmax" => Number(&mut self.autoxmax),
            "autoymin" => Number(&mut self.autoymin),
            "autoymax" => Number(&mut self.autoymax),
            "autovar" => Word(&mut self.autovar),
            "xp" => Word(&mut self.xp),
            "yp" => Word(&mut self.yp),
            "xlo" => Number(&mut self.xlo),
            "xhi" => Number(&mut self.xhi),
            "ylo" => Number(&mut self.ylo),
            "yhi" => Number(&mut self.yhi),
            _ => return None,
        })
    }
}

enum Slot<'a> {
    Number(&'a mut Option<f64>),
    Word(&'a mut Option<String>),
}

/// Beginnings of the names of the options that have a meaning here.
const WITH_MEANING: &[&str] = &[
    "total", "dt", "t0", "trans", "bound", "tol", "atol", "meth", "ntst", "ncol", "nmax", "npr", "ds",
    "dsmin", "dsmax", "parmin", "parmax", "normmin", "normmax", "epsl", "epsu", "epss", "autoxmin",
    "autoxmax", "autoymin", "autoymax", "autovar", "xp", "yp", "xlo", "xhi", "ylo", "yhi",
];
