"""Values that are recorded in place of numbers.

A symbol knows the type that the number would have (:class:`numpy.float64`, :class:`bool`, ..): which operation a sign means depends on it, as
``+`` of two truth values of NumPy is *or*. The type of a result is asked of Python and NumPy, by the same operation on ones.
"""

from __future__ import annotations

import functools
import linecache
import math
import operator
import os
import sys
import threading
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from ..errors import NotTraceable

_HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
_NUMPY = os.path.dirname(os.path.abspath(np.__file__))
_OWN = (_HERE + os.sep, _NUMPY + os.sep, "<__array_function__", "<frozen ")

CHOICE = "write np.where(condition, a, b), np.minimum or np.maximum in place of it; loops must not depend on values"
REMAINDER = "write x - n*np.floor(x/n); a remainder jumps, and so does the right-hand side"
REAL = "write real and imaginary parts as states of their own"

_active = threading.local()


def is_users(file: str) -> bool:
    """Whether code of this file is the user's, neither of this package nor of NumPy."""
    return not file.startswith(_OWN)


def refused_at(what: str, remedy: str, file: str, line: int) -> NotTraceable:
    code = linecache.getline(file, line).strip()
    message = f"{file}, line {line}: {what}; {remedy}" + (f"\n    {code}" if code else "")
    error = NotTraceable(message, key=what, value=code or None, allowed=remedy)
    error.filename, error.line = file, line
    return error


def refusal(what: str, remedy: str) -> NotTraceable:
    """What is refused, with the place in the function that is recorded. The recording remembers it: the function may catch it."""
    frame: types.FrameType | None = sys._getframe(1)
    while frame is not None and not is_users(frame.f_code.co_filename):
        frame = frame.f_back
    if frame is None:
        error = NotTraceable(f"{what}; {remedy}", key=what, allowed=remedy)
    else:
        error = refused_at(what, remedy, frame.f_code.co_filename, frame.f_lineno)
    recording = getattr(_active, "recording", None)
    if recording is not None:
        recording.refused.append(error)
    return error


class Recording:
    """The operations of a function, in their order; equal ones once."""

    def __init__(self, leaves: int) -> None:
        self.leaves = leaves
        self.operations: list[tuple[str, list[int], float]] = []
        self.known: dict[tuple[str, tuple[int, ...], str], int] = {}
        #: What was refused, though the function may have caught it.
        self.refused: list[NotTraceable] = []

    @contextmanager
    def active(self) -> Iterator[None]:
        before = getattr(_active, "recording", None)
        _active.recording = self
        try:
            yield
        finally:
            _active.recording = before

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
        if type(value) is Symbol:
            if value.recording is not self:
                raise refusal("a value of another recording", "a right-hand side must not keep values from one call to the next")
            return value
        if isinstance(value, np.ndarray) and value.ndim == 0:
            return self.symbol(value[()] if value.dtype != object else value.view(np.ndarray).item())
        if is_number(value):
            number = float(value)
            if not math.isfinite(number):
                raise refusal(f"the number {number}", "numbers in a right-hand side must be finite")
            return self.add("constant", (), number)
        if isinstance(value, (complex, np.complexfloating)):
            raise refusal("a complex number", REAL)
        raise refusal(f"a value of type {type(value).__name__}", "use numbers, arrays and NumPy's functions")


def is_number(value: Any) -> bool:
    """Whether it is a real number; symbols are none."""
    return type(value) is not Symbol and isinstance(value, (bool, int, float, np.bool_, np.integer, np.floating))


def node(name: str, *values: Any) -> Symbol:
    """Records an operation."""
    recording = next(value.recording for value in values if type(value) is Symbol)
    return recording.add(name, tuple(recording.symbol(value).index for value in values))


def typed(value: Any, kind: Any) -> Any:
    """A symbol or a number with this type."""
    if type(value) is Symbol:
        return value if value.type is kind else Symbol(value.recording, value.index, kind)
    return kind(value)


def type_of(value: Any) -> Any:
    return value.type if type(value) is Symbol else type(value)


def known_type(kind: Any) -> Any:
    """The type of a result, where it is one of those that are recorded."""
    if kind in (bool, int, float, np.bool_, np.int64, np.float64):
        return kind
    if issubclass(kind, np.integer):
        return np.int64
    if issubclass(kind, (complex, np.complexfloating)):
        raise refusal("a complex number", REAL)
    if issubclass(kind, np.floating):
        raise refusal(f"a result in {kind.__name__}", "only numbers of double precision are recorded: leave out dtype, and write 1.0*condition")
    return None


@functools.cache
def _result_type(function: Callable[..., Any], types: tuple[Any, ...]) -> Any:
    with np.errstate(all="ignore"):
        return type(function(*[kind(1) for kind in types]))


def _or(a: Any, b: Any) -> Symbol:
    return node("|", a, b)


def _and(a: Any, b: Any) -> Symbol:
    return node("&", a, b)


#: Operators: what is recorded for numbers, and for truth values of NumPy.
OPERATORS: dict[Callable[..., Any], tuple[str, str | None]] = {
    operator.add: ("+", "|"),
    operator.sub: ("-", None),
    operator.mul: ("*", "&"),
    operator.truediv: ("/", None),
    operator.pow: ("^", None),
    operator.lt: ("<", "<"),
    operator.le: ("<=", "<="),
    operator.gt: (">", ">"),
    operator.ge: (">=", ">="),
    operator.eq: ("==", "=="),
    operator.ne: ("!=", "!="),
    operator.and_: ("", "&"),
    operator.or_: ("", "|"),
    operator.xor: ("", "!="),
}


def operate(function: Callable[..., Any], *values: Any) -> Any:
    """What an operator of Python does with symbols and numbers."""
    kind = known_type(_result_type(function, tuple(type_of(value) for value in values)))
    if kind is None:
        return NotImplemented
    number, truth = OPERATORS[function]
    name = truth if kind in (bool, np.bool_) else number
    if not name:
        raise refusal(f"{function.__name__.rstrip('_')} of whole numbers", "bits of numbers are not recorded")
    return typed(node(name, *values), kind)


def _binary(function: Callable[[Any, Any], Any], swapped: bool = False) -> Callable[[Any, Any], Any]:
    def method(self: Symbol, other: Any) -> Any:
        if isinstance(other, np.ndarray):
            if other.ndim > 0:
                return NotImplemented
            other = other[()]
        if isinstance(other, (complex, np.complexfloating)):
            raise refusal("a complex number", REAL)
        if type(other) is not Symbol and not is_number(other):
            if isinstance(other, (list, tuple)) and issubclass(self.type, np.generic):
                raise refusal(f"{function.__name__} with a {type(other).__name__}", "make an array of it by np.array")
            return NotImplemented
        return operate(function, other, self) if swapped else operate(function, self, other)

    return method


def _refusing(what: str, remedy: str) -> Callable[..., Any]:
    def method(self: Symbol, *_: Any) -> Any:
        raise refusal(what, remedy)

    return method


class Symbol:
    """A value that is recorded, of the type that the number would have."""

    __slots__ = ("index", "recording", "type")
    __array_priority__ = 1000.0

    def __init__(self, recording: Recording, index: int, type: Any = np.float64) -> None:
        self.recording = recording
        self.index = index
        self.type = type

    @property
    def __class__(self) -> Any:
        """So that ``isinstance`` answers as for the number."""
        return self.type

    @__class__.setter
    def __class__(self, _: Any) -> None:
        raise TypeError("the class of a value does not change")

    __add__ = _binary(operator.add)
    __radd__ = _binary(operator.add, True)
    __sub__ = _binary(operator.sub)
    __rsub__ = _binary(operator.sub, True)
    __mul__ = _binary(operator.mul)
    __rmul__ = _binary(operator.mul, True)
    __truediv__ = _binary(operator.truediv)
    __rtruediv__ = _binary(operator.truediv, True)
    __pow__ = _binary(operator.pow)
    __rpow__ = _binary(operator.pow, True)
    __lt__ = _binary(operator.lt)
    __le__ = _binary(operator.le)
    __gt__ = _binary(operator.gt)
    __ge__ = _binary(operator.ge)
    __eq__ = _binary(operator.eq)
    __ne__ = _binary(operator.ne)
    __and__ = _binary(operator.and_)
    __rand__ = _binary(operator.and_, True)
    __or__ = _binary(operator.or_)
    __ror__ = _binary(operator.or_, True)
    __xor__ = _binary(operator.xor)
    __rxor__ = _binary(operator.xor, True)
    __mod__ = __rmod__ = __divmod__ = __rdivmod__ = _refusing("the remainder %", REMAINDER)
    __floordiv__ = __rfloordiv__ = _refusing("the division //", "write np.floor(a/b)")
    __bool__ = _refusing("a choice by a value that is not known before", CHOICE)
    __index__ = _refusing("an index or a count that depends on a value", "indices must not depend on states and parameters")
    __int__ = __trunc__ = _refusing(
        "a value made a whole number, or put into an array of whole numbers",
        "write np.floor, and make arrays of numbers with a point: np.array([0.0, 1.0])",
    )
    __round__ = _refusing("the function round", "write np.floor(x + 0.5)")
    __float__ = _refusing(
        "a value made a number (by a function that is not recorded, or put into an array of numbers)",
        "call NumPy's functions and those of math, and make arrays by np.zeros or np.array, in functions, not in methods of objects made inside",
    )
    __complex__ = _refusing("a complex number", REAL)
    __hash__ = _refusing("a value as a key of a dictionary or a set", "keys must not depend on states and parameters")
    __str__ = _refusing("a value made a text", "texts must not depend on states and parameters; print(x) shows what is recorded")

    def __format__(self, form: str) -> str:
        return str(self)

    def __neg__(self) -> Symbol:
        kind = _result_type(operator.neg, (self.type,))
        return Symbol(self.recording, node("negate", self).index, kind)

    def __pos__(self) -> Symbol:
        return Symbol(self.recording, self.index, _result_type(operator.pos, (self.type,)))

    def __abs__(self) -> Symbol:
        kind = _result_type(operator.abs, (self.type,))
        return self if kind is np.bool_ else Symbol(self.recording, node("abs", self).index, kind)

    def __invert__(self) -> Any:
        kind = _result_type(operator.invert, (self.type,))
        if kind is np.bool_:
            return typed(node("not", self), kind)
        return typed(node("-", node("negate", self), 1.0), kind)

    def __floor__(self) -> Symbol:
        return typed(node("flr", self), int)  # type: ignore[no-any-return]

    def __ceil__(self) -> Symbol:
        return typed(node("ceil", self), int)  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        return f"<value {self.index}>"

    def __copy__(self) -> Symbol:
        return self

    def __deepcopy__(self, _: Any) -> Symbol:
        return self

    def __reduce__(self) -> Any:
        raise refusal("a value that is pickled", "values must not leave the function")

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        from .arrays import call_ufunc

        return call_ufunc(ufunc, method, inputs, keywords)

    def __array_function__(self, function: Any, types: Any, arguments: Any, keywords: Any) -> Any:
        from .functions import call_function

        return call_function(function, arguments, keywords)

    def __getattr__(self, name: str) -> Any:
        """What is asked of numbers of NumPy, and what NumPy asks of the entries of arrays of objects: ``value.exp()``."""
        from .arrays import call_ufunc, plain, wrapped
        from .rules import RULES

        if not name.startswith("__"):
            if issubclass(self.type, np.generic) and hasattr(self.type, name):
                return getattr(wrapped(plain(self), np.dtype(self.type)), name)
            function = getattr(np, name, None)
            if name in RULES and isinstance(function, np.ufunc):
                return lambda *values: call_ufunc(function, "__call__", (self, *values), {})
        raise AttributeError(f"'{self.type.__name__}' object has no attribute '{name}'")

    # What is asked of numbers of Python and of NumPy.
    @property
    def real(self) -> Symbol:
        return self

    @property
    def imag(self) -> Any:
        return self.type(0)

    def item(self) -> Symbol:
        return Symbol(self.recording, self.index, type(self.type(0).item()))

    def tolist(self) -> Symbol:
        return self.item()

    def copy(self) -> Symbol:
        return self

    def conjugate(self) -> Symbol:
        return self

    def is_integer(self) -> Any:
        raise refusal("a choice by a value that is not known before", CHOICE)
