"""What a sweep goes over: points that each chunk works out for itself, from their numbers alone."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput
from .identity import of_value

if TYPE_CHECKING:
    import numpy as np

    Arrays = dict[str, np.ndarray[Any, Any]]


class Sample:
    """Points, numbered from 0: names of what varies, how many points there are, and the values of those from one number to another."""

    #: What varies, in order.
    names: list[str]
    #: Number of points.
    count: int

    def points(self, start: int, stop: int) -> Arrays:
        """The values of the points with the numbers ``start`` to ``stop - 1``, an array of shape ``(stop - start,)`` for each name."""
        raise NotImplementedError

    def part(self, start: int, stop: int) -> Sample:
        """What a worker has to be sent for these points: as small as it can be, with the numbers of the points unchanged."""
        return self

    def description(self) -> dict[str, Any]:
        """What tells this sample from any other, for names of files."""
        raise NotImplementedError

    def __len__(self) -> int:
        return self.count

    def __repr__(self) -> str:
        return f"<{self.count} points of {', '.join(self.names)}>"


def _digest(name: str, values: np.ndarray[Any, Any]) -> str:
    return of_value(f"sample {name}", values, lenient=False)


class Grid(Sample):
    """All combinations of values along axes; the last axis varies fastest."""

    def __init__(self, axes: Mapping[str, Any]) -> None:
        if not axes:
            raise InvalidInput("a grid without axes; allowed: grid(v=(1, 8, 15))", key="grid", allowed="at least one axis")
        self.axes = {name: _axis(name, axis) for name, axis in axes.items()}
        self.names = list(self.axes)
        self.shape = tuple(len(axis) for axis in self.axes.values())
        self.count = math.prod(self.shape)

    def points(self, start: int, stop: int) -> Arrays:
        import numpy as np

        indices = np.unravel_index(np.arange(start, stop), self.shape)
        return {name: axis[index] for (name, axis), index in zip(self.axes.items(), indices, strict=True)}

    def description(self) -> dict[str, Any]:
        axes = [{"name": name, "count": len(axis), "values": _digest(name, axis)} for name, axis in self.axes.items()]
        return {"kind": "grid", "axes": axes}


class Random(Sample):
    """Uniformly distributed points in a box. A point depends on the seed, its number and the position of its axis only."""

    #: Numbers that the generator makes at once.
    _BLOCK = 4

    def __init__(self, count: int, seed: int, box: Mapping[str, tuple[float, float]]) -> None:
        if count < 1 or seed < 0 or not box:
            raise InvalidInput(
                f"{count} random points in {len(box)} dimensions, seed {seed}: not a sample; allowed: at least one point, one range, "
                "a seed of 0 or more",
                key="random",
                allowed="random_sample(1000, v=(1, 8))",
            )
        self.count, self.seed = count, seed
        self.box = {name: _range(name, ends) for name, ends in box.items()}
        self.names = list(box)

    def points(self, start: int, stop: int) -> Arrays:
        import numpy as np

        skipped = start // self._BLOCK
        columns = {}
        for position, (name, (low, high)) in enumerate(self.box.items()):
            generator = np.random.Philox(key=np.array([self.seed, position], dtype=np.uint64))
            generator.advance(skipped)
            raw = generator.random_raw(stop - skipped * self._BLOCK)[start - skipped * self._BLOCK :]
            columns[name] = low + (high - low) * ((raw >> np.uint64(11)) * 2.0**-53)
        return columns

    def description(self) -> dict[str, Any]:
        box = [{"name": name, "low": low, "high": high} for name, (low, high) in self.box.items()]
        return {"kind": "random", "count": self.count, "seed": self.seed, "box": box}


class Listed(Sample):
    """Points of a table: columns of equal length, numbers or words."""

    def __init__(self, columns: Mapping[str, Any], *, first: int = 0) -> None:
        import numpy as np

        self.columns = {}
        for name in columns:
            values = np.asarray(columns[name])
            if values.ndim != 1:
                raise InvalidInput(f"sample {name}: not a column of values", key=name, allowed="one value for each point")
            self.columns[str(name)] = values.astype(object) if values.dtype.kind not in "fiub" else values
        self.names = list(self.columns)
        lengths = {len(values) for values in self.columns.values()}
        if len(lengths) != 1 or 0 in lengths:
            raise InvalidInput(
                "the columns of the sample differ in length, or there are none", key="sample", allowed="columns of equal length"
            )
        self.count = lengths.pop()
        self._first = first

    def points(self, start: int, stop: int) -> Arrays:
        return {name: values[start - self._first : stop - self._first] for name, values in self.columns.items()}

    def part(self, start: int, stop: int) -> Sample:
        return Listed(self.points(start, stop), first=start)

    def description(self) -> dict[str, Any]:
        columns = [{"name": name, "values": _digest(name, values)} for name, values in self.columns.items()]
        return {"kind": "table", "count": self.count, "columns": columns}


def _axis(name: str, axis: Any) -> np.ndarray[Any, Any]:
    import numpy as np

    allowed = "(a, b, number of values), or a list of values"
    if isinstance(axis, tuple):
        if len(axis) != 3 or isinstance(axis[2], bool) or not isinstance(axis[2], int) or axis[2] < 1:
            raise InvalidInput(f"grid {name} {axis!r}: not an axis; allowed: {allowed}", key=name, value=repr(axis), allowed=allowed)
        return np.linspace(float(axis[0]), float(axis[1]), axis[2])
    values = np.asarray(axis)
    if values.ndim != 1 or len(values) == 0:
        raise InvalidInput(f"grid {name} {axis!r}: not an axis; allowed: {allowed}", key=name, value=repr(axis), allowed=allowed)
    return values.astype(object) if values.dtype.kind not in "fiub" else values


def _range(name: str, ends: Any) -> tuple[float, float]:
    low, high = (float(end) for end in ends) if isinstance(ends, Iterable) and len(tuple(ends)) == 2 else (math.nan, math.nan)
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise InvalidInput(f"random {name} {ends!r}: not a range; allowed: (a, b), a < b", key=name, value=repr(ends), allowed="(a, b)")
    return low, high


def grid(**axes: Any) -> Grid:
    """All combinations of values: an axis is a tuple ``(a, b, n)`` of ``n`` equidistant values, both ends included, or a list of values.

    >>> grid(v=(1, 8, 15), r=[1, 2, math.inf])
    <45 points of v, r>
    """
    return Grid(axes)


def random_sample(count: int, *, seed: int = 1, **box: tuple[float, float]) -> Random:
    """Uniformly distributed random points: ``random_sample(1000, v=(1, 8), l=(0.02, 0.3))``. The first points are those of a longer sample."""
    return Random(count, seed, box)


def sample_of(given: Any) -> Sample:
    """A sample, or the columns of one (a mapping, a DataFrame)."""
    if isinstance(given, Sample):
        return given
    if not (hasattr(given, "keys") and hasattr(given, "__getitem__")):
        allowed = "grid(...), random_sample(...), or columns (a mapping, a DataFrame)"
        raise InvalidInput(f"sample {given!r}: not a sample; allowed: {allowed}", key="sample", value=repr(given), allowed=allowed)
    return Listed({name: given[name] for name in given.keys()})
