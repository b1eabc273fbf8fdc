//! The verdict: the whole report in one sentence.

use super::finding::Finding;

/// What each subject says in a few words, as far as it has anything to say.
#[derive(Debug, Default)]
pub(super) struct Verdict {
    /// That nothing presses the wheel on the ground.
    pub lifted: Option<String>,
    pub straight: Option<String>,
    pub circle: Option<String>,
    pub dry_friction: Option<String>,
    pub shimmy: Option<String>,
    pub blow: Option<String>,
    pub rolling: Option<String>,
    pub dampers: Option<String>,
    pub dampers_on_circle: Option<String>,
}

impl Verdict {
    /// All of it, joined.
    pub(super) fn finding(self) -> Finding {
        let Self {
            lifted,
            straight,
            circle,
            dry_friction,
            shimmy,
            blow,
            rolling,
            dampers,
            dampers_on_circle,
        } = self;
        let parts =
            [lifted, straight, circle, dry_friction, shimmy, blow, rolling, dampers, dampers_on_circle];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        Finding::new("verdict", sentence(&parts.join("; ")), "")
    }
}

/// Words as a sentence.
pub(super) fn sentence(words: &str) -> String {
    let (first, rest) = words.split_at(words.chars().next().map_or(0, char::len_utf8));
    format!("{}{rest}.", first.to_uppercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_is_joined_in_one_sentence() {
        let verdict = Verdict {
            straight: Some("straight: unstable at every speed".to_owned()),
            dampers: Some("it takes a damper".to_owned()),
            ..Verdict::default()
        };
        assert_eq!(verdict.finding().text, "Straight: unstable at every speed; it takes a damper.");
    }
}
