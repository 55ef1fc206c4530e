"""What is to be seen to before numpy, scipy and matplotlib are loaded."""

import mmap

MEMORY = 300 << 20  # what they map when they are loaded, and some more


def ready() -> None:
    """Before numpy is loaded: a library that does not fit into memory is an ImportError. Raises
    MemoryError."""
    try:
        mmap.mmap(-1, MEMORY, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, mmap.PROT_READ).close()
    except OSError:
        raise MemoryError from None
