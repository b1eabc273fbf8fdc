//! A page of the gallery: the model, its diagrams, and the table of what is published and what is computed.

use crate::gallery;
use kingpin_figure::Figure;
use kingpin_report::numbers::significant;
use std::fmt::Write;

/// Where a reference value comes from.
pub(crate) enum Source {
    /// A publication or another program.
    Published(&'static str),
    /// A formula, or another method than continuation.
    ClosedForm(&'static str),
    /// Nothing: the value was computed by this program alone, and stays what it is.
    OwnValue,
}

/// How close the computed value must be.
#[derive(Clone, Copy)]
pub(crate) enum Tolerance {
    /// Relative to the reference.
    Relative(f64),
    /// For references that are zero.
    Absolute(f64),
}

/// As exact as special equilibria are located.
pub(crate) const LOCATED: Tolerance = Tolerance::Relative(1e-10);
/// As exact as the digits of values that were printed with twelve of them, or periods of cycles by default.
pub(crate) const CYCLE: Tolerance = Tolerance::Relative(1e-9);
/// As exact as coefficients of normal forms are.
pub(crate) const COEFFICIENT: Tolerance = Tolerance::Relative(1e-8);

struct Row {
    quantity: String,
    reference: f64,
    source: Source,
    tolerance: Tolerance,
    computed: f64,
}

/// A page that is being written.
pub(crate) struct Page {
    name: &'static str,
    title: &'static str,
    text: &'static str,
    commands: Vec<&'static str>,
    rows: Vec<Row>,
    figures: Vec<(String, &'static str, Figure)>,
}

impl Page {
    /// The page of a model.
    pub(crate) fn new(name: &'static str, title: &'static str, text: &'static str) -> Self {
        Self { name, title, text, commands: Vec::new(), rows: Vec::new(), figures: Vec::new() }
    }

    /// A command that shows what the page is about.
    pub(crate) fn command(&mut self, command: &'static str) {
        self.commands.push(command);
    }

    /// A diagram.
    pub(crate) fn figure(&mut self, suffix: &str, caption: &'static str, figure: Figure) {
        self.figures.push((format!("{}{suffix}", self.name), caption, figure));
    }

    /// Compares a computed value with its reference.
    #[track_caller]
    pub(crate) fn row(
        &mut self,
        quantity: impl Into<String>,
        reference: f64,
        source: Source,
        tolerance: Tolerance,
        computed: f64,
    ) {
        let quantity = quantity.into();
        let (error, allowed) = match tolerance {
            Tolerance::Relative(allowed) => ((computed - reference).abs() / reference.abs(), allowed),
            Tolerance::Absolute(allowed) => ((computed - reference).abs(), allowed),
        };
        assert!(error <= allowed, "{}: {quantity} = {computed}, not {reference}: {error:e}", self.name);
        self.rows.push(Row { quantity, reference, source, tolerance, computed });
    }

    fn markdown(&self) -> String {
        let mut text = format!("# {}\n\n{}\n\n", self.title, self.text);
        for (name, caption, _) in &self.figures {
            write!(text, "![{caption}](figures/{name}.svg)\n\n").unwrap();
        }
        text += "| quantity | reference | source | computed | agree within |\n| --- | ---: | --- | ---: | ---: |\n";
        for row in &self.rows {
            let source = match row.source {
                Source::Published(source) => source.to_owned(),
                Source::ClosedForm(formula) => format!("closed form: {formula}"),
                Source::OwnValue => "this program, no other source".to_owned(),
            };
            // As many digits as are compared.
            let (computed, tolerance) = match row.tolerance {
                Tolerance::Relative(allowed) => {
                    let digits = (-allowed.log10()).ceil() as usize;
                    (significant(row.computed, digits), format!("{allowed:e}"))
                }
                Tolerance::Absolute(allowed) => ("0".to_owned(), format!("{allowed:e} (absolute)")),
            };
            let reference = significant(row.reference, 13);
            writeln!(text, "| {} | {reference} | {source} | {computed} | {tolerance} |", row.quantity)
                .unwrap();
        }
        if !self.commands.is_empty() {
            write!(text, "\n```sh\n{}\n```\n", self.commands.join("\n")).unwrap();
        }
        let path = gallery().join(format!("models/{}.ode", self.name));
        let model = std::fs::read_to_string(path).unwrap();
        write!(text, "\n[{0}.ode](models/{0}.ode):\n\n```text\n{1}```\n", self.name, model).unwrap();
        text
    }

    /// Compares the page with the one in the gallery, or writes it.
    pub(crate) fn finish(self) {
        let path = gallery().join(format!("{}.md", self.name));
        let text = self.markdown();
        if std::env::var_os("UPDATE_GALLERY").is_some() {
            std::fs::write(&path, &text).unwrap();
            std::fs::create_dir_all(gallery().join("figures")).unwrap();
            for (name, _, figure) in &self.figures {
                figure.save(gallery().join(format!("figures/{name}.svg"))).unwrap();
            }
            return;
        }
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(
            committed,
            text,
            "{} is not what is computed; UPDATE_GALLERY=1 writes it again",
            path.display()
        );
        for (name, _, _) in &self.figures {
            assert!(gallery().join(format!("figures/{name}.svg")).exists(), "{name}.svg");
        }
    }
}
