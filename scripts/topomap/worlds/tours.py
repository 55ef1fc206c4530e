"""Tours: closed walks over every way, as short as they can be (the Chinese postman's)."""

import itertools
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime import nx
from topomap.runtime.errors import InputError
from topomap.runtime.watch import Watch

if TYPE_CHECKING:
    from networkx import Graph, MultiGraph

MOST_ODD = 1500  # places with an odd number of ways: of more pairs than memory should hold


def tour(world: TopologicalMap, start: Place, watch: Watch | None = None) -> list[int]:
    """The slots by which the places of a tour are left: a closed walk over every way that can be
    reached from ``start``; places and ways in sorted order. The watch may end the work.

    Raises InputError where more than MOST_ODD places have an odd number of ways."""
    watch = watch or Watch()
    graph = _reached(world, start)
    _go_twice(graph, watch)
    route = []
    for here, there, key in nx.eulerian_circuit(graph, source=start, keys=True):
        # A way walked twice has a key of networkx's own: take the first way there.
        ways = [s for s in sorted(world.stars[here]) if world.links[here, s][0] == there]
        keyed = [s for s in ways if key in ((here, s), world.links[here, s])]
        route.append((keyed or ways)[0])
    return route


def _reached(world: TopologicalMap, start: Place) -> "MultiGraph[Place]":
    """The places and ways that can be reached; the key of a way is one of its gateways."""
    ways: list[tuple[Gateway, Gateway]] = sorted(world.edges())
    there = nx.node_connected_component(nx.Graph((a[0], b[0]) for a, b in ways), start)
    graph: MultiGraph[Place] = nx.MultiGraph()
    graph.add_nodes_from(sorted(there))
    for a, b in ways:
        if a[0] in there:
            graph.add_edge(a[0], b[0], key=a)
    copy: MultiGraph[Place] = nx.MultiGraph(graph)  # in the order of ways that eulerize has
    return copy


def _go_twice(graph: "MultiGraph[Place]", watch: Watch) -> None:
    """Double ways, as few as can be, so that an even number of them meets at every place. It is
    what networkx's ``eulerize`` does, and it gives the same; but that cannot be ended, and looks
    for a path between each two of the places, where a search from each of them will do."""
    odd = [place for place, ways in graph.degree() if ways % 2]
    if len(odd) > MOST_ODD:
        raise InputError(
            f"a tour: {len(odd)} places have an odd number of ways, more than {MOST_ODD}"
        )
    number = {place: nth for nth, place in enumerate(odd)}
    pairs = _heeding(watch)
    for nth, first in enumerate(odd):
        watch.tick()
        far = nx.single_source_shortest_path_length(graph, first)
        for second in itertools.islice(odd, nth + 1, None):
            # The last place is named first, as in eulerize, on whose order the matching depends.
            pairs.add_edge(second, first, weight=len(graph) - far[second])
    matching: Graph[Place] = nx.Graph(list(nx.max_weight_matching(pairs)))
    doubled: list[Iterable[Any]] = []
    for pair in matching.edges():
        first, second = sorted(pair, key=number.__getitem__)
        doubled.append(itertools.pairwise(nx.shortest_path(graph, first, second)))
    for path in doubled:
        graph.add_edges_from(path)


def _heeding(watch: Watch) -> "Graph[Place]":
    """An empty graph that looks at a watch whenever it is asked for neighbours: so that what
    networkx does with it can be ended."""

    class Heeding(nx.Graph):  # type: ignore[type-arg]
        def neighbors(self, n: Place) -> Any:
            watch.tick()
            return super().neighbors(n)

    return Heeding()
