"""From arguments to requests, and from requests to results."""

from __future__ import annotations

import json
import math
import operator
import os
import re
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any, Literal, get_args

from . import _native
from .errors import AnalysisWarning, InvalidInput

if TYPE_CHECKING:
    from ._native import NativeResult

#: A parameter and its interval: ``("mu", -1, 1)``, ``"mu=-1:1"``, or ``"mu"`` where the model says from where to where.
Along = str | tuple[str, float, float]
#: A parameter and equidistant values of it: ``("v", 1, 8, 15)``, both ends included.
Sampled = tuple[str, float, float, int]
#: All values between two, or each of several: ``(1, inf)``, ``[1, 2, 5]``, or as text ``"1:inf"``, ``"1,2,5"``.
Conditions = str | tuple[float, float] | list[float]
#: Called with the part that is done (0 to 1) or ``None``, and with where the computation is, or ``None``; ``True`` is a bar of tqdm.
Progress = Callable[[float | None, str | None], object] | Literal[True]

#: How a motion of a model is integrated, and which crossings of a section count.
Method = Literal["auto", "explicit", "implicit"]
Direction = Literal["both", "rising", "falling"]
#: Whether a wheel may slide, and what disturbs it.
Contact = Literal["rolling", "sliding"]
Kick = Literal["impulse", "release-angle", "jolt", "step-steer"]

#: More threads than any machine has processors for take minutes to start.
_MOST_THREADS = 1024

_ENCODER = json.JSONEncoder(allow_nan=False)

#: Whether warnings of results are only kept in them.
_KEPT: ContextVar[bool] = ContextVar("kept", default=False)


@contextmanager
def as_column_of_warnings() -> Iterator[None]:
    """Results keep their warnings to themselves meanwhile: who asks for thousands of results shows them in another way."""
    token = _KEPT.set(True)
    try:
        yield
    finally:
        _KEPT.reset(token)


def number(key: str, value: Any) -> float | str:
    """A number as a request has it: infinity is a word there."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InvalidInput(
            f"{key} {value!r}: not a number; allowed: a number", key=key, value=repr(value), allowed="a number"
        ) from None
    if math.isnan(number):
        raise InvalidInput(f"{key} nan: not a number; allowed: a number", key=key, value="nan", allowed="a number")
    return ("inf" if number > 0 else "-inf") if math.isinf(number) else number


def numbers(key: str, values: Any) -> list[float | str]:
    """A number, or several, as a list."""
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        values = [values]
    return [number(key, value) for value in values]


def optional(key: str, value: Any) -> float | str | None:
    """A number or nothing."""
    return None if value is None else number(key, value)


def whole(key: str, value: Any) -> int:
    """A whole number."""
    try:
        return operator.index(value)
    except TypeError:
        raise InvalidInput(
            f"{key} {value!r}: not a whole number; allowed: a whole number",
            key=key,
            value=repr(value),
            allowed="a whole number",
        ) from None


def word(key: str, value: Any, words: Any) -> str:
    """One of the words of a type such as :data:`Method`."""
    allowed = get_args(words)
    if value not in allowed:
        listed = ", ".join(allowed)
        raise InvalidInput(f"{key} {value!r}: there is no such thing; allowed: {listed}", key=key, value=str(value), allowed=listed)
    return str(value)


def optional_word(key: str, value: Any, words: Any) -> str | None:
    """One of the words of a type, or nothing."""
    return None if value is None else word(key, value, words)


def thread_count(threads: Any) -> int:
    """A number of threads; 0 where none is given."""
    count = 0 if threads is None else whole("threads", threads)
    if not 0 <= count <= _MOST_THREADS:
        allowed = f"1 to {_MOST_THREADS}, or None for one for each processor"
        raise InvalidInput(f"threads {count}: out of range; allowed: {allowed}", key="threads", value=str(count), allowed=allowed)
    return count


def named(key: str, values: Mapping[str, Any] | None) -> dict[str, float | str]:
    """Numbers with names."""
    if values is not None and not isinstance(values, Mapping):
        raise _form(key, values, "a mapping from names to numbers")
    return {str(name): number(f"{key} {name}", value) for name, value in (values or {}).items()}


def assignments(values: Mapping[str, Any]) -> list[dict[str, str]]:
    """Parameters with their values as text."""
    return [{"key": str(key), "value": text(key, value)} for key, value in values.items()]


def text(key: str, value: Any) -> str:
    """A value as text: a word, or a number that is read back as itself."""
    return value if isinstance(value, str) else str(number(key, value))


def _form(field: str, given: object, allowed: str) -> InvalidInput:
    message = f"{field} {given!r}: not of the form asked for; allowed: {allowed}"
    return InvalidInput(message, key=field, value=repr(given), allowed=allowed)


def interval(field: str, given: Along) -> dict[str, Any]:
    """A parameter and its interval, in either order."""
    allowed = '("KEY", a, b), "KEY=a:b", or "KEY" where the model says from where to where'
    if isinstance(given, str):
        key, equals, ends = given.partition("=")
        if not equals:
            return {"key": key.strip()}
        parts: list[Any] = [key.strip(), *ends.split(":")]
    else:
        parts = list(given) if isinstance(given, Iterable) else []
    if len(parts) != 3 or not isinstance(parts[0], str):
        raise _form(field, given, allowed)
    first, second = (float(number(field, end)) for end in parts[1:])
    if first == second:
        raise InvalidInput(
            f"{field} {given!r}: an empty interval; allowed: two different ends",
            key=field,
            value=repr(given),
            allowed="two different ends",
        )
    return {"key": parts[0], "start": number(field, min(first, second)), "end": number(field, max(first, second))}


def sampled(field: str, given: Sampled | str) -> dict[str, Any]:
    """A parameter and equidistant values of it."""
    allowed = '("KEY", a, b, number of values) or "KEY=a:b:n"'
    if isinstance(given, str):
        key, _, ends = given.partition("=")
        parts: list[Any] = [key.strip(), *ends.split(":")]
        if len(parts) == 4 and str(parts[3]).strip().isdigit():
            parts[3] = int(parts[3])
    else:
        parts = list(given) if isinstance(given, Iterable) else []
    if len(parts) != 4 or not isinstance(parts[0], str):
        raise _form(field, given, allowed)
    return {**interval(field, (parts[0], parts[1], parts[2])), "count": whole(field, parts[3])}


def conditions(field: str, given: Conditions | None) -> dict[str, Any] | list[Any] | None:
    """All values between two, ``(a, b)``, or each of a list; nothing where none are given."""
    if given is None:
        return None
    allowed = '(a, b) for all values between, a list [a, b, c] for each, "a:b" or "a,b,c"'
    parts: Any = given
    if isinstance(given, str):
        ends = given.split(":")
        parts = (ends[0], ends[1]) if len(ends) == 2 else given.split(",")
    if isinstance(parts, tuple):
        if len(parts) != 2:
            raise _form(field, given, allowed)
        start, end = sorted((number(field, value) for value in parts), key=float)
        return {"start": start, "end": end}
    return numbers(field, parts)


def monitors(given: Mapping[str, Any] | Iterable[str], until: Mapping[str, Any] | None) -> list[dict[str, Any]]:
    """What is recorded along a branch, with values at which a point is wanted, and at which it ends."""
    if isinstance(given, str):
        given = [given]
    if not isinstance(given, Iterable):
        raise _form("monitors", given, "expressions, or a mapping from expressions to values")
    asked = given if isinstance(given, Mapping) else {expression: () for expression in given}
    recorded = [{"expression": expression, "at": numbers("monitor", at)} for expression, at in asked.items()]
    ending = [
        {"expression": expression, "until": numbers("until", at)} for expression, at in (until or {}).items()
    ]
    return recorded + ending


def held(given: str | tuple[str, float] | None) -> dict[str, Any] | None:
    """What keeps its value along a curve, perhaps with that value."""
    if given is None:
        return None
    expression, values = (given, []) if isinstance(given, str) else (given[0], numbers("hold", given[1]))
    return {"expression": expression, "at": values}


@contextmanager
def reported(progress: Progress | None, title: str) -> Iterator[Callable[[float | None, str | None], object] | None]:
    """What is told the progress; for ``True`` a bar on standard error, for as long as it takes (needs tqdm)."""
    if progress is not True:
        yield progress
        return
    from tqdm.auto import tqdm

    with tqdm(total=1.0, desc=title, bar_format="{desc}: {percentage:3.0f} %|{bar}| {elapsed}{postfix}") as bar:

        def tell(part: float | None, place: str | None) -> None:
            if part is not None:
                bar.update(part - bar.n)
            if place is not None:
                bar.set_postfix_str(place)

        yield tell


#: How the native module says what it cannot read, and where.
_UNREAD = re.compile(r"the request cannot be read: (?P<what>.*?), expected (?P<expected>.*) at line \d+ column \d+")
_EXPECTED = {
    "f64": "a finite number",
    **dict.fromkeys(("u8", "u16", "u32", "u64", "usize"), "a whole number that is not negative and not too large"),
}
_OF_A_FIELD = re.compile(r"(?P<key>\w+) = (?P<value>\S+) is not allowed: |unknown (?:key|state) `(?P<unknown>[^`]*)`")


def _unread(analysis: str, request: Mapping[str, Any]) -> str | None:
    """What the native module cannot read of a request."""
    try:
        _native.complete_request(analysis, _ENCODER.encode(request))
    except InvalidInput as error:
        told = _UNREAD.match(error.message)
        return told["what"] if told is not None else error.message
    return None


def _explain(error: InvalidInput, analysis: str, request: Mapping[str, Any]) -> None:
    """Says of an error of the native module which field it is about."""
    told = _UNREAD.match(error.message)
    if told is not None:
        # Without the field at fault there is no error, or it is missed.
        without = {key: _unread(analysis, {one: value for one, value in request.items() if one != key}) for key in request}
        fields = [key for key, what in without.items() if what is None] or [key for key, what in without.items() if what != told["what"]]
        key = fields[0] if fields else "request"
        given = re.search(r'[`"]([^`"]*)[`"]', told["what"])
        value = given[1] if given else told["what"]
        allowed = _EXPECTED.get(told["expected"], told["expected"].removeprefix("one of ").replace("`", "").replace(" or ", ", "))
        error.message = f"{key} {value}: out of range; allowed: {allowed}"
        error.key, error.value, error.allowed = key, value, allowed
    elif error.key is None and (told := _OF_A_FIELD.match(error.message)) is not None:
        error.key, error.value = told["key"] or told["unknown"], told["value"] or told["unknown"]


def run(
    analysis: str, request: Mapping[str, Any], *, threads: int | None = None, progress: Progress | None = None
) -> NativeResult:
    """Runs an analysis and warns of what is worth knowing."""
    text = _ENCODER.encode(request)
    count = thread_count(threads)
    try:
        if progress is True:
            with reported(progress, analysis) as told:
                result = _native.run_analysis(analysis, text, count, told)
        else:
            result = _native.run_analysis(analysis, text, count, progress)
    except InvalidInput as error:
        _explain(error, analysis, request)
        raise
    if _KEPT.get():
        return result
    for warning in result.warnings:
        warnings.warn(warning, AnalysisWarning, stacklevel=4)
    if result.interrupted:
        warnings.warn("interrupted: the result is what there was up to then", AnalysisWarning, stacklevel=4)
    return result


@contextmanager
def on_disk(result: NativeResult) -> Iterator[str]:
    """The result as a file, for as long as something starts from it."""
    with tempfile.TemporaryDirectory(prefix="arclength-") as folder:
        path = os.path.join(folder, "result.json")
        with open(path, "wb") as file:
            file.write(result.json())
        yield path
