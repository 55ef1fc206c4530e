"""What is known besides views: whether two visits, or two steps, agree with it.

It covers the compass, odometry, lengths, and visits that are known to be of one place or of two. It
is written from the definitions (semantics: "Beyond the paper"), not from the encodings.
"""

from collections import defaultdict

from topomap.model.experience import Experience

# The rules that can refuse an arrival, apart from views.
RULES = ("compass", "odometry", "apart", "same", "length")


class Evidence:
    """What an experience tells besides views.

    The ``compass`` can be left out if it is taken into account elsewhere.
    """

    def __init__(self, experience: Experience, compass: bool = True):
        self.slots, self.drift, self.stretch = (
            experience.slots,
            experience.drift,
            experience.stretch,
        )
        self.lengths = (None, *experience.lengths) if experience.lengths else ()
        self._compass = experience.compass if compass else ()
        self._tolerance = experience.tolerance
        # For each visit: where the unbroken sequence of shifts began that ends there, the position
        # by these shifts, and the length of the way.
        self._track: list[tuple[int, int, int, int]] = []
        begun = x = y = way = 0
        for step, shift in enumerate((None, *experience.shifts) if experience.shifts else ()):
            if shift is None and step in experience.looks:
                shift = 0, 0
            if shift is None or step in experience.starts:
                begun, x, y, way = step, 0, 0, 0
            else:
                x, y, way = x + shift[0], y + shift[1], way + abs(shift[0]) + abs(shift[1])
            self._track.append((begun, x, y, way))
        self._apart = experience.apart
        # For each visit, the earlier ones that are known to be of its place.
        self.same: dict[int, list[int]] = defaultdict(list)
        for one, other in experience.same:
            if one != other:
                self.same[other].append(one)
        told = self.lengths or self._compass or self._track or self._apart or self.same
        self._told = bool(told)

    def __bool__(self) -> bool:
        """Whether anything else is known."""
        return self._told

    def refuses(self, one: int, other: int, turn: int) -> str | None:
        """The first of ``RULES`` by which two visits are not of one place, or None.

        ``one`` is the earlier visit. The later one stands so many slots clockwise from it.
        """
        if self._compass:
            before, after = self._compass[one], self._compass[other]
            if before is not None and after is not None:
                off = (before + turn - after) % self.slots
                if min(off, self.slots - off) > self._tolerance:
                    return "compass"
        if self._track:
            begun, x, y, way = self._track[one]
            since, u, v, more = self._track[other]
            if begun == since and 100 * max(abs(x - u), abs(y - v)) > self.drift * (more - way):
                return "odometry"
        return "apart" if (one, other) in self._apart else None

    def unequal(self, step: int, other: int) -> bool:
        """Tell whether the lengths of two steps differ too much for one link."""
        if not self.lengths:
            return False
        one, two = self.lengths[step], self.lengths[other]
        if one is None or two is None:
            return False
        return 100 * abs(one - two) > self.stretch * max(one, two)
