"""What is to be seen to before numpy, scipy and matplotlib are loaded."""

import mmap
import os

MEMORY = 300 << 20  # what they map when they are loaded, and some more


def ready() -> None:
    """Before numpy is loaded: OpenBLAS would wait without end for memory that is not there, and
    a library that does not fit into it is an ImportError. One thread will do. Raises
    MemoryError."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        mmap.mmap(-1, MEMORY, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, mmap.PROT_READ).close()
    except OSError:
        raise MemoryError from None
