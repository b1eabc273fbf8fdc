"""One chunk of a sweep, wherever it is worked on: computed, written, told."""

from __future__ import annotations

import multiprocessing
import sys
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import InvalidInput
from . import storage
from .sample import Sample
from .task import Stopped, Task


@dataclass(frozen=True)
class Chunk:
    """What a worker needs. Doing it twice gives the same file, and it does nothing where the file is there already."""

    task: Task
    sample: Sample
    kinds: Mapping[str, str]
    folder: Path
    number: int
    start: int
    stop: int
    identity: str
    threads: int | None = None

    @property
    def file(self) -> str:
        """The name of its file: its number, and the hash of all that it depends on."""
        return f"{self.number:08d}-{storage.digest(self.identity)}.parquet"

    def __call__(self, stop: threading.Event | None = None) -> dict[str, Any]:
        """Computes and writes it, unless it is there whole and undamaged, and gives its receipt."""
        rows = self.stop - self.start
        kept = storage.kept(self.folder, self.file, self.identity, self.number, rows)
        if kept is not None:
            return kept
        points = self.sample.points(self.start, self.stop)
        columns = self._columns(points, (lambda: False) if stop is None else stop.is_set)
        table = storage.table(columns, self.kinds, self.identity, rows, points)
        return storage.keep(self.folder, self.file, storage.parquet(table), self.number, rows)

    def _columns(self, points: Mapping[str, Any], stopped: Any) -> Mapping[str, Any]:
        threads = _threads() if self.threads is None else self.threads
        if self.task.batched:
            return self.task.columns(points, stopped, threads)
        names = list(points)
        rows = []
        for values in zip(*(column.tolist() for column in points.values()), strict=True):
            if stopped():
                raise Stopped
            row = self.task.row(dict(zip(names, values, strict=True)), stopped, threads)
            unknown = [name for name in row if name not in self.kinds]
            if unknown:
                raise InvalidInput(
                    f"column {unknown[0]}: it was not there at the first points; choose columns by fields=", key="fields", value=unknown[0]
                )
            rows.append(row)
        return {name: [row.get(name) for row in rows] for name in self.kinds}


def _threads() -> int | None:
    """How many threads an analysis may have here: a worker of Dask has its own number, one process of several has one."""
    if "distributed" in sys.modules:
        from distributed import get_worker

        try:
            return int(get_worker().state.nthreads)
        except (AttributeError, ValueError):
            pass
    return None if multiprocessing.parent_process() is None else 1
