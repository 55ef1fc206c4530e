"""Output files: the old one or the whole new one, never a part."""

import contextlib
import os
import sys
import tempfile
from collections.abc import Iterator
from errno import EISDIR
from pathlib import Path
from typing import IO

from topomap.errors import InputError


@contextlib.contextmanager
def output(path: str | None, parents: bool = False) -> Iterator[IO[str]]:
    """A text to write: standard output without a path, else a temporary file beside
    the named one that takes its place when all is written; ``parents`` makes its folder.
    Raises InputError where that cannot be."""
    if path is None:
        yield sys.stdout
        return
    target = Path(path).resolve()
    try:
        if parents:
            target.parent.mkdir(parents=True, exist_ok=True)
        if target.is_dir():
            raise IsADirectoryError(EISDIR, os.strerror(EISDIR))
        if target.exists() and not target.is_file():
            with target.open("w", encoding="utf-8") as device:
                yield device
            return
        with tempfile.NamedTemporaryFile(
            "w", encoding="utf-8", dir=target.parent, prefix=f".{target.name}.", delete=False
        ) as text:
            try:
                yield text
                text.flush()
                Path(text.name).chmod(0o666 & ~_umask())
                Path(text.name).replace(target)
            except BaseException:
                Path(text.name).unlink()
                raise
    except OSError as error:
        raise InputError(f"{path}: {(error.strerror or str(error)).lower()}") from None


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
