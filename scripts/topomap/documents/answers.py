"""Answers of ``solve``: maps as JSON, or as lines to read."""

import json
from collections.abc import Sequence
from typing import IO, Any

from topomap.model import words
from topomap.model.experience import Experience, Misread
from topomap.model.found import UNPROVED, Found, steps_json
from topomap.model.query import Query
from topomap.model.topology import Gateway, TopologicalMap
from topomap.runtime import formats


def map_json(world: TopologicalMap, at: Sequence[Gateway]) -> dict[str, Any]:
    """A hypothesis as JSON, from its map and the dstate after each step. A gateway or dstate
    is ``[place, slot]``; a link its two gateways; a path its dstates in order, with the slot
    of its heading; a face the gateways its walk leaves by (the paper's next); ``dstate``
    where the agent is."""
    return {
        "at": steps_json(at),
        "places": [
            {"place": place, "gateways": sorted(star), "landmarks": sorted(world.landmarks[place])}
            for place, star in world.stars.items()
        ],
        "links": world.edges(),
        "paths": world.paths(),
        "faces": world.faces(),
        "genus": world.genus(),
        "pending": world.pending(),
        "dstate": at[-1],
    }


def misread_json(experience: Experience, misread: Sequence[Misread]) -> list[dict[str, Any]]:
    """What was misread, as JSON: the step, the gateway or the landmark, and whether it was seen,
    and so is imagined, or was missed."""
    return [
        {"step": step, "gateway": what, "seen": what in experience.views[step]}
        if isinstance(what, int)
        else {"step": step, "landmark": what, "seen": what in experience.landmarks[step]}
        for step, what in misread
    ]


def map_line(experience: Experience, found: Found) -> str:
    """A hypothesis in one line: what it disbelieves, its size, and the dstate after each step.
    The experience is the corrected one."""
    world = experience.map_of(found.at)
    pending = sum(map(len, world.stars.values())) - len(world.links)
    return (
        f"{words.disbelieved(experience, found.misread)}"
        f"places {len(world.stars)}, links {len(world.links) // 2}, paths {len(world.paths())}, "
        f"genus {world.genus()}, pending {pending}: "
        + " ".join(f"{place}.{slot}" for place, slot in found.at)
    )


class Report:
    """The answer for one instance, written as it is found."""

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
            out.write(json.dumps(formats.headed(head))[:-1] + ', "maps": [')

    def add(self, found: Found) -> None:
        """Write one map."""
        self.count += 1
        self.last = found
        corrected = self.experience.corrected(found.misread)
        real = False
        if self.truth:
            real = corrected.map_of(found.at).isomorphic(self.truth)
            self.real += real
        if self.as_json:
            answer = map_json(corrected.map_of(found.at), found.at)
            if self.noisy:
                answer["misread"] = misread_json(self.experience, found.misread)
            if self.truth:
                answer["real"] = real
            self.out.write((",\n" if self.count > 1 else "\n") + json.dumps(answer))
        else:
            mark = " (the real map)" if real else ""
            self.out.write(f"map {self.count}{mark}: {map_line(corrected, found)}\n")

    def end(self, fault: str | None, nodes: int | None = None) -> None:
        """Write what the maps are, and whether they are all; ``nodes`` were searched. Where they
        may not be all, nothing is said of those that were not found."""
        if self.as_json:
            kind = self.last.kind if self.count or not fault else None
            tail: dict[str, Any] = {"kind": kind, "count": self.count}
            if self.last.cost:
                tail |= {"cost": self.last.cost, "proved": self.last.proved}
            if nodes is not None:
                tail["nodes"] = nodes
            tail |= formats.ended(fault)
            self.out.write("\n], " + json.dumps(tail)[1:] + "\n")
            return
        kind = "" if self.last.kind == UNPROVED else f"{self.last.kind} "
        line = f"{self.count} {kind}{words.plural(self.count, 'map')}{' found' * bool(fault)}"
        if fault and not self.count:
            line = "no map found yet"
        if self.last.cost:
            line += f", cost {' '.join(map(str, self.last.cost))}"
        if not self.last.proved:
            line += f", {UNPROVED}"
        elif fault and self.count:
            line += ", more may exist"
        if nodes is not None:
            line += f", {nodes:,} nodes searched"
        if self.truth and not self.real and (self.count or not fault):
            line += f", the real map is not among {'those found so far' if fault else 'them'}"
        self.out.write(line + (f"; partial: {fault}\n" if fault else "\n"))
