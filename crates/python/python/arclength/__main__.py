"""``python -m arclength``: sweeps by shards, for clusters whose jobs know nothing of each other.

A script says ``study = dict(function=..., sample=..., folder=...)`` with the arguments of :func:`arclength.sweep`. Then each job of an array
does its part, and one more puts the parts together::

    python -m arclength sweep study.py --shard $SLURM_ARRAY_TASK_ID/100
    python -m arclength merge results -o results.parquet
"""

from __future__ import annotations

import argparse
import importlib
import runpy
import sys
from collections.abc import Sequence
from typing import Any

from .errors import ArclengthError, InvalidInput, Interrupted
from .sweeps import merge, sweep


def _study(path: str, name: str) -> dict[str, Any]:
    try:
        # Under a name of its own: what stands below `if __name__ == "__main__"` is not run.
        names = runpy.run_path(path, run_name="arclength_study")
    except FileNotFoundError:
        raise InvalidInput(f"{path}: there is no such file", key="script", value=path) from None
    study = names.get(name)
    if not isinstance(study, dict):
        allowed = f"{name} = dict(function=..., sample=..., folder=...)"
        raise InvalidInput(f"{path}: there is no mapping `{name}` in it; allowed: {allowed}", key="script", value=path, allowed=allowed)
    return study


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m arclength", description="Sweeps by shards.")
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("sweep", help="compute a sweep, or a shard of it; what is there already is kept")
    one.add_argument("script", help="Python file with the arguments of arclength.sweep as a mapping")
    one.add_argument("--name", default="study", help="name of the mapping (default: study)")
    one.add_argument("--shard", metavar="i/n", help="every n-th chunk from the i-th, i from 1 to n")
    one.add_argument("--threads", type=int, help="number of threads (default: one for each processor)")
    one.add_argument("--scheduler", metavar="ADDRESS", help="scheduler of a Dask cluster")
    one.add_argument("-q", "--quiet", action="store_true", help="no progress on standard error")
    two = commands.add_parser("merge", help="put the shards together: manifest, and one file")
    two.add_argument("folder", help="folder of the sweep")
    two.add_argument("-o", "--out", help="Parquet file with all rows")
    return parser


def _progress(done: float | None, _: str | None) -> None:
    print(f"\r{100 * (done or 0):5.1f} %", end="\n" if done == 1 else "", file=sys.stderr, flush=True)


def _run(asked: argparse.Namespace) -> None:
    if asked.command == "merge":
        swept = merge(asked.folder, asked.out)
        print(f"{swept.count} points in {len(swept.files)} chunks", file=sys.stderr)
        return
    study = dict(_study(asked.script, asked.name))
    if asked.threads is not None:
        study["threads"] = asked.threads
    study.setdefault("progress", None if asked.quiet else _progress)
    if asked.scheduler is None:
        sweep(**study, shard=asked.shard)
        return
    # Without types of its own.
    distributed: Any = importlib.import_module("distributed")
    with distributed.Client(asked.scheduler) as client:
        sweep(**study, shard=asked.shard, client=client)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs it with these arguments, and gives the exit code: 0 done, 1 failed, 2 bad input, 130 interrupted."""
    try:
        _run(_parser().parse_args(arguments))
    except Interrupted as interrupted:
        print(f"\n{interrupted}", file=sys.stderr)
        return 130
    except ArclengthError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2 if isinstance(error, InvalidInput) else 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
