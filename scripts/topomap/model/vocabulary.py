"""What can be asked of maps: the parts of the theory, and what statements are made of.

The module loads nothing, so that help, and the message about a mistyped call, need not wait for the
solver.
"""

from collections.abc import Iterable

PARTS = {
    "planar": "the map is planar: each new link joins two gateways of one face",
    "euler": "the map is planar by Euler's formula: places - links + faces = 2",
    "closed": "no gateway is pending",
    "travelled": "every path has two places or more",
    "boundary": "no place is both left and right of a path, or both on it and beside it",
    "perpendicular": "two paths meet at most once, and no three make a triangle",
    "genus": "maps with the least genus are preferred",
    "exceptions": "maps with the fewest exceptions to consistent boundaries are preferred",
    "minimal": "maps with the fewest paths, then the fewest places, are preferred",
    "no_path_axiom": "a path may contain a place twice, and may be circular",
}
OPTIMIZING = {"genus", "exceptions", "minimal"}
RELAXING = ("no_path_axiom",)  # parts that remove a default
# Properties that, if true of a map, were true after every earlier step.
PRUNING = ("planar", "perpendicular")
CHOSEN = (*PRUNING, *RELAXING)  # the parts that draw, explore and report accept
DEMANDS = tuple(part for part in PARTS if part not in (*OPTIMIZING, *RELAXING))
PROPERTIES = tuple(part for part in DEMANDS if part != "euler")  # euler is another rule for planar
FORMS = ("work", "paper")  # encodings: the efficient one, and the statement of the paper
STATED = {"planar", "closed", "travelled", "boundary", "perpendicular", "minimal"}  # by paper
BEYOND = {  # parts beyond the paper that can be combined with it, and their files
    "exceptions": "beyond/exceptions",
    "no_path_axiom": "../no_path_axiom",
}

# What a statement can say of the whole map: that it meets the demand of a part, that some path
# is circular, or that two paths share two places or more.
QUALITIES = (*PROPERTIES, "circular", "meets_twice")

# The kinds of the arguments: a step, or a slot, counted clockwise from the gateway where the
# agent stood after the step that precedes it.
RELATIONS = {
    "same": ("step", "step"),
    "linked": ("step", "slot", "step", "slot"),
    "path": ("step", "slot", "step", "slot"),
    "pending": ("step", "slot"),
    "at": ("step", "place", "slot"),
}
FIGURES = {  # with their names in query.lp
    "places": "place",
    "paths": "path",
    "links": "link",
    "pending": "pending",
    "genus": "genus",
    "exceptions": "exception",
}
VOCABULARY = """\
statements; T and U are steps; S and R are slots, counted clockwise from the gateway where the
agent stood after the step:
  same(T,U)         the agent was at one place after T and after U
  linked(T,S,U,R)   gateway S of where it was after T is joined to gateway R of
                    where it was after U
  path(T,S,U,R)     one path leads through these two gateways
  pending(T,S)      that gateway has no link
  at(T,P,S)         after T it is at gateway S of place P, as in the maps of solve
  places < 12       the number of places, paths, links, pending gateways (pending) or
                    exceptions to consistent boundaries (exceptions), or the genus, is
                    compared by one of < <= = != >= >
  planar, closed, travelled, boundary, perpendicular
                    the map fulfils what the part of this name demands
  circular          some path is circular, which takes --no-path-axiom
  meets_twice       there are two paths that share two places or more
  not STATEMENT     the statement does not hold"""


def unstated(parts: Iterable[str]) -> list[str]:
    """List those of these parts that ``encodings/paper/`` does not state.

    It states ``perpendicular`` only together with the path axiom.
    """
    asked = {*parts}
    free = {"perpendicular"} & asked if "no_path_axiom" in asked else set()
    return sorted(asked - STATED - BEYOND.keys() | free)
