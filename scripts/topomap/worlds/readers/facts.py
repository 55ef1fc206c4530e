"""World files that a person writes: ground facts, in the language of clingo.

With ``slots(K)`` and ``link(P,S,Q,R)``, the gateway in slot S of place P leads to place Q, to its
gateway in slot R. Slots are numbered clockwise, and slot 0 is north. These facts may be added:
``name(P,"text")``, ``coordinates(P,X,Y)``, ``landmark(P,L)``, and ``straight(P,S,R)``, which as in
instances names two gateways of a place that are on one path, or with S = R one that ends its path.
If any place has such a fact, then at all places only the gateways of these facts are on one path.
"""

import re
from collections.abc import Mapping
from typing import NoReturn

import clingo

from topomap.model.facts import ground_facts, slots_fault
from topomap.model.terms import cut_short
from topomap.model.topology import Gateway, Place
from topomap.runtime.errors import InputError
from topomap.worlds.plan import Plan, Point, Reading
from topomap.worlds.readers import exact
from topomap.worlds.readers.common import demand_few, name_of, number_of

FORMS = {
    "slots": "slots(K)",
    "link": "link(P,S,Q,R)",
    "name": 'name(P,"text")',
    "coordinates": "coordinates(P,X,Y)",
    "landmark": "landmark(P,L)",
    "straight": "straight(P,S,R)",
}
_FACT = re.compile(rb"(?:^|[.\s])(?:link|slots)\s*\(")
_MARKUP = (b"<", b"{", b"[")


def fits(name: str, content: bytes) -> bool:
    """Tell whether a file has facts, and is neither XML nor JSON."""
    begin = content.removeprefix(b"\xef\xbb\xbf").lstrip()[:1]
    return begin not in _MARKUP and b"\0" not in content and bool(_FACT.search(content))


def read(file: str, content: bytes, reading: Reading) -> Plan:
    """Read the plan in a file of facts.

    Raises:
        InputError: The file has a fault.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{file}: not a text file") from None
    world = _World(file)
    for line, fact in ground_facts(text):
        world.take(line, fact)
    return world.plan()


class _World:
    """The facts of a world file, each with its line."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.slots: tuple[int, int] | None = None  # the number, with the line
        self.links: dict[Gateway, tuple[Gateway, int]] = {}  # in both directions
        self.terms: dict[str, clingo.Symbol] = {}  # the term of each place
        self.names: dict[Place, tuple[str, int]] = {}
        self.points: dict[Place, tuple[Point, int]] = {}
        self.landmarks: dict[Place, dict[str, int]] = {}
        self.straight: dict[Gateway, tuple[Gateway, int]] = {}

    def wrong(self, line: int, said: str) -> NoReturn:
        """The error about what is wrong in a line."""
        raise InputError(f"{self.file}:{line}: {said}")

    def take(self, line: int, fact: clingo.Symbol | str) -> None:
        """Read a fact.

        Raises:
            InputError: It has a fault.
        """
        if isinstance(fact, str):
            self.wrong(line, fact)
        name, told = fact.name, fact.arguments
        form = FORMS.get(name)
        if not fact.positive or form is None or len(told) != form.count(",") + 1:
            known = ", ".join(FORMS.values())
            self.wrong(line, f"{cut_short(str(fact))} is not a fact over {known}")
        getattr(self, f"_{name}")(line, cut_short(str(fact)), told)

    def _slots(self, line: int, fact: str, told: list[clingo.Symbol]) -> None:
        slots = self._whole(line, fact, told[0])
        if fault := slots_fault(slots):
            self.wrong(line, fault)
        if self.slots and self.slots[0] != slots:
            self.wrong(line, f"{fact}: line {self.slots[1]} has slots({self.slots[0]})")
        self.slots = self.slots or (slots, line)

    def _link(self, line: int, fact: str, told: list[clingo.Symbol]) -> None:
        one = self._place(line, fact, told[0]), self._whole(line, fact, told[1])
        other = self._place(line, fact, told[2]), self._whole(line, fact, told[3])
        if one == other:
            self.wrong(line, f"{fact}: it links a gateway to itself")
        for out, end in ((one, other), (other, one)):
            if out in self.links and self.links[out][0] != end:
                known, first = self.links[out]
                there = f"slot {known[1]} of place {known[0]}"
                said = f"gateway {out[1]} of place {out[0]} has two links, also one to {there}"
                self.wrong(line, f"{fact}: {said} (line {first})")
        for out, end in ((one, other), (other, one)):
            self.links.setdefault(out, (end, line))

    def _name(self, line: int, fact: str, told: list[clingo.Symbol]) -> None:
        place = self._place(line, fact, told[0])
        text = told[1].string if told[1].type == clingo.SymbolType.String else str(told[1])
        if self.names.setdefault(place, (text, line))[0] != text:
            self.wrong(line, f"{fact}: the place has another name in line {self.names[place][1]}")

    def _coordinates(self, line: int, fact: str, told: list[clingo.Symbol]) -> None:
        place = self._place(line, fact, told[0])
        numbers = [
            number_of(one.string if one.type == clingo.SymbolType.String else str(one))
            for one in told[1:]
        ]
        if numbers[0] is None or numbers[1] is None:
            said = 'coordinates are whole numbers, or other numbers in quotes, such as "1.5"'
            self.wrong(line, f"{fact}: {said}")
        point = numbers[0], numbers[1]
        if self.points.setdefault(place, (point, line))[0] != point:
            also = f"line {self.points[place][1]}"
            self.wrong(line, f"{fact}: the place has other coordinates in {also}")

    def _landmark(self, line: int, fact: str, told: list[clingo.Symbol]) -> None:
        place = self._place(line, fact, told[0])
        self.landmarks.setdefault(place, {}).setdefault(str(told[1]), line)

    def _straight(self, line: int, fact: str, told: list[clingo.Symbol]) -> None:
        place = self._place(line, fact, told[0])
        one, other = ((place, self._whole(line, fact, slot)) for slot in told[1:])
        for out, end in ((one, other), (other, one)):
            if out in self.straight and self.straight[out][0] != end:
                also = f"line {self.straight[out][1]}"
                self.wrong(line, f"{fact}: gateway {out[1]} is in another pair, too, in {also}")
        self.straight.setdefault(one, (other, line))
        self.straight.setdefault(other, (one, line))

    def _place(self, line: int, fact: str, term: clingo.Symbol) -> str:
        """The name of a place: the text of a string, otherwise the term."""
        text = term.string if term.type == clingo.SymbolType.String else str(term)
        name = name_of(f"{self.file}:{line}", fact, text)
        if self.terms.setdefault(name, term) != term:
            self.wrong(line, f"{fact}: {term} and {self.terms[name]} are two places of one name")
        return name

    def _whole(self, line: int, fact: str, term: clingo.Symbol) -> int:
        if term.type != clingo.SymbolType.Number:
            self.wrong(line, f"{fact}: slots are whole numbers")
        return term.number

    def plan(self) -> Plan:
        """Make the plan of the facts."""
        if self.slots is None:
            raise InputError(f"{self.file}: no fact slots(K), the number of directions at a place")
        slots = self.slots[0]
        for (place, slot), (_, line) in sorted(self.links.items(), key=lambda one: one[1][1]):
            if not 0 <= slot < slots:
                self.wrong(line, f"slot {slot} of place {place} is not in 0..{slots - 1}")
        linked = {place for place, _ in self.links}
        demand_few(self.file, len(linked))
        lines: Mapping[Place, int]
        for lines in (
            {place: line for place, (_, line) in self.names.items()},
            {place: line for place, (_, line) in self.points.items()},
            {place: min(of.values()) for place, of in self.landmarks.items()},
        ):
            for place, line in lines.items():
                if place not in linked:
                    self.wrong(line, f"place {place} has no link")
        for (place, slot), (_, line) in self.straight.items():
            if (place, slot) not in self.links:
                self.wrong(line, f"straight: gateway {slot} of place {place} has no link")
        whole = all(term.type == clingo.SymbolType.Number for term in self.terms.values())
        called = {name: term.number if whole else name for name, term in self.terms.items()}

        def out(gateway: Gateway) -> Gateway:
            """The exit of a gateway."""
            return called[gateway[0]], gateway[1]

        links = [
            exact.Link(out(one), out(other), self._move(one[0], other[0]))
            for one, (other, _) in self.links.items()
            if one < other
        ]
        pairs = [(one, other) for one, (other, _) in self.straight.items() if one < other]
        return exact.plan(
            self.file,
            slots,
            0.0,
            links,
            [(out(one), out(other)) for one, other in pairs] if self.straight else None,
            points={called[place]: point for place, (point, _) in self.points.items()},
            landmarks={called[place]: frozenset(of) for place, of in self.landmarks.items()},
            names={called[place]: name for place, (name, _) in self.names.items()},
        )

    def _move(self, one: Place, other: Place) -> Point | None:
        if not {one, other} <= self.points.keys():
            return None
        (x, y), (to_x, to_y) = self.points[one][0], self.points[other][0]
        return to_x - x, to_y - y
