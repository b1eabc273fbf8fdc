"""Results: what every analysis gives, and branches, whose points can be started from."""

from __future__ import annotations

import csv
import functools
import html
import io
import json
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar, overload

from . import _native
from ._copied import Copied, state_of, write_parquet, write_whole
from ._requests import on_disk
from .errors import InvalidInput, UnknownLabel
from .records import Record, same, tidy

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

    Names differ: where a state, an auxiliary quantity or a parameter of a model has the name of another column of the result, it is in
    ``state_NAME``, ``aux_NAME`` or ``parameter_NAME``.
    """

    def __init__(self, native: NativeResult, of_model: Callable[[], Mapping[int, str]] = dict) -> None:
        self._native = native
        self._arrays: dict[str, np.ndarray[Any, Any]] = {}
        given = native.column_names()
        #: Names with the places of their columns, and with the names that they had.
        self._places = {name: place for place, name in enumerate(given)}
        self._given = dict.fromkeys(given, "")
        #: Names of what is of the model, where they were changed.
        self.renamed: dict[str, str] = {}
        if len(self._places) < len(given):
            names = self._distinct(given, of_model())
            self._places = {name: place for place, name in enumerate(names)}
        self._given = {name: given[place] for name, place in self._places.items()}
        self._names = list(self._places)

    def _distinct(self, given: list[str], kinds: Mapping[int, str]) -> list[str]:
        taken = set(given)
        names = []
        for place, name in enumerate(given):
            is_first_of_others = all(other in kinds for other in range(place) if given[other] == name)
            if given.count(name) > 1 and (place in kinds or not is_first_of_others):
                kind = kinds.get(place, "result")
                new = f"{kind}_{name}"
                while new in taken:
                    new = f"{kind}_{new}"
                taken.add(new)
                if place in kinds:
                    self.renamed[name] = new
                name = new
            names.append(name)
        return names

    def _column(self, name: str) -> Any:
        """A column as the native module gives it, which knows the first of a name only."""
        given, place = self._given[name], self._places[name]
        if self._native.column_names().index(given) == place:
            return self._native.column(given)
        return _read_column(_as_csv(self._native), place)

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
            if name not in self._places:
                raise UnknownLabel(
                    f"there is no column `{name}`; there are: {', '.join(self._names)}",
                    key="column",
                    value=name,
                    allowed=", ".join(self._names),
                )
            column = self._column(name)
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

    def __eq__(self, other: object) -> bool:
        return same(self, other) if isinstance(other, Mapping) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<columns {', '.join(self._names)}>"


def _as_csv(native: NativeResult) -> bytes:
    with tempfile.TemporaryDirectory(prefix="arclength-") as folder:
        path = os.path.join(folder, "result.csv")
        native.write(path)
        with open(path, "rb") as file:
            return file.read()


def _read_column(text: bytes, place: int) -> Any:
    """A column of numbers or counts, by its place."""
    import numpy as np

    _, *rows = csv.reader(io.StringIO(text.decode(), newline=""))
    cells = [row[place] for row in rows]
    if cells and all(cell.isdigit() for cell in cells):
        return np.array(cells, dtype=np.uint64)
    return np.array([float(cell) if cell else np.nan for cell in cells], dtype=float)


class Result:
    """What an analysis gives. The fields of its file are attributes: lists of numbers are arrays."""

    def __init__(self, native: NativeResult) -> None:
        self._native = native
        #: What is not in the file: what there was to tell when it was computed.
        self._warnings = native.warnings
        self._interrupted = native.interrupted

    def _of_model(self) -> dict[int, str]:
        """Places of the columns that the model gives their names, with what they are."""
        return {}

    @property
    def schema(self) -> str:
        """Name of its kind, such as ``arclength.cycles``."""
        return self._native.schema

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C stopped it before its end."""
        return self._interrupted

    @property
    def warnings(self) -> list[str]:
        """What is worth knowing of it."""
        return list(self._warnings)

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
        return Columns(self._native, self._of_model)

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
        if self.columns.renamed:
            return self.to_arrow().__arrow_c_stream__()
        return self._native.stream()

    def to_arrow(self) -> Any:
        """Its columns as a ``pyarrow.Table``, with the units in the metadata of the fields (needs pyarrow)."""
        import pyarrow

        if self.columns.renamed:
            return pyarrow.table(_Stream(self._native)).rename_columns(list(self.columns))
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

        if self.columns.renamed:
            columns = {name: column.tolist() if column.dtype == object else column for name, column in self.columns.items()}
            return polars.DataFrame([polars.Series(name, column, nan_to_null=True) for name, column in columns.items()])
        return polars.DataFrame(self)

    def to_xarray(self) -> Any:
        """Its columns as an ``xarray.Dataset`` along ``row``, with ``units`` as attributes (needs xarray).

        Yes and no are true and false; where some are undecided they are 1 and 0, and not a number where that is undecided.
        """
        import xarray

        units = self.columns.units
        attributes = {name: {"units": units[name]} if name in units else {} for name in self.columns}
        return xarray.Dataset({name: ("row", decided(column), attributes[name]) for name, column in self.columns.items()})

    def save(self, path: Path) -> None:
        """Writes it to a file, whole or not at all: ``.json`` (from which it is loaded again, by the programs too), ``.csv``,
        ``.parquet``, and where there is something to see ``.svg``, ``.png``, ``.pdf``.

        Raises :class:`~arclength.InvalidInput` for another ending or a file that cannot be written.
        """
        place = os.fspath(path)
        ending = os.path.splitext(place)[1].lower()
        if self.columns.renamed and ending in (".csv", ".parquet"):
            if ending == ".parquet":
                write_parquet(self.to_arrow(), place)
            else:
                names = io.StringIO(newline="")
                csv.writer(names, lineterminator="\n").writerow(self.columns)
                write_whole(place, names.getvalue().encode() + _as_csv(self._native).partition(b"\n")[2])
            return
        try:
            self._native.write(place)
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
        if self.schema in _LOADED:
            return (_from_json, (self.to_json(), self._warnings, self._interrupted))
        return (_from_state, (state_of(self._native),))


#: Results that are read from their files, so that more can start from them.
_LOADED = frozenset(
    "arclength.equilibria arclength.cycles arclength.locus arclength.cycle_locus arclength.simulate"
    " kingpin.hopf kingpin.cycles kingpin.locus kingpin.cycle_locus".split()
)


class _Stream:
    """The columns with the names that the native module gives them."""

    def __init__(self, native: NativeResult) -> None:
        self._native = native

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self._native.stream()


def decided(column: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Yes and no as such where all are decided, else as numbers; other columns as they are."""
    import numpy as np

    if column.dtype != object or not {type(entry) for entry in column.ravel().tolist()} <= {bool, type(None)}:
        return column
    if all(entry is not None for entry in column.ravel().tolist()):
        return column.astype(bool)
    return np.array([np.nan if entry is None else float(entry) for entry in column.ravel().tolist()]).reshape(column.shape)


def _from_json(text: bytes, warnings: list[str], interrupted: bool) -> Any:
    with tempfile.TemporaryDirectory(prefix="arclength-") as folder:
        path = os.path.join(folder, "result.json")
        with open(path, "wb") as file:
            file.write(text)
        result = load(path)
    result._warnings, result._interrupted = warnings, interrupted
    return result


def _from_state(state: dict[str, Any]) -> Any:
    native: Any = Copied(state)
    return of(native)


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

    def __contains__(self, key: object) -> bool:
        """Whether a point has this label, or is equal to this one."""
        return key in self.labels if isinstance(key, str) else any(point == key for point in self.points)

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
