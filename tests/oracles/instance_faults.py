"""Instances with faults, and the error of encodings/input.lp that belongs to each message of the
command's reader."""

import re

import clingo
from conftest import ENCODINGS
from topomap.model.facts import SIGNATURES
from topomap.runtime.limits import LARGEST

from oracles.worlds import random_experience

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
    r"step (?P<T>\d+): turn (?P<S>-?\d+): no gateway.*": r"{T},no_gateway\({S}\)",
    r"step (?P<T>\d+): the marker is put down.*": "{T},put_down",
    r"step (?P<T>\d+): the marker is taken up.*": "{T},taken_up",
    r"step (?P<T>\d+): the marker is seen.*": "{T},no_marker",
    r".*: K is a whole number": r"-1,no_number\(.*\)",
    r".*: a step is a whole number": r"-?\d+,no_step\(.*\)",
    r".* a step and a slot are whole numbers": r"-?\d+,(no_step|(compass_)?slot)\(.*\)",
    r".* a step, and how far it moved, are whole numbers": r"-?\d+,no_(step|shift)\(.*\)",
    r".* a step and two slots are whole numbers": r"-?\d+,(no_step|straight_slot)\(.*\)",
    r"step (?P<T>\d+): straight\(.*\): slot (?P<S>-?\d+) is not in .*": (
        r"{T},straight_slot\({S}\)"
    ),
    r"step (?P<T>\d+): straight\(.*\): no gateway in slot (?P<S>\d+) .*": r"{T},no_pair\({S}\)",
    r"step (?P<T>\d+): gateway (?P<S>\d+) is in more than one pair": r"{T},two_pairs\({S}\)",
    r".* a step and its length are whole numbers": r"-?\d+,no_(step|length)\(.*\)",
    r"step (?P<T>\d+): compass slot (?P<S>-?\d+) is not in .*": r"{T},compass_slot\({S}\)",
    r"step (?P<T>\d+): more than one compass": "{T},two_compasses",
    r"step (?P<T>\d+): more than one shift": "{T},two_shifts",
    r"step (?P<T>\d+): more than one length": "{T},two_lengths",
    r"step 0: there is a shift, .*": "0,shift_at_start",
    r"step 0: there is a length, .*": "0,length_at_start",
    r"step (?P<T>\d+): length (?P<D>-?\d+) is not above 0": r"{T},no_length\({D}\)",
    r"step (?P<T>\d+): there is a length, but it is not a travel step": r"{T},no_way\(.*\)",
    r"step (?P<T>\d+): the shifts up to here .*": "{T},far",
    r"step (?P<T>\d+): length \d+ is above .*": "{T},long",
    r"step (?P<T>\d+): it is said to be at another place than itself": "{T},apart_from_itself",
    r"step 0: it is already the start": "0,starts_already",
    r"step 0: there is no earlier look": "0,no_earlier_look",
    r"step (?P<T>\d+): (it has a turn, but begins a log|a look has no turn)": "{T},travels",
    r"step (?P<T>\d+): it begins a log, and is a second look": "{T},start_and_look",
}
TERMS = ("a", '"0"', "f(0)", "(0,1)", "#inf", "#sup", '""', "-a")
NUMBERS = (-1, 0, 1, 2, 3, 4, 5, 6, 7, 9, -4, 10**6, 10**9, LARGEST, -LARGEST)


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
        terms = [
            str(draw.choice(NUMBERS)) if draw.random() < 0.8 else draw.choice(TERMS)
            for _ in range(3)
        ]
        name = draw.choice(list(SIGNATURES))
        edit = draw.choice(["drop", "add", "change", "change", "shift"]) if facts else "add"
        if edit == "add":
            facts.append([name, *terms[: SIGNATURES[name].count(",") + 1]])
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
