"""Branches and motions drawn with matplotlib, in the style of the figures of the programs."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING, Any

from .errors import InvalidInput

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .results import Branch, Result

#: Line styles by stability; where it is undecided the line is dotted.
LINES = {True: "-", False: "--", None: ":"}
COLOR = "#0072b2"
#: Labels of ends and of values asked for are no bifurcations.
ORDINARY = ("EP", "AT", "MX", "UZ")


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    from matplotlib import pyplot

    return pyplot.subplots()[1]


def _chosen(branch: Branch, x: str | None, y: str | None) -> tuple[str, list[str]]:
    names = list(branch.columns)
    plane = [name for name in ("value", "value_1", "value_2") if name in names]
    renamed = branch.columns.renamed
    keys = [renamed.get(entry["key"], entry["key"]) for entry in branch.document.get("in", [])]
    if keys:
        plane = [key for key in keys if key in names] or plane
    across = x or (plane[0] if plane else names[1])
    if y is not None:
        return across, [y]
    if len(plane) > 1:
        return across, [plane[1]]
    if "psi_max" in names:
        return across, ["psi_max", "psi_min"]
    largest = next((name for name in names if name.startswith("max_")), None)
    if largest is not None:
        return across, [largest, "min_" + largest.removeprefix("max_")]
    left_out = {"label", "value", "stable", "branch", across}
    ordinary = [name for name in names if name not in left_out]
    if not ordinary:
        raise InvalidInput("there is nothing to draw", key="y", allowed=", ".join(names))
    return across, ordinary[:1]


def plot_branch(branch: Branch, ax: Axes | None, x: str | None, y: str | None, style: dict[str, Any]) -> Axes:
    """Draws a branch."""
    ax = _axes(ax)
    across, upwards = _chosen(branch, x, y)
    columns = branch.columns
    rows = len(columns[across])
    stable = list(columns["stable"]) if "stable" in columns else [None] * rows
    branches = list(columns["branch"]) if "branch" in columns else [0] * rows
    color = style.pop("color", COLOR)
    known = "stable" in columns
    for name in upwards:
        place = 0
        for (number, is_stable), group in groupby(zip(branches, stable, strict=True)):
            count = len(list(group))
            # A piece reaches the first point of the next one on the same branch, so that the line has no gaps.
            goes_on = place + count < rows and branches[place + count] == number
            piece = slice(place, place + count + (1 if goes_on else 0))
            line = {"linestyle": LINES[is_stable] if known else "-", "color": color, **style}
            ax.plot(columns[across][piece], columns[name][piece], **line)
            place += count
    if "label" in columns:
        for row, label in enumerate(columns["label"]):
            if label and not str(label).startswith(ORDINARY):
                point = (columns[across][row], columns[upwards[0]][row])
                ax.plot(*point, marker="o", markersize=4, color=color, linestyle="none")
                ax.annotate(str(label), point, textcoords="offset points", xytext=(4, 4), fontsize="small")
    ax.set_xlabel(_axis(branch, across))
    ax.set_ylabel(_axis(branch, upwards[0].removesuffix("_max") if len(upwards) > 1 else upwards[0]))
    return ax


def _axis(result: Result, name: str) -> str:
    unit = result.columns.units.get(name) or result.columns.units.get(f"{name}_max")
    along = result.document.get("along")
    if name == "value" and isinstance(along, dict):
        name, unit = along["key"], along.get("unit") or unit
    name = name.removeprefix("max_")
    return f"{name} ({unit})" if unit else name


def plot_history(result: Result, ax: Axes | None, names: tuple[str, ...], style: dict[str, Any]) -> Axes:
    """Draws columns of a motion over the time."""
    ax = _axes(ax)
    columns = result.columns
    for name in names:
        ax.plot(columns["t"], columns[name], **{"label": name, **style})
    ax.set_xlabel(_axis(result, "t"))
    if len(names) == 1:
        ax.set_ylabel(_axis(result, names[0]))
    else:
        ax.legend()
    return ax


def plot_chart(chart: Any, ax: Axes | None, style: dict[str, Any]) -> Axes:
    """Draws a stability chart."""
    import numpy as np

    ax = _axes(ax)
    x, y = chart.document["x"], chart.document["y"]
    rates = chart.growth_rate
    largest = float(np.nanmax(np.abs(rates))) or 1.0
    colors = {"cmap": "RdBu_r", "vmin": -largest, "vmax": largest, "shading": "nearest", **style}
    mesh = ax.pcolormesh(x["values"], y["values"], rates, **colors)
    ax.figure.colorbar(mesh, ax=ax, label="growth rate (1/s)")
    for curves, line in ((chart.document["stability_boundary"], "-"), (chart.document["rolling_limit"], ":")):
        for curve in curves:
            ax.plot(*np.array(curve).T, linestyle=line, color="black")
    ax.set_xlabel(f"{x['key']} ({x['unit']})")
    ax.set_ylabel(f"{y['key']} ({y['unit']})")
    return ax
