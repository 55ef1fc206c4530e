"""The answers of ``solve``: maps as JSON, or as lines to read."""

import json
from collections.abc import Iterable, Sequence
from typing import IO, Any

from topomap.model import words
from topomap.model.compact import CompactMap, Numbering
from topomap.model.exceptions import exceptions_of
from topomap.model.experience import DState, Experience, Misread
from topomap.model.found import BEST, UNPROVED, Found, steps_json
from topomap.model.query import Query
from topomap.model.topology import Gateway, TopologicalMap
from topomap.runtime import formats
from topomap.solver import defaults


def map_json(world: TopologicalMap, at: Sequence[Gateway]) -> dict[str, Any]:
    """Convert a hypothesis to JSON, from its map and the dstate after each step.

    A gateway or a dstate is ``[place, slot]``; a link is its two gateways; a path is its dstates in
    order, with the slot of its heading; a face is the gateways by which its walk leaves (the
    paper's next); ``dstate`` is where the agent is.
    """
    return {
        "at": steps_json(at),
        "places": [
            {"place": place, "gateways": sorted(star), "landmarks": sorted(world.landmarks[place])}
            for place, star in world.stars.items()
        ],
        "links": world.edges(),
        "paths": world.headings(),
        "faces": world.faces(),
        "genus": world.genus(),
        "pending": world.pending(),
        "dstate": at[-1],
    }


def misread_json(experience: Experience, misread: Sequence[Misread]) -> list[dict[str, Any]]:
    """Convert what was misread to JSON.

    Each entry has the step, the gateway or the landmark, and whether it was seen (and so is
    imagined) or was missed.
    """
    return [
        {"step": step, "gateway": what, "seen": what in experience.views[step]}
        if isinstance(what, int)
        else {"step": step, "landmark": what, "seen": what in experience.landmarks[step]}
        for step, what in misread
    ]


def map_line(experience: Experience, found: Found) -> str:
    """Write a hypothesis in one line: what it contradicts, its size, and its dstates.

    ``experience`` is the corrected one.
    """
    if not found.misread:
        return Texts(experience, path_axiom=False).line(found)
    world = experience.map_of(found.at)
    size = (
        len(world.stars),
        len(world.links) // 2,
        len(world.paths()),
        world.genus(),
        len(world.pending()),
    )
    way = " ".join(f"{place}.{slot}" for place, slot in found.at)
    return words.contradicted(experience, found.misread) + line_of(size, way)


def line_of(size: tuple[int, int, int, int, int], way: str) -> str:
    """Write the line of a map of this size; ``way`` has the dstates.

    The size has the numbers of places, links and paths, the genus, and the number of pending
    gateways.
    """
    places, links, paths, genus, pending = size
    return f"places {places}, links {links}, paths {paths}, genus {genus}, pending {pending}: {way}"


class Texts:
    """The maps of one experience as texts, with or without the path axiom.

    What is the same in many of them is made once.
    """

    def __init__(self, experience: Experience, path_axiom: bool = True):
        self._experience = experience
        self._numbering = Numbering(experience, path_axiom)
        self._names: dict[DState, str] = {}  # dstates as the line of a map names them
        slots = experience.slots
        self._gateways = [  # as JSON, by number
            f"[{number // slots}, {number % slots}]"
            for number in range(slots * len(experience.views))
        ]
        self._places = [
            json.dumps({"place": place, "gateways": sorted(view), "landmarks": sorted(landmarks)})
            for place, (view, landmarks) in enumerate(
                zip(experience.views, experience.landmarks, strict=True)
            )
        ]

    def line(self, found: Found) -> str:
        """Write a hypothesis that contradicts no view in one line: its size, and its dstates."""
        one = CompactMap(self._numbering, found.at)
        names = self._names
        try:
            way = " ".join([names[dstate] for dstate in found.at])
        except KeyError:
            for place, slot in found.at:
                names[place, slot] = f"{place}.{slot}"
            way = " ".join([names[dstate] for dstate in found.at])
        size = (
            len(one.places),
            len(one.link) // 2,
            one.number_of_paths(),
            one.genus(),
            one.number_of_pending(),
        )
        return line_of(size, way)

    def document(self, at: Sequence[DState]) -> str:
        """Write a hypothesis as JSON text, the same as ``map_json``."""
        one = CompactMap(self._numbering, at)
        texts, slots = self._gateways, self._experience.slots
        bearing = self._numbering.bearing
        link, faces = one.link, one.faces()

        def listed(gateways: Iterable[int]) -> str:
            """List gateways as JSON text."""
            return f"[{', '.join([texts[gateway] for gateway in gateways])}]"

        steps = [f"[{step}, {place}, {slot}]" for step, (place, slot) in enumerate(at)]
        links = [f"[{texts[a]}, {texts[link[a]]}]" for a in sorted(link) if a < link[a]]
        pending = [gateway for gateway in one.gateways() if gateway not in link]
        place, slot = at[-1]
        return (
            f'{{"at": [{", ".join(steps)}], '
            f'"places": [{", ".join([self._places[place] for place in one.places])}], '
            f'"links": [{", ".join(links)}], '
            f'"paths": [{", ".join([listed(map(bearing, path)) for path in one.paths()])}], '
            f'"faces": [{", ".join(map(listed, faces))}], '
            f'"genus": {one.genus(len(faces))}, '
            f'"pending": {listed(pending)}, '
            f'"dstate": {texts[place * slots + slot]}}}'
        )


class Report:
    """The answer for one instance, which is written while maps are found."""

    def __init__(
        self,
        out: IO[str],
        instance: str,
        experience: Experience,
        query: Query,
        kind: str | None,
        truth: TopologicalMap | None,
        as_json: bool,
    ):
        self.out, self.as_json = out, as_json
        self.experience, self.truth = experience, truth
        self._texts = Texts(experience, "no_path_axiom" not in query.parts)
        self.count = self.real = 0
        self.noisy = query.noise is not None
        self.last = Found((), kind or query.kind)
        if as_json:
            head = {
                "instance": instance,
                "slots": experience.slots,
                "parts": sorted(query.parts),
                "bound": query.places,
                "horizon": query.horizon,
                "optimal": kind == "optimal",
            }
            if kind == "circumscribed":
                head["circumscribe"] = True
            if query.noise is not None:
                head["noise"] = query.noise
            if experience.parted:
                head["rests"] = sorted(experience.starts | experience.looks)
            out.write(json.dumps(formats.headed(head))[:-1] + ', "maps": [')

    def add(self, found: Found) -> None:
        """Write one map."""
        self.count += 1
        self.last = found
        corrected = self.experience.corrected(found.misread) if found.misread else self.experience
        real = False
        if self.truth:
            real = corrected.map_of(found.at).isomorphic(self.truth)
            self.real += real
        # They are written if they are minimised; for a million maps this would take long.
        exceptions = exceptions_of(corrected, found.at) if found.kind in BEST else []
        if self.as_json:
            more: dict[str, Any] = {}
            if found.kind in BEST:
                more["exceptions"] = [one.document() for one in exceptions]
            if self.noisy:
                more["misread"] = misread_json(self.experience, found.misread)
            if self.truth:
                more["real"] = real
            if found.misread:
                document = json.dumps(map_json(corrected.map_of(found.at), found.at))
            else:
                document = self._texts.document(found.at)
            if more:
                document = f"{document[:-1]}, {json.dumps(more)[1:]}"
            self.out.write((",\n" if self.count > 1 else "\n") + document)
        else:
            mark = " (the real map)" if real else ""
            line = map_line(corrected, found) if found.misread else self._texts.line(found)
            self.out.write(f"map {self.count}{mark}: {line}\n")
            for one in exceptions:
                self.out.write(f"  {one.words}\n")

    def end(
        self,
        fault: str | None,
        nodes: int | None = None,
        by: str | None = None,
        least: tuple[int, ...] | None = None,
        way: Sequence[str] | None = None,
    ) -> None:
        """Write what the maps are, and whether they are all.

        ``nodes`` is the number of nodes that were searched, and ``by`` is the way that found the
        maps. If they may not be all, nothing is said of those that were not found, except
        ``least``, a lower bound on what each map costs, if it is proved. If no map is closed,
        ``way`` is what stands in the way of one, as ``defaults.in_the_way`` finds it.
        """
        if self.as_json:
            kind = self.last.kind if self.count or not fault else None
            tail: dict[str, Any] = {"kind": kind, "count": self.count}
            if self.last.open:
                tail["open"] = True
            if self.last.cost:
                tail |= {"cost": self.last.cost, "proved": self.last.proved}
                if not self.last.proved and least:
                    tail["least"] = least
            if nodes is not None:
                tail["nodes"] = nodes
            if by is not None:
                tail["by"] = by
            if way is not None:
                tail["in_the_way"] = way
            tail |= formats.ended(fault)
            self.out.write("\n], " + json.dumps(tail)[1:] + "\n")
            return
        kind = "" if self.last.kind == UNPROVED else f"{self.last.kind} "
        line = f"{self.count} {kind}{words.plural(self.count, 'map')}{' found' * bool(fault)}"
        if fault and not self.count:
            line = "no map found yet"
        elif by is not None:
            line += f" by {by}"
        if self.last.cost:
            line += f", cost {' '.join(map(str, self.last.cost))}"
        if self.last.open:
            line += ", with pending gateways, as no closed map is found yet"
        elif not self.last.proved:
            line += f", {UNPROVED}"
            if least:
                line += f", proved to cost at least {' '.join(map(str, least))}"
        elif fault and self.count:
            line += ", more may exist"
        if nodes is not None:
            line += f", {nodes:,} nodes searched"
        if self.truth and not self.real and (self.count or not fault):
            line += f", the real map is not among {'those found so far' if fault else 'them'}"
        self.out.write(line + (f"; partial: {fault}\n" if fault else "\n"))
        if way:
            self.out.write(f"{defaults.told(way)}\n")
