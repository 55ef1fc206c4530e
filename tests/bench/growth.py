"""Curves: what the rows of a series take as they grow, the exponents, and the picture."""

import math
from itertools import groupby
from pathlib import Path
from statistics import linear_regression
from typing import Any

SHOWN = ("rules", "conflicts", "seconds")
OF_SEARCH = {"conflicts": "nodes"}  # what stands for a figure in the curves of the search
LEAST = {"rules": 1, "conflicts": 10, "nodes": 10, "seconds": 0.05}  # below it is no growth
COLOURS = {"baseline": "#888888", "fast": "#0055aa", "search": "#cc5500"}
TITLES = {
    "snakes": "grid snakes 3x3 ...,\nclosed perpendicular planar",
    "walks": "random walks on a 6x6 grid,\none perpendicular planar map",
    "signs": "5x5 tour, more and more signs,\nclosed perpendicular planar",
}
AXES = {"steps": "steps", "kinds": "kinds of views"}


def curves(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """For each series, way and figure: the points, the exponent of y = a x^exponent by least
    squares of the logarithms, and the share of their variance that it explains."""
    found = []
    grown = [row for row in rows if row["growth"] and "about" in row]
    for series, group in groupby(grown, lambda row: row["series"]):
        own = list(group)
        for way in COLOURS:
            for shown in SHOWN:
                figure = OF_SEARCH.get(shown, shown) if way == "search" else shown
                points = [
                    (row["about"][row["growth"]], row["ways"][way][figure])
                    for row in own
                    if figure in row["ways"].get(way, {}) and "cut" not in row["ways"][way]
                ]
                cut = [
                    (row["about"][row["growth"]], row["ways"][way]["limit"])
                    for row in own
                    if row["ways"].get(way, {}).get("cut") == "time"
                ]
                curve = {
                    "series": series,
                    "x": own[0]["growth"],
                    "way": way,
                    "figure": figure,
                    "shown": shown,
                }
                curve |= {"points": sorted(points), "cut": cut}
                if points:
                    found.append(curve | _fit(points, LEAST[figure]))
    return found


def _fit(points: list[tuple[float, float]], least: float) -> dict[str, Any]:
    """The exponent, if there are three points or more to fit."""
    used = [(math.log(x), math.log(y)) for x, y in points if y >= least]
    if len({x for x, _ in used}) < 3:
        return {"fitted": len(used)}
    xs, ys = zip(*used, strict=True)
    line = linear_regression(xs, ys)
    mean = sum(ys) / len(ys)
    left = sum((y - line.slope * x - line.intercept) ** 2 for x, y in used)
    whole = sum((y - mean) ** 2 for y in ys)
    explained = 1 - left / whole if whole else 1.0
    factor = math.exp(line.intercept)
    return {
        "fitted": len(used),
        "exponent": line.slope,
        "factor": factor,
        "explained": explained,
        "from": math.exp(min(xs)),
        "to": math.exp(max(xs)),
    }


def draw(found: list[dict[str, Any]], path: Path) -> None:
    """The picture, the same bytes for the same curves."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.ticker import LogFormatterSciNotation, NullFormatter

    matplotlib.rcParams.update({"svg.hashsalt": "topomap", "font.size": 9})
    columns = list(dict.fromkeys(curve["series"] for curve in found))
    size = (3.6 * max(1, len(columns)) + 0.4, 8.4)
    picture, axes = pyplot.subplots(len(SHOWN), max(1, len(columns)), figsize=size, squeeze=False)
    for row, figure in enumerate(SHOWN):
        for column, series in enumerate(columns):
            axis = axes[row][column]
            axis.set_xscale("log")
            axis.set_yscale("log")
            own = [c for c in found if (c["series"], c["shown"]) == (series, figure)]
            for curve in own:
                _plot(axis, curve)
            if own:
                ticks = sorted({x for c in own for x, _ in c["points"] + c["cut"]})
                axis.set_xticks(_apart(ticks), [f"{x:g}" for x in _apart(ticks)])
                axis.xaxis.set_minor_formatter(NullFormatter())
                axis.minorticks_off()
                axis.yaxis.set_major_formatter(LogFormatterSciNotation())
                axis.set_xlabel(AXES[own[0]["x"]])
                axis.legend(fontsize=8, frameon=False)
            axis.grid(color="#dddddd", linewidth=0.5)
            if row == 0:
                axis.set_title(TITLES.get(series, series), fontsize=9)
            if column == 0:
                axis.set_ylabel(
                    {"rules": "ground rules", "conflicts": "conflicts, or nodes of the search"}.get(
                        figure, figure
                    )
                )
    picture.tight_layout()
    kind = path.suffix[1:]
    path.parent.mkdir(parents=True, exist_ok=True)
    picture.savefig(path, format=kind, metadata={"Date": None} if kind == "svg" else None)
    pyplot.close(picture)


def _apart(values: list[float]) -> list[float]:
    """Those values that have room for their numbers on the axis."""
    kept: list[float] = []
    for value in values:
        if not kept or value > 1.25 * kept[-1]:
            kept.append(value)
    return kept


def _plot(axis: Any, curve: dict[str, Any]) -> None:
    """Points, the line fitted to them, and at the time limit what was cut."""
    colour = COLOURS[curve["way"]]
    label = curve["way"]
    if "exponent" in curve:
        label += f": exponent {curve['exponent']:.1f}"
        xs = [curve["from"], curve["to"]]
        axis.plot(xs, [curve["factor"] * x ** curve["exponent"] for x in xs], color=colour, lw=0.8)
    shown = [(x, y) for x, y in curve["points"] if y > 0]
    axis.plot(
        *zip(*shown, strict=True) if shown else ((), ()), "o", ms=4, color=colour, label=label
    )
    if curve["figure"] == "seconds" and curve["cut"]:
        axis.plot(*zip(*curve["cut"], strict=True), "^", ms=6, mfc="none", color=colour)
