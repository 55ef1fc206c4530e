"""The atlas of aliasing: the command, its JSON, its page, and the ones that are committed."""

import json
import random
import re

import pytest
from conftest import ROOT
from topomap.documents import atlas
from topomap.questions import ambiguity, peers
from topomap.runtime import extras
from topomap.runtime.errors import InputError
from topomap.worlds import files
from topomap.worlds.family import expand
from topomap.worlds.plan import Reading

LIST, JSON, PAGE = (
    ROOT / name for name in ("instances/atlas.txt", "docs/atlas.json", "docs/atlas.md")
)
WORLDS = "grid 2 2\nmaze 3 3 --seed {1,2}  # two of them\n"


@pytest.fixture
def listed(tmp_path):
    """A list of worlds, with this text."""

    def made(text=WORLDS):
        file = tmp_path / "worlds.txt"
        file.write_text(text)
        return file

    return made


@pytest.fixture
def made(inside, listed, tmp_path):
    """An atlas of a few worlds, as JSON."""

    def made(*options, text=WORLDS):
        done = inside("atlas", listed(text), "--json", *options)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return made


def test_the_form_of_the_json(made):
    told = made("--most", 500, "--steps", 30, "--seed", 4)
    assert [*told][:1] == ["format"]
    assert [*told][-2:] == ["complete", "fault"]
    limits = {key: told[key] for key in ("worlds", "most", "seconds", "steps", "seed", "living")}
    assert limits == {
        "worlds": 3,
        "most": 500,
        "seconds": 10.0,
        "steps": 30,
        "seed": 4,
        "living": ambiguity.MOST_LIVING,
    }
    assert [row["world"] for row in told["rows"]] == [
        "grid 2 2",
        "maze 3 3 --seed 1",
        "maze 3 3 --seed 2",
    ]
    assert (told["complete"], told["fault"]) == (True, None)
    for row in told["rows"]:
        assert row["dstates"] == 2 * row["ways"]
        assert [walk["walk"] for walk in row["walks"]] == ["tour", "random"]
        for walk in row["walks"]:
            assert walk["steps"] <= 30
            assert {*walk["maps"]} == {*walk["preferred"]} == {*ambiguity.KNOWLEDGE}
            assert {*walk["settling"]} == {*ambiguity.KINDS}
            for counted in walk["maps"].values():
                whole = counted["stopped"] is None
                assert len(counted["maps"]) == len(counted["closed"])
                assert whole == (len(counted["maps"]) == walk["steps"] + 1)
        tour = row["walks"][0]
        assert tour["whole"]
        assert tour["settling"]["all"]["living"] == tour["maps"]["all"]["maps"][-1]
        assert tour["settling"]["closed"]["living"] == tour["maps"]["all"]["closed"][-1]


def keys(data):
    """All keys of a JSON, but for what is counted by kind."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield key
            yield from keys(value)
    elif isinstance(data, list):
        for one in data:
            yield from keys(one)


def test_the_keys_are_described(made):
    pytest.importorskip("aalpy")
    text = (ROOT / "docs/formats.md").read_text()
    rows = "".join(re.findall(r"^\| `atlas` .*?(?=^\| `count`)", text, re.M | re.S))
    told = {*keys(made(text="grid 2 2"))} - {"format", "complete", "fault"}
    assert len(told) > 40
    assert {key for key in told if f"`{key}`" not in rows} == set()


def test_the_same_call_gives_the_same(made):
    assert made() == made()


@pytest.mark.slow
def test_seeds_and_starts(made):
    """The random walk hangs on the seed, the tour does not; both begin where they are told to."""
    steps = [[walk["steps"] for walk in made("--seed", n)["rows"][0]["walks"]] for n in range(8)]
    assert len({tour for tour, _ in steps}) == 1
    assert len({walk for _, walk in steps}) > 1
    views = [made(text=f"grid 2 3 --start {at}")["rows"][0]["walks"] for at in ("0,0", "0,1")]
    assert views[0] != views[1]
    (signed,) = made(text="grid 2 2 --signs 1")["rows"]
    assert (
        signed["walks"][0]["maps"]["all"]["maps"][-1]
        < made()["rows"][0]["walks"][0]["maps"]["all"]["maps"][-1]
    )


def test_the_page_is_what_the_json_gives(inside, listed, tmp_path):
    file = tmp_path / "atlas.json"
    assert inside("atlas", listed(), "--json", "-o", file).returncode == 0
    page = inside("atlas", "--from", file).stdout
    assert page == inside("atlas", listed()).stdout
    assert "| grid 2 2 | 4 | 4 | tour | 4 | " in page
    assert "Nothing was cut." in page or "## What was cut\n\n- " in page
    again = tmp_path / "atlas.md"
    assert inside("atlas", "--from", file, "-o", again).stdout == ""
    assert again.read_text() == page


@pytest.mark.slow
def test_what_is_cut_is_named(inside, listed):
    page = inside("atlas", listed("grid 3 3"), "--most", 10, "--steps", 12, "--no-peers").stdout
    _, cut = page.split("## What was cut\n")
    assert re.search(r"^- grid 3 3, tour: all: more than 10 maps after step \d+$", cut, re.M)
    assert (
        "- grid 3 3, random walk: it ended after 12 steps, before it had gone along every way"
        in cut
    )
    assert re.search(r"more than 10 \(step \d+\)", page)
    page = inside("atlas", listed("grid 6 6"), "--seconds", 0.01, "--no-peers").stdout
    _, cut = page.split("## What was cut\n")
    assert re.search(r"^- grid 6 6, tour: planar: counted to step \d+ \(timeout\)$", cut, re.M)
    assert "- grid 6 6, tour: all: what is preferred is open (timeout)" in cut


def test_a_cut_atlas_keeps_the_worlds_that_are_done(inside, listed, monkeypatch):
    """It is partial, and says so, as text and as JSON."""
    ended = []
    real = ambiguity.preferred

    def preferred(walk, knowledge, seconds, watch):
        ended.append(walk)
        if len(ended) > 6:  # two walks of the first world, three times
            watch.ended = "timeout"
        return real(walk, knowledge, seconds, watch)

    monkeypatch.setattr("topomap.api.atlas.preferred", preferred)
    done = inside("atlas", listed(), "--json", "--no-peers")
    told = json.loads(done.stdout)
    assert done.returncode == 3
    assert (told["complete"], told["fault"], told["worlds"]) == (False, "timeout", 3)
    assert [row["name"] for row in told["rows"]] == ["grid 2 2"]
    ended.clear()
    done = inside("atlas", listed(), "--no-peers")
    assert done.returncode == 3
    assert "**partial: timeout; 1 of 3 worlds**" in done.stdout
    assert inside("atlas", listed(), "--timeout", 0.001).returncode == 3


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("grid 2 2\ngrid 2\n", ":2: topomap atlas grid: "),
        ("sphere 2 2\n", ":1: topomap atlas: "),
        ("grid 2 2 --route tour\n", ":1: unrecognized arguments: --route tour"),
        ("grid 2 2 --start 9,9\n", ":1: grid-2x2: there is no place '9,9'"),
        ("grid 2 2 --facing 0\n", ":1: grid-2x2: place 0,0 has no gateway 0"),
        ("grid 1 1\n", ":1: an environment needs a way between two places"),
        ("world none.json\n", "none.json: no such file or directory"),
        ("grid --help\n", ":1: --help cannot be used in a list"),
        ("# nothing\n", ": it has no worlds"),
        ('grid 2 2 "\n', ":1: no closing quotation"),
    ],
)
def test_bad_lines(inside, listed, tmp_path, text, fault):
    out = tmp_path / "out"
    done = inside("atlas", listed(text), "-o", out)
    assert (done.returncode, done.stdout) == (2, "")
    assert fault in done.stderr
    assert done.stderr.startswith(str(tmp_path / "worlds.txt"))
    assert done.stderr.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("call", "fault"),
    [
        ([], "give either a file of WORLDS or --from FILE"),
        (["{list}", "--from", "{list}"], "give either a file of WORLDS or --from FILE"),
        (["--from", "{list}", "--most", "3"], "--most cannot be used with --from"),
        (["--from", "{list}", "--json"], "cannot be used with --from"),
        (["{list}", "--most", "0"], "'0' is not a whole number, from 1 to 1000000"),
        (["{list}", "--seconds", "0"], "not a number"),
        (["none.txt"], "none.txt: no such file or directory"),
        (["--from", "none.json"], "none.json: no such file or directory"),
        (["--from", "{list}"], "worlds.txt: not JSON"),
        (["{list}", "-o", "{list}"], "it is an input, so it cannot be written"),
    ],
)
def test_bad_calls(inside, listed, call, fault):
    done = inside("atlas", *(word.format(list=listed()) for word in call))
    assert (done.returncode, done.stdout) == (2, "")
    assert fault in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("text", ["[]", "{}", '{"rows": [1]}', "3", '{"format": 2}', "[" * 5000])
def test_what_is_no_atlas(tmp_path, text):
    file = tmp_path / "atlas.json"
    file.write_text(text)
    with pytest.raises(InputError) as error:
        atlas.read_atlas(file)
    assert str(error.value).startswith(f"{file}: ")
    assert "\n" not in str(error.value)


def test_each_key_is_needed(tmp_path):
    """A file in which one is missing is refused, or makes the same page."""
    told = json.loads(JSON.read_text())
    told["rows"] = told["rows"][:1]
    whole = [*atlas.page(told)]
    file = tmp_path / "atlas.json"
    draw = random.Random(0)
    refused = 0
    for _ in range(100):
        data = json.loads(json.dumps(told))
        at = data
        while True:
            key = draw.choice([*at] if isinstance(at, dict) else range(len(at)))
            if not isinstance(at[key], dict | list) or not at[key] or draw.random() < 0.2:
                break
            at = at[key]
        if not isinstance(at, dict):
            continue
        del at[key]
        file.write_text(json.dumps(data))
        try:
            assert [*atlas.page(atlas.read_atlas(file))] == whole
        except InputError:
            refused += 1
    assert refused > 20


def test_files_are_looked_for_beside_the_list(made, tmp_path):
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps/two.world").write_text("slots(4). link(a,1,b,3).\n")
    (row,) = made(text="world maps/two.world")["rows"]
    assert (row["name"], row["world"], row["places"]) == ("two", "world maps/two.world", 2)
    (row,) = made(text=f"world {tmp_path}/maps/two.world")["rows"]
    assert row["places"] == 2


def test_it_works_without_the_learner(inside, listed, monkeypatch):
    monkeypatch.setitem(extras.MODULES, "peers", ("a_module_that_is_not_there",))
    done = inside("atlas", listed("grid 2 2"), "--json")
    assert done.returncode == 0
    assert "AALpy is not installed" in done.stderr
    assert done.stderr.count("\n") == 1
    told = json.loads(done.stdout)
    assert told["peers"] is None
    assert [row["peer"] for row in told["rows"]] == [None]
    page = "\n".join(atlas.page(told))
    assert "These columns are missing" in page
    assert inside("atlas", listed("grid 2 2"), "--json", "--no-peers").stderr == ""


def test_cells_say_what_is_decided_where_a_count_stopped(inside, listed):
    """Where a count stopped, it is open only if it may be that exactly one map remains."""
    limits = "--most", 50, "--steps", 10, "--no-peers"
    page = inside("atlas", listed("grid 3 3\ntorus 3 3"), *limits).stdout
    _, further = page.split("## Which further walk")
    rows = dict(re.findall(r"^\| (\w+ 3 3 \| [\w ]+) \| (.*) \|$", further.split("\n## ")[0], re.M))
    assert rows["grid 3 3 | tour"].startswith(
        "- | - | - | - | none (1 of 1 tried) | none (44 of 44)"
    )
    assert rows["grid 3 3 | random walk"].endswith("| no map")
    assert rows["torus 3 3 | tour"].startswith(
        "open | open | open | - | real map not one of them |"
    )


def test_what_the_learner_comes_to_is_told(made):
    pytest.importorskip("aalpy")
    told = made(text="grid 2 3\ngrid 1 2")
    assert told["peers"]["tested"] == peers.TESTED
    assert told["peers"]["aalpy"] == peers.peer()
    page = "\n".join(atlas.page(told))
    row = told["rows"][0]["peer"]
    turns, compass = row["turns"], row["compass"]
    cells = f"| grid 2 3 | 14 | 7 | 7 | {turns['moves']:,} | 14 | 14 | {compass['moves']:,} |"
    assert cells in page
    assert re.search(
        r"\| grid 1 2 \| 2 \| 1 \| not begun: all looked alike \| \d+ \| 2 \| 2 \| ", page
    )
    words = " ".join(page.split())
    predicts = "its automaton predicts everything rightly"
    assert f"- turns: the algorithm ended in 1 of 2 worlds; in 1 {predicts}" in words
    assert f"- compass: the algorithm ended in 2 of 2 worlds; in 2 {predicts}" in words
    row["turns"]["right"] = False
    assert "| 7 (wrong) |" in "\n".join(atlas.page(told))


def test_the_committed_page_is_what_the_committed_json_gives():
    assert "\n".join(atlas.page(atlas.read_atlas(JSON))) + "\n" == PAGE.read_text()


def test_the_committed_atlas_is_whole():
    told = json.loads(JSON.read_text())
    assert told["complete"]
    listed = [" ".join(call) for _, call in expand(LIST)]
    assert [row["world"] for row in told["rows"]] == listed
    assert len(listed) == told["worlds"] == 22
    assert told["peers"]
    names = [row["name"] for row in told["rows"]]
    assert len({*names}) == len(names)


SAME = "maps", "closed", "stopped", "more_than", "one_since"


def cases():
    """The worlds of the list; those that take long are long."""
    quick = ("grid 2 3", "maze", "hexagons 1 2", "triangles 2 3", "crescents")
    for _, call in expand(LIST):
        slow = not " ".join(call).startswith(quick)
        yield pytest.param(call, marks=[pytest.mark.long] * slow, id=" ".join(call))


@pytest.mark.slow
@pytest.mark.parametrize("call", [*cases()])
def test_the_counts_are_what_comes_out(inside, tmp_path, call):
    """But for those that the time has cut, then or now."""
    told = json.loads(JSON.read_text())
    (before,) = (row for row in told["rows"] if row["world"] == " ".join(call))
    file = tmp_path / "worlds.txt"
    (tmp_path / "atlas").symlink_to(ROOT / "instances/atlas")
    file.write_text(" ".join(call))
    options = ("--most", told["most"], "--seconds", told["seconds"], "--steps", told["steps"])
    done = inside("atlas", file, "--json", "--no-peers", *options)
    (now,) = json.loads(done.stdout)["rows"]
    for one, other in zip(before["walks"], now["walks"], strict=True):
        assert one["steps"] == other["steps"]
        for kind in ambiguity.KNOWLEDGE:
            counts = one["maps"][kind], other["maps"][kind]
            shorter = min(len(counted["maps"]) for counted in counts)
            assert counts[0]["maps"][:shorter] == counts[1]["maps"][:shorter]
            if "timeout" not in (counts[0]["why"], counts[1]["why"]):
                assert {key: counts[0][key] for key in SAME} == {
                    key: counts[1][key] for key in SAME
                }
            best = one["preferred"][kind], other["preferred"][kind]
            if not any(told["why"] for told in best):
                assert best[0] == best[1]
        for kind in ambiguity.KINDS:
            settled = one["settling"][kind], other["settling"][kind]
            if all(told["living"] is not None and not told["why"] for told in settled):
                assert {key: settled[0][key] for key in ("kind", "living", "others")} == {
                    key: settled[1][key] for key in ("kind", "living", "others")
                }


def test_the_coloured_room_is_as_its_file_says():
    """Its colours are those that random numbers with that seed give, and it is a grid."""
    room = files.load(
        str(ROOT / "instances/atlas/room-6x8-coloured.world"), Reading(), 4, 0.0, None, False
    ).environment.map
    draw = random.Random(0)
    colours = {}
    for row in range(1, 7):
        for column in range(1, 9):
            colours[f"{row}{column}"] = draw.choice(["red", "green", "blue", "yellow"])
    assert {str(place): {*signs} for place, signs in room.landmarks.items()} == {
        place: {colour} for place, colour in colours.items()
    }
    from topomap.worlds.environment import grid

    def name(place):
        return f"{place[0] + 1}{place[1] + 1}"

    uniform = {((name(a[0]), a[1]), (name(b[0]), b[1])) for a, b in grid(6, 8).map.links.items()}
    assert {((str(a[0]), a[1]), (str(b[0]), b[1])) for a, b in room.links.items()} == uniform
