"""Models of other packages, against the same model in Python, and a bar for the progress."""

import math

import numpy as np
import pytest

import arclength


def test_casadi():
    casadi = pytest.importorskip("casadi")
    x, p = casadi.SX.sym("x", 3), casadi.SX.sym("p", 2)
    lure = {"x": x, "p": p, "ode": casadi.vertcat(x[1], x[2], -p[0] * x[2] - p[1] * x[1] - x[0] + x[0] ** 2)}
    model = arclength.Model.from_casadi(lure, {"p_0": 2.0, "p_1": 1.0})
    assert list(model.states) == ["x_0", "x_1", "x_2"]
    branch = model.equilibria(along=("p_0", -1.5, 1.5))
    assert branch["HB1"].value == pytest.approx(1, abs=1e-10)
    with pytest.raises(arclength.InvalidInput, match="p_1"):
        arclength.Model.from_casadi(lure, {"p_0": 2.0})
    # Every function with a rule, at random points, against CasADi's own numbers.
    a, b = casadi.SX.sym("a"), casadi.SX.sym("b")
    small = a / 4
    expressions = [
        a + b * a - 2 * b,
        casadi.sin(a) * casadi.cos(b) / (2 + casadi.tanh(a)) + casadi.tan(small),
        casadi.exp(-a) + casadi.log(1 + b**2) - casadi.sqrt(b**2 + 1) + casadi.log1p(b**2) + casadi.expm1(small),
        casadi.if_else(a > b, a, b * b) + casadi.fmin(a, b) * casadi.fmax(a, 0.5) + casadi.fabs(b),
        casadi.atan2(a, 2 + b) + casadi.asin(small) + casadi.acos(small) + casadi.atan(b) + casadi.hypot(a, b),
        casadi.sinh(a) + casadi.cosh(b),
        casadi.if_else(casadi.logic_and(a > 0, b < 0), 1, casadi.if_else(casadi.logic_or(a < -1, b > 1), a, 3)) + casadi.sign(a),
        casadi.if_else(casadi.logic_not(a >= b), a**3, 1 / (2 + b**2)) + a**1.0 * 2,
    ]
    names = [f"s{index}" for index in range(len(expressions) - 2)]
    state = casadi.vertcat(a, b, *[casadi.SX.sym(name) for name in names])
    model = arclength.Model.from_casadi({"x": state, "ode": casadi.vertcat(*expressions)})
    truth = casadi.Function("f", [state], [casadi.vertcat(*expressions)])
    for point in np.random.default_rng(1).uniform(-2, 2, (50, len(expressions))):
        np.testing.assert_allclose(model(point), np.array(truth(point)).ravel(), rtol=1e-13, atol=1e-13)
    with pytest.raises(arclength.NotTraceable, match="OP_FMOD"):
        arclength.Model.from_casadi({"x": a, "ode": casadi.fmod(a, 2)})


def test_small_and_large_numbers_of_casadi():
    casadi = pytest.importorskip("casadi")
    a, b = casadi.SX.sym("a"), casadi.SX.sym("b")
    model = arclength.Model.from_casadi({"x": casadi.vertcat(a, b), "ode": casadi.vertcat(casadi.expm1(a), casadi.log1p(b))})
    small = [sign * 10.0**power for power in range(-300, 3) for sign in (1, -1)]
    for x in [*small, 0.0, 0.3, -0.7, 5.0, 300.0, -30.0, -1500.0, -1e6]:
        expected = math.expm1(x)
        assert model([x, 0.0])[0] == pytest.approx(expected, rel=4e-15, abs=0), x
    for x in [*(x for x in small if x > -1), 0.0, 0.3, -0.7, -0.999999, 1e10, 1e300]:
        assert model([0.0, x])[1] == pytest.approx(math.log1p(x), rel=4e-15, abs=0), x


def test_sympy_takes_names_in_texts_for_what_they_are_given_as():
    sympy = pytest.importorskip("sympy")
    for name in ("E", "I", "S", "N", "O", "Q", "beta", "gamma", "zeta", "sin_", "exp_1", "C", "Lambda", "lambdify"):
        model = arclength.Model.from_sympy({"x": f"{name}*x + 1"}, {name: 2.0})
        assert model([3.0]).tolist() == [7.0], name
        symbol, x = sympy.Symbol(name), sympy.Symbol("x", positive=True)
        assert arclength.Model.from_sympy({x: symbol * x + 1}, {symbol: 2.0})([3.0]).tolist() == [7.0], name
        assert arclength.Model.from_sympy({name: f"-{name}**2"})([3.0]).tolist() == [-9.0], name
    # A name that is given to nothing is what it is for SymPy; functions stay functions.
    assert arclength.Model.from_sympy({"x": "E*x + exp(x) + a"}, {"a": 1.0})([1.0])[0] == pytest.approx(2 * math.e + 1)
    assert arclength.Model.from_sympy({"lam": sympy.Symbol("lam") * 2})([1.0]).tolist() == [2.0]


def test_sympy_refuses_with_a_remedy():
    sympy = pytest.importorskip("sympy")
    x = sympy.Symbol("x")
    for wrong in ("beta*x", "x +", "S*x", "gamma", "[x]", "x > 1", "lambda*x"):
        with pytest.raises(arclength.InvalidInput, match="allowed: an expression in x") as refused:
            arclength.Model.from_sympy({"x": wrong})
        assert (refused.value.key, refused.value.value) == ("equations", wrong)
    with pytest.raises(arclength.InvalidInput, match="c: neither a state nor a parameter"):
        arclength.Model.from_sympy({"x": "c*x"})
    with pytest.raises(arclength.NotTraceable, match="besselj"):
        arclength.Model.from_sympy({x: sympy.besselj(0, x)})
    with pytest.raises(arclength.NotTraceable, match="not finite"):
        arclength.Model.from_sympy({x: x / 0})


ANTIMONY = """
model brusselator()
  compartment cell = 1
  species X in cell = 1, Y in cell = 1
  A = 1; B = 1.5
  R1: -> X; A*cell
  R2: X -> Y; B*X*cell
  R3: Y -> X; X*X*Y*cell
  R4: X -> ; X*cell
end
"""


def test_antimony_and_sbml():
    antimony = pytest.importorskip("antimony")
    pytest.importorskip("COPASI")
    model = arclength.Model.from_antimony(ANTIMONY)
    parameter = next(name for name in model.parameters if name.lower() == "b")
    # Closed form: x = a, y = b/a, Hopf point at b = 1 + a^2 with the frequency a.
    hopf = model.equilibria(along=(parameter, 0.5, 5))["HB1"]
    assert hopf.value == pytest.approx(2, abs=1e-8)
    assert hopf.normal_form.frequency == pytest.approx(1, abs=1e-8)
    antimony.loadAntimonyString(ANTIMONY)
    again = arclength.Model.from_sbml(antimony.getSBMLString("brusselator"))
    assert again.source == model.source
    with pytest.raises(arclength.InvalidModel, match="Antimony"):
        arclength.Model.from_antimony("model x(; \n")
    with pytest.raises(arclength.InvalidModel, match="events"):
        arclength.Model.from_antimony("model x()\n X=1; k=1;\n R: X -> ; k*X\n at (X<0.5): X=1\nend\n")
    with pytest.raises(arclength.InvalidModel, match="SBML"):
        arclength.Model.from_sbml("<nothing/>")
    with pytest.raises(arclength.InvalidInput, match="no_such_file"):
        arclength.Model.from_sbml("no_such_file.xml")


def test_a_bar(capsys):
    pytest.importorskip("tqdm")
    from arclength.kingpin import Wheel

    Wheel().chart(("v", 0.1, 12, 300), ("l", 0.02, 0.3, 300), progress=True)
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "kingpin.chart" in shown.err
