"""Numerical continuation of ordinary differential equations, and the shimmy of towed wheels (:mod:`arclength.kingpin`).

>>> import arclength
>>> model = arclength.Model(lambda x, p: [x[1], (p.mu - x[1] ** 2) * x[1] - x[0]], states=["x", "y"], parameters={"mu": -1.0})
>>> branch = model.equilibria(along=("mu", -1, 1))
>>> branch.labels
['EP1', 'HB1', 'EP2']
>>> cycles = branch["HB1"].cycles(along=("mu", -1, 1))
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._native import __version__
from .errors import (
    AnalysisWarning,
    ArclengthError,
    ComputationFailed,
    Interrupted,
    InvalidInput,
    InvalidModel,
    NotTraceable,
    UnknownLabel,
)
from .models import Cycles, Equilibria, History, Locus, Model, Parameters
from .records import Record
from .results import Branch, Columns, Point, Result, load

if TYPE_CHECKING:
    from .sweeps import Swept, grid, merge, random_sample, sweep

__all__ = [
    "AnalysisWarning",
    "ArclengthError",
    "Branch",
    "Columns",
    "ComputationFailed",
    "Cycles",
    "Equilibria",
    "History",
    "Interrupted",
    "InvalidInput",
    "InvalidModel",
    "Locus",
    "Model",
    "NotTraceable",
    "Parameters",
    "Point",
    "Record",
    "Result",
    "Swept",
    "UnknownLabel",
    "__version__",
    "grid",
    "load",
    "merge",
    "random_sample",
    "sweep",
]

_SWEEPS = ("Swept", "grid", "merge", "random_sample", "sweep")


def __getattr__(name: str) -> Any:
    # Executors and the rest take longer to import than all else; they are when they are first used.
    if name in _SWEEPS:
        from . import sweeps

        globals().update({each: getattr(sweeps, each) for each in _SWEEPS})
        return globals()[name]
    raise AttributeError(f"module `arclength` has no `{name}`")


def __dir__() -> list[str]:
    return sorted({*globals(), *_SWEEPS})
