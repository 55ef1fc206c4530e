"""Where the texts beside a place go."""

import math
from collections.abc import Sequence
from itertools import pairwise


def gaps(directions: Sequence[float]) -> list[tuple[float, float]]:
    """The gaps between directions, in radians: the width of each, and its middle.

    Of gaps of one width, those up and to the right come first, where a text is looked for.
    """
    order = sorted(directions) or [-2.4]
    pairs = pairwise([*order, order[0] + 2 * math.pi])
    found = [(round(b - a, 1), (a + b) / 2) for a, b in pairs]
    return sorted(found, key=lambda gap: (-gap[0], round(-math.cos(gap[1] - 0.9), 3)))
