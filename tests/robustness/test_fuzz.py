"""Random bad input to every reader: instances, maps, true maps, networks, surveys, floor plans,
families, journals, routes and command lines. Each is refused in one line with status 2, or
answered; nothing hangs, shows a traceback or leaves a part of a file.

A new reader is a line in READERS; a new subcommand is found by itself.
"""

import argparse
import contextlib
import functools
import io
import json
import random
import re
import shlex
import signal
import string
import tempfile
from dataclasses import replace
from pathlib import Path

import networkx as nx
import pytest
from conftest import ROOT
from oracles.worlds import random_experience
from topomap import cli
from topomap.documents.answers import Report
from topomap.drawing.scenes import Scene
from topomap.exchange import exports
from topomap.model.query import Query
from topomap.paper import beyond, figure4
from topomap.runtime.watch import Watch
from topomap.search import traversal
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance

SECONDS = 10
OLD = "old\n"
TOKENS = [
    *("#script (python) print(1) #end.", '#include "/etc/passwd".', "#const a=1.", "#inf"),
    *("\0", "\ufeff", "\u0663", "\u0441", "\uff10", "\u2028", "\r", "\n", "\t", " ", "", "\\"),
    *("99999999999", "2147483648", "1000000000", "-1", "0x0", "1e999", "NaN", "inf", "0", "1.5"),
    *("slots(1000000000).", "turn(1000000000,0).", "view(0,0).", "view(X,0).", "a:-b.", "-a"),
    *("f(" * 200, "(" * 5000, "[" * 5000, "<a>" * 5000, "-" * 500, "|", "..", ";", ",", ".", ":"),
    *("%*", "*%", "%", '"', "{", "}", "{1..9}", "{0..999999999}", "{a,b}" * 30, "null", "true"),
    *("<!DOCTYPE a>", '<!ENTITY a "b">', "&lt;", "&a;", "]]>", "<", ">", "</node>", "<data/>"),
    *("--help", "-o", "--json", "--route", "snake", "walk", "tour", "--seed", "--name", "../x"),
]  # fmt: skip


def on_bytes(draw, text):
    """The text with bytes changed, cut out, put in or cut off."""
    content = bytearray(text.encode())
    for _ in range(draw.choice([1, 1, 2, 5])):
        at = draw.randint(0, len(content))
        end = min(len(content), at + draw.choice([1, 1, 2, 10, 100]))
        put = bytes(draw.choice([draw.randrange(256), draw.randrange(32, 127)]) for _ in range(3))
        content[at:end] = draw.choice([b"", put[:1], put, content[at:end] * 2])
    return bytes(content)


def on_tokens(draw, text):
    """The text with words and signs replaced by odd ones."""
    tokens = re.findall(r"\w+|\s+|.", text, re.DOTALL)
    for _ in range(draw.choice([1, 1, 2, 4])):
        put = draw.choice([draw.choice(TOKENS), draw.choice(tokens)])
        at = draw.randrange(len(tokens))
        tokens[at : at + draw.choice([0, 1, 1, 1])] = [put]
    return "".join(tokens).encode()


def on_lines(draw, text):
    """The text with lines, facts or tags taken away, doubled or moved."""
    lines = [line for line in re.split(r"(?<=[.>\n])", text) if line]
    for _ in range(draw.choice([1, 1, 2, 4])):
        line = lines.pop(draw.randrange(len(lines)))
        for _ in range(draw.choice([0, 0, 1, 2])):
            lines.insert(draw.randint(0, len(lines)), line)
        if not lines:
            break
    return "".join(lines).encode()


def on_values(draw, text):
    """A JSON text with values replaced."""
    odd = [None, True, -1, 0, 3, 10**9, 10**30, 0.5, 1e308, float("inf"), "", "0", [], {}, [[]]]

    def change(value):
        if draw.random() < 0.05:
            return draw.choice(odd)
        if isinstance(value, dict):
            return {key: change(item) for key, item in value.items() if draw.random() < 0.95}
        if isinstance(value, list):
            return [change(item) for item in value if draw.random() < 0.98]
        return value

    return json.dumps(change(json.loads(text))).encode()


def made(draw, kind):
    """A good input of this kind."""
    if (ROOT / "tests/files" / kind).is_file():
        return (ROOT / "tests/files" / kind).read_text()
    if kind == "instance":
        return "% made\n" + random_experience(draw, 5, marker=True).facts()
    if kind == "maps":
        return maps(draw)
    if kind == "truth":
        at = instance(grid(2, 2), "snake").truth
        return json.dumps({"maps": [{"at": [[t, *dstate] for t, dstate in enumerate(at)]}]})
    if kind == "network":
        return network(draw)
    if kind == "survey":
        return survey(draw)
    if kind == "map":
        return floor("floor.pgm")
    if kind == "image":
        return crossing()
    if kind == "proof":
        return proof()
    if kind == "journal":
        return journal()
    if kind == "graphml":
        return exports.graphml(scene())
    if kind == "node-link":
        return exports.node_link(scene())
    return draw.choice(
        [
            "# grids\ngrid {2..3} 2 --route {snake,E}  # two by two\n",
            "maze 2 3 --route tour --seed {0,1}\nhexagons 1 1 --route walk --steps 3 --name a.b\n",
        ]
    )


def maps(draw):
    """Maps as solve writes them, or clingo."""
    seen = instance(grid(2, 2), "snake").experience
    query = Query(frozenset(["closed"]), noise=draw.choice([None, 1]))
    out = io.StringIO()
    report = Report(out, "good.lp", seen, query, None, None, as_json=True)
    found = list(traversal.hypotheses(seen, replace(query, noise=None), Watch()))
    for one in found:
        misread = [] if query.noise is None else [(draw.randrange(4), draw.randrange(4))]
        report.add(replace(one, misread=tuple(misread)))
    report.end(None)
    values = [[f"at({t},{p},{s})" for t, (p, s) in enumerate(one.at)] for one in found]
    clingo = {"Solver": "clingo", "Call": [{"Witnesses": [{"Value": atoms} for atoms in values]}]}
    return draw.choice([out.getvalue(), json.dumps(clingo)])


def scene():
    """The map of a grid."""
    seen = instance(grid(2, 2), "snake")
    return Scene(seen.experience.map_of(seen.truth), seen.truth, "good.lp", kind="optimal")


@functools.cache
def proof():
    """That no walk tells two maps apart."""
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        file, snake = Path(folder) / "proof", Path(folder) / "three.lp"
        snake.write_text(THREE)
        assert cli.main(["explore", str(snake), "--proof", str(file)]) == 1
        return file.read_text()


@functools.cache
def journal():
    """What a run leaves that was cut in the middle of a part."""
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()):
        file, snake = Path(folder) / "maps", Path(folder) / "three.lp"
        snake.write_text(THREE)
        assert (
            cli.main(["solve", str(snake), "--by", "clingo", "--limit", "60", "-o", str(file)]) == 3
        )
        return Path(f"{file}.part").read_text()


COURSES = "", "LINESTRING (0 0, 4 5, 0 9)", "[[0, 0], [4, 5], [0, 9]]"


def network(draw):
    graph = draw.choice([nx.Graph, nx.MultiDiGraph])(crs="epsg:32618")
    for name, east, north in (("a", 0, 0), ("b", 0, 9), ("c", 9, 9), ("d", 9, 0)):
        graph.add_node(name, x=float(east), y=float(north), lanes="2", oneway=True)
    graph.add_edges_from(["ab", "bc", "cd", "da"], length=9.5, geometry=draw.choice(COURSES))
    graph.add_edges_from(["ba", "cb", "dc", "ad"] if graph.is_directed() else [], length=9.5)
    return "\n".join(nx.generate_graphml(graph))


def survey(draw):
    """A cave of two blocks and a dead end."""
    form = draw.choice(["from to tape compass clino", "from to tape compass clino ignoreall"])
    return f"""*begin cave
*units tape feet
*calibrate declination {draw.randint(-5, 5)} ; degrees
*data normal {form}
1 2 100 0 0
2 3 100 90 5
3 4 100 180 -5
4 1 100 270 0
1 5 50 {draw.choice(["80 0", "- down"])}
5 6 50 200 0
*equate 6 7
*fix 1 100 200 30
*flags splay
4 wall 10 200 0
*end cave
"""


def floor(image):
    """The YAML file of a map."""
    return f"""image: {image}
resolution: 0.1
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.2
"""


def crossing():
    """The image of two corridors."""
    rows = [
        " ".join("255" if abs(x - 20) < 4 or abs(y - 20) < 4 else "0" for x in range(41))
        for y in range(41)
    ]
    return "\n".join(["P2", "41 41", "255", *rows, ""])


EDITS = on_bytes, on_tokens, on_lines
GRID = instance(grid(2, 2), "snake").text()
THREE = instance(grid(3, 3), "snake").text()
READERS = {  # the calls that read a file, and how to spoil it
    "instance": (
        [
            "solve FILE --limit 5 --timeout 5 -o out",
            "solve FILE --optimal --json --limit 5 --timeout 5 -o out",
            "solve good.lp FILE --limit 2 --timeout 5 --json -o out",
            "count FILE --horizon 4 --timeout 5 --json -o out",
            "ask FILE planar same(0,0) --timeout 5 --json -o out",
            "search FILE --timeout 5 --json -o out",
            "branching FILE --timeout 5 -o out",
            "solve FILE --noise 1 --horizon 2 --limit 5 --timeout 5 --json -o out",
            "report FILE --timeout 5 --horizon 5 --maps 1 -o out",
            "explore FILE --timeout 5 --json --proof proof -o out",
            "validate good.lp FILE",
            "validate FILE three.lp --json",
        ],
        EDITS,
    ),
    "truth": (["solve good.lp --truth FILE --timeout 5 --json -o out"], (*EDITS, on_values)),
    "maps": (
        [
            "check good.lp FILE -o out",
            "check good.lp FILE --planar --closed --bound 4 --json -o out",
            "check good.lp FILE --noise 2 -o out",
            "show FILE",
            "export FILE --format graphml -o out",
            "explore good.lp --among FILE --timeout 5 -o out",
        ],
        (*EDITS, on_values),
    ),
    "proof": (["explore three.lp --check FILE -o out"], (*EDITS, on_values)),
    "network": (
        [
            "generate network FILE --route tour -o out",
            "generate world FILE --slots 8 --north 20 --straight 30 --two-way --loops --route walk "
            "--steps 3 --signs 0.5 -o out",
        ],
        EDITS,
    ),
    "survey": (
        [
            "generate world FILE --route tour -o out",
            "generate world FILE --loops --along 20 --route walk --steps 3 -o out",
        ],
        EDITS,
    ),
    **dict.fromkeys(
        ("museum.world", "ring.json", "greenhouse.yaml", "manor.trizbort", "bend.maps.json"),
        (
            [
                "generate world FILE --route tour -o out",
                "generate world FILE --two-way --loops --names --slots 16 --north 0 --route walk "
                "--steps 3 --world w.graphml -o out",
            ],
            EDITS,
        ),
    ),
    "map": (["generate world FILE --route tour -o out"], EDITS),
    "image": (["generate world floor.yaml --radius 1 --route tour -o out"], EDITS),
    "graphml": (["import FILE -o out"], EDITS),
    "node-link": (["import FILE -o out"], (*EDITS, on_values)),
    "family": (["family FILE -d folder"], EDITS),
    "journal": (["solve three.lp --resume -o maps"], EDITS),
}


class Hang(BaseException):
    """It took too long."""


@pytest.fixture
def feed(tmp_path, monkeypatch):
    """Run a command in a folder that holds some files; returns its exit status, after
    demanding of it what every command owes."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(figure4, "COLUMNS", figure4.COLUMNS[:1])
    monkeypatch.setattr(beyond, "COLUMNS", [(2, 3, None, True)])
    (tmp_path / "good.lp").write_text(GRID)
    (tmp_path / "three.lp").write_text(THREE)
    (tmp_path / "net.graphml").write_text(network(random.Random(0)))
    (tmp_path / "floor.pgm").write_text(crossing())
    (tmp_path / "floor.yaml").write_text(floor("FILE"))
    (tmp_path / "bad.lp").write_text("slots(5).")
    (tmp_path / "dir").mkdir()

    def files():
        every = (path for path in tmp_path.rglob("*") if path.is_file())
        return {path: path.read_bytes() for path in every}

    def alarm(*_):
        raise Hang

    def run(arguments, named=None):
        for path in set(files()) - kept:
            path.unlink()
        (tmp_path / "out").write_text(OLD)
        before = files()
        out, err = io.StringIO(), io.StringIO()
        fault = status = None
        signal.signal(signal.SIGALRM, alarm)
        signal.setitimer(signal.ITIMER_REAL, SECONDS)
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                status = cli.main(arguments)
        except BaseException as error:
            fault = repr(error)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
        lines = [
            line
            for line in err.getvalue().splitlines()
            if not line.startswith(("warning: ", "counted "))
        ]
        printed = out.getvalue()
        if status == 2 and arguments[0] == "validate" and printed:  # faults are its result
            lines, printed = [*lines, printed], ""
        after = files()
        if fault is None and status not in (0, 1, 2, 3):
            fault = f"status {status}"
        elif any(path.name.startswith(".topomap-") for path in after):
            fault = fault or "a temporary file is left"
        elif status == 2 and (len(lines) != 1 or printed):
            fault = f"not one line: {lines} {printed[:100]!r}"
        elif status == 2 and after != before:
            fault = f"files changed: {sorted(set(after.items()) ^ set(before.items()))}"
        elif status == 2 and named and named not in lines[0]:
            fault = f"{named} is not named: {lines}"
        assert fault is None, f"{fault}\ncd {tmp_path} && topomap {shlex.join(arguments)}"
        return status

    kept = {*files(), tmp_path / "FILE", tmp_path / "maps.part"}
    return run


CASES = [240, pytest.param(8000, marks=pytest.mark.long)]


@pytest.mark.slow
@pytest.mark.parametrize("cases", CASES)
def test_spoilt_files(feed, tmp_path, cases, record_property):
    refused = dict.fromkeys(READERS, 0)
    for number in range(cases):
        draw = random.Random(f"file {cases} {number}")
        kind = draw.choice(list(READERS))
        calls, edits = READERS[kind]
        file = tmp_path / ("maps.part" if kind == "journal" else "FILE")
        file.write_bytes(draw.choice(edits)(draw, made(draw, kind)))
        refused[kind] += feed(draw.choice(calls).split(), file.name) == 2
        file.unlink(missing_ok=True)
    assert min(refused.values()) > cases / len(READERS) / 4, refused
    record_property("bad files refused", sum(refused.values()))


@pytest.mark.parametrize("cases", CASES)
def test_spoilt_routes(feed, cases, record_property):
    refused = 0
    for number in range(cases // 4):
        draw = random.Random(f"route {cases} {number}")
        letters = draw.choice(
            ["NESW", "NESW,", "0123,", string.printable, "NE,\u0663\uff10\u0430\0"]
        )
        route = "".join(draw.choice(letters) for _ in range(draw.choice([0, 1, 3, 8, 30])))
        if draw.random() < 0.2:
            route = on_tokens(draw, route or "E").decode()
        world = draw.choice(["grid 3 3", "hexagons 1 1", "network net.graphml --slots 8"]).split()
        call = ["generate", *world, f"--route={route}", "-o", "out"]
        refused += feed([*call, "--steps", "3"][: draw.choice([len(call), None])]) == 2
    assert refused > cases / 16
    record_property("bad routes refused", refused)


def actions(parser, path=()):
    """Each subcommand of a parser, with its arguments."""
    nested = [a for a in parser._actions if isinstance(a, argparse._SubParsersAction)]
    if not nested:
        yield path, [action for action in parser._actions if action.dest != "help"]
    for action in nested:
        for name, sub in action.choices.items():
            yield from actions(sub, (*path, name))


# The options of clingo are its own.
COMMANDS = [
    found for name in cli.SUBCOMMANDS if name != "clingo" for found in actions(cli._parser(name))
]
FILES = ["good.lp", "bad.lp", "none.lp", "dir", "net.graphml", "", "a\0b", "\udcff", "a" * 300]
OUTPUTS = ["out", "dir", "none/out", "/dev/full", "", "a" * 300, "new", "a\0b", "out/out", "\udcff"]
NUMBERS = ["0", "1", "2", "3", "5", "-1", "0.5", "1e9", "1000000000", "9" * 30, "9" * 5000, "nan"]
NUMBERS += ["inf", "x", "", "1_0", " 3", "\u0663", "1e-400", "0x3", "a\nb"]
WORDS = ["snake", "walk", "tour", "E", "0,1", "0,0", "a", "x y", "\n", "\udcff", "", "%s", "--"]


def value(draw, action):
    """A value for an argument: often a fitting one."""
    where = (action.metavar or action.dest).upper()
    if draw.random() < 0.05:
        return draw.choice([*TOKENS[:40], *NUMBERS, *WORDS, *FILES[:4]])
    if set(action.option_strings) & {"-o", "--output", "-d", "--directory", "--proof"}:
        return draw.choice(["out", *OUTPUTS])
    if any(word in where for word in ("FILE", "INSTANCE", "FAMILY", "MAP")):
        return draw.choice(FILES)
    return draw.choice(NUMBERS if action.type else WORDS)


def command_line(draw):
    path, arguments = draw.choice(COMMANDS)
    if "--truth" in (option for a in arguments for option in a.option_strings):
        arguments = [
            a for a in arguments if "--truth" not in a.option_strings or draw.random() < 0.2
        ]
    words = []
    for action in arguments:
        often = 0.95 if action.required or not action.option_strings else 0.12
        if draw.random() < often:
            word = value(draw, action)
            if action.nargs == 0:
                words.append([draw.choice(action.option_strings)])
            elif action.option_strings:
                words.append([f"{action.option_strings[-1]}={word}"])
            else:
                words.append([word])
    if draw.random() < 0.1:
        words.append([draw.choice([*TOKENS, "--", "-", "--none", "-x", "@good.lp"])])
    if path == ("follow",):  # which else waits without end, or has a line for each fault
        words = [["--no-wait"], *(word for word in words if word != ["--keep-going"])]
    if path[0] == "simulate":  # a robot may walk for long
        words = [["--timeout=1"], *(word for word in words if word[0][:9] != "--timeout")]
    draw.shuffle(words)
    return [*path, *(word for group in words for word in group)]


@pytest.mark.slow
@pytest.mark.parametrize("cases", CASES)
def test_random_command_lines(feed, cases, record_property):
    statuses = [
        feed(command_line(random.Random(f"line {cases} {number}"))) for number in range(cases // 2)
    ]
    assert statuses.count(2) > cases / 4
    assert statuses.count(0)
    record_property("bad command lines refused", statuses.count(2))
