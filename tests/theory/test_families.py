"""Nothing can be combined into a wrong answer: each entry of encodings/ with each part of any
folder, by stock clingo, gives the right number of maps, or none and a message of clingo's."""

from functools import cache
from pathlib import Path

import clingo
import pytest
from conftest import ENCODINGS, PARTS, ROOT, Truth, answers, plain
from oracles.brute_force import Hypothesis, tree
from oracles.rule_mutation import named_files
from topomap.model.facts import read
from topomap.model.vocabulary import STATED

MORE = {  # facts that the paper does not have
    "marker": ["drop(0).", "drop(0,coin)."],
    "compass": ["compass(3,1)."],
    "odometry": ["shift(3,1,0)."],
    "lengths": ["length(3,7)."],
    "closures": ["same(0,16).", "apart(0,8)."],
    "straight": ["straight(0,0,0)."],
    "logs": ["look(17). view(17,0). view(17,3).", "start(17). view(17,0). view(17,2)."],
}
FACTS = read(ROOT / "instances/grid-3x3-snake.lp").facts()
BEYOND = [f"paper/beyond/{name}" for name in MORE]
OF_ENTRY = {
    "topomap": [
        *(*PARTS, "bound", "minimal", "genus", "noise", "query", "explain", "circumscribe"),
        *("exceptions", "no_path_axiom"),
    ],
    "paper/topomap": [
        *(f"paper/{part}" for part in ("bound", *STATED)),
        *(*BEYOND, "paper/beyond/exceptions", "paper/beyond/tolerance", "no_path_axiom"),
    ],
}
# They are loaded by programs, which add a fact that says so, and not by plain clingo.
FOR_PROGRAMS = ["phases/topomap", "phases/visits", "phases/runs", "phases/lines", "online"]
ENTRIES = [*OF_ENTRY, *FOR_PROGRAMS]
ALONE = ("input", "check", "explore", "unseen", "bisimilar")  # programs of their own
INCLUDED = (
    "theory/",
    "explore/",
    "paper/path_axiom",
    "paper/paths",
    "paper/sides",
    "paper/told",
)
EVERY_PART = [
    file
    for file in named_files(ENCODINGS)
    if file not in (*ENTRIES, *ALONE) and not file.startswith(INCLUDED)
]


def tried(files, facts, *arguments):
    """How many answers clingo gives, or how many best ones, and what it says besides."""
    messages = []
    options = ["0", "--opt-mode=optN", "--project", *arguments]
    control = clingo.Control(options, logger=lambda _, text: messages.append(text))
    for file in files:
        control.load(str(ENCODINGS / f"{file}.lp"))
    control.add("base", [], facts + "#project at/3.")
    control.ground()
    found = 0

    def count(model):
        nonlocal found
        found += model.optimality_proven or not model.cost

    control.solve(on_model=count)
    return found, messages


@cache
def maps(part):
    """The maps that a part leaves, or prefers, by the independent search."""
    snake = read(ROOT / "instances/grid-3x3-snake.lp")
    if part == "no_path_axiom":
        return {*tree(plain(snake), axiom=False)[-1]}
    truth = Truth(snake)
    if part in PARTS or part == "bound":
        return truth.having(*[part] * (part in PARTS), bound=16 if part == "bound" else None)
    keys = {
        "minimal": lambda h: h.cost(),
        "genus": lambda h: h.genus(),
        "exceptions": lambda h: sum(h.exceptions()),
    }
    return truth.least(keys.get(part, lambda _: 0), truth.final)


def bounded(file):
    return ["-c", "places=16"] if file.endswith("bound") else []


@pytest.mark.parametrize("part", EVERY_PART)
@pytest.mark.parametrize("entry", ENTRIES)
def test_each_entry_with_each_part(entry, part):
    found, messages = tried([entry, part], FACTS, *bounded(part))
    if part in OF_ENTRY.get(entry, ()):
        assert (found, messages) == (len(maps(Path(part).name)), [])
    else:
        assert found == 0
        assert any("does not occur in any rule head" in message for message in messages)


@pytest.mark.parametrize("program", ALONE)
@pytest.mark.parametrize("entry", OF_ENTRY)
def test_a_program_of_its_own_changes_no_count(entry, program):
    assert tried([entry, program], FACTS)[0] == len(maps(""))


@pytest.mark.parametrize("part", EVERY_PART)
def test_a_part_without_an_entry(part):
    found, messages = tried([part], FACTS, *bounded(part))
    assert found == 0
    assert any("does not occur in any rule head" in message for message in messages)


@pytest.mark.parametrize("entry", ENTRIES)
def test_an_entry_without_an_instance(entry):
    found, messages = tried([entry], "")
    assert found == 0
    assert any("does not occur in any rule head" in message for message in messages)


@pytest.mark.parametrize("entry", OF_ENTRY)
def test_a_bound_without_its_number(entry):
    part = entry.replace("topomap", "bound")
    found, messages = tried([entry, part], FACTS)
    assert found == 0
    assert any("operation undefined" in message for message in messages)


@pytest.mark.parametrize(("file", "fact"), [(file, fact) for file in MORE for fact in MORE[file]])
def test_the_statement_refuses_what_it_does_not_know(file, fact):
    assert tried(["paper/topomap"], FACTS + fact)[0] == 0
    with_it = tried(["paper/topomap", f"paper/beyond/{file}"], FACTS + fact)
    assert with_it == tried(["topomap"], FACTS + fact)
    assert with_it[0] > 0


@pytest.mark.parametrize("horizon", [(), ("-c", "horizon=16")])
@pytest.mark.parametrize("other", [entry for entry in ENTRIES if entry != "topomap"])
def test_two_entries_are_not_loaded_together(other, horizon):
    try:
        found, messages = tried(["topomap", other], FACTS, *horizon)
    except RuntimeError:  # what clingo's Python has for a constant of two values
        return
    assert found == 0
    assert any("does not occur in any rule head" in message for message in messages)


@pytest.mark.parametrize("entry", ["topomap", "paper/topomap"])
def test_half_an_instance_has_no_map(entry):
    found, messages = tried([entry], "slots(4).")
    assert found == 0
    assert any("view(" in message for message in messages)


@pytest.mark.parametrize("more", [(), ("explain",), ("noise",)])
def test_a_bound_without_a_number_has_no_map(more):
    found, messages = tried(["topomap", "bound", *more], FACTS)
    assert found == 0
    assert any("operation undefined" in message for message in messages)


def test_the_statement_says_that_it_does_not_know_a_marker():
    facts = FACTS + "drop(0)."
    found, messages = tried(["paper/topomap"], facts)
    assert found == 0
    assert any("with_marker" in message for message in messages)
    truth = Truth(read(ROOT / "instances/grid-3x3-snake.lp").cut(16))
    assert len(truth.final) == tried(["paper/topomap", "paper/beyond/marker"], FACTS)[0]
    assert (
        tried(["paper/topomap", "paper/beyond/marker"], facts)
        == tried(["topomap"], facts)
        != (0, [])
    )


@pytest.mark.slow
def test_the_path_axiom_can_be_taken_away_step_by_step():
    """The line of online.lp that includes it is taken out. (Of the other entries it is a default:
    test_exceptions.py.)"""
    head, *steps = FACTS.splitlines()
    lines = (ENCODINGS / "online.lp").read_text().replace('"online/', f'"{ENCODINGS}/online/')
    without = [line for line in lines.splitlines() if "path_axiom" not in line]
    messages = []
    options = ["0", "--project", "--opt-mode=ignore"]
    control = clingo.Control(options, logger=lambda _, text: messages.append(text))
    control.add("base", [], "\n".join([*without, "online.", head]))
    control.ground()
    for step, facts in enumerate(steps):
        control.add(f"facts{step}", [], facts)
        control.ground([(f"facts{step}", []), ("step", [clingo.Number(step)])])
    with control.solve(yield_=True) as models:
        assert len([*models]) == 129
    assert not messages


def test_perpendicular_maps_without_the_axiom():
    """One path may cross itself."""
    views = " ".join(f"view({step},(0;1;2;3))." for step in range(4))
    facts = f"slots(4). {views} turn(1,3). turn(2,3). turn(3,3)."
    experience = (4, [{0, 1, 2, 3}] * 4, [None, 3, 3, 3], [frozenset()] * 4, set())
    every = answers(("no_path_axiom",), facts)
    kept = {at for at in every if Hypothesis(experience, at).perpendicular()}
    assert answers(("no_path_axiom", "perpendicular"), facts) == kept
    assert any(Hypothesis(experience, at).breaks_path_axiom() for at in kept)
