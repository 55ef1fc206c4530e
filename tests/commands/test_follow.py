"""``topomap follow``: lines of both kinds, growing files, faults, kills, and the same bytes."""

import contextlib
import json
import random
import re
import signal
import subprocess
import time

import pytest
import topomap as topomap_api
from conftest import BIN, ROOT, TRIED
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.brute_force import certain
from oracles.worlds import marks, random_experience
from topomap.model.experience import observe
from topomap.model.facts import parse, read
from topomap.model.query import Query
from topomap.questions.lines import decoded
from topomap.questions.records import Record
from topomap.runtime.errors import InputError
from topomap.search.traversal import depth_first, root
from topomap.worlds.environment import EAST, grid
from topomap.worlds.route import snake

GRID = ROOT / "instances/grid-3x3-snake.lp"
FACTS = GRID.read_text()
LINES = [line for line in FACTS.splitlines() if line and not line.startswith("%")]


def in_json(experience):
    """The lines of an experience, in JSON."""
    seen = zip(experience.views, experience.landmarks, strict=True)
    for step, (view, landmarks) in enumerate(seen):
        first = {"turn": experience.turns[step - 1]} if step else {"slots": experience.slots}
        rest = {"landmarks": sorted(landmarks)} if landmarks else {}
        rest |= dict.fromkeys(sorted(marks(experience, step)), True)
        yield json.dumps({**first, "view": sorted(view), **rest})


def answers(text):
    """The answers without the seconds."""
    told = [json.loads(line) for line in text.splitlines()]
    return [{key: value for key, value in one.items() if key != "seconds"} for one in told]


def follow(topomap, text, *arguments, status=0):
    done = topomap("follow", "--json", *arguments, input=text, timeout=60)
    assert done.returncode == status, done.stderr
    return answers(done.stdout)


def recorded(lines):
    record = Record()
    for number, line in enumerate(lines, 1):
        record = record.with_line(line, "x", number)
    return record


def of_record(record):
    """The facts that a record holds."""
    facts = [f"slots({record.slots})."]
    for number, step in enumerate(record.whole()):
        facts += [f"view({number},{slot})." for slot in step.view]
        facts += [f"landmark({number},{term})." for term in step.landmarks]
        facts += [f"turn({number},{step.turn})."] * (step.turn is not None)
        facts += [f"{name}({number})." for name in step.marks]
    return parse("\n".join(facts), "x")


def test_the_papers_instance(topomap):
    levels = [0] * 17
    experience = read(GRID)
    for node in depth_first(root(experience, Query(frozenset(["planar"])))):
        levels[node.steps] += 1
    told = follow(topomap, FACTS, "--planar")
    assert [one["step"] for one in told] == list(range(17))
    assert [one["hypotheses"] for one in told] == levels
    assert all(one["exact"] and one["complete"] for one in told)
    assert (told[-1]["best"]["kind"], told[-1]["best"]["cost"]) == ("optimal", [0, 6, 9])
    assert told[-1]["next"] == {
        "kind": "settled",
        "turns": [],
        "drop": None,
        "left": 1,
        "proved": True,
    }
    assert told[0]["next"]["kind"] == "pending"
    # What has become certain, step by step, is what is certain at the end.
    nodes = depth_first(root(experience, Query(frozenset(["planar"]))))
    same, new = certain([node.dstates for node in nodes if node.steps == 16])
    assert {tuple(pair) for one in told for pair in one["certain"]["same"]} == same
    assert {step for one in told for step in one["certain"]["new"]} == new


def test_the_same_in_every_form(topomap):
    seen = read(GRID).cut(7)
    lines = seen.facts().splitlines()
    whole = follow(topomap, "\n".join(lines))
    assert follow(topomap, "\n".join(in_json(seen))) == whole
    assert follow(topomap, " ".join(lines)) == whole
    assert follow(topomap, "\r\n\r\n% a walk\r\n".join(lines)) == whole


def test_what_is_read_by_people(topomap):
    text = topomap("follow", GRID, "--no-wait").stdout
    levels = [0] * 17
    for node in depth_first(root(read(GRID), Query())):
        levels[node.steps] += 1
    numbers = re.findall(r"^step (\d+): (\d+) hypothes[ei]s \(", text, re.MULTILINE)
    assert [(int(step), int(number)) for step, number in numbers] == list(enumerate(levels))
    assert "\n  certain now: new(0)\n" in text
    first = "\n  next: turn 0 (by the gateway where it stands): to a pending gateway\nstep 1: "
    assert first in text
    assert (
        "\n  2 optimal maps, cost 0 6 9\n  next: nothing; no walk tells the 2 maps apart\n" in text
    )


def test_one_fact_a_line_amends_the_step(topomap):
    facts = [fact + "." for line in LINES[:6] for fact in re.findall(r"\w+\([^)]*\)", line)]
    told = follow(topomap, "\n".join(facts))
    whole = follow(topomap, "\n".join(LINES[:6]))
    last = {one["step"]: one for one in told}
    assert [last[step]["hypotheses"] for step in range(5)] == [one["hypotheses"] for one in whole]
    assert [last[step]["best"] for step in range(5)] == [one["best"] for one in whole]
    assert len(told) > len(whole)


def test_steps_taken_back(topomap):
    away = ["turn(6,0). view(6,0). view(6,2).", "turn(7,2). view(7,0).", "undo(2). % back"]
    whole = follow(topomap, "\n".join(LINES[:10]))
    told = follow(topomap, "\n".join([*LINES[:7], *away, *LINES[7:10]]))
    assert [one["step"] for one in told] == [0, 1, 2, 3, 4, 5, 6, 7, 5, 6, 7, 8]
    assert told[8:] == whole[5:]


def settled_by_a_marker():
    """The snake of 3x3, which leaves two maps for ever; then the marker, and a walk."""
    made = grid(3, 3)
    route = snake(made)
    place, slot = (0, 0), EAST
    for leaves in route:
        place, slot = made.map.links[place, leaves]
    for turn in [0, 1, 1, 1]:
        route.append((slot + turn) % 4)
        place, slot = made.map.links[place, route[-1]]
    return observe(made.map, ((0, 0), EAST), route, drops=[16])[0]


@pytest.mark.long
@pytest.mark.parametrize("form", ["facts", "json", "amended"])
def test_a_marker_settles_what_else_nothing_does(topomap, tmp_path, form):
    experience = settled_by_a_marker()
    lines = experience.facts().splitlines()[1:]
    lines[0] = f"slots(4). {lines[0]}"
    if form == "json":
        lines = list(in_json(experience))
    if form == "amended":
        lines[16] = lines[16].removesuffix(" drop(16).")
        lines.insert(17, "drop(16).")
    told = follow(topomap, "\n".join(lines))
    assert (told[-1]["best"]["count"], told[-1]["next"]["kind"]) == (1, "settled")
    marked = [one for one in told if one["step"] == 16]
    assert marked[-1]["best"]["count"] == 2
    # Where the marker lies now, the next best action is a walk.
    assert (marked[-1]["next"]["kind"], marked[-1]["next"]["left"]) == ("apart", 1)
    if form == "amended":
        assert marked[0]["next"]["kind"] == "bisimilar"
        bare = lines[:17]
        carried = follow(topomap, "\n".join(bare), "--marker")[-1]["next"]
        assert (carried["kind"], carried["left"]) == ("apart", 1)
        assert carried["drop"] is not None
        text = topomap("follow", "--marker", input="\n".join(bare)).stdout
        assert text.splitlines()[-1].count("the marker put down before; ") == 1
    # Taken back with its step, and from a log.
    log = tmp_path / "walk.log"
    follow(topomap, "\n".join(lines[: 18 + (form == "amended")]), "--log", log)
    again = follow(topomap, "\n".join(["undo.", *lines[-4:]]), "--log", log)
    assert [one["step"] for one in again] == [17, 16, 17, 18, 19, 20]
    assert again[-1]["best"] == told[-1]["best"]
    gone = follow(topomap, "undo(5).\nturn(16,2). view(16,0). view(16,3).", "--log", log)
    assert [one["step"] for one in gone] == [20, 15, 16]
    assert gone[-1]["next"]["kind"] == "bisimilar"


def test_no_hypothesis_left_is_said_and_mended(topomap):
    lines = ["slots(2). view(0,0). view(0,1). landmark(0,a).", "turn(1,1). view(1,0)."]
    lines.append("turn(2,0). view(2,0). view(2,1). landmark(2,b).")
    told = follow(topomap, "\n".join(lines), status=1)
    assert [one["none_since"] for one in told] == [None, None, 2]
    assert (
        topomap("follow", input="\n".join(lines))
        .stdout.splitlines()[-1]
        .startswith("step 2: no hypothesis is left (")
    )
    assert len(follow(topomap, "\n".join([*lines, "undo."]))) == 4


BAD = [
    ("wall(0,1).", "wall(0,1) is not a fact over slots/1, view/2, turn/2, landmark/2, drop/1, "),
    ("veiw(2,0).", "veiw(2,0): veiw/2 is not known; did you mean view/2?"),
    ("undone(1).", "undone(1): undone/1 is not known; did you mean undo/1?"),
    ("turn(2,0). undo(1).", "undo(1): undo is a line by itself"),
    ("view(3,0).", "step 3: the log is at step 1, and goes on with that or with step 2"),
    ("view(0,3).", "step 0: the log is at step 1, and goes on with that or with step 2"),
    ("turn(2,4).", "step 2: slot 4 is not in 0..3"),
    ("turn(2,1).", "step 2: turn 1: no gateway there after step 1"),
    ("turn(2,0). turn(2,2).", "step 2: more than one turn"),
    ("slots(4).", "slots are given twice"),
    ("view(2,0) :- a.", "'view(2,0) :- a' is not a ground fact"),
    ("#script (python) print(1) #end.", "is not a ground fact"),
    ("view(2,0)", "'view(2,0)' does not end"),
    ("view(X,0).", "is not a ground fact"),
    ("marker(1).", "step 1: the marker is seen, but lies nowhere"),
    ("pick(1). drop(1).", "step 1: the marker is taken up, but lies nowhere"),
    ("drop(0). turn(2,0). view(2,0). drop(2).", "step 0: the log is at step 1, and goes on with"),
    ("drop(1). turn(2,0). view(2,0). drop(2).", "step 2: the marker is put down, but lies"),
    ("drop(1,0,0).", "drop(1,0,0): drop has 1 argument, drop(T), or 2 with a name"),
    ("drop(1,a). drop(1,b). turn(2,0). view(2,0). drop(2,a).", "step 2: the marker a is put down,"),
    ("pick(a).", "pick(a): a step is a whole number"),
    ('{"turn": 0, "view": [0], "drop": 1}', "drop: true or false is wanted"),
    ('{"turn": 0, "view": [0], "pick": true}', "step 2: the marker is taken up, but lies nowhere"),
    ("undo(2).", "undo of 2 steps: to take back: 1 step"),
    ('{"turn": 0, "view": [0]', "not a JSON text"),
    ("[1]", "a JSON object is wanted"),
    ('{"turn": 0}', "view is missing"),
    ('{"view": [0]}', "turn is missing"),
    ('{"turn": 0, "view": [2]}', "step 2: the view lacks slot 0, the gateway where the agent"),
    (
        '{"turn": 0, "view": [0], "sound": 1}',
        '"sound": not one of apart, compass, drop, landmarks, length, look, marker, pick, same, '
        "shift, start, straight, turn, view",
    ),
    ('{"turn": true, "view": [0]}', "turn: a whole number is wanted"),
    ('{"turn": 0, "view": 0}', "view: a list of slots is wanted"),
    ('{"turn": 0, "view": [0], "landmarks": ["X"]}', "is not a ground fact"),
    ('{"turn": 0, "view": [0], "landmarks": ["a). view(7,0"]}', "is not a ground"),
    ('{"turn": 0, "view": [0], "compass": 4}', "step 2: compass slot 4 is not in 0..3"),
    ('{"turn": 0, "view": [0], "compass": "n"}', "compass: a slot is wanted"),
    ('{"turn": 0, "view": [0], "shift": [1]}', "shift: a list of two whole numbers is wanted"),
    ('{"turn": 0, "view": [0], "shift": [0, 21474837]}', "step 2: the shifts up to here come to"),
    ('{"turn": 0, "view": [0], "length": 0}', "step 2: length 0 is not above 0"),
    ('{"turn": 0, "view": [0], "apart": [2]}', "step 2: it is said to be at another place"),
    ('{"turn": 0, "view": [0], "same": [3]}', "same: step 3 is later than step 2"),
    (
        '{"look": true, "view": [0], "length": 5}',
        "step 2: there is a length, but it is not a travel step",
    ),
    ('{"look": true, "start": true, "view": [0]}', "step 2: it begins a log, and is a second look"),
    ('{"turn": 0, "view": [0], "drop": [7]}', "drop: true or false is wanted, or the names of"),
    ('{"turn": 0, "view": [0], "drop": "a)."}', "drop: "),
    ('{"turn": 0, "view": [0], "pick": "a"}', "the marker a is taken up, but lies nowhere"),
    ("start(2). view(2,0). turn(2,0).", "step 2: it has a turn, but is not a travel step"),
    ('{"undo": 5}', "undo of 5 steps: to take back: 1 step"),
    ("\0", "not text"),
]


def test_a_new_log_is_refused_where_maps_are_to_be_planar(topomap):
    """In one line that names the line of the input; all that was sent before is answered."""
    text = "\n".join([*LINES[:3], "start(2). view(2,0)."])
    done = topomap("follow", "--planar", input=text)
    assert done.returncode == 2
    said = "standard input:4: step 2: a new log is not followed if maps are to be planar\n"
    assert done.stderr == said
    assert "step 1" in done.stdout
    begun = topomap_api.follow(4, planar=True)
    begun.step([0])
    with pytest.raises(ValueError, match="a new log is not followed"):
        begun.step([0], start=True)
    lone = "slots(4). view(0,0). start(1). view(1,0)."
    refused = topomap("branching", "-", input=lone)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr == "branching: equation (1) is of one log, without start(T)\n"


def test_a_key_that_is_null_counts_as_missing():
    """A program that writes a line for each step may keep all keys, also on the first line."""
    first = {"slots": 4, "view": [0], "compass": 1}
    second = {"turn": 0, "view": [0, 1], "shift": [3, 0]}
    keys = ("landmarks", "marker", "drop", "pick", "same", "apart", "length", "start", "look")
    null = dict.fromkeys(keys)
    plain = recorded([json.dumps(first), json.dumps(second)])
    assert recorded([json.dumps(null | first), json.dumps(null | second)]) == plain
    false = {"start": False, "look": False, "marker": False}
    assert recorded([json.dumps(false | first), json.dumps(false | second)]) == plain
    with pytest.raises(InputError, match="it is already the start"):
        recorded([json.dumps(first | {"start": True})])
    with pytest.raises(ValueError, match="shift"):
        topomap_api.follow(4).step([0], shift=())


@pytest.mark.parametrize(("line", "fault"), BAD)
def test_a_bad_line_is_refused(line, fault):
    begun = recorded(LINES[:3])
    with pytest.raises(InputError) as refused:
        begun.with_line(decoded(line.encode(), "x", 4), "x", 4)
    assert str(refused.value).startswith("x:4: ")
    assert fault in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_bad_line_ends_it_or_is_passed_over(topomap, tmp_path):
    text = "\n".join([*LINES[:3], "view(9,0).", *LINES[3:5]])
    file = tmp_path / "walk.lp"
    file.write_text(text)
    for arguments, name in ((["-"], "standard input"), ([file, "--no-wait"], str(file))):
        done = topomap("follow", "--json", *arguments, input=text)
        assert done.returncode == 2
        assert (
            done.stderr
            == f"{name}:4: step 9: the log is at step 1, and goes on with that or with step 2\n"
        )
        assert len(done.stdout.splitlines()) == 2
    done = topomap("follow", "--json", "--keep-going", input=text)
    assert (done.returncode, done.stderr.count("\n")) == (0, 1)
    assert len(done.stdout.splitlines()) == 4


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "standard input: no step in it"),
        ("slots(4).\n", "standard input: no step in it"),
        ("slots(4). view(0,1).\n", "standard input: step 0: the view lacks slot 0"),
        (LINES[0] + LINES[1] + "view(1,0).", "standard input: step 1: no turn"),
        (LINES[0] + LINES[1] + "turn(1,0).", "standard input: step 1: no view"),
    ],
)
def test_an_end_too_early(topomap, text, fault):
    done = topomap("follow", input=text)
    assert done.returncode == 2
    assert done.stderr.startswith(fault)
    assert done.stderr.count("\n") == 1


def started(*arguments, **options):
    program = BIN / "topomap"
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(
        [program, "follow", *arguments], text=True, cwd=ROOT, **pipes, **options
    )


def test_a_file_that_grows(tmp_path):
    file = tmp_path / "walk.lp"
    file.write_text("\n".join(LINES[:3]) + "\nturn(2,2). vie")
    process = started(file, "--json")
    told = [json.loads(process.stdout.readline()) for _ in range(2)]
    time.sleep(0.5)
    with file.open("a") as more:
        more.write("w(2,0). view(2,3).\n")
    told.append(json.loads(process.stdout.readline()))
    process.send_signal(signal.SIGTERM)
    rest, errors = process.communicate(timeout=10)
    assert [one["step"] for one in told] == [0, 1, 2]
    assert (rest, errors, process.returncode) == ("", "interrupted\n", 130)


def test_a_file_that_becomes_shorter(tmp_path):
    file = tmp_path / "walk.lp"
    file.write_text(FACTS)
    process = started(file)
    assert process.stdout.readline().startswith("step 0:")
    file.write_text(LINES[0])
    assert "it became shorter" in process.communicate(timeout=20)[1]
    assert process.returncode == 2


@pytest.mark.parametrize("cuts", [1, pytest.param(30, marks=pytest.mark.long)])
def test_a_killed_follower_goes_on_from_its_log(topomap, tmp_path, cuts):
    whole = {one["step"]: one for one in follow(topomap, "\n".join(LINES[:12]))}
    for number in range(cuts):
        draw = random.Random(f"kill {number}")
        log = tmp_path / f"{number}.log"
        told, sent = [], 0
        while True:
            process = started("--json", "--log", log)
            have = log.read_bytes().count(b"\n") if log.exists() else 0
            assert have >= max((one["step"] + 2 for one in answers("".join(told))), default=0)
            sent = have
            stop = draw.randint(sent + 1, 12)
            for line in LINES[sent : min(stop, 12)]:
                process.stdin.write(line + "\n")
            process.stdin.flush()
            if stop >= 12:
                out, errors = process.communicate(timeout=60)
                assert process.returncode == 0, errors
                told.append(out)
                break
            time.sleep(draw.choice([0.3, 0.6, 0.9]))
            process.kill()
            told.append(process.communicate()[0])
            told[-1] = told[-1][: told[-1].rfind("\n") + 1]
            TRIED["followers killed"] += 1
        assert log.read_text().splitlines() == LINES[:12]
        for one in answers("".join(told)):
            good = whole[one["step"]]
            assert {**one, "certain": None} == {**good, "certain": None}
        assert {one["step"] for one in answers("".join(told))} >= {10}


def test_a_torn_log(topomap, tmp_path):
    log = tmp_path / "walk.log"
    log.write_text("\n".join(LINES[:4]) + "\nturn(3,3). vi")
    done = topomap("follow", "--json", "--log", log, input=LINES[4])
    assert done.stderr == f"{log}:5: an incomplete line, dropped\n"
    assert [one["step"] for one in answers(done.stdout)] == [2, 3]
    assert log.read_text() == "\n".join(LINES[:5]) + "\n"
    log.write_text("slots(4).\nview(0,X).\n")
    done = topomap("follow", "--log", log, input="")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"{log}:2: ")
    for other in (tmp_path, tmp_path / "none" / "log", "/dev/full"):
        done = topomap("follow", "--log", other, input=LINES[0])
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert done.stderr.startswith(str(other))
    assert topomap("follow", GRID, "--log", log).returncode == 2


@pytest.mark.parametrize("cut", [1, 3])
def test_a_log_that_ends_within_a_step(topomap, tmp_path, cut):
    """After slots(K) alone, or a turn without its view."""
    log = tmp_path / "walk.log"
    lines = [*LINES[:2], "turn(1,0).", LINES[2].removeprefix("turn(1,0).")]
    log.write_text("\n".join(lines[:cut]) + "\n")
    done = topomap("follow", "--json", "--log", log, input="\n".join(lines[cut:]))
    assert [one["step"] for one in answers(done.stdout)] == [0, 1]


def test_two_do_not_share_a_log(topomap, tmp_path):
    log = tmp_path / "walk.log"
    first = started("--json", "--log", log)
    first.stdin.write(LINES[0] + LINES[1] + "\n")
    first.stdin.flush()
    assert first.stdout.readline()
    done = topomap("follow", "--log", log, input=LINES[2])
    assert (done.returncode, done.stderr) == (2, f"{log}: another topomap follow is writing it\n")
    first.communicate(timeout=20)


def test_a_time_limit_keeps_what_was_found(topomap):
    done = topomap("follow", GRID, "--no-wait", "--json", "--timeout", "0.001")
    assert done.returncode == 3
    told = answers(done.stdout)
    assert len(told) == 17
    assert {one["fault"] for one in told} <= {None, "timeout"}
    assert any(one["fault"] for one in told)
    assert all(one["complete"] is (one["fault"] is None) for one in told)


def test_more_hypotheses_than_are_counted(topomap):
    told = follow(topomap, FACTS, "--count-limit", "20")
    assert [one["hypotheses"] for one in told if one["exact"]][-1] == 11
    assert (told[-1]["hypotheses"], told[-1]["exact"], told[-1]["complete"]) == (20, False, True)
    assert (
        "step 16: more than 20 hypotheses"
        in topomap("follow", GRID, "--no-wait", "--count-limit", "20").stdout
    )


@pytest.mark.parametrize("cases", [40, pytest.param(2000, marks=pytest.mark.long)])
def test_random_experiences_are_read_as_they_are(cases):
    for number in range(cases):
        draw = random.Random(f"lines {number}")
        experience = random_experience(draw, 8, marker=number % 2 > 0)
        facts = experience.facts().splitlines()
        for lines in (facts, list(in_json(experience)), [" ".join(facts)]):
            assert of_record(recorded(lines)) == experience
        facts = [fact + "." for line in facts for fact in re.findall(r"\w+\([^)]*\)", line)]
        assert of_record(recorded(facts)) == experience


WORDS = st.sampled_from(
    [
        "view",
        "turn",
        "slots",
        "landmark",
        "undo",
        "drop",
        "(",
        ")",
        ".",
        ",",
        "0",
        "1",
        "2",
        "-1",
        '{"turn": ',
        '"view": [0',
        "]",
        "}",
        '"a"',
        "%",
        "%*",
        "#inf",
        "99999999999",
        " ",
        "٣",
    ]
)
LINE = st.one_of(
    st.lists(WORDS, max_size=12).map("".join),
    st.text(max_size=30),
    st.sampled_from([*LINES[2:5], *in_json(read(GRID))]),
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(st.sampled_from(["turn", "view", "landmarks", "undo", "x"]), inner)
        ),
        max_leaves=6,
    ).map(json.dumps),
)


@settings(max_examples=150, deadline=None)
@given(st.lists(LINE, max_size=5))
def test_any_lines_are_read_or_refused(lines):
    record = recorded(LINES[:2])
    for line in lines:
        with contextlib.suppress(InputError):
            record = record.with_line(line, "x", 3)
    whole = record.whole()
    assert of_record(record).steps == len(whole) - 1
