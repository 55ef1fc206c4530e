"""Ways to the same answer, on named and on random experiences: stock clingo on the encoding that
does the work, and on the statement of the paper, the search of the package, a slow independent
search (oracles/brute_force.py), and two checkers of maps."""

import random
import subprocess
from collections import Counter
from contextlib import contextmanager
from dataclasses import replace
from itertools import combinations

import pytest
from conftest import BIN, ENCODINGS, PARTS, TRIED, Truth, answers, costs, forms, part_file
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from oracles.known_answers import EXPERIENCES
from oracles.worlds import WORLDS, random_experience
from topomap.documents.check import by_definition, by_rules
from topomap.model.query import Query
from topomap.paper.statistics import Tally
from topomap.runtime.watch import Watch
from topomap.search import traversal
from topomap.solver import solving

QUICK = settings(
    max_examples=12,
    derandomize=True,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
NUMBERS = range(len(PARTS) + 1)
EVERY = [parts for number in NUMBERS for parts in combinations(PARTS, number)]
FEW = [parts for parts in EVERY if len(parts) in (0, 1, len(PARTS))]
SOME = [*FEW, *(parts for parts in EVERY if len(parts) == 2), ("planar", "closed", "perpendicular")]
DEMANDS = {"planar": "planar", "euler": "planar"}  # of check.lp; other parts by their names


@contextmanager
def case(experience, parts=(), *arguments, form="work"):
    """Print a case that fails as an instance file, and the commands that give its answers."""
    TRIED["queries on which ways to an answer were compared"] += 1
    try:
        yield
    except AssertionError as error:
        files = " ".join(str(part_file(form, part)) for part in ("topomap", *parts))
        switches = " ".join(f"--{part}" for part in parts)
        error.add_note(f"save as case.lp:\n{experience.facts()}")
        error.add_note(f"clingo {files} case.lp {' '.join(arguments)} 0")
        error.add_note(f"topomap solve case.lp {switches} --by search")
        raise


def searched(experience, *parts, places=None, horizon=None, way=traversal.hypotheses):
    """The hypotheses that the search finds, each once; the best ones, if a part minimises."""
    query = Query(frozenset(parts), places, horizon)
    found = [f.at for f in way(experience, query, Watch()) if f.proved]
    assert len(found) == len(set(found))
    return set(found)


def all_give(expected, experience, parts=(), *arguments, facts=None):
    """Demand this answer of clingo on each form of the encodings."""
    for form in forms(*parts):
        with case(experience, parts, *arguments, form=form):
            given = facts or experience.facts()
            assert answers(parts, given, *arguments, encoding=form) == expected


def driven(experience, form, *parts):
    """The hypotheses that the driver finds with a form of the encodings."""
    query = Query(frozenset(parts), encoding=form)
    return {f.at for f in solving.hypotheses(experience, query, Watch())}


def best(experience, way, form="work"):
    """The optimal maps, or the best so far, with what they cost and which of these they are."""
    query = Query(encoding=form)
    found = [f for f in solving.best(experience, query, Watch(), way) if f.proved]
    return {(f.at, f.cost, f.kind) for f in found}


def listed(experience, most=150):
    """The experience, cut where its tree has grown to ``most`` hypotheses, and what the
    independent search says of it."""
    for horizon in range(experience.steps + 1):
        cut = experience.cut(horizon)
        truth = Truth(cut)
        if len(truth.final) > most:
            break
    TRIED["random experiences"] += 1
    return cut, truth


@st.composite
def experiences(draw):
    marker = draw(st.booleans())
    return listed(random_experience(draw(st.randoms(use_true_random=False)), 10, marker))


def agree_on_parts(experience, truth, every=SOME):
    for parts in every:
        expected = truth.having(*parts)
        all_give(expected, experience, parts)
        with case(experience, parts):
            assert searched(experience, *parts) == expected
    for parts in ("planar", "closed", "perpendicular"), ("closed", "perpendicular"), PARTS:
        for form in forms(*parts):
            with case(experience, parts, form=form):
                assert driven(experience, form, *parts) == truth.having(*parts)


def agree_on_bounds(experience, truth, bound):
    expected = truth.having(bound=bound)
    all_give(expected, experience, ("bound",), "-c", f"places={bound}")
    with case(experience, ("bound",), "-c", f"places={bound}"):
        assert searched(experience, places=bound) == expected


def agree_on_preferences(experience, truth):
    facts, final = experience.facts(), truth.final
    bounds = "--opt-mode=enum,999"
    orders = {
        ("minimal",): lambda h: h.cost(),
        ("genus",): lambda h: (h.genus(),),
        ("genus", "minimal"): lambda h: (h.genus(), *h.cost()),
        ("genus", "exceptions", "minimal"): lambda h: (h.genus(), *h.worth()),
    }
    for parts, order in orders.items():
        all_give(truth.least(order, final), experience, parts)
        with case(experience, parts, "--opt-mode=optN"):
            assert searched(experience, *parts) == truth.least(order, final)
        figures = {at: order(h) for at, h in final.items()}
        for form in forms(*parts):
            with case(experience, parts, bounds, form=form):
                assert costs(parts, facts, bounds, encoding=form) == figures
    for closed in (("closed",), ()):
        all_give(truth.best(closed=bool(closed)), experience, (*closed, "exceptions", "minimal"))
    for form in forms("closed", "exceptions", "minimal"):
        with case(experience, ("closed", "exceptions", "minimal"), "--opt-mode=optN", form=form):
            found = best(experience, solving.hypotheses, form)
            assert found == best(experience, traversal.hypotheses)
            expected = truth.best(closed=True) or truth.best(closed=False)
            assert {at for at, *_ in found} == expected


def agree_on_the_tree(experience, truth):
    """Levels of the tree are answers with a horizon, in both orders of the search; and with
    planarity as pruning."""
    for planar, levels in ((), truth.levels), (("planar",), truth.planar_levels()):
        root = traversal.root(experience, Query(frozenset(planar)))
        for order in traversal.breadth_first, traversal.depth_first:
            counted = Counter(node.steps for node in order(root))
            assert [counted[step] for step in range(len(levels))] == [*map(len, levels)]
        tally = Tally(experience.steps)
        for node in traversal.depth_first(root):
            tally.add(node)
        figures = {
            "closed": truth.having("travelled", *planar),
            "closed_text": truth.having("closed", *planar),
            "perpendicular": truth.having("closed", "perpendicular", *planar),
        }
        assert {key: getattr(tally, key) for key in figures} == {
            key: len(found) for key, found in figures.items()
        }
        assert planar or tally.optimal == len(truth.best(closed=True))
        maps = [sum(adds_a_link(experience, at) for at in level) for level in levels]
        assert tally.maps_built == sum(maps)
        facts = experience.facts()
        for step, level in enumerate(levels):
            cut = experience.cut(step)
            all_give(set(level), cut, planar, "-c", f"horizon={step}", facts=facts)
            with case(cut, planar):
                assert searched(experience, *planar, horizon=step) == set(level)
                assert {at[:step] for at in level} <= set(levels[step - 1]) or not step
        with case(experience, planar):
            counted = solving.count(experience, Query(frozenset(planar)))
            assert counted == (len(levels[-1]), maps[-1])


def adds_a_link(experience, at):
    """Whether the last step of a hypothesis does, or there is none."""
    grown, before = experience.map_of(at), experience.map_of(at[:-1])
    return len(at) == 1 or len(grown.links) > len(before.links)


def agree_with_the_checkers(experience, truth, most=20):
    """Maps are sound, and have a property if and only if the checkers find no fault."""
    properties = sorted({DEMANDS.get(part, part) for part in PARTS})
    having = {part: truth.having(part) for part in properties}
    for at in sorted(truth.final)[:: 1 + len(truth.final) // most]:
        TRIED["maps judged by both checkers"] += 1
        facts = [(step, *dstate) for step, dstate in enumerate(at)]
        lacks = {part for part in properties if at not in having[part]}
        with case(experience):
            rules = by_rules(experience, facts, properties)
            assert rules == by_definition(experience, facts, properties)
            assert {rule for rule, _ in rules} == lacks


def unnamed(experience, at):
    """The map of a hypothesis without names: its places in the order in which they are
    reached from the start by taking gateways clockwise."""
    world = experience.map_of(at)
    found = {at[0][0]: at[0][1]}
    for place in (places := list(found)):
        for slot in range(world.slots):
            end = world.links.get((place, (slot + found[place]) % world.slots))
            if end and end[0] not in found:
                found[end[0]] = end[1]
                places.append(end[0])

    def renamed(gateway):
        place, slot = gateway
        return places.index(place), (slot - found[place]) % world.slots

    links = frozenset((renamed(a), renamed(b)) for a, b in world.links.items())
    stars = tuple(world.view((place, found[place])) for place in places)
    return stars, links, renamed(at[-1])


def have_no_two_the_same(experience, truth):
    with case(experience):
        assert len({unnamed(experience, at) for at in truth.final}) == len(truth.final)


def mirrored(experience):
    """The experience in the mirror: slot S is K - S."""

    def mirror(slot):
        return -slot % experience.slots

    return replace(
        experience,
        views=tuple(frozenset(map(mirror, view)) for view in experience.views),
        turns=tuple(map(mirror, experience.turns)),
    )


def are_as_many_in_the_mirror(experience, truth):
    image = mirrored(experience)
    for parts in FEW:
        for form in forms(*parts):
            with case(image, parts, form=form):
                found = answers(parts, image.facts(), encoding=form)
                assert len(found) == len(truth.having(*parts))
    best = ("closed", "exceptions", "minimal")
    for parts in ("minimal",), ("genus",), ("closed", "boundary", "minimal"), best:
        for form in forms(*parts):
            with case(image, parts, "--opt-mode=optN", form=form):
                here, there = (
                    answers(parts, seen.facts(), encoding=form) for seen in (experience, image)
                )
                assert len(here) == len(there)


PROPERTIES = [
    agree_on_parts,
    agree_on_preferences,
    agree_on_the_tree,
    agree_with_the_checkers,
    have_no_two_the_same,
    are_as_many_in_the_mirror,
]


@pytest.mark.parametrize("holds", PROPERTIES, ids=lambda holds: holds.__name__)
def test_quick(holds):
    @QUICK
    @given(experiences())
    def check(case):
        holds(*case)

    check()


@QUICK
@given(experiences(), st.data())
def test_bounds(case, data):
    agree_on_bounds(*case, bound=data.draw(st.integers(1, case[0].steps + 1)))


NAMED = EXPERIENCES | WORLDS
NONE = frozenset()


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMED)
def test_named(name):
    experience, truth = NAMED[name], Truth(NAMED[name])
    most = max((len(h.stars) for h in truth.final.values()), default=1)
    agree_on_bounds(experience, truth, max(1, most - 1))
    agree_on_parts(experience, truth, FEW)
    agree_on_preferences(experience, truth)
    agree_with_the_checkers(experience, truth, 5)


@pytest.mark.long
@pytest.mark.parametrize("name", NAMED)
def test_named_in_every_way(name):
    experience, truth = NAMED[name], Truth(NAMED[name])
    for bound in range(1, experience.steps + 2):
        agree_on_bounds(experience, truth, bound)
    for holds in PROPERTIES:
        holds(experience, truth)
    agree_on_parts(experience, truth, EVERY)


@pytest.mark.long
@pytest.mark.parametrize("block", range(10))
def test_many(block):
    """Five hundred longer experiences, at random but the same each time; what costs most, of
    some of them."""
    for number in range(50):
        draw = random.Random(f"{block}.{number}")
        experience, truth = listed(random_experience(draw, 13, marker=number % 3 == 2), 300)
        agree_on_bounds(experience, truth, 1 + number % (experience.steps + 1))
        agree_on_parts(experience, truth, SOME[number % 3 :: 3])
        agree_on_the_tree(experience, truth)
        agree_with_the_checkers(experience, truth)
        have_no_two_the_same(experience, truth)
        (agree_on_preferences, are_as_many_in_the_mirror)[number % 2](experience, truth)


def test_a_case_that_fails_is_printed_as_a_file_and_commands(tmp_path):
    """And the commands run on that file, with the answers that are compared."""
    experience, truth = listed(random_experience(random.Random(3), 8))
    with pytest.raises(AssertionError) as caught, case(experience, ("planar",)):
        raise AssertionError
    facts, clingo, topomap = caught.value.__notes__
    (tmp_path / "case.lp").write_text(facts.partition("\n")[2])
    number = len(truth.having("planar"))
    (tmp_path / "encodings").symlink_to(ENCODINGS)
    for command, line in (clingo, f"Models       : {number}"), (topomap, f"{number} consistent"):
        program, *arguments = command.split()
        done = subprocess.run(
            [BIN / program, *arguments], cwd=tmp_path, capture_output=True, text=True
        )
        assert line in done.stdout


def test_the_generator_makes_what_it_promises():
    made = [random_experience(random.Random(n), 10) for n in range(300)]
    assert {e.slots for e in made} >= {2, 4, 6, 8, 12}
    assert {len(view) for e in made for view in e.views} == set(range(1, 7))
    assert any(0 in e.turns[1:] for e in made)
    assert any(any(e.landmarks) for e in made)
    marked = [random_experience(random.Random(n), 10, marker=True) for n in range(300)]
    assert [replace(e, drops=NONE, picks=NONE, markers=NONE) for e in marked] == made
    assert any(e.picks & e.drops for e in marked)
    assert sum(bool(e.markers) for e in marked) > 100
