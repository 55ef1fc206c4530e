"""What ends a command, and the exit status it ends with."""

DONE, NO, BAD_INPUT, PARTIAL, INTERRUPTED = 0, 1, 2, 3, 130


class InputError(Exception):
    """Bad input or usage; the message is one line that names file, step and fault."""
