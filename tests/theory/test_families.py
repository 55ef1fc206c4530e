"""Nothing can be combined into a wrong answer: each entry of encodings/ with each part of any
folder, by stock clingo, gives the right number of maps, or none and a message of clingo's."""

from functools import cache
from pathlib import Path

import clingo
import pytest
from conftest import ENCODINGS, PARTS, ROOT, Truth
from oracles.rule_mutation import named_files
from topomap.model.facts import read
from topomap.model.vocabulary import STATED

FACTS = read(ROOT / "instances/grid-3x3-snake.lp").facts()
OF_ENTRY = {
    "topomap": [*PARTS, "bound", "minimal", "genus", "noise", "query", "explain"],
    "paper/topomap": [*(f"paper/{part}" for part in ("bound", *STATED)), "paper/beyond/marker"],
}
# They are loaded by programs, which add a fact that says so, and not by plain clingo.
FOR_PROGRAMS = ["phases/topomap", "phases/visits", "phases/runs", "phases/lines", "online"]
ENTRIES = [*OF_ENTRY, *FOR_PROGRAMS]
ALONE = ("input", "check", "explore", "unseen", "bisimilar")  # programs of their own
INCLUDED = ("theory/", "explore/")
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
    truth = Truth(read(ROOT / "instances/grid-3x3-snake.lp"))
    if part in PARTS or part == "bound":
        return truth.having(*[part] * (part in PARTS), bound=16 if part == "bound" else None)
    keys = {"minimal": lambda h: h.cost(), "genus": lambda h: h.genus()}
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


def test_the_statement_refuses_a_marker_that_it_does_not_know():
    assert tried(["paper/topomap"], FACTS + "drop(0).")[0] == 0
    with_it = tried(["paper/topomap", "paper/beyond/marker"], FACTS + "drop(0).")
    assert with_it == tried(["topomap"], FACTS + "drop(0).")
    assert with_it[0] > 0
