"""What a function reaches is recorded too, or refused: decorators, modules, methods, containers, imports, and what changes from call to call."""

import dataclasses
import functools
import math
import random
import sys
import time
import types

import numpy as np
import pytest

import arclength

TABLE = {"square": lambda v: np.array([v[0] ** 2, v[1]]), "list": [lambda v: math.exp(-v)]}
GENERATOR = np.random.default_rng(1)


def doubled(function):
    @functools.wraps(function)
    def wrapper(x, *rest):
        return 2 * np.asarray(function(np.maximum(x, 0), *rest))

    return wrapper


class Counted:
    """A decorator that is a class."""

    def __init__(self, function):
        functools.update_wrapper(self, function)
        self.function = function

    def __call__(self, *given):
        return -np.array(self.function(*given))


@doubled
def decorated(x, p):
    return -x


@Counted
def counted(x, p):
    return [p.a * x[0], math.tanh(x[1])]


@functools.lru_cache
def kept(value):
    return np.zeros(2) + value


@functools.singledispatch
def dispatched(value):
    return value


@dispatched.register(np.ndarray)
def _(value):
    return -value


@dispatched.register(float)
def _(value):
    return 3 * value


@functools.wraps(np.clip)
def clip(value, *_):
    return 5 * value


@dataclasses.dataclass(frozen=True)
class Rates:
    gain: float
    shape: object = np.tanh

    def rate(self, value):
        filled = np.zeros(2)
        filled[:] = self.gain * self.shape(value)
        return filled + self.inner(value)

    def inner(self, value):
        return [math.exp(-v * v) for v in value]


class Steeper(Rates):
    @property
    def buffer(self):
        return np.zeros(2)

    @staticmethod
    def power(value):
        return np.array([v**3 for v in value])

    def rate(self, value):
        filled = self.buffer
        filled[0] = value[1]
        return super().rate(value) + filled * self.power(value)


RATES = Rates(1.5)
STEEPER = Steeper(0.5)
MODULE = types.ModuleType("of_the_user")
exec("import numpy as np, math\ndef rate(x):\n    y = np.zeros(2)\n    y[0] = math.sin(x[0])\n    return y\n", MODULE.__dict__)


def default(x, p, helper=TABLE["list"][0]):
    return [helper(v) for v in x]


def imported(x, p):
    import math as m

    import numpy as np
    from numpy import zeros

    y = zeros(2)
    y[0] = m.exp(-x[0] ** 2)
    y[1] = np.linalg.norm([x[0], x[1]])
    return y


@pytest.mark.parametrize(
    "function",
    [
        decorated,
        counted,
        lambda x, p: doubled(np.sin)(x),
        lambda x, p: kept(x[0]) * x,
        lambda x, p: dispatched(x) * dispatched(x[0]),
        lambda x, p: clip(x, -1, 1),
        lambda x, p: TABLE["square"](x) + TABLE["list"][0](x[0]),
        lambda x, p: RATES.rate(x),
        lambda x, p: MODULE.rate(x) + p.a,
        functools.partial(lambda rates, x, p: rates.rate(x), Rates(0.5, np.arctan)),
        lambda x, p: STEEPER.rate(x),
        lambda x, p: np.poly1d([1, 2])(x) + np.polynomial.Polynomial([1, 2, 3])(x),
        default,
        imported,
    ],
)
def test_what_a_function_calls_is_recorded(function):
    model = arclength.Model(function, ["x", "y"], {"a": 1.0})
    for state in ([1.0, -2.0], [-0.3, 0.8]):
        expected = np.asarray(function(np.array(state), arclength.Parameters({"a": 1.0})), dtype=float)
        np.testing.assert_allclose(model(state), expected, rtol=1e-13)


def caught(x, p):
    try:
        return [math.log1p(x[0])]
    except ValueError:
        return [0.0]


def caught_choice(x, p):
    try:
        return [1.0 if x[0] > 0 else -1.0]
    except Exception:
        return [0.0]


CALLS = []


def counting(x, p):
    CALLS.append(1)
    return [len(CALLS) * x[0]]


def broken_for_numbers(x, p):
    if type(x) is np.ndarray:
        raise ValueError("not for arrays")
    return x


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (broken_for_numbers, "raises ValueError for numbers"),
        (lambda x, p: [x[0]] * (1 + (type(x) is np.ndarray)), "2 derivatives"),
        (caught, "log1p has no rule"),
        (caught_choice, r"np\.where"),
        (lambda x, p: [random.random() * x[0]], "another number each time"),
        (lambda x, p: x + np.random.normal(size=1), "another number each time"),
        (lambda x, p: x + GENERATOR.normal(), "another number each time"),
        (lambda x, p: x * time.time(), "another number each time"),
        (counting, "another value when it is called again"),
        (lambda x, p: x if type(x) is np.ndarray else -x, "its recording"),
        (lambda x, p: x if sys._getframe(1).f_code.co_name == "trace" else -x, "its recording"),
        (lambda x, p: x * {}["b"], "KeyError"),
    ],
)
def test_what_is_not_what_its_function_does_is_refused(function, message):
    with pytest.raises(arclength.NotTraceable, match=message):
        arclength.Model(function, ["x"], {"a": 1.0})


def test_numbers_drawn_with_a_seed_inside_are_constants():
    model = arclength.Model(lambda x, p: x * np.random.default_rng(3).normal(), ["x"])
    assert model([2.0]) == 2 * np.random.default_rng(3).normal()


@pytest.mark.parametrize(
    "function",
    [
        lambda x, p: [math.log(x[0]) + math.sqrt(p.a - 1)],
        lambda x, p: [np.sqrt(x[0] - 1) / x[0]],
        lambda x, p: [np.floor(1e6 * x[0]) + np.where(x[0] == 0.1 * 3, 1, 0)],
        lambda x, p: [1e12 * (x[0] + 1e3 - 1e3 - x[0]) - x[0]],
        lambda x, p: [np.exp(50 * x[0]) - np.exp(50 * x[0]) * (1 + 1e-16)],
        lambda x, p: [np.sum(np.sin(np.arange(1000) * x[0])) - p.a],
        lambda x, p: [x[0] ** p.a * (1 - x[0]) ** 0.5],
    ],
)
def test_functions_with_kinks_roundings_and_narrow_domains_are_not_refused(function):
    arclength.Model(function, ["x"], {"a": 2.0})


def test_a_function_without_a_value_anywhere_is_told():
    with pytest.warns(arclength.AnalysisWarning, match="was not compared"):
        arclength.Model(lambda x, p: [math.log(-1 - x[0] * x[0])], ["x"])


def test_texts_for_sympy_mean_the_names_that_are_given():
    sympy = pytest.importorskip("sympy")
    model = arclength.Model.from_sympy({"x": "E*x + beta*S"}, {"E": 2.0, "beta": 3.0, "S": 5.0})
    assert model([1.0]) == 17
    x, wave = sympy.symbols("x lambda")
    assert arclength.Model.from_sympy({x: wave * x}, {wave: 2.0})([3.0]) == 6
    for wrong in (sympy.besselj(1, x), sympy.zoo * x):
        with pytest.raises(arclength.NotTraceable):
            arclength.Model.from_sympy({x: wrong})


def test_what_is_no_function_or_no_mapping_is_refused():
    for function, parameters in ((3, None), (lambda x, p: x, [1.0])):
        with pytest.raises(arclength.InvalidInput):
            arclength.Model(function, ["x"], parameters)
