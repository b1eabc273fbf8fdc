//! Options that say which wheel, and the help on its parameters.

use arclength_analysis::Assignment;
use clap::Args;
use kingpin::{Key, Tyre};
use kingpin_analysis::WheelRequest;
use kingpin_report::Table;
use kingpin_report::numbers::readable;
use std::path::PathBuf;
use std::sync::LazyLock;

/// Which wheel.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Wheel")]
pub(crate) struct WheelOptions {
    /// Read the wheel from a file of `key = value` lines [default: the paper's wheel]
    #[arg(long, value_name = "FILE.toml")]
    pub wheel: Option<PathBuf>,

    /// Set a parameter, wins over the file; repeatable, for example -s l=0.1 -s r=inf
    #[arg(short, long, value_name = "KEY=VALUE")]
    pub set: Vec<Assignment>,
}

impl WheelOptions {
    /// The wheel that is asked for.
    pub(crate) fn request(&self) -> WheelRequest {
        WheelRequest { wheel: self.wheel.clone(), set: self.set.clone() }
    }
}

/// An example and the parameters of the wheel, for the long help.
pub(crate) fn parameter_help(example: &str) -> String {
    // Every command has this text, and all of them are made whichever one runs.
    static TABLE: LazyLock<String> = LazyLock::new(parameter_table);
    format!("Example: {example}\n\nParameters, in SI units and radians:\n{}", *TABLE)
}

/// The parameters of the wheel with symbol, unit, default, allowed range and meaning.
fn parameter_table() -> String {
    let mut table = Table::new(["key", "symbol", "unit", "default", "allowed", "meaning"]);
    for key in Key::ALL {
        table.row([
            key.name().into(),
            key.symbol().into(),
            key.unit().into(),
            if has_default(key) { readable(key.default_value()) } else { "none".to_owned() }.into(),
            key.allowed().to_string().into(),
            key.meaning().into(),
        ]);
    }
    table.row([
        Tyre::KEY.into(),
        "".into(),
        "".into(),
        Tyre::default().name().into(),
        Tyre::ALL.map(Tyre::name).join(", ").into(),
        "law of the tyre: none, linear, or limited by friction".into(),
    ]);
    let mut text = Vec::new();
    // Writing to memory does not fail.
    let _ = table.write(&mut text);
    String::from_utf8_lossy(&text).into_owned()
}

/// Whether a key need not be set, with a tyre either.
fn has_default(key: Key) -> bool {
    key.allowed().contains(key.default_value())
}
