"""What is not proved is never worded as a no, a none or an only.

Every subcommand that searches is driven into its limit, and what it says is read. The limits
always bite: the instances are so large that no machine is done with them in that time, or there
is one map more than may be reported, or one step less than is needed.
"""

import html
import json
import re

import pytest
from conftest import ROOT
from topomap.documents.maps import KINDS, document
from topomap.drawing import scenes
from topomap.model.facts import read
from topomap.model.found import UNPROVED, Found
from topomap.model.query import Query
from topomap.questions import robot
from topomap.runtime import formats
from topomap.runtime.watch import Stopped, Watch
from topomap.solver import solving
from topomap.solver.enumeration import best_maps
from topomap.worlds.environment import grid

GRID, SNAKE = "instances/grid-3x3-snake.lp", "instances/grid-4x4-snake.lp"
LARGE = "instances/manhattan-tour40-signs30.lp"  # it has 305,359 maps
QUICK = "--timeout", "0.1"
AT_ONCE = "--timeout", "0.001"
# Subcommands that look for no map within a limit, and so have nothing to leave open.
UNLIMITED = {
    *("generate", "family", "import", "log", "validate", "path"),  # they do not search
    "clingo",  # it is clingo's own word
    "atlas",  # what it cuts is named in its cells, and its text explains proofs (test_atlas)
    "figures",  # it draws all or, when it is interrupted, says so (test_draw)
}
CLAIM = re.compile(r"\b(no|none|only|never|nothing|impossible|certain|all|every)\b", re.IGNORECASE)
# What may be said nevertheless, and why.
PROVED = {
    r"no map found yet": "it says of itself that it is open",
    r"none of these unsound": "each of those that are counted was checked",
    r"no walk of at most 1 steps does better, a longer one may": "all such walks were tried",
    r"not settled: in some or (none|all)": "both are left open",
    r"certain now: .*": "what holds in all maps by the solver's word, stated once it is settled",
    r"next: nothing; no walk tells the 2 maps apart": "the best maps are all known at that step",
    r"(?m)^planarity .*": "the head of the table's columns",
    r"a tour over every way": "about the world, not about maps",
    r"a random walk over every way": "the same",
    r"with all pending gateways": "the name of a figure: equation (1) as the paper has it",
    r"(?m)^ +all +\d.*": "the row of the sums, of the nodes met until then",
    r"\(every pending gateway fits\)": "the same",
    r"Final maps \(all\)": "the name of a figure",
    r"\((closed: )?no (path untravelled|gateway pending)\)?": "the same",
    r"closed: no gateway pending": "the same",
}

CASES = {
    "solve": [
        (LARGE, *QUICK),
        (GRID, "--limit", "1"),
        (GRID, "--limit", "1", "--truth", "{truth}"),
        (GRID, "--optimal", "--limit", "1"),
        (LARGE, "--optimal", *QUICK),
        (LARGE, LARGE, *QUICK),
        (LARGE, "--by", "search", *QUICK),
        (LARGE, "--noise", "1", *QUICK),
        (LARGE, "--minimal", *QUICK),
    ],
    "ask": [
        (LARGE, "planar", "same(3,12)", *AT_ONCE),
        (LARGE, "not planar", "places < 20", "--optimal", *QUICK),
    ],
    "explain": [(LARGE, "places > 20", "--closed", *AT_ONCE), (SNAKE, "same(3,12)", *AT_ONCE)],
    "explore": [
        (LARGE, *QUICK),
        (SNAKE, "--among", "closed", "--among", "perpendicular", *AT_ONCE),
        (SNAKE, "--among", "{four}", "--steps", "1"),
    ],
    "follow": [(GRID, "--no-wait", *AT_ONCE)],
    "simulate": [
        ("grid", "5", "5", *QUICK),
        ("grid", "3", "3", "--steps", "3"),
        ("grid", "2", "3", "--steps", "0"),
        ("list", "{worlds}", *QUICK),
    ],
    "count": [(LARGE, *QUICK)],
    "search": [
        (LARGE, *QUICK),
        (LARGE, "--order", "depth", *QUICK),
        (LARGE, "--order", "best", *QUICK),
    ],
    "branching": [(LARGE, *QUICK)],
    "check": [(GRID, "{maps}", *AT_ONCE)],
    "table": [("-o", "{out}", *AT_ONCE), ("--beyond", "-o", "{out}", *AT_ONCE)],
    "draw": [(LARGE, "-o", "{out}.svg", *QUICK)],
    "show": [(LARGE, *QUICK)],
    "export": [(LARGE, "--format", "dot", *QUICK), (LARGE, "--format", "json", *QUICK)],
    "report": [(LARGE, "-o", "{out}", *AT_ONCE)],
}
CALLS = [(name, *call) for name, calls in CASES.items() for call in calls]
TEXT_ONLY = "draw", "show", "export", "report"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Files that calls name."""
    folder = tmp_path_factory.mktemp("honest")
    names = {name: folder / name for name in ("truth", "maps", "worlds", "out", "four")}
    experience, everything = read(ROOT / GRID), Watch()
    found = list(solving.hypotheses(experience, Query(), everything))
    at = [[[step, *dstate] for step, dstate in enumerate(one.at)] for one in found]
    names["maps"].write_text(json.dumps([{"at": one} for one in at]))
    closed = solving.hypotheses(experience, Query(frozenset(["closed", "planar"])), everything)
    (truth, *_) = [one for one in closed if len(experience.map_of(one.at).stars) == 9]
    real = [[step, *dstate] for step, dstate in enumerate(truth.at)]
    names["truth"].write_text(json.dumps({"maps": [{"at": real}]}))
    names["worlds"].write_text("grid 5 5\n")
    seen = read(ROOT / SNAKE)
    best = solving.best(seen, Query(frozenset(["planar"]), 16), everything)
    four = [[[s, *dstate] for s, dstate in enumerate(one.at)] for one in best if one.proved]
    assert len(four) > 1
    names["four"].write_text(json.dumps([{"at": one} for one in four]))
    return names


def said(done):
    """What a call printed, without progress lines."""
    return done.stdout + "".join(
        line + "\n" for line in done.stderr.splitlines() if line.startswith(("instances/", "topom"))
    )


def claims(text):
    """What is claimed in a text without proof."""
    for phrase in PROVED:
        text = re.sub(phrase, "", text)
    return [line for line in text.splitlines() if CLAIM.search(line)]


@pytest.mark.parametrize("call", CALLS, ids=lambda call: " ".join(call)[:60])
def test_a_limit_leaves_open_what_was_not_proved(inside, made, call):
    done = inside(*(word.format(**made) for word in call))
    assert done.returncode == 3, (done.stdout, done.stderr)
    text = said(done)
    assert "partial: " in text
    assert not claims(text)


@pytest.mark.parametrize(
    "call", [c for c in CALLS if c[0] not in TEXT_ONLY], ids=lambda call: " ".join(call)[:60]
)
def test_the_same_as_json(inside, made, call):
    done = inside(*(word.format(**made) for word in call), "--json")
    assert done.returncode == 3, (done.stdout, done.stderr)
    lines = done.stdout.splitlines() if call[0] == "follow" else [done.stdout]
    answers = [json.loads(line) for line in lines]
    assert all(next(iter(answer)) == "format" for answer in answers)
    partial = [answer for answer in answers if not answer["complete"]]
    assert partial
    assert all(isinstance(answer["fault"], str) for answer in partial)
    for answer in partial:
        for result in answer.get("results", [answer]):
            assert next(iter(result)) == "format"
            open_where_it_must_be(result)


def open_where_it_must_be(answer):
    """No key of a partial answer says what was not proved."""
    parts = [answer, *answer.get("statements", []), *answer.get("rows", [])]
    parts += [part for part in (answer.get("best"), answer.get("next")) if part]
    for part in parts:
        for key in ("has_maps", "truth", "exact", "all", "minimal"):
            assert part.get(key) is not False or (key == "truth" and part["end"] == "settled")
        assert part.get("holds") is None or part["witness"] or part["counter"]
        assert part.get("verdict") != "no map"
        for key in ("nodes", "maps_built", "optimal", "perpendicular", "final"):
            if "per_step" in part and not part.get("rows"):
                assert part[key] is None
        assert part.get("kind") not in ("settled", "no map")
        if "count" in part and "maps" in part:
            assert part["count"] == len(part["maps"]) or part["count"] is None
        if part.get("maps") == []:
            assert part.get("kind") is None
        if part.get("proved") is False and "turns" not in part:
            assert part["kind"] in (UNPROVED, "closed, best-first")
    assert not answer.get("at_least", {}).get("optimal")


def test_every_subcommand_is_driven_into_its_limit(inside):
    """A new one is to be listed above."""
    told = inside("--help").stdout
    names = set(re.findall(r"^    ([a-z]+)(?:\s|$)", told, re.MULTILINE))
    assert len(names) > 15
    assert names <= set(CASES) | UNLIMITED, "a subcommand that no test drives into its limit"
    assert set(CASES) <= names


@pytest.mark.parametrize("name", sorted(CASES))
def test_every_limit_has_a_case(inside, name):
    """A subcommand that is not driven by one of its limits is driven by another one."""
    given = {word for call in CASES[name] for word in call}
    assert given & {"--timeout", "--limit", "--steps"}
    told = inside(name, "--help").stdout
    assert "--timeout" not in told or "--timeout" in given
    assert "--limit" not in told.replace("--count-limit", "") or "--limit" in given


# solve


def cut_short(monkeypatch, *found):
    """Have ``solve``, and what else asks for the best maps, find these, and then no more time."""

    def answers(*_, **__):
        yield from found
        raise Stopped("timeout")

    monkeypatch.setattr("topomap.api.solve.every", answers)
    monkeypatch.setattr("topomap.solver.enumeration.every", answers)


def test_maps_that_are_not_proved_to_be_best_are_of_no_better_kind(inside, monkeypatch, tmp_path):
    experience = read(ROOT / GRID)
    best = solving.best(experience, Query(), Watch())
    at = next(one.at for one in best if one.proved)
    cut_short(monkeypatch, Found(at, "optimal", (0, 6, 9), proved=False))
    done = inside("solve", GRID, "--optimal")
    assert done.stdout.splitlines()[1:] == [
        "1 map found, cost 0 6 9, not proved to be best; partial: timeout"
    ]
    file = tmp_path / "maps.json"
    assert inside("solve", GRID, "--optimal", "--json", "-o", file).returncode == 3
    answer = json.loads(file.read_text())
    assert (answer["kind"], answer["proved"], answer["optimal"]) == (UNPROVED, False, True)
    assert inside("check", GRID, file).returncode == 0
    assert "map 1 of 1 found, not proved to be best" in inside("show", file).stdout
    assert UNPROVED in KINDS


def test_the_last_map_before_the_end_is_shown_as_not_proved(inside, monkeypatch):
    experience = read(ROOT / GRID)
    at = next(one.at for one in solving.best(experience, Query(), Watch()) if one.proved)
    cut_short(monkeypatch, Found(at, "optimal", (0, 6, 9), proved=False))
    shown = inside("show", GRID)
    assert (shown.returncode, UNPROVED in shown.stdout) == (3, True)
    (only,), fault = best_maps(experience, Query(), Watch())
    assert (only.at, only.kind, fault) == (at, UNPROVED, "timeout")
    best = [Found(at, "optimal", (0, 6, 9), proved=proved) for proved in (False, True)]
    cut_short(monkeypatch, *best)
    assert best_maps(experience, Query(), Watch()) == (best[1:], "timeout")


def test_the_real_map_may_be_among_those_that_were_not_found(inside, made):
    def last(*options):
        done = inside("solve", GRID, "--truth", made["truth"], *options)
        return done.stdout.splitlines()[-1]

    assert last("--limit", "1").endswith(
        "the real map is not among those found so far; partial: limit"
    )
    assert last("--limit", "99") == "88 consistent maps by search"
    assert last("--bound", "8").endswith(
        "consistent maps by search, the real map is not among them"
    )
    assert last("--bound", "3") == "0 consistent maps by search, the real map is not among them"


def test_none_is_said_where_there_is_none(inside):
    """Proved answers keep their words."""
    assert inside("solve", GRID, "--bound", "3").stdout == "0 consistent maps by search\n"
    assert inside("search", GRID, "--order", "best", "--bound", "3").stdout.startswith(
        "0 closed, best-first maps"
    )


# Pictures


def test_one_of_two_maps_is_not_said_to_be_the_only_one(inside, tmp_path):
    """Whichever of the two was left out."""
    whole, file = tmp_path / "whole.json", tmp_path / "maps.json"
    assert not inside("solve", GRID, "--optimal", "--json", "-o", whole).returncode
    two = json.loads(whole.read_text())
    assert (two["count"], two["complete"]) == (2, True)
    for change in (
        {"maps": two["maps"][:1]},
        {"maps": two["maps"][:1], "count": 1, "complete": False, "fault": "limit"},
        {"maps": two["maps"][:1], "kind": UNPROVED, "proved": False, "count": 1},
    ):
        file.write_text(json.dumps({**two, **change}))
        assert "map 1 of 1 found" in inside("show", file).stdout
    file.write_text(json.dumps({**two, "maps": two["maps"][:1], "count": 1}))
    assert "the only optimal map" in inside("show", file).stdout
    graph = tmp_path / "map.graphml"
    assert not inside("export", whole, "--map", 2, "--format", "graphml", "-o", graph).returncode
    assert not inside("import", graph, "-o", file).returncode
    assert "map 1 of 1 found, optimal" in inside("show", file).stdout
    dot = inside("export", file, "--format", "dot").stdout
    assert ("map 1 of 1 found" in dot, "only" in dot) == (True, False)


CUT = '{"Models": {"Number": 0, "More": "yes"}, "Call": [{}]}'
QUIET = '{"Models": {"Number": 4, "More": "no"}, "Call": [{"Witnesses": []}]}'
NONE = '{"Models": {"Number": 0, "More": "no"}, "Call": [{}]}'


@pytest.mark.parametrize("command", ["show", "draw", "export"])
@pytest.mark.parametrize(
    ("text", "status", "said"),
    [
        ('{"maps": []}', 3, "no map in it; partial: its file does not say that it is complete"),
        (
            '{"maps": [], "count": 0, "complete": false, "fault": "timeout"}',
            *(3, "no map in it; partial: timeout"),
        ),
        ('{"maps": [], "count": 0, "complete": true, "fault": null}', 1, "no map in it"),
        (CUT, 3, "no map in it; partial: clingo was not asked for all, or did not end"),
        (QUIET, 3, "no map in it; partial: clingo did not print all"),
        (NONE, 1, "no map in it"),
    ],
)
def test_a_file_without_a_map_does_not_say_that_there_is_none(
    inside, tmp_path, command, text, status, said
):
    file = tmp_path / "maps.json"
    file.write_text(text)
    rest = {"draw": ["-o", tmp_path / "a.svg"], "export": ["--format", "dot"]}.get(command, [])
    for given in ([file], [GRID, file]):
        done = inside(command, *given, *rest)
        assert (done.returncode, done.stdout, done.stderr) == (status, "", f"{file}: {said}\n")


def test_a_search_that_found_no_map_says_so(inside):
    done = inside("show", LARGE, "--timeout", "0.001")
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr == f"{LARGE}: no map found yet; partial: timeout\n"


def test_a_scene_is_one_of_those_found_unless_stated_otherwise():
    seen = read(ROOT / GRID)
    (at, *_) = [one.at for one in solving.best(seen, Query(), Watch()) if one.proved]
    scene = scenes.Scene(seen.map_of(at), at, "made")
    assert scene.title.startswith("made: map 1 of 1 found\n")


# explore, follow, simulate


def test_one_map_of_a_file_is_not_settled(inside, tmp_path):
    """The file may hold one of two."""
    file = tmp_path / "one.json"
    inside("solve", GRID, "--optimal", "--limit", 1, "--json", "-o", file)
    done = inside("explore", GRID, "--among", file)
    assert not claims(done.stdout)
    assert "whether it is the real one is open" in done.stdout
    assert json.loads(inside("explore", GRID, "--among", file, "--json").stdout)["kind"] is None
    done = inside("explore", GRID, "--planar")
    assert done.stdout.endswith("settled: the only map that is optimal, and it is closed\n")


def test_more_than_are_counted_are_reported_as_more(inside):
    done = inside("follow", GRID, "--no-wait", "--count-limit", 5, "--planar", "--json")
    last = json.loads(done.stdout.splitlines()[-1])
    assert (last["hypotheses"], last["exact"]) == (5, False)


def test_a_robot_that_may_not_go_on_does_not_know_the_truth(inside):
    for call in (["grid", 2, 3, "--steps", 2], ["grid", 5, 5, *AT_ONCE]):
        answer = json.loads(inside("simulate", *call, "--json").stdout)
        assert (answer["truth"], answer["complete"]) == (None, False)
    settled = json.loads(inside("simulate", "grid", 2, 3, "--json").stdout)
    assert (settled["truth"], settled["end"]) == (False, "settled")


def test_a_robot_with_more_best_maps_than_it_keeps_does_not_know_the_truth(monkeypatch):
    monkeypatch.setattr(robot, "MOST_MAPS", 1)
    outcome = robot.simulate(grid(3, 3), ((0, 0), 1), Query(), Watch(), 5)
    assert len(outcome.maps) == 1
    assert outcome.truth is not False


def test_ask_leaves_open_what_the_closed_maps_do_not_settle():
    """That no optimal map is closed is not yet that there is no best map."""
    from topomap.questions import ask, statements

    experience = read(ROOT / "instances/manhattan-tour20.lp")
    answers = ask.Inquiry([statements.parse_statement("planar", experience, "ask")])
    settle = answers._settle

    def closed_only(experience, query, kind, watch):
        if kind != "optimal":
            raise Stopped("timeout")
        settle(experience, query, kind, watch)

    answers._settle = closed_only
    with pytest.raises(Stopped):
        answers.settle(experience, Query(), True, Watch())
    assert (answers.some, answers.kind) == (None, None)


# The page


@pytest.mark.parametrize("way", [QUICK, AT_ONCE], ids=["some time", "hardly any"])
def test_a_partial_page_claims_nothing(inside, tmp_path, way):
    file = tmp_path / "page.html"
    assert inside("report", LARGE, "-o", file, *way).returncode == 3
    body = re.sub(r"<style.*?</style>|<script.*?</script>", "", file.read_text(), flags=re.DOTALL)
    text = " ".join(html.unescape(re.sub(r"<[^>]+>", " ", body)).split())
    assert "This page is partial" in text
    for claim in ("No hypothesis is left", "There is no map", "There is none"):
        assert claim not in text
    assert "the only" not in text
    # The hypotheses after the first steps may all be known by then.
    for step, told in re.findall(r'data-step="(\d+)">(.*?)</details>', body, re.DOTALL):
        if "These are all" in told:
            many = json.loads(inside("count", LARGE, "--horizon", step, "--json").stdout)["final"]
            assert told.count("<figure") == many


# The format


@pytest.mark.slow
def test_documents_of_another_format_are_refused_in_one_line(inside, tmp_path):
    """Those that say none, as what is written by hand, are read."""
    maps = tmp_path / "maps.json"
    inside("solve", GRID, "--planar", "--optimal", "--json", "-o", maps)
    graph, proof = tmp_path / "graph.json", tmp_path / "proof.json"
    inside("export", maps, "--format", "json", "-o", graph)
    inside("explore", GRID, "--proof", proof)
    for file, call in (
        (maps, ["check", GRID, maps]),
        (maps, ["show", maps]),
        (maps, ["show", GRID, maps]),
        (maps, ["report", GRID, "--maps-from", maps, "--timeout", "0.1"]),
        (graph, ["import", graph]),
        (proof, ["explore", GRID, "--check", proof]),
    ):
        told = json.loads(file.read_text())
        assert next(iter(told.items())) == ("format", formats.FORMAT)
        old = file.read_text()
        for said in (0, 2, "1", None, True, 1.0, [1]):
            file.write_text(json.dumps({**told, "format": said}))
            done = inside(*call)
            assert (done.returncode, done.stdout) == (2, "")
            wanted = f"format {json.dumps(said)} is not known; this topomap reads format 1"
            assert done.stderr == f"{file}: {wanted}\n"
        del told["format"]
        file.write_text(json.dumps(told))
        assert inside(*call).returncode in (0, 3)
        file.write_text(old)


FORMATS = (ROOT / "docs/formats.md").read_text()
WHOLE = [
    ("generate", "grid", "2", "2", "--route", "snake"),
    ("solve", GRID, "--optimal"),
    ("solve", GRID, GRID, "--optimal"),
    ("ask", GRID, "planar", "--closed"),
    ("explain", GRID, "same(1,7)"),
    ("explore", GRID),
    ("follow", GRID, "--no-wait", "--planar"),
    ("simulate", "grid", "1", "3"),
    ("simulate", "list", "{short}"),
    ("atlas", "{short}", "--no-peers"),
    ("count", GRID, "--planar"),
    ("search", GRID, "--planar"),
    ("search", GRID, "--order", "best"),
    ("branching", GRID),
    ("check", GRID, "{maps}"),
    ("family", "{family}", "-d", "{folder}"),
]


@pytest.mark.parametrize("call", WHOLE, ids=lambda call: " ".join(call[:2]))
def test_every_answer_says_its_format_first_and_last_that_it_is_whole(inside, made, tmp_path, call):
    names = {"short": tmp_path / "short", "family": tmp_path / "family", "folder": tmp_path / "in"}
    names["short"].write_text("grid 1 3\n")
    names["family"].write_text("grid 2 2 --route snake\n")
    done = inside(*(word.format(**made, **names) for word in call), "--json")
    assert done.stderr == ""
    lines = done.stdout.splitlines() if call[0] == "follow" else [done.stdout]
    for answer in map(json.loads, lines):
        assert next(iter(answer.items())) == ("format", 1)
        assert list(answer.items())[-2:] == [("complete", True), ("fault", None)]
        for result in answer.get("results", ()):
            assert next(iter(result.items())) == ("format", 1)
        whole = answer.get("maps", [])
        assert isinstance(whole, list)
        assert {key for key in answer if f"`{key}`" not in FORMATS} == set()


def test_a_kind_that_is_open_is_read_back():
    """What a partial answer says of its maps is not a contradiction."""
    told = {"maps": [], "kind": None, "count": 0, "optimal": True, "complete": False, "fault": "x"}
    assert not document("-", told).whole
