"""Where to go next: the walk that tells maps apart, against all walks; bisimulations, against
another way to them, and a checker that refuses damaged ones."""

import json
import random
import signal
import subprocess
import time
from dataclasses import replace
from itertools import combinations

import clingo
import pytest
from conftest import BIN, ENCODINGS, ROOT, TRIED, run
from oracles.walks import alike, asked, best, gone, same, scattered, sight, standing
from topomap import cli
from topomap.documents import bisimulation
from topomap.model.experience import observe as experienced
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.questions import explore
from topomap.questions.explore import plan
from topomap.questions.standings import Standing, predict, tells
from topomap.runtime.watch import Watch
from topomap.solver.solving import hypotheses
from topomap.worlds.environment import EAST, grid
from topomap.worlds.instance import instance


def quiet(timeout=None):
    return Watch(timeout)


def maps(experience, *parts, bound=None):
    """The hypotheses with these parts; the best, if one is minimal."""
    found = hypotheses(experience, Query(frozenset(parts), bound), quiet())
    return sorted(one.at for one in found if one.proved)


@pytest.fixture
def topomap(capsys, monkeypatch):
    """The command, in this process, which is faster."""
    monkeypatch.chdir(ROOT)

    def call(*arguments):
        status = cli.main([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        return subprocess.CompletedProcess(arguments, status, out, err)

    return call


def holds(among, made):
    """What a plan says of itself is so."""
    predictions = tuple(predict(one, made.turns, made.drop) for one in among)
    assert made.predictions == predictions
    for one, seen in zip(among, predictions, strict=True):
        here = one.dstate, one.marker
        for step, (turn, what) in enumerate(zip(made.turns, seen, strict=True)):
            if made.drop == step and here:
                here = here[0], here[0][0]
            here = gone(one, here, turn) if here else None
            here = None if here == "end" else here
            look = what and (
                *(tuple(sorted(what.view)), tuple(sorted(what.landmarks))),
                *(what.marker, what.compass, tuple(sorted(what.straight or ()))),
            )
            assert look == (sight(one, here) if here else None)
    assert sorted(n for same in made.classes for n in same) == list(range(len(among)))
    numbers = range(len(among))
    untold = [sum(not tells(predictions[i], predictions[j]) for j in numbers) for i in numbers]
    assert made.left == max(untold)


@pytest.mark.slow
@pytest.mark.parametrize("cases", [150, pytest.param(3000, marks=pytest.mark.long)])
def test_no_walk_does_better(cases):
    kinds = {}
    for number in range(cases):
        draw = random.Random(f"explore {number}")
        slots, among = asked(draw, number, 4)
        made = plan(slots, among, quiet())
        (left, length), walk, (out, soon), seek = best(among)
        holds(among, made)
        assert made.proved
        assert made.left == left
        kinds[made.kind] = kinds.get(made.kind, 0) + 1
        if made.kind == "apart":
            assert left < len(among)
            assert made.turns == tuple(turn for _, turn in walk)
            assert len(walk) == length
            continue
        assert left == len(among)
        if made.kind == "pending":
            assert made.turns == tuple(turn for _, turn in seek)
            assert -soon == len(seek)
            assert out > 0
            continue
        assert (out, made.turns) == (0, ())
        one = all(same(among[0], other) for other in among)
        assert made.kind == ("settled" if one else "bisimilar")
    TRIED["plans against all walks"] += cases
    assert min(kinds["apart"], kinds["pending"]) > cases / 10, kinds


@pytest.mark.slow
@pytest.mark.parametrize("cases", [60, pytest.param(600, marks=pytest.mark.long)])
def test_no_walk_with_a_marker_does_better(cases):
    drops = 0
    for number in range(cases):
        draw = random.Random(f"marker {number}")
        slots, among = asked(draw, number, 3)
        made = plan(slots, among, quiet(), marker=True)
        (left, length), _, (_out, soon), _ = best(among, carried=True)
        holds(among, made)
        assert made.proved
        assert made.left == left
        if made.kind == "apart":
            assert len(made.turns) == length
            plain, walk, *_ = best(among)
            assert (made.drop is None) == (plain == (left, length)), number
            drops += made.drop is not None
            if made.drop is None:
                assert made.turns == tuple(turn for _, turn in walk)
        elif made.kind == "pending":
            assert len(made.turns) == -soon
    assert drops > cases / 20
    TRIED["plans against all walks"] += cases


@pytest.mark.slow
def test_where_the_search_ends_early_clingo_goes_on(monkeypatch):
    """What the search for the length, and for pairs, can no longer tell is left to clingo."""
    kinds = set()
    for number in range(40):
        slots, among = asked(random.Random(f"explore {number}"), number, 4)
        whole = plan(slots, among, quiet(), steps=8)
        monkeypatch.setattr(explore, "MOST_WORK", number % 3 * 5)
        monkeypatch.setattr(explore, "CONFLICTS", 10**6)
        made = plan(slots, among, quiet(), steps=8)
        monkeypatch.undo()
        if made.proved:
            assert made == whole
        else:
            assert (made.turns, made.left, made.untold) == (whole.turns, whole.left, whole.untold)
            assert made.fault == "steps"
        kinds.add((made.kind, made.proved))
    assert kinds >= {("apart", True), ("apart", False), ("pending", True), ("pending", False)}


@pytest.mark.slow
def test_where_clingo_is_stopped_the_walk_is_the_same(monkeypatch):
    """A walk that is proved to be best by the search for the length is of the least turns."""
    walks = []
    for conflicts in (explore.CONFLICTS, 10):
        monkeypatch.setattr(explore, "CONFLICTS", conflicts)
        draws = [asked(random.Random(f"stop {number}"), number, 4) for number in range(60)]
        walks.append([plan(slots, among, quiet()) for slots, among in draws])
    assert walks[0] == walks[1]


@pytest.mark.slow
@pytest.mark.parametrize("marker", [False, True])
@pytest.mark.parametrize("cases", [100, pytest.param(1500, marks=pytest.mark.long)])
def test_why_no_walk_tells_them(cases, marker):
    reasons = {"walk": 0, "pending": 0, "bisimilar": 0}
    for number in range(cases):
        slots, among = asked(random.Random(f"why {number}"), number, 4)
        made = plan(slots, among, quiet(), marker=marker)
        predictions = made.predictions
        classes = {number: same for same in made.classes for number in same}
        for pair in made.untold:
            one, other = among[pair.one], among[pair.other]
            assert not tells(predictions[pair.one], predictions[pair.other])
            reasons[pair.why] += 1
            related = alike(one, other)
            if pair.why == "walk":
                assert related is None or marker
                left, *_ = best([one, other], carried=marker)[0]
                assert left == 1
                continue
            least = {(here[0], there[0], (here[1], there[1])) for here, there in related}
            assert least <= set(pair.related) if marker else least == set(pair.related)
            for chart, side in ((one, 0), (other, 1)):
                places = {ends[side][0] for ends in pair.related}
                ends = {end for end in chart.world.pending() if end[0] in places}
                assert set(pair.open[side]) == ends
            assert (pair.why == "pending") == any(pair.open)
            if pair.why == "bisimilar" and not marker:
                world = one.world
                assert world.indistinguishable(one.dstate, other.world, other.dstate)
        # Every pair that no walk distinguishes is listed, or follows from pairs that are.
        there = {(pair.one, pair.other) for pair in made.untold}
        for i, j in combinations(range(len(among)), 2):
            if tells(predictions[i], predictions[j]):
                assert (i, j) not in there
            else:
                a, b = classes[i][0], classes[j][0]
                assert {i, j} - {a, b} == set() or (a, i) in there or (b, j) in there
                assert a == b or (min(a, b), max(a, b)) in there
    TRIED["maps not told apart, with the reason"] += sum(reasons.values())
    assert all(reasons.values()), reasons


@pytest.mark.slow
def test_closed_maps_are_bisimilar_as_refinement_says():
    """All pairs, against TopologicalMap.indistinguishable: closed hypotheses, and others."""
    counts = {True: 0, False: 0}
    groups = []
    for number in range(100):
        made, among = scattered(random.Random(f"pairs {number}"), 5, 1)
        groups.append((made, [replace(one, compass={}) for one in among]))
    for name, bound in (("grid-3x3-snake", None), ("grid-3x4-paper", None)):
        experience = read(ROOT / f"instances/{name}.lp")
        found = maps(experience, "closed", bound=bound)
        groups.append((experience, [standing(experience, at) for at in found]))
    for made, among in groups:
        found = plan(made.slots, among, quiet())
        for i, j in combinations(range(len(among)), 2):
            one, other = among[i], among[j]
            never = one.world.indistinguishable(one.dstate, other.world, other.dstate)
            assert never == any({i, j} <= set(same) for same in found.classes)
            assert not never or found.kind != "settled" or same(one, other)
            counts[never] += 1
    assert min(counts.values()) > 50, counts


def some_proof(marker):
    """Charts and a relation that proves that no walk tells them apart."""
    for number in range(1000):
        slots, among = asked(random.Random(f"proof {number}"), 1, 3)
        for pair in plan(slots, among, quiet(), marker=marker).untold:
            if len(pair.related) > 5 and any(a != b for a, b, _ in pair.related):
                yield among[pair.one].chart(), among[pair.other].chart(), pair.related


@pytest.mark.parametrize("marker", [False, True])
def test_the_checker_refuses_damaged_proofs(marker):
    damaged = 0
    for one, other, related in (
        made for made, _ in zip(some_proof(marker), range(8), strict=False)
    ):
        assert not list(bisimulation.faults(one, other, related, marker))
        for number, (here, there, lies) in enumerate(related):
            rest = [*related[:number], *related[number + 1 :]]
            assert list(bisimulation.faults(one, other, rest, marker))
            turned = there[0], (there[1] + 1) % one.slots
            changes = [(here, turned, lies), ((None, 0), there, lies), (turned, there, lies)]
            for changed in changes:
                if changed not in related:
                    assert list(bisimulation.faults(one, other, [*rest, changed], marker))
                    damaged += 1
    assert damaged > 100


def test_a_relation_of_maps_that_look_different_is_refused():
    """All dstates related: closed, and wrong."""
    refused = 0
    for number in range(200):
        _, among = asked(random.Random(f"explore {number}"), 1, 2)
        one, other = (replace(one.chart(), compass={}) for one in among)
        every = [
            ((p, s), (q, x), (None, None))
            for p, star in one.gateways.items()
            for s in star
            for q, image in other.gateways.items()
            for x in image
        ]
        faults = list(bisimulation.faults(one, other, every, False))
        views = {among[0].world.view(ends[0]) for ends in every}
        views |= {among[1].world.view(ends[1]) for ends in every}
        signs = {frozenset(one.landmarks.get(place, ())) for place in one.gateways}
        assert bool(faults) == (len(views) > 1 or len(signs) > 1)
        assert all("look" in fault for fault in faults)
        refused += bool(faults)
    assert refused > 100


# The cases of the paper.

SNAKES = {3: ("instances/grid-3x3-snake.lp", None), 4: ("instances/grid-4x4-snake.lp", 16)}


def optimal(size):
    """The optimal maps of a snake, and the real one among all of them."""
    name, bound = SNAKES[size]
    experience = read(ROOT / name)
    found = maps(experience, "closed", "boundary", "minimal", bound=bound)
    truth = instance(grid(size, size), "snake").truth
    if truth not in found:
        found.append(truth)
    return [standing(experience, at) for at in found], found.index(truth)


def test_figure_5():
    among, real = optimal(4)
    assert [len(one.world.stars) for one in among] == [12, 12, 16]
    made = plan(4, among, quiet())
    assert (made.kind, len(made.turns), made.left, made.proved) == ("apart", 3, 2, True)
    (other,) = (pair for pair in made.untold)
    assert (other.other, other.why) == (real, "bisimilar")
    (told,) = {0, 1} - {other.one}
    assert made.classes == ((told,), (other.one, real)) or made.classes == ((0, real), (1,))
    assert all(tells(made.predictions[told], made.predictions[n]) for n in (other.one, real))
    pair = [among[other.one], among[real]]
    assert plan(4, pair, quiet()).kind == "bisimilar"
    settled = plan(4, pair, quiet(), marker=True)
    assert (settled.kind, settled.left, settled.proved) == ("apart", 1, True)
    assert settled.drop is not None
    assert plan(4, among, quiet(), marker=True).left == 1


def test_figure_1():
    among, _ = optimal(3)
    assert {one.world.genus() for one in among} == {0, 1}
    made = plan(4, among, quiet())
    assert (made.kind, made.turns, made.left, made.proved) == ("bisimilar", (), 2, True)
    assert [pair.why for pair in made.untold] == ["bisimilar"]
    assert plan(4, among, quiet(), marker=True).left == 1
    assert plan(4, among[:1], quiet()).kind == "settled"
    assert plan(4, among[:1] * 2, quiet()).kind == "settled"


def test_a_marker_that_is_out_is_seen():
    """It lies where a map says; it cannot be dropped again."""
    experience = read(ROOT / SNAKES[3][0])
    at = instance(grid(3, 3), "snake").truth
    here = standing(experience, at)
    lies = [replace(here, marker=place) for place in (2, 4)]
    made = plan(4, lies, quiet(), marker=True)
    assert (made.drop, made.left, made.kind) == (None, 1, "apart")
    holds(lies, made)
    assert len(made.turns) == best(lies)[0][1]
    assert best(lies)[0][0] == 1


@pytest.mark.slow
@pytest.mark.parametrize("most", [1, 2, 5])
def test_too_many_classes_are_reported(monkeypatch, most):
    monkeypatch.setattr(explore, "MOST_CLASSES", most)
    for number in range(40):
        slots, among = asked(random.Random(f"many {number}"), number, 5)
        made = plan(slots, among, quiet())
        holds(among, made)
        assert made.proved == (len(made.classes) <= most)
        assert made.fault == (None if made.proved else "maps")


@pytest.mark.slow
def test_too_many_states_are_reported(monkeypatch):
    experience = read(ROOT / "instances/manhattan-tour20.lp").cut(14)
    among = [standing(experience, at) for at in maps(experience)]
    whole = plan(4, among, quiet())
    monkeypatch.setattr(explore, "MOST_STATES", 200)
    made = plan(4, among, quiet())
    holds(among, made)
    assert (whole.fault, made.fault, made.proved) == (None, "maps", False)
    assert made.left >= whole.left


@pytest.mark.slow
def test_many_maps_that_are_few():
    """Many that are the same up to names cost little more than one of them."""
    among, _ = optimal(4)
    started = time.monotonic()
    made = plan(4, among * 100, quiet())
    assert time.monotonic() - started < 20
    assert (made.left, len(made.classes), made.proved) == (200, 2, True)


def test_a_plan_is_made_soon():
    experience = read(ROOT / "instances/manhattan-tour20.lp")
    among = [standing(experience, at) for at in maps(experience)][:20]
    started = time.monotonic()
    for _ in range(3):
        plan(4, among, quiet())
    assert time.monotonic() - started < 6


def test_a_long_street_is_not_a_problem():
    street = grid(1, 3000).map
    started = time.monotonic()
    assert plan(4, [Standing(street, ((0, 0), EAST))], quiet()).kind == "settled"
    assert time.monotonic() - started < 3


# The encodings by stock clingo.


def by_clingo(files, facts, *options):
    control = clingo.Control(["0", "--opt-mode=optN", *options])
    for file in files:
        control.load(str(ENCODINGS / f"{file}.lp"))
    control.add("base", [], facts)
    control.ground()
    found = []
    control.solve(
        on_model=lambda m: (
            found.append((m.cost, sorted(map(str, m.symbols(shown=True)))))
            if m.optimality_proven or not m.cost
            else None
        )
    )
    return found


@pytest.mark.slow
@pytest.mark.parametrize("marker", [0, 1])
def test_stock_clingo_gives_the_walk(topomap, tmp_path, marker):
    """From what --facts prints, and nothing of ours."""
    truth = tmp_path / "truth.json"
    at = instance(grid(4, 4), "snake").truth
    truth.write_text(json.dumps([{"at": [[t, *dstate] for t, dstate in enumerate(at)]}]))
    call = ["explore", SNAKES[4][0], "--bound", "16", "--among", "optimal", "--among", truth]
    call += ["--marker"] * marker
    facts = topomap(*call, "--facts").stdout
    made = json.loads(topomap(*call, "--json").stdout)
    n = len(made["turns"]) + 1
    options = "-c", f"n={n}"
    ((cost, atoms),) = by_clingo(["explore"], facts, *options)
    walk = [f"go({step},{turn})" for step, turn in enumerate(made["turns"], 1)]
    drop = [f"drop({made['drop']})"] if marker else []
    assert atoms == sorted(walk + drop)
    assert cost[:3] == [made["left"], len(made["turns"]), marker]
    ((_, proof),) = by_clingo(["bisimilar"], facts)
    bisimilar = [atom for atom in proof if atom.startswith("bisimilar")]
    assert bisimilar == (
        [] if marker else [f"bisimilar({a},{b})" for a, b in [made["untold"][0]["map_numbers"]]]
    )
    done = run("clingo", ENCODINGS / "explore.lp", "-", *options, input=facts)
    assert f"Optimization : {' '.join(map(str, cost))}" in done.stdout.splitlines()
    assert not done.stderr


def test_stock_clingo_gives_the_way_to_a_pending_gateway(topomap):
    call = ["explore", SNAKES[3][0], "--horizon", "15"]
    facts = topomap(*call, "--facts").stdout
    made = json.loads(topomap(*call, "--json").stdout)
    assert made["kind"] == "pending"
    ((cost, atoms),) = by_clingo(["unseen"], facts, "-c", "n=4")
    assert atoms == [f"go({step},{turn})" for step, turn in enumerate(made["turns"], 1)]
    assert cost[:2] == [0, len(made["turns"])]


# The command.


def test_the_command_says_what_the_plan_is(topomap):
    done = topomap("explore", SNAKES[4][0], "--bound", "16")
    lines = done.stdout.splitlines()
    assert done.returncode == 0
    assert lines[0] == "2 maps (2 optimal)"
    assert lines[1].split() == ["step", "turn", "map", "1", "map", "2"]
    assert lines[2] == "1     0 back  0 1 2    0 1 2"
    assert lines[5] == (
        "left in the worst case: 1 of 2 maps; no walk leaves fewer, none as few sooner"
    )
    made = json.loads(topomap("explore", SNAKES[4][0], "--bound", "16", "--json").stdout)
    assert (made["turns"], made["left"], made["complete"]) == ([0, 1, 1], 1, True)
    assert [[p["view"] for p in row] for row in made["predictions"]] == [
        [[0, 1, 2], [0, 1, 2, 3], [0, 1, 2, 3]],
        [[0, 1, 2], [0, 1, 2, 3], [0, 1, 3]],
    ]
    with_marker = topomap("explore", SNAKES[3][0], "--marker").stdout
    assert "put the marker down" in with_marker
    assert with_marker.splitlines()[-2].endswith("0 1, marker")
    never = topomap("explore", SNAKES[3][0])
    assert never.returncode == 1
    assert "a bisimulation of 48 pairs of dstates, checked" in never.stdout
    settled = topomap("explore", SNAKES[3][0], "--planar")
    assert settled.returncode == 0
    assert settled.stdout.endswith("settled: the only map that is optimal, and it is closed\n")
    so_far = topomap("explore", "instances/manhattan-tour20.lp", "--horizon", "0").stdout
    assert so_far.startswith("1 map (1 best so far)")
    assert "through a pending gateway in the map" in so_far


def test_which_maps_are_meant(topomap, tmp_path):
    counts = {"closed": 4, "perpendicular": 2, "optimal": 2}
    for among, count in counts.items():
        made = json.loads(topomap("explore", SNAKES[3][0], "--among", among, "--json").stdout)
        assert len(made["maps"]) == count
    file = tmp_path / "maps.json"
    topomap("solve", SNAKES[3][0], "--planar", "--closed", "--json", "-o", file)
    made = json.loads(topomap("explore", SNAKES[3][0], "--among", file, "--json").stdout)
    assert {tuple(m["at"][-1]) for m in made["maps"]} <= {
        (16, p, s) for p in range(17) for s in range(4)
    }
    assert len(made["maps"]) == 3
    both = topomap("explore", SNAKES[3][0], "--among", file, "--among", "optimal", "--json")
    assert len(json.loads(both.stdout)["maps"]) == 4
    cut = topomap("explore", SNAKES[3][0], "--among", file, "--horizon", "9", "--json")
    assert {len(m["at"]) for m in json.loads(cut.stdout)["maps"]} == {10}


def test_bad_input_is_one_line(topomap, tmp_path):
    bad = tmp_path / "bad.json"
    at = instance(grid(3, 3), "snake").truth
    steps = [[t, *dstate] for t, dstate in enumerate(at)]

    def refused(content, *words, option="--among"):
        bad.write_text(content if isinstance(content, str) else json.dumps(content))
        done = topomap("explore", SNAKES[3][0], option, bad)
        assert (done.returncode, done.stdout) == (2, "")
        (line,) = done.stderr.splitlines()
        assert line.startswith(f"{bad}")
        assert all(word in line for word in words), line

    refused("no", "JSON")
    refused([], "no maps")
    refused([{"at": steps}, {"at": steps[:-1]}], "map 2", "15 steps")
    moved = [*steps[:5], [5, 3, 1], *steps[6:]]
    refused([{"at": moved}], "map 1", "step 5")
    circular = [*steps[:2], [2, 0, 0], *steps[3:]]
    refused([{"at": circular}], "map 1", "step 2")
    for content in ("no", [], {}, {"marker": 1, "proofs": [], "horizon": 16, "maps": []}):
        refused(content, "explore --proof", option="--check")
    proof = {"marker": False, "horizon": 16, "maps": [{"at": steps}]}
    itself = {"map_numbers": [1, 1], "why": "bisimilar", "related": []}
    for one in (None, {}, {**itself, "map_numbers": [1, 2]}, itself):
        refused({**proof, "proofs": [one]}, "proof 1", "explore --proof", option="--check")
    refused({**proof, "horizon": True, "proofs": []}, "explore --proof", option="--check")
    none = topomap("explore", SNAKES[3][0], "--bound", "3")
    assert (none.returncode, none.stdout) == (1, "")
    assert none.stderr.endswith("no such map is consistent with it\n")
    both = topomap("explore", SNAKES[3][0], "--proof", bad, "-o", bad)
    assert (both.returncode, len(both.stderr.splitlines())) == (2, 1)


@pytest.mark.parametrize(
    ("arguments", "of"),
    [
        ([], ""),
        (["--horizon", "12"], ", of the first 12 of 16 steps"),
    ],
)
def test_proofs_are_checked_from_the_file(topomap, tmp_path, arguments, of):
    file = tmp_path / "proof.json"
    done = topomap("explore", SNAKES[3][0], *arguments, "--proof", file)
    assert done.returncode == (0 if of else 1)
    checked = topomap("explore", SNAKES[3][0], "--check", file)
    assert checked.returncode == 0
    assert checked.stdout == f"1 proof, none wrong{of}\n"
    proof = json.loads(file.read_text())
    related = proof["proofs"][0]["related"]
    assert of or len(related) == 48
    proof["proofs"][0]["related"] = related[1:]
    file.write_text(json.dumps(proof))
    checked = topomap("explore", SNAKES[3][0], "--check", file, "--json")
    assert checked.returncode == 1
    assert len(json.loads(checked.stdout)["wrong"]) == 1
    proof["proofs"][0]["related"] = related
    file.write_text(json.dumps(proof | {"marker": True}))
    assert "marker" in topomap("explore", SNAKES[3][0], "--check", file).stdout
    if of:  # it comes to a pending gateway
        proof["proofs"][0] |= {"related": related, "why": "bisimilar"}
        file.write_text(json.dumps(proof))
        assert "a later walk may tell" in topomap("explore", SNAKES[3][0], "--check", file).stdout


@pytest.mark.parametrize("out", [True, False])
def test_proofs_are_checked_where_the_marker_is_out(topomap, tmp_path, out):
    """Or was, and is taken up again."""
    if out:
        seen = replace(read(ROOT / SNAKES[3][0]).cut(11), drops=frozenset([2]))
    else:
        route = [1, 1, 3, 2, 2, 3, 0]
        seen, _ = experienced(grid(3, 3).map, ((0, 0), EAST), route, [1], [3])
        assert seen.picks == {3}
    file, among, proof = (tmp_path / name for name in ("in.lp", "maps.json", "proof.json"))
    file.write_text(seen.facts())
    assert topomap("solve", file, "--json", "-o", among).returncode == 0
    assert topomap("explore", file, "--among", among, "--proof", proof).returncode == 0
    told = json.loads(proof.read_text())["proofs"]
    assert told
    lies = {tuple(lies) for one in told for *_, lies in one["related"]}
    assert lies == {(2, 2) if out else (None, None)}
    assert topomap("explore", file, "--check", proof).returncode == 0


def test_a_time_limit_ends_it(topomap, tmp_path):
    started = time.monotonic()
    done = topomap("explore", "instances/manhattan-tour40-signs30.lp", "--timeout", "1", "--json")
    assert time.monotonic() - started < 30
    assert done.returncode == 3
    made = json.loads(done.stdout)
    assert (made["complete"], made["fault"]) == (False, "timeout")


@pytest.mark.slow
def test_a_time_limit_of_the_planning_keeps_the_maps(monkeypatch):
    among, _ = optimal(4)
    late = quiet(0.001)
    time.sleep(0.01)
    made = plan(4, among, late)
    assert (made.fault, made.proved, made.left) == ("timeout", False, 3)
    assert len(made.predictions) == 3


def test_interrupted(tmp_path):
    command = [BIN / "topomap", "explore", "instances/manhattan-tour40-signs30.lp", "-o"]
    with subprocess.Popen(
        [*command, tmp_path / "out"], cwd=ROOT, stderr=subprocess.DEVNULL
    ) as process:
        while not any(tmp_path.iterdir()):
            time.sleep(0.05)
        time.sleep(1)
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 130
