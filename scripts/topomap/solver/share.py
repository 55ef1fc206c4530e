"""Work in units, shared out among processes or the workers of a Dask cluster: results come in
the order of the units, whoever has done them."""

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol, TypeVar

from topomap.runtime.watch import Watch

Unit = TypeVar("Unit")
Result = TypeVar("Result")
Work = Callable[[Unit, Watch | None], Result]  # a function of a module, or partial of one
AHEAD = 8  # units for each worker that may be done before the one that is next
LOST = "workers were lost"


class Crew(Protocol):
    """Whoever works. As a context it sends its workers home."""

    def each(
        self, work: Work[Unit, Result], units: Sequence[Unit], watch: Watch
    ) -> Iterator[Result]:
        """The result of each unit, in order. Raises Stopped as the watch does, and where
        workers are lost again and again."""

    def __enter__(self) -> "Crew": ...

    def __exit__(self, *_: object) -> None: ...


class Alone:
    """This process does all itself."""

    def each(
        self, work: Work[Unit, Result], units: Sequence[Unit], watch: Watch
    ) -> Iterator[Result]:
        return (work(unit, watch) for unit in units)

    def __enter__(self) -> "Alone":
        return self

    def __exit__(self, *_: object) -> None:
        pass


ALONE = Alone()
