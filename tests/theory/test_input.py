"""encodings/input.lp: the faults of an instance as plain clingo shows them. They are those
for which the command's reader refuses it."""

import random
import re

import pytest
from conftest import ENCODINGS, ROOT, run
from oracles.instance_faults import KINDS, PROGRAM, corrupted, errors
from oracles.maps_with_errors import INSTANCES
from topomap.model.facts import parse
from topomap.runtime.errors import InputError


@pytest.mark.parametrize("facts", INSTANCES)
def test_each_fault_has_its_error(facts):
    assert errors(facts) == sorted(f"error({error})" for error in INSTANCES[facts].split())


def agree(facts):
    """Whether there is an error; and that the reader refuses then, and only then, and
    for a fault that is among the errors."""
    shown, message = errors(facts), None
    try:
        parse(facts, "made")
    except InputError as error:
        message = re.sub(r"^made(:\d+)?: ", "", str(error))
    assert bool(shown) == bool(message), f"{facts}\nread: {message}\nshown: {shown}"
    if message:
        matches = [(re.fullmatch(said, message), meant) for said, meant in KINDS.items()]
        (wanted,) = (meant.format(**match.groupdict()) for match, meant in matches if match)
        assert any(re.fullmatch(rf"error\({wanted}\)", error) for error in shown), (
            f"{facts}\nread: {message}\nshown: {shown}"
        )
    return bool(shown)


@pytest.mark.slow
@pytest.mark.parametrize(
    "seeds", [range(1500), pytest.param(range(1500, 30000), marks=pytest.mark.long)]
)
def test_the_reader_refuses_exactly_what_shows_an_error(seeds):
    bad = [agree(corrupted(random.Random(f"input {seed}"))) for seed in seeds]
    assert len(seeds) // 2 < sum(bad) < len(seeds)


def test_percents_are_not_negative():
    """They are constants of clingo, which takes any number; the commands refuse these, too."""
    facts = "slots(4). view(0,0). turn(1,0). view(1,0). shift(1,1,0). length(1,5).\n"
    for name in ("drift", "stretch"):
        assert errors(facts, f"{PROGRAM}\n#const {name} = -1. ") == [
            f"error(-1,negative_{name}(-1))"
        ]
        assert errors(facts, f"{PROGRAM}\n#const {name} = 0. ") == []


def test_it_grounds_over_what_occurs(tmp_path):
    file = tmp_path / "large.lp"
    file.write_text("slots(1000000000). view(0,0). turn(1000000000,0). view(1000000000,0).")
    done = run("clingo", ENCODINGS / "input.lp", file, "--stats")
    assert int(re.search(r"^Rules +: (\d+)", done.stdout, re.M)[1]) < 40
    assert "Models       : 1\n" in done.stdout


def test_the_instances_are_good():
    for file in (ROOT / "instances").glob("*.lp"):
        assert errors(file.read_text()) == []
