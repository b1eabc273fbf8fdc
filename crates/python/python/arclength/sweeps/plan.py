"""How a sweep is divided: into chunks of equal numbers of points, which depend on the sample and on one number that is fixed at the start."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from .. import _native
from ..errors import ComputationFailed, InvalidInput
from . import storage
from .chunk import Chunk
from .identity import difference
from .sample import Sample
from .task import PROBLEM, WARNINGS, Row, Task, kind_of, kind_of_type

SCHEMA = {"name": "arclength.sweep", "version": 2}
#: Seconds of work that a chunk is to be, when its size is chosen.
_SECONDS = 2.0
#: Seconds that the choice may take, and the most points of a chunk.
_TRIAL, _MOST_POINTS = 0.5, 1 << 20
#: Points at which the columns are looked up.
_FIRST = 8


def _trial_points(sample: Sample, count: int) -> Iterator[Mapping[str, Any]]:
    """Points spread over the sample."""
    for index in range(count):
        number = index * sample.count // count
        yield {name: values.tolist()[0] for name, values in sample.points(number, number + 1).items()}


def _chosen(seconds_per_point: float, count: int) -> int:
    points = 1
    while points * 2 <= min(_MOST_POINTS, max(1.0, _SECONDS / max(seconds_per_point, 1e-9))):
        points *= 2
    return min(points, count)


def _batched_trial(task: Task, sample: Sample, threads: int | None) -> tuple[dict[str, str], float]:
    size, kinds, spent = 1, {}, 0.0
    while True:
        size = min(size, sample.count)
        start = time.perf_counter()
        columns = task.columns(sample.points(0, size), lambda: False, threads)
        spent = time.perf_counter() - start
        kinds = {name: kind_of(_first(column)) for name, column in columns.items()}
        if spent > _TRIAL / 4 or size in (sample.count, _MOST_POINTS):
            return kinds, spent / size
        size *= 4


def _first(column: Any) -> Any:
    import numpy as np

    return np.asarray(column)[0].item()


def _trial(task: Task, sample: Sample, threads: int | None) -> tuple[dict[str, str], float]:
    """The columns with their types, and the seconds that a point takes."""
    if task.batched:
        kinds, seconds = _batched_trial(task, sample, threads)
        return {**kinds, **_declared(task)}, seconds
    found: dict[str, str | None] = {}
    problem: str | None = None
    start = time.perf_counter()
    done = 0
    for point in _trial_points(sample, min(sample.count, 64)):
        row: Row = task.row(point, lambda: False, threads)
        problem = row.get(PROBLEM)
        done += 1
        for name, value in row.items():
            if value is not None and found.get(name) != "number":
                found[name] = kind_of(value)
            else:
                found.setdefault(name, None)
        if time.perf_counter() - start > _TRIAL and done >= min(_FIRST, sample.count):
            break
        if done >= _FIRST and time.perf_counter() - start > 20 * _TRIAL:
            break
    seconds = (time.perf_counter() - start) / done
    found = {name: kind for name, kind in found.items() if name not in (PROBLEM, WARNINGS)}
    if not (found or task.declared):
        raise ComputationFailed(f"there is no answer at the first {done} points that were tried: {problem}; name the columns by fields=")
    kinds = {name: kind or "number" for name, kind in found.items()}
    return {**kinds, **_declared(task)}, seconds


def _declared(task: Task) -> dict[str, str]:
    """The columns that were said beforehand, and those that every sweep by points has."""
    declared = {name: kind_of_type(kind) for name, kind in task.declared.items()}
    return declared if task.batched else {**declared, WARNINGS: "word", PROBLEM: "word"}


class Plan:
    """A sweep as it stands in its folder: columns, size and names of its chunks, the same for whoever works on it."""

    def __init__(self, task: Task, sample: Sample, folder: Path, chunk: int | None, threads: int | None) -> None:
        self.task, self.sample, self.folder, self.threads = task, sample, folder, threads
        if chunk is not None and chunk < 1:
            raise InvalidInput(f"chunk {chunk}: no number of points; allowed: 1 or more", key="chunk", value=str(chunk), allowed="1 or more")
        asked = {
            "schema": SCHEMA,
            "version": _native.__version__,
            "function": task.identity(),
            "sample": sample.description(),
            "points": sample.count,
        }
        path = folder / storage.PLAN
        if not path.exists():
            folder.mkdir(parents=True, exist_ok=True)
            if chunk is not None and task.declared:
                kinds, size = _declared(task), chunk
            else:
                kinds, seconds = _trial(task, sample, threads)
                size = chunk or _chosen(seconds, sample.count)
            content = storage.sealed({**asked, "columns": list(kinds.items()), "chunk": size})
            # Whoever is first says how it is divided; all others go by that.
            storage.publish(folder, storage.PLAN, content, once=True)
        self.document = storage.read_plan(folder)
        there = {name: self.document.get(name) for name in asked}
        differs = difference(there, json.loads(storage.canonical(asked)))
        if differs:
            raise InvalidInput(
                f"{folder}: another sweep is in there ({differs} differs); allowed: an empty folder, or the same function with all that it "
                "depends on, constants and sample",
                key="folder",
                value=str(folder),
                allowed="an empty folder",
            )
        if chunk is not None and chunk != self.document["chunk"]:
            raise InvalidInput(
                f"chunk {chunk}: the sweep in {folder} was begun with chunks of {self.document['chunk']} points; allowed: "
                f"{self.document['chunk']}",
                key="chunk",
                value=str(chunk),
                allowed=str(self.document["chunk"]),
            )
        self.kinds: dict[str, str] = dict(self.document["columns"])
        for name, kind in _declared(task).items():
            if self.kinds.get(name) != kind:
                told = self.kinds.get(name, "nothing")
                raise InvalidInput(
                    f"field {name} of {kind}: the sweep in {folder} was begun with {told}; allowed: the same types, or an empty folder",
                    key="fields",
                    value=name,
                    allowed=told,
                )
        self.size: int = self.document["chunk"]
        self.count = -(-sample.count // self.size)
        self.key = storage.digest(storage.canonical(self.document))

    def chunk(self, number: int, *, threads: int | None = None) -> Chunk:
        """The chunk with this number, from 0."""
        start = number * self.size
        stop = min(start + self.size, self.sample.count)
        identity = storage.canonical({"sweep": self.key, "start": start, "stop": stop})
        part = self.sample.part(start, stop)
        return Chunk(self.task, part, self.kinds, self.folder, number, start, stop, identity, threads)
