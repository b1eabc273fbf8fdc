//! A model as AUTO's equations file.

use arclength_ode::Model;
use std::fmt::Write as _;

/// The model with some parameters active, as AUTO's equations file. The files compared use little of the language of .ode files.
pub(crate) fn fortran(
    model: &Model,
    source: &str,
    equilibrium: &[f64],
    parameters: &[f64],
    active: &[usize],
) -> String {
    let statements: Vec<String> = source
        .lines()
        .map(|line| line.replace('^', "**").replace("ln(", "log("))
        .filter(|line| line.contains('=') && !line.starts_with(['#', '@']))
        .filter(|line| !["par ", "init", "set ", "aux ", "number "].iter().any(|word| line.starts_with(word)))
        .filter(|line| !line.contains("(0)"))
        .collect();
    let mut functions = String::new();
    let mut body = String::new();
    let mut names: Vec<String> = model.parameters().to_vec();
    for line in &statements {
        let (left, right) = line.split_once('=').unwrap_or_default();
        let (left, right) = (left.trim().trim_start_matches('!'), right.trim());
        if let Some(state) = left.strip_suffix('\'') {
            let index = model.state_index(state).unwrap_or_default() + 1;
            let _ = writeln!(body, "  auto_f({index}) = {right}");
        } else if let Some((name, arguments)) = left.split_once('(') {
            names.push(name.to_owned());
            let _ = writeln!(functions, "  {name}({arguments} = {right}");
        } else {
            names.push(left.to_owned());
            let _ = writeln!(body, "  {left} = {right}");
        }
    }
    for line in source.lines().filter_map(|line| line.strip_prefix("number ")) {
        let (name, value) = line.split_once('=').unwrap_or_default();
        names.push(name.trim().to_owned());
        body.insert_str(0, &format!("  {} = {}\n", name.trim(), value.trim()));
    }
    let mut values = String::new();
    for (index, (name, value)) in model.parameters().iter().zip(parameters).enumerate() {
        if let Some(place) = active.iter().position(|active| *active == index) {
            let _ = writeln!(values, "  {name} = auto_par({})", place + 1);
        } else {
            let _ = writeln!(values, "  {name} = {value:e}");
        }
    }
    let mut initial = String::new();
    for (index, name) in model.states().iter().enumerate() {
        let _ = writeln!(values, "  {name} = auto_u({})", index + 1);
        let _ = writeln!(initial, "  auto_u({}) = {:e}", index + 1, equilibrium[index]);
        names.push(name.clone());
    }
    for (place, &index) in active.iter().enumerate() {
        let _ = writeln!(initial, "  auto_par({}) = {:e}", place + 1, parameters[index]);
    }
    names.sort();
    names.dedup();
    format!(
        "subroutine func(auto_n, auto_u, auto_icp, auto_par, auto_jac, auto_f, auto_fu, auto_fp)\n\
         \x20 implicit none\n  integer :: auto_n, auto_icp(*), auto_jac\n\
         \x20 real :: auto_u(auto_n), auto_par(*), auto_f(auto_n), auto_fu(auto_n, auto_n), auto_fp(auto_n, *)\n\
         \x20 real :: {}\n{functions}{values}{body}end subroutine\n\
         subroutine stpnt(auto_n, auto_u, auto_par, auto_t)\n  implicit none\n  integer :: auto_n\n\
         \x20 real :: auto_u(auto_n), auto_par(*), auto_t\n{initial}end subroutine\n\
         subroutine bcnd\nend subroutine\nsubroutine icnd\nend subroutine\nsubroutine fopt\nend subroutine\n\
         subroutine pvls\nend subroutine\n",
        names.join(", ")
    )
}
