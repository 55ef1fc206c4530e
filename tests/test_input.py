"""encodings/input.lp: the faults of an instance as plain clingo shows them. They are those
for which the command's reader refuses it."""

import random
import re

import clingo
import pytest
from conftest import ENCODINGS, ROOT, run
from flawed import INSTANCES
from topomap.model.experience import ARITY, parse
from topomap.runtime.errors import InputError
from topomap.runtime.limits import LARGEST
from worlds import random_experience

PROGRAM = (ENCODINGS / "input.lp").read_text()
KINDS = {  # what topomap.model.experience says, and the error that says the same
    r"(there are )?no facts.*": "-1,no_slots",
    r"\d+ facts slots.*": "-1,two_slots",
    r"slots\((?P<K>-?\d+)\): K must.*": r"-1,(odd|few|many)_slots\({K}\)",
    r"step (?P<T>-\d+): steps are numbered from 0": r"-1,no_step\({T}\)",
    r"step (?P<T>\d+): it has no turn .*": "{T},no_step",
    r"step (?P<T>\d+): no turn, .*": "{T},no_turn",
    r"step 0: there is a turn, .*": "0,turn_at_start",
    r"step (?P<T>\d+): more than one turn": "{T},two_turns",
    r"step (?P<T>\d+): no view .*": "{T},no_view",
    r"step (?P<T>\d+): slot (?P<S>-?\d+) is not in .*": r"{T},slot\({S}\)",
    r"step (?P<T>\d+): the view lacks slot 0.*": "{T},no_slot_0",
    r"step (?P<T>\d+): turn (?P<S>\d+): no gateway.*": r"{T},no_gateway\({S}\)",
    r"step (?P<T>\d+): the marker is put down.*": "{T},put_down",
    r"step (?P<T>\d+): the marker is taken up.*": "{T},taken_up",
    r"step (?P<T>\d+): the marker is seen.*": "{T},no_marker",
    r".* a step or a slot is a whole number": r"-?\d+,(no_number|no_step|slot)\(.*\)",
}


def errors(facts, program=PROGRAM):
    """What stock clingo shows of the facts: exactly one answer set, and no message."""
    messages = []
    control = clingo.Control(["0"], logger=lambda _, text: messages.append(text))
    control.add("base", [], program + facts)
    control.ground([("base", [])])
    models = []
    control.solve(on_model=lambda model: models.append(sorted(map(str, model.symbols(shown=True)))))
    assert (len(models), messages) == (1, [])
    return models[0]


@pytest.mark.parametrize("facts", INSTANCES)
def test_each_fault_has_its_error(facts):
    assert errors(facts) == sorted(f"error({error})" for error in INSTANCES[facts].split())


TERMS = ("a", '"0"', "f(0)", "(0,1)", "#inf", "#sup", '""', "-a")
NUMBERS = (-1, 0, 1, 2, 3, 4, 5, 6, 7, 9, -4, 10**6, 10**9, LARGEST, -LARGEST)


def corrupted(draw):
    """The facts of a random exploration with one to three of them taken away, added or
    changed; now and then none."""
    facts = [
        [name, *terms.split(",", 1)]
        for name, terms in re.findall(
            r"(\w+)\((.*?)\)\.",
            random_experience(draw, draw.choice([0, 1, 2, 5]), marker=True).facts(),
        )
    ]
    for _ in range(draw.choice([0, 1, 1, 1, 2, 3])):
        terms = [str(draw.choice(NUMBERS)) if draw.random() < 0.8 else draw.choice(TERMS)]
        terms.append(str(draw.choice(NUMBERS)) if draw.random() < 0.8 else draw.choice(TERMS))
        name = draw.choice(list(ARITY))
        edit = draw.choice(["drop", "add", "change", "change", "shift"]) if facts else "add"
        if edit == "add":
            facts.append([name, *terms[: ARITY[name]]])
        elif edit == "drop":
            del facts[draw.randrange(len(facts))]
        elif edit == "change":
            draw.choice(facts)[-1] = terms[0]
        else:
            fact = draw.choice(facts)
            if fact[1].isdigit():
                fact[1] = str(min(int(fact[1]) + draw.choice([-1, 1]), LARGEST))
    draw.shuffle(facts)
    return " ".join(f"{name}({','.join(terms)})." for name, *terms in facts)


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


@pytest.mark.parametrize(
    "seeds", [range(1500), pytest.param(range(1500, 30000), marks=pytest.mark.long)]
)
def test_the_reader_refuses_exactly_what_shows_an_error(seeds):
    bad = [agree(corrupted(random.Random(f"input {seed}"))) for seed in seeds]
    assert len(seeds) // 2 < sum(bad) < len(seeds)


def test_it_grounds_over_what_occurs(tmp_path):
    file = tmp_path / "large.lp"
    file.write_text("slots(1000000000). view(0,0). turn(1000000000,0). view(1000000000,0).")
    done = run("clingo", ENCODINGS / "input.lp", file, "--stats")
    assert int(re.search(r"^Rules +: (\d+)", done.stdout, re.M)[1]) < 40
    assert "Models       : 1\n" in done.stdout


def test_the_instances_are_good():
    for file in (ROOT / "instances").glob("*.lp"):
        assert errors(file.read_text()) == []
