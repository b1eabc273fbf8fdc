//! Reads models and says what is wrong with them: `cargo run --example check -- a.ode b.ode`.
//!
//! For each model that can be read, prints its size, its warnings, and with `--values` the field at
//! the initial state.

use arclength::VectorField;
use arclength_ode::Model;
use std::process::ExitCode;

fn main() -> ExitCode {
    let (flags, files): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.starts_with("--"));
    let values = flags.iter().any(|flag| flag == "--values");
    let mut refused = 0;
    for file in &files {
        let bytes = match std::fs::read(file) {
            Ok(bytes) => bytes,
            Err(error) => {
                eprintln!("{file}: {error}");
                return ExitCode::from(2);
            }
        };
        match Model::parse_bytes(&bytes) {
            Ok(model) => report(file, &model, values),
            Err(error) => {
                refused += 1;
                println!("{file}: refused\n{}\n", error.snippet());
            }
        }
    }
    println!("{} read, {refused} refused", files.len() - refused);
    ExitCode::from(u8::from(refused > 0))
}

fn report(file: &str, model: &Model, values: bool) {
    println!(
        "{file}: {} states, {} parameters, {} instructions, {} registers{}",
        model.states().len(),
        model.parameters().len(),
        model.instruction_count(),
        model.register_count(),
        if model.is_autonomous() { "" } else { ", depends on time" }
    );
    for warning in model.warnings() {
        println!("  {warning}");
    }
    if values {
        let state = model.initial_state(model.default_parameters());
        let mut derivative = vec![0.0; state.len()];
        model.evaluate(&state, model.default_parameters(), &mut derivative);
        println!("  state {state:?}\n  field {derivative:?}");
    }
}
