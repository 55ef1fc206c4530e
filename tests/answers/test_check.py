"""The two checkers: each rule of check.lp holds and bites at the right step, on maps made by
hand and on maps with errors; and ``topomap check`` on maps that anyone made."""

import json
import random

import pytest
import topomap
from conftest import ENCODINGS, ROOT, TRIED, plain, run
from oracles.brute_force import Hypothesis, tree
from oracles.maps_with_errors import DEMANDS, MAPS, mapped, of_texts, placed, with_errors
from oracles.worlds import random_experience
from topomap.documents.answers import map_json
from topomap.documents.check import NO_PATH_AXIOM, STEP_RULES, Grown, by_definition, by_rules
from topomap.model.vocabulary import PROPERTIES
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance

GRID = "instances/grid-3x3-snake.lp"
CASES = "oxbow", "loop"


@pytest.mark.parametrize("judge", [by_rules, by_definition])
@pytest.mark.parametrize(("rule", "steps", "sound", "broken", "step"), MAPS)
def test_a_rule_holds_and_bites(judge, rule, steps, sound, broken, step):
    demands = [] if rule in (*STEP_RULES, "path_twice", "path_circular") else [rule]
    assert not judge(of_texts(steps), placed(sound), demands)
    found = judge(of_texts(steps), placed(broken), demands)
    assert (rule, step) in found
    assert demands == [] or found == {(rule, step)}


def agree_on_errors(draw, steps=10, marker=False):
    """On maps with errors the checkers agree; what a broken step does to the map as a whole
    is not defined, so there only the rules of steps count."""
    experience, sound = mapped(draw, steps, marker)
    for at in [sound, *(with_errors(draw, experience, sound) for _ in range(5))]:
        TRIED["maps with errors judged by both checkers"] += 1
        rules = by_rules(experience, at, DEMANDS)
        definition = by_definition(experience, at, DEMANDS)
        of_steps = [{v for v in found if v[0] in STEP_RULES} for found in (rules, definition)]
        assert of_steps[0] == of_steps[1], (experience.facts(), at)
        assert of_steps[0] or rules == definition, (experience.facts(), at)
        assert at is not sound or not of_steps[0]


@pytest.mark.slow
def test_the_checkers_agree_on_errors():
    for number in range(60):
        agree_on_errors(random.Random(f"errors {number}"), marker=number % 3 == 2)


@pytest.mark.long
def test_the_checkers_agree_on_many_errors():
    for number in range(1000):
        agree_on_errors(random.Random(f"many errors {number}"), 14, marker=number % 3 == 2)


def expected(world, at, axiom):
    """What a map breaks, by the independent search: the first step, or the last one."""
    whole, last = Hypothesis(world, at), len(at) - 1

    def first(breaks):
        return next(t for t in range(last + 1) if breaks(Hypothesis(world, at[: t + 1])))

    def comes_back(circular):
        def breaks(h):
            return any(
                (end == h.opposite(gateway)) == circular
                for gateway in h.link
                for end in h.ray(gateway)
                if end[0] == gateway[0]
            )

        return breaks

    found = set()
    tests = {"planar": lambda h: h.genus() != 0, "boundary": lambda h: any(h.exceptions())}
    if axiom:
        tests |= {"path_circular": comes_back(True), "path_twice": comes_back(False)}
    for rule, breaks in tests.items():
        if breaks(whole):
            found.add((rule, first(breaks)))
    for part in ("closed", "travelled", "perpendicular"):
        if not getattr(whole, part)():
            found.add((part, last))
    return found


def without_the_axiom(cases, name, most):
    """On maps, some of which break the path axiom: the checkers agree with brute force on each
    part, with the axiom and without it, and on the exceptions."""
    judged = 0
    for seed in range(cases):
        draw = random.Random(f"{name} {seed}")
        experience = random_experience(draw, draw.choice([4, 5, 6, 7]))
        world = plain(experience)
        ats = tree(world, axiom=False)[-1]
        for at in draw.sample(ats, min(most, len(ats))):
            steps = [(step, *dstate) for step, dstate in enumerate(at)]
            whole = Hypothesis(world, at)
            grown = Grown(experience, dict(enumerate(at)), len(at) - 1)
            kinds = [kind for kind, *_ in grown.exceptions()]
            told = tuple(kinds.count(kind) for kind in ("meet twice", "place twice", "both sides"))
            assert told == whole.exceptions()
            for axiom in (True, False):
                demands = [*PROPERTIES, *([] if axiom else [NO_PATH_AXIOM])]
                found = expected(world, at, axiom)
                for judge in (by_rules, by_definition):
                    assert judge(experience, steps, demands) == found, (experience.facts(), at)
            judged += 1
            TRIED["maps judged that break the path axiom"] += whole.breaks_path_axiom()
            TRIED["maps judged with exceptions"] += any(told)
    return judged


@pytest.mark.slow
def test_maps_are_judged_without_the_path_axiom():
    assert without_the_axiom(250, "classes", 1) == 250


@pytest.mark.long
def test_many_maps_are_judged_without_the_path_axiom():
    assert without_the_axiom(3000, "many classes", 3) > 5000


def test_the_fact_says_what_the_demand_says():
    """Either takes the axiom away, and nothing else."""
    rules = {rule: (steps, broken) for rule, steps, _, broken, _ in MAPS}
    for rule, fact in (("path_twice", True), ("path_circular", True), ("itself", False)):
        steps, broken = rules[rule]
        at = "".join(f"at({t},{p},{s})." for t, p, s in placed(broken))
        text = of_texts(steps).facts() + at
        for more in ("no_path_axiom.", "demand(no_path_axiom)."):
            done = run("clingo", ENCODINGS / "check.lp", "-", input=text + more)
            assert (f"violation({rule}," in done.stdout) != fact
        done = run("clingo", ENCODINGS / "check.lp", "-", input=text)
        assert f"violation({rule}," in done.stdout


AXIOMS = {  # and defaults, by the independent search
    "path axiom": lambda h: not h.breaks_path_axiom(),
    "planar": lambda h: h.genus() == 0,
    "closed": Hypothesis.closed,
    "travelled": Hypothesis.travelled,
    "boundary": Hypothesis.boundary,
    "perpendicular": Hypothesis.perpendicular,
}


@pytest.mark.slow
def test_which_axioms_and_defaults_a_map_breaks():
    """All of them at once, with what the map has of each; and none is a fault unless demanded."""
    assert {*AXIOMS} == {"path axiom", *PROPERTIES}
    for seed in range(60):
        experience = random_experience(random.Random(f"all {seed}"), 6)
        world = plain(experience)
        ats = tree(world, axiom=False)[-1][:4]
        maps = [{"at": [[step, *dstate] for step, dstate in enumerate(at)]} for at in ats]
        judged = topomap.check(experience, maps, every=True)
        assert judged
        told = judged.document()["judged"]
        for verdict, at, said in zip(judged.verdicts, ats, told, strict=True):
            whole = Hypothesis(world, at)
            broken = {name for name, keeps in AXIOMS.items() if not keeps(whole)}
            assert verdict.axioms.breaks.keys() == said["breaks"].keys() == broken
            assert (
                verdict.axioms.keeps
                == said["keeps"]
                == [one for one in AXIOMS if one not in broken]
            )
            assert (said["genus"], said["pending"]) == (whole.genus(), len(whole.pending()))
            assert len(said["exceptions"]) == sum(whole.exceptions())
            TRIED["maps judged by all parts at once"] += 1


def test_check_all_names_what_each_map_breaks(inside, tmp_path):
    """The oxbow has a closed map with exceptions, and an open one without; the loop breaks the path
    axiom. A fault is what is demanded, or said in the file, and does not hold."""
    maps, oxbow, loop = tmp_path / "maps.json", *(ROOT / f"tests/cases/{n}.lp" for n in CASES)
    assert not inside("solve", oxbow, "--planar", "--json", "-o", maps).returncode
    done = inside("check", "--all", oxbow, maps)
    named = [one.words for one in topomap.solve(topomap.read(oxbow), optimal=True)[0].exceptions]
    assert (done.returncode, done.stdout.splitlines()) == (
        0,
        [
            f"{maps}: map 1: breaks boundary, perpendicular; "
            "keeps path axiom, planar, closed, travelled",
            f"{maps}: map 1: 5 exceptions to consistent boundaries",
            *(f"  {words}" for words in named),
            f"{maps}: map 2: breaks closed (3 pending), travelled; "
            "keeps path axiom, planar, boundary, perpendicular",
            "2 maps, none unsound",
        ],
    )
    assert inside("check", "--all", oxbow, maps, "--closed").returncode == 1
    call = ["solve", loop, "--no-path-axiom", "--closed", "--json", "-o", maps]
    assert not inside(*call).returncode
    document = json.loads(maps.read_text())
    first = f"{maps}: map 1: breaks path axiom (path_twice after step 1), boundary; keeps planar, "
    sound, unsound = "1 map, none unsound", f"{maps}: map 1: violation(path_twice,1)"
    for parts, options, status, line in (
        (["closed", "no_path_axiom"], [], 0, sound),
        (["closed", "no_path_axiom"], ["--all"], 0, first),
        (["closed"], [], 1, unsound),
        (["closed"], ["--all"], 1, unsound),
        (["closed"], ["--no-path-axiom"], 0, sound),
        (None, ["--all"], 0, first),
        (None, [], 1, unsound),
    ):
        said = {key: value for key, value in document.items() if key != "parts"}
        maps.write_text(json.dumps(said if parts is None else {**said, "parts": parts}))
        done = inside("check", loop, maps, *options)
        assert (done.returncode, done.stdout[: len(line)]) == (status, line)


def test_the_exceptions_that_a_file_tells_are_verified(inside, tmp_path):
    maps, oxbow = tmp_path / "maps.json", ROOT / "tests/cases/oxbow.lp"
    call = ["solve", oxbow, "--planar", "--optimal", "--json", "-o", maps]
    assert not inside(*call).returncode
    document = json.loads(maps.read_text())
    done = json.loads(inside("check", oxbow, maps, "--json").stdout)
    assert done["unsound"] == []
    (told,), (one,) = done["judged"], document["maps"]
    said = one["exceptions"]
    assert told["exceptions"] == said
    fault = "exceptions: not what at says"
    for wrong, faults in (
        (said[::-1], []),
        (said[1:], [fault]),
        ([{**said[0], "places": [1, 4]}, *said[1:]], [fault]),
        ([{**said[0], "paths": [2, 5]}, *said[1:]], [fault]),
        ([*said, said[0]], [fault]),
        ({}, [fault]),
    ):
        maps.write_text(
            json.dumps({**document, "maps": [{**document["maps"][0], "exceptions": wrong}]})
        )
        done = json.loads(inside("check", oxbow, maps, "--json").stdout)
        assert [fault for one in done["unsound"] for fault in one["faults"]] == faults
    maps.write_text(json.dumps({**document, "cost": [4, *document["cost"][1:]]}))
    assert f"cost: it is {document['cost']}" in inside("check", oxbow, maps).stdout


@pytest.fixture(scope="module")
def solved():
    done = run("topomap", "solve", GRID, "--planar", "--closed", "--json")
    assert done.returncode == 0
    return done.stdout


@pytest.fixture
def maps(tmp_path, solved):
    """The planar, closed maps of the 3x3 snake, as solve writes them."""
    file = tmp_path / "maps.json"
    file.write_text(solved)
    return file


def test_maps_of_solve_are_sound(inside, maps):
    done = inside("check", GRID, maps, "--planar", "--closed", "--bound", "12", "--json")
    answer = json.loads(done.stdout)
    assert done.returncode == 0
    assert answer["unsound"] == []
    assert answer["checked"] == answer["count"] == 3
    assert answer["demands"] == ["planar", "closed", "bound(12)"]


@pytest.mark.parametrize("options", [["--opt-mode=optN"], []])
def test_maps_of_clingo_are_checked(inside, tmp_path, options):
    file = tmp_path / "maps.json"
    parts = ["closed", "boundary", *(["minimal"] if options else [])]
    files = [ENCODINGS / f"{part}.lp" for part in ("topomap", *parts)]
    file.write_text(run("clingo", *files, GRID, "0", "--outf=2", *options).stdout)
    assert inside("check", GRID, file, "--closed", "--boundary").returncode == 0
    done = inside("check", GRID, file, "--closed", "--planar")
    assert done.returncode == 1
    assert "violation(planar," in done.stdout


def test_demands_that_a_document_makes_are_checked(inside, maps):
    document = json.loads(maps.read_text())
    for key, value, fault in (
        ("parts", ["closed", "perpendicular"], "violation(perpendicular,"),
        ("bound", 8, "violation(bound(8),"),
        ("horizon", 15, "horizon: at ends after step 16"),
        ("cost", [1, 2], "cost: it is"),
        ("count", 4, "count is 4, but there are 3 maps"),
    ):
        maps.write_text(json.dumps({**document, key: value}))
        done = inside("check", GRID, maps)
        assert (done.returncode, fault in done.stdout) == (1, True), done.stdout


@pytest.mark.parametrize(
    ("key", "change"),
    [
        ("places", lambda said: said[0]["gateways"].pop()),
        ("places", lambda said: said[0]["landmarks"].append("a")),
        ("links", lambda said: said.pop()),
        ("links", lambda said: said.append(said[0])),
        ("paths", lambda said: said[0].pop()),
        ("paths", lambda said: said[0].reverse()),
        ("faces", lambda said: said.append(said[0])),
        ("faces", lambda said: said[0].reverse()),
        ("pending", lambda said: said.append([0, 0])),
        ("dstate", lambda said: said.reverse()),
        ("dstate", lambda said: said.append("a")),
        ("dstate", lambda said: said.__setitem__(0, float(said[0]))),
        ("places", lambda said: said[0].update(extra=1)),
        ("places", lambda said: said[0].update(place=float(said[0]["place"]))),
        ("places", lambda said: said[1]["gateways"].__setitem__(0, False)),
        ("links", lambda said: said[0][0].__setitem__(1, float(said[0][0][1]))),
    ],
)
def test_what_else_a_map_says_is_verified(inside, maps, key, change):
    document = json.loads(maps.read_text())
    change(document["maps"][1][key])
    maps.write_text(json.dumps(document))
    done = inside("check", GRID, maps)
    assert done.returncode == 1
    assert done.stdout == f"{maps}: map 2: {key}: not what at says\n3 maps, 1 unsound\n"


@pytest.mark.parametrize("key", ["places", "links", "paths", "faces", "pending", "dstate", "genus"])
@pytest.mark.parametrize("said", [{}, "", None, 1.0, [[]], [None], [{}]])
def test_what_a_map_says_is_of_the_right_kind(inside, maps, key, said):
    document = json.loads(maps.read_text())
    document["maps"][1][key] = said
    maps.write_text(json.dumps(document))
    assert f"map 2: {key}: not what at says\n" in inside("check", GRID, maps).stdout


def test_order_and_direction_do_not_matter(inside, maps):
    document = json.loads(maps.read_text())
    for one in document["maps"]:
        for key in ("at", "places", "links", "paths", "faces", "pending"):
            one[key].reverse()
        one["paths"] = [[[p, (s + 2) % 4] for p, s in reversed(path)] for path in one["paths"]]
        one["faces"] = [face[1:] + face[:1] for face in one["faces"]]
        one["links"] = [link[::-1] for link in one["links"]]
    maps.write_text(json.dumps(document))
    assert inside("check", GRID, maps).returncode == 0


def test_no_maps_are_sound(inside, maps):
    maps.write_text("[]")
    done = inside("check", GRID, maps)
    assert (done.returncode, done.stdout) == (0, "0 maps, none unsound\n")


def test_maps_of_part_of_the_steps_are_reported(inside, maps):
    document = json.loads(maps.read_text())
    at = [{"at": one["at"][:10]} for one in document["maps"][:1]] + document["maps"][1:]
    maps.write_text(json.dumps(at))
    done = inside("check", GRID, maps)
    assert done.stdout == "3 maps, none unsound; 1 of them for only part of the 16 steps\n"


def test_other_faults_of_maps(inside, maps, tmp_path):
    document = json.loads(maps.read_text())
    first = document["maps"][0]
    for entries, fault in (
        ([{"at": first["at"]}, {"at": first["at"]}], "map 2: the same as map 1"),
        ([{**first, "colour": 1}], "map 1: colour: no such key of a map"),
        ([{"at": [*first["at"][:-1], [16, 0, 2]]}], "violation(gateway,16)"),
        ([{"at": []}], "violation(exactly_one,0)"),
    ):
        maps.write_text(json.dumps(entries))
        done = inside("check", GRID, maps)
        assert (done.returncode, fault in done.stdout) == (1, True), done.stdout


def test_the_real_map_is_verified(inside, tmp_path):
    truth, instance = tmp_path / "truth.json", tmp_path / "grid.lp"
    call = ["generate", "grid", "3", "3", "--route", "snake"]
    assert not inside(*call, "--truth", truth, "-o", instance).returncode
    maps = tmp_path / "maps.json"
    assert not inside(
        "solve", instance, "--closed", "--truth", truth, "--json", "-o", maps
    ).returncode
    assert inside("check", instance, maps, "--truth", truth).returncode == 0
    assert "real: only --truth can tell" in inside("check", instance, maps).stdout
    maps.write_text(maps.read_text().replace('"real": true', '"real": false'))
    done = inside("check", instance, maps, "--truth", truth)
    assert (done.returncode, "real: it is the real map" in done.stdout) == (1, True)


@pytest.mark.parametrize(
    "text",
    [
        *("", "[", "3", "{}", "[" * 100000, '{"maps": 1}', '{"results": 1}', '{"Call": 3}'),
        '[{"at": 1}]',
        '[{"at": [[0, 0]]}]',
        '[{"at": [[0, 0, "a"]]}]',
        '[{"at": [[0, 0, true]]}]',
        '[{"at": [[99999999999, 0, 0]]}]',
        '{"Call": [{"Witnesses": [{"Value": ["at(0,0,a)"]}]}]}',
        '{"maps": [{"at": []}], "parts": "planar"}',
        '{"maps": [{"at": []}], "bound": "many"}',
        '{"maps": [{"at": []}], "horizon": [1]}',
        '{"maps": [{"at": []}], "parts": ["nonsense"]}',
        '{"maps": [{"at": []}], "count": true}',
        '{"maps": [{"at": []}], "colour": 1}',
        '{"maps": [{"at": []}], "kind": "nonsense"}',
        '{"maps": [{"at": []}], "kind": "consistent", "optimal": true}',
        '{"maps": [{"at": []}], "kind": "optimal", "optimal": false}',
        '{"maps": [{"at": []}], "nodes": -5}',
        '{"maps": [{"at": []}], "complete": true, "fault": "limit"}',
        '{"maps": [{"at": []}], "complete": false, "fault": null}',
        '{"maps": [], "count": 3}',
        json.dumps([{"at": [[0, 0, 0]] * 1000}]),
    ],
)
def test_what_is_not_a_document_of_maps_is_refused(inside, tmp_path, text):
    file = tmp_path / "maps.json"
    file.write_text(text)
    done = inside("check", GRID, file)
    assert done.returncode == 2
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"{file}: ")


def test_check_lp_is_decided_while_grounding():
    """So the aggregates in it are evaluated by gringo, and never reach clasp."""
    at = [(step, step, 0) for step in range(17)]
    text = "".join(f"at({t},{p},{s})." for t, p, s in at)
    text += "demand((planar;bound(3);closed;travelled;boundary;perpendicular))."
    done = run("clingo", ENCODINGS / "check.lp", GRID, "-", "--mode=gringo", "--text", input=text)
    assert "violation(bound(3),3)." in done.stdout.splitlines()
    assert not [line for line in done.stdout.splitlines() if ":-" in line or "{" in line]
    assert not done.stderr


def test_check_lp_gives_one_answer_without_anything():
    done = run("clingo", ENCODINGS / "check.lp", "--outf=1", "0")
    assert "ANSWER\nviolation(exactly_one,0).\n" in done.stdout
    assert not done.stderr


def test_a_file_of_several_instances(inside, tmp_path):
    maps = tmp_path / "maps.json"
    other = "instances/grid-3x4-paper.lp"
    assert not inside("solve", GRID, other, "--optimal", "--json", "-o", maps).returncode
    for file, number in ((GRID, 2), (other, 8)):
        done = inside("check", file, maps)
        assert done.stdout == f"{number} maps, none unsound\n"
    assert inside("check", "instances/grid-4x4-snake.lp", maps).returncode == 2


@pytest.mark.long
def test_a_circular_path_may_begin_anywhere(inside, tmp_path):
    """Either way round; but its order counts."""
    made = instance(grid(1, 5, "cylinder"), "walk", steps=12)
    file, seen = tmp_path / "maps.json", tmp_path / "ring.lp"
    seen.write_text(made.experience.facts())
    found = map_json(made.experience.map_of(made.truth), made.truth)
    (ring,) = [path for path in found["paths"] if len(path) > 1]
    back = [[place, (slot + 2) % 4] for place, slot in reversed(ring)]
    ways = [way[n:] + way[:n] for way in (ring, back) for n in range(len(ring))]
    wrong = [[*ring[:2], *reversed(ring[2:])], ring[:-1], [], [[place, 9] for place, _ in ring]]
    for way in ways + wrong:
        others = [path for path in found["paths"] if path != ring]
        file.write_text(json.dumps({"maps": [{**found, "paths": [way, *others]}]}))
        done = inside("check", seen, file)
        assert done.returncode == 1
        assert "path_circular" in done.stdout
        assert ("paths: not what at says" in done.stdout) == (way in wrong)
