"""What the shown atoms of models say."""

from collections.abc import Sequence

import clingo

from topomap.model.experience import DState


class Shown:
    """What the shown atoms of many models say.

    Each atom is read once, and then known by its number in clingo: to ask clingo for the parts of
    an atom, or to compare two atoms, takes longer than everything else that is done for a map.
    """

    def __init__(self) -> None:
        self._steps: dict[int, tuple[int, DState]] = {}  # what atoms at/3 say
        self._others: dict[int, tuple[str, list[clingo.Symbol]]] = {}

    def of(
        self, atoms: Sequence[clingo.Symbol]
    ) -> tuple[tuple[DState, ...], list[tuple[str, list[clingo.Symbol]]]]:
        """The dstate after each step, and the name and the terms of each other atom."""
        numbers = [atom._rep for atom in atoms]
        steps, others = self._steps, self._others
        for atom, number in zip(atoms, numbers, strict=True):
            if number in steps or number in others:
                continue
            if atom.name == "at":
                step, place, slot = (term.number for term in atom.arguments)
                steps[number] = step, (place, slot)
            else:
                others[number] = atom.name, atom.arguments
        said = sorted([steps[number] for number in numbers if number in steps])
        rest = [others[number] for number in numbers if number in others]
        return tuple([dstate for _, dstate in said]), rest
