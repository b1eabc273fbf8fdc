"""Models, and what is computed of them: equilibria, cycles, curves of special points, motions."""

from __future__ import annotations

import csv
import json
import os
import re
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property
from typing import TYPE_CHECKING, Any, overload

from . import _native
from ._requests import (
    Along,
    Direction,
    Method,
    Progress,
    held,
    interval,
    monitors,
    named,
    number,
    numbers,
    optional,
    run,
    whole,
    word,
)
from .errors import InvalidInput, NotTraceable
from .results import Branch, Path, Point, Result, of

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes

Monitors = Mapping[str, float | Iterable[float]] | Iterable[str]


class Parameters(Mapping[str, Any]):
    """Values of parameters as a traced function gets them: ``p["mu"]``, ``p.mu``, ``p[0]``, ``p[0:2]``, and ``a, b = p.values()``."""

    __slots__ = ("_values",)

    def __init__(self, values: Mapping[str, Any]) -> None:
        object.__setattr__(self, "_values", dict(values))

    def __getitem__(self, name: str | int | slice) -> Any:
        values: dict[str, Any] = self._values
        if isinstance(name, (int, slice)):
            return list(values.values())[name]
        return values[name]

    def __getattr__(self, name: str) -> Any:
        try:
            return object.__getattribute__(self, "_values")[name]
        except KeyError:
            known = ", ".join(object.__getattribute__(self, "_values"))
            raise AttributeError(f"there is no parameter `{name}`; there are: {known}") from None

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("parameters do not change in a right-hand side")

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return f"Parameters({self._values!r})"


class Model:
    """A system of ordinary differential equations ``x' = f(x, p)``.

    ``function(x, p)`` is ordinary Python with NumPy or :mod:`math`: ``x`` is an array of shape ``(len(states),)``, ``p`` has the
    parameters by name (:class:`Parameters`), and it returns the derivatives: a list, an array, or a mapping by name of the state. It is
    called once to record its operations, which are then differentiated and run natively, and at a few points with numbers, to compare.
    Loops, inner functions, ``np.where`` and arrays filled by assignment are recorded. What would have to choose by a value
    (``if x > 0``, ``while``, ``min``), and what was recorded otherwise than the function computes it, is refused with
    :class:`~arclength.NotTraceable`, which says where and what to write instead.

    ``states`` are names, or names with initial values; ``parameters`` are names with values. Names consist of the letters a to z,
    digits and underscores, and differ in more than capital letters.
    """

    def __init__(
        self,
        function: Callable[[Any, Any], Any],
        states: Sequence[str] | Mapping[str, float],
        parameters: Mapping[str, float] | None = None,
        *,
        name: str | None = None,
    ) -> None:
        from ._trace import trace
        from ._trace.checking import check

        if isinstance(states, str) or not isinstance(states, (Mapping, Sequence)):
            allowed = "names, or a mapping from names to initial values"
            raise InvalidInput(f"states {states!r}: not names; allowed: {allowed}", key="states", value=repr(states), allowed=allowed)
        initial = dict(states) if isinstance(states, Mapping) else dict.fromkeys(states, 0.0)
        if len(initial) != len(states):
            message = "two states have the same name; allowed: names that differ"
            raise InvalidInput(message, key="states", value=repr(list(states)), allowed="names that differ")
        if not isinstance(parameters or {}, Mapping):
            raise InvalidInput(
                "parameters: not a mapping; allowed: names with their values, {\"a\": 1.0}",
                key="parameters",
                value=repr(parameters),
                allowed="names with values",
            )
        values = {key: _finite(key, value) for key, value in (parameters or {}).items()}
        try:
            source = trace(function, {key: _finite(key, value) for key, value in initial.items()}, values)
        except InvalidInput as error:
            told = re.match(r"`([^`]*)`: ", error.message) if error.key is None else None
            if told is not None:
                error.key, error.value = "parameters" if told[1] in values else "states", told[1]
                error.allowed = error.allowed or "other names: letters a to z, digits, underscores, different in more than capital letters"
            raise
        self._stored = {"name": name or getattr(function, "__name__", "model"), "source": source}
        #: The function from which it was traced, if it was.
        self.function: Callable[[Any, Any], Any] | None = function
        check(function, self, initial, values)

    @classmethod
    def from_ode(cls, model: Path, *, name: str | None = None) -> Model:
        """A model in XPPAUT's ``.ode`` format: its text, or the path of its file.

        A string with an equals sign or more than one line is a text. Raises :class:`~arclength.InvalidModel` with line and column of
        what cannot be read.
        """
        if isinstance(model, str) and ("\n" in model or "=" in model):
            return cls._of_text(name or "model.ode", model)
        if not isinstance(model, (str, os.PathLike)):
            allowed = "the text of a model, or the path of its file"
            raise InvalidInput(f"model {model!r}: not a model; allowed: {allowed}", key="model", value=repr(model), allowed=allowed)
        request = {"source": {"file": os.fspath(model)}}
        native = _native.NativeModel(json.dumps(request))
        return cls._of_text(name or native.name, native.source)

    @classmethod
    def from_sympy(
        cls, equations: Mapping[Any, Any], parameters: Mapping[Any, float] | None = None, *, name: str = "model"
    ) -> Model:
        """A model of SymPy expressions: the derivative of each state (a symbol or its name), and values of the parameters.

        Expressions may be texts: a name in them is that state or parameter where there is one (``E``, ``beta``, ``S``), else what it is
        for SymPy. Raises :class:`~arclength.InvalidInput` for a symbol that is neither, and :class:`~arclength.NotTraceable` for a
        function without a rule (needs sympy).
        """
        import sympy

        names = [str(symbol) for symbol in [*equations, *(parameters or {})]]
        # Whatever they are called, symbols are no words of Python and no functions.
        variables = {name: sympy.Dummy(f"x{index}") for index, name in enumerate(names)}
        expressions = [_of_sympy(sympy, expression, variables) for expression in equations.values()]
        function = sympy.lambdify(list(variables.values()), expressions, modules="numpy", cse=True)

        def derivatives(x: Any, p: Any) -> Any:
            return function(*x, *p.values())

        states = [str(state) for state in equations]
        values = {str(key): value for key, value in (parameters or {}).items()}
        try:
            return cls(derivatives, states, values, name=name)
        except NameError as error:
            unknown = error.name or str(error)
            message = f"the function {unknown} of SymPy has no rule; write it by others"
            raise NotTraceable(message, key=unknown, allowed="elementary functions") from None

    @classmethod
    def from_casadi(
        cls,
        system: Mapping[str, Any],
        parameters: Mapping[str, float] | None = None,
        *,
        start: Mapping[str, float] | None = None,
        name: str = "model",
    ) -> Model:
        """A model of CasADi's expressions: ``{"x": x, "p": p, "ode": f}`` of SX, as CasADi's integrators take it (needs casadi).

        Names are those of the symbols. ``parameters`` are their values, ``start`` initial values of states other than 0. Raises
        :class:`~arclength.NotTraceable` for an operation without a rule.
        """
        from ._formats import of_casadi

        function, states, names = of_casadi(system)
        given, initial = dict(parameters or {}), dict.fromkeys(states, 0.0) | dict(start or {})
        for field, known, values in (("parameters", names, given), ("start", states, initial)):
            wrong = sorted(set(known) ^ set(values))
            if wrong:
                raise InvalidInput(
                    f"{field} {wrong[0]}: every symbol has a value, and nothing else; allowed: {', '.join(known)}",
                    key=field,
                    value=wrong[0],
                    allowed=", ".join(known),
                )
        return cls(function, initial, {key: given[key] for key in names}, name=name)

    @classmethod
    def from_sbml(cls, model: Path, *, name: str | None = None) -> Model:
        """A model in SBML: its text, or the path of its file (needs ``pip install arclength[sbml]``).

        COPASI writes it in the format of XPPAUT, in which it is read: amounts of species are states, names are as COPASI shortens them.
        """
        from ._formats import ode_of_sbml

        return cls._of_text(name or "sbml", ode_of_sbml(_text_of(model, "<")))

    @classmethod
    def from_antimony(cls, model: Path, *, name: str | None = None) -> Model:
        """A model in Antimony: its text, or the path of its file (needs ``pip install arclength[sbml]``). See :meth:`from_sbml`."""
        from ._formats import ode_of_sbml, sbml_of_antimony

        return cls._of_text(name or "antimony", ode_of_sbml(sbml_of_antimony(_text_of(model, "\n;"))))

    @classmethod
    def _of_text(cls, name: str, source: str) -> Model:
        self = cls.__new__(cls)
        self._stored = {"name": name, "source": source}
        self.function = None
        self._native  # noqa: B018  a text that is no model is refused here
        return self

    @cached_property
    def _native(self) -> _native.NativeModel:
        return _native.NativeModel(json.dumps({"source": {"text": self._stored}}))

    @property
    def name(self) -> str:
        """Its name."""
        return self._stored["name"]

    @property
    def source(self) -> str:
        """Its text in the ``.ode`` format, which result files hold and the programs read."""
        return self._stored["source"]

    @property
    def states(self) -> dict[str, float]:
        """States with their initial values."""
        return self._native.states

    @property
    def parameters(self) -> dict[str, float]:
        """Parameters with their values."""
        return self._native.parameters

    @property
    def auxiliaries(self) -> list[str]:
        """Names of auxiliary quantities (``aux`` in the text)."""
        return self._native.auxiliaries

    @property
    def warnings(self) -> list[str]:
        """What its reader warns of."""
        return self._native.warnings

    def __call__(
        self, state: Any, parameters: Mapping[str, float] | None = None, *, t: float = 0.0
    ) -> np.ndarray[Any, Any]:
        """The right-hand side at a state of shape ``(n,)``, natively; parameters that are not given are as in the model."""
        values = self.parameters
        _ = named("parameters", parameters)
        unknown = [key for key in parameters or {} if key not in values]
        if unknown:
            allowed = ", ".join(values) or "none"
            raise InvalidInput(
                f"parameters {unknown[0]}: the model has no such parameter; allowed: {allowed}",
                key=unknown[0],
                allowed=allowed,
            )
        given = {**values, **{key: _finite(f"parameters {key}", value) for key, value in (parameters or {}).items()}}
        return self._native.evaluate(_finite("t", t), _vector("state", state, len(self.states)), _vector("parameters", list(given.values()), len(given)))

    def _at(self, point: Mapping[str, Any]) -> tuple[Model, dict[str, Any]]:
        """The model with keywords for a point of a sweep: values of parameters, and what of the point is none."""
        own = {key: value for key, value in point.items() if key in self.parameters}
        return self, {"set": own, **{key: value for key, value in point.items() if key not in own}}

    def _identity(self) -> dict[str, Any]:
        """What tells it from other models, for sweeps."""
        return {"model": self.source}

    def __repr__(self) -> str:
        parameters = ", ".join(f"{name}={value!r}" for name, value in self.parameters.items())
        return f"<Model {self.name}: states {', '.join(self.states)}; parameters {parameters}>"

    def __reduce__(self) -> tuple[object, ...]:
        return (_of_text, (self.name, self.source))

    def save(self, path: Path) -> None:
        """Writes its text to a ``.ode`` file, for the programs."""
        with open(path, "w", encoding="utf-8", newline="\n") as file:
            file.write(self.source)

    def _request(
        self,
        set: Mapping[str, float] | None,
        start: Mapping[str, float] | None,
        named_set: str | None,
        freeze: float | None,
    ) -> dict[str, Any]:
        return {
            "source": {"text": self._stored},
            "named_set": named_set,
            "set": named("set", set),
            "start": named("start", start),
            "freeze": optional("freeze", freeze),
        }

    def equilibria(
        self,
        along: Along,
        *,
        at: float | Iterable[float] = (),
        set: Mapping[str, float] | None = None,
        start: Mapping[str, float] | None = None,
        named_set: str | None = None,
        freeze: float | None = None,
        monitors: Monitors = (),
        until: Mapping[str, Any] | None = None,
        steps: int = 10_000,
        finer: int = 1,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Equilibria:
        """Follows the equilibria along a parameter from the one near the initial state, with folds, branch points, Hopf points.

        Raises :class:`~arclength.InvalidInput` and :class:`~arclength.ComputationFailed`. Ctrl-C ends the branch where it is.

        Parameters
        ----------
        along: parameter and its interval, ``("mu", -1, 1)``.
        at: values of the parameter at which equilibria are wanted exactly.
        set, start: values of parameters and initial values of states in place of those of the model.
        named_set: a named set of values of a ``.ode`` model.
        freeze: time at which a right-hand side that depends on it is frozen.
        monitors: expressions that are recorded, or a mapping to values at which a point is wanted.
        until: expressions with values at which the branch ends.
        steps, finer: most steps in one direction; how many times shorter they are.
        threads, progress: number of threads; a function that is told the progress, or ``True`` for a bar of tqdm.
        """
        model = self._request(set, start, named_set, freeze)
        return _equilibria(model, along, at, monitors, until, steps, finer, threads, progress)

    def cycles(
        self,
        samples: Path | Mapping[str, Any],
        along: Along,
        *,
        set: Mapping[str, float] | None = None,
        at: float | Iterable[float] = (),
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
        """Follows limit cycles along a parameter from samples of an orbit over one period, stable or not.

        ``samples`` is a ``.csv`` file or columns (a mapping, a DataFrame): ``t`` and all states, of which the last row repeats the
        first one period later. The keywords are those of :meth:`ModelPoint.cycles`. From a Hopf point cycles are followed by
        ``branch["HB1"].cycles(...)``.
        """
        with samples_on_disk(samples) as path:
            return _cycles(
                {"samples": path},
                {"text": self._stored},
                along,
                set,
                at=at,
                stay=stay,
                monitors=monitors,
                until=until,
                steps=steps,
                finer=finer,
                tolerance=tolerance,
                intervals=intervals,
                threads=threads,
                progress=progress,
            )

    def simulate(
        self,
        duration: float | None = None,
        *,
        set: Mapping[str, float] | None = None,
        start: Mapping[str, float] | None = None,
        named_set: str | None = None,
        freeze: float | None = None,
        points: int | None = None,
        t0: float | None = None,
        transient: float | None = None,
        bound: float | None = None,
        tolerance: float | None = None,
        max_step: float | None = None,
        method: Method = "auto",
        section: str | None = None,
        direction: Direction = "both",
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> History:
        """Follows the motion from the initial state for a time; what is not given is as the model has it in its lines ``@``.

        The keywords are ``points`` (number of samples), ``t0``, ``transient``, ``bound``, ``tolerance``, ``max_step``, ``method``
        (``"auto"``, ``"explicit"``, ``"implicit"``), ``section`` (``"x=0"``: samples are at its crossings, those of one ``direction``,
        ``"rising"`` or ``"falling"``, or ``"both"``), ``threads`` and ``progress``. Ctrl-C ends the motion where it is.
        """
        return _simulate(
            self._request(set, start, named_set, freeze),
            duration,
            points=points,
            t0=t0,
            transient=transient,
            bound=bound,
            tolerance=tolerance,
            max_step=max_step,
            method=method,
            section=section,
            direction=direction,
            threads=threads,
            progress=progress,
        )


def _of_sympy(sympy: Any, given: Any, variables: Mapping[str, Any]) -> Any:
    """An expression in these variables."""
    allowed = f"an expression in {', '.join(variables)}"
    try:
        expression = sympy.sympify(given, locals={name: sympy.Symbol(name) for name in variables} if isinstance(given, str) else None)
    except (sympy.SympifyError, SyntaxError, TypeError, AttributeError) as error:
        told = str(error).strip().splitlines() or [type(error).__name__]
        message = f"{given}: SymPy cannot read it ({told[0]}); allowed: {allowed}"
        raise InvalidInput(message, key="equations", value=str(given), allowed=allowed) from None
    if not isinstance(expression, sympy.Expr):
        raise InvalidInput(f"{given}: not an expression of numbers; allowed: {allowed}", key="equations", value=str(given), allowed=allowed)
    if expression.has(sympy.zoo, sympy.nan, sympy.oo, -sympy.oo):
        message = f"{given}: not finite; allowed: finite numbers"
        raise NotTraceable(message, key="equations", value=str(given), allowed="finite numbers")
    unknown = sorted({str(symbol) for symbol in expression.free_symbols} - set(variables))
    if unknown:
        listed = ", ".join(variables)
        raise InvalidInput(f"{unknown[0]}: neither a state nor a parameter; allowed: {listed}", key=unknown[0], allowed=listed)
    return expression.xreplace({symbol: variables[str(symbol)] for symbol in expression.free_symbols})


def _text_of(model: Path, signs: str) -> str:
    """A text, known by one of these signs, or what stands in a file."""
    if isinstance(model, str) and any(sign in model for sign in signs):
        return model
    try:
        with open(model, encoding="utf-8") as file:
            return file.read()
    except OSError as error:
        raise InvalidInput(f"{os.fspath(model)}: {error.strerror}", key="model", value=os.fspath(model)) from None


def _of_text(name: str, source: str) -> Model:
    return Model._of_text(name, source)


def _finite(key: str, value: Any) -> float:
    given = number(key, value)
    if isinstance(given, str):
        raise InvalidInput(f"{key} {given}: not finite; allowed: a finite number", key=key, value=given, allowed="a finite number")
    return given


def _any_number(key: str, value: Any) -> float:
    """A number, or none: not a number."""
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InvalidInput(f"{key} {value!r}: not a number; allowed: a number", key=key, value=repr(value), allowed="a number") from None


def _vector(key: str, values: Any, count: int) -> np.ndarray[Any, Any]:
    import numpy as np

    allowed = f"{count} numbers, of shape ({count},)"
    try:
        vector = np.ascontiguousarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InvalidInput(f"{key} {values!r}: not numbers; allowed: {allowed}", key=key, value=repr(values), allowed=allowed) from None
    if np.shape(values) != (count,):
        shape = str(np.shape(values))
        raise InvalidInput(f"{key} of shape {shape}; allowed: {allowed}", key=key, value=shape, allowed=allowed)
    return vector


@contextmanager
def samples_on_disk(samples: Path | Mapping[str, Any]) -> Iterator[str]:
    """A file of samples, or columns as such a file for as long as they are read."""
    if isinstance(samples, (str, os.PathLike)):
        yield os.fspath(samples)
        return
    if not (hasattr(samples, "keys") and hasattr(samples, "__getitem__")):
        allowed = "a .csv file, or columns (a mapping, a DataFrame)"
        raise InvalidInput(f"samples {samples!r}: not samples; allowed: {allowed}", key="samples", value=repr(samples), allowed=allowed)
    names = list(samples.keys())
    columns = [[_any_number(f"samples {name}", value) for value in samples[name]] for name in names]
    if len({len(column) for column in columns}) != 1:
        raise InvalidInput("the columns of the samples differ in length", key="samples", allowed="columns of equal length")
    with tempfile.TemporaryDirectory(prefix="arclength-") as folder:
        path = os.path.join(folder, "samples.csv")
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(names)
            writer.writerows([repr(value) for value in row] for row in zip(*columns, strict=True))
        yield path


def _equilibria(
    model: dict[str, Any],
    along: Along,
    at: float | Iterable[float],
    recorded: Monitors,
    until: Mapping[str, Any] | None,
    steps: int,
    finer: int,
    threads: int | None,
    progress: Progress | None,
) -> Equilibria:
    request = {
        "model": model,
        "along": interval("along", along),
        "at": numbers("at", at),
        "monitors": monitors(recorded, until),
        "steps": whole("steps", steps),
        "finer": whole("finer", finer),
    }
    result: Equilibria = of(run("arclength.equilibria", request, threads=threads, progress=progress))
    return result


def _cycles(
    source: dict[str, Any],
    model: dict[str, Any] | None,
    along: Along,
    set: Mapping[str, float] | None,
    *,
    at: float | Iterable[float] = (),
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
    from ._requests import monitors as recorded

    request = {
        "from": source,
        "model": model,
        "set": named("set", set),
        "along": interval("along", along),
        "at": numbers("at", at),
        "monitors": recorded(monitors, until),
        "stay": bool(stay),
        "steps": whole("steps", steps),
        "finer": whole("finer", finer),
        "tolerance": number("tolerance", tolerance),
        "intervals": whole("intervals", intervals),
    }
    result: Cycles = of(run("arclength.cycles", request, threads=threads, progress=progress))
    return result


def _simulate(
    model: dict[str, Any],
    duration: float | None,
    *,
    points: int | None = None,
    t0: float | None = None,
    transient: float | None = None,
    bound: float | None = None,
    tolerance: float | None = None,
    max_step: float | None = None,
    method: Method = "auto",
    section: str | None = None,
    direction: Direction = "both",
    threads: int | None = None,
    progress: Progress | None = None,
) -> History:
    request = {
        "model": model,
        "duration": optional("duration", duration),
        "points": None if points is None else whole("points", points),
        "t0": optional("t0", t0),
        "transient": optional("transient", transient),
        "bound": optional("bound", bound),
        "tolerance": optional("tolerance", tolerance),
        "max_step": optional("max_step", max_step),
        "method": word("method", method, Method),
    }
    crossing = word("direction", direction, Direction)
    if section is not None:
        left, equals, right = section.partition("=")
        request["section"] = {"expression": f"{left}-({right})" if equals else left, "direction": crossing}
    result: History = of(run("arclength.simulate", request, threads=threads, progress=progress))
    return result


class ModelPoint(Point):
    """A point of a branch of a model. What has a label can be started from; model and parameters are those of the branch."""

    __slots__ = ()

    def equilibria(
        self,
        along: Along,
        *,
        at: float | Iterable[float] = (),
        set: Mapping[str, float] | None = None,
        monitors: Monitors = (),
        until: Mapping[str, Any] | None = None,
        steps: int = 10_000,
        finer: int = 1,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Equilibria:
        """Follows equilibria from here: from a branch point (BP) the other branch, from any other point the branch through it.

        The keywords are those of :meth:`Model.equilibria`.
        """
        with self.branch._file() as path:
            model = {"source": {"point": {"path": path, "label": self._label()}}, "set": named("set", set)}
            return _equilibria(model, along, at, monitors, until, steps, finer, threads, progress)

    def cycles(
        self,
        along: Along,
        *,
        at: float | Iterable[float] = (),
        set: Mapping[str, float] | None = None,
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
        """Follows limit cycles along a parameter from here.

        From a Hopf point (HB) the cycles that are born there, from a period doubling (PD) the doubled ones, from a branch point of
        cycles (BPC) the other branch, from any other cycle, or with ``stay``, the branch through it.

        Raises :class:`~arclength.InvalidInput` and :class:`~arclength.ComputationFailed`. Ctrl-C ends the branch where it is.

        Parameters
        ----------
        along: parameter and its interval, ``("mu", -1, 1)``.
        at: values of the parameter at which cycles are wanted exactly.
        set: values of parameters in place of those of the branch.
        monitors: expressions that are recorded, made of ``max(..)``, ``min(..)``, ``mean(..)``, ``at(.., phase)``, ``period`` and
            parameters, or a mapping to values at which a point is wanted.
        until: expressions with values at which the branch ends.
        steps, finer: most steps in one direction; how many times shorter they are.
        tolerance, intervals: error estimate, relative to the amplitude, that no cycle exceeds; most mesh intervals.
        threads, progress: number of threads; a function that is told the progress, or ``True`` for a bar of tqdm.
        """
        with self.branch._file() as path:
            return _cycles(
                {"path": path, "label": self._label()},
                None,
                along,
                set,
                at=at,
                stay=stay,
                monitors=monitors,
                until=until,
                steps=steps,
                finer=finer,
                tolerance=tolerance,
                intervals=intervals,
                threads=threads,
                progress=progress,
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
    ) -> Locus:
        """Follows the curve of such points in two parameters: folds, Hopf points and branch points of equilibria, folds, period
        doublings and torus bifurcations of cycles, with their points of codimension two.

        ``hold`` is an expression that keeps its value, perhaps with that value, along any equilibria or cycles: ``("period", 50)``. The
        other keywords are those of :meth:`cycles`; ``at`` are values of the first parameter.
        """
        from ._requests import monitors as recorded

        with self.branch._file() as path:
            request = {
                "from": {"path": path, "label": self._label()},
                "in": [interval("first", first), interval("second", second)],
                "at": numbers("at", at),
                "hold": held(hold),
                "monitors": recorded(monitors, until),
                "steps": whole("steps", steps),
                "finer": whole("finer", finer),
                "tolerance": number("tolerance", tolerance),
                "intervals": whole("intervals", intervals),
            }
            result: Locus = of(run("arclength.locus", request, threads=threads, progress=progress))
        return result

    def simulate(
        self,
        duration: float | None = None,
        *,
        set: Mapping[str, float] | None = None,
        start: Mapping[str, float] | None = None,
        points: int | None = None,
        t0: float | None = None,
        transient: float | None = None,
        bound: float | None = None,
        tolerance: float | None = None,
        max_step: float | None = None,
        method: Method = "auto",
        section: str | None = None,
        direction: Direction = "both",
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> History:
        """Follows the motion that starts here, changed where ``set`` and ``start`` say so, for a time.

        The keywords are those of :meth:`Model.simulate`.
        """
        with self.branch._file() as path:
            source = {"point": {"path": path, "label": self._label()}}
            return _simulate(
                {"source": source, "set": named("set", set), "start": named("start", start)},
                duration,
                points=points,
                t0=t0,
                transient=transient,
                bound=bound,
                tolerance=tolerance,
                max_step=max_step,
                method=method,
                section=section,
                direction=direction,
                threads=threads,
                progress=progress,
            )


class ModelBranch(Branch):
    """A branch of a model."""

    _point = ModelPoint

    if TYPE_CHECKING:

        @cached_property
        def points(self) -> tuple[ModelPoint, ...]: ...  # noqa: D102

        def __iter__(self) -> Iterator[ModelPoint]: ...

        @overload
        def __getitem__(self, key: str | int) -> ModelPoint: ...
        @overload
        def __getitem__(self, key: slice) -> tuple[ModelPoint, ...]: ...
        def __getitem__(self, key: str | int | slice) -> Any: ...

    @property
    def of_model(self) -> Model:
        """The model, with the parameters of its text."""
        stored = self.document["model"]
        return Model._of_text(stored["name"], stored["source"])


class Equilibria(ModelBranch):
    """A branch of equilibria."""

    def _of_model(self) -> dict[int, str]:
        points = self.document["points"]
        states = len(points[0]["state"]) if points else 0
        aux = len({name for point in points for name in point.get("aux") or ()})
        # After the label, the value of the parameter and the stability.
        return {**dict.fromkeys(range(3, 3 + states), "state"), **dict.fromkeys(range(3 + states, 3 + states + aux), "aux")}


class Cycles(ModelBranch):
    """A branch of limit cycles."""


class Locus(ModelBranch):
    """A curve of special points in two parameters."""

    def _of_model(self) -> dict[int, str]:
        points = self.document["points"]
        states = len(points[0]["state"]) if points and self.schema == "arclength.locus" else 0
        # After the label both parameters; after frequency and first Lyapunov coefficient the states.
        return {1: "parameter", 2: "parameter", **dict.fromkeys(range(5, 5 + states), "state")}


class History(Result):
    """A motion: ``history["x"]`` is an array of shape ``(samples,)``, ``history["t"]`` the times."""

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        """Names of its columns."""
        return iter(self.columns)

    def __contains__(self, name: object) -> bool:
        """Whether it has this column."""
        return name in self.columns

    @property
    def end(self) -> ModelPoint:
        """Where it ends: a start for :meth:`ModelPoint.cycles` where it has settled on a cycle, and for :meth:`ModelPoint.simulate`."""
        state = {name: float(self.columns[name][-1]) for name in self.document["states"]}
        return ModelPoint({"label": "END", "state": state}, self)  # type: ignore[arg-type]

    def _file(self) -> Any:
        from ._requests import on_disk

        return on_disk(self._native)

    def plot(self, *names: str, ax: Axes | None = None, **style: Any) -> Axes:
        """Draws columns over the time with matplotlib, by default all; returns the axes."""
        from .plotting import plot_history

        return plot_history(self, ax, names or tuple(name for name in self.columns if name != "t"), style)


#: Classes of results by their schema.
KINDS: dict[str, type[Result]] = {
    "arclength.equilibria": Equilibria,
    "arclength.cycles": Cycles,
    "arclength.locus": Locus,
    "arclength.cycle_locus": Locus,
    "arclength.simulate": History,
}
