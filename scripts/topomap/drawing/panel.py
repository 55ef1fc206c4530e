"""One map, drawn into axes by matplotlib: its places, lines, faces, landmarks and steps."""

from collections.abc import Sequence
from functools import cache
from math import atan2, cos, sin
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import findfont, get_font
from matplotlib.patches import Circle, PathPatch, Polygon
from matplotlib.path import Path as Outline
from scipy.spatial import KDTree

from topomap.drawing.clearance import RADIUS
from topomap.drawing.labels import gaps
from topomap.drawing.layout import ELSEWHERE, Layout, layout
from topomap.drawing.mesh import Points
from topomap.drawing.scenes import Scene
from topomap.model import words
from topomap.model.topology import Gateway, Place, TopologicalMap, gid, label

INK, LINK, CROSSING, PENDING = "#1b1b1b", "#3d4a57", "#c2332d", "#2f7fc1"
AGENT, SIGN, SIGNED, STEP = "#e07b00", "#2e7d4f", "#e7f5ea", "#5c6670"
FACES = ("#dfeaf3", "#f6ead9", "#e3f0e0", "#efe3ef", "#f3f0d8", "#dff0ee")
BESIDE = 0.15  # the distance of a text from its line; what is farther away is not near
DASHES: Any = (0, (4, 2))
UNIT = 0.8  # inches of a link of length 1
MARGIN = 0.35  # the margin around all lines
TITLE = 9  # the size of titles in points
LETTERS = 5  # letters in a line of the name of a place, if it is longer but not too long

Box = tuple[float, float, float, float]  # left, bottom, right, top


def draw(
    axes: Axes, scene: Scene, faces: bool = True, route: bool = True, laid: Layout | None = None
) -> Layout:
    """Draw a map into axes, as it is ``laid`` out, and return the layout.

    If some links cross others, no faces are drawn, because those of the planar part
    are not the map's.
    """
    world = scene.world
    at = scene.at
    laid = laid or layout(world, scene.ahead, where=scene.where())
    for gateway, line in laid.lines.items():
        _draw_line(axes, world, laid, gateway, line)
    for place, point in laid.places.items():
        _draw_place(axes, world, laid, place, point)
    texts: list[Box] = []
    if route:
        number = {gateway: n for n, gateway in enumerate(laid.lines)}
        dots = np.array([_even(line) for line in laid.lines.values()])
        tree = KDTree(dots.reshape(-1, 2))
        for gateway, steps in scene.steps().items():
            near = dots[number[gateway]].mean(0)
            far = np.linalg.norm(dots[number[gateway]] - near, axis=1).max() + 2 * BESIDE
            spots = np.array(tree.query_ball_point(near, far), int)
            own = [number[gateway], number[world.links[gateway]]]
            others = tree.data[spots[~np.isin(spots // len(dots[0]), own)]]
            texts.append(_draw_steps(axes, laid, gateway, steps, others))
    taken = [(x - RADIUS, y - RADIUS, x + RADIUS, y + RADIUS) for x, y in laid.places.values()]
    stubs = [line for end, line in laid.lines.items() if end not in world.links]
    taken += [(*(line.min(0) - 0.05), *(line.max(0) + 0.05)) for line in stubs]
    for place in laid.places:
        if world.landmarks.get(place):
            texts.append(_draw_signs(axes, world, laid, place, [*taken, *texts]))
    points = np.concatenate([*laid.lines.values(), *([p] for p in laid.places.values())])
    corners = np.array(texts).reshape(-1, 2)
    low = np.min([*(points - MARGIN), *(corners - 0.06)], axis=0)
    high = np.max([*(points + MARGIN), *(corners + 0.06)], axis=0)
    if faces and not laid.crossing:
        # Room for the number of the outer face, at the bottom.
        low[1] = min([points[:, 1].min() - MARGIN - 0.12, *(corners[:, 1] - 0.26)])
        _draw_faces(axes, laid, [*texts, *taken], low + 0.06)
    if at:
        _draw_agent(axes, laid, at[-1])
    axes.set_title(title(scene, laid), fontsize=TITLE, color=INK, pad=5)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    return laid


def title(scene: Scene, laid: Layout) -> str:
    """Say what the map is, and how many links cross others; or that it is drawn plainly."""
    count = len(laid.crossing)
    others = "1 link crosses others" if count == 1 else f"{count} links cross others"
    told = [scene.title, *[others] * bool(count), *[laid.note] * bool(laid.note)]
    told += [ELSEWHERE] * laid.elsewhere
    return ", ".join(told)


@cache
def _advance(letter: str) -> float:
    """The width of a letter in the font, in ems; another font may show what this one lacks."""
    font = get_font(findfont("DejaVu Sans"))
    if not font.get_char_index(ord(letter)):
        return 1.2
    font.set_size(100, 72)
    return float(font.load_char(ord(letter)).linearHoriAdvance) / 65536 / 100


def extent(text: str, points: float) -> float:
    """An upper bound on the width of a text in inches; fitting letters to pixels widens them."""
    return 1.05 * sum(map(_advance, text)) * points / 72


def _draw_faces(axes: Axes, laid: Layout, taken: Sequence[Box], corner: Points) -> None:
    """Draw the faces and their numbers away from other things; the outer one's in a corner."""
    style: Any = {"color": "#767676", "fontsize": 9, "style": "italic"}
    for number, face in enumerate(laid.faces):
        if number == laid.outer:
            name = f"{number + 1} (outer)"
            x, y = corner
            axes.text(x, y, name, **style, ha="left", va="bottom", gid=f"number-{number + 1}")
            continue
        outline = laid.outline(face)
        colour = FACES[number % len(FACES)]
        face_name = f"face-{number + 1}"
        axes.add_patch(Polygon(outline, color=colour, lw=0, zorder=0.5, gid=face_name))
        x, y = inside(outline, taken)
        name = f"number-{number + 1}"
        axes.text(x, y, str(number + 1), **style, ha="center", va="center", gid=name)


def inside(outline: Points, taken: Sequence[Box] = (), grid: int = 24) -> Points:
    """A point well inside a polygon.

    It is the point of a grid that is farthest from the outline and from what is taken.
    """
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
    for x0, y0, x1, y1 in taken:
        if x0 < high[0] and x1 > low[0] and y0 < high[1] and y1 > low[1]:
            away = points - np.clip(points, (x0, y0), (x1, y1))
            far = np.minimum(far, np.linalg.norm(away, axis=-1).round(6))
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


def _draw_place(
    axes: Axes, world: TopologicalMap, laid: Layout, place: Place, point: Points
) -> None:
    """Draw a circle with a tick for each gateway, and a dot at gateway 0."""
    face = SIGNED if world.landmarks.get(place) else "white"
    name = label(place)
    axes.add_patch(
        Circle(tuple(point), RADIUS, fc=face, ec=INK, lw=1.2, zorder=4, gid=f"place-{name}")
    )
    ticks = []
    for slot in sorted(world.stars[place]):
        out = _out(laid.lines[place, slot])
        ticks += [point + RADIUS * out, point + 1.4 * RADIUS * out]
        if slot == 0:
            dot = tuple(point + RADIUS * out)
            axes.add_patch(
                Circle(dot, 0.05, fc=INK, ec="white", lw=0.6, zorder=4.5, gid=f"zero-{name}")
            )
    if ticks:
        codes = [Outline.MOVETO, Outline.LINETO] * (len(ticks) // 2)
        path = Outline(np.array(ticks), codes)
        style: Any = {"ec": INK, "lw": 3, "capstyle": "butt", "zorder": 4.2}
        axes.add_patch(PathPatch(path, fill=False, **style, gid=f"ticks-{name}"))
    x, y = point
    lines = words.wrapped(name, LETTERS if len(name) <= LETTERS**2 else len(name))
    size = min(7.0, 18 / max(map(len, lines)), 18 / 1.2 / len(lines))
    axes.text(x, y, "\n".join(lines), fontsize=size, ha="center", va="center", color=INK, zorder=5)


def _out(line: Points) -> Points:
    """The direction in which a line leaves."""
    return np.asarray((line[1] - line[0]) / np.linalg.norm(line[1] - line[0]))


def _draw_signs(
    axes: Axes, world: TopologicalMap, laid: Layout, place: Place, taken: Sequence[Box]
) -> Box:
    """Draw the landmarks of a place, in the widest gap between the lines that leave it.

    If the text covers something there, it goes into the gap where it covers least.

    Returns:
        Where the text is.
    """
    lines = words.sign_lines(world.landmarks[place])
    text = "\n".join(lines)
    wide = max(extent(line, 7) for line in lines) / UNIT + 0.04
    high = len(lines) * 7 * 1.2 / 72 / UNIT
    outs = (_out(laid.lines[place, slot]) for slot in world.stars[place])
    places: list[Box] = []
    for gap, middle in gaps([atan2(y, x) for x, y in outs]):
        if gap > 0.5 or not places:
            x, y = laid.places[place] + 1.2 * RADIUS * np.array([cos(middle), sin(middle)])
            side = 0 if abs(cos(middle)) < 0.3 else np.sign(cos(middle))
            up = 0 if abs(sin(middle)) < 0.3 else np.sign(sin(middle))
            left, bottom = x + (side - 1) * wide / 2, y + (up - 1) * high / 2
            places.append((left, bottom, left + wide, bottom + high))
    box = min(places, key=lambda box: round(sum(_shared(box, other) for other in taken), 3))
    x, y = (box[0] + box[2]) / 2, (box[1] + box[3]) / 2
    halo: Any = {"fc": "white", "lw": 0, "alpha": 0.8, "boxstyle": "round,pad=0.08"}
    style: Any = {"ha": "center", "va": "center", "bbox": halo, "zorder": 6}
    axes.text(x, y, text, fontsize=7, color=SIGN, gid=f"sign-{label(place)}", **style)
    return box


def _shared(one: Box, other: Box) -> float:
    """The area that two boxes have in common."""
    wide, high = (min(one[n + 2], other[n + 2]) - max(one[n], other[n]) for n in (0, 1))
    return max(0.0, wide) * max(0.0, high)


def _even(line: Points, parts: int = 24) -> Points:
    """Points on a line, in equal steps from its beginning to its end."""
    along = np.concatenate([[0], np.linalg.norm(np.diff(line, axis=0), axis=1).cumsum()])
    at = np.linspace(0, along[-1], parts + 1)
    return np.stack([np.interp(at, along, line[:, axis]) for axis in (0, 1)], 1)


def _draw_steps(
    axes: Axes, laid: Layout, gateway: Gateway, steps: list[int], others: Points
) -> Box:
    """Draw the numbers of the steps that leave by a gateway, on the right of the way.

    They are kept away from other lines, of which points are given (all those that may be near).

    Returns:
        Where the numbers are.
    """
    line = _even(laid.lines[gateway])
    spots: list[tuple[float, int, Points, Points, Points]] = []
    for k in (12, 7, 17):  # the middle, unless another line is near
        ahead = (line[k + 2] - line[k - 2]) / np.linalg.norm(line[k + 2] - line[k - 2])
        right = np.array([ahead[1], -ahead[0]])
        away = np.linalg.norm(others - line[k] - 0.13 * right, axis=1).min(initial=1)
        spots.append((-min(BESIDE, round(away, 3)), len(spots), line[k], ahead, right))
    *_, middle, ahead, right = min(spots, key=lambda spot: spot[:2])
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
    half = np.array([extent(text, 5.5), 5.5 / 72]) / UNIT / 2
    wide, high = half @ abs(np.array([[ahead[0], ahead[1]], [ahead[1], ahead[0]]]))
    return x - wide, y - high, x + wide, y + high


def _upright(ahead: Points) -> float:
    """The angle, in degrees, of a text along a line that is not upside down."""
    turn = float(np.degrees(np.arctan2(ahead[1], ahead[0]))) % 360
    return turn - 180 if 90 < turn <= 270 else turn


def _draw_agent(axes: Axes, laid: Layout, dstate: Gateway) -> None:
    """Draw the agent at its gateway."""
    line = laid.lines[dstate]
    out = line[1] - line[0]
    out = out / np.linalg.norm(out)
    side = np.array([-out[1], out[0]])
    foot = line[0] + 1.25 * RADIUS * out
    points = [foot + 0.17 * out, foot + 0.08 * side, foot - 0.08 * side]
    axes.add_patch(
        Polygon(points, fc=AGENT, ec="white", lw=0.6, zorder=7, gid=f"agent-{gid(dstate)}")
    )
