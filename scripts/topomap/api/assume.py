"""Taking statements about an experience for granted."""

from topomap.api.parts import demand_experience, demand_text
from topomap.model.experience import Experience
from topomap.questions.statements import parse_statement
from topomap.runtime.errors import InputError


def assume(experience: Experience, *statement: str) -> Experience:
    """Take statements about an experience for granted.

    Only the maps in which the statements hold are consistent with the experience that is returned.
    The statements ``same(T,U)`` and ``not same(T,U)`` are added to what is known, like the facts
    ``same/2`` and ``apart/2`` of an instance file; clingo gets the others as demands. (The paper,
    section II, has the maps; assumptions are not in it.)

    Parameters:
        experience: What the agent saw and did.
        statement: The statements, such as ``same(3,12)``, ``places < 12`` or ``not planar``;
            ``topomap ask --help`` lists what can be said.

    Returns:
        The experience with the assumptions, for ``solve``, ``ask``, ``explain``, ``explore`` and
        other functions.

    Raises:
        TypeError: ``experience`` is not an Experience, or a statement is not a text.
        InputError: A text is not a statement about this experience. The message is one line.
    """
    demand_experience(experience)
    for text in statement:
        demand_text("statement", text, "same(3,12)")
    return assumed("assume", experience, statement)


def assumed(command: str, experience: Experience, statement: "tuple[str, ...]") -> Experience:
    """Take statements for granted as ``assume`` does; errors name the command."""
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
