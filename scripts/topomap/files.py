"""Output files: the old one or the whole new one, never a part."""

import contextlib
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from topomap.errors import InputError


@contextlib.contextmanager
def output(path: str | None) -> Iterator[TextIO]:
    """A text to write: standard output without a path, else a temporary file beside
    the named one that takes its place when all is written. Raises InputError where
    that cannot be."""
    if path is None:
        yield sys.stdout
        return
    target = Path(path).resolve()
    try:
        if target.exists() and not target.is_file():
            if target.is_dir():
                raise InputError(f"{path}: is a directory")
            with open(target, "w", encoding="utf-8") as device:
                yield device
            return
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.", suffix=".tmp")
        try:
            with open(handle, "w", encoding="utf-8") as text:
                yield text
            os.chmod(name, 0o666 & ~_umask())
            os.replace(name, target)
        except BaseException:
            os.unlink(name)
            raise
    except OSError as error:
        raise InputError(f"{path}: {(error.strerror or str(error)).lower()}") from None


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
