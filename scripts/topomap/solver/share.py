"""Work in units, shared among processes or the workers of a Dask cluster.

The results come in the order of the units, whichever worker has done them.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol, TypeVar

from topomap.runtime.watch import Watch

Unit = TypeVar("Unit")
Result = TypeVar("Result")
Work = Callable[[Unit, Watch | None], Result]  # a function of a module, or a partial of one
AHEAD = 8  # so many units for each worker may be done in advance
LOST = "workers were lost"


class Crew(Protocol):
    """The workers that share the work; used as a context, a crew dismisses them at the end."""

    def each(
        self, work: Work[Unit, Result], units: Sequence[Unit], watch: Watch
    ) -> Iterator[Result]:
        """The result of each unit, in order.

        Raises:
            Stopped: The watch ends the work, or workers are lost again and again.
        """

    def __enter__(self) -> "Crew": ...

    def __exit__(self, *_: object) -> None: ...


class Alone:
    """A crew of this process alone."""

    def each(
        self, work: Work[Unit, Result], units: Sequence[Unit], watch: Watch
    ) -> Iterator[Result]:
        """The result of each unit, in order."""
        return (work(unit, watch) for unit in units)

    def __enter__(self) -> "Alone":
        return self

    def __exit__(self, *_: object) -> None:
        pass


ALONE = Alone()
