"""Exit statuses."""

DONE, NO, BAD_INPUT, PARTIAL, INTERRUPTED = 0, 1, 2, 3, 130
INTERRUPT = "interrupted"  # the fault of an answer that a signal cut


def exit_status(fault: str | None, yes: bool) -> int:
    """The exit status of an answer: partial, for that reason, or else yes or no."""
    if fault:
        return INTERRUPTED if fault == INTERRUPT else PARTIAL
    return DONE if yes else NO
