//! The names that an expression may use: those of a model, or any given ones.
//!
//! The language of models does not tell capital letters from small ones. Given names may differ by these only, as the towing speed
//! `v` and the wheel's speed `V` do: such a name has another one in the language, and a name in other letters than its own is refused.

use crate::calls::{Named, replace_names};
use arclength_ode::{Model, OdeError, Quantity};
use std::borrow::Cow;

/// The names that an expression may use, with the language in which it is written.
///
/// ```
/// use arclength_analysis::Vocabulary;
/// let vocabulary = Vocabulary::named(&["psi", "V"], &["v"], &["friction_force"])?;
/// assert_eq!(vocabulary.names().collect::<Vec<_>>(), ["psi", "V", "v", "friction_force"]);
/// # Ok::<(), arclength_ode::OdeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Vocabulary<'a> {
    model: Cow<'a, Model>,
    /// Names with those that they have in the language; none for the names of a model.
    given: Vec<(String, String)>,
    /// Quantities, by their names in the language, whose values are given with every evaluation.
    further: Vec<String>,
}

impl<'a> Vocabulary<'a> {
    /// The names of a model.
    pub fn of(model: &'a Model) -> Self {
        Self { model: Cow::Borrowed(model), given: Vec::new(), further: Vec::new() }
    }
}

impl Vocabulary<'static> {
    /// Names of states, of parameters and of further quantities of a motion.
    ///
    /// # Errors
    /// A name that is no identifier of the language.
    pub fn named(states: &[&str], parameters: &[&str], further: &[&str]) -> Result<Self, OdeError> {
        let mut given: Vec<(String, String)> = Vec::new();
        for name in [states, parameters, further].concat() {
            let mut in_language = name.to_owned();
            while given.iter().any(|(_, other)| other.eq_ignore_ascii_case(&in_language)) {
                in_language.push('_');
            }
            given.push((name.to_owned(), in_language));
        }
        let in_language = |index: usize| &given[index].1;
        let mut text = String::new();
        for index in 0..states.len() {
            text += &format!("{}'=0\n", in_language(index));
        }
        for index in 0..parameters.len() {
            text += &format!("par {}=0\n", in_language(states.len() + index));
        }
        let model = Cow::Owned(Model::parse(&format!("{text}done\n"))?);
        let further = given[states.len() + parameters.len()..].iter().map(|(_, name)| name.clone()).collect();
        Ok(Self { model, given, further })
    }
}

impl Vocabulary<'_> {
    /// The names as users write them: states, parameters, further quantities.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let of_model = self.model.states().iter().chain(self.model.parameters()).map(String::as_str);
        let count = if self.given.is_empty() { usize::MAX } else { 0 };
        of_model.take(count).chain(self.given.iter().map(|(name, _)| name.as_str()))
    }

    /// An expression in the words of the language.
    ///
    /// # Errors
    /// A name that is one of the given ones but for capital letters, in words.
    pub(crate) fn translate(&self, expression: &str) -> Result<String, String> {
        let mut wrong = None;
        let translated = replace_names(expression, |name| {
            if let Some((_, in_language)) = self.given.iter().find(|(given, _)| given == name) {
                return Named::Replaced(in_language.clone());
            }
            let alike = self.given.iter().filter(|(given, _)| given.eq_ignore_ascii_case(name));
            let alike: Vec<&str> = alike.map(|(given, _)| given.as_str()).collect();
            if !alike.is_empty() {
                let meant = alike.join(" or ");
                wrong.get_or_insert(format!(
                    "there is no {name}: capital letters count; perhaps {meant} is meant"
                ));
            }
            Named::Kept
        });
        match wrong {
            Some(problem) => Err(problem),
            None => Ok(translated),
        }
    }

    /// The quantity that an expression in the words of the language is, with the values of further quantities and then those of `others`
    /// given at every evaluation.
    pub(crate) fn quantity(&self, expression: &str, others: &[&str]) -> Result<Quantity, OdeError> {
        let further = self.further.iter().map(String::as_str);
        self.model.quantity(expression, &further.chain(others.iter().copied()).collect::<Vec<_>>())
    }

    /// Names in the language of what varies along a cycle, with those that users write.
    pub(crate) fn varying(&self) -> impl Iterator<Item = (&str, &str)> {
        let written = |name: &'_ str| {
            let given = self.given.iter().find(|(_, other)| other == name);
            given.map(|(written, _)| written.as_str())
        };
        let varying = self.model.states().iter().chain(&self.further);
        varying.map(move |name| (name.as_str(), written(name).unwrap_or(name)))
    }

    /// Names in the language of all that is no constant.
    pub(crate) fn variables(&self) -> impl Iterator<Item = &str> {
        let names = self.model.states().iter().chain(self.model.parameters()).chain(&self.further);
        names.map(String::as_str)
    }

    /// Numbers of states, of parameters and of further quantities.
    pub(crate) fn sizes(&self) -> [usize; 3] {
        [self.model.states().len(), self.model.parameters().len(), self.further.len()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_differ_by_capital_letters_are_told_apart() {
        let vocabulary = Vocabulary::named(&["V"], &["v", "k"], &["f"]).unwrap();
        let translated = vocabulary.translate("V - 2*v + k + f").unwrap();
        let quantity = vocabulary.quantity(&translated, &[]).unwrap();
        assert_eq!(quantity.value(&[5.0], &[1.0, 10.0], &[100.0]), 113.0);
        let refused = vocabulary.translate("K").unwrap_err();
        assert_eq!(refused, "there is no K: capital letters count; perhaps k is meant");
        assert!(vocabulary.translate("max(V)").is_ok());
    }

    #[test]
    fn a_models_own_names_are_read_as_the_model_reads_them() {
        let model = Model::parse("par a=1\nx'=-a*x\ndone\n").unwrap();
        let vocabulary = Vocabulary::of(&model);
        assert_eq!(vocabulary.names().collect::<Vec<_>>(), ["x", "a"]);
        assert_eq!(vocabulary.translate("A*X").unwrap(), "A*X");
    }
}
