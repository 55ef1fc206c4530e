"""Curves: what the rows of a series take as they grow, the exponents, and the picture."""

import logging
import math
from itertools import groupby
from pathlib import Path
from statistics import linear_regression
from typing import Any

SHOWN = ("rules", "conflicts", "seconds")
OF_SEARCH = {"conflicts": "nodes"}  # what stands for a figure in the curves of the search
LEAST = {
    "rules": 1,
    "conflicts": 10,
    "nodes": 10,
    "seconds": 0.05,
}  # less is not growth
STYLES: dict[str, dict[str, Any]] = {
    "baseline": {"color": "#888888", "marker": "s", "markersize": 7, "markerfacecolor": "none"},
    "work": {"color": "#0055aa", "marker": "o", "markersize": 4},
    "search": {"color": "#cc5500", "marker": "D", "markersize": 4},
}
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
        for way in STYLES:
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

    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # no word of a cache of fonts
    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.ticker import NullLocator

    matplotlib.rcParams.update({"svg.hashsalt": "topomap", "svg.fonttype": "none", "font.size": 9})
    columns = list(dict.fromkeys(curve["series"] for curve in found))
    size = (3.6 * max(1, len(columns)) + 0.4, 8.4)
    picture, axes = pyplot.subplots(
        len(SHOWN), max(1, len(columns)), figsize=size, squeeze=False, sharex="col"
    )
    for row, figure in enumerate(SHOWN):
        for column, series in enumerate(columns):
            axis = axes[row][column]
            axis.set_xscale("log")
            axis.set_yscale("log")
            own = [c for c in found if (c["series"], c["shown"]) == (series, figure)]
            for curve in own:
                _plot(axis, curve)
            ys = [y for curve in own for _, y in curve["points"] if y > 0]
            ys += [y for curve in own for _, y in curve["cut"] if figure == "seconds"]
            if ys:  # a decade at least, so that the axis has numbers
                bottom, top = math.floor(math.log10(min(ys))), math.ceil(math.log10(max(ys)))
                axis.set_ylim(10**bottom / 2, 10 ** max(top, bottom + 1) * 2)
                axis.legend(fontsize=8, frameon=False)
            axis.xaxis.set_minor_locator(NullLocator())
            axis.yaxis.set_minor_locator(NullLocator())
            axis.grid(color="#dddddd", linewidth=0.5)
            if row == 0:
                axis.set_title(TITLES.get(series, series), fontsize=9)
            if column == 0:
                axis.set_ylabel(
                    {"rules": "ground rules", "conflicts": "conflicts, or nodes of the search"}.get(
                        figure, figure
                    )
                )
    for column, series in enumerate(columns):
        own = [curve for curve in found if curve["series"] == series]
        ticks = _apart(sorted({x for curve in own for x, _ in curve["points"] + curve["cut"]}))
        axes[-1][column].set_xticks(ticks, [f"{x:g}" for x in ticks])
        axes[-1][column].set_xlabel(AXES[own[0]["x"]])
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
    style = STYLES[curve["way"]]
    colour = style["color"]
    label = curve["way"]
    if "exponent" in curve:
        label += f": exponent {curve['exponent']:.1f}"
        xs = [curve["from"], curve["to"]]
        axis.plot(xs, [curve["factor"] * x ** curve["exponent"] for x in xs], color=colour, lw=0.8)
    shown = [(x, y) for x, y in curve["points"] if y > 0] or [(math.nan, math.nan)]
    axis.plot(*zip(*shown, strict=True), linestyle="none", label=label, **style)
    if curve["figure"] == "seconds" and curve["cut"]:
        axis.plot(*zip(*curve["cut"], strict=True), "^", ms=6, mfc="none", color=colour)
