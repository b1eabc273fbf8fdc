//! Events of models (`global`): how they are read, and to which states they lead.

use arclength::{Direction, Dual, VectorField};
use arclength_ode::{Event, Model, Outcome};

fn model(text: &str) -> Model {
    Model::parse(text).unwrap_or_else(|error| panic!("{}", error.snippet()))
}

fn after(event: &Event, time: f64, state: &[f64], parameters: &[f64]) -> (Vec<f64>, Outcome) {
    let mut next = state.to_vec();
    let outcome = event.apply(time, &mut next, parameters);
    (next, outcome)
}

#[test]
fn events_are_read_as_xppaut_writes_them() {
    use Direction::{Either, Falling, Rising};
    for (line, direction, condition) in [
        ("global 1 x-a {x=0}", Rising, 0.0),
        ("global 1 {x-a} {x=0}", Rising, 0.0),
        ("glo +1{x-a}{x=0;}", Rising, 0.0),
        ("GLOBAL -1 {2*x} { X = 0 ; ; }", Falling, 4.0),
        ("g 0 t-1 {x=0}", Either, 6.0),
        ("global 0 x - \\\n 1 {x=0}", Either, 1.0),
    ] {
        let model = model(&format!("par a=2\nx'=1\ny'=0\n{line}\ndone\n"));
        let [event] = model.global_events() else { panic!("{line}") };
        assert_eq!(event.direction(), direction, "{line}");
        assert_eq!(event.condition(7.0, &[2.0, 3.0], &[2.0]), condition, "{line}");
        assert_eq!(after(event, 0.0, &[2.0, 3.0], &[2.0]).0, [0.0, 3.0], "{line}");
        assert_eq!(event.place().line, 4, "{line}");
    }
}

#[test]
fn assignments_follow_each_other() {
    // As XPPAUT has it: y gets the x that was just set.
    let swapped = model("x'=1\ny'=1\nk=2*x\nglobal 1 x {x=y;y=x;out_put=y-1;arret=k-100}\n");
    let event = &swapped.global_events()[0];
    assert_eq!(
        after(event, 0.0, &[5.0, 3.0], &[]),
        (vec![3.0, 3.0], Outcome { stops: false, is_put_out: true })
    );
    assert_eq!(
        after(event, 0.0, &[5.0, 70.0], &[]),
        (vec![70.0, 70.0], Outcome { stops: true, is_put_out: true })
    );
    assert_eq!(after(event, 0.0, &[5.0, 0.5], &[]).1, Outcome::default());
    assert!(!event.uses_time());
    assert!(model("x'=1\nglobal 1 x {x=t}\n").global_events()[0].uses_time());
}

#[test]
fn arrays_have_events_and_words_without_meaning_a_warning() {
    let cells =
        model("par vt=1\nv[0..2]'=1\nglobal 1 v[0..2]-vt {v[j]=-[j]}\nglobal 1 v0-2 {v0=0;no_interp=1}\n");
    let states: Vec<_> =
        cells.global_events().iter().map(|event| after(event, 0.0, &[5.0; 3], &[1.0]).0).collect();
    assert_eq!(states, [[0.0, 5.0, 5.0], [5.0, -1.0, 5.0], [5.0, 5.0, -2.0], [0.0, 5.0, 5.0]]);
    let [warning] = cells.warnings() else { panic!("{:?}", cells.warnings()) };
    assert!(warning.message.contains("no_interp"), "{warning}");
}

#[test]
fn the_field_has_the_events_with_their_derivatives() {
    let ball = model("par e=.5\nx'=v\nv'=-1\nglobal -1 x^2-1 {v=-e*v^2}\n");
    assert_eq!(VectorField::events(&ball), [Direction::Falling]);
    let state = [Dual::<f64, 2>::variable(3.0, 0), Dual::variable(4.0, 1)];
    let mut values = [Dual::from(0.0); 3];
    ball.evaluate_event(0, &state, &[Dual::from(0.5)], &mut values);
    let numbers = values.map(|value| (value.value, value.derivatives));
    assert_eq!(numbers, [(8.0, [6.0, 0.0]), (3.0, [1.0, 0.0]), (-8.0, [0.0, -4.0])]);
    let mut condition = [0.0];
    ball.evaluate_event(0, &[2.0, 0.0], &[0.5], &mut condition);
    assert_eq!(condition, [3.0]);
    assert!(VectorField::events(&model("x'=1\n")).is_empty());
}

#[test]
fn conditions_on_the_time_are_switches() {
    let kicked = model("x'=-x\nglobal 1 {sin(pi*t)} {x=x+1}\nglobal 1 {t-2.5} {x=0}\n");
    let mut from = 0.1;
    for right in [1.0, 2.0, 2.5, 3.0] {
        let switch = kicked.next_switch(from, 10.0, &[]).unwrap().unwrap();
        assert!((switch.before - right).abs() < 1e-13 && (switch.after - right).abs() < 1e-13, "{switch:?}");
        from = switch.after;
    }
}
