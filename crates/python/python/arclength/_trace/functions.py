"""NumPy's functions of arrays with symbols that are not element-wise, and those that make arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .arrays import (
    FIXED,
    FLOAT,
    NumberArray,
    SymbolArray,
    call_ufunc,
    cast,
    has_symbols,
    into,
    kind_of,
    known_kind,
    objects,
    plain,
    put,
    realized,
    result,
    shadow,
    to_array,
    wrapped,
)
from .rules import no_rule, select
from .values import Symbol, refusal

#: Largest system for ``np.linalg.solve``: what is written out grows with the cube of its size.
LARGEST_SYSTEM = 8

#: Functions that only move entries; what they return may share them.
MOVES = frozenset(
    "diagonal diag diagflat concatenate concat stack vstack hstack dstack column_stack row_stack block reshape ravel transpose"
    " matrix_transpose permute_dims swapaxes moveaxis rollaxis roll flip fliplr flipud rot90 repeat tile take take_along_axis compress"
    " squeeze expand_dims broadcast_to broadcast_arrays atleast_1d atleast_2d atleast_3d split array_split hsplit vsplit dsplit unstack"
    " append insert delete copy meshgrid tril triu resize extract real trim_zeros".split()
)
#: Functions that NumPy does by additions, multiplications and moves.
SUMS = frozenset(
    "dot vdot inner outer tensordot einsum cross trace convolve matmul vecdot matvec vecmat kron diff ediff1d pad trapezoid trapz"
    " polyval matrix_power multi_dot".split()
)
#: Functions that ask only for shapes and types.
SHAPES = frozenset("zeros_like ones_like empty_like shape ndim size result_type iscomplexobj isrealobj isscalar can_cast common_type".split())


def call_function(function: Any, arguments: Any, keywords: Any) -> Any:
    """A function of NumPy with arrays of symbols and numbers."""
    if not any(map(has_symbols, (*arguments, *keywords.values()))):
        return constant_call(function, arguments, keywords)
    name = function.__name__
    if name in SPECIAL:
        return SPECIAL[name](*arguments, **keywords)
    if name in SHAPES:
        made = function(*map(shadow, arguments), **{key: shadow(value) for key, value in keywords.items()})
        return wrapped(np.zeros_like(made) if name == "empty_like" else made)
    if name not in MOVES and name not in SUMS:
        raise no_rule(f"np.{name}")
    out = keywords.get("out")
    with np.errstate(all="ignore"):
        sample = function(*map(shadow, arguments), **{key: shadow(value) for key, value in keywords.items()})
    first = sample
    while isinstance(first, (list, tuple)) and first:
        first = first[0]
    kind = known_kind(np.asarray(first).dtype)
    keywords = {key: value for key, value in keywords.items() if key != "out"}

    def given(value: Any) -> Any:
        if isinstance(value, (list, tuple)):
            if has_symbols(value) and all(np.ndim(shadow(item)) == 0 for item in value):
                return given(to_array(value))
            return type(value)(map(given, value)) if any(isinstance(item, np.ndarray) for item in value) or has_symbols(value) else value
        if type(value) is Symbol or isinstance(value, np.ndarray):
            if name in MOVES and not has_symbols(value) and kind_of(value) != FLOAT:
                return realized(value)  # indices
            if name in SUMS or kind_of(value) != kind:
                return objects(value, kind)
            return plain(value)
        return value

    values = function(*map(given, arguments), **{key: given(value) for key, value in keywords.items()})
    if out is not None:
        return into(out, values, kind)
    return _results(values, kind)


def _results(values: Any, kind: np.dtype[Any]) -> Any:
    if isinstance(values, (list, tuple)):
        return type(values)(_results(value, kind) for value in values)
    return result(values, kind, values) if isinstance(values, np.ndarray) or type(values) is Symbol else values


def constant_call(function: Any, arguments: Any, keywords: Any) -> Any:
    """A function of arrays without symbols is that of NumPy; what it changes in them is changed."""
    changed: list[tuple[SymbolArray, Any, Any]] = []

    def real(value: Any) -> Any:
        if type(value) is SymbolArray:
            array = realized(value)
            changed.append((value, array, array.copy()))
            return array
        if type(value) is NumberArray:
            return value.view(np.ndarray)
        return type(value)(map(real, value)) if type(value) in (list, tuple) else value

    if getattr(function, "__name__", "") in MOVES and any(type(value) is SymbolArray for value in arguments):
        owner = next(value for value in arguments if type(value) is SymbolArray)
        if not keywords.get("out") and all(kind_of(value) == FLOAT for value in arguments if isinstance(value, np.ndarray)):
            # The entries may be shared by what it returns.
            return _results(function(*[plain(value) if value is owner else realized(value) for value in arguments], **keywords), owner.kind)
    made = function(*map(real, arguments), **{key: real(value) for key, value in keywords.items()})
    for owner, array, before in changed:
        if made is array:
            made = owner
        if not np.array_equal(array, before, equal_nan=array.dtype.kind in "fc"):
            owner[...] = array
    return wrapped(made)


def array(values: Any, dtype: Any = None, *, copy: Any = True, order: Any = None, subok: bool = False, ndmin: int = 0, like: Any = None) -> Any:
    """``np.array`` that takes symbols."""
    if type(values) is SymbolArray or has_symbols(values):
        made = values if isinstance(values, np.ndarray) else to_array(values)
        if type(made) is Symbol:
            made = wrapped(plain(made), np.dtype(made.type))
        elif type(made) is not SymbolArray:
            made = wrapped(made)
        if dtype is not None and np.dtype(dtype) != made.kind:
            made = cast(made, np.dtype(dtype))
        elif copy is True and made is values:
            made = made.copy()
        return made.reshape((1,) * (ndmin - made.ndim) + made.shape) if isinstance(made, np.ndarray) and made.ndim < ndmin else made
    made = np.array(realized(values), dtype=dtype, ndmin=ndmin)
    if made.dtype == object:
        raise refusal("an array of objects", "make arrays of lists of numbers and values")
    return wrapped(made)


def as_array(values: Any, dtype: Any = None, order: Any = None, *, copy: Any = None, **keywords: Any) -> Any:
    """``np.asarray``: an array is not copied."""
    return array(values, dtype, copy=copy is True)


def _empty(shape: Any, dtype: Any = float, **keywords: Any) -> Any:
    return wrapped(np.zeros(shape, dtype, **keywords))


def _full(shape: Any, fill_value: Any, dtype: Any = None, **keywords: Any) -> Any:
    made = array(np.full(shape, shadow(fill_value), dtype=dtype))
    if has_symbols(fill_value):
        if type(made) is not SymbolArray:
            made = wrapped(made, known_kind(made.dtype))
        made[...] = fill_value
    return made


def _full_like(like: Any, fill_value: Any, dtype: Any = None, *, shape: Any = None, **keywords: Any) -> Any:
    return _full(np.shape(shadow(like)) if shape is None else shape, fill_value, dtype or np.asarray(shadow(like)).dtype)


def _from_iterable(values: Any, dtype: Any, count: int = -1, **keywords: Any) -> Any:
    given = list(values)
    return array(given if count < 0 else given[:count], dtype)


#: Functions that make arrays.
CREATION: dict[str, Callable[..., Any]] = {
    "array": array,
    "asarray": as_array,
    "asanyarray": as_array,
    "ascontiguousarray": as_array,
    "asarray_chkfinite": as_array,
    "empty": _empty,
    "full": _full,
    "fromiter": _from_iterable,
}


def _where(condition: Any, x: Any = None, y: Any = None) -> Any:
    if x is None or y is None:
        raise refusal("np.where with a condition only", "its result would depend on values; give both np.where(condition, a, b)")
    sample = np.where(shadow(condition), shadow(x), shadow(y))
    return result(_selected(condition, x, y), known_kind(sample.dtype), sample)


def _selected(condition: Any, x: Any, y: Any) -> Any:
    truth = kind_of(to_array(condition)) == bool
    choose = np.frompyfunc(lambda chosen, yes, no: select(chosen, yes, no, truth), 3, 1)
    return np.asarray(choose(plain(condition), plain(x), plain(y)), dtype=object)


def _choose(condlist: Any, choicelist: Any, default: Any = 0) -> Any:
    """``np.select``: the first choice whose condition holds."""
    sample = np.select(shadow(condlist), shadow(choicelist), shadow(default))
    chosen = plain(default)
    for condition, choice in reversed(list(zip(condlist, choicelist, strict=True))):
        chosen = _selected(condition, choice, chosen)
    return result(np.broadcast_to(chosen, sample.shape).copy(), known_kind(sample.dtype), sample)


def _clip(a: Any, a_min: Any = None, a_max: Any = None, out: Any = None, *, min: Any = None, max: Any = None) -> Any:
    low, high = a_min if min is None else min, a_max if max is None else max
    clipped = a
    if low is not None:
        clipped = call_ufunc(np.maximum, "__call__", (clipped, low), {})
    if high is not None:
        clipped = call_ufunc(np.minimum, "__call__", (clipped, high), {})
    if out is not None:
        return into(out, plain(clipped), kind_of(clipped))
    return clipped.copy() if clipped is a else clipped


def _reduced(ufunc: np.ufunc) -> Callable[..., Any]:
    def function(a: Any, axis: Any = None, dtype: Any = None, out: Any = None, **keywords: Any) -> Any:
        return call_ufunc(ufunc, "reduce", (to_array(a),), {"axis": axis, "dtype": dtype, "out": out, **keywords})

    return function


def _extreme(ufunc: np.ufunc) -> Callable[..., Any]:
    def function(a: Any, axis: Any = None, out: Any = None, **keywords: Any) -> Any:
        return call_ufunc(ufunc, "reduce", (to_array(a),), {"axis": axis, "out": out, **keywords})

    return function


def _accumulated(ufunc: np.ufunc) -> Callable[..., Any]:
    def function(a: Any, axis: Any = None, dtype: Any = None, out: Any = None) -> Any:
        a = to_array(a)
        if axis is None:
            a, axis = a.ravel(), 0
        return call_ufunc(ufunc, "accumulate", (a,), {"axis": axis, "dtype": dtype, "out": out})

    return function


def _delivered(value: Any, out: Any) -> Any:
    return value if out is None else into(out, plain(value), kind_of(value))


def _mean(a: Any, axis: Any = None, dtype: Any = None, out: Any = None, keepdims: bool = False) -> Any:
    a = array(a, dtype, copy=False)
    total = np.sum(a, axis=axis, keepdims=keepdims)
    return _delivered(total / (np.size(shadow(a)) / max(np.size(shadow(total)), 1)), out)


def _variance(
    a: Any, axis: Any = None, dtype: Any = None, out: Any = None, ddof: float = 0, keepdims: bool = False, *, correction: float = 0
) -> Any:
    a = array(a, dtype, copy=False)
    squares = np.sum(np.square(a - _mean(a, axis, keepdims=True)), axis=axis, keepdims=keepdims)
    return _delivered(squares / (np.size(shadow(a)) / max(np.size(shadow(squares)), 1) - ddof - correction), out)


def _deviation(*arguments: Any, out: Any = None, **keywords: Any) -> Any:
    return _delivered(np.sqrt(_variance(*arguments, **keywords)), out)


def _range(a: Any, axis: Any = None, out: Any = None, keepdims: bool = False) -> Any:
    return _delivered(np.max(a, axis=axis, keepdims=keepdims) - np.min(a, axis=axis, keepdims=keepdims), out)


def _count(a: Any, axis: Any = None, *, keepdims: bool = False) -> Any:
    return np.sum(np.not_equal(array(a, copy=False), 0), axis=axis, keepdims=keepdims)


def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Any:
    x = array(x, copy=False)
    vector = (x.ndim == 1 and axis is None) or isinstance(axis, (int, np.integer))
    if ord is None or (ord == 2 and vector) or (ord == "fro" and not vector and (x.ndim == 2 or axis is not None)):
        return np.sqrt(np.sum(np.square(x), axis=axis, keepdims=keepdims))
    if vector and ord == 1:
        return np.sum(np.abs(x), axis=axis, keepdims=keepdims)
    if vector and ord in (np.inf, -np.inf):
        return (np.max if ord > 0 else np.min)(np.abs(x), axis=axis, keepdims=keepdims)
    raise refusal(f"np.linalg.norm with ord={ord!r}", "write it by np.sum, np.abs and np.maximum")


def _triangle(matrix: Any, right: Any) -> tuple[list[Any], Any, int]:
    """Elimination with the pivots on the diagonal, where mass matrices have them; rows change places at a pivot that is zero."""
    rows = [list(row) for row in objects(to_array(matrix), FLOAT)]
    size, sign = len(rows), 1
    if size > LARGEST_SYSTEM or any(len(row) != size for row in rows):
        raise refusal(
            f"a linear system with a matrix of shape {np.shape(shadow(matrix))}",
            f"square ones of up to {LARGEST_SYSTEM} rows can be written out",
        )
    for pivot in range(size):
        found = next((row for row in range(pivot, size) if not _is_zero(rows[row][pivot])), None)
        if found is None:
            raise refusal("a linear system whose matrix is singular", "its determinant must not vanish")
        if found != pivot:
            rows[pivot], rows[found], sign = rows[found], rows[pivot], -sign
            right[[pivot, found]] = right[[found, pivot]]
        for row in range(pivot + 1, size):
            entry = rows[row][pivot]
            if _is_zero(entry):
                continue
            factor = entry / rows[pivot][pivot]
            rows[row] = [below - factor * above for below, above in zip(rows[row], rows[pivot], strict=True)]
            right[row] = right[row] - factor * right[pivot]
    return rows, right, sign


def _is_zero(value: Any) -> bool:
    return type(value) is not Symbol and bool(value == 0)


def _solve(a: Any, b: Any) -> Any:
    sample = np.linalg.solve(np.eye(np.shape(shadow(a))[-1]), shadow(b))
    if np.ndim(shadow(a)) != 2:
        raise refusal("several linear systems at once", "solve one after the other in a loop")
    if not has_symbols(a) and len(np.shape(a)) == 2 and np.shape(a)[0] == np.shape(a)[1]:
        return np.matmul(np.linalg.inv(np.asarray(realized(a), dtype=float)), to_array(b))
    right = array(b, dtype=float)
    rows, solution, _ = _triangle(a, wrapped(objects(right, FLOAT)))
    for row in reversed(range(len(rows))):
        for column in range(row + 1, len(rows)):
            solution[row] = solution[row] - rows[row][column] * solution[column]
        solution[row] = solution[row] / rows[row][row]
    return result(plain(solution), known_kind(sample.dtype))


def _inverse(a: Any) -> Any:
    return _solve(a, np.eye(np.shape(shadow(a))[-1]))


def _determinant(a: Any) -> Any:
    if np.ndim(shadow(a)) != 2:
        raise refusal("several determinants at once", "compute one after the other in a loop")
    rows, _, sign = _triangle(a, wrapped(np.zeros(np.shape(shadow(a))[0])))
    product = rows[0][0]
    for index in range(1, len(rows)):
        product = product * rows[index][index]
    return sign * product


def _fill_diagonal(a: Any, val: Any, wrap: bool = False) -> None:
    if type(a) is not SymbolArray:
        raise refusal("a value put into an array of numbers", FIXED)
    ones = np.zeros(a.shape)
    np.fill_diagonal(ones, 1.0, wrap)
    positions = np.nonzero(ones)
    values = np.resize(plain(val), len(positions[0]))
    a[positions] = wrapped(values.astype(object), kind_of(to_array(val)))


def _copy_to(dst: Any, src: Any, casting: str = "same_kind", where: Any = True) -> None:
    if type(dst) is not SymbolArray:
        raise refusal("a value put into an array of numbers", FIXED)
    put(dst, ..., src if where is True else np.where(where, src, dst))


#: Functions that NumPy would do by values, and those that reduce.
SPECIAL: dict[str, Callable[..., Any]] = {
    "where": _where,
    "select": _choose,
    "clip": _clip,
    "sum": _reduced(np.add),
    "prod": _reduced(np.multiply),
    "max": _extreme(np.maximum),
    "amax": _extreme(np.maximum),
    "min": _extreme(np.minimum),
    "amin": _extreme(np.minimum),
    "any": _extreme(np.logical_or),
    "all": _extreme(np.logical_and),
    "cumsum": _accumulated(np.add),
    "cumprod": _accumulated(np.multiply),
    "mean": _mean,
    "var": _variance,
    "std": _deviation,
    "ptp": _range,
    "count_nonzero": _count,
    "norm": _norm,
    "solve": _solve,
    "inv": _inverse,
    "det": _determinant,
    "fill_diagonal": _fill_diagonal,
    "copyto": _copy_to,
    "full_like": _full_like,
    **CREATION,
}
