"""Towed wheels: uniform motion, stability, shimmy, safe kicks, dampers, and parameters from records.

>>> from arclength.kingpin import Wheel
>>> wheel = Wheel(l=0.08, r=1.0, v=4.0, k=100)
>>> round(wheel.stability().critical_speed, 3)
8.431
"""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, overload

from . import _native
from ._requests import (
    Along,
    Conditions,
    Contact,
    Kick,
    Progress,
    Sampled,
    assignments,
    conditions,
    held,
    interval,
    named,
    number,
    numbers,
    optional,
    optional_word,
    run,
    sampled,
    text,
    thread_count,
    whole,
    word,
)
from ._requests import monitors as recorded
from .errors import InvalidInput, Interrupted
from .models import Monitors, samples_on_disk
from .results import Branch, Path, Point, Result, decided, of

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    from matplotlib.axes import Axes

__all__ = ["Basin", "Chart", "Cycles", "Fit", "HopfPoints", "Motion", "Parameter", "ParameterTable", "Wheel", "WheelPoint"]


#: Points that the engine gets at a time: a tenth of a second of work.
_POINTS_AT_ONCE = 1 << 16


class Parameter(NamedTuple):
    """A parameter of a wheel."""

    key: str
    symbol: str
    unit: str
    meaning: str
    #: Smallest and largest finite value, and whether it may be infinite.
    lowest: float
    highest: float
    infinite: bool
    #: Value of the paper's wheel.
    default: float


class ParameterTable(Mapping[str, Parameter]):
    """All parameters of wheels: meaning, unit, range and default of each key."""

    def __init__(self) -> None:
        self._rows = {row[0]: Parameter(*row) for row in _native.parameter_table()}

    def __getitem__(self, key: str) -> Parameter:
        return self._rows[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._rows)

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        rows = [(row.key, row.unit, _range(row), row.meaning) for row in self._rows.values()]
        widths = [max(len(row[column]) for row in rows) for column in range(3)]
        return "\n".join(
            "  ".join([*(cell.ljust(width) for cell, width in zip(row, widths, strict=False)), row[3]]) for row in rows
        )

    def _repr_html_(self) -> str:
        import html

        cells = [
            (row.key, row.symbol, row.unit, row.meaning, _range(row), f"{row.default:g}") for row in self._rows.values()
        ]
        heading = "".join(f"<th>{name}</th>" for name in ("key", "symbol", "unit", "meaning", "allowed", "default"))
        body = "".join(f"<tr>{''.join(f'<td>{html.escape(cell)}</td>' for cell in row)}</tr>" for row in cells)
        return f"<table><thead><tr>{heading}</tr></thead><tbody>{body}</tbody></table>"

    def to_pandas(self) -> pd.DataFrame:
        """The table as a ``pandas.DataFrame`` by key (needs pandas)."""
        import pandas

        return pandas.DataFrame(list(self._rows.values()), columns=list(Parameter._fields)).set_index("key")


def _range(row: Parameter) -> str:
    return f"{row.lowest:g} to {row.highest:g}" + (", or inf" if row.infinite else "")


class Wheel:
    """A towed wheel: the paper's, with the parameters that are given. Everything is in SI units and radians.

    ``k`` sets both stiffnesses, ``r=math.inf`` is straight towing, ``k_u=math.inf`` lateral elasticity only, and ``tyre`` is
    ``"rigid"``, ``"linear"`` or ``"brush"``. :attr:`parameters` is the table of all keys. A wheel does not change: :meth:`replace` gives
    another. Wheels with equal parameters are equal. Raises :class:`~arclength.InvalidInput`, whose ``key``, ``value`` and ``allowed``
    say what is wrong.

    The keywords ``threads`` (number of threads, by default that of the processors) and ``progress`` (a function that is called with the
    part that is done, or ``None``, and where the computation is, or ``None``; ``True`` shows a bar of tqdm) are those of every analysis that may take long.
    """

    __slots__ = ("_given", "_values")
    _given: dict[str, str]
    _values: dict[str, float | str]

    #: All parameters: meaning, unit, range and default.
    parameters = ParameterTable()

    def __init__(self, **parameters: float | str) -> None:
        given = {key: text(key, value) for key, value in parameters.items()}
        object.__setattr__(self, "_given", given)
        object.__setattr__(self, "_values", _native.wheel_parameters(list(given.items()), None))

    @classmethod
    def from_file(cls, path: Path) -> Wheel:
        """The wheel of a file of lines ``key = value``."""
        _native.wheel_parameters([], os.fspath(path))
        with open(path, "rb") as file:
            return cls(**tomllib.load(file))

    def save(self, path: Path) -> None:
        """Writes it to a file, for ``--wheel`` of the program and :meth:`from_file`."""
        with open(path, "w", encoding="utf-8", newline="\n") as file:
            file.write(_native.wheel_toml(list(self._given.items())))

    def replace(self, **parameters: float | str) -> Wheel:
        """The same wheel with other values of some parameters."""
        given: dict[str, float | str] = {key: value for key, value in self._given.items() if key not in parameters}
        return Wheel(**{**given, **parameters})

    def as_dict(self) -> dict[str, float | str]:
        """Values of all parameters by key."""
        return dict(self._values)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        values = self._values
        if name in values:
            return values[name]
        if name == "k":
            return values["k_q"]
        if name == "curvature":
            return 1.0 / float(values["r"])
        raise AttributeError(f"a wheel has no `{name}`; its parameters are: {', '.join(values)}")

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a wheel does not change; wheel.replace({name}=...) gives another")

    def __delattr__(self, name: str) -> None:
        raise AttributeError("a wheel does not change")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._values})

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Wheel) and self._values == other._values

    def __hash__(self) -> int:
        return hash(tuple(self._values.items()))

    def __repr__(self) -> str:
        # Infinity is a word here, so that Python reads it back.
        words = {key: key == "tyre" or not math.isfinite(float(value)) for key, value in self._given.items()}
        inside = ", ".join(f"{key}={value!r}" if words[key] else f"{key}={value}" for key, value in self._given.items())
        return f"Wheel({inside})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{key}</td><td>{value}</td><td>{self.parameters[key].unit}</td><td>{self.parameters[key].meaning}</td></tr>"
            for key, value in self._values.items()
            if key in self.parameters
        )
        return f"<table>{rows}</table>"

    def __reduce__(self) -> tuple[object, ...]:
        return (_wheel, (self._given,))

    def _at(self, point: Mapping[str, Any]) -> tuple[Wheel, dict[str, Any]]:
        """The wheel at a point of a sweep, and what of the point is no parameter of it."""
        own = {key: value for key, value in point.items() if key in self.parameters or key in self._values}
        return self.replace(**own), {key: value for key, value in point.items() if key not in own}

    def _identity(self) -> dict[str, Any]:
        """What tells it from other wheels, for sweeps."""
        return {"wheel": self.as_dict()}

    def _run(
        self,
        analysis: str,
        request: Mapping[str, Any],
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Any:
        request = {"set": assignments(self._given), **request}
        return of(run(f"kingpin.{analysis}", request, threads=threads, progress=progress))

    def steady(self, along: Sampled | str | None = None) -> Any:
        """The uniform motion: states, forces, and whether the ground can supply them.

        With ``along=("v", 1, 8, 15)`` at several values of a parameter, as a :class:`~arclength.Branch`.
        """
        if along is None:
            return self._run("steady", {})
        return self._run("steady-along", {"along": sampled("along", along)})

    def stability(self) -> Result:
        """Eigenvalues of the uniform motion (complex, 1/s), whether it is stable (``None``: undecided), its critical speed (m/s)."""
        result: Result = self._run("stability", {})
        return result

    def stability_at(self, points: Mapping[str, Any], *, threads: int | None = None) -> dict[str, np.ndarray[Any, Any]]:
        """What a chart says, at many points at once.

        ``points`` are arrays of shape ``(n,)``, the values of as many parameters as vary, by key: a mapping or a DataFrame. The answer
        has arrays of that shape: ``growth_rate`` (1/s, not a number where there is no uniform motion), ``stable`` (masked where
        rounding could decide it) and ``rolls``. Raises :class:`~arclength.InvalidInput` for a value that is not allowed.
        """
        import numpy as np

        allowed = "arrays of shape (n,), one for each key"
        wrong = InvalidInput(f"points: not columns of equal length; allowed: {allowed}", key="points", allowed=allowed)
        if not (hasattr(points, "keys") and hasattr(points, "__getitem__")):
            raise wrong
        keys = [str(key) for key in points.keys()]
        try:
            arrays = [np.ascontiguousarray(points[key], dtype=float) for key in keys]
        except (TypeError, ValueError):
            raise wrong from None
        if not keys or any(np.shape(points[key]) != arrays[0].shape or array.ndim != 1 for key, array in zip(keys, arrays, strict=True)):
            raise wrong
        at_once = thread_count(threads)
        parts = []
        try:
            # Between parts Python listens to Ctrl-C.
            for start in range(0, max(len(arrays[0]), 1), _POINTS_AT_ONCE):
                part = [array[start : start + _POINTS_AT_ONCE] for array in arrays]
                parts.append(_native.stability_at(list(self._given.items()), keys, part, at_once))
        except KeyboardInterrupt:
            done = min(len(parts) * _POINTS_AT_ONCE, len(arrays[0]))
            raise Interrupted(f"interrupted after {done} of {len(arrays[0])} points") from None
        growth_rate, stable, rolls = (np.concatenate(column) for column in zip(*parts, strict=True))
        undecided = np.isnan(stable)
        return {
            "growth_rate": growth_rate,
            "stable": np.ma.MaskedArray(stable == 1.0, mask=undecided),
            "rolls": rolls == 1.0,
        }

    stability_at.batched = True  # type: ignore[attr-defined]  # a sweep hands it arrays

    def chart(
        self,
        x: Sampled | str = ("v", 0.1, 12.0, 240),
        y: Sampled | str = ("l", 0.02, 0.3, 141),
        *,
        overlay: Mapping[str, float | Iterable[float]] | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Chart:
        """Stability chart over two parameters; ``overlay`` are values of a third for which its limits are drawn too."""
        lists = {key: ",".join(text(key, value) for value in _listed(values)) for key, values in (overlay or {}).items()}
        request = {"x": sampled("x", x), "y": sampled("y", y), "overlay": assignments(lists)}
        result: Chart = self._run("chart", request, threads, progress)
        return result

    def hopf(
        self,
        along: Along,
        *,
        monitors: Monitors = (),
        until: Mapping[str, Any] | None = None,
        steps: int = 10_000,
        finer: int = 1,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> HopfPoints:
        """Hopf points of the uniform motion along a parameter, ``("v", 1, 12)``, with frequency (rad/s) and first Lyapunov coefficient.

        ``monitors`` are expressions in states, parameters, ``friction_force``, ``king_pin_force`` and ``damper_power`` that are recorded, or a
        mapping to values at which a motion is wanted; ``until`` maps expressions to values at which the search ends.

        Raises :class:`~arclength.ComputationFailed` where there is none.
        """
        request = {
            "along": _interval("along", along),
            "monitors": recorded(monitors, until),
            "steps": whole("steps", steps),
            "finer": whole("finer", finer),
        }
        result: HopfPoints = self._run("hopf", request, threads, progress)
        return result

    def cycles(
        self,
        along: Along,
        *,
        at: float | Iterable[float] = (),
        samples: Path | Mapping[str, Any] | None = None,
        stay: bool = False,
        monitors: Monitors = (),
        until: Mapping[str, Any] | None = None,
        steps: int = 10_000,
        finer: int = 1,
        tolerance: float = 1e-8,
        intervals: int = 2000,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Cycles:
        """Limit cycles along a parameter from its Hopf points there, or from ``samples`` of an orbit over one period.

        ``at`` are values at which cycles are wanted exactly. Each point has its multipliers, its error estimate and its forces.
        ``monitors`` and ``until`` are as those of :meth:`hopf`, made of ``max(..)``, ``min(..)``, ``mean(..)``, ``at(.., phase)``, ``period`` and
        parameters.
        """
        with ExitStack() as stack:
            source = None if samples is None else {"samples": stack.enter_context(samples_on_disk(samples))}
            return _cycles(
                self, source, along, at, stay, monitors, until, steps, finer, tolerance, intervals, threads, progress
            )

    def locus(
        self,
        first: Along,
        second: Along,
        *,
        label: str = "HB1",
        at: float | Iterable[float] = (),
        hold: str | tuple[str, float] | None = None,
        monitors: Monitors = (),
        until: Mapping[str, Any] | None = None,
        steps: int = 10_000,
        finer: int = 1,
        tolerance: float = 1e-8,
        intervals: int = 2000,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> WheelBranch:
        """The curve of Hopf points in two parameters through the Hopf point ``label`` along the first of them.

        From other points of other branches: :meth:`WheelPoint.locus`, which has the keywords.
        """
        return self.hopf(first, threads=threads)[label].locus(
            first,
            second,
            at=at,
            hold=hold,
            monitors=monitors,
            until=until,
            steps=steps,
            finer=finer,
            tolerance=tolerance,
            intervals=intervals,
            threads=threads,
            progress=progress,
        )

    def shimmy(
        self,
        along: Along,
        *,
        at: float | Iterable[float] = (),
        steps: int = 500,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> WheelBranch:
        """Large stable shimmy with sliding along a parameter, followed through its changes of phases."""
        request = {"along": _interval("along", along), "at": numbers("at", at), "steps": whole("steps", steps)}
        result: WheelBranch = self._run("shimmy", request, threads, progress)
        return result

    def simulate(
        self,
        duration: float,
        *,
        perturb: Mapping[str, float] | None = None,
        blow: float = 0.0,
        points: int = 1001,
        contact: Contact = "rolling",
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Motion:
        """The motion (``duration`` in s) that starts at the uniform one, changed by ``perturb={"psi": 0.1}`` and a sideways ``blow`` (N s).

        ``contact`` is ``"rolling"`` or ``"sliding"``: then the wheel slides where rolling takes more than the static friction.
        """
        request = {
            "duration": number("duration", duration),
            "perturb": named("perturb", perturb),
            "blow": number("blow", blow),
            "points": whole("points", points),
            "contact": word("contact", contact, Contact),
        }
        result: Motion = self._run("simulate", request, threads, progress)
        return result

    def basin(
        self,
        x: Sampled | str = ("psi", -1.0, 1.0, 81),
        y: Sampled | str = ("Omega", -60.0, 60.0, 61),
        *,
        samples: int | None = None,
        seed: int = 1,
        contact: Contact | None = None,
        duration: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Basin:
        """Where motions end, over two states of their start, or from so many random ``samples`` in that rectangle."""
        request = {
            "x": sampled("x", x),
            "y": sampled("y", y),
            "samples": None if samples is None else whole("samples", samples),
            "seed": whole("seed", seed),
            "contact": optional_word("contact", contact, Contact),
            "duration": optional("duration", duration),
        }
        result: Basin = self._run("basin", request, threads, progress)
        return result

    def safe_kick(
        self,
        kind: Kick = "impulse",
        *,
        largest: float | None = None,
        contact: Contact | None = None,
        duration: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Result:
        """The smallest disturbance from which the wheel does not return: ``"impulse"`` (N s), ``"release-angle"`` (rad), ``"jolt"``
        (m/s) or ``"step-steer"`` (1/m), in both directions."""
        request = {
            "kind": word("kind", kind, Kick),
            "largest": optional("largest", largest),
            "contact": optional_word("contact", contact, Contact),
            "duration": optional("duration", duration),
        }
        result: Result = self._run("safe-kick", request, threads, progress)
        return result

    def margin(
        self,
        along: Sampled | str = ("v", 1.0, 8.0, 15),
        *,
        kind: Kick = "impulse",
        largest: float | None = None,
        contact: Contact | None = None,
        duration: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> WheelBranch:
        """The safe disturbance along a parameter beside the amplitude of the unstable limit cycle."""
        request = {
            "along": sampled("along", along),
            "kind": word("kind", kind, Kick),
            "largest": optional("largest", largest),
            "contact": optional_word("contact", contact, Contact),
            "duration": optional("duration", duration),
        }
        result: WheelBranch = self._run("margin", request, threads, progress)
        return result

    def damper(
        self,
        up_to: float,
        *,
        radius: Conditions | None = None,
        load: Conditions | None = None,
        small_motions: bool = False,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Result:
        """The smallest dampers with which no shimmy is born up to a speed (m/s), and with which no large cycle is found either.

        They are enough on all circles of ``radius`` (m) and under all loads ``load`` (N, ``F_Az``), each all values between two, ``(1,
        math.inf)``, or each of a list; without, at the wheel's own."""
        request = {
            "up_to": {"key": "v", "value": text("up_to", up_to)},
            "radius": conditions("radius", radius),
            "load": conditions("load", load),
            "small_motions": bool(small_motions),
        }
        result: Result = self._run("damper", request, threads, progress)
        return result

    def fit(
        self,
        records: Any,
        *,
        estimate: Iterable[str] = (),
        states: Iterable[str] = (),
        start: Mapping[str, float | str] | None = None,
        offset: Iterable[str] = (),
        sigma: Mapping[str, float] | None = None,
        blow: bool = True,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Fit:
        """Parameters from records of motions, with their intervals.

        A record is a ``.csv`` file or columns (a mapping, a DataFrame) with ``t`` (s) and states, or a pair of one and the parameters at
        which it was taken: ``(columns, {"v": 1.5})``; ``records`` is one or a list. ``estimate`` are keys, by default the usual ones;
        ``start`` says what is known of states at the first sample (a value, ``"uniform"``, ``"free"``); ``offset`` are states whose
        instruments have an unknown zero; ``sigma`` are known standard deviations; without ``blow`` no safe blow is computed.
        """
        listed = records if isinstance(records, list) else [records]
        with ExitStack() as stack:
            asked = []
            for record in listed:
                samples, at = record if isinstance(record, tuple) else (record, {})
                file = stack.enter_context(samples_on_disk(samples))
                asked.append({"file": file, "set": assignments(at)})
            request = {
                "records": asked,
                "estimate": _words("estimate", estimate),
                "states": _words("states", states),
                "start": assignments(start or {}),
                "offset": _words("offset", offset),
                "sigma": assignments(sigma or {}),
                "no_blow": not blow,
            }
            result: Fit = self._run("fit", request, threads, progress)
            return result

    def report(
        self,
        out: Path,
        *,
        up_to: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Result:
        """Writes a page about the wheel with pictures and data into the folder ``out``; the result has the findings and the files."""
        speed = None if up_to is None else {"key": "v", "value": text("up_to", up_to)}
        result: Result = self._run("report", {"out": os.fspath(out), "up_to": speed}, threads, progress)
        return result


def _wheel(given: dict[str, str]) -> Wheel:
    return Wheel(**given)


def _listed(values: Any) -> list[Any]:
    return list(values) if isinstance(values, Iterable) and not isinstance(values, str) else [values]


def _words(key: str, words: Iterable[str]) -> list[str]:
    if isinstance(words, str):
        raise InvalidInput(f"{key} {words!r}: a list of keys is wanted; allowed: [{words!r}]", key=key, value=words)
    return list(words)


def _interval(field: str, along: Along) -> dict[str, Any]:
    asked = interval(field, along)
    if "start" not in asked:
        raise InvalidInput(
            f'{field} {along!r}: from where to where; allowed: ("KEY", a, b)', key=field, value=repr(along), allowed='("KEY", a, b)'
        )
    return asked


def _cycles(
    wheel: Wheel,
    source: dict[str, Any] | None,
    along: Along,
    at: float | Iterable[float],
    stay: bool,
    monitors: Monitors,
    until: Mapping[str, Any] | None,
    steps: int,
    finer: int,
    tolerance: float,
    intervals: int,
    threads: int | None,
    progress: Progress | None,
) -> Cycles:
    request = {
        "from": source,
        "along": _interval("along", along),
        "at": numbers("at", at),
        "stay": bool(stay),
        "monitors": recorded(monitors, until),
        "steps": whole("steps", steps),
        "finer": whole("finer", finer),
        "tolerance": number("tolerance", tolerance),
        "intervals": whole("intervals", intervals),
    }
    result: Cycles = wheel._run("cycles", request, threads, progress)
    return result


class WheelPoint(Point):
    """A point of a branch of a wheel. What has a label can be started from; the wheel is that of the branch."""

    __slots__ = ()

    def cycles(
        self,
        along: Along,
        *,
        at: float | Iterable[float] = (),
        set: Mapping[str, float | str] | None = None,
        stay: bool = False,
        monitors: Monitors = (),
        until: Mapping[str, Any] | None = None,
        steps: int = 10_000,
        finer: int = 1,
        tolerance: float = 1e-8,
        intervals: int = 2000,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Cycles:
        """Limit cycles along a parameter from here: those born at a Hopf point or a period doubling, else the branch through it."""
        with self.branch._file() as path:
            source = {"path": path, "label": self._label()}
            return _cycles(
                Wheel(**(set or {})),
                source,
                along,
                at,
                stay,
                monitors,
                until,
                steps,
                finer,
                tolerance,
                intervals,
                threads,
                progress,
            )

    def locus(
        self,
        first: Along,
        second: Along,
        *,
        at: float | Iterable[float] = (),
        hold: str | tuple[str, float] | None = None,
        monitors: Monitors = (),
        until: Mapping[str, Any] | None = None,
        steps: int = 10_000,
        finer: int = 1,
        tolerance: float = 1e-8,
        intervals: int = 2000,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> WheelBranch:
        """The curve of such points in two parameters: Hopf points, folds, period doublings, torus bifurcations.

        ``hold`` is an expression that keeps its value, perhaps with that value, along any uniform motions or cycles: ``("max(psi)", 0.3)``.
        """
        with self.branch._file() as path:
            request = {
                "from": {"path": path, "label": self._label()},
                "in": [_interval("first", first), _interval("second", second)],
                "at": numbers("at", at),
                "hold": held(hold),
                "monitors": recorded(monitors, until),
                "steps": whole("steps", steps),
                "finer": whole("finer", finer),
                "tolerance": number("tolerance", tolerance),
                "intervals": whole("intervals", intervals),
            }
            result: WheelBranch = of(run("kingpin.locus", request, threads=threads, progress=progress))
            return result


class WheelBranch(Branch):
    """A branch of a wheel."""

    _point = WheelPoint

    if TYPE_CHECKING:

        @cached_property
        def points(self) -> tuple[WheelPoint, ...]: ...  # noqa: D102

        def __iter__(self) -> Iterator[WheelPoint]: ...

        @overload
        def __getitem__(self, key: str | int) -> WheelPoint: ...
        @overload
        def __getitem__(self, key: slice) -> tuple[WheelPoint, ...]: ...
        def __getitem__(self, key: str | int | slice) -> Any: ...


class HopfPoints(WheelBranch):
    """Hopf points of the uniform motion."""


class Cycles(WheelBranch):
    """Branches of limit cycles."""


class Chart(Result):
    """A stability chart: ``x["values"]`` of shape ``(m,)``, ``y["values"]`` ``(n,)``, and arrays of shape ``(n, m)``."""

    def _plane(self, name: str) -> np.ndarray[Any, Any]:
        return self.columns[name].reshape(len(self.document["y"]["values"]), len(self.document["x"]["values"]))

    @property
    def growth_rate(self) -> np.ndarray[Any, Any]:
        """Largest real part (1/s) of the eigenvalues, not a number where there is no uniform motion; shape ``(n, m)``."""
        return self._plane("growth_rate")

    @property
    def stable(self) -> np.ndarray[Any, Any]:
        """Whether the uniform motion is stable, ``None`` where that is undecided; shape ``(n, m)``."""
        return self._plane("stable")

    @property
    def rolls(self) -> np.ndarray[Any, Any]:
        """Whether the ground can supply what rolling takes; shape ``(n, m)``."""
        return self._plane("rolls")

    def to_xarray(self) -> Any:
        """The chart as an ``xarray.Dataset`` over its two parameters, with ``units`` as attributes (needs xarray)."""
        import xarray

        x, y = self.document["x"], self.document["y"]
        plane = (y["key"], x["key"])
        return xarray.Dataset(
            {
                "growth_rate": (plane, self.growth_rate, {"units": "1/s"}),
                "stable": (plane, decided(self.stable)),
                "rolls": (plane, decided(self.rolls)),
            },
            coords={axis["key"]: (axis["key"], axis["values"], {"units": axis["unit"]}) for axis in (y, x)},
        )

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draws the growth rate with the limits of stability (solid) and of rolling (dotted); returns the axes."""
        from .plotting import plot_chart

        return plot_chart(self, ax, style)


class Motion(Result):
    """A motion of a wheel: ``motion["psi"]`` is an array of shape ``(samples,)``, ``motion["t"]`` the times (s)."""

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        """Names of its columns."""
        return iter(self.columns)

    def __contains__(self, name: object) -> bool:
        """Whether it has this column."""
        return name in self.columns

    def plot(self, *names: str, ax: Axes | None = None, **style: Any) -> Axes:
        """Draws columns over the time, by default the caster angle; returns the axes."""
        from .plotting import plot_history

        return plot_history(self, ax, names or ("psi",), style)


class Fit(Result):
    """Parameters from records, with their intervals (``estimates``)."""

    @property
    def wheel(self) -> Wheel:
        """The wheel with the estimates."""
        estimates = {entry["key"]: entry["value"] for entry in self.document["estimates"] if entry["value"] is not None}
        return Wheel(**{**self.document["parameters"], **estimates})


class Basin(Result):
    """Where motions end, over two states of their start."""


#: Classes of results by their schema.
KINDS: dict[str, type[Result]] = {
    "kingpin.steady-along": WheelBranch,
    "kingpin.hopf": HopfPoints,
    "kingpin.cycles": Cycles,
    "kingpin.locus": WheelBranch,
    "kingpin.cycle_locus": WheelBranch,
    "kingpin.shimmy": WheelBranch,
    "kingpin.margin": WheelBranch,
    "kingpin.chart": Chart,
    "kingpin.simulate": Motion,
    "kingpin.basin": Basin,
    "kingpin.fit": Fit,
}
