"""Python functions as models: equal to the function at random points, and refused where they are none."""

import functools
import math
from math import sin as sine

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import arclength


def van_der_pol(x, p):
    return [x[1], p.mu * (1 - x[0] ** 2) * x[1] - x[0]]


def lorenz(x, p):
    a, b, c = x
    return np.array([p["sigma"] * (b - a), a * (p["rho"] - c) - b, a * b - p["beta"] * c])


def filled(x, p):
    dx = np.zeros(3)
    dx[0] = -x[0] + math.tanh(x[1])
    dx[1:] = np.exp(-x[:2]) - p.a * x[1:]
    dx *= 2
    dx[2] -= 0.5
    return dx


def matrices(x, p):
    coupling = np.array([[-2.0, 1.0, 0.0], [1.0, -2.0, 1.0], [0.0, 1.0, -2.0]])
    return coupling @ x + p.a * np.sin(x) - np.dot(coupling, np.tanh(x)) + np.sum(x**2) * np.ones(3) / np.linalg.norm(x + 3)


def choices(x, p):
    steep = np.where(x > p.a, x**2, -x)
    kinks = np.maximum(x, 0.1) + np.minimum(x, p.a) + np.abs(x) + np.sign(x) + np.heaviside(x, 0.5) + np.clip(x, -0.5, p.a)
    return steep + kinks + np.where(np.logical_and(x[0] > 0, x[1] <= p.a), 1.0, x.mean())


def functions(x, p):
    a, b, c = x
    first = np.sqrt(a * a + 1) + np.arctan2(a, b) + math.log(b * b + 1, 2) + np.log10(c * c + 1) + math.erf(a)
    second = np.sinh(a) * np.cosh(b) / (2 + np.cos(c)) + np.expm1(a) + np.hypot(a, b) + math.atan(c) + np.exp2(b)
    third = np.power(a * a + 0.5, p.a) + a**3 - b**-2.0 * b**2 + abs(c) ** 1.5 + np.square(c) + np.deg2rad(b) + sine(a)
    return {"x": first, "z": third, "y": second}


def helper(values, factor):
    result = np.empty_like(values)
    for index, value in enumerate(values):
        result[index] = factor * math.cos(value)
    return result


def inner_functions(x, p):
    def twice(value):
        return 2 * value

    squares = [twice(value) * value for value in x]
    return helper(x, p.a) + np.array(squares) + functools.reduce(lambda a, b: a * b, x)


def shapes(x, p):
    grid = np.stack([x, np.roll(x, 1), x[::-1]])
    differences = np.diff(np.concatenate([x, x[:1]]))
    return grid.T @ x - grid.sum(axis=0) * p.a + differences + np.outer(x, x).trace() + np.einsum("ij,j->i", grid, x) + grid.max(axis=0)


def mass_matrix(x, p):
    mass = np.array([[2.0, np.cos(x[0]), 0.1], [np.cos(x[0]), 3.0, 0.2 * x[2]], [0.1, 0.2 * x[2], 4.0]])
    return np.linalg.solve(mass, np.array([x[1], -p.a * x[0], x[2] - 1]))


class Neuron:
    def __init__(self, rate):
        self.rate = rate

    def __call__(self, x, p):
        gate = 1 / (1 + np.exp(-(x[0] + self.rate) / 0.3))
        return [gate - x[0], self.rate * (x[0] - x[1]) * p.a, np.tanh(x[2]) - gate]


THREE = ["x", "y", "z"]
MODELS = [
    (van_der_pol, ["x", "y"], {"mu": 1.5}),
    (lorenz, THREE, {"sigma": 10.0, "rho": 28.0, "beta": 8 / 3}),
    (filled, THREE, {"a": 0.3}),
    (matrices, THREE, {"a": 0.3}),
    (choices, THREE, {"a": 0.3}),
    (functions, THREE, {"a": 0.3}),
    (inner_functions, THREE, {"a": 0.3}),
    (shapes, THREE, {"a": 0.3}),
    (mass_matrix, THREE, {"a": 0.3}),
    (Neuron(0.7), THREE, {"a": 0.3}),
    (functools.partial(lambda gain, x, p: gain * x - p.a * x**3, 2.5), THREE, {"a": 0.3}),
    (lambda x, p: np.cumsum(x) - p[0] * x[0] * np.arange(3), THREE, {"a": 0.3}),
]


@functools.cache
def traced(index):
    function, states, parameters = MODELS[index]
    return arclength.Model(function, states=states, parameters=parameters)


@pytest.mark.parametrize("index", range(len(MODELS)))
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_a_model_equals_its_function(index, data):
    function, states, parameters = MODELS[index]
    number = st.floats(-2, 2).filter(lambda value: abs(value) > 1e-3)
    state = np.array(data.draw(st.lists(number, min_size=len(states), max_size=len(states))))
    values = {name: data.draw(st.floats(0.05, 2)) for name in parameters}
    expected = function(state, arclength.Parameters(values))
    if isinstance(expected, dict):
        expected = [expected[name] for name in states]
    found = traced(index)(state, values)
    np.testing.assert_allclose(found, np.asarray(expected, dtype=float), rtol=2e-13, atol=2e-13)


def test_a_thousand_states():
    def ring(x, p):
        return p.a * (np.roll(x, 1) - 2 * x + np.roll(x, -1)) + x - x**3

    model = arclength.Model(ring, states=[f"x{index}" for index in range(1000)], parameters={"a": 0.1})
    state = np.sin(np.arange(1000.0))
    np.testing.assert_allclose(model(state), ring(state, arclength.Parameters({"a": 0.1})), rtol=1e-13, atol=1e-15)


def hopf_normal_form(x, p):
    return p.mu * x + np.array([-x[1], x[0]]) - x * np.sum(x**2)


def test_a_traced_model_bifurcates_and_is_restarted_by_the_program(program, tmp_path):
    model = arclength.Model(hopf_normal_form, states=["x", "y"], parameters={"mu": -1.0})
    branch = model.equilibria(along=("mu", -1, 1))
    assert branch["HB1"].value == pytest.approx(0, abs=1e-12)
    branch.save(tmp_path / "branch.json")
    done = program("arclength", "cycles", "--from", "branch.json:HB1", "--along", "mu=-1:1.5", "--at", "1", "-o", "c.json", "-q")
    assert done.returncode == 0, done.stderr
    cycle = arclength.load(tmp_path / "c.json")["AT1"]
    assert cycle.period == pytest.approx(2 * math.pi, rel=1e-9)
    assert cycle.max.x == pytest.approx(1, rel=1e-9)


def test_expressions_of_sympy():
    sympy = pytest.importorskip("sympy")
    x, y, a = sympy.symbols("x y a")
    equations = {x: y, y: a * sympy.sin(x) - sympy.Piecewise((y**3, y > 0), (y, True)) + sympy.exp(-a * x) / (1 + x**2)}
    model = arclength.Model.from_sympy(equations, {a: 0.5})
    for state in ([0.3, 0.7], [-1.2, -0.4]):
        expected = [float(entry.subs({x: state[0], y: state[1], a: 0.5})) for entry in equations.values()]
        np.testing.assert_allclose(model(state), expected, rtol=1e-13)
    with pytest.raises(arclength.InvalidInput, match="b: neither"):
        arclength.Model.from_sympy({x: sympy.Symbol("b") * x})


def test_names_keep_their_capitals():
    model = arclength.Model(lambda x, p: [-p.Gamma * x[0]], states=["Voltage"], parameters={"Gamma": 2.0})
    assert list(model.states) == ["Voltage"]
    assert list(model.parameters) == ["Gamma"]
    for name in ("gamma", "sin", "λ", "a b"):
        with pytest.raises(arclength.InvalidInput):
            arclength.Model(lambda x, p: [x[0]], states=["x"], parameters={"Gamma": 1.0, name: 1.0})


def branching(x, p):
    if x[0] > 0:
        return [x[0]]
    return [-x[0]]


def on_a_parameter(x, p):
    return [x[0] if p.a > 0 else -x[0]]


def remainder(x, p):
    return [x[0] % 2]


def smallest(x, p):
    return [min(x[0], p.a)]


def without_a_rule(x, p):
    return [np.arcsinh(x[0])]


def counting(x, p):
    return [sum(x[0] for _ in range(int(p.a)))]


def too_many(x, p):
    return [x[0], x[0]]


def unbound(x, p):
    numbers = [0.0] * 1
    import array

    return [array.array("d", [x[0]])[0] + numbers[0]]


@pytest.mark.parametrize(
    ("function", "line", "remedy"),
    [
        (branching, 1, "np.where"),
        (on_a_parameter, 1, "np.where"),
        (remainder, 1, "np.floor"),
        (smallest, 1, "np.minimum"),
        (without_a_rule, 1, "np.log"),
        (counting, 1, "np.floor"),
        (unbound, 4, "np.array"),
    ],
)
def test_what_is_no_model_is_refused_where_it_is(function, line, remedy):
    with pytest.raises(arclength.NotTraceable) as refused:
        arclength.Model(function, states=["x"], parameters={"a": 1.0})
    assert refused.value.filename == __file__
    assert refused.value.line == function.__code__.co_firstlineno + line
    assert remedy in str(refused.value)


def test_a_function_with_other_states_is_refused():
    with pytest.raises(arclength.NotTraceable, match="2 derivatives; allowed: 1"):
        arclength.Model(too_many, states=["x"], parameters={})
    with pytest.raises(arclength.NotTraceable, match="returns nothing"):
        arclength.Model(lambda x, p: None, states=["x"])
    with pytest.raises(arclength.NotTraceable, match="at least one"):
        arclength.Model(lambda x, p: [], states=[])


def test_the_function_itself_is_left_as_it_was():
    before = dict(vars(np))
    arclength.Model(filled, states=THREE, parameters={"a": 1.0})
    assert dict(vars(np)) == before
    assert filled.__globals__["np"] is np
    assert filled(np.zeros(3), arclength.Parameters({"a": 1.0}))[2] == pytest.approx(1.5)
