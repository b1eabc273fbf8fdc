//! Branches of equilibria against closed forms and published values.

use approx::assert_relative_eq;
use arclength::branch::Criticality;
use arclength::continuation::Stop;
use arclength::equilibrium::{Crossing, Equilibria, EquilibriumBranch, SpecialPoint};
use arclength::{Scalar, VectorField};

field!(Lure, ["x", "y", "z"], ["alpha", "beta"], |x, p, d| {
    d[0] = x[1];
    d[1] = x[2];
    d[2] = -p[0] * x[2] - p[1] * x[1] - x[0] + x[0] * x[0];
});

field!(Brusselator, ["x", "y"], ["b", "a"], |x, p, d| {
    let square = x[0] * x[0] * x[1];
    d[0] = p[1] - (p[0] + 1.0) * x[0] + square;
    d[1] = p[0] * x[0] - square;
});

field!(Reaction, ["u1", "u2"], ["D", "B", "beta"], |x, p, d| {
    let rate = p[0] * (-x[0] + 1.0) * x[1].exp();
    d[0] = rate - x[0];
    d[1] = rate * p[1] - x[1] - p[2] * x[1];
});

field!(Predator, ["u1", "u2"], ["p1", "p2", "p3", "p4"], |x, p, d| {
    let harvest = p[0] * (-(-p[2] * x[0]).exp() + 1.0);
    d[0] = p[1] * x[0] * (-x[0] + 1.0) - x[0] * x[1] - harvest;
    d[1] = p[3] * x[0] * x[1] - x[1];
});

field!(Lorenz, ["x", "y", "z"], ["rho", "sigma", "beta"], |x, p, d| {
    d[0] = p[1] * (x[1] - x[0]);
    d[1] = p[0] * x[0] - x[1] - x[0] * x[2];
    d[2] = x[0] * x[1] - p[2] * x[2];
});

/// The towed wheel as a Chaplygin sleigh on springs.
struct Wheel;

impl VectorField for Wheel {
    fn state_names(&self) -> Vec<String> {
        ["u", "q", "psi", "V", "Omega"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        ["v", "l", "r"].map(String::from).to_vec()
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let (m_w, m_c, spin, vertical, caster) = (0.3519, 0.0668, 4.63e-5, 2.38e-5, 3.48e-6);
        let (radius, centre, stiffness) = (0.04, 0.012, 100.0);
        let (v, l, omega) = (p[0], p[1], p[0] / p[2]);
        let [u, q, psi, speed, rate] = [x[0], x[1], x[2], x[3], x[4]];
        let arm = l - centre;
        let mass = m_w + m_c + spin / (radius * radius);
        let inertia = arm * arm * m_c + (caster + vertical);
        let moment = arm * m_c;
        let (sine, cosine) = psi.sin_cos();
        let forward = (u * cosine - q * sine) * -stiffness;
        let sideways = (u * sine + q * cosine) * -stiffness;
        d[0] = speed * cosine + l * rate * sine - v + omega * q;
        d[1] = l * rate * cosine - speed * sine - omega * u;
        d[2] = omega - rate;
        d[3] = (moment * rate * rate + forward) / mass;
        d[4] = (l * sideways - moment * speed * rate) / inertia;
    }
}

fn kinds(branch: &EquilibriumBranch) -> Vec<String> {
    branch.points.iter().filter_map(|point| Some(point.label?.to_string())).collect()
}

#[test]
fn the_wheel_has_its_hopf_point_at_the_critical_speed() {
    let branch = Equilibria::of(&Wheel)
        .start(&[0.0, 0.0, 0.08, 1.0, 1.0])
        .parameters(&[1.0, 0.08, 1.0])
        .along("v", 0.1..=12.0)
        .run()
        .unwrap();
    assert_eq!(kinds(&branch), ["HB1"]);
    let hopf = branch.hopf_points().next().unwrap();
    assert_relative_eq!(hopf.value, 8.43103697014, max_relative = 1e-11);
    // From the closed form of the characteristic polynomial.
    assert_relative_eq!(hopf.frequency, 43.255_392_119_586_26, max_relative = 1e-12);
    assert_relative_eq!(hopf.first_lyapunov.unwrap(), 6.520929e-5, max_relative = 1e-7);
    assert_relative_eq!(hopf.c1_real.unwrap(), 6.520929e-5 * 43.2553921186, max_relative = 1e-7);
    assert_eq!(hopf.criticality, Criticality::Subcritical);
    assert!(hopf.crossing_speed.unwrap() > 0.0);
    assert!(hopf.location_error < 1e-11, "{:e}", hopf.location_error);
    assert!(hopf.state[0].abs() < 1e-14);
    for point in &branch.points {
        let expected = match point.value.total_cmp(&hopf.value) {
            std::cmp::Ordering::Less => Some(0),
            std::cmp::Ordering::Greater => Some(2),
            std::cmp::Ordering::Equal => continue,
        };
        assert_eq!(point.stability.unstable_dimension(), expected, "at {}", point.value);
    }
    assert!(matches!(branch.stops[0], Some(Stop::RangeEnd { value: 0.1, .. })));
    assert!(matches!(branch.stops[1], Some(Stop::RangeEnd { value: 12.0, .. })));
    assert_eq!(branch.points[0].value, 0.1);
    assert_eq!(branch.points[branch.start].value, 1.0);
}

#[test]
fn lure_has_a_hopf_point_and_a_neutral_saddle() {
    let branch = Equilibria::of(&Lure)
        .parameters(&[2.0, 1.0])
        .along("alpha", -1.0..=3.0)
        .at(&[0.25, 2.5])
        .run()
        .unwrap();
    let hopf: Vec<_> = branch.hopf_points().collect();
    assert_eq!(hopf.len(), 1);
    assert_relative_eq!(hopf[0].value, 1.0, max_relative = 1e-14);
    assert_relative_eq!(hopf[0].frequency, 1.0, max_relative = 1e-14);
    assert_relative_eq!(hopf[0].first_lyapunov.unwrap(), -0.3, max_relative = 1e-13);
    assert_eq!(hopf[0].criticality, Criticality::Supercritical);
    assert_eq!(kinds(&branch), ["AT1", "HB1", "AT2"]);
    assert_eq!(branch.labelled("AT2".parse().unwrap()).unwrap().value, 2.5);
    // The other equilibrium, x = 1, has the characteristic polynomial s^3 + alpha s^2 + beta s - 1: eigenvalues
    // +-i and 1 at alpha = -1, beta = 1, but +-sqrt(2) and -1/2 at alpha = 1/2, beta = -2.
    let run = |beta: f64| {
        let start = Equilibria::of(&Lure).start(&[1.0, 0.0, 0.0]).parameters(&[2.0, beta]);
        start.along("alpha", -3.0..=3.0).run().unwrap()
    };
    assert_eq!(kinds(&run(1.0)), ["HB1"]);
    assert_relative_eq!(run(1.0).hopf_points().next().unwrap().value, -1.0, max_relative = 1e-14);
    let branch = run(-2.0);
    assert_eq!(kinds(&branch), ["NSE1"]);
    match branch.special_points().next() {
        Some(SpecialPoint::NeutralSaddle(saddle)) => {
            assert_relative_eq!(saddle.value, 0.5, max_relative = 1e-14);
            assert_relative_eq!(saddle.eigenvalue, 2.0_f64.sqrt(), max_relative = 1e-14);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn brusselator_has_its_hopf_point_at_two() {
    let branch = Equilibria::of(&Brusselator)
        .start(&[1.0, 1.0])
        .parameters(&[1.0, 1.0])
        .along("b", 0.5..=6.0)
        .run()
        .unwrap();
    let hopf: Vec<_> = branch.hopf_points().collect();
    assert_eq!(kinds(&branch), ["HB1"]);
    assert_relative_eq!(hopf[0].value, 2.0, max_relative = 1e-14);
    assert_relative_eq!(hopf[0].frequency, 1.0, max_relative = 1e-14);
    assert_relative_eq!(hopf[0].crossing_speed.unwrap(), 0.5, max_relative = 1e-13);
    assert_relative_eq!(hopf[0].c1_real.unwrap(), -0.5, max_relative = 1e-13);
}

#[test]
fn reaction_has_its_published_folds_and_hopf_points() {
    let run =
        |b: f64| Equilibria::of(&Reaction).parameters(&[0.0, b, 3.0]).along("D", 0.0..=0.4).run().unwrap();
    let values = |branch: &EquilibriumBranch| branch.hopf_points().map(|hopf| hopf.value).collect::<Vec<_>>();
    let branch = run(14.0);
    assert_eq!(kinds(&branch), ["HB1", "HB2"]);
    assert_relative_eq!(values(&branch)[0], 0.16504204532, max_relative = 1e-10);
    let branch = run(17.0);
    assert_eq!(kinds(&branch), ["HB1", "LP1", "LP2", "HB2"]);
    let hopf = values(&branch);
    assert_relative_eq!(hopf[0], 0.12086571951, max_relative = 1e-10);
    assert_relative_eq!(hopf[1], 0.21708050970, max_relative = 1e-10);
    let branch = run(18.0);
    assert_eq!(kinds(&branch), ["HB1", "LP1", "LP2", "HB2"]);
    let folds: Vec<_> = branch.folds().collect();
    assert_relative_eq!(folds[0].value, (-1.5_f64).exp() / 2.0, max_relative = 1e-13);
    assert_relative_eq!(folds[1].value, 2.0 * (-3.0_f64).exp(), max_relative = 1e-13);
}

#[test]
fn lorenz_has_hopf_points_on_both_branches_through_the_pitchfork() {
    let parameters = [0.0, 10.0, 8.0 / 3.0];
    let trivial = Equilibria::of(&Lorenz).parameters(&parameters).along("rho", 0.0..=30.0).run().unwrap();
    assert_eq!(kinds(&trivial), ["BP1", "NSE1"]);
    let pitchfork = trivial.branch_points().next().unwrap();
    assert_relative_eq!(pitchfork.value, 1.0, max_relative = 1e-14);
    assert_eq!(pitchfork.crossing, Crossing::Pitchfork);
    assert!(pitchfork.cubic.unwrap() < 0.0);
    let branch = Equilibria::of(&Lorenz).from_branch_point(pitchfork).along("rho", 0.0..=30.0).run().unwrap();
    assert_eq!(kinds(&branch), ["HB1", "BP1", "HB2"]);
    for hopf in branch.hopf_points() {
        assert_relative_eq!(hopf.value, 470.0 / 19.0, max_relative = 1e-13);
        assert_eq!(hopf.criticality, Criticality::Subcritical);
    }
    for point in &branch.points {
        assert!((point.state[2] - (point.value - 1.0)).abs() < 1e-9 * point.value);
        if point.label.is_none() {
            let expected = if point.value < 470.0 / 19.0 { 0 } else { 2 };
            assert_eq!(point.stability.unstable_dimension(), Some(expected), "at {}", point.value);
        }
    }
}

#[test]
fn predator_has_its_published_special_points() {
    let parameters = [0.0, 3.0, 5.0, 3.0];
    let branch = Equilibria::of(&Predator)
        .start(&[1.0 / 3.0, 2.0])
        .parameters(&parameters)
        .along("p1", 0.0..=1.5)
        .run()
        .unwrap();
    let hopf: Vec<_> = branch.hopf_points().collect();
    assert_eq!(kinds(&branch), ["HB1", "BP1"]);
    assert_relative_eq!(hopf[0].value, 0.67159384747883, max_relative = 1e-13);
    assert_relative_eq!(hopf[0].frequency, 0.6047822219, max_relative = 1e-10);
    let branch = Equilibria::of(&Predator).parameters(&parameters).along("p1", 0.0..=0.9).run().unwrap();
    assert_eq!(kinds(&branch), ["NSE1", "BP1"]);
    let branch_points: Vec<_> = branch.branch_points().collect();
    assert_relative_eq!(branch_points[0].value, 0.6, max_relative = 1e-13);
    assert_eq!(branch_points[0].crossing, Crossing::Transcritical);
    let prey =
        Equilibria::of(&Predator).from_branch_point(branch_points[0]).along("p1", 0.0..=0.9).run().unwrap();
    // Both real eigenvalues pass through each other's negative on the way, twice.
    assert_eq!(kinds(&prey), ["BP1", "NSE1", "BP2", "LP1", "NSE2"]);
    let folds: Vec<_> = prey.folds().collect();
    assert_relative_eq!(folds[0].value, 0.83292932223, max_relative = 1e-10);
}
