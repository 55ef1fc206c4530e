"""What the public functions are given: numbers of any type of whole number are taken, and what
cannot be is refused in one line that names the argument, before anything is done."""

import subprocess
import sys
from fractions import Fraction

import numpy
import pytest
import topomap
from conftest import ROOT
from topomap.api.explore import candidates, check_proofs

GRID = ROOT / "instances/grid-3x3-snake.lp"
SEEN = topomap.read(GRID)


def ask(seen, **given):
    return topomap.ask(seen, "planar", **given)


def check(seen, **given):
    return topomap.check(seen, [], **given)


def walk(**given):
    return topomap.generate("maze", 2, 2, route="walk", **{"steps": 3, **given})


def robot(**given):
    return topomap.simulate("maze", 2, 2, **given)


ASKED = [topomap.solve, topomap.count, topomap.explain, topomap.explore, candidates, ask, check]
WRONG = {
    "bound": (0, -1, 9.0, True, "9", 2**31, [9]),
    "horizon": (-1, 2.5, False, "2", 2**40),
    "timeout": (-1, float("nan"), float("inf"), "a", True, 10**400),
}
CASES = [
    (call, name, value)
    for call in ASKED
    for name, values in WRONG.items()
    for value in values
    if (call, name) != (check, "horizon")
]


@pytest.mark.parametrize(("call", "name", "value"), CASES)
def test_numbers_that_cannot_be(call, name, value):
    with pytest.raises(ValueError, match=rf"^{name}=.*: it must be a (whole )?number") as fault:
        call(SEEN, **{name: value})
    assert "\n" not in str(fault.value)
    assert len(str(fault.value)) < 120


@pytest.mark.parametrize(
    ("call", "name", "value"),
    [
        (topomap.solve, "noise", 1.0),
        (topomap.solve, "limit", 2.5),
        (topomap.solve, "limit", 0),
        (topomap.solve, "jobs", 0),
        (topomap.solve, "jobs", "2"),
        (topomap.solve, "planar", "no"),
        (topomap.solve, "optimal", 1),
        (ask, "optimal", "no"),
        (check, "noise", -1),
        (check, "planar", None),
        (topomap.count, "jobs", -1),
        (topomap.explore, "steps", "3"),
        (topomap.explore, "steps", 1001),
        (topomap.explore, "marker", 0),
        (lambda _, **given: topomap.follow(**given), "slots", "4"),
        (lambda _, **given: topomap.follow(**given), "bound", 4.0),
        (lambda _, **given: topomap.follow(**given), "count_limit", 0),
        (lambda _, **given: topomap.follow(**given), "timeout", -1),
        (lambda _, **given: topomap.follow(**given), "marker", "yes"),
        (lambda _, **given: topomap.follow(**given), "planar", 1),
        (lambda _, **given: walk(**given), "steps", -5),
        (lambda _, **given: walk(**given), "steps", 2.5),
        (lambda _, **given: walk(**given), "steps", 10**5 + 1),
        (lambda _, **given: walk(**given), "signs", 7),
        (lambda _, **given: walk(**given), "thin", -0.1),
        (lambda _, **given: walk(**given), "seed", "x"),
        (lambda _, **given: walk(**given), "facing", -1),
        (lambda _, **given: robot(**given), "steps", -1),
        (lambda _, **given: robot(**given), "signs", 2),
        (lambda _, **given: robot(**given), "thin", 7),
        (lambda _, **given: robot(**given), "seed", None),
        (lambda _, **given: robot(**given), "facing", "0"),
        (lambda _, **given: robot(**given), "marker", "yes"),
        (lambda _, **given: robot(**given), "bound", 1.5),
        (lambda _, **given: robot(**given), "timeout", float("nan")),
        (lambda _, **given: topomap.simulate("grid", 2, **given), "rows", 0),
        (lambda _, **given: check_proofs(SEEN, "x", **given), "horizon", 1.5),
    ],
)
def test_what_cannot_be(call, name, value):
    if name == "rows":
        with pytest.raises(ValueError, match="columns=0: it must be a whole number, 1 or more"):
            topomap.simulate("grid", 2, 0)
        return
    with pytest.raises(ValueError, match=rf"^{name}=.*: it must be "):
        call(SEEN, **{name: value})


def test_numbers_of_any_type():
    ours = topomap.solve(SEEN, bound=9, horizon=12, limit=3, timeout=60)
    theirs = topomap.solve(
        SEEN,
        bound=numpy.int8(9),
        horizon=numpy.int64(12),
        limit=numpy.uint16(3),
        timeout=Fraction(120, 2),
    )
    assert [*ours] == [*theirs]
    assert theirs.fault == "limit"
    assert topomap.solve(SEEN, timeout=0).fault == "timeout"
    follower = topomap.follow(numpy.int64(4), planar=True)
    follower.step(numpy.array([0, 1]))
    assert follower.step({0}, numpy.int64(1)).step == 1
    assert follower.undo(numpy.int64(1)).step == 0


def test_steps_of_a_follower_that_are_something_else():
    follower = topomap.follow(4)
    follower.step([0, 1])
    before = follower.record
    for error, fault, given in (
        (ValueError, "turn='1': a whole number", {"view": [0], "turn": "1"}),
        (ValueError, "turn=True: a whole number", {"view": [0], "turn": True}),
        (ValueError, r"view: slot=0\.0: a whole number", {"view": [0.0], "turn": 1}),
        (TypeError, "view: a collection is wanted", {"view": "01", "turn": 1}),
        (TypeError, "landmarks: .*, not 'pub'", {"view": [0], "turn": 1, "landmarks": "pub"}),
    ):
        with pytest.raises(error, match=fault):
            follower.step(**given)
        assert follower.record == before
    with pytest.raises(ValueError, match="steps='x': a whole number"):
        follower.undo("x")


@pytest.mark.parametrize("call", ASKED)
@pytest.mark.parametrize("given", [str(GRID), GRID, None, [[0]]])
def test_something_else_than_an_experience(call, given):
    with pytest.raises(TypeError, match=r"an Experience is wanted, which topomap\.read\(path\)"):
        call(given)


@pytest.mark.parametrize(
    ("call", "fault"),
    [
        (lambda: topomap.ask(SEEN, 5), "statement: a text is wanted, such as .*, not 5"),
        (lambda: topomap.ask(SEEN, ["planar"]), "statement: a text is wanted, .*, not "),
        (lambda: topomap.explain(SEEN, 5), "statement: a text is wanted"),
        (lambda: topomap.read(None), "the path of a file is wanted, not None"),
        (lambda: topomap.read(b"x"), "the path of a file is wanted"),
        (lambda: topomap.validate(None), "the path of a file is wanted"),
        (lambda: topomap.validate(SEEN), "the path of a file is wanted"),
        (lambda: topomap.explore(SEEN, None), "among: a Map, .* is wanted, .*, not None"),
        (lambda: topomap.explore(SEEN, [1]), "among: number 1: a Map, .*, not 1"),
        (lambda: check_proofs(SEEN, None), "the path of a file is wanted"),
        (lambda: check_proofs(str(GRID), "x"), "an Experience is wanted"),
        (lambda: topomap.simulate(None), "world: the name of a world, or an environment"),
        (lambda: topomap.generate(5, 2, 2, route="E"), "world: the name of a world, or an"),
        (lambda: topomap.generate("grid", 2, 2, route=None), "route: a text is wanted"),
        (lambda: topomap.generate("grid", 2, 2, route=[1, 2]), "route: a text is wanted"),
    ],
)
def test_something_else_of_another_type(call, fault):
    with pytest.raises(TypeError, match=fault):
        call()


def test_the_maps_to_explore_among():
    best = topomap.solve(SEEN, optimal=True)
    one, several = topomap.explore(SEEN, best[0]), topomap.explore(SEEN, best)
    assert (len(one.maps), len(several.maps)) == (1, len(best))
    for none in ([], (), topomap.solve(SEEN, bound=1)):
        with pytest.raises(ValueError, match=r"among: a Map, .* is wanted, .*, but it is empty"):
            topomap.explore(SEEN, none)
    with pytest.raises(topomap.InputError, match=r"optimall: no such .*; did you mean optimal"):
        topomap.explore(SEEN, "optimall")


def test_parts_beside_candidates_are_not_passed_over():
    given = candidates(SEEN, planar=True)
    with pytest.raises(ValueError, match="'nonsense' is not one of the parts"):
        topomap.explore(SEEN, given, nonsense=True)
    with pytest.raises(ValueError, match="bound=-5"):
        topomap.explore(SEEN, given, bound=-5)
    for more in ({"bound": 9}, {"horizon": 3}, {"planar": True}):
        with pytest.raises(ValueError, match="to candidates, not to explore"):
            topomap.explore(SEEN, given, **more)


def test_parts_of_a_follower():
    with pytest.raises(
        ValueError, match=r"'planarr' is not one of the parts planar, .*; did you mean"
    ):
        topomap.follow(planarr=True)
    with pytest.raises(ValueError, match="'closed' is not one of the parts planar"):
        topomap.follow(closed=True)


TYPED = """\
import topomap

seen = topomap.read("x.lp")
reveal_type(topomap.count(seen)["final"])
reveal_type(topomap.count(seen)["per_step"])
topomap.explore(seen, topomap.solve(seen))
topomap.check(seen, topomap.solve(seen))
topomap.nonsense
topomap.follow(closed=True)
"""


@pytest.mark.long
def test_what_a_checker_of_types_sees(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(TYPED)
    call = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path), str(program)]
    done = subprocess.run(call, capture_output=True, text=True, cwd=ROOT)
    told = [line for line in done.stdout.splitlines() if line.startswith(f"{program}:")]
    for line, words in (
        (4, 'Revealed type is "int | None"'),
        (5, 'Revealed type is "list[int]"'),
        (8, 'has no attribute "nonsense"'),
        (9, 'Unexpected keyword argument "closed"'),
    ):
        assert told.pop(0).startswith(f"{program}:{line}:"), done.stdout
        assert words in done.stdout
    assert [*told] == [one for one in told if " note: " in one], done.stdout
