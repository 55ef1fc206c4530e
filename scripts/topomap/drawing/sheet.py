"""Maps side by side on one sheet in a file, with titles and a legend.

The same maps always give the same bytes.
"""

import re
import warnings
from collections.abc import Sequence
from typing import IO, Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path as Outline
from matplotlib.textpath import TextPath
from matplotlib.transforms import Bbox

from topomap.drawing.layout import Layout
from topomap.drawing.panel import (
    AGENT,
    CROSSING,
    DASHES,
    FACES,
    INK,
    LINK,
    PENDING,
    SIGNED,
    STEP,
    TITLE,
    UNIT,
    draw,
    extent,
)
from topomap.drawing.scenes import Scene

LEAST, WIDEST = 4.5, 3.2  # inches: the least width of a picture, and the largest of a title
STYLE: Any = {
    "text.parse_math": False,  # a name may have a "$"
    "svg.hashsalt": "topomap",
    "svg.fonttype": "none",
    "font.family": "DejaVu Sans",
    "pdf.fonttype": 42,
}


def _wrapped(text: str, inches: float) -> list[str]:
    """The lines of a title."""
    lines = []
    for told in text.splitlines():
        lines.append("")
        for word in re.findall(r"\S+\s*|\s+", told):
            if lines[-1] and extent(lines[-1] + word.rstrip(), TITLE) > inches:
                lines.append("")
            for letter in word:
                if lines[-1] and letter != " " and extent(lines[-1] + letter, TITLE) > inches:
                    lines.append("")
                lines[-1] += letter
    return [line.rstrip() for line in lines]


def legend(
    figure: Figure, scenes: Sequence[Scene], drawn: Sequence[Layout], inches: float
) -> Legend:
    """Explain the signs that occur in the scenes, in lines at the foot of a figure."""
    worlds = [scene.world for scene in scenes]
    dot = Line2D([], [], marker=Outline.circle((0, 1), 0.4), ls="", mfc=INK, mew=0, ms=11)
    place: Any = {"marker": "o", "ls": "", "mec": INK, "ms": 8}
    which = (Line2D([], [], mfc="white", **place), dot)
    entries: list[tuple[Any, str]] = [(which, "place; the dot marks its gateway 0")]
    if any(world.links for world in worlds):
        entries.append((Line2D([], [], color=LINK, lw=2), "link"))
    if any(world.pending() for world in worlds):
        pending: Any = {"marker": "o", "mfc": "white", "mec": PENDING, "markevery": [1]}
        line = Line2D([0, 1], [0, 0], color=PENDING, lw=1.8, **pending)
        entries.append((line, "pending gateway"))
    if any(laid.crossing for laid in drawn):
        entries.append((Line2D([], [], color=CROSSING, lw=1.6, ls=DASHES), "link that crosses"))
    if any(len(laid.faces) > 1 for laid in drawn):
        entries.append((Patch(fc=FACES[0]), "face"))
    if any(any(world.landmarks.values()) for world in worlds):
        entries.append((Line2D([], [], mfc=SIGNED, **place), "place with landmarks"))
    if any(len(scene.at) > 1 for scene in scenes):
        digit = TextPath((0, 0), "3", size=1)
        middle = (digit.vertices.min(0) + digit.vertices.max(0)) / 2
        marker = Outline(digit.vertices - middle, digit.codes)
        entries.append((Line2D([], [], marker=marker, ls="", color=STEP, mew=0, ms=6), "step"))
    if any(scene.at for scene in scenes):
        entries.append((Line2D([], [], marker="^", ls="", color=AGENT, ms=7), "agent"))
    handles, labels = zip(*entries, strict=True)
    style: Any = {"loc": "lower center", "fontsize": 7, "frameon": False, "columnspacing": 1.5}
    style["handler_map"] = {tuple: HandlerTuple(ndivide=1)}
    for columns in range(len(entries), 0, -1):
        made = figure.legend(handles, labels, ncols=columns, **style)
        if columns == 1 or _inches(figure, made)[0] <= inches:
            break
        made.remove()
    return made


def _inches(figure: Figure, made: Legend) -> tuple[float, float]:
    """The width and height of a legend."""
    box = made.get_window_extent()
    return box.width / figure.dpi, box.height / figure.dpi


def picture(
    scenes: Sequence[Scene], columns: int = 3, laid: Sequence[Layout | None] = ()
) -> Figure:
    """Draw maps side by side, in one scale, and a legend.

    Each is in the middle of as much room as the largest one in its row or column needs, below a
    title that is not wider. They are drawn as they are ``laid`` out, if that is known.
    """
    with mpl.rc_context(STYLE):
        figure = Figure()
        FigureCanvasAgg(figure)
        columns = min(columns, len(scenes))
        panels = [figure.add_axes((0, 0, 1, 1)) for _ in scenes]
        drawn = [
            draw(axes, scene, laid=one)
            for scene, axes, one in zip(scenes, panels, laid or [None] * len(scenes), strict=True)
        ]
        spans = UNIT * np.array([_spans(axes) for axes in panels])
        lines = [line for axes in panels for line in axes.get_title().splitlines()]
        longest = max(extent(line, TITLE) for line in lines) + 0.2
        least = max(LEAST / columns, min(longest, WIDEST))
        wide = [max(least, *spans[n::columns, 0]) for n in range(columns)]
        titles = [
            _wrapped(axes.get_title(), wide[n % columns] - 0.2) for n, axes in enumerate(panels)
        ]
        rows = range(0, len(scenes), columns)
        heads = [max(map(len, titles[n : n + columns])) * TITLE * 1.2 / 72 + 0.15 for n in rows]
        high = [max(spans[n : n + columns, 1]) for n in rows]
        foot = _inches(figure, legend(figure, scenes, drawn, sum(wide)))[1]
        size = np.array([sum(wide), sum(heads) + sum(high) + foot])
        figure.set_size_inches(*size)
        for n, (axes, told) in enumerate(zip(panels, titles, strict=True)):
            axes.set_title("\n".join(told), fontsize=TITLE, color=INK, pad=5)
            row, column = divmod(n, columns)
            x = sum(wide[:column]) + wide[column] / 2
            y = size[1] - sum(heads[: row + 1]) - sum(high[:row]) - high[row] / 2
            # It is as high as the row, so that the titles are aligned.
            half = np.array([spans[n, 0], high[row]]) / 2
            low, top = axes.get_ylim()
            middle = (low + top) / 2
            axes.set_ylim(middle - half[1] / UNIT, middle + half[1] / UNIT)
            centre = np.array([x, y])
            axes.set_position(Bbox([(centre - half) / size, (centre + half) / size]))
    return figure


def _spans(axes: Axes) -> tuple[float, float]:
    """The width and height of what axes show."""
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    return x1 - x0, y1 - y0


def write(figure: Figure, file: IO[bytes], format: str) -> None:
    """Write a figure as svg, png or pdf, without the date."""
    about = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {"Software": None}}
    with mpl.rc_context(STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        figure.savefig(file, format=format, metadata=about[format], dpi=150)
