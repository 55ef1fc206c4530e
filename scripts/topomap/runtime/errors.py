"""Bad input, and messages of one line."""

import contextlib
import sys


class InputError(Exception):
    """Bad input or usage; the message is one line that names file, step and fault."""


def of_file(path: object, error: OSError) -> InputError:
    """What the system says of a file."""
    return InputError(f"{path}: {(error.strerror or str(error)).lower()}")


def printable(text: str) -> str:
    """The text in one line, what a terminal would obey spelt out."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def say(message: str) -> None:
    """A message on stderr: one line, whatever names are in it; lost if it cannot be written."""
    with contextlib.suppress(OSError):
        print(printable(message), file=sys.stderr, flush=True)
