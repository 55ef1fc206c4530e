"""Taking statements about an experience for granted."""

from topomap.api.parts import demand_experience, demand_text
from topomap.model.experience import Experience
from topomap.questions.statements import parse_statement
from topomap.runtime.errors import InputError


def assume(experience: Experience, *statement: str) -> Experience:
    """The same experience, of which statements are taken for granted: only the maps in which they
    hold are consistent with it. (``same(T,U)`` and ``not same(T,U)`` become part of what is known,
    as the facts ``same/2`` and ``apart/2`` of an instance file; the others are put to clingo.)

    Parameters:
        experience: what was seen and done.
        statement: such as ``same(3,12)``, ``places < 12``, ``not planar``; what can be said is in
            ``topomap ask --help``.

    Returns:
        The experience, for ``solve``, ``ask``, ``explain``, ``explore`` and the like.

    Raises:
        TypeError: no experience, or a statement that is no text.
        InputError: a text that is no statement about this experience; one line.
    """
    demand_experience(experience)
    for text in statement:
        demand_text("statement", text, "same(3,12)")
    return assumed("assume", experience, statement)


def assumed(command: str, experience: Experience, statement: "tuple[str, ...]") -> Experience:
    """The same for a command, which an error names."""
    for text in statement:
        said = parse_statement(text, experience, command)
        name, _, numbers = said.term.rstrip(")").partition("(")
        if name == "same":
            one, other = map(int, numbers.split(","))
            if one != other:
                pair = [(one, other)]
                known = {"same": pair} if said.positive else {"apart": pair}
                experience = experience.knowing(**known)
            elif not said.positive:
                raise InputError(f'{command}: "{said.text}": a visit is of one place with itself')
            continue
        experience = experience.granted(said.term, said.positive)
    return experience
