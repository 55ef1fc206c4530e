"""topomap: exact topological map-building in answer set programming.

    import topomap

    seen = topomap.read("grid-3x3-snake.lp")
    answer = topomap.solve(seen, planar=True, optimal=True, timeout=60)
    answer[0].draw("map.svg")

The functions and classes below are the public ones; each is loaded when it is first used. What
is in the packages beside them may change without notice: docs/DEVELOPMENT.md walks through them.
"""

from typing import TYPE_CHECKING

from topomap.runtime.lazy import loader
from topomap.runtime.version import VERSION as __version__

if TYPE_CHECKING:
    from topomap.api.answer import Answer
    from topomap.api.ask import ask
    from topomap.api.assume import assume
    from topomap.api.check import check
    from topomap.api.count import count
    from topomap.api.explain import explain
    from topomap.api.explore import explore
    from topomap.api.follow import follow
    from topomap.api.generate import generate
    from topomap.api.log import read_log
    from topomap.api.maps import Map
    from topomap.api.read import read
    from topomap.api.simulate import simulate
    from topomap.api.solve import solve
    from topomap.api.validate import validate
    from topomap.api.world import world, write_world
    from topomap.model.experience import Experience
    from topomap.runtime.errors import InputError

_WHERE = {
    "Answer": "api.answer",
    "Experience": "model.experience",
    "InputError": "runtime.errors",
    "Map": "api.maps",
    "ask": "api.ask",
    "assume": "api.assume",
    "check": "api.check",
    "count": "api.count",
    "explain": "api.explain",
    "explore": "api.explore",
    "follow": "api.follow",
    "generate": "api.generate",
    "read": "api.read",
    "read_log": "api.log",
    "simulate": "api.simulate",
    "solve": "api.solve",
    "validate": "api.validate",
    "world": "api.world",
    "write_world": "api.world",
}
__all__ = [
    "Answer",
    "Experience",
    "InputError",
    "Map",
    "__version__",
    "ask",
    "assume",
    "check",
    "count",
    "explain",
    "explore",
    "follow",
    "generate",
    "read",
    "read_log",
    "simulate",
    "solve",
    "validate",
    "world",
    "write_world",
]

if not TYPE_CHECKING:  # a checker of types would take any name for one of these
    __getattr__ = loader(__name__, _WHERE)


def __dir__() -> list[str]:
    return sorted(__all__)
