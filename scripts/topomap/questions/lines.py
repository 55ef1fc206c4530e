"""Lines as they arrive: from standard input, from a file that grows, and from a log."""

import contextlib
import fcntl
import os
import select
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from topomap.runtime.errors import InputError, of_file, say

LONGEST = 2**20  # the largest number of bytes of a line
PAUSE = 0.1  # seconds between two looks at a file


class Log:
    """A file with the lines that were accepted.

    Raises:
        InputError: The file cannot be opened.
    """

    def __init__(self, path: str):
        self.path = path
        self._file: int | None = None

    def open(self, make: bool) -> None:
        """Open the file for this process alone; it is made when there is something to write."""
        flags = os.O_RDWR | os.O_APPEND | (os.O_CREAT if make else 0)
        try:
            self._file = os.open(self.path, flags, 0o666)
            if not Path(self.path).is_file():
                raise InputError(f"{self.path}: not a regular file")
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(f"{self.path}: another topomap follow is writing it") from None
        except FileNotFoundError as error:
            if make or not Path(self.path).parent.is_dir():
                raise of_file(self.path, error) from None
        except OSError as error:
            raise of_file(self.path or "an empty name", error) from None
        except ValueError:
            raise InputError(f"{self.path}: not the name of a file") from None

    def lines(self) -> Iterator[tuple[int, bytes]]:
        """The lines of the file; a last line that is incomplete is dropped."""
        self.open(make=False)
        if self._file is None:
            return
        with os.fdopen(os.dup(self._file), "rb") as file:
            whole = 0
            for number, line in enumerate(file, 1):
                if not line.endswith(b"\n"):
                    say(f"{self.path}:{number}: an incomplete line, dropped")
                    os.ftruncate(self._file, whole)
                    return
                whole += len(line)
                yield number, line

    def add(self, line: str) -> None:
        """Write a line in such a way that it survives a crash."""
        if self._file is None:
            self.open(make=True)
        assert self._file is not None
        try:
            left = line.strip().encode() + b"\n"
            while left:
                left = left[os.write(self._file, left) :]
            os.fsync(self._file)
        except OSError as error:
            raise of_file(self.path, error) from None


def arriving(path: str, wait: bool, stopped: Callable[[], None]) -> Iterator[bytes]:
    """Give the lines of standard input to its end, or of a file as it grows.

    The last line is given when it is complete, or when no more is to come. ``stopped`` raises an
    error if the work is to end.
    """
    try:
        file = os.dup(0) if path == "-" else os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    except OSError as error:
        raise of_file(path or "an empty name", error) from None
    except ValueError:
        raise InputError(f"{path}: not the name of a file") from None
    grows = wait and path != "-"
    rest, read = bytearray(), 0
    with contextlib.ExitStack() as stack:
        stack.callback(os.close, file)
        while True:
            stopped()
            try:
                if not select.select([file], [], [], PAUSE)[0]:
                    continue
                chunk = os.read(file, 2**16)
            except BlockingIOError:
                continue
            except OSError as error:
                raise of_file(path, error) from None
            read += len(chunk)
            *whole, last = (rest + chunk).split(b"\n")
            yield from map(bytes, whole)
            rest = bytearray(last)
            if len(rest) > LONGEST:
                yield bytes(rest)
                return
            if chunk:
                continue
            if not grows:
                break
            if os.fstat(file).st_size < read:
                raise InputError(f"{path}: it became shorter")
            time.sleep(PAUSE)
        if rest:
            yield bytes(rest)


def decoded(line: bytes, source: str, number: int) -> str:
    """Decode a line.

    Raises:
        InputError: It is not text.
    """
    if len(line) > LONGEST:
        raise InputError(f"{source}:{number}: longer than {LONGEST >> 20} MiB")
    try:
        text = line.decode("utf-8-sig" if number == 1 else "utf-8")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise InputError(f"{source}:{number}: not text")
    return text
