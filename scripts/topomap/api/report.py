"""The page about explorations."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.page.chapter import Chapter, given_maps
from topomap.page.report import Asked, page
from topomap.runtime.limits import LARGEST
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import Watch


@dataclass(frozen=True)
class Page:
    """A page with one chapter for each exploration."""

    asked: Asked
    chapters: list[Chapter]

    def html(self) -> str:
        """The page, as the text of a file."""
        return page(self.asked, self.chapters)

    @property
    def faults(self) -> list[tuple[str, str]]:
        """What the page lacks and why, each with the name of the exploration."""
        return [(one.name, fault) for one in self.chapters for fault in one.faults]

    @property
    def fault(self) -> str | None:
        """Why the page is not whole; None if it is."""
        told = [fault for _, fault in self.faults]
        return (
            INTERRUPT if any(one.endswith(INTERRUPT) for one in told) else "; ".join(told) or None
        )

    @property
    def has_maps(self) -> bool:
        """Whether each exploration has a map."""
        return all(one.best for one in self.chapters)


def report_under(
    watch: Watch,
    seen: Sequence[tuple[str, Experience]],
    query: Query,
    most: int,
    seconds: float,
    maps_from: str | None = None,
    known: Sequence[str] = (),
) -> Page:
    """Make the page about explorations under the watch of a command.

    ``seen`` holds the explorations, each with its name, and ``seconds`` is the time for all of
    them. At most ``most`` of the best maps of each are drawn; or those in the file ``maps_from``,
    which is allowed for one exploration only. ``known`` holds the options that state more about
    the explorations than their files do.

    Raises:
        InputError: The file of maps cannot be read. One line.
    """
    given = None if maps_from is None else given_maps(maps_from, *seen[0], query)
    end = time.monotonic() + seconds
    chapters = []
    for nth, (name, whole) in enumerate(seen):
        share = (end - time.monotonic()) / (len(seen) - nth)
        cut = whole.cut(LARGEST if query.horizon is None else query.horizon)
        chapter = Chapter(name, cut, replace(query, horizon=None), most, watch, given)
        chapter.look(max(0.0, share))
        chapters.append(chapter)
    asked = Asked([name for name, _ in seen], query, most, seconds, maps_from, known)
    return Page(asked, chapters)
