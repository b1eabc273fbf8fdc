//! The branches that are compared: those of the gallery, and chains of Brusselators of any length.

use std::fmt::Write as _;

/// A branch of cycles from a Hopf point.
#[derive(Clone)]
pub(crate) struct Case {
    pub(crate) model: String,
    /// The text of the model.
    pub(crate) source: String,
    pub(crate) parameter: &'static str,
    pub(crate) set: &'static [(&'static str, f64)],
    /// Start of the search for the equilibrium, in place of the model's own.
    pub(crate) start: Option<&'static [f64]>,
    /// Range of the equilibria, which holds the Hopf point wanted, counted from zero.
    pub(crate) equilibria: (f64, f64),
    pub(crate) hopf: usize,
    /// Range of the cycles.
    pub(crate) cycles: (f64, f64),
    /// Values at which the period is compared.
    pub(crate) values: &'static [f64],
}

/// A branch of a model of the gallery.
struct Branch {
    model: &'static str,
    parameter: &'static str,
    set: &'static [(&'static str, f64)],
    start: Option<&'static [f64]>,
    equilibria: (f64, f64),
    hopf: usize,
    cycles: (f64, f64),
    values: &'static [f64],
}

const GALLERY: [Branch; 12] = [
    Branch {
        model: "towed_wheel",
        parameter: "v",
        set: &[("l", 0.08), ("v", 9.0)],
        start: None,
        equilibria: (8.0, 9.0),
        hopf: 0,
        cycles: (0.2, 9.0),
        values: &[1.0, 2.0, 4.0, 6.0, 8.0],
    },
    Branch {
        model: "lure",
        parameter: "alpha",
        set: &[],
        start: None,
        equilibria: (0.5, 2.0),
        hopf: 0,
        cycles: (-0.9, 1.1),
        values: &[0.8, 0.4, 0.0, -0.4],
    },
    Branch {
        model: "ab",
        parameter: "D",
        set: &[],
        start: None,
        equilibria: (0.0, 0.4),
        hopf: 0,
        cycles: (0.1, 0.4),
        values: &[0.2, 0.25, 0.3],
    },
    Branch {
        model: "pp2",
        parameter: "p1",
        set: &[("p1", 0.65)],
        start: Some(&[0.33, 0.42]),
        equilibria: (0.65, 0.8),
        hopf: 0,
        cycles: (0.6, 0.71),
        values: &[0.68, 0.70],
    },
    Branch {
        model: "lorenz",
        parameter: "rho",
        set: &[("rho", 20.0)],
        start: Some(&[7.0, 7.0, 19.0]),
        equilibria: (15.0, 30.0),
        hopf: 0,
        cycles: (14.5, 26.0),
        values: &[23.0, 20.0, 17.0],
    },
    Branch {
        model: "brusselator",
        parameter: "b",
        set: &[],
        start: None,
        equilibria: (1.0, 3.0),
        hopf: 0,
        cycles: (1.5, 5.0),
        values: &[2.5, 3.0, 4.0],
    },
    Branch {
        model: "fitzhugh_nagumo",
        parameter: "i0",
        set: &[],
        start: None,
        equilibria: (0.0, 1.0),
        hopf: 0,
        cycles: (0.0, 1.2),
        values: &[0.5, 0.8, 1.1],
    },
    Branch {
        model: "langford",
        parameter: "lambda",
        set: &[("lambda", 1.5)],
        start: Some(&[0.0, 0.0, 1.5]),
        equilibria: (1.0, 2.2),
        hopf: 0,
        cycles: (1.0, 2.2),
        values: &[1.8, 1.9],
    },
    Branch {
        model: "hodgkin_huxley",
        parameter: "i0",
        set: &[],
        start: None,
        equilibria: (0.0, 20.0),
        hopf: 0,
        cycles: (0.0, 200.0),
        values: &[20.0, 60.0, 120.0],
    },
    Branch {
        model: "morris_lecar",
        parameter: "iapp",
        set: &[],
        start: None,
        equilibria: (0.0, 120.0),
        hopf: 0,
        cycles: (50.0, 300.0),
        values: &[120.0, 160.0, 200.0],
    },
    Branch {
        model: "bautin",
        parameter: "beta1",
        set: &[],
        start: None,
        equilibria: (-1.0, 1.0),
        hopf: 0,
        cycles: (-1.0, 1.0),
        values: &[0.2, 0.5, 0.8],
    },
    Branch {
        model: "lure",
        parameter: "beta",
        set: &[("beta", 1.0)],
        start: None,
        equilibria: (0.2, 1.5),
        hopf: 0,
        cycles: (0.34, 0.6),
        values: &[0.45, 0.4, 0.36],
    },
];

/// The text of a model of the gallery.
///
/// # Errors
/// What reading it says.
pub(crate) fn source(model: &str) -> Result<String, String> {
    let path = format!("{}/../../gallery/models/{model}.ode", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).map_err(|error| format!("{path}: {error}"))
}

/// The branches of the gallery.
///
/// # Errors
/// As [`source`].
pub(crate) fn gallery() -> Result<Vec<Case>, String> {
    let case = |branch: &Branch| {
        let &Branch { model, parameter, set, start, equilibria, hopf, cycles, values } = branch;
        Ok(Case {
            model: model.into(),
            source: source(model)?,
            parameter,
            set,
            start,
            equilibria,
            hopf,
            cycles,
            values,
        })
    };
    GALLERY.iter().map(case).collect()
}

/// Brusselators in a row, the neighbours coupled by diffusion, with two states each: all of them swing together.
pub(crate) fn chain(states: usize) -> Case {
    let cells = states / 2;
    let mut source = String::from("par a=1, b=1.5, d=.2\n");
    for cell in 1..=cells {
        let (before, after) = (cell.saturating_sub(1).max(1), (cell + 1).min(cells));
        let diffusion = |name: &str| format!("({name}{before} - 2*{name}{cell} + {name}{after})");
        let _ = writeln!(source, "x{cell}' = a - (b+1)*x{cell} + x{cell}^2*y{cell} + d*{}", diffusion("x"));
        let _ = writeln!(source, "y{cell}' = b*x{cell} - x{cell}^2*y{cell} + d*{}", diffusion("y"));
    }
    for cell in 1..=cells {
        let _ = writeln!(source, "init x{cell}=1, y{cell}=1.5");
    }
    source.push_str("done\n");
    Case {
        model: format!("chain{states}"),
        source,
        parameter: "b",
        set: &[],
        start: None,
        equilibria: (1.5, 2.5),
        hopf: 0,
        cycles: (1.8, 3.0),
        values: &[2.2, 2.5, 2.8],
    }
}

/// A curve of bifurcations in the parameter of a case and a second one.
pub(crate) struct Curve {
    pub(crate) case: Case,
    pub(crate) kind: Kind,
    pub(crate) first: (f64, f64),
    pub(crate) second: (&'static str, (f64, f64)),
    /// Values of the first parameter at which the second is compared.
    pub(crate) values: &'static [f64],
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Hopf,
    FoldOfCycles,
    PeriodDoubling,
    Torus,
}

impl Kind {
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Hopf => "HB1",
            Self::FoldOfCycles => "LPC1",
            Self::PeriodDoubling => "PD1",
            Self::Torus => "NS1",
        }
    }

    /// The number of the kind in AUTO's files.
    pub(crate) fn code(self) -> f64 {
        match self {
            Self::Hopf => 3.0,
            Self::FoldOfCycles => 5.0,
            Self::PeriodDoubling => 7.0,
            Self::Torus => 8.0,
        }
    }
}

/// Four curves of bifurcations.
///
/// # Errors
/// As [`source`].
pub(crate) fn curves() -> Result<[Curve; 4], String> {
    let all = gallery()?;
    let case = |model: &str, parameter: &str| {
        all.iter()
            .find(|case| case.model == model && case.parameter == parameter)
            .cloned()
            .ok_or_else(|| format!("no case {model}"))
    };
    Ok([
        Curve {
            case: case("brusselator", "b")?,
            kind: Kind::Hopf,
            first: (1.2, 5.0),
            second: ("a", (0.5, 2.0)),
            values: &[1.5, 3.0, 4.0],
        },
        Curve {
            case: case("bautin", "beta1")?,
            kind: Kind::FoldOfCycles,
            first: (-1.0, 1.0),
            second: ("beta2", (0.1, 2.0)),
            values: &[-0.1, -0.5, -0.9],
        },
        Curve {
            case: Case { cycles: (0.5, 1.1), values: &[0.8], ..case("lure", "alpha")? },
            kind: Kind::PeriodDoubling,
            first: (0.2, 2.0),
            second: ("beta", (0.5, 1.5)),
            values: &[0.4, 0.8],
        },
        Curve {
            case: case("langford", "lambda")?,
            kind: Kind::Torus,
            first: (1.7, 2.4),
            second: ("b", (2.5, 3.5)),
            values: &[1.8, 2.2],
        },
    ])
}
