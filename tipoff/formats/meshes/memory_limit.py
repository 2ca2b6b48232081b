"""A memory limit for reading a file. Without it, a few bytes in the file, such as the number of a
node, could request all memory of the machine."""

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_PAGES = Path("/proc/self/statm")  # its first number is the address space in pages


@contextmanager
def limited(extra: int) -> Iterator[None]:
    """Context in which this process gets at most ``extra`` more bytes of address space, then a
    MemoryError. No effect on systems that do not report the present size."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    try:
        limit = int(_PAGES.read_text().split()[0]) * resource.getpagesize() + extra
    except OSError:
        yield
        return
    if soft != resource.RLIM_INFINITY:
        limit = min(limit, soft)
    resource.setrlimit(resource.RLIMIT_AS, (limit, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
