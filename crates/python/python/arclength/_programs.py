"""The programs ``arclength`` and ``kingpin``."""

from __future__ import annotations

import sys

from . import _native


def _run(program: str) -> int:
    return _native.run_program(program, [program, *sys.argv[1:]])


def arclength() -> int:
    """The program ``arclength``."""
    return _run("arclength")


def kingpin() -> int:
    """The program ``kingpin``."""
    return _run("kingpin")
