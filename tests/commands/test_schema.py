"""docs/schema.json, the JSON schema of what the commands write, against what they write."""

import contextlib
import copy
import io
import json

import pytest
from conftest import ROOT
from jsonschema import Draft202012Validator
from topomap import read, solve
from topomap.cli import main, whole_parser
from topomap.cli.arguments import parsers
from topomap.documents.answers import Report
from topomap.model.found import UNPROVED, Found
from topomap.model.query import Query

SCHEMA = json.loads((ROOT / "docs/schema.json").read_text())
FORMATS = (ROOT / "docs/formats.md").read_text()
GRID, LARGE = "instances/grid-3x3-snake.lp", "instances/grid-4x4-snake.lp"
MISREAD, LOGS = "instances/grid-3x3-misread.lp", "{folder}/logs.lp"
QUICK = "--timeout", "0.001"
CALLS = [  # the answer, and a call that gives one
    ("solve", "solve", GRID, "--optimal", "--planar"),
    ("solve", "solve", GRID, "--limit", "1"),
    ("solve", "solve", GRID, "--circumscribe"),
    ("solve", "solve", GRID, "--closed", "--bound", "5", "--truth", "{folder}/truth.json"),
    ("solve", "solve", GRID, "--closed", "--truth", "{folder}/truth.json"),
    ("solve", "solve", MISREAD, "--noise", "1", "--optimal", "--planar"),
    ("solve", "solve", "{folder}/crescent.lp", "--optimal", "--planar"),
    ("solve", "solve", "{folder}/sign.lp", "--noise", "1", "--closed"),
    ("solve", "solve", LOGS),
    ("solve", "solve", LARGE, "--optimal", *QUICK),
    ("solve", "search", GRID, "--order", "best", "--planar"),
    ("solve", "import", "{folder}/graph.json"),
    ("solve_several", "solve", GRID, GRID, "--optimal"),
    ("generate", "generate", "grid", "2", "3", "--route", "tour"),
    ("generate", "generate", "torus", "3", "3", "--route", "tour", "-o", "{folder}/torus.lp"),
    ("log", "log", "tests/files/streets.csv"),
    ("log", "log", "tests/files/courtyard.csv"),
    ("validate", "validate", GRID, "{folder}/wrong.lp", "{folder}/strange.lp"),
    ("ask", "ask", GRID, "same(4,12)", "places < 12", "places > 90"),
    ("ask", "ask", LARGE, "planar", *QUICK),
    ("explain", "explain", GRID, "same(1,7)"),
    ("explain", "explain", GRID, "--perpendicular", "--bound", "5"),
    ("explain", "explain", GRID, "--closed", "--bound", "5"),
    ("explain", "explain", GRID, "planar"),
    ("explain", "explain", LARGE, "same(1,7)", *QUICK),
    ("explore", "explore", GRID, "--among", "optimal", "--proof", "{folder}/proof.json"),
    ("explore", "explore", LARGE, "--among", "optimal"),
    ("explore", "explore", "{folder}/compass.lp"),
    ("explore", "explore", "{folder}/straight.lp"),
    ("explore_no_map", "explore", MISREAD),
    ("explore_check", "explore", GRID, "--check", "{folder}/proof.json"),
    ("follow", "follow", GRID, "--no-wait"),
    ("follow", "follow", GRID, "--no-wait", "--count-limit", "5"),
    ("follow", "follow", "{folder}/crescent.lp", "--no-wait", "--planar"),
    ("simulate", "simulate", "grid", "2", "3"),
    ("simulate", "simulate", "grid", "3", "3", "--steps", "2"),
    ("simulate_list", "simulate", "list", "{folder}/worlds.txt"),
    ("count", "count", GRID),
    ("count", "count", GRID, "--circumscribe"),
    ("count", "count", GRID, "--merging"),
    ("count", "search", GRID, "--order", "depth"),
    ("count", "search", LARGE, "--order", "depth", *QUICK),
    ("branching", "branching", GRID),
    ("check", "check", GRID, "{folder}/maps.json", "--all"),
    ("check", "check", GRID, "{folder}/maps.json", "--planar"),
    ("family", "family", "instances/batch.txt", "-d", "{folder}/family"),
    ("path", "path"),
    ("export", "export", GRID, "--planar", "--format", "json"),
    ("atlas", "atlas", "{folder}/atlas.txt", "--no-peers", "--most", "50", "--steps", "10"),
]
PLAIN = {"import", "export"}  # they write JSON without being asked for it
APART = {"table"}  # it takes long
OF_THE_TABLE = [("some_figures", "properties", "optimal")]  # what the paper has


def validator(name, schema=SCHEMA):
    return Draft202012Validator({**schema, "anyOf": [{"$ref": f"#/$defs/{name}"}]})


def called(*words):
    """What a command writes to standard output."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        status = main(words)
    assert status in (0, 1, 2, 3), words
    return out.getvalue()


def cut_short():
    """What ``solve --optimal`` writes if it is cut short before a closed map is found, but when it
    knows a map and what each map costs at least; when that is depends on the machine."""
    seen = read(ROOT / GRID)
    at = next(iter(solve(seen, limit=1))).at
    out = io.StringIO()
    report = Report(out, GRID, seen, Query(), "optimal", None, True)
    report.add(Found(at, UNPROVED, (0, 6, 9), proved=False, open=True))
    report.end("timeout", by="search", least=(0, 4, 9))
    return json.loads(out.getvalue())


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """The answers, each with its name: those of the calls, those in files that commands write, and
    the committed ones."""
    folder = tmp_path_factory.mktemp("schema")
    made = []
    with contextlib.chdir(ROOT):
        write = {
            "wrong.lp": "slots(4). view(0,0). veiw(0,1). turn(1,2). view(1,0).",
            "strange.lp": "slots(4). view(0,0). view(0,2). turn(1,2). view(1,0).",
            "sign.lp": "slots(4). view(0,0). turn(1,0). view(1,0). turn(2,0). view(2,0)."
            "turn(3,0). view(3,0). landmark(1,a).",
            "straight.lp": "slots(4). view(0,0). turn(1,0). view(1,0). view(1,2). turn(2,0). "
            "view(2,0). straight(0,0,0). straight(1,0,2). straight(2,0,0).",
            "logs.lp": "slots(4). view(0,0). turn(1,0). view(1,0). start(2). view(2,0).",
            "worlds.txt": "grid 1 3\n",
            "atlas.txt": "grid 2 3\ngrid 3 3\n",
            "crescent.lp": (ROOT / "tests/cases/crescent.lp").read_text(),
        }
        for name, text in write.items():
            (folder / name).write_text(text)
        for words in (
            ("generate", "grid", "3", "3", "--route", "snake", "--truth", "{folder}/truth.json"),
            (
                "generate",
                "grid",
                "3",
                "3",
                "--route",
                "EESSWWNNESE",
                "--compass",
                "-o",
                "{folder}/compass.lp",
            ),
            ("export", GRID, "--planar", "--format", "json", "-o", "{folder}/graph.json"),
            ("solve", GRID, "--closed", "--json", "-o", "{folder}/maps.json"),
        ):
            called(*(word.format(folder=folder) for word in words))
        for name, *call in CALLS:
            words = [word.format(folder=folder) for word in call]
            text = called(*words, *(["--json"] if words[0] not in PLAIN else []))
            lines = text.splitlines() if name == "follow" else [text]
            made += [(name, json.loads(line)) for line in lines]
    files = {
        "truth": folder / "truth.json",
        "explore_proof": folder / "proof.json",
        "simulate_list": ROOT / "docs/simulations.json",
        "table_beyond": ROOT / "docs/beyond.json",
        "atlas": ROOT / "docs/atlas.json",
    }
    made.append(("solve", cut_short()))
    return made + [(name, json.loads(file.read_text())) for name, file in files.items()]


def named():
    """The answers of which the schema tells."""
    return {one["$ref"].rpartition("/")[2] for one in SCHEMA["anyOf"]}


def test_the_schema_is_one():
    Draft202012Validator.check_schema(SCHEMA)


def test_each_subcommand_that_writes_json_is_called():
    """So that a new one cannot be forgotten."""
    writing = {
        parser.prog.split()[1]
        for parser in parsers(whole_parser())
        if any("--json" in action.option_strings for action in parser._actions)
    }
    assert len(writing) > 15
    assert writing - APART <= {call[1] for call in CALLS}


@pytest.mark.slow
def test_what_commands_write_fits_the_schema(answers):
    for name, answer in answers:
        faults = [f"{one.json_path}: {one.message}" for one in validator(name).iter_errors(answer)]
        assert not faults, (name, faults[:3], answer)
        assert Draft202012Validator(SCHEMA).is_valid(answer)
    assert {name for name, _ in answers} == named() - APART


def places(schema, path=()):
    """Where the schema tells of a key: the path of each property."""
    if isinstance(schema, dict):
        for key in schema.get("properties", {}) if path[-1:] != ("properties",) else ():
            yield (*path, "properties", key)
        for key, value in schema.items():
            yield from places(value, (*path, key))
    if isinstance(schema, list):
        for number, value in enumerate(schema):
            yield from places(value, (*path, number))


@pytest.mark.long
def test_each_key_of_the_schema_is_written(answers):
    """Without it, some answer would not fit."""
    texts = [(name, answer, json.dumps(answer)) for name, answer in answers]
    told, idle = 0, []
    for path in places(SCHEMA["$defs"]):
        if path[0] in APART or path[-1] in ("format", "complete", "fault") or "if" in path:
            continue
        less = copy.deepcopy(SCHEMA)
        inner = less["$defs"]
        for step in path[:-1]:
            parent, inner = inner, inner[step]
        del inner[path[-1]]
        parent["required"] = [key for key in parent.get("required", ()) if key != path[-1]]
        holding = [(name, answer) for name, answer, text in texts if f'"{path[-1]}"' in text]
        if all(validator(name, less).is_valid(answer) for name, answer in holding):
            idle.append(path)
        told += 1
    assert idle == OF_THE_TABLE
    assert told > 200


def inside(value, path=()):
    """Each value in an answer, with the path to it."""
    for key, item in value.items() if isinstance(value, dict) else enumerate(value):
        yield (*path, key)
        if isinstance(item, dict | list):
            yield from inside(item, (*path, key))


@pytest.mark.long
def test_what_no_command_writes_does_not_fit(answers):
    """A value of another type, a key that is missing and one that is unknown are faults."""
    tried = 0
    seen = set()
    for name, answer in answers:
        judge = validator(name)
        for path in inside(answer):
            shape = name, tuple("" if isinstance(step, int) else step for step in path)
            if shape in seen:
                continue
            seen.add(shape)
            wrong = copy.deepcopy(answer)
            parent = wrong
            for step in path[:-1]:
                parent = parent[step]
            parent[path[-1]] = {"no": "such"}
            assert not judge.is_valid(wrong), shape
            tried += 1
        assert not judge.is_valid({**answer, "unknown": 1})
        if name not in ("export", "count"):
            for key in {"format", "complete", "fault"} & set(answer):
                assert not judge.is_valid({k: v for k, v in answer.items() if k != key})
    assert tried > 300


def test_the_page_explains_each_key():
    """docs/formats.md names the keys of the answers in `code`."""
    for name in named() - {"path", "branching", "export", "validate"}:
        for key in SCHEMA["$defs"][name].get("properties", ()):
            assert f"`{key}`" in FORMATS, (name, key)


@pytest.mark.long
def test_the_table(tmp_path, inside):
    answer = json.loads(inside("table", "--json", "-o", tmp_path / "table.json").stdout)
    assert not [*validator("table").iter_errors(answer)]
    assert validator("table").is_valid(json.loads((tmp_path / "table.json").read_text()))
