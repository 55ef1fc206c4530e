"""Misreadings: all that is said of wrong views is compared with a brute force over all ways to
correct so many of them, each judged by the independent search."""

import json
import random
from dataclasses import replace

import clingo
import pytest
from conftest import ENCODINGS, ROOT, TRIED, run
from oracles.misreadings import brute, corrupted, expected
from oracles.statements import FIGURES
from oracles.worlds import random_experience
from topomap.cli import main
from topomap.model.experience import Experience, observe
from topomap.model.facts import parse, read
from topomap.model.query import Query
from topomap.runtime.errors import InputError
from topomap.runtime.watch import Watch
from topomap.solver import solving
from topomap.solver.solving import misreadings
from topomap.worlds.environment import grid

QUIET = Watch()
MISREAD = ROOT / "instances/grid-3x3-misread.lp"
PARTS = [
    (),
    ("planar",),
    ("closed",),
    ("minimal",),
    ("closed", "boundary", "minimal"),
    ("closed", "exceptions", "minimal"),
    ("genus", "exceptions", "minimal"),
    ("planar", "closed", "minimal"),
    ("perpendicular", "euler", "genus"),
]


def answered(seen: Experience, parts, most: int, mode: str):
    """The same by stock clingo; with optN the best ones."""
    messages, found = [], []
    arguments = ["0", "-c", f"noise={most}", f"--opt-mode={mode}"]
    control = clingo.Control(arguments, logger=lambda _, text: messages.append(text))
    for part in ("topomap", "noise", *parts):
        control.load(str(ENCODINGS / f"{part}.lp"))
    control.add("base", [], seen.facts())
    control.ground()

    def take(model):
        if mode == "optN" and not model.optimality_proven:
            return
        shown = [(atom.name, atom.arguments) for atom in model.symbols(shown=True)]
        at = sorted(tuple(a.number for a in terms) for name, terms in shown if name == "at")
        misread = frozenset(misreadings(terms for name, terms in shown if name == "misread"))
        wrong = {terms[0].number for name, terms in shown if name == "wrong"}
        assert wrong == {step for step, _ in misread}
        key = tuple((place, slot) for _, place, slot in at), misread
        found.append((key, tuple(model.cost)))

    control.solve(on_model=take)
    assert not messages
    assert len(found) == len(dict(found)), "an answer is given twice"
    return dict(found)


def driven(seen: Experience, parts, most: int):
    query = Query(frozenset(parts), noise=most)
    found = [f for f in solving.hypotheses(seen, query, QUIET) if f.proved]
    answers = {(f.at, frozenset(f.misread)): f.cost for f in found}
    assert len(answers) == len(found)
    return answers


def best(every):
    least = min(every.values(), default=None)
    return {key: cost for key, cost in every.items() if cost == least}


def agree_with_brute_force(seen: Experience, most: int):
    """Demand the same of clingo, of the driver and of brute force; whether there is a map, and
    whether there would be one without misreadings."""
    TRIED["experiences with misreadings"] += 1
    ways = list(brute(seen, most))
    for parts in PARTS:
        every = expected(ways, parts)
        case = seen.facts(), parts, most
        assert answered(seen, parts, most, "enum,999") == every, case
        assert answered(seen, parts, most, "optN") == best(every), case
        assert driven(seen, parts, most) == best(every), case
    open_too = expected(ways, ("exceptions", "minimal"))
    least = min((cost[:2] for cost in open_too.values()), default=())  # before anything else
    closed = expected(ways, ("closed", "exceptions", "minimal"))
    optimal = {key: cost for key, cost in closed.items() if cost[:2] == least} or open_too
    query = Query(noise=most)
    found = [f for f in solving.best(seen, query, QUIET) if f.proved]
    assert {(f.at, frozenset(f.misread)): f.cost for f in found} == best(optimal)
    every = expected(ways, ())
    return bool(every), any(not misread for _, misread in every)


@pytest.mark.slow
@pytest.mark.parametrize(
    "seeds", [range(12), pytest.param(range(12, 300), marks=pytest.mark.long)], ids=["few", "many"]
)
def test_misreadings_are_those_of_brute_force(seeds):
    fates = []
    for seed in seeds:
        draw = random.Random(f"noise {seed}")
        most = seed % 3
        fates.append(agree_with_brute_force(corrupted(draw, 4 if most < 2 else 2), most))
    assert {(True, True), (True, False), (False, False)} == set(fates)


def test_figures_are_of_what_is_there():
    """Statements about a map in which views are wrong: encodings/query.lp, by stock clingo."""
    for seed in range(6):
        draw = random.Random(f"figures {seed}")
        seen = corrupted(draw, 3)
        control = clingo.Control(["0", "-c", "noise=1"])
        for part in ("topomap", "noise", "query"):
            control.load(str(ENCODINGS / f"{part}.lp"))
        every = expected(brute(seen, 1), ())
        figures = {"place": "places", "path": "paths", "link": "links", "pending": "pending"}
        facts = "".join(f"ask(number({figure},0..30)). " for figure in figures)
        control.add("base", [], seen.facts() + facts)
        control.ground()
        found = {}
        control.configuration.solve.opt_mode = "ignore"
        with control.solve(yield_=True) as models:
            for model in models:
                shown = [(atom.name, atom.arguments) for atom in model.symbols(shown=True)]
                at = sorted(tuple(a.number for a in t) for name, t in shown if name == "at")
                wrong = misreadings(terms for name, terms in shown if name == "misread")
                key = tuple((place, slot) for _, place, slot in at), frozenset(wrong)
                found[key] = {str(terms[0]) for name, terms in shown if name == "holds"}
        assert found.keys() == every.keys()
        truths = dict(brute(seen, 1))
        for (at, wrong), holding in found.items():
            h = truths[wrong].final[at]
            said = {f"number({one},{FIGURES[name](h)})" for one, name in figures.items()}
            assert holding == said


def test_no_view_is_taken_as_misread_for_a_map_to_be_closed():
    """The one step leads to a place with a gateway more; without that, the map were closed."""
    seen = parse("slots(2). view(0,0). turn(1,0). view(1,0). view(1,1).", "seen")
    found = list(solving.best(seen, Query(noise=1), QUIET))
    assert [(f.kind, f.cost, f.misread) for f in found if f.proved] == [
        ("best so far", (0, 0, 0, 1, 2), ())
    ]


# What is tested | how many views may be wrong | what is seen, step by step: the turn, gateways and
# signs | the least that was misread, one or another, as steps and what it is
RULES = """
nothing is wrong             | 1 | 0; 0: 0 2; 0: 0            |
the way back, a gateway more | 1 | 0; 0: 0 2; 0: 0 1          | 0.1; 2.1
a gateway fewer              | 1 | 0 1; 0: 0 2; 0: 0          | 0.1; 2.1
no view may be wrong         | 0 | 0; 0: 0 2; 0: 0 1          | none
all of one view              | 1 | 0; 0: 0 2; 0: 0 1 2 3      | 0.1 0.2 0.3; 2.1 2.2 2.3
a sign more                  | 1 | 0; 0: 0 2; 0: 0 a          | 0.a; 2.a
a sign and a gateway         | 1 | 0 a; 0: 0 2; 0: 0 1        | 0.1 0.a; 2.1 2.a
the gateway stood at         | 1 | 0; 0: 2; 2: 0              | 1.0
nothing is seen              | 1 | 0; 0: ; 2: 0               | 1.0 1.2
a turn to what was not seen  | 1 | 0; 0: 0; 2: 0              | 1.2
the same at the start        | 1 | 1; 1: 0                    | 0.0
two views, one allowed       | 1 | 1; 1: 1                    | none
two views                    | 2 | 1; 1: 1                    | 0.0 1.0
two views, at one place      | 2 | 0; 0: 0 2; 0: 0 1; 0: 0 3  | 1.2 1.3 2.1; 1.2 1.3 0.1; 3.2 3.3 2.1; 3.2 3.3 0.1
"""  # noqa: E501


@pytest.mark.parametrize("case", RULES.strip().splitlines())
def test_rule_holds_and_bites(case):
    _, most, steps, wanted = (field.strip() for field in case.split("|"))
    facts = ["slots(4)."]
    for step, text in enumerate(steps.split(";")):
        turn, _, view = text.rpartition(":")
        facts += [f"turn({step},{turn})."] if step else []
        for word in view.split():
            fact = "view" if word.isdigit() else "landmark"
            facts.append(f"{fact}({step},{word}).")
    seen = parse(" ".join(facts), "case", noisy=True)
    least = {misread for _, misread in answered(seen, (), int(most), "optN")}
    said = {
        frozenset(
            (int(step), int(what) if what.isdigit() else what)
            for step, what in (word.split(".") for word in one.split())
        )
        for one in wanted.split(";")
        if one != "none"
    }
    assert least == said


@pytest.mark.slow
def test_without_misreadings_the_answers_are_those_without_noise():
    for seed in range(6):
        seen = random_experience(random.Random(f"quiet {seed}"), 8, marker=seed % 2 == 1)
        for parts in PARTS:
            query = Query(frozenset(parts))
            bare = {f.at for f in solving.hypotheses(seen, query, QUIET) if f.proved}
            for most in (0, 2):
                found = driven(seen, parts, most)
                if bare:
                    assert set(found) == {(at, frozenset()) for at in bare}
                assert most or {at for at, _ in found} == bare


def back_and_forth(size: int, route: str):
    made = grid(size, size)
    (first, *_), slots = ((0, 0), 0), ["NESW".index(letter) for letter in route]
    return observe(made.map, (first, slots[0]), slots)


RETRACED = {
    3: "EESWWSEENNWSSWNNSSEN",
    4: "EEESWWWSEEESWWWNNNESSSENNNESSSNNNW",
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "step", "misread"),
    [
        (3, 13, [(13, 2)]),  # a gateway imagined
        (3, 15, [(15, 3)]),  # one missed
        (3, 18, [(18, 0)]),  # the one stood at
        (3, 12, [(12, 3)]),
        pytest.param(4, 32, [(32, 1)], marks=pytest.mark.long),
        pytest.param(4, 20, [(20, 0), (20, 2)], marks=pytest.mark.long),
    ],
)
def test_one_wrong_view_hides_every_map(size, step, misread):
    """And with one that is taken as misread, the real map is back, and that view is the one."""
    true, truth = back_and_forth(size, RETRACED[size])
    seen = true.corrected(misread)
    if not seen.misled():
        assert not list(solving.hypotheses(seen, Query(), QUIET))
    parts = frozenset(["closed", "boundary", "minimal", "planar"])
    if size == 4:
        parts |= {"perpendicular"}
    query = Query(parts, noise=1)
    found = [f for f in solving.hypotheses(seen, query, QUIET) if f.proved]
    assert [(f.at, f.misread) for f in found] == [(truth, tuple(misread))]
    assert found[0].cost[:2] == (1, len(misread))
    assert {step} == {t for t, _ in misread}


@pytest.mark.slow
def test_two_wrong_views():
    true, truth = back_and_forth(3, RETRACED[3])
    seen = true.corrected([(13, 2), (18, 0)])
    query = Query(frozenset(["closed", "boundary", "minimal", "planar"]), noise=1)
    assert not list(solving.hypotheses(seen, query, QUIET))
    found = [f for f in solving.hypotheses(seen, replace(query, noise=2), QUIET) if f.proved]
    assert (truth, ((13, 2), (18, 0))) in [(f.at, f.misread) for f in found]
    assert {f.cost[:2] for f in found} == {(2, 2)}


# The command


def test_the_instance_is_what_its_header_says():
    true, _ = back_and_forth(3, RETRACED[3])
    assert read(MISREAD) == true.corrected([(13, 2)])


def test_the_command_says_what_is_misread(topomap):
    assert topomap("solve", MISREAD, "--optimal").returncode == 1
    done = topomap("solve", MISREAD, "--optimal", "--planar", "--noise", "1")
    assert (done.returncode, done.stderr) == (0, "")
    first, last = done.stdout.splitlines()
    assert first.startswith("map 1: contradicts step 13 (gateway 2 imagined); places 9, links 12,")
    assert last == "1 optimal map by clingo, cost 1 1 0 6 9"


@pytest.mark.long
def test_maps_with_misreadings_are_checked_and_drawn(topomap, tmp_path, capsys):
    file = tmp_path / "maps.json"
    done = topomap("solve", MISREAD, "--optimal", "--noise", "2", "--json", "-o", file)
    assert done.returncode == 0
    document = json.loads(file.read_text())
    assert (document["noise"], document["cost"][:2]) == (2, [1, 1])
    assert all(len(one["misread"]) == 1 for one in document["maps"])
    assert topomap("check", MISREAD, file).returncode == 0
    assert topomap("check", MISREAD, file, "--noise", "0").returncode == 1
    assert topomap("draw", file, "-o", tmp_path / "map.svg").returncode == 0
    assert "9 places, 12 links" in topomap("show", file).stdout
    for change, fault in (
        (lambda d, m: d.update(noise=0), "misread: 1 view, more than 0"),
        (lambda d, m: d.pop("noise"), "misread: the file does not say how many"),
        (lambda d, m: m.pop("misread"), "violation("),
        (lambda d, m: m["misread"][0].update(seen=False), "misread: not what"),
        (lambda d, m: m["misread"][0].update(step=True), "misread: not what"),
        (lambda d, m: m["misread"][0].update(step=99), "misread: not what"),
        (lambda d, m: m["misread"][0].update(gateway=4), "misread: not what"),
        (lambda d, m: m["misread"].append(m["misread"][0]), "misread: not what"),
        (lambda d, m: m.update(misread=3), "misread: not what"),
        (lambda d, m: m.update(misread=[{"step": 13, "landmark": "a"}]), "misread: not what"),
        (
            lambda d, m: m["misread"].append({"step": 3, "gateway": 0, "seen": True}),
            "misread: the agent still stands at no gateway",
        ),
        (lambda d, m: d["cost"].__setitem__(1, 2), "cost: it is"),
    ):
        changed = json.loads(file.read_text())
        change(changed, changed["maps"][0])
        (tmp_path / "changed.json").write_text(json.dumps(changed))
        status = main(["check", str(MISREAD), str(tmp_path / "changed.json")])
        said = capsys.readouterr().out
        assert (status, fault in said) == (1, True), said


def test_maps_of_clingo_with_misreadings_are_checked(topomap, tmp_path):
    file = tmp_path / "maps.json"
    files = [ENCODINGS / f"{part}.lp" for part in ("topomap", "noise", "closed", "minimal")]
    done = run("clingo", *files, MISREAD, "--opt-mode=optN", "--outf=2", "0")
    file.write_text(done.stdout)
    assert topomap("check", MISREAD, file, "--closed", "--noise", "1").returncode == 0
    done = topomap("check", MISREAD, file, "--closed")
    assert done.returncode == 1
    assert "the file does not say how many views may be wrong" in done.stdout


UNSEEN = {
    "slots(4). view(0,0). turn(1,2). view(1,0).": "turn 2: no gateway there after step 0",
    "slots(4). view(0,0). turn(1,0). view(1,2).": "the view lacks slot 0, the gateway where",
    "slots(4). view(0,0). turn(1,0).": "step 1: no view",
    "slots(4). turn(1,0). view(1,0).": "step 0: no view",
}


@pytest.mark.parametrize("facts", UNSEEN)
def test_what_is_refused_without_noise_is_a_misreading(topomap, tmp_path, facts):
    file = tmp_path / "unseen.lp"
    file.write_text(facts)
    with pytest.raises(InputError) as refused:
        read(file)
    assert UNSEEN[facts] in str(refused.value)
    assert str(refused.value).endswith("solve --noise allows for that)")
    assert topomap("count", file).returncode == 2
    done = topomap("solve", file, "--noise", "0")
    assert (done.returncode, done.stdout, done.stderr) == (1, "0 consistent maps by clingo\n", "")
    done = topomap("solve", file, "--noise", "1", "--json")
    assert done.returncode == 0
    (tmp_path / "maps.json").write_text(done.stdout)
    assert topomap("check", file, tmp_path / "maps.json").returncode == 0
    assert parse(read(file, noisy=True).facts(), "again", noisy=True) == read(file, noisy=True)


@pytest.mark.parametrize(
    "option",
    [
        "--by=search",
        "--encoding=paper",
        "--jobs=2",
        "--dask=tcp://127.0.0.1:1",
        "--resume",
        "--truth=none",
    ],
)
def test_what_does_not_go_with_noise_is_refused(topomap, tmp_path, option):
    out = tmp_path / "out"
    done = topomap("solve", MISREAD, "--noise", "1", option, "-o", out)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("topomap solve: --noise cannot be combined with --")
    assert done.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())
