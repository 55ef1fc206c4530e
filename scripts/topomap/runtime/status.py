"""Exit statuses."""

DONE, NO, BAD_INPUT, PARTIAL, INTERRUPTED = 0, 1, 2, 3, 130
INTERRUPT = "interrupted"  # the fault of an answer that a signal cut short


def exit_status(fault: str | None, yes: bool) -> int:
    """Give the exit status of an answer: partial if there is a fault, otherwise yes or no."""
    if fault:
        return INTERRUPTED if fault == INTERRUPT else PARTIAL
    return DONE if yes else NO
