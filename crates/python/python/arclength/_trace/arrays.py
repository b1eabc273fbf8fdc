"""Arrays of values that are recorded, and NumPy's element-wise functions of them.

An array holds symbols and numbers as objects; its ``kind`` is the type that NumPy's array would have. Shapes, types and errors of a result
are NumPy's own: every function is first called with arrays of ones in place of those of symbols.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from .rules import RULES, TRUTHS, no_rule, of_numbers
from .values import Symbol, is_number, known_type, refusal, type_of, typed

FLOAT = np.dtype(float)
FIXED = "make arrays of numbers in this function, by np.zeros, np.empty, np.array([0.0, ..]) or np.zeros_like(x)"


class SymbolArray(np.ndarray):
    """An array of symbols and numbers."""

    kind: np.dtype[Any]

    def __array_finalize__(self, parent: Any) -> None:
        self.kind = getattr(parent, "kind", FLOAT)

    @property
    def __class__(self) -> Any:
        return np.ndarray

    @__class__.setter
    def __class__(self, _: Any) -> None:
        raise TypeError("the class of an array does not change")

    @property
    def dtype(self) -> Any:
        return self.kind

    @dtype.setter
    def dtype(self, _: Any) -> None:
        raise refusal("an array whose dtype is set", "make another by astype")

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        return call_ufunc(ufunc, method, inputs, keywords)

    def __array_function__(self, function: Any, types: Any, arguments: Any, keywords: Any) -> Any:
        from .functions import call_function

        return call_function(function, arguments, keywords)

    def __setitem__(self, key: Any, value: Any) -> None:
        if has_symbols(key):
            chosen = realized(key)
            if not isinstance(chosen, SymbolArray) or chosen.shape != self.shape or np.ndim(shadow(value)) > 0:
                raise refusal("an assignment to entries that are chosen by values", "write np.where(condition, a, b)")
            value = np.where(chosen, value, self)
            key = ...
        put(self, realized(key), value)

    def __getitem__(self, key: Any) -> Any:
        if has_symbols(key):
            raise refusal("entries that are chosen by values", "write np.where(condition, a, b); indices must not depend on values")
        found = self.view(np.ndarray)[realized(key)]
        return wrapped(found, self.kind) if isinstance(found, np.ndarray) else entry(found, self.kind)

    def __iter__(self) -> Iterator[Any]:
        if self.ndim == 0:
            raise TypeError("iteration over a 0-d array")
        return (self[index] for index in range(len(self)))

    def __str__(self) -> str:
        if has_symbols(self):
            raise refusal("values made a text", "texts must not depend on states and parameters; print(x) shows what is recorded")
        return str(realized(self))

    def __format__(self, form: str) -> str:
        return format(str(self), form)

    def __repr__(self) -> str:
        return f"array({self.view(np.ndarray).tolist()!r})"

    def __deepcopy__(self, _: Any) -> SymbolArray:
        return self.copy()

    def __reduce__(self) -> Any:
        raise refusal("an array that is pickled", "values must not leave the function")

    def astype(self, dtype: Any, *_: Any, **__: Any) -> Any:
        return cast(self, np.dtype(dtype))

    def item(self, *where: Any) -> Any:
        return python(self.view(np.ndarray).item(*where), self.kind)

    def tolist(self) -> Any:
        if self.ndim == 0:
            return self.item()
        return [self[index].tolist() for index in range(len(self))]

    def fill(self, value: Any) -> None:
        self[...] = value

    def sort(self, *arguments: Any, **keywords: Any) -> None:
        if has_symbols(self):
            raise no_rule("sort")
        self[...] = np.sort(realized(self), *arguments, **keywords)


class NumberArray(np.ndarray):
    """An array of numbers: one of the function's constants, or of whole numbers. What is computed from it takes symbols."""

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        return call_ufunc(ufunc, method, inputs, keywords)

    def __array_function__(self, function: Any, types: Any, arguments: Any, keywords: Any) -> Any:
        from .functions import call_function

        return call_function(function, arguments, keywords)

    def __getitem__(self, key: Any) -> Any:
        if has_symbols(key):
            raise refusal("entries that are chosen by values", "write np.where(condition, a, b); indices must not depend on values")
        return super().__getitem__(realized(key))

    def __setitem__(self, key: Any, value: Any) -> None:
        if has_symbols(value) or has_symbols(key):
            kind = "whole numbers or truth values" if self.dtype.kind != "f" else "numbers that was not made in this function"
            raise refusal(f"a value put into an array of {kind}", FIXED)
        super().__setitem__(realized(key), realized(value))

    def astype(self, dtype: Any, *_: Any, **__: Any) -> Any:
        return wrapped(self.view(np.ndarray).astype(dtype))


def _method(name: str) -> Callable[..., Any]:
    def method(self: Any, *arguments: Any, **keywords: Any) -> Any:
        from .functions import call_function, constant_call

        if not any(map(has_symbols, (self, *arguments, *keywords.values()))):
            return constant_call(getattr(np.ndarray, name), (self, *arguments), keywords)
        function = getattr(np, name)
        if isinstance(function, np.ufunc):
            return call_ufunc(function, "__call__", (self, *arguments), keywords)
        return call_function(function, (self, *arguments), keywords)

    return method


def _refused(name: str) -> Callable[..., Any]:
    def method(self: Any, *_: Any, **__: Any) -> Any:
        raise no_rule(f"ndarray.{name}")

    return method


SymbolArray.real = property(lambda self: self)  # type: ignore[assignment]
SymbolArray.imag = property(lambda self: wrapped(np.zeros(self.shape, dtype=self.kind)))  # type: ignore[assignment]
_METHODS = "sum prod mean std var max min any all cumsum cumprod dot clip trace argmax argmin argsort nonzero round searchsorted".split()
for _name in [*_METHODS, "choose", "compress", "conj", "conjugate", "argpartition", "take"]:
    setattr(SymbolArray, _name, _method(_name))
    setattr(NumberArray, _name, _method(_name))
NumberArray.copy = _method("copy")  # type: ignore[method-assign]
for _name in "tobytes tofile dump dumps byteswap getfield setfield resize partition put itemset newbyteorder tostring to_device".split():
    setattr(SymbolArray, _name, _refused(_name))


def put(target: SymbolArray, key: Any, value: Any) -> None:
    """Puts values into entries of an array, as NumPy's assignment does."""
    value = to_array(value)
    if not has_symbols(value):
        value = np.asarray(realized(value))
        if not np.can_cast(value.dtype, target.kind, "unsafe") or value.dtype.kind == "c":
            raise refusal(f"values of type {value.dtype} put into an array", "values are real numbers")
        value = value.astype(target.kind).astype(object)
    else:
        kind = kind_of(value)
        if not np.can_cast(kind, target.kind, "same_kind"):
            raise refusal(f"a value put into an array of type {target.kind}", FIXED)
        value = plain(value)
    entries = target.view(np.ndarray)
    if isinstance(entries[key], np.ndarray):
        entries[key] = value
    elif value.size == 1:
        entries[key] = value.item()
    else:
        raise ValueError("setting an array element with a sequence.")


def entry(value: Any, kind: np.dtype[Any]) -> Any:
    """An entry of an array of this kind."""
    return typed(value, kind.type)


def python(value: Any, kind: np.dtype[Any]) -> Any:
    """An entry as a number of Python."""
    return typed(value, type(kind.type(0).item()))


def wrapped(value: Any, kind: np.dtype[Any] | None = None) -> Any:
    """A result of NumPy: arrays of floating numbers become such that symbols can be put into."""
    if isinstance(value, np.ndarray):
        if type(value) is SymbolArray:
            return value
        if kind is None and value.dtype != FLOAT and value.dtype != object:
            return value.view(NumberArray)
        if kind is None and value.dtype == object and not has_symbols(value):
            return value
        array = value.astype(object).view(SymbolArray) if value.dtype != object else value.view(SymbolArray)
        array.kind = kind or FLOAT
        return array
    if type(value) in (list, tuple):
        return type(value)(wrapped(item, kind) for item in value)
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return type(value)(*[wrapped(item, kind) for item in value])
    return value


def result(value: Any, kind: np.dtype[Any], sample: Any = None) -> Any:
    """A result of this kind: an array, or an entry; an array without axes only where the sample is one."""
    if isinstance(value, np.ndarray) and (value.ndim > 0 or isinstance(sample, np.ndarray)):
        return wrapped(value, kind)
    return entry(value.item() if isinstance(value, np.ndarray) else value, kind)


def has_symbols(value: Any) -> bool:
    if type(value) is Symbol:
        return True
    if type(value) is SymbolArray or (isinstance(value, np.ndarray) and value.dtype == object):
        return any(type(item) is Symbol for item in value.view(np.ndarray).flat)
    if isinstance(value, (list, tuple)):
        return any(has_symbols(item) for item in value)
    return False


def plain(value: Any) -> Any:
    """Symbols, and arrays and lists of them, as plain arrays of objects."""
    value = to_array(value)
    if type(value) is Symbol:
        box = np.empty((), dtype=object)
        box[()] = value
        return box
    return value.view(np.ndarray) if type(value) in (SymbolArray, NumberArray) else value


def to_array(value: Any) -> Any:
    """Lists with symbols in them as arrays."""
    if isinstance(value, (list, tuple)) and has_symbols(value):
        ones = np.array(shadow(value))
        array = np.empty(ones.shape, dtype=object)
        if array.ndim:
            array.reshape(-1)[:] = [plain(item).item() if isinstance(item, np.ndarray) else item for item in _leaves(value, array.ndim)]
        return wrapped(array, known_kind(ones.dtype))
    return value


def _leaves(value: Any, depth: int) -> Iterator[Any]:
    if depth == 0:
        yield value
    else:
        for item in value:
            yield from _leaves(item, depth - 1)


def realized(value: Any) -> Any:
    """Arrays without symbols as those of NumPy."""
    if type(value) is SymbolArray and not has_symbols(value):
        return value.view(np.ndarray).astype(value.kind)
    if type(value) is NumberArray:
        return value.view(np.ndarray)
    if type(value) in (list, tuple):
        items = [realized(item) for item in value]
        return items if type(value) is list else tuple(items)
    return value


def shadow(value: Any) -> Any:
    """What NumPy would have in place of it, by shape and type: ones for symbols."""
    if type(value) is Symbol:
        return value.type(1)
    if isinstance(value, np.ndarray) and (type(value) is SymbolArray or value.dtype == object):
        if type(value) is not SymbolArray or has_symbols(value):
            return np.ones(value.shape, dtype=getattr(value, "kind", FLOAT))
        return realized(value)
    if type(value) is NumberArray:
        return value.view(np.ndarray)
    if type(value) in (list, tuple):
        items = [shadow(item) for item in value]
        return items if type(value) is list else tuple(items)
    return value


def known_kind(dtype: np.dtype[Any]) -> np.dtype[Any]:
    """The type of an array of symbols."""
    kind = known_type(dtype.type)
    if kind is None:
        raise refusal(f"an array of type {dtype}", "values are real numbers")
    found: np.dtype[Any] = np.dtype(kind)
    return found


def kind_of(value: Any) -> np.dtype[Any]:
    if type(value) is SymbolArray:
        return value.kind
    if isinstance(value, np.ndarray) and value.dtype == object:
        return FLOAT
    return np.dtype(value.dtype) if isinstance(value, np.ndarray) else np.dtype(type_of(value))


def cast(value: Any, kind: np.dtype[Any]) -> Any:
    """A copy of this kind, if nothing is lost by it."""
    if not has_symbols(value):
        return wrapped(np.asarray(realized(value)).astype(kind))
    kind, before = known_kind(kind), kind_of(value)
    if not np.can_cast(before, kind, "safe"):
        raise refusal(f"values made {kind}", "values are real numbers; write np.floor, or a condition")
    entries = np.frompyfunc(lambda item: typed(item, kind.type), 1, 1)(plain(value))
    return result(np.asarray(entries, dtype=object), kind) if isinstance(value, np.ndarray) else typed(value, kind.type)


def objects(value: Any, kind: np.dtype[Any]) -> Any:
    """Entries as objects of this kind, in a plain array."""
    if isinstance(value, np.ndarray) or type(value) is Symbol or has_symbols(value):
        value = plain(value)
        return np.asarray(np.frompyfunc(lambda item: typed(item, kind.type), 1, 1)(value), dtype=object)
    return [objects(item, kind) for item in value] if isinstance(value, (list, tuple)) else value


@functools.cache
def elementwise(ufunc: np.ufunc, truth: bool) -> np.ufunc:
    """A function of objects that records symbols, and is that of NumPy for numbers."""
    name = ufunc.__name__

    def function(*values: Any) -> Any:
        if not any(type(value) is Symbol for value in values):
            with np.errstate(all="ignore"):
                return ufunc(*values)
        return TRUTHS[name](*values) if truth else of_numbers(name, values)

    made: np.ufunc = np.frompyfunc(function, ufunc.nin, 1)
    return made


#: Functions of NumPy that are ufuncs, but no element-wise ones.
PRODUCTS = frozenset(("matmul", "vecdot", "matvec", "vecmat"))


def call_ufunc(ufunc: np.ufunc, method: str, inputs: tuple[Any, ...], keywords: dict[str, Any]) -> Any:
    """A ufunc of arrays with symbols and numbers."""
    from .functions import call_function, constant_call

    function = ufunc if method == "__call__" else getattr(ufunc, method)
    if not any(map(has_symbols, (*inputs, *keywords.values()))):
        return constant_call(function, inputs, keywords)
    if method == "__call__" and ufunc.__name__ in PRODUCTS:
        return call_function(ufunc, inputs, keywords)
    name = ufunc.__name__
    if method == "__call__" and name.endswith("(vectorized)"):
        # Of np.vectorize and np.frompyfunc: a function of Python.
        return wrapped(ufunc(*map(plain, inputs), **keywords))
    if method in ("at", "reduceat"):
        raise no_rule(f"{name}.{method}")
    if keywords.get("where", True) is not True:
        raise refusal("the keyword where of an element-wise function", "write np.where(condition, a, b)")
    if name not in RULES and name not in TRUTHS:
        raise no_rule(name)
    out = keywords.get("out")
    ones = {key: shadow(value) for key, value in keywords.items()}
    with np.errstate(all="ignore"):
        sample = function(*map(shadow, inputs), **ones)
    kind = known_kind(np.asarray(sample).dtype)
    truth = kind == bool and name in TRUTHS and all(kind_of(to_array(value)) == bool for value in inputs)
    if not truth and name not in RULES:
        raise no_rule(f"{name} of whole numbers")
    entries = elementwise(ufunc, truth)
    given = [plain(value) for value in inputs]
    if method in ("reduce", "accumulate") and kind != bool:
        given[0] = objects(given[0], kind)  # truth values are counted
    if method == "__call__":
        values = entries(*given)
    elif method == "outer":
        values = entries.outer(*given)
    elif method == "reduce":
        values = _reduce(ufunc, entries, np.shape(sample), *given, **keywords)
    else:
        values = _accumulate(entries, *given, **keywords)
    if out is not None:
        return into(out, values, kind)
    return result(values, kind)


def into(out: Any, values: Any, kind: np.dtype[Any]) -> Any:
    """Puts a result where it was wanted."""
    target = out[0] if isinstance(out, tuple) else out
    if type(target) is not SymbolArray:
        raise refusal("a value put into an array of numbers", FIXED)
    put(target, ..., result(np.asarray(values, dtype=object), kind))
    return target


def _reduce(
    ufunc: np.ufunc,
    entries: Any,
    shape: tuple[int, ...],
    array: Any,
    axis: Any = 0,
    dtype: Any = None,
    out: Any = None,
    keepdims: bool = False,
    initial: Any = None,
    where: bool = True,
) -> Any:
    if ufunc.nin != 2 or ufunc.identity is None and ufunc.__name__ not in ("maximum", "minimum", "fmax", "fmin"):
        raise no_rule(f"{ufunc.__name__}.reduce")
    array = np.asarray(array, dtype=object)
    axes = tuple(range(array.ndim)) if axis is None else axis if isinstance(axis, tuple) else (axis,)
    axes = tuple(one % array.ndim for one in axes)
    kept = tuple(one for one in range(array.ndim) if one not in axes)
    rows = array.transpose(*axes, *kept).reshape(math.prod([array.shape[one] for one in axes]), -1)
    first = [initial] if is_number(initial) or type(initial) is Symbol else []
    if not first and ufunc.__name__.startswith("logical"):
        first = [ufunc.identity]
    total = functools.reduce(entries, [*(np.full(rows.shape[1], value, dtype=object) for value in first), *rows])
    return np.asarray(total, dtype=object).reshape(shape)


def _accumulate(entries: Any, array: Any, axis: int = 0, dtype: Any = None, out: Any = None) -> Any:
    moved = np.moveaxis(np.asarray(array, dtype=object), axis, 0)
    rows = moved.reshape(len(moved), -1).copy()
    for index in range(1, len(rows)):
        rows[index] = entries(rows[index - 1], rows[index])
    return np.moveaxis(rows.reshape(moved.shape), 0, axis)
