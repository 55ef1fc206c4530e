"""Files: they are read whole, within a limit, and are never left half-written."""

import contextlib
import fcntl
import os
import secrets
import sys
from collections.abc import Iterator
from errno import EISDIR, ELOOP
from pathlib import Path
from typing import IO, Any

from topomap.runtime.errors import InputError, of_file

MOST_BYTES = 2**25
_CHUNK = 2**20
_TEMPORARY = ".topomap-"
TEXT = {"encoding": "utf-8", "errors": "backslashreplace"}


def read_bytes(path: str | Path) -> bytes:
    """Read the bytes of a file.

    Raises:
        InputError: The file cannot be read.
    """
    return bytes(_content(path, MOST_BYTES))


def read_text(path: str | Path, most: int = MOST_BYTES) -> str:
    """Read the text of a file of at most ``most`` bytes.

    Raises:
        InputError: The file cannot be read, is too large, or is not text.
    """
    try:
        return _content(path, most, b"\0").decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file") from None


def _content(path: str | Path, most: int, forbidden: bytes | None = None) -> bytearray:
    """Read a file until it is too large or turns out not to be text."""
    content = bytearray()
    try:
        with Path("/dev/stdin" if str(path) == "-" else path).open("rb") as file:
            while chunk := file.read(_CHUNK):
                content += chunk
                if len(content) > most:
                    raise InputError(f"{path}: larger than {most >> 20} MiB")
                if forbidden and forbidden in chunk:
                    raise InputError(f"{path}: not a text file")
    except OSError as error:
        raise of_file(path, error) from None
    except ValueError:
        raise InputError(f"{path}: not the name of a file") from None
    return content


@contextlib.contextmanager
def output(path: str | None, parents: bool = False, binary: bool = False) -> Iterator[IO[Any]]:
    """Open what a command writes to: standard output if there is no path, otherwise a file.

    A temporary file beside the named one is written, and takes its place when it is whole.
    ``parents`` makes the folder of the file, and ``binary`` takes bytes.

    Raises:
        InputError: The file cannot be written.
    """
    try:
        how: dict[str, Any] = {"mode": "wb"} if binary else {"mode": "w", **TEXT}
        if path is None:
            yield sys.stdout.buffer if binary else sys.stdout
            sys.stdout.flush()
            return
        target = Path(os.path.realpath(path))
        if target.is_symlink():
            raise OSError(ELOOP, os.strerror(ELOOP))
        if parents:
            target.parent.mkdir(parents=True, exist_ok=True)
        if target.is_dir() or path.endswith("/"):
            raise IsADirectoryError(EISDIR, os.strerror(EISDIR))
        if Path(path).exists() and not Path(path).is_file():
            with Path(path).open(**how) as device:
                yield device
            return
        # The name is known before the file is there, so an interrupt at any moment leaves none.
        temporary = target.parent / f"{_TEMPORARY}{secrets.token_hex(8)}"
        try:
            with _locked(temporary, how) as file:
                yield file
                file.flush()
                temporary.chmod(0o666 & ~_umask())
                temporary.replace(target)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise
    except BrokenPipeError:
        raise
    except OSError as error:
        name = "standard output" if path is None else path or "an empty name"
        raise of_file(name, error) from None
    except ValueError as error:
        if "null byte" not in str(error):
            raise
        raise InputError(f"{path}: not the name of a file") from None


def _locked(name: Path, how: dict[str, Any]) -> IO[Any]:
    """Make a new file, which is locked while its writer lives.

    A writer that was killed leaves a file without a lock; such files in the folder are removed.
    """
    for left in name.parent.glob(f"{_TEMPORARY}*"):
        with contextlib.suppress(OSError), left.open() as old:
            fcntl.flock(old, fcntl.LOCK_EX | fcntl.LOCK_NB)
            left.unlink()
    while True:
        new = os.open(name, os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_CLOEXEC, 0o600)
        file: IO[Any] = os.fdopen(new, **how)
        with contextlib.suppress(OSError):  # this file system has no locks: nothing is removed
            fcntl.flock(file, fcntl.LOCK_EX)
        if os.fstat(file.fileno()).st_nlink:  # otherwise another writer has removed it
            return file
        file.close()


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
