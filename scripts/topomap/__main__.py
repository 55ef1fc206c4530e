"""The entry point of the command.

It handles closed streams, an interrupt while Python is still loading, and an end of the process
that nothing changes any more.
"""

import contextlib
import os
import signal
import sys


def run() -> None:
    """Run the command with the arguments of this process, and end the process."""
    if sys.argv[1:2] == ["clingo"]:  # clingo handles signals and streams itself
        from topomap.cli.clingo import run as clingo

        signal.signal(signal.SIGINT, signal.SIG_DFL)
        sys.exit(clingo(sys.argv[2:]))
    both = signal.SIGINT, signal.SIGTERM
    heeded = [number for number in both if signal.getsignal(number) != signal.SIG_IGN]
    for number in heeded:
        signal.signal(number, _stop)
    _open_streams()
    sys.unraisablehook = _note
    # Without this, OpenBLAS (for numpy) may wait for ever for memory. One thread is enough.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from topomap.cli import main

    try:
        for number in heeded:
            signal.signal(number, signal.default_int_handler)
        status = main()
    except KeyboardInterrupt:
        _stop()
    for number in (*both, signal.SIGALRM):
        signal.signal(number, signal.SIG_IGN)
    with contextlib.suppress(OSError):
        sys.stdout.flush()
    # Python would now wait for a clingo that grounds in a thread that nothing can stop, and
    # write once more to streams that cannot be written.
    os._exit(status)


def _stop(*_: object) -> None:
    """End the process at once, because an exception during an import may become another one."""
    with contextlib.suppress(OSError):
        os.write(2, b"interrupted\n")
    os._exit(130)


def _note(ignored: "sys.UnraisableHookArgs") -> None:
    """Handle an exception that Python can only report.

    If memory is short, a generator cannot even be closed; the answer reports that once. An
    interrupt that came where no exception can be raised is sent again a moment later.
    """
    if issubclass(ignored.exc_type, KeyboardInterrupt):
        signal.signal(signal.SIGALRM, signal.default_int_handler)
        signal.setitimer(signal.ITIMER_REAL, 0.01)
    elif not issubclass(ignored.exc_type, MemoryError):
        sys.__unraisablehook__(ignored)


def _open_streams() -> None:
    """Make the standard streams usable.

    A standard stream that was closed is replaced by one that cannot be written. Characters that the
    encoding lacks are written as escapes, so that names of files that are not valid text can be
    printed.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.open(os.devnull, os.O_RDONLY), "w"))  # noqa: PTH123, SIM115
    sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]


if __name__ == "__main__":
    run()
