"""The queries that the encodings are tried with, each with its right answers: what
make mutate runs on every mutant of an encoding.

A suite is a function that yields queries; an encoding is tried with those of its form that
load it.
"""

import random
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import phased
from conftest import ENCODINGS, PARTS, Truth
from flawed import DEMANDS, INSTANCES, by_hand, drawn
from topomap.check import STEP_RULES, by_definition, by_rules
from topomap.environment import EAST, WEST, grid
from topomap.experience import Experience, explore
from topomap.route import snake
from topomap.solver import FORMS
from worlds import WORLDS, of_grid, random_experience, walked


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
EXPERIENCES = {
    "corridor": CORRIDOR,
    "same": marked(CORRIDOR, 1, 3),
    "lost": marked(CORRIDOR, 1),
    "added": marked(CORRIDOR, 3),
    "branch": seen("0 1", "0: 0"),
    "end": seen("0 2", "0: 0"),
    "loop": seen("0 1", "0: 0 3"),
    "corners": seen("0 1", "0: 0 1", "1: 0 3"),
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
    "star": seen("0 1 2", "0: 0", "0: 0 1 2", "1: 0", "0: 0 1 5", "1: 0", "0: 0 4 5", slots=6),
}


# The random ones: seed, most steps, and how many of them are after the horizon. The last two
# were found by a search for experiences that kill a mutant which the others do not.
DRAWN = [*((seed, 8, seed % 3) for seed in range(100)), (602, 14, 0), (2408, 12, 0)]


# Walks whose runs meet at places of four gateways, most of them found by such a search.
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


@dataclass(frozen=True)
class Query:
    """Encodings, by their names under encodings/, loaded with what they include, with facts
    and with arguments of clingo; and the answers, each its cost and the atoms that it shows.
    With --opt-mode=optN, these are the optimal ones."""

    files: tuple[str, ...]
    facts: str
    answers: Answers
    arguments: tuple[str, ...] = ()


def shown(*atoms: str) -> Answers:
    """The one answer that shows these atoms, and has no cost."""
    return frozenset({((), frozenset(atoms))})


def theory() -> Iterator[Query]:
    """Experiences, with the answers that the independent search gives."""
    for experience in (EXPERIENCES | WORLDS).values():
        yield from hypotheses(experience.facts(), (), Truth(experience))
    for seed, most, after in DRAWN:
        experience = random_experience(random.Random(f"corpus {seed}"), most)
        horizon = max(0, experience.steps - after)
        cut = ("-c", f"horizon={horizon}")
        yield from hypotheses(experience.facts(), cut, Truth(experience.cut(horizon)))


def hypotheses(facts: str, arguments: tuple[str, ...], truth: Truth) -> Iterator[Query]:
    """What is asked of one experience, of each form of the encodings: all hypotheses, those
    of each part, what each costs, and the best."""

    def atoms(at):
        return frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at))

    def query(parts, found, *more, cost=lambda h: ()):
        answers = frozenset((cost(truth.final[at]), atoms(at)) for at in found)
        for folder in FORMS.values():
            under = folder.relative_to(ENCODINGS)
            files = tuple(str(under / part) for part in ("topomap", *parts))
            yield Query(files, facts, answers, (*arguments, *more))

    def least(parts, cost, found):
        return query(parts, truth.least(cost, found), "--opt-mode=optN", cost=cost)

    def genus(h):
        return (h.genus(),)

    def fewest(h):
        return h.cost()

    def both(h):
        return (h.genus(), *h.cost())

    # The plain ones are also to say what euler/1 and genus/1 are.
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


def phases() -> Iterator[Query]:
    """The programs of the phases: which visits can be of one place; which runs can lie on one
    path or cross; the closed and perpendicular maps; and the hypotheses that are left by what
    was found."""
    experiences = [*(EXPERIENCES | WORLDS).values()]
    experiences += WALKS
    experiences += [random_experience(random.Random(f"corpus {seed}"), 8) for seed in range(60)]
    for experience in experiences:
        facts = experience.facts()
        draw = random.Random(facts)
        pairs = phased.Pairs(experience)
        yield Query(("fast/phases/visits",), facts, shown(*pairs.shown()))
        facts += "".join(f"{atom}. " for atom in pairs.shown())
        truth = Truth(experience)
        yield left(facts, experience, truth, [])
        yield left(facts, experience, truth, [], "boundary")
        yield begun(facts, experience, pairs, draw.randint(0, experience.steps))
        founds = [[]]
        if truth.final:
            at = draw.choice(sorted(truth.final))
            few, many, every = (phased.drawn(draw, experience, at, rate) for rate in (0.1, 0.4, 1))
            # Which visits are new, so that the order of the gateways is known too.
            news = [fact for fact in every if fact[0] in ("new", "old")]
            founds += [few, many, news]
            yield left(facts, experience, truth, few, "planar")
            yield left(facts, experience, truth, many, "closed", "perpendicular")
            yield left(facts, experience, truth, news, "planar")
        for found in founds * (experience.slots == 4):
            yield lines(facts, experience, truth, found)
            if (ways := phased.runs(experience, found)) is not None:
                answers = frozenset(((), way) for way in ways)
                file = ("fast/phases/runs",)
                yield Query(file, facts + phased.text(found), answers, ("--project",))


def lines(facts: str, experience: Experience, truth: Truth, found: list) -> Query:
    """What is asked of closed and perpendicular maps where something was found."""
    of_pairs = [fact for fact in found if fact[0] in ("new", "never", "apart")]
    squares = truth.having("closed", "perpendicular")
    maps = [at for at in squares if phased.so(of_pairs, experience, at)]
    facts += phased.text(found)
    return Query(("fast/phases/lines",), facts, phased.lines(experience, maps), ("--project",))


def squares() -> Iterator[Query]:
    """More of that."""
    for experience in SQUARES:
        facts = experience.facts()
        facts += "".join(f"{atom}. " for atom in phased.Pairs(experience).shown())
        yield lines(facts, experience, Truth(experience), [])


def left(facts: str, experience: Experience, truth: Truth, found: list, *parts: str) -> Query:
    """What is asked where something was found: the hypotheses in which it is so."""
    answers = frozenset(
        ((), frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at)))
        for at in truth.having(*parts)
        if phased.so(found, experience, at)
    )
    files = tuple(f"fast/{name}" for name in ("phases/topomap", *parts))
    return Query(files, facts + phased.text(found), answers)


def ends() -> Iterator[Query]:
    """As many gateways as ends of links: that is to say, the closed maps."""
    files = "fast/phases/topomap", "fast/phases/ends"
    draws = [random_experience(random.Random(f"ends {seed}"), 8) for seed in range(20)]
    for experience in [*(EXPERIENCES | WORLDS).values(), *draws]:
        truth = Truth(experience)
        facts = experience.facts()
        facts += "".join(f"{atom}. " for atom in phased.Pairs(experience).shown())
        asked = left(facts, experience, truth, [], "closed")
        yield replace(asked, files=files, arguments=("--eq=0",))


def begun(facts: str, experience: Experience, pairs: phased.Pairs, horizon: int) -> Query:
    """What is asked of a beginning: its hypotheses, but for those which take visits to be of
    one place that the whole tells apart."""
    answers = frozenset(
        ((), frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at)))
        for at in Truth(experience.cut(horizon)).final
        if pairs.may.issuperset(phased.same(at, experience.slots))
    )
    return Query(("fast/phases/topomap",), facts, answers, ("-c", f"horizon={horizon}"))


def sizes() -> list[Query]:
    """What the size of the fast encodings is taken by: each experience with all the parts, one
    in five of what is asked of the phases, and a large exploration of which it is known what
    visits are new."""
    files = tuple(f"fast/{part}" for part in ("topomap", "bound", *PARTS, "genus", "minimal"))
    whole = [Query(files, seen.facts(), frozenset()) for seen in (EXPERIENCES | WORLDS).values()]
    phases = [query for query in queries() if query.files[0].startswith("fast/phases/")]
    made = grid(5, 5)
    route = [EAST, WEST] * 2 + snake(made)
    experience, truth = explore(made.map, ((0, 0), EAST), route)
    found = phased.drawn(random.Random(0), experience, truth, 1)
    known = phased.text(fact for fact in found if fact[0] in ("new", "old"))
    pairs = "".join(f"{atom}. " for atom in phased.Pairs(experience).shown())
    large = experience.facts() + pairs + known
    return [*whole, *phases[::5], Query(("fast/phases/topomap", "fast/planar"), large, frozenset())]


def check() -> Iterator[Query]:
    """Maps, sound and with errors, with the violations that are there by definition. What a
    broken step does to the map as a whole is not defined, so a map with one is asked only
    where both checkers say the same."""
    for experience, at in [*by_hand(), *drawn(120)]:
        for demands in (DEMANDS, ()):
            violations = by_definition(experience, at, demands)
            broken = STEP_RULES & dict(violations).keys()
            if broken and by_rules(experience, at, demands) != violations:
                continue
            facts = [f"at({step},{place},{slot})." for step, place, slot in at]
            facts += [f"demand({demand})." for demand in demands]
            found = shown(*(f"violation({rule},{step})" for rule, step in violations))
            yield Query(("check",), experience.facts() + "".join(facts), found)


def demands() -> Iterator[Query]:
    """Demands that are known, and others; and no map, or nothing at all."""
    nowhere = "violation(exactly_one,0)"
    yield Query(("check",), "", shown(nowhere))
    yield Query(("check",), "slots(4). demand(plan).", shown(nowhere, "violation(plan,0)"))
    facts = "slots(4). view(0,0). view(1,0). turn(1,0). at(0,0,0). at(1,1,0). "
    sound = ("planar", "closed", "travelled", "boundary", "perpendicular")
    for demand in (*sound, "bound(2)", "bound(2147483647)"):
        yield Query(("check",), f"{facts} demand({demand}).", shown())
    for demand in ("plannar", "bound", "bound(a)", "bound(#inf)", '"closed"', "2"):
        yield Query(("check",), f"{facts} demand({demand}).", shown(f"violation({demand},1)"))


def faults() -> Iterator[Query]:
    """Instances with faults."""
    for facts, errors in INSTANCES.items():
        yield Query(("input",), facts, shown(*(f"error({error})" for error in errors.split())))


SUITES = (theory, phases, squares, ends, check, demands, faults)


@cache
def queries() -> list[Query]:
    """All of them, mixed, as that kills a mutant soon."""
    every = [query for suite in SUITES for query in suite()]
    return random.Random("queries").sample(every, len(every))
