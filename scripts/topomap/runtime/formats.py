"""What all JSON that the commands write has in common: the number of its format comes first, and
whether it is whole comes last. Each command's keys are in docs/formats.md."""

import json
from typing import Any

from topomap.runtime.errors import InputError

FORMAT = 1


def headed(data: dict[str, Any]) -> dict[str, Any]:
    """The data, the number of their format first."""
    return {"format": FORMAT, **data}


def ended(fault: str | None) -> dict[str, Any]:
    """What tells whether an answer is whole, and if not, why."""
    return {"complete": fault is None, "fault": fault}


def answer(data: dict[str, Any], fault: str | None = None) -> dict[str, Any]:
    """A whole JSON object: the data between its format and its end."""
    return headed({**data, **ended(fault)})


def line(data: dict[str, Any], fault: str | None = None) -> str:
    """The same as a line of text."""
    return json.dumps(answer(data, fault)) + "\n"


def demand(where: object, data: Any) -> None:
    """Demand that what was read has this format, or names no format, as a file that was written
    by hand may. Raises InputError, one line that begins with ``where``."""
    if isinstance(data, dict) and "format" in data:
        said = data["format"]
        if type(said) is not int or said != FORMAT:
            told = json.dumps(said)
            told = told if len(told) <= 20 else f"{told[:20]}..."
            raise InputError(
                f"{where}: format {told} is not known; this topomap reads format {FORMAT}"
            )
