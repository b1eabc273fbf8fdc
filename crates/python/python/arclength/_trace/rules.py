"""What NumPy's element-wise functions record."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ..errors import NotTraceable
from .values import REMAINDER, Symbol, node, refusal, typed


def _rule(name: str) -> Callable[..., Any]:
    return lambda *values: node(name, *values)


def _truth(value: Any) -> Any:
    """A number as a truth value."""
    return node("!=", value, 0.0) if type(value) is Symbol else bool(value)


def _of_truths(name: str) -> Callable[..., Any]:
    return lambda *values: node(name, *map(_truth, values))


def _greater_of(a: Any, b: Any) -> Any:
    for one, other in ((a, b), (b, a)):
        if type(one) is not Symbol and one == -math.inf:
            return other
    return node("max", a, b)


def _lesser_of(a: Any, b: Any) -> Any:
    for one, other in ((a, b), (b, a)):
        if type(one) is not Symbol and one == math.inf:
            return other
    return node("min", a, b)


def _times(factor: float) -> Callable[[Any], Any]:
    return lambda x: x * factor


def select(condition: Any, yes: Any, no: Any, truth: bool) -> Any:
    """One of two by a condition, which is a truth value or a number."""
    if type(condition) is not Symbol:
        return yes if condition else no
    return node("select", condition if truth else _truth(condition), yes, no)


#: For numbers, by names of NumPy, and of scipy.special and math. Operands are symbols of type float64, and numbers.
RULES: dict[str, Callable[..., Any]] = {
    "add": _rule("+"),
    "subtract": _rule("-"),
    "multiply": _rule("*"),
    "divide": _rule("/"),
    "true_divide": _rule("/"),
    "power": _rule("^"),
    "float_power": _rule("^"),
    "pow": _rule("^"),
    "negative": _rule("negate"),
    "positive": lambda x: x,
    "absolute": _rule("abs"),
    "fabs": _rule("abs"),
    "abs": _rule("abs"),
    "square": lambda x: x * x,
    "reciprocal": lambda x: 1.0 / x,
    "sqrt": _rule("sqrt"),
    "exp": _rule("exp"),
    "exp2": lambda x: 2.0**x,
    # Without cancellation next to 0, and finite far from it.
    "expm1": lambda x: node("tanh", 0.5 * x) * (node("exp", x) + 1.0),
    "log": _rule("ln"),
    "log10": _rule("log10"),
    "log2": _rule("log2"),
    "sin": _rule("sin"),
    "cos": _rule("cos"),
    "tan": _rule("tan"),
    "arcsin": _rule("asin"),
    "asin": _rule("asin"),
    "arccos": _rule("acos"),
    "acos": _rule("acos"),
    "arctan": _rule("atan"),
    "atan": _rule("atan"),
    "arctan2": _rule("atan2"),
    "atan2": _rule("atan2"),
    "sinh": _rule("sinh"),
    "cosh": _rule("cosh"),
    "tanh": _rule("tanh"),
    "hypot": lambda x, y: node("sqrt", x * x + y * y),
    "floor": _rule("flr"),
    "ceil": _rule("ceil"),
    "sign": _rule("sign"),
    "heaviside": lambda x, at_zero: node("select", x > 0, 1.0, node("select", x == 0, at_zero, 0.0)),
    "maximum": _greater_of,
    "fmax": _greater_of,
    "minimum": _lesser_of,
    "fmin": _lesser_of,
    "greater": _rule(">"),
    "greater_equal": _rule(">="),
    "less": _rule("<"),
    "less_equal": _rule("<="),
    "equal": _rule("=="),
    "not_equal": _rule("!="),
    "logical_and": _of_truths("&"),
    "logical_or": _of_truths("|"),
    "logical_xor": _of_truths("!="),
    "logical_not": _of_truths("not"),
    "invert": lambda x: node("negate", x) - 1.0,
    "conjugate": lambda x: x,
    "deg2rad": _times(math.pi / 180.0),
    "radians": _times(math.pi / 180.0),
    "rad2deg": _times(180.0 / math.pi),
    "degrees": _times(180.0 / math.pi),
    # Of scipy.special and math.
    "erf": _rule("erf"),
    "erfc": _rule("erfc"),
    "expit": lambda x: 1.0 / (1.0 + node("exp", -x)),
}

#: For truth values that give truth values.
TRUTHS: dict[str, Callable[..., Any]] = {
    "add": _rule("|"),
    "maximum": _rule("|"),
    "fmax": _rule("|"),
    "logical_or": _rule("|"),
    "bitwise_or": _rule("|"),
    "multiply": _rule("&"),
    "minimum": _rule("&"),
    "fmin": _rule("&"),
    "logical_and": _rule("&"),
    "bitwise_and": _rule("&"),
    "bitwise_xor": _rule("!="),
    "logical_xor": _rule("!="),
    "logical_not": _rule("not"),
    "invert": _rule("not"),
    "absolute": lambda x: x,
    "positive": lambda x: x,
    "square": lambda x: x,
}

#: What to write in place of a function without a rule.
REMEDIES = {
    "remainder": REMAINDER,
    "mod": REMAINDER,
    "fmod": REMAINDER,
    "floor_divide": "write np.floor(a/b)",
    "log1p": "write np.log(1 + x)",
    "arcsinh": "write np.log(x + np.sqrt(x*x + 1))",
    "asinh": "write np.log(x + np.sqrt(x*x + 1))",
    "arccosh": "write np.log(x + np.sqrt(x*x - 1))",
    "acosh": "write np.log(x + np.sqrt(x*x - 1))",
    "arctanh": "write 0.5*np.log((1 + x)/(1 - x))",
    "atanh": "write 0.5*np.log((1 + x)/(1 - x))",
    "cbrt": "write np.sign(x)*np.abs(x)**(1/3); it has no derivative at 0",
    "round": "write np.floor(x + 0.5)",
    "around": "write np.floor(x + 0.5)",
    "rint": "write np.floor(x + 0.5)",
    "interp": "write np.where for its pieces, or a smooth function",
    "piecewise": "write np.where or np.select",
    "linspace": "write a + (b - a)*np.linspace(0, 1, n)",
    "gradient": "write differences of slices: (x[2:] - x[:-2])/(2*h)",
    "at": "write a loop over the indices",
    "argmax": "indices must not depend on states and parameters",
    "argmin": "indices must not depend on states and parameters",
    "argsort": "indices must not depend on states and parameters",
    "nonzero": "write np.where(condition, a, b)",
    "sort": "an order must not depend on states and parameters; write np.minimum and np.maximum",
    "apply_along_axis": "write a loop over the rows",
}


def no_rule(name: str) -> NotTraceable:
    short = name.rpartition(".")[2]
    remedy = REMEDIES.get(short, "write it by arithmetic and the functions that have one: sin, exp, log, sqrt, tanh, where, ..")
    return refusal(f"the function {name} has no rule", remedy)


def of_numbers(name: str, values: tuple[Any, ...]) -> Any:
    """Records an element-wise function of numbers, of which one at least is a symbol."""
    return RULES[name](*[typed(value, np.float64) if type(value) is Symbol else value for value in values])
