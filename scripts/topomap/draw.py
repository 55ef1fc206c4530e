"""Pictures of maps, by matplotlib: the same bytes for the same map."""

from collections.abc import Sequence
from typing import IO, Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon
from matplotlib.path import Path as Outline

from topomap.bent import Points
from topomap.layout import Layout, layout
from topomap.scenes import Scene
from topomap.topology import Gateway, Place, TopologicalMap, gid, label

INK, LINK, CROSSING, PENDING = "#1b1b1b", "#3d4a57", "#c2332d", "#2f7fc1"
AGENT, SIGN, SIGNED, STEP = "#e07b00", "#2e7d4f", "#e7f5ea", "#5c6670"
FACES = ("#dfeaf3", "#f6ead9", "#e3f0e0", "#efe3ef", "#f3f0d8", "#dff0ee")
RADIUS = 0.15  # of a place's circle, where a link is of length 1
DASHES: Any = (0, (4, 2))
UNIT = 0.8  # inches that a link of length 1 takes
STYLE: Any = {
    "svg.hashsalt": "topomap",
    "svg.fonttype": "none",
    "font.family": "DejaVu Sans",
    "pdf.fonttype": 42,
}


def draw(axes: Axes, scene: Scene, faces: bool = True, route: bool = True) -> Layout:
    """Draw a map into axes; returns where everything is."""
    world = scene.world
    at = scene.at
    ahead = world.links[at[1]] if len(at) > 1 else None
    laid = layout(world, ahead)
    if faces:
        _draw_faces(axes, laid)
    for gateway, line in laid.lines.items():
        _draw_line(axes, world, laid, gateway, line)
    for place, point in laid.places.items():
        _draw_place(axes, world, place, point)
    if route:
        for gateway, steps in scene.steps().items():
            _draw_steps(axes, laid, gateway, steps)
    if at:
        _draw_agent(axes, laid, at[-1])
    axes.set_title(scene.title, fontsize=9, color=INK, pad=8)
    axes.set_aspect("equal")
    axes.set_axis_off()
    points = np.concatenate([*laid.lines.values(), *([p] for p in laid.places.values())])
    low, high = points.min(0) - 0.45, points.max(0) + 0.45
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    return laid


def _draw_faces(axes: Axes, laid: Layout) -> None:
    for number, face in enumerate(laid.faces):
        if number == laid.outer:
            continue
        outline = laid.outline(face)
        colour = FACES[number % len(FACES)]
        axes.add_patch(Polygon(outline, color=colour, lw=0, gid=f"face-{number + 1}"))
        x, y = inside(outline)
        text = str(number + 1)
        axes.text(x, y, text, color="#8b8b8b", fontsize=9, style="italic", ha="center", va="center")


def inside(outline: Points, grid: int = 24) -> Points:
    """A point well inside a polygon: of a grid of points the one farthest from its line."""
    low, high = outline.min(0), outline.max(0)
    xs, ys = (np.linspace(low[axis], high[axis], grid + 2)[1:-1] for axis in (0, 1))
    points = np.array([(x, y) for y in ys for x in xs])
    points = points[Outline(outline).contains_points(points)]
    if not len(points):
        return np.asarray(outline.mean(0))
    a, b = outline, np.roll(outline, -1, axis=0)
    side = b - a
    along = ((points[:, None] - a) * side).sum(-1) / np.maximum((side**2).sum(-1), 1e-12)
    nearest = a + np.clip(along, 0, 1)[..., None] * side
    far = np.linalg.norm(points[:, None] - nearest, axis=-1).min(1).round(6)
    return np.asarray(points[far.argmax()])


def _draw_line(
    axes: Axes, world: TopologicalMap, laid: Layout, gateway: Gateway, line: Points
) -> None:
    name = gid(gateway)
    crossing = [out for out, _ in laid.crossing]
    if gateway not in world.links:
        axes.plot(*line.T, color=PENDING, lw=1.8, solid_capstyle="round", gid=f"pending-{name}")
        axes.plot(*line[-1], "o", ms=4, mfc="white", mec=PENDING, mew=1.2)
    elif gateway in crossing:
        name += "-to-" + gid(world.links[gateway])
        axes.plot(*line.T, color=CROSSING, lw=1.6, ls=DASHES, gid=f"crossing-{name}")
    elif all(gateway != end for _, end in laid.crossing) and gateway < world.links[gateway]:
        name += "-to-" + gid(world.links[gateway])
        axes.plot(*line.T, color=LINK, lw=2, solid_joinstyle="round", gid=f"link-{name}")


def _draw_place(axes: Axes, world: TopologicalMap, place: Place, point: Points) -> None:
    signs = ", ".join(sign.strip('"') for sign in sorted(world.landmarks.get(place, ())))
    face = SIGNED if signs else "white"
    axes.add_patch(
        Circle(tuple(point), RADIUS, fc=face, ec=INK, lw=1.2, zorder=4, gid=f"place-{label(place)}")
    )
    x, y = point
    axes.text(x, y, label(place), fontsize=7, ha="center", va="center", color=INK, zorder=5)
    if signs:
        axes.text(
            x + RADIUS, y + RADIUS, signs, fontsize=7, color=SIGN, ha="left", va="bottom", zorder=6
        )


def _draw_steps(axes: Axes, laid: Layout, gateway: Gateway, steps: list[int]) -> None:
    """The numbers of the steps that leave by a gateway, on the right of the way."""
    line = laid.lines[gateway]
    if len(line) == 2:
        line = np.linspace(line[0], line[-1], 9)
    k = len(line) // 2
    ahead = line[k] - line[k - 1]
    ahead = ahead / np.linalg.norm(ahead)
    right = np.array([ahead[1], -ahead[0]])
    middle = line[k] if len(line) % 2 else (line[k] + line[k - 1]) / 2
    x, y = middle + 0.13 * right
    text = " ".join(map(str, steps[:3])) + (" …" if len(steps) > 3 else "")
    axes.text(
        x,
        y,
        text,
        fontsize=5.5,
        color=STEP,
        ha="center",
        va="center",
        rotation=_upright(ahead),
        rotation_mode="anchor",
        zorder=3,
    )
    tip = middle + 0.05 * right
    axes.annotate(
        "",
        xy=tuple(tip + 0.09 * ahead),
        xytext=tuple(tip - 0.09 * ahead),
        arrowprops={"arrowstyle": "-|>", "lw": 0.6, "color": "#9aa4ae", "mutation_scale": 5},
        zorder=3,
    )


def _upright(ahead: Points) -> float:
    """The angle, in degrees, of a text along a line, not upside down."""
    turn = float(np.degrees(np.arctan2(ahead[1], ahead[0]))) % 360
    return turn - 180 if 90 < turn <= 270 else turn


def _draw_agent(axes: Axes, laid: Layout, dstate: Gateway) -> None:
    """The agent at the gateway where it stands."""
    line = laid.lines[dstate]
    out = line[1] - line[0]
    out = out / np.linalg.norm(out)
    side = np.array([-out[1], out[0]])
    foot = line[0] + 1.25 * RADIUS * out
    points = [foot + 0.17 * out, foot + 0.08 * side, foot - 0.08 * side]
    axes.add_patch(
        Polygon(points, fc=AGENT, ec="white", lw=0.6, zorder=7, gid=f"agent-{gid(dstate)}")
    )


def legend(figure: Figure, scenes: Sequence[Scene]) -> None:
    """What the signs mean, of those that occur, in a line or more at the foot of a figure."""
    worlds = [scene.world for scene in scenes]
    place: Any = {"marker": "o", "ls": "", "mec": INK, "ms": 8}
    entries: list[tuple[Any, str]] = [(Line2D([], [], mfc="white", **place), "place")]
    if any(world.links for world in worlds):
        entries.append((Line2D([], [], color=LINK, lw=2), "link"))
    if any(world.pending() for world in worlds):
        pending: Any = {"marker": "o", "mfc": "white", "mec": PENDING, "markevery": [1]}
        line = Line2D([0, 1], [0, 0], color=PENDING, lw=1.8, **pending)
        entries.append((line, "pending gateway"))
    if any(world.genus() for world in worlds):
        entries.append((Line2D([], [], color=CROSSING, lw=1.6, ls=DASHES), "link that crosses"))
    if any(len(world.faces()) > 1 for world in worlds):
        entries.append((Patch(fc=FACES[0]), "face"))
    if any(any(world.landmarks.values()) for world in worlds):
        entries.append((Line2D([], [], mfc=SIGNED, **place), "place with landmarks"))
    if any(len(scene.at) > 1 for scene in scenes):
        entries.append((Line2D([], [], marker="$3$", ls="", color=STEP, ms=6), "step"))
    if any(scene.at for scene in scenes):
        entries.append((Line2D([], [], marker="^", ls="", color=AGENT, ms=7), "agent"))
    columns = max(1, int(figure.get_size_inches()[0] / 1.3))
    handles, labels = zip(*entries, strict=True)
    figure.legend(handles, labels, loc="lower center", ncols=columns, fontsize=7, frameon=False)


def picture(scenes: Sequence[Scene], columns: int = 3) -> Figure:
    """Maps side by side, and a legend."""
    with mpl.rc_context(STYLE):
        figure = Figure()
        FigureCanvasAgg(figure)
        columns = min(columns, len(scenes))
        rows = -(-len(scenes) // columns)
        grid = figure.subplots(rows, columns, squeeze=False)
        used = grid.ravel()[: len(scenes)]
        for scene, axes in zip(scenes, used, strict=True):
            draw(axes, scene)
        # One scale for all: each map in the middle of as much room as the largest needs.
        width, height = np.max([_spans(axes) for axes in used], axis=0)
        for axes in used:
            (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
            axes.set_xlim((x0 + x1 - width) / 2, (x0 + x1 + width) / 2)
            axes.set_ylim((y0 + y1 - height) / 2, (y0 + y1 + height) / 2)
        for axes in grid.ravel()[len(scenes) :]:
            axes.set_axis_off()
        size = max(4.5, columns * width * UNIT), rows * (height * UNIT + 0.6) + 0.6
        figure.set_size_inches(size)
        legend(figure, scenes)
        bottom = 0.6 / figure.get_size_inches()[1]
        figure.subplots_adjust(0.01, bottom, 0.99, 1 - bottom * 0.9, 0.02, 0.15)
    return figure


def _spans(axes: Axes) -> tuple[float, float]:
    """Width and height of what axes show."""
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    return x1 - x0, y1 - y0


def save(figure: Figure, file: IO[bytes], format: str) -> None:
    """Write a figure: svg, png or pdf, without the date."""
    about = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {"Software": None}}
    with mpl.rc_context(STYLE):
        figure.savefig(file, format=format, metadata=about[format], dpi=150)
