"""Sweeps: a function, or an analysis of a wheel or a model, at many points, on one machine or many.

>>> import arclength, tempfile
>>> from arclength.kingpin import Wheel
>>> folder = tempfile.mkdtemp()
>>> swept = arclength.sweep(Wheel(r=1).stability, arclength.grid(v=(1, 8, 3), l=[0.08, 0.1]), folder, fields=["growth_rate", "stable"])
>>> swept.count
6

The points are divided into chunks of one to five seconds of work. Each chunk is a Parquet file in the folder, whose name is the hash of all
that it depends on; it is written under another name, forced to the disk and then renamed, so that a file is whole or not there. Its own hash
is beside it. What is there and undamaged is not computed again: a sweep that was stopped, killed or lost its workers goes on by the same call.
"""

from __future__ import annotations

import concurrent.futures
import os
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from .._requests import reported
from ..errors import ComputationFailed, Interrupted, InvalidInput
from . import storage
from .plan import Plan
from .sample import Grid, Listed, Random, Sample, grid, random_sample, sample_of
from .task import Stopped, Task

if TYPE_CHECKING:
    import pandas as pd

    from .._requests import Progress

__all__ = ["Grid", "Listed", "Random", "Sample", "Swept", "grid", "merge", "random_sample", "sweep"]

#: Chunks that wait at each worker, besides the one that it works on.
_AHEAD = 2
#: How often a chunk is given to another worker when the one that had it died.
_RETRIES = 3
#: How often, in seconds, whoever waits looks for Ctrl-C.
_TICK = 0.05


class Submits(Protocol):
    """What takes work: a ``dask.distributed.Client``, or an executor of :mod:`concurrent.futures`."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Any:
        """Takes a function with its arguments, and gives what will be its answer."""
        ...


def sweep(
    function: Callable[..., Any],
    sample: Any,
    folder: str | os.PathLike[str],
    *,
    constants: Mapping[str, Any] | None = None,
    fields: Iterable[str] | Mapping[str, type] | None = None,
    batched: bool = False,
    version: str = "",
    chunk: int | None = None,
    client: Submits | None = None,
    shard: tuple[int, int] | str | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Swept:
    """Computes a function, or an analysis, at every point of a sample, and keeps the answers in a folder (needs pyarrow).

    Where a computation fails, the column ``problem`` says why, and ``warnings`` what is worth knowing. Raises
    :class:`~arclength.InvalidInput`, whatever else the function raises, and :class:`~arclength.Interrupted` at Ctrl-C.

    Parameters
    ----------
    function: called with a point's values by name, ``function(v=1.0, l=0.1)``, it gives a mapping from names of columns to numbers, yes
        or no, words or ``None``; or an analysis of a wheel or a model (``wheel.stability``, ``wheel.safe_kick``, ``model.simulate``),
        whose parameters take the values of the point by name, other names being keywords of the analysis.
    sample: :func:`grid`, :func:`random_sample`, or columns (a mapping, a DataFrame).
    folder: where the chunks are. A sweep that is in there already, begun or done, goes on; another one is refused.
    constants: further keywords, the same at every point.
    fields: which fields of the answer are columns, by default all that are no lists; ``"fractions.0.share"`` looks into lists and
        records; a mapping says the types, too (``float``, ``int``, ``bool``, ``str``).
    batched: the function takes arrays of shape ``(n,)`` and gives such arrays. ``wheel.stability_at`` is such a function.
    version: whatever tells the function from what it was before. Its code, default arguments, what it closes over and the global names in it
        are looked at, as are the constants; what is installed is not. With a version, values whose content cannot be known are let pass.
    chunk: number of points of a chunk. By default it is chosen at the start for about two seconds, and stands in the folder then.
    client: a ``dask.distributed.Client``, or an executor of :mod:`concurrent.futures`; by default threads of this process.
    shard: ``(i, n)`` or ``"i/n"``: only every n-th chunk, from the i-th, i from 1 to n. :func:`merge` puts them together.
    threads: number of threads, here of the chunks, in other processes of each analysis.
    progress: is told the part that is done; ``True`` shows a bar (needs tqdm).
    """
    task = Task(function, constants, fields, batched, version)
    plan = Plan(task, sample_of(sample), Path(folder).absolute(), chunk, threads)
    numbers = _shard(plan.count, shard)
    workers = _Workers(client, plan, threads)
    receipts = {}
    with reported(progress, "sweep") as told:
        for done, receipt in enumerate(workers.receipts(numbers), 1):
            receipts[receipt["chunk"]] = receipt
            if told is not None:
                told(done / len(numbers), None)
    if shard is None:
        _publish(plan.folder, plan.document, [receipts[number] for number in numbers])
    return Swept(plan.folder)


def merge(folder: str | os.PathLike[str], out: str | os.PathLike[str] | None = None) -> Swept:
    """Puts together what shards have computed: writes the manifest, and with ``out`` one Parquet file of all chunks.

    Raises :class:`~arclength.ComputationFailed` with the numbers of the chunks that are not there.
    """
    path = Path(folder).absolute()
    document = storage.read_plan(path)
    key = storage.digest(storage.canonical(document))
    size, points = document["chunk"], document["points"]
    receipts, missing = [], []
    for number, start in enumerate(range(0, points, size)):
        stop = min(start + size, points)
        identity = storage.canonical({"sweep": key, "start": start, "stop": stop})
        name = f"{number:08d}-{storage.digest(identity)}.parquet"
        kept = storage.kept(path, name, identity, number, stop - start)
        if kept is None:
            missing.append(number)
        else:
            receipts.append(kept)
    if missing:
        some = ", ".join(map(str, missing[:10])) + (", .." if len(missing) > 10 else "")
        raise ComputationFailed(f"{path}: {len(missing)} of {-(-points // size)} chunks are not there, or damaged: {some}; run their shards again")
    _publish(path, document, receipts)
    swept = Swept(path)
    if out is not None:
        swept.write(out)
    return swept


def _publish(folder: Path, document: Mapping[str, Any], receipts: list[dict[str, Any]]) -> None:
    manifest = storage.canonical({"sweep": document, "chunks": receipts})
    path = folder / storage.MANIFEST
    if not path.exists() or path.read_text(encoding="utf-8") != manifest:
        storage.publish(folder, storage.MANIFEST, manifest.encode())


def _shard(count: int, shard: tuple[int, int] | str | None) -> range:
    if shard is None:
        return range(count)
    try:
        first, of = (int(part) for part in (shard.split("/") if isinstance(shard, str) else shard))
        if not 1 <= first <= of:
            raise ValueError
    except (ValueError, TypeError):
        raise InvalidInput(
            f"shard {shard!r}: not a part; allowed: i/n, i from 1 to n", key="shard", value=str(shard), allowed="i/n, i from 1 to n"
        ) from None
    return range(first - 1, count, of)


class _Workers:
    """Who works on the chunks: threads of this process, or what a client stands for."""

    def __init__(self, client: Any, plan: Plan, threads: int | None) -> None:
        self._plan = plan
        self._threads = threads
        self._own = client is None
        self._stop = threading.Event()
        if client is None:
            # The engine has its own threads for arrays.
            count = 1 if plan.task.batched else threads or os.cpu_count() or 1
            self._executor: Any = concurrent.futures.ThreadPoolExecutor(count, "arclength-sweep")
            self._window = count * _AHEAD
        elif hasattr(client, "get_executor"):
            self._executor = client.get_executor(pure=False, retries=_RETRIES)
            self._client = client
            self._window = 0
        else:
            self._executor = client
            self._window = getattr(client, "_max_workers", os.cpu_count() or 1) * _AHEAD

    def _so_far(self, done: int, numbers: range) -> str:
        return f"{done} of {len(numbers)} chunks are in {self._plan.folder}; the same call goes on from there"

    def _ahead(self) -> int:
        """Chunks that are given out at a time: a cluster may grow meanwhile."""
        if self._window:
            return self._window
        threads: dict[str, int] = self._client.nthreads()
        return max(1, sum(threads.values())) * (1 + _AHEAD)

    def _submit(self, number: int) -> Future[dict[str, Any]]:
        if self._own:
            threads = self._threads if self._plan.task.batched else None
            future: Future[dict[str, Any]] = self._executor.submit(self._plan.chunk(number, threads=threads), self._stop)
        else:
            future = self._executor.submit(self._plan.chunk(number, threads=self._threads))
        return future

    def receipts(self, numbers: range) -> Iterator[dict[str, Any]]:
        """Receipts of the chunks, as they come."""
        left = iter(numbers)
        running: set[Future[dict[str, Any]]] = set()
        done = 0
        try:
            while True:
                for number in left:
                    running.add(self._submit(number))
                    if len(running) >= self._ahead():
                        break
                if not running:
                    return
                finished, running = concurrent.futures.wait(running, _TICK, concurrent.futures.FIRST_COMPLETED)
                for future in finished:
                    yield future.result()
                    done += 1
        except KeyboardInterrupt:
            raise Interrupted(f"interrupted: {self._so_far(done, numbers)}") from None
        except Exception as error:
            error.add_note(self._so_far(done, numbers))
            raise
        finally:
            self._stop.set()
            for future in running:
                future.cancel()
            if self._own:
                self._executor.shutdown(wait=True, cancel_futures=True)


class Swept:
    """A sweep that is done, or a part of it that is: the chunks in its folder."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder).absolute()
        self._document = storage.read_plan(self.folder)

    @property
    def count(self) -> int:
        """Number of points."""
        count: int = self._document["points"]
        return count

    @property
    def chunk(self) -> int:
        """Number of points of a chunk; the last may have fewer."""
        size: int = self._document["chunk"]
        return size

    @property
    def manifest(self) -> dict[str, Any]:
        """The plan (``sweep``) and all ``chunks`` with file, rows, bytes and SHA-256. There is none until all chunks are there."""
        manifest: dict[str, Any] = storage.read_json(self.folder / storage.MANIFEST)
        return manifest

    @property
    def files(self) -> list[Path]:
        """The files of the chunks, in the order of the points: a data set for DuckDB, polars, pyarrow, Dask."""
        return [self.folder / entry["file"] for entry in self.manifest["chunks"]]

    def to_arrow(self) -> Any:
        """All rows as a ``pyarrow.Table``, in the order of the points; each chunk is compared with its hash in the manifest."""
        import pyarrow

        return pyarrow.concat_tables(storage.read_chunk(self.folder, entry) for entry in self.manifest["chunks"])

    def to_pandas(self) -> pd.DataFrame:
        """All rows as a ``pandas.DataFrame``, in the order of the points (needs pandas)."""
        frame: pd.DataFrame = self.to_arrow().to_pandas()
        return frame

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes all rows into one Parquet file, chunk by chunk; each is compared with its hash in the manifest."""
        storage.write_merged(self.folder, self.manifest["chunks"], Path(path).absolute())

    def __len__(self) -> int:
        return self.count

    def __repr__(self) -> str:
        return f"<sweep over {self.count} points in {self.folder}>"
