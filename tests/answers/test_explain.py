"""topomap explain: verdicts against all hypotheses of the independent search, and reasons against
all assignments of dstates, each rule written here once more, from its definition."""

import contextlib
import io
import json
import random
import re
from dataclasses import replace
from itertools import combinations, pairwise

import clingo
import pytest
from conftest import ENCODINGS, ROOT, Truth, run
from oracles.broken_rules import Assignment, assignments, reasons
from oracles.known_answers import EXPERIENCES
from oracles.mapless import Held, candidate, wrong
from oracles.worlds import random_experience
from topomap import cli
from topomap.model.facts import parse, read
from topomap.questions.reasons import RULE_NAMES, gathered, told_gathered, told_marker

MOST = 2500  # assignments that are tried by brute force
LASTING = ("same", "at")
LATE = {"closed", "travelled"}


def explained(tmp_path, experience, *arguments):
    """The status and the answer of a call."""
    file = tmp_path / "instance.lp"
    file.write_text(experience.facts())
    with contextlib.redirect_stdout(io.StringIO()) as out:
        status = cli.main(["explain", str(file), *arguments, "--json"])
    return status, json.loads(out.getvalue())


def number_of_assignments(experience):
    """At most."""
    product = 1
    for step in range(1, experience.steps + 1):
        product *= 1 + step * experience.slots
    return product


def holds(experience, statement, at):
    """Whether a statement holds of dstates, from what it means."""
    text, positive = statement.removeprefix("not "), not statement.startswith("not ")
    name, *numbers = re.findall(r"\w+", text)
    n = [int(number) for number in numbers]
    ways = Assignment(experience, at).ways

    def gateway(step, slot):
        return at[step][0], (at[step][1] + slot) % experience.slots

    if name == "same":
        value = at[n[0]][0] == at[n[1]][0]
    elif name == "at":
        value = at[n[0]] == (n[1], n[2])
    elif name == "linked":
        value = {(gateway(*n[:2]), gateway(*n[2:])), (gateway(*n[2:]), gateway(*n[:2]))} & {*ways}
    elif name == "pending":
        met = {end for way in ways for end in way}
        value = n[1] in experience.views[n[0]] and gateway(*n) not in met
    else:
        assert name == "places"
        value = len({place for place, _ in at}) < n[0]
    return bool(value) == positive


def random_statement(draw, experience):
    step = [draw.randint(0, experience.steps) for _ in range(2)]
    slot = [draw.choice(sorted(experience.views[s])) for s in step]
    if draw.random() < 0.05:
        slot[0] = draw.randrange(experience.slots)
    kind = draw.choice(["same"] * 5 + ["at", "at", "linked", "linked", "pending", "places"])
    text = {
        "same": f"same({step[0]},{step[1]})",
        "at": f"at({max(step)},{min(step)},{slot[step.index(min(step))]})",
        "linked": f"linked({step[0]},{slot[0]},{step[1]},{slot[1]})",
        "pending": f"pending({step[0]},{slot[0]})",
        "places": f"places < {draw.randint(1, experience.steps + 1)}",
    }[kind]
    return draw.choice(["", "", "not "]) + text


def corrupted(draw, experience):
    """The experience with a gateway seen that is not there, or not one that is."""
    step = draw.randint(0, experience.steps)
    kept = {0, *experience.turns[step : step + 1]}
    slot = draw.randrange(experience.slots)
    if slot in kept:
        return experience
    views = list(experience.views)
    views[step] = views[step] ^ {slot}
    return replace(experience, views=tuple(views))


GRIDS = [read(ROOT / f"instances/grid-{size}-snake.lp") for size in ("3x3", "4x4")]


def case(draw, steps):
    experience = random_experience(draw, steps, marker=steps % 2 == 1)
    if draw.random() < 0.3:
        experience = draw.choice(GRIDS).cut(draw.randint(4, 10))
    if draw.random() < 0.3:
        experience = corrupted(draw, experience)
    statement = random_statement(draw, experience) if draw.random() < 0.8 else None
    parts = draw.choice([[], [], [], ["planar"], ["planar"], ["perpendicular"], ["closed"],
                         ["travelled"], ["planar", "perpendicular"], ["boundary"]])  # fmt: skip
    bound = draw.randint(1, 4) if draw.random() < 0.15 else None
    return experience, statement, parts, bound


def call(statement, parts, bound):
    words = [statement] if statement else []
    words += [f"--{part}" for part in parts]
    return words + ([f"--bound={bound}"] if bound else [])


def verdict_of(experience, statement, parts, bound, axiom=True):
    """The verdict by all hypotheses of the independent search."""
    final = Truth(experience, axiom).having(*parts, bound=bound)
    if not final:
        return "no map"
    if statement is None:
        return "map"
    found = {holds(experience, statement, at) for at in final}
    return "open" if len(found) == 2 else "certain" if found == {True} else "impossible"


def goal(answer, statement):
    """What is impossible."""
    if answer["verdict"] == "no map":
        return None
    negated = statement[4:] if statement.startswith("not ") else f"not {statement}"
    return statement if answer["verdict"] == "impossible" else negated


def demand_words(experience, answer):
    """The paths and cycles in the answer exist in the maps of which it speaks, and so on."""
    for reason in answer["reasons"]:
        at = tuple((place, slot) for _, place, slot in reason["without"])
        kind, words = reason["reason"].partition("(")[0], reason["words"]
        numbers = [int(number) for number in re.findall(r"\d+", reason["reason"])]
        ways = Assignment(experience, at).ways
        both = [*ways, *((b, a) for a, b in ways)]
        told = set(map(int, re.findall(r"\d+", words)))
        if kind in ("view", "schema", "unification", "twice", "planar"):
            assert set(numbers) <= told
        if kind in ("twice", "crossed", "circular", "place_twice"):
            match = re.search(r"through places? ([\d ]+) \(steps? ([\d ]+)\)", words)
            places, steps = ([int(n) for n in group.split()] for group in match.groups())
            assert places == [at[step][0] for step in steps]
            assert places[0] == places[-1]
            assert len(places) > 1
            half = experience.slots // 2
            # An agent that walks straight on can pass these places, and meets the first one again.
            # (Where a gateway has two links, from one of them to the other, too.)
            forks = any(name.startswith(("schema", "unification")) for name in reason["also"])
            walks = [(a, b) for a, b in both if (a[0], b[0]) == tuple(places[:2])]
            for here, there in pairwise(places[1:]):
                walks = [
                    (start, b)
                    for start, (p, s) in walks
                    for a, b in both
                    if (a[0], b[0]) == (here, there)
                    and (a == (p, (s + half) % experience.slots) or (forks and a == (p, s)))
                ]
            assert walks, (reason, experience)
            ahead = [(start, (p, (s + half) % experience.slots)) for start, (p, s) in walks]
            if kind == "circular":
                assert any(start == on for start, on in ahead)
            if kind in ("crossed", "place_twice"):
                assert forks or any((start[1] - on[1]) % half for start, on in ahead)
        if kind == "itself":
            assert words.endswith(f" {'{}.{}'.format(*at[numbers[0]])}")
        if kind == "planar":
            match = re.search(r"cycle of steps? ([\d ]+), which passes places? ([\d ]+), to", words)
            steps, places = ([int(n) for n in group.split()] for group in match.groups())
            assert places[0] == places[-1]
            assert steps[-1] == numbers[0]
            for step, ends in zip(steps, pairwise(places), strict=True):
                assert {end[0] for end in ways[step - 1]} == set(ends)
            assert all(at[step][0] == step for step in steps[:-1])
        if kind == "bound":
            assert f"there would be {len({place for place, _ in at})} place" in words
        if kind == "view":
            for step in numbers:
                assert " ".join(map(str, sorted(experience.views[step]))) in words


def demand_reasons(experience, answer, wanted, bound):
    """Every assignment in which it is so breaks a reason, and some assignment only this one."""
    names = [reason["reason"] for reason in answer["reasons"]]
    alone = set()
    for at in assignments(experience):
        if wanted is None or holds(experience, wanted, at):
            one = Assignment(experience, at)
            broken = [
                name
                for name in names
                if (len(one.new) > bound if name == "bound" else one.broken(name))
            ]
            assert broken, at
            if len(broken) == 1:
                alone |= {*broken}
    assert alone == {*names}


def demand_gathered(experience, answer, bound):
    """There is no map, and each reason, a whole rule or what is seen after a step, is broken in a
    map that breaks no other one."""
    assert answer["verdict"] == "no map"
    assert wrong(experience, answer, bound) in (None, "open")
    names = [one["reason"] for one in answer["reasons"]]
    assert Held(experience, bound).suffice(names) is not False


# Each of the long runs must end in time on a slow machine, too.
LONG = [pytest.param(first, first + 220, marks=pytest.mark.long) for first in range(20, 1120, 220)]


@pytest.mark.slow
@pytest.mark.parametrize(("first", "end"), [(0, 20), *LONG])
def test_verdicts_and_reasons(tmp_path, first, end, record_property):
    verdicts, tried, kinds, long = {}, 0, set(), end - first > 20
    for number in range(first, end):
        draw = random.Random(f"explain {number}")
        experience, statement, parts, bound = case(draw, draw.choice([3, 4, 5, 12]))
        status, answer = explained(tmp_path, experience, *call(statement, parts, bound))
        where = f"case {number}: {statement} {parts} {bound}"
        verdict = verdict_of(experience, statement, parts, bound)
        assert answer["verdict"] == verdict, where
        assert status == (verdict in ("open", "map")), where
        assert answer["complete"], where
        verdicts[verdict] = verdicts.get(verdict, 0) + 1
        if status:
            final = Truth(experience).having(*parts, bound=bound)
            for key, value in ("witness", True), ("counter", False):
                at = tuple((place, slot) for _, place, slot in answer[key])
                assert not at or at in final, where
                if verdict == "open":
                    assert holds(experience, statement, at) == value, where
            continue
        names = [reason["reason"] for reason in answer["reasons"]]
        if answer["in_the_way"]:  # whether that is so, test_defaults.py asks
            assert (verdict, "closed" in parts, names) == ("no map", True, []), where
            continue
        assert answer["minimal"], where
        wanted, last = goal(answer, statement), answer["horizon"]
        cut = experience.cut(last)
        late = {name.partition("(")[0] for name in names} & LATE
        assert not late or last == experience.steps, where
        # No shorter beginning will do.
        about = [int(n) for n in re.findall(r"\d+", wanted)[:2]] if wanted else [0]
        lasting = wanted is None or wanted.removeprefix("not ").startswith(LASTING)
        if lasting and max(about) < last and not set(parts) & LATE:
            before = Truth(experience.cut(last - 1)).having(*parts, bound=bound)
            assert any(wanted is None or holds(experience, wanted, at) for at in before), where
        if answer["note"] and verdict != "no map":  # it was seen that it cannot be
            assert not names, where
            continue
        kinds |= {name.partition("(")[0] for name in names}
        if answer["gathered"]:
            demand_gathered(cut, answer, bound)
            continue
        demand_words(cut, answer)
        if number_of_assignments(cut) <= MOST * (4 if long else 1) and "boundary" not in parts:
            tried += 1
            demand_reasons(cut, answer, wanted, bound)
    assert {*verdicts, "open"} == {"no map", "map", "open", "certain", "impossible"}, verdicts
    assert "open" in verdicts or not long  # few of the small ones are
    assert tried > (end - first) / 6
    assert kinds >= {"view", "unification", *["schema"] * long}
    record_property("explanations held against all assignments", tried)


def least_cases():
    """Of each reason that there is without the path axiom, or that then is of more, a case."""
    loop = parse((ROOT / "tests/cases/loop.lp").read_text(), "loop")
    back = parse("slots(4). view(0,0). view(0,1). turn(1,0). view(1,0). view(1,1).", "back")
    yield "itself", back, "at(1,0,0)", []
    yield "place_twice", loop, "same(0,1)", ["boundary"]


@pytest.mark.slow
@pytest.mark.parametrize("cases", [25, pytest.param(500, marks=pytest.mark.long)])
def test_verdicts_without_the_path_axiom(tmp_path, cases, record_property):
    """A way may come back to a place, but not to the gateway by which it was left."""
    verdicts, tried, kinds = set(), 0, set()
    hand = [(reason, seen, said, parts, None) for reason, seen, said, parts in least_cases()]
    for number in range(cases):
        draw = random.Random(f"without the path axiom {number}")
        hand.append((None, *case(draw, draw.choice([3, 4, 4, 5]))))
    for reason, experience, statement, parts, bound in hand:
        words = call(statement, parts, bound)
        status, answer = explained(tmp_path, experience, *words, "--no-path-axiom")
        assert answer["demands"] == [*parts, "no_path_axiom"]
        verdict = verdict_of(experience, statement, parts, bound, axiom=False)
        assert (answer["verdict"], status) == (verdict, verdict in ("open", "map"))
        verdicts.add(verdict)
        if status or (answer["note"] and verdict != "no map"):
            continue
        cut = experience.cut(answer["horizon"])
        names = [one["reason"] for one in answer["reasons"]]
        if answer["gathered"]:
            assert "path axiom" not in names
            continue
        demand_words(cut, answer)
        found = {name.partition("(")[0] for name in names}
        assert reason is None or reason in found
        assert not found & {"twice", "crossed", "circular"}
        kinds |= found
        if number_of_assignments(cut) <= MOST and "sides" not in found:
            demand_reasons(cut, answer, goal(answer, statement), bound)
            tried += 1
    assert verdicts >= {"no map", "open", "impossible"}
    assert tried > cases / 4
    assert kinds >= {"view", "itself", "place_twice"}
    record_property("explanations without the path axiom", tried)


CALLS = """
3x3 6  | same(0,6)       | --perpendicular | impossible | crossed triangle view
3x3 8  | same(3,8)       |                 | impossible | view
3x3 7  | same(1,7)       |                 | impossible | unification view
3x3 6  | at(6,0,0)       | --perpendicular | impossible | crossed triangle
3x3 9  | not same(0,9)   | --bound 9       | certain    | view
4x4 10 | linked(1,3,5,3) | --planar        | impossible | crossed planar twice
4x4 8  | at(8,1,2)       | --perpendicular | impossible | crossed triangle
4x4 8  | at(8,4,2)       | --boundary      | impossible | boundary
3x3 5  |                 | --bound 4       | no map     | bound view
3x3 9  |                 | --travelled     | no map     | travelled view
3x3 7  |                 | --closed        | no map     | closed view
"""


LINES = CALLS.strip().splitlines()
SOONER = [line for line in LINES if any(word in line for word in ("(0,6)", "(5,3)", "(0,9)"))]
LATER = [pytest.param(line, marks=pytest.mark.long) for line in LINES if line not in SOONER]


@pytest.mark.slow
@pytest.mark.parametrize("line", [*SOONER, *LATER])
def test_words_of_the_grids(tmp_path, line):
    """The kinds of reasons that are there, stated from a map; stock clingo says the same of all of
    them, and of each left out."""
    name, statement, options, verdict, kinds = map(str.strip, line.split("|"))
    size, steps = name.split()
    experience = GRIDS[size == "4x4"].cut(int(steps))
    words = [statement] if statement else []
    status, answer = explained(tmp_path, experience, *words, *options.split())
    assert status == 0
    assert answer["verdict"] == verdict
    names = [reason["reason"] for reason in answer["reasons"]]
    assert {*kinds.split()} <= {name.partition("(")[0] for name in names}
    cut = experience.cut(answer["horizon"])
    if not answer["gathered"]:
        demand_words(cut, answer)
    parts = [word.removeprefix("--") for word in options.split() if word.startswith("--")]
    extra = []
    if statement:
        asked = statement.removeprefix("not ")
        true = (verdict == "impossible") != statement.startswith("not ")
        extra = [f"ask({asked}).", f":- {'not ' * true}holds({asked})."]
    numbers = [word for word in options.split() if word.isdigit()]
    arguments = ["-c", f"places={numbers[0]}"] if numbers else []
    files = [ROOT / f"encodings/{part}.lp" for part in ("topomap", "explain", "query", *parts)]
    for left_out in [None, *names]:
        kept = [name for name in names if name != left_out]
        forced = [f":- waived({name})." for name in Held(cut, None).all_singles(kept)]
        given = tmp_path / "given.lp"
        given.write_text(cut.facts() + "".join([*extra, *forced]))
        done = run("clingo", *files, given, "--opt-mode=ignore", "-q", *arguments)
        assert done.returncode in ([20] if left_out is None else [10, 30]), done.stderr


@pytest.mark.slow
def test_stock_clingo_gives_up_the_fewest_reasons(tmp_path):
    """As encodings/explain.lp says: none where there is a map; else as few as brute force."""
    files = [ROOT / f"encodings/{part}.lp" for part in ("topomap", "explain")]
    done = run("clingo", *files, ROOT / "instances/grid-3x3-snake.lp", "-q1")
    assert "Optimization : 0" in done.stdout
    tried = 0
    for number in range(200):
        draw = random.Random(f"fewest {number}")
        experience = corrupted(draw, corrupted(draw, random_experience(draw, 4)))
        if number_of_assignments(experience) > MOST or Truth(experience).final:
            continue
        least = min(
            sum(one.broken(name) for name in reasons(experience))
            for one in (Assignment(experience, at) for at in assignments(experience))
        )
        instance = tmp_path / "instance.lp"
        instance.write_text(experience.facts())
        done = run("clingo", *files, instance, "-q1")
        assert f"Optimization : {least}\n" in done.stdout, experience
        assert len(re.findall("waived", done.stdout)) == least
        tried += 1
        if tried == 4:
            break
    assert tried == 4


def gathered_of(name, experience):
    """The gathered reasons that a single one is a part of, by the list of what each stands for."""
    held = Held(experience, None)
    whole = ["gateway unification", "schema", "path axiom", "planarity", "perpendicularity"]
    if name.startswith("view"):
        return {f"view({step})" for step in re.findall(r"\d+", name)}
    return {one for one in [*whole, "travelled", "bound"] if name in held.singles(one)}


@pytest.mark.slow
def test_a_walk_of_thirteen_steps_without_a_map(tmp_path):
    """Stock clingo says that the few reasons are enough; that no two reasons are; and that random
    sets of one reason fewer are not."""
    seen = read(ROOT / "tests/cases/no-map-13-steps.lp")
    parts = ["planar", "perpendicular", "travelled"]
    status, answer = explained(tmp_path, seen, *call(None, parts, None))
    names = [one["reason"] for one in answer["reasons"]]
    assert (status, answer["verdict"], answer["horizon"]) == (0, "no map", 13)
    assert (answer["minimal"], answer["gathered"], answer["fewest"]) == (True, True, True)
    # Eight would be enough if a path could not lead on by a gateway that was not seen; but where
    # views are given up, it can.
    assert len(names) <= 10
    assert wrong(seen, answer, None) in (None, "open")
    control = clingo.Control(["--opt-mode=ignore"])
    for file in ("topomap", "explain", *parts):
        control.load(str(ENCODINGS / f"{file}.lp"))
    control.add("base", [], seen.facts())
    control.ground()
    waived = {
        str(atom.symbol.arguments[0]): atom.literal
        for atom in control.symbolic_atoms.by_signature("waived", 1)
    }
    parts_of = {name: gathered_of(name, seen) for name in waived}
    assert all(parts_of.values())

    def enough(kept):
        forced = [-waived[name] for name, of in parts_of.items() if of <= {*kept}]
        return control.solve(forced).unsatisfiable

    assert enough(names)
    every = sorted(set().union(*parts_of.values()))
    assert not any(map(enough, combinations(every, 2)))
    fewer = random.Random("fewer").sample([*combinations(every, len(names) - 1)], 80)
    assert not any(map(enough, fewer))


def test_what_is_known_of_one_step_is_gathered():
    ring = replace(EXPERIENCES["round"], compass=(), lengths=())
    steps = ring.steps
    ring = replace(ring, compass=[0] * (steps + 1), lengths=[7] * steps)
    assert gathered("compass(1,3)") == ("compass(1)", "compass(3)")
    assert gathered("same(1,3)") == ("same(1,3)",)
    assert gathered("itself(3)") == gathered("schema(1,3)") == ("schema",)
    assert "to compass slot 0 after step 1" in told_gathered(ring, "compass(1)", None).words
    assert told_gathered(ring, "length(2)", None).words == "step 2 is 7 long"
    assert told_gathered(ring, "bound", 3).words == "there are at most 3 places"
    assert told_gathered(ring, "view(1)", None).steps == (1,)


@pytest.mark.slow
@pytest.mark.parametrize("cases", [7, pytest.param(200, marks=pytest.mark.long)])
def test_reasons_why_there_is_no_map(tmp_path, cases, record_property):
    """Each is needed, as the definitions of the rules say; they are enough, as all assignments show
    where these are few; and there are no more than can be read."""
    found, enough, number = [], 0, 0
    while len(found) < cases:
        seen, parts, bound = candidate(random.Random(f"no map {number}"), 6)
        number += 1
        status, answer = explained(tmp_path, seen, *call(None, parts, bound))
        if answer["verdict"] == "map" or answer["in_the_way"]:
            continue
        assert (status, answer["verdict"]) == (0, "no map")
        assert verdict_of(seen, None, parts, bound) == "no map"
        assert answer["minimal"], number
        assert wrong(seen, answer, bound) in (None, "open"), number
        names = [one["reason"] for one in answer["reasons"]]
        suffice = Held(seen.cut(answer["horizon"]), bound).suffice(names)
        assert suffice is not False, number
        enough += suffice is True
        assert answer["gathered"] or len(names) <= 8
        assert all(len(one["steps"]) <= 1 for one in answer["reasons"]) or not answer["gathered"]
        found.append(answer)
    assert enough > cases / 2
    assert {answer["gathered"] for answer in found} == {True, False}
    record_property("reasons why there is no map held against all assignments", enough)


NOT_WAIVED = {"pair", "runs_meet_twice", "runs_triangle"}


def test_each_reason_has_words():
    """What the encodings name, apart from those that are not loaded with explain.lp."""
    texts = [
        path.read_text()
        for path in [*ENCODINGS.glob("*.lp"), *ENCODINGS.glob("theory/*.lp")]
        if path.name not in ("check.lp", "input.lp", "noise.lp")
    ]
    named = {name for text in texts for name in re.findall(r"^broken\((\w+)", text, re.MULTILINE)}
    assert named >= {"view", "schema", "planar", "euler", "bound", "closed"}
    assert named - {*RULE_NAMES} == NOT_WAIVED


def test_what_is_not_grounded_where_rules_are_waived_is_not_a_reason():
    """Those names say the same as others, by fewer ground rules."""
    control = clingo.Control(["--opt-mode=ignore"])
    for file in ("topomap", "explain", "perpendicular", "planar", "closed"):
        control.load(str(ENCODINGS / f"{file}.lp"))
    control.add("base", [], EXPERIENCES["round"].facts())
    control.ground()
    atoms = control.symbolic_atoms.by_signature("broken", 1)
    names = {atom.symbol.arguments[0].name for atom in atoms}
    assert {"view", "schema", "unification", "planar"} <= names
    assert not names & NOT_WAIVED


@pytest.mark.parametrize(
    ("turn", "seen", "words"),
    [(0, "", "does not see {}, and would be at place 0"),
     (2, "marker(2).", "sees {}, and would be at place 2")],
)  # fmt: skip
def test_words_of_the_marker(tmp_path, turn, seen, words):
    """There and back, or on and on: the step at which it was put down is named."""
    text = f"""slots(4). view(0,0). view(0,2). drop(0). turn(1,0). view(1,0). view(1,2).
        turn(2,{turn}). view(2,0). view(2,2). {seen}"""
    experience = parse(text, "marker")
    status, answer = explained(tmp_path, experience)
    assert (status, answer["verdict"]) == (0, "no map")
    (reason,) = (one for one in answer["reasons"] if one["rule"] == "marker")
    lies = "the marker, which lies at place 0 (step 0)"
    assert reason["words"] == f"after step 2 the agent {words.format(lies)}"
    assert reason["steps"] == [0, 2]
    assert told_marker(experience, 2).words.endswith("which it put down after step 0")


@pytest.mark.slow
def test_the_answer_in_lines(topomap, tmp_path):
    done = topomap("explain", "instances/grid-3x3-snake.lp", "same(3,8)")
    assert done.returncode == 0
    first, second, third, last = done.stdout.splitlines()
    assert first == "same(3,8): impossible, already after step 8"
    assert second == (
        "  view(8,3): views: after step 8 the agent sees the gateways 0 1, after step 3 0 2 3: "
        "no turn of one view gives the other"
    )
    assert re.fullmatch(r"    without it: 0\.0( \d\.\d){7} 3\.\d", third)
    assert last == "this one reason is enough"
    done = topomap("explain", "instances/grid-3x3-snake.lp")
    assert done.returncode == 1
    assert done.stdout.startswith(
        "there are maps, so there is nothing to explain\n  a map: places "
    )
    done = topomap("explain", "instances/grid-3x3-snake.lp", "same(0,16)", "--planar")
    assert done.returncode == 1
    lines = done.stdout.splitlines()
    assert lines[0] == "same(0,16): so in some maps, and not in others"
    assert "in which it holds" in lines[1]
    assert "in which it does not" in lines[2]
    done = topomap("explain", "instances/grid-3x3-snake.lp", "linked(0,3,2,0)")
    assert done.returncode == 0
    assert "no gateway was seen 3 slots clockwise after step 0" in done.stdout
    out = tmp_path / "out"
    again = topomap("explain", "instances/grid-3x3-snake.lp", "linked(0,3,2,0)", "-o", out)
    assert again.returncode == 0
    assert out.read_text() == done.stdout


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        (["same(3,99)"], "step 99"),
        (["same(3"], "not a statement"),
        (["taller"], "no such word"),
        (["pending(1,4)"], "slot 4"),
        ([""], "not a statement"),
        (["same(1,2)", "same(2,3)"], "unrecognized arguments"),
        (["--bound=0"], "--bound"),
        (["--optimal"], "unrecognized arguments"),
    ],
)
def test_bad_calls(topomap, arguments, fault):
    done = topomap("explain", "instances/grid-3x3-snake.lp", *arguments)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert fault in done.stderr
    assert not done.stdout


@pytest.mark.slow
def test_a_time_limit_leaves_what_is_known(topomap, tmp_path):
    call = ["explain", "instances/manhattan-tour40-signs30.lp", "places > 20", "--closed", "--json"]
    done = topomap(*call, "--timeout", "2")
    answer = json.loads(done.stdout)
    assert done.returncode == 3
    assert not answer["complete"]
    assert answer["fault"] == "timeout"
    assert not answer["minimal"]
    done = topomap("explain", "instances/grid-4x4-snake.lp", "same(3,12)", "--timeout", "0.001")
    assert done.returncode == 3
    assert done.stdout == "same(3,12): not settled\npartial: timeout\n"


@pytest.mark.slow
def test_the_same_input_gives_the_same_bytes(topomap):
    call = ["explain", "instances/grid-3x3-snake.lp", "same(0,6)", "--perpendicular", "--json"]
    assert topomap(*call).stdout == topomap(*call).stdout


def told_with_a_tolerance(topomap, tmp_path, facts):
    """The last line of what is said where bearings may be one slot off, and the answer as JSON."""
    file = tmp_path / "back.lp"
    file.write_text(facts)
    call = ["explain", str(file), "--tolerance", "1"]
    answer = json.loads(topomap(*call, "--json").stdout)
    assert (answer["verdict"], answer["complete"]) == ("no map", True)
    return topomap(*call).stdout.splitlines()[-1], answer


def test_reasons_with_a_tolerance_where_all_views_are_of_one_size(topomap, tmp_path):
    views = "view(0,0). view(0,1). view(1,0). view(1,1). view(2,0). view(2,2)."
    facts = f"slots(4). turn(1,1). turn(2,0). {views}"
    told, answer = told_with_a_tolerance(topomap, tmp_path, facts)
    assert told.startswith("these 2 reasons are enough, ")
    assert answer["minimal"]


def test_reasons_with_a_tolerance_where_views_are_of_different_sizes(topomap, tmp_path):
    """With another view there is a map that keeps the only reason, so it is not called enough."""
    facts = "slots(4). view(0,0). view(0,1). turn(1,1). view(1,0). turn(2,0). view(2,0)."
    told, answer = told_with_a_tolerance(topomap, tmp_path, facts)
    condition = "if all visits of a place see equally many gateways"
    assert told == f"1 reason: enough {condition}, but it may not be needed"
    assert answer["minimal"] is None
    assert [reason["reason"] for reason in answer["reasons"]] == ["unification(1,2)"]
    other = tmp_path / "other.lp"
    other.write_text(f"{facts} view(2,3).")
    assert "0.0 1.0 0.1" in topomap("solve", str(other), "--tolerance", "1").stdout
