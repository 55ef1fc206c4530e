"""The public functions, and the classes of their replies for annotations.

"import topomap" gives the functions. Each name is loaded when it is first used.

The commands use the functions named ``..._under``. These do the same work as the public functions,
under the ``Watch`` of a command, which shows progress and heeds signals.
"""

from typing import TYPE_CHECKING

from topomap.runtime.lazy import loader

if TYPE_CHECKING:
    from topomap.api.ask import StatementAnswer, StatementAnswers
    from topomap.api.count import Counts
    from topomap.api.explain import Explained
    from topomap.api.explore import NextWalk
    from topomap.api.follow import Follower, FollowerStatus
    from topomap.api.parts import Parts
    from topomap.api.simulate import Simulation
    from topomap.api.validate import Validation
    from topomap.documents.verdicts import Judged
    from topomap.model.reply import Reply
    from topomap.questions.candidates import Candidates
    from topomap.questions.proofs import Checked
    from topomap.worlds.environment import Environment
    from topomap.worlds.instance import Instance
    from topomap.worlds.logs import Log

_WHERE = {
    "Candidates": "questions.candidates",
    "Checked": "questions.proofs",
    "Counts": "api.count",
    "Environment": "worlds.environment",
    "Explained": "api.explain",
    "Follower": "api.follow",
    "FollowerStatus": "api.follow",
    "Instance": "worlds.instance",
    "Judged": "documents.verdicts",
    "Log": "worlds.logs",
    "NextWalk": "api.explore",
    "Parts": "api.parts",
    "Reply": "model.reply",
    "Simulation": "api.simulate",
    "StatementAnswer": "api.ask",
    "StatementAnswers": "api.ask",
    "Validation": "api.validate",
}
__all__ = [
    "Candidates",
    "Checked",
    "Counts",
    "Environment",
    "Explained",
    "Follower",
    "FollowerStatus",
    "Instance",
    "Judged",
    "Log",
    "NextWalk",
    "Parts",
    "Reply",
    "Simulation",
    "StatementAnswer",
    "StatementAnswers",
    "Validation",
]
__getattr__ = loader(__name__, _WHERE)


def __dir__() -> list[str]:
    return sorted(__all__)
