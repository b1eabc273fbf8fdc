//! Messages that echo what was given stay readable however long that is.
//!
//! Whoever makes a message need not think of it: nothing longer gets out.

use std::borrow::Cow;

/// Most characters of a word, such as a value that was given, and how many of its first and last ones are shown otherwise.
const WORD: Limit = Limit { most: 240, first: 60, last: 20 };
/// The same of a line.
const LINE: Limit = Limit { most: 1200, first: 700, last: 400 };
/// The same of the lines of a message.
const LINES: Limit = Limit { most: 60, first: 40, last: 10 };

/// How long something may be.
#[derive(Clone, Copy, Debug)]
struct Limit {
    most: usize,
    first: usize,
    last: usize,
}

/// A message, borrowed where nothing is too long, in which too long words and lines, and too many lines, have lost their middle, which is said there.
pub(crate) fn shortened(message: &str) -> Cow<'_, str> {
    if message.len() <= WORD.most {
        return message.into();
    }
    let lines: Vec<&str> = message.split('\n').collect();
    let lines = match LINES.cut(lines.len()) {
        None => lines.into_iter().map(shortened_line).collect::<Vec<_>>(),
        Some((first, last)) => {
            let omitted = format!("... ({} lines left out)", last - first).into();
            let before = lines[..first].iter().map(|line| shortened_line(line));
            before.chain([omitted]).chain(lines[last..].iter().map(|line| shortened_line(line))).collect()
        }
    };
    let shorter = lines.join("\n");
    if shorter == message { message.into() } else { shorter.into() }
}

fn shortened_line(line: &str) -> Cow<'_, str> {
    if line.len() <= WORD.most {
        return line.into();
    }
    let words: String =
        line.split_inclusive(char::is_whitespace).map(|word| without_middle(word, WORD)).collect();
    without_middle(&words, LINE).into_owned().into()
}

/// A text without its middle where it is longer than allowed.
fn without_middle(text: &str, limit: Limit) -> Cow<'_, str> {
    // Bytes are at least as many as characters.
    if text.len() <= limit.most {
        return text.into();
    }
    let count = text.chars().count();
    let Some((first, _)) = limit.cut(count) else { return text.into() };
    let head: String = text.chars().take(first).collect();
    let mut tail: Vec<char> = text.chars().rev().take(limit.last).collect();
    tail.reverse();
    let tail: String = tail.into_iter().collect();
    format!("{head}... ({} characters left out) ...{tail}", count - limit.first - limit.last).into()
}

impl Limit {
    /// Where the part that is left out begins and ends, of so many.
    fn cut(self, count: usize) -> Option<(usize, usize)> {
        (count > self.most).then(|| (self.first, count - self.last))
    }
}

#[cfg(test)]
mod tests {
    use super::shortened;

    #[test]
    fn what_is_short_stays() {
        let text = "--set l=-1: below its range; allowed: 0 to 10 m\n  |\n1 | x' = -gama*x";
        assert_eq!(shortened(text), text);
        let sentences = "a word and another ".repeat(60);
        assert_eq!(shortened(&sentences), sentences);
    }

    #[test]
    fn long_words_lines_and_texts_lose_their_middle() {
        let value = "9".repeat(1_000_000);
        let text = shortened(&format!("--set l={value}: no number; allowed: 0 to 10 m")).into_owned();
        assert!(
            text.starts_with("--set l=999") && text.ends_with("999: no number; allowed: 0 to 10 m"),
            "{text}"
        );
        assert!(text.contains("(999924 characters left out)") && text.len() < 300, "{text}");
        let line = shortened(&"1 2 ".repeat(1_000_000)).into_owned();
        assert!(line.starts_with("1 2 1 2") && line.contains("left out") && line.len() < 1300);
        let lines = shortened(&"x\n".repeat(1_000_000)).into_owned();
        assert!(lines.contains("(999951 lines left out)") && lines.lines().count() < 60, "{lines}");
        let umlauts = shortened(&"ü".repeat(1000)).into_owned();
        assert!(umlauts.contains("(920 characters left out)"), "{umlauts}");
    }
}
