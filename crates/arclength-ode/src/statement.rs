//! Which kind of statement a line is.
//!
//! A line is told by its first punctuation, as in XPPAUT: `x'=`, `dx/dt=`, `x(0)=`, `f(x,y)=`, `k=`,
//! `!k=`, `@`; otherwise its first word is a directive. What is not a smooth ordinary differential
//! equation is refused here, by name.

use crate::error::{OdeError, Span, nearest};
use crate::source::Text;

/// A name as written, and where.
#[derive(Clone, Debug)]
pub(crate) struct Name {
    pub text: String,
    pub span: Span,
}

impl Name {
    /// The name as XPPAUT compares names.
    pub(crate) fn key(&self) -> String {
        self.text.to_ascii_lowercase()
    }
}

/// A statement; the numbers are indices into the line where its right-hand side starts.
#[derive(Debug)]
pub(crate) enum Statement {
    /// `x' = ...` or `dx/dt = ...`
    Equation(Name, usize),
    /// `k = ...`: a quantity that the equations use.
    Fixed(Name, usize),
    /// `!k = ...`: a quantity of the parameters only.
    Derived(Name, usize),
    /// `aux k = ...`
    Auxiliary(Name, usize),
    /// `f(x, y) = ...`
    Function(Name, Vec<Name>, usize),
    /// `x(0) = ...`
    InitialFormula(Name, usize),
    /// `par a=1, b=2`
    Parameters(usize),
    /// `number a=1, b=2`
    Numbers(usize),
    /// `init x=1, y=2`
    Initial(usize),
    /// `set name {x=1, a=2}`: the name, and where the inside of the braces starts and ends.
    Set(Name, usize, usize),
    /// `@ total=100, dt=.1`
    Options(usize),
    /// A directive that has no meaning here, with what to say about it.
    Ignored(Span, &'static str),
}

/// Directives as XPPAUT knows them, for suggestions.
const DIRECTIVES: [&str; 9] = ["par", "number", "init", "aux", "set", "options", "bdry", "only", "done"];

/// Largest number of arguments of a function.
const MAXIMUM_ARGUMENTS: usize = 100;

/// Spellings of the directive that gives a boundary condition.
const BOUNDARY: [&str; 4] = ["b", "bdry", "bndry", "boundary"];

/// Says what a non-empty line is.
pub(crate) fn classify(line: &Text) -> Result<Statement, OdeError> {
    let start = line.skip_blanks(0);
    match line.at(start) {
        '@' => return Ok(Statement::Options(start + 1)),
        '!' => {
            let (name, end) = name_at(line, start + 1)?;
            return Ok(Statement::Derived(name, after_equals(line, end)?));
        }
        '0' if line.at(line.skip_blanks(start + 1)) == '=' => {
            return Err(OdeError::unsupported(
                line.span(start, line.len()),
                "algebraic equations (0=...) are",
                "solve the equation for its variable by hand, or give the variable fast dynamics of its own",
            ));
        }
        '#' => {
            return Err(OdeError::unsupported(
                line.span(start, line.len()),
                "including other files is",
                "paste the text of the included file here",
            ));
        }
        first if first.is_ascii_digit() => {
            return Err(OdeError::unsupported(
                line.span(start, line.len()),
                "statements that start with a number (the format of XPP before 1997) are",
                "write the equations as x'=..., the parameters as par a=1",
            ));
        }
        _ => {}
    }
    let (name, end) = name_at(line, start)?;
    let next = line.skip_blanks(end);
    match line.at(next) {
        '=' if line.at(next + 1) != '=' => Ok(Statement::Fixed(name, next + 1)),
        '\'' if line.at(next + 1) == '\'' => Err(OdeError::unsupported(
            line.span(start, next + 2),
            "second derivatives are",
            format!("name the derivative and write two equations: {0}'={0}dot, {0}dot'=...", name.text),
        )),
        '\'' => Ok(Statement::Equation(name, after_equals(line, next + 1)?)),
        '/' if line.lower_at(start) == 'd' && end > start + 1 => leibniz(line, start, end, next),
        // `b (x-1)` is a boundary condition, `f (x)=...` a function.
        '(' if next > end && BOUNDARY.contains(&name.key().as_str()) => directive(line, name, next),
        '(' => with_parentheses(line, name, next),
        _ => directive(line, name, next),
    }
}

/// `dx/dt = ...`
fn leibniz(line: &Text, start: usize, end: usize, slash: usize) -> Result<Statement, OdeError> {
    let (denominator, after) = name_at(line, line.skip_blanks(slash + 1))?;
    if denominator.key() != "dt" {
        return Err(OdeError::syntax(denominator.span, "a derivative is written dx/dt= or x'="));
    }
    let name = Name { text: line.string(start + 1, end), span: line.span(start + 1, end) };
    Ok(Statement::Equation(name, after_equals(line, after)?))
}

/// `x(0)=`, `x(t+1)=`, `x(t)=` with an integral, or the definition of a function.
fn with_parentheses(line: &Text, name: Name, open: usize) -> Result<Statement, OdeError> {
    let close = line.find(open, |character| character == ')');
    let whole = line.span(open, close + 1);
    if close == line.len() {
        return Err(OdeError::syntax(whole, "the parenthesis ( is never closed"));
    }
    let inside: String = line.string(open + 1, close).split_whitespace().collect();
    let inside = inside.to_ascii_lowercase();
    let right = after_equals(line, close + 1)?;
    match inside.as_str() {
        "0" => return Ok(Statement::InitialFormula(name, right)),
        "t+1" | "n+1" => {
            return Err(OdeError::unsupported(
                line.span(line.skip_blanks(0), close + 1),
                "maps (x(t+1)=...) are",
                "only differential equations x'=... can be continued",
            ));
        }
        "t" if has_integral(line, right) => {
            return Err(OdeError::unsupported(
                line.span(line.skip_blanks(0), close + 1),
                "integral equations are",
                "replace an exponential kernel by a differential equation (the linear chain trick)",
            ));
        }
        _ => {}
    }
    let mut arguments = Vec::new();
    let mut position = open + 1;
    loop {
        let start = line.skip_blanks(position);
        let end = line.identifier_end(start);
        if end == start {
            let message = "a function is defined as f(x,y)=...: its arguments must be names";
            return Err(OdeError::syntax(line.span(start, start + 1), message));
        }
        arguments.push(Name { text: line.string(start, end), span: line.span(start, end) });
        if arguments.len() > MAXIMUM_ARGUMENTS {
            let what = "a function with too many arguments".into();
            return Err(OdeError::TooLarge { place: name.span.into(), what, limit: MAXIMUM_ARGUMENTS });
        }
        position = line.skip_blanks(end);
        match line.at(position) {
            ',' => position += 1,
            ')' => break,
            _ => {
                let message = "expected , or ) after the name of an argument";
                return Err(OdeError::syntax(line.span(position, position + 1), message));
            }
        }
    }
    Ok(Statement::Function(name, arguments, right))
}

fn has_integral(line: &Text, start: usize) -> bool {
    let text = line.string(start, line.len()).to_ascii_lowercase();
    text.contains("int{") || text.contains("int[")
}

fn directive(line: &Text, word: Name, rest: usize) -> Result<Statement, OdeError> {
    let key = word.key();
    let refuse = |feature: &str, remedy: &str| Err(OdeError::unsupported(word.span, feature, remedy));
    match key.as_str() {
        "p" | "par" | "pars" | "para" | "param" | "params" | "parameter" | "parameters" => {
            Ok(Statement::Parameters(rest))
        }
        "n" | "num" | "nums" | "number" | "numbers" => Ok(Statement::Numbers(rest)),
        "i" | "ic" | "init" | "initial" => Ok(Statement::Initial(rest)),
        "a" | "au" | "aux" | "auxiliary" => {
            // Nothing refers to an auxiliary quantity, so its name may hold any character.
            let end = line.find(rest, |character| character == '=' || character.is_whitespace());
            let name = Name { text: line.string(rest, end), span: line.span(rest, end) };
            Ok(Statement::Auxiliary(name, after_equals(line, end)?))
        }
        "set" => set(line, rest),
        key if BOUNDARY.contains(&key) => Ok(Statement::Ignored(
            word.span,
            "boundary conditions are ignored: equilibria and cycles have none",
        )),
        "only" => Ok(Statement::Ignored(word.span, "`only` chooses columns of XPPAUT's output: ignored")),
        "o" | "opt" | "option" | "options" => {
            Ok(Statement::Ignored(word.span, "a file of options is not read: give the options on a line @"))
        }
        "g" | "global" => refuse(
            "events that reset the state (global) are",
            "only smooth systems can be continued; remove the line to follow the flow between events",
        ),
        "w" | "wie" | "wien" | "wiener" => {
            refuse("noise (wiener) is", "remove the line and declare the noise as a parameter with value 0")
        }
        "m" | "markov" => {
            refuse("a Markov variable is", "replace it by the differential equation of its mean")
        }
        "t" | "tab" | "table" | "tabular" => {
            refuse("a table is", "write the tabulated function as a formula, f(x)=...")
        }
        "v" | "volt" | "volterra" => refuse(
            "an integral equation is",
            "replace an exponential kernel by a differential equation (the linear chain trick)",
        ),
        "s" | "so" | "sol" | "solv" | "solve" => refuse(
            "an algebraic equation (solve) is",
            "solve the equation by hand, or give its variable fast dynamics of its own",
        ),
        "sp" | "spec" | "special" => {
            refuse("a network operator (special) is", "write it with sum(a,b)of(...) and shift(x,i')")
        }
        "ex" | "export" | "vector" => {
            refuse("an external library is", "write its function as a formula in the model")
        }
        "group" => refuse("a group is", "write its parts as plain equations"),
        _ => {
            let next = line.at(rest);
            if nearest(&key, DIRECTIVES).is_none()
                && next != '\0'
                && !crate::source::is_identifier_start(next)
            {
                let message = format!("expected = after `{}`, found `{next}`", word.text);
                return Err(OdeError::syntax(line.span(rest, rest + 1), message));
            }
            let nearest = nearest(&key, DIRECTIVES);
            Err(OdeError::UnknownName {
                place: word.span.into(),
                kind: "directive",
                name: word.text.clone(),
                nearest,
            })
        }
    }
}

fn set(line: &Text, rest: usize) -> Result<Statement, OdeError> {
    let end = line.find(rest, |character| character == '{' || character.is_whitespace());
    let open = line.skip_blanks(end);
    let close = line.find(open, |character| character == '}');
    if end == rest || line.at(open) != '{' || close == line.len() {
        let message = "a named set is written set name {x=1,a=2}";
        return Err(OdeError::syntax(line.span(rest, line.len()), message));
    }
    let name = Name { text: line.string(rest, end), span: line.span(rest, end) };
    Ok(Statement::Set(name, open + 1, close))
}

fn name_at(line: &Text, position: usize) -> Result<(Name, usize), OdeError> {
    let start = line.skip_blanks(position);
    let end = line.identifier_end(start);
    if end == start {
        let message = match line.at(start) {
            '\0' => "expected a name before the end of the line".to_owned(),
            found => format!("expected a name, found `{found}`"),
        };
        return Err(OdeError::syntax(line.span(start, start + 1), message));
    }
    Ok((Name { text: line.string(start, end), span: line.span(start, end) }, end))
}

fn after_equals(line: &Text, position: usize) -> Result<usize, OdeError> {
    let position = line.skip_blanks(position);
    if line.at(position) == '=' {
        return Ok(position + 1);
    }
    let message = match line.at(position) {
        '\0' => "expected = before the end of the line".to_owned(),
        found => format!("expected =, found `{found}`"),
    };
    Err(OdeError::syntax(line.span(position, position + 1), message))
}
