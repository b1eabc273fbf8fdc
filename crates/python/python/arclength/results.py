"""Results: what every analysis gives, and branches, whose points can be started from."""

from __future__ import annotations

import functools
import html
import json
import os
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar, overload

from . import _native
from ._requests import on_disk
from .errors import InvalidInput, UnknownLabel
from .records import Record, tidy

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    from matplotlib.axes import Axes

    from ._native import NativeResult

Path = str | os.PathLike[str]
Self = TypeVar("Self", bound="Result")


class Columns(Mapping[str, "np.ndarray[Any, Any]"]):
    """The columns of a result as arrays, of shape ``(rows,)``.

    Numbers are ``float64``, not a number where there is none; counts ``uint64``; words, and yes and no, are objects, ``None`` where
    there is none. ``units`` has the units of the columns that have one.
    """

    def __init__(self, native: NativeResult) -> None:
        self._native = native
        self._names = native.column_names()
        self._arrays: dict[str, np.ndarray[Any, Any]] = {}

    @property
    def units(self) -> dict[str, str]:
        """Units by name of the column."""
        return self._native.units()

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        if name not in self._arrays:
            if not isinstance(name, str):
                raise UnknownLabel(
                    f"columns have names, not {name!r}; allowed: {', '.join(self._names)}", key="column", value=repr(name)
                )
            column = self._native.column(name)
            if column is None:
                raise UnknownLabel(
                    f"there is no column `{name}`; there are: {', '.join(self._names)}",
                    key="column",
                    value=name,
                    allowed=", ".join(self._names),
                )
            if isinstance(column, list):
                import numpy as np

                objects = np.empty(len(column), dtype=object)
                objects[:] = column
                column = objects
            self._arrays[name] = column
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"<columns {', '.join(self._names)}>"


class Result:
    """What an analysis gives. The fields of its file are attributes: lists of numbers are arrays."""

    def __init__(self, native: NativeResult) -> None:
        self._native = native

    @property
    def schema(self) -> str:
        """Name of its kind, such as ``arclength.cycles``."""
        return self._native.schema

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C stopped it before its end."""
        return self._native.interrupted

    @property
    def warnings(self) -> list[str]:
        """What is worth knowing of it."""
        return self._native.warnings

    @cached_property
    def document(self) -> dict[str, Any]:
        """Its file, as ``json`` reads it: numbers that are infinite are the text ``"inf"``."""
        document: dict[str, Any] = json.loads(self._native.json())
        return document

    @cached_property
    def parameters(self) -> Record:
        """Every parameter that was used and did not vary."""
        return Record({name: tidy(value) for name, value in self.document["parameters"].items()})

    @cached_property
    def columns(self) -> Columns:
        """Its rows, by columns."""
        return Columns(self._native)

    @property
    def story(self) -> str | None:
        """The story of the run, as ``--explain`` tells it: why it ended and what to do, what was found on the way, meshes and errors."""
        told = self._native.story()
        return told.strip("\n") if told else None

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        document = self.document
        if name not in document or name in ("schema", "points"):
            raise AttributeError(f"`{type(self).__name__}` has no field `{name}`; there are: {', '.join(document)}")
        value = tidy(document[name], name)
        self.__dict__[name] = value
        return value

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.document})

    def __repr__(self) -> str:
        return self._native.table().rstrip("\n")

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(repr(self))}</pre>"

    def _repr_svg_(self) -> str | None:
        return self._native.svg()

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Its columns by Arrow's C interface, for pyarrow, polars, pandas, DuckDB and others."""
        return self._native.stream()

    def to_arrow(self) -> Any:
        """Its columns as a ``pyarrow.Table``, with the units in the metadata of the fields (needs pyarrow)."""
        import pyarrow

        return pyarrow.table(self)

    def to_pandas(self) -> pd.DataFrame:
        """Its columns as a ``pandas.DataFrame``, with the units in ``attrs["units"]`` (needs pandas)."""
        import pandas

        columns: dict[str, Any] = {}
        for name, column in self.columns.items():
            kinds = {type(entry) for entry in column} - {type(None)} if column.dtype == object else set()
            columns[name] = pandas.array(list(column), dtype="boolean") if kinds == {bool} else column
        frame = pandas.DataFrame(columns)
        frame.attrs["units"] = self.columns.units
        return frame

    def to_polars(self) -> Any:
        """Its columns as a ``polars.DataFrame`` (needs polars)."""
        import polars

        return polars.DataFrame(self)

    def to_xarray(self) -> Any:
        """Its columns as an ``xarray.Dataset`` along ``row``, with ``units`` as attributes (needs xarray)."""
        import xarray

        units = self.columns.units
        attributes = {name: {"units": units[name]} if name in units else {} for name in self.columns}
        return xarray.Dataset({name: ("row", column, attributes[name]) for name, column in self.columns.items()})

    def save(self, path: Path) -> None:
        """Writes it to a file, whole or not at all: ``.json`` (from which it is loaded again, by the programs too), ``.csv``,
        ``.parquet``, and where there is something to see ``.svg``, ``.png``, ``.pdf``.

        Raises :class:`~arclength.InvalidInput` for another ending or a file that cannot be written.
        """
        try:
            self._native.write(os.fspath(path))
        except InvalidInput as error:
            error.key, error.value = error.key or "path", error.value or os.fspath(path)
            raise

    def to_json(self) -> bytes:
        """The bytes of its ``.json`` file, as the programs write it."""
        return self._native.json()

    @classmethod
    def load(cls: type[Self], path: Path) -> Self:
        """A result from its ``.json`` file, written here or by the programs; see :func:`arclength.load`."""
        result = load(path)
        if not isinstance(result, cls):
            raise InvalidInput(
                f"{os.fspath(path)}: it is a {result.schema}, not a {cls.__name__}",
                key="path",
                value=os.fspath(path),
                allowed=f"the file of a {cls.__name__}",
            )
        return result

    def __reduce__(self) -> tuple[object, ...]:
        return (_from_json, (self.to_json(),))


def _from_json(text: bytes) -> Any:
    import tempfile

    with tempfile.TemporaryDirectory(prefix="arclength-") as folder:
        path = os.path.join(folder, "result.json")
        with open(path, "wb") as file:
            file.write(text)
        return load(path)


class Point(Record):
    """A point of a branch: its fields, and what can be started from it where it has a label."""

    __slots__ = ("branch",)
    branch: Branch

    def __init__(self, fields: Mapping[str, Any], branch: Branch) -> None:
        super().__init__(fields)
        object.__setattr__(self, "branch", branch)

    @property
    def normal_form(self) -> Record | None:
        """Coefficients of the normal form of a special point; ``None`` at others."""
        fields = self._fields
        found: Record | None = fields.get("special") or fields.get("normal_form")
        if found is None and "first_lyapunov" in fields:
            names = ("frequency", "first_lyapunov", "first_lyapunov_error", "c1_real", "criticality")
            return Record({name: fields[name] for name in names if name in fields})
        return found

    def _label(self) -> str:
        label = self._fields.get("label")
        if not label:
            raise InvalidInput(
                "the point has no label: nothing can be started from it; ask for one there by at=...", key="label"
            )
        return str(label)

    def __reduce__(self) -> tuple[object, ...]:
        return (type(self), (self._fields, self.branch))

    def __repr__(self) -> str:
        fields = self._fields
        where = {name: fields[name] for name in ("value", "values", "state", "period", "stable") if name in fields}
        inside = ", ".join(f"{name}={value!r}" for name, value in where.items())
        return f"<{fields.get('label') or 'point'} {inside}>"


class Branch(Result):
    """Points in the order of a branch: ``branch["HB1"]`` by label, ``branch[0]`` by index, and one by one in a loop."""

    _point: type[Point] = Point

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """Its points, each with the fields of the file."""
        points = self.document.get("points", [])
        return tuple(self._point({name: tidy(value, name) for name, value in point.items()}, self) for point in points)

    @property
    def labels(self) -> list[str]:
        """Labels of its points, in the order of the branch."""
        return [label for point in self.document.get("points", []) if (label := point.get("label"))]

    def __len__(self) -> int:
        return len(self.document.get("points", []))

    def __iter__(self) -> Iterator[Point]:
        return iter(self.points)

    @overload
    def __getitem__(self, key: str | int) -> Any: ...
    @overload
    def __getitem__(self, key: slice) -> tuple[Any, ...]: ...
    def __getitem__(self, key: str | int | slice) -> Any:
        if not isinstance(key, str):
            return self.points[key]
        for point in self.points:
            if point.get("label") == key:
                return point
        labels = ", ".join(self.labels) or "it has no labels"
        raise UnknownLabel(f"no point is labelled `{key}`; the labels are: {labels}", key="label", value=key, allowed=labels)

    def plot(self, ax: Axes | None = None, *, x: str | None = None, y: str | None = None, **style: Any) -> Axes:
        """Draws the branch with matplotlib: solid where it is stable, dashed where not, dotted where that is undecided, with labels.

        ``x`` and ``y`` are names of columns. Without, it is the parameter across, and upwards the first state, for cycles its largest
        and smallest value. ``style`` is handed to every ``ax.plot``. Returns the axes.
        """
        from .plotting import plot_branch

        return plot_branch(self, ax, x, y, style)

    def _file(self) -> Any:
        return on_disk(self._native)


def load(path: Path) -> Any:
    """A result from its ``.json`` file, written here or by the programs ``arclength`` and ``kingpin``.

    Results of ``equilibria``, ``cycles``, ``locus`` and ``simulate`` of models, of ``hopf``, ``cycles`` and ``locus`` of wheels can be
    loaded. Raises :class:`~arclength.InvalidInput` for any other file.
    """
    try:
        return of(_native.read_result(os.fspath(path)))
    except InvalidInput as error:
        error.key, error.value = error.key or "path", error.value or os.fspath(path)
        raise


def of(native: NativeResult) -> Any:
    """The result as the class of its kind."""
    return _kinds().get(native.schema, Result)(native)


@functools.cache
def _kinds() -> dict[str, type[Result]]:
    from . import kingpin, models

    return {**models.KINDS, **kingpin.KINDS}
