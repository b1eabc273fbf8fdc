"""What was recorded is compared with the function itself, at the initial state and at points around it."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from time import perf_counter
from typing import Any

import numpy as np

from ..errors import AnalysisWarning, NotTraceable
from ..models import Parameters
from . import derivatives

#: Points at which the function is finite that suffice, points that are tried, and seconds after which no more than two are compared.
ENOUGH, TRIED, SLOW = 6, 24, 1.0
#: Largest relative difference; and that to the largest derivative, for rounding.
RELATIVE, ROUNDING = 1e-7, 1e-12
#: How :mod:`math` tells that a number is outside of the domain of a function.
DOMAIN = ("math ", "expected a")

Point = tuple[np.ndarray[Any, Any], dict[str, float]]


def _points(states: Mapping[str, float], parameters: Mapping[str, float]) -> Iterator[Point]:
    """The initial state, and points around it of several sizes, with parameters as given and others."""
    start = np.array(list(states.values()), dtype=float)
    yield start, dict(parameters)
    random = np.random.default_rng(0)
    for attempt in range(TRIED - 1):
        size = (1.0, 1.0, 0.1, 3.0)[attempt % 4]
        point = start + size * np.maximum(1.0, np.abs(start)) * random.normal(size=len(start))
        if attempt % 3 == 2:
            point = np.abs(point)
        others = dict(parameters)
        if attempt % 2:
            others = {name: value * random.uniform(0.7, 1.3) if value else random.uniform(0, 0.5) for name, value in parameters.items()}
        yield point, others


def _told(state: np.ndarray[Any, Any], names: Mapping[str, float], parameters: Mapping[str, float]) -> str:
    pairs = [*zip(names, state, strict=True), *parameters.items()]
    return ", ".join(f"{name}={float(value):.6g}" for name, value in pairs[:12]) + (", .." if len(pairs) > 12 else "")


class _Outside(Exception):
    """The function has no value there."""


def check(
    function: Callable[[Any, Any], Any],
    recorded: Callable[[np.ndarray[Any, Any], dict[str, float]], np.ndarray[Any, Any]],
    states: Mapping[str, float],
    parameters: Mapping[str, float],
) -> None:
    """Refuses a recording that differs from its function."""
    function = getattr(function, "py_func", function)  # of numba
    single = False

    def evaluated(state: np.ndarray[Any, Any], given: dict[str, float]) -> np.ndarray[Any, Any]:
        nonlocal single
        try:
            with np.errstate(all="ignore"):
                result = function(state.copy(), Parameters(given))
                single = single or np.dtype(getattr(result, "dtype", float)) == np.float32
                values = np.array([value if np.ndim(value) == 0 else np.ravel(value)[0] for value in derivatives(result, states)])
        except NotTraceable:
            raise
        except Exception as error:
            if isinstance(error, (ArithmeticError, np.linalg.LinAlgError)) or (isinstance(error, ValueError) and str(error).startswith(DOMAIN)):
                raise _Outside(f"{type(error).__name__}: {error}") from None
            what = f"the function raises {type(error).__name__} for numbers: {error}"
            raise NotTraceable(f"{what}, at {_told(state, states, given)}", key=what) from error
        if values.dtype.kind == "c":
            raise _Outside("complex numbers")
        return values.astype(float)

    def differ(state: np.ndarray[Any, Any], given: dict[str, float], plain: np.ndarray[Any, Any], found: np.ndarray[Any, Any]) -> Any:
        finite = np.isfinite(plain)
        if np.array_equal(plain, found, equal_nan=True):
            return np.zeros(len(plain), dtype=bool)
        relative = 1e-4 if single else RELATIVE
        allowed = relative * np.abs(plain) + ROUNDING * np.max(np.abs(plain[finite]), initial=0.0) + 1e-14
        with np.errstate(all="ignore"):
            wrong = finite & ~(np.abs(found - plain) <= allowed)
            if wrong.any():
                # Next to a jump, and where digits cancel, rounding decides.
                for factor in (1 + 1e-13, 1 - 1e-13):
                    near = evaluated(state * factor, {name: value * factor for name, value in given.items()})
                    allowed = allowed + 100 * np.abs(near - plain)
            return wrong & ~(np.abs(found - plain) <= allowed)

    compared, reason, began = 0, "it is not finite", perf_counter()
    for state, given in _points(states, parameters):
        try:
            plain = evaluated(state, given)
            if not np.array_equal(plain, evaluated(state, given), equal_nan=True):
                raise NotTraceable(
                    f"the function gives another value when it is called again, at {_told(state, states, given)}; random numbers, the time, and "
                    "what it keeps from call to call cannot be recorded",
                    key="function",
                )
            found = recorded(state, given)
            wrong = differ(state, given, plain, found)
        except _Outside as error:
            reason = str(error)
            continue
        if np.any(wrong):
            index = int(np.argmax(wrong))
            name = list(states)[index]
            raise NotTraceable(
                f"{name}': the function gives {float(plain[index]):.10g} and its recording {float(found[index]):.10g}, at "
                f"{_told(state, states, given)}; it does something that cannot be recorded: it asks for types, catches errors, changes what it "
                "keeps, or calls a function that is recorded otherwise",
                key=name,
                value=f"{float(found[index])!r}",
                allowed=f"{float(plain[index])!r}",
            )
        compared += bool(np.isfinite(plain).all())
        if compared >= ENOUGH or (compared >= 2 and perf_counter() - began > SLOW):
            return
    if not compared:
        message = f"the recording was not compared with its function, which has no value at any point tried: {reason}"
        warnings.warn(message, AnalysisWarning, stacklevel=4)
