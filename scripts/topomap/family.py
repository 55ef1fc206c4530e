"""Families of instances: a file that lists what to generate.

A line is the arguments of ``topomap generate``, without ``-o``; ``{3..6}`` and
``{snake,tour}`` stand for each value in turn; ``#`` begins a comment.
"""

import itertools
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

from topomap.errors import InputError

_CHOICE = re.compile(r"\{([^{}]*)\}")


def expand(file: str | Path) -> Iterator[tuple[int, list[str]]]:
    """The generate calls of a family file, each with its line."""
    try:
        lines = Path(file).read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise InputError(f"{file}: {(error.strerror or str(error)).lower()}") from None
    except ValueError:
        raise InputError(f"{file}: not a text file") from None
    for number, line in enumerate(lines, 1):
        pieces = _CHOICE.split(line.partition("#")[0])
        fixed, choices = pieces[::2], [_values(choice) for choice in pieces[1::2]]
        for values in itertools.product(*choices):
            call = "".join(itertools.chain(*zip(fixed, [*values, ""], strict=True)))
            try:
                arguments = shlex.split(call)
            except ValueError as error:
                raise InputError(f"{file}:{number}: {str(error).lower()}") from None
            if arguments:
                yield number, arguments


def _values(choice: str) -> list[str]:
    bounds = re.fullmatch(r"(\d+)\.\.(\d+)", choice)
    if bounds:
        first, last = map(int, bounds.groups())
        return [str(value) for value in range(first, last + 1)]
    return choice.split(",")
