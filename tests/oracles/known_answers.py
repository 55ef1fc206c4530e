"""The queries that the encodings are tried with, each with its right answers: what
make mutate runs on every mutant of an encoding.

A suite is a function that yields queries; an encoding is tried with those of its form that
load it.
"""

import random
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import combinations, product

from conftest import ENCODINGS, PARTS, ROOT, Truth, beyond, forms
from topomap.documents.check import NO_PATH_AXIOM, STEP_RULES, by_definition, by_rules
from topomap.model.experience import MARKER, Experience, observe
from topomap.model.facts import parse
from topomap.model.topology import TopologicalMap
from topomap.questions.standings import Standing
from topomap.runtime.limits import LARGEST
from topomap.solver.programs import FORMS
from topomap.worlds.environment import EAST, WEST, grid, world
from topomap.worlds.route import snake

from oracles import phase_answers, walks
from oracles.broken_rules import Assignment, assignments, reasons
from oracles.brute_force import Hypothesis
from oracles.maps_with_errors import (
    DEMANDS,
    INSTANCES,
    WITH_NUMBERS,
    bent_maps,
    by_hand,
    coming_back,
    contradicting,
    drawn,
)
from oracles.misreadings import brute, corrupted, expected
from oracles.statements import FIGURES, PROPERTIES, QUALITIES, RELATIONS, relation
from oracles.worlds import (
    WORLDS,
    bent,
    informed,
    logs,
    of_grid,
    random_experience,
    walked,
    wavering,
)


def seen(*steps, slots=4):
    """An experience from one text a step: "turn: gateways"."""
    views = tuple(frozenset(map(int, step.split(":")[-1].split())) for step in steps)
    turns = tuple(int(step.split(":")[0]) for step in steps[1:])
    return Experience(slots, views, turns, (frozenset(),) * len(steps))


def marked(experience, *steps):
    """The same with a landmark recognised after these steps."""
    marks = [frozenset("a" if step in steps else "") for step in range(experience.steps + 1)]
    return replace(experience, landmarks=tuple(marks))


CORRIDOR = seen("0", "0: 0 2", "2: 0", "0: 0 2")
CORNERS = seen("0 1", "0: 0 1", "1: 0 3")
FIRST, LAST = frozenset([0]), frozenset([2])
EXPERIENCES = {
    "corridor": CORRIDOR,
    "same": marked(CORRIDOR, 1, 3),
    "lost": marked(CORRIDOR, 1),
    "added": marked(CORRIDOR, 3),
    "branch": seen("0 1", "0: 0"),
    "end": seen("0 2", "0: 0"),
    "loop": seen("0 1", "0: 0 3"),
    "corners": CORNERS,
    "marker": replace(CORNERS, drops=FIRST, markers=LAST),
    "no marker": replace(CORNERS, drops=FIRST),
    "taken": replace(CORNERS, drops=FIRST, picks=LAST),
    # The marker is put down, taken up at the same place, and not seen there any more.
    "taken back": replace(seen("0", "0: 0", "0: 0", "0: 0", "0: 0"), drops=FIRST, picks=LAST),
    # No step arrives where it left.
    "marker at once": replace(seen("0 1", "0: 0 3"), drops=FIRST, markers=frozenset([1])),
    "mirrored": seen("0 1", "0: 0 1", "1: 0 1"),
    "ahead": seen("0 1 2 3", "0: 0 2", "2: 0 1 2 3"),
    "square": seen("0 3", "0: 0 3", "3: 0 3", "3: 0 3", "3: 0 1"),
    "round": seen("0 3", "0: 0 3", "3: 0 3", "3: 0 3", "3: 0 1", "1: 0 3"),
    "lasso": seen("0 1 2", "0: 0 1 2 3", "0: 0 1 2", "1: 0", "0: 0 1 3", "1: 0 1 2 3"),
    "ears": seen("0 1 2 3", "0: 0 1", "1: 0 1", "1: 0 1 2 3", "1: 0 1", "1: 0 1", "1: 0 1 2 3"),
    "triangle": seen("0 3", "0: 0 1", "1: 0 1", "1: 0 1"),
    "twisted": seen("0 1", "0: 0 1", "1: 0 3", "3: 0 3"),
    "stages": seen(
        "0 1 3",
        "3: 0 3",
        "3: 0 2 3",
        "3: 0",
        "0: 0 1 3",
        "3: 0 1",
        "1: 0 2 3",
        "2: 0 1",
        "1: 0 2 3",
    ),
    "meeting": seen(
        "0 2 3",
        "0: 0 1",
        "1: 0 1 2",
        "0: 0 3",
        "3: 0 2 3",
        "2: 0 1",
        "1: 0 2 3",
        "2: 0 1",
        "1: 0 2 3",
        "3: 0",
    ),
    "turning off": seen(
        "0 1 3",
        "3: 0 3",
        "3: 0 2 3",
        "2: 0 1",
        "1: 0 2 3",
        "3: 0",
        "0: 0 1 3",
        "3: 0 1",
        "1: 0 2 3",
    ),
    # Planarity goes by what lies beyond a gateway by which a place, which is new for sure, was
    # first reached.
    "beyond": seen(
        "0",
        "0: 0 1 2 4 6",
        "6: 0 2",
        "2: 0 1 2 4 6",
        "6: 0 1 2 3",
        "3: 0 1 3 5 7",
        "5: 0 1 2 3",
        "0: 0 2 3 4 6",
        "4: 0 4",
        "4: 0 2 4 5 6",
        slots=8,
    ),
    # Two paths that meet twice: on no run of either; on two runs that an earlier one joins.
    "lens": walked(4, "p1 x3 x1 q3 x2 c0 c3 y1 p2 y0 y2 q0", "p1", "1 2 3 2 3 2 3 0"),
    "fork": walked(4, "p1 q3 p2 y0 y2 z0 z2 q0 z1 c3 c0 d2 d3 y1", "y2", "2 1 0 3 0 1 0"),
    # Three runs on one path, the first of which and the last one would cross if the last place were
    # the first; and the same walked with the middle one first, or last.
    "three pieces": seen(
        *("0 1 2 3", "0: 0 2 3", "3: 0", "0: 0 1 3", "3: 0 2 3", "3: 0", "0: 0 1 3", "3: 0 1 2 3")
    ),
    "the middle first": seen(
        *("0 1 2", "0: 0 2 3", "3: 0", "0: 0 1 3", "3: 0 1 2 3", "3: 0 3", "3: 0 3", "3: 0 1 3"),
        "1: 0 1 2 3",
    ),
    "the middle last": seen(
        *("0 1 2 3", "0: 0 2 3", "3: 0 1 2", "1: 0 1 3", "3: 0 1 2 3", "2: 0 3", "3: 0 3"),
        *("3: 0 2 3", "2: 0 1 3", "3: 0 2 3"),
    ),
    # The path along the row ends twice where a run of several steps does.
    "both ends of a row": of_grid(2, 5, "grid", (0, 2, 1), "EESWWNWW"),
    # Some place would be on both sides of a path, if two that look alike were one: of a path of two
    # runs that share one link; of a path of two runs that share a place; where a walk leaves a path
    # against two steps of a run; where it goes on along another run; and so against the first.
    "sides of two runs": walked(
        *(4, "a1 e3 e1 z3 z2 t0 t3 s1 s0 e2 a3 b1 b0 o2 o0 w2 o1 v3 t1 u3", "a1"),
        "1 1 2 3 0 3 3 0",
    ),
    "sides of two pieces": walked(
        4, "t0 p2 p1 q3 q2 d0 q1 r3 r0 o2 t1 u3 o1 v3", "t0", "0 1 2 0 1 0"
    ),
    "sides two steps away": walked(4, "t0 m2 m0 p2 p1 q3 q0 o2 t1 u3 o1 v3", "t0", "0 0 1 0"),
    "sides by another run": walked(
        4, "q0 o2 q3 p1 p2 m0 m1 d3 m2 k0 o1 u3 k1 v3", "q0", "0 2 3 2 1 3 2"
    ),
    "sides against a run": walked(
        *(4, "a1 e3 e1 z3 z2 y0 y1 o3 y3 s1 s0 e2 a3 b1 o2 u0 b2 v0", "a1"),
        "1 1 2 1 3 3 0 3 3",
    ),
    # Two paths meet twice, one of them, or both, in two pieces; and a triangle of paths in pieces.
    "lens of a path in pieces": walked(4, "p1 q3 q2 d0 q1 r3 r0 o0 o2 p0", "p1", "1 2 0 1 0 2"),
    "lens in pieces": walked(4, "p1 q3 q2 d0 q1 r3 r0 o0 o1 f3 o2 p0", "p1", "1 2 0 1 0 1 3 2"),
    "triangle in pieces": walked(
        *(4, "p1 a3 a2 d0 a1 q3 q2 b0 b1 e3 b2 r0 r3 c1 c2 f0 c3 p2", "p1"),
        "1 2 0 1 2 1 3 2 3 2 0 3",
    ),
    # A path would be a circle: of two runs with one heading, or with opposite ones.
    "a circle in pieces": walked(4, "p1 q3 q1 r3 r2 d0 r1 s3 s1 p3", "p1", "1 1 2 0 1 1"),
    "a circle from both sides": walked(
        4, "p1 q3 q1 r3 r2 x0 x2 p2 p3 s1 s3 r1", "p1", "1 1 2 2 3 3"
    ),
    # The ends of a path are seen where long runs begin.
    "long runs at both ends": walked(
        4,
        "m1 p3 p1 q3 q1 x3 q2 r0 r2 s0 s3 t1 t0 m2 m3 k1 k3 l1 l3 w1 l2 g0 g2 h0",
        "m1",
        "1 1 2 2 3 0 3 3 2 2",
    ),
    "star": seen("0 1 2", "0: 0", "0: 0 1 2", "1: 0", "0: 0 1 5", "1: 0", "0: 0 4 5", slots=6),
}


# The random ones: seed, most steps, and how many of them are after the horizon. The last three
# were found by a search for experiences that kill a mutant which the others do not.
DRAWN = [*((seed, 8, seed % 3) for seed in range(100)), (602, 14, 0), (2408, 12, 0), (10497, 11, 0)]


# Walks whose runs meet at places of four gateways, most of them found by such a search.
# Random walks, by seed, for which each of these leaves out some hypotheses: the path axiom,
# planarity, consistent boundaries and perpendicularity. (Most random walks have one hypothesis.)
BITING = [94, 158, 226, 294, 321, 330, 430, 439, 497, 614, 687, 815, 1036, 1151, 1198, 1334, 1484]
BITING += [1541, 1568, 1671, 1782, 1956, 2318, 2519, 2549, 2591, 2741, 2868, 2900]
WALKS = [
    # Runs that pass no such place are on one path with runs that do.
    seen(
        *("0 2", "0: 0", "0: 0 2", "2: 0 1 2 3", "2: 0 1", "1: 0 1", "1: 0 1", "1: 0 1 2 3"),
        *("2: 0 2", "2: 0", "0: 0 2"),
    ),
    # Runs of one path pass as many such places as there are runs that do, and more.
    of_grid(3, 4, "grid", (1, 0, 1), "EEWWNESSENN"),
    marked(of_grid(3, 5, "grid", (1, 0, 1), "EEEWWWSENNESSENN"), 2, 4, 12),
    of_grid(2, 3, "grid", (1, 2, 0), "WNSNWS"),
    of_grid(4, 4, "grid", (2, 0, 2), "ESEWN"),
    of_grid(3, 3, "grid", (2, 2, 3), "WWNNSENE"),
    of_grid(4, 4, "grid", (3, 1, 3), "EENN"),
    of_grid(3, 3, "cylinder", (2, 1, 1), "NENWWWWWWSSWW"),
    of_grid(3, 3, "grid", (1, 2, 2), "NWWSSE"),
    of_grid(3, 3, "cylinder", (1, 2, 1), "WSWWNNWWEE"),
    of_grid(4, 4, "grid", (2, 1, 3), "ENWNEEWWWSSNN"),
    of_grid(4, 4, "grid", (2, 1, 1), "WNSSEENW"),
    of_grid(3, 3, "grid", (0, 1, 2), "SNWSE"),
    of_grid(3, 3, "grid", (0, 1, 2), "SNWSEESWN"),
]

# Walks of four slots that kill mutants of lines.lp: made for it, and found by a search.
RING = "w2 t0 t2 w0 t1 q3 q2 r0 r1 s3 s0 d2 d0 e2"
TWO_GATES = "a1 p3 p1 t3 t1 f3 a2 e0 e1 z3 z0 p2 t2 x0"
TWICE = "t1 m3 m1 n3 n1 u3 m0 k0 n0 l0"
FORK = "g1 m3 m2 k0 k1 l3 l1 h3 h0 z2 z3 n1 n2 l0 n3 u1 u2 o0 o1 k3 m1 v3 g2 v2"
SQUARES = [
    # A circular path that could be taken for one that ends, as parts of the two look alike.
    walked(4, RING, "w0", "2 1 3 2 0 1 2 1 0 2 0 0"),
    walked(4, RING, "d2", "0 2 2 3 0 3 0 2 1 3 2"),
    # A visit that could be of two places, each with a gateway which no other visit takes.
    walked(4, TWO_GATES, "f3", "3 3 3 2 1 0"),
    walked(4, TWO_GATES, "p2", "2 3 0 1 1 1"),
    # Two paths that meet twice, one of them of runs that do not all touch; or both passed
    # straight on at both places.
    walked(4, TWICE + " t2 w0 w2 u2", "w2", "0 1 3 2 0 1 0 0 1 0 0 1 2 2 3"),
    walked(4, TWICE + " t2 u2", "l0", "0 3 0 0 3 2 3 1 2 1"),
    walked(4, TWICE + " t2 u2", "m1", "3 2 3 1 2 1 0 0 1 0"),
    walked(4, "x1 t3 t1 u3 u1 y3 y2 c0 c3 d1 d0 u2 u0 t0 t2 w0", "x1", "1 1 1 2 3 0 0 2"),
    # A triangle of paths, but of no three runs.
    walked(4, "x1 m3 m1 z3 x2 y0 y1 z2 m0 k0", "m1", "3 2 1 3 0"),
    # Two ways could begin at one gateway, and two more at another.
    walked(4, FORK, "g2", "1 2 1 1 0 3 2 0 3 2 1 0 1"),
    seen("0 2", "2: 0 3", "3: 0 3", "3: 0 2", "2: 0 3", "3: 0 3", "3: 0 2"),
    seen("0", "0: 0 1 2 3", "3: 0", "0: 0 1 2 3", "3: 0", "0: 0 1 2 3", "3: 0 2", "2: 0"),
    seen("0 2", "0: 0 1 2", "1: 0", "0: 0 1 3", "1: 0", "0: 0 2 3", "2: 0 2", "2: 0"),
    marked(
        seen(
            "0 2 3",
            "2: 0 2 3",
            "2: 0 3",
            "3: 0 3",
            "3: 0 2 3",
            "2: 0 2 3",
            "2: 0 3",
            "3: 0 3",
            "3: 0 2 3",
            "3: 0 1 3",
            "1: 0 1 2",
            "1: 0 1 3",
        ),
        0,
        8,
    ),
    seen("0 2", "0: 0", "0: 0 2", "2: 0", "0: 0 2", "2: 0", "0: 0 2"),
    seen(
        "0 1 2 3",
        "3: 0",
        "0: 0 1 2 3",
        "3: 0 1",
        "1: 0",
        "0: 0 3",
        "3: 0 1 2 3",
        "2: 0",
        "0: 0 1 2 3",
        "1: 0",
    ),
    seen("0 2", "0: 0 2", "0: 0 2", "2: 0", "0: 0 2", "2: 0 2", "2: 0", "0: 0 2", "2: 0 2"),
    seen("0 1 2 3", "0: 0", "0: 0 1 2 3", "2: 0", "0: 0 1 2 3", "1: 0", "0: 0 1 2 3", "2: 0"),
    seen("0 1 2 3", "2: 0", "0: 0 1 2 3", "1: 0", "0: 0 1 2 3", "2: 0", "0: 0 1 2 3", "3: 0"),
    seen(
        "0 1 2 3",
        "2: 0 2",
        "0: 0 1 2 3",
        "1: 0",
        "0: 0 1 2 3",
        "2: 0",
        "0: 0 1 2 3",
        "3: 0",
        "0: 0 1 2 3",
        "2: 0 2",
        "2: 0",
    ),
    seen(
        "0 2 3",
        "2: 0 3",
        "3: 0 3",
        "3: 0 2 3",
        "2: 0 2 3",
        "2: 0 3",
        "3: 0 3",
        "3: 0 2 3",
        "2: 0 2 3",
        "3: 0 1 3",
        "3: 0 2 3",
        "3: 0 1 3",
    ),
    seen("0 2", "2: 0 3", "3: 0 3", "3: 0 2", "0: 0 1", "0: 0 2", "2: 0 3", "3: 0 3", "3: 0 2"),
    # What contradicts itself: the way back ends elsewhere.
    seen("0", "0: 0 1", "1: 0", "0: 0"),
]


Answers = frozenset[tuple[tuple[int, ...], frozenset[str]]]


DEFAULTS = "drift=10", "stretch=10", "tolerance=0"


@dataclass(frozen=True)
class Query:
    """Encodings, by their names under encodings/, loaded with what they include, with facts
    and with arguments of clingo; and the answers, each its cost and the atoms that it shows.
    With --opt-mode=optN, these are the optimal ones.

    With ``steps``, they are grounded one after the other, each with its facts and the program
    parts ``parts``, and then it is asked. A number among them takes that step back; what is
    not of a step is only added."""

    files: tuple[str, ...]
    facts: str
    answers: Answers
    arguments: tuple[str, ...] = ()
    steps: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()


def shown(*atoms: str) -> Answers:
    """The one answer that shows these atoms, and has no cost."""
    return frozenset({((), frozenset(atoms))})


def constants(experience: Experience) -> tuple[str, ...]:
    """Its constants, but for those which the encodings have to take without being told."""
    told = experience.constants()
    pairs = [pair for pair in zip(told[::2], told[1::2], strict=True) if pair[1] not in DEFAULTS]
    return tuple(word for pair in pairs for word in pair)


def theory() -> Iterator[Query]:
    """Experiences, with the answers that the independent search gives; and what is none."""
    # No visit sees the gateway at which it stands, or the number of directions is not given.
    yield Query(("topomap",), "slots(4). view(0,0). turn(1,0). view(1,2).", frozenset())
    for parts in ((), ("explain",)):
        yield Query(("topomap", *parts), "#defined slots/1. view(0,0).", frozenset())
    for name, experience in (EXPERIENCES | WORLDS).items():
        yield from hypotheses(experience.facts(), (), Truth(experience))
        if name.startswith("sides"):
            yield from exceptional(experience, Truth(experience))
    for seed, most, after in DRAWN:
        experience = random_experience(random.Random(f"corpus {seed}"), most)
        horizon = max(0, experience.steps - after)
        cut = ("-c", f"horizon={horizon}")
        yield from hypotheses(experience.facts(), cut, Truth(experience.cut(horizon)))


def marker() -> Iterator[Query]:
    """Experiences with a marker."""
    for seed in range(30):
        experience = random_experience(random.Random(f"marker {seed}"), 9, marker=True)
        yield from hypotheses(experience.facts(), (), Truth(experience))
    for name in ("marker", "no marker", "taken", "marker at once"):
        for horizon in range(EXPERIENCES[name].steps + 1):
            cut, how = EXPERIENCES[name].cut(horizon), ("-c", f"horizon={horizon}")
            yield from hypotheses(EXPERIENCES[name].facts(), how, Truth(cut))


def knowledge() -> Iterator[Query]:
    """Experiences with more known than views: all that is asked of others, what is broken if
    it may be, the phases, and statements."""
    known = [*KNOWN.values(), *(informed(random.Random(f"known {seed}"), 7) for seed in range(30))]
    told = [*LOGS.values(), *(logs(random.Random(f"logs known {seed}"), 6) for seed in range(30))]
    for experience in [*known, *told]:
        truth, how = Truth(experience), constants(experience)
        facts = experience.facts()
        if len(truth.final) < 150:
            yield from hypotheses(facts, how, truth)
        answers = frozenset(
            ((), frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at))) for at in truth.final
        )
        explained = f"{facts} :- waived(_)."
        yield Query(("topomap", "explain"), explained, answers, (*how, "--opt-mode=ignore"))
        if experience.same or experience.apart:
            yield Query(("topomap",), turned(experience), answers, how)
        if len(truth.final) < 100:
            tests = {"planar": PROPERTIES["planar"], "closed": PROPERTIES["closed"]}
            tests |= {
                f"{name}({NAMED.get(figure, figure)},2)": partial(
                    _compared, FIGURES[figure], COMPARED[name], 2
                )
                for name in COMPARED
                for figure in FIGURES
            }
            yield from statements(experience, truth, tests)
    for experience in known:
        facts, how = experience.facts() + "phases. ", constants(experience)
        pairs = phase_answers.Pairs(experience)
        yield Query(("phases/visits",), facts, shown(*pairs.shown()), how)
        facts += "".join(f"{atom}. " for atom in pairs.shown())
        yield replace(left(facts, experience, Truth(experience), []), arguments=how)
    for experience in KNOWN.values():
        yield from waived(experience.cut(3), ())
    for experience in [*KNOWN.values(), *LOGS.values()]:
        truth = Truth(experience)
        for horizon in range(experience.steps):
            found = frozenset(((), ats(at)) for at in truth.levels[horizon])
            how = (*constants(experience), "-c", f"horizon={horizon}")
            for facts in dict.fromkeys((experience.facts(), turned(experience))):
                yield Query(("topomap",), facts, found, how)
            planar = Truth(experience.cut(horizon)).having("planar")
            found = frozenset(((), ats(at)) for at in planar)
            yield Query(("topomap", "planar"), experience.facts(), found, how)


def turned(experience: Experience) -> str:
    """Its facts, with the visits known to be of one place, or of two, the other way round."""
    return re.sub(r"(same|apart)\((\d+),(\d+)\)", r"\1(\3,\2)", experience.facts())


# Each of what is known besides views, where it holds and where it bites, at its border.
ROUND = seen("0 3", "3: 0 3", "3: 0 3", "3: 0 3", "3: 0 3", "3: 0 3")  # perhaps a square
THERE = seen("0 2", "0: 0 2", "0: 0 2", "0: 0 2")  # to and fro
KNOWN = {
    "compass": replace(ROUND, compass=(0, 1, 2, 3, 0, 1)),
    "compass, elsewhere": replace(ROUND, compass=(0, None, 2, None, 3, 1)),
    "odometry": replace(ROUND, shifts=((10, 0), (0, 10), (-10, 1), (1, -10), (9, 0))),
    "odometry, just": replace(ROUND, shifts=((10, 0), (0, 10), (-6, 0), (0, -10), None)),
    "odometry, just not": replace(ROUND, shifts=((10, 0), (0, 10), (-5, 0), (0, -10), (9, 0))),
    "odometry, aside": replace(ROUND, shifts=((10, 0), (0, 10), (-10, 0), (0, -5), (9, 0))),
    "odometry, a gap": replace(ROUND, shifts=((10, 0), None, (10, 0), (10, 0), (10, 0))),
    # At the border: the way of 20 ends 2 off; that of 99 ends 10 off.
    "odometry, as far as may be": replace(ROUND, shifts=((11, 0), (0, 0), (-9, 0), (0, 0), None)),
    "odometry, a little more": replace(ROUND, shifts=((54, 0), (0, 1), (-44, 0), (0, 0), None)),
    "aside, as far as may be": replace(ROUND, shifts=((0, 11), (0, 0), (0, -9), (0, 0), None)),
    "aside, a little more": replace(ROUND, shifts=((0, 54), (1, 0), (0, -44), (0, 0), None)),
    "all the drift there is": replace(
        ROUND, shifts=((1, 0), (0, 0), (0, 0), (0, 0), None), drift=LARGEST
    ),
    "drift": replace(ROUND, shifts=((10, 0), (0, 10), (-5, 0), (0, -10), (9, 0)), drift=20),
    "length": replace(THERE, lengths=(100, 90, 100)),
    "length, just not": replace(THERE, lengths=(100, 89, 100)),
    "length, longer": replace(THERE, lengths=(89, 100, 95)),
    "length, longer, as far as may be": replace(THERE, lengths=(90, 100, None)),
    "length, a little more": replace(THERE, lengths=(1000, 899, None)),
    "length, longer, a little more": replace(THERE, lengths=(899, 1000, None)),
    "length, round": replace(ROUND, lengths=(100, 50, 40, 30, 100)),
    "length, unlike": replace(ROUND, lengths=(100, 50, 40, 30, 89)),
    "stretch": replace(THERE, lengths=(100, 89, None), stretch=11),
    "stretch, just not": replace(THERE, lengths=(100, 88, None), stretch=11),
    "odometry, two gaps": replace(
        seen("0 2", *["0: 0 2"] * 4), shifts=((10, 0), None, None, (0, 0))
    ),
    "same": replace(ROUND, same=[(0, 4)]),
    "same, again": replace(ROUND, same=[(5, 1), (2, 0)]),
    "apart": replace(ROUND, apart=[(0, 4)]),
    "apart, the other way": replace(ROUND, apart=[(4, 0), (1, 2)]),
}


def rested(experience: Experience, step: int, kind: str, **more) -> Experience:
    """The same with an inserted step that is not a travel: it has the view of the step before."""
    views = [*experience.views[:step], experience.views[step - 1], *experience.views[step:]]
    turns = [*experience.turns[: step - 1], None, *experience.turns[step - 1 :]]
    return Experience(experience.slots, views, turns, **{kind: [step]}, **more)


TWO = Experience(4, [[0], [0, 1], [0, 1], [0]], [0, None, 1], starts=[2])
LOGS = {
    "a second look": rested(ROUND, 2, "looks"),
    "at the start": rested(THERE, 1, "looks"),
    "looks straight on": rested(seen("0", "0: 0 2", "2: 0 2", "2: 0"), 2, "looks"),
    "a look with odometry": rested(
        ROUND, 2, "looks", shifts=[(10, 0), None, (0, 10), (-10, 0), (0, -10), (10, 0)]
    ),
    # Without the shift of the look it would be too far.
    "a look that moved": rested(
        *(ROUND, 2, "looks"),
        shifts=[(10, 0), (5, 5), (0, 10), (-70, -7), (0, -8), None],
        drift=50,
    ),
    "a look that moved too far": rested(
        ROUND, 2, "looks", shifts=[None, (5, 5), None, None, None, None]
    ),
    "a log": TWO,
    "a log from a corridor": rested(seen("0 2", "0: 0 2", "2: 0 2", "2: 0"), 2, "starts"),
    "a log of one place": Experience(4, [[0], [0], [0]], [0, None], starts=[2]),
    "two dead ends": Experience(4, [[0], [0]], [None], starts=[1]),
    "three dead ends": Experience(4, [[0], [0], [0]], [None, None], starts=[1, 2]),
    "a log that joins two": Experience(4, [[0], [0], [0], [0]], [None, None, 0], starts=[1, 2]),
    "two places": Experience(4, [[0, 1], [0, 1]], [None], starts=[1]),
    "a log with odometry": replace(TWO, shifts=((5, 0), (1, 1), (0, 5))),
    "coin and rope": Experience(
        4,
        [[0, 2], [0, 2], [0, 2], [0, 2]],
        [0, 0, 0],
        things=[
            ("drop", 0, "coin"),
            ("drop", 1, "rope"),
            ("marker", 2, "coin"),
            ("pick", 3, "rope"),
        ],
    ),
    "beside the one without a name": Experience(
        4, [[0, 2]] * 4, [0, 2, 2], drops=[0], things=[("drop", 1, "coin")], markers=[3]
    ),
    "back at the one without a name": Experience(
        4, [[0, 2]] * 4, [0, 0, 2], drops=[0], things=[("drop", 1, "coin")], markers=[2]
    ),
    # It is taken up at a second look, and so is not seen when the agent comes back.
    "taken at a look": Experience(4, [[0]] * 4, [None, 0, 0], looks=[1], drops=[0], picks=[1]),
}


# Pairs of gateways that are given, and bearings that are not exact: each at its border.
BOTH = [(0, 2), (1, 3)]  # all that are opposite, of four
DRIFTING = Experience(12, [[0, 4, 8], [0], [0, 5, 7]], [0, 0])
BENT = {
    "one slot off": replace(DRIFTING, tolerance=1),
    "one slot off, exactly": DRIFTING,
    "a pair more": Experience(4, [[0, 1, 2], [0], [0, 1, 2]], [0, 0], straight=[[], [], [(0, 1)]]),
    "a pair less": Experience(4, [[0, 1, 2], [0], [0, 1, 2]], [0, 0], straight=[[(0, 1)], [], []]),
    "another pair": Experience(
        4, [[0, 1, 2], [0], [0, 1, 2]], [0, 0], straight=[[(0, 1)], [], [(0, 2)]]
    ),
    "a pair more, not exactly": Experience(
        4, [[0, 1, 2], [0], [0, 1, 2]], [0, 0], straight=[[], [], [(0, 1)]], tolerance=1
    ),
    "a pair less, not exactly": Experience(
        4, [[0, 1, 2], [0], [0, 1, 2]], [0, 0], straight=[[(0, 1)], [], []], tolerance=1
    ),
    # The one gateway is right of the other at the first visit, and left of it at the second one.
    "right or left": Experience(12, [[0, 5], [0], [0, 5], [0]], [5, 0, 5], tolerance=2),
    # Each is within the tolerance of the first visit, and the two are twice that apart.
    "off to both sides": Experience(
        12, [[0, 4], [0], [0, 3], [0], [0, 5]], [0, 0, 0, 0], tolerance=1
    ),
    "off to both sides, the other way": Experience(
        12, [[0, 4], [0], [0, 5], [0], [0, 3]], [0, 0, 0, 0], tolerance=1
    ),
    # The visits are from two gateways, and the bearing of each is in the difference of a third one.
    "off three times": Experience(
        36, [[0, 10, 20], [0], [0, 11, 25], [0], [0, 17, 27]], [10, 0, 11, 0], tolerance=1
    ),
    "a length that differs, not exactly": Experience(
        4, [[0], [0], [0]], [0, 0], lengths=[100, 50], tolerance=1
    ),
    # Gateways that are a slot apart, and seen a slot off, where the paper's faces are walked.
    "a slot apart": Experience(
        12,
        [
            [0, 1, 8],
            [0, 1, 8],
            [0, 8, 11],
            [0, 5, 11],
            [0, 3, 5],
            [0, 7, 10],
            [0, 5, 11],
            [0, 4, 5],
        ],
        [1, 0, 8, 0, 3, 7, 0],
        tolerance=1,
    ),
    "a slot apart, once more": Experience(
        12,
        [
            *([0, 3, 4, 11], [0, 6, 8, 10], [0, 7, 8, 11], [0, 1, 8, 9], [0, 8, 9, 11]),
            *([0, 1, 8, 9], [0, 1, 8, 9], [0, 1, 4, 5]),
        ],
        [0, 8, 7, 9, 8, 8, 0],
        tolerance=1,
    ),
    "off too far": Experience(12, [[0, 4], [0], [0, 6]], [0, 0], tolerance=1),
    "the last slot": Experience(4, [[0, 1], [0], [0, 3]], [0, 0], tolerance=2),
    "a turn of a slot off": Experience(
        12, [[0, 4, 8], [0], [0, 5, 7], [0]], [0, 0, 5], tolerance=1
    ),
    "a compass one off": Experience(
        12, [[0, 4], [0], [0, 4]], [0, 0], compass=[3, None, 4], tolerance=1
    ),
    "a compass two off": Experience(
        12, [[0, 4], [0], [0, 4]], [0, 0], compass=[3, None, 5], tolerance=1
    ),
    "a compass round the circle": Experience(
        12, [[0, 4], [0], [0, 4], [0], [0, 4]], [0] * 4, compass=[0, None, 11, None, 1], tolerance=1
    ),
    "a compass round the circle, the other way": Experience(
        12, [[0, 4], [0], [0, 4], [0], [0, 4]], [0] * 4, compass=[0, None, 1, None, 11], tolerance=1
    ),
    # The bearing is one slot off, and the compass one slot more.
    "a compass one off, and a slot": Experience(
        *(12, [[0, 4], [0], [0, 5], [0], [0, 8]], [0, 0, 5, 0]),
        compass=[None, None, 3, None, 6],
        tolerance=1,
    ),
    "a compass one off, and a slot, the other way": Experience(
        *(12, [[0, 4], [0], [0, 3], [0], [0, 8]], [0, 0, 3, 0]),
        compass=[None, None, 3, None, 8],
        tolerance=1,
    ),
    "a compass two off, from high slots": Experience(
        *(12, [[0, 11], [0], [0, 1], [0], [0, 11]], [11, 0, 1, 0]),
        compass=[None, None, 0, None, 11],
        tolerance=1,
    ),
    "two off, from a high slot": Experience(12, [[0, 11], [0], [0, 11]], [11, 0], tolerance=1),
    "one off, from a high slot": Experience(12, [[0, 11], [0], [0, 2]], [11, 0], tolerance=1),
    "a landmark too much": Experience(12, [[0], [0, 4], [0]], [0, 0], [(), (), ["a"]], tolerance=1),
    "a landmark too few": Experience(12, [[0], [0, 4], [0]], [0, 0], [["a"], (), ()], tolerance=1),
    "one opposite, and one not": Experience(8, [[0, 4], [0], [0, 5]], [0, 0], tolerance=1),
    "one not, and one opposite": Experience(8, [[0, 5], [0], [0, 4]], [0, 0], tolerance=1),
    "opposite, as given": replace(ROUND, straight=[[]] * 6),
    "all opposite": replace(EXPERIENCES["ahead"], straight=[[], [(0, 2)], BOTH]),
    "perhaps a circle": replace(EXPERIENCES["ahead"], straight=[BOTH, [(0, 2)], BOTH]),
    "perhaps a circle, not exactly": replace(
        EXPERIENCES["ahead"], straight=[BOTH, [(0, 2)], BOTH], tolerance=1
    ),
    "round a corner": replace(EXPERIENCES["square"], straight=[*[[(0, 3)]] * 4, [(0, 1)]]),
    "round once more": replace(
        EXPERIENCES["round"], straight=[*[[(0, 3)]] * 4, [(0, 1)], [(0, 3)]]
    ),
    "ends at a corner": replace(CORNERS, straight=[[(0, 1)], [], [(0, 3)]]),
    # The path ends at gateway 0 of the first place, and another one has the gateway opposite to it.
    "a gateway opposite an end": Experience(
        4, [[0, 1, 2], [0, 1], [0, 2], [0, 2, 3]], [2, 1, 2], straight=[[(1, 2)], [], [], [(0, 3)]]
    ),
    # Three paths meet at the first place, and end there.
    "three ends": replace(
        seen("0 1 2", "0: 0", "0: 0 1 2", "1: 0", "0: 0 1 3", "1: 0", "0: 0 2 3"),
        straight=[[]] * 7,
    ),
    "paths that bend": Experience(
        6,
        [[0, 1, 3], [0, 2], [0, 2], [0, 3, 4], [0, 2], [0, 1]],
        [1, 2, 2, 3, 2],
        straight=[[(0, 1)], [(0, 2)], [], [(0, 4)], [(0, 2)], []],
    ),
}


UNTRIED = seen("0 1", "1: 0")  # closed but for the first gateway


def places_of(name):
    """A walk through a smallest case of tests/cases."""
    return parse((ROOT / f"tests/cases/{name}.lp").read_text(), name)


def bearings() -> Iterator[Query]:
    """Experiences where pairs of gateways are given, or bearings are not exact, with the path axiom
    and without it; and others without it."""
    cases = [places_of(name) for name in ("crescent", "oxbow", "loop")]
    drawn = [bent(random.Random(f"bearings {seed}"), 7) for seed in range(40)]
    drawn += [replace(informed(random.Random(f"off {seed}"), 5), tolerance=1) for seed in range(8)]
    drawn += [
        replace(logs(random.Random(f"logs off {seed}"), 6), tolerance=1) for seed in range(12)
    ]
    drawn += [wavering(random.Random(f"wavering {seed}")) for seed in range(40)]
    for experience in [*BENT.values(), *cases, *drawn]:
        truth = Truth(experience)
        if len(truth.final) < 60:
            yield from shapes(experience, truth)
            yield from exceptional(experience, truth)
            yield from _asked(random.Random(experience.facts()), experience, truth)
        if (experience.straight or experience.tolerance) and len(truth.final) < 60:
            yield from about(experience, truth)
    for seed in range(20):
        for number in range(2):  # more of what is asked of gateways
            experience = bent(random.Random(f"bent asked {seed}"), 6)
            truth = Truth(experience)
            if len(truth.final) < 60:
                yield from _asked(random.Random(f"{number} {seed}"), experience, truth)
    loose = [bent(random.Random(f"bearings, no axiom {seed}"), 6) for seed in range(25)]
    loose += [random_experience(random.Random(f"no axiom {seed}"), 6) for seed in range(20)]
    for experience in [*BENT.values(), *cases[2:], *loose]:
        truth = Truth(experience, axiom=False)
        if len(truth.final) < 60:
            yield from shapes(experience, truth, "no_path_axiom")
            yield from exceptional(experience, truth, "no_path_axiom")
            draw = random.Random(experience.facts())
            yield from _asked(draw, experience, truth, "no_path_axiom")


def about(experience: Experience, truth: Truth) -> Iterator[Query]:
    """The same pairs of gateways in the other order, or in both; and a part of the experience."""
    facts = experience.facts()
    swapped = re.sub(r"straight\((\d+),(\d+),(\d+)\)", r"straight(\1,\3,\2)", facts)
    under = FORMS["paper"].relative_to(ENCODINGS)
    stated = [*beyond(facts), *["beyond/tolerance"] * bool(experience.tolerance)]
    told = tuple(str(under / name) for name in ("topomap", *stated))
    how = constants(experience)
    found = frozenset(((), ats(at)) for at in truth.final)
    # The gateways that end their path may be told, too.
    ends = "".join(
        f"straight({t},{s},{s}). "
        for t, (view, pairs) in enumerate(zip(experience.views, experience.straight, strict=False))
        for s in view - {slot for pair in pairs for slot in pair}
    )
    for text in (swapped, swapped + ends, swapped + facts):
        yield Query(("topomap",), text, found, how)
        yield Query(told, text, found, how)
    sided = frozenset(((), ats(at)) for at in truth.having("boundary"))
    yield Query(("topomap", "boundary"), swapped + ends, sided, how)
    best = truth.least(Hypothesis.cost, truth.final)
    best = frozenset((truth.final[at].cost(), ats(at)) for at in best)
    yield Query(("topomap", "minimal"), swapped + ends, best, (*how, "--opt-mode=optN"))
    horizon = experience.steps // 2
    cut = frozenset(((), ats(at)) for at in truth.levels[horizon])
    how = (*how, "-c", f"horizon={horizon}")
    for files in ("topomap",), told:
        yield Query(files, facts, cut, how)


def ats(at) -> frozenset[str]:
    """The atoms of a hypothesis."""
    return frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at))


def shapes(experience: Experience, truth: Truth, *more: str) -> Iterator[Query]:
    """All hypotheses, those of each part, and the best, of each form of the encodings that has
    what is told."""
    facts, how = experience.facts(), constants(experience)
    told = [*beyond(facts), *["beyond/tolerance"] * bool(experience.tolerance)]
    best = {"minimal": Hypothesis.cost, "genus": lambda h: (h.genus(),)}
    for part in ("", *PARTS, *best):
        parts = (part,) if part else ()
        if part in best:
            found = truth.least(best[part], truth.final)
            answers = frozenset((best[part](truth.final[at]), ats(at)) for at in found)
            options = (*how, "--opt-mode=optN")
        else:
            answers = frozenset(((), ats(at)) for at in truth.having(*parts))
            options = how
        for form in forms(*parts):
            if (form, part, bool(experience.straight)) == ("paper", "boundary", True):
                continue  # it has no left and right of paths whose gateways are given
            if form == "paper" and more and part in ("boundary", "perpendicular"):
                continue  # it states them of paths that do not come back
            under = FORMS[form].relative_to(ENCODINGS)
            mine = told if form == "paper" else ()
            files = [str(under / name) for name in ("topomap", *mine, *parts)]
            yield Query((*files, *more), facts, answers, options)
    bound = frozenset(((), ats(at)) for at in truth.having(bound=2))
    yield Query(("topomap", "bound", *more), facts, bound, (*how, "-c", "places=2"))


def exceptional(experience: Experience, truth: Truth, *more: str) -> Iterator[Query]:
    """The exceptions of each map, and the maps that are best with them."""
    facts, how = experience.facts(), constants(experience)
    under = FORMS["paper"].relative_to(ENCODINGS)
    stated = [*beyond(facts), *["beyond/tolerance"] * bool(experience.tolerance)]
    stated = [str(under / name) for name in ("topomap", *stated, "beyond/exceptions")]
    for parts in ((), ("minimal",), ("closed", "minimal")):
        closed = [*truth.having(*(part for part in parts if part == "closed"))]
        costs = {at: (h.worth() if parts else h.worth()[:1]) for at, h in truth.final.items()}
        options = (*how, "--opt-mode=enum,99,99,99") if parts else (*how, "--opt-mode=enum,99")
        named = frozenset((costs[at], ats(at) | exceptions_of(truth.final[at])) for at in closed)
        files = ("topomap", "exceptions", *parts, *more)
        yield Query(files, facts, named, options)
        least = min((costs[at] for at in closed), default=())
        best = frozenset(one for one in named if one[0] == least)
        yield Query(files, facts, best, (*how, "--opt-mode=optN"))
        if not experience.straight:
            files = (*stated, *(str(under / part) for part in parts), *more)
            plain = frozenset((costs[at], ats(at)) for at in closed)
            yield Query(files, facts, plain, options)
            best = frozenset((costs[at], ats(at)) for at in closed if costs[at] == least)
            yield Query(files, facts, best, (*how, "--opt-mode=optN"))
    costs = {at: (h.genus(), *h.worth()) for at, h in truth.final.items()}
    named = frozenset((costs[at], ats(at) | exceptions_of(h)) for at, h in truth.final.items())
    files = ("topomap", "genus", "exceptions", "minimal", *more)
    yield Query(files, facts, named, (*how, "--opt-mode=enum,99,99,99,99"))


def exceptions_of(h: Hypothesis) -> frozenset[str]:
    """The exceptions of a map as exceptions.lp names them: a path by its first run, or by its place
    and lower slot there if no step went along it."""
    named = named_paths(h)
    found = set()
    for (one, here), (other, there) in combinations(named, 2):
        if len({place for place, _ in here} & {place for place, _ in there}) > 1:
            first, second = sorted((int(one), int(other)))
            found.add(f"exception(meet_twice({first},{second}))")
    for name, path in named:
        if len({place for place, _ in path}) < len(path):
            found.add(f"exception(place_twice({name}))")
    for (name, _), (_, right, left) in zip(named, h.sides(), strict=True):
        found |= {f"exception(both_sides({name},{place}))" for place in right & left}
    return frozenset(found)


def named_paths(h: Hypothesis) -> list[tuple[str, list]]:
    """The paths, in their order, each with its name."""
    named = []
    for path in h.paths():
        ends = {*path} | {h.opposite(heading) for heading in path}
        steps = [
            t for t in range(1, len(h.at)) if isinstance(h.turns[t], int) and h.leaves(t) in ends
        ]
        place, slot = min(end for end in ends if not isinstance(end[1], str))
        name = str(min(steps)) if steps else f"bare({place},{slot})"
        named.append((name, path))
    return named


def off_or_bent() -> Iterator[Query]:
    """What a step may break where pairs of gateways are given, or bearings are not exact, and each
    visit sees as many gateways. Where visits of one place take other gateways to be on one path, it
    is not defined what a path is; so nothing but views is then broken, or no view is."""
    # The way back ends where two gateways are seen, and was one. (All else breaks more than that.)
    back = Experience(4, [[0], [0, 2], [0, 1]], [0, 0], tolerance=1)
    # No visit is of a place that a later one names.
    on = Experience(4, [[0, 2], [0]], [0], tolerance=1)
    facts = f"{on.facts()} :- waived(R), R != view(0,1)."
    found = shown("at(0,0,0)", "at(1,1,0)")
    yield Query(("topomap", "explain"), facts, found, (*constants(on), "--opt-mode=ignore"))
    for part in ("planar", "boundary", "no_path_axiom"):
        found = shown("at(0,0,0)", "at(1,1,0)", "at(2,0,0)", "waived(view(2,0))")
        how = (*constants(back), "--opt-mode=ignore")
        facts = f"{back.facts()} :- waived(R), R != view(2,0), R != view(0,2)."
        yield Query(("topomap", "explain", part), facts, found, how)
    for told in ({"apart": [(0, 2)]}, {"shifts": [(9, 0), (9, 0)]}, {"lengths": [100, 50]}):
        inexact = Experience(4, [[0], [0], [0]], [0, 0], tolerance=1, **told)
        yield from given_up_of(inexact, [Assignment(inexact, at) for at in assignments(inexact)])
    number = 0
    for seed in range(10_000):
        draw = random.Random(f"broken bent {seed}")
        experience = bent(draw, 3)
        if not experience.steps or len({*map(len, experience.views)}) > 1 or experience.slots > 8:
            continue
        if not (experience.straight or experience.tolerance):
            continue
        every = [Assignment(experience, at) for at in assignments(experience)]
        if len(every) > 400:
            continue
        yield from given_up_of(experience, every)
        number += 1
        if number == 60:
            return


def given_up_of(experience: Experience, every: list[Assignment]) -> Iterator[Query]:
    """All dstates without a wrong view, with what they break; those that break nothing else;
    and those that break nothing."""
    names = [*reasons(experience)]
    views = [name for name in names if name.startswith("view")]
    of_paths = ("twice", "crossed", "circular")
    safe = [name for name in names if name not in views and not name.startswith(of_paths)]
    sound, other, defined = set(), set(), True
    for one in every:
        wrong = {f"waived({name})" for name in names if one.broken(name)}
        of_views = {name for name in wrong if name.startswith("waived(view")}
        if not of_views:
            sound.add(((), ats(one.at) | wrong))
        odd = any(
            one.at[t][0] == one.at[u][0] and one.pairs(t) != one.pairs(u)
            for t, u in combinations(range(len(one.at)), 2)
        )
        if odd and not any(one.broken(name) for name in safe):
            defined = False
        if wrong == of_views:
            other.add(((), ats(one.at) | wrong))
    files, how = ("topomap", "explain"), (*constants(experience), "--opt-mode=ignore")
    facts = experience.facts()
    yield Query(files, f"{facts} :- waived(view(_,_)).", frozenset(sound), how)
    if defined:
        seen = "is_view(view(T,U)) :- waived(view(T,U)). :- waived(R), not is_view(R)."
        yield Query(files, f"{facts} {seen}", frozenset(other), how)
    right = frozenset(((), ats(at)) for at in Truth(experience).final)
    for parts, found in (((), right), (("planar",), None), (("boundary",), None)):
        if found is None:
            found = frozenset(((), ats(at)) for at in Truth(experience).having(*parts))
        yield Query((*files, *parts), f"{facts} :- waived(_).", found, how)
    free = frozenset(((), ats(at)) for at in Truth(experience, axiom=False).final)
    yield Query((*files, "no_path_axiom"), f"{facts} :- waived(_).", free, how)


def excused(experience: Experience, truth: Truth) -> Iterator[Query]:
    """All hypotheses, with what a part would give up of each, and nothing else is given up: two
    paths that meet twice, three that form a triangle, and places on both sides of a path."""
    twice, three, sides = {}, {}, {}
    for at, h in truth.final.items():
        paths = {name: frozenset(place for place, _ in path) for name, path in named_paths(h)}
        paths = {int(name): on for name, on in sorted(paths.items()) if name.isdecimal()}
        twice[at] = [
            f"{one},{other}"
            for one, other in combinations(sorted(paths), 2)
            if len(paths[one] & paths[other]) > 1
        ]
        three[at] = [
            f"{a},{b},{c}"
            for a, b, c in combinations(sorted(paths), 3)
            if paths[a] & paths[b] and paths[b] & paths[c] and paths[a] & paths[c]
            if not paths[a] & paths[b] & paths[c]
        ]
        sides[at] = [
            f"{name},{place}"
            for (name, _), (_, right, left) in zip(named_paths(h), h.sides(), strict=True)
            for place in right & left
            if name.isdecimal()
        ]
    for part, broken in (
        ("perpendicular", (("perpendicular(A,B)", twice), ("triangle(A,B,C)", three))),
        ("boundary", (("boundary(A,B)", twice), ("sides(A,P)", sides))),
    ):
        allowed = "".join(f" excused({term}) :- waived({term})." for term, _ in broken)
        found = frozenset(
            (
                (),
                ats(at).union(
                    f"waived({term.partition('(')[0]}({numbers}))"
                    for term, by_map in broken
                    for numbers in by_map[at]
                ),
            )
            for at in truth.final
        )
        facts = f"{experience.facts()} :- waived(R), not excused(R).{allowed} #defined excused/1."
        how = (*constants(experience), "--opt-mode=ignore")
        yield Query(("topomap", "explain", part), facts, found, how)


def waived(experience: Experience, parts: tuple[str, ...]) -> Iterator[Query]:
    """All dstates by step, with what they break; and those that break least."""
    pending = product(range(experience.steps + 1), range(experience.slots))
    every = [*reasons(experience), *(f"closed({p},{s})" for p, s in pending if parts)]
    found = []
    for at in assignments(experience):
        one = Assignment(experience, at)
        broken = [f"waived({reason})" for reason in every if one.broken(reason)]
        atoms = frozenset([*broken, *(f"at({t},{p},{s})" for t, (p, s) in enumerate(at))])
        found.append((len(broken), atoms))
    whatever = frozenset(((), atoms) for _, atoms in found)
    least = min(number for number, _ in found)
    best = frozenset(((number,), atoms) for number, atoms in found if number == least)
    files, how = ("topomap", "explain", *parts), constants(experience)
    yield Query(files, experience.facts(), whatever, (*how, "--opt-mode=ignore"))
    yield Query(files, experience.facts(), best, (*how, "--opt-mode=optN"))


def hypotheses(facts: str, arguments: tuple[str, ...], truth: Truth) -> Iterator[Query]:
    """What is asked of one experience, of each form of the encodings: all hypotheses, those
    of each part, what each costs, and the best."""

    def atoms(at):
        return frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at))

    def query(parts, found, *more, cost=lambda h: ()):
        answers = frozenset((cost(truth.final[at]), atoms(at)) for at in found)
        for form in forms(*parts):
            told = beyond(facts) if form == "paper" else ()
            under = FORMS[form].relative_to(ENCODINGS)
            files = tuple(str(under / part) for part in ("topomap", *told, *parts))
            yield Query(files, facts, answers, (*arguments, *more))

    def least(parts, cost, found):
        return query(parts, truth.least(cost, found), "--opt-mode=optN", cost=cost)

    def genus(h):
        return (h.genus(),)

    def fewest(h):
        return h.cost()

    def both(h):
        return (h.genus(), *h.cost())

    # What euler/1 and genus/1 are, too.
    figures = "#show euler/1. #show genus/1."
    answers = frozenset(
        ((), atoms(at) | {f"euler({h.euler()})", f"genus({h.genus()})"})
        for at, h in truth.final.items()
    )
    ignore = (*arguments, "--opt-mode=ignore")
    yield Query(("topomap", "genus"), facts + figures, answers, ignore)

    yield from query((), truth.final)
    for part in PARTS:
        yield from query((part,), truth.having(part))
    yield from query(("bound",), truth.having(bound=3), "-c", "places=3")
    yield from query(("genus", "minimal"), truth.final, "--opt-mode=enum,99", cost=both)
    yield from least(("minimal",), fewest, truth.final)
    yield from least(("boundary", "minimal"), fewest, truth.having("boundary"))
    yield from least(("genus",), genus, truth.final)
    yield from least(("genus", "minimal"), both, truth.final)


def circumscription() -> Iterator[Query]:
    """The names of the paths and places of each map; one map is given, and those are asked for that
    are preferred to it, or have the same paths and places; or it was passed."""
    draws = [random_experience(random.Random(f"circumscribe {seed}"), 8) for seed in range(40)]
    for experience in [*(EXPERIENCES | WORLDS).values(), *draws]:
        truth = Truth(experience)
        draw = random.Random(experience.facts())
        names = {at: h.names() for at, h in truth.final.items()}
        if not 1 < len(names) < 100:
            continue
        atoms = {
            at: [f"path,{kind}({','.join(map(str, n))})" for kind, *n in sorted(paths)]
            + [f"place,{place}" for place in sorted(places)]
            for at, (paths, places) in names.items()
        }

        def asked(facts, test, *steps, experience=experience, names=names, atoms=atoms):
            answers = frozenset(
                (
                    (),
                    frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at))
                    | {f"has({name})" for name in atoms[at]},
                )
                for at, mine in names.items()
                if test(*mine)
            )
            facts = experience.facts() + facts
            return Query(("topomap", "circumscribe"), facts, answers, (), steps, ("passed",))

        yield asked("", lambda paths, places: True)
        for at in draw.sample(sorted(names), min(4, len(names))):
            its, there = names[at]
            given = "".join(f"given({name})." for name in atoms[at])
            yield asked(
                f"prefer. {given}",
                lambda paths, places, its=its, there=there: (
                    paths < its or (paths == its and places < there)
                ),
            )
            yield asked(
                f"repeat. {given}",
                lambda paths, places, its=its, there=there: (paths, places) == (its, there),
            )
            yield asked(
                "",
                lambda paths, places, its=its, there=there: (
                    not (paths > its or (paths == its and places >= there))
                ),
                "".join(f"passed(7,{name})." for name in atoms[at]),
            )


def misread() -> Iterator[Query]:
    """Experiences with wrong views, with what brute force says of them."""
    drawn = [(corrupted(random.Random(f"misread {seed}"), 3), 1) for seed in range(16)]
    drawn += [(corrupted(random.Random(f"misread {seed}"), 2), 2) for seed in range(2)]
    named = [(EXPERIENCES[name], 1) for name in ("same", "lost", "added")]
    named.append((seen("1", "0: 0", "0: 0"), 1))  # and where it stood at first
    nothing = Experience(4, (frozenset(),), (), (frozenset(),))
    twice = Experience(4, [[0], [0, 1], [0, 1, 2], [0]], [0, None, 1], looks=[2])
    named += [(twice, 1), (KNOWN["compass"].cut(3), 1), (KNOWN["length"], 1), (TWO, 1)]
    named += [(KNOWN["odometry, just not"].cut(3), 1), (KNOWN["apart"].cut(3), 1)]
    for experience, most in [*drawn, *named, (CORNERS, 0), (nothing, 1)]:
        ways = list(brute(experience, most))
        for parts in ((), ("closed",), ("minimal",), ("genus", "minimal")):
            every = {
                cost: [key for key, other in found.items() if other == cost]
                for found in [expected(ways, parts)]
                for cost in found.values()
            }
            said = {cost: {wrong_atoms(*key) for key in keys} for cost, keys in every.items()}
            files = ("topomap", "noise", *parts)
            answers = frozenset((cost, atoms) for cost in said for atoms in said[cost])
            how = () if most == 1 else ("-c", f"noise={most}")
            how += constants(experience)
            yield Query(files, experience.facts(), answers, (*how, "--opt-mode=enum,999"))
            best = min(said, default=())
            answers = frozenset((best, atoms) for atoms in said.get(best, ()))
            yield Query(files, experience.facts(), answers, (*how, "--opt-mode=optN"))
        if ways and len(ways[0][1].final) < 20 and most == 1:
            yield figures(experience, ways)
            yield paths(experience, ways)


def figures(seen: Experience, ways) -> Query:
    """How many places, links, paths and pending gateways there are where views are wrong."""
    terms = {figure: NAMED.get(figure, figure) for figure in FIGURES if figure != "genus"}
    facts = seen.facts() + " ".join(f"ask(number({term},0..20))." for term in terms.values())
    answers = set()
    for (at, wrong), cost in expected(ways, ()).items():
        map_ = dict(ways)[wrong].final[at]
        told = {f"holds(number({terms[one]},{FIGURES[one](map_)}))" for one in terms}
        answers.add((cost, wrong_atoms(at, wrong) | told))
    arguments = ("--opt-mode=enum,999",)
    return Query(("topomap", "noise", "query"), facts, frozenset(answers), arguments)


def paths(seen: Experience, ways) -> Query:
    """Which gateways are on one path where views are wrong, so that some of them are not there."""
    gateways = [*product(range(min(seen.steps, 2) + 1), range(seen.slots))]
    every = [*product(gateways, repeat=2)]
    pairs = random.Random(seen.facts()).sample(every, min(40, len(every)))
    numbers = [(*one, *other) for one, other in pairs]
    answers = set()
    for (at, wrong), cost in expected(ways, ()).items():
        map_ = dict(ways)[wrong].final[at]
        on_one = [four for four in numbers if RELATIONS["path"](map_, *four)]
        told = {f"holds(path({','.join(map(str, four))}))" for four in on_one}
        answers.add((cost, wrong_atoms(at, wrong) | told))
    facts = seen.facts() + " ".join(f"ask(path({','.join(map(str, four))}))." for four in numbers)
    arguments = ("--opt-mode=enum,999",)
    return Query(("topomap", "noise", "query"), facts, frozenset(answers), arguments)


def wrong_atoms(at, misread) -> frozenset[str]:
    """What is shown of a hypothesis with misreadings."""
    atoms = {f"at({t},{p},{s})" for t, (p, s) in enumerate(at)}
    atoms |= {f"wrong({t})" for t, _ in misread}
    kinds = ((t, "gateway" if isinstance(what, int) else "landmark", what) for t, what in misread)
    return frozenset(atoms | {f"misread({t},{kind}({what}))" for t, kind, what in kinds})


def given_up() -> Iterator[Query]:
    """All dstates by step, with what they break; and those that break least."""
    names = "corners", "mirrored", "ahead", "branch", "loop", "lost", "added"
    for name, parts in [*((name, ()) for name in names), ("corners", ("closed",))]:
        yield from waived(EXPERIENCES[name].cut(3), parts)
    # Where a view is given up, a path may lead on by a gateway that was not seen.
    facts = (
        f"{seen('0 1', '0: 0 1', '1: 0').facts()} :- waived(R), R != view(2,0). :- not at(2,0,3)."
    )
    found = shown("at(0,0,0)", "at(1,1,0)", "at(2,0,3)", "waived(view(2,0))")
    yield Query(("topomap", "explain", "travelled"), facts, found, ("--opt-mode=ignore",))
    # If nothing may be given up, the maps of each part are left.
    for name in ("lens", "corners", "triangle"):
        experience = EXPERIENCES[name].cut(6)
        truth = Truth(experience)
        for part in PARTS:
            found = {
                ((), frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at)))
                for at in truth.having(part)
            }
            facts = f"{experience.facts()} :- waived(_)."
            how = ("--opt-mode=ignore",)
            yield Query(("topomap", "explain", part), facts, frozenset(found), how)
        yield from excused(experience, truth)
    for seed in BITING:
        experience = random_experience(random.Random(f"biting {seed}"), 14).cut(6)
        yield from excused(experience, Truth(experience))


def phases() -> Iterator[Query]:
    """The programs of the phases: which visits can be of one place; which runs can lie on one
    path or cross; the closed and perpendicular maps; and the hypotheses that are left by what
    was found."""
    experiences = [*(EXPERIENCES | WORLDS).values()]
    experiences += WALKS
    experiences += [random_experience(random.Random(f"corpus {seed}"), 8) for seed in range(60)]
    for experience in experiences:
        yield from phased(experience)
    # No map is left where a visit is said to be apart from itself.
    for experience in (seen("0", "0: 0"), EXPERIENCES["round"]):
        facts = experience.facts() + "phases. "
        facts += "".join(f"{atom}. " for atom in phase_answers.Pairs(experience).shown())
        facts += phase_answers.text([("apart", experience.steps, experience.steps, 0)])
        for entry in ("phases/topomap", "phases/lines"):
            yield Query((entry,), facts, frozenset(), ("--project",))


def phased(experience: Experience) -> Iterator[Query]:
    """That of one experience."""
    facts = experience.facts() + "phases. "
    draw = random.Random(facts)
    pairs = phase_answers.Pairs(experience)
    yield Query(("phases/visits",), facts, shown(*pairs.shown()))
    facts += "".join(f"{atom}. " for atom in pairs.shown())
    truth = Truth(experience)
    yield left(facts, experience, truth, [])
    yield left(facts, experience, truth, [], "boundary")
    yield left(facts, experience, truth, [], "phases/earlier")
    yield begun(facts, experience, pairs, draw.randint(0, experience.steps))
    founds = [[]]
    if truth.final:
        at = draw.choice(sorted(truth.final))
        few, many, every = (
            phase_answers.drawn(draw, experience, at, rate) for rate in (0.1, 0.4, 1)
        )
        # Which visits are new, so that the order of the gateways is known too.
        news = [fact for fact in every if fact[0] in ("new", "old")]
        founds += [few, many, news]
        yield left(facts, experience, truth, few, "planar")
        yield left(facts, experience, truth, many, "closed", "perpendicular")
        yield left(facts, experience, truth, news, "planar")
    for found in founds * (experience.slots == 4):
        yield lines(facts, experience, truth, found)
        if (ways := phase_answers.runs(experience, found)) is not None:
            answers = frozenset(((), way) for way in ways)
            file = ("phases/runs",)
            yield Query(file, facts + phase_answers.text(found), answers, ("--project",))


def biting() -> Iterator[Query]:
    """Experiences for which each demand leaves out some hypotheses: at once, in phases, step by
    step; statements; and what is wrong with what is left out."""
    for number, seed in enumerate(BITING):
        experience = random_experience(random.Random(f"biting {seed}"), 14)
        truth, loose = Truth(experience), Truth(experience, axiom=False)
        for part in ("planar", "boundary", "perpendicular"):
            assert len(truth.having(part)) < len(truth.final) < len(loose.final)
        yield from hypotheses(experience.facts(), (), truth)
        yield from exceptional(experience, truth)
        yield from phased(experience)
        for kind in range(3):
            yield from followed(3 * number + kind, experience)
        draw = random.Random(f"biting {number}")
        yield from _asked(draw, experience, truth)
        few = sorted(loose.final) if len(loose.final) < 60 else []
        if few:
            yield from followed(number, experience, "no_path_axiom")
            yield from _asked(draw, experience, loose, "no_path_axiom")
        for told in enumerated(draw.sample(few, min(8, len(few)))):
            yield from judged(experience, told, DEMANDS, (*DEMANDS, NO_PATH_AXIOM))


def lines(facts: str, experience: Experience, truth: Truth, found: list) -> Query:
    """What is asked of closed and perpendicular maps where something was found."""
    of_pairs = [fact for fact in found if fact[0] in ("new", "never", "apart")]
    squares = truth.having("closed", "perpendicular")
    maps = [at for at in squares if phase_answers.so(of_pairs, experience, at)]
    facts += phase_answers.text(found)
    return Query(("phases/lines",), facts, phase_answers.lines(experience, maps), ("--project",))


def squares() -> Iterator[Query]:
    """More of that."""
    for experience in [*SQUARES, UNTRIED]:
        facts = experience.facts() + "phases. "
        facts += "".join(f"{atom}. " for atom in phase_answers.Pairs(experience).shown())
        yield lines(facts, experience, Truth(experience), [])


def left(facts: str, experience: Experience, truth: Truth, found: list, *parts: str) -> Query:
    """What is asked where something was found: the hypotheses in which it is so."""
    answers = frozenset(
        ((), frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at)))
        for at in truth.having(*(part for part in parts if part != "phases/earlier"))
        if phase_answers.so(found, experience, at)
    )
    files = ("phases/topomap", *parts)
    return Query(files, facts + phase_answers.text(found), answers)


def ends() -> Iterator[Query]:
    """As many gateways as ends of links: that is to say, the closed maps."""
    files = "phases/topomap", "phases/ends"
    draws = [random_experience(random.Random(f"ends {seed}"), 8) for seed in range(20)]
    for experience in [*(EXPERIENCES | WORLDS).values(), *draws]:
        truth = Truth(experience)
        facts = experience.facts() + "phases. "
        facts += "".join(f"{atom}. " for atom in phase_answers.Pairs(experience).shown())
        asked = left(facts, experience, truth, [], "closed")
        yield replace(asked, files=files, arguments=("--eq=0",))


def begun(facts: str, experience: Experience, pairs: phase_answers.Pairs, horizon: int) -> Query:
    """What is asked of a beginning: its hypotheses, except for those which take visits to be of
    one place that the whole separates."""
    answers = frozenset(
        ((), frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at)))
        for at in Truth(experience.cut(horizon)).final
        if pairs.may.issuperset(phase_answers.same(at, experience.slots))
    )
    return Query(("phases/topomap",), facts, answers, ("-c", f"horizon={horizon}"))


def sizes() -> list[Query]:
    """What the size of the encodings is taken by: every other named experience with all the parts,
    one in eight where rules may be waived, some of what is asked of the phases and step by step;
    first of all, a large exploration in which it is known which visits are new; and last, what is
    told besides views, where the exploration is cut, without the path axiom, of one part, and
    what is asked of runs, of which few queries are large."""
    files = ("topomap", "bound", "query", *PARTS, "genus", "minimal")
    many = ("-c", "places=99")
    waived = ("topomap", "explain", "perpendicular")
    named = (EXPERIENCES | WORLDS).values()
    whole = [Query(files, seen.facts(), frozenset(), many) for seen in [*named][::2]]
    whole += [Query(waived, seen.facts(), frozenset()) for seen in [*named][::8]]
    phases = [query for query in queries() if query.files[0].startswith("phases/")]
    made = grid(5, 5)
    route = [EAST, WEST] * 2 + snake(made)
    experience, truth = observe(made.map, ((0, 0), EAST), route)
    found = phase_answers.drawn(random.Random(0), experience, truth, 1)
    known = phase_answers.text(fact for fact in found if fact[0] in ("new", "old"))
    pairs = "".join(f"{atom}. " for atom in phase_answers.Pairs(experience).shown())
    large = experience.facts() + "phases. " + pairs + known
    plane = Query(("phases/topomap", "planar"), large, frozenset())
    more = []
    kinds = "odometry, a gap", "length, unlike", "length, just not", "same", "apart", "compass"
    known = [KNOWN[name] for name in kinds]
    kinds = "a look with odometry", "a second look", "three dead ends", "coin and rope"
    several = [LOGS[name] for name in kinds]
    off = BENT["one slot off"], replace(ROUND, tolerance=1), replace(THERE, tolerance=1)
    statement = "ask(path(0,0,1,0)). ask(number(exception,0)). ask(number(path,0))."
    for told in (*known, *several, *off, BENT["paths that bend"], EXPERIENCES["lens"]):
        how = constants(told)
        cut = (*how, "-c", "horizon=1")
        less = told.cut(min(2, told.steps)).facts()
        more += [Query(files, told.facts(), frozenset(), (*many, *how))]
        more += [Query(files, told.facts(), frozenset(), (*many, *cut))]
        more += [Query((*files, "no_path_axiom"), told.facts(), frozenset(), (*many, *how))]
        more += [Query(waived, less, frozenset(), how)]
        more += [Query(files, turned(told), frozenset(), (*many, *cut))]
        for facts in turned(told), told.facts() + statement:
            more += [Query(("topomap", "query"), facts, frozenset(), how)]
        more += [Query(("topomap", "query", "no_path_axiom"), told.facts(), frozenset(), how)]
    told = EXPERIENCES["stages"]
    more += [Query(("topomap", "euler"), told.facts(), frozenset())]
    more += [Query(("topomap", "query"), told.facts() + " ask(boundary).", frozenset())]
    more += judged(told, next(enumerated(sorted(Truth(told).final))), DEMANDS)
    of_runs = [query for query in phases if query.files[0] == "phases/runs"]
    return [plane, *whole, *phases[::40], *[*following()][::20], *more, *of_runs[::20]]


def check() -> Iterator[Query]:
    """Maps, sound and with errors, with the violations that are there by definition. What a
    broken step does to the map as a whole is not defined, so a map with one is asked only
    where both checkers say the same."""
    alone = ("boundary", "perpendicular", "travelled")
    for experience, at in [*by_hand(), *drawn(120), *contradicting(80), *coming_back(80)]:
        yield from judged(experience, at, DEMANDS, (), (*alone, NO_PATH_AXIOM))


def check_bent() -> Iterator[Query]:
    """The same where pairs of gateways are given, or bearings are not exact."""
    alone = ("boundary", NO_PATH_AXIOM)
    for experience, at in bent_maps(160):
        yield from judged(experience, at, DEMANDS, (*DEMANDS, NO_PATH_AXIOM), alone, ())


def borders() -> Iterator[Query]:
    """Maps of what is seen, where more is known: what the checker says of them."""
    wide = ("-c", f"tolerance={LARGEST}")
    for experience in BENT.values():
        if experience.tolerance:
            any_bearings = replace(experience, tolerance=experience.slots)
            found = frozenset(((), ats(at)) for at in Truth(any_bearings).final)
            facts = experience.facts()
            told = *beyond(facts), "beyond/tolerance"
            paper = tuple(f"paper/{name}" for name in ("topomap", *told))
            for files in (("topomap",), paper):
                if "straight" not in facts:
                    yield Query(files, facts, found, wide)
                    # Three times this does not fit into a number of clingo's, either.
                    yield Query(files, facts, found, ("-c", f"tolerance={2 * LARGEST // 3 + 1}"))
            maps = [*enumerated(Truth(any_bearings).final), [(0, 0, 0), (1, 1, 0), (2, 2, 0)]]
            for told in maps:
                for query in judged(any_bearings, told, ()):
                    yield replace(query, arguments=wide)
    for experience in [*KNOWN.values(), *LOGS.values(), *BENT.values()]:
        less = replace(experience, compass=(), shifts=(), lengths=(), same=(), apart=(), things=())
        less = replace(less, straight=(), tolerance=2 * less.tolerance)
        found = sorted(Truth(less).final)
        facts = experience.facts()
        some = random.Random(experience.facts()).sample(found, min(12, len(found)))
        for told in enumerated(some):
            for query in judged(experience, told, ()):
                yield query
                yield replace(query, facts=query.facts.replace(facts, turned(experience)))


# Two gateways that are a slot apart, seen a slot off: the one is where the other is expected.
SHIFTED = Experience(
    *(12, [[0, 3, 4], [0], [0, 4, 5], [0], [0, 1, 9], [0]], [0, 0, 4, 0, 1]),
    lengths=(None, None, 100, 100, 50),
    tolerance=1,
)
EARS = EXPERIENCES["ears"]


def stated() -> Iterator[Query]:
    """What the statement of the paper says of what lies beyond it: where several logs are planar,
    where the exploration is cut, and where bearings of links with lengths are not exact."""
    several = [
        Experience(4, [*EARS.views, [0]], [*EARS.turns, None], starts=[7]),
        *(rested(EARS, step, "starts") for step in (3, 4, 5)),
        *(logs(random.Random(f"stated {seed}"), 9) for seed in range(60)),
    ]
    for experience in several:
        truth = Truth(experience)
        if len(truth.final) < 400:
            yield told_in_paper(experience, truth.having("planar"), "planar")
    for experience in [SHIFTED, *KNOWN.values(), *LOGS.values()]:
        yield told_in_paper(experience, Truth(experience).final)
        yield told_in_paper(experience, Truth(experience).having("planar"), "planar")
        for horizon in range(1, experience.steps):
            found = Truth(experience).levels[horizon]
            yield told_in_paper(experience, found, more=("-c", f"horizon={horizon}"))


def told_in_paper(experience: Experience, found, *parts: str, more=()) -> Query:
    """The statement of the paper, with the files for what is known of an experience."""
    facts = experience.facts()
    told = [*beyond(facts), *["beyond/tolerance"] * bool(experience.tolerance)]
    files = tuple(f"paper/{name}" for name in ("topomap", *told, *parts))
    answers = frozenset(((), ats(at)) for at in found)
    return Query(files, facts, answers, (*constants(experience), *more))


def enumerated(maps: Iterable) -> Iterator[list[tuple[int, int, int]]]:
    """Hypotheses as they are judged: step, place and gateway."""
    for at in maps:
        yield [(step, *dstate) for step, dstate in enumerate(at)]


def judged(experience: Experience, at: list, *every: tuple[str, ...]) -> Iterator[Query]:
    """What is wrong with a map where this is demanded."""
    for demands in every:
        violations = by_definition(experience, at, demands)
        broken = STEP_RULES & dict(violations).keys()
        if broken and by_rules(experience, at, demands) != violations:
            continue
        facts = [f"at({step},{place},{slot})." for step, place, slot in at]
        facts += [f"demand({demand})." for demand in demands]
        found = shown(*(f"violation({rule},{step})" for rule, step in violations))
        told = experience.facts() + "".join(facts)
        yield Query(("check",), told, found, constants(experience))


def demands() -> Iterator[Query]:
    """Demands that are known, and others; and no map, or nothing at all."""
    nowhere = "violation(exactly_one,0)"
    yield Query(("check",), "", shown(nowhere))
    yield Query(("check",), "slots(4). demand(plan).", shown(nowhere, "violation(plan,0)"))
    facts = "slots(4). view(0,0). view(1,0). turn(1,0). at(0,0,0). at(1,1,0). "
    sound = ("planar", "closed", "travelled", "boundary", "perpendicular", NO_PATH_AXIOM)
    for demand in (*sound, "bound(2)", "bound(2147483647)"):
        yield Query(("check",), f"{facts} demand({demand}).", shown())
    for demand in ("plannar", "bound", "bound(a)", "bound(#inf)", '"closed"', "2"):
        yield Query(("check",), f"{facts} demand({demand}).", shown(f"violation({demand},1)"))
    for fact, breaks in (("", True), (" no_path_axiom.", False)):
        told = (
            "slots(4). view(0,0). view(0,1). turn(1,0). view(1,0). view(1,3). at(0,0,0). at(1,0,1)."
        )
        yield Query(("check",), told + fact, shown(*["violation(path_twice,1)"] * breaks))

    # Two circular paths meet at the one place that there is.
    crossing = seen("0 1 2 3", "0: 0 1 2 3", "3: 0 1 2 3")
    yield from judged(crossing, [(0, 0, 0), (1, 0, 2), (2, 0, 3)], ("boundary", NO_PATH_AXIOM))


def faults() -> Iterator[Query]:
    """Instances with faults."""
    for facts, errors in INSTANCES.items():
        yield Query(("input",), facts, shown(*(f"error({error})" for error in errors.split())))
    for facts, told, errors in WITH_NUMBERS:
        how = tuple(word for one in told.split() for word in ("-c", one))
        yield Query(("input",), facts, shown(*(f"error({error})" for error in errors.split())), how)


COMPARED = {"number": int.__eq__, "least": int.__ge__, "most": int.__le__}
NAMED = {"places": "place", "paths": "path", "links": "link", "exceptions": "exception"}


def asked() -> Iterator[Query]:
    """Statements, and of each hypothesis those that hold in it."""
    draws = [random_experience(random.Random(f"asked {seed}"), 9) for seed in range(60)]
    for experience in [*(EXPERIENCES | WORLDS).values(), *draws]:
        truth = Truth(experience)
        draw = random.Random(experience.facts())
        for _ in range(3 if len(truth.final) < 100 else 0):
            yield from _asked(draw, experience, truth)
    for seed in range(60):
        draw = random.Random(f"asked without the path axiom {seed}")
        experience = random_experience(draw, draw.choice([4, 5, 6, 7]))
        truth = Truth(experience, axiom=False)
        if len(truth.final) < 100:
            yield from _asked(draw, experience, truth, "no_path_axiom")
    yield from statements(CORRIDOR, Truth(CORRIDOR), {})
    # Each by itself, as another one may ground what it needs.
    draws = [random_experience(random.Random(f"biting {seed}"), 14) for seed in BITING[::3]]
    draws += [EXPERIENCES[name] for name in ("lens", "fork", "ahead", "loop", "star")]
    for experience in draws:
        for more in (), ("no_path_axiom",):
            truth = Truth(experience, axiom=not more)
            if len(truth.final) < 100:
                yield from single(experience, truth, *more)


def single(experience: Experience, truth: Truth, *more: str) -> Iterator[Query]:
    """Each quality, and each figure compared with its least and its greatest number."""
    for name, test in QUALITIES.items():
        yield from statements(experience, truth, {name: test}, *more)
    for name, figure in FIGURES.items():
        numbers = sorted({figure(h) for h in truth.final.values()})
        for number in {*numbers[:1], *numbers[-1:]}:
            for how, compare in COMPARED.items():
                term = f"{how}({NAMED.get(name, name)},{number})"
                tests = {term: partial(_compared, figure, compare, number)}
                yield from statements(experience, truth, tests, *more)


def _asked(
    draw: random.Random, experience: Experience, truth: Truth, *more: str
) -> Iterator[Query]:
    """Some statements."""
    tests = {}
    for kind in draw.choices([*RELATIONS], k=8):
        numbers = relation(draw, experience, kind)
        tests[f"{kind}({','.join(map(str, numbers))})"] = partial(_so, RELATIONS[kind], numbers)
    for figure in draw.sample([*FIGURES], 2):
        for how in draw.choices([*COMPARED], k=3):
            number = draw.randint(0, experience.steps + 2)
            term = f"{how}({NAMED.get(figure, figure)},{number})"
            tests[term] = partial(_compared, FIGURES[figure], COMPARED[how], number)
    for name in draw.sample([*QUALITIES], 1):
        tests[name] = QUALITIES[name]
    yield from statements(experience, truth, tests, *more)
    yield from statements(experience, truth, {"boundary": PROPERTIES["boundary"]}, *more)
    figure = draw.choice(["paths", "exceptions"])  # that it is asked for by itself grounds enough
    number = FIGURES[figure](draw.choice([*truth.final.values()])) if truth.final else 1
    term, test = f"number({NAMED[figure]},{number})", COMPARED["number"]
    alone = {term: partial(_compared, FIGURES[figure], test, number)}
    yield from statements(experience, truth, alone, *more)
    name = draw.choice(["circular", "meets_twice"])
    yield from statements(experience, truth, {name: QUALITIES[name]}, *more)


def statements(
    experience: Experience,
    truth: Truth,
    tests: dict[str, Callable[[Hypothesis], bool]],
    *more: str,
) -> Iterator[Query]:
    """Statements, each with its truth value in a hypothesis, for each hypothesis."""
    answers = set()
    for at, h in truth.final.items():
        atoms = {f"at({t},{p},{s})" for t, (p, s) in enumerate(at)}
        atoms |= {f"holds({term})" for term, test in tests.items() if test(h)}
        answers.add(((), frozenset(atoms)))
    facts = experience.facts() + "".join(f"ask({term})." for term in tests)
    files, how = ("topomap", "query", *more), constants(experience)
    yield Query(files, facts, frozenset(answers), how)


def _so(test: Callable[..., bool], numbers: list[int], h: Hypothesis) -> bool:
    return test(h, *numbers)


def _compared(
    figure: Callable[[Hypothesis], int], compare: Callable[..., bool], number: int, h: Hypothesis
) -> bool:
    return compare(figure(h), number)


def further() -> Iterator[Query]:
    """Where to go next, and why not: maps of one world, and hypotheses of one experience."""
    for seed in range(200):
        draw = random.Random(f"further {seed}")
        n = draw.choice([1, 2, 3, 4])
        carried = n in (2, 3) and draw.random() < 0.5
        if seed % 4:
            _, among = walks.scattered(draw, 3)
            out = draw.random() < 0.3
            among = [numbered(draw, one, out and draw.random() < 0.7) for one in among]
            facts = bare(among)
        else:
            experience, found = signed(draw) if seed % 8 else walks.drawn(draw, 3, 6)
            facts, among = of_one(experience, found)
        yield from planned(facts, among, n, carried, draw.choice([1, 2]))
        for pairs in (None, [(0, 1)])[: len(among)]:
            yield proved(facts, among, carried and seed % 4 > 0, pairs)
    for draw, among in rings():
        carried = draw.random() < 0.8
        yield from planned(bare(among), among, draw.randint(1, 4), carried, 1)
        yield proved(bare(among), among, carried, None)
    yield from planned(bare(among), among, None, False, 1)
    among = [crossings(ways) for ways in TWO_MARKERS]
    yield from planned(bare(among), among, 3, True, 1)
    ends = {(0, 1): (1, 3), (1, 3): (0, 1)}
    less = Standing(world(4, ends), (0, 1))
    more = Standing(world(4, ends | {(1, 1): (2, 3), (2, 3): (1, 1)}), (0, 1))
    for among in ([less, more], [more, less]):
        yield from planned(bare(among), among, 1, False, 1)
        yield proved(bare(among), among, False, None)


def of_one(experience: Experience, found: list) -> tuple[str, list[Standing]]:
    """Hypotheses of one experience, as facts, and where the agent stands in each."""
    facts = experience.facts()
    for number, at in enumerate(found):
        facts += "".join(f"map({number},{t},{p},{s}). " for t, (p, s) in enumerate(at))
    return facts, [walks.standing(experience, at) for at in found]


def further_bent() -> Iterator[Query]:
    """The same of maps in which pairs of gateways are given, in which there is a compass, and in
    which markers lie that have names."""
    for seed in range(90):
        draw = random.Random(f"further bent {seed}")
        if seed % 3:
            _, among = walks.scattered(draw, 3)
            among = [numbered(draw, one, False) for one in walks.bent(draw, among)]
            facts = bare(among)
        else:
            experience, found = walks.drawn_bent(draw, 3, 6) if seed < 70 else lying(draw)
            if seed % 2 and experience.compass:  # not at each visit
                known = [slot if draw.random() < 0.8 else None for slot in experience.compass]
                experience = replace(experience, compass=known)
            facts, among = of_one(experience, found)
        yield from planned(facts, among, draw.choice([1, 2]), False, 1)
        yield proved(facts, among, False, None)
    for seed in (50, 262, 1299):  # a marker that was taken up would tell the maps apart
        draw = random.Random(f"taken up {seed}")
        experience = logs(draw, 7)
        facts, among = of_one(experience, sorted(Truth(experience).final))
        yield from planned(facts, among, draw.choice([1, 2]), False, 1)
        yield proved(facts, among, False, None)


# Two markers would tell these three by three steps, and one does not.
TWO_MARKERS = (
    {(0, 1): (0, 2), (0, 3): (0, 0)},
    {(0, 1): (1, 0), (1, 1): (2, 0), (2, 1): (2, 2)},
    {(0, 1): (1, 0), (1, 1): (2, 0), (2, 1): (3, 0)},
)


def crossings(ways: dict) -> Standing:
    """A map of places with four gateways each."""
    links = ways | {there: here for here, there in ways.items()}
    stars = {place: frozenset(range(4)) for place, _ in links}
    return Standing(TopologicalMap(4, stars, links), (0, 0))


def signed(draw: random.Random) -> tuple[Experience, list]:
    """Hypotheses of an experience with landmarks."""
    while True:
        experience, found = walks.drawn(draw, 3, 8)
        if any(experience.landmarks) and len(found) > 1:
            return experience, found


def lying(draw: random.Random) -> tuple[Experience, list]:
    """Hypotheses of an experience with markers that have names, and were taken up now and then."""
    while True:
        experience = logs(draw, 7)
        found = sorted(Truth(experience).final)
        picks = any(kind == "pick" for kind, *_ in experience.things)
        if len(found) > 1 and experience.things and (picks or draw.random() < 0.2):
            return experience, draw.sample(found, min(3, len(found)))


def rings() -> Iterator[tuple[random.Random, list[Standing]]]:
    """Maps that only a marker or a sign distinguishes: rings of some places, of
    which each may have a dead end beside it."""
    for seed in range(60):
        draw = random.Random(f"rings {seed}")
        ends = draw.random() < 0.5
        among = []
        for size in draw.sample(range(1, 5), draw.choice([2, 2, 3])):
            links = {(place, 1): ((place + 1) % size, 3) for place in range(size)}
            if ends:
                links |= {(place, 0): (size + place, 2) for place in range(size)}
            made = world(4, links | {there: here for here, there in links.items()})
            start = (size, 2) if ends else (0, 1)
            if seed % 5 == 1 and ends and size > 1:  # the first place has no dead end
                kept = {a: b for a, b in links.items() if a != (size - 1, 0)}
                made = world(4, kept | {there: here for here, there in kept.items()})
            if seed % 5 == 0:
                others = [place for place in made.stars if place != start[0]]
                made = replace(made, landmarks={place: {"a"} for place in others[-1:]})
            among.append(Standing(made, start))
        yield draw, among


def numbered(draw: random.Random, one: Standing, out: bool) -> Standing:
    """The same with numbers for places; if the marker is out, it lies where it is not seen."""
    number = {place: count for count, place in enumerate(one.world.stars)}
    stars = {number[place]: star for place, star in one.world.stars.items()}
    links = {(number[p], s): (number[q], x) for (p, s), (q, x) in one.world.links.items()}
    signs = {number[place]: terms for place, terms in one.world.landmarks.items()}
    across = one.world.across
    if across is not None:
        across = {(number[p], s): (number[q], x) for (p, s), (q, x) in across.items()}
    world = replace(one.world, stars=stars, links=links, landmarks=signs, across=across)
    dstate = number[one.dstate[0]], one.dstate[1]
    elsewhere = [place for place in stars if place != dstate[0]]
    north = {number[place]: slot for place, slot in one.compass.items()}
    return Standing(world, dstate, draw.choice(elsewhere) if out and elsewhere else None, north)


def bare(among: list[Standing]) -> str:
    """The maps as facts of their own."""
    facts = f"slots({among[0].world.slots}). "
    for number, one in enumerate(among):
        for place, slot in one.world.gateways():
            facts += f"map_gateway({number},{place},{slot}). "
        for (place, slot), (other, at) in one.world.links.items():
            facts += f"map_link({number},{place},{slot},{other},{at}). "
        for place, terms in one.world.landmarks.items():
            facts += "".join(f"map_sign({number},{place},{term}). " for term in terms)
        facts += "".join(f"map_compass({number},{p},{s}). " for p, s in one.compass.items())
        for (place, slot), (_, other) in (one.world.across or {}).items():
            facts += f"map_pair({number},{place},{slot},{other}). "
        facts += "map_stands({},{},{}). ".format(number, *one.dstate)
        facts += f"map_marker({number},{one.marker}). " if one.marker is not None else ""
    return facts


def planned(
    facts: str, among: list[Standing], n: int | None, carried: bool, most: int
) -> Iterator[Query]:
    """The best walks of at most n steps (6 without a number), where a map stands for up to
    ``most`` maps."""
    weights = [1 + number % most for number in range(len(among))]
    options = ("--opt-mode=optN",) if n is None else ("--opt-mode=optN", "-c", f"n={n}")
    n = 6 if n is None else n
    facts += "carried. " * carried
    carried = carried and all(one.marker is None for one in among)
    out_of: list = []
    tells: list = []
    for walk, drop, pairs, out in walks.every(among, n, carried):
        left = max(
            sum(w for j, w in enumerate(weights) if (min(i, j), max(i, j)) not in pairs)
            for i in range(len(among))
        )
        missed = sum(w for j, w in enumerate(weights) if j not in out)
        rest = [len(walk), *[int(drop is not None)] * carried, *walk, *[0] * (n - len(walk))]
        rest += [drop or 0] * carried
        tells.append((left, *rest, walk, drop))
        out_of.append((missed, *rest, walk, drop))
    for file, costs in (("explore", tells), ("unseen", out_of)):
        *cost, walk, drop = min(costs, key=lambda one: one[:-2])
        atoms = [f"go({step},{turn})" for step, turn in enumerate(walk, 1)]
        atoms += [f"drop({drop})"] if drop is not None else []
        sizes = "".join(f"size({i},{w}). " for i, w in enumerate(weights) if w > 1)
        yield Query((file,), facts + sizes, frozenset({(tuple(cost), frozenset(atoms))}), options)


def proved(facts: str, among: list[Standing], carried: bool, pairs: list | None) -> Query:
    """Which maps no walk tells apart, with the proof."""
    facts += "carried. " * carried
    carried = carried and all(one.marker is None for one in among)
    atoms = []
    for i, j in pairs or combinations(range(len(among)), 2):
        one, other = among[i], among[j]
        reached, alike = walks.related(one, other, carried)
        if not alike:
            continue
        ends = set()
        for (place, slot), (image, at), lies in reached:
            where = ",".join("nowhere" if place is None else str(place) for place in lies)
            atoms.append(f"related({i},{j},({place},{slot}),({image},{at}),({where}))")
            ends |= {(1, place), (2, image)}
        opened = [
            f"open({i},{j},{side},{place},{slot})"
            for side, world in ((1, one.world), (2, other.world))
            for place, slot in world.pending()
            if (side, place) in ends
        ]
        atoms += [*opened, f"{'alike_so_far' if opened else 'bisimilar'}({i},{j})"]
    facts += "".join(f"compare({i},{j}). " for i, j in pairs or ())
    return Query(("bisimilar",), facts, shown(*atoms))


def following() -> Iterator[Query]:
    """Experiences step by step: all hypotheses, the planar ones, those of few places, what
    they cost, the best closed ones, and which visits are of one place. Steps that lead
    elsewhere are taken back."""
    draws = [random_experience(random.Random(f"following {seed}"), 9) for seed in range(40)]
    draws += [random_experience(random.Random(f"marked {seed}"), 9, True) for seed in range(24)]
    draws += [EXPERIENCES["taken back"]]
    # Of several logs it is not followed what is planar.
    head, *steps = TWO.facts().splitlines()
    yield Query(("online",), f"online. {head}", frozenset(), (), tuple(steps), ("step", "planar"))
    back = (
        "slots(4).",
        "view(0,0).",
        "start(1). view(1,0).",
        "1",
        "after(2,0). turn(2,0). view(2,0).",
    )
    head, *steps = back
    found, how = shown("at(0,0,0)", "at(2,2,0)"), ("--project", "--opt-mode=ignore")
    yield Query(("online",), f"online. {head}", found, how, tuple(steps), ("step", "planar"))
    draws += [informed(random.Random(f"following known {seed}"), 6) for seed in range(20)]
    draws += [logs(random.Random(f"following logs {seed}"), 5) for seed in range(20)]
    for number, experience in enumerate([*(EXPERIENCES | WORLDS).values(), *draws]):
        yield from followed(number, experience)
    # All that may be asked of what is told besides views, and of what was made for one rule.
    made = "three pieces", "the middle first", "the middle last", "a circle in pieces"
    made += "a circle from both sides", "taken back", "marker", "no marker", "taken", "triangle"
    for experience in [*KNOWN.values(), *LOGS.values(), *(EXPERIENCES[name] for name in made)]:
        for number in range(6):
            yield from followed(number, experience)


def following_bent() -> Iterator[Query]:
    """The same of experiences where pairs of gateways are given, and without the path axiom."""
    draws = [bent(random.Random(f"following bent {seed}"), 7) for seed in range(90)]
    draws = [one for one in draws if one.straight and not one.tolerance]
    draws += [one for one in BENT.values() if one.straight]
    for number, experience in enumerate(draws):
        yield from followed(number, experience)
        yield from followed(number + 1, experience, "no_path_axiom")
    for seed in range(40):
        experience = random_experience(random.Random(f"following, no axiom {seed}"), 6)
        yield from followed(seed, experience, "no_path_axiom")


def followed(number: int, experience: Experience, *loaded: str) -> Iterator[Query]:
    """Some of that, by the number."""
    truth = Truth(experience, axiom=not loaded)
    head, *lines = experience.facts().splitlines()
    head = f"online. {'straight_told. ' * bool(experience.straight)}{head}"
    head += " step(0)." * bool(loaded)
    names, steps = list(range(len(lines))), tuple(lines)
    if number % 2:
        names, steps = astray(random.Random(f"astray {number}"), experience)

    def atoms(at, names=names):
        return frozenset(f"at({names[t]},{names[p]},{s})" for t, (p, s) in enumerate(at))

    all_ = ("--project", *constants(experience))

    def asked(found, *more, parts=(), arguments=(), facts=head, steps=steps, all_=all_):
        how = (*all_, *arguments)
        files = ("online", *more, *loaded)
        return Query(files, facts, frozenset(found), how, steps, ("step", *parts))

    every, ignore = truth.final, ("--opt-mode=ignore",)
    yield asked([((), atoms(at)) for at in every], arguments=ignore)
    bound, parts = ((None, ("planar",)), (3, ("bound",)), (4, ("bound", "planar")))[number % 3]
    if experience.starts:  # of several logs it is not followed what is planar
        bound, parts = 4, ("bound",)
    found = [
        ((), atoms(at)) for at in truth.having(*parts[-1:] * (parts[-1] == "planar"), bound=bound)
    ]
    few = () if bound is None else ("-c", f"places={bound}")
    yield asked(found, parts=parts, arguments=(*ignore, *few))
    if experience.starts:
        closed = [((), atoms(at)) for at in truth.having("closed")]
        ends = (*steps, f":- not closed({names[-1]}).")
        yield asked(closed, arguments=ignore, steps=ends)
    costs = {at: h.cost() for at, h in every.items()}
    if loaded and number % 3 < 2:  # what a map costs is not stated without the path axiom
        closed = [((), atoms(at)) for at in truth.having("closed")]
        ends = (*steps, f":- not closed({names[-1]}).")
        yield asked(closed, arguments=ignore, steps=ends)
    elif number % 3 == 0:
        fewest = truth.least(lambda h: h.cost(), every)
        found = [(costs[at], atoms(at)) for at in fewest]
        yield asked(found, arguments=("--opt-mode=optN",))
    elif number % 3 == 1:
        fewest = truth.least(lambda h: h.cost(), truth.having("closed"))
        found = [(costs[at], atoms(at)) for at in fewest]
        ends = (*steps, f":- not closed({names[-1]}).")
        yield asked(found, arguments=("--opt-mode=optN",), steps=ends)
    else:
        told = [atoms(at) | together(experience.slots, at, names) for at in every]
        yield asked([((), one) for one in told], "online/certain", arguments=ignore)
        for mode, join in ("cautious", frozenset.intersection), ("brave", frozenset.union):
            found = [((), join(*told))] if told else []
            how = (*ignore, f"--enum-mode={mode}")
            yield asked(found, "online/certain", arguments=how)


def astray(draw, experience):
    """The same experience with steps that lead elsewhere and are taken back: the numbers of
    its own steps, and all the steps."""
    names, steps, away, last = [], [], [], -1
    for step in range(experience.steps + 1):
        if step and draw.random() < 0.4:
            turn = draw.choice(sorted(experience.views[step - 1]))
            last += 1
            away.append(last)
            told = "".join(f" {name}({last})." for name in MARKER if draw.random() < 0.3)
            told += f" same({draw.choice(names)},{last})." * (draw.random() < 0.2)
            if draw.random() < 0.2:
                seen_again = experience.views[step - 1]
                told += f" look({last})." + "".join(f" view({last},{slot})." for slot in seen_again)
            else:
                told += f" turn({last},{turn}). view({last},0)."
                told += f" length({last},{draw.randint(1, 99)})." * bool(experience.lengths)
                told += f" shift({last},{draw.randint(-9, 9)},0)." * bool(experience.shifts)
            steps.append(f"after({last},{names[-1]}).{told}")
            steps.append(str(last))
        last += 1
        facts = experience.facts_of(step, last)
        if away and draw.random() < 0.2:  # this says nothing about a step that was not taken back
            one, other = draw.sample([draw.choice(away), last], 2)
            facts.append(f"{draw.choice(['same', 'apart'])}({one},{other}).")
        for name in ("same", "apart"):
            pairs = [pair for pair in getattr(experience, name) if pair[1] == step]
            facts += [f"{name}({last},{names[one]})." for one, _ in sorted(pairs)]
        if step:
            facts += [f"after({last},{names[-1]})."] * (last - 1 != names[-1])
        names.append(last)
        steps.append(" ".join(facts))
    return names, tuple(steps)


def together(slots, at, names):
    """What certain.lp shows of a hypothesis."""
    found = {f"new({names[t]})" for t, (p, _) in enumerate(at) if p == t}
    for u, (q, there) in enumerate(at):
        for t, (p, here) in enumerate(at[:u]):
            if p == q:
                pair = f"{names[t]},{names[u]}"
                found |= {f"together({pair})", f"one_place({pair},{(there - here) % slots})"}
    return frozenset(found)


# What each file demands of the ones that it is loaded with.
GUARD = re.compile(r"^:- not (topomap|paper|online|phases)\.", re.MULTILINE)


def alone() -> Iterator[Query]:
    """Parts without their entry, and what belongs to several calls in a single one: no answer.
    That no message hides it, each predicate is said to be defined."""
    texts = {
        str(path.relative_to(ENCODINGS))[:-3]: path.read_text(encoding="utf-8")
        for path in ENCODINGS.rglob("*.lp")
    }
    atoms = {
        (name, number)
        for name, number in re.findall(
            r"^\| `(\w+)(\([^)]*\))?`", (ENCODINGS / "README.md").read_text(), re.MULTILINE
        )
    }
    defined = " ".join(
        f"#defined {name}/{number.count(',') + 1 if number else 0}."
        for name, number in sorted(atoms)
    )
    entries = ("phases/topomap", "phases/visits", "phases/runs", "phases/lines", "online")
    for file, text in sorted(texts.items()):
        if GUARD.search(text) and file not in entries:
            told = ("-c", "places=3", "-c", "tolerance=0")
            yield Query((file,), defined, frozenset(), told)
    for file, told in ("bound", ("-c", "places=3")), ("beyond/straight", ("-c", "with_sides=0")):
        yield Query((f"paper/{file}",), defined, frozenset(), told)
    # That no number is there has a message, and so is said by one that is too small.
    for file, told in (
        ("marker", EXPERIENCES["marker"]),
        ("marker", LOGS["coin and rope"]),
        ("logs", TWO),
        ("logs", LOGS["a second look"]),
        ("compass", KNOWN["compass"]),
        ("odometry", KNOWN["odometry"]),
        ("lengths", KNOWN["length"]),
        ("closures", KNOWN["same"]),
        ("closures", KNOWN["apart"]),
        ("straight", BENT["all opposite"]),
        ("tolerance", BENT["one slot off"]),
    ):
        facts, how = f"{told.facts()} #const with_{file} = 0.", constants(told)
        yield Query(("paper/topomap",), facts, frozenset(), how)
        # Nor does one file stand for another, of facts that say nothing.
        other = "compass" if file == "closures" else "closures"
        fact = "compass(0,0)." if file == "closures" else "same(0,0)."
        facts = f"{told.facts()} {fact} #const with_{other} = 0."
        yield Query(("paper/topomap", f"paper/beyond/{file}"), facts, frozenset(), how)
    sides = f"{BENT['all opposite'].facts()} #const with_sides = 0."
    for part in ("paper/boundary", "paper/beyond/exceptions"):
        yield Query(("paper/topomap", "paper/beyond/straight", part), sides, frozenset())
    yield Query(("no_path_axiom",), defined, frozenset())
    yield Query(("paper/perpendicular",), defined, frozenset(), ("-c", "with_path_axiom=0"))
    parts = ("paper/topomap", "paper/perpendicular", "no_path_axiom")
    yield Query(parts, CORRIDOR.facts(), frozenset(), ("-c", "with_path_axiom=0"))
    facts, how = BENT["one slot off"].facts(), constants(BENT["one slot off"])
    how = (*how, "-c", "noise_with_tolerance=0", "--opt-mode=ignore")
    yield Query(("topomap", "noise"), facts, frozenset(), how)
    # A file for facts that are not given changes nothing.
    for name in ("ahead", "lasso"):
        found = frozenset(((), ats(at)) for at in Truth(EXPERIENCES[name]).final)
        for file in ("straight", "tolerance", "compass"):
            files = ("paper/topomap", f"paper/beyond/{file}")
            yield Query(files, EXPERIENCES[name].facts(), found)
    truth = Truth(EXPERIENCES["ahead"])
    best = truth.least(Hypothesis.cost, truth.final)
    found = frozenset((truth.final[at].cost(), ats(at)) for at in best)
    files = "paper/topomap", "paper/beyond/straight", "paper/minimal"
    yield Query(files, EXPERIENCES["ahead"].facts(), found, ("--opt-mode=optN",))
    # It has a map, and that one is closed.
    back = seen("0", "0: 0", "0: 0")
    pairs = "".join(f"{atom}. " for atom in phase_answers.Pairs(back).shown())
    for entry in entries[:4]:
        yield Query((entry,), f"{back.facts()} {pairs} {defined}", frozenset())


SUITES = (
    alone,
    theory,
    marker,
    knowledge,
    given_up,
    bearings,
    off_or_bent,
    check_bent,
    borders,
    stated,
    further_bent,
    following_bent,
    misread,
    circumscription,
    phases,
    biting,
    squares,
    ends,
    check,
    demands,
    faults,
    asked,
    further,
    following,
)


@cache
def queries() -> list[Query]:
    """All of them, mixed, as that kills a mutant soon."""
    every = [query for suite in SUITES for query in suite()]
    return random.Random("queries").sample(every, len(every))
