//! Several results in one bifurcation diagram, or in one plane of two parameters.

use crate::picture::{self, Curve, OwnColor};
use crate::result_file::ResultFile;
use kingpin_figure::Figure;

/// Everything in one diagram; the error says which file does not fit to the first one.
///
/// # Errors
/// A time history, or files over different parameters.
pub fn diagram(results: &[ResultFile]) -> Result<Figure, (usize, String)> {
    diagram_of(results, &[], &[])
}

/// The same of some states only, of all where none is named, and with colours of their own for results, in their order.
///
/// # Errors
/// Those of [`diagram`], and where the first file has none of these states.
pub fn diagram_of(
    results: &[ResultFile],
    shown: &[String],
    colors: &[Option<OwnColor>],
) -> Result<Figure, (usize, String)> {
    let own = |index: usize| colors.get(index).and_then(Option::as_ref);
    let axes = |result: &ResultFile| -> Option<Vec<String>> {
        match result {
            ResultFile::Equilibria(result) => Some(vec![result.along.key.clone()]),
            ResultFile::Cycles(result) => Some(vec![result.along.key.clone()]),
            ResultFile::Locus(result) => Some(result.curve.keys().map(str::to_owned).to_vec()),
            ResultFile::CycleLocus(result) => Some(result.curve.keys().map(str::to_owned).to_vec()),
            ResultFile::History(_) => None,
        }
    };
    let first = results.first().and_then(axes).unwrap_or_default();
    let (mut states, mut name): (Vec<String>, String) = (Vec::new(), String::new());
    for (index, result) in results.iter().enumerate() {
        match axes(result) {
            Some(own) if own == first => {}
            Some(own) => {
                let problem = format!("it is over {}, not over {}", own.join(" and "), first.join(" and "));
                return Err((
                    index,
                    format!("{problem} as the first file; allowed: files over the same parameters"),
                ));
            }
            None => {
                let problem =
                    "a time history has no place in a bifurcation diagram; allowed: `simulate -o x.svg`";
                return Err((index, problem.to_owned()));
            }
        }
        let (own, model) = match result {
            ResultFile::Equilibria(result) => (result.states(), &result.model),
            ResultFile::Cycles(result) => (result.states(), &result.model),
            ResultFile::Locus(result) => (Vec::new(), &result.model),
            ResultFile::CycleLocus(result) => (Vec::new(), &result.model),
            ResultFile::History(_) => continue,
        };
        if index == 0 {
            states = own.into_iter().map(str::to_owned).collect();
            name.clone_from(&model.name);
        }
    }
    if let [one, two] = &first[..] {
        let curves: Vec<Curve> = results
            .iter()
            .enumerate()
            .filter_map(|(index, result)| match result {
                ResultFile::Locus(result) => Some(result.curve.drawn().in_color(own(index))),
                ResultFile::CycleLocus(result) => Some(result.curve.drawn().in_color(own(index))),
                _ => None,
            })
            .collect();
        return Ok(picture::plane(&format!("Special points of {name}"), [one, two], &curves));
    }
    if !shown.is_empty() {
        let all = states.join(", ");
        states.retain(|state| shown.contains(state));
        if states.is_empty() {
            let problem = format!("it has no state {}; allowed: {all}", shown.join(", "));
            return Err((0, problem));
        }
    }
    let panels = states.iter().map(|state| {
        let curves = results.iter().enumerate().flat_map(|(index, result)| {
            let curves = match result {
                ResultFile::Equilibria(result) => result.curves(state),
                ResultFile::Cycles(result) => result.curves(state),
                _ => Vec::new(),
            };
            curves.into_iter().map(move |curve| curve.in_color(own(index)))
        });
        (state.clone(), curves.collect::<Vec<Curve>>())
    });
    let key = first.first().map_or("", String::as_str);
    Ok(picture::bifurcation_diagram(&format!("Bifurcation diagram of {name}"), key, panels))
}
