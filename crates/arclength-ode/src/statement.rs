//! Which kind of statement a line is.
//!
//! A line is told by its first punctuation, as in XPPAUT: `x'=`, `dx/dt=`, `x(0)=`, `f(x,y)=`, `k=`,
//! `!k=`, `@`; otherwise its first word is a directive. What is not a smooth ordinary differential
//! equation is refused here, by name.

use crate::assignments::assignments;
use crate::error::{OdeError, Span, nearest};
use crate::expression::parse_number;
use crate::look_alike;
use crate::name::Name;
use crate::source::Text;
use arclength::Direction;

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
    /// `table f % 101 0 1 sin(t)`: the name, number of points and their range, and where the formula starts.
    Table(Name, TableRange, usize),
    /// `global 1 {x-1} {x=0;y=y+1}`
    Event(EventStatement),
    /// Names of what is refused where something depends on them, with the refusal, and how many lines behind belong to it.
    Refused(Vec<Name>, OdeError, usize),
    /// A line that has no meaning here, with what to say about it.
    Ignored(Span, String),
}

/// `global sign condition {name=expression; ...}`; the numbers are where expressions start and end.
#[derive(Debug)]
pub(crate) struct EventStatement {
    pub span: Span,
    pub direction: Direction,
    pub condition: (usize, usize),
    pub assignments: Vec<(Name, usize, usize)>,
}

/// Directives that are understood, for suggestions.
const DIRECTIVES: [&str; 9] = ["par", "number", "init", "aux", "set", "table", "only", "global", "done"];

/// Where the points of a table lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TableRange {
    pub points: u32,
    pub low: f64,
    pub high: f64,
}

/// Largest number of arguments of a function.
const MAXIMUM_ARGUMENTS: usize = 100;

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
        _ if line.skip_blanks(line.number_end(start)) == line.len() => {
            return Err(OdeError::unsupported(
                line.span(start, line.len()),
                "statements that start with a number (the format of XPP before 1997) are",
                "write the equations as x'=..., the parameters as par a=1",
            ));
        }
        _ => {}
    }
    // XPPAUT ends the first word of a line at these.
    let word_end = line.find(start, |c| c.is_whitespace() || matches!(c, '=' | '/' | '\'' | '('));
    let ends_in_blank = line.at(word_end) == '\0' || line.at(word_end).is_whitespace();
    if ends_in_blank && word_end > line.identifier_end(start) && line.at(line.skip_blanks(word_end)) != '=' {
        let word = Name { text: line.string(start, word_end), span: line.span(start, word_end) };
        return directive(line, word, line.skip_blanks(word_end));
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
        '(' if next > end && !defines(line, next) => directive(line, name, next),
        '(' => with_parentheses(line, name, next),
        mark if look_alike::is_prime(mark) && line.at(line.skip_blanks(next + 1)) == '=' => {
            let message =
                format!("`{}` makes no derivative{}", mark.escape_default(), look_alike::remedy(mark));
            Err(OdeError::syntax(line.span(next, next + 1), message))
        }
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

/// Whether an equals sign follows the parenthesis that opens at `open`.
fn defines(line: &Text, open: usize) -> bool {
    let close = line.find(open, |character| character == ')');
    line.at(line.skip_blanks(close + 1)) == '='
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

/// A line whose first word is a directive, which XPPAUT knows by its first letter or two. Other lines it drops.
fn directive(line: &Text, word: Name, rest: usize) -> Result<Statement, OdeError> {
    let key = word.key();
    let refuse = |feature: &str, remedy: &str| Err(OdeError::unsupported(word.span, feature, remedy));
    let is_vectorizer = key.starts_with("ve") && key.as_bytes().get(5) == Some(&b'r');
    let is_special = key.starts_with("sp") && key.as_bytes().get(5) == Some(&b'a');
    match key.as_bytes() {
        [b'p', ..] => Ok(Statement::Parameters(rest)),
        [b'n', ..] => Ok(Statement::Numbers(rest)),
        [b'i', ..] => Ok(Statement::Initial(rest)),
        [b'a'] | [b'a', b'u', ..] => {
            // Nothing refers to an auxiliary quantity, so its name may hold any character.
            let end = line.find(rest, |character| character == '=' || character.is_whitespace());
            let name = Name { text: line.string(rest, end), span: line.span(rest, end) };
            Ok(Statement::Auxiliary(name, after_equals(line, end)?))
        }
        [b's', b'e', ..] => set(line, rest),
        [b't', b'a', ..] => table(line, &word, rest),
        [b'b', ..] => refuse(
            "boundary conditions are",
            "remove the lines of boundary conditions to follow the motion from the initial values, which is another problem",
        ),
        [b'o', b'n', ..] => Ok(Statement::Ignored(
            word.span,
            format!("`{}` chooses columns of XPPAUT's output: ignored", word.text),
        )),
        [b'o', ..] => Ok(Statement::Ignored(
            word.span,
            "a file of options is not read: give the options on a line @".to_owned(),
        )),
        [b'g', b'r', ..] => refuse("a group is", "write its parts as plain equations"),
        [b'g', ..] => event(line, &word, rest),
        [b'w', ..] => {
            let remedy = "remove the line and declare the noise as a parameter with value 0";
            let names = assignments(line, rest, line.len())?.into_iter().map(|assignment| assignment.name);
            Ok(Statement::Refused(
                names.collect(),
                OdeError::unsupported(word.span, "noise (wiener) is", remedy),
                0,
            ))
        }
        [b'm', b'a', ..] => markov(line, &word, rest),
        _ if is_vectorizer => {
            refuse("an external library is", "write its function as a formula in the model")
        }
        [b'v', ..] => refuse(
            "an integral equation is",
            "replace an exponential kernel by a differential equation (the linear chain trick)",
        ),
        [b's', b'o', ..] => refuse(
            "an algebraic equation (solve) is",
            "solve the equation by hand, or give its variable fast dynamics of its own",
        ),
        _ if is_special => {
            let remedy = "write it with sum(a,b)of(...) and shift(x,i')";
            let error = OdeError::unsupported(word.span, "a network operator (special) is", remedy);
            match name_at(line, rest) {
                Ok((name, _)) => Ok(Statement::Refused(vec![name], error, 0)),
                Err(_) => Err(error),
            }
        }
        [b'e', b'x', ..] => refuse("an external library is", "write its function as a formula in the model"),
        _ => {
            let guess = nearest(&key, DIRECTIVES);
            let guess = guess.map(|guess| format!("; did you mean `{guess}`?")).unwrap_or_default();
            let message =
                format!("`{}` begins no statement: the line is left out, as by XPPAUT{guess}", word.text);
            Ok(Statement::Ignored(word.span, message))
        }
    }
}

/// `markov z 2`, and the rows of its matrix on as many lines.
fn markov(line: &Text, word: &Name, rest: usize) -> Result<Statement, OdeError> {
    let remedy = "replace it by the differential equation of its mean";
    let error = OdeError::unsupported(word.span, "a Markov variable is", remedy);
    let Ok((name, end)) = name_at(line, rest) else { return Err(error) };
    match line.string(end, line.len()).trim().parse() {
        Ok(rows) => Ok(Statement::Refused(vec![name], error, rows)),
        Err(_) => Err(error),
    }
}

/// `table f % 101 0 1 sin(t)`
fn table(line: &Text, word: &Name, rest: usize) -> Result<Statement, OdeError> {
    let mut position = rest;
    let mut next = || {
        let start = line.skip_blanks(position);
        position = line.find(start, char::is_whitespace);
        (line.string(start, position), line.span(start, position))
    };
    let (name, name_span) = next();
    let (kind, _) = next();
    if kind != "%" {
        let error = OdeError::unsupported(
            word.span,
            "a table that is read from a file is",
            format!(
                "write the tabulated function as a formula, {name}(x)=..., or as a table of a formula, table {name} % POINTS LOW HIGH f(t)"
            ),
        );
        return Ok(Statement::Refused(vec![Name { text: name, span: name_span }], error, 0));
    }
    let mut number = |what: &str| {
        let (text, span) = next();
        let number = parse_number(&text).filter(|number| number.is_finite());
        number.map(|number| (number, span)).ok_or_else(|| {
            let message = format!("expected {what} in table {name} % POINTS LOW HIGH f(t), found `{text}`");
            OdeError::syntax(span, message)
        })
    };
    let (points, points_span) = number("the number of points")?;
    let (low, _) = number("the lower end")?;
    let (high, high_span) = number("the upper end")?;
    if !(points.fract() == 0.0 && (2.0..=f64::from(u32::MAX)).contains(&points)) {
        return Err(OdeError::syntax(points_span, "a table has two points or more"));
    }
    if high <= low {
        return Err(OdeError::syntax(high_span, "the upper end of a table lies above its lower end"));
    }
    let range = TableRange { points: points as u32, low, high };
    Ok(Statement::Table(Name { text: name, span: name_span }, range, position))
}

/// `global 1 {x-1} {x=0;y=y+1}`, the first braces being optional.
fn event(line: &Text, word: &Name, rest: usize) -> Result<Statement, OdeError> {
    let malformed = |start: usize, end: usize, what: &str| {
        let message = format!("{what}; an event is written global 1 {{x-1}} {{x=0;y=y+1}}");
        Err(OdeError::syntax(line.span(start, end), message))
    };
    let sign_end = line.find(rest, |character| character.is_whitespace() || character == '{');
    let direction = match line.string(rest, sign_end).as_str() {
        "1" | "+1" => Direction::Rising,
        "-1" => Direction::Falling,
        "0" => Direction::Either,
        _ => {
            return malformed(
                rest,
                sign_end,
                "expected the sign of the passage of the condition through zero: 1 (rising), -1 (falling) or 0 (both)",
            );
        }
    };
    let start = line.skip_blanks(sign_end);
    let is_braced = line.at(start) == '{';
    let condition_start = start + usize::from(is_braced);
    let condition_end = line.find(condition_start, |character| matches!(character, '{' | '}'));
    let open = line.find(condition_end, |character| character == '{');
    let close = line.find(open, |character| character == '}');
    if line.skip_blanks(condition_start) >= condition_end {
        return malformed(start, condition_end, "expected a condition");
    }
    if close == line.len() {
        return malformed(open, line.len(), "expected assignments in braces");
    }
    let mut assignments = Vec::new();
    let mut position = open + 1;
    while position < close {
        let end = line.find(position, |character| character == ';').min(close);
        if line.skip_blanks(position) < end {
            let (name, name_end) = name_at(line, position)?;
            assignments.push((name, after_equals(line, name_end)?, end));
        }
        position = end + 1;
    }
    if assignments.is_empty() {
        return malformed(open, close + 1, "expected an assignment");
    }
    let condition = (condition_start, condition_end);
    Ok(Statement::Event(EventStatement { span: word.span, direction, condition, assignments }))
}

fn set(line: &Text, rest: usize) -> Result<Statement, OdeError> {
    let open = line.find(rest, |character| character == '{');
    let mut end = open;
    while end > rest && line.at(end - 1).is_whitespace() {
        end -= 1;
    }
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
            found => format!("expected a name, found `{found}`{}", look_alike::remedy(found)),
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
        found => format!("expected =, found `{found}`{}", look_alike::remedy(found)),
    };
    Err(OdeError::syntax(line.span(position, position + 1), message))
}
