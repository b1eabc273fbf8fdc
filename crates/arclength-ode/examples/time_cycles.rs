use arclength::cycle::{CycleStart, Cycles, Resolution};
use arclength::equilibrium::Equilibria;
use arclength_ode::Model;
use std::time::Instant;
fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let tolerance: f64 = arguments[2].parse().unwrap();
    let degree: usize = arguments[3].parse().unwrap();
    let fewest: usize = arguments[4].parse().unwrap();
    let runs: usize = arguments[5].parse().unwrap();
    let (name, set, start, eq, cyc, along): (
        &str,
        &[(&str, f64)],
        Option<&[f64]>,
        (f64, f64),
        (f64, f64),
        &str,
    ) = match arguments[1].as_str() {
        "wheel" => ("towed_wheel", &[("l", 0.08), ("v", 9.0)], None, (8.0, 9.0), (0.2, 9.0), "v"),
        "langford" => {
            ("langford", &[("lambda", 1.5)], Some(&[0.0, 0.0, 1.5]), (1.0, 2.2), (1.0, 2.2), "lambda")
        }
        "brusselator" => ("brusselator", &[], None, (1.0, 3.0), (1.5, 5.0), "b"),
        "lorenz" => ("lorenz", &[("rho", 20.0)], Some(&[7.0, 7.0, 19.0]), (15.0, 30.0), (14.5, 26.0), "rho"),
        "fhn" => ("fitzhugh_nagumo", &[], None, (0.0, 1.0), (0.0, 1.2), "i0"),
        "lure" => ("lure", &[], None, (0.5, 2.0), (-0.9, 1.1), "alpha"),
        "ab" => ("ab", &[], None, (0.0, 0.4), (0.1, 0.4), "D"),
        "pp2" => ("pp2", &[("p1", 0.65)], Some(&[0.33, 0.42]), (0.65, 0.8), (0.6, 0.71), "p1"),
        _ => panic!(),
    };
    let path = format!("{}/../../gallery/models/{name}.ode", env!("CARGO_MANIFEST_DIR"));
    let model = Model::parse(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let mut p = model.default_parameters().to_vec();
    for (k, v) in set {
        p[model.parameter_index(k).unwrap()] = *v;
    }
    let active = model.parameter_index(along).unwrap();
    if !(eq.0..=eq.1).contains(&p[active]) {
        p[active] = eq.0;
    }
    let branch = Equilibria::of(&model)
        .start(&start.map_or_else(|| model.initial_state(&p), <[f64]>::to_vec))
        .parameters(&p)
        .along(along, eq.0..=eq.1)
        .run()
        .unwrap();
    let hopf = branch.hopf_points().next().unwrap().clone();
    p[active] = hopf.parameter;
    let mut best = f64::MAX;
    let mut found = None;
    for _ in 0..runs {
        let t = Instant::now();
        let branch = Cycles::of(&model, CycleStart::from(&hopf))
            .parameters(&p)
            .along(active, cyc.0..=cyc.1)
            .resolution(if degree == 0 {
                Resolution::with_tolerance(tolerance)
            } else {
                Resolution { tolerance, degree, fewest_intervals: fewest, ..Resolution::default() }
            })
            .run()
            .unwrap();
        best = best.min(t.elapsed().as_secs_f64());
        found = Some(branch);
    }
    let branch = found.unwrap();
    for p in &branch.points {
        eprintln!(
            "{:.10} T {:.4} trivial {:.1e} err {:.1e} mult {:?}",
            p.value, p.period, p.trivial_multiplier_error, p.error_estimate, p.multipliers
        );
    }
    let intervals: Vec<usize> = branch.points.iter().map(|point| point.orbit.mesh.len() - 1).collect();
    println!("special {:?}", branch.points.iter().filter_map(|p| (!matches!(p.role, arclength::cycle::Role::Step)).then(|| format!("{:?}", p.role))).collect::<Vec<_>>());
    println!(
        "{name} {:.2} ms, {} points, {:.1} us/point, intervals {:?}, stops {:?}",
        1e3 * best,
        branch.points.len(),
        1e6 * best / branch.points.len() as f64,
        intervals,
        branch.stops
    );
}
