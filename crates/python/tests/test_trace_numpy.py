"""NumPy's own semantics in functions that are models: types, shapes, ``out=``, views, and constants made inside."""

import math
from fractions import Fraction
from numbers import Number

import numpy as np
import pytest

import arclength

MATRIX = np.array([[2.0, 0.5, 0.0], [0.1, 1.0, -0.3], [0.0, 0.2, 3.0]])
STATES = ["x", "y", "z"]


def assert_recorded(function):
    """The model equals its function at points that were not compared when it was made."""
    model = arclength.Model(function, STATES, {"a": 1.3, "b": -0.4})
    random = np.random.default_rng(5)
    for _ in range(8):
        state, values = random.uniform(-2, 2, 3), {"a": random.uniform(0.2, 2), "b": random.uniform(-1, 1)}
        with np.errstate(all="ignore"):
            expected = np.asarray(function(state.copy(), arclength.Parameters(values)), dtype=float)
        np.testing.assert_allclose(model(state, values), expected, rtol=1e-12, atol=1e-13)


def written_by(act):
    """A function that fills an array by a function of NumPy that writes into it."""

    def function(x, p):
        y = np.zeros(3)
        act(x, y)
        return y

    return function


def filled_then(function):
    def filled(x, p):
        y = np.zeros(3)
        for index in range(3):
            y[index] = x[index] * p.a
        y[1] += 1
        return function(y)

    return filled


def of_whole_numbers(x, p):
    weights = np.array([1, 2, 3])
    return weights // 2 * x + weights[::-1] * (x > 0)


def through_a_view(x, p):
    d = np.zeros((3, 1))
    np.asarray(d)[0] = x[0]
    d.ravel()[1] = x[1]
    np.transpose(d)[0, 2] = p.a
    return d[:, 0]


def masked(x, p):
    y = x.copy()
    y[y > p.a] = p.a
    np.fill_diagonal(square := np.outer(x, x), x)
    return y + square[1]


def from_constants(x, p):
    first, second, third = MATRIX.copy(), np.full(3, -1) + 0.0, MATRIX.prod(axis=0)
    first[0] = x
    second[x > 0] = p.a
    third[2] = x[1]
    return first @ second + third


@pytest.mark.parametrize(
    "function",
    [
        lambda x, p: np.clip(x, a_min=-1, a_max=1),
        pytest.param(
            lambda x, p: np.clip(x, max=p.a, min=p.b) + x.clip(-1, 1),
            marks=pytest.mark.skipif(np.lib.NumpyVersion(np.__version__) < "2.1.0", reason="clip has min and max since NumPy 2.1"),
        ),
        lambda x, p: np.clip(x, -np.inf, 1) + np.minimum(np.inf, x),
        written_by(lambda x, y: np.clip(x, -1, 1, out=y)),
        written_by(lambda x, y: x.clip(-1, 1, out=y)),
        written_by(lambda x, y: np.matmul(MATRIX, x, out=y)),
        written_by(lambda x, y: x.dot(MATRIX, out=y)),
        written_by(lambda x, y: np.outer(x, x).mean(axis=0, out=y)),
        written_by(lambda x, y: np.multiply(x, x[0], out=y)),
        written_by(lambda x, y: np.sum(np.outer(x, x), axis=1, out=y)),
        written_by(lambda x, y: np.copyto(y, x)),
        through_a_view,
        masked,
        of_whole_numbers,
        lambda x, p: np.asarray(x) + np.array(x, dtype=np.float64) + np.array([x[0], x[1], 0], dtype=float),
        # Truth values.
        lambda x, p: 1.0 * ((x > 0) + (x > -1)) + 1.0 * ((x > 0) * (x < 1) + (x > -1)),
        lambda x, p: [np.add(x[0] > 0, x[1] > 0), np.dot(x > 0, x > -1), (x[0] > 0) + (x[1] > 0) + 1],
        lambda x, p: [(p.a > 1) + (p.b > 0), np.sum(x > 0) * x[0], ((x[:, None] > 0) @ (x[None, :] > 1)).sum()],
        lambda x, p: np.where(~(x > 0) | (x > 1), x, 1 - (x > 0.5)) + np.any(x > 1) - np.all(x < 1) + np.mean(x > 0),
        lambda x, p: np.where(x, 1.0, 0.0) + 1.0 * np.logical_and(x, x - x[0]) + 1.0 * ((x > 0) ^ (x > 1)),
        # Types.
        lambda x, p: [x[0] if isinstance(x[0], float) else -x[0], 0, x[0] if isinstance(p.a, Number) else -x[0]],
        lambda x, p: x if isinstance(x[0], np.floating) and isinstance(x, np.ndarray) and x.dtype == float else -x,
        lambda x, p: x * (1 if isinstance(np.where(x[0] > 5, p.a, p.b), float) else 2) + np.where(x[0] > 5, p.a, p.b) ** 2,
        lambda x, p: [float(v) for v in x],
        lambda x, p: np.float64(p.a) * x.astype(float),
        lambda x, p: [Fraction(1, 3) * v + v.imag for v in x],
        # Arrays filled by assignment, then given to functions.
        filled_then(np.tanh),
        filled_then(lambda y: np.where(y > 0, y, np.maximum(y, -1))),
        filled_then(lambda y: y.clip(0, 1) + np.exp(-(y**2)) + np.cumsum(y) + np.diff(y, append=y[0])),
        filled_then(lambda y: y * y.std() + np.var(y, ddof=1) + np.prod(y) + y.max(keepdims=True)),
        # Arguments by position and by name.
        lambda x, p: np.zeros(3, float) + np.ones(3, np.float64) * x + np.zeros_like(x, float) + np.full(shape=3, fill_value=p.a),
        lambda x, p: x[np.array([2, 0, 1])] + x[np.arange(3)] + x[np.array([True, True, True])] + np.full(3, x[0]),
        lambda x, p: x * max(i for i in range(3)) + min(map(abs, [1, -2])),
        lambda x, p: [math.prod(x), math.fsum(x), math.hypot(*x)],
        lambda x, p: np.outer(x, x).mean(axis=(0, 1)) + np.max(np.outer(x, x), axis=(0, 1)) + np.linalg.norm(np.outer(x, x), axis=1),
        lambda x, p: np.linalg.norm(x, 1) * x + np.linalg.norm(x, np.inf) + np.linalg.norm(np.outer(x, x), "fro") + sum(p[0:2]),
        lambda x, p: np.linalg.solve(np.array([[0, 1.0, 0], [1, 0, 0], [0, p.b, 1]]), x),
        lambda x, p: np.linalg.inv(np.eye(3) * 4 + np.outer(x, x) / 3) @ x + np.linalg.det(np.eye(3) + np.outer(x, x)),
        # Constants made inside are those of NumPy.
        lambda x, p: np.linalg.inv(np.array([[2.0, 0, 0], [0, 1, 0], [0, 0, 1]])) @ x + np.linalg.solve(np.eye(3) * 2, x),
        lambda x, p: x * np.log1p(np.array([1.0, 2, 3])) + np.median(np.array([3.0, 1.0])) + np.linspace(0, 1, 3).argmax(),
        lambda x, p: x * np.array([1.5, 2.5, 3.5]).astype(int) + np.sort(np.array([2.0, 1.0, 3.0])) + MATRIX[np.array([0, 1, 0]), 1],
        from_constants,
        lambda x, p: MATRIX.mean(axis=0).clip(0.5) * x + MATRIX.dot(x) + MATRIX.T[1:, 0].sum(),
        lambda x, p: np.r_[x[0], x[1:]] + np.array([[v, 1.0] for v in x])[:, 0] + np.vectorize(lambda v: v * v)(x),
    ],
)
def test_a_function_is_recorded_as_numpy_computes_it(function):
    assert_recorded(function)


def test_an_exponential_less_one_far_from_zero():
    model = arclength.Model(lambda x, p: np.expm1(x), ["x"])
    for value in (-1500.0, -50.0, -1e-12, 0.0, 1e-12, 30.0):
        np.testing.assert_allclose(model([value]), np.expm1(value), rtol=1e-15)


def whole(x, p):
    d = np.array([0, 0, 0])
    d[1] = 7 * x[1]
    return d


@pytest.mark.parametrize(
    ("function", "remedy"),
    [
        (whole, r"np\.array\(\[0\.0"),
        (lambda x, p: np.full(3, 0).__setitem__(0, x[0]), r"np\.array\(\[0\.0"),
        (lambda x, p: MATRIX.__setitem__(0, x), "not made in this function"),
        (lambda x, p: np.zeros(3, dtype=np.float32) * p.a + x.astype(np.float32), "double precision"),
        (lambda x, p: np.exp(x > 0), r"1\.0\*condition"),
        (lambda x, p: [np.linalg.norm(np.outer(x, x), 2), 0, 0], r"np\.sum"),
        (lambda x, p: x[x > 0], r"np\.where"),
        (lambda x, p: np.add.at(x, [0, 1], 1.0), "loop"),
        (lambda x, p: np.sum(x, where=x > 0), r"np\.where"),
        (lambda x, p: 1j * x[0] * x, "real and imaginary"),
        (lambda x, p: [float(f"{x[0]:.3f}"), 0, 0], "texts"),
        (lambda x, p: [len(str(x[0])), 0, 0], "texts"),
        (lambda x, p: x * p.c, "there is no parameter `c`"),
        (lambda x, p: x + [1, 2], "broadcast"),
    ],
)
def test_what_is_not_recorded_is_refused_with_its_remedy(function, remedy):
    with pytest.raises(arclength.NotTraceable, match=remedy) as refused:
        arclength.Model(function, STATES, {"a": 1.0})
    assert refused.value.filename == __file__
