"""Entry point of the command: closed streams, an interrupt while Python still loads, and
an end that nothing changes any more."""

import contextlib
import os
import signal
import sys


def run() -> None:
    status = 130
    try:
        if signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:
            signal.signal(signal.SIGTERM, signal.default_int_handler)
        _open_streams()
        from topomap.cli import main

        status = main()
    except KeyboardInterrupt:
        with contextlib.suppress(OSError):
            print("interrupted", file=sys.stderr, flush=True)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    with contextlib.suppress(OSError):
        sys.stdout.flush()
    # Python would now wait for a clingo that grounds in a thread that nothing can stop, and
    # write once more to streams that cannot be written.
    os._exit(status)


def _open_streams() -> None:
    """A standard stream that was closed is one that cannot be written; names that are no
    text can be."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.open(os.devnull, os.O_RDONLY), "w"))  # noqa: PTH123, SIM115
    sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]


if __name__ == "__main__":
    run()
