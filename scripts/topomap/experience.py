"""Experiences: what an exploration does and sees, and the instance files that hold it.

An instance file is data: ground facts ``slots/1``, ``view/2``, ``turn/2``, ``landmark/2``,
``drop/1``, ``pick/1`` and ``marker/1`` (see ``encodings/topomap.lp``), and comments. Anything
else is refused.
"""

import re
from collections import defaultdict
from collections.abc import Container, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import clingo

from topomap import files
from topomap.errors import InputError
from topomap.topology import Gateway, Place, TopologicalMap

DState = tuple[int, int]
Misread = tuple[int, int | str]  # a step, and a gateway or a landmark that was missed or imagined
MOST_SLOTS = 10**6  # sums of slots then stay below it
DEEPEST = 100  # clingo's parser crashes on terms that are very deep
ARITY = {"slots": 1, "view": 2, "turn": 2, "landmark": 2, "drop": 1, "pick": 1, "marker": 1}
MARKER = ("drop", "pick", "marker")
HINT = " (misread? solve --noise allows for that)"


@dataclass(frozen=True)
class Experience:
    """An exploration of ``len(turns)`` steps (semantics: "Experience").

    ``views[t]`` and ``landmarks[t]``, t = 0..n, are what is seen after step t: slots
    clockwise from the gateway stood at, and landmarks as terms; ``turns[t - 1]`` is
    the turn of step t, in slots clockwise. ``drops``, ``picks`` and ``markers`` are the steps
    after which the marker is put down, taken up and seen.
    """

    slots: int
    views: tuple[frozenset[int], ...]
    turns: tuple[int, ...]
    landmarks: tuple[frozenset[str], ...]
    drops: frozenset[int] = frozenset()
    picks: frozenset[int] = frozenset()
    markers: frozenset[int] = frozenset()

    @property
    def steps(self) -> int:
        return len(self.turns)

    def cut(self, horizon: int) -> "Experience":
        """The experience up to and including step ``horizon``."""
        return Experience(
            self.slots,
            self.views[: horizon + 1],
            self.turns[:horizon],
            self.landmarks[: horizon + 1],
            *(
                frozenset(step for step in steps if step <= horizon)
                for steps in (self.drops, self.picks, self.markers)
            ),
        )

    def marker(self) -> tuple[tuple[int, bool] | None, ...]:
        """Of each step, if the marker lies somewhere when it ends: after which step it was put
        down, and whether it is seen. (Who takes it up sees it; taking up comes before putting
        down.)"""
        told: list[tuple[int, bool] | None] = []
        down = None
        for step in range(self.steps + 1):
            seen = step in self.markers or step in self.picks
            told.append(None if down is None else (down, seen))
            down = None if step in self.picks else down
            down = step if step in self.drops else down
        return tuple(told)

    def corrected(self, misread: Iterable[Misread]) -> "Experience":
        """The experience with the other of what was misread: seen what was missed, and not what
        was imagined."""
        views, landmarks = list(self.views), list(self.landmarks)
        for step, what in misread:
            if isinstance(what, int):
                views[step] ^= {what}
            else:
                landmarks[step] ^= {what}
        return replace(self, views=tuple(views), landmarks=tuple(landmarks))

    def misled(self) -> list[int]:
        """The steps after which the agent stands at no gateway, or leaves by none, by what it
        sees there."""
        needs = [{0, turn} for turn in self.turns] + [{0}]
        return [step for step, need in enumerate(needs) if not need <= self.views[step]]

    def facts(self) -> str:
        """The experience as facts, one line a step."""
        lines = [f"slots({self.slots})."]
        for step, (view, landmarks) in enumerate(zip(self.views, self.landmarks, strict=True)):
            line = [f"turn({step},{self.turns[step - 1]})."] if step else []
            line += [f"view({step},{slot})." for slot in sorted(view)]
            line += [f"landmark({step},{term})." for term in sorted(landmarks)]
            line += [f"marker({step})."] * (step in self.markers)
            line += [f"pick({step})."] * (step in self.picks)
            line += [f"drop({step})."] * (step in self.drops)
            lines.append(" ".join(line))
        return "\n".join(lines) + "\n"

    def map_of(self, at: tuple[DState, ...]) -> TopologicalMap:
        """The map of a hypothesis, given the dstate after each step (``at/3``)."""
        stars = {place: self.views[place] for place, _ in at}
        links: dict[Gateway, Gateway] = {}
        for turn, (place, slot), arrival in zip(self.turns, at, at[1:], strict=False):
            out = place, (slot + turn) % self.slots
            links[out], links[arrival] = arrival, out
        landmarks = {place: self.landmarks[place] for place in stars}
        return TopologicalMap(self.slots, stars, links, landmarks)


def explore(
    world: TopologicalMap,
    start: Gateway,
    route: Iterable[int],
    drops: Iterable[int] = (),
    picks: Iterable[int] = (),
) -> tuple[Experience, tuple[DState, ...]]:
    """What is seen from ``start`` (the gateway stood at) along ``route``, the absolute
    slots by which places are left; and the true hypothesis, as ``at/3`` would name it.

    The marker is put down after those of the steps ``drops`` when it is in hand, and taken up
    after those of ``picks`` when it is seen."""
    dstates = [start]
    turns = []
    for slot in route:
        place, stood_at = dstates[-1]
        turns.append((slot - stood_at) % world.slots)
        dstates.append(world.links[place, slot])
    first: dict[Place, tuple[int, int]] = {}
    for step, (place, slot) in enumerate(dstates):
        first.setdefault(place, (step, slot))
    truth = [(first[place][0], (slot - first[place][1]) % world.slots) for place, slot in dstates]
    views = tuple(world.view(dstate) for dstate in dstates)
    landmarks = tuple(world.landmarks.get(place, frozenset()) for place, _ in dstates)
    marker = _marker(dstates, {*drops}, {*picks})
    return Experience(world.slots, views, tuple(turns), landmarks, *marker), tuple(truth)


def _marker(
    dstates: Iterable[Gateway], drops: Container[int], picks: Container[int]
) -> list[frozenset[int]]:
    """The steps after which the marker is put down, taken up and seen."""
    put: set[int] = set()
    taken: set[int] = set()
    seen: set[int] = set()
    lies: list[Place] = []  # where
    for step, (place, _) in enumerate(dstates):
        if place in lies:
            seen.add(step)
            if step in picks:
                taken.add(step)
                lies.clear()
        if not lies and step in drops:
            put.add(step)
            lies.append(place)
    return [frozenset(put), frozenset(taken), frozenset(seen)]


def read(path: str | Path, noisy: bool = False) -> Experience:
    """The experience in an instance file; a ``noisy`` one may turn to gateways that were not
    seen, and views may lack slot 0. Raises InputError, one line, on bad input."""
    return parse(files.text(path), str(path), noisy)


def parse(text: str, source: str, noisy: bool = False) -> Experience:
    """The experience in the text of an instance; ``source`` names it in errors."""
    if text.lstrip()[:1] in ("{", "["):
        raise InputError(f"{source}: the facts of an instance are wanted, not JSON or a rule")
    slots: set[int] = set()
    views: dict[int, set[int]] = defaultdict(set)
    turns: dict[int, set[int]] = defaultdict(set)
    landmarks: dict[int, set[str]] = defaultdict(set)
    marker: dict[str, set[int]] = {name: set() for name in MARKER}
    for line, fact in ground_facts(text, source):
        name, arguments = fact.name, fact.arguments
        if not fact.positive or ARITY.get(name) != len(arguments):
            known = ", ".join(f"{known}/{arity}" for known, arity in ARITY.items())
            raise InputError(f"{source}:{line}: {cut_short(str(fact))} is not a fact over {known}")
        numbers = arguments[:1] if name == "landmark" else arguments
        if any(argument.type != clingo.SymbolType.Number for argument in numbers):
            raise InputError(
                f"{source}:{line}: {cut_short(str(fact))}: a step or a slot is a whole number"
            )
        if name == "slots":
            slots.add(arguments[0].number)
        elif name in MARKER:
            marker[name].add(arguments[0].number)
        elif name == "landmark":
            landmarks[arguments[0].number].add(str(arguments[1]))
        else:
            (views if name == "view" else turns)[arguments[0].number].add(arguments[1].number)
    return _checked(source, slots, views, turns, landmarks, marker, noisy)


def _checked(
    source: str,
    slots: set[int],
    views: dict[int, set[int]],
    turns: dict[int, set[int]],
    landmarks: dict[int, set[str]],
    marker: dict[str, set[int]],
    noisy: bool,
) -> Experience:
    """The experience, if the facts make one."""
    drops, picks, markers = (marker[name] for name in MARKER)
    if not slots and not views and not turns:
        raise InputError(f"{source}: no facts in it")
    if len(slots) != 1:
        raise InputError(f"{source}: {len(slots) or 'no'} facts slots(K); there must be one")
    (number,) = slots
    if number < 2 or number % 2 or number > MOST_SLOTS:
        raise InputError(f"{source}: slots({number}): K must be even, from 2 to {MOST_SLOTS}")
    last = max([0, *turns])
    for step in sorted({*views, *turns, *landmarks, *drops, *picks, *markers}):
        if step < 0:
            raise InputError(f"{source}: step {step}: steps are numbered from 0")
        if step > last:
            raise InputError(f"{source}: step {step}: it has no turn (the last one is {last})")
    out = False  # the marker
    for step in range(last + 1):
        if step and step not in turns:
            raise InputError(f"{source}: step {step}: no turn, but there are later steps")
        if step in turns and step == 0:
            raise InputError(f"{source}: step 0: a turn; steps with a turn begin at 1")
        if len(turns.get(step, ())) > 1:
            raise InputError(f"{source}: step {step}: more than one turn")
        if step not in views and not noisy:
            raise InputError(f"{source}: step {step}: no view{HINT}")
        for slot in [*views[step], *turns.get(step, ())]:
            if not 0 <= slot < number:
                raise InputError(f"{source}: step {step}: slot {slot} is not in 0..{number - 1}")
        if 0 not in views[step] and not noisy:
            fault = "the view lacks slot 0, the gateway stood at"
            raise InputError(f"{source}: step {step}: {fault}{HINT}")
        for turn in turns.get(step, ()):
            if turn not in views[step - 1] and not noisy:
                fault = f"turn {turn}: no gateway there after step {step - 1}"
                raise InputError(f"{source}: step {step}: {fault}{HINT}")
        marks = {name for name in MARKER if step in marker[name]}
        if wrong := marker_fault(marks, out):
            raise InputError(f"{source}: step {step}: {wrong}")
        out = marker_out(marks, out)
    return Experience(
        number,
        tuple(frozenset(views[step]) for step in range(last + 1)),
        tuple(next(iter(turns[step])) for step in range(1, last + 1)),
        tuple(frozenset(landmarks.get(step, ())) for step in range(last + 1)),
        frozenset(drops),
        frozenset(picks),
        frozenset(markers),
    )


def marker_fault(marks: Container[str], out: bool) -> str | None:
    """What cannot be of what is done with the marker after a step; ``out`` tells whether it lies
    somewhere before that."""
    if "pick" in marks and not out:
        return "the marker is taken up, but lies nowhere"
    if "drop" in marks and out and "pick" not in marks:
        return "the marker is put down, but is out already"
    if "marker" in marks and not out and "drop" not in marks:
        return "the marker is seen, but lies nowhere"
    return None


def marker_out(marks: Container[str], out: bool) -> bool:
    """Whether the marker lies somewhere after that."""
    return "drop" in marks or (out and "pick" not in marks)


# Outside a block comment: its beginning, a line comment, the two stops of an interval, a
# string, a full stop, or other text. Block comments are nested.
_STRING = r'"(?:[^"\\\n]++|\\.)*+"'
_TOKEN = re.compile(rf'%\*|%[^\n]*|\.\.|{_STRING}|\.|[^%".]+|"', re.DOTALL)
_COMMENT = re.compile(r"%\*|\*%|[^%*]+|[%*]", re.DOTALL)
_FACT = re.compile(r"-?[a-z]\w*\(.*\)", re.DOTALL)
_SPACE = re.compile(rf"({_STRING})|\s+", re.DOTALL)
_BRACKET = re.compile(rf"{_STRING}|[(|)]", re.DOTALL)


def ground_facts(text: str, source: str, line: int = 1) -> Iterator[tuple[int, clingo.Symbol]]:
    """The ground facts of a text, each with the line it begins in; the first line is ``line``."""
    fact: list[str] = []
    begins = line
    position = depth = 0
    while match := (_COMMENT if depth else _TOKEN).match(text, position):
        token, position = match[0], match.end()
        if token == "%*":
            depth += 1
        elif depth:
            depth -= token == "*%"
        elif token == ".":
            yield begins, _fact("".join(fact).strip(), source, begins)
            fact = []
        elif not token.startswith("%") and (fact or token.strip()):
            if not fact:
                begins = line + token[: -len(token.lstrip())].count("\n")
            fact.append(token)
        line += token.count("\n")
    if fact or depth:
        rest = _short("".join(fact)) if fact else "a comment"
        raise InputError(f"{source}:{begins}: {rest} does not end")


def _fact(text: str, source: str, line: int) -> clingo.Symbol:
    refused = InputError(f"{source}:{line}: {_short(text)} is not a ground fact")
    if not _FACT.fullmatch(text):
        raise refused
    if len(text) > DEEPEST and _depth(text) > DEEPEST:
        raise InputError(f"{source}:{line}: {_short(text)} is nested deeper than {DEEPEST}")
    try:
        symbol = clingo.parse_term(text, logger=lambda *_: None)
    except (RuntimeError, UnicodeDecodeError):  # clingo's message may cut a letter in two
        raise refused from None
    # clingo computes, and wraps numbers that are too large, without a word.
    if str(symbol) != _SPACE.sub(r"\1", text):
        has = cut_short(str(symbol))
        raise InputError(f"{source}:{line}: {_short(text)} is no plain fact, clingo has {has}")
    return symbol


def _depth(text: str) -> int:
    """How deep the brackets of a text are nested, or more."""
    depth = deepest = 0
    for bracket in _BRACKET.findall(text):
        depth += (bracket in "(|") - (bracket == ")")
        deepest = max(deepest, depth)
    return deepest


def _short(text: str) -> str:
    return repr(cut_short(text))


def cut_short(text: str) -> str:
    """A text in one line for a message."""
    line = " ".join(text[:1000].split())
    return line if len(line) <= 40 else line[:37] + "..."
