//! Lists such as `a=1, b = 2 c=3`: names with values, separated by commas, blanks or both.

use crate::error::OdeError;
use crate::name::Name;
use crate::source::Text;

/// A name and where its value stands in the line; the value is empty when there was no `=`.
#[derive(Debug)]
pub(crate) struct Assignment {
    pub name: Name,
    pub value_start: usize,
    pub value_end: usize,
}

impl Assignment {
    pub(crate) fn value<'a>(&self, line: &'a Text) -> std::borrow::Cow<'a, str> {
        line.string(self.value_start, self.value_end).into()
    }

    pub(crate) fn has_value(&self) -> bool {
        self.value_end > self.value_start
    }
}

/// Reads the assignments in `line[start..end]`.
pub(crate) fn assignments(line: &Text, start: usize, end: usize) -> Result<Vec<Assignment>, OdeError> {
    let mut list = Vec::new();
    let separator = |character: char| character.is_whitespace() || matches!(character, ',' | ';');
    let mut position = start;
    loop {
        while position < end && separator(line.at(position)) {
            position += 1;
        }
        if position >= end {
            return Ok(list);
        }
        let name_end = line.find(position, |c| separator(c) || c == '=').min(end);
        let name = Name { text: line.string(position, name_end), span: line.span(position, name_end) };
        if name.text.is_empty() {
            return Err(OdeError::syntax(line.span(position, position + 1), "expected a name before ="));
        }
        let equals = line.skip_blanks(name_end);
        if equals >= end || line.at(equals) != '=' {
            list.push(Assignment { name, value_start: name_end, value_end: name_end });
            position = name_end;
            continue;
        }
        let value_start = line.skip_blanks(equals + 1).min(end);
        let value_end = value_end(line, value_start, end);
        if value_end == value_start {
            let message = format!("expected a value after `{}=`", name.text);
            return Err(OdeError::syntax(line.span(equals, equals + 1), message));
        }
        list.push(Assignment { name, value_start, value_end });
        position = value_end;
    }
}

/// A value ends at a comma or blank outside parentheses.
fn value_end(line: &Text, start: usize, end: usize) -> usize {
    let mut depth = 0_usize;
    for position in start..end {
        match line.at(position) {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            character if depth == 0 && (character.is_whitespace() || matches!(character, ',' | ';')) => {
                return position;
            }
            _ => {}
        }
    }
    end
}
