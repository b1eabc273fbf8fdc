//! `RUSTC_BOOTSTRAP=1 cargo fuzz run parse ../../gallery/models`: reads any bytes as a model and
//! evaluates what is accepted.
#![no_main]

use arclength::VectorField;
use arclength_ode::Model;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    match Model::parse_bytes(bytes) {
        Ok(model) => {
            let parameters = model.default_parameters();
            let mut derivative = vec![0.0; model.dimension()];
            model.evaluate(&model.initial_state(parameters), parameters, &mut derivative);
        }
        Err(error) => drop(error.snippet()),
    }
});
