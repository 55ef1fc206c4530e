"""Maps and instances with errors, and what is wrong with each."""

import random
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

from topomap.model.experience import MARKER, Experience
from topomap.model.facts import parse
from topomap.model.query import Query
from topomap.search import traversal

from oracles.worlds import bent, informed, logs, random_experience

At = list[tuple[int, int, int]]
DEMANDS = ("planar", "bound(3)", "closed", "travelled", "boundary", "perpendicular")
CORRIDOR = ("0", "0: 0 2", "2: 0", "0: 0 2")
SQUARE = ("0 3", "0: 0 3", "3: 0 3", "3: 0 3", "3: 0 1")
LASSO = ("0 1 2", "0: 0 1 2 3", "0: 0 1 2", "1: 0", "0: 0 1 3", "1: 0 1 2 3")
TRIANGLE = ("0 3", "0: 0 1", "1: 0 1", "1: 0 1")
EARS = ("0 1 2 3", "0: 0 1", "1: 0 1", "1: 0 1 2 3", "1: 0 1", "1: 0 1", "1: 0 1 2 3")
TWISTED = ("0 1", "0: 0 1", "1: 0 3", "3: 0 3")
# The link in the middle of a street is its newest.
GROWING = ("0 1 2", "2: 0 1 a", "0: 0 2 3", "2: 0 3", "3: 0 2 3", "2: 0 3 a")
CORNERS = ("0 1", "0: 0 1", "1: 0 3")
TAKEN = ("0 drop", "0: 0 2", "0: 0 pick", "0: 0 2", "0: 0")
MOVED = ("0 drop", "0: 0 2", "0: 0 pick drop", "0: 0 2", "0: 0 marker")
# The rule, what is seen ("turn: gateways", landmarks, what is done with the marker), a sound map
# and a map that breaks it, as a place and a gateway after each step, and the step at which it
# does.
MAPS = [
    ("exactly_one", CORRIDOR, "0.0 1.0 2.0 1.2", "0.0 1.0 - 1.2", 2),
    ("exactly_one", CORRIDOR, "0.0 1.0 2.0 1.2", "0.0 1.0 2.0 1.2 0.0", 4),
    ("exactly_one", CORRIDOR, "0.0 1.0 2.0 1.2", "0.0 1.0 2.0 1.2 0.3", 4),
    ("exactly_one", CORRIDOR, "0.0 1.0 2.0 1.2", "0.0 1.0/0.0 2.0 1.2", 1),
    ("naming", CORRIDOR, "0.0 1.0 2.0 1.2", "0.0 2.0 2.0 2.0", 1),
    ("naming", ("0 2", "2: 0 2"), "0.0 1.0", "0.2 1.0", 0),
    ("naming", ("0 2", "0: 0 2"), "0.0 1.0", "1.0 1.0", 0),
    ("naming", CORRIDOR, "0.0 1.0", "0.0 2.0", 1),
    ("gateway", CORNERS, "0.0 1.0 0.1", "0.0 1.0 0.2", 2),
    ("view", ("0 1", "0: 0 1", "1: 0 1 3"), "0.0 1.0 2.0", "0.0 1.0 0.1", 2),
    ("view", ("0 1 3", "0: 0 1", "1: 0 1"), "0.0 1.0 2.0", "0.0 1.0 0.3", 2),
    ("view", ("0 1", "0: 0 1", "1: 0 2"), "0.0 1.0 2.0", "0.0 1.0 0.1", 2),
    ("landmark", ("0 a", "0: 0 2 a", "2: 0", "0: 0 2 a"), "0.0 1.0 2.0 1.2", "0.0 1.0 0.0 1.2", 2),
    ("landmark", ("0", "0: 0 2", "2: 0", "0: 0 2 a"), "0.0 1.0 2.0", "0.0 1.0 2.0 1.2", 3),
    ("landmark", ("0", "0: 0 2 a", "2: 0", "0: 0 2"), "0.0 1.0 2.0", "0.0 1.0 2.0 1.2", 3),
    ("marker", ("0 drop", "0: 0 2", "0: 0 marker"), "0.0 1.0 0.0", "0.0 1.0 2.0", 2),
    ("marker", ("0 drop", "0: 0 2", "2: 0"), "0.0 1.0 2.0", "0.0 1.0 0.0", 2),
    ("marker", ("0 drop", "0: 0 2", "0: 0 pick"), "0.0 1.0 0.0", "0.0 1.0 2.0", 2),
    ("marker", TAKEN, "0.0 1.0 0.0 1.0 0.0", "0.0 1.0 2.0 1.0 4.0", 2),
    ("marker", MOVED, "0.0 1.0 0.0 1.0 0.0", "0.0 1.0 0.0 1.0 4.0", 4),
    ("schema", CORRIDOR, "0.0 1.0 2.0 1.2", "0.0 1.0 2.0 3.0", 3),
    ("itself", ("0 1", "0: 0 1"), "0.0 1.0", "0.0 0.0", 1),
    ("path_twice", LASSO, "0.0 1.0 0.0 3.0 0.1 5.0", "0.0 1.0 0.0 3.0 0.1 1.1", 5),
    ("path_twice", ("0 1", "0: 0 3"), "0.0 1.0", "0.0 0.1", 1),
    ("path_circular", LASSO, "0.0 1.0 0.0 3.0 0.1 5.0", "0.0 1.0 0.0 3.0 0.1 1.2", 5),
    ("planar", EARS, "0.0 1.0 2.0 0.2 4.0 5.0 6.0", "0.0 1.0 2.0 0.2 4.0 5.0 0.1", 6),
    ("bound(3)", SQUARE, "0.0 1.0 2.0", "0.0 1.0 2.0 3.0 0.3", 3),
    ("closed", SQUARE, "0.0 1.0 2.0 3.0 0.3", "0.0 1.0 2.0 3.0 4.0", 4),
    ("travelled", SQUARE, "0.0 1.0 2.0 3.0 0.3", "0.0 1.0 2.0 3.0", 3),
    ("travelled", ("0 2", "0: 0"), "0.0 1.0", "0.0", 0),
    ("boundary", CORNERS, "0.0 1.0 2.0", "0.0 1.0 0.1", 2),
    ("boundary", TWISTED, "0.0 1.0 2.0", "0.0 1.0 2.0 0.1", 3),
    ("perpendicular", CORNERS, "0.0 1.0 2.0", "0.0 1.0 0.1", 2),
    ("perpendicular", TRIANGLE, "0.0 1.0 2.0 3.0", "0.0 1.0 2.0 0.3", 3),
    ("perpendicular", GROWING, "0.0 1.0 0.2 3.0 4.0 5.0", "0.0 1.0 0.2 3.0 4.0 1.1", 5),
]


def of_texts(steps: tuple[str, ...]) -> Experience:
    """The experience of such texts."""
    facts = ["slots(4)."]
    for step, text in enumerate(steps):
        turn, _, view = text.rpartition(":")
        facts += [f"turn({step},{turn})."] if step else []
        for word in view.split():
            name = "view" if word.isdigit() else "landmark"
            facts.append(f"{word}({step})." if word in MARKER else f"{name}({step},{word}).")
    return parse(" ".join(facts), "test")


def placed(text: str) -> At:
    """A map of such a text."""
    return [
        (step, *map(int, dstate.split(".")))
        for step, dstates in enumerate(text.split())
        for dstate in dstates.split("/")
        if dstate != "-"
    ]


def with_errors(draw: random.Random, experience: Experience, at: At) -> At:
    """The same with an error or two."""
    wrong = list(at)
    for _ in range(draw.choice((1, 1, 2))):
        step = draw.randrange(len(wrong))
        kind = draw.choice(("gone", "two", "place", "slot", "cut", "more"))
        if kind == "gone" and len(wrong) > 1:
            del wrong[step]
        elif kind == "two":
            wrong.append((wrong[step][0], draw.randrange(experience.steps + 1), 0))
        elif kind == "place":
            place = draw.randrange(-1, experience.steps + 2)
            wrong[step] = wrong[step][0], place, wrong[step][2]
        elif kind == "slot":
            slot = draw.randrange(-1, experience.slots + 1)
            wrong[step] = *wrong[step][:2], slot
        elif kind == "cut":
            del wrong[step + 1 :]
        else:
            wrong.append((draw.randrange(-2, experience.steps + 4), 0, 0))
    return wrong


def mapped(draw: random.Random, steps: int, marker: bool = False) -> tuple[Experience, At]:
    """A random experience, and a sound map of it with few paths; with a marker, the real one may
    be none."""
    experience = random_experience(draw, steps, marker)
    for node in traversal.best_first(traversal.root(experience, Query())):
        if node.steps == experience.steps:
            return experience, [(step, *dstate) for step, dstate in enumerate(node.dstates)]
    assert marker
    return mapped(draw, steps, marker)


def by_hand() -> Iterator[tuple[Experience, At]]:
    """The maps above."""
    for _, steps, sound, broken, _ in MAPS:
        yield of_texts(steps), placed(sound)
        yield of_texts(steps), placed(broken)


def drawn(number: int) -> Iterator[tuple[Experience, At]]:
    """Random maps, sound and with errors."""
    for seed in range(number):
        draw = random.Random(f"flawed {seed}")
        experience, at = mapped(draw, 10, marker=seed % 3 == 2)
        yield experience, at
        for _ in range(3):
            yield experience, with_errors(draw, experience, at)


def contradicting(number: int) -> Iterator[tuple[Experience, At]]:
    """Hypotheses of what is seen, most of which contradict what is known besides."""
    for seed in range(number):
        draw = random.Random(f"contradicting {seed}")
        experience = (informed if seed % 2 else logs)(draw, 7)
        bare = replace(experience, compass=(), shifts=(), lengths=(), same=(), apart=(), things=())
        node = traversal.root(bare, Query())
        found = [n.dstates for n in traversal.depth_first(node) if n.steps == bare.steps]
        for at in draw.sample(found, min(3, len(found))):
            told = [(step, *dstate) for step, dstate in enumerate(at)]
            yield experience, told
            yield experience, with_errors(draw, experience, told)


def coming_back(number: int) -> Iterator[tuple[Experience, At]]:
    """Maps in which, as a rule, a path is circular or holds a place twice."""
    for seed in range(number):
        draw = random.Random(f"coming back {seed}")
        experience = random_experience(draw, draw.choice([4, 5, 6, 7]))
        node = traversal.root(experience, Query(frozenset(["no_path_axiom"])))
        ends = (one for one in traversal.depth_first(node) if one.steps == experience.steps)
        found = [one.dstates for one in islice(ends, 300)]
        wrong = [at for at in found if experience.map_of(at).path_axiom_fault()]
        for at in draw.sample(wrong or found, 1):
            yield experience, [(step, *dstate) for step, dstate in enumerate(at)]


def bent_maps(number: int) -> Iterator[tuple[Experience, At]]:
    """Maps, with errors or without, where pairs of gateways are given, or bearings are not exact:
    of the very experience, and of one about which less is given, or less exactly; some with paths
    that come back."""
    # Two circular paths through one place, neither with the other on both of its sides.
    rings = Experience(
        4, [[*range(4)]] * 3, [1, 2], straight=[[(0, 1), (2, 3)]] * 2 + [[(1, 2), (0, 3)]]
    )
    yield rings, [(0, 0, 0), (1, 0, 0), (2, 0, 3)]
    for seed in range(number):
        draw = random.Random(f"bent maps {seed}")
        experience = bent(draw, draw.choice([3, 5, 6, 8]))
        less = replace(experience, compass=())
        if seed % 2:
            less = replace(less, straight=draw.choice([(), less.straight]))
        if seed % 2 and less.tolerance:
            less = replace(less, tolerance=less.tolerance + 1)
        node = traversal.root(less, Query(frozenset(["no_path_axiom"] if seed % 3 else [])))
        ends = (one for one in traversal.depth_first(node) if one.steps == less.steps)
        found = [one.dstates for one in islice(ends, 200)]
        for at in draw.sample(found, min(2, len(found))):
            told = [(step, *dstate) for step, dstate in enumerate(at)]
            yield experience, told
            if draw.random() < 0.3:
                yield experience, with_errors(draw, experience, told)


# Facts, and the errors that input.lp shows.
THREE = "slots(4). view(0,0). view(0,1). view(0,2)."
ONE = "slots(4). view(0,0). turn(1,0). view(1,0)."
INSTANCES = {
    "slots(4). view(0,0).": "",
    "slots(4). view(0,0). view(0,3). turn(1,3). view(1,0). landmark(1,a).": "",
    "": "-1,no_slots 0,no_view",
    "slots(4;6). view(0,0).": "-1,two_slots",
    "slots(a). view(0,0).": "-1,no_number(a)",
    "slots(#inf). view(0,0).": "-1,no_number(#inf)",
    "slots(5). view(0,0).": "-1,odd_slots(5)",
    "slots(1). view(0,0).": "-1,odd_slots(1) -1,few_slots(1)",
    "slots(2). view(0,0).": "",
    "slots(1000000). view(0,0).": "",
    "slots(1000001). view(0,0).": "-1,odd_slots(1000001) -1,many_slots(1000001)",
    "slots(2147483647). view(0,0).": "-1,odd_slots(2147483647) -1,many_slots(2147483647)",
    "slots(4). view(0,0). view(a,1).": "-1,no_step(a)",
    "view(0,0). view(0,2147483647).": "-1,no_slots",
    "slots(0). view(0,0).": "-1,few_slots(0) 0,slot(0)",
    "slots(1000002). view(0,0).": "-1,many_slots(1000002)",
    "slots(4). view(0,0). view(-1,0).": "-1,no_step(-1)",
    "slots(4). view(0,0). landmark(#inf,a).": "-1,no_step(#inf)",
    "slots(4). view(0,0). turn(a,0).": "-1,no_step(a)",
    "slots(4). view(0,0). turn(2,0). turn(4,0). view(2,0). view(4,0).": "1,no_turn 3,no_turn",
    "slots(4). view(0,0). view(1,0).": "1,no_step",
    "slots(4). view(0,0). turn(0,0).": "0,turn_at_start",
    "slots(4). view(0,0). view(0,1). turn(1,0). turn(1,1). view(1,0).": "1,two_turns",
    "slots(4). view(0,0). turn(1,0).": "1,no_view",
    "slots(4). turn(1,0). view(1,0).": "0,no_view",
    "slots(4). view(0,1).": "0,no_slot_0",
    "slots(4). view(0,0). view(0,4). view(0,-1).": "0,slot(4) 0,slot(-1)",
    "slots(4). view(0,0). turn(1,4). view(1,0).": "1,slot(4) 1,no_gateway(4)",
    "view(0,0). view(0,a).": "-1,no_slots 0,slot(a)",
    "slots(4). view(0,0). turn(1,3). view(1,0).": "1,no_gateway(3)",
    "slots(4). view(0,0). drop(0). turn(1,0). view(1,0). drop(1).": "1,put_down",
    "slots(4). view(0,0). drop(0). turn(1,0). view(1,0). pick(1). drop(1).": "",
    "slots(4). view(0,0). drop(0). marker(0). turn(1,0). view(1,0). marker(1). pick(1).": "",
    "slots(4). view(0,0). drop(0). turn(1,0). view(1,0). turn(2,0). view(2,0). drop(2).": (
        "2,put_down"
    ),
    "slots(4). view(0,0). drop(0). turn(1,0). view(1,0). pick(1). turn(2,0). view(2,0). drop(2).": (
        ""
    ),
    "slots(4). view(0,0). pick(0).": "0,taken_up",
    "slots(4). view(0,0). drop(-1). marker(0).": "-1,no_step(-1) 0,no_marker",
    "slots(4). view(0,0). pick(0). drop(0).": "0,taken_up",
    "slots(4). view(0,0). marker(0).": "0,no_marker",
    "slots(4). view(0..2,0). turn(1..2,0). drop(0). pick(1). marker(2).": "2,no_marker",
    "slots(4). view(0,0). drop(a). pick((1,2)). marker(-1).": (
        "-1,no_step(a) -1,no_step((1,2)) -1,no_step(-1)"
    ),
    "slots(4). view(0,0). drop(1). pick(2). marker(3).": "1,no_step 2,no_step 3,no_step",
    "slots(4). view(0,0). compass(0,3).": "",
    "slots(4). view(0,0). compass(0,4).": "0,compass_slot(4)",
    "slots(4). view(0,0). compass(0,-1).": "0,compass_slot(-1)",
    "slots(4). view(0,0). compass(0,a).": "0,compass_slot(a)",
    "slots(4). view(0,0). compass(0,1). compass(0,2).": "0,two_compasses",
    "slots(4). view(0,0). compass(-1,0).": "-1,no_step(-1)",
    "slots(4). view(0,0). compass(1,0).": "1,no_step",
    f"{ONE} shift(1,-3,4). length(1,1).": "",
    f"{ONE} shift(0,1,1). length(0,1).": "0,shift_at_start 0,length_at_start",
    f"{ONE} shift(1,1,1). shift(1,1,2). length(1,1). length(1,2).": "1,two_shifts 1,two_lengths",
    f"{ONE} shift(1,a,2).": "1,no_shift(a)",
    f"{ONE} shift(1,2,#inf).": "1,no_shift(#inf)",
    f"{ONE} length(1,0).": "1,no_length(0)",
    f"{ONE} length(1,-1).": "1,no_length(-1)",
    f"{ONE} length(1,b).": "1,no_length(b)",
    f"{ONE} shift(1,-21474836,0). length(1,21474836).": "",
    f"{ONE} shift(1,0,21474837). length(1,21474837).": "1,far 1,long",
    f"{ONE} shift(1,-21474837,0).": "1,far",
    f"{ONE} shift(1,2147483647,2147483647).": "1,far",
    f"{ONE} turn(2,0). view(2,0). shift(1,21474836,0). shift(2,0,0).": "",
    f"{ONE} turn(2,0). view(2,0). shift(1,21474836,0). shift(2,0,1).": "2,far",
    f"{ONE} turn(2,0). view(2,0). shift(2,10737418,-10737418).": "",
    f"{ONE} same(0,1). apart(1,0). same(1,1).": "",
    f"{ONE} apart(1,1).": "1,apart_from_itself",
    f"{ONE} same(0,2).": "2,no_step",
    f"{ONE} apart(-1,0).": "-1,no_step(-1)",
    f"{ONE} look(2). view(2,0). start(3). view(3,0).": "",
    f"{ONE} look(2).": "2,no_view",
    f"{ONE} start(3). view(3,0).": "2,no_turn",
    f"{ONE} straight(0,0,0). straight(1,0,0).": "",
    f"{ONE} straight(0,0,1). straight(1,3,0).": "0,no_pair(1) 1,no_pair(3)",
    f"{ONE} straight(1,1,1).": "1,no_pair(1)",
    f"{ONE} straight(1,0,4). straight(0,-1,0).": "1,straight_slot(4) 0,straight_slot(-1)",
    f"{ONE} straight(1,a,0).": "1,straight_slot(a)",
    f"{ONE} straight(1,0,a).": "1,straight_slot(a)",
    f"{ONE} straight(1,0,#inf).": "1,straight_slot(#inf)",
    f"{ONE} straight(a,0,0).": "-1,no_step(a)",
    f"{ONE} straight(-1,0,0).": "-1,no_step(-1)",
    f"{ONE} straight(a,8,9).": "-1,no_step(a)",
    "view(0,0). straight(0,a,0).": "-1,no_slots 0,straight_slot(a)",
    f"{ONE} straight(2,0,0).": "2,no_step",
    f"{THREE} straight(0,0,1). straight(0,1,0).": "",
    f"{THREE} straight(0,0,1). straight(0,2,1).": "0,two_pairs(1)",
    f"{THREE} straight(0,0,1). straight(0,1,1).": "0,two_pairs(1)",
    f"{THREE} straight(0,1,2). straight(0,2,2).": "0,two_pairs(2)",
    "slots(4). view(0,0). view(0,3). straight(0,3,0).": "",
    "view(0,0). straight(0,2147483647,0).": "-1,no_slots 0,no_pair(2147483647)",
    f"{ONE} start(0).": "0,starts_already",
    f"{ONE} look(0).": "0,no_earlier_look",
    f"{ONE} start(1).": "1,travels",
    f"{ONE} look(1).": "1,travels",
    f"{ONE} start(2). look(2). view(2,0).": "2,start_and_look",
    f"{ONE} look(2). view(2,0). length(2,5).": "2,no_way(5)",
    f"{ONE} look(2). view(2,0). shift(2,5,0). turn(3,0). view(3,0).": "",
    f"{ONE} look(a). start(-1).": "-1,no_step(a) -1,no_step(-1)",
    f"{ONE} drop(0,a). marker(1,a). drop(1,b).": "",
    f"{ONE} drop(0,a). drop(1,a).": "1,put_down",
    f"{ONE} drop(0). drop(1,a).": "",
    f"{ONE} drop(0,a). pick(1,b).": "1,taken_up",
    f"{ONE} drop(0,a). marker(1,b).": "1,no_marker",
    f"{ONE} drop(0,a). pick(1,a). drop(1,a).": "",
    f"{ONE} marker(a,b).": "-1,no_step(a)",
    # Each fault where another fact is missing or wrong, too.
    f"{ONE} pick(a,b). drop(b,a).": "-1,no_step(a) -1,no_step(b)",
    f"{ONE} drop(2,a).": "2,no_step",
    f"{ONE} shift(a,1,1). length(b,1).": "-1,no_step(a) -1,no_step(b)",
    f"{ONE} shift(-1,a,0). length(-1,0).": "-1,no_step(-1)",
    f"{ONE} compass(-1,9).": "-1,no_step(-1)",
    f"{ONE} apart(a,a).": "-1,no_step(a)",
    "slots(4). view(0,0). turn(0,0). start(0).": "0,turn_at_start 0,starts_already",
    "slots(4). view(0,0). start(0). look(0).": "0,starts_already 0,no_earlier_look",
    "slots(4). view(0,0). view(1,0). start(1). look(1).": "1,start_and_look",
    f"{ONE} start(1). look(1).": "1,travels",
    f"{ONE} start(a). look(a).": "-1,no_step(a)",
    "slots(4). view(0,0). view(1,0). look(1). length(1,5).": "1,no_way(5)",
    "slots(4). view(0,0). start(0). length(0,5).": "0,starts_already 0,length_at_start",
    "slots(4). view(0,0). turn(2,0). view(2,0). drop(1,a). marker(2,a).": (
        "1,no_turn 1,no_step 2,no_marker"
    ),
    "slots(4). view(0,0). pick(1,a).": "1,no_step",
    "view(0,0). compass(0,a).": "-1,no_slots 0,compass_slot(a)",
    "view(0,0). compass(0,2147483647).": "-1,no_slots",
    f"{ONE} shift(1,a,0). length(1,2147483647).": "1,no_shift(a) 1,long",
    f"{ONE} shift(1,0,a).": "1,no_shift(a)",
    f"{ONE} shift(1,#inf,0).": "1,no_shift(#inf)",
    f"{ONE} shift(1,2147483647,0).": "1,far",
    f"{ONE} shift(1,0,2147483647).": "1,far",
    # The sums are beyond clingo's numbers, and so negative.
    f"{ONE} shift(1,2147483647,21474836).": "1,far",
    f"{ONE} shift(1,-2147483647,21474836).": "1,far",
    f"{ONE} shift(1,21474836,2147483647).": "1,far",
    f"{ONE} shift(1,21474836,-2147483647).": "1,far",
    f"{ONE} turn(2,0). view(2,0). shift(2,21474836,1).": "2,far",
    f"{ONE} turn(2,0). view(2,0). shift(1,2147483647,0). shift(2,1,1).": "1,far",
    f"{ONE} shift(0,21474836,0). shift(1,1,0).": "0,shift_at_start",
    "slots(4). view(0,0). shift(1,1,1).": "1,no_step",
    "slots(4). view(0,0). turn(2,0). view(2,0). shift(1,21474836,0). shift(2,1,0).": (
        "1,no_turn 1,no_step"
    ),
    "slots(2000000000). turn(2147483647,0).": (
        "-1,many_slots(2000000000) 0,no_view 1,no_turn 2147483647,no_view"
    ),
}

# Facts, constants, and the errors that input.lp shows: limits of the numbers that clingo has.
PLAIN = "slots(4). view(0,0)."
WITH_NUMBERS = [
    (PLAIN, "tolerance=-2", "-1,negative_tolerance(-2)"),
    (PLAIN, "tolerance=-1", "-1,negative_tolerance(-1)"),
    (PLAIN, "tolerance=0", ""),
    (PLAIN, "tolerance=3", ""),
    (PLAIN, "drift=-1 stretch=-1", ""),
    *[
        (f"{ONE} {fact}", f"{name}={number}", errors)
        for name, fact in (("drift", "shift(1,1,0)."), ("stretch", "length(1,1)."))
        for number, errors in (
            (-2, f"-1,negative_{name}(-2)"),
            (-1, f"-1,negative_{name}(-1)"),
            (0, ""),
            (1, ""),
            (100, ""),
            (101, ""),
            (102, ""),
            (2147483647, ""),
        )
    ],
    *[
        (f"{ONE} {fact}({terms}).", f"{name}={number}", errors)
        for name, fact, more, error in (
            ("drift", "shift", ",0", "1,far"),
            ("stretch", "length", "", "1,long"),
        )
        for number, most in ((100, 21474836), (101, 21262214), (200, 10737418), (2147483647, 1))
        for far, errors in ((most, ""), (most + 1, error))
        for terms in (f"1,{far}{more}",)
    ],
]
