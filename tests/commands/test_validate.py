"""``topomap validate``: every fault with its line and step, and warnings that are seldom false."""

import contextlib
import io
import json
import random
import re
import subprocess
import tempfile
from pathlib import Path

import pytest
from conftest import BIN, ROOT
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.instance_faults import KINDS, corrupted, errors
from test_cli import BAD
from topomap import cli
from topomap.model.facts import HINT, NAMED, SIGNATURES, parse, read
from topomap.runtime.errors import InputError, printable
from topomap.worlds.environment import grid, lattice, maze
from topomap.worlds.instance import instance

INSTANCES = sorted((ROOT / "instances").glob("*.lp"))
GRID = ROOT / "instances/grid-3x3-snake.lp"
BACK = "0 is the way back, straight on is 2"


@pytest.fixture
def judged(inside, tmp_path):
    """What the command says of a text: its exit status, and the lines without the file's name."""

    def judge(text, *arguments):
        file = tmp_path / "mine.lp"
        file.write_text(text)
        done = inside("validate", file, *arguments)
        assert not done.stderr
        assert all(line.startswith(f"{file}:") for line in done.stdout.splitlines())
        return done.returncode, [
            line.removeprefix(f"{file}:").strip() for line in done.stdout.splitlines()
        ]

    return judge


def test_a_good_instance_is_summed_up(judged):
    text = """\
slots(4). view(0,0). view(0,1).
turn(1,0). view(1,0). view(1,2). landmark(1,lift). landmark(1,shop("A")).
turn(2,2). view(2,0). view(2,2). landmark(2,lift).
"""
    assert judged(text) == (0, ["valid: 2 steps, 4 slots, 3 kinds of views, 2 landmarks"])
    one = "slots(2). view(0,0). turn(1,0). view(1,0). landmark(0,a). landmark(1,a)."
    assert judged(one) == (0, ["valid: 1 step, 2 slots, 1 kind of view, 1 landmark"])


MORE = "there may be more faults: what is missing can be said only when every statement is a fact"
FAULTS = {  # and all that is said of them
    "": ["there are no facts in it"],
    "\n\nslots(4).\nslots(6). slots(8).\nview(0,0).": ["4: 3 facts slots(K); there must be one"],
    "slots(4).\nview(0,0).\nturn(1,1). view(1,0). view(1,4).\nturn(2,0). turn(2,4).\nview(2,1).": [
        f"3: step 1: turn 1: no gateway there after step 0{HINT}",
        "3: step 1: slot 4 is not in 0..3",
        "4: step 2: more than one turn",
        "4: step 2: slot 4 is not in 0..3",
        f"5: step 2: the view lacks slot 0, the gateway where the agent stands{HINT}",
    ],
    "view(0,0).\n\nturn(2,0).\nview(2,0). landmark(4,a).\nturn(-1,0). turn(0,0).": [
        "no facts slots(K); there must be one",
        "5: step -1: steps are numbered from 0",
        "5: step 0: there is a turn, but step 1 is the first with a turn",
        "3: step 1: no turn, but there are later steps",
        "4: step 4: it has no turn (the last one is 2)",
    ],
    "slots(5).\nview(0,7).\nturn(1,0).": [
        "1: slots(5): K must be even, from 2 to 1000000",
        f"2: step 0: the view lacks slot 0, the gateway where the agent stands{HINT}",
        f"3: step 1: turn 0: no gateway there after step 0{HINT}",
        f"3: step 1: no view{HINT}",
    ],
    "slots(4). view(0,0).\nturn(1,0). view(1,0).\npick(1).\ndrop(0).\nmarker(1).\ndrop(1).": [],
    "slots(4). view(0,0).\nturn(1,0). view(1,0). shift(1,1.5,0).": [
        "2: 'shift(1,1' is not a ground fact: numbers are whole, without a decimal point",
        "2: '5,0)' is not a ground fact",
        MORE,
    ],
    "slots(4). view(0,0).\nstart(0).\nlook(0).": [
        "2: step 0: it is already the start",
        "3: step 0: there is no earlier look",
    ],
    "slots(4). view(0,0).\nturn(1,0). view(1,0).\npick(1).\nmarker(0).\ndrop(1).": [
        "4: step 0: the marker is seen, but lies nowhere",
        "3: step 1: the marker is taken up, but lies nowhere",
    ],
    # What may be missing only because it stands in a statement that was not read is not reported.
    "slots(4).\nveiw(0,0).\nturn(1,0) view(1,0).\nview(2).\nview(1,9). a :- b.\nturn(2,x).": [
        "2: veiw(0,0): veiw/2 is not known; did you mean view/2?",
        "3: 'turn(1,0) view(1,0)' is not a ground fact (is a full stop missing?)",
        "4: view(2): view has 2 arguments, view(T,S)",
        "5: 'a :- b' is not a ground fact",
        "6: turn(2,x): a step and a slot are whole numbers",
        "5: step 1: slot 9 is not in 0..3",
        MORE,
    ],
    "slots(4). view(0,0).\n% fine\nview(0,1)": ["3: 'view(0,1)' does not end", MORE],
    "slots(3).\n{view(0,0)}.": [
        "1: slots(3): K must be even, from 2 to 1000000",
        "2: '{view(0,0)}' is not a ground fact",
        MORE,
    ],
    "\n {": ["2: the facts of an instance are wanted, not JSON or a rule", MORE],
    # The text of a script is not of statements.
    "slots(5).\n#script (python) print(1). print(2). #end.\nview(X,0).": [
        "2: '#script (python) print(1)' is not a ground fact",
        "1: slots(5): K must be even, from 2 to 1000000",
        MORE,
    ],
}


def test_what_is_too_large_depends_on_the_percent(judged):
    """By a drift of 200 percent, half as much is a number of clingo as by 100 or less."""
    text = "slots(4). view(0,0).\nturn(1,0). view(1,0).\nshift(1,15000000,0).\nlength(1,15000000)."
    assert judged(text)[0] == judged(text, "--drift", "100")[0] == 0
    held = "with a drift of 200 % clingo's numbers hold 10737418 in all"
    far = f"the shifts up to here come to 15000000; {held}"
    assert judged(text, "--drift", "200") == (2, [f"3: step 1: {far}"])
    assert judged(text, "--stretch", "200") == (
        2,
        [
            "4: step 1: length 15000000 is above 10737418, the most that clingo's numbers hold "
            "with a stretch of 200 %"
        ],
    )


def test_a_shift_that_is_not_used_is_reported(judged):
    text = "slots(4). view(0,0).\nturn(1,0). view(1,0).\nstart(2). view(2,0). shift(2,1,1)."
    _, (_, warning) = judged(text)
    assert warning.startswith("3: step 2: warning: there is a shift, which is not used")
    assert len(judged(text.replace("shift(2", "shift(1"))[1]) == 1


@pytest.mark.parametrize("text", FAULTS)
def test_all_faults_are_reported(judged, text):
    status, lines = judged(text)
    if FAULTS[text]:
        assert (status, sorted(lines)) == (2, sorted(FAULTS[text]))
    else:
        assert (status, lines[0][:6]) == (0, "valid:")


@pytest.mark.parametrize("text", {**BAD, **FAULTS})
def test_the_first_fault_is_what_every_command_says(inside, judged, tmp_path, text):
    status, lines = judged(text)
    done = inside("solve", tmp_path / "mine.lp", "--limit", "1")
    assert (done.returncode == 2) == (status == 2)
    if status == 2:
        named = f"{tmp_path / 'mine.lp'}:"
        assert done.stderr in (f"{named}{lines[0]}\n", f"{named} {lines[0]}\n")


@pytest.mark.parametrize(
    ("fact", "fault"),
    [
        ("slot(4)", "slot/1 is not known; did you mean slots/1?"),
        ("views(0,1)", "views/2 is not known; did you mean view/2?"),
        ("landmrak(0)", "landmrak/1 is not known; did you mean landmark/2?"),
        ("landmark(0)", "landmark has 2 arguments, landmark(T,L)"),
        ("slots(4,4)", "slots has 1 argument, slots(K)"),
    ],
)
def test_what_was_meant_is_suggested(judged, fact, fault):
    status, lines = judged(f"slots(4). view(0,0).\n{fact}.")
    assert (status, lines) == (2, [f"2: {fact}: {fault}", MORE])
    for name in ("wall", "place", "at", "a" * 100_000):
        _, (line, _) = judged(f"slots(4). view(0,0). {name}(1).")
        assert "is not a fact over slots/1, view/2, turn/2, landmark/2, drop/1, pick/1," in line


def test_the_page_tells_each_form():
    page = (ROOT / "docs/writing-instances.md").read_text()
    rows = "".join(re.findall(r"^\| (`.*?) \|", page, re.M))
    told = re.findall("`(.*?)`", rows)
    assert [form for form in told if form not in NAMED.values()] == [*SIGNATURES.values()]
    assert {*NAMED.values()} <= {*told}


def test_each_form_is_read_as_it_is_given():
    """The forms in messages are facts, once their letters are values."""
    values = {
        "K": "4",
        "T": "1",
        "S": "0",
        "R": "0",
        "L": "a",
        "U": "0",
        "X": "3",
        "Y": "4",
        "D": "5",
        "M": "m",
    }
    forms = [*SIGNATURES.values(), *NAMED.values()]
    facts = [re.sub("[A-Z]", lambda match: values[match[0]], form) for form in forms]
    rest = {
        "start(1)": "start(2)",
        "look(1)": "look(3)",
        "pick(1)": "pick(2)",
        "pick(1,m)": "pick(2,m)",
    }
    facts = [rest.get(fact, fact) for fact in facts if not fact.startswith("apart")]
    seen = parse(". ".join([*facts, *(f"view({step},0)" for step in (0, 2, 3))]) + ".", "made")
    assert (seen.drops, seen.markers, seen.picks) == ({1}, {1}, {2})
    assert (seen.starts, seen.looks, seen.same) == ({2}, {3}, {(0, 1)})
    assert (seen.compass[1], seen.shifts[0], seen.lengths[0]) == (0, (3, 4), 5)
    assert len(seen.straight) == seen.steps + 1
    assert seen.things == {("drop", 1, "m"), ("pick", 2, "m"), ("marker", 1, "m")}


def test_many_faults_are_cut_short(judged):
    facts = [f"view(0,{slot})." for slot in range(2, 3000)]
    status, lines = judged("slots(2). view(0,0).\n" + "\n".join(facts))
    assert status == 2
    assert len(lines) == 52
    assert lines[49:] == [
        "51: step 0: slot 51 is not in 0..1",
        "and 950 more faults: see --json",
        "there may be more faults: only the first 1,000 are listed",
    ]
    status, lines = judged("slots(2). view(0,0).\n" + "\n".join(facts[:1000]))
    assert (status, len(lines)) == (2, 51)
    status, lines = judged("slots(2). view(0,0).\n" + "\n".join(facts[:50]))
    assert (status, len(lines)) == (2, 50)


def test_json_has_more_faults_than_lines(inside, tmp_path):
    file = tmp_path / "bad.lp"
    file.write_text("slots(2). view(0,0).\n" + "".join(f"view(0,{n}).\n" for n in range(2, 3000)))
    (told,) = json.loads(inside("validate", file, "--json").stdout)["files"]
    assert len(told["faults"]) == 1000
    assert told["more_faults"] == "only the first 1,000 are listed"


def test_several_files_and_standard_input(tmp_path):
    (tmp_path / "bad.lp").write_text("slots(5).\nview(0,0).")
    (tmp_path / "binary.lp").write_bytes(b"\xff\0")
    (tmp_path / "map.json").write_text('{"maps": []}')
    files = ["bad.lp", "none.lp", "-", "binary.lp", "map.json", GRID, tmp_path.parent]
    done = subprocess.run(
        [BIN / "topomap", "validate", *files],
        input="slots(4). view(0,0).\nturn(1,0). view(1,0). view(1,4).",
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    assert (done.returncode, done.stderr) == (2, "")
    assert done.stdout.splitlines() == [
        "bad.lp:1: slots(5): K must be even, from 2 to 1000000",
        "none.lp: no such file or directory",
        "-:2: step 1: slot 4 is not in 0..3",
        "binary.lp: not a text file",
        "map.json:1: the facts of an instance are wanted, not JSON or a rule",
        f"map.json: {MORE}",
        f"{GRID}: valid: 16 steps, 4 slots, 6 kinds of views, 0 landmarks",
        f"{tmp_path.parent}: is a directory",
    ]


def test_json(inside, tmp_path):
    bad, odd = tmp_path / "bad.lp", tmp_path / "odd.lp"
    bad.write_text("slots(4).\nview(0,0). view(0,4).\nview(0).")
    odd.write_text("slots(4).\nview(0,0). landmark(0,a).")
    done = inside("validate", bad, GRID, odd, "--json")
    assert (done.returncode, done.stderr) == (2, "")
    none = dict.fromkeys(("steps", "slots", "views", "landmarks"))
    good = {"valid": True, "faults": [], "more_faults": None, "slots": 4}
    answer = json.loads(done.stdout)
    assert answer == {
        "format": 1,
        "files": [
            {
                "file": str(bad),
                "valid": False,
                **none,
                "faults": [
                    {
                        "line": 3,
                        "step": None,
                        "fault": "view(0): view has 2 arguments, view(T,S)",
                    },
                    {"line": 2, "step": 0, "fault": "slot 4 is not in 0..3"},
                ],
                "more_faults": MORE.partition(": ")[2],
                "warnings": [],
            },
            {"file": str(GRID), **good, "steps": 16, "views": 6, "landmarks": 0, "warnings": []},
            {
                "file": str(odd),
                **good,
                "steps": 0,
                "views": 1,
                "landmarks": 1,
                "warnings": [{"line": 2, "step": 0, "warning": STILL}],
            },
        ],
        "complete": True,
        "fault": None,
    }
    assert inside("validate", GRID, odd, "--json").returncode == 0


# Warnings

STILL = "there is no turn(1), so the place where the agent starts is never left"
START = (
    "after a travel, slot 0 is the gateway by which you arrived (behind you); at the start you "
    "choose it, and turn(1) counts from it"
)
ALWAYS = f"every turn from step 2 is 0: the agent turns back at once everywhere; {BACK}"
NEVER = "places that look like the one after this step are always left by the way back, in 4 "


def log(turns, views):
    """The facts of an exploration, each step in a line of its own."""
    lines = ["slots(4)."]
    for step, (turn, view) in enumerate(zip([None, *turns], views, strict=True)):
        line = [] if turn is None else [f"turn({step},{turn})."]
        lines.append(" ".join([*line, *(f"view({step},{slot})." for slot in view)]))
    return "\n".join(lines)


def warned(judged, turns, views):
    """The warnings about an exploration."""
    status, (valid, *warnings) = judged(log(turns, views))
    assert (status, valid[:6]) == (0, "valid:")
    return warnings


CROSSING = (0, 1, 2, 3)


def test_a_start_that_looks_like_an_arrival(judged):
    """The agent stands in a corner and looks along one of its ways, which are straight on and to
    the right; someone adds a way behind, so that there is a slot 0."""
    (warning,) = warned(judged, [2, 2], [(0, 2, 3), (0, 2), (0, 1)])
    assert warning.startswith("3: step 1: warning: turn(1) is 2, so the start looks like an ")
    assert START in warning
    assert not warned(judged, [0, 2], [(0, 1), (0, 2), (0, 1)])
    (warning,) = warned(judged, [3, 2], [CROSSING, (0, 2), (0, 1)])
    assert "turn(1) is 3" in warning


@pytest.mark.slow
def test_every_start_can_be_given_without_the_warning(inside, judged, tmp_path):
    """Counted from the gateway that is left by, the same exploration has as many maps."""
    seen = instance(grid(3, 3), "snake", facing=2).experience
    turn = seen.turns[0]
    assert turn
    turned = log(
        [0, *seen.turns[1:]],
        [sorted((slot - turn) % 4 for slot in seen.views[0]), *map(sorted, seen.views[1:])],
    )
    counts = []
    for text, warnings in ((seen.facts(), 1), (turned, 0)):
        status, lines = judged(text)
        assert (status, len(lines) - 1) == (0, warnings)
        counts.append(inside("count", tmp_path / "mine.lp", "--json").stdout)
    nodes = [json.loads(count)["per_step"] for count in counts]
    assert nodes[0] == nodes[1]


def test_turning_back_everywhere(judged):
    """An author who takes 0 for straight on, along a corridor."""
    corridor = [(0,), (0, 2), (0, 2), (0, 2), (0,)]
    assert warned(judged, [0, 0, 0, 0], corridor) == [f"4: step 2: warning: {ALWAYS}"]
    assert not warned(judged, [0, 2, 2, 2], corridor)
    assert not warned(judged, [0, 0, 0, 2], corridor)
    # There and back between two dead ends: there is no other way.
    assert not warned(judged, [0, 0, 0, 0], [(0,)] * 5)
    assert not warned(judged, [0, 0, 0], corridor[:4])  # too few to tell


def test_places_that_are_never_left(judged):
    """Four times the agent comes to a corner, by either way, and turns back; at crossings it
    goes on."""
    views = [CROSSING, (0, 1), CROSSING, (0, 3), CROSSING, (0, 1), CROSSING, (0, 3), CROSSING]
    turns = [0, 0, 1, 0, 1, 0, 1, 0]
    (warning,) = warned(judged, turns, views)
    assert warning.startswith(f"3: step 1: warning: {NEVER}visits, though they have other")
    assert BACK in warning
    assert not warned(judged, [0, 0, 1, 0, 1, 0, 1, 3], views)  # the last corner is left
    assert not warned(judged, turns[:7], views[:8])  # too few to tell
    ends = [view if view == CROSSING else (0,) for view in views]  # of a dead end there is no other
    assert not warned(judged, turns, ends)


def test_an_exploration_without_a_step(judged):
    assert judged("slots(4).\n\nview(0,0).")[1][1:] == [f"3: step 0: warning: {STILL}"]


def test_committed_instances_are_not_warned_of(inside):
    done = inside("validate", *INSTANCES)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert [line.split(": ")[:2] for line in lines] == [[str(file), "valid"] for file in INSTANCES]
    for line, file in zip(lines, INSTANCES, strict=True):
        seen = read(file, noisy=True)
        assert f"valid: {seen.steps} steps, {seen.slots} slots, " in line


def explored():
    """Explorations that topomap generate makes, and whether they are random walks."""
    for seed in range(6):
        worlds = [
            *(grid(2 + seed % 3, 2 + seed % 4), grid(3, 2 + seed % 4, "torus")),
            *(maze(2 + seed % 3, 4, 0.3, seed), maze(4, 4, 1.0, seed)),
            *(lattice("hexagons", 1 + seed % 2, 2), lattice("triangles", 2, 2 + seed % 2)),
        ]
        for place in worlds:
            yield False, instance(place, "tour", signs=0.3, seed=seed)
            for steps in (5, 12, 40):
                yield True, instance(place, "walk", steps=steps, seed=seed)
        yield False, instance(worlds[0], "snake")


def test_generated_instances_are_seldom_warned_of(inside, tmp_path):
    """Never those that go somewhere; of random walks, which may turn back anywhere, few."""
    walks = {}
    for number, (walk, made) in enumerate(explored()):
        file = tmp_path / f"{number}.lp"
        file.write_text(made.text())
        walks[str(file)] = walk
    done = inside("validate", *walks, "--json")
    assert done.returncode == 0
    warned = [file["file"] for file in json.loads(done.stdout)["files"] if file["warnings"]]
    assert all(walks[file] for file in warned)
    assert sum(walks.values()) > 100
    assert len(walks) - sum(walks.values()) > 40
    assert len(warned) < sum(walks.values()) / 20


# Beside encodings/input.lp

SAME = {  # errors of input.lp of which only one is reported
    r"(\d+),no_step": r"\1,no_turn",
    r"-1,no_step\((-\d+)\)": r"-1,negative(\1)",
    r"-1,(odd|few|many)_slots\(.*\)": "-1,slots",
    r"(\d+),(put_down|taken_up|no_marker)": r"\1,marker",
}


def one_word(error):
    for pattern, same in SAME.items():
        if re.fullmatch(pattern, error):
            return re.sub(pattern, same, error)
    return error


def of_input(facts):
    """The errors that input.lp shows, in the words of SAME."""
    return {one_word(error[6:-1]) for error in errors(facts)}


def of_validate(file):
    """The faults, as input.lp would show them, in the words of SAME; None where one is not one of
    its errors."""
    shown = set()
    for fault in file["faults"]:
        step = "" if fault["step"] is None else f"step {fault['step']}: "
        said = f"{step}{fault['fault']}"
        ((wanted, groups),) = [
            (meant, match.groupdict())
            for pattern, meant in KINDS.items()
            if (match := re.fullmatch(pattern, said))
        ]
        error = wanted.format(**groups).replace("\\", "")
        shown.add(one_word(error.replace("(odd|few|many)", "odd")))
    return shown


@pytest.mark.slow
@pytest.mark.parametrize(
    "seeds", [range(400), pytest.param(range(400, 12000), marks=pytest.mark.long)]
)
def test_validate_and_input_lp_find_the_same_faults(inside, tmp_path, seeds):
    """In facts that clingo reads both find a fault or neither does; and where every fact could be
    read, and one K is given, the faults are the same ones. (input.lp cannot see what is wrong with
    the text: a statement that is not a fact, or an unknown predicate, is not an error there,
    or clingo's own.)"""
    texts = {}
    for seed in seeds:
        file = tmp_path / f"{seed}.lp"
        file.write_text(corrupted(random.Random(f"validate {seed}")))
        texts[str(file)] = file.read_text()
    compared = bad = 0
    done = inside("validate", *texts, "--json")
    for file in json.loads(done.stdout)["files"]:
        text = texts[file["file"]]
        shown = of_input(text)
        assert bool(shown) != file["valid"], text
        assert bool(file["faults"]) != file["valid"], text
        bad += not file["valid"]
        if file["more_faults"]:
            continue
        told = of_validate(file)
        if any(error.startswith("-1,") and "slots" in error for error in shown):
            # No slot is checked against a K that is wrong, and where there is neither a K nor a
            # view nor a turn, no more is reported.
            shown = {
                error for error in shown if not re.match(r"\d+,((straight|compass)_)?slot", error)
            }
            told = {
                error for error in told if not re.match(r"\d+,((straight|compass)_)?slot", error)
            }
            if not re.search(r"\b(slots|view|turn)\(", text):
                shown &= {"-1,no_slots"}
        # A turn out of range is reported once; after a gap nobody knows where the marker lies.
        shown -= {
            error
            for error in shown
            if error.replace("no_gateway", "slot") in shown and "no_gateway" in error
        }
        gap = min((int(error.split(",")[0]) for error in shown if "no_turn" in error), default=None)
        if gap is not None:
            shown = {e for e in shown if "marker" not in e or int(e.split(",")[0]) < gap}
        assert told == shown, text
        compared += bool(told)
    assert len(seeds) // 2 < bad < len(seeds)
    assert compared > len(seeds) // 4


# Anything

WORDS = st.sampled_from(
    [
        *("slots(4).", "view(0,0).", "view(0,1).", "turn(1,0).", "view(1,0).", "drop(0)."),
        *("landmark(1,a).", "veiw(0,0).", "view(0).", "view(-1,0).", "turn(3,0).", "view(0,9)."),
        *("(", ")", ",", ".", "..", '"', "%", "%*", "*%", "\n", " ", "f(", "-", "#script (lua)"),
        *("99999999999", "X", "{", "\u2028", "\x1b[31m", "\u0663", "a:-b.", "#inf", "\ufeff"),
    ]
)
CONTENT = st.one_of(
    st.binary(max_size=60),
    st.text(max_size=60).map(lambda text: text.encode("utf-8", "surrogatepass")),
    st.lists(WORDS, max_size=25).map("".join).map(str.encode),
)


@settings(max_examples=200, deadline=None)
@given(CONTENT)
def test_any_file_is_judged(content):
    """Without a traceback; as bad if and only if every other command refuses it, and the first
    fault is what they say."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "any.lp"
        file.write_bytes(content)
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            status = cli.main(["validate", str(file)])
        lines = out.getvalue().removesuffix("\n").split("\n")
        assert not err.getvalue()
        assert all(line.startswith(f"{file}:") and line.isprintable() for line in lines)
        if status == 0:
            read(file)
            assert lines[0].startswith(f"{file}: valid: ")
            assert all(" warning: " in line for line in lines[1:])
        else:
            with pytest.raises(InputError) as refused:
                read(file)
            assert (status, lines[0]) == (2, printable(str(refused.value)))
