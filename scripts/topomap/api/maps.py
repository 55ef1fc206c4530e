"""A map that was found, and what can be done with it."""

import json
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from topomap.documents import answers
from topomap.model.exceptions import NamedException, exceptions_of
from topomap.model.experience import DState, Experience, Misread
from topomap.model.found import BEST, UNPROVED, Found
from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.model.words import markers
from topomap.runtime.checks import seconds
from topomap.runtime.limits import DRAWING
from topomap.runtime.watch import Watch

if TYPE_CHECKING:
    from networkx import MultiGraph

    from topomap.drawing.scenes import Scene


class Map:
    """A hypothesis: a topological map, and the agent's way in it (the paper, sections II and III).

    A place is the number of the step in which the agent was there first. A gateway is a pair
    ``(place, slot)``; slots are counted clockwise from 0 to ``slots - 1``. Nothing of a map can be
    changed. Two maps of one experience are equal if the agent is at the same place and gateway
    after each step, and if they contradict the same views. A notebook shows a map as a drawing.
    """

    def __init__(
        self,
        experience: Experience,
        found: Found,
        number: int = 1,
        many: int = 1,
        whole: bool = False,
        *,
        name: str = "",
        noisy: bool = False,
    ):
        """Make the map of what was found in an experience.

        Parameters:
            experience: What the agent saw and did.
            found: What was found.
            number: The number of the map among those that were found, from 1.
            many: How many maps were found; 0 if that is not known.
            whole: Whether these are proved to be all maps.
            name: Where the experience is from, for the title of a drawing.
            noisy: Whether views were allowed to be wrong; ``document`` then says which were.
        """
        self._seen, self._found = experience, found
        self._number, self._many, self._whole = number, many, whole
        self._name, self._noisy = name, noisy

    @cached_property
    def _corrected(self) -> Experience:
        return self._seen.corrected(self._found.misread)

    @cached_property
    def _world(self) -> TopologicalMap:
        return self._corrected.map_of(self._found.at)

    @property
    def found(self) -> Found:
        """What was found, as the rest of the package has it."""
        return self._found

    @property
    def slots(self) -> int:
        """The number of directions at each place."""
        return self._seen.slots

    @property
    def places(self) -> dict[Place, list[int]]:
        """The gateways of each place, as a list of their slots in order."""
        return {place: sorted(star) for place, star in self._world.stars.items()}

    @property
    def landmarks(self) -> dict[Place, list[str]]:
        """The landmarks of each place in order, as an instance writes them."""
        return {place: sorted(self._world.landmarks[place]) for place in self._world.stars}

    @property
    def links(self) -> list[tuple[Gateway, Gateway]]:
        """Each link once, as its two gateways."""
        return self._world.edges()

    @property
    def paths(self) -> list[list[Gateway]]:
        """Each path as its places in order, each with the slot by which the path goes on."""
        return self._world.paths()

    @property
    def faces(self) -> list[list[Gateway]]:
        """Each face as the gateways by which a walk round it leaves (the paper, Figure 3).

        If there are no links, there is one empty face.
        """
        return self._world.faces()

    @property
    def genus(self) -> int:
        """The genus; it is 0 if the map is planar."""
        return self._world.genus()

    @property
    def pending(self) -> list[Gateway]:
        """The gateways that have no link (the paper, section III.B)."""
        return self._world.pending()

    @property
    def at(self) -> tuple[DState, ...]:
        """The dstate after each step from 0: the place of the agent, and its gateway there."""
        return self._found.at

    @property
    def kind(self) -> str:
        """What the map is.

        It is "consistent"; "best" or "optimal", if that is proved; "best so far", if no closed map
        is consistent; or "not proved to be best".
        """
        unproved = not self.proved and self._found.kind in ("best", *BEST)
        return UNPROVED if unproved else self._found.kind

    @property
    def cost(self) -> tuple[int, ...]:
        """What was minimised, the most important number first; empty if nothing was."""
        return self._found.cost

    @cached_property
    def exceptions(self) -> list[NamedException]:
        """The exceptions to consistent boundaries.

        They are paths that meet twice, places that are both left and right of a path and, without
        the path axiom, paths that contain a place twice.
        """
        return exceptions_of(self._corrected, self.at)

    @property
    def proved(self) -> bool:
        """Whether it is proved that no map costs less."""
        return self._found.proved

    @property
    def misread(self) -> tuple[Misread, ...]:
        """What the map contradicts.

        Each misreading has the step, and the gateway (a slot, counted clockwise from the gateway
        where the agent stands) or the landmark that was missed or imagined.
        """
        return self._found.misread

    def to_networkx(self) -> "MultiGraph[int]":
        """Convert the map to a graph of networkx, the same that ``topomap export`` writes.

        A node is a place, with its ``gateways`` and ``landmarks``. An edge is a link, with its two
        gateways as ``ends``, the ``steps`` that travel it from the first to the second, and the
        steps that travel it ``back``. The attribute ``at`` of the graph is ``[[T, P, S], ...]``.

        Returns:
            The graph.
        """
        from topomap.exchange.exports import graph_of

        return graph_of(self._scene())

    def draw(self, file: str | Path, *, timeout: float | None = DRAWING) -> None:
        """Draw the map into a file: SVG, PNG or PDF, by the ending of its name.

        If there is enough time, one map always gives the same bytes.

        Parameters:
            file: The file to write.
            timeout: The number of seconds that the drawing may take. What cannot be drawn well in
                this time is drawn plainly, and the title says so.

        Raises:
            ValueError: ``timeout`` is not a number of seconds.
            InputError: The file has another ending or cannot be written, or the extra ``draw`` is
                not installed. The message is one line.
        """
        from topomap.api.draw import save

        save(self._scene(), file, Watch(seconds("timeout", timeout)).late)

    def _repr_svg_(self) -> str | None:
        """Draw the map for a notebook, which shows ``repr`` if the extra ``draw`` is missing."""
        from topomap.runtime.extras import lacking

        return None if lacking("draw") else self._drawn

    @cached_property
    def _drawn(self) -> str:
        from topomap.api.draw import svg

        return svg(self._scene(), Watch(DRAWING).late)

    def document(self) -> dict[str, Any]:
        """Convert the map to what ``topomap solve --json`` writes of it.

        Returns:
            A dictionary, whose keys ``docs/formats.md`` explains.
        """
        told = answers.map_json(self._world, self.at)
        if self._noisy or self.misread:
            told["misread"] = answers.misread_json(self._seen, self.misread)
        plain: dict[str, Any] = json.loads(json.dumps(told))
        return plain

    def _scene(self) -> "Scene":
        from topomap.drawing.scenes import Scene

        return Scene(
            *(self._world, self.at, self._name, self._number, self._many, self.kind),
            whole=self._whole,
            marker=markers(self._corrected, self.at),
            rests=self._corrected.starts | self._corrected.looks,
            seen=self._corrected,
        )

    def __str__(self) -> str:
        """The line that ``topomap solve`` prints."""
        return f"map {self._number}: {answers.map_line(self._corrected, self._found)}"

    def __repr__(self) -> str:
        return f"<{self.kind} {self}>"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Map):
            return NotImplemented
        return (self.at, self.misread) == (other.at, other.misread)

    def __hash__(self) -> int:
        return hash((self.at, self.misread))
