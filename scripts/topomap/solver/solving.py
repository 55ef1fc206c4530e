"""Every hypothesis of a query, or the best ones, by clingo; and the number of hypotheses."""

import hashlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from operator import itemgetter

import clingo

from topomap.model.experience import Experience, Misread
from topomap.model.found import BEST_SO_FAR, OPTIMAL, Cube, Found
from topomap.model.query import Query
from topomap.model.vocabulary import CHOSEN
from topomap.runtime.folders import ENCODINGS
from topomap.runtime.version import VERSION
from topomap.runtime.watch import MEMORY, Stopped, Watch
from topomap.solver.programs import answers, program_of
from topomap.solver.shown import Shown
from topomap.solver.threads import Put, in_thread


def demand_cover(
    experience: Experience, query: Query, watch: Watch, cubes: Sequence[Cube], step: int
) -> None:
    """Check by clingo that each hypothesis after a step begins with exactly one of the cubes.

    So no answer depends on how the search has divided the tree.
    """
    kept = set(CHOSEN)
    if "no_path_axiom" in query.parts:  # a later link can then make the map perpendicular
        kept.remove("perpendicular")
    level = replace(query, parts=query.parts & kept, horizon=step)
    known, parted = watch.found, set(cubes)
    for found in hypotheses(experience, level, watch):
        if found and sum(found.at[:size] in parted for size in range(1, step + 2)) != 1:
            raise RuntimeError(f"clingo and the search differ by step {step}")
    watch.found = known


def digest(*experiences: Experience) -> str:
    """A digest that identifies the program, its encodings and these experiences."""
    texts = [_program_digest()]
    for seen in experiences:
        texts += [seen.facts(), *seen.constants(), seen.assumptions()]
    return hashlib.sha256("".join(texts).encode()).hexdigest() if experiences else texts[0]


@cache
def _program_digest() -> str:
    texts = [path.read_bytes() for path in sorted(ENCODINGS.rglob("*.lp"))]
    return hashlib.sha256(b"".join([VERSION.encode(), *texts])).hexdigest()


def misreadings(terms: Iterable[Sequence[clingo.Symbol]]) -> tuple[Misread, ...]:
    """What the atoms ``misread/2`` with these terms say, in order."""
    gateways, landmarks = [], []
    for step, what in terms:
        if what.name == "gateway":
            gateways.append((step.number, what.arguments[0].number))
        else:
            landmarks.append((step.number, str(what.arguments[0])))
    return tuple(sorted([*sorted(gateways), *sorted(landmarks)], key=itemgetter(0)))


def hypotheses(
    experience: Experience,
    query: Query,
    watch: Watch,
    kind: str | None = None,
    cubes: Sequence[Cube] | None = None,
) -> Iterator[Found | None]:
    """Find every hypothesis of a query.

    If the query minimises, better and better ones come first, and then all of the best with their
    proof. With ``cubes``, which is not for minimising, those that begin with the first cube come
    first, then a None, and so on.
    """
    shown = Shown()

    def read(model: clingo.Model) -> Found:
        """Read a hypothesis from a model."""
        at, others = shown.of(model.symbols(shown=True))
        if query.optimizes:
            misread = misreadings(terms for name, terms in others if name == "misread")
            cost = tuple(model.cost)
            return Found(at, kind or query.kind, cost, model.optimality_proven, misread)
        return Found(at, kind or query.kind)

    return answers(experience, query, watch, read, cubes)


Way = Callable[..., Iterator[Found | None]]  # a function like ``hypotheses``, here or by search


def best(
    experience: Experience, query: Query, watch: Watch, way: Way = hypotheses
) -> Iterator[Found | None]:
    """Find the best maps, as ``hypotheses`` gives them, with their cost.

    (semantics: "What is preferred, also where no map is perfect".) The cost is the numbers of
    exceptions, paths and places.

    The maps are ``optimal`` if they are closed, with the fewest exceptions to consistent
    boundaries, then the fewest paths, then the fewest places. If no map is closed, they are ``best
    so far``: the same with pending gateways allowed. If views may be wrong, a map that contradicts
    more views than another one is neither.

    If the least genus is preferred, it comes before the exceptions. Otherwise maps without
    exceptions are looked for first (``preferences``).
    """
    least: tuple[int, ...] = ()
    if query.noise is not None:
        cheapest = _first_proved(way(experience, query, watch))
        if cheapest is None:
            return
        least = cheapest.cost[:2]
        query = replace(query, noise=least[0])
    for kind, closed in ((OPTIMAL, ("closed",)), (BEST_SO_FAR, ())):
        for preferred, before in preferences(query):
            some = False
            asked = query.having(*closed, preferred, "minimal")
            try:
                for found in way(experience, asked, watch, kind):
                    if found and found.cost[: len(least)] == least:
                        some = some or not found.open  # an open map does not end the search
                        rest = found.cost[len(least) :]
                        yield replace(found, cost=(*least, *before, *rest))
            finally:
                if watch.least is not None:
                    watch.least = (*before, *watch.least)
            if some:
                return


def preferences(query: Query) -> list[tuple[str, tuple[int, ...]]]:
    """The parts by which to look for maps with the fewest exceptions, until there is a map.

    With each comes what precedes the cost of its maps. Maps without exceptions come first, because
    this prunes the search, and mostly there are some. But a map with exceptions may have a smaller
    genus, so where that is preferred all maps are considered at once.
    """
    either = [("boundary", (0,)), ("exceptions", ())]
    return either[1:] if "genus" in query.parts else either


def _first_proved(maps: Iterator[Found | None]) -> Found | None:
    """The first map that is proved to be best, or None; the search ends with the call."""
    return next((found for found in maps if found and found.proved), None)


def count(
    experience: Experience,
    query: Query,
    cube: Cube = (),
    watch: Watch | None = None,
    grown: bool = True,
) -> tuple[int, int]:
    """Count the hypotheses that begin with a cube (the best ones, if the query minimises).

    If it is asked for, those are counted, too, whose last step added a link (or that have no step).
    clingo counts, and no answer comes to Python; each is met once, even if those that have grown
    are counted separately. Without a watch it is counted in the caller's thread.
    """
    program = program_of(experience, query)
    last = experience.steps if query.horizon is None else min(query.horizon, experience.steps)
    fresh = clingo.Function("fresh", [clingo.Number(last)])
    counts: list[tuple[int, tuple[float, ...]]] = []

    def work(put: Put) -> None:
        """Count, and put the numbers."""
        for more in [[(fresh, True)], [(fresh, False)]] if grown and last else [[]]:
            program.solve(cube, more)
            counts.append(program.models())
            if not put(counts[-1][0]):
                break

    if watch is None:
        try:
            work(lambda _: True)
            program.keep()
        except MemoryError:
            raise Stopped(MEMORY) from None
    else:
        for number in in_thread(program, watch, work):
            watch.found += number
    least = min((cost for number, cost in counts if number), default=())
    numbers = [number if cost == least else 0 for number, cost in counts]
    return sum(numbers), numbers[0] if grown else 0
