"""Python functions as models: a function is called once with symbols in place of numbers, which record what is done with them.

A symbol is a value of the recording. Arrays of symbols are :class:`SymbolArray`, which answer to NumPy's functions. So that functions
that make arrays, and those of :mod:`math`, know symbols too, the function is called with its modules replaced, and so are the functions
of Python that it calls: the code is the same, the names in it are bound to something else.
"""

from __future__ import annotations

import builtins
import functools
import linecache
import math
import operator
import os
import sys
import types
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from . import _native
from .errors import NotTraceable
from .models import Parameters

#: Largest system for ``np.linalg.solve``: what is written out grows with the cube of its size.
LARGEST_SYSTEM = 8

_HERE = os.path.dirname(os.path.abspath(__file__))
_NUMPY = os.path.dirname(os.path.abspath(np.__file__))

CHOICE = "write np.where(condition, a, b), np.minimum or np.maximum in place of it; loops must not depend on values"


def refusal(what: str, remedy: str) -> NotTraceable:
    """What is refused, with the place in the function that is recorded."""
    frame: types.FrameType | None = sys._getframe(1)
    while frame is not None:
        file = frame.f_code.co_filename
        if not file.startswith((_HERE + os.sep, _NUMPY + os.sep, "<__array_function__")):
            break
        frame = frame.f_back
    if frame is None:
        return NotTraceable(f"{what}; {remedy}", key=what, allowed=remedy)
    file, line = frame.f_code.co_filename, frame.f_lineno
    code = linecache.getline(file, line).strip()
    message = f"{file}, line {line}: {what}; {remedy}" + (f"\n    {code}" if code else "")
    error = NotTraceable(message, key=what, value=code or None, allowed=remedy)
    error.filename, error.line = file, line
    return error


class Recording:
    """The operations of a function, in their order; equal ones once."""

    def __init__(self, leaves: int) -> None:
        self.leaves = leaves
        self.operations: list[tuple[str, list[int], float]] = []
        self.known: dict[tuple[str, tuple[int, ...], str], int] = {}

    def add(self, name: str, operands: tuple[int, ...], value: float = 0.0) -> Symbol:
        key = (name, operands, value.hex())
        index = self.known.get(key)
        if index is None:
            index = self.leaves + len(self.operations)
            self.operations.append((name, list(operands), value))
            self.known[key] = index
        return Symbol(self, index)

    def symbol(self, value: Any) -> Symbol:
        """A number as a symbol."""
        if isinstance(value, Symbol):
            if value.recording is not self:
                raise refusal("a value of another recording", "a right-hand side must not keep values from one call to the next")
            return value
        if isinstance(value, np.ndarray) and value.ndim == 0:
            return self.symbol(value.item())
        if isinstance(value, (bool, np.bool_, int, np.integer, float, np.floating)):
            number = float(value)
            if not math.isfinite(number):
                raise refusal(f"the number {number}", "numbers in a right-hand side must be finite")
            return self.add("constant", (), number)
        if isinstance(value, (complex, np.complexfloating)):
            raise refusal("a complex number", "write real and imaginary parts as states of their own")
        raise refusal(f"a value of type {type(value).__name__}", "use numbers, arrays and NumPy's functions")


def _is_number(value: Any) -> bool:
    return isinstance(value, (bool, int, float, np.bool_, np.integer, np.floating))


def apply(name: str, *values: Any) -> Symbol:
    """Records an operation."""
    recording = next(value.recording for value in values if isinstance(value, Symbol))
    return recording.add(name, tuple(recording.symbol(value).index for value in values))


def _binary(name: str, swapped: bool = False) -> Callable[[Any, Any], Any]:
    def method(self: Symbol, other: Any) -> Any:
        if isinstance(other, np.ndarray) and other.ndim > 0:
            return NotImplemented
        if not isinstance(other, Symbol) and not _is_number(other) and not isinstance(other, np.ndarray):
            if isinstance(other, (list, tuple)):
                raise refusal(f"{name} with a {type(other).__name__}", "make an array of it by np.array")
            return NotImplemented
        return apply(name, other, self) if swapped else apply(name, self, other)

    return method


def _refusing(what: str, remedy: str) -> Callable[..., Any]:
    def method(self: Symbol, *_: Any) -> Any:
        raise refusal(what, remedy)

    return method


REMAINDER = "write x - n*np.floor(x/n); a remainder jumps, and so does the right-hand side"


class Symbol:
    """A value that is recorded."""

    __slots__ = ("index", "recording")
    __array_priority__ = 1000.0

    def __init__(self, recording: Recording, index: int) -> None:
        self.recording = recording
        self.index = index

    __add__ = _binary("+")
    __radd__ = _binary("+", True)
    __sub__ = _binary("-")
    __rsub__ = _binary("-", True)
    __mul__ = _binary("*")
    __rmul__ = _binary("*", True)
    __truediv__ = _binary("/")
    __rtruediv__ = _binary("/", True)
    __pow__ = _binary("^")
    __rpow__ = _binary("^", True)
    __lt__ = _binary("<")
    __le__ = _binary("<=")
    __gt__ = _binary(">")
    __ge__ = _binary(">=")
    __eq__ = _binary("==")
    __ne__ = _binary("!=")
    __and__ = _binary("&")
    __rand__ = _binary("&", True)
    __or__ = _binary("|")
    __ror__ = _binary("|", True)
    __mod__ = __rmod__ = __divmod__ = __rdivmod__ = _refusing("the remainder %", REMAINDER)
    __floordiv__ = __rfloordiv__ = _refusing("the division //", "write np.floor(a/b)")
    __xor__ = __rxor__ = _refusing("the operator ^", "powers are written with **")
    __bool__ = _refusing("a choice by a value that is not known before", CHOICE)
    __index__ = _refusing("an index or a count that depends on a value", "indices must not depend on states and parameters")
    __int__ = __trunc__ = _refusing("a value made a whole number", "write np.floor")
    __round__ = _refusing("the function round", "write np.floor(x + 0.5)")
    __float__ = _refusing(
        "a value made a number (by a function that is not recorded, or put into an array of numbers)",
        "call NumPy's functions and those of math by their names in this function, and make arrays by np.zeros or np.array there",
    )
    __complex__ = _refusing("a complex number", "write real and imaginary parts as states of their own")
    __iter__ = _refusing("a loop over a single value", "states are in the array x, parameters in p")
    __hash__ = _refusing("a value as a key of a dictionary or a set", "keys must not depend on states and parameters")

    def __neg__(self) -> Symbol:
        return apply("negate", self)

    def __pos__(self) -> Symbol:
        return self

    def __abs__(self) -> Symbol:
        return apply("abs", self)

    def __invert__(self) -> Symbol:
        return apply("not", self)

    def __repr__(self) -> str:
        return f"<value {self.index}>"

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        return _ufunc(ufunc, method, inputs, keywords)

    def __array_function__(self, function: Any, types: Any, arguments: Any, keywords: Any) -> Any:
        return _array_function(function, arguments, keywords)

    # What is asked of the elements of arrays, and of numbers.
    shape: tuple[()] = ()
    ndim = 0
    size = 1

    @property
    def real(self) -> Symbol:
        return self

    def item(self) -> Symbol:
        return self

    def copy(self) -> Symbol:
        return self

    def conjugate(self) -> Symbol:
        return self


def _rule(name: str) -> Callable[..., Any]:
    return lambda *values: apply(name, *values)


def _clip(value: Any, low: Any, high: Any) -> Any:
    if low is not None:
        value = SCALAR["maximum"](value, low)
    return value if high is None else SCALAR["minimum"](value, high)


def _power(base: Any, exponent: Any) -> Any:
    return base**exponent


#: What NumPy's element-wise functions record, by their names.
RULES: dict[str, Callable[..., Any]] = {
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "divide": operator.truediv,
    "true_divide": operator.truediv,
    "power": _power,
    "float_power": _power,
    "pow": _power,
    "negative": operator.neg,
    "positive": operator.pos,
    "absolute": operator.abs,
    "fabs": operator.abs,
    "abs": operator.abs,
    "square": lambda x: x * x,
    "reciprocal": lambda x: 1.0 / x,
    "sqrt": _rule("sqrt"),
    "exp": _rule("exp"),
    "exp2": lambda x: 2.0**x,
    "expm1": lambda x: 2.0 * apply("sinh", 0.5 * x) * apply("exp", 0.5 * x),
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
    "hypot": lambda x, y: apply("sqrt", x * x + y * y),
    "floor": _rule("flr"),
    "ceil": _rule("ceil"),
    "sign": _rule("sign"),
    "heaviside": lambda x, at_zero: apply("select", x > 0, 1.0, apply("select", x == 0, at_zero, 0.0)),
    "maximum": _rule("max"),
    "fmax": _rule("max"),
    "minimum": _rule("min"),
    "fmin": _rule("min"),
    "greater": operator.gt,
    "greater_equal": operator.ge,
    "less": operator.lt,
    "less_equal": operator.le,
    "equal": operator.eq,
    "not_equal": operator.ne,
    "logical_and": operator.and_,
    "bitwise_and": operator.and_,
    "logical_or": operator.or_,
    "bitwise_or": operator.or_,
    "logical_not": operator.invert,
    "invert": operator.invert,
    "conjugate": operator.pos,
    "deg2rad": lambda x: x * (math.pi / 180.0),
    "radians": lambda x: x * (math.pi / 180.0),
    "rad2deg": lambda x: x * (180.0 / math.pi),
    "degrees": lambda x: x * (180.0 / math.pi),
    # Of scipy.special and math.
    "erf": _rule("erf"),
    "erfc": _rule("erfc"),
    "expit": lambda x: 1.0 / (1.0 + apply("exp", -x)),
    "clip": _clip,
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
}


def _no_rule(name: str) -> NotTraceable:
    remedy = REMEDIES.get(name, "write it by arithmetic and the functions that have one: sin, exp, log, sqrt, tanh, where, .."
    )
    return refusal(f"the function {name} has no rule", remedy)


def _scalar(name: str, plain: Callable[..., Any]) -> Callable[..., Any]:
    """A function of numbers and symbols."""
    rule = RULES[name]

    def function(*values: Any) -> Any:
        if any(isinstance(value, Symbol) for value in values):
            return rule(*values)
        return plain(*values)

    return function


SCALAR: dict[str, Callable[..., Any]] = {
    name: _scalar(name, getattr(np, name, None) or getattr(math, name, None) or RULES[name]) for name in RULES
}


def _select(condition: Any, yes: Any, no: Any) -> Any:
    if isinstance(condition, Symbol):
        return apply("select", condition, yes, no)
    return yes if condition else no


def _plain(value: Any) -> Any:
    """Arrays without their class; lists with symbols in them as arrays."""
    if isinstance(value, SymbolArray):
        return value.view(np.ndarray)
    if isinstance(value, (list, tuple)):
        return np.asarray(array(value)) if _has_symbols(value) else np.asarray(value)
    return value


def _has_symbols(value: Any) -> bool:
    if isinstance(value, (Symbol, SymbolArray)):
        return True
    if isinstance(value, np.ndarray):
        return bool(value.dtype == object)
    return isinstance(value, (list, tuple)) and any(_has_symbols(entry) for entry in value)


def _wrapped(value: Any) -> Any:
    if isinstance(value, np.ndarray) and value.dtype == object:
        return value.item() if value.ndim == 0 else value.view(SymbolArray)
    return value


@functools.cache
def _elementwise(name: str, inputs: int) -> np.ufunc:
    function: np.ufunc = np.frompyfunc(SCALAR[name], inputs, 1)
    return function


def _ufunc(ufunc: np.ufunc, method: str, inputs: tuple[Any, ...], keywords: dict[str, Any]) -> Any:
    name = ufunc.__name__
    plain = [_boxed(value) for value in inputs]
    if name == "matmul" and method == "__call__":
        return _wrapped(np.matmul(*plain))
    if name not in RULES:
        raise _no_rule(name)
    out = keywords.pop("out", None)
    keywords.pop("dtype", None)
    if keywords.get("where", True) is not True:
        raise refusal("the keyword where of an element-wise function", "write np.where(condition, a, b)")
    keywords.pop("where", None)
    keywords.pop("casting", None)
    keywords.pop("subok", None)
    function = _elementwise(name, ufunc.nin)
    if method == "reduce" and name in ("add", "multiply"):
        function = ufunc
    result = getattr(function, method)(*plain, **keywords)
    if out is not None:
        (target,) = out if isinstance(out, tuple) else (out,)
        if target.dtype != object:
            raise refusal(
                "a value put into an array of numbers", "make the array in this function by np.zeros, np.empty or np.zeros_like(x)"
            )
        target.view(np.ndarray)[...] = result
        return target
    return _wrapped(result)


def _boxed(value: Any) -> Any:
    """A symbol as an array of one object: NumPy would ask it what it is."""
    if isinstance(value, Symbol):
        box = np.empty((), dtype=object)
        box[()] = value
        return box
    return _plain(value)


def _where(condition: Any, yes: Any = None, no: Any = None) -> Any:
    if yes is None or no is None:
        raise refusal("np.where with a condition only", "its result would depend on values; give both np.where(condition, a, b)")
    return _wrapped(np.frompyfunc(_select, 3, 1)(_boxed(condition), _boxed(yes), _boxed(no)))


def _solve(matrix: Any, right: Any) -> Any:
    """The solution of a linear system by elimination, with the pivots on the diagonal: mass matrices have them there."""
    rows = [list(row) for row in _plain(matrix)]
    size = len(rows)
    if size > LARGEST_SYSTEM or any(len(row) != size for row in rows):
        raise refusal(
            f"a linear system with a matrix of shape {np.shape(_plain(matrix))}",
            f"square ones of up to {LARGEST_SYSTEM} rows can be written out",
        )
    solution = np.array(_plain(right), dtype=object)
    for pivot in range(size):
        for row in range(pivot + 1, size):
            entry = rows[row][pivot]
            if _is_number(entry) and entry == 0:
                continue
            factor = entry / rows[pivot][pivot]
            rows[row] = [below - factor * above for below, above in zip(rows[row], rows[pivot], strict=True)]
            solution[row] = solution[row] - factor * solution[pivot]
    for row in reversed(range(size)):
        for column in range(row + 1, size):
            solution[row] = solution[row] - rows[row][column] * solution[column]
        solution[row] = solution[row] / rows[row][row]
    return _wrapped(solution)


def _norm(value: Any, ord: Any = None) -> Any:
    if ord not in (None, 2):
        raise refusal(f"np.linalg.norm with ord={ord!r}", "write it by np.sum, np.abs and np.maximum")
    flat = np.ravel(_plain(value))
    return SCALAR["sqrt"](functools.reduce(operator.add, [entry * entry for entry in flat]))


def _reduced(name: str) -> Callable[..., Any]:
    def function(values: Any, axis: Any = None, **keywords: Any) -> Any:
        if keywords:
            raise refusal(f"np.{name} with {', '.join(keywords)}", "only axis can be given")
        array = np.asarray(_plain(values))
        if axis is None:
            array, axis = array.ravel(), 0
        return _wrapped(_elementwise({"max": "maximum", "min": "minimum"}[name], 2).reduce(array, axis=axis))

    return function


def _clipped(values: Any, low: Any = None, high: Any = None, **keywords: Any) -> Any:
    low, high = keywords.pop("min", low), keywords.pop("max", high)
    result = values
    if low is not None:
        result = _ufunc(np.maximum, "__call__", (result, low), {})
    return result if high is None else _ufunc(np.minimum, "__call__", (result, high), {})


def _choose(conditions: Any, choices: Any, default: Any = 0) -> Any:
    """``np.select``: the first choice whose condition holds."""
    result = default
    for condition, choice in reversed(list(zip(conditions, choices, strict=True))):
        result = _where(condition, choice, result)
    return result


#: Functions that NumPy would do by values.
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "where": _where,
    "select": _choose,
    "solve": _solve,
    "norm": _norm,
    "max": _reduced("max"),
    "amax": _reduced("max"),
    "min": _reduced("min"),
    "amin": _reduced("min"),
    "clip": _clipped,
}
#: Functions that only move entries, or that NumPy does by additions and multiplications.
PLAIN = frozenset(
    "sum prod mean dot vdot inner outer tensordot einsum cross trace diagonal diag cumsum concatenate stack vstack hstack dstack column_stack"
    " block reshape ravel transpose swapaxes moveaxis roll flip fliplr flipud rot90 repeat tile take squeeze expand_dims"
    " broadcast_to broadcast_arrays atleast_1d atleast_2d atleast_3d split array_split append insert delete copy zeros_like empty_like ones_like"
    " full_like shape ndim size diff gradient convolve matmul ediff1d pad kron tril triu".split()
)


def _array_function(function: Any, arguments: Any, keywords: Any) -> Any:
    name = function.__name__
    if name in FUNCTIONS:
        return FUNCTIONS[name](*arguments, **keywords)
    if name not in PLAIN:
        raise _no_rule(f"np.{name}")
    if name in ("zeros_like", "empty_like", "ones_like", "full_like"):
        keywords = {**keywords, "dtype": object}

    def stripped(value: Any) -> Any:
        if isinstance(value, (list, tuple)):
            return type(value)(stripped(entry) for entry in value) if _has_symbols(value) else value
        return _boxed(value)

    result = function(*map(stripped, arguments), **{key: stripped(value) for key, value in keywords.items()})
    if isinstance(result, (list, tuple)):
        return type(result)(_wrapped(entry) for entry in result)
    return _wrapped(result)


class SymbolArray(np.ndarray):
    """An array of symbols and numbers."""

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        return _ufunc(ufunc, method, inputs, keywords)

    def __array_function__(self, function: Any, types: Any, arguments: Any, keywords: Any) -> Any:
        return _array_function(function, arguments, keywords)

    def __setitem__(self, key: Any, value: Any) -> None:
        self.view(np.ndarray)[key] = _boxed(value) if isinstance(value, Symbol) else _plain(value)

    def __getitem__(self, key: Any) -> Any:
        return _wrapped(self.view(np.ndarray)[key])

    def __iter__(self) -> Any:
        return (self[index] for index in range(len(self)))

    def sum(self, axis: Any = None, **keywords: Any) -> Any:  # type: ignore[override]
        return np.sum(self, axis=axis, **keywords)

    def mean(self, axis: Any = None, **keywords: Any) -> Any:  # type: ignore[override]
        return np.sum(self, axis=axis, **keywords) / (self.size if axis is None else self.shape[axis])

    def dot(self, other: Any, out: Any = None) -> Any:
        return np.dot(self, other)

    def max(self, axis: Any = None) -> Any:  # type: ignore[override]
        return FUNCTIONS["max"](self, axis)

    def min(self, axis: Any = None) -> Any:  # type: ignore[override]
        return FUNCTIONS["min"](self, axis)

    def clip(self, low: Any = None, high: Any = None, **keywords: Any) -> Any:  # type: ignore[override]
        return _clipped(self, low, high, **keywords)

    def astype(self, dtype: Any, *_: Any, **__: Any) -> Any:
        if np.dtype(dtype).kind not in "fO":
            raise refusal(f"values made {np.dtype(dtype)}", "values are real numbers")
        return self.copy()

    def tolist(self) -> Any:
        return self.view(np.ndarray).tolist()


def array(values: Any, dtype: Any = None, **keywords: Any) -> Any:
    """``np.array`` that takes symbols, and whose arrays take symbols."""
    if dtype is not None and np.dtype(dtype).kind not in "fO":
        return np.array(values, dtype=dtype, **keywords)
    if isinstance(values, Symbol):
        return values
    if isinstance(values, (list, tuple)) and any(isinstance(entry, (SymbolArray, np.ndarray, list, tuple)) for entry in values):
        rows = [np.asarray(_plain(array(entry))) if not isinstance(entry, Symbol) else entry for entry in values]
        shapes = {np.shape(row) for row in rows}
        if len(shapes) != 1:
            raise refusal("an array of rows that differ in length", "rows of an array have equal lengths")
        result = np.empty((len(rows), *shapes.pop()), dtype=object)
        for index, row in enumerate(rows):
            result[index] = row
        return result.view(SymbolArray)
    return np.array(_plain(values) if isinstance(values, np.ndarray) else values, dtype=object).view(SymbolArray)


def _created(function: Callable[..., Any]) -> Callable[..., Any]:
    def create(*arguments: Any, dtype: Any = None, **keywords: Any) -> Any:
        if dtype is not None and np.dtype(dtype).kind not in "fO":
            return function(*arguments, dtype=dtype, **keywords)
        return function(*arguments, dtype=object, **keywords).view(SymbolArray)

    return create


def _filled(shape: Any, value: Any, dtype: Any = None) -> Any:
    result = np.empty(shape, dtype=object).view(SymbolArray)
    result[...] = value
    return result


#: What NumPy's functions that make arrays are replaced by.
CREATION: dict[str, Callable[..., Any]] = {
    "array": array,
    "asarray": array,
    "asanyarray": array,
    "ascontiguousarray": array,
    "zeros": _created(np.zeros),
    "empty": _created(np.zeros),
    "ones": _created(np.ones),
    "eye": _created(np.eye),
    "identity": _created(np.identity),
    "full": _filled,
    "float64": lambda value=0.0: value if isinstance(value, Symbol) else np.float64(value),
}


def _of_numpy(name: str, function: Any) -> Any:
    """A function of NumPy that knows symbols in lists too."""
    if name in CREATION:
        return CREATION[name]
    if isinstance(function, np.ufunc):

        def elementwise(*values: Any, **keywords: Any) -> Any:
            if any(_has_symbols(value) for value in values):
                return _ufunc(function, "__call__", values, keywords)
            return function(*values, **keywords)

        elementwise.reduce = lambda values, *a, **k: _ufunc(function, "reduce", (values, *a), k)  # type: ignore[attr-defined]
        elementwise.accumulate = lambda values, *a, **k: _ufunc(function, "accumulate", (values, *a), k)  # type: ignore[attr-defined]
        elementwise.outer = lambda *values, **k: _ufunc(function, "outer", values, k)  # type: ignore[attr-defined]
        return elementwise
    if callable(function) and not isinstance(function, type):

        def general(*arguments: Any, **keywords: Any) -> Any:
            if any(_has_symbols(value) for value in [*arguments, *keywords.values()]):
                return _array_function(function, arguments, keywords)
            return function(*arguments, **keywords)

        return general
    return function


class Replaced:
    """A module of functions that know symbols."""

    def __init__(self, module: types.ModuleType, function: Callable[[str, Any], Any]) -> None:
        self._module = module
        self._function = function

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._module, name)
        if isinstance(value, types.ModuleType):
            return replaced_module(value) or value
        return self._function(name, value)


def _of_math(name: str, function: Any) -> Any:
    if not callable(function):
        return function

    def scalar(*values: Any) -> Any:
        if any(isinstance(value, np.ndarray) and value.dtype == object for value in values):
            values = tuple(value.item() if isinstance(value, np.ndarray) else value for value in values)
        if not any(isinstance(value, Symbol) for value in values):
            return function(*values)
        if name == "log" and len(values) == 2:
            return apply("ln", values[0]) / (apply("ln", values[1]) if isinstance(values[1], Symbol) else math.log(values[1]))
        if name == "fsum":
            return functools.reduce(operator.add, values[0])
        if name not in RULES:
            raise _no_rule(f"math.{name}") if name not in REMEDIES else _no_rule(name)
        return RULES[name](*values)

    return scalar


def replaced_module(module: types.ModuleType) -> Replaced | None:
    """What a module is replaced by, if it is one of those that are."""
    name = module.__name__
    if name == "math":
        return Replaced(module, _of_math)
    if name in ("numpy", "numpy.linalg", "jax.numpy", "jax.numpy.linalg", "scipy.special", "autograd.numpy"):
        return Replaced(np if name.endswith(".numpy") else module, _of_numpy)
    return None


class Rebinding:
    """Functions with their modules, and the functions that they call, replaced."""

    def __init__(self) -> None:
        self.done: dict[int, Any] = {}
        #: What was replaced must not be freed, or another would have its identity.
        self.kept: list[Any] = []

    def value(self, value: Any) -> Any:
        """What a name is bound to."""
        if isinstance(value, types.ModuleType):
            return replaced_module(value) or value
        if isinstance(value, np.ufunc):
            return _of_numpy(value.__name__, value)
        if isinstance(value, types.BuiltinFunctionType) and getattr(value, "__module__", None) == "math":
            return _of_math(value.__name__, value)
        if isinstance(value, (types.FunctionType, types.BuiltinFunctionType)) or type(value).__name__ == "_ArrayFunctionDispatcher":
            module = getattr(value, "__module__", "") or ""
            if module.split(".")[0] == "numpy":
                return _of_numpy(value.__name__, value)
        if isinstance(value, np.ndarray) and value.dtype == object:
            return value.view(SymbolArray)
        return self.callable(value)

    def callable(self, value: Any) -> Any:
        """A function of Python."""
        if isinstance(value, types.MethodType):
            return types.MethodType(self.callable(value.__func__), value.__self__)
        if isinstance(value, functools.partial):
            return functools.partial(self.callable(value.func), *value.args, **value.keywords)
        inner = getattr(value, "py_func", None) or (getattr(value, "__wrapped__", None) if not isinstance(value, type) else None)
        if isinstance(inner, types.FunctionType):
            return self.callable(inner)
        if not isinstance(value, types.FunctionType):
            return value
        if id(value) in self.done:
            return self.done[id(value)]
        names: dict[str, Any] = dict(value.__globals__)
        cells = None
        if value.__closure__ is not None:
            cells = tuple(types.CellType() for _ in value.__closure__)
        function = types.FunctionType(value.__code__, names, value.__name__, value.__defaults__, cells)
        function.__kwdefaults__ = value.__kwdefaults__
        self.done[id(value)] = function
        self.kept.append(value)
        for name in _names(value.__code__):
            if name in names:
                names[name] = self.value(names[name])
        for builtin, why in (("min", "np.minimum"), ("max", "np.maximum")):
            if builtin not in value.__globals__:
                names[builtin] = _builtin(builtin, why)
        for own, cell in zip(cells or (), value.__closure__ or (), strict=True):
            try:
                own.cell_contents = self.value(cell.cell_contents)
            except ValueError:
                continue  # a name that has no value yet
        return function


def _builtin(name: str, remedy: str) -> Callable[..., Any]:
    plain = getattr(builtins, name)

    def function(*values: Any, **keywords: Any) -> Any:
        inside = values[0] if len(values) == 1 else values
        if isinstance(inside, Symbol) or _has_symbols(list(inside)):
            raise refusal(f"the function {name} of Python", f"write {remedy}(a, b) in place of it")
        return plain(*values, **keywords)

    return function


def _names(code: types.CodeType) -> set[str]:
    """Global names in a code and those inside it."""
    names = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            names |= _names(constant)
    return names


def _derivatives(result: Any, states: Mapping[str, float]) -> list[Any]:
    if isinstance(result, Mapping):
        wrong = set(result) ^ set(states)
        if wrong:
            raise NotTraceable(
                f"the function returns derivatives of {', '.join(map(str, result))}; allowed: those of {', '.join(states)}",
                key=", ".join(sorted(map(str, wrong))),
            )
        return [result[name] for name in states]
    if isinstance(result, Symbol) or _is_number(result):
        result = [result]
    if result is None:
        raise NotTraceable("the function returns nothing; it must return the derivatives", key="return")
    derivatives = list(np.asarray(_plain(result), dtype=object).ravel()) if not isinstance(result, list) else result
    if len(derivatives) != len(states):
        raise NotTraceable(
            f"the function returns {len(derivatives)} derivatives; allowed: {len(states)}, one for each state",
            key="return",
            value=str(len(derivatives)),
            allowed=str(len(states)),
        )
    return [entry.item() if isinstance(entry, np.ndarray) and entry.size == 1 else entry for entry in derivatives]


def trace(function: Callable[[Any, Any], Any], states: Mapping[str, float], parameters: Mapping[str, float]) -> str:
    """The text of the model of a function."""
    if not states:
        raise NotTraceable("a model needs states; allowed: at least one name", key="states")
    recording = Recording(len(states) + len(parameters))
    state = np.empty(len(states), dtype=object)
    state[:] = [Symbol(recording, index) for index in range(len(states))]
    values = {name: Symbol(recording, len(states) + index) for index, name in enumerate(parameters)}
    rebinding = Rebinding()
    called = rebinding.callable(function)
    if called is function and not isinstance(function, type) and hasattr(function, "__call__"):
        method = getattr(type(function), "__call__", None)
        if isinstance(method, types.FunctionType):
            called = types.MethodType(rebinding.callable(method), function)
    result = called(state.view(SymbolArray), Parameters(values))
    derivatives = [recording.symbol(entry).index for entry in _derivatives(result, states)]
    return _native.build_model(list(states.items()), list(parameters.items()), recording.operations, derivatives)
