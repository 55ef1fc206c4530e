"""Tours: closed walks over every way that are as short as possible (Chinese postman's tours)."""

import itertools
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime import nx
from topomap.runtime.errors import InputError
from topomap.runtime.watch import Watch

if TYPE_CHECKING:
    from networkx import Graph, MultiGraph

MOST_ODD = 1500  # places with an odd number of ways; their pairs must fit into memory


def tour(world: TopologicalMap, start: Place, watch: Watch | None = None) -> list[int]:
    """Find a tour over every way that can be reached from ``start``.

    Places and ways are taken in sorted order. The watch may end the work.

    Returns:
        The slots by which its places are left.

    Raises:
        InputError: More than MOST_ODD places have an odd number of ways.
    """
    watch = watch or Watch()
    graph = _reached(world, start)
    _go_twice(graph, watch)
    route = []
    for here, there, key in nx.eulerian_circuit(graph, source=start, keys=True):
        # A doubled way has a key of networkx's own: take the first way there.
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
    copy: MultiGraph[Place] = nx.MultiGraph(graph)  # in eulerize's order of the ways
    return copy


def _go_twice(graph: "MultiGraph[Place]", watch: Watch) -> None:
    """Double as few ways as possible, so that an even number of them meets at every place.

    This is what networkx's ``eulerize`` does, with the same result. But that cannot be ended, and
    looks for a path between each two places, where one search from each place is enough.
    """
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
            # The last place is named first, as in eulerize: the matching depends on the order.
            pairs.add_edge(second, first, weight=len(graph) - far[second])
    matching: Graph[Place] = nx.Graph(list(nx.max_weight_matching(pairs)))
    doubled: list[Iterable[Any]] = []
    for pair in matching.edges():
        first, second = sorted(pair, key=number.__getitem__)
        doubled.append(itertools.pairwise(nx.shortest_path(graph, first, second)))
    for path in doubled:
        graph.add_edges_from(path)


def _heeding(watch: Watch) -> "Graph[Place]":
    """Make an empty graph that looks at a watch whenever it is asked for neighbours.

    So what networkx does with it can be ended.
    """

    class Heeding(nx.Graph):  # type: ignore[type-arg]
        """A graph that looks at the watch."""

        def neighbors(self, n: Place) -> Any:
            """The neighbours of a node, after a look at the watch."""
            watch.tick()
            return super().neighbors(n)

    return Heeding()
