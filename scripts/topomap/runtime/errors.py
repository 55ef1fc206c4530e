"""Bad input, and messages of one line."""

import contextlib
import sys


class InputError(Exception):
    """Bad input or bad usage; the message is one line that names file, step and fault."""


def of_file(path: object, error: OSError) -> InputError:
    """Convert an OSError to an InputError that names the file."""
    return InputError(f"{path}: {(error.strerror or str(error)).lower()}")


def printable(text: str) -> str:
    """Spell the text in one line, with escapes in place of characters that control a terminal."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def say(message: str) -> None:
    """Print a message of one line on stderr; it is lost if it cannot be written."""
    with contextlib.suppress(OSError):
        print(printable(message), file=sys.stderr, flush=True)
