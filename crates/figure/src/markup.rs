//! The markup of labels: plain text with mathematics between dollar signs, a small part of LaTeX.
//!
//! Between `$` signs letters are italic, `_` and `^` lower and raise the next character or group, `\psi` and the like
//! name symbols, `\mathrm{..}` is upright, `\,` is a thin space, and `-` is a minus sign. `\$` is a dollar sign. Markup
//! never fails: what is not understood is shown as it was written.

/// A piece of a label.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Piece {
    /// One character, already in its mathematical form (an italic letter is another character than an upright one).
    Character(char),
    /// A space, in em.
    Space(f64),
    /// Lowered and raised text after what precedes; either may be empty.
    Scripts { lower: Vec<Piece>, upper: Vec<Piece> },
}

/// Spaces around relations and binary operators, in em (Knuth, The TeXbook, chapter 18).
const RELATION_SPACE: f64 = 5.0 / 18.0;
const OPERATOR_SPACE: f64 = 4.0 / 18.0;
const THIN_SPACE: f64 = 3.0 / 18.0;

/// Parses a label.
pub(crate) fn parse(source: &str) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut rest = source;
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("\\$") {
            pieces.push(Piece::Character('$'));
            rest = after;
        } else if let Some((math, after)) = rest.strip_prefix('$').and_then(|inner| inner.split_once('$')) {
            let mut parser = MathParser { characters: math.chars().collect(), position: 0, upright: false };
            pieces.extend(parser.row());
            rest = after;
        } else {
            let mut characters = rest.chars();
            if let Some(character) = characters.next() {
                pieces.push(Piece::Character(character));
            }
            rest = characters.as_str();
        }
    }
    pieces
}

struct MathParser {
    characters: Vec<char>,
    position: usize,
    upright: bool,
}

impl MathParser {
    fn peek(&self) -> Option<char> {
        self.characters.get(self.position).copied()
    }

    /// Everything up to the end or to the brace that closes this group.
    fn row(&mut self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        while let Some(next) = self.peek() {
            match next {
                '}' => break,
                '_' | '^' => pieces.push(self.scripts()),
                _ => self.atom(&mut pieces),
            }
        }
        pieces
    }

    fn scripts(&mut self) -> Piece {
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        while let Some(mark @ ('_' | '^')) = self.peek() {
            self.position += 1;
            let target = if mark == '_' { &mut lower } else { &mut upper };
            match self.peek() {
                Some('_' | '^' | '}') | None => target.push(Piece::Character(mark)),
                Some(_) => self.atom(target),
            }
        }
        Piece::Scripts { lower, upper }
    }

    /// One character, command or group in braces.
    fn atom(&mut self, pieces: &mut Vec<Piece>) {
        let Some(character) = self.peek() else { return };
        self.position += 1;
        match character {
            '{' => {
                pieces.extend(self.row());
                if self.peek() == Some('}') {
                    self.position += 1;
                }
            }
            '\\' => self.command(pieces),
            ' ' if self.upright => pieces.push(Piece::Character(' ')),
            c if c.is_whitespace() => {}
            _ => self.symbol(character, pieces),
        }
    }

    fn command(&mut self, pieces: &mut Vec<Piece>) {
        let start = self.position;
        while self.peek().is_some_and(|c| c.is_ascii_alphabetic()) {
            self.position += 1;
        }
        if start == self.position {
            match self.peek() {
                Some(',') => pieces.push(Piece::Space(THIN_SPACE)),
                Some(' ') => pieces.push(Piece::Character(' ')),
                Some(other) => pieces.push(Piece::Character(other)),
                None => pieces.push(Piece::Character('\\')),
            }
            self.position += 1;
            return;
        }
        let name: String = self.characters[start..self.position].iter().collect();
        match name.as_str() {
            "mathrm" | "text" => {
                let before = std::mem::replace(&mut self.upright, true);
                self.atom(pieces);
                self.upright = before;
            }
            "quad" => pieces.push(Piece::Space(1.0)),
            _ => match symbol_named(&name) {
                Some(symbol) => self.symbol(symbol, pieces),
                None => pieces.extend(std::iter::once('\\').chain(name.chars()).map(Piece::Character)),
            },
        }
    }

    fn symbol(&self, character: char, pieces: &mut Vec<Piece>) {
        let character = if character == '-' && !self.upright { '−' } else { character };
        let space = match character {
            _ if self.upright => 0.0,
            '=' | '<' | '>' | '≤' | '≥' | '≈' | '→' | '∼' => RELATION_SPACE,
            // An operator with nothing to its left is a sign.
            '+' | '−' | '±' | '×' | '·'
                if matches!(pieces.last(), Some(Piece::Character(_) | Piece::Scripts { .. })) =>
            {
                OPERATOR_SPACE
            }
            ',' => {
                pieces.push(Piece::Character(','));
                pieces.push(Piece::Space(THIN_SPACE));
                return;
            }
            _ => 0.0,
        };
        let shown = if self.upright { character } else { italic(character) };
        if space > 0.0 {
            pieces.extend([Piece::Space(space), Piece::Character(shown), Piece::Space(space)]);
        } else {
            pieces.push(Piece::Character(shown));
        }
    }
}

/// The mathematical italic of a Latin or small Greek letter; capital Greek letters stay upright as in LaTeX.
fn italic(character: char) -> char {
    let shifted = |first: char, base: u32| char::from_u32(base + (character as u32 - first as u32));
    match character {
        // Unicode keeps the italic h among the letter-like symbols.
        'h' => Some('\u{210E}'),
        'a'..='z' => shifted('a', 0x1D44E),
        'A'..='Z' => shifted('A', 0x1D434),
        'α'..='ω' => shifted('α', 0x1D6FC),
        'ϑ' => Some('\u{1D717}'),
        'ϕ' => Some('\u{1D719}'),
        'ϵ' => Some('\u{1D716}'),
        _ => None,
    }
    .unwrap_or(character)
}

fn symbol_named(name: &str) -> Option<char> {
    const SYMBOLS: [(&str, char); 60] = [
        ("alpha", 'α'),
        ("beta", 'β'),
        ("gamma", 'γ'),
        ("delta", 'δ'),
        ("epsilon", 'ϵ'),
        ("varepsilon", 'ε'),
        ("zeta", 'ζ'),
        ("eta", 'η'),
        ("theta", 'θ'),
        ("vartheta", 'ϑ'),
        ("iota", 'ι'),
        ("kappa", 'κ'),
        ("lambda", 'λ'),
        ("mu", 'μ'),
        ("nu", 'ν'),
        ("xi", 'ξ'),
        ("pi", 'π'),
        ("rho", 'ρ'),
        ("sigma", 'σ'),
        ("tau", 'τ'),
        ("upsilon", 'υ'),
        ("phi", 'ϕ'),
        ("varphi", 'φ'),
        ("chi", 'χ'),
        ("psi", 'ψ'),
        ("omega", 'ω'),
        ("Gamma", 'Γ'),
        ("Delta", 'Δ'),
        ("Theta", 'Θ'),
        ("Lambda", 'Λ'),
        ("Xi", 'Ξ'),
        ("Pi", 'Π'),
        ("Sigma", 'Σ'),
        ("Upsilon", 'Υ'),
        ("Phi", 'Φ'),
        ("Psi", 'Ψ'),
        ("Omega", 'Ω'),
        ("infty", '∞'),
        ("ell", 'ℓ'),
        ("to", '→'),
        ("rightarrow", '→'),
        ("pm", '±'),
        ("times", '×'),
        ("cdot", '·'),
        ("circ", '°'),
        ("degree", '°'),
        ("le", '≤'),
        ("leq", '≤'),
        ("ge", '≥'),
        ("geq", '≥'),
        ("approx", '≈'),
        ("sim", '∼'),
        ("partial", '∂'),
        ("prime", '′'),
        ("Re", 'ℜ'),
        ("Im", 'ℑ'),
        ("ldots", '…'),
        ("sqrt", '√'),
        ("propto", '∝'),
        ("neq", '≠'),
    ];
    SYMBOLS.iter().find(|(known, _)| *known == name).map(|(_, symbol)| *symbol)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn characters(pieces: &[Piece]) -> String {
        pieces
            .iter()
            .map(|piece| match piece {
                Piece::Character(c) => c.to_string(),
                Piece::Space(_) => " ".to_owned(),
                Piece::Scripts { lower, upper } => format!("_{}^{}", characters(lower), characters(upper)),
            })
            .collect()
    }

    #[test]
    fn symbols_are_italic_and_units_upright() {
        assert_eq!(characters(&parse("$v$ (m/s)")), "\u{1D463} (m/s)");
        assert_eq!(characters(&parse("$\\psi_0$ (rad)")), "\u{1D713}_0^ (rad)");
    }

    #[test]
    fn scripts_take_groups_and_stand_above_each_other() {
        assert_eq!(characters(&parse("$x_{\\mathrm{max}}^2$")), "\u{1D465}_max^2");
    }

    #[test]
    fn a_minus_is_a_sign_or_an_operator() {
        assert_eq!(characters(&parse("$-1$")), "−1");
        assert_eq!(characters(&parse("$2-1$")), "2 − 1");
        assert_eq!(characters(&parse("$r=-1$")), "\u{1D45F} = −1");
    }

    #[test]
    fn what_is_not_understood_is_shown() {
        assert_eq!(characters(&parse("$\\frobnicate$ costs 5 \\$ or $ 6")), "\\frobnicate costs 5 $ or $ 6");
    }

    proptest! {
        #[test]
        fn any_text_parses(source in "[ -~$\\\\_^{}]{0,40}") {
            parse(&source);
        }
    }
}
