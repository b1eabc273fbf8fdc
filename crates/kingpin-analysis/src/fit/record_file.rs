//! A record from a file of comma-separated values.
//!
//! The first line has the names of the columns: `t` and states, in any order, with or without their units in brackets; other columns
//! are passed over. Lines that begin with `#` are comments; one of the form `# v = 1.5`, or `# v: 1.5 m/s, r: 2`, says at which values of
//! parameters the record was taken.

use crate::error::Error;
use arclength_analysis::Assignment;
use csv::{ReaderBuilder, StringRecord, Trim};
use kingpin::identification::{Column, FEWEST_SAMPLES};
use kingpin::{Key, Tyre};
use kingpin_report::numbers::readable;
use std::path::Path;

/// Name of the column of the times.
const TIME: &str = "t";

/// What a file holds.
#[derive(Clone, Debug)]
pub(super) struct RecordFile {
    /// Times in s.
    pub times: Vec<f64>,
    /// The states that were measured.
    pub columns: Vec<Column>,
    /// Parameters that it says it was taken at.
    pub settings: Vec<Assignment>,
    /// Names of columns that were passed over.
    pub passed_over: Vec<String>,
    /// Remarks that look like values of parameters and are none, with their lines and why.
    pub not_understood: Vec<(u64, String)>,
}

/// The unit of a column in which a file may have it.
fn unit(name: &str) -> &'static str {
    match name {
        TIME => "s",
        "psi" => "rad",
        "Omega" => "rad/s",
        "V" | "V1" | "V2" => "m/s",
        _ => "m",
    }
}

/// Reads a record with some of the states; those that are wanted, or all where none is.
///
/// # Errors
/// [`Error::RecordFile`], which says where what is wrong, and what is allowed.
pub(super) fn read(path: &Path, states: &[&str], wanted: &[String]) -> Result<RecordFile, Error> {
    let failure = |line: u64, column: Option<&str>, problem: String| Error::RecordFile {
        path: path.to_owned(),
        line,
        column: column.map(str::to_owned),
        problem,
    };
    let bytes =
        std::fs::read(path).map_err(|source| Error::UnreadableRecord { path: path.to_owned(), source })?;
    let text = String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes));
    let (comments, rows): (Vec<_>, Vec<_>) =
        (1..).zip(text.lines()).partition(|(_, line)| line.trim_start().starts_with('#'));
    // The line of the file in which a line without the comments stands.
    let line_of = |position: Option<&csv::Position>| {
        let index = position.map_or(0, |position| position.line().saturating_sub(1) as usize);
        rows.get(index).or(rows.last()).map_or(1, |(line, _)| *line)
    };
    let unreadable = |error: csv::Error| {
        failure(line_of(error.position()), None, format!("these are no comma-separated values: {error}"))
    };
    let values_alone: String = rows.iter().map(|(_, line)| format!("{line}\n")).collect();
    let mut reader = ReaderBuilder::new().trim(Trim::All).flexible(true).from_reader(values_alone.as_bytes());
    let header = reader.headers().map_err(unreadable)?.clone();
    let first_line = line_of(header.position());
    let places = places(&header, states, wanted)
        .map_err(|(column, problem)| failure(first_line, column.as_deref(), problem))?;
    let mut times: Vec<f64> = Vec::new();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); places.states.len()];
    let mut last = first_line;
    for row in reader.records() {
        let row = row.map_err(unreadable)?;
        last = line_of(row.position());
        let number = |name: &str, place: usize| {
            let text = row.get(place).unwrap_or_default();
            let number = text.parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| {
                let problem = format!(
                    "`{text}` is no finite number; allowed: a number in {}, with a decimal point",
                    unit(name)
                );
                failure(last, Some(name), problem)
            })
        };
        if let Some(text) = row.iter().skip(header.len()).find(|text| !text.is_empty()) {
            let problem = format!(
                "`{text}` stands under no name; allowed: {} values, with decimal points, separated by commas",
                header.len()
            );
            return Err(failure(last, None, problem));
        }
        let time = number(TIME, places.time)?;
        if let Some(before) = times.last().filter(|before| time <= **before) {
            let problem = format!(
                "{} does not come after {}; allowed: times that grow from row to row",
                readable(time),
                readable(*before)
            );
            return Err(failure(last, Some(TIME), problem));
        }
        times.push(time);
        for ((name, place), values) in places.states.iter().zip(&mut values) {
            values.push(number(name, *place)?);
        }
    }
    if times.len() < FEWEST_SAMPLES {
        let problem =
            format!("the file ends after {} samples; allowed: at least {FEWEST_SAMPLES}", times.len());
        return Err(failure(last, None, problem));
    }
    let columns = places.states.into_iter().zip(values).map(|((state, _), values)| Column { state, values });
    let (mut settings, mut not_understood) = (Vec::new(), Vec::new());
    for remark in comments.iter().flat_map(|(line, comment)| remarks(*line, comment)) {
        match remark {
            Remark::Setting(setting) => settings.push(setting),
            Remark::NotUnderstood(line, problem) => not_understood.push((line, problem)),
        }
    }
    Ok(RecordFile {
        columns: columns.collect(),
        times,
        settings,
        passed_over: places.passed_over,
        not_understood,
    })
}

/// Where the columns are.
struct Places {
    time: usize,
    states: Vec<(String, usize)>,
    passed_over: Vec<String>,
}

/// Finds the columns by their names.
///
/// # Errors
/// The column and what is wrong.
fn places(
    header: &StringRecord,
    states: &[&str],
    wanted: &[String],
) -> Result<Places, (Option<String>, String)> {
    if header.len() == 1 && header[0].contains([';', '\t']) {
        let problem =
            "the columns are not separated by commas; allowed: commas, and decimal points".to_owned();
        return Err((None, problem));
    }
    let mut time = None;
    let mut found: Vec<(String, usize)> = Vec::new();
    let mut passed_over = Vec::new();
    for (place, heading) in header.iter().enumerate() {
        let end = heading.find(['(', '[', ' ']).unwrap_or(heading.len());
        let (name, rest) = heading.split_at(end);
        let given = rest.trim_matches(|letter: char| letter.is_whitespace() || "()[]".contains(letter));
        let is_wanted = wanted.is_empty() || wanted.iter().any(|wanted| wanted == name);
        if name != TIME && !(states.contains(&name) && is_wanted) {
            passed_over.push(heading.to_owned());
            continue;
        }
        if !given.is_empty() && given != unit(name) {
            let problem = format!("its unit is {given}; allowed: {}", unit(name));
            return Err((Some(name.to_owned()), problem));
        }
        let twice = if name == TIME { time.is_some() } else { found.iter().any(|(other, _)| other == name) };
        if twice {
            return Err((Some(name.to_owned()), "it stands twice".to_owned()));
        }
        if name == TIME { time = Some(place) } else { found.push((name.to_owned(), place)) }
    }
    let columns = header.iter().collect::<Vec<_>>().join(", ");
    let missing = |name: &str, allowed: String| {
        let problem = format!("there is no such column; the columns are: {columns}; {allowed}");
        (Some(name.to_owned()), problem)
    };
    let Some(time) = time else {
        return Err(missing(TIME, format!("needed are: {TIME} and one or more of {}", states.join(", "))));
    };
    if let Some(wanted) = wanted.iter().find(|wanted| !found.iter().any(|(name, _)| name == *wanted)) {
        return Err(missing(wanted, format!("states are: {}", states.join(", "))));
    }
    if found.is_empty() {
        let problem =
            format!("no column is a state; the columns are: {columns}; allowed: {}", states.join(", "));
        return Err((None, problem));
    }
    Ok(Places { time, states: found, passed_over })
}

/// What a comment says of a parameter.
enum Remark {
    /// At which value the record was taken.
    Setting(Assignment),
    /// A line with something that looks like a value, and why it is none.
    NotUnderstood(u64, String),
}

/// The values in a comment, `# v = 1.5` or `# by hand, v: 1.5 m/s; r: 2`. Other words are passed over.
fn remarks(line: u64, comment: &str) -> Vec<Remark> {
    let comment = comment.trim_start().trim_start_matches('#');
    parts(comment).into_iter().filter_map(|part| remark(line, part)).collect()
}

/// The parts of a comment between semicolons and commas that are no decimal commas.
fn parts(comment: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut start = 0;
    for (place, _) in comment.match_indices([';', ',']) {
        let rest = &comment[place + 1..];
        if !rest.starts_with(|letter: char| letter.is_ascii_digit()) {
            parts.push(&comment[start..place]);
            start = place + 1;
        }
    }
    parts.push(&comment[start..]);
    parts
}

/// What a part of a comment says.
fn remark(line: u64, part: &str) -> Option<Remark> {
    let separator = part.find(['=', ':'])?;
    let (name, value) = (part[..separator].trim(), part[separator + 1..].trim());
    let first = value.split_whitespace().next().unwrap_or_default();
    // Between digits a colon is that of a time of day.
    let is_time =
        part[separator..].starts_with(':') && name.ends_with(|letter: char| letter.is_ascii_digit());
    let is_number = !is_time && first.parse::<f64>().is_ok();
    // A colon stands in many a sentence.
    let is_assigned = part[separator..].starts_with('=') || is_number || first.parse::<Tyre>().is_ok();
    let setting =
        |value: &str| Some(Remark::Setting(Assignment { key: name.to_owned(), value: value.to_owned() }));
    match name.parse::<Key>() {
        Ok(key) if is_assigned => {
            let unit = value.strip_prefix(first).unwrap_or_default().trim();
            setting(if unit == key.unit() { first } else { value })
        }
        _ if name == Tyre::KEY && is_assigned => setting(value),
        Err(error) if is_number && name.starts_with(char::is_alphabetic) => {
            Some(Remark::NotUnderstood(line, format!("`{}` is not understood: {error}", part.trim())))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATES: [&str; 5] = ["u", "q", "psi", "V", "Omega"];

    fn of(text: &str, wanted: &[&str]) -> Result<RecordFile, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        let wanted: Vec<String> = wanted.iter().map(|name| (*name).to_owned()).collect();
        read(file.path(), &STATES, &wanted).map_err(|error| error.to_string())
    }

    #[test]
    fn columns_may_stand_in_any_order_and_have_units() {
        let text = "# v = 1.5\n# taken by hand\npsi (rad),note,t [s]\n0.3,a,0\n0.2,b,1\n0.1,c,2\n# k = 7\n0,d,3\n0.1,e,4\n";
        let found = of(text, &[]).unwrap();
        assert_eq!(found.times, [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(
            found.columns,
            [Column { state: "psi".to_owned(), values: vec![0.3, 0.2, 0.1, 0.0, 0.1] }]
        );
        assert_eq!(found.passed_over, ["note"]);
        let settings: Vec<String> =
            found.settings.iter().map(|set| format!("{}={}", set.key, set.value)).collect();
        assert_eq!(settings, ["v=1.5", "k=7"]);
    }

    #[test]
    fn remarks_are_read_or_told_of() {
        const ROWS: &str = "t,psi\n0,0\n1,1\n2,0\n3,1\n4,0\n";
        for (remark, expected) in [
            ("# v = 0.5", "v=0.5"),
            ("#v=0.5", "v=0.5"),
            ("## v: 0.5", "v=0.5"),
            ("# v = 0.5 m/s", "v=0.5"),
            ("# psi in rad, v = 0.5", "v=0.5"),
            ("# v: 0.5, r: 2; l=0.1", "v=0.5 r=2 l=0.1"),
            ("# v=0.5,r=inf", "v=0.5 r=inf"),
            ("# tyre: brush", "tyre=brush"),
            // What is no value is refused where it is set.
            ("# v = 0,5", "v=0,5"),
            ("# v = 0.5 km/h", "v=0.5 km/h"),
        ] {
            let found = of(&format!("{remark}\n{ROWS}"), &[]).unwrap();
            let settings: Vec<String> =
                found.settings.iter().map(|set| format!("{}={}", set.key, set.value)).collect();
            assert_eq!((settings.join(" ").as_str(), found.not_understood.len()), (expected, 0), "{remark}");
        }
        for remark in ["# V = 0.5", "# speed: 0.5", "# taken at v = 0.5", "# by hand; velocity = 0.5 m/s"] {
            let found = of(&format!("# first\n{remark}\n{ROWS}"), &[]).unwrap();
            assert!(found.settings.is_empty(), "{remark}");
            let [(line, problem)] = found.not_understood.as_slice() else { panic!("{remark}") };
            assert!(*line == 2 && problem.contains("is not understood: unknown key"), "{problem}");
        }
        for remark in ["# taken at 10:30", "# date: 2026-05-01", "# v: by hand", "# note: all is well"] {
            let found = of(&format!("{remark}\n{ROWS}"), &[]).unwrap();
            assert!(found.settings.is_empty() && found.not_understood.is_empty(), "{remark}");
        }
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let rows = "0,0\n1,1\n2,0\n3,1\n4,0\n";
        for (text, wanted, expected) in [
            (
                format!("time,psi\n{rows}"),
                &[][..],
                "line 1, column t: there is no such column; the columns are: time, psi; needed are: t and",
            ),
            (
                format!("t,phi\n{rows}"),
                &[],
                "line 1: no column is a state; the columns are: t, phi; allowed: u, q, psi, V, Omega",
            ),
            (format!("t,psi (deg)\n{rows}"), &[], "line 1, column psi: its unit is deg; allowed: rad"),
            (format!("t,psi,psi\n{rows}"), &[], "line 1, column psi: it stands twice"),
            (format!("t,psi\n{rows}"), &["q"], "line 1, column q: there is no such column"),
            (
                "t,psi\n0,1\n1,2\n1,3\n".to_owned(),
                &[],
                "line 4, column t: 1 does not come after 1; allowed: times that grow",
            ),
            (
                "t,psi\n0,1\n1,nan\n".to_owned(),
                &[],
                "line 3, column psi: `nan` is no finite number; allowed: a number in rad",
            ),
            ("t,psi\n0,1\n1\n".to_owned(), &[], "line 3, column psi: `` is no finite number"),
            ("t,psi\n0,1\n".to_owned(), &[], "line 2: the file ends after 1 samples; allowed: at least 5"),
            ("t;psi\n0;1\n".to_owned(), &[], "line 1: the columns are not separated by commas"),
            (String::new(), &[], "column t: there is no such column"),
            (
                "t,psi\n0,0.3\n0.003,0.30,7\n".to_owned(),
                &[],
                "line 3: `7` stands under no name; allowed: 2 values, with decimal points",
            ),
        ] {
            let message = of(&text, wanted).unwrap_err();
            assert!(message.contains(expected), "{message}\n{expected}");
        }
    }
}
