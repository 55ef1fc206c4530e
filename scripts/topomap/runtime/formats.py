"""What all JSON that the commands write has in common.

The number of its format comes first, and whether the answer is whole comes last. docs/formats.md
explains the keys of each command.
"""

import json
from typing import Any

from topomap.runtime.errors import InputError

FORMAT = 1


def headed(data: dict[str, Any]) -> dict[str, Any]:
    """Put the number of the format before the data."""
    return {"format": FORMAT, **data}


def ended(fault: str | None) -> dict[str, Any]:
    """Tell whether an answer is whole, and if it is not, why."""
    return {"complete": fault is None, "fault": fault}


def answer(data: dict[str, Any], fault: str | None = None) -> dict[str, Any]:
    """Make a whole JSON object: the number of the format, the data, and whether it is whole."""
    return headed({**data, **ended(fault)})


def line(data: dict[str, Any], fault: str | None = None) -> str:
    """Make a whole JSON object, as a line of text."""
    return json.dumps(answer(data, fault)) + "\n"


def demand(where: object, data: Any) -> None:
    """Check that what was read has this format.

    A file that was written by hand may name no format.

    Raises:
        InputError: It has another format; one line that begins with ``where``.
    """
    if isinstance(data, dict) and "format" in data:
        said = data["format"]
        if type(said) is not int or said != FORMAT:
            told = json.dumps(said)
            told = told if len(told) <= 20 else f"{told[:20]}..."
            raise InputError(
                f"{where}: format {told} is not known; this topomap reads format {FORMAT}"
            )
