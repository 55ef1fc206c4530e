"""The paper's figures, and a few more, from computed answers (``make figures``)."""

from collections.abc import Callable, Collection
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from matplotlib.ticker import MaxNLocator, NullFormatter

from topomap.drawing import panel, scenes, sheet
from topomap.drawing.clearance import RADIUS
from topomap.drawing.mesh import Points
from topomap.drawing.scenes import Scene
from topomap.model.experience import Experience
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.paper import figure4
from topomap.runtime.watch import Stopped, Watch
from topomap.search import branching, traversal
from topomap.solver import solving
from topomap.solver.circumscription import circumscribed
from topomap.solver.enumeration import best_maps
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance

WALKS = ("#c2332d", "#2f7fc1", "#2e7d4f", "#e07b00", "#7a4fa3")
BLUE, ORANGE = "#2f7fc1", "#e07b00"
PLANAR, ANY = ("planar", BLUE, "s--"), ("any", ORANGE, "o-")


def figures(folder: Path, watch: Watch) -> dict[str, Callable[[], Figure]]:
    """Name each figure, with the function that makes it; ``folder`` has the instances."""

    def of(name: str) -> Experience:
        """Read an instance."""
        return read(folder / f"{name}.lp")

    return {
        "figure1": lambda: figure1(of("grid-3x3-snake"), watch),
        "figure3": lambda: figure3(watch),
        "figure4": lambda: growth(watch),
        "figure5": lambda: figure5(of("grid-4x4-snake"), watch),
        "equation1": lambda: equation1(of("grid-4x4-snake"), watch),
        "manhattan": lambda: manhattan(
            [of(f"manhattan-{name}") for name in ("tour20", "tour40-signs30", "tour88-signs30")],
            watch,
        ),
        "circumscription": lambda: circumscription(watch),
        "first": lambda: first(watch),
        "place": place,
    }


def all_scenes(
    experience: Experience, watch: Watch, *parts: str, places: int | None = None
) -> list[Scene]:
    """Find all maps with these properties, or the best of them, in order."""
    found = solving.hypotheses(experience, Query(frozenset(parts), places), watch)
    proved = sorted(one.at for one in found if one and one.proved)
    return [Scene(experience.map_of(at), at, "") for at in proved]


def best_scenes(experience: Experience, watch: Watch, *parts: str) -> list[Scene]:
    """Find the optimal maps, or those that are best so far.

    Raises:
        Stopped: The work was cut short.
    """
    found, fault = best_maps(experience, Query(frozenset(parts)), watch)
    if fault:
        raise Stopped(fault)
    return scenes.of_found(experience, "", found, True)


def titled(scene: Scene, caption: str) -> Scene:
    """Give a scene a caption."""
    return replace(scene, caption=caption)


def first(watch: Watch) -> Figure:
    """Draw the figure of the first page.

    It shows what a walk sees, place by place; two of the maps that are consistent with it; and the
    closed map, which is the real one.
    """
    made = instance(grid(2, 3), "EESWWNES")
    found = all_scenes(made.experience, watch)
    (real,) = [scene for scene in found if not scene.world.pending()]
    if tuple(real.at) != made.truth:
        raise ValueError("the closed map is not the real one")
    others = [scene for scene in found if scene is not real]
    others.sort(key=lambda scene: (len(scene.world.paths()), len(scene.world.stars)))
    captions = [
        *(f"consistent; {len(scene.world.pending())} gateways pending" for scene in others[:2]),
        "the only closed map: the real one",
    ]
    figure = sheet.picture(
        [
            titled(scene, f"({letter}) {caption}")
            for letter, scene, caption in zip("abc", [*others[:2], real], captions, strict=True)
        ]
    )
    # Room for the log, on the left of the maps.
    (wide, high), more = figure.get_size_inches(), 2.7
    boxes = [axes.get_position() for axes in figure.axes]
    figure.set_size_inches(wide + more, high)
    for axes, box in zip(figure.axes, boxes, strict=True):
        left = (box.x0 * wide + more) / (wide + more)
        axes.set_position((left, box.y0, box.width * wide / (wide + more), box.height))
    with mpl.rc_context(sheet.STYLE):
        log = figure.add_axes((0, boxes[0].y0, more / (wide + more), boxes[0].height))
        _log(log, made.experience)
        title = f"what was seen: {len(found)} maps explain it\narrows: where the agent turns"
        log.set_title(title, fontsize=panel.TITLE, color=panel.INK, pad=5)
    return figure


def _log(axes: Any, experience: Experience) -> None:
    """Draw what is seen after each step, and how the agent then leaves."""
    columns, wide, high = 3, 1.25, 1.12
    rows = -(-len(experience.views) // columns)
    for step, view in enumerate(experience.views):
        row, column = divmod(step, columns)
        centre = np.array([wide * column, -high * row])
        turn = experience.turns[step] if step < experience.steps else None
        _star(axes, centre, 0.36, experience.slots, view, turn, begins=step == 0)
        text = f"step {step}" if step else "start"
        x, y = centre
        axes.text(x, y - 0.55, text, fontsize=6, color=panel.STEP, ha="center")
    axes.set_xlim(-0.5 * wide, (columns - 0.5) * wide)
    axes.set_ylim(-(rows - 1) * high - 0.6, 0.6)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _star(
    axes: Any,
    centre: Points,
    length: float,
    slots: int,
    view: Collection[int],
    turn: int | None,
    begins: bool,
) -> list[Points]:
    """Draw a place as the agent sees it.

    It shows the gateways, the agent at its gateway, and an arrow through the gateway to which it
    turns. The gateway of the agent is below, because it is behind the agent after a travel, or
    above where an exploration begins.

    Returns:
        The directions of the slots, as vectors.
    """
    first = np.pi / 2 if begins else -np.pi / 2
    angles = [first - 2 * np.pi * slot / slots for slot in range(slots)]
    outs = [np.array([np.cos(angle), np.sin(angle)]).round(6) for angle in angles]
    for slot in sorted(view):
        line = np.array([centre, centre + length * outs[slot]])
        axes.plot(*line.T, color=panel.LINK, lw=2, solid_capstyle="butt", zorder=1)
    if turn is not None:
        line = np.array([centre + 0.5 * length * outs[turn], centre + 1.6 * length * outs[turn]])
        _arrow(axes, line, BLUE)
    size = 0.35 * length
    style = {"fc": "white", "ec": panel.INK, "lw": 1.2, "zorder": 4}
    axes.add_patch(Circle(tuple(centre), size, **style))
    ahead = outs[0] if begins else -outs[0]
    side = np.array([-ahead[1], ahead[0]])
    foot = centre + 0.75 * length * outs[0] - 0.2 * length * ahead
    points = [foot + 0.5 * length * ahead, foot + 0.25 * length * side, foot - 0.25 * length * side]
    axes.add_patch(Polygon(points, fc=panel.AGENT, ec="white", lw=0.6, zorder=7))
    return outs


def place() -> Figure:
    """Draw how the slots of a place are numbered, at the start and after a travel."""
    panels: list[tuple[str, set[int], int, str]] = [
        ("at the start you choose slot 0", {0, 1}, 0, "view(0,0). view(0,1).  turn(1,0)."),
        (
            "after a travel slot 0 is behind you",
            {0, 2, 3},
            3,
            "view(1,0). view(1,2). view(1,3).  turn(2,3).",
        ),
    ]
    with mpl.rc_context(sheet.STYLE):
        figure = _figure(5.6, 2.6)
        for number, (title, view, turn, facts) in enumerate(panels):
            axes = figure.add_axes((number / 2, 0, 0.5, 1))
            outs = _star(axes, np.zeros(2), 0.5, 4, view, turn, begins=number == 0)
            for slot, out in enumerate(outs):
                if slot not in view:
                    line = np.array([0.18 * out, 0.5 * out])
                    axes.plot(*line.T, ":", color="#9aa4ae", lw=1.2)
                far = 1.0 if slot == turn else 0.66
                x, y = far * out
                style: Any = {"fontsize": 10, "ha": "center", "va": "center"}
                axes.text(x, y, str(slot), color=panel.INK, **style)
            axes.text(0, 1.25, title, fontsize=8, color=panel.INK, ha="center")
            axes.text(0, -1.1, facts, fontsize=7, color=panel.STEP, ha="center")
            axes.set_xlim(-1.4, 1.4)
            axes.set_ylim(-1.2, 1.4)
            axes.set_aspect("equal")
            axes.set_axis_off()
    return figure


def figure1(experience: Experience, watch: Watch) -> Figure:
    """Draw the paper's Figure 1: the 3x3 grid, and the two maps that no exploration tells apart."""
    made = instance(grid(3, 3), "snake")
    real = Scene(experience.map_of(made.truth), (), "")
    planar, other = sorted(best_scenes(experience, watch), key=lambda scene: scene.world.genus())
    return sheet.picture(
        [
            titled(real, "(a) the environment"),
            titled(planar, "(b) an optimal map"),
            titled(other, "(c) the other one"),
        ]
    )


def figure3(watch: Watch) -> Figure:
    """Draw the paper's Figure 3: next(e1) = pred(rev(e1)), and the walks round three faces."""
    made = instance(grid(2, 3), "snake")
    (found,) = all_scenes(made.experience, watch, "planar", "closed", "perpendicular")
    scene = replace(found, at=())
    with mpl.rc_context(sheet.STYLE):
        figure = _figure(6.4, 2.6)
        left, right = figure.subplots(1, 2)
        laid = panel.draw(
            left, titled(scene, "(a) e2 = rev(e1), e3 = pred(e2) = next(e1)"), False, False
        )
        walk = next(face for face in laid.faces if len(face) > 3)
        out = walk[0]
        arrows = [
            ("e1", out, WALKS[0]),
            ("e2 = rev(e1)", scene.world.links[out], WALKS[1]),
            ("e3 = next(e1)", scene.world.next(out), WALKS[2]),
        ]
        for text, gateway, colour in arrows:
            line = _beside(laid.lines[gateway], 0.1)
            _arrow(left, line, colour)
            x, y = _beside(laid.lines[gateway], 0.24).mean(0)
            across = laid.lines[gateway][-1] - laid.lines[gateway][0]
            turn = 90 if abs(across[0]) < abs(across[1]) else 0
            style = {"fontsize": 7, "ha": "center", "va": "center", "rotation": turn}
            left.text(x, y, text, color=colour, **style)
        walks = f"(b) the walks round its {len(laid.faces)} faces"
        laid = panel.draw(right, titled(scene, walks), False, False)
        low = np.min(list(laid.places.values()), axis=0)
        for number, face in enumerate(laid.faces):
            colour = WALKS[number % len(WALKS)]
            for gateway in face:
                _arrow(right, _beside(laid.lines[gateway], 0.12), colour)
            is_outer = number == laid.outer
            x, y = low - [0, 0.28] if is_outer else panel.inside(laid.outline(face))
            name = f"{number + 1}{' (outer)' * is_outer}"
            right.text(x, y, name, color=colour, fontsize=9, ha="center", va="center")
        figure.subplots_adjust(0.01, 0.02, 0.99, 0.84, 0.05)
    return figure


def _beside(line: Points, aside: float) -> Points:
    """Shift a straight line to its right, and shorten it."""
    a, b = line[0], line[-1]
    ahead = (b - a) / np.linalg.norm(b - a)
    right = aside * np.array([ahead[1], -ahead[0]])
    short = 1.3 * RADIUS * ahead
    return np.array([a + short + right, b - short + right])


def _arrow(axes: Any, line: Points, colour: str) -> None:
    shape = {"arrowstyle": "-|>", "color": colour, "lw": 1.3, "mutation_scale": 9}
    axes.annotate("", xy=tuple(line[1]), xytext=tuple(line[0]), arrowprops=shape)


def growth(watch: Watch) -> Figure:
    """Draw, for the paper's Figure 4, how the tree grows step by step."""
    rows = [(column, figure4.row(column, watch)["per_step"]) for column in figure4.COLUMNS]
    with mpl.rc_context(sheet.STYLE):
        figure = _figure(9, 3.2)
        names = list(dict.fromkeys(column["environment"] for column, _ in rows))
        for name, axes in zip(names, figure.subplots(1, len(names)), strict=True):
            for column, per_step in rows:
                if column["environment"] == name:
                    places = column["places"]
                    label, colour, line = PLANAR if column["planarity"] else ANY
                    axes.semilogy(per_step, line, color=colour, label=label, lw=1.2, ms=2.5)
            axes.set_title(f"{name}, at most {places} places" if places else name, fontsize=9)
            axes.set_xlabel("step", fontsize=8)
            # matplotlib would write powers as formulas, which STYLE does not read.
            axes.yaxis.set_major_formatter("{x:,.0f}")
            axes.yaxis.set_minor_formatter(NullFormatter())
            axes.xaxis.set_major_locator(MaxNLocator(integer=True))
            _plain(axes)
        figure.axes[0].set_ylabel("maps consistent so far", fontsize=8)
        figure.axes[0].legend(fontsize=8, frameon=False)
        figure.tight_layout()
    return figure


def equation1(experience: Experience, watch: Watch) -> Figure:
    """Draw equation (1): which share of the children of each branching node is planar."""
    node = traversal.root(experience, Query(frozenset(["planar"]), 16))
    nodes = list(branching.branching(node, watch))
    panels: list[tuple[str, list[tuple[Fraction | None, Fraction]]]] = [
        (
            "worst case: every pending gateway fits",
            [(n.worst.predicted, n.worst.measured) for n in nodes],
        ),
        (
            "as seen: those that fit (footnote 2)",
            [(n.seen.predicted, n.seen.measured) for n in nodes],
        ),
    ]
    with mpl.rc_context(sheet.STYLE):
        figure = _figure(8, 4)
        for axes, (title, pairs) in zip(figure.subplots(1, 2), panels, strict=True):
            known = [(float(p), float(m)) for p, m in pairs if p is not None]
            points, number = np.unique(np.round(known, 6), axis=0, return_counts=True)
            axes.plot([0, 1], [0, 1], color="#9aa4ae", lw=0.8, zorder=1)
            axes.scatter(*points.T, s=4 + 2.2 * number**0.5, color=BLUE, alpha=0.55, lw=0, zorder=2)
            equal = sum(p == m for p, m in pairs)
            axes.set_title(f"{title}\nequal at {equal:,} of {len(known):,} nodes", fontsize=8)
            axes.set_xlabel("predicted bp/b, by equation (1)", fontsize=8)
            axes.set_aspect("equal")
            _plain(axes)
        figure.axes[0].set_ylabel("measured bp/b", fontsize=8)
        figure.tight_layout()
    return figure


def figure5(experience: Experience, watch: Watch) -> Figure:
    """Draw the paper's Figure 5.

    It has the real 4x4 map, one of the 255 others that are closed and perpendicular, and the two
    optimal ones.
    """
    square = all_scenes(experience, watch, "closed", "perpendicular", places=16)
    (real,) = [scene for scene in square if scene.world.genus() == 0]
    others = [scene for scene in square if scene.world.genus() > 0]
    optimal = best_scenes(experience, watch)

    def is_told(scene: Scene) -> bool:
        """Tell whether some walk can tell the map from the real one."""
        return not scene.world.indistinguishable(scene.at[-1], real.world, real.at[-1])

    told, never = sorted(optimal, key=is_told, reverse=True)
    return sheet.picture(
        [
            titled(real, "(a) the real map"),
            titled(others[0], f"(b) one of {len(others)} others, closed, perpendicular"),
            titled(told, f"(c) optimal; {_told(is_told(told))} by going on"),
            titled(never, f"(d) optimal; {_told(is_told(never))} by going on"),
        ],
        columns=2,
    )


def circumscription(watch: Watch) -> Figure:
    """Draw a walk of four steps with two circumscribed maps, one of which is smaller."""
    fork = frozenset([0, 2, 4])
    experience = Experience(6, (fork,) * 5, (4, 2, 2, 2))
    found = [*circumscribed(experience, Query(), watch)]
    (least,) = all_scenes(experience, watch, "boundary", "minimal")
    found.sort(key=lambda one: one.at != least.at)
    captions = "(a) circumscribed, and best by number", "(b) circumscribed"
    return sheet.picture(
        [
            titled(Scene(experience.map_of(one.at), one.at, ""), caption)
            for one, caption in zip(found, captions, strict=True)
        ]
    )


def _told(is_told: bool) -> str:
    return "told from (a)" if is_told else "never told from (a)"


def manhattan(tours: list[Experience], watch: Watch) -> Figure:
    """Draw a piece of Manhattan: the hypotheses after 20 and 40 steps, and the real map."""
    (whole,) = all_scenes(tours[-1], watch, "closed", "planar", "perpendicular")
    real = titled(whole, f"the real map, a tour of {tours[-1].steps} steps")
    panels: list[Scene] = []
    for tour, parts in zip(tours[:-1], ((), ("planar",)), strict=True):
        found = best_scenes(tour, watch, *parts)
        at = whole.at[: tour.steps + 1]
        truth = Scene(tours[-1].cut(tour.steps).map_of(tuple(at)), at, "")
        which = f"one of {len(found)} best{' planar ones' * bool(parts)} so far"
        panels.append(titled(found[0], f"after {tour.steps} steps: {which}"))
        panels.append(titled(truth, f"after {tour.steps} steps: the truth"))
    return sheet.picture([*panels[:2], real, *panels[2:]], columns=3)


def _figure(width: float, height: float) -> Figure:
    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure


def _plain(axes: Any) -> None:
    axes.tick_params(labelsize=7)
    axes.grid(color="#e3e7ea", lw=0.5)
    axes.spines[["top", "right"]].set_visible(False)
