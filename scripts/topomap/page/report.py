"""The page about explorations, in one file that loads no other file."""

import base64
import hashlib
import platform
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import clingo

from topomap.documents.verdicts import axioms_of
from topomap.drawing import svg
from topomap.drawing.agreement import Agreement
from topomap.drawing.scenes import Scene
from topomap.drawing.shapes import Drawing
from topomap.model import words
from topomap.model.exceptions import exceptions_of
from topomap.model.experience import Experience
from topomap.model.found import Cube
from topomap.model.query import Query
from topomap.model.topology import gid
from topomap.model.vocabulary import CHOSEN, PARTS
from topomap.page.chapter import Chapter
from topomap.page.replay import MOST, SHOWN, fate, in_force
from topomap.runtime.errors import printable
from topomap.runtime.version import VERSION
from topomap.search.evidence import RULES as KNOWN
from topomap.search.evidence import Evidence

ENDERS = ("view", "landmark", "marker", *KNOWN, "bound")  # the rules that can end a hypothesis
FOLDER = Path(__file__).parent
LARGER = 1.7  # the scale of the picture of a best map, if there is room
ROOM = 2_000_000  # letters: about so many for the small pictures of one exploration


@dataclass(frozen=True)
class Asked:
    """What a page was asked for.

    It has the instances, the parts and limits of their maps, the largest number of the best maps to
    draw, the number of seconds, and the file of the maps that are shown instead, if there is one;
    and what is ``known`` besides the instances, as options. The page shows all this as options of
    the command.
    """

    instances: Sequence[str]
    query: Query
    most: int
    timeout: float
    maps_from: str | None = None
    known: Sequence[str] = ()

    def options(self, without: str = "") -> list[str]:
        """The parts and limits as options."""
        asked = self.query.parts - {without}
        flags = [f"--{part.replace('_', '-')}" for part in CHOSEN if part in asked]
        for name, value in (("bound", self.query.places), ("horizon", self.query.horizon)):
            flags += [] if value is None else [f"--{name}", str(value)]
        return [*flags, *self.known]

    def call(self) -> str:
        """The call that makes the page."""
        limits = ["--maps", str(self.most), "--timeout", f"{self.timeout:g}"]
        limits += [] if self.maps_from is None else ["--maps-from", self.maps_from]
        named = [*self.instances, *self.options(), *limits, "-o", "report.html"]
        return shlex.join(["topomap", "report", *named])


def page(asked: Asked, made: Sequence[Chapter]) -> str:
    """Write the page about explorations that were examined."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(FOLDER, encoding="utf-8"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    style, script = ((FOLDER / f"page.{kind}").read_text("utf-8") for kind in ("css", "js"))
    policy = {
        "default-src": "'none'",
        "style-src": _hash(style),
        "script-src": _hash(script),
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    content = environment.get_template("page.html").render(
        style=style,
        script=script,
        policy="; ".join(f"{key} {value}" for key, value in policy.items()),
        many=len(made),
        explorations=[_about(asked, number, about) for number, about in enumerate(made, 1)],
        call=asked.call(),
        versions={
            "topomap": VERSION,
            "clingo": clingo.__version__,
            "Python": platform.python_version(),
            **{name: version(name) for name in ("networkx", "numpy", "scipy")},
        },
        most=MOST,
        shown=SHOWN,
    )
    return content


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _about(asked: Asked, number: int, about: Chapter) -> dict[str, Any]:
    """Collect what the template tells of an exploration."""
    from markupsafe import Markup

    seen, last = about.seen, about.seen.steps
    glyphs = Glyphs(f"i{number}-")
    log = [_log_line(seen, step) for step in range(last + 1)]
    room = ROOM
    steps = []
    for step, found in reversed(
        list(enumerate(about.steps))
    ):  # those of the best maps are drawn first
        shown: list[dict[str, Any]] = []
        for at in found.shown:
            if at in about.shapes and room > 0:
                shown.append(_shown(about, at, len(shown) + 1, glyphs))
                room -= shown[-1]["letters"]
        alive = about.alive(step)
        more = None if alive is None else alive - len(shown)
        steps.append({"alive": alive, "shown": shown, "more": more, **log[step]})
    steps.reverse()
    rules = in_force(about.query, seen)
    stem = printable(Path(about.name).stem)
    name = f"Hypotheses after each step of {stem}, on a logarithmic scale"
    agreed = Agreement([scene.at for scene in about.best], seen)
    drawn = [
        _map(seen, scene, about.shapes.get(tuple(scene.at)), agreed)
        for scene in about.best[: asked.most]
    ]
    file = about.name
    solve = shlex.join(["topomap", "solve", file, "--optimal", *asked.options()])
    solved = [] if about.given else [solve]
    return {
        "id": f"i{number}",
        "name": file,
        "last": last,
        "slots": seen.slots,
        "signs": len(frozenset().union(*seen.landmarks)),
        "marked": bool(seen.drops),
        "known": bool(Evidence(seen)),
        "faults": about.faults,
        "asked": [PARTS[part] for part in sorted(about.query.parts)]
        + ([f"at most {words.number(about.query.places, 'place')}"] if about.query.places else []),
        "log": log,
        "steps": steps,
        "defs": Markup(glyphs.shared()),
        "plot": Markup(svg.plot(name, about.counts)),
        "counts": list(zip(*about.counts.values(), strict=True)),
        "checked": sum(
            found.alive is not None and counted is not None
            for found, counted in zip(about.steps, about.counted, strict=True)
        ),
        "rules": {rule: words.RULES[rule] for rule in rules},
        "enders": [rule for rule in rules if rule in ENDERS],
        "refused": [
            (step, about.steps[step - 1].alive, about.steps[step]) for step in range(1, last + 1)
        ],
        "maps": drawn,
        "dead": next((step for step in range(1, last + 1) if about.steps[step].alive == 0), None),
        "found": len(about.best),
        "kind": about.best[0].kind if about.best else "",
        "whole": about.whole,
        "given": about.given,
        "which": f"the maps{' given' if about.given else ' found' * (not about.whole)}",
        "agreed": agreed,
        "commands": [
            shlex.join(["topomap", "count", file, *asked.options("planar")]),
            shlex.join(["topomap", "count", file, "--planar", *asked.options("planar")]),
            *solved,
        ],
    }


def _log_line(seen: Experience, step: int) -> dict[str, Any]:
    from markupsafe import Markup

    view = words.view(seen, step)
    ways = seen.views[step]
    drawn = len(ways) <= words.MOST
    return {
        "step": step,
        "turn": words.turn(seen, step),
        "view": view,
        "glyph": Markup(svg.view(view, seen.slots, ways)) if drawn else "",
        "landmarks": ", ".join(sorted(seen.landmarks[step])),
        "marker": words.marker(seen, step),
        "known": words.known(seen, step),
    }


class Glyphs:
    """Drawings by their content: a drawing that occurs several times is written once."""

    def __init__(self, prefix: str):
        self.prefix = prefix
        self.names: dict[str, str] = {}

    def use(self, body: str) -> str:
        """Refer to a drawing, which is written once."""
        name = self.names.setdefault(body, f"{self.prefix}m{len(self.names) + 1}")
        return f'<use href="#{name}"/>'

    def shared(self) -> str:
        """The drawings that are referred to."""
        return "".join(f'<g id="{name}">{body}</g>' for body, name in self.names.items())


def _shown(about: Chapter, at: Cube, number: int, glyphs: Glyphs) -> dict[str, Any]:
    """Describe a hypothesis of a step."""
    from markupsafe import Markup

    seen, drawn, step = about.seen, about.shapes[at], len(at) - 1
    rests = seen.starts | seen.looks
    scene = Scene(seen.map_of(at), at, about.name, rests=rests)
    known = len(glyphs.names)
    body = svg.body(scene, drawn)
    content = _last(drawn, at) + glyphs.use(body) + svg.agent(drawn, at[-1])
    place, slot = at[-1]
    name = (
        f"After step {step}, hypothesis {number}: {_sizes(scene)}, "
        f"the agent at place {place}, gateway {slot}"
    )
    picture = svg.picture(name, drawn.frame, content)
    children, rule, refused = fate(seen, about.query, at)
    if step == seen.steps:
        next = "a map of the whole exploration"
    elif children:
        next = "goes on" if children == 1 else f"goes on in {children} ways"
    else:
        next = f"ends at the next step: {words.RULES[rule]}"
    begun = [n for n, best in enumerate(about.best, 1) if best.at[: step + 1] == at]
    return {
        "picture": Markup(picture),
        "letters": len(picture) + len(body) * (len(glyphs.names) > known),
        "sizes": _sizes(scene) + _note(drawn),
        "at": f"at place {place}, gateway {slot}",
        "next": next,
        "refused": words.refused(refused, step + 1),
        "ends": not children and step < seen.steps,
        "begun": f"{'map' if len(begun) == 1 else 'maps'} {words.listed(begun, 4)}"
        if begun
        else "",
    }


def _last(drawn: Drawing, at: Cube) -> str:
    """Draw the link of the last step, which lies under the map."""
    if len(at) == 1:
        return ""
    return f'<path class="last" d="{svg.path(drawn.lines[at[-1]])}"/>'


def _sizes(scene: Scene) -> str:
    return scene.title.splitlines()[1]


def _note(drawn: Drawing | None) -> str:
    return f", {drawn.note}" if drawn and drawn.note else ""


def _map(
    seen: Experience, scene: Scene, drawn: Drawing | None, agreed: Agreement
) -> dict[str, Any]:
    """Describe one of the best maps."""
    from markupsafe import Markup

    world, number = scene.world, scene.number
    steps = scene.steps()
    strange = agreed.strange(number - 1)
    links = []
    for out, end in world.edges():
        along = sorted(steps.get(out, []) + steps.get(end, []))
        links.append((out, end, along, agreed.having(out, end)))
    apart = [(out, end) for out, end, _, having in links if having < scene.many]
    apart += [(end, out) for out, end in apart]
    found = " found" * (not scene.whole)
    name = f"Map {number} of {scene.many}{found}{f', {scene.kind}' * bool(scene.kind)}: "
    name += _sizes(scene)
    name += f", the agent at place {scene.at[-1][0]}, gateway {scene.at[-1][1]}"
    picture = ""
    if drawn:
        content = svg.body(scene, drawn, False, apart, strange) + svg.agent(drawn, scene.at[-1])
        picture = svg.picture(name, drawn.frame, content, "map large", LARGER)
    paths = [
        ", ".join(map(gid, path)) if len(path) > 1 else f"{gid(path[0])} (untravelled)"
        for path in world.paths()
    ]
    return {
        "number": number,
        "picture": Markup(picture),
        "sizes": _sizes(scene) + _note(drawn),
        "axioms": axioms_of(seen, scene.at).words,
        "exceptions": [one.words for one in exceptions_of(seen, scene.at)],
        "numbered": bool(drawn and drawn.faces),
        "links": [
            (gid(out), gid(end), words.listed(along), having) for out, end, along, having in links
        ],
        "apart": len(apart) // 2,
        "places": [
            (
                place,
                words.listed(agreed.visits[number - 1][place]),
                ", ".join(map(str, sorted(star))),
                ", ".join(str(slot) for slot in sorted(star) if (place, slot) not in world.links),
                ", ".join(sorted(world.landmarks.get(place, ()))),
                place in strange,
            )
            for place, star in world.stars.items()
        ],
        "paths": paths,
        "faces": [", ".join(map(gid, face)) for face in world.faces()],
    }
