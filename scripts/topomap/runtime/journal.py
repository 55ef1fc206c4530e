"""Journals of long runs: FILE.part, beside the output FILE, tells what is done."""

import fcntl
import json
import os
import zlib
from collections.abc import Iterator, Mapping
from errno import ENAMETOOLONG
from pathlib import Path
from typing import Any, BinaryIO

from topomap.runtime.errors import InputError, of_file, say
from topomap.runtime.version import VERSION

HEAD = b'{"topomap": '
DONE = b"done"


class Journal:
    """A journal of a run that consists of units.

    Values are written, and a unit is done when it is committed. Each line ends with a checksum of
    all that the file holds so far.

    ``run`` describes what is computed. ``resume`` goes on with the journal of an earlier, equal
    run, after its last unit that was done; with ``cut_too`` the values of the unit that was cut
    short are kept as well. Without an output file, or if it is not a regular file, nothing is kept.

    Raises:
        InputError: The file cannot be opened, another process uses it, or it is of another run.
    """

    def __init__(
        self,
        output: str | None = None,
        run: Mapping[str, Any] | None = None,
        resume: bool = False,
        cut_too: bool = False,
    ):
        self.path: Path | None = None
        self.complete = self._stopped = False
        self._cut_too, self._output = cut_too, output
        self._end = self._units = self._sum = 0  # of the valid part
        self._reader: BinaryIO | None = None
        head = json.dumps({"topomap": VERSION, **(run or {})}) + "\n"
        if output is None or (Path(output).exists() and not Path(output).is_file()):
            if resume:
                raise InputError("--resume: it needs an output file (-o)")
            return
        try:
            self.path = Path(os.path.realpath(output) + ".part")
            flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_NONBLOCK
            self._file = os.fdopen(os.open(self.path, flags, 0o666), "a+b")
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if self.path.stat().st_size:
                self._file.seek(0)
                if self._file.read(len(HEAD)) != HEAD[: self.path.stat().st_size]:
                    raise InputError(
                        f"{self.path}: not a journal of this program; it is in the way"
                    )
                if resume:
                    self._read(head.encode())
                else:
                    say(f"{output}: started anew; with --resume the run would have gone on")
            self._file.truncate(self._end)
            if not self._end:
                self._file.write(head.encode())
                self._file.flush()
                self._sum = zlib.crc32(head.encode())
            self._reader = self.path.open("rb")
            self._reader.readline()
        except BlockingIOError:
            raise InputError(f"{self.path}: another run is writing it") from None
        except OSError as error:
            if error.errno == ENAMETOOLONG and not resume:
                self.path = None
                return
            named = self.path if self.path and os.path.lexists(self.path) else output
            raise of_file(named, error) from None
        except ValueError:
            raise InputError(f"{output}: not the name of a file") from None

    def _read(self, head: bytes) -> None:
        """Find the end of what is valid."""
        self._file.seek(0)
        first = self._file.readline()
        if not first.endswith(b"\n"):
            return
        if first != head:
            raise InputError(
                f"{self.path}: it belongs to another run; without --resume this run starts anew"
            )
        self._end = self._file.tell()
        self._sum = total = zlib.crc32(first)
        for line in self._file:
            if not line.endswith(b"\n"):
                return
            text, done = self._text(line)
            total = self._added(text, total)
            if line != self._line(text, total):
                fault = f"damaged after unit {self._units}; without --resume it is begun anew"
                raise InputError(f"{self.path}: {fault}")
            self._units += done
            if self._cut_too or done:
                self._end, self._sum = self._file.tell(), total

    @staticmethod
    def _added(text: bytes, total: int) -> int:
        """Add a text to the checksum.

        The end of the text is included, because two texts could otherwise be taken for one.
        """
        return zlib.crc32(text + b"\n", total)

    @staticmethod
    def _line(text: bytes, total: int) -> bytes:
        return b"%b %08x\n" % (text, total)

    @staticmethod
    def _text(line: bytes) -> tuple[bytes, bool]:
        """Read what a line says, and whether it ends a unit."""
        text = line.rpartition(b" ")[0]
        return text, text == DONE

    @property
    def kept(self) -> bool:
        """Whether anything is written down."""
        return self.path is not None

    def recorded(self, units: int) -> Iterator[Any]:
        """Give the recorded values of the next units.

        A None follows the values of each unit that is done. The values of the unit that was cut
        short, if there was one, come last.
        """
        while units and self._reader and self._reader.tell() < self._end and not self._stopped:
            text, done = self._text(self._reader.readline())
            units -= done
            yield None if done else json.loads(text)

    def known(self, units: int) -> list[Any]:
        """Give the recorded values of the next units that have one value each."""
        return [value for value in self.recorded(units) if value is not None]

    def keep(self, value: Any) -> None:
        """Write down a unit of one value, which is done."""
        self.add(value)
        self.commit()

    def add(self, value: Any) -> None:
        """Write down a value of the unit that is being worked on."""
        self._write(json.dumps(value).encode())

    def commit(self) -> None:
        """Write down that the unit is done."""
        self._write(DONE, flush=True)
        self._units += 1

    def stop(self) -> None:
        """Write down nothing more, because the next unit is not the next one of a whole run."""
        self._stopped = True

    def _write(self, text: bytes, flush: bool = False) -> None:
        if self._reader is None or self._stopped:
            return
        self._sum = self._added(text, self._sum)
        try:
            self._file.write(self._line(text, self._sum))
            if flush:
                self._file.flush()
        except OSError as error:
            raise of_file(self.path, error) from None

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Close the file, and remove it if the run is complete or has done nothing."""
        if self._reader is None or self.path is None:
            return
        if not self._units or (self.complete and kind is None):
            self.path.unlink()
        elif kind is None or not issubclass(kind, InputError):
            say(f"{self._output}: partial; the same call with --resume goes on from here")
        self._file.close()
        self._reader.close()
