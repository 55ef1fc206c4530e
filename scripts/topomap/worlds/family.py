"""Families of instances: a file that lists what to generate.

A line has the arguments of ``topomap generate``, without ``-o``. ``{3..6}`` and ``{snake,tour}``
stand for each of their values in turn; ``#`` begins a comment.
"""

import itertools
import math
import re
import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path

from topomap.runtime.errors import InputError
from topomap.runtime.files import read_text

MOST = 10**5
_CHOICE = re.compile(r"\{([^{}]*)\}")


def expand(file: str | Path) -> Iterator[tuple[int, list[str]]]:
    """List the generate calls of a family file, each with its line."""
    left = MOST
    for number, line in enumerate(read_text(file).splitlines(), 1):
        pieces = _CHOICE.split(line.partition("#")[0])
        fixed, choices = pieces[::2], [_values(choice) for choice in pieces[1::2]]
        left -= math.prod(map(len, choices))
        if left < 0:
            raise InputError(f"{file}:{number}: more than {MOST} lines, choices multiplied")
        for values in itertools.product(*choices):
            call = "".join(itertools.chain(*zip(fixed, [*map(str, values), ""], strict=True)))
            try:
                arguments = shlex.split(call)
            except ValueError as error:
                raise InputError(f"{file}:{number}: {str(error).lower()}") from None
            if arguments:
                yield number, arguments


def _values(choice: str) -> Sequence[object]:
    bounds = re.fullmatch(r"([0-9]{1,9})\.\.([0-9]{1,9})", choice)
    if bounds:
        return range(int(bounds[1]), int(bounds[2]) + 1)
    return choice.split(",")
