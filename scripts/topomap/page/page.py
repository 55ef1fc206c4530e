"""``topomap report``: a page about explorations, in one file that loads nothing else."""

import argparse
import base64
import hashlib
import platform
import shlex
import time
from collections.abc import Iterator
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import clingo

from topomap import __version__
from topomap.documents import maps
from topomap.drawing import scenes, svg
from topomap.drawing.agreement import Agreement
from topomap.drawing.scenes import MOST_PLACES, Scene
from topomap.drawing.svg import Drawing, part_of
from topomap.exploring import hypothesis
from topomap.model import experience, words
from topomap.model.experience import Experience
from topomap.model.found import Cube
from topomap.model.query import Query
from topomap.model.topology import gid
from topomap.model.vocabulary import PARTS, PRUNING
from topomap.page.replay import MOST, SHOWN, Step, fate, in_force, replay
from topomap.pictures import ready
from topomap.runtime.errors import InputError, printable, say
from topomap.runtime.extras import need
from topomap.runtime.files import output
from topomap.runtime.limits import LARGEST
from topomap.runtime.status import INTERRUPT, exit_status
from topomap.runtime.watch import Attempt, Watch, heeding
from topomap.solver import solving

FOLDER = Path(__file__).parent
SMALL = 100  # places in a small picture, at most
LARGER = 1.7  # than its units are the picture of a best map, where there is room
ROOM = 2_000_000  # letters that small pictures of one exploration take, about


def report(args: argparse.Namespace) -> int:
    """Write the page about the instances."""
    need("draw", "topomap report")
    seen = [(path, experience.read(path)) for path in args.instance]
    if len({path for path, _ in seen}) < len(seen):
        raise InputError("topomap report: an instance is named twice")
    parts = frozenset(part for part in PRUNING if getattr(args, part))
    query = Query(parts, args.bound, args.horizon)
    given = None if args.maps_from is None else _given(args, seen, query)
    with output(args.output) as out, heeding(args.timeout) as watch:
        end = time.monotonic() + args.timeout
        made = []
        for number, (path, one) in enumerate(seen):
            share = (end - time.monotonic()) / (len(seen) - number)
            cut = one.cut(LARGEST if query.horizon is None else query.horizon)
            about = Exploration(path, cut, replace(query, horizon=None), args.maps, watch, given)
            about.look(max(0.0, share))
            made.append(about)
        out.write(_page(args, made))
    for about in made:
        for fault in about.faults:
            say(f"{about.name}: partial: {fault}")
    faults = [fault for about in made for fault in about.faults]
    fault = INTERRUPT if any(fault.endswith(INTERRUPT) for fault in faults) else "".join(faults)
    return exit_status(fault, all(about.best for about in made))


def _given(
    args: argparse.Namespace, seen: list[tuple[str, Experience]], query: Query
) -> list[Scene]:
    """The maps of a file, for the page to tell of. Raises InputError, one line, where they are
    none of the hypotheses that it counts."""
    if len(seen) > 1:
        raise InputError("topomap report: --maps-from goes with one instance")
    ((path, whole),) = seen
    cut = whole.cut(LARGEST if query.horizon is None else query.horizon)
    demands = sorted(query.parts)
    demands += [] if query.places is None else [f"bound({query.places})"]
    documents = maps.of_instance(maps.read(args.maps_from), path)
    made: list[Scene] = []
    for document in documents:
        many = len(document.best)
        for number, (place, entry) in enumerate(document.best, 1):
            where = f"{document.where}: map {place}"
            if entry.get("misread"):
                raise InputError(f"{where}: it disbelieves what was seen; the page is of all of it")
            at = hypothesis(where, entry["at"], whole, cut, demands)
            rest = path, number, many, document.kind
            made.append(Scene(cut.map_of(at), at, *rest, whole=document.whole))
    if len({scene.at for scene in made}) < len(made):
        raise InputError(f"{args.maps_from}: a map is there twice")
    if not made:
        raise InputError(f"{args.maps_from}: no maps of {path} in it")
    return made


class Exploration:
    """What the page tells of an exploration: of its best maps, or of those that are ``given``;
    ``faults`` are what it lacks, and why; ``whole`` tells whether the maps are all of their
    kind."""

    def __init__(
        self,
        name: str,
        seen: Experience,
        query: Query,
        most: int,
        watch: Watch,
        given: list[Scene] | None = None,
    ):
        self.name, self.seen, self.query, self.watch = name, seen, query, watch
        self.most = most  # maps to be drawn
        self.faults: list[str] = []
        self.given = given is not None
        self.best: list[Scene] = given or []
        self.whole = all(scene.whole for scene in self.best)
        self.steps: list[Step] = []
        self.shapes: dict[Cube, Drawing] = {}  # small ones, but for the best maps
        self.counts: dict[str, list[int | None]] = {
            which: [None] * (seen.steps + 1) for which in ("without planarity", "with planarity")
        }

    def look(self, seconds: float) -> None:
        """Find out what can be found in that time: no part of the work takes it all."""
        now = time.monotonic()
        self.watch.deadline.at = now + seconds / 3
        if not self.given:
            self.best, fault = scenes.best(self.seen, self.name, self.query, self.watch)
            self.whole = not fault
            if fault:
                self.faults.append(f"the best maps: {fault}")
        self.watch.deadline.at = now + seconds / 2
        ats = [tuple(scene.at) for scene in self.best]
        self.steps, fault = replay(self.seen, self.query, ats, self.watch)
        if fault:
            self.faults.append(f"what was refused: {fault}")
        self.watch.deadline.at = now + seconds * 2 / 3
        self._until("pictures", self._draw())
        self.watch.deadline.at = now + seconds
        self._until("counts by clingo", self._count())
        self.watch.title("")

    def _until(self, what: str, work: Iterator[None]) -> None:
        with Attempt() as attempt:
            self.watch.tick()
            for _ in work:
                self.watch.tick()
        if attempt.fault:
            self.faults.append(f"{what}: {attempt.fault}")

    def _count(self) -> Iterator[None]:
        """Count the hypotheses after each step, by clingo."""
        found = self.watch.found
        parts = [self.query.parts - {"planar"}, self.query.parts | {"planar"}]
        queries = [replace(self.query, parts=some) for some in parts]
        for step in range(self.seen.steps + 1):
            self.watch.title(f"counts after step {step} of {self.seen.steps}")
            for query, numbers in zip(queries, self.counts.values(), strict=True):
                asked = replace(query, horizon=step)
                numbers[step], _ = solving.count(self.seen, asked, (), self.watch, grown=False)
                self.watch.found = found
                yield
            self._agree(step)

    @property
    def counted(self) -> list[int | None]:
        """The hypotheses after each step that the replay is about, by clingo."""
        return self.counts[f"with{'' if 'planar' in self.query.parts else 'out'} planarity"]

    def _agree(self, step: int) -> None:
        ours, theirs = self.steps[step].alive, self.counted[step]
        if ours is not None and ours != theirs:
            raise RuntimeError(f"{self.name}: step {step}: the search has {ours}, clingo {theirs}")

    def alive(self, step: int) -> int | None:
        """How many hypotheses there are after a step, if it is known."""
        by_clingo = self.counted[step]
        return self.steps[step].alive if by_clingo is None else by_clingo

    def _keep(self, at: Cube, drawn: Drawing | None) -> None:
        if drawn:
            self.shapes[at] = drawn

    def _draw(self) -> Iterator[None]:
        """Drawings of the best maps, and small ones: of the first of each, then of the others."""
        ready()
        yield from self._draw_best(self.best[: min(1, self.most)])
        yield from self._draw_shown(0)
        yield from self._draw_best(self.best[1 : self.most])
        for rank in range(1, SHOWN):
            yield from self._draw_shown(rank)

    def _draw_best(self, some: list[Scene]) -> Iterator[None]:
        for scene in some:
            self.watch.title(f"picture of map {scene.number}")
            if len(scene.world.stars) <= MOST_PLACES:
                self._keep(tuple(scene.at), svg.drawing(scene.world, scene.ahead))
                yield

    def _draw_shown(self, rank: int) -> Iterator[None]:
        """Of each step one, from the last step back: that of a map which grows to another one
        that is shown is a part of the other's."""
        last = self.seen.steps
        for number in range(last, -1, -1):
            self.watch.title(f"pictures of step {number} of {last}")
            for at in self.steps[number].shown[rank : rank + 1]:
                world = self.seen.map_of(at)
                if at in self.shapes or len(world.stars) > SMALL:
                    continue
                later = self.steps[number + 1].shown if number < last else []
                grown = (self.shapes.get(more) for more in later if more[: number + 1] == at)
                parts = (part_of(whole, world) for whole in grown if whole)
                drawn = next((part for part in parts if part), None)
                if drawn is None:
                    drawn = svg.drawing(world, Scene(world, at, self.name).ahead, small=True)
                self._keep(at, drawn)
                yield


def _page(args: argparse.Namespace, made: list[Exploration]) -> str:
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
        explorations=[_about(args, number, about) for number, about in enumerate(made, 1)],
        call=_call(args),
        versions={
            "topomap": __version__,
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


def _options(args: argparse.Namespace, without: str = "") -> list[str]:
    flags = [f"--{part}" for part in PRUNING if getattr(args, part) and part != without]
    for name in ("bound", "horizon"):
        value = getattr(args, name)
        flags += [] if value is None else [f"--{name}", str(value)]
    return flags


def _call(args: argparse.Namespace) -> str:
    limits = ["--maps", str(args.maps), "--timeout", f"{args.timeout:g}"]
    if args.maps_from is not None:
        limits += ["--maps-from", args.maps_from]
    call = ["topomap", "report", *args.instance, *_options(args), *limits, "-o", "report.html"]
    return shlex.join(call)


def _about(args: argparse.Namespace, number: int, about: Exploration) -> dict[str, Any]:
    """What the template tells of an exploration."""
    from markupsafe import Markup

    seen, last = about.seen, about.seen.steps
    glyphs = Glyphs(f"i{number}-")
    log = [_log_line(seen, step) for step in range(last + 1)]
    room = ROOM
    steps = []
    for step, found in reversed(list(enumerate(about.steps))):  # the best maps' are drawn first
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
        _map(scene, about.shapes.get(tuple(scene.at)), agreed) for scene in about.best[: args.maps]
    ]
    file = about.name
    solve = shlex.join(["topomap", "solve", file, "--optimal", *_options(args)])
    solved = [] if about.given else [solve]
    return {
        "id": f"i{number}",
        "name": file,
        "last": last,
        "slots": seen.slots,
        "signs": len(frozenset().union(*seen.landmarks)),
        "marked": bool(seen.drops),
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
        "enders": [rule for rule in rules if rule in ("view", "landmark", "marker", "bound")],
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
            shlex.join(["topomap", "count", file, *_options(args, "planar")]),
            shlex.join(["topomap", "count", file, "--planar", *_options(args, "planar")]),
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
    }


class Glyphs:
    """Drawings by what they are: those that come again are written once."""

    def __init__(self, prefix: str):
        self.prefix = prefix
        self.names: dict[str, str] = {}

    def use(self, body: str) -> str:
        """What shows a drawing."""
        name = self.names.setdefault(body, f"{self.prefix}m{len(self.names) + 1}")
        return f'<use href="#{name}"/>'

    def shared(self) -> str:
        """The drawings."""
        return "".join(f'<g id="{name}">{body}</g>' for body, name in self.names.items())


def _shown(about: Exploration, at: Cube, number: int, glyphs: Glyphs) -> dict[str, Any]:
    """A hypothesis of a step."""
    from markupsafe import Markup

    seen, drawn, step = about.seen, about.shapes[at], len(at) - 1
    scene = Scene(seen.map_of(at), at, about.name)
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
        "sizes": _sizes(scene),
        "at": f"at place {place}, gateway {slot}",
        "next": next,
        "refused": words.refused(refused, step + 1),
        "ends": not children and step < seen.steps,
        "begun": f"{'map' if len(begun) == 1 else 'maps'} {words.listed(begun, 4)}"
        if begun
        else "",
    }


def _last(drawn: Drawing, at: Cube) -> str:
    """The link of the last step, to lie under the map."""
    if len(at) == 1:
        return ""
    return f'<path class="last" d="{svg.path(drawn.lines[at[-1]])}"/>'


def _sizes(scene: Scene) -> str:
    return scene.title.splitlines()[1]


def _map(scene: Scene, drawn: Drawing | None, agreed: Agreement) -> dict[str, Any]:
    """One of the best maps."""
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
        "sizes": _sizes(scene),
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
