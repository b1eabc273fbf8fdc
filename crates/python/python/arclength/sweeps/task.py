"""What a sweep does at each point: a function, or an analysis of a wheel or a model, and how its answer becomes rows."""

from __future__ import annotations

import functools
import inspect
import json
import sys
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from .._requests import as_column_of_warnings
from ..errors import ArclengthError, ComputationFailed, Interrupted, InvalidInput
from ..results import Result
from . import identity

#: Types that a column may have, by the name that a manifest has for them.
TYPES: dict[str, type] = {"number": float, "whole number": int, "yes or no": bool, "word": str}
#: The column that says why there is no answer at a point, and the one with what is worth knowing of it.
PROBLEM, WARNINGS = "problem", "warnings"

Row = dict[str, Any]


class Task:
    """A function with what does not vary. ``rows(points)`` is its answer at points: columns of equal length."""

    def __init__(
        self,
        function: Callable[..., Any],
        constants: Mapping[str, Any] | None,
        fields: Iterable[str] | Mapping[str, type] | None,
        batched: bool,
        version: str,
    ) -> None:
        if not callable(function):
            allowed = "a function, or an analysis as wheel.stability"
            raise InvalidInput(f"sweep {function!r}: not a function; allowed: {allowed}", key="function", allowed=allowed)
        self.function = function
        self.constants = dict(constants or {})
        self.fields = None if fields is None else list(fields)
        self.declared = dict(fields) if isinstance(fields, Mapping) else {}
        self.batched = batched or bool(getattr(function, "batched", False))
        self.version = version
        _analysis(function)

    def identity(self) -> dict[str, Any]:
        """What tells this function, with its constants, from any other."""
        function = self.function
        analysis = _analysis(function)
        if analysis is not None:
            subject, name = analysis
            code = {"name": name, "of": subject._identity()}
            if not type(subject).__module__.startswith(f"{__name__.partition('.')[0]}."):
                code["class"] = identity.of_value("class", type(subject), lenient=bool(self.version))
        else:
            code = {
                "name": getattr(function, "__qualname__", type(function).__name__),
                "python": ".".join(map(str, sys.version_info[:2])),
                **identity.of_function(function, lenient=bool(self.version)),
            }
        lenient = bool(self.version)
        constants = {name: identity.of_value(f"constants {name}", value, lenient=lenient) for name, value in sorted(self.constants.items())}
        return {**code, "version": self.version, "constants": constants, "fields": self.fields, "batched": self.batched}

    def call(self, point: Mapping[str, Any], stopped: Callable[[], bool], threads: int | None) -> Any:
        """Its answer at one point, or at the points of arrays."""
        analysis = _analysis(self.function)
        if analysis is None:
            return self.function(**point, **self.constants)
        subject, name = analysis
        if self.batched:
            return getattr(subject, name)(point, **self.constants, threads=threads)
        subject, keywords = subject._at(point)
        method = getattr(subject, name)
        accepted = inspect.signature(method).parameters
        if "progress" in accepted:
            keywords["progress"] = functools.partial(_check, stopped)
        if "threads" in accepted:
            keywords["threads"] = threads
        both = {**keywords, **self.constants}
        if "set" in keywords:
            both["set"] = {**(self.constants.get("set") or {}), **keywords["set"]}
        _check_keywords(subject, name, method, both)
        return method(**both)

    def row(self, point: Mapping[str, Any], stopped: Callable[[], bool], threads: int | None) -> Row:
        """Its answer at one point by column. Where the computation fails, the column ``problem`` says why."""
        try:
            return self._row(point, stopped, threads)
        except ComputationFailed as failure:
            return {PROBLEM: str(failure)}
        except (Stopped, Interrupted):
            raise
        except Exception as error:
            where = ", ".join(f"{name} = {value!r}" for name, value in point.items())
            if isinstance(error, ArclengthError):
                error.message = f"at {where}: {error.message}"
            else:
                error.add_note(f"at {where}")
            raise

    def _row(self, point: Mapping[str, Any], stopped: Callable[[], bool], threads: int | None) -> Row:
        with as_column_of_warnings():
            answer = self.call(point, stopped, threads)
        if isinstance(answer, Result):
            told = "; ".join(answer.warnings) or None
            return {**_fields(answer.document, self.fields), WARNINGS: told}
        if not isinstance(answer, Mapping):
            allowed = "a mapping from names to numbers, yes or no, words, or None"
            raise InvalidInput(f"the function gave {type(answer).__name__}; allowed: {allowed}", key="function", allowed=allowed)
        return _fields(dict(answer), self.fields)

    def columns(self, points: Mapping[str, Any], stopped: Callable[[], bool], threads: int | None) -> dict[str, Any]:
        """Its answer at many points at once, by a function that takes arrays and gives arrays."""
        import numpy as np

        answer = self.call(points, stopped, threads)
        count = len(next(iter(points.values())))
        if not isinstance(answer, Mapping) or any(np.shape(column) != (count,) for column in answer.values()):
            allowed = f"a mapping from names to arrays of {count} values, one for each point"
            raise InvalidInput(f"the function gave something else; allowed: {allowed}", key="function", allowed=allowed)
        chosen = list(answer) if self.fields is None else self.fields
        return {name: answer[name] for name in chosen}


class Stopped(Exception):
    """The sweep is to stop: what was begun is given up."""


def _check(stopped: Callable[[], bool], *_: object) -> None:
    if stopped():
        raise Stopped


def _check_keywords(subject: Any, name: str, method: Callable[..., Any], keywords: Mapping[str, Any]) -> None:
    accepted = [one for one in inspect.signature(method).parameters.values() if one.kind is not one.VAR_KEYWORD]
    known = [one.name for one in accepted]
    allowed = ", ".join([*subject.parameters, *known])
    for key in keywords:
        if key not in known:
            raise InvalidInput(f"{key}: neither a parameter nor a keyword of {name}; allowed: {allowed}", key=key, allowed=allowed)
    for one in accepted:
        if one.default is one.empty and one.name not in keywords:
            message = f"{one.name}: {name} needs it; allowed: {one.name} in the sample or in constants="
            raise InvalidInput(message, key=one.name, allowed=f"{one.name} in the sample or in constants=")


def _analysis(function: Callable[..., Any]) -> tuple[Any, str] | None:
    """The wheel or the model, and the name of the analysis, if the function is a method of one."""
    subject = getattr(function, "__self__", None)
    if subject is None or inspect.ismodule(subject) or inspect.isclass(subject):
        return None
    if not hasattr(subject, "_at"):
        raise InvalidInput(
            f"sweep over a method of {type(subject).__name__}: what the object holds is not known; allowed: a function, or an analysis of a "
            "Wheel or a Model",
            key="function",
            allowed="a function, or an analysis of a Wheel or a Model",
        )
    return subject, function.__name__


def _fields(document: Mapping[str, Any], fields: list[str] | None) -> Row:
    if fields is not None:
        return {field: _scalar(field, _followed(document, field)) for field in fields}
    unread = ("schema", "parameters", "warnings")
    scalars = {name: value for name, value in document.items() if name not in unread and not isinstance(value, (dict, list, tuple))}
    return {name: _scalar(name, value) for name, value in scalars.items()}


def _followed(value: Any, path: str) -> Any:
    """What stands at a path like ``fractions.0.share`` or ``psi.-1``; ``None`` where a list is shorter or something is ``None``."""
    for step in path.split("."):
        if isinstance(value, Mapping) and step in value:
            value = value[step]
        elif isinstance(value, (list, tuple)) and step.lstrip("-").isdigit():
            value = value[int(step)] if -len(value) <= int(step) < len(value) else None
        elif value is not None:
            allowed = ", ".join(value) if isinstance(value, Mapping) else "a number in a list"
            raise InvalidInput(f"field {path}: there is no `{step}`; allowed: {allowed}", key="fields", value=path, allowed=allowed)
    return value


def _scalar(name: str, value: Any) -> Any:
    if hasattr(value, "item") and getattr(value, "ndim", 0) == 0:
        value = value.item()
    if value in ("inf", "-inf"):
        return float(value)
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise InvalidInput(
        f"{name} {json.dumps(value, default=repr)[:60]}: not a number, yes or no, or a word; allowed: fields like `{name}.0` in it",
        key=name,
        allowed="a number, yes or no, a word, or None",
    )


def kind_of(value: Any) -> str:
    """The name of the type of a value."""
    for name in ("yes or no", "whole number", "number", "word"):
        if isinstance(value, TYPES[name]):
            return name
    raise InvalidInput(f"{value!r}: no type of a column; allowed: float, int, bool, str", key="fields", allowed=", ".join(TYPES))


def kind_of_type(kind: type) -> str:
    """The name of a type."""
    for name, known in TYPES.items():
        if kind is known:
            return name
    raise InvalidInput(f"{kind!r}: no type of a column; allowed: float, int, bool, str", key="fields", allowed="float, int, bool, str")
