"""The follower: after each step it says what is found from scratch, and a step that was taken
back leaves no trace."""

import random
from dataclasses import replace

import clingo
import pytest
from conftest import ENCODINGS, ROOT, TRIED, plain
from oracles.brute_force import Hypothesis, best, certain, tree
from oracles.worlds import WORLDS, bent, informed, logs, random_experience, told
from topomap.model.experience import Step
from topomap.model.facts import read
from topomap.model.found import UNPROVED
from topomap.model.query import Query
from topomap.runtime.limits import MOST_COUNTED
from topomap.runtime.watch import Watch
from topomap.search import traversal
from topomap.solver import online, solving
from topomap.solver.boundaries import crossed
from topomap.solver.online import Certain, OnlineSolver
from topomap.solver.stepwise import Asked

WATCH = Watch()


# Where hypotheses have more places than this, clingo is asked: always, or as it is by default.
WAYS = pytest.mark.parametrize(
    "living", [pytest.param(0, id="clingo"), pytest.param(online.LIVING, id="search")]
)


def begun(experience, planar=False, bound=None, most=MOST_COUNTED, **options):
    measured = experience.drift, experience.stretch, experience.tolerance
    first = told(experience, 0)
    axiom = options.pop("path_axiom", True)
    asked = Asked(planar, bound, most, *measured, axiom)
    return OnlineSolver(experience.slots, first, asked, **options)


def go(follower, experience, step):
    follower.step(told(experience, step))


def agrees(status, experience, level):
    """Demand that a status is what the oracle's hypotheses say."""
    assert status.fault is None
    assert (status.hypotheses, status.exact) == (len(level), True)
    if not level:
        assert status.none_since is not None
        assert status.best == ()
        assert status.kind is None
        return
    seen = plain(experience)
    wanted = best(seen, level, closed=True)
    kind = "optimal" if wanted else "best so far"
    wanted = wanted or best(seen, level, closed=False)
    assert set(status.best) == wanted
    assert len(status.best) == len(wanted)
    if wanted:
        assert status.kind == kind
        assert status.cost == Hypothesis(seen, next(iter(wanted))).worth()
    same, new = certain(level)
    assert (status.certain.same, status.certain.new) == (same, new)
    for t, s, u, r in status.certain.linked:
        for at in level:
            link = Hypothesis(seen, at).link
            (p, here), (q, there) = at[t], at[u]
            slots = experience.slots
            assert link[p, (here + s) % slots] == (q, (there + r) % slots)


def follow_all(experience, planar=False, bound=None, **options):
    """Hold each step against the oracle; the statuses."""
    levels = tree(plain(experience), planar, bound)
    follower = begun(experience, planar, bound, **options)
    for step, level in enumerate(levels):
        if step:
            go(follower, experience, step)
        status = follower.status(WATCH)
        agrees(status, experience.cut(step), level)
        TRIED["statuses of a follower"] += 1
        yield status


@WAYS
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("name", WORLDS)
def test_each_step_of_the_worlds(name, planar, living):
    assert list(follow_all(WORLDS[name], planar, living=living))


@pytest.mark.slow
@WAYS
@pytest.mark.parametrize("cases", [30, pytest.param(800, marks=pytest.mark.long)])
def test_each_step_of_random_experiences(cases, living):
    for number in range(cases):
        draw = random.Random(f"online {number}")
        experience = random_experience(draw, draw.choice([6, 9, 12]))
        bound = draw.choice([None, None, 3, 5])
        assert list(follow_all(experience, draw.random() < 0.5, bound, living=living))


@pytest.mark.slow
@WAYS
@pytest.mark.parametrize("cases", [30, pytest.param(300, marks=pytest.mark.long)])
def test_each_step_without_the_path_axiom(living, cases):
    """Worlds with loops and rooms that come back among them; what is preferred is said of all maps
    of the oracle. A step that was taken back leaves no trace here, either."""
    for number in range(cases):
        draw = random.Random(f"online without the axiom {number}")
        experience = random_experience(draw, draw.choice([4, 6, 7]))
        planar, bound = draw.random() < 0.5, draw.choice([None, None, 3])
        seen = plain(experience)
        follower = begun(experience, planar, bound, path_axiom=False, living=living)
        for step, level in enumerate(tree(seen, planar, bound, axiom=False)):
            if step:
                go(follower, experience, step)
                if draw.random() < 0.3:
                    follower.undo()
                    go(follower, experience, step)
            status = follower.status(WATCH)
            assert (status.fault, status.hypotheses, status.exact) == (None, len(level), True)
            assert not level or (status.certain.same, status.certain.new) == certain(level)
            cut = plain(experience.cut(step))
            every = {at: Hypothesis(cut, at) for at in level}
            worth = {
                at: (not one.closed(), sum(one.exceptions()), *one.cost())
                for at, one in every.items()
            }
            first = min(worth.values(), default=(None,))
            assert set(status.best) == {at for at in worth if worth[at] == first}
            assert status.cost == first[1:]
            TRIED["statuses of a follower without the path axiom"] += 1
            broken = sum(one.breaks_path_axiom() for one in every.values())
            TRIED["followed maps that break the path axiom"] += broken


@pytest.mark.slow
@WAYS
@pytest.mark.parametrize("cases", [30, pytest.param(1500, marks=pytest.mark.long)])
def test_each_step_of_walks_with_a_marker(living, cases):
    told = 0
    for number in range(cases):
        draw = random.Random(f"online marker {number}")
        experience = random_experience(draw, draw.choice([6, 9, 12]), marker=True)
        planar = draw.random() < 0.5
        *_, last = follow_all(experience, planar, living=living)
        bare = replace(experience, **dict.fromkeys(("drops", "picks", "markers"), frozenset()))
        told += last.hypotheses < len(tree(plain(bare), planar)[-1])
    assert told > cases // 5  # in so many the marker has refuted something


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "planar", "bound"),
    [
        ("grid-3x3-snake", False, None),
        ("grid-3x3-snake", True, None),
        ("grid-3x4-paper", True, None),
        pytest.param("grid-3x4-paper", False, None, marks=pytest.mark.long),
        pytest.param("grid-4x4-snake", True, 16, marks=pytest.mark.long),
        pytest.param("manhattan-tour20", False, None, marks=pytest.mark.long),
        pytest.param("manhattan-tour20", True, None, marks=pytest.mark.long),
    ],
)
def test_the_papers_instances(name, planar, bound):
    """The number of hypotheses by the search, the best maps by the solver, from scratch."""
    experience = read(ROOT / f"instances/{name}.lp")
    query = Query(frozenset(["planar"] if planar else ()), bound)
    levels = [0] * (experience.steps + 1)
    for node in traversal.depth_first(traversal.root(experience, query)):
        levels[node.steps] += 1
    follower = begun(experience, planar, bound)
    for step, level in enumerate(levels):
        if step:
            go(follower, experience, step)
        status = follower.status(WATCH)
        assert (status.hypotheses, status.exact) == (level, True)
        if step % 4 and step < experience.steps:
            continue
        found = [one for one in solving.best(experience.cut(step), query, WATCH) if one.proved]
        assert sorted(one.at for one in found) == list(status.best)
        assert {(one.kind, one.cost) for one in found} == {(status.kind, status.cost)}


@pytest.mark.slow
@WAYS
def test_steps_that_were_taken_back_leave_no_trace(living):
    for number in range(12):
        draw = random.Random(f"undo {number}")
        experience = random_experience(draw, 9, marker=number % 2 > 0)
        planar = draw.random() < 0.5
        follower = begun(experience, planar, living=living)
        true, step = begun(experience, planar, living=living), 0
        while step < experience.steps:
            # Steps that lead elsewhere; some are asked about.
            for _ in range(draw.randint(0, 3)):
                turn = draw.choice(sorted(follower.experience.views[-1]))
                rest = range(1, experience.slots)
                view = {0, *(slot for slot in rest if draw.random() < 0.5)}
                known = follower.experience
                out = max(known.drops, default=-1) >= max([0, *known.picks])
                marked = draw.choice([["marker"], ["pick"], []] if out else [["drop"], []])
                sign = frozenset(draw.choice(["", "a"]))
                follower.step(Step(turn, frozenset(view), sign, frozenset(marked)))
                if draw.random() < 0.5:
                    follower.status(WATCH)
            back = follower.experience.steps - step
            again = draw.randint(0, step) if draw.random() < 0.3 else 0
            if back + again:
                follower.undo(back + again)
            for more in range(step - again + 1, step + 1):
                go(follower, experience, more)
            assert follower.experience == true.experience
            assert follower.status(WATCH) == true.status(WATCH)
            step += 1
            go(follower, experience, step)
            go(true, experience, step)
        assert follower.status(WATCH) == true.status(WATCH)


def test_no_hypothesis_is_left_and_undo_mends_it():
    follower = OnlineSolver(2, Step(None, frozenset({0, 1}), frozenset({"a"})))
    follower.step(Step(1, frozenset({0})))
    whole = follower.status(WATCH)
    follower.step(Step(0, frozenset({0, 1}), frozenset({"b"})))  # back where there was a sign a
    assert follower.status(WATCH).none_since == 2
    follower.step(Step(0, frozenset({0})))
    status = follower.status(WATCH)
    assert (status.hypotheses, status.none_since, status.best) == (0, 2, ())
    follower.undo(2)
    assert follower.status(WATCH) == whole
    follower.step(Step(0, frozenset({0, 1}), frozenset({"a"})))
    assert follower.status(WATCH).hypotheses == 1


@pytest.mark.parametrize("most", [1, 5, 40, 300])
def test_more_than_are_counted(most):
    """And counted again when they are fewer."""
    experience = read(ROOT / "instances/grid-3x4-paper.lp").cut(17)
    numbers = [len(level) for level in tree(plain(experience))]
    follower = begun(experience, most=most)
    for step, number in enumerate(numbers):
        if step:
            go(follower, experience, step)
        told, exact = follower.count(WATCH)
        assert told == number <= most if exact else -1 <= told < number
        if step == experience.steps:
            wanted = None if told < 0 else told
            assert follower.status(WATCH).hypotheses == wanted
    assert any(number > most for number in numbers)
    assert exact is (most == 300)


def drawn(draw):
    """An experience of any kind."""
    kinds = [random_experience, informed, bent, logs]
    return draw.choice(kinds)(draw, draw.choice([6, 9, 12]))


def said(known, experience):
    """What a status says, without the many names of the same."""
    assert known.fault is None
    maps = [(one.at, one.sizes, list(one.exceptions), one.way(3)) for one in known.maps]
    assert [one.at for one in known.maps] == list(known.best)
    assert all(one.sizes[0] == len(experience.map_of(one.at).stars) for one in known.maps)
    return known, maps


@pytest.mark.slow
@pytest.mark.parametrize("cases", [25, pytest.param(600, marks=pytest.mark.long)])
def test_clingo_and_the_search_say_the_same(cases, monkeypatch):
    """With everything known besides views, with steps that are taken back, and where the one takes
    over from the other in the middle."""
    monkeypatch.setattr(online, "FEWER", 1)
    for number in range(cases):
        draw = random.Random(f"both ways {number}")
        experience = drawn(draw)
        planar = draw.random() < 0.4 and not experience.starts
        bound, path_axiom = draw.choice([None, None, 3, 5]), draw.random() < 0.8
        ways = [
            begun(experience, planar, bound, path_axiom=path_axiom, living=living)
            for living in (0, online.LIVING, draw.choice([8, 20, 60, 200]))
        ]
        before = Certain()
        for step in range(experience.steps + 1):
            for way in ways:
                if step:
                    go(way, experience, step)
                if step and draw.random() < 0.2:
                    back = draw.randint(1, step)
                    way.undo(back)
                    if draw.random() < 0.5:
                        way.status(WATCH)
                    for again in range(step - back + 1, step + 1):
                        go(way, experience, again)
            seen = experience.cut(step)
            one, *others = (said(way.status(WATCH), seen) for way in ways)
            assert all(other == one for other in others), experience.facts()
            assert all(way.experience == seen for way in ways)
            TRIED["statuses of a follower by clingo and by search"] += 1
            if step % 3 == 0:  # what is new since then; sets are not made of it
                known = [other[0].certain for other in others]
                fresh = one[0].certain.since(before)
                assert all(other.since(before) == fresh for other in known)
                pairs = sorted(fresh.same)
                assert all(
                    other.since(before).pairs(4) == (pairs[:4], len(pairs)) for other in known
                )
                before = known[0]


@pytest.mark.slow
def test_clingo_takes_over_and_gives_back(monkeypatch):
    monkeypatch.setattr(online, "FEWER", 1)
    experience = read(ROOT / "instances/manhattan-tour40-signs30.lp").cut(23)
    true, follower = begun(experience, planar=True), begun(experience, planar=True, living=300)
    turns = []
    for step in range(experience.steps + 1):
        if step:
            go(true, experience, step)
            go(follower, experience, step)
        assert follower.status(WATCH) == true.status(WATCH)
        by = "search" if follower.searching else "clingo"
        turns += [by] * (turns[-1:] != [by])
    assert turns[:3] == ["search", "clingo", "search"]
    assert true.searching
    assert true.rules == 0 < follower.rules


def test_only_some_hypotheses_are_kept_where_clingos_program_is_too_large(monkeypatch):
    """Then nothing is said that is not so, and it is called partial; and steps that are taken back
    make it whole again."""
    experience = read(ROOT / "instances/grid-3x4-paper.lp")
    levels = tree(plain(experience.cut(17)))
    monkeypatch.setattr(online, "SOME", 100)
    follower = begun(experience, living=200, most_atoms=1000)
    true = begun(experience)
    partial = 0
    for step, level in enumerate(levels):
        if step:
            go(follower, experience, step)
            go(true, experience, step)
        status, whole = follower.status(WATCH), true.status(WATCH)
        if status.fault is None:
            assert (status, partial) == (whole, 0)
            continue
        partial += 1
        assert status.fault == online.TOO_MANY
        assert (status.kind, status.all_best, status.exact) == (UNPROVED, False, False)
        assert status.certain is None
        assert status.hypotheses < len(level)
        assert {*status.best} <= {*level}
    assert partial > 2
    follower.undo(1)
    go(follower, experience, len(levels) - 1)
    assert follower.status(WATCH) == status
    follower.undo(10)
    true.undo(10)
    assert follower.status(WATCH) == true.status(WATCH)
    assert follower.status(WATCH).fault is None


def test_boundaries_are_those_of_the_definition():
    """And the steps that are named suffice for that."""
    broken = 0
    for number in range(60):
        draw = random.Random(f"boundaries {number}")
        experience = random_experience(draw, 9)
        for at in tree(plain(experience))[-1]:
            whole = Hypothesis(plain(experience), at)
            reasons = crossed(experience.slots, experience.turns, at)
            assert bool(reasons) is not whole.boundary()
            broken += bool(reasons)
            for steps in reasons:
                part = Hypothesis(plain(experience), at)
                ends = {part.leaves(step) for step in steps}
                ends |= {part.link[end] for end in ends}
                part.link = {one: two for one, two in part.link.items() if one in ends}
                assert not part.boundary()
    assert broken > 30


@pytest.mark.slow
def test_stock_clingo_drives_it():
    """As its header says, and with the whole instance given at once."""
    experience = read(ROOT / "instances/grid-3x3-snake.lp")
    numbers = [len(level) for level in tree(plain(experience), planar=True, bound=9)]
    head, *lines = experience.facts().splitlines()
    for at_once in (False, True):
        messages = []
        options = ["0", "--project", "--opt-mode=ignore", "-c", "places=9"]
        control = clingo.Control(options, logger=lambda _, text, to=messages: to.append(text))
        control.load(str(ENCODINGS / "online.lp"))
        control.add("base", [], " ".join(["online.", head, *(lines if at_once else [])]))
        control.ground([("base", [])])
        for step, line in enumerate(lines):
            control.add(f"facts{step}", [], "" if at_once else line)
            number = [clingo.Number(step)]
            parts = [(part, number) for part in ("step", "planar", "bound")]
            control.ground([(f"facts{step}", []), *parts])
            control.solve()
            models = control.statistics["summary"]["models"]["enumerated"]
            assert int(models) == numbers[step]
        assert not messages


def test_what_was_not_certain_before():
    one = Certain(frozenset({(0, 1)}), frozenset({0}), frozenset())
    both = Certain(frozenset({(0, 1), (0, 2)}), frozenset({0, 3}), frozenset({(0, 1, 2, 3)}))
    new = Certain(frozenset({(0, 2)}), frozenset({3}), frozenset({(0, 1, 2, 3)}))
    assert both.since(one) == new
