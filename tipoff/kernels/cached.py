"""Files in which Numba keeps compiled kernels: one for each combination of types, with a digest of
its content.

Numba numbers these files and keeps the numbers in an index. Two processes that compile at the same
time may take the same number; then one loads the machine code of the other, made for other types.
Numba also loads damaged files, which ends the program with a traceback or a segmentation fault.
Here the name of a file follows from the types, and there is no index. A damaged file counts as
missing: the kernel is compiled again and the file replaced. A file that cannot be written, as on a
full disk, is left out.
"""

import contextlib
import hashlib
from pathlib import Path
from typing import Any

from numba.core.caching import IndexDataCacheFile

from tipoff.cache import Cache, binary


class KernelFiles(IndexDataCacheFile):
    """The machine code of one kernel. A ``key`` has the types, the processor and the function."""

    def __init__(self, cache_path: str, filename_base: str, source_stamp: str):
        super().__init__(cache_path, filename_base, source_stamp)
        self._base = filename_base
        self._files: Cache[tuple] = binary(self._dump, lambda path: self._load_data(path.name))

    def save(self, key: tuple, data: Any) -> None:
        """Keep ``data``, as Numba makes it, under ``key``."""
        with contextlib.suppress(OSError):
            self._files.put(*self._place(key), (self._origin(key), data))

    def load(self, key: tuple) -> Any:
        """What is kept under ``key``, or None."""
        found = self._files.get(*self._place(key), "the kernel is compiled again")
        # types of one text may differ
        return found[1] if found is not None and found[0] == self._origin(key) else None

    def flush(self) -> None:
        """Remove what is kept of this kernel."""
        for path in Path(self._cache_path).glob(f"{self._base}.*.nbc"):
            path.unlink(missing_ok=True)

    def _origin(self, key: tuple) -> tuple:
        return self._version, self._source_stamp, key

    def _place(self, key: tuple) -> tuple[Path, str]:
        digest = hashlib.sha256(repr(self._origin(key)).encode()).hexdigest()
        return Path(self._cache_path) / f"{self._base}.{digest[:16]}.nbc", digest
