"""What must be prepared before numpy, scipy and matplotlib are loaded."""

import mmap

MEMORY = 300 << 20  # bytes: what these libraries map when they are loaded, and some more


def ready() -> None:
    """Check that there is memory enough before numpy is loaded.

    A library that does not fit into memory would raise an ImportError.

    Raises:
        MemoryError: There is not enough memory.
    """
    try:
        mmap.mmap(-1, MEMORY, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, mmap.PROT_READ).close()
    except OSError:
        raise MemoryError from None
