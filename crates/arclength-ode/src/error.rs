//! What can be wrong with a model, and where.

use std::fmt;

/// Where in the source something is: line and column count from 1, in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1.
    pub line: usize,
    /// Column of the first character, from 1.
    pub column: usize,
    /// Number of characters meant, at least 1.
    pub length: usize,
    /// The whole line of the source.
    pub source_line: String,
}

impl Place {
    /// The line of the source with carets under the place, as compilers print it; of a long line what is around the place.
    pub fn snippet(&self) -> String {
        /// Most characters of a line that are shown.
        const MOST: usize = 200;
        /// What stands where characters are left out.
        const LEFT_OUT: &str = "...";
        let number = self.line.to_string();
        let margin = " ".repeat(number.len());
        let count = self.source_line.chars().count();
        let before = self.column - 1;
        let start = if count > MOST { before.saturating_sub(MOST / 2).min(count - MOST) } else { 0 };
        let shown = self.source_line.chars().skip(start).take(MOST);
        let shown: String = shown.map(|c| if c.is_control() { ' ' } else { c }).collect();
        let head = if start > 0 { LEFT_OUT } else { "" };
        let tail = if start + MOST < count { LEFT_OUT } else { "" };
        let room = shown.chars().count().saturating_sub(before - start).max(1);
        let indent = " ".repeat(head.len() + before - start);
        let carets = "^".repeat(self.length.clamp(1, room));
        format!("{margin} |\n{number} | {head}{shown}{tail}\n{margin} | {indent}{carets}")
    }
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "line {}, column {}", self.line, self.column)
    }
}

/// Why a model could not be read.
///
/// The message names line, column and the offending text; [`OdeError::snippet`] shows the line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OdeError {
    /// Valid XPPAUT that is not a smooth system of ordinary differential equations.
    #[error("{place}: {feature} not supported; {remedy}")]
    Unsupported {
        /// Where it is.
        place: Place,
        /// What it is, with its verb: "delays are", "the table `w` is".
        feature: String,
        /// What to do about it.
        remedy: String,
    },
    /// Text that does not follow the grammar.
    #[error("{place}: {message}")]
    Syntax {
        /// Where it is.
        place: Place,
        /// What was found and what was expected.
        message: String,
    },
    /// A name that is declared nowhere.
    #[error("{place}: unknown {kind} `{name}`{}", suggest(nearest))]
    UnknownName {
        /// Where it is.
        place: Place,
        /// What it should name: "name", "function", "state", "directive".
        kind: &'static str,
        /// The name as written.
        name: String,
        /// The known name that is spelled most like it.
        nearest: Option<String>,
    },
    /// A name declared twice, or one that XPPAUT reserves.
    #[error("{place}: the name `{name}` is already {as_what}")]
    NameTaken {
        /// Where the second declaration is.
        place: Place,
        /// The name as written.
        name: String,
        /// What it already is.
        as_what: String,
    },
    /// A quantity or function that is defined through itself.
    #[error("{place}: `{name}` is defined through itself")]
    Circular {
        /// Where the circle closes.
        place: Place,
        /// The quantity or function.
        name: String,
    },
    /// A value that must be known when the model is read but depends on states, parameters or time.
    #[error("{place}: {what} must be a constant{}", because(variable))]
    NotConstant {
        /// Where it is.
        place: Place,
        /// What must be constant.
        what: String,
        /// What makes it vary, where known.
        variable: Option<String>,
    },
    /// A function called with the wrong number of arguments.
    #[error("{place}: `{function}` takes {expected} argument{}, not {found}", plural(*expected))]
    WrongNumberOfArguments {
        /// Where the call is.
        place: Place,
        /// The function.
        function: String,
        /// Number of arguments it takes.
        expected: usize,
        /// Number of arguments it was given.
        found: usize,
    },
    /// A model that exceeds a documented limit.
    #[error("{place}: {what}; the limit is {limit}")]
    TooLarge {
        /// Where the limit was passed.
        place: Place,
        /// What is too large.
        what: String,
        /// The limit.
        limit: usize,
    },
    /// A text without a single differential equation.
    #[error("the model has no differential equation; write one as x'=..., or dx/dt=...")]
    NoEquations,
    /// A name or a number that a model that is built cannot have.
    #[error("`{name}`: {problem}")]
    Name {
        /// The name.
        name: String,
        /// Why not.
        problem: String,
    },
}

impl OdeError {
    /// Where the error is; `None` when it concerns the whole text.
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::Unsupported { place, .. }
            | Self::Syntax { place, .. }
            | Self::UnknownName { place, .. }
            | Self::NameTaken { place, .. }
            | Self::Circular { place, .. }
            | Self::NotConstant { place, .. }
            | Self::WrongNumberOfArguments { place, .. }
            | Self::TooLarge { place, .. } => Some(place),
            Self::NoEquations | Self::Name { .. } => None,
        }
    }

    /// The message, and below it the line of the source with carets under the offending text.
    ///
    /// ```
    /// let error = arclength_ode::Model::parse("x' = -gama*x\npar gamma=1\n").unwrap_err();
    /// assert_eq!(
    ///     error.snippet(),
    ///     "line 1, column 7: unknown name `gama`; did you mean `gamma`?\n  \
    ///      |\n1 | x' = -gama*x\n  |       ^^^^"
    /// );
    /// ```
    pub fn snippet(&self) -> String {
        match self.place() {
            Some(place) => format!("{self}\n{}", place.snippet()),
            None => self.to_string(),
        }
    }

    fn place_mut(&mut self) -> Option<&mut Place> {
        match self {
            Self::Unsupported { place, .. }
            | Self::Syntax { place, .. }
            | Self::UnknownName { place, .. }
            | Self::NameTaken { place, .. }
            | Self::Circular { place, .. }
            | Self::NotConstant { place, .. }
            | Self::WrongNumberOfArguments { place, .. }
            | Self::TooLarge { place, .. } => Some(place),
            Self::NoEquations | Self::Name { .. } => None,
        }
    }

    /// Fills in the text of the source line, which the parser does not carry along.
    pub(crate) fn with_source(mut self, lines: &[&str]) -> Self {
        if let Some(place) = self.place_mut() {
            place.fill(lines);
        }
        self
    }

    pub(crate) fn unsupported(span: Span, feature: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Unsupported { place: span.into(), feature: feature.into(), remedy: remedy.into() }
    }

    pub(crate) fn syntax(span: Span, message: impl Into<String>) -> Self {
        Self::Syntax { place: span.into(), message: message.into() }
    }
}

/// Something that was read, but perhaps not as its author meant, or that has no meaning here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Where it is.
    pub place: Place,
    /// What is noticed and what was done.
    pub message: String,
}

impl Warning {
    pub(crate) fn new(span: Span, message: impl Into<String>) -> Self {
        Self { place: span.into(), message: message.into() }
    }

    pub(crate) fn with_source(mut self, lines: &[&str]) -> Self {
        self.place.fill(lines);
        self
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}", self.place, self.message)
    }
}

impl Place {
    pub(crate) fn fill(&mut self, lines: &[&str]) {
        self.source_line = lines.get(self.line - 1).copied().unwrap_or_default().to_owned();
    }
}

/// A place without the text of its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    pub line: u32,
    pub column: u32,
    pub length: u32,
}

impl From<Span> for Place {
    fn from(span: Span) -> Self {
        Self {
            line: span.line as usize,
            column: span.column as usize,
            length: span.length as usize,
            source_line: String::new(),
        }
    }
}

/// The candidate spelled most like `name`, if any is close enough to be a slip of the finger.
pub(crate) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    /// Similarity (one minus the edits per letter) below which a suggestion would mislead.
    const CLOSE: f64 = 0.6;
    /// Longest names that are compared: the work grows as the product of the lengths.
    const LONGEST: usize = 40;
    let name = name.to_lowercase();
    if name.len() > LONGEST {
        return None;
    }
    candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST)
        .map(|candidate| {
            (strsim::normalized_damerau_levenshtein(&name, &candidate.to_lowercase()), candidate)
        })
        .filter(|(similarity, _)| *similarity >= CLOSE)
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(a.1)))
        .map(|(_, candidate)| candidate.to_owned())
}

fn suggest(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

fn because(variable: &Option<String>) -> String {
    match variable {
        Some(name) => format!(", but it depends on `{name}`"),
        None => "; declare what it depends on with `number` instead of `par`".to_owned(),
    }
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}
